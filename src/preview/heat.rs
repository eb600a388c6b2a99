//! Numbers on a surface, as colors.
//!
//! Promise: what is shown is measured on the written triangles, each number where it was measured; the scale goes from
//! the least that makes sense to the greatest that was measured, or, where few triangles are far beyond all others, to
//! what all but a hundredth of the triangles keep below, and says so.
//! No promise: where there is nothing to measure (no texture, no skin) triangles are gray.
//!
//! Source: S. Rusinkiewicz, Estimating Curvatures and Their Derivatives on Triangle Meshes, 2004, section 3.1 (curvature of
//! a face by its normals); P. Sander et al., Texture Mapping Progressive Meshes, 2001, section 3 (singular values of
//! a parametrization).

use glam::{DMat2, DVec2, DVec3, Vec3};
use thiserror::Error;

use super::asset::{Asset, Part};
use super::color;
use super::stage::{Piece, Stage};
use crate::geometry::number::{floor_index, in_fan, single};

/// What is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heat {
    /// Distance from the true surface, which a file does not hold.
    Deviation,
    /// Distance from another surface, which is given.
    Distance,
    /// The greater of the principal curvatures, without sign.
    Curvature,
    /// How unequally texture coordinates stretch the picture: the greater stretch over the lesser.
    UvStretch,
    /// How dense the texels of the color texture lie.
    TexelDensity,
    /// Which level of detail is shown, 0 for the finest.
    Lod,
    /// How much a joint carries, by its name.
    Weights(String),
}

/// Numbers measured on the triangles of one mesh, at the places of [`FAN`](crate::geometry::number::FAN).
pub type Measured = Vec<[f32; 13]>;

/// Numbers on the triangles of a stage.
#[derive(Clone, Debug)]
pub struct HeatMap {
    /// For each triangle what was measured.
    values: Vec<Values>,
    /// The number of the first color.
    pub low: f64,
    /// The number of the last color.
    pub high: f64,
    /// The greatest number.
    pub greatest: f64,
}

#[derive(Clone, Copy, Debug)]
enum Values {
    None,
    Face(f32),
    Corners([f32; 3]),
    Places([f32; 13]),
}

/// Why there is nothing to show.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum HeatError {
    /// No surface to measure from.
    #[error(
        "the distance from the true surface is not known: a .glb file does not hold the surface, and hulls, rounded shapes and subdivided ones have none of their own; name a document"
    )]
    NoSurface,
    /// No color texture.
    #[error("no material has a color texture, so there are no texels")]
    NoTexture,
    /// No texture coordinates.
    #[error("no mesh has texture coordinates")]
    NoUv,
    /// No joint of the name.
    #[error("no joint `{0}` carries anything{1}")]
    NoJoint(String, String),
    /// No levels of detail.
    #[error("there is one level of detail: write `[lod]` in the document for more")]
    NoLevels,
    /// No triangles.
    #[error("there are no triangles to measure on")]
    NoTriangles,
}

impl Heat {
    /// What is shown by the word for it: `deviation`, `curvature`, `uv-stretch`, `texel-density`, `lod`, or
    /// `weights:JOINT`.
    #[must_use]
    pub fn named(text: &str) -> Option<Self> {
        Some(match text.split_once(':') {
            Some(("weights", joint)) if !joint.is_empty() => Self::Weights(joint.to_owned()),
            None if text == "deviation" => Self::Deviation,
            None if text == "curvature" => Self::Curvature,
            None if text == "uv-stretch" => Self::UvStretch,
            None if text == "texel-density" => Self::TexelDensity,
            None if text == "lod" => Self::Lod,
            _ => return None,
        })
    }

    /// What is shown, and its unit, in words.
    #[must_use]
    pub fn title(&self) -> String {
        match self {
            Self::Deviation => "deviation, m".to_owned(),
            Self::Distance => "distance, m".to_owned(),
            Self::Curvature => "curvature, 1/m".to_owned(),
            Self::UvStretch => "uv stretch".to_owned(),
            Self::TexelDensity => "texels/m".to_owned(),
            Self::Lod => "level of detail".to_owned(),
            Self::Weights(joint) => format!("weight of {joint}"),
        }
    }
}

impl HeatMap {
    /// Measures what is to be shown on a stage. Distances from the true surface are given: for each mesh of the file what
    /// was measured on its triangles, in their order.
    ///
    /// Cost: linear in triangles, but for sorting them where few are far beyond the others.
    ///
    /// # Errors
    /// When nothing of it is there to be measured.
    pub fn new(
        heat: &Heat,
        (asset, stage): (&Asset, &Stage),
        deviations: &[Option<Measured>],
    ) -> Result<Self, HeatError> {
        if stage.triangles.is_empty() {
            return Err(HeatError::NoTriangles);
        }
        let mut values = Vec::with_capacity(stage.triangles.len());
        let mut own = Place::default();
        for piece in &stage.pieces {
            own.enter(asset, piece);
            let Some((mesh, part)) = own.part(asset) else { continue };
            for (number, corners) in part.triangles.iter().enumerate() {
                let triangle = values.len();
                values.push(match heat {
                    Heat::Deviation | Heat::Distance => {
                        let measured = deviations.get(mesh).and_then(Option::as_ref);
                        let found = measured.and_then(|measured| measured.get(own.before + number));
                        found.map_or(Values::None, |found| turned(*found, stage, triangle, corners))
                    }
                    Heat::Curvature => Values::Face(curvature(stage, triangle)),
                    Heat::UvStretch => stretch(part, stage, triangle),
                    Heat::TexelDensity => density((asset, stage), piece.material, triangle),
                    Heat::Lod if asset.shown.count < 2 => Values::None,
                    Heat::Lod => Values::Face(single(asset.shown.of(piece.node) as f64)),
                    Heat::Weights(joint) => weights(asset, piece, part, (joint, *corners)),
                });
            }
            own.before += part.triangles.len();
        }
        Self::scaled(heat, values, asset)
    }

    /// Numbers that are known: for each triangle of a stage those at its places, and those of the first and last color. A
    /// triangle whose numbers are none (NaN) is gray.
    #[must_use]
    pub fn of(values: Measured, (low, high): (f64, f64)) -> Self {
        let value = |value: [f32; 13]| if value[12].is_nan() { Values::None } else { Values::Places(value) };
        Self { values: values.into_iter().map(value).collect(), low, high, greatest: high }
    }

    fn scaled(heat: &Heat, values: Vec<Values>, asset: &Asset) -> Result<Self, HeatError> {
        let mut all: Vec<f32> =
            values.iter().filter_map(Values::greatest).filter(|value| value.is_finite()).collect();
        if all.is_empty() {
            return Err(match heat {
                Heat::Deviation | Heat::Distance => HeatError::NoSurface,
                Heat::UvStretch => HeatError::NoUv,
                Heat::TexelDensity => HeatError::NoTexture,
                Heat::Weights(joint) => HeatError::NoJoint(joint.clone(), joints(asset)),
                Heat::Lod => HeatError::NoLevels,
                Heat::Curvature => HeatError::NoTriangles,
            });
        }
        all.sort_by(f32::total_cmp);
        let greatest = f64::from(all[all.len() - 1]);
        let usual = f64::from(all[floor_index(0.99 * (all.len() - 1) as f64)]);
        let low = if *heat == Heat::UvStretch { 1.0 } else { 0.0 };
        let whole = matches!(heat, Heat::Weights(_) | Heat::Deviation | Heat::Distance);
        let high = match heat {
            Heat::Weights(_) => 1.0,
            // The same color for a level whichever is shown.
            Heat::Lod => (asset.shown.count - 1) as f64,
            _ if !whole && greatest - low > 4.0 * (usual - low) && usual > low => usual,
            _ => greatest,
        };
        // Where all is the same there is one color.
        let high = if high > low { high } else { low + 1.0 };
        Ok(Self { values, low, high, greatest })
    }

    /// The color at a place of a triangle, linear; none where nothing was measured.
    #[must_use]
    pub fn color(&self, triangle: u32, shares: [f64; 3]) -> Option<Vec3> {
        let value = self.values.get(triangle as usize)?.at(shares)?;
        Some(ramp((value - self.low) / (self.high - self.low)))
    }
}

/// The part of a mesh that a piece of a stage shows.
#[derive(Default)]
struct Place {
    node: Option<usize>,
    number: usize,
    /// Triangles of the mesh before the part.
    before: usize,
}

impl Place {
    fn enter(&mut self, asset: &Asset, piece: &Piece) {
        let parts = self
            .node
            .and_then(|node| asset.nodes[node].mesh)
            .map_or(0, |mesh| asset.meshes[mesh].parts.len());
        if self.node == Some(piece.node) && self.number + 1 < parts {
            self.number += 1;
        } else {
            *self = Self { node: Some(piece.node), ..Self::default() };
        }
    }

    fn part<'a>(&self, asset: &'a Asset) -> Option<(usize, &'a Part)> {
        let mesh = asset.nodes[self.node?].mesh?;
        asset.meshes[mesh].parts.get(self.number).map(|part| (mesh, part))
    }
}

impl Values {
    fn greatest(&self) -> Option<f32> {
        match self {
            Self::None => None,
            Self::Face(value) => Some(*value),
            Self::Corners(values) => values.iter().copied().reduce(f32::max),
            Self::Places(values) => values.iter().copied().reduce(f32::max),
        }
    }

    /// The number at a place, straight between those that were measured.
    fn at(&self, shares: [f64; 3]) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Face(value) => Some(f64::from(*value)),
            Self::Corners(values) => Some((0..3).map(|k| f64::from(values[k]) * shares[k]).sum()),
            Self::Places(values) => Some(in_fan(&values.map(f64::from), shares)),
        }
    }
}

/// What was measured, where a mirrored node shows the triangle turned around.
fn turned(measured: [f32; 13], stage: &Stage, triangle: usize, corners: &[u32; 3]) -> Values {
    let shown = stage.triangles[triangle];
    let same = i64::from(shown[1]) - i64::from(shown[0]) == i64::from(corners[1]) - i64::from(corners[0]);
    if same {
        return Values::Places(measured);
    }
    // The rim from the same corner, the other way.
    let mut other = measured;
    for (step, value) in other[..12].iter_mut().enumerate() {
        *value = measured[(12 - step) % 12];
    }
    Values::Places(other)
}

/// The greater principal curvature of a face by the normals at its corners.
fn curvature(stage: &Stage, triangle: usize) -> f32 {
    let corners = stage.triangles[triangle].map(|corner| stage.vertices[corner as usize]);
    let points = corners.map(|corner| corner.point);
    let along = (points[1] - points[0]).normalize_or_zero();
    let across = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
    let aside = across.cross(along);
    let plane = |vector: DVec3| DVec2::new(vector.dot(along), vector.dot(aside));
    // Least squares for the second fundamental form [a b; b c]: along each side it gives the change of the normal.
    let (mut left, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for k in 0..3 {
        let side = plane(points[(k + 1) % 3] - points[k]);
        let change = plane(corners[(k + 1) % 3].normal - corners[k].normal);
        for (row, value) in [([side.x, side.y, 0.0], change.x), ([0.0, side.x, side.y], change.y)] {
            for i in 0..3 {
                right[i] += row[i] * value;
                for j in 0..3 {
                    left[i][j] += row[i] * row[j];
                }
            }
        }
    }
    let matrix = glam::DMat3::from_cols_array_2d(&left);
    if matrix.determinant() == 0.0 {
        return 0.0;
    }
    let DVec3 { x: a, y: b, z: c } = matrix.inverse() * DVec3::from_array(right);
    let (mean, spread) = ((a + c) / 2.0, ((a - c) * (a - c) / 4.0 + b * b).sqrt());
    let greatest = mean.abs() + spread;
    if greatest.is_finite() { single(greatest) } else { 0.0 }
}

/// How texture coordinates become places: the matrix in the plane of the triangle; none where they have no area.
fn parametrization(stage: &Stage, triangle: usize, set: usize) -> Option<DMat2> {
    let corners = stage.triangles[triangle].map(|corner| stage.vertices[corner as usize]);
    let [p, q, r] = corners.map(|corner| DVec2::from_array(corner.uvs[set].map(f64::from)));
    let [a, b, c] = corners.map(|corner| corner.point);
    let along = (b - a).try_normalize()?;
    let aside = (b - a).cross(c - a).try_normalize()?.cross(along);
    let plane = |vector: DVec3| DVec2::new(vector.dot(along), vector.dot(aside));
    let picture = DMat2::from_cols(q - p, r - p);
    (picture.determinant() != 0.0).then(|| DMat2::from_cols(plane(b - a), plane(c - a)) * picture.inverse())
}

fn stretch(part: &Part, stage: &Stage, triangle: usize) -> Values {
    if part.uvs[0].is_empty() {
        return Values::None;
    }
    let Some(map) = parametrization(stage, triangle, 0) else { return Values::Face(f32::INFINITY) };
    // Singular values: their squares have this sum, and their product is the determinant.
    let sum = map.x_axis.length_squared() + map.y_axis.length_squared();
    let product = map.determinant().abs();
    let apart = (sum * sum / 4.0 - product * product).max(0.0).sqrt();
    let (greater, lesser) = (sum / 2.0 + apart, sum / 2.0 - apart);
    // The lesser loses its digits where they are far apart; it follows from the product.
    let lesser = if greater > 0.0 { (product * product / greater).max(lesser.min(0.0)) } else { 0.0 };
    Values::Face(single((greater / lesser).sqrt()))
}

fn density((asset, stage): (&Asset, &Stage), material: usize, triangle: usize) -> Values {
    let Some(map) = asset.materials[material].color_map else { return Values::None };
    let (width, height) = asset.textures[map.texture].size();
    let Some(places) = parametrization(stage, triangle, map.set) else { return Values::None };
    let texels = map.place.matrix2.determinant().abs() * width * height;
    Values::Face(single((texels / places.determinant().abs()).sqrt()))
}

fn weights(asset: &Asset, piece: &Piece, part: &Part, (joint, corners): (&str, [u32; 3])) -> Values {
    let Some(skin) = asset.nodes[piece.node].skin else { return Values::None };
    let own = |node: &usize| asset.nodes[*node].name == joint;
    let Some(index) = asset.skins[skin].joints.iter().position(own) else { return Values::None };
    let weight = |corner: u32| {
        let vertex = corner as usize;
        let pairs =
            part.joints.get(vertex).into_iter().flatten().zip(part.shares.get(vertex).into_iter().flatten());
        pairs.filter(|(joint, _)| **joint as usize == index).map(|(_, share)| share).sum()
    };
    Values::Corners(corners.map(weight))
}

fn joints(asset: &Asset) -> String {
    let all: Vec<&str> = asset
        .skins
        .iter()
        .flat_map(|skin| skin.joints.iter().map(|joint| asset.nodes[*joint].name.as_str()))
        .collect();
    if all.is_empty() {
        ": the file has no skin".to_owned()
    } else {
        format!(": there are {}", all.join(", "))
    }
}

/// Colors from dark violet over green to yellow, which differ by as much as their numbers do, for the color-blind too: nine
/// of the map `viridis` by S. van der Walt and N. Smith (2015, CC0), straight between.
const COLORS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6d, 0xcd, 0x59],
    [0xfd, 0xe7, 0x25],
];

/// The color of a share of the scale, linear.
pub(super) fn ramp(share: f64) -> Vec3 {
    let place = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64 };
    let step = floor_index(place).min(COLORS.len() - 2);
    let color = |step: usize| Vec3::from_array(COLORS[step].map(color::linear));
    color(step).lerp(color(step + 1), single(place - step as f64))
}

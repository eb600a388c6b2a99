//! Grids for positions: which mesh is rounded to which.
//!
//! Promise: meshes that are shown at one scale share one grid, so that what lies at one place in two of them stays at one
//! place; a step is as long in the scene whatever the scale of a mesh. Lines go through the origin, so that what is symmetric
//! stays so, within what single precision tells apart. A mesh that 16 bits do not span within the tolerance has no grid.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde_json::Value;

use super::accessor::Source;
use super::document::{Fault, as_index, list, whole};
use super::pin::Pins;
use super::{Options, copies, number_list, primitives};
use crate::geometry::number::{Bounds, single};

/// Steps that a whole number of 16 bits tells apart, less one at each end for what is rounded outward.
const MOST_STEPS: f64 = 65533.0;

/// Steps over the scene where no tolerance is asked for: as fine as what engines commonly ask for.
const STEPS: f64 = 16384.0;

/// Where positions are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    /// From one line to the next, in units of the mesh.
    pub(super) step: f32,
    /// What 0 stands for.
    pub(super) offset: [f32; 3],
}

impl Grid {
    /// From places on the grid to the units of the mesh.
    pub(super) fn affine(self) -> DAffine3 {
        let offset = DVec3::from_array(self.offset.map(f64::from));
        DAffine3::from_scale_rotation_translation(DVec3::splat(self.step.into()), DQuat::IDENTITY, offset)
    }

    /// The place nearest to a position; the mesh lies within the grid.
    pub(super) fn place(self, position: [f64; 3]) -> [f64; 3] {
        let step = f64::from(self.step);
        std::array::from_fn(|axis| {
            ((position[axis] - f64::from(self.offset[axis])) / step).round().clamp(0.0, 65535.0)
        })
    }

    /// Where a place stands.
    pub(super) fn position(self, place: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| f64::from(self.offset[axis]) + place[axis] * f64::from(self.step))
    }
}

/// What is known of a mesh before it is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshPlace {
    /// Its grid, where it has one.
    pub(super) grid: Option<Grid>,
    /// By how much it is magnified in the scene, at most.
    pub(super) scale: f64,
    /// Whether its positions stand on a grid already, which is kept.
    pub(super) whole: bool,
}

/// For each mesh its grid and its scale. Linear in the positions.
pub(super) fn places(
    source: &Source<'_>,
    pins: &Pins,
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<Vec<MeshPlace>, Fault> {
    let meshes = list(source.root, "meshes");
    let bounds: Result<Vec<(Bounds, bool)>, Fault> = meshes.iter().map(|mesh| bounds(source, mesh)).collect();
    let bounds = bounds?;
    let scene = Scene::of(source)?;
    let mut scales = vec![0.0_f64; meshes.len()];
    let mut shown = Bounds::EMPTY;
    for (node, own) in list(source.root, "nodes").iter().enumerate() {
        let Some(mesh) = whole(own, "mesh") else { continue };
        let (map, scale) = scene.shows(node, own);
        for copy in copies::maps(source, node, own)? {
            let copy = DMat4::from(copy);
            scales[mesh] = scales[mesh].max(scale * magnification(&copy));
            if !bounds[mesh].0.is_empty() {
                let (map, corners) = (map * copy, bounds[mesh].0.corners());
                shown = shown.union(Bounds::of_points(corners.map(|corner| map.transform_point3(corner))));
            }
        }
    }
    let sound = |scale: f64| if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
    let scales: Vec<f64> = scales.into_iter().map(sound).collect();
    let own = bounds.iter().zip(&scales).map(|((bounds, _), scale)| extent(bounds) * scale);
    let all = Some(extent(&shown)).filter(|extent| *extent > 0.0 && extent.is_finite());
    let all = all.unwrap_or_else(|| own.fold(0.0, f64::max));
    let quantized = options.profile.is_quantized();
    let mut made: Vec<MeshPlace> = scales
        .iter()
        .zip(&bounds)
        .map(|(scale, (_, whole))| MeshPlace { grid: None, scale: *scale, whole: *whole && quantized })
        .collect();
    if !(quantized && all > 0.0 && all.is_finite()) {
        return Ok(made);
    }
    let coarse = options.profile.is_compressed();
    let half_diagonal = 0.75_f64.sqrt();
    let step = match options.tolerance {
        Some(tolerance) if coarse => tolerance / half_diagonal,
        None if coarse => all / STEPS,
        _ => all / MOST_STEPS,
    };
    // Meshes of one scale, by the bits of the scale, which order as positive numbers do.
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (mesh, (bounds, whole)) in bounds.iter().enumerate() {
        if !pins.meshes.contains(&mesh) && !whole && !bounds.is_empty() {
            groups.entry(rounded(scales[mesh]).to_bits()).or_default().push(mesh);
        }
    }
    for (scale, members) in groups {
        let scale = f64::from_bits(scale);
        let together = members.iter().fold(Bounds::EMPTY, |all, mesh| all.union(bounds[*mesh].0));
        let fits = |bounds: &Bounds| extent(bounds) <= step / scale * MOST_STEPS;
        for mesh in members {
            let span = if fits(&together) { &together } else { &bounds[mesh].0 };
            let needed = extent(span) / MOST_STEPS;
            let own = f64::max(step / scale, needed);
            let allowed = options.tolerance.unwrap_or(f64::INFINITY) / scale;
            // A hair for what the step is rounded by.
            if own * half_diagonal > allowed * (1.0 + 1e-6) {
                notes.push(format!(
                    "mesh {mesh} keeps its floats: 16 bits over {} units move points by {}, more than {allowed}",
                    extent(span),
                    own * half_diagonal
                ));
                continue;
            }
            made[mesh].grid = grid(span, own);
        }
    }
    Ok(made)
}

fn extent(bounds: &Bounds) -> f64 {
    if bounds.is_empty() { 0.0 } else { (bounds.max - bounds.min).max_element() }
}

/// A grid that spans a box; none where floats do not hold its numbers.
fn grid(span: &Bounds, step: f64) -> Option<Grid> {
    let mut narrow = single(step.max(f64::from(f32::MIN_POSITIVE)));
    if f64::from(narrow) < step {
        narrow = f32::from_bits(narrow.to_bits() + 1);
    }
    let step = f64::from(narrow);
    let low = (span.min / step).floor() * step;
    // Rounding to single precision may not put the first line above what is rounded.
    let below = |number: f64| {
        let near = single(number);
        if f64::from(near) > number { single(number - step) } else { near }
    };
    let offset = low.to_array().map(below);
    let end = DVec3::from_array(offset.map(f64::from)) + step * 65535.0;
    let spans = (end - span.max).min_element() >= 0.0;
    (narrow.is_finite() && offset.iter().all(|part| part.is_finite()) && spans)
        .then_some(Grid { step: narrow, offset: offset.map(|part| part + 0.0) })
}

/// A scale with three bits behind the first, at least as great, but for a hair, which matrices add.
fn rounded(scale: f64) -> f64 {
    let mut power = 1.0;
    while power > scale && power > 1e-30 {
        power /= 2.0;
    }
    while power * 2.0 <= scale && power < 1e30 {
        power *= 2.0;
    }
    ((scale / power - 1e-4) * 8.0).ceil().max(8.0) / 8.0 * power
}

/// The box of a mesh's positions, and whether all of them are whole numbers.
fn bounds(source: &Source<'_>, mesh: &Value) -> Result<(Bounds, bool), Fault> {
    let mut all = Bounds::EMPTY;
    let mut whole_numbers = true;
    let mut seen = Vec::new();
    for primitive in primitives(mesh) {
        let Some(accessor) = primitive.get("attributes").and_then(|own| whole(own, "POSITION")) else {
            continue;
        };
        if seen.contains(&accessor) {
            continue;
        }
        seen.push(accessor);
        let elements = source.sound(accessor)?;
        whole_numbers &= !elements.is_float();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in 0..elements.count {
            let point = elements.numbers::<3>(vertex);
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        all = all.union(Bounds::of_points([low, high].map(DVec3::from_array)));
    }
    let positions = !seen.is_empty();
    Ok((all, whole_numbers && positions))
}

/// Where nodes stand at rest, and how they may be magnified.
struct Scene {
    worlds: Vec<DMat4>,
    /// The product of the greatest scales of a node and of those above it, where an animation changes one of them.
    moved: Vec<Option<f64>>,
    /// For each skin its joints with what takes a mesh to them.
    skins: Vec<Vec<(usize, DMat4)>>,
}

impl Scene {
    fn of(source: &Source<'_>) -> Result<Self, Fault> {
        let nodes = list(source.root, "nodes");
        let mut parents = vec![None; nodes.len()];
        super::check::children(nodes).for_each(|(node, child)| parents[child] = Some(node));
        let locals: Vec<DMat4> = nodes.iter().map(local).collect();
        let keyed = keyed_scales(source)?;
        let mut scene = Self { worlds: locals.clone(), moved: vec![None; nodes.len()], skins: Vec::new() };
        let mut products: Vec<f64> = Vec::with_capacity(nodes.len());
        let own = |node: usize| magnification(&locals[node]).max(keyed[node].unwrap_or(0.0));
        products.extend((0..nodes.len()).map(own));
        let mut moves: Vec<bool> = keyed.iter().map(Option::is_some).collect();
        // Parents before their children.
        let mut open: Vec<usize> = (0..nodes.len()).filter(|node| parents[*node].is_none()).collect();
        let mut below = vec![Vec::new(); nodes.len()];
        super::check::children(nodes).for_each(|(node, child)| below[node].push(child));
        while let Some(node) = open.pop() {
            for child in &below[node] {
                scene.worlds[*child] = scene.worlds[node] * locals[*child];
                products[*child] *= products[node];
                moves[*child] |= moves[node];
                open.push(*child);
            }
        }
        scene.moved =
            products.into_iter().zip(moves).map(|(product, moves)| moves.then_some(product)).collect();
        for skin in list(source.root, "skins") {
            let joints = skin["joints"].as_array().into_iter().flatten().filter_map(as_index);
            let inverse = inverse_bind(source, skin)?;
            let back = |place: usize| inverse.get(place).copied().unwrap_or(DMat4::IDENTITY);
            scene.skins.push(joints.enumerate().map(|(place, joint)| (joint, back(place))).collect());
        }
        Ok(scene)
    }

    /// Where a node shows its mesh at rest, and by how much it magnifies it at most.
    fn shows(&self, node: usize, own: &Value) -> (DMat4, f64) {
        let Some(skin) = whole(own, "skin") else {
            return (
                self.worlds[node],
                self.moved[node].unwrap_or_else(|| magnification(&self.worlds[node])),
            );
        };
        let joint = |(joint, inverse): &(usize, DMat4)| match self.moved[*joint] {
            Some(product) => product * magnification(inverse),
            None => magnification(&(self.worlds[*joint] * *inverse)),
        };
        let scale = self.skins[skin].iter().map(joint).fold(0.0, f64::max);
        let map = self.skins[skin].first().map(|(joint, inverse)| self.worlds[*joint] * *inverse);
        (map.unwrap_or(DMat4::IDENTITY), scale)
    }
}

/// The matrices that take a mesh to the joints of a skin; none where the skin has none.
pub(super) fn inverse_bind(source: &Source<'_>, skin: &Value) -> Result<Vec<DMat4>, Fault> {
    let Some(accessor) = whole(skin, "inverseBindMatrices") else { return Ok(Vec::new()) };
    let elements = source.sound(accessor)?;
    let matrix = |place: usize| DMat4::from_cols_array(&elements.numbers::<16>(place));
    Ok((0..elements.count).map(matrix).collect())
}

/// No vector is longer after a map than this many times what it was: exact where the columns are at right angles.
fn magnification(map: &DMat4) -> f64 {
    let linear = glam::DMat3::from_mat4(*map);
    let square = linear.transpose() * linear;
    let row = |axis: usize| square.row(axis).abs().element_sum();
    row(0).max(row(1)).max(row(2)).sqrt()
}

/// For each node the greatest scale that an animation gives it.
fn keyed_scales(source: &Source<'_>) -> Result<Vec<Option<f64>>, Fault> {
    let mut keyed = vec![None; list(source.root, "nodes").len()];
    for animation in list(source.root, "animations") {
        for channel in animation["channels"].as_array().into_iter().flatten() {
            let target = &channel["target"];
            let sampler = whole(channel, "sampler").map(|sampler| &animation["samplers"][sampler]);
            let output = sampler.and_then(|sampler| whole(sampler, "output"));
            let (Some(node), Some(output), Some("scale")) =
                (whole(target, "node"), output, target["path"].as_str())
            else {
                continue;
            };
            let elements = source.elements(output)?;
            let greatest = |key: usize| DVec3::from_array(elements.numbers::<3>(key)).abs().max_element();
            let most = (0..elements.count).map(greatest).fold(0.0, f64::max);
            keyed[node] = Some(keyed[node].map_or(most, |known: f64| known.max(most)));
        }
    }
    Ok(keyed)
}

/// A node's own map.
fn local(node: &Value) -> DMat4 {
    if let Some(matrix) = number_list::<16>(node, "matrix") {
        return DMat4::from_cols_array(&matrix);
    }
    let translation = number_list::<3>(node, "translation").unwrap_or_default();
    let rotation = number_list::<4>(node, "rotation").unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = number_list::<3>(node, "scale").unwrap_or([1.0; 3]);
    let turn = DQuat::from_array(rotation);
    let turn = if turn.length_squared() > 0.0 { turn.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(scale.into(), turn, translation.into())
}

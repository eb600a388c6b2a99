//! Normal maps of full-resolution fields for the reduced meshes that show them.
//!
//! Each texel has the normal of the exact surface at its place, in the tangent space of the written mesh: normal and
//! tangent interpolated between vertices and made unit again, their cross product by the tangent's sign. The place of a
//! texel is that of its center; texels around charts, which filters read, go on from those inside.
//!
//! Source: M. Mikkelsen, "Simulation of wrinkled surfaces revisited", 2008, for the space; J. Cohen, M. Olano, D. Manocha,
//! "Appearance-preserving simplification", SIGGRAPH 1998, for the map.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::RealizeError;
use super::shape::Maker;
use crate::geometry::mesh::texels::texels;
use crate::geometry::number::floor_count;
use crate::geometry::tessellate::Layer;
use crate::model::{Model, NormalMap, Recipe, ShapeHandle};
use crate::scene::{Geometry, Scene};

/// What went wrong with a shape.
type Refused = (ShapeHandle, RealizeError);

/// Draws the normal maps that a model asks for into the images of its scene, which has tangents by now. `shapes` are those
/// of the geometries.
///
/// # Errors
/// Every map that cannot be drawn: where the texture coordinates of a shape leave the picture or overlap.
pub fn normal_maps(model: &Model, scene: &mut Scene, shapes: &[ShapeHandle]) -> Result<(), Vec<Refused>> {
    let mut refused = Vec::new();
    for map in &model.normal_maps {
        let image = scene.images.iter().position(|image| image.name == map.name && image.bytes.is_empty());
        let geometry = shapes.iter().position(|shape| *shape == map.shape);
        let (Some(image), Some(geometry)) = (image, geometry) else {
            refused.push((map.shape, RealizeError::NormalMapUnused));
            continue;
        };
        match drawn(model, map, &scene.geometries[geometry]) {
            Ok(bytes) => scene.images[image].bytes = bytes.into(),
            Err(error) => refused.push((map.shape, error)),
        }
    }
    if refused.is_empty() { Ok(()) } else { Err(refused) }
}

fn drawn(model: &Model, map: &NormalMap, geometry: &Geometry) -> Result<Vec<u8>, RealizeError> {
    let truth = Truth::of(model, map)?;
    let [width, height] = map.size;
    let count = width as usize * height as usize;
    // The best known of each texel: its encoded normal and how deep inside of a triangle its center lies.
    let mut best: Vec<([u8; 3], f64)> = vec![([128, 128, 255], f64::NEG_INFINITY); count];
    let tangents = geometry.tangents.as_deref().unwrap_or(&[]);
    let mesh = &geometry.mesh;
    for triangle in &mesh.triangles {
        let vertices = triangle.map(|corner| mesh.vertices[corner.subscript()]);
        if !truth.covers(vertices.map(|vertex| vertex.anchor.source)) {
            continue;
        }
        let tangent =
            triangle.map(|corner| tangents.get(corner.subscript()).copied().unwrap_or([1.0, 0.0, 0.0, 1.0]));
        texels(vertices.map(|vertex| vertex.uv), map.size, |texel| {
            if texel.inside.min(0.0) <= best[texel.at].1 {
                return;
            }
            let sum = |of: [DVec3; 3]| (0..3).map(|k| of[k] * texel.weights[k]).sum::<DVec3>();
            let normal = sum(vertices.map(|vertex| vertex.normal)).normalize_or(vertices[0].normal);
            let along = sum(tangent.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into())));
            let along = along.normalize_or(normal.any_orthonormal_vector());
            let across =
                normal.cross(along).normalize_or(normal.any_orthonormal_vector()) * f64::from(tangent[0][3]);
            let uv: DVec2 = (0..3).map(|k| vertices[k].uv * texel.weights[k]).sum();
            let Some(exact) = truth.normal(texel.at, uv) else { return };
            let space = DMat3::from_cols(along, across, normal).inverse() * exact;
            best[texel.at] = (encoded(space), texel.inside.min(0.0));
        });
    }
    spread(&mut best, map.size);
    Ok(png(map.size, &best))
}

/// A direction as a color; what would look inward lies on the rim.
fn encoded(direction: DVec3) -> [u8; 3] {
    let direction = direction.with_z(direction.z.max(0.0)).normalize_or(DVec3::Z);
    direction.to_array().map(|part| {
        let level = (part * 0.5 + 0.5) * 255.0 + 0.5;
        u8::try_from(floor_count(level.clamp(0.0, 255.0))).unwrap_or(255)
    })
}

/// Texels without a triangle take the mean of neighbors that have one, ring by ring.
fn spread(best: &mut [([u8; 3], f64)], [width, height]: [u32; 2]) {
    /// Rings: enough for filters and three smaller pictures of a pyramid.
    const RINGS: u32 = 8;
    let (width, height) = (width as usize, height as usize);
    for _ in 0..RINGS {
        let known: Vec<bool> = best.iter().map(|(_, inside)| *inside > f64::NEG_INFINITY).collect();
        let mut filled = Vec::new();
        for at in (0..best.len()).filter(|at| !known[*at]) {
            let (i, j) = (at % width, at / width);
            let near = [
                (i > 0).then(|| at - 1),
                (i + 1 < width).then_some(at + 1),
                (j > 0).then(|| at - width),
                (j + 1 < height).then_some(at + width),
            ];
            let near: Vec<[u8; 3]> =
                near.into_iter().flatten().filter(|other| known[*other]).map(|other| best[other].0).collect();
            if near.is_empty() {
                continue;
            }
            let mean = [0, 1, 2].map(|k| {
                let sum: usize = near.iter().map(|color| usize::from(color[k])).sum();
                u8::try_from(sum / near.len()).unwrap_or(255)
            });
            filled.push((at, mean));
        }
        for (at, color) in filled {
            best[at] = (color, -1.0);
        }
    }
}

fn png([width, height]: [u32; 2], best: &[([u8; 3], f64)]) -> Vec<u8> {
    let colors: Vec<u8> = best.iter().flat_map(|(color, _)| *color).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&colors));
    written.expect("a picture of this size into memory cannot fail");
    bytes
}

/// The exact normals of a shape.
enum Truth<'a> {
    /// Of a map, at texture coordinates, under a map of space.
    Field(&'a Recipe, DMat3),
    /// Of texels, where there are any.
    Picture(Vec<Option<DVec3>>, DMat3),
}

impl<'a> Truth<'a> {
    fn of(model: &'a Model, map: &NormalMap) -> Result<Self, RealizeError> {
        let shape = model.shape(map.shape);
        let space: DAffine3 = model.frame.map() * shape.options.placement;
        let turning = cofactors(&space.matrix3);
        match &shape.recipe {
            Recipe::Displaced(recipe) => {
                let maker = Maker::new(model, &super::Options::default());
                maker.normals_of(map, recipe).map(|picture| Self::Picture(picture, turning))
            }
            recipe => Ok(Self::Field(recipe, turning)),
        }
    }

    /// Whether a triangle with corners on these sources shows the map.
    fn covers(&self, sources: [u32; 3]) -> bool {
        matches!(self, Self::Picture(..)) || sources == [0; 3]
    }

    fn normal(&self, at: usize, uv: DVec2) -> Option<DVec3> {
        let (own, turning) = match self {
            Self::Picture(picture, turning) => (picture[at]?, turning),
            Self::Field(recipe, turning) => {
                let place =
                    |[right, bottom]: [f64; 2]| [uv.x.clamp(0.0, 1.0) * right, uv.y.clamp(0.0, 1.0) * bottom];
                let own = match recipe {
                    Recipe::Height(map) => map.normal(place(map.field.extent())),
                    Recipe::Based(map) => map.jet(Layer::Top, place(map.heights().field.extent())).normal,
                    _ => return None,
                };
                (own, turning)
            }
        };
        (*turning * own).try_normalize()
    }
}

/// How normals turn under a linear map.
fn cofactors(matrix: &DMat3) -> DMat3 {
    DMat3::from_cols(
        matrix.y_axis.cross(matrix.z_axis),
        matrix.z_axis.cross(matrix.x_axis),
        matrix.x_axis.cross(matrix.y_axis),
    ) * matrix.determinant().signum()
}

//! Attributes of vertices that games read themselves: formulas at the places of written vertices.
//!
//! They are computed when everything else is done, for each level of detail at its own vertices: so no operation, rounding or
//! simplification comes between the formula and the file.

use glam::{DVec2, DVec3};

use super::RealizeError;
use crate::model::{At, Attribute, Model, ShapeHandle};
use crate::motion::Influences;
use crate::scene::{Geometry, Scene, VertexAttribute};

/// Gives the geometries of a scene the attributes that a model asks for. `shapes` are those of the geometries. Linear in the
/// vertices times the formulas.
///
/// # Errors
/// Every attribute that has no value at some vertex.
pub fn attributes(
    model: &Model,
    scene: &mut Scene,
    shapes: &[ShapeHandle],
) -> Result<(), Vec<(ShapeHandle, RealizeError)>> {
    let mut errors = Vec::new();
    for (geometry, shape) in scene.geometries.iter_mut().zip(shapes) {
        for attribute in model.attributes.iter().filter(|attribute| attribute.shape == *shape) {
            match evaluated(attribute, geometry) {
                Ok(made) => geometry.attributes.push(made),
                Err(place) => errors.push((
                    *shape,
                    RealizeError::NoAttribute {
                        name: attribute.name.clone(),
                        place: attribute.space.transform_point3(place),
                    },
                )),
            }
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}

/// An attribute at all vertices, or the first place where it has no value.
fn evaluated(attribute: &Attribute, geometry: &Geometry) -> Result<VertexAttribute, DVec3> {
    let mesh = &geometry.mesh;
    let weight = |point: usize| {
        let carried = geometry.influences.as_ref().zip(attribute.joint);
        carried.map_or(0.0, |(influences, joint)| weight_of(&influences[point], joint))
    };
    let at = |at: At| attribute.at(at).ok_or(at.place);
    let mut values = Vec::with_capacity(mesh.vertices.len() * attribute.formulas.len());
    for vertex in &mesh.vertices {
        let point = vertex.point.subscript();
        let place = mesh.points[point];
        values.extend(at(At { place, normal: vertex.normal, uv: vertex.uv, weight: weight(point) })?);
    }
    let mut of_lines = Vec::with_capacity(geometry.wire.points.len() * attribute.formulas.len());
    for point in &geometry.wire.points {
        let place = point.position;
        of_lines.extend(at(At { place, normal: DVec3::ZERO, uv: DVec2::ZERO, weight: 0.0 })?);
    }
    Ok(VertexAttribute {
        name: attribute.name.clone(),
        width: attribute.formulas.len(),
        bytes: attribute.bytes,
        values,
        of_lines,
    })
}

fn weight_of(influences: &Influences, joint: usize) -> f64 {
    influences
        .iter()
        .filter(|one| usize::from(one.joint) == joint)
        .map(|one| f64::from(one.weight) / 255.0)
        .sum()
}

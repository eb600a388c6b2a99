//! The proof that the states of a geometry can be written.

use super::SceneError;
use crate::scene::{Geometry, MorphTarget, Scene};

pub(super) fn check(scene: &Scene, geometry: &Geometry) -> Result<(), SceneError> {
    geometry.targets.iter().try_for_each(|target| {
        check_target(scene, geometry, target)
            .map_err(|what| SceneError::Morph(geometry.name.clone(), target.name.clone(), what))
    })
}

fn check_target(scene: &Scene, geometry: &Geometry, target: &MorphTarget) -> Result<(), &'static str> {
    let mesh = &geometry.mesh;
    if !geometry.wire.is_empty() {
        return Err("lines, which have no states");
    }
    if target.points.len() != mesh.points.len() || target.normals.len() != mesh.vertices.len() {
        return Err("another number of points or vertices than its shape");
    }
    let limit = f64::from(f32::MAX) / 2.0;
    if !target.points.iter().all(|point| point.abs().max_element() <= limit) {
        return Err("a coordinate that is not finite or beyond single precision");
    }
    if !target.normals.iter().all(|normal| (normal.length_squared() - 1.0).abs() < 1e-6) {
        return Err("a normal that is not of unit length");
    }
    let whole = |tangents: &Vec<[f32; 3]>| {
        let unit = |[x, y, z]: &[f32; 3]| (x * x + y * y + z * z - 1.0).abs() < 1e-4;
        tangents.len() == mesh.vertices.len() && tangents.iter().all(unit)
    };
    if target.tangents.is_some() != geometry.tangents.is_some() || !target.tangents.iter().all(whole) {
        return Err("tangents that its shape does not have, or that are not of unit length");
    }
    let on_grid = scene.grid.is_none_or(|grid| {
        target.points.iter().all(|point| {
            let steps = (*point - grid.offset) / grid.step;
            steps == steps.round()
        })
    });
    if !on_grid {
        return Err("a coordinate that is not on the grid of the model");
    }
    if target.weight.abs() <= limit { Ok(()) } else { Err("a weight that is not finite") }
}

//! What a motion is judged by: nodes in trees, with points that are watched.

use glam::{DAffine3, DVec3, DVec4};

use super::morphed::MorphedBox;
use super::track::Path;
use super::transform::Transform;

/// What moves: nodes in trees, with points that are watched.
#[derive(Clone, Debug)]
pub struct Rig {
    /// For each node its parent.
    pub parents: Vec<Option<usize>>,
    /// For each node its place at rest.
    pub rest: Vec<Transform>,
    /// For each node points in its space.
    pub points: Vec<Vec<DVec3>>,
    /// For each node the weights of the morph targets of its mesh at rest.
    pub weights: Vec<Vec<f64>>,
    /// Points that morph.
    pub morphed: Vec<MorphedBox>,
}

/// Nodes with parents first.
pub(super) fn order(rig: &Rig) -> Vec<usize> {
    let mut order = Vec::with_capacity(rig.parents.len());
    let mut placed = vec![false; rig.parents.len()];
    for start in 0..rig.parents.len() {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(node) = next.filter(|node| !placed[*node]) {
            placed[node] = true;
            chain.push(node);
            next = rig.parents[node];
        }
        order.extend(chain.into_iter().rev());
    }
    order
}

/// The value of a place at rest.
pub(super) fn rest_value(rest: &Transform, path: Path) -> DVec4 {
    match path {
        Path::Translation => rest.translation.extend(0.0),
        Path::Rotation => DVec4::from(rest.rotation),
        Path::Scale => rest.scale.extend(0.0),
        Path::Weight => DVec4::ZERO,
    }
}

pub(super) fn places(points: &[Vec<DVec3>], worlds: &[DAffine3]) -> Vec<DVec3> {
    let of = |(points, world): (&Vec<DVec3>, &DAffine3)| {
        points.iter().map(|point| world.transform_point3(*point)).collect::<Vec<_>>()
    };
    points.iter().zip(worlds).flat_map(of).collect()
}

/// For each node the greatest distance of a point that it carries from its origin, metres: over its own points, and
/// for those of nodes below by the triangle inequality.
pub(super) fn reaches(rig: &Rig, points: &[Vec<DVec3>], order: &[usize], worlds: &[DAffine3]) -> Vec<f64> {
    let mut reach = vec![0.0_f64; worlds.len()];
    for node in order.iter().rev() {
        let origin = worlds[*node].translation;
        for point in &points[*node] {
            reach[*node] = reach[*node].max(worlds[*node].transform_point3(*point).distance(origin));
        }
        if let Some(parent) = rig.parents[*node] {
            reach[parent] = reach[parent].max(reach[*node] + worlds[parent].translation.distance(origin));
        }
    }
    reach
}

pub(super) fn stretch(map: &DAffine3) -> f64 {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    columns.iter().map(|column| column.length()).fold(0.0, f64::max)
}

pub(super) fn least_factor(map: &DAffine3) -> f64 {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    columns.iter().map(|column| column.length()).fold(f64::INFINITY, f64::min).max(1e-6)
}

//! Colliders: what they are and that they hold what they stand for.

use glam::{DAffine3, DVec3};
use indexmap::IndexMap;
use serde::Serialize;

use super::ShapeFacts;
use crate::geometry::mesh::distance::Sheet;
use crate::gltf::{Geometry, Indices, Read, Written};
use crate::scene::{Body, Collider};

/// A collider of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ColliderFacts {
    /// What body it is.
    pub body: &'static str,
    /// The shape that it stands for.
    pub of: String,
    /// The node that it moves with.
    pub node: String,
    /// Whether it is the shape itself, and no body around it.
    pub exact: bool,
    /// Cubic metres.
    pub volume: f64,
    /// Corners of a hull, or of all parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices: Option<usize>,
    /// How far the farthest written vertex of the shape is outside of it, metres; none where the file has no mesh of the shape.
    pub outside: Option<f64>,
    /// Of several convex parts what else there is to say.
    #[serde(flatten)]
    pub parts: Option<PartsFacts>,
}

/// Several convex parts that stand for a shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PartsFacts {
    /// How many.
    pub parts: usize,
    /// The greatest distance from convex of what a part stands for, as it was made, metres.
    pub concavity: f64,
    /// The volume of all parts over that of the written shape; none where the file has no closed mesh of it.
    pub volume_ratio: Option<f64>,
    /// How far the farthest point of a part is outside of the written shape, metres, within a twentieth of the allowed
    /// concavity and never less than it is; none where the file has no closed mesh of it.
    pub beyond: Option<f64>,
}

/// The colliders of a file, by their names.
pub(super) fn colliders(
    file: &Read<'_>,
    written: &Written,
    shapes: &IndexMap<String, ShapeFacts>,
) -> IndexMap<String, ColliderFacts> {
    let whole = |collider: &Collider| collider.part.as_ref().map(|part| part.of.clone());
    let alike = |a: &Collider, b: &Collider| whole(a).is_some() && whole(a) == whole(b);
    written.colliders.chunk_by(alike).map(|bodies| of_bodies(file, written, shapes, bodies)).collect()
}

fn of_bodies(
    file: &Read<'_>,
    written: &Written,
    shapes: &IndexMap<String, ShapeFacts>,
    bodies: &[Collider],
) -> (String, ColliderFacts) {
    let first = &bodies[0];
    let shape = written.geometries.iter().find(|geometry| geometry.name == first.shape);
    let geometry = shape.map(|shape| &file.geometries[shape.mesh()]);
    let maps: Vec<DAffine3> = bodies
        .iter()
        .map(|body| DAffine3::from_rotation_translation(body.rotation, body.translation).inverse())
        .collect();
    let outside = geometry.map(|geometry| {
        let surface = (0..geometry.positions.len()).map(|vertex| geometry.position(vertex));
        let away = |place: [f32; 3]| {
            let place = DVec3::from_array(place.map(f64::from));
            let of = |(body, map): (&Collider, &DAffine3)| outside(&body.body, map.transform_point3(place));
            bodies.iter().zip(&maps).map(of).fold(f64::INFINITY, f64::min)
        };
        surface.chain(geometry.lines.positions.iter().copied()).map(away).fold(0.0, f64::max)
    });
    let volume = bodies.iter().map(|body| body.body.volume()).sum();
    let corners = |body: &Collider| match &body.body {
        Body::Hull { points, .. } => Some(points.len()),
        _ => None,
    };
    let parts = first.part.as_ref().map(|part| {
        let enclosed = shapes.get(&first.shape).filter(|shape| shape.facts.closed);
        let enclosed = enclosed.and_then(|shape| shape.facts.volume).filter(|volume| *volume > 0.0);
        PartsFacts {
            parts: bodies.len(),
            concavity: bodies
                .iter()
                .filter_map(|body| body.part.as_ref())
                .map(|part| part.concavity)
                .fold(0.0, f64::max),
            volume_ratio: enclosed.map(|enclosed| volume / enclosed),
            beyond: enclosed
                .and(geometry)
                .and_then(sheet)
                .map(|shape| beyond(bodies, &shape, part.allowed / 20.0)),
        }
    });
    let facts = ColliderFacts {
        body: if parts.is_some() { "parts" } else { first.body.kind() },
        of: first.shape.clone(),
        node: file.root.nodes[first.node].name.clone().unwrap_or_default(),
        exact: first.exact,
        volume,
        vertices: bodies.iter().map(corners).sum(),
        outside,
        parts,
    };
    (first.part.as_ref().map_or(&first.name, |part| &part.of).clone(), facts)
}

/// The written triangles of a mesh.
fn sheet(geometry: &Geometry<'_>) -> Option<Sheet> {
    let points = (0..geometry.positions.len())
        .map(|vertex| DVec3::from_array(geometry.position(vertex).map(f64::from)));
    let indices: Vec<u32> = match &geometry.indices {
        Indices::Short(indices) => indices.iter().map(|index| u16::from_le_bytes(*index).into()).collect(),
        Indices::Long(indices) => indices.iter().map(|index| u32::from_le_bytes(*index)).collect(),
    };
    Sheet::new(
        points.collect(),
        indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
    )
}

/// How far the farthest point of some hulls is outside of a shape.
fn beyond(bodies: &[Collider], shape: &Sheet, accuracy: f64) -> f64 {
    let of = |body: &Collider| {
        let (points, triangles) = body.body.triangles();
        Sheet::new(points, triangles).map_or(0.0, |body| body.farthest_outside(shape, accuracy).at_most)
    };
    bodies.iter().map(of).fold(0.0, f64::max)
}

/// How far a point is outside of a body; 0 inside. Of a hull how far above the plane of a face.
fn outside(body: &Body, point: DVec3) -> f64 {
    let away = match body {
        Body::Box { size } => (point.abs() - *size / 2.0).max_element(),
        Body::Sphere { radius } => point.length() - radius,
        Body::Capsule { radius, height } => {
            let along = point.y.clamp(-height / 2.0, height / 2.0);
            (point - DVec3::Y * along).length() - radius
        }
        Body::Cylinder { radius, height } => {
            let across = DVec3::new(point.x, 0.0, point.z).length() - radius;
            across.max(point.y.abs() - height / 2.0)
        }
        Body::Hull { points, triangles } => {
            let above = |[a, b, c]: &[u32; 3]| {
                let [a, b, c] = [a, b, c].map(|corner| points[*corner as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                (point - a).dot(normal)
            };
            triangles.iter().map(above).fold(f64::NEG_INFINITY, f64::max)
        }
    };
    away.max(0.0)
}

//! Colliders: what they are and that they hold what they stand for.

use glam::{DAffine3, DVec3};
use indexmap::IndexMap;
use serde::Serialize;

use crate::gltf::{Read, Written};
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
    /// Corners of a hull.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices: Option<usize>,
    /// How far the farthest written vertex of the shape is outside of it, metres; none where the file has no mesh of the shape.
    pub outside: Option<f64>,
}

/// The colliders of a file, by their names.
pub(super) fn colliders(file: &Read<'_>, written: &Written) -> IndexMap<String, ColliderFacts> {
    let facts = |collider: &Collider| {
        let shape = written.geometries.iter().find(|geometry| geometry.name == collider.shape);
        let map = DAffine3::from_rotation_translation(collider.rotation, collider.translation).inverse();
        let outside = shape.map(|shape| {
            let geometry = &file.geometries[shape.mesh];
            let surface = (0..geometry.positions.len()).map(|vertex| geometry.position(vertex));
            let all = surface.chain(geometry.lines.positions.iter().copied());
            let place = |place: [f32; 3]| map.transform_point3(DVec3::from_array(place.map(f64::from)));
            all.map(|vertex| outside(&collider.body, place(vertex))).fold(0.0, f64::max)
        });
        let facts = ColliderFacts {
            body: collider.body.kind(),
            of: collider.shape.clone(),
            node: file.root.nodes[collider.node].name.clone().unwrap_or_default(),
            exact: collider.exact,
            volume: collider.body.volume(),
            vertices: match &collider.body {
                Body::Hull { points, .. } => Some(points.len()),
                _ => None,
            },
            outside,
        };
        (collider.name.clone(), facts)
    };
    written.colliders.iter().map(facts).collect()
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

//! Lightmaps: how dense they are, and that no two places share one.

use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::geometry::mesh::overlap::overlaps;
use crate::gltf::Geometry;
use crate::model::LightmapOptions;

/// How deep triangles that share a side may overlap by rounding: a step of 16 bits.
const ROUNDING: f64 = 1.0 / 65535.0;

/// The second texture coordinates of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LightmapFacts {
    /// Texels of a side of the picture.
    pub size: u32,
    /// The part of the picture that triangles cover.
    pub filled: f64,
    /// Texels for a metre, over the whole surface.
    pub density: f64,
    /// The least texels for a metre of a triangle.
    pub least_density: f64,
    /// The greatest texels for a metre of a triangle.
    pub greatest_density: f64,
    /// Pairs of triangles that lie on each other by more than rounding.
    pub overlaps: usize,
}

/// Measures what a file has of it.
pub(super) fn lightmap(geometry: &Geometry<'_>, asked: LightmapOptions) -> Option<LightmapFacts> {
    let second = geometry.second.as_ref()?;
    let places: Vec<DVec2> = second.iter().map(|place| DVec2::from_array(place.map(f64::from))).collect();
    let triangles: Vec<[u32; 3]> = (0..geometry.indices.len() / 3)
        .map(|k| [0, 1, 2].map(|corner| geometry.indices.at(3 * k + corner)))
        .collect();
    let side = f64::from(asked.size);
    let (mut area, mut covered, mut least, mut greatest) = (0.0, 0.0, f64::INFINITY, 0.0_f64);
    for corners in &triangles {
        let position = |corner: u32| DVec3::from_array(geometry.position(corner as usize).map(f64::from));
        let [a, b, c] = corners.map(position);
        let [p, q, r] = corners.map(|corner| places[corner as usize]);
        let (own, laid) = ((b - a).cross(c - a).length() / 2.0, (q - p).perp_dot(r - p).abs() / 2.0);
        area += own;
        covered += laid;
        // What is laid out as a line has no density.
        if own > 0.0 && laid > ROUNDING * ROUNDING {
            let density = side * (laid / own).sqrt();
            (least, greatest) = (least.min(density), greatest.max(density));
        }
    }
    Some(LightmapFacts {
        size: asked.size,
        filled: covered,
        density: if area > 0.0 { side * (covered / area).sqrt() } else { 0.0 },
        least_density: if least.is_finite() { least } else { 0.0 },
        greatest_density: greatest,
        overlaps: overlaps(&places, &triangles, ROUNDING),
    })
}

//! What is baked into vertices once surfaces are triangles: what hides the sky, and places on a lightmap.

use super::{Made, Surfaces, place};
use crate::geometry::mesh::Color;
use crate::geometry::mesh::occlusion::{Sky, occlusion};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::model::{Occlusion, ShapeHandle};
use crate::optimize::lay_out;
use crate::scene::Geometry;

/// The most lines of sight of all shapes together.
const MOST_LINES: u64 = 1 << 28;

/// Darkens colors and lays out lightmaps, of all levels.
///
/// # Errors
/// More lines of sight than the limit; shapes that cannot be laid out.
pub(super) fn bake(made: &Made<'_>, surfaces: &mut Surfaces) -> Result<(), Vec<Diagnostic>> {
    let model = &made.built.model;
    let realized = &mut surfaces.realized;
    let asked = |shape: &ShapeHandle| model.shape(*shape).options.occlusion;
    let lines = |(geometry, shape): (&Geometry, &ShapeHandle)| {
        let samples = asked(shape).map_or(0, |asked| u64::from(asked.samples));
        geometry.mesh.vertices.len() as u64 * samples
    };
    let mut total: u64 = 0;
    for (geometry, shape) in realized.scene.geometries.iter().zip(&realized.shapes) {
        total = total.saturating_add(lines((geometry, shape)));
        if total > MOST_LINES {
            let message = format!(
                "occlusion of shape `{}` brings lines of sight to {total}, and the limit is {MOST_LINES}",
                geometry.name
            );
            return Err(vec![
                Diagnostic::error(Code::LimitPassed, message)
                    .at(place(made.built, *shape), "this shape")
                    .help("write fewer `samples`, or a coarser `tolerance`"),
            ]);
        }
    }
    let mut failed = Vec::new();
    for (geometry, shape) in realized.scene.geometries.iter_mut().zip(&realized.shapes) {
        if let Some(asked) = asked(shape) {
            darken(geometry, &asked, model.frame.unit);
        }
        let Some(map) = model.shape(*shape).options.lightmap.filter(|_| !geometry.mesh.triangles.is_empty())
        else {
            continue;
        };
        if let Err(fault) = lay_out(geometry, (map.size, map.padding)) {
            let message = format!("shape `{}` has no lightmap: it {fault}", geometry.name);
            failed.push(
                Diagnostic::error(Code::NoLightmap, message)
                    .at(place(made.built, *shape), "this shape")
                    .help("write a greater `size`, less `padding`, or a coarser `tolerance`"),
            );
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed) }
}

fn darken(geometry: &mut Geometry, asked: &Occlusion, unit: f64) {
    let distance = asked.distance.map_or(f64::INFINITY, |distance| distance * unit);
    let sky = Sky { samples: asked.samples, distance, seed: asked.seed };
    let hidden = occlusion(&geometry.mesh, &sky);
    for (vertex, share) in geometry.mesh.vertices.iter_mut().zip(hidden) {
        let left = 1.0 - asked.strength * share;
        vertex.color = vertex.color.times(Color::held([left, left, left, 1.0]));
    }
    geometry.colored = true;
}

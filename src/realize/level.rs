//! Levels of detail: the same surfaces, coarser.
//!
//! Promise: a level has the origins, texture coordinates and kinds of seams of the finest one, and its points are carried by the
//! joints that carry the nearest points of that. The states of a shape that morphs are cut again together with it. Not promised:
//! that it has fewer triangles, or that parts stay apart.

use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use super::limit::Cost;
use super::material::grouped;
use super::shape::{self, Made, Maker};
use super::{Options, RealizeError, Realized, morph};
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::nearest::Nearest;
use crate::model::{MaterialHandle, Model, ShapeHandle};
use crate::motion::{Influences, weights_of};
use crate::scene::Geometry;

/// A level of every geometry of a scene, in their order; `None` for one that cannot be made so coarsely.
#[must_use]
pub fn level(model: &Model, options: &Options<'_>, finest: &Realized) -> Vec<Option<Geometry>> {
    let maker = Maker::new(model, options);
    let make = |index: usize| {
        let geometry = &finest.scene.geometries[index];
        let finished = |maker: &Maker<'_>, handle: ShapeHandle| {
            let mut made = maker.make(handle, geometry.uv)?;
            shape::to_metres(&mut made, &model.frame);
            Ok(grouped(made, options.apart))
        };
        let shape = finest.shapes[index];
        let made = finished(&maker, shape).ok()?;
        let (made, targets) = morph::morphed((model, shape), options, made, &finished).ok()?;
        let made = with_origins(made, &finest.materials[index], options.apart)?;
        let influences = geometry.influences.as_ref();
        let influences = influences.map(|finest| carried(&made.mesh, &geometry.mesh, finest));
        Some(Geometry {
            name: geometry.name.clone(),
            uv: geometry.uv,
            colored: geometry.colored,
            tolerance: made.tolerance,
            deviation: made.deviation,
            parts: geometry.parts.clone(),
            mesh: made.mesh,
            wire: made.wire,
            tangents: None,
            lightmap: None,
            attributes: Vec::new(),
            influences,
            targets,
        })
    };
    let all = 0..finest.shapes.len();
    if all.len() == 1 { all.map(make).collect() } else { all.into_par_iter().map(make).collect() }
}

/// Refuses levels that pass the limits together.
///
/// # Errors
/// The limit that is passed.
pub fn within_limits<'a>(
    model: &Model,
    geometries: impl IntoIterator<Item = &'a Geometry>,
) -> Result<(), RealizeError> {
    let cost = |geometry: &Geometry| {
        let own = Cost::of(&geometry.mesh).plus(Cost::of_wire(&geometry.wire));
        own.with_states(&geometry.mesh, geometry.targets.len() as u64)
    };
    geometries.into_iter().map(cost).fold(Cost::default(), Cost::plus).check(&model.limits)
}

/// A shape whose origins count as those of the finest level; `None` where it shows a material that this does not, or has other
/// parts where these stay apart.
fn with_origins(mut made: Made, materials: &[Option<MaterialHandle>], apart: bool) -> Option<Made> {
    if apart {
        return (made.materials == materials).then_some(made);
    }
    let place = |material: &Option<MaterialHandle>| materials.iter().position(|known| known == material);
    let names: Vec<Option<u32>> =
        made.materials.iter().map(|material| place(material).map(crate::geometry::mesh::index)).collect();
    for run in &mut made.mesh.runs {
        run.origin = names[run.origin as usize]?;
    }
    for strand in &mut made.wire.strands {
        strand.origin = names[strand.origin as usize]?;
    }
    Some(made)
}

/// The joints that carry the points of a mesh: what carries the nearest place of another.
fn carried(mesh: &Mesh, finest: &Mesh, influences: &[Influences]) -> Vec<Influences> {
    let nearest = Nearest::new(finest);
    let joints = influences.iter().flatten().map(|one| usize::from(one.joint) + 1).max().unwrap_or(0);
    let weights = weights_of(&mesh.points, joints, |point, weights| {
        let Some(found) = nearest.find(point) else { return };
        for (corner, part) in finest.triangles[found.triangle].iter().zip(found.weights) {
            let carrier = finest.vertices[corner.subscript()].point;
            for one in influences[carrier.subscript()] {
                weights[usize::from(one.joint)] += part * f64::from(one.weight);
            }
        }
    });
    weights.written()
}

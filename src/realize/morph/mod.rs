//! A shape and its states on one triangulation.
//!
//! The shape and each of its states are made by themselves first. Where their triangles correspond, as those of
//! polygons, cages and fixed grids do, they are taken as they are. Otherwise one of the meshes is the plan for all: its
//! points are put on the other surfaces at the same parameters, or on the same rays, and how far its triangles then are from each surface is
//! measured by dense samples. The plan is the mesh of the fewest triangles that is within the tolerance of every state;
//! where none is, all are made finer and tried again.
//!
//! Promise: the triangles of all states are those of the shape, and points that triangles share are shared in every
//! state. Not promised: that what lies between two states is near to any surface.

mod carry;
mod cast;
mod chart;

use carry::{Carried, carry, same_polygons};

use super::shape::{Made, Maker};
use super::source::{Sources, sources};
use super::{Level, Options, RealizeError};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::{Deviation, Evidence};
use crate::model::{Model, Morph, ShapeHandle, State};
use crate::scene::MorphTarget;

/// How often tolerances are halved before the best that was found must do.
const ROUNDS: u32 = 5;

/// What the greatest of the samples is multiplied by for what lies between them.
const MARGIN: f64 = 1.1;

/// A shape or a state of it, made by itself.
struct Member<'m> {
    model: &'m Model,
    shape: ShapeHandle,
    made: Made,
}

/// All of them on the plan of one.
struct Planned {
    plan: usize,
    all: Vec<Carried>,
    /// The greatest deviation as a share of its tolerance.
    worst: f64,
}

/// Makes the mesh of a shape, its placement and frame applied.
type Make<'f> = dyn Fn(&Maker<'_>, ShapeHandle) -> Result<Made, RealizeError> + 'f;

/// A shape with its states; `made` is what it is by itself.
pub(super) fn morphed(
    (model, shape): (&Model, ShapeHandle),
    options: &Options<'_>,
    made: Made,
    make: &Make<'_>,
) -> Result<(Made, Vec<MorphTarget>), RealizeError> {
    let morphs: Vec<&Morph> = model.morphs_of(shape).collect();
    if morphs.is_empty() {
        return Ok((made, Vec::new()));
    }
    if !made.wire.is_empty() {
        return Err(RealizeError::MorphedWire);
    }
    let mut made = Some(made);
    let mut best: Option<(Vec<Member<'_>>, Planned)> = None;
    for round in 0..=ROUNDS {
        let finer = 1.0 / f64::from(1_u32 << round);
        let mut members = members((model, shape), &morphs, (options, finer, 0), made.take(), make)?;
        // Cages are refined equally often.
        let levels = members.iter().map(|member| member.made.levels).max().unwrap_or(0);
        if members.iter().any(|member| member.made.levels < levels) {
            members = self::members((model, shape), &morphs, (options, finer, levels), None, make)?;
        }
        let planned = planned(&members, &morphs)?;
        let good = planned.worst <= 1.0;
        if best.as_ref().is_none_or(|(_, known)| planned.worst < known.worst) {
            best = Some((members, planned));
        }
        if good {
            break;
        }
    }
    let Some((members, planned)) = best else { return Err(RealizeError::MorphedWire) };
    Ok(finished(members, planned, &morphs))
}

fn members<'m>(
    (model, shape): (&'m Model, ShapeHandle),
    morphs: &[&Morph],
    (options, finer, levels): (&Options<'_>, f64, u32),
    made: Option<Made>,
    make: &Make<'_>,
) -> Result<Vec<Member<'m>>, RealizeError> {
    let coarser = if options.coarser > 0.0 { options.coarser } else { 1.0 };
    let level = Level { least: options.level.least * finer, ..options.level };
    let options = Options { coarser: coarser * finer, level, ..*options };
    // What is made finer than it must be is held to what was asked for.
    let held = |mut made: Made| {
        made.tolerance = made.tolerance.map(|tolerance| tolerance / finer);
        made
    };
    let maker = Maker::new(model, &options).with_levels(levels);
    let base = match made {
        Some(made) => made,
        None => held(make(&maker, shape)?),
    };
    let mut all = vec![Member { model, shape, made: base }];
    for morph in morphs {
        let (model, shape) = match morph.state {
            State::Shape(shape) => (model, shape),
            State::Other { model: other, shape } => (&model.states[other], shape),
        };
        let made = make(&Maker::new(model, &options).with_levels(levels), shape);
        let made = made.map_err(|error| of_state(morph, error))?;
        all.push(Member { model, shape, made: held(made) });
    }
    Ok(all)
}

fn of_state(morph: &Morph, error: RealizeError) -> RealizeError {
    RealizeError::State { state: morph.name.clone(), error: Box::new(error) }
}

/// All members on the plan that is good enough for them with the fewest triangles, or else on the one that is the best.
fn planned(members: &[Member<'_>], morphs: &[&Morph]) -> Result<Planned, RealizeError> {
    let surfaces: Vec<Sources> = members.iter().map(|member| sources(member.model, member.shape)).collect();
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by_key(|member| members[*member].made.mesh.triangles.len());
    let base = (members[0].model, members[0].shape);
    if members.iter().all(|member| same_polygons(base, (member.model, member.shape))) {
        // Faces that have no area in some state are there in others.
        order.reverse();
    }
    let mut best: Option<Planned> = None;
    let mut fault = None;
    for plan in order {
        let on_plan = |other: usize| {
            let (from, to) = (&members[plan], &members[other]);
            if plan == other {
                return Ok(Carried::own(&from.made));
            }
            carry((from, &surfaces[plan]), (to, &surfaces[other])).ok_or(other)
        };
        match (0..members.len()).map(on_plan).collect::<Result<Vec<Carried>, usize>>() {
            Ok(all) => {
                let share = |(carried, member): (&Carried, &Member<'_>)| {
                    member.made.tolerance.map_or(0.0, |tolerance| carried.deviation.bound / tolerance)
                };
                // What a shape is by itself is no better for its states.
                let own = members.iter().map(|member| share((&Carried::own(&member.made), member)));
                let shares = all.iter().zip(members).map(share).zip(own);
                let worst =
                    shares.map(|(share, own)| if share <= own { 0.0 } else { share }).fold(0.0, f64::max);
                if best.as_ref().is_none_or(|known| worst < known.worst) {
                    best = Some(Planned { plan, all, worst });
                }
                if worst <= 1.0 {
                    break;
                }
            }
            Err(other) => fault = fault.or(Some((plan, other))),
        }
    }
    best.ok_or_else(|| {
        let (plan, other) = fault.unwrap_or_default();
        let counts = |member: &Member<'_>| (member.made.mesh.points.len(), member.made.mesh.triangles.len());
        let state = if other == 0 { plan } else { other };
        RealizeError::Topology {
            state: morphs[state.saturating_sub(1)].name.clone(),
            found: counts(&members[state]),
            wanted: counts(&members[0]),
        }
    })
}

fn finished(members: Vec<Member<'_>>, planned: Planned, morphs: &[&Morph]) -> (Made, Vec<MorphTarget>) {
    let tolerances: Vec<Option<f64>> = members.iter().map(|member| member.made.tolerance).collect();
    let notes = members[0].made.notes.clone();
    let mut all = planned.all.into_iter();
    let base = all.next().unwrap_or_default();
    // Materials are those of the shape: runs of equal meshes correspond.
    let materials = members[0].made.materials.clone();
    let mut made = members.into_iter().nth(planned.plan).map_or_else(Made::empty, |member| member.made);
    if planned.plan != 0 {
        made.mesh.points = base.points;
        for ((vertex, normal), anchor) in made.mesh.vertices.iter_mut().zip(base.normals).zip(base.anchors) {
            (vertex.normal, vertex.anchor) = (normal, anchor);
        }
        (made.deviation, made.tolerance, made.materials) = (base.deviation, tolerances[0], materials);
    }
    made.notes = notes;
    let targets = all.zip(morphs).zip(&tolerances[1..]).map(|((carried, morph), tolerance)| MorphTarget {
        name: morph.name.clone(),
        weight: morph.weight,
        points: carried.points,
        normals: carried.normals,
        tangents: None,
        deviation: carried.deviation,
        tolerance: *tolerance,
    });
    let targets = targets.collect();
    (made, targets)
}

/// The deviation of a mesh that was put on another surface, by what samples found.
fn sampled(found: f64, bounds: &Bounds) -> Deviation {
    // Below this nothing but rounding is left.
    let rounding = 1e-12 * bounds.diagonal();
    Deviation::new(if found <= rounding { 0.0 } else { found * MARGIN }, Evidence::Sampled)
}

//! Levels of detail: which are asked for, how each is made, and which are kept.
//!
//! A level is the surfaces cut again, more coarsely. It counts when it has fewer triangles than the one before, is closed where
//! the finest is, with as many parts and holes, and keeps its tolerance; else triangles of the level before are taken away, and
//! where that does not count either, there is no such level.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::{Made, Surfaces, place};
use crate::build::Built;
use crate::geometry::mesh;
use crate::geometry::mesh::topology::{Topology, measure};
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::number::{Bounds, single_rounding};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{Lod, LodForm};
use crate::model::ShapeHandle;
use crate::motion::Path;
use crate::optimize::decimated;
use crate::realize::{self, Level};
use crate::scene::{Channel, Geometry, LevelForm, LevelSource, LevelUse, MeshUse, Node, Scene};

/// A level has at most this part of the triangles of the one before.
const FEWER: f64 = 0.9;

/// How much coarser each level is than the one before, where their number is all that is said: triangles come to a fourth.
const STEP: f64 = 4.0;

/// Meshes of fewer triangles need no levels: nothing is said where they have none.
const FEW: usize = 200;

/// The picture that coverage is told for: lines, and pixels of a line for each of them.
const LINES: f64 = 1080.0;
const ASPECT: f64 = 16.0 / 9.0;

/// The levels beside the finest, where a part of the tolerance is kept for surfaces.
fn levels(lod: &Lod, kept: f64) -> Vec<Level> {
    if let Some(tolerances) = &lod.tolerances {
        let level = |(number, tolerance): (u32, &f64)| Level { number, factor: 1.0, least: tolerance * kept };
        return (1..).zip(&tolerances.value).map(level).collect();
    }
    let count = lod.levels.map_or(1, |levels| levels.value);
    let factors = (1..count).scan(1.0, |factor, number| {
        *factor *= STEP;
        Some(Level { number, factor: *factor, least: 0.0 })
    });
    factors.collect()
}

/// How a level that counts was made.
struct Kept {
    geometry: Geometry,
    source: LevelSource,
}

/// Adds to the surfaces of a document the levels that it asks for, after all that there is; returns what there is to say.
///
/// # Errors
/// When all levels together pass a limit.
pub(super) fn add(made: &Made<'_>, surfaces: &mut Surfaces) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
    let (built, Some(lod)) = (made.built, &made.spec.lod) else { return Ok(Vec::new()) };
    let realized = &mut surfaces.realized;
    let kept = 1.0 - surfaces.share;
    let levels = levels(&lod.value, kept);
    let mut chains: Vec<Vec<Kept>> = realized.shapes.iter().map(|_| Vec::new()).collect();
    let mut asked = vec![0; chains.len()];
    for level in &levels {
        let options = realize::Options { coarser: kept, level: *level, memo: made.memo, apart: made.apart() };
        let made = realize::level(&built.model, &options, realized);
        for (index, coarse) in made.into_iter().enumerate() {
            let finest = &realized.scene.geometries[index];
            let before = chains[index].last().map_or(finest, |kept| &kept.geometry);
            let allowed = allowed(built, finest, level, kept);
            // What is as coarse by itself has no such level.
            asked[index] += usize::from(finest.tolerance.is_none_or(|own| allowed > own));
            let coarse = coarse.map(|coarse| {
                let whole = |tolerance: Option<f64>| tolerance.map(|tolerance| tolerance / kept);
                let mut coarse = Geometry { tolerance: whole(coarse.tolerance), ..coarse };
                coarse.targets.iter_mut().for_each(|state| state.tolerance = whole(state.tolerance));
                coarse
            });
            if let Some(next) = next(finest, before, coarse, (allowed, kept)) {
                chains[index].push(next);
            }
        }
        let all = chains.iter().flatten().map(|kept| &kept.geometry).chain(&realized.scene.geometries);
        realize::within_limits(&built.model, all).map_err(|error| {
            let shape = realized.shapes.first().copied().unwrap_or(ShapeHandle(0));
            vec![super::refusal(built, shape, &error)]
        })?;
    }
    let said = (0..chains.len()).filter_map(|index| {
        let (shape, finest) = (realized.shapes[index], &realized.scene.geometries[index]);
        fewer(built, shape, finest, (chains[index].len(), asked[index]))
    });
    let said = said.collect();
    for (index, chain) in chains.into_iter().enumerate() {
        for kept in chain {
            realized.shapes.push(realized.shapes[index]);
            realized.materials.push(realized.materials[index].clone());
            push(&mut realized.scene, index, kept);
        }
    }
    Ok(said)
}

/// What a level may be off by, metres.
fn allowed(built: &Built, finest: &Geometry, level: &Level, kept: f64) -> f64 {
    let unit = built.model.frame.unit;
    let own = finest.tolerance.or_else(|| built.model.tolerance.map(|tolerance| tolerance * unit));
    let own = own.unwrap_or_else(|| bounds(finest).diagonal() / 2000.0);
    (own * level.factor).max(level.least * unit / kept)
}

/// The next level: the surface cut more coarsely, or triangles taken away from the one before.
fn next(
    finest: &Geometry,
    before: &Geometry,
    coarse: Option<Geometry>,
    (allowed, kept): (f64, f64),
) -> Option<Kept> {
    let counts = |level: &Geometry| {
        let rounding = single_rounding(level.bounds().reach());
        let within = |(bound, tolerance): (f64, Option<f64>)| {
            tolerance.is_none_or(|tolerance| bound + rounding <= tolerance * kept * (1.0 + 1e-9))
        };
        let states = level.targets.iter().map(|state| (state.deviation.bound, state.tolerance));
        size(level) <= FEWER * size(before)
            && std::iter::once((level.deviation.bound, level.tolerance)).chain(states).all(within)
            && is_alike(finest, level)
    };
    if let Some(geometry) = coarse.filter(counts) {
        return Some(Kept { geometry, source: LevelSource::Surface });
    }
    let room = allowed * kept - single_rounding(bounds(finest).reach());
    let few = decimated(before, finest, room)?;
    let geometry = Geometry { tolerance: Some(allowed), ..few };
    counts(&geometry).then_some(Kept { geometry, source: LevelSource::Triangles })
}

/// What is drawn of a geometry: triangles and segments.
fn size(geometry: &Geometry) -> f64 {
    (geometry.mesh.triangles.len() + geometry.wire.points.len()) as f64
}

fn bounds(geometry: &Geometry) -> Bounds {
    geometry.mesh.bounds().union(geometry.wire.bounds())
}

/// Whether a level is closed where another is, in as many parts with as many holes, as written in single precision.
fn is_alike(finest: &Geometry, level: &Geometry) -> bool {
    let of = |geometry: &Geometry| {
        let known = topology(geometry)?;
        Some((known.closed, known.manifold, known.components, known.euler, known.boundary_loops))
    };
    of(finest) == of(level) && finest.wire.strands.len() == level.wire.strands.len()
}

fn topology(geometry: &Geometry) -> Option<Topology> {
    let mesh = &geometry.mesh;
    let rounded: Vec<_> = mesh.points.iter().map(|point| point.as_vec3().as_dvec3()).collect();
    let welded = weld_equal(&rounded);
    let point = |corner: usize| {
        let vertex = mesh.triangles[corner / 3][corner % 3];
        welded.map[mesh.vertices[vertex.subscript()].point.subscript()]
    };
    measure(mesh.triangles.len(), welded.points.len(), point).ok()
}

/// Adds a level of a geometry, and a mesh for each that shows it.
fn push(scene: &mut Scene, finest: usize, level: Kept) {
    let geometry = scene.geometries.len();
    let shows: Vec<usize> =
        (0..scene.meshes.len()).filter(|mesh| scene.meshes[*mesh].geometry == finest).collect();
    let mut name = String::new();
    for index in shows {
        let mesh = scene.meshes.len();
        let shown = &mut scene.meshes[index];
        if shown.levels.is_empty() {
            shown.levels.push(LevelUse {
                number: 0,
                mesh: index,
                source: LevelSource::Finest,
                coverage: 1.0,
            });
        }
        let number = mesh::index(shown.levels.len());
        shown.levels.push(LevelUse { number, mesh, source: level.source, coverage: 1.0 });
        let materials = shown.materials.clone();
        let coarser =
            MeshUse { name: level_name(&shown.name, number), geometry, materials, levels: Vec::new() };
        name = level_name(&scene.geometries[finest].name, number);
        scene.meshes.push(coarser);
    }
    scene.geometries.push(Geometry { name, ..level.geometry });
}

fn level_name(name: &str, number: u32) -> String {
    format!("{name}_LOD{number}")
}

/// What to say of a shape that has fewer levels than others.
fn fewer(
    built: &Built,
    shape: ShapeHandle,
    finest: &Geometry,
    (found, asked): (usize, usize),
) -> Option<Diagnostic> {
    if found == asked || finest.mesh.triangles.len() < FEW {
        return None;
    }
    let why = if finest.targets.is_empty() {
        "coarser ones would have hardly fewer triangles, or come apart"
    } else {
        "coarser ones would have hardly fewer triangles, come apart, or be too far from one of its states"
    };
    let message =
        format!("shape `{}` has {} of {} levels of detail: {why}", finest.name, found + 1, asked + 1);
    let report = Diagnostic::warning(Code::FewerLevels, message).at(place(built, shape), "this shape");
    Some(report.help("write fewer `levels`, or `tolerances` that its parts are not lost in"))
}

/// Leaves out levels that rounding has spoiled, and says for what part of the picture the others are good. `shapes` are those of
/// the geometries.
pub(super) fn settle(scene: &mut Scene, shapes: &mut Vec<ShapeHandle>) {
    let before: usize = scene.meshes.iter().map(|mesh| mesh.levels.len()).sum();
    for index in 0..scene.meshes.len() {
        let levels = std::mem::take(&mut scene.meshes[index].levels);
        let finest = &scene.geometries[scene.meshes[index].geometry];
        let mut kept: Vec<LevelUse> = Vec::with_capacity(levels.len());
        for level in levels {
            let own = &scene.geometries[scene.meshes[level.mesh].geometry];
            if level.number > 0 && !is_alike(finest, own) {
                break;
            }
            let before = kept.last().map_or(1.0, |level| level.coverage);
            let coverage = if level.number == 0 { 1.0 } else { coverage(finest, own).min(before) };
            kept.push(LevelUse { coverage, ..level });
        }
        scene.meshes[index].levels = kept;
    }
    if scene.meshes.iter().map(|mesh| mesh.levels.len()).sum::<usize>() < before {
        drop_unshown(scene, shapes);
    }
}

/// Leaves out meshes that no node shows and that are no level of another, and geometries that no mesh shows.
fn drop_unshown(scene: &mut Scene, shapes: &mut Vec<ShapeHandle>) {
    let levels = scene.meshes.iter().flat_map(|mesh| mesh.levels.iter().map(|level| level.mesh));
    let shown: Vec<usize> = scene.nodes.iter().filter_map(|node| node.mesh).chain(levels).collect();
    let meshes = places(scene.meshes.len(), |mesh| shown.contains(&mesh));
    let worn: Vec<usize> = shown.iter().map(|mesh| scene.meshes[*mesh].geometry).collect();
    let geometries = places(scene.geometries.len(), |geometry| worn.contains(&geometry));
    keep(&mut scene.meshes, &meshes);
    keep(&mut scene.geometries, &geometries);
    keep(shapes, &geometries);
    for mesh in &mut scene.meshes {
        mesh.geometry = geometries[mesh.geometry].unwrap_or(0);
        mesh.levels.iter_mut().for_each(|level| level.mesh = meshes[level.mesh].unwrap_or(0));
    }
    scene.nodes.iter_mut().for_each(|node| node.mesh = node.mesh.and_then(|mesh| meshes[mesh]));
}

/// Where things stand when only some are kept.
fn places(count: usize, kept: impl Fn(usize) -> bool) -> Vec<Option<usize>> {
    let mut next = 0;
    let mut place = |index: usize| {
        kept(index).then(|| {
            next += 1;
            next - 1
        })
    };
    (0..count).map(&mut place).collect()
}

fn keep<T>(all: &mut Vec<T>, places: &[Option<usize>]) {
    let mut places = places.iter();
    all.retain(|_| places.next().is_some_and(Option::is_some));
}

/// The part of a picture that a geometry covers, taken as the disk around its box, where the error of a level is a pixel.
fn coverage(finest: &Geometry, level: &Geometry) -> f64 {
    let error = level.deviation_of_all() + single_rounding(level.bounds().reach());
    let height = bounds(finest).diagonal() / (error * LINES);
    if height.is_finite() { (PI / 4.0 * height * height / ASPECT).min(1.0) } else { 1.0 }
}

/// The scene of each file: levels in files of their own where that is asked for, else all in one.
pub(super) fn files(mut scene: Scene, form: LodForm) -> Vec<Scene> {
    if form == LodForm::Nodes {
        scene.level_form = LevelForm::Nodes;
        name_levels(&mut scene);
    }
    if form != LodForm::Files {
        return vec![scene];
    }
    let count = scene.meshes.iter().map(|mesh| mesh.levels.len()).max().unwrap_or(0);
    (0..count.max(1)).map(|number| alone(&scene, number)).collect()
}

/// Gives each level a node with a name: below the node that shows the mesh, or beside it where joints carry that.
fn name_levels(scene: &mut Scene) {
    for index in 0..scene.nodes.len() {
        let node = scene.nodes[index].clone();
        let levels = node.mesh.map_or(&[][..], |mesh| &scene.meshes[mesh].levels);
        if levels.len() < 2 {
            continue;
        }
        let skinned = node.skin.is_some();
        let own = levels.iter().skip(usize::from(skinned)).map(|level| Node {
            name: level_name(&node.name, level.number),
            mesh: Some(level.mesh),
            socket: false,
            copy: false,
            instances: Vec::new(),
            parent: if skinned { node.parent } else { Some(index) },
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
            ..node.clone()
        });
        let own: Vec<Node> = own.collect();
        if !skinned {
            scene.nodes[index].mesh = None;
        }
        let first = scene.nodes.len();
        scene.nodes.extend(own);
        weigh_levels(scene, index, first);
    }
}

/// What changes the weights of a node changes those of its levels, the nodes from `first` on.
fn weigh_levels(scene: &mut Scene, node: usize, first: usize) {
    let levels = first..scene.nodes.len();
    for animation in &mut scene.animations {
        let own = |channel: &Channel| channel.node == node && channel.path == Path::Weight;
        let Some(place) = animation.channels.iter().position(own) else { continue };
        let whole = animation.channels[place].clone();
        if scene.nodes[node].mesh.is_none() {
            animation.channels.remove(place);
        }
        animation.channels.extend(levels.clone().map(|node| Channel { node, ..whole.clone() }));
    }
}

/// The scene with one level of each mesh: the coarsest where that has no more.
fn alone(scene: &Scene, number: usize) -> Scene {
    let coarser: Vec<usize> =
        scene.meshes.iter().flat_map(|mesh| mesh.levels.iter().skip(1)).map(|level| level.mesh).collect();
    let mut only = Scene { geometries: Vec::new(), meshes: Vec::new(), ..scene.clone() };
    let mut places = vec![None; scene.geometries.len()];
    let mut meshes = vec![0; scene.meshes.len()];
    for (index, mesh) in scene.meshes.iter().enumerate().filter(|(index, _)| !coarser.contains(index)) {
        let level = mesh.levels.get(number).or(mesh.levels.last());
        let shown = level.map_or(mesh, |level| &scene.meshes[level.mesh]);
        let geometry = *places[shown.geometry].get_or_insert_with(|| {
            let name = scene.geometries[mesh.geometry].name.clone();
            only.geometries.push(Geometry { name, ..scene.geometries[shown.geometry].clone() });
            only.geometries.len() - 1
        });
        meshes[index] = only.meshes.len();
        let own = level.map(|level| LevelUse { mesh: only.meshes.len(), ..*level });
        let levels = own.into_iter().collect();
        only.meshes.push(MeshUse { geometry, levels, ..mesh.clone() });
    }
    for node in &mut only.nodes {
        node.mesh = node.mesh.map(|mesh| meshes[mesh]);
    }
    only
}

//! Skins and clips as they stand in the file: played again from its bytes.
//!
//! Rotations are interpolated on the sphere, as the format demands; everything else in doubles from the written single
//! precision. The poses are for other players to be held against.

mod drivers;

use glam::{DMat4, DQuat, DVec3, DVec4};
use indexmap::IndexMap;
use serde::Serialize;

pub use drivers::{DriverFacts, DriverFrame};

use super::Extent;
use crate::geometry::number::Bounds;
use crate::gltf::{
    Read, ReadAnimation, ReadChannel, ReadError, ReadInfluences, ReadProperty, ReadSkin, ReadTarget, Written,
    WrittenAnimation,
};
use crate::model::{Model, ReachTask};
use crate::motion::{Path, Property, Transform, slerp};
use crate::scene::PropertyChannel;

/// Poses of each clip.
const POSES: u32 = 9;

/// Vertices of each mesh that poses tell.
const TOLD: usize = 24;

/// Vertices times poses that are played for the bounds of a clip.
const MOST_PLAYED: usize = 20_000_000;

/// What is known of a skin.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct SkinFacts {
    /// Names of the joints' nodes, in the order of the file.
    pub joints: Vec<String>,
    /// The meshes it carries.
    pub meshes: Vec<String>,
    /// The most joints that carry one vertex.
    pub most_influences: usize,
}

/// What is known of a clip.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ClipFacts {
    /// Seconds from 0 to the last key.
    pub duration: f64,
    /// Tracks that were written.
    pub tracks: usize,
    /// Keys of all tracks.
    pub keys: usize,
    /// Samples of the exact motion that the keys were held against.
    pub samples: usize,
    /// What was asked for, metres.
    pub tolerance: f64,
    /// No vertex is further from the exact motion at any sample or halfway between two, metres; for players that
    /// interpolate rotations on the sphere, and for those that do so by normalized straight lines.
    pub bound: f64,
    /// The box of all vertices at the keys and at 64 times between, metres.
    pub bounds: Extent,
    /// What changes of materials, lights and cameras, by the JSON pointers of the file.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub properties: IndexMap<String, PropertyFacts>,
    /// What joints reach, by the names of their nodes.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub reaches: IndexMap<String, ReachFacts>,
    /// Weights that follow the angles of joints, by the names of nodes and states.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub drivers: IndexMap<String, DriverFacts>,
    /// The scene at some times.
    pub poses: Vec<PoseFacts>,
}

/// What is known of a property that changes.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PropertyFacts {
    /// Its keys.
    pub keys: usize,
    /// No value is further from the exact one at any sample or halfway between two: colors as a screen shows them, from 0 to
    /// 1, others in the document's unit.
    pub bound: f64,
    /// What was asked for, in the same unit.
    pub tolerance: f64,
}

/// How near a point of a joint comes to where it shall be.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ReachFacts {
    /// The point, in the joint's space, metres.
    pub point: [f64; 3],
    /// So far from its place it counts as there, metres.
    pub tolerance: f64,
    /// The greatest distance of all frames in the file, metres.
    pub worst: f64,
    /// Frames in which solving brought it there.
    pub reached: usize,
    /// Each frame that was solved, played from the file.
    pub frames: Vec<ReachFrame>,
}

/// A frame of what a joint reaches.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ReachFrame {
    /// Seconds.
    pub time: f64,
    /// Where the point shall be, metres.
    pub target: [f64; 3],
    /// How far from there solving left it, metres.
    pub solved: f64,
    /// How far from there it is in the file, metres: what solving left and what keys leave out.
    pub distance: f64,
}

/// The scene at a time.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PoseFacts {
    /// Seconds.
    pub time: f64,
    /// Places of joints and of nodes that move, in the scene, column by column.
    pub nodes: IndexMap<String, [f64; 16]>,
    /// For each mesh with morph targets that shows in a node its weights there.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub weights: IndexMap<String, Vec<f64>>,
    /// Properties that change, by their JSON pointers, as the file has them.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub properties: IndexMap<String, Vec<f64>>,
    /// For each mesh that joints carry or weights move some of its vertices, at the first node that shows it.
    pub vertices: IndexMap<String, Vec<PosedVertex>>,
}

/// A vertex that joints or weights move.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PosedVertex {
    /// Its number in the mesh.
    pub vertex: usize,
    /// Where it is in the scene, metres.
    pub at: [f64; 3],
}

/// The skins and clips of a file, by their names.
pub(super) type Motion = (IndexMap<String, SkinFacts>, IndexMap<String, ClipFacts>);

/// A mesh that joints carry or weights move, at the first node that shows it.
struct Carried {
    mesh: usize,
    name: String,
    node: usize,
    skin: Option<usize>,
    influences: Vec<ReadInfluences>,
    targets: Vec<ReadTarget>,
}

/// The scene at a time.
struct Played {
    /// The matrices of all nodes.
    worlds: Vec<DMat4>,
    /// For each node the weights of its mesh.
    weights: Vec<Vec<f64>>,
}

/// A file that can be played.
struct Stage<'a> {
    file: &'a Read<'a>,
    skins: Vec<ReadSkin>,
    carried: Vec<Carried>,
    parents: Vec<Option<usize>>,
    rest: Vec<Transform>,
    weights: Vec<Vec<f64>>,
    order: Vec<usize>,
}

/// Everything that is known of the skins and clips of a file.
///
/// # Errors
/// When the bytes cannot be read back.
pub(super) fn motion(file: &Read<'_>, written: &Written, model: &Model) -> Result<Motion, ReadError> {
    if file.root.skins.is_empty() && file.root.animations.is_empty() {
        return Ok((IndexMap::new(), IndexMap::new()));
    }
    let stage = Stage::new(file)?;
    let mut clips = IndexMap::new();
    for (animation, known) in file.animations()?.iter().zip(&written.animations) {
        let moving = animation.channels.iter().map(|channel| &channel.times);
        let ends = moving.chain(animation.properties.iter().map(|channel| &channel.times));
        let duration = ends.filter_map(|times| times.last()).copied().fold(0.0, f64::max);
        let time = |k: u32| duration * f64::from(k) / f64::from(POSES - 1);
        clips.insert(
            known.name.clone(),
            ClipFacts {
                duration,
                tracks: animation.channels.len() + animation.properties.len(),
                keys: animation.channels.iter().map(|channel| channel.times.len()).sum::<usize>()
                    + animation.properties.iter().map(|channel| channel.times.len()).sum::<usize>(),
                properties: properties(animation, known),
                samples: known.samples,
                tolerance: known.tolerance,
                bound: known.bound,
                bounds: stage.bounds(animation, duration),
                reaches: stage.reaches(animation, model, (&known.name, written.root)),
                drivers: stage.drivers(animation, model, (&known.name, duration)),
                poses: (0..POSES).map(|k| stage.pose(animation, time(k))).collect(),
            },
        );
    }
    Ok((stage.skin_facts(), clips))
}

impl<'a> Stage<'a> {
    fn new(file: &'a Read<'a>) -> Result<Self, ReadError> {
        let nodes = &file.root.nodes;
        let mut parents = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                parents[child.value()] = Some(index);
            }
        }
        let mut carried: Vec<Carried> = Vec::new();
        for (index, node) in nodes.iter().enumerate() {
            let Some(mesh) = node.mesh.map(|mesh| mesh.value()) else { continue };
            let targets = file.targets(mesh)?;
            let known = carried.iter().any(|known| known.mesh == mesh);
            if known || (node.skin.is_none() && targets.is_empty()) {
                continue;
            }
            let skin = node.skin.map(|skin| skin.value());
            let influences = file.influences(mesh)?.filter(|_| skin.is_some()).unwrap_or_default();
            let name = file.root.meshes[mesh].name.clone().unwrap_or_default();
            carried.push(Carried { mesh, name, node: index, skin, influences, targets });
        }
        let weights = nodes.iter().map(|node| rest_weights(&carried, node)).collect();
        let order = order(&parents);
        let rest = nodes.iter().map(rest).collect();
        Ok(Self { file, skins: file.skins()?, carried, parents, rest, weights, order })
    }

    fn name(&self, node: usize) -> String {
        self.file.root.nodes[node].name.clone().unwrap_or_default()
    }

    fn skin_facts(&self) -> IndexMap<String, SkinFacts> {
        let facts = |(index, skin): (usize, &ReadSkin)| {
            let own = self.carried.iter().filter(|carried| carried.skin == Some(index));
            let used =
                |influences: &ReadInfluences| influences.iter().filter(|(_, weight)| *weight > 0.0).count();
            let most = own.clone().flat_map(|carried| carried.influences.iter().map(used)).max();
            let name = self.file.root.skins[index].name.clone().unwrap_or_default();
            let facts = SkinFacts {
                joints: skin.joints.iter().map(|joint| self.name(*joint)).collect(),
                meshes: own.map(|carried| carried.name.clone()).collect(),
                most_influences: most.unwrap_or(0),
            };
            (name, facts)
        };
        self.skins.iter().enumerate().map(facts).collect()
    }

    fn played(&self, animation: &ReadAnimation, time: f64) -> Played {
        let mut weights = self.weights.clone();
        for channel in animation.channels.iter().filter(|channel| channel.path == Path::Weight) {
            weights[channel.node] = played(channel, time);
        }
        Played { worlds: self.worlds(animation, time), weights }
    }

    /// The matrices of all nodes at a time.
    fn worlds(&self, animation: &ReadAnimation, time: f64) -> Vec<DMat4> {
        let mut local = self.rest.clone();
        for channel in animation.channels.iter().filter(|channel| channel.path != Path::Weight) {
            let value = vector(&played(channel, time));
            let place = &mut local[channel.node];
            match channel.path {
                Path::Translation => place.translation = value.truncate(),
                Path::Rotation => place.rotation = DQuat::from_vec4(value).normalize(),
                Path::Scale => place.scale = value.truncate(),
                Path::Weight => {}
            }
        }
        let mut worlds = vec![DMat4::IDENTITY; local.len()];
        for node in &self.order {
            let outside = self.parents[*node].map_or(DMat4::IDENTITY, |parent| worlds[parent]);
            worlds[*node] = outside * DMat4::from(local[*node].map());
        }
        worlds
    }

    fn pose(&self, animation: &ReadAnimation, time: f64) -> PoseFacts {
        let scene = self.played(animation, time);
        let mut told: Vec<usize> = self.skins.iter().flat_map(|skin| skin.joints.iter().copied()).collect();
        told.extend(animation.channels.iter().map(|channel| channel.node));
        told.sort_unstable();
        told.dedup();
        let nodes = told.iter().map(|node| (self.name(*node), scene.worlds[*node].to_cols_array())).collect();
        let some = |carried: &Carried| {
            let moved = self.moved(carried, &scene);
            let posed = |vertex: usize| PosedVertex { vertex, at: moved(vertex).to_array() };
            (carried.name.clone(), self.told(carried).into_iter().map(posed).collect())
        };
        let weighted = (0..self.rest.len()).filter(|node| !self.weights[*node].is_empty());
        let weights = weighted.map(|node| (self.name(node), scene.weights[node].clone())).collect();
        let changed = |channel: &ReadProperty| {
            (channel.pointer.clone(), row((&channel.times, &channel.values), channel.stepped, time))
        };
        let properties = animation.properties.iter().map(changed).collect();
        PoseFacts { time, nodes, weights, properties, vertices: self.carried.iter().map(some).collect() }
    }

    /// The vertices of a mesh that poses tell: some of all, and of those that weights move as many again.
    fn told(&self, carried: &Carried) -> Vec<usize> {
        let all: Vec<usize> = (0..self.file.geometries[carried.mesh].positions.len()).collect();
        let moves = |vertex: &usize| {
            carried
                .targets
                .iter()
                .any(|target| target.positions.get(*vertex).is_some_and(|way| *way != DVec3::ZERO))
        };
        let moving: Vec<usize> = all.iter().copied().filter(moves).collect();
        let some = |list: &[usize]| {
            let step = list.len().div_ceil(TOLD).max(1);
            list.iter().copied().step_by(step).collect::<Vec<_>>()
        };
        let mut told = [some(&all), some(&moving)].concat();
        told.sort_unstable();
        told.dedup();
        told
    }

    /// The node of a joint. Joints and sockets follow the nodes of the document, skeleton by skeleton; copies that are places
    /// of one node stand after them.
    fn joint_node(&self, model: &Model, (skeleton, joint): (usize, usize)) -> usize {
        let before = model.skeletons[..skeleton].iter();
        let before: usize = before.map(|one| one.skeleton.joints.len() + one.sockets.len()).sum();
        model.nodes.len() - self.file.copies + before + joint
    }

    /// How near the points of joints come to their places, frame by frame.
    fn reaches(
        &self,
        animation: &ReadAnimation,
        model: &Model,
        (clip, root): (&str, Option<usize>),
    ) -> IndexMap<String, ReachFacts> {
        let outside = root.map_or(DMat4::IDENTITY, |root| DMat4::from(self.rest[root].map()));
        let scale = root.map_or(1.0, |root| self.rest[root].scale.x);
        let clip = model.clips.iter().find(|known| known.name == clip);
        let facts = |task: &ReachTask| {
            let node = self.joint_node(model, (task.skeleton, task.joint));
            let frame = |(time, place, left): &(f64, DVec3, f64)| {
                let found = self.worlds(animation, *time)[node].transform_point3(task.point);
                let place = outside.transform_point3(*place);
                ReachFrame {
                    time: *time,
                    target: place.to_array(),
                    solved: *left * scale,
                    distance: found.distance(place),
                }
            };
            let tolerance = task.tolerance * scale;
            let frames: Vec<ReachFrame> = task.frames.iter().map(frame).collect();
            let facts = ReachFacts {
                point: task.point.to_array(),
                tolerance,
                worst: frames.iter().map(|frame| frame.distance).fold(0.0, f64::max),
                reached: frames.iter().filter(|frame| frame.solved <= tolerance).count(),
                frames,
            };
            (self.name(node), facts)
        };
        let tasks = clip.into_iter().flat_map(|clip| &clip.reaches);
        tasks.filter(|task| !task.frames.is_empty()).map(facts).collect()
    }

    /// Where the vertices of a mesh are.
    fn moved<'s>(&'s self, carried: &'s Carried, scene: &'s Played) -> impl Fn(usize) -> DVec3 + 's {
        let skin = carried.skin.map(|skin| &self.skins[skin]);
        let pairs = skin.into_iter().flat_map(|skin| skin.joints.iter().zip(&skin.inverse_bind));
        let maps: Vec<DMat4> = pairs.map(|(joint, bind)| scene.worlds[*joint] * *bind).collect();
        move |vertex: usize| {
            let place = self.file.geometries[carried.mesh].position(vertex);
            let states = carried.targets.iter().zip(&scene.weights[carried.node]);
            let way = |(target, weight): (&ReadTarget, &f64)| target.positions[vertex] * *weight;
            let place = glam::Vec3::from_array(place).as_dvec3() + states.map(way).sum::<DVec3>();
            if carried.skin.is_none() {
                return scene.worlds[carried.node].transform_point3(place);
            }
            let part = |(joint, weight): &(usize, f64)| maps[*joint].transform_point3(place) * *weight;
            carried.influences[vertex].iter().filter(|(_, weight)| *weight > 0.0).map(part).sum()
        }
    }

    fn bounds(&self, animation: &ReadAnimation, duration: f64) -> Extent {
        let mut times: Vec<f64> =
            animation.channels.iter().flat_map(|channel| channel.times.clone()).collect();
        times.extend((0..=64).map(|k| duration * f64::from(k) / 64.0));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let count = |carried: &Carried| self.file.geometries[carried.mesh].positions.len();
        let vertices: usize = self.carried.iter().map(count).sum();
        let step = (vertices * times.len()).div_ceil(MOST_PLAYED).max(1);
        let mut bounds = Bounds::EMPTY;
        for time in times.iter().step_by(step) {
            let scene = self.played(animation, *time);
            for carried in &self.carried {
                let moved = self.moved(carried, &scene);
                bounds = (0..count(carried)).fold(bounds, |bounds, vertex| bounds.with_point(moved(vertex)));
            }
            for (index, (node, world)) in self.file.root.nodes.iter().zip(&scene.worlds).enumerate() {
                let still = node.skin.is_none() && self.weights[index].is_empty();
                let Some(mesh) = node.mesh.filter(|_| still) else { continue };
                let geometry = &self.file.geometries[mesh.value()];
                let points = (0..geometry.positions.len()).map(|vertex| geometry.position(vertex));
                let points = points.chain(geometry.lines.positions.iter().copied());
                bounds = points.fold(bounds, |bounds, point| {
                    bounds.with_point(world.transform_point3(glam::Vec3::from_array(point).as_dvec3()))
                });
            }
        }
        Extent { min: bounds.min.to_array(), max: bounds.max.to_array() }
    }
}

/// Nodes with parents first.
fn order(parents: &[Option<usize>]) -> Vec<usize> {
    let mut order = Vec::with_capacity(parents.len());
    let mut placed = vec![false; parents.len()];
    for start in 0..parents.len() {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(node) = next.filter(|node| !placed[*node]) {
            placed[node] = true;
            chain.push(node);
            next = parents[node];
        }
        order.extend(chain.into_iter().rev());
    }
    order
}

fn rest(node: &gltf::json::Node) -> Transform {
    let vector =
        |value: Option<[f32; 3]>, rest: f32| glam::Vec3::from_array(value.unwrap_or([rest; 3])).as_dvec3();
    let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.0);
    Transform {
        translation: vector(node.translation, 0.0),
        rotation: glam::Quat::from_array(rotation).as_dquat().normalize(),
        scale: vector(node.scale, 1.0),
    }
}

/// The weights of what a node shows.
fn rest_weights(carried: &[Carried], node: &gltf::json::Node) -> Vec<f64> {
    let shown = node.mesh.and_then(|mesh| carried.iter().find(|known| known.mesh == mesh.value()));
    shown.map_or_else(Vec::new, |known| known.targets.iter().map(|target| target.weight).collect())
}

fn vector(numbers: &[f64]) -> DVec4 {
    let part = |axis: usize| numbers.get(axis).copied().unwrap_or(0.0);
    DVec4::new(part(0), part(1), part(2), part(3))
}

/// What is known of the properties that a clip changes.
fn properties(animation: &ReadAnimation, known: &WrittenAnimation) -> IndexMap<String, PropertyFacts> {
    // What a camera without perspective sees is two properties of the file.
    let twice = |one: &PropertyChannel| if one.property == Property::Height { 2 } else { 1 };
    let each = known.properties.iter().flat_map(|one| std::iter::repeat_n(one, twice(one)));
    let facts = |(read, written): (&ReadProperty, &PropertyChannel)| {
        let PropertyChannel { bound, tolerance, .. } = *written;
        (read.pointer.clone(), PropertyFacts { keys: read.times.len(), bound, tolerance })
    };
    animation.properties.iter().zip(each).map(facts).collect()
}

/// The numbers of a channel at a time.
fn played(channel: &ReadChannel, time: f64) -> Vec<f64> {
    if channel.path != Path::Rotation {
        return row((&channel.times, &channel.values), channel.stepped, time);
    }
    let (key, next, share) = between(&channel.times, channel.stepped, time);
    let turn = |key: usize| DQuat::from_vec4(vector(&channel.values[4 * key..4 * key + 4])).normalize();
    if share == 0.0 {
        return channel.values[4 * key..4 * key + 4].to_vec();
    }
    slerp(turn(key), turn(next), share).to_array().to_vec()
}

/// The numbers at a time of what runs straight from key to key, or steps.
fn row((times, values): (&[f64], &[f64]), stepped: bool, time: f64) -> Vec<f64> {
    let width = values.len() / times.len();
    let (key, next, share) = between(times, stepped, time);
    let row = |key: usize| &values[key * width..(key + 1) * width];
    row(key).iter().zip(row(next)).map(|(from, to)| from + (to - from) * share).collect()
}

/// The keys around a time, and the share of the way from the one to the other.
fn between(times: &[f64], stepped: bool, time: f64) -> (usize, usize, f64) {
    let next = times.partition_point(|key| *key <= time);
    let key = next.saturating_sub(1);
    if next == 0 || next == times.len() || stepped {
        return (key, key, 0.0);
    }
    (key, next, (time - times[key]) / (times[next] - times[key]))
}

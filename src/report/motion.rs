//! Skins and clips as they stand in the file: played again from its bytes.
//!
//! Rotations are interpolated on the sphere, as the format demands; everything else in doubles from the written single
//! precision. The poses are for other players to be held against.

use glam::{DMat4, DQuat, DVec3, DVec4};
use indexmap::IndexMap;
use serde::Serialize;

use super::Extent;
use crate::geometry::number::Bounds;
use crate::gltf::{Read, ReadAnimation, ReadChannel, ReadError, ReadInfluences, ReadSkin, Written};
use crate::model::{Model, ReachTask};
use crate::motion::{Path, Transform, slerp};

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
    /// What joints reach, by the names of their nodes.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub reaches: IndexMap<String, ReachFacts>,
    /// The scene at some times.
    pub poses: Vec<PoseFacts>,
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
    /// For each skinned mesh some of its vertices.
    pub vertices: IndexMap<String, Vec<PosedVertex>>,
}

/// A skinned vertex.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PosedVertex {
    /// Its number in the mesh.
    pub vertex: usize,
    /// Where it is in the scene, metres.
    pub at: [f64; 3],
}

/// The skins and clips of a file, by their names.
pub(super) type Motion = (IndexMap<String, SkinFacts>, IndexMap<String, ClipFacts>);

/// A mesh that joints carry.
struct Carried {
    mesh: usize,
    name: String,
    skin: usize,
    influences: Vec<ReadInfluences>,
}

/// A file that can be played.
struct Stage<'a> {
    file: &'a Read<'a>,
    skins: Vec<ReadSkin>,
    carried: Vec<Carried>,
    parents: Vec<Option<usize>>,
    rest: Vec<Transform>,
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
        let duration = animation.channels.iter().filter_map(|channel| channel.times.last());
        let duration = duration.copied().fold(0.0, f64::max);
        let time = |k: u32| duration * f64::from(k) / f64::from(POSES - 1);
        clips.insert(
            known.name.clone(),
            ClipFacts {
                duration,
                tracks: animation.channels.len(),
                keys: animation.channels.iter().map(|channel| channel.times.len()).sum(),
                samples: known.samples,
                tolerance: known.tolerance,
                bound: known.bound,
                bounds: stage.bounds(animation, duration),
                reaches: stage.reaches(animation, model, &known.name),
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
        for node in nodes {
            let (Some(mesh), Some(skin)) = (node.mesh, node.skin) else { continue };
            if carried.iter().any(|known| known.mesh == mesh.value()) {
                continue;
            }
            let influences = file.influences(mesh.value())?.unwrap_or_default();
            let name = file.root.meshes[mesh.value()].name.clone().unwrap_or_default();
            carried.push(Carried { mesh: mesh.value(), name, skin: skin.value(), influences });
        }
        let order = order(&parents);
        let rest = nodes.iter().map(rest).collect();
        Ok(Self { file, skins: file.skins()?, carried, parents, rest, order })
    }

    fn name(&self, node: usize) -> String {
        self.file.root.nodes[node].name.clone().unwrap_or_default()
    }

    fn skin_facts(&self) -> IndexMap<String, SkinFacts> {
        let facts = |(index, skin): (usize, &ReadSkin)| {
            let own = self.carried.iter().filter(|carried| carried.skin == index);
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

    /// The matrices of all nodes at a time.
    fn worlds(&self, animation: &ReadAnimation, time: f64) -> Vec<DMat4> {
        let mut local = self.rest.clone();
        for channel in &animation.channels {
            let value = played(channel, time);
            let place = &mut local[channel.node];
            match channel.path {
                Path::Translation => place.translation = value.truncate(),
                Path::Rotation => place.rotation = DQuat::from_vec4(value).normalize(),
                Path::Scale => place.scale = value.truncate(),
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
        let worlds = self.worlds(animation, time);
        let mut told: Vec<usize> = self.skins.iter().flat_map(|skin| skin.joints.iter().copied()).collect();
        told.extend(animation.channels.iter().map(|channel| channel.node));
        told.sort_unstable();
        told.dedup();
        let nodes = told.iter().map(|node| (self.name(*node), worlds[*node].to_cols_array())).collect();
        let some = |carried: &Carried| {
            let count = carried.influences.len();
            let step = count.div_ceil(TOLD).max(1);
            let skinned = self.skinned(carried, &worlds);
            let posed = |vertex: usize| PosedVertex { vertex, at: skinned(vertex).to_array() };
            (carried.name.clone(), (0..count).step_by(step).map(posed).collect())
        };
        PoseFacts { time, nodes, vertices: self.carried.iter().map(some).collect() }
    }

    /// How near the points of joints come to their places, frame by frame.
    fn reaches(&self, animation: &ReadAnimation, model: &Model, clip: &str) -> IndexMap<String, ReachFacts> {
        let clip = model.clips.iter().find(|known| known.name == clip);
        let facts = |task: &ReachTask| {
            // Joints and sockets follow the nodes of the document, skeleton by skeleton.
            let before = model.skeletons[..task.skeleton].iter();
            let before: usize = before.map(|one| one.skeleton.joints.len() + one.sockets.len()).sum();
            let node = model.nodes.len() + before + task.joint;
            let frame = |(time, place, left): &(f64, DVec3, f64)| {
                let found = self.worlds(animation, *time)[node].transform_point3(task.point);
                ReachFrame {
                    time: *time,
                    target: place.to_array(),
                    solved: *left,
                    distance: found.distance(*place),
                }
            };
            let frames: Vec<ReachFrame> = task.frames.iter().map(frame).collect();
            let facts = ReachFacts {
                point: task.point.to_array(),
                tolerance: task.tolerance,
                worst: frames.iter().map(|frame| frame.distance).fold(0.0, f64::max),
                reached: frames.iter().filter(|frame| frame.solved <= task.tolerance).count(),
                frames,
            };
            (self.name(node), facts)
        };
        let tasks = clip.into_iter().flat_map(|clip| &clip.reaches);
        tasks.filter(|task| !task.frames.is_empty()).map(facts).collect()
    }

    /// Where the vertices of a mesh are.
    fn skinned<'s>(&'s self, carried: &'s Carried, worlds: &[DMat4]) -> impl Fn(usize) -> DVec3 + 's {
        let skin = &self.skins[carried.skin];
        let maps: Vec<DMat4> =
            skin.joints.iter().zip(&skin.inverse_bind).map(|(joint, bind)| worlds[*joint] * *bind).collect();
        move |vertex: usize| {
            let place = self.file.geometries[carried.mesh].position(vertex);
            let place = glam::Vec3::from_array(place).as_dvec3();
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
        let vertices: usize = self.carried.iter().map(|carried| carried.influences.len()).sum();
        let step = (vertices * times.len()).div_ceil(MOST_PLAYED).max(1);
        let mut bounds = Bounds::EMPTY;
        for time in times.iter().step_by(step) {
            let worlds = self.worlds(animation, *time);
            for carried in &self.carried {
                let skinned = self.skinned(carried, &worlds);
                bounds = (0..carried.influences.len())
                    .fold(bounds, |bounds, vertex| bounds.with_point(skinned(vertex)));
            }
            for (node, world) in self.file.root.nodes.iter().zip(&worlds) {
                let Some(mesh) = node.mesh.filter(|_| node.skin.is_none()) else { continue };
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

fn played(channel: &ReadChannel, time: f64) -> DVec4 {
    let next = channel.times.partition_point(|key| *key <= time);
    if next == 0 {
        return channel.values[0];
    }
    let key = next - 1;
    if next == channel.times.len() || channel.stepped {
        return channel.values[key];
    }
    let share = (time - channel.times[key]) / (channel.times[next] - channel.times[key]);
    let (from, to) = (channel.values[key], channel.values[next]);
    if channel.path != Path::Rotation {
        return from + (to - from) * share;
    }
    DVec4::from(slerp(DQuat::from_vec4(from).normalize(), DQuat::from_vec4(to).normalize(), share))
}

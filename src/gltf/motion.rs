//! Skins and animations into glTF.
//!
//! Times that several channels of a clip share are one accessor, and so are equal inverse bind matrices of several skins.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf::json::validation::Checked as Valid;
use gltf::json::{Accessor, Animation, Index, Node, Root, Skin, Value};
use serde_json::json;

use super::buffer::{Binary, Content, Elements, accessor};
use super::pointer::{self, Pointer};
use super::vector::put;
use super::write::Carriers;
use crate::geometry::mesh;
use crate::geometry::number::single;
use crate::motion::Path;
use crate::scene::{self, Geometry, Scene};

/// Joints and weights of a geometry, written.
pub(super) struct Carried {
    pub(super) joints: Index<Accessor>,
    pub(super) weights: Index<Accessor>,
}

/// Writes the joints and weights of each vertex; none where a geometry has none.
pub(super) fn carried(root: &mut Root, binary: &mut Binary, geometry: &Geometry) -> Option<Carried> {
    let influences = geometry.influences.as_ref()?;
    let elements =
        || Elements { component: ComponentType::U8, shape: Type::Vec4, count: geometry.mesh.vertices.len() };
    let of = |vertex: &mesh::Vertex| influences[vertex.point.subscript()];
    let joints = binary.attribute(root, elements(), Content::Attributes { stride: 4 }, |bytes| {
        for vertex in &geometry.mesh.vertices {
            bytes.extend(of(vertex).map(|influence| influence.joint));
        }
    });
    let weights = binary.attribute(root, elements(), Content::Attributes { stride: 4 }, |bytes| {
        for vertex in &geometry.mesh.vertices {
            bytes.extend(of(vertex).map(|influence| influence.weight));
        }
    });
    root.accessors[weights.value()].normalized = true;
    Some(Carried { joints, weights })
}

/// Writes all skins.
pub(super) fn skins(root: &mut Root, binary: &mut Binary, scene: &Scene) {
    let mut written: Vec<(&scene::Skin, Index<Accessor>)> = Vec::new();
    for skin in &scene.skins {
        let known = written.iter().find(|(other, _)| other.inverse_bind == skin.inverse_bind);
        let matrices = match known {
            Some((_, accessor)) => *accessor,
            None => {
                let start = binary.start();
                for map in &skin.inverse_bind {
                    let map = scene.grid.map_or(*map, |grid| *map * grid.affine());
                    put(&mut binary.bytes, glam::DMat4::from(map).as_mat4().to_cols_array());
                }
                let view = binary.view(root, start, None, Content::Attributes { stride: 64 });
                let count = skin.inverse_bind.len();
                let elements = Elements { component: ComponentType::F32, shape: Type::Mat4, count };
                let accessor = root.push(accessor(view, 0, elements, None));
                written.push((skin, accessor));
                accessor
            }
        };
        root.push(Skin {
            extensions: None,
            extras: None,
            inverse_bind_matrices: Some(matrices),
            joints: skin.joints.iter().map(|joint| Index::new(mesh::index(*joint))).collect(),
            name: Some(skin.name.clone()),
            skeleton: Some(Index::new(mesh::index(skin.root))),
        });
    }
}

/// Writes animations; what points at properties is for [`document`](super::pointer::document).
pub(super) fn animations(
    (root, binary): (&mut Root, &mut Binary),
    scene: &Scene,
    all: &[&scene::Animation],
    (carriers, has_properties): (&Carriers, bool),
) -> Vec<Pointer> {
    let mut pointers = Vec::new();
    for animation in all {
        let mut inputs: Vec<(&[f64], Index<Accessor>)> = Vec::new();
        let mut samplers = Vec::new();
        let mut channels = Vec::new();
        for channel in &animation.channels {
            let input = times(root, binary, &channel.times, &mut inputs);
            let sampler = Index::new(mesh::index(samplers.len()));
            let form = match channel.path {
                Path::Translation | Path::Scale => (Type::Vec3, 3),
                Path::Rotation => (Type::Vec4, 4),
                Path::Weight => (Type::Scalar, 1),
            };
            let output = values(root, binary, &channel.values, form);
            samplers.push(self::sampler(input, channel.stepped, output));
            channels
                .extend(targets(channel, carriers).into_iter().map(|node| target(channel, sampler, node)));
        }
        for channel in animation.properties.iter().filter(|_| has_properties) {
            let input = times(root, binary, &channel.times, &mut inputs);
            for (path, factor) in pointer::targets(scene, channel) {
                let sampler = Index::new(mesh::index(samplers.len()));
                let numbers: Vec<f64> = channel.values.iter().map(|value| value * factor).collect();
                let form = match channel.property.width() {
                    1 => (Type::Scalar, 1),
                    3 => (Type::Vec3, 3),
                    _ => (Type::Vec4, 4),
                };
                let output = values(root, binary, &numbers, form);
                samplers.push(self::sampler(input, channel.stepped, output));
                pointers.push(Pointer { animation: root.animations.len(), sampler, path });
            }
        }
        root.push(Animation {
            extensions: None,
            extras: extras(animation),
            channels,
            name: Some(animation.name.clone()),
            samplers,
        });
    }
    pointers
}

fn sampler(input: Index<Accessor>, stepped: bool, output: Index<Accessor>) -> Sampler {
    let interpolation = Valid::Valid(if stepped { Interpolation::Step } else { Interpolation::Linear });
    Sampler { extensions: None, extras: None, input, interpolation, output }
}

/// The nodes that a channel moves: weights move the mesh, which may hang on a node of its own, and all its levels.
fn targets(channel: &scene::Channel, carriers: &Carriers) -> Vec<Index<Node>> {
    let bears = |(shown, _): &&(usize, Index<Node>)| channel.path == Path::Weight && *shown == channel.node;
    let borne: Vec<Index<Node>> = carriers.iter().filter(bears).map(|(_, bearer)| *bearer).collect();
    if borne.is_empty() { vec![Index::new(mesh::index(channel.node))] } else { borne }
}

fn target(channel: &scene::Channel, sampler: Index<Sampler>, node: Index<Node>) -> Channel {
    Channel {
        sampler,
        target: Target {
            extensions: None,
            extras: None,
            node,
            path: Valid::Valid(match channel.path {
                Path::Translation => Property::Translation,
                Path::Rotation => Property::Rotation,
                Path::Scale => Property::Scale,
                Path::Weight => Property::MorphTargetWeights,
            }),
        },
        extensions: None,
        extras: None,
    }
}

/// Times of keys; those that a channel of the clip has had are that accessor.
fn times<'c>(
    root: &mut Root,
    binary: &mut Binary,
    times: &'c [f64],
    known: &mut Vec<(&'c [f64], Index<Accessor>)>,
) -> Index<Accessor> {
    if let Some((_, accessor)) = known.iter().find(|(other, _)| *other == times) {
        return *accessor;
    }
    let start = binary.start();
    times.iter().for_each(|time| put(&mut binary.bytes, [single(*time)]));
    let view = binary.view(root, start, None, Content::Attributes { stride: 4 });
    let elements = Elements { component: ComponentType::F32, shape: Type::Scalar, count: times.len() };
    let mut made = accessor(view, 0, elements, None);
    let bound = |time: Option<&f64>| time.map(|time| Value::from(vec![single(*time)]));
    made.min = bound(times.first());
    made.max = bound(times.last());
    let made = root.push(made);
    known.push((times, made));
    made
}

fn values(
    root: &mut Root,
    binary: &mut Binary,
    values: &[f64],
    (shape, width): (Type, usize),
) -> Index<Accessor> {
    let start = binary.start();
    values.iter().for_each(|value| put(&mut binary.bytes, [single(*value)]));
    let view = binary.view(root, start, None, Content::Attributes { stride: 4 * width });
    let count = values.len() / width;
    let elements = Elements { component: ComponentType::F32, shape, count };
    root.push(accessor(view, 0, elements, None))
}

/// The mark of a socket.
pub(super) fn socket() -> gltf::json::Extras {
    serde_json::value::to_raw_value(&json!({ "socket": true })).ok()
}

/// What a game may want to know of a clip and glTF has no place for.
fn extras(animation: &scene::Animation) -> gltf::json::Extras {
    let mut object = serde_json::Map::new();
    if animation.looped {
        object.insert("loop".to_owned(), json!(true));
    }
    if !animation.events.is_empty() {
        let event = |(time, name): &(f64, String)| json!({ "time": time, "name": name });
        object.insert("events".to_owned(), animation.events.iter().map(event).collect());
    }
    if let Some((min, max)) = animation.reach {
        // A hair wider than the samples, for what rounding to single precision adds.
        let margin = animation.bound + 1e-6 * min.abs().max(max.abs()).max_element();
        let (min, max) = (min - margin, max + margin);
        object.insert("bounds".to_owned(), json!({ "min": min.to_array(), "max": max.to_array() }));
    }
    serde_json::value::to_raw_value(&object).ok().filter(|_| !object.is_empty())
}

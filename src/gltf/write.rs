//! A checked scene into the bytes of a `.glb` file.

use std::collections::BTreeMap;

use glam::DVec2;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::scene::UnitQuaternion;
use gltf::json::validation::Checked as Valid;
use gltf::json::{Accessor, Asset, Index, Mesh, Node, Root, Scene};
use thiserror::Error;

use super::buffer::{Binary, at, index_accessors, index_width};
use super::color::colors;
use super::position::positions;
use super::profile::Profile;
use super::vector::{Directions, uvs};
use super::{
    attribute, carrier, collider, duplicate, instance, lines, manifold, material, morph, motion, pointer,
    view,
};
use crate::geometry::mesh;
use crate::geometry::mesh::Anchor;
use crate::geometry::number::size;
use crate::geometry::tessellate::Deviation;
use crate::scene::{Checked, Collider, Geometry, Grid, LevelUse, PropertyChannel};

/// The bytes of a file and what only its writer knows of them.
#[derive(Clone, Debug)]
pub struct Written {
    /// The `.glb` file.
    pub bytes: Vec<u8>,
    /// Names and bytes of the pictures that stand beside it.
    pub pictures: Vec<(String, Vec<u8>)>,
    /// For each geometry of the scene what is known of it.
    pub geometries: Vec<WrittenGeometry>,
    /// For each animation what is known of it.
    pub animations: Vec<WrittenAnimation>,
    /// Bodies for physics.
    pub colliders: Vec<Collider>,
    /// The node that carries all others, where the file turns, moves or scales the model.
    pub root: Option<usize>,
    /// The levels of detail of each mesh that has some, the finest first.
    pub levels: Vec<Vec<WrittenLevel>>,
}

/// A level of detail, with its geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenLevel {
    /// The level.
    pub level: LevelUse,
    /// Index into [`Written::geometries`].
    pub geometry: usize,
}

/// What is known of an animation beyond its bytes.
#[derive(Clone, Debug)]
pub struct WrittenAnimation {
    /// Name of the clip.
    pub name: String,
    /// No vertex is further from the exact motion at any sample, metres.
    pub bound: f64,
    /// What was asked for, metres.
    pub tolerance: f64,
    /// Samples of the exact motion.
    pub samples: usize,
    /// What it changes of materials, lights and cameras, in the order of the file; some are two properties there.
    pub properties: Vec<PropertyChannel>,
}

/// What is known of a geometry beyond its bytes.
#[derive(Clone, Debug)]
pub struct WrittenGeometry {
    /// Name of the shape.
    pub name: String,
    /// The meshes of the file that show it, at least one; where nodes show it with several materials, there are several.
    pub meshes: Vec<usize>,
    /// Bytes that its vertices and indices add to the file, without materials; what it shares with a geometry before it is
    /// counted there.
    pub bytes: u64,
    /// Distance from the exact shape before rounding.
    pub deviation: Deviation,
    /// Distance that was asked for, metres.
    pub tolerance: Option<f64>,
    /// For each morph target what is known of it.
    pub targets: Vec<WrittenTarget>,
    /// For each written vertex its place on the exact source; empty unless asked for.
    pub anchors: Vec<Anchor>,
    /// For each written vertex of lines its place on the exact curve; empty unless asked for.
    pub line_anchors: Vec<Anchor>,
}

impl WrittenGeometry {
    /// The first mesh of the file that shows it: they differ by their materials alone.
    #[must_use]
    pub fn mesh(&self) -> usize {
        self.meshes.first().copied().unwrap_or(0)
    }
}

/// What is known of a morph target beyond its bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenTarget {
    /// Distance from the exact state before rounding.
    pub deviation: Deviation,
    /// Distance that was asked for, metres.
    pub tolerance: Option<f64>,
}

/// What keeps a scene from being one file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WriteError {
    /// The format counts bytes in 32 bits.
    #[error("the file would have {0} bytes, and a .glb file holds at most 4294967295")]
    TooLarge(u64),
}

/// How a scene is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// For whom.
    pub profile: Profile,
    /// Whether the places of all vertices on their sources are kept beside the bytes.
    pub anchors: bool,
    /// Where pictures stand beside the file: what their names begin with.
    pub beside: Option<String>,
}

/// Writes a scene; a scene on a grid for a profile that is quantized.
///
/// Cost: one pass over the scene; the bytes are allocated once.
///
/// # Errors
/// When the file would pass 4 GiB.
pub fn write(checked: Checked<'_>, form: &Form) -> Result<Written, WriteError> {
    let Form { profile, anchors, ref beside } = *form;
    let scene = checked.scene();
    let mut writer = Writer {
        root: Root { asset: asset(scene.grid), ..Root::default() },
        binary: Binary::new(binary_size(checked), profile.is_compressed()),
        small: profile.is_quantized(),
        grid: scene.grid,
        pointers: Vec::new(),
    };
    if writer.small {
        writer.root.extensions_used.push(QUANTIZATION.to_owned());
        writer.root.extensions_required.push(QUANTIZATION.to_owned());
    }
    let shared: Vec<_> = scene
        .geometries
        .iter()
        .map(|geometry| {
            let before = writer.binary.bytes.len();
            let triangles = (!geometry.mesh.triangles.is_empty()).then(|| writer.geometry(geometry));
            let lines =
                lines::shared(&mut writer.root, &mut writer.binary, geometry, (scene.grid, writer.small));
            (triangles, lines, (writer.binary.bytes.len() - before) as u64)
        })
        .collect();
    let mut pictures = Vec::new();
    let place = beside.as_deref().map(|stem| (stem, &mut pictures));
    let images = material::images(&mut writer.root, &mut writer.binary, scene, place);
    material::materials(&mut writer.root, scene, &images);
    for mesh in &scene.meshes {
        let (triangles, lines, _) = &shared[mesh.geometry];
        writer.mesh(checked, mesh, triangles.as_ref(), lines);
    }
    motion::skins(&mut writer.root, &mut writer.binary, scene);
    let carriers = carrier::carriers(scene);
    let bearers = carrier::bearers(scene, &carriers);
    let has_properties = profile.reads_properties();
    let written: Vec<&crate::scene::Animation> = scene
        .animations
        .iter()
        .filter(|animation| has_properties || !animation.channels.is_empty())
        .collect();
    let both = (&mut writer.root, &mut writer.binary);
    writer.pointers = motion::animations(both, scene, &written, (&bearers, has_properties));
    writer.nodes(checked, &carriers);
    duplicate::merge_accessors(&mut writer.root);
    instance::write(&mut writer.root, &mut writer.binary, scene);
    if profile.tells_manifolds() {
        manifold::mark(&mut writer.root, &mut writer.binary, scene);
    }
    let animated = |animation: &&crate::scene::Animation| WrittenAnimation {
        name: animation.name.clone(),
        bound: animation.bound,
        tolerance: animation.tolerance,
        samples: animation.samples,
        properties: if has_properties { animation.properties.clone() } else { Vec::new() },
    };
    let animations = written.iter().map(animated).collect();
    let mut meshes = vec![Vec::new(); scene.geometries.len()];
    for (index, mesh) in scene.meshes.iter().enumerate() {
        meshes[mesh.geometry].push(index);
    }
    let known = |(index, geometry): (usize, &Geometry)| WrittenGeometry {
        name: geometry.name.clone(),
        meshes: std::mem::take(&mut meshes[index]),
        bytes: shared[index].2,
        deviation: geometry.deviation,
        tolerance: geometry.tolerance,
        targets: geometry
            .targets
            .iter()
            .map(|target| WrittenTarget { deviation: target.deviation, tolerance: target.tolerance })
            .collect(),
        line_anchors: if anchors {
            geometry.wire.points.iter().map(|p| p.anchor).collect()
        } else {
            Vec::new()
        },
        anchors: if anchors { geometry.mesh.vertices.iter().map(|v| v.anchor).collect() } else { Vec::new() },
    };
    let geometries = scene.geometries.iter().enumerate().map(known).collect();
    let written =
        |level: &LevelUse| WrittenLevel { level: *level, geometry: scene.meshes[level.mesh].geometry };
    let levels = scene.meshes.iter().filter(|mesh| !mesh.levels.is_empty());
    let levels = levels.map(|mesh| mesh.levels.iter().map(written).collect()).collect();
    Ok(Written {
        bytes: writer.finish()?,
        pictures,
        geometries,
        animations,
        colliders: scene.colliders.clone(),
        root: scene.root,
        levels,
    })
}

/// The extension that allows attributes of whole numbers.
const QUANTIZATION: &str = "KHR_mesh_quantization";

fn asset(grid: Option<Grid>) -> Asset {
    Asset {
        extras: grid.and_then(|grid| serde_json::value::to_raw_value(&grid.extras()).ok()),
        generator: Some(concat!("Kiln ", env!("CARGO_PKG_VERSION")).to_owned()),
        version: "2.0".to_owned(),
        ..Asset::default()
    }
}

fn binary_size(checked: Checked<'_>) -> usize {
    let scene = checked.scene();
    let geometry = |geometry: &Geometry| {
        let tangent = if geometry.tangents.is_some() { 16 } else { 0 };
        let uv = if geometry.uv { 8 } else { 0 } + if geometry.lightmap.is_some() { 8 } else { 0 };
        let vertices = geometry.mesh.vertices.len();
        let points = geometry.wire.points.len();
        let triangles = geometry.mesh.triangles.len() * 3 * index_width(vertices);
        let color = if geometry.colored { 16 } else { 0 };
        let carried = if geometry.influences.is_some() { 8 } else { 0 };
        let own: usize = geometry.attributes.iter().map(|own| 4 * own.width).sum();
        let states = geometry.targets.len() * (vertices * (24 + tangent) + 512);
        vertices * (24 + tangent + uv + color + carried + own)
            + states
            + triangles
            + points * (12 + color + own + 2 * index_width(points))
            + 128
    };
    let images: usize = scene.images.iter().map(|image| image.bytes.len() + 4).sum();
    // The header and the JSON chunk are put before: room for most, so that the bytes are not copied for it.
    let json = 4096
        + 1024 * (scene.geometries.len() + scene.meshes.len() + scene.materials.len() + scene.nodes.len());
    let channel = |channel: &crate::scene::Channel| (channel.times.len() + channel.values.len()) * 4 + 256;
    let channels = scene.animations.iter().flat_map(|animation| animation.channels.iter().map(channel));
    let change = |channel: &PropertyChannel| (channel.times.len() + 2 * channel.values.len()) * 4 + 512;
    let changes = scene.animations.iter().flat_map(|animation| animation.properties.iter().map(change));
    let bind: usize = scene.skins.iter().map(|skin| skin.joints.len() * 80).sum();
    scene.geometries.iter().map(geometry).sum::<usize>()
        + images
        + json
        + channels.sum::<usize>()
        + changes.sum::<usize>()
        + bind
        + scene.nodes.iter().map(|node| node.instances.len() * 40).sum::<usize>()
}

/// Nodes that show a mesh, each with those that hold the mesh or a level of it.
pub(super) type Carriers = Vec<(usize, Index<Node>)>;

/// Accessors that all meshes of a geometry share.
struct Shared {
    position: Index<Accessor>,
    normal: Index<Accessor>,
    tangent: Option<Index<Accessor>>,
    uv: Option<Index<Accessor>>,
    lightmap: Option<Index<Accessor>>,
    color: Option<Index<Accessor>>,
    carried: Option<motion::Carried>,
    attributes: attribute::Named,
    targets: Vec<gltf::json::mesh::MorphTarget>,
    /// For each run its indices.
    indices: Vec<Index<Accessor>>,
}

/// What a primitive wears, and the part that it is where parts stay apart.
type Worn<'a> = (Option<usize>, Option<(u32, &'a str)>);

struct Writer {
    root: Root,
    binary: Binary,
    /// Whether attributes are whole numbers.
    small: bool,
    grid: Option<Grid>,
    /// Channels that name no node.
    pointers: Vec<pointer::Pointer>,
}

impl Writer {
    fn geometry(&mut self, geometry: &Geometry) -> Shared {
        let mesh = &geometry.mesh;
        let (root, binary) = (&mut self.root, &mut self.binary);
        let places = mesh.vertices.iter().map(|vertex| mesh.points[vertex.point.subscript()]);
        let position = positions(root, binary, self.grid, places);
        let directions = Directions { small: self.small, count: mesh.vertices.len() };
        let normals = mesh.vertices.iter().map(|vertex| vertex.normal.extend(0.0));
        let normal = directions.write(root, binary, Type::Vec3, normals);
        let tangent = geometry.tangents.as_ref().map(|tangents| {
            let wide = tangents.iter().map(|tangent| glam::Vec4::from_array(*tangent).as_dvec4());
            directions.write(root, binary, Type::Vec4, wide)
        });
        let first: Vec<DVec2> =
            if geometry.uv { mesh.vertices.iter().map(|vertex| vertex.uv).collect() } else { Vec::new() };
        let uv = geometry.uv.then(|| uvs(root, binary, &first, self.small));
        let lightmap = geometry.lightmap.as_ref().map(|lightmap| {
            let second: Vec<DVec2> =
                lightmap.places.iter().map(|place| DVec2::from_array(place.map(f64::from))).collect();
            uvs(root, binary, &second, self.small)
        });
        let shades = mesh.vertices.iter().map(|vertex| vertex.color);
        let color = geometry.colored.then(|| colors(root, binary, shades, self.small));
        let carried = motion::carried(root, binary, geometry);
        let attributes = attribute::written(root, binary, &geometry.attributes, |own| &own.values);
        let targets = morph::targets(root, binary, geometry, (self.grid, self.small));
        let ends = [0].into_iter().chain(mesh.runs.iter().map(|run| run.end));
        let counts = ends.zip(&mesh.runs).map(|(start, run)| (run.end - start) as usize * 3);
        let all = mesh.triangles.iter().flatten().map(|vertex| vertex.0);
        let indices = index_accessors(root, binary, all, (mesh.vertices.len(), false), counts);
        Shared { position, normal, tangent, uv, lightmap, color, carried, attributes, targets, indices }
    }

    fn mesh(
        &mut self,
        checked: Checked<'_>,
        mesh: &crate::scene::MeshUse,
        shared: Option<&Shared>,
        lines: &[lines::Lines],
    ) {
        let scene = checked.scene();
        let geometry = &scene.geometries[mesh.geometry];
        let runs = &geometry.mesh.runs;
        // A primitive without tangents has none in its targets.
        let targets = |shared: &Shared, bumps: bool| {
            let one = |target: &gltf::json::mesh::MorphTarget| gltf::json::mesh::MorphTarget {
                tangents: target.tangents.filter(|_| bumps),
                ..target.clone()
            };
            (!shared.targets.is_empty()).then(|| shared.targets.iter().map(one).collect())
        };
        let primitive = |shared: &Shared, (material, part): Worn<'_>, indices: Index<Accessor>| {
            let worn = material.map(|index| &scene.materials[index]);
            let bumps = worn.is_some_and(crate::scene::Material::needs_tangents);
            let mut attributes = BTreeMap::new();
            attributes.insert(Valid::Valid(Semantic::Positions), shared.position);
            attributes.insert(Valid::Valid(Semantic::Normals), shared.normal);
            if let Some(tangent) = shared.tangent.filter(|_| bumps) {
                attributes.insert(Valid::Valid(Semantic::Tangents), tangent);
            }
            if let Some(uv) = shared.uv {
                attributes.insert(Valid::Valid(Semantic::TexCoords(0)), uv);
            }
            if let Some(lightmap) = shared.lightmap {
                attributes.insert(Valid::Valid(Semantic::TexCoords(1)), lightmap);
            }
            if let Some(color) = shared.color {
                attributes.insert(Valid::Valid(Semantic::Colors(0)), color);
            }
            if let Some(carried) = &shared.carried {
                attributes.insert(Valid::Valid(Semantic::Joints(0)), carried.joints);
                attributes.insert(Valid::Valid(Semantic::Weights(0)), carried.weights);
            }
            attribute::name(&mut attributes, &shared.attributes);
            Primitive {
                attributes,
                extensions: None,
                extras: part.and_then(|(_, name)| {
                    serde_json::value::to_raw_value(&serde_json::json!({ "part": name })).ok()
                }),
                indices: Some(indices),
                material: material.map(|index| Index::new(mesh::index(index))),
                mode: Valid::Valid(Mode::Triangles),
                targets: targets(shared, bumps),
            }
        };
        let wears = |run: &mesh::Run| {
            let origin = run.origin as usize;
            (mesh.materials[origin], geometry.parts.get(origin).map(|name| (run.origin, name.as_str())))
        };
        let worn: Vec<Worn<'_>> = runs.iter().map(wears).collect();
        let accessors = &mut self.root.accessors;
        let mut triangles = Vec::new();
        for (shared, range) in shared
            .into_iter()
            .flat_map(|shared| duplicate::neighbors(&worn).map(move |range| (shared, range)))
        {
            let own = &shared.indices[range.clone()];
            let indices = if let [one] = own { *one } else { joined(accessors, own) };
            triangles.push(primitive(shared, worn[range.start], indices));
        }
        let primitives =
            triangles.into_iter().chain(lines.iter().map(|lines| lines.primitive(mesh))).collect();
        self.root.push(Mesh {
            extensions: None,
            extras: morph::names(geometry),
            name: Some(mesh.name.clone()),
            primitives,
            weights: morph::weights(geometry),
        });
    }

    fn nodes(&mut self, checked: Checked<'_>, carriers: &[carrier::Carrier]) {
        let scene = checked.scene();
        let mut children: Vec<Vec<Index<Node>>> = vec![Vec::new(); scene.nodes.len()];
        let mut top = Vec::new();
        for (index, node) in scene.nodes.iter().enumerate() {
            node.parent.map_or(&mut top, |parent| &mut children[parent]).push(at(index));
        }
        let mut lights = view::lights(&mut self.root, scene);
        let mut bodies = collider::write(&mut self.root, &mut self.binary, scene);
        for (index, node) in scene.nodes.iter().enumerate() {
            let mut below = std::mem::take(&mut children[index]);
            below.extend(carrier::below(scene, carriers, index));
            let mesh = node.mesh.filter(|_| !carrier::is_relieved(carriers, index));
            let told = mesh.map(|mesh| carrier::told(scene, carriers, (index, mesh)));
            let (mut extensions, levels) = told.unwrap_or_default();
            let body = std::mem::take(&mut bodies[index]);
            if !body.extensions.is_empty() {
                extensions.get_or_insert_default().others.extend(body.extensions);
            }
            let plain = |vector: glam::DVec3, rest: glam::DVec3| {
                (vector != rest).then(|| vector.as_vec3().to_array())
            };
            if let Some(light) = lights[index].take() {
                let others = &mut extensions.get_or_insert_default().others;
                others.insert(view::LIGHTS.to_owned(), light);
            }
            let camera = node.camera.map(|camera| self.root.push(view::camera(&node.name, &camera)));
            self.root.push(Node {
                camera,
                children: (!below.is_empty()).then_some(below),
                extensions,
                extras: extras(node, levels, body.extras),
                matrix: None,
                mesh: mesh.or(body.mesh).map(at),
                name: Some(node.name.clone()),
                rotation: (node.rotation != glam::DQuat::IDENTITY)
                    .then(|| UnitQuaternion(node.rotation.as_quat().to_array())),
                scale: plain(node.scale, glam::DVec3::ONE),
                translation: plain(node.translation, glam::DVec3::ZERO),
                skin: node.skin.map(|skin| Index::new(mesh::index(skin))),
                weights: None,
            });
        }
        carrier::push(&mut self.root, scene, carriers);
        let name = Some(scene.name.clone());
        let scene = self.root.push(Scene { extensions: None, extras: None, name, nodes: top });
        self.root.scene = Some(scene);
    }

    /// Header, JSON chunk and binary chunk.
    fn finish(mut self) -> Result<Vec<u8>, WriteError> {
        self.binary.start();
        self.binary.buffers(&mut self.root);
        let binary = self.binary.bytes;
        let json = pointer::document(&mut self.root, &self.pointers)
            .expect("a glTF document has no map with other keys than text");
        container(json, binary)
    }
}

/// The bytes of a `.glb` file of its two chunks; the second is whole words. It is moved, not copied, where its memory has
/// room for the first before it.
///
/// # Errors
/// When the file would pass 4 GiB.
pub fn container(mut json: Vec<u8>, binary: Vec<u8>) -> Result<Vec<u8>, WriteError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() as u64 + 8 + binary.len() as u64;
    if length > u64::from(u32::MAX) {
        return Err(WriteError::TooLarge(length));
    }
    let word = |value: usize| u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes();
    let mut head = Vec::with_capacity(json.len() + 28);
    head.extend_from_slice(b"glTF");
    head.extend_from_slice(&word(2));
    head.extend_from_slice(&word(size(length)));
    head.extend_from_slice(&word(json.len()));
    head.extend_from_slice(b"JSON");
    head.extend_from_slice(&json);
    head.extend_from_slice(&word(binary.len()));
    head.extend_from_slice(b"BIN\0");
    let mut bytes = binary;
    bytes.splice(0..0, head);
    Ok(bytes)
}

/// One accessor to all elements of several that follow each other in their view.
fn joined(accessors: &mut Vec<Accessor>, parts: &[Index<Accessor>]) -> Index<Accessor> {
    let count = parts.iter().map(|part| accessors[part.value()].count.0).sum();
    let first = accessors[parts[0].value()].clone();
    accessors.push(Accessor { count: gltf::json::validation::USize64(count), ..first });
    Index::new(mesh::index(accessors.len() - 1))
}

/// What stands in the extras of a node.
fn extras(
    node: &crate::scene::Node,
    levels: gltf::json::Extras,
    colliders: Option<serde_json::Value>,
) -> gltf::json::Extras {
    let own = node.socket.then(motion::socket).flatten().or(levels);
    let Some(colliders) = colliders else { return own };
    let mut all: serde_json::Map<String, serde_json::Value> =
        own.and_then(|own| serde_json::from_str(own.get()).ok()).unwrap_or_default();
    all.insert("colliders".to_owned(), colliders);
    serde_json::value::to_raw_value(&all).ok()
}

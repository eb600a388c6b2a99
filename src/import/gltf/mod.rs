//! glTF 2.0 files, in one piece (`.glb`) or as text (`.gltf`) with their data in it or beside it.
//!
//! Promise: any valid file is read, its quantized, scattered and sparse accessors and what `EXT_meshopt_compression` packs
//! in a `.glb` file too, if it needs no other compression; a broken one is an error, never a panic. Every offset and
//! count is held against the bytes before anything is read. What is drawn, and what becomes a shape, is read by the same
//! code. Not promised: that what the specification asks for is held against all of it; the Khronos validator does that.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021.

mod accessor;
mod clip;
mod geometry;
mod look;
mod mesh;
mod rig;

use std::borrow::Cow;

use glam::{DMat4, DQuat, DVec3};
use gltf::json::validation::Validate as _;
use thiserror::Error;

pub(crate) use accessor::{Data, little, number, size};
pub use clip::{Channel, ChannelPath, Clip, PropertyChannel, Steps, Track};
pub use geometry::{FileState, Weighted, read, read_weighted};
pub(crate) use mesh::read as mesh;
pub use mesh::{Mesh, Part, Target};
pub use rig::{Rig, RigJoint};

use crate::packing::{PointerChannel, UnpackError, unpacked, without_pointers};

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    /// Its name, may be empty.
    pub name: String,
    /// Its children.
    pub children: Vec<usize>,
    /// Where it stands in its parent.
    pub place: Place,
    /// Its mesh.
    pub mesh: Option<usize>,
    /// Its skin.
    pub skin: Option<usize>,
    /// Weights of the targets of its mesh; those of the mesh where empty.
    pub weights: Vec<f64>,
    /// Nodes that stand for it at coarser levels of detail (`MSFT_lod`).
    pub levels: Vec<usize>,
    /// The camera at it, which looks along its -z with y up: its number in the file, and how it sees.
    pub camera: Option<(usize, Lens)>,
}

/// How a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// What is far away is smaller.
    Perspective {
        /// The angle from the lower to the upper border, radians.
        upright: f64,
        /// Nearer than this, nothing is seen.
        near: f64,
        /// Nor farther than this; `None` is endless.
        far: Option<f64>,
    },
    /// Parallel lines stay parallel.
    Orthographic {
        /// Half of what is seen from the lower to the upper border.
        half: f64,
        /// Nearer than this, nothing is seen.
        near: f64,
        /// Nor farther than this.
        far: f64,
    },
}

/// Where a node stands in its parent.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// By a matrix; clips do not move it.
    Matrix(DMat4),
    /// Scaled, then turned, then moved.
    Parts {
        /// The move.
        translation: DVec3,
        /// The turn, of length 1.
        rotation: DQuat,
        /// The scale.
        scale: DVec3,
    },
}

impl Place {
    /// As a matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

/// Joints that move a mesh.
#[derive(Clone, Debug)]
pub struct Skin {
    /// Nodes.
    pub joints: Vec<usize>,
    /// For each joint the way back from where it stands at rest.
    pub inverse: Vec<DMat4>,
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GltfFault {
    /// Not a `.glb` file, or cut off.
    #[error("it is not a whole .glb file: {0}")]
    Container(String),
    /// A buffer in another file, which cannot be read.
    #[error("buffer {0} stands in the file `{1}`, which cannot be read")]
    File(usize, String),
    /// A buffer in the document, which is not written as such are.
    #[error("the data of buffer {0} is not written in base64")]
    Base64(usize),
    /// A buffer that is shorter than the document says.
    #[error("buffer {0} has {1} bytes, and should have {2}")]
    Short(usize, usize, u64),
    /// Not a valid document.
    #[error("it is not a valid glTF document: {0}")]
    Document(String),
    /// Its compressed data is broken.
    #[error(transparent)]
    Packed(#[from] UnpackError),
    /// It needs what is not read here.
    #[error("it needs the extension {0}, which is not supported here")]
    Extension(String),
    /// A view reaches past the bytes of its buffer.
    #[error("buffer view {0} reaches past the end of the data")]
    View(usize),
    /// An accessor of the wrong kind, or without data.
    #[error("accessor {0} does not hold what it is used for")]
    Accessor(usize),
    /// A vertex is carried by a joint that its skin has not.
    #[error("mesh {0} is carried by joint {1}, which its skin does not have")]
    Joint(usize, u32),
    /// Keys that do not follow each other in time, from 0 on.
    #[error("the times of accessor {0} are not in order, or not from 0 on")]
    Times(usize),
    /// A joint that is bound by a matrix that cannot be undone, or in two ways.
    #[error("node {0}, a joint, is bound {1}")]
    Bound(usize, &'static str),
    /// An index of a mesh reaches past its vertices.
    #[error("mesh {0} uses vertex {1}, which does not exist")]
    Vertex(usize, u32),
    /// Nodes that contain themselves, or have two parents.
    #[error("node {0} stands in two places")]
    Tree(usize),
}

/// Extensions that a file may need.
const KNOWN: [&str; 3] = ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform"];

/// A file whose document is valid and whose buffers are there.
#[derive(Clone, Debug)]
pub struct GltfFile {
    /// Its document.
    pub(crate) document: gltf::Document,
    buffers: Vec<Vec<u8>>,
    /// For each node its parent.
    parents: Vec<Option<usize>>,
    /// Channels of animations that point at properties.
    pointers: Vec<PointerChannel>,
}

/// Opens a file; `open` reads others by their paths from it.
///
/// # Errors
/// See [`GltfFault`].
pub fn open(bytes: &[u8], open: &mut dyn FnMut(&str) -> Option<Vec<u8>>) -> Result<GltfFile, GltfFault> {
    let (json, binary) = if bytes.starts_with(b"glTF") {
        let bytes = unpacked(bytes)?;
        let container =
            gltf::Glb::from_slice(&bytes).map_err(|error| GltfFault::Container(error.to_string()))?;
        (Cow::Owned(container.json.into_owned()), container.bin.map(Cow::into_owned))
    } else {
        (Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)), None)
    };
    let parsed = serde_json::from_slice(&json).map(|root| (root, Vec::new())).or_else(|error| {
        let (rest, pointers) = without_pointers(&json).ok_or(error)?;
        Ok((serde_json::from_slice(&rest)?, pointers))
    });
    let (mut root, pointers): (gltf::json::Root, Vec<PointerChannel>) =
        parsed.map_err(|error: serde_json::Error| GltfFault::Document(error.to_string()))?;
    if let Some(unknown) = root.extensions_required.iter().find(|name| !KNOWN.contains(&name.as_str())) {
        return Err(GltfFault::Extension(unknown.clone()));
    }
    root.extensions_required.clear();
    // The library's own check takes these for granted.
    check_references(&root)?;
    let mut fault = None;
    root.validate(&root, gltf::json::Path::new, &mut |path, error| {
        fault.get_or_insert_with(|| format!("{}: {error}", path()));
    });
    if let Some(fault) = fault {
        return Err(GltfFault::Document(fault));
    }
    let parents = parents(&root)?;
    let mut binary = binary;
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let data = match &buffer.uri {
            None => binary.take().unwrap_or_default(),
            Some(uri) => buffer_of(index, uri, open)?,
        };
        if (data.len() as u64) < buffer.byte_length.0 {
            return Err(GltfFault::Short(index, data.len(), buffer.byte_length.0));
        }
        buffers.push(data);
    }
    let document = gltf::Document::from_json_without_validation(root);
    Ok(GltfFile { document, buffers, parents, pointers })
}

impl GltfFile {
    /// The document with its bytes.
    pub(crate) fn data(&self) -> Data<'_> {
        Data { document: &self.document, buffers: self.buffers.iter().map(Vec::as_slice).collect() }
    }

    /// All nodes.
    #[must_use]
    pub fn nodes(&self) -> Vec<Node> {
        self.document.nodes().map(|own| node(&own)).collect()
    }

    /// Nodes of the scene that is shown; without scenes, those that have no parent.
    #[must_use]
    pub fn roots(&self) -> Vec<usize> {
        match self.document.default_scene().or_else(|| self.document.scenes().next()) {
            Some(scene) => scene.nodes().map(|node| node.index()).collect(),
            None => (0..self.parents.len()).filter(|node| self.parents[*node].is_none()).collect(),
        }
    }

    /// All clips.
    ///
    /// # Errors
    /// When one of them is broken.
    pub fn clips(&self) -> Result<Vec<Clip>, GltfFault> {
        let data = self.data();
        self.document.animations().map(|own| clip::read(&data, &own, &self.pointers)).collect()
    }

    /// For each node the map from it to the scene.
    #[must_use]
    pub fn worlds(&self) -> Vec<DMat4> {
        let nodes = self.nodes();
        let mut worlds: Vec<Option<DMat4>> = vec![None; nodes.len()];
        for start in 0..nodes.len() {
            let mut open = vec![start];
            while let Some(node) = open.last().copied() {
                match self.parents[node] {
                    Some(parent) if worlds[parent].is_none() => open.push(parent),
                    parent => {
                        let outer = parent.and_then(|parent| worlds[parent]).unwrap_or(DMat4::IDENTITY);
                        worlds[node] = Some(outer * nodes[node].place.matrix());
                        open.pop();
                    }
                }
            }
        }
        worlds.into_iter().flatten().collect()
    }
}

/// The bytes of a buffer that stand in the document or in another file.
pub(crate) fn buffer_of(
    index: usize,
    uri: &str,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Vec<u8>, GltfFault> {
    if let Some(rest) = uri.strip_prefix("data:") {
        let (_, text) = rest.split_once(";base64,").ok_or(GltfFault::Base64(index))?;
        return base64(text.as_bytes()).ok_or(GltfFault::Base64(index));
    }
    let path = unescaped(uri);
    open(&path).ok_or(GltfFault::File(index, path))
}

/// Bytes written in base64 (RFC 4648, section 4), whether or not they are padded.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"==").or(text.strip_suffix(b"=")).unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut word, mut bits) = (0_u32, 0);
    for letter in text {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        word = word << 6 | u32::from(value);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((word >> bits).to_le_bytes()[0]);
            word &= (1 << bits) - 1;
        }
    }
    (bits < 6).then_some(bytes)
}

/// A path whose letters may be written as `%20` (RFC 3986, section 2.1); itself where that makes no text.
fn unescaped(uri: &str) -> String {
    let digit = |byte: u8| char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok());
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        if let (b'%', [high, low, after @ ..]) = (first, tail)
            && let (Some(high), Some(low)) = (digit(*high), digit(*low))
        {
            bytes.push(high << 4 | low);
            rest = after;
            continue;
        }
        bytes.push(*first);
        rest = tail;
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}

/// That attributes name accessors that there are, and clips nodes.
fn check_references(root: &gltf::json::Root) -> Result<(), GltfFault> {
    let missing = |what: String| Err(GltfFault::Document(format!("{what} does not exist")));
    for (mesh, own) in root.meshes.iter().enumerate() {
        for accessor in own.primitives.iter().flat_map(|primitive| primitive.attributes.values()) {
            if accessor.value() >= root.accessors.len() {
                return missing(format!("accessor {} of mesh {mesh}", accessor.value()));
            }
        }
    }
    for (clip, own) in root.animations.iter().enumerate() {
        for target in own.channels.iter().map(|channel| &channel.target) {
            if target.node.value() >= root.nodes.len() {
                return missing(format!("node {} of animation {clip}", target.node.value()));
            }
            if target.path == gltf::json::validation::Checked::Invalid {
                return missing(format!("a path of animation {clip}"));
            }
        }
    }
    Ok(())
}

/// For each node its parent; that every node has one at most, and none is above itself.
fn parents(root: &gltf::json::Root) -> Result<Vec<Option<usize>>, GltfFault> {
    let mut parents = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(|child| child.value()) {
            if parents[child].replace(index).is_some() {
                return Err(GltfFault::Tree(child));
            }
        }
    }
    // The node from which each was first come by: what is met again from one is above itself.
    let mut from = vec![usize::MAX; parents.len()];
    for start in 0..parents.len() {
        let mut next = Some(start);
        while let Some(node) = next.filter(|node| from[*node] == usize::MAX) {
            from[node] = start;
            next = parents[node];
        }
        if let Some(node) = next.filter(|node| from[*node] == start) {
            return Err(GltfFault::Tree(node));
        }
    }
    let mut shown = root.scenes.iter().flat_map(|scene| &scene.nodes).map(|node| node.value());
    match shown.find(|node| parents[*node].is_some()) {
        Some(node) => Err(GltfFault::Tree(node)),
        None => Ok(parents),
    }
}

fn vector([x, y, z]: [f32; 3]) -> DVec3 {
    DVec3::new(x.into(), y.into(), z.into())
}

fn node(own: &gltf::Node<'_>) -> Node {
    let place = match own.transform() {
        gltf::scene::Transform::Matrix { matrix } => {
            Place::Matrix(DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))))
        }
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => Place::Parts {
            translation: vector(translation),
            rotation: DQuat::from_array(rotation.map(f64::from)).normalize(),
            scale: vector(scale),
        },
    };
    Node {
        name: own.name().unwrap_or_default().to_owned(),
        children: own.children().map(|child| child.index()).collect(),
        place,
        mesh: own.mesh().map(|mesh| mesh.index()),
        skin: own.skin().map(|skin| skin.index()),
        weights: own.weights().unwrap_or_default().iter().map(|weight| f64::from(*weight)).collect(),
        levels: levels(own),
        camera: own.camera().map(|camera| (camera.index(), lens(&camera))),
    }
}

fn lens(camera: &gltf::Camera<'_>) -> Lens {
    match camera.projection() {
        gltf::camera::Projection::Perspective(own) => Lens::Perspective {
            upright: own.yfov().into(),
            near: own.znear().into(),
            far: own.zfar().map(f64::from),
        },
        gltf::camera::Projection::Orthographic(own) => {
            Lens::Orthographic { half: own.ymag().into(), near: own.znear().into(), far: own.zfar().into() }
        }
    }
}

/// A skin of a file; joints without a matrix have none that moves anything.
pub(crate) fn skin(data: &Data<'_>, own: &gltf::Skin<'_>) -> Result<Skin, GltfFault> {
    let joints: Vec<usize> = own.joints().map(|joint| joint.index()).collect();
    let mut inverse = vec![DMat4::IDENTITY; joints.len()];
    if let Some(accessor) = own.inverse_bind_matrices() {
        let matrices = data.numbers::<16>(&accessor)?;
        for (inverse, matrix) in inverse.iter_mut().zip(matrices) {
            *inverse = DMat4::from_cols_array(&matrix.map(f64::from));
        }
    }
    Ok(Skin { joints, inverse })
}

/// The coarser levels that a node names; indices that are none are told when the file is checked.
fn levels(node: &gltf::Node<'_>) -> Vec<usize> {
    let ids = node.extension_value("MSFT_lod").and_then(|own| own.get("ids")?.as_array());
    let index = |value: &serde_json::Value| value.as_u64().and_then(|index| usize::try_from(index).ok());
    ids.into_iter().flatten().map(|value| index(value).unwrap_or(usize::MAX)).collect()
}

#[cfg(test)]
mod tests;

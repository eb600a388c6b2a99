//! Autodesk 3D Studio scenes (3DS): meshes with materials and smoothing groups, cameras, lights, and their motions.
//!
//! A file is a tree of chunks: a number that says what it is, its length, and what is in it, often chunks again. Those
//! that are not known are passed over. Faces have up to 32 smoothing groups at once; colors are those of a screen. z
//! points up, corners run counter-clockwise. Points of an object at equal places are made one: the format repeats them
//! along seams of pictures.
//!
//! Promise: a chunk lies inside the one that holds it, and counts are held against its length, so that no more memory is
//! taken than a few times the file's length. Source: Autodesk, 3D Studio File Toolkit for Release 2, 1996; M. Fercoq,
//! 3DS file format, 1995.

mod chunk;
pub mod keyframe;
pub mod scene;

use thiserror::Error;

use super::{ImportError, ImportOptions, Imported, Note};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{PolygonMesh, index};
use scene::{Object, Scene};

/// Why a file is no scene.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StudioFault {
    /// Another file.
    #[error("the file does not begin with chunk 0x4d4d, as 3D Studio scenes do")]
    NotStudio,
    /// A chunk that what holds it has no room for.
    #[error("chunk 0x{id:04x} at byte {start} has {length} bytes, and there are {room}")]
    Chunk {
        /// Its number.
        id: u16,
        /// Its first byte.
        start: usize,
        /// How long it says that it is.
        length: u32,
        /// Bytes that are left where it stands.
        room: usize,
    },
    /// A chunk that ends too early.
    #[error("chunk 0x{id:04x} at byte {start} ends inside {what}")]
    Ends {
        /// Its number.
        id: u16,
        /// Its first byte.
        start: usize,
        /// What is cut off.
        what: &'static str,
    },
    /// A number that is none.
    #[error("chunk 0x{id:04x} at byte {start} has {value} for {what}, which is no finite number")]
    NotFinite {
        /// Its number.
        id: u16,
        /// Its first byte.
        start: usize,
        /// What it is for.
        what: &'static str,
        /// The value.
        value: f32,
    },
    /// Something that there is not.
    #[error("object `{object}` names {what} {index}, and has {count}, counted from 0")]
    Index {
        /// Its name.
        object: String,
        /// What is named.
        what: &'static str,
        /// Its number.
        index: u16,
        /// How many there are.
        count: usize,
    },
    /// Nodes that carry each other in a circle, or one that nothing is known of.
    #[error("node `{node}` is carried by node {parent}, which {why}")]
    Parent {
        /// Its name.
        node: String,
        /// Number of what should carry it.
        parent: u16,
        /// What is wrong with that.
        why: &'static str,
    },
    /// Keys that do not follow each other.
    #[error("the keys of node `{node}` do not follow each other: frame {next} stands after frame {before}")]
    Order {
        /// Its name.
        node: String,
        /// A frame.
        before: i32,
        /// The one after it.
        next: i32,
    },
}

/// Reads the meshes of a file as one: all objects, or the one of a name. Linear in its length.
///
/// # Errors
/// See [`StudioFault`]; a name that no object with faces has.
pub fn read(bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let scene = scene::read(bytes)?;
    let groups: Vec<String> = scene.objects.iter().map(|object| object.name.clone()).collect();
    let wanted = |object: &&Object| options.group.as_ref().is_none_or(|group| object.name == *group);
    if let Some(group) = options.group.as_ref().filter(|group| !groups.contains(group)) {
        return Err(ImportError::UnknownGroup { group: group.clone(), known: groups });
    }
    let mut mesh = PolygonMesh::default();
    for object in scene.objects.iter().filter(wanted) {
        append(&mut mesh, object);
    }
    if mesh.faces.is_empty() {
        return Err(match &options.group {
            Some(group) => ImportError::EmptyGroup { group: group.clone() },
            None => ImportError::NoFaces { vertices: index(mesh.points.len()) },
        });
    }
    if let Some(weld) = options.weld {
        mesh.weld(weld);
    }
    let materials = scene.looks(&mesh.materials);
    let mut notes = Vec::new();
    let beside = scene.cameras.len() + scene.lights.len();
    let motions = scene.nodes.iter().filter(|node| node.moves()).count();
    if beside + motions > 0 {
        let message = format!(
            "its {} cameras, {} lights and {motions} motions are left out; `[node.NAME.import]` reads the whole scene",
            scene.cameras.len(),
            scene.lights.len()
        );
        notes.push(Note { line: None, message });
    }
    Ok(Imported { mesh, materials, groups, notes })
}

/// Adds the faces of an object to a mesh, where they stand.
pub fn append(mesh: &mut PolygonMesh, object: &Object) {
    let own = weld_equal(&object.points);
    let first = index(mesh.points.len());
    let first_uv = index(mesh.uvs.len());
    mesh.points.extend(own.points);
    mesh.uvs.extend(&object.uvs);
    mesh.has_smoothing |= object.has_smoothing;
    mesh.smoothing_masks = true;
    for face in &object.faces {
        let material = face.material.as_ref().map(|name| {
            mesh.materials.iter().position(|known| known == name).unwrap_or_else(|| {
                mesh.materials.push(name.clone());
                mesh.materials.len() - 1
            })
        });
        let corners = face.corners.map(|corner| first + own.map[usize::from(corner)]);
        let before = mesh.corners.len();
        mesh.push_face(&[&corners], material.map(index), face.smoothing);
        if !object.uvs.is_empty() {
            mesh.corner_uvs.resize(before, NONE);
            mesh.corner_uvs.extend(face.corners.map(|corner| first_uv + u32::from(corner)));
        }
    }
    if !mesh.corner_uvs.is_empty() {
        mesh.corner_uvs.resize(mesh.corners.len(), NONE);
    }
}

/// Reads a whole file.
///
/// # Errors
/// See [`StudioFault`].
pub fn read_scene(bytes: &[u8]) -> Result<Scene, ImportError> {
    Ok(scene::read(bytes)?)
}

#[cfg(test)]
mod tests;

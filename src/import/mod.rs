//! The import stage: bytes of other programs' files into polygon meshes, image facts and motions.
//!
//! Promise: no input makes a reader panic, hang, or take memory out of proportion to its size; what is refused is
//! refused with the line, the value and the limit; what is passed over is told in a [`Note`]. Readers open nothing
//! themselves: other files come through a door that the caller passes in.

pub mod bvh;
mod bytes;
pub mod dxf;
mod error;
mod foreign;
pub mod gltf;
pub mod heights;
pub mod image;
pub mod keyframes;
pub mod look;
pub mod md2;
pub mod md3;
pub mod md5;
pub mod obj;
pub mod ply;
pub mod stl;
pub mod studio;

use crate::geometry::mesh::PolygonMesh;

pub use error::ImportError;
pub use foreign::{Foreign, recognize};
pub use look::MaterialLook;

/// What to read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Only the faces of this group, object or solid.
    pub group: Option<String>,
    /// Join points that are within this distance, in the units of the file; 0 joins equal points. Without it OBJ points
    /// stay as they are, STL points are joined within rounding, and those of glTF where they are equal.
    pub weld: Option<f64>,
    /// No more triangles than this are read from a glTF file, where one mesh may stand in many places; 0 is no limit.
    pub most: u64,
}

/// What a file held, in its own units and axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// The faces; valid in the sense of [`PolygonMesh::validate`].
    pub mesh: PolygonMesh,
    /// What the materials of `mesh` look like, as far as the file says; in the order of its names.
    pub materials: Vec<MaterialLook>,
    /// Names of groups, objects or solids in the order of the file, also those not read.
    pub groups: Vec<String>,
    /// What was passed over or put right.
    pub notes: Vec<Note>,
}

/// Something passed over or put right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line of the file, counted from 1; `None` when it concerns the whole file.
    pub line: Option<u32>,
    /// What happened, in lower case without a full stop.
    pub message: String,
}

/// Whether files of this ending, in lower case, have z up by custom; those of the others have y.
#[must_use]
pub fn z_is_up(ending: &str) -> bool {
    matches!(ending, "stl" | "3ds" | "dxf" | "md2" | "md3" | "md5mesh" | "md5anim")
}

/// The mesh of a file by the ending of its name, in lower case; of one with frames, its first. `None` where meshes of
/// that ending are not read. `open` gives files by their paths from this one.
pub fn read(
    ending: &str,
    bytes: &[u8],
    options: &ImportOptions,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Option<Result<Imported, ImportError>> {
    let group = options.group.as_deref();
    Some(match ending {
        "stl" => stl::read(bytes, options),
        "obj" => obj::read(bytes, options, open),
        "ply" => ply::read(bytes, options),
        "3ds" => studio::read(bytes, options),
        "dxf" => dxf::read(bytes, options),
        "md2" => md2::read(bytes).map(|found| found.frame(0)).map_err(ImportError::from),
        "md3" => md3::read(bytes, group).map(|found| found.frame(0)),
        "md5mesh" => md5::mesh::read(bytes, group).map(|found| {
            let mut imported = found.imported;
            if let Some(weld) = options.weld {
                imported.mesh.weld(weld);
            }
            imported
        }),
        "glb" | "gltf" => gltf::read(bytes, options, open),
        _ => return None,
    })
}

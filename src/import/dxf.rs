//! Drawings of CAD programs (DXF), text and binary: faces and meshes, and lines, arcs and splines as curves.
//!
//! A drawing is a row of pairs, a code and a value. Read are 3DFACE, SOLID, TRACE, polygon and polyface meshes, MESH; LINE,
//! LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE; INSERT of blocks, also in rows and columns, one in the
//! other. Everything lies on a layer, and what a block has on layer `0` on that of its INSERT. Entities of other kinds are
//! passed over, and a note counts them. Lengths are the drawing's; z points up.
//!
//! Promise: what blocks multiply is counted before it is made, and blocks that hold themselves are refused. Source:
//! Autodesk, DXF Reference, 2012.

mod block;
mod curve;
mod entity;
mod pairs;

use glam::DVec3;
use thiserror::Error;

use super::{ImportError, ImportOptions, Imported, Note};
use crate::geometry::mesh::weld::weld_near;
use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::number::{Bounds, single_rounding};
pub use curve::{Drawn, Piece};
use entity::Kind;

/// Why a file is no drawing. Places are lines of a text, or bytes of a binary file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DxfFault {
    /// Another file.
    #[error("this is no DXF drawing: it does not begin with a section or a comment")]
    NotDxf,
    /// A code that is none.
    #[error("expected the code of a pair, found `{found}`")]
    Code {
        /// Where.
        place: Place,
        /// What stands there.
        found: String,
    },
    /// The file ends too early.
    #[error("the drawing ends inside {what}")]
    Ends {
        /// The last place.
        place: Place,
        /// What is cut off.
        what: &'static str,
    },
    /// What is no number.
    #[error("expected a number for code {code}, found `{found}`")]
    Number {
        /// Where.
        place: Place,
        /// The code of the pair.
        code: i32,
        /// What stands there.
        found: String,
    },
    /// A corner that there is not.
    #[error("{entity} has a face with vertex {index}, and it has {count}")]
    Index {
        /// Where the entity begins.
        place: Place,
        /// What it is.
        entity: &'static str,
        /// The number.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// Numbers that make no entity.
    #[error("{entity} {what}")]
    Entity {
        /// Where it begins.
        place: Place,
        /// What it is.
        entity: &'static str,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A block that holds itself.
    #[error("block `{block}` holds itself")]
    Circle {
        /// Its name.
        block: String,
    },
    /// Blocks in blocks without end.
    #[error("blocks are inserted in each other more than {} deep", block::DEEPEST)]
    Deep,
    /// Blocks that multiply beyond measure.
    #[error("the blocks that are inserted make {count} points, and at most {} are read", block::MOST_POINTS)]
    TooMany {
        /// How many.
        count: u64,
    },
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1.
    Line(u32),
    /// A byte of a binary file.
    Byte(usize),
}

impl DxfFault {
    /// The line of a text that it stands on.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        match self {
            Self::Code { place, .. }
            | Self::Ends { place, .. }
            | Self::Number { place, .. }
            | Self::Index { place, .. }
            | Self::Entity { place, .. } => match place {
                Place::Line(line) => Some(*line),
                Place::Byte(_) => None,
            },
            _ => None,
        }
    }
}

/// A drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// What is drawn, with blocks in place.
    items: Vec<entity::Item>,
    /// Names of layers in the order of their first use.
    pub layers: Vec<String>,
    /// How many entities of other kinds there are, by their names.
    others: Vec<(String, usize)>,
}

/// Reads a drawing. O(n log n) in its length and in what its blocks make.
///
/// # Errors
/// See [`DxfFault`].
pub fn drawing(bytes: &[u8]) -> Result<Drawing, DxfFault> {
    let parts = entity::read(pairs::Pairs::new(bytes)?)?;
    let items = block::placed(&parts)?;
    let mut drawing = Drawing { items, layers: Vec::new(), others: parts.others };
    for item in &drawing.items {
        if !drawing.layers.contains(&item.layer) {
            drawing.layers.push(item.layer.clone());
        }
    }
    Ok(drawing)
}

/// Reads the faces of a drawing, or of one of its layers. Points are joined as those of STL files are: within
/// [`ImportOptions::weld`], by default within the rounding of single precision. Materials have the names of layers.
///
/// # Errors
/// See [`DxfFault`]; a layer that there is not; no face.
pub fn read(bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let drawing = drawing(bytes)?;
    let wanted = |item: &&entity::Item| options.group.as_ref().is_none_or(|group| item.layer == *group);
    if let Some(group) = options.group.as_ref().filter(|group| !drawing.layers.contains(group)) {
        return Err(ImportError::UnknownGroup { group: group.clone(), known: drawing.layers });
    }
    let mut points: Vec<DVec3> = Vec::new();
    let mut faces: Vec<(String, Vec<u32>)> = Vec::new();
    let mut curves = 0;
    for item in drawing.items.iter().filter(wanted) {
        let Kind::Faces { points: own, faces: of } = &item.kind else {
            curves += 1;
            continue;
        };
        let first = index(points.len());
        points.extend(own);
        faces.extend(of.iter().map(|face| (item.layer.clone(), face.iter().map(|at| first + at).collect())));
    }
    let reach = Bounds::of_points(points.iter().copied()).reach();
    let welded = weld_near(&points, options.weld.unwrap_or_else(|| single_rounding(reach)));
    let mut mesh = PolygonMesh { points: welded.points, ..PolygonMesh::default() };
    let mut thin = 0;
    for (layer, face) in faces {
        let mut corners: Vec<u32> = face.iter().map(|at| welded.map[*at as usize]).collect();
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() < 3 {
            thin += 1;
            continue;
        }
        let material = mesh.materials.iter().position(|name| *name == layer).unwrap_or_else(|| {
            mesh.materials.push(layer);
            mesh.materials.len() - 1
        });
        mesh.push_face(&[&corners], Some(index(material)), 0);
    }
    if mesh.faces.is_empty() {
        return Err(match &options.group {
            Some(group) => ImportError::EmptyGroup { group: group.clone() },
            None => ImportError::NoFaces { vertices: index(mesh.points.len()) },
        });
    }
    let mut notes = Vec::new();
    let mut tell = |message: String| notes.push(Note { line: None, message });
    if curves > 0 {
        tell(format!("{curves} lines and curves are left out; `[curve.NAME.dxf]` reads them"));
    }
    if thin > 0 {
        tell(format!("{thin} faces have fewer than three corners and are left out"));
    }
    for (name, count) in &drawing.others {
        tell(format!("{count} entities {name} are left out"));
    }
    Ok(Imported { mesh, materials: Vec::new(), groups: drawing.layers, notes })
}

#[cfg(test)]
mod tests;

//! Where the triangles of a file are defined.
//!
//! Promise: a triangle leads to the definition whose surface it lies on, through groups, arrays, deformations and solids;
//! those that an operation adds (the caps of a cut, a hull) lead to the operation.
//! No promise: lines and normals of the text within a definition are not told apart.

use crate::build::Built;
use crate::gltf::Written;
use crate::language::source::Span;
use crate::model::ShapeHandle;
use crate::realize;

/// Where the triangles of a file are defined.
#[derive(Clone, Debug)]
pub struct Origins {
    /// For each mesh of the file its geometry.
    meshes: Vec<usize>,
    geometries: Vec<GeometryOrigins>,
}

#[derive(Clone, Debug)]
struct GeometryOrigins {
    /// For each written vertex its surface.
    sources: Vec<u32>,
    /// For each surface where it is defined.
    places: Vec<Span>,
    /// Where the whole is defined.
    whole: Span,
}

impl Origins {
    pub(super) fn new(
        (built, shapes): (&Built, &[ShapeHandle]),
        meshes: Vec<usize>,
        written: &Written,
    ) -> Self {
        let place = |shape: ShapeHandle| super::place(built, shape);
        let geometry = |(known, shape): (&crate::gltf::WrittenGeometry, &ShapeHandle)| {
            let sources = realize::sources(&built.model, *shape);
            GeometryOrigins {
                sources: known.anchors.iter().map(|anchor| anchor.source).collect(),
                places: sources.iter().map(|source| place(source.shape())).collect(),
                whole: place(*shape),
            }
        };
        let geometries = written.geometries.iter().zip(shapes).map(geometry).collect();
        Self { meshes, geometries }
    }

    /// The header of the definition that a triangle comes from: index of the mesh in the file, and of the vertices at its
    /// corners. Where corners are shared with a neighbour, most decide. None when there is no such mesh.
    #[must_use]
    pub fn place(&self, mesh: usize, corners: [usize; 3]) -> Option<Span> {
        let geometry = self.geometries.get(*self.meshes.get(mesh)?)?;
        let of = |corner: usize| {
            let source = *geometry.sources.get(corner)?;
            geometry.places.get(source as usize).copied().filter(|place| !place.is_none())
        };
        let [a, b, c] = corners.map(of);
        Some(if b == c { b } else { a }.unwrap_or(geometry.whole))
    }
}

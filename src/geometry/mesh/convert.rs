//! Polygons into triangles with normals: a [`PolygonMesh`] becomes a [`Mesh`].
//!
//! Promise: every boundary edge of every face is kept, so what was closed stays closed; vertices are split only
//! where a normal, a UV or a color differs; triangles are grouped by material and otherwise keep the order of the faces.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use crate::geometry::mesh::normals::{Smooth, corner_normals};
use crate::geometry::mesh::polygon::{NONE, PolygonError};
use crate::geometry::mesh::triangulate::{split_quad, triangulate_in_space, view};
use crate::geometry::mesh::{Anchor, Color, Mesh, PolygonMesh, Run, Vertex, VertexIndex, index};

/// Where normals come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// The mesh's own normals where it has them, else its smoothing groups, else the crease angle.
    #[default]
    Auto,
    /// Every face flat.
    Flat,
    /// Every edge smooth.
    Smooth,
}

/// How to convert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvertOptions {
    /// Where normals come from.
    pub shading: Shading,
    /// Edges whose faces turn by more than this many degrees are hard, where [`Shading::Auto`] comes to it.
    pub crease_angle: f64,
}

impl Default for ConvertOptions {
    fn default() -> Self {
        Self { shading: Shading::Auto, crease_angle: 30.0 }
    }
}

/// A converted mesh and what happened on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Converted {
    /// The triangles. [`Run::origin`] is an index into `materials`.
    pub mesh: Mesh,
    /// The material of each run: an index into [`PolygonMesh::materials`].
    pub materials: Vec<Option<u32>>,
    /// Faces that vanished because their corners stand on fewer than three positions.
    pub dropped_faces: Vec<u32>,
    /// Faces whose corners all lie on one line. Their triangles stay, for the edges they share with others.
    pub flat_faces: Vec<u32>,
    /// Faces that cross themselves, or are too bent to be seen flat: their boundary is right, their inside may fold.
    pub crossing_faces: Vec<u32>,
}

/// Converts a valid mesh. O(n log n); polygons of many corners as in [`triangulate_in_space`].
///
/// # Errors
/// What [`PolygonMesh::validate`] finds. Degenerate and self-crossing faces are no errors; see [`Converted`].
pub fn convert(source: &PolygonMesh, options: &ConvertOptions) -> Result<Converted, PolygonError> {
    source.validate()?;
    let normals = normals_of(source, options);
    let mut out = Converted::default();
    let mut splitter = Splitter::new(source, &normals);
    for (material, faces) in faces_by_material(source) {
        let before = splitter.triangles.len();
        for face in faces {
            splitter.push_face(face, &mut out);
        }
        if splitter.triangles.len() > before {
            let end = index(splitter.triangles.len());
            splitter.runs.push(Run { origin: index(out.materials.len()), end });
            out.materials.push(material);
        }
    }
    out.dropped_faces.sort_unstable();
    out.flat_faces.sort_unstable();
    out.crossing_faces.sort_unstable();
    out.mesh = splitter.finish();
    Ok(out)
}

/// Faces of each material, materials in the order of their first face.
fn faces_by_material(source: &PolygonMesh) -> Vec<(Option<u32>, Vec<usize>)> {
    let mut groups: Vec<(Option<u32>, Vec<usize>)> = Vec::new();
    let mut place = vec![None; source.materials.len() + 1];
    for (number, face) in source.faces.iter().enumerate() {
        let slot = face.material.map_or(source.materials.len(), |material| material as usize);
        let group = *place[slot].get_or_insert_with(|| {
            groups.push((face.material, Vec::new()));
            groups.len() - 1
        });
        groups[group].1.push(number);
    }
    groups
}

fn normals_of(source: &PolygonMesh, options: &ConvertOptions) -> Vec<DVec3> {
    let rule = match options.shading {
        Shading::Flat => Smooth::Never,
        Shading::Smooth => Smooth::Always,
        Shading::Auto if source.has_smoothing => Smooth::Groups,
        Shading::Auto => Smooth::Within(options.crease_angle),
    };
    let given = |corner: usize| {
        let normal = *source.corner_normals.get(corner)?;
        if normal == NONE { None } else { source.normals[normal as usize].try_normalize() }
    };
    let own = options.shading == Shading::Auto;
    if own && !source.corners.is_empty() && (0..source.corners.len()).all(|corner| given(corner).is_some()) {
        return (0..source.corners.len()).filter_map(given).collect();
    }
    let mut normals = corner_normals(source, rule);
    if own {
        for (corner, normal) in normals.iter_mut().enumerate() {
            *normal = given(corner).unwrap_or(*normal);
        }
    }
    normals
}

/// Vertices in the chain of one point; a table holds the others.
const CHAIN_LIMIT: usize = 16;

/// Makes vertices, one for each different (point, normal, UV, color).
struct Splitter<'a> {
    source: &'a PolygonMesh,
    normals: &'a [DVec3],
    vertices: Vec<Vertex>,
    triangles: Vec<[VertexIndex; 3]>,
    runs: Vec<Run>,
    /// The chain of the first vertices on each point: its newest, and for each vertex the one made before it.
    newest: Vec<u32>,
    older: Vec<u32>,
    /// Vertices of points whose chains grew long.
    crowded: HashMap<(u32, [u64; 5], [u32; 4]), u32>,
}

impl<'a> Splitter<'a> {
    fn new(source: &'a PolygonMesh, normals: &'a [DVec3]) -> Self {
        Self {
            source,
            normals,
            vertices: Vec::with_capacity(source.points.len()),
            triangles: Vec::with_capacity(source.corners.len()),
            runs: Vec::new(),
            newest: vec![NONE; source.points.len()],
            older: Vec::new(),
            crowded: HashMap::new(),
        }
    }

    fn push_face(&mut self, face: usize, out: &mut Converted) {
        let start = self.source.corners_of(face).start;
        let triangles = self.cut(face, out);
        let before = self.triangles.len();
        for triangle in triangles {
            let corners = triangle.map(|corner| start + corner as usize);
            let [a, b, c] = corners.map(|corner| self.source.position(corner));
            if a != b && b != c && c != a {
                let vertices = corners.map(|corner| self.vertex(corner));
                self.triangles.push(vertices);
            }
        }
        if self.triangles.len() == before {
            out.dropped_faces.push(index(face));
        }
    }

    /// Triangles of a face, as corners counted from its first.
    fn cut(&self, face: usize, out: &mut Converted) -> Vec<[u32; 3]> {
        let corners = self.source.corners_of(face);
        if corners.len() == 3 {
            let [a, b, c] = [0, 1, 2].map(|step| self.source.position(corners.start + step));
            // Corners on one place are told of as dropped.
            if (b - a).cross(c - a) == DVec3::ZERO && a != b && b != c && c != a {
                out.flat_faces.push(index(face));
            }
            return vec![[0, 1, 2]];
        }
        let loops = self.source.loops_of(face);
        if corners.len() == 4 && loops.len() == 1 {
            let positions = [0, 1, 2, 3].map(|step| self.source.position(corners.start + step));
            if let Some(split) = split_quad(positions) {
                return split.to_vec();
            }
        }
        let rings: Vec<Vec<DVec3>> = self
            .source
            .loops_of(face)
            .map(|ring| {
                self.source.corners_of_loop(ring).map(|corner| self.source.position(corner)).collect()
            })
            .collect();
        let slices: Vec<&[DVec3]> = rings.iter().map(Vec::as_slice).collect();
        match triangulate_in_space(&slices) {
            Ok((triangles, true)) => triangles,
            Ok((triangles, false)) => {
                let flat = view(&slices) == DVec3::ZERO;
                let list = if flat { &mut out.flat_faces } else { &mut out.crossing_faces };
                list.push(index(face));
                triangles
            }
            // More corners than can be triangulated.
            Err(_) => {
                out.crossing_faces.push(index(face));
                fans(&slices)
            }
        }
    }

    fn vertex(&mut self, corner: usize) -> VertexIndex {
        let point = self.source.corners[corner];
        let uv = self.source.corner_uvs.get(corner).filter(|&&uv| uv != NONE);
        let uv = uv.map_or(DVec2::ZERO, |&uv| self.source.uvs[uv as usize]);
        let normal = self.normals[corner];
        let color = self.source.corner_colors.get(corner);
        let color = color.map_or(Color::WHITE, |&color| self.source.colors[color as usize]);
        let wanted = Vertex { point, normal, uv, color, anchor: Anchor::default() };
        let mut vertex = self.newest[point.subscript()];
        for _ in 0..CHAIN_LIMIT {
            if vertex == NONE {
                let made = self.push_vertex(wanted);
                self.older.push(std::mem::replace(&mut self.newest[point.subscript()], made.0));
                return made;
            }
            let made = &self.vertices[vertex as usize];
            if made.normal == normal && made.uv == uv && made.color == color {
                return VertexIndex(vertex);
            }
            vertex = self.older[vertex as usize];
        }
        // Adding zero turns -0 into 0: equal values must have equal bits.
        let bits = [normal.x, normal.y, normal.z, uv.x, uv.y].map(|value| (value + 0.0).to_bits());
        let shade = color.0.map(|part| (part + 0.0).to_bits());
        if let Some(&vertex) = self.crowded.get(&(point.0, bits, shade)) {
            return VertexIndex(vertex);
        }
        let vertex = self.push_vertex(wanted);
        self.older.push(NONE);
        self.crowded.insert((point.0, bits, shade), vertex.0);
        vertex
    }

    fn push_vertex(&mut self, wanted: Vertex) -> VertexIndex {
        let vertex = index(self.vertices.len());
        self.vertices.push(wanted);
        VertexIndex(vertex)
    }

    fn finish(self) -> Mesh {
        Mesh {
            points: self.source.points.clone(),
            vertices: self.vertices,
            triangles: self.triangles,
            runs: self.runs,
        }
    }
}

/// Each ring as a fan from its first corner.
fn fans(rings: &[&[DVec3]]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut start = 0;
    for ring in rings {
        let end = start + index(ring.len());
        triangles.extend((start + 1..end - 1).map(|corner| [start, corner, corner + 1]));
        start = end;
    }
    triangles
}

#[cfg(test)]
mod tests;

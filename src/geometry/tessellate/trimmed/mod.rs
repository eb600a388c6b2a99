//! Parts of surfaces inside closed lines of their parameters.
//!
//! Promise: the lines are cut first, within the tolerance in space, and the inside is filled with triangles that are
//! Delaunay in parameters drawn to the size of the surface. Lines may run over edges of the surface, which stay edges of
//! the mesh, and over the seam of a closed one; what lies on both ends of a closed surface, or on a pole, is one point, so
//! that nothing cracks there. Triangles are judged as those of whole surfaces are. The bound is `Sampled`: the lines are
//! compared with their chords at places. Not promised: that lines which cross each other are found before the filling.

mod cells;
mod chart;
mod lines;
mod split;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::patch::Block;
use super::region::{Filled, NO_LINE, Outline, Place, Wanted, fill};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh::weld::weld_near;
use crate::geometry::mesh::{self, Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::{self, Bounds, floor_count};
use crate::geometry::surface::{AnySurface, Surface as _};
use cells::{Cells, Direction};
use chart::ParameterChart;
use lines::Cut;
use split::Part;

/// A surface and the lines it ends at.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSurface {
    surface: AnySurface,
    outlines: Vec<AnyCurve>,
    cells: Cells,
}

impl TrimmedSurface {
    /// A surface and closed curves of its parameters (x is u, y is v) that do not meet. What an odd number of them goes
    /// around is left. Around a closed surface parameters go on and come round: there the outlines may run over the seam.
    #[must_use]
    pub fn new(surface: AnySurface, outlines: Vec<AnyCurve>) -> Self {
        let cells = Cells::new(&surface, outlines.iter().map(|outline| range_of(lines::rough(outline))));
        Self { surface, outlines, cells }
    }

    /// The whole surface.
    #[must_use]
    pub fn surface(&self) -> &AnySurface {
        &self.surface
    }

    /// The curves.
    #[must_use]
    pub fn outlines(&self) -> &[AnyCurve] {
        &self.outlines
    }

    /// The point of the surface at parameters that may have come round.
    #[must_use]
    pub fn point(&self, place: DVec2) -> DVec3 {
        let own = self.cells.parameters(place);
        self.surface.evaluate(own.x, own.y).point
    }

    /// The least and greatest parameters of the outlines.
    #[must_use]
    pub fn range(&self) -> (DVec2, DVec2) {
        range_of(self.outlines.iter().flat_map(lines::rough))
    }

    /// The box of points of the surface over the range of its outlines.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let (low, high) = self.range();
        let at = |x: u32, y: u32| low + (high - low) * DVec2::new(f64::from(x), f64::from(y)) / 16.0;
        let places = (0..=16).flat_map(|x| (0..=16).map(move |y| at(x, y)));
        Bounds::of_points(places.map(|place| self.point(place)))
    }
}

fn range_of(places: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}

/// Times that the lines are cut finer, where their chords cross in the plane of the parameters or hold triangles away from
/// the surface.
const TRIES: usize = 6;

/// The share of the tolerance that the lines may use.
const LINES: f64 = 0.8;

/// Cuts what is left of a surface into triangles. Anchor source 0, with the parameters of the surface. The normals are
/// du x dv. A fixed grid gives each outline `u` chords and the range of parameters a lattice of `u` by `v` points.
///
/// # Errors
/// When the limit is passed, nothing is left, or outlines meet.
pub fn trimmed(shape: &TrimmedSurface, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let (mut cut, tolerance) = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => (Cut::Within(LINES * tolerance), tolerance),
        SurfaceDensity::Grid { u, .. } => (Cut::Into(u.max(4)), f64::INFINITY),
    };
    let mut last = None;
    for _ in 0..TRIES {
        let Some(made) = attempt(shape, (cut, tolerance), detail)? else {
            cut = cut.finer();
            continue;
        };
        if made.mesh.triangles.is_empty() {
            return Err(TessellateError::NoArea);
        }
        if made.deviation.bound <= tolerance {
            return Ok(made);
        }
        last = Some(made);
        cut = cut.finer();
    }
    last.ok_or(TessellateError::Tangled)
}

/// What is left, with lines cut in a way; `None` where chords cross.
fn attempt(
    shape: &TrimmedSurface,
    (cut, tolerance): (Cut, f64),
    detail: &Detail,
) -> Result<Option<Tessellation>, TessellateError> {
    let limit = detail.triangle_limit;
    let mut loops = lines::loops(shape, cut, limit)?;
    let parts = split::parts(shape, &mut loops, cut, limit)?;
    let mut points = Vec::new();
    let mut faces: Vec<Face<'_>> =
        parts.iter().map(|part| Face::new(shape, part, tolerance, &mut points)).collect();
    let border = points.len();
    let (low, high) = shape.range();
    let mut bound = loops.deviation;
    let mut made = 0;
    for face in &mut faces {
        let lattice = match detail.density {
            SurfaceDensity::Grid { u, v } => {
                let share = (face.range.1 - face.range.0) / (high - low);
                let steps =
                    |count: u32, share: f64| floor_count((f64::from(count) * share - 1e-9).ceil()).max(1);
                Some([steps(u, share.x), steps(v, share.y)])
            }
            SurfaceDensity::Tolerance(_) => None,
        };
        let wanted = Wanted { tolerance, limit: limit.saturating_sub(made), lattice };
        let Ok(filled) = fill(&face.chart, &face.outline, &mut points, wanted)? else { return Ok(None) };
        bound = bound.max(filled.bound);
        made += filled.triangles.len() as u64;
        face.filled = Some(filled);
    }
    let mesh = joined(shape, &faces, (&points, border), detail);
    Ok(Some(Tessellation { mesh, deviation: Deviation { bound, evidence: Evidence::Sampled } }))
}

/// What is left of one cell of the surface.
struct Face<'a> {
    chart: ParameterChart<'a>,
    outline: Outline,
    range: (DVec2, DVec2),
    filled: Option<Filled>,
}

impl<'a> Face<'a> {
    /// Its border; the points of it are appended.
    fn new(shape: &'a TrimmedSurface, part: &Part, tolerance: f64, points: &mut Vec<DVec3>) -> Self {
        let [u, v] = &shape.cells.directions;
        let ends = |direction: &Direction, cell: usize| (direction.own(cell), direction.own(cell + 1));
        let block = Block::alone(&shape.surface, ends(u, part.cell[0]), ends(v, part.cell[1]));
        let range = range_of(part.edges.iter().flatten().copied());
        let chart = ParameterChart::new(block, range, tolerance);
        let mut outline = Outline::default();
        let mut known: BTreeMap<[u64; 2], usize> = BTreeMap::new();
        for edge in &part.edges {
            let ends = edge.map(|place| {
                *known.entry(place.to_array().map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                    let at = chart.drawn(place);
                    outline.places.push(Place { at, point: mesh::index(points.len()), lines: [NO_LINE; 2] });
                    points.push(chart.jet(place).point);
                    outline.places.len() - 1
                })
            });
            if ends[0] != ends[1] {
                outline.edges.push(ends);
            }
        }
        Self { chart, outline, range, filled: None }
    }
}

/// Points of the border nearer to each other than this share of the size are one: on a side between two cells, at both ends
/// of a closed surface, or on a pole.
const ONE_PLACE: f64 = 1e-9;

/// One mesh of all faces. The first `border` points are those of their borders.
fn joined(
    shape: &TrimmedSurface,
    faces: &[Face<'_>],
    (points, border): (&[DVec3], usize),
    detail: &Detail,
) -> Mesh {
    let size = Bounds::of_points(points.iter().copied()).diagonal();
    let welded = weld_near(&points[..border], ONE_PLACE * size);
    let mut made = Mesh { points: welded.points, ..Mesh::default() };
    let inner = mesh::index(made.points.len());
    made.points.extend_from_slice(&points[border..]);
    let moved = |point: u32| {
        let index = point as usize;
        if index < border { welded.map[index] } else { inner + mesh::index(index - border) }
    };
    for face in faces {
        let Some(filled) = &face.filled else { continue };
        let places: BTreeMap<u32, DVec2> = filled.places.iter().copied().collect();
        let mut known: BTreeMap<u32, u32> = BTreeMap::new();
        for corners in &filled.triangles {
            let [a, b, c] = corners.map(moved);
            if a == b || b == c || c == a {
                continue;
            }
            let vertices = corners.map(|corner| {
                let index = *known.entry(corner).or_insert_with(|| {
                    let place = face.chart.parameters(places[&corner]);
                    let mut vertex = vertex(shape, place, face.chart.jet(place).normal, detail.uv);
                    vertex.point = PointIndex(moved(corner));
                    made.vertices.push(vertex);
                    mesh::index(made.vertices.len() - 1)
                });
                VertexIndex(index)
            });
            made.triangles.push(vertices);
        }
    }
    smooth_joints(&mut made, detail.crease_angle);
    share_vertices(&mut made);
    keep_used(&mut made);
    made.runs = vec![Run { origin: 0, end: mesh::index(made.triangles.len()) }];
    made
}

fn vertex(shape: &TrimmedSurface, place: DVec2, normal: DVec3, uv: bool) -> Vertex {
    let [u, v] = &shape.cells.directions;
    let part = DVec2::new((place.x - u.own(0)) / u.span(), (place.y - v.own(0)) / v.span());
    Vertex {
        point: PointIndex(0),
        normal,
        uv: if uv { DVec2::new(part.x, 1.0 - part.y) } else { DVec2::ZERO },
        color: Color::WHITE,
        anchor: Anchor { source: 0, u: place.x, v: place.y },
    }
}

/// Vertices on one point whose normals turn by no more than the crease angle get one normal.
fn smooth_joints(made: &mut Mesh, crease_angle: f64) {
    let least = number::sin_cos_degrees(crease_angle.clamp(0.0, 180.0)).1;
    let mut at: BTreeMap<PointIndex, Vec<usize>> = BTreeMap::new();
    for (index, vertex) in made.vertices.iter().enumerate() {
        at.entry(vertex.point).or_default().push(index);
    }
    for all in at.values().filter(|all| all.len() > 1) {
        let normals: Vec<DVec3> = all.iter().map(|index| made.vertices[*index].normal).collect();
        for (index, own) in all.iter().zip(&normals) {
            let sum: DVec3 = normals.iter().filter(|other| own.dot(**other) >= least).sum();
            made.vertices[*index].normal = sum.try_normalize().unwrap_or(*own);
        }
    }
}

/// Vertices on one point that look the same become one.
fn share_vertices(made: &mut Mesh) {
    /// Cosine of the angle of normals that are equal but for rounding.
    const SAME: f64 = 1.0 - 1e-12;
    let mut first: BTreeMap<PointIndex, Vec<u32>> = BTreeMap::new();
    let mut kept: Vec<Vertex> = Vec::with_capacity(made.vertices.len());
    let map: Vec<u32> = made
        .vertices
        .iter()
        .map(|vertex| {
            let here = first.entry(vertex.point).or_default();
            let alike = |other: &Vertex| other.uv == vertex.uv && other.normal.dot(vertex.normal) >= SAME;
            let same = here.iter().find(|index| alike(&kept[**index as usize]));
            if let Some(index) = same {
                return *index;
            }
            kept.push(*vertex);
            let index = mesh::index(kept.len() - 1);
            here.push(index);
            index
        })
        .collect();
    made.vertices = kept;
    for corner in made.triangles.iter_mut().flatten() {
        *corner = VertexIndex(map[corner.subscript()]);
    }
}

/// Leaves out points that no vertex uses.
fn keep_used(made: &mut Mesh) {
    let mut kept: Vec<Option<u32>> = vec![None; made.points.len()];
    let mut points = Vec::with_capacity(made.points.len());
    for vertex in &mut made.vertices {
        let index = *kept[vertex.point.subscript()].get_or_insert_with(|| {
            points.push(made.points[vertex.point.subscript()]);
            mesh::index(points.len() - 1)
        });
        vertex.point = PointIndex(index);
    }
    made.points = points;
}

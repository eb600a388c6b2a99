//! Parts of surfaces inside closed lines of their parameters.
//!
//! Promise: the lines are cut first, within the tolerance in space, and the inside is filled with triangles that are
//! Delaunay in parameters drawn to the size of the surface; what lies on both ends of a closed surface, or on a pole, is one
//! point, so that nothing cracks there. Triangles are judged as those of whole surfaces are. The bound is `Sampled`: the
//! lines are compared with their chords at places. Not promised: surfaces with edges inside; see [`TrimmedSurface::first_edge`].

mod chart;
mod lines;
mod seam;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::region::{Fault, Filled, NO_LINE, Outline, Place, Wanted, fill};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh::weld::weld_near;
use crate::geometry::mesh::{self, Anchor, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{AnySurface, Surface as _};
use chart::ParameterChart;
use lines::{Cut, Loops};

/// A surface and the lines it ends at.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSurface {
    /// The whole surface.
    pub surface: AnySurface,
    /// Closed curves of its parameters (x is u, y is v) that do not meet. What an odd number of them goes around is left.
    pub outlines: Vec<AnyCurve>,
}

impl TrimmedSurface {
    /// The first edge of the surface, where its tangents jump: whether along u = constant, and the parameter. A surface that
    /// is to be cut by lines must have none.
    #[must_use]
    pub fn first_edge(surface: &AnySurface) -> Option<(bool, f64)> {
        let along_u = surface.joints_u().first().map(|u| (true, *u));
        along_u.or_else(|| surface.joints_v().first().map(|v| (false, *v)))
    }

    /// The least and greatest parameters of the outlines.
    fn range(&self) -> (DVec2, DVec2) {
        let places = self.outlines.iter().flat_map(lines::rough);
        places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    }

    /// The box of points of the surface over the range of its outlines.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let (low, high) = self.range();
        let at = |x: u32, y: u32| low + (high - low) * DVec2::new(f64::from(x), f64::from(y)) / 16.0;
        let places = (0..=16).flat_map(|x| (0..=16).map(move |y| at(x, y)));
        Bounds::of_points(places.map(|place| self.surface.evaluate(place.x, place.y).point))
    }
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
    let (mut cut, tolerance, lattice) = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => (Cut::Within(LINES * tolerance), tolerance, None),
        SurfaceDensity::Grid { u, v } => (Cut::Into(u.max(4)), f64::INFINITY, Some([u, v])),
    };
    let wanted = Wanted { tolerance, limit: detail.triangle_limit, lattice };
    let mut last = None;
    for _ in 0..TRIES {
        let loops = lines::loops(shape, cut, detail.triangle_limit)?;
        let mut work = Work::new(shape, &loops, tolerance);
        let filled = match fill(&work.chart, &work.outline, &mut work.points, wanted)? {
            Ok(filled) => filled,
            Err(Fault::Crossing) => {
                cut = cut.finer();
                continue;
            }
        };
        let bound = loops.deviation.max(filled.bound);
        let made = Tessellation {
            mesh: work.mesh(&filled, detail.uv),
            deviation: Deviation { bound, evidence: Evidence::Sampled },
        };
        if made.mesh.triangles.is_empty() {
            return Err(TessellateError::NoArea);
        }
        if bound <= tolerance {
            return Ok(made);
        }
        last = Some(made);
        cut = cut.finer();
    }
    last.ok_or(TessellateError::Tangled)
}

/// Everything about one attempt.
struct Work<'a> {
    chart: ParameterChart<'a>,
    outline: Outline,
    points: Vec<DVec3>,
}

/// Points of the outlines nearer to each other than this share of the size are one: both ends of a closed surface, or a pole.
const ONE_PLACE: f64 = 1e-9;

impl<'a> Work<'a> {
    fn new(shape: &'a TrimmedSurface, loops: &Loops, tolerance: f64) -> Self {
        let chart = ParameterChart::new(&shape.surface, shape.range(), tolerance);
        let mut outline = Outline::default();
        let mut points = Vec::new();
        for places in &loops.all {
            let first = outline.places.len();
            for (k, place) in places.iter().enumerate() {
                let at = chart.drawn(*place);
                outline.places.push(Place { at, point: mesh::index(points.len()), lines: [NO_LINE; 2] });
                points.push(shape.surface.evaluate(place.x, place.y).point);
                outline.edges.push([first + k, first + (k + 1) % places.len()]);
            }
        }
        Self { chart, outline, points }
    }

    fn mesh(&self, filled: &Filled, uv: bool) -> Mesh {
        let border = self.outline.places.len();
        let size = Bounds::of_points(self.points.iter().copied()).diagonal();
        let welded = weld_near(&self.points[..border], ONE_PLACE * size);
        let mut made = Mesh { points: welded.points, ..Mesh::default() };
        let inner = mesh::index(made.points.len());
        made.points.extend_from_slice(&self.points[border..]);
        let moved = |point: u32| {
            let index = point as usize;
            if index < border { welded.map[index] } else { inner + mesh::index(index - border) }
        };
        let places: BTreeMap<u32, DVec2> = filled.places.iter().copied().collect();
        let mut known: BTreeMap<u32, u32> = BTreeMap::new();
        for corners in &filled.triangles {
            let [a, b, c] = corners.map(moved);
            if a == b || b == c || c == a {
                continue;
            }
            let vertices = corners.map(|corner| {
                let index = *known.entry(corner).or_insert_with(|| {
                    let place = self.chart.parameters(places[&corner]);
                    let mut vertex = self.chart.vertex(place, uv);
                    vertex.point = PointIndex(moved(corner));
                    made.vertices.push(vertex);
                    mesh::index(made.vertices.len() - 1)
                });
                VertexIndex(index)
            });
            made.triangles.push(vertices);
        }
        if !uv {
            share_vertices(&mut made);
        }
        keep_used(&mut made);
        made.runs = vec![Run { origin: 0, end: mesh::index(made.triangles.len()) }];
        made
    }
}

/// Vertices on one point that look the same become one, where no texture needs them apart.
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
            let same = here.iter().find(|index| kept[**index as usize].normal.dot(vertex.normal) >= SAME);
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

impl ParameterChart<'_> {
    fn vertex(&self, place: DVec2, uv: bool) -> Vertex {
        let jet = self.jet(place);
        let (u, v) = self.domains();
        let part = DVec2::new((place.x - u.0) / (u.1 - u.0), (place.y - v.0) / (v.1 - v.0));
        Vertex {
            point: PointIndex(0),
            normal: jet.normal,
            uv: if uv { DVec2::new(part.x, 1.0 - part.y) } else { DVec2::ZERO },
            anchor: Anchor { source: 0, u: place.x, v: place.y },
        }
    }
}

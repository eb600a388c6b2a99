//! The inside of a region, by refined constrained Delaunay triangulation.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::{DVec2, DVec3};
use spade::handles::{FixedFaceHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, PositionInTriangulation, Triangulation};

use crate::geometry::mesh;
use crate::geometry::tessellate::TessellateError;

/// A surface that plane coordinates cover once.
pub(in crate::geometry::tessellate) trait Chart {
    /// The point of the surface at plane coordinates; `None` where there is none near.
    fn lift(&self, place: DVec2) -> Option<DVec3>;

    /// How far a triangle with corners on the surface, at these places, lies from it.
    fn judge(&self, places: [DVec2; 3], corners: [DVec3; 3]) -> Judgment;

    /// How far the surface lies from an edge between two of its points: flat triangles along it are no nearer.
    fn judge_edge(&self, places: [DVec2; 2], ends: [DVec3; 2]) -> f64;
}

/// What is known of a triangle.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry::tessellate) struct Judgment {
    /// A bound on the distance between the triangle and the surface; infinite where none is known.
    pub(in crate::geometry::tessellate) bound: f64,
    /// The shares of the corners in the place that is furthest away.
    pub(in crate::geometry::tessellate) worst: DVec3,
}

/// The border of a region: places in the plane and edges between them. What an odd number of edges divides from the
/// outside is inside.
#[derive(Clone, Debug, Default)]
pub(in crate::geometry::tessellate) struct Outline {
    pub(in crate::geometry::tessellate) places: Vec<Place>,
    pub(in crate::geometry::tessellate) edges: Vec<[usize; 2]>,
}

/// A place of a border.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry::tessellate) struct Place {
    pub(in crate::geometry::tessellate) at: DVec2,
    /// Index of its point in space.
    pub(in crate::geometry::tessellate) point: u32,
    /// Lines of the border that it lies on: a triangle on one line alone would lie beside the surface, however small.
    pub(in crate::geometry::tessellate) lines: [u32; 2],
}

/// No line.
pub(in crate::geometry::tessellate) const NO_LINE: u32 = u32::MAX;

/// What fills a region.
#[derive(Clone, Debug)]
pub(in crate::geometry::tessellate) struct Filled {
    /// Corners as indices of points, counterclockwise in the plane.
    pub(in crate::geometry::tessellate) triangles: Vec<[u32; 3]>,
    /// Where points lie in the plane, by their indices.
    pub(in crate::geometry::tessellate) places: Vec<(u32, DVec2)>,
    /// The greatest bound of all triangles.
    pub(in crate::geometry::tessellate) bound: f64,
}

/// A vertex of the triangulation.
#[derive(Clone, Copy)]
struct Corner {
    place: Point2<f64>,
    point: u32,
    lines: [u32; 2],
}

impl Corner {
    fn at(&self) -> DVec2 {
        DVec2::new(self.place.x, self.place.y)
    }

    fn is_on(&self, line: u32) -> bool {
        line != NO_LINE && self.lines.contains(&line)
    }
}

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

type Delaunay = ConstrainedDelaunayTriangulation<Corner>;
type Face = FixedFaceHandle<InnerTag>;

/// Coordinates below this are 0: `spade` takes none that are much smaller.
const VANISHING: f64 = 1e-40;

/// Whether corners lie on one line of the plane but for rounding.
fn is_sliver(corners: &[Corner; 3]) -> bool {
    const THIN: f64 = 1e-9;
    let [a, b, c] = corners.map(|corner| DVec2::new(corner.place.x, corner.place.y));
    let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
    (b - a).perp_dot(c - a).abs() <= THIN * longest
}

/// A triangle that waits for its turn.
struct Waiting {
    bound: f64,
    face: Face,
    /// To tell whether the face is still this triangle.
    corners: [u32; 3],
    worst: DVec3,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        // Equal bounds, as symmetric surfaces have, in the order of their corners.
        self.bound.total_cmp(&other.bound).then_with(|| other.corners.cmp(&self.corners))
    }
}

/// Why a region cannot be filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::geometry::tessellate) enum Fault {
    /// Two edges cross, or two places are one.
    Crossing,
}

/// How a region is to be filled.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry::tessellate) struct Wanted {
    /// Distance in metres; infinite adds no points.
    pub(in crate::geometry::tessellate) tolerance: f64,
    /// Most triangles.
    pub(in crate::geometry::tessellate) limit: u64,
    /// Points of a lattice over the region that are there from the start, along both coordinates.
    pub(in crate::geometry::tessellate) lattice: Option<[u32; 2]>,
}

/// Fills a region. New points are appended to `points`. Cost: O(n log n) for n triangles.
///
/// # Errors
/// Crossing edges (which finer lines resolve), more triangles than allowed.
pub(in crate::geometry::tessellate) fn fill(
    chart: &dyn Chart,
    outline: &Outline,
    points: &mut Vec<DVec3>,
    wanted: Wanted,
) -> Result<Result<Filled, Fault>, TessellateError> {
    let Some(delaunay) = constrained(outline) else { return Ok(Err(Fault::Crossing)) };
    let mut filling = Filling { chart, delaunay, points, waiting: BinaryHeap::new(), bound: 0.0 };
    if let Some(lattice) = wanted.lattice {
        filling.sow(outline, lattice);
    }
    let inside = filling.inside();
    for face in inside {
        filling.judge(face);
    }
    filling.refine(wanted)?;
    let triangles = filling.triangles();
    let places =
        filling.delaunay.vertices().map(|vertex| (vertex.data().point, vertex.data().at())).collect();
    Ok(Ok(Filled { triangles, places, bound: filling.bound }))
}

fn position(place: DVec2) -> Point2<f64> {
    let clean = |x: f64| if x.abs() <= VANISHING { 0.0 } else { x };
    Point2::new(clean(place.x), clean(place.y))
}

fn constrained(outline: &Outline) -> Option<Delaunay> {
    let mut delaunay = Delaunay::new();
    let mut handles = Vec::with_capacity(outline.places.len());
    for place in &outline.places {
        let count = delaunay.num_vertices();
        let corner = Corner { place: position(place.at), point: place.point, lines: place.lines };
        handles.push(delaunay.insert(corner).ok()?);
        // Two places that are one would leave fewer vertices.
        if delaunay.num_vertices() == count {
            return None;
        }
    }
    for [from, to] in &outline.edges {
        let (from, to) = (handles[*from], handles[*to]);
        if from == to || !delaunay.can_add_constraint(from, to) {
            return None;
        }
        delaunay.add_constraint(from, to);
    }
    // A vertex on an edge cuts it in two; such an edge runs over another line.
    let edges = delaunay.num_constraints();
    (edges == outline.edges.len()).then_some(delaunay)
}

struct Filling<'a> {
    chart: &'a dyn Chart,
    delaunay: Delaunay,
    points: &'a mut Vec<DVec3>,
    waiting: BinaryHeap<Waiting>,
    bound: f64,
}

impl Filling<'_> {
    /// Faces that an odd number of edges divides from the outside.
    fn inside(&self) -> Vec<Face> {
        let mut side: Vec<Option<bool>> = vec![None; self.delaunay.num_all_faces()];
        let outer = self.delaunay.outer_face();
        let mut front = Vec::new();
        side[outer.fix().index()] = Some(false);
        front.extend(self.delaunay.convex_hull());
        let mut found = Vec::new();
        while let Some(edge) = front.pop() {
            // The hull's edges have the outer face to their left; all others the face that was reached.
            let (from, to) = (edge.face(), edge.rev().face());
            let Some(here) = side[from.fix().index()] else { continue };
            let slot = &mut side[to.fix().index()];
            if slot.is_some() {
                continue;
            }
            let there = here != edge.is_constraint_edge();
            *slot = Some(there);
            if let Some(inner) = to.as_inner() {
                if there {
                    found.push(inner.fix());
                }
                front.extend(inner.adjacent_edges());
            }
        }
        found.sort_by_key(|face| face.index());
        found
    }

    fn corners(&self, face: Face) -> [Corner; 3] {
        self.delaunay.face(face).vertices().map(|vertex| *vertex.data())
    }

    fn judge(&mut self, face: Face) {
        let all = self.corners(face);
        let corners = all.map(|corner| corner.point);
        let [a, b, c] = corners;
        // Two places of one point: a pole, whose triangle has no area.
        if a == b || b == c || c == a {
            return;
        }
        let one_line = all[0].lines.iter().any(|line| all[1].is_on(*line) && all[2].is_on(*line));
        let beside = one_line && !is_sliver(&all);
        let places = all.map(|corner| corner.at());
        let judgment = self.chart.judge(places, corners.map(|corner| self.points[corner as usize]));
        let (bound, worst) = if beside && judgment.bound > 0.0 {
            (f64::INFINITY, DVec3::splat(1.0 / 3.0))
        } else {
            (judgment.bound, judgment.worst)
        };
        self.waiting.push(Waiting { bound, face, corners, worst });
    }

    /// Adds the points of a lattice that lie inside, away from the border.
    fn sow(&mut self, outline: &Outline, [across, up]: [u32; 2]) {
        let low = outline.places.iter().fold(DVec2::INFINITY, |low, place| low.min(place.at));
        let high = outline.places.iter().fold(DVec2::NEG_INFINITY, |high, place| high.max(place.at));
        let step = (high - low) / DVec2::new(f64::from(across), f64::from(up));
        let inside: std::collections::BTreeSet<usize> =
            self.inside().into_iter().map(|face| face.index()).collect();
        let places = (1..up).flat_map(|row| (1..across).map(move |column| (column, row)));
        let places = places.map(|(column, row)| low + step * DVec2::new(f64::from(column), f64::from(row)));
        let room = 0.25 * step.min_element();
        let free = |place: &DVec2| {
            let PositionInTriangulation::OnFace(face) = self.delaunay.locate(position(*place)) else {
                return false;
            };
            let near = |corner: Corner| DVec2::new(corner.place.x, corner.place.y).distance(*place) < room;
            inside.contains(&face.index()) && !self.corners(face).into_iter().any(near)
        };
        let free: Vec<DVec2> = places.filter(free).collect();
        for place in free {
            let Some(point) = self.chart.lift(place) else { continue };
            let index = mesh::index(self.points.len());
            let data = Corner { place: position(place), point: index, lines: [NO_LINE; 2] };
            let count = self.delaunay.num_vertices();
            if self.delaunay.insert(data).is_ok() && self.delaunay.num_vertices() > count {
                self.points.push(point);
            }
        }
    }

    /// Adds points until no triangle is further away than wanted.
    fn refine(&mut self, wanted: Wanted) -> Result<(), TessellateError> {
        while let Some(worst) = self.waiting.pop() {
            if self.corners(worst.face).map(|corner| corner.point) != worst.corners {
                continue;
            }
            if worst.bound <= wanted.tolerance || !self.split(&worst) {
                self.bound = self.bound.max(worst.bound);
            }
            let needed = self.delaunay.num_inner_faces() as u64;
            if needed > wanted.limit {
                return Err(TessellateError::TooMany { needed, limit: wanted.limit });
            }
        }
        Ok(())
    }

    /// Adds the point of a triangle that is furthest away. Whether that could be done.
    fn split(&mut self, triangle: &Waiting) -> bool {
        let corners = self.corners(triangle.face);
        let Some(shares) = self.inner_place(triangle, &corners) else { return false };
        let place = corners
            .iter()
            .zip(shares.to_array())
            .map(|(corner, share)| DVec2::new(corner.place.x, corner.place.y) * share)
            .sum();
        let Some(point) = self.chart.lift(place) else { return false };
        let point_index = mesh::index(self.points.len());
        let data = Corner { place: position(place), point: point_index, lines: [NO_LINE; 2] };
        let hint = self.delaunay.face(triangle.face).vertices()[0].fix();
        // There a vertex would be replaced by another of the same place.
        if let PositionInTriangulation::OnVertex(_) = self.delaunay.locate_with_hint(data.place, hint) {
            return false;
        }
        let Ok(handle) = self.delaunay.insert_with_hint(data, hint) else { return false };
        self.points.push(point);
        let around: Vec<Face> = self
            .delaunay
            .vertex(handle)
            .out_edges()
            .filter_map(|edge| edge.face().as_inner().map(|face| face.fix()))
            .collect();
        for face in around {
            self.judge(face);
        }
        true
    }

    /// Where a triangle is split: at its worst place, but never on an edge of the border, where the neighbour could
    /// not follow; `None` where only the border is far away.
    fn inner_place(&self, triangle: &Waiting, corners: &[Corner; 3]) -> Option<DVec3> {
        let edges = self.delaunay.face(triangle.face).adjacent_edges();
        let shares = triangle.worst.to_array();
        // Edge k leads from corner k to the next; the third has no share in its points.
        let on_border = (0..3).find(|k| shares[(k + 2) % 3] < 1e-3 && edges[*k].is_constraint_edge());
        let Some(edge) = on_border else {
            let short = shares.iter().any(|share| *share > 1.0 - 1e-9);
            return Some(if short { DVec3::splat(1.0 / 3.0) } else { triangle.worst });
        };
        // A flat triangle on the same edge is as far away as the edge itself: no point inside would help.
        let ends = [edge, edge + 1].map(|k| &corners[k % 3]);
        let points = ends.map(|corner| self.points[corner.point as usize]);
        let leaf = self.chart.judge_edge(ends.map(Corner::at), points);
        (leaf < 0.95 * triangle.bound).then_some(DVec3::splat(1.0 / 3.0))
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let whole = |corners: &[u32; 3]| {
            corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]
        };
        let inside = self.inside().into_iter();
        inside.map(|face| self.corners(face).map(|corner| corner.point)).filter(whole).collect()
    }
}

//! Polygons with holes by constrained Delaunay triangulation: the checked adapter of the `spade` crate.
//!
//! Corners that stand on one *place* are one vertex there, and an edge of the polygon that runs over places is a
//! chain of *pieces*. What lies inside is told by winding numbers. Then every triangle gets the corners of the polygon
//! back, so that each of its edges is the edge of exactly one triangle:
//!
//! ```text
//!          x2                Around a place, triangles lie in sectors between the piece
//!      x3 / | x1             that leaves corner X and the piece that comes into corner Y.
//!       \ | |/               Where X and Y differ (corners that touch) a triangle without
//!   -----> Y,X ----->        area joins them: (x3, Y, X).
//! ```
//!
//! Other triangles without area stand where a corner lies on an edge: the edge a-b over the place p gets (a, b, p).
//! With them the number of triangles is always corners + 2 holes - 2.
//!
//! Source of the triangulation: L. P. Chew, Constrained Delaunay triangulations, Algorithmica 4 (1989); of the
//! predicates, which are exact: J. Shewchuk, 1997.

use std::collections::HashMap;

use glam::DVec2;
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::corners::{Coincident, Sector};
use super::{Polygon, alone, bend};
use crate::geometry::mesh::index;
use crate::geometry::planar::turn;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Edge<'a> = DirectedEdgeHandle<'a, Point2<f64>, (), spade::CdtEdge<()>, ()>;

/// No entry of a table.
const NONE: u32 = u32::MAX;

/// Coordinates below this part of the greatest are 0: `spade` takes none that are smaller.
const VANISHING: f64 = 1e-40;

/// Triangles of a polygon whose edges do not cross; `None` where they do, or where it winds other than once around
/// what it encloses.
pub(super) fn triangulate(polygon: &Polygon) -> Option<Vec<[u32; 3]>> {
    let places = Places::new(polygon);
    let ways = polygon.edges().map(|[_, to]| vec![places.of[to as usize]]).collect();
    over(polygon, &places, ways)
}

/// The same for a polygon whose edges cross by a little: they are led over corners that are in their way. The
/// triangles are those of the bent edges, so they are turned over by no more than edges were bent.
pub(super) fn triangulate_bent(polygon: &Polygon) -> Option<Vec<[u32; 3]>> {
    let places = Places::new(polygon);
    let ways = bend::ways(polygon, &places.of, &places.points)?;
    over(polygon, &places, ways)
}

/// With `ways` for each edge of the polygon the places that it runs over, its end last.
fn over(polygon: &Polygon, places: &Places, ways: Vec<Vec<u32>>) -> Option<Vec<[u32; 3]>> {
    let delaunay = places.delaunay(polygon, &ways)?;
    let pieces = Pieces::new(polygon, places, (&delaunay, &ways))?;
    let inside = inside(&delaunay, &pieces)?;
    let naming =
        Naming { polygon, places: &places.of, delaunay: &delaunay, pieces: &pieces, inside: &inside };
    let triangles = naming.triangles()?;
    let holes = polygon.ring_ends.len() - 1;
    (triangles.len() + 2 == polygon.corners.len() + 2 * holes).then_some(triangles)
}

/// Which place each corner stands on.
struct Places {
    of: Vec<u32>,
    points: Vec<DVec2>,
}

impl Places {
    fn new(polygon: &Polygon) -> Self {
        let reach =
            polygon.corners.iter().fold(0.0, |reach, corner| f64::max(reach, corner.abs().max_element()));
        let clean = |value: f64| if value.abs() <= VANISHING * reach { 0.0 } else { value };
        let mut first: HashMap<[u64; 2], u32> = HashMap::with_capacity(polygon.corners.len());
        let mut places = Self { of: Vec::with_capacity(polygon.corners.len()), points: Vec::new() };
        for corner in &polygon.corners {
            let (x, y) = (clean(corner.x), clean(corner.y));
            let place = *first.entry([x.to_bits(), y.to_bits()]).or_insert_with(|| {
                places.points.push(DVec2::new(x, y));
                index(places.points.len() - 1)
            });
            places.of.push(place);
        }
        places
    }

    /// The triangulation of all places with the polygon's edges; `None` when edges cross.
    fn delaunay(&self, polygon: &Polygon, ways: &[Vec<u32>]) -> Option<Delaunay> {
        let mut edges: Vec<[usize; 2]> = Vec::with_capacity(polygon.corners.len());
        for ([from, _], way) in polygon.edges().zip(ways) {
            let mut here = self.of[from as usize] as usize;
            for &next in way {
                let next = next as usize;
                if here != next {
                    edges.push([here.min(next), here.max(next)]);
                }
                here = next;
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let mut crossed = false;
        let points = self.points.iter().map(|point| Point2::new(point.x, point.y)).collect();
        let made = Delaunay::try_bulk_load_cdt(points, edges, |_| crossed = true).ok()?;
        (!crossed && made.num_vertices() == self.points.len() && made.num_inner_faces() > 0).then_some(made)
    }
}

/// A part of an edge of the polygon between two neighbouring places.
#[derive(Clone, Copy)]
struct Piece {
    /// The corner at its start; one that exists only here, beyond the polygon's, where the edge runs over a place.
    start: u32,
    /// The corner at its end.
    end: u32,
}

/// The edges of the polygon as directed edges of the triangulation.
struct Pieces {
    all: Vec<Piece>,
    /// For each directed edge of the triangulation its piece.
    of_edge: Vec<u32>,
    /// For each edge of the polygon that runs over places: its corners, and those on the way.
    chains: Vec<([u32; 2], Vec<u32>)>,
    /// How many corners exist only on the way.
    passing: usize,
}

impl Pieces {
    /// `None` when two edges run over one stretch the same way.
    fn new(polygon: &Polygon, places: &Places, (delaunay, ways): (&Delaunay, &[Vec<u32>])) -> Option<Self> {
        let mut between: HashMap<[u32; 2], usize> = HashMap::new();
        for edge in delaunay.directed_edges().filter(|edge| edge.as_undirected().is_constraint_edge()) {
            between.insert([index(edge.from().index()), index(edge.to().index())], edge.fix().index());
        }
        let mut pieces = Self {
            all: Vec::with_capacity(polygon.corners.len()),
            of_edge: vec![NONE; delaunay.num_directed_edges()],
            chains: Vec::new(),
            passing: 0,
        };
        for ([from, to], way) in polygon.edges().zip(ways) {
            let mut here = places.of[from as usize];
            if way.as_slice() == [here] {
                continue;
            }
            let mut corners = vec![from];
            for (k, &goal) in way.iter().enumerate() {
                while here != goal {
                    let direct = between.contains_key(&[here, goal]);
                    let next = if direct { goal } else { next_place(delaunay, here, goal)? };
                    let last = direct && k + 1 == way.len();
                    let corner = if last { to } else { pieces.corner(polygon) };
                    pieces.push(between[&[here, next]], Piece { start: *corners.last()?, end: corner })?;
                    corners.push(corner);
                    here = next;
                }
            }
            // First and last are the polygon's own.
            corners.pop();
            if corners.len() > 1 {
                pieces.chains.push(([from, to], corners.split_off(1)));
            }
        }
        Some(pieces)
    }

    /// A new corner that exists only on the way.
    fn corner(&mut self, polygon: &Polygon) -> u32 {
        self.passing += 1;
        index(polygon.corners.len() + self.passing - 1)
    }

    fn push(&mut self, edge: usize, piece: Piece) -> Option<()> {
        let slot = &mut self.of_edge[edge];
        if *slot != NONE {
            return None;
        }
        *slot = index(self.all.len());
        self.all.push(piece);
        Some(())
    }

    fn of(&self, edge: Edge<'_>) -> Option<Piece> {
        self.all.get(self.of_edge[edge.fix().index()] as usize).copied()
    }
}

/// The nearest place on the way from one place to another along constraint edges.
fn next_place(delaunay: &Delaunay, here: u32, end: u32) -> Option<u32> {
    let point = |vertex: Point2<f64>| DVec2::new(vertex.x, vertex.y);
    let handle = |place: u32| delaunay.vertex(FixedVertexHandle::from_index(place as usize));
    let (from, to) = (point(handle(here).position()), point(handle(end).position()));
    let onward = |edge: &Edge<'_>| {
        let next = point(edge.to().position());
        edge.as_undirected().is_constraint_edge()
            && turn(from, to, next) == 0.0
            && (next - from).dot(to - from) > 0.0
    };
    handle(here).out_edges().find(onward).map(|edge| index(edge.to().index()))
}

/// Which faces of the triangulation lie inside; `None` where the polygon winds around a face other than once.
fn inside(delaunay: &Delaunay, pieces: &Pieces) -> Option<Vec<bool>> {
    let mut winding: Vec<Option<i32>> = vec![None; delaunay.num_all_faces()];
    let outer = delaunay.outer_face();
    winding[outer.index()] = Some(0);
    let mut open: Vec<Edge<'_>> = delaunay.directed_edges().filter(|edge| edge.face().is_outer()).collect();
    while let Some(edge) = open.pop() {
        let (here, there) = (edge.face().index(), edge.rev().face().index());
        if winding[there].is_some() {
            continue;
        }
        let count = |edge: Edge<'_>| i32::from(pieces.of(edge).is_some());
        let found = winding[here]? - count(edge) + count(edge.rev());
        if found != 0 && found != 1 {
            return None;
        }
        winding[there] = Some(found);
        open.extend([edge.rev().next(), edge.rev().prev()]);
    }
    Some(winding.into_iter().map(|winding| winding == Some(1)).collect())
}

/// Gives the triangles inside the corners of the polygon.
struct Naming<'a> {
    polygon: &'a Polygon,
    places: &'a [u32],
    delaunay: &'a Delaunay,
    pieces: &'a Pieces,
    inside: &'a [bool],
}

impl Naming<'_> {
    fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        // For each directed edge with a triangle inside to its left: the corner at its start.
        let mut names = vec![NONE; self.delaunay.num_directed_edges()];
        let mut coincident = Coincident::new(self.polygon, self.places, self.pieces.passing);
        let mut flat: Vec<[u32; 3]> = Vec::new();
        for edge in self.delaunay.directed_edges() {
            let Some(piece) = self.pieces.of(edge) else { continue };
            if self.inside[edge.face().index()] {
                let incoming = self.name_sector(edge, piece.start, &mut names)?;
                coincident.sector(Sector { out: piece.start, back: incoming.end, from: incoming.start });
                continue;
            }
            // Two edges back to back with nothing on either side: a spike.
            let back = self.pieces.of(edge.rev())?;
            coincident.link(piece.start, back.end);
            if edge.fix().index() < edge.rev().fix().index() {
                flat.push([piece.start, piece.end, back.start]);
                flat.push([piece.start, back.start, back.end]);
            }
        }
        let rename = coincident.close(&mut flat)?;
        for ([from, to], way) in &self.pieces.chains {
            let way: Vec<u32> = way.iter().copied().filter(|corner| !rename.alone.contains(corner)).collect();
            for (k, &corner) in way.iter().enumerate() {
                flat.push([*from, way.get(k + 1).copied().unwrap_or(*to), corner]);
            }
        }
        let faces = self.delaunay.inner_faces().filter(|face| self.inside[face.index()]);
        let named = faces.map(|face| face.adjacent_edges().map(|edge| names[edge.fix().index()]));
        let all = named.chain(flat).map(|triangle| triangle.map(|corner| rename.of[corner as usize]));
        // A triangle between corners that turned out to be one is none.
        let all: Vec<[u32; 3]> = all.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        alone::without(self.polygon, all, &rename.alone)
    }

    /// Names one corner in all triangles from the piece that leaves it, counter-clockwise, to the next piece that
    /// comes in; gives that piece.
    fn name_sector(&self, out: Edge<'_>, corner: u32, names: &mut [u32]) -> Option<Piece> {
        let mut edge = out;
        loop {
            if !self.inside[edge.face().index()] {
                return None;
            }
            names[edge.fix().index()] = corner;
            edge = edge.ccw();
            if let Some(incoming) = self.pieces.of(edge.rev()) {
                return Some(incoming);
            }
            if edge == out {
                return None;
            }
        }
    }
}

//! Surfaces by their parameters: which place of one is which of another.

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::super::source::{Source, Sources};
use super::carry::{Carried, side_of};
use crate::geometry::curve::Side;
use crate::geometry::mesh::{Anchor, Mesh, VertexIndex};
use crate::geometry::surface::SurfaceJet;

/// From the surfaces of one model to those of another, by the sources of anchors.
pub(super) struct Charts<'s>(Vec<Option<Chart<'s>>>);

/// From one surface to another.
pub(super) struct Chart<'s> {
    surfaces: [&'s Source; 2],
    /// For u and v the ends of the domain and where pieces meet between them, on both surfaces.
    stops: [[Vec<f64>; 2]; 2],
    /// Whether u and v come round.
    closed: [bool; 2],
}

/// A place in a triangle by the weights of its corners: as the deviation of written meshes is sampled, without corners.
const SAMPLES: [[f64; 3]; 10] = [
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.75, 0.25, 0.0],
    [0.25, 0.75, 0.0],
    [0.0, 0.75, 0.25],
    [0.0, 0.25, 0.75],
    [0.25, 0.0, 0.75],
    [0.75, 0.0, 0.25],
];

impl<'s> Charts<'s> {
    /// None where there are more surfaces in one model than in the other, or of other kinds or pieces.
    pub(super) fn between(from: &'s Sources, to: &'s Sources) -> Option<Self> {
        if from.len() != to.len() {
            return None;
        }
        let pairs = (0..from.len()).map(|source| Some((from.get(source)?, to.get(source)?)));
        let chart = |pair: Option<(&'s Source, &'s Source)>| {
            let (one, other) = pair?;
            match (one.stops(), other.stops()) {
                (None, None) if one.is_like(other) => Some(None),
                (Some(a), Some(b)) if one.is_like(other) => {
                    let same = a.iter().zip(&b).all(|(a, b)| a.len() == b.len());
                    let closed = one.closed();
                    same.then_some(Some(Chart { surfaces: [one, other], stops: [a, b], closed }))
                }
                _ => None,
            }
        };
        pairs.map(chart).collect::<Option<Vec<_>>>().map(Self)
    }

    /// How many surfaces there are.
    pub(super) fn len(&self) -> u32 {
        crate::geometry::mesh::index(self.0.len())
    }

    /// The chart of a source; none where its faces are flat or without parameters.
    pub(super) fn get(&self, source: u32) -> Option<&Chart<'s>> {
        self.0.get(source as usize)?.as_ref()
    }
}

type Sides = [Side; 2];

impl Chart<'_> {
    /// The sides of a corner's parameters on which its triangle lies.
    pub(super) fn sides(&self, mesh: &Mesh, triangle: &[VertexIndex; 3], own: Anchor) -> Sides {
        let others = triangle.iter().map(|vertex| mesh.vertices[vertex.subscript()].anchor);
        let others: Vec<Anchor> = others.filter(|anchor| anchor.source == own.source).collect();
        let count = others.len().max(1) as f64;
        let side = |axis: usize, own: f64, of: fn(&Anchor) -> f64| {
            let near = others.iter().map(|anchor| self.near((0, axis), own, of(anchor)));
            side_of(own, near.sum::<f64>() / count)
        };
        [side(0, own.u, |anchor| anchor.u), side(1, own.v, |anchor| anchor.v)]
    }

    /// A parameter of one of the surfaces counted on or back by a turn, so that it is near another.
    fn near(&self, (surface, axis): (usize, usize), own: f64, other: f64) -> f64 {
        let stops = &self.stops[surface][axis];
        let span = stops[stops.len() - 1] - stops[0];
        if !self.closed[axis] || (other - own).abs() <= span / 2.0 {
            other
        } else if other > own {
            other - span
        } else {
            other + span
        }
    }

    /// The place of an anchor on the surface that it is of.
    pub(super) fn from(&self, anchor: Anchor, sides: Sides) -> SurfaceJet {
        self.surfaces[0].jet((anchor.u, sides[0]), (anchor.v, sides[1]))
    }

    /// The anchor on the other surface, and the place there.
    pub(super) fn to(&self, anchor: Anchor, sides: Sides) -> (Anchor, SurfaceJet) {
        let (u, v) = (self.moved(0, anchor.u), self.moved(1, anchor.v));
        (Anchor { u, v, ..anchor }, self.surfaces[1].jet((u, sides[0]), (v, sides[1])))
    }

    /// A parameter of the first surface as one of the second: the same share of the same piece.
    fn moved(&self, axis: usize, value: f64) -> f64 {
        let [from, to] = [&self.stops[0][axis], &self.stops[1][axis]];
        let next = from.partition_point(|stop| *stop <= value).clamp(1, from.len() - 1);
        let share = (value - from[next - 1]) / (from[next] - from[next - 1]);
        if share == 1.0 { to[next] } else { to[next - 1] + (to[next] - to[next - 1]) * share }
    }
}

/// The greatest distance found from a carried mesh to the surfaces that it was put on, `cast` to those without parameters too.
pub(super) fn deviation(
    mesh: &Mesh,
    carried: &Carried,
    charts: &Charts<'_>,
    (to, cast): (&Sources, bool),
) -> f64 {
    let of = |triangle: &[VertexIndex; 3]| of_triangle((mesh, carried), triangle, charts, (to, cast));
    mesh.triangles.par_iter().with_min_len(256).map(of).reduce(|| 0.0, f64::max)
}

fn of_triangle(
    (mesh, carried): (&Mesh, &Carried),
    triangle: &[VertexIndex; 3],
    charts: &Charts<'_>,
    (to, cast): (&Sources, bool),
) -> f64 {
    let places = triangle.map(|vertex| carried.points[mesh.vertices[vertex.subscript()].point.subscript()]);
    let anchors = triangle.map(|vertex| carried.anchors[vertex.subscript()]);
    let at = |weights: &[f64; 3]| (0..3).map(|k| places[k] * weights[k]).sum::<DVec3>();
    let source = anchors[0].source;
    let chart = charts.get(source);
    if anchors.iter().any(|anchor| anchor.source != source) || (cast && chart.is_none()) {
        // Between surfaces: the nearest of those around.
        let around = to.around(&anchors, &places);
        let nearest = |point: DVec3| {
            let away = around.iter().map(|(source, window)| source.distance(point, window));
            away.fold(f64::INFINITY, f64::min)
        };
        let found = SAMPLES.iter().map(|weights| nearest(at(weights)));
        return found.filter(|away| away.is_finite()).fold(0.0, f64::max);
    }
    let Some(chart) = chart else { return 0.0 };
    let corners = chart.corners(anchors);
    let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
    let distance = |weights: &[f64; 3]| {
        let [u, v] = [0, 1].map(|axis| (0..3).map(|k| corners[k][axis] * weights[k]).sum::<f64>());
        chart.distance(at(weights), [u, v], middle)
    };
    SAMPLES.iter().map(distance).fold(0.0, f64::max)
}

impl Chart<'_> {
    /// Parameters of three corners on the second surface without a seam between them; a corner that is a pole has the u
    /// of the others.
    fn corners(&self, anchors: [Anchor; 3]) -> [[f64; 2]; 3] {
        let first = anchors[0];
        let mut corners = anchors
            .map(|anchor| [self.near((1, 0), first.u, anchor.u), self.near((1, 1), first.v, anchor.v)]);
        for axis in 0..2 {
            let still = |k: usize| {
                let [u, v] = corners[k];
                let jet = self.there([u, v], [u, v]);
                let own = [jet.du, jet.dv][axis].length();
                let span = self.stops[1][axis][self.stops[1][axis].len() - 1] - self.stops[1][axis][0];
                let other = [jet.dv, jet.du][axis].length();
                own * span <= 1e-9 * other
            };
            let poles = [0, 1, 2].map(still);
            let lively: Vec<f64> = (0..3).filter(|k| !poles[*k]).map(|k| corners[k][axis]).collect();
            if lively.is_empty() || lively.len() == 3 {
                continue;
            }
            let base = lively[0];
            let near: Vec<f64> = lively.iter().map(|value| self.near((1, axis), base, *value)).collect();
            let mean = near.iter().sum::<f64>() / near.len() as f64;
            for k in 0..3 {
                corners[k][axis] = if poles[k] { mean } else { self.near((1, axis), base, corners[k][axis]) };
            }
        }
        corners
    }

    /// The second surface at parameters that may have gone round, from the side where a triangle's middle lies.
    fn there(&self, at: [f64; 2], middle: [f64; 2]) -> SurfaceJet {
        let inside = |axis: usize| {
            let stops = &self.stops[1][axis];
            let (start, end) = (stops[0], stops[stops.len() - 1]);
            let turn = if self.closed[axis] { end - start } else { 0.0 };
            let value = at[axis];
            let value = value + if value < start { turn } else { 0.0 } - if value > end { turn } else { 0.0 };
            (value.clamp(start, end), side_of(at[axis], middle[axis]))
        };
        self.surfaces[1].jet(inside(0), inside(1))
    }

    /// The distance from a point to the second surface near parameters: to the place there, or to that after one step of
    /// Gauss and Newton's method, never less than to the whole surface.
    fn distance(&self, point: DVec3, at: [f64; 2], middle: [f64; 2]) -> f64 {
        let jet = self.there(at, middle);
        let away = point - jet.point;
        let (a, b, c) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let (x, y) = (away.dot(jet.du), away.dot(jet.dv));
        let determinant = a * c - b * b;
        let found = away.length();
        if determinant <= 1e-18 * a * c {
            return found;
        }
        let next = [at[0] + (x * c - y * b) / determinant, at[1] + (y * a - x * b) / determinant];
        found.min(point.distance(self.there(next, middle).point))
    }
}

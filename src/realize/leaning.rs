//! Distances from the walls of beveled and drafted extrusions.

use glam::{DVec2, DVec3};

use super::window::{Window, ranges};
use crate::geometry::curve::{AnyCurve, Curve as _, Side, nearest_within};
use crate::geometry::tessellate::{Density, EdgeProfile, Extrusion, discretize};

/// A wall that stands inside of an outline as a profile says.
#[derive(Clone, Debug)]
pub(super) struct Leaning {
    outline: AnyCurve,
    /// Parameters between which the outline is smooth.
    breaks: Vec<f64>,
    edge: EdgeProfile,
    /// 1 where the solid lies to the left of the outline, -1 where to the right.
    inside: f64,
}

impl Leaning {
    /// The wall of one of its outlines; none where walls are straight.
    pub(super) fn of(extrusion: &Extrusion, index: usize) -> Option<Self> {
        let edge = extrusion.edge.clone()?;
        let outline = extrusion.outlines[index].clone();
        let stations = discretize(&outline, Density::Count(256), u64::MAX).ok()?;
        let places = stations.iter().map(|station| station.point.truncate()).collect::<Vec<_>>();
        let turn = crate::geometry::planar::twice_area(&places).signum();
        let mut next = 0;
        let first = extrusion.islands.iter().any(|count| {
            next += count;
            next - count == index
        });
        let breaks = outline.breaks();
        Some(Self { outline, breaks, edge, inside: if first { turn } else { -turn } })
    }

    /// Distance of a point: what its distance from the outline and its height are from the profile.
    pub(super) fn distance(&self, point: DVec3, window: &Window) -> f64 {
        let flat = point.with_z(0.0);
        let (away, t) = self.nearest(flat, window);
        let spoke = flat - self.outline.point(t);
        // In a corner a place is inside if it is so of both sides or of either, as the corner turns.
        let along = self.directions(t);
        let sides = along.map(|along| self.inside * along.perp_dot(spoke.truncate()));
        let inside = if sides[0] * sides[1] < 0.0 {
            // Beside one side and behind the other: inside where the outline turns the other way.
            self.inside * along[0].perp_dot(along[1]) < 0.0
        } else {
            sides[0] + sides[1] > 0.0
        };
        self.edge.distance(DVec2::new(if inside { away } else { -away }, point.z))
    }

    /// Distance and parameter of the nearest point of the outline around the corners of a triangle. What has vanished on
    /// the way up may lie between these.
    fn nearest(&self, flat: DVec3, window: &Window) -> (f64, f64) {
        let mut best = (f64::INFINITY, window.u[0]);
        let domain = self.outline.domain();
        let wide = |one: f64, other: f64| (one - other).abs() > domain.span() / 2.0;
        let [a, b, c] = window.u;
        let mut around = ranges(&self.outline, window.u);
        if wide(a, b) || wide(b, c) || wide(c, a) {
            // Across the seam, or over much that has vanished.
            around.push((domain.start, domain.end));
        }
        for (from, to) in around {
            let inner = self.breaks.iter().copied().filter(|stop| *stop > from && *stop < to);
            let stops: Vec<f64> = std::iter::once(from).chain(inner).chain([to]).collect();
            for pair in stops.windows(2) {
                let next = nearest_within(&self.outline, flat, pair[0], pair[1]);
                if next.0 < best.0 {
                    best = next;
                }
            }
        }
        best
    }

    /// Directions of the outline before and after a place; its ends are one place.
    fn directions(&self, t: f64) -> [DVec2; 2] {
        let domain = self.outline.domain();
        let (before, after) = match t {
            t if t <= domain.start || t >= domain.end => (domain.end, domain.start),
            t => (t, t),
        };
        [self.outline.direction(before, Side::Before), self.outline.direction(after, Side::After)]
            .map(|along| along.truncate())
    }
}

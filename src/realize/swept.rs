//! Distance to surfaces of moving sections.

use glam::DVec3;

use super::window::{Window, nearest_near, unwrapped};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::hypot;
use crate::geometry::surface::{Carrier, Plane, Surface as _, SweptWall};

/// The section that holds the point is found by Newton's method on its place along the way; the rest is a
/// distance in the plane of that section. Behind a mitre the surface goes on straight until it meets the other
/// side, so at a corner what is left along the way does not count.
pub(super) fn distance(wall: &SweptWall, point: DVec3, window: &Window) -> f64 {
    let carrier = &wall.surface.carrier;
    let domain = carrier.domain();
    let corners = match carrier {
        Carrier::Path { path, .. } => crate::geometry::curve::Curve::joints(path),
        Carrier::Screw(_) => Vec::new(),
    };
    let seam = carrier.is_closed();
    let (low, high) = unwrapped(domain, seam, window.v);
    let corner_below = corners.iter().copied().filter(|t| *t <= low).fold(f64::NEG_INFINITY, f64::max);
    let corner_above = corners.iter().copied().filter(|t| *t >= high).fold(f64::INFINITY, f64::min);
    let margin = high - low;
    let stretch = Stretch {
        low: (low - margin).max(corner_below).max(domain.start),
        high: (high + margin).min(corner_above).min(domain.end),
        open_below: corner_below >= low - margin || (seam && low - margin <= domain.start),
        open_above: corner_above <= high + margin || (seam && high + margin >= domain.end),
    };
    within(wall, point, &stretch, window)
}

/// A smooth stretch of a way; at an open end it stops at a corner or a seam.
struct Stretch {
    low: f64,
    high: f64,
    open_below: bool,
    open_above: bool,
}

impl Stretch {
    fn side(&self, v: f64) -> Side {
        if v >= self.high { Side::Before } else { Side::After }
    }
}

fn within(wall: &SweptWall, point: DVec3, stretch: &Stretch, window: &Window) -> f64 {
    let surface = &wall.surface;
    let mut v = (stretch.low + stretch.high) / 2.0;
    for _ in 0..12 {
        let Some(step) = step(&surface.carrier.plane(v, stretch.side(v)), point) else {
            break;
        };
        v = (v + step).clamp(stretch.low, stretch.high);
    }
    let stand = surface.stand(v, stretch.side(v));
    let frame = &stand.plane.frame;
    let away = point - stand.plane.origin;
    let flat = DVec3::new(away.dot(frame.side), away.dot(frame.up), 0.0);
    let section = surface.outlines[wall.outline].under(&stand.mix);
    let (across, u) = nearest_near(&section, flat, window.u);
    let along = away.dot(frame.along);
    let beyond = (stretch.open_above && v == stretch.high && along > 0.0)
        || (stretch.open_below && v == stretch.low && along < 0.0);
    let found = if beyond { across } else { hypot(across, along) };
    if stand.plane.slope.is_some() {
        let middle = |corners: [f64; 3]| corners.iter().sum::<f64>() / 3.0;
        let center = (middle(window.u), middle(window.v).clamp(stretch.low, stretch.high));
        let starts = [(u, v), center];
        let found = starts.map(|start| leaning_distance(wall, point, stretch, start));
        return found[0].min(found[1]);
    }
    let leans = stand.plane.leans || !surface.change.is_constant();
    if leans { found.min(leaning_distance(wall, point, stretch, (u, v))) } else { found }
}

/// The step that brings the plane to a point, as far as it can be told.
fn step(plane: &Plane, point: DVec3) -> Option<f64> {
    let away = point - plane.origin;
    let along = plane.frame.along;
    let slope = away.dot(plane.spin.cross(along)) - plane.velocity.dot(along);
    // Beyond the center of a bend, or behind the axis of a screw, the plane moves the other way.
    (slope < 0.0).then(|| -away.dot(along) / slope)
}

/// A surface that leans against the planes of its sections: the nearest point is looked for along both
/// parameters, by Gauss and Newton's method from a point near by, with steps that are halved until they help.
fn leaning_distance(wall: &SweptWall, point: DVec3, stretch: &Stretch, (mut u, mut v): (f64, f64)) -> f64 {
    let Domain { start, end } = wall.domain_u();
    let closed = wall.surface.outlines[wall.outline].is_closed();
    // A closed section goes on beyond its seam.
    let turn = if closed { end - start } else { 0.0 };
    let inside = |u: f64| {
        (u + if u < start { turn } else { 0.0 } - if u > end { turn } else { 0.0 }).clamp(start, end)
    };
    let mut jet = wall.evaluate(u, v);
    let mut nearest = point.distance(jet.point);
    for _ in 0..12 {
        let away = point - jet.point;
        let (uu, uv, vv) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let (by_u, by_v) = (away.dot(jet.du), away.dot(jet.dv));
        let determinant = uu * vv - uv * uv;
        if determinant <= 0.0 {
            break;
        }
        let step = ((by_u * vv - by_v * uv) / determinant, (by_v * uu - by_u * uv) / determinant);
        let next = [1.0, 0.5, 0.25, 0.125].into_iter().find_map(|part| {
            let at = (inside(u + part * step.0), (v + part * step.1).clamp(stretch.low, stretch.high));
            let jet = wall.evaluate(at.0, at.1);
            let reached = point.distance(jet.point);
            (reached < nearest).then_some((at, jet, reached))
        });
        let Some((at, reached_jet, reached)) = next else { break };
        ((u, v), jet) = (at, reached_jet);
        let gain = nearest - reached;
        nearest = reached;
        if gain < 1e-9 * nearest {
            break;
        }
    }
    nearest
}

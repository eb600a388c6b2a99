//! Surfaces of revolution about the y axis.
//!
//! The profile is cut into chords, each chord sweeps a cone, and each cone becomes a band of triangles
//! between two rings. Rings have their own numbers of steps: a neck needs fewer than a belly.
//!
//! # The proved bound
//! Distance from the cones to the surface is that of the profile's chords to the profile, e1. On a cone,
//! a triangle's point at weights `w_k` over corners of radius `r_k` and angle `t_k` lies inside the circle of its
//! height by at most half the sum of `w_k` `r_k` (`t_k` - t)^2 for any t, since cos x >= 1 - x^2/2. Minimized over
//! t the worst pair of corners decides: `r_i` `r_j` (`t_i` - `t_j)^2` / (2 (sqrt `r_i` + sqrt `r_j)^2`). Times the
//! cosine of the cone's slope this is the distance e2, and e1 + e2 bounds the whole. With steps
//! sqrt(8 e2 / (r cos)) on each ring, edges across a band that span at most the mean of the two steps obey
//! the same bound, which is what the stitching keeps.
//!
//! With e1 = e2 the number of triangles tends to the integral of sqrt |K| dA / (2 tolerance), the optimum
//! of right-angled grids on doubly curved surfaces.

use glam::{DVec2, DVec3};

use super::cap::{CapLoop, Facing, add_cap};
use super::discretize::{Density, Station, arc_lengths, discretize};
use super::ring::{Row, RowKind, count, stitch};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::{AnyCurve, Curve};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex};
use crate::geometry::number::{cos_degrees, floor_count, floor_large, sin_cos_degrees, size};

/// A profile turned about the y axis: x of the profile is the radius. Angles in degrees, from +x toward -z.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// The profile, x >= 0.
    pub profile: AnyCurve,
    /// First angle.
    pub start: f64,
    /// Turn, more than 0 and at most 360.
    pub angle: f64,
    /// Whether a partial turn gets flat faces at its two ends, where the profile encloses an area (is closed,
    /// or runs from axis to axis).
    pub caps: bool,
}

/// Anchor source of the turned surface.
const WALL: u32 = 0;
/// Anchor source of the flat face at the first angle; the one at the last angle is the next.
const CAP: u32 = 1;

/// Degrees below which a joint is no edge; smooth constructions leave about 1e-12.
const STRAIGHT: f64 = 1e-6;

/// Radii below this share of the greatest are on the axis.
const ON_AXIS: f64 = 1e-12;

/// Turns a profile into triangles.
///
/// # Errors
/// When the limit would be passed (before memory is taken), the profile encloses no area, or a cap fails.
pub fn revolve(shape: &Revolution, detail: &Detail) -> Result<Tessellation, TessellateError> {
    refuse_early(shape, detail)?;
    let plan = Plan::new(shape, detail)?;
    let needed = plan.triangles();
    if needed > detail.triangle_limit {
        return Err(TessellateError::TooMany { needed, limit: detail.triangle_limit });
    }
    let mut builder = Builder::new(&plan, shape, detail);
    builder.rows();
    builder.caps()?;
    let mut mesh = builder.mesh;
    mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
    Ok(Tessellation { mesh, deviation: plan.deviation() })
}

/// Refuses a tolerance far below what the limit allows without cutting the profile so finely: the number of
/// triangles is inverse to the tolerance, so a coarser plan tells it.
fn refuse_early(shape: &Revolution, detail: &Detail) -> Result<(), TessellateError> {
    /// Chords of a plan that costs nothing to speak of.
    const FEW: u64 = 1024;
    let tolerance = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => tolerance,
        SurfaceDensity::Grid { u, v } => return detail.allow(u64::from(u) * u64::from(v)),
    };
    let mut coarser = 1.0;
    while coarser < 1e30 {
        let density = SurfaceDensity::Tolerance(tolerance * coarser);
        match Plan::new(shape, &Detail { density, triangle_limit: FEW, uv: false, ..*detail }) {
            Ok(plan) => {
                // Rings have at least four steps however coarse they are: a quarter is safe.
                let needed = floor_large(plan.triangles() as f64 * coarser / 4.0);
                let limit = detail.triangle_limit;
                let passed = coarser > 1.0 && needed > limit;
                return if passed { Err(TessellateError::TooMany { needed, limit }) } else { Ok(()) };
            }
            Err(TessellateError::TooMany { .. }) => coarser *= 64.0,
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Profile and rings, before any vertex is made.
struct Plan {
    stations: Vec<Station>,
    /// Distance along the profile, 0 to 1, from the lower end.
    along: Vec<f64>,
    steps: Vec<u32>,
    /// Whether the profile runs against the sense that gives outward normals.
    backward: bool,
    closed: bool,
    turn: f64,
}

impl Plan {
    fn new(shape: &Revolution, detail: &Detail) -> Result<Self, TessellateError> {
        let curve = &shape.profile;
        let turn = shape.angle;
        let (density, fixed) = match detail.density {
            SurfaceDensity::Tolerance(tolerance) => (Density::Tolerance(tolerance / 2.0), None),
            SurfaceDensity::Grid { u, v } => (Density::Count(v), Some(u)),
        };
        let mut stations = discretize(curve, density, detail.triangle_limit)?;
        snap_to_axis(&mut stations);
        if stations.iter().all(|station| station.point.x == 0.0) {
            return Err(TessellateError::NoArea);
        }
        let along =
            if detail.uv { fractions(&arc_lengths(curve, &stations)) } else { vec![0.0; stations.len()] };
        let closed = curve.is_closed();
        let mut plan =
            Self { backward: runs_backward(&stations), stations, along, steps: Vec::new(), closed, turn };
        plan.steps = (0..plan.stations.len())
            .map(|index| match (plan.on_axis(index), detail.density, fixed) {
                (true, _, _) => 0,
                (_, _, Some(count)) => count.max(if turn == 360.0 { 3 } else { 1 }),
                (_, SurfaceDensity::Tolerance(tolerance), _) => plan.steps_needed(index, tolerance),
                _ => 1,
            })
            .collect();
        if closed {
            let last = plan.steps.len() - 1;
            plan.steps[0] = plan.steps[0].max(plan.steps[last]);
            plan.steps[last] = plan.steps[0];
        }
        Ok(plan)
    }

    fn triangles(&self) -> u64 {
        self.steps.windows(2).map(|pair| count(pair[0], pair[1])).sum()
    }

    fn radius(&self, index: usize) -> f64 {
        self.stations[index].point.x
    }

    fn on_axis(&self, index: usize) -> bool {
        self.radius(index) == 0.0
    }

    /// Cosine of the slope of the cone from station `index` to the next: how much of a radial distance
    /// counts across it.
    fn across(&self, index: usize) -> f64 {
        let chord = self.stations[index + 1].point - self.stations[index].point;
        let length = chord.length();
        if length > 0.0 { chord.y.abs() / length } else { 0.0 }
    }

    fn is_corner(&self, index: usize, crease_angle: f64) -> bool {
        let station = &self.stations[index];
        station.turn() > crease_angle
    }

    /// Steps of the ring at a station, by the bands beside it.
    fn steps_needed(&self, index: usize, tolerance: f64) -> u32 {
        let last = self.stations.len() - 1;
        let at_end = index == 0 || index == last;
        let radius = self.radius(index);
        // Chords of rims and of edges are feature lines: they keep the tolerance by themselves.
        let feature = (at_end && !self.closed) || self.stations[index].turn() > STRAIGHT;
        let mut step = if feature { ring_step(radius, tolerance) } else { f64::INFINITY };
        let mut bands = vec![];
        if index > 0 {
            bands.push(index - 1);
        }
        if index < last {
            bands.push(index);
        }
        for band in bands {
            let left = tolerance - self.stations[band].deviation;
            step = step.min(ring_step(radius * self.across(band), left));
        }
        let steps = (self.turn.to_radians() / step).ceil();
        let least = (self.turn / 90.0).ceil().max(1.0);
        let steps = steps.max(least).min(4e9);
        // A full turn in multiples of four is symmetric, and as wide as the circle itself along x and z.
        if self.turn == 360.0 { floor_count((steps / 4.0).ceil()) * 4 } else { floor_count(steps) }
    }

    /// The proved bound of what will be made.
    fn deviation(&self) -> Deviation {
        let mut bound = 0.0_f64;
        let turn = self.turn.to_radians();
        let step = |index: usize| turn / f64::from(self.steps[index].max(1));
        for band in 0..self.stations.len() - 1 {
            let (low, high) = (self.radius(band), self.radius(band + 1));
            let mut inside = 0.0_f64;
            for (radius, index) in [(low, band), (high, band + 1)] {
                if radius > 0.0 {
                    inside = inside.max(radius * step(index) * step(index) / 8.0);
                }
            }
            if low > 0.0 && high > 0.0 {
                let mean = (step(band) + step(band + 1)) / 2.0;
                let roots = low.sqrt() + high.sqrt();
                inside = inside.max(low * high * mean * mean / (2.0 * roots * roots));
            }
            bound = bound.max(self.stations[band].deviation + inside * self.across(band));
        }
        // Rims: the flat side of a disc is exact, its edge is not.
        for index in 0..self.stations.len() {
            if !self.on_axis(index) && self.stations[index].turn() > STRAIGHT || self.is_rim(index) {
                bound = bound.max(self.radius(index) * (1.0 - cos_degrees(step(index).to_degrees() / 2.0)));
            }
        }
        Deviation { bound, evidence: if bound == 0.0 { Evidence::Exact } else { Evidence::Proved } }
    }

    fn is_rim(&self, index: usize) -> bool {
        !self.closed && !self.on_axis(index) && (index == 0 || index == self.stations.len() - 1)
    }
}

/// The step of angle whose chord on a circle of this radius deviates by at most `tolerance`.
fn ring_step(radius: f64, tolerance: f64) -> f64 {
    if radius <= 0.0 { f64::INFINITY } else { (8.0 * tolerance / radius).sqrt() }
}

fn snap_to_axis(stations: &mut [Station]) {
    let reach = stations.iter().map(|station| station.point.x).fold(0.0, f64::max);
    for station in stations {
        if station.point.x.abs() <= ON_AXIS * reach {
            station.point.x = 0.0;
        }
    }
}

/// Whether the outside is to the left of the profile: by the sign of the area that it and the axis enclose;
/// a flat ring shows its face to +y.
fn runs_backward(stations: &[Station]) -> bool {
    let twice_area: f64 = stations
        .windows(2)
        .map(|pair| (pair[0].point.x + pair[1].point.x) * (pair[1].point.y - pair[0].point.y))
        .sum();
    if twice_area == 0.0 {
        stations[stations.len() - 1].point.x > stations[0].point.x
    } else {
        twice_area < 0.0
    }
}

fn fractions(lengths: &[f64]) -> Vec<f64> {
    let whole = lengths[lengths.len() - 1];
    lengths.iter().map(|length| if whole > 0.0 { length / whole } else { 0.0 }).collect()
}

struct Builder<'a> {
    plan: &'a Plan,
    shape: &'a Revolution,
    detail: &'a Detail,
    mesh: Mesh,
    /// First point of each ring.
    rings: Vec<u32>,
    /// Sine and cosine of the steps of the last ring made; neighbours often have equal counts.
    angles: (u32, Vec<(f64, f64)>),
}

impl<'a> Builder<'a> {
    fn new(plan: &'a Plan, shape: &'a Revolution, detail: &'a Detail) -> Self {
        let mut mesh = Mesh::default();
        let points: u64 = plan.steps.iter().map(|steps| u64::from(*steps) + 1).sum();
        let triangles: u64 = plan.steps.windows(2).map(|pair| count(pair[0], pair[1])).sum();
        mesh.points.reserve_exact(size(points));
        mesh.triangles.reserve_exact(size(triangles));
        Self { plan, shape, detail, mesh, rings: Vec::new(), angles: (0, Vec::new()) }
    }

    fn full(&self) -> bool {
        self.shape.angle == 360.0
    }

    fn angle(&self, k: u32, steps: u32) -> f64 {
        if k == steps {
            self.shape.start + self.shape.angle
        } else {
            self.shape.start + self.shape.angle * (f64::from(k) / f64::from(steps))
        }
    }

    /// At least as many vertices as all rows have: two rows at hard joints and at poles inside the profile.
    fn vertices(&self) -> u64 {
        let last = self.plan.stations.len() - 1;
        let row = |index: usize| {
            let (before, after) = self.normals(index);
            let single = index == 0 || index == last || (before == after && !self.plan.on_axis(index));
            let (lower, upper) = self.row_steps(index);
            (u64::from(lower.max(upper)) + 1) * if single { 1 } else { 2 }
        };
        (0..=last).map(row).sum()
    }

    fn rows(&mut self) {
        self.mesh.vertices.reserve_exact(size(self.vertices()));
        let stations = self.plan.stations.len();
        let mut below: Option<Row> = None;
        let mut first: Option<Row> = None;
        for index in 0..stations {
            self.ring(index);
            let (before, after) = self.normals(index);
            let steps = self.row_steps(index);
            let lower = below.take();
            let mut row = None;
            if let Some(lower) = lower {
                let returns = self.plan.closed && index + 1 == stations && before == after && !self.detail.uv;
                let upper = match first.filter(|_| returns) {
                    Some(row) => row,
                    None => self.row(index, before, steps.0),
                };
                self.band(&lower, &upper);
                row = Some(upper);
            }
            if index + 1 < stations {
                let shared = row.filter(|upper| before == after && upper.kind != RowKind::Fan);
                below = Some(shared.unwrap_or_else(|| self.row(index, after, steps.1)));
                first = first.or(below);
            }
        }
    }

    fn band(&mut self, lower: &Row, upper: &Row) {
        if self.plan.backward {
            stitch(upper, lower, &mut self.mesh.triangles);
        } else {
            stitch(lower, upper, &mut self.mesh.triangles);
        }
    }

    /// Steps that the rows before and after a station have: of its own ring, or for a pole of the other ring.
    fn row_steps(&self, index: usize) -> (u32, u32) {
        let steps = &self.plan.steps;
        if steps[index] > 0 {
            return (steps[index], steps[index]);
        }
        let before = if index > 0 { steps[index - 1] } else { 0 };
        (before, steps.get(index + 1).copied().unwrap_or(0))
    }

    /// Makes the points of a station. A pole has one; the end of a closed profile returns to its start.
    fn ring(&mut self, index: usize) {
        let last = self.plan.stations.len() - 1;
        if self.plan.closed && index == last {
            self.rings.push(self.rings[0]);
            return;
        }
        let base = mesh::index(self.mesh.points.len());
        let point = self.plan.stations[index].point;
        let steps = self.plan.steps[index];
        if steps == 0 {
            self.mesh.points.push(DVec3::new(0.0, point.y, 0.0));
        } else {
            self.load_angles(steps);
            let count = if self.full() { steps } else { steps + 1 };
            let around = |(sin, cos): &(f64, f64)| DVec3::new(point.x * cos, point.y, -point.x * sin);
            self.mesh.points.extend(self.angles.1[..count as usize].iter().map(around));
        }
        self.rings.push(base);
    }

    fn load_angles(&mut self, steps: u32) {
        if self.angles.0 != steps {
            let all = (0..=steps).map(|k| sin_cos_degrees(self.angle(k, steps))).collect();
            self.angles = (steps, all);
        }
    }

    /// Normals in the profile's plane before and after a station; equal where the joint is smooth.
    fn normals(&self, index: usize) -> (DVec2, DVec2) {
        let station = &self.plan.stations[index];
        let outward = |direction: DVec3| {
            let normal = DVec2::new(direction.y, -direction.x);
            let normal = if self.plan.backward { -normal } else { normal };
            let normal = if self.plan.on_axis(index) && normal.x.abs() < 1e-6 {
                // Round at the pole: every meridian agrees on the axis.
                DVec2::new(0.0, normal.y.signum())
            } else {
                normal
            };
            normal.normalize_or(DVec2::Y)
        };
        let (before, after) = (outward(station.before), outward(station.after));
        if self.plan.is_corner(index, self.detail.crease_angle) {
            (before, after)
        } else {
            let mean = (before + after).normalize_or(after);
            (mean, mean)
        }
    }

    fn row(&mut self, index: usize, normal: DVec2, steps: u32) -> Row {
        let base = mesh::index(self.mesh.vertices.len());
        let pole = self.plan.on_axis(index);
        let uv = self.detail.uv;
        let kind = match (pole, self.full()) {
            (true, _) if normal.x == 0.0 && !uv => RowKind::Pole,
            (true, _) => RowKind::Fan,
            (false, true) if !uv => RowKind::Round,
            _ => RowKind::Open,
        };
        let vertices = match kind {
            RowKind::Pole => 1,
            RowKind::Round | RowKind::Fan => steps,
            RowKind::Open => steps + 1,
        };
        if kind != RowKind::Fan {
            self.load_angles(steps.max(1));
        }
        for k in 0..vertices {
            let vertex = self.vertex(index, normal, (k, steps, kind));
            self.mesh.vertices.push(vertex);
        }
        Row { base, steps, kind }
    }

    fn vertex(&self, index: usize, normal: DVec2, (k, steps, kind): (u32, u32, RowKind)) -> Vertex {
        let pole = matches!(kind, RowKind::Pole | RowKind::Fan);
        let ring = self.rings[index];
        // A vertex of a pole stands for a whole step: it looks along the middle of it.
        let place = f64::from(k) + if kind == RowKind::Fan { 0.5 } else { 0.0 };
        let fraction = if kind == RowKind::Pole { 0.5 } else { place / f64::from(steps) };
        let (sin, cos) = match kind {
            RowKind::Fan => sin_cos_degrees(self.shape.start + self.shape.angle * fraction),
            RowKind::Pole => (0.0, 1.0),
            _ => self.angles.1[k as usize],
        };
        let point = if pole { ring } else { ring + if self.full() { k % steps } else { k } };
        let along = self.plan.along[index];
        let up = if self.plan.backward { along } else { 1.0 - along };
        Vertex {
            point: PointIndex(point),
            normal: DVec3::new(normal.x * cos, normal.y, -normal.x * sin),
            uv: if self.detail.uv { DVec2::new(fraction, up) } else { DVec2::ZERO },
            color: Color::WHITE,
            anchor: Anchor {
                source: WALL,
                u: self.shape.start + self.shape.angle * fraction,
                v: self.plan.stations[index].t,
            },
        }
    }

    /// Flat faces at the ends of a partial turn.
    fn caps(&mut self) -> Result<(), TessellateError> {
        let stations = &self.plan.stations;
        let last = stations.len() - 1;
        let encloses = self.plan.closed || (self.plan.on_axis(0) && self.plan.on_axis(last));
        if self.full() || !self.shape.caps || !encloses {
            return Ok(());
        }
        let used = if self.plan.closed { last } else { last + 1 };
        let outline: Vec<DVec2> = stations[..used].iter().map(|station| station.point.truncate()).collect();
        for (end, angle) in [self.shape.start, self.shape.start + self.shape.angle].into_iter().enumerate() {
            let (sin, cos) = sin_cos_degrees(angle);
            // The way on around the axis is (-sin, 0, -cos); the first face looks back.
            let onward = DVec3::new(-sin, 0.0, -cos);
            let points = (0..used).map(|index| {
                let far = if end == 1 { self.plan.steps[index] } else { 0 };
                PointIndex(self.rings[index] + far)
            });
            let outline = CapLoop { place: outline.clone(), points: points.collect() };
            let normal = if end == 1 { onward } else { -onward };
            // Seen from the far side, at the last angle, the profile's plane has x to the left.
            let facing = Facing { normal, mirrored: end == 1 };
            add_cap(&mut self.mesh, &[outline], facing, CAP + mesh::index(end), self.detail.uv)?;
        }
        Ok(())
    }
}

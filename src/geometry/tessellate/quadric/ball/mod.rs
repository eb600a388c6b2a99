//! Quadrics inside a ball.
//!
//! The surface of the ball is parted into sheets as the quadric is; both end at the curves in which they meet, which are
//! cut into chords once. Where only touching, quadric and ball do not meet: the ball is larger by a billionth.

mod meeting;
mod stationary;
#[cfg(test)]
mod tests;

use glam::{DMat3, DVec3};

use super::flat::Planes;
use super::judge::FlatChart;
use super::shell::Shell;
use super::skeleton::{Edge, Skeleton};
use super::walled::{Sheets, TRIES, Walled, add_sheets, add_wall, fill_face, in_walls};
use super::{Job, Made, OUTWARD, SHEETS, proved};
use crate::geometry::field::quadric::{HalfSpace, QuadricForm, QuadricKind, Sheet};
use crate::geometry::field::{Field, Quadric};
use crate::geometry::tessellate::TessellateError;
use crate::geometry::tessellate::region::{Arc, Fault, Line as _, PlaneSection};
pub use meeting::Ball;
use meeting::Meeting;

/// The number of the ball among the planes of an edge.
const BALL: usize = 0;

impl Ball {
    /// What only touches the ball is inside.
    fn outward(&self) -> Self {
        Self { radius: self.radius * (1.0 + OUTWARD), ..*self }
    }

    /// How the surface looks to what parts it into sheets.
    fn form(&self) -> QuadricForm {
        QuadricForm {
            kind: QuadricKind::Ellipsoid,
            origin: self.center,
            axes: DMat3::IDENTITY,
            half: DVec3::splat(self.radius),
        }
    }
}

/// A curved quadric inside a ball.
pub(super) fn in_ball(
    quadric: &Quadric,
    form: &QuadricForm,
    ball: &Ball,
    job: &Job,
) -> Result<Made, TessellateError> {
    /// Distance of an apex from the ball's surface as a share of the radius: a circle that small would be dust.
    const NEAR: f64 = 1e-6;
    let ball = ball.outward();
    let sheets = Sheet::all(form, &[]);
    let apex = sheets.first().and_then(Sheet::apex);
    let height = |apex: DVec3| apex.distance(ball.center) - ball.radius;
    if apex.is_some_and(|apex| height(apex).abs() < NEAR * ball.radius) {
        return Err(TessellateError::Tangled);
    }
    let mut cuts: Vec<HalfSpace> = Vec::new();
    for limit in sheets.iter().flat_map(Sheet::limits) {
        if !limit.touches_apex(form) && !cuts.iter().any(|cut| cut.normal.cross(limit.normal).length() < 1e-9)
        {
            cuts.push(limit);
        }
    }
    let own = Sheet::all(&ball.form(), &cuts);
    let meeting = Meeting { quadric, sphere: ball.quadric(), ball };
    let body = Body {
        curves: meeting.curves()?,
        meeting,
        cuts,
        own_cut: own[0].limits()[0],
        apex: apex.filter(|apex| height(*apex) < 0.0),
    };
    let mut job = *job;
    for _ in 0..TRIES {
        let skeleton = body.skeleton(&job)?;
        match body.dress(&sheets, &own, &skeleton, &job)? {
            Ok(made) => return Ok(made),
            Err(Fault::Crossing) => job = job.finer(),
        }
    }
    Err(TessellateError::Tangled)
}

struct Body<'a> {
    meeting: Meeting<'a>,
    curves: Vec<Vec<DVec3>>,
    /// Planes that part the quadric.
    cuts: Vec<HalfSpace>,
    /// The plane that parts the ball.
    own_cut: HalfSpace,
    /// The apex of a cone, inside of the ball.
    apex: Option<DVec3>,
}

/// A point of a curve on the plane of that number; the ball's comes after those of the quadric.
struct Vertex {
    plane: usize,
    index: usize,
}

impl Body<'_> {
    fn size(&self) -> f64 {
        2.0 * self.meeting.ball.radius
    }

    fn skeleton(&self, job: &Job) -> Result<Skeleton, TessellateError> {
        let mut skeleton = Skeleton::default();
        if let Some(apex) = self.apex {
            skeleton.apex = Some(0);
            skeleton.points.push(apex);
        }
        let mut vertices = Vec::new();
        for curve in &self.curves {
            self.add_curve(curve, &mut vertices, &mut skeleton, job)?;
        }
        let ball = self.meeting.ball;
        let around = (ball.center, self.size());
        for (plane, cut) in self.cuts.iter().enumerate() {
            let mut points = on_plane(plane, &vertices, &skeleton);
            if let Some(apex) = self.apex {
                points.push((0, apex));
            }
            let section = section(self.meeting.quadric, cut);
            let inside = |point: DVec3| self.meeting.sphere.value(point) < 0.0;
            skeleton.add_arcs(&section, &points, around, &inside, job)?;
        }
        if job.closed {
            let points = on_plane(self.cuts.len(), &vertices, &skeleton);
            let first = skeleton.edges.len();
            let section = section(&self.meeting.sphere, &self.own_cut);
            let inside = |point: DVec3| self.meeting.quadric.value(point) < 0.0;
            skeleton.add_arcs(&section, &points, around, &inside, job)?;
            for edge in &mut skeleton.edges[first..] {
                (edge.on_quadric, edge.planes[0]) = (false, Some(BALL));
            }
        }
        Ok(skeleton)
    }

    /// Adds a curve as edges between the planes that it crosses.
    fn add_curve(
        &self,
        curve: &[DVec3],
        vertices: &mut Vec<Vertex>,
        skeleton: &mut Skeleton,
        job: &Job,
    ) -> Result<(), TessellateError> {
        let own = job.closed.then_some(&self.own_cut);
        let mut crossings: Vec<(usize, f64, DVec3, usize)> = Vec::new();
        for (plane, cut) in self.cuts.iter().chain(own).enumerate() {
            let found = self.meeting.crossings(curve, |point| cut.depth(point));
            crossings.extend(found.into_iter().map(|(after, share, place)| (after, share, place, plane)));
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let edge =
            |middle: DVec3| Edge { points: Vec::new(), middle, on_quadric: true, planes: [Some(BALL), None] };
        if crossings.is_empty() {
            let stops = curve.iter().chain(&curve[..1]).copied().collect();
            return skeleton.add_line(&self.meeting, &Arc { ends: None, stops }, job, edge(curve[0]));
        }
        let first = skeleton.points.len();
        for (k, (_, _, place, plane)) in crossings.iter().enumerate() {
            skeleton.points.push(*place);
            vertices.push(Vertex { plane: *plane, index: first + k });
        }
        for (k, from) in crossings.iter().enumerate() {
            let next = (k + 1) % crossings.len();
            let to = &crossings[next];
            // Once around where the curve crosses planes in one place only.
            let turns = if next <= k { curve.len() } else { 0 };
            let between = (from.0 + 1..=to.0 + turns).map(|at| curve[at % curve.len()]);
            let stops: Vec<DVec3> = std::iter::once(from.2).chain(between).chain([to.2]).collect();
            let longest = stops
                .windows(2)
                .max_by(|a, b| a[0].distance_squared(a[1]).total_cmp(&b[0].distance_squared(b[1])));
            let middle = longest.map_or(from.2, |pair| self.meeting.bulge(pair[0], pair[1]).0);
            let arc = Arc { ends: Some([first + k, first + next]), stops };
            skeleton.add_line(&self.meeting, &arc, job, edge(middle))?;
        }
        Ok(())
    }

    /// The faces on a skeleton: sheets of the quadric and, of a closed body, of the ball.
    fn dress(
        &self,
        sheets: &[Sheet],
        own: &[Sheet],
        skeleton: &Skeleton,
        job: &Job,
    ) -> Result<Result<Made, Fault>, TessellateError> {
        let mut shell = Shell::on(skeleton.points.clone());
        let mut bound = skeleton.out;
        let of_quadric =
            Sheets { quadric: self.meeting.quadric, all: sheets, first: 0, on: &|edge| edge.on_quadric };
        let of_ball =
            Sheets { quadric: &self.meeting.sphere, all: own, first: SHEETS, on: &|edge| edge.lies_on(BALL) };
        for part in [of_quadric, of_ball].iter().take(if job.closed { 2 } else { 1 }) {
            match add_sheets(part, skeleton, self.size(), &mut shell, job)? {
                Ok(found) => bound = bound.max(found),
                Err(fault) => return Ok(Err(fault)),
            }
            shell.part();
        }
        Ok(Ok(Made { shell, deviation: proved(bound) }))
    }
}

fn on_plane(plane: usize, vertices: &[Vertex], skeleton: &Skeleton) -> Vec<(usize, DVec3)> {
    let on_it = vertices.iter().filter(|vertex| vertex.plane == plane);
    on_it.map(|vertex| (vertex.index, skeleton.points[vertex.index])).collect()
}

fn section(quadric: &Quadric, plane: &HalfSpace) -> PlaneSection {
    PlaneSection { quadric: *quadric, normal: plane.normal, offset: plane.offset }
}

/// A plane or two inside a ball: disks, or the parts of the ball that they leave.
pub(super) fn flat_in_ball(
    form: &QuadricForm,
    ball: &Ball,
    negative: &dyn Fn(DVec3) -> bool,
    job: &Job,
) -> Result<Made, TessellateError> {
    let planes = Planes::new(form, negative);
    let ball = ball.outward();
    let sphere = ball.quadric();
    let around = (ball.center, 2.0 * ball.radius);
    // What only touches the ball cuts nothing off.
    let reach = ball.radius * (1.0 - OUTWARD);
    let mut made = Made { shell: Shell::default(), deviation: proved(0.0) };
    if job.closed {
        for body in &planes.bodies {
            if body.iter().any(|wall| wall.depth(ball.center) <= -reach) {
                continue;
            }
            let walls: Vec<HalfSpace> =
                body.iter().filter(|wall| wall.depth(ball.center) < reach).copied().collect();
            let walled = Walled {
                quadric: &sphere,
                form: &ball.form(),
                walls: &walls,
                first_sheet: SHEETS,
                first_wall: 0,
            };
            let part = in_walls(&walled, around, job)?;
            made.shell.append(part.shell);
            made.deviation.bound = made.deviation.bound.max(part.deviation.bound);
        }
        return Ok(made);
    }
    for (source, plane) in (0..).zip(&planes.all) {
        if plane.depth(ball.center).abs() >= reach {
            continue;
        }
        let mut skeleton = Skeleton::default();
        skeleton.add_arcs(&section(&sphere, plane), &[], around, &|_| true, job)?;
        for edge in &mut skeleton.edges {
            edge.planes[0] = Some(0);
        }
        let mut shell = Shell::on(skeleton.points.clone());
        let Ok(filled) = fill_face(&FlatChart, &skeleton.on_wall(0, plane), &mut shell, job)? else {
            return Err(TessellateError::Tangled);
        };
        let Some((triangles, _)) = filled else { continue };
        add_wall(&mut shell, plane, &triangles, source);
        made.shell.append(shell);
        made.deviation.bound = made.deviation.bound.max(skeleton.out);
    }
    Ok(made)
}

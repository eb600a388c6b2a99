//! Paths of a document: segments end to start, and what is claimed of their joints.

use glam::DVec3;

use super::Builder;
use super::curve::positions;
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Continuity, Curve as _, EllipseArc, Meeting, Parametrization, Path, Polyline,
    Side, Transformed, parameters,
};
use crate::geometry::number;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, ArcSegment, EndRule, Joint, Point, Segment, Sp};
use crate::model::NamedPath;

/// Where a segment starts: the end of the one before, and its direction there.
#[derive(Clone, Copy)]
struct Start {
    point: DVec3,
    /// None for the first segment.
    along: Option<DVec3>,
}

impl Builder<'_> {
    pub(super) fn path(&mut self, path: &spec::Path) -> Option<AnyCurve> {
        let mut curves = Vec::new();
        let mut start = Start { point: path.start.position, along: None };
        for segment in &path.segments {
            let curve = self.segment(start, &segment.value, segment.span)?;
            let end = curve.domain().end;
            let along = curve.direction(end, Side::Before);
            start = Start { point: curve.evaluate(end, Side::Before).point, along: Some(along) };
            curves.push(curve);
        }
        let built = if path.closed.value { Path::closed(curves) } else { Path::new(curves) }?;
        self.check_joints(path, &built);
        let name = self.path_name();
        self.model.paths.push(NamedPath { name, path: built.clone() });
        Some(AnyCurve::Path(built))
    }

    /// The name of a curve as it is, and of a path inside another definition its name and a number.
    fn path_name(&self) -> String {
        let Some((within, inline)) = &self.within else { return String::new() };
        if !inline {
            return within.clone();
        }
        let inside =
            |path: &&NamedPath| path.name.strip_prefix(within).is_some_and(|rest| rest.starts_with('/'));
        format!("{within}/{}", self.model.paths.iter().filter(inside).count() + 1)
    }

    fn segment(&mut self, start: Start, segment: &Segment, span: Span) -> Option<AnyCurve> {
        let with_start = |points: &[Sp<Point>]| {
            let mut all = vec![start.point];
            all.extend(positions(points));
            all
        };
        match segment {
            Segment::Line(points) => Polyline::new(with_start(points), false).map(AnyCurve::Polyline),
            Segment::CatmullRom(points) => {
                let ends = (false, EndRule::Natural);
                self.catmull_rom_through(&with_start(points), 0.5, ends, span)
            }
            Segment::BSpline(points) => self.clamped_b_spline(with_start(points), span),
            Segment::NaturalSpline(points) => {
                let points = with_start(points);
                match parameters(&points, false, Parametrization::Chordal) {
                    Ok(numbers) => self.through(&points, &numbers, false, span),
                    Err(error) => self.degenerate(&error.to_string(), span),
                }
            }
            Segment::Bezier(points) => BezierSpline::new(3, with_start(points)).ok().map(AnyCurve::Bezier),
            Segment::Quadratic(points) => BezierSpline::new(2, with_start(points)).ok().map(AnyCurve::Bezier),
            Segment::Arc(arc) => self.arc_segment(start, arc, span),
            Segment::Curve(reference) => {
                let curve = self.curve_of(reference)?;
                let way = start.point - curve.point(curve.domain().start);
                if way == DVec3::ZERO {
                    return Some(curve);
                }
                let map = glam::DAffine3::from_translation(way);
                Some(AnyCurve::Transformed(Transformed::new(curve, map)))
            }
        }
    }

    fn arc_segment(&mut self, start: Start, arc: &ArcSegment, span: Span) -> Option<AnyCurve> {
        match arc {
            ArcSegment::Through { through, to } => {
                self.arc_through(start.point, through.position, to.position, span)
            }
            ArcSegment::Center { center, angle } => self.arc_about(start.point, center, angle.value, span),
            ArcSegment::Onward { to } => {
                let along = self.onward(start, span)?;
                let arc = tangent_arc(start.point, along, to.position);
                if arc.is_none() {
                    let message =
                        "no arc goes on from the segment before to this point: it lies straight behind";
                    self.report(
                        Diagnostic::error(Code::Degenerate, message)
                            .at(to.span, "straight behind")
                            .help("write a point `through` which the arc is to go"),
                    );
                }
                arc
            }
            ArcSegment::Turn { radius, angle } => {
                let along = self.onward(start, span)?;
                let left = DVec3::Z.cross(along);
                if left.length() < 1e-9 {
                    let message = "an arc by radius and angle turns about the z axis, and the segment before it goes along that axis";
                    self.report(
                        Diagnostic::error(Code::Degenerate, message)
                            .at(span, "no plane to turn in")
                            .help("write `to`, or `through` and `to`"),
                    );
                    return None;
                }
                let side = left.normalize() * radius.value.copysign(angle.value);
                let (x, y) = (-side, along * radius.value);
                let to = angle.value.abs();
                Some(AnyCurve::Ellipse(EllipseArc { center: start.point + side, x, y, from: 0.0, to }))
            }
        }
    }

    /// The direction that an arc goes on in.
    fn onward(&mut self, start: Start, span: Span) -> Option<DVec3> {
        if start.along.is_none() {
            let message = "this arc goes on in the direction of the segment before, and there is none";
            self.report(
                Diagnostic::error(Code::Degenerate, message)
                    .at(span, "the first segment")
                    .help("write `through` and `to`, or `center` and `angle`"),
            );
        }
        start.along
    }

    fn arc_about(&mut self, start: DVec3, center: &Sp<Point>, angle: f64, span: Span) -> Option<AnyCurve> {
        let spoke = start - center.position;
        if spoke.truncate().length() == 0.0 {
            let message = "the center of an arc is the point it starts from";
            self.report(
                Diagnostic::error(Code::Degenerate, message)
                    .at(center.span, "no radius")
                    .also(span, "the arc"),
            );
            return None;
        }
        let y = DVec3::new(-spoke.y, spoke.x, 0.0);
        Some(AnyCurve::Ellipse(EllipseArc { center: center.position, x: spoke, y, from: 0.0, to: angle }))
    }

    /// Joints must be what they are declared.
    fn check_joints(&mut self, path: &spec::Path, built: &Path) {
        let Some(joints) = &path.joints else { return };
        let inner = path.segments.len() - 1;
        for (index, joint) in joints.iter().enumerate() {
            // The joint after the last inner one is the seam of a closed path, at the start.
            let place = if index == inner { 0 } else { index + 1 };
            let meeting = built.meeting(place);
            let Some(fault) = fault(joint.value, &meeting) else { continue };
            let found = match meeting.continuity() {
                Continuity::Gap | Continuity::G0 => "corner".to_owned(),
                Continuity::G1 => "smooth".to_owned(),
                better => better.to_string(),
            };
            let message =
                format!("joint {index} of this path is declared {}, but {fault}", joint.value.text());
            let report = Diagnostic::error(Code::BrokenJoint, message)
                .at(joint.span, "does not hold")
                .also(path.segments[place].span, "the segment that starts there")
                .help(format!("write \"{found}\", which holds, or change the segments"));
            self.report(report);
        }
    }
}

/// By how much a joint fails to be what it is declared; none where it holds.
fn fault(declared: Joint, meeting: &Meeting) -> Option<String> {
    let claim = match declared {
        Joint::Corner => return None,
        Joint::Smooth => Continuity::G1,
        Joint::C1 => Continuity::C1,
        Joint::G2 => Continuity::G2,
        Joint::C2 => Continuity::C2,
    };
    if meeting.holds(claim) {
        return None;
    }
    if !meeting.holds(Continuity::G1) {
        return Some(format!("the direction turns by {:.3} degrees there", meeting.turn.to_degrees()));
    }
    if claim == Continuity::G2 {
        let [before, after] = meeting.curvature.map(DVec3::length);
        let apart = meeting.curvature[0].distance(meeting.curvature[1]);
        return Some(format!(
            "the curvature jumps from {before:.6} to {after:.6} there (1 / radius), a step of {apart:.6}"
        ));
    }
    if !meeting.holds(Continuity::C1) {
        let [before, after] = meeting.first.map(DVec3::length);
        return Some(format!(
            "the speed jumps from {before:.6} to {after:.6} there (length for each segment's unit of the parameter)"
        ));
    }
    let apart = meeting.second[0].distance(meeting.second[1]);
    Some(format!("the second derivative jumps by {apart:.6} there"))
}

/// The arc from a point in a direction to another point; a line where that is straight ahead, none where it is
/// straight behind.
fn tangent_arc(start: DVec3, along: DVec3, to: DVec3) -> Option<AnyCurve> {
    /// A bend whose radius is beyond 1e12 times the distance is none.
    const STRAIGHT: f64 = 1e-12;
    let way = to - start;
    let ahead = way.dot(along);
    let aside = way - along * ahead;
    if aside.length() <= STRAIGHT * way.length() {
        return if ahead > 0.0 {
            Polyline::new(vec![start, to], false).map(AnyCurve::Polyline)
        } else {
            None
        };
    }
    let left = aside.normalize();
    let radius = way.length_squared() / (2.0 * aside.length());
    let angle = number::atan2(ahead, radius - aside.length()).to_degrees();
    let angle = if angle <= 0.0 { angle + 360.0 } else { angle };
    let center = start + left * radius;
    Some(AnyCurve::Ellipse(EllipseArc { center, x: left * -radius, y: along * radius, from: 0.0, to: angle }))
}

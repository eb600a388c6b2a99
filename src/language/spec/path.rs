//! Paths: pieces of several kinds joined end to end.

use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::arc::check_three;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, kinds, table};
use crate::language::spec::kind::{Kinds, take_kind};
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::report_repeated;
use crate::language::value::Value;

table! {
    /// Lines, arcs and splines joined end to end: each segment starts where the one before ends.
    "path" pub Path {
        /// Where it starts.
        start: Sp<Point>;
        /// The segments, in order.
        segments: Vec<Sp<Segment>> => Check::items(1);
        /// What each joint between segments is: a `"corner"`, of which nothing is claimed, or how well the segments
        /// must meet (`"smooth"`, `"C1"`, `"G2"`, `"C2"`), which is then proved. One for each joint; one more, for
        /// the start, when the path is closed. Nothing is claimed of joints when none is written.
        joints: Option<Sp<Vec<Sp<Joint>>>>;
        /// Whether it is closed; a line is added when the end is not the start.
        closed: Sp<bool> = false;
    }
    checked check
}

kinds! {
    /// A segment of a path; it starts where the one before ends.
    "segment" Segment {
        /// Straight lines to each of these points.
        Line(Vec<Sp<Point>>) = "line";
        /// A natural spline through the current point and these.
        NaturalSpline(Vec<Sp<Point>>) = "natural-spline";
        /// A centripetal Catmull-Rom spline through the current point and these.
        CatmullRom(Vec<Sp<Point>>) = "catmull-rom";
        /// A cubic B-spline (of a lower degree with less than 3 points) from the current point, drawn towards these, to the
        /// last of them.
        BSpline(Vec<Sp<Point>>) = "b-spline";
        /// Cubic Bezier curves: for each, two control points and the end.
        Bezier(Vec<Sp<Point>>) = "bezier";
        /// Quadratic Bezier curves: for each, a control point and the end.
        Quadratic(Vec<Sp<Point>>) = "quadratic";
        /// A part of a circle.
        Arc(ArcSegment) = "arc";
        /// Another curve, by name or in place, moved so that it starts where the segment before ends.
        Curve(CurveReference) = "curve";
    }
}

choices! {
    /// How two segments meet.
    Joint {
        /// With a sharp edge.
        Corner = "corner";
        /// With one common direction (G1).
        Smooth = "smooth";
        /// With one common first derivative: direction and speed, where each segment takes one unit of the parameter.
        C1 = "C1";
        /// With one common direction and curvature, so that reflections do not break.
        G2 = "G2";
        /// With common first and second derivatives.
        C2 = "C2";
    }
}

/// An arc that starts at the current point of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum ArcSegment {
    /// Through one point to the next.
    Through {
        /// A point between start and end.
        through: Sp<Point>,
        /// The end.
        to: Sp<Point>,
    },
    /// Around a center.
    Center {
        /// The center.
        center: Sp<Point>,
        /// Degrees, counterclockwise where positive; from -360 to 360, not 0.
        angle: Sp<f64>,
    },
    /// On in the direction of the segment before, to a point.
    Onward {
        /// The end.
        to: Sp<Point>,
    },
    /// On in the direction of the segment before.
    Turn {
        /// The radius, greater than 0.
        radius: Sp<f64>,
        /// Degrees, to the left where positive; from -360 to 360, not 0.
        angle: Sp<f64>,
    },
}

table! {
    /// A part of a circle from the current point of a path: `through` and `to`; or `center` and `angle`; or going on
    /// in the direction of the segment before, `to` a point, or by `radius` and `angle`.
    "arc segment" pub(crate) ArcSegmentFields {
        /// A point between start and end.
        through: Option<Sp<Point>>;
        /// Where it ends.
        to: Option<Sp<Point>>;
        /// The center.
        center: Option<Sp<Point>>;
        /// The radius of an arc that goes on in the direction of the segment before.
        radius: Option<Sp<f64>> => Check::above(0.0);
        /// How far it turns about the center in degrees: counterclockwise, to the left, where positive.
        angle: Option<Sp<f64>> => Check::within(-360.0, 360.0).other_than_zero();
    }
}

impl Read for Segment {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, Self::TITLE, reader)?;
        let kind = take_kind::<Self>(&mut fields, reader);
        let read = if fields.close(reader) { kind } else { None };
        read.filter(|segment| segment.check_points(value.span, reader))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        schemas.object(
            "segment",
            "A segment of a path; it starts where the one before ends.",
            Self::describe_kinds,
        )
    }
}

impl Read for ArcSegment {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let fields = ArcSegmentFields::read(value, reader)?;
        match (fields.through, fields.to, fields.center, fields.radius, fields.angle) {
            (Some(through), Some(to), None, None, None) => Some(Self::Through { through, to }),
            (None, Some(to), None, None, None) => Some(Self::Onward { to }),
            (None, None, Some(center), None, Some(angle)) => Some(Self::Center { center, angle }),
            (None, None, None, Some(radius), Some(angle)) => Some(Self::Turn { radius, angle }),
            (through, to, center, radius, angle) => {
                let points = through.is_some() || to.is_some();
                let sizes = center.is_some() || radius.is_some() || angle.is_some();
                let both = (points && sizes) || (center.is_some() && radius.is_some());
                let code = if both { Code::Conflict } else { Code::MissingField };
                let message = "an arc segment has either `through` and `to`, or `center` and `angle`, or goes on from the segment before with `to`, or with `radius` and `angle`";
                reader.report(Diagnostic::error(code, message).at(value.span, "none of these forms"));
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        ArcSegmentFields::schema(schemas)
    }
}

impl Segment {
    /// The points that are written, in order.
    #[must_use]
    pub fn points(&self) -> Vec<&Sp<Point>> {
        match self {
            Self::Line(points)
            | Self::NaturalSpline(points)
            | Self::CatmullRom(points)
            | Self::BSpline(points)
            | Self::Bezier(points)
            | Self::Quadratic(points) => points.iter().collect(),
            Self::Arc(ArcSegment::Through { through, to }) => vec![through, to],
            Self::Arc(ArcSegment::Center { center, .. }) => vec![center],
            Self::Arc(ArcSegment::Onward { to }) => vec![to],
            Self::Arc(ArcSegment::Turn { .. }) | Self::Curve(_) => Vec::new(),
        }
    }

    /// Where it ends, where that is written.
    #[must_use]
    pub fn end(&self) -> Option<&Sp<Point>> {
        match self {
            Self::Arc(ArcSegment::Center { .. }) => None,
            _ => self.points().last().copied(),
        }
    }

    fn check_points(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let (count, multiple) = match self {
            Self::Line(points)
            | Self::NaturalSpline(points)
            | Self::CatmullRom(points)
            | Self::BSpline(points) => (points.len(), 1),
            Self::Bezier(points) => (points.len(), 3),
            Self::Quadratic(points) => (points.len(), 2),
            Self::Arc(_) | Self::Curve(_) => return true,
        };
        if count > 0 && count % multiple == 0 {
            return true;
        }
        let kind = self.kind();
        let needs = if multiple == 1 {
            "at least 1 point".to_owned()
        } else {
            format!("{multiple} points for each curve")
        };
        let message = format!("a {kind} segment needs {needs}, found {count}");
        reader
            .report(Diagnostic::error(Code::WrongCount, message).at(span, "the start is not written again"));
        false
    }
}

impl Path {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let counted = self.check_joints(reader);
        self.check_steps(reader) && counted
    }

    fn check_joints(&self, reader: &mut Reader<'_>) -> bool {
        let Some(joints) = &self.joints else { return true };
        let inner = self.segments.len() - 1;
        if joints.len() == inner || (self.closed.value && joints.len() == inner + 1) {
            return true;
        }
        let fits = if self.closed.value { format!("{inner} or {}", inner + 1) } else { inner.to_string() };
        let count = self.segments.len();
        let segments = if count == 1 { "segment" } else { "segments" };
        let named = if fits == "1" { "joint" } else { "joints" };
        let message = format!("a path of {count} {segments} has {fits} {named}, found {}", joints.len());
        reader
            .report(Diagnostic::error(Code::WrongCount, message).at(joints.span, format!("expected {fits}")));
        false
    }

    /// Steps of no length, segment by segment, as far as the current point is written.
    fn check_steps(&self, reader: &mut Reader<'_>) -> bool {
        let mut current = Some(self.start);
        let mut good = true;
        for segment in &self.segments {
            good &= check_step(current, segment, reader);
            current = segment.end().copied();
        }
        good
    }
}

fn check_step(current: Option<Sp<Point>>, segment: &Sp<Segment>, reader: &mut Reader<'_>) -> bool {
    match (&segment.value, current) {
        (
            Segment::Line(points)
            | Segment::NaturalSpline(points)
            | Segment::CatmullRom(points)
            | Segment::BSpline(points),
            _,
        ) => {
            let first =
                points.first().zip(current).is_some_and(|(first, now)| first.position == now.position);
            if first {
                let report =
                    Diagnostic::error(Code::RepeatedPoints, "this segment begins with the current point")
                        .at(points[0].span, "already there")
                        .help("leave it out: a segment starts where the one before ends");
                reader.report(report);
            }
            report_repeated(points, false, segment.kind(), reader) && !first
        }
        (Segment::Bezier(points), Some(now)) => check_curves(now, points, 3, reader),
        (Segment::Quadratic(points), Some(now)) => check_curves(now, points, 2, reader),
        (Segment::Arc(ArcSegment::Through { through, to }), Some(now)) => {
            check_three(&[now, *through, *to], segment.span, reader)
        }
        (Segment::Arc(ArcSegment::Onward { to }), Some(now)) if to.position == now.position => {
            let report = Diagnostic::error(Code::RepeatedPoints, "this arc ends at the current point");
            reader.report(report.at(to.span, "already there"));
            false
        }
        (Segment::Arc(ArcSegment::Center { center, .. }), Some(now)) if center.position == now.position => {
            let report = Diagnostic::error(Code::Degenerate, "the center of this arc is the current point")
                .at(center.span, "an arc needs a radius");
            reader.report(report);
            false
        }
        _ => true,
    }
}

fn check_curves(mut now: Sp<Point>, points: &[Sp<Point>], step: usize, reader: &mut Reader<'_>) -> bool {
    let mut good = true;
    for curve in points.chunks(step) {
        if curve.iter().all(|point| point.position == now.position) {
            let report = Diagnostic::error(Code::RepeatedPoints, "all points of this curve are equal");
            reader.report(report.at(curve[0].span, "no curve"));
            good = false;
        }
        now = curve[step - 1];
    }
    good
}

//! B-splines and NURBS: control points, knots and weights.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::knots::{KnotFrame, KnotRule};
use crate::language::spec::point::Point;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// A B-spline: a smooth curve that is drawn towards its control points and stays inside their hull. Of degree 3
    /// it has a continuous curvature; each point bends only the part of the curve near it.
    "b-spline" pub BSpline {
        /// The control points, in order; at least `degree` and 1 more, or 3 when closed.
        points: Sp<Vec<Sp<Point>>> => Check::items(2);
        /// Degree of the pieces: 1 is a polyline, 2 has a continuous direction, 3 a continuous curvature.
        degree: Sp<u32> = 3 => Check::within(1.0, 25.0);
        /// Whether it runs back to its start, as smooth there as everywhere.
        closed: Sp<bool> = false;
        /// The parameters at which pieces meet. `"clamped"` begins and ends at the first and last point (when open,
        /// this is meant where nothing is written); `"uniform"` has equal steps everywhere and ends near them (when
        /// closed, this is meant). Or numbers that never decrease: as many as points, `degree` and 1 more; the
        /// parameter then runs from the number after the first `degree` ones to the one before the last `degree`. A
        /// number that is repeated takes a derivative from the smoothness there. When closed, one period: as many
        /// as points and 1 more.
        knots: Option<Sp<KnotRule>>;
    }
    checked check
}

table! {
    /// A rational B-spline: as `b-spline`, with a weight for each control point. It makes circles and ellipses
    /// exactly.
    "nurbs" pub Nurbs {
        /// The control points, in order. A point of weight 0 lies at infinity: what is written is then its direction,
        /// and its length says how far the curve is drawn that way.
        points: Sp<Vec<Sp<Point>>> => Check::items(2);
        /// One for each point, at least 0: how strongly it draws the curve.
        weights: Sp<Vec<Sp<f64>>>;
        /// Degree of the pieces.
        degree: Sp<u32> = 3 => Check::within(1.0, 25.0);
        /// Whether it runs back to its start, as smooth there as everywhere.
        closed: Sp<bool> = false;
        /// The parameters at which pieces meet; as of a `b-spline`.
        knots: Option<Sp<KnotRule>>;
    }
    checked check
}

impl BSpline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (degree, closed, knots) = (self.degree, self.closed, self.knots.as_ref());
        check_frame("B-spline", &self.points, (degree, closed), knots, reader)
    }
}

impl Nurbs {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (degree, closed, knots) = (self.degree, self.closed, self.knots.as_ref());
        let framed = check_frame("NURBS", &self.points, (degree, closed), knots, reader);
        check_weights(&self.weights, self.points.len(), reader) && framed
    }
}

/// What must hold of B-splines and of NURBS.
fn check_frame(
    what: &'static str,
    points: &Sp<Vec<Sp<Point>>>,
    (degree, closed): (Sp<u32>, Sp<bool>),
    knots: Option<&Sp<KnotRule>>,
    reader: &mut Reader<'_>,
) -> bool {
    let count = Sp::new(points.len(), points.span);
    KnotFrame { what, points: count, degree, closed, knots }.check(reader)
        && check_moving(points, degree.value as usize, closed.value, reader)
}

/// A weight for each point, none negative and not all zero; tiny ones are taken for slips.
pub(crate) fn check_weights(weights: &Sp<Vec<Sp<f64>>>, points: usize, reader: &mut Reader<'_>) -> bool {
    const LEAST_SHARE: f64 = 1e-9;
    if weights.len() != points {
        let message = format!("{points} points need {points} weights, found {}", weights.len());
        reader.report(
            Diagnostic::error(Code::WrongCount, message).at(weights.span, format!("expected {points}")),
        );
        return false;
    }
    let greatest = weights.iter().map(|weight| weight.value).fold(0.0, f64::max);
    if greatest == 0.0 && weights.iter().all(|weight| weight.value == 0.0) {
        let report = Diagnostic::error(Code::BadWeight, "all weights are 0")
            .at(weights.span, "no point is left to hold the curve")
            .help("a weight of 0 puts a point at infinity; at least every second point is finite");
        reader.report(report);
        return false;
    }
    let mut good = true;
    for weight in weights.iter() {
        let tiny = weight.value > 0.0 && weight.value < LEAST_SHARE * greatest;
        if weight.value < 0.0 || tiny {
            let shown = show_number(weight.value);
            let report = if tiny {
                Diagnostic::error(
                    Code::BadWeight,
                    format!("the weight {shown} is lost beside {}", show_number(greatest)),
                )
                .at(weight.span, "less than a billionth of the greatest")
            } else {
                Diagnostic::error(Code::BadWeight, format!("a weight is at least 0, found {shown}"))
                    .at(weight.span, "negative")
                    .help("a negative weight would let the curve run to infinity and come back from behind")
            };
            reader.report(report);
            good = false;
        }
    }
    good
}

/// A piece whose control points are all equal stands still.
fn check_moving(points: &Sp<Vec<Sp<Point>>>, degree: usize, closed: bool, reader: &mut Reader<'_>) -> bool {
    let count = points.len();
    let windows = if closed { count } else { count - degree };
    let still =
        |start: &usize| (1..=degree).all(|k| points[(start + k) % count].position == points[*start].position);
    let Some(start) = (0..windows).find(still) else { return true };
    let message = if degree == 1 {
        format!("`points[{start}]` and `points[{}]` are the same point", (start + 1) % count)
    } else {
        format!(
            "{} control points from `points[{start}]` on are the same: the curve stands still",
            degree + 1
        )
    };
    let report = Diagnostic::error(Code::RepeatedPoints, message)
        .at(points[(start + degree) % count].span, "once too often")
        .also(points[start].span, "the first of them")
        .help(if degree == 1 {
            "leave one of them out".to_owned()
        } else {
            format!("{degree} equal points in a row already make a corner")
        });
    reader.report(report);
    false
}

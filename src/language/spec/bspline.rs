//! B-splines and NURBS: control points, knots and weights.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::kind::choice;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::check_closed;
use crate::language::value::{Data, Value, show_number};

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

/// How the knots of a B-spline are given.
#[derive(Clone, Debug, PartialEq)]
pub enum KnotRule {
    /// Equal steps, the ends repeated so that the curve reaches its first and last point.
    Clamped,
    /// Equal steps.
    Uniform,
    /// As written: never decreasing, as many as fit, none repeated too often.
    Given(Vec<Sp<f64>>),
}

const RULES: [&str; 2] = ["clamped", "uniform"];

impl Read for KnotRule {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Array(_)) {
            return Vec::read(value, reader).map(Self::Given);
        }
        match choice(value, &RULES, reader)? {
            "uniform" => Some(Self::Uniform),
            _ => Some(Self::Clamped),
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&RULES);
        alternatives.push(Vec::<f64>::schema(schemas));
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        match self {
            Self::Clamped => Some(json!("clamped")),
            Self::Uniform => Some(json!("uniform")),
            Self::Given(numbers) => numbers.written(),
        }
    }
}

/// What a B-spline and a NURBS have in common.
struct Frame<'a> {
    what: &'static str,
    points: &'a Sp<Vec<Sp<Point>>>,
    degree: Sp<u32>,
    closed: Sp<bool>,
    knots: Option<&'a Sp<KnotRule>>,
}

impl BSpline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (degree, closed, knots) = (self.degree, self.closed, self.knots.as_ref());
        Frame { what: "B-spline", points: &self.points, degree, closed, knots }.check(reader)
    }
}

impl Nurbs {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (degree, closed, knots) = (self.degree, self.closed, self.knots.as_ref());
        let framed = Frame { what: "NURBS", points: &self.points, degree, closed, knots }.check(reader);
        check_weights(&self.weights, self.points.len(), reader) && framed
    }
}

impl Frame<'_> {
    fn degree(&self) -> usize {
        self.degree.value as usize
    }

    fn check(&self, reader: &mut Reader<'_>) -> bool {
        check_closed(self.what, self.points.len(), self.closed, reader)
            && self.check_count(reader)
            && self.check_knots(reader)
            && check_moving(self.points, self.degree(), self.closed.value, reader)
    }

    fn check_count(&self, reader: &mut Reader<'_>) -> bool {
        let (count, degree) = (self.points.len(), self.degree());
        if self.closed.value || count > degree {
            return true;
        }
        let message = format!(
            "an open {} of degree {degree} needs at least {} points, found {count}",
            self.what,
            degree + 1
        );
        let report = Diagnostic::error(Code::FewPoints, message)
            .at(self.points.span, "too few for the degree")
            .also(self.degree.span, "the degree")
            .help(format!("write `degree = {}`, or more points", count - 1));
        reader.report(report);
        false
    }

    fn check_knots(&self, reader: &mut Reader<'_>) -> bool {
        match self.knots.map(|rule| (&rule.value, rule.span)) {
            Some((KnotRule::Clamped, span)) if self.closed.value => {
                let report =
                    Diagnostic::error(Code::Conflict, "a closed curve has no ends that could be clamped")
                        .at(span, "cannot stand beside `closed`")
                        .also(self.closed.span, "closed")
                        .help("leave `knots` out: they are uniform");
                reader.report(report);
                false
            }
            Some((KnotRule::Given(numbers), span)) => {
                self.check_knot_count(numbers, span, reader)
                    && check_order(numbers, reader)
                    && self.check_multiplicities(numbers, reader)
            }
            _ => true,
        }
    }

    fn check_knot_count(&self, numbers: &[Sp<f64>], span: Span, reader: &mut Reader<'_>) -> bool {
        let (points, degree) = (self.points.len(), self.degree());
        let expected = if self.closed.value { points + 1 } else { points + degree + 1 };
        if numbers.len() == expected {
            return true;
        }
        let closed = if self.closed.value { "closed " } else { "" };
        let sum =
            if self.closed.value { format!("{points} + 1") } else { format!("{points} + {degree} + 1") };
        let message = format!(
            "a {closed}{} of {points} points and degree {degree} has {expected} knots, found {}",
            self.what,
            numbers.len()
        );
        let report = Diagnostic::error(Code::WrongCount, message)
            .at(span, format!("expected {expected}"))
            .note(if self.closed.value {
                format!("points + 1 = {sum}: one period, its start and its end")
            } else {
                format!("points + degree + 1 = {sum}")
            });
        reader.report(report);
        false
    }

    /// Inside the domain a knot may stand as often as the degree, at its ends once more.
    fn check_multiplicities(&self, numbers: &[Sp<f64>], reader: &mut Reader<'_>) -> bool {
        let (degree, last) = (self.degree(), numbers.len() - 1);
        let (start, end) = if self.closed.value {
            (numbers[0].value, numbers[last].value)
        } else {
            (numbers[degree].value, numbers[last - degree].value)
        };
        if start == end {
            let message = format!("all knots of the domain are {}", show_number(start));
            let report = Diagnostic::error(Code::KnotRepeated, message)
                .at(numbers[if self.closed.value { 0 } else { degree }].span, "the parameter has no room");
            reader.report(report);
            return false;
        }
        let seam =
            numbers.iter().filter(|knot| self.closed.value && (knot.value == start || knot.value == end));
        if seam.count().saturating_sub(1) > degree {
            let message = format!("the seam repeats its knot more than {degree} times, the degree");
            reader.report(Diagnostic::error(Code::KnotRepeated, message).at(numbers[0].span, "too often"));
            return false;
        }
        let mut good = true;
        for run in numbers.chunk_by(|a, b| a.value == b.value) {
            let inside = self.closed.value || (run[0].value > start && run[0].value < end);
            let most = degree + usize::from(!inside);
            if run.len() > most {
                reader.report(repeated_knot(run, most, degree));
                good = false;
            }
        }
        good
    }
}

fn repeated_knot(run: &[Sp<f64>], most: usize, degree: usize) -> Diagnostic {
    let message = format!(
        "the knot {} stands {} times, more than {most} for degree {degree}",
        show_number(run[0].value),
        run.len()
    );
    Diagnostic::error(Code::KnotRepeated, message)
        .at(run[most].span, "once too often")
        .help("a knot as often as the degree makes a corner; once more would break the curve")
}

/// Knots that never decrease, nor differ by less than rounding.
fn check_order(numbers: &[Sp<f64>], reader: &mut Reader<'_>) -> bool {
    const CLOSEST: f64 = 1e-9;
    let length = numbers[numbers.len() - 1].value - numbers[0].value;
    let wrong = |pair: &[Sp<f64>]| {
        let step = pair[1].value - pair[0].value;
        step < 0.0 || (step > 0.0 && step < CLOSEST * length)
    };
    let Some(index) = numbers.windows(2).position(wrong) else { return true };
    let (before, after) = (&numbers[index], &numbers[index + 1]);
    let (shown_before, shown_after) = (show_number(before.value), show_number(after.value));
    let (message, label) = if after.value < before.value {
        (
            format!(
                "knots must not decrease, found {shown_after} after {shown_before} at index {}",
                index + 1
            ),
            "less than the one before",
        )
    } else {
        (format!("knots {shown_before} and {shown_after} are different, but hardly"), "equal or further away")
    };
    let report =
        Diagnostic::error(Code::KnotOrder, message).at(after.span, label).also(before.span, "the one before");
    reader.report(report);
    false
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

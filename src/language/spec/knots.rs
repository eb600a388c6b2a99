//! Knots: the parameters at which the pieces of B-splines meet, and what must hold of them.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::kind::choice;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::check_closed;
use crate::language::value::{Data, Value, show_number};

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

/// Knots beside what they must fit: of a curve, or of a surface in one direction.
pub(crate) struct KnotFrame<'a> {
    /// What has the knots, as a message names it: `B-spline`.
    pub(crate) what: &'static str,
    /// How many control points there are, and where they are written.
    pub(crate) points: Sp<usize>,
    /// Degree of the pieces.
    pub(crate) degree: Sp<u32>,
    /// Whether the end runs back to the start.
    pub(crate) closed: Sp<bool>,
    /// How the knots are given; `None` where nothing is written.
    pub(crate) knots: Option<&'a Sp<KnotRule>>,
}

impl KnotFrame<'_> {
    fn degree(&self) -> usize {
        self.degree.value as usize
    }

    /// Whether points are enough and knots fit; reports what does not.
    pub(crate) fn check(&self, reader: &mut Reader<'_>) -> bool {
        check_closed(self.what, self.points.value, self.closed, reader)
            && self.check_count(reader)
            && self.check_knots(reader)
    }

    fn check_count(&self, reader: &mut Reader<'_>) -> bool {
        let (count, degree) = (self.points.value, self.degree());
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
                let report = Diagnostic::error(
                    Code::Conflict,
                    format!("a closed {} has no ends that could be clamped", self.what),
                )
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
        let (points, degree) = (self.points.value, self.degree());
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

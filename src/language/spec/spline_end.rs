//! Cubic splines with end conditions, in space and of one variable.

use glam::DVec2;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::kind::choice;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::schema::{Object, Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::{
    Parameters, check_closed, check_parameters, not_increasing, report_repeated,
};
use crate::language::value::{Data, Value, show_number};

table! {
    /// A cubic spline through points: its curvature is continuous. What it does at its ends is said; written plainly
    /// it is a `natural-spline`.
    "spline" pub Spline {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// Whether it runs back to the first point, smooth there too (periodic).
        closed: Sp<bool> = false;
        /// How the parameter is spread over the points: as of a `natural-spline`.
        parameters: Sp<Parameters> = Parameters::Chordal;
        /// What holds at both ends: `"natural"` (the second derivative is 0), `"clamped"` (the first derivative is 0),
        /// `"not-a-knot"` (the first two pieces are one cubic, and the last two), `{ first = [x, y] }` or
        /// `{ second = [x, y] }` (that derivative by the parameter). Natural when nothing is written.
        ends: Option<Sp<SplineEnd<Point>>>;
        /// What holds at the start, where that is not what holds at both ends.
        start: Option<Sp<SplineEnd<Point>>>;
        /// What holds at the end, where that is not what holds at both ends.
        end: Option<Sp<SplineEnd<Point>>>;
    }
    checked check
}

table! {
    /// The graph of a function that is known at some places: a cubic spline y = S(x) through a table of x and y.
    "function-spline" pub FunctionSpline {
        /// The table, `[x, y]` each; x increases.
        points: Vec<Sp<DVec2>> => Check::items(2);
        /// What holds at both ends: `"natural"`, `"clamped"`, `"not-a-knot"`, `{ first = y' }` or `{ second = y'' }`;
        /// as of a `spline`.
        ends: Option<Sp<SplineEnd<f64>>>;
        /// What holds at the start, where that is not what holds at both ends.
        start: Option<Sp<SplineEnd<f64>>>;
        /// What holds at the end, where that is not what holds at both ends.
        end: Option<Sp<SplineEnd<f64>>>;
        /// Whether the function repeats itself: the last y is the first, and so are both derivatives.
        periodic: Sp<bool> = false;
    }
    checked check
}

/// What holds at an end of a cubic spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplineEnd<T> {
    /// The second derivative is zero.
    Natural,
    /// The first derivative is zero.
    Clamped,
    /// The two pieces next to the end are one cubic.
    NotAKnot,
    /// The first derivative is given.
    First(Sp<T>),
    /// The second derivative is given.
    Second(Sp<T>),
}

/// What a derivative is, with the title and the description of the table that holds it.
pub(crate) trait Derivative: Read {
    /// Title of the table.
    const TITLE: &'static str;
    /// What the table is.
    const DOC: &'static str;
}

impl Derivative for Point {
    const TITLE: &'static str = "spline end";
    const DOC: &'static str = "What holds at an end of a spline: either `first` or `second`.";
}

impl Derivative for f64 {
    const TITLE: &'static str = "function end";
    const DOC: &'static str = "What holds at an end of a function spline: either `first` or `second`.";
}

const RULES: [&str; 3] = ["natural", "clamped", "not-a-knot"];

impl<T: Derivative> Read for SplineEnd<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if !matches!(value.data, Data::Table(_)) {
            return Some(match choice(value, &RULES, reader)? {
                "clamped" => Self::Clamped,
                "not-a-knot" => Self::NotAKnot,
                _ => Self::Natural,
            });
        }
        let mut fields = Fields::open(value, T::TITLE, reader)?;
        let first = fields.take::<Option<Sp<T>>>("first", None, Check::ANY, reader);
        let second = fields.take::<Option<Sp<T>>>("second", None, Check::ANY, reader);
        if !fields.close(reader) {
            return None;
        }
        match (first?, second?) {
            (Some(first), None) => Some(Self::First(first)),
            (None, Some(second)) => Some(Self::Second(second)),
            (first, _) => {
                let (code, message) = if first.is_some() {
                    (Code::Conflict, "an end of a spline has either `first` or `second`, not both")
                } else {
                    (Code::MissingField, "an end of a spline needs `first` or `second`")
                };
                reader.report(Diagnostic::error(code, message).at(value.span, "one derivative"));
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        fn describe<T: Derivative>(object: &mut Object, schemas: &mut Schemas) {
            object.field::<Option<Sp<T>>>("first", "The first derivative.", None, Check::ANY, schemas);
            object.field::<Option<Sp<T>>>("second", "The second derivative.", None, Check::ANY, schemas);
        }
        let mut alternatives = one_of_words(&RULES);
        alternatives.push(schemas.object(T::TITLE, T::DOC, describe::<T>));
        any_of(alternatives)
    }
}

impl Spline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_closed("spline", self.points.len(), self.closed, reader)
            && report_repeated(&self.points, self.closed.value, "points", reader)
            && check_parameters(&self.parameters, self.points.len(), self.closed.value, reader)
            && check_ends((&self.ends, &self.start, &self.end), ("closed", self.closed), reader)
    }
}

impl FunctionSpline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        self.check_order(reader)
            && check_ends((&self.ends, &self.start, &self.end), ("periodic", self.periodic), reader)
            && self.check_period(reader)
    }

    fn check_order(&self, reader: &mut Reader<'_>) -> bool {
        let fault = not_increasing("x", self.points.iter().map(|point| (point.x, point.span)));
        let good = fault.is_none();
        let help = "a function has one y at each x; a curve that turns back is a `spline`";
        fault.into_iter().for_each(|report| reader.report(report.help(help)));
        good
    }

    fn check_period(&self, reader: &mut Reader<'_>) -> bool {
        let (first, last) = (&self.points[0], &self.points[self.points.len() - 1]);
        if !self.periodic.value {
            return true;
        }
        if self.points.len() < 3 {
            let report = Diagnostic::error(Code::WrongLength, "a periodic function needs at least 3 points")
                .at(self.periodic.span, "periodic");
            reader.report(report);
            return false;
        }
        if first.y == last.y {
            return true;
        }
        let message = format!(
            "a periodic function ends at the y where it starts, found {} and {}",
            show_number(first.y),
            show_number(last.y)
        );
        let report = Diagnostic::error(Code::Conflict, message)
            .at(last.span, "another y")
            .also(first.span, "the start")
            .also(self.periodic.span, "periodic");
        reader.report(report);
        false
    }
}

type Written<'a, T> = &'a Option<Sp<SplineEnd<T>>>;

/// A curve without ends has no end conditions, and of three that say two things one is idle.
fn check_ends<T>(
    (ends, start, end): (Written<'_, T>, Written<'_, T>, Written<'_, T>),
    (name, closed): (&str, Sp<bool>),
    reader: &mut Reader<'_>,
) -> bool {
    let named = [("ends", ends), ("start", start), ("end", end)];
    let written = named.iter().find_map(|(name, rule)| rule.as_ref().map(|rule| (*name, rule.span)));
    if let (true, Some((rule, span))) = (closed.value, written) {
        let message = format!("a spline that is {name} has no `{rule}`");
        let report = Diagnostic::error(Code::Conflict, message)
            .at(span, format!("cannot stand beside `{name}`"))
            .also(closed.span, format!("it is {name}"));
        reader.report(report);
        return false;
    }
    if let (Some(ends), Some(start), Some(end)) = (ends, start, end) {
        let report =
            Diagnostic::error(Code::Conflict, "`ends` says nothing where `start` and `end` are written")
                .at(ends.span, "of no effect")
                .also(start.span, "the start")
                .also(end.span, "the end");
        reader.report(report);
        return false;
    }
    true
}

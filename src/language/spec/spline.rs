//! Curves through and near points: natural splines and Bezier curves.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::bspline::check_weights;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::kind::choice;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

table! {
    /// A smooth curve through points: a cubic spline whose curvature is zero at both ends, or periodic when closed.
    "natural-spline" pub NaturalSpline {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// Whether it runs back to the first point, smooth there too.
        closed: Sp<bool> = false;
        /// How the parameter is spread over the points: `"uniform"`, `"chordal"` (by distance), `"centripetal"`
        /// (by the root of the distance: tighter at sharp turns), `"nielsen"` (by distance and turn, unchanged when
        /// the points are stretched), or increasing numbers, one for each point (one more when closed).
        parameters: Sp<Parameters> = Parameters::Chordal;
    }
    checked check
}

/// How the parameter of a spline is spread over its points.
#[derive(Clone, Debug, PartialEq)]
pub enum Parameters {
    /// The same step between all points.
    Uniform,
    /// In proportion to the distance between points.
    Chordal,
    /// In proportion to the square root of the distance.
    Centripetal,
    /// By distances in the norm of the points and by their turns, which affine maps do not change.
    Nielsen,
    /// As written; strictly increasing, one for each point, one more when closed.
    Given(Vec<Sp<f64>>),
}

table! {
    /// Bezier curves joined end to end: each begins at the last point of the one before.
    "bezier" pub Bezier {
        /// End points and the control points between them, in one list: `degree` times the number of pieces, plus 1.
        points: Sp<Vec<Sp<Point>>> => Check::items(2);
        /// Degree of each piece: 3 is cubic.
        degree: Sp<u32> = 3 => Check::within(1.0, 25.0);
        /// A weight for each point, which makes the curve rational: how strongly the point draws it. A point of weight
        /// 0 lies at infinity in the direction that is written; where pieces end weights are greater than 0.
        weights: Option<Sp<Vec<Sp<f64>>>>;
    }
    checked check
}

const RULES: [&str; 4] = ["uniform", "chordal", "centripetal", "nielsen"];

impl Read for Parameters {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Array(_)) {
            return Vec::read(value, reader).map(Self::Given);
        }
        match choice(value, &RULES, reader)? {
            "uniform" => Some(Self::Uniform),
            "centripetal" => Some(Self::Centripetal),
            "nielsen" => Some(Self::Nielsen),
            _ => Some(Self::Chordal),
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&RULES);
        alternatives.push(Vec::<f64>::schema(schemas));
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        match self {
            Self::Uniform => Some(json!("uniform")),
            Self::Chordal => Some(json!("chordal")),
            Self::Centripetal => Some(json!("centripetal")),
            Self::Nielsen => Some(json!("nielsen")),
            Self::Given(numbers) => numbers.written(),
        }
    }
}

impl NaturalSpline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_closed("spline", self.points.len(), self.closed, reader)
            && report_repeated(&self.points, self.closed.value, "points", reader)
            && check_parameters(&self.parameters, self.points.len(), self.closed.value, reader)
    }
}

/// Whether parameters that are written out fit the points and increase.
pub(crate) fn check_parameters(
    parameters: &Sp<Parameters>,
    points: usize,
    closed: bool,
    reader: &mut Reader<'_>,
) -> bool {
    let Parameters::Given(numbers) = &parameters.value else { return true };
    let expected = points + usize::from(closed);
    if numbers.len() != expected {
        let message = format!(
            "a spline through {points} points{} needs {expected} parameters, found {}",
            if closed { " that is closed" } else { "" },
            numbers.len()
        );
        reader.report(Diagnostic::error(Code::WrongCount, message).at(parameters.span, "wrong count"));
        return false;
    }
    check_increasing(numbers, reader)
}

/// Whether a curve through so many points may be closed.
pub(crate) fn check_closed(what: &str, points: usize, closed: Sp<bool>, reader: &mut Reader<'_>) -> bool {
    if !closed.value || points > 2 {
        return true;
    }
    let message = format!("a closed {what} needs at least 3 points, found {points}");
    reader.report(Diagnostic::error(Code::WrongLength, message).at(closed.span, "closed"));
    false
}

fn check_increasing(numbers: &[Sp<f64>], reader: &mut Reader<'_>) -> bool {
    let fault = not_increasing("`parameters`", numbers.iter().map(|number| (number.value, number.span)));
    let good = fault.is_none();
    fault.into_iter().for_each(|report| reader.report(report));
    good
}

/// What is wrong with numbers that have to increase; `what` names them.
pub(crate) fn not_increasing(
    what: &str,
    numbers: impl ExactSizeIterator<Item = (f64, Span)> + DoubleEndedIterator + Clone,
) -> Option<Diagnostic> {
    // Steps that are lost beside the whole would leave no digit of the derivatives.
    const CLOSEST: f64 = 1e-12;
    let span = numbers.clone().next_back()?.0 - numbers.clone().next()?.0;
    let mut pairs = numbers.clone().zip(numbers.skip(1)).enumerate();
    let (index, (before, after)) =
        pairs.find(|(_, (before, after))| after.0 - before.0 <= CLOSEST * span.abs())?;
    let message = format!(
        "{what} must increase, found {} after {} at index {}",
        show_number(after.0),
        show_number(before.0),
        index + 1
    );
    let report = Diagnostic::error(Code::NotIncreasing, message)
        .at(after.1, "not greater than the one before")
        .also(before.1, "the one before");
    Some(report)
}

impl Bezier {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (count, degree) = (self.points.len(), self.degree.value as usize);
        if count % degree != 1 % degree {
            let below = count.saturating_sub(1) / degree * degree + 1;
            let fits =
                if below > 1 { format!("{below} or {}", below + degree) } else { (degree + 1).to_string() };
            let message = format!("a Bezier curve of degree {degree} cannot have {count} points");
            let report = Diagnostic::error(Code::WrongCount, message)
                .at(self.points.span, format!("expected {fits}"))
                .note("each piece adds as many points as its degree to the point where it begins");
            reader.report(report);
            return false;
        }
        self.check_weights(degree, reader) && self.check_pieces(degree, reader)
    }

    fn check_weights(&self, degree: usize, reader: &mut Reader<'_>) -> bool {
        let Some(weights) = &self.weights else { return true };
        if !check_weights(weights, self.points.len(), reader) {
            return false;
        }
        let Some(end) = weights.iter().step_by(degree).find(|weight| weight.value == 0.0) else {
            return true;
        };
        let report = Diagnostic::error(Code::BadWeight, "the weight of a point where a piece ends is 0")
            .at(end.span, "the curve runs to infinity")
            .help("points at infinity stand between the ends of pieces");
        reader.report(report);
        false
    }

    fn check_pieces(&self, degree: usize, reader: &mut Reader<'_>) -> bool {
        let pieces =
            (0..self.points.len() - 1).step_by(degree).map(|at| (at, &self.points[at..=at + degree]));
        let mut good = true;
        for (at, piece) in pieces {
            if piece.iter().all(|point| point.position == piece[0].position) {
                let message = format!("points {at} to {} of this Bezier curve are all equal", at + degree);
                reader.report(Diagnostic::error(Code::RepeatedPoints, message).at(piece[1].span, "no curve"));
                good = false;
            }
        }
        good
    }
}

/// Whether all consecutive points differ, last and first too when `closed`; reports those that do not.
pub(crate) fn report_repeated(
    points: &[Sp<Point>],
    closed: bool,
    field: &str,
    reader: &mut Reader<'_>,
) -> bool {
    let count = points.len();
    let steps = if closed && count > 1 { count } else { count.saturating_sub(1) };
    let mut good = true;
    for index in 0..steps {
        let next = (index + 1) % count;
        if points[index].position == points[next].position {
            reader.report(repeated(points, index, next, field));
            good = false;
        }
    }
    good
}

fn repeated(points: &[Sp<Point>], index: usize, next: usize, field: &str) -> Diagnostic {
    let message = format!("`{field}[{index}]` and `{field}[{next}]` are the same point");
    let report = Diagnostic::error(Code::RepeatedPoints, message);
    if next == 0 {
        return report
            .at(points[index].span, "equal to the first point")
            .also(points[0].span, "the first point")
            .help("leave the last point out: a closed curve leads back by itself");
    }
    report
        .at(points[next].span, "equal to the point before")
        .also(points[index].span, "the point before")
        .help("leave one of them out")
}

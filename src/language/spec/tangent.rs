//! Curves through points by their derivatives: given ones, or found from the neighbours.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::bspline::check_weights;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of, one_of_words, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::{Parameters, check_closed, check_parameters, report_repeated};
use crate::language::value::{Data, Value};

table! {
    /// A curve through points with given derivatives: cubic Hermite pieces (Ferguson's curve). Its direction and speed
    /// are continuous.
    "hermite" pub Hermite {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// The derivative by the parameter at each point: its direction is that of the curve, its length the speed.
        tangents: Sp<Vec<Sp<Point>>>;
        /// Whether it runs back to the first point.
        closed: Sp<bool> = false;
        /// How the parameter is spread over the points: as of a `natural-spline`.
        parameters: Sp<Parameters> = Parameters::Uniform;
        /// A weight greater than 0 for each point, which makes the curve rational: it still takes the points and
        /// tangents, but between them it is drawn towards the heavier end.
        weights: Option<Sp<Vec<Sp<f64>>>> => Check::above(0.0);
        /// The derivative of the weight at each point; 0 when they are not written.
        weight_rates: Option<Sp<Vec<Sp<f64>>>>;
    }
    checked check
}

table! {
    /// A cardinal spline: a curve through points whose derivative at each is a share of the way between its
    /// neighbours.
    "cardinal" pub Cardinal {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// How tightly it runs: 0 is the uniform Catmull-Rom spline, 1 the straight polygon, less than 0 swings out.
        tension: Option<Sp<f64>> => Check::within(-10.0, 1.0);
        /// The share itself, (1 - `tension`) / 2; 0.5 is the uniform Catmull-Rom spline.
        scale: Option<Sp<f64>> => Check::within(0.0, 5.5);
        /// Whether it runs back to the first point.
        closed: Sp<bool> = false;
        /// How an open curve begins and ends.
        ends: Sp<EndRule> = EndRule::Natural;
    }
    checked check
}

table! {
    /// A Catmull-Rom spline: a smooth curve through points, each piece of which depends on the four points near it.
    "catmull-rom" pub CatmullRom {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// How the parameter grows with the distance of the points: its power, from 0 to 1, or `"uniform"` (0),
        /// `"centripetal"` (0.5: no loops or cusps between two points), `"chordal"` (1).
        alpha: Sp<ChordPower> = ChordPower(0.5);
        /// Whether it runs back to the first point.
        closed: Sp<bool> = false;
        /// How an open curve begins and ends.
        ends: Sp<EndRule> = EndRule::Natural;
    }
    checked check
}

table! {
    /// A Kochanek-Bartels spline: a Catmull-Rom spline whose swing can be shaped, as a whole or at each point.
    "kochanek-bartels" pub KochanekBartels {
        /// The points that it goes through, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// Shortens the derivatives: 1 stops at the point, -1 doubles the swing. A number, or one for each point.
        tension: Sp<PerPoint> = PerPoint::All(0.0) => Check::within(-1.0, 1.0);
        /// Makes corners: 0 is smooth, towards -1 the polygon, towards 1 buckling outward. A number, or one for each
        /// point.
        continuity: Sp<PerPoint> = PerPoint::All(0.0) => Check::within(-1.0, 1.0);
        /// Leans the curve at the point: above 0 it overshoots, below 0 it turns early. A number, or one for each
        /// point.
        bias: Sp<PerPoint> = PerPoint::All(0.0) => Check::within(-1.0, 1.0);
        /// How the parameter is spread over the points: as of a `natural-spline`.
        parameters: Sp<Parameters> = Parameters::Uniform;
        /// Whether it runs back to the first point.
        closed: Sp<bool> = false;
        /// How an open curve begins and ends.
        ends: Sp<EndRule> = EndRule::Natural;
    }
    checked check
}

choices! {
    /// How an open curve through points begins and ends.
    EndRule {
        /// Its second derivative is 0 there: it runs out evenly.
        Natural = "natural";
        /// Its first and last piece are parabolas.
        Quadratic = "quadratic";
        /// As if the polygon went straight on.
        Reflect = "reflect";
        /// As if the first and last point stood twice.
        Duplicate = "duplicate";
        /// The first and last point only guide: it runs from the second point to the last but one.
        Guides = "guides";
    }
}

/// The power with which the parameter grows with the distance of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordPower(pub f64);

/// A number for all points or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum PerPoint {
    /// The same for all.
    All(f64),
    /// One for each, in order.
    Each(Vec<Sp<f64>>),
}

impl PerPoint {
    /// The number of one point.
    #[must_use]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::All(number) => *number,
            Self::Each(numbers) => numbers.get(index).map_or(0.0, |number| number.value),
        }
    }
}

const ALPHAS: [(&str, f64); 3] = [("uniform", 0.0), ("centripetal", 0.5), ("chordal", 1.0)];

impl Read for ChordPower {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if value.number().is_some() {
            let read = finite(value, reader).filter(|_| Check::within(0.0, 1.0).apply(value, reader));
            return read.map(Self);
        }
        let word = choice(value, &ALPHAS.map(|(word, _)| word), reader)?;
        ALPHAS.iter().find(|(known, _)| *known == word).map(|(_, alpha)| Self(*alpha))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&ALPHAS.map(|(word, _)| word));
        alternatives.push(json!({ "type": "number", "minimum": 0, "maximum": 1 }));
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        let word = ALPHAS.iter().find(|(_, alpha)| *alpha == self.0);
        Some(word.map_or_else(|| json!(self.0), |(word, _)| json!(word)))
    }
}

impl Read for PerPoint {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Array(_)) {
            return Vec::read(value, reader).map(Self::Each);
        }
        finite(value, reader).map(Self::All)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![or_expression("number"), Vec::<f64>::schema(schemas)])
    }

    fn written(&self) -> Option<Json> {
        match self {
            Self::All(number) => Some(json!(number)),
            Self::Each(numbers) => numbers.written(),
        }
    }
}

impl Hermite {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let count = self.points.len();
        check_closed("Hermite curve", count, self.closed, reader)
            && check_each("tangents", &self.tangents, count, reader)
            && self.check_tangents(reader)
            && self.check_weights(reader)
            && check_parameters(&self.parameters, count, self.closed.value, reader)
            && (self.parameters.value == Parameters::Uniform
                || report_repeated(&self.points, self.closed.value, "points", reader))
    }

    fn check_tangents(&self, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (index, tangent) in self.tangents.iter().enumerate() {
            if tangent.position == glam::DVec3::ZERO {
                let message = format!(
                    "`tangents[{index}]` has no length: the curve would stop there without a direction"
                );
                let report = Diagnostic::error(Code::ZeroTangent, message)
                    .at(tangent.span, "no direction")
                    .help("write a short tangent for a sharp turn");
                reader.report(report);
                good = false;
            }
        }
        good
    }

    fn check_weights(&self, reader: &mut Reader<'_>) -> bool {
        let count = self.points.len();
        match (&self.weights, &self.weight_rates) {
            (None, Some(rates)) => {
                let report = Diagnostic::error(Code::MissingField, "`weight-rates` without `weights`")
                    .at(rates.span, "rates of what?");
                reader.report(report);
                false
            }
            (Some(weights), rates) => {
                check_weights(weights, count, reader)
                    && rates.as_ref().is_none_or(|rates| check_each("weight-rates", rates, count, reader))
            }
            (None, None) => true,
        }
    }
}

impl Cardinal {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if let (Some(tension), Some(scale)) = (&self.tension, &self.scale) {
            let report = Diagnostic::error(
                Code::Conflict,
                "`tension` and `scale` say the same: one of them is enough",
            )
            .at(scale.span, "cannot stand beside `tension`")
            .also(tension.span, "the tension");
            reader.report(report);
            return false;
        }
        check_through("cardinal spline", (&self.points, self.closed, self.ends), reader)
    }

    /// The share of the way between neighbours that is the derivative.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.scale
            .map_or(0.5 * (1.0 - self.tension.map_or(0.0, |tension| tension.value)), |scale| scale.value)
    }
}

impl CatmullRom {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_through("Catmull-Rom spline", (&self.points, self.closed, self.ends), reader)
    }
}

impl KochanekBartels {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let shapes = [("tension", &self.tension), ("continuity", &self.continuity), ("bias", &self.bias)];
        let count = self.points.len();
        for (name, numbers) in shapes {
            if let PerPoint::Each(list) = &numbers.value
                && list.len() != count
            {
                report_count(name, count, list.len(), numbers.span, reader);
                return false;
            }
        }
        check_through("Kochanek-Bartels spline", (&self.points, self.closed, self.ends), reader)
            && check_parameters(&self.parameters, count, self.closed.value, reader)
    }
}

fn check_each<T>(name: &str, items: &Sp<Vec<T>>, count: usize, reader: &mut Reader<'_>) -> bool {
    if items.len() == count {
        return true;
    }
    report_count(name, count, items.len(), items.span, reader);
    false
}

fn report_count(name: &str, expected: usize, found: usize, span: Span, reader: &mut Reader<'_>) {
    let message = format!("`{name}` has one item for each of the {expected} points, found {found}");
    reader.report(Diagnostic::error(Code::WrongCount, message).at(span, format!("expected {expected}")));
}

fn check_through(
    what: &str,
    (points, closed, ends): (&[Sp<Point>], Sp<bool>, Sp<EndRule>),
    reader: &mut Reader<'_>,
) -> bool {
    if closed.value && !ends.span.is_none() {
        let report = Diagnostic::error(Code::Conflict, format!("a closed {what} has no `ends`"))
            .at(ends.span, "cannot stand beside `closed`")
            .also(closed.span, "closed");
        reader.report(report);
        return false;
    }
    if ends.value == EndRule::Guides && points.len() < 4 {
        let message = format!("a {what} between guides needs at least 4 points, found {}", points.len());
        let report = Diagnostic::error(Code::FewPoints, message)
            .at(ends.span, "the first and the last point are not on the curve")
            .help("write `ends = \"natural\"`, or more points");
        reader.report(report);
        return false;
    }
    check_closed(what, points.len(), closed, reader)
        && report_repeated(points, closed.value, "points", reader)
}

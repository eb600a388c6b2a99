//! How the size of a section changes along its way.

use glam::DVec2;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::point::read_numbers;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::{Schemas, any_of, array, numbers, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// Factors of size along a way.
#[derive(Clone, Debug, PartialEq)]
pub enum Scaling {
    /// From 1 at the start to this at the end.
    End(f64),
    /// At places of the way, in order.
    Stations(Vec<ScaleStation>),
    /// A curve: x is the share of the way, y the factor.
    Curve(CurveReference),
}

table! {
    /// A factor of size at one place of the way.
    "scale station" pub ScaleStation {
        /// Where it is: 0 at the start, 1 at the end, by length.
        at: Sp<f64> => Check::within(0.0, 1.0);
        /// How large the section is there: a factor, or one for x and one for y.
        factor: Sp<Factor> => Check::at_least(0.0);
    }
    checked check
}

/// A factor for both axes of a section, or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor(pub DVec2);

choices! {
    /// How a section changes from one station to the next.
    Blend {
        /// Evenly, with an edge at each station.
        Linear = "linear";
        /// By a smooth curve through all stations.
        Smooth = "smooth";
    }
}

impl ScaleStation {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        keeps_width(&self.factor, reader)
    }
}

/// Whether a factor leaves a section its area, or makes it a point; reports one that makes it a line.
pub(crate) fn keeps_width(factor: &Sp<Factor>, reader: &mut Reader<'_>) -> bool {
    let Factor(both) = factor.value;
    if (both.x == 0.0) == (both.y == 0.0) {
        return true;
    }
    let message = "a factor of 0 for one axis alone would flatten the section to a line";
    let report = Diagnostic::error(Code::OutOfRange, message)
        .at(factor.span, "one axis")
        .help("write 0 for both, which makes a point, or a small factor instead of 0");
    reader.report(report);
    false
}

impl Read for Factor {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if value.number().is_some() {
            return finite(value, reader).map(|factor| Self(DVec2::splat(factor)));
        }
        let factors = read_numbers(value, 2, 2, "a number or two [x, y]", reader)?;
        Some(Self(DVec2::new(factors[0], factors[1])))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut schema = numbers(2, 2);
        schema["type"] = json!(["number", "array", "object", "string"]);
        schema
    }
}

impl Read for Scaling {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(_) | Data::Table(_) => CurveReference::read(value, reader).map(Self::Curve),
            Data::Array(items) => stations(items, value, reader).map(Self::Stations),
            _ if value.number().is_some() => {
                let factor = finite(value, reader)?;
                Check::at_least(0.0).apply(value, reader).then_some(Self::End(factor))
            }
            _ => {
                reader.mismatch(value, "a factor, a list of factors, or a curve");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut number = or_expression("number");
        Check::at_least(0.0).constrain(&mut number);
        let item = any_of(vec![number.clone(), ScaleStation::schema(schemas)]);
        any_of(vec![number, array(item), CurveReference::schema(schemas)])
    }
}

/// Factors at even places, or tables that say where.
fn stations(items: &[Value], value: &Value, reader: &mut Reader<'_>) -> Option<Vec<ScaleStation>> {
    if items.len() < 2 {
        let message = format!("{} needs at least 2 factors, found {}", reader.place(), items.len());
        reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "too few"));
        return None;
    }
    let even = items.iter().all(|item| item.number().is_some());
    let last = (items.len() - 1) as f64;
    let mut read = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        read.extend(reader.within_index(index, |reader| {
            if !even {
                return ScaleStation::read(item, reader);
            }
            let factor = Factor::read(item, reader).filter(|_| Check::at_least(0.0).apply(item, reader))?;
            Some(ScaleStation { at: Sp::from(index as f64 / last), factor: Sp::new(factor, item.span) })
        }));
    }
    let whole = read.len() == items.len();
    (whole && increasing(read.iter().map(|station| station.at), reader)).then_some(read)
}

/// Whether places of stations increase; reports the first that does not.
pub(crate) fn increasing(places: impl Iterator<Item = Sp<f64>>, reader: &mut Reader<'_>) -> bool {
    let places: Vec<Sp<f64>> = places.collect();
    let Some(index) = places.windows(2).position(|pair| pair[1].value <= pair[0].value) else { return true };
    let (before, after) = (&places[index], &places[index + 1]);
    let message = format!(
        "stations must increase, found `at = {}` after `at = {}`",
        crate::language::value::show_number(after.value),
        crate::language::value::show_number(before.value)
    );
    let report = Diagnostic::error(Code::NotIncreasing, message)
        .at(after.span, "not greater than the one before")
        .also(before.span, "the one before");
    reader.report(report);
    false
}

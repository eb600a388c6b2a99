//! Assertions: what must hold of the result.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Table, Value};

/// What must hold of one number, word or truth of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct Assertion {
    /// Its path in the report: `shapes.vase.triangles`.
    pub path: Sp<String>,
    /// What must hold.
    pub demand: Demand,
    /// Where the assertion is written.
    pub span: Span,
}

/// What an assertion demands.
#[derive(Clone, Debug, PartialEq)]
pub enum Demand {
    /// Exactly this.
    Equals(Expected),
    /// A number within bounds; at least one of the fields is written.
    Bounds {
        /// The greatest that is allowed.
        at_most: Option<f64>,
        /// The least that is allowed.
        at_least: Option<f64>,
        /// The number that it must be, give or take `tolerance`.
        equals: Option<f64>,
        /// How far it may be from `equals`; 0 when it is not written.
        tolerance: f64,
    },
}

/// A value of the report.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// A number.
    Number(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// A word.
    Text(String),
}

table! {
    /// Bounds on a number of the report.
    "bounds" pub(crate) BoundFields {
        /// The greatest that is allowed.
        at_most: Option<Sp<f64>>;
        /// The least that is allowed.
        at_least: Option<Sp<f64>>;
        /// The number that it must be, give or take `tolerance`.
        equals: Option<Sp<f64>>;
        /// How far it may be from `equals`.
        tolerance: Option<Sp<f64>> => Check::at_least(0.0);
    }
    checked check
}

/// The keys that make a table bounds rather than a part of a path.
const BOUNDS: [&str; 4] = ["at-most", "at-least", "equals", "tolerance"];

impl BoundFields {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let bounded = self.at_most.is_some() || self.at_least.is_some() || self.equals.is_some();
        if !bounded {
            let message = "an assertion needs `at-most`, `at-least` or `equals`";
            reader.report(Diagnostic::error(Code::MissingField, message).at(span, "demands nothing"));
        } else if let (Some(tolerance), None) = (&self.tolerance, &self.equals) {
            let report = Diagnostic::error(Code::MissingField, "`tolerance` needs `equals`");
            reader.report(report.at(tolerance.span, "has no effect"));
            return false;
        }
        bounded && self.check_order(reader)
    }

    fn check_order(&self, reader: &mut Reader<'_>) -> bool {
        let (Some(least), Some(most)) = (&self.at_least, &self.at_most) else { return true };
        if least.value <= most.value {
            return true;
        }
        let report = Diagnostic::error(Code::OutOfRange, "`at-least` is greater than `at-most`")
            .at(least.span, "never holds")
            .also(most.span, "the greatest that is allowed");
        reader.report(report);
        false
    }
}

/// Reads the `[assert]` table. A dotted key and a quoted one with dots mean the same path.
pub(crate) fn read_assertions(value: &Value, reader: &mut Reader<'_>) -> Vec<Assertion> {
    let Data::Table(table) = &value.data else {
        reader.within("assert", |reader| reader.mismatch(value, "a table"));
        return Vec::new();
    };
    let mut assertions = Vec::new();
    collect("", table, reader, &mut assertions);
    assertions
}

fn collect(prefix: &str, table: &Table, reader: &mut Reader<'_>, assertions: &mut Vec<Assertion>) {
    for (name, entry) in &table.entries {
        let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        match &entry.value.data {
            Data::Table(inner) if !is_bounds(inner) => collect(&path, inner, reader, assertions),
            _ => {
                let demand = reader.within(&path, |reader| read_demand(&entry.value, reader));
                let span = entry.key.to(entry.value.span);
                let path = Sp::new(path, entry.key);
                assertions.extend(demand.map(|demand| Assertion { path, demand, span }));
            }
        }
    }
}

fn is_bounds(table: &Table) -> bool {
    table.entries.is_empty()
        || table.entries.iter().any(|(name, entry)| {
            BOUNDS.contains(&name.as_str())
                || !matches!(entry.value.data, Data::Table(_)) && name.starts_with("at-")
        })
}

fn read_demand(value: &Value, reader: &mut Reader<'_>) -> Option<Demand> {
    match &value.data {
        Data::Boolean(truth) => Some(Demand::Equals(Expected::Boolean(*truth))),
        Data::String(text) => Some(Demand::Equals(Expected::Text(text.clone()))),
        Data::Integer(_) | Data::Float(_) => {
            finite(value, reader).map(|number| Demand::Equals(Expected::Number(number)))
        }
        Data::Table(_) => BoundFields::read(value, reader).map(|fields| Demand::Bounds {
            at_most: fields.at_most.map(|bound| bound.value),
            at_least: fields.at_least.map(|bound| bound.value),
            equals: fields.equals.map(|bound| bound.value),
            tolerance: fields.tolerance.map_or(0.0, |bound| bound.value),
        }),
        _ => {
            reader.mismatch(value, "a number, true, false, a string, or bounds");
            None
        }
    }
}

/// The schema of the `[assert]` table: its keys are paths of the report, which no schema can list.
pub(crate) fn schema(schemas: &mut Schemas) -> Json {
    BoundFields::schema(schemas);
    json!({
        "description": "What must hold of the result: keys are paths of the report, values what must stand there.",
        "type": "object",
        "additionalProperties": { "type": ["number", "boolean", "string", "object"] },
    })
}

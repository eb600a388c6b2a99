//! Formulas: expressions of variables, and the curves that they give.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::expression;
use crate::language::source::Span;
use crate::language::spec::construct::table;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

/// A formula, or a number where it does not vary.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// Always this number.
    Number(f64),
    /// An expression of variables.
    Varying(expression::Formula),
}

impl Read for Formula {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::Formula(formula) => Some(Self::Varying(formula.clone())),
            Data::Integer(_) | Data::Float(_) => finite(value, reader).map(Self::Number),
            Data::String(text) if !text.starts_with('=') => {
                let message = format!("{} must be a formula, found {}", reader.place(), value.describe());
                let report = Diagnostic::error(Code::WrongType, message)
                    .at(value.span, "no formula")
                    .help("a formula begins with an equals sign and a space: \"= ...\"")
                    .suggest(value.span, format!("\"= {text}\""), "put them before it");
                reader.report(report);
                None
            }
            _ => {
                reader.mismatch(value, "a formula");
                None
            }
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": ["number", "string"], "pattern": "^= " })
    }

    fn written(&self) -> Option<Json> {
        match self {
            Self::Number(number) => Some(json!(number)),
            Self::Varying(_) => None,
        }
    }
}

table! {
    /// A curve by formulas: `y` of the variable x (a graph), `x` of the variable y (a graph lying on its side, such
    /// as the radius of a turned shape), `x` and `y` of the variable t, or the distance `r` from the origin of the
    /// angle t. Angles are in degrees. Kinks become corners; where a formula has no value, jumps or stands still,
    /// that is an error.
    "formula" pub FormulaCurve {
        /// The x coordinate.
        x: Option<Sp<Formula>>;
        /// The y coordinate.
        y: Option<Sp<Formula>>;
        /// The z coordinate; 0 when it is not written.
        z: Option<Sp<Formula>>;
        /// The distance from the origin in the direction of the angle t, in place of `x` and `y`.
        r: Option<Sp<Formula>>;
        /// The first value of the variable.
        from: Sp<f64>;
        /// The last value of the variable, greater than the first.
        to: Sp<f64>;
    }
    checked check
}

/// Which coordinates of a formula curve are written, and so what its variable is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulaForm {
    /// y of x.
    Graph,
    /// x of y.
    SideGraph,
    /// x and y of t.
    Parametric,
    /// r of t.
    Polar,
}

impl FormulaForm {
    /// The name of the variable.
    #[must_use]
    pub const fn variable(self) -> &'static str {
        match self {
            Self::Graph => "x",
            Self::SideGraph => "y",
            Self::Parametric | Self::Polar => "t",
        }
    }
}

impl FormulaCurve {
    /// What is written; none when that is no curve.
    #[must_use]
    pub fn form(&self) -> Option<FormulaForm> {
        match (self.x.is_some(), self.y.is_some(), self.r.is_some()) {
            (false, true, false) => Some(FormulaForm::Graph),
            (true, false, false) => Some(FormulaForm::SideGraph),
            (true, true, false) => Some(FormulaForm::Parametric),
            (false, false, true) => Some(FormulaForm::Polar),
            _ => None,
        }
    }

    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let formed = self.form().is_some() || self.refuse_form(table, reader);
        if self.from.value < self.to.value {
            return formed;
        }
        let (from, to) = (show_number(self.from.value), show_number(self.to.value));
        let message = format!("`to` must be greater than `from`, found {to} after {from}");
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(self.to.span, "not greater")
            .also(self.from.span, "the start")
            .help("to run the other way, put the formula into `{ reverse = { of = ... } }`");
        reader.report(report);
        false
    }

    fn refuse_form(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let other = self.x.as_ref().or(self.y.as_ref());
        let report = match (&self.r, other) {
            (Some(r), Some(other)) => {
                let message = "a formula curve has either `r`, or `x` and `y`";
                Diagnostic::error(Code::Conflict, message)
                    .at(other.span, "cannot stand beside `r`")
                    .also(r.span, "the distance from the origin")
            }
            _ => Diagnostic::error(Code::MissingField, "missing `x`, `y` or `r` of formula")
                .at(table, "no curve in the plane")
                .help("write `y = \"= ...\"` with x in it, `x` and `y` with t in them, or `r` with t in it"),
        };
        reader.report(report);
        false
    }
}

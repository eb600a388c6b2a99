//! What a field demands of its numbers: one declaration for the check, the schema and the reference.

use serde_json::{Map, Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::reader::Reader;
use crate::language::value::{Data, Value, show_number};

/// Bounds on the numbers of a field and on how many items its array has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Check {
    above: Option<f64>,
    least: Option<f64>,
    most: Option<f64>,
    zero: bool,
    fewest: usize,
}

impl Check {
    /// Demands nothing.
    pub(crate) const ANY: Self = Self { above: None, least: None, most: None, zero: true, fewest: 0 };

    /// Numbers greater than `bound`.
    pub(crate) const fn above(bound: f64) -> Self {
        Self { above: Some(bound), ..Self::ANY }
    }

    /// Numbers of at least `bound`.
    pub(crate) const fn at_least(bound: f64) -> Self {
        Self { least: Some(bound), ..Self::ANY }
    }

    /// Numbers from `least` to `most`, both included.
    pub(crate) const fn within(least: f64, most: f64) -> Self {
        Self { least: Some(least), most: Some(most), ..Self::ANY }
    }

    /// Numbers other than zero.
    pub(crate) const fn nonzero() -> Self {
        Self { zero: false, ..Self::ANY }
    }

    /// An array of at least `fewest` items.
    pub(crate) const fn items(fewest: usize) -> Self {
        Self { fewest, ..Self::ANY }
    }

    /// The same, and no number greater than `most`.
    pub(crate) const fn up_to(self, most: f64) -> Self {
        Self { most: Some(most), ..self }
    }

    /// The same, and no zero.
    pub(crate) const fn other_than_zero(self) -> Self {
        Self { zero: false, ..self }
    }

    /// Reports every number of `value` that is out of bounds. Numbers that are not finite are left to the reader.
    pub(crate) fn apply(&self, value: &Value, reader: &mut Reader<'_>) -> bool {
        let counted = self.count(value, reader);
        let bounded = self.above.is_some() || self.least.is_some() || self.most.is_some() || !self.zero;
        counted && (!bounded || self.numbers(value, reader))
    }

    fn count(&self, value: &Value, reader: &mut Reader<'_>) -> bool {
        let Data::Array(items) = &value.data else { return true };
        if items.len() >= self.fewest {
            return true;
        }
        let message = format!(
            "{} needs at least {} {}, found {}",
            reader.place(),
            self.fewest,
            if self.fewest == 1 { "item" } else { "items" },
            items.len()
        );
        reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "too few"));
        false
    }

    fn numbers(&self, value: &Value, reader: &mut Reader<'_>) -> bool {
        if let Data::Array(items) = &value.data {
            let mut good = true;
            for (index, item) in items.iter().enumerate() {
                good &= reader.within_index(index, |reader| self.numbers(item, reader));
            }
            return good;
        }
        match value.number() {
            Some(number) if number.is_finite() && !self.allows(number) => {
                self.refuse(value, number, reader);
                false
            }
            _ => true,
        }
    }

    fn allows(&self, number: f64) -> bool {
        self.above.is_none_or(|bound| number > bound)
            && self.least.is_none_or(|bound| number >= bound)
            && self.most.is_none_or(|bound| number <= bound)
            && (self.zero || number != 0.0)
    }

    fn refuse(&self, value: &Value, number: f64, reader: &mut Reader<'_>) {
        let demand = self.demand();
        let message = format!("{} must be {demand}, found {}", reader.place(), show_number(number));
        reader.report(Diagnostic::error(Code::OutOfRange, message).at(value.span, format!("not {demand}")));
    }

    /// The demand on each number in words.
    pub(crate) fn demand(&self) -> String {
        let show = show_number;
        let bounds = self.bounds(show);
        match (bounds, self.zero) {
            (Some(bounds), true) => bounds,
            (Some(bounds), false) => format!("{bounds} and not 0"),
            (None, _) => "other than 0".to_owned(),
        }
    }

    fn bounds(&self, show: fn(f64) -> String) -> Option<String> {
        Some(match (self.above, self.least, self.most) {
            (Some(low), _, Some(high)) => format!("greater than {} and at most {}", show(low), show(high)),
            (Some(low), _, None) => format!("greater than {}", show(low)),
            (None, Some(low), Some(high)) => format!("from {} to {}", show(low), show(high)),
            (None, Some(low), None) => format!("at least {}", show(low)),
            (None, None, Some(high)) => format!("at most {}", show(high)),
            (None, None, None) => return None,
        })
    }

    /// Writes the demand into the schema of a field: on the value and, for arrays, on its items.
    pub(crate) fn constrain(&self, schema: &mut Json) {
        let Some(object) = schema.as_object_mut() else { return };
        if self.fewest > 0 {
            object.insert("minItems".to_owned(), json!(self.fewest));
        }
        self.constrain_numbers(object);
    }

    fn constrain_numbers(&self, object: &mut Map<String, Json>) {
        if let Some(Json::Object(items)) = object.get_mut("items") {
            self.constrain_numbers(items);
        }
        let takes = |name: &str| object.get("type").is_some_and(|kinds| mentions(kinds, name));
        if !takes("number") && !takes("integer") {
            return;
        }
        let bounds = [("exclusiveMinimum", self.above), ("minimum", self.least), ("maximum", self.most)];
        for (name, bound) in bounds {
            if let Some(bound) = bound {
                object.insert(name.to_owned(), json!(bound));
            }
        }
        if !self.zero {
            object.insert("not".to_owned(), json!({ "const": 0 }));
        }
    }
}

fn mentions(kinds: &Json, name: &str) -> bool {
    kinds.as_str() == Some(name) || kinds.as_array().is_some_and(|list| list.iter().any(|kind| kind == name))
}

//! The value tree: what a document says, before anything is known of its meaning.

mod describe;
mod parse;
mod scan;

pub use describe::{quote, show_number};
pub use parse::parse;

use indexmap::IndexMap;

use crate::language::expression::Formula;
use crate::language::source::Span;

/// One value of a document and the place that wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// The text of the value; of a table under a header, the header.
    pub span: Span,
    /// What it is.
    pub data: Data,
}

/// The kinds of values.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// A whole number.
    Integer(i64),
    /// A number; may be infinite or NaN.
    Float(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// Text; an expression when it begins with `= `.
    String(String),
    /// A date or a time, as written. No field of Kiln takes one.
    Datetime(String),
    /// `[...]`, or the tables under `[[...]]` headers.
    Array(Vec<Value>),
    /// An expression with variables, where a formula may stand.
    Formula(Formula),
    /// `{...}` or what stands under a header.
    Table(Table),
    /// Something that was already reported; reading it fails silently.
    Broken,
}

/// A table: entries in the order of the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The entries by name.
    pub entries: IndexMap<String, Entry>,
}

/// An entry of a [`Table`].
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Where the name is written.
    pub key: Span,
    /// What it names.
    pub value: Value,
}

impl Value {
    /// A value with the place that wrote it.
    #[must_use]
    pub fn new(span: Span, data: Data) -> Self {
        Self { span, data }
    }

    /// The number, where it is one.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self.data {
            #[expect(
                clippy::cast_precision_loss,
                reason = "numbers beyond 2^53 are refused when they are read"
            )]
            Data::Integer(number) => Some(number as f64),
            Data::Float(number) => Some(number),
            Data::Formula(ref formula) => formula.value(),
            _ => None,
        }
    }

    /// The table, where it is one.
    #[must_use]
    pub fn table(&self) -> Option<&Table> {
        match &self.data {
            Data::Table(table) => Some(table),
            _ => None,
        }
    }
}

impl Table {
    /// The value under a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.entries.get(name).map(|entry| &entry.value)
    }
}

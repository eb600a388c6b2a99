//! Expressions: strings that begin with `= ` compute a value from parameters.
//!
//! A name is the longest `[a-z][a-z0-9-]*`, so `+` and `-` between operands need spaces on both sides.
//! Angles are in degrees. Nothing here depends on the machine: transcendental functions come from
//! [`geometry::number`](crate::geometry::number). Where a formula is asked for, an expression has variables
//! beside the parameters and is kept as a tree.

mod evaluate;
mod fault;
mod formula;
mod function;
mod parse;
mod token;

pub use evaluate::{Evaluator, Scope};
pub use fault::Fault;
pub use formula::{ATTRIBUTE_VARIABLES, Formula, SURFACE_VARIABLES, VARIABLES};
pub use function::{FUNCTIONS, Function};
pub use parse::{Expression, parse};

pub(crate) use function::Call;
pub(crate) use parse::{Binary, Node};

/// What an expression computes.
#[derive(Clone, Debug, PartialEq)]
pub enum Computed {
    /// A number, finite.
    Number(f64),
    /// `true` or `false`.
    Boolean(bool),
    /// Text.
    Text(String),
    /// A point or another list.
    List(Vec<Self>),
}

impl Computed {
    /// The type in words.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Boolean(_) => "true or false",
            Self::Text(_) => "a string",
            Self::List(_) => "a list",
        }
    }
}

/// The text of an expression, when a string is one: what follows `= `.
#[must_use]
pub fn body(text: &str) -> Option<&str> {
    text.strip_prefix("= ")
}

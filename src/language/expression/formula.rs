//! Expressions of variables: formulas, which are computed for many values instead of once.

use std::ops::Range;
use std::sync::Arc;

use crate::language::expression::fault::Fault;
use crate::language::expression::parse::{Expression, Node};
use crate::language::expression::{Computed, Scope};
use crate::language::source::Span;

/// The names that can be variables of a formula. Where a formula stands they hide parameters of the same name.
pub const VARIABLES: &[&str] = &["t", "u", "v", "x", "y", "z"];

/// Those of a formula over the places of a surface and its normals there.
pub const SURFACE_VARIABLES: &[&str] = &["t", "u", "v", "x", "y", "z", "nx", "ny", "nz"];

/// Those of an attribute of vertices.
pub const ATTRIBUTE_VARIABLES: &[&str] = &["t", "u", "v", "x", "y", "z", "nx", "ny", "nz", "weight"];

/// An expression with variables, its parameters put in.
#[derive(Clone, Debug)]
pub struct Formula {
    tree: Arc<Expression>,
    /// The string that it was read from, `= ` included.
    text: Arc<str>,
    span: Span,
    /// Where the text begins in the span, if escapes do not hide it.
    offset: Option<u32>,
    /// Its value when parameters have the names of all its variables, for a field that takes a number.
    value: Option<f64>,
    /// The names that can be variables.
    known: &'static [&'static str],
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && format!("{:?}", self.tree) == format!("{:?}", other.tree)
    }
}

impl Formula {
    /// A formula of a tree in which only variables, some of `known`, are names.
    pub(crate) fn new(
        tree: Expression,
        text: &str,
        (span, offset): (Span, Option<u32>),
        known: &'static [&'static str],
    ) -> Self {
        Self { tree: Arc::new(tree), text: Arc::from(text), span, offset, value: None, known }
    }

    /// The same, with the value that it has as an expression of parameters.
    pub(crate) fn with_value(self, value: Option<Computed>) -> Self {
        let value = match value {
            Some(Computed::Number(number)) => Some(number),
            _ => None,
        };
        Self { value, ..self }
    }

    /// Its value when parameters have the names of all its variables.
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        self.value
    }

    /// The tree.
    #[must_use]
    pub fn tree(&self) -> &Expression {
        &self.tree
    }

    /// As it is written, without `= `.
    #[must_use]
    pub fn text(&self) -> &str {
        self.text.strip_prefix("= ").unwrap_or(&self.text)
    }

    /// Where the string is written.
    #[must_use]
    pub fn span(&self) -> Span {
        self.span
    }

    /// Where a part of the expression is written; `false` when that is not known more closely than the string.
    #[must_use]
    pub fn place(&self, range: &Range<usize>) -> (Span, bool) {
        let Some(at) = self.offset else { return (self.span, false) };
        let byte = |byte: usize| at + u32::try_from(self.text.len().min(byte + 2)).unwrap_or(0);
        (Span::new(self.span.start + byte(range.start), self.span.start + byte(range.end)), true)
    }

    /// A part of the expression as it is written.
    #[must_use]
    pub fn part(&self, range: &Range<usize>) -> &str {
        self.text().get(range.clone()).unwrap_or_default()
    }

    /// The variables that it has, in the order of those that it can have.
    #[must_use]
    pub fn variables(&self) -> Vec<&'static str> {
        self.known.iter().copied().filter(|name| self.tree.names(name)).collect()
    }
}

impl Expression {
    /// Whether a name stands in it.
    #[must_use]
    pub(crate) fn names(&self, wanted: &str) -> bool {
        match &self.node {
            Node::Number(_) | Node::Boolean(_) | Node::Text(_) => false,
            Node::Name(name) => name == wanted,
            Node::List(items) | Node::Call(_, items) => items.iter().any(|item| item.names(wanted)),
            Node::Negate(inner) | Node::Not(inner) | Node::Part(inner, _) => inner.names(wanted),
            Node::Binary(_, sides) => sides.iter().any(|side| side.names(wanted)),
        }
    }

    /// The same with the values of a scope in place of all names but variables, which are `known`.
    ///
    /// # Errors
    /// When a name has no value.
    pub(crate) fn resolved(&self, scope: &mut impl Scope, known: &[&str]) -> Result<Self, Fault> {
        scope.step(&self.range)?;
        let one = |inner: &Self, scope: &mut _| inner.resolved(scope, known).map(Box::new);
        let node = match &self.node {
            Node::Name(name) if !known.contains(&name.as_str()) => {
                literal(&scope.look_up(name, self.range.clone())?, &self.range)
            }
            Node::Number(_) | Node::Boolean(_) | Node::Text(_) | Node::Name(_) => self.node.clone(),
            Node::List(items) => Node::List(all(items, scope, known)?),
            Node::Call(function, items) => Node::Call(function, all(items, scope, known)?),
            Node::Negate(inner) => Node::Negate(one(inner, scope)?),
            Node::Not(inner) => Node::Not(one(inner, scope)?),
            Node::Part(inner, index) => Node::Part(one(inner, scope)?, *index),
            Node::Binary(operator, sides) => {
                let sides = [sides[0].resolved(scope, known)?, sides[1].resolved(scope, known)?];
                Node::Binary(*operator, Box::new(sides))
            }
        };
        Ok(Self::new(node, self.range.clone()))
    }
}

fn all(items: &[Expression], scope: &mut impl Scope, known: &[&str]) -> Result<Vec<Expression>, Fault> {
    items.iter().map(|item| item.resolved(scope, known)).collect()
}

/// A value as it would be written.
fn literal(value: &Computed, range: &Range<usize>) -> Node {
    match value {
        Computed::Number(number) => Node::Number(*number),
        Computed::Boolean(truth) => Node::Boolean(*truth),
        Computed::Text(text) => Node::Text(text.clone()),
        Computed::List(items) => {
            let item = |item: &Computed| Expression::new(literal(item, range), range.clone());
            Node::List(items.iter().map(item).collect())
        }
    }
}

//! Parameters: computed by demand, each once.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::expression::{Computed, Evaluator, Expression, Fault, Formula, Scope, body, parse};
use crate::language::source::{SourceMap, Span};
use crate::language::suggest::closest;
use crate::language::value::{Data, Table, Value};

/// The most steps that the expressions of a document take together.
const MOST_STEPS: u64 = 10_000_000;

/// How many parameters may be computed from each other in a row.
const LONGEST_CHAIN: usize = 64;

/// The parameters of a document and what is known of their values.
pub(crate) struct Parameters<'d> {
    sources: &'d SourceMap,
    written: &'d Table,
    values: BTreeMap<String, State>,
    /// The names that expressions used.
    pub(crate) used: BTreeSet<String>,
    /// What `i` is, inside of `{ count, each }`.
    pub(crate) index: Option<f64>,
    /// What was wrong so far.
    pub(crate) found: Vec<Diagnostic>,
    computing: Vec<String>,
    steps: u64,
    most_steps: u64,
}

/// What an expression gives where a formula may stand.
pub(crate) enum FormulaOrValue {
    Formula(Formula),
    Value(Computed),
}

enum State {
    Known(Computed),
    Failed,
}

impl<'d> Parameters<'d> {
    /// The parameters of a `[parameters]` table. At most `steps` steps are taken, if that lowers the limit.
    pub(crate) fn new(written: &'d Table, steps: Option<u64>, sources: &'d SourceMap) -> Self {
        Self {
            sources,
            written,
            values: BTreeMap::new(),
            used: BTreeSet::new(),
            index: None,
            found: Vec::new(),
            computing: Vec::new(),
            steps: 0,
            most_steps: steps.map_or(MOST_STEPS, |steps| steps.min(MOST_STEPS)),
        }
    }

    /// The texts that spans point into.
    pub(crate) fn sources(&self) -> &'d SourceMap {
        self.sources
    }

    /// Sets a parameter to what a person says instead of the document.
    pub(crate) fn set(&mut self, name: &str, value: Computed) {
        self.values.insert(name.to_owned(), State::Known(value));
    }

    /// The value of a parameter; `None` when it has none, which is then reported.
    pub(crate) fn value(&mut self, name: &str) -> Option<Computed> {
        self.compute(name);
        match self.values.get(name) {
            Some(State::Known(value)) => Some(value.clone()),
            _ => None,
        }
    }

    fn compute(&mut self, name: &str) {
        if self.values.contains_key(name) {
            return;
        }
        let Some(value) = self.written.get(name) else { return };
        self.computing.push(name.to_owned());
        // A parameter means the same wherever it is first asked for.
        let index = self.index.take();
        let state = self.read(value, name).map_or(State::Failed, State::Known);
        self.index = index;
        self.computing.pop();
        self.values.insert(name.to_owned(), state);
    }

    fn read(&mut self, value: &Value, name: &str) -> Option<Computed> {
        match &value.data {
            Data::Integer(_) | Data::Float(_) => self.finite(value, name).map(Computed::Number),
            Data::Boolean(truth) => Some(Computed::Boolean(*truth)),
            Data::String(text) => match body(text) {
                Some(_) => self.expression(text, value.span),
                None => Some(Computed::Text(text.clone())),
            },
            Data::Array(items) => {
                let read: Vec<_> = items.iter().map(|item| self.read(item, name)).collect();
                read.into_iter().collect::<Option<Vec<_>>>().map(Computed::List)
            }
            Data::Table(_) | Data::Datetime(_) | Data::Formula(_) => {
                let kinds = "a number, true or false, a point or a string";
                let message = format!("parameter `{name}` must be {kinds}, found {}", value.describe());
                self.found
                    .push(Diagnostic::error(Code::WrongType, message).at(value.span, "not a parameter"));
                None
            }
            Data::Broken => None,
        }
    }

    fn finite(&mut self, value: &Value, name: &str) -> Option<f64> {
        let number = value.number().filter(|number| number.is_finite());
        if number.is_none() {
            let message = format!("parameter `{name}` must be a finite number, found {}", value.describe());
            self.found.push(Diagnostic::error(Code::NotFinite, message).at(value.span, "not finite"));
        }
        number
    }

    /// The value of a string that is an expression; reports why it has none.
    pub(crate) fn expression(&mut self, text: &str, span: Span) -> Option<Computed> {
        let parsed = self.parsed(text, span)?;
        self.evaluate(&parsed, text, span)
    }

    /// The tree of a string that is an expression; reports what cannot be read.
    pub(crate) fn parsed(&mut self, text: &str, span: Span) -> Option<Expression> {
        parse(body(text)?).map_err(|fault| self.report(fault, text, span)).ok()
    }

    /// The value of a tree that was parsed from `text`.
    pub(crate) fn evaluate(&mut self, parsed: &Expression, text: &str, span: Span) -> Option<Computed> {
        Evaluator::new(self).value(parsed).map_err(|fault| self.report(fault, text, span)).ok()
    }

    /// The formula of a string that is an expression of variables, or its value where it has none.
    pub(crate) fn formula(
        &mut self,
        text: &str,
        span: Span,
        variables: &'static [&'static str],
    ) -> Option<FormulaOrValue> {
        let parsed = self.parsed(text, span)?;
        if !variables.iter().any(|name| parsed.names(name)) {
            return self.evaluate(&parsed, text, span).map(FormulaOrValue::Value);
        }
        let resolved =
            parsed.resolved(self, variables).map_err(|fault| self.report(fault, text, span)).ok()?;
        let offset = self.sources.snippet(span).find(text).and_then(|at| u32::try_from(at).ok());
        let formula = Formula::new(resolved, text, (span, offset), variables);
        let named = formula.variables().iter().all(|name| self.written.get(name).is_some());
        let value = if named { Evaluator::new(self).value(&parsed).ok() } else { None };
        Some(FormulaOrValue::Formula(formula.with_value(value)))
    }

    fn report(&mut self, fault: Fault, text: &str, span: Span) {
        if !fault.reported {
            let sources = self.sources;
            self.found.push(fault.diagnostic(|range| place(sources, text, span, &range)));
        }
    }

    fn unknown(&self, name: &str, range: Range<usize>) -> Fault {
        let fault = Fault::new(Code::UnknownVariable, range, format!("there is no parameter `{name}`"));
        let known =
            |part: &str| self.written.get(part).is_some() || part.parse::<f64>().is_ok() || part == "i";
        let cuts = name.match_indices('-').map(|(at, _)| (&name[..at], &name[at + 1..]));
        if let Some((left, right)) = cuts.clone().find(|(left, right)| known(left) && known(right)) {
            return fault
                .label("one name: `-` is part of it")
                .help("a minus needs a space on both sides")
                .replace(format!("{left} - {right}"));
        }
        let fault = match closest(name, self.written.entries.keys().map(String::as_str)) {
            Some(near) => fault.label(format!("did you mean `{near}`?")).replace(near),
            None => fault.label("not defined in [parameters]"),
        };
        if name.contains('-') {
            fault.help("`-` is part of a name; a minus needs a space on both sides")
        } else {
            fault
        }
    }
}

impl Scope for Parameters<'_> {
    fn look_up(&mut self, name: &str, range: Range<usize>) -> Result<Computed, Fault> {
        if name == "i" && self.written.get(name).is_none() {
            let help = "`i` counts the items of `{ count = 3, each = \"= [i, 0]\" }`";
            let none = || {
                Fault::new(Code::UnknownVariable, range, "`i` has a value only inside of `each`").help(help)
            };
            return self.index.map(Computed::Number).ok_or_else(none);
        }
        self.used.insert(name.to_owned());
        if let Some(start) = self.computing.iter().position(|computing| computing == name) {
            let circle = self.computing[start..].join(" -> ");
            let message = format!("`{name}` is computed from itself: {circle} -> {name}");
            return Err(Fault::new(Code::ParameterCycle, range, message).label("closes the circle"));
        }
        if self.written.get(name).is_none() {
            return Err(self.unknown(name, range));
        }
        if self.computing.len() >= LONGEST_CHAIN {
            let message = format!("more than {LONGEST_CHAIN} parameters are computed from each other");
            return Err(Fault::new(Code::ExpressionLimit, range, message));
        }
        let value = self.value(name).ok_or_else(|| Fault::reported(range.clone()))?;
        self.charge(size(&value), &range)?;
        Ok(value)
    }

    fn step(&mut self, range: &Range<usize>) -> Result<(), Fault> {
        self.charge(1, range)
    }
}

impl Parameters<'_> {
    fn charge(&mut self, steps: u64, range: &Range<usize>) -> Result<(), Fault> {
        if self.steps > self.most_steps {
            return Err(Fault::reported(range.clone()));
        }
        self.steps += steps;
        if self.steps <= self.most_steps {
            return Ok(());
        }
        let message = format!("the expressions of this document take more than {} steps", self.most_steps);
        Err(Fault::new(Code::ExpressionLimit, range.clone(), message).label("here it was enough"))
    }
}

/// What copying a value costs, in steps.
fn size(value: &Computed) -> u64 {
    match value {
        Computed::List(items) => 1 + items.iter().map(size).sum::<u64>(),
        Computed::Text(text) => 1 + text.len() as u64 / 32,
        Computed::Number(_) | Computed::Boolean(_) => 1,
    }
}

/// The span of a range of an expression's text. `false` when escapes in the string hide it: then it is the
/// span of the whole string.
fn place(sources: &SourceMap, text: &str, span: Span, range: &Range<usize>) -> (Span, bool) {
    let Some(at) = sources.snippet(span).find(text) else { return (span, false) };
    let offset = |byte: usize| u32::try_from(at + text.len().min(byte + 2)).unwrap_or(0);
    (Span::new(span.start + offset(range.start), span.start + offset(range.end)), true)
}

//! Expressions put into the value tree.

use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::document::parameters::{FormulaOrValue, Parameters};
use crate::language::expression::{
    ATTRIBUTE_VARIABLES, Computed, FUNCTIONS, SURFACE_VARIABLES, VARIABLES, body,
};
use crate::language::source::{SourceMap, Span};
use crate::language::spec::{ParameterValue, Sp, backtick, check_name};
use crate::language::suggest::closest;
use crate::language::value::{Data, Entry, Table, Value};

/// The most items that the generators of a document make together.
const MOST_ITEMS: u64 = 1_000_000;

/// What is said of parameters beside the document's own values.
pub(crate) struct Given<'g> {
    /// Names and texts, as the command line writes them.
    pub(crate) overrides: &'g [(String, String)],
    /// Names and values, as a state of the document has them.
    pub(crate) with: &'g IndexMap<String, Sp<ParameterValue>>,
}

/// Names that a parameter cannot have.
const WORDS: [&str; 7] = ["and", "or", "not", "true", "false", "pi", "i"];

/// Computes the parameters and replaces every expression of a document by its value. What has none becomes
/// [`Data::Broken`] and is reported.
pub(crate) fn evaluate(
    table: &mut Table,
    variants: &Table,
    given: &Given<'_>,
    sources: &SourceMap,
) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let written = take_parameters(table, &mut found);
    let steps = table.get("limits").and_then(Value::table).and_then(|limits| limits.get("steps"));
    let steps = steps.and_then(|steps| match steps.data {
        Data::Integer(steps) => u64::try_from(steps).ok(),
        _ => None,
    });
    let mut parameters = Parameters::new(&written, steps, sources);
    for (name, text) in given.overrides {
        set(name, text, &written, &mut parameters);
    }
    for (name, value) in given.with {
        set_value(name, value, &written, &mut parameters);
    }
    for name in written.entries.keys() {
        parameters.value(name);
    }
    let mut tree = Tree { parameters: &mut parameters, items: 0 };
    for entry in table.entries.values_mut() {
        tree.value(&mut entry.value, Place::TOP);
    }
    found.append(&mut parameters.found);
    if found.is_empty() {
        // An expression that could not be read uses its parameters all the same.
        found.extend(unused(&written, &parameters, variants, given.overrides, sources));
    }
    found
}

fn take_parameters(table: &mut Table, found: &mut Vec<Diagnostic>) -> Table {
    let Some(entry) = table.entries.shift_remove("parameters") else { return Table::default() };
    let Data::Table(written) = entry.value.data else {
        if !matches!(entry.value.data, Data::Broken) {
            let message = format!("`parameters` must be a table, found {}", entry.value.describe());
            found.push(Diagnostic::error(Code::WrongType, message).at(entry.value.span, "expected a table"));
        }
        return Table::default();
    };
    for (name, entry) in &written.entries {
        found.extend(check_name("parameter", name, entry.key));
        if WORDS.contains(&name.as_str()) || FUNCTIONS.iter().any(|function| function.name == name) {
            let message = format!("`{name}` is built in and cannot be a parameter");
            found.push(Diagnostic::error(Code::ReservedName, message).at(entry.key, "choose another name"));
        }
    }
    written
}

/// Sets a parameter from the command line, if it exists and the value is of its type.
fn set(name: &str, text: &str, written: &Table, parameters: &mut Parameters<'_>) {
    let asked = format!("--set {}={}", plain(name), plain(text));
    if written.get(name).is_none() {
        let report =
            Diagnostic::error(Code::BadOverride, format!("there is no parameter {}", backtick(name)));
        let report = report.note(format!("asked for by {asked}"));
        let near = closest(name, written.entries.keys().map(String::as_str));
        parameters.found.push(match near {
            Some(near) => report.help(format!("did you mean `{near}`?")),
            None => report,
        });
        return;
    }
    let mut base = Parameters::new(written, None, parameters.sources());
    // A parameter without a value is reported when the parameters are computed.
    let Some(default) = base.value(name) else { return };
    let value = match (&default, body(text)) {
        (Computed::Text(_), None) => Ok(Computed::Text(text.to_owned())),
        (_, inner) => {
            let before = base.found.len();
            let value = base.expression(&format!("= {}", inner.unwrap_or(text)), Span::NONE);
            value.ok_or_else(|| base.found.split_off(before).pop().map(|one| one.message).unwrap_or_default())
        }
    };
    match value {
        Ok(value) if value.kind() == default.kind() => parameters.set(name, value),
        Ok(value) => {
            let message =
                format!("parameter `{name}` is {}, `{asked}` gives {}", default.kind(), value.kind());
            parameters.found.push(Diagnostic::error(Code::BadOverride, message));
        }
        Err(why) => {
            let report = Diagnostic::error(Code::BadOverride, format!("`{asked}` has no value: {why}"));
            parameters.found.push(report.note(format!("parameter `{name}` is {}", default.kind())));
        }
    }
}

/// Sets a parameter to a value of a state, if it exists and the value is of its type.
fn set_value(name: &str, value: &Sp<ParameterValue>, written: &Table, parameters: &mut Parameters<'_>) {
    if written.get(name).is_none() {
        let report =
            Diagnostic::error(Code::BadOverride, format!("there is no parameter {}", backtick(name)))
                .at(value.span, "not defined in [parameters]");
        let near = closest(name, written.entries.keys().map(String::as_str));
        parameters.found.push(match near {
            Some(near) => report.help(format!("did you mean `{near}`?")),
            None => report,
        });
        return;
    }
    let Some(default) = Parameters::new(written, None, parameters.sources()).value(name) else { return };
    let ParameterValue(given) = &value.value;
    if given.kind() == default.kind() {
        parameters.set(name, given.clone());
        return;
    }
    let message = format!("parameter `{name}` is {}, and here it is {}", default.kind(), given.kind());
    let report = Diagnostic::error(Code::BadOverride, message);
    parameters.found.push(report.at(value.span, format!("expected {}", default.kind())));
}

fn plain(text: &str) -> String {
    let quoted = backtick(text);
    quoted[1..quoted.len() - 1].to_owned()
}

/// Names under which formulas stand.
const TAKES_FORMULAS: [&str; 3] = ["formula", "implicit", "parametric"];

/// The name under which formulas speak of normals too.
const OF_SURFACES: &str = "vertex-color";

/// The name of a table under whose names formulas speak of normals and weights too.
const OF_ATTRIBUTES: &str = "attributes";

/// Where a value stands in the document.
#[derive(Clone, Copy)]
struct Place {
    /// Names on the way from the top.
    depth: usize,
    /// Whether an expression here may have variables: directly under one of these names, or in the table of that name.
    formula: Option<Level>,
    /// The variables of such an expression.
    variables: &'static [&'static str],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    /// In the table of attributes, each of which is as if it had one of these names.
    Outside,
    Named,
    Inside,
}

impl Place {
    const TOP: Self = Self { depth: 1, formula: None, variables: VARIABLES };

    /// The place of an entry of the table that stands here. The first two names are the family and the name of
    /// a definition, which may well be called so.
    fn entry(self, name: &str) -> Self {
        let surface = name == OF_SURFACES;
        let attributes = name == OF_ATTRIBUTES && self.depth >= 2;
        let outside = self.formula == Some(Level::Outside);
        let formula = if attributes {
            Some(Level::Outside)
        } else if outside || ((surface || TAKES_FORMULAS.contains(&name)) && self.depth >= 2) {
            Some(Level::Named)
        } else if self.formula == Some(Level::Named) {
            Some(Level::Inside)
        } else {
            None
        };
        let inside = formula.is_some() && self.formula.is_some();
        let inherited = if inside { self.variables } else { VARIABLES };
        Self {
            depth: self.depth + 1,
            formula,
            variables: match name {
                OF_SURFACES => SURFACE_VARIABLES,
                _ if attributes => ATTRIBUTE_VARIABLES,
                _ => inherited,
            },
        }
    }
}

struct Tree<'p, 'd> {
    parameters: &'p mut Parameters<'d>,
    items: u64,
}

impl Tree<'_, '_> {
    fn value(&mut self, value: &mut Value, place: Place) {
        match &mut value.data {
            Data::String(text) if body(text).is_some() => {
                value.data = match place.formula {
                    Some(_) => {
                        let found = self.parameters.formula(text, value.span, place.variables);
                        formula(found, value.span)
                    }
                    None => data(self.parameters.expression(text, value.span), value.span),
                };
            }
            Data::Array(items) => items.iter_mut().for_each(|item| self.value(item, place)),
            Data::Table(table) if table.get("each").is_some() => {
                let table = std::mem::take(table);
                value.data = self.generate(table, value.span, place).map_or(Data::Broken, Data::Array);
            }
            Data::Table(table) => {
                for (name, entry) in &mut table.entries {
                    self.value(&mut entry.value, place.entry(name));
                }
            }
            _ => {}
        }
    }

    /// The items of `{ count, each }`.
    fn generate(&mut self, mut table: Table, span: Span, place: Place) -> Option<Vec<Value>> {
        let count = table.entries.shift_remove("count");
        let each = table.entries.shift_remove("each")?.value;
        for (name, entry) in &table.entries {
            let message = format!("unknown field {} beside `each`", backtick(name));
            let report = Diagnostic::error(Code::UnknownField, message);
            self.parameters.found.push(report.at(entry.key, "expected only `count` and `each`"));
        }
        let Some(count) = count else {
            let report = Diagnostic::error(Code::MissingField, "missing field `count` beside `each`");
            self.parameters.found.push(report.at(span, "how many?"));
            return None;
        };
        let count = self.count(count)?;
        let outer = self.parameters.index;
        let items = self.items(&each, count, place);
        self.parameters.index = outer;
        items
    }

    fn count(&mut self, mut entry: Entry) -> Option<u64> {
        self.value(&mut entry.value, Place::TOP);
        let (value, span) = (&entry.value, entry.value.span);
        if matches!(value.data, Data::Broken) {
            return None;
        }
        let whole = value.number().filter(|number| *number >= 0.0 && number.fract() == 0.0);
        let Some(whole) = whole else {
            let message = format!("`count` must be a whole number, found {}", value.describe());
            self.parameters.found.push(Diagnostic::error(Code::WrongType, message).at(span, "how many?"));
            return None;
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates at the limit below"
        )]
        let count = whole.min(1e15) as u64;
        self.items += count;
        if self.items <= MOST_ITEMS {
            return Some(count);
        }
        let message = format!("arrays with `each` make at most {MOST_ITEMS} items in one document");
        self.parameters.found.push(Diagnostic::error(Code::ExpressionLimit, message).at(span, "too many"));
        None
    }

    /// One item for each index; stops at the first that has no value, since the rest would repeat its error.
    fn items(&mut self, each: &Value, count: u64, place: Place) -> Option<Vec<Value>> {
        let parsed = match &each.data {
            Data::String(text) if body(text).is_some() => {
                Some((self.parameters.parsed(text, each.span)?, text))
            }
            _ => None,
        };
        let mut items = Vec::new();
        for index in 0..count {
            #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
            let number = index as f64;
            self.parameters.index = Some(number);
            let before = self.parameters.found.len();
            let item = match &parsed {
                Some((parsed, text)) => {
                    let computed = self.parameters.evaluate(parsed, text, each.span);
                    Value::new(each.span, data(computed, each.span))
                }
                None => {
                    let mut item = each.clone();
                    self.value(&mut item, place);
                    item
                }
            };
            if self.parameters.found.len() > before || matches!(item.data, Data::Broken) {
                return None;
            }
            items.push(item);
        }
        Some(items)
    }
}

fn data(computed: Option<Computed>, span: Span) -> Data {
    match computed {
        None => Data::Broken,
        Some(Computed::Number(number)) => Data::Float(number),
        Some(Computed::Boolean(truth)) => Data::Boolean(truth),
        Some(Computed::Text(text)) => Data::String(text),
        Some(Computed::List(items)) => {
            Data::Array(items.into_iter().map(|item| Value::new(span, data(Some(item), span))).collect())
        }
    }
}

fn formula(found: Option<FormulaOrValue>, span: Span) -> Data {
    match found {
        Some(FormulaOrValue::Formula(formula)) => Data::Formula(formula),
        Some(FormulaOrValue::Value(value)) => data(Some(value), span),
        None => Data::Broken,
    }
}

/// A warning for each parameter of the main document that nothing uses.
fn unused(
    written: &Table,
    parameters: &Parameters<'_>,
    variants: &Table,
    overrides: &[(String, String)],
    sources: &SourceMap,
) -> Vec<Diagnostic> {
    let main = sources.files().next();
    let idle = written.entries.iter().filter(|(name, entry)| {
        !parameters.used.contains(*name)
            && sources.file_of(entry.key) == main
            && !overrides.iter().any(|(set, _)| set == *name)
            && !variants.entries.values().any(|variant| mentions(&variant.value, name))
    });
    let warn = |(name, entry): (&String, &Entry)| {
        Diagnostic::warning(Code::UnusedParameter, format!("parameter {} is never used", backtick(name)))
            .at(entry.key, "not used")
            .help(format!("use it as \"= {name}\", or leave it out"))
    };
    idle.map(warn).collect()
}

/// Whether an expression inside of a value holds a name.
fn mentions(value: &Value, name: &str) -> bool {
    match &value.data {
        Data::String(text) => body(text).is_some_and(|body| body.contains(name)),
        Data::Array(items) => items.iter().any(|item| mentions(item, name)),
        Data::Table(table) => table.entries.values().any(|entry| mentions(&entry.value, name)),
        _ => false,
    }
}

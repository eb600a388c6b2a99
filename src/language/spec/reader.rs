//! Reading the value tree into types: every error of a table in one pass, each with its place.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::{SourceMap, Span};
use crate::language::spec::check::Check;
use crate::language::spec::reference::{Family, Use};
use crate::language::spec::schema::Schemas;
use crate::language::suggest::closest;
use crate::language::value::{Data, Table, Value, quote};

/// A type that can be read from a value.
pub(crate) trait Read: Sized {
    /// Reads the value; reports what is wrong and answers `None` where it cannot.
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self>;

    /// What stands for a field that is not written; `None` where it must be.
    fn absent() -> Option<Self> {
        None
    }

    /// The JSON Schema of the value, as a document writes it.
    fn schema(schemas: &mut Schemas) -> serde_json::Value;

    /// The value as the schema shows a default; `None` where it cannot be written.
    fn written(&self) -> Option<serde_json::Value> {
        None
    }
}

/// What is known while values are read: where we are, what was wrong, which names were used.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    /// The texts that spans point into.
    pub(crate) sources: &'a SourceMap,
    /// Everything reported so far.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Every name that a definition uses.
    pub(crate) uses: Vec<Use>,
    /// The definition that is being read.
    pub(crate) user: Option<(Family, String)>,
    path: Vec<Step>,
}

#[derive(Debug)]
enum Step {
    Name(String),
    Index(usize),
}

impl<'a> Reader<'a> {
    /// A reader of values that were written in `sources`.
    #[must_use]
    pub(crate) fn new(sources: &'a SourceMap) -> Self {
        Self { sources, diagnostics: Vec::new(), uses: Vec::new(), user: None, path: Vec::new() }
    }

    /// Adds a diagnostic.
    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The field that is being read as a message names it: `` `points[3]` ``, or `the value`.
    #[must_use]
    pub(crate) fn place(&self) -> String {
        let Some(last) = self.path.iter().rposition(|step| matches!(step, Step::Name(_))) else {
            return "the value".to_owned();
        };
        let steps = self.path[last..].iter().map(|step| match step {
            Step::Name(name) => name.clone(),
            Step::Index(index) => format!("[{index}]"),
        });
        format!("`{}`", steps.collect::<String>())
    }

    /// Runs `read` with the path one name longer.
    pub(crate) fn within<T>(&mut self, name: &str, read: impl FnOnce(&mut Self) -> T) -> T {
        self.within_key(&name.replace('_', "-"), read)
    }

    /// Runs `read` with the path one name longer, as a document writes it.
    pub(crate) fn within_key<T>(&mut self, key: &str, read: impl FnOnce(&mut Self) -> T) -> T {
        self.path.push(Step::Name(key.to_owned()));
        let result = read(self);
        self.path.pop();
        result
    }

    /// Runs `read` with the path one index longer.
    pub(crate) fn within_index<T>(&mut self, index: usize, read: impl FnOnce(&mut Self) -> T) -> T {
        self.path.push(Step::Index(index));
        let result = read(self);
        self.path.pop();
        result
    }

    /// Reports that a value is not what was expected (`"a number"`); silent on what was reported before.
    pub(crate) fn mismatch(&mut self, value: &Value, expected: &str) {
        if matches!(value.data, Data::Broken) {
            return;
        }
        let message = format!("{} must be {expected}, found {}", self.place(), value.describe());
        let mut report =
            Diagnostic::error(Code::WrongType, message).at(value.span, format!("expected {expected}"));
        match &value.data {
            Data::String(text) => report = hint_expression(report, text, value.span),
            Data::Array(items)
                if expected == "a table" && items.iter().all(|item| item.table().is_some()) =>
            {
                report = report.help("`[[name]]` begins a list of tables; write `[name]`");
            }
            _ => {}
        }
        self.report(report);
    }

    /// Notes that the definition in hand uses a name of a family.
    pub(crate) fn uses(&mut self, family: Family, name: &str, span: Span) {
        let user = self.user.clone();
        self.uses.push(Use { family, name: name.to_owned(), span, user, quoted: true });
    }

    /// Notes a name that says nothing of what is made of what.
    pub(crate) fn uses_alone(&mut self, family: Family, name: &str, span: Span) {
        self.uses.push(Use { family, name: name.to_owned(), span, user: None, quoted: true });
    }

    /// Notes a name inside a text; `exact` tells whether the span is that of the name alone.
    pub(crate) fn uses_inside(&mut self, family: Family, name: &str, span: Span, exact: bool) {
        let user = self.user.clone();
        self.uses.push(Use { family, name: name.to_owned(), span, user, quoted: !exact });
    }
}

fn hint_expression(report: Diagnostic, text: &str, span: Span) -> Diagnostic {
    if text.starts_with('=') && !text.starts_with("= ") {
        return report.help("an expression begins with an equals sign and a space: \"= ...\"").suggest(
            span,
            format!("\"= {}\"", &text[1..]),
            "add the space",
        );
    }
    if text.trim().parse::<f64>().is_ok() {
        return report.suggest(span, text.trim(), "write the number without quotes");
    }
    report
}

/// Reads a whole text as one table, and what was wrong with it.
pub(crate) fn read_whole<T: Read>(
    table: Table,
    start: Span,
    sources: &SourceMap,
) -> (Option<T>, Vec<Diagnostic>) {
    let mut reader = Reader::new(sources);
    let read = T::read(&Value::new(start, Data::Table(table)), &mut reader);
    (read, reader.diagnostics)
}

/// The entries of one table, taken by name; what remains is unknown.
#[derive(Debug)]
pub(crate) struct Fields<'v> {
    table: &'v Table,
    span: Span,
    known: Vec<&'static str>,
    missing: Vec<&'static str>,
    title: &'static str,
}

impl<'v> Fields<'v> {
    /// Opens a table that reads as `title` (`"circle"`).
    pub(crate) fn open(value: &'v Value, title: &'static str, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Table(table) = &value.data else {
            reader.mismatch(value, "a table");
            return None;
        };
        Some(Self { table, span: value.span, known: Vec::new(), missing: Vec::new(), title })
    }

    /// Reads a field. Rust's `end_radius` is TOML's `end-radius`.
    pub(crate) fn take<T: Read>(
        &mut self,
        name: &'static str,
        default: Option<fn() -> T>,
        check: Check,
        reader: &mut Reader<'_>,
    ) -> Option<T> {
        // Rust writes words of its own so.
        let name = name.strip_prefix("r#").unwrap_or(name);
        let Some(value) = self.raw(name) else {
            let value = default.map(|default| default()).or_else(T::absent);
            if value.is_none() {
                self.missing.push(name);
            }
            return value;
        };
        reader.within(name, |reader| {
            let value_read = T::read(value, reader);
            // A value of the wrong type says so; bounds on its parts would only repeat it.
            value_read.filter(|_| check.apply(value, reader))
        })
    }

    /// The value of a field, unread; the field is then known.
    pub(crate) fn raw(&mut self, name: &'static str) -> Option<&'v Value> {
        self.known.push(name);
        if name.contains('_') {
            return self.table.get(&name.replace('_', "-"));
        }
        self.table.get(name)
    }

    /// Names that this table knows beside those that were taken.
    pub(crate) fn know(&mut self, names: &[&'static str]) {
        self.known.extend_from_slice(names);
    }

    /// The place of the table.
    #[must_use]
    pub(crate) fn span(&self) -> Span {
        self.span
    }

    /// The entries of the table, whether taken or not.
    pub(crate) fn table(&self) -> &'v Table {
        self.table
    }

    /// Reports the keys that nobody took and the fields that are missing. Whether all is well.
    pub(crate) fn close(self, reader: &mut Reader<'_>) -> bool {
        let meant = self.unknown(reader);
        // A misspelt field is not missing too.
        let missing =
            self.missing.iter().filter(|name| !meant.iter().flatten().any(|near| same_name(name, near)));
        let names: Vec<_> = missing.map(|name| format!("`{}`", name.replace('_', "-"))).collect();
        if names.is_empty() {
            return meant.is_empty();
        }
        let fields = if names.len() == 1 { "field" } else { "fields" };
        let message = format!("missing {fields} {} of {}", names.join(", "), self.title);
        let label = format!("needs {}", names.join(", "));
        reader.report(Diagnostic::error(Code::MissingField, message).at(self.span, label));
        false
    }

    /// The keys that nobody took so far, with their places.
    #[must_use]
    pub(crate) fn unknown_names(&self) -> Vec<(&'v str, Span)> {
        let entries = self.table.entries.iter().map(|(name, entry)| (name.as_str(), entry.key));
        entries.filter(|(name, _)| !self.known.iter().any(|known| same_name(known, name))).collect()
    }

    /// Reports unknown keys; for each the field that was probably meant.
    fn unknown(&self, reader: &mut Reader<'_>) -> Vec<Option<String>> {
        let unknown = self.unknown_names();
        if unknown.is_empty() {
            return Vec::new();
        }
        let known: Vec<String> = self.known.iter().map(|name| name.replace('_', "-")).collect();
        let report = |(name, key): (&str, Span)| {
            let report = unknown_field(name, key, &known, self.title);
            let meant = report.suggestion.as_ref().map(|suggestion| suggestion.replacement.clone());
            reader.report(report);
            meant
        };
        unknown.into_iter().map(report).collect()
    }
}

/// Whether Rust's name of a field (`end_radius`) is the name of a key (`end-radius`).
fn same_name(field: &str, key: &str) -> bool {
    let letters = field.bytes().map(|byte| if byte == b'_' { b'-' } else { byte });
    field.len() == key.len() && letters.eq(key.bytes())
}

/// The error on a key that a table does not know, with the nearest one that it does.
pub(crate) fn unknown_field(name: &str, key: Span, known: &[String], title: &str) -> Diagnostic {
    let report =
        Diagnostic::error(Code::UnknownField, format!("unknown field {} of {title}", backtick(name)))
            .at(key, format!("not a field of {title}"));
    let near = closest(name, known.iter().map(String::as_str));
    let report = match near {
        Some(near) => report.suggest(key, near, format!("did you mean `{near}`?")),
        None => report,
    };
    report.note(format!("fields of {title}: {}", known.join(", ")))
}

/// A name of the text in backticks, cut when it is long.
pub(crate) fn backtick(name: &str) -> String {
    let quoted = quote(name);
    format!("`{}`", &quoted[1..quoted.len() - 1])
}

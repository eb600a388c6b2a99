//! Text to value tree: every syntax error in one run.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::{FileId, SourceMap, Span};
use crate::language::value::scan::{DEEPEST, Finding, scan};
use crate::language::value::{Data, Entry, Table, Value, quote};

/// The most syntax errors that one file reports: what follows so many is rarely the author's.
const MOST_ERRORS: usize = 50;

/// Parses a file of a map. What cannot be read is left out or [`Data::Broken`], and reported.
///
/// Cost: linear in the text.
#[must_use]
pub fn parse(sources: &SourceMap, file: FileId) -> (Table, Vec<Diagnostic>) {
    let text = sources.text(file);
    let mut parser = Parser { sources, file, found: Vec::new(), unclosed: usize::MAX };
    if !parser.prepare(text) {
        return (Table::default(), parser.found);
    }
    let (tree, errors) = DeTable::parse_recoverable(text);
    let unclosed = parser.unclosed;
    let sound = errors.iter().filter(|error| error.span().is_none_or(|range| range.start < unclosed));
    for error in sound.take(MOST_ERRORS) {
        parser.syntax(error.span(), error.message());
    }
    let table = parser.table(tree.into_inner());
    (table, parser.found)
}

struct Parser<'s> {
    sources: &'s SourceMap,
    file: FileId,
    found: Vec<Diagnostic>,
    /// Where a bracket opens that is never closed.
    unclosed: usize,
}

impl Parser<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        self.sources.span(self.file, range)
    }

    /// Checks the raw text; `false` when it must not be parsed.
    fn prepare(&mut self, text: &str) -> bool {
        if text.starts_with('\u{feff}') {
            let report = Diagnostic::error(Code::Syntax, "a second byte order mark");
            self.found.push(report.at(self.span(0..3), "not TOML"));
        }
        let mut good = true;
        for finding in scan(text) {
            match finding {
                Finding::Newer(range, message) => {
                    let report = Diagnostic::error(Code::Syntax, message.to_owned());
                    self.found.push(report.at(self.span(range), "not TOML 1.0"));
                }
                Finding::Unclosed(at) => {
                    let bracket = &text[at..=at];
                    let report =
                        Diagnostic::error(Code::Unclosed, format!("this `{bracket}` is never closed"));
                    self.found.push(report.at(self.span(at..at + 1), "no closing bracket"));
                    self.unclosed = at;
                }
                Finding::TooDeep(at) => {
                    let message = format!("arrays and tables are nested more than {DEEPEST} deep");
                    let report = Diagnostic::error(Code::TooDeep, message);
                    self.found.push(report.at(self.span(at..at + 1), "too deep"));
                    good = false;
                }
            }
        }
        good
    }

    fn syntax(&mut self, range: Option<Range<usize>>, message: &str) {
        let range = range.unwrap_or(0..0);
        let span = self.span(range);
        let (message, expected) = message.split_once(", expected ").unwrap_or((message, ""));
        let label = if expected.is_empty() { String::new() } else { format!("expected {expected}") };
        let snippet = self.sources.snippet(span);
        if message == "duplicate key" {
            let report =
                Diagnostic::error(Code::DuplicateName, format!("{} is written twice", name(snippet)));
            let first = self.first_time(span).unwrap_or(Span::NONE);
            return self.found.push(report.at(span, "the second time").also(first, "the first time"));
        }
        let report = Diagnostic::error(Code::Syntax, better(message, snippet)).at(span, label);
        self.found.push(match snippet.strip_prefix(',') {
            Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => {
                report.help("numbers have a decimal point: 1.5")
            }
            _ => report,
        });
    }

    /// Where a key that is written twice was written first: in the same header, or above under the same header.
    fn first_time(&self, second: Span) -> Option<Span> {
        let (file, range) = self.sources.range(second)?;
        let (text, key) = (self.sources.text(file), self.sources.snippet(second));
        let start = text[..range.start].rfind('\n').map_or(0, |at| at + 1);
        let end = text[range.start..].find('\n').map_or(text.len(), |at| range.start + at);
        let (line, offset) = (text[start..end].trim_end(), range.start - start);
        let is_header = line.trim_start().starts_with('[');
        let mut at = start;
        for above in text[..start].split_inclusive('\n').rev() {
            at -= above.len();
            let named =
                above.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
            if is_header && above.trim_end() == line {
                return Some(self.span(at + offset..at + offset + key.len()));
            } else if !is_header && named {
                let indent = above.len() - above.trim_start().len();
                return Some(self.span(at + indent..at + indent + key.len()));
            } else if !is_header && above.trim_start().starts_with('[') {
                return None;
            }
        }
        None
    }

    fn table(&mut self, table: DeTable<'_>) -> Table {
        let mut read = Table::default();
        read.entries.reserve(table.len());
        for (key, value) in table {
            let span = self.span(key.span());
            let value = self.value(value);
            read.entries.insert(key.into_inner().into_owned(), Entry { key: span, value });
        }
        read
    }

    fn value(&mut self, value: Spanned<DeValue<'_>>) -> Value {
        let span = self.span(value.span());
        let data = match value.into_inner() {
            DeValue::String(text) => Data::String(text.into_owned()),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => Data::Integer(number),
                Err(_) if number.as_str().is_empty() => Data::Broken,
                Err(_) => self.too_large(number.as_str(), span),
            },
            DeValue::Float(number) => self.float(number.as_str(), span),
            DeValue::Boolean(truth) => Data::Boolean(truth),
            DeValue::Datetime(time) => self.datetime(time.to_string(), span),
            DeValue::Array(items) => Data::Array(items.into_iter().map(|item| self.value(item)).collect()),
            DeValue::Table(table) => Data::Table(self.table(table)),
        };
        Value { span, data }
    }

    fn too_large(&mut self, number: &str, span: Span) -> Data {
        let message = format!("the whole number {} does not fit in 64 bits", unquoted(number));
        self.found.push(Diagnostic::error(Code::OutOfRange, message).at(span, "too large"));
        Data::Broken
    }

    fn float(&mut self, text: &str, span: Span) -> Data {
        match text.trim_start_matches('+').parse() {
            Ok(number) => Data::Float(number),
            Err(_) => {
                let message = format!("{} is no number", unquoted(text));
                self.found.push(Diagnostic::error(Code::Syntax, message).at(span, ""));
                Data::Broken
            }
        }
    }

    /// TOML 1.0 times have seconds.
    fn datetime(&mut self, read: String, span: Span) -> Data {
        let written = self.sources.snippet(span);
        let time = written.split_once(['T', 't', ' ']).map_or(written, |(_, time)| time);
        let hours_and_minutes = time.as_bytes().get(2) == Some(&b':');
        if hours_and_minutes && time.as_bytes().get(5) != Some(&b':') {
            let report = Diagnostic::error(Code::Syntax, "a time of TOML 1.0 has seconds");
            self.found.push(report.at(span, "expected hours:minutes:seconds"));
        }
        Data::Datetime(read)
    }
}

/// The parser's message in plainer words, where it has any.
fn better<'m>(message: &'m str, snippet: &str) -> &'m str {
    match message {
        "string values must be quoted" if snippet.trim().is_empty() => "a value is missing",
        "invalid basic string" | "invalid literal string" if snippet.trim().is_empty() => {
            "this string does not end on its line"
        }
        "invalid basic string" | "invalid literal string" => "a control character stands in this string",
        "unexpected key or value" => "nothing more can stand on this line",
        "missing escaped value" => "no such escape",
        message => message,
    }
}

fn unquoted(text: &str) -> String {
    let quoted = quote(text);
    quoted[1..quoted.len() - 1].to_owned()
}

fn name(text: &str) -> String {
    format!("`{}`", unquoted(text.trim_matches(['"', '\''])))
}

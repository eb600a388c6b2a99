//! Exactly one kind, and one of several words.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::reader::{Fields, Reader, backtick};
use crate::language::spec::schema::{Object, Schemas};
use crate::language::suggest::closest;
use crate::language::value::{Data, Value};

/// A family of which a table holds exactly one kind.
pub(crate) trait Kinds: Sized {
    /// The family in words: `curve`.
    const TITLE: &'static str;
    /// The kinds as documents name them.
    const NAMES: &'static [&'static str];

    /// Reads the table under the name of a kind.
    fn read_kind(name: &str, value: &Value, reader: &mut Reader<'_>) -> Option<Self>;

    /// Adds a property for each kind to the schema of a table.
    fn describe_kinds(object: &mut Object, schemas: &mut Schemas);
}

/// Takes the one kind among the fields of a table; reports none and several.
pub(crate) fn take_kind<K: Kinds>(fields: &mut Fields<'_>, reader: &mut Reader<'_>) -> Option<K> {
    fields.know(K::NAMES);
    let table = fields.table();
    let present: Vec<_> =
        table.entries.iter().filter(|(name, _)| K::NAMES.contains(&name.as_str())).collect();
    // Each kind is read even where there are several, so that errors inside are seen in the same run.
    let mut kinds: Vec<Option<K>> = present
        .iter()
        .map(|(name, entry)| reader.within(name, |reader| K::read_kind(name, &entry.value, reader)))
        .collect();
    match present.as_slice() {
        [] => {
            report_none::<K>(fields, reader);
            None
        }
        [_] => kinds.pop().flatten(),
        [(first, one), (second, other), ..] => {
            let title = K::TITLE;
            let message = format!("a {title} has one kind, found `{first}` and `{second}`");
            let report = Diagnostic::error(Code::ManyKinds, message)
                .at(kind_span(other.key, &other.value), "the second kind")
                .also(kind_span(one.key, &one.value), "the first kind")
                .help(if title == "segment" {
                    "write `{ ... }` for each segment".to_owned()
                } else {
                    format!("give each {title} a name of its own")
                });
            reader.report(report);
            None
        }
    }
}

fn kind_span(key: Span, value: &Value) -> Span {
    if key.is_none() { value.span } else { key }
}

fn report_none<K: Kinds>(fields: &Fields<'_>, reader: &mut Reader<'_>) {
    let title = K::TITLE;
    let unknown = fields.unknown_names();
    let near = unknown
        .iter()
        .find_map(|(name, key)| closest(name, K::NAMES.iter().copied()).map(|near| (*key, near)));
    let report = Diagnostic::error(Code::NoKind, format!("this {title} says no kind"))
        .at(fields.span(), format!("a {title} needs one kind"))
        .note(format!("kinds of {title}: {}", K::NAMES.join(", ")));
    // A misspelt kind is reported as an unknown field, with the nearest one; saying more would repeat it.
    if near.is_none() {
        reader.report(report);
    }
}

/// The word of a value among `words`; reports anything else.
pub(crate) fn choice<'w>(value: &Value, words: &[&'w str], reader: &mut Reader<'_>) -> Option<&'w str> {
    let listed = words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
    let Data::String(text) = &value.data else {
        reader.mismatch(value, &format!("one of {listed}"));
        return None;
    };
    if let Some(word) = words.iter().find(|word| *word == text) {
        return Some(word);
    }
    let message = format!("{} cannot be {}", reader.place(), backtick(text));
    let report =
        Diagnostic::error(Code::UnknownChoice, message).at(value.span, format!("expected one of {listed}"));
    reader.report(match closest(text, words.iter().copied()) {
        Some(near) => report.suggest(value.span, format!("\"{near}\""), format!("did you mean \"{near}\"?")),
        None => report,
    });
    None
}

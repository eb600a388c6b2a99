//! What came of documents, for services that show it: SARIF, `JUnit`, and the annotations of GitHub's workflows.
//!
//! Sources: OASIS, Static Analysis Results Interchange Format (SARIF) 2.1.0, 2020; the `JUnit` format as Jenkins' `xUnit` plugin
//! defines it, version 10; GitHub, Workflow commands for GitHub Actions, 2024. No record holds a time, so that the same
//! documents give the same bytes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde_json::{Value, json};

use super::Outcome;
use super::arguments::RecordOptions;
use super::output::Printer;
use super::turns::Message;
use crate::language::diagnostic::Code;
use crate::project::{reason, save};

/// What came of each document, by its turn.
#[derive(Debug, Default)]
pub(crate) struct Records(Mutex<BTreeMap<usize, Entry>>);

#[derive(Debug)]
struct Entry {
    path: String,
    outcome: Outcome,
    /// Diagnostics as objects.
    found: Vec<Value>,
    /// All of it for people.
    text: String,
}

impl Records {
    /// Notes what came of a document.
    pub(crate) fn add(&self, turn: usize, path: &str, outcome: Outcome, messages: &[Message]) {
        let (mut found, mut text) = (Vec::new(), String::new());
        for message in messages {
            match message {
                Message::Diagnostics(list) => {
                    found.extend(list.to_json().as_array().into_iter().flatten().cloned());
                    text.push_str(&list.render(false));
                }
                Message::Failure(message) => {
                    found.push(json!({ "severity": "error", "message": message, "file": path }));
                    let _ = writeln!(text, "error: {message}");
                }
                Message::Result(..) => {}
            }
        }
        let entry = Entry { path: path.to_owned(), outcome, found, text };
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(turn, entry);
    }

    /// Writes the records that are asked for.
    pub(crate) fn write(&self, options: &RecordOptions, printer: &Printer) -> Outcome {
        let entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let entries: Vec<&Entry> = entries.values().collect();
        let sarif = options.sarif.as_ref().map(|file| write(file, &sarif(&entries), printer));
        let junit = options.junit.as_ref().map(|file| write(file, &junit(&entries), printer));
        sarif.into_iter().chain(junit).max().unwrap_or(Outcome::Good)
    }
}

/// Writes a file that was named in an argument.
pub(crate) fn write(file: &Path, text: &str, printer: &Printer) -> Outcome {
    let folder = file
        .parent()
        .filter(|folder| *folder != Path::new(""))
        .map_or_else(|| PathBuf::from("."), Path::to_path_buf);
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match save(&folder, &[(&name, text.as_bytes())]) {
        Ok(()) => Outcome::Good,
        Err(error) => {
            printer.failure(&format!("cannot write {}: {}", file.display(), reason(&error)), None);
            Outcome::Files
        }
    }
}

fn text_of<'a>(of: &'a Value, key: &str) -> &'a str {
    of[key].as_str().unwrap_or_default()
}

/// A sentence with what is to be done about it.
fn sentence(found: &Value) -> String {
    let list =
        |key: &str| found[key].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
    let help = found["help"].as_str().map(str::to_owned).into_iter().chain(list("help"));
    let help = help.map(|help| format!("help: {help}"));
    std::iter::once(text_of(found, "message").to_owned())
        .chain(list("notes"))
        .chain(help)
        .collect::<Vec<_>>()
        .join("\n")
}

fn sarif(entries: &[&Entry]) -> String {
    let found = || entries.iter().flat_map(|entry| &entry.found);
    let codes: std::collections::BTreeSet<&str> = found().filter_map(|one| one["code"].as_str()).collect();
    let rules: Vec<Value> = codes.iter().filter_map(|code| Code::parse(code)).map(rule).collect();
    let results: Vec<Value> = found().map(result).collect();
    let log = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "kiln", "semanticVersion": env!("CARGO_PKG_VERSION"), "rules": rules } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    });
    format!("{log:#}\n")
}

fn rule(code: Code) -> Value {
    json!({ "id": code.text(), "shortDescription": { "text": code.title() } })
}

fn result(found: &Value) -> Value {
    let mut result = json!({
        "level": text_of(found, "severity"),
        "message": { "text": sentence(found) },
        "locations": location(found).into_iter().collect::<Vec<_>>(),
    });
    if let Some(code) = found["code"].as_str() {
        result["ruleId"] = json!(code);
    }
    let others = found["labels"].as_array().into_iter().flatten();
    let others = others.filter(|label| label["primary"] == json!(false));
    let related: Vec<Value> = others
        .filter_map(|label| {
            let mut place = location(label)?;
            place["message"] = json!({ "text": text_of(label, "text") });
            Some(place)
        })
        .collect();
    if !related.is_empty() {
        result["relatedLocations"] = json!(related);
    }
    result
}

fn location(of: &Value) -> Option<Value> {
    let file = of["file"].as_str()?;
    let mut place = json!({ "artifactLocation": { "uri": uri(file) } });
    if !of["line"].is_null() {
        place["region"] = json!({
            "startLine": of["line"],
            "startColumn": of["column"],
            "endLine": of["end_line"],
            "endColumn": of["end_column"],
        });
    }
    Some(json!({ "physicalLocation": place }))
}

/// A relative path as a reference of RFC 3986.
fn uri(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    path.bytes()
        .map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

fn junit(entries: &[&Entry]) -> String {
    let failed = entries.iter().filter(|entry| entry.outcome != Outcome::Good).count();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<testsuites>\n<testsuite name=\"kiln\" tests=\"{}\" failures=\"{failed}\" errors=\"0\" skipped=\"0\">",
        entries.len()
    );
    for entry in entries {
        let name = xml(&entry.path);
        let said = xml(&entry.text);
        let _ = match (entry.outcome, said.is_empty()) {
            (Outcome::Good, true) => writeln!(text, "<testcase classname=\"kiln\" name=\"{name}\"/>"),
            (Outcome::Good, false) => writeln!(
                text,
                "<testcase classname=\"kiln\" name=\"{name}\">\n<system-err>{said}</system-err>\n</testcase>"
            ),
            _ => {
                let first = entry.found.iter().find(|one| one["severity"] == json!("error"));
                let message = xml(first.map_or("it failed", |one| text_of(one, "message")));
                writeln!(
                    text,
                    "<testcase classname=\"kiln\" name=\"{name}\">\n<failure message=\"{message}\">{said}</failure>\n</testcase>"
                )
            }
        };
    }
    text.push_str("</testsuite>\n</testsuites>\n");
    text
}

/// Text in XML 1.0, which has no way to write most control characters.
fn xml(text: &str) -> String {
    let mut made = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => made.push_str("&amp;"),
            '<' => made.push_str("&lt;"),
            '>' => made.push_str("&gt;"),
            '"' => made.push_str("&quot;"),
            '\n' | '\t' => made.push(letter),
            _ if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => made.push('\u{fffd}'),
            _ => made.push(letter),
        }
    }
    made
}

/// A line by which a workflow of GitHub shows a diagnostic at its place.
pub(crate) fn annotation(found: &Value) -> String {
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let mut properties = Vec::new();
    if let Some(file) = found["file"].as_str() {
        properties.push(format!("file={}", property(file)));
    }
    for (name, key) in
        [("line", "line"), ("endLine", "end_line"), ("col", "column"), ("endColumn", "end_column")]
    {
        if let Some(number) = found[key].as_u64() {
            properties.push(format!("{name}={number}"));
        }
    }
    if let Some(code) = found["code"].as_str() {
        properties.push(format!("title={}", property(code)));
    }
    let level = if found["severity"] == json!("warning") { "warning" } else { "error" };
    let space = if properties.is_empty() { "" } else { " " };
    format!("::{level}{space}{}::{}", properties.join(","), data(&sentence(found)))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{annotation, uri, xml};

    #[test]
    fn signs_that_formats_obey_are_escaped() {
        assert_eq!(uri("a b/ä%.toml"), "a%20b/%C3%A4%25.toml");
        assert_eq!(xml("<a & \"b\">\u{1b}[0m\n"), "&lt;a &amp; &quot;b&quot;&gt;\u{fffd}[0m\n");
        let found = json!({ "severity": "warning", "message": "100 %\n::error::no", "file": "a,b:c.toml", "line": 3, "help": ["x"] });
        assert_eq!(
            annotation(&found),
            "::warning file=a%2Cb%3Ac.toml,line=3::100 %25%0A::error::no%0Ahelp: x"
        );
    }
}

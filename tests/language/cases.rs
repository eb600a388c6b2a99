//! The language tested in the language: text cases with the expected messages inline.
//!
//! A file of cases holds sections `=== name`. In a section stand the text of `case.toml`, further files after
//! `--- path`, then lines `#!` with what is expected: `#! ok`, or for each diagnostic its line and column (with
//! the file when it is not `case.toml`), severity when it is a warning, code and message, and under it its help and
//! the text that it suggests. `#? --set a=1` and `#? --variant tall` give arguments. With `KILN_BLESS=1` the
//! expectations are written anew, to be read before they are kept.

use std::fmt::Write;
use std::path::Path;

use kiln::language::Document;
use kiln::language::diagnostic::{Diagnostic, Diagnostics, Severity};
use kiln::language::source::MemoryFiles;

pub(crate) struct Case {
    pub(crate) name: String,
    files: Vec<(String, String)>,
    pub(crate) overrides: Vec<(String, String)>,
    pub(crate) variant: Option<String>,
    arguments: Vec<String>,
    expected: Vec<String>,
}

#[test]
fn every_case_gives_the_messages_beside_it() {
    check_folder("tests/language/cases", 150, |case, files| diagnostics(case, &files));
}

/// Runs every case of a folder and holds what is found against what stands beside it.
pub(crate) fn check_folder(folder: &str, least: usize, run: impl Fn(&Case, MemoryFiles) -> Diagnostics) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let run = |case: &Case| described(case, &run);
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .expect("the cases are there")
        .map(|entry| entry.expect("it is read").path())
        .collect();
    paths.sort();
    let mut wrong = String::new();
    let mut count = 0;
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("cases are text");
        let cases = read(&text);
        count += cases.len();
        if std::env::var_os("KILN_BLESS").is_some() {
            std::fs::write(&path, bless(&cases, &run)).expect("cases are written");
            continue;
        }
        for case in &cases {
            let found = run(case);
            if found != case.expected {
                let file = path.file_name().unwrap_or_default().to_string_lossy();
                let (expected, found) = (case.expected.join("\n"), found.join("\n"));
                let _ = writeln!(wrong, "{file}: {}\nexpected:\n{expected}\nfound:\n{found}\n", case.name);
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(count >= least, "only {count} cases were found");
    let whose = folder.parent().and_then(|folder| folder.file_name()).unwrap_or_default().to_string_lossy();
    crate::counts::tried(&format!("cases-of-{whose}"), count);
}

fn read(text: &str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("=== ") {
            let files = vec![("case.toml".to_owned(), String::new())];
            let (overrides, arguments, expected) = (Vec::new(), Vec::new(), Vec::new());
            cases.push(Case { name: name.to_owned(), files, overrides, variant: None, arguments, expected });
            continue;
        }
        let case = cases.last_mut().expect("a file of cases begins with ===");
        if let Some(path) = line.strip_prefix("--- ") {
            case.files.push((path.to_owned(), String::new()));
        } else if let Some(line) = line.strip_prefix("#! ") {
            case.expected.push(line.to_owned());
        } else if let Some(argument) = line.strip_prefix("#? ") {
            take_argument(case, argument);
        } else {
            let (_, text) = case.files.last_mut().expect("there is a file");
            text.push_str(line);
            text.push('\n');
        }
    }
    cases
}

fn take_argument(case: &mut Case, argument: &str) {
    case.arguments.push(argument.to_owned());
    match argument.split_once(' ') {
        Some(("--set", pair)) => {
            let (name, value) = pair.split_once('=').expect("--set name=value");
            case.overrides.push((name.to_owned(), value.to_owned()));
        }
        Some(("--variant", name)) => case.variant = Some(name.to_owned()),
        _ => panic!("unknown argument {argument}"),
    }
}

fn described(case: &Case, run: &impl Fn(&Case, MemoryFiles) -> Diagnostics) -> Vec<String> {
    let files =
        case.files.iter().fold(MemoryFiles::new(), |files, (path, text)| files.with(path, unescape(text)));
    let found = run(case, files);
    // Whatever is found can be shown.
    assert_eq!(found.render(true).is_empty(), found.is_empty());
    assert_eq!(found.to_json().as_array().map(Vec::len), Some(found.len()));
    let lines: Vec<String> = found.iter().flat_map(|one| describe(one, &found)).collect();
    if lines.is_empty() { vec!["ok".to_owned()] } else { lines }
}

/// Bytes that a text of cases cannot hold: `\u{...}` in a comment line `#bytes`.
fn unescape(text: &str) -> Vec<u8> {
    let Some(rest) = text.trim().strip_prefix("#bytes ") else { return text.as_bytes().to_vec() };
    rest.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("a byte in hex")).collect()
}

fn diagnostics(case: &Case, files: &MemoryFiles) -> Diagnostics {
    let document = match Document::load("case.toml", files) {
        Ok(document) => document,
        Err(found) => return found,
    };
    match document.spec(case.variant.as_deref(), &case.overrides) {
        Ok((_, warnings)) => document.diagnostics(warnings),
        Err(found) => found,
    }
}

fn describe(one: &Diagnostic, found: &Diagnostics) -> Vec<String> {
    let place = one.place().and_then(|span| found.sources().locate(span));
    let place = place.map_or("-".to_owned(), |place| match place.file {
        "case.toml" => format!("{}:{}", place.line, place.column),
        file => format!("{file}:{}:{}", place.line, place.column),
    });
    let warning = if one.severity == Severity::Warning { "warning " } else { "" };
    let mut lines = vec![format!("{place} {warning}{} {}", one.code, one.message)];
    lines.extend(one.help.iter().map(|help| format!("    help: {help}")));
    lines.extend(one.suggestion.iter().map(|one| format!("    {} -> {}", one.text, one.replacement)));
    lines
}

fn bless(cases: &[Case], run: &impl Fn(&Case) -> Vec<String>) -> String {
    let mut text = String::new();
    for case in cases {
        let _ = writeln!(text, "=== {}", case.name);
        for (index, (path, body)) in case.files.iter().enumerate() {
            if index > 0 {
                let _ = writeln!(text, "--- {path}");
            }
            text.push_str(body);
        }
        for argument in &case.arguments {
            let _ = writeln!(text, "#? {argument}");
        }
        for line in run(case) {
            let _ = writeln!(text, "#! {line}");
        }
    }
    text
}

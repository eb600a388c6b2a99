//! Which files outputs were made of, for Make and Ninja.
//!
//! Source: GNU Make manual, 2023, section 4.2 (rules) and Ninja manual, 2024, `depfile`: both read `outputs: inputs` with
//! spaces escaped by a backslash and dollars doubled.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};

/// Outputs and inputs of all documents, by their turn.
#[derive(Debug, Default)]
pub(crate) struct Dependencies(Mutex<BTreeMap<usize, Rule>>);

#[derive(Debug)]
struct Rule {
    outputs: Vec<String>,
    inputs: Vec<String>,
}

impl Dependencies {
    /// Notes what a document was made into, and of what.
    pub(crate) fn add(&self, turn: usize, outputs: Vec<String>, inputs: Vec<String>) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.insert(turn, Rule { outputs, inputs });
    }

    /// One rule for each document that has outputs, and an empty one for each input, so that Make goes on when one is
    /// gone.
    pub(crate) fn text(&self) -> String {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut text = String::new();
        let mut known: Vec<&String> = Vec::new();
        for Rule { outputs, inputs } in all.values().filter(|rule| !rule.outputs.is_empty()) {
            let list =
                |paths: &[String]| paths.iter().map(|path| escaped(path)).collect::<Vec<_>>().join(" ");
            let _ = writeln!(text, "{}: {}", list(outputs), list(inputs));
            known.extend(inputs);
        }
        known.sort();
        known.dedup();
        for input in known {
            let _ = writeln!(text, "{}:", escaped(input));
        }
        text
    }
}

/// A path as Make reads it.
pub(crate) fn escaped(path: &str) -> String {
    let mut text = String::new();
    for letter in path.chars() {
        match letter {
            ' ' | '#' => text.extend(['\\', letter]),
            '$' => text.push_str("$$"),
            _ => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::Dependencies;

    #[test]
    fn rules_stand_in_the_order_of_the_documents_with_paths_escaped() {
        let all = Dependencies::default();
        let list = |paths: &[&str]| paths.iter().map(|path| (*path).to_owned()).collect::<Vec<_>>();
        all.add(1, list(&["out/b.glb"]), list(&["b.toml", "common.toml"]));
        all.add(0, list(&["out/a a.glb", "out/a$.glb"]), list(&["a#1.toml", "common.toml"]));
        all.add(2, Vec::new(), list(&["failed.toml"]));
        let expected = "out/a\\ a.glb out/a$$.glb: a\\#1.toml common.toml\nout/b.glb: b.toml common.toml\n\
                        a\\#1.toml:\nb.toml:\ncommon.toml:\n";
        assert_eq!(all.text(), expected);
    }
}

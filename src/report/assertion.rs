//! What a document demands of its report.

use serde::Serialize;
use serde_json::Value;

use super::Report;

/// A demand that holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Path of the fact.
    pub path: String,
    /// What it is.
    pub found: Value,
}

/// Why a path has no fact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The part of the path that is not there.
    pub missing: String,
    /// What is there instead.
    pub known: Vec<String>,
}

impl Report {
    /// The fact at a path of keys with dots between them. A path that is not there is looked for in `totals`,
    /// and in the one shape of a report with one shape, whose coarser levels of detail do not count.
    ///
    /// # Errors
    /// When nothing stands at the path.
    pub fn fact(&self, path: &str) -> Result<Value, Fault> {
        let whole = serde_json::to_value(self).unwrap_or(Value::Null);
        let mut roots = vec![&whole];
        let coarser: usize = self.lods.values().map(|levels| levels.len().saturating_sub(1)).sum();
        if self.shapes.len() == 1 + coarser {
            roots.extend(whole.get("shapes").and_then(|shapes| shapes.as_object()?.values().next()));
        }
        roots.extend(whole.get("totals"));
        let mut fault = None;
        for root in roots {
            match walk(root, path) {
                Ok(found) => return Ok(found.clone()),
                Err(missing) => {
                    fault.get_or_insert(missing);
                }
            }
        }
        Err(fault.unwrap_or(Fault { missing: path.to_owned(), known: Vec::new() }))
    }
}

fn walk<'a>(root: &'a Value, path: &str) -> Result<&'a Value, Fault> {
    let mut here = root;
    for part in path.split('.') {
        let next = match here {
            Value::Object(fields) => fields.get(part),
            Value::Array(items) => part.parse::<usize>().ok().and_then(|index| items.get(index)),
            _ => None,
        };
        here = next.ok_or_else(|| Fault { missing: part.to_owned(), known: keys(here) })?;
    }
    Ok(here)
}

fn keys(value: &Value) -> Vec<String> {
    match value {
        Value::Object(fields) => fields.keys().cloned().collect(),
        Value::Array(items) => (0..items.len()).map(|index| index.to_string()).collect(),
        _ => Vec::new(),
    }
}

//! Facts of two models, held against each other.

use serde_json::{Value, json};

/// A fact that is not the same on both sides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Change {
    /// Keys from the outside in, with dots between them.
    pub(super) path: String,
    /// What it was; none where it was not there.
    pub(super) before: Option<Value>,
    /// What it is.
    pub(super) after: Option<Value>,
}

impl Change {
    pub(super) fn text(&self) -> String {
        format!("  {}: {} -> {}", self.path, shown(self.before.as_ref()), shown(self.after.as_ref()))
    }

    pub(super) fn json(&self) -> Value {
        json!({ "fact": self.path, "before": self.before, "after": self.after })
    }
}

/// A value for people; a dash where there is none.
pub(super) fn shown(value: Option<&Value>) -> String {
    value.map_or_else(|| "-".to_owned(), ToString::to_string)
}

/// All facts that differ, in the order of the first.
pub(super) fn changes(before: &Value, after: &Value) -> Vec<Change> {
    let mut found = Vec::new();
    compare("", Some(before), Some(after), &mut found);
    found
}

fn compare(path: &str, before: Option<&Value>, after: Option<&Value>, found: &mut Vec<Change>) {
    if before == after {
        return;
    }
    if let (Some(Value::Object(one)), Some(Value::Object(other))) = (before, after) {
        let keys = one.keys().chain(other.keys().filter(|key| !one.contains_key(*key)));
        for key in keys {
            let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            compare(&inner, one.get(key), other.get(key), found);
        }
        return;
    }
    found.push(Change { path: path.to_owned(), before: before.cloned(), after: after.cloned() });
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::changes;

    #[test]
    fn what_changed_came_or_went_is_told_with_its_path() {
        let before = json!({ "a": 1, "b": { "c": [1, 2], "d": null }, "gone": { "x": 1 } });
        let after = json!({ "a": 1, "b": { "c": [1, 3], "d": null }, "new": true });
        let found: Vec<String> = changes(&before, &after).iter().map(super::Change::text).collect();
        assert_eq!(found, ["  b.c: [1,2] -> [1,3]", "  gone: {\"x\":1} -> -", "  new: - -> true"]);
        assert!(changes(&before, &before).is_empty());
    }
}

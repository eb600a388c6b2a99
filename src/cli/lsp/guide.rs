//! What the language has to say of a place: a JSON Schema, followed from the top.

use serde_json::{Map, Value as Json};

use super::scan::Step;

/// How deep alternatives of alternatives are followed.
const DEEPEST: u32 = 12;

/// The schema.
pub(super) struct Guide {
    schema: Json,
}

/// A word that may be written.
pub(super) struct Word {
    pub(super) text: String,
    pub(super) description: String,
    /// Whether a table follows, and not a value.
    pub(super) table: bool,
}

impl Guide {
    /// That of documents.
    pub(super) fn of_documents() -> Self {
        Self { schema: crate::language::schema() }
    }

    /// That of project files.
    pub(super) fn of_projects() -> Self {
        Self { schema: crate::language::project_schema() }
    }

    /// The sections of documents.
    pub(super) fn sections(&self) -> impl Iterator<Item = &str> {
        self.schema["properties"].as_object().into_iter().flat_map(Map::keys).map(String::as_str)
    }

    /// Whether what stands in a section has names that documents give.
    pub(super) fn is_family(&self, section: &str) -> bool {
        self.schema["properties"][section]["additionalProperties"].is_object()
    }

    /// All that a schema may be: itself, what it refers to, its alternatives.
    fn all<'a>(&'a self, schema: &'a Json, depth: u32, found: &mut Vec<&'a Json>) {
        found.push(schema);
        if depth == DEEPEST {
            return;
        }
        if let Some(target) = schema["$ref"].as_str().and_then(|name| name.strip_prefix("#/$defs/")) {
            self.all(&self.schema["$defs"][target], depth + 1, found);
        }
        for alternative in ["anyOf", "oneOf", "allOf"] {
            for one in schema[alternative].as_array().into_iter().flatten() {
                self.all(one, depth + 1, found);
            }
        }
    }

    fn each<'a>(&'a self, schemas: &[&'a Json]) -> Vec<&'a Json> {
        let mut found = Vec::new();
        schemas.iter().for_each(|schema| self.all(schema, 0, &mut found));
        found
    }

    /// The schemas of a place, as its table names them.
    fn named(&self, path: &[Step]) -> Vec<&Json> {
        let mut here = vec![&self.schema];
        for step in path {
            let all = self.each(&here);
            here = match step {
                Step::Item => {
                    all.iter().map(|schema| &schema["items"]).filter(|items| items.is_object()).collect()
                }
                Step::Key(key) => {
                    // The header of an array's item names the array alone.
                    let items: Vec<&Json> =
                        all.iter().map(|schema| &schema["items"]).filter(|items| items.is_object()).collect();
                    let tables = all.into_iter().chain(self.each(&items));
                    let mut found = Vec::new();
                    for schema in tables {
                        let more = &schema["additionalProperties"];
                        let inside = schema["properties"].get(key.as_str());
                        found.extend(inside.or_else(|| more.is_object().then_some(more)));
                    }
                    found
                }
            };
        }
        here
    }

    /// The keys of a table.
    pub(super) fn keys(&self, path: &[Step]) -> Vec<Word> {
        let mut words: Vec<Word> = Vec::new();
        for schema in self.each(&self.named(path)) {
            for (key, value) in schema["properties"].as_object().into_iter().flatten() {
                // What computes an array is no part of what a person looks for here.
                let computed = schema["type"].as_array().is_some_and(|types| types.len() > 1);
                if computed || words.iter().any(|word| word.text == *key) {
                    continue;
                }
                let table = self.each(&[value]).iter().any(|schema| is_table(schema));
                words.push(Word { text: key.clone(), description: self.description(&[value]), table });
            }
        }
        words
    }

    /// The words that a value may be.
    pub(super) fn words(&self, path: &[Step]) -> Vec<String> {
        let mut words = Vec::new();
        for schema in self.each(&self.named(path)) {
            let listed = schema["enum"].as_array().into_iter().flatten();
            let all =
                listed.chain(schema.get("const")).filter_map(|word| Some(format!("\"{}\"", word.as_str()?)));
            words.extend(all);
            let types = schema["type"].as_array().into_iter().flatten();
            if types.chain([&schema["type"]]).any(|one| one == "boolean") {
                words.extend(["true".to_owned(), "false".to_owned()]);
            }
        }
        words.dedup();
        words
    }

    /// The section whose names a string at a place may be.
    pub(super) fn section(&self, path: &[Step]) -> Option<&str> {
        let is_family = |name: &&str| self.is_family(name);
        let named = self.named(path);
        let refers = self.each(&named).into_iter().find_map(|schema| {
            let alternatives = schema["anyOf"].as_array()?;
            alternatives.iter().find(|one| one["type"] == "string")?;
            let targets =
                alternatives.iter().filter_map(|one| one["$ref"].as_str()?.strip_prefix("#/$defs/"));
            targets.into_iter().find(is_family)
        });
        // Plain names stand under the word for what they name.
        refers.or_else(|| {
            let takes_text = self.each(&named).iter().any(|schema| schema["type"] == "string");
            let key = path.iter().rev().find_map(|step| match step {
                Step::Key(key) => Some(key.as_str()),
                Step::Item => None,
            })?;
            let section = match key {
                "parent" | "target" | "aim" => "node",
                other => other.strip_suffix('s').filter(is_family).unwrap_or(other),
            };
            let known = self.sections().find(|known| *known == section && self.is_family(known))?;
            takes_text.then_some(known)
        })
    }

    /// What is said of a place.
    pub(super) fn about(&self, path: &[Step]) -> String {
        self.description(&self.named(path))
    }

    fn description(&self, schemas: &[&Json]) -> String {
        let mut said: Vec<&str> = Vec::new();
        for schema in self.each(schemas) {
            let text = schema["description"].as_str().unwrap_or_default();
            if !text.is_empty() && !said.contains(&text) {
                said.push(text);
            }
            // A table tells of itself; what its alternatives are would be too much.
            if said.len() == 2 {
                break;
            }
        }
        let mut text = said.join("\n\n");
        let default = self.each(schemas).into_iter().find_map(|schema| schema.get("default"));
        if let Some(default) = default {
            text.push_str(&format!("\n\nWithout it: `{default}`"));
        }
        text
    }
}

fn is_table(schema: &Json) -> bool {
    schema["properties"].is_object() && schema["type"] == "object"
}

#[cfg(test)]
mod tests {
    use super::Guide;
    use crate::cli::lsp::scan::Step;

    fn path(text: &str) -> Vec<Step> {
        let step = |part: &str| if part == "*" { Step::Item } else { Step::Key(part.to_owned()) };
        text.split('.').filter(|part| !part.is_empty()).map(step).collect()
    }

    #[test]
    fn tables_name_their_keys() {
        let guide = Guide::of_documents();
        let keys = |at: &str| guide.keys(&path(at)).into_iter().map(|word| word.text).collect::<Vec<_>>();
        assert!(keys("").contains(&"material".to_owned()));
        assert!(keys("shape.a").contains(&"revolve".to_owned()));
        assert_eq!(keys("shape.a.sphere"), ["center", "radius"].map(str::to_owned).to_vec());
        assert!(keys("shape.a.trimmed.profile.circle").contains(&"radius".to_owned()));
        assert!(
            keys("shape.a.split.part.*").contains(&"mask".to_owned()),
            "{:?}",
            keys("shape.a.split.part.*")
        );
    }

    #[test]
    fn values_know_their_words_and_names() {
        let guide = Guide::of_documents();
        assert!(guide.words(&path("up")).contains(&"\"z\"".to_owned()));
        assert!(guide.words(&path("material.a.double-sided")).contains(&"true".to_owned()));
        assert_eq!(guide.section(&path("shape.a.trimmed.of")), Some("shape"));
        assert_eq!(guide.section(&path("shape.a.trimmed.holes.*")), Some("curve"));
        assert_eq!(guide.section(&path("shape.a.material")), Some("material"));
        assert_eq!(guide.section(&path("node.a.parent")), Some("node"));
        assert_eq!(guide.section(&path("up")), None);
        assert!(guide.about(&path("shape.a.trimmed.of")).starts_with("The surface"));
    }
}

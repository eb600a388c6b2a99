//! The JSON Schema of a document, built from the same declarations that read it.

use serde_json::{Map, Value as Json, json};

use crate::language::spec::check::Check;
use crate::language::spec::reader::Read;

/// Under this key stands the order of the properties, which a JSON map does not keep, for the reference page.
pub(crate) const ORDER: &str = "x-order";

/// What an expression looks like.
const EXPRESSION: &str = "^= ";

/// The named schemas of a document: one for each kind of table.
#[derive(Debug, Default)]
pub(crate) struct Schemas {
    definitions: Map<String, Json>,
}

/// The schema of one table while it is described.
#[derive(Debug, Default)]
pub(crate) struct Object {
    properties: Map<String, Json>,
    required: Vec<String>,
    kinds: Vec<String>,
    order: Vec<String>,
    fields: usize,
}

impl Schemas {
    /// The reference to the schema of a table; it is described once, when it is first asked for.
    pub(crate) fn object(&mut self, title: &str, doc: &str, describe: fn(&mut Object, &mut Self)) -> Json {
        if !self.definitions.contains_key(title) {
            // The name stands before the description, so that a table may hold itself.
            self.definitions.insert(title.to_owned(), Json::Null);
            let mut object = Object::default();
            describe(&mut object, self);
            self.definitions.insert(title.to_owned(), object.finish(title, doc));
        }
        json!({ "$ref": format!("#/$defs/{title}") })
    }

    /// All named schemas.
    #[must_use]
    pub(crate) fn into_definitions(self) -> Map<String, Json> {
        self.definitions
    }
}

impl Object {
    /// Adds a field.
    pub(crate) fn field<T: Read>(
        &mut self,
        name: &str,
        doc: &str,
        default: Option<fn() -> T>,
        check: Check,
        schemas: &mut Schemas,
    ) {
        let name = name.strip_prefix("r#").unwrap_or(name).replace('_', "-");
        let mut schema = T::schema(schemas);
        check.constrain(&mut schema);
        describe(&mut schema, doc);
        match default {
            Some(default) => set_default(&mut schema, default().written()),
            None if T::absent().is_none() => self.required.push(name.clone()),
            None => {}
        }
        self.fields += 1;
        self.order.push(name.clone());
        self.properties.insert(name, schema);
    }

    /// Whether it has a property of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.properties.contains_key(name)
    }

    /// Adds a kind, of which the table holds exactly one.
    pub(crate) fn kind<T: Read>(&mut self, name: &str, doc: &str, schemas: &mut Schemas) {
        let mut schema = T::schema(schemas);
        describe(&mut schema, doc);
        self.kinds.push(name.to_owned());
        self.order.push(name.to_owned());
        self.properties.insert(name.to_owned(), schema);
    }

    fn finish(self, title: &str, doc: &str) -> Json {
        let mut schema = json!({
            "title": title,
            "description": tidy(doc),
            "type": "object",
            "properties": self.properties,
            "additionalProperties": false,
            ORDER: self.order,
        });
        if !self.required.is_empty() {
            schema["required"] = json!(self.required);
        }
        if !self.kinds.is_empty() && self.fields == 0 {
            // Counting properties instead of `oneOf` keeps the errors of editors at the wrong key.
            schema["minProperties"] = json!(1);
            schema["maxProperties"] = json!(1);
        } else if !self.kinds.is_empty() {
            schema["oneOf"] = self.kinds.iter().map(|kind| json!({ "required": [kind] })).collect();
        }
        schema
    }
}

/// The schema of a type, which an expression may compute too.
#[must_use]
pub(crate) fn or_expression(kind: &str) -> Json {
    json!({ "type": [kind, "string"], "pattern": EXPRESSION })
}

/// The schema of an array that may be computed: written out, an expression, or `{ count, each }`.
#[must_use]
pub(crate) fn array(items: Json) -> Json {
    json!({
        "type": ["array", "object", "string"],
        "pattern": EXPRESSION,
        "items": items,
        "required": ["count", "each"],
        "properties": {
            "count": {
                "type": ["integer", "string"],
                "pattern": EXPRESSION,
                "minimum": 0,
                "description": "How many items to compute.",
            },
            "each": { "description": "What each item is; in its expressions `i` counts from 0." },
        },
        "additionalProperties": false,
    })
}

/// The schema of `length` numbers, or of from `length.0` to `length.1`.
#[must_use]
pub(crate) fn numbers(least: usize, most: usize) -> Json {
    let mut schema = array(or_expression("number"));
    schema["minItems"] = json!(least);
    schema["maxItems"] = json!(most);
    schema
}

/// The schema of a choice among words, each with its meaning.
#[must_use]
pub(crate) fn words(choices: &[(&str, &str)]) -> Json {
    let names: Vec<_> = choices.iter().map(|(name, _)| *name).collect();
    let meanings: Vec<_> = choices.iter().map(|(name, doc)| format!("- `{name}`: {}", tidy(doc))).collect();
    let mut schema = any_of(one_of_words(&names));
    schema["choices"] = json!(meanings);
    schema
}

/// The alternatives of a choice among words: the words, or an expression.
pub(crate) fn one_of_words(words: &[&str]) -> Vec<Json> {
    vec![json!({ "type": "string", "enum": words }), json!({ "type": "string", "pattern": EXPRESSION })]
}

/// One of several schemas that differ in type.
pub(crate) fn any_of(schemas: Vec<Json>) -> Json {
    json!({ "anyOf": schemas })
}

fn describe(schema: &mut Json, doc: &str) {
    let choices = schema.as_object_mut().and_then(|object| object.remove("choices"));
    let mut text = tidy(doc);
    for choice in choices.iter().flat_map(|list| list.as_array().into_iter().flatten()) {
        text.push('\n');
        text.push_str(choice.as_str().unwrap_or_default());
    }
    schema["description"] = json!(text);
}

fn set_default(schema: &mut Json, default: Option<Json>) {
    if let Some(default) = default {
        schema["default"] = default;
    }
}

/// A doc comment without the space that begins each of its lines.
#[must_use]
pub(crate) fn tidy(doc: &str) -> String {
    let lines: Vec<_> = doc.lines().map(|line| line.strip_prefix(' ').unwrap_or(line).trim_end()).collect();
    lines.join("\n").trim().to_owned()
}

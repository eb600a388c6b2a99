//! The JSON Schema of whole documents, for editors: completion, hover texts, errors while typing.

use serde_json::{Map, Value as Json, json};

use crate::language::spec::assertion;
use crate::language::spec::check::Check;
use crate::language::spec::clip::Clip;
use crate::language::spec::collider::Collider;
use crate::language::spec::curve::Curve;
use crate::language::spec::document::{Asset, Unit};
use crate::language::spec::field::FieldDefinition;
use crate::language::spec::import::Up;
use crate::language::spec::limit::LimitFields;
use crate::language::spec::lod::Lod;
use crate::language::spec::map::MapDefinition;
use crate::language::spec::material::Material;
use crate::language::spec::morph::Morphs;
use crate::language::spec::node::Node;
use crate::language::spec::output::Output;
use crate::language::spec::reader::Read;
use crate::language::spec::schema::{ORDER, Schemas};
use crate::language::spec::section::SECTIONS;
use crate::language::spec::shape::ShapeDefinition;
use crate::language::spec::skeleton::Skeleton;
use crate::language::spec::skin::Skin;

/// What a name looks like.
const NAME: &str = "^[a-z][a-z0-9]*(-[a-z0-9]+)*$";

/// Ends the names of schemas that describe a part of a table, as variants write it.
const PARTIAL: &str = "-partial";

/// The JSON Schema (draft 2020-12) of a document. Built anew at each call; not needed to read documents.
#[must_use]
pub fn schema() -> Json {
    let mut schema = ordered();
    if let Some(definitions) = schema["$defs"].as_object_mut() {
        for definition in definitions.values_mut().filter_map(Json::as_object_mut) {
            definition.remove(ORDER);
        }
    }
    schema
}

/// The schema, with the order of properties beside them.
pub(crate) fn ordered() -> Json {
    let mut schemas = Schemas::default();
    let sections: Map<String, Json> = SECTIONS
        .iter()
        .map(|(name, doc)| {
            let mut schema = section(name, &mut schemas);
            schema["description"] = json!(doc);
            ((*name).to_owned(), schema)
        })
        .collect();
    let mut definitions = schemas.into_definitions();
    let partial: Map<String, Json> =
        definitions.iter().map(|(name, schema)| (format!("{name}{PARTIAL}"), partial(schema))).collect();
    definitions.extend(partial);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Kiln document",
        "description": "A declarative model, baked into glTF.",
        "type": "object",
        "properties": sections,
        "additionalProperties": false,
        "$defs": definitions,
    })
}

fn section(name: &str, schemas: &mut Schemas) -> Json {
    match name {
        "unit" => with_default(Unit::schema(schemas), Unit::Metre.written()),
        "up" => with_default(Up::schema(schemas), Up::Y.written()),
        "tolerance" | "motion-tolerance" => {
            let mut number = f64::schema(schemas);
            Check::above(0.0).constrain(&mut number);
            number
        }
        "include" => json!({ "type": "array", "items": { "type": "string" } }),
        "asset" => Asset::schema(schemas),
        "output" => Output::schema(schemas),
        "lod" => Lod::schema(schemas),
        "parameters" => named(json!({ "type": ["number", "boolean", "array", "string"] })),
        "curve" => named(Curve::schema(schemas)),
        "field" => named(FieldDefinition::schema(schemas)),
        "map" => named(MapDefinition::schema(schemas)),
        "shape" => named(ShapeDefinition::schema(schemas)),
        "material" => named(Material::schema(schemas)),
        "node" => named(Node::schema(schemas)),
        "skeleton" => named(Skeleton::schema(schemas)),
        "skin" => named(Skin::schema(schemas)),
        "morph" => named(Morphs::schema(schemas)),
        "clip" => named(Clip::schema(schemas)),
        "collider" => named(Collider::schema(schemas)),
        "assert" => assertion::schema(schemas),
        "limits" => LimitFields::schema(schemas),
        _ => named(variant(schemas)),
    }
}

/// A partial document: every section that may vary, with nothing required.
fn variant(schemas: &mut Schemas) -> Json {
    let varied =
        SECTIONS.iter().map(|(name, _)| *name).filter(|name| !matches!(*name, "include" | "variant"));
    let properties: Map<String, Json> =
        varied.map(|name| (name.to_owned(), partial(&section(name, schemas)))).collect();
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// The schema of a part of what another describes: the same keys, none of them required.
fn partial(schema: &Json) -> Json {
    match schema {
        Json::Object(object) => {
            let generator =
                object.get("properties").is_some_and(|properties| properties.get("each").is_some());
            let keep = |name: &str| {
                generator || !matches!(name, "required" | "oneOf" | "minProperties" | "maxProperties")
            };
            let entry = |(name, value): (&String, &Json)| {
                let value = match (name.as_str(), value.as_str()) {
                    ("$ref", Some(target)) => json!(format!("{target}{PARTIAL}")),
                    _ => partial(value),
                };
                (name.clone(), value)
            };
            Json::Object(object.iter().filter(|(name, _)| keep(name)).map(entry).collect())
        }
        Json::Array(items) => Json::Array(items.iter().map(partial).collect()),
        other => other.clone(),
    }
}

fn named(value: Json) -> Json {
    json!({ "type": "object", "additionalProperties": value, "propertyNames": { "pattern": NAME } })
}

fn with_default(mut schema: Json, default: Option<Json>) -> Json {
    if let Some(object) = schema.as_object_mut() {
        object.remove("choices");
        object.extend(default.map(|default| ("default".to_owned(), default)));
    }
    schema
}

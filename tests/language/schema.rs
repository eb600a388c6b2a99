//! The schema and the reference page say what the reader does.

use kiln::language::{errors, project_schema, reference, schema};
use serde_json::Value as Json;

/// Every `$ref` of a schema.
fn targets<'s>(schema: &'s Json, found: &mut Vec<&'s str>) {
    match schema {
        Json::Object(object) => {
            found.extend(object.get("$ref").and_then(Json::as_str));
            object.values().for_each(|value| targets(value, found));
        }
        Json::Array(items) => items.iter().for_each(|item| targets(item, found)),
        _ => {}
    }
}

#[test]
fn every_reference_of_the_schema_leads_somewhere() {
    let schema = schema();
    let mut found = Vec::new();
    targets(&schema, &mut found);
    assert!(found.len() > 50);
    for target in found {
        let name = target.strip_prefix("#/$defs/").expect("references stay inside");
        assert!(schema["$defs"][name].is_object(), "{target}");
    }
}

#[test]
fn fields_carry_type_bounds_default_and_words_for_artists() {
    let schema = schema();
    let revolve = &schema["$defs"]["revolve"];
    assert_eq!(revolve["required"], serde_json::json!(["profile"]));
    assert_eq!(revolve["additionalProperties"], false);
    let angle = &revolve["properties"]["angle"];
    assert_eq!(angle["type"], serde_json::json!(["number", "string"]));
    assert_eq!((&angle["exclusiveMinimum"], &angle["maximum"]), (&0.0.into(), &360_000.0.into()));
    assert_eq!(angle["default"], 360.0);
    assert_eq!(angle["description"], "How far it is turned, in degrees; more than 360 needs a `rise`.");
    assert_eq!(schema["$defs"]["revolve-partial"].get("required"), None);
    let size = &schema["$defs"]["box"]["properties"]["size"];
    assert_eq!((&size["minItems"], &size["maxItems"]), (&3.into(), &3.into()));
    assert_eq!(size["items"]["exclusiveMinimum"], 0.0);
    assert_eq!(schema["$defs"]["curve"]["maxProperties"], 1);
}

#[test]
fn the_reference_page_lists_every_table_once() {
    let page = reference();
    let schema = schema();
    for name in schema["$defs"].as_object().expect("definitions").keys() {
        if name.ends_with("-partial") || name == "curve" {
            continue;
        }
        assert_eq!(page.matches(&format!("\n### {name}\n")).count(), 1, "{name}");
    }
    assert!(
        page.contains("| `angle` | number > 0, ≤ 360000 | `360` | How far it is turned, in degrees; more than 360 needs a `rise`. |"),
        "{page}"
    );
    assert!(
        page.contains(
            "| `frame` | `\"rotation-minimizing\"`, `\"frenet\"`, `\"up\"` | `\"rotation-minimizing\"` |"
        ),
        "{page}"
    );
    assert!(page.contains("| `smoothstep(from, to, x)` |"));
}

/// The pages and the schemas that editors and readers find in `docs` are those of this build; `KILN_BLESS=1`
/// writes them anew.
#[test]
fn docs_hold_the_generated_pages_and_schemas() {
    let pretty = |schema| serde_json::to_string_pretty(&schema).expect("plain data") + "\n";
    let docs = [
        ("docs/kiln.schema.json", pretty(schema())),
        ("docs/project.schema.json", pretty(project_schema())),
        ("docs/reference.md", reference()),
        ("docs/errors.md", errors()),
    ];
    for (path, text) in docs {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        if std::env::var_os("KILN_BLESS").is_some() {
            std::fs::write(&path, &text).expect("docs can be written");
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(kept == text, "{} is stale; run the tests with KILN_BLESS=1", path.display());
    }
}

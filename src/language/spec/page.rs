//! The reference page, written from the schema: one source for both.

use std::fmt::Write;

use serde_json::{Map, Value as Json};

use crate::language::expression::FUNCTIONS;
use crate::language::spec::project::ordered_project;
use crate::language::spec::schema::ORDER;
use crate::language::spec::section::SECTIONS;
use crate::language::spec::whole::ordered;
use crate::language::value::show_number;

/// The chapters after the first, and the tables that stand in each.
const CHAPTERS: [(&str, &str, &[&str]); 8] = [
    (
        "Curves",
        "A curve is written `[curve.NAME.KIND]`, or in place where a curve is asked for: `{ circle = { radius = 0.005 } }`.",
        &[
            "line",
            "polyline",
            "circle",
            "ellipse",
            "parabola",
            "hyperbola",
            "conic",
            "formula",
            "arc",
            "helix",
            "natural-spline",
            "spline",
            "spline end",
            "function-spline",
            "function end",
            "hermite",
            "catmull-rom",
            "cardinal",
            "kochanek-bartels",
            "bezier",
            "b-spline",
            "nurbs",
            "beta-spline",
            "cubic",
            "subdivision",
            "path",
            "segment",
            "arc segment",
            "implicit",
            "svg",
            "dxf",
            "curve group",
            "part",
            "offset",
            "profile set",
            "fillet",
            "chamfer",
            "reverse",
            "transform",
        ],
    ),
    (
        "Maps",
        "A map is written `[map.NAME]`, for the fields of every map, and `[map.NAME.KIND]`, or in place where a map is asked for.",
        &["map", "map image", "map raw", "map grid", "map points", "map formula", "map noise", "map combine"],
    ),
    (
        "Fields",
        "A field is written `[field.NAME]`, for the fields of every field, and `[field.NAME.KIND]`, or in place where a field is asked for. Simple bodies (`sphere`, `box`, `cylinder`, `capsule`, `torus`, `cone`) are written as shapes of these kinds are.",
        &[
            "field",
            "skeleton field",
            "element",
            "field formula",
            "field quadric",
            "shape field",
            "half space",
            "field join",
            "field sum",
            "perturbed field",
            "bump",
        ],
    ),
    (
        "Shapes",
        "A shape is written `[shape.NAME]`, for the fields of every shape, and `[shape.NAME.KIND]`.",
        &[
            "shape",
            "vertex-color",
            "attribute",
            "occlusion",
            "lightmap",
            "box",
            "sphere",
            "cylinder",
            "cone",
            "capsule",
            "torus",
            "tube",
            "disk",
            "flat plane",
            "polyhedron",
            "geodesic",
            "revolve",
            "axis",
            "extrude",
            "bevel",
            "sweep",
            "profile station",
            "scale station",
            "ruled",
            "loft",
            "loft end",
            "profile",
            "translational",
            "sheet",
            "polygon",
            "wire",
            "patches",
            "bezier triangles",
            "hermite surface",
            "b-spline surface",
            "nurbs surface",
            "coons",
            "coons side",
            "gordon",
            "quadric",
            "quadric within",
            "within",
            "trimmed",
            "joined",
            "height map",
            "base",
            "sphere base",
            "ellipsoid base",
            "cylinder base",
            "surface base",
            "mask",
            "split",
            "split part",
            "parametric",
            "perturbed patches",
            "patch bump",
            "implicit shape",
            "mesh",
            "import",
            "taper",
            "twist",
            "bend",
            "along",
            "displace",
            "copy",
            "mirror",
            "plane",
            "array",
            "group",
            "solid set",
            "solid",
            "cut",
            "hull",
            "minkowski-round",
            "shell",
            "subdivide",
            "crease",
            "sharp corner",
        ],
    ),
    (
        "Materials",
        "",
        &[
            "material",
            "clearcoat",
            "transmission",
            "volume",
            "specular",
            "sheen",
            "iridescence",
            "anisotropy",
            "texture",
        ],
    ),
    (
        "Nodes",
        "A document without nodes shows each shape that no other definition uses.",
        &["node", "node copy", "camera", "light", "scene import"],
    ),
    (
        "Motion",
        "A skeleton is written `[skeleton.NAME.joint.JOINT]`, a skin `[skin.NAME]`, a state of a shape `[morph.SHAPE.TARGET]`, a motion `[clip.NAME]` with `[[clip.NAME.track]]`.",
        &[
            "skeleton",
            "joint",
            "skeleton import",
            "chain",
            "axis ranges",
            "socket",
            "skin",
            "skin weight",
            "skin bump",
            "morph",
            "morph driver",
            "clip",
            "track",
            "key",
            "reach",
            "motion import",
            "event",
        ],
    ),
    (
        "Facts, outputs, assertions and limits",
        "",
        &["asset", "output", "textures", "lod", "collider", "bounds", "limits"],
    ),
];

/// The reference page of the language, as Markdown.
#[must_use]
pub fn reference() -> String {
    let schema = ordered();
    let mut page =
        String::from("# Reference\n\nEvery number may be an expression: a string that begins with `= `.\n");
    page.push_str("Lengths are in the document's unit, angles in degrees.\n\n## A document\n\n");
    let rows = SECTIONS.iter().map(|(name, doc)| format!("| `{name}` | {doc} |\n"));
    page.push_str("| key | meaning |\n| --- | --- |\n");
    page.extend(rows);
    for (title, intro, tables) in CHAPTERS {
        let _ = write!(page, "\n## {title}\n");
        if !intro.is_empty() {
            let _ = write!(page, "\n{intro}\n");
        }
        for name in tables {
            page.push_str(&table(name, &schema["$defs"][name]));
        }
    }
    page.push_str(&expressions());
    let project = ordered_project();
    page.push_str(
        "\n## A project\n\nWhat stands in `kiln.toml`; `kiln bake` without paths bakes all of it.\n",
    );
    for name in ["project", "cache", "remote cache", "project limits"] {
        page.push_str(&table(name, &project["$defs"][name]));
    }
    page
}

fn table(name: &str, schema: &Json) -> String {
    let mut text = format!("\n### {name}\n\n{}\n", schema["description"].as_str().unwrap_or_default());
    let Some(order) = schema[ORDER].as_array() else { return text };
    let required = schema["required"].as_array().map(Vec::as_slice).unwrap_or_default();
    text.push_str("\n| key | type | default | meaning |\n| --- | --- | --- | --- |\n");
    for key in order.iter().filter_map(Json::as_str) {
        let field = &schema["properties"][key];
        let default = match field.get("default") {
            Some(default) => format!("`{}`", toml(default)),
            None if required.iter().any(|name| name == key) => "required".to_owned(),
            None => String::new(),
        };
        let meaning = cell(field["description"].as_str().unwrap_or_default());
        let _ = writeln!(text, "| `{key}` | {} | {default} | {meaning} |", kind(field));
    }
    text
}

/// A description in one line of a table: choices after it, with semicolons.
fn cell(description: &str) -> String {
    let mut lines = description.split("\n- ");
    let first = lines.next().unwrap_or_default().replace('\n', " ");
    let choices: Vec<_> = lines.map(|line| line.trim_end_matches('.').replace('\n', " ")).collect();
    let list = if choices.is_empty() { String::new() } else { format!(" {}.", choices.join("; ")) };
    format!("{first}{list}").replace('|', "\\|")
}

fn kind(schema: &Json) -> String {
    if let Some(target) = schema["$ref"].as_str() {
        return format!("table `{}`", target.trim_start_matches("#/$defs/"));
    }
    if let Some(alternatives) = schema["anyOf"].as_array() {
        let kinds =
            alternatives.iter().filter(|schema| schema["pattern"] != "^= " || schema["type"] != "string");
        return kinds.map(kind).collect::<Vec<_>>().join(" or ");
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
    }
    let names: Vec<&str> = match &schema["type"] {
        Json::Array(names) => names.iter().filter_map(Json::as_str).collect(),
        name => name.as_str().into_iter().collect(),
    };
    let object = schema.as_object();
    let plain = |name: &&str| match *name {
        "string" if names.len() > 1 => schema["pattern"].as_str().is_some_and(|pattern| pattern != "^= "),
        "object" => !names.contains(&"array"),
        _ => true,
    };
    let described = names.iter().filter(|name| plain(name)).map(|name| describe(name, schema, object));
    described.collect::<Vec<_>>().join(" or ")
}

fn describe(name: &str, schema: &Json, object: Option<&Map<String, Json>>) -> String {
    match name {
        "number" | "integer" => {
            let word = if name == "integer" { "whole number" } else { name };
            object.map_or(word.to_owned(), |object| format!("{word}{}", bounds(object)))
        }
        "boolean" => "true or false".to_owned(),
        "array" => {
            let item = kind(&schema["items"]);
            let nested = item.starts_with(|letter: char| letter.is_ascii_digit());
            let plural =
                if nested { format!("lists of {item}") } else { item.replacen("number", "numbers", 1) };
            match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
                (Some(least), Some(most)) if least == most => format!("{least} {plural}"),
                (Some(least), Some(most)) => format!("{least} or {most} {plural}"),
                (Some(least), None) => format!("list of at least {least} ({item})"),
                _ => format!("list of ({item})"),
            }
        }
        "object" => match schema.get("additionalProperties") {
            Some(value) if value.is_object() => format!("table of ({})", kind(value)),
            _ => "table".to_owned(),
        },
        name => name.to_owned(),
    }
}

fn bounds(object: &Map<String, Json>) -> String {
    let number = |key: &str| object.get(key).and_then(Json::as_f64).map(show_number);
    let low = number("exclusiveMinimum").map(|bound| format!("> {bound}"));
    let least = number("minimum").map(|bound| format!("≥ {bound}"));
    let most = number("maximum").map(|bound| format!("≤ {bound}"));
    let zero = object.get("not").map(|_| "not 0".to_owned());
    let all: Vec<_> = [low, least, most, zero].into_iter().flatten().collect();
    if all.is_empty() { String::new() } else { format!(" {}", all.join(", ")) }
}

fn toml(value: &Json) -> String {
    match value {
        Json::Number(number) => number.as_f64().map_or_else(|| number.to_string(), show_number),
        Json::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Json::Object(_) => "{}".to_owned(),
        other => other.to_string(),
    }
}

fn expressions() -> String {
    let mut text = String::from(
        "\n## Expressions\n\nA string that begins with `= ` is computed. It may use numbers, `true`, `false`, `'text'`, \
         points `[x, y]`, names of `[parameters]`, `pi`, brackets and, from loose to tight: `or`, `and`, `not`, \
         `== != < <= > >=`, `+ -`, `* / %`, a sign, `^`. `+` and `-` between operands need spaces on both sides, since \
         `-` may be part of a name. Points are added, subtracted, multiplied by numbers; `p.x` is a part of one. The \
         remainder `%` has the sign of the divisor. A list may be computed: in `{ count = 24, each = \"= [i, sin(i * 15)]\" }` \
         `i` counts from 0.\n\n| function | value |\n| --- | --- |\n",
    );
    for function in FUNCTIONS {
        let _ = writeln!(text, "| `{}` | {} |", function.usage, function.doc);
    }
    text
}

//! `kiln inspect`: what is in a `.glb` file, measured on its bytes.

use serde_json::{Value, json};

use super::Outcome;
use super::arguments::{Format, Inspect};
use super::output::Printer;
use crate::gltf;
use crate::packing::unpacked;
use crate::project::reason;
use crate::report::{line_facts, mesh_facts};

pub(crate) fn run(inspect: &Inspect, printer: &Printer) -> Outcome {
    let bytes = match std::fs::read(&inspect.file) {
        Ok(bytes) => bytes,
        Err(error) => {
            printer.failure(&format!("{}: {}", inspect.file.display(), reason(&error)), None);
            return Outcome::Files;
        }
    };
    let mut object = match facts(&bytes) {
        Ok(object) => object,
        Err(message) => {
            printer.failure(&format!("{}: {message}", inspect.file.display()), None);
            return Outcome::Errors;
        }
    };
    object["file"] = Value::from(inspect.file.display().to_string());
    match printer.format {
        Format::Json => printer.raw(&format!("{object}\n")),
        Format::Text | Format::Github => {
            let text = serde_json::to_string_pretty(&object).unwrap_or_default();
            printer.raw(&format!("{text}\n"));
        }
    }
    Outcome::Good
}

/// What is in the bytes of a file, as an object; or why they cannot be read.
pub(super) fn facts(bytes: &[u8]) -> Result<Value, String> {
    let plain = unpacked(bytes).map_err(|error| error.to_string())?;
    let file = gltf::read(&plain).map_err(|error| error.to_string())?;
    let mut meshes = serde_json::Map::new();
    for (index, geometry) in file.geometries.iter().enumerate() {
        let name = file.root.meshes[index].name.clone().unwrap_or_else(|| format!("mesh {index}"));
        let mut facts = match mesh_facts(geometry) {
            Ok(facts) => serde_json::to_value(facts).unwrap_or(Value::Null),
            Err(error) => Value::from(error.to_string()),
        };
        if let (Some(facts), Some(lines)) = (facts.as_object_mut(), line_facts(geometry)) {
            facts.insert("lines".to_owned(), serde_json::to_value(lines).unwrap_or(Value::Null));
        }
        meshes.insert(name, facts);
    }
    Ok(json!({
        "bytes": bytes.len(),
        "blake3": blake3::hash(bytes).to_hex().to_string(),
        "generator": file.root.asset.generator,
        "nodes": file.root.nodes.len(),
        "materials": file.root.materials.len(),
        "images": file.root.images.len(),
        "meshes": meshes,
    }))
}

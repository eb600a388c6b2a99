//! Files with compressed buffers into files without.

use std::borrow::Cow;

use serde_json::{Map, Value, json};
use thiserror::Error;

use super::codec::{Codec, decode_attributes, decode_sequence, decode_triangles};
use super::filter::Filter;

/// The extension that a bake writes.
pub const EXTENSION: &str = Codec::Zero.extension();

/// The extensions that are read.
pub const EXTENSIONS: [&str; 2] = [EXTENSION, Codec::One.extension()];

/// Plain bytes for each byte of a file, at most.
pub const MOST_RATIO: usize = 128;

/// Why a file cannot be unpacked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnpackError {
    /// Not a `.glb` file, or cut off.
    #[error("it is not a whole .glb file: {0}")]
    Container(String),
    /// The JSON is not what it should be.
    #[error("its JSON is not a glTF document: {0}")]
    Json(String),
    /// A view is broken.
    #[error("buffer view {0} cannot be unpacked: {1}")]
    View(usize, &'static str),
}

/// The file with all its buffer views plain; itself where none is compressed.
///
/// Nothing else in it is changed, whether it is understood here or not. Linear in the bytes of the result, which are
/// hardly more than 128 times those of the file.
///
/// # Errors
/// When the file is broken.
pub fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, UnpackError> {
    let file = container(bytes)?;
    let named = |name: &str| file.json.windows(name.len()).any(|part| part == name.as_bytes());
    if !EXTENSIONS.into_iter().any(named) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut root = root(&file)?;
    let binary = file.bin.as_deref().unwrap_or_default();
    let mut plain = Vec::new();
    for (index, view) in
        root.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten().enumerate()
    {
        let view = view.as_object_mut().ok_or(UnpackError::View(index, "it is no object"))?;
        unpack(view, binary, &mut plain).map_err(|fault| UnpackError::View(index, fault))?;
        // Views that share their bytes could ask for any amount together.
        if plain.len() / MOST_RATIO > bytes.len() {
            return Err(UnpackError::View(index, "with those before it, it is more than the file can hold"));
        }
    }
    for list in ["extensionsUsed", "extensionsRequired"] {
        let left = root.get_mut(list).and_then(Value::as_array_mut).map(|names| {
            names.retain(|name| !EXTENSIONS.into_iter().any(|packs| name == packs));
            names.len()
        });
        if left == Some(0) {
            root.remove(list);
        }
    }
    plain.resize(plain.len().next_multiple_of(4), 0);
    root.insert("buffers".to_owned(), json!([{ "byteLength": plain.len() }]));
    let mut json = serde_json::to_vec(&root).map_err(|error| UnpackError::Json(error.to_string()))?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let whole = gltf::Glb {
        header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
        json: Cow::Owned(json),
        bin: Some(Cow::Owned(plain)),
    };
    whole.to_vec().map(Cow::Owned).map_err(|error| UnpackError::Container(error.to_string()))
}

/// For each buffer view how many bytes of the file it takes, compressed or not.
///
/// # Errors
/// When the file is broken.
pub fn stored_lengths(bytes: &[u8]) -> Result<Vec<u64>, UnpackError> {
    let root = root(&container(bytes)?)?;
    let length = |(index, view): (usize, &Value)| {
        let own = view.get("extensions");
        let packed = own.and_then(|all| EXTENSIONS.into_iter().find_map(|name| all.get(name)));
        let length = packed.unwrap_or(view).get("byteLength").and_then(Value::as_u64);
        length.ok_or(UnpackError::View(index, "it has no length"))
    };
    root.get("bufferViews").and_then(Value::as_array).into_iter().flatten().enumerate().map(length).collect()
}

fn container(bytes: &[u8]) -> Result<gltf::Glb<'_>, UnpackError> {
    gltf::Glb::from_slice(bytes).map_err(|error| UnpackError::Container(error.to_string()))
}

fn root(file: &gltf::Glb<'_>) -> Result<Map<String, Value>, UnpackError> {
    match serde_json::from_slice(&file.json) {
        Ok(Value::Object(root)) => Ok(root),
        Ok(_) => Err(UnpackError::Json("it is no object".to_owned())),
        Err(error) => Err(UnpackError::Json(error.to_string())),
    }
}

/// Appends the plain bytes of a view and makes the view one of them.
fn unpack(view: &mut Map<String, Value>, binary: &[u8], plain: &mut Vec<u8>) -> Result<(), &'static str> {
    let own = view.get_mut("extensions").and_then(Value::as_object_mut);
    let packed = own.and_then(|own| EXTENSIONS.into_iter().find_map(|name| own.remove(name)));
    if view.get("extensions").and_then(Value::as_object).is_some_and(Map::is_empty) {
        view.remove("extensions");
    }
    plain.resize(plain.len().next_multiple_of(4), 0);
    let start = plain.len();
    match packed {
        None => plain.extend_from_slice(part(view, binary)?),
        Some(Value::Object(packed)) => plain.extend(decoded(&packed, part(&packed, binary)?)?),
        Some(_) => return Err("its extension is no object"),
    }
    view.insert("buffer".to_owned(), json!(0));
    view.insert("byteOffset".to_owned(), json!(start));
    view.insert("byteLength".to_owned(), json!(plain.len() - start));
    Ok(())
}

fn number(of: &Map<String, Value>, name: &str) -> Option<usize> {
    of.get(name)?.as_u64().and_then(|number| usize::try_from(number).ok())
}

/// The bytes that a view, or its extension, names.
fn part<'a>(of: &Map<String, Value>, binary: &'a [u8]) -> Result<&'a [u8], &'static str> {
    if number(of, "buffer") != Some(0) {
        return Err("its data is outside the file");
    }
    let (start, length) =
        (number(of, "byteOffset").unwrap_or(0), number(of, "byteLength").ok_or("it has no length")?);
    let end = start.checked_add(length);
    end.and_then(|end| binary.get(start..end)).ok_or("it reaches past the end of the data")
}

/// The plain bytes of a view, of what its extension says of them and its compressed bytes. Linear in the result, which is
/// hardly more than 128 times as long.
///
/// # Errors
/// What is wrong with them.
pub fn decoded(packed: &Map<String, Value>, encoded: &[u8]) -> Result<Vec<u8>, &'static str> {
    let text = |name: &str| packed.get(name).and_then(Value::as_str);
    let count = number(packed, "count").ok_or("it has no count")?;
    let stride = number(packed, "byteStride").ok_or("it has no stride")?;
    let broken = "its bytes are broken";
    let indices = |all: Option<Vec<u32>>| match stride {
        2 => {
            let short = |index: u32| u16::try_from(index).ok().map(u16::to_le_bytes);
            let all: Option<Vec<[u8; 2]>> = all.ok_or(broken)?.into_iter().map(short).collect();
            Ok(all.ok_or(broken)?.into_flattened())
        }
        4 => Ok(all.ok_or(broken)?.into_iter().flat_map(u32::to_le_bytes).collect()),
        _ => Err("its indices have neither 2 nor 4 bytes"),
    };
    match text("mode") {
        Some("ATTRIBUTES") => {
            let mut bytes = decode_attributes(encoded, count, stride).ok_or(broken)?;
            match text("filter").unwrap_or("NONE") {
                "NONE" => {}
                name => {
                    let filter = Filter::named(name).ok_or("its filter is unknown")?;
                    if !filter.undo(&mut bytes, stride) {
                        return Err("its filter has another stride");
                    }
                }
            }
            Ok(bytes)
        }
        Some("TRIANGLES") => indices(decode_triangles(encoded, count)),
        Some("INDICES") => indices(decode_sequence(encoded, count)),
        _ => Err("its mode is unknown"),
    }
}

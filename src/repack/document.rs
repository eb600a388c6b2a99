//! The document and its bytes: the JSON as it is, its buffers, and its buffer views without compression.

use std::borrow::Cow;
use std::fmt;

use rayon::prelude::{IntoParallelRefIterator as _, ParallelIterator as _};
use serde_json::{Map, Value};

use crate::import::gltf::buffer_of;
use crate::packing::{EXTENSIONS, MOST_RATIO, decoded};

/// Bytes of a file, or made of them.
pub(super) type Bytes<'a> = Cow<'a, [u8]>;

/// A document, or an object in it.
pub(super) type Object = Map<String, Value>;

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where in the JSON it stands (RFC 6901), as in `/meshes/0/primitives/1`; empty where it is the whole file.
    pub path: String,
    /// What is wrong.
    pub message: String,
}

impl Fault {
    pub(super) fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), message: message.into() }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let colon = if self.path.is_empty() { "" } else { ": " };
        write!(formatter, "{}{colon}{}", self.path, self.message)
    }
}

impl std::error::Error for Fault {}

/// The JSON of a file and, of a `.glb`, its binary chunk.
pub(super) fn parse(bytes: &[u8]) -> Result<(Value, Option<Bytes<'_>>), Fault> {
    let (json, binary) = if bytes.starts_with(b"glTF") {
        let file = gltf::Glb::from_slice(bytes)
            .map_err(|error| Fault::new("", format!("it is not a whole .glb file: {error}")))?;
        (file.json, file.bin)
    } else {
        (Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)), None)
    };
    match serde_json::from_slice(&json) {
        Ok(root) => Ok((root, binary)),
        Err(error) => Err(Fault::new("", format!("it is neither glTF nor JSON: {error}"))),
    }
}

/// The objects of a list of the document; none where it has no such list.
pub(super) fn list<'a>(of: &'a Object, name: &str) -> &'a [Value] {
    of.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// As [`list`], to change.
pub(super) fn list_mut<'a>(of: &'a mut Object, name: &str) -> &'a mut [Value] {
    of.get_mut(name).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
}

/// A whole number of an object.
pub(super) fn whole(of: &Value, name: &str) -> Option<usize> {
    of.get(name).and_then(as_index)
}

/// A value as an index or a count.
pub(super) fn as_index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|number| usize::try_from(number).ok())
}

/// The bytes of all buffers; none for those that only stand for compressed ones.
pub(super) fn buffers<'a>(
    root: &Object,
    binary: Option<Bytes<'a>>,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Vec<Bytes<'a>>, Fault> {
    let mut binary = binary;
    let one = |(index, buffer): (usize, &Value)| {
        let path = || format!("/buffers/{index}");
        let length = whole(buffer, "byteLength").unwrap_or(0);
        let data = match buffer.get("uri").and_then(Value::as_str) {
            Some(uri) => Cow::Owned(
                buffer_of(index, uri, open)
                    .map_err(|fault| Fault::new(format!("{}/uri", path()), fault.to_string()))?,
            ),
            None if index == 0 && binary.is_some() => binary.take().unwrap_or_default(),
            None if packing(buffer).is_some() => return Ok(Cow::Borrowed(&[][..])),
            None => return Err(Fault::new(path(), "it has no data: neither a `uri` nor a binary chunk")),
        };
        if data.len() < length {
            let message = format!("it has {} bytes, and should have {length}", data.len());
            return Err(Fault::new(path(), message));
        }
        Ok(data)
    };
    list(root, "buffers").iter().enumerate().map(one).collect()
}

/// What one of the extensions that compress says of a buffer or a view.
pub(super) fn packing(of: &Value) -> Option<&Value> {
    let own = of.get("extensions")?;
    EXTENSIONS.into_iter().find_map(|name| own.get(name))
}

/// The plain bytes of all views.
pub(super) fn views<'a>(root: &Object, buffers: &'a [Bytes<'a>]) -> Result<Vec<Bytes<'a>>, Fault> {
    let views = list(root, "bufferViews");
    check_amount(views, buffers)?;
    let all: Vec<(usize, &Value)> = views.iter().enumerate().collect();
    all.par_iter().map(|(index, view)| plain(*index, view, buffers)).collect()
}

/// Views that share their bytes could ask for any amount together.
fn check_amount(views: &[Value], buffers: &[Bytes<'_>]) -> Result<(), Fault> {
    let held: usize = buffers.iter().map(|buffer| buffer.len()).sum();
    let mut asked: usize = 0;
    for (index, packed) in views.iter().enumerate().filter_map(|(index, view)| Some((index, packing(view)?)))
    {
        let count = whole(packed, "count").unwrap_or(0);
        asked = asked.saturating_add(count.saturating_mul(whole(packed, "byteStride").unwrap_or(0)));
        if asked / MOST_RATIO > held {
            let message = "with those before it, it claims to hold more than the file can";
            return Err(Fault::new(format!("/bufferViews/{index}"), message));
        }
    }
    Ok(())
}

fn plain<'a>(index: usize, view: &Value, buffers: &'a [Bytes<'a>]) -> Result<Bytes<'a>, Fault> {
    let wrong = |message: &str| Fault::new(format!("/bufferViews/{index}"), message);
    let part = |of: &Value| {
        let buffer = buffers.get(whole(of, "buffer")?)?;
        let start = whole(of, "byteOffset").unwrap_or(0);
        buffer.get(start..start.checked_add(whole(of, "byteLength")?)?)
    };
    let outside = "it reaches past the end of its buffer";
    match packing(view) {
        None => part(view).map(Cow::Borrowed).ok_or_else(|| wrong(outside)),
        Some(packed) => {
            let own = packed.as_object().ok_or_else(|| wrong("its extension is no object"))?;
            let bytes = decoded(own, part(packed).ok_or_else(|| wrong(outside))?).map_err(wrong)?;
            if Some(bytes.len()) != whole(view, "byteLength") {
                return Err(wrong("it has another length than what is compressed in it"));
            }
            Ok(Cow::Owned(bytes))
        }
    }
}

//! Pictures into the file: those in text or beside it, too. One that is there twice is written once.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::accessor::Source;
use super::document::{Fault, Object, list, list_mut, whole};
use super::pin::Pins;
use super::stream::Output;
use super::{Options, texture};
use crate::import::gltf::buffer_of;

/// Pictures, in memory.
pub(super) struct Pictures {
    /// For each one its bytes, if they stand in a text or another file.
    own: Vec<Option<Vec<u8>>>,
    /// Bytes that were read of other files.
    pub(super) read: u64,
}

/// Reads the pictures that stand in texts or other files; those on other machines stay there.
pub(super) fn read(
    root: &Object,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
    notes: &mut Vec<String>,
) -> Result<Pictures, Fault> {
    let mut read = 0;
    let mut one = |(index, image): (usize, &Value)| {
        let Some(uri) = image.get("uri").and_then(Value::as_str) else { return Ok(None) };
        let inside = uri.starts_with("data:");
        if !inside && uri.contains("://") {
            return Ok(None);
        }
        let bytes = match buffer_of(index, uri, open) {
            Ok(bytes) => bytes,
            Err(_) if inside => {
                return Err(Fault::new(
                    format!("/images/{index}/uri"),
                    "the picture is not written in base64",
                ));
            }
            Err(_) => {
                let shown: String = uri.chars().take(60).collect();
                notes.push(format!("picture {index} is named as before: the file `{shown}` cannot be read"));
                return Ok(None);
            }
        };
        if mime(&bytes, image).is_none() {
            notes.push(format!("picture {index} stays where it is: it is of no kind that a file can hold"));
            return Ok(None);
        }
        if !inside {
            read += bytes.len() as u64;
        }
        Ok(Some(bytes))
    };
    let own: Result<Vec<_>, Fault> = list(root, "images").iter().enumerate().map(&mut one).collect();
    Ok(Pictures { own: own?, read })
}

/// What kind of picture bytes are, by how they begin, or as the document says.
fn mime(bytes: &[u8], image: &Value) -> Option<String> {
    let known: [(&[u8], &str); 3] =
        [(b"\x89PNG", "image/png"), (b"\xff\xd8\xff", "image/jpeg"), (b"\xabKTX 20\xbb", "image/ktx2")];
    let found = known.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, name)| (*name).to_owned());
    let webp =
        (bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP")).then(|| "image/webp".to_owned());
    found.or(webp).or_else(|| image.get("mimeType").and_then(Value::as_str).map(str::to_owned))
}

/// Writes the pictures, as small as is asked for.
///
/// # Errors
/// A picture that is broken and was to be made smaller.
pub(super) fn write(
    made: &mut Object,
    (source, pins): (&Source<'_>, &Pins),
    (pictures, options): (Pictures, &Options),
    output: &mut Output,
) -> Result<(), Fault> {
    let uses = texture::uses(source.root);
    let mut known: HashMap<Vec<u8>, usize> = HashMap::new();
    for (index, (image, own)) in list_mut(made, "images").iter_mut().zip(pictures.own).enumerate() {
        let Some(image) = image.as_object_mut() else { continue };
        let number = whole(&Value::Object(image.clone()), "bufferView");
        let (bytes, told) = match (own, number) {
            (Some(bytes), _) => {
                let kind = mime(&bytes, &Value::Object(image.clone())).unwrap_or_default();
                image.remove("uri");
                image.insert("mimeType".to_owned(), json!(kind));
                (bytes, Object::new())
            }
            (None, Some(view)) if pins.views.contains(&view) => continue,
            (None, Some(view)) => {
                let told = list(source.root, "bufferViews")[view].as_object().cloned().unwrap_or_default();
                let named = told.into_iter().filter(|(name, _)| ["name", "extras"].contains(&name.as_str()));
                (source.views[view].to_vec(), named.collect())
            }
            (None, None) => continue,
        };
        let bytes = match texture::fit((index, &bytes), uses[index], options)? {
            Some(smaller) => {
                image.insert("mimeType".to_owned(), json!("image/png"));
                smaller
            }
            None => bytes,
        };
        let view = match known.get(&bytes) {
            Some(view) => *view,
            None => {
                let view = output.plain(bytes.clone(), told);
                known.insert(bytes, view);
                view
            }
        };
        image.insert("bufferView".to_owned(), json!(view));
    }
    Ok(())
}

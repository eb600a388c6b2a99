//! What pictures are for: how they are made smaller depends on it.

use serde_json::Value;

use super::document::{Object, as_index, list, whole};
use super::{Fault, Options};
use crate::import::image::{Edge, Meaning, Wish, fitted};

/// The most pixels of a picture that is decoded.
const MOST_PIXELS: u64 = 1 << 28;

/// What a picture means, and how it goes on beyond its borders.
pub(super) type Use = (Meaning, [Edge; 2]);

/// For each picture what it is for; numbers where no material shows it.
pub(super) fn uses(root: &Object) -> Vec<Use> {
    let mut found: Vec<Option<Use>> = vec![None; list(root, "images").len()];
    for material in list(root, "materials") {
        visit(root, material, &mut found);
    }
    found.into_iter().map(|one| one.unwrap_or((Meaning::Data, [Edge::Repeat; 2]))).collect()
}

fn visit(root: &Object, value: &Value, found: &mut [Option<Use>]) {
    for (name, inner) in value.as_object().into_iter().flatten().filter(|(name, _)| *name != "extras") {
        if name.ends_with("Texture") {
            let texture = inner.get("index").and_then(as_index).and_then(|at| list(root, "textures").get(at));
            let image = texture.and_then(|texture| found.get_mut(whole(texture, "source")?));
            if let (Some(texture), Some(known)) = (texture, image) {
                let meaning = meaning(name);
                // Colors are told by the eye: what is one of them as well is made smaller as one.
                let meaning = match *known {
                    Some((other, _)) if other == Meaning::Color || meaning == Meaning::Data => other,
                    _ => meaning,
                };
                *known = Some((meaning, edges(root, texture)));
            }
        }
        visit(root, inner, found);
    }
}

/// By the names that the format and its extensions give to textures.
fn meaning(name: &str) -> Meaning {
    match name {
        "baseColorTexture"
        | "emissiveTexture"
        | "diffuseTexture"
        | "specularGlossinessTexture"
        | "specularColorTexture"
        | "sheenColorTexture"
        | "diffuseTransmissionColorTexture" => Meaning::Color,
        "normalTexture" | "clearcoatNormalTexture" => Meaning::Normal,
        _ => Meaning::Data,
    }
}

fn edges(root: &Object, texture: &Value) -> [Edge; 2] {
    let sampler = whole(texture, "sampler").and_then(|at| list(root, "samplers").get(at));
    ["wrapS", "wrapT"].map(|name| match sampler.and_then(|sampler| whole(sampler, name)) {
        Some(33071) => Edge::Clamp,
        Some(33648) => Edge::Mirror,
        _ => Edge::Repeat,
    })
}

/// A picture as it is asked for; `None` where it stays as it is.
///
/// # Errors
/// When it is a broken PNG or JPEG.
pub(super) fn fit(
    (index, bytes): (usize, &[u8]),
    (meaning, edges): Use,
    options: &Options,
) -> Result<Option<Vec<u8>>, Fault> {
    let wish = Wish { most: options.texture_size, compress: options.compress_textures };
    let read = bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xff\xd8\xff");
    if !read || (wish.most.is_none() && !wish.compress) {
        return Ok(None);
    }
    fitted(bytes, (meaning, edges), wish, MOST_PIXELS)
        .map_err(|error| Fault::new(format!("/images/{index}"), error.to_string()))
}

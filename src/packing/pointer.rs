//! Channels of animations that point at properties (`KHR_animation_pointer`) and name no node.
//!
//! Promise: what the document types of the library cannot hold is taken out of a document's text and told; channels that
//! point at the place or the weights of a node become channels of that node. Not promised: that a pointer points at
//! anything, or a sampler exists.
//!
//! Source: Khronos Group, `KHR_animation_pointer`, 2024; glTF 2.0 Specification, 2021, section 3.11 (a channel without a node
//! is left out where no extension says what it moves).

use serde_json::{Value, json};

/// The extension.
pub const POINTER: &str = "KHR_animation_pointer";

/// A channel that points at a property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointerChannel {
    /// The animation.
    pub animation: usize,
    /// The sampler of that animation.
    pub sampler: usize,
    /// The JSON pointer.
    pub path: String,
}

/// A document's text without the channels that name no node, and what those point at; none where there are no such channels.
#[must_use]
pub fn without_pointers(json: &[u8]) -> Option<(Vec<u8>, Vec<PointerChannel>)> {
    let mut root: Value = serde_json::from_slice(json).ok()?;
    let (mut found, mut changed) = (Vec::new(), false);
    let animations = root.get_mut("animations").and_then(Value::as_array_mut);
    for (animation, own) in animations.into_iter().flatten().enumerate() {
        let Some(channels) = own.get_mut("channels").and_then(Value::as_array_mut) else { continue };
        channels.retain_mut(|channel| {
            if channel["target"].get("node").is_some() {
                return true;
            }
            changed = true;
            let path = channel["target"]["extensions"][POINTER]["pointer"].as_str().map(str::to_owned);
            let sampler = channel["sampler"].as_u64().and_then(|sampler| usize::try_from(sampler).ok());
            let (Some(path), Some(sampler)) = (path, sampler) else { return false };
            if let Some((node, part)) = of_node(&path) {
                channel["target"] = json!({ "node": node, "path": part });
                return true;
            }
            found.push(PointerChannel { animation, sampler, path });
            false
        });
    }
    if !changed {
        return None;
    }
    Some((serde_json::to_vec(&root).ok()?, found))
}

/// The node and the part of it that a pointer names, where a plain channel can.
fn of_node(path: &str) -> Option<(u32, &str)> {
    let (node, part) = path.strip_prefix("/nodes/")?.split_once('/')?;
    let part = ["translation", "rotation", "scale", "weights"].into_iter().find(|known| *known == part)?;
    Some((node.parse().ok()?, part))
}

#[cfg(test)]
mod tests {
    use super::{PointerChannel, without_pointers};

    #[test]
    fn what_names_no_node_is_told() {
        let text = r#"{"animations":[{"samplers":[],"channels":[
            {"sampler":0,"target":{"node":1,"path":"scale"}},
            {"sampler":1,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/2/emissiveFactor"}}}},
            {"sampler":2,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/nodes/3/rotation"}}}},
            {"sampler":3,"target":{"path":"translation"}}]}]}"#;
        let (rest, found) = without_pointers(text.as_bytes()).expect("there are some");
        let path = "/materials/2/emissiveFactor".to_owned();
        assert_eq!(found, [PointerChannel { animation: 0, sampler: 1, path }]);
        let rest: serde_json::Value = serde_json::from_slice(&rest).expect("JSON");
        let channels = rest["animations"][0]["channels"].as_array().expect("channels");
        assert_eq!(channels.len(), 2);
        assert_eq!(channels[1]["target"], serde_json::json!({ "node": 3, "path": "rotation" }));
        assert_eq!(without_pointers(b"{\"animations\":[]}"), None);
        assert_eq!(without_pointers(b"{"), None);
    }
}

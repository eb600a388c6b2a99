//! That a document is what the specification says, as far as what follows takes it for granted.
//!
//! Promise: after it, every index that the document itself uses names something, lists are lists of objects, numbers are
//! numbers, nodes form trees, and attributes of a primitive have one length. Not promised: all else that the Khronos
//! validator asks for; what extensions say is not looked at.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021.

use serde_json::Value;

use super::document::{Fault, Object, as_index, list, whole};

/// A value with the way to it.
#[derive(Clone, Copy)]
struct At<'a> {
    value: &'a Value,
    key: Key<'a>,
    above: Option<&'a Self>,
}

#[derive(Clone, Copy)]
enum Key<'a> {
    Name(&'a str),
    Place(usize),
}

impl<'a> At<'a> {
    fn path(&self) -> String {
        let before = self.above.map_or_else(String::new, At::path);
        match self.key {
            Key::Name(name) => format!("{before}/{}", name.replace('~', "~0").replace('/', "~1")),
            Key::Place(place) => format!("{before}/{place}"),
        }
    }

    fn fault<T>(&self, message: impl Into<String>) -> Result<T, Fault> {
        Err(Fault::new(self.path(), message))
    }

    /// What stands under a name, if anything does.
    fn get(&'a self, name: &'a str) -> Option<Self> {
        let value = self.value.get(name)?;
        Some(At { value, key: Key::Name(name), above: Some(self) })
    }

    fn need(&'a self, name: &'a str) -> Result<Self, Fault> {
        self.get(name).map_or_else(|| self.fault(format!("`{name}` is missing")), Ok)
    }

    /// The members of a list.
    fn items(&'a self) -> Result<impl Iterator<Item = At<'a>>, Fault> {
        let Some(all) = self.value.as_array() else { return self.fault("it is no list") };
        let item = |(place, value)| At { value, key: Key::Place(place), above: Some(self) };
        Ok(all.iter().enumerate().map(item))
    }

    /// The members of an object.
    fn members(&'a self) -> Result<impl Iterator<Item = At<'a>>, Fault> {
        let Some(all) = self.value.as_object() else { return self.fault("it is no object") };
        Ok(all.iter().map(|(name, value)| At { value, key: Key::Name(name), above: Some(self) }))
    }

    fn whole(&self) -> Result<usize, Fault> {
        as_index(self.value).map_or_else(|| self.fault(format!("{} is no index or count", self.value)), Ok)
    }

    /// An index into a list of the document.
    fn index(&self, root: &Object, name: &str) -> Result<usize, Fault> {
        let index = self.whole()?;
        let length = list(root, name).len();
        if index < length {
            return Ok(index);
        }
        self.fault(format!("{index} is not below {length}, the number of `{name}`"))
    }

    fn one_of(&self, known: &[usize]) -> Result<usize, Fault> {
        let found = self.whole()?;
        if known.contains(&found) { Ok(found) } else { self.fault(format!("{found} is none of {known:?}")) }
    }

    /// So many finite numbers.
    fn numbers(&self, count: usize) -> Result<(), Fault> {
        let finite = |value: &Value| value.as_f64().is_some_and(f64::is_finite);
        match self.value.as_array() {
            Some(all) if all.len() == count && all.iter().all(finite) => Ok(()),
            _ => self.fault(format!("it is not {count} numbers")),
        }
    }
}

/// Bytes of the components of accessors by the numbers of their types.
const COMPONENTS: [usize; 6] = [5120, 5121, 5122, 5123, 5125, 5126];

/// Lists of the document, whose members are objects.
const LISTS: [&str; 13] = [
    "accessors",
    "animations",
    "bufferViews",
    "buffers",
    "cameras",
    "images",
    "materials",
    "meshes",
    "nodes",
    "samplers",
    "scenes",
    "skins",
    "textures",
];

/// Checks a document. Linear in its JSON.
pub(super) fn check(own: &Object) -> Result<(), Fault> {
    // The way to a member of the document begins with its name.
    let member =
        |name: &'static str| own.get(name).map(|value| At { value, key: Key::Name(name), above: None });
    let asset =
        member("asset").ok_or_else(|| Fault::new("/asset", "`asset` is missing: it is no glTF document"))?;
    match asset.need("version")?.value.as_str() {
        Some(version) if version.starts_with("2.") => {}
        _ => return asset.need("version")?.fault(format!("{} is not version 2", asset.value["version"])),
    }
    for all in LISTS.into_iter().filter_map(member) {
        for item in all.items()? {
            if !item.value.is_object() {
                return item.fault("it is no object");
            }
        }
    }
    let each = |name: &'static str, check: fn(&Object, At<'_>) -> Result<(), Fault>| -> Result<(), Fault> {
        let Some(all) = member(name) else { return Ok(()) };
        all.items()?.try_for_each(|item| check(own, item))
    };
    each("buffers", buffer)?;
    each("bufferViews", view)?;
    each("accessors", accessor)?;
    each("images", image)?;
    each("textures", texture)?;
    each("materials", material)?;
    each("meshes", mesh)?;
    each("nodes", node)?;
    each("skins", skin)?;
    each("animations", animation)?;
    each("scenes", |root, scene| match scene.get("nodes") {
        None => Ok(()),
        Some(nodes) => nodes.items()?.try_for_each(|node| node.index(root, "nodes").map(drop)),
    })?;
    if let Some(scene) = member("scene") {
        scene.index(own, "scenes")?;
    }
    trees(own)
}

fn buffer(_: &Object, at: At<'_>) -> Result<(), Fault> {
    at.need("byteLength")?.whole()?;
    match at.get("uri") {
        Some(uri) if !uri.value.is_string() => uri.fault("it is no text"),
        _ => Ok(()),
    }
}

fn view(root: &Object, at: At<'_>) -> Result<(), Fault> {
    at.need("buffer")?.index(root, "buffers")?;
    at.need("byteLength")?.whole()?;
    let optional = ["byteOffset", "byteStride"];
    optional
        .into_iter()
        .filter_map(|name| at.get(name).map(|at| at.whole()))
        .try_for_each(|found| found.map(drop))
}

fn accessor(root: &Object, at: At<'_>) -> Result<(), Fault> {
    at.need("componentType")?.one_of(&COMPONENTS)?;
    let kind = at.need("type")?;
    if kind.value.as_str().and_then(super::accessor::width).is_none() {
        return kind.fault(format!("{} is no type of elements", kind.value));
    }
    let count = at.need("count")?;
    if count.whole()? == 0 {
        return count.fault("an accessor has 1 element or more");
    }
    if let Some(offset) = at.get("byteOffset") {
        offset.whole()?;
    }
    if let Some(view) = at.get("bufferView") {
        view.index(root, "bufferViews")?;
    }
    let Some(sparse) = at.get("sparse") else { return Ok(()) };
    sparse.need("count")?.whole()?;
    for part in ["indices", "values"] {
        let part = sparse.need(part)?;
        part.need("bufferView")?.index(root, "bufferViews")?;
        if let Some(offset) = part.get("byteOffset") {
            offset.whole()?;
        }
    }
    sparse.need("indices")?.need("componentType")?.one_of(&[5121, 5123, 5125]).map(drop)
}

fn image(root: &Object, at: At<'_>) -> Result<(), Fault> {
    match (at.get("bufferView"), at.get("uri")) {
        (Some(view), _) => view.index(root, "bufferViews").map(drop),
        (None, Some(uri)) if !uri.value.is_string() => uri.fault("it is no text"),
        _ => Ok(()),
    }
}

fn texture(root: &Object, at: At<'_>) -> Result<(), Fault> {
    for (name, into) in [("source", "images"), ("sampler", "samplers")] {
        if let Some(own) = at.get(name) {
            own.index(root, into)?;
        }
    }
    Ok(())
}

fn material(root: &Object, at: At<'_>) -> Result<(), Fault> {
    let look = at.get("pbrMetallicRoughness");
    let in_look = ["baseColorTexture", "metallicRoughnessTexture"];
    let own = ["normalTexture", "occlusionTexture", "emissiveTexture"];
    let infos = look.iter().flat_map(|look| in_look.into_iter().filter_map(|name| look.get(name)));
    for info in infos.chain(own.into_iter().filter_map(|name| at.get(name))) {
        info.need("index")?.index(root, "textures")?;
    }
    Ok(())
}

fn mesh(root: &Object, at: At<'_>) -> Result<(), Fault> {
    let primitives = at.need("primitives")?;
    for primitive in primitives.items()? {
        let mut vertices = None;
        let attributes = primitive.need("attributes")?;
        alike(root, &attributes, &mut vertices)?;
        if let Some(targets) = primitive.get("targets") {
            for target in targets.items()? {
                alike(root, &target, &mut vertices)?;
            }
        }
        if let Some(indices) = primitive.get("indices") {
            let accessor = &list(root, "accessors")[indices.index(root, "accessors")?];
            let kind = whole(accessor, "componentType").unwrap_or(0);
            if accessor["type"] != "SCALAR" || ![5121, 5123, 5125].contains(&kind) {
                return indices.fault("its accessor holds no indices: scalars of unsigned whole numbers");
            }
        }
        if let Some(material) = primitive.get("material") {
            material.index(root, "materials")?;
        }
        if let Some(mode) = primitive.get("mode") {
            mode.one_of(&[0, 1, 2, 3, 4, 5, 6])?;
        }
    }
    Ok(())
}

/// How many numbers an element of an attribute has, where the specification says.
fn known_width(name: &str) -> Option<&'static [&'static str]> {
    Some(match name.split_once('_').map_or(name, |(own, _)| own) {
        "POSITION" | "NORMAL" => &["VEC3"],
        // Targets have no sign.
        "TANGENT" => &["VEC4", "VEC3"],
        "TEXCOORD" => &["VEC2"],
        "COLOR" => &["VEC3", "VEC4"],
        "JOINTS" | "WEIGHTS" => &["VEC4"],
        _ => return None,
    })
}

/// That attributes name accessors of one length.
fn alike(root: &Object, attributes: &At<'_>, vertices: &mut Option<usize>) -> Result<(), Fault> {
    for attribute in attributes.members()? {
        let accessor = &list(root, "accessors")[attribute.index(root, "accessors")?];
        let count = whole(accessor, "count").unwrap_or(0);
        let expected = *vertices.get_or_insert(count);
        if expected != count {
            return attribute.fault(format!("it has {count} elements where others have {expected}"));
        }
        let Key::Name(name) = attribute.key else { continue };
        let kind = accessor["type"].as_str().unwrap_or_default();
        if let Some(known) = known_width(name).filter(|known| !known.contains(&kind)) {
            return attribute.fault(format!("its elements are {kind}, and should be {}", known.join(" or ")));
        }
    }
    Ok(())
}

fn node(root: &Object, at: At<'_>) -> Result<(), Fault> {
    for (name, into) in [("mesh", "meshes"), ("skin", "skins"), ("camera", "cameras")] {
        if let Some(own) = at.get(name) {
            own.index(root, into)?;
        }
    }
    for (name, count) in [("matrix", 16), ("translation", 3), ("rotation", 4), ("scale", 3)] {
        if let Some(own) = at.get(name) {
            own.numbers(count)?;
        }
    }
    match at.get("children") {
        None => Ok(()),
        Some(children) => children.items()?.try_for_each(|child| child.index(root, "nodes").map(drop)),
    }
}

fn skin(root: &Object, at: At<'_>) -> Result<(), Fault> {
    let joints = at.need("joints")?;
    let mut count = 0;
    for joint in joints.items()? {
        joint.index(root, "nodes")?;
        count += 1;
    }
    if count == 0 {
        return joints.fault("a skin has 1 joint or more");
    }
    if let Some(skeleton) = at.get("skeleton") {
        skeleton.index(root, "nodes")?;
    }
    let Some(inverse) = at.get("inverseBindMatrices") else { return Ok(()) };
    let accessor = &list(root, "accessors")[inverse.index(root, "accessors")?];
    let matrices = accessor["type"] == "MAT4" && accessor["componentType"] == 5126;
    match whole(accessor, "count") {
        Some(held) if matrices && held >= count => Ok(()),
        _ => inverse.fault(format!("its accessor does not hold {count} matrices of floats")),
    }
}

fn animation(root: &Object, at: At<'_>) -> Result<(), Fault> {
    let samplers = at.need("samplers")?;
    for sampler in samplers.items()? {
        let input = sampler.need("input")?;
        let accessor = &list(root, "accessors")[input.index(root, "accessors")?];
        if accessor["type"] != "SCALAR" || accessor["componentType"] != 5126 {
            return input.fault("its accessor holds no times: scalars of floats");
        }
        sampler.need("output")?.index(root, "accessors")?;
    }
    let count = samplers.value.as_array().map_or(0, Vec::len);
    for channel in at.need("channels")?.items()? {
        let sampler = channel.need("sampler")?;
        if sampler.whole()? >= count {
            return sampler.fault(format!("it is not below {count}, the number of samplers"));
        }
        let target = channel.need("target")?;
        if let Some(node) = target.get("node") {
            node.index(root, "nodes")?;
        }
        if !target.need("path")?.value.is_string() {
            return target.fault("its `path` is no text");
        }
    }
    Ok(())
}

/// That every node has one parent at most, and none is above itself.
fn trees(root: &Object) -> Result<(), Fault> {
    let nodes = list(root, "nodes");
    let mut parents = vec![None; nodes.len()];
    for (index, child) in children(nodes) {
        if parents[child].replace(index).is_some() {
            return Err(Fault::new(
                format!("/nodes/{index}/children"),
                format!("node {child} has two parents"),
            ));
        }
    }
    // The node from which each was first come by: what is met again from one is above itself.
    let mut from = vec![usize::MAX; parents.len()];
    for start in 0..parents.len() {
        let mut next = Some(start);
        while let Some(node) = next.filter(|node| from[*node] == usize::MAX) {
            from[node] = start;
            next = parents[node];
        }
        if let Some(node) = next.filter(|node| from[*node] == start) {
            return Err(Fault::new(
                format!("/nodes/{node}/children"),
                format!("node {node} is below itself"),
            ));
        }
    }
    Ok(())
}

/// Each node with each of its children.
pub(super) fn children(nodes: &[Value]) -> impl Iterator<Item = (usize, usize)> {
    nodes.iter().enumerate().flat_map(|(index, node)| {
        let own = node.get("children").and_then(Value::as_array).into_iter().flatten();
        own.filter_map(as_index).map(move |child| (index, child))
    })
}

//! The Rust module that names what was baked.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use gltf::json::Root;
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;

use super::names;
use crate::geometry::number::single;
use crate::gltf::ReadLevels;

/// What the module says of an asset.
pub(super) struct Asset {
    /// Folder below the output folder, with `/` between its parts; empty for that itself.
    folder: String,
    /// Name of the file.
    file: String,
    /// The box of all nodes, where there is a report.
    bounds: Option<[[f64; 3]; 2]>,
    /// Kinds of things and their names, as they stand in the file.
    lists: Vec<(&'static str, Vec<String>)>,
    /// For each mesh with levels of detail their meshes and for what part of the picture each is good at least.
    levels: Vec<Vec<(String, f64)>>,
}

impl Asset {
    pub(super) fn new(folder: &str, file: &str, bytes: &[u8], bounds: Option<[[f64; 3]; 2]>) -> Self {
        // What was written is read; it cannot be broken.
        let plain = crate::packing::unpacked(bytes).unwrap_or_default();
        let (root, levels) =
            crate::gltf::read(&plain).map(|read| (read.root, read.levels)).unwrap_or_default();
        let name = |mesh: &usize| root.meshes[*mesh].name.clone().unwrap_or_default();
        let named =
            |one: &ReadLevels| one.meshes.iter().map(name).zip(one.coverage.iter().copied()).collect();
        let levels = levels.iter().map(named).collect();
        Self { folder: folder.to_owned(), file: file.to_owned(), bounds, lists: lists(&root), levels }
    }

    /// Names of the modules around it, and its own.
    fn path(&self) -> Vec<String> {
        let stem = self.file.trim_end_matches(".glb");
        let above = self.folder.split('/').filter(|part| !part.is_empty());
        above.chain([stem]).map(names::module).collect()
    }

    fn below(&self) -> String {
        if self.folder.is_empty() { self.file.clone() } else { format!("{}/{}", self.folder, self.file) }
    }
}

/// Names of things in a file.
fn lists(root: &Root) -> Vec<(&'static str, Vec<String>)> {
    let extra = |extras: &gltf::json::Extras| -> Option<serde_json::Value> {
        serde_json::from_str(extras.as_ref()?.get()).ok()
    };
    let joint =
        |index: usize| root.skins.iter().any(|skin| skin.joints.iter().any(|joint| joint.value() == index));
    let socket = |node: &gltf::json::Node| {
        extra(&node.extras).is_some_and(|value| value.get("socket").is_some_and(|mark| mark == true))
    };
    let mut kinds: [(&'static str, Vec<String>); 8] = [
        ("nodes", Vec::new()),
        ("meshes", root.meshes.iter().filter_map(|mesh| mesh.name.clone()).collect()),
        ("materials", root.materials.iter().filter_map(|material| material.name.clone()).collect()),
        ("clips", root.animations.iter().filter_map(|clip| clip.name.clone()).collect()),
        ("joints", Vec::new()),
        ("sockets", Vec::new()),
        ("morphs", Vec::new()),
        ("attributes", attributes(root)),
    ];
    for (index, node) in root.nodes.iter().enumerate() {
        let Some(name) = node.name.clone() else { continue };
        let kind = if joint(index) {
            4
        } else if socket(node) {
            5
        } else {
            0
        };
        kinds[kind].1.push(name);
    }
    for mesh in &root.meshes {
        let names = extra(&mesh.extras).and_then(|value| value.get("targetNames")?.as_array().cloned());
        let names = names.unwrap_or_default();
        kinds[6].1.extend(names.iter().filter_map(|name| name.as_str()).map(str::to_owned));
    }
    let mut lists: Vec<(&'static str, Vec<String>)> = kinds.into();
    lists.retain(|(_, names)| !names.is_empty());
    lists
}

/// Attributes of vertices that the format has no name for, each once.
fn attributes(root: &Root) -> Vec<String> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut names: Vec<String> = primitives
        .flat_map(|primitive| primitive.attributes.keys())
        .filter_map(|semantic| match semantic {
            Checked::Valid(Semantic::Extras(name)) => Some(format!("_{name}")),
            _ => None,
        })
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Modules and assets in a module.
#[derive(Default)]
struct Folder<'a> {
    folders: BTreeMap<String, Self>,
    asset: Option<&'a Asset>,
}

/// The text of the module. Files are named from `OUT_DIR`, or from `out` where it is another folder.
///
/// # Errors
/// When two assets, or two things of one kind in an asset, would have one name.
pub(super) fn text(assets: &[Asset], out: Option<&Path>) -> Result<String, String> {
    let mut root = Folder::default();
    for asset in assets {
        let path = asset.path();
        let mut at = &mut root;
        for part in &path {
            at = at.folders.entry(part.clone()).or_default();
        }
        if let Some(other) = at.asset.replace(asset) {
            let (one, other, name) = (asset.below(), other.below(), path.join("::"));
            return Err(format!("{other} and {one} would both be `{name}` in Rust: rename one of them"));
        }
    }
    let mut text = "// Made by Kiln; changes are lost at the next build.\n".to_owned();
    inside(&mut text, &root, out, 0)?;
    Ok(text)
}

fn inside(text: &mut String, folder: &Folder<'_>, out: Option<&Path>, depth: usize) -> Result<(), String> {
    let space = "    ".repeat(depth);
    if let Some(asset) = folder.asset {
        constants(text, asset, out, &space)?;
    }
    for (name, inner) in &folder.folders {
        let about = inner
            .asset
            .map_or_else(|| "Assets of a folder.".to_owned(), |asset| format!("`{}`", asset.below()));
        let _ = writeln!(
            text,
            "{space}#[allow(dead_code, missing_docs)]\n{space}/// {about}\n{space}pub mod {name} {{"
        );
        inside(text, inner, out, depth + 1)?;
        let _ = writeln!(text, "{space}}}");
    }
    Ok(())
}

fn constants(text: &mut String, asset: &Asset, out: Option<&Path>, space: &str) -> Result<(), String> {
    let below = asset.below();
    let path = match out {
        None => format!("concat!(env!(\"OUT_DIR\"), {:?})", format!("/{below}")),
        Some(out) => format!("{:?}", out.join(&below).display().to_string()),
    };
    let _ = writeln!(text, "{space}/// Where the file stands.\n{space}pub const PATH: &str = {path};");
    let _ = writeln!(text, "{space}/// The file.\n{space}pub const BYTES: &[u8] = include_bytes!({path});");
    if let Some(bounds) = asset.bounds {
        let corner = |[x, y, z]: [f64; 3]| format!("[{x:?}, {y:?}, {z:?}]");
        let [low, high] = bounds.map(corner);
        let _ = writeln!(
            text,
            "{space}/// Least and greatest corner of the box around it, in meters.\n\
             {space}pub const BOUNDS: [[f64; 3]; 2] = [{low}, {high}];"
        );
    }
    for (kind, list) in &asset.lists {
        let _ = writeln!(text, "{space}/// Names of its {kind}.\n{space}pub mod {kind} {{");
        let mut known: BTreeMap<String, &str> = BTreeMap::new();
        for name in list {
            let constant = names::constant(name);
            match known.insert(constant.clone(), name) {
                None => {
                    let _ = writeln!(text, "{space}    pub const {constant}: &str = {name:?};");
                }
                // One name for two things says nothing new.
                Some(other) if other == name => {}
                Some(other) => {
                    return Err(format!(
                        "{below}: its {kind} `{other}` and `{name}` would both be `{constant}` in Rust: rename one of them"
                    ));
                }
            }
        }
        let all: Vec<&String> = known.keys().collect();
        let all = all.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            text,
            "{space}    /// All of them, by name.\n{space}    pub const ALL: &[&str] = &[{all}];"
        );
        let _ = writeln!(text, "{space}}}");
    }
    levels(text, asset, space);
    Ok(())
}

/// Levels of detail of meshes, whose own names are told apart already.
fn levels(text: &mut String, asset: &Asset, space: &str) {
    if asset.levels.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "{space}/// Levels of detail: for each mesh those of its levels, the finest first, and for what part of the picture\n\
         {space}/// each is good at least.\n{space}pub mod lods {{"
    );
    for levels in &asset.levels {
        let Some((finest, _)) = levels.first() else { continue };
        let one = |(name, coverage): &(String, f64)| format!("({name:?}, {:?})", single(*coverage));
        let all = levels.iter().map(one).collect::<Vec<_>>().join(", ");
        let constant = names::constant(finest);
        let _ = writeln!(text, "{space}    pub const {constant}: &[(&str, f32)] = &[{all}];");
    }
    let _ = writeln!(text, "{space}}}");
}

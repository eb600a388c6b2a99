//! Nodes that carry meshes for others: from the grid to metres, and levels of detail.
//!
//! A mesh on a grid hangs on a node of its own below the one that shows it, and so does one that has levels of detail: what a
//! game moves, and what hangs on it, stays one node whatever level is shown. Coarser levels are nodes that `MSFT_lod` names and
//! the scene does not. What joints carry moves with no node: its node shows it itself. Carriers stand after all other nodes, so
//! that these keep their places.
//!
//! Source: Microsoft, `MSFT_lod`, 2018.

use gltf::json::{Index, Node, Root, extensions};
use serde_json::{Map, Value, json};

use super::buffer::at;
use super::write::Carriers;
use crate::geometry::number::single;
use crate::scene::{Grid, LevelForm, LevelUse, Scene};

/// The extension of levels of detail.
pub(super) const LEVELS: &str = "MSFT_lod";

/// For what part of the picture each level is good at least, in the extras of the finest.
pub(super) const COVERAGE: &str = "MSFT_screencoverage";

/// A node that carries a mesh for another.
pub(super) struct Carrier {
    /// The node of the scene that shows it.
    shown: usize,
    mesh: usize,
    hangs: Hangs,
}

/// Where a carrier hangs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Hangs {
    /// Below the node that shows it.
    Below,
    /// Nowhere: another node names it as its coarser level.
    Aside,
}

/// All carriers of a scene.
pub(super) fn carriers(scene: &Scene) -> Vec<Carrier> {
    let mut all = Vec::new();
    for (shown, node) in scene.nodes.iter().enumerate() {
        let Some(mesh) = node.mesh else { continue };
        let levels = if scene.level_form == LevelForm::Extension { levels(scene, mesh) } else { &[] };
        if node.skin.is_none() && node.instances.is_empty() && (scene.grid.is_some() || !levels.is_empty()) {
            all.push(Carrier { shown, mesh, hangs: Hangs::Below });
        }
        let coarser = levels.iter().skip(1);
        all.extend(coarser.map(|level| Carrier { shown, mesh: level.mesh, hangs: Hangs::Aside }));
    }
    all
}

/// The levels of a mesh; none where it has no other than itself.
fn levels(scene: &Scene, mesh: usize) -> &[LevelUse] {
    let levels = scene.meshes[mesh].levels.as_slice();
    if levels.len() > 1 { levels } else { &[] }
}

/// Nodes that show a mesh, each with the nodes that bear the mesh or a level of it in its stead; itself where joints carry it.
pub(super) fn bearers(scene: &Scene, carriers: &[Carrier]) -> Carriers {
    let itself = |shown: usize| (!is_relieved(carriers, shown)).then(|| (shown, at(shown)));
    let mut own: Vec<usize> = carriers.iter().map(|carrier| carrier.shown).collect();
    own.dedup();
    let others = carriers.iter().enumerate();
    let others = others.map(|(place, carrier)| (carrier.shown, at(scene.nodes.len() + place)));
    own.into_iter().filter_map(itself).chain(others).collect()
}

/// Carriers below a node, as indices of nodes.
pub(super) fn below(scene: &Scene, carriers: &[Carrier], parent: usize) -> Vec<Index<Node>> {
    let own = carriers.iter().enumerate().filter(|(_, one)| one.hangs == Hangs::Below && one.shown == parent);
    own.map(|(place, _)| at(scene.nodes.len() + place)).collect()
}

/// Whether a carrier takes a node's mesh off it.
pub(super) fn is_relieved(carriers: &[Carrier], node: usize) -> bool {
    carriers.iter().any(|carrier| carrier.shown == node && carrier.hangs == Hangs::Below)
}

/// What the node with the finest level says of the others: extension and extras.
pub(super) fn told(
    scene: &Scene,
    carriers: &[Carrier],
    (shown, mesh): (usize, usize),
) -> (Option<extensions::scene::Node>, gltf::json::Extras) {
    let levels = levels(scene, mesh);
    let coarser =
        carriers.iter().enumerate().filter(|(_, one)| one.shown == shown && one.hangs == Hangs::Aside);
    let ids: Vec<usize> = coarser.map(|(place, _)| scene.nodes.len() + place).collect();
    let extension = (!ids.is_empty()).then(|| {
        let others = Map::from_iter([(LEVELS.to_owned(), json!({ "ids": ids }))]);
        extensions::scene::Node { others }
    });
    // Each is good until the next is; the last never gives way to nothing.
    let until: Vec<f64> = levels.iter().skip(1).map(|level| level.coverage).chain([0.0]).collect();
    let extras = (!levels.is_empty())
        .then(|| serde_json::value::to_raw_value(&json!({ (COVERAGE): until })).ok())
        .flatten();
    (extension, extras)
}

/// Writes the carriers, after all nodes of the scene.
pub(super) fn push(root: &mut Root, scene: &Scene, carriers: &[Carrier]) {
    for carrier in carriers {
        let shown = &scene.nodes[carrier.shown];
        let grid = scene.grid.filter(|_| shown.skin.is_none());
        let finest = shown.mesh == Some(carrier.mesh);
        let (extensions, extras) =
            if finest { told(scene, carriers, (carrier.shown, carrier.mesh)) } else { (None, None) };
        root.push(Node {
            mesh: Some(at(carrier.mesh)),
            skin: shown.skin.map(at),
            scale: grid.map(|grid| [single(grid.step); 3]),
            translation: grid.map(|grid| grid.offset.as_vec3().to_array()),
            extensions,
            extras,
            ..Node::default()
        });
    }
    if carriers.iter().any(|carrier| carrier.hangs == Hangs::Aside) {
        root.extensions_used.push(LEVELS.to_owned());
    }
}

/// Nodes that others name as their coarser levels.
fn aside(root: &Root) -> Vec<usize> {
    let of = |node: &Node| -> Vec<usize> {
        let ids = node.extensions.as_ref().and_then(|own| own.others.get(LEVELS)?.get("ids")?.as_array());
        let numbers = ids.into_iter().flatten().filter_map(Value::as_u64);
        numbers.filter_map(|number| usize::try_from(number).ok()).collect()
    };
    root.nodes.iter().flat_map(of).collect()
}

/// Takes away the nodes that only carry a mesh: the last ones. Tells which of them others show, each with the node that does.
pub(super) fn drop_carriers(root: &mut Root, grid: Option<Grid>) -> Vec<(usize, usize)> {
    let mut dropped = Vec::new();
    let aside = aside(root);
    let scale = grid.map(|grid| [single(grid.step); 3]);
    let translation = grid.map(|grid| grid.offset.as_vec3().to_array());
    while let Some(last) = root.nodes.len().checked_sub(1) {
        let node = &root.nodes[last];
        let placed = node.scale == scale && node.translation == translation;
        let plain = node.name.is_none() && node.children.is_none() && node.rotation.is_none();
        let Some(mesh) = node.mesh.filter(|_| plain) else { break };
        if aside.contains(&last) && (placed || node.skin.is_some()) {
            root.nodes.pop();
            continue;
        }
        let has_levels = node.extensions.as_ref().is_some_and(|own| own.others.contains_key(LEVELS));
        if !placed || !(grid.is_some() || has_levels) {
            break;
        }
        let above = |node: &Node| node.children.iter().flatten().any(|child| child.value() == last);
        let found = root.nodes.iter().position(|node| above(node) && node.mesh.is_none());
        let Some(found) = found else { break };
        let shows = &mut root.nodes[found];
        dropped.push((last, found));
        shows.mesh = Some(mesh);
        let left: Vec<_> =
            shows.children.take().into_iter().flatten().filter(|child| child.value() != last).collect();
        shows.children = (!left.is_empty()).then_some(left);
        root.nodes.pop();
    }
    dropped
}

/// A mesh of a file with its levels.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadLevels {
    /// Indices of meshes, the finest first.
    pub meshes: Vec<usize>,
    /// For what part of the picture each of them is good at least, the last 0.
    pub coverage: Vec<f64>,
}

/// The levels of all meshes that have some, by the names of meshes and what the nodes say that carry the finest.
pub(super) fn read_levels(root: &Root) -> Vec<ReadLevels> {
    let named = |name: &str| root.meshes.iter().position(|mesh| mesh.name.as_deref() == Some(name));
    let of = |(index, mesh): (usize, &gltf::json::Mesh)| {
        let name = mesh.name.as_deref()?;
        let coarser = (1..).map_while(|number: u32| named(&format!("{name}_LOD{number}")));
        let meshes: Vec<usize> = std::iter::once(index).chain(coarser).collect();
        let carries =
            |node: &&Node| node.mesh.is_some_and(|mesh| mesh.value() == index) && node.extras.is_some();
        let extras: Value =
            serde_json::from_str(root.nodes.iter().find(carries)?.extras.as_ref()?.get()).ok()?;
        let coverage = extras.get(COVERAGE)?.as_array()?.iter().filter_map(Value::as_f64).collect();
        (meshes.len() > 1).then_some(ReadLevels { meshes, coverage })
    };
    root.meshes.iter().enumerate().filter_map(of).collect()
}

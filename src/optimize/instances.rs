//! Nodes that are copies of one thing become places of one node, which draws all of them at once.
//!
//! Promise: the same triangles stand at the same places. Copies stay nodes where drawing at once would lose or change something:
//! where something hangs on one or moves it, a body stands for it, one is a mirror image (winding is told for all at once),
//! the mesh has levels of detail in the file or states, lines, of which three.js draws one, or takes light in, by a thickness that
//! is counted in the units of the node.

use crate::scene::{Instance, Node, Owner, Scene};

/// Fewer copies are no gain.
const FEWEST: usize = 2;

/// Makes copies places of the nodes that show them. Linear in nodes and what refers to them.
pub fn fold_copies(scene: &mut Scene) {
    let mut held = vec![false; scene.nodes.len()];
    let children = scene.nodes.iter().filter_map(|node| node.parent);
    let moved = scene.animations.iter().flat_map(|animation| animation.channels.iter().map(|one| one.node));
    let bodies = scene.colliders.iter().flat_map(|body| std::iter::once(body.node).chain(body.holder));
    for node in children.chain(moved).chain(bodies) {
        held[node] = true;
    }
    let mut copies: Vec<Vec<usize>> = vec![Vec::new(); scene.nodes.len()];
    for (index, node) in scene.nodes.iter().enumerate().filter(|(_, node)| node.copy) {
        copies[node.parent.unwrap_or(index)].push(index);
    }
    let mut folded = vec![false; scene.nodes.len()];
    for (parent, own) in copies.into_iter().enumerate() {
        let shows = own.first().and_then(|first| scene.nodes[*first].mesh).filter(|_| own.len() >= FEWEST);
        let Some(mesh) = shows.filter(|mesh| is_plain(scene, *mesh)) else { continue };
        let one = &scene.nodes[parent];
        let fits = |index: &usize| {
            let node = &scene.nodes[*index];
            !held[*index]
                && node.mesh == Some(mesh)
                && node.skin.is_none()
                && node.scale.x * node.scale.y * node.scale.z > 0.0
        };
        if one.mesh.is_some() || one.skin.is_some() || !own.iter().all(fits) {
            continue;
        }
        let instance = |node: &Node| Instance {
            translation: node.translation,
            rotation: node.rotation,
            scale: node.scale,
        };
        let instances = own.iter().map(|index| instance(&scene.nodes[*index])).collect();
        (scene.nodes[parent].mesh, scene.nodes[parent].instances) = (Some(mesh), instances);
        own.iter().for_each(|index| folded[*index] = true);
    }
    if folded.contains(&true) {
        leave_out(scene, &folded);
    }
}

/// Whether a mesh is one that all engines draw many times at once.
fn is_plain(scene: &Scene, mesh: usize) -> bool {
    let mesh = &scene.meshes[mesh];
    let geometry = &scene.geometries[mesh.geometry];
    let worn = mesh.materials.iter().flatten().map(|material| &scene.materials[*material]);
    let thin = worn.into_iter().all(|material| material.optics.volume.is_none());
    mesh.levels.len() < 2 && geometry.wire.is_empty() && geometry.targets.is_empty() && thin
}

/// Leaves out nodes that nothing refers to.
fn leave_out(scene: &mut Scene, gone: &[bool]) {
    let mut places = Vec::with_capacity(gone.len());
    let mut next = 0;
    for gone in gone {
        places.push(next);
        next += usize::from(!gone);
    }
    let mut left = gone.iter();
    scene.nodes.retain(|_| left.next().is_some_and(|gone| !gone));
    let place = |node: &mut usize| *node = places[*node];
    scene.nodes.iter_mut().filter_map(|node| node.parent.as_mut()).for_each(place);
    scene.root.iter_mut().for_each(place);
    for skin in &mut scene.skins {
        skin.joints.iter_mut().for_each(place);
        place(&mut skin.root);
    }
    for animation in &mut scene.animations {
        animation.channels.iter_mut().for_each(|channel| place(&mut channel.node));
        for channel in &mut animation.properties {
            if let Owner::Node(node) = &mut channel.owner {
                place(node);
            }
        }
    }
    for body in &mut scene.colliders {
        place(&mut body.node);
        body.holder.iter_mut().for_each(place);
    }
}

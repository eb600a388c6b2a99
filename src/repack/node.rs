//! Nodes and skins that take whole numbers back to the units of a mesh.
//!
//! A mesh on a grid hangs on a node of its own below the one that showed it, which keeps its place, its name and all else: what
//! a game moves turns about the point that it was made to turn about. A mesh with a skin is taken back by the inverse bind
//! matrices, one that stands in many places at once by these (`copies`). The new nodes stand after all others, so that these keep their numbers.

use gltf::json::accessor::ComponentType;
use serde_json::{Value, json};

use super::accessor::Source;
use super::column;
use super::document::{Fault, Object, as_index, list, list_mut, whole};
use super::grid::{Grid, MeshPlace, inverse_bind};
use super::stream::{Content, Kind, Output};
use super::{copies, described, number_of, primitives};
use crate::geometry::number::single;

/// That vertices name only joints that the skins of their nodes have.
pub(super) fn check_joints(source: &Source<'_>) -> Result<(), Fault> {
    // For each mesh the least number of joints of a skin that carries it.
    let mut least = vec![usize::MAX; list(source.root, "meshes").len()];
    for node in list(source.root, "nodes") {
        if let (Some(mesh), Some(skin)) = (whole(node, "mesh"), whole(node, "skin")) {
            let joints = list(source.root, "skins")[skin]["joints"].as_array().map_or(0, Vec::len);
            least[mesh] = least[mesh].min(joints);
        }
    }
    for (index, mesh) in
        list(source.root, "meshes").iter().enumerate().filter(|(mesh, _)| least[*mesh] < usize::MAX)
    {
        for (place, primitive) in primitives(mesh).enumerate() {
            let attributes = primitive["attributes"].as_object().into_iter().flatten();
            for (name, accessor) in attributes.filter(|(name, _)| name.starts_with("JOINTS_")) {
                let elements = source.elements(as_index(accessor).unwrap_or(0))?;
                let greatest = |at: usize| elements.numbers::<4>(at).into_iter().fold(0.0, f64::max);
                let found = (0..elements.count).find(|at| greatest(*at) >= least[index] as f64);
                if let Some(vertex) = found {
                    let path = format!("/meshes/{index}/primitives/{place}/attributes/{name}");
                    let message = format!(
                        "vertex {vertex} is carried by joint {}, and a skin of this mesh has {} joints",
                        greatest(vertex),
                        least[index]
                    );
                    return Err(Fault::new(path, message));
                }
            }
        }
    }
    Ok(())
}

/// Hangs meshes on a grid below the nodes that showed them; what moves the weights of their targets moves there.
pub(super) fn carriers(made: &mut Object, places: &[MeshPlace]) {
    let count = list(made, "nodes").len();
    let mut added: Vec<Value> = Vec::new();
    let mut moved: Vec<Option<usize>> = vec![None; count];
    for (index, node) in list_mut(made, "nodes").iter_mut().enumerate() {
        let grid = whole(node, "mesh").and_then(|mesh| places[mesh].grid);
        let hangs = node.get("skin").is_none() && !copies::has_some(node);
        let Some(grid) = grid.filter(|_| hangs) else { continue };
        let Some(own) = node.as_object_mut() else { continue };
        let step = number_of(grid.step.into());
        let mut carrier = Object::new();
        for name in ["mesh", "weights"] {
            carrier.extend(own.remove(name).map(|value| (name.to_owned(), value)));
        }
        carrier.insert("scale".to_owned(), json!([step, step, step]));
        if grid.offset != [0.0; 3] {
            let offset = grid.offset.map(|part| number_of(part.into()));
            carrier.insert("translation".to_owned(), json!(offset));
        }
        let number = count + added.len();
        let children = own.entry("children").or_insert_with(|| json!([]));
        children.as_array_mut().into_iter().for_each(|all| all.push(json!(number)));
        added.push(Value::Object(carrier));
        moved[index] = Some(number);
    }
    if let Some(nodes) = made.get_mut("nodes").and_then(Value::as_array_mut) {
        nodes.extend(added);
    }
    for animation in list_mut(made, "animations") {
        for channel in animation.get_mut("channels").and_then(Value::as_array_mut).into_iter().flatten() {
            let target = &mut channel["target"];
            let carrier = whole(target, "node").and_then(|node| moved[node]);
            if let Some(carrier) = carrier.filter(|_| target["path"] == "weights") {
                target["node"] = json!(carrier);
            }
        }
    }
}

/// Writes the matrices of skins; a skin that carries meshes of several grids becomes several.
pub(super) fn skins(
    made: &mut Object,
    source: &Source<'_>,
    places: &[MeshPlace],
    output: &mut Output,
) -> Result<(), Fault> {
    let skins = list(source.root, "skins");
    // For each skin the grids of what it carries, each with the nodes that show it.
    let mut grids: Vec<Vec<(Option<Grid>, Vec<usize>)>> = vec![Vec::new(); skins.len()];
    for (index, node) in list(source.root, "nodes").iter().enumerate() {
        let (Some(mesh), Some(skin)) = (whole(node, "mesh"), whole(node, "skin")) else { continue };
        let grid = places[mesh].grid;
        match grids[skin].iter_mut().find(|(known, _)| *known == grid) {
            Some((_, nodes)) => nodes.push(index),
            None => grids[skin].push((grid, vec![index])),
        }
    }
    let mut added: Vec<Value> = Vec::new();
    for (index, (skin, grids)) in skins.iter().zip(grids).enumerate() {
        for (place, (grid, nodes)) in grids.iter().enumerate() {
            let matrices = match grid {
                Some(grid) => Some(bind(source, (skin, *grid), output)?),
                None => unchanged(source, skin, output)?,
            };
            let mut own = list(made, "skins")[index].clone();
            if let Some(matrices) = matrices {
                own["inverseBindMatrices"] = json!(matrices);
            }
            let number = if place == 0 {
                list_mut(made, "skins")[index] = own;
                index
            } else {
                added.push(own);
                skins.len() + added.len() - 1
            };
            for node in nodes {
                list_mut(made, "nodes")[*node]["skin"] = json!(number);
            }
        }
        if grids.is_empty()
            && let Some(matrices) = unchanged(source, skin, output)?
        {
            list_mut(made, "skins")[index]["inverseBindMatrices"] = json!(matrices);
        }
    }
    if let Some(all) = made.get_mut("skins").and_then(Value::as_array_mut) {
        all.extend(added);
    }
    Ok(())
}

/// The matrices of a skin for a mesh on a grid.
fn bind(source: &Source<'_>, (skin, grid): (&Value, Grid), output: &mut Output) -> Result<usize, Fault> {
    let joints = skin["joints"].as_array().map_or(0, Vec::len);
    let inverse = inverse_bind(source, skin)?;
    let count = joints.max(inverse.len());
    let map = glam::DMat4::from(grid.affine());
    let one =
        |place: usize| (inverse.get(place).copied().unwrap_or(glam::DMat4::IDENTITY) * map).to_cols_array();
    let words = (0..count).flat_map(one).flat_map(|number| (single(number) + 0.0).to_le_bytes());
    let told = whole(skin, "inverseBindMatrices").map(|accessor| described(source.root, accessor));
    Ok(matrices(words.collect(), count, told.unwrap_or_default(), output))
}

fn unchanged(source: &Source<'_>, skin: &Value, output: &mut Output) -> Result<Option<usize>, Fault> {
    let Some(accessor) = whole(skin, "inverseBindMatrices") else { return Ok(None) };
    let elements = source.sound(accessor)?;
    let column = column::copied(&elements);
    Ok(Some(matrices(column.rows, elements.count, described(source.root, accessor), output)))
}

fn matrices(rows: Vec<u8>, count: usize, mut told: Object, output: &mut Output) -> usize {
    let kind = Kind { name: "bind".to_owned(), content: Content::Rows, stride: 64, target: None };
    let span = output.put(&kind, rows);
    told.insert("componentType".to_owned(), json!(ComponentType::F32.as_gl_enum()));
    told.insert("count".to_owned(), json!(count));
    told.insert("type".to_owned(), json!("MAT4"));
    output.accessor(span, told)
}

//! Meshes that a node shows in many places at once, by `EXT_mesh_gpu_instancing`.
//!
//! Promise: each copy stands where it stood, within what single precision rounds. Of a mesh on a grid the places hold the step
//! and the offset of the grid, so that the node stays what it is; all else of the extension is copied.
//!
//! Source: Khronos, `EXT_mesh_gpu_instancing`, 2020.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::accessor::ComponentType;
use serde_json::{Value, json};

use super::accessor::{Elements, Source};
use super::column;
use super::described;
use super::document::{Fault, Object, as_index, list, list_mut, whole};
use super::grid::{Grid, MeshPlace};
use super::stream::{Content, Kind, Output};
use crate::geometry::number::single;

/// The extension.
const COPIES: &str = "EXT_mesh_gpu_instancing";

/// Where the mesh of a node stands, from the node.
#[derive(Clone, Copy)]
struct Place {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

/// Whether a node shows its mesh in many places.
pub(super) fn has_some(node: &Value) -> bool {
    node.get("extensions").is_some_and(|own| own.get(COPIES).is_some())
}

/// The attributes of places, by name.
fn attributes(node: &Value) -> Option<&Object> {
    node.get("extensions")?.get(COPIES)?.get("attributes")?.as_object()
}

/// An attribute of the places of a node.
fn elements<'a>(
    source: &'a Source<'_>,
    (index, name): (usize, &str),
    accessor: &Value,
) -> Result<Elements<'a>, Fault> {
    let known = as_index(accessor).filter(|number| *number < list(source.root, "accessors").len());
    let Some(number) = known else {
        let path = path(index, name);
        return Err(Fault::new(path, format!("{accessor} is no accessor of the document")));
    };
    source.sound(number)
}

fn path(index: usize, name: &str) -> String {
    format!("/nodes/{index}/extensions/{COPIES}/attributes/{name}")
}

/// Where a node shows its mesh, one at least; itself where it shows it once.
pub(super) fn maps(source: &Source<'_>, index: usize, node: &Value) -> Result<Vec<DAffine3>, Fault> {
    let map =
        |own: &Place| DAffine3::from_scale_rotation_translation(own.scale, own.rotation, own.translation);
    let all = places(source, index, node)?;
    Ok(if all.is_empty() { vec![DAffine3::IDENTITY] } else { all.iter().map(map).collect() })
}

fn places(source: &Source<'_>, index: usize, node: &Value) -> Result<Vec<Place>, Fault> {
    let Some(attributes) = attributes(node) else { return Ok(Vec::new()) };
    let mut count = None;
    for (name, accessor) in attributes {
        let own = elements(source, (index, name), accessor)?.count;
        let known = *count.get_or_insert(own);
        if known != own {
            let message = format!("it has {own} elements, and another attribute of these places {known}");
            return Err(Fault::new(path(index, name), message));
        }
    }
    let read = |name: &str| {
        attributes.get(name).map(|accessor| elements(source, (index, name), accessor)).transpose()
    };
    let (moves, turns, sizes) = (read("TRANSLATION")?, read("ROTATION")?, read("SCALE")?);
    let vector = |all: &Option<Elements<'_>>, row: usize, rest: DVec3| {
        all.as_ref().map_or(rest, |all| DVec3::from_array(all.numbers(row)))
    };
    let place = |row: usize| {
        let turn = turns.as_ref().map(|all| DQuat::from_array(all.numbers(row)));
        let turn = turn.filter(|turn| turn.length_squared() > 0.0);
        Place {
            translation: vector(&moves, row, DVec3::ZERO),
            rotation: turn.map_or(DQuat::IDENTITY, DQuat::normalize),
            scale: vector(&sizes, row, DVec3::ONE),
        }
    };
    Ok((0..count.unwrap_or(0)).map(place).collect())
}

/// Writes the places where nodes show meshes.
pub(super) fn write(
    made: &mut Object,
    source: &Source<'_>,
    meshes: &[MeshPlace],
    output: &mut Output,
) -> Result<(), Fault> {
    for (index, node) in list(source.root, "nodes").iter().enumerate() {
        let Some(attributes) = attributes(node) else { continue };
        let grid =
            whole(node, "mesh").and_then(|mesh| meshes[mesh].grid).filter(|_| whole(node, "skin").is_none());
        let mut told = Object::new();
        for (name, accessor) in attributes {
            if grid.is_some() && ["TRANSLATION", "SCALE"].contains(&name.as_str()) {
                continue;
            }
            let own = elements(source, (index, name), accessor)?;
            let column = column::copied(&own);
            let mut form =
                as_index(accessor).map(|number| described(source.root, number)).unwrap_or_default();
            form.insert("componentType".to_owned(), json!(column.component.as_gl_enum()));
            form.insert("count".to_owned(), json!(own.count));
            form.insert("type".to_owned(), json!(column.kind));
            if column.normalized {
                form.insert("normalized".to_owned(), json!(true));
            }
            told.insert(name.clone(), json!(put((name, column.stride), column.rows, form, output)));
        }
        if let Some(grid) = grid {
            let all: Vec<Place> = places(source, index, node)?.iter().map(|own| on_grid(own, grid)).collect();
            let moves = all.iter().map(|own| own.translation);
            told.insert("TRANSLATION".to_owned(), json!(vectors("TRANSLATION", moves, output)));
            let sizes = all.iter().map(|own| own.scale);
            told.insert("SCALE".to_owned(), json!(vectors("SCALE", sizes, output)));
        }
        list_mut(made, "nodes")[index]["extensions"][COPIES]["attributes"] = Value::Object(told);
    }
    Ok(())
}

/// The place of a mesh whose positions are whole numbers of a grid.
fn on_grid(own: &Place, grid: Grid) -> Place {
    let offset = DVec3::from_array(grid.offset.map(f64::from));
    let translation = own.translation + own.rotation * (own.scale * offset);
    Place { translation, rotation: own.rotation, scale: own.scale * f64::from(grid.step) }
}

fn vectors(name: &str, all: impl ExactSizeIterator<Item = DVec3>, output: &mut Output) -> usize {
    let form = Object::from_iter([
        ("componentType".to_owned(), json!(ComponentType::F32.as_gl_enum())),
        ("count".to_owned(), json!(all.len())),
        ("type".to_owned(), json!("VEC3")),
    ]);
    let words = all.flat_map(|vector| vector.to_array()).flat_map(|part| (single(part) + 0.0).to_le_bytes());
    put((name, 12), words.collect(), form, output)
}

fn put((name, stride): (&str, usize), rows: Vec<u8>, form: Object, output: &mut Output) -> usize {
    let kind = Kind { name: format!("copy {name}"), content: Content::Rows, stride, target: None };
    let span = output.put(&kind, rows);
    output.accessor(span, form)
}

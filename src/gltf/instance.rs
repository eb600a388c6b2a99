//! Many copies of a mesh in one node, by `EXT_mesh_gpu_instancing`, and back.
//!
//! Copies of a mesh on a grid take it to metres themselves: their factors hold the step of the grid, their places its offset.
//! Read back they are nodes below the one that shows them, `NODE.0`, `NODE.1`... as they are in files without the extension;
//! these stand after all others.
//!
//! Source: Khronos, `EXT_mesh_gpu_instancing`, 2020.

use glam::{DQuat, DVec3, Quat, Vec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::extensions::scene::Node as Extensions;
use gltf::json::scene::UnitQuaternion;
use gltf::json::{Accessor, Index, Node, Root};
use serde_json::{Map, Value, json};

use super::buffer::{Binary, Content, Elements, accessor, at};
use super::read::Read;
use super::vector::put;
use crate::scene::{Grid, Instance, Scene};

/// The extension.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";

/// Writes the places of all nodes that show their mesh more than once. Nodes of the scene have their numbers in the file.
pub(super) fn write(root: &mut Root, binary: &mut Binary, scene: &Scene) {
    for (index, node) in scene.nodes.iter().enumerate().filter(|(_, node)| !node.instances.is_empty()) {
        let all: Vec<Instance> = node.instances.iter().map(|own| on_grid(own, scene.grid)).collect();
        let mut told = Map::new();
        let mut tell = |name: &str, shape: Type, width: usize, number: &dyn Fn(&Instance) -> [f32; 4]| {
            let accessor = column((&mut *root, &mut *binary), (shape, width), all.iter().map(number));
            told.insert(name.to_owned(), json!(accessor.value()));
        };
        let wide = |vector: DVec3| vector.as_vec3().extend(0.0).to_array();
        tell("TRANSLATION", Type::Vec3, 3, &|own| wide(own.translation));
        if all.iter().any(|own| own.rotation != DQuat::IDENTITY) {
            tell("ROTATION", Type::Vec4, 4, &|own| own.rotation.as_quat().normalize().to_array());
        }
        if all.iter().any(|own| own.scale != DVec3::ONE) {
            tell("SCALE", Type::Vec3, 3, &|own| wide(own.scale));
        }
        let others = Map::from_iter([(INSTANCES.to_owned(), json!({ "attributes": told }))]);
        root.nodes[index].extensions.get_or_insert_with(Extensions::default).others.extend(others);
    }
    if scene.nodes.iter().any(|node| !node.instances.is_empty()) {
        root.extensions_used.push(INSTANCES.to_owned());
        root.extensions_required.push(INSTANCES.to_owned());
    }
}

/// The place of a mesh whose positions are whole numbers of a grid.
fn on_grid(own: &Instance, grid: Option<Grid>) -> Instance {
    let Some(grid) = grid else { return *own };
    let translation = own.translation + own.rotation * (own.scale * grid.offset);
    Instance { translation, rotation: own.rotation, scale: own.scale * grid.step }
}

fn column(
    (root, binary): (&mut Root, &mut Binary),
    (shape, width): (Type, usize),
    rows: impl ExactSizeIterator<Item = [f32; 4]>,
) -> Index<Accessor> {
    let start = binary.start();
    let count = rows.len();
    rows.for_each(|row| row[..width].iter().for_each(|number| put(&mut binary.bytes, [*number])));
    let view = binary.view(root, start, None, Content::Attributes { stride: 4 * width });
    root.push(accessor(view, 0, Elements { component: ComponentType::F32, shape, count }, None))
}

/// Makes copies nodes again. Those of other writers whose places are no floats, or not all as many, stay as they are.
pub(super) fn unfold(read: &mut Read<'_>) {
    for parent in 0..read.root.nodes.len() {
        let extensions = read.root.nodes[parent].extensions.as_ref();
        let Some(own) = extensions.and_then(|own| own.others.get(INSTANCES)) else { continue };
        let attributes = own["attributes"].clone();
        let index = |name: &str| {
            let number = attributes.get(name).and_then(Value::as_u64);
            number.map(|number| Index::new(u32::try_from(number).unwrap_or(u32::MAX)))
        };
        let translations = index("TRANSLATION").map(|own| read.floats::<3>(own, Type::Vec3)).transpose();
        let rotations = index("ROTATION").map(|own| read.floats::<4>(own, Type::Vec4)).transpose();
        let scales = index("SCALE").map(|own| read.floats::<3>(own, Type::Vec3)).transpose();
        let (Ok(translations), Ok(rotations), Ok(scales)) = (translations, rotations, scales) else {
            continue;
        };
        let lengths = [
            translations.as_ref().map(Vec::len),
            rotations.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
        ];
        let mut lengths = lengths.into_iter().flatten();
        let Some(count) = lengths.next().filter(|first| lengths.all(|length| length == *first)) else {
            continue;
        };
        if let Some(own) = &mut read.root.nodes[parent].extensions {
            own.others.remove(INSTANCES);
        }
        let (mesh, name) = (read.root.nodes[parent].mesh.take(), read.root.nodes[parent].name.clone());
        let name = name.unwrap_or_default();
        let first = read.root.nodes.len();
        for place in 0..count {
            let scale = Vec3::from_array(scales.as_ref().map_or([1.0; 3], |all| all[place])).as_dvec3();
            let turn = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |all| all[place]);
            let rotation = Quat::from_array(turn).as_dquat().normalize();
            let from = translations.as_ref().map_or([0.0; 3], |all| all[place]);
            let mut own = Instance { translation: Vec3::from_array(from).as_dvec3(), rotation, scale };
            if let Some(grid) = read.grid {
                own.scale /= grid.step;
                own.translation -= own.rotation * (own.scale * grid.offset);
            }
            read.root.nodes.push(Node {
                name: Some(format!("{name}.{place}")),
                mesh,
                translation: Some(own.translation.as_vec3().to_array()),
                rotation: rotations.as_ref().map(|_| UnitQuaternion(turn)),
                scale: scales.as_ref().map(|_| own.scale.as_vec3().to_array()),
                ..Node::default()
            });
        }
        read.root.nodes[parent].children.get_or_insert_default().extend((first..first + count).map(at));
        read.copies += count;
    }
}

//! Nodes, and the meshes they show.

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::limit::{Cost, Spent};
use super::material::{grouped, part_names};
use super::shape::{self, Made, Maker};
use super::textured::wants_uv;
use super::vertex_color::is_colored;
use super::{Options, RealizeError, Realized, morph, motion};
use crate::geometry::mesh;
use crate::model::{MaterialHandle, Model, ShapeHandle};
use crate::scene::{Geometry, MeshUse, MorphTarget, Node, Scene};

/// A shape with the material that a node puts on it.
type Shown = (ShapeHandle, Option<MaterialHandle>);

/// A shape as triangles with its states.
type Morphed = (Made, Vec<MorphTarget>);

pub(super) fn scene(
    model: &Model,
    options: &Options<'_>,
) -> Result<Realized, Vec<(ShapeHandle, RealizeError)>> {
    let mut shown: Vec<Shown> = Vec::new();
    for node in &model.nodes {
        let Some(shape) = node.shape else { continue };
        if !shown.contains(&(shape, node.material)) {
            shown.push((shape, node.material));
        }
    }
    let mut shapes: Vec<ShapeHandle> = Vec::new();
    for (shape, _) in &shown {
        if !shapes.contains(shape) {
            shapes.push(*shape);
        }
    }
    let made = make_all(model, options, &shapes, &shown)?;
    let mut realized = assemble((model, options.apart), &shapes, &shown, made);
    if !model.skeletons.is_empty() || !model.clips.is_empty() {
        let used = used_materials(&shown, &shapes, realized.materials.iter().map(Vec::as_slice));
        let baked = motion::add((model, &used), &shapes, &mut realized.scene)?;
        (realized.loose, realized.unseen) = baked;
    }
    Ok(realized)
}

fn make_all(
    model: &Model,
    options: &Options<'_>,
    shapes: &[ShapeHandle],
    shown: &[Shown],
) -> Result<Vec<Morphed>, Vec<(ShapeHandle, RealizeError)>> {
    let maker = Maker::new(model, options);
    let spent = Spent::default();
    let make = |handle: &ShapeHandle| {
        spent.check(&model.limits).map_err(|error| (*handle, error))?;
        let overrides: Vec<_> =
            shown.iter().filter(|(shape, _)| shape == handle).map(|(_, material)| *material).collect();
        let uv = wants_uv(model, *handle, &overrides);
        let finished = |maker: &Maker<'_>, handle: ShapeHandle| {
            let mut made = maker.make(handle, uv)?;
            shape::to_metres(&mut made, &model.frame);
            Ok(grouped(made, options.apart))
        };
        let made = finished(&maker, *handle).map_err(|error| (*handle, error))?;
        let states = model.morphs_of(*handle).count() as u64;
        let cost = Cost::of(&made.mesh).plus(Cost::of_wire(&made.wire));
        let morphed = cost.with_states(&made.mesh, states);
        morphed.check(&model.limits).map_err(|error| (*handle, error))?;
        spent.add(morphed);
        morph::morphed((model, *handle), options, made, &finished).map_err(|error| (*handle, error))
    };
    // One shape is made on this thread: waking others costs more than a small shape takes.
    let results: Vec<Result<Morphed, _>> =
        if let [one] = shapes { vec![make(one)] } else { shapes.par_iter().map(make).collect() };
    // Which shapes were still made when the sum passed a limit depends on the threads; that it passed does not.
    if let (Err(error), Some(first)) = (spent.check(&model.limits), shapes.first()) {
        return Err(vec![(*first, error)]);
    }
    let mut made = Vec::new();
    let mut errors = Vec::new();
    for result in results {
        match result {
            Ok(one) => made.push(one),
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() { Ok(made) } else { Err(errors) }
}

fn assemble(
    (model, apart): (&Model, bool),
    shapes: &[ShapeHandle],
    shown: &[Shown],
    made: Vec<Morphed>,
) -> Realized {
    let own = made.iter().map(|(made, _)| made.materials.as_slice());
    let materials = used_materials(shown, shapes, own);
    let position = |handle: MaterialHandle| materials.iter().position(|known| *known == handle);
    let mut scene = Scene { name: model.name.clone(), ..Scene::default() };
    for (shape, material) in shown {
        let geometry = shapes.iter().position(|known| known == shape).unwrap_or(0);
        let own = &made[geometry].0.materials;
        let worn = own.iter().map(|own| material.or(*own).and_then(position)).collect();
        let name = match material {
            Some(material)
                if shown.iter().any(|(other, plain)| other == shape && plain != &Some(*material)) =>
            {
                format!("{}.{}", model.shape(*shape).name, model.material(*material).name)
            }
            _ => model.shape(*shape).name.clone(),
        };
        scene.meshes.push(MeshUse { name, geometry, materials: worn, levels: Vec::new() });
    }
    let mut notes = Vec::new();
    let own = made.iter().map(|(made, _)| made.materials.clone()).collect();
    for ((made, targets), handle) in made.into_iter().zip(shapes) {
        let overrides: Vec<_> =
            shown.iter().filter(|(shape, _)| shape == handle).map(|(_, material)| *material).collect();
        notes.extend(&made.notes);
        scene.geometries.push(Geometry {
            name: model.shape(*handle).name.clone(),
            uv: wants_uv(model, *handle, &overrides),
            colored: is_colored(&made.mesh, &made.wire),
            tolerance: made.tolerance,
            deviation: made.deviation,
            parts: if apart { part_names(model, *handle, &made) } else { Vec::new() },
            mesh: made.mesh,
            wire: made.wire,
            tangents: None,
            lightmap: None,
            attributes: Vec::new(),
            influences: None,
            targets,
        });
    }
    scene.materials = materials.iter().map(|handle| model.material(*handle).clone()).collect();
    keep_used_images(model, &mut scene);
    scene.nodes = nodes(model, shown);
    Realized { scene, shapes: shapes.to_vec(), materials: own, loose: Vec::new(), unseen: Vec::new(), notes }
}

fn used_materials<'m>(
    shown: &[Shown],
    shapes: &[ShapeHandle],
    own: impl Iterator<Item = &'m [Option<MaterialHandle>]>,
) -> Vec<MaterialHandle> {
    let made: Vec<&[Option<MaterialHandle>]> = own.collect();
    let mut used = Vec::new();
    for (shape, material) in shown {
        let geometry = shapes.iter().position(|known| known == shape).unwrap_or(0);
        for own in made[geometry] {
            if let Some(handle) = material.or(*own)
                && !used.contains(&handle)
            {
                used.push(handle);
            }
        }
    }
    used
}

/// Leaves out images that no material shows and renumbers the rest.
fn keep_used_images(model: &Model, scene: &mut Scene) {
    let mut kept: Vec<u32> = Vec::new();
    let mut keep = |image: &mut crate::model::ImageHandle| {
        let place = kept.iter().position(|known| *known == image.0).unwrap_or_else(|| {
            kept.push(image.0);
            kept.len() - 1
        });
        image.0 = mesh::index(place);
    };
    for material in &mut scene.materials {
        material.textures_mut().for_each(|(texture, _)| keep(&mut texture.image));
    }
    scene.images = kept.iter().map(|image| model.images[*image as usize].clone()).collect();
}

fn nodes(model: &Model, shown: &[Shown]) -> Vec<Node> {
    let place = |node: &crate::model::Node| {
        let shape = node.shape?;
        shown.iter().position(|known| *known == (shape, node.material))
    };
    let frame = &model.frame;
    let (turn, axes) = (frame.turn(), frame.axes());
    model
        .nodes
        .iter()
        .map(|node| Node {
            name: node.name.clone(),
            mesh: place(node),
            skin: None,
            socket: node.is_socket,
            copy: node.is_copy,
            instances: Vec::new(),
            camera: node.camera,
            light: node.light,
            parent: node.parent,
            translation: axes * node.translation * model.frame.unit,
            rotation: (turn * node.rotation * turn.conjugate()).normalize(),
            scale: frame.scale(node.scale),
        })
        .collect()
}

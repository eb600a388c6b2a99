//! The proof that skins and motions can be written.

use super::SceneError;
use crate::motion::{Influences, Path, Property};
use crate::scene::{Animation, Channel, Geometry, Lens, Owner, PropertyChannel, Scene, Skin};

pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    for skin in &scene.skins {
        check_skin(scene, skin).map_err(|what| SceneError::Skin(skin.name.clone(), what))?;
    }
    for node in &scene.nodes {
        let Some(skin) = node.skin else { continue };
        let dangling = || SceneError::Dangling(format!("node `{}`", node.name));
        let skin = scene.skins.get(skin).ok_or_else(dangling)?;
        let mesh = node.mesh.and_then(|mesh| scene.meshes.get(mesh)).ok_or_else(dangling)?;
        let levels = mesh.levels.iter().filter_map(|level| scene.meshes.get(level.mesh));
        for mesh in std::iter::once(mesh).chain(levels) {
            check_weights(&scene.geometries[mesh.geometry], skin)
                .map_err(|what| SceneError::Skin(skin.name.clone(), what))?;
        }
    }
    for animation in &scene.animations {
        check_animation(scene, animation)
            .map_err(|what| SceneError::Animation(animation.name.clone(), what))?;
    }
    Ok(())
}

fn check_weights(geometry: &Geometry, skin: &Skin) -> Result<(), &'static str> {
    let influences = geometry.influences.as_ref().ok_or("a shape without weights")?;
    if influences.len() != geometry.mesh.points.len() {
        return Err("weights for other points than those of its shape");
    }
    if !influences.iter().all(|one| whole(one, skin.joints.len())) {
        return Err("weights that do not sum to 255, or of joints it does not have");
    }
    Ok(())
}

fn whole(influences: &Influences, joints: usize) -> bool {
    let sum: u32 = influences.iter().map(|one| u32::from(one.weight)).sum();
    let named = |joint: u8| usize::from(joint) < joints;
    sum == 255 && influences.iter().all(|one| named(one.joint) && (one.weight > 0 || one.joint == 0))
}

fn check_skin(scene: &Scene, skin: &Skin) -> Result<(), &'static str> {
    if skin.joints.is_empty() || skin.joints.len() > 256 {
        return Err("no joint, or more than 256");
    }
    if skin.inverse_bind.len() != skin.joints.len() {
        return Err("another number of inverse bind maps than joints");
    }
    if skin.joints.iter().any(|joint| *joint >= scene.nodes.len()) || skin.root >= scene.nodes.len() {
        return Err("a joint that does not exist");
    }
    let limit = f64::from(f32::MAX);
    let finite = |map: &glam::DAffine3| map.to_cols_array().iter().all(|number| number.abs() <= limit);
    if skin.inverse_bind.iter().all(finite) { Ok(()) } else { Err("a map that is not finite") }
}

fn check_animation(scene: &Scene, animation: &Animation) -> Result<(), &'static str> {
    if animation.channels.is_empty() && animation.properties.is_empty() {
        return Err("no channel");
    }
    let mut moved: Vec<(usize, Path)> =
        animation.channels.iter().map(|channel| (channel.node, channel.path)).collect();
    moved.sort_unstable();
    if moved.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("one part of a node in motion twice");
    }
    let mut changed: Vec<_> =
        animation.properties.iter().map(|channel| (channel.owner, channel.property)).collect();
    changed.sort_unstable();
    if changed.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("one property in change twice");
    }
    animation.properties.iter().try_for_each(|channel| check_property(scene, channel))?;
    animation.channels.iter().try_for_each(|channel| check_channel(scene, channel))
}

fn check_property(scene: &Scene, channel: &PropertyChannel) -> Result<(), &'static str> {
    if !has(scene, channel) {
        return Err("a change of what does not have that property");
    }
    let (least, most) = channel.property.range();
    // Lengths are held against their range in the document's unit, not in metres.
    let least = if channel.property.is_length() { 0.0 } else { least };
    let within = |value: &f64| value.is_finite() && *value >= least - 1e-6 && *value <= most + 1e-6;
    if !channel.values.iter().all(within) {
        return Err("a value that a property cannot have");
    }
    check_keys(&channel.times, &channel.values, channel.property.width())
}

/// Whether something has the property that changes.
fn has(scene: &Scene, channel: &PropertyChannel) -> bool {
    match channel.owner {
        Owner::Material(material) => {
            scene.materials.get(material).is_some_and(|own| own.value(channel.property).is_some())
        }
        Owner::Node(node) => scene.nodes.get(node).is_some_and(|own| {
            let lens = own.camera.map(|camera| camera.lens);
            match channel.property {
                Property::LightColor | Property::Intensity => own.light.is_some(),
                Property::Range => own.light.is_some_and(|light| light.range.is_some()),
                Property::FieldOfView => matches!(lens, Some(Lens::Perspective { .. })),
                Property::Height => matches!(lens, Some(Lens::Parallel { .. })),
                _ => false,
            }
        }),
    }
}

/// Times that increase, with so many finite numbers each.
fn check_keys(times: &[f64], values: &[f64], width: usize) -> Result<(), &'static str> {
    if times.is_empty() || times.len() * width != values.len() {
        return Err("another number of values than times");
    }
    // They are written in single precision, where they must still increase.
    let times: Vec<f32> = times.iter().map(|time| crate::geometry::number::single(*time)).collect();
    if times[0] < 0.0 || !times.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err("times that do not increase from 0");
    }
    let limit = f64::from(f32::MAX);
    if values.iter().all(|value| value.abs() <= limit) { Ok(()) } else { Err("a value that is not finite") }
}

/// How many numbers a channel has for each time.
fn width(scene: &Scene, channel: &Channel) -> Result<usize, &'static str> {
    Ok(match channel.path {
        Path::Translation | Path::Scale => 3,
        Path::Rotation => 4,
        Path::Weight => {
            let mesh = scene.nodes[channel.node].mesh.map(|mesh| scene.meshes[mesh].geometry);
            let targets = mesh.map_or(0, |geometry| scene.geometries[geometry].targets.len());
            if targets == 0 {
                return Err("weights of a node without morph targets");
            }
            targets
        }
    })
}

fn check_channel(scene: &Scene, channel: &Channel) -> Result<(), &'static str> {
    if channel.node >= scene.nodes.len() {
        return Err("a node that does not exist");
    }
    let width = width(scene, channel)?;
    check_keys(&channel.times, &channel.values, width)?;
    let unit = |value: &[f64]| (value.iter().map(|part| part * part).sum::<f64>() - 1.0).abs() < 1e-5;
    if channel.path == Path::Rotation && !channel.values.chunks(width).all(unit) {
        return Err("a rotation that is not of unit length");
    }
    Ok(())
}

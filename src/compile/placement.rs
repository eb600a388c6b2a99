//! Where a model stands in a file: forward axis, pivot and scale of `[output]`.
//!
//! A node at the top carries all others, rather than that vertices are moved: so one mesh serves every node that shows it,
//! skins, motions, sockets and bodies stay as the document says, and positions keep their grid and their proved distance.
//! Every engine applies nodes. What joints carry stands at the top itself, as the format advises: its joints carry it along.

use glam::{DAffine3, DQuat, DVec3};

use super::profile_of;
use crate::geometry::number::Bounds;
use crate::gltf::Profile;
use crate::language::spec::{Forward, Pivot, Spec};
use crate::model::Frame;
use crate::motion::Property;
use crate::scene::{Lens, LightKind, Node, Owner, PropertyChannel, Scene};

/// A model turned about y, moved and scaled.
pub(super) struct Placement {
    pivot: DVec3,
    rotation: DQuat,
    scale: f64,
}

/// Where the model stands in the files of a profile; `None` where that is as it stands in the document.
pub(super) fn placement(scene: &Scene, frame: &Frame, spec: &Spec, profile: Profile) -> Option<Placement> {
    const HALF_ROOT: f64 = core::f64::consts::FRAC_1_SQRT_2;
    let is = |name| profile_of(name) == profile;
    let output = &spec.output;
    let pivot = output.pivot.as_ref().and_then(|pivot| pivot.of(is)).map_or(Pivot::Origin, |own| own.value);
    let pivot = match pivot {
        Pivot::Origin => DVec3::ZERO,
        Pivot::Point(point) => frame.map().transform_point3(point),
        Pivot::Center => middle(&bounds(scene)),
        Pivot::Base => {
            let bounds = bounds(scene);
            middle(&bounds).with_y(bounds.min.y)
        }
    };
    let forward = output.forward.as_ref().and_then(|forward| forward.of(is));
    let rotation = match forward.map_or(Forward::Z, |own| own.value) {
        Forward::Z => DQuat::IDENTITY,
        Forward::NegativeZ => DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0),
        Forward::X => DQuat::from_xyzw(0.0, HALF_ROOT, 0.0, HALF_ROOT),
        Forward::NegativeX => DQuat::from_xyzw(0.0, -HALF_ROOT, 0.0, HALF_ROOT),
    };
    let scale = output.scale.as_ref().and_then(|scale| scale.of(is)).map_or(1.0, |own| own.value.0);
    let moves = pivot != DVec3::ZERO || rotation != DQuat::IDENTITY || scale != 1.0;
    moves.then_some(Placement { pivot, rotation, scale })
}

fn middle(bounds: &Bounds) -> DVec3 {
    (bounds.min + bounds.max) / 2.0
}

/// The box of all that nodes show at rest. Linear in the vertices times the nodes that show them.
fn bounds(scene: &Scene) -> Bounds {
    let world = |node: &Node| {
        let mut map = own(node);
        let mut above = node.parent;
        while let Some(parent) = above.map(|parent| &scene.nodes[parent]) {
            map = own(parent) * map;
            above = parent.parent;
        }
        map
    };
    let mut bounds = Bounds::EMPTY;
    for node in &scene.nodes {
        let Some(mesh) = node.mesh else { continue };
        let (geometry, map) = (&scene.geometries[scene.meshes[mesh].geometry], world(node));
        let lines = geometry.wire.points.iter().map(|point| point.position);
        let all = geometry.mesh.points.iter().copied().chain(lines);
        bounds = all.fold(bounds, |bounds, point| bounds.with_point(map.transform_point3(point)));
    }
    bounds
}

fn own(node: &Node) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(node.scale, node.rotation, node.translation)
}

impl Placement {
    /// Puts a node above all others, and makes lights, cameras and what bodies take of light reach as far as it scales.
    pub(super) fn place(&self, scene: &mut Scene) {
        let root = scene.nodes.len();
        let skinned: Vec<bool> = scene.nodes.iter().map(|node| node.skin.is_some()).collect();
        // What joints carry stands at the origin: what hangs on it stands there in the scene.
        let stands_at_top = |parent: Option<usize>| parent.is_none_or(|parent| skinned[parent]);
        for (node, skinned) in scene.nodes.iter_mut().zip(&skinned) {
            if !skinned && stands_at_top(node.parent) {
                node.parent = Some(root);
            }
            if self.scale != 1.0 {
                scale_view(node, self.scale);
            }
        }
        for collider in scene.colliders.iter_mut().filter(|collider| skinned[collider.node]) {
            collider.node = root;
        }
        let mut name = scene.name.clone();
        while scene.nodes.iter().any(|node| node.name == name) {
            name.push_str(".root");
        }
        scene.nodes.push(Node {
            name,
            mesh: None,
            skin: None,
            socket: false,
            copy: false,
            instances: Vec::new(),
            camera: None,
            light: None,
            parent: None,
            translation: self.rotation * -self.pivot * self.scale,
            rotation: self.rotation,
            scale: DVec3::splat(self.scale),
        });
        scene.root = Some(root);
        // A thickness is scaled by the nodes; the way in a body is one of the scene.
        for material in &mut scene.materials {
            let distance = material.optics.volume.as_mut().and_then(|own| own.attenuation_distance.as_mut());
            distance.into_iter().for_each(|distance| *distance *= self.scale);
        }
        for animation in &mut scene.animations {
            animation.reach = animation.reach.map(|reach| self.box_of(reach));
            animation.bound *= self.scale;
            animation.tolerance *= self.scale;
            for channel in &mut animation.properties {
                scale_channel(channel, &scene.nodes, self.scale);
            }
        }
    }

    /// The box around what a box becomes.
    fn box_of(&self, (min, max): (DVec3, DVec3)) -> (DVec3, DVec3) {
        let place = |corner: DVec3| self.rotation * (corner - self.pivot) * self.scale;
        let pick = |k: usize| {
            DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { min[axis] } else { max[axis] }))
        };
        let bounds = Bounds::of_points((0..8).map(|k| place(pick(k))));
        (bounds.min, bounds.max)
    }
}

/// What changes how far lights and cameras reach.
fn scale_channel(channel: &mut PropertyChannel, nodes: &[Node], scale: f64) {
    let sun = match channel.owner {
        Owner::Node(node) => nodes[node].light.is_some_and(|light| light.kind == LightKind::Sun),
        Owner::Material(_) => false,
    };
    let factor = match channel.property {
        Property::AttenuationDistance | Property::Range | Property::Height => scale,
        Property::Intensity if !sun => scale * scale,
        _ => return,
    };
    channel.values.iter_mut().for_each(|value| *value *= factor);
    channel.bound *= factor;
    channel.tolerance *= factor;
}

/// A node above scales places, not what cameras see or how far lights reach. A light that is further away has to be brighter by
/// the square of that to look as before; a sun is as far as ever.
fn scale_view(node: &mut Node, scale: f64) {
    if let Some(camera) = &mut node.camera {
        camera.near *= scale;
        camera.far = camera.far.map(|far| far * scale);
        if let Lens::Parallel { height } = &mut camera.lens {
            *height *= scale;
        }
    }
    if let Some(light) = &mut node.light {
        light.range = light.range.map(|range| range * scale);
        if light.kind != LightKind::Sun {
            light.intensity *= scale * scale;
        }
    }
}

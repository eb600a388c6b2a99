//! What a glTF file changes besides joints: states of the shapes that show its meshes, and properties of the materials that
//! look as its own do.

use glam::{DAffine3, DVec4};

use super::Builder;
use super::frames::unique;
use super::gltf::keys_of;
use super::import::{axes_between, default_up};
use crate::import::gltf::{self, Channel, Clip, Node, PropertyChannel, Track};
use crate::language::source::Span;
use crate::language::spec::{FilePath, Frames, Import};
use crate::model::{ClipTrack, MaterialHandle, PropertyTrack, Recipe, ShapeHandle, Space, Target};
use crate::motion::{Course, Law, Property};

/// What of files other files' motions may move.
#[derive(Default)]
pub(super) struct FromFiles {
    /// States of nodes of files.
    states: Vec<Known>,
    /// Paths of files, numbers of their materials, and materials that stand for them.
    looks: Vec<(String, usize, MaterialHandle)>,
}

/// A state of a shape that came from a file.
struct Known {
    file: String,
    /// The node of the file, and the number of the state among those of its mesh.
    node: usize,
    target: usize,
    shape: ShapeHandle,
    /// The number of the state among those of the shape.
    own: usize,
}

impl FromFiles {
    pub(super) fn wears(&mut self, file: &FilePath, number: usize, material: MaterialHandle) {
        self.looks.push((file.resolved.clone(), number, material));
    }
}

impl Builder<'_> {
    /// Makes the morph targets of a file states of the shape that shows it.
    pub(super) fn file_states(
        &mut self,
        name: &str,
        shape: ShapeHandle,
        import: &Import,
        span: Span,
    ) -> Option<()> {
        if import.frames.value == Frames::One || import.weld.is_some() {
            return None;
        }
        // The shape was read, so that this succeeds again.
        let found = self.gltf_weighted(import)?;
        if found.states.is_empty() {
            return None;
        }
        let up = import.up.map_or_else(|| default_up(&import.file), |up| up.value);
        let map = DAffine3::from_mat3(axes_between(up, self.spec.up) * import.scale.value);
        let base = self.model.shape(shape).clone();
        let Recipe::Polygons { materials, .. } = base.recipe else { return None };
        let recipe = |weights: &[f64]| {
            let mut mesh = found.at(weights);
            mesh.transform(&map);
            Recipe::Polygons { mesh, materials: materials.clone() }
        };
        let still = vec![0.0; found.states.len()];
        // What counts at rest is told by the weights of the states.
        self.model.shapes[shape.0 as usize].recipe = recipe(&still);
        let mut names: Vec<String> = Vec::with_capacity(found.states.len());
        for (own, state) in found.states.iter().enumerate() {
            let target = unique(&state.name, own, "state", &names);
            names.push(target.clone());
            let mut weights = still.clone();
            weights[own] = 1.0;
            self.push_state((shape, span), (name, target), recipe(&weights), state.weight);
            let file = import.file.value.resolved.clone();
            self.from_files.states.push(Known { file, node: state.node, target: state.target, shape, own });
        }
        Some(())
    }

    /// The tracks of the weights of a file's node; none where no shape of the document has its states.
    pub(super) fn weight_tracks(&self, file: &FilePath, channel: &Channel) -> Option<Vec<ClipTrack>> {
        let Track::Weights(values) = &channel.track else { return None };
        let rows = channel.times.len() * if channel.steps == gltf::Steps::Cubic { 3 } else { 1 };
        let width = values.len() / rows.max(1);
        let mut tracks = Vec::new();
        let here = |known: &&Known| {
            known.file == file.resolved && known.node == channel.node && known.target < width
        };
        for known in self.from_files.states.iter().filter(here) {
            let numbers =
                (0..rows).map(|row| DVec4::X * f64::from(values[row * width + known.target])).collect();
            let keys = keys_of((&channel.times, channel.steps), numbers, &|value| value, &|slope| slope);
            tracks.extend(self.showing(known.shape).into_iter().map(|node| ClipTrack {
                target: Target::Weight { node, target: known.own },
                course: Course::Weight(Law::Keys(keys.clone())),
                space: Space::Document,
                clamp: None,
            }));
        }
        (!tracks.is_empty()).then_some(tracks)
    }

    /// The track of a property of a file's material; none where nothing of the document looks like it or has the property.
    pub(super) fn property_tracks(
        &self,
        file: &FilePath,
        channel: &PropertyChannel,
    ) -> Option<PropertyTrack> {
        let (number, path) = channel.pointer.strip_prefix("/materials/")?.split_once('/')?;
        let number: usize = number.parse().ok()?;
        let property = match path {
            "pbrMetallicRoughness/baseColorFactor" => Property::Color,
            "pbrMetallicRoughness/metallicFactor" => Property::Metallic,
            "pbrMetallicRoughness/roughnessFactor" => Property::Roughness,
            "emissiveFactor" => Property::Emissive,
            "normalTexture/scale" => Property::NormalScale,
            "occlusionTexture/strength" => Property::OcclusionStrength,
            "alphaCutoff" => Property::AlphaCutoff,
            "extensions/KHR_materials_emissive_strength/emissiveStrength" => Property::EmissiveStrength,
            _ => return None,
        };
        let has = |handle: &MaterialHandle| self.model.material(*handle).value(property).is_some();
        let looks = self.from_files.looks.iter();
        let looks = looks.filter(|(known, of, _)| *known == file.resolved && *of == number);
        let mut owners: Vec<MaterialHandle> = looks.map(|(.., handle)| *handle).filter(has).collect();
        owners.sort_unstable();
        owners.dedup();
        let width = property.width();
        let rows = channel.times.len() * if channel.steps == gltf::Steps::Cubic { 3 } else { 1 };
        if owners.is_empty() || channel.values.len() != rows * width {
            return None;
        }
        let number = |row: &[f32]| {
            let part = |k: usize| row.get(k).map_or(0.0, |part| f64::from(*part));
            DVec4::new(part(0), part(1), part(2), part(3))
        };
        let numbers = channel.values.chunks_exact(width).map(number).collect();
        let keys = keys_of((&channel.times, channel.steps), numbers, &|value| value, &|slope| slope);
        Some(PropertyTrack {
            owner: self.wearing_all(&owners),
            property,
            first: 0,
            count: width,
            course: Course::Offset(Law::Keys(keys)),
            clamp: true,
        })
    }
}

/// What of an animation the document does not play, each in words.
pub(super) fn words_of(channel: &Channel, nodes: &[Node]) -> String {
    let path = match &channel.track {
        Track::Translation(_) => "translation",
        Track::Rotation(_) => "rotation",
        Track::Scale(_) => "scale",
        Track::Weights(_) => "weights",
    };
    let name = nodes.get(channel.node).map_or("", |node| node.name.as_str());
    match name {
        "" => format!("the {path} of node {}", channel.node),
        name => format!("the {path} of node `{name}`"),
    }
}

/// A file's animation, its nodes and whether one of them is a joint.
pub(super) struct Playing<'a> {
    pub(super) own: &'a Clip,
    pub(super) nodes: &'a [Node],
    pub(super) is_joint: &'a dyn Fn(usize) -> bool,
}

impl Builder<'_> {
    /// Everything in an animation that moves no joint, and what of it is left out.
    pub(super) fn beside_joints(
        &self,
        file: &FilePath,
        playing: &Playing<'_>,
    ) -> (Vec<ClipTrack>, Vec<PropertyTrack>, Vec<String>) {
        let (mut tracks, mut properties, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
        for channel in &playing.own.channels {
            match &channel.track {
                Track::Weights(_) => match self.weight_tracks(file, channel) {
                    Some(made) => tracks.extend(made),
                    None => left_out.push(format!(
                        "{}: no shape that a node shows is imported from this node with its states",
                        words_of(channel, playing.nodes)
                    )),
                },
                _ if (playing.is_joint)(channel.node) => {}
                _ => left_out.push(format!("{}, which is no joint", words_of(channel, playing.nodes))),
            }
        }
        for channel in &playing.own.properties {
            match self.property_tracks(file, channel) {
                Some(made) => properties.push(made),
                None => left_out.push(format!(
                    "`{}`: no imported material of this document has the property",
                    channel.pointer
                )),
            }
        }
        (tracks, properties, left_out)
    }
}

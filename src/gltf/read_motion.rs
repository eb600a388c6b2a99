//! The skins and animations in the bytes of a `.glb` file, for the report.
//!
//! Reads what our own writer writes: joints and weights of one byte, float matrices, keys that step or run straight.

use glam::{DMat4, Mat4};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::animation::{Interpolation, Property};
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};

use super::read::{Read, ReadError, elements, kind};
use crate::motion::Path;
use crate::packing::PointerChannel;

/// A skin of a file.
#[derive(Clone, Debug)]
pub struct ReadSkin {
    /// Indices of nodes.
    pub joints: Vec<usize>,
    /// For each joint its inverse bind matrix.
    pub inverse_bind: Vec<DMat4>,
}

/// A vertex's joints and weights, which sum to 1.
pub type ReadInfluences = [(usize, f64); 4];

/// An animation of a file.
#[derive(Clone, Debug)]
pub struct ReadAnimation {
    /// Its channels.
    pub channels: Vec<ReadChannel>,
    /// Its channels that point at properties.
    pub properties: Vec<ReadProperty>,
}

/// A channel that points at a property.
#[derive(Clone, Debug)]
pub struct ReadProperty {
    /// The JSON pointer.
    pub pointer: String,
    /// Whether values stay until the next key.
    pub stepped: bool,
    /// Seconds.
    pub times: Vec<f64>,
    /// For each time as many numbers.
    pub values: Vec<f64>,
}

/// A channel of an animation.
#[derive(Clone, Debug)]
pub struct ReadChannel {
    /// The node.
    pub node: usize,
    /// Which part of it.
    pub path: Path,
    /// Whether values stay until the next key.
    pub stepped: bool,
    /// Seconds.
    pub times: Vec<f64>,
    /// For each time as many numbers: translations and scales x, y and z, rotations x, y, z and w, weights one for each
    /// morph target.
    pub values: Vec<f64>,
}

impl Read<'_> {
    /// The skins of a file.
    ///
    /// # Errors
    /// When they are broken or not written as ours are.
    pub fn skins(&self) -> Result<Vec<ReadSkin>, ReadError> {
        let skin = |skin: &gltf::json::Skin| {
            let matrices = skin.inverse_bind_matrices;
            let matrices = matrices.ok_or_else(|| ReadError::Missing("inverse bind matrices".to_owned()))?;
            let rows = self.floats::<16>(matrices, Type::Mat4)?;
            // Positions are read in metres: the way from the grid to them is taken out again.
            let from_metres = self.grid.map_or(DMat4::IDENTITY, |grid| DMat4::from(grid.affine().inverse()));
            let matrix = |row: &[f32; 16]| Mat4::from_cols_array(row).as_dmat4() * from_metres;
            Ok(ReadSkin {
                joints: skin.joints.iter().map(|joint| joint.value()).collect(),
                inverse_bind: rows.iter().map(matrix).collect(),
            })
        };
        self.root.skins.iter().map(skin).collect()
    }

    /// The joints and weights of a mesh's vertices; none where it has none.
    ///
    /// # Errors
    /// When they are broken or not written as ours are.
    pub fn influences(&self, mesh: usize) -> Result<Option<Vec<ReadInfluences>>, ReadError> {
        let primitives = &self.root.meshes[mesh].primitives;
        let named = |semantic: Semantic| {
            primitives
                .iter()
                .find_map(|primitive| primitive.attributes.get(&Checked::Valid(semantic.clone())))
        };
        let (Some(joints), Some(weights)) = (named(Semantic::Joints(0)), named(Semantic::Weights(0))) else {
            return Ok(None);
        };
        let (joints, weights) = (self.bytes(*joints)?, self.bytes(*weights)?);
        let pair = |(joints, weights): (&[u8; 4], &[u8; 4])| {
            core::array::from_fn(|place| (usize::from(joints[place]), f64::from(weights[place]) / 255.0))
        };
        Ok(Some(joints.iter().zip(&weights).map(pair).collect()))
    }

    /// The animations of a file.
    ///
    /// # Errors
    /// When they are broken or not written as ours are.
    pub fn animations(&self) -> Result<Vec<ReadAnimation>, ReadError> {
        let own = |(index, animation)| {
            let properties = self.pointers.iter().filter(|pointer| pointer.animation == index);
            let properties = properties.map(|pointer| self.property(animation, pointer));
            let properties: Result<Vec<_>, _> = properties.collect();
            self.animation(animation, properties?)
        };
        self.root.animations.iter().enumerate().map(own).collect()
    }

    fn property(
        &self,
        animation: &gltf::json::Animation,
        pointer: &PointerChannel,
    ) -> Result<ReadProperty, ReadError> {
        let sampler = animation.samplers.get(pointer.sampler);
        let sampler = sampler.ok_or_else(|| ReadError::Missing("a sampler".to_owned()))?;
        let stepped = stepped(sampler)?;
        let times = self.floats::<1>(sampler.input, Type::Scalar)?;
        let values: Vec<f32> = match kind(&self.root, sampler.output) {
            Some((_, Type::Vec3)) => self.floats::<3>(sampler.output, Type::Vec3)?.into_flattened(),
            Some((_, Type::Vec4)) => self.floats::<4>(sampler.output, Type::Vec4)?.into_flattened(),
            _ => self.floats::<1>(sampler.output, Type::Scalar)?.into_flattened(),
        };
        if times.is_empty() || values.is_empty() || !values.len().is_multiple_of(times.len()) {
            return Err(ReadError::Missing("a value of an animation".to_owned()));
        }
        Ok(ReadProperty {
            pointer: pointer.path.clone(),
            stepped,
            times: times.into_iter().map(|[time]| f64::from(time)).collect(),
            values: values.into_iter().map(f64::from).collect(),
        })
    }

    fn animation(
        &self,
        animation: &gltf::json::Animation,
        properties: Vec<ReadProperty>,
    ) -> Result<ReadAnimation, ReadError> {
        let channel = |channel: &gltf::json::animation::Channel| {
            let unsupported = |what: &str| ReadError::Unsupported(what.to_owned());
            let sampler = animation.samplers.get(channel.sampler.value());
            let sampler = sampler.ok_or_else(|| ReadError::Missing("a sampler".to_owned()))?;
            let path = match channel.target.path {
                Checked::Valid(Property::Translation) => Path::Translation,
                Checked::Valid(Property::Rotation) => Path::Rotation,
                Checked::Valid(Property::Scale) => Path::Scale,
                Checked::Valid(Property::MorphTargetWeights) => Path::Weight,
                _ => return Err(unsupported("an animated property")),
            };
            let stepped = stepped(sampler)?;
            let times = self.floats::<1>(sampler.input, Type::Scalar)?;
            let wide = |rows: &[f32]| rows.iter().map(|part| f64::from(*part)).collect();
            let values: Vec<f64> = match path {
                Path::Rotation => wide(self.floats::<4>(sampler.output, Type::Vec4)?.as_flattened()),
                Path::Weight => wide(self.floats::<1>(sampler.output, Type::Scalar)?.as_flattened()),
                _ => wide(self.floats::<3>(sampler.output, Type::Vec3)?.as_flattened()),
            };
            let width = match path {
                Path::Rotation => 4,
                Path::Weight => values.len() / times.len().max(1),
                _ => 3,
            };
            if width == 0 || values.len() != times.len() * width || times.is_empty() {
                return Err(ReadError::Missing("a value of an animation".to_owned()));
            }
            let node = channel.target.node.value();
            let shows = self.carriers.iter().find(|(carrier, _)| *carrier == node);
            Ok(ReadChannel {
                node: shows.map_or(node, |(_, shows)| *shows),
                path,
                stepped,
                times: times.into_iter().map(|[time]| f64::from(time)).collect(),
                values,
            })
        };
        // Levels that stand aside move as the finest does, and are no nodes of the scene.
        let stands = |channel: &&gltf::json::animation::Channel| {
            let node = channel.target.node.value();
            node < self.root.nodes.len() || self.carriers.iter().any(|(carrier, _)| *carrier == node)
        };
        let channels: Result<Vec<_>, _> = animation.channels.iter().filter(stands).map(channel).collect();
        Ok(ReadAnimation { channels: channels?, properties })
    }

    pub(super) fn floats<const N: usize>(
        &self,
        index: Index<Accessor>,
        shape: Type,
    ) -> Result<Vec<[f32; N]>, ReadError> {
        if kind(&self.root, index) != Some((ComponentType::F32, shape)) {
            return Err(ReadError::Unsupported(format!("accessor {} as numbers", index.value())));
        }
        let found = elements(&self.root, self.binary, index, 4 * N)?;
        let row = |element: &[u8]| {
            let (words, _) = element.as_chunks::<4>();
            core::array::from_fn(|column| f32::from_le_bytes(words[column]))
        };
        Ok(found.each(self.binary).map(row).collect())
    }

    fn bytes(&self, index: Index<Accessor>) -> Result<Vec<[u8; 4]>, ReadError> {
        if kind(&self.root, index) != Some((ComponentType::U8, Type::Vec4)) {
            return Err(ReadError::Unsupported(format!("accessor {} as joints or weights", index.value())));
        }
        let found = elements(&self.root, self.binary, index, 4)?;
        Ok(found.each(self.binary).map(|element| element.as_chunks::<4>().0[0]).collect())
    }
}

/// Whether values of a sampler stay until the next key.
fn stepped(sampler: &gltf::json::animation::Sampler) -> Result<bool, ReadError> {
    match sampler.interpolation {
        Checked::Valid(Interpolation::Step) => Ok(true),
        Checked::Valid(Interpolation::Linear) => Ok(false),
        _ => Err(ReadError::Unsupported("a cubic sampler".to_owned())),
    }
}

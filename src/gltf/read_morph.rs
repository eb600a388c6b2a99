//! The morph targets in the bytes of a `.glb` file, for the report.
//!
//! Reads what our own writer writes: floats, steps of the grid, shares of 127, dense or sparse.

use glam::DVec3;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};

use super::read::{Read, ReadError, elements_of, kind};
use crate::geometry::number::size;

/// A morph target of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadTarget {
    /// Its name.
    pub name: String,
    /// Its weight where no animation moves it.
    pub weight: f64,
    /// For each vertex how far its position moves, metres.
    pub positions: Vec<DVec3>,
    /// For each vertex how its normal changes.
    pub normals: Vec<DVec3>,
}

impl Read<'_> {
    /// The morph targets of a mesh; none where it has none.
    ///
    /// # Errors
    /// When they are broken or not written as ours are.
    pub fn targets(&self, mesh: usize) -> Result<Vec<ReadTarget>, ReadError> {
        let mesh = &self.root.meshes[mesh];
        let Some(primitive) = mesh.primitives.first() else { return Ok(Vec::new()) };
        let names = self.names(mesh);
        let step = self.grid.map_or(1.0, |grid| grid.step);
        let missing = |what: &str| ReadError::Missing(format!("{what} of a morph target"));
        let targets = primitive.targets.iter().flatten().enumerate().map(|(index, target)| {
            let positions = self.differences(target.positions.ok_or_else(|| missing("POSITION"))?)?;
            let normals = self.differences(target.normals.ok_or_else(|| missing("NORMAL"))?)?;
            let weight = mesh.weights.as_ref().and_then(|weights| weights.get(index));
            Ok(ReadTarget {
                name: names.get(index).cloned().unwrap_or_default(),
                weight: weight.map_or(0.0, |weight| f64::from(*weight)),
                positions: positions.into_iter().map(|moved| moved * step).collect(),
                normals,
            })
        });
        targets.collect()
    }

    fn names(&self, mesh: &gltf::json::Mesh) -> Vec<String> {
        let extras = mesh.extras.as_ref();
        let extras: Option<serde_json::Value> =
            extras.and_then(|extras| serde_json::from_str(extras.get()).ok());
        let names = extras.as_ref().and_then(|extras| extras.get("targetNames")?.as_array());
        let name = |name: &serde_json::Value| name.as_str().unwrap_or_default().to_owned();
        names.map_or_else(Vec::new, |names| names.iter().map(name).collect())
    }

    /// The elements of an accessor, those of bytes as shares of 127.
    fn differences(&self, index: Index<Accessor>) -> Result<Vec<DVec3>, ReadError> {
        let at = index.value();
        let unsupported = || ReadError::Unsupported(format!("accessor {at} as differences"));
        let (component, divisor) = match kind(&self.root, index) {
            Some((ComponentType::F32, Type::Vec3)) => (ComponentType::F32, 1.0),
            Some((ComponentType::I16, Type::Vec3)) => (ComponentType::I16, 1.0),
            Some((ComponentType::I8, Type::Vec3)) => (ComponentType::I8, 127.0),
            _ => return Err(unsupported()),
        };
        let width = component.size() * 3;
        let element = |bytes: &[u8]| {
            let part = |axis: usize| {
                let bytes = &bytes[axis * component.size()..];
                f64::from(match component {
                    ComponentType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
                    ComponentType::I16 => f32::from(i16::from_le_bytes([bytes[0], bytes[1]])),
                    _ => f32::from(bytes[0].cast_signed()),
                }) / divisor
            };
            DVec3::new(part(0), part(1), part(2))
        };
        let find = |place, elements| elements_of(&self.root, self.binary, place, elements, at);
        let accessor = &self.root.accessors[at];
        let count = size(accessor.count.0);
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let mut all: Vec<DVec3> = match accessor.buffer_view {
            Some(view) => find((view, offset), (count, width))?.each(self.binary).map(element).collect(),
            None if count <= self.binary.len().max(1 << 16) * 16 => vec![DVec3::ZERO; count],
            None => return Err(ReadError::Range(at)),
        };
        if let Some(sparse) = &accessor.sparse {
            let wide = match sparse.indices.component_type {
                Checked::Valid(component) => component.0.size(),
                Checked::Invalid => return Err(unsupported()),
            };
            let changed = size(sparse.count.0);
            let own = &sparse.indices;
            let places = find((own.buffer_view, own.byte_offset.0), (changed, wide))?;
            let own = &sparse.values;
            let values = find((own.buffer_view, own.byte_offset.0), (changed, width))?;
            for (place, value) in places.each(self.binary).zip(values.each(self.binary)) {
                let mut word = [0; 4];
                word[..place.len()].copy_from_slice(place);
                let place = u32::from_le_bytes(word) as usize;
                *all.get_mut(place).ok_or(ReadError::Range(at))? = element(value);
            }
        }
        Ok(all)
    }
}

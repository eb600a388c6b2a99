//! Positions: floats, or whole numbers on the grid of the scene.
//!
//! Nodes take whole numbers back to metres: each mesh on a grid hangs on a node of its own below the one that shows it,
//! which keeps its place, so that what a game moves turns about the point that it was made to turn about. A mesh with a
//! skin is taken back by the inverse bind matrices, for its node moves nothing.

use glam::{DAffine3, DVec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::buffer::Target;
use gltf::json::{Accessor, Index, Root, Value};
use serde_json::json;

use super::buffer::{Binary, Content, Elements, accessor};
use super::vector::put;
use crate::scene::Grid;

/// Writes positions.
pub(super) fn positions(
    root: &mut Root,
    binary: &mut Binary,
    grid: Option<Grid>,
    all: impl ExactSizeIterator<Item = DVec3>,
) -> Index<Accessor> {
    let count = all.len();
    match grid {
        Some(grid) => on_grid(root, binary, grid, (all, count)),
        None => floats(root, binary, (all, count)),
    }
}

fn floats(
    root: &mut Root,
    binary: &mut Binary,
    (all, count): (impl Iterator<Item = DVec3>, usize),
) -> Index<Accessor> {
    let start = binary.start();
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for position in all {
        let position = (position.as_vec3() + 0.0).to_array();
        for axis in 0..3 {
            min[axis] = min[axis].min(position[axis]);
            max[axis] = max[axis].max(position[axis]);
        }
        put(&mut binary.bytes, position);
    }
    let view = binary.view(root, start, Some(Target::ArrayBuffer), Content::Attributes { stride: 12 });
    let elements = Elements { component: ComponentType::F32, shape: Type::Vec3, count };
    let bounds = (Value::from(min.to_vec()), Value::from(max.to_vec()));
    root.push(accessor(view, 0, elements, Some(bounds)))
}

fn on_grid(
    root: &mut Root,
    binary: &mut Binary,
    grid: Grid,
    (all, count): (impl Iterator<Item = DVec3>, usize),
) -> Index<Accessor> {
    let (mut min, mut max) = ([u16::MAX; 3], [0; 3]);
    let elements = Elements { component: ComponentType::U16, shape: Type::Vec3, count };
    let made = binary.attribute(root, elements, Content::Attributes { stride: 8 }, |bytes| {
        for position in all {
            // A checked scene has every position on its grid.
            let place = grid.place(position).unwrap_or_default();
            for axis in 0..3 {
                min[axis] = min[axis].min(place[axis]);
                max[axis] = max[axis].max(place[axis]);
            }
            let [x, y, z] = place.map(u16::to_le_bytes);
            bytes.extend_from_slice([x, y, z, [0; 2]].as_flattened());
        }
    });
    root.accessors[made.value()].min = Some(Value::from(min.to_vec()));
    root.accessors[made.value()].max = Some(Value::from(max.to_vec()));
    made
}

impl Grid {
    /// From places on the grid to metres.
    pub(super) fn affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(DVec3::splat(self.step), glam::DQuat::IDENTITY, self.offset)
    }

    /// As it stands in the file.
    pub(super) fn extras(self) -> Value {
        json!({ "grid": { "step": self.step, "offset": self.offset.to_array() } })
    }

    /// The grid of a file that has one.
    pub(super) fn of(root: &Root) -> Option<Self> {
        let extras: Value = serde_json::from_str(root.asset.extras.as_ref()?.get()).ok()?;
        let grid = extras.get("grid")?;
        let step = grid.get("step")?.as_f64()?;
        let offset = grid.get("offset")?.as_array()?;
        let part = |axis: usize| offset.get(axis)?.as_f64();
        let offset = DVec3::new(part(0)?, part(1)?, part(2)?);
        (step.is_finite() && step > 0.0 && offset.is_finite()).then_some(Self { step, offset })
    }
}

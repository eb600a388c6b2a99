//! States of a geometry into morph targets.
//!
//! What is written is the difference to the base: of positions as they stand in the file, so that points that triangles
//! share move alike; of normals and tangents between vectors of unit length. Where few vertices move, accessors are
//! sparse; compressed views are not, for their zeros take no bytes.

use glam::DVec3;
use gltf::json::accessor::sparse::{Indices, Sparse, Values};
use gltf::json::accessor::{ComponentType, IndexComponentType, Type};
use gltf::json::mesh::MorphTarget as Target;
use gltf::json::validation::{Checked as Valid, USize64};
use gltf::json::{Accessor, Index, Root, Value};
use serde_json::json;

use super::buffer::{Binary, Content, Elements, accessor, index_width};
use super::vector::put;
use crate::geometry::number::single;
use crate::packing::{Filter, octahedral, signed_byte};
use crate::scene::{Geometry, Grid, MorphTarget};

/// What a sparse accessor costs in JSON and views beyond its elements.
const OVERHEAD: usize = 400;

/// Differences of all vertices in one kind of number.
enum Differences {
    Floats(Vec<[f32; 3]>),
    /// Steps of the grid.
    Steps(Vec<[i16; 3]>),
    /// Shares of 127.
    Shares(Vec<[i8; 3]>),
}

/// How the directions of the base stand in the file.
#[derive(Clone, Copy)]
enum Form {
    Floats,
    Bytes,
    /// Bytes from the octahedron.
    Octahedral,
}

impl Form {
    /// What a reader finds of a direction.
    fn read_back(self, direction: DVec3) -> DVec3 {
        let shares = |bytes: [i8; 3]| DVec3::from_array(bytes.map(|byte| f64::from(byte) / 127.0));
        match self {
            Self::Floats => direction,
            Self::Bytes => shares(direction.to_array().map(signed_byte)),
            Self::Octahedral => {
                let mut bytes = octahedral(direction.to_array(), 0.0).map(i8::cast_unsigned);
                // Rows of four bytes are the filter's own.
                let _ = Filter::Octahedral.undo(&mut bytes, 4);
                let [x, y, z, _] = bytes.map(u8::cast_signed);
                shares([x, y, z])
            }
        }
    }
}

/// Writes the targets of a geometry; `small` where attributes are whole numbers.
pub(super) fn targets(
    root: &mut Root,
    binary: &mut Binary,
    geometry: &Geometry,
    (grid, small): (Option<Grid>, bool),
) -> Vec<Target> {
    let form = match (small, binary.is_compressed()) {
        (false, _) => Form::Floats,
        (true, false) => Form::Bytes,
        (true, true) => Form::Octahedral,
    };
    let write = |target: &MorphTarget| Target {
        positions: Some(written(root, binary, &positions(geometry, target, grid), true)),
        normals: Some(written(root, binary, &normals(geometry, target, form), false)),
        tangents: tangents(geometry, target, form).map(|all| written(root, binary, &all, false)),
    };
    geometry.targets.iter().map(write).collect()
}

/// The names of the targets, where players look for them.
pub(super) fn names(geometry: &Geometry) -> gltf::json::Extras {
    if geometry.targets.is_empty() {
        return None;
    }
    let names: Vec<&str> = geometry.targets.iter().map(|target| target.name.as_str()).collect();
    serde_json::value::to_raw_value(&json!({ "targetNames": names })).ok()
}

/// The weights of the targets where no clip moves them.
pub(super) fn weights(geometry: &Geometry) -> Option<Vec<f32>> {
    let weights = geometry.targets.iter().map(|target| single(target.weight)).collect();
    (!geometry.targets.is_empty()).then_some(weights)
}

fn positions(geometry: &Geometry, target: &MorphTarget, grid: Option<Grid>) -> Differences {
    let pairs = geometry.mesh.vertices.iter().map(|vertex| {
        let point = vertex.point.subscript();
        (geometry.mesh.points[point], target.points[point])
    });
    let Some(grid) = grid else {
        return Differences::Floats(
            pairs.map(|(from, to)| (to.as_vec3() - from.as_vec3()).to_array()).collect(),
        );
    };
    // A checked scene has all of them on its grid.
    let steps: Vec<DVec3> = pairs.map(|(from, to)| ((to - from) / grid.step).round()).collect();
    if steps.iter().all(|step| step.abs().max_element() <= f64::from(i16::MAX)) {
        #[expect(clippy::cast_possible_truncation, reason = "within the range of the type")]
        return Differences::Steps(
            steps.iter().map(|step| step.to_array().map(|part| part as i16)).collect(),
        );
    }
    Differences::Floats(steps.iter().map(|step| step.as_vec3().to_array()).collect())
}

fn normals(geometry: &Geometry, target: &MorphTarget, form: Form) -> Differences {
    let from = geometry.mesh.vertices.iter().map(|vertex| vertex.normal);
    directions(from.zip(target.normals.iter().copied()), form)
}

fn tangents(geometry: &Geometry, target: &MorphTarget, form: Form) -> Option<Differences> {
    let wide = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into());
    let from = geometry.tangents.as_ref()?.iter().map(|[x, y, z, _]| wide([*x, *y, *z]));
    Some(directions(from.zip(target.tangents.as_ref()?.iter().map(|tangent| wide(*tangent))), form))
}

/// Differences of unit vectors: in bytes where the base is and none is greater than 1. Directions that stay have none.
fn directions(pairs: impl Iterator<Item = (DVec3, DVec3)>, form: Form) -> Differences {
    let way = |(from, to): (DVec3, DVec3)| if from == to { DVec3::ZERO } else { to - form.read_back(from) };
    let ways: Vec<DVec3> = pairs.map(way).collect();
    let small = !matches!(form, Form::Floats);
    if small && ways.iter().all(|way| way.abs().max_element() <= 1.0) {
        return Differences::Shares(ways.iter().map(|way| way.to_array().map(signed_byte)).collect());
    }
    Differences::Floats(ways.iter().map(|way| way.as_vec3().to_array()).collect())
}

impl Differences {
    fn len(&self) -> usize {
        match self {
            Self::Floats(all) => all.len(),
            Self::Steps(all) => all.len(),
            Self::Shares(all) => all.len(),
        }
    }

    fn component(&self) -> ComponentType {
        match self {
            Self::Floats(_) => ComponentType::F32,
            Self::Steps(_) => ComponentType::I16,
            Self::Shares(_) => ComponentType::I8,
        }
    }

    fn elements(&self) -> Elements {
        Elements { component: self.component(), shape: Type::Vec3, count: self.len() }
    }

    fn as_floats(&self, at: usize) -> [f32; 3] {
        match self {
            Self::Floats(all) => all[at],
            Self::Steps(all) => all[at].map(f32::from),
            Self::Shares(all) => all[at].map(f32::from),
        }
    }

    fn put(&self, bytes: &mut Vec<u8>, at: usize) {
        match self {
            Self::Floats(all) => put(bytes, all[at]),
            Self::Steps(all) => bytes.extend_from_slice(all[at].map(i16::to_le_bytes).as_flattened()),
            Self::Shares(all) => bytes.extend(all[at].map(i8::cast_unsigned)),
        }
    }

    /// The least and the greatest of each component.
    fn bounds(&self) -> (Value, Value) {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for at in 0..self.len() {
            for (axis, part) in self.as_floats(at).into_iter().enumerate() {
                min[axis] = min[axis].min(part + 0.0);
                max[axis] = max[axis].max(part + 0.0);
            }
        }
        match self {
            Self::Floats(_) => (json!(min), json!(max)),
            _ => {
                #[expect(clippy::cast_possible_truncation, reason = "they were whole numbers")]
                let whole = |bound: [f32; 3]| json!(bound.map(|part| part as i32));
                (whole(min), whole(max))
            }
        }
    }
}

/// Writes differences, sparse where that is shorter.
fn written(root: &mut Root, binary: &mut Binary, all: &Differences, bounded: bool) -> Index<Accessor> {
    let mut moved: Vec<usize> = (0..all.len()).filter(|at| all.as_floats(*at) != [0.0; 3]).collect();
    let width = all.component().size() * 3;
    let stride = width.next_multiple_of(4);
    let names = index_width(all.len());
    let shorter = moved.len() * (width + names) + OVERHEAD < all.len() * stride;
    let made = if shorter && !binary.is_compressed() {
        if moved.is_empty() {
            // Not every reader knows accessors without any data.
            moved.push(0);
        }
        sparse(root, binary, all, &moved)
    } else {
        binary.attribute(root, all.elements(), Content::Attributes { stride }, |bytes| {
            for at in 0..all.len() {
                all.put(bytes, at);
                bytes.extend(std::iter::repeat_n(0, stride - width));
            }
        })
    };
    let accessor = &mut root.accessors[made.value()];
    accessor.normalized = matches!(all, Differences::Shares(_));
    if bounded {
        let (min, max) = all.bounds();
        (accessor.min, accessor.max) = (Some(min), Some(max));
    }
    made
}

fn sparse(root: &mut Root, binary: &mut Binary, all: &Differences, moved: &[usize]) -> Index<Accessor> {
    let start = binary.start();
    let short = index_width(all.len()) == 2;
    for at in moved {
        let [a, b, c, d] = crate::geometry::mesh::index(*at).to_le_bytes();
        binary.bytes.extend_from_slice(&[a, b]);
        if !short {
            binary.bytes.extend_from_slice(&[c, d]);
        }
    }
    let indices = binary.view(root, start, None, Content::Picture);
    let start = binary.start();
    moved.iter().for_each(|at| all.put(&mut binary.bytes, *at));
    let values = binary.view(root, start, None, Content::Picture);
    let component = IndexComponentType(if short { ComponentType::U16 } else { ComponentType::U32 });
    let (none, zero) = (None, USize64::from(0_usize));
    let sparse = Sparse {
        count: USize64::from(moved.len()),
        indices: Indices {
            buffer_view: indices,
            byte_offset: zero,
            component_type: Valid::Valid(component),
            extensions: None,
            extras: none.clone(),
        },
        values: Values { buffer_view: values, byte_offset: zero, extensions: None, extras: none.clone() },
        extensions: None,
        extras: none,
    };
    let plain = accessor(values, 0, all.elements(), None);
    root.push(Accessor { buffer_view: None, sparse: Some(sparse), ..plain })
}

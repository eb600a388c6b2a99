//! Bytes of a `.glb` file back into numbers, for the report and for `inspect`.
//!
//! Reads float positions and indices of triangles; every offset and count is checked against the bytes.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index, Root};
use thiserror::Error;

use crate::geometry::mesh;
use crate::geometry::number::size;

/// A file, read.
#[derive(Clone, Debug)]
pub struct Read {
    /// The JSON document.
    pub root: Root,
    /// For each mesh of the file its triangles.
    pub geometries: Vec<Geometry>,
}

/// Triangles of one mesh.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Positions; primitives that share accessors share them.
    pub positions: Vec<[f32; 3]>,
    /// Triangles of all primitives, in order.
    pub indices: Vec<u32>,
    /// Its primitives.
    pub parts: Vec<Part>,
}

/// One primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of its triangles.
    pub triangles: usize,
    /// Its material.
    pub material: Option<usize>,
}

/// What an accessor is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Positions.
    Position,
    /// Indices.
    Index,
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ReadError {
    /// Not a `.glb` file, or cut off.
    #[error("it is not a whole .glb file: {0}")]
    Container(String),
    /// The JSON is not a glTF document.
    #[error("its JSON is not a glTF document: {0}")]
    Json(String),
    /// An index points at nothing.
    #[error("{0} does not exist")]
    Missing(String),
    /// An accessor reaches past the bytes.
    #[error("accessor {0} reaches past the end of the data")]
    Range(usize),
    /// Something that is not read.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// A vertex index is too great.
    #[error("mesh {0} uses vertex {1}, which does not exist")]
    Vertex(usize, u32),
}

/// Reads the triangles of every mesh.
///
/// # Errors
/// When the file is broken or holds what is not read here (compressed or quantized data, other primitives).
pub fn read(bytes: &[u8]) -> Result<Read, ReadError> {
    let container = gltf::Glb::from_slice(bytes).map_err(|error| ReadError::Container(error.to_string()))?;
    let root: Root =
        serde_json::from_slice(&container.json).map_err(|error| ReadError::Json(error.to_string()))?;
    let binary = container.bin.as_deref().unwrap_or(&[]);
    let geometries: Result<Vec<_>, _> =
        (0..root.meshes.len()).map(|mesh| geometry(&root, binary, mesh)).collect();
    let geometries = geometries?;
    Ok(Read { root, geometries })
}

fn geometry(root: &Root, binary: &[u8], mesh: usize) -> Result<Geometry, ReadError> {
    let mut all = Geometry::default();
    let mut bases: Vec<(u32, u32)> = Vec::new();
    for primitive in &root.meshes[mesh].primitives {
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            return Err(ReadError::Unsupported(format!("a primitive of mesh {mesh} that is not triangles")));
        }
        let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let position = position.ok_or_else(|| ReadError::Missing(format!("POSITION of mesh {mesh}")))?;
        let known = bases
            .iter()
            .find(|(accessor, _)| *accessor == mesh::index(position.value()))
            .map(|(_, base)| *base);
        let base = match known {
            Some(base) => base,
            None => {
                let base = mesh::index(all.positions.len());
                read_positions(root, binary, *position, &mut all.positions)?;
                bases.push((mesh::index(position.value()), base));
                base
            }
        };
        let before = all.indices.len();
        match primitive.indices {
            Some(indices) => read_indices(root, binary, indices, base, &mut all.indices)?,
            None => all.indices.extend(base..mesh::index(all.positions.len())),
        }
        let material = primitive.material.map(|material| material.value());
        all.parts.push(Part { triangles: (all.indices.len() - before) / 3, material });
    }
    let count = mesh::index(all.positions.len());
    match all.indices.iter().find(|index| **index >= count) {
        Some(index) => Err(ReadError::Vertex(mesh, *index)),
        None => Ok(all),
    }
}

/// The bytes of an accessor and the step between its elements.
fn elements<'a>(
    root: &Root,
    binary: &'a [u8],
    index: Index<Accessor>,
    width: usize,
) -> Result<(&'a [u8], usize, usize), ReadError> {
    let at = index.value();
    let accessor = root.accessors.get(at).ok_or_else(|| ReadError::Missing(format!("accessor {at}")))?;
    let view = accessor.buffer_view.filter(|_| accessor.sparse.is_none());
    let view =
        view.ok_or_else(|| ReadError::Unsupported(format!("accessor {at}, sparse or without data,")))?;
    let view = root
        .buffer_views
        .get(view.value())
        .ok_or_else(|| ReadError::Missing(format!("view of accessor {at}")))?;
    if view.buffer.value() != 0 || root.buffers.first().is_none_or(|buffer| buffer.uri.is_some()) {
        return Err(ReadError::Unsupported("data outside the file".to_owned()));
    }
    let number = |value: Option<gltf::json::validation::USize64>| value.map_or(0, |value| value.0);
    let start = number(view.byte_offset).saturating_add(number(accessor.byte_offset));
    let stride = view.byte_stride.map_or(width, |stride| stride.0);
    let count = usize::try_from(accessor.count.0).map_err(|_| ReadError::Range(at))?;
    let reach = match count {
        0 => 0,
        _ => ((count - 1) as u64).saturating_mul(stride as u64).saturating_add(width as u64),
    };
    let view_end = number(view.byte_offset).saturating_add(view.byte_length.0);
    let end = start.saturating_add(reach);
    if end > view_end || end > binary.len() as u64 {
        return Err(ReadError::Range(at));
    }
    Ok((&binary[size(start)..size(end)], stride, count))
}

fn kind(root: &Root, index: Index<Accessor>) -> Option<(ComponentType, Type)> {
    let accessor = root.accessors.get(index.value())?;
    match (accessor.component_type, accessor.type_) {
        (Checked::Valid(component), Checked::Valid(shape)) => Some((component.0, shape)),
        _ => None,
    }
}

fn read_positions(
    root: &Root,
    binary: &[u8],
    index: Index<Accessor>,
    positions: &mut Vec<[f32; 3]>,
) -> Result<(), ReadError> {
    if kind(root, index) != Some((ComponentType::F32, Type::Vec3)) {
        return Err(ReadError::Unsupported(format!("accessor {} as positions", index.value())));
    }
    let (bytes, stride, count) = elements(root, binary, index, 12)?;
    positions.reserve_exact(count);
    let element = |element: &[u8]| {
        let (words, _) = element.as_chunks::<4>();
        [words[0], words[1], words[2]].map(f32::from_le_bytes)
    };
    if stride == 12 {
        positions.extend(bytes.chunks_exact(12).map(element));
    } else {
        positions.extend((0..count).map(|k| element(&bytes[k * stride..k * stride + 12])));
    }
    Ok(())
}

fn read_indices(
    root: &Root,
    binary: &[u8],
    index: Index<Accessor>,
    base: u32,
    indices: &mut Vec<u32>,
) -> Result<(), ReadError> {
    let unsupported = || ReadError::Unsupported(format!("accessor {} as indices", index.value()));
    let width = match kind(root, index) {
        Some((ComponentType::U8, Type::Scalar)) => 1,
        Some((ComponentType::U16, Type::Scalar)) => 2,
        Some((ComponentType::U32, Type::Scalar)) => 4,
        _ => return Err(unsupported()),
    };
    let (bytes, stride, count) = elements(root, binary, index, width)?;
    if count % 3 != 0 {
        return Err(unsupported());
    }
    indices.reserve_exact(count);
    match width {
        2 if stride == 2 => {
            let shorts = bytes.as_chunks::<2>().0.iter();
            indices.extend(shorts.map(|short| base.saturating_add(u32::from(u16::from_le_bytes(*short)))));
            return Ok(());
        }
        4 if stride == 4 => {
            let words = bytes.as_chunks::<4>().0.iter();
            indices.extend(words.map(|word| base.saturating_add(u32::from_le_bytes(*word))));
            return Ok(());
        }
        _ => {}
    }
    for k in 0..count {
        let mut word = [0; 4];
        word[..width].copy_from_slice(&bytes[k * stride..k * stride + width]);
        indices.push(base.saturating_add(u32::from_le_bytes(word)));
    }
    Ok(())
}

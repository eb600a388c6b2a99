//! The triangles and lines in the bytes of a `.glb` file, for the report and for `inspect`.
//!
//! Finds positions, floats or on the grid of the file, and indices of triangles; every offset and count is checked against the bytes. What stands
//! together in the file, as our own writer has it, stays where it is; only what other writers scatter is copied.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index, Root};
use indexmap::IndexMap;
use thiserror::Error;

use super::attribute::{ReadRange, read_attributes};
use super::carrier::{ReadLevels, drop_carriers, read_levels};
use super::color::{ReadColors, read_colors};
use super::instance;
use super::read_second::read_second;
use crate::geometry::mesh;
use crate::geometry::number::size;
use crate::packing::{PointerChannel, without_pointers};
use crate::scene::Grid;

/// A file, read.
#[derive(Clone, Debug)]
pub struct Read<'a> {
    /// The JSON document.
    pub root: Root,
    /// For each mesh of the file its triangles.
    pub geometries: Vec<Geometry<'a>>,
    /// The binary chunk.
    pub binary: &'a [u8],
    /// The grid of its positions, which are read in metres.
    pub grid: Option<Grid>,
    /// Nodes that only took a mesh from the grid to metres, and are no nodes here, with those that show it.
    pub(super) carriers: Vec<(usize, usize)>,
    /// How many nodes are copies that the file holds as places of one node; they stand last.
    pub copies: usize,
    /// The meshes that have levels of detail.
    pub levels: Vec<ReadLevels>,
    /// Channels of animations that point at properties.
    pub(super) pointers: Vec<PointerChannel>,
}

/// A position as it stands in a file: three little-endian floats.
pub type PositionBytes = [u8; 12];

/// Triangles of one mesh.
#[derive(Clone, Debug)]
pub struct Geometry<'a> {
    /// Positions; primitives that share accessors share them.
    pub positions: Cow<'a, [PositionBytes]>,
    /// Triangles of all primitives, in order; every index is in range.
    pub indices: Indices<'a>,
    /// Its primitives of triangles.
    pub parts: Vec<Part>,
    /// Its primitives of lines.
    pub lines: Lines,
    /// The range of its colors, where it has some.
    pub colors: Option<ReadColors>,
    /// The ranges of its attributes that the format has no name for.
    pub attributes: IndexMap<String, ReadRange>,
    /// For each vertex its second texture coordinates, where all primitives have them.
    pub second: Option<Vec<[f32; 2]>>,
}

/// Lines of one mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Positions, apart from those of triangles.
    pub positions: Vec<[f32; 3]>,
    /// Pairs of positions; every index is in range.
    pub segments: Vec<[u32; 2]>,
    /// For each primitive its material.
    pub parts: Vec<Option<usize>>,
}

/// Indices as they stand in a file, little-endian.
#[derive(Clone, Debug)]
pub enum Indices<'a> {
    /// Of two bytes.
    Short(Cow<'a, [[u8; 2]]>),
    /// Of four bytes.
    Long(Cow<'a, [[u8; 4]]>),
}

impl Indices<'_> {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Short(all) => all.len(),
            Self::Long(all) => all.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The index at a place below [`len`](Self::len).
    #[must_use]
    pub fn at(&self, place: usize) -> u32 {
        match self {
            Self::Short(all) => u16::from_le_bytes(all[place]).into(),
            Self::Long(all) => u32::from_le_bytes(all[place]),
        }
    }

    fn greatest(&self) -> Option<u32> {
        match self {
            Self::Short(all) => all.iter().map(|bytes| u16::from_le_bytes(*bytes)).max().map(u32::from),
            Self::Long(all) => all.iter().map(|bytes| u32::from_le_bytes(*bytes)).max(),
        }
    }
}

impl Geometry<'_> {
    /// The position of a vertex.
    #[must_use]
    pub fn position(&self, vertex: usize) -> [f32; 3] {
        floats(self.positions[vertex])
    }
}

/// One primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of its triangles.
    pub triangles: usize,
    /// Its material.
    pub material: Option<usize>,
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

/// Reads the triangles of every mesh. Compressed files are unpacked before (`packing::unpacked`); nodes that only
/// carry a mesh for another are left out: each mesh is shown by the node that was made to show it, levels of detail by none.
///
/// # Errors
/// When the file is broken or holds what is not read here (compressed data, whole numbers without a grid that Kiln
/// wrote, other primitives).
pub fn read(bytes: &[u8]) -> Result<Read<'_>, ReadError> {
    let container = gltf::Glb::from_slice(bytes).map_err(|error| ReadError::Container(error.to_string()))?;
    let (mut root, pointers) =
        document(&container.json).map_err(|error| ReadError::Json(error.to_string()))?;
    let binary = match container.bin {
        Some(Cow::Borrowed(binary)) => binary,
        _ => &[],
    };
    let grid = Grid::of(&root);
    let data = Data { root: &root, binary, grid };
    let geometries: Result<Vec<_>, _> = (0..root.meshes.len()).map(|mesh| geometry(data, mesh)).collect();
    let geometries = geometries?;
    let levels = read_levels(&root);
    let carriers = drop_carriers(&mut root, grid);
    let mut read = Read { root, geometries, binary, grid, carriers, copies: 0, levels, pointers };
    instance::unfold(&mut read);
    Ok(read)
}

/// A document and the channels of its animations that point at properties.
fn document(json: &[u8]) -> serde_json::Result<(Root, Vec<PointerChannel>)> {
    serde_json::from_slice(json).map(|root| (root, Vec::new())).or_else(|error| {
        let (rest, pointers) = without_pointers(json).ok_or(error)?;
        Ok((serde_json::from_slice(&rest)?, pointers))
    })
}

#[derive(Clone, Copy)]
struct Data<'r, 'a> {
    root: &'r Root,
    binary: &'a [u8],
    grid: Option<Grid>,
}

/// Where the elements of an accessor stand.
pub(super) struct Elements {
    /// Their bytes, from the first of the first element to the last of the last.
    range: Range<usize>,
    /// Bytes from one element to the next.
    stride: usize,
    /// Bytes of one element.
    width: usize,
    count: usize,
}

impl Elements {
    fn tight(&self) -> bool {
        self.stride == self.width
    }

    /// The bytes of each element.
    pub(super) fn each<'a>(&self, binary: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, width) = (&binary[self.range.clone()], self.stride, self.width);
        (0..self.count).map(move |k| &bytes[k * stride..k * stride + width])
    }
}

/// The indices of one primitive and the vertex that its own vertex 0 is; without indices, its vertices in order.
struct Primitive {
    base: u32,
    vertices: u32,
    indices: Option<Elements>,
}

fn geometry<'a>(data: Data<'_, 'a>, mesh: usize) -> Result<Geometry<'a>, ReadError> {
    let Data { root, binary, .. } = data;
    let mut clouds: Vec<(usize, u32, Elements)> = Vec::new();
    let mut primitives = Vec::new();
    let mut parts = Vec::new();
    let mut vertices = 0_u32;
    let lines = lines(data, mesh)?;
    for primitive in &root.meshes[mesh].primitives {
        if primitive.mode == Checked::Valid(Mode::Lines) {
            continue;
        }
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            let message = format!("a primitive of mesh {mesh} that is neither triangles nor lines");
            return Err(ReadError::Unsupported(message));
        }
        let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let position = position.ok_or_else(|| ReadError::Missing(format!("POSITION of mesh {mesh}")))?;
        let known = clouds.iter().find(|(accessor, ..)| *accessor == position.value());
        let (base, own) = match known {
            Some((_, base, cloud)) => (*base, mesh::index(cloud.count)),
            None => {
                let cloud = positions(data, *position)?;
                let (base, own) = (vertices, mesh::index(cloud.count));
                vertices = vertices.checked_add(own).ok_or(ReadError::Range(position.value()))?;
                clouds.push((position.value(), base, cloud));
                (base, own)
            }
        };
        let indices = primitive.indices.map(|index| indices(root, binary, index)).transpose()?;
        let count = indices.as_ref().map_or(own as usize, |indices| indices.count);
        if count % 3 != 0 {
            let message = format!("a primitive of mesh {mesh} that does not hold whole triangles");
            return Err(ReadError::Unsupported(message));
        }
        parts.push(Part {
            triangles: count / 3,
            material: primitive.material.map(|material| material.value()),
        });
        primitives.push(Primitive { base, vertices: own, indices });
    }
    let second = read_second(root, binary, (mesh, vertices))?;
    let positions = gathered_positions(data, &clouds);
    let missing = |index: u32| ReadError::Vertex(mesh, index);
    let indices = gathered_indices(binary, &primitives).map_err(missing)?;
    match indices.greatest().filter(|index| *index >= vertices) {
        Some(index) => Err(missing(index)),
        None => Ok(Geometry {
            positions,
            indices,
            parts,
            lines,
            colors: read_colors(root, binary, mesh)?,
            attributes: read_attributes(root, binary, mesh)?,
            second,
        }),
    }
}

/// The lines of a mesh; positions that primitives share are read once.
fn lines(data: Data<'_, '_>, mesh: usize) -> Result<Lines, ReadError> {
    let Data { root, binary, .. } = data;
    let mut all = Lines::default();
    let mut clouds: Vec<(usize, u32, u32)> = Vec::new();
    for primitive in &root.meshes[mesh].primitives {
        if primitive.mode != Checked::Valid(Mode::Lines) {
            continue;
        }
        let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let position = position.ok_or_else(|| ReadError::Missing(format!("POSITION of mesh {mesh}")))?;
        let known = clouds.iter().find(|(accessor, ..)| *accessor == position.value()).copied();
        let (_, base, count) = match known {
            Some(known) => known,
            None => {
                let cloud = positions(data, *position)?;
                let made = (position.value(), mesh::index(all.positions.len()), mesh::index(cloud.count));
                let floats = |element: &[u8]| floats(metres(element, data.grid));
                all.positions.extend(cloud.each(binary).map(floats));
                clouds.push(made);
                made
            }
        };
        let ends: Vec<u32> = match primitive.indices {
            None => (0..count).collect(),
            Some(index) => {
                let word = |element: &[u8]| {
                    let mut word = [0; 4];
                    word[..element.len()].copy_from_slice(element);
                    u32::from_le_bytes(word)
                };
                indices(root, binary, index)?.each(binary).map(word).collect()
            }
        };
        if let Some(beyond) = ends.iter().find(|end| **end >= count) {
            return Err(ReadError::Vertex(mesh, *beyond));
        }
        let (pairs, rest) = ends.as_chunks::<2>();
        if !rest.is_empty() {
            let message = format!("a primitive of mesh {mesh} that does not hold whole lines");
            return Err(ReadError::Unsupported(message));
        }
        all.segments.extend(pairs.iter().map(|pair| pair.map(|end| base + end)));
        all.parts.push(primitive.material.map(|material| material.value()));
    }
    Ok(all)
}

fn floats(position: PositionBytes) -> [f32; 3] {
    let (words, _) = position.as_chunks::<4>();
    [words[0], words[1], words[2]].map(f32::from_le_bytes)
}

/// A position in metres: floats as they stand, whole numbers by the grid.
fn metres(element: &[u8], grid: Option<Grid>) -> PositionBytes {
    if let (Some(grid), [x, x_high, y, y_high, z, z_high]) = (grid, element) {
        let place =
            [[*x, *x_high], [*y, *y_high], [*z, *z_high]].map(|part| f64::from(u16::from_le_bytes(part)));
        let position = (DVec3::from_array(place) * grid.step + grid.offset).as_vec3();
        return words(position.to_array());
    }
    element.first_chunk().copied().unwrap_or_default()
}

fn words(position: [f32; 3]) -> PositionBytes {
    let mut bytes = [0; 12];
    bytes.copy_from_slice(position.map(f32::to_le_bytes).as_flattened());
    bytes
}

/// Positions of all accessors, one after the other; those of a single tight one of floats stay in place.
fn gathered_positions<'a>(data: Data<'_, 'a>, clouds: &[(usize, u32, Elements)]) -> Cow<'a, [PositionBytes]> {
    if let [(.., cloud)] = clouds
        && cloud.tight()
        && cloud.width == size_of::<PositionBytes>()
    {
        return Cow::Borrowed(data.binary[cloud.range.clone()].as_chunks().0);
    }
    let all = clouds.iter().flat_map(|(.., cloud)| cloud.each(data.binary));
    Cow::Owned(all.map(|element| metres(element, data.grid)).collect())
}

/// Indices of all primitives, one after the other; those that stand so in the file stay in place, and are not looked
/// at here. Of the others one that is no vertex of its primitive is an error.
fn gathered_indices<'a>(binary: &'a [u8], primitives: &[Primitive]) -> Result<Indices<'a>, u32> {
    match in_place(primitives) {
        Some((range, 2)) => return Ok(Indices::Short(Cow::Borrowed(binary[range].as_chunks().0))),
        Some((range, 4)) => return Ok(Indices::Long(Cow::Borrowed(binary[range].as_chunks().0))),
        _ => {}
    }
    let mut all: Vec<[u8; 4]> = Vec::new();
    for Primitive { base, vertices, indices } in primitives {
        let Some(indices) = indices else {
            all.extend((*base..base + vertices).map(u32::to_le_bytes));
            continue;
        };
        for element in indices.each(binary) {
            let mut word = [0; 4];
            word[..element.len()].copy_from_slice(element);
            let index = u32::from_le_bytes(word);
            if index >= *vertices {
                return Err(index);
            }
            all.push((base + index).to_le_bytes());
        }
    }
    Ok(Indices::Long(Cow::Owned(all)))
}

/// The range of all indices and their width, when they follow each other without gaps and count from one vertex.
fn in_place(primitives: &[Primitive]) -> Option<(Range<usize>, usize)> {
    let first = primitives.first()?.indices.as_ref()?;
    let mut end = first.range.start;
    for Primitive { base, indices, .. } in primitives {
        let indices = indices.as_ref()?;
        if *base != 0 || !indices.tight() || indices.width != first.width || indices.range.start != end {
            return None;
        }
        end = indices.range.end;
    }
    Some((first.range.start..end, first.width))
}

pub(super) fn elements(
    root: &Root,
    binary: &[u8],
    index: Index<Accessor>,
    width: usize,
) -> Result<Elements, ReadError> {
    let at = index.value();
    let accessor = root.accessors.get(at).ok_or_else(|| ReadError::Missing(format!("accessor {at}")))?;
    let view = accessor.buffer_view.filter(|_| accessor.sparse.is_none());
    let view =
        view.ok_or_else(|| ReadError::Unsupported(format!("accessor {at}, sparse or without data,")))?;
    let count = usize::try_from(accessor.count.0).map_err(|_| ReadError::Range(at))?;
    let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
    elements_of(root, binary, (view, offset), (count, width), at)
}

/// So many elements of a view from an offset on, for accessor `at`.
pub(super) fn elements_of(
    root: &Root,
    binary: &[u8],
    (view, offset): (Index<gltf::json::buffer::View>, u64),
    (count, width): (usize, usize),
    at: usize,
) -> Result<Elements, ReadError> {
    let view = root
        .buffer_views
        .get(view.value())
        .ok_or_else(|| ReadError::Missing(format!("view of accessor {at}")))?;
    if view.buffer.value() != 0 || root.buffers.first().is_none_or(|buffer| buffer.uri.is_some()) {
        return Err(ReadError::Unsupported("data outside the file".to_owned()));
    }
    let view_start = view.byte_offset.map_or(0, |offset| offset.0);
    let start = view_start.saturating_add(offset);
    let stride = view.byte_stride.map_or(width, |stride| stride.0);
    let reach = match count {
        0 => 0,
        _ => ((count - 1) as u64).saturating_mul(stride as u64).saturating_add(width as u64),
    };
    let view_end = view_start.saturating_add(view.byte_length.0);
    let end = start.saturating_add(reach);
    if stride < width {
        return Err(ReadError::Unsupported(format!("accessor {at}, whose elements overlap,")));
    }
    if end > view_end || end > binary.len() as u64 || u32::try_from(count).is_err() {
        return Err(ReadError::Range(at));
    }
    Ok(Elements { range: size(start)..size(end), stride, width, count })
}

pub(super) fn kind(root: &Root, index: Index<Accessor>) -> Option<(ComponentType, Type)> {
    let accessor = root.accessors.get(index.value())?;
    match (accessor.component_type, accessor.type_) {
        (Checked::Valid(component), Checked::Valid(shape)) => Some((component.0, shape)),
        _ => None,
    }
}

fn positions(data: Data<'_, '_>, index: Index<Accessor>) -> Result<Elements, ReadError> {
    match kind(data.root, index) {
        Some((ComponentType::F32, Type::Vec3)) => elements(data.root, data.binary, index, 12),
        Some((ComponentType::U16, Type::Vec3)) if data.grid.is_some() => {
            elements(data.root, data.binary, index, 6)
        }
        _ => Err(ReadError::Unsupported(format!("accessor {} as positions", index.value()))),
    }
}

fn indices(root: &Root, binary: &[u8], index: Index<Accessor>) -> Result<Elements, ReadError> {
    let unsupported = || ReadError::Unsupported(format!("accessor {} as indices", index.value()));
    let width = match kind(root, index) {
        Some((ComponentType::U8, Type::Scalar)) => 1,
        Some((ComponentType::U16, Type::Scalar)) => 2,
        Some((ComponentType::U32, Type::Scalar)) => 4,
        _ => return Err(unsupported()),
    };
    elements(root, binary, index, width)
}

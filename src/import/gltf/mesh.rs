//! Triangles and lines of meshes.

use gltf::Semantic;
use gltf::mesh::Mode;

use super::{Data, GltfFault};
use crate::geometry::number::count_of;

/// A mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Its name, may be empty.
    pub name: String,
    /// Its primitives.
    pub parts: Vec<Part>,
    /// Weights of its targets.
    pub weights: Vec<f64>,
}

/// A primitive: vertices, and triangles or lines between them. Lists of vertices are as long as `positions`, or empty.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// Where vertices stand.
    pub positions: Vec<[f32; 3]>,
    /// Normals.
    pub normals: Vec<[f32; 3]>,
    /// Tangents, with the side of the bitangent.
    pub tangents: Vec<[f32; 4]>,
    /// Texture coordinates.
    pub uvs: [Vec<[f32; 2]>; 2],
    /// Linear colors with opacity.
    pub colors: Vec<[f32; 4]>,
    /// Joints of the skin.
    pub joints: Vec<[u32; 4]>,
    /// What they count.
    pub shares: Vec<[f32; 4]>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Lines.
    pub lines: Vec<[u32; 2]>,
    /// The material; none is that of glTF.
    pub material: Option<usize>,
    /// Morph targets.
    pub targets: Vec<Target>,
}

/// How vertices differ in a state. Lists are as long as the positions, or empty.
#[derive(Clone, Debug, Default)]
pub struct Target {
    /// Moves.
    pub positions: Vec<[f32; 3]>,
    /// Changes of normals.
    pub normals: Vec<[f32; 3]>,
}

/// The mesh of a file; what is left out of it is noted.
pub(crate) fn read(
    data: &Data<'_>,
    own: &gltf::Mesh<'_>,
    notes: &mut Vec<String>,
) -> Result<Mesh, GltfFault> {
    let mut parts = Vec::new();
    for primitive in own.primitives() {
        if primitive.mode() == Mode::Points {
            notes.push(format!("the points of mesh {} are left out", own.index()));
            continue;
        }
        if let Some(part) = part(data, own.index(), &primitive)? {
            parts.push(part);
        }
    }
    let weights = own.weights().unwrap_or_default().iter().map(|weight| f64::from(*weight)).collect();
    Ok(Mesh { name: own.name().unwrap_or_default().to_owned(), parts, weights })
}

fn part(data: &Data<'_>, mesh: usize, primitive: &gltf::Primitive<'_>) -> Result<Option<Part>, GltfFault> {
    let Some(position) = primitive.get(&Semantic::Positions) else { return Ok(None) };
    let positions = data.numbers::<3>(&position)?;
    let count = positions.len();
    let indices: Vec<u32> = match primitive.indices() {
        Some(indices) => data.whole::<1>(&indices)?.into_iter().map(|[index]| index).collect(),
        None => (0..count_of(count)).collect(),
    };
    if let Some(beyond) = indices.iter().find(|index| **index as usize >= count) {
        return Err(GltfFault::Vertex(mesh, *beyond));
    }
    let (triangles, lines) = joined(primitive.mode(), &indices);
    let targets: Result<Vec<Target>, GltfFault> = primitive
        .morph_targets()
        .map(|target| {
            let read = |accessor: Option<gltf::Accessor<'_>>| match accessor {
                Some(accessor) => same(data.numbers::<3>(&accessor)?, count, &accessor),
                None => Ok(Vec::new()),
            };
            Ok(Target { positions: read(target.positions())?, normals: read(target.normals())? })
        })
        .collect();
    Ok(Some(Part {
        normals: attribute(data, primitive, &Semantic::Normals, count)?,
        tangents: attribute(data, primitive, &Semantic::Tangents, count)?,
        uvs: [
            attribute(data, primitive, &Semantic::TexCoords(0), count)?,
            attribute(data, primitive, &Semantic::TexCoords(1), count)?,
        ],
        colors: colors(data, primitive, count)?,
        joints: match primitive.get(&Semantic::Joints(0)) {
            Some(accessor) => same(data.whole::<4>(&accessor)?, count, &accessor)?,
            None => Vec::new(),
        },
        shares: attribute(data, primitive, &Semantic::Weights(0), count)?,
        positions,
        triangles,
        lines,
        material: primitive.material().index(),
        targets: targets?,
    }))
}

fn same<T>(list: Vec<T>, count: usize, accessor: &gltf::Accessor<'_>) -> Result<Vec<T>, GltfFault> {
    if list.len() == count { Ok(list) } else { Err(GltfFault::Accessor(accessor.index())) }
}

fn attribute<const N: usize>(
    data: &Data<'_>,
    primitive: &gltf::Primitive<'_>,
    semantic: &Semantic,
    count: usize,
) -> Result<Vec<[f32; N]>, GltfFault> {
    match primitive.get(semantic) {
        Some(accessor) => same(data.numbers::<N>(&accessor)?, count, &accessor),
        None => Ok(Vec::new()),
    }
}

/// Colors of vertices; those of three numbers are opaque.
fn colors(
    data: &Data<'_>,
    primitive: &gltf::Primitive<'_>,
    count: usize,
) -> Result<Vec<[f32; 4]>, GltfFault> {
    let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(Vec::new()) };
    let mut colors = same(data.numbers::<4>(&accessor)?, count, &accessor)?;
    if accessor.dimensions().multiplicity() == 3 {
        colors.iter_mut().for_each(|color| color[3] = 1.0);
    }
    Ok(colors)
}

/// Triangles and lines of a list of indices (glTF 2.0 Specification, 2021, section 3.7.2.1).
fn joined(mode: Mode, list: &[u32]) -> (Vec<[u32; 3]>, Vec<[u32; 2]>) {
    let pairs = || list.windows(2).map(|pair| [pair[0], pair[1]]);
    match mode {
        Mode::Points => (Vec::new(), Vec::new()),
        Mode::Lines => (Vec::new(), list.as_chunks().0.to_vec()),
        Mode::LineStrip => (Vec::new(), pairs().collect()),
        Mode::LineLoop => {
            let back = list.first().zip(list.last()).map(|(first, last)| [*last, *first]);
            (Vec::new(), pairs().chain(back).collect())
        }
        Mode::Triangles => (list.as_chunks().0.to_vec(), Vec::new()),
        Mode::TriangleStrip => {
            let turned = |(k, corners): (usize, &[u32])| match k % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[1], corners[0], corners[2]],
            };
            (list.windows(3).enumerate().map(turned).collect(), Vec::new())
        }
        Mode::TriangleFan => {
            let first = list.first().copied().unwrap_or_default();
            let fan = list.get(1..).unwrap_or_default().windows(2);
            (fan.map(|pair| [first, pair[0], pair[1]]).collect(), Vec::new())
        }
    }
}

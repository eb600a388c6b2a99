//! Facts about the written bytes, held against the model.
//!
//! Promise: every number is measured on the bytes that were written, read back; only the bound on the
//! deviation comes from the tessellator, with what rounding to single precision adds. Keys are the same from
//! run to run, and no number depends on the machine or on the number of threads.

mod assertion;
mod cages;
mod colliders;
mod deviation;
pub mod facts;
mod heights;
mod joints;
mod levels;
mod lightmaps;
mod morphs;
mod motion;
mod perturbed;
mod polygons;
mod quadrics;
mod surfaces;

pub use assertion::{Check, Fault};
pub use cages::CageFacts;
pub use colliders::{ColliderFacts, PartsFacts};
pub use deviation::{deviation_maps, measure_deviation};
pub use heights::HeightFacts;
pub use joints::JointFacts;
pub use levels::{LevelFacts, LevelOrigin};
pub use lightmaps::LightmapFacts;
pub use morphs::MorphFacts;
pub use motion::{
    ClipFacts, DriverFacts, DriverFrame, PoseFacts, PosedVertex, ReachFacts, ReachFrame, SkinFacts,
};
pub use perturbed::PerturbedFacts;
pub use quadrics::QuadricFacts;
pub use surfaces::{NetworkFacts, NetworkJoint, NetworkLine};

use indexmap::IndexMap;
use serde::Serialize;

use crate::geometry::mesh::polygon_facts::PolygonFacts;
use crate::geometry::number::{Bounds, single_rounding};
use crate::geometry::tessellate::Evidence;
use crate::gltf::{Geometry, Indices, Profile, Read, ReadError, Written, WrittenGeometry, read};
use crate::model::{Model, ShapeHandle};
use crate::packing::{UnpackError, unpacked};
use crate::realize::Note;
use facts::{Box3, FactsError, LineFacts, MeshFacts, measure_lines};
use thiserror::Error;

/// What is known of an asset.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Report {
    /// Version of Kiln.
    pub kiln: &'static str,
    /// Name of the asset.
    pub asset: String,
    /// The document, from the project root.
    pub spec: String,
    /// The variant of the document.
    pub variant: Option<String>,
    /// Output profile.
    pub profile: &'static str,
    /// The grid that all positions lie on, where they are whole numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<GridFacts>,
    /// The file.
    pub file: FileFacts,
    /// Sums over the file.
    pub totals: Totals,
    /// Each shape, by the name of its mesh.
    pub shapes: IndexMap<String, ShapeFacts>,
    /// The levels of detail of each mesh that has some.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub lods: IndexMap<String, Vec<LevelFacts>>,
    /// Each node, in the order of the file; those that only carry a mesh for another are left out.
    pub nodes: Vec<NodeFacts>,
    /// Each skin, by its name.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub skins: IndexMap<String, SkinFacts>,
    /// Each clip, by its name.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub clips: IndexMap<String, ClipFacts>,
    /// Each body for physics, by its name.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub colliders: IndexMap<String, ColliderFacts>,
    /// The joints of each path of the document.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub paths: IndexMap<String, Vec<JointFacts>>,
    /// What each quadric of the document is.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub quadrics: IndexMap<String, QuadricFacts>,
    /// How many polygons each height map stands for.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub heights: IndexMap<String, HeightFacts>,
    /// How the surfaces of each shape of several join.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub networks: IndexMap<String, NetworkFacts>,
    /// How the surfaces of perturbed patches were made.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub perturbed: IndexMap<String, PerturbedFacts>,
    /// What the vertices of each cage are.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub cages: IndexMap<String, CageFacts>,
    /// Each assertion of the document that holds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assertions: Vec<Check>,
}

/// The written file.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FileFacts {
    /// Its name.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// Its BLAKE3 hash in hexadecimal digits.
    pub blake3: String,
    /// Extensions of the format that it uses, in its order.
    pub used_extensions: Vec<String>,
    /// Names of the pictures that stand beside it.
    pub pictures: Vec<String>,
}

/// A grid of positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GridFacts {
    /// From line to line, metres.
    pub step: f64,
    /// Its first point, metres.
    pub offset: [f64; 3],
}

/// Sums over the file.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Totals {
    /// Meshes.
    pub meshes: usize,
    /// Primitives of all meshes.
    pub primitives: usize,
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Segments of lines of all meshes.
    #[serde(skip_serializing_if = "is_zero")]
    pub segments: u64,
    /// Vertices of all meshes.
    pub vertices: u64,
    /// Materials.
    pub materials: usize,
    /// Images.
    pub images: usize,
    /// Nodes.
    pub nodes: usize,
    /// Primitives of all nodes: what a plain renderer draws.
    pub draw_calls: u64,
    /// Triangles of all nodes.
    pub drawn_triangles: u64,
    /// Segments of all nodes.
    #[serde(skip_serializing_if = "is_zero")]
    pub drawn_segments: u64,
    /// Box of all nodes in the scene.
    pub bounds: Extent,
}

/// A box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Extent {
    /// Least corner.
    pub min: [f64; 3],
    /// Greatest corner.
    pub max: [f64; 3],
}

/// What is known of a shape: measured on its mesh.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ShapeFacts {
    /// Names of the meshes that show it, in the order of the file, where nodes show it with several materials; all are
    /// of one geometry, which is measured once. Empty where one mesh of its own name shows it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<String>,
    /// Primitives of its mesh, of each where there are several.
    pub primitives: usize,
    /// What is measured.
    #[serde(flatten)]
    pub facts: MeshFacts,
    /// The colors of its vertices, where it has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colors: Option<ColorFacts>,
    /// Its attributes that games read themselves, by their names.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub attributes: IndexMap<String, AttributeFacts>,
    /// Its second texture coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lightmap: Option<LightmapFacts>,
    /// Its lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<LineFacts>,
    /// Distance from the exact shape.
    pub deviation: DeviationFacts,
    /// Its states, by their names.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub morphs: IndexMap<String, MorphFacts>,
    /// The polygons it was made from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PolygonFacts>,
}

/// The range of the colors of vertices: linear red, green, blue and alpha.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ColorFacts {
    /// The least of each part.
    pub min: [f32; 4],
    /// The greatest of each part.
    pub max: [f32; 4],
}

/// The range of an attribute that games read themselves.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct AttributeFacts {
    /// The least of each component.
    pub min: Vec<f32>,
    /// The greatest of each component.
    pub max: Vec<f32>,
}

/// Distance between written triangles and exact shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct DeviationFacts {
    /// What was asked for, metres; none for a fixed grid and for polygons.
    pub tolerance: Option<f64>,
    /// No point is further away, metres, rounding of positions included.
    pub bound: f64,
    /// How the bound is known.
    pub kind: Kind,
    /// The greatest distance found by dense sampling, metres, when that was asked for.
    pub measured: Option<f64>,
}

/// How a bound is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The triangles are the shape, but for rounding.
    Exact,
    /// Proved.
    Proved,
    /// The greatest of dense samples, with a margin.
    Sampled,
}

impl From<Evidence> for Kind {
    fn from(evidence: Evidence) -> Self {
        match evidence {
            Evidence::Exact => Self::Exact,
            Evidence::Proved => Self::Proved,
            Evidence::Sampled => Self::Sampled,
        }
    }
}

/// A node of the file.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NodeFacts {
    /// Its name.
    pub name: String,
    /// Its parent.
    pub parent: Option<String>,
    /// The mesh it shows.
    pub mesh: Option<String>,
    /// Whether it is a joint of a skin.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub joint: bool,
    /// Its place in the scene, column by column.
    pub matrix: [f64; 16],
}

/// What a report says beyond the bytes.
#[derive(Clone, Debug)]
pub struct About<'a> {
    /// The document, from the project root.
    pub spec: &'a str,
    /// The variant of the document.
    pub variant: Option<&'a str>,
    /// For whom the file is.
    pub profile: Profile,
    /// Name of the written file.
    pub file: &'a str,
    /// Whether the deviation is measured by dense sampling.
    pub measure: bool,
    /// What was noticed while shapes were made.
    pub notes: &'a [(ShapeHandle, Note)],
}

/// Why a file cannot be measured: a bug of the writer, or more triangles than can be counted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReportError {
    /// The bytes cannot be unpacked.
    #[error(transparent)]
    Unpack(#[from] UnpackError),
    /// The bytes cannot be read back.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A mesh cannot be measured.
    #[error(transparent)]
    Facts(#[from] FactsError),
}

/// Measures the bytes of a file.
///
/// # Errors
/// When the bytes cannot be read back, which is a bug of the writer.
pub fn measure(
    written: &Written,
    model: &Model,
    shapes: &[ShapeHandle],
    about: &About<'_>,
) -> Result<Report, ReportError> {
    let plain = unpacked(&written.bytes)?;
    let file = read(&plain)?;
    let mut facts = IndexMap::new();
    for (index, (known, handle)) in written.geometries.iter().zip(shapes).enumerate() {
        // Where triangles were taken away, corners say nothing of where on the surface the others belong.
        let anchored = about.measure && !levels::is_thinned(written, index);
        let measured = (anchored
            .then(|| measure_deviation(&file.geometries[known.mesh()], known, model, *handle)))
        .flatten();
        let mut own = shape_facts(&file, known, (model, *handle), measured)?;
        own.meshes = meshes(&file, &known.meshes, &known.name);
        facts.insert(known.name.clone(), own);
    }
    let nodes = nodes(&file);
    let (skins, clips) = motion::motion(&file, written, model)?;
    Ok(Report {
        kiln: env!("CARGO_PKG_VERSION"),
        asset: model.name.clone(),
        spec: about.spec.to_owned(),
        variant: about.variant.map(str::to_owned),
        profile: about.profile.name(),
        grid: file.grid.map(|grid| GridFacts { step: grid.step, offset: grid.offset.to_array() }),
        file: FileFacts {
            name: about.file.to_owned(),
            bytes: written.bytes.len() as u64,
            blake3: blake3::hash(&written.bytes).to_hex().to_string(),
            used_extensions: file.root.extensions_used.clone(),
            pictures: written.pictures.iter().map(|(name, _)| name.clone()).collect(),
        },
        totals: totals(&file, &facts, written, &nodes),
        lods: levels::levels(&file, written, &facts),
        colliders: colliders::colliders(&file, written, &facts),
        shapes: facts,
        nodes,
        skins,
        clips,
        paths: joints::joints(model),
        quadrics: quadrics::quadrics(model),
        heights: heights::heights(&file, written, model, shapes)?,
        networks: surfaces::networks(model),
        perturbed: perturbed::perturbed(model),
        cages: cages::cages(model, about.notes),
        assertions: Vec::new(),
    })
}

/// The names of meshes that show one geometry, unless its own name says it all.
fn meshes(file: &Read<'_>, meshes: &[usize], own: &str) -> Vec<String> {
    let names = meshes.iter().map(|mesh| file.root.meshes[*mesh].name.clone().unwrap_or_default());
    let names: Vec<String> = names.collect();
    if names.as_slice() == [own] { Vec::new() } else { names }
}

fn shape_facts(
    file: &Read<'_>,
    known: &WrittenGeometry,
    (model, handle): (&Model, ShapeHandle),
    measured: Option<f64>,
) -> Result<ShapeFacts, ReportError> {
    let geometry = &file.geometries[known.mesh()];
    let mut facts = mesh_facts(geometry)?;
    let lines = line_facts(geometry);
    if geometry.parts.is_empty() {
        // Of no triangles everything holds; to say so of lines would mislead.
        (facts.closed, facts.manifold, facts.volume) = (false, false, None);
    }
    if let Some(lines) = &lines {
        facts.bounds = together(facts.bounds, lines.bounds);
    }
    Ok(ShapeFacts {
        meshes: Vec::new(),
        primitives: geometry.parts.len() + geometry.lines.parts.len(),
        colors: geometry.colors.map(|colors| ColorFacts { min: colors.min, max: colors.max }),
        attributes: geometry
            .attributes
            .iter()
            .map(|(name, own)| (name.clone(), AttributeFacts { min: own.min.clone(), max: own.max.clone() }))
            .collect(),
        lightmap: model.shape(handle).options.lightmap.and_then(|asked| lightmaps::lightmap(geometry, asked)),
        lines,
        deviation: DeviationFacts {
            tolerance: known.tolerance,
            bound: known.deviation.bound + single_rounding(extent(&facts).reach()),
            kind: known.deviation.evidence.into(),
            measured,
        },
        polygons: polygons::polygon_facts(model, handle),
        morphs: morphs::morphs(file, known)?,
        facts,
    })
}

/// Measures one mesh of a file, where it stands.
///
/// # Errors
/// See [`FactsError`].
pub fn mesh_facts(geometry: &Geometry<'_>) -> Result<MeshFacts, FactsError> {
    match &geometry.indices {
        Indices::Short(indices) => facts::measure(&geometry.positions, indices),
        Indices::Long(indices) => facts::measure(&geometry.positions, indices),
    }
}

/// Measures the lines of one mesh of a file; `None` where it has none.
#[must_use]
pub fn line_facts(geometry: &Geometry<'_>) -> Option<LineFacts> {
    let lines = &geometry.lines;
    (!lines.parts.is_empty()).then(|| measure_lines(&lines.positions, &lines.segments))
}

fn together(one: Option<Box3>, other: Option<Box3>) -> Option<Box3> {
    let (Some(a), Some(b)) = (one, other) else { return one.or(other) };
    let pick =
        |pick: fn(f32, f32) -> f32, a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|axis| pick(a[axis], b[axis]));
    Some(Box3 { min: pick(f32::min, a.min, b.min), max: pick(f32::max, a.max, b.max) })
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

fn extent(facts: &MeshFacts) -> Bounds {
    let point = |corner: [f32; 3]| glam::Vec3::from_array(corner).as_dvec3();
    facts.bounds.map_or(Bounds::EMPTY, |bounds| Bounds { min: point(bounds.min), max: point(bounds.max) })
}

fn nodes(file: &Read<'_>) -> Vec<NodeFacts> {
    let all = &file.root.nodes;
    let mut parents = vec![None; all.len()];
    for (index, node) in all.iter().enumerate() {
        for child in node.children.iter().flatten() {
            parents[child.value()] = Some(index);
        }
    }
    let name = |index: usize| all[index].name.clone().unwrap_or_default();
    let facts = |index: usize| {
        let mut matrix = local(&all[index]);
        let mut ancestor = parents[index];
        while let Some(parent) = ancestor {
            matrix = local(&all[parent]) * matrix;
            ancestor = parents[parent];
        }
        NodeFacts {
            name: name(index),
            parent: parents[index].map(name),
            mesh: all[index].mesh.and_then(|mesh| file.root.meshes[mesh.value()].name.clone()),
            joint: file.root.skins.iter().any(|skin| skin.joints.iter().any(|joint| joint.value() == index)),
            matrix: matrix.to_cols_array(),
        }
    };
    (0..all.len()).map(facts).collect()
}

fn local(node: &gltf::json::Node) -> glam::DMat4 {
    let vector =
        |value: Option<[f32; 3]>, rest: f32| glam::Vec3::from_array(value.unwrap_or([rest; 3])).as_dvec3();
    let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.0);
    glam::DMat4::from_scale_rotation_translation(
        vector(node.scale, 1.0),
        glam::Quat::from_array(rotation).as_dquat().normalize(),
        vector(node.translation, 0.0),
    )
}

fn totals(
    file: &Read<'_>,
    shapes: &IndexMap<String, ShapeFacts>,
    written: &Written,
    nodes: &[NodeFacts],
) -> Totals {
    let mut totals = Totals {
        meshes: file.root.meshes.len(),
        materials: file.root.materials.len(),
        images: file.root.images.len(),
        nodes: nodes.len(),
        ..Totals::default()
    };
    for mesh in &file.geometries {
        totals.primitives += mesh.parts.len() + mesh.lines.parts.len();
        totals.triangles += mesh.indices.len() as u64 / 3;
        totals.segments += mesh.lines.segments.len() as u64;
        totals.vertices += (mesh.positions.len() + mesh.lines.positions.len()) as u64;
    }
    let mut bounds = Bounds::EMPTY;
    for (node, facts) in file.root.nodes.iter().zip(nodes) {
        let Some(mesh) = node.mesh else { continue };
        let geometry = &file.geometries[mesh.value()];
        totals.draw_calls += (geometry.parts.len() + geometry.lines.parts.len()) as u64;
        totals.drawn_segments += geometry.lines.segments.len() as u64;
        totals.drawn_triangles += geometry.indices.len() as u64 / 3;
        // At rest joints bring what they carry where the node above them brings all.
        let carried = written.root.filter(|_| node.skin.is_some());
        let matrix = carried.map_or(&facts.matrix, |root| &nodes[root].matrix);
        let matrix = glam::DMat4::from_cols_array(matrix);
        let plain = matrix == glam::DMat4::IDENTITY;
        let known = written.geometries.iter().find(|known| known.meshes.contains(&mesh.value()));
        bounds = match known.and_then(|known| shapes.get(&known.name)).filter(|_| plain) {
            Some(facts) => bounds.union(extent(&facts.facts)),
            None => {
                let triangles = (0..geometry.positions.len()).map(|vertex| geometry.position(vertex));
                triangles.chain(geometry.lines.positions.iter().copied()).fold(bounds, |bounds, position| {
                    let place = glam::Vec3::from_array(position).as_dvec3();
                    bounds.with_point(matrix.transform_point3(place))
                })
            }
        };
    }
    totals.bounds = Extent { min: bounds.min.to_array(), max: bounds.max.to_array() };
    totals
}

//! The meshes of a file as one mesh of triangles, where its nodes place them.

use glam::{DAffine3, DMat4, DVec2, DVec3, Vec3};
use serde_json::Value;

use super::look::{self, Mapping};
use super::{GltfFault, GltfFile, Node, Part, Skin, open};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{Color, NormalMap, PointIndex, PolygonMesh, index};
use crate::import::{ImportError, ImportOptions, Imported, MaterialLook, Note};

/// Reads a file: the triangles of the scene that is shown, in its space, states as much as they count at rest, skinned meshes as
/// they are bound, where their first joint at rest brings them. Points are joined where they are equal, or within `weld`. Lines and points are left
/// out with a note.
///
/// `open` reads other files by their paths from this one. Linear in what is read, a mesh once for each node that shows it.
///
/// # Errors
/// The first fault in it, a group that there is not, or more triangles than `most`.
pub fn read(
    bytes: &[u8],
    options: &ImportOptions,
    open_other: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Imported, ImportError> {
    Ok(read_weighted(bytes, options, open_other)?.imported)
}

/// A mesh with the joints that carry its points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weighted {
    /// The mesh.
    pub imported: Imported,
    /// For each point of the mesh the nodes that carry it, joints of its skin, and their shares; none where no skin does.
    pub weights: Vec<Vec<(usize, f64)>>,
    /// The states of the meshes of all nodes.
    pub states: Vec<FileState>,
    /// Points and normals of the mesh where all states count nothing.
    plain: (Vec<DVec3>, Vec<DVec3>),
}

/// A morph target of the mesh of a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileState {
    /// The node.
    pub node: usize,
    /// Its number among those of the node's mesh.
    pub target: usize,
    /// Its name in the file (`targetNames`), may be empty.
    pub name: String,
    /// What it counts at rest.
    pub weight: f64,
    /// For each point of the mesh the way that it goes.
    ways: Vec<DVec3>,
    /// For each normal what is added.
    turns: Vec<DVec3>,
}

impl Weighted {
    /// The mesh where states count so much, in their order.
    #[must_use]
    pub fn at(&self, weights: &[f64]) -> PolygonMesh {
        let (points, normals) = self.plain.clone();
        let mut mesh = PolygonMesh { points, normals, ..self.imported.mesh.clone() };
        let mut turned = false;
        for (state, weight) in self.states.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            mesh.points.iter_mut().zip(&state.ways).for_each(|(point, way)| *point += *way * *weight);
            mesh.normals.iter_mut().zip(&state.turns).for_each(|(normal, turn)| *normal += *turn * *weight);
            turned = true;
        }
        if turned {
            mesh.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        }
        mesh
    }
}

/// Places of points in all states of a file.
const MOST_PLACES: usize = 1 << 26;

/// As [`read`], with weights and states. Points on one place with other weights, or that go other ways in states, stay apart; where points within `weld` are joined,
/// weights are left out.
///
/// # Errors
/// As [`read`].
pub fn read_weighted(
    bytes: &[u8],
    options: &ImportOptions,
    open_other: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Weighted, ImportError> {
    let file = open(bytes, open_other)?;
    let nodes = file.nodes();
    let shown = shown(&file, &nodes, options)?;
    check_size(&file, &nodes, &shown, options.most)?;
    let worlds = file.worlds();
    let data = file.data();
    let mut found = Found::default();
    let mut notes = Vec::new();
    let (materials, mappings) = look::read(&data, &mut notes);
    found.mesh.materials = materials.iter().map(|look| look.name.clone()).collect();
    for node in shown {
        let Some(mesh) = nodes[node].mesh.and_then(|mesh| file.document.meshes().nth(mesh)) else { continue };
        let (index, names) = (mesh.index(), target_names(&mesh));
        let mesh = super::mesh(&data, &mesh, &mut notes)?;
        let skin = nodes[node].skin.and_then(|skin| file.document.skins().nth(skin));
        let skin = skin.map(|skin| super::skin(&data, &skin)).transpose()?;
        let map = skin.as_ref().map_or_else(|| affine(&worlds[node]), |skin| bound(skin, &worlds));
        let weights = if nodes[node].weights.is_empty() { &mesh.weights } else { &nodes[node].weights };
        for part in &mesh.parts {
            let mapping = part.material.and_then(|material| mappings.get(material));
            let before = (found.mesh.points.len(), found.mesh.normals.len());
            found.part(part, &map, mapping);
            found.states_of(part, &map, before, &Morphs { node, names: &names, weights });
            found.carry(part, skin.as_ref(), index)?;
            if found.states.len().saturating_mul(found.mesh.points.len()) > MOST_PLACES {
                let limit = u32::try_from(MOST_PLACES).unwrap_or(u32::MAX);
                return Err(ImportError::TooMany { what: "places of points in its states", limit });
            }
        }
    }
    finish(&file, found, (materials, notes), options)
}

fn finish(
    file: &GltfFile,
    found: Found,
    (materials, notes): (Vec<MaterialLook>, Vec<String>),
    options: &ImportOptions,
) -> Result<Weighted, ImportError> {
    let mut found = found;
    let count = found.states.len();
    found.weld(options.weld);
    let Found { mut mesh, weights, lines, states } = found;
    if mesh.faces.is_empty() {
        return Err(match &options.group {
            Some(group) => ImportError::EmptyGroup { group: group.clone() },
            None => ImportError::NoFaces { vertices: index(mesh.points.len()) },
        });
    }
    if mesh.corner_uvs.iter().all(|uv| *uv == NONE) {
        mesh.corner_uvs.clear();
    }
    if mesh.corner_normals.iter().all(|normal| *normal == NONE) {
        mesh.corner_normals.clear();
    }
    if mesh.colors.iter().all(|color| *color == Color::WHITE) {
        (mesh.colors, mesh.corner_colors) = (Vec::new(), Vec::new());
    }
    let mut notes: Vec<Note> = notes.into_iter().map(|message| Note { line: None, message }).collect();
    let mut note = |message: String| notes.push(Note { line: None, message });
    if lines > 0 {
        note(format!("{lines} lines are left out"));
    }
    if options.weld.is_some() && count > 0 {
        note(format!("its {count} states are left out, since `weld` joins points that may part in them"));
    }
    let plain = (mesh.points.clone(), mesh.normals.clone());
    let imported = Imported { mesh, materials, groups: names(file), notes };
    let mut found = Weighted { imported, weights, states, plain };
    let rest: Vec<f64> = found.states.iter().map(|state| state.weight).collect();
    found.imported.mesh = found.at(&rest);
    Ok(found)
}

/// Nodes whose meshes are read, in the order of the tree.
fn shown(file: &GltfFile, nodes: &[Node], options: &ImportOptions) -> Result<Vec<usize>, ImportError> {
    let mesh_names: Vec<Option<&str>> = file.document.meshes().map(|mesh| mesh.name()).collect();
    let wanted = options.group.as_deref();
    let mut shown = Vec::new();
    let mut known = false;
    // With each node whether it is below one that is wanted.
    let mut open: Vec<(usize, bool)> =
        file.roots().into_iter().rev().map(|root| (root, wanted.is_none())).collect();
    while let Some((node, within)) = open.pop() {
        let own = &nodes[node];
        let within = within || wanted == Some(own.name.as_str());
        let named = wanted.is_some() && own.mesh.is_some_and(|mesh| mesh_names[mesh] == wanted);
        known |= within || named;
        if own.mesh.is_some() && (within || named) {
            shown.push(node);
        }
        open.extend(own.children.iter().rev().map(|child| (*child, within)));
    }
    match wanted.filter(|_| !known) {
        Some(group) => Err(ImportError::UnknownGroup { group: group.to_owned(), known: names(file) }),
        None => Ok(shown),
    }
}

/// Names of nodes that show something and of meshes, each once.
fn names(file: &GltfFile) -> Vec<String> {
    let nodes = file.document.nodes().filter(|node| node.mesh().is_some());
    let nodes = nodes.filter_map(|node| node.name().map(str::to_owned));
    let meshes = file.document.meshes().filter_map(|mesh| mesh.name().map(str::to_owned));
    let mut names: Vec<String> = Vec::new();
    for name in nodes.chain(meshes) {
        if !name.is_empty() && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Refuses more than a limit before it is read: many primitives may share their vertices, and many nodes their mesh.
fn check_size(file: &GltfFile, nodes: &[Node], shown: &[usize], most: u64) -> Result<(), ImportError> {
    let most = if most == 0 { u64::from(u32::MAX) / 3 } else { most.min(u64::from(u32::MAX) / 3) };
    let size = |primitive: gltf::Primitive<'_>| {
        let vertices =
            primitive.get(&gltf::Semantic::Positions).map_or(0, |accessor| accessor.count() as u64);
        let corners = primitive.indices().map_or(vertices, |indices| indices.count() as u64);
        let triangles = match primitive.mode() {
            gltf::mesh::Mode::TriangleStrip | gltf::mesh::Mode::TriangleFan => corners,
            _ => corners / 3,
        };
        // Each triangle that is allowed may have vertices of its own.
        triangles.max(vertices / 3)
    };
    let sizes: Vec<u64> =
        file.document.meshes().map(|mesh| mesh.primitives().map(size).fold(0, u64::saturating_add)).collect();
    let sum = shown
        .iter()
        .filter_map(|node| nodes[*node].mesh)
        .fold(0, |sum: u64, mesh| sum.saturating_add(sizes[mesh]));
    if sum > most {
        return Err(ImportError::TooMany {
            what: "triangles",
            limit: u32::try_from(most).unwrap_or(u32::MAX),
        });
    }
    Ok(())
}

/// Names of the targets of a mesh, by custom in its `extras`.
fn target_names(mesh: &gltf::Mesh<'_>) -> Vec<String> {
    let extras = mesh.extras().as_ref().and_then(|extras| serde_json::from_str::<Value>(extras.get()).ok());
    let names = extras.as_ref().and_then(|extras| extras.get("targetNames")?.as_array());
    let name = |name: &Value| name.as_str().unwrap_or_default().to_owned();
    names.map_or_else(Vec::new, |names| names.iter().map(name).collect())
}

/// The states of the mesh of a node.
struct Morphs<'a> {
    node: usize,
    names: &'a [String],
    weights: &'a [f64],
}

/// Where a skin's mesh stands in the scene as it is bound: where its first joint, at rest, brings it.
pub(super) fn bound(skin: &Skin, worlds: &[DMat4]) -> DAffine3 {
    let first = skin.joints.first().zip(skin.inverse.first());
    first.map_or(DAffine3::IDENTITY, |(joint, inverse)| affine(&(worlds[*joint] * *inverse)))
}

pub(super) fn affine(matrix: &DMat4) -> DAffine3 {
    DAffine3::from_mat4(*matrix)
}

/// What is read.
#[derive(Default)]
struct Found {
    mesh: PolygonMesh,
    /// For each point the nodes that carry it.
    weights: Vec<Vec<(usize, f64)>>,
    lines: usize,
    states: Vec<FileState>,
}

impl Found {
    fn part(&mut self, part: &Part, map: &DAffine3, mapping: Option<&Mapping>) {
        self.lines += part.lines.len();
        if part.triangles.is_empty() {
            return;
        }
        let first = index(self.mesh.points.len());
        let (first_uv, first_normal) = (index(self.mesh.uvs.len()), index(self.mesh.normals.len()));
        let first_color = index(self.mesh.colors.len());
        if part.colors.is_empty() {
            self.mesh.colors.push(Color::WHITE);
        }
        let shade = |color: &[f32; 4]| Color::held(color.map(f64::from));
        self.mesh.colors.extend(part.colors.iter().map(shade));
        let normals = NormalMap::new(&map.matrix3);
        for (vertex, position) in part.positions.iter().enumerate() {
            self.mesh.points.push(map.transform_point3(Vec3::from_array(*position).as_dvec3()));
            if let Some(normal) = part.normals.get(vertex) {
                self.mesh
                    .normals
                    .push(normals.apply(Vec3::from_array(*normal).as_dvec3()).normalize_or_zero());
            }
        }
        let uvs = &part.uvs[mapping.map_or(0, |mapping| mapping.set).min(1)];
        let place = |[u, v]: &[f32; 2]| {
            let place = DVec2::new((*u).into(), (*v).into());
            mapping.map_or(place, |mapping| mapping.at(place))
        };
        self.mesh.uvs.extend(uvs.iter().map(place));
        let material = part.material.map(index);
        for corners in &part.triangles {
            let mut corners = *corners;
            // Strips turn by triangles that are lines.
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                continue;
            }
            if normals.mirrors {
                corners.swap(1, 2);
            }
            self.mesh.push_face(&[&corners.map(|corner| first + corner)], material, 0);
            let uv = |corner: u32| {
                let known = uvs.get(corner as usize).is_some_and(|uv| uv[0].is_finite() && uv[1].is_finite());
                if known { first_uv + corner } else { NONE }
            };
            self.mesh.corner_uvs.extend(corners.map(uv));
            let color = |corner: u32| first_color + if part.colors.is_empty() { 0 } else { corner };
            self.mesh.corner_colors.extend(corners.map(color));
            let mesh = &self.mesh;
            let normal = |corner: u32| {
                let own = first_normal + corner;
                let known = !part.normals.is_empty()
                    && mesh
                        .normals
                        .get(own as usize)
                        .is_some_and(|normal| normal.is_finite() && *normal != DVec3::ZERO);
                if known { own } else { NONE }
            };
            let named = corners.map(normal);
            self.mesh.corner_normals.extend(named);
        }
    }

    /// The states of a part, whose points and normals were added after so many.
    fn states_of(
        &mut self,
        part: &Part,
        map: &DAffine3,
        (points, normals): (usize, usize),
        own: &Morphs<'_>,
    ) {
        if part.triangles.is_empty() {
            return;
        }
        let turned = NormalMap::new(&map.matrix3);
        for (target, moved) in part.targets.iter().enumerate() {
            let known = self.states.iter().position(|state| (state.node, state.target) == (own.node, target));
            let known = known.unwrap_or_else(|| {
                self.states.push(FileState {
                    node: own.node,
                    target,
                    name: own.names.get(target).cloned().unwrap_or_default(),
                    weight: own.weights.get(target).copied().unwrap_or(0.0),
                    ..FileState::default()
                });
                self.states.len() - 1
            });
            let state = &mut self.states[known];
            state.ways.resize(points, DVec3::ZERO);
            state
                .ways
                .extend(moved.positions.iter().map(|way| map.matrix3 * Vec3::from_array(*way).as_dvec3()));
            if moved.normals.len() == part.normals.len() {
                state.turns.resize(normals, DVec3::ZERO);
                // A normal has length 1 once it is turned, and what is added to it is as much shorter or longer.
                state.turns.extend(part.normals.iter().zip(&moved.normals).map(|(normal, turn)| {
                    let normal = Vec3::from_array(*normal).as_dvec3();
                    let length = turned.apply(normal).length();
                    let turn = turned.apply(Vec3::from_array(*turn).as_dvec3());
                    if length > 0.0 { turn / length } else { DVec3::ZERO }
                }));
            }
        }
    }

    /// The joints that carry the points of a part, which were added last.
    fn carry(&mut self, part: &Part, skin: Option<&Skin>, mesh: usize) -> Result<(), GltfFault> {
        let Some(skin) = skin.filter(|_| part.joints.len() == part.shares.len()) else {
            self.weights.resize(self.mesh.points.len(), Vec::new());
            return Ok(());
        };
        if part.triangles.is_empty() {
            return Ok(());
        }
        for (joints, shares) in part.joints.iter().zip(&part.shares) {
            let mut own: Vec<(usize, f64)> = Vec::new();
            for (joint, share) in joints.iter().zip(shares).filter(|(_, share)| **share > 0.0) {
                let node = *skin.joints.get(*joint as usize).ok_or(GltfFault::Joint(mesh, *joint))?;
                match own.iter_mut().find(|(known, _)| *known == node) {
                    Some((_, sum)) => *sum += f64::from(*share),
                    None => own.push((node, f64::from(*share))),
                }
            }
            own.sort_by_key(|(node, _)| *node);
            self.weights.push(own);
        }
        self.weights.resize(self.mesh.points.len(), Vec::new());
        Ok(())
    }

    /// Joins points.
    fn weld(&mut self, within: Option<f64>) {
        for state in &mut self.states {
            state.ways.resize(self.mesh.points.len(), DVec3::ZERO);
            state.turns.resize(self.mesh.normals.len(), DVec3::ZERO);
        }
        if let Some(within) = within {
            // What counts at rest stays as it is.
            let states = std::mem::take(&mut self.states);
            for state in states.iter().filter(|state| state.weight != 0.0) {
                self.mesh
                    .points
                    .iter_mut()
                    .zip(&state.ways)
                    .for_each(|(point, way)| *point += *way * state.weight);
            }
            self.weights.clear();
            self.mesh.weld(within);
            return;
        }
        let welded = weld_equal(&self.mesh.points);
        // For each place the points that stay there.
        let mut kept: Vec<Vec<u32>> = vec![Vec::new(); welded.points.len()];
        let (mut points, mut weights): (Vec<DVec3>, Vec<Vec<(usize, f64)>>) = (Vec::new(), Vec::new());
        let mut map = Vec::with_capacity(self.mesh.points.len());
        // For each point that stays the one that it was.
        let mut before: Vec<usize> = Vec::new();
        for (old, (own, place)) in self.weights.drain(..).zip(&welded.map).enumerate() {
            let here = &mut kept[*place as usize];
            let together =
                |other: usize| self.states.iter().all(|state| state.ways[other] == state.ways[old]);
            let alike = here
                .iter()
                .copied()
                .find(|point| weights[*point as usize] == own && together(before[*point as usize]));
            map.push(alike.unwrap_or_else(|| {
                let new = index(points.len());
                here.push(new);
                before.push(old);
                points.push(welded.points[*place as usize]);
                weights.push(own);
                new
            }));
        }
        for corner in &mut self.mesh.corners {
            *corner = PointIndex(map[corner.subscript()]);
        }
        for state in &mut self.states {
            state.ways = before.iter().map(|old| state.ways[*old]).collect();
        }
        (self.mesh.points, self.weights) = (points, weights);
    }
}

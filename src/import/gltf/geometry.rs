//! The meshes of a file as one mesh of triangles, where its nodes place them.

use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, Vec3};

use super::{Data, GltfFault, GltfFile, Node, Part, open};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::{Color, NormalMap, PolygonMesh, index};
use crate::import::{ImportError, ImportOptions, Imported, MaterialLook, Note};

/// Reads a file: the triangles of the scene that is shown, in its space, states by their weights at rest, skinned meshes as
/// their joints stand at rest. Points are joined where they are equal, or within `weld`. Lines and points are left
/// out with a note, and so are the pictures of materials.
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
    let file = open(bytes, open_other)?;
    let nodes = file.nodes();
    let shown = shown(&file, &nodes, options)?;
    check_size(&file, &nodes, &shown, options.most)?;
    let worlds = file.worlds();
    let data = file.data();
    let mut found = Found { mesh: PolygonMesh::default(), lines: 0 };
    found.mesh.materials = file.document.materials().map(|own| name_of(&own)).collect();
    let mut notes = Vec::new();
    for node in shown {
        let Some(mesh) = nodes[node].mesh.and_then(|mesh| file.document.meshes().nth(mesh)) else { continue };
        let mesh_index = mesh.index();
        let mesh = super::mesh(&data, &mesh, &mut notes)?;
        let stand = Stand::new(&file, &data, &nodes[node], (&worlds, worlds[node]))?;
        let weights = if nodes[node].weights.is_empty() { &mesh.weights } else { &nodes[node].weights };
        for part in &mesh.parts {
            found.part(&morphed(part, weights), &stand, mesh_index)?;
        }
    }
    finish(&file, found, notes, options)
}

fn finish(
    file: &GltfFile,
    found: Found,
    notes: Vec<String>,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let mut mesh = found.mesh;
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
    mesh.weld(options.weld.unwrap_or(0.0));
    let mut notes: Vec<Note> = notes.into_iter().map(|message| Note { line: None, message }).collect();
    let mut note = |message: String| notes.push(Note { line: None, message });
    if found.lines > 0 {
        note(format!("{} lines are left out", found.lines));
    }
    let pictured: Vec<String> = file.document.materials().filter(pictured).map(|own| name_of(&own)).collect();
    if let Some(first) = pictured.first() {
        let count = pictured.len();
        note(format!(
            "the pictures of {count} materials are left out, `{first}` the first; `materials` gives them others"
        ));
    }
    let materials = file.document.materials().map(|own| look(&own)).collect();
    Ok(Imported { mesh, materials, groups: names(file), notes })
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

/// A part with its states added as much as they count.
fn morphed(part: &Part, weights: &[f64]) -> Part {
    let mut part = part.clone();
    for (target, weight) in part.targets.clone().iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        let add = |values: &mut [[f32; 3]], changes: &[[f32; 3]]| {
            for (value, change) in values.iter_mut().zip(changes) {
                let sum =
                    Vec3::from_array(*value).as_dvec3() + Vec3::from_array(*change).as_dvec3() * *weight;
                *value = sum.as_vec3().to_array();
            }
        };
        add(&mut part.positions, &target.positions);
        add(&mut part.normals, &target.normals);
    }
    part
}

/// Where the vertices of a node's mesh stand in the scene.
enum Stand {
    /// All of them by one map.
    Node(DAffine3),
    /// By their joints, each from where it was bound to where it rests.
    Joints(Vec<DAffine3>),
}

impl Stand {
    fn new(
        file: &GltfFile,
        data: &Data<'_>,
        node: &Node,
        (worlds, own): (&[DMat4], DMat4),
    ) -> Result<Self, GltfFault> {
        let Some(skin) = node.skin.and_then(|skin| file.document.skins().nth(skin)) else {
            return Ok(Self::Node(affine(&own)));
        };
        let skin = super::skin(data, &skin)?;
        let joint = |(joint, inverse): (&usize, &DMat4)| affine(&(worlds[*joint] * *inverse));
        Ok(Self::Joints(skin.joints.iter().zip(&skin.inverse).map(joint).collect()))
    }

    /// The map of a vertex.
    fn of(&self, part: &Part, vertex: usize, mesh: usize) -> Result<DAffine3, GltfFault> {
        let maps = match self {
            Self::Node(map) => return Ok(*map),
            Self::Joints(maps) => maps,
        };
        let (Some(joints), Some(shares)) = (part.joints.get(vertex), part.shares.get(vertex)) else {
            return Ok(DAffine3::IDENTITY);
        };
        let (mut matrix, mut translation, mut sum) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        for (joint, share) in joints.iter().zip(shares).filter(|(_, share)| **share > 0.0) {
            let map = maps.get(*joint as usize).ok_or(GltfFault::Joint(mesh, *joint))?;
            let share = f64::from(*share);
            matrix += map.matrix3 * share;
            translation += map.translation * share;
            sum += share;
        }
        Ok(if sum > 0.0 {
            DAffine3::from_mat3_translation(matrix * (1.0 / sum), translation / sum)
        } else {
            DAffine3::IDENTITY
        })
    }
}

fn affine(matrix: &DMat4) -> DAffine3 {
    DAffine3::from_mat4(*matrix)
}

/// What is read.
struct Found {
    mesh: PolygonMesh,
    lines: usize,
}

impl Found {
    fn part(&mut self, part: &Part, stand: &Stand, mesh: usize) -> Result<(), GltfFault> {
        self.lines += part.lines.len();
        if part.triangles.is_empty() {
            return Ok(());
        }
        let first = index(self.mesh.points.len());
        let (first_uv, first_normal) = (index(self.mesh.uvs.len()), index(self.mesh.normals.len()));
        let first_color = index(self.mesh.colors.len());
        if part.colors.is_empty() {
            self.mesh.colors.push(Color::WHITE);
        }
        let shade = |color: &[f32; 4]| Color::held(color.map(f64::from));
        self.mesh.colors.extend(part.colors.iter().map(shade));
        let mut mirrored = Vec::with_capacity(part.positions.len());
        for (vertex, position) in part.positions.iter().enumerate() {
            let map = stand.of(part, vertex, mesh)?;
            let normals = NormalMap::new(&map.matrix3);
            mirrored.push(normals.mirrors);
            self.mesh.points.push(map.transform_point3(Vec3::from_array(*position).as_dvec3()));
            if let Some(normal) = part.normals.get(vertex) {
                self.mesh
                    .normals
                    .push(normals.apply(Vec3::from_array(*normal).as_dvec3()).normalize_or_zero());
            }
        }
        let place = |[u, v]: &[f32; 2]| DVec2::new((*u).into(), (*v).into());
        self.mesh.uvs.extend(part.uvs[0].iter().map(place));
        let material = part.material.map(index);
        for corners in &part.triangles {
            let mut corners = *corners;
            // Strips turn by triangles that are lines.
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                continue;
            }
            if mirrored[corners[0] as usize] {
                corners.swap(1, 2);
            }
            self.mesh.push_face(&[&corners.map(|corner| first + corner)], material, 0);
            let uv = |corner: u32| {
                let known =
                    part.uvs[0].get(corner as usize).is_some_and(|uv| uv[0].is_finite() && uv[1].is_finite());
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
            let normals = corners.map(normal);
            self.mesh.corner_normals.extend(normals);
        }
        Ok(())
    }
}

/// The name of a material, or its number.
fn name_of(own: &gltf::Material<'_>) -> String {
    match own.name().filter(|name| !name.is_empty()) {
        Some(name) => name.to_owned(),
        None => format!("material-{}", own.index().map_or(0, |index| index + 1)),
    }
}

fn look(own: &gltf::Material<'_>) -> MaterialLook {
    let metal = own.pbr_metallic_roughness();
    let share = |value: f32| f64::from(value).clamp(0.0, 1.0);
    let [red, green, blue, opacity] = metal.base_color_factor().map(share);
    let opaque = own.alpha_mode() == gltf::material::AlphaMode::Opaque;
    MaterialLook {
        name: name_of(own),
        color: Some([red, green, blue]),
        opacity: Some(if opaque { 1.0 } else { opacity }),
        metallic: Some(share(metal.metallic_factor())),
        roughness: Some(share(metal.roughness_factor())),
        emissive: Some(own.emissive_factor().map(share)),
        double_sided: own.double_sided(),
        texture: None,
    }
}

/// Whether a material shows pictures.
fn pictured(own: &gltf::Material<'_>) -> bool {
    let metal = own.pbr_metallic_roughness();
    metal.base_color_texture().is_some()
        || metal.metallic_roughness_texture().is_some()
        || own.normal_texture().is_some()
        || own.occlusion_texture().is_some()
        || own.emissive_texture().is_some()
}

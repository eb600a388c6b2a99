//! A file at a moment: every mesh where its nodes, its joints and its morph targets put it.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021, sections 3.7.2.2 (morph targets) and 3.7.3 (skins): a skinned
//! mesh stands where its joints put it, wherever its node is.

use glam::{DMat3, DMat4, DQuat, DVec3};
use thiserror::Error;

use super::asset::{Asset, Lens, Material, Node, Part, Place, changed, see};
use super::heat::HeatMap;
use crate::geometry::number::Bounds;

/// A file at a moment, in meters.
#[derive(Clone, Debug)]
pub struct Stage {
    /// All vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Lines of vertices.
    pub lines: Vec<[u32; 2]>,
    /// The materials of the asset as they are then.
    pub materials: Vec<Material>,
    /// What the triangles belong to, in their order.
    pub pieces: Vec<Piece>,
    /// The box around all vertices that are used.
    pub bounds: Bounds,
    /// Numbers that are shown as colors, in place of the materials.
    pub heat: Option<HeatMap>,
    /// The cameras of the file.
    pub eyes: Vec<Eye>,
}

/// A camera of the file, where it stands.
#[derive(Clone, Debug)]
pub struct Eye {
    /// The name of its node.
    pub name: String,
    /// From its axes to space.
    pub world: DMat4,
    /// How it sees.
    pub lens: Lens,
}

/// A corner of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Where it stands.
    pub point: DVec3,
    /// Normal of length 1; zero where the file has none.
    pub normal: DVec3,
    /// Tangent of length 1 and the side of the bitangent; zero where the file has none.
    pub tangent: [f32; 4],
    /// Two sets of texture coordinates.
    pub uvs: [[f32; 2]; 2],
    /// Linear color with opacity.
    pub color: [f32; 4],
}

/// Triangles and lines of one primitive at one node.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// The node.
    pub node: usize,
    /// The material: an index into those of the asset.
    pub material: usize,
    /// One more than its last triangle.
    pub end: usize,
    /// The mesh.
    pub mesh: usize,
    /// From the axes of the mesh to space; none where joints or morph targets bend it.
    pub world: Option<DMat4>,
}

/// Which moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// Name of the clip; none shows what the file holds at rest.
    pub clip: Option<String>,
    /// Seconds from its start.
    pub time: f64,
}

/// Why a moment cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StageError {
    /// No clip of the name.
    #[error("there is no clip `{asked}`{}", known(.clips))]
    Clip {
        /// What was asked for.
        asked: String,
        /// Those that there are.
        clips: Vec<String>,
    },
}

fn known(clips: &[String]) -> String {
    if clips.is_empty() {
        ": the file has none".to_owned()
    } else {
        format!(": there are {}", clips.join(", "))
    }
}

impl Stage {
    /// The file at a moment. What is not finite is left where it would stand without it: at the origin.
    ///
    /// Cost: linear in vertices, times morph targets whose weight is not zero.
    ///
    /// # Errors
    /// When there is no clip of the name.
    pub fn new(asset: &Asset, moment: &Moment) -> Result<Self, StageError> {
        let (nodes, materials) = posed(asset, moment)?;
        let mut worlds = vec![DMat4::IDENTITY; nodes.len()];
        let mut open: Vec<(usize, DMat4)> =
            asset.roots.iter().rev().map(|root| (*root, DMat4::IDENTITY)).collect();
        let mut order = Vec::with_capacity(nodes.len());
        while let Some((node, above)) = open.pop() {
            worlds[node] = above * nodes[node].place.matrix();
            order.push(node);
            open.extend(nodes[node].children.iter().rev().map(|child| (*child, worlds[node])));
        }
        let mut stage = Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            lines: Vec::new(),
            materials: materials.unwrap_or_else(|| asset.materials.clone()),
            pieces: Vec::new(),
            bounds: Bounds::of_points([]),
            heat: None,
            eyes: Vec::new(),
        };
        for node in order {
            if let Some((_, lens)) = nodes[node].camera {
                let name = nodes[node].name.clone();
                stage.eyes.push(Eye { name, world: worlds[node], lens });
            }
            let Some(number) = nodes[node].mesh.filter(|mesh| *mesh < asset.meshes.len()) else { continue };
            let mesh = &asset.meshes[number];
            let own = &nodes[node].weights;
            let weights = if own.is_empty() { &mesh.weights } else { own };
            let joints: Option<Vec<DMat4>> = nodes[node].skin.map(|skin| {
                let skin = &asset.skins[skin];
                skin.joints
                    .iter()
                    .zip(&skin.inverse)
                    .map(|(joint, inverse)| worlds[*joint] * *inverse)
                    .collect()
            });
            let moved = joints.is_some()
                || mesh.parts.iter().any(|part| {
                    let mut own = part.targets.iter().zip(weights);
                    own.any(|(_, weight)| *weight != 0.0)
                });
            let world = (!moved).then_some(worlds[node]);
            for part in &mesh.parts {
                stage.add(part, weights, (worlds[node], joints.as_deref()));
                let last = asset.materials.len() - 1;
                let material = part.material.unwrap_or(last).min(last);
                stage.pieces.push(Piece { node, material, end: stage.triangles.len(), mesh: number, world });
            }
        }
        let used = stage.triangles.iter().flatten().chain(stage.lines.iter().flatten());
        stage.bounds = Bounds::of_points(used.map(|vertex| stage.vertices[*vertex as usize].point));
        Ok(stage)
    }

    fn add(&mut self, part: &Part, weights: &[f64], (world, joints): (DMat4, Option<&[DMat4]>)) {
        let base = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        let morphs: Vec<_> = part.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0).collect();
        let at = |list: &[[f32; 3]], k: usize| {
            list.get(k).map_or(DVec3::ZERO, |[x, y, z]| DVec3::new((*x).into(), (*y).into(), (*z).into()))
        };
        for k in 0..part.positions.len() {
            let (mut point, mut normal) = (at(&part.positions, k), at(&part.normals, k));
            for (target, weight) in &morphs {
                point += at(&target.positions, k) * **weight;
                normal += at(&target.normals, k) * **weight;
            }
            let own = joints.and_then(|joints| blend(part, joints, k));
            let matrix = own.unwrap_or(world);
            let tangent = part.tangents.get(k).copied().unwrap_or_default();
            let along =
                matrix.transform_vector3(DVec3::new(tangent[0].into(), tangent[1].into(), tangent[2].into()));
            let [x, y, z] = along.normalize_or_zero().as_vec3().to_array();
            self.vertices.push(Vertex {
                point: finite(matrix.transform_point3(point)),
                normal: finite(turned(&matrix, normal)),
                tangent: [x, y, z, tangent[3]],
                uvs: [0, 1].map(|set| part.uvs[set].get(k).copied().unwrap_or_default()),
                color: part.colors.get(k).copied().unwrap_or([1.0; 4]),
            });
        }
        // A matrix that mirrors turns the triangles around.
        let mirrored = joints.is_none() && world.determinant() < 0.0;
        self.triangles.extend(part.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| corner + base);
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
        self.lines.extend(part.lines.iter().map(|ends| ends.map(|end| end + base)));
    }
}

/// The nodes at a moment, and the materials where a clip was asked for.
fn posed(asset: &Asset, moment: &Moment) -> Result<(Vec<Node>, Option<Vec<Material>>), StageError> {
    let mut nodes = asset.nodes.clone();
    let Some(asked) = &moment.clip else { return Ok((nodes, None)) };
    let clip = asset.clips.iter().find(|clip| clip.name == *asked).ok_or_else(|| StageError::Clip {
        asked: asked.clone(),
        clips: asset.clips.iter().map(|clip| clip.name.clone()).collect(),
    })?;
    clip.apply(moment.time, &mut nodes);
    see(clip, moment.time, &mut nodes);
    Ok((nodes, Some(changed(asset, clip, moment.time))))
}

/// How each node is turned at a moment, relative to its parent; none where a matrix says where it stands.
///
/// # Errors
/// When there is no clip of the name.
pub fn turns(asset: &Asset, moment: &Moment) -> Result<Vec<Option<DQuat>>, StageError> {
    let turn = |node: &Node| match node.place {
        Place::Parts { rotation, .. } => Some(rotation),
        Place::Matrix(_) => None,
    };
    Ok(posed(asset, moment)?.0.iter().map(turn).collect())
}

fn finite(vector: DVec3) -> DVec3 {
    if vector.is_finite() { vector } else { DVec3::ZERO }
}

/// Where the joints of a vertex put it; none where it has none.
fn blend(part: &Part, joints: &[DMat4], vertex: usize) -> Option<DMat4> {
    let (own, shares) = (part.joints.get(vertex)?, part.shares.get(vertex)?);
    let mut sum = DMat4::ZERO;
    for (joint, share) in own.iter().zip(shares) {
        if *share != 0.0 {
            sum += *joints.get(*joint as usize)? * f64::from(*share);
        }
    }
    Some(sum)
}

/// A normal as a matrix turns it: across the surface, whatever the scale.
fn turned(matrix: &DMat4, normal: DVec3) -> DVec3 {
    let linear = DMat3::from_mat4(*matrix);
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    (cofactors * normal * sign).normalize_or_zero()
}

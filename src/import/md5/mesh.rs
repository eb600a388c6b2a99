//! Meshes with joints and weights (`.md5mesh`).
//!
//! A vertex is the sum of points that stand in the spaces of joints, each by its weight. Vertices of a mesh that have
//! one place and the same weights, as they do along seams of a picture, are made one point. At most four joints carry a
//! point: of more the greatest weights are kept and brought to the sum 1, and a note counts the points.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::tokens::Tokens;
use super::{Md5Fault, Md5Joint, Place, joint, place, version};
use crate::geometry::mesh::{PolygonMesh, index};
use crate::import::{ImportError, Imported, MaterialLook, Note};

/// The most weights of a vertex that are read.
pub const MOST_WEIGHTS: u32 = 256;
/// Joints that carry a point.
const KEPT: usize = 4;

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Md5Mesh {
    /// The joints, parents first.
    pub joints: Vec<Md5Joint>,
    /// For each joint its place at rest, in the model's space.
    pub places: Vec<Place>,
    /// The meshes; each is a group with the name of its material.
    pub imported: Imported,
    /// For each point the joints that carry it, increasing, and their weights, whose sum is 1.
    pub weights: Vec<Vec<(usize, f64)>>,
}

/// Joints and weights of a vertex, for the search of equal ones.
type Key = ([u64; 3], Vec<(usize, u64)>);

/// Reads a file: all of its meshes, or those of a material. O(n log n) in its length.
///
/// # Errors
/// See [`Md5Fault`]; a material that no mesh has; no triangle.
pub fn read(bytes: &[u8], group: Option<&str>) -> Result<Md5Mesh, ImportError> {
    let mut tokens = Tokens::new(bytes)?;
    version(&mut tokens)?;
    tokens.word("numJoints", "`numJoints`")?;
    let joints = tokens.count("the number of joints")?;
    tokens.word("numMeshes", "`numMeshes`")?;
    let meshes = tokens.count("the number of meshes")?;
    let (joints, places) = self::joints(&mut tokens, joints)?;
    let mut whole =
        Whole { joints: &joints, places: &places, found: Imported::default(), weights: Vec::new() };
    whole.found.mesh = PolygonMesh { has_smoothing: true, ..PolygonMesh::default() };
    let (mut count, mut pruned) = (0, 0);
    while !tokens.is_done() {
        pruned += whole.mesh(&mut tokens, group)?;
        count += 1;
    }
    tokens.counted("meshes", meshes, count)?;
    let Whole { found: mut imported, weights, .. } = whole;
    if let Some(group) = group.filter(|group| !imported.groups.iter().any(|name| name == group)) {
        return Err(ImportError::UnknownGroup { group: group.to_owned(), known: imported.groups });
    }
    if imported.mesh.faces.is_empty() {
        return Err(ImportError::NoFaces { vertices: index(imported.mesh.points.len()) });
    }
    if pruned > 0 {
        let message = format!(
            "{pruned} points are carried by more than {KEPT} joints; the {KEPT} greatest weights of each are kept"
        );
        imported.notes.push(Note { line: None, message });
    }
    Ok(Md5Mesh { joints, places, imported, weights })
}

fn joints(tokens: &mut Tokens<'_>, announced: u32) -> Result<(Vec<Md5Joint>, Vec<Place>), Md5Fault> {
    tokens.word("joints", "`joints`")?;
    tokens.word("{", "`{`")?;
    let (mut joints, mut places) = (Vec::new(), Vec::new());
    while !tokens.is_next("}") {
        joints.push(joint(tokens, joints.len())?);
        places.push(place(tokens)?);
    }
    tokens.word("}", "`}`")?;
    tokens.counted("joints", announced, joints.len())?;
    if joints.is_empty() {
        return Err(Md5Fault::Count { line: tokens.line(), what: "joints", announced, found: 0 });
    }
    Ok((joints, places))
}

struct Whole<'j> {
    joints: &'j [Md5Joint],
    places: &'j [Place],
    found: Imported,
    weights: Vec<Vec<(usize, f64)>>,
}

/// A vertex as it is written.
struct Vertex {
    line: u32,
    uv: DVec2,
    first: usize,
    count: u32,
}

/// A weight as it is written.
struct Weight {
    joint: usize,
    share: f64,
    place: DVec3,
}

impl Whole<'_> {
    /// Reads a mesh and adds it where it is wanted; how many of its points lost weights.
    fn mesh(&mut self, tokens: &mut Tokens<'_>, group: Option<&str>) -> Result<usize, Md5Fault> {
        tokens.word("mesh", "`mesh`")?;
        tokens.word("{", "`{`")?;
        let mut name = String::new();
        if tokens.is_next("shader") {
            tokens.word("shader", "`shader`")?;
            name = tokens.name("the name of a material")?;
        }
        let vertices = rows(tokens, ("numverts", "vert"), ("vertices", "`numverts`", "`vert`"), |tokens| {
            let [s, t] = tokens.numbers("a texture coordinate")?;
            let first = tokens.count("the number of a weight")?;
            let count = tokens.count("how many weights")?;
            Ok(Vertex { line: tokens.line(), uv: DVec2::new(s, t), first: first as usize, count })
        })?;
        let triangles = rows(tokens, ("numtris", "tri"), ("triangles", "`numtris`", "`tri`"), |tokens| {
            let mut corner = || tokens.index("vertex", vertices.len());
            Ok([corner()?, corner()?, corner()?])
        })?;
        let joints = self.joints.len();
        let weights =
            rows(tokens, ("numweights", "weight"), ("weights", "`numweights`", "`weight`"), |tokens| {
                let joint = tokens.index("joint", joints)?;
                let share = tokens.number("a weight")?;
                Ok(Weight { joint, share, place: DVec3::from_array(tokens.numbers("a coordinate")?) })
            })?;
        tokens.word("}", "`}`")?;
        let name = if name.is_empty() { format!("mesh-{}", self.found.groups.len() + 1) } else { name };
        let wanted = group.is_none_or(|group| group == name);
        if !self.found.groups.contains(&name) {
            self.found.groups.push(name.clone());
        }
        if wanted { self.add(name, &vertices, &triangles, &weights) } else { Ok(0) }
    }

    fn add(
        &mut self,
        name: String,
        vertices: &[Vertex],
        triangles: &[[usize; 3]],
        weights: &[Weight],
    ) -> Result<usize, Md5Fault> {
        let material = self.material(name);
        let mesh = &mut self.found.mesh;
        let first_uv = mesh.uvs.len();
        let mut known: BTreeMap<Key, u32> = BTreeMap::new();
        let mut points = Vec::with_capacity(vertices.len());
        let mut pruned = 0;
        for (number, vertex) in vertices.iter().enumerate() {
            let own = of_vertex(number, vertex, weights)?;
            let place: DVec3 =
                own.iter().map(|weight| self.places[weight.joint].at(weight.place) * weight.share).sum();
            let mut shares = shares(own, number, vertex.line)?;
            mesh.uvs.push(vertex.uv);
            let bits = (place + DVec3::ZERO).to_array().map(f64::to_bits);
            let next = index(mesh.points.len());
            let key = (bits, shares.iter().map(|(joint, share)| (*joint, share.to_bits())).collect());
            let point = *known.entry(key).or_insert(next);
            if point == next {
                pruned += usize::from(prune(&mut shares));
                mesh.points.push(place);
                self.weights.push(shares);
            }
            points.push(point);
        }
        // Clockwise becomes counter-clockwise.
        for [a, b, c] in triangles.iter().copied() {
            let corners = [a, c, b];
            mesh.push_face(&[&corners.map(|corner| points[corner])], Some(material), 1);
            mesh.corner_uvs.extend(corners.map(|corner| index(first_uv + corner)));
        }
        Ok(pruned)
    }

    fn material(&mut self, name: String) -> u32 {
        let names = &mut self.found.mesh.materials;
        if let Some(known) = names.iter().position(|known| *known == name) {
            return index(known);
        }
        names.push(name.clone());
        // A shader may be defined elsewhere; one that is written as a path names a picture.
        let path = if name.contains(['/', '\\', '.']) { name.as_str() } else { "" };
        self.found.materials.push(MaterialLook::pictured(&name, path));
        index(names.len() - 1)
    }
}

impl Place {
    /// Where a point of the joint's space is.
    fn at(&self, point: DVec3) -> DVec3 {
        self.translation + self.rotation * point
    }
}

/// A count and as many rows, each with its number after its word.
fn rows<T>(
    tokens: &mut Tokens<'_>,
    (count, word): (&str, &str),
    (what, expected_count, expected): (&'static str, &'static str, &'static str),
    mut row: impl FnMut(&mut Tokens<'_>) -> Result<T, Md5Fault>,
) -> Result<Vec<T>, Md5Fault> {
    tokens.word(count, expected_count)?;
    let announced = tokens.count("how many")?;
    let mut rows = Vec::new();
    while tokens.is_next(word) {
        tokens.word(word, expected)?;
        tokens.ordered(what, rows.len())?;
        rows.push(row(tokens)?);
    }
    tokens.counted(what, announced, rows.len())?;
    Ok(rows)
}

/// The weights of a vertex.
fn of_vertex<'w>(number: usize, vertex: &Vertex, weights: &'w [Weight]) -> Result<&'w [Weight], Md5Fault> {
    let Vertex { line, first, count, .. } = *vertex;
    if count == 0 {
        return Err(Md5Fault::Bare { line, vertex: number });
    }
    if count > MOST_WEIGHTS {
        return Err(Md5Fault::Crowded { line, vertex: number, count });
    }
    let end = first.saturating_add(count as usize);
    weights.get(first..end).ok_or(Md5Fault::Index {
        line,
        what: "weight",
        index: index(end.min(u32::MAX as usize) - 1),
        count: weights.len(),
    })
}

/// For each joint of a vertex the sum of its weights, brought to the sum 1.
fn shares(own: &[Weight], vertex: usize, line: u32) -> Result<Vec<(usize, f64)>, Md5Fault> {
    let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
    for weight in own {
        *sums.entry(weight.joint).or_default() += weight.share.max(0.0);
    }
    let whole: f64 = sums.values().sum();
    if whole <= 0.0 {
        return Err(Md5Fault::Bare { line, vertex });
    }
    let share = |(joint, sum): (usize, f64)| (sum > 0.0).then_some((joint, sum / whole));
    Ok(sums.into_iter().filter_map(share).collect())
}

/// Leaves the greatest weights, brought to the sum 1; whether there were more.
fn prune(shares: &mut Vec<(usize, f64)>) -> bool {
    if shares.len() <= KEPT {
        return false;
    }
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    shares.truncate(KEPT);
    shares.sort_by_key(|(joint, _)| *joint);
    let whole: f64 = shares.iter().map(|(_, share)| share).sum();
    shares.iter_mut().for_each(|(_, share)| *share /= whole);
    true
}

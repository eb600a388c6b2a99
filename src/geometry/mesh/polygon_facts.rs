//! The classical properties of a polyhedron, measured on its polygons before they are cut into triangles.
//!
//! V vertices, E edges, F faces, H hole loops and genus G obey Euler-Poincare, V - E + F = 2 (C - G) + H for C
//! closed components; for one component V + F - E = 2 + H - 2G.

use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::geometry::mesh::triangulate::drop_axis;
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::planar::{crossing, turn};

/// A face is called planar when no corner is further from its plane than this part of the face's size: what
/// decimal coordinates of six digits leave.
pub const PLANAR_PART: f64 = 1e-5;

/// Properties of the source polygons. Points at equal positions count as one vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PolygonFacts {
    /// V: positions that a face uses.
    pub vertices: u64,
    /// E: pairs of positions that an edge joins.
    pub edges: u64,
    /// F: faces.
    pub faces: u64,
    /// H: loops beyond the outer one of each face.
    pub holes: u64,
    /// C: sets of faces joined through edges.
    pub components: u64,
    /// V - E + F - H.
    pub euler: i64,
    /// G, summed over components, when the polyhedron is closed and each edge has exactly two faces; halves appear
    /// where parts touch in a vertex only, and then there is no genus.
    pub genus: Option<u64>,
    /// Each edge is used equally often in both directions.
    pub closed: bool,
    /// One component ("monolithic").
    pub connected: bool,
    /// No face's outline crosses itself or repeats a vertex.
    pub simple: bool,
    /// Every face lies in a plane, within [`PLANAR_PART`] of its size.
    pub planar: bool,
    /// The largest distance of a corner from its face's plane (through the mean of its corners), metres.
    pub planar_deviation: f64,
    /// Every face is convex and without holes.
    pub convex_faces: bool,
    /// Corners of the largest face.
    pub most_corners: u64,
}

/// Measures a valid mesh (see [`PolygonMesh::validate`]). O(n log n); O(k^2) at worst for a face of k corners.
#[must_use]
pub fn measure(mesh: &PolygonMesh) -> PolygonFacts {
    let places = weld_equal(&mesh.points).map;
    let mut facts = PolygonFacts {
        faces: mesh.faces.len() as u64,
        holes: (mesh.loop_ends.len() - mesh.faces.len()) as u64,
        simple: true,
        planar: true,
        convex_faces: true,
        ..PolygonFacts::default()
    };
    measure_edges(mesh, &places, &mut facts);
    for face in 0..mesh.faces.len() {
        measure_face(mesh, &places, face, &mut facts);
    }
    facts
}

/// A directed edge of a face, keyed by its lower place.
struct Edge {
    low: u32,
    high: u32,
    forward: bool,
    face: u32,
}

fn measure_edges(mesh: &PolygonMesh, places: &[u32], facts: &mut PolygonFacts) {
    let mut edges = directed_edges(mesh, places);
    edges.sort_unstable_by_key(|edge| (edge.low, edge.high));
    let mut parents: Vec<u32> = (0..index(mesh.faces.len())).collect();
    facts.closed = true;
    let mut two_faces = true;
    for uses in edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)) {
        facts.edges += 1;
        let forward = uses.iter().filter(|edge| edge.forward).count();
        facts.closed &= 2 * forward == uses.len();
        two_faces &= uses.len() == 2;
        for pair in uses.windows(2) {
            join(&mut parents, pair[0].face, pair[1].face);
        }
    }
    let mut used: Vec<u32> = mesh.corners.iter().map(|point| places[point.subscript()]).collect();
    used.sort_unstable();
    used.dedup();
    facts.vertices = used.len() as u64;
    facts.components = parents.iter().zip(0..).filter(|&(&parent, face)| parent == face).count() as u64;
    facts.connected = facts.components == 1;
    let signed = |count: u64| i64::try_from(count).expect("counts are below 2^33");
    facts.euler = signed(facts.vertices) - signed(facts.edges) + signed(facts.faces) - signed(facts.holes);
    let handles = 2 * signed(facts.components) - facts.euler;
    if facts.closed && two_faces && handles >= 0 && handles % 2 == 0 {
        facts.genus = u64::try_from(handles / 2).ok();
    }
}

fn directed_edges(mesh: &PolygonMesh, places: &[u32]) -> Vec<Edge> {
    let mut edges = Vec::with_capacity(mesh.corners.len());
    for face in 0..mesh.faces.len() {
        for ring in mesh.loops_of(face) {
            let corners = &mesh.corners[mesh.corners_of_loop(ring)];
            for (corner, from) in corners.iter().enumerate() {
                let to = corners[(corner + 1) % corners.len()];
                let [from, to] = [from, &to].map(|point| places[point.subscript()]);
                if from != to {
                    let (low, high) = (from.min(to), from.max(to));
                    edges.push(Edge { low, high, forward: from == low, face: index(face) });
                }
            }
        }
    }
    edges
}

fn find(parents: &mut [u32], mut face: u32) -> u32 {
    while parents[face as usize] != face {
        parents[face as usize] = parents[parents[face as usize] as usize];
        face = parents[face as usize];
    }
    face
}

fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parents, a), find(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

fn measure_face(mesh: &PolygonMesh, places: &[u32], face: usize, facts: &mut PolygonFacts) {
    let corners = mesh.corners_of(face);
    facts.most_corners = facts.most_corners.max(corners.len() as u64);
    let normal = mesh.newell(face).normalize_or_zero();
    let deviation = plane_deviation(mesh, corners.clone(), normal);
    facts.planar_deviation = facts.planar_deviation.max(deviation.0);
    facts.planar &= deviation.0 <= PLANAR_PART * deviation.1;

    let rings: Vec<Vec<DVec2>> = mesh
        .loops_of(face)
        .map(|ring| {
            mesh.corners_of_loop(ring).map(|corner| drop_axis(mesh.position(corner), normal)).collect()
        })
        .collect();
    let slices: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    let simple = normal != DVec3::ZERO && !repeats(mesh, places, corners) && crossing(&slices).is_none();
    facts.simple &= simple;
    facts.convex_faces &= simple && slices.len() == 1 && is_convex(slices[0]);
}

/// Largest distance of the corners from their mean plane, and the size of the face.
fn plane_deviation(mesh: &PolygonMesh, corners: std::ops::Range<usize>, normal: DVec3) -> (f64, f64) {
    let origin = mesh.position(corners.start);
    let arms = || corners.clone().map(|corner| mesh.position(corner) - origin);
    #[expect(clippy::cast_precision_loss, reason = "a mean of fewer than 2^32 corners")]
    let count = corners.len() as f64;
    let middle = arms().sum::<DVec3>().dot(normal) / count;
    let far = arms().map(|arm| (arm.dot(normal) - middle).abs()).fold(0.0, f64::max);
    (far, arms().map(DVec3::length).fold(0.0, f64::max))
}

fn repeats(mesh: &PolygonMesh, places: &[u32], corners: std::ops::Range<usize>) -> bool {
    let mut seen: Vec<u32> = corners.map(|corner| places[mesh.corners[corner].subscript()]).collect();
    seen.sort_unstable();
    seen.windows(2).any(|pair| pair[0] == pair[1])
}

/// Whether a simple ring never turns right: exact.
fn is_convex(ring: &[DVec2]) -> bool {
    (0..ring.len()).all(|corner| {
        let at = |step: usize| ring[(corner + step) % ring.len()];
        turn(at(0), at(1), at(2)) >= 0.0
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::measure;
    use crate::geometry::mesh::PolygonMesh;

    fn points(list: &[[f64; 3]]) -> Vec<DVec3> {
        list.iter().copied().map(DVec3::from_array).collect()
    }

    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    const SIDES: [&[u32]; 6] =
        [&[3, 2, 1, 0], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

    #[test]
    fn cube() {
        let facts = measure(&PolygonMesh::from_faces(points(&CUBE), &SIDES));
        assert_eq!((facts.vertices, facts.edges, facts.faces, facts.holes), (8, 12, 6, 0));
        assert_eq!((facts.euler, facts.genus, facts.components), (2, Some(0), 1));
        assert!(facts.closed && facts.connected && facts.simple && facts.planar && facts.convex_faces);
        assert_eq!((facts.planar_deviation, facts.most_corners), (0.0, 4));
    }

    /// A block with a square hole through it: V + F - E = 2 + H - 2G with H = 2, G = 1.
    #[test]
    fn block_with_a_hole_through_it() {
        let mut all = points(&CUBE);
        all.extend(CUBE.map(|[x, y, z]| DVec3::new(0.25 + 0.5 * x, 0.25 + 0.5 * y, z)));
        let mut mesh = PolygonMesh { points: all, ..PolygonMesh::default() };
        for side in &SIDES[2..] {
            mesh.push_face(&[side], None, 0);
            let inner: Vec<u32> = side.iter().rev().map(|corner| corner + 8).collect();
            mesh.push_face(&[&inner], None, 0);
        }
        mesh.push_face(&[&[3, 2, 1, 0], &[8, 9, 10, 11]], None, 0);
        mesh.push_face(&[&[4, 5, 6, 7], &[15, 14, 13, 12]], None, 0);
        let facts = measure(&mesh);
        assert_eq!((facts.vertices, facts.edges, facts.faces, facts.holes), (16, 24, 10, 2));
        assert_eq!(
            facts.vertices + facts.faces,
            facts.edges + 2 + facts.holes - 2 * facts.genus.expect("closed")
        );
        assert_eq!(facts.genus, Some(1));
        assert!(facts.closed && facts.connected && facts.simple && facts.planar && !facts.convex_faces);
    }

    #[test]
    fn two_cubes_apart_and_two_sharing_a_vertex() {
        for (shift, vertices, genus) in [(3.0, 16, Some(0)), (1.0, 15, None)] {
            let mut all = points(&CUBE);
            all.extend(CUBE.map(|[x, y, z]| DVec3::new(x + shift, y + shift, z + shift)));
            let mut faces: Vec<Vec<u32>> = SIDES.map(<[u32]>::to_vec).to_vec();
            faces.extend(SIDES.map(|side| side.iter().map(|corner| corner + 8).collect()));
            let slices: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
            let facts = measure(&PolygonMesh::from_faces(all, &slices));
            assert_eq!((facts.vertices, facts.components, facts.connected), (vertices, 2, false));
            assert_eq!(facts.genus, genus, "shifted by {shift}");
        }
    }

    #[test]
    fn each_fault_shows_in_its_own_property() {
        let mut bent = points(&CUBE);
        bent[6].z = 1.3;
        let facts = measure(&PolygonMesh::from_faces(bent, &SIDES));
        assert!(!facts.planar && facts.simple && facts.closed);
        assert!((facts.planar_deviation - 0.07).abs() < 0.01, "{}", facts.planar_deviation);

        let open = measure(&PolygonMesh::from_faces(points(&CUBE), &SIDES[1..]));
        assert!(!open.closed && open.genus.is_none() && open.euler == 1);

        let bow_tie: &[&[u32]] = &[&[0, 1, 3, 2]];
        let facts = measure(&PolygonMesh::from_faces(points(&CUBE), bow_tie));
        assert!(!facts.simple && !facts.convex_faces);
        // A star that turns left at each of its tips.
        let star = points(&[
            [0.0, 3.0, 0.0],
            [-2.0, -3.0, 0.0],
            [3.0, 1.0, 0.0],
            [-3.0, 1.0, 0.0],
            [2.0, -3.0, 0.0],
        ]);
        let facts = measure(&PolygonMesh::from_faces(star, &[&[0, 1, 2, 3, 4]]));
        assert!(!facts.simple && !facts.convex_faces);

        let dart = points(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]]);
        let facts = measure(&PolygonMesh::from_faces(dart, &[&[0, 1, 2, 3]]));
        assert!(facts.simple && facts.planar && !facts.convex_faces);
    }
}

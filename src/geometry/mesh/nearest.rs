//! The nearest points of triangles, and how far two meshes are apart.
//!
//! Promise: the nearest triangle is exact but for rounding, and of several at one distance the first. How far meshes are apart is
//! found by samples on both of them, so that what only one of them has is seen too. Cost: a tree of boxes, O(n log n), and
//! some ten boxes for each question.

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::Mesh;
use super::tree::Tree;

/// A mesh that can be asked for nearest points.
pub struct Nearest<'a> {
    mesh: &'a Mesh,
    triangles: Vec<[u32; 3]>,
    tree: Tree,
}

/// A nearest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Its triangle.
    pub triangle: usize,
    /// Weights of the triangle's corners whose sum is the point.
    pub weights: [f64; 3],
    /// How far it is, metres.
    pub distance: f64,
}

/// Samples of a triangle: its corners, its middle, those of its sides, and halfway from its middle to the corners.
const SAMPLES: [[f64; 3]; 10] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
];

impl<'a> Nearest<'a> {
    /// The triangles of a mesh.
    #[must_use]
    pub fn new(mesh: &'a Mesh) -> Self {
        let point = |vertex: super::VertexIndex| mesh.vertices[vertex.subscript()].point.0;
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|corners| corners.map(point)).collect();
        let tree = Tree::new(&mesh.points, &triangles);
        Self { mesh, triangles, tree }
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|point| self.mesh.points[point as usize])
    }

    /// The nearest point; `None` of a mesh without triangles.
    #[must_use]
    pub fn find(&self, point: DVec3) -> Option<Found> {
        let distance = |triangle: u32| nearest_of_triangle(self.corners(triangle), point).distance(point);
        let (triangle, distance) = self.tree.least(point, distance)?;
        let corners = self.corners(triangle);
        let weights = weights(corners, nearest_of_triangle(corners, point));
        Some(Found { triangle: triangle as usize, weights, distance })
    }

    /// The greatest distance from samples of each triangle of another mesh to this one.
    fn farthest(&self, other: &Mesh, samples: &[[f64; 3]]) -> f64 {
        let of = |corners: &[super::VertexIndex; 3]| {
            let places =
                corners.map(|vertex| other.points[other.vertices[vertex.subscript()].point.subscript()]);
            let away = |weights: &[f64; 3]| {
                let sample = (0..3).map(|k| places[k] * weights[k]).sum();
                self.find(sample).map_or(f64::INFINITY, |found| found.distance)
            };
            samples.iter().map(away).fold(0.0, f64::max)
        };
        other.triangles.par_iter().with_min_len(256).map(of).reduce(|| 0.0, f64::max)
    }
}

/// The greatest distance between a mesh of larger triangles and one of smaller ones that samples on both of them find, metres;
/// infinite where one of them alone has triangles.
#[must_use]
pub fn distance_between(coarse: &Mesh, fine: &Mesh) -> f64 {
    let (fine, of_fine) = (Nearest::new(fine), fine);
    fine.farthest(coarse, &SAMPLES).max(Nearest::new(coarse).farthest(of_fine, &SAMPLES[..4]))
}

/// Weights of the corners of a triangle for a point on it.
pub(crate) fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let square = normal.length_squared();
    if square > 0.0 {
        let part = |from: DVec3, to: DVec3| (from - point).cross(to - point).dot(normal) / square;
        let (u, v) = (part(b, c).clamp(0.0, 1.0), part(c, a).clamp(0.0, 1.0));
        return [u, v.min(1.0 - u), (1.0 - u - v).max(0.0)];
    }
    // A triangle without area is its longest side.
    let sides = [(0, 1, a, b), (1, 2, b, c), (2, 0, c, a)];
    let longest = sides
        .into_iter()
        .max_by(|one, other| one.2.distance_squared(one.3).total_cmp(&other.2.distance_squared(other.3)));
    let mut weights = [1.0, 0.0, 0.0];
    if let Some((from, to, p, q)) = longest.filter(|(.., p, q)| p != q) {
        let share = ((point - p).dot(q - p) / p.distance_squared(q)).clamp(0.0, 1.0);
        weights = [0.0; 3];
        (weights[from], weights[to]) = (1.0 - share, share);
    }
    weights
}

/// The nearest point of a triangle.
#[must_use]
pub fn nearest_of_triangle(corners: [DVec3; 3], point: DVec3) -> DVec3 {
    nearest_part(corners, point).0
}

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A corner, by its number.
    Corner(usize),
    /// A side, by the number of the corner at which it starts.
    Side(usize),
    /// What is between the sides.
    Inside,
}

/// The nearest point of a triangle, and the least part of it that the point lies on.
///
/// Source: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
#[must_use]
pub fn nearest_part([a, b, c]: [DVec3; 3], point: DVec3) -> (DVec3, Part) {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Part::Corner(0));
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Part::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Part::Side(0));
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Part::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Part::Side(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Part::Side(1));
    }
    let sum = va + vb + vc;
    (a + ab * (vb / sum) + ac * (vc / sum), Part::Inside)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Nearest, distance_between};
    use crate::geometry::mesh::Mesh;
    use crate::geometry::mesh::convert::{ConvertOptions, convert};
    use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};

    fn ball(radius: f64) -> Mesh {
        let solid = platonic(Platonic::Icosahedron, PlatonicSize::Circumradius(radius), Pose::Axes);
        convert(&solid, &ConvertOptions::default()).expect("a solid").mesh
    }

    #[test]
    fn the_tree_finds_what_looking_at_all_finds() {
        let ball = ball(1.0);
        let nearest = Nearest::new(&ball);
        for k in 0..500_u32 {
            let part = |step: u32| f64::from(k * step % 97) / 48.5 - 1.0;
            let point = DVec3::new(part(5), part(11), part(23)) * 2.0;
            let found = nearest.find(point).expect("there are triangles");
            let corners = |triangle: u32| nearest.corners(triangle);
            let all =
                (0..20).map(|triangle| super::nearest_of_triangle(corners(triangle), point).distance(point));
            let least = all.fold(f64::INFINITY, f64::min);
            assert!((found.distance - least).abs() < 1e-14);
            let triangle = u32::try_from(found.triangle).expect("twenty");
            let sum: DVec3 = (0..3).map(|k| corners(triangle)[k] * found.weights[k]).sum();
            assert!((sum.distance(point) - least).abs() < 1e-12, "the weights are those of the point");
        }
    }

    #[test]
    fn meshes_are_apart_by_what_only_one_of_them_has() {
        let (small, large) = (ball(1.0), ball(1.5));
        // Corners of the greater are 0.5 from corners of the lesser.
        assert!((distance_between(&small, &large) - 0.5).abs() < 1e-12);
        let mut half = small.clone();
        half.triangles.truncate(10);
        // Feet on triangles of size 1 are rounded.
        assert!(distance_between(&small, &small) < 1e-15);
        assert!(distance_between(&half, &small) > 0.3 && distance_between(&small, &half) > 0.3);
        assert_eq!(distance_between(&small, &Mesh::default()), f64::INFINITY);
    }
}

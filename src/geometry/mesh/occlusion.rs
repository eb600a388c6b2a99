//! How much of the sky over each vertex of a mesh is hidden.
//!
//! Promise: a share from 0 to 1 of the directions above the triangles around a vertex, weighted by their cosine, along which
//! something lies within a distance. Vertices of one place and one normal have one share, so that seams of texture coordinates
//! do not show. The same input gives the same bits. A convex body hides nothing of itself.
//!
//! Directions are a spiral of equal areas on the disk below the half ball, turned by the seed; they start beside the vertex,
//! within its triangles, so that what meets there in a corner hides as it should. Sources: S. Zhukov, A. Iones, G. Kronin, An
//! ambient light illumination model, 1998 (the share); H. Vogel, A better way to construct the sunflower head, 1979 (the
//! spiral); J. Malley, A shading method for computer generated images, 1988 (from disk to half ball).
//!
//! Cost: a search along a line in a tree of boxes for each vertex and sample.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::sight::Sight;
use super::{Mesh, index};
use crate::geometry::number::sin_cos;

/// How the sky is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Directions for each vertex.
    pub samples: u32,
    /// How far things hide, in the unit of the mesh; infinite for all of them.
    pub distance: f64,
    /// Turns the directions.
    pub seed: u32,
}

/// How far from a vertex, as weights of the other corners of its triangles, lines start.
const BESIDE: f64 = 0.02;

/// How far above its triangle a line starts, as part of the size of the mesh.
const ABOVE: f64 = 1e-6;

/// The turn from one direction to the next: the golden ratio of a whole turn.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// For each vertex the share of its sky that is hidden by the mesh itself.
#[must_use]
pub fn occlusion(mesh: &Mesh, sky: &Sky) -> Vec<f64> {
    let corner = |vertex: super::VertexIndex| mesh.vertices[vertex.subscript()].point.0;
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|corners| corners.map(corner)).collect();
    let sight = Sight::new(&mesh.points, &triangles);
    let (names, groups) = alike(mesh);
    let size = mesh.bounds().diagonal();
    let reach = sky.distance.min(2.0 * size);
    let share = |group: &Vec<(u32, usize)>| {
        let starts: Vec<(DVec3, DVec3)> = group.iter().filter_map(|at| start(mesh, *at, size)).collect();
        if starts.is_empty() {
            return 0.0;
        }
        let hidden = (0..sky.samples).filter(|sample| {
            let (from, normal) = starts[*sample as usize % starts.len()];
            !sight.is_free(from, from + direction(normal, *sample, sky) * reach)
        });
        f64::from(index(hidden.count())) / f64::from(sky.samples)
    };
    let shares: Vec<f64> = groups.par_iter().map(share).collect();
    names.into_iter().map(|name| shares[name]).collect()
}

/// Vertices of one place and normal as one: for each vertex its group, and for each group its corners: triangle and which.
fn alike(mesh: &Mesh) -> (Vec<usize>, Vec<Vec<(u32, usize)>>) {
    let mut known: BTreeMap<(u32, [u64; 3]), usize> = BTreeMap::new();
    let names: Vec<usize> = mesh
        .vertices
        .iter()
        .map(|vertex| {
            let next = known.len();
            let normal = (vertex.normal + 0.0).to_array().map(f64::to_bits);
            *known.entry((vertex.point.0, normal)).or_insert(next)
        })
        .collect();
    let mut groups = vec![Vec::new(); known.len()];
    for (number, corners) in (0..).zip(&mesh.triangles) {
        for (which, vertex) in corners.iter().enumerate() {
            groups[names[vertex.subscript()]].push((number, which));
        }
    }
    (names, groups)
}

/// Where lines start beside a corner of a triangle, and the triangle's normal; none without area.
fn start(mesh: &Mesh, (triangle, which): (u32, usize), size: f64) -> Option<(DVec3, DVec3)> {
    let corners = mesh.triangles[triangle as usize];
    let [a, b, c] =
        [0, 1, 2].map(|k| mesh.points[mesh.vertices[corners[(which + k) % 3].subscript()].point.subscript()]);
    let normal = (b - a).cross(c - a).try_normalize()?;
    Some((a + ((b - a) + (c - a)) * BESIDE + normal * (ABOVE * size), normal))
}

/// A direction of the half ball above a plane.
fn direction(normal: DVec3, sample: u32, sky: &Sky) -> DVec3 {
    let share = (f64::from(sample) + 0.5) / f64::from(sky.samples);
    let turn = (f64::from(sample) * GOLDEN + f64::from(sky.seed) * GOLDEN * GOLDEN).fract();
    let (sine, cosine) = sin_cos(TAU * turn);
    let (across, up) = normal.any_orthonormal_pair();
    let away = share.sqrt();
    across * (away * cosine) + up * (away * sine) + normal * (1.0 - share).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{Sky, occlusion};
    use crate::geometry::mesh::convert::{ConvertOptions, convert};
    use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};
    use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};

    const ALL: Sky = Sky { samples: 4096, distance: f64::INFINITY, seed: 0 };

    /// Rectangles by a corner and two sides, each with corners of its own.
    fn rectangles(all: &[[DVec3; 3]]) -> Mesh {
        let mut mesh = Mesh::default();
        for [corner, one, other] in all {
            let first = u32::try_from(mesh.points.len()).unwrap();
            for place in [*corner, *corner + *one, *corner + *one + *other, *corner + *other] {
                let point = PointIndex(u32::try_from(mesh.points.len()).unwrap());
                let normal = one.cross(*other).normalize();
                let (uv, color, anchor) = (DVec2::ZERO, Color::WHITE, Anchor::default());
                mesh.points.push(place);
                mesh.vertices.push(Vertex { point, normal, uv, color, anchor });
            }
            mesh.triangles.push([first, first + 1, first + 2].map(VertexIndex));
            mesh.triangles.push([first, first + 2, first + 3].map(VertexIndex));
        }
        mesh.runs.push(Run { origin: 0, end: u32::try_from(mesh.triangles.len()).unwrap() });
        mesh
    }

    /// A small square on the ground, so that lines start at one place as good as, and a wall beside it.
    fn beside_wall(away: f64, height: f64) -> Mesh {
        let square = [DVec3::new(away, 0.0, 0.0), DVec3::Z * 1e-4, DVec3::X * 1e-4];
        rectangles(&[square, [DVec3::new(0.0, 0.0, -1e3), DVec3::Y * height, DVec3::Z * 2e3]])
    }

    /// The share that an endless wall hides of a place on the ground before it: H. Hottel, Radiant heat transmission, 1954.
    #[test]
    fn a_wall_hides_what_its_closed_form_says_the_better_the_more_samples() {
        for (away, height) in [(1.0, 1.0), (1.0, 4.0), (2.0, 0.5), (0.01, 3.0)] {
            let exact = 0.5 * (1.0 - away / crate::geometry::number::hypot(away, height));
            let mesh = beside_wall(away, height);
            let mut worst = Vec::new();
            for samples in [64, 1024, 16_384] {
                let found = occlusion(&mesh, &Sky { samples, ..ALL })[0];
                worst.push((found - exact).abs());
                // A spiral errs about as its rim over its area: less than 1 / sqrt(samples).
                assert!(
                    (found - exact).abs() < 0.6 / f64::from(samples).sqrt(),
                    "{away} {height} {found} {exact}"
                );
            }
            assert!(worst[2] < 0.004, "{worst:?}");
        }
    }

    #[test]
    fn in_the_corner_of_two_planes_half_is_hidden() {
        let mesh = rectangles(&[
            [DVec3::new(0.0, 0.0, -0.5), DVec3::Z, DVec3::X],
            [DVec3::new(0.0, 0.0, -500.0), DVec3::Y * 500.0, DVec3::Z * 1e3],
        ]);
        assert!((occlusion(&mesh, &ALL)[0] - 0.5).abs() < 0.02);
    }

    #[test]
    fn convex_bodies_hide_nothing_and_hollows_all_within_the_distance() {
        let solid = platonic(Platonic::Icosahedron, PlatonicSize::Circumradius(2.0), Pose::Axes);
        let mut ball = convert(&solid, &ConvertOptions::default()).expect("a solid").mesh;
        assert!(occlusion(&ball, &ALL).iter().all(|share| *share == 0.0));
        ball.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        assert!(occlusion(&ball, &ALL).iter().all(|share| *share == 1.0));
        let near = occlusion(&ball, &Sky { distance: 0.01, ..ALL });
        assert!(near.iter().all(|share| *share < 0.5), "{near:?}");
        // Seeds turn the directions.
        let some = Sky { samples: 16, distance: 1.5, seed: 0 };
        assert_ne!(occlusion(&ball, &some), occlusion(&ball, &Sky { seed: 9, ..some }));
        assert_eq!(occlusion(&ball, &some), occlusion(&ball, &some));
    }
}

//! Weights by heat: each bone is warm, the skin near it is heated by it and carries heat along, and where it is as warm as
//! all bones together make it, the shares of the bones are the weights.
//!
//! With L the Laplacian of the surface and A the areas of its points, (L + A H) w = A H p for each bone. At each point
//! H = c k / d² for the k nearest bones, d away; p is 1 / k for these and 0 for others; where none of them is seen
//! through the body H is 0 and heat comes along the skin alone. A bone toward which the skin turns its outer side counts
//! as further away, up to a thousand times, so that bones outside carry what no other does.
//!
//! Promise: weights are from 0 to 1 and sum to 1; they are continuous along the skin, depend on its shape and little
//! on its triangles; points on one place have the same. All bones share one factorization. Not promised: weights where a
//! part of the skin sees none of its nearest bones; such parts are told.
//!
//! Source: I. Baran, J. Popović, Automatic rigging and animation of 3D characters, 2007, section 4.

use glam::DVec3;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use super::skeleton::Joint;
use super::skin::Weights;
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::laplacian::laplacian;
use crate::geometry::mesh::sight::Sight;
use crate::geometry::mesh::weld::{Welded, weld_near};
use crate::geometry::number::{Bounds, Factors, Plan, Symmetric, acos, dissection};

/// Why there are no weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatFault {
    /// Parts of the mesh that see no bone.
    Unseen {
        /// How many parts.
        parts: usize,
        /// Points of them together.
        count: usize,
        /// One of these.
        first: usize,
    },
    /// The system would take more bytes than allowed.
    Limit {
        /// How many.
        needed: u64,
    },
}

/// The heat c that a bone gives at a distance of 1. The paper's is 1, for Laplacians that are not brought to scale: with the
/// true one, as here, its authors' program amounts to 3 and Blender's automatic weights to 4.
const HEAT: f64 = 4.0;

/// No bone is nearer to a point than this, in sizes of the mesh: on a bone heat would be infinite.
const NEAREST: f64 = 1e-4;

/// Bones whose distances differ by less than this part are equally near: those that meet in a joint.
const EQUAL: f64 = 1e-4;

/// Points of the mesh that are nearer than this, in its sizes, are one: what single precision makes of seams.
const WELD: f64 = 1e-7;

/// The right sides that are solved at once.
const TOGETHER: usize = 8;

/// The weights of `joints` at the points of a mesh, for which no more than `most_bytes` are taken.
///
/// Cost: a sparse factorization of about O(n^1.5) for n points, a solution of O(n log n) for each joint, a line of sight for
/// each point.
///
/// # Errors
/// See [`HeatFault`].
pub fn heat_weights(mesh: &Mesh, joints: &[&Joint], most_bytes: u64) -> Result<Weights, HeatFault> {
    let size = Bounds::of_points(mesh.points.iter().copied()).diagonal();
    let welded = weld_near(&mesh.points, WELD * size);
    let triangles = triangles(mesh, &welded);
    let points = &welded.points;
    let heats = heats(points, &triangles, joints, NEAREST * size);
    unseen(points.len(), &triangles, &heats, &welded)?;
    let surface = laplacian(points, &triangles);
    // A point of no triangle has no area and keeps what heats it.
    let warmth: Vec<f64> = surface
        .areas
        .iter()
        .zip(&heats)
        .map(|(area, heat)| area.max(1e-12 * size * size) * heat.rate)
        .collect();
    let mut entries = surface.entries;
    entries.extend((0..).zip(&warmth).map(|(row, warmth)| (row, row, *warmth)));
    let matrix = Symmetric::new(points.len(), entries);
    let plan = Plan::new(&matrix, dissection(&matrix, points));
    let needed = plan.bytes() + (points.len() + mesh.points.len()) as u64 * joints.len() as u64 * 8;
    if needed > most_bytes {
        return Err(HeatFault::Limit { needed });
    }
    let Ok(factors) = plan.factor() else {
        // Heat so weak that rounding hides it: the same as none.
        let all = Seen { parts: 1, count: mesh.points.len(), first: 0 };
        return Err(all.fault());
    };
    Ok(spread(&factors, (&heats, &warmth), joints.len(), &welded))
}

/// The solutions of all bones, for each point of the mesh.
fn spread(factors: &Factors, (heats, warmth): (&[Heat], &[f64]), joints: usize, welded: &Welded) -> Weights {
    let groups: Vec<Vec<[f64; TOGETHER]>> = (0..joints.div_ceil(TOGETHER))
        .into_par_iter()
        .map(|group| {
            factors.solve(|point| {
                let mut right = [0.0; TOGETHER];
                let heat = &heats[point];
                for joint in heat.joints.iter().filter(|joint| *joint / TOGETHER == group) {
                    right[joint % TOGETHER] = warmth[point] / heat.joints.len() as f64;
                }
                right
            })
        })
        .collect();
    let mut kept = welded.map.iter();
    super::skin::weights_of(&vec![DVec3::ZERO; welded.map.len()], joints, |_, weights| {
        let Some(point) = kept.next() else { return };
        for (joint, weight) in weights.iter_mut().enumerate() {
            *weight = groups[joint / TOGETHER][*point as usize][joint % TOGETHER].clamp(0.0, 1.0);
        }
    })
}

/// What heats a point.
#[derive(Clone, Debug, Default)]
struct Heat {
    /// The bones, as indices among the joints that carry.
    joints: Vec<usize>,
    /// Heat for each metre squared; 0 where no bone is seen.
    rate: f64,
}

/// What heats each point.
fn heats(points: &[DVec3], triangles: &[[u32; 3]], joints: &[&Joint], nearest: f64) -> Vec<Heat> {
    let normals = normals(points, triangles);
    let sight = Sight::new(points, triangles);
    let heat = |point: usize| {
        let place = points[point];
        let distance = |joint: &&Joint| {
            let away = place - joint.nearest(place);
            let outward = away.normalize_or_zero().dot(normals[point]);
            away.length().max(nearest) * 2.0 / (1.002 + outward)
        };
        let distances: Vec<f64> = joints.iter().map(distance).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let near = |joint: &usize| distances[*joint] <= least * (1.0 + EQUAL);
        let seen = |joint: &usize| {
            u32::try_from(point).is_ok_and(|from| sight.sees(from, joints[*joint].nearest(place)))
        };
        let joints: Vec<usize> = (0..joints.len()).filter(near).filter(seen).collect();
        let rate = HEAT * joints.len() as f64 / (least * least);
        Heat { joints, rate }
    };
    (0..points.len()).into_par_iter().map(heat).collect()
}

/// Normals of points: those of their triangles by the angles there.
fn normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    for corners in triangles {
        let places = corners.map(|corner| points[corner as usize]);
        let normal = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
        for k in 0..3 {
            let to = |other: usize| (places[(k + other) % 3] - places[k]).normalize_or_zero();
            sums[corners[k] as usize] += normal * acos(to(1).dot(to(2)).clamp(-1.0, 1.0));
        }
    }
    sums.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// The triangles of a mesh between welded points, those that have three.
fn triangles(mesh: &Mesh, welded: &Welded) -> Vec<[u32; 3]> {
    let corner = |vertex: crate::geometry::mesh::VertexIndex| {
        welded.map[mesh.vertices[vertex.subscript()].point.subscript()]
    };
    let triangles = mesh.triangles.iter().map(|corners| corners.map(corner));
    triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Parts that see no bone.
struct Seen {
    parts: usize,
    count: usize,
    first: usize,
}

impl Seen {
    fn fault(&self) -> HeatFault {
        HeatFault::Unseen { parts: self.parts, count: self.count, first: self.first }
    }
}

/// Refuses a mesh of which parts that hang together see no bone.
fn unseen(points: usize, triangles: &[[u32; 3]], heats: &[Heat], welded: &Welded) -> Result<(), HeatFault> {
    // Each point leads to another of its part, the first of it to itself.
    let mut leads: Vec<usize> = (0..points).collect();
    fn first(leads: &mut [usize], mut point: usize) -> usize {
        while leads[point] != point {
            leads[point] = leads[leads[point]];
            point = leads[point];
        }
        point
    }
    for corners in triangles {
        for other in [corners[1], corners[2]] {
            let (a, b) = (first(&mut leads, corners[0] as usize), first(&mut leads, other as usize));
            leads[a.max(b)] = a.min(b);
        }
    }
    let mut warm = vec![false; points];
    for (point, heat) in heats.iter().enumerate() {
        let part = first(&mut leads, point);
        warm[part] |= heat.rate > 0.0;
    }
    let parts = (0..points).filter(|point| leads[*point] == *point && !warm[*point]).count();
    if parts == 0 {
        return Ok(());
    }
    let mut cold = (0..welded.map.len()).filter(|point| {
        let part = first(&mut leads, welded.map[*point] as usize);
        !warm[part]
    });
    let found = cold.next();
    Err(Seen { parts, count: cold.count() + usize::from(found.is_some()), first: found.unwrap_or(0) }.fault())
}

#[cfg(test)]
mod tests;

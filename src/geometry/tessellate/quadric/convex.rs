//! Convex polyhedra cut by planes, one after the other.
//!
//! Promise: closed after every cut. Whether a corner lies inside, on or outside of a plane is decided once for all faces
//! that meet in it, and a new corner is made once for each edge; so planes that meet in a corner, or lie in a face, leave
//! neither gaps nor dust.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::geometry::field::quadric::HalfSpace;
use crate::geometry::mesh;
use crate::geometry::number::Bounds;

/// A convex polyhedron.
#[derive(Clone, Debug)]
pub(super) struct Polyhedron {
    pub(super) points: Vec<DVec3>,
    pub(super) faces: Vec<Facet>,
}

/// A face: corners counterclockwise from outside.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    pub(super) corners: Vec<u32>,
    /// What plane it lies on.
    pub(super) source: u32,
}

/// Corners nearer to a plane than this share of the size lie on it: less than single precision tells apart.
const ON: f64 = 1e-9;

impl Polyhedron {
    /// A box. Its sides come from `source` on: x least, x greatest, y least ...
    pub(super) fn cuboid(bounds: &Bounds, source: u32) -> Self {
        let corner = |k: u32| {
            let pick = |bit: u32, low: f64, high: f64| if k & bit == 0 { low } else { high };
            DVec3::new(
                pick(1, bounds.min.x, bounds.max.x),
                pick(2, bounds.min.y, bounds.max.y),
                pick(4, bounds.min.z, bounds.max.z),
            )
        };
        let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let faces = sides.into_iter().zip(source..);
        Self {
            points: (0..8).map(corner).collect(),
            faces: faces.map(|(corners, source)| Facet { corners: corners.to_vec(), source }).collect(),
        }
    }

    /// Keeps what lies inside a half space; the new face gets `source`. Where all of it lies inside nothing changes.
    pub(super) fn cut(&mut self, half: &HalfSpace, size: f64, source: u32) {
        let depths: Vec<f64> = self.points.iter().map(|point| half.depth(*point)).collect();
        let side = |corner: u32| {
            let depth = depths[corner as usize];
            if depth.abs() <= ON * size { 0.0 } else { depth }
        };
        if !self.faces.iter().flat_map(|face| &face.corners).any(|corner| side(*corner) < 0.0) {
            return;
        }
        let mut made: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut faces = Vec::with_capacity(self.faces.len() + 1);
        for face in &self.faces {
            let mut kept = Vec::with_capacity(face.corners.len() + 1);
            for (k, corner) in face.corners.iter().enumerate() {
                let next = face.corners[(k + 1) % face.corners.len()];
                let (here, there) = (side(*corner), side(next));
                if here >= 0.0 {
                    kept.push(*corner);
                }
                if here * there < 0.0 {
                    let key = (*corner.min(&next), *corner.max(&next));
                    kept.push(*made.entry(key).or_insert_with(|| {
                        let (low, high) = (key.0 as usize, key.1 as usize);
                        let share = depths[low] / (depths[low] - depths[high]);
                        self.points.push(self.points[low].lerp(self.points[high], share));
                        mesh::index(self.points.len() - 1)
                    }));
                }
            }
            // A face that has no corner inside only touches the half space.
            let reaches = face.corners.iter().any(|corner| side(*corner) > 0.0);
            if reaches && kept.len() > 2 {
                faces.push(Facet { corners: kept, source: face.source });
            }
        }
        faces.extend(lids(&faces, source));
        self.faces = faces;
    }
}

/// The faces that close what others leave open: loops of their edges without a twin, run backward.
fn lids(faces: &[Facet], source: u32) -> Vec<Facet> {
    let edges = |face: &Facet| {
        let count = face.corners.len();
        (0..count).map(|k| (face.corners[k], face.corners[(k + 1) % count])).collect::<Vec<_>>()
    };
    let all: std::collections::BTreeSet<(u32, u32)> = faces.iter().flat_map(edges).collect();
    let mut open: BTreeMap<u32, u32> =
        all.iter().filter(|(from, to)| !all.contains(&(*to, *from))).map(|(from, to)| (*to, *from)).collect();
    let mut lids = Vec::new();
    while let Some((start, _)) = open.first_key_value() {
        let mut corners = Vec::new();
        let mut at = *start;
        while let Some(next) = open.remove(&at) {
            corners.push(at);
            at = next;
        }
        lids.push(Facet { corners, source });
    }
    lids
}

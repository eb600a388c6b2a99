//! A normal for each corner of a polygon mesh: hard edges by smoothing group or by angle.
//!
//! The corners around a point fall into fans, cut apart by hard edges; all corners of a fan share one normal, the
//! sum of their faces' normals weighted by the angle at the corner (G. Thürmer, C. Wüthrich, "Computing Vertex
//! Normals from Polygonal Facets", 1998), so that it does not depend on how a face is cut into triangles.

use glam::DVec3;

use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::number::{atan2, cos_degrees};

/// An edge whose faces turn by the crease angle itself stays smooth in spite of rounding.
const CREASE_ROUNDING: f64 = 1e-9;

/// When an edge between two faces is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Smooth {
    /// Never.
    Never,
    /// Always.
    Always,
    /// When the faces' normals differ by at most this many degrees.
    Within(f64),
    /// When both faces are in one smoothing group other than 0.
    Groups,
}

/// Unit normals, one for each corner. O(n log n) in corners.
///
/// Edges that are not shared by exactly two faces, one in each direction, are hard. A face without area takes part
/// in nothing and borrows the normal of a neighbour.
pub(super) fn corner_normals(mesh: &PolygonMesh, smooth: Smooth) -> Vec<DVec3> {
    let corners = Corners::new(mesh);
    let twins = corners.twins(mesh);
    let faces = FaceNormals::new(mesh, &corners, &twins);
    let mut fans = Fans::new(mesh.corners.len());
    for (corner, &twin) in twins.iter().enumerate() {
        if let Some(twin) = twin
            && corner < twin as usize
            && faces.is_smooth(mesh, smooth, [corners.face[corner], corners.face[twin as usize]])
        {
            fans.join(index(corner), corners.next[twin as usize]);
            fans.join(corners.next[corner], twin);
        }
    }
    sum_over_fans(mesh, &corners, &faces, &mut fans)
}

/// The corner that follows each corner in its loop, and the face of each.
struct Corners {
    next: Vec<u32>,
    before: Vec<u32>,
    face: Vec<u32>,
}

impl Corners {
    fn new(mesh: &PolygonMesh) -> Self {
        let count = mesh.corners.len();
        let mut corners = Self { next: vec![0; count], before: vec![0; count], face: vec![0; count] };
        for face in 0..mesh.faces.len() {
            for ring in mesh.loops_of(face) {
                let range = mesh.corners_of_loop(ring);
                for corner in range.clone() {
                    let next = if corner + 1 == range.end { range.start } else { corner + 1 };
                    corners.next[corner] = index(next);
                    corners.before[next] = index(corner);
                    corners.face[corner] = index(face);
                }
            }
        }
        corners
    }

    /// For each edge, named by the corner at its start, the one edge that runs back along it.
    fn twins(&self, mesh: &PolygonMesh) -> Vec<Option<u32>> {
        let mut keyed: Vec<(u32, u32, u32)> = (0..mesh.corners.len())
            .map(|corner| {
                let (a, b) = (mesh.corners[corner].0, mesh.corners[self.next[corner] as usize].0);
                (a.min(b), a.max(b), index(corner))
            })
            .collect();
        keyed.sort_unstable();
        let mut twins = vec![None; mesh.corners.len()];
        for uses in keyed.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            if let &[(low, high, a), (_, _, b)] = uses
                && low != high
                && mesh.corners[a as usize] != mesh.corners[b as usize]
            {
                twins[a as usize] = Some(b);
                twins[b as usize] = Some(a);
            }
        }
        twins
    }
}

/// Unit normals of faces; zero for a face without area, and then what it borrows.
struct FaceNormals {
    own: Vec<DVec3>,
    borrowed: Vec<DVec3>,
}

impl FaceNormals {
    fn new(mesh: &PolygonMesh, corners: &Corners, twins: &[Option<u32>]) -> Self {
        let own: Vec<DVec3> =
            (0..mesh.faces.len()).map(|face| mesh.newell(face).normalize_or_zero()).collect();
        let neighbour = |corner: usize| {
            let twin = twins[corner]? as usize;
            Some(own[corners.face[twin] as usize]).filter(|&normal| normal != DVec3::ZERO)
        };
        let borrow = |face: usize| mesh.corners_of(face).find_map(neighbour).unwrap_or(DVec3::Y);
        let borrowed = (0..own.len())
            .map(|face| if own[face] == DVec3::ZERO { borrow(face) } else { own[face] })
            .collect();
        Self { own, borrowed }
    }

    fn is_smooth(&self, mesh: &PolygonMesh, smooth: Smooth, [a, b]: [u32; 2]) -> bool {
        let [a, b] = [a as usize, b as usize];
        if self.own[a] == DVec3::ZERO || self.own[b] == DVec3::ZERO {
            return false;
        }
        match smooth {
            Smooth::Never => false,
            Smooth::Always => true,
            Smooth::Within(degrees) => {
                self.own[a].dot(self.own[b]) >= cos_degrees(degrees.clamp(0.0, 180.0)) - CREASE_ROUNDING
            }
            Smooth::Groups => {
                let group = mesh.faces[a].smoothing;
                let other = mesh.faces[b].smoothing;
                if mesh.smoothing_masks { group & other != 0 } else { group != 0 && group == other }
            }
        }
    }
}

/// Sets of corners that share a normal, each named by its least corner.
struct Fans(Vec<u32>);

impl Fans {
    fn new(count: usize) -> Self {
        Self((0..index(count)).collect())
    }

    fn find(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let above = self.0[self.0[corner as usize] as usize];
            self.0[corner as usize] = above;
            corner = above;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

fn sum_over_fans(mesh: &PolygonMesh, corners: &Corners, faces: &FaceNormals, fans: &mut Fans) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.corners.len()];
    for corner in 0..index(mesh.corners.len()) {
        let normal = faces.own[corners.face[corner as usize] as usize];
        if normal != DVec3::ZERO {
            sums[fans.find(corner) as usize] += normal * angle_at(mesh, corners, corner as usize, normal);
        }
    }
    (0..index(mesh.corners.len()))
        .map(|corner| {
            let own = faces.borrowed[corners.face[corner as usize] as usize];
            sums[fans.find(corner) as usize].try_normalize().unwrap_or(own)
        })
        .collect()
}

/// Angle inside the face at a corner, radians in [0, 2 pi); more than pi where the face is concave.
fn angle_at(mesh: &PolygonMesh, corners: &Corners, corner: usize, normal: DVec3) -> f64 {
    let here = mesh.position(corner);
    let ahead = mesh.position(corners.next[corner] as usize) - here;
    let behind = mesh.position(corners.before[corner] as usize) - here;
    let angle = atan2(ahead.cross(behind).dot(normal), ahead.dot(behind));
    if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
}

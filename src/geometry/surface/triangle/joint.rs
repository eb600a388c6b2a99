//! How Bezier triangles continue each other across their sides.
//!
//! Two triangles with a common side are pieces of one smooth map, over some two triangles of the plane, when one and the
//! same barycentric coordinates of the far corner of the second bring the rows of the first to those of the second: the row
//! next to the side by one step of de Casteljau for C1, the one after it by two for C2. Source: G. Farin, Triangular
//! Bernstein-Bezier patches, CAGD 3 (1986), section 4.

use super::net::TriangleNet;
use crate::geometry::curve::control::Control;
use crate::geometry::surface::{
    AnySurface, PatchContinuity, Rim, Surface as _, SurfaceJoint, SurfaceJoints, SurfaceLine, joints,
};

/// Control points as numbers.
pub trait Coordinates: Control {
    /// Its length times that of another times the cosine between them.
    fn dot(self, other: Self) -> f64;

    /// Its length.
    fn size(self) -> f64 {
        self.dot(self).sqrt()
    }
}

impl Coordinates for glam::DVec3 {
    fn dot(self, other: Self) -> f64 {
        Self::dot(self, other)
    }
}

impl Coordinates for glam::DVec4 {
    fn dot(self, other: Self) -> f64 {
        Self::dot(self, other)
    }
}

/// Derivatives that differ by less than this share are equal but for rounding.
const ROUNDING: f64 = 1e-7;

/// The corners of a side of a triangle, from its start to its end in the parameter of the rim; `None` for the rim that is
/// drawn together to corner 0.
#[must_use]
pub const fn side_of(rim: Rim) -> Option<[usize; 2]> {
    match rim {
        Rim::Bottom => None,
        Rim::Top => Some([1, 2]),
        Rim::Left => Some([0, 1]),
        Rim::Right => Some([0, 2]),
    }
}

/// The joints of triangles, which are surfaces in the form of [`TriangleNet::grid`]. C1 and C2 are Farin's, for homogeneous
/// control points where triangles are rational, which is enough but not needed.
///
/// Cost: as [`joints`], and O(degree^2) for each.
#[must_use]
pub fn triangle_joints<P: Coordinates>(nets: &[TriangleNet<P>], surfaces: &[AnySurface]) -> SurfaceJoints {
    let mut found = joints(surfaces);
    for joint in &mut found.joints {
        classify(nets, surfaces, joint);
    }
    found
}

fn classify<P: Coordinates>(nets: &[TriangleNet<P>], surfaces: &[AnySurface], joint: &mut SurfaceJoint) {
    let [(one, SurfaceLine::Rim(first)), (other, SurfaceLine::Rim(second))] = joint.lines else { return };
    let (Some(side), Some(partner)) = (side_of(first), side_of(second)) else { return };
    let at = |(surface, rim): (usize, Rim), share: f64| {
        let (x, y) = rim.place(share);
        surfaces[surface].evaluate(x, y).point
    };
    let (here, partner_rim) = (at((one, first), 0.0), (other, second));
    let backward = here.distance(at(partner_rim, 1.0)) < here.distance(at(partner_rim, 0.0));
    let partner = if backward { [partner[1], partner[0]] } else { partner };
    let facing = |net: &TriangleNet<P>, [from, to]: [usize; 2]| net.renamed([3 - from - to, from, to]);
    let (mut a, mut b) = (facing(&nets[one], side), facing(&nets[other], partner));
    while a.degree() < b.degree() {
        a = a.elevated();
    }
    while b.degree() < a.degree() {
        b = b.elevated();
    }
    let smoothness = &mut joint.smoothness;
    let planes = smoothness.continuity.min(PatchContinuity::G1);
    (smoothness.slope, smoothness.bend) = differences(&a, &b);
    smoothness.continuity = if !smoothness.same_parameters || smoothness.slope > ROUNDING {
        planes
    } else if smoothness.bend > ROUNDING {
        PatchContinuity::C1
    } else {
        PatchContinuity::C2
    };
}

/// By what shares the rows next to the common last row, and those after them, differ from what one map would make of them;
/// 1 or more where no map that goes on across the side comes near.
fn differences<P: Coordinates>(a: &TriangleNet<P>, b: &TriangleNet<P>) -> (f64, f64) {
    let n = a.degree();
    let Some(far) = fitted(a, b) else { return (1.0, 1.0) };
    let size = (0..n).map(|k| (b.get(n - 1, k) - b.get(n, k)).size()).fold(0.0, f64::max);
    let off = |row: usize, net: &TriangleNet<P>, scale: f64| {
        let away = (0..=row).map(|k| (net.get(row, k) - b.get(row, k)).size());
        if scale > 0.0 { away.fold(0.0, f64::max) / scale } else { 1.0 }
    };
    let once = a.step(far);
    let slope = off(n - 1, &once, size);
    // Linear patches have nothing more to differ in.
    let bend = if n > 1 { off(n - 2, &once.step(far), size) } else { slope };
    (slope, bend)
}

/// The barycentric coordinates of the far corner of the second triangle in the first that fit best; `None` where it would
/// lie on the same side, or where the side is one point.
fn fitted<P: Coordinates>(a: &TriangleNet<P>, b: &TriangleNet<P>) -> Option<[f64; 3]> {
    let n = a.degree();
    // b's row is a's moved by y towards the start and z towards the end of the side: two unknowns.
    let (mut yy, mut yz, mut zz, mut y_b, mut z_b) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for k in 0..n {
        let from = a.get(n - 1, k);
        let (y, z, to) = (a.get(n, k) - from, a.get(n, k + 1) - from, b.get(n - 1, k) - from);
        yy += y.dot(y);
        yz += y.dot(z);
        zz += z.dot(z);
        y_b += y.dot(to);
        z_b += z.dot(to);
    }
    let determinant = yy * zz - yz * yz;
    if determinant <= 1e-24 * yy * zz {
        return None;
    }
    let (y, z) = ((y_b * zz - z_b * yz) / determinant, (z_b * yy - y_b * yz) / determinant);
    let x = 1.0 - y - z;
    (x < 0.0).then_some([x, y, z])
}

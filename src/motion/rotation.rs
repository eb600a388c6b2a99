//! Rotations: Euler angles of every order, axis and angle, and the two ways players go between quaternions.
//!
//! Promise: bits are equal on every machine; both interpolations take the shorter way. Not promised: Euler
//! angles near the middle angle of 90 degrees are unique; one of them is then 0.
//!
//! Sources: K. Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985 (slerp); J. Diebel,
//! Representing attitude, 2006, section 8 (Euler angles of all orders).

use glam::{DMat3, DQuat, DVec3};

use crate::geometry::number::{acos, atan2, hypot, sin, sin_cos_degrees};

/// In which order the angles of a rotation about x, y and z are applied, each about an axis that stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EulerOrder {
    /// About x first, then y, then z.
    Xyz,
    /// About x first, then z, then y.
    Xzy,
    /// About y first, then x, then z.
    Yxz,
    /// About y first, then z, then x.
    Yzx,
    /// About z first, then x, then y.
    Zxy,
    /// About z first, then y, then x.
    Zyx,
}

/// A turn by degrees about an axis of unit length.
#[must_use]
pub fn about(axis: DVec3, degrees: f64) -> DQuat {
    let (sin, cos) = sin_cos_degrees(degrees / 2.0);
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

impl EulerOrder {
    /// The rotation of three angles in degrees, about x, y and z.
    #[must_use]
    pub fn rotation(self, degrees: DVec3) -> DQuat {
        let (x, y, z) = (about(DVec3::X, degrees.x), about(DVec3::Y, degrees.y), about(DVec3::Z, degrees.z));
        match self {
            Self::Xyz => z * y * x,
            Self::Xzy => y * z * x,
            Self::Yxz => z * x * y,
            Self::Yzx => x * z * y,
            Self::Zxy => y * x * z,
            Self::Zyx => x * y * z,
        }
    }
}

/// The rotation of a joint's angles, degrees about x, y and z of its rest frame: twist about y first, then the swing
/// about z, then the one about x.
#[must_use]
pub fn from_angles(angles: DVec3) -> DQuat {
    EulerOrder::Yzx.rotation(angles)
}

/// The angles of [`from_angles`], degrees: that about z lies between -90 and 90, the others between -180 and 180.
#[must_use]
pub fn to_angles(rotation: DQuat) -> DVec3 {
    let matrix = DMat3::from_quat(rotation);
    let (first, second, third) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let flat = hypot(first.x, third.x);
    let z = atan2(-second.x, flat);
    // Straight up or down only the sum of the other two is known.
    let (x, y) = if flat > 1e-9 {
        (atan2(second.z, second.y), atan2(third.x, first.x))
    } else {
        (atan2(-third.y, if z > 0.0 { first.y } else { -first.y }), 0.0)
    };
    DVec3::new(x, y, z).map(f64::to_degrees)
}

/// The other quaternion of the same rotation if that one is nearer.
pub(super) fn nearer(to: DQuat, from: DQuat) -> DQuat {
    if to.dot(from) < 0.0 { -to } else { to }
}

/// Between two rotations at constant speed along the shorter way, at a share from 0 to 1.
#[must_use]
pub fn slerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let to = nearer(to, from);
    let cos = from.dot(to);
    // Below a hundredth of a radian both ways agree to 1e-7 of the angle; nearer still the sine loses digits.
    if cos > 1.0 - 1e-9 {
        return normalized_lerp(from, to, share);
    }
    let angle = acos(cos.min(1.0));
    let whole = sin(angle);
    (from * (sin((1.0 - share) * angle) / whole) + to * (sin(share * angle) / whole)).normalize()
}

/// Between two rotations along a straight line that is brought back to unit length, the shorter way.
#[must_use]
pub fn normalized_lerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let to = nearer(to, from);
    (from * (1.0 - share) + to * share).normalize()
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::{EulerOrder, about, from_angles, normalized_lerp, slerp, to_angles};

    fn gap(a: DQuat, b: DQuat) -> f64 {
        (1.0 - a.dot(b).abs()).abs()
    }

    #[test]
    fn angles_come_back() {
        for x in [-170.0, -90.0, -12.5, 0.0, 33.0, 120.0] {
            for y in [-150.0, -1.0, 0.0, 60.0, 179.0] {
                for z in [-90.0, -89.0, -30.0, 0.0, 45.0, 90.0] {
                    let angles = DVec3::new(x, y, z);
                    let found = to_angles(from_angles(angles));
                    assert!(gap(from_angles(found), from_angles(angles)) < 1e-14, "{angles}: {found}");
                    if z.abs() < 90.0 {
                        assert!(found.distance(angles) < 1e-9, "{angles}: {found}");
                    }
                }
            }
        }
    }

    /// A vector turned by hand, one axis after the other.
    #[test]
    fn orders_are_what_they_say() {
        let quarter = DVec3::splat(90.0);
        let turned = EulerOrder::Xyz.rotation(quarter) * DVec3::Y;
        // y -> z by x, z -> x by y, x -> y by z.
        assert!(turned.distance(DVec3::Y) < 1e-12, "{turned}");
        let turned = EulerOrder::Zyx.rotation(quarter) * DVec3::Y;
        // y -> -x by z, -x -> z by y, z -> -y by x.
        assert!(turned.distance(DVec3::NEG_Y) < 1e-12, "{turned}");
    }

    #[test]
    fn both_ways_take_the_shorter_one_and_meet_in_the_middle() {
        let (from, to) = (about(DVec3::Z, 10.0), -about(DVec3::Z, 70.0));
        for way in [slerp, normalized_lerp] {
            assert!(gap(way(from, to, 0.5), about(DVec3::Z, 40.0)) < 1e-15);
            assert!(gap(way(from, to, 0.0), from) < 1e-15 && gap(way(from, to, 1.0), to) < 1e-15);
        }
        assert!(gap(slerp(from, to, 0.25), about(DVec3::Z, 25.0)) < 1e-15);
    }
}

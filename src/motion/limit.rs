//! How far joints turn: a range for each axis of the rest frame.
//!
//! A rotation is taken apart into a swing about x, then one about z, then a twist about y, which is the bone
//! (each about the axis as the turns before left it). Every rotation has two such triples; it is allowed when
//! one of them, with whole turns added, lies inside all three ranges.

use glam::{DQuat, DVec3};

use super::rotation::{from_angles, to_angles};

/// An axis of a joint's rest frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Across the bone.
    X,
    /// Along the bone.
    Y,
    /// Across the bone and x.
    Z,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its letter.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'x',
            Self::Y => 'y',
            Self::Z => 'z',
        }
    }

    /// Its direction.
    #[must_use]
    pub const fn direction(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

/// From `least` to `most`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub most: f64,
}

impl Range {
    /// Nothing but zero.
    pub const NONE: Self = Self { least: 0.0, most: 0.0 };

    /// How far a value lies outside, zero inside.
    #[must_use]
    pub fn excess(&self, value: f64) -> f64 {
        (self.least - value).max(value - self.most).max(0.0)
    }
}

/// Ranges of angles in degrees about x, y and z; an axis without one turns freely.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// About x, y and z.
    pub ranges: [Option<Range>; 3],
}

/// An angle outside of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// About which axis.
    pub axis: Axis,
    /// The angle, degrees.
    pub angle: f64,
    /// The end of the range that it passes, degrees.
    pub limit: f64,
}

/// Degrees that rounding may put beyond a limit.
const ROUNDING: f64 = 1e-6;

impl Limits {
    /// Whether any axis has a range.
    #[must_use]
    pub fn any(&self) -> bool {
        self.ranges.iter().any(Option::is_some)
    }

    /// Whether a rotation lies inside; else the angle that is furthest outside, of the triple that is nearest to being
    /// allowed.
    ///
    /// # Errors
    /// The axis, the angle and the limit.
    pub fn hold(&self, rotation: DQuat) -> Result<(), Excess> {
        if !self.any() {
            return Ok(());
        }
        let angles = self.nearest(rotation);
        let beyond = |axis: &Axis| {
            let (angle, range) = (angles[*axis as usize], self.ranges[*axis as usize]?);
            let limit = if angle > range.most { range.most } else { range.least };
            Some(Excess { axis: *axis, angle, limit }).filter(|_| range.excess(angle) > ROUNDING)
        };
        let worst = Axis::ALL.iter().filter_map(beyond);
        let worst = worst.max_by(|a, b| (a.angle - a.limit).abs().total_cmp(&(b.angle - b.limit).abs()));
        worst.map_or(Ok(()), Err)
    }

    /// The rotation with each angle brought into its range.
    #[must_use]
    pub fn clamp(&self, rotation: DQuat) -> DQuat {
        if self.hold(rotation).is_ok() {
            return rotation;
        }
        from_angles(self.clamped(self.nearest(rotation)))
    }

    /// Angles brought into their ranges.
    #[must_use]
    pub fn clamped(&self, angles: DVec3) -> DVec3 {
        let inside = |axis: usize| {
            self.ranges[axis].map_or(angles[axis], |range| angles[axis].clamp(range.least, range.most))
        };
        DVec3::new(inside(0), inside(1), inside(2))
    }

    /// The angles of a rotation about x, y and z, degrees: of the two triples, whole turns added, the one with the least excess.
    #[must_use]
    pub fn nearest(&self, rotation: DQuat) -> DVec3 {
        let first = self.turned(to_angles(rotation));
        let second = self.turned(DVec3::new(first.x + 180.0, first.y + 180.0, 180.0 - first.z));
        if self.excess(second) < self.excess(first) { second } else { first }
    }

    /// Whole turns added so that each angle comes as near to its range as it can.
    fn turned(&self, angles: DVec3) -> DVec3 {
        let near = |axis: usize| {
            let middle = self.ranges[axis].map_or(0.0, |range| (range.least + range.most) / 2.0);
            angles[axis] - 360.0 * ((angles[axis] - middle) / 360.0).round()
        };
        DVec3::new(near(0), near(1), near(2))
    }

    /// How far angles lie outside, in sum.
    #[must_use]
    pub fn excess(&self, angles: DVec3) -> f64 {
        let of = |axis: usize| self.ranges[axis].map_or(0.0, |range| range.excess(angles[axis]));
        of(0) + of(1) + of(2)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Axis, Excess, Limits, Range};
    use crate::motion::rotation::{about, from_angles};

    fn range(least: f64, most: f64) -> Option<Range> {
        Some(Range { least, most })
    }

    #[test]
    fn a_hinge_turns_as_far_as_it_may_about_any_axis() {
        for axis in Axis::ALL {
            let mut ranges = [Some(Range::NONE); 3];
            ranges[axis as usize] = range(-10.0, 170.0);
            let limits = Limits { ranges };
            for angle in [-10.0, 0.0, 89.0, 90.0, 91.0, 120.0, 170.0] {
                assert_eq!(limits.hold(about(axis.direction(), angle)), Ok(()), "{axis:?} {angle}");
            }
            let Excess { axis: found, angle, limit } =
                limits.hold(about(axis.direction(), -25.0)).expect_err("beyond");
            assert!(found == axis && (angle + 25.0).abs() < 1e-9 && limit == -10.0, "{found:?} {angle}");
            let clamped = limits.clamp(about(axis.direction(), 190.0));
            assert!(clamped.dot(about(axis.direction(), 170.0)).abs() > 1.0 - 1e-14, "{axis:?}");
        }
    }

    #[test]
    fn clamping_keeps_what_is_allowed_and_ends_inside() {
        let limits = Limits { ranges: [range(-30.0, 60.0), range(0.0, 5.0), None] };
        for x in [-80.0, 0.0, 50.0, 75.0] {
            for y in [-20.0, 2.0, 90.0] {
                for z in [-60.0, 10.0] {
                    let rotation = from_angles(DVec3::new(x, y, z));
                    let clamped = limits.clamp(rotation);
                    assert_eq!(limits.hold(clamped), Ok(()), "{x} {y} {z}");
                    let allowed = (-30.0..=60.0).contains(&x) && (0.0..=5.0).contains(&y);
                    assert_eq!(clamped == rotation, allowed, "{x} {y} {z}");
                }
            }
        }
    }
}

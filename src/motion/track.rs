//! What a law moves: a translation, a rotation or a scale, on top of the rest, or the weight of a morph target.

use glam::{DMat3, DQuat, DVec3, DVec4};

use super::law::{Interpolation, Keys, Law};
use super::limit::{Axis, Limits};
use super::rotation::{EulerOrder, about, nearer, slerp, to_angles};
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::surface::{Carry, FrameField};

/// Which part of a place is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Path {
    /// The translation.
    Translation,
    /// The rotation.
    Rotation,
    /// The scale.
    Scale,
    /// The weight of a morph target.
    Weight,
}

/// How a part changes, relative to rest: translations are added in the parent's axes for nodes and in the rest frame
/// for joints, rotations are applied before the rest's, scales are multiplied.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Translation by three numbers.
    Offset(Law),
    /// Translation along an axis.
    Slide {
        /// Direction of unit length.
        axis: DVec3,
        /// How far.
        law: Law,
    },
    /// Translation along a curve by length.
    Along {
        /// The curve.
        path: AnyCurve,
        /// Share of its length from 0 to 1; more goes round on a closed curve.
        law: Law,
    },
    /// Rotation with the frames of a curve: z looks along it, y is up.
    Facing {
        /// The curve.
        path: AnyCurve,
        /// How the frames are carried along.
        carry: Carry,
        /// Share of its length.
        law: Law,
    },
    /// Rotation about an axis by degrees, any number of turns.
    Turn {
        /// Direction of unit length.
        axis: DVec3,
        /// Degrees.
        law: Law,
    },
    /// Rotation by three angles in degrees.
    Euler {
        /// Their order.
        order: EulerOrder,
        /// The angles about x, y and z.
        law: Law,
    },
    /// Rotations at keys, the shorter way between them.
    Rotations(Keys),
    /// Factors for x, y and z.
    Size(Law),
    /// One factor.
    Growth(Law),
    /// A weight, in place of the one at rest.
    Weight(Law),
    /// A weight by the angle of a joint.
    Driven {
        /// The rotation of the joint.
        of: Box<Self>,
        /// Limits into which it is brought.
        limits: Option<Limits>,
        /// Which angle gives which weight.
        ramp: Ramp,
    },
}

/// A weight by an angle: 0 up to one, 1 from another on, evenly between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Which angle of the rotation, as limits take it apart.
    pub axis: Axis,
    /// Degrees at which the weight is 0.
    pub from: f64,
    /// Degrees at which it is 1.
    pub to: f64,
}

impl Ramp {
    /// The angle of a rotation of a joint, degrees.
    #[must_use]
    pub fn angle(&self, rotation: DQuat) -> f64 {
        to_angles(rotation)[self.axis as usize]
    }

    /// The weight at a rotation of a joint.
    #[must_use]
    pub fn weight(&self, rotation: DQuat) -> f64 {
        let angle = self.angle(rotation);
        ((angle - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }
}

/// A course and what it moves it on.
#[derive(Clone, Debug)]
pub struct Track<'a> {
    course: &'a Course,
    frames: Option<FrameField>,
}

impl Course {
    /// Rotations with slopes for cubics, each quaternion the one of its pair that is nearer to the key before.
    #[must_use]
    pub fn rotations(
        times: Vec<f64>,
        rotations: &[DQuat],
        interpolation: Interpolation,
        looped: bool,
    ) -> Self {
        let mut values: Vec<DVec4> = Vec::with_capacity(rotations.len());
        for rotation in rotations {
            let before = values.last().map_or(*rotation, |before| DQuat::from_vec4(*before));
            values.push(DVec4::from(nearer(*rotation, before)));
        }
        Self::Rotations(Keys::new((times, values), &[], interpolation, looped))
    }

    /// Which part it moves.
    #[must_use]
    pub fn path(&self) -> Path {
        match self {
            Self::Offset(_) | Self::Slide { .. } | Self::Along { .. } => Path::Translation,
            Self::Facing { .. } | Self::Turn { .. } | Self::Euler { .. } | Self::Rotations(_) => {
                Path::Rotation
            }
            Self::Size(_) | Self::Growth(_) => Path::Scale,
            Self::Weight(_) | Self::Driven { .. } => Path::Weight,
        }
    }

    fn law(&self) -> Option<&Law> {
        match self {
            Self::Offset(law) | Self::Size(law) | Self::Growth(law) | Self::Weight(law) => Some(law),
            Self::Slide { law, .. }
            | Self::Along { law, .. }
            | Self::Facing { law, .. }
            | Self::Turn { law, .. }
            | Self::Euler { law, .. } => Some(law),
            Self::Rotations(_) | Self::Driven { .. } => None,
        }
    }

    /// Times at which it may bend sharply, seconds.
    #[must_use]
    pub fn stops(&self) -> Vec<f64> {
        match self {
            Self::Rotations(keys) => keys.times.clone(),
            Self::Driven { of, .. } => of.stops(),
            _ => self.law().map(Law::stops).unwrap_or_default(),
        }
    }

    /// The times of the keys of a weight that runs straight from key to key; none for everything else.
    #[must_use]
    pub fn corners(&self) -> Option<Vec<f64>> {
        match self {
            Self::Weight(Law::Keys(keys)) if keys.interpolation == Interpolation::Linear => {
                Some(keys.times.clone())
            }
            _ => None,
        }
    }

    /// Whether it jumps from key to key.
    #[must_use]
    pub fn stepped(&self) -> bool {
        match self {
            Self::Rotations(keys) => keys.interpolation == Interpolation::Step,
            Self::Driven { of, .. } => of.stepped(),
            _ => self.law().is_some_and(Law::stepped),
        }
    }
}

impl<'a> Track<'a> {
    /// Makes ready to evaluate. Cost: for paths one walk along them.
    #[must_use]
    pub fn new(course: &'a Course) -> Self {
        let frames = match course {
            Course::Along { path, .. } => Some(FrameField::new(path, &Carry::PLAIN, 0.0)),
            Course::Facing { path, carry, .. } => Some(FrameField::new(path, carry, 0.0)),
            _ => None,
        };
        Self { course, frames }
    }

    /// The translation, scale (x, y, z) or rotation (x, y, z, w) at a time, relative to rest; or the weight (x).
    #[must_use]
    pub fn at(&self, time: f64) -> DVec4 {
        match self.course {
            Course::Offset(law) | Course::Size(law) | Course::Weight(law) => law.at(time),
            Course::Growth(law) => DVec3::splat(law.at(time).x).extend(0.0),
            Course::Slide { axis, law } => (*axis * law.at(time).x).extend(0.0),
            Course::Turn { axis, law } => DVec4::from(about(*axis, law.at(time).x)),
            Course::Euler { order, law } => DVec4::from(order.rotation(law.at(time).truncate())),
            Course::Rotations(keys) => rotated(keys, time),
            Course::Driven { of, limits, ramp } => {
                let turned = DQuat::from_vec4(Track::new(of).at(time)).normalize();
                let turned = limits.as_ref().map_or(turned, |limits| limits.clamp(turned));
                DVec4::X * ramp.weight(turned)
            }
            Course::Along { path, law } => {
                path.evaluate(self.parameter(path, law.at(time).x), Side::After).point.extend(0.0)
            }
            Course::Facing { path, law, .. } => {
                let Some(frames) = &self.frames else { return DVec4::W };
                let frame = frames.at(self.parameter(path, law.at(time).x), Side::After);
                DVec4::from(
                    DQuat::from_mat3(&DMat3::from_cols(frame.side, frame.up, frame.along)).normalize(),
                )
            }
        }
    }

    /// Where a share of the length lies.
    fn parameter(&self, path: &AnyCurve, share: f64) -> f64 {
        let share = if path.is_closed() && !(0.0..=1.0).contains(&share) {
            share - share.floor()
        } else {
            share.clamp(0.0, 1.0)
        };
        self.frames.as_ref().map_or(0.0, |frames| frames.parameter(share))
    }
}

fn rotated(keys: &Keys, time: f64) -> DVec4 {
    let (key, share, _) = keys.locate(time);
    if keys.interpolation != Interpolation::Linear || share <= 0.0 {
        return keys.at(time).normalize();
    }
    let quaternion = |key: usize| DQuat::from_vec4(keys.values[key]);
    DVec4::from(slerp(quaternion(key), quaternion(key + 1), share))
}

//! Motion: skeletons with limits, poses, skins, laws of motion in time, and clips reduced to few keys.
//!
//! Promise: a [`Skeleton`] has one root, parents before children, at most [`MOST_JOINTS`] joints and no bone
//! without length; the frame of each joint has y along its bone. Weights of a [`Weights`] sum to exactly 255
//! for each point. [`reduce()`] keeps so few keys that no point moves further than a tolerance from the exact
//! motion, whether a player interpolates rotations on the sphere or by normalized straight lines, at dense
//! sample times and halfway between them. Not promised: the least number of keys there is; a bound between
//! the samples.
//!
//! Lengths are metres, y is up, angles are degrees where they are written and radians nowhere in interfaces.

mod heat;
mod inverse;
mod law;
mod limit;
mod morphed;
mod property;
mod reduce;
mod rig;
mod rotation;
mod skeleton;
mod skin;
mod track;
mod transform;

pub use heat::{HeatFault, heat_weights};
pub use inverse::{Angles, Goal, InverseKinematics, Reached, Search, Stand};
pub use law::{Interpolation, Keys, Law, LawFault, Speed};
pub use limit::{Axis, Excess, Limits, Range};
pub use morphed::{MorphedBox, MorphedState};
pub use property::{Property, PropertyKeys};
pub use reduce::{Moving, Player, Reduced, ReducedTrack, Wanted, reduce};
pub use rig::Rig;
pub use rotation::{EulerOrder, about, from_angles, normalized_lerp, slerp, to_angles};
pub use skeleton::{Bone, Joint, MOST_JOINTS, Skeleton, SkeletonFault};
pub use skin::{Envelope, Influence, Influences, Weights, envelope_weights, rigid_weights, weights_of};
pub use track::{Course, Path, Ramp, Track};
pub use transform::Transform;

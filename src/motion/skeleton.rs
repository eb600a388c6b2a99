//! Joints in a tree, each with a bone and a rest frame.
//!
//! The rest frame of a joint stands at the head of its bone: y points to the tail, and x and z are where the
//! least rotation from the upright brings them, turned about the bone by the roll. So the z of a bone in the
//! x-y plane is the scene's z, and the x of one in the y-z plane is the scene's x.

use glam::{DAffine3, DQuat, DVec3};

use super::limit::{Limits, Range};
use super::rotation::about;
use super::transform::Transform;

/// The most joints of a skeleton: indices of joints are written as bytes.
pub const MOST_JOINTS: usize = 256;

/// A joint as it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// Name of the joint.
    pub name: String,
    /// Index of its parent.
    pub parent: Option<usize>,
    /// Where it turns.
    pub head: DVec3,
    /// Where its bone ends.
    pub tail: DVec3,
    /// Turn of the rest frame about the bone, degrees.
    pub roll: f64,
    /// How far it turns.
    pub limits: Limits,
    /// How far it slides along its axes, metres; none does not slide.
    pub slide: [Option<Range>; 3],
    /// How unwilling it is to turn where several joints could: 0 to less than 1.
    pub stiffness: f64,
}

/// A joint of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// What it was made from; its parent is the index in the skeleton.
    pub bone: Bone,
    /// Its place at rest relative to its parent.
    pub rest: Transform,
    /// Its frame at rest in the skeleton's space.
    pub frame: DQuat,
}

impl Joint {
    /// The map from the rest frame to the skeleton's space.
    #[must_use]
    pub fn bind(&self) -> DAffine3 {
        DAffine3::from_rotation_translation(self.frame, self.bone.head)
    }

    /// The point of the bone that is nearest to another.
    #[must_use]
    pub fn nearest(&self, point: DVec3) -> DVec3 {
        let along = self.bone.tail - self.bone.head;
        let share = ((point - self.bone.head).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        self.bone.head + along * share
    }

    /// Distance from a point to the bone.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        point.distance(self.nearest(point))
    }

    /// Length of the bone.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.bone.head.distance(self.bone.tail)
    }
}

/// Joints, parents before children, the first the root.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// The joints.
    pub joints: Vec<Joint>,
}

/// Why joints make no skeleton. Indices are those of the given bones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SkeletonFault {
    /// No bone at all.
    Empty,
    /// Joints that are each other's ancestors, from one to its parent and on.
    Cycle(Vec<usize>),
    /// Two joints without a parent.
    Roots(usize, usize),
    /// A bone without length.
    NoLength(usize),
    /// More joints than [`MOST_JOINTS`].
    TooMany(usize),
}

impl Skeleton {
    /// Puts joints in order: as given, but parents first. Every parent must be an index of `bones`.
    ///
    /// # Errors
    /// See [`SkeletonFault`].
    pub fn new(bones: Vec<Bone>) -> Result<Self, SkeletonFault> {
        if bones.len() > MOST_JOINTS {
            return Err(SkeletonFault::TooMany(bones.len()));
        }
        let order = order(&bones)?;
        let size = bones.iter().fold(0.0_f64, |size, bone| {
            size.max(bone.head.abs().max_element()).max(bone.tail.abs().max_element())
        });
        let short = |bone: &Bone| bone.head.distance(bone.tail) <= 1e-9 * size;
        if let Some(bone) = bones.iter().position(short) {
            return Err(SkeletonFault::NoLength(bone));
        }
        let mut places = vec![0; bones.len()];
        order.iter().enumerate().for_each(|(place, bone)| places[*bone] = place);
        let mut joints: Vec<Joint> = Vec::with_capacity(bones.len());
        for bone in order {
            let mut bone = bones[bone].clone();
            bone.parent = bone.parent.map(|parent| places[parent]);
            let frame = rest_frame(bone.tail - bone.head, bone.roll);
            let rest = match bone.parent.map(|parent| &joints[parent]) {
                None => Transform { translation: bone.head, rotation: frame, scale: DVec3::ONE },
                Some(parent) => Transform {
                    translation: parent.frame.conjugate() * (bone.head - parent.bone.head),
                    rotation: (parent.frame.conjugate() * frame).normalize(),
                    scale: DVec3::ONE,
                },
            };
            joints.push(Joint { bone, rest, frame });
        }
        Ok(Self { joints })
    }

    /// The joint of a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.bone.name == name)
    }
}

/// The given order with parents before children. Linear in time.
fn order(bones: &[Bone]) -> Result<Vec<usize>, SkeletonFault> {
    let mut roots = (0..bones.len()).filter(|bone| bones[*bone].parent.is_none());
    let first = roots.next();
    if let (Some(first), Some(second)) = (first, roots.next()) {
        return Err(SkeletonFault::Roots(first, second));
    }
    let mut placed = vec![false; bones.len()];
    let mut order = Vec::with_capacity(bones.len());
    for start in 0..bones.len() {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(bone) = next.filter(|bone| !placed[*bone]) {
            if let Some(met) = chain.iter().position(|known| *known == bone) {
                return Err(SkeletonFault::Cycle(chain.split_off(met)));
            }
            chain.push(bone);
            next = bones[bone].parent;
        }
        for bone in chain.into_iter().rev() {
            placed[bone] = true;
            order.push(bone);
        }
    }
    if order.is_empty() { Err(SkeletonFault::Empty) } else { Ok(order) }
}

/// The frame whose y points along a bone.
fn rest_frame(along: DVec3, roll: f64) -> DQuat {
    let along = along.normalize();
    // Half of the angle lies between y and the bone; straight down every half turn is as short, and x is kept.
    let half = DVec3::Y + along;
    let swing = if half.length_squared() > 1e-12 {
        let half = half.normalize();
        let axis = DVec3::Y.cross(half);
        DQuat::from_xyzw(axis.x, axis.y, axis.z, DVec3::Y.dot(half)).normalize()
    } else {
        about(DVec3::X, 180.0)
    };
    (swing * about(DVec3::Y, roll)).normalize()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Bone, Limits, Skeleton, SkeletonFault};

    fn bone(name: &str, parent: Option<usize>, head: [f64; 3], tail: [f64; 3]) -> Bone {
        Bone {
            name: name.to_owned(),
            parent,
            head: DVec3::from_array(head),
            tail: DVec3::from_array(tail),
            roll: 0.0,
            limits: Limits::default(),
            slide: [None; 3],
            stiffness: 0.0,
        }
    }

    #[test]
    fn rest_frames_have_y_along_the_bone_and_compose_to_the_heads() {
        let bones = vec![
            bone("hand", Some(2), [1.0, 2.0, 0.0], [1.0, 1.0, 0.0]),
            bone("root", None, [0.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
            bone("arm", Some(1), [0.0, 2.0, 0.0], [1.0, 2.0, 0.0]),
        ];
        let skeleton = Skeleton::new(bones).expect("a skeleton");
        let names: Vec<&str> = skeleton.joints.iter().map(|joint| joint.bone.name.as_str()).collect();
        assert_eq!(names, ["root", "arm", "hand"]);
        let mut world = glam::DAffine3::IDENTITY;
        for joint in &skeleton.joints {
            world *= joint.rest.map();
            assert!(world.translation.distance(joint.bone.head) < 1e-12);
            let tail = world.transform_point3(DVec3::Y * joint.length());
            assert!(tail.distance(joint.bone.tail) < 1e-12, "{tail}");
            // Bones in the x-y plane keep z.
            assert!((joint.frame * DVec3::Z).distance(DVec3::Z * (joint.frame * DVec3::Z).z) < 1e-12);
        }
    }

    #[test]
    fn what_is_no_skeleton_is_named() {
        let (a, b) = ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let cycle = vec![bone("a", Some(1), a, b), bone("b", Some(0), a, b)];
        assert_eq!(Skeleton::new(cycle), Err(SkeletonFault::Cycle(vec![0, 1])));
        let apart = vec![bone("r", None, a, b), bone("a", Some(2), a, b), bone("b", Some(1), a, b)];
        assert_eq!(Skeleton::new(apart), Err(SkeletonFault::Cycle(vec![1, 2])));
        let two = vec![bone("a", None, a, b), bone("b", None, a, b)];
        assert_eq!(Skeleton::new(two), Err(SkeletonFault::Roots(0, 1)));
        assert_eq!(Skeleton::new(vec![bone("a", None, b, b)]), Err(SkeletonFault::NoLength(0)));
        assert_eq!(Skeleton::new(Vec::new()), Err(SkeletonFault::Empty));
        let many = vec![bone("a", None, a, b); 257];
        assert_eq!(Skeleton::new(many), Err(SkeletonFault::TooMany(257)));
    }
}

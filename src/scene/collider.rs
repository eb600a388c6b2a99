//! Bodies for physics, as a file holds them.

use glam::{DQuat, DVec3};

use crate::geometry::mesh::index;
use crate::geometry::number::sin_cos_degrees;

/// A body that physics takes for what a node shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// Its name.
    pub name: String,
    /// Name of the shape that it stands for.
    pub shape: String,
    /// The node that it moves with, an index into [`Scene::nodes`](super::Scene::nodes).
    pub node: usize,
    /// The node of its own, where its form asks for one.
    pub holder: Option<usize>,
    /// The body about its middle; round ones along y.
    pub body: Body,
    /// Where its middle is in the node, metres.
    pub translation: DVec3,
    /// How it is turned there.
    pub rotation: DQuat,
    /// Whether it is the shape itself and no body around it.
    pub exact: bool,
    /// What it is a part of, if it stands for a part of its shape alone.
    pub part: Option<ColliderPart>,
}

/// What a body is a part of.
#[derive(Clone, Debug, PartialEq)]
pub struct ColliderPart {
    /// Name of the whole, which no body has.
    pub of: String,
    /// How far from convex that is what it stands for, metres.
    pub concavity: f64,
    /// How far that was to be, metres.
    pub allowed: f64,
}

/// A body about the origin, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A box.
    Box {
        /// Lengths of its edges.
        size: DVec3,
    },
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A cylinder between two half balls.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Height of the cylinder.
        height: f64,
    },
    /// A cylinder.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its height.
        height: f64,
    },
    /// A convex body of triangles.
    Hull {
        /// Its corners.
        points: Vec<DVec3>,
        /// Counter-clockwise, seen from outside.
        triangles: Vec<[u32; 3]>,
    },
}

/// How colliders stand in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColliderForm {
    /// As numbers in the extras of nodes.
    #[default]
    Extras,
    /// By extensions.
    Omi,
    /// As meshes of hulls with names that Godot knows.
    Godot,
    /// As meshes with names that Unreal knows.
    Unreal,
}

impl Body {
    /// Its kind in a word.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Capsule { .. } => "capsule",
            Self::Cylinder { .. } => "cylinder",
            Self::Hull { .. } => "hull",
        }
    }

    /// Its volume, cubic metres.
    #[must_use]
    pub fn volume(&self) -> f64 {
        const PI: f64 = std::f64::consts::PI;
        match self {
            Self::Box { size } => size.element_product(),
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius * radius * radius,
            Self::Capsule { radius, height } => PI * radius * radius * (height + 4.0 / 3.0 * radius),
            Self::Cylinder { radius, height } => PI * radius * radius * height,
            Self::Hull { points, triangles } => {
                let place = |corner: u32| points[corner as usize];
                let cone = |[a, b, c]: &[u32; 3]| place(*a).dot(place(*b).cross(place(*c))) / 6.0;
                triangles.iter().map(cone).sum()
            }
        }
    }

    /// Whether every number is finite and nothing is without extent.
    pub(super) fn is_sound(&self) -> bool {
        let length = |number: f64| number > 0.0 && number <= f64::from(f32::MAX);
        match self {
            Self::Box { size } => size.to_array().into_iter().all(length),
            Self::Sphere { radius } => length(*radius),
            Self::Capsule { radius, height } => length(*radius) && (*height == 0.0 || length(*height)),
            Self::Cylinder { radius, height } => length(*radius) && length(*height),
            Self::Hull { points, triangles } => {
                points.iter().all(|point| point.abs().max_element() <= f64::from(f32::MAX))
                    && triangles.len() >= 4
                    && triangles.iter().flatten().all(|corner| (*corner as usize) < points.len())
            }
        }
    }
}

/// Steps around a round body.
const AROUND: u32 = 24;

impl Body {
    /// The body as triangles: round ones with corners on them.
    #[must_use]
    pub fn triangles(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let arc = |radius: f64, y: f64, from: u32| {
            (0..=AROUND / 4).map(move |step| {
                let (sine, cosine) =
                    sin_cos_degrees(f64::from(from + step) * 360.0 / f64::from(AROUND) - 90.0);
                (radius * cosine, y + radius * sine)
            })
        };
        match self {
            Self::Hull { points, triangles } => (points.clone(), triangles.clone()),
            Self::Box { size } => {
                let side = |bit: u32, k: u32| if k & bit == 0 { -0.5 } else { 0.5 };
                let points = (0..8).map(|k| *size * DVec3::new(side(1, k), side(2, k), side(4, k))).collect();
                let faces =
                    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
                (points, faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
            }
            Self::Sphere { radius } => {
                lathe(arc(*radius, 0.0, 0).chain(arc(*radius, 0.0, AROUND / 4).skip(1)).collect())
            }
            Self::Capsule { radius, height } => {
                let half = height / 2.0;
                lathe(arc(*radius, -half, 0).chain(arc(*radius, half, AROUND / 4)).collect())
            }
            Self::Cylinder { radius, height } => {
                let half = height / 2.0;
                lathe(vec![(0.0, -half), (*radius, -half), (*radius, half), (0.0, half)])
            }
        }
    }
}

/// A profile of radii and heights from pole to pole, upward, turned about the y axis.
fn lathe(profile: Vec<(f64, f64)>) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let inner = &profile[1..profile.len() - 1];
    let (south, north) = (profile[0].1, profile[profile.len() - 1].1);
    let mut points = vec![DVec3::Y * south];
    for (radius, y) in inner {
        points.extend((0..AROUND).map(|step| {
            let (sine, cosine) = sin_cos_degrees(f64::from(step) * 360.0 / f64::from(AROUND));
            DVec3::new(radius * cosine, *y, -radius * sine)
        }));
    }
    points.push(DVec3::Y * north);
    let last = index(points.len() - 1);
    let at = |ring: u32, step: u32| 1 + ring * AROUND + step % AROUND;
    let rings = index(inner.len());
    let mut triangles = Vec::new();
    for step in 0..AROUND {
        triangles.push([0, at(0, step + 1), at(0, step)]);
        for ring in 0..rings - 1 {
            let [a, b, c, d] =
                [at(ring, step), at(ring, step + 1), at(ring + 1, step + 1), at(ring + 1, step)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([last, at(rings - 1, step), at(rings - 1, step + 1)]);
    }
    (points, triangles)
}

//! Skins and motions, as a file holds them.

use glam::{DAffine3, DVec3};

use crate::motion::{Path, Property};

/// Joints that carry meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Its name.
    pub name: String,
    /// Indices of nodes.
    pub joints: Vec<usize>,
    /// For each joint the map from the mesh's space to its own at rest.
    pub inverse_bind: Vec<DAffine3>,
    /// Index of the node that carries all joints.
    pub root: usize,
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// Its name.
    pub name: String,
    /// What moves, no part of a node twice.
    pub channels: Vec<Channel>,
    /// What changes of materials, lights and cameras, nothing twice. There is at least one of these or of those.
    pub properties: Vec<PropertyChannel>,
    /// Whether it is played again and again.
    pub looped: bool,
    /// What happens: seconds and names.
    pub events: Vec<(f64, String)>,
    /// The box of all vertices over the whole motion, metres; none where nothing is shown.
    pub reach: Option<(DVec3, DVec3)>,
    /// No vertex is further from the exact motion at any sample, metres.
    pub bound: f64,
    /// What was asked for, metres.
    pub tolerance: f64,
    /// Samples of the exact motion.
    pub samples: usize,
}

/// One part of a node in motion, or all weights of its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The node.
    pub node: usize,
    /// Which part of it.
    pub path: Path,
    /// Whether values stay until the next key; else they run straight, rotations on the sphere.
    pub stepped: bool,
    /// Seconds, increasing.
    pub times: Vec<f64>,
    /// For each time as many numbers: translations and scales x, y and z, rotations x, y, z and w, weights one for each
    /// morph target of the node's mesh.
    pub values: Vec<f64>,
}

/// A property that changes.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyChannel {
    /// Of what.
    pub owner: Owner,
    /// Which.
    pub property: Property,
    /// Whether values stay until the next key; else they run straight.
    pub stepped: bool,
    /// Seconds, increasing.
    pub times: Vec<f64>,
    /// For each time as many numbers as the property has; degrees, metres, candela, linear colors.
    pub values: Vec<f64>,
    /// No value is further from the exact one at any sample, in the unit of the tolerance.
    pub bound: f64,
    /// What was asked for: of colors as a screen shows them, else in the property's unit.
    pub tolerance: f64,
}

/// Whose properties change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// A material, by its index in [`Scene::materials`](super::Scene::materials).
    Material(usize),
    /// The light or camera of a node.
    Node(usize),
}

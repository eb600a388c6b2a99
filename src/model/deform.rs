//! Deformations as recipes: what is not written follows from the shape.

use glam::DVec3;

use crate::geometry::curve::AnyCurve;
use crate::geometry::surface::{AxialKind, Carry};

/// A map that bends space.
#[derive(Clone, Debug, PartialEq)]
pub enum Bending {
    /// Taper, twist or bend.
    Axial(AxialBending),
    /// Along a curve.
    Along(PathBending),
}

/// A map that acts along a straight axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxialBending {
    /// A point on the axis.
    pub around: DVec3,
    /// Unit direction of the axis.
    pub axis: DVec3,
    /// Unit direction across it: toward which a bend goes.
    pub side: DVec3,
    /// Where it begins, as a coordinate along the axis; none is the start of the shape.
    pub from: Option<f64>,
    /// Where it ends; none is the end of the shape.
    pub to: Option<f64>,
    /// What it does.
    pub kind: AxialKind,
}

/// A map that lays an axis on a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct PathBending {
    /// The curve, without corners.
    pub path: AnyCurve,
    /// A point on the axis.
    pub around: DVec3,
    /// Unit direction of the axis.
    pub axis: DVec3,
    /// Unit direction that comes to the side of the curve.
    pub side: DVec3,
    /// How it is carried.
    pub carry: Carry,
    /// Coordinate along the axis that comes to the start of the curve; none is the start of the shape.
    pub from: Option<f64>,
    /// Whether the shape is stretched to the length of the curve.
    pub stretch: bool,
}

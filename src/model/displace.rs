//! Shapes moved along their normals, as recipes.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::ShapeHandle;
use crate::geometry::formula::Formula;
use crate::geometry::map::{Closes, GridField};
use crate::geometry::number::{Bounds, atan2, hypot, sin_degrees};

/// A shape and the heights that it is moved by.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacement {
    /// The shape.
    pub of: ShapeHandle,
    /// The heights, in the document's unit.
    pub heights: Heights,
}

/// Heights over places and texture coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Heights {
    /// A map that lies on the shape.
    Map {
        /// It closes as its projection does.
        field: Arc<GridField>,
        /// How it lies.
        projection: Projection,
    },
    /// A formula of x, y and z; its values 0 and 1 are these heights.
    Formula {
        /// The formula.
        formula: Box<Formula>,
        /// The heights.
        range: DVec2,
    },
}

/// How a map lies on a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// By texture coordinates.
    Texture,
    /// Along an axis: 0 is x.
    Along(usize),
    /// By angle and latitude.
    Spherical,
    /// By angle and height.
    Cylindrical,
}

impl Projection {
    /// How a map under it closes.
    #[must_use]
    pub fn closes(self) -> Closes {
        match self {
            Self::Texture | Self::Along(_) => Closes::default(),
            Self::Spherical => Closes { columns: true, rows: false, first: true, last: true },
            Self::Cylindrical => Closes { columns: true, ..Closes::default() },
        }
    }

    /// Parts of the map's rectangle for a place on a shape within bounds.
    fn parts(self, bounds: &Bounds, place: DVec3, uv: DVec2) -> DVec2 {
        let size = (bounds.max - bounds.min).max(DVec3::splat(f64::MIN_POSITIVE));
        let low = (place - bounds.min) / size;
        let around = |way: DVec3| 0.5 + atan2(way.x, way.z) / core::f64::consts::TAU;
        match self {
            Self::Texture => {
                let again = |part: f64| if (0.0..=1.0).contains(&part) { part } else { part - part.floor() };
                DVec2::new(again(uv.x), again(uv.y))
            }
            Self::Along(0) => DVec2::new(1.0 - low.z, 1.0 - low.y),
            Self::Along(1) => DVec2::new(low.x, low.z),
            Self::Along(_) => DVec2::new(low.x, 1.0 - low.y),
            Self::Spherical => {
                let way = place - bounds.center();
                let rise = atan2(way.y, hypot(way.x, way.z));
                DVec2::new(around(way), 0.5 - rise / core::f64::consts::PI)
            }
            Self::Cylindrical => DVec2::new(around(place - bounds.center()), 1.0 - low.y),
        }
    }
}

impl Heights {
    /// The height at a place of a shape within bounds; no finite number where a formula has no value.
    #[must_use]
    pub fn at(&self, bounds: &Bounds, place: DVec3, uv: DVec2) -> f64 {
        match self {
            Self::Map { field, projection } => {
                let [right, bottom] = field.extent();
                let part = projection.parts(bounds, place, uv);
                field.value(part.x * right, part.y * bottom)
            }
            Self::Formula { formula, range } => {
                let [value] = formula.evaluate::<f64, 1>(&place.to_array());
                range.x + (range.y - range.x) * value
            }
        }
    }

    /// Steps of the map between two places; 0 where that is not known.
    #[must_use]
    pub fn detail(&self, bounds: &Bounds, places: [DVec3; 2], uvs: [DVec2; 2]) -> f64 {
        match self {
            Self::Map { field, projection } => {
                let [right, bottom] = field.extent();
                // Texture coordinates are not taken back into the map first: a side may hold it many times.
                let [from, to] = match projection {
                    Projection::Texture => uvs,
                    other => [0, 1].map(|k| other.parts(bounds, places[k], uvs[k])),
                };
                let mut way = (to - from).abs();
                if projection.closes().columns {
                    way.x = way.x.min(1.0 - way.x);
                }
                // Columns come together at poles.
                let narrow = match projection {
                    Projection::Spherical => {
                        let wide = |part: DVec2| sin_degrees(180.0 * part.y);
                        wide(from).max(wide(to))
                    }
                    _ => 1.0,
                };
                (way.x * right * narrow).max(way.y * bottom)
            }
            Self::Formula { .. } => 0.0,
        }
    }

    /// The greatest size of the heights over places.
    #[must_use]
    pub fn most(&self, bounds: &Bounds, places: &[DVec3]) -> f64 {
        match self {
            Self::Map { field, .. } => {
                let (low, high) = field.range();
                low.abs().max(high.abs())
            }
            Self::Formula { .. } => places
                .iter()
                .map(|place| self.at(bounds, *place, DVec2::ZERO).abs())
                .filter(|height| height.is_finite())
                .fold(0.0, f64::max),
        }
    }
}

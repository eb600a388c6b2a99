//! Colors of vertices, as recipes.

use glam::{DAffine3, DVec3};

use crate::geometry::formula::Formula;
use crate::geometry::mesh::Color;
use crate::geometry::number::floor_index;

/// What colors the vertices of a shape have.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexColor {
    /// Their law.
    pub law: ColorLaw,
    /// From the space of the recipe to that of the shape before its placement, in which the law speaks.
    pub space: DAffine3,
}

/// Colors over places and normals.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorLaw {
    /// One for all.
    Even([f64; 4]),
    /// Linear red, green, blue and alpha as formulas of x, y, z and of the normal's nx, ny, nz.
    Parts(Box<Formula>),
    /// Colors evenly from 0 to 1, and where between them.
    Between {
        /// The colors, linear, two or more.
        colors: Vec<[f64; 4]>,
        /// A formula of the same variables.
        by: Box<Formula>,
    },
}

impl VertexColor {
    /// The color at a place of the recipe with a unit normal, or zero where there is none; `None` where a formula has no value.
    #[must_use]
    pub fn at(&self, place: DVec3, normal: DVec3) -> Option<Color> {
        if let ColorLaw::Even(color) = self.law {
            return Some(Color::held(color));
        }
        let turned = self.space.matrix3.inverse().transpose() * normal;
        let (place, normal) = (self.space.transform_point3(place), turned.normalize_or_zero());
        let variables = [place.x, place.y, place.z, normal.x, normal.y, normal.z];
        let parts = match &self.law {
            ColorLaw::Even(color) => *color,
            ColorLaw::Parts(formula) => formula.evaluate::<f64, 4>(&variables),
            ColorLaw::Between { colors, by } => {
                let [part] = by.evaluate::<f64, 1>(&variables);
                if part.is_nan() {
                    return None;
                }
                let steps = colors.len() - 1;
                let along = part.clamp(0.0, 1.0) * steps as f64;
                let first = floor_index(along).min(steps - 1);
                let rest = along - first as f64;
                let (one, other) = (colors[first], colors[first + 1]);
                [0, 1, 2, 3].map(|k| one[k] + (other[k] - one[k]) * rest)
            }
        };
        parts.iter().all(|part| !part.is_nan()).then(|| Color::held(parts))
    }
}

//! Which places a light reaches.
//!
//! Source: L. Williams, Casting Curved Shadows on Curved Surfaces, SIGGRAPH 1978; W. Reeves, D. Salesin, R. Cook, Rendering
//! Antialiased Shadows with Depth Maps, SIGGRAPH 1987 (several places are asked, and the mean is taken).

use glam::{DMat3, DVec2, DVec3};

use super::raster::{Face, MIDDLE, draw};
use super::stage::Stage;
use crate::geometry::number::{count_of, floor_index, single};

/// Depths as a light sees them.
pub(super) struct Shadow {
    /// Axes of the light: right, up, towards it.
    axes: DMat3,
    /// The place of the upper left pixel, in these axes.
    corner: DVec3,
    /// Pixels for one meter.
    scale: f64,
    depths: Vec<f32>,
}

/// Pixels across and down.
const SIZE: usize = 1536;

/// Pixels around a place that are asked, on each side.
const REACH: i32 = 2;

/// Pixels by which a place is moved out of its surface, so that a surface casts no shadow on itself.
const LIFT: f64 = 2.5;

impl Shadow {
    /// What a light sees of a stage; `opacity` by the name of a triangle and shares of its corners.
    pub(super) fn new(
        stage: &Stage,
        towards: DVec3,
        opacity: &(impl Fn(u32, [f64; 3]) -> f32 + Sync),
    ) -> Self {
        let right = DVec3::Y.cross(towards).normalize_or(DVec3::X);
        let axes = DMat3::from_cols(right, towards.cross(right), towards);
        let (low, high) = (stage.bounds.min, stage.bounds.max);
        let corners = (0..8).map(|k| {
            let pick = |bit: usize, axis: usize| if k >> bit & 1 == 0 { low[axis] } else { high[axis] };
            axes.transpose() * DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        });
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        corners.for_each(|corner| (least, most) = (least.min(corner), most.max(corner)));
        let margin = f64::from(REACH) + LIFT + 1.0;
        let extent = (most - least).truncate().max_element();
        let scale =
            if extent > 0.0 && extent.is_finite() { (SIZE as f64 - 2.0 * margin) / extent } else { 1.0 };
        let corner = DVec3::new(least.x, most.y, 0.0) + DVec3::new(-margin, margin, 0.0) / scale;
        let mut shadow = Self { axes, corner, scale, depths: Vec::new() };
        let faces: Vec<Face> = stage
            .triangles
            .iter()
            .enumerate()
            .map(|(name, corners)| Face {
                corners: corners.map(|corner| shadow.place(stage.vertices[corner as usize].point)),
                name: count_of(name),
            })
            .collect();
        let by_place = |name: u32, place: DVec2| {
            let [a, b, c] = faces[name as usize].corners.map(|corner| corner.truncate());
            let twice = (b - a).perp_dot(c - a);
            let part = |one: DVec2, other: DVec2| (one - place).perp_dot(other - place) / twice;
            opacity(name, [part(b, c), part(c, a), part(a, b)].map(|share| share.clamp(0.0, 1.0)))
        };
        let tiles = draw(&faces, (SIZE, SIZE), MIDDLE, &by_place, |tile| {
            let depths: Vec<f32> = tile.seen.iter().map(|seen| seen.depth).collect();
            (tile.left, tile.top, tile.width, depths)
        });
        shadow.depths = super::gathered(tiles, (SIZE, SIZE), f32::INFINITY);
        shadow
    }

    fn place(&self, point: DVec3) -> DVec3 {
        let own = self.axes.transpose() * point - self.corner;
        DVec3::new(own.x * self.scale, -own.y * self.scale, -own.z)
    }

    /// The share of the light that arrives at a point of a surface with a normal on the side that is looked at.
    pub(super) fn at(&self, point: DVec3, normal: DVec3) -> f32 {
        let towards = self.axes.z_axis;
        let facing = normal.dot(towards);
        if facing <= 0.0 {
            return 0.0;
        }
        let lifted = point + normal * (LIFT / self.scale);
        let place = self.place(lifted);
        // Over the pixels that are asked, a slanted surface rises.
        let slack = f64::from(REACH) * 0.5 / self.scale;
        let mut open = 0_u8;
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                let pixel = |value: f64, step: i32| floor_index(value + f64::from(step)).min(SIZE - 1);
                let depth = self.depths[pixel(place.y, dy) * SIZE + pixel(place.x, dx)];
                open += u8::from(place.z - slack <= f64::from(depth));
            }
        }
        let side = f32::from(u8::try_from(2 * REACH + 1).unwrap_or(1));
        let share = f32::from(open) / (side * side);
        // Towards the edge of night the light fades out by itself, without steps of the map.
        share * single((facing * 8.0).min(1.0))
    }
}

//! Maps of a rectangle onto ellipsoids and cylinders.
//!
//! Angles of whole turns and right angles are exact, so the first and last column of a chart all around are one line to
//! the last bit, and poles are points.

use glam::{DVec2, DVec3};

use crate::geometry::map::Closes;
use crate::geometry::number::sin_cos_degrees;

/// How a rectangle comes onto a quadric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chart {
    /// By angle and latitude, degrees; rows go from the first latitude down to the second. Of an ellipsoid the
    /// latitude is that of the sphere that is stretched to it.
    Spherical {
        /// Angles of the first and last column.
        longitude: [f64; 2],
        /// Latitudes of the first and last row.
        latitude: [f64; 2],
    },
    /// By angle and height along the axis.
    Cylindrical {
        /// Angles of the first and last column.
        longitude: [f64; 2],
        /// y of the first and last row.
        rise: [f64; 2],
    },
    /// Straight along -z onto the front: a rectangle of this size about the z axis.
    Parallel {
        /// Lengths along x and y.
        size: DVec2,
    },
}

/// A point of a quadric and its derivatives.
pub(super) struct Spot {
    pub(super) point: DVec3,
    pub(super) ds: DVec3,
    pub(super) dt: DVec3,
}

/// From the first to the second; both are met exactly.
pub(super) fn between([from, to]: [f64; 2], part: f64) -> f64 {
    from * (1.0 - part) + to * part
}

/// An angle of a column. All around, the last is the first.
fn angle(longitude: [f64; 2], s: f64) -> f64 {
    if s >= 1.0 && is_whole(longitude) { longitude[0] } else { between(longitude, s) }
}

fn is_whole([from, to]: [f64; 2]) -> bool {
    to - from == 360.0
}

impl Chart {
    pub(super) fn closes(&self) -> Closes {
        match self {
            Self::Spherical { longitude, latitude } => Closes {
                columns: is_whole(*longitude),
                rows: false,
                first: latitude[0] == 90.0,
                last: latitude[1] == -90.0,
            },
            Self::Cylindrical { longitude, .. } => {
                Closes { columns: is_whole(*longitude), ..Closes::default() }
            }
            Self::Parallel { .. } => Closes::default(),
        }
    }

    pub(super) fn on_ellipsoid(&self, radii: DVec3, s: f64, t: f64) -> Spot {
        match *self {
            Self::Spherical { longitude, latitude } => {
                let (sin, cos) = sin_cos_degrees(angle(longitude, s));
                let (rise, wide) = sin_cos_degrees(between(latitude, t));
                let by_s = (longitude[1] - longitude[0]).to_radians();
                let by_t = (latitude[1] - latitude[0]).to_radians();
                Spot {
                    point: radii * DVec3::new(wide * sin, rise, wide * cos),
                    ds: radii * DVec3::new(wide * cos, 0.0, -wide * sin) * by_s,
                    dt: radii * DVec3::new(-rise * sin, wide, -rise * cos) * by_t,
                }
            }
            Self::Cylindrical { longitude, rise } => {
                let (sin, cos) = sin_cos_degrees(angle(longitude, s));
                let y = between(rise, t);
                let part = y / radii.y;
                let wide = (1.0 - part * part).sqrt();
                let by_s = (longitude[1] - longitude[0]).to_radians();
                let by_t = rise[1] - rise[0];
                let narrower = -part / (radii.y * wide);
                Spot {
                    point: DVec3::new(radii.x * wide * sin, y, radii.z * wide * cos),
                    ds: DVec3::new(radii.x * wide * cos, 0.0, -radii.z * wide * sin) * by_s,
                    dt: DVec3::new(radii.x * narrower * sin, 1.0, radii.z * narrower * cos) * by_t,
                }
            }
            Self::Parallel { size } => {
                let at = DVec2::new(s - 0.5, 0.5 - t) * size;
                let part = at / DVec2::new(radii.x, radii.y);
                let deep = (1.0 - part.length_squared()).sqrt();
                let slope = -part / (DVec2::new(radii.x, radii.y) * deep) * radii.z;
                Spot {
                    point: at.extend(radii.z * deep),
                    ds: DVec3::new(1.0, 0.0, slope.x) * size.x,
                    dt: DVec3::new(0.0, -1.0, -slope.y) * size.y,
                }
            }
        }
    }

    pub(super) fn on_cylinder(&self, radius: f64, s: f64, t: f64) -> Spot {
        match *self {
            Self::Spherical { .. } => Spot { point: DVec3::Z * radius, ds: DVec3::X, dt: DVec3::NEG_Y },
            Self::Cylindrical { longitude, rise } => {
                let (sin, cos) = sin_cos_degrees(angle(longitude, s));
                let by_s = (longitude[1] - longitude[0]).to_radians();
                Spot {
                    point: DVec3::new(radius * sin, between(rise, t), radius * cos),
                    ds: DVec3::new(cos, 0.0, -sin) * (radius * by_s),
                    dt: DVec3::Y * (rise[1] - rise[0]),
                }
            }
            Self::Parallel { size } => {
                let at = DVec2::new(s - 0.5, 0.5 - t) * size;
                let deep = (radius * radius - at.x * at.x).sqrt();
                Spot {
                    point: at.extend(deep),
                    ds: DVec3::new(1.0, 0.0, -at.x / deep) * size.x,
                    dt: DVec3::NEG_Y * size.y,
                }
            }
        }
    }
}

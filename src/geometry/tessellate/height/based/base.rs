//! What heights stand on instead of a plane: ellipsoids, cylinders and surfaces by parameters, each under a map that brings
//! the rectangle of a field onto it.
//!
//! Places are parts of the rectangle, from 0 to 1: s along the columns, t along the rows. Seen from outside columns go to
//! the right and rows down. Angles turn about +y, 0 is +z, and +x is 90 degrees. Lengths are metres.
//!
//! Source of normals and their derivatives on quadrics: the gradient of the equation, M. do Carmo, "Differential Geometry
//! of Curves and Surfaces", 1976, section 3.3.

use glam::DVec3;

use super::chart::{Chart, Spot};
use super::surface::SurfaceBase;
use crate::geometry::map::Closes;

/// A base with its map.
#[derive(Clone, Debug, PartialEq)]
pub enum Base {
    /// An ellipsoid about the origin, a sphere when its radii are equal.
    Ellipsoid {
        /// Half axes along x, y and z.
        radii: DVec3,
        /// How the field lies on it.
        chart: Chart,
    },
    /// A cylinder around the y axis.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// How the field lies on it; rows of a turned chart are heights along y.
        chart: Chart,
    },
    /// A surface by its parameters.
    Surface(Box<SurfaceBase>),
}

/// Point, normal and their derivatives by the parts s and t.
#[derive(Clone, Copy, Debug)]
pub(super) struct BaseJet {
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
    pub(super) ds: DVec3,
    pub(super) dt: DVec3,
    pub(super) normal_ds: DVec3,
    pub(super) normal_dt: DVec3,
}

impl Base {
    /// How a field on it closes.
    #[must_use]
    pub fn closes(&self) -> Closes {
        match self {
            Self::Surface(base) => base.closes,
            Self::Ellipsoid { chart, .. } | Self::Cylinder { chart, .. } => chart.closes(),
        }
    }

    /// The greatest depth to which normals can be followed inward without meeting each other; infinite where it is not
    /// known and must be found in another way.
    pub(super) fn reach(&self) -> Option<f64> {
        match self {
            Self::Ellipsoid { radii, .. } => {
                Some(radii.min_element() * radii.min_element() / radii.max_element())
            }
            Self::Cylinder { radius, .. } => Some(*radius),
            Self::Surface(_) => None,
        }
    }

    /// Whether columns and rows run the other way around the normal than those of a plane.
    pub(super) fn is_turned(&self) -> bool {
        matches!(self, Self::Surface(base) if base.turned)
    }

    /// Point and normal at a place.
    pub(super) fn stand(&self, s: f64, t: f64) -> (DVec3, DVec3) {
        match self {
            Self::Ellipsoid { radii, chart } => {
                let point = chart.on_ellipsoid(*radii, s, t).point;
                (point, (point / (*radii * *radii)).normalize())
            }
            Self::Cylinder { radius, chart } => {
                let point = chart.on_cylinder(*radius, s, t).point;
                (point, DVec3::new(point.x / radius, 0.0, point.z / radius).normalize())
            }
            Self::Surface(base) => {
                let jet = base.at(s, t);
                (jet.point, jet.normal)
            }
        }
    }

    /// Everything at a place.
    pub(super) fn jet(&self, s: f64, t: f64) -> BaseJet {
        match self {
            Self::Ellipsoid { radii, chart } => {
                let squares = *radii * *radii;
                of_gradient(&chart.on_ellipsoid(*radii, s, t), &|point| point / squares)
            }
            Self::Cylinder { radius, chart } => {
                of_gradient(&chart.on_cylinder(*radius, s, t), &|point| point.with_y(0.0))
            }
            Self::Surface(base) => base.jet(s, t),
        }
    }

    /// Bounds on the second derivatives by s and by t of the point and on the first and second of the normal, in that
    /// order; none where no bound is known.
    pub(super) fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        match self {
            Self::Ellipsoid { radii, chart: Chart::Spherical { longitude, latitude } } => {
                let (most, least) = (radii.max_element(), radii.min_element());
                let ratio = most / least;
                // n = w / |w| with |w| at least 1 / most and derivatives of w at most 1 / least in size.
                let across = ratio + 2.0 * ratio * ratio;
                let along = ratio * ratio;
                let second = if ratio == 1.0 { 1.0 } else { (across * across + along * along).sqrt() };
                let of = |[from, to]: [f64; 2]| {
                    let angle = (to - from).abs().to_radians();
                    [most * angle * angle, ratio * angle, second * angle * angle]
                };
                Some([of(*longitude), of(*latitude)])
            }
            Self::Cylinder { radius, chart: Chart::Cylindrical { longitude, .. } } => {
                let angle = (longitude[1] - longitude[0]).abs().to_radians();
                Some([[radius * angle * angle, angle, angle * angle], [0.0; 3]])
            }
            _ => None,
        }
    }
}

/// The jet of a quadric by the gradient of its equation, a linear map.
fn of_gradient(spot: &Spot, gradient: &dyn Fn(DVec3) -> DVec3) -> BaseJet {
    let across = gradient(spot.point);
    let length = across.length();
    let normal = across / length;
    let change = |way: DVec3| {
        let change = gradient(way);
        (change - normal * change.dot(normal)) / length
    };
    BaseJet {
        point: spot.point,
        normal,
        ds: spot.ds,
        dt: spot.dt,
        normal_ds: change(spot.ds),
        normal_dt: change(spot.dt),
    }
}

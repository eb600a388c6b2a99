//! What heights stand on instead of a plane: ellipsoids, cylinders and surfaces by parameters, each under a map that brings
//! the rectangle of a field onto it.
//!
//! Places are parts of the rectangle, from 0 to 1: s along the columns, t along the rows. Seen from outside columns go to
//! the right and rows down. Angles turn about +y, 0 is +z, and +x is 90 degrees. Lengths are metres.
//!
//! Source of normals and their derivatives on quadrics: the gradient of the equation, M. do Carmo, "Differential Geometry
//! of Curves and Surfaces", 1976, section 3.3.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use crate::geometry::curve::{Curve as _, Domain};
use crate::geometry::map::Closes;
use crate::geometry::number::sin_cos_degrees;
use crate::geometry::surface::{AnySurface, ExtrudedSurface, RevolvedSurface, Surface, SurfaceJet};

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

/// A surface of one piece.
#[derive(Clone, Debug, PartialEq)]
pub enum BaseSurface {
    /// One of patches, formulas, lofts and the like.
    Any(AnySurface),
    /// A turned profile.
    Turned(RevolvedSurface),
    /// The wall of an extrusion.
    Pushed(ExtrudedSurface),
}

macro_rules! each_kind {
    ($self:expr, $surface:ident => $body:expr) => {
        match $self {
            BaseSurface::Any($surface) => $body,
            BaseSurface::Turned($surface) => $body,
            BaseSurface::Pushed($surface) => $body,
        }
    };
}

/// A part of a surface under a map of space.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceBase {
    surface: BaseSurface,
    place: DAffine3,
    u: [f64; 2],
    v: [f64; 2],
    closes: Closes,
    /// 1, or -1 where its normals are turned over to look outward.
    side: f64,
    /// Whether columns and rows run the other way around its normal than those of a plane.
    turned: bool,
}

/// Why a surface is no base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseFault {
    /// Its normal jumps at this u, or at this v.
    Edge {
        /// Whether it is a line of constant u.
        along_v: bool,
        /// The parameter.
        at: f64,
    },
    /// It closes with a twist: it has no outside.
    Twisted,
    /// It has no area somewhere that is no pole.
    Flat {
        /// A place of its parameters.
        place: [f64; 2],
    },
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

/// A point of a quadric and its derivatives.
struct Spot {
    point: DVec3,
    ds: DVec3,
    dt: DVec3,
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
            Self::Ellipsoid { radii, .. } => Some(radii.min_element().powi(2) / radii.max_element()),
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

/// From the first to the second; both are met exactly.
fn between([from, to]: [f64; 2], part: f64) -> f64 {
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
    fn closes(&self) -> Closes {
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

    fn on_ellipsoid(&self, radii: DVec3, s: f64, t: f64) -> Spot {
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

    fn on_cylinder(&self, radius: f64, s: f64, t: f64) -> Spot {
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

impl BaseSurface {
    fn domains(&self) -> (Domain, Domain) {
        each_kind!(self, surface => (surface.domain_u(), surface.domain_v()))
    }

    /// Where tangents jump along u and along v.
    fn joints(&self) -> (Vec<f64>, Vec<f64>) {
        match self {
            Self::Any(surface) => (surface.joints_u(), surface.joints_v()),
            Self::Turned(turned) => (Vec::new(), turned.profile.joints()),
            Self::Pushed(pushed) => (pushed.profile.joints(), Vec::new()),
        }
    }

    fn evaluate(&self, u: f64, v: f64) -> SurfaceJet {
        each_kind!(self, surface => surface.evaluate(u, v))
    }
}

/// Places that are looked at along each parameter.
const PLACES: u32 = 48;

/// Jumps of the normal that smooth constructions stay below.
const JUMP: f64 = 1e-5;

/// Sides that lie nearer to each other than this share of the size are one line.
const SAME: f64 = 1e-9;

fn part(k: u32) -> f64 {
    f64::from(k) / f64::from(PLACES)
}

impl SurfaceBase {
    /// A part of a surface between parameters, all of it where they are not given. Rows run against v.
    ///
    /// # Errors
    /// When heights along its normals would tear it.
    pub fn new(
        surface: BaseSurface,
        place: DAffine3,
        u: Option<[f64; 2]>,
        v: Option<[f64; 2]>,
    ) -> Result<Self, BaseFault> {
        let (whole_u, whole_v) = surface.domains();
        let u = u.unwrap_or([whole_u.start, whole_u.end]);
        let v = v.unwrap_or([whole_v.start, whole_v.end]);
        let mut base = Self { surface, place, u, v, closes: Closes::default(), side: 1.0, turned: false };
        base.check_edges()?;
        base.find_ends()?;
        base.look_outward();
        base.find_turn()?;
        Ok(base)
    }

    /// The domains of a surface.
    #[must_use]
    pub fn domains(surface: &BaseSurface) -> [[f64; 2]; 2] {
        let (u, v) = surface.domains();
        [[u.start, u.end], [v.start, v.end]]
    }

    fn check_edges(&self) -> Result<(), BaseFault> {
        let joints = self.surface.joints();
        let within = |t: &f64, range: [f64; 2]| *t > range[0] && *t < range[1];
        for (along_v, joints, range, other) in
            [(true, joints.0, self.u, self.v), (false, joints.1, self.v, self.u)]
        {
            for at in joints.into_iter().filter(|at| within(at, range)) {
                let step = 1e-9 * (range[1] - range[0]);
                let jump = (1..PLACES).map(|k| {
                    let along = between(other, part(k));
                    let normal = |at: f64| {
                        if along_v {
                            self.surface.evaluate(at, along)
                        } else {
                            self.surface.evaluate(along, at)
                        }
                        .normal
                    };
                    normal(at - step).distance(normal(at + step))
                });
                if jump.fold(0.0, f64::max) > JUMP {
                    return Err(BaseFault::Edge { along_v, at });
                }
            }
        }
        Ok(())
    }

    fn find_ends(&mut self) -> Result<(), BaseFault> {
        let point = |s: f64, t: f64| self.at(s, t).point;
        let corners = (0..=PLACES).flat_map(|i| (0..=PLACES).map(move |j| (part(i), part(j))));
        let size = corners.map(|(s, t)| point(s, t).distance(point(0.5, 0.5))).fold(0.0, f64::max);
        let same = |a: DVec3, b: DVec3| a.distance(b) <= SAME * size;
        let all = |holds: &dyn Fn(f64) -> bool| (0..=PLACES).all(|k| holds(part(k)));
        let first = all(&|s| same(point(s, 0.0), point(0.0, 0.0)));
        let last = all(&|s| same(point(s, 1.0), point(0.0, 1.0)));
        let columns = all(&|t| same(point(0.0, t), point(1.0, t)));
        let rows = !first && !last && all(&|s| same(point(s, 0.0), point(s, 1.0)));
        let twisted = (!columns && all(&|t| same(point(0.0, t), point(1.0, 1.0 - t))))
            || (!rows && !first && !last && all(&|s| same(point(s, 0.0), point(1.0 - s, 1.0))));
        let agree = |one: (f64, f64), other: (f64, f64)| {
            self.at(one.0, one.1).normal.dot(self.at(other.0, other.1).normal) > 0.0
        };
        let flipped = (columns && !all(&|t| t == 0.0 || t == 1.0 || agree((0.0, t), (1.0, t))))
            || (rows && !all(&|s| agree((s, 0.0), (s, 1.0))));
        if twisted || flipped {
            return Err(BaseFault::Twisted);
        }
        let apart = |one: (f64, f64), other: (f64, f64)| {
            self.at(one.0, one.1).normal.distance(self.at(other.0, other.1).normal)
        };
        let inner = || (1..PLACES).map(part);
        // At a point normals are limits, which formulas know less well.
        let ends = [
            (columns, true, self.u[1], inner().map(|t| apart((0.0, t), (1.0, t))).fold(0.0, f64::max)),
            (rows, false, self.v[1], inner().map(|s| apart((s, 0.0), (s, 1.0))).fold(0.0, f64::max)),
            (
                first,
                false,
                self.v[1],
                inner().map(|s| apart((s, 0.0), (0.0, 0.0))).fold(0.0, f64::max) / 100.0,
            ),
            (
                last,
                false,
                self.v[0],
                inner().map(|s| apart((s, 1.0), (0.0, 1.0))).fold(0.0, f64::max) / 100.0,
            ),
        ];
        for (closes, along_v, at, jump) in ends {
            if closes && jump > JUMP {
                return Err(BaseFault::Edge { along_v, at });
            }
        }
        self.closes = Closes { columns, rows, first, last };
        Ok(())
    }

    /// Turns the normals of what goes around something away from its middle.
    fn look_outward(&mut self) {
        let around = matches!(self.surface, BaseSurface::Turned(_) | BaseSurface::Pushed(_));
        if !(around || self.closes.columns || self.closes.rows) {
            return;
        }
        let places = || (0..PLACES).flat_map(|i| (0..PLACES).map(move |j| (part(i), part(j))));
        let half = 0.5 / f64::from(PLACES);
        let jets: Vec<SurfaceJet> = places().map(|(s, t)| self.at(s + half, t + half)).collect();
        let area = |jet: &SurfaceJet| jet.du.cross(jet.dv).length();
        let whole: f64 = jets.iter().map(area).sum();
        let middle =
            jets.iter().map(|jet| jet.point * area(jet)).sum::<DVec3>() / whole.max(f64::MIN_POSITIVE);
        let flux: f64 = jets.iter().map(|jet| (jet.point - middle).dot(jet.normal) * area(jet)).sum();
        if flux < 0.0 {
            self.side = -1.0;
        }
    }

    fn find_turn(&mut self) -> Result<(), BaseFault> {
        let mut sense = 0.0;
        let inner = (1..PLACES).flat_map(|i| (1..PLACES).map(move |j| (part(i), part(j))));
        let turns: Vec<(f64, f64, f64)> = inner
            .map(|(s, t)| {
                let jet = self.jet(s, t);
                let across = jet.ds.cross(jet.dt);
                (s, t, across.dot(jet.normal) / (jet.ds.length() * jet.dt.length()))
            })
            .collect();
        for (s, t, turn) in turns {
            if !(turn.abs() > 1e-6) || turn * sense < 0.0 {
                return Err(BaseFault::Flat { place: [between(self.u, s), between(self.v, 1.0 - t)] });
            }
            sense = turn;
        }
        self.turned = sense > 0.0;
        Ok(())
    }

    /// A radius that ways around it do not come below, but near its points; infinite where it does not close.
    pub(super) fn girth(&self) -> f64 {
        let reach = |line: &dyn Fn(f64) -> DVec3| {
            (0..=PLACES).map(|k| line(part(k)).distance(line(0.0))).fold(0.0, f64::max) / 2.0
        };
        let lines = (0..=PLACES).map(part);
        let mut least = f64::INFINITY;
        for at in lines {
            let near = (self.closes.first && at < 0.125) || (self.closes.last && at > 0.875);
            if self.closes.columns && !near {
                least = least.min(reach(&|s| self.at(s, at).point));
            }
            if self.closes.rows {
                least = least.min(reach(&|t| self.at(at, t).point));
            }
        }
        least
    }

    /// Parameters of a place.
    fn parameters(&self, s: f64, t: f64) -> (f64, f64) {
        let s = if self.closes.columns && s >= 1.0 { 0.0 } else { s };
        let t = if self.closes.rows && t >= 1.0 { 0.0 } else { t };
        (between(self.u, s), between([self.v[1], self.v[0]], t))
    }

    /// The surface under its map; the derivatives are those by u and v.
    fn at(&self, s: f64, t: f64) -> SurfaceJet {
        let (u, v) = self.parameters(s, t);
        let jet = self.surface.evaluate(u, v);
        let matrix = self.place.matrix3;
        SurfaceJet {
            point: self.place.transform_point3(jet.point),
            du: matrix * jet.du,
            dv: matrix * jet.dv,
            normal: (turning(&matrix) * jet.normal).normalize_or(DVec3::Y) * self.side,
        }
    }

    /// Derivatives of the normal by differences, good to about nine digits.
    fn jet(&self, s: f64, t: f64) -> BaseJet {
        /// Of a part: between rounding and the third derivative.
        const STEP: f64 = 1e-5;
        let jet = self.at(s, t);
        let across = self.u[1] - self.u[0];
        let along = self.v[0] - self.v[1];
        let change = |way: DVec2| {
            let ends = [-1.0, 1.0].map(|sign| {
                let end = DVec2::new(s, t) + way * (sign * STEP);
                end.clamp(DVec2::ZERO, DVec2::ONE)
            });
            let [from, to] = ends.map(|end| self.at(end.x, end.y).normal);
            (to - from) / (ends[1] - ends[0]).length()
        };
        // Over a seam differences go wrong; the step back from it is one-sided.
        BaseJet {
            point: jet.point,
            normal: jet.normal,
            ds: jet.du * across,
            dt: jet.dv * along,
            normal_ds: change(DVec2::X),
            normal_dt: change(DVec2::Y),
        }
    }
}

/// How normals turn under a linear map: by its cofactors, away from the origin's side too where it mirrors.
fn turning(matrix: &DMat3) -> DMat3 {
    DMat3::from_cols(
        matrix.y_axis.cross(matrix.z_axis),
        matrix.z_axis.cross(matrix.x_axis),
        matrix.x_axis.cross(matrix.y_axis),
    ) * matrix.determinant().signum()
}

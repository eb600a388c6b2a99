//! Surfaces by parameters as bases: where they close, where they end in points, which way they look.
//!
//! Promise: what is accepted has one normal everywhere, and heights along it do not tear. Found in many places, not proved:
//! that opposite sides are one line, and that the surface has area.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::base::BaseJet;
use super::chart::between;
use crate::geometry::curve::{Curve as _, Domain};
use crate::geometry::map::Closes;
use crate::geometry::surface::{AnySurface, ExtrudedSurface, RevolvedSurface, Surface, SurfaceJet};

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
    pub(super) closes: Closes,
    /// 1, or -1 where its normals are turned over to look outward.
    side: f64,
    /// Whether columns and rows run the other way around its normal than those of a plane.
    pub(super) turned: bool,
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
            if turn.abs() <= 1e-6 || turn.is_nan() || turn * sense < 0.0 {
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
    pub(super) fn at(&self, s: f64, t: f64) -> SurfaceJet {
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
    pub(super) fn jet(&self, s: f64, t: f64) -> BaseJet {
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

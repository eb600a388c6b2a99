//! The parameters of a surface as the plane in which a region is filled.

use glam::{DVec2, DVec3};

use crate::geometry::surface::{Rim, SurfaceJet};
use crate::geometry::tessellate::patch::{Block, Corner, Free, judge};
use crate::geometry::tessellate::region::{Chart, Judgment};

/// Parameters, drawn so that a step in both directions goes about equally far in space.
pub(super) struct ParameterChart<'a> {
    block: Block<'a>,
    scale: DVec2,
    tolerance: f64,
    /// Sides of the block that are one point, in the order of [`Rim::ALL`].
    poles: [bool; 4],
    /// What is nearer than this is one place.
    near: f64,
}

/// Places along each direction where lengths are measured.
const PLACES: u32 = 8;

impl<'a> ParameterChart<'a> {
    /// For a range of the parameters of a smooth part of a surface.
    pub(super) fn new(block: Block<'a>, (low, high): (DVec2, DVec2), tolerance: f64) -> Self {
        let mut lengths = DVec2::ZERO;
        let mut reach = 0.0_f64;
        let first = block.jet(low.x, low.y).point;
        for (x, y) in (0..=PLACES).flat_map(|x| (0..=PLACES).map(move |y| (x, y))) {
            let place = low + (high - low) * DVec2::new(f64::from(x), f64::from(y)) / f64::from(PLACES);
            let jet = block.jet(place.x, place.y);
            lengths += DVec2::new(jet.du.length(), jet.dv.length());
            reach = reach.max(jet.point.distance(first));
        }
        let scale = |length: f64| if length.is_finite() && length > 0.0 { length } else { 1.0 };
        let near = 1e-12 * reach;
        let pole = |rim: Rim| {
            let at = |share: f64| {
                let (x, y) = block.at(rim.place(share));
                block.jet(x, y).point
            };
            (1..=4).all(|k| at(f64::from(k) / 4.0).distance(at(0.0)) <= near)
        };
        let poles = Rim::ALL.map(pole);
        Self { scale: DVec2::new(scale(lengths.x), scale(lengths.y)), block, tolerance, poles, near }
    }

    /// Where parameters lie in the plane.
    pub(super) fn drawn(&self, place: DVec2) -> DVec2 {
        place * self.scale
    }

    /// The parameters of a place in the plane.
    pub(super) fn parameters(&self, at: DVec2) -> DVec2 {
        let place = at / self.scale;
        let (u, v) = self.domains();
        // Division rounds: what was drawn from a side lies on it again.
        let snapped = |x: f64, (start, end): (f64, f64)| {
            let rounding = 1e-14 * (end - start).max(start.abs()).max(end.abs());
            if x - start <= rounding {
                start
            } else if end - x <= rounding {
                end
            } else {
                x
            }
        };
        DVec2::new(snapped(place.x, u), snapped(place.y, v))
    }

    fn domains(&self) -> ((f64, f64), (f64, f64)) {
        (self.block.u, self.block.v)
    }

    pub(super) fn jet(&self, place: DVec2) -> SurfaceJet {
        self.block.jet(place.x, place.y)
    }

    fn corner(&self, at: DVec2) -> Corner {
        let place = self.parameters(at);
        let (u, v) = self.domains();
        let on = |rim: Rim| {
            self.poles[rim as usize]
                && match rim {
                    Rim::Bottom => place.y == v.0,
                    Rim::Top => place.y == v.1,
                    Rim::Left => place.x == u.0,
                    Rim::Right => place.x == u.1,
                }
        };
        let free = if on(Rim::Bottom) || on(Rim::Top) {
            Free::U
        } else if on(Rim::Left) || on(Rim::Right) {
            Free::V
        } else {
            Free::Neither
        };
        Corner { u: place.x, v: place.y, point: 0, free }
    }
}

impl Chart for ParameterChart<'_> {
    fn lift(&self, at: DVec2) -> Option<DVec3> {
        Some(self.jet(self.parameters(at)).point)
    }

    fn judge(&self, places: [DVec2; 3], corners: [DVec3; 3]) -> Judgment {
        let middle = DVec3::splat(1.0 / 3.0);
        let [a, b, c] = corners;
        // Two corners on a pole or a seam: there is no triangle.
        if a.distance(b).min(b.distance(c)).min(c.distance(a)) <= self.near {
            return Judgment { bound: 0.0, worst: middle };
        }
        let own = places.map(|at| self.corner(at));
        let normals = own.map(|corner| self.block.jet(corner.u, corner.v).normal);
        let verdict = judge(&self.block, (own, normals), corners, self.tolerance);
        let (bound, _) = verdict.bound(self.tolerance);
        let side = (0..3).fold(0, |best, k| if verdict.sides[k] > verdict.sides[best] { k } else { best });
        let mut worst = [0.5; 3];
        worst[side] = 0.0;
        let known = bound.is_finite() && verdict.sides[side] > 0.0;
        Judgment { bound, worst: if known { DVec3::from_array(worst) } else { middle } }
    }

    fn judge_edge(&self, places: [DVec2; 2], ends: [DVec3; 2]) -> f64 {
        let away = [0.25, 0.5, 0.75].map(|part| {
            let jet = self.jet(self.parameters(places[0].lerp(places[1], part)));
            (jet.point - ends[0].lerp(ends[1], part)).dot(jet.normal).abs()
        });
        away.into_iter().fold(0.0, f64::max)
    }
}

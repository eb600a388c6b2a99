//! Surfaces through whole curves: Boolean sums of interpolation along two parameters.
//!
//! Notation: `phi_i` are the blending functions of u and `psi_j` those of v; `R_j(u)` is the curve that `psi_j`
//! carries, `Q_i(v)` the one that `phi_i` carries, and `N_ij` the datum of `R_j` that belongs to `phi_i`, which is
//! also the datum of `Q_i` that belongs to `psi_j`. The surface is
//!
//! ```text
//! P(u, v) = sum_j psi_j(v) R_j(u) + sum_i phi_i(u) (Q_i(v) - sum_j N_ij psi_j(v))
//! ```
//!
//! A curve that is not given is `sum_i N_ij phi_i` (or `sum_j N_ij psi_j`), so that its part of the second sum is
//! zero. Sources: S. A. Coons 1967; W. J. Gordon, Blending-function methods of bivariate and multivariate
//! interpolation and approximation, SIAM J. Numer. Anal. 8 (1971); G. Farin, Curves and Surfaces for CAGD,
//! 5th ed. 2002, ch. 22.

use glam::DVec3;

use super::blends::{Blends, Hull};
use super::gregory;
use super::rail::{Rail, matched, scaled};
use crate::geometry::curve::{Domain, Jet, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{SecondJet, SecondRange, Surface, SurfaceJet, limit};

/// A surface through curves along u, along v, or both. The normal is du x dv.
#[derive(Clone, Debug, PartialEq)]
pub struct TransfiniteSurface {
    u: Blends,
    v: Blends,
    /// `N_ij` at `i * (count of psi) + j`.
    net: Vec<DVec3>,
    rails_u: Vec<Option<Rail>>,
    rails_v: Vec<Option<Rail>>,
    joints_u: Vec<f64>,
    joints_v: Vec<f64>,
    /// Half differences of the twists at the corners (0, 0), (1, 0), (0, 1), (1, 1).
    disagreements: Option<Box<[DVec3; 4]>>,
}

/// Everything at one place.
struct Place {
    point: DVec3,
    du: DVec3,
    dv: DVec3,
    second: SecondJet,
}

/// Boxes of a curve without what the net makes of it, and of its derivatives.
struct Residual {
    value: Bounds,
    first: Bounds,
    second: Bounds,
}

const NO_JET: Jet = Jet { point: DVec3::ZERO, first: DVec3::ZERO, second: DVec3::ZERO };

impl TransfiniteSurface {
    /// The surface of a net and of the curves along u (one place for each function of v) and along v (one for
    /// each function of u).
    pub(super) fn new(
        (u, v): (Blends, Blends),
        net: Vec<DVec3>,
        mut rails_u: Vec<Option<Rail>>,
        mut rails_v: Vec<Option<Rail>>,
    ) -> Self {
        debug_assert_eq!(net.len(), u.count() * v.count());
        let joints = |blends: &Blends, rails: &mut [Option<Rail>]| {
            let mut joints = matched(rails);
            joints.extend(blends.joints());
            joints.sort_by(f64::total_cmp);
            joints.dedup_by(|next, kept| *next - *kept <= 1e-12);
            joints
        };
        let (joints_u, joints_v) = (joints(&u, &mut rails_u), joints(&v, &mut rails_v));
        Self { u, v, net, rails_u, rails_v, joints_u, joints_v, disagreements: None }
    }

    /// The same where derivatives across the boundary disagree about the twists.
    pub(super) fn with_disagreements(self, disagreements: [DVec3; 4]) -> Self {
        let none = disagreements.iter().all(|d| *d == DVec3::ZERO);
        Self { disagreements: (!none).then(|| Box::new(disagreements)), ..self }
    }

    fn datum(&self, i: usize, j: usize) -> DVec3 {
        self.net[i * self.v.count() + j]
    }

    /// The curve that a function of v carries.
    fn along_u(&self, j: usize, (t, side): (f64, Side), piece: usize) -> Jet {
        match &self.rails_u[j] {
            Some(rail) => rail.evaluate(t, side),
            None => blended(&self.u, piece, t, |i| self.datum(i, j)),
        }
    }

    fn place(&self, u: (f64, Side), v: (f64, Side)) -> Place {
        let u = (u.0.clamp(self.u.start(), self.u.end()), u.1);
        let v = (v.0.clamp(self.v.start(), self.v.end()), v.1);
        let (piece_u, piece_v) = (self.u.piece(u.0, u.1), self.v.piece(v.0, v.1));
        let second = SecondJet { uu: DVec3::ZERO, uv: DVec3::ZERO, vv: DVec3::ZERO };
        let mut place = Place { point: DVec3::ZERO, du: DVec3::ZERO, dv: DVec3::ZERO, second };
        for j in 0..self.v.count() {
            let weight = self.v.jet(piece_v, j, v.0);
            if weight != [0.0; 3] {
                let curve = self.along_u(j, u, piece_u);
                place.add(weight, &curve);
            }
        }
        for (i, rail) in self.rails_v.iter().enumerate() {
            let Some(rail) = rail else { continue };
            let weight = self.u.jet(piece_u, i, u.0);
            if weight != [0.0; 3] {
                let net = blended(&self.v, piece_v, v.0, |j| self.datum(i, j));
                place.add_across(weight, &minus(&rail.evaluate(v.0, v.1), &net));
            }
        }
        self.correct(u.0, v.0, &mut place);
        place
    }

    fn correct(&self, u: f64, v: f64, place: &mut Place) {
        let Some(disagreements) = &self.disagreements else { return };
        for (corner, half) in disagreements.iter().enumerate() {
            let (x, y, sign_u, sign_v) = from_corner(corner, u, v);
            let at = gregory::correction(x, y);
            let half = *half * (-sign_u * sign_v);
            place.point += half * at.value;
            place.du += half * (at.u * sign_u);
            place.dv += half * (at.v * sign_v);
            place.second.uu += half * at.uu;
            place.second.uv += half * (at.uv * sign_u * sign_v);
            place.second.vv += half * at.vv;
        }
    }

    /// The hull of the second derivatives of what the net alone makes.
    fn net_range(&self, u: (f64, f64), v: (f64, f64)) -> SecondRange {
        let empty = Bounds::EMPTY;
        let mut range = SecondRange { uu: empty, uv: empty, vv: empty };
        for (piece_u, part_u) in self.u.parts(u) {
            let across = hulls(&self.u, piece_u, part_u);
            for (piece_v, part_v) in self.v.parts(v) {
                let up = hulls(&self.v, piece_v, part_v);
                range.uu = range.uu.union(self.tensor(&across, &up, |hull| &hull.second, |hull| &hull.value));
                range.uv = range.uv.union(self.tensor(&across, &up, |hull| &hull.first, |hull| &hull.first));
                range.vv = range.vv.union(self.tensor(&across, &up, |hull| &hull.value, |hull| &hull.second));
            }
        }
        range
    }

    /// The hull of `sum N_ij a_i b_j`, from the coefficients of `a_i` and `b_j`.
    fn tensor<'h>(
        &self,
        across: &'h [Hull],
        up: &'h [Hull],
        a: impl Fn(&'h Hull) -> &'h [f64],
        b: impl Fn(&'h Hull) -> &'h [f64],
    ) -> Bounds {
        let columns = across.first().map_or(0, |hull| a(hull).len());
        let rows = up.first().map_or(0, |hull| b(hull).len());
        let mut bounds = Bounds::EMPTY;
        for column in 0..columns {
            let sums: Vec<DVec3> = (0..up.len())
                .map(|j| (0..across.len()).map(|i| self.datum(i, j) * a(&across[i])[column]).sum())
                .collect();
            for row in 0..rows {
                let control: DVec3 = sums.iter().zip(up).map(|(sum, hull)| *sum * b(hull)[row]).sum();
                bounds = bounds.with_point(control);
            }
        }
        bounds
    }
}

impl Place {
    /// Adds a function of v times a curve of u.
    fn add(&mut self, [value, first, second]: [f64; 3], curve: &Jet) {
        self.point += curve.point * value;
        self.du += curve.first * value;
        self.dv += curve.point * first;
        self.second.uu += curve.second * value;
        self.second.uv += curve.first * first;
        self.second.vv += curve.point * second;
    }

    /// Adds a function of u times a curve of v.
    fn add_across(&mut self, [value, first, second]: [f64; 3], curve: &Jet) {
        self.point += curve.point * value;
        self.du += curve.point * first;
        self.dv += curve.first * value;
        self.second.uu += curve.point * second;
        self.second.uv += curve.first * first;
        self.second.vv += curve.second * value;
    }
}

/// The curve that a row of the net makes.
fn blended(blends: &Blends, piece: usize, t: f64, datum: impl Fn(usize) -> DVec3) -> Jet {
    let mut jet = NO_JET;
    for function in 0..blends.count() {
        let [value, first, second] = blends.jet(piece, function, t);
        let datum = datum(function);
        jet.point += datum * value;
        jet.first += datum * first;
        jet.second += datum * second;
    }
    jet
}

fn minus(a: &Jet, b: &Jet) -> Jet {
    Jet { point: a.point - b.point, first: a.first - b.first, second: a.second - b.second }
}

/// Distances from a corner, and the signs of their growth with u and v.
fn from_corner(corner: usize, u: f64, v: f64) -> (f64, f64, f64, f64) {
    let (right, top) = (corner % 2 == 1, corner >= 2);
    let (x, sign_u) = if right { (1.0 - u, -1.0) } else { (u, 1.0) };
    let (y, sign_v) = if top { (1.0 - v, -1.0) } else { (v, 1.0) };
    (x, y, sign_u, sign_v)
}

fn hulls(blends: &Blends, piece: usize, part: (f64, f64)) -> Vec<Hull> {
    (0..blends.count()).map(|function| blends.hull(piece, function, part)).collect()
}

/// The interval of a function and its derivatives.
fn span(blends: &Blends, function: usize, interval: (f64, f64)) -> [(f64, f64); 3] {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for (piece, part) in blends.parts(interval) {
        let hull = blends.hull(piece, function, part);
        for (range, coefficients) in range.iter_mut().zip([&hull.value[..], &hull.first, &hull.second]) {
            for coefficient in coefficients {
                *range = (range.0.min(*coefficient), range.1.max(*coefficient));
            }
        }
    }
    range
}

impl Residual {
    /// Of a rail, with the data that the net has of it.
    fn new(
        rail: &Rail,
        blends: &Blends,
        datum: impl Fn(usize) -> DVec3,
        interval: (f64, f64),
    ) -> Option<Self> {
        let range = rail.range(interval)?;
        let mut net = Bounds::EMPTY;
        let mut slopes = Bounds::EMPTY;
        for (piece, part) in blends.parts(interval) {
            let hulls = hulls(blends, piece, part);
            let control = |coefficients: &dyn Fn(&Hull) -> f64| {
                hulls.iter().enumerate().map(|(k, hull)| datum(k) * coefficients(hull)).sum::<DVec3>()
            };
            for k in 0..2 {
                net = net.with_point(control(&|hull| hull.second[k]));
            }
            for k in 0..3 {
                slopes = slopes.with_point(control(&|hull| hull.first[k]));
            }
        }
        let second = Bounds { min: range.second.min - net.max, max: range.second.max - net.min };
        let middle = f64::midpoint(interval.0, interval.1);
        let half = (interval.1 - interval.0) / 2.0;
        let here = minus(
            &rail.evaluate(middle, Side::After),
            &blended(blends, blends.piece(middle, Side::After), middle, datum),
        );
        let around = |center: DVec3, rate: &Bounds| {
            let reach = rate.min.abs().max(rate.max.abs()) * half;
            Bounds { min: center - reach, max: center + reach }
        };
        // Both bounds of the derivative hold, so their common part does.
        let (near, far) = (around(here.first, &second), &slopes);
        let first = Bounds {
            min: near.min.max(range.first.min - far.max),
            max: near.max.min(range.first.max - far.min),
        };
        Some(Self { value: around(here.point, &first), first, second })
    }
}

fn add(sum: &mut Bounds, part: &Bounds) {
    sum.min += part.min;
    sum.max += part.max;
}

impl Surface for TransfiniteSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: self.u.start(), end: self.u.end() }
    }

    fn domain_v(&self) -> Domain {
        Domain { start: self.v.start(), end: self.v.end() }
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let place = self.place(u, v);
        let normal = limit::normal((place.du, place.dv), &place.second, (u.1, v.1))
            .unwrap_or_else(|| self.normal_near(u, v));
        SurfaceJet { point: place.point, du: place.du, dv: place.dv, normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        self.place(u, v).second
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let mut range = self.net_range(u, v);
        for (j, rail) in self.rails_u.iter().enumerate() {
            let Some(rail) = rail else { continue };
            let residual = Residual::new(rail, &self.u, |i| self.datum(i, j), u)?;
            let weight = span(&self.v, j, v);
            add(&mut range.uu, &scaled(&residual.second, weight[0]));
            add(&mut range.uv, &scaled(&residual.first, weight[1]));
            add(&mut range.vv, &scaled(&residual.value, weight[2]));
        }
        for (i, rail) in self.rails_v.iter().enumerate() {
            let Some(rail) = rail else { continue };
            let residual = Residual::new(rail, &self.v, |j| self.datum(i, j), v)?;
            let weight = span(&self.u, i, u);
            add(&mut range.uu, &scaled(&residual.value, weight[2]));
            add(&mut range.uv, &scaled(&residual.first, weight[1]));
            add(&mut range.vv, &scaled(&residual.second, weight[0]));
        }
        self.add_corrections(u, v, &mut range);
        Some(range)
    }

    fn joints_u(&self) -> Vec<f64> {
        self.joints_u.clone()
    }

    fn joints_v(&self) -> Vec<f64> {
        self.joints_v.clone()
    }
}

impl TransfiniteSurface {
    fn add_corrections(&self, u: (f64, f64), v: (f64, f64), range: &mut SecondRange) {
        let Some(disagreements) = &self.disagreements else { return };
        for (corner, half) in disagreements.iter().enumerate() {
            let ((a, b, sign_u, sign_v), (c, d, ..)) =
                (from_corner(corner, u.0, v.0), from_corner(corner, u.1, v.1));
            let [uu, uv, vv] = gregory::second_ranges((a.min(c), a.max(c)), (b.min(d), b.max(d)));
            let half = *half * (-sign_u * sign_v);
            let half = Bounds { min: half, max: half };
            let sign = sign_u * sign_v;
            let turned = if sign < 0.0 { (-uv.1, -uv.0) } else { uv };
            add(&mut range.uu, &scaled(&half, uu));
            add(&mut range.uv, &scaled(&half, turned));
            add(&mut range.vv, &scaled(&half, vv));
        }
    }

    /// The normal a short step inside, for places where neither tangents nor their changes span a plane.
    fn normal_near(&self, u: (f64, Side), v: (f64, Side)) -> DVec3 {
        const STEP: f64 = 1e-4;
        let inside = |(t, side): (f64, Side), domain: Domain| {
            let step = STEP * domain.span();
            let back = (side == Side::Before && t - step > domain.start) || t + step >= domain.end;
            (if back { t - step } else { t + step }, side)
        };
        let place = self.place(inside(u, self.domain_u()), inside(v, self.domain_v()));
        place.du.cross(place.dv).normalize_or(DVec3::Y)
    }
}

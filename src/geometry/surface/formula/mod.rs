//! Surfaces given by formulas.
//!
//! Derivatives are exact (forward automatic differentiation), and bounds on them over rectangles are proved by
//! interval arithmetic (R. Moore, R. Kearfott, M. Cloud, Introduction to Interval Analysis, 2009, ch. 6).

mod closing;
mod study;

pub use closing::Closing;
pub use study::SurfaceFault;

use glam::DVec3;

use super::{SecondJet, SecondRange, Surface, SurfaceJet, limit};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::formula::{Formula, Interval, Jet, Quality};
use crate::geometry::number::Bounds;
use study::Break;

/// The points (x, y, z) of a formula of two variables, u and v.
///
/// Lines of constant u or v along which the formula is not smooth are found when it is made and are its joints.
/// Where tangents vanish or have no limit (poles, points at which the surface pinches itself) the normal is the
/// limit from inside.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaSurface {
    formula: Formula,
    domains: [Domain; 2],
    breaks: [Vec<Break>; 2],
    size: f64,
}

/// Point and derivatives up to the second.
struct Full {
    point: DVec3,
    du: DVec3,
    dv: DVec3,
    second: SecondJet,
}

/// Sines of angles between tangents below this are looked at more closely: there the tangents' own rounding shows.
const NEARLY_PARALLEL: f64 = 1e-6;

/// Share of a domain by which a place without tangents is left for one that has them.
const STEP: f64 = 1.0 / 4096.0;

impl FormulaSurface {
    /// The surface of a formula with two variables and three results over a rectangle of them. Studies the formula
    /// first, see [`SurfaceFault`]; cost: some thousand evaluations over boxes at most, a few for calm formulas.
    ///
    /// # Errors
    /// When the formula has no finite value somewhere, jumps, or changes too often to be followed.
    pub fn new(formula: Formula, u: Domain, v: Domain) -> Result<Self, SurfaceFault> {
        let domains = [u, v];
        let breaks = study::study(&formula, domains)?;
        let mut surface = Self { formula, domains, breaks, size: 0.0 };
        surface.size = surface.box_of_points().diagonal();
        for axis in [0, 1] {
            let found: Vec<bool> = surface.breaks[axis].iter().map(|one| surface.grows(axis, one)).collect();
            surface.breaks[axis].iter_mut().zip(found).for_each(|(one, steep)| one.steep = steep);
        }
        Ok(surface)
    }

    /// About its size: the diagonal of a box around some of its points.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Whether second derivatives grow without end toward a line.
    fn grows(&self, axis: usize, line: &Break) -> bool {
        /// Times the size by the square of the range: far more than waves that can be followed.
        const ENDLESS: f64 = 1e6;
        let (domain, other) = (self.domains[axis], self.domains[1 - axis]);
        let most = ENDLESS * self.size / (domain.span() * domain.span());
        [line.before, line.after].into_iter().any(|t| {
            [0.137, 0.5, 0.863].into_iter().any(|share| {
                let at = other.at(share);
                let full = if axis == 0 { self.full(t, at) } else { self.full(at, t) };
                let bend = if axis == 0 { full.second.uu } else { full.second.vv };
                bend.is_nan() || bend.length() > most
            })
        })
    }

    /// A parameter, kept away from lines toward which second derivatives grow without end: what they say so near holds
    /// for a part too small to matter, and would ask for steps without end.
    fn off_steep(&self, axis: usize, (t, side): (f64, Side)) -> (f64, Side) {
        /// Where the average of 1 / sqrt(distance) over the last piece of a lattice of 64 is reached, about.
        const NEAR: f64 = 1e-3;
        let domain = self.domains[axis];
        let near = NEAR * domain.span();
        let steep = self.breaks[axis].iter().find(|one| one.steep && (t - one.t).abs() < near);
        let Some(one) = steep else { return (t, side) };
        let before = t < one.t || (t == one.t && side == Side::Before);
        let moved = if (before && one.t - near >= domain.start) || one.t + near > domain.end {
            one.t - near
        } else {
            one.t + near
        };
        (moved, side)
    }

    fn box_of_points(&self) -> Bounds {
        let share = |k: u32| f64::from(k) / 16.0;
        let places = (0..=16).flat_map(|i| (0..=16).map(move |j| (share(i), share(j))));
        Bounds::of_points(places.map(|(x, y)| self.place(self.domains[0].at(x), self.domains[1].at(y))))
    }

    fn place(&self, u: f64, v: f64) -> DVec3 {
        DVec3::from_array(self.formula.evaluate::<f64, 3>(&[u, v]))
    }

    /// Where derivatives are taken for a parameter: beside a break, on the named side of it.
    fn beside(&self, axis: usize, (t, side): (f64, Side)) -> f64 {
        let domain = self.domains[axis];
        let t = t.clamp(domain.start, domain.end);
        let breaks = &self.breaks[axis];
        let index = breaks.partition_point(|one| one.after <= t && one.t < t);
        let Some(one) = breaks.get(index).filter(|one| one.t == t || (one.before < t && t < one.after))
        else {
            return t;
        };
        let before = if one.t == t { side == Side::Before } else { t < one.t };
        let there = if before { one.before } else { one.after };
        // At the ends of the domain there is only one side.
        if there <= domain.start {
            one.after
        } else if there >= domain.end {
            one.before
        } else {
            there
        }
    }

    fn full(&self, u: f64, v: f64) -> Full {
        let jets: [Jet<f64, 2>; 3] = self.formula.jets([u, v]);
        let vector =
            |part: fn(&Jet<f64, 2>) -> f64| DVec3::new(part(&jets[0]), part(&jets[1]), part(&jets[2]));
        Full {
            point: vector(|jet| jet.value),
            du: vector(|jet| jet.first[0]),
            dv: vector(|jet| jet.first[1]),
            second: SecondJet {
                uu: vector(|jet| jet.second[0][0]),
                uv: vector(|jet| jet.second[0][1]),
                vv: vector(|jet| jet.second[1][1]),
            },
        }
    }

    /// Derivatives at a place or, where one is infinite, as near to it as all are finite.
    fn finite(&self, u: (f64, Side), v: (f64, Side)) -> Full {
        let (x, y) = (self.beside(0, u), self.beside(1, v));
        let here = self.full(x, y);
        let known = |full: &Full| {
            let second = &full.second;
            [full.du, full.dv, second.uu, second.uv, second.vv].iter().all(|vector| vector.is_finite())
        };
        if known(&here) {
            return here;
        }
        for step in [1e-9, 1e-7, 1e-5] {
            let near = self.full(self.inward(0, (x, u.1), step), self.inward(1, (y, v.1), step));
            if known(&near) {
                return Full { point: here.point, ..near };
            }
        }
        Full {
            point: here.point,
            du: DVec3::ZERO,
            dv: DVec3::ZERO,
            second: SecondJet { uu: DVec3::ZERO, uv: DVec3::ZERO, vv: DVec3::ZERO },
        }
    }

    /// A parameter moved to the named side by a share of its domain, or to the other where it would leave.
    fn inward(&self, axis: usize, (t, side): (f64, Side), share: f64) -> f64 {
        let domain = self.domains[axis];
        let step = domain.span() * share;
        let backward = (side == Side::Before && t - step >= domain.start) || t + step > domain.end;
        if backward { t - step } else { t + step }
    }

    /// The unit normal of derivatives by parameters from 0 to 1; none where they span no plane.
    fn regular(&self, full: &Full) -> Option<DVec3> {
        let (du, dv) = (full.du * self.domains[0].span(), full.dv * self.domains[1].span());
        let (across, product) = (du.cross(dv), du.length() * dv.length());
        let least = 1e-9 * self.size;
        let wide = across.length() > NEARLY_PARALLEL * product && du.length().min(dv.length()) > least;
        wide.then(|| across.normalize())
    }

    fn normal(&self, full: &Full, u: (f64, Side), v: (f64, Side)) -> DVec3 {
        if let Some(normal) = self.regular(full) {
            return normal;
        }
        let (a, b) = (self.domains[0].span(), self.domains[1].span());
        let second = &full.second;
        let scaled = SecondJet { uu: second.uu * (a * a), uv: second.uv * (a * b), vv: second.vv * (b * b) };
        if let Some(normal) = limit::normal((full.du * a, full.dv * b), &scaled, (u.1, v.1)) {
            return normal;
        }
        // Into the surface across one parameter or the other; where both fail, across both.
        for (x, y) in [(0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
            let at = |step: f64| {
                let near_u = if x == 0.0 { u.0 } else { self.inward(0, u, x * step) };
                let near_v = if y == 0.0 { v.0 } else { self.inward(1, v, y * step) };
                self.regular(&self.finite((near_u, u.1), (near_v, v.1)))
            };
            if let (Some(near), Some(far)) = (at(STEP), at(2.0 * STEP)) {
                return (near * 2.0 - far).normalize_or(near);
            }
        }
        DVec3::Y
    }
}

impl Surface for FormulaSurface {
    fn domain_u(&self) -> Domain {
        self.domains[0]
    }

    fn domain_v(&self) -> Domain {
        self.domains[1]
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let u = (u.0.clamp(self.domains[0].start, self.domains[0].end), u.1);
        let v = (v.0.clamp(self.domains[1].start, self.domains[1].end), v.1);
        let full = self.finite(u, v);
        let moved = self.beside(0, u) != u.0 || self.beside(1, v) != v.0;
        let point = if moved { self.place(u.0, v.0) } else { full.point };
        SurfaceJet { point, du: full.du, dv: full.dv, normal: self.normal(&full, u, v) }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        self.finite(self.off_steep(0, u), self.off_steep(1, v)).second
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let side = |axis: usize, (low, high): (f64, f64)| {
            let ends = (self.beside(axis, (low, Side::After)), self.beside(axis, (high, Side::Before)));
            Interval::new(ends.0.min(ends.1), ends.0.max(ends.1))
        };
        let jets: [Jet<Interval, 2>; 3] = self.formula.jets_over([side(0, u), side(1, v)]);
        let range = |i: usize, j: usize| {
            let end = |part: fn(&Interval) -> f64| {
                DVec3::from_array([0, 1, 2].map(|axis: usize| part(&jets[axis].second[i][j])))
            };
            Bounds { min: end(|side| side.low), max: end(|side| side.high) }
        };
        let smooth = jets.iter().all(|jet| jet.value.quality == Quality::Smooth);
        let range = SecondRange { uu: range(0, 0), uv: range(0, 1), vv: range(1, 1) };
        let finite = |bounds: &Bounds| bounds.min.is_finite() && bounds.max.is_finite();
        (smooth && [&range.uu, &range.uv, &range.vv].into_iter().all(finite)).then_some(range)
    }

    fn joints_u(&self) -> Vec<f64> {
        study::inside(&self.breaks[0], self.domains[0])
    }

    fn joints_v(&self) -> Vec<f64> {
        study::inside(&self.breaks[1], self.domains[1])
    }
}

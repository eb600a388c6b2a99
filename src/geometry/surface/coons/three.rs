//! The patch through three curves, alike in all of its corners.
//!
//! With barycentric coordinates b0, b1, b2 and P0, P1, P2 the linear interpolations along the lines b0, b1, b2 =
//! constant between the two sides that they end on, the surface is (P0 + P1 + P2 - L) / 2, where L is the flat triangle of the
//! corners. Source: R. E. Barnhill, G. Birkhoff, W. J. Gordon, Smooth interpolation in triangles, J. Approx. Theory 8
//! (1973); the mean as in G. M. Nielson, The side-vertex method for interpolation in triangles, same journal 25 (1979).
//!
//! A side that is e(t) away from its chord enters twice: with `b_j e(s) / s` at `s = b_j + b_k`, seen from the corner
//! where it starts, and the like from its other corner. Both are one function of two variables, f(x, s) = x e(s) / s,
//! whose second derivatives stay bounded where s vanishes: with g = e / s they are, by x - y coordinates of the corner
//! (s = x + y), 2 g' + w (e'' - 2 g'), g' + w (e'' - 2 g') and w (e'' - 2 g') with w = x / s, and g' is a mean of e'',
//! so that it lies in half of any box that holds e''.

use glam::DVec3;

use super::rail::{Rail, scaled};
use crate::geometry::curve::{Domain, Jet, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{SecondJet, SecondRange, Surface, SurfaceJet, limit};

/// A surface through three curves that run head to tail. The corner where the first starts is the pole v = 0; u goes
/// from the first side to the third, and v = 1 is the second. The normal is du x dv.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreeSidedSurface {
    /// From corner 0 to 1, from 1 to 2, from 0 to 2.
    sides: [Rail; 3],
    corners: [DVec3; 3],
}

/// Coordinates of a place: the three barycentric ones with their derivatives by u and v.
struct Barycentric {
    value: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    uv: [f64; 3],
}

/// How one side enters from one of its corners: b_`across` e(s) / s with s = b_`across` + b_`along`.
struct Term {
    side: usize,
    /// Whether distances are counted from the end of the side.
    backward: bool,
    across: usize,
    along: usize,
}

/// Each side from both of its corners; the first and the fifth are seen from the pole.
const TERMS: [Term; 6] = [
    Term { side: 0, backward: false, across: 1, along: 2 },
    Term { side: 0, backward: true, across: 0, along: 2 },
    Term { side: 1, backward: false, across: 2, along: 0 },
    Term { side: 1, backward: true, across: 1, along: 0 },
    Term { side: 2, backward: false, across: 2, along: 1 },
    Term { side: 2, backward: true, across: 0, along: 1 },
];

/// Corner 0 is the one that u and v share at v = 0.
const POLE: usize = 0;

/// Everything at one place.
#[derive(Clone, Copy)]
struct Place {
    point: DVec3,
    du: DVec3,
    dv: DVec3,
    second: SecondJet,
}

/// Derivatives of x e(s) / s by x and by the rest of s.
struct Slopes<T> {
    x: T,
    k: T,
    xx: T,
    xk: T,
    kk: T,
}

impl Term {
    fn corner(&self) -> usize {
        3 - self.across - self.along
    }
}

impl ThreeSidedSurface {
    /// The surface of three sides that run head to tail and have no corners inside.
    pub(super) fn new([first, second, third]: [Rail; 3]) -> Self {
        let third = third.backward();
        let corners = [first.point(0.0), first.point(1.0), third.point(1.0)];
        Self { sides: [first, second, third], corners }
    }

    fn chord(&self, side: usize) -> (DVec3, DVec3) {
        let (from, to) = [(0, 1), (1, 2), (0, 2)][side];
        (self.corners[from], self.corners[to])
    }

    /// A side without its chord, at a distance from one of its corners.
    fn residual(&self, term: &Term, s: f64) -> Jet {
        let t = if term.backward { 1.0 - s } else { s };
        let jet = self.sides[term.side].evaluate(t, if t >= 1.0 { Side::Before } else { Side::After });
        let (from, to) = self.chord(term.side);
        let sign = if term.backward { -1.0 } else { 1.0 };
        Jet {
            point: jet.point - (from * (1.0 - t) + to * t),
            first: (jet.first - (to - from)) * sign,
            second: jet.second,
        }
    }

    fn place(&self, u: f64, v: f64) -> Place {
        let b = Barycentric::new(u, v);
        let flat = |weights: &[f64; 3]| -> DVec3 {
            self.corners.iter().zip(weights).map(|(corner, weight)| *corner * *weight).sum()
        };
        let second = SecondJet { uu: DVec3::ZERO, uv: flat(&b.uv), vv: DVec3::ZERO };
        let mut place = Place { point: flat(&b.value), du: flat(&b.u), dv: flat(&b.v), second };
        for term in &TERMS {
            let (x, k) = (term.across, term.along);
            let s = b.value[x] + b.value[k];
            let share = share(term, u, b.value[x], s);
            let e = self.residual(term, s);
            place.point += e.point * (share * 0.5);
            let slopes = slopes(&e, s, share);
            let [xu, xv, ku, kv] = [b.u[x], b.v[x], b.u[k], b.v[k]].map(|slope| slope * 0.5);
            place.du += slopes.x * xu + slopes.k * ku;
            place.dv += slopes.x * xv + slopes.k * kv;
            let twice = |a: (f64, f64), c: (f64, f64)| {
                slopes.xx * (2.0 * a.0 * c.0)
                    + slopes.xk * (2.0 * (a.0 * c.1 + a.1 * c.0))
                    + slopes.kk * (2.0 * a.1 * c.1)
            };
            place.second.uu += twice((xu, ku), (xu, ku));
            place.second.uv +=
                twice((xu, ku), (xv, kv)) + slopes.x * (b.uv[x] * 0.5) + slopes.k * (b.uv[k] * 0.5);
            place.second.vv += twice((xv, kv), (xv, kv));
        }
        place
    }

    /// Boxes of the slopes of a term over a rectangle.
    fn slope_ranges(&self, term: &Term, u: (f64, f64), v: (f64, f64)) -> Option<Slopes<Bounds>> {
        let (low, high) = sums(term, u, v);
        let share = share_range(term, u, v);
        let t = if term.backward { (1.0 - high, 1.0 - low) } else { (low, high) };
        let range = self.sides[term.side].range(t)?;
        let (from, to) = self.chord(term.side);
        let first = Bounds { min: range.first.min - (to - from), max: range.first.max - (to - from) };
        let first = if term.backward { Bounds { min: -first.max, max: -first.min } } else { first };
        // g = e / s and its derivative are means: of what they are at the low end and of e' and e'' / 2 beyond it.
        let start = self.residual(term, low);
        let (g, g1) = quotient(&start, low);
        let kept = if high > 0.0 { low / high } else { 1.0 };
        let value = mean(g, &first, kept);
        let slope = mean(g1, &halved(&range.second), kept * kept);
        let w = share;
        let rest = minus(&first, &value);
        let bend = scaled(&minus(&range.second, &plus(&slope, &slope)), w);
        Some(Slopes {
            x: plus(&value, &scaled(&rest, w)),
            k: scaled(&rest, w),
            xx: plus(&plus(&slope, &slope), &bend),
            xk: plus(&slope, &bend),
            kk: bend,
        })
    }
}

/// The part x / s; at the pole the way there decides, which u tells.
fn share(term: &Term, u: f64, x: f64, s: f64) -> f64 {
    match term.corner() {
        POLE if term.across == 1 => 1.0 - u,
        POLE => u,
        _ if s > 0.0 => x / s,
        _ => 0.5,
    }
}

fn share_range(term: &Term, u: (f64, f64), v: (f64, f64)) -> (f64, f64) {
    if term.corner() == POLE {
        return if term.across == 1 { (1.0 - u.1, 1.0 - u.0) } else { u };
    }
    let (x, k) = (range_of(term.across, u, v), range_of(term.along, u, v));
    let part = |x: f64, k: f64, empty: f64| if x + k > 0.0 { x / (x + k) } else { empty };
    (part(x.0, k.1, 0.0), part(x.1, k.0, 1.0))
}

/// The interval of a barycentric coordinate.
fn range_of(index: usize, u: (f64, f64), v: (f64, f64)) -> (f64, f64) {
    match index {
        0 => (1.0 - v.1, 1.0 - v.0),
        1 => (v.0 * (1.0 - u.1), v.1 * (1.0 - u.0)),
        _ => (v.0 * u.0, v.1 * u.1),
    }
}

/// The interval of s: all but the coordinate of the corner.
fn sums(term: &Term, u: (f64, f64), v: (f64, f64)) -> (f64, f64) {
    let (low, high) = range_of(term.corner(), u, v);
    (1.0 - high, 1.0 - low)
}

/// Distances from a corner below which quotients are taken from derivatives at the corner: there the quotient of
/// two small numbers has lost as many digits as the next term of the series is worth.
const NEAR: f64 = 1e-5;

/// g = e / s and its derivative.
fn quotient(e: &Jet, s: f64) -> (DVec3, DVec3) {
    if s < NEAR {
        return (e.first - e.second * (s / 2.0), e.second / 2.0);
    }
    let g = e.point / s;
    (g, (e.first - g) / s)
}

fn slopes(e: &Jet, s: f64, w: f64) -> Slopes<DVec3> {
    let (g, g1) = quotient(e, s);
    let bend = (e.second - g1 * 2.0) * w;
    Slopes {
        x: g * (1.0 - w) + e.first * w,
        k: (e.first - g) * w,
        xx: g1 * 2.0 + bend,
        xk: g1 + bend,
        kk: bend,
    }
}

/// The box of means of a vector and one of a box, the vector weighing at least `least`.
fn mean(vector: DVec3, range: &Bounds, least: f64) -> Bounds {
    let mixed = Bounds {
        min: vector * least + range.min * (1.0 - least),
        max: vector * least + range.max * (1.0 - least),
    };
    mixed.with_point(vector)
}

fn halved(range: &Bounds) -> Bounds {
    Bounds { min: range.min / 2.0, max: range.max / 2.0 }
}

fn plus(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min + b.min, max: a.max + b.max }
}

fn minus(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min - b.max, max: a.max - b.min }
}

impl Barycentric {
    fn new(u: f64, v: f64) -> Self {
        Self {
            value: [1.0 - v, v * (1.0 - u), v * u],
            u: [0.0, -v, v],
            v: [-1.0, 1.0 - u, u],
            uv: [0.0, -1.0, 1.0],
        }
    }
}

/// Intervals of the derivatives of a barycentric coordinate by u and by v, and its mixed derivative.
fn derivatives(index: usize, u: (f64, f64), v: (f64, f64)) -> ((f64, f64), (f64, f64), f64) {
    match index {
        0 => ((0.0, 0.0), (-1.0, -1.0), 0.0),
        1 => ((-v.1, -v.0), (1.0 - u.1, 1.0 - u.0), -1.0),
        _ => (v, u, 1.0),
    }
}

fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    super::gregory::times(a, b)
}

fn constant(factor: f64) -> (f64, f64) {
    (factor, factor)
}

impl Surface for ThreeSidedSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn domain_v(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let (at_u, at_v) = (u.0.clamp(0.0, 1.0), v.0.clamp(0.0, 1.0));
        let place = self.place(at_u, at_v);
        let normal = limit::normal((place.du, place.dv), &place.second, (u.1, v.1));
        let normal = normal.unwrap_or_else(|| {
            let inside = |t: f64| t.clamp(1e-4, 1.0 - 1e-4);
            let near = self.place(inside(at_u), inside(at_v));
            near.du.cross(near.dv).normalize_or(DVec3::Y)
        });
        SurfaceJet { point: place.point, du: place.du, dv: place.dv, normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        self.place(u.0.clamp(0.0, 1.0), v.0.clamp(0.0, 1.0)).second
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let corners = self.corners[2] - self.corners[1];
        let (flat, twist) = (Bounds::of_points([DVec3::ZERO]), Bounds::of_points([corners]));
        let mut range = SecondRange { uu: flat, uv: twist, vv: flat };
        for term in &TERMS {
            let slopes = self.slope_ranges(term, u, v)?;
            let (xu, xv, xuv) = derivatives(term.across, u, v);
            let (ku, kv, kuv) = derivatives(term.along, u, v);
            let twice = |a: ((f64, f64), (f64, f64)), c: ((f64, f64), (f64, f64))| {
                let (p, q) = (product(a.0, c.1), product(a.1, c.0));
                let mixed = (p.0 + q.0, p.1 + q.1);
                let sum = plus(&scaled(&slopes.xx, product(a.0, c.0)), &scaled(&slopes.xk, mixed));
                halved(&plus(&sum, &scaled(&slopes.kk, product(a.1, c.1))))
            };
            let direct = plus(&scaled(&slopes.x, constant(xuv)), &scaled(&slopes.k, constant(kuv)));
            range.uu = plus(&range.uu, &twice((xu, ku), (xu, ku)));
            range.uv = plus(&range.uv, &plus(&twice((xu, ku), (xv, kv)), &halved(&direct)));
            range.vv = plus(&range.vv, &twice((xv, kv), (xv, kv)));
        }
        Some(range)
    }
}

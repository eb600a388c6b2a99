//! Surfaces through a row of curves.

use glam::DVec3;

use super::{SecondJet, SecondRange, Surface, SurfaceJet, limit};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Curve, Domain, Jet, Side, SplineEnd, SplineError, interpolate,
    interpolate_closed, interpolate_with, jumps,
};
use crate::geometry::number::Bounds;

/// How a surface goes from curve to curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Across {
    /// Straight from each to the next.
    Linear,
    /// A cubic spline through all, with what holds at its start and its end.
    Smooth(CrossEnd, CrossEnd),
    /// Straight, and from the last back to the first.
    LinearRing,
    /// A periodic cubic spline through all and back to the first.
    SmoothRing,
}

/// What holds at the first or the last curve.
#[derive(Clone, Debug, PartialEq)]
pub enum CrossEnd {
    /// The second derivative by v is zero.
    Natural,
    /// The first two pieces (or the last two) are one cubic.
    NotAKnot,
    /// The derivative by v, for each u from 0 to 1.
    Derivative(Box<AnyCurve>),
}

/// The surface P(u, v) = sum of `w_k(v)` `C_k(u)`, where the weights w interpolate: at the k-th knot the surface is
/// the k-th curve. u goes from 0 to 1 along all curves, v over the knots. The normal is du x dv.
///
/// The weights are splines through 0 and 1, so that for each u the curve along v is the spline through the points
/// of the curves at u. They add up to 1. Given derivatives at the ends come with weights of their own, which are 0 at
/// all knots.
///
/// Source: L. Piegl, W. Tiller, The NURBS Book, 2nd ed. 1997, section 10.3: skinned surfaces; here without the
/// detour of compatible control polygons.
///
/// Cost: an evaluation of each curve whose weight is not zero: for n curves at most n, and about 60 however many.
#[derive(Clone, Debug, PartialEq)]
pub struct LoftedSurface {
    /// Those that it goes through, then the derivatives given at its ends.
    curves: Vec<AnyCurve>,
    /// How many it goes through.
    through: usize,
    /// Weights of curves 3 i, 3 i + 1 and 3 i + 2 as the coordinates of spline i.
    weights: Vec<BezierSpline>,
    joints_u: Vec<f64>,
    joints_v: Vec<f64>,
}

/// Weights and their derivatives below this add less than rounding does.
const NOTHING: f64 = 1e-20;

impl LoftedSurface {
    /// The surface through `curves`, all over 0 to 1, at increasing `knots`: one for each curve, and for a ring one
    /// more, for the return to the first.
    ///
    /// # Errors
    /// For too few curves (two, for a ring three), a wrong number of knots, or knots that do not increase.
    pub fn new(curves: Vec<AnyCurve>, knots: &[f64], across: Across) -> Result<Self, SplineError> {
        let through = curves.len();
        let straight = matches!(across, Across::Linear | Across::LinearRing);
        let rows = Rows::new(through, &across);
        let mut curves = curves;
        if let Across::Smooth(start, end) = across {
            for end in [start, end] {
                if let CrossEnd::Derivative(curve) = end {
                    curves.push(*curve);
                }
            }
        }
        let weights: Result<Vec<BezierSpline>, SplineError> =
            (0..curves.len()).step_by(3).map(|first| rows.weights(first, knots)).collect();
        let weights = weights?;
        let mut joints_u: Vec<f64> = curves.iter().flat_map(jumps).collect();
        joints_u.sort_by(f64::total_cmp);
        joints_u.dedup();
        let joints_v = if straight { knots[1..knots.len() - 1].to_vec() } else { Vec::new() };
        Ok(Self { curves, through, weights, joints_u, joints_v })
    }

    /// The curves that it goes through.
    #[must_use]
    pub fn curves(&self) -> &[AnyCurve] {
        &self.curves[..self.through]
    }

    /// Weight of each curve with derivatives by v, for those that matter.
    fn weights(&self, (v, side): (f64, Side)) -> impl Iterator<Item = (usize, [f64; 3])> {
        self.weights.iter().enumerate().flat_map(move |(group, spline)| {
            let Jet { point, first, second } = spline.evaluate(v, side);
            (0..3).map(move |k| (3 * group + k, [point[k], first[k], second[k]]))
        })
    }

    fn both(&self, u: (f64, Side), v: (f64, Side)) -> (SurfaceJet, SecondJet) {
        let zero = DVec3::ZERO;
        let mut jet = SurfaceJet { point: zero, du: zero, dv: zero, normal: DVec3::Y };
        let mut second = SecondJet { uu: zero, uv: zero, vv: zero };
        for (k, [w, w1, w2]) in self.weights(v) {
            if k >= self.curves.len() || (w.abs() + w1.abs() + w2.abs()) < NOTHING {
                continue;
            }
            let curve = self.curves[k].evaluate(u.0, u.1);
            jet.point += curve.point * w;
            jet.du += curve.first * w;
            jet.dv += curve.point * w1;
            second.uu += curve.second * w;
            second.uv += curve.first * w1;
            second.vv += curve.point * w2;
        }
        (jet, second)
    }
}

impl LoftedSurface {
    /// Ranges where every weight is one cubic. With u = m + d around the middle of a range of half width h, and each
    /// curve's second derivatives within r of a center c, both by coordinates:
    ///
    /// - `P_uu = sum w C''` lies within `sum |w| r` of `sum w c`;
    /// - `P_uv = sum w' C'` within `h (|sum w' c| + sum |w'| r)` of `sum w' C'(m)`;
    /// - `P_vv = sum w'' C` within `h |sum w'' C'(m)| + h^2 / 2 (|sum w'' c| + sum |w''| r)` of `sum w'' C(m)`.
    ///
    /// Sums are taken before sizes, so what cancels does not count; over v they are polynomials.
    fn range_between_knots(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let (middle, half) = ((u.0 + u.1) / 2.0, (u.1 - u.0) / 2.0);
        let step = v.1 - v.0;
        let mut bends = Sums::default();
        let mut speeds = Sums::default();
        let mut places = Sums::default();
        let (mut loose, mut loose_1, mut loose_2) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        let ends = self.weights((v.0, Side::After)).zip(self.weights((v.1, Side::Before)));
        for ((k, start), (_, end)) in ends {
            let size: f64 = start.iter().chain(&end).map(|weight| weight.abs()).sum();
            let Some(curve) = self.curves.get(k).filter(|_| size >= NOTHING) else { continue };
            let range = curve.second_range(u.0, u.1)?;
            let jet = curve.evaluate(middle, Side::After);
            bends.add(range.center(), &start, &end);
            speeds.add(jet.first, &start, &end);
            places.add(jet.point, &start, &end);
            let radius = (range.max - range.min) / 2.0;
            let [most, most_1, most_2] = greatest(&start, &end, step);
            loose += radius * most;
            loose_1 += radius * most_1;
            loose_2 += radius * most_2;
        }
        let bend_1 = size(&bends.first(step)) + loose_1;
        let bend_2 = size(&bends.second()) + loose_2;
        Some(SecondRange {
            uu: widened(&bends.value(step), loose),
            uv: widened(&speeds.first(step), bend_1 * half),
            vv: widened(&places.second(), size(&speeds.second()) * half + bend_2 * (half * half / 2.0)),
        })
    }
}

/// Sums of vectors by the weights, and by their derivatives, at both ends of a piece where weights are cubic.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    start: [DVec3; 3],
    end: [DVec3; 3],
}

impl Sums {
    fn add(&mut self, vector: DVec3, start: &[f64; 3], end: &[f64; 3]) {
        for k in 0..3 {
            self.start[k] += vector * start[k];
            self.end[k] += vector * end[k];
        }
    }

    /// All values between the ends: those of a chord, and what a bounded second derivative adds.
    fn value(&self, step: f64) -> Bounds {
        let bend = self.start[2].abs().max(self.end[2].abs());
        widened(&Bounds::of_points([self.start[0], self.end[0]]), bend * (step * step / 8.0))
    }

    /// The same of the first derivative, whose own second one is the same all over.
    fn first(&self, step: f64) -> Bounds {
        let change = (self.end[2] - self.start[2]).abs();
        widened(&Bounds::of_points([self.start[1], self.end[1]]), change * (step / 8.0))
    }

    /// The same of the second derivative, which is linear.
    fn second(&self) -> Bounds {
        Bounds::of_points([self.start[2], self.end[2]])
    }
}

/// The greatest sizes of one weight and its derivatives between two ends.
fn greatest(start: &[f64; 3], end: &[f64; 3], step: f64) -> [f64; 3] {
    let most = |k: usize| start[k].abs().max(end[k].abs());
    [most(0) + most(2) * step * step / 8.0, most(1) + (end[2] - start[2]).abs() * step / 8.0, most(2)]
}

/// The greatest sizes of coordinates in a box.
fn size(range: &Bounds) -> DVec3 {
    range.min.abs().max(range.max.abs())
}

fn widened(range: &Bounds, by: DVec3) -> Bounds {
    Bounds { min: range.min - by, max: range.max + by }
}

/// The interpolation that gives the weights of curves.
struct Rows {
    through: usize,
    rule: Rule,
}

/// [`Across`] without the curves: for an end with a derivative the number of its weight.
#[derive(Clone, Copy)]
enum Rule {
    Linear,
    LinearRing,
    Smooth(RuleEnd, RuleEnd),
    SmoothRing,
}

#[derive(Clone, Copy)]
enum RuleEnd {
    Natural,
    NotAKnot,
    Derivative(usize),
}

impl Rows {
    fn new(through: usize, across: &Across) -> Self {
        let mut number = through;
        let mut end = |end: &CrossEnd| match end {
            CrossEnd::Natural => RuleEnd::Natural,
            CrossEnd::NotAKnot => RuleEnd::NotAKnot,
            CrossEnd::Derivative(_) => {
                number += 1;
                RuleEnd::Derivative(number - 1)
            }
        };
        let rule = match across {
            Across::Linear => Rule::Linear,
            Across::LinearRing => Rule::LinearRing,
            Across::SmoothRing => Rule::SmoothRing,
            Across::Smooth(first, last) => Rule::Smooth(end(first), end(last)),
        };
        Self { through, rule }
    }

    /// Weights `first` to `first` + 2, one in each coordinate: splines through 1 at the knots of their own curves and 0
    /// at all others.
    fn weights(&self, first: usize, knots: &[f64]) -> Result<BezierSpline, SplineError> {
        let unit = |k: usize| match k.checked_sub(first) {
            Some(0) => DVec3::X,
            Some(1) => DVec3::Y,
            Some(2) => DVec3::Z,
            _ => DVec3::ZERO,
        };
        let end = |end: RuleEnd| match end {
            RuleEnd::Natural => SplineEnd::Natural,
            RuleEnd::NotAKnot => SplineEnd::NotAKnot,
            RuleEnd::Derivative(k) => SplineEnd::First(unit(k)),
        };
        let mut points: Vec<DVec3> = (0..self.through).map(unit).collect();
        match self.rule {
            Rule::Smooth(start, last) => interpolate_with(&points, knots, (end(start), end(last))),
            Rule::SmoothRing => interpolate_closed(&points, knots),
            Rule::Linear => polygon(points, knots),
            Rule::LinearRing => {
                points.extend(points.first().copied());
                polygon(points, knots)
            }
        }
    }
}

/// The lines from point to point.
fn polygon(points: Vec<DVec3>, knots: &[f64]) -> Result<BezierSpline, SplineError> {
    let few = SplineError::Few { least: 2, found: points.len() };
    // Checks the numbers and the order of the knots.
    interpolate(&points, knots)?;
    BezierSpline::with_knots(1, points, knots.to_vec()).map_err(|_| few)
}

impl Surface for LoftedSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn domain_v(&self) -> Domain {
        self.weights[0].domain()
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let (mut jet, second) = self.both(u, v);
        let span = self.domain_v().span();
        let by_unit = SecondJet { uv: second.uv * span, vv: second.vv * (span * span), ..second };
        jet.normal = limit::normal((jet.du, jet.dv * span), &by_unit, (u.1, v.1)).unwrap_or_else(|| {
            let weights = self.weights(v).take(self.through);
            let nearest = weights.max_by(|a, b| a.1[0].total_cmp(&b.1[0])).map_or(0, |(k, _)| k);
            let along = self.curves[nearest].direction(u.0, u.1);
            along.cross(jet.dv).normalize_or(DVec3::Y)
        });
        jet
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        self.both(u, v).1
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let mut stops = vec![v.0];
        stops.extend(self.weights[0].breaks().into_iter().filter(|knot| *knot > v.0 && *knot < v.1));
        stops.push(v.1);
        let pieces = stops.windows(2).map(|piece| self.range_between_knots(u, (piece[0], piece[1])));
        pieces.reduce(|one, other| {
            let (one, other) = (one?, other?);
            Some(SecondRange {
                uu: one.uu.union(other.uu),
                uv: one.uv.union(other.uv),
                vv: one.vv.union(other.vv),
            })
        })?
    }

    fn joints_u(&self) -> Vec<f64> {
        self.joints_u.clone()
    }

    fn joints_v(&self) -> Vec<f64> {
        self.joints_v.clone()
    }
}

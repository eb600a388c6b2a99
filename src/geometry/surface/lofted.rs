//! Surfaces through a row of curves.

mod range;

use glam::DVec3;

use super::{SecondJet, SecondRange, Surface, SurfaceJet, limit};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Curve, Domain, Jet, Side, SplineEnd, SplineError, interpolate,
    interpolate_closed, interpolate_with, jumps,
};
use range::{Piece, Stretch, Weight, union};

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

    /// The weights that matter at a place: numbers of curves, weights with derivatives by v.
    fn weights(&self, (v, side): (f64, Side)) -> Vec<(usize, [f64; 3])> {
        let mut weights = Vec::with_capacity(self.curves.len().min(MANY));
        for (group, spline) in self.weights.iter().enumerate() {
            let Jet { point, first, second } = spline.evaluate(v, side);
            for k in 0..3 {
                let weight = [point[k], first[k], second[k]];
                let number = 3 * group + k;
                if number < self.curves.len() && size_of_all(&weight) >= NOTHING {
                    weights.push((number, weight));
                }
            }
        }
        weights
    }

    /// The jet, but for its normal, by the weights of curves whose jets are given.
    fn weighted<'a>(weights: &[(usize, [f64; 3])], curve: impl Fn(usize) -> &'a Jet) -> SurfaceJet {
        let zero = DVec3::ZERO;
        let mut jet = SurfaceJet { point: zero, du: zero, dv: zero, normal: DVec3::Y };
        for (k, [w, w1, _]) in weights {
            let curve = curve(*k);
            jet.point += curve.point * *w;
            jet.du += curve.first * *w;
            jet.dv += curve.point * *w1;
        }
        jet
    }

    /// The second derivatives, likewise.
    fn weighted_second<'a>(weights: &[(usize, [f64; 3])], curve: impl Fn(usize) -> &'a Jet) -> SecondJet {
        let zero = DVec3::ZERO;
        let mut second = SecondJet { uu: zero, uv: zero, vv: zero };
        for (k, [w, w1, w2]) in weights {
            let curve = curve(*k);
            second.uu += curve.second * *w;
            second.uv += curve.first * *w1;
            second.vv += curve.point * *w2;
        }
        second
    }

    /// Weights at v and the jets of all curves at u; of curves that do not count, zeros.
    fn at(&self, u: (f64, Side), v: (f64, Side)) -> (Vec<(usize, [f64; 3])>, Vec<Jet>) {
        let weights = self.weights(v);
        let mut jets = vec![UNKNOWN; self.curves.len()];
        for (k, _) in &weights {
            jets[*k] = self.curves[*k].evaluate(u.0, u.1);
        }
        (weights, jets)
    }

    fn with_normal(
        &self,
        (mut jet, second): (SurfaceJet, SecondJet),
        u: (f64, Side),
        v: (f64, Side),
    ) -> SurfaceJet {
        let span = self.domain_v().span();
        let by_unit = SecondJet { uv: second.uv * span, vv: second.vv * (span * span), ..second };
        jet.normal = limit::normal((jet.du, jet.dv * span), &by_unit, (u.1, v.1)).unwrap_or_else(|| {
            let weights = self.weights(v).into_iter().filter(|(k, _)| *k < self.through);
            let nearest = weights.max_by(|a, b| a.1[0].total_cmp(&b.1[0])).map_or(0, |(k, _)| k);
            let along = self.curves[nearest].direction(u.0, u.1);
            along.cross(jet.dv).normalize_or(DVec3::Y)
        });
        jet
    }

    /// Which curves are among the named ones.
    fn which(&self, named: impl Iterator<Item = usize>) -> Vec<bool> {
        let mut among = vec![false; self.curves.len()];
        named.for_each(|k| among[k] = true);
        among
    }

    /// The pieces of an interval of v over which every weight is one cubic.
    fn pieces(&self, v: (f64, f64)) -> Vec<Piece> {
        let mut stops = vec![v.0];
        stops.extend(self.weights[0].breaks().into_iter().filter(|knot| *knot > v.0 && *knot < v.1));
        stops.push(v.1);
        stops.windows(2).map(|ends| self.piece((ends[0], ends[1]))).collect()
    }

    fn piece(&self, v: (f64, f64)) -> Piece {
        let step = v.1 - v.0;
        let mut weights = Vec::with_capacity(self.curves.len().min(MANY));
        for (group, spline) in self.weights.iter().enumerate() {
            let (start, end) = (spline.evaluate(v.0, Side::After), spline.evaluate(v.1, Side::Before));
            for k in 0..3 {
                let of = |jet: &Jet| [jet.point[k], jet.first[k], jet.second[k]];
                let (start, end, number) = (of(&start), of(&end), 3 * group + k);
                if number < self.curves.len() && size_of_all(&start) + size_of_all(&end) >= NOTHING {
                    weights.push(Weight::new(number, (start, end), step));
                }
            }
        }
        Piece::new(step, weights)
    }
}

/// The jet of a curve that does not count.
const UNKNOWN: Jet = Jet { point: DVec3::ZERO, first: DVec3::ZERO, second: DVec3::ZERO };

/// Greatest lengths of points, first and second derivatives.
fn most_of_all(jets: &[Jet]) -> [f64; 3] {
    let mut most = [0.0_f64; 3];
    for jet in jets {
        for (most, vector) in most.iter_mut().zip([jet.point, jet.first, jet.second]) {
            *most = most.max(vector.length_squared());
        }
    }
    most.map(f64::sqrt)
}

/// No sum of squares of second derivatives, by v over 0 to 1, is greater for these weights.
fn most_of_second(weights: &[(usize, [f64; 3])], [point, first, second]: &[f64; 3], span: f64) -> f64 {
    let sum = |k: usize| weights.iter().map(|(_, weight)| weight[k].abs()).sum::<f64>();
    let (uu, uv, vv) = (sum(0) * second, sum(1) * first * span, sum(2) * point * (span * span));
    // Sums round.
    (uu * uu + uv * uv + vv * vv) * (1.0 + 1e-9)
}

/// Curves whose weights matter at one place, however many there are.
const MANY: usize = 64;

fn size_of_all(weight: &[f64; 3]) -> f64 {
    weight.iter().map(|weight| weight.abs()).sum()
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
        let (weights, jets) = self.at(u, v);
        let jet = Self::weighted(&weights, |k| &jets[k]);
        self.with_normal((jet, Self::weighted_second(&weights, |k| &jets[k])), u, v)
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let (weights, jets) = self.at(u, v);
        Self::weighted_second(&weights, |k| &jets[k])
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        Some(self.second_ranges(&[u], &[v])?[0])
    }

    fn lattice(&self, u: &[(f64, Side)], v: &[(f64, Side)]) -> Vec<SurfaceJet> {
        let rows: Vec<Vec<(usize, [f64; 3])>> = v.iter().map(|v| self.weights(*v)).collect();
        let matter = self.which(rows.iter().flatten().map(|(k, _)| *k));
        let count = self.curves.len();
        let mut jets = Vec::with_capacity(u.len() * count);
        for (u, side) in u {
            let curves = self.curves.iter().zip(&matter);
            jets.extend(
                curves.map(|(curve, matters)| if *matters { curve.evaluate(*u, *side) } else { UNKNOWN }),
            );
        }
        // Where the tangents are far greater than all that second derivatives can be, these need not be known.
        let most = most_of_all(&jets);
        let span = self.domain_v().span();
        let mut places = Vec::with_capacity(u.len() * v.len());
        for (weights, v) in rows.iter().zip(v) {
            let second = most_of_second(weights, &most, span);
            for (jets, u) in jets.chunks(count).zip(u) {
                let mut jet = Self::weighted(weights, |k| &jets[k]);
                places.push(match limit::plain_normal((jet.du, jet.dv * span), second) {
                    Some(normal) => {
                        jet.normal = normal;
                        jet
                    }
                    None => self.with_normal((jet, Self::weighted_second(weights, |k| &jets[k])), *u, *v),
                });
            }
        }
        places
    }

    fn second_ranges(&self, u: &[(f64, f64)], v: &[(f64, f64)]) -> Option<Vec<SecondRange>> {
        let rows: Vec<Vec<Piece>> = v.iter().map(|v| self.pieces(*v)).collect();
        let matter = self
            .which(rows.iter().flatten().flat_map(|piece| piece.weights.iter().map(|weight| weight.curve)));
        let on = |u: (f64, f64)| {
            let curves = self.curves.iter().zip(&matter);
            curves.map(
                move |(curve, matters)| {
                    if *matters { Stretch::new(curve, u) } else { Some(Stretch::default()) }
                },
            )
        };
        let stretches: Option<Vec<Stretch>> = u.iter().flat_map(|u| on(*u)).collect();
        let stretches = stretches?;
        let mut ranges = Vec::with_capacity(u.len() * v.len());
        for pieces in &rows {
            for (stretches, u) in stretches.chunks(self.curves.len()).zip(u) {
                let range = |piece: &Piece| piece.range((u.1 - u.0) / 2.0, |k| &stretches[k]);
                let first = range(&pieces[0]);
                ranges.push(pieces[1..].iter().fold(first, |sum, piece| union(sum, range(piece))));
            }
        }
        Some(ranges)
    }

    fn joints_u(&self) -> Vec<f64> {
        self.joints_u.clone()
    }

    fn joints_v(&self) -> Vec<f64> {
        self.joints_v.clone()
    }
}

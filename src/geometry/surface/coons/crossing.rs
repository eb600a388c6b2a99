//! Where two curves come nearest to each other.

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, Curve, Domain, Side};

/// The nearest places of two curves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Parameter of the first.
    pub(super) first: f64,
    /// Parameter of the second.
    pub(super) second: f64,
    pub(super) distance: f64,
    /// Place on the first.
    pub(super) point: DVec3,
}

/// Samples of each curve in the first look.
const SAMPLES: usize = 128;

/// Nearest pairs of samples from which the search goes on.
const STARTS: usize = 6;

/// Points along a curve, for the first look.
pub(super) struct Sampled<'a> {
    curve: &'a AnyCurve,
    places: Vec<(f64, DVec3)>,
}

impl<'a> Sampled<'a> {
    pub(super) fn new(curve: &'a AnyCurve) -> Self {
        let domain = curve.domain();
        let mut parameters: Vec<f64> = (0..=SAMPLES).map(|k| domain.at(k as f64 / SAMPLES as f64)).collect();
        parameters.extend(curve.joints());
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let side = |t: f64| if t >= domain.end { Side::Before } else { Side::After };
        let places = parameters.into_iter().map(|t| (t, curve.evaluate(t, side(t)).point)).collect();
        Self { curve, places }
    }

    /// The nearest approach to another curve: the best of the nearest samples, polished by Newton's method on the
    /// squared distance. Cost: the product of both numbers of samples.
    pub(super) fn nearest(&self, other: &Self) -> Crossing {
        let mut best: Vec<(f64, f64, f64)> = Vec::with_capacity(STARTS + 1);
        for (s, p) in &self.places {
            for (t, q) in &other.places {
                let square = p.distance_squared(*q);
                if best.len() < STARTS || square < best[STARTS - 1].0 {
                    let place = best.partition_point(|(known, ..)| *known <= square);
                    best.insert(place, (square, *s, *t));
                    best.truncate(STARTS);
                }
            }
        }
        let found = best.into_iter().map(|(_, s, t)| polish(self.curve, other.curve, s, t));
        let nothing = Crossing { first: 0.0, second: 0.0, distance: f64::INFINITY, point: DVec3::ZERO };
        found.fold(nothing, |best, next| if next.distance < best.distance { next } else { best })
    }
}

fn polish(one: &AnyCurve, other: &AnyCurve, mut s: f64, mut t: f64) -> Crossing {
    let (domain, range) = (one.domain(), other.domain());
    let mut best = at(one, other, s, t);
    for _ in 0..40 {
        let (a, b) = (evaluate(one, s, domain), evaluate(other, t, range));
        let away = a.point - b.point;
        // Half of the gradient and of the Gauss-Newton matrix, damped where the curves run side by side.
        let (gs, gt) = (away.dot(a.first), -away.dot(b.first));
        let (ss, st, tt) = (a.first.length_squared(), -a.first.dot(b.first), b.first.length_squared());
        let damped = 1e-12 * (ss + tt);
        let determinant = (ss + damped) * (tt + damped) - st * st;
        if determinant <= 0.0 {
            break;
        }
        let step_s = (gs * (tt + damped) - gt * st) / determinant;
        let step_t = (gt * (ss + damped) - gs * st) / determinant;
        let (next_s, next_t) = (inside(one, s - step_s), inside(other, t - step_t));
        let next = at(one, other, next_s, next_t);
        if next.distance >= best.distance {
            break;
        }
        (s, t, best) = (next_s, next_t, next);
    }
    best
}

/// A parameter within the domain; around a closed curve it comes back at the other end.
fn inside(curve: &AnyCurve, t: f64) -> f64 {
    let domain = curve.domain();
    if curve.is_closed() && t < domain.start {
        (t + domain.span()).max(domain.start)
    } else if curve.is_closed() && t > domain.end {
        (t - domain.span()).min(domain.end)
    } else {
        t.clamp(domain.start, domain.end)
    }
}

fn evaluate(curve: &AnyCurve, t: f64, domain: Domain) -> crate::geometry::curve::Jet {
    curve.evaluate(t, if t >= domain.end { Side::Before } else { Side::After })
}

fn at(one: &AnyCurve, other: &AnyCurve, s: f64, t: f64) -> Crossing {
    let (p, q) = (evaluate(one, s, one.domain()).point, evaluate(other, t, other.domain()).point);
    Crossing { first: s, second: t, distance: p.distance(q), point: p }
}

//! Factors of a section's size along its path.

use glam::DVec2;

use crate::geometry::curve::{AnyCurve, Curve, Side};

/// A factor for each axis of a section, by the share of the path's length, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// No change.
    One,
    /// Through given factors at given shares.
    Stations(Stations),
    /// A curve in the plane: x is the share and increases from 0 to 1, y the factor of both axes.
    Curve(AnyCurve),
}

/// Factors at increasing shares, and what goes on between them; constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Stations {
    shares: Vec<f64>,
    factors: Vec<DVec2>,
    /// Slopes at the stations; empty for straight lines.
    slopes: Vec<DVec2>,
}

/// The greatest rate that is told; a curve of factors may stand upright.
const STEEPEST: f64 = 1e9;

impl Stations {
    /// Straight lines from factor to factor; shares increase.
    #[must_use]
    pub fn linear(stations: &[(f64, DVec2)]) -> Self {
        let (shares, factors) = stations.iter().copied().unzip();
        Self { shares, factors, slopes: Vec::new() }
    }

    /// A smooth curve through all factors that never leaves the range of two neighbors.
    ///
    /// Source: F. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM
    /// J. Sci. Stat. Comput. 5 (1984): the slope at a station is a weighted harmonic mean of those beside it, zero
    /// where they disagree in sign. C1.
    #[must_use]
    pub fn smooth(stations: &[(f64, DVec2)]) -> Self {
        let mut all = Self::linear(stations);
        let axis = |pick: fn(DVec2) -> f64| {
            let values: Vec<f64> = all.factors.iter().map(|factor| pick(*factor)).collect();
            monotone_slopes(&all.shares, &values)
        };
        let (x, y) = (axis(|factor| factor.x), axis(|factor| factor.y));
        all.slopes = x.into_iter().zip(y).map(|(x, y)| DVec2::new(x, y)).collect();
        all
    }

    fn at(&self, share: f64, side: Side) -> (DVec2, DVec2) {
        let last = self.shares.len() - 1;
        let next = self.shares.partition_point(|station| match side {
            Side::After => *station <= share,
            Side::Before => *station < share,
        });
        if next == 0 || next > last {
            return (self.factors[if next == 0 { 0 } else { last }], DVec2::ZERO);
        }
        let (from, to) = (next - 1, next);
        let span = self.shares[to] - self.shares[from];
        let (low, high) = (self.factors[from], self.factors[to]);
        let part = (share - self.shares[from]) / span;
        if self.slopes.is_empty() {
            return (low * (1.0 - part) + high * part, (high - low) / span);
        }
        let (out, into) = (self.slopes[from] * span, self.slopes[to] * span);
        // The cubic with these ends and slopes, by powers of the part.
        let (square, cube) = ((high - low) * 3.0 - out * 2.0 - into, (low - high) * 2.0 + out + into);
        let value = low + (out + (square + cube * part) * part) * part;
        let value = if share == self.shares[to] { high } else { value };
        (value, (out + (square * 2.0 + cube * (3.0 * part)) * part) / span)
    }
}

fn monotone_slopes(shares: &[f64], values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let step = |k: usize| shares[k + 1] - shares[k];
    let slope = |k: usize| (values[k + 1] - values[k]) / step(k);
    if count < 3 {
        return vec![if count < 2 { 0.0 } else { slope(0) }; count];
    }
    let inner = |k: usize| {
        let (before, after) = (slope(k - 1), slope(k));
        if before * after <= 0.0 {
            return 0.0;
        }
        let share = (step(k - 1) + 2.0 * step(k)) / (3.0 * (step(k - 1) + step(k)));
        before * after / (share * after + (1.0 - share) * before)
    };
    // At an end the parabola through three stations, held back where it would overshoot.
    let end = |near: f64, far: f64, (h, g): (f64, f64)| {
        let slope = ((2.0 * h + g) * near - h * far) / (h + g);
        if slope * near <= 0.0 {
            0.0
        } else if near * far <= 0.0 && slope.abs() > 3.0 * near.abs() {
            3.0 * near
        } else {
            slope
        }
    };
    let mut slopes = vec![end(slope(0), slope(1), (step(0), step(1)))];
    slopes.extend((1..count - 1).map(inner));
    slopes.push(end(slope(count - 2), slope(count - 3), (step(count - 2), step(count - 3))));
    slopes
}

impl Law {
    /// The factors at a share of the path and their derivatives by it, at a joint from the named side.
    #[must_use]
    pub fn at(&self, share: f64, side: Side) -> (DVec2, DVec2) {
        match self {
            Self::One => (DVec2::ONE, DVec2::ZERO),
            Self::Stations(stations) => stations.at(share, side),
            Self::Curve(curve) => {
                let jet = curve.evaluate(parameter(curve, share, side), side);
                // x increases: where it stands still the sign of its zero means nothing.
                let rate = jet.first.y / jet.first.x.abs();
                let rate = if rate.is_nan() { 0.0 } else { rate.clamp(-STEEPEST, STEEPEST) };
                (DVec2::splat(jet.point.y), DVec2::splat(rate))
            }
        }
    }

    /// Shares strictly inside where the rate may jump, or at which factors are given.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        let all = match self {
            Self::One => Vec::new(),
            Self::Stations(stations) => stations.shares.clone(),
            Self::Curve(curve) => curve.breaks().into_iter().map(|t| curve.point(t).x).collect(),
        };
        all.into_iter().filter(|share| *share > 0.0 && *share < 1.0).collect()
    }

    /// A bound on how far the factors between two shares lie from a straight line between them; of stations none is
    /// needed, for between two joints they are cubic at most.
    #[must_use]
    pub fn bend(&self, from: f64, to: f64) -> f64 {
        match self {
            Self::Curve(curve) => {
                let (start, end) = (parameter(curve, from, Side::After), parameter(curve, to, Side::Before));
                if start < end { curve.chord_deviation(start, end) } else { 0.0 }
            }
            _ => 0.0,
        }
    }

    /// Whether the factors between two shares without a joint between them follow a straight line and are equal for
    /// both axes.
    #[must_use]
    pub fn is_even(&self, from: f64, to: f64) -> bool {
        match self {
            Self::One => true,
            Self::Stations(stations) => {
                let (low, high) = (stations.at(from, Side::After), stations.at(to, Side::Before));
                let same = |(value, rate): (DVec2, DVec2)| value.x == value.y && rate.x == rate.y;
                same(low) && same(high) && (stations.slopes.is_empty() || low.1 == high.1)
            }
            Self::Curve(_) => self.bend(from, to) == 0.0,
        }
    }

    /// The greatest factor along each axis, of the stations and of samples between them.
    #[must_use]
    pub fn greatest(&self) -> DVec2 {
        const SAMPLES: u32 = 256;
        match self {
            Self::One => DVec2::ONE,
            // Neither straight lines nor monotone cubics pass their ends.
            Self::Stations(stations) => {
                stations.factors.iter().fold(DVec2::ZERO, |most, factor| most.max(*factor))
            }
            Self::Curve(curve) => {
                let domain = curve.domain();
                let samples = (0..=SAMPLES).map(|k| domain.at(f64::from(k) / f64::from(SAMPLES)));
                let points = samples.chain(curve.breaks()).map(|t| curve.point(t).y);
                DVec2::splat(points.fold(0.0, f64::max))
            }
        }
    }
}

/// Where a curve whose x increases has this x: Newton's method inside a bracket that halves when it must.
fn parameter(curve: &AnyCurve, share: f64, side: Side) -> f64 {
    let domain = curve.domain();
    for t in curve.breaks() {
        if curve.point(t).x == share {
            return t;
        }
    }
    let (mut low, mut high) = (domain.start, domain.end);
    if curve.point(low).x >= share {
        return low;
    }
    if curve.evaluate(high, Side::Before).point.x <= share {
        return high;
    }
    let mut t = domain.at(share.clamp(0.0, 1.0));
    for _ in 0..64 {
        let jet = curve.evaluate(t, side);
        let away = jet.point.x - share;
        if away < 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - away / jet.first.x;
        let next = if newton > low && newton < high { newton } else { (low + high) / 2.0 };
        if (next - t).abs() <= 1e-15 * domain.span() {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{Law, Stations};
    use crate::geometry::curve::{AnyCurve, BezierSpline, EllipseArc, Side};

    fn stations() -> Vec<(f64, DVec2)> {
        [(0.0, 1.0), (0.2, 1.5), (0.25, 0.4), (0.7, 0.4), (1.0, 0.0)]
            .map(|(share, x)| (share, DVec2::new(x, 2.0 * x)))
            .to_vec()
    }

    #[test]
    fn stations_are_met_and_never_overshot() {
        for law in
            [Law::Stations(Stations::linear(&stations())), Law::Stations(Stations::smooth(&stations()))]
        {
            for pair in stations().windows(2) {
                for side in [Side::Before, Side::After] {
                    assert_eq!(law.at(pair[0].0, side).0, pair[0].1);
                }
                for k in 0..=100 {
                    let share = pair[0].0 + (pair[1].0 - pair[0].0) * f64::from(k) / 100.0;
                    let value = law.at(share, Side::After).0;
                    assert!(value.cmpge(pair[0].1.min(pair[1].1) - 1e-12).all(), "{share} {value}");
                    assert!(value.cmple(pair[0].1.max(pair[1].1) + 1e-12).all(), "{share} {value}");
                }
            }
            assert_eq!(law.at(1.0, Side::Before).0, DVec2::ZERO);
            assert_eq!(law.greatest(), DVec2::new(1.5, 3.0));
        }
    }

    #[test]
    fn rates_are_the_limits_of_differences_and_smooth_where_promised() {
        let wave = BezierSpline::new(
            3,
            [(0.0, 1.0), (0.3, 2.0), (0.5, 0.2), (1.0, 0.5)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
        );
        let laws = [
            Law::Stations(Stations::linear(&stations())),
            Law::Stations(Stations::smooth(&stations())),
            Law::Curve(AnyCurve::Bezier(wave.unwrap())),
        ];
        for law in laws {
            for k in 1..200 {
                let (share, step) = (f64::from(k) / 200.0, 1e-6);
                if law.joints().iter().any(|joint| (joint - share).abs() < 2.0 * step) {
                    continue;
                }
                let at = |share: f64| law.at(share, Side::After).0;
                let slope = (at(share + step) - at(share - step)) / (2.0 * step);
                assert!(slope.distance(law.at(share, Side::After).1) < 1e-5, "{law:?} at {share}");
            }
        }
        let smooth = Law::Stations(Stations::smooth(&stations()));
        for share in smooth.joints() {
            let (before, after) = (smooth.at(share, Side::Before).1, smooth.at(share, Side::After).1);
            assert!(before.distance(after) < 1e-12, "{share}");
        }
    }

    #[test]
    fn a_curve_may_end_upright() {
        let quarter = EllipseArc { center: DVec3::ZERO, x: DVec3::Y, y: DVec3::X, from: 0.0, to: 90.0 };
        let law = Law::Curve(AnyCurve::Ellipse(quarter));
        for k in 0..=50 {
            let share = f64::from(k) / 50.0;
            let exact = (1.0 - share * share).sqrt();
            assert!((law.at(share, Side::Before).0.x - exact).abs() < 1e-12, "{share}");
        }
        let (value, rate) = law.at(1.0, Side::Before);
        assert!(value == DVec2::ZERO && rate.is_finite() && rate.x < -1e6, "{value} {rate}");
    }
}

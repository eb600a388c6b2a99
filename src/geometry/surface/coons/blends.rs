//! Blending functions: what each curve of a transfinite surface weighs at a place.
//!
//! Piecewise cubics in Bernstein form, so that bounds on values and derivatives are hulls of coefficients.
//! Sources: S. A. Coons, Surfaces for computer-aided design of space forms, 1967 (linear and Hermite blends);
//! W. J. Gordon, Spline-blended surface interpolation through curve networks, J. Math. Mech. 18 (1969)
//! (cardinal splines).

use glam::DVec3;

use crate::geometry::curve::{Side, interpolate, interpolate_closed};

/// Functions over one parameter, each belonging to one datum (a value or a derivative at a station) and zero
/// for all others.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blends {
    breaks: Vec<f64>,
    /// Bernstein coefficients of each function over each piece.
    pieces: Vec<Vec<[f64; 4]>>,
    creased: bool,
}

/// Bernstein coefficients of a function over a part of one piece: its own, and those of its derivatives by
/// the surface's parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    pub(super) value: [f64; 4],
    pub(super) first: [f64; 3],
    pub(super) second: [f64; 2],
}

impl Blends {
    /// 1 - t and t over 0 to 1: data are the values at both ends.
    pub(super) fn linear() -> Self {
        let third = 1.0 / 3.0;
        let falling = [1.0, 2.0 * third, third, 0.0];
        let rising = [0.0, third, 2.0 * third, 1.0];
        Self { breaks: vec![0.0, 1.0], pieces: vec![vec![falling, rising]], creased: false }
    }

    /// Cubic Hermite functions over 0 to 1: data are the values at both ends, then the derivatives there.
    pub(super) fn hermite() -> Self {
        let third = 1.0 / 3.0;
        let functions =
            vec![[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0], [0.0, third, 0.0, 0.0], [0.0, 0.0, -third, 0.0]];
        Self { breaks: vec![0.0, 1.0], pieces: vec![functions], creased: false }
    }

    /// Hat functions: linear from station to station.
    pub(super) fn chords(stations: &[f64]) -> Self {
        let piece = |index: usize| {
            let linear = Self::linear().pieces[0].clone();
            let mut functions = vec![[0.0; 4]; stations.len()];
            functions[index] = linear[0];
            functions[index + 1] = linear[1];
            functions
        };
        let pieces = (0..stations.len() - 1).map(piece).collect();
        Self { breaks: stations.to_vec(), pieces, creased: stations.len() > 2 }
    }

    /// Hat functions around a closed parameter: the last station is the first again.
    pub(super) fn closed_chords(stations: &[f64]) -> Self {
        let mut open = Self::chords(stations);
        let last = stations.len() - 1;
        for functions in &mut open.pieces {
            let seam = functions.remove(last);
            for (sum, part) in functions[0].iter_mut().zip(seam) {
                *sum += part;
            }
        }
        Self { creased: true, ..open }
    }

    /// Cardinal functions of the natural cubic spline over stations: two continuous derivatives. Cost: O(n^2)
    /// for n stations.
    pub(super) fn spline(stations: &[f64]) -> Option<Self> {
        if stations.len() < 3 {
            return Some(Self::chords(stations));
        }
        Self::cardinal(stations, stations.len(), |data| interpolate(data, stations).ok())
    }

    /// Cardinal functions of the periodic cubic spline: the last station is the first again.
    pub(super) fn closed_spline(stations: &[f64]) -> Option<Self> {
        let count = stations.len() - 1;
        Self::cardinal(stations, count, |data| interpolate_closed(data, stations).ok())
    }

    fn cardinal(
        stations: &[f64],
        count: usize,
        spline: impl Fn(&[DVec3]) -> Option<crate::geometry::curve::BezierSpline>,
    ) -> Option<Self> {
        let mut pieces = vec![vec![[0.0; 4]; count]; stations.len() - 1];
        for function in 0..count {
            let mut data = vec![DVec3::ZERO; count];
            data[function] = DVec3::X;
            let curve = spline(&data)?;
            let control = curve.control_points();
            for (index, functions) in pieces.iter_mut().enumerate() {
                functions[function] = [0, 1, 2, 3].map(|k| control[3 * index + k].x);
            }
        }
        Some(Self { breaks: stations.to_vec(), pieces, creased: false })
    }

    pub(super) fn count(&self) -> usize {
        self.pieces[0].len()
    }

    pub(super) fn start(&self) -> f64 {
        self.breaks[0]
    }

    pub(super) fn end(&self) -> f64 {
        self.breaks[self.breaks.len() - 1]
    }

    /// Stations where first derivatives jump.
    pub(super) fn joints(&self) -> &[f64] {
        if self.creased { &self.breaks[1..self.breaks.len() - 1] } else { &[] }
    }

    /// The piece that holds `t` from one side.
    pub(super) fn piece(&self, t: f64, side: Side) -> usize {
        let inner = &self.breaks[1..self.breaks.len() - 1];
        match side {
            Side::After => inner.partition_point(|stop| *stop <= t),
            Side::Before => inner.partition_point(|stop| *stop < t),
        }
    }

    /// Pieces that an interval touches, each with its part of the interval.
    pub(super) fn parts(&self, (from, to): (f64, f64)) -> impl Iterator<Item = (usize, (f64, f64))> + '_ {
        let first = self.piece(from, Side::After);
        let last = self.piece(to, Side::Before).max(first);
        (first..=last)
            .map(move |piece| (piece, (from.max(self.breaks[piece]), to.min(self.breaks[piece + 1]))))
    }

    fn span(&self, piece: usize) -> f64 {
        self.breaks[piece + 1] - self.breaks[piece]
    }

    /// Value, first and second derivative of a function.
    pub(super) fn jet(&self, piece: usize, function: usize, t: f64) -> [f64; 3] {
        let span = self.span(piece);
        let x = (t - self.breaks[piece]) / span;
        let y = 1.0 - x;
        let [a, b, c, d] = self.pieces[piece][function];
        let value = y * y * (y * a + 3.0 * x * b) + x * x * (3.0 * y * c + x * d);
        let first = 3.0 * (y * y * (b - a) + 2.0 * x * y * (c - b) + x * x * (d - c)) / span;
        let second = 6.0 * (y * (c - 2.0 * b + a) + x * (d - 2.0 * c + b)) / (span * span);
        [value, first, second]
    }

    /// Coefficients of a function over a part of a piece.
    pub(super) fn hull(&self, piece: usize, function: usize, (from, to): (f64, f64)) -> Hull {
        let span = self.span(piece);
        let local = |t: f64| ((t - self.breaks[piece]) / span).clamp(0.0, 1.0);
        let (from, to) = (local(from), local(to));
        let [a, b, c, d] = self.pieces[piece][function];
        let slopes = [3.0 * (b - a) / span, 3.0 * (c - b) / span, 3.0 * (d - c) / span];
        let bends = [2.0 * (slopes[1] - slopes[0]) / span, 2.0 * (slopes[2] - slopes[1]) / span];
        Hull {
            value: restricted([a, b, c, d], from, to),
            first: restricted(slopes, from, to),
            second: restricted(bends, from, to),
        }
    }
}

/// Bernstein coefficients over a part of 0 to 1, by blossoming: coefficient k takes k arguments at `to` and the
/// others at `from`.
fn restricted<const N: usize>(coefficients: [f64; N], from: f64, to: f64) -> [f64; N] {
    std::array::from_fn(|k| {
        let mut work = coefficients;
        for step in 1..N {
            let x = if step <= k { to } else { from };
            for index in 0..N - step {
                work[index] = work[index] * (1.0 - x) + work[index + 1] * x;
            }
        }
        work[0]
    })
}

#[cfg(test)]
mod tests {
    use super::Blends;
    use crate::geometry::curve::Side;

    fn all() -> Vec<(Blends, bool)> {
        let stations = [0.0, 0.2, 0.55, 0.8, 1.0];
        vec![
            (Blends::linear(), true),
            (Blends::hermite(), false),
            (Blends::chords(&stations), true),
            (Blends::closed_chords(&stations), true),
            (Blends::spline(&stations).unwrap(), true),
            (Blends::closed_spline(&stations).unwrap(), true),
        ]
    }

    #[test]
    fn values_add_up_to_one_and_each_is_its_own_datum() {
        for (blends, lagrangian) in all() {
            for k in 0..=50 {
                let t = f64::from(k) / 50.0;
                let piece = blends.piece(t, Side::After);
                let used = if lagrangian { blends.count() } else { 2 };
                let sum: f64 = (0..used).map(|function| blends.jet(piece, function, t)[0]).sum();
                assert!((sum - 1.0).abs() < 1e-14, "{t}: {sum}");
            }
            if lagrangian {
                for (station, t) in blends.breaks.iter().enumerate() {
                    let piece = blends.piece(*t, Side::After);
                    for function in 0..blends.count() {
                        let own = function == station % blends.count()
                            || (blends.count() == blends.breaks.len() && function == station);
                        let value = blends.jet(piece, function, *t)[0];
                        assert!((value - f64::from(u8::from(own))).abs() < 1e-14);
                    }
                }
            }
        }
    }

    #[test]
    fn hulls_hold_values_and_derivatives() {
        for (blends, _) in all() {
            let mut from = 0.0_f64;
            while from < 0.95 {
                let to = (from + 0.17).min(1.0);
                for (piece, (low, high)) in blends.parts((from, to)) {
                    for function in 0..blends.count() {
                        let hull = blends.hull(piece, function, (low, high));
                        for k in 0..=10 {
                            let t = low + (high - low) * f64::from(k) / 10.0;
                            let jet = blends.jet(piece, function, t);
                            let holds = |coefficients: &[f64], value: f64| {
                                let low = coefficients.iter().copied().fold(f64::INFINITY, f64::min);
                                let high = coefficients.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                                low - 1e-12 <= value && value <= high + 1e-12
                            };
                            assert!(holds(&hull.value, jet[0]) && holds(&hull.first, jet[1]));
                            assert!(holds(&hull.second, jet[2]));
                        }
                    }
                }
                from = to;
            }
        }
    }
}

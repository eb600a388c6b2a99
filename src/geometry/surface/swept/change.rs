//! What a section is at each place of its path: a mix of profiles, under factors.

use glam::DVec2;

use super::law::Law;
use crate::geometry::curve::Side;

/// How sections change along a path: profiles at increasing shares of its length, and factors of size.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Shares of the path's length at which each profile stands.
    stations: Vec<f64>,
    /// Whether the section goes smoothly through the profiles, instead of straight from one to the next.
    smooth: bool,
    /// Factors of size.
    pub scale: Law,
}

/// Weights of profiles and factors at one place. At most four profiles have a part in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mix {
    /// The first profile that has a part.
    pub first: usize,
    /// How many do.
    pub count: usize,
    /// The part of each.
    pub weights: [f64; 4],
    /// Derivative of each part by the share of the path.
    pub rates: [f64; 4],
    /// Factors of x and y.
    pub scale: DVec2,
    /// Their derivatives by the share of the path.
    pub scale_rate: DVec2,
}

impl Change {
    /// One profile, the same everywhere.
    #[must_use]
    pub fn constant() -> Self {
        Self::of_scale(Law::One)
    }

    /// One profile under factors.
    #[must_use]
    pub fn of_scale(scale: Law) -> Self {
        Self { stations: vec![0.0], smooth: false, scale }
    }

    /// Several profiles, at least one, at increasing shares, under factors.
    ///
    /// Smooth mixes are the cubics of Bessel: the slope at a profile is that of the parabola through it and its
    /// neighbors. Source: C. de Boor, A Practical Guide to Splines, 1978, chapter IV.
    #[must_use]
    pub fn new(stations: Vec<f64>, smooth: bool, scale: Law) -> Self {
        Self { smooth: smooth && stations.len() > 2, stations, scale }
    }

    /// Shares at which the profiles stand.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Number of profiles.
    #[must_use]
    pub fn profiles(&self) -> usize {
        self.stations.len()
    }

    /// Whether it is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.stations.len() == 1 && self.scale == Law::One
    }

    /// Shares strictly inside the path where it may change its course.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        let mut all = self.scale.joints();
        if self.stations.len() > 1 {
            all.extend(self.stations.iter().copied().filter(|share| *share > 0.0 && *share < 1.0));
        }
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Whether between two shares without a joint between them all lines along the path that are straight without
    /// change stay straight, and flat cells stay flat.
    #[must_use]
    pub fn is_even(&self, from: f64, to: f64) -> bool {
        let mixed = || {
            let (one, other) = (self.mix(from, Side::After), self.mix(to, Side::Before));
            one.rates == [0.0; 4] && other.rates == [0.0; 4] && !self.smooth
        };
        (self.stations.len() == 1 || mixed()) && self.scale.is_even(from, to)
    }

    /// The greatest sum of all weights by size that is found along the path: 1 but for smooth mixes, which pass their
    /// profiles where these stand at uneven shares.
    #[must_use]
    pub fn greatest_weight(&self) -> f64 {
        const SAMPLES: u32 = 16;
        if !self.smooth {
            return 1.0;
        }
        let between = |pair: &[f64]| {
            let (from, to) = (pair[0], pair[1]);
            (0..SAMPLES).map(move |k| from + (to - from) * f64::from(k) / f64::from(SAMPLES))
        };
        let sum = |share: f64| {
            let mix = self.mix(share, Side::After);
            mix.weights.iter().map(|weight| weight.abs()).sum::<f64>()
        };
        self.stations.windows(2).flat_map(between).map(sum).fold(1.0, f64::max)
    }

    /// Weights and factors at a share of the path's length.
    #[must_use]
    pub fn mix(&self, share: f64, side: Side) -> Mix {
        let (scale, scale_rate) = self.scale.at(share, side);
        let last = self.stations.len() - 1;
        let alone = |first: usize| Mix {
            first,
            count: 1,
            weights: [1.0, 0.0, 0.0, 0.0],
            rates: [0.0; 4],
            scale,
            scale_rate,
        };
        if last == 0 {
            return alone(0);
        }
        let next = self.stations.partition_point(|station| match side {
            Side::After => *station <= share,
            Side::Before => *station < share,
        });
        if next == 0 || next > last {
            return alone(if next == 0 { 0 } else { last });
        }
        let mut mix = alone(next - 1);
        if self.smooth {
            self.mix_smoothly(next, share, &mut mix);
        } else {
            let (from, to) = (self.stations[next - 1], self.stations[next]);
            let (part, rate) = ((share - from) / (to - from), 1.0 / (to - from));
            mix.count = 2;
            mix.weights = [1.0 - part, part, 0.0, 0.0];
            mix.rates = [-rate, rate, 0.0, 0.0];
        }
        mix
    }

    fn mix_smoothly(&self, next: usize, share: f64, mix: &mut Mix) {
        let (from, to) = (next - 1, next);
        let span = self.stations[to] - self.stations[from];
        let t = (share - self.stations[from]) / span;
        // Hermite's cubics and their derivatives by t: at the two ends, and slopes at the two ends.
        let value = [
            1.0 - t * t * (3.0 - 2.0 * t),
            t * t * (3.0 - 2.0 * t),
            span * t * (1.0 - t) * (1.0 - t),
            span * t * t * (t - 1.0),
        ];
        let slope = [
            6.0 * t * (t - 1.0),
            6.0 * t * (1.0 - t),
            span * (1.0 - t) * (1.0 - 3.0 * t),
            span * t * (3.0 * t - 2.0),
        ];
        let first = from.saturating_sub(1).min(self.stations.len().saturating_sub(4));
        let count = self.stations.len().min(4);
        let (mut weights, mut rates) = ([0.0; 4], [0.0; 4]);
        let mut add = |profile: usize, amount: f64, part: usize| {
            weights[profile - first] += amount * value[part];
            rates[profile - first] += amount * slope[part] / span;
        };
        add(from, 1.0, 0);
        add(to, 1.0, 1);
        for (station, part) in [(from, 2), (to, 3)] {
            for (profile, amount) in self.slope(station) {
                add(profile, amount, part);
            }
        }
        (mix.first, mix.count, mix.weights, mix.rates) = (first, count, weights, rates);
    }

    /// The slope at a station as a sum of profiles: of the parabola through three stations.
    fn slope(&self, station: usize) -> [(usize, f64); 3] {
        let middle = station.clamp(1, self.stations.len() - 2);
        let at = |k: usize| self.stations[k];
        let (a, b, c, t) = (at(middle - 1), at(middle), at(middle + 1), at(station));
        [
            (middle - 1, (2.0 * t - b - c) / ((a - b) * (a - c))),
            (middle, (2.0 * t - a - c) / ((b - a) * (b - c))),
            (middle + 1, (2.0 * t - a - b) / ((c - a) * (c - b))),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::{Change, Law};
    use crate::geometry::curve::Side;

    #[test]
    fn weights_are_a_partition_of_one_and_meet_the_stations() {
        for stations in [
            vec![0.0, 1.0],
            vec![0.0, 0.3, 1.0],
            vec![0.1, 0.15, 0.5, 0.9],
            vec![0.0, 0.2, 0.4, 0.7, 0.8, 1.0],
        ] {
            for smooth in [false, true] {
                let change = Change::new(stations.clone(), smooth, Law::One);
                for k in 0..=200 {
                    let mix = change.mix(f64::from(k) / 200.0, Side::After);
                    assert!((mix.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                    assert!(mix.rates.iter().sum::<f64>().abs() < 1e-9);
                    let sum = mix.weights.iter().map(|weight| weight.abs()).sum::<f64>();
                    assert!(sum <= 1.05 * change.greatest_weight(), "{stations:?} {sum}");
                }
                for (index, share) in stations.iter().enumerate() {
                    for side in [Side::Before, Side::After] {
                        let mix = change.mix(*share, side);
                        assert!((mix.weights[index - mix.first] - 1.0).abs() < 1e-12, "{stations:?} {index}");
                    }
                }
            }
        }
    }

    /// Parabolas are reproduced, and rates are the limits of differences.
    #[test]
    fn smooth_mixes_follow_parabolas() {
        let stations = vec![0.0, 0.2, 0.45, 0.7, 1.0];
        let values: Vec<f64> = stations.iter().map(|x| 1.0 + x * (3.0 - 2.0 * x)).collect();
        let change = Change::new(stations, true, Law::One);
        let at = |share: f64| {
            let mix = change.mix(share, Side::After);
            let sum = |parts: [f64; 4]| (0..mix.count).map(|k| parts[k] * values[mix.first + k]).sum::<f64>();
            (sum(mix.weights), sum(mix.rates))
        };
        for k in 0..100 {
            let share = f64::from(k) / 100.0;
            let (value, rate) = at(share);
            assert!((value - (1.0 + share * (3.0 - 2.0 * share))).abs() < 1e-12, "{share}");
            assert!((rate - (3.0 - 4.0 * share)).abs() < 1e-9, "{share}");
        }
    }
}

//! How many steps a line needs from place to place, and where they end.

use crate::geometry::number::{floor_count, floor_index};

/// Steps for each unit of a fraction from 0 to 1, given at even places and linear between them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Density(pub(super) Vec<f64>);

impl Density {
    /// The same everywhere.
    pub(super) fn even(steps: f64) -> Self {
        Self(vec![steps; 2])
    }

    /// Steps for a unit at a place.
    pub(super) fn at(&self, fraction: f64) -> f64 {
        let pieces = self.0.len() - 1;
        let place = fraction.clamp(0.0, 1.0) * pieces as f64;
        let piece = floor_index(place).min(pieces - 1);
        let part = place - piece as f64;
        self.0[piece] * (1.0 - part) + self.0[piece + 1] * part
    }

    /// All steps.
    pub(super) fn total(&self) -> f64 {
        let pieces = (self.0.len() - 1) as f64;
        self.0.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).sum::<f64>() / pieces
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|steps| steps * factor).collect())
    }

    pub(super) fn reversed(&self) -> Self {
        Self(self.0.iter().rev().copied().collect())
    }

    /// At each place as much as the greater of the two.
    pub(super) fn max(&self, other: &Self) -> Self {
        let count = self.0.len().max(other.0.len());
        let place = |k: usize| k as f64 / (count - 1) as f64;
        Self((0..count).map(|k| self.at(place(k)).max(other.at(place(k)))).collect())
    }

    /// Ends of at least `least` whole steps, 0 and 1 included, each as good a share of the density as the others.
    pub(super) fn stations(&self, least: u32) -> Vec<f64> {
        let total = self.total();
        // Half a percent is less than what the margin of the bounds allows for.
        let count = floor_count((total * 0.995).ceil()).max(least).max(1);
        let low = self.0.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.0.iter().copied().fold(0.0, f64::max);
        if high - low <= 1e-6 * high {
            return (0..=count).map(|k| f64::from(k) / f64::from(count)).collect();
        }
        let pieces = self.0.len() - 1;
        let mut ends = vec![0.0];
        let (mut piece, mut before) = (0, 0.0);
        for k in 1..count {
            let wanted = total * f64::from(k) / f64::from(count) * pieces as f64;
            while piece + 1 < pieces && before + self.piece(piece) < wanted {
                before += self.piece(piece);
                piece += 1;
            }
            ends.push((piece as f64 + self.inverse(piece, wanted - before)) / pieces as f64);
        }
        ends.push(1.0);
        ends
    }

    fn piece(&self, piece: usize) -> f64 {
        (self.0[piece] + self.0[piece + 1]) / 2.0
    }

    /// The part of a piece over which its density adds up to `sum`.
    fn inverse(&self, piece: usize, sum: f64) -> f64 {
        let (start, end) = (self.0[piece], self.0[piece + 1]);
        let root = (start * start + 2.0 * (end - start) * sum).max(0.0).sqrt();
        if start + root > 0.0 { (2.0 * sum / (start + root)).clamp(0.0, 1.0) } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::Density;

    #[test]
    fn stations_share_the_density() {
        let density = Density(vec![1.0, 3.0, 9.0, 2.0, 0.0, 40.0]);
        let ends = density.stations(0);
        assert_eq!(ends.len() - 1, 7);
        let sum = |from: f64, to: f64| {
            (0..10_000).map(|k| density.at(from + (to - from) * (f64::from(k) + 0.5) / 1e4)).sum::<f64>()
                * (to - from)
                / 1e4
        };
        for pair in ends.windows(2) {
            assert!((sum(pair[0], pair[1]) - density.total() / 7.0).abs() < 1e-6, "{ends:?}");
        }
        assert_eq!(Density::even(3.0).stations(0), [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
        assert_eq!(Density::even(0.0).stations(0), [0.0, 1.0]);
    }
}

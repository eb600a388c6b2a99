//! Laws of motion: numbers as functions of time.
//!
//! Between keys a law stays, runs straight, or is a cubic with the slope of its keys (Hermite; without a
//! written slope that of the chord between the neighbours, as Catmull and Rom have it, for uneven times). A
//! graph is a plane curve that runs onward in x, which is the time. A law of speed gives the length that was
//! gone. Before its first and after its last time every law keeps its value.

use glam::DVec4;

use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::formula::Formula;

/// How values go from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// They stay until the next key.
    Step,
    /// Straight.
    Linear,
    /// A cubic with given slopes.
    Cubic,
}

/// Values at times.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    /// Seconds, increasing.
    pub times: Vec<f64>,
    /// One value for each time.
    pub values: Vec<DVec4>,
    /// What is between.
    pub interpolation: Interpolation,
    /// Change a second at each key, for cubics.
    pub slopes: Vec<DVec4>,
}

impl Keys {
    /// Keys with the slopes of the chords between neighbours where none are written; a loop's first and last key are
    /// neighbours too. `times` increase, and each has a value.
    #[must_use]
    pub fn new(
        (times, values): (Vec<f64>, Vec<DVec4>),
        written: &[Option<DVec4>],
        interpolation: Interpolation,
        looped: bool,
    ) -> Self {
        let last = times.len() - 1;
        let chord = |from: usize, to: usize| (values[to] - values[from], times[to] - times[from]);
        let slope = |key: usize| {
            let before = if key > 0 {
                Some(chord(key - 1, key))
            } else {
                (looped && last > 0).then(|| chord(last - 1, last))
            };
            let after = if key < last {
                Some(chord(key, key + 1))
            } else {
                (looped && last > 0).then(|| chord(0, 1))
            };
            match (before, after) {
                (Some((a, s)), Some((b, t))) => (a + b) / (s + t),
                (Some((way, time)), None) | (None, Some((way, time))) => way / time,
                (None, None) => DVec4::ZERO,
            }
        };
        let slopes = if interpolation == Interpolation::Cubic {
            (0..=last).map(|key| written.get(key).copied().flatten().unwrap_or_else(|| slope(key))).collect()
        } else {
            Vec::new()
        };
        Self { times, values, interpolation, slopes }
    }

    /// The key before a time, the share of the way to the next and the seconds between them.
    pub(super) fn locate(&self, time: f64) -> (usize, f64, f64) {
        let next = self.times.partition_point(|key| *key <= time);
        if next == 0 {
            return (0, 0.0, 0.0);
        }
        let key = next - 1;
        if next == self.times.len() {
            return (key, 0.0, 0.0);
        }
        let span = self.times[next] - self.times[key];
        (key, (time - self.times[key]) / span, span)
    }

    /// The value at a time.
    #[must_use]
    pub fn at(&self, time: f64) -> DVec4 {
        let (key, share, span) = self.locate(time);
        if share <= 0.0 || self.interpolation == Interpolation::Step {
            return self.values[key];
        }
        let (from, to) = (self.values[key], self.values[key + 1]);
        if self.interpolation == Interpolation::Linear {
            return from + (to - from) * share;
        }
        let (s, t) = (share, 1.0 - share);
        let (leaving, coming) = (self.slopes[key] * span, self.slopes[key + 1] * span);
        from * (t * t * (1.0 + 2.0 * s)) + to * (s * s * (1.0 + 2.0 * t)) + leaving * (t * t * s)
            - coming * (s * s * t)
    }
}

/// A speed that changes evenly between times, in lengths a second.
#[derive(Clone, Debug, PartialEq)]
pub struct Speed {
    /// Seconds, increasing.
    pub times: Vec<f64>,
    /// Speed at each time.
    pub speeds: Vec<f64>,
}

impl Speed {
    /// The length gone until a time: before the first time none, after the last at the last speed.
    #[must_use]
    pub fn gone(&self, time: f64) -> f64 {
        let mut gone = 0.0;
        for (times, speeds) in self.times.windows(2).zip(self.speeds.windows(2)) {
            if time <= times[0] {
                return gone;
            }
            let (span, part) = (times[1] - times[0], time.min(times[1]) - times[0]);
            gone += part * (speeds[0] + (speeds[1] - speeds[0]) * part / (2.0 * span));
        }
        let (last, speed) = (self.times[self.times.len() - 1], self.speeds[self.speeds.len() - 1]);
        gone + (time - last).max(0.0) * speed
    }
}

/// Up to four numbers as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// Values at times.
    Keys(Keys),
    /// Formulas of the time t in seconds and of the place u along a chain.
    Formula {
        /// One output for each number.
        formulas: Vec<Formula>,
        /// u.
        share: f64,
    },
    /// The y of a plane curve over its x.
    Graph(AnyCurve),
    /// Lengths gone at a speed, as shares of a length.
    Speed {
        /// The speed.
        speed: Speed,
        /// What is 1.
        length: f64,
    },
}

/// Why a curve is no law of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawFault {
    /// It turns back or stands still in x at this time.
    TurnsBack(f64),
}

impl Law {
    /// A graph; the curve must run onward in x all the way. Checked at dense samples.
    ///
    /// # Errors
    /// Where it does not.
    pub fn graph(curve: AnyCurve) -> Result<Self, LawFault> {
        const SAMPLES: u32 = 1024;
        let domain = curve.domain();
        let mut places: Vec<f64> =
            (0..=SAMPLES).map(|k| domain.at(f64::from(k) / f64::from(SAMPLES))).collect();
        places.extend(curve.breaks());
        places.sort_by(f64::total_cmp);
        places.dedup();
        let times: Vec<f64> = places.iter().map(|t| curve.evaluate(*t, Side::Before).point.x).collect();
        match times.windows(2).find(|pair| pair[1] <= pair[0]) {
            Some(pair) => Err(LawFault::TurnsBack(pair[0])),
            None => Ok(Self::Graph(curve)),
        }
    }

    /// The values at a time; numbers that the law does not have are 0.
    #[must_use]
    pub fn at(&self, time: f64) -> DVec4 {
        match self {
            Self::Keys(keys) => keys.at(time),
            Self::Formula { formulas, share } => {
                let mut values = DVec4::ZERO;
                for (index, formula) in formulas.iter().enumerate().take(4) {
                    let [value] = formula.evaluate::<f64, 1>(&[time, *share]);
                    values[index] = value;
                }
                values
            }
            Self::Graph(curve) => DVec4::new(height(curve, time), 0.0, 0.0, 0.0),
            Self::Speed { speed, length } => DVec4::new(speed.gone(time) / length, 0.0, 0.0, 0.0),
        }
    }

    /// Times at which it may bend sharply.
    #[must_use]
    pub fn stops(&self) -> Vec<f64> {
        match self {
            Self::Keys(keys) => keys.times.clone(),
            Self::Formula { .. } => Vec::new(),
            Self::Graph(curve) => {
                let domain = curve.domain();
                let ends = [domain.start, domain.end];
                let stops = curve.breaks().into_iter().chain(ends);
                stops.map(|t| curve.evaluate(t, Side::Before).point.x).collect()
            }
            Self::Speed { speed, .. } => speed.times.clone(),
        }
    }

    /// Whether its values jump from key to key.
    #[must_use]
    pub fn stepped(&self) -> bool {
        matches!(self, Self::Keys(keys) if keys.interpolation == Interpolation::Step)
    }
}

/// The y of a curve at an x, by halving: 60 evaluations.
fn height(curve: &AnyCurve, x: f64) -> f64 {
    let domain = curve.domain();
    let (mut low, mut high) = (domain.start, domain.end);
    for _ in 0..60 {
        let middle = low + (high - low) / 2.0;
        if curve.evaluate(middle, Side::Before).point.x <= x { low = middle } else { high = middle }
    }
    curve.evaluate(low, Side::Before).point.y
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, DVec4};

    use super::{Interpolation, Keys, Law, LawFault, Speed};
    use crate::geometry::curve::{AnyCurve, BezierSpline, Polyline};

    fn keys(interpolation: Interpolation) -> Keys {
        let values = [0.0, 1.0, 8.0].map(DVec4::splat).to_vec();
        Keys::new((vec![0.0, 1.0, 2.0], values), &[], interpolation, false)
    }

    #[test]
    fn keys_step_run_straight_and_bend() {
        assert_eq!(keys(Interpolation::Step).at(0.99), DVec4::ZERO);
        assert_eq!(keys(Interpolation::Linear).at(1.5), DVec4::splat(4.5));
        for (time, value) in [(-1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (2.0, 8.0), (3.0, 8.0)] {
            for way in [Interpolation::Step, Interpolation::Linear, Interpolation::Cubic] {
                assert_eq!(keys(way).at(time), DVec4::splat(value), "{way:?} {time}");
            }
        }
        // x^3 is followed exactly where its own slopes are written.
        let written = [0.0, 3.0, 12.0].map(|slope| Some(DVec4::splat(slope)));
        let values = [0.0, 1.0, 8.0].map(DVec4::splat).to_vec();
        let cube = Keys::new((vec![0.0, 1.0, 2.0], values), &written, Interpolation::Cubic, false);
        for time in [0.25_f64, 0.5, 1.3, 1.9] {
            assert!((cube.at(time).x - time * time * time).abs() < 1e-14, "{time}");
        }
    }

    #[test]
    fn a_loop_has_one_slope_at_its_seam() {
        let values = [0.0, 1.0, 0.0, -1.0, 0.0].map(DVec4::splat).to_vec();
        let keys = Keys::new((vec![0.0, 1.0, 2.0, 3.0, 4.0], values), &[], Interpolation::Cubic, true);
        assert_eq!(keys.slopes[0], keys.slopes[4]);
        assert_eq!(keys.slopes[0], DVec4::ONE);
    }

    #[test]
    fn speed_adds_up_to_length() {
        let speed = Speed { times: vec![0.0, 2.0, 3.0], speeds: vec![0.0, 4.0, 4.0] };
        for (time, gone) in [(-1.0, 0.0), (1.0, 1.0), (2.0, 4.0), (2.5, 6.0), (3.0, 8.0), (4.0, 12.0)] {
            assert!((speed.gone(time) - gone).abs() < 1e-14, "{time}");
        }
    }

    #[test]
    fn a_graph_is_read_by_its_time() {
        let points = [(0.0, 0.0), (0.3, 0.0), (0.7, 1.0), (1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let ease = AnyCurve::Bezier(BezierSpline::new(3, points.to_vec()).expect("a curve"));
        let law = Law::graph(ease).expect("it runs onward");
        assert!((law.at(0.5).x - 0.5).abs() < 1e-12 && law.at(2.0).x == 1.0);
        let back = Polyline::new(
            [(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
            false,
        );
        let back = AnyCurve::Polyline(back.expect("a line"));
        assert_eq!(Law::graph(back), Err(LawFault::TurnsBack(1.0)));
    }
}

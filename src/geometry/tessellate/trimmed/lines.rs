//! Lines of the parameters of a surface, cut into chords by what they leave out in space.

use glam::{DVec2, DVec3};

use super::TrimmedSurface;
use super::seam::Seams;
use crate::geometry::curve::{AnyCurve, Curve as _, Domain, Side};
use crate::geometry::number::floor_index;
use crate::geometry::surface::{AnySurface, Surface as _};
use crate::geometry::tessellate::TessellateError;

/// How finely lines are cut.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cut {
    /// Chords within this many metres.
    Within(f64),
    /// So many chords for each line.
    Into(u32),
}

impl Cut {
    pub(super) fn finer(self) -> Self {
        match self {
            Self::Within(tolerance) => Self::Within(tolerance / 3.0),
            Self::Into(count) => Self::Into(count.saturating_mul(2)),
        }
    }
}

/// All lines as polygons of parameters; the last place is joined to the first.
pub(super) struct Loops {
    pub(super) all: Vec<Vec<DVec2>>,
    /// The most that a chord leaves out, as seen by samples.
    pub(super) deviation: f64,
}

/// Places along a line of parameters, close enough to know its range.
pub(super) fn rough(curve: &AnyCurve) -> impl Iterator<Item = DVec2> + '_ {
    let domain = curve.domain();
    let even = (0..=64).map(move |k| domain.at(f64::from(k) / 64.0));
    even.chain(curve.joints()).map(|t| curve.point(t).truncate())
}

/// Cuts all outlines of a shape.
///
/// # Errors
/// More chords than `limit`.
pub(super) fn loops(shape: &TrimmedSurface, cut: Cut, limit: u64) -> Result<Loops, TessellateError> {
    let mut made = Loops { all: Vec::new(), deviation: 0.0 };
    for curve in &shape.outlines {
        let line = Trim::new(&shape.surface, curve);
        let mut places = Vec::new();
        for pair in line.stops().windows(2) {
            let stations = line.stations((pair[0], pair[1]), cut, limit)?;
            let chords = stations.windows(2).map(|chord| line.deviation(chord[0], chord[1]));
            made.deviation = chords.fold(made.deviation, f64::max);
            // The end of one piece is the start of the next, and of the last that of the first.
            places.extend(stations[..stations.len() - 1].iter().map(|t| line.place(*t)));
        }
        places.dedup();
        made.all.push(places);
    }
    Seams::new(&shape.surface).match_up(&mut made.all);
    Ok(made)
}

/// A line of parameters on its surface.
struct Trim<'a> {
    surface: &'a AnySurface,
    curve: &'a AnyCurve,
    domains: (Domain, Domain),
}

/// Samples are raised by this share: a smooth line may exceed them by terms of the next order.
const MARGIN: f64 = 1.05;

/// Chords of a whole line at least: fewer would make a circle a line.
const FEWEST: usize = 8;

/// Halvings of a part of a line.
const DEEPEST: u32 = 20;

impl<'a> Trim<'a> {
    fn new(surface: &'a AnySurface, curve: &'a AnyCurve) -> Self {
        Self { surface, curve, domains: (surface.domain_u(), surface.domain_v()) }
    }

    /// Ends of the pieces of the line.
    fn stops(&self) -> Vec<f64> {
        let domain = self.curve.domain();
        let joints = self.curve.joints().into_iter();
        std::iter::once(domain.start).chain(joints).chain(std::iter::once(domain.end)).collect()
    }

    /// Parameters of the surface; those that lie outside by rounding, on its side.
    fn place(&self, t: f64) -> DVec2 {
        let at = self.curve.evaluate(t, Side::After).point;
        let snapped = |x: f64, domain: Domain| {
            let rounding = 1e-9 * domain.span();
            if x - domain.start <= rounding {
                domain.start
            } else if domain.end - x <= rounding {
                domain.end
            } else {
                x
            }
        };
        DVec2::new(snapped(at.x, self.domains.0), snapped(at.y, self.domains.1))
    }

    fn point(&self, t: f64) -> DVec3 {
        let place = self.place(t);
        self.surface.evaluate(place.x, place.y).point
    }

    /// How far the line leaves a chord, at quarters of it.
    fn deviation(&self, from: f64, to: f64) -> f64 {
        let (start, end) = (self.point(from), self.point(to));
        let along = end - start;
        let square = along.length_squared();
        let away = [0.25, 0.5, 0.75].map(|part| {
            let point = self.point(from + (to - from) * part);
            let share =
                if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
            point.distance(start + along * share)
        });
        away.into_iter().fold(0.0, f64::max) * MARGIN
    }

    /// Parameters of a piece, its ends included: all chords leave out alike.
    fn stations(&self, piece: (f64, f64), cut: Cut, limit: u64) -> Result<Vec<f64>, TessellateError> {
        let pieces = self.stops().len() - 1;
        let fewest = FEWEST.div_ceil(pieces).min(4);
        let fine = self.fine(piece, cut, limit)?;
        let weights: Vec<f64> = fine.windows(2).map(|pair| self.deviation(pair[0], pair[1]).sqrt()).collect();
        let total: f64 = weights.iter().sum();
        let straight = total <= 1e-9 * self.point(piece.0).distance(self.point(piece.1)).sqrt();
        let mut count = match cut {
            Cut::Within(_) if straight => 1,
            Cut::Within(tolerance) => floor_index((total / tolerance.sqrt() - 1e-6).ceil()).max(fewest),
            Cut::Into(count) => count.div_ceil(u32::try_from(pieces).unwrap_or(u32::MAX)) as usize,
        };
        loop {
            let chords = even(&fine, &weights, count);
            let good = match cut {
                Cut::Within(tolerance) => {
                    chords.windows(2).all(|pair| self.deviation(pair[0], pair[1]) <= tolerance)
                }
                Cut::Into(_) => true,
            };
            if good || count >= fine.len() {
                return Ok(if good { chords } else { fine });
            }
            count += 1 + count / 16;
        }
    }

    /// Parameters so close that chords between them leave out little more than nothing.
    fn fine(&self, (from, to): (f64, f64), cut: Cut, limit: u64) -> Result<Vec<f64>, TessellateError> {
        const START: u32 = 8;
        let at = |k: u32| if k == START { to } else { from + (to - from) * f64::from(k) / f64::from(START) };
        let enough = match cut {
            Cut::Within(tolerance) => tolerance / 16.0,
            Cut::Into(count) => {
                let count = f64::from(count.max(8));
                (0..START).map(|k| self.deviation(at(k), at(k + 1))).fold(0.0, f64::max) / (count * count)
            }
        };
        let mut all = vec![from];
        for k in 0..START {
            self.halve((at(k), at(k + 1)), enough, DEEPEST, &mut all);
            let needed = all.len() as u64 / 4;
            if needed > limit {
                return Err(TessellateError::TooMany { needed, limit });
            }
        }
        Ok(all)
    }

    fn halve(&self, (from, to): (f64, f64), enough: f64, depth: u32, all: &mut Vec<f64>) {
        let middle = f64::midpoint(from, to);
        if depth > 0 && self.deviation(from, to) > enough && middle != from && middle != to {
            self.halve((from, middle), enough, depth - 1, all);
            self.halve((middle, to), enough, depth - 1, all);
        } else {
            all.push(to);
        }
    }
}

/// `count` chords with equal sums of the weights.
fn even(fine: &[f64], weights: &[f64], count: usize) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let (first, last) = (fine[0], fine[fine.len() - 1]);
    let mut chords = vec![first];
    let (mut index, mut before) = (0, 0.0);
    for k in 1..count {
        let share = k as f64 / count as f64;
        let wanted = total * share;
        while index + 1 < weights.len() && before + weights[index] < wanted {
            before += weights[index];
            index += 1;
        }
        // A straight line takes even parts.
        let t = if total > 0.0 && weights[index] > 0.0 {
            let part = ((wanted - before) / weights[index]).clamp(0.0, 1.0);
            fine[index] + (fine[index + 1] - fine[index]) * part
        } else {
            first + (last - first) * share
        };
        chords.push(t);
    }
    chords.push(last);
    chords
}

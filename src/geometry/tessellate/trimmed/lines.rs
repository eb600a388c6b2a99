//! Lines of the parameters of a surface, cut into chords by what they leave out in space.

use glam::{DVec2, DVec3};

use super::TrimmedSurface;
use super::cells::{Cells, Direction, Number};
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::{floor_count, floor_index};
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

    /// For a line that is this share of a whole one.
    pub(super) fn share(self, share: f64) -> Self {
        match self {
            Self::Within(_) => self,
            Self::Into(count) => Self::Into(floor_count((f64::from(count) * share - 1e-9).ceil()).max(1)),
        }
    }
}

/// All lines as polygons of the endless plane of parameters; the last place is joined to the first. Places on lines between
/// cells lie on them exactly, and no edge crosses one.
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
        let line = Trim::new(shape, curve);
        let mut places = Vec::new();
        let stops = line.stops();
        let pieces = stops.len() - 1;
        let how = (cut.share(1.0 / pieces as f64), FEWEST.div_ceil(pieces).min(4));
        for pair in stops.windows(2) {
            let stations = line.stations((pair[0], pair[1]), how, limit)?;
            made.deviation = made.deviation.max(line.left_out(&stations));
            // The end of one piece is the start of the next, and of the last that of the first.
            places.extend(stations[..stations.len() - 1].iter().map(|t| line.place(*t)));
        }
        places.dedup();
        made.all.push(cut_at_lines(&shape.cells, &places));
    }
    Ok(made)
}

/// Adds the places where edges still cross lines between cells, as where a curve touched one and its chord does not.
fn cut_at_lines(cells: &Cells, places: &[DVec2]) -> Vec<DVec2> {
    let mut made = Vec::with_capacity(places.len());
    for (k, from) in places.iter().enumerate() {
        let to = places[(k + 1) % places.len()];
        let mut between: Vec<(f64, DVec2)> = Vec::new();
        for (axis, direction) in cells.directions.iter().enumerate() {
            for line in direction.between(from[axis], to[axis]) {
                let at = direction.line(line);
                let share = (at - from[axis]) / (to[axis] - from[axis]);
                let mut place = from.lerp(to, share);
                place[axis] = at;
                between.push((share, cells.snapped(place)));
            }
        }
        between.sort_by(|one, other| one.0.total_cmp(&other.0));
        made.push(*from);
        made.extend(between.into_iter().map(|(_, place)| place));
    }
    made.dedup();
    if made.len() > 1 && made.first() == made.last() {
        made.pop();
    }
    made
}

/// A line of parameters on its surface.
pub(super) struct Trim<'a> {
    shape: &'a TrimmedSurface,
    curve: &'a AnyCurve,
}

/// Samples are raised by this share: a smooth line may exceed them by terms of the next order.
const MARGIN: f64 = 1.05;

/// Chords of a whole line at least: fewer would make a circle a line.
const FEWEST: usize = 8;

/// Halvings of a part of a line.
const DEEPEST: u32 = 20;

/// Places along each piece of a line between which crossings of cells are sought.
const SOUGHT: u32 = 32;

impl<'a> Trim<'a> {
    pub(super) fn new(shape: &'a TrimmedSurface, curve: &'a AnyCurve) -> Self {
        Self { shape, curve }
    }

    /// Ends of the pieces of the line: its joints, and where it enters another cell.
    fn stops(&self) -> Vec<f64> {
        let domain = self.curve.domain();
        let joints = self.curve.joints().into_iter();
        let ends: Vec<f64> =
            std::iter::once(domain.start).chain(joints).chain(std::iter::once(domain.end)).collect();
        let mut stops = vec![ends[0]];
        for pair in ends.windows(2) {
            let at = |k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(SOUGHT);
            let first = stops.len();
            for k in 0..SOUGHT {
                self.crossings((at(k), at(k + 1)), &mut stops);
            }
            stops[first..].sort_by(f64::total_cmp);
            stops.push(pair[1]);
        }
        let near = 1e-12 * domain.span();
        stops.dedup_by(|next, kept| *next - *kept <= near);
        *stops.last_mut().expect("it has ends") = domain.end;
        stops
    }

    /// Adds the parameters where the line crosses lines between cells, each within rounding.
    fn crossings(&self, (from, to): (f64, f64), stops: &mut Vec<f64>) {
        let ends = [from, to].map(|t| self.place(t));
        for (axis, direction) in self.shape.cells.directions.iter().enumerate() {
            for line in direction.between(ends[0][axis], ends[1][axis]) {
                stops.push(self.crossing((from, to), axis, direction, line));
            }
        }
    }

    fn crossing(&self, (from, to): (f64, f64), axis: usize, direction: &Direction, line: Number) -> f64 {
        const HALVINGS: u32 = 60;
        let at = direction.line(line);
        let beyond = |t: f64| self.curve.point(t)[axis] > at;
        let (mut low, mut high) = (from, to);
        let rising = beyond(to);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if beyond(middle) == rising { high = middle } else { low = middle }
        }
        high
    }

    /// The place in the plane; what lies beside a line between cells by rounding, on it.
    pub(super) fn place(&self, t: f64) -> DVec2 {
        self.shape.cells.snapped(self.curve.evaluate(t, Side::After).point.truncate())
    }

    /// The most that chords between stations leave out.
    pub(super) fn left_out(&self, stations: &[f64]) -> f64 {
        stations.windows(2).map(|chord| self.deviation(chord[0], chord[1])).fold(0.0, f64::max)
    }

    /// Parameters of a line that crosses no other cell, its ends included.
    pub(super) fn whole(&self, cut: Cut, limit: u64) -> Result<Vec<f64>, TessellateError> {
        let domain = self.curve.domain();
        self.stations((domain.start, domain.end), (cut, 1), limit)
    }

    fn point(&self, t: f64) -> DVec3 {
        self.shape.point(self.place(t))
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
    fn stations(
        &self,
        piece: (f64, f64),
        (cut, fewest): (Cut, usize),
        limit: u64,
    ) -> Result<Vec<f64>, TessellateError> {
        let fine = self.fine(piece, cut, limit)?;
        let weights: Vec<f64> = fine.windows(2).map(|pair| self.deviation(pair[0], pair[1]).sqrt()).collect();
        let total: f64 = weights.iter().sum();
        let straight = total <= 1e-9 * self.point(piece.0).distance(self.point(piece.1)).sqrt();
        let mut count = match cut {
            Cut::Within(_) if straight => 1,
            Cut::Within(tolerance) => floor_index((total / tolerance.sqrt() - 1e-6).ceil()).max(fewest),
            Cut::Into(count) => count as usize,
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

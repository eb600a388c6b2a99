//! Iso-lines of bilinear fields: in each cell arcs of hyperbolas, in closed form.
//!
//! Notation: in a cell f(s, t) = a (1-s)(1-t) + b s (1-t) + c (1-s) t + d s t, less the threshold. With a center where
//! both derivatives vanish, (s - s0)(t - t0) is constant along the line, so the point of an arc whose tangent is parallel
//! to a chord lies at the geometric means of the distances of its ends from the center: there it is farthest from it.
//! Source of the pairing at saddles: G. Nielson and B. Hamann, "The asymptotic decider", 1991.

use glam::DVec2;

use super::{Pieces, Side, Step, Trace, away_from_chord};
use crate::geometry::map::GridField;

pub(super) fn trace(field: &GridField, how: &Trace) -> Pieces {
    let mut pieces = Pieces::default();
    let (columns, rows) = (field.columns(), field.rows());
    let samples = field.samples();
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            let at = j * columns + i;
            let corners = [at, at + 1, at + columns, at + columns + 1].map(|at| samples[at] - how.threshold);
            let cell = Cell { origin: [i as f64, j as f64], corners };
            let above = corners.iter().filter(|value| **value >= 0.0).count();
            if above != 0 && above != 4 {
                cell.trace(how, &mut pieces);
            }
            if above != 0 {
                let on = [(j == 0), (j + 2 == rows), (i == 0), (i + 2 == columns)];
                Side::ALL
                    .into_iter()
                    .zip(on)
                    .filter(|(_, on)| *on)
                    .for_each(|(side, _)| cell.border(side, &mut pieces));
            }
        }
    }
    pieces
}

/// A cell and its corners less the threshold, as in the module's notation.
struct Cell {
    origin: Step,
    corners: [f64; 4],
}

/// The sides of a cell counter-clockwise over columns and rows, each as two corners.
const AROUND: [[usize; 2]; 4] = [[0, 1], [1, 3], [3, 2], [2, 0]];

/// Where each corner lies.
const PLACES: [Step; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

impl Cell {
    fn above(&self, corner: usize) -> bool {
        self.corners[corner] >= 0.0
    }

    /// Where a side whose corners differ is crossed, in the cell; the same from both cells at it.
    fn crossing(&self, [one, other]: [usize; 2]) -> Step {
        let (low, high) = (one.min(other), one.max(other));
        let part = self.corners[low] / (self.corners[low] - self.corners[high]);
        let (from, to) = (PLACES[low], PLACES[high]);
        [0, 1].map(|k| if from[k] == to[k] { from[k] } else { part })
    }

    fn at(&self, place: Step) -> Step {
        [self.origin[0] + place[0], self.origin[1] + place[1]]
    }

    fn border(&self, side: Side, pieces: &mut Pieces) {
        let (corners, along) = match side {
            Side::Top => ([0, 1], 0),
            Side::Bottom => ([2, 3], 0),
            Side::Left => ([0, 2], 1),
            Side::Right => ([1, 3], 1),
        };
        let ends = [self.origin[along], self.origin[along] + 1.0];
        let crossing = || self.at(self.crossing(corners))[along];
        match corners.map(|corner| self.above(corner)) {
            [true, true] => pieces.above(side, ends[0], ends[1]),
            [true, false] => pieces.above(side, ends[0], crossing()),
            [false, true] => pieces.above(side, crossing(), ends[1]),
            [false, false] => {}
        }
    }

    fn trace(&self, how: &Trace, pieces: &mut Pieces) {
        let changes = AROUND.map(|[from, to]| (self.above(from), self.above(to)));
        let joined = self.center_is_above();
        for (k, change) in changes.into_iter().enumerate() {
            // The border of the part above leaves the cell's side where that part ends.
            if change != (true, false) {
                continue;
            }
            let entry = |at: &usize| changes[*at % 4] == (false, true);
            let found = if joined { (k + 1..k + 4).find(entry) } else { (k + 1..k + 4).rev().find(entry) };
            let Some(found) = found else { continue };
            let ends = [self.crossing(AROUND[k]), self.crossing(AROUND[found % 4])];
            let mut arc = vec![self.at(ends[0])];
            self.arc(ends, how, &mut arc);
            pieces.arcs.push(arc);
        }
    }

    /// Whether the parts above are joined in the middle, where opposite corners are on equal sides.
    fn center_is_above(&self) -> bool {
        let [a, b, c, d] = self.corners;
        if self.above(0) { a * d >= b * c } else { a * d <= b * c }
    }

    /// Appends the points of the arc between two places, the first left out.
    fn arc(&self, [from, to]: [Step; 2], how: &Trace, points: &mut Vec<Step>) {
        /// Halvings of an arc; each quarters its distance from its chords.
        const DEEPEST: u32 = 24;
        let [a, b, c, d] = self.corners;
        let twist = a - b - c + d;
        let center = [(a - c) / twist, (a - b) / twist];
        let metres = |place: Step| DVec2::from_array(place) * how.step;
        let mut open = vec![(from, to, 0)];
        while let Some((from, to, depth)) = open.pop() {
            let middle = self.farthest([from, to], center);
            let away = away_from_chord(metres(middle), metres(from), metres(to));
            if depth < DEEPEST && away > how.tolerance / 2.0 {
                open.extend([(middle, to, depth + 1), (from, middle, depth + 1)]);
            } else {
                points.push(self.at(to));
            }
        }
    }

    /// The point of the arc between two places that is farthest from their chord; without a center a place on it.
    fn farthest(&self, [from, to]: [Step; 2], center: Step) -> Step {
        let straight = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
        if !center[0].is_finite() || !center[1].is_finite() {
            return straight;
        }
        let mean = |k: usize| {
            let (one, other) = (from[k] - center[k], to[k] - center[k]);
            let size = (one * other).max(0.0).sqrt();
            (center[k] + if one + other < 0.0 { -size } else { size })
                .clamp(from[k].min(to[k]), from[k].max(to[k]))
        };
        let [s, t] = [mean(0), mean(1)];
        // Far centers cost digits: one of both follows from the other, along the steeper slope.
        let [a, b, c, d] = self.corners;
        let (by_s, by_t) = ((b - a) * (1.0 - t) + (d - c) * t, (c - a) * (1.0 - s) + (d - b) * s);
        if by_s == 0.0 && by_t == 0.0 {
            return [s, t];
        }
        if by_t.abs() >= by_s.abs() {
            let value = a * (1.0 - s) + b * s;
            [s, (-value / by_t).clamp(0.0, 1.0)]
        } else {
            let value = a * (1.0 - t) + c * t;
            [(-value / by_s).clamp(0.0, 1.0), t]
        }
    }
}

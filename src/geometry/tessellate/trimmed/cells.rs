//! The parameters of a surface as cells: rectangles that no edge of the surface crosses, which come round where the
//! surface is closed.
//!
//! Outlines are drawn in the endless plane: on a closed surface they may run over its seam. Lines between cells are
//! numbered through all turns, so that what lies on a line lies on it exactly, on both sides and at both ends of a turn.

use glam::DVec2;

use crate::geometry::curve::Domain;
use crate::geometry::number::floor_index;
use crate::geometry::surface::{AnySurface, Surface as _, closed_directions};

/// A line or a cell of a direction, counted through all turns: cell k lies between lines k and k + 1.
pub(super) type Number = i64;

/// One direction of parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Direction {
    /// The ends of the domain and the joints between them, increasing.
    lines: Vec<f64>,
    /// Whether the last line is the first again.
    closed: bool,
}

/// What is nearer to a line than this share of the domain lies on it.
const ON_LINE: f64 = 1e-9;

impl Direction {
    fn new(domain: Domain, joints: Vec<f64>, closed: bool) -> Self {
        let inner = joints.into_iter();
        let lines = std::iter::once(domain.start).chain(inner).chain(std::iter::once(domain.end)).collect();
        Self { lines, closed }
    }

    /// Adds a line where an outline that goes all around starts and ends: there it meets itself.
    fn add_start(&mut self, (low, high): (f64, f64)) {
        if self.closed && (high - low - self.span()).abs() <= 2.0 * self.near() && self.on(low).is_none() {
            let cell = self.cell(low);
            self.lines.insert(self.same_cell(cell) + 1, self.folded(low, cell));
        }
    }

    /// Cells of a turn.
    pub(super) fn count(&self) -> usize {
        self.lines.len() - 1
    }

    fn counted(&self) -> Number {
        Number::try_from(self.count()).unwrap_or(Number::MAX)
    }

    pub(super) fn span(&self) -> f64 {
        self.lines[self.count()] - self.lines[0]
    }

    /// What counts as one place.
    pub(super) fn near(&self) -> f64 {
        ON_LINE * self.span()
    }

    /// After how much it comes round.
    pub(super) fn period(&self) -> Option<f64> {
        self.closed.then(|| self.span())
    }

    /// A line of the first turn.
    pub(super) fn own(&self, line: usize) -> f64 {
        self.lines[line]
    }

    /// A line of any turn.
    pub(super) fn line(&self, number: Number) -> f64 {
        let count = self.counted();
        if (0..=count).contains(&number) {
            return self.lines[self.subscript(number, true)];
        }
        let turns = number.div_euclid(count);
        self.lines[self.subscript(number, false)] + turns as f64 * self.span()
    }

    fn subscript(&self, number: Number, first_turn: bool) -> usize {
        let within = if first_turn { number } else { number.rem_euclid(self.counted()) };
        usize::try_from(within).expect("a remainder is not negative")
    }

    /// The line of the first turn that a line of any turn is in space; both ends of a closed direction are the first.
    pub(super) fn same_line(&self, number: Number) -> usize {
        self.subscript(number, !self.closed)
    }

    /// The cell of the first turn that a cell of any turn is.
    pub(super) fn same_cell(&self, number: Number) -> usize {
        self.subscript(number, !self.closed)
    }

    /// Turns before that of a cell.
    fn turns(&self, number: Number) -> f64 {
        if self.closed { number.div_euclid(self.counted()) as f64 } else { 0.0 }
    }

    /// The cell that holds a place; at a line the one after it, beyond an open end the last.
    pub(super) fn cell(&self, x: f64) -> Number {
        let turns = if self.closed { ((x - self.lines[0]) / self.span()).floor() } else { 0.0 };
        let within = x - turns * self.span();
        let after = self.lines.partition_point(|line| *line <= within);
        let cell = after.saturating_sub(1).min(self.count() - 1);
        let number = Number::try_from(cell).unwrap_or(0);
        // A number of turns that is no index is beyond what any outline reaches.
        let whole = Number::try_from(floor_index(turns.abs())).unwrap_or(0);
        number + self.counted() * if turns < 0.0 { -whole } else { whole }
    }

    /// The line that a place lies on.
    pub(super) fn on(&self, x: f64) -> Option<Number> {
        let cell = self.cell(x);
        let lines = [cell - 1, cell, cell + 1, cell + 2].into_iter();
        let mut known = lines.filter(|line| self.closed || (0..=self.counted()).contains(line));
        known.find(|line| (self.line(*line) - x).abs() <= self.near())
    }

    /// Lines strictly between two places, from the lower to the upper.
    pub(super) fn between(&self, one: f64, other: f64) -> Vec<Number> {
        let (low, high) = (one.min(other), one.max(other));
        let last = if self.closed { self.cell(high) + 1 } else { self.counted() };
        let mut found = Vec::new();
        let mut number = self.cell(low);
        while number <= last {
            let x = self.line(number);
            if x > low && x < high {
                found.push(number);
            }
            number += 1;
        }
        found
    }

    /// The parameter of the surface at a place of a cell.
    pub(super) fn folded(&self, x: f64, cell: Number) -> f64 {
        let own = self.same_cell(cell);
        let (start, end) = (self.lines[own], self.lines[own + 1]);
        if x == self.line(cell) {
            start
        } else if x == self.line(cell + 1) {
            end
        } else {
            (x - self.turns(cell) * self.span()).clamp(start, end)
        }
    }
}

/// Both directions: 0 is u, 1 is v.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    pub(super) directions: [Direction; 2],
}

impl Cells {
    /// The cells of a surface on which outlines with these ranges are drawn.
    pub(super) fn new(surface: &AnySurface, outlines: impl Iterator<Item = (DVec2, DVec2)>) -> Self {
        let [closed_u, closed_v] = closed_directions(surface);
        let mut directions = [
            Direction::new(surface.domain_u(), surface.joints_u(), closed_u),
            Direction::new(surface.domain_v(), surface.joints_v(), closed_v),
        ];
        for (low, high) in outlines {
            directions.iter_mut().enumerate().for_each(|(axis, own)| own.add_start((low[axis], high[axis])));
        }
        Self { directions }
    }

    /// A place of the plane; what lies beside a line by rounding, on it.
    pub(super) fn snapped(&self, place: DVec2) -> DVec2 {
        let [u, v] = &self.directions;
        let on = |direction: &Direction, x: f64| direction.on(x).map_or(x, |line| direction.line(line));
        DVec2::new(on(u, place.x), on(v, place.y))
    }

    /// The cell of a place, counted through all turns.
    pub(super) fn cell(&self, place: DVec2) -> [Number; 2] {
        [self.directions[0].cell(place.x), self.directions[1].cell(place.y)]
    }

    /// The parameters of the surface at a place of a cell.
    pub(super) fn folded(&self, place: DVec2, cell: [Number; 2]) -> DVec2 {
        let [u, v] = &self.directions;
        DVec2::new(u.folded(place.x, cell[0]), v.folded(place.y, cell[1]))
    }

    /// The parameters of the surface at any place of the plane.
    pub(super) fn parameters(&self, place: DVec2) -> DVec2 {
        self.folded(place, self.cell(place))
    }
}

//! The outlines of a trimmed surface, split into the border of what is left of each cell.
//!
//! Edges of the outlines go to the cells they lie in. Where what is left goes on over a side of a cell, the side is a
//! border too: it is cut once, at places that both cells share, so that their triangles meet without a crack.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::TrimmedSurface;
use super::cells::{Cells, Number};
use super::lines::{Cut, Loops, Trim};
use crate::geometry::curve::{AnyCurve, Polyline};
use crate::geometry::tessellate::TessellateError;

/// What is left of one cell: edges between parameters of the surface.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// Number of the cell in u and in v.
    pub(super) cell: [usize; 2],
    pub(super) edges: Vec<[DVec2; 2]>,
}

/// A side between two cells: its direction (0 is a line of constant u), its line, and its cell along the line.
type Side = (usize, usize, usize);

/// For each side, between its stops, the places of its chords; none where nothing is left on either hand.
type Sides = BTreeMap<Side, Vec<Vec<f64>>>;

/// Splits outlines; what their chords and those of the sides leave out is noted in `loops`.
///
/// # Errors
/// More chords than `limit`.
pub(super) fn parts(
    shape: &TrimmedSurface,
    loops: &mut Loops,
    cut: Cut,
    limit: u64,
) -> Result<Vec<Part>, TessellateError> {
    let mut split =
        Split { cells: &shape.cells, loops: &loops.all, edges: BTreeMap::new(), stops: BTreeMap::new() };
    split.sort_edges();
    split.merge_stops();
    let (sides, deviation) = split.sides(shape, cut, limit)?;
    let made = split.close(&sides);
    loops.deviation = loops.deviation.max(deviation);
    Ok(made)
}

struct Split<'a> {
    cells: &'a Cells,
    /// Places on lines lie on them exactly, and no edge crosses a line.
    loops: &'a [Vec<DVec2>],
    /// Edges inside of cells, by the cell.
    edges: BTreeMap<[usize; 2], Vec<[DVec2; 2]>>,
    /// Parameters along each side where outlines stand.
    stops: BTreeMap<Side, Vec<f64>>,
}

impl Split<'_> {
    fn sort_edges(&mut self) {
        for places in self.loops {
            for (k, from) in places.iter().enumerate() {
                self.sort_edge(*from, places[(k + 1) % places.len()]);
            }
        }
    }

    fn sort_edge(&mut self, from: DVec2, to: DVec2) {
        let cell = self.cells.cell(from.midpoint(to));
        let ends = [from, to].map(|place| self.cells.folded(place, cell));
        let mut along_line = false;
        for (axis, direction) in self.cells.directions.iter().enumerate() {
            let other = 1 - axis;
            let beside = self.cells.directions[other].same_cell(cell[other]);
            let on = [from, to].map(|place| direction.on(place[axis]));
            for (line, end) in on.iter().zip(ends) {
                if let Some(line) = line {
                    self.stops
                        .entry((axis, direction.same_line(*line), beside))
                        .or_default()
                        .push(end[other]);
                }
            }
            along_line |= on[0].is_some() && on[0] == on[1];
        }
        if !along_line {
            let [u, v] = &self.cells.directions;
            let own = [u.same_cell(cell[0]), v.same_cell(cell[1])];
            self.edges.entry(own).or_default().push(ends);
        }
    }

    /// Stops that are one place become one; edges that end there end at it.
    fn merge_stops(&mut self) {
        let cells = self.cells;
        for ((axis, _, beside), stops) in &mut self.stops {
            let along = &cells.directions[1 - *axis];
            let (start, end) = (along.own(*beside), along.own(*beside + 1));
            let near = along.near();
            stops.retain(|stop| stop - start > near && end - stop > near);
            stops.sort_by(f64::total_cmp);
            stops.dedup_by(|next, kept| *next - *kept <= near);
        }
        let stops = &self.stops;
        for (cell, edges) in &mut self.edges {
            for place in edges.iter_mut().flatten() {
                for axis in 0..2 {
                    *place = settled(cells, stops, (*cell, axis), *place);
                }
            }
        }
    }

    /// The places of all sides that outlines or what is left of the surface touch, and the most that their chords leave out.
    fn sides(&self, shape: &TrimmedSurface, cut: Cut, limit: u64) -> Result<(Sides, f64), TessellateError> {
        let mut deviation = 0.0_f64;
        let mut made = BTreeMap::new();
        let [u, v] = &self.cells.directions;
        for (axis, direction) in self.cells.directions.iter().enumerate() {
            let along = &self.cells.directions[1 - axis];
            let lines = direction.count() + usize::from(direction.period().is_none());
            for side in (0..lines).flat_map(|line| (0..along.count()).map(move |beside| (axis, line, beside)))
            {
                let mut pieces = Vec::new();
                let stops = self.stops_of(side);
                for pair in stops.windows(2) {
                    let place = |t: f64| axes(axis, direction.own(side.1), t);
                    let middle = f64::midpoint(pair[0], pair[1]);
                    let number = Number::try_from(side.1).unwrap_or(Number::MAX);
                    if !self.is_left((axis, number, true), middle)
                        && !self.is_left((axis, number, false), middle)
                    {
                        pieces.push(Vec::new());
                        continue;
                    }
                    let ends =
                        [place(pair[0]), place(pair[1])].map(|place| DVec3::new(place.x, place.y, 0.0));
                    let line = Polyline::new(ends.to_vec(), false).expect("two places that lie apart");
                    let line = AnyCurve::Polyline(line);
                    let trim = Trim::new(shape, &line);
                    let cut = cut.share((pair[1] - pair[0]) / if axis == 0 { v.span() } else { u.span() });
                    let stations = trim.whole(cut, limit)?;
                    deviation = deviation.max(trim.left_out(&stations));
                    let last = stations.len() - 1;
                    let exact = |(k, t): (usize, &f64)| match k {
                        0 => pair[0],
                        _ if k == last => pair[1],
                        _ => trim.place(*t)[1 - axis],
                    };
                    pieces.push(stations.iter().enumerate().map(exact).collect());
                }
                made.insert(side, pieces);
            }
        }
        Ok((made, deviation))
    }

    /// The ends of a side and the stops between them.
    fn stops_of(&self, side: Side) -> Vec<f64> {
        let along = &self.cells.directions[1 - side.0];
        let inner = self.stops.get(&side).map_or(&[][..], Vec::as_slice).iter().copied();
        let ends = (along.own(side.2), along.own(side.2 + 1));
        std::iter::once(ends.0).chain(inner).chain(std::iter::once(ends.1)).collect()
    }

    /// Whether a place just before or after a line belongs to what is left: an odd number of edges lies beyond it, over all
    /// turns of the surface.
    fn is_left(&self, (axis, line, after): (usize, Number, bool), along: f64) -> bool {
        let (direction, other) = (&self.cells.directions[axis], &self.cells.directions[1 - axis]);
        let count = Number::try_from(direction.count()).unwrap_or(Number::MAX);
        let mut odd = false;
        for turn in turns(self.loops, axis, direction.period().map(|period| (direction.own(0), period))) {
            let x = direction.line(line + turn * count);
            for turn in turns(self.loops, 1 - axis, other.period().map(|period| (other.own(0), period))) {
                let y = along + turn as f64 * other.period().unwrap_or(0.0);
                for places in self.loops {
                    for (k, from) in places.iter().enumerate() {
                        let to = places[(k + 1) % places.len()];
                        let crosses = (from[1 - axis] <= y) != (to[1 - axis] <= y);
                        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
                        odd ^= crosses && low >= x && (high > x || !after);
                    }
                }
            }
        }
        odd
    }

    /// Adds the sides over which what is left goes on.
    fn close(mut self, sides: &Sides) -> Vec<Part> {
        for ((axis, line, beside), pieces) in sides {
            let direction = &self.cells.directions[*axis];
            let stops = self.stops_of((*axis, *line, *beside));
            for (pair, piece) in stops.windows(2).zip(pieces) {
                if piece.is_empty() {
                    continue;
                }
                let middle = f64::midpoint(pair[0], pair[1]);
                let number = Number::try_from(*line).unwrap_or(Number::MAX);
                for after in [false, true] {
                    let Some(cell) = beyond(direction.count(), direction.period().is_some(), *line, after)
                    else {
                        continue;
                    };
                    if !self.is_left((*axis, number, after), middle) {
                        continue;
                    }
                    let at = direction.own(if after { cell } else { cell + 1 });
                    let own = if *axis == 0 { [cell, *beside] } else { [*beside, cell] };
                    let edges = self.edges.entry(own).or_default();
                    edges.extend(
                        piece.windows(2).map(|pair| [axes(*axis, at, pair[0]), axes(*axis, at, pair[1])]),
                    );
                }
            }
        }
        self.edges.into_iter().map(|(cell, edges)| Part { cell, edges }).collect()
    }
}

/// The cell of the first turn before or after a line.
fn beyond(count: usize, closed: bool, line: usize, after: bool) -> Option<usize> {
    match (after, line) {
        (true, line) if line < count => Some(line),
        (true, _) => closed.then_some(0),
        (false, 0) => closed.then(|| count - 1),
        (false, line) => Some(line - 1),
    }
}

/// A place by its coordinate in a direction and that in the other.
fn axes(axis: usize, at: f64, along: f64) -> DVec2 {
    if axis == 0 { DVec2::new(at, along) } else { DVec2::new(along, at) }
}

/// A place on a side, at the stop that stands for it.
fn settled(
    cells: &Cells,
    stops: &BTreeMap<Side, Vec<f64>>,
    (cell, axis): ([usize; 2], usize),
    place: DVec2,
) -> DVec2 {
    let (direction, along) = (&cells.directions[axis], &cells.directions[1 - axis]);
    let line = if place[axis] == direction.own(cell[axis]) {
        cell[axis]
    } else if place[axis] == direction.own(cell[axis] + 1) {
        direction.same_line(Number::try_from(cell[axis] + 1).unwrap_or(Number::MAX))
    } else {
        return place;
    };
    let (beside, t) = (cell[1 - axis], place[1 - axis]);
    let ends = [along.own(beside), along.own(beside + 1)];
    let own = stops.get(&(axis, line, beside)).map_or(&[][..], Vec::as_slice);
    let nearest = ends.iter().chain(own).copied().min_by(|a, b| (a - t).abs().total_cmp(&(b - t).abs()));
    let nearest = nearest.filter(|stop| (stop - t).abs() <= along.near()).unwrap_or(t);
    axes(axis, place[axis], nearest)
}

/// Turns by which a place of the first turn must be moved to meet all outlines.
fn turns(loops: &[Vec<DVec2>], axis: usize, closed: Option<(f64, f64)>) -> std::ops::RangeInclusive<Number> {
    let Some((start, period)) = closed else { return 0..=0 };
    let all = loops.iter().flatten().map(|place| (place[axis] - start) / period);
    let (low, high) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let whole = |x: f64| (-64..=64).find(|turn: &Number| x < *turn as f64 + 1.0).unwrap_or(64);
    whole(low) - 1..=whole(high) + 1
}

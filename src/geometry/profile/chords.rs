//! Closed curves as chords, and which chord passes through a place.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{CHORDS, ProfileError};
use crate::geometry::curve::AnyCurve;
use crate::geometry::number::floor_index;
use crate::geometry::tessellate::{Density, Station, discretize};

/// A closed curve and its chords.
pub(super) struct Loop {
    pub(super) curve: AnyCurve,
    pub(super) stations: Vec<Station>,
}

impl Loop {
    pub(super) fn new(curve: AnyCurve, accuracy: f64) -> Result<Self, ProfileError> {
        let stations = discretize(&curve, Density::Tolerance(accuracy), CHORDS)?;
        Ok(Self { curve, stations })
    }

    /// How many chords there are.
    pub(super) fn count(&self) -> usize {
        self.stations.len() - 1
    }

    /// The ends of a chord.
    pub(super) fn chord(&self, step: usize) -> [DVec2; 2] {
        [self.stations[step].point.truncate(), self.stations[step + 1].point.truncate()]
    }

    /// Where chords meet, each place once.
    pub(super) fn places(&self) -> Vec<DVec2> {
        self.stations[..self.count()].iter().map(|station| station.point.truncate()).collect()
    }
}

/// The largest extent of all loops.
pub(super) fn reach(loops: &[Loop]) -> f64 {
    let places = || loops.iter().flat_map(|one| &one.stations).map(|station| station.point.truncate());
    let low = places().reduce(DVec2::min).unwrap_or_default();
    let high = places().reduce(DVec2::max).unwrap_or_default();
    (high - low).length()
}

/// A chord of a loop, and whether it is run through forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) of: usize,
    pub(super) step: usize,
    pub(super) forward: bool,
}

/// Chords by the cells of a grid that they pass.
pub(super) struct Chords<'a> {
    loops: &'a [Loop],
    cells: BTreeMap<(usize, usize), Vec<(usize, usize)>>,
    low: DVec2,
    cell: f64,
    /// How far a place on a chord may be away from it: what rounding does.
    near: f64,
}

/// Cells along the largest extent.
const CELLS: f64 = 32.0;

impl<'a> Chords<'a> {
    pub(super) fn new(loops: &'a [Loop], size: f64) -> Self {
        let places = loops.iter().flat_map(|one| &one.stations).map(|station| station.point.truncate());
        let near = 1e-9 * size;
        let low = places.reduce(DVec2::min).unwrap_or_default() - near;
        let mut chords = Self { loops, cells: BTreeMap::new(), low, cell: size / CELLS, near };
        for (of, one) in loops.iter().enumerate() {
            for step in 0..one.count() {
                let [a, b] = one.chord(step);
                let (first, last) = (chords.cell_of(a.min(b) - near), chords.cell_of(a.max(b) + near));
                for x in first.0..=last.0 {
                    for y in first.1..=last.1 {
                        chords.cells.entry((x, y)).or_default().push((of, step));
                    }
                }
            }
        }
        chords
    }

    fn cell_of(&self, place: DVec2) -> (usize, usize) {
        let cell = ((place - self.low) / self.cell).max(DVec2::ZERO);
        (floor_index(cell.x), floor_index(cell.y))
    }

    /// The chord that an edge of a result with this middle and direction lies on: one that goes on from `before` where
    /// there is a choice, else the first.
    pub(super) fn at(&self, middle: DVec2, along: DVec2, before: Option<Place>) -> Option<Place> {
        let all = self.cells.get(&self.cell_of(middle))?;
        let found: Vec<(f64, Place)> = all
            .iter()
            .map(|(of, step)| {
                let [a, b] = self.loops[*of].chord(*step);
                let away = crate::geometry::planar::distance_to_segment(middle, [a, b]);
                (away, Place { of: *of, step: *step, forward: (b - a).dot(along) > 0.0 })
            })
            .collect();
        let least = found.iter().map(|(away, _)| *away).fold(f64::INFINITY, f64::min);
        let close = || found.iter().filter(|(away, _)| *away <= least + self.near).map(|(_, place)| *place);
        let on = before.and_then(|before| close().find(|place| self.steps(before, *place).is_some()));
        on.or_else(|| close().next())
    }

    /// How many chords further one place is than another, where it goes on from it: 0 or 1.
    pub(super) fn steps(&self, from: Place, to: Place) -> Option<usize> {
        if (from.of, from.forward) != (to.of, to.forward) {
            return None;
        }
        let count = self.loops[from.of].count();
        let next = if from.forward { (from.step + 1) % count } else { (from.step + count - 1) % count };
        if from.step == to.step { Some(0) } else { (to.step == next).then_some(1) }
    }
}

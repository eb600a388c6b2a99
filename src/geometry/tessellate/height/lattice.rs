//! The grid on which a field is searched.
//!
//! A bilinear field is searched on its own grid, where it is bilinear exactly. A spline is searched on a finer grid: in a
//! cell of side h a function is within `h^2 / 8 (max |f_xx| + max |f_yy|)` of the bilinear function through its corners
//! (linear interpolation in one variable, then in the other, whose norm is 1; P. Davis, "Interpolation and
//! Approximation", 1963, section 3.1). Corners of triangles may stand on a still finer grid, of *units*.

use std::borrow::Cow;

use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};

use super::chain::Chain;
use super::delaunay::Place;
use super::greedy::Floor;
use super::ground::{Ground, Value as _};
use crate::geometry::map::GridField;
use crate::geometry::number::{floor_count, size};

/// Values at the nodes of a grid over a function.
pub(super) struct Lattice<'f, G: Ground = GridField> {
    pub(super) ground: &'f G,
    /// Nodes in a row.
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) values: Cow<'f, [G::Value]>,
    /// Nodes to a step of the field.
    pub(super) refine: u32,
    /// Units to a step between nodes.
    pub(super) units: i32,
    /// How far the function may be from the bilinear function between nodes.
    pub(super) slack: f64,
}

/// The most bits of a coordinate.
const BITS: u32 = 29;

/// The least power of two that is no less than a number, and at least 1.
fn power_of_two(number: f64) -> u64 {
    let mut power = 1_u64;
    while (power as f64) < number && power < 1 << 40 {
        power *= 2;
    }
    power
}

/// The greatest sum of the bounds on second derivatives of a cell.
pub(super) fn most_bend(field: &GridField) -> f64 {
    let cells = (0..field.rows() - 1).flat_map(|j| (0..field.columns() - 1).map(move |i| (i, j)));
    cells.map(|(i, j)| field.bends(i, j)).fold(0.0, |most, (x, y)| most.max(x + y))
}

/// Steps into which those of a spline are cut, for slack of at most an eighth of a tolerance.
pub(super) fn refinement(bend: f64, tolerance: f64) -> u64 {
    power_of_two((bend / tolerance).sqrt())
}

impl<'f, G: Ground> Lattice<'f, G> {
    /// The samples themselves.
    pub(super) fn coarse(ground: &'f G) -> Self {
        let grid = ground.grid();
        Self {
            ground,
            columns: grid.columns(),
            rows: grid.rows(),
            values: ground.samples(),
            refine: 1,
            units: 1,
            slack: ground.bend() / 8.0,
        }
    }

    /// A grid fine enough for a tolerance everywhere, `finer` times finer in units than must be. Where there would be
    /// more than `limit` nodes or units, their number.
    pub(super) fn fine(ground: &'f G, tolerance: f64, finer: i32, limit: u64) -> Result<Self, u64> {
        Self::cut(ground, (tolerance, 1), finer, limit)
    }

    /// The same with at least so many nodes to a step.
    pub(super) fn cut(
        ground: &'f G,
        (tolerance, least): (f64, u64),
        finer: i32,
        limit: u64,
    ) -> Result<Self, u64> {
        let bend = ground.bend();
        let refine = refinement(bend, tolerance).max(least);
        let mut lattice = if refine > 1 { Self::bare(ground) } else { Self::coarse(ground) };
        if refine > 1 {
            let grid = ground.grid();
            let steps = [grid.columns() - 1, grid.rows() - 1].map(|steps| steps as u64);
            let nodes = steps.map(|steps| steps.saturating_mul(refine).saturating_add(1));
            let all = nodes[0].saturating_mul(nodes[1]);
            if all > limit {
                return Err(all);
            }
            lattice = Self::refined(ground, refine as f64, nodes.map(size));
            lattice.slack = bend / 8.0 / (refine * refine) as f64;
        }
        let rest = 0.9 * (tolerance - lattice.slack);
        let units = power_of_two((lattice.most_twist() / (4.0 * rest)).sqrt());
        let units = units.saturating_mul(u64::from(finer.unsigned_abs()));
        lattice.set_units(units)?;
        Ok(lattice)
    }

    /// The same with units so fine that places of borders are whole, and those of so many parts of a step.
    pub(super) fn holding(mut self, chains: &[Chain; 4], grain: u64) -> Result<Self, u64> {
        let finest = chains.iter().map(|chain| chain.refine).fold(grain, u64::max);
        let wanted = finest / u64::from(self.refine).min(finest);
        let units = wanted.max(u64::from(self.units.unsigned_abs()));
        self.set_units(units)?;
        Ok(self)
    }

    /// Units to a step of the field.
    pub(super) fn parts(&self) -> u64 {
        u64::from(self.units.unsigned_abs()) * u64::from(self.refine)
    }

    /// The same with so many units to a step of the field, a power of two no less than now.
    pub(super) fn set_parts(&mut self, parts: u64) -> Result<(), u64> {
        self.set_units(parts / u64::from(self.refine))
    }

    fn set_units(&mut self, units: u64) -> Result<(), u64> {
        let longest = (self.columns.max(self.rows) as u64).saturating_mul(units);
        match i32::try_from(units) {
            Ok(whole) if longest < 1 << BITS => {
                self.units = whole;
                Ok(())
            }
            _ => Err(longest.saturating_mul(longest)),
        }
    }

    /// One without values.
    fn bare(ground: &'f G) -> Self {
        let values = Cow::Owned(Vec::new());
        Self { ground, columns: 0, rows: 0, values, refine: 1, units: 1, slack: 0.0 }
    }

    fn refined(ground: &'f G, refine: f64, [columns, rows]: [usize; 2]) -> Self {
        let mut values = vec![G::Value::default(); columns * rows];
        values.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
            let y = j as f64 / refine;
            for (i, value) in row.iter_mut().enumerate() {
                *value = ground.at(i as f64 / refine, y);
            }
        });
        let refine = floor_count(refine);
        Self { ground, columns, rows, values: Cow::Owned(values), refine, units: 1, slack: 0.0 }
    }

    /// The greatest mixed difference of a cell: by a quarter of it a cell rises above its diagonals' means.
    pub(super) fn most_twist(&self) -> f64 {
        let pairs =
            self.values.chunks_exact(self.columns).zip(self.values.chunks_exact(self.columns).skip(1));
        let twist = |(near, far): (&[G::Value], &[G::Value])| {
            let cells = near.windows(2).zip(far.windows(2));
            cells.map(|(a, b)| (a[0] - a[1] - b[0] + b[1]).size()).fold(0.0, f64::max)
        };
        pairs.map(twist).fold(0.0, f64::max)
    }

    /// The far corner in units.
    pub(super) fn far(&self) -> Place {
        [self.columns, self.rows]
            .map(|count| i32::try_from(count - 1).unwrap_or(i32::MAX).saturating_mul(self.units))
    }

    /// A place in steps of the field.
    pub(super) fn steps(&self, place: Place) -> [f64; 2] {
        place.map(|unit| f64::from(unit) / (f64::from(self.units) * f64::from(self.refine)))
    }

    /// The value at a place.
    pub(super) fn height(&self, place: Place) -> G::Value {
        if let [Some(i), Some(j)] = place.map(|unit| self.node(unit)) {
            return self.values[j * self.columns + i];
        }
        let [x, y] = self.steps(place);
        self.ground.at(x, y)
    }

    /// The value at a place next to a base.
    pub(super) fn standing(&self, place: Place, floor: Option<Floor>, on_line: bool) -> G::Value {
        self.ground.standing(self.steps(place), self.height(place), floor, on_line)
    }

    /// The node at a coordinate, if there is one.
    fn node(&self, unit: i32) -> Option<usize> {
        (unit % self.units == 0).then(|| usize::try_from(unit / self.units).unwrap_or(0))
    }
}

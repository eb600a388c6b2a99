//! Lines of masks on a grid of whole places, such that their chords follow the heights over them.

use glam::DVec2;

use super::HeightMap;
use super::chain::Side;
use super::contour::{Contour, Step, Trace, cancelled, thinned, trace};
use super::delaunay::Place;
use super::greedy::whole;
use super::ground::Ground;
use super::lattice::Lattice;
use super::region::RegionError;
use super::scan::edge;
use crate::geometry::map::{GridField, Interpolation};

/// Lines of one mask.
pub(super) struct Lines {
    pub(super) bit: u32,
    /// Places on the grid of lines; closed where the first is the last.
    pub(super) chains: Vec<Vec<Place>>,
    /// Along each side of the rectangle the parts that are above, as their ends in order.
    pub(super) border: [Vec<i32>; 4],
}

/// Tells the cells that lie wholly at a threshold: they belong to both sides.
pub(super) fn level_cells(field: &GridField, threshold: f64) -> impl Fn(usize, usize) -> bool {
    let scale = field.samples().iter().fold(threshold.abs(), |most, value| most.max(value.abs()));
    let slack = if field.interpolation() == Interpolation::Bicubic { 1e-12 * scale } else { 0.0 };
    move |i, j| {
        let at = j * field.columns() + i;
        let corners = [at, at + 1, at + field.columns(), at + field.columns() + 1];
        let near = |value: f64| (value - threshold).abs() <= slack;
        corners.iter().all(|at| near(field.samples()[*at]))
            && field.net(i, j).is_none_or(|net| net.iter().flatten().all(|value| near(*value)))
    }
}

/// Brings lines onto the grid.
pub(super) struct Scribe<'s, G: Ground> {
    pub(super) shape: &'s HeightMap,
    pub(super) lattices: &'s [Lattice<'s, G>],
    pub(super) rise: f64,
    pub(super) grain: u64,
    pub(super) error: f64,
    pub(super) limit: u64,
}

impl<G: Ground> Scribe<'_, G> {
    pub(super) fn mask(&self, bit: u32, field: &GridField, threshold: f64) -> Result<Lines, RegionError> {
        let step = self.shape.size / DVec2::from_array(field.extent());
        let how = Trace { threshold, step, tolerance: self.error / 2.0, limit: self.limit };
        let Contour { chains, border } = trace(field, &how).map_err(RegionError::TooMany)?;
        let mut found = Vec::new();
        for chain in chains {
            let mut good =
                |a: Step, b: Step| self.rises([self.place(field, a), self.place(field, b)]).is_none();
            let thin = thinned(&chain, &how, &mut good);
            let mut places = vec![self.place(field, thin[0])];
            for step in &thin[1..] {
                self.push(&mut places, self.place(field, *step));
            }
            if places.len() > 1 {
                found.push(places);
            }
        }
        Ok(Lines { bit, chains: found, border: self.border(field, border) })
    }

    /// Lines around all cells that are chosen, along the grid; runs of sides are one chord each.
    pub(super) fn cells(
        &self,
        bit: u32,
        field: &GridField,
        chosen: &dyn Fn(usize, usize) -> bool,
    ) -> Option<Lines> {
        let (columns, rows) = (field.columns() - 1, field.rows() - 1);
        let inside = |i: Option<usize>, j: Option<usize>| match (i, j) {
            (Some(i), Some(j)) if i < columns && j < rows => Some(chosen(i, j)),
            _ => None,
        };
        let mut chains = Vec::new();
        let mut border: [Vec<f64>; 4] = Default::default();
        for j in 0..=rows {
            let change = |i: usize| (inside(Some(i), j.checked_sub(1)), inside(Some(i), Some(j)));
            let side = if j == 0 { Side::Top } else { Side::Bottom };
            for [from, to] in runs(columns, &change, &mut border[side as usize]) {
                chains.push(vec![[from, j as f64], [to, j as f64]]);
            }
        }
        for i in 0..=columns {
            let change = |j: usize| (inside(i.checked_sub(1), Some(j)), inside(Some(i), Some(j)));
            let side = if i == 0 { Side::Left } else { Side::Right };
            for [from, to] in runs(rows, &change, &mut border[side as usize]) {
                chains.push(vec![[i as f64, from], [i as f64, to]]);
            }
        }
        let places = |chain: Vec<Step>| {
            let mut places = vec![self.place(field, chain[0])];
            self.push(&mut places, self.place(field, chain[1]));
            places
        };
        let lines = Lines {
            bit,
            chains: chains.into_iter().map(places).filter(|chain| chain.len() > 1).collect(),
            border: self.border(field, border),
        };
        let any = !lines.chains.is_empty() || lines.border.iter().any(|ends| !ends.is_empty());
        any.then_some(lines)
    }

    /// The nearest place of the grid.
    fn place(&self, field: &GridField, step: Step) -> Place {
        let (from, to) = (field.extent(), self.shape.field.extent());
        [0, 1].map(|k| whole(step[k] * (to[k] / from[k]) * self.grain as f64))
    }

    fn border(&self, field: &GridField, border: [Vec<f64>; 4]) -> [Vec<i32>; 4] {
        let mut number = 0;
        border.map(|ends| {
            let along = usize::from(!Side::ALL[number].is_row());
            number += 1;
            let place = |end: &f64| self.place(field, [*end; 2])[along];
            let mut places: Vec<i32> = ends.iter().map(place).collect();
            places.sort_unstable();
            cancelled(&places)
        })
    }

    /// Appends a chord that follows the heights, broken where it must be.
    fn push(&self, places: &mut Vec<Place>, to: Place) {
        let mut open = vec![to];
        while let Some(end) = open.pop() {
            let Some(from) = places.last().copied() else { return };
            if from == end {
                continue;
            }
            match self.rises([from, end]) {
                Some(middle) if middle != from && middle != end => open.extend([end, middle]),
                _ => places.push(end),
            }
        }
    }

    /// Where a chord is too far from the heights over it, on the grid.
    fn rises(&self, ends: [Place; 2]) -> Option<Place> {
        self.lattices.iter().find_map(|lattice| {
            let factor = lattice.parts() as f64 / self.grain as f64;
            let corner = |place: Place| {
                let place = place.map(|part| whole(f64::from(part) * factor));
                (place, lattice.height(place))
            };
            let worst = edge(lattice, corner(ends[0]), corner(ends[1]));
            (worst.error > self.rise).then(|| worst.place.map(|part| whole(part / factor)))
        })
    }
}

/// Runs of sides between chosen cells and others; where there is no cell beyond, ends of runs on the border.
fn runs(
    count: usize,
    change: &dyn Fn(usize) -> (Option<bool>, Option<bool>),
    border: &mut Vec<f64>,
) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    let extend = |list: &mut Vec<[f64; 2]>, at: usize| match list.last_mut() {
        Some(run) if run[1] == at as f64 => run[1] = (at + 1) as f64,
        _ => list.push([at as f64, (at + 1) as f64]),
    };
    let mut edges = Vec::new();
    for at in 0..count {
        match change(at) {
            (Some(one), Some(other)) if one != other => extend(&mut found, at),
            (None, Some(true)) | (Some(true), None) => extend(&mut edges, at),
            _ => {}
        }
    }
    border.extend(edges.into_iter().flatten());
    found
}

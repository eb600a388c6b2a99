//! How the borders of a map over a curved base are cut, and the lines that keep it sound where it closes in itself.

use glam::DVec3;

use super::super::chain::{Chain, split};
use super::super::lattice::Lattice;
use super::skin::Skin;
use crate::geometry::map::Closes;

/// How borders, rings and lines around are cut, in nodes of the lattice.
pub(super) struct Cut {
    pub(super) chains: [Chain; 4],
    /// Lines along x: their row and their columns; and along y.
    rows: Vec<(usize, Vec<usize>)>,
    columns: Vec<(usize, Vec<usize>)>,
}

impl Cut {
    pub(super) fn new(lattices: &[Lattice<'_, Skin<'_>>], closes: Closes, tolerance: f64) -> Self {
        let (right, bottom) = (lattices[0].columns - 1, lattices[0].rows - 1);
        let thirds = |closed: bool, end: usize| if closed { vec![end / 3, 2 * end / 3] } else { Vec::new() };
        let meridians = thirds(closes.columns, right);
        let circles = thirds(closes.rows, bottom);
        let mut down = vec![0, bottom];
        down.extend(&circles);
        down.extend(closes.first.then_some(1));
        down.extend(closes.last.then_some(bottom - 1));
        down.sort_unstable();
        let mut over = vec![0, right];
        over.extend(&meridians);
        over.sort_unstable();
        let row = |j: usize| (0..=right).map(move |i| (i, j)).collect::<Vec<_>>();
        let column = |i: usize| (0..=bottom).map(move |j| (i, j)).collect::<Vec<_>>();
        let cut = |nodes: Vec<(usize, usize)>, stops: &[usize]| cut_line(lattices, &nodes, stops, tolerance);
        let first = if closes.first { 1 } else { 0 };
        let last = if closes.last { bottom - 1 } else { bottom };
        let (top, top_bound) = cut(row(first), &over);
        let (low, low_bound) = if closes.rows { (top.clone(), top_bound) } else { cut(row(last), &over) };
        let (left, left_bound) = cut(column(0), &down);
        let (far, far_bound) =
            if closes.columns { (left.clone(), left_bound) } else { cut(column(right), &down) };
        let refine = u64::from(lattices[0].refine);
        let chain = |nodes: &[usize], bound: f64| Chain {
            steps: nodes.iter().map(|node| *node as f64 / refine as f64).collect(),
            bound,
            refine,
        };
        let chains = [
            chain(&top, top_bound),
            chain(&low, low_bound),
            chain(&left, left_bound),
            chain(&far, far_bound),
        ];
        let mut rows: Vec<_> = circles.iter().map(|j| (*j, cut(row(*j), &over).0)).collect();
        rows.extend(closes.first.then_some((first, top)));
        rows.extend(closes.last.then_some((last, low)));
        let columns = meridians.iter().map(|i| (*i, cut(column(*i), &down).0)).collect();
        Self { chains, rows, columns }
    }

    /// The lines that stay edges, in units.
    pub(super) fn lines(&self, units: i32) -> Vec<Vec<[i32; 2]>> {
        let unit = |node: usize| i32::try_from(node).unwrap_or(i32::MAX).saturating_mul(units);
        let rows = self.rows.iter().map(|(j, nodes)| nodes.iter().map(|i| [unit(*i), unit(*j)]).collect());
        let columns =
            self.columns.iter().map(|(i, nodes)| nodes.iter().map(|j| [unit(*i), unit(*j)]).collect());
        rows.chain(columns).collect()
    }
}

/// Nodes of a line such that chords are within a tolerance on all lattices, and how near they are.
fn cut_line(
    lattices: &[Lattice<'_, Skin<'_>>],
    nodes: &[(usize, usize)],
    stops: &[usize],
    tolerance: f64,
) -> (Vec<usize>, f64) {
    let mut kept = stops.to_vec();
    let mut bound = 0.0_f64;
    for lattice in lattices {
        let values: Vec<DVec3> = nodes.iter().map(|(i, j)| lattice.values[j * lattice.columns + i]).collect();
        let ranges = kept.windows(2).rev().map(|pair| (pair[0], pair[1])).collect();
        let (found, near) = split(&values, ranges, tolerance);
        kept = found;
        bound = bound.max(near + lattice.slack);
    }
    (kept, bound)
}

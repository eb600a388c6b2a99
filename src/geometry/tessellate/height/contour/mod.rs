//! Iso-lines of a field, to a tolerance.
//!
//! Promise: the chains bound the part of the rectangle where the field is at least a threshold, with that part to their
//! left over columns and rows, and end on the border or close. Every point of the iso-line is within the tolerance of a
//! chain and the other way round, but for parts of it that are smaller than the tolerance; in particular no part larger
//! than that is missed ([`cells`] of a bilinear field are solved in closed form; those of a spline are bisected until a
//! cell holds one monotone arc or none, by the signs of its Bezier net). A line depends on the field, the threshold and
//! the tolerance alone: whoever asks for either side of it gets the same chains.
//!
//! Samples at the threshold count as above it, so that a line runs through them; where it touches there alone, it has no
//! length and vanishes. At a saddle at the threshold the part above is joined.

mod cells;
mod spline;

use std::collections::BTreeMap;

use glam::DVec2;

use super::chain::Side;
use crate::geometry::map::{GridField, Interpolation};

/// A place in steps of the field.
pub(super) type Step = [f64; 2];

/// Pieces of iso-lines, cell by cell.
#[derive(Default)]
pub(super) struct Pieces {
    /// Each with the part above to its left.
    arcs: Vec<Vec<Step>>,
    /// Along each side of the rectangle where the part above begins and ends; what stands there twice is nothing.
    border: [Vec<f64>; 4],
}

/// How to trace.
#[derive(Clone, Copy)]
pub(super) struct Trace {
    pub(super) threshold: f64,
    /// Metres of a step along x and y.
    pub(super) step: DVec2,
    /// Metres that the line may be off.
    pub(super) tolerance: f64,
    /// Most points.
    pub(super) limit: u64,
}

/// The iso-lines of a field.
pub(super) struct Contour {
    /// Points in steps; closed where the first is the last.
    pub(super) chains: Vec<Vec<Step>>,
    /// Along each side where the part above begins and ends, in order.
    pub(super) border: [Vec<f64>; 4],
}

impl Pieces {
    /// The part of a cell's side on the rectangle's border that is above: between two places along it.
    fn above(&mut self, side: Side, from: f64, to: f64) {
        self.border[side as usize].extend([from, to]);
    }
}

/// Traces a field. Where it would take more points than the limit, their number.
pub(super) fn trace(field: &GridField, how: &Trace) -> Result<Contour, u64> {
    let pieces = match field.interpolation() {
        Interpolation::Bilinear => cells::trace(field, how),
        Interpolation::Bicubic => spline::trace(field, how)?,
    };
    let border = pieces.border.map(|mut ends| {
        ends.sort_by(f64::total_cmp);
        cancelled(&ends)
    });
    Ok(Contour { chains: joined(pieces.arcs), border })
}

/// Sorted numbers without those that stand there twice.
pub(super) fn cancelled<T: Copy + PartialEq>(sorted: &[T]) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for number in sorted {
        if kept.last() == Some(number) {
            kept.pop();
        } else {
            kept.push(*number);
        }
    }
    kept
}

/// Arcs end to end. Where several meet in one place, each is followed by the first that is left.
fn joined(arcs: Vec<Vec<Step>>) -> Vec<Vec<Step>> {
    let key = |place: &Step| place.map(|part| (part + 0.0).to_bits());
    let ends = |arc: &[Step]| (key(&arc[0]), key(&arc[arc.len() - 1]));
    let mut starts: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
    let mut balance: BTreeMap<[u64; 2], i32> = BTreeMap::new();
    for (at, arc) in arcs.iter().enumerate().rev() {
        let (from, to) = ends(arc);
        starts.entry(from).or_default().push(at);
        *balance.entry(from).or_default() += 1;
        *balance.entry(to).or_default() -= 1;
    }
    let mut used = vec![false; arcs.len()];
    let mut chains = Vec::new();
    // Those that begin on the border first; what is left is closed.
    for open in [true, false] {
        for first in 0..arcs.len() {
            let (from, _) = ends(&arcs[first]);
            if used[first] || (open && balance[&from] <= 0) {
                continue;
            }
            if open {
                *balance.entry(from).or_default() -= 1;
            }
            let mut chain = vec![arcs[first][0]];
            let mut next = Some(first);
            while let Some(at) = next {
                used[at] = true;
                chain.extend_from_slice(&arcs[at][1..]);
                let (_, to) = ends(&arcs[at]);
                let list = starts.get_mut(&to);
                next = list.and_then(|list| {
                    while list.last().is_some_and(|at| used[*at]) {
                        list.pop();
                    }
                    list.pop()
                });
            }
            chains.push(chain);
        }
    }
    chains
}

/// Points of a chain such that no point of it is further than the tolerance from the chord over it, or fails `good`,
/// which looks at a chord of two of its points.
///
/// Source: U. Ramer, "An iterative procedure for the polygonal approximation of plane curves", 1972.
pub(super) fn thinned(chain: &[Step], how: &Trace, good: &mut dyn FnMut(Step, Step) -> bool) -> Vec<Step> {
    let last = chain.len() - 1;
    let mut kept = vec![chain[0]];
    let mut open = vec![(0, last)];
    if chain[0] == chain[last] {
        // A closed chain is halved where it is farthest from its start.
        let away = |at: &usize| (at_metres(chain[*at], how) - at_metres(chain[0], how)).length_squared();
        let far = (1..last).fold(0, |best, at| if away(&at) > away(&best) { at } else { best });
        open = vec![(far, last), (0, far)];
    }
    while let Some((from, to)) = open.pop() {
        if from == to {
            continue;
        }
        let (error, at) = farthest(chain, (from, to), how);
        if to > from + 1 && (error > how.tolerance || !good(chain[from], chain[to])) {
            let at = if at == from { usize::midpoint(from, to) } else { at };
            open.extend([(at, to), (from, at)]);
        } else {
            kept.push(chain[to]);
        }
    }
    kept
}

fn at_metres(place: Step, how: &Trace) -> DVec2 {
    DVec2::from_array(place) * how.step
}

fn farthest(chain: &[Step], (from, to): (usize, usize), how: &Trace) -> (f64, usize) {
    let (a, b) = (at_metres(chain[from], how), at_metres(chain[to], how));
    let mut worst = (0.0, from);
    for (at, place) in chain.iter().enumerate().take(to).skip(from + 1) {
        let error = away_from_chord(at_metres(*place, how), a, b);
        if error > worst.0 {
            worst = (error, at);
        }
    }
    worst
}

/// Distance of a point from the chord between two others.
fn away_from_chord(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let way = b - a;
    let square = way.length_squared();
    let part = if square > 0.0 { ((point - a).dot(way) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + way * part).distance(point)
}

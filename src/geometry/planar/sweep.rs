//! The line sweep that finds whether any two of many segments meet.
//!
//! A line moves over the plane and keeps the segments that it cuts in their order along it. Segments that meet are
//! neighbours in that order before they do, so only new neighbours are looked at. Points on one vertical are taken
//! from below: the line leans by less than any angle.
//!
//! Source: M. Shamos, D. Hoey, Geometric intersection problems, FOCS 1976; with the order decided by exact
//! orientations, so that touching and collinear segments have their place in it.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ops::Bound;

use glam::DVec2;

use super::turn;
use crate::geometry::number::count_of;

/// A segment in the order of the sweep.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// The end that the line meets first.
    left: DVec2,
    right: DVec2,
    /// Whether the segment runs from right to left. Of segments on each other, those of one sense are together.
    backward: bool,
    number: u32,
}

impl Edge {
    fn new(number: u32, [from, to]: [DVec2; 2]) -> Self {
        let backward = before(to, from) == Ordering::Less;
        let (left, right) = if backward { (to, from) } else { (from, to) };
        Self { left, right, backward, number }
    }
}

/// Order in which the line meets points.
fn before(a: DVec2, b: DVec2) -> Ordering {
    // Equal numbers may differ in bits: 0 and -0.
    a.x.partial_cmp(&b.x).unwrap_or(Ordering::Equal).then(a.y.partial_cmp(&b.y).unwrap_or(Ordering::Equal))
}

/// Order along the line where it cuts both: from below to above. Segments that lie on each other are told apart by
/// their sense and number.
impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.number == other.number {
            return Ordering::Equal;
        }
        // The segment that begins later is compared against the other, which the line cuts already.
        let later = before(self.left, other.left) == Ordering::Greater;
        let (first, second) = if later { (other, self) } else { (self, other) };
        let above = |point: DVec2| turn(first.left, first.right, point).partial_cmp(&0.0);
        let order = [second.left, second.right]
            .into_iter()
            .filter_map(above)
            .find(|order| *order != Ordering::Equal)
            // `above` says where the second lies: the first is on the other side.
            .map_or(Ordering::Equal, Ordering::reverse);
        let order = if later { order.reverse() } else { order };
        order.then(self.backward.cmp(&other.backward)).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Edge {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Edge {}

/// The first answer of `meet` for two segments, by their numbers, that are neighbours in the sweep. Where it answers
/// for every two that cross or lie on each other in one sense, one of them is found; where it answers for every
/// contact, one is found unless all contacts are between ends of segments. Segments of one point are left out.
/// O(n log n).
pub(super) fn sweep<T>(
    segments: &[[DVec2; 2]],
    mut meet: impl FnMut(usize, usize) -> Option<T>,
) -> Option<T> {
    let edges: Vec<Edge> = (0..count_of(segments.len()))
        .map(|number| Edge::new(number, segments[number as usize]))
        .filter(|edge| edge.left != edge.right)
        .collect();
    // At one point segments end before others begin.
    let mut events: Vec<(DVec2, bool, u32)> = (0..count_of(edges.len()))
        .flat_map(|k| {
            let edge = &edges[k as usize];
            [(edge.left, true, k), (edge.right, false, k)]
        })
        .collect();
    events.sort_unstable_by(|a, b| before(a.0, b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut cut: BTreeSet<Edge> = BTreeSet::new();
    let mut meet = |a: &Edge, b: &Edge| {
        let (a, b) = (a.number.min(b.number) as usize, a.number.max(b.number) as usize);
        meet(a, b)
    };
    for (_, begins, k) in events {
        let edge = edges[k as usize];
        if !begins {
            cut.remove(&edge);
        }
        let below = cut.range(..edge).next_back();
        let above = cut.range((Bound::Excluded(edge), Bound::Unbounded)).next();
        let found = if begins {
            below.and_then(|below| meet(below, &edge)).or_else(|| above.and_then(|above| meet(&edge, above)))
        } else {
            below.zip(above).and_then(|(below, above)| meet(below, above))
        };
        if found.is_some() {
            return found;
        }
        if begins {
            cut.insert(edge);
        }
    }
    None
}

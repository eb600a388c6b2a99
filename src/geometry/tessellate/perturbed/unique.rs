//! How often rays meet the surface of a face, by intervals.
//!
//! F' must be negative where the search begins and positive where it ends, on every ray. Between, blocks of rays and
//! numbers are halved until each either holds no zero or has F' growing along all of its rays. Then a ray crosses zero
//! upward alone, so only once. What is not decided in small blocks counts as met more than once: a body of a field needs no
//! such proof.

use glam::{DVec2, DVec3};

use super::PerturbedFace;
use crate::geometry::field::Zone;
use crate::geometry::number::Bounds;
use crate::geometry::planar::encloses;

/// How often rays through a face meet its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Count {
    /// Each of them once.
    One,
    /// Some perhaps more than once, near a place.
    Several { place: DVec3 },
    /// Some not between the ends of their search.
    Lost {
        place: DVec3,
        /// Whether F' is not negative at the start.
        inward: bool,
    },
}

/// Blocks are halved down to this share of the size of the face.
const SMALLEST: f64 = 1.0 / 65536.0;
/// Times that bounds are asked for, over the number of quadrics.
const BUDGET: u64 = 1 << 22;

/// A block of rays, from a number to another.
#[derive(Clone, Copy)]
struct Block {
    low: DVec2,
    high: DVec2,
    from: f64,
    to: f64,
}

/// Counts.
pub(super) fn count(face: &PerturbedFace) -> Count {
    let (low, high) = face.rectangle();
    let (from, to) = face.reach;
    let whole = Block { low, high, from, to };
    let mut budget = BUDGET / face.relief.weight();
    for (number, inward) in [(from, true), (to, false)] {
        let end = Block { from: number, to: number, ..whole };
        let decided = |bounds: &Bounds, _: &Block| {
            let values = face.relief.values(Zone::Box(bounds));
            if inward { values.high < 0.0 } else { values.low > 0.0 }
        };
        if let Some(place) = undecided(face, end, &mut budget, decided) {
            return Count::Lost { place, inward };
        }
    }
    let grows = |bounds: &Bounds, block: &Block| {
        let values = face.relief.values(Zone::Box(bounds));
        if values.low > 0.0 || values.high < 0.0 {
            return true;
        }
        let directions = face.rays.directions((block.low, block.high));
        let spread = directions.diagonal() / 2.0 * face.relief.steepness(bounds);
        face.relief.slope(Zone::Box(bounds), directions.center()).low > spread
    };
    match undecided(face, whole, &mut budget, grows) {
        Some(place) => Count::Several { place },
        None => Count::One,
    }
}

/// The middle of a block that stays undecided, however small.
fn undecided(
    face: &PerturbedFace,
    whole: Block,
    budget: &mut u64,
    decided: impl Fn(&Bounds, &Block) -> bool,
) -> Option<DVec3> {
    let (low, high) = face.rectangle();
    let smallest = SMALLEST * (high - low).max_element();
    let mut stack = vec![whole];
    while let Some(block) = stack.pop() {
        if !touches(&face.outline, block.low, block.high) {
            continue;
        }
        let bounds = face.rays.block((block.low, block.high), (block.from, block.to));
        if decided(&bounds, &block) {
            continue;
        }
        *budget = budget.saturating_sub(1);
        let length = if face.rays.is_central() { block.to } else { 1.0 };
        let widths = [
            (block.high.x - block.low.x) * length,
            (block.high.y - block.low.y) * length,
            (block.to - block.from) * face.rays.stretch(),
        ];
        let widest = if widths[0] >= widths[1] { 0 } else { 1 };
        let widest = if widths[2] > widths[widest] { 2 } else { widest };
        if widths[widest] <= smallest || *budget == 0 {
            return Some(bounds.center());
        }
        let middle = (block.low + block.high) / 2.0;
        let number = f64::midpoint(block.from, block.to);
        stack.extend(match widest {
            0 => [
                Block { high: block.high.with_x(middle.x), ..block },
                Block { low: block.low.with_x(middle.x), ..block },
            ],
            1 => [
                Block { high: block.high.with_y(middle.y), ..block },
                Block { low: block.low.with_y(middle.y), ..block },
            ],
            _ => [Block { to: number, ..block }, Block { from: number, ..block }],
        });
    }
    None
}

/// Whether a rectangle holds a point of a polygon.
fn touches(outline: &[DVec2], low: DVec2, high: DVec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    let mut sides = outline.iter().zip(next);
    sides.any(|(from, to)| enters(*from, *to, low, high)) || encloses(outline, (low + high) / 2.0)
}

/// Whether a segment enters a rectangle: Y.-D. Liang, B. Barsky, A new concept and method for line clipping, 1984.
fn enters(from: DVec2, to: DVec2, low: DVec2, high: DVec2) -> bool {
    let way = (to - from).to_array();
    let (from, low, high) = (from.to_array(), low.to_array(), high.to_array());
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (near, far) = (low[axis] - from[axis], high[axis] - from[axis]);
        if way[axis] == 0.0 {
            if near > 0.0 || far < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (near / way[axis], far / way[axis]);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    first <= last
}

//! Cells of space in which a surface is searched: an octree that is cut until nothing can hide in a cell.
//!
//! Promise: a cell is left out only where bounds on the field prove that it has no zero. A cell is cut no further where
//! bounds on the gradient prove that the surface in it is one graph; then no part of the surface is missed, however
//! thin. Where neither can be shown the search goes on to a least size. More cells than allowed end it. The order of all
//! work depends on nothing but the field.
//!
//! Source: S. Plantinga, G. Vegter, Isotopic approximation of implicit curves and surfaces, 2004, section 3.
//!
//! Cost: one study of the field for each cell; a few thousand cells for a smooth body.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

use glam::DVec3;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::zones::Zones;
use crate::geometry::field::{AnyField, Field, Study};
use crate::geometry::formula::Quality;
use crate::geometry::number::{Bounds, floor_count};

/// A quick hash of whole numbers: the same on every machine, and never used for an order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 29)
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, number: u64) {
        self.0 = (self.0.rotate_left(23) ^ number).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

/// A map by whole numbers.
pub(super) type Quick<V> = HashMap<u64, V, BuildHasherDefault<Mix>>;
type QuickSet = HashSet<u64, BuildHasherDefault<Mix>>;

/// The deepest level. Places count in halves of the least cell, so that middles have whole coordinates.
pub(super) const DEEPEST: u32 = 12;

/// Cells along the longest side before any is cut.
const COARSE: f64 = 8.0;

/// The level at which a search that proves nothing ends, unless it is told to go on.
const SAMPLED: u32 = 4;

/// A cell: its level and the place of its least corner in its own sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    pub(super) level: u32,
    pub(super) place: [u32; 3],
}

impl Cell {
    fn key(self) -> u64 {
        let [x, y, z] = self.place.map(u64::from);
        (u64::from(self.level) << 60) | (x << 40) | (y << 20) | z
    }

    fn children(self) -> impl Iterator<Item = Self> {
        (0..8_u32).map(move |k| {
            let [x, y, z] = self.place;
            let place = [2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2)];
            Self { level: self.level + 1, place }
        })
    }

    fn parent(self) -> Option<Self> {
        (self.level > 0).then(|| Self { level: self.level - 1, place: self.place.map(|x| x / 2) })
    }

    fn beside(self, step: [i32; 3]) -> Option<Self> {
        let mut place = self.place;
        for (x, step) in place.iter_mut().zip(step) {
            *x = x.checked_add_signed(step)?;
        }
        Some(Self { place, ..self })
    }

    /// Half of its size and its least corner, in units of places.
    pub(super) fn corner(self) -> (u32, [u32; 3]) {
        let half = 1 << (DEEPEST - self.level);
        (half, self.place.map(|x| x * 2 * half))
    }
}

/// The lattice that all places lie on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    origin: DVec3,
    /// Size of a unit of places.
    unit: f64,
    counts: [u32; 3],
}

impl Lattice {
    /// A lattice that reaches a little beyond a box. No plane of it lies where planes of models lie.
    fn around(within: &Bounds) -> Self {
        let size = within.max - within.min;
        let longest = size.max_element();
        let coarse = longest * 1.07 / COARSE;
        let count = |extent: f64| ((extent + 0.043 * longest) / coarse).ceil().max(1.0);
        let counts = DVec3::new(count(size.x), count(size.y), count(size.z));
        let spare = counts * coarse - size;
        let origin = within.min - spare * DVec3::new(0.4871, 0.5139, 0.4937);
        let units = f64::from(1_u32 << (DEEPEST + 1));
        let counts = counts.to_array().map(|count| floor_count(count).min(64));
        Self { origin, unit: coarse / units, counts }
    }

    pub(super) fn point(&self, place: [u32; 3]) -> DVec3 {
        self.origin + DVec3::from_array(place.map(f64::from)) * self.unit
    }

    fn bounds(&self, cell: Cell) -> Bounds {
        let (half, corner) = cell.corner();
        Bounds { min: self.point(corner), max: self.point(corner.map(|x| x + 2 * half)) }
    }
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Finding {
    /// It holds no zero.
    Empty,
    /// The surface in it is one graph.
    Graph,
    /// The surface in it is one graph, which may have kinks.
    Crest,
    /// More must be found out, and can be: the field is smooth there.
    Smooth,
    /// The field may have kinks.
    Kinked,
    /// The field may have no value.
    Unknown,
}

/// The cells that the surface runs through.
#[derive(Debug)]
pub(super) struct Cells {
    pub(super) lattice: Lattice,
    /// In the order of their levels and places.
    pub(super) leaves: Vec<Cell>,
    cut: QuickSet,
    /// Whether the limit ended the search.
    pub(super) short: bool,
    /// A place where the field has no value; it ended the search.
    pub(super) lost: Option<DVec3>,
}

/// How far to search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<'a> {
    /// Where bounds prove nothing cells are cut down to this size; a share of the box where it is not given.
    pub(super) least: Option<f64>,
    /// The most cells to look at.
    pub(super) limit: usize,
    /// No cell of the surface is larger than this.
    pub(super) largest: f64,
    /// Where they are smaller.
    pub(super) zones: &'a Zones,
}

struct Finder<'a> {
    field: &'a AnyField,
    lattice: Lattice,
    search: Search<'a>,
    kinks: bool,
    cut: QuickSet,
    leaves: QuickSet,
    seen: usize,
    short: bool,
    lost: Option<DVec3>,
}

impl Cells {
    /// Searches a box; more cells than `limit` end it.
    pub(super) fn find(field: &AnyField, within: &Bounds, search: Search<'_>) -> Self {
        let lattice = Lattice::around(within);
        let mut finder = Finder {
            field,
            lattice,
            search,
            kinks: field.has_kinks(),
            cut: QuickSet::default(),
            leaves: QuickSet::default(),
            seen: 0,
            short: false,
            lost: None,
        };
        let [nx, ny, nz] = lattice.counts;
        let mut front: Vec<Cell> = Vec::new();
        for x in 0..nx {
            for y in 0..ny {
                front.extend((0..nz).map(|z| Cell { level: 0, place: [x, y, z] }));
            }
        }
        let mut leaves = Vec::new();
        while !front.is_empty() && !finder.short && finder.lost.is_none() {
            front = finder.level(&front, &mut leaves);
        }
        finder.balance(&mut leaves);
        leaves.retain(|cell| finder.leaves.contains(&cell.key()));
        leaves.sort_unstable();
        leaves.dedup();
        Self { lattice, leaves, cut: finder.cut, short: finder.short, lost: finder.lost }
    }

    /// Whether a cell is cut into smaller ones.
    fn is_cut(&self, level: u32, place: [Option<u32>; 3]) -> bool {
        let [Some(x), Some(y), Some(z)] = place else { return false };
        self.cut.contains(&Cell { level, place: [x, y, z] }.key())
    }

    /// Whether a side of a cell is cut, seen from the other side of it.
    pub(super) fn is_side_cut(&self, level: u32, place: [u32; 3], axis: usize, up: bool) -> bool {
        let mut other = place.map(Some);
        other[axis] = if up { place[axis].checked_add(1) } else { place[axis].checked_sub(1) };
        self.is_cut(level, other)
    }

    /// Whether an edge of cells of this level is cut in the middle: one of the four cells around it is. `place` is its
    /// start, in sizes of the cell.
    pub(super) fn is_edge_cut(&self, level: u32, place: [u32; 3], along: usize) -> bool {
        let (a, b) = ((along + 1) % 3, (along + 2) % 3);
        [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().any(|(one, other)| {
            let mut cell = place.map(Some);
            cell[a] = place[a].checked_sub(one);
            cell[b] = place[b].checked_sub(other);
            self.is_cut(level, cell)
        })
    }
}

impl Finder<'_> {
    fn finding(&self, cell: Cell) -> Finding {
        let study: Study = self.field.study(&self.lattice.bounds(cell));
        let value = study.value;
        if value.quality == Quality::Unknown || value.low.is_nan() || value.high.is_nan() {
            return Finding::Unknown;
        }
        let finite = study.gradient.iter().all(|part| part.is_finite());
        if value.low > 0.0 || value.high < 0.0 || (finite && self.is_far(cell, &study)) {
            return Finding::Empty;
        }
        // Slopes at kinks are those of all sides: a surface that none of them turns much is a graph with kinks.
        let graph = finite && value.quality >= Quality::Continuous && study.turns_little();
        match (graph, finite && value.quality == Quality::Smooth) {
            (true, true) => Finding::Graph,
            (true, false) => Finding::Crest,
            (false, true) => Finding::Smooth,
            (false, false) => Finding::Kinked,
        }
    }

    /// Whether the value in the middle is further from 0 than slopes can lead within the cell: the mean value form, which
    /// is sharper than the bounds on the values themselves in all but large cells.
    fn is_far(&self, cell: Cell, study: &Study) -> bool {
        let bounds = self.lattice.bounds(cell);
        let half = ((bounds.max - bounds.min) / 2.0).to_array();
        let reach: f64 = study.gradient.iter().zip(half).map(|(slope, half)| slope.size() * half).sum();
        let value = self.field.value(bounds.center()).abs();
        value > reach * (1.0 + 1e-9) + 1e-12 * value
    }

    /// How deep a cell of a finding is cut.
    fn depth(&self, cell: Cell, finding: Finding) -> u32 {
        let level = |size: f64| {
            let coarse = self.lattice.unit * f64::from(1_u32 << (DEEPEST + 1));
            (0..DEEPEST).find(|level| coarse / f64::from(1_u32 << level) <= size).unwrap_or(DEEPEST)
        };
        let least = self.search.zones.cell(&self.lattice.bounds(cell)).map_or(0, level);
        least.max(match finding {
            Finding::Empty => 0,
            Finding::Graph => level(self.search.largest),
            Finding::Crest => level(self.search.largest / 2.0),
            // Bounds on slopes near kinks are finite and say little.
            Finding::Smooth if self.kinks => SAMPLED + 2,
            Finding::Smooth => DEEPEST - 2,
            Finding::Kinked | Finding::Unknown => self.search.least.map_or(SAMPLED, level),
        })
    }

    /// Settles the cells of one level; the cells of the next.
    fn level(&mut self, front: &[Cell], leaves: &mut Vec<Cell>) -> Vec<Cell> {
        let found: Vec<Finding> = front.par_iter().map(|cell| self.finding(*cell)).collect();
        self.seen += front.len();
        let mut next = Vec::new();
        for (cell, finding) in front.iter().zip(found) {
            if finding == Finding::Empty {
                continue;
            }
            if finding == Finding::Unknown && self.lost.is_none() {
                let center = self.lattice.bounds(*cell).center();
                self.lost = self.field.value(center).is_nan().then_some(center);
            }
            let full = self.seen + next.len() > self.search.limit;
            if cell.level < self.depth(*cell, finding) && !full {
                self.cut.insert(cell.key());
                next.extend(cell.children());
            } else {
                self.short |= full;
                self.leaves.insert(cell.key());
                leaves.push(*cell);
            }
        }
        next
    }

    /// Cuts cells until neighbors differ by one level at most.
    fn balance(&mut self, leaves: &mut Vec<Cell>) {
        let mut open: Vec<Cell> = leaves.clone();
        open.sort_unstable_by(|a, b| b.cmp(a));
        while let Some(cell) = open.pop() {
            if self.seen > self.search.limit {
                self.short = true;
                return;
            }
            if !self.leaves.contains(&cell.key()) {
                continue;
            }
            for step in NEIGHBORS {
                let Some(beside) = cell.beside(step).and_then(Cell::parent).and_then(Cell::parent) else {
                    continue;
                };
                let mut above = Some(beside);
                while let Some(coarse) = above {
                    if self.leaves.remove(&coarse.key()) {
                        self.cut.insert(coarse.key());
                        self.seen += 8;
                        for child in coarse.children() {
                            let finding = self.finding(child);
                            if finding != Finding::Empty {
                                self.leaves.insert(child.key());
                                leaves.push(child);
                                open.push(child);
                            }
                        }
                        open.push(cell);
                        break;
                    }
                    above = coarse.parent();
                }
            }
        }
    }
}

/// Steps to the cells that share a side or an edge.
const NEIGHBORS: [[i32; 3]; 18] = [
    [-1, 0, 0],
    [1, 0, 0],
    [0, -1, 0],
    [0, 1, 0],
    [0, 0, -1],
    [0, 0, 1],
    [-1, -1, 0],
    [-1, 1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 0, -1],
    [-1, 0, 1],
    [1, 0, -1],
    [1, 0, 1],
    [0, -1, -1],
    [0, -1, 1],
    [0, 1, -1],
    [0, 1, 1],
];

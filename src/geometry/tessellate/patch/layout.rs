//! How the pieces of a patchwork hang together: which sides are one edge, which are points.
//!
//! Each surface is cut at its joints into blocks, smooth rectangles of its parameters. Sides that run along
//! one line in space, in either direction, are one edge, whether they belong to neighbours in one surface,
//! to the two ends of a closed one, or to two surfaces.

use std::collections::BTreeMap;

use glam::DVec3;

use super::judge::Chart;
use crate::geometry::curve::Side;
use crate::geometry::mesh::weld::weld_near;
use crate::geometry::number::Bounds;
pub use crate::geometry::surface::Rim;
use crate::geometry::surface::{AnySurface, SecondJet, SecondRange, Surface, SurfaceJet};

/// A smooth rectangle of one surface.
pub(in crate::geometry::tessellate) struct Block<'a> {
    pub(super) surface: &'a AnySurface,
    /// Index of the surface.
    pub(super) source: u32,
    pub(in crate::geometry::tessellate) u: (f64, f64),
    pub(in crate::geometry::tessellate) v: (f64, f64),
    /// In the order of [`Rim::ALL`].
    pub(super) sides: [EdgeUse; 4],
    /// Whether its normal is turned around, so that neighbours look to one side.
    pub(super) flipped: bool,
    /// Whether these rims of the block lie at the border of its surface.
    pub(super) outer: [bool; 4],
}

/// An edge as a side runs along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct EdgeUse {
    pub(super) edge: usize,
    /// Whether the side starts where the edge ends.
    pub(super) backward: bool,
}

/// A line that one side or several run along.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    /// Points at its ends.
    pub(super) ends: [u32; 2],
    /// Blocks and which of their sides.
    pub(super) uses: Vec<(usize, Rim)>,
    /// Whether all of it is one point: a pole.
    pub(super) pole: bool,
}

/// Blocks, edges and the points where edges end.
pub(super) struct Layout<'a> {
    pub(super) blocks: Vec<Block<'a>>,
    pub(super) edges: Vec<Edge>,
    pub(super) nodes: Vec<DVec3>,
}

impl Block<'_> {
    /// Parameters at fractions of the block.
    pub(in crate::geometry::tessellate) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (mix(self.u, x), mix(self.v, y))
    }

    pub(in crate::geometry::tessellate) fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        self.surface.sided((u, side(u, self.u)), (v, side(v, self.v)))
    }

    /// Jets wherever one of the parameters `u` crosses one of `v`, row by row.
    pub(super) fn lattice(&self, u: &[f64], v: &[f64]) -> Vec<SurfaceJet> {
        let sided = |parameters: &[f64], within: (f64, f64)| -> Vec<(f64, Side)> {
            parameters.iter().map(|t| (*t, side(*t, within))).collect()
        };
        self.surface.lattice(&sided(u, self.u), &sided(v, self.v))
    }

    pub(super) fn second(&self, u: f64, v: f64) -> SecondJet {
        self.surface.second((u, side(u, self.u)), (v, side(v, self.v)))
    }

    pub(super) fn spans(&self) -> (f64, f64) {
        (self.u.1 - self.u.0, self.v.1 - self.v.0)
    }

    pub(super) fn edge(&self, rim: Rim) -> EdgeUse {
        self.sides[rim as usize]
    }

    /// A smooth rectangle of a surface, by itself: what is asked of its edges means nothing.
    pub(in crate::geometry::tessellate) fn alone(
        surface: &AnySurface,
        u: (f64, f64),
        v: (f64, f64),
    ) -> Block<'_> {
        Block {
            surface,
            source: 0,
            u,
            v,
            sides: [EdgeUse { edge: 0, backward: false }; 4],
            flipped: false,
            outer: [true; 4],
        }
    }

    fn point(&self, place: (f64, f64)) -> DVec3 {
        let (u, v) = self.at(place);
        self.jet(u, v).point
    }
}

impl Chart for Block<'_> {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        Block::jet(self, u, v)
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        self.surface.second_range(u, v)
    }

    fn limits(&self) -> ((f64, f64), (f64, f64)) {
        (self.u, self.v)
    }
}

fn side(t: f64, (_, end): (f64, f64)) -> Side {
    if t >= end { Side::Before } else { Side::After }
}

fn mix((start, end): (f64, f64), part: f64) -> f64 {
    start * (1.0 - part) + end * part
}

/// Sides nearer to each other than this share of the size of all are one edge, and a side shorter than it is a
/// point: constructions that mean the same line leave about 1e-15, measured data far more than this.
const SAME: f64 = 1e-9;

/// Places along a side that are compared: symmetric, since sides may run against each other, and at no plain share of it,
/// where waves of formulas meet by chance.
const PROBES: [f64; 5] = [0.118, 0.314, 0.5, 0.686, 0.882];

impl<'a> Layout<'a> {
    /// Cost: O(b log b) for b blocks.
    pub(super) fn new(surfaces: &'a [AnySurface]) -> Self {
        let mut blocks = Vec::new();
        for (source, surface) in surfaces.iter().enumerate() {
            add_blocks(surface, crate::geometry::mesh::index(source), &mut blocks);
        }
        let mut layout = Self { blocks, edges: Vec::new(), nodes: Vec::new() };
        layout.join();
        layout.turn();
        layout
    }

    fn join(&mut self) {
        let corners: Vec<DVec3> = self
            .blocks
            .iter()
            .flat_map(|block| {
                [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|place| block.point(place))
            })
            .collect();
        let probes: Vec<[DVec3; 5]> = self
            .blocks
            .iter()
            .flat_map(|block| Rim::ALL.map(|rim| PROBES.map(|part| block.point(rim.place(part)))))
            .collect();
        let all = corners.iter().chain(probes.iter().flatten()).copied();
        let near = SAME * Bounds::of_points(all).diagonal();
        let welded = weld_near(&corners, near);
        self.nodes = welded.points;
        let mut known: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
        for block in 0..self.blocks.len() {
            for rim in Rim::ALL {
                let corner = |k: usize| welded.map[4 * block + k];
                let ends = match rim {
                    Rim::Bottom => [corner(0), corner(1)],
                    Rim::Right => [corner(1), corner(2)],
                    Rim::Top => [corner(3), corner(2)],
                    Rim::Left => [corner(0), corner(3)],
                };
                let middle = probes[4 * block + rim as usize];
                let list = known.entry((ends[0].min(ends[1]), ends[0].max(ends[1]))).or_default();
                let found = list.iter().find_map(|edge| {
                    let (owner, other) = self.edges[*edge].uses[0];
                    let same = &probes[4 * owner + other as usize];
                    let start = self.edges[*edge].ends[0];
                    alike(same, &middle, near, start == ends[0], start == ends[1])
                        .map(|backward| EdgeUse { edge: *edge, backward })
                });
                let used = found.unwrap_or_else(|| {
                    let pole = ends[0] == ends[1]
                        && middle.iter().all(|p| p.distance(self.nodes[ends[0] as usize]) <= near);
                    self.edges.push(Edge { ends, uses: Vec::new(), pole });
                    list.push(self.edges.len() - 1);
                    EdgeUse { edge: self.edges.len() - 1, backward: false }
                });
                self.edges[used.edge].uses.push((block, rim));
                self.blocks[block].sides[rim as usize] = used;
            }
        }
    }

    /// Turns normals so that neighbours look to one side, as far as that can be: not around a Moebius band.
    fn turn(&mut self) {
        let mut seen = vec![false; self.blocks.len()];
        for start in 0..self.blocks.len() {
            let mut front = vec![start];
            while let Some(block) = front.pop() {
                if std::mem::replace(&mut seen[block], true) {
                    continue;
                }
                for rim in Rim::ALL {
                    let Some((other, back)) = self.across(block, rim) else { continue };
                    if !seen[other] {
                        let same = self.runs_on(block, rim) == self.runs_on(other, back);
                        self.blocks[other].flipped = self.blocks[block].flipped != same;
                        front.push(other);
                    }
                }
            }
        }
    }

    /// Whether the boundary of a block, run around with the block to the left, goes along the edge's own way.
    fn runs_on(&self, block: usize, rim: Rim) -> bool {
        let forward = matches!(rim, Rim::Bottom | Rim::Right);
        forward != self.blocks[block].edge(rim).backward
    }

    /// The one block on the other side of a side.
    pub(super) fn across(&self, block: usize, rim: Rim) -> Option<(usize, Rim)> {
        let edge = &self.edges[self.blocks[block].edge(rim).edge];
        match edge.uses.as_slice() {
            [one, other] if !edge.pole => Some(if *one == (block, rim) { *other } else { *one }),
            _ => None,
        }
    }
}

/// Whether two sides run along one line, and if so whether they run against each other.
fn alike(one: &[DVec3; 5], other: &[DVec3; 5], near: f64, with: bool, against: bool) -> Option<bool> {
    let close = |a: &DVec3, b: &DVec3| a.distance(*b) <= near;
    if with && one.iter().zip(other).all(|(a, b)| close(a, b)) {
        return Some(false);
    }
    (against && one.iter().rev().zip(other).all(|(a, b)| close(a, b))).then_some(true)
}

fn add_blocks<'a>(surface: &'a AnySurface, source: u32, blocks: &mut Vec<Block<'a>>) {
    let stops = |start: f64, joints: Vec<f64>, end: f64| {
        let mut stops = vec![start];
        stops.extend(joints);
        stops.push(end);
        stops
    };
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let (u, v) = (stops(u.start, surface.joints_u(), u.end), stops(v.start, surface.joints_v(), v.end));
    for row in 0..v.len() - 1 {
        for column in 0..u.len() - 1 {
            blocks.push(Block {
                surface,
                source,
                u: (u[column], u[column + 1]),
                v: (v[row], v[row + 1]),
                sides: [EdgeUse { edge: 0, backward: false }; 4],
                flipped: false,
                outer: [row == 0, column + 2 == u.len(), row + 2 == v.len(), column == 0],
            });
        }
    }
}

//! Lines drawn into a triangulation: edges that stay, and the sides of them on which triangles lie.
//!
//! Promise: after [`Delaunay::draw`] the line runs along edges. Where it meets a corner it passes through it; where it
//! crosses another line, a corner is set at the crossing, rounded to a whole place. Lines carry bits; drawn twice, a bit
//! vanishes, so closed lines bound regions by parity whatever rounding does. Delaunay is restored as far as lines allow.
//!
//! Sources: S. Sloan, "A fast algorithm for generating constrained Delaunay triangulations", Computers and Structures 47
//! (1993); for crossings D. Greene and F. Yao, "Finite-resolution computational geometry", 1986.

use std::collections::VecDeque;

use super::delaunay::{BORDER, Delaunay, FIXED, Place, next, previous, turn};

/// Lines that could not be told apart: rounding moved crossings onto ever new lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tangled;

/// What lies between two corners.
enum Way {
    /// An edge.
    Edge(u32),
    /// A corner on the way.
    Through(u32),
    /// An edge with a line, crossed.
    Blocked(u32),
    /// Edges without lines, as pairs of corners.
    Across(VecDeque<[u32; 2]>),
}

impl Delaunay {
    /// Makes ready for lines.
    pub(super) fn allow_lines(&mut self) {
        if !self.lines.is_empty() {
            return;
        }
        self.lines = vec![0; self.corners.len()];
        self.out_of = vec![BORDER; self.places.len()];
        for (side, corner) in (0..).zip(&self.corners) {
            self.out_of[*corner as usize] = side;
        }
    }

    /// Half-edges that begin at a corner, counter-clockwise; at the border from the first to the last.
    pub(super) fn around(&self, corner: u32) -> Vec<u32> {
        let start = self.out_of[corner as usize];
        let mut first = start;
        while self.beyond(first) != BORDER {
            first = next(self.beyond(first));
            if first == start {
                break;
            }
        }
        let mut all = vec![first];
        let mut at = self.beyond(previous(first));
        while at != BORDER && at != first {
            all.push(at);
            at = self.beyond(previous(at));
        }
        all
    }

    fn at(&self, corner: u32) -> Place {
        self.places[corner as usize]
    }

    /// Draws a line between two corners with some bits.
    pub(super) fn draw(&mut self, from: u32, to: u32, bits: u32) -> Result<(), Tangled> {
        /// A line of a contour meets a handful of others.
        const MOST: u32 = 1 << 16;
        let mut open = vec![(from, to, bits)];
        for _ in 0..MOST {
            let Some((a, b, bits)) = open.pop() else { return Ok(()) };
            if a == b {
                continue;
            }
            match self.way(a, b) {
                Way::Edge(edge) => self.toggle(edge, bits),
                Way::Through(corner) => open.extend([(corner, b, bits), (a, corner, bits)]),
                Way::Blocked(edge) => self.cross([a, b], edge, bits, &mut open),
                Way::Across(crossed) => {
                    let edge = self.turn_aside(a, b, crossed).ok_or(Tangled)?;
                    self.toggle(edge, bits);
                }
            }
        }
        Err(Tangled)
    }

    /// Toggles bits of an edge.
    pub(super) fn toggle(&mut self, edge: u32, bits: u32) {
        self.lines[edge as usize] ^= bits;
        let other = self.beyond(edge);
        if other != BORDER {
            self.lines[other as usize] ^= bits;
        }
    }

    /// An edge between two corners, as a half-edge of either direction.
    pub(super) fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).into_iter().find_map(|edge| {
            if self.corners[next(edge) as usize] == b {
                return Some(edge);
            }
            let back = previous(edge);
            (self.corners[back as usize] == b).then_some(back)
        })
    }

    fn way(&self, a: u32, b: u32) -> Way {
        let (from, to) = (self.at(a), self.at(b));
        let side = |corner: u32| turn(from, to, self.at(corner));
        let ahead = |corner: u32| {
            let at = self.at(corner);
            let part = |k: usize| i64::from(to[k] - from[k]) * i64::from(at[k] - from[k]);
            part(0) + part(1) > 0
        };
        let mut edge = BORDER;
        for out in self.around(a) {
            let (p, q) = (self.corners[next(out) as usize], self.corners[previous(out) as usize]);
            if p == b {
                return Way::Edge(out);
            }
            if q == b {
                return Way::Edge(previous(out));
            }
            let (at_p, at_q) = (side(p), side(q));
            for (corner, turn) in [(p, at_p), (q, at_q)] {
                if turn == 0 && ahead(corner) {
                    return Way::Through(corner);
                }
            }
            if at_p < 0 && at_q > 0 {
                edge = next(out);
            }
        }
        let mut crossed = VecDeque::new();
        loop {
            // The rectangle is convex: between two of its places nothing leaves it.
            let beyond = self.beyond(edge);
            if self.line(edge) != 0 {
                return Way::Blocked(edge);
            }
            crossed.push_back([edge, next(edge)].map(|side| self.corners[side as usize]));
            let apex = self.corners[previous(beyond) as usize];
            if apex == b {
                return Way::Across(crossed);
            }
            edge = match side(apex) {
                0 => return Way::Through(apex),
                left if left > 0 => next(beyond),
                _ => previous(beyond),
            };
        }
    }

    /// Where a line from a to b crosses an edge that has lines, both are broken at the crossing.
    fn cross(&mut self, [a, b]: [u32; 2], edge: u32, bits: u32, open: &mut Vec<(u32, u32, u32)>) {
        let [c, d] = [edge, next(edge)].map(|side| self.corners[side as usize]);
        let lines = self.line(edge);
        let place = crossing([a, b, c, d].map(|corner| self.at(corner)));
        if let Some(end) = [c, d].into_iter().find(|end| self.at(*end) == place) {
            open.extend([(end, b, bits), (a, end, bits)]);
            return;
        }
        self.toggle(edge, lines);
        let Some(corner) = self.corner_at(place, edge / 3) else { return };
        open.extend([(corner, d, lines), (c, corner, lines), (corner, b, bits), (a, corner, bits)]);
    }

    /// Turns edges between two corners until one joins them.
    fn turn_aside(&mut self, a: u32, b: u32, mut crossed: VecDeque<[u32; 2]>) -> Option<u32> {
        let (from, to) = (self.at(a), self.at(b));
        let mut made = Vec::new();
        // Each round over all of them turns at least one; Sloan's order needs a few rounds.
        let mut patience = 64 + crossed.len() * (crossed.len() + 8) * 4;
        while let Some([p, q]) = crossed.pop_front() {
            patience = patience.checked_sub(1)?;
            let edge = self.edge_between(p, q)?;
            let other = self.beyond(edge);
            let corners = [edge, previous(other), next(edge), previous(edge)];
            let [s, t, u, v] = corners.map(|side| self.corners[side as usize]);
            let places = [s, t, u, v].map(|corner| self.at(corner));
            // The quadrilateral s, t, u, v must be strictly convex at s and u.
            let convex =
                turn(places[3], places[0], places[1]) > 0 && turn(places[1], places[2], places[3]) > 0;
            if !convex {
                crossed.push_back([p, q]);
                continue;
            }
            self.flip(edge);
            let between = |corner: u32| corner != a && corner != b;
            let apart = turn(from, to, places[1]).signum() * turn(from, to, places[3]).signum() < 0;
            if between(t) && between(v) && apart {
                crossed.push_back([t, v]);
            } else {
                made.push([t, v]);
            }
        }
        let edge = self.edge_between(a, b)?;
        // Kept as it is while the others are settled.
        self.toggle(edge, u32::MAX);
        self.restore(made);
        let edge = self.edge_between(a, b)?;
        self.toggle(edge, u32::MAX);
        Some(edge)
    }

    /// Turns edges until all are Delaunay that may be turned.
    pub(super) fn restore(&mut self, mut open: Vec<[u32; 2]>) {
        while let Some([p, q]) = open.pop() {
            let Some(edge) = self.edge_between(p, q) else { continue };
            let other = self.beyond(edge);
            if other == BORDER || self.line(edge) != 0 {
                continue;
            }
            let corners = [edge, next(edge), previous(edge), previous(other)];
            let [a, b, p, q] = corners.map(|side| self.corners[side as usize]);
            let places = [a, b, p, q].map(|corner| self.at(corner));
            if super::delaunay::in_circle(places[0], places[1], places[2], places[3]) {
                self.flip(edge);
                open.extend([[a, q], [q, b], [b, p], [p, a]]);
            }
        }
    }

    /// For each triangle the bits of the lines between it and the outside of the rectangle. None where lines are not
    /// closed.
    pub(super) fn sides_of_lines(&self) -> Result<Vec<u32>, Tangled> {
        let count = self.triangles();
        let mut sides: Vec<Option<u32>> = vec![None; count as usize];
        let start = (0..3 * count).find(|side| self.beyond(*side) == BORDER).ok_or(Tangled)?;
        sides[start as usize / 3] = Some(self.line(start) & !FIXED);
        let mut open = vec![start / 3];
        while let Some(triangle) = open.pop() {
            let own = sides[triangle as usize].unwrap_or(0);
            for side in 3 * triangle..3 * triangle + 3 {
                let other = self.beyond(side);
                let across = own ^ (self.line(side) & !FIXED);
                if other == BORDER {
                    if across != 0 {
                        return Err(Tangled);
                    }
                    continue;
                }
                match sides[other as usize / 3] {
                    None => {
                        sides[other as usize / 3] = Some(across);
                        open.push(other / 3);
                    }
                    Some(known) if known != across => return Err(Tangled),
                    Some(_) => {}
                }
            }
        }
        Ok(sides.into_iter().map(|side| side.unwrap_or(0)).collect())
    }
}

/// The whole place nearest to where ab crosses cd.
fn crossing([a, b, c, d]: [Place; 4]) -> Place {
    let (from, to) = (turn(c, d, a) as f64, turn(c, d, b) as f64);
    let part = from / (from - to);
    [0, 1].map(|k| {
        let way = f64::from(b[k]) - f64::from(a[k]);
        super::greedy::whole(f64::from(a[k]) + part * way)
    })
}

//! Triangles of one block: rows of steps, zipped together, with strips where the rims are cut otherwise.

use glam::DVec3;

use super::density::Density;
use super::layout::{Block, Rim};
use super::plan::Plan;
use crate::geometry::mesh::index;

/// Which parameter of a corner means nothing, because it stands on a pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::geometry::tessellate) enum Free {
    Neither,
    U,
    V,
}

/// A corner of triangles in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::geometry::tessellate) struct Corner {
    pub(in crate::geometry::tessellate) u: f64,
    pub(in crate::geometry::tessellate) v: f64,
    /// The point in space.
    pub(in crate::geometry::tessellate) point: u32,
    pub(in crate::geometry::tessellate) free: Free,
}

/// Triangles of one block, counter-clockwise where u runs to the right and v up.
#[derive(Clone, Debug, Default)]
pub(super) struct Piece {
    pub(super) corners: Vec<Corner>,
    /// The surface's own normal at each corner.
    pub(super) normals: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A rim as it was cut: fractions and points. A pole has one of each.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    pub(super) fractions: Vec<f64>,
    pub(super) points: Vec<u32>,
}

impl Cut {
    fn is_pole(&self) -> bool {
        self.points.len() == 1
    }

    /// Whether rows that end at these levels end in its points.
    fn fits(&self, levels: &[f64]) -> bool {
        self.fractions == levels
    }
}

/// A corner with its place along the chain it stands in.
#[derive(Clone, Copy)]
struct Link {
    corner: u32,
    place: f64,
}

/// The block as its rows see it: x along the rows, y from row to row.
struct Weaver<'a, 'b> {
    block: &'a Block<'b>,
    plan: &'a Plan,
    piece: Piece,
    next_point: &'a mut u32,
    /// Points that whole rims are gathered in.
    poles: Vec<(u32, Free)>,
}

/// Cuts a block whose rims, in the order of [`Rim::ALL`], are cut already. New points count on from `next_point`.
pub(super) fn weave(block: &Block<'_>, plan: &Plan, rims: &[Cut; 4], next_point: &mut u32) -> Piece {
    let [bottom, right, top, left] = rims;
    // Where rows run along v the picture is mirrored: x is v, and the left rim lies below.
    let (bottom, right, top, left) =
        if plan.along_u { (bottom, right, top, left) } else { (left, top, right, bottom) };
    let mut poles = Vec::new();
    for (rim, cut) in Rim::ALL.iter().zip(rims) {
        if cut.is_pole() {
            poles.push((cut.points[0], if rim.along_u() { Free::U } else { Free::V }));
        }
    }
    let mut weaver = Weaver { block, plan, piece: Piece::default(), next_point, poles };
    weaver.run(bottom, right, top, left);
    let mut piece = weaver.piece;
    if !plan.along_u {
        piece.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    piece
}

impl Weaver<'_, '_> {
    fn run(&mut self, bottom: &Cut, right: &Cut, top: &Cut, left: &Cut) {
        let levels = self.levels(right, left);
        let (left_fits, right_fits) = (left.fits(&levels), right.fits(&levels));
        let inner = levels.len() - 2;
        let below = self.rim(bottom, 0.0, true);
        let above = self.rim(top, 1.0, true);
        if inner == 0 {
            self.zip(&below, &above);
            return;
        }
        let (left_chain, right_chain) = (self.rim(left, 0.0, false), self.rim(right, 1.0, false));
        let (from, to) = self.inner(&levels, left_fits, right_fits);
        let mut rows: Vec<Vec<Link>> = Vec::with_capacity(inner);
        let mut last: Option<Vec<f64>> = None;
        for k in 1..=inner {
            let level = levels[k];
            let mut places = self.places(level, last.as_ref());
            last = Some(places.clone());
            if self.plan.shifted && k % 2 == 1 {
                places = shifted(&places);
            }
            trim(&mut places, from, to);
            let mut row = Vec::with_capacity(places.len());
            for place in places {
                let known = match place {
                    0.0 if left_fits => Some(left_chain[k].corner),
                    1.0 if right_fits => Some(right_chain[k].corner),
                    _ => None,
                };
                let corner = known.unwrap_or_else(|| self.inside(place, level));
                row.push(Link { corner, place });
            }
            rows.push(row);
        }
        self.zip(&below, &rows[0]);
        for pair in rows.windows(2) {
            self.zip(&pair[0], &pair[1]);
        }
        self.zip(&rows[inner - 1], &above);
        let column = |end: fn(&Vec<Link>) -> Link| -> Vec<Link> {
            let link = |(row, level): (&Vec<Link>, &f64)| Link { place: *level, ..end(row) };
            rows.iter().zip(&levels[1..]).map(link).collect()
        };
        if !left_fits {
            self.zip(&column(|row| row[0]), &left_chain);
        }
        if !right_fits {
            self.zip(&right_chain, &column(|row| row[row.len() - 1]));
        }
    }

    /// Where rows lie, 0 and 1 included: at the points of a rim if those are about as many as are needed.
    fn levels(&self, right: &Cut, left: &Cut) -> Vec<f64> {
        let own = self.plan.rows.stations(1);
        let wanted = own.len();
        let near = |cut: &&Cut| cut.fractions.len() >= wanted && cut.fractions.len() * 3 <= wanted * 4 + 2;
        let rim = [left, right].into_iter().filter(|cut| !cut.is_pole()).find(near);
        let levels = rim.map_or(own, |cut| cut.fractions.clone());
        let fits = |cut: &Cut| cut.fits(&levels);
        let room = fits(left) && fits(right) && self.poles.len() < 2;
        if levels.len() == 2 && !room { vec![0.0, 0.5, 1.0] } else { levels }
    }

    /// Between which places all inner rows run: the whole width, but for a strip beside rims that do not fit.
    fn inner(&self, levels: &[f64], left_fits: bool, right_fits: bool) -> (f64, f64) {
        let inner = &levels[1..levels.len() - 1];
        let most = inner.iter().map(|level| self.steps(*level).total()).fold(1.0, f64::max);
        let strip = (1.0 / most).min(0.5);
        let from = if left_fits { 0.0 } else { strip };
        let to = if right_fits { 1.0 } else { 1.0 - strip };
        if to - from < 0.25 * strip { (0.5, 0.5) } else { (from, to) }
    }

    /// The density of steps at a level.
    fn steps(&self, level: f64) -> Density {
        let rows = &self.plan.steps;
        let pieces = rows.len() - 1;
        let place = level * pieces as f64;
        let piece = crate::geometry::number::floor_index(place).min(pieces - 1);
        let part = place - piece as f64;
        let (below, above) = (&rows[piece].0, &rows[piece + 1].0);
        Density(below.iter().zip(above).map(|(a, b)| a * (1.0 - part) + b * part).collect())
    }

    /// Ends of steps at a level: those of the row before, where they are about as many as are needed.
    fn places(&self, level: f64, last: Option<&Vec<f64>>) -> Vec<f64> {
        let steps = self.steps(level);
        if let Some(last) = last {
            let enough = last
                .windows(2)
                .all(|pair| (pair[1] - pair[0]) * (steps.at(pair[0]) + steps.at(pair[1])) / 2.0 <= 1.03);
            if enough && (last.len() - 1) as f64 <= 1.12 * steps.total().ceil() {
                return last.clone();
            }
        }
        steps.stations(1)
    }

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        self.block.at(if self.plan.along_u { (x, y) } else { (y, x) })
    }

    fn inside(&mut self, x: f64, y: f64) -> u32 {
        let (u, v) = self.place(x, y);
        let point = *self.next_point;
        *self.next_point += 1;
        self.push(Corner { u, v, point, free: Free::Neither })
    }

    fn push(&mut self, corner: Corner) -> u32 {
        self.piece.corners.push(corner);
        index(self.piece.corners.len() - 1)
    }

    /// The corners of a rim at y = `at` (or, not along the rows, at x = `at`). Rims share their ends.
    fn rim(&mut self, cut: &Cut, at: f64, along: bool) -> Vec<Link> {
        let mut chain = Vec::with_capacity(cut.points.len());
        for (fraction, point) in cut.fractions.iter().zip(&cut.points) {
            let (x, y) = if along { (*fraction, at) } else { (at, *fraction) };
            let (u, v) = self.place(x, y);
            let pole = self.poles.iter().find(|(pole, _)| pole == point);
            let free = pole.map_or(Free::Neither, |(_, free)| *free);
            let corner = Corner { u, v, point: *point, free };
            let end = *fraction == 0.0 || *fraction == 1.0;
            let known = if end && free == Free::Neither {
                self.piece.corners.iter().position(|known| *known == corner)
            } else {
                None
            };
            let corner = known.map_or_else(|| self.push(corner), index);
            chain.push(Link { corner, place: *fraction });
        }
        chain
    }

    /// Fills the band between two chains; `upper` lies to the left of the way along `lower`.
    fn zip(&mut self, lower: &[Link], upper: &[Link]) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < lower.len() || j + 1 < upper.len() {
            let on_lower =
                j + 1 == upper.len() || (i + 1 < lower.len() && self.prefers(lower, upper, (i, j)));
            let triangle = if on_lower {
                i += 1;
                [lower[i - 1], lower[i], upper[j]]
            } else {
                j += 1;
                [lower[i], upper[j], upper[j - 1]]
            };
            let corners = triangle.map(|link| link.corner);
            if lower.len() == 1 || upper.len() == 1 {
                self.fan(corners);
            } else {
                self.piece.triangles.push(corners);
            }
        }
    }

    /// A triangle with one corner on a chain of a single point. On a pole that corner stands for the whole step.
    fn fan(&mut self, mut corners: [u32; 3]) {
        let at = |corner: u32| self.piece.corners[corner as usize];
        if let Some(pole) = corners.iter().position(|corner| at(*corner).free != Free::Neither) {
            let mut tip = at(corners[pole]);
            let (one, other) = (at(corners[(pole + 1) % 3]), at(corners[(pole + 2) % 3]));
            match tip.free {
                Free::U => tip.u = (one.u + other.u) / 2.0,
                Free::V => tip.v = (one.v + other.v) / 2.0,
                Free::Neither => {}
            }
            corners[pole] = self.push(tip);
        }
        self.piece.triangles.push(corners);
    }

    /// Whether the next triangle stands on the lower chain: the one whose new side spans less. Where both span
    /// alike, the side that bends less.
    fn prefers(&self, lower: &[Link], upper: &[Link], (i, j): (usize, usize)) -> bool {
        let forward = (lower[i + 1].place - upper[j].place).abs();
        let backward = (upper[j + 1].place - lower[i].place).abs();
        if (forward - backward).abs() > 1e-6 * (forward + backward) {
            return forward < backward;
        }
        let at = |link: &Link| self.piece.corners[link.corner as usize];
        let (a, b, c) = (at(&lower[i]), at(&lower[i + 1]), at(&upper[j + 1]));
        let (u, v) = ((a.u + c.u) / 2.0, (a.v + c.v) / 2.0);
        let (normal, second) = (self.block.jet(u, v).normal, self.block.second(u, v));
        let bend = |(du, dv): (f64, f64), (eu, ev): (f64, f64)| {
            second.uu.dot(normal) * du * eu
                + second.uv.dot(normal) * (du * ev + dv * eu)
                + second.vv.dot(normal) * dv * ev
        };
        // With e along the chain and f across, the diagonals bend by q(e) + q(f) plus or minus 2 q(e, f).
        let (along, across) = ((b.u - a.u, b.v - a.v), (c.u - b.u, c.v - b.v));
        (bend(along, along) + bend(across, across)) * bend(along, across) >= 0.0
    }
}

/// The middles between the places of a row, and its ends.
fn shifted(places: &[f64]) -> Vec<f64> {
    let (first, last) = (places[0], places[places.len() - 1]);
    let middles = places.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
    std::iter::once(first).chain(middles).chain(std::iter::once(last)).collect()
}

/// Leaves of the places of a row those between two, which become its ends.
fn trim(places: &mut Vec<f64>, from: f64, to: f64) {
    if from == to {
        *places = vec![from];
        return;
    }
    let step = 1.0 / (places.len() - 1) as f64;
    let margin = 0.4 * step.min(to - from);
    places.retain(|place| {
        (*place > from + margin || from == 0.0)
            && (*place < to - margin || to == 1.0)
            && *place > 0.0
            && *place < 1.0
    });
    places.insert(0, from);
    places.push(to);
}

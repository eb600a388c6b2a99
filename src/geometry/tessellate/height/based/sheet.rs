//! One skin as triangles between places.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::super::delaunay::{BORDER, Place, next};
use super::super::greedy::Triangles;
use super::super::ground::Ground;
use super::super::lattice::Lattice;
use super::super::round::Round;
use super::skin::Skin;
use super::twist;
use crate::geometry::mesh::index;

/// Triangles between corners, counter-clockwise over columns and rows.
pub(super) struct Sheet {
    /// In units.
    pub(super) places: Vec<Place>,
    /// In steps of the field.
    pub(super) steps: Vec<[f64; 2]>,
    pub(super) points: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Sides beyond which the sheet has no triangle, before it is closed in itself.
    pub(super) rim: Vec<[u32; 2]>,
    /// The far corner, in units.
    pub(super) far: Place,
    pub(super) round: Round,
}

impl Sheet {
    /// What is kept of a triangulation.
    pub(super) fn of(
        made: &Triangles<DVec3>,
        lattice: &Lattice<'_, Skin<'_>>,
        round: &Round,
        _: &Skin<'_>,
    ) -> Self {
        let mesh = &made.mesh;
        let mut numbers = vec![BORDER; mesh.places.len()];
        let mut sheet = Self {
            places: Vec::new(),
            steps: Vec::new(),
            points: Vec::new(),
            triangles: Vec::new(),
            rim: Vec::new(),
            far: lattice.far(),
            round: round.clone(),
        };
        for triangle in (0..mesh.triangles()).filter(|triangle| mesh.keeps(*triangle)) {
            let corners = mesh.corners_of(triangle).map(|corner| {
                let number = &mut numbers[corner as usize];
                if *number == BORDER {
                    *number = index(sheet.points.len());
                    let place = mesh.places[corner as usize];
                    sheet.places.push(place);
                    sheet.steps.push(lattice.steps(place));
                    sheet.points.push(made.heights[corner as usize]);
                }
                *number
            });
            sheet.triangles.push(corners);
            for side in 3 * triangle..3 * triangle + 3 {
                let beyond = mesh.beyond(side);
                if beyond == BORDER || !mesh.keeps(beyond / 3) {
                    let ends = [side, next(side)].map(|side| numbers[mesh.corners[side as usize] as usize]);
                    sheet.rim.push(ends);
                }
            }
        }
        for end in [0, 1] {
            if sheet.round.poles[end] && sheet.is_torn(end) {
                sheet.leave_out_cone(end);
            }
        }
        sheet
    }

    /// Whether what is kept touches itself in a pole.
    fn is_torn(&self, end: usize) -> bool {
        let pole = self.round.place(self.far, [0, if end == 0 { 0 } else { self.far[1] }]);
        self.open_sides().iter().filter(|ends| self.place(ends[0]) == pole).count() > 1
    }

    /// Takes away the triangles between a pole and its ring.
    fn leave_out_cone(&mut self, end: usize) {
        let ring = self.round.ring + 1;
        let (far, places) = (self.far[1], &self.places);
        let in_cone = |corner: &u32| {
            let row = places[*corner as usize][1];
            if end == 0 { row <= ring } else { row >= far - ring }
        };
        self.triangles.retain(|corners| !corners.iter().all(in_cone));
        let sides = self.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        let mut open = BTreeSet::new();
        for [from, to] in sides {
            if !open.remove(&[to, from]) {
                open.insert([from, to]);
            }
        }
        self.rim = open.into_iter().collect();
    }

    /// Sides with nothing beyond when seams and poles are closed.
    pub(super) fn open_sides(&self) -> Vec<[u32; 2]> {
        let mut found: BTreeMap<[Place; 2], [u32; 2]> = BTreeMap::new();
        for ends in &self.rim {
            let [from, to] = ends.map(|corner| self.place(corner));
            if from == to || found.remove(&[to, from]).is_some() {
                continue;
            }
            found.insert([from, to], *ends);
        }
        found.into_values().collect()
    }

    /// The whole grid, each cell cut along its shorter diagonal, and how far it is from the skin.
    pub(super) fn dense(skin: &Skin<'_>, round: &Round) -> (Self, f64) {
        let grid = skin.grid();
        let (columns, rows) = (grid.columns(), grid.rows());
        let points = skin.samples().into_owned();
        let place = |at: usize| [at % columns, at / columns];
        let whole = |part: usize| i32::try_from(part).unwrap_or(i32::MAX);
        let mut bound = 0.0_f64;
        let mut triangles = Vec::with_capacity(2 * (columns - 1) * (rows - 1));
        for j in 0..rows - 1 {
            for i in 0..columns - 1 {
                let at = j * columns + i;
                let corners = [at, at + 1, at + columns + 1, at + columns];
                let [a, b, c, d] = corners.map(|at| points[at]);
                bound = bound.max(twist([a, b, c, d]));
                let [p, q, r, s] = corners.map(index);
                // At a point the diagonals end in one place.
                let pair = if a.distance_squared(c) <= b.distance_squared(d) {
                    [[p, q, r], [p, r, s]]
                } else {
                    [[p, q, s], [q, r, s]]
                };
                triangles.extend(pair);
            }
        }
        let last = rows - 1;
        let ring: Vec<usize> = (0..columns - 1)
            .chain((0..last).map(|j| j * columns + columns - 1))
            .chain((1..columns).rev().map(|i| last * columns + i))
            .chain((1..rows).rev().map(|j| j * columns))
            .collect();
        let rim = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b].map(index)).collect();
        let sheet = Self {
            places: (0..columns * rows).map(|at| place(at).map(whole)).collect(),
            steps: (0..columns * rows).map(|at| place(at).map(|part| part as f64)).collect(),
            points,
            triangles,
            rim,
            far: [columns - 1, rows - 1].map(whole),
            round: round.clone(),
        };
        (sheet, bound + skin.bend() / 8.0)
    }

    /// The place that stands for all places of a corner's point.
    pub(super) fn place(&self, corner: u32) -> Place {
        self.round.place(self.far, self.places[corner as usize])
    }
}

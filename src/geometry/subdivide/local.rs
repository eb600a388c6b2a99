//! One vertex and its neighbors under Catmull-Clark or Loop: the step that maps them to themselves, and where they end.
//!
//! The ring of a vertex after a step depends on its ring before alone. So what is left of fading creases is followed by
//! products of small matrices; after that the limit masks hold: of M. Halstead, M. Kass, T. `DeRose`, "Efficient, Fair
//! Interpolation Using Catmull-Clark Surfaces", 1993; H. Hoppe et al., 1994, for Loop's. Across creases the published masks
//! (H. Biermann, A. Levin, D. Zorin, "Piecewise Smooth Subdivision Surfaces with Normal Control", 2000) are those of a
//! modified step where the crease is not regular; here they are carried on to the eigenvectors of the step itself. Where a
//! crease that never fades ends in a smooth place, the limit is that of powers of the step.

use std::f64::consts::{PI, TAU};

use super::primal::loop_weight;
use super::sharpness::{Around, ENDLESS, VertexClass};
use crate::geometry::mesh::index;
use crate::geometry::number::{cos, sin};

/// Weights of the ring: the vertex, the far ends of its edges, and with quads the opposite corners of its faces.
pub(super) type Weights = Vec<f64>;

/// The shape of a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Local {
    pub(super) quads: bool,
    pub(super) edges: usize,
    pub(super) faces: usize,
}

/// Where a vertex ends, as weights of its ring.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LocalLimit {
    pub(super) position: Weights,
    pub(super) sectors: Vec<Sector>,
}

/// Faces around a vertex that look smooth together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sector {
    /// Its first face in the ring.
    pub(super) first: usize,
    /// How many faces it has.
    pub(super) count: usize,
    /// Two directions in the surface, the second counterclockwise of the first; none where the faces decide.
    pub(super) tangents: Option<[Weights; 2]>,
}

impl Local {
    pub(super) fn size(self) -> usize {
        1 + self.edges + if self.quads { self.faces } else { 0 }
    }

    fn closed(self) -> bool {
        self.edges == self.faces
    }

    fn edge(self, edge: usize) -> usize {
        1 + edge % self.edges
    }

    fn face(self, face: usize) -> usize {
        1 + self.edges + face % self.faces
    }

    fn zero(self) -> Weights {
        vec![0.0; self.size()]
    }

    /// The limit of a vertex with this sharpness around it.
    pub(super) fn limit(self, around: &Around, known: &mut Known) -> LocalLimit {
        if !around.fades() {
            return self.settled(around, known);
        }
        let mut around = around.clone();
        let mut steps = self.identity();
        while around.fades() {
            steps = product(&self.step(&around), &steps);
            around.wear();
        }
        let mut limit = self.settled(&around, known);
        limit.position = through(&limit.position, &steps);
        for sector in &mut limit.sectors {
            if let Some(tangents) = &mut sector.tangents {
                tangents.iter_mut().for_each(|tangent| *tangent = through(tangent, &steps));
            }
        }
        limit
    }

    /// The limit when all sharpness that is left is endless.
    fn settled(self, around: &Around, known: &mut Known) -> LocalLimit {
        let sharp: Vec<usize> = (0..self.edges).filter(|edge| around.edges[*edge] > 0.0).collect();
        match around.class() {
            VertexClass::Smooth => LocalLimit { position: self.smooth(), sectors: vec![self.whole(true)] },
            VertexClass::Dart => {
                let mut step = self.step(around);
                // 2^6 steps: what is not the limit is below rounding.
                (0..6).for_each(|_| step = product(&step, &step));
                LocalLimit { position: step.swap_remove(0), sectors: vec![self.whole(true)] }
            }
            VertexClass::Crease => {
                let mut position = self.zero();
                position[0] = 4.0 / 6.0;
                sharp.iter().for_each(|edge| position[self.edge(*edge)] = 1.0 / 6.0);
                LocalLimit { position, sectors: self.sectors(&sharp, Some(known)) }
            }
            VertexClass::Corner => {
                let mut position = self.zero();
                position[0] = 1.0;
                let sectors =
                    if sharp.is_empty() { vec![self.whole(false)] } else { self.sectors(&sharp, None) };
                LocalLimit { position, sectors }
            }
        }
    }

    fn whole(self, smooth: bool) -> Sector {
        Sector { first: 0, count: self.faces, tangents: smooth.then(|| self.smooth_tangents()) }
    }

    fn sectors(self, sharp: &[usize], mut known: Option<&mut Known>) -> Vec<Sector> {
        let next = |place: usize| match sharp.get(place + 1) {
            Some(edge) => *edge,
            None => sharp[0] + self.edges,
        };
        let all = sharp.iter().enumerate().map(|(place, first)| (*first, next(place) - first));
        // Outside of a border there is no sector.
        let inside = if self.closed() { sharp.len() } else { sharp.len() - 1 };
        let made = |(first, count): (usize, usize)| Sector {
            first,
            count,
            tangents: known.as_deref_mut().map(|known| self.crease_tangents(first, count, known)),
        };
        all.take(inside).map(made).collect()
    }

    fn smooth(self) -> Weights {
        let n = f64::from(index(self.edges));
        let mut position = self.zero();
        if self.quads {
            let sum = n * (n + 5.0);
            position[0] = n * n / sum;
            (0..self.edges).for_each(|edge| position[self.edge(edge)] = 4.0 / sum);
            (0..self.faces).for_each(|face| position[self.face(face)] = 1.0 / sum);
        } else {
            let weight = 1.0 / (n + 0.375 / loop_weight(self.edges));
            position[0] = 1.0 - n * weight;
            (0..self.edges).for_each(|edge| position[self.edge(edge)] = weight);
        }
        position
    }

    fn smooth_tangents(self) -> [Weights; 2] {
        if self.edges == 2 && self.quads {
            // Two faces only: from one to the other, and across.
            let between = |one: usize, other: usize| {
                let mut tangent = self.zero();
                (tangent[one], tangent[other]) = (1.0, -1.0);
                tangent
            };
            return [between(self.edge(0), self.edge(1)), between(self.face(0), self.face(1))];
        }
        let turn = TAU / f64::from(index(self.edges));
        let reach = 1.0 + cos(turn) + cos(turn / 2.0) * (2.0 * (9.0 + cos(turn))).sqrt();
        let along = |wave: fn(f64) -> f64| {
            let mut tangent = self.zero();
            for edge in 0..self.edges {
                let at = |step: usize| wave(turn * f64::from(index(edge + step)));
                tangent[self.edge(edge)] = if self.quads { reach * at(0) } else { at(0) };
                if self.quads {
                    tangent[self.face(edge)] = at(0) + at(1);
                }
            }
            tangent
        };
        [along(cos), along(sin)]
    }

    /// Along a crease and across it, into a sector.
    fn crease_tangents(self, first: usize, count: usize, known: &mut Known) -> [Weights; 2] {
        let mut along = self.zero();
        along[self.edge(first)] += 1.0;
        along[self.edge(first + count)] -= 1.0;
        let sector = Self { quads: self.quads, edges: count + 1, faces: count };
        let own = known.across(sector);
        let mut across = self.zero();
        across[0] = own[0];
        (0..=count).for_each(|step| across[self.edge(first + step)] += own[sector.edge(step)]);
        if self.quads {
            (0..count).for_each(|step| across[self.face(first + step)] += own[sector.face(step)]);
        }
        [along, across]
    }

    /// Across the crease at the rim of this ring, inward: the published mask carried on under the step.
    fn across(self) -> Weights {
        /// Steps until what shrinks faster is below rounding, and the largest ring for which they are made.
        const POWERS: u32 = 400;
        const LARGEST: usize = 32;
        let mut across =
            if self.quads { self.across_quads(0, self.faces) } else { self.across_triangles(0, self.faces) };
        if self.faces == 1 || self.faces > LARGEST {
            return across;
        }
        let mut around = Around { vertex: 0.0, edges: vec![0.0; self.edges] };
        (around.edges[0], around.edges[self.faces]) = (ENDLESS, ENDLESS);
        let step = self.step(&around);
        for _ in 0..POWERS {
            across = through(&across, &step);
            // No part of the limit itself: it alone has a sum.
            let sum: f64 = across.iter().sum();
            across[0] -= sum * (4.0 / 6.0);
            across[1] -= sum / 6.0;
            across[self.edges] -= sum / 6.0;
            let size = across.iter().fold(0.0, |size: f64, part| size.max(part.abs()));
            across.iter_mut().for_each(|part| *part /= size);
        }
        across
    }

    fn across_quads(self, first: usize, count: usize) -> Weights {
        let mut across = self.zero();
        if count == 1 {
            across[0] = -6.0;
            across[self.edge(first)] += 3.0;
            across[self.edge(first + 1)] += 3.0;
            return across;
        }
        let angle = PI / f64::from(index(count));
        let wave = |step: usize| sin(angle * f64::from(index(step)));
        let ratio = (cos(angle) + 1.0) / sin(angle);
        across[0] = 4.0 * ratio * (cos(angle) - 1.0);
        across[self.edge(first)] = -ratio * (1.0 + 2.0 * cos(angle));
        across[self.edge(first + count)] = -ratio * (1.0 + 2.0 * cos(angle));
        (1..count).for_each(|step| across[self.edge(first + step)] = 4.0 * wave(step));
        (0..count).for_each(|step| across[self.face(first + step)] = wave(step) + wave(step + 1));
        across
    }

    fn across_triangles(self, first: usize, count: usize) -> Weights {
        let mut across = self.zero();
        let mut set = |step: usize, weight: f64| across[self.edge(first + step)] = weight;
        match count {
            1 => {
                set(0, 1.0);
                set(1, 1.0);
                across[0] = -2.0;
            }
            2 => {
                set(1, 1.0);
                across[0] = -1.0;
            }
            3 => {
                [-1.0, 2.0, 2.0, -1.0].into_iter().enumerate().for_each(|(step, weight)| set(step, weight));
                across[0] = -2.0;
            }
            _ => {
                let angle = PI / f64::from(index(count));
                set(0, -sin(angle));
                set(count, -sin(angle));
                for step in 1..count {
                    set(step, (2.0 - 2.0 * cos(angle)) * sin(angle * f64::from(index(step))));
                }
            }
        }
        across
    }

    fn identity(self) -> Vec<Weights> {
        let unit = |row: usize| {
            let mut weights = self.zero();
            weights[row] = 1.0;
            weights
        };
        (0..self.size()).map(unit).collect()
    }

    /// The ring after a step, in terms of the ring before.
    pub(super) fn step(self, around: &Around) -> Vec<Weights> {
        let mut rows = vec![self.vertex_row(around)];
        rows.extend((0..self.edges).map(|edge| self.edge_row(edge, around.edges[edge])));
        if self.quads {
            rows.extend((0..self.faces).map(|face| {
                let mut row = self.zero();
                self.add_face(&mut row, face, 1.0);
                row
            }));
        }
        rows
    }

    fn add_face(self, row: &mut Weights, face: usize, weight: f64) {
        for place in [0, self.edge(face), self.face(face), self.edge(face + 1)] {
            row[place] += weight / 4.0;
        }
    }

    fn vertex_row(self, around: &Around) -> Weights {
        let mut row = self.zero();
        for (class, after, share) in around.rules().into_iter().filter(|rule| rule.2 > 0.0) {
            match class {
                VertexClass::Smooth | VertexClass::Dart => self.add_smooth(&mut row, share),
                VertexClass::Crease => {
                    row[0] += 0.75 * share;
                    around
                        .crease_edges(after)
                        .into_iter()
                        .for_each(|edge| row[self.edge(edge)] += 0.125 * share);
                }
                VertexClass::Corner => row[0] += share,
            }
        }
        row
    }

    fn add_smooth(self, row: &mut Weights, share: f64) {
        let n = f64::from(index(self.edges));
        if self.quads {
            row[0] += share * (n - 2.0) / n;
            (0..self.edges).for_each(|edge| row[self.edge(edge)] += share / (n * n));
            (0..self.faces).for_each(|face| self.add_face(row, face, share / (n * n)));
        } else {
            let weight = loop_weight(self.edges);
            row[0] += share * (1.0 - n * weight);
            (0..self.edges).for_each(|edge| row[self.edge(edge)] += share * weight);
        }
    }

    fn edge_row(self, edge: usize, sharpness: f64) -> Weights {
        let (mut row, sharp) = (self.zero(), sharpness.min(1.0));
        let smooth = 1.0 - sharp;
        row[0] += 0.5 * sharp;
        row[self.edge(edge)] += 0.5 * sharp;
        if smooth == 0.0 {
            return row;
        }
        // Edges of borders are sharp, so this one has neighbors on both sides.
        let before = edge + self.edges - 1;
        if self.quads {
            row[0] += 0.25 * smooth;
            row[self.edge(edge)] += 0.25 * smooth;
            self.add_face(&mut row, edge, 0.25 * smooth);
            self.add_face(&mut row, if self.closed() { before } else { edge - 1 }, 0.25 * smooth);
        } else {
            row[0] += 0.375 * smooth;
            row[self.edge(edge)] += 0.375 * smooth;
            row[self.edge(edge + 1)] += 0.125 * smooth;
            row[self.edge(before)] += 0.125 * smooth;
        }
        row
    }
}

/// Masks across creases by the number of faces of their sector.
#[derive(Default)]
pub(super) struct Known(Vec<Option<Weights>>);

impl Known {
    fn across(&mut self, sector: Local) -> &Weights {
        if self.0.len() <= sector.faces {
            self.0.resize(sector.faces + 1, None);
        }
        self.0[sector.faces].get_or_insert_with(|| sector.across())
    }
}

/// Weights of the ring after some steps, in terms of the ring before them.
fn through(weights: &Weights, steps: &[Weights]) -> Weights {
    let mut sum = vec![0.0; weights.len()];
    for (weight, row) in weights.iter().zip(steps) {
        sum.iter_mut().zip(row).for_each(|(sum, part)| *sum += weight * part);
    }
    sum
}

fn product(left: &[Weights], right: &[Weights]) -> Vec<Weights> {
    left.iter().map(|row| through(row, right)).collect()
}

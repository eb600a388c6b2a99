//! Values and normals on the limit surface, for each vertex of a level.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Scheme;
use super::level::{Channel, Level};
use super::local::{Known, Local, LocalLimit, Sector};
use super::mask::{Mask, apply};
use super::root3;
use super::sharpness::{Around, VertexClass};
use super::topology::{NONE, Ring};
use crate::geometry::mesh::index;
use crate::geometry::number::{cos, sin};

/// A level moved to where its vertices end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limit {
    /// Values of the vertices.
    pub channels: Vec<Channel>,
    /// Unit normals.
    pub normals: Vec<DVec3>,
    /// For each corner its normal; on both sides of a crease there are different ones.
    pub corner_normals: Vec<u32>,
}

pub(super) fn position(channel: &Channel, vertex: u32) -> DVec3 {
    DVec3::from_slice(channel.value(vertex as usize))
}

/// The limit of a level whose faces are those of the scheme: quads for Catmull-Clark, so at least one step has been made.
/// Not for the schemes that cut corners; see [`dual_limit`](super::dual_limit()). O(n).
#[must_use]
pub fn limit(level: &Level, scheme: Scheme) -> Limit {
    let mut made = Limit {
        channels: level
            .channels
            .iter()
            .map(|channel| Channel { width: channel.width, values: Vec::new() })
            .collect(),
        normals: Vec::with_capacity(level.topology.vertices()),
        corner_normals: vec![NONE; level.topology.corners()],
    };
    let mut work = Work {
        level,
        scheme,
        ring: Ring::default(),
        around: Around::default(),
        known: Vec::new(),
        across: Known::default(),
    };
    let mut mask = Mask::default();
    for vertex in 0..index(level.topology.vertices()) {
        level.topology.ring(vertex, &mut work.ring);
        let local = work.local();
        work.places(&local.position, &mut mask);
        apply(&mask, &level.channels, &mut made.channels);
        for sector in &local.sectors {
            let number = index(made.normals.len());
            for face in sector.first..sector.first + sector.count {
                let corner = work.ring.corners[face % work.ring.corners.len()];
                made.corner_normals[corner as usize] = number;
            }
            let normal = work.normal(sector, &mut mask);
            made.normals.push(normal);
        }
    }
    made
}

struct Work<'a> {
    level: &'a Level,
    scheme: Scheme,
    ring: Ring,
    around: Around,
    /// Limits of smooth vertices by their valence.
    known: Vec<Option<LocalLimit>>,
    across: Known,
}

impl Work<'_> {
    fn local(&mut self) -> LocalLimit {
        let (edges, faces) = (self.ring.valence(), self.ring.corners.len());
        let local = Local { quads: self.scheme == Scheme::CatmullClark, edges, faces };
        match self.scheme {
            Scheme::CatmullClark | Scheme::Loop => {
                self.around.read(self.level, &self.ring);
                if self.around.class() != VertexClass::Smooth {
                    return local.limit(&self.around, &mut self.across);
                }
                self.remembered(edges, |around| local.limit(around, &mut Known::default()))
            }
            Scheme::Root3 => self.root3(local),
            Scheme::Butterfly => self.butterfly(local),
            _ => only_faces(local),
        }
    }

    fn remembered(&mut self, valence: usize, make: impl Fn(&Around) -> LocalLimit) -> LocalLimit {
        if self.known.len() <= valence {
            self.known.resize(valence + 1, None);
        }
        let around = &self.around;
        self.known[valence].get_or_insert_with(|| make(around)).clone()
    }

    fn root3(&mut self, local: Local) -> LocalLimit {
        if self.ring.is_closed() {
            return self.remembered(local.edges, |_| {
                let share = 3.0 * root3::relaxation(local.edges);
                let share = share / (1.0 + share);
                let mut position = vec![share / f64::from(index(local.edges)); local.size()];
                position[0] = 1.0 - share;
                LocalLimit { position, sectors: vec![waves(local)] }
            });
        }
        let mut made = only_faces(local);
        if self.level.vertex_sharpness(self.ring.vertex) == 0.0 {
            made.position[0] = 4.0 / 6.0;
            made.position[1] = 1.0 / 6.0;
            made.position[local.edges] = 1.0 / 6.0;
        }
        made
    }

    fn butterfly(&mut self, local: Local) -> LocalLimit {
        let mut made = only_faces(local);
        if self.ring.is_closed() {
            made.sectors = vec![waves(local)];
        }
        made
    }

    /// Weights of the ring as weights of vertices.
    fn places(&self, weights: &[f64], mask: &mut Mask) {
        let topology = &self.level.topology;
        mask.0.clear();
        let ring = &self.ring;
        let around = ring.far.iter().copied();
        let opposite = ring
            .corners
            .iter()
            .map(|corner| topology.corner_vertex[topology.next(topology.next(*corner)) as usize]);
        let all = std::iter::once(ring.vertex).chain(around).chain(opposite);
        mask.0.extend(all.zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0));
    }

    fn direction(&self, weights: &[f64], mask: &mut Mask) -> DVec3 {
        self.places(weights, mask);
        let positions = &self.level.channels[0];
        mask.0.iter().map(|(vertex, weight)| position(positions, *vertex) * *weight).sum()
    }

    fn normal(&self, sector: &Sector, mask: &mut Mask) -> DVec3 {
        if let Some([one, other]) = &sector.tangents {
            let (mut one, mut other) = (self.direction(one, mask), self.direction(other, mask));
            if self.scheme == Scheme::Butterfly {
                let [far_one, far_other] = self.butterfly_beyond();
                (one, other) = (one + far_one, other + far_other);
            }
            let normal = one.cross(other);
            // Tangents that lie along one another say nothing.
            if normal.length() > 1e-12 * one.length() * other.length() {
                return normal.normalize();
            }
        }
        self.normal_of_faces(sector)
    }

    /// The sum of the faces' normals at the vertex.
    fn normal_of_faces(&self, sector: &Sector) -> DVec3 {
        let positions = &self.level.channels[0];
        let here = position(positions, self.ring.vertex);
        let arm = |edge: usize| position(positions, self.ring.far[edge % self.ring.far.len()]) - here;
        let faces = sector.first..sector.first + sector.count;
        let sum: DVec3 = faces.map(|face| arm(face).cross(arm(face + 1))).sum();
        sum.try_normalize().unwrap_or(DVec3::Y)
    }

    /// What the second ring adds to both tangents of a regular vertex among regular ones: the left eigenvectors of the
    /// Butterfly step to 1/2 have on the first ring the cosines and sines `c` of their angles, on the vertices across the
    /// ring's edges `-c sqrt(3)/6` of the angles between, and straight on `c / 16`.
    fn butterfly_beyond(&self) -> [DVec3; 2] {
        let topology = &self.level.topology;
        let regular = |vertex: u32| {
            let mut ring = Ring::default();
            topology.ring(vertex, &mut ring);
            ring.is_closed() && ring.valence() == 6
        };
        if !regular(self.ring.vertex) || !self.ring.far.iter().all(|far| regular(*far)) {
            return [DVec3::ZERO; 2];
        }
        let positions = &self.level.channels[0];
        let at = |corner: u32| position(positions, topology.corner_vertex[corner as usize]);
        let mut sums = [DVec3::ZERO; 2];
        for (step, corner) in self.ring.corners.iter().enumerate() {
            let outer = topology.twin[topology.next(*corner) as usize];
            let between = at(topology.before(outer));
            // Straight on over the far end of edge `step`: from the outer triangle one face further round it.
            let beyond = topology.twin[topology.next(outer) as usize];
            let beyond = at(topology.before(beyond));
            let angle = TAU / 6.0 * f64::from(index(step));
            let half = angle + TAU / 12.0;
            for (sum, wave) in sums.iter_mut().zip([cos as fn(f64) -> f64, sin]) {
                *sum += beyond * (wave(angle) / 16.0) - between * (wave(half) * 3.0_f64.sqrt() / 6.0);
            }
        }
        sums
    }
}

/// A vertex that stays, with the normal of its faces.
fn only_faces(local: Local) -> LocalLimit {
    let mut position = vec![0.0; local.size()];
    position[0] = 1.0;
    LocalLimit { position, sectors: vec![Sector { first: 0, count: local.faces, tangents: None }] }
}

/// Tangents by the first waves around the ring.
fn waves(local: Local) -> Sector {
    let turn = TAU / f64::from(index(local.edges));
    let along = |wave: fn(f64) -> f64| {
        let mut weights = vec![0.0; local.size()];
        (0..local.edges).for_each(|edge| weights[1 + edge] = wave(turn * f64::from(index(edge))));
        weights
    };
    Sector { first: 0, count: local.faces, tangents: Some([along(cos), along(sin)]) }
}

//! One level of refinement: topology, sharpness and values.

use super::sharpness::{ENDLESS, worn};
use super::split::{self, Dual, Root3};
use super::topology::Topology;
use super::{Scheme, Split};

/// Values at the vertices: `width` numbers each, such as a position, a texture coordinate or weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// Numbers of one value.
    pub width: usize,
    /// The numbers of all values, one value after another.
    pub values: Vec<f64>,
}

impl Channel {
    /// The value of a vertex.
    #[must_use]
    pub fn value(&self, vertex: usize) -> &[f64] {
        &self.values[vertex * self.width..(vertex + 1) * self.width]
    }
}

/// A mesh between two steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// Who touches whom.
    pub topology: Topology,
    /// What the vertices carry; the first channel is the position.
    pub channels: Vec<Channel>,
    /// Sharpness of the edges; empty when none is sharp but those of borders, which always are.
    pub(super) edge_sharpness: Vec<f64>,
    /// Sharpness of the vertices; empty when none is sharp.
    pub(super) vertex_sharpness: Vec<f64>,
    /// Steps made before.
    pub(super) step: u32,
}

/// What the vertices of the next level stand for.
pub(super) enum Born {
    /// Old vertices, edges, and perhaps faces, in this order.
    Primal { faces: bool },
    /// Old vertices and these.
    Root3(Vec<Root3>),
    /// These alone.
    Dual(Vec<Dual>),
}

impl Level {
    /// The sharpness of an edge; a border's never ends.
    pub(super) fn edge_sharpness(&self, edge: u32) -> f64 {
        if self.topology.is_border(edge) {
            return ENDLESS;
        }
        self.edge_sharpness.get(edge as usize).copied().unwrap_or(0.0)
    }

    pub(super) fn vertex_sharpness(&self, vertex: u32) -> f64 {
        self.vertex_sharpness.get(vertex as usize).copied().unwrap_or(0.0)
    }

    /// The next level without values.
    pub(super) fn split(&self, scheme: Scheme) -> (Self, Born) {
        let old = &self.topology;
        let (topology, born) = match scheme.split() {
            Split::Quads => (split::quads(old), Born::Primal { faces: true }),
            Split::Triangles => (split::triangles(old), Born::Primal { faces: false }),
            Split::Root3 => {
                let (topology, new) = split::root3(old, self.step % 2 == 1);
                (topology, Born::Root3(new))
            }
            Split::Dual => {
                let (topology, new) = split::dual(old);
                (topology, Born::Dual(new))
            }
        };
        let mut made = Self { topology, step: self.step + 1, ..Self::default() };
        match born {
            Born::Primal { .. } => made.inherit_sharpness(self),
            // Ends of borders, which never fade.
            Born::Root3(_) if !self.vertex_sharpness.is_empty() => {
                made.vertex_sharpness.clone_from(&self.vertex_sharpness);
                made.vertex_sharpness.resize(made.topology.vertices(), 0.0);
            }
            Born::Root3(_) | Born::Dual(_) => {}
        }
        (made, born)
    }

    /// Halves of an edge have the old numbers doubled; vertices keep their numbers.
    fn inherit_sharpness(&mut self, old: &Self) {
        if old.edge_sharpness.iter().any(|sharpness| worn(*sharpness) > 0.0) {
            self.edge_sharpness = vec![0.0; self.topology.edges()];
            for (edge, sharpness) in old.edge_sharpness.iter().enumerate() {
                self.edge_sharpness[2 * edge..2 * edge + 2].fill(worn(*sharpness));
            }
        }
        if old.vertex_sharpness.iter().any(|sharpness| worn(*sharpness) > 0.0) {
            self.vertex_sharpness = vec![0.0; self.topology.vertices()];
            for (vertex, sharpness) in old.vertex_sharpness.iter().enumerate() {
                self.vertex_sharpness[vertex] = worn(*sharpness);
            }
        }
    }
}

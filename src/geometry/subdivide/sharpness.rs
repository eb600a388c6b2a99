//! Creases: what kind of place a vertex is, and how sharp edges lose their sharpness.
//!
//! Sharpness falls by one with each step and then ends smooth; between 1 and 0 rules are mixed. Rules and mixture are
//! `OpenSubdiv`'s ("uniform" creasing) after T. `DeRose`, M. Kass, T. Truong, "Subdivision Surfaces in Character
//! Animation", 1998; the classes are those of H. Hoppe et al., "Piecewise Smooth Surface Reconstruction", 1994.

use super::level::Level;
use super::topology::Ring;

/// Sharpness from here on never ends.
pub const ENDLESS: f64 = 10.0;

/// What the edges around a vertex make of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VertexClass {
    /// No sharp edge.
    Smooth,
    /// One: a crease ends here.
    Dart,
    /// Two: a crease goes through.
    Crease,
    /// More, or the vertex is sharp itself.
    Corner,
}

/// Sharpness after one step.
pub(super) fn worn(sharpness: f64) -> f64 {
    if sharpness >= ENDLESS { sharpness } else { (sharpness - 1.0).max(0.0) }
}

/// The class of a vertex of a sharpness with edges of these.
pub(super) fn class(vertex: f64, edges: impl Iterator<Item = f64>) -> VertexClass {
    if vertex > 0.0 {
        return VertexClass::Corner;
    }
    match edges.filter(|edge| *edge > 0.0).count() {
        0 => VertexClass::Smooth,
        1 => VertexClass::Dart,
        2 => VertexClass::Crease,
        _ => VertexClass::Corner,
    }
}

/// Sharpness around a vertex: its own and that of its edges.
#[derive(Clone, Debug, Default)]
pub(super) struct Around {
    pub(super) vertex: f64,
    pub(super) edges: Vec<f64>,
}

impl Around {
    pub(super) fn read(&mut self, level: &Level, ring: &Ring) {
        self.vertex = level.vertex_sharpness(ring.vertex);
        self.edges.clear();
        self.edges.extend(ring.edges.iter().map(|edge| level.edge_sharpness(*edge)));
    }

    pub(super) fn class(&self) -> VertexClass {
        class(self.vertex, self.edges.iter().copied())
    }

    fn class_after(&self) -> VertexClass {
        class(worn(self.vertex), self.edges.iter().map(|edge| worn(*edge)))
    }

    /// Whether anything here is sharp but not for ever.
    pub(super) fn fades(&self) -> bool {
        let fading = |sharpness: f64| sharpness > 0.0 && sharpness < ENDLESS;
        fading(self.vertex) || self.edges.iter().any(|edge| fading(*edge))
    }

    pub(super) fn wear(&mut self) {
        self.vertex = worn(self.vertex);
        self.edges.iter_mut().for_each(|edge| *edge = worn(*edge));
    }

    /// The rules that hold for the vertex, each with its share: of this level, and of the next where that differs.
    pub(super) fn rules(&self) -> [(VertexClass, bool, f64); 2] {
        let (now, after) = (self.class(), self.class_after());
        if now <= VertexClass::Dart || now == after {
            return [(now, false, 1.0), (after, true, 0.0)];
        }
        let share = self.share();
        [(now, false, share), (after, true, 1.0 - share)]
    }

    /// The mean of the sharpnesses that end with this step, at most 1.
    fn share(&self) -> f64 {
        let all = self.edges.iter().chain(std::iter::once(&self.vertex));
        let (sum, count) = all
            .filter(|sharpness| **sharpness > 0.0 && worn(**sharpness) == 0.0)
            .fold((0.0, 0.0), |(sum, count), sharpness| (sum + sharpness, count + 1.0));
        if count == 0.0 { 0.0 } else { f64::min(sum / count, 1.0) }
    }

    /// The two edges of a crease, of this level or as they are after the step.
    pub(super) fn crease_edges(&self, after: bool) -> [usize; 2] {
        let sharp = |edge: f64| if after { worn(edge) > 0.0 } else { edge > 0.0 };
        let mut found = (0..self.edges.len()).filter(|edge| sharp(self.edges[*edge]));
        let first = found.next().unwrap_or(0);
        [first, found.next().unwrap_or(first)]
    }
}

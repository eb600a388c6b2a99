//! What came of a file: sizes, counts, and by how much a reader is off.

use serde::Serialize;

use super::column::{Column, Measure};
use super::set::Tally;
use crate::geometry::number::asin;

/// What came of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Bytes of the file and of those that it reads.
    pub bytes: Change<u64>,
    /// Triangles that primitives draw, each once however many nodes show it.
    pub triangles: Change<u64>,
    /// Vertices of what is not left as it is.
    pub vertices: Change<u64>,
    /// Vertices that are transformed for each triangle, by a cache of 16, first in and first out.
    pub acmr: Change<f64>,
    /// By how much a reader is off at most.
    pub errors: Errors,
    /// What was left as it is, and why.
    pub notes: Vec<String>,
}

/// Before and after.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change<T> {
    /// Before.
    pub before: T,
    /// After.
    pub after: T,
}

/// The greatest differences between what a reader finds before and after.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Of positions, also in each state of a morph target, in units of the scene.
    pub positions: f64,
    /// Of normals, degrees.
    pub normals: f64,
    /// Of tangents, degrees.
    pub tangents: f64,
    /// Of texture coordinates.
    pub uvs: f64,
    /// Of colors, of which 1 is the most.
    pub colors: f64,
    /// Of the shares of joints.
    pub weights: f64,
    /// Of keys that turn nodes, degrees.
    pub rotations: f64,
    /// Of keys that move nodes, in units of what is above the node.
    pub translations: f64,
    /// Of keys that scale nodes.
    pub scales: f64,
    /// Of keys of the weights of morph targets.
    pub morphs: f64,
}

/// The angle over a chord of the unit sphere, degrees.
fn degrees(chord: f64) -> f64 {
    2.0 * asin((chord / 2.0).min(1.0)).to_degrees()
}

impl Errors {
    /// Takes what a column is off.
    pub(super) fn column(&mut self, column: &Column) {
        let (own, error) = match column.measure {
            Measure::Positions => (&mut self.positions, column.error),
            Measure::Normals => (&mut self.normals, degrees(column.error)),
            Measure::Tangents => (&mut self.tangents, degrees(column.error)),
            Measure::Uvs => (&mut self.uvs, column.error),
            Measure::Colors => (&mut self.colors, column.error),
            Measure::Weights => (&mut self.weights, column.error),
            Measure::Nothing => return,
        };
        *own = own.max(error);
    }

    /// Takes the distance of two quaternions.
    pub(super) fn turn(&mut self, distance: f64) {
        // A turn goes twice as far as its quaternion.
        self.rotations = self.rotations.max(2.0 * degrees(distance));
    }

    /// Takes what a key is off.
    pub(super) fn key(&mut self, path: &str, error: f64) {
        let own = match path {
            "translation" => &mut self.translations,
            "scale" => &mut self.scales,
            _ => &mut self.morphs,
        };
        *own = own.max(error);
    }
}

/// Misses for each triangle; 0 where there are none.
pub(super) fn acmr(tallies: &[Tally]) -> Change<f64> {
    let of = |when: usize| {
        let misses: u64 = tallies.iter().map(|tally| tally.misses[when]).sum();
        let triangles: usize = tallies.iter().map(|tally| tally.triangles[when]).sum();
        if triangles == 0 { 0.0 } else { misses as f64 / triangles as f64 }
    };
    Change { before: of(0), after: of(1) }
}

/// A sum over all tallies.
pub(super) fn total(tallies: &[Tally], of: impl Fn(&Tally) -> [usize; 2]) -> Change<u64> {
    let sum = |when: usize| tallies.iter().map(|tally| of(tally)[when] as u64).sum();
    Change { before: sum(0), after: sum(1) }
}

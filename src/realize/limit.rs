//! Limits, before and after meshes are made.

use std::sync::atomic::{AtomicU64, Ordering};

use super::RealizeError;
use crate::geometry::mesh::{Mesh, Vertex, Wire, WirePoint};
use crate::model::{Displacement, Limits, Model, Recipe};

/// What a mesh takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cost {
    triangles: u64,
    vertices: u64,
    /// Bytes of the mesh in memory and in the file.
    memory: u64,
}

/// Bytes that a triangle takes at most while it is made, with its share of vertices (half a vertex each on a large smooth
/// mesh), in memory and in the file. Figures are what the peak of a whole process grew by for each triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Working {
    /// It is cut from a surface with parameters.
    Surface,
    /// It is cut from a formula, which is asked for bounds.
    Formula,
    /// It is found in a field: first triangles, bounds and corners that move stand beside it.
    Field,
    /// It is a face of a cage that is refined, with the level before.
    Subdivided,
    /// It is bent, twisted or tapered.
    Deformed,
    /// It is moved along its normal.
    Displaced,
    /// It is one of those that solids are combined from: halves of edges, boxes and crossings stand beside it.
    Combined,
    /// It is one of those that are wrapped by a hull.
    Wrapped,
    /// It is one of those whose distance a field asks for: what they meet in and boxes around them stand beside it.
    Distant,
}

impl Working {
    /// How a recipe makes its triangles.
    pub(super) const fn of(recipe: &Recipe) -> Self {
        match recipe {
            Recipe::Implicit { .. } | Recipe::Perturbed(_) => Self::Field,
            Recipe::Sheet(_) => Self::Formula,
            Recipe::Subdivided(_) => Self::Subdivided,
            Recipe::Deformed { .. } => Self::Deformed,
            Recipe::Displaced(_) => Self::Displaced,
            _ => Self::Surface,
        }
    }

    const fn bytes(self) -> u64 {
        match self {
            Self::Surface => 110,
            Self::Formula => 160,
            Self::Subdivided => 200,
            Self::Field | Self::Deformed | Self::Displaced => 320,
            Self::Wrapped => 500,
            Self::Distant => 560,
            Self::Combined => 800,
        }
    }

    /// The most triangles of one surface, known before it is made.
    pub(super) fn most(self, limits: &Limits) -> u64 {
        limits.triangles.min(limits.memory / self.bytes())
    }

    /// A surface that was refused for its triangles, said in terms of the limit that was meant.
    pub(super) fn refusal(self, needed: u64, limits: &Limits) -> RealizeError {
        if needed > limits.triangles {
            return RealizeError::Limit { what: "triangles", needed, limit: limits.triangles };
        }
        let needed = needed.saturating_mul(self.bytes());
        RealizeError::Limit { what: "bytes of memory", needed, limit: limits.memory }
    }

    /// Refuses to make something of triangles that are there already, where that takes more memory than it may.
    pub(super) fn check(self, triangles: usize, limits: &Limits) -> Result<(), RealizeError> {
        let needed = (triangles as u64).saturating_mul(self.bytes());
        if needed <= limits.memory {
            return Ok(());
        }
        Err(RealizeError::Limit { what: "bytes of memory", needed, limit: limits.memory })
    }
}

impl Cost {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let (triangles, vertices) = (mesh.triangles.len() as u64, mesh.vertices.len() as u64);
        let points = mesh.points.len() as u64;
        let vertex = size_of::<Vertex>() as u64 + 32;
        Self { triangles, vertices, memory: triangles * (12 + 12) + vertices * vertex + points * 24 }
    }

    /// Segments count as triangles: both are what a renderer draws.
    pub(super) fn of_wire(wire: &Wire) -> Self {
        let points = wire.points.len() as u64;
        Self {
            triangles: points,
            vertices: points,
            memory: points * (size_of::<WirePoint>() as u64 + 12 + 8),
        }
    }

    /// With states of the mesh, each of which has points and normals of its own in memory and in the file.
    pub(super) fn with_states(self, mesh: &Mesh, states: u64) -> Self {
        let (vertices, points) = (mesh.vertices.len() as u64, mesh.points.len() as u64);
        let one = vertices * (24 + 24) + points * 24;
        Self { memory: self.memory.saturating_add(one.saturating_mul(states)), ..self }
    }

    pub(super) fn times(self, count: u64) -> Self {
        Self {
            triangles: self.triangles.saturating_mul(count),
            vertices: self.vertices.saturating_mul(count),
            memory: self.memory.saturating_mul(count),
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            triangles: self.triangles.saturating_add(other.triangles),
            vertices: self.vertices.saturating_add(other.vertices),
            memory: self.memory.saturating_add(other.memory),
        }
    }

    fn against(self, limits: &Limits) -> [(&'static str, u64, u64); 3] {
        [
            ("triangles", self.triangles, limits.triangles),
            ("vertices", self.vertices, limits.vertices),
            ("bytes of memory", self.memory, limits.memory),
        ]
    }

    /// Refuses what passes a limit by itself.
    pub(super) fn check(self, limits: &Limits) -> Result<(), RealizeError> {
        match self.against(limits).into_iter().find(|(_, needed, limit)| needed > limit) {
            Some((what, needed, limit)) => Err(RealizeError::Limit { what, needed, limit }),
            None => Ok(()),
        }
    }
}

/// For each shape a number of triangles that it will have at least, known without making it: copies of copies
/// are refused before the first is made.
pub(super) fn least_triangles(model: &Model) -> Vec<u64> {
    let mut all: Vec<u64> = Vec::with_capacity(model.shapes.len());
    for shape in &model.shapes {
        all.push(match &shape.recipe {
            // A recipe refers only to shapes before it.
            Recipe::Assembly(parts) => {
                parts.iter().fold(0, |sum: u64, (part, _)| sum.saturating_add(all[part.0 as usize]))
            }
            Recipe::Deformed { of, .. } | Recipe::Displaced(Displacement { of, .. }) => all[of.0 as usize],
            Recipe::Solid(_) | Recipe::Subdivided(_) => 1,
            Recipe::Cuboid { .. } => 12,
            Recipe::RoundedBox(_) => 44,
            Recipe::Height(_) | Recipe::Based(_) | Recipe::TwoSided(_) => 2,
            _ => 1,
        });
    }
    all
}

/// What all shapes take together, counted on every thread. Whether a limit is passed depends on the sum alone
/// and not on the order; once it is passed nothing more needs to be made.
#[derive(Debug, Default)]
pub(super) struct Spent([AtomicU64; 3]);

impl Spent {
    pub(super) fn add(&self, cost: Cost) {
        for (sum, part) in self.0.iter().zip([cost.triangles, cost.vertices, cost.memory]) {
            sum.fetch_add(part, Ordering::Relaxed);
        }
    }

    /// Refuses when the sum passes a limit.
    pub(super) fn check(&self, limits: &Limits) -> Result<(), RealizeError> {
        let [triangles, vertices, memory] = [0, 1, 2].map(|part| self.0[part].load(Ordering::Relaxed));
        let cost = Cost { triangles, vertices, memory };
        match cost.against(limits).into_iter().find(|(_, spent, limit)| spent > limit) {
            Some((what, _, limit)) => Err(RealizeError::Together { what, limit }),
            None => Ok(()),
        }
    }
}

//! Subdivision surfaces: a cage of polygons refined step by step toward its smooth limit.
//!
//! A scheme is its masks and the way it splits faces; one engine (`mask`) applies the masks to all that the vertices carry.
//! Promise: what is closed stays closed and keeps its Euler characteristic; limit positions and normals are those of the
//! published limit masks; time and memory are linear in the faces that are made; the same bytes everywhere. Not promised:
//! that the surface does not cross itself, and distances from the limit are sampled, not proved. Sources stand with the
//! masks: `primal` (Catmull-Clark, Loop), `root3`, `corner_cut` (Doo-Sabin, mid-edge), `butterfly`,
//! `sharpness` (creases), `local` and `dual_limit` (limits).

mod butterfly;
mod chart;
mod corner_cut;
mod dual_limit;
mod fault;
mod level;
mod limit;
mod local;
mod mask;
mod near;
mod polygons;
mod primal;
mod root3;
mod sharpness;
mod split;
#[cfg(test)]
mod tests;
mod topology;

pub use dual_limit::dual_limit;
pub use fault::SubdivideFault;
pub use level::{Channel, Level};
pub use limit::{Limit, limit};
pub use polygons::{Aim, Crease, CreaseEdges, Options, Subdivided, subdivide};
pub use sharpness::{ENDLESS, VertexClass};
pub use topology::Topology;

/// How a cage is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Faces of any number of corners into quads; bicubic splines where the cage is regular.
    CatmullClark,
    /// Triangles into four; quartic box splines where six meet.
    Loop,
    /// Triangles into three, turned over.
    Root3,
    /// Corners are cut; biquadratic splines where the cage is regular.
    DooSabin,
    /// Corners are cut between the middles of edges.
    MidEdge,
    /// Triangles into four; the vertices of the cage stay.
    Butterfly,
    /// Faces into quads; nothing moves.
    Bilinear,
}

/// How faces are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    Quads,
    Triangles,
    Root3,
    Dual,
}

impl Scheme {
    pub(crate) fn split(self) -> Split {
        match self {
            Self::CatmullClark | Self::Bilinear => Split::Quads,
            Self::Loop | Self::Butterfly => Split::Triangles,
            Self::Root3 => Split::Root3,
            Self::DooSabin | Self::MidEdge => Split::Dual,
        }
    }

    /// Whether it needs triangles.
    #[must_use]
    pub fn wants_triangles(self) -> bool {
        matches!(self, Self::Loop | Self::Root3 | Self::Butterfly)
    }

    /// Whether it knows creases and sharp vertices.
    #[must_use]
    pub fn creases(self) -> bool {
        matches!(self, Self::CatmullClark | Self::Loop)
    }

    /// Triangles after `levels` steps from a cage of so many faces and corners, at most.
    #[must_use]
    pub fn triangles(self, faces: u64, corners: u64, levels: u32) -> u64 {
        let (count, each) = match self.split() {
            Split::Quads => (corners.saturating_mul(2), 4_u64),
            Split::Triangles => (faces.saturating_mul(4), 4),
            Split::Root3 => (faces.saturating_mul(3), 3),
            Split::Dual => (corners.saturating_mul(6), 4),
        };
        if levels == 0 { corners } else { count.saturating_mul(each.saturating_pow(levels - 1)) }
    }
}

/// One step of a scheme over a level: topology, all channels, sharpness. O(new faces).
#[must_use]
pub fn refine(level: &Level, scheme: Scheme) -> Level {
    mask::refine(level, scheme)
}

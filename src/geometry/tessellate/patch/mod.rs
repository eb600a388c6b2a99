//! Any smooth surfaces, alone or joined, into triangles within a tolerance.
//!
//! Each surface is cut at its joints into blocks; sides that run along one line are one edge, cut once for all who
//! share it. Blocks are filled with rows of steps as the second fundamental form asks for, every triangle is
//! judged, and those that lie too far away are split together with their neighbours. So nothing cracks, and
//! the bound of the whole is the greatest of what was proved or sampled for each triangle.
//!
//! Cost: linear in the triangles; about 10 evaluations of the surface for each.

mod assemble;
mod density;
pub(super) mod judge;
mod lattice;
mod layout;
mod net;
mod plan;
mod refine;
pub(super) mod rows;
#[cfg(test)]
mod tests;

pub(super) use judge::judge;
pub(super) use layout::Block;
pub use layout::Rim;
pub(super) use rows::{Corner, Free};

use super::{Detail, TessellateError, Tessellation};
use crate::geometry::surface::AnySurface;
use layout::Layout;
use net::Net;

/// Surfaces that are one mesh: where their sides run along one line they are joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Patchwork {
    /// The surfaces. Their sides count as one line where they agree in parameters (either way around) to a
    /// billionth of the size of all.
    pub surfaces: Vec<AnySurface>,
    /// Flat ends: for each the sides that it closes, as the surface and its rim, one after the other. Together they
    /// must close, and lie in a plane.
    pub caps: Vec<Vec<(u32, Rim)>>,
}

impl Patchwork {
    /// The surface that a source of anchors is, or of a flat end the surface of its first side.
    #[must_use]
    pub fn owner(&self, source: u32) -> usize {
        let source = source as usize;
        let cap = source.checked_sub(self.surfaces.len()).and_then(|cap| self.caps.get(cap)?.first());
        cap.map_or(source, |(surface, _)| *surface as usize)
    }
}

/// Cuts surfaces into triangles. Anchor sources: surface k is k, caps come after the surfaces.
///
/// What encloses a volume shows its outside. Otherwise the normals are du x dv of the first surface of each joined
/// part, and neighbours are turned to agree with it.
///
/// # Errors
/// When the limit would be passed (before memory is taken), there is no area, or a cap cannot be triangulated.
pub fn patchwork(shape: &Patchwork, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let net = Net::new(Layout::new(&shape.surfaces), detail)?;
    let mesh = assemble::assemble(&net, shape, detail)?;
    if mesh.triangles.is_empty() {
        return Err(TessellateError::NoArea);
    }
    Ok(Tessellation { mesh, deviation: net.deviation })
}

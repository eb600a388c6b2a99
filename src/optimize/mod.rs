//! Ordered passes from scene to scene. They never tessellate and know nothing of the model.

mod band;
mod compact;
mod decimate;
mod grid;
mod instances;
mod lightmap;
mod order;
mod tangent;

use crate::scene::Scene;

pub use decimate::decimated;
pub use grid::{GRID_SHARE, MOST_GRID_SHARE, TooCoarse, grid_share};
pub use instances::fold_copies;
pub use lightmap::lay_out;
pub use order::{Order, Place, order_triangles};

/// What positions are rounded to; a grid with the share of the tolerance that it may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounding {
    /// Single precision.
    Single,
    /// The finest grid of 16 bits.
    Fine(f64),
    /// The coarsest grid of at most 16 bits.
    Coarse(f64),
}

/// Runs all passes in order.
///
/// # Errors
/// When the scene is too large for a grid to be within its tolerance; positions are then left as they are.
pub fn run(scene: &mut Scene, rounding: Rounding, order: Order) -> Result<(), TooCoarse> {
    let compacted = |scene: &mut Scene| {
        for geometry in &mut scene.geometries {
            compact::compact(geometry);
        }
    };
    compacted(scene);
    let snapped = match rounding {
        Rounding::Single => Ok(()),
        Rounding::Fine(share) | Rounding::Coarse(share) => {
            let snapped = grid::snap(scene, matches!(rounding, Rounding::Coarse(_)), share);
            compacted(scene);
            snapped
        }
    };
    tangent::tangents(scene);
    scene.geometries.iter_mut().for_each(|geometry| order::order(geometry, order));
    snapped
}

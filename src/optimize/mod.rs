//! Ordered passes from scene to scene. They never tessellate and know nothing of the model.

mod band;
mod compact;
mod order;
mod tangent;

use crate::scene::Scene;

/// Runs all passes in order.
pub fn run(scene: &mut Scene) {
    for geometry in &mut scene.geometries {
        compact::compact(&mut geometry.mesh, geometry.influences.as_mut());
    }
    tangent::tangents(scene);
    scene.geometries.iter_mut().for_each(order::order);
}

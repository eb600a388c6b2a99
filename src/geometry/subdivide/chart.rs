//! Values of corners that differ from face to face, such as texture coordinates with seams: the same faces over vertices of
//! their own, which are torn apart along the seams.

use super::topology::{NONE, Ring, Topology};
use crate::geometry::mesh::index;

/// The faces of `whole` over one vertex for each run of faces around a vertex that agree in their values, and the value of
/// each. Values are compared by number. O(n).
pub(super) fn chart(whole: &Topology, values: &[u32]) -> (Topology, Vec<u32>) {
    let mut made = whole.clone();
    for corner in 0..index(whole.corners()) {
        let twin = whole.twin[corner as usize];
        if twin != NONE {
            let agrees = |one: u32, other: u32| values[one as usize] == values[other as usize];
            if !agrees(corner, whole.next(twin)) || !agrees(whole.next(corner), twin) {
                made.twin[corner as usize] = NONE;
            }
        }
    }
    made.edge_corner.clear();
    for corner in 0..whole.corners() {
        let twin = made.twin[corner];
        made.corner_edge[corner] = if twin == NONE || twin as usize > corner {
            made.edge_corner.push(index(corner));
            index(made.edge_corner.len()) - 1
        } else {
            made.corner_edge[twin as usize]
        };
    }
    made.vertex_corner.clear();
    let (mut ring, mut taken) = (Ring::default(), Vec::new());
    for vertex in 0..index(whole.vertices()) {
        whole.ring(vertex, &mut ring);
        let count = ring.corners.len();
        // Runs begin behind a seam, if there is one.
        let first = ring.corners.iter().position(|corner| made.twin[*corner as usize] == NONE).unwrap_or(0);
        for step in 0..count {
            let corner = ring.corners[(first + step) % count];
            if step == 0 || made.twin[corner as usize] == NONE {
                made.vertex_corner.push(corner);
                taken.push(values[corner as usize]);
            }
            made.corner_vertex[corner as usize] = index(made.vertex_corner.len()) - 1;
        }
    }
    (made, taken)
}

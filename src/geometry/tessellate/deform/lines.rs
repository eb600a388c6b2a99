//! The lines of a mesh that a map must keep as lines.

use std::collections::{HashMap, HashSet};

use super::split::key;
use crate::geometry::mesh::{Mesh, VertexIndex};

/// Lines of a mesh that keep the tolerance by themselves: borders, and edges where normals differ.
pub(super) fn lines(mesh: &Mesh) -> HashSet<(u32, u32)> {
    let mut first: HashMap<(u32, u32), ([VertexIndex; 2], u32)> = HashMap::new();
    let mut lines = HashSet::new();
    let normal = |vertex: VertexIndex| mesh.vertices[vertex.subscript()].normal;
    for triangle in &mesh.triangles {
        for side in 0..3 {
            let (a, b) = (triangle[(side + 1) % 3], triangle[(side + 2) % 3]);
            let (p, q) = (mesh.vertices[a.subscript()].point.0, mesh.vertices[b.subscript()].point.0);
            let ends = if p < q { [a, b] } else { [b, a] };
            match first.get_mut(&key(p, q)) {
                None => {
                    first.insert(key(p, q), (ends, 1));
                    lines.insert(key(p, q));
                }
                Some((known, uses)) => {
                    *uses += 1;
                    let alike = |k: usize| normal(known[k]).distance(normal(ends[k])) < 1e-6;
                    if *uses == 2 && alike(0) && alike(1) {
                        lines.remove(&key(p, q));
                    } else {
                        lines.insert(key(p, q));
                    }
                }
            }
        }
    }
    lines
}

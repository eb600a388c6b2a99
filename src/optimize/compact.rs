//! Leaves out vertices and points that no triangle uses, and triangles that use one vertex twice.

use crate::geometry::mesh;
use crate::geometry::mesh::{Mesh, PointIndex, Vertex, VertexIndex};
use crate::scene::Geometry;

/// Renumbers what is used, in the order it stands. O(size of the mesh); nothing moves when all is used.
/// What is known of points and vertices goes with them.
pub(super) fn compact(geometry: &mut Geometry) {
    let (vertices, points) = compact_mesh(&mut geometry.mesh);
    for target in &mut geometry.targets {
        keep(&mut target.normals, vertices.as_deref());
        keep(&mut target.points, points.as_deref());
    }
    if let Some(lightmap) = &mut geometry.lightmap {
        keep(&mut lightmap.places, vertices.as_deref());
    }
    if let Some(influences) = &mut geometry.influences {
        keep(influences, points.as_deref());
    }
}

/// Leaves out what is not used; all is where nothing is said.
fn keep<T>(all: &mut Vec<T>, used: Option<&[bool]>) {
    if let Some(used) = used {
        let mut used = used.iter();
        all.retain(|_| used.next().copied().unwrap_or(false));
    }
}

/// Tells which vertices, and which points, were used; none where all were.
fn compact_mesh(mesh: &mut Mesh) -> (Option<Vec<bool>>, Option<Vec<bool>>) {
    let mut vertex_used = vec![false; mesh.vertices.len()];
    let mut collapsed = false;
    for triangle in &mesh.triangles {
        if is_collapsed(&mesh.vertices, triangle) {
            collapsed = true;
        } else {
            triangle.iter().for_each(|vertex| vertex_used[vertex.0 as usize] = true);
        }
    }
    if collapsed {
        drop_collapsed(mesh);
    }
    let some = |used: Vec<bool>| used.contains(&false).then_some(used);
    let vertex_used = some(vertex_used);
    if let Some(used) = &vertex_used {
        let places = renumber(used);
        keep(&mut mesh.vertices, Some(used));
        for triangle in &mut mesh.triangles {
            *triangle = triangle.map(|vertex| VertexIndex(places[vertex.0 as usize]));
        }
    }
    let mut point_used = vec![false; mesh.points.len()];
    mesh.vertices.iter().for_each(|vertex| point_used[vertex.point.0 as usize] = true);
    let point_used = some(point_used);
    if let Some(used) = &point_used {
        let places = renumber(used);
        keep(&mut mesh.points, Some(used));
        for vertex in &mut mesh.vertices {
            vertex.point = PointIndex(places[vertex.point.0 as usize]);
        }
    }
    (vertex_used, point_used)
}

fn renumber(used: &[bool]) -> Vec<u32> {
    let mut next = 0;
    used.iter()
        .map(|used| {
            let place = next;
            next += u32::from(*used);
            place
        })
        .collect()
}

/// A triangle with two corners on one point has no area and both its other edges cancel.
fn is_collapsed(vertices: &[Vertex], [a, b, c]: &[VertexIndex; 3]) -> bool {
    let [a, b, c] = [a, b, c].map(|vertex| vertices[vertex.0 as usize].point);
    a == b || b == c || c == a
}

fn drop_collapsed(mesh: &mut Mesh) {
    let keep: Vec<bool> =
        mesh.triangles.iter().map(|triangle| !is_collapsed(&mesh.vertices, triangle)).collect();
    let mut kept_before = 0;
    let mut start = 0;
    let mut runs = Vec::with_capacity(mesh.runs.len());
    for run in &mesh.runs {
        kept_before += mesh::index(keep[start..run.end as usize].iter().filter(|keep| **keep).count());
        start = run.end as usize;
        let empty = runs.last().map_or(0, |last: &mesh::Run| last.end) == kept_before;
        if !empty {
            runs.push(mesh::Run { origin: run.origin, end: kept_before });
        }
    }
    mesh.runs = runs;
    let mut keep = keep.into_iter();
    mesh.triangles.retain(|_| keep.next().unwrap_or(false));
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::compact_mesh;
    use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};

    #[test]
    fn unused_and_collapsed_parts_go_and_the_rest_keeps_its_order() {
        let vertex = |point: u32| Vertex {
            point: PointIndex(point),
            normal: DVec3::Z,
            uv: DVec2::ZERO,
            color: Color::WHITE,
            anchor: Anchor::default(),
        };
        let triangle = |a: u32, b: u32, c: u32| [a, b, c].map(VertexIndex);
        let mut mesh = Mesh {
            points: vec![DVec3::ZERO, DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z],
            vertices: [0, 2, 1, 3, 3].map(vertex).to_vec(),
            triangles: vec![triangle(0, 3, 4), triangle(0, 1, 3), triangle(3, 4, 1)],
            runs: vec![Run { origin: 0, end: 1 }, Run { origin: 1, end: 2 }, Run { origin: 2, end: 3 }],
        };
        compact_mesh(&mut mesh);
        assert_eq!(mesh.triangles, vec![triangle(0, 1, 2)]);
        assert_eq!(mesh.runs, vec![Run { origin: 1, end: 1 }]);
        assert_eq!(mesh.points, vec![DVec3::ZERO, DVec3::X, DVec3::Y]);
    }
}

//! Flat faces: triangles of one plane that look alike are one face, which may be cut into triangles anew.

use glam::DVec3;

use super::Stock;
use super::parts::find;
use crate::geometry::mesh::{Mesh, VertexIndex, index};

/// Part of its size by which a face may leave its plane, or its coordinates the straight way: rounding.
const FLAT: f64 = 1e-11;

/// For each triangle of a stock one that stands for its whole flat face: the largest of it. A triangle of a curved
/// face stands for itself.
pub(super) fn faces(stock: &Stock) -> Vec<u32> {
    let mesh = &stock.mesh;
    let mut parent: Vec<u32> = (0..index(mesh.triangles.len())).collect();
    let mut sides: Vec<(u32, u32, u32)> = Vec::new();
    for (number, triangle) in (0..).zip(&mesh.triangles) {
        if is_flat(mesh, triangle) {
            let [a, b, c] = triangle.map(|vertex| vertex.0);
            sides.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b), number)));
        }
    }
    sides.sort_unstable();
    let origins = origins(mesh);
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let [(a, b, one), (_, _, other)] = edge else { continue };
        let (one, other) = (*one, *other);
        if origins[one as usize] == origins[other as usize] && continues(mesh, (*a, *b), one, other) {
            let (one, other) = (find(&mut parent, one), find(&mut parent, other));
            parent[one.max(other) as usize] = one.min(other);
        }
    }
    largest(mesh, &mut parent)
}

/// The origin of each triangle's run.
pub(super) fn origins(mesh: &Mesh) -> Vec<u32> {
    let mut origins = Vec::with_capacity(mesh.triangles.len());
    for run in &mesh.runs {
        origins.resize(run.end as usize, run.origin);
    }
    origins
}

/// Whether a triangle has one normal, one color and one source. Colors that change are not drawn out over a face: they would
/// leave their bounds.
fn is_flat(mesh: &Mesh, triangle: &[VertexIndex; 3]) -> bool {
    let [a, b, c] = triangle.map(|vertex| &mesh.vertices[vertex.subscript()]);
    a.normal == b.normal
        && b.normal == c.normal
        && a.color == b.color
        && b.color == c.color
        && a.anchor.source == b.anchor.source
        && b.anchor.source == c.anchor.source
}

/// Place, texture coordinates and parameters of a vertex, of which all are linear over a flat face.
type Row = [f64; 7];

fn row(mesh: &Mesh, vertex: u32) -> Row {
    let vertex = &mesh.vertices[vertex as usize];
    let place = mesh.points[vertex.point.subscript()];
    [place.x, place.y, place.z, vertex.uv.x, vertex.uv.y, vertex.anchor.u, vertex.anchor.v]
}

/// Whether the triangle beyond a side goes on straight in every respect.
fn continues(mesh: &Mesh, (a, b): (u32, u32), one: u32, other: u32) -> bool {
    let tip = |triangle: u32| {
        mesh.triangles[triangle as usize]
            .iter()
            .map(|vertex| vertex.0)
            .find(|vertex| *vertex != a && *vertex != b)
    };
    let (Some(near), Some(far)) = (tip(one), tip(other)) else { return false };
    let rows = [a, b, near, far].map(|vertex| row(mesh, vertex));
    let place = |k: usize| DVec3::new(rows[k][0], rows[k][1], rows[k][2]);
    let (along, up, out) = (place(1) - place(0), place(2) - place(0), place(3) - place(0));
    let normal = along.cross(up);
    let square = normal.length_squared();
    if square == 0.0 {
        return false;
    }
    // The far tip over the first triangle: out = x along + y up, but for what it leaves its plane.
    let x = out.cross(up).dot(normal) / square;
    let y = along.cross(out).dot(normal) / square;
    (0..7).all(|k| {
        let [from, to, tip, far] = [0, 1, 2, 3].map(|row| rows[row][k]);
        let expected = from + x * (to - from) + y * (tip - from);
        let size = [from, to, tip, far].iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        (far - expected).abs() <= FLAT * size.max(along.length()) * (1.0 + x.abs() + y.abs())
    })
}

/// For each triangle the largest of its set.
fn largest(mesh: &Mesh, parent: &mut [u32]) -> Vec<u32> {
    let area = |number: u32| {
        let corner = |vertex: VertexIndex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()];
        let [a, b, c] = mesh.triangles[number as usize].map(corner);
        (b - a).cross(c - a).length_squared()
    };
    let roots: Vec<u32> = (0..index(parent.len())).map(|number| find(parent, number)).collect();
    let mut best: Vec<u32> = roots.clone();
    for (number, root) in (0..).zip(&roots) {
        if number != *root && area(number) > area(best[*root as usize]) {
            best[*root as usize] = number;
        }
    }
    roots.into_iter().map(|root| best[root as usize]).collect()
}

//! Normals and texture coordinates of a finished surface.

use glam::{DVec2, DVec3};

use super::edges::ASIDE;
use super::refine::Refiner;
use super::skin::before;
use super::{FieldSurface, is_on_edge};
use crate::geometry::mesh::{self, Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::cos_degrees;
use crate::geometry::tessellate::Detail;

/// The mesh of a finished skin.
pub(super) fn dress(refiner: &Refiner<'_>, shape: &FieldSurface, detail: &Detail) -> Mesh {
    let skin = &refiner.skin;
    let crease = cos_degrees(detail.crease_angle);
    let mut vertex_of = vec![u32::MAX; skin.twins.len()];
    let mut mesh = Mesh::default();
    for index in 0..mesh::index(skin.points.len()) {
        if skin.starts[index as usize] == super::skin::NONE {
            continue;
        }
        let ring: Vec<u32> = skin.around(index).collect();
        let point = PointIndex(mesh::index(mesh.points.len()));
        mesh.points.push(skin.point(index));
        for sector in sectors(refiner, index, &ring, crease) {
            let name = mesh::index(mesh.vertices.len());
            let place = skin.point(index);
            let vertex = Vertex {
                point,
                normal: sector.0,
                uv: texture(shape, place),
                color: Color::WHITE,
                anchor: Anchor { source: 0, u: place.x, v: place.y },
            };
            mesh.vertices.push(vertex);
            for half in sector.1 {
                vertex_of[half as usize] = name;
            }
        }
    }
    for triangle in 0..skin.triangles.len() {
        if skin.is_alive(mesh::index(triangle)) {
            mesh.triangles.push([0, 1, 2].map(|k| VertexIndex(vertex_of[3 * triangle + k])));
        }
    }
    mesh.runs.push(Run { origin: 0, end: mesh::index(mesh.triangles.len()) });
    mesh
}

/// Seen from the front: x to the right, y up.
fn texture(shape: &FieldSurface, place: DVec3) -> DVec2 {
    let size = shape.within.max - shape.within.min;
    let part = (place - shape.within.min) / size;
    DVec2::new(part.x, 1.0 - part.y)
}

/// Groups of half-edges around a point whose triangles share a normal, with that normal.
fn sectors(refiner: &Refiner<'_>, index: u32, ring: &[u32], crease: f64) -> Vec<(DVec3, Vec<u32>)> {
    let skin = &refiner.skin;
    if !is_on_edge(skin, index) {
        return vec![(skin.normal(index), ring.to_vec())];
    }
    let middle = |half: u32| {
        let corners = skin.triangles[(half / 3) as usize].map(|corner| skin.point(corner));
        (corners[0] + corners[1] + corners[2]) / 3.0
    };
    let normals: Vec<DVec3> = ring
        .iter()
        .map(|half| refiner.probe.normal_towards(skin.point(index), middle(*half), ASIDE))
        .collect();
    // The ring runs from triangle to triangle across the half-edge that ends here.
    let count = ring.len();
    let parted = |k: usize| {
        let after = (k + 1) % count;
        skin.is_sharp(before(ring[k])) && normals[k].dot(normals[after]) < crease
    };
    let Some(first) = (0..count).find(|k| parted(*k)) else {
        let sum: DVec3 = normals.iter().sum();
        return vec![(sum.normalize_or(skin.normal(index)), ring.to_vec())];
    };
    let mut all = Vec::new();
    let (mut sum, mut halves) = (DVec3::ZERO, Vec::new());
    for step in 1..=count {
        let k = (first + step) % count;
        sum += normals[k];
        halves.push(ring[k]);
        if parted(k) {
            all.push((sum.normalize_or(skin.normal(index)), std::mem::take(&mut halves)));
            sum = DVec3::ZERO;
        }
    }
    all
}

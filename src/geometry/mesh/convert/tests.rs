//! Normals, splits and boundaries of converted meshes.

use glam::{DVec2, DVec3};

use super::{ConvertOptions, Converted, Shading, convert};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::{PolygonMesh, topology};
use crate::geometry::number::sin_cos_degrees;

const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const SIDES: [&[u32]; 6] =
    [&[3, 2, 1, 0], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

fn cube() -> PolygonMesh {
    PolygonMesh::from_faces(CUBE.map(DVec3::from_array).to_vec(), &SIDES)
}

/// A cylinder of quads with caps of `sides` corners.
fn cylinder(sides: u32) -> PolygonMesh {
    let mut mesh = PolygonMesh::default();
    for side in 0..sides {
        let (sin, cos) = sin_cos_degrees(360.0 * f64::from(side) / f64::from(sides));
        mesh.points.extend([DVec3::new(cos, sin, 0.0), DVec3::new(cos, sin, 1.0)]);
    }
    for side in 0..sides {
        let next = (side + 1) % sides;
        mesh.push_face(&[&[2 * side, 2 * next, 2 * next + 1, 2 * side + 1]], None, 1);
    }
    let top: Vec<u32> = (0..sides).map(|side| 2 * side + 1).collect();
    let bottom: Vec<u32> = (0..sides).rev().map(|side| 2 * side).collect();
    mesh.push_face(&[&top], None, 2);
    mesh.push_face(&[&bottom], None, 0);
    mesh
}

fn shaded(shading: Shading, crease_angle: f64) -> ConvertOptions {
    ConvertOptions { shading, crease_angle }
}

fn is_closed(converted: &Converted) -> bool {
    let mesh = &converted.mesh;
    let corner = |corner: usize| mesh.vertices[mesh.triangles[corner / 3][corner % 3].subscript()].point.0;
    topology::measure(mesh.triangles.len(), mesh.points.len(), corner).expect("small").closed
}

#[test]
fn a_cube_is_split_by_its_hard_edges() {
    let by_angle =
        |angle| convert(&cube(), &shaded(Shading::Auto, angle)).expect("valid").mesh.vertices.len();
    assert_eq!((by_angle(30.0), by_angle(89.9), by_angle(90.0)), (24, 24, 8));
    let smooth = convert(&cube(), &shaded(Shading::Smooth, 0.0)).expect("valid");
    assert_eq!(smooth.mesh.vertices.len(), 8);
    for vertex in &smooth.mesh.vertices {
        let outward = smooth.mesh.points[vertex.point.subscript()].normalize();
        assert!((vertex.normal - outward).length() < 1e-15);
    }
    assert!(is_closed(&smooth));
}

#[test]
fn normals_do_not_depend_on_the_cut() {
    // The corner of a cube where one side is two triangles weighs each side alike, by angle.
    let mut split = cube();
    split.loop_ends.clear();
    split.corners.clear();
    split.faces.clear();
    for side in SIDES {
        split.push_face(&[&[side[0], side[1], side[2]]], None, 0);
        split.push_face(&[&[side[0], side[2], side[3]]], None, 0);
    }
    let whole = convert(&cube(), &shaded(Shading::Smooth, 0.0)).expect("valid").mesh;
    let halves = convert(&split, &shaded(Shading::Smooth, 0.0)).expect("valid").mesh;
    for (a, b) in whole.vertices.iter().zip(&halves.vertices) {
        assert!((a.normal - b.normal).length() < 1e-15 && a.point == b.point);
    }
}

#[test]
fn a_cylinder_is_smooth_around_and_hard_at_its_rims() {
    let converted = convert(&cylinder(16), &ConvertOptions::default()).expect("valid");
    assert_eq!(converted.mesh.vertices.len(), 64);
    assert_eq!(converted.mesh.triangles.len(), 32 + 28);
    assert!(is_closed(&converted) && converted.crossing_faces.is_empty());
    // Sides that turn by exactly the crease angle are smooth.
    assert_eq!(convert(&cylinder(12), &ConvertOptions::default()).expect("valid").mesh.vertices.len(), 48);
    assert_eq!(convert(&cylinder(11), &ConvertOptions::default()).expect("valid").mesh.vertices.len(), 66);
}

#[test]
fn smoothing_groups_win_over_the_angle() {
    let mut mesh = cylinder(5);
    mesh.has_smoothing = true;
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid");
    // Sides in group 1 are smooth in spite of 72 degrees: 10 vertices; the caps have 5 each.
    assert_eq!(converted.mesh.vertices.len(), 20);
    for face in &mut mesh.faces {
        face.smoothing = 0;
    }
    assert_eq!(convert(&mesh, &shaded(Shading::Auto, 180.0)).expect("valid").mesh.vertices.len(), 30);
}

#[test]
fn given_normals_win_where_they_are_given() {
    let mut mesh = cube();
    mesh.normals = vec![DVec3::new(0.0, 3.0, 4.0)];
    mesh.corner_normals = vec![NONE; 24];
    mesh.corner_normals[0] = 0;
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid").mesh;
    assert_eq!(
        converted.vertices[converted.triangles[0][0].subscript()].normal,
        DVec3::new(0.0, 3.0, 4.0).normalize()
    );
    assert_eq!(converted.vertices[converted.triangles[0][1].subscript()].normal, -DVec3::Z);
    let flat = convert(&mesh, &shaded(Shading::Flat, 0.0)).expect("valid").mesh;
    assert_eq!(flat.vertices[flat.triangles[0][0].subscript()].normal, -DVec3::Z);
}

#[test]
fn a_uv_seam_splits_vertices_by_value() {
    let mut mesh = cube();
    mesh.uvs = vec![DVec2::ZERO, DVec2::ZERO, DVec2::X];
    mesh.corner_uvs = (0..24).map(|corner| corner % 2).collect();
    let smooth = shaded(Shading::Smooth, 0.0);
    assert_eq!(convert(&mesh, &smooth).expect("valid").mesh.vertices.len(), 8);
    mesh.corner_uvs[5] = 2;
    assert_eq!(convert(&mesh, &smooth).expect("valid").mesh.vertices.len(), 9);
}

#[test]
fn many_vertices_on_one_point() {
    let mut mesh = PolygonMesh { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y], ..PolygonMesh::default() };
    for k in 0..200_u32 {
        mesh.push_face(&[&[0, 1, 2]], None, 0);
        mesh.uvs.push(DVec2::splat(f64::from(k % 100)));
        mesh.corner_uvs.extend([k; 3]);
    }
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid").mesh;
    assert_eq!((converted.vertices.len(), converted.triangles.len()), (300, 200));
}

#[test]
fn runs_follow_materials() {
    let mut mesh = cube();
    mesh.materials = vec!["a".to_owned(), "b".to_owned()];
    for (face, material) in mesh.faces.iter_mut().zip([Some(1), None, Some(1), Some(0), None, Some(1)]) {
        face.material = material;
    }
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid");
    assert_eq!(converted.materials, [Some(1), None, Some(0)]);
    assert_eq!(
        converted.mesh.runs.iter().map(|run| (run.origin, run.end)).collect::<Vec<_>>(),
        [(0, 6), (1, 10), (2, 12)]
    );
}

#[test]
fn what_was_closed_stays_closed() {
    // A cube whose top has its edges divided, as its neighbours have; with a sliver and a vanishing face.
    let mut mesh = cube();
    mesh.points.push(DVec3::new(0.0, -1.0, 1.0));
    mesh.points.push(DVec3::new(0.5, -1.0, 1.0));
    mesh.loop_ends.clear();
    mesh.corners.clear();
    mesh.faces.clear();
    for side in SIDES {
        mesh.push_face(&[side], None, 0);
    }
    mesh.corners.splice(4..8, [4, 8, 9, 5, 6, 7].map(crate::geometry::mesh::PointIndex));
    for end in &mut mesh.loop_ends[1..] {
        *end += 2;
    }
    // The seam between the divided edge and the plain one is a sliver of collinear points.
    mesh.push_face(&[&[5, 9, 8, 4]], None, 0);
    mesh.push_face(&[&[0, 0, 1]], None, 0);
    mesh.push_face(&[&[0, 1, 0, 1]], None, 0);
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid");
    assert!(is_closed(&converted));
    assert_eq!(
        (converted.dropped_faces.as_slice(), converted.crossing_faces.as_slice()),
        (&[7, 8][..], &[][..])
    );
    assert!(converted.mesh.vertices.iter().all(|vertex| (vertex.normal.length() - 1.0).abs() < 1e-12));
}

#[test]
fn a_crossing_face_is_told() {
    let mut points = CUBE.map(DVec3::from_array).to_vec();
    points.push(DVec3::new(3.0, 1.5, 1.0));
    let mesh = PolygonMesh::from_faces(points, &[&[0, 1, 2, 3], &[4, 5, 7, 8]]);
    let converted = convert(&mesh, &ConvertOptions::default()).expect("valid");
    assert_eq!(converted.crossing_faces, [1]);
    assert_eq!(converted.mesh.triangles.len(), 4);
}

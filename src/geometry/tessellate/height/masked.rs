//! Masks against small worlds tried one by one, closed forms and each other.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Closing, HeightBound, HeightMap, Mask, MaskSide, TwoSided, height_map, two_sided};
use crate::geometry::map::{GridField, Interpolation};
use crate::geometry::mesh::Mesh;
use crate::geometry::tessellate::{Detail, SurfaceDensity, TessellateError};

const TOLERANCE: f64 = 0.01;

fn made(shape: &HeightMap, tolerance: f64) -> Result<Mesh, TessellateError> {
    let density = SurfaceDensity::Tolerance(tolerance);
    let detail = Detail { density, crease_angle: 30.0, uv: true, triangle_limit: 1 << 22 };
    let made = height_map(shape, &detail, tolerance)?;
    assert!(shape.bound != HeightBound::Surface || made.deviation.bound <= tolerance);
    Ok(made.mesh)
}

fn flat(masks: Vec<Mask>, field: Arc<GridField>, close: Closing) -> HeightMap {
    HeightMap { size: DVec2::from_array(field.extent()), field, bound: HeightBound::Surface, close, masks }
}

fn mask(field: &Arc<GridField>, threshold: f64, side: MaskSide) -> Mask {
    Mask { field: field.clone(), threshold, side }
}

fn point(mesh: &Mesh, corner: crate::geometry::mesh::VertexIndex) -> DVec3 {
    mesh.points[mesh.vertices[corner.subscript()].point.subscript()]
}

/// Area of the upper sheet, seen from above.
fn area(mesh: &Mesh) -> f64 {
    let tops = mesh
        .triangles
        .iter()
        .filter(|triangle| triangle.iter().all(|at| mesh.vertices[at.subscript()].anchor.source == 0));
    let areas = tops.map(|triangle| {
        let [a, b, c] = triangle.map(|at| point(mesh, at)).map(|point| DVec2::new(point.x, point.z));
        (b - a).perp_dot(c - a) / -2.0
    });
    areas.inspect(|area| assert!(*area > 0.0, "turned over")).sum()
}

/// Edges between places, each with how often it is used in its direction less how often in the other.
fn edges(mesh: &Mesh) -> BTreeMap<[[u64; 3]; 2], i32> {
    let key = |point: DVec3| point.to_array().map(|part| (part + 0.0).to_bits());
    let mut edges = BTreeMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|at| key(point(mesh, at)));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry(if from < to { [from, to] } else { [to, from] }).or_insert(0) +=
                if from < to { 1 } else { -1 };
        }
    }
    edges
}

/// Each edge once in both directions.
fn is_manifold(mesh: &Mesh) -> bool {
    let key = |point: DVec3| point.to_array().map(|part| (part + 0.0).to_bits());
    let mut seen = BTreeSet::new();
    let mut sides = mesh.triangles.iter().flat_map(|triangle| {
        let [a, b, c] = triangle.map(|at| key(point(mesh, at)));
        [[a, b], [b, c], [c, a]]
    });
    sides.all(|side| seen.insert(side)) && seen.iter().all(|[a, b]| seen.contains(&[*b, *a]))
}

/// The open edges inside of the rectangle.
fn inner_rim(mesh: &Mesh, size: DVec2) -> BTreeSet<[[u64; 3]; 2]> {
    let on_border = |ends: &[[u64; 3]; 2]| {
        let [a, b] = ends.map(|end| end.map(f64::from_bits));
        let both = |axis: usize, at: f64| a[axis].abs() == at && a[axis] == b[axis];
        both(0, size.x / 2.0) || both(2, size.y / 2.0)
    };
    edges(mesh)
        .into_iter()
        .filter(|(ends, balance)| *balance != 0 && !on_border(ends))
        .map(|(ends, _)| ends)
        .collect()
}

/// Every grid of three by three samples below, at and above a threshold: both sides of it are sound, fill the rectangle
/// together and share their rim.
#[test]
fn all_small_worlds_are_bounded() {
    for world in 0..3_u32.pow(9) {
        let values: Vec<f64> = (0..9).map(|k| f64::from(world / 3_u32.pow(k) % 3) - 1.0).collect();
        let level = |at: &usize| [0, 1, 3, 4].iter().all(|step| values[at + step] == 0.0);
        let plateau = [0, 1, 3, 4].iter().filter(|at| level(at)).count();
        let field = Arc::new(GridField::new(3, values.clone(), Interpolation::Bilinear).unwrap());
        let ground = Arc::new(GridField::new(3, vec![0.0; 9], Interpolation::Bilinear).unwrap());
        let mut whole = 0.0;
        let mut rims = Vec::new();
        for side in [MaskSide::AtLeast, MaskSide::AtMost] {
            let open = flat(vec![mask(&field, 0.0, side)], ground.clone(), Closing::None);
            let sheet = match made(&open, TOLERANCE) {
                Ok(sheet) => sheet,
                Err(TessellateError::NothingKept) => Mesh::default(),
                Err(error) => panic!("{values:?} {side:?}: {error}"),
            };
            whole += area(&sheet);
            rims.push(inner_rim(&sheet, open.size));
            if sheet.triangles.is_empty() {
                continue;
            }
            let thick = HeightMap { close: Closing::Thickness(0.5), ..open };
            let solid = made(&thick, TOLERANCE).unwrap();
            assert!(is_manifold(&solid), "{values:?} {side:?}");
        }
        assert!((whole - 4.0 - plateau as f64).abs() < 1e-5, "{values:?}: {whole}");
        if plateau == 0 {
            assert_eq!(rims[0], rims[1], "{values:?}");
        }
    }
}

fn sampled(columns: usize, rows: usize, kind: Interpolation, f: impl Fn(f64, f64) -> f64) -> Arc<GridField> {
    let at = |k: usize, count: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (at(i, columns), at(j, rows))));
    Arc::new(GridField::new(columns, places.map(|(x, y)| f(x, y)).collect(), kind).unwrap())
}

#[test]
fn a_spline_of_a_quadric_has_the_area_of_its_ellipse() {
    // The spline reproduces it exactly: x^2 + 4 y^2 = 0.64, off the middle.
    let ellipse = |x: f64, y: f64| (x - 0.1) * (x - 0.1) + 4.0 * (y + 0.2) * (y + 0.2);
    let field = sampled(9, 12, Interpolation::Bicubic, ellipse);
    let size = DVec2::new(2.0, 2.0);
    for tolerance in [0.05, 0.005, 0.0005] {
        for close in [Closing::None, Closing::Base(-1.0), Closing::Thickness(0.1)] {
            let shape =
                HeightMap { size, ..flat(vec![mask(&field, 0.64, MaskSide::AtMost)], field.clone(), close) };
            let mesh = made(&shape, tolerance).unwrap();
            let exact = core::f64::consts::PI * 0.8 * 0.4;
            assert!((area(&mesh) - exact).abs() < tolerance * 4.0, "{tolerance}");
            for corner in mesh.vertices.iter().filter(|corner| corner.anchor.source == 0) {
                let at = mesh.points[corner.point.subscript()];
                assert!(ellipse(at.x, at.z) <= 0.64 + 4.0 * tolerance);
            }
            assert_eq!(is_manifold(&mesh), close != Closing::None);
        }
    }
}

#[test]
fn nothing_small_is_missed_between_samples() {
    // A spline through zeros but one sample: its hill rises above 0.9 in a spot much smaller than a cell.
    let mut values = vec![0.0; 81];
    values[4 * 9 + 4] = 1.0;
    let field = Arc::new(GridField::new(9, values, Interpolation::Bicubic).unwrap());
    for threshold in [0.9, 0.99, 0.999] {
        let shape = flat(vec![mask(&field, threshold, MaskSide::AtLeast)], field.clone(), Closing::None);
        let area = area(&made(&shape, 0.002).unwrap());
        // 1 - b r^2 near its top, with the second derivative of the cardinal spline in its middle.
        let b = (1.0 - field.value(4.01, 4.0)) / 1e-4;
        let about = core::f64::consts::PI * (1.0 - threshold) / b;
        // The next term is of the order of the height.
        assert!((area / about - 1.0).abs() < 0.01 + 2.0 * (1.0 - threshold), "{threshold}: {area} {about}");
    }
    // And between samples: a saddle's two parts, a hollow that no sample reaches.
    let bowl = sampled(4, 4, Interpolation::Bicubic, |x, y| x * x + y * y);
    let shape = flat(vec![mask(&bowl, 0.02, MaskSide::AtMost)], bowl.clone(), Closing::None);
    let found = area(&made(&shape, 0.005).unwrap());
    let exact = core::f64::consts::PI * 0.02 * 1.5 * 1.5;
    assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
}

#[test]
fn masks_hold_together_and_rings_have_holes() {
    let radius = sampled(33, 33, Interpolation::Bicubic, |x, y| x * x + y * y);
    let slope = sampled(5, 5, Interpolation::Bilinear, |x, y| x + 0.5 * y);
    let masks = vec![
        mask(&radius, 0.25, MaskSide::AtLeast),
        mask(&radius, 0.81, MaskSide::AtMost),
        mask(&slope, 0.0, MaskSide::AtMost),
    ];
    let size = DVec2::splat(2.0);
    let half = HeightMap { size, ..flat(masks.clone(), radius.clone(), Closing::Base(0.0)) };
    let ring = HeightMap { masks: masks[..2].to_vec(), ..half.clone() };
    let exact = core::f64::consts::PI * (0.81 - 0.25);
    let (half, ring) = (made(&half, 0.001).unwrap(), made(&ring, 0.001).unwrap());
    assert!(is_manifold(&half) && is_manifold(&ring));
    assert!((area(&ring) - exact).abs() < 0.005 && (area(&half) - exact / 2.0).abs() < 0.005);
}

#[test]
fn samples_without_a_value_are_holes_along_the_grid() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let mut unknown = vec![false; 42];
        // Two that touch in a corner, one on the border.
        [8, 16, 30, 41].iter().for_each(|at| unknown[*at] = true);
        let values = (0..42).map(|at| f64::from(at % 7) * 0.1).collect();
        let field = Arc::new(GridField::with_gaps(7, values, unknown, kind).unwrap());
        let lost =
            (0..5).flat_map(|j| (0..6).map(move |i| (i, j))).filter(|(i, j)| !field.knows(*i, *j)).count();
        for bound in [HeightBound::Surface, HeightBound::Dense] {
            let shape = HeightMap { bound, ..flat(Vec::new(), field.clone(), Closing::Thickness(0.2)) };
            let mesh = made(&shape, 0.01).unwrap();
            assert!((area(&mesh) - (30 - lost) as f64).abs() < 1e-3, "{kind:?}");
            assert!(is_manifold(&mesh));
        }
    }
}

#[test]
fn ground_may_end_on_its_base() {
    let hill = sampled(21, 21, Interpolation::Bicubic, |x, y| 0.5 - x * x - y * y);
    let size = DVec2::splat(2.0);
    let shape = HeightMap {
        size,
        ..flat(vec![mask(&hill, 0.0, MaskSide::AtLeast)], hill.clone(), Closing::Base(0.0))
    };
    let mesh = made(&shape, 0.002).unwrap();
    assert!(is_manifold(&mesh));
    // No walls: the sheet and the bottom share their rim.
    let upright = mesh.vertices.iter().filter(|corner| corner.normal.y.abs() < 1e-9).count();
    let used: BTreeSet<u32> = mesh.triangles.iter().flatten().map(|corner| corner.0).collect();
    let walls = mesh
        .vertices
        .iter()
        .zip(0..)
        .filter(|(corner, at)| corner.normal.y.abs() < 1e-9 && used.contains(at))
        .count();
    assert!(upright > 0 && walls == 0, "{walls} of {upright}");
}

#[test]
fn dense_regions_keep_every_sample_inside() {
    let field = sampled(30, 24, Interpolation::Bilinear, |x, y| x * x + y * y + 0.1 * x * y);
    let open = flat(vec![mask(&field, 0.7, MaskSide::AtMost)], field.clone(), Closing::None);
    let shape = HeightMap { bound: HeightBound::Dense, ..open };
    let density = SurfaceDensity::Tolerance(0.01);
    let detail = Detail { density, crease_angle: 30.0, uv: false, triangle_limit: 1 << 22 };
    let mesh = height_map(&shape, &detail, 0.01).unwrap().mesh;
    let places: BTreeSet<[u64; 2]> =
        mesh.vertices.iter().map(|corner| [corner.anchor.u.to_bits(), corner.anchor.v.to_bits()]).collect();
    let inside = field.samples().iter().enumerate().filter(|(_, value)| **value < 0.69);
    for (at, _) in inside {
        assert!(places.contains(&[(at % 30) as f64, (at / 30) as f64].map(f64::to_bits)));
    }
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|at| point(mesh, at)));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn body(front: HeightMap, back: HeightMap, tolerance: f64) -> Mesh {
    let density = SurfaceDensity::Tolerance(tolerance);
    let detail = Detail { density, crease_angle: 30.0, uv: true, triangle_limit: 1 << 22 };
    let made = two_sided(&TwoSided { front, back }, &detail, tolerance).unwrap();
    assert!(made.deviation.bound <= tolerance);
    made.mesh
}

#[test]
fn two_sides_meet_without_a_wall_between() {
    let size = DVec2::splat(2.0);
    let tolerance = 0.002;
    let side = |center: f64, height: f64| {
        let disk = sampled(25, 25, Interpolation::Bicubic, |x, y| (x - center) * (x - center) + y * y);
        let field = sampled(25, 25, Interpolation::Bicubic, |x, y| height * (2.0 - x * x - 0.5 * y));
        HeightMap { size, ..flat(vec![mask(&disk, 0.3, MaskSide::AtMost)], field, Closing::None) }
    };
    // The integral of h (2 - x^2 - y / 2) over a disk around [c, 0]: h (pi r^2) (2 - c^2 - r^2 / 4).
    let volume_of =
        |center: f64, height: f64| height * core::f64::consts::PI * 0.3 * (2.0 - center * center - 0.3 / 4.0);
    for apart in [0.0, 0.2, 0.45] {
        let mesh = body(side(-apart, 0.3), side(apart, 0.5), tolerance);
        assert!(is_manifold(&mesh), "{apart}");
        let exact = volume_of(-apart, 0.3) + volume_of(apart, 0.5);
        assert!((volume(&mesh) - exact).abs() < 0.01 * exact, "{apart}: {} {exact}", volume(&mesh));
        // On the plane there are triangles only where one side is alone.
        let on_plane =
            mesh.triangles.iter().filter(|triangle| triangle.iter().all(|at| point(&mesh, *at).y == 0.0));
        assert_eq!(on_plane.count() > 0, apart > 0.0);
    }
    // One disk within the other, and a side without any mask.
    let mut wide = side(0.0, 0.3);
    wide.masks[0].threshold = 0.6;
    assert!(is_manifold(&body(wide, side(0.0, 0.5), tolerance)));
    let whole = HeightMap { masks: Vec::new(), ..side(0.0, 0.3) };
    assert!(is_manifold(&body(whole.clone(), whole.clone(), tolerance)));
    assert!(is_manifold(&body(whole, side(0.1, 0.5), tolerance)));
}

#[test]
fn lenses_end_sharply_on_their_plane() {
    // Both sides fall to nothing on their common line: the sheets share it and there are no walls.
    let lens = sampled(33, 33, Interpolation::Bicubic, |x, y| 0.4 * (0.5 - x * x - y * y));
    let side = HeightMap {
        size: DVec2::splat(2.0),
        ..flat(vec![mask(&lens, 0.0, MaskSide::AtLeast)], lens.clone(), Closing::None)
    };
    let mesh = body(side.clone(), side, 0.001);
    assert!(is_manifold(&mesh));
    let exact = 2.0 * 0.4 * core::f64::consts::PI * 0.125;
    assert!((volume(&mesh) - exact).abs() < 0.01 * exact);
    let walls =
        mesh.triangles.iter().flatten().filter(|at| mesh.vertices[at.subscript()].anchor.source == 1).count();
    assert_eq!(walls, 0);
}

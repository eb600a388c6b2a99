//! Height maps against their fields, by sampling that shares nothing with the scan.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Closing, HeightBound, HeightMap, height_map};
use crate::geometry::map::{GridField, Interpolation};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::{floor_count, noise};
use crate::geometry::tessellate::{Detail, SurfaceDensity, TessellateError, Tessellation};

fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: true,
        triangle_limit: 1 << 22,
    }
}

fn hills(columns: usize, rows: usize, kind: Interpolation) -> Arc<GridField> {
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (i as f64, j as f64)));
    let height = |(x, y)| {
        noise(3.0, x * 0.11 + 0.3, y * 0.11 + 0.3) + 0.1 * noise(5.0, x * 0.83 + 0.1, y * 0.83 + 0.2)
    };
    Arc::new(GridField::new(columns, places.map(height).collect(), kind).unwrap())
}

fn map(field: Arc<GridField>, bound: HeightBound, close: Closing) -> HeightMap {
    HeightMap { field, size: DVec2::new(4.0, 3.0), bound, close, masks: Vec::new() }
}

fn make(shape: &HeightMap, tolerance: f64) -> Tessellation {
    height_map(shape, &detail(tolerance), tolerance).unwrap()
}

/// The greatest vertical distance from points of the upper sheet to the field; each triangle is sampled as finely as
/// sixteen places in a cell of the grid.
fn deviation(shape: &HeightMap, mesh: &Mesh) -> f64 {
    let mut worst = 0.0_f64;
    let cells = shape.field.extent();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|corner| mesh.vertices[corner.subscript()]);
        if corners.iter().any(|corner| corner.anchor.source != 0) {
            continue;
        }
        let [a, b, c] = corners.map(|corner| mesh.points[corner.point.subscript()]);
        let reach = (b - a).abs().max((c - a).abs());
        let steps = (4.0 * (reach.x / shape.size.x * cells[0]).max(reach.z / shape.size.y * cells[1]))
            .ceil()
            .max(4.0);
        let count = floor_count(steps);
        for i in 0..=count {
            for j in 0..=count - i {
                let (s, t) = (f64::from(i) / steps, f64::from(j) / steps);
                let point = a + (b - a) * s + (c - a) * t;
                let [x, y] = shape.place(point);
                worst = worst.max((point.y - shape.field.value(x, y)).abs());
            }
        }
    }
    worst
}

/// Volume of a mesh over its triangles, which must be closed.
fn volume(mesh: &Mesh) -> f64 {
    let at = |corner: crate::geometry::mesh::VertexIndex| {
        mesh.points[mesh.vertices[corner.subscript()].point.subscript()]
    };
    let mut edges = std::collections::BTreeMap::new();
    for triangle in &mesh.triangles {
        let points = triangle.map(|corner| mesh.vertices[corner.subscript()].point);
        for k in 0..3 {
            let (from, to) = (points[k], points[(k + 1) % 3]);
            assert_ne!(from, to);
            *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|balance| *balance == 0), "open");
    mesh.triangles.iter().map(|triangle| triangle.map(at)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn the_bound_holds_everywhere_and_is_met() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        for (columns, rows) in [(33, 41), (70, 20), (2, 9), (5, 3)] {
            let shape = map(hills(columns, rows, kind), HeightBound::Surface, Closing::None);
            for tolerance in [0.3, 0.03, 0.003] {
                let made = make(&shape, tolerance);
                let found = deviation(&shape, &made.mesh);
                let bound = made.deviation.bound;
                assert!(bound <= tolerance, "{kind:?} {columns} {rows} {tolerance}: {bound}");
                assert!(found <= bound * (1.0 + 1e-9) + 1e-14, "{kind:?} {columns} {rows}: {found} {bound}");
            }
        }
    }
}

#[test]
fn samples_and_dense_maps_tell_their_true_bound() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let field = hills(40, 30, kind);
        for bound in [HeightBound::Samples, HeightBound::Dense] {
            let shape = map(field.clone(), bound, Closing::None);
            let made = make(&shape, 0.02);
            let found = deviation(&shape, &made.mesh);
            assert!(
                found <= made.deviation.bound * (1.0 + 1e-9),
                "{bound:?} {found} {}",
                made.deviation.bound
            );
            for (at, height) in field.samples().iter().enumerate() {
                let place = [(at % 40) as f64, (at / 40) as f64];
                let below = shape.point(place, *height);
                let over = covering(&made.mesh, below);
                let most = if bound == HeightBound::Dense { 1e-12 } else { 0.02 + 1e-12 };
                assert!((over - height).abs() <= most, "{bound:?} {place:?}");
            }
        }
    }
}

/// Height of a sheet over a point.
fn covering(mesh: &Mesh, point: DVec3) -> f64 {
    let flat = |point: DVec3| DVec2::new(point.x, point.z);
    for triangle in &mesh.triangles {
        let [a, b, c] =
            triangle.map(|corner| mesh.points[mesh.vertices[corner.subscript()].point.subscript()]);
        let area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
        let s = (flat(point) - flat(a)).perp_dot(flat(c) - flat(a)) / area;
        let t = (flat(b) - flat(a)).perp_dot(flat(point) - flat(a)) / area;
        if s >= -1e-9 && t >= -1e-9 && s + t <= 1.0 + 1e-9 {
            return a.y + (b.y - a.y) * s + (c.y - a.y) * t;
        }
    }
    panic!("nothing over {point}");
}

#[test]
fn flat_ground_is_two_triangles_and_a_slope_too() {
    let slope = (0..30 * 20).map(|at| f64::from(at % 30) * 0.25 - f64::from(at / 30) * 0.5).collect();
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let field = Arc::new(GridField::new(30, Vec::clone(&slope), kind).unwrap());
        let made = make(&map(field, HeightBound::Surface, Closing::None), 1e-6);
        assert_eq!(made.mesh.triangles.len(), 2);
        assert!(made.deviation.bound < 1e-12);
    }
}

#[test]
fn closed_maps_enclose_the_integral_of_their_field() {
    // The integral of a bilinear field is the sum over cells of the mean of their corners.
    let field = hills(24, 18, Interpolation::Bilinear);
    let samples = field.samples();
    let cells = (0..17).flat_map(|j| (0..23).map(move |i| j * 24 + i));
    let mean: f64 =
        cells.map(|at| samples[at] + samples[at + 1] + samples[at + 24] + samples[at + 25]).sum::<f64>()
            / 4.0;
    let area = 4.0 * 3.0;
    let integral = area * mean / (23.0 * 17.0);
    for tolerance in [0.1, 0.01, 0.001] {
        let base = map(field.clone(), HeightBound::Surface, Closing::Base(-2.0));
        let exact = integral + 2.0 * area;
        assert!((volume(&make(&base, tolerance).mesh) - exact).abs() <= tolerance * area + 1e-9);
        let thick = map(field.clone(), HeightBound::Surface, Closing::Thickness(0.25));
        assert!((volume(&make(&thick, tolerance).mesh) - 0.25 * area).abs() < 1e-9);
    }
    // Without walls where it lies on its base.
    let mound = (0..25).map(|at| if at == 12 { 1.0 } else { 0.0 }).collect();
    let field = Arc::new(GridField::new(5, mound, Interpolation::Bilinear).unwrap());
    let made = make(&map(field, HeightBound::Dense, Closing::Base(0.0)), 0.1);
    assert!((volume(&made.mesh) - area / 16.0).abs() < area / 16.0);
    assert!(made.mesh.points.iter().filter(|point| point.y == 0.0).count() == 24);
}

#[test]
fn a_surface_below_its_base_is_refused() {
    let shape = map(hills(9, 9, Interpolation::Bilinear), HeightBound::Surface, Closing::Base(0.0));
    assert!(matches!(height_map(&shape, &detail(0.1), 0.1), Err(TessellateError::BelowBase { .. })));
}

#[test]
fn neighbours_share_their_border_to_the_last_bit() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let wide = hills(41, 17, Interpolation::Bilinear);
        let part = |from: usize| {
            let rows = wide.samples().chunks(41).flat_map(|row| row[from..from + 21].to_vec());
            Arc::new(GridField::new(21, rows.collect(), kind).unwrap())
        };
        let border = |field: Arc<GridField>, x: f64, aim: f64| {
            let shape = map(field, HeightBound::Surface, Closing::None);
            let made = height_map(&shape, &detail(aim), 0.004).unwrap();
            let mut points: Vec<DVec3> =
                made.mesh.points.iter().copied().filter(|point| point.x == x).collect();
            points.sort_by(|a, b| a.z.total_cmp(&b.z));
            points.iter().map(|point| (point.y, point.z)).collect::<Vec<_>>()
        };
        // What is kept for rounding depends on where a map lies, and changes nothing here.
        let (left, right) = (border(part(0), 2.0, 0.003_99), border(part(20), -2.0, 0.003_999));
        assert!(left.len() > 4);
        assert_eq!(left, right);
    }
}

#[test]
fn limits_hold_before_memory_is_taken() {
    let shape = map(hills(60, 60, Interpolation::Bicubic), HeightBound::Surface, Closing::None);
    let few = Detail { triangle_limit: 500, ..detail(1e-4) };
    assert!(matches!(height_map(&shape, &few, 1e-4), Err(TessellateError::TooMany { .. })));
    let fine = height_map(&shape, &detail(1e-12), 1e-12);
    assert!(matches!(fine, Err(TessellateError::TooMany { .. })));
}

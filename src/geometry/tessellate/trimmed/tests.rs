//! Laws of trimmed surfaces.

use core::f64::consts::PI;
use std::collections::BTreeMap;

use glam::DVec3;

use super::{TrimmedSurface, trimmed};
use crate::geometry::curve::control::BSpline;
use crate::geometry::curve::{AnyCurve, EllipseArc, Polyline, RationalSpline};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::ln;
use crate::geometry::surface::tensor::{Grid, PolynomialSurface, RationalSurface, revolved};
use crate::geometry::surface::{AnySurface, Surface as _};
use crate::geometry::tessellate::{Detail, SurfaceDensity, TessellateError, Tessellation};

fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: false,
        triangle_limit: 1 << 22,
    }
}

fn circle(x: f64, y: f64, radius: f64) -> AnyCurve {
    AnyCurve::Ellipse(EllipseArc::full(DVec3::new(x, y, 0.0), radius, radius))
}

fn polygon(corners: &[[f64; 2]]) -> AnyCurve {
    let points = corners.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
    AnyCurve::Polyline(Polyline::new(points, true).expect("corners"))
}

/// (2 u, v, 0) over the unit square.
fn plane() -> AnySurface {
    let corners = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y, DVec3::new(2.0, 1.0, 0.0)];
    let grid = Grid::new(2, corners).expect("two rows of two");
    let made = PolynomialSurface::bezier((1, 1), &grid, vec![0.0, 1.0], vec![0.0, 1.0]);
    AnySurface::Polynomial(Box::new(made.expect("one patch")))
}

/// (u, v, u^2 + v^2) from -1 to 1.
fn bowl() -> AnySurface {
    let ends = [-1.0, 0.0, 1.0];
    let square = [1.0, -1.0, 1.0];
    let grid = Grid::from_fn(3, 3, |i, j| DVec3::new(ends[i], ends[j], square[i] + square[j]));
    let breaks = || vec![-1.0, 1.0];
    let made = PolynomialSurface::bezier((2, 2), &grid.expect("nine points"), breaks(), breaks());
    AnySurface::Polynomial(Box::new(made.expect("one patch")))
}

/// The unit ball: u runs around in quarters, v from the south pole to the north.
fn ball() -> AnySurface {
    let half = 0.5_f64.sqrt();
    let points =
        [([0.0, -1.0], 1.0), ([1.0, -1.0], half), ([1.0, 0.0], 1.0), ([1.0, 1.0], half), ([0.0, 1.0], 1.0)];
    let control = points.map(|([x, y], w)| RationalSpline::homogeneous(DVec3::new(x, y, 0.0), w));
    let profile = BSpline::from_bezier(2, control.to_vec(), &[0.0, 0.5, 1.0]).expect("two pieces");
    let spline = revolved(&profile, 0.0, 360.0);
    AnySurface::Rational(Box::new(RationalSurface::spline(&spline).expect("positive weights")))
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    mesh.triangles
        .iter()
        .map(|corners| corners.map(|corner| mesh.points[mesh.vertices[corner.subscript()].point.subscript()]))
}

fn area(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// Edges by how often they are used: once at the border, twice inside, in both directions.
fn border(mesh: &Mesh) -> usize {
    let mut uses: BTreeMap<(u32, u32), Vec<bool>> = BTreeMap::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| mesh.vertices[corner.subscript()].point.0);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            uses.entry((from.min(to), from.max(to))).or_default().push(from < to);
        }
    }
    assert!(uses.values().all(|ways| ways.len() == 1 || (ways.len() == 2 && ways[0] != ways[1])));
    uses.values().filter(|ways| ways.len() == 1).count()
}

/// Edges, and points and triangles together: they differ by Euler's number.
fn counts(mesh: &Mesh) -> (usize, usize) {
    let edges = (3 * mesh.triangles.len() + border(mesh)) / 2;
    (edges, mesh.points.len() + mesh.triangles.len())
}

fn made(surface: &AnySurface, outlines: Vec<AnyCurve>, tolerance: f64) -> Tessellation {
    let shape = TrimmedSurface::new(surface.clone(), outlines);
    let made = trimmed(&shape, &detail(tolerance)).unwrap_or_else(|error| panic!("{error}"));
    assert!(made.deviation.bound <= tolerance, "{} of {tolerance}", made.deviation.bound);
    for (corners, [a, b, c]) in made.mesh.triangles.iter().zip(corners(&made.mesh)) {
        let across = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        assert!(across.length() > 1e-9 * longest, "{a} {b} {c}");
        for corner in corners {
            let vertex = made.mesh.vertices[corner.subscript()];
            let jet = surface.evaluate(vertex.anchor.u, vertex.anchor.v);
            assert!(jet.point.distance(made.mesh.points[vertex.point.subscript()]) < 1e-9);
            assert!(across.dot(vertex.normal) > 0.0);
        }
    }
    made
}

/// How fast errors of areas fall with the tolerance, over three decades.
fn exponent(surface: &AnySurface, outlines: &[AnyCurve], expected: f64) -> f64 {
    let errors = [1e-1, 1e-4]
        .map(|tolerance| (area(&made(surface, outlines.to_vec(), tolerance).mesh) / expected - 1.0).abs());
    assert!(errors[1] < 1e-3, "{errors:?}");
    -ln(errors[1] / errors[0]) / ln(1000.0)
}

#[test]
fn areas_are_those_of_closed_forms() {
    // An ellipse of half axes 0.8 and 0.4 in a plane; a disk and a ring of a paraboloid.
    let found = exponent(&plane(), &[circle(0.5, 0.5, 0.4)], PI * 0.8 * 0.4);
    assert!(found >= 0.9, "{found}");
    let of_bowl = |radius: f64| {
        let root = (1.0 + 4.0 * radius * radius).sqrt();
        PI / 6.0 * (root * root * root - 1.0)
    };
    let found = exponent(&bowl(), &[circle(0.0, 0.0, 0.9)], of_bowl(0.9));
    assert!(found >= 0.9, "{found}");
    let ring = [circle(0.0, 0.0, 0.9), circle(0.0, 0.0, 0.4)];
    let found = exponent(&bowl(), &ring, of_bowl(0.9) - of_bowl(0.4));
    assert!(found >= 0.9, "{found}");
}

/// A cap of a ball goes around its pole and over its seam: one border, and the area of Archimedes.
#[test]
fn poles_and_seams_are_closed() {
    let ball = ball();
    let (u, v) = (ball.domain_u(), ball.domain_v());
    for share in [0.25, 0.5, 0.8] {
        let top = v.start + share * v.span();
        let outline = polygon(&[[u.start, v.start], [u.end, v.start], [u.end, top], [u.start, top]]);
        let height = ball.evaluate(u.start, top).point.y + 1.0;
        for tolerance in [1e-2, 1e-3] {
            let made = made(&ball, vec![outline.clone()], tolerance);
            let off = (area(&made.mesh) - 2.0 * PI * height).abs();
            assert!(off < 20.0 * tolerance, "{share} {off}");
            // All of the border lies on the circle at the top.
            let edges = border(&made.mesh);
            let on_top = made.mesh.points.iter().filter(|point| (point.y + 1.0 - height).abs() < 1e-9);
            assert_eq!(edges, on_top.count());
        }
    }
    let whole = polygon(&[[u.start, v.start], [u.end, v.start], [u.end, v.end], [u.start, v.end]]);
    assert_eq!(border(&made(&ball, vec![whole], 1e-2).mesh), 0);
}

#[test]
fn a_hole_in_a_ball_leaves_the_rest() {
    let ball = ball();
    let (u, v) = (ball.domain_u(), ball.domain_v());
    let whole = polygon(&[[u.start, v.start], [u.end, v.start], [u.end, v.end], [u.start, v.end]]);
    let hole = circle(u.at(0.3), v.at(0.5), 0.1 * v.span().min(u.span()));
    let rest = area(&made(&ball, vec![whole, hole.clone()], 1e-3).mesh);
    let lid = area(&made(&ball, vec![hole], 1e-3).mesh);
    assert!((rest + lid - 4.0 * PI).abs() < 2e-2, "{rest} {lid}");
}

#[test]
fn lines_that_cross_are_refused() {
    let outlines = vec![circle(0.4, 0.5, 0.3), circle(0.6, 0.5, 0.3)];
    let shape = TrimmedSurface::new(plane(), outlines);
    assert_eq!(trimmed(&shape, &detail(1e-2)), Err(TessellateError::Tangled));
    let shape = TrimmedSurface::new(bowl(), vec![circle(0.0, 0.0, 0.9)]);
    let few = Detail { triangle_limit: 50, ..detail(1e-5) };
    assert!(matches!(trimmed(&shape, &few), Err(TessellateError::TooMany { .. })));
}

#[test]
fn a_fixed_grid_is_a_lattice() {
    let shape = TrimmedSurface::new(bowl(), vec![circle(0.0, 0.0, 0.9)]);
    let grid = Detail { density: SurfaceDensity::Grid { u: 16, v: 10 }, ..detail(1.0) };
    let made = trimmed(&shape, &grid).expect("a grid");
    assert_eq!(border(&made.mesh), 16);
    assert!(made.mesh.triangles.len() > 60);
}

/// Two halves of a roof over the unit square that meet along u = 1/2 at a height of 1/2.
fn roof() -> AnySurface {
    let heights = [0.0, 0.5, 0.0];
    let grid = Grid::from_fn(3, 2, |i, j| DVec3::new(i as f64 / 2.0, j as f64, heights[i]));
    let breaks = vec![0.0, 0.5, 1.0];
    let made = PolynomialSurface::bezier((1, 1), &grid.expect("six points"), breaks, vec![0.0, 1.0]);
    AnySurface::Polynomial(Box::new(made.expect("two patches")))
}

/// A ring of radii 2 and 1/2: u around it in quarters, v around its tube in quarters.
fn ring() -> AnySurface {
    let half = 0.5_f64.sqrt();
    let circle = [
        ([2.5, 0.0], 1.0),
        ([2.5, 0.5], half),
        ([2.0, 0.5], 1.0),
        ([1.5, 0.5], half),
        ([1.5, 0.0], 1.0),
        ([1.5, -0.5], half),
        ([2.0, -0.5], 1.0),
        ([2.5, -0.5], half),
        ([2.5, 0.0], 1.0),
    ];
    let control = circle.map(|([x, y], w)| RationalSpline::homogeneous(DVec3::new(x, y, 0.0), w));
    let breaks = [0.0, 0.25, 0.5, 0.75, 1.0];
    let profile = BSpline::from_bezier(2, control.to_vec(), &breaks).expect("four pieces");
    let spline = revolved(&profile, 0.0, 360.0);
    AnySurface::Rational(Box::new(RationalSurface::spline(&spline).expect("positive weights")))
}

/// What lies over a seam is what lies elsewhere: a ring looks the same after each quarter turn and mirrored in its plane.
#[test]
fn outlines_run_over_seams() {
    let ring = ring();
    let (u, v) = (ring.domain_u(), ring.domain_v());
    let radius = 0.1 * u.span().min(v.span());
    let disk = |x: f64, y: f64| circle(u.start + x * u.span(), v.start + y * v.span(), radius);
    let inside = made(&ring, vec![disk(0.25, 0.5)], 1e-2);
    for x in [0.0, 0.5, 1.0, 3.0, -1.0] {
        let over = made(&ring, vec![disk(x, 0.5)], 1e-2);
        assert!((area(&over.mesh) - area(&inside.mesh)).abs() < 1e-2, "{x}");
        // One part, and one border all around it.
        let (edges, others) = counts(&over.mesh);
        assert_eq!(others, edges + 1, "{x}");
    }
    let whole = polygon(&[[u.start, v.start], [u.end, v.start], [u.end, v.end], [u.start, v.end]]);
    let all = area(&made(&ring, vec![whole.clone()], 1e-2).mesh);
    // The area of Pappus; chords of a tube leave out about four times the tolerance over its radius.
    assert!((all / (4.0 * PI * PI * 2.0 * 0.5) - 1.0).abs() < 0.08, "{all}");
    for (x, y) in [(0.0, 0.5), (0.0, 0.0), (1.0, 1.0), (0.97, 0.02), (1.05, -0.03), (0.5, 1.0)] {
        let rest = made(&ring, vec![whole.clone(), disk(x, y)], 1e-2);
        let lid = made(&ring, vec![disk(x, y)], 1e-2);
        assert!((area(&rest.mesh) + area(&lid.mesh) - all).abs() < 0.02 * all, "{x} {y}");
        assert_eq!(border(&rest.mesh), border(&lid.mesh), "{x} {y}");
        // A ring with a hole.
        let (edges, others) = counts(&rest.mesh);
        assert_eq!(others + 1, edges, "{x} {y}");
    }
    // A band around the tube and over the seam: two borders, and the area of Pappus.
    let band = polygon(&[[-0.1, v.start], [0.1, v.start], [0.1, v.end], [-0.1, v.end]]);
    let band = made(&ring, vec![band], 1e-2);
    assert_eq!(band.mesh.points.len() * 2 - border(&band.mesh), band.mesh.triangles.len());
    // A band all around that starts and ends anywhere has no border there.
    let band = polygon(&[[-0.4, 0.2], [u.span() - 0.4, 0.2], [u.span() - 0.4, 0.7], [-0.4, 0.7]]);
    let band = made(&ring, vec![band], 1e-2);
    assert_eq!(band.mesh.points.len() * 2 - border(&band.mesh), band.mesh.triangles.len());
}

/// An ellipse over the ridge of a roof: both halves are flat, and the ridge is an edge.
#[test]
fn outlines_run_over_edges() {
    let outlines = vec![circle(0.5, 0.5, 0.3)];
    let made = made(&roof(), outlines, 1e-4);
    // Each half leans by 45 degrees.
    assert!((area(&made.mesh) - PI * 0.09 * 2.0_f64.sqrt()).abs() < 1e-3);
    let ridge = made.mesh.points.iter().filter(|point| point.x == 0.5).count();
    assert!(ridge >= 2);
    for vertex in &made.mesh.vertices {
        let point = made.mesh.points[vertex.point.subscript()];
        assert!((point.z - (0.5 - (point.x - 0.5).abs())).abs() < 1e-12, "{point}");
        assert!((vertex.normal.x.abs() - 0.5_f64.sqrt()).abs() < 1e-12);
    }
    // The border is one line; the ridge belongs to it with its two ends.
    let (edges, others) = counts(&made.mesh);
    assert_eq!(others, edges + 1);
    // With a greater angle it is smooth.
    let shape = TrimmedSurface::new(roof(), vec![circle(0.5, 0.5, 0.3)]);
    let smooth = trimmed(&shape, &Detail { crease_angle: 100.0, ..detail(1e-3) }).expect("a cap");
    let on_ridge =
        |vertex: &&crate::geometry::mesh::Vertex| smooth.mesh.points[vertex.point.subscript()].x == 0.5;
    assert!(smooth.mesh.vertices.iter().filter(on_ridge).all(|vertex| vertex.normal.x.abs() < 1e-12));
}

/// Outlines along an edge, and holes that touch one.
#[test]
fn outlines_run_along_edges() {
    let half = polygon(&[[0.5, 0.1], [0.9, 0.1], [0.9, 0.9], [0.5, 0.9]]);
    let one = made(&roof(), vec![half.clone()], 1e-3);
    assert!((area(&one.mesh) - 0.32 * 2.0_f64.sqrt()).abs() < 1e-9);
    let whole = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let rest = made(&roof(), vec![whole, half], 1e-3);
    assert!((area(&rest.mesh) - 0.68 * 2.0_f64.sqrt()).abs() < 1e-9);
}

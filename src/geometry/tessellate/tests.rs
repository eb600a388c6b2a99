//! Laws that every tessellation keeps: closed where the shape is, within its bound, unit normals outward.

use glam::{DVec2, DVec3};

use super::{
    Detail, Extrusion, Revolution, SurfaceDensity, Sweep, Tessellation, cuboid, extrude, revolve, sweep,
};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, EllipseArc, Helix, Parametrization, Polyline, interpolate, interpolate_closed,
    parameters,
};
use crate::geometry::mesh::topology::measure;
use crate::geometry::number::{cos_degrees, sin_degrees};
use crate::geometry::surface::Carry;

fn polyline(points: &[(f64, f64)], closed: bool) -> AnyCurve {
    let points = points.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect();
    AnyCurve::Polyline(Polyline::new(points, closed).unwrap())
}

fn circle(x: f64, y: f64, radius: f64) -> AnyCurve {
    AnyCurve::Ellipse(EllipseArc::full(DVec3::new(x, y, 0.0), radius, radius))
}

fn bezier(points: &[(f64, f64)]) -> AnyCurve {
    let points = points.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect();
    AnyCurve::Bezier(BezierSpline::new(3, points).unwrap())
}

fn vase() -> AnyCurve {
    bezier(&[(0.0, 0.0), (0.9, 0.0), (1.2, 0.5), (1.0, 1.0), (0.8, 1.5), (0.5, 1.6), (0.0, 2.0)])
}

fn knot(closed: bool) -> AnyCurve {
    let points: Vec<DVec3> = (0..12)
        .map(|k| {
            let angle = f64::from(k) * 30.0;
            DVec3::new(2.0 * cos_degrees(angle), sin_degrees(3.0 * angle), 2.0 * sin_degrees(angle))
        })
        .collect();
    let numbers = parameters(&points, closed, Parametrization::Chordal).unwrap();
    let curve = if closed { interpolate_closed(&points, &numbers) } else { interpolate(&points, &numbers) };
    AnyCurve::Bezier(curve.unwrap())
}

/// Each density with each kind of attributes.
fn details() -> Vec<Detail> {
    let densities = [
        SurfaceDensity::Tolerance(0.05),
        SurfaceDensity::Tolerance(0.002),
        SurfaceDensity::Grid { u: 7, v: 9 },
        SurfaceDensity::Grid { u: 32, v: 16 },
    ];
    let both =
        |density| [false, true].map(|uv| Detail { density, crease_angle: 30.0, uv, triangle_limit: 1 << 24 });
    densities.into_iter().flat_map(both).collect()
}

pub(super) fn volume(made: &Tessellation) -> f64 {
    let mesh = &made.mesh;
    let point = |vertex: &crate::geometry::mesh::VertexIndex| {
        mesh.points[mesh.vertices[vertex.subscript()].point.subscript()]
    };
    let six = mesh.triangles.iter().map(|[a, b, c]| point(a).dot(point(b).cross(point(c))));
    six.sum::<f64>() / 6.0
}

pub(super) fn check(name: &str, made: &Tessellation, detail: &Detail, closed: bool) {
    let mesh = &made.mesh;
    let corner = |corner: usize| mesh.vertices[mesh.triangles[corner / 3][corner % 3].subscript()].point.0;
    let topology = measure(mesh.triangles.len(), mesh.points.len(), corner).unwrap();
    assert_eq!(topology.closed, closed, "{name} {detail:?} {topology:?}");
    if closed {
        assert!(topology.manifold, "{name} {detail:?} {topology:?}");
    }
    if let SurfaceDensity::Tolerance(tolerance) = detail.density {
        let bound = made.deviation.bound;
        // Rows behind the mitre of a twisted corner are left out, and the bound says what that costs.
        let torn = name.contains("corner by 90");
        assert!(torn || bound <= tolerance * (1.0 + 1e-12), "{name} {detail:?} bound {bound}");
    }
    if name.contains("corner by 90") {
        // Beside a mitre that is longer than the twist's rows there is no surface to be faithful to.
        return;
    }
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.vertices[vertex.subscript()]);
        let [a, b, c] = corners.map(|vertex| mesh.points[vertex.point.subscript()]);
        let across = (b - a).cross(c - a);
        assert!(across.length() > 0.0, "{name} {detail:?}: a triangle has no area");
        for vertex in corners {
            assert!((vertex.normal.length() - 1.0).abs() < 1e-9, "{name} {detail:?}");
            assert!(
                vertex.normal.dot(across.normalize()) > 0.0,
                "{name} {detail:?} at {a} {b} {c}: {}",
                vertex.normal
            );
            assert!(vertex.uv.cmpge(DVec2::ZERO).all() && vertex.uv.cmple(DVec2::ONE).all(), "{name}");
        }
    }
    assert_eq!(mesh.runs[0].end as usize, mesh.triangles.len());
}

#[test]
fn revolutions_keep_the_laws() {
    let square = [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)];
    let cup = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.8, 1.0), (0.8, 0.2), (0.0, 0.2)];
    let cases: [(&str, AnyCurve, bool, bool); 9] = [
        ("sphere", AnyCurve::Ellipse(EllipseArc::circle(DVec3::ZERO, 1.0, -90.0, 90.0)), true, true),
        ("vase", vase(), true, true),
        ("torus", circle(3.0, 0.0, 1.0), true, true),
        ("washer", polyline(&square, true), true, true),
        ("cup", polyline(&cup, false), true, true),
        ("double cone", polyline(&[(0.0, -1.0), (1.0, 0.0), (0.0, 1.0)], false), true, true),
        ("down", polyline(&[(0.0, 1.0), (1.0, 0.0), (0.0, -1.0)], false), true, true),
        ("pipe", polyline(&[(1.0, 0.0), (1.0, 2.0)], false), false, false),
        ("funnel", bezier(&[(1.0, 0.0), (1.0, 1.0), (0.2, 1.0), (0.2, 2.0)]), false, false),
    ];
    for (name, profile, closed, closed_with_caps) in cases {
        for angle in [360.0, 270.0, 30.0] {
            for detail in details() {
                let shape = Revolution { profile: profile.clone(), start: 10.0, angle, caps: true };
                let made = revolve(&shape, &detail).unwrap();
                let solid = if angle == 360.0 { closed } else { closed_with_caps };
                check(&format!("{name} by {angle}"), &made, &detail, solid);
                if solid {
                    assert!(volume(&made) > 0.0, "{name} by {angle} is inside out");
                }
            }
        }
    }
}

#[test]
fn a_sphere_needs_few_triangles_and_meets_its_bound() {
    let profile = AnyCurve::Ellipse(EllipseArc::circle(DVec3::ZERO, 1.0, -90.0, 90.0));
    let shape = Revolution { profile, start: 0.0, angle: 360.0, caps: true };
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let density = SurfaceDensity::Tolerance(tolerance);
        let detail = Detail { density, crease_angle: 30.0, uv: false, triangle_limit: 1 << 24 };
        let made = revolve(&shape, &detail).unwrap();
        // The integral of sqrt|K| dA over 2 tolerances.
        let optimum = 4.0 * core::f64::consts::PI / (2.0 * tolerance);
        let ratio = made.mesh.triangles.len() as f64 / optimum;
        assert!(ratio < 1.25, "{tolerance}: {ratio}");
        let mesh = &made.mesh;
        for triangle in &mesh.triangles {
            let [a, b, c] =
                triangle.map(|vertex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()]);
            // The plane's distance from the center bounds how deep the triangle cuts.
            let normal = (b - a).cross(c - a).normalize();
            let depth = 1.0 - normal.dot(a).abs();
            assert!(depth <= made.deviation.bound * (1.0 + 1e-9) || depth < 1e-15, "{depth}");
        }
    }
}

#[test]
fn extrusions_keep_the_laws() {
    let outline = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 1.0), (0.0, 3.0)];
    let round =
        bezier(&[(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0), (-3.0, 3.0), (-3.0, 0.0), (0.0, 0.0)]);
    let cases = [
        ("arrow", vec![polyline(&outline, true)]),
        (
            "clockwise",
            vec![AnyCurve::Reversed(crate::geometry::curve::Reversed::new(polyline(&outline, true)))],
        ),
        ("disc with two holes", vec![circle(0.0, 0.0, 3.0), circle(1.5, 0.0, 1.0), circle(-1.5, 0.0, 1.0)]),
        ("blob", vec![round]),
    ];
    for (name, outlines) in cases {
        for caps in [true, false] {
            for detail in details() {
                let islands = vec![outlines.len()];
                let shape = Extrusion {
                    outlines: outlines.clone(),
                    islands,
                    bottom: -1.0,
                    height: 2.0,
                    caps,
                    edge: None,
                };
                let made = extrude(&shape, &detail).unwrap();
                check(name, &made, &detail, caps);
                if caps {
                    assert!(volume(&made) > 0.0);
                }
            }
        }
    }
}

#[test]
fn sweeps_keep_the_laws() {
    let section = circle(0.0, 0.0, 0.2);
    let bar = polyline(&[(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1)], true);
    let strip = polyline(&[(-0.2, 0.0), (0.2, 0.0)], false);
    let helix = AnyCurve::Helix(Helix { radius: 1.0, end_radius: 0.6, pitch: 0.7, turns: 3.5 });
    let frame = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)];
    let paths = [
        ("helix", helix, false),
        ("knot", knot(true), true),
        ("open knot", knot(false), false),
        ("frame", polyline(&frame, true), true),
        ("corner", polyline(&frame[..3], false), false),
        ("line", polyline(&frame[..2], false), false),
    ];
    for (section_name, profile, solid) in
        [("tube", section, true), ("bar", bar, true), ("strip", strip, false)]
    {
        for (path_name, path, _) in &paths {
            for twist in [0.0, 90.0] {
                for detail in details() {
                    let carry = Carry { twist, ..Carry::PLAIN };
                    let shape = Sweep::plain(profile.clone(), path.clone(), carry);
                    if twist != 0.0 && matches!(*path_name, "knot" | "frame") {
                        continue;
                    }
                    let coarse = matches!(detail.density, SurfaceDensity::Grid { u: 7, .. });
                    if coarse && (path_name.contains("knot") || *path_name == "helix") {
                        continue;
                    }
                    let made = sweep(&shape, &detail).unwrap_or_else(|e| {
                        panic!("{section_name} along {path_name} by {twist} {detail:?} {e:?}")
                    });
                    check(&format!("{section_name} along {path_name} by {twist}"), &made, &detail, solid);
                    if solid {
                        assert!(volume(&made) > 0.0, "{section_name} along {path_name}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_box_is_exact() {
    let detail = details()[0];
    let made = cuboid(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, -1.0, 4.0), true);
    check("box", &made, &detail, true);
    assert!((volume(&made) - 6.0).abs() < 1e-12);
}

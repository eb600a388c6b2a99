use glam::DVec3;

use super::{Patchwork, Rim, patchwork};
use crate::geometry::curve::{AnyCurve, BezierSpline, EllipseArc, Polyline, Reversed, Side};
use crate::geometry::mesh::VertexIndex;
use crate::geometry::surface::{AnySurface, RuledSurface, Surface, TranslationalSurface};
use crate::geometry::tessellate::tests::{check, volume};
use crate::geometry::tessellate::{Detail, SurfaceDensity, Tessellation};

fn line(points: &[[f64; 3]], closed: bool) -> AnyCurve {
    AnyCurve::Polyline(
        Polyline::new(points.iter().map(|point| DVec3::from(*point)).collect(), closed).unwrap(),
    )
}

fn bezier(points: &[[f64; 3]]) -> AnyCurve {
    let points = points.iter().map(|point| DVec3::from(*point)).collect::<Vec<_>>();
    AnyCurve::Bezier(BezierSpline::new(points.len() - 1, points).unwrap())
}

fn circle(radius: f64, z: f64) -> AnyCurve {
    AnyCurve::Ellipse(EllipseArc::full(DVec3::new(0.0, 0.0, z), radius, radius))
}

fn ruled(from: AnyCurve, to: AnyCurve) -> AnySurface {
    AnySurface::Ruled(Box::new(RuledSurface::new(from, to)))
}

fn moved(profile: AnyCurve, path: AnyCurve) -> AnySurface {
    AnySurface::Translational(Box::new(TranslationalSurface::new(profile, path)))
}

fn square(size: f64, z: f64) -> AnyCurve {
    line(&[[size, -size, z], [size, size, z], [-size, size, z], [-size, -size, z]], true)
}

struct Case {
    name: &'static str,
    shape: Patchwork,
    closed: bool,
}

fn cases() -> Vec<Case> {
    let open = |name, surface| Case {
        name,
        shape: Patchwork { surfaces: vec![surface], caps: Vec::new() },
        closed: false,
    };
    let solid = |name, surface, rims: &[Rim]| Case {
        name,
        shape: Patchwork { surfaces: vec![surface], caps: rims.iter().map(|rim| vec![(0, *rim)]).collect() },
        closed: true,
    };
    let both = [Rim::Bottom, Rim::Top];
    let wave = bezier(&[[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [2.0, -2.0, 0.0], [3.0, 0.0, 0.0]]);
    let apex = |profile: AnyCurve, z: f64| {
        AnySurface::Ruled(Box::new(RuledSurface::to_point(profile, DVec3::new(0.3, 0.1, z))))
    };
    vec![
        open(
            "hyperbolic paraboloid",
            ruled(
                line(&[[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]], false),
                line(&[[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]], false),
            ),
        ),
        open("cubic to line", ruled(wave.clone(), line(&[[0.0, 0.0, 3.0], [3.0, 0.0, 3.0]], false))),
        open(
            "flat trapezoid",
            ruled(
                line(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]], false),
                line(&[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0]], false),
            ),
        ),
        open("flat ring", ruled(circle(1.0, 0.0), circle(2.0, 0.0))),
        solid("frustum", ruled(circle(1.0, 0.0), circle(0.4, 1.5)), &both),
        solid("cone", apex(circle(1.0, 0.0), 2.0), &[Rim::Bottom]),
        solid("pyramid", apex(square(1.0, 0.0), 2.0), &[Rim::Bottom]),
        solid("square to circle", ruled(square(1.0, 0.0), circle(0.5, 1.0)), &both),
        solid(
            "inside out",
            ruled(
                AnyCurve::Reversed(Reversed::new(circle(1.0, 0.0))),
                AnyCurve::Reversed(Reversed::new(square(1.0, 1.0))),
            ),
            &both,
        ),
        open("saddle", moved(wave.clone(), bezier(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5, 1.0, 2.0]]))),
        open(
            "bowl",
            moved(
                bezier(&[[-1.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1.0, 0.0]]),
                bezier(&[[0.0, 1.0, -1.0], [0.0, -1.0, 0.0], [0.0, 1.0, 1.0]]),
            ),
        ),
        open("corrugated", moved(wave, line(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.3, 2.0]], false))),
    ]
}

fn detail(tolerance: f64, uv: bool) -> Detail {
    Detail { density: SurfaceDensity::Tolerance(tolerance), crease_angle: 30.0, uv, triangle_limit: 1 << 24 }
}

#[test]
fn patchworks_keep_the_laws() {
    for Case { name, shape, closed } in cases() {
        for tolerance in [0.3, 0.05, 0.01, 0.001] {
            for uv in [false, true] {
                let detail = detail(tolerance, uv);
                let made = patchwork(&shape, &detail).unwrap();
                check(name, &made, &detail, closed);
                assert!(!closed || volume(&made) > 0.0, "{name}");
            }
        }
        for grid in [(1, 1), (7, 3), (16, 16)] {
            let density = SurfaceDensity::Grid { u: grid.0, v: grid.1 };
            let detail = Detail { density, ..detail(1.0, false) };
            let made = patchwork(&shape, &detail).unwrap();
            if grid.0 >= 3 {
                check(name, &made, &detail, closed);
            }
        }
    }
}

/// The greatest distance from places spread over a mesh to its surface, by Newton's method from the parameters
/// of the places.
fn measured(shape: &Patchwork, made: &Tessellation) -> f64 {
    let mesh = &made.mesh;
    let mut worst = 0.0_f64;
    for triangle in &mesh.triangles {
        let corners = triangle.map(|VertexIndex(vertex)| mesh.vertices[vertex as usize]);
        let Some(surface) = shape.surfaces.get(corners[0].anchor.source as usize) else { continue };
        let places = corners.map(|vertex| mesh.points[vertex.point.subscript()]);
        for i in 0..=6 {
            for j in 0..=6 - i {
                let weights = [f64::from(i) / 6.0, f64::from(j) / 6.0, f64::from(6 - i - j) / 6.0];
                let sum = |values: [f64; 3]| -> f64 { values.iter().zip(weights).map(|(a, b)| a * b).sum() };
                let place = places[0] * weights[0] + places[1] * weights[1] + places[2] * weights[2];
                let start = (sum(corners.map(|c| c.anchor.u)), sum(corners.map(|c| c.anchor.v)));
                worst = worst.max(near(surface, place, start));
            }
        }
    }
    worst
}

fn near(surface: &AnySurface, place: DVec3, (mut u, mut v): (f64, f64)) -> f64 {
    let (du, dv) = (surface.domain_u(), surface.domain_v());
    let mut best = f64::INFINITY;
    for _ in 0..40 {
        let side = |t: f64, end: f64| if t >= end { Side::Before } else { Side::After };
        let jet = surface.sided((u, side(u, du.end)), (v, side(v, dv.end)));
        let away = place - jet.point;
        best = best.min(away.length());
        let (a, b, c) =
            (jet.du.length_squared() + 1e-12, jet.du.dot(jet.dv), jet.dv.length_squared() + 1e-12);
        let determinant = a * c - b * b;
        let (x, y) = (away.dot(jet.du), away.dot(jet.dv));
        let (step_u, step_v) = ((x * c - y * b) / determinant, (y * a - x * b) / determinant);
        let (next_u, next_v) = (u + step_u, v + step_v);
        // On a rim the other parameter goes its own way.
        let (in_u, in_v) = (next_u.clamp(du.start, du.end), next_v.clamp(dv.start, dv.end));
        (u, v) = match (in_u == next_u, in_v == next_v) {
            (true, false) => ((u + (x - b * (in_v - v)) / a).clamp(du.start, du.end), in_v),
            (false, true) => (in_u, (v + (y - b * (in_u - u)) / c).clamp(dv.start, dv.end)),
            _ => (in_u, in_v),
        };
    }
    best
}

#[test]
fn bounds_hold_and_are_kept() {
    for Case { name, shape, .. } in cases() {
        for tolerance in [0.1, 0.01, 0.001] {
            let made = patchwork(&shape, &detail(tolerance, true)).unwrap();
            let (found, bound) = (measured(&shape, &made), made.deviation.bound);
            assert!(found <= bound * (1.0 + 1e-6) + 1e-12, "{name} {tolerance}: {found} beyond {bound}");
            assert!(bound <= tolerance, "{name}");
        }
    }
}

#[test]
fn bounds_of_grids_hold() {
    for Case { name, shape, .. } in cases() {
        for (u, v) in [(3, 5), (16, 12)] {
            let detail = Detail { density: SurfaceDensity::Grid { u, v }, ..detail(1.0, true) };
            let made = patchwork(&shape, &detail).unwrap();
            let (found, bound) = (measured(&shape, &made), made.deviation.bound);
            assert!(found <= bound * (1.0 + 1e-6) + 1e-12, "{name} {u} {v}: {found} beyond {bound}");
            assert!(bound.is_finite(), "{name}");
        }
    }
}

/// The integral of sqrt |K| dA over twice the tolerance.
fn optimum(surface: &AnySurface, tolerance: f64) -> f64 {
    const STEPS: u32 = 200;
    let part = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (u, v) = ((part(i), Side::After), (part(j), Side::After));
            let (jet, second) = (surface.sided(u, v), surface.second(u, v));
            let [l, m, n] = [second.uu, second.uv, second.vv].map(|bend| bend.dot(jet.normal));
            sum += (l * n - m * m).abs().sqrt();
        }
    }
    sum / f64::from(STEPS * STEPS) / (2.0 * tolerance)
}

#[test]
fn doubly_curved_surfaces_need_few_triangles() {
    for Case { name, shape, .. } in cases() {
        if !matches!(name, "hyperbolic paraboloid" | "saddle" | "bowl" | "cubic to line") {
            continue;
        }
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let made = patchwork(&shape, &detail(tolerance, false)).unwrap();
            let best = optimum(&shape.surfaces[0], tolerance);
            let ratio = made.mesh.triangles.len() as f64 / best;
            // Coarse meshes end in whole rows; as the tolerance falls only what zipping and proving cost remains.
            let most = if tolerance > 5e-3 { 1.75 } else { 1.6 };
            assert!(ratio <= most && ratio > 0.4, "{name} at {tolerance}: {ratio:.3} of the optimum");
        }
    }
}

#[test]
fn a_flat_trapezoid_is_two_triangles() {
    let case = cases().into_iter().find(|case| case.name == "flat trapezoid").unwrap();
    let made = patchwork(&case.shape, &detail(0.001, false)).unwrap();
    assert_eq!(made.mesh.triangles.len(), 2);
    assert_eq!(made.deviation.bound, 0.0);
    assert_eq!(made.mesh.points.len(), 4);
}

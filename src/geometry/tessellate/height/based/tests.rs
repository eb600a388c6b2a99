//! Height maps over curved bases against closed forms and by sampling that shares nothing with the search.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};

use super::super::{Mask, MaskSide};
use super::{
    Base, BaseFault, BaseSurface, BasedMap, Chart, Closing, HeightBound, HeightMap, Layer, SurfaceBase,
    based_map,
};
use crate::geometry::curve::{AnyCurve, EllipseArc, Polyline};
use crate::geometry::map::{GridField, Interpolation};
use crate::geometry::mesh::{Mesh, VertexIndex};
use crate::geometry::number::{cos_degrees, noise, sin_cos_degrees, sin_degrees};
use crate::geometry::surface::{ExtrudedSurface, RevolvedSurface};
use crate::geometry::tessellate::{Detail, SurfaceDensity, TessellateError, Tessellation};

const PI: f64 = core::f64::consts::PI;

fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: true,
        triangle_limit: 1 << 22,
    }
}

fn heights(field: GridField, close: Closing) -> HeightMap {
    HeightMap {
        field: Arc::new(field),
        size: DVec2::ONE,
        bound: HeightBound::Surface,
        close,
        masks: Vec::new(),
    }
}

fn sampled(columns: usize, rows: usize, kind: Interpolation, f: impl Fn(f64, f64) -> f64) -> GridField {
    let at = |k: usize, count: usize| k as f64 / (count - 1) as f64;
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (at(i, columns), at(j, rows))));
    GridField::new(columns, places.map(|(s, t)| f(s, t)).collect(), kind).unwrap()
}

fn make(map: &BasedMap, tolerance: f64) -> Tessellation {
    let made = based_map(map, &detail(tolerance), tolerance).unwrap();
    let bound = made.deviation.bound;
    assert!(map.heights.bound == HeightBound::Dense || bound <= tolerance, "{bound} > {tolerance}");
    made
}

fn point(mesh: &Mesh, corner: VertexIndex) -> DVec3 {
    mesh.points[mesh.vertices[corner.subscript()].point.subscript()]
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|at| point(mesh, at)));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Each side of a triangle once in both directions, by points.
fn is_closed(mesh: &Mesh) -> bool {
    let mut seen = BTreeSet::new();
    let mut sides = mesh.triangles.iter().flat_map(|triangle| {
        let [a, b, c] = triangle.map(|at| mesh.vertices[at.subscript()].point.0);
        [[a, b], [b, c], [c, a]]
    });
    sides.all(|side| side[0] != side[1] && seen.insert(side))
        && seen.iter().all(|[a, b]| seen.contains(&[*b, *a]))
}

const WHOLE: Chart = Chart::Spherical { longitude: [-180.0, 180.0], latitude: [90.0, -90.0] };

fn sphere(radius: f64) -> Base {
    Base::Ellipsoid { radii: DVec3::splat(radius), chart: WHOLE }
}

fn cylinder(radius: f64, height: f64) -> Base {
    let rise = [height / 2.0, -height / 2.0];
    Base::Cylinder { radius, chart: Chart::Cylindrical { longitude: [-180.0, 180.0], rise } }
}

/// Hills on a sphere that go around and are even at the poles.
fn hills(s: f64, t: f64) -> f64 {
    let (sin, cos) = sin_cos_degrees(360.0 * s);
    let wide = sin_degrees(180.0 * t);
    0.1 * wide * wide * noise(3.0, 5.3 + 3.0 * wide * sin, 7.1 + 3.0 * wide * cos + 2.0 * t)
}

/// The greatest distance of points of the upper skin from the exact skin at the same parameters, or at a pole at the nearest.
fn deviation(map: &BasedMap, mesh: &Mesh) -> f64 {
    const STEPS: u32 = 6;
    let mut worst = 0.0_f64;
    let [_, bottom] = map.heights.field.extent();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|at| mesh.vertices[at.subscript()].anchor);
        if corners.iter().any(|anchor| anchor.source != 0) {
            continue;
        }
        let points = triangle.map(|at| point(mesh, at));
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let weights = [i, j, STEPS - i - j].map(|k| f64::from(k) / f64::from(STEPS));
                let at: DVec3 = (0..3).map(|k| points[k] * weights[k]).sum();
                let place = |of: [f64; 3]| (0..3).map(|k| of[k] * weights[k]).sum::<f64>();
                let mut step = [place(corners.map(|a| a.u)), place(corners.map(|a| a.v))];
                // In a fan the columns of the pole are those of the side it looks at.
                if let Some(k) = (0..3).find(|k| corners[*k].v == 0.0 || corners[*k].v == bottom) {
                    let rest = 1.0 - weights[k];
                    let closes = map.base.closes();
                    let pole = if corners[k].v == 0.0 { closes.first } else { closes.last };
                    if pole && rest > 0.0 {
                        step[0] = (0..3).filter(|m| *m != k).map(|m| corners[m].u * weights[m] / rest).sum();
                    }
                }
                worst = worst.max(map.jet(Layer::Top, step).point.distance(at));
            }
        }
    }
    worst
}

#[test]
fn a_planet_is_closed_and_within_its_tolerance() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        for tolerance in [0.03, 0.004, 0.0007] {
            let field = sampled(48, 25, kind, |s, t| hills(s * 47.0 / 48.0, t));
            let map = BasedMap::new(sphere(1.0), heights(field, Closing::None));
            assert_eq!(map.heights.field.columns(), 49, "the first column follows the last");
            let made = make(&map, tolerance);
            assert!(is_closed(&made.mesh), "{kind:?} {tolerance}");
            let found = deviation(&map, &made.mesh);
            assert!(found <= made.deviation.bound * (1.0 + 1e-9), "{found} {}", made.deviation.bound);
            assert!(found > tolerance / 8.0, "far more triangles than are needed");
            for vertex in &made.mesh.vertices {
                let at = made.mesh.points[vertex.point.subscript()];
                assert!(vertex.normal.dot(at.normalize()) > 0.2, "looks outward");
                assert!((vertex.normal.length() - 1.0).abs() < 1e-12);
            }
            let poles: BTreeSet<u32> = made
                .mesh
                .vertices
                .iter()
                .filter(|vertex| vertex.anchor.v == 0.0)
                .map(|vertex| vertex.point.0)
                .collect();
            assert_eq!(poles.len(), 1, "a pole is one point");
        }
    }
}

#[test]
fn even_heights_have_volumes_of_closed_forms() {
    let flat = |height: f64| sampled(5, 4, Interpolation::Bilinear, |_, _| height);
    let tolerance = 1e-4;
    let ball = |r: f64| 4.0 / 3.0 * PI * r * r * r;
    let check = |base: Base, close: Closing, exact: f64, area: f64| {
        let made = make(&BasedMap::new(base, heights(flat(0.25), close)), tolerance);
        assert!(is_closed(&made.mesh), "{close:?}");
        let found = volume(&made.mesh);
        assert!((found - exact).abs() <= tolerance * area, "{close:?}: {found} {exact}");
    };
    let area = 4.0 * PI * 1.25 * 1.25;
    check(sphere(1.0), Closing::None, ball(1.25), area);
    check(sphere(1.0), Closing::Base(0.0), ball(1.25) - ball(1.0), 2.0 * area);
    check(sphere(1.0), Closing::Thickness(0.5), ball(1.25) - ball(0.75), 2.0 * area);
    let tube = |r: f64| PI * r * r * 2.0;
    let side = 2.0 * PI * 1.25 * 3.0;
    check(cylinder(1.0, 2.0), Closing::Ends, tube(1.25), side);
    check(cylinder(1.0, 2.0), Closing::Base(0.0), tube(1.25) - tube(1.0), 2.0 * side);
    check(cylinder(1.0, 2.0), Closing::Thickness(0.125), tube(1.25) - tube(1.125), 2.0 * side);
    // A quarter of a sphere: an eighth of the turn on both sides, from 60 degrees to the pole.
    let part = Chart::Spherical { longitude: [-45.0, 45.0], latitude: [90.0, 30.0] };
    let exact = (ball(1.25) - ball(1.0)) / 4.0 * (1.0 - 0.5) / 2.0;
    check(Base::Ellipsoid { radii: DVec3::ONE, chart: part }, Closing::Base(0.0), exact, area);
    let part = Chart::Cylindrical { longitude: [-45.0, 45.0], rise: [0.5, -0.5] };
    // Between y = -1/2 and 1/2 along true normals: the zone's share of both spheres is a half.
    let exact = (ball(1.25) - ball(1.0)) / 8.0;
    check(Base::Ellipsoid { radii: DVec3::ONE, chart: part }, Closing::Base(0.0), exact, area);
    let exact = PI * (1.25 * 1.25 - 1.0) / 4.0;
    check(Base::Cylinder { radius: 1.0, chart: part }, Closing::Base(0.0), exact, side);
    let sixth = Chart::Parallel { size: DVec2::new(1.0, 1.0) };
    let exact = PI * (1.25 * 1.25 - 1.0) / 6.0;
    check(Base::Cylinder { radius: 1.0, chart: sixth }, Closing::Base(0.0), exact, side);
}

/// The volume between a surface and the skin over it is the integral of h + H h^2 (with its sign) + K h^3 / 3.
#[test]
fn heights_on_ellipsoids_stand_along_true_normals() {
    let radii = DVec3::new(1.0, 0.7, 1.2);
    let height = 0.15;
    let field = sampled(9, 7, Interpolation::Bicubic, |_, _| height);
    let base = Base::Ellipsoid { radii, chart: WHOLE };
    let map = BasedMap::new(base, heights(field, Closing::None));
    let made = make(&map, 2e-4);
    for point in &made.mesh.points {
        // The foot on the ellipsoid: from the point back along the normal there.
        let mut foot = *point / (1.0 + height);
        for _ in 0..200 {
            let normal = (foot / (radii * radii)).normalize();
            let next = *point - normal * height;
            foot += (next - foot) * 0.5;
        }
        assert!(((foot / radii).length() - 1.0).abs() < 1e-9);
    }
    assert!(is_closed(&made.mesh));
}

#[test]
fn masks_cross_seams_and_poles() {
    let ground = || sampled(32, 17, Interpolation::Bilinear, |s, t| 0.05 + 0.5 * hills(s, t));
    // How far from an axis that leans: its caps hold a pole, cross the seam, or both.
    let axes = [DVec3::Y, DVec3::new(0.3, 1.0, -0.2), DVec3::new(0.1, 0.0, -1.0), DVec3::new(0.7, -1.0, 0.3)];
    let mut covered = Vec::new();
    for axis in axes {
        let axis = axis.normalize();
        let toward = Arc::new(sampled(97, 49, Interpolation::Bilinear, |s, t| {
            let (sin, cos) = sin_cos_degrees(360.0 * s - 180.0);
            let (rise, wide) = (cos_degrees(180.0 * t), sin_degrees(180.0 * t));
            DVec3::new(wide * sin, rise, wide * cos).dot(axis)
        }));
        for side in [MaskSide::AtLeast, MaskSide::AtMost] {
            let mask = Mask { field: toward.clone(), threshold: 0.6, side };
            let mut shape = heights(ground(), Closing::Base(0.0));
            shape.masks = vec![mask];
            let map = BasedMap::new(sphere(1.0), shape.clone());
            let body = make(&map, 0.004);
            assert!(is_closed(&body.mesh), "{axis} {side:?}");
            shape.close = Closing::None;
            let open = make(&BasedMap::new(sphere(1.0), shape), 0.004).mesh;
            let area: f64 = open
                .triangles
                .iter()
                .map(|triangle| triangle.map(|at| point(&open, at).normalize()))
                .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
                .sum();
            covered.push(area);
        }
    }
    // Caps of 0.4 of the half sphere's height; triangles inside of the unit sphere lose a little.
    for pair in covered.chunks(2) {
        assert!((pair[0] - 0.8 * PI).abs() < 0.03, "{covered:?}");
        assert!((pair[1] - 3.2 * PI).abs() < 0.12, "{covered:?}");
    }
}

#[test]
fn holes_without_values_are_closed_around() {
    let mut unknown = vec![false; 24 * 13];
    // At the seam, at a pole's row, in the middle.
    [0, 23, 5 * 24, 5 * 24 + 23, 24 + 11, 6 * 24 + 12].iter().for_each(|at| unknown[*at] = true);
    let values = sampled(24, 13, Interpolation::Bilinear, hills).samples().to_vec();
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let field = GridField::with_gaps(24, values.clone(), unknown.clone(), kind).unwrap();
        for bound in [HeightBound::Surface, HeightBound::Samples] {
            let shape = HeightMap { bound, ..heights(field.clone(), Closing::Thickness(0.1)) };
            let map = BasedMap::new(sphere(1.0), shape);
            let made = based_map(&map, &detail(0.01), 0.01).unwrap();
            assert!(is_closed(&made.mesh), "{kind:?} {bound:?}");
        }
    }
}

fn surface(surface: BaseSurface) -> Base {
    Base::Surface(Box::new(SurfaceBase::new(surface, DAffine3::IDENTITY, None, None).unwrap()))
}

fn torus(outer: f64, tube: f64) -> Base {
    let profile =
        EllipseArc { center: DVec3::X * outer, x: DVec3::X * tube, y: DVec3::Y * tube, from: 0.0, to: 360.0 };
    surface(BaseSurface::Turned(RevolvedSurface {
        profile: AnyCurve::Ellipse(profile),
        start: 0.0,
        angle: 360.0,
    }))
}

#[test]
fn a_torus_closes_both_ways() {
    for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let even = sampled(7, 6, kind, |_, _| 0.1);
        let map = BasedMap::new(torus(1.0, 0.3), heights(even, Closing::None));
        let made = make(&map, 5e-4);
        assert!(is_closed(&made.mesh));
        let exact = 2.0 * PI * PI * 0.4 * 0.4;
        assert!((volume(&made.mesh) - exact).abs() < 5e-4 * 4.0 * PI * PI * 0.4);
        let rough = sampled(40, 24, kind, |s, t| 0.05 * sin_degrees(1800.0 * s) * cos_degrees(1080.0 * t));
        let map = BasedMap::new(torus(1.0, 0.3), heights(rough, Closing::Thickness(0.05)));
        let made = make(&map, 2e-3);
        assert!(is_closed(&made.mesh));
        assert!(deviation(&map, &made.mesh) <= made.deviation.bound);
    }
}

#[test]
fn profiles_that_run_down_look_outward_too() {
    for points in [[0.0, 1.0], [1.0, 0.0]] {
        let line = points.map(|y| DVec3::new(0.5, y, 0.0)).to_vec();
        let profile = AnyCurve::Polyline(Polyline::new(line, false).unwrap());
        let base = surface(BaseSurface::Turned(RevolvedSurface { profile, start: 0.0, angle: 360.0 }));
        let even = sampled(9, 3, Interpolation::Bilinear, |_, _| 0.1);
        let made = make(&BasedMap::new(base, heights(even, Closing::Base(0.0))), 1e-3);
        assert!(is_closed(&made.mesh));
        let exact = PI * (0.36 - 0.25);
        assert!((volume(&made.mesh) - exact).abs() < 1e-2, "{} {exact}", volume(&made.mesh));
    }
}

#[test]
fn what_runs_through_itself_is_refused_with_the_place() {
    let even = |height: f64| heights(sampled(5, 4, Interpolation::Bilinear, |_, _| height), Closing::None);
    let refused =
        |base: Base, shape: HeightMap| match based_map(&BasedMap::new(base, shape), &detail(0.01), 0.01) {
            Err(TessellateError::CrossesItself { place }) => place,
            other => panic!("{other:?}"),
        };
    refused(sphere(1.0), even(-1.0));
    refused(cylinder(1.0, 1.0), even(-1.25));
    // A long ellipsoid is curved most at its tips: with the radius 0.5^2 / 2.
    let slim = Base::Ellipsoid { radii: DVec3::new(2.0, 0.5, 0.5), chart: WHOLE };
    refused(slim.clone(), even(-0.13));
    based_map(&BasedMap::new(slim, even(-0.12)), &detail(0.01), 0.01).unwrap();
    // Normals of a torus meet in the middle of its tube, and reach over its hole.
    refused(torus(1.0, 0.3), even(-0.31));
    let place = refused(torus(1.0, 0.3), even(0.72));
    assert!(place.with_y(0.0).length() < 0.1, "{place}");
    // A wall that comes back: heights from one side reach the other, 0.2 apart, at its open ends.
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.0, 0.2)];
    let outline = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let arms = [&outline[0..2], &outline[2..4]];
    let straight = arms.map(|arm| AnyCurve::Polyline(Polyline::new(arm.to_vec(), false).unwrap()));
    let bow = EllipseArc {
        center: DVec3::new(1.0, 0.1, 0.0),
        x: DVec3::NEG_Y * 0.1,
        y: DVec3::X * 0.1,
        from: 0.0,
        to: 180.0,
    };
    let [there, back] = straight;
    let path = crate::geometry::curve::Path::new(vec![there, AnyCurve::Ellipse(bow), back]);
    let profile = AnyCurve::Path(path.unwrap());
    let wall = |profile: AnyCurve| {
        surface(BaseSurface::Pushed(ExtrudedSurface { profile, bottom: 0.0, height: 0.5 }))
    };
    let bump = |depth: f64| {
        let field = sampled(65, 9, Interpolation::Bicubic, |s, _| if s < 0.3 { -depth } else { 0.0 });
        heights(field, Closing::None)
    };
    let base = wall(profile);
    refused(base.clone(), bump(0.25));
    based_map(&BasedMap::new(base, bump(0.05)), &detail(0.01), 0.01).unwrap();
}

#[test]
fn surfaces_with_edges_and_twists_are_no_bases() {
    let corners = [(0.5, 0.0), (0.5, 1.0), (0.2, 1.5)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let profile = AnyCurve::Polyline(Polyline::new(corners, false).unwrap());
    let turned =
        |profile: AnyCurve| BaseSurface::Turned(RevolvedSurface { profile, start: 0.0, angle: 360.0 });
    let edged = SurfaceBase::new(turned(profile.clone()), DAffine3::IDENTITY, None, None);
    assert!(matches!(edged, Err(BaseFault::Edge { along_v: false, .. })), "{edged:?}");
    // On one side of the edge it is smooth.
    let [_, v] = SurfaceBase::domains(&turned(profile.clone()));
    let part = Some([v[0], v[0] + 0.5 * (v[1] - v[0])]);
    SurfaceBase::new(turned(profile), DAffine3::IDENTITY, None, part).unwrap();
}

#[test]
fn dense_maps_keep_every_sample() {
    let shape = HeightMap {
        bound: HeightBound::Dense,
        ..heights(sampled(21, 13, Interpolation::Bilinear, hills), Closing::None)
    };
    let map = BasedMap::new(sphere(1.0), shape);
    let made = make(&map, 0.001);
    assert!(is_closed(&made.mesh));
    let columns = map.heights.field.columns();
    // Two rows are points: their cells are single triangles.
    assert_eq!(made.mesh.triangles.len(), 2 * (columns - 1) * 12 - 2 * (columns - 1));
    assert!(deviation(&map, &made.mesh) <= made.deviation.bound);
}

#[test]
fn a_tolerance_as_large_as_the_base_leaves_a_body() {
    for tolerance in [0.5, 10.0] {
        for base in [sphere(1.0), cylinder(1.0, 1.0), torus(1.0, 0.3)] {
            for close in [Closing::None, Closing::Thickness(0.1)] {
                let even = sampled(3, 3, Interpolation::Bilinear, |_, _| 0.1);
                let map = BasedMap::new(base.clone(), heights(even, close));
                let made = based_map(&map, &detail(tolerance), tolerance).unwrap();
                let open = close == Closing::None && matches!(map.base, Base::Cylinder { .. });
                assert!(open || is_closed(&made.mesh));
                assert!(made.mesh.triangles.len() > 8);
            }
        }
    }
}

//! Laws of surfaces through curves.

use glam::DVec3;

use super::{CoonsBlend, CoonsError, CoonsSide, CoonsSides, GordonBlend, GordonError, Twist, coons, gordon};
use crate::geometry::curve::{AnyCurve, BezierSpline, Curve, EllipseArc, Helix, Polyline, Side};
use crate::geometry::surface::{AnySurface, Surface};

fn bezier(points: &[[f64; 3]]) -> AnyCurve {
    let degree = points.len() - 1;
    let points = points.iter().map(|point| DVec3::from_array(*point)).collect();
    AnyCurve::Bezier(BezierSpline::new(degree, points).unwrap())
}

fn plain(curve: AnyCurve) -> CoonsSide {
    CoonsSide { curve, cross: None }
}

/// Around the patch: bottom, right, top and left, two of them backwards.
fn four() -> Vec<CoonsSide> {
    vec![
        plain(bezier(&[[0.0, 0.0, 0.0], [1.0, 0.0, 2.0], [2.0, 0.0, -1.0], [3.0, 0.0, 0.0]])),
        plain(bezier(&[[3.0, 0.0, 0.0], [4.0, 1.0, 0.0], [3.0, 2.0, -1.0], [3.0, 3.0, 0.0]])),
        plain(bezier(&[[0.0, 3.0, 1.0], [1.0, 3.0, 0.0], [2.0, 4.0, 2.0], [3.0, 3.0, 0.0]])),
        plain(bezier(&[[0.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, 3.0, 1.0]])),
    ]
}

/// A quarter of a helix, a polyline, an arc and a line.
fn mixed() -> Vec<CoonsSide> {
    let helix = AnyCurve::Helix(Helix { radius: 1.0, end_radius: 1.0, pitch: 1.0, turns: 0.25 });
    let end = helix.point(0.25);
    let far = DVec3::new(-1.5, 0.5, -1.5);
    let corner = DVec3::new(-1.0, 0.7, -1.2);
    let polyline = AnyCurve::Polyline(Polyline::new(vec![end, corner, far], false).unwrap());
    let last = DVec3::new(0.5, 0.0, 1.5);
    let arc = AnyCurve::Ellipse(EllipseArc::through(far, DVec3::new(-2.0, 0.2, 0.5), last).unwrap());
    let line = AnyCurve::Polyline(Polyline::new(vec![last, helix.point(0.0)], false).unwrap());
    [helix, polyline, arc, line].map(plain).to_vec()
}

fn three() -> Vec<CoonsSide> {
    let octant = [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)];
    octant
        .map(|(from, to)| {
            let arc = EllipseArc { center: DVec3::ZERO, x: from, y: to, from: 0.0, to: 90.0 };
            plain(AnyCurve::Ellipse(arc))
        })
        .to_vec()
}

fn two() -> Vec<CoonsSide> {
    vec![
        plain(bezier(&[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 0.0, 0.0]])),
        plain(bezier(&[[0.0, 0.0, 0.0], [1.0, -1.0, 1.0], [2.0, 0.0, 0.0]])),
    ]
}

fn one() -> Vec<CoonsSide> {
    vec![plain(AnyCurve::Ellipse(EllipseArc::full(DVec3::Y, 2.0, 1.0)))]
}

/// Derivatives across the sides that are tangents of their neighbours at the ends and go their own way between,
/// so that the twists disagree.
fn crossed() -> Vec<CoonsSide> {
    let mut sides = four();
    let tangent = |side: &CoonsSide, end: f64| {
        let place = if end == 0.0 { Side::After } else { Side::Before };
        side.curve.evaluate(end, place).first
    };
    let across = |start: DVec3, end: DVec3, bow: [f64; 3]| {
        let bow = DVec3::from_array(bow);
        let points = vec![start, start + bow, end + bow * 0.3, end];
        Some(AnyCurve::Bezier(BezierSpline::new(3, points).unwrap()))
    };
    let (bottom, right, top, left) = (&sides[0], &sides[1], &sides[2], &sides[3]);
    // Into the patch: at the right and the top against the parameter.
    let crosses = [
        across(tangent(left, 0.0), tangent(right, 0.0), [0.0, 1.0, 3.0]),
        across(-tangent(bottom, 1.0), -tangent(top, 1.0), [1.0, 0.0, 2.0]),
        across(-tangent(left, 1.0), -tangent(right, 1.0), [0.5, 0.0, -2.0]),
        across(tangent(bottom, 0.0), tangent(top, 0.0), [0.0, 2.0, 1.0]),
    ];
    for (side, cross) in sides.iter_mut().zip(crosses) {
        side.cross = cross;
    }
    sides
}

fn network(count: u32) -> (Vec<AnyCurve>, Vec<AnyCurve>) {
    // Places of z = x y (x + 2 y) / 4, cubic along both, so that cubics are its lines; run at their own pace.
    let place = |x: f64, y: f64| [x, y, x * y * (x + 2.0 * y) / 4.0];
    let at = |k: u32| 3.0 * f64::from(k) / f64::from(count - 1);
    let line = |f: &dyn Fn(f64) -> [f64; 3]| {
        let samples: Vec<DVec3> = (0..4).map(|k| DVec3::from_array(f(f64::from(k)))).collect();
        let [a, b, c, d] = [samples[0], samples[1], samples[2], samples[3]];
        let p = (a * -5.0 + b * 18.0 - c * 9.0 + d * 2.0) / 6.0;
        let q = (a * 2.0 - b * 9.0 + c * 18.0 - d * 5.0) / 6.0;
        AnyCurve::Bezier(BezierSpline::new(3, vec![a, p, q, d]).unwrap())
    };
    let along_u = (0..count).map(|k| line(&|x| place(x, at(k)))).collect();
    let along_v = (0..count).map(|k| line(&|y| place(at(k), y))).collect();
    (along_u, along_v)
}

fn rings() -> (Vec<AnyCurve>, Vec<AnyCurve>) {
    let ring = |y: f64, radius: f64| {
        let arc = EllipseArc {
            center: DVec3::Y * y,
            x: DVec3::X * radius,
            y: DVec3::NEG_Z * radius,
            from: 30.0 * y,
            to: 360.0 + 30.0 * y,
        };
        AnyCurve::Ellipse(arc)
    };
    let along_u = vec![ring(0.0, 1.0), ring(1.0, 1.5), ring(2.0, 0.8)];
    let rib = |angle: f64| {
        let (sin, cos) = crate::geometry::number::sin_cos_degrees(angle);
        let at = |y: f64, radius: f64| DVec3::new(radius * cos, y, -radius * sin);
        let points = [at(0.0, 1.0), at(1.0, 1.5), at(2.0, 0.8)];
        AnyCurve::Bezier(crate::geometry::curve::interpolate(&points, &[0.0, 1.0, 2.0]).unwrap())
    };
    (along_u, [0.0, 70.0, 150.0, 260.0].map(rib).to_vec())
}

fn made(sides: Vec<CoonsSide>, blend: CoonsBlend, twist: Twist) -> AnySurface {
    coons(CoonsSides::Around(sides), blend, twist).unwrap()
}

fn all() -> Vec<(&'static str, AnySurface)> {
    let given = [DVec3::X, DVec3::new(-1.0, 2.0, 0.0), DVec3::Z, DVec3::ONE];
    let drop = [
        DVec3::new(6.0, 0.0, 9.0),
        DVec3::new(0.0, -6.0, -9.0),
        DVec3::new(-6.0, 0.0, 9.0),
        DVec3::new(0.0, 6.0, -9.0),
    ];
    let gordon_of = |(u, v): (Vec<AnyCurve>, Vec<AnyCurve>), blend| {
        AnySurface::Transfinite(Box::new(gordon(&u, &v, blend).unwrap()))
    };
    let strip = || [four().remove(0), four().remove(2)];
    let mut strip_crossed = [crossed().remove(0), crossed().remove(2)];
    strip_crossed[1].cross = None;
    vec![
        ("four", made(four(), CoonsBlend::Bilinear, Twist::Zero)),
        ("four cubic", made(four(), CoonsBlend::Bicubic, Twist::Zero)),
        ("four adini", made(four(), CoonsBlend::Bicubic, Twist::Adini)),
        ("four flat", made(four(), CoonsBlend::Bicubic, Twist::Bilinear)),
        ("four given", made(four(), CoonsBlend::Bicubic, Twist::Given(given))),
        ("crossed", made(crossed(), CoonsBlend::Bicubic, Twist::Zero)),
        ("mixed", made(mixed(), CoonsBlend::Bilinear, Twist::Zero)),
        ("mixed cubic", made(mixed(), CoonsBlend::Bicubic, Twist::Adini)),
        ("three", made(three(), CoonsBlend::Bilinear, Twist::Zero)),
        ("three cubic", made(three(), CoonsBlend::Bicubic, Twist::Zero)),
        ("two", made(two(), CoonsBlend::Bilinear, Twist::Zero)),
        ("two cubic", made(two(), CoonsBlend::Bicubic, Twist::Adini)),
        ("one", made(one(), CoonsBlend::Bilinear, Twist::Zero)),
        ("one cubic", made(one(), CoonsBlend::Bicubic, Twist::Adini)),
        ("none", coons(CoonsSides::Point(DVec3::Y), CoonsBlend::Bicubic, Twist::Given(drop)).unwrap()),
        ("strip", coons(CoonsSides::Apart(Box::new(strip())), CoonsBlend::Bilinear, Twist::Zero).unwrap()),
        (
            "strip cubic",
            coons(CoonsSides::Apart(Box::new(strip_crossed)), CoonsBlend::Bicubic, Twist::Zero).unwrap(),
        ),
        ("network", gordon_of(network(4), GordonBlend::Spline)),
        ("network of hats", gordon_of(network(3), GordonBlend::Linear)),
        ("rings", gordon_of(rings(), GordonBlend::Spline)),
        ("rings of hats", gordon_of(rings(), GordonBlend::Linear)),
    ]
}

fn far_from(joints: &[f64], t: f64) -> bool {
    joints.iter().all(|joint| (joint - t).abs() > 2e-4)
}

/// Places inside, none near a joint.
fn places(surface: &AnySurface) -> Vec<(f64, f64)> {
    let (joints_u, joints_v) = (surface.joints_u(), surface.joints_v());
    let mut all = Vec::new();
    for a in 0..9 {
        for b in 0..9 {
            let (u, v) = ((f64::from(a) + 0.453) / 9.0, (f64::from(b) + 0.541) / 9.0);
            if far_from(&joints_u, u) && far_from(&joints_v, v) {
                all.push((u, v));
            }
        }
    }
    all
}

#[test]
fn derivatives_are_limits_of_differences() {
    let h = 1e-5;
    for (name, surface) in all() {
        for (u, v) in places(&surface) {
            let at = |u: f64, v: f64| surface.sided((u, Side::After), (v, Side::After));
            let here = at(u, v);
            let second = surface.second((u, Side::After), (v, Side::After));
            let by_u = |f: fn(&crate::geometry::surface::SurfaceJet) -> DVec3| {
                (f(&at(u + h, v)) - f(&at(u - h, v))) / (2.0 * h)
            };
            let by_v = |f: fn(&crate::geometry::surface::SurfaceJet) -> DVec3| {
                (f(&at(u, v + h)) - f(&at(u, v - h))) / (2.0 * h)
            };
            for (what, difference, derivative) in [
                ("du", by_u(|jet| jet.point), here.du),
                ("dv", by_v(|jet| jet.point), here.dv),
                ("uu", by_u(|jet| jet.du), second.uu),
                ("uv", by_v(|jet| jet.du), second.uv),
                ("vu", by_u(|jet| jet.dv), second.uv),
                ("vv", by_v(|jet| jet.dv), second.vv),
            ] {
                // Differences of numbers of this size lose about 1e-11 / 1e-5, smooth ones h squared.
                let off = difference.distance(derivative);
                assert!(off < 2e-6 * (1.0 + derivative.length()), "{name} {what} at {u} {v}: {off}");
            }
        }
    }
}

#[test]
fn second_derivatives_lie_in_their_boxes() {
    for (name, surface) in all() {
        let stops = |domain: crate::geometry::curve::Domain, joints: Vec<f64>| {
            let mut stops = vec![domain.start];
            stops.extend(joints);
            stops.extend([0.13, 0.5, 0.71].map(|part| domain.at(part)));
            stops.push(domain.end);
            stops.sort_by(f64::total_cmp);
            stops
        };
        let (us, vs) =
            (stops(surface.domain_u(), surface.joints_u()), stops(surface.domain_v(), surface.joints_v()));
        for u in us.windows(2) {
            for v in vs.windows(2) {
                if u[1] - u[0] < 1e-3 || v[1] - v[0] < 1e-3 {
                    continue;
                }
                let range = surface.second_range((u[0], u[1]), (v[0], v[1]));
                let range = range.unwrap_or_else(|| panic!("{name}: no bound on {u:?} {v:?}"));
                for a in 0..=6 {
                    for b in 0..=6 {
                        let side = |k: i32| if k == 6 { Side::Before } else { Side::After };
                        let at = |pair: &[f64], k: i32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / 6.0;
                        let second = surface.second((at(u, a), side(a)), (at(v, b), side(b)));
                        for (what, value, range) in [
                            ("uu", second.uu, range.uu),
                            ("uv", second.uv, range.uv),
                            ("vv", second.vv, range.vv),
                        ] {
                            let slack = DVec3::splat(1e-6);
                            let holds =
                                value.cmpge(range.min - slack).all() && value.cmple(range.max + slack).all();
                            assert!(holds, "{name} {what} {u:?} {v:?} at {a} {b}: {value} not in {range:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bounds_close_in_on_small_rectangles() {
    for (name, surface) in all() {
        for (u, v) in places(&surface) {
            let step = 1e-4;
            let range = surface.second_range((u, u + step), (v, v + step)).expect("known");
            let second = surface.second((u, Side::After), (v, Side::After));
            let size = 1.0 + second.uu.length() + second.uv.length() + second.vv.length();
            for range in [range.uu, range.uv, range.vv] {
                assert!(range.diagonal() < 0.1 * size, "{name} at {u} {v}: {range:?}");
            }
        }
    }
}

#[test]
fn sides_are_kept() {
    let rim = |surface: &AnySurface, side: usize, t: f64| match side {
        0 => surface.evaluate(t, 0.0),
        1 => surface.evaluate(1.0, t),
        2 => surface.evaluate(1.0 - t, 1.0),
        _ => surface.evaluate(0.0, 1.0 - t),
    };
    for sides in [four(), crossed(), mixed()] {
        for blend in [CoonsBlend::Bilinear, CoonsBlend::Bicubic] {
            let laid = super::ring(sides.iter().map(|side| side.curve.clone()).collect()).unwrap();
            let surface = made(sides.clone(), blend, Twist::Zero);
            for (side, curve) in laid.iter().enumerate() {
                for k in 0..=20 {
                    let t = f64::from(k) / 20.0;
                    let place = curve.domain().at(t);
                    let jet = curve.evaluate(place, if k == 20 { Side::Before } else { Side::After });
                    assert!(rim(&surface, side, t).point.distance(jet.point) < 1e-14);
                }
            }
        }
    }
}

#[test]
fn derivatives_across_sides_are_kept_though_twists_disagree() {
    let surface = made(crossed(), CoonsBlend::Bicubic, Twist::Zero);
    let sides = crossed();
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        let across = |side: usize| sides[side].cross.as_ref().unwrap().point(t);
        for (found, expected) in [
            (surface.evaluate(t, 0.0).dv, across(0)),
            (surface.evaluate(1.0, t).du, -across(1)),
            (surface.evaluate(t, 1.0).dv, -across(2)),
            (surface.evaluate(0.0, t).du, across(3)),
        ] {
            assert!(found.distance(expected) < 1e-12, "{t}: {found} for {expected}");
        }
    }
}

#[test]
fn a_bicubic_patch_of_its_own_sides_is_itself() {
    // The lines of a bicubic surface, its derivatives across them and its twists determine it (Farin 2002, 22.3).
    let control = |i: usize, j: usize| {
        let (x, y) = (i as f64, j as f64);
        DVec3::new(x + 0.1 * y * y, y - 0.2 * x * y, (x - 1.3) * (y * y - x) * 0.7)
    };
    let cubic =
        |f: &dyn Fn(usize) -> DVec3| AnyCurve::Bezier(BezierSpline::new(3, (0..4).map(f).collect()).unwrap());
    let sides = vec![
        CoonsSide {
            curve: cubic(&|i| control(i, 0)),
            cross: Some(cubic(&|i| (control(i, 1) - control(i, 0)) * 3.0)),
        },
        CoonsSide {
            curve: cubic(&|j| control(3, j)),
            cross: Some(cubic(&|j| (control(2, j) - control(3, j)) * 3.0)),
        },
        CoonsSide {
            curve: cubic(&|i| control(i, 3)),
            cross: Some(cubic(&|i| (control(i, 2) - control(i, 3)) * 3.0)),
        },
        CoonsSide {
            curve: cubic(&|j| control(0, j)),
            cross: Some(cubic(&|j| (control(1, j) - control(0, j)) * 3.0)),
        },
    ];
    let surface = made(sides, CoonsBlend::Bicubic, Twist::Zero);
    let bernstein =
        |k: usize, t: f64| (0..3).fold([1.0, 3.0, 3.0, 1.0][k], |b, j| b * if j < k { t } else { 1.0 - t });
    for (u, v) in places(&surface) {
        let mut expected = DVec3::ZERO;
        for i in 0..4 {
            for j in 0..4 {
                expected += control(i, j) * (bernstein(i, u) * bernstein(j, v));
            }
        }
        assert!(surface.evaluate(u, v).point.distance(expected) < 1e-13);
    }
}

#[test]
fn three_sides_are_alike() {
    let sides = three();
    let surface = made(sides.clone(), CoonsBlend::Bilinear, Twist::Zero);
    let turned =
        made(vec![sides[1].clone(), sides[2].clone(), sides[0].clone()], CoonsBlend::Bilinear, Twist::Zero);
    let place = |surface: &AnySurface, b: [f64; 3]| {
        let v = 1.0 - b[0];
        surface.evaluate(if v > 0.0 { b[2] / v } else { 0.5 }, v).point
    };
    for a in 0..=12 {
        for c in 0..=12 - a {
            let (a, c) = (f64::from(a) / 12.0, f64::from(c) / 12.0);
            let b = [1.0 - a - c, a, c];
            assert!(place(&surface, b).distance(place(&turned, [b[1], b[2], b[0]])) < 1e-14);
        }
    }
    let apart = super::ring(sides.iter().map(|side| side.curve.clone()).collect()).unwrap();
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        let at = |curve: &AnyCurve| curve.evaluate(t, if k == 20 { Side::Before } else { Side::After }).point;
        assert!(surface.evaluate(0.0, t).point.distance(at(&apart[0])) < 1e-14);
        assert!(surface.evaluate(t, 1.0).point.distance(at(&apart[1])) < 1e-14);
        assert!(surface.evaluate(1.0, 1.0 - t).point.distance(at(&apart[2])) < 1e-14);
    }
}

#[test]
fn a_network_holds_its_curves() {
    for (along_u, along_v) in [network(4), network(5), rings()] {
        for blend in [GordonBlend::Linear, GordonBlend::Spline] {
            let surface = gordon(&along_u, &along_v, blend).unwrap();
            let around = along_u[0].is_closed();
            let inside = |u: f64| if around { u - u.floor() } else { u.clamp(0.0, 1.0) };
            let near = |point: DVec3| {
                // The nearest place of a fine lattice, closed in on.
                let mut best = (f64::INFINITY, 0.0, 0.0);
                let mut look = |low: (f64, f64), high: (f64, f64)| {
                    for a in 0..=40 {
                        for b in 0..=40 {
                            let u = low.0 + (high.0 - low.0) * f64::from(a) / 40.0;
                            let v = low.1 + (high.1 - low.1) * f64::from(b) / 40.0;
                            let distance =
                                surface.evaluate(inside(u), v.clamp(0.0, 1.0)).point.distance(point);
                            if distance < best.0 {
                                best = (distance, u, v);
                            }
                        }
                    }
                    best
                };
                let mut found = look((0.0, 0.0), (1.0, 1.0));
                let mut reach = 1.0;
                for _ in 1..8 {
                    reach *= 0.05;
                    found = look((found.1 - reach, found.2 - reach), (found.1 + reach, found.2 + reach));
                }
                found.0
            };
            for curve in along_u.iter().chain(&along_v) {
                for k in [0.11, 0.47, 0.83] {
                    let distance = near(curve.point(curve.domain().at(k)));
                    assert!(distance < 1e-7, "{blend:?}: {distance}");
                }
            }
        }
    }
}

#[test]
fn a_network_of_straight_lines_is_the_surface_they_lie_on() {
    // z = x y, at paces of their own.
    let line = |from: [f64; 3], to: [f64; 3]| bezier(&[from, to]);
    let along_u: Vec<_> = [0.0, 1.0, 3.0].map(|y| line([0.0, y, 0.0], [2.0, y, 2.0 * y])).to_vec();
    let along_v: Vec<_> = [0.0, 0.7, 1.6, 2.0].map(|x| line([x, 0.0, 0.0], [x, 3.0, 3.0 * x])).to_vec();
    for blend in [GordonBlend::Linear, GordonBlend::Spline] {
        let surface = gordon(&along_u, &along_v, blend).unwrap();
        for k in 0..100 {
            let point = surface.evaluate(f64::from(k % 10) / 9.3, f64::from(k / 10) / 9.7).point;
            assert!((point.z - point.x * point.y).abs() < 1e-12);
        }
    }
}

#[test]
fn what_does_not_meet_is_refused() {
    let mut apart = four();
    apart[2] = plain(bezier(&[[0.0, 3.0, 1.5], [3.0, 3.0, 0.0]]));
    let error = coons(CoonsSides::Around(apart), CoonsBlend::Bilinear, Twist::Zero).unwrap_err();
    let CoonsError::Gap(gap) = error else { panic!("{error}") };
    assert_eq!((gap.first, gap.second, gap.distance), (2, 3, 0.5));
    let open = vec![plain(bezier(&[[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]]))];
    let error = coons(CoonsSides::Around(open), CoonsBlend::Bilinear, Twist::Zero).unwrap_err();
    assert_eq!(error, CoonsError::Open(5.0));
    let mut wrong = crossed();
    wrong[1].cross = wrong[0].cross.clone();
    let error = coons(CoonsSides::Around(wrong), CoonsBlend::Bicubic, Twist::Zero).unwrap_err();
    assert!(matches!(error, CoonsError::Cross { side: 1, .. }), "{error}");
    let error = coons(CoonsSides::Around(crossed()), CoonsBlend::Bicubic, Twist::Given([DVec3::ONE; 4]));
    assert!(matches!(error, Err(CoonsError::Twist { corner: 0, .. })), "{error:?}");

    let (along_u, mut along_v) = network(3);
    along_v.swap(0, 1);
    let error = gordon(&along_u, &along_v, GordonBlend::Spline).unwrap_err();
    assert!(matches!(error, GordonError::Order { index: 0, .. }), "{error}");
    let (along_u, mut along_v) = network(3);
    along_v[1] = bezier(&[[1.5, 0.0, 9.0], [1.5, 3.0, 9.0]]);
    let error = gordon(&along_u, &along_v, GordonBlend::Spline).unwrap_err();
    assert!(matches!(error, GordonError::Apart { u: 0, v: 1, distance } if distance > 1.0), "{error}");
    let error = gordon(&network(3).0[..1], &network(3).1, GordonBlend::Spline).unwrap_err();
    assert!(matches!(error, GordonError::Few { found: 1, .. }), "{error}");
}

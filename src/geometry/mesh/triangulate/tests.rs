//! Laws of triangulation: areas, counts and boundaries, on shapes that break simple ear cutting.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::{TriangulateError, triangulate, triangulate_anyway, triangulate_in_space};
use crate::geometry::planar::{crossing, turn, twice_area as ring_area};

type Ring = Vec<DVec2>;

fn ring(points: &[(f64, f64)]) -> Ring {
    points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
}

fn regular(corners: u32, radius: f64, center: DVec2) -> Ring {
    (0..corners)
        .map(|corner| {
            let (sin, cos) =
                crate::geometry::number::sin_cos_degrees(360.0 * f64::from(corner) / f64::from(corners));
            center + radius * DVec2::new(cos, sin)
        })
        .collect()
}

/// Triangulates and checks everything that is promised; returns the number of triangles that have area.
#[track_caller]
fn check(rings: &[Ring]) -> usize {
    let slices: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    let triangles = triangulate(&slices).expect("the polygon can be triangulated");
    let points: Vec<DVec2> = rings.iter().flatten().copied().collect();
    let area = check_edges(rings, &triangles);
    let sense = ring_area(&rings[0]).signum();
    let turns: Vec<f64> = triangles
        .iter()
        .map(|t| sense * turn(points[t[0] as usize], points[t[1] as usize], points[t[2] as usize]))
        .collect();
    assert!(turns.iter().all(|turn| *turn >= 0.0), "a triangle is turned over: {rings:?}");
    let total: f64 = turns.iter().sum();
    assert!((total - area).abs() <= 1e-12 * area.max(1e-300), "{total} against {area}: {rings:?}");
    turns.into_iter().filter(|turn| *turn > 0.0).count()
}

/// Every edge of the rings is the edge of one triangle, all others have two sides, and the number of triangles is
/// that of Euler; gives twice the area that the rings enclose.
#[track_caller]
fn check_edges(rings: &[Ring], triangles: &[[u32; 3]]) -> f64 {
    let corners: usize = rings.iter().map(Vec::len).sum();
    assert_eq!(triangles.len() + 2, corners + 2 * (rings.len() - 1), "{rings:?}");
    let sense = ring_area(&rings[0]).signum();
    let mut area = 0.0;
    let mut open: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    let mut use_edge = |from: u32, to: u32, count: i32| {
        *open.entry([from.min(to), from.max(to)]).or_default() += if from < to { count } else { -count };
    };
    for [a, b, c] in triangles {
        assert!(a != b && b != c && c != a, "a triangle names a corner twice");
        [(a, b), (b, c), (c, a)].into_iter().for_each(|(from, to)| use_edge(*from, *to, 1));
    }
    let mut start = 0;
    for (number, ring) in rings.iter().enumerate() {
        let len = u32::try_from(ring.len()).expect("small");
        let own = ring_area(ring);
        area += if number == 0 { own.abs() } else { -own.abs() };
        // Holes run against the outer ring, whichever way they are written.
        let turned = if number > 0 && own.signum() == sense { -1 } else { 1 };
        for corner in 0..len {
            use_edge(start + corner, start + (corner + 1) % len, -turned);
        }
        start += len;
    }
    let loose: Vec<_> = open.iter().filter(|(_, uses)| **uses != 0).collect();
    assert!(loose.is_empty(), "edges without a partner: {loose:?} in {rings:?}, {triangles:?}");
    area
}

#[test]
fn regular_polygons() {
    for corners in 3..60 {
        assert_eq!(check(&[regular(corners, 2.5, DVec2::new(1.0, -3.0))]), corners as usize - 2);
    }
}

#[test]
fn turning_the_outer_ring_turns_the_triangles() {
    let mut star = Vec::new();
    for (outer, inner) in regular(7, 2.0, DVec2::ZERO).into_iter().zip(regular(7, 0.5, DVec2::ZERO)) {
        star.extend([outer, inner]);
    }
    assert_eq!(check(&[star.clone()]), 12);
    star.reverse();
    assert_eq!(check(&[star]), 12);
}

#[test]
fn collinear_points_stay_connected() {
    for extra in 1..9 {
        let mut square = Vec::new();
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            square.extend((0..extra).map(|step| from.lerp(to, f64::from(step) / f64::from(extra))));
        }
        let count = square.len();
        assert_eq!(check(&[square]), count - 2, "{extra} pieces a side");
    }
    // The same on a side that is not along an axis, where rounding moves points off the line.
    let mut side: Ring = (0..=10)
        .map(|step| DVec2::new(0.1, 0.3).lerp(DVec2::new(2.3, 1.7), f64::from(step) / 10.0))
        .collect();
    side.push(DVec2::new(0.0, 5.0));
    let count = side.len();
    assert_eq!(check(&[side]), count - 2);
}

#[test]
fn lines_of_collinear_points_through_the_inside() {
    // A comb: teeth whose feet stand on one line, so cutting them leaves collinear chains inside.
    let mut comb = ring(&[(0.0, 0.0), (0.0, -1.0), (20.0, -1.0), (20.0, 0.0)]);
    for tooth in (0..10).rev() {
        let x = 2.0 * f64::from(tooth);
        comb.extend([DVec2::new(x + 1.5, 0.0), DVec2::new(x + 1.0, 3.0), DVec2::new(x + 0.5, 0.0)]);
    }
    let count = comb.len();
    assert_eq!(check(&[comb]), count - 2);
}

#[test]
fn holes_either_way() {
    let outer = ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]);
    let mut rings = vec![outer];
    for x in 0..4 {
        for y in 0..4 {
            let mut hole =
                regular(5 + x, 0.8, DVec2::new(1.5 + 2.3 * f64::from(x), 1.5 + 2.3 * f64::from(y)));
            if (x + y) % 2 == 0 {
                hole.reverse();
            }
            rings.push(hole);
        }
    }
    let corners: usize = rings.iter().map(Vec::len).sum();
    assert_eq!(check(&rings), corners + 2 * 16 - 2);
}

#[test]
fn holes_that_touch_at_a_corner() {
    let outer = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
    let at_corner = ring(&[(0.0, 0.0), (2.0, 1.0), (1.0, 2.0)]);
    assert_eq!(check(&[outer.clone(), at_corner]), 5);
    let left = ring(&[(1.0, 1.0), (2.0, 2.0), (1.0, 3.0)]);
    let right = ring(&[(2.0, 2.0), (3.0, 1.0), (3.0, 3.0)]);
    assert_eq!(check(&[outer, left, right]), 10);
}

#[test]
fn a_keyhole_polygon_is_its_hole() {
    let keyhole = ring(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 4.0),
        (0.0, 4.0),
        (0.0, 0.0),
        (1.0, 1.0),
        (1.0, 3.0),
        (3.0, 3.0),
        (3.0, 1.0),
        (1.0, 1.0),
    ]);
    assert_eq!(check(std::slice::from_ref(&keyhole)), 8);
    let triangles = triangulate(&[&keyhole]).expect("a keyhole can be cut");
    assert_eq!(triangles.len(), 8, "both sides of the cut have corners of their own");
}

#[test]
fn repeated_points_get_triangles_without_area() {
    let square = ring(&[
        (0.0, 0.0),
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 1.0),
        (1.0, 1.0),
        (1.0, 1.0),
        (0.0, 1.0),
        (0.0, 0.0),
    ]);
    assert_eq!(check(&[square]), 2);
}

#[test]
fn a_corner_on_an_edge_gets_a_triangle_without_area() {
    let outer = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
    // From inside, in the middle of an edge, and two of them on one edge.
    let touching = ring(&[(1.0, 0.0), (2.0, 1.0), (1.0, 1.0)]);
    assert_eq!(check(&[outer.clone(), touching.clone()]), 7 - 2 + 2 - 1);
    let other = ring(&[(3.0, 0.0), (3.5, 1.0), (3.0, 1.0)]);
    check(&[outer.clone(), touching.clone(), other]);
    // Two holes that touch the edge at one place.
    let same = ring(&[(1.0, 0.0), (0.5, 1.0), (0.25, 1.0)]);
    check(&[outer.clone(), touching, same]);
    // A hole with an edge on the outer edge.
    check(&[outer.clone(), ring(&[(1.0, 0.0), (2.0, 0.0), (2.0, 1.0)])]);
    // Touched from outside: the tip of an arm that comes back to an edge of its own ring.
    let hook = ring(&[
        (0.0, 0.0),
        (6.0, 0.0),
        (6.0, 4.0),
        (0.0, 4.0),
        (2.0, 1.0),
        (3.0, 3.0),
        (5.0, 3.0),
        (5.0, 1.0),
        (0.0, 1.0),
    ]);
    assert_eq!(check(&[hook]), 7);
}

#[test]
fn spikes_have_no_area() {
    // Out of the polygon and back, into it and back, with places on the way.
    let outward = ring(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (3.0, 3.0), (2.0, 2.0), (0.0, 2.0)]);
    assert_eq!(check(&[outward]), 2);
    let inward = ring(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 1.0), (2.0, 2.0), (0.0, 2.0)]);
    assert_eq!(check(&[inward]), 4);
    let long = ring(&[
        (0.0, 0.0),
        (2.0, 0.0),
        (2.0, 2.0),
        (3.0, 3.0),
        (4.0, 4.0),
        (3.0, 3.0),
        (2.0, 2.0),
        (0.0, 2.0),
    ]);
    assert_eq!(check(&[long]), 2);
}

#[test]
fn quads_are_cut_like_everywhere_else() {
    let convex = ring(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
    assert_eq!(triangulate(&[&convex]), Ok(vec![[0, 1, 2], [0, 2, 3]]));
    let concave_at_1 = ring(&[(0.0, 0.0), (1.0, 1.0), (4.0, 0.0), (1.0, 4.0)]);
    assert_eq!(triangulate(&[&concave_at_1]), Ok(vec![[0, 1, 3], [1, 2, 3]]));
    let clockwise: Ring = convex.into_iter().rev().collect();
    assert_eq!(triangulate(&[&clockwise]), Ok(vec![[0, 1, 2], [0, 2, 3]]));
}

#[test]
fn faults_are_named() {
    let error = |rings: &[Ring]| {
        triangulate(&rings.iter().map(Vec::as_slice).collect::<Vec<_>>()).expect_err("cannot be triangulated")
    };
    assert_eq!(error(&[]), TriangulateError::TooFewCorners { ring: 0, corners: 0 });
    assert_eq!(
        error(&[ring(&[(0.0, 0.0), (1.0, 0.0)])]),
        TriangulateError::TooFewCorners { ring: 0, corners: 2 }
    );
    let line = ring(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]);
    assert_eq!(error(std::slice::from_ref(&line)), TriangulateError::NoArea { ring: 0 });
    assert_eq!(
        error(&[ring(&[(0.0, 0.0), (f64::NAN, 0.0), (1.0, 1.0)])]),
        TriangulateError::NotFinite { corner: 1 }
    );
    let bow_tie = ring(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)]);
    assert_eq!(error(&[bow_tie]), TriangulateError::Crossing { edges: [0, 2] });
    let square = ring(&[(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)]);
    let away = ring(&[(20.0, 20.0), (21.0, 20.0), (20.0, 21.0)]);
    assert_eq!(error(&[square.clone(), away]), TriangulateError::Unsolved);
    let across = ring(&[(8.0, 4.0), (10.0, 4.0), (8.0, 5.0)]);
    assert_eq!(error(&[square, across]), TriangulateError::Crossing { edges: [1, 4] });
}

#[test]
fn any_size_of_number() {
    for scale in [1e-300, 1e-160, 1e-9, 1.0, 1e38, 1e150, 1e300] {
        let star: Ring = regular(11, scale, DVec2::ZERO)
            .into_iter()
            .enumerate()
            .map(|(k, p)| if k % 2 == 0 { p } else { p * 0.3 })
            .collect();
        assert_eq!(triangulate(&[&star]).map(|triangles| triangles.len()), Ok(9), "at {scale}");
    }
}

#[test]
fn in_space_on_every_side() {
    let outer = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.0, 1.0), (0.0, 3.0)];
    let hole = [(0.5, 0.5), (0.5, 0.8), (0.8, 0.5)];
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::ONE.normalize()];
    for axis in axes.into_iter().flat_map(|axis| [axis, -axis]) {
        let side = axis.any_orthonormal_vector();
        let place = |&(x, y): &(f64, f64)| side * x + axis.cross(side) * y + axis * 7.0;
        let rings: [Vec<DVec3>; 2] = [outer.iter().map(place).collect(), hole.iter().map(place).collect()];
        let points: Vec<DVec3> = rings.concat();
        let (triangles, exact) = triangulate_in_space(&[&rings[0], &rings[1]]).expect("a polygon");
        assert_eq!((triangles.len(), exact), (8, true));
        let area: DVec3 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|corner| points[corner as usize]);
                (b - a).cross(c - a)
            })
            .sum();
        assert!((area - axis * (2.0 * 6.0 - 0.09)).length() < 1e-12, "{area}");
    }
}

/// Every polygon with its corners on a 3 x 3 grid, five corners, all orders: refused if and only if it crosses
/// itself, touches itself or has no area; else right.
#[test]
fn all_small_pentagons() {
    let place = |cell: usize| {
        DVec2::new(
            f64::from(u32::try_from(cell % 3).expect("small")),
            f64::from(u32::try_from(cell / 3).expect("small")),
        )
    };
    let (mut cut, mut refused) = (0, 0);
    for code in 0..9_usize.pow(5) {
        let cells: Vec<usize> = (0..5)
            .scan(code, |rest, _| {
                let cell = *rest % 9;
                *rest /= 9;
                Some(cell)
            })
            .collect();
        if (0..5).any(|a| (0..a).any(|b| cells[a] == cells[b])) {
            continue;
        }
        let pentagon: Ring = cells.into_iter().map(place).collect();
        if is_simple(&pentagon) {
            assert_eq!(check(&[pentagon]), 3);
            cut += 1;
        } else {
            let result = triangulate(&[&pentagon]);
            let area = ring_area(&pentagon).abs();
            let points = &pentagon;
            refused += usize::from(result.is_err());
            if let Ok(triangles) = result {
                let total: f64 = triangles
                    .iter()
                    .map(|t| turn(points[t[0] as usize], points[t[1] as usize], points[t[2] as usize]).abs())
                    .sum();
                assert_eq!(total, area, "{points:?}");
            }
        }
    }
    assert!(cut > 1000 && refused > 1000, "{cut} cut, {refused} refused");
}

/// No edge touches another except neighbours at their common corner.
fn is_simple(ring: &Ring) -> bool {
    let on_segment = |p: DVec2, a: DVec2, b: DVec2| turn(a, b, p) == 0.0 && (p - a).dot(p - b) <= 0.0;
    let corners = ring.len();
    let clear = (0..corners).all(|corner| {
        (0..corners).all(|side| {
            let next = (side + 1) % corners;
            corner == side || corner == next || !on_segment(ring[corner], ring[side], ring[next])
        })
    });
    clear && crossing(&[ring]).is_none()
}

#[test]
fn bent_quads_keep_all_their_corners() {
    // Seen along any axis, this quadrilateral has corners that fall together or edges that cross.
    let bent = [DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)];
    let steep =
        [DVec3::ZERO, DVec3::new(0.01, 0.0, 0.6), DVec3::new(0.01, 0.02, 0.0), DVec3::new(0.0, 0.02, 0.6)];
    for quad in [bent, steep] {
        let (triangles, _) = triangulate_in_space(&[&quad]).expect("a quadrilateral");
        assert_eq!(triangles.len(), 2);
        assert!((0..4).all(|corner| triangles.iter().flatten().any(|&used| used == corner)));
    }
}

#[test]
fn corners_hidden_by_the_view_are_not_lost() {
    // The second and third corner differ only along the normal.
    let rings = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 0.0, 0.5), (4.0, 4.0, 0.0), (0.0, 4.0, 0.0)];
    let ring: Vec<DVec3> = rings.iter().map(|&(x, y, z)| DVec3::new(x, y, z)).collect();
    let (triangles, exact) = triangulate_in_space(&[&ring]).expect("a polygon");
    assert!(exact && triangles.len() == 3);
    assert!((0..5).all(|corner| triangles.iter().flatten().any(|&used| used == corner)));
}

/// Numbers below `most`, the same in every run.
fn random(state: &mut u64, most: u32) -> u32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    u32::try_from(*state >> 33).expect("31 bits") % most
}

/// Rings of any kind on small whole coordinates, where corners meet, repeat and lie on edges: number, edges and area
/// are always right, and where no edges cross no triangle is turned over.
#[test]
fn every_ring_gets_its_triangles() {
    let mut state = 5;
    let (mut exact, mut harmed) = (0, 0);
    for round in 0..60_000 {
        let most = 3 + round % 6;
        let ring: Ring = (0..3 + round % 11)
            .map(|_| DVec2::new(f64::from(random(&mut state, most)), f64::from(random(&mut state, most))))
            .collect();
        let (triangles, found) = triangulate_anyway(&[&ring]).expect("corners are many and finite");
        check_edges(std::slice::from_ref(&ring), &triangles);
        if found {
            check(std::slice::from_ref(&ring));
            exact += 1;
        } else {
            harmed += 1;
        }
    }
    assert!(exact > 10_000 && harmed > 10_000, "{exact} {harmed}");
}

/// Polygons grown corner by corner so that they never cross but often touch, with holes made the same way.
#[test]
fn touching_polygons_are_exact() {
    let mut state = 77;
    let mut solved = 0;
    for round in 0..4000 {
        let grown = |state: &mut u64, low: u32, size: u32, corners: u32| -> Option<Ring> {
            let place = |state: &mut u64| {
                DVec2::new(f64::from(low + random(state, size)), f64::from(low + random(state, size)))
            };
            let mut ring: Ring = (0..3).map(|_| place(state)).collect();
            for _ in 0..corners {
                let at = random(state, u32::try_from(ring.len()).expect("small")) as usize;
                let mut next = ring.clone();
                next.insert(at, place(state));
                if crossing(&[&next]).is_none() && ring_area(&next) != 0.0 {
                    ring = next;
                }
            }
            (ring_area(&ring) != 0.0 && crossing(&[&ring]).is_none()).then_some(ring)
        };
        let Some(outer) = grown(&mut state, 0, 9, 8 + round % 40) else { continue };
        let mut rings = vec![outer];
        for _ in 0..round % 3 {
            if let Some(hole) = grown(&mut state, 2, 5, 3) {
                rings.push(hole);
            }
        }
        let slices: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        let (triangles, found) = triangulate_anyway(&slices).expect("corners are many and finite");
        check_edges(&rings, &triangles);
        if found {
            check(&rings);
            solved += 1;
        }
    }
    // The others have holes outside of them, across them or in each other.
    assert!(solved > 500, "{solved}");
}

/// A polygon that crosses itself by a little loses no more than that.
#[test]
fn small_crossings_do_small_harm() {
    let mut state = 3;
    for depth in [1e-9, 1e-6, 1e-3] {
        for _ in 0..200 {
            // A star whose every fifth edge is pushed over its neighbour.
            let star: Ring = regular(40, 1.0, DVec2::ZERO)
                .into_iter()
                .enumerate()
                .map(|(k, p)| if k % 2 == 0 { p } else { p * 0.8 })
                .collect();
            let mut ring = star.clone();
            let at = random(&mut state, 40) as usize;
            // A corner is doubled and its twin pulled back along the edge before: a fold of the depth asked for.
            let back = (ring[(at + 39) % 40] - ring[at]).normalize();
            let across = back.perp();
            ring.insert(at, ring[at] + back * (10.0 * depth) + across * depth);
            ring.insert(at, star[at] + back * (5.0 * depth) - across * depth);
            let (triangles, _) = triangulate_anyway(&[&ring]).expect("corners are many and finite");
            check_edges(std::slice::from_ref(&ring), &triangles);
            for t in triangles {
                let [a, b, c] = t.map(|corner| ring[corner as usize]);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                assert!(turn(a, b, c) / longest >= -4.0 * depth, "{depth}: {a} {b} {c}");
            }
        }
    }
}

/// Corners on one circle, evenly or not, from any start and either way around: no sliver but those that the corners ask
/// for, nothing turned over, the whole area.
#[test]
fn round_polygons_are_cut_by_halves() {
    for count in [5_u32, 6, 7, 12, 33, 128] {
        for shift in [0.0, 0.37] {
            for turned in [1.0, -1.0] {
                let angle = |k: u32| {
                    let part = f64::from(k) / f64::from(count);
                    turned * 360.0 * (part + shift + 0.05 * part * (1.0 - part))
                };
                let ring: Vec<DVec2> = (0..count)
                    .map(|k| {
                        let (sin, cos) = crate::geometry::number::sin_cos_degrees(angle(k));
                        DVec2::new(3.0 + 2.0 * cos, -1.0 + 2.0 * sin)
                    })
                    .collect();
                let triangles = triangulate(&[&ring]).unwrap();
                assert_eq!(triangles.len(), count as usize - 2);
                let area = |[a, b, c]: [u32; 3]| {
                    (ring[b as usize] - ring[a as usize]).perp_dot(ring[c as usize] - ring[a as usize])
                };
                assert!(triangles.iter().all(|triangle| area(*triangle) * turned > 0.0));
                let sum: f64 = triangles.iter().map(|triangle| area(*triangle)).sum();
                assert!((sum - ring_area(&ring)).abs() < 1e-12 * sum.abs());
            }
        }
    }
}

/// A ring that runs twice around a circle is no polygon, however round.
#[test]
fn twice_around_a_circle_is_refused() {
    let ring: Vec<DVec2> = (0..9)
        .map(|k| {
            let (sin, cos) = crate::geometry::number::sin_cos_degrees(80.0 * f64::from(k) + 1.0);
            DVec2::new(cos, sin)
        })
        .collect();
    assert!(matches!(triangulate(&[&ring]), Err(TriangulateError::Crossing { .. })));
}

//! Known surfaces, and every orientation of a small one.

use super::surface::of_surface;
use super::{Topology, of_any, of_triangles};

fn measure(triangles: &[[u32; 3]]) -> Topology {
    let points = triangles.iter().flatten().max().map_or(0, |&point| point as usize + 1);
    of_triangles(triangles, points).expect("small")
}

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn shifted(triangles: &[[u32; 3]], by: u32) -> Vec<[u32; 3]> {
    triangles.iter().map(|triangle| triangle.map(|point| point + by)).collect()
}

/// A grid of `columns` x `rows` quads whose sides are joined: a torus.
fn torus(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let at = |column: u32, row: u32| row % rows * columns + column % columns;
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b, c, d] =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

#[test]
fn nothing() {
    let empty = measure(&[]);
    assert!(empty.closed && empty.components == 0 && empty.euler == 0);
}

#[test]
fn tetrahedron() {
    let found = measure(&TETRAHEDRON);
    assert!(found.closed && found.manifold);
    assert_eq!(
        (found.points, found.edges, found.euler, found.genus, found.components),
        (4, 6, 2, Some(0), 1)
    );
}

#[test]
fn platonic_solids() {
    let octahedron = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mut icosahedron = Vec::new();
    for k in 0..5_u32 {
        let (up, up_next, down, down_next) = (1 + k, 1 + (k + 1) % 5, 6 + k, 6 + (k + 1) % 5);
        icosahedron.extend([
            [0, up, up_next],
            [up, down, up_next],
            [up_next, down, down_next],
            [down, 11, down_next],
        ]);
    }
    for (solid, points, edges) in [(octahedron.to_vec(), 6, 12), (icosahedron, 12, 30)] {
        let found = measure(&solid);
        assert_eq!((found.points, found.edges, found.genus), (points, edges, Some(0)));
        assert!(found.closed && found.manifold);
    }
}

#[test]
fn tori_of_all_sizes() {
    for columns in 3..8 {
        for rows in 3..8 {
            let found = measure(&torus(columns, rows));
            assert!(found.closed && found.manifold, "{columns} x {rows}");
            assert_eq!((found.euler, found.genus, found.components), (0, Some(1), 1));
        }
    }
}

#[test]
fn parts_add_up() {
    let mut all = torus(5, 4);
    all.extend(shifted(&TETRAHEDRON, 20));
    all.extend(shifted(&torus(3, 3), 24));
    let found = measure(&all);
    assert_eq!((found.components, found.genus, found.euler), (3, Some(2), 2));
}

#[test]
fn open_surfaces_have_loops() {
    let found = measure(&TETRAHEDRON[..3]);
    assert!(!found.closed && found.genus.is_none());
    assert_eq!((found.boundary_edges, found.boundary_loops, found.euler), (3, 1, 1));

    // Two opposite quads away from a torus: the holes are apart.
    let mut holed = torus(6, 6);
    holed.drain(42..44);
    holed.drain(0..2);
    let found = measure(&holed);
    assert_eq!((found.boundary_edges, found.boundary_loops, found.euler), (8, 2, -2));

    // Two quads that share a corner: the corner has two fans, and taking them apart makes one hole of two.
    let mut touching = torus(6, 6);
    touching.drain(14..16);
    touching.drain(0..2);
    let found = measure(&touching);
    assert_eq!((found.boundary_edges, found.boundary_loops, found.extra_fans), (8, 1, 1));

    let two_triangles = measure(&[[0, 1, 2], [0, 3, 4]]);
    assert_eq!((two_triangles.boundary_loops, two_triangles.extra_fans, two_triangles.components), (2, 1, 2));
}

#[test]
fn moebius_band_has_one_edge_and_no_orientation() {
    let steps = 7_u32;
    let mut band = Vec::new();
    for k in 0..steps {
        let (a, b) = (2 * k, 2 * k + 1);
        let (c, d) = if k + 1 == steps { (1, 0) } else { (2 * k + 2, 2 * k + 3) };
        band.extend([[a, c, b], [b, c, d]]);
    }
    let found = measure(&band);
    assert!(!found.closed && !found.manifold);
    assert_eq!((found.euler, found.boundary_edges, found.components), (0, 14, 1));
    assert_eq!(found.misoriented_edges, 1);
}

#[test]
fn all_orientations_of_a_tetrahedron() {
    for flips in 0..16_u32 {
        let mut turned = TETRAHEDRON;
        for (face, triangle) in turned.iter_mut().enumerate() {
            if flips >> face & 1 == 1 {
                triangle.swap(1, 2);
            }
        }
        let found = measure(&turned);
        let alike = flips == 0 || flips == 15;
        assert_eq!((found.closed, found.manifold), (alike, alike), "flips {flips:04b}");
        let odd = flips.count_ones().min(4 - flips.count_ones());
        // One face against three shares three edges with them; two against two share four.
        assert_eq!(found.misoriented_edges, [0, 3, 4][odd as usize], "flips {flips:04b}");
        assert_eq!((found.boundary_edges, found.euler), (0, 2));
    }
}

#[test]
fn sharing_an_edge_is_closed_but_not_manifold() {
    // The second uses points 0 and 1 of the first.
    let mut pair = TETRAHEDRON.to_vec();
    pair.extend(TETRAHEDRON.map(|triangle| triangle.map(|point| if point < 2 { point } else { point + 2 })));
    let found = measure(&pair);
    assert!(found.closed && !found.manifold);
    assert_eq!((found.crowded_edges, found.components, found.genus), (1, 1, None));
}

#[test]
fn sharing_a_point_is_closed_but_not_manifold() {
    let mut pair = TETRAHEDRON.to_vec();
    pair.extend(TETRAHEDRON.map(|triangle| triangle.map(|point| if point == 0 { 0 } else { point + 3 })));
    let found = measure(&pair);
    assert!(found.closed && !found.manifold);
    assert_eq!((found.extra_fans, found.components, found.euler, found.crowded_edges), (1, 2, 3, 0));
}

#[test]
fn triangles_without_three_points_are_not_manifold() {
    let mut with_sliver = TETRAHEDRON.to_vec();
    with_sliver.push([0, 0, 1]);
    let found = measure(&with_sliver);
    assert!(found.closed && !found.manifold);
    assert_eq!((found.edges, found.triangles), (6, 5));
    let point = measure(&[[3, 3, 3]]);
    assert!(point.closed && !point.manifold);
    assert_eq!((point.points, point.edges), (1, 0));
}

#[test]
fn a_wheel_of_any_size_is_one_fan() {
    for spokes in [3, 10, 21, 500] {
        let wheel: Vec<[u32; 3]> = (0..spokes).map(|k| [0, 1 + k, 1 + (k + 1) % spokes]).collect();
        let found = measure(&wheel);
        assert_eq!((found.boundary_edges, found.boundary_loops, found.extra_fans), (u64::from(spokes), 1, 0));
        assert_eq!(found.euler, 1);
    }
}

/// The quick way says what the general way says, and speaks whenever it should: on every surface whose points have
/// one fan each and whose edges are used once in a direction.
#[test]
fn the_quick_way_agrees_with_the_general_way() {
    let mut state = 3_u64;
    let mut random = |below: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::try_from(state >> 33).expect("31 bits") % below
    };
    let (mut quick, mut general) = (0, 0);
    for round in 0..4000 {
        let mut triangles = torus(3 + random(5), 3 + random(5));
        if random(2) == 0 {
            triangles.extend(shifted(&TETRAHEDRON, random(70)));
        }
        let damage = if round % 4 == 0 { 0 } else { random(6) };
        for _ in 0..damage {
            let victim = random(u32::try_from(triangles.len()).expect("few")) as usize;
            match random(9) {
                0 => triangles[victim].swap(0, 1),
                1 => triangles[victim][0] = random(64),
                2 => triangles.push(triangles[victim]),
                _ => drop(triangles.swap_remove(victim)),
            }
        }
        if random(2) == 0 {
            let third = triangles.len() / 3;
            triangles.rotate_left(third);
        }
        let point_of = |corner: usize| triangles[corner / 3][corner % 3];
        let expected = of_any(triangles.len(), 140, &point_of);
        let flat = triangles.iter().any(|[a, b, c]| a == b || b == c || c == a);
        let odd = expected.crowded_edges + expected.misoriented_edges + expected.extra_fans > 0 || flat;
        match of_surface(triangles.len(), 140, &point_of) {
            Some(found) => {
                quick += 1;
                assert_eq!(found, expected, "{triangles:?}");
            }
            None => {
                general += 1;
                assert!(odd, "{triangles:?}");
            }
        }
    }
    assert!(quick > 1000 && general > 1000, "{quick} and {general}");
}

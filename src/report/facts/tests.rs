//! Closed forms, known topology, and damage.

use super::{FactsError, Mass, measure, vertex_cache};
use crate::geometry::number::sin_cos;

const CUBE_INDICES: [u32; 36] = [
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4,
    7,
];

/// A box from `low` of size `size`.
fn cuboid(low: [f32; 3], size: [f32; 3]) -> Vec<[f32; 3]> {
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .map(|corner: [u8; 3]| [0, 1, 2].map(|axis| low[axis] + size[axis] * f32::from(corner[axis])))
        .to_vec()
}

/// A torus of radii 2 and 0.5 around z, each vertex doubled.
fn torus(columns: u32, rows: u32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut positions = Vec::new();
    let at = |column: u32, row: u32| 2 * (row % rows * columns + column % columns) + (column + row) % 2;
    let mut indices = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (sin_u, cos_u) = sin_cos(std::f64::consts::TAU * f64::from(column) / f64::from(columns));
            let (sin_v, cos_v) = sin_cos(std::f64::consts::TAU * f64::from(row) / f64::from(rows));
            let radius = 2.0 + 0.5 * cos_v;
            #[expect(clippy::cast_possible_truncation, reason = "positions are written in single precision")]
            let position = [radius * cos_u, radius * sin_u, 0.5 * sin_v].map(|value| value as f32);
            positions.extend([position, position]);
            let [a, b, c, d] =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            indices.extend([a, b, c, a, c, d]);
        }
    }
    (positions, indices)
}

#[test]
fn a_box_by_closed_form() {
    let size = [2.0, 3.0, 5.0];
    for low in [[0.0, 0.0, 0.0], [-7.0, 100.0, 4096.0]] {
        let facts = measure(&cuboid(low, size), &CUBE_INDICES).expect("good");
        assert_eq!((facts.volume, facts.area, facts.mass), (Some(30.0), 62.0, Mass::Solid));
        let bounds = facts.bounds.expect("a box");
        assert_eq!((bounds.min, bounds.max), (low, [0, 1, 2].map(|axis| low[axis] + size[axis])));
        let centroid = facts.centroid.expect("a volume");
        let inertia = facts.inertia.expect("a volume");
        for axis in 0..3 {
            assert!((centroid[axis] - f64::from(low[axis] + size[axis] / 2.0)).abs() < 1e-12);
            let others =
                [(axis + 1) % 3, (axis + 2) % 3].map(|other| f64::from(size[other]) * f64::from(size[other]));
            assert!((inertia[axis][axis] - 30.0 * (others[0] + others[1]) / 12.0).abs() < 1e-10);
            assert!(inertia[axis][(axis + 1) % 3].abs() < 1e-12);
        }
        assert_eq!((facts.points, facts.euler, facts.genus, facts.components), (8, 2, Some(0), 1));
        assert!(facts.closed && facts.manifold);
    }
}

#[test]
fn inside_out_is_negative() {
    let turned: Vec<u32> = CUBE_INDICES.chunks(3).flat_map(|t| [t[0], t[2], t[1]]).collect();
    let facts = measure(&cuboid([0.0; 3], [1.0; 3]), &turned).expect("good");
    assert_eq!((facts.volume, facts.closed, facts.manifold), (Some(-1.0), true, true));
    assert!(facts.centroid.expect("a volume").iter().all(|value| (value - 0.5).abs() < 1e-15));
}

#[test]
fn a_tilted_plate_has_products_of_inertia() {
    // A thin plate spanned by (1, 1, 0) and z: the tensor of the solid differs off the diagonal.
    let plate = cuboid([0.0; 3], [1.0, 1.0, 1.0])
        .into_iter()
        .map(|[x, y, z]| [x - 0.25 * y, x + 0.25 * y, z])
        .collect::<Vec<_>>();
    let inertia = measure(&plate, &CUBE_INDICES).expect("good").inertia.expect("a volume");
    // Shear of the cube by M: second moments are det M / 12 * M M^T, det = 0.5.
    let second = |row: [f64; 2], column: [f64; 2]| 0.5 / 12.0 * (row[0] * column[0] + row[1] * column[1]);
    let (x, y) = ([1.0, -0.25], [1.0, 0.25]);
    assert!((inertia[0][1] + second(x, y)).abs() < 1e-15);
    assert!((inertia[2][2] - second(x, x) - second(y, y)).abs() < 1e-15);
    assert_eq!(inertia[0][1], inertia[1][0]);
}

#[test]
fn an_open_sheet_is_measured_as_a_surface() {
    let square = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
    let facts = measure(&square, &[0, 1, 2, 0, 2, 3]).expect("good");
    assert_eq!((facts.mass, facts.volume, facts.area), (Mass::Surface, None, 4.0));
    assert_eq!(facts.centroid, Some([1.0, 1.0, 0.0]));
    let inertia = facts.inertia.expect("an area");
    for (axis, expected) in [(0, 4.0 / 3.0), (1, 4.0 / 3.0), (2, 8.0 / 3.0)] {
        assert!((inertia[axis][axis] - expected).abs() < 1e-14);
    }
    assert_eq!((facts.boundary_edges, facts.boundary_loops, facts.genus), (4, 1, None));

    // With its back side it is closed and still has no inside.
    let both = measure(&square, &[0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2]).expect("good");
    assert_eq!((both.mass, both.volume, both.area, both.closed), (Mass::Surface, Some(0.0), 8.0, true));
}

#[test]
fn a_torus_converges_to_pappus_and_its_seams_are_merged() {
    let pi = std::f64::consts::PI;
    let (volume, area) = (2.0 * pi * pi * 2.0 * 0.25, 4.0 * pi * pi * 2.0 * 0.5);
    let mut last = f64::INFINITY;
    for rows in [8, 16, 32, 64] {
        let (positions, indices) = torus(4 * rows, rows);
        let facts = measure(&positions, &indices).expect("good");
        assert!(facts.closed && facts.manifold, "{rows} rows");
        assert_eq!((facts.genus, facts.euler, facts.components), (Some(1), 0, 1));
        assert_eq!((facts.points, facts.vertices), (u64::from(4 * rows * rows), u64::from(8 * rows * rows)));
        let error = (facts.volume.expect("closed") / volume - 1.0).abs() + (facts.area / area - 1.0).abs();
        assert!(error < last / 3.5, "{error} after {last}");
        last = error;
    }
}

#[test]
fn blocks_add_up_as_one_sum_does() {
    // More than a block of triangles, against a plain sum in another order.
    let (positions, indices) = torus(100, 50);
    let facts = measure(&positions, &indices).expect("good");
    let point = |index: u32| positions[index as usize].map(f64::from);
    let plain: f64 = indices
        .chunks(3)
        .rev()
        .map(|t| {
            let [a, b, c] = [point(t[0]), point(t[1]), point(t[2])];
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum();
    assert!((facts.volume.expect("closed") - plain).abs() < 1e-11);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    assert_eq!(
        pool(1).install(|| measure(&positions, &indices)),
        pool(3).install(|| measure(&positions, &indices))
    );
}

#[test]
fn two_boxes_that_share_an_edge() {
    let mut positions = cuboid([0.0; 3], [1.0; 3]);
    positions.extend(cuboid([1.0, 1.0, 0.0], [1.0; 3]));
    let indices: Vec<u32> =
        CUBE_INDICES.iter().copied().chain(CUBE_INDICES.iter().map(|index| index + 8)).collect();
    let facts = measure(&positions, &indices).expect("good");
    assert_eq!((facts.points, facts.crowded_edges, facts.volume), (14, 1, Some(2.0)));
    assert!(facts.closed && !facts.manifold && facts.genus.is_none());
}

#[test]
fn degenerate_triangles_are_counted() {
    let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let facts = measure(&line, &[0, 1, 2, 0, 1, 1, 0, 1, 3]).expect("good");
    assert_eq!(facts.degenerate_triangles, 2);
}

#[test]
fn damage_is_named() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    assert_eq!(measure(&cube, &[0, 1]), Err(FactsError::IncompleteTriangle { indices: 2 }));
    assert_eq!(
        measure(&cube, &[0, 1, 2, 3, 8, 4]),
        Err(FactsError::IndexOutOfRange { triangle: 1, index: 8, vertices: 8 })
    );
    let mut spoiled = cube;
    spoiled[5][1] = f32::NAN;
    assert_eq!(measure(&spoiled, &[0, 1, 2]), Err(FactsError::NotFinite { vertex: 5 }));
    let nothing = measure::<[f32; 3], u32>(&[], &[]).expect("an empty mesh");
    assert!(nothing.bounds.is_none() && nothing.centroid.is_none() && nothing.acmr == 0.0);
}

#[test]
fn keys_are_kebab_case() {
    let facts = measure(&cuboid([0.0; 3], [1.0; 3]), &CUBE_INDICES).expect("good");
    let json = serde_json::to_value(&facts).expect("plain data");
    assert_eq!(json["boundary-edges"], 0);
    assert_eq!(json["inertia-of"], "solid");
    assert_eq!(json["bounds"]["max"][0], 1.0);
}

/// A grid of n x n quads row by row: each row but the first meets n + 1 old vertices and n + 1 new ones; with rows
/// longer than the cache all are misses. Figures: 2 (n + 1) n misses for 2 n^2 triangles.
#[test]
fn a_long_grid_misses_every_vertex_once_a_row() {
    let n = 32_u32;
    let at = |column: u32, row: u32| row * (n + 1) + column;
    let mut indices = Vec::new();
    for row in 0..n {
        for column in 0..n {
            let [a, b, c, d] =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            indices.extend([a, b, c, a, c, d]);
        }
    }
    let figures = vertex_cache(&indices, 33 * 33);
    assert_eq!(figures.acmr, f64::from(2 * (n + 1) * n) / f64::from(2 * n * n));
    assert_eq!(figures.atvr, f64::from(2 * (n + 1) * n) / f64::from((n + 1) * (n + 1)));
    assert_eq!(vertex_cache(&[0, 1, 2], 3).acmr, 3.0);
}

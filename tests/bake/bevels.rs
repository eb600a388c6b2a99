//! Bevels and drafts of extrusions: closed, as far inside the outline as they should be, of the volumes of closed forms.

use std::f64::consts::PI;

use kiln::geometry::number::{hypot, sin_cos_degrees};

use super::{assert_near, bake};

/// A bevel on a square is two frustums and a box between them.
#[test]
fn a_beveled_square_has_the_volume_of_its_frustums() {
    let volume = |side: f64, inset: f64, height: f64| {
        let small = side - 2.0 * inset;
        height / 3.0 * (side * side + small * small + side * small)
    };
    for (bevel, ends) in [("0.25", 2.0), ("{ size = 0.25, height = 0.5, ends = \"top\" }", 1.0)] {
        let text = format!(
            "[shape.a.extrude]\nprofile = {{ polyline = {{ points = [[0, 0], [2, 0], [2, 2], [0, 2]], closed = true }} }}\nheight = 2\nbevel = {bevel}"
        );
        let baked = bake(&text);
        let facts = &baked.only().facts;
        let high = if ends == 1.0 { 0.5 } else { 0.25 };
        let expected = ends * volume(2.0, 0.25, high) + 4.0 * (2.0 - ends * high);
        assert_near(facts.volume.expect("closed"), expected, 1e-6);
        assert!(facts.manifold && facts.genus == Some(0));
        assert_eq!(facts.triangles, if ends == 1.0 { 20 } else { 28 });
        // Nothing but the rounding to single precision.
        assert!(baked.only().deviation.bound <= 3e-7);
    }
}

/// Round and hollow bevels of a disk are parts of a torus: volumes by quadrature of the disks at each height.
#[test]
fn round_bevels_of_a_disk_have_the_volume_of_their_slices() {
    const STEPS: u32 = 20_000;
    let slices = |inset: &dyn Fn(f64) -> f64, height: f64| {
        let slice = |k: u32| {
            let radius = 1.0 - inset((f64::from(k) + 0.5) / f64::from(STEPS) * height);
            PI * radius * radius * height / f64::from(STEPS)
        };
        (0..STEPS).map(slice).sum::<f64>()
    };
    let square = |x: f64| x * x;
    let round = |z: f64| 0.3 * (1.0 - (1.0 - square(z / 0.2)).sqrt());
    let cove = |z: f64| 0.3 * (1.0 - square(1.0 - z / 0.2)).sqrt();
    let cases: [(&str, &dyn Fn(f64) -> f64); 2] = [("round", &round), ("cove", &cove)];
    for (form, inset) in cases {
        let mut errors = Vec::new();
        for tolerance in [0.003, 0.0003] {
            let text = format!(
                "tolerance = {tolerance}\n[shape.a.extrude]\nprofile = {{ circle = {{ radius = 1 }} }}\nheight = 1\nbevel = {{ size = 0.3, height = 0.2, form = \"{form}\" }}"
            );
            let baked = bake(&text);
            let facts = &baked.only().facts;
            let expected = 2.0 * slices(inset, 0.2) + PI * 0.6;
            errors.push((facts.volume.expect("closed") - expected).abs());
            assert!(errors[errors.len() - 1] <= facts.area * tolerance, "{form}: {errors:?}");
        }
        // Chords come nearer with the tolerance.
        assert!(errors[1] < errors[0] / 5.0, "{form}: {errors:?}");
    }
}

/// Closed outlines, with the number of their holes.
const OUTLINES: [(&str, u64); 7] = [
    (
        "profile = { polyline = { points = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]], closed = true } }",
        0,
    ),
    (
        "profile = { polyline = { points = { count = 14, each = \"= [(2 - 0.9 * (i % 2)) * cos(360 / 14 * i), (2 - 0.9 * (i % 2)) * sin(360 / 14 * i)]\" }, closed = true } }",
        0,
    ),
    // Short sides beside a corner vanish on the way.
    (
        "profile = { polyline = { points = [[0, 0], [3, 0], [3, 0.05], [2.98, 0.13], [2.93, 0.2], [2.8, 0.31], [1.2, 1.4], [0.1, 2], [0, 1.95]], closed = true } }",
        0,
    ),
    (
        "profile = { circle = { radius = 1.8 } }\nholes = [{ circle = { radius = 0.5 } }, { circle = { center = [0.9, 0.6], radius = 0.1 } }]",
        2,
    ),
    (
        "profile = { path = { start = [0, 0], segments = [{ line = [[2, 0]] }, { arc = { through = [2.3, 1], to = [1.5, 1.6] } }, { arc = { through = [0.9, 1], to = [0.2, 1.2] } }, { line = [[0, 0]] }] } }",
        0,
    ),
    (
        "profile = { natural-spline = { points = [[0, 0], [2, -0.3], [3, 1], [1.5, 0.9], [0, 2]], closed = true } }",
        0,
    ),
    ("profile = { svg = { d = \"M0 0 H3 V3 H0 Z M0.8 0.8 V2.2 H2.2 V0.8 Z\" } }", 1),
];

const BEVELS: [&str; 6] = [
    "bevel = 0.2",
    "bevel = { size = 0.15, form = \"round\" }",
    "bevel = { size = 0.12, height = 0.3, form = \"cove\", ends = \"bottom\" }",
    "draft = 5",
    "draft = 3\nbevel = { size = 0.05, form = \"round\" }",
    "bevel = { size = 0.1, height = 0.5 }\ncentered = true",
];

#[test]
fn leaning_walls_are_closed_and_within_their_bound() {
    for (outline, holes) in OUTLINES {
        for bevel in BEVELS {
            for options in ["", "[material.m]\ncolor = \"#888\"\n", "segments = [40, 5]"] {
                let (before, options) =
                    if options.starts_with('[') { ("uv = \"always\"", "") } else { (options, options) };
                let text = format!(
                    "tolerance = 0.004\n[shape.a]\n{before}\n[shape.a.extrude]\n{outline}\nheight = 1\n{bevel}\n"
                );
                let baked = bake(&text);
                let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
                assert!(facts.closed && facts.manifold, "{text}: {facts:?}");
                assert_eq!((facts.genus, facts.degenerate_triangles), (Some(holes), 0), "{text}");
                let measured = deviation.measured.expect("asked for");
                assert!(measured <= deviation.bound + 1e-6, "{text}: {deviation:?}");
                assert!(!options.is_empty() || deviation.bound <= 0.004, "{text}: {deviation:?}");
                assert!(baked.compiled.warnings.is_empty(), "{text}: {}", baked.compiled.warnings);
            }
        }
    }
}

/// Every point of a polygon's cut is as far inside the polygon as it is high: looked at by the distances from all
/// sides, with no part of the kernel.
#[test]
fn a_cut_stands_as_far_inside_as_it_is_high() {
    let corner = |k: u32| {
        let (sin, cos) = sin_cos_degrees(360.0 * f64::from(k) / 11.0);
        // Uneven arms: sides vanish, inner corners fan out.
        let arm = 1.0 + 0.35 * f64::from((7 * k * k + 3 * k) % 11) / 11.0;
        [arm * cos, arm * sin]
    };
    let corners: Vec<[f64; 2]> = (0..11).map(corner).collect();
    let text = format!(
        "tolerance = 0.0005\n[shape.a.extrude]\nprofile = {{ polyline = {{ points = {corners:?}, closed = true }} }}\nheight = 1\nbevel = {{ size = 0.4, ends = \"top\" }}"
    );
    let baked = bake(&text);
    let distance = |x: f64, y: f64| {
        let side = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let part = (((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
            hypot(x - a[0] - dx * part, y - a[1] - dy * part)
        };
        (0..corners.len()).map(side).fold(f64::INFINITY, f64::min)
    };
    let mesh = baked.glb.mesh(0);
    let mut checked = 0;
    for triangle in &mesh.triangles {
        let points = triangle.map(|corner| mesh.positions[corner]);
        let on_cut = |point: &[f64; 3]| point[2] >= 0.6 - 1e-9;
        if !points.iter().all(on_cut) || points.iter().all(|point| point[2] > 1.0 - 1e-9) {
            continue;
        }
        for weights in [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [1.0 / 3.0; 3]] {
            let at = |axis: usize| (0..3).map(|k| points[k][axis] * weights[k]).sum::<f64>();
            let off = distance(at(0), at(1)) - (at(2) - 0.6);
            assert!(off.abs() <= 0.0005 * f64::sqrt(2.0), "{off} at {:?}", [at(0), at(1), at(2)]);
            checked += 1;
        }
    }
    assert!(checked > 60, "{checked}");
}

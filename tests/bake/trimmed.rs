//! Surfaces cut along lines of their parameters: closed forms, borders, and what the file says.

use core::f64::consts::PI;

use super::{assert_near, bake};

/// z = x y over a square of half width 1, without a round hole; then the lid of the hole.
#[test]
fn a_saddle_and_its_lid_make_the_whole() {
    let saddle = "degree = 1, control = [[[-1, -1, 1], [1, -1, -1]], [[-1, 1, -1], [1, 1, 1]]]";
    let part = |rest: &str| {
        let text =
            format!("tolerance = 1e-3\n[shape.a.trimmed]\nof = {{ patches = {{ {saddle} }} }}\n{rest}");
        let baked = bake(&text);
        let facts = baked.only().facts.clone();
        let deviation = baked.only().deviation;
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
        assert!(deviation.bound <= 1.001e-3 && facts.degenerate_triangles == 0, "{facts:?}");
        for [x, y, z] in &baked.glb.named("a").positions {
            assert!((z - x * y).abs() < 1e-6);
        }
        facts
    };
    let rest = part("holes = [{ circle = { radius = 0.25, center = [0.5, 0.5] } }]");
    assert_eq!((rest.components, rest.boundary_loops), (1, 2));
    // The circle in the parameters has a radius of 1/2 in x and y: the integral of sqrt(1 + r^2) over the disk.
    let lid = part("profile = { circle = { radius = 0.25, center = [0.5, 0.5] } }");
    assert_near(lid.area, 2.0 * PI / 3.0 * (1.25_f64 * 1.25_f64.sqrt() - 1.0), 3e-3);
    let whole = part("profile = { polyline = { points = [[0, 0], [1, 0], [1, 1], [0, 1]], closed = true } }");
    assert_near(rest.area + lid.area, whole.area, 6e-3);
}

/// Where the surface stands, is turned and is scaled, its parts are too; it is not shown by itself.
#[test]
fn parts_stand_where_their_surface_stands() {
    let baked = bake(
        "tolerance = 1e-3\n[shape.wall]\nscale = 2\nat = [0, 0, 5]\n[shape.wall.patches]\ndegree = 1\n\
         control = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]\n\
         [shape.a]\nat = [1, 0, 0]\n[shape.a.trimmed]\nof = \"wall\"\n\
         holes = [{ circle = { radius = 0.25, center = [0.5, 0.5] } }]",
    );
    let facts = &baked.only().facts;
    assert_near(facts.area, 4.0 - PI / 4.0, 4e-3);
    let mesh = baked.glb.named("a");
    assert!(mesh.positions.iter().all(|[x, _, z]| (1.0..=3.0).contains(x) && *z == 5.0));
}

/// The asset of the gallery: the panel has an outline and its openings.
#[test]
fn the_panel_has_its_openings() {
    let baked = bake(include_str!("../../specs/trimmed/hood.toml"));
    let facts = &baked.report().shapes["hood"].facts;
    assert_eq!((facts.components, facts.boundary_loops), (1, 4), "{facts:?}");
}

/// The asset of the gallery: windows over the edges and over the seam of its shell, and a band of glass all around.
#[test]
fn the_lantern_has_its_windows() {
    let baked = bake(include_str!("../../specs/trimmed/lantern.toml"));
    let shell = &baked.report().shapes["shell"].facts;
    assert_eq!((shell.components, shell.boundary_loops, shell.degenerate_triangles), (1, 10, 0), "{shell:?}");
    let glass = &baked.report().shapes["glass"].facts;
    assert_eq!((glass.components, glass.boundary_loops, glass.degenerate_triangles), (1, 2, 0), "{glass:?}");
}

/// A roof of two flat halves: a disk over its ridge has the area of a disk, leaned.
#[test]
fn outlines_run_over_edges() {
    let baked = bake(
        "tolerance = 1e-4\n[shape.a.trimmed]\nof = { patches = { degree = 1, control = [\
         [[0, 0, 0], [1, 1, 0], [2, 0, 0]], [[0, 0, 2], [1, 1, 2], [2, 0, 2]]] } }\n\
         profile = { ellipse = { radii = [0.8, 0.4], center = [1, 0.5] } }",
    );
    let facts = &baked.only().facts;
    assert_near(facts.area, PI * 0.8 * 0.8 * 2.0_f64.sqrt(), 2e-3);
    assert_eq!((facts.components, facts.boundary_loops), (1, 1), "{facts:?}");
}

//! Curves as lines.

use core::f64::consts::PI;

use super::{Baked, assert_near, bake};
use kiln::report::facts::LineFacts;

fn lines(baked: &Baked) -> &LineFacts {
    baked.only().lines.as_ref().expect("there are lines")
}

#[test]
fn a_wire_is_its_curves_and_nothing_more() {
    let baked = bake(
        "tolerance = 0.001\n[curve.way.polyline]\npoints = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 3, 0]]\n\
         [shape.a.wire]\ncurves = [\"way\", { circle = { radius = 2 } }]",
    );
    let (facts, found) = (&baked.only().facts, lines(&baked));
    assert_eq!((facts.triangles, facts.closed, facts.manifold, facts.volume), (0, false, false, None));
    assert_eq!((found.curves, found.closed_curves), (2, 1));
    // Corners of polylines stay, also those in straight parts.
    let circle = found.segments - 3;
    assert_eq!(found.vertices, circle + 4);
    // A chord of n to the turn has the sagitta r (1 - cos(pi / n)), about r pi^2 / 2 n^2.
    let needed = PI * (2.0 / (2.0 * 0.001_f64)).sqrt();
    assert!((circle as f64) < needed + 5.0, "{circle} segments, {needed} are needed");
    let inscribed = 4.0 * PI - found.length + 5.0;
    assert!((0.0..0.01).contains(&inscribed), "{inscribed}");
    assert!(baked.only().deviation.bound <= 0.001);
    let measured = baked.only().deviation.measured.expect("asked for");
    assert!(measured <= baked.only().deviation.bound && measured > 0.0005, "{measured}");
    let bounds = found.bounds.expect("there are points");
    assert_eq!(bounds.max, [2.0, 3.0, 0.0]);
    assert!(bounds.min[..2].iter().all(|least| (-2.0..-1.999).contains(least)), "{bounds:?}");
    assert_eq!(baked.report().totals.bounds.max, [2.0, 3.0, 0.0]);
    assert_eq!((baked.report().totals.segments, baked.report().totals.triangles), (found.segments, 0));
}

#[test]
fn wires_stand_beside_surfaces_in_a_group() {
    let baked = bake(
        "[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n\
         [curve.edge.polyline]\npoints = [[0, 0, 0], [0, 0, 2]]\n\
         [shape.block]\nmaterial = \"red\"\n[shape.block.box]\nsize = [1, 1, 1]\n\
         [shape.rod]\nmaterial = \"blue\"\n[shape.rod.wire]\ncurves = [\"edge\"]\n\
         [shape.pole]\nat = [1, 0, 0]\nmaterial = \"red\"\n[shape.pole.wire]\ncurves = [\"edge\"]\n\
         [shape.all.group]\nof = [\"block\", \"rod\", \"pole\"]\n[node.one]\nshape = \"all\"\nat = [0, 5, 0]",
    );
    let shape = baked.only();
    assert_eq!((shape.primitives, shape.facts.triangles), (3, 12));
    assert!(shape.facts.closed && shape.facts.manifold);
    assert_near(shape.facts.volume.expect("closed"), 1.0, 1e-6);
    let found = lines(&baked);
    assert_eq!((found.curves, found.closed_curves, found.segments, found.length), (2, 0, 2, 4.0));
    assert_eq!(baked.report().totals.bounds.max, [1.0, 5.5, 2.0]);
    let written = &baked.glb.mesh(0).lines;
    let color = |material: Option<usize>| {
        let material = &baked.glb.list("materials")[material.expect("a material")];
        material["name"].as_str().expect("a name").to_owned()
    };
    let mut worn: Vec<_> = written.materials.iter().map(|material| color(*material)).collect();
    worn.sort_unstable();
    assert_eq!(worn, ["blue", "red"]);
}

#[test]
fn placements_move_wires_as_they_move_surfaces() {
    let baked = bake(
        "unit = \"cm\"\nup = \"z\"\ntolerance = 0.01\n[shape.a]\nscale = 3\nat = [0, 0, 10]\n\
         [shape.a.wire]\ncurves = [{ circle = { radius = 2, center = [5, 0] } }]",
    );
    let found = lines(&baked);
    let bounds = found.bounds.expect("there are points");
    assert!(
        (0.0..1e-4).contains(&(bounds.min[0] - 0.09)) && (bounds.max[0] - 0.21).abs() < 1e-7,
        "{bounds:?}"
    );
    assert!((bounds.min[1] - 0.1).abs() < 1e-7 && (bounds.max[1] - 0.1).abs() < 1e-7, "{bounds:?}");
    assert!(baked.only().deviation.bound <= 1e-4);
    assert_near(found.length, 0.12 * PI, 1e-2);
}

#[test]
fn long_wires_have_wide_indices() {
    let baked = bake("[shape.a]\nsegments = 70000\n[shape.a.wire]\ncurves = [{ circle = { radius = 1 } }]");
    assert_eq!((lines(&baked).segments, lines(&baked).vertices), (70_000, 70_000));
}

//! Perturbed patches: skins are closed, lie on their equation, and have the measures of integrals.

use core::f64::consts::PI;

use super::{assert_near, bake};

/// Points of a cube's surface by six squares.
const CUBE: &str = "points = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]\n\
     faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\n";

/// Without bumps the faces of a ball are the ball.
#[test]
fn faces_of_a_ball_make_a_ball() {
    let text = format!("tolerance = 1e-3\n[shape.a.perturbed]\n{CUBE}center = [0, 0, 0]\nspherical = true");
    let baked = bake(&text);
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 4.0 / 3.0 * PI * 3.0_f64.sqrt() * 3.0, 2e-2);
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 1e-3);
    // Smooth across sides: a vertex for each point.
    assert_eq!(facts.vertices, facts.points);
}

/// Over a cylinder's quadric the height has a closed form: f (1 - r²)² in all directions.
#[test]
fn the_volume_below_a_bump_is_that_of_its_integral() {
    let text = "tolerance = 2e-5\n[shape.a.perturbed]\n\
         points = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0], [0, 0, -1]]\n\
         faces = [[0, 1, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]\nreach = 1\n\
         bumps = [{ field = { quadric = { xx = 1, yy = 1, constant = -1 } }, factor = 0.25, faces = [0] }]";
    let baked = bake(text);
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    // 2 pi f times the integral of r (1 - r²)², which is 1/6.
    assert_near(facts.volume.expect("closed"), 16.0 / 3.0 + PI / 12.0, 1e-4);
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 2e-5);
    for [x, y, z] in baked.glb.named("a").positions.iter().filter(|point| point[2] >= 0.0) {
        let depth = (x * x + y * y - 1.0).min(0.0);
        assert!((z - 0.25 * depth * depth).abs() < 1e-6, "{x} {y} {z}");
    }
}

/// Bumps over edges and corners of a cube about a center: closed, and hard at its edges.
#[test]
fn bumps_lie_over_edges() {
    let text = format!(
        "tolerance = 2e-3\n[shape.a.perturbed]\n{CUBE}center = [0, 0, 0]\nbumps = [\
         {{ field = {{ quadric = {{ xx = 4, yy = 4, zz = 4, constant = -1 }}, at = [1, 1, 1] }}, factor = 0.2 }},\
         {{ field = {{ quadric = {{ xx = 9, yy = 9, zz = 9, constant = -1 }}, at = [1, 0, 1] }}, factor = -0.1 }}]"
    );
    let baked = bake(&text);
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    assert!(facts.vertices > facts.points && facts.degenerate_triangles == 0, "{facts:?}");
    assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
    assert_eq!(baked.report().perturbed["a"].made, "surface");
    // F' by hand: the greatest share of the coordinates, less the bumps.
    for [x, y, z] in &baked.glb.named("a").positions {
        let depth = |square: f64, [a, b, c]: [f64; 3]| {
            let (a, b, c) = (x - a, y - b, z - c);
            (square * (a * a + b * b + c * c) - 1.0).min(0.0)
        };
        let (hill, dent) = (depth(4.0, [1.0, 1.0, 1.0]), depth(9.0, [1.0, 0.0, 1.0]));
        let base = x.abs().max(y.abs()).max(z.abs()) - 1.0;
        let value = base - 0.2 * hill * hill + 0.1 * dent * dent;
        assert!(value.abs() < 2e-6, "{x} {y} {z}: {value}");
    }
}

/// Where it overhangs the shape is the solid below, down to its depth, and the report says so.
#[test]
fn overhangs_make_solids() {
    let text = "tolerance = 2e-3\n[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n\
         faces = [[0, 1, 2, 3]]\ndepth = 0.3\n\
         bumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.5, 0.5, 0.12] }, factor = 1 }]";
    let baked = bake(text);
    let facts = &baked.only().facts;
    assert_eq!(baked.report().perturbed["a"].made, "solid");
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    let bounds = facts.bounds.expect("not empty");
    assert!((bounds.min[2] + 0.3).abs() < 1e-6 && bounds.max[2] > 0.2, "{bounds:?}");
    assert!(facts.volume.expect("closed") > 0.3, "{facts:?}");
    let deviation = baked.only().deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
}

/// The gallery's heads and boxes, each within what is proved.
#[test]
fn the_gallery_keeps_its_bounds() {
    for text in [
        include_str!("../../specs/perturbed/creature-head.toml"),
        include_str!("../../specs/perturbed/casket.toml"),
    ] {
        let coarser = text.replacen("tolerance = 0.00", "tolerance = 0.01", 1);
        let baked = bake(&coarser);
        for (name, shape) in &baked.report().shapes {
            let deviation = shape.deviation;
            assert!(deviation.measured.expect("asked for") <= deviation.bound, "{name}: {deviation:?}");
            assert!(shape.facts.closed && shape.facts.manifold, "{name}: {:?}", shape.facts);
        }
        assert!(baked.report().perturbed.values().all(|patches| patches.made == "surface" && patches.closed));
    }
}

//! Surfaces of several shapes as one skin: closed where they enclose something, smooth where they are declared so.

use super::{assert_near, bake};

/// The asset of the gallery: a Bezier patch sewn to a Coons patch along four sides.
#[test]
fn two_patches_are_a_cushion() {
    let text = include_str!("../../specs/joined/cushion.toml");
    for tolerance in ["0.02", "0.001"] {
        let baked = bake(&text.replace("tolerance = 0.001", &format!("tolerance = {tolerance}")));
        let facts = &baked.report().shapes["cushion"].facts;
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{tolerance}: {facts:?}");
        assert!(facts.volume.expect("closed") > 0.005 && facts.degenerate_triangles == 0, "{facts:?}");
        let deviation = baked.report().shapes["cushion"].deviation;
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
    }
}

/// Six surfaces of three kinds are a box without cracks, whose volume is known.
#[test]
fn sides_of_any_kinds_close_a_box() {
    let line = |from: &str, to: &str| format!("{{ line = {{ from = {from}, to = {to} }} }}");
    let (a, b, c, d) = ("[0, 0, 0]", "[2, 0, 0]", "[2, 1, 0]", "[0, 1, 0]");
    let (e, f, g, h) = ("[0, 0, 3]", "[2, 0, 3]", "[2, 1, 3]", "[0, 1, 3]");
    let ruled = |one: (&str, &str), other: (&str, &str)| {
        format!("{{ ruled = {{ from = {}, to = {} }} }}", line(one.0, one.1), line(other.0, other.1))
    };
    let patch = |p: [&str; 4]| {
        format!("{{ patches = {{ degree = 1, control = [[{}, {}], [{}, {}]] }} }}", p[0], p[1], p[2], p[3])
    };
    let coons = |p: [&str; 4]| {
        let sides = [(p[0], p[1]), (p[1], p[2]), (p[2], p[3]), (p[3], p[0])].map(|(from, to)| line(from, to));
        format!("{{ coons = {{ sides = [{}] }} }}", sides.join(", "))
    };
    let of = [
        patch([a, b, d, c]),
        coons([e, f, g, h]),
        ruled((a, b), (e, f)),
        ruled((d, c), (h, g)),
        patch([a, d, e, h]),
        coons([b, c, g, f]),
    ];
    let text =
        format!("[shape.a]\nat = [0, 5, 0]\n[shape.a.joined]\nof = [{}]\ncontinuity = \"C0\"", of.join(", "));
    let baked = bake(&text);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.components == 1, "{facts:?}");
    assert_near(facts.volume.expect("closed"), 6.0, 1e-6);
    assert_near(facts.area, 2.0 * (2.0 + 3.0 + 6.0), 1e-6);
}

/// One side four times, turned by a right angle each time, and a lid: a box of parts that stand at places of their own,
/// each with its material, though they are one skin.
#[test]
fn parts_stand_at_their_own_places_and_keep_their_materials() {
    let side = "[shape.side]\nmaterial = \"wood\"\n[shape.side.patches]\ndegree = 1\n\
         control = [[[-1, 0, 1], [1, 0, 1]], [[-1, 3, 1], [1, 3, 1]]]\n";
    let turned: String = [90, 180, 270]
        .map(|angle| {
            format!(
                "[shape.s{angle}]\nrotate = [0, {angle}, 0]\nmaterial = \"wood\"\n[shape.s{angle}.patches]\n\
                 degree = 1\ncontrol = [[[-1, 0, 1], [1, 0, 1]], [[-1, 3, 1], [1, 3, 1]]]\n"
            )
        })
        .concat();
    let lids = "[shape.low]\nmaterial = \"tin\"\n[shape.low.patches]\ndegree = 1\n\
         control = [[[-1, 0, -1], [1, 0, -1]], [[-1, 0, 1], [1, 0, 1]]]\n\
         [shape.high]\nat = [0, 3, 0]\nscale = 2\n[shape.high.patches]\ndegree = 1\n\
         control = [[[-0.5, 0, -0.5], [0.5, 0, -0.5]], [[-0.5, 0, 0.5], [0.5, 0, 0.5]]]\n";
    let text = format!(
        "{side}{turned}{lids}[material.wood]\n[material.tin]\n[material.felt]\n[shape.a]\nmaterial = \"felt\"\n\
         [shape.a.joined]\nof = [\"side\", \"s90\", \"s180\", \"s270\", \"low\", \"high\"]"
    );
    let baked = bake(&text);
    let shape = baked.only();
    assert!(shape.facts.closed && shape.facts.manifold && shape.facts.components == 1, "{:?}", shape.facts);
    assert_near(shape.facts.volume.expect("closed"), 12.0, 1e-6);
    assert_eq!(shape.primitives, 3, "wood, tin and, where a part has none, that of the whole");
    assert!(shape.deviation.measured.expect("asked for") <= shape.deviation.bound);
}

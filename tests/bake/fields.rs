//! Surfaces of fields: closed, without crossings, with the measures of closed forms.

use core::f64::consts::PI;
use std::collections::BTreeSet;

use kiln::compile::Options;
use kiln::geometry::number::{acos, floor_large};

use super::{assert_near, bake, compile};

/// Wyvill's potential is 1/2 at half of its radius: one point makes a ball.
#[test]
fn one_point_makes_a_ball() {
    let text = "tolerance = 1e-3\n[field.a.skeleton]\nelements = [{ point = [1, 0, 0], radius = 2 }]\n\
         [shape.s.implicit]\nfield = \"a\"";
    let baked = bake(text);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 4.0 / 3.0 * PI, 2e-2);
    for [x, y, z] in &baked.glb.named("s").positions {
        let radius = ((x - 1.0) * (x - 1.0) + y * y + z * z).sqrt();
        assert!((radius - 1.0).abs() < 3e-7, "{radius}");
    }
}

/// A drilled block keeps its edges: no vertex is lost on them, and its faces are flat.
#[test]
fn a_drilled_block_keeps_its_edges() {
    let baked = bake(include_str!("../../specs/fields/block.toml"));
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(3), "{facts:?}");
    let bores = PI * (0.02 * 0.02 + 2.0 * 0.006 * 0.006) * 0.03;
    let volume = 0.12 * 0.03 * 0.07 - bores;
    assert!((facts.volume.expect("closed") / volume - 1.0).abs() < 5e-3, "{facts:?}");
    let size = facts.bounds.expect("not empty");
    assert_eq!((size.max[0], size.max[1], size.max[2]), (0.06, 0.015, 0.035));
}

/// Dense sampling of every surface of the gallery finds no more than its bound says, and the tolerance allows.
#[test]
fn bounds_hold() {
    for text in [
        include_str!("../../specs/fields/cloud.toml"),
        include_str!("../../specs/fields/creature.toml"),
        include_str!("../../specs/fields/gyroid.toml"),
        include_str!("../../specs/fields/head.toml"),
    ] {
        let baked = bake(text);
        let (_, shape) = baked.report().shapes.iter().next().expect("one shape");
        let deviation = shape.deviation;
        let measured = deviation.measured.expect("asked for");
        assert!(
            measured <= deviation.bound && deviation.bound <= deviation.tolerance.expect("one was asked for"),
            "{deviation:?}"
        );
        assert!(shape.facts.closed && shape.facts.manifold, "{:?}", shape.facts);
    }
}

/// Two balls that flow together, each of the material of its own element: along the border each material has vertices of
/// its own.
#[test]
fn each_element_keeps_its_material() {
    let text = "tolerance = 1e-2\n[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n\
         [field.a.skeleton]\nelements = [{ point = [0.5, 0, 0], radius = 1, material = \"blue\" },\n\
         { point = [-0.5, 0, 0], radius = 1, material = \"red\" }]\n[shape.s.implicit]\nfield = \"a\"";
    let baked = bake(text);
    let materials = baked.glb.list("materials");
    let meshes = baked.glb.list("meshes");
    let primitives = meshes[0]["primitives"].as_array().expect("primitives");
    assert_eq!(primitives.len(), 2);
    let index =
        |value: &serde_json::Value| usize::try_from(value.as_u64().expect("an index")).expect("small");
    let mut shared: BTreeSet<u64> = BTreeSet::new();
    for primitive in primitives {
        let name = &materials[index(&primitive["material"])]["name"];
        let positions = baked.glb.accessor(index(&primitive["attributes"]["POSITION"]));
        let side = if name == "blue" { 1.0 } else { -1.0 };
        let used = baked.glb.accessor(index(&primitive["indices"]));
        assert!(used.len() > 100);
        let corners: BTreeSet<u64> = used.iter().map(|corner| floor_large(corner[0])).collect();
        for corner in &corners {
            let corner = usize::try_from(*corner).expect("small");
            // The middles of triangles decide.
            assert!(positions[corner][0] * side > -0.3, "{name}: {:?}", positions[corner]);
        }
        // Readers that keep one mesh a primitive count a vertex that two share twice.
        assert!(shared.is_disjoint(&corners));
        shared.extend(corners);
    }
}

/// The skin of a ball: two spheres, one inside the other.
#[test]
fn a_skin_has_two_sides() {
    let baked = bake(
        "tolerance = 1e-2\n[shape.s.implicit]\nfield = { sphere = { radius = 1 }, thickness = 0.2 }\n\
         within = { min = [-2, -2, -2], max = [2, 2, 2] }",
    );
    let facts = &baked.only().facts;
    assert_eq!((facts.components, facts.closed), (2, true), "{facts:?}");
    let volume = 4.0 / 3.0 * PI * (1.331 - 0.729);
    assert!((facts.volume.expect("closed") / volume - 1.0).abs() < 0.03, "{facts:?}");
}

/// Balls that touch in a point have no surface of sound triangles; it is said where.
#[test]
fn balls_that_touch_are_refused() {
    let text = "[shape.s.implicit]\nfield = { union = { of = [{ sphere = { radius = 1 } }, \
         { sphere = { radius = 1, center = [2, 0, 0] } }] } }";
    let refused = compile(text, &Options::default()).expect_err("no sound triangles");
    let found = refused.to_string();
    let place = found.split_once("near [").and_then(|(_, rest)| rest.split_once(']')).expect("a place").0;
    let place: Vec<f64> = place.split(", ").map(|x| x.parse().expect("a number")).collect();
    let near = (place[0] - 1.0).abs().max(place[1].abs()).max(place[2].abs()) < 0.1;
    assert!(found.contains("K0944") && found.contains("its parts touch") && near, "{found}");
}

/// Corners where four planes meet, a fillet that fades into edges: all are kept.
#[test]
fn sharp_edges_of_formulas_and_joins_are_kept() {
    let octahedron = bake(
        "[shape.s.implicit]\nfield = { formula = { f = \"= abs(x) + abs(y) + abs(z) - 1\" } }\n\
         within = { min = [-1.5, -1.5, -1.5], max = [1.5, 1.5, 1.5] }",
    );
    let facts = &octahedron.only().facts;
    assert_near(facts.volume.expect("closed"), 4.0 / 3.0, 1e-4);
    assert!(facts.triangles < 50, "{facts:?}");
    let baked = bake(include_str!("../data/fields/bracket.toml"));
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(3), "{facts:?}");
    let size = facts.bounds.expect("not empty");
    assert_eq!((size.max[0], size.max[1]), (0.05, 0.08));
}

/// A gyroid ends at a box: the two spaces that it parts have equal shares of its period.
#[test]
fn a_gyroid_is_closed_at_a_box() {
    let baked = bake(include_str!("../data/fields/tile.toml"));
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.components == 1, "{facts:?}");
    assert_near(facts.volume.expect("closed"), 0.5, 0.05);
    let size = facts.bounds.expect("not empty");
    assert!(size.max.iter().chain(&size.min).all(|x| (x.abs() - 0.5).abs() < 1e-6), "{size:?}");
}

/// A surface of a field is a shape: solids take it, and it is a cage.
#[test]
fn fields_are_parts_of_solids_and_cages() {
    let text = "tolerance = 5e-3\n[shape.ball.implicit]\nfield = { sphere = { radius = 1 } }\n\
         [shape.block.box]\nsize = [4, 4, 2]\ncenter = [0, 0, 1]\n\
         [shape.half.intersection]\nof = [\"ball\", \"block\"]\n[node.a]\nshape = \"half\"";
    let baked = bake(text);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold, "{facts:?}");
    assert_near(facts.volume.expect("closed"), 2.0 / 3.0 * PI, 2e-2);
    let text = "[field.a.skeleton]\nelements = [{ segment = [[0, 0, 0], [1, 0, 0]], radius = 0.5 }]\n\
         [shape.rough]\ntolerance = 0.05\n[shape.rough.implicit]\nfield = \"a\"\n\
         [shape.s.subdivide]\ncage = \"rough\"\nscheme = \"loop\"\nlevels = 2\n[node.a]\nshape = \"s\"";
    let baked = bake(text);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    assert_eq!(facts.triangles % 16, 0);
}

/// A body moved outward by r is as large as Steiner says: V + A r + M r² + 4/3 π r³, where M is half of the sum over the edges of
/// length times the angle that they turn by.
#[test]
fn a_shape_that_is_grown_is_as_large_as_steiner_says() {
    let tetrahedron = "[shape.a.polyhedron]\nsolid = \"tetrahedron\"\nedge = 1\n";
    let edge_turn = PI - acos(1.0 / 3.0);
    let root = |x: f64| x.sqrt();
    for (shape, [volume, area, bend]) in [
        (
            "[shape.a.box]\nsize = [1, 0.6, 0.8]\n",
            [0.48, 2.0 * (0.6 + 0.48 + 0.8), 4.0 * (1.0 + 0.6 + 0.8) * PI / 4.0],
        ),
        (tetrahedron, [1.0 / (6.0 * root(2.0)), root(3.0), 6.0 * edge_turn / 2.0]),
    ] {
        let r = 0.2;
        let text = format!(
            "tolerance = 0.04\n{shape}[shape.s.implicit]\nfield = {{ shape = {{ of = \"a\" }}, grow = {r} }}\nsearch = 0.05\n"
        );
        let baked = bake(&text);
        let facts = &baked.only().facts;
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
        let wanted = volume + area * r + bend * r * r + 4.0 / 3.0 * PI * r * r * r;
        let off = facts.volume.expect("closed") - wanted;
        assert!(off < 1e-6 && -off < 0.04 * facts.area, "{off} of {wanted}: {facts:?}");
    }
}

/// A cube comes back as its twelve triangles: edges of the shape are edges where the field is 0.
#[test]
fn edges_of_a_shape_stay_sharp() {
    let baked = bake(
        "[shape.a.box]\nsize = [1, 0.6, 0.8]\ncenter = [0, 1, 0]\n\
         [shape.s.implicit]\nfield = { shape = { of = \"a\" } }",
    );
    let facts = &baked.only().facts;
    assert_eq!((facts.triangles, facts.closed), (12, true), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 0.48, 1e-6);
}

/// A ball as a shape, blended with another: within the tolerance of the same made of simple bodies, and as smooth.
#[test]
fn a_round_shape_is_as_smooth_as_its_own_field() {
    let blended = |one: &str| {
        let text = format!(
            "tolerance = 0.01\n[shape.b.sphere]\nradius = 0.5\n[field.f.union]\nblend = 0.2\n\
             of = [{one}, {{ sphere = {{ radius = 0.3, center = [0.6, 0, 0] }} }}]\n\
             [shape.s.implicit]\nfield = \"f\"\n[node.n]\nshape = \"s\"\n"
        );
        bake(&text)
    };
    let (mesh, body) = (blended("{ shape = { of = \"b\" } }"), blended("{ sphere = { radius = 0.5 } }"));
    let volume = |baked: &super::Baked| baked.only().facts.volume.expect("closed");
    assert!((volume(&mesh) / volume(&body) - 1.0).abs() < 0.02, "{} {}", volume(&mesh), volume(&body));
    let own = mesh.glb.named("s");
    let (mut seen, mut worst) = (0, 1.0_f64);
    for ([x, y, z], [a, b, c]) in own.positions.iter().zip(&own.normals) {
        if *x < -0.1 {
            let length = (x * x + y * y + z * z).sqrt();
            worst = worst.min((x * a + y * b + z * c) / length);
            seen += 1;
        }
    }
    assert!(seen > 20 && worst > 0.9995, "{seen} {worst}");
}

/// Each body has its material where it is the nearest, and a hole that of what made it.
#[test]
fn bodies_of_a_field_have_materials_of_their_own() {
    let baked = bake(
        "tolerance = 0.02\n[shape.b.box]\nsize = [1, 1, 1]\n[field.f.difference]\nof = [\
         { union = { of = [{ shape = { of = \"b\" }, material = \"stone\" }, \
         { sphere = { radius = 0.4, center = [0, 0.6, 0] }, material = \"gold\" }] } }, \
         { cylinder = { radius = 0.2, height = 2 }, rotate = [90, 0, 0] }]\n\
         [shape.s.implicit]\nfield = \"f\"\nsearch = 0.05\n[shape.s]\nmaterial = \"soot\"\n\
         [material.stone]\n[material.gold]\n[material.soot]\n",
    );
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.genus == Some(1), "{facts:?}");
    assert_eq!(baked.only().primitives, 3);
}

//! Subdivision surfaces in the file: closed, on their limit, with what their cages carry.

use super::{Baked, assert_near, bake};

fn last(baked: &Baked) -> kiln::report::ShapeFacts {
    baked.report().shapes.last().expect("a shape").1.clone()
}

/// A cube of side 2 under Catmull-Clark: area and volume as the limit of `OpenSubdiv` has them, to four digits.
#[test]
fn a_cube_has_the_measures_of_its_limit() {
    let baked = bake("tolerance = 0.0005\n[shape.a.subdivide]\ncage = { box = { size = [2, 2, 2] } }");
    let shape = last(&baked);
    assert!(shape.facts.closed && shape.facts.manifold);
    assert_near(shape.facts.volume.expect("closed"), 2.620_414_96, 2e-3);
    assert_near(shape.facts.area, 9.197_582_21, 2e-3);
    assert!(shape.deviation.bound <= 0.0005, "{:?}", shape.deviation);
}

/// Every scheme keeps a closed cage closed and its genus, on the limit and beside it.
#[test]
fn closed_cages_stay_closed() {
    for scheme in ["catmull-clark", "loop", "sqrt3", "doo-sabin", "mid-edge", "butterfly", "bilinear"] {
        for limit in [true, false] {
            let text = format!(
                "[shape.ring]\nsegments = [8, 5]\n[shape.ring.torus]\nradius = 2\ntube-radius = 0.6\n[shape.a.subdivide]\ncage = \"ring\"\nscheme = \"{scheme}\"\nlevels = 2\nlimit = {limit}"
            );
            let shape = last(&bake(&text));
            assert!(shape.facts.closed && shape.facts.manifold, "{scheme} {limit}: {:?}", shape.facts);
            assert_eq!(shape.facts.euler, 0, "{scheme} {limit}");
        }
    }
}

#[test]
fn placements_of_the_cage_count() {
    let plain = last(&bake("[shape.a.subdivide]\ncage = { box = { size = [2, 2, 2] } }\nlevels = 4"));
    let placed = last(&bake(
        "[shape.die]\nat = [5, 0, 0]\nscale = 2\n[shape.die.box]\nsize = [1, 1, 1]\n[shape.a.subdivide]\ncage = \"die\"\nlevels = 4",
    ));
    let (one, other) = (plain.facts.volume.expect("closed"), placed.facts.volume.expect("closed"));
    assert_near(one, other, 1e-5);
}

/// Catmull-Clark over a square with sharp corners of its border is the square, and its texture coordinates are their places.
#[test]
fn texture_coordinates_are_carried() {
    let baked = bake(
        "[shape.a]\nuv = \"always\"\n[shape.a.subdivide]\nborder = \"corners\"\nlevels = 3\ncage = { mesh = { points = [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1]], faces = [[0, 1, 2, 3]], uvs = [[0, 0], [1, 0], [1, 1], [0, 1]] } }",
    );
    let primitive = &baked.glb.json["meshes"][0]["primitives"][0];
    let values = |name: &str| {
        let accessor =
            primitive["attributes"][name].as_u64().unwrap_or_else(|| panic!("{name}: {primitive}"));
        baked.glb.accessor(usize::try_from(accessor).expect("small"))
    };
    let (places, charts) = (values("POSITION"), values("TEXCOORD_0"));
    assert!(places.len() >= 81 && places.len() == charts.len());
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert!(places.iter().zip(&charts).all(|(place, chart)| near(place[0], chart[0])), "{charts:?}");
    // Written coordinates count up from the lower edge, those of a file down from the upper one.
    let v =
        |of: fn(f64) -> f64| places.iter().zip(&charts).all(|(place, chart)| near(of(place[2]), chart[1]));
    assert!(v(|z| -z) || v(|z| 1.0 + z), "{charts:?}");
}

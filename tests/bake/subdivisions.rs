//! Subdivision surfaces in the file: closed, on their limit, with what their cages carry.

use kiln::compile::Options;
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

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

/// A cube whose file has sharp edges and a sharp vertex: as if the document named them. The file numbers its vertices
/// otherwise than faces use them, and has one that none uses.
#[test]
fn creases_of_a_file_are_those_of_the_document() {
    let cube = "v 9 9 9\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                f 6 9 8 7\nf 2 3 4 5\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 9 5\nf 5 9 6 2\n";
    let tags = "t crease 5/4/0 1 2 3 4 1 2.5 2.5 2.5 2.5\nt crease 2/1/0 5 6 10\nt corner 1/1/0 7 1.5\n\
                t crease 2/1/0 0 1 4\nt interpolateboundary 1/0/0 2\nt crease 2/1/0 oops\n";
    let spec = |extra: &str| {
        format!("[shape.a.subdivide]\ncage = {{ import = {{ file = \"cube.obj\" }} }}\nlevels = 3\n{extra}")
    };
    let bake = |obj: &str, extra: &str| {
        let files = MemoryFiles::new().with("spec.toml", spec(extra)).with("cube.obj", obj);
        let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
        kiln::compile(&document, &files, &Options { name: "asset".to_owned(), ..Options::default() })
    };
    let whole = format!("{cube}{tags}");
    // In the order of faces: 6 9 8 7 2 3 4 5 of the file are 0 to 7 of the cage.
    let named = "creases = [{ edges = [[4, 5], [5, 6], [6, 7], [7, 4]], sharpness = 2.5 }, { edges = [[0, 3]], sharpness = \"sharp\" }]\n\
                 corners = [{ vertex = 2, sharpness = 1.5 }]";
    let own = bake(&whole, "creases = [{ imported = true }]").expect("it bakes");
    let by_name = bake(cube, named).expect("it bakes");
    assert_eq!(own.bytes, by_name.bytes);
    let smooth = bake(cube, "").expect("it bakes");
    assert_ne!(own.bytes, smooth.bytes, "the creases are seen");
    assert_eq!(bake(&whole, "").expect("it bakes").bytes, smooth.bytes, "nobody asked for them");
    let said = own.warnings.render(false);
    assert!(said.contains("tags other than") && said.contains("a tag is broken"), "{said}");
    let refused = bake(cube, "creases = [{ imported = true }]").expect_err("there are none").render(false);
    assert!(refused.contains("says of no edge and of no vertex"), "{refused}");
}

/// A die with sharp edges that are chosen, in a group: how many of its corners are smooth, darts, creases and corners.
fn classes(edges: &str, more: &str) -> [u32; 4] {
    let text = format!(
        "[shape.g.group]
of = [\"s\"]
[shape.s.subdivide]
cage = {{ mesh = {{ points = [[-1, -1, -1], [1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]], faces = [[0, 1, 2, 3], [7, 6, 5, 4], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]] }} }}
levels = 2
creases = [{{ edges = {edges} }}]
{more}
[node.n]
shape = \"g\"
"
    );
    let facts = bake(&text).report().cages["s"];
    [facts.smooth, facts.dart, facts.crease, facts.corner]
}

#[test]
fn the_report_counts_the_classes_of_the_vertices_of_a_cage() {
    assert_eq!(classes("[[0, 1]]", ""), [6, 2, 0, 0], "a crease of one edge ends at two darts");
    assert_eq!(classes("[[0, 1], [1, 2], [2, 3], [3, 0]]", ""), [4, 0, 4, 0], "a loop");
    assert_eq!(classes("[[0, 1], [1, 2], [1, 5]]", ""), [4, 3, 0, 1], "three edges meet at a corner");
    assert_eq!(classes("[[0, 1]]", "corners = [{ vertex = 6 }]"), [5, 2, 0, 1], "a sharp vertex");
}

//! Colors of vertices: where they come from, and that all that is done to a mesh carries them.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::geometry::number::srgb_to_linear;
use kiln::language::Document;
use kiln::language::source::MemoryFiles;
use kiln::packing::unpacked;

use super::glb::{Glb, Mesh};
use super::{bake, bake_with};

/// Every vertex of a mesh has the color of a law of its place, to within rounding of what lies between.
#[track_caller]
fn assert_colors(mesh: &Mesh, within: f64, law: impl Fn([f64; 3]) -> [f64; 3]) {
    let colors = mesh.colors.as_ref().expect("it has colors");
    assert_eq!(colors.len(), mesh.positions.len());
    for (place, color) in mesh.positions.iter().zip(colors) {
        for (found, expected) in color.iter().zip(law(*place)) {
            assert!((found - expected).abs() <= within, "{found} instead of {expected} at {place:?}");
        }
    }
}

#[test]
fn one_color_is_linear_light_and_what_is_white_has_none() {
    let baked = bake("[shape.a]\nvertex-color = \"#336699\"\n[shape.a.box]\nsize = [1, 1, 1]");
    let mesh = baked.glb.mesh(0);
    let expected = [0x33, 0x66, 0x99].map(|byte| srgb_to_linear(f64::from(byte) / 255.0));
    assert_colors(&mesh, 1e-7, |_| expected);
    assert!(mesh.colors.expect("it has colors").iter().all(|color| color.len() == 3), "opaque");
    let facts = baked.only().colors.expect("the report tells the range");
    assert_eq!(facts.min, facts.max);
    let clear = bake("[shape.a]\nvertex-color = [1, 1, 1, 0.5]\n[shape.a.box]\nsize = [1, 1, 1]");
    let colors = clear.glb.mesh(0).colors.expect("it has colors");
    assert!(colors.iter().all(|color| *color == [1.0, 1.0, 1.0, 0.5]));
    let white = bake("[shape.a]\nvertex-color = \"#ffffff\"\n[shape.a.box]\nsize = [1, 1, 1]");
    assert!(white.glb.mesh(0).colors.is_none() && white.only().colors.is_none());
}

#[test]
fn formulas_speak_of_places_before_they_are_moved_in_the_axes_of_the_document() {
    let law = "[shape.a.vertex-color]\nred = \"= x / 2 + 0.5\"\ngreen = \"= y\"\nblue = \"= 0.5 + nz / 2\"\n";
    let sphere = "[shape.a.sphere]\nradius = 1\ncenter = [0, 0.5, 0]\n";
    let plain = bake(&format!("tolerance = 0.02\n{law}{sphere}"));
    let mesh = plain.glb.mesh(0);
    assert_colors(&mesh, 1e-6, |[x, y, z]| [x / 2.0 + 0.5, y.clamp(0.0, 1.0), 0.5 + z / 2.0]);
    let moved = bake(&format!(
        "tolerance = 0.04\nup = \"z\"\n[shape.a]\nat = [5, 6, 7]\nscale = 2\nrotate = [0, 0, 90]\n{law}{sphere}"
    ));
    assert_colors(&moved.glb.mesh(0), 1e-5, |[x, up, back]| {
        // Of the document: z up, then back by place, turn and size.
        let (x, y, z) = (x - 5.0, -back - 6.0, up - 7.0);
        let (x, y, z) = (y / 2.0, -x / 2.0, z / 2.0);
        [x / 2.0 + 0.5, y.clamp(0.0, 1.0), 0.5 + z / 2.0]
    });
}

#[test]
fn colors_lie_evenly_along_their_scale() {
    let text = "[shape.a]\nsegments = [8, 1]\n[shape.a.vertex-color]\ncolors = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nby = \"= x\"\n[shape.a.plane]\nsize = [2, 2]";
    assert_colors(&bake(text).glb.mesh(0), 1e-6, |[x, ..]| {
        [(2.0 * x).clamp(0.0, 1.0), (2.0 * x - 1.0).clamp(0.0, 1.0), 0.0]
    });
}

#[test]
fn parts_keep_their_colors_under_that_of_the_whole() {
    let text = "[shape.a]\nvertex-color = [0.5, 0.5, 1]\n[shape.a.group]\nof = [\"left\", \"right\"]\n[shape.left]\nat = [-2, 0, 0]\nvertex-color = [1, 0.5, 0]\n[shape.left.box]\nsize = [1, 1, 1]\n[shape.right]\nat = [2, 0, 0]\n[shape.right.box]\nsize = [1, 1, 1]";
    let law = |[x, ..]: [f64; 3]| if x < 0.0 { [0.5, 0.25, 0.0] } else { [0.5, 0.5, 1.0] };
    assert_colors(&bake(text).glb.mesh(0), 1e-7, law);
}

/// A law that is linear is the same law at every vertex that an operation makes.
#[test]
fn colors_ride_through_solids_cuts_and_bends() {
    let ball = "tolerance = 0.02\n[shape.ball.vertex-color]\nred = \"= 0.5 + x / 4\"\ngreen = \"= 0.5 + y / 4\"\nblue = \"= 0.5 + z / 4\"\n[shape.ball.sphere]\nradius = 1\n[shape.block]\nvertex-color = [0, 0, 0]\n[shape.block.box]\nsize = [1, 3, 1]\n";
    let drilled = bake(&format!("{ball}[shape.a.difference]\nof = [\"ball\", \"block\"]"));
    let mesh = drilled.glb.named("a");
    let colors = mesh.colors.as_ref().expect("it has colors");
    let (mut inside, mut outside) = (0, 0);
    for (place, color) in mesh.positions.iter().zip(colors) {
        if color[..] == [0.0; 3] {
            inside += 1;
            assert!(place[0].abs().max(place[2].abs()) < 0.5 + 1e-6, "{place:?}");
            continue;
        }
        outside += 1;
        for (part, at) in color.iter().zip(place) {
            assert!((part - (0.5 + at / 4.0)).abs() < 1e-6, "{color:?} at {place:?}");
        }
    }
    assert!(inside >= 8 && outside > 100, "{inside} {outside}");

    let half = bake(&format!(
        "{ball}[shape.a.cut]\nof = \"ball\"\nplane = {{ point = [0, 0.3, 0], normal = [0.2, 1, 0] }}\ncap = false"
    ));
    assert_colors(&half.glb.named("a"), 1e-6, |place| place.map(|part| 0.5 + part / 4.0));

    // Places along the axis stay where they are, so green tells how the new vertices were colored.
    let twisted = bake(
        "tolerance = 0.002\n[shape.bar.vertex-color]\nred = 0\ngreen = \"= 0.5 + y / 4\"\nblue = 0\n[shape.bar.box]\nsize = [0.4, 2, 0.2]\n[shape.a.twist]\nof = \"bar\"\nangle = 180",
    );
    let mesh = twisted.glb.named("a");
    assert!(mesh.positions.len() > 100);
    assert_colors(&mesh, 1e-6, |[_, y, _]| [0.0, 0.5 + y / 4.0, 0.0]);
}

/// Points of a cage: a cube with corners at 1 and -1.
const CUBE: &str = "points = [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]]\nfaces = [[0,3,2,1],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]\n";

/// A cube whose colors are its points moved into the unit cube.
fn colored_cube() -> String {
    let corner = |k: usize| {
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
            [k]
    };
    let color = |k: usize| format!("{:?}", corner(k).map(|part| f64::from(part) * 0.5 + 0.5));
    format!("{CUBE}colors = [{}]\n", (0..8).map(color).collect::<Vec<_>>().join(", "))
}

/// Rules of subdivision are the same for places and colors: a color that is the place stays it.
#[test]
fn subdivision_moves_colors_as_it_moves_points() {
    let mesh = colored_cube();
    let law = |place: [f64; 3]| place.map(|part| (part * 0.5 + 0.5).clamp(0.0, 1.0));
    for (scheme, limit) in [
        ("catmull-clark", true),
        ("catmull-clark", false),
        ("loop", true),
        ("sqrt3", true),
        ("doo-sabin", true),
        ("doo-sabin", false),
        ("mid-edge", true),
        ("butterfly", true),
    ] {
        let text = format!(
            "[shape.cage.mesh]\n{mesh}[shape.a.subdivide]\ncage = \"cage\"\nscheme = \"{scheme}\"\nlevels = 2\nlimit = {limit}\n"
        );
        let text = if matches!(scheme, "loop" | "sqrt3" | "butterfly") {
            text + "triangulate = true\n"
        } else {
            text
        };
        assert_colors(&bake(&text).glb.named("a"), 1e-6, law);
    }
    // The law of a cage is that of its corners, and its faces stay quadrilaterals.
    let text = format!(
        "[shape.cage.vertex-color]\nred = \"= x / 2 + 0.5\"\ngreen = \"= y / 2 + 0.5\"\nblue = \"= z / 2 + 0.5\"\n[shape.cage.mesh]\n{CUBE}[shape.a.subdivide]\ncage = \"cage\"\nlevels = 2\n"
    );
    let baked = bake(&text);
    assert_colors(&baked.glb.named("a"), 1e-6, law);
    assert_eq!(baked.only().facts.triangles, 6 * 16 * 2);
}

/// A square of two triangles, one red and one blue: along its diagonal each point has two colors.
const TORN: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";

#[test]
fn colors_that_differ_across_an_edge_stay_apart_where_faces_keep_their_corners() {
    for (scheme, apart) in [("catmull-clark", true), ("loop", true), ("doo-sabin", false), ("sqrt3", false)] {
        let text = format!(
            "[shape.a.subdivide]\ncage = {{ import = {{ file = \"a.ply\" }} }}\nscheme = \"{scheme}\"\nlevels = 2\n"
        );
        let files = MemoryFiles::new().with("asset.toml", text).with("a.ply", TORN);
        let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
        let made =
            kiln::compile(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
        let mesh = Glb::new(&made.bytes).mesh(0);
        let colors = mesh.colors.expect("it has colors");
        assert!(
            colors.iter().all(|color| (color[0] + color[2] - 1.0).abs() < 1e-6 && color[1] == 0.0),
            "{scheme}"
        );
        assert_eq!(
            colors.iter().all(|color| color[0] == 0.0 || color[0] == 1.0),
            apart,
            "{scheme}: {colors:?}"
        );
    }
}

/// Levels that are cut anew, and those that lose triangles, whose vertices are vertices of the finest.
#[test]
fn levels_of_detail_have_the_colors_of_the_finest() {
    let law = "[shape.a.vertex-color]\nred = \"= 0.5 + x / 4\"\ngreen = \"= 0.5 + y / 4\"\nblue = \"= 0.5 + z / 4\"\n";
    let lump =
        colored_cube().replace("colors", "uvs = [[0,0],[1,0],[1,1],[0,1],[0,0],[1,0],[1,1],[0,1]]\ncolors");
    for (text, expected) in [
        (format!("tolerance = 0.002\n[lod]\nlevels = 3\n{law}[shape.a.sphere]\nradius = 1"), 0.25),
        (
            format!(
                "[lod]\ntolerances = [0.02]\n[shape.a.subdivide]\ncage = {{ mesh = {{ {} }} }}\nlevels = 4",
                lump.trim().replace('\n', ", ")
            ),
            0.5,
        ),
    ] {
        let baked = bake_with(&text, &Options { name: "asset".to_owned(), ..Options::default() });
        let meshes = baked.glb.list("meshes").len();
        assert!(meshes > 1, "{meshes} levels of {text}");
        for mesh in 0..meshes {
            assert_colors(&baked.glb.mesh(mesh), 1e-6, |place| {
                place.map(|part| (0.5 + part * expected).clamp(0.0, 1.0))
            });
        }
    }
}

fn files(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = MemoryFiles::new().with("asset.toml", text);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}"))
}

/// Whole numbers are the nearest ones, compressed or not; vertices that differ in color alone stay two.
#[test]
fn small_profiles_hold_bytes() {
    let text = "tolerance = 0.002\n[shape.a.vertex-color]\nred = \"= 0.5 + x / 4\"\ngreen = \"= 0.5 + y / 4\"\nblue = \"= 0.5 + z / 4\"\nalpha = \"= 0.75 + x / 4\"\n[shape.a.sphere]\nradius = 1";
    for file in files(text, &[Profile::Quantized, Profile::Web]) {
        let plain = unpacked(&file.bytes).expect("it was written so");
        let read = kiln::gltf::read(&plain).expect("it was written so");
        let colors = read.geometries[0].colors.expect("it has colors");
        assert!((colors.min[0] - 0.25).abs() < 0.003 && (colors.max[1] - 0.75).abs() < 0.003, "{colors:?}");
        assert_eq!((colors.min[3], colors.max[3]), (128.0 / 255.0, 1.0));
        let asset = kiln::preview::asset::read(&plain).unwrap_or_else(|error| panic!("{error}"));
        let part = &asset.meshes[0].parts[0];
        let grid = read.grid.expect("it has a grid");
        for (place, color) in part.positions.iter().zip(&part.colors) {
            for axis in 0..3 {
                let at = f64::from(place[axis]) * grid.step + grid.offset.to_array()[axis];
                let expected = 0.5 + at / 4.0;
                // Half a step of a byte, and half the tolerance for what the grid moved.
                assert!((f64::from(color[axis]) - expected).abs() < 0.5 / 255.0 + 0.001, "{color:?} at {at}");
            }
        }
    }
}

#[test]
fn lines_have_colors_too() {
    let text = "tolerance = 0.01\n[shape.a.vertex-color]\nred = \"= 0.5 + x / 2\"\ngreen = \"= 0.5 + z / 2\"\nblue = \"= nx + ny + nz\"\n[shape.a.wire]\ncurves = [{ circle = { radius = 1 } }]";
    let baked = bake(text);
    let lines = baked.glb.mesh(0).lines;
    let colors = lines.colors.expect("they have colors");
    for (place, color) in lines.positions.iter().zip(&colors) {
        assert!(
            (color[0] - (0.5 + place[0] / 2.0)).abs() < 1e-6 && color[2] == 0.0,
            "{color:?} at {place:?}"
        );
    }
    assert!(baked.only().colors.is_some());
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 51\n3 0 1 2\n";

#[test]
fn imported_points_bring_their_colors() {
    let files = MemoryFiles::new()
        .with("asset.toml", "[shape.a]\nvertex-color = [1, 0.5, 1]\n[shape.a.import]\nfile = \"a.ply\"")
        .with("a.ply", PLY);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let made =
        kiln::compile(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    assert!(made.warnings.is_empty(), "{}", made.warnings);
    let blue = srgb_to_linear(0.2);
    assert_colors(&Glb::new(&made.bytes).mesh(0), 1e-7, |[x, y, _]| [1.0 - x - y, x * 0.5, y * blue]);
}

#[test]
fn imported_gltf_files_bring_their_colors() {
    let law = "red = \"= 0.5 + x / 4\"\ngreen = \"= 0.5 + y / 4\"\nblue = \"= 0.5 + z / 4\"\n";
    let text = format!(
        "tolerance = 0.02\n[shape.a.vertex-color]\n{law}[shape.a.sphere]\nradius = 1\n[shape.b]\nat = [5, 0, 0]\n[shape.b.box]\nsize = [1, 1, 1]"
    );
    let first = bake(&text);
    let files = MemoryFiles::new()
        .with("asset.toml", "[shape.c.import]\nfile = \"a.glb\"")
        .with("a.glb", first.compiled.bytes.clone());
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let made =
        kiln::compile(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let law = |place: [f64; 3]| if place[0] > 2.0 { [1.0; 3] } else { place.map(|part| 0.5 + part / 4.0) };
    assert_colors(&Glb::new(&made.bytes).mesh(0), 1e-6, law);
}

//! Height maps: closed, of the volume of their field, the same whatever file they come from, seamless as tiles.

use kiln::compile::Options;
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

use super::glb::Glb;
use super::{Baked, assert_near, bake};

fn bake_beside(text: &str, files: MemoryFiles) -> Baked {
    let files = files.with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let options = Options { name: "asset".to_owned(), measure: true, ..Options::default() };
    let compiled =
        kiln::compile(&document, &files, &options).unwrap_or_else(|found| panic!("{found}\n{text}"));
    Baked { glb: Glb::new(&compiled.bytes), compiled }
}

/// A field with the integral of a closed form: x^2 y over the unit square, by a spline, which reproduces cubics.
const CUBIC: &str = "[map.m]
interpolation = \"bicubic\"
[map.m.formula]
f = \"= x ^ 2 * y\"
columns = 9
rows = 7
";

#[test]
fn a_closed_map_has_the_volume_of_its_field() {
    for tolerance in ["0.01", "0.001", "0.0001"] {
        let text = format!(
            "tolerance = {tolerance}\n{CUBIC}[shape.a.height-map]\nmap = \"m\"\nsize = [2, 3]\nrange = [1, 2]\nclose = \"base\""
        );
        let baked = bake(&text);
        let facts = baked.only();
        assert!(facts.facts.closed);
        assert_eq!(facts.facts.genus, Some(0));
        let volume = facts.facts.volume.expect("closed");
        let tolerance: f64 = tolerance.parse().unwrap();
        // The integral of 1 + x^2 y over the unit square is 7/6.
        assert!((volume - 7.0).abs() <= 1e-6 * 7.0 + tolerance * 6.0, "{volume}");
        let deviation = &facts.deviation;
        assert!(
            deviation.bound <= tolerance && deviation.measured.is_some_and(|found| found <= deviation.bound)
        );
    }
}

#[test]
fn a_thick_map_has_the_volume_of_a_plate() {
    let text = format!(
        "tolerance = 0.001\n{CUBIC}[shape.a.height-map]\nmap = \"m\"\nsize = [2, 3]\nclose = \"thickness\"\ndepth = 0.25"
    );
    let baked = bake(&text);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.genus == Some(0));
    assert_near(facts.volume.expect("closed"), 1.5, 1e-6);
}

#[test]
fn one_grid_from_four_kinds_of_file_is_one_mesh() {
    let numbers = [3_u8, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8];
    let rows: Vec<String> = numbers.chunks(4).map(|row| format!("{row:?}")).collect();
    let words: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    let asc = format!("ncols 4\nnrows 3\ncellsize 30\n{}\n", words.join(" "));
    let raw: Vec<u8> = numbers.iter().flat_map(|number| f32::from(*number).to_le_bytes()).collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 4, 3);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let pixels: Vec<u8> = numbers.iter().flat_map(|number| u16::from(*number).to_be_bytes()).collect();
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    let files = || {
        let files = MemoryFiles::new().with("a.asc", asc.as_str()).with("a.raw", raw.as_slice());
        files.with("a.png", png.as_slice())
    };
    let kinds = [
        (format!("grid = {{ rows = [{}] }}", rows.join(", ")), "[0, 1]"),
        ("grid = { file = \"a.asc\" }".to_owned(), "[0, 1]"),
        ("raw = { file = \"a.raw\", columns = 4, rows = 3, number = \"f32\" }".to_owned(), "[0, 1]"),
        ("image = { file = \"a.png\" }".to_owned(), "[0, 65535]"),
    ];
    let baked: Vec<Baked> = kinds
        .iter()
        .map(|(kind, range)| {
            let text = format!(
                "tolerance = 0.01\n[shape.a.height-map]\nmap = {{ {kind} }}\nsize = [3, 2]\nrange = {range}\nclose = \"base\""
            );
            bake_beside(&text, files())
        })
        .collect();
    for other in &baked[1..] {
        assert_eq!(other.compiled.bytes, baked[0].compiled.bytes);
    }
    let bounds = baked[0].only().facts.bounds.expect("points");
    assert_eq!((bounds.min, bounds.max), ([-1.5, 0.0, -1.0], [1.5, 9.0, 1.0]));
}

#[test]
fn tiles_meet_to_the_last_bit() {
    let tile = |from: f64, at: f64| {
        format!(
            "[map.m]\ninterpolation = \"bicubic\"\n[map.m.formula]\nf = \"= sin(x * 200) * cos(y * 170) + 0.2 * noise(3, x * 9, y * 9)\"\n\
             from = [{from}, 0]\nto = [{}, 1]\ncolumns = 33\nrows = 33\n[shape.a]\nat = [{at}, 0, 0]\ntolerance = 0.01\n\
             [shape.a.height-map]\nmap = \"m\"\nsize = [4, 4]",
            from + 1.0
        )
    };
    let border = |text: &str, x: f64| {
        let baked = bake(text);
        let mesh = &baked.glb.mesh(0);
        let mut points: Vec<[u64; 3]> = mesh
            .positions
            .iter()
            .filter(|point| point[0] == x)
            .map(|point| point.map(f64::to_bits))
            .collect();
        points.sort_unstable();
        points.dedup();
        points
    };
    let (left, right) = (border(&tile(0.0, 6.0), 8.0), border(&tile(1.0, 10.0), 8.0));
    assert!(left.len() > 8);
    assert_eq!(left, right);
}

#[test]
fn where_the_ground_is_flat_there_are_few_triangles() {
    let text = "tolerance = 0.001\n[shape.a.height-map]\nmap = { formula = { f = \"= max(0, x - 0.75)\", columns = 65, rows = 65 } }\nsize = [1, 1]";
    assert_eq!(bake(text).only().facts.triangles, 4);
}

#[test]
fn dense_maps_keep_every_sample() {
    let text = "[shape.a.height-map]\nmap = { noise = { columns = 20, rows = 13 } }\nsize = [1, 1]\nbound = \"dense\"";
    let baked = bake(text);
    assert_eq!(baked.only().facts.triangles, 2 * 19 * 12);
    assert_eq!(baked.only().deviation.tolerance, None);
}

/// Real ground: the elevation grid of the Jacksboro fault, from a folder outside of the repository.
#[test]
#[expect(clippy::print_stdout, reason = "a test that does not run must say so")]
fn real_ground_within_its_tolerance() {
    use std::io::Read as _;
    let Some(folder) = std::env::var_os("KILN_CASES") else {
        println!("KILN_CASES is not set: real ground not tried");
        return;
    };
    let packed = std::fs::read(std::path::Path::new(&folder).join("height/jacksboro_fault.asc.gz"))
        .expect("it is there");
    let mut grid = String::new();
    flate2::read::GzDecoder::new(packed.as_slice()).read_to_string(&mut grid).expect("text");
    let files = MemoryFiles::new().with("ground.asc", grid);
    let text = "tolerance = 20\n[shape.a.height-map]\nmap = { grid = { file = \"ground.asc\" } }\nsize = [30, 30]\nclose = \"base\"";
    let baked = bake_beside(text, files);
    let facts = baked.only();
    assert!(facts.facts.closed && facts.deviation.bound <= 20.0);
    assert!(facts.facts.triangles < 344 * 403 / 2);
    assert!(facts.deviation.measured.is_some_and(|found| found <= facts.deviation.bound));
}

/// Edges of the only mesh that have no other side and lie inside of the rectangle.
fn inner_rim(baked: &Baked, half: [f64; 2]) -> std::collections::BTreeSet<[[u64; 3]; 2]> {
    let mesh = &baked.glb.mesh(0);
    let key = |at: usize| mesh.positions[at].map(f64::to_bits);
    let mut sides = std::collections::BTreeSet::new();
    for triangle in &mesh.triangles {
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            sides.insert([key(triangle[from]), key(triangle[to])]);
        }
    }
    let on_border = |side: &[[u64; 3]; 2]| {
        [(0, half[0]), (2, half[1])].into_iter().any(|(axis, at)| {
            let [a, b] = side.map(|end| f64::from_bits(end[axis]));
            a.abs() == at && a == b
        })
    };
    let open = sides.iter().filter(|[a, b]| !sides.contains(&[*b, *a])).filter(|side| !on_border(side));
    open.map(|[a, b]| if a < b { [*a, *b] } else { [*b, *a] }).collect()
}

#[test]
fn complementary_masks_share_their_line_to_the_last_bit() {
    for kind in ["bilinear", "bicubic"] {
        let half = |side: &str, close: &str| {
            format!(
                "tolerance = 0.003\n[map.m.noise]\ncolumns = 40\nrows = 30\nhills = [3, 2]\n\
                 [map.lake]\ninterpolation = \"{kind}\"\n[map.lake.noise]\nseed = 5\ncolumns = 33\nrows = 21\n\
                 [shape.a.height-map]\nmap = \"m\"\nsize = [2, 1.5]\nrange = [0, 0.3]\n{close}\n\
                 mask = [{{ map = \"lake\", {side} = 0.05 }}]"
            )
        };
        let (above, below) = (bake(&half("at-least", "")), bake(&half("at-most", "")));
        let (one, other) = (inner_rim(&above, [1.0, 0.75]), inner_rim(&below, [1.0, 0.75]));
        assert!(one.len() > 40);
        assert_eq!(one, other);
        let close = "close = \"base\"\nbase = -1";
        let solids = [bake(&half("at-least", close)), bake(&half("at-most", close))];
        for solid in &solids {
            assert!(solid.only().facts.closed && solid.only().facts.manifold);
        }
        let whole = bake(&half("at-least", close).replace("at-least = 0.05", "at-least = -9"));
        let volumes =
            [&solids[0], &solids[1], &whole].map(|baked| baked.only().facts.volume.expect("closed"));
        // Both halves and the whole are within the tolerance of the field, over the area of 3.
        assert!((volumes[0] + volumes[1] - volumes[2]).abs() < 0.003 * 3.0, "{volumes:?}");
    }
}

/// Real ground with cells that have no value: every known cell is there and no other.
#[test]
#[expect(clippy::print_stdout, reason = "a test that does not run must say so")]
fn real_ground_with_gaps_keeps_its_known_cells() {
    let Some(folder) = std::env::var_os("KILN_CASES") else {
        println!("KILN_CASES is not set: real ground with gaps not tried");
        return;
    };
    let grid = std::fs::read_to_string(std::path::Path::new(&folder).join("height/hugo_site.asc"))
        .expect("it is there");
    let numbers: Vec<f64> = grid
        .lines()
        .filter(|line| !line.starts_with(|c: char| c.is_ascii_alphabetic()))
        .flat_map(|line| line.split_ascii_whitespace().map(|word| word.parse().expect("a number")))
        .collect();
    let (columns, rows) = (76, 55);
    assert_eq!(numbers.len(), columns * rows);
    let known = |i: usize, j: usize| {
        [(0, 0), (1, 0), (0, 1), (1, 1)]
            .iter()
            .all(|(di, dj)| numbers[(j + dj) * columns + i + di] != -9999.0)
    };
    let cells = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| (i, j)));
    let area = cells.filter(|(i, j)| known(*i, *j)).count();
    for kind in ["bilinear", "bicubic"] {
        let text = format!(
            "tolerance = 0.5\n[map.m]\nno-data = \"marked\"\ninterpolation = \"{kind}\"\n\
             [map.m.grid]\nfile = \"ground.asc\"\n\
             [shape.a.height-map]\nmap = \"m\"\nsize = [75, 54]\nclose = \"thickness\"\ndepth = 2"
        );
        let baked = bake_beside(&text, MemoryFiles::new().with("ground.asc", grid.as_str()));
        let facts = &baked.only().facts;
        assert!(facts.closed && facts.manifold);
        // A plate of one depth has the volume of what it covers; corners that touch are joined by a hair.
        let volume = facts.volume.expect("closed");
        assert!((volume - 2.0 * area as f64).abs() < 1e-3 * area as f64, "{volume} {area}");
    }
}

#[test]
fn a_split_body_is_one_skin() {
    // Half balls of 0.5 around the plane, cut where they end: with the plane z = 0 and seen from the back as well.
    let ball = "[map.m]\ninterpolation = \"bicubic\"\n[map.m.formula]\nf = \"= 0.5 - x ^ 2 - y ^ 2\"\nfrom = [-1, -1]\nto = [1, 1]\ncolumns = 9\nrows = 9\n";
    let body = |parts: &str| {
        format!(
            "tolerance = 0.002\n{ball}[shape.a.split]\nsize = [2, 2]\nmask = [{{ map = \"m\", at-least = 0 }}]\npart = [{parts}]"
        )
    };
    let half = core::f64::consts::PI / 8.0;
    let front = "{ map = \"m\", normal = [0, 0, 1] }";
    let back = "{ map = \"m\", normal = [0, 0, -1], mirror = true }";
    for (parts, halves) in [(front.to_owned(), 1.0), (format!("{front}, {back}"), 2.0)] {
        let baked = bake(&body(&parts));
        let facts = &baked.only().facts;
        assert!(facts.closed && facts.manifold && facts.components == 1);
        assert_near(facts.volume.expect("closed"), halves * half, 0.005);
        let deviation = &baked.only().deviation;
        assert!(deviation.bound <= 0.002 && deviation.measured.is_some_and(|found| found <= deviation.bound));
    }
    // A part that is apart, and one that reaches into the first.
    let apart = bake(&body(&format!("{front}, {back}, {{ map = \"m\", point = [0, 2, 0] }}")));
    assert_eq!((apart.only().facts.components, apart.only().facts.closed), (2, true));
    let joined = bake(&body(&format!("{front}, {{ map = \"m\", point = [0, -0.2, 0.1] }}")));
    let facts = &joined.only().facts;
    assert!(facts.closed && facts.components == 1);
    assert!(facts.volume.is_some_and(|volume| volume > half && volume < 2.0 * half));
}

#[test]
fn parts_of_a_split_body_may_have_other_grids() {
    let side = |columns: u32, rows: u32, kind: &str, normal: &str| {
        format!(
            "{{ map = {{ interpolation = \"{kind}\", formula = {{ f = \"= 1 + x * y\", columns = {columns}, rows = {rows} }} }}, normal = {normal} }}"
        )
    };
    for kind in ["bilinear", "bicubic"] {
        let text = format!(
            "tolerance = 0.001\n[shape.a.split]\nsize = [2, 3]\npart = [{}, {}]",
            side(7, 5, kind, "[0, 1, 0]"),
            side(10, 4, kind, "[0, -1, 0]")
        );
        let baked = bake(&text);
        let facts = &baked.only().facts;
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{kind}");
        // Twice the integral of 1 + x y over the unit square, which both grids hold exactly.
        assert_near(facts.volume.expect("closed"), 2.0 * 1.25 * 6.0, 0.012);
    }
}

#[test]
fn parts_of_a_split_body_have_operations() {
    let even = |height: f64, rest: &str| {
        format!("{{ map = {{ grid = {{ rows = [[{height}, {height}], [{height}, {height}]] }} }}{rest} }}")
    };
    for (operation, exact) in [("union", 4.0 + 1.0), ("difference", 4.0 - 1.0), ("intersection", 1.0)] {
        // A plate of 2 x 2 x 1 and one of 2 x 2 x 1/2 that stands on its side in the middle: half of it is inside.
        let text = format!(
            "[shape.a.split]\nsize = [2, 2]\npart = [{}, {}]",
            even(1.0, ""),
            even(0.5, &format!(", normal = [1, 0, 0], operation = \"{operation}\""))
        );
        let baked = bake(&text);
        let facts = &baked.only().facts;
        assert!(facts.closed, "{operation}");
        assert_near(facts.volume.expect("closed"), exact, 1e-6);
    }
}

//! Files of other programs against what other programs say of them.
//!
//! The files lie outside the repository, in the folder that the variable `KILN_CASES` names; without it these tests
//! print how many files were not tried.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use kiln::geometry::mesh::convert::{ConvertOptions, Converted, convert};
use kiln::geometry::mesh::topology::{self, Topology};
use kiln::geometry::mesh::triangulate::triangulate_anyway;
use kiln::geometry::mesh::weld::weld_equal;
use kiln::geometry::planar::regions;
use kiln::import::image::ImageError;
use kiln::import::{ImportError, ImportOptions, Imported, image, obj, stl};
use kiln::report::facts::vertex_cache;
use serde_json::Value;

/// The folder of cases, or a line that says how many are not run.
#[expect(clippy::print_stdout, reason = "a test that does not run must say so")]
pub(crate) fn cases(count: usize, what: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("KILN_CASES").map(PathBuf::from);
    if folder.is_none() {
        println!("KILN_CASES is not set: {count} {what} not tried");
    }
    folder
}

/// Bytes of a case; names that end in `.gz` are unpacked.
fn bytes_of(path: &Path) -> Vec<u8> {
    let raw = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    if path.extension().is_none_or(|extension| extension != "gz") {
        return raw;
    }
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(raw.as_slice()).read_to_end(&mut bytes).expect("gzip data");
    bytes
}

pub(crate) fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&bytes_of(path)).expect("JSON")
}

/// Files of a folder in the order of their names.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

fn read(name: &str, bytes: &[u8]) -> Result<Imported, ImportError> {
    let options = ImportOptions::default();
    if name.to_lowercase().contains(".stl") {
        stl::read(bytes, &options)
    } else {
        obj::read(bytes, &options, &mut |_| None)
    }
}

/// The message with its place, as a diagnostic shows it.
fn told(error: &ImportError) -> String {
    error.line().map_or_else(|| error.to_string(), |line| format!("line {line}: {error}"))
}

/// A triangle mesh by position, as other tools see it.
struct Soup {
    corners: Vec<[DVec3; 3]>,
    topology: Topology,
}

impl Soup {
    fn of(converted: &Converted) -> Self {
        let mesh = &converted.mesh;
        let places = weld_equal(&mesh.points).map;
        let point = |corner: usize| mesh.vertices[mesh.triangles[corner / 3][corner % 3].subscript()].point;
        let topology = topology::measure(mesh.triangles.len(), mesh.points.len(), |corner| {
            places[point(corner).subscript()]
        })
        .expect("small");
        let corners = (0..mesh.triangles.len())
            .map(|triangle| [0, 1, 2].map(|side| mesh.points[point(3 * triangle + side).subscript()]))
            .collect();
        Self { corners, topology }
    }

    fn area(&self) -> f64 {
        self.corners.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).length() / 2.0).sum()
    }

    fn volume(&self) -> f64 {
        let origin = self.corners[0][0];
        let six_fold = |[a, b, c]: &[DVec3; 3]| (*a - origin).cross(*b - origin).dot(*c - origin);
        self.corners.iter().map(six_fold).sum::<f64>() / 6.0
    }
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

/// Files with concave faces and keyholes: a plain fan, which other tools make of them, folds over and leaves edges that
/// do not exist. Ours are an annulus and a closed wall.
const CUT_MATTERS: [&str; 2] = ["obj/assimp_concave_polygon.obj", "obj/wallhole.obj"];

/// A clipping box as large as single precision goes, which breaks the merging of the reference.
const TOO_LARGE_FOR_THE_REFERENCE: &str = "csg/Cray_right.obj";

#[test]
fn imported_meshes_have_the_facts_that_trimesh_finds() {
    let Some(folder) = cases(60, "OBJ and STL files") else { return };
    let facts = json_of(&folder.join("mesh/import_facts.json.gz"));
    let files = facts["files"].as_object().expect("an object");
    let mut faults = Vec::new();
    let mut compared = 0;
    for (name, expected) in files {
        let read = read(name, &bytes_of(&folder.join(name)));
        if expected.get("triangles").is_none() {
            assert!(read.is_err(), "{name} has nothing to read and was read");
            continue;
        }
        let mesh = read.unwrap_or_else(|error| panic!("{name}: {error}")).mesh;
        let converted =
            convert(&mesh, &ConvertOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        if name == TOO_LARGE_FOR_THE_REFERENCE {
            assert!(Soup::of(&converted).topology.manifold);
            continue;
        }
        compare(name, expected, &converted, &mut faults);
        compared += 1;
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    assert!(compared >= 50, "only {compared} files compared");
}

fn compare(name: &str, expected: &Value, converted: &Converted, faults: &mut Vec<String>) {
    let soup = Soup::of(converted);
    let mut check = |what: &str, ours: f64, theirs: f64, relative: f64| {
        if !near(ours, theirs, relative) {
            faults.push(format!("{name}: {what} is {ours}, expected {theirs}"));
        }
    };
    let number = |key: &str| expected[key].as_f64();
    let found = &soup.topology;
    let count = |count: u64| count as f64;
    let degenerate = soup.corners.iter().filter(|[a, b, c]| a == b || b == c || c == a).count();
    assert_eq!(degenerate, 0, "{name}: triangles without three positions are dropped");
    // Their triangles on fewer than three positions stay; ours are gone.
    let dropped = number("triangles").expect("a number") - count(found.triangles);
    assert!(dropped >= 0.0, "{name}");
    if dropped == 0.0 {
        check("points", count(found.points), number("merged_vertices").expect("a number"), 0.0);
    }
    if dropped == 0.0 && !CUT_MATTERS.contains(&name) {
        check("euler", found.euler as f64, number("euler").expect("a number"), 0.0);
        let watertight = found.boundary_edges == 0 && found.crowded_edges == 0;
        let theirs = expected["watertight"].as_bool().expect("a flag");
        check("watertight", f64::from(watertight), f64::from(theirs), 0.0);
        if theirs {
            let consistent = found.misoriented_edges == 0;
            check(
                "winding",
                f64::from(consistent),
                f64::from(expected["winding_consistent"].as_bool().expect("a flag")),
                0.0,
            );
            check("bodies", count(found.components), number("bodies").expect("a number"), 0.0);
        }
    }
    if !CUT_MATTERS.contains(&name) {
        check("area", soup.area(), number("area").expect("a number"), 1e-9);
    }
    // Where neighbours disagree, trimesh turns them around before it measures.
    if let Some(volume) = number("volume").filter(|_| expected["winding_consistent"] == true) {
        check("volume", soup.volume(), volume, 1e-9);
    }
    let bounds = converted.mesh.bounds();
    for axis in 0..3 {
        let theirs = [0, 1].map(|end| expected["bounds"][end][axis].as_f64().expect("a number"));
        // The reference is rounded to six decimals.
        let slack = 1e-6 + 1e-9 * theirs[0].abs().max(theirs[1].abs());
        let ours = [bounds.min[axis], bounds.max[axis]];
        assert!(
            (0..2).all(|end| (ours[end] - theirs[end]).abs() <= slack),
            "{name}: {bounds:?} against {theirs:?}"
        );
    }
}

/// Angle-weighted normals of whole meshes, and edges that pass an angle.
#[test]
fn smooth_normals_are_those_of_trimesh() {
    let Some(folder) = cases(60, "meshes with normals") else { return };
    let facts = json_of(&folder.join("mesh/import_facts.json.gz"));
    let mut compared = 0;
    for (name, expected) in facts["files"].as_object().expect("an object") {
        let Some(normals) = expected["smooth_normals"].as_array() else { continue };
        // A merged point may stand on parts that only touch there; one normal for all is then not ours.
        if expected["watertight"] != true || expected["winding_consistent"] != true {
            continue;
        }
        let Ok(mut read) = read(name, &bytes_of(&folder.join(name))) else { continue };
        read.mesh.weld(0.0);
        let options = ConvertOptions {
            shading: kiln::geometry::mesh::convert::Shading::Smooth,
            ..ConvertOptions::default()
        };
        let mesh = convert(&read.mesh, &options).expect("valid").mesh;
        for entry in normals {
            let vector = |value: &Value| {
                Some(DVec3::from_array([value[0].as_f64()?, value[1].as_f64()?, value[2].as_f64()?]))
            };
            let (Some(at), Some(expected)) = (vector(&entry["at"]), vector(&entry["angle_weighted"])) else {
                continue;
            };
            let here: Vec<DVec3> = mesh
                .vertices
                .iter()
                .filter(|vertex| {
                    (mesh.points[vertex.point.subscript()] - at).abs().max_element() <= 1e-4 * at.length()
                })
                .map(|vertex| vertex.normal)
                .collect();
            if let [normal] = here[..] {
                assert!((normal - expected).length() < 2e-3, "{name} at {at}: {normal} against {expected}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 80, "only {compared} normals compared");
}

#[test]
fn hostile_and_broken_meshes_are_refused_or_read_safely() {
    let Some(folder) = cases(14, "hostile OBJ and STL files") else { return };
    let expected: BTreeMap<&str, Option<&str>> = BTreeMap::from([
        ("index_huge.obj", Some("line 5: vertex 99999999999999999999 does not exist; the file has 4")),
        ("index_zero.obj", Some("line 5: index 0 in `0`; indices count from 1")),
        ("nan_vertex.obj", Some("line 1: `nan` is not a finite number")),
        ("negative_too_far.obj", Some("line 5: vertex -9 does not exist; only 4 come before it")),
        ("nul_bytes.obj", Some("line 5: this is not text: it holds byte 0x00")),
        ("path_traversal.obj", None),
        ("utf8_bom.obj", None),
        ("malformed.obj", Some("line 28: index 0 in `0`; indices count from 1")),
        ("ascii_two_vertices.stl", Some("line 6: expected vertex, found `endloop`")),
        ("binary_named_solid.stl", None),
        ("count_4g.stl", Some("the file says it holds 4294967295 triangles, but there is room for only 1")),
        ("nan_vertex.stl", Some("facet 1 has a coordinate that is not a finite number: NaN")),
        ("short_header.stl", Some("the file has 60 bytes; a binary STL file has at least 84")),
    ]);
    let mut tried = 0;
    for file in ["hostile/obj", "hostile/stl", "obj/bad"].iter().flat_map(|part| files_in(&folder.join(part)))
    {
        let name = file.file_name().expect("a name").to_string_lossy().into_owned();
        let result = read(&name, &bytes_of(&file));
        let message = result.as_ref().err().map(told);
        let known =
            expected.get(name.as_str()).unwrap_or_else(|| panic!("{name} is not in the list: {message:?}"));
        assert_eq!(message.as_deref(), *known, "{name}");
        if let Ok(imported) = result {
            assert_eq!(imported.mesh.validate(), Ok(()), "{name}");
            assert_eq!(imported.mesh.faces.len(), 1, "{name}");
        }
        tried += 1;
    }
    assert_eq!(tried, expected.len());
}

#[test]
fn a_library_outside_the_folder_is_never_asked_for() {
    let Some(folder) = cases(1, "OBJ file") else { return };
    let bytes = bytes_of(&folder.join("hostile/obj/path_traversal.obj"));
    let read =
        obj::read(&bytes, &ImportOptions::default(), &mut |path| panic!("asked for {path}")).expect("read");
    assert!(read.notes.iter().any(|note| note.message.contains("outside the folder")));
}

/// The corpus lists rings without saying which hole lies in which; outer rings run counter-clockwise. Number and area
/// are those of its publisher for every set, and no triangle is turned over by more than the tolerance stated there
/// but in the sets that cross themselves by more.
#[test]
fn polygons_of_the_corpus() {
    let Some(folder) = cases(50, "polygon sets") else { return };
    let corpus = json_of(&folder.join("csg/polygon_corpus.json.gz"));
    let (mut exact, mut folded) = (0, Vec::new());
    for entry in corpus["entries"].as_array().expect("a list") {
        let name = entry["name"].as_str().expect("a name");
        let number = |key: &str| entry[key].as_f64().expect("a number");
        let loops = loops_of(entry);
        let slices: Vec<&[DVec2]> = loops.iter().map(Vec::as_slice).collect();
        let regions = regions(&slices);
        assert!(regions.stray.is_empty(), "{name}: {regions:?}");
        let (mut count, mut area, mut turned, mut all) = (0, 0.0, 0.0_f64, true);
        for face in &regions.faces {
            let rings: Vec<&[DVec2]> = face.iter().map(|ring| slices[*ring]).collect();
            let points: Vec<DVec2> = rings.concat();
            let (triangles, found) = triangulate_anyway(&rings).expect("corners are many and finite");
            all &= found;
            count += triangles.len();
            for t in triangles {
                let [a, b, c] = t.map(|corner| points[corner as usize]);
                let twice = (b - a).perp_dot(c - a);
                area += twice / 2.0;
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                turned = turned.max(-twice / longest.max(f64::MIN_POSITIVE));
            }
        }
        let reach =
            loops.concat().iter().fold(0.0, |reach, point| f64::max(reach, point.abs().max_element()));
        assert_eq!(count as f64, number("triangles"), "{name}");
        let expected = number("signed_area");
        assert!((area - expected).abs() <= 1e-12 * reach * reach, "{name}: area {area}, expected {expected}");
        exact += usize::from(all);
        if turned > number("epsilon").max(1e-12 * reach) {
            folded.push(name.to_owned());
        }
    }
    // The others have edges that cross, loops without area, or outlines around which they wind twice.
    assert_eq!((exact, folded), (35, Vec::<String>::new()));
}

pub(crate) fn loops_of(entry: &Value) -> Vec<Vec<DVec2>> {
    let point = |p: &Value| DVec2::new(p[0].as_f64().expect("x"), p[1].as_f64().expect("y"));
    let ring = |ring: &Value| ring.as_array().expect("points").iter().map(point).collect();
    entry["polygons"].as_array().expect("rings").iter().map(ring).collect()
}

#[test]
fn good_pictures_are_accepted() {
    let Some(folder) = cases(160, "PNG files") else { return };
    let mut tried = 0;
    for file in files_in(&folder.join("png/valid")) {
        if file.extension().is_some_and(|extension| extension == "png") {
            let facts = image::read(&bytes_of(&file), 1 << 28)
                .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            assert!(facts.width > 0 && facts.height > 0);
            tried += 1;
        }
    }
    assert!(tried >= 60, "only {tried} pictures");
}

#[test]
fn broken_pictures_are_refused_or_decoded_safely() {
    let Some(folder) = cases(30, "broken PNG files") else { return };
    let mut refused = Vec::new();
    for file in ["png/bad", "hostile/png"].iter().flat_map(|part| files_in(&folder.join(part))) {
        let name = file.file_name().expect("a name").to_string_lossy().into_owned();
        if let Err(error) = image::read(&bytes_of(&file), 1 << 28) {
            assert!(!error.to_string().is_empty() && error.hint().is_some());
            if name.starts_with("bomb") || name.starts_with("dims_2147") {
                assert!(matches!(error, ImageError::TooLarge { .. }), "{name}: {error}");
            }
            refused.push(name);
        }
    }
    let must = |name: &&str| !refused.iter().any(|refused| refused == name);
    let named = [
        "xc1n0g08.png",
        "xcrn0g04.png",
        "xd0n2c08.png",
        "xd9n2c08.png",
        "xhdn0g08.png",
        "xs1n0g01.png",
        "xs4n0g01.png",
        "bomb_25000sq_1bit.png",
        "dims_2147483647_sq.png",
        "dims_zero.png",
        "palette_missing.png",
        "short_data.png",
        "truncated_mid_idat.png",
    ];
    let accepted: Vec<&str> = named.into_iter().filter(must).collect();
    assert!(accepted.is_empty(), "accepted: {accepted:?}");
}

#[test]
fn cache_figures_are_those_of_meshoptimizer() {
    let Some(folder) = cases(7, "index buffers") else { return };
    let references = json_of(&folder.join("mesh/vertex_cache_refs.json"));
    let mut compared = 0;
    for (name, expected) in references["meshes"].as_object().expect("an object") {
        let indices = if let Some(size) = name.strip_prefix("grid:") {
            grid(size.parse().expect("a number"))
        } else {
            let path = ["", ".gz"].map(|end| folder.join(format!("obj/{name}{end}")));
            let bytes = bytes_of(path.iter().find(|path| path.exists()).expect("the file"));
            position_indices(&String::from_utf8(bytes).expect("text"))
        };
        let vertices = indices.iter().max().map_or(0, |&most| most as usize + 1);
        let figures = vertex_cache(&indices, vertices);
        let reference = &expected["input_order"];
        assert!(
            (figures.acmr - reference["acmr16"].as_f64().expect("a number")).abs() < 1e-5,
            "{name}: {figures:?}"
        );
        assert!(
            (figures.atvr - reference["atvr16"].as_f64().expect("a number")).abs() < 1e-5,
            "{name}: {figures:?}"
        );
        compared += 1;
    }
    assert_eq!(compared, 7);
}

fn grid(n: u32) -> Vec<u32> {
    let corners = |cell: u32| {
        let a = cell / n * (n + 1) + cell % n;
        [a, a + 1, a + n + 2, a, a + n + 2, a + n + 1]
    };
    (0..n * n).flat_map(corners).collect()
}

/// Position indices of an OBJ text in the order of the file, polygons as fans.
fn position_indices(text: &str) -> Vec<u32> {
    let corner = |word: &str| word.split('/').next().expect("a part").parse::<u32>().expect("an index") - 1;
    let mut indices = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("f ")) {
        let face: Vec<u32> = line.split_whitespace().skip(1).map(corner).collect();
        indices.extend((2..face.len()).flat_map(|last| [face[0], face[last - 1], face[last]]));
    }
    indices
}

//! Profiles: whole numbers on one grid, compressed or not, are the same model.

use std::collections::BTreeSet;

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::gltf::read;
use kiln::language::Document;
use kiln::language::diagnostic::Code;
use kiln::language::source::MemoryFiles;
use kiln::packing::unpacked;

/// The files of a text for some profiles.
fn files(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = MemoryFiles::new().with("asset.toml", text);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}"))
}

/// Shapes of many kinds: seams, poles, edges, holes, several materials, wires, solids, a skin.
const MODELS: [&str; 7] = [
    "tolerance = 0.002\n[shape.a.sphere]\nradius = 0.7",
    "tolerance = 0.002\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.2",
    "[shape.a.box]\nsize = [1, 2, 3]\n[node.left]\nshape = \"a\"\nat = [0.3, 0, 0]\n[node.left-again]\nshape = \"a\"\nparent = \"left\"\nat = [0, 3, 0]\nrotate = [10, 20, 30]",
    "tolerance = 0.001\n[curve.ring.circle]\nradius = 0.3\n[shape.a.wire]\ncurves = [\"ring\"]",
    "tolerance = 0.002\n[shape.ball.sphere]\nradius = 0.5\n[shape.rod.cylinder]\nradius = 0.2\nheight = 2\n[shape.a.difference]\nof = [\"ball\", \"rod\"]",
    "tolerance = 0.001\n[shape.a.parametric]\nx = \"= (1 + 0.4 * cos(v)) * cos(u)\"\ny = \"= 0.4 * sin(v)\"\nz = \"= (1 + 0.4 * cos(v)) * sin(u)\"\nu = [0, 360]\nv = [0, 360]\nclosed = [\"u\", \"v\"]",
    "tolerance = 0.002\n[shape.arm.capsule]\nradius = 0.1\nheight = 1.2\n[skeleton.s.joint.low]\nhead = [0, -0.5, 0]\ntail = [0, 0, 0]\n[skeleton.s.joint.high]\nparent = \"low\"\ntail = [0, 0.5, 0]\n[skin.k]\nshape = \"arm\"\nskeleton = \"s\"\nweights = \"rigid\"",
];

#[test]
fn every_profile_is_the_same_model_within_its_tolerance() {
    for text in MODELS {
        let made = files(text, &[Profile::Core, Profile::Quantized, Profile::Web]);
        let report = |at: usize| made[at].report.as_ref().unwrap_or_else(|| panic!("no report of {text}"));
        for other in [1, 2] {
            assert!(made[other].warnings.is_empty(), "{}", made[other].warnings);
            let grid = report(other).grid.unwrap_or_else(|| panic!("{text}: it has no grid"));
            assert_eq!(grid.step.to_bits() & 0x000F_FFFF_FFFF_FFFF, 0, "{text}: the step is a power of two");
            for ((name, core), (_, facts)) in report(0).shapes.iter().zip(&report(other).shapes) {
                let (a, b) = (&core.facts, &facts.facts);
                assert_eq!(
                    (a.closed, a.components, a.boundary_loops),
                    (b.closed, b.components, b.boundary_loops)
                );
                assert_eq!(
                    (a.euler, a.genus, a.crowded_edges),
                    (b.euler, b.genus, b.crowded_edges),
                    "{name} of {text}"
                );
                let deviation = facts.deviation;
                let within =
                    deviation.tolerance.is_none_or(|tolerance| deviation.bound <= tolerance * (1.0 + 1e-9));
                assert!(within, "{name} of {text}: {deviation:?}");
                assert!(deviation.bound > 0.0, "{name} of {text}: rounding is told");
            }
            let nodes = |at: usize| -> Vec<_> {
                let of = |node: &kiln::report::NodeFacts| {
                    (node.name.clone(), node.mesh.clone(), node.matrix.map(f64::to_bits))
                };
                report(at).nodes.iter().map(of).collect()
            };
            assert_eq!(nodes(0), nodes(other), "{text}: what a game moves stays where it was");
        }
        let length = |at: usize| made[at].bytes.len();
        assert!(length(1) < length(0) || report(0).totals.vertices < 100, "{text}");
    }
}

/// Positions of a mesh as bits.
fn places(file: &Compiled, mesh: usize) -> BTreeSet<[u32; 3]> {
    let plain = unpacked(&file.bytes).unwrap_or_else(|error| panic!("{error}"));
    let read = read(&plain).unwrap_or_else(|error| panic!("{error}"));
    let all = &read.geometries[mesh];
    (0..all.positions.len()).map(|vertex| all.position(vertex).map(f32::to_bits)).collect()
}

/// Two bowls that share a rim at an odd place: where they meet they meet to the last bit, on any grid.
#[test]
fn what_touches_in_two_shapes_touches_still() {
    let text = "tolerance = 0.001\n[curve.up.polyline]\npoints = [[0, 0.1], [0.337, 0.7131]]\n[curve.down.polyline]\npoints = [[0.337, 0.7131], [0, 1.9]]\n\
                [shape.a]\nsegments = [37, 1]\n[shape.a.revolve]\nprofile = \"up\"\n[shape.b]\nsegments = [37, 1]\n[shape.b.revolve]\nprofile = \"down\"";
    for file in files(text, &[Profile::Core, Profile::Quantized, Profile::Web]) {
        let (a, b) = (places(&file, 0), places(&file, 1));
        let shared = a.intersection(&b).count();
        assert_eq!(shared, 37, "{:?}", file.profile);
    }
}

#[test]
fn compression_makes_files_a_fraction() {
    let made = files(
        "tolerance = 0.0002\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.2",
        &[Profile::Core, Profile::Quantized, Profile::Web],
    );
    let [core, quantized, web] = [0, 1, 2].map(|at: usize| made[at].bytes.len() as f64);
    assert!(quantized < 0.8 * core, "{quantized} of {core}");
    assert!(web < 0.25 * core, "{web} of {core}");
}

/// The bytes that a height map stands for are those of each file, packed or not.
#[test]
fn the_bytes_of_a_mesh_are_those_of_its_file() {
    let text = "tolerance = 0.004\n[map.hills.noise]\nseed = 3\ncolumns = 65\nrows = 65\n[shape.a.height-map]\nmap = \"hills\"\nsize = [8, 8]\nrange = [0, 1]";
    let made = files(text, &[Profile::Core, Profile::Quantized, Profile::Web]);
    let bytes: Vec<u64> = made
        .iter()
        .map(|file| {
            let report = file.report.as_ref().expect("there is a report");
            let bytes = report.heights["a"].mesh_bytes;
            // A file of one shape holds little else: its JSON, and texture coordinates.
            assert!(bytes < report.file.bytes && bytes > 0, "{bytes} of {}", report.file.bytes);
            bytes
        })
        .collect();
    let totals = &made[0].report.as_ref().expect("there is a report").totals;
    let width = if totals.vertices < 0xFFFF { 2 } else { 4 };
    assert_eq!(bytes[0], totals.vertices * 24 + totals.triangles * 3 * width, "floats take what they take");
    assert!(bytes[1] < bytes[0] && 2 * bytes[2] < bytes[1], "{bytes:?}");
}

/// What only one profile meets is said with its file, and what all meet once.
#[test]
fn warnings_stand_with_the_first_file_that_they_are_true_of() {
    let text = "tolerance = 0.01\n[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 2, 1, 3]]";
    let made = files(text, &[Profile::Core, Profile::Quantized, Profile::Web]);
    let codes: Vec<Vec<Code>> =
        made.into_iter().map(|file| file.warnings.into_iter().map(|one| one.code).collect()).collect();
    assert_eq!(codes, [vec![Code::FoldedFace], vec![], vec![]]);
}

#[test]
fn a_model_too_large_for_its_tolerance_keeps_floats_and_says_so() {
    let text = "tolerance = 1e-5\n[shape.a.cylinder]\nradius = 0.5\nheight = 3";
    for file in files(text, &[Profile::Quantized, Profile::Web]) {
        let codes: Vec<Code> = file.warnings.into_iter().map(|one| one.code).collect();
        assert_eq!(codes, [Code::CoarseGrid], "{:?}", file.profile);
        let report = file.report.as_ref().expect("there is a report");
        assert!(report.grid.is_none());
        let plain = unpacked(&file.bytes).expect("it was written so");
        assert_eq!(
            read(&plain).expect("it was written so").geometries[0].positions.len() as u64,
            report.totals.vertices
        );
    }
}

#[test]
fn a_document_says_for_whom_it_is() {
    let names = |text: &str, profiles: &[Profile]| -> Vec<String> {
        files(text, profiles).into_iter().map(|file| file.file).collect()
    };
    let body = "[shape.a.box]\nsize = [1, 1, 1]";
    assert_eq!(names(body, &[]), ["asset.glb"]);
    let two = format!("[output]\nprofiles = [\"web\", \"core\", \"web\"]\n{body}");
    assert_eq!(names(&two, &[]), ["asset.web.glb", "asset.glb"]);
    assert_eq!(names(&two, &[Profile::Quantized]), ["asset.quantized.glb"], "who bakes has the last word");
    // What stands beside it does not change a file.
    assert_eq!(files(&two, &[])[1].bytes, files(body, &[])[0].bytes);
}

#[test]
fn broken_files_are_refused_and_nothing_falls_over() {
    let made = files("[shape.a.box]\nsize = [1, 2, 3]", &[Profile::Web]);
    let whole = &made[0].bytes;
    for cut in 0..whole.len() {
        assert!(unpacked(&whole[..cut]).is_err(), "cut off at {cut}");
    }
    let mut refused = 0;
    for at in 12..whole.len() {
        for bit in [1, 0x10, 0x80] {
            let mut broken = whole.clone();
            broken[at] ^= bit;
            match unpacked(&broken) {
                Err(_) => refused += 1,
                Ok(plain) => {
                    let _ = read(&plain);
                }
            }
        }
    }
    assert!(refused > 1000, "{refused}");
    crate::counts::tried("damaged-packed-files", whole.len() + 3 * (whole.len() - 12));
}

#[test]
fn what_claims_more_than_its_bytes_can_hold_is_refused_before_memory_is_taken() {
    let made = files("[shape.a.box]\nsize = [1, 2, 3]", &[Profile::Web]);
    let mut bytes = made[0].bytes.clone();
    let named = b"\"byteStride\":8,\"count\":24";
    let at = bytes.windows(named.len()).position(|part| part == named).expect("a view of 24 positions");
    // The count of a view grows to 24 thousand millions; the header's lengths stay right as padding pays for it.
    let json =
        usize::try_from(u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]])).expect("it fits");
    let more = b"000000000000";
    bytes.splice(at + named.len()..at + named.len(), more.iter().copied());
    for (place, length) in [(8, bytes.len()), (12, json + more.len())] {
        bytes[place..place + 4].copy_from_slice(&u32::try_from(length).expect("it fits").to_le_bytes());
    }
    let error = unpacked(&bytes).expect_err("no such file has so many vertices");
    assert!(error.to_string().contains("cannot be unpacked"), "{error}");
}

/// A file of a few hundred views that all name the same bytes.
#[test]
fn views_that_share_their_bytes_cannot_ask_for_any_amount() {
    let zeros = vec![0_u8; 8 * 4096];
    let packed = kiln::packing::encode_attributes(&zeros, 8, kiln::packing::Codec::Zero)
        .expect("the stride is one of the format");
    let view = format!(
        r#"{{"buffer":1,"byteLength":32768,"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteLength":{},"byteStride":8,"count":4096,"mode":"ATTRIBUTES"}}}}}}"#,
        packed.len()
    );
    let file = |count: usize| {
        let views = vec![view.clone(); count].join(",");
        let mut json = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[{views}]}}"#,
            packed.len()
        )
        .into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = packed.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let word = |length: usize| u32::try_from(length).expect("it fits").to_le_bytes();
        let mut bytes = [&b"glTF"[..], &word(2), &word(28 + json.len() + binary.len())].concat();
        bytes
            .extend([&word(json.len())[..], b"JSON", &json, &word(binary.len()), b"BIN\0", &binary].concat());
        bytes
    };
    assert!(unpacked(&file(1)).is_ok());
    let error = unpacked(&file(400)).expect_err("4 MB in 60 kB");
    assert!(error.to_string().contains("more than the file can hold"), "{error}");
}

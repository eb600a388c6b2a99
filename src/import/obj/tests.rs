//! Every kind of line, and every fault with its message.

use glam::{DVec2, DVec3};

use super::{inside_folder, mtl, read};
use crate::geometry::mesh::polygon::NONE;
use crate::import::image::Edge;
use crate::import::look::Picture;
use crate::import::{ImportError, ImportOptions, Imported};

fn text(text: &str) -> Result<Imported, ImportError> {
    read(text.as_bytes(), &ImportOptions::default(), &mut |_| None)
}

fn group(source: &str, group: &str) -> Result<Imported, ImportError> {
    let options = ImportOptions { group: Some(group.to_owned()), ..ImportOptions::default() };
    read(source.as_bytes(), &options, &mut |_| None)
}

/// The message with its place, as a diagnostic shows it.
fn told(error: &ImportError) -> String {
    error.line().map_or_else(|| error.to_string(), |line| format!("line {line}: {error}"))
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn on_quad(rest: &str) -> Result<Imported, ImportError> {
    text(&format!("{QUAD}{rest}"))
}

#[test]
fn a_quad_stays_a_quad() {
    let read = on_quad("f 1 2 3 4").expect("good");
    assert_eq!(read.mesh.loop_ends, [4]);
    assert_eq!(read.mesh.points[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(read.mesh.validate(), Ok(()));
    assert!(read.notes.is_empty() && !read.mesh.has_smoothing);
}

#[test]
fn line_ends_marks_and_continuations() {
    for ends in ["\n", "\r\n", "\r"] {
        let source = format!("\u{feff}{QUAD}f 1 2 \\\n3 \\\n 4 # a comment\n\n# f 9 9 9").replace('\n', ends);
        let read = text(&source).expect("good");
        assert_eq!((read.mesh.faces.len(), read.mesh.corners.len()), (1, 4), "{ends:?}");
    }
    // The line of a fault after a continuation is still right, and so is one inside.
    let error = on_quad("f 1 \\\n2 \\\n3\nf 1 2 0").expect_err("index 0");
    assert_eq!(error, ImportError::IndexZero { line: 8, text: "0".to_owned() });
}

#[test]
fn relative_indices_count_back() {
    let read = on_quad("f -4 -3 -2\nv 5 5 5\nf -5 -3 -1").expect("good");
    let position = |corner: usize| read.mesh.position(corner);
    assert_eq!([position(0), position(3), position(5)], [DVec3::ZERO, DVec3::ZERO, DVec3::splat(5.0)]);
}

#[test]
fn attributes_only_where_they_are_given() {
    let read = on_quad("vt 0.25 0.75\nvt 1\nvn 0 0 1\nf 1 2/1 3//1 4/2/1\nf 1 2 3").expect("good");
    let mesh = read.mesh;
    assert_eq!(
        mesh.corner_uvs.iter().map(|&uv| uv == NONE).collect::<Vec<_>>(),
        [true, false, true, false, true, true, true]
    );
    assert_eq!(mesh.uvs[mesh.corner_uvs[1] as usize], DVec2::new(0.25, 0.25));
    assert_eq!(mesh.uvs[mesh.corner_uvs[3] as usize], DVec2::new(1.0, 1.0));
    assert_eq!(
        mesh.corner_normals.iter().map(|&normal| normal == NONE).collect::<Vec<_>>(),
        [true, true, false, false, true, true, true]
    );
    assert!(on_quad("vt 0 0\nf 1 2 3").expect("good").mesh.corner_uvs.is_empty());
}

#[test]
fn attributes_that_are_missing_altogether_are_forgotten() {
    let read = on_quad("f 1/1/3 2/2/2 3/3/1").expect("good");
    assert!(read.mesh.corner_uvs.is_empty() && read.mesh.corner_normals.is_empty());
    let notes: Vec<&str> = read.notes.iter().map(|note| note.message.as_str()).collect();
    assert_eq!(
        notes,
        [
            "faces name texture coordinates, but the file has none",
            "faces name normals, but the file has none"
        ]
    );
}

#[test]
fn smoothing_groups_are_kept() {
    let read = on_quad("f 1 2 3\ns 1\nf 1 2 3\ns off\nf 1 2 3\ns 7\nf 1 2 3\ns 0\nf 1 2 3\ns on\nf 1 2 3")
        .expect("good");
    assert!(read.mesh.has_smoothing);
    assert_eq!(read.mesh.faces.iter().map(|face| face.smoothing).collect::<Vec<_>>(), [0, 1, 0, 7, 0, 1]);
    let strange = on_quad("s left\nf 1 2 3").expect("good");
    assert_eq!(strange.notes[0].message, "a smoothing group is not a number; taken as off");
}

#[test]
fn materials_and_their_libraries() {
    let source = format!(
        "mtllib a dir/my look.mtl\n{QUAD}f 1 2 3\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\nusemtl red\nf 1 2 3\n"
    );
    let library = b"newmtl red\nKd 0.5 0.25 2\nd 0.5\nmap_Kd red one.png\nnewmtl blue\nKd x\nTr 0.25\n";
    let mut asked = Vec::new();
    let mut open = |path: &str| {
        asked.push(path.to_owned());
        Some(library.to_vec())
    };
    let read = read(source.as_bytes(), &ImportOptions::default(), &mut open).expect("good");
    assert_eq!(asked, ["a dir/my look.mtl"]);
    assert_eq!(read.mesh.materials, ["red", "blue"]);
    assert_eq!(
        read.mesh.faces.iter().map(|face| face.material).collect::<Vec<_>>(),
        [None, Some(0), Some(1), Some(0)]
    );
    assert_eq!(read.materials[0].color, Some([0.5, 0.25, 1.0]));
    assert_eq!(
        (read.materials[0].opacity, read.materials[0].pictures.color.clone()),
        (Some(0.5), Some(Picture::file("a dir/red one.png")))
    );
    assert_eq!((read.materials[1].color, read.materials[1].opacity), (None, Some(0.75)));
}

#[test]
fn options_of_pictures_are_read() {
    let color = |line: &str| mtl::read(format!("newmtl a\n{line}").as_bytes(), "").remove(0).pictures.color;
    let path = Some(Picture::file("a b.png"));
    for options in ["", "-blendu on ", "-s 1 1 1 -o 0 0 ", "-mm 0 1 -bm 0.5 ", "-clamp off "] {
        assert_eq!(color(&format!("map_Kd {options}a b.png")), path, "{options}");
    }
    let clamped = color("map_Kd -clamp on a b.png").expect("a picture");
    assert_eq!(clamped, Picture { edge: Edge::Clamp, ..Picture::file("a b.png") });
    for line in
        ["map_Kd", "map_Kd -s 2 2 1 a.png", "map_Kd -o 0.5 a.png", "map_Kd -clamp", "map_Kd -wild on a.png"]
    {
        assert_eq!(color(line), None, "{line}");
    }
    let look =
        mtl::read(b"newmtl a\nPm 1\nPr 0.25\nKe 0 0.5 1\nmap_Ke glow.png\nnorm bumps.png\n", "b/").remove(0);
    assert_eq!(
        (look.metallic, look.roughness, look.emissive, look.color),
        (Some(1.0), Some(0.25), Some([0.0, 0.5, 1.0]), None)
    );
    assert_eq!(look.pictures.emissive, Some(Picture::file("b/glow.png")));
    assert_eq!(look.pictures.normal, Some((Picture::file("b/bumps.png"), 1.0)));
}

#[test]
fn libraries_outside_the_folder_are_not_asked_for() {
    for path in ["../x.mtl", "/etc/passwd", "a/../../x", "C:\\x.mtl", "..\\x.mtl", "file://x", "a//b", ""] {
        assert_eq!(inside_folder(path), None, "{path}");
        let source = format!("mtllib {path}\n{QUAD}f 1 2 3");
        let read = read(source.as_bytes(), &ImportOptions::default(), &mut |path| panic!("asked for {path}"))
            .expect("good");
        assert_eq!(read.notes.len(), 1);
        assert_eq!(read.notes[0].line, Some(1));
    }
    assert_eq!(inside_folder("./a\\b.mtl").as_deref(), Some("a/b.mtl"));
    let missing = text(&format!("{QUAD}f 1 2 3\nmtllib x.mtl")).expect("good");
    assert_eq!(missing.notes[0].message, "material library `x.mtl` not found");
}

#[test]
fn groups_and_objects_can_be_read_alone() {
    let source = format!(
        "{QUAD}o body\ng left arm\nf 1 2 3\ng right\nf 2 3 4\nf 1 2 4\no head\nf 1 3 4\ng right\ng\nf 1 2 3 4\no empty"
    );
    let faces = |name| group(&source, name).map(|read| read.mesh.faces.len());
    assert_eq!(faces("body"), Ok(3));
    assert_eq!(faces("left"), Ok(1));
    assert_eq!(faces("left arm"), Ok(1));
    assert_eq!(faces("right"), Ok(2));
    assert_eq!(faces("head"), Ok(2));
    assert_eq!(faces("empty"), Err(ImportError::EmptyGroup { group: "empty".to_owned() }));
    let error = faces("leg").expect_err("no such group");
    assert_eq!(error.to_string(), "the file has no group `leg`");
    assert_eq!(error.hint().as_deref(), Some("its groups are: `body`, `left arm`, `right`, `head`, `empty`"));
    assert_eq!(text(&source).expect("good").groups, ["body", "left arm", "right", "head", "empty"]);
    assert_eq!(group(&source, "left").expect("good").mesh.points.len(), 3);
}

#[test]
fn what_is_passed_over_is_told_once() {
    let read = on_quad(
        "p 1\np 2\nl 1 2\nfrobnicate\nvp 0\ncurv 0 1\nf 1 2\nf 1 2 3\nvn nan 0 0\nv 1 2 3 0.5 0.5 0.5",
    )
    .expect("good");
    let notes: Vec<(Option<u32>, &str)> =
        read.notes.iter().map(|note| (note.line, note.message.as_str())).collect();
    assert_eq!(
        notes,
        [
            (Some(5), "points are not read (2 lines)"),
            (Some(7), "lines are not read"),
            (Some(8), "a keyword is not known"),
            (Some(9), "free-form curves and surfaces are not read (2 lines)"),
            (Some(11), "a face with fewer than three corners was left out"),
            (Some(13), "a normal is not made of finite numbers; computed from the faces instead"),
            (Some(14), "vertex colors and weights are not read"),
        ]
    );
}

#[test]
fn a_wrong_vertex_is_an_error_when_it_is_used() {
    assert!(on_quad("v 1 2 3.1+e2\nv nan 0 0\nv 1\nf 1 2 3").is_ok());
    let message = |rest| told(&on_quad(rest).expect_err("a wrong vertex"));
    assert_eq!(
        message("v 1 2 3.1+e2\nf 1 2 5"),
        "line 5: expected a number for the z coordinate of a vertex, found `3.1+e2`"
    );
    assert_eq!(message("v 0 0 0\nv 1 2 -inf\nf 1 2 6\n"), "line 6: `-inf` is not a finite number");
    assert_eq!(message("f 1 2 5\nv 1 1e999 0"), "line 6: `1e999` is not a finite number");
    assert_eq!(message("v 1 2\nv 1\nf 1 5 6"), "line 5: a vertex needs 3 numbers, found 2");
    let comma = on_quad("v 1,5 2 3\nf 1 2 5").expect_err("a comma");
    assert_eq!(comma.hint().as_deref(), Some("write decimals with a point, not a comma"));
}

#[test]
fn faults_in_faces() {
    let message = |rest| told(&on_quad(rest).expect_err("a fault"));
    assert_eq!(message("f 1 2 0"), "line 5: index 0 in `0`; indices count from 1");
    assert_eq!(message("f 1 2 5"), "line 5: vertex 5 does not exist; the file has 4");
    assert_eq!(
        message("f 1 2 9\nf 1 2 8\nf 1 2 7\nv 0 0 0"),
        "line 5: vertex 9 does not exist; the file has 5"
    );
    assert_eq!(message("f -1 -2 -5"), "line 5: vertex -5 does not exist; only 4 come before it");
    assert_eq!(
        message("f 1 2 99999999999999999999"),
        "line 5: vertex 99999999999999999999 does not exist; the file has 4"
    );
    assert_eq!(
        message("vt 0 0\nf 1/1 2/1 3/2"),
        "line 6: texture coordinate 2 does not exist; the file has 1"
    );
    assert_eq!(message("f 1//2 2//2 3//2\nvn 0 0 1"), "line 5: normal 2 does not exist; the file has 1");
    for corner in ["x", "/1", "1/2/3/4", "1.5", "--1", "+", "1/x", "0x1", "1_0"] {
        let expected = ImportError::BadCorner { line: 5, text: corner.to_owned() };
        assert_eq!(on_quad(&format!("f 1 2 {corner}")), Err(expected));
    }
}

#[test]
fn files_that_are_not_obj() {
    assert_eq!(text(""), Err(ImportError::NoFaces { vertices: 0 }));
    assert_eq!(text(QUAD).expect_err("points").to_string(), "the file holds no faces, only 4 vertices");
    assert_eq!(on_quad("f 1 2 3\0"), Err(ImportError::Binary { line: 5, byte: 0 }));
    assert_eq!(read(b"\xff\xfev\0", &ImportOptions::default(), &mut |_| None), Err(ImportError::Utf16));
    let blend = read(b"BLENDER-v405", &ImportOptions::default(), &mut |_| None).expect_err("not OBJ");
    assert_eq!(blend.to_string(), "this is a Blender file, which Kiln does not read");
    assert_eq!(
        blend.hint().as_deref(),
        Some("in Blender: File > Export > Wavefront (.obj), then import that file")
    );
}

#[test]
fn points_at_one_place_stay_apart_until_welded() {
    let source = format!("{QUAD}v 1 0 1e-9\nv 0 0 0\nf 1 2 3\nf 6 5 4");
    assert_eq!(text(&source).expect("good").mesh.points.len(), 6);
    let weld = |tolerance| {
        let options = ImportOptions { weld: Some(tolerance), ..ImportOptions::default() };
        read(source.as_bytes(), &options, &mut |_| None).expect("good").mesh.points.len()
    };
    assert_eq!((weld(0.0), weld(1e-6)), (5, 4));
}

/// Every prefix of a file, and the file with each byte spoiled, is read or refused.
#[test]
fn no_damage_breaks_the_reader() {
    let source = format!(
        "mtllib m.mtl\no a\ng b\nusemtl c\ns 1\n{QUAD}vt 0.5 1\nvn 0 0 1\nf 1/1/1 2//1 3/1 \\\n -1\nl 1 2\n"
    );
    let bytes = source.as_bytes();
    let (mut good, mut bad) = (0, 0);
    let mut attempt = |bytes: &[u8]| match read(bytes, &ImportOptions::default(), &mut |_| None) {
        Ok(read) => {
            assert_eq!(read.mesh.validate(), Ok(()));
            good += 1;
        }
        Err(error) => {
            assert!(!error.to_string().is_empty() && error.hint().is_some());
            bad += 1;
        }
    };
    for end in 0..bytes.len() {
        attempt(&bytes[..end]);
        for value in [0, b' ', b'\n', b'/', b'-', b'9', b'x', b'#', 0xff] {
            let mut spoiled = bytes.to_vec();
            spoiled[end] = value;
            attempt(&spoiled);
        }
    }
    assert!(good > 100 && bad > 100, "{good} good, {bad} bad");
}

use glam::DVec3;

use super::super::ImportError;
use super::{Md5Fault, animation, mesh};

/// A square that hangs from two joints, one turned by a quarter about z; its first corner stands there twice.
const MESH: &str = "MD5Version 10\ncommandline \"made by hand\"\n\nnumJoints 2\nnumMeshes 1\n\njoints {\n\t\"hip\"\t-1 ( 0 0 1 ) ( 0 0 0 )\t\t// \n\t\"knee\"\t0 ( 2 0 1 ) ( 0 0 0.7071067811865476 )\t\t// hip\n}\n\nmesh {\n\t// the only one\n\tshader \"cloth\"\n\n\tnumverts 5\n\tvert 0 ( 0 0 ) 0 1\n\tvert 1 ( 1 0.25 ) 1 2\n\tvert 2 ( 1 1 ) 3 1\n\tvert 3 ( 0 1 ) 4 1\n\tvert 4 ( 0.5 0.5 ) 0 1\n\n\tnumtris 2\n\ttri 0 0 1 2\n\ttri 1 4 2 3\n\n\tnumweights 5\n\tweight 0 0 1 ( 0 0 0 )\n\tweight 1 0 0.75 ( 4 0 0 )\n\tweight 2 1 0.25 ( 0 -2 0 )\n\tweight 3 1 1 ( 4 -2 0 )\n\tweight 4 0 1 ( 0 4 0 )\n}\n";

const MOTION: &str = "MD5Version 10\ncommandline \"\"\n\nnumFrames 2\nnumJoints 2\nframeRate 24\nnumAnimatedComponents 3\n\nhierarchy {\n\t\"hip\"\t-1 4 0\t//\n\t\"knee\"\t0 40 1\t// hip\n}\n\nbounds {\n\t( 0 0 0 ) ( 1 1 1 )\n\t( 0 0 0 ) ( 1 1 1 )\n}\n\nbaseframe {\n\t( 0 0 1 ) ( 0 0 0 )\n\t( 2 0 0 ) ( 0 0 0.5 )\n}\n\nframe 0 {\n\t1 0 0.5\n}\n\nframe 1 {\n\t3 0 0\n}\n";

#[test]
fn points_hang_from_joints() {
    let found = mesh::read(MESH.as_bytes(), None).expect("a mesh");
    let mesh = &found.imported.mesh;
    mesh.validate().expect("valid");
    // The fourth part of a rotation is not positive: this one turns by a quarter the other way.
    let wanted = [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, -4.0, 1.0], [0.0, 4.0, 1.0]];
    assert_eq!(mesh.points.len(), 4, "the seam is joined");
    for (point, wanted) in mesh.points.iter().zip(wanted) {
        assert!(point.distance(DVec3::from_array(wanted)) < 1e-12, "{point}");
    }
    assert_eq!(found.weights[1], [(0, 0.75), (1, 0.25)]);
    let corners: Vec<u32> = mesh.corners.iter().map(|corner| corner.0).collect();
    assert_eq!(corners, [0, 2, 1, 0, 3, 2], "counter-clockwise");
    assert_eq!(mesh.corner_uvs, [0, 2, 1, 4, 3, 2]);
    assert_eq!((found.joints[1].name.as_str(), found.joints[1].parent), ("knee", Some(0)));
    assert_eq!(found.imported.groups, ["cloth"]);
    assert!(matches!(mesh::read(MESH.as_bytes(), Some("skin")), Err(ImportError::UnknownGroup { .. })));
}

#[test]
fn at_most_four_joints_carry_a_point() {
    let joints: String = (0..5).map(|k| format!("\"j{k}\" {} ( 0 0 0 ) ( 0 0 0 )\n", k - 1)).collect();
    let weights: String =
        (0..5).map(|k| format!("weight {k} {k} 0.{} ( {k} 0 0 )\n", [1, 3, 1, 3, 2][k])).collect();
    let text = format!(
        "MD5Version 10 numJoints 5 numMeshes 1 joints {{ {joints} }} mesh {{ numverts 3 vert 0 (0 0) 0 5 vert 1 (0 0) 1 1 vert 2 (0 0) 2 1 numtris 1 tri 0 0 1 2 numweights 5 {weights} }}"
    );
    let found = mesh::read(text.as_bytes(), None).expect("a mesh");
    let kept = &found.weights[0];
    assert_eq!(kept.iter().map(|(joint, _)| *joint).collect::<Vec<_>>(), [0, 1, 3, 4]);
    for ((_, share), wanted) in kept.iter().zip([1.0, 3.0, 3.0, 2.0]) {
        assert!((share - wanted / 9.0).abs() < 1e-12, "{kept:?}");
    }
    // Where it stands is what all weights say.
    assert!(found.imported.mesh.points[0].distance(DVec3::X * 2.2) < 1e-12);
    assert_eq!(
        found.imported.notes[0].message,
        "1 points are carried by more than 4 joints; the 4 greatest weights of each are kept"
    );
}

#[test]
fn frames_move_what_flags_name() {
    let found = animation::read(MOTION.as_bytes()).expect("a motion");
    assert_eq!((found.frames.len(), found.frame_rate), (2, 24.0));
    assert_eq!(found.frames[0][0].translation, DVec3::new(0.0, 0.0, 1.0));
    assert_eq!(found.frames[1][0].translation, DVec3::new(0.0, 0.0, 3.0));
    let [first, second] = [0, 1].map(|frame| found.frames[frame][1].rotation);
    assert!((first.z - 0.5).abs() < 1e-12 && (first.w + 0.75_f64.sqrt()).abs() < 1e-12, "{first}");
    assert_eq!((second.z, second.w), (0.0, -1.0));
    assert_eq!(found.frames[1][1].translation, DVec3::new(2.0, 0.0, 0.0));
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused, and indices are in range.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    let read_mesh = |bytes: &[u8]| {
        let found = mesh::read(bytes, None).map_err(|error| error.to_string())?;
        found.imported.mesh.validate().expect("valid");
        assert_eq!(found.weights.len(), found.imported.mesh.points.len());
        let sum = |own: &Vec<(usize, f64)>| own.iter().map(|(_, share)| share).sum::<f64>();
        assert!(found.weights.iter().all(|own| (sum(own) - 1.0).abs() < 1e-12));
        Ok(())
    };
    let read_motion = |bytes: &[u8]| {
        let found = animation::read(bytes).map_err(|error| error.to_string())?;
        assert!(found.frames.iter().all(|frame| frame.len() == found.joints.len()));
        assert!(found.frames.iter().flatten().all(|place| place.rotation.is_normalized()));
        Ok(())
    };
    type Reader<'r> = &'r dyn Fn(&[u8]) -> Result<(), String>;
    let files: [(&str, Reader<'_>); 2] = [(MESH, &read_mesh), (MOTION, &read_motion)];
    for (whole, read) in files {
        let whole = whole.as_bytes();
        for length in 0..whole.len() - 2 {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
        let mut refused = 0;
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.to_vec();
                bytes[at] ^= 1 << bit;
                if let Err(message) = read(&bytes) {
                    assert!(!message.is_empty());
                    refused += 1;
                }
            }
        }
        assert!(refused > 1000, "{refused}");
    }
}

#[test]
fn faults_name_what_they_found() {
    let of_mesh = |from: &str, to: &str| {
        assert!(MESH.contains(from), "{from}");
        let error = mesh::read(MESH.replacen(from, to, 1).as_bytes(), None).expect_err("refused");
        format!("{}: {error}", error.line().unwrap_or(0))
    };
    assert_eq!(
        of_mesh("MD5Version 10", "MD5Version 6"),
        "1: this is version 6 of the format, and version 10 is read"
    );
    assert_eq!(of_mesh("numJoints 2", "numJoints 3"), "10: the file announces 3 joints and has 2");
    assert_eq!(
        of_mesh("\"knee\"\t0", "\"knee\"\t1"),
        "9: joint `knee` is carried by joint 1, which does not stand before it"
    );
    assert_eq!(
        of_mesh("( 0 0 0.7071067811865476 )", "( 0 1 0.7 )"),
        "9: a rotation has parts from -1 to 1 whose squares add up to at most 1"
    );
    assert_eq!(of_mesh("3 ( 0 1 ) 4 1", "3 ( 0 1 ) 4 0"), "20: vertex 3 has no weight");
    assert_eq!(
        of_mesh("3 ( 0 1 ) 4 1", "3 ( 0 1 ) 4 2"),
        "20: weight 5 does not exist: there are 5, counted from 0"
    );
    assert_eq!(
        of_mesh("3 ( 0 1 ) 4 1", "3 ( 0 1 ) 0 300"),
        "20: vertex 3 has 300 weights, and at most 256 are read"
    );
    assert_eq!(
        of_mesh("tri 0 0 1 2", "tri 0 0 1 5"),
        "24: vertex 5 does not exist: there are 5, counted from 0"
    );
    assert_eq!(of_mesh("tri 1 4", "tri 2 4"), "25: triangles 2 stands where 1 must");
    assert_eq!(
        of_mesh("weight 3 1 1", "weight 3 2 1"),
        "31: joint 2 does not exist: there are 2, counted from 0"
    );
    assert_eq!(of_mesh("4 0 0 )", "4 nan 0 )"), "29: expected a coordinate, found `nan`");
    assert_eq!(of_mesh("mesh {", "mush {"), "12: expected `mesh`, found `mush`");
    let of_motion = |from: &str, to: &str| {
        let error = animation::read(MOTION.replacen(from, to, 1).as_bytes()).expect_err("refused");
        format!("{}: {error}", error.line().unwrap_or(0))
    };
    assert_eq!(of_motion("frameRate 24", "frameRate 0"), "7: expected a frame rate above 0, found `0`");
    assert_eq!(
        of_motion("0 40 1", "0 40 2"),
        "11: animated component 3 does not exist: there are 3, counted from 0"
    );
    assert_eq!(of_motion("0 40 1", "0 64 1"), "11: flags 64 does not exist: there are 64, counted from 0");
    assert_eq!(
        of_motion("1 0 0.5\n", "1 0 0.5 2\n"),
        "26: the file announces 3 numbers of a frame and has 4"
    );
    assert_eq!(of_motion("numFrames 2", "numFrames 3"), "30: the file announces 3 frames and has 2");
    assert_eq!(of_motion("frame 1", "frame 2"), "28: frame 2 stands where 1 must");
    assert_eq!(animation::read(b"MD5Version \0"), Err(Md5Fault::NotText));
    let many: String = (0..3000).map(|k| format!("\"j{k}\" -1 0 0\n")).collect();
    let places = "( 0 0 0 ) ( 0 0 0 )\n".repeat(3000);
    let frames: String = (0..2000).map(|k| format!("frame {k} {{ }}\n")).collect();
    let long = format!(
        "MD5Version 10 numFrames 2000 numJoints 3000 frameRate 24 numAnimatedComponents 0 hierarchy {{ {many} }} baseframe {{ {places} }} {frames}"
    );
    assert!(matches!(animation::read(long.as_bytes()), Err(Md5Fault::Long { .. })));
}

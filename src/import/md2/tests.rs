use std::fmt::Write as _;

use glam::DVec3;

use super::super::MaterialLook;
use super::super::keyframes::{STANDARD, STANDARD_FRAMES};
use super::{Md2Fault, read};

/// A tetrahedron in some frames, written field by field.
fn file(names: &[&str]) -> Vec<u8> {
    let frames = i32::try_from(names.len()).expect("few");
    let frame_size = 40 + 4 * 4;
    let offsets = [68, 68 + 64, 68 + 64 + 16, 68 + 64 + 16 + 48];
    let end = offsets[3] + frames * frame_size;
    let header = [
        8, 64, 32, frame_size, 1, 4, 4, 4, 0, frames, offsets[0], offsets[1], offsets[2], offsets[3], end,
        end,
    ];
    let mut bytes = b"IDP2".to_vec();
    header.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    let mut skin = b"players/knight.pcx".to_vec();
    skin.resize(64, 0);
    bytes.extend(skin);
    for [s, t] in [[0_i16, 0], [64, 0], [64, 32], [0, 32]] {
        bytes.extend([s, t].map(i16::to_le_bytes).as_flattened());
    }
    // Clockwise from outside.
    for [a, b, c] in [[0_u16, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] {
        bytes.extend([a, b, c, a, b, c].map(u16::to_le_bytes).as_flattened());
    }
    for (number, name) in (0_u8..).zip(names) {
        let numbers = [0.5_f32, 0.25, 1.0, f32::from(number), -1.0, 0.0];
        bytes.extend(numbers.map(f32::to_le_bytes).as_flattened());
        let mut text = name.as_bytes().to_vec();
        text.resize(16, 0);
        bytes.extend(text);
        for place in [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4 + number]] {
            bytes.extend(place);
            bytes.push(3);
        }
    }
    bytes
}

#[test]
fn points_faces_and_pictures_are_read() {
    let bytes = file(&["stand01", "stand02"]);
    let found = read(&bytes).expect("a model");
    assert_eq!(found.pictures, ["players/knight.pcx"]);
    assert_eq!(found.materials, [MaterialLook::pictured("skin", "players/knight.pcx")]);
    assert!(found.mesh.faces.iter().all(|face| face.material == Some(0)));
    assert_eq!(found.frames[0].points[1], DVec3::new(2.0, -1.0, 0.0));
    assert_eq!(found.frames[1].points[3], DVec3::new(1.0, -1.0, 5.0));
    assert_eq!(found.mesh.points, found.frames[0].points);
    found.mesh.validate().expect("valid");
    let places: Vec<[f64; 2]> = found.mesh.uvs.iter().map(|place| place.to_array()).collect();
    assert_eq!(places, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    // Counter-clockwise: the volume is positive.
    let volume: f64 = (0..4)
        .map(|face| {
            let [a, b, c] =
                [0, 1, 2].map(|k| found.mesh.points[found.mesh.corners[3 * face + k].subscript()]);
            a.cross(b).dot(c) / 6.0
        })
        .sum();
    assert!((volume - 2.0 * 1.0 * 4.0 / 6.0).abs() < 1e-12, "{volume}");
}

#[test]
fn sequences_have_the_names_of_their_frames() {
    let names =
        ["stand01", "stand02", "run001", "run002", "death101", "death102", "death201", "boom", "stand03"];
    let found = read(&file(&names)).expect("a model").sequences();
    let told: String = found.iter().fold(String::new(), |mut told, one| {
        write!(told, "{} {}-{}; ", one.name, one.frames.start, one.frames.end).expect("text");
        told
    });
    assert_eq!(told, "stand 0-2; run 2-4; death1 4-6; death2 6-7; boom 7-8; stand 8-9; ");
    assert!(read(&file(&names)).expect("a model").standard_sequences().is_none());
    let many = vec!["x"; STANDARD_FRAMES + 1];
    for (frames, sequences) in [(STANDARD_FRAMES, 20), (STANDARD_FRAMES + 1, 21)] {
        let found = read(&file(&many[..frames])).expect("a model").standard_sequences().expect("a player");
        assert_eq!((found.len(), found[sequences - 1].frames.end), (sequences, frames));
        assert_eq!(found[0].name, STANDARD[0].0);
    }
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused, and indices are in range.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    let whole = file(&["stand01", "stand02"]);
    for length in 0..whole.len() {
        assert!(read(&whole[..length]).is_err(), "{length} bytes");
    }
    let mut refused = 0;
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            match read(&bytes) {
                Ok(found) => found.mesh.validate().expect("valid"),
                Err(fault) => {
                    assert!(!fault.to_string().is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 300, "{refused}");
}

#[test]
fn faults_name_what_they_found() {
    let with = |word: usize, value: i32| {
        let mut bytes = file(&["a"]);
        bytes[4 * word..4 * word + 4].copy_from_slice(&value.to_le_bytes());
        read(&bytes).expect_err("refused").to_string()
    };
    assert_eq!(with(1, 9), "this is version 9 of the format, and version 8 is read");
    assert_eq!(with(6, 0), "the header counts 0 points");
    assert_eq!(with(10, -1), "the header counts -1 frames");
    assert_eq!(with(10, i32::MAX), "frames should stand at bytes 196 to 120259084428, and the file has 252");
    assert_eq!(with(13, -4), "triangles should stand at bytes -4 to 44, and the file has 252");
    assert_eq!(with(4, 41), "each frame has 41 bytes, and 4 points need 56");
    let mut bytes = file(&["a"]);
    bytes[148..150].copy_from_slice(&7_u16.to_le_bytes());
    assert_eq!(read(&bytes).expect_err("refused").to_string(), "triangle 1 has point 7, and the file has 4");
    let mut bytes = file(&["a"]);
    bytes[196..200].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(matches!(read(&bytes), Err(Md2Fault::NotFinite { frame: 1, .. })));
    assert_eq!(read(b"IDP").expect_err("refused"), Md2Fault::TooShort { length: 3 });
    assert_eq!(read(b"IDP3").expect_err("refused"), Md2Fault::NotMd2);
}

use glam::{DMat3, DVec2, DVec3};

use super::super::ImportError;
use super::super::keyframes::Keyframes;
use super::super::look::Picture;
use super::{Md3Fault, read};

/// A name in a field of so many bytes.
fn field(name: &str, size: usize) -> Vec<u8> {
    let mut text = name.as_bytes().to_vec();
    text.resize(size, 0);
    text
}

fn words(numbers: &[i32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A tetrahedron whose first corner stands there twice, with other texture coordinates; its top rises from frame to frame.
fn surface(name: &str, frames: i16) -> Vec<u8> {
    let places: [[i16; 3]; 5] = [[0, 0, 0], [64, 0, 0], [0, 64, 0], [0, 0, 64], [0, 0, 0]];
    // Clockwise from outside.
    let triangles = words(&[0, 1, 2, 0, 3, 1, 4, 2, 3, 1, 3, 2]);
    let shader = [field("models/toy.png", 64), words(&[0])].concat();
    let uvs = floats(&[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.5, 0.25]);
    let mut points = Vec::new();
    for frame in 0..frames {
        for [x, y, z] in places {
            let z = if z > 0 { z + 64 * frame } else { 0 };
            points.extend([x, y, z].iter().flat_map(|part| part.to_le_bytes()));
            // A quarter turn from z, and a quarter turn about it: y.
            points.extend([64, 64]);
        }
    }
    let sections = [triangles, shader, uvs, points];
    let mut offsets = vec![108];
    sections.iter().for_each(|section| offsets.push(offsets[offsets.len() - 1] + section.len()));
    let offsets: Vec<i32> = offsets.iter().map(|offset| i32::try_from(*offset).expect("small")).collect();
    let counts = words(&[0, i32::from(frames), 1, 5, 4]);
    [b"IDP3".to_vec(), field(name, 64), counts, words(&offsets), sections.concat()].concat()
}

/// Two surfaces and a tag that turns by a quarter in the second frame.
fn file() -> Vec<u8> {
    let frames: Vec<u8> =
        ["walk1", "walk2"].iter().flat_map(|name| [floats(&[0.0; 10]), field(name, 16)].concat()).collect();
    let tag = |numbers: [f32; 12]| [field("tag_hand", 64), floats(&numbers)].concat();
    let tags = [
        tag([1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
        tag([1.0, 2.0, 4.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    ];
    let offsets = [108, 108 + 112, 108 + 112 + 224];
    let surfaces = [surface("body", 2), surface("hat", 2)].concat();
    let end = offsets[2] + i32::try_from(surfaces.len()).expect("small");
    let header = [field("toy", 64), words(&[0, 2, 1, 2, 0]), words(&offsets), words(&[end])].concat();
    [b"IDP3".to_vec(), words(&[15]), header, frames, tags.concat(), surfaces].concat()
}

fn model(bytes: &[u8]) -> Keyframes {
    read(bytes, None).expect("a model")
}

#[test]
fn surfaces_frames_and_tags_are_read() {
    let found = model(&file());
    found.mesh.validate().expect("valid");
    assert_eq!((found.mesh.points.len(), found.mesh.uvs.len()), (8, 10), "the seam is joined");
    assert_eq!(found.mesh.uvs[4], DVec2::new(0.5, 0.25));
    assert_eq!(
        (found.groups.clone(), found.mesh.materials.clone()),
        (found.mesh.materials.clone(), found.groups.clone())
    );
    assert_eq!(found.materials[1].pictures.color, Some(Picture::file("models/toy.png")));
    let names: Vec<&str> = found.frames.iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(names, ["walk1", "walk2"]);
    assert_eq!(found.sequences().len(), 1);
    let second = found.at(1);
    second.validate().expect("valid");
    assert_eq!((found.mesh.points[3], second.points[3]), (DVec3::Z, DVec3::Z * 2.0));
    assert!(second.normals.iter().all(|normal| normal.distance(DVec3::Y) < 1e-12));
    // Counter-clockwise: the volume is positive.
    let volume: f64 = (0..4)
        .map(|face| {
            let [a, b, c] = [0, 1, 2].map(|k| second.points[second.corners[3 * face + k].subscript()]);
            a.cross(b).dot(c) / 6.0
        })
        .sum();
    assert!((volume - 2.0 / 6.0).abs() < 1e-12, "{volume}");
    let tag = &found.tags[0];
    assert_eq!((tag.name.as_str(), tag.places[1].translation), ("tag_hand", DVec3::new(1.0, 2.0, 4.0)));
    assert_eq!(tag.places[1].matrix3, DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z));
}

#[test]
fn one_surface_is_read_alone() {
    let found = read(&file(), Some("hat")).expect("a model");
    assert_eq!((found.mesh.faces.len(), found.mesh.materials.len()), (4, 1));
    assert_eq!(found.frames[1].points.len(), 4);
    let unknown = read(&file(), Some("head")).expect_err("refused");
    assert!(matches!(unknown, ImportError::UnknownGroup { known, .. } if known == ["body", "hat"]));
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused, and indices are in range.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    let whole = file();
    for length in 0..whole.len() {
        assert!(read(&whole[..length], None).is_err(), "{length} bytes");
    }
    let mut refused = 0;
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            match read(&bytes, None) {
                Ok(found) => {
                    (0..found.frames.len()).for_each(|frame| found.at(frame).validate().expect("valid"))
                }
                Err(fault) => {
                    assert!(!fault.to_string().is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 500, "{refused}");
}

#[test]
fn faults_name_what_they_found() {
    let with = |at: usize, value: i32| {
        let mut bytes = file();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        read(&bytes, None).expect_err("refused").to_string()
    };
    let first = 108 + 112 + 224;
    assert_eq!(with(4, 14), "this is version 14 of the format, and version 15 is read");
    assert_eq!(with(76, 0), "the header counts 0 frames");
    assert_eq!(
        with(80, i32::MAX),
        "tags of the file should stand at bytes 220 to 481036337148, and there is room from 0 to 1132"
    );
    assert_eq!(with(84, 3), "the header of a surface should stand at byte 1132, and the file has 1132");
    assert_eq!(with(first, 7), "surface 1 at byte 444 does not begin with `IDP3`, as surfaces do");
    assert_eq!(with(first + 72, 3), "surface `body` has 3 frames, and the file has 2");
    assert_eq!(with(first + 84, -1), "surface `body` counts -1 triangles");
    assert_eq!(
        with(first + 92, 0),
        "shaders of surface `body` should stand at bytes 0 to 68, and there is room from 108 to 344"
    );
    assert_eq!(
        with(first + 104, 64),
        "triangles of surface `body` should stand at bytes 108 to 156, and there is room from 108 to 64"
    );
    assert_eq!(with(first + 108, 5), "triangle 1 of surface `body` has point 5, and the surface has 5");
    let nan = f32::NAN.to_bits().cast_signed();
    assert_eq!(with(220 + 64, nan), "tag `tag_hand` in frame 1 has NaN, which is no finite number");
    assert_eq!(
        with(220 + 112 + 76, 0x4000_0000),
        "the axes of tag `tag_hand` in frame 2 are not of unit length and square to each other"
    );
    assert_eq!(read(b"IDP4", None), Err(Md3Fault::NotMd3.into()));
    assert!(matches!(read(b"IDP", None), Err(ImportError::Md3(Md3Fault::TooShort { .. }))));
}

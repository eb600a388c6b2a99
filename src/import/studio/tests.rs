use glam::DVec3;

use super::super::look::Picture;
use super::super::{ImportError, ImportOptions};
use super::{StudioFault, read, scene};
use crate::geometry::number::srgb_to_linear;

/// A chunk of a number and what is in it.
fn chunk(id: u16, parts: &[Vec<u8>]) -> Vec<u8> {
    let body = parts.concat();
    let length = u32::try_from(body.len() + 6).expect("small");
    [id.to_le_bytes().to_vec(), length.to_le_bytes().to_vec(), body].concat()
}

fn text(name: &str) -> Vec<u8> {
    [name.as_bytes(), b"\0"].concat()
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn shorts(numbers: &[u16]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A tetrahedron whose first point stands there twice, moved along x.
fn object(name: &str, along: f32) -> Vec<u8> {
    let places = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];
    let points: Vec<f32> = places.iter().flat_map(|[x, y, z]| [x + along, *y, *z]).collect();
    let faces = shorts(&[0, 2, 1, 7, 0, 1, 3, 7, 1, 2, 3, 7, 2, 4, 3, 7]);
    let worn = chunk(0x4130, &[text("brick"), shorts(&[2, 1, 3])]);
    let smooth = chunk(0x4150, &[words(&[1, 1, 3, 2])]);
    let uvs: Vec<f32> = (0..10_u8).map(f32::from).collect();
    let mesh = [
        chunk(0x4110, &[shorts(&[5]), floats(&points)]),
        chunk(0x4140, &[shorts(&[5]), floats(&uvs)]),
        chunk(0x4160, &[floats(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, along, 0.0, 0.0])]),
        chunk(0x4120, &[shorts(&[4]), faces, worn, smooth]),
    ];
    chunk(0x4000, &[text(name), chunk(0x4100, &mesh)])
}

/// Keys of vectors, each `frame x y z`, the second with tension 1.
fn track(id: u16, keys: &[(u32, &[f32])]) -> Vec<u8> {
    let mut parts = vec![shorts(&[0]), words(&[0, 0, u32::try_from(keys.len()).expect("few")])];
    for (number, (frame, values)) in keys.iter().enumerate() {
        parts.push(words(&[*frame]));
        parts.push(if number == 1 { [shorts(&[1]), floats(&[1.0])].concat() } else { shorts(&[0]) });
        parts.push(floats(values));
    }
    chunk(id, &parts)
}

fn node(id: u16, name: &str, number: u16, parent: u16, tracks: &[Vec<u8>]) -> Vec<u8> {
    let head = [chunk(0xb030, &[shorts(&[number])]), chunk(0xb010, &[text(name), shorts(&[0, 0, parent])])];
    chunk(id, &[head.concat(), tracks.concat()])
}

fn file() -> Vec<u8> {
    let material = chunk(
        0xafff,
        &[
            chunk(0xa000, &[text("brick")]),
            chunk(0xa020, &[chunk(0x0011, &[vec![255, 51, 0]])]),
            chunk(0xa050, &[chunk(0x0030, &[shorts(&[25])])]),
            chunk(0xa200, &[chunk(0x0030, &[shorts(&[100])]), chunk(0xa300, &[text("BRICK.JPG")])]),
        ],
    );
    let lamp = chunk(
        0x4600,
        &[
            floats(&[1.0, 2.0, 3.0]),
            chunk(0x0010, &[floats(&[1.0, 0.5, 0.0])]),
            chunk(0x4610, &[floats(&[1.0, 2.0, 0.0, 40.0, 50.0])]),
            chunk(0x465b, &[floats(&[2.0])]),
        ],
    );
    let camera = chunk(
        0x4700,
        &[floats(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 50.0]), chunk(0x4720, &[floats(&[1.0, 100.0])])],
    );
    let editor = [
        material,
        object("left", 0.0),
        object("right", 4.0),
        chunk(0x4000, &[text("Lamp"), lamp]),
        chunk(0x4000, &[text("Eye"), camera]),
    ];
    let quarter = std::f32::consts::FRAC_PI_2;
    let nodes = [
        chunk(0xb008, &[words(&[0, 20])]),
        // Written before its parent.
        node(0xb002, "right", 7, 3, &[track(0xb020, &[(0, &[4.0, 0.0, 0.0])])]),
        node(
            0xb002,
            "left",
            3,
            0xffff,
            &[
                chunk(0xb013, &[floats(&[0.5, 0.0, 0.0])]),
                track(0xb020, &[(0, &[0.0, 0.0, 0.0]), (10, &[2.0, 0.0, 0.0]), (20, &[2.0, 4.0, 0.0])]),
                track(
                    0xb021,
                    &[
                        (0, &[0.0, 0.0, 0.0, 1.0]),
                        (10, &[quarter, 0.0, 0.0, 1.0]),
                        (20, &[quarter, 1.0, 0.0, 0.0]),
                    ],
                ),
                track(0xb022, &[(0, &[1.0, 1.0, 1.0])]),
                track(0xb029, &[(5, &[]), (8, &[])]),
            ],
        ),
        node(0xb003, "Eye", 9, 0xffff, &[track(0xb020, &[(0, &[5.0, 0.0, 0.0])])]),
    ];
    chunk(0x4d4d, &[chunk(0x0002, &[words(&[3])]), chunk(0x3d3d, &editor), chunk(0xb000, &nodes)])
}

#[test]
fn meshes_materials_and_smoothing_are_read() {
    let found = read(&file(), &ImportOptions::default()).expect("a mesh");
    found.mesh.validate().expect("valid");
    assert_eq!((found.mesh.points.len(), found.mesh.faces.len()), (8, 8), "equal points are one");
    assert_eq!(found.groups, ["left", "right"]);
    let look = &found.materials[0];
    assert_eq!((look.color, look.opacity), (Some([1.0; 3]), Some(0.75)), "its picture covers its color");
    assert_eq!(look.pictures.color, Some(Picture::file("BRICK.JPG")));
    let faces: Vec<(Option<u32>, u32)> =
        found.mesh.faces[..4].iter().map(|face| (face.material, face.smoothing)).collect();
    assert_eq!(faces, [(None, 1), (Some(0), 1), (None, 3), (Some(0), 2)]);
    assert_eq!(found.mesh.uvs[4].to_array(), [8.0, -8.0], "v counts from below");
    assert_eq!(found.notes.len(), 1, "{:?}", found.notes);
    let alone = ImportOptions { group: Some("right".to_owned()), ..ImportOptions::default() };
    let alone = read(&file(), &alone).expect("a mesh").mesh;
    assert_eq!((alone.faces.len(), alone.points[1]), (4, DVec3::new(5.0, 0.0, 0.0)));
    let unknown = ImportOptions { group: Some("Eye".to_owned()), ..ImportOptions::default() };
    assert!(matches!(read(&file(), &unknown), Err(ImportError::UnknownGroup { .. })));
}

#[test]
fn cameras_lights_and_nodes_are_read() {
    let found = scene::read(&file()).expect("a scene");
    let camera = &found.cameras[0];
    assert_eq!(
        (camera.name.as_str(), camera.lens, camera.roll, camera.range),
        ("Eye", 50.0, 10.0, Some((1.0, 100.0)))
    );
    let light = &found.lights[0];
    assert_eq!((light.color, light.strength, light.on), ([1.0, srgb_to_linear(0.5), 0.0], 2.0, true));
    assert_eq!(light.spot, Some((DVec3::new(1.0, 2.0, 0.0), 40.0, 50.0)));
    assert_eq!(found.frames, Some((0, 20)));
    let told: Vec<(&str, Option<usize>)> =
        found.nodes.iter().map(|node| (node.name.as_str(), node.parent)).collect();
    assert_eq!(told, [("left", None), ("right", Some(0)), ("Eye", None)], "parents first");
    assert_eq!((found.nodes[0].hidden.as_slice(), found.nodes[0].pivot), (&[5, 8][..], DVec3::X * 0.5));
    assert!(found.nodes[0].moves() && !found.nodes[1].moves());
}

#[test]
fn tracks_go_through_their_keys_as_their_splines_have_it() {
    let found = scene::read(&file()).expect("a scene");
    let node = &found.nodes[0];
    let place = |frame: f64| node.position.numbers(frame).expect("keys").truncate();
    for (frame, wanted) in [
        (-3.0, [0.0, 0.0, 0.0]),
        (0.0, [0.0, 0.0, 0.0]),
        (10.0, [2.0, 0.0, 0.0]),
        (20.0, [2.0, 4.0, 0.0]),
        (99.0, [2.0, 4.0, 0.0]),
    ] {
        assert!(place(frame).distance(DVec3::from_array(wanted)) < 1e-12, "{frame}");
    }
    // The key in the middle has tension 1: nothing moves there. At the ends the slope is 3/2 of the way.
    assert!((place(10.001) - place(10.0)).length() < 1e-6);
    let s = 0.5;
    let hermite = 2.0 * (s * s * (3.0 - 2.0 * s)) + 3.0 * s * (1.0 - s) * (1.0 - s);
    assert!((place(5.0).x - hermite).abs() < 1e-12, "{}", place(5.0));
    // Clockwise by a quarter about z, then about x of the parent.
    let turned = |frame: f64, point: DVec3| node.rotation.rotation(frame).expect("keys") * point;
    assert!(turned(10.0, DVec3::X).distance(-DVec3::Y) < 1e-6);
    assert!(turned(20.0, DVec3::X).distance(DVec3::Z) < 1e-6, "{}", turned(20.0, DVec3::X));
    assert!(node.rotation.rotation(15.0).expect("keys").is_normalized());
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused, and what is read is sound.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    let whole = file();
    for length in 0..whole.len() {
        assert!(scene::read(&whole[..length]).is_err(), "{length} bytes");
    }
    let mut refused = 0;
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            match read(&bytes, &ImportOptions::default()) {
                Ok(found) => found.mesh.validate().expect("valid"),
                Err(fault) => {
                    assert!(!fault.to_string().is_empty());
                    refused += 1;
                }
            }
            for node in scene::read(&bytes).map(|scene| scene.nodes).unwrap_or_default() {
                let places = [0.0, 3.0, 12.5]
                    .map(|frame| (node.position.numbers(frame), node.rotation.rotation(frame)));
                assert!(places.iter().all(|(place, _)| place.is_none_or(|place| place.is_finite())));
                assert!(places.iter().all(|(_, turn)| turn.is_none_or(|turn| turn.is_normalized())));
            }
        }
    }
    assert!(refused > 500, "{refused}");
}

#[test]
fn faults_name_what_they_found() {
    let refused = |parts: &[Vec<u8>]| scene::read(&chunk(0x4d4d, parts)).expect_err("refused").to_string();
    let long = [vec![0x3d, 0x3d], words(&[99])].concat();
    assert_eq!(refused(&[long]), "chunk 0x3d3d at byte 6 has 99 bytes, and there are 6");
    let mesh = |parts: &[Vec<u8>]| chunk(0x3d3d, &[chunk(0x4000, &[text("a"), chunk(0x4100, parts)])]);
    assert_eq!(
        refused(&[mesh(&[chunk(0x4110, &[shorts(&[2]), floats(&[0.0; 3])])])]),
        "chunk 0x4110 at byte 26 ends inside points"
    );
    assert_eq!(
        refused(&[mesh(&[chunk(0x4110, &[shorts(&[1]), floats(&[0.0, f32::NAN, 0.0])])])]),
        "chunk 0x4110 at byte 26 has NaN for a coordinate, which is no finite number"
    );
    assert_eq!(
        refused(&[mesh(&[chunk(0x4120, &[shorts(&[1, 0, 1, 2, 7])])])]),
        "object `a` names point 0, and has 0, counted from 0"
    );
    assert_eq!(
        refused(&[mesh(&[chunk(0x4120, &[shorts(&[0]), chunk(0x4130, &[text("m"), shorts(&[1, 3])])])])]),
        "object `a` names face 3, and has 0, counted from 0"
    );
    let circle = [node(0xb002, "a", 0, 1, &[]), node(0xb002, "b", 1, 0, &[])];
    assert_eq!(
        refused(&[chunk(0xb000, &circle)]),
        "node `a` is carried by node 1, which carries it in a circle"
    );
    let back = node(0xb002, "a", 0, 0xffff, &[track(0xb020, &[(5, &[0.0; 3]), (5, &[0.0; 3])])]);
    assert_eq!(
        refused(&[chunk(0xb000, &[back])]),
        "the keys of node `a` do not follow each other: frame 5 stands after frame 5"
    );
    assert_eq!(scene::read(b"MMx"), Err(StudioFault::NotStudio));
    assert_eq!(scene::read(b"BLENDER"), Err(StudioFault::NotStudio));
}

use glam::{DVec2, DVec3};

use super::super::{ImportError, ImportOptions, Imported, MaterialLook};
use super::{PlyFault, read};
use crate::geometry::mesh::Color;
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::number::srgb_to_linear;

const TEXT: &str = "ply\nformat ascii 1.0\ncomment two faces\nelement vertex 5\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty float s\nproperty float t\nelement other 1\nproperty list uchar int things\nelement face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 255 1 0\n1 1 0 0 0 1 255 1 1\n0 1 0 0 0 1 255 0 1\n2 0.5 0 0 0 2 255 0.5 0.25\n3 7 8 9\n1 4 0 1 2 3\n1 3 1 4 2\n";

/// The same numbers in binary.
fn binary(big: bool) -> Vec<u8> {
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let (head, body) = TEXT.split_at(TEXT.find("end_header\n").expect("a header") + 11);
    let mut bytes = head.replace("ascii", name).into_bytes();
    let mut numbers = body.split_ascii_whitespace().map(|word| word.parse::<f32>().expect("a number"));
    let mut put = |size: usize| {
        let number = numbers.next().expect("a number");
        let mut word = match size {
            1 => vec![crate::geometry::number::floor_count(f64::from(number)).to_le_bytes()[0]],
            4 => number.to_le_bytes().to_vec(),
            8 => f64::from(number).to_le_bytes().to_vec(),
            _ => crate::geometry::number::floor_count(f64::from(number)).to_le_bytes().to_vec(),
        };
        if big {
            word.reverse();
        }
        bytes.extend(word);
    };
    for _ in 0..5 {
        [4, 4, 8, 4, 4, 4, 1, 4, 4].into_iter().for_each(&mut put);
    }
    // Whole numbers of four bytes.
    [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0].into_iter().for_each(put);
    bytes
}

fn model(bytes: &[u8]) -> Imported {
    read(bytes, &ImportOptions::default()).expect("a mesh")
}

#[test]
fn points_have_places() {
    let fault = read(TEXT.replace("float x", "float q").as_bytes(), &ImportOptions::default());
    let message = fault.expect_err("no x").to_string();
    assert!(message.contains("no properties `x`, `y` and `z`, it has `q`, `y`, `z`, `nx`"), "{message}");
}

/// Faces show the pictures of their numbers, as MeshLab writes them; without numbers the first.
#[test]
fn pictures_are_named_by_comments() {
    let pictured =
        TEXT.replace("comment two faces", "comment TextureFile a b.png\ncomment TextureFile c.png");
    let materials = |text: &str| {
        let found = model(text.as_bytes());
        found.mesh.validate().expect("valid");
        assert_eq!(found.materials[0], MaterialLook::pictured("texture-1", "a b.png"));
        assert_eq!(found.mesh.materials, ["texture-1", "texture-2"]);
        found.mesh.faces.iter().map(|face| face.material).collect::<Vec<_>>()
    };
    assert_eq!(materials(&pictured), [Some(0), Some(0)]);
    let numbered = pictured.replace("uchar flags", "uchar texnumber");
    assert_eq!(materials(&numbered), [Some(1), Some(1)]);
    let beyond = numbered.replace("\n1 3 1 4 2\n", "\n2 3 1 4 2\n");
    assert_eq!(materials(&beyond), [Some(1), None]);
}

#[test]
fn text_and_binary_of_both_orders_are_one_mesh() {
    let text = model(TEXT.as_bytes());
    assert_eq!(text.mesh.points[4], DVec3::new(2.0, 0.5, 0.0));
    assert_eq!(text.mesh.corners.iter().map(|corner| corner.0).collect::<Vec<_>>(), [0, 1, 2, 3, 1, 4, 2]);
    assert_eq!(text.mesh.loop_ends, [4, 7]);
    assert_eq!(text.mesh.normals[4], DVec3::Z * 2.0);
    assert_eq!(text.mesh.uvs[4], DVec2::new(0.5, 0.75), "v counts from below");
    assert_eq!(text.notes, []);
    assert!(text.mesh.corner_colors.is_empty(), "red alone is no color");
    text.mesh.validate().expect("valid");
    for big in [false, true] {
        assert_eq!(model(&binary(big)), text, "big {big}");
    }
    let returns = TEXT.replace('\n', "\r\n");
    assert_eq!(model(returns.as_bytes()), text);
}

#[test]
fn corners_have_places_of_their_own_and_strips_are_triangles() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 0\n";
    let found = model(text.as_bytes()).mesh;
    assert_eq!(found.corner_uvs, [0, 1, 2, NONE, NONE, NONE]);
    assert_eq!(found.uvs[2], DVec2::new(1.0, 0.0));
    found.validate().expect("valid");
    let strips = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 3 4\n";
    let found = model(strips.as_bytes()).mesh;
    let corners: Vec<u32> = found.corners.iter().map(|corner| corner.0).collect();
    assert_eq!(corners, [0, 1, 2, 2, 1, 3]);
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    for whole in [TEXT.as_bytes().to_vec(), binary(false), binary(true)] {
        for length in 0..whole.len() - 2 {
            assert!(read(&whole[..length], &ImportOptions::default()).is_err(), "{length} bytes");
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
            }
        }
        assert!(refused > 500, "{refused}");
    }
}

#[test]
fn faults_name_what_they_found() {
    let told = |from: &str, to: &str| {
        assert!(TEXT.contains(from), "{from}");
        read(TEXT.replacen(from, to, 1).as_bytes(), &ImportOptions::default())
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(told("ply", "plo"), "line 1 of the header: expected `ply`, found `plo`");
    assert!(told("ascii", "text").starts_with("line 2 of the header: expected `ascii`"));
    assert!(told("float x", "real x").starts_with("line 5 of the header: expected a property"));
    assert!(told("vertex 5", "vertex 900000000").contains("need at least 16199999999 bytes, and"));
    assert_eq!(told("2 0.5 0", "2 nan 0"), "`y` of `vertex` 5 is `NaN`, which is no finite number");
    assert_eq!(told("2 0.5 0", "2 half 0"), "`y` of `vertex` 5 is `half`, which is no finite number");
    assert_eq!(
        told("1 3 1 4 2", "1 3 1 4 5"),
        "`face` 2 has the point 5, and the file has 5, counted from 0"
    );
    assert_eq!(told("1 3 1 4 2\n", "1 3 1 4"), "the file ends inside `face` 2");
    let empty = read(TEXT.replace("element face 2", "element fake 2").as_bytes(), &ImportOptions::default());
    assert!(matches!(empty, Err(ImportError::NoFaces { vertices: 5 })));
    let wide = "ply\nformat binary_little_endian 1.0\nelement nothing 4000000000\nend_header\n";
    let found = read(wide.as_bytes(), &ImportOptions::default());
    assert!(matches!(found, Err(ImportError::Ply(PlyFault::Truncated { .. }))));
}

/// A square of two triangles whose points and faces have properties of their own.
fn square(points: &str, faces: &str, rows: [&str; 6]) -> String {
    let [a, b, c, d, one, other] = rows;
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{points}element face 2\nproperty list uchar int vertex_index\n{faces}end_header\n0 0 0 {a}\n1 0 0 {b}\n1 1 0 {c}\n0 1 0 {d}\n3 0 1 2 {one}\n3 0 2 3 {other}\n"
    )
}

#[test]
fn colors_of_points_and_of_faces_are_those_of_screens() {
    let bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    let text = square(bytes, "", ["255 0 51 255", "0 255 0 51", "10 20 30 255", "255 255 255 255", "", ""]);
    let found = model(text.as_bytes());
    assert_eq!(found.notes, []);
    let light = |byte: u8| srgb_to_linear(f64::from(byte) / 255.0);
    assert_eq!(found.mesh.colors[0], Color::held([1.0, 0.0, light(51), 1.0]));
    assert_eq!(found.mesh.colors[1], Color::held([0.0, 1.0, 0.0, 0.2]), "opacity is no light");
    assert_eq!(found.mesh.colors[2], Color::held([light(10), light(20), light(30), 1.0]));
    assert_eq!(found.mesh.corner_colors, [0, 1, 2, 0, 2, 3]);
    found.mesh.validate().expect("valid");

    let floats = "property float red\nproperty float green\nproperty float blue\n";
    let text = square("", floats, ["", "", "", "", "1 0.5 0", "0 0 2"]);
    let found = model(text.as_bytes());
    assert_eq!(found.mesh.colors[0], Color::held([1.0, srgb_to_linear(0.5), 0.0, 1.0]));
    assert_eq!(found.mesh.colors[1], Color::held([0.0, 0.0, 1.0, 1.0]));
    assert_eq!(found.mesh.corner_colors, [0, 0, 0, 1, 1, 1]);
    assert_eq!(found.notes.len(), 1, "one color is held back: {:?}", found.notes);

    let both = square(bytes, floats, ["1 2 3 4", "1 2 3 4", "1 2 3 4", "1 2 3 4", "0 0 0", "0 0 0"]);
    let found = model(both.as_bytes());
    assert_eq!((found.mesh.colors.len(), found.notes.len()), (4, 1), "{:?}", found.notes);
}

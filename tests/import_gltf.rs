//! glTF files of other programs: good ones are read, broken ones are refused, none of them does harm.

use std::path::Path;

use kiln::import::gltf::read;
use kiln::import::{ImportError, ImportOptions, Imported};

use crate::import::{cases, json_of};

/// No file here has more triangles.
const MOST: u64 = 1 << 20;

fn read_file(path: &Path) -> Result<Imported, ImportError> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    read_bytes(&bytes, path)
}

fn read_bytes(bytes: &[u8], path: &Path) -> Result<Imported, ImportError> {
    let folder = path.parent().expect("a folder");
    // As the door of a project does it: nothing outside of the folder.
    let mut open = |name: &str| {
        let inside = !name.contains("..") && !name.starts_with('/');
        inside.then(|| std::fs::read(folder.join(name)).ok()).flatten()
    };
    read(bytes, &ImportOptions { most: MOST, ..ImportOptions::default() }, &mut open)
}

/// Triangles that the files' own indices count.
const GOOD: [(&str, usize); 12] = [
    ("AnimatedMorphCube/AnimatedMorphCube.gltf", 12),
    ("AnimatedTriangle.gltf", 1),
    ("BoxInterleaved.glb", 12),
    ("BoxTexcoords/boxTexcoords.gltf", 12),
    ("CesiumMan.glb", 4672),
    ("Fox.glb", 576),
    ("RiggedSimple.glb", 892),
    ("SimpleMorph/SimpleMorph.gltf", 1),
    ("SimpleSkin.gltf", 8),
    ("boolean.glb", 3936),
    ("cubevc.glb", 48),
    ("monkey.glb", 968),
];

#[test]
fn files_of_others_are_read_whole() {
    let Some(folder) = cases(GOOD.len(), "glTF files") else { return };
    for (name, triangles) in GOOD {
        let found =
            read_file(&folder.join("gltf").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(found.mesh.faces.len(), triangles, "{name}");
        found.mesh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn every_kind_of_primitive_is_read_or_told() {
    let Some(folder) = cases(8, "glTF files") else { return };
    // The Khronos asset generator: points, a loop of lines, a strip and a list of triangles, lines, a strip of lines, a fan,
    // and a list of triangles with indices.
    for (number, triangles) in
        [("00", 0), ("02", 0), ("04", 2), ("06", 2), ("08", 0), ("10", 0), ("12", 2), ("14", 2)]
    {
        let path = folder.join(format!("gltf/primitive_mode/Mesh_PrimitiveMode_{number}.gltf"));
        match read_file(&path) {
            Ok(found) => assert_eq!(found.mesh.faces.len(), triangles, "{number}"),
            Err(ImportError::NoFaces { .. }) => assert_eq!(triangles, 0, "{number}"),
            Err(error) => panic!("{number}: {error}"),
        }
    }
}

#[test]
fn broken_and_hostile_files_are_refused() {
    let Some(folder) = cases(9, "glTF files") else { return };
    for name in [
        "gltf/bad/BoxTextured.gltf",
        "gltf/bad/IndexOutOfRange.gltf",
        "gltf/bad/NoScene.gltf",
        "gltf/bad/badArray.gltf",
        "gltf/bad/badObject.gltf",
        "hostile/gltf/accessor_count_huge.gltf",
        "hostile/gltf/joint_missing.gltf",
        "hostile/gltf/node_cycle.gltf",
        "hostile/gltf/uri_traversal.gltf",
    ] {
        let error = read_file(&folder.join(name)).expect_err(name);
        assert!(!error.to_string().is_empty() && error.hint().is_some(), "{name}");
    }
}

/// What the Khronos validator finds no error in is read, unless it has no triangles; the rest does no harm.
#[test]
fn the_corpus_of_the_validator_is_read_or_refused() {
    let Some(folder) = cases(136, "glTF files") else { return };
    let corpus = json_of(&folder.join("gltf/validator_corpus.json.gz"));
    let files = corpus["files"].as_object().expect("an object");
    assert_eq!(files.len(), 136);
    let mut refused = 0;
    for (name, file) in files {
        let bytes = decoded(file["file"].as_str().expect("text"));
        let found = read(&bytes, &ImportOptions { most: MOST, ..ImportOptions::default() }, &mut |_| None);
        refused += usize::from(found.is_err());
        if let Ok(found) = found {
            assert!(!found.mesh.faces.is_empty(), "{name}");
        }
    }
    assert!(refused > 96, "{refused}");
}

/// Base64 by shifts, apart from the reader's own.
fn decoded(text: &str) -> Vec<u8> {
    const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits: Vec<usize> = text.chars().filter_map(|letter| LETTERS.find(letter)).collect();
    let group = |digits: &[usize]| {
        let word = digits.iter().enumerate().fold(0, |word, (at, digit)| word | digit << (18 - 6 * at));
        let bytes = [word >> 16, word >> 8, word].map(|byte| u8::try_from(byte & 255).expect("a byte"));
        bytes[..digits.len().saturating_sub(1)].to_vec()
    };
    digits.chunks(4).flat_map(group).collect()
}

/// Files cut off anywhere are refused; files with a changed byte are read or refused, and nothing else.
#[test]
fn damage_is_borne() {
    let Some(folder) = cases(2, "glTF files") else { return };
    let mut tried = 0;
    for name in ["BoxInterleaved.glb", "SimpleSkin.gltf"] {
        let path = folder.join("gltf").join(name);
        let bytes = std::fs::read(&path).expect("the file");
        for length in (0..bytes.len() - 4).step_by(7) {
            assert!(read_bytes(&bytes[..length], &path).is_err(), "{name} cut at {length}");
            tried += 1;
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            if let Ok(found) = read_bytes(&changed, &path) {
                let _ = found.mesh.validate();
            }
        }
        tried += bytes.len();
    }
    crate::counts::tried("damaged-gltf-files", tried);
}

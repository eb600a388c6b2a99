//! Files made to break readers, through documents that name them.
//!
//! They lie outside the repository, in the folder that the variable `KILN_CASES` names; without it this test prints how
//! many were not tried.

use std::path::PathBuf;

use kiln::compile::{Compiled, Options};
use kiln::language::Document;
use kiln::language::diagnostic::Diagnostics;
use kiln::language::source::MemoryFiles;

use super::glb::Glb;

#[expect(clippy::print_stdout, reason = "a test that does not run must say so")]
fn folder(count: usize) -> Option<PathBuf> {
    let folder = std::env::var_os("KILN_CASES").map(PathBuf::from);
    if folder.is_none() {
        println!("KILN_CASES is not set: {count} hostile files not tried");
    }
    folder
}

fn run(path: &str, bytes: Vec<u8>) -> Result<Compiled, Diagnostics> {
    let text = if path.ends_with(".png") {
        format!(
            "[material.x]\ncolor-texture = \"{path}\"\n[shape.a]\nmaterial = \"x\"\n[shape.a.box]\nsize = [1, 1, 1]\n"
        )
    } else {
        format!("[shape.a.import]\nfile = \"{path}\"\n")
    };
    let files = MemoryFiles::new().with("spec.toml", text).with(path, bytes);
    let document = Document::load("spec.toml", &files)?;
    kiln::compile(&document, &files, &Options { name: "x".to_owned(), ..Options::default() })
}

/// Each file with a part of the message that refuses it, or nothing where it must load.
const HOSTILE: [(&str, Option<&str>); 18] = [
    ("obj/index_huge.obj", Some("99999999999999999999")),
    ("obj/index_zero.obj", Some("index 0")),
    ("obj/nan_vertex.obj", Some("`nan` is not a finite number")),
    ("obj/negative_too_far.obj", Some("vertex -9 does not exist")),
    ("obj/nul_bytes.obj", Some("0x00")),
    ("obj/path_traversal.obj", None),
    ("obj/utf8_bom.obj", None),
    ("stl/ascii_two_vertices.stl", Some("spec.toml")),
    ("stl/binary_named_solid.stl", None),
    ("stl/count_4g.stl", Some("4294967295")),
    ("stl/nan_vertex.stl", Some("not a finite number")),
    ("stl/short_header.stl", Some("60 bytes")),
    ("png/bomb_25000sq_1bit.png", Some("25000")),
    ("png/dims_2147483647_sq.png", Some("2147483647")),
    ("png/dims_zero.png", Some("zero")),
    ("png/palette_missing.png", Some("palette")),
    ("png/short_data.png", Some("")),
    ("png/truncated_mid_idat.png", Some("")),
];

#[test]
fn hostile_files_are_refused_or_read() {
    let Some(folder) = folder(HOSTILE.len()) else { return };
    let mut wrong = Vec::new();
    let mut listed = 0;
    for (name, expected) in HOSTILE {
        let bytes = std::fs::read(folder.join("hostile").join(name)).expect("the case is there");
        listed += 1;
        let short = name.rsplit('/').next().unwrap_or(name);
        match (run(short, bytes), expected) {
            (Ok(compiled), None) => Glb::new(&compiled.bytes).check(),
            (Err(found), Some(part)) => {
                let text = found.render(false);
                let placed = found.iter().all(|one| one.place().is_some());
                if !text.contains(part) || !placed {
                    wrong.push(format!("{name}: expected `{part}` in\n{text}"));
                }
            }
            (Ok(_), Some(_)) => wrong.push(format!("{name} was accepted")),
            (Err(found), None) => wrong.push(format!("{name} was refused:\n{found}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let there = |kind: &str| std::fs::read_dir(folder.join("hostile").join(kind)).expect("a folder").count();
    assert_eq!(listed, there("obj") + there("stl") + there("png"), "every file of the folder is tried");
    crate::counts::tried("hostile-files", listed);
}

/// Broken images and meshes of other people: never a panic, and a refusal says where.
#[test]
fn broken_files_of_other_programs_are_refused_or_read() {
    let Some(folder) = folder(60) else { return };
    let mut tried = 0;
    for kind in ["png/bad", "png/valid", "obj/bad", "obj", "stl"] {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder.join(kind))
            .expect("a folder")
            .map(|entry| entry.expect("it is read").path())
            .collect();
        paths.sort();
        for path in paths.into_iter().filter(|path| path.is_file()) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let known = [".obj", ".stl", ".STL", ".png"].iter().any(|ending| name.ends_with(ending));
            if !known || path.metadata().is_ok_and(|facts| facts.len() > 2_000_000) {
                continue;
            }
            tried += 1;
            match run(&name, std::fs::read(&path).expect("the case is there")) {
                Ok(compiled) => Glb::new(&compiled.bytes).check(),
                Err(found) => assert!(found.iter().all(|one| one.place().is_some()), "{name}: {found}"),
            }
        }
    }
    assert!(tried >= 60, "{tried}");
    crate::counts::tried("broken-files", tried);
}

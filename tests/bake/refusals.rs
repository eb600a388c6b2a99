//! What cannot be baked, told in the language: cases with the expected messages beside them, as in
//! `tests/language/cases.rs`. Beside each case stand the files of [`inputs`](super::inputs) and a few broken ones.

use kiln::compile::Options;
use kiln::language::Document;
use kiln::language::diagnostic::Diagnostics;
use kiln::language::source::MemoryFiles;

use crate::language::cases::{Case, check_folder};

/// The case's own files, and broken ones that a text cannot hold.
fn with_broken(files: MemoryFiles) -> MemoryFiles {
    let png: &[u8] = include_bytes!("../../specs/inputs/label.png");
    let mut bomb = png.to_vec();
    bomb[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let mut sum = flate2::Crc::new();
    sum.update(&bomb[12..29]);
    bomb[29..33].copy_from_slice(&sum.sum().to_be_bytes());
    let mut liar = vec![0; 84 + 50];
    liar[80..84].copy_from_slice(&1_000_000_u32.to_le_bytes());
    files
        .with("label.png", png)
        .with("half.png", &png[..png.len() / 2])
        .with("bomb.png", bomb)
        .with("text.png", "not an image")
        .with("bird.obj", include_str!("../../specs/inputs/bird.obj"))
        .with("liar.stl", liar)
        .with("empty.obj", "")
        .with("scene.blend", b"BLENDER-v293".as_slice())
        .with("packed.obj", b"BLENDER-v293".as_slice())
        .with("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
}

fn found(case: &Case, files: MemoryFiles) -> Diagnostics {
    let files = with_broken(files);
    let document = match Document::load("case.toml", &files) {
        Ok(document) => document,
        Err(found) => return found,
    };
    let options = Options {
        variant: case.variant.clone(),
        overrides: case.overrides.clone(),
        name: "case".to_owned(),
        ..Options::default()
    };
    match kiln::compile(&document, &files, &options) {
        Ok(compiled) => compiled.warnings,
        Err(found) => found,
    }
}

#[test]
fn every_case_gives_the_messages_beside_it() {
    check_folder("tests/bake/cases", 50, found);
}

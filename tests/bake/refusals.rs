//! What cannot be baked, told in the language: cases with the expected messages beside them, as in
//! `tests/language/cases.rs`. Beside each case stand the files of [`inputs`](super::inputs) and a few broken ones.

use kiln::compile::Options;
use kiln::language::Document;
use kiln::language::diagnostic::Diagnostics;
use kiln::language::source::MemoryFiles;

use crate::language::cases::{Case, check_folder};

/// A model with frames.
const CATERPILLAR: &[u8] = include_bytes!("../../specs/inputs/caterpillar.md2");

/// Models of frames with tags, and of joints with a motion.
const BEETLE: &[u8] = include_bytes!("../../specs/inputs/beetle.md3");
const LAMP: &str = include_str!("../../specs/inputs/lamp.md5mesh");
const PLATE: &str = include_str!("../../specs/inputs/plate.dxf");
const BOW: &str = include_str!("../../specs/inputs/lamp-bow.md5anim");

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
        .with("caterpillar.md2", CATERPILLAR)
        .with("half.md2", &CATERPILLAR[..CATERPILLAR.len() / 2])
        .with("bird.md2", include_str!("../../specs/inputs/bird.obj"))
        .with("windmill.3ds", include_bytes!("../../specs/inputs/windmill.3ds").as_slice())
        .with("plate.dxf", PLATE)
        .with("half.dxf", &PLATE[..PLATE.find(" 40\n10").expect("an arc") + 4])
        .with("bird.3ds", include_str!("../../specs/inputs/bird.obj"))
        .with("half.3ds", b"MM\x20\0\0\0\x3d\x3d\x10\0\0\0".as_slice())
        .with("beetle.md3", BEETLE)
        .with("half.md3", &BEETLE[..BEETLE.len() / 2])
        .with("bird.md3", include_str!("../../specs/inputs/bird.obj"))
        .with("old.md4", b"IDP4\x01\0\0\0".as_slice())
        .with("lamp.md5mesh", LAMP)
        .with("half.md5mesh", &LAMP[..LAMP.len() / 2])
        .with("bird.md5mesh", include_str!("../../specs/inputs/bird.obj"))
        .with("lamp-bow.md5anim", BOW)
        .with("half.md5anim", &BOW[..BOW.len() / 2])
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

/// Forty-eight groups of twice the one before are refused at once, with a texture to look for or without.
#[test]
fn doubling_groups_are_refused_at_once() {
    let mut text = "[shape.s0.box]\nsize = [1, 1, 1]\n".to_owned();
    for level in 1..48 {
        let below = level - 1;
        text.push_str(&format!("[shape.s{level}]\nat = [{level}, 0, 0]\n[shape.s{level}.group]\nof = [\"s{below}\", \"s{below}\"]\n"));
    }
    let files = MemoryFiles::new().with("case.toml", text);
    let document = Document::load("case.toml", &files).expect("it can be read");
    let options = Options { name: "case".to_owned(), ..Options::default() };
    let found = kiln::compile(&document, &files, &options).expect_err("it is refused");
    assert!(found.iter().any(|one| one.code.text() == "K0901"), "{}", found.render(false));
}

/// Chords over whole turns of a path look straight to samples; the bound must not believe them.
#[test]
fn paths_that_wind_many_times_are_followed() {
    for turns in [32, 64, 128] {
        for segments in ["", "[shape.a]\nsegments = [8, 16]\n"] {
            let text = format!(
                "tolerance = 0.01\n{segments}[shape.a.sweep]\nprofile = {{ circle = {{ radius = 0.02 }} }}\npath = {{ helix = {{ radius = 1, pitch = 0.1, turns = {turns} }} }}\n"
            );
            let files = MemoryFiles::new().with("case.toml", text);
            let document = Document::load("case.toml", &files).expect("it can be read");
            let options = Options { name: "case".to_owned(), measure: true, ..Options::default() };
            let compiled = kiln::compile(&document, &files, &options).expect("it bakes");
            let deviation = compiled.report.expect("a report").shapes["a"].deviation;
            let measured = deviation.measured.expect("it was measured");
            assert!(!segments.is_empty() || deviation.bound <= 0.01, "{turns}: {deviation:?}");
            assert!(measured <= deviation.bound, "{turns} {segments}: {deviation:?}");
        }
    }
}

/// Whichever bit of a scene is wrong: it is baked or refused.
#[test]
fn scenes_with_flipped_bits_are_baked_or_refused() {
    let whole: &[u8] = include_bytes!("../../specs/inputs/windmill.3ds");
    let text = "[node.mill.import]\nfile = \"mill.3ds\"\n";
    let (mut baked, mut refused) = (0, 0);
    for at in (0..whole.len()).step_by(17) {
        let mut bytes = whole.to_vec();
        bytes[at] ^= 1 << (at % 8);
        let files = MemoryFiles::new().with("case.toml", text).with("mill.3ds", bytes);
        let document = Document::load("case.toml", &files).expect("a document");
        match kiln::compile(&document, &files, &Options::default()) {
            Ok(_) => baked += 1,
            Err(found) => {
                assert!(!found.is_empty(), "byte {at}");
                refused += 1;
            }
        }
    }
    assert!(baked > 50 && refused > 20, "{baked} {refused}");
    crate::counts::tried("damaged-scenes", baked + refused);
}

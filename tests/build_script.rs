//! Baking from a build script: what is written, what Cargo is told, and that the module compiles.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use kiln::Build;

const VASE: &str = "include = [\"common/clay.toml\"]\n[shape.body]\nmaterial = \"clay\"\nattributes = { _WIND = \"= y\" }\n[shape.body.sphere]\nradius = 1\n\
                    [variant.tall.shape.body]\nscale = [1, 2, 1]\n[lod]\nlevels = 3";
const CLAY: &str = "[material.clay]\ncolor = \"#b5651d\"";
const PAWN: &str = "[parameters]\nsize = 1\n[shape.pawn-foot.box]\nsize = [\"= size\", 1, 1]";

/// A folder of assets and one for outputs.
fn project(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (assets, out) = (folder.path().join("assets"), folder.path().join("out"));
    for (name, text) in files {
        let path = assets.join(name);
        fs::create_dir_all(path.parent().expect("below")).expect("made");
        fs::write(path, text).expect("written");
    }
    (folder, assets, out)
}

fn whole() -> (tempfile::TempDir, PathBuf, PathBuf) {
    project(&[("vase.toml", VASE), ("common/clay.toml", CLAY), ("chess/pawn.toml", PAWN)])
}

fn modified(path: &Path) -> std::time::SystemTime {
    fs::metadata(path).and_then(|facts| facts.modified()).expect("it is there")
}

#[test]
fn a_folder_is_baked_with_all_that_it_reads() {
    let (_folder, assets, out) = whole();
    let done = Build::new(&assets).out_dir(&out).bake().expect("all is well");
    let files = ["chess/pawn.glb", "vase.glb", "vase.tall.glb"].map(|name| out.join(name));
    assert_eq!(done.files, files);
    assert!(files.iter().all(|file| fs::read(file).expect("written").starts_with(b"glTF")));
    assert!(out.join("vase.tall.report.json").is_file());
    let read = ["", "chess/pawn.toml", "common/clay.toml", "vase.toml"];
    assert_eq!(
        done.inputs,
        read.map(|name| if name.is_empty() { assets.clone() } else { assets.join(name) })
    );
    assert_eq!(done.module, out.join("assets.rs"));
}

#[test]
fn pictures_beside_files_are_written_and_come_from_the_cache() {
    let label = "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor-texture = \"label.png\"\n[output.textures]\nbeside = true";
    let (folder, assets, out) = project(&[("crate.toml", label)]);
    let grey = kiln::import::image::Pixels { width: 2, height: 2, rgba: vec![[90, 90, 90, 255]; 4] };
    let picture = kiln::import::image::png(&grey, false);
    fs::write(assets.join("label.png"), &picture).expect("written");
    let build = Build::new(&assets).out_dir(&out).cache(folder.path().join("cache"), 1 << 20);
    for _ in 0..2 {
        build.bake().expect("all is well");
        assert_eq!(fs::read(out.join("crate.label.png")).expect("it is there"), picture);
        fs::remove_file(out.join("crate.label.png")).expect("it is there");
    }
}

/// What is the same is not touched, so that nothing that depends on it is built again.
#[test]
fn unchanged_files_keep_their_times() {
    let (_folder, assets, out) = whole();
    let build = Build::new(&assets).out_dir(&out);
    build.bake().expect("all is well");
    let before = ["vase.glb", "chess/pawn.glb", "assets.rs"].map(|name| modified(&out.join(name)));
    std::thread::sleep(std::time::Duration::from_millis(20));
    build.clone().set("size", 2).bake().expect_err("vase has no parameter `size`");
    fs::write(assets.join("chess/pawn.toml"), PAWN.replace("size = 1\n", "size = 2\n")).expect("written");
    build.bake().expect("all is well");
    let after = ["vase.glb", "chess/pawn.glb", "assets.rs"].map(|name| modified(&out.join(name)));
    assert_eq!(before[0], after[0], "the vase is the same");
    assert!(before[1] < after[1], "the pawn is another");
    assert!(before[2] < after[2], "and so is its box");
}

const PROJECT: &str =
    "roots = [\"chess\"]\nprofiles = [\"core\", \"web\"]\n[parameters]\nsize = 3\nother = 1\n";

/// A project file in the root says what the build does not.
#[test]
fn a_project_file_in_the_root_is_heard() {
    let (_folder, assets, out) =
        project(&[("vase.toml", VASE), ("chess/pawn.toml", PAWN), ("kiln.toml", PROJECT)]);
    let build = Build::new(&assets).out_dir(&out);
    let done = build.bake().expect("all is well");
    assert_eq!(done.files, ["pawn.glb", "pawn.web.glb"].map(|name| out.join(name)));
    assert!(done.inputs.contains(&assets.join("kiln.toml")));
    let wide = |out: &Path| fs::read_to_string(out.join("assets.rs")).expect("written").contains("1.5");
    assert!(wide(&out), "the size of the project");
    let done = build.clone().set("size", 1).profile(kiln::Profile::Core).bake().expect("all is well");
    assert_eq!(done.files, [out.join("pawn.glb")]);
    assert!(!wide(&out), "what the build says wins");
    fs::write(assets.join("kiln.toml"), PROJECT.replace("roots", "rots")).expect("written");
    let failure = build.bake().expect_err("a misspelt word");
    assert!(failure.to_string().contains("did you mean `roots`?"), "{failure}");
    assert!(failure.inputs.contains(&assets.join("kiln.toml")));
}

/// What comes from the cache is what a bake gives, warnings too; a folder that cannot be used costs a warning.
#[test]
fn a_cache_gives_the_same_assets() {
    let folded =
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 2, 1, 3]]\n";
    let (folder, assets, out) =
        project(&[("vase.toml", VASE), ("common/clay.toml", CLAY), ("folded.toml", folded)]);
    let plain = Build::new(&assets).out_dir(&out).bake().expect("all is well");
    let cache = folder.path().join("cache");
    let files = |out: &Path| {
        let mut all: Vec<_> = fs::read_dir(out).expect("there").flatten().map(|entry| entry.path()).collect();
        all.sort();
        all.iter()
            .map(|path| (path.file_name().map(ToOwned::to_owned), fs::read(path).ok()))
            .collect::<Vec<_>>()
    };
    let right = files(&out);
    for _ in 0..2 {
        fs::remove_dir_all(&out).expect("gone");
        let done = Build::new(&assets).out_dir(&out).cache(&cache, 1 << 30).bake().expect("all is well");
        assert_eq!(done, plain);
        assert_eq!(files(&out), right);
    }
    let stats = kiln::cache::stats(&cache).expect("a cache");
    assert_eq!(stats.documents, 2);
    fs::remove_dir_all(&cache).expect("gone");
    fs::write(&cache, "no folder").expect("written");
    let done = Build::new(&assets).out_dir(&out).cache(&cache, 1 << 30).bake().expect("all is well");
    assert_eq!(done.warnings.len(), plain.warnings.len() + 1);
}

/// The module compiles, and says what the files say.
#[test]
fn the_module_is_rust() {
    let (folder, assets, out) = whole();
    Build::new(&assets).out_dir(&out).bake().expect("all is well");
    let program = folder.path().join("game.rs");
    let text = format!(
        "mod assets {{ include!({:?}); }}\nfn main() {{\n\
         assert!(assets::vase::BYTES.starts_with(b\"glTF\"));\n\
         assert_eq!((assets::vase_tall::BOUNDS[0][1], assets::vase_tall::BOUNDS[1][1]), (-2.0, 2.0));\n\
         assert_eq!(assets::chess::pawn::meshes::PAWN_FOOT, \"pawn-foot\");\n\
         assert_eq!(assets::vase::materials::ALL, [\"clay\"]);\n\
         assert_eq!(assets::vase::attributes::WIND, \"_WIND\");\n\
         let levels = assets::vase::lods::BODY;\n\
         assert_eq!(levels.iter().map(|(name, _)| *name).collect::<Vec<_>>(), [\"body\", assets::vase::meshes::BODY_LOD1, \"body_LOD2\"]);\n\
         assert!(levels[0].1 > levels[1].1 && levels[2].1 == 0.0);\n\
         assert_eq!(std::fs::read(assets::chess::pawn::PATH).unwrap(), assets::chess::pawn::BYTES);\n}}\n",
        out.join("assets.rs").display().to_string()
    );
    fs::write(&program, text).expect("written");
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let game = folder.path().join("game");
    let made = Command::new(rustc)
        .args(["--edition", "2024", "-o"])
        .arg(&game)
        .arg(&program)
        .output()
        .expect("rustc");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(Command::new(game).status().expect("it runs").success());
}

/// All errors of all documents, with their places; what is right is baked; the module stays.
#[test]
fn errors_are_told_together_and_the_module_stays() {
    let (_folder, assets, out) = whole();
    let build = Build::new(&assets).out_dir(&out);
    build.bake().expect("all is well");
    let module = fs::read(out.join("assets.rs")).expect("written");
    fs::write(assets.join("vase.toml"), VASE.replace("radius = 1", "radios = 1")).expect("written");
    fs::write(assets.join("chess/pawn.toml"), "[shape.a.box]\nsize = [0, 1, 1]").expect("written");
    let failure = build.bake().expect_err("two documents are wrong");
    let all = failure.to_string();
    assert!(all.contains("radios") && all.contains("--> vase.toml:6:1"), "{all}");
    assert!(all.contains("--> chess/pawn.toml:2:"), "{all}");
    assert_eq!(fs::read(out.join("assets.rs")).expect("written"), module);
    assert!(failure.inputs.contains(&assets.join("common/clay.toml")));
}

#[test]
fn names_that_would_be_one_in_rust_are_told() {
    let (_folder, assets, out) = project(&[("a-b.toml", PAWN), ("a_b.toml", PAWN)]);
    let failure = Build::new(&assets).out_dir(&out).bake().expect_err("two assets, one name");
    assert_eq!(failure.errors, ["a-b.glb and a_b.glb would both be `a_b` in Rust: rename one of them"]);
    let (_folder, assets, out) = project(&[]);
    fs::create_dir_all(&assets).expect("made");
    let failure = Build::new(&assets).out_dir(&out).bake().expect_err("nothing to bake");
    assert!(failure.to_string().starts_with("no document (.toml) in "), "{failure}");
    let failure = Build::new(assets.join("none")).out_dir(&out).bake().expect_err("no such folder");
    assert!(failure.to_string().ends_with("no such file or folder"), "{failure}");
}

//! How diagnostics look to people and to programs.

use kiln::language::Document;
use kiln::language::diagnostic::Diagnostics;
use kiln::language::source::MemoryFiles;

fn found() -> Diagnostics {
    let main = "include = [\"common/a.toml\"]\n[material.clay]\nrougness = 0.5\n";
    let files =
        MemoryFiles::new().with("main.toml", main).with("common/a.toml", "# shared\n[material.clay]\n");
    Document::load("main.toml", &files).expect_err("the name is there twice")
}

#[test]
fn people_see_the_lines_of_all_files() {
    let expected = "\
error[K0304]: material `clay` is defined twice
 --> main.toml:2:11
  |
2 | [material.clay]
  |           ^^^^ here
  |
 ::: common/a.toml:2:11
  |
2 | [material.clay]
  |           ---- and in an included document
  |
  = help: give one of them another name, or leave it out

error[K0101]: unknown field `rougness` of material
 --> main.toml:3:1
  |
3 | rougness = 0.5
  | ^^^^^^^^ not a field of material
  |
  = note: fields of material: color, metallic, roughness, color-texture, metallic-roughness-texture, \
roughness-texture, metallic-texture, normal-texture, normal-scale, occlusion-texture, occlusion-strength, emissive, emissive-texture, \
emissive-strength, alpha, alpha-cutoff, double-sided, unlit, ior, dispersion, clearcoat, transmission, volume, specular, sheen, \
iridescence, anisotropy
help: did you mean `roughness`?
  |
3 | roughness = 0.5
  |     +
";
    assert_eq!(found().render(false), expected);
    assert!(found().render(true).contains("\u{1b}["));
}

#[test]
fn programs_see_places_and_changes() {
    let json = found().to_json();
    let one = &json[1];
    assert_eq!((&one["severity"], &one["code"]), (&"error".into(), &"K0101".into()));
    assert_eq!((&one["file"], &one["line"], &one["column"]), (&"main.toml".into(), &3.into(), &1.into()));
    assert_eq!((&one["end_line"], &one["end_column"]), (&3.into(), &9.into()));
    assert_eq!(one["suggestion"]["replacement"], "roughness");
    assert_eq!(json[0]["labels"][1]["file"], "common/a.toml");
    assert_eq!(json[0]["labels"][1]["primary"], false);
}

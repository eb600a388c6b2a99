//! Attributes that games read themselves: in every profile, on every level, by position, normal, texture and weight.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::language::Document;
use kiln::language::diagnostic::Code;
use kiln::language::source::MemoryFiles;
use kiln::report::AttributeFacts;

use super::glb::Glb;

fn made(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = MemoryFiles::new().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

fn range(compiled: &Compiled, shape: &str, name: &str) -> AttributeFacts {
    compiled.report.as_ref().expect("a report").shapes[shape].attributes[name].clone()
}

const BALL: &str = "tolerance = 0.01\nunit = \"cm\"\n[lod]\nlevels = 3\nform = \"nodes\"\n[shape.a]\nscale = 2\nat = [0, 10, 0]\nattributes = { _WIND = [\"= y\", \"= ny\"], _HALF = { formula = \"= (x + 1) / 2\", form = \"byte\" } }\n[shape.a.sphere]\nradius = 1\n";

/// A ball of 1 cm before its placement: y and ny go from -1 to 1, whatever `scale`, `at` and `unit` say.
#[test]
fn formulas_speak_of_the_shape_before_its_placement_on_every_level_in_every_profile() {
    for compiled in made(BALL, &[Profile::Core, Profile::Quantized, Profile::Web, Profile::Verify]) {
        let name = compiled.profile.name();
        for shape in ["a", "a_LOD1", "a_LOD2"] {
            let wind = range(&compiled, shape, "_WIND");
            // Positions are on a grid within the tolerance; compressed floats have 16 bits.
            for part in wind.min.iter().map(|low| -low).chain(wind.max.iter().copied()) {
                assert!((part - 1.0).abs() < 0.02, "{name} {shape}: {wind:?}");
            }
            let half = range(&compiled, shape, "_HALF");
            assert!(
                half.min[0] < 0.05 && half.max[0] > 0.95 && half.max[0] <= 1.0,
                "{name} {shape}: {half:?}"
            );
        }
        let glb = Glb::new(&compiled.bytes);
        for mesh in glb.list("meshes") {
            let attributes = &mesh["primitives"][0]["attributes"];
            let accessor = |name: &str| {
                let index = attributes[name].as_u64().and_then(|index| usize::try_from(index).ok());
                &glb.list("accessors")[index.expect("an accessor")]
            };
            let (wind, half) = (accessor("_WIND"), accessor("_HALF"));
            assert_eq!((wind["componentType"].as_u64(), wind["type"].as_str()), (Some(5126), Some("VEC2")));
            assert_eq!(
                (half["componentType"].as_u64(), half["normalized"].as_bool()),
                (Some(5121), Some(true))
            );
        }
    }
}

#[test]
fn weights_and_texture_coordinates_and_lines_have_attributes() {
    let text = "tolerance = 0.01\n[shape.arm]\nattributes = { _HIGH = { joint = \"high\" }, _REST = { formula = \"= 1 - weight\", joint = \"high\" }, _U = \"= u\" }\n[shape.arm.capsule]\nradius = 0.2\nheight = 1\n[skeleton.s.joint.low]\nhead = [0, -0.5, 0]\ntail = [0, 0, 0]\n[skeleton.s.joint.high]\nparent = \"low\"\ntail = [0, 0.5, 0]\n[skin.k]\nshape = \"arm\"\nskeleton = \"s\"\nweights = \"rigid\"\n[shape.line]\nattributes = { _AT = \"= x\" }\n[shape.line.wire]\ncurves = [{ line = { from = [0, 0], to = [3, 0] } }]\n[node.arm]\nshape = \"arm\"\n[node.line]\nshape = \"line\"\n";
    let compiled = made(text, &[Profile::Core]).remove(0);
    for (name, low, high) in [("_HIGH", 0.0, 1.0), ("_REST", 0.0, 1.0), ("_U", 0.0, 1.0)] {
        let found = range(&compiled, "arm", name);
        assert!((found.min[0] - low).abs() < 1e-6 && (found.max[0] - high).abs() < 1e-6, "{name}: {found:?}");
    }
    let found = range(&compiled, "line", "_AT");
    assert_eq!((found.min[0], found.max[0]), (0.0, 3.0));
}

#[test]
fn engines_that_leave_attributes_out_are_told() {
    let text = "[shape.a]\nattributes = { _WIND = \"= y\" }\n[shape.a.sphere]\nradius = 1\n";
    for (name, profile) in Profile::NAMED {
        let found = made(text, &[profile]).remove(0).warnings.into_vec();
        let told = found.iter().any(|one| one.code == Code::EngineAttributes);
        assert_eq!(told, ["godot", "unreal", "unity", "babylon"].contains(&name), "{name}");
    }
    let two = text.replace(" }", ", _SHARE = 1 }");
    for (profile, several) in [(Profile::Blender, true), (Profile::Three, false), (Profile::Bevy, false)] {
        let found = made(&two, &[profile]).remove(0).warnings.into_vec();
        assert_eq!(found.iter().any(|one| one.code == Code::EngineAttributes), several);
    }
}

//! Profiles of engines: what each file requires, the forms that levels and colliders take, and what is told.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::language::Document;
use kiln::language::diagnostic::Code;
use kiln::language::source::MemoryFiles;
use serde_json::Value;

const ENGINES: [Profile; 7] = [
    Profile::Bevy,
    Profile::Godot,
    Profile::Unreal,
    Profile::Unity,
    Profile::Three,
    Profile::Babylon,
    Profile::Blender,
];

fn files(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = MemoryFiles::new().with("asset.toml", text);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}"))
}

/// The JSON of a file.
fn json(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).expect("JSON")
}

fn texts(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

fn codes(file: &Compiled) -> Vec<Code> {
    file.warnings.clone().into_vec().into_iter().map(|one| one.code).collect()
}

const BALL: &str = "tolerance = 0.002\n[lod]\nlevels = 3\n[shape.a.sphere]\nradius = 0.7\n[node.ball]\nshape = \"a\"\n[collider.c]\nshape = \"a\"\n";

/// What a loader refuses is never required; see the table of what engines read in the documentation of [`Profile`].
#[test]
fn files_require_what_their_engine_reads() {
    let made = files(BALL, &ENGINES);
    for profile in ENGINES {
        let own: Vec<&Compiled> = made.iter().filter(|file| file.profile == profile).collect();
        let name = profile.name();
        let one_file = matches!(profile, Profile::Three | Profile::Babylon);
        assert_eq!(own.len(), if one_file { 1 } else { 3 }, "{name}: levels");
        assert_eq!(own[0].file, format!("asset.{name}.glb"));
        for (level, file) in own.iter().enumerate() {
            assert_eq!(codes(file), [], "{name}");
            let json = json(&file.bytes);
            let small = matches!(profile, Profile::Unity | Profile::Three | Profile::Babylon);
            let required = if small { vec!["KHR_mesh_quantization"] } else { Vec::new() };
            assert_eq!(texts(&json["extensionsRequired"]), required, "{name}");
            assert_eq!(texts(&json["extensionsUsed"]).contains(&"MSFT_lod"), one_file, "{name}");
            if level > 0 {
                assert_eq!(file.file, format!("asset.lod{level}.{name}.glb"));
            }
            let primitives: Vec<&Value> = (json["meshes"].as_array().expect("meshes").iter())
                .flat_map(|mesh| mesh["primitives"].as_array().expect("primitives"))
                .collect();
            let corners = |primitive: &&Value| {
                let accessor = primitive["indices"].as_u64().and_then(|index| usize::try_from(index).ok());
                json["accessors"][accessor.expect("indices")]["count"].as_u64().expect("a count")
            };
            let totals = &file.report.as_ref().expect("a report was asked for").totals;
            assert_eq!(totals.primitives, primitives.len(), "{name}: bodies are counted too");
            assert_eq!(totals.triangles, primitives.iter().map(corners).sum::<u64>() / 3, "{name}");
            let nodes = json["nodes"].as_array().expect("nodes");
            let named = |wanted: &str| nodes.iter().any(|node| node["name"] == wanted);
            assert_eq!(named("c-convcolonly"), profile == Profile::Godot, "{name}");
            assert_eq!(named("USP_ball_00"), profile == Profile::Unreal, "{name}");
            let extras = nodes.iter().any(|node| node["extras"]["colliders"].is_array());
            assert_eq!(extras, !matches!(profile, Profile::Godot | Profile::Unreal), "{name}");
        }
    }
}

/// The floats of an engine's file are those of `core`, the whole numbers those of `quantized`.
#[test]
fn what_differs_from_the_profile_for_everyone_is_form_alone() {
    let text = "tolerance = 0.002\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.2";
    let made = files(text, &[&[Profile::Core, Profile::Quantized][..], &ENGINES].concat());
    for file in &made[2..] {
        let like = usize::from(file.profile.is_quantized());
        assert_eq!(file.bytes, made[like].bytes, "{}", file.profile.name());
    }
}

#[test]
fn forms_that_an_engine_does_not_read_are_written_and_told() {
    let with = |form: &str, colliders: &str| {
        let levels = BALL.replace("levels = 3", &format!("levels = 3\nform = \"{form}\""));
        format!("{levels}[output]\ncolliders = \"{colliders}\"\n")
    };
    let told =
        |form: &str, colliders: &str, profile: Profile| codes(&files(&with(form, colliders), &[profile])[0]);
    assert_eq!(told("files", "extras", Profile::Bevy), []);
    assert_eq!(told("msft-lod", "extras", Profile::Bevy), [Code::EngineLevels]);
    assert_eq!(told("nodes", "omi", Profile::Unity), [Code::EngineLevels, Code::EngineColliders]);
    assert_eq!(told("msft-lod", "omi", Profile::Three), [Code::EngineColliders]);
    assert_eq!(told("files", "omi", Profile::Godot), []);
    assert_eq!(told("files", "godot", Profile::Unreal), [Code::EngineColliders]);
    assert_eq!(told("nodes", "unreal", Profile::Core), []);
    let made = files(&with("nodes", "extras"), &[Profile::Blender]);
    assert_eq!(made.len(), 1, "written as asked for");
}

#[test]
fn names_that_godot_acts_upon_are_told() {
    let text = "[shape.front-wheel.sphere]\nradius = 1\n[node.door-col2]\nshape = \"front-wheel\"\n[node.wheel-front]\nshape = \"front-wheel\"\n[node.protocol]\n[material.glass-alpha]\n[[clip.loop-a.track]]\nnode = \"protocol\"\npath = \"translation\"\nkeys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [0, 1, 0] }]\n[clip.swing-loop]\nloop = true\n[[clip.swing-loop.track]]\nnode = \"protocol\"\npath = \"translation\"\nkeys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [0, 0, 0] }]\n";
    let found = files(text, &[Profile::Godot]);
    let told: Vec<String> = found[0]
        .warnings
        .clone()
        .into_vec()
        .into_iter()
        .filter(|one| one.code == Code::EngineName)
        .map(|one| one.message)
        .collect();
    let names = ["door-col2", "glass-alpha", "loop-a"];
    assert_eq!(told.len(), names.len(), "{told:?}");
    assert!(told.iter().zip(names).all(|(message, name)| message.contains(&format!("`{name}`"))), "{told:?}");
    let others = files(text, &[Profile::Bevy]);
    assert!(!codes(&others[0]).contains(&Code::EngineName));
}

const PLACED: &str = "unit = \"cm\"\nup = \"z\"\n[output]\nforward = { bevy = \"-z\", unreal = \"x\" }\npivot = { bevy = \"base\", unreal = [10, 0, 0], three = \"center\" }\nscale = { unreal = 100 }\n[shape.a.box]\nsize = [20, 30, 40]\n[node.box]\nshape = \"a\"\nat = [0, 0, 50]\n[node.lamp]\nparent = \"box\"\n[node.lamp.light]\nkind = \"point\"\nrange = 200\nintensity = 3\n";

/// The box, 0.2 by 0.4 (up) by 0.3 metres about (0, 0.5, 0), turned, moved and scaled: its corners by hand.
#[test]
fn a_model_stands_in_each_file_as_its_engine_is_told() {
    let made = files(PLACED, &[Profile::Core, Profile::Bevy, Profile::Unreal, Profile::Three]);
    let expected = [
        ([-0.1, 0.3, -0.15], [0.1, 0.7, 0.15]),
        ([-0.1, 0.0, -0.15], [0.1, 0.4, 0.15]),
        ([-15.0, 30.0, 0.0], [15.0, 70.0, 20.0]),
        ([-0.1, -0.2, -0.15], [0.1, 0.2, 0.15]),
    ];
    for (file, (min, max)) in made.iter().zip(expected) {
        let name = file.profile.name();
        let report = file.report.as_ref().expect("a report was asked for");
        let bounds = report.totals.bounds;
        for (found, wanted) in bounds.min.iter().chain(&bounds.max).zip(min.iter().chain(&max)) {
            assert!((found - wanted).abs() < 1e-5 * 70.0, "{name}: {bounds:?}");
        }
        let json = json(&file.bytes);
        let scene = json["scenes"][0]["nodes"].as_array().expect("nodes at the top");
        assert_eq!(scene.len(), 1, "{name}");
        let named = json["nodes"].as_array().expect("nodes").iter().find(|node| node["name"] == "asset");
        assert_eq!(named.is_some(), file.profile != Profile::Core, "{name}");
        let light = &json["extensions"]["KHR_lights_punctual"]["lights"][0];
        let scale = if file.profile == Profile::Unreal { 100.0 } else { 1.0 };
        assert_eq!(light["range"].as_f64(), Some(2.0 * scale), "{name}");
        assert_eq!(light["intensity"].as_f64(), Some(3.0 * scale * scale), "{name}");
    }
}

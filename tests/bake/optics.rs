//! What light does at surfaces beyond color, metal and roughness: what files say of it, and what engines are told not to read.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::import::image::{Pixels, png};
use kiln::language::Document;
use kiln::language::diagnostic::Code;
use kiln::language::source::MemoryFiles;
use serde_json::{Value, json};

use super::glb::Glb;

fn files(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let picture =
        |shade: u8| png(&Pixels { width: 2, height: 2, rgba: vec![[shade, 9, 128, 255]; 4] }, false);
    let files = MemoryFiles::new()
        .with("spec.toml", text)
        .with("a.png", picture(1))
        .with("b.png", picture(2))
        .with("c.png", picture(3));
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}"))
}

/// The file of a box of one material.
fn of_material(material: &str, profile: Profile) -> Value {
    let text =
        format!("[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\n{material}\n");
    let made = files(&text, &[profile]).remove(0);
    let glb = Glb::new(&made.bytes);
    if profile == Profile::Core {
        glb.check();
    }
    glb.json
}

/// Numbers to within the rounding of single precision, all else to the letter.
fn alike(found: &Value, wanted: &Value) -> bool {
    match (found, wanted) {
        (Value::Number(found), Value::Number(wanted)) => {
            let [found, wanted] = [found, wanted].map(|number| number.as_f64().unwrap_or(f64::NAN));
            (found - wanted).abs() <= 1e-6 * wanted.abs()
        }
        (Value::Array(found), Value::Array(wanted)) => {
            found.len() == wanted.len()
                && found.iter().zip(wanted).all(|(found, wanted)| alike(found, wanted))
        }
        (Value::Object(found), Value::Object(wanted)) => {
            found.len() == wanted.len()
                && wanted.iter().all(|(key, wanted)| found.get(key).is_some_and(|found| alike(found, wanted)))
        }
        _ => found == wanted,
    }
}

#[test]
fn each_extension_says_what_is_written() {
    let cases = [
        ("ior = 1.33", json!({ "KHR_materials_ior": { "ior": 1.33 } })),
        ("unlit = true", json!({ "KHR_materials_unlit": {} })),
        (
            "emissive = \"#ffffff\"\nemissive-strength = 12.5",
            json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 12.5 } }),
        ),
        (
            "clearcoat = {}",
            json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0 } }),
        ),
        (
            "transmission = { factor = 0.9 }\nvolume = { thickness = 0.2 }\ndispersion = 0.31",
            json!({
                "KHR_materials_transmission": { "transmissionFactor": 0.9 },
                "KHR_materials_volume": { "thicknessFactor": 0.2, "attenuationColor": [1, 1, 1] },
                "KHR_materials_dispersion": { "dispersion": 0.31 },
            }),
        ),
        (
            "specular = { factor = 0.4, color = [1, 0.5, 0.25] }",
            json!({ "KHR_materials_specular": { "specularFactor": 0.4, "specularColorFactor": [1, 0.5, 0.25] } }),
        ),
        (
            "sheen = { color = [0.5, 0.25, 0.125] }",
            json!({ "KHR_materials_sheen": {
                "sheenColorFactor": [0.5, 0.25, 0.125], "sheenRoughnessFactor": 0.5
            } }),
        ),
        (
            "iridescence = { factor = 0.5, ior = 1.4, thickness = 300 }",
            json!({ "KHR_materials_iridescence": {
                "iridescenceFactor": 0.5, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 300
            } }),
        ),
        (
            "anisotropy = { strength = 0.6, rotation = 90 }",
            json!({ "KHR_materials_anisotropy": {
                "anisotropyStrength": 0.6, "anisotropyRotation": std::f64::consts::FRAC_PI_2
            } }),
        ),
        ("roughness = 0.5", Value::Null),
    ];
    for (text, wanted) in cases {
        let json = of_material(text, Profile::Core);
        let found = &json["materials"][0]["extensions"];
        assert!(alike(found, &wanted), "{text}: {found}");
        let used: Vec<&str> =
            json["extensionsUsed"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let mut named: Vec<&str> =
            wanted.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
        named.sort_unstable();
        assert_eq!(used, named, "{text}");
    }
}

#[test]
fn pictures_of_extensions_are_textures_of_the_file() {
    let text = "clearcoat = { texture = \"a.png\", roughness-texture = \"b.png\", normal-texture = { file = \"c.png\", wrap = \"clamp\" }, normal-scale = 0.5 }\niridescence = { thickness-texture = \"b.png\", least-thickness = 200 }\ncolor-texture = \"a.png\"\n";
    let json = of_material(text, Profile::Core);
    let own = &json["materials"][0]["extensions"];
    let coat = &own["KHR_materials_clearcoat"];
    let film = &own["KHR_materials_iridescence"];
    let color = &json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    assert_eq!(coat["clearcoatTexture"]["index"], color["index"]);
    assert_eq!(coat["clearcoatRoughnessTexture"], film["iridescenceThicknessTexture"]);
    assert_eq!(coat["clearcoatNormalTexture"]["scale"], 0.5);
    assert_eq!(film["iridescenceThicknessMinimum"], 200.0);
    let lengths = ["images", "textures", "samplers"].map(|list| json[list].as_array().map_or(0, Vec::len));
    assert_eq!(lengths, [3, 3, 2]);
    let index =
        |texture: &Value| usize::try_from(texture["index"].as_u64().expect("an index")).expect("it fits");
    let name = |texture: &Value| {
        let source = &json["textures"][index(texture)]["source"];
        json["images"][usize::try_from(source.as_u64().expect("an index")).expect("it fits")]["name"].clone()
    };
    let named = ["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"]
        .map(|key| name(&coat[key]));
    assert_eq!(named, ["a", "b", "c"]);
}

/// By the format's own rule and that of the extensions: a frame of tangents for normals of a coat and for a direction of shine.
#[test]
fn tangents_stand_where_an_extension_is_drawn_in_their_frame() {
    let cases = [
        ("clearcoat = { normal-texture = \"a.png\" }", true),
        ("clearcoat = { texture = \"a.png\" }", false),
        ("anisotropy = {}", true),
        ("sheen = {}", false),
    ];
    for (text, wanted) in cases {
        let json = of_material(text, Profile::Core);
        let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().expect("attributes");
        assert_eq!(attributes.contains_key("TANGENT"), wanted, "{text}");
        assert_eq!(attributes.contains_key("TEXCOORD_0"), wanted || text.contains("png"), "{text}");
    }
}

/// A thickness is one in the units of the mesh, which the nodes above it bring to the scene; the way in a body is one of the
/// scene.
#[test]
fn a_body_is_as_thick_in_every_file() {
    let text = "unit = \"cm\"\ntolerance = 0.1\n[shape.a]\nmaterial = \"m\"\n[shape.a.sphere]\nradius = 20\n[material.m]\ntransmission = {}\nvolume = { thickness = 3, attenuation-distance = 50, attenuation-color = \"#ff0000\" }\n[clip.c]\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"thickness\"\nkeys = [{ at = 0, value = 3 }, { at = 1, value = 6 }]\n[output]\nscale = { babylon = 2, unreal = 100 }\n";
    let made = files(text, &[Profile::Core, Profile::Quantized, Profile::Babylon, Profile::Unreal]);
    for (file, scale) in made.iter().zip([1.0, 1.0, 2.0, 100.0]) {
        let glb = Glb::new(&file.bytes);
        let (nodes, name) = (glb.list("nodes"), file.profile.name());
        let number = |value: &Value| value.as_f64().unwrap_or(1.0);
        // The scales of all nodes multiply: each of them carries the mesh.
        let unit: f64 = nodes.iter().map(|node| number(&node["scale"][0])).product();
        let volume = &glb.list("materials")[0]["extensions"]["KHR_materials_volume"];
        let thick = number(&volume["thicknessFactor"]) * unit;
        assert!((thick / scale - 0.03).abs() < 1e-7, "{name}: {thick}");
        let way = number(&volume["attenuationDistance"]);
        assert!((way / scale - 0.5).abs() < 1e-6, "{name}: {way}");
        let animation = &glb.list("animations")[0];
        let pointer = &animation["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"];
        assert_eq!(*pointer, "/materials/0/extensions/KHR_materials_volume/thicknessFactor", "{name}");
        let output =
            animation["samplers"][0]["output"].as_u64().and_then(|index| usize::try_from(index).ok());
        let values = glb.accessor(output.expect("an accessor"));
        for (value, wanted) in values.iter().zip([0.03, 0.06]) {
            assert!((value[0] * unit / scale - wanted).abs() < 1e-7, "{name}: {value:?}");
        }
    }
}

#[test]
fn what_an_engine_does_not_draw_is_written_and_told_once() {
    let text = "[shape.a]\nmaterial = \"glass\"\n[shape.a.sphere]\nradius = 1\n[material.glass]\nior = 1.4\ntransmission = {}\nvolume = { thickness = 1 }\n[material.velvet]\nsheen = {}\n[material.lamp]\nunlit = true\n";
    let told = |profile: Profile| -> Vec<String> {
        let made = files(text, &[profile]).remove(0);
        assert!(Glb::new(&made.bytes).json["materials"][0]["extensions"]["KHR_materials_volume"].is_object());
        assert!(made.warnings.clone().into_vec().iter().all(|one| one.code == Code::EngineMaterials));
        made.warnings.into_vec().into_iter().map(|one| one.message).collect()
    };
    for profile in [Profile::Core, Profile::Web, Profile::Three, Profile::Babylon, Profile::Blender] {
        assert!(told(profile).is_empty(), "{}", profile.name());
    }
    assert_eq!(told(Profile::Bevy), ["Bevy reads of these materials no `sheen`"]);
    assert_eq!(told(Profile::Unreal), ["Unreal reads of these materials no `volume`"]);
    assert_eq!(told(Profile::Unity), ["Unity reads of these materials no `ior`, `sheen`, `volume`"]);
    assert_eq!(
        told(Profile::Godot),
        ["Godot reads of these materials no `ior`, `sheen`, `transmission`, `volume`"]
    );
}

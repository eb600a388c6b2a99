//! Pictures of files: made smaller, written anew, packed; decoded here again.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::import::image::{Pixels, pixels, png};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

use super::glb::Glb;

/// Stripes of 32 pixels across by 16 down.
fn stripes(one: u8, other: u8) -> Vec<u8> {
    let grey = |k: usize| if k.is_multiple_of(2) { one } else { other };
    let rgba = (0..512).map(|k| [grey(k), grey(k), grey(k), 255]).collect();
    png(&Pixels { width: 32, height: 16, rgba }, false)
}

fn made(text: &str, profiles: &[Profile]) -> Result<Vec<Compiled>, String> {
    made_by(text, Options { profiles: profiles.to_vec(), ..Options::default() })
}

fn made_by(text: &str, options: Options) -> Result<Vec<Compiled>, String> {
    let files = MemoryFiles::new()
        .with("spec.toml", text)
        .with("color.png", stripes(0, 255))
        .with("rough.png", stripes(10, 10))
        .with("metal.png", stripes(200, 200))
        .with("other/Color.png", stripes(1, 2))
        .with("ein Bild.png", stripes(3, 4))
        .with("occlusion.png", {
            let rgba = (0..128).map(|_| [90, 0, 0, 255]).collect();
            png(&Pixels { width: 16, height: 8, rgba }, false)
        });
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options { name: "my asset".to_owned(), ..options };
    compile_profiles(&document, &files, &options).map_err(|found| found.to_string())
}

/// The pictures of a file by their names.
fn pictures(compiled: &Compiled) -> Vec<(String, Pixels)> {
    let glb = Glb::new(&compiled.bytes);
    let one = |image: &serde_json::Value| {
        let view = image["bufferView"].as_u64().and_then(|view| usize::try_from(view).ok()).expect("a view");
        let picture = pixels(glb.view(view), 1 << 20).expect("a picture");
        (image["name"].as_str().unwrap_or_default().to_owned(), picture)
    };
    glb.list("images").iter().map(one).collect()
}

const BOX: &str = "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n";

#[test]
fn pictures_keep_to_the_size_of_each_profile() {
    let text = format!(
        "{BOX}[material.m]\ncolor-texture = \"color.png\"\n[output.textures]\nmax-size = {{ bevy = 8, core = 1024 }}\ncompress = true\n"
    );
    let all = made(&text, &[Profile::Core, Profile::Bevy, Profile::Unity]).expect("it bakes");
    let sizes: Vec<[u32; 2]> =
        all.iter().map(|file| pictures(file).remove(0).1).map(|own| [own.width, own.height]).collect();
    assert_eq!(sizes, [[32, 16], [8, 4], [32, 16]]);
    let small = pictures(&all[1]).remove(0).1;
    assert!(
        small.rgba.iter().all(|pixel| *pixel == [188, 188, 188, 255]),
        "mixed as light: {:?}",
        small.rgba
    );
}

#[test]
fn channels_of_three_pictures_are_one() {
    let text = format!(
        "{BOX}[material.m]\nroughness-texture = \"rough.png\"\nmetallic-texture = \"metal.png\"\nocclusion-texture = \"occlusion.png\"\n"
    );
    let compiled = made(&text, &[Profile::Core]).expect("it bakes").remove(0);
    let all = pictures(&compiled);
    assert_eq!(all.len(), 1);
    let (name, picture) = &all[0];
    assert_eq!((name.as_str(), picture.width, picture.height), ("m-orm", 32, 16));
    assert!(picture.rgba.iter().all(|pixel| *pixel == [90, 10, 200, 255]));
    let glb = Glb::new(&compiled.bytes);
    let material = &glb.list("materials")[0];
    let index = |texture: &serde_json::Value| texture["index"].as_u64();
    let packed = index(&material["pbrMetallicRoughness"]["metallicRoughnessTexture"]);
    assert!(packed.is_some() && packed == index(&material["occlusionTexture"]), "{material}");
}

#[test]
fn what_is_not_there_is_full() {
    let text = format!("{BOX}[material.m]\nmetallic = 1\nmetallic-texture = \"metal.png\"\n");
    let compiled = made(&text, &[Profile::Core]).expect("it bakes").remove(0);
    assert_eq!(pictures(&compiled)[0].1.rgba[7], [255, 255, 200, 255]);
}

const BESIDE: &str = "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor-texture = \"color.png\"\nemissive-texture = \"other/Color.png\"\nmetallic-roughness-texture = \"ein Bild.png\"\nsheen = { color-texture = \"color.png\" }\n";

/// Names keep to what every file system and address takes, and each picture has one of its own.
#[test]
fn pictures_stand_beside_the_file_under_names_of_their_own() {
    let text = format!("{BESIDE}[output.textures]\nbeside = {{ core = true, unity = true }}\n");
    let profiles = vec![Profile::Core, Profile::Unity, Profile::Web];
    let files = made_by(&text, Options { profiles, beside: true, ..Options::default() }).expect("it bakes");
    let within = made_by(&text, Options::default()).expect("it bakes").remove(0);
    assert!(within.pictures.is_empty(), "who looks at one file alone has all in it");
    let wanted = [stripes(0, 255), stripes(1, 2), stripes(3, 4)];
    for (file, stem) in files.iter().zip(["my asset", "my asset.unity"]) {
        let glb = Glb::new(&file.bytes);
        let names = ["color.png", "Color-2.png", "ein-Bild.png"].map(|name| format!("{stem}.{name}"));
        let found: Vec<(String, Vec<u8>)> = file.pictures.clone();
        let order: Vec<String> = found.iter().map(|(name, _)| name.clone()).collect();
        assert_eq!(order.len(), 3, "one that two materials' parts show is one: {order:?}");
        for (image, (name, bytes)) in glb.list("images").iter().zip(&found) {
            assert_eq!(image["uri"], name.replace(' ', "%20"));
            assert!(image.get("bufferView").is_none() && image["mimeType"] == "image/png");
            let place =
                names.iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}: {names:?}"));
            assert_eq!(*bytes, wanted[place], "{name}");
        }
    }
    assert!(files[0].bytes.len() + 3 * wanted[0].len() / 2 < within.bytes.len() + 600);
    assert!(files[2].pictures.is_empty() && Glb::new(&files[2].bytes).list("images")[0].get("uri").is_none());
}

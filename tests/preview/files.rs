//! Files from elsewhere, at moments of their clips, and broken ones.

use kiln::preview::asset::{self, Cutoff, GltfFault};
use kiln::preview::{Moment, Stage, StageError};

use crate::bake::bake;

/// A `.glb` file of a JSON document and binary data.
fn container(json: &str, binary: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, binary) = (pad(json.as_bytes(), b' '), pad(binary, 0));
    let long = |count: usize| u32::try_from(count).expect("small").to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(long(28 + json.len() + binary.len()));
    for (kind, bytes) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        file.extend(long(bytes.len()));
        file.extend(kind);
        file.extend(bytes);
    }
    file
}

fn floats(list: &[f32]) -> Vec<u8> {
    list.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A triangle of three vertices on two joints, with a morph target and a clip that turns a joint, moves a node and raises
/// the target; positions are quantized.
fn moving() -> Vec<u8> {
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut put = |bytes: Vec<u8>| {
        views.push(format!(
            "{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}}",
            binary.len(),
            bytes.len()
        ));
        binary.extend(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
        views.len() - 1
    };
    // Positions (0,0,0), (1,0,0), (0,1,0) as normalized shares of 127, of four bytes each.
    put(vec![0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0]);
    put(vec![0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    put(vec![255, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0]);
    put(floats(&[0.0, 0.0, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.5]));
    put(floats(&[0.0, 2.0]));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    put(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]));
    put(floats(&[0.0, 1.0]));
    // Cubic: tangent in, value, tangent out; from 0 to (3, 0, 0), leaving at (0, 4, 0) a second.
    put(floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"],
        "scene":0,"scenes":[{{"nodes":[0,1,3]}}],
        "nodes":[{{"mesh":0,"skin":0}},{{"name":"hip","children":[2]}},{{"name":"knee"}},{{"name":"free","mesh":1,"translation":[5,0,0]}}],
        "skins":[{{"joints":[1,2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}}}]}},
          {{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{{"POSITION":3}}]}}],"weights":[0]}}],
        "accessors":[
          {{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3","min":[0,0,0],"max":[127,127,0]}},
          {{"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"}},
          {{"bufferView":2,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"}},
          {{"bufferView":3,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0.5],"max":[0,0,0.5]}},
          {{"bufferView":4,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]}},
          {{"bufferView":5,"componentType":5126,"count":2,"type":"VEC4"}},
          {{"bufferView":6,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]}},
          {{"bufferView":7,"componentType":5126,"count":6,"type":"VEC3"}}],
        "animations":[{{"name":"bend","samplers":[
            {{"input":4,"output":5}},{{"input":4,"output":6,"interpolation":"LINEAR"}},{{"input":4,"output":7,"interpolation":"CUBICSPLINE"}}],
          "channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}},
            {{"sampler":1,"target":{{"node":3,"path":"weights"}}}},{{"sampler":2,"target":{{"node":3,"path":"translation"}}}}]}}],
        "bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
        views.join(",").replacen("\"byteLength\":12", "\"byteLength\":12,\"byteStride\":4", 1),
        binary.len()
    );
    container(&json, &binary)
}

fn at(time: f64) -> Stage {
    let asset = asset::read(&moving()).expect("valid");
    Stage::new(&asset, &Moment { clip: Some("bend".to_owned()), time }).expect("the clip is there")
}

fn near(stage: &Stage, vertex: usize, expected: [f64; 3]) {
    let off = stage.vertices[vertex].point.distance(expected.into());
    assert!(off < 1e-6, "vertex {vertex} at {} instead of {expected:?}", stage.vertices[vertex].point);
}

/// Joints turn along the shorter arc at an even pace; weights are linear; a cubic is Hermite's.
#[test]
fn a_clip_moves_joints_targets_and_nodes() {
    let rest = Stage::new(&asset::read(&moving()).expect("valid"), &Moment::default()).expect("at rest");
    near(&rest, 1, [1.0, 0.0, 0.0]);
    near(&rest, 4, [6.0, 0.0, 0.0]);
    // At the end the knee has turned by 90 degrees around z; of the triangle only vertex 1 is its own.
    let end = at(2.0);
    near(&end, 0, [0.0, 0.0, 0.0]);
    near(&end, 1, [0.0, 1.0, 0.0]);
    near(&end, 2, [0.0, 1.0, 0.0]);
    near(&end, 3, [3.0, 0.0, 0.5]);
    let middle = at(1.0);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    near(&middle, 1, [half, half, 0.0]);
    // Hermite at a half: 3/2 along x, and 4 * 2 * (1/8 - 1/2 + 1/2) along y.
    near(&middle, 3, [1.5, 1.0, 0.25]);
    // After the last key everything waits.
    near(&at(99.0), 3, [3.0, 0.0, 0.5]);
}

#[test]
fn an_unknown_clip_is_told_with_those_that_there_are() {
    let asset = asset::read(&moving()).expect("valid");
    let error =
        Stage::new(&asset, &Moment { clip: Some("walk".to_owned()), time: 0.0 }).expect_err("no such clip");
    assert_eq!(error, StageError::Clip { asked: "walk".to_owned(), clips: vec!["bend".to_owned()] });
    assert_eq!(error.to_string(), "there is no clip `walk`: there are bend");
}

/// Cut off anywhere, or with any byte of its JSON changed, a file is read or refused, and never more than that.
#[test]
fn broken_files_are_refused() {
    let whole = moving();
    for length in 0..whole.len() {
        assert!(asset::read(&whole[..length]).is_err(), "{length} bytes were taken for a file");
    }
    let mut refused = 0;
    for place in 12..whole.len() {
        for byte in [b'9', b'-', 0xff] {
            let mut broken = whole.clone();
            broken[place] = byte;
            match asset::read(&broken) {
                Ok(asset) => {
                    let moment = Moment { clip: Some("bend".to_owned()), time: 0.7 };
                    let stage =
                        Stage::new(&asset, &moment).or_else(|_| Stage::new(&asset, &Moment::default()));
                    let stage = stage.expect("at rest");
                    assert!(stage.vertices.iter().all(|vertex| vertex.point.is_finite()));
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 1000, "{refused}");
}

#[test]
fn what_is_needed_and_unknown_is_named() {
    let json = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
    assert_eq!(
        asset::read(&container(json, &[])).expect_err("compressed"),
        GltfFault::Extension("KHR_draco_mesh_compression".to_owned())
    );
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}"#;
    assert_eq!(asset::read(&container(json, &[])).expect_err("a loop"), GltfFault::Tree(0));
}

/// What is baked comes back: materials, names and normals.
#[test]
fn what_is_baked_is_read() {
    let text = "[shape.a]\nmaterial = \"red\"\n[shape.a.box]\nsize = [1, 2, 3]\n[material.red]\ncolor = [1, 0, 0]\nroughness = 0.25";
    let asset = asset::read(&bake(text).compiled.bytes).expect("baked");
    let material = &asset.materials[0];
    assert_eq!(
        (material.name.as_str(), material.color, material.roughness),
        ("red", [1.0, 0.0, 0.0, 1.0], 0.25)
    );
    assert_eq!(material.cutoff, Cutoff::Opaque);
    let stage = Stage::new(&asset, &Moment::default()).expect("at rest");
    assert_eq!((stage.triangles.len(), stage.vertices.len()), (12, 24));
    assert!(stage.vertices.iter().all(|vertex| (vertex.normal.length() - 1.0).abs() < 1e-6));
    assert_eq!((stage.bounds.max - stage.bounds.min).to_array(), [1.0, 2.0, 3.0]);
}

use glam::{DVec2, DVec3};
use serde_json::{Value, json};

use super::{GltfFault, Place, Steps, Track, base64, open, read, read_weighted, unescaped};
use crate::import::image::Edge;
use crate::import::look::{Picture, PictureSource, Pictures};
use crate::import::{ImportError, ImportOptions, Imported};

/// A square of four points at z = 0 as floats, the bytes of a strip of them, weights of all on the first of four joints,
/// and another square as bytes, four for each point.
fn square() -> Vec<u8> {
    let points = [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = points.into_iter().flatten().flat_map(f32::to_le_bytes).collect();
    bytes.extend([0, 1, 2, 3]);
    bytes.extend([[1.0_f32, 0.0, 0.0, 0.0]; 4].into_iter().flatten().flat_map(f32::to_le_bytes));
    bytes.extend([0, 0, 0, 9, 255, 0, 0, 9, 0, 51, 0, 9, 255, 51, 0, 9]);
    bytes
}

/// A document that shows the square as a strip, with changes.
fn document(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "a%20square.bin", "byteLength": 132 }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 52, "byteLength": 64 },
            { "buffer": 0, "byteOffset": 116, "byteLength": 16, "byteStride": 4 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [2, 1, 0] },
            { "bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 4 },
        ],
        "materials": [{ "name": "red", "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0.25 } }],
        "meshes": [{ "name": "square", "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1, "mode": 5, "material": 0 },
        ] }],
        "nodes": [
            { "name": "arm", "translation": [0, 0, 5], "children": [1] },
            { "name": "hand", "mesh": 0, "scale": [1, 1, 2] },
            { "name": "twin", "mesh": 0, "scale": [-1, 1, 1] },
        ],
        "scenes": [{ "nodes": [0, 2] }],
        "scene": 0,
    });
    change(&mut document);
    document.to_string().into_bytes()
}

fn read_with(document: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    read(document, options, &mut |path| (path == "a square.bin").then(square))
}

fn read_all(change: impl FnOnce(&mut Value)) -> Result<Imported, ImportError> {
    read_with(&document(change), &ImportOptions::default())
}

fn fault(change: impl FnOnce(&mut Value)) -> GltfFault {
    match read_all(change) {
        Err(ImportError::Gltf(fault)) => fault,
        other => panic!("{other:?}"),
    }
}

/// The sum of the faces' normals by twice their areas.
fn facing(found: &Imported) -> DVec3 {
    (0..found.mesh.faces.len()).map(|face| found.mesh.newell(face)).sum()
}

#[test]
fn nodes_place_what_they_show_and_mirrors_turn_it() {
    let found = read_all(|_| {}).expect("two squares");
    assert_eq!(found.mesh.faces.len(), 4);
    // Both face z: the mirrored one was turned.
    assert_eq!(facing(&found), DVec3::Z * 8.0);
    let bounds = found.mesh.bounds();
    assert_eq!((bounds.min, bounds.max), (DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 1.0, 5.0)));
    // Four points each.
    assert_eq!(found.mesh.points.len(), 8);
    assert_eq!(found.groups, ["hand", "twin", "square"]);
    assert_eq!(found.mesh.materials, ["red"]);
    let look = &found.materials[0];
    assert_eq!((look.color, look.metallic), (Some([1.0, 0.5, 0.0]), Some(0.25)));
    found.mesh.validate().expect("valid");
}

/// Pictures inside the document and beside it, how they go on, and what lays them elsewhere.
#[test]
fn materials_bring_their_pictures() {
    let with = |change: &dyn Fn(&mut Value)| {
        read_all(|document| {
            document["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33071, "magFilter": 9728 }, { "wrapS": 33071 }]);
            document["images"] = json!([{ "uri": "a%20b.png" }, { "uri": "data:image/png;base64,Zm9v", "name": "foo" }]);
            document["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }, { "source": 1, "sampler": 1 }]);
            document["accessors"].as_array_mut().expect("a list").push(
                json!({ "bufferView": 0, "componentType": 5126, "type": "VEC2", "count": 4 }),
            );
            document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2.into();
            document["materials"][0] = json!({
                "name": "red", "alphaMode": "MASK", "normalTexture": { "index": 1, "scale": 0.5 },
                "occlusionTexture": { "index": 1, "strength": 0.25 }, "emissiveTexture": { "index": 0 },
                "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
                "extensions": { "KHR_materials_unlit": {}, "KHR_materials_sheen": {} },
            });
            change(document);
        })
        .expect("squares")
    };
    let plain = with(&|_| {});
    let look = &plain.materials[0];
    let outside = Picture { edge: Edge::Clamp, nearest: true, ..Picture::file("a b.png") };
    let source = PictureSource::Inside { number: 1, name: "foo".to_owned(), bytes: b"foo".as_slice().into() };
    let inside = Picture { source, edge: Edge::Repeat, nearest: false };
    let expected = Pictures {
        color: Some(outside.clone()),
        metallic_roughness: Some(inside.clone()),
        normal: Some((inside.clone(), 0.5)),
        occlusion: Some((inside, 0.25)),
        emissive: Some(outside),
    };
    assert_eq!(look.pictures, expected);
    assert_eq!((look.unlit, look.cutoff, look.blends), (true, Some(0.5), false));
    let notes: Vec<&str> = plain.notes.iter().map(|note| note.message.as_str()).collect();
    assert_eq!(notes, ["material `red` has KHR_materials_sheen, which is left out"]);
    // All pictures turned, scaled and moved alike: the coordinates are.
    let turned = json!({ "KHR_texture_transform": { "offset": [0.5, 2], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3] } });
    let moved = with(&|document| {
        let material = &mut document["materials"][0];
        for name in ["normalTexture", "occlusionTexture", "emissiveTexture"] {
            material[name]["extensions"] = turned.clone();
        }
        for name in ["baseColorTexture", "metallicRoughnessTexture"] {
            material["pbrMetallicRoughness"][name]["extensions"] = turned.clone();
        }
    });
    assert_eq!(moved.materials[0].pictures, expected);
    for (before, after) in plain.mesh.uvs.iter().zip(&moved.mesh.uvs) {
        // A quarter turn against the clock, seen with v down: (u, v) becomes (v, -u).
        let place = DVec2::new(0.5 + 3.0 * before.y, 2.0 - 2.0 * before.x);
        assert!(after.distance(place) < 1e-12, "{before} {after}");
    }
    // One that lies elsewhere, one of a third set, and one that goes on in two ways.
    let apart = with(&|document| {
        let material = &mut document["materials"][0];
        material["normalTexture"]["extensions"] = turned.clone();
        material["occlusionTexture"]["texCoord"] = 2.into();
        material["emissiveTexture"]["index"] = 2.into();
    });
    let left = Pictures { normal: None, occlusion: None, emissive: None, ..expected };
    assert_eq!(apart.materials[0].pictures, left);
    let told = |words: &str| apart.notes.iter().any(|note| note.message.contains(words));
    assert!(told("normal picture of material `red` is left out: it is laid in another way"));
    assert!(told(
        "occlusion picture of material `red` is left out: it is laid by texture coordinates beyond"
    ));
    assert!(told("emissive picture of material `red` is left out: it goes on in another way"));
}

/// Points that part in a state stay apart; a state moves only what its node shows, as its node lies.
#[test]
fn states_move_what_their_nodes_show() {
    let with = |weld: Option<f64>, weights: Value| {
        let bytes = document(|document| {
            // All four points at one place, moved to the square's.
            document["accessors"].as_array_mut().expect("a list").push(json!({
                "componentType": 5126, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 0, 0],
                "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 0 } },
            }));
            let mesh = &mut document["meshes"][0];
            let other = mesh["primitives"][0].clone();
            mesh["primitives"][0]["attributes"]["POSITION"] = 2.into();
            mesh["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
            mesh["extras"] = json!({ "targetNames": ["Grown Up"] });
            mesh["weights"] = weights;
            document["meshes"].as_array_mut().expect("a list").push(json!({ "primitives": [other] }));
            document["nodes"][2]["mesh"] = 1.into();
        });
        let options = ImportOptions { weld, ..ImportOptions::default() };
        read_weighted(&bytes, &options, &mut |path| (path == "a square.bin").then(square)).expect("squares")
    };
    let found = with(None, json!([0]));
    let state = &found.states[0];
    assert_eq!((found.states.len(), state.node, state.target, state.weight), (1, 1, 0, 0.0));
    assert_eq!(state.name, "Grown Up");
    let plain = found.at(&[0.0]);
    assert_eq!((plain.points.len(), &plain), (8, &found.imported.mesh));
    let half = found.at(&[0.5]).bounds();
    // The hand is moved by 5 along z; the twin beside it stays.
    assert_eq!((half.min, half.max), (DVec3::new(-2.0, 0.0, 0.0), DVec3::new(1.0, 1.0, 5.0)));
    // What counts at rest is in the mesh as it is read, and not in the one without states.
    let grown = with(None, json!([0.5]));
    assert_eq!((grown.states[0].weight, &grown.imported.mesh), (0.5, &found.at(&[0.5])));
    assert_eq!(grown.at(&[0.0]), plain);
    // Joined, points go where they rest.
    let welded = with(Some(0.001), json!([0.5]));
    assert_eq!((welded.states.len(), welded.imported.mesh.points.len()), (0, 8));
    assert!(welded.imported.notes.iter().any(|note| note.message.contains("its 1 states are left out")));
}

#[test]
fn groups_are_nodes_with_what_is_below_and_meshes() {
    let of = |group: &str| {
        let options = ImportOptions { group: Some(group.to_owned()), ..ImportOptions::default() };
        read_with(&document(|_| {}), &options)
    };
    for (group, faces) in [("arm", 2), ("hand", 2), ("twin", 2), ("square", 4)] {
        assert_eq!(of(group).expect("a part").mesh.faces.len(), faces, "{group}");
    }
    assert!(matches!(of("foot"), Err(ImportError::UnknownGroup { known, .. }) if known.len() == 3));
}

#[test]
fn fans_lists_and_loose_vertices_are_read() {
    let faces = |mode: u32, indices: bool| {
        let found = read_all(|document| {
            let primitive = &mut document["meshes"][0]["primitives"][0];
            primitive["mode"] = mode.into();
            if !indices {
                primitive.as_object_mut().expect("an object").remove("indices");
            }
            document["scenes"][0]["nodes"] = json!([2]);
        });
        found.map(|found| found.mesh.faces.len())
    };
    assert_eq!((faces(6, true), faces(5, false), faces(4, true)), (Ok(2), Ok(2), Ok(1)));
    // Lines alone are no mesh.
    assert!(matches!(faces(1, true), Err(ImportError::NoFaces { .. })));
}

#[test]
fn sparse_and_whole_numbers_are_read() {
    // The last point is moved to (7, 1, 0), by the first three numbers of what stands at byte 12.
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 1, "byteOffset": 3, "componentType": 5121 },
        "values": { "bufferView": 0, "byteOffset": 12 },
    });
    let found = read_all(|document| {
        document["accessors"][0]["sparse"] = sparse;
        document["scenes"][0]["nodes"] = json!([2]);
    });
    assert_eq!(found.expect("a triangle").mesh.points.len(), 3, "the last point lies on the second");
    for (normalized, most) in [(true, DVec3::new(1.0, 0.2, 0.0)), (false, DVec3::new(255.0, 51.0, 0.0))] {
        let found = read_all(|document| {
            document["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
            document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            document["accessors"][0] = json!({
                "bufferView": 3, "componentType": 5121, "normalized": normalized, "type": "VEC3", "count": 4,
                "min": [0, 0, 0], "max": [255, 51, 0],
            });
            document["nodes"][2]["scale"] = json!([1, 1, 1]);
            document["scenes"][0]["nodes"] = json!([2]);
        });
        let bounds = found.expect("triangles").mesh.bounds();
        assert!(bounds.min == DVec3::ZERO && bounds.max.distance(most) < 1e-7, "{bounds:?}");
    }
}

#[test]
fn skinned_meshes_stand_where_their_first_joint_rests() {
    // Without matrices joints are bound at the origin.
    let found = read_all(|document| {
        document["accessors"].as_array_mut().expect("a list").extend([
            // Zeros but for the first, which is written as zeros.
            json!({ "componentType": 5121, "type": "VEC4", "count": 4, "sparse": {
                "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 0 } } }),
            json!({ "bufferView": 2, "componentType": 5126, "type": "VEC4", "count": 4 }),
        ]);
        document["skins"] = json!([{ "joints": [0] }]);
        let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = 2.into();
        attributes["WEIGHTS_0"] = 3.into();
        document["nodes"][2]["skin"] = 0.into();
        document["nodes"][1].as_object_mut().expect("an object").remove("mesh");
    });
    let found = found.expect("squares").mesh;
    // The twin's own scale does not count: it stands where the arm does.
    let bounds = found.bounds();
    assert_eq!((bounds.min, bounds.max), (DVec3::Z * 5.0, DVec3::new(2.0, 1.0, 5.0)));
}

/// The square, carried by its first joint, which stands 5 before the scene's origin, or by both of two.
fn skinned(document: &mut Value) {
    document["accessors"].as_array_mut().expect("a list").extend([
        json!({ "bufferView": 2, "byteOffset": 4, "componentType": 5121, "type": "VEC4", "count": 4 }),
        json!({ "bufferView": 2, "componentType": 5126, "type": "VEC4", "count": 4 }),
    ]);
    document["skins"] = json!([{ "joints": [0, 1] }]);
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = 2.into();
    attributes["WEIGHTS_0"] = 3.into();
    document["nodes"][2]["skin"] = 0.into();
    document["nodes"][1].as_object_mut().expect("an object").remove("mesh");
}

#[test]
fn rigs_have_joints_with_what_is_between_them() {
    let with = |change: &dyn Fn(&mut Value)| {
        let bytes = document(|document| {
            skinned(document);
            change(document);
        });
        open(&bytes, &mut |_| Some(square())).expect("a file").rig()
    };
    let rig = with(&|_| {}).expect("a rig");
    let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!((names.as_slice(), rig.joints[1].parent), (&["arm", "hand"][..], Some(0)));
    // Without matrices both are bound where the mesh is, which stands as the first one rests.
    assert!(
        rig.joints.iter().all(|joint| joint.bind.translation == DVec3::Z * 5.0 && joint.between.is_empty())
    );
    assert!(matches!(rig.joints[0].rest, Place::Parts { translation, .. } if translation == DVec3::Z * 5.0));
    // A node between two joints belongs to neither, and moves what is behind it.
    let rig = with(&|document| {
        document["nodes"]
            .as_array_mut()
            .expect("a list")
            .push(json!({ "children": [1], "translation": [0, 3, 0] }));
        document["nodes"][0]["children"] = json!([3]);
    });
    let hand = &rig.expect("a rig").joints[1];
    assert_eq!(
        (hand.parent, hand.between.as_slice(), hand.before.translation),
        (Some(0), &[3][..], DVec3::Y * 3.0)
    );
    // A second skin that binds a joint elsewhere.
    let fault = with(&|document| {
        document["skins"].as_array_mut().expect("a list").push(json!({ "joints": [2, 0] }));
    });
    assert!(matches!(fault, Err(GltfFault::Bound(0, _))), "{fault:?}");
}

#[test]
fn points_on_one_place_with_other_weights_stay_apart() {
    let weighted = |triangles: bool| {
        let bytes = document(|document| {
            skinned(document);
            document["scenes"][0]["nodes"] = json!([0, 2]);
            if triangles {
                // The mesh once more: the same points with the same weights.
                let twice = document["meshes"][0]["primitives"][0].clone();
                document["meshes"][0]["primitives"].as_array_mut().expect("a list").push(twice);
            }
        });
        read_weighted(&bytes, &ImportOptions::default(), &mut |_| Some(square())).expect("a mesh")
    };
    for twice in [false, true] {
        let found = weighted(twice);
        assert_eq!((found.imported.mesh.points.len(), found.weights.len()), (4, 4));
        assert!(found.weights.iter().all(|own| own == &[(0, 1.0)]), "{:?}", found.weights);
    }
}

#[test]
fn clips_are_read_and_their_times_are_in_order() {
    let clip = |times: [f32; 4], interpolation: &str| {
        let bytes = document(|document| {
            document["buffers"][0]["byteLength"] = 148.into();
            document["bufferViews"]
                .as_array_mut()
                .expect("a list")
                .push(json!({ "buffer": 0, "byteOffset": 132, "byteLength": 16 }));
            document["accessors"].as_array_mut().expect("a list").push(
                json!({ "bufferView": 4, "componentType": 5126, "type": "SCALAR", "count": 4, "min": [0], "max": [9] }));
            document["animations"] = json!([{ "name": "wave",
                "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
                "samplers": [{ "input": 2, "output": 0, "interpolation": interpolation }],
            }]);
        });
        let mut data = square();
        data.extend(times.into_iter().flat_map(f32::to_le_bytes));
        open(&bytes, &mut |_| Some(data.clone())).expect("a file").clips()
    };
    let clips = clip([0.0, 0.5, 1.0, 9.0], "LINEAR").expect("clips");
    assert_eq!((clips[0].name.as_str(), clips[0].duration()), ("wave", 9.0));
    assert!(
        matches!(&clips[0].channels[0].track, Track::Translation(values) if values[1] == [2.0, 0.0, 0.0])
    );
    assert_eq!(clips[0].channels[0].steps, Steps::Linear);
    for times in
        [[0.0, 0.5, 0.5, 1.0], [1.0, 0.5, 2.0, 3.0], [-1.0, 0.0, 1.0, 2.0], [0.0, f32::NAN, 1.0, 2.0]]
    {
        assert_eq!(clip(times, "STEP").expect_err("times"), GltfFault::Times(2), "{times:?}");
    }
    // Cubics have three rows for each key.
    assert_eq!(clip([0.0, 0.5, 1.0, 9.0], "CUBICSPLINE").expect_err("rows"), GltfFault::Accessor(0));
}

#[test]
fn what_is_broken_is_named() {
    assert_eq!(fault(|d| d["buffers"][0]["uri"] = "b.bin".into()), GltfFault::File(0, "b.bin".to_owned()));
    assert_eq!(fault(|d| d["buffers"][0]["uri"] = "data:,x".into()), GltfFault::Base64(0));
    assert_eq!(fault(|d| d["buffers"][0]["byteLength"] = 133.into()), GltfFault::Short(0, 132, 133));
    assert_eq!(fault(|d| d["bufferViews"][0]["byteLength"] = 133.into()), GltfFault::View(0));
    assert_eq!(fault(|d| d["accessors"][0]["count"] = 5.into()), GltfFault::View(0));
    assert_eq!(fault(|d| d["accessors"][0]["type"] = "VEC2".into()), GltfFault::Accessor(0));
    assert_eq!(fault(|d| d["nodes"][1]["children"] = json!([0])), GltfFault::Tree(0));
    assert_eq!(fault(|d| d["nodes"][2]["children"] = json!([1])), GltfFault::Tree(1));
    assert_eq!(fault(|d| d["scenes"][0]["nodes"] = json!([1])), GltfFault::Tree(1));
    let draco = "KHR_draco_mesh_compression";
    assert_eq!(fault(|d| d["extensionsRequired"] = json!([draco])), GltfFault::Extension(draco.to_owned()));
    assert!(matches!(fault(|d| d["nodes"][1]["mesh"] = 1.into()), GltfFault::Document(_)));
    assert!(matches!(fault(|d| d["nodes"][0]["children"] = json!([9])), GltfFault::Document(_)));
    assert!(matches!(fault(|d| d["accessors"][0]["componentType"] = 1.into()), GltfFault::Document(_)));
    // Points 0 to 2 are all that there are.
    assert_eq!(fault(|d| d["accessors"][0]["count"] = 3.into()), GltfFault::Vertex(0, 3));
    for bytes in [&b"glTF"[..], b"", b"{", b"{}", b"glTF\x02\0\0\0\x0c\0\0\0"] {
        assert!(read_with(bytes, &ImportOptions::default()).is_err(), "{bytes:?}");
    }
}

/// Many nodes may show one large mesh: what that comes to is known before.
#[test]
fn too_much_is_refused_before_it_is_read() {
    let options = ImportOptions { most: 7, ..ImportOptions::default() };
    let found = read_with(&document(|_| {}), &options);
    assert!(matches!(found, Err(ImportError::TooMany { what: "triangles", limit: 7 })), "{found:?}");
    let found = read_all(|document| {
        document["accessors"][0]["count"] = (1_u64 << 53).into();
        document["accessors"][1]["count"] = (1_u64 << 53).into();
    });
    assert!(matches!(found, Err(ImportError::TooMany { .. })), "{found:?}");
}

#[test]
fn base64_is_that_of_the_standard() {
    // RFC 4648, section 10.
    for (text, bytes) in
        [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm8", "fo"), ("Zm9v", "foo"), ("Zm9vYmFy", "foobar")]
    {
        assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
    }
    for text in ["Z", "Zm9vY", "Zm 9", "Zm-_", "Z===", "=Zg="] {
        assert_eq!(base64(text.as_bytes()), None, "{text}");
    }
}

#[test]
fn paths_are_unescaped() {
    assert_eq!(unescaped("a%20b%C3%A4.bin"), "a b\u{e4}.bin");
    for strange in ["100%", "%2", "%zz", "%ff"] {
        assert_eq!(unescaped(strange), strange);
    }
}

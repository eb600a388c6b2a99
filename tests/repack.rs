//! glTF files of other makers made small: what must not change does not, and what is broken is told with its place.

use std::collections::BTreeMap;

use kiln::Profile;
use kiln::packing::unpacked;
use kiln::repack::{Codec, Options, Repacked, repacked};
use serde_json::{Value, json};

/// A `.glb` file in the making.
struct File {
    json: Value,
    binary: Vec<u8>,
}

impl File {
    fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0", "copyright": "nobody" },
            "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [], "meshes": [], "nodes": [],
            "scenes": [{ "nodes": [] }], "scene": 0
        });
        Self { json, binary: Vec::new() }
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let all = self.json.as_object_mut().expect("an object").entry(list).or_insert_with(|| json!([]));
        let all = all.as_array_mut().expect("a list");
        all.push(value);
        all.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], kind: (u32, &str, usize)) -> usize {
        let start = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view =
            self.push("bufferViews", json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() }));
        let (component, shape, count) = kind;
        let told = json!({ "bufferView": view, "componentType": component, "type": shape, "count": count });
        self.push("accessors", told)
    }

    fn floats(&mut self, numbers: &[f32], width: usize) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let shape = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][width];
        self.accessor(&bytes, (5126, shape, numbers.len() / width))
    }

    fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.accessor(&bytes, (5123, "SCALAR", indices.len()))
    }

    /// A node that shows a mesh of a primitive, at the top of the scene.
    fn shown(&mut self, name: &str, primitives: Value) -> (usize, usize) {
        let mesh = self.push("meshes", json!({ "name": name, "primitives": primitives }));
        let node = self.push("nodes", json!({ "name": name, "mesh": mesh }));
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(node));
        (mesh, node)
    }

    fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = json!(self.binary.len());
        let text = serde_json::to_vec(&json).expect("it is JSON");
        kiln::gltf::container(text, self.binary.clone()).expect("it is small")
    }

    fn made(&self, profile: Profile) -> Read {
        let options = Options { profile, ..Options::default() };
        Read::of(&made(&self.bytes(), &options).expect("the file is right"))
    }
}

fn made(bytes: &[u8], options: &Options) -> Result<Repacked, String> {
    repacked(bytes, options, &mut |_| None).map_err(|fault| fault.to_string())
}

/// A file, read back.
struct Read {
    json: Value,
    binary: Vec<u8>,
    report: kiln::repack::Report,
    shipped: Value,
}

impl Read {
    fn of(made: &Repacked) -> Self {
        let split = |bytes: &[u8]| {
            let file = gltf::Glb::from_slice(bytes).expect("it is a .glb file");
            let json: Value = serde_json::from_slice(&file.json).expect("it is JSON");
            (json, file.bin.map(std::borrow::Cow::into_owned).unwrap_or_default())
        };
        let (shipped, _) = split(&made.bytes);
        let (json, binary) = split(&unpacked(&made.bytes).expect("its views are whole"));
        Self { json, binary, report: made.report.clone(), shipped }
    }

    fn view(&self, index: usize) -> &[u8] {
        let view = &self.json["bufferViews"][index];
        let start = count(&view["byteOffset"]);
        &self.binary[start..start + count(&view["byteLength"])]
    }

    /// Elements of an accessor, as they stand.
    fn elements(&self, index: &Value) -> Vec<Vec<u8>> {
        let own = &self.json["accessors"][count(index)];
        let width = ["", "SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|shape| own["type"] == *shape);
        let size = match own["componentType"].as_u64() {
            Some(5120 | 5121) => 1,
            Some(5122 | 5123) => 2,
            _ => 4,
        };
        let size = width.expect("a known type") * size;
        let view = count(&own["bufferView"]);
        let stride = self.json["bufferViews"][view]["byteStride"].as_u64();
        let stride = stride.map_or(size, |stride| usize::try_from(stride).expect("small"));
        let bytes = &self.view(view)[count(&own["byteOffset"])..];
        (0..count(&own["count"])).map(|at| bytes[at * stride..][..size].to_vec()).collect()
    }

    fn indices(&self, index: &Value) -> Vec<u16> {
        self.elements(index).iter().map(|own| u16::from_le_bytes([own[0], own[1]])).collect()
    }

    /// Places of vertices on the grid, in the units of the node that shows them.
    fn positions(&self, primitive: &Value, carrier: &Value) -> Vec<[f64; 3]> {
        let step = carrier["scale"][0].as_f64().expect("a step");
        let offset = |axis: usize| carrier["translation"][axis].as_f64().unwrap_or(0.0);
        let place =
            |own: &Vec<u8>, axis: usize| f64::from(u16::from_le_bytes([own[2 * axis], own[2 * axis + 1]]));
        let all = self.elements(&primitive["attributes"]["POSITION"]);
        all.iter().map(|own| [0, 1, 2].map(|axis| offset(axis) + place(own, axis) * step)).collect()
    }
}

fn count(value: &Value) -> usize {
    value.as_u64().map_or(0, |number| usize::try_from(number).expect("small"))
}

/// A wavy sheet of `n` by `n` cells from a corner on, as a soup of triangles.
fn sheet(n: u16, corner: f32) -> Vec<f32> {
    let point = |i: u16, j: u16| {
        let (x, z) = (corner + f32::from(i) / f32::from(n), f32::from(j) / f32::from(n));
        [x, (x * 7.3 + z * 3.1) % 0.37, z]
    };
    let cell = |i: u16, j: u16| {
        let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
        [a, b, c, a, c, d].concat()
    };
    (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect()
}

#[test]
fn meshes_that_touch_still_touch_and_their_vertices_are_few() {
    let mut file = File::new();
    for (name, corner) in [("left", -1.0), ("right", 0.0)] {
        let positions = file.floats(&sheet(40, corner), 3);
        file.shown(name, json!([{ "attributes": { "POSITION": positions } }]));
    }
    let read = file.made(Profile::Web);
    assert_eq!(read.report.vertices.after, 2 * 41 * 41, "{:?}", read.report.vertices);
    assert_eq!(read.report.triangles.after, 2 * 40 * 40 * 2);
    assert!(read.report.bytes.after * 10 < read.report.bytes.before);
    assert!(read.report.acmr.after < 1.0 && read.report.acmr.before == 3.0, "{:?}", read.report.acmr);
    let border = |node: usize| -> Vec<[u64; 3]> {
        let carrier = &read.json["nodes"][count(&read.json["nodes"][node]["children"][0])];
        let mesh = &read.json["meshes"][count(&carrier["mesh"])];
        assert_eq!(read.json["nodes"][node]["name"], mesh["name"]);
        let all = read.positions(&mesh["primitives"][0], carrier);
        let step = carrier["scale"][0].as_f64().expect("a step");
        let mut own: Vec<_> = all.into_iter().filter(|[x, ..]| x.abs() < step).collect();
        own.sort_by(|a, b| a[2].total_cmp(&b[2]));
        own.into_iter().map(|point| point.map(f64::to_bits)).collect()
    };
    assert_eq!(border(0).len(), 41);
    assert_eq!(border(0), border(1), "what lay at one place lies at one place, bit for bit");
    // Half a step along each axis, of the 16384th of two meters.
    assert!(read.report.errors.positions <= 2.0 / 16384.0 * 0.75_f64.sqrt() * 1.0001);
}

#[test]
fn what_an_unknown_extension_may_refer_to_stays() {
    let mut file = File::new();
    let positions = file.floats(&sheet(8, 0.0), 3);
    let other = file.floats(&sheet(8, 2.0), 3);
    let secret = file.floats(&[1.5, 2.5, 3.5, 4.5], 2);
    let unused = file.floats(&[9.0, 9.5], 1);
    let bytes = file.accessor(b"opaque bytes", (5121, "SCALAR", 12));
    let view = count(&file.json["accessors"][bytes]["bufferView"]);
    file.json["accessors"].as_array_mut().expect("a list").pop();
    let told = json!({ "rows": { "values": view }, "accessor": secret, "name": "kept", "weight": 0.25 });
    file.json["extensions"] = json!({ "ACME_secret": told.clone() });
    file.json["extensionsUsed"] = json!(["ACME_secret", "ACME_mesh"]);
    file.json["extensionsRequired"] = json!(["ACME_secret"]);
    let own = json!([{ "attributes": { "POSITION": positions }, "extensions": { "ACME_mesh": { "edges": unused } } }]);
    let (held, node) = file.shown("held", own);
    file.json["nodes"][node]["extras"] = json!({ "hit points": 12 });
    let (free, _) = file.shown("free", json!([{ "attributes": { "POSITION": other } }]));
    let before: Vec<Vec<u8>> = [positions, secret, unused, view]
        .iter()
        .map(|at| {
            let view = &file.json["bufferViews"][*at];
            file.binary[count(&view["byteOffset"])..][..count(&view["byteLength"])].to_vec()
        })
        .collect();
    let read = file.made(Profile::Web);
    assert_eq!(read.json["extensions"]["ACME_secret"], told);
    assert_eq!(read.json["extensionsRequired"][0], "ACME_secret");
    assert_eq!(read.json["asset"]["copyright"], "nobody");
    let kept = &read.json["meshes"][held];
    assert_eq!(*kept, file.json["meshes"][held], "a primitive with an extension stays as it is");
    assert_eq!(read.json["nodes"][node], file.json["nodes"][node]);
    for (place, accessor) in [positions, secret, unused].into_iter().enumerate() {
        let own = &read.json["accessors"][accessor];
        assert_eq!(own["count"], file.json["accessors"][accessor]["count"]);
        assert_eq!(read.view(count(&own["bufferView"])), before[place], "accessor {accessor}");
    }
    assert_eq!(read.view(view), before[3], "views that are named keep their numbers");
    assert_eq!(
        read.json["accessors"][count(&read.json["meshes"][free]["primitives"][0]["attributes"]["POSITION"])]
            ["componentType"],
        5123
    );
    assert!(read.report.notes.iter().any(|note| note.contains("ACME_mesh")), "{:?}", read.report.notes);
}

#[test]
fn what_is_said_twice_is_said_once_and_names_stay() {
    let mut file = File::new();
    let (first, second) = (file.floats(&sheet(6, 0.0), 3), file.floats(&sheet(6, 0.0), 3));
    let picture = file.accessor(b"\x89PNG not a whole picture", (5121, "SCALAR", 24));
    let view = count(&file.json["accessors"][picture]["bufferView"]);
    for _ in 0..2 {
        let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let texture = file.push("textures", json!({ "source": image }));
        let look = json!({ "baseColorTexture": { "index": texture } });
        file.push("materials", json!({ "name": "stone", "pbrMetallicRoughness": look }));
    }
    file.push("materials", json!({ "name": "moss" }));
    for (name, positions, material) in [("a", first, 0), ("a", second, 1), ("b", second, 1), ("a", first, 2)]
    {
        file.shown(name, json!([{ "attributes": { "POSITION": positions }, "material": material }]));
    }
    let read = file.made(Profile::Web);
    let length = |list: &str| read.json[list].as_array().map_or(0, Vec::len);
    assert_eq!((length("images"), length("textures"), length("materials")), (1, 1, 2));
    let meshes: Vec<&Value> = read.json["meshes"].as_array().expect("a list").iter().collect();
    let told: Vec<_> =
        meshes.iter().map(|mesh| (mesh["name"].clone(), mesh["primitives"][0]["material"].clone())).collect();
    assert_eq!(told, [(json!("a"), json!(0)), (json!("b"), json!(0)), (json!("a"), json!(1))]);
    // All of them share their numbers.
    assert_eq!(length("accessors"), 2, "positions and indices: {}", read.json["accessors"]);
}

/// `KHR_materials_volume`: a thickness is one in the units of the mesh, which are the steps of its grid.
#[test]
fn bodies_are_as_thick_as_before() {
    let mut file = File::new();
    let large: Vec<f32> = sheet(6, 0.0).into_iter().map(|number| number * 50.0).collect();
    let (small, large) = (file.floats(&sheet(6, 0.0), 3), file.floats(&large, 3));
    let volume = json!({ "KHR_materials_volume": { "thicknessFactor": 0.25, "attenuationDistance": 2 } });
    file.push("materials", json!({ "name": "glass", "extensions": volume }));
    for (name, positions, scale) in [("a", small, 1.0), ("b", large, 1.0), ("c", small, 50.0)] {
        let primitives = json!([{ "attributes": { "POSITION": positions }, "material": 0 }]);
        let (_, node) = file.shown(name, primitives);
        file.json["nodes"][node]["scale"] = json!([scale, scale, scale]);
    }
    file.json["extensionsUsed"] = json!(["KHR_materials_volume"]);
    let read = file.made(Profile::Three);
    let (nodes, materials) = (&read.json["nodes"], &read.json["materials"]);
    for top in 0..3 {
        let carrier = &nodes[count(&nodes[top]["children"][0])];
        let step = carrier["scale"][0].as_f64().expect("a step");
        let worn = &read.json["meshes"][count(&carrier["mesh"])]["primitives"][0]["material"];
        let volume = &materials[count(worn)]["extensions"]["KHR_materials_volume"];
        let thick = volume["thicknessFactor"].as_f64().expect("a number") * step;
        assert!((thick - 0.25).abs() < 1e-7, "node {top}: {thick}");
        assert_eq!(volume["attenuationDistance"], 2);
        assert_eq!(materials[count(worn)]["name"], "glass");
    }
    // Where the thickness moves, what wears it keeps its units.
    let (times, values) = (file.floats(&[0.0, 1.0], 1), file.floats(&[0.25, 0.5], 1));
    let pointer = "/materials/0/extensions/KHR_materials_volume/thicknessFactor";
    let target =
        json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
    file.push(
        "animations",
        json!({ "samplers": [{ "input": times, "output": values }], "channels": [{ "sampler": 0, "target": target }] }),
    );
    file.json["extensionsUsed"] = json!(["KHR_materials_volume", "KHR_animation_pointer"]);
    let read = file.made(Profile::Three);
    assert_eq!(read.json["materials"].as_array().map(Vec::len), Some(1));
    assert_eq!(read.json["materials"][0]["extensions"]["KHR_materials_volume"]["thicknessFactor"], 0.25);
    assert!(read.json["nodes"].as_array().expect("nodes").iter().all(|node| node.get("children").is_none()));
}

/// Pictures of extensions of materials that are said twice, and materials that name coarser ones.
#[test]
fn pictures_and_materials_that_extensions_name_are_renamed() {
    let mut file = File::new();
    let positions = file.floats(&sheet(6, 0.0), 3);
    for bytes in [b"\x89PNG first", b"\x89PNG first", b"\x89PNG other"] {
        let picture = file.accessor(bytes, (5121, "SCALAR", bytes.len()));
        let view = count(&file.json["accessors"][picture]["bufferView"]);
        let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        file.push("textures", json!({ "source": image }));
    }
    let coat = |normal: usize| {
        let coat =
            json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": normal, "scale": 0.5 } });
        let sheen = json!({ "sheenColorTexture": { "index": 2, "texCoord": 1 } });
        json!({ "KHR_materials_clearcoat": coat, "KHR_materials_sheen": sheen })
    };
    file.push("materials", json!({ "name": "a", "extensions": coat(0) }));
    file.push("materials", json!({ "name": "a", "extensions": coat(1) }));
    file.push("materials", json!({ "name": "far" }));
    file.push("materials", json!({ "name": "b", "extensions": { "MSFT_lod": { "ids": [2] } } }));
    for material in [1, 3] {
        file.shown("m", json!([{ "attributes": { "POSITION": positions }, "material": material }]));
    }
    file.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_materials_sheen", "MSFT_lod"]);
    let read = file.made(Profile::Web);
    let materials = read.json["materials"].as_array().expect("a list");
    assert_eq!(materials.len(), 3, "{materials:?}");
    let own = &materials[0]["extensions"];
    assert_eq!(own["KHR_materials_clearcoat"]["clearcoatNormalTexture"], json!({ "index": 0, "scale": 0.5 }));
    assert_eq!(own["KHR_materials_sheen"]["sheenColorTexture"], json!({ "index": 1, "texCoord": 1 }));
    assert_eq!(read.json["images"].as_array().map(Vec::len), Some(2));
    assert_eq!(materials[2]["extensions"]["MSFT_lod"]["ids"], json!([1]));
}

#[test]
fn neighbors_of_one_material_are_one_and_strips_become_lists() {
    let mut file = File::new();
    let positions = file.floats(
        &(0..12_u8).flat_map(|at| [f32::from(at / 2), f32::from(at % 2), 0.0]).collect::<Vec<_>>(),
        3,
    );
    file.push("materials", json!({ "name": "m" }));
    let strip = file.indices(&[0, 1, 2, 3, 4, 4, 5]);
    let fan = file.indices(&[6, 7, 8, 10, 11]);
    let list = file.indices(&[1, 3, 5]);
    let one = |indices: usize, mode: u8| json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode, "material": 0 });
    let mut last = one(list, 4);
    last["material"] = Value::Null;
    last.as_object_mut().expect("an object").remove("material");
    let (mesh, _) = file.shown("strips", json!([one(strip, 5), one(fan, 6), last]));
    let read = file.made(Profile::Core);
    let primitives = read.json["meshes"][mesh]["primitives"].as_array().expect("a list");
    assert_eq!(primitives.len(), 2);
    let corner = |vertex: u16| {
        let own = read.elements(&primitives[0]["attributes"]["POSITION"])[usize::from(vertex)].clone();
        let part =
            |at: usize| f32::from_le_bytes([own[4 * at], own[4 * at + 1], own[4 * at + 2], own[4 * at + 3]]);
        part(0) * 2.0 + part(1)
    };
    let indices = read.indices(&primitives[0]["indices"]);
    let mut found: Vec<[i32; 3]> = indices
        .as_chunks::<3>()
        .0
        .iter()
        .map(|triangle| {
            let all = triangle.map(|vertex| format!("{}", corner(vertex)).parse::<i32>().expect("whole"));
            let least = (0..3).min_by_key(|at| all[*at]).unwrap_or(0);
            [0, 1, 2].map(|step| all[(least + step) % 3])
        })
        .collect();
    found.sort_unstable();
    // Of the strip, the triangles with vertex 4 twice are none.
    assert_eq!(found, [[0, 1, 2], [1, 3, 2], [2, 3, 4], [6, 7, 8], [6, 8, 10], [6, 10, 11]]);
    assert!(primitives.iter().all(|primitive| primitive.get("mode").is_none()));
}

#[test]
fn weights_move_where_the_mesh_hangs_and_skins_take_it_back() {
    let mut file = File::new();
    let positions = file.floats(&sheet(6, 0.0), 3);
    let vertices = sheet(6, 0.0).len() / 3;
    let mut lifted = vec![0.0; vertices * 3];
    lifted[4] = 0.3;
    let target = file.floats(&lifted, 3);
    let primitive = json!([{ "attributes": { "POSITION": positions }, "targets": [{ "POSITION": target }] }]);
    let (_, node) = file.shown("face", primitive);
    file.json["nodes"][node]["weights"] = json!([0.5]);
    let joints = file.accessor(&vec![0; vertices * 4], (5121, "VEC4", vertices));
    let shares = file.floats(&[1.0, 0.0, 0.0, 0.0].repeat(vertices), 4);
    let carried =
        json!([{ "attributes": { "POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": shares } }]);
    let (_, body) = file.shown("body", carried);
    file.push("skins", json!({ "joints": [node] }));
    file.json["nodes"][body]["skin"] = json!(0);
    let (times, keys) = (file.floats(&[0.0, 1.0, 2.0], 1), file.floats(&[0.0, 1.0, 0.0], 1));
    let moves = file.floats(&[1.0, 2.0, 3.0].repeat(3), 3);
    let channel =
        |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    file.push(
        "animations",
        json!({
            "name": "smile",
            "channels": [channel(0, "weights"), channel(1, "translation")],
            "samplers": [{ "input": times, "output": keys }, { "input": times, "output": moves }]
        }),
    );
    let read = file.made(Profile::Web);
    let carrier = count(&read.json["nodes"][node]["children"][0]);
    assert_eq!(read.json["nodes"][carrier]["weights"], json!([0.5]));
    assert!(read.json["nodes"][node].get("weights").is_none());
    let channels = &read.json["animations"][0]["channels"];
    assert_eq!(channels[0]["target"]["node"], carrier);
    assert_eq!(channels[1]["target"]["node"], node, "what moves a node moves that node");
    // A skin without matrices has one now, which holds the grid.
    let skin = &read.json["skins"][0];
    assert_eq!(read.json["accessors"][count(&skin["inverseBindMatrices"])]["type"], "MAT4");
    let bind = read.view(count(&read.json["accessors"][count(&skin["inverseBindMatrices"])]["bufferView"]));
    let step = f32::from_le_bytes([bind[0], bind[1], bind[2], bind[3]]);
    assert_eq!(
        f64::from(step),
        read.json["nodes"][carrier]["scale"][0]
            .as_f64()
            .map_or(0.0, |step| f64::from(format!("{step}").parse::<f32>().expect("a number")))
    );
    // What stays still keeps its first and last key.
    let still = &read.json["animations"][0]["samplers"][1];
    assert_eq!(read.json["accessors"][count(&still["output"])]["count"], 2);
    assert_eq!(read.json["accessors"][count(&still["input"])]["max"], json!([2]));
}

#[test]
fn the_bytes_depend_on_the_input_alone() {
    let mut file = File::new();
    for (name, corner) in [("a", 0.0), ("b", 3.0), ("c", 7.0)] {
        let positions = file.floats(&sheet(90, corner), 3);
        file.shown(name, json!([{ "attributes": { "POSITION": positions } }]));
    }
    let bytes = file.bytes();
    for (profile, codec) in
        [(Profile::Core, Codec::Zero), (Profile::Web, Codec::Zero), (Profile::Web, Codec::One)]
    {
        let options = Options { profile, codec, ..Options::default() };
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| made(&bytes, &options).expect("the file is right").bytes)
        };
        let one = with(1);
        assert_eq!(one, with(4), "{}", profile.name());
        let name = codec.extension();
        let read = Read::of(&made(&bytes, &options).expect("the file is right"));
        let compressed = profile == Profile::Web;
        assert_eq!(read.shipped["extensionsRequired"].to_string().contains(name), compressed);
    }
}

#[test]
fn small_changes_of_few_vertices_are_sparse_where_nothing_is_compressed() {
    let mut file = File::new();
    let points = sheet(20, 0.0);
    let positions = file.floats(&points, 3);
    let mut lifted = vec![0.0; points.len()];
    lifted[4] = 0.3;
    let target = file.floats(&lifted, 3);
    file.shown(
        "face",
        json!([{ "attributes": { "POSITION": positions }, "targets": [{ "POSITION": target }] }]),
    );
    for (profile, sparse) in [(Profile::Core, true), (Profile::Quantized, true), (Profile::Web, false)] {
        let read = file.made(profile);
        let target = &read.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
        let accessor = &read.json["accessors"][count(target)];
        assert_eq!(accessor.get("sparse").is_some(), sparse, "{}", profile.name());
        let least = accessor["max"][1].as_f64().expect("a bound");
        assert!(least > 0.0, "the greatest change is told");
    }
}

/// Documents with one thing wrong each: where it is put, what is put there, and what is said of it.
#[test]
fn broken_documents_are_told_with_their_place() {
    let mut file = File::new();
    let positions = file.floats(&sheet(2, 0.0), 3);
    let indices = file.indices(&[0, 1, 2, 3, 4, 5]);
    file.shown("s", json!([{ "attributes": { "POSITION": positions }, "indices": indices }]));
    let times = file.floats(&[0.0, 1.0], 1);
    let keys = file.floats(&[0.0; 6], 3);
    file.push(
        "animations",
        json!({
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": times, "output": keys }]
        }),
    );
    file.push("skins", json!({ "joints": [0] }));
    made(&file.bytes(), &Options::default()).expect("nothing is wrong yet");
    let packed = json!({ "EXT_meshopt_compression":
        { "buffer": 0, "byteLength": 8, "byteStride": 4, "count": 1 << 30, "mode": "ATTRIBUTES" } });
    let cases = [
        ("/asset/version", json!("1.0"), "/asset/version: "),
        ("/nodes", json!({}), "/nodes: it is no list"),
        ("/nodes/0", json!(7), "/nodes/0: it is no object"),
        ("/nodes/0/mesh", json!(3), "/nodes/0/mesh: 3 is not below 1"),
        ("/nodes/0/scale", json!([1, 2]), "/nodes/0/scale: it is not 3 numbers"),
        ("/nodes/0/children", json!([0]), "/nodes/0/children: node 0 is below itself"),
        ("/scene", json!(-1), "/scene: -1 is no index"),
        ("/scenes/0/nodes/0", json!(1.5), "/scenes/0/nodes/0: 1.5 is no index"),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(9),
            "/meshes/0/primitives/0/attributes/POSITION: 9 is",
        ),
        (
            "/meshes/0/primitives/0/indices",
            json!(0),
            "/meshes/0/primitives/0/indices: its accessor holds no indices",
        ),
        ("/meshes/0/primitives/0/mode", json!(7), "/meshes/0/primitives/0/mode: 7 is none of"),
        (
            "/meshes/0/primitives/0/attributes/NORMAL",
            json!(3),
            "POSITION: it has 24 elements where others have 2",
        ),
        ("/accessors/0/componentType", json!(5124), "/accessors/0/componentType: 5124 is none of"),
        ("/accessors/0/type", json!("VEC5"), "/accessors/0/type: \"VEC5\" is no type"),
        ("/accessors/0/count", json!(25), "/accessors/0: it reaches past the end of buffer view 0"),
        ("/accessors/0/byteOffset", json!(4), "/accessors/0: it reaches past the end of buffer view 0"),
        ("/accessors/1/count", json!(u64::MAX), "/accessors/1"),
        ("/accessors/0/bufferView", json!(77), "/accessors/0/bufferView: 77 is not below"),
        ("/bufferViews/0/byteLength", json!(1_u64 << 40), "/bufferViews/0: it reaches past the end"),
        ("/bufferViews/0/byteStride", json!(4), "/accessors/0: it reaches past"),
        ("/bufferViews/0/extensions", packed, "/bufferViews/0: with those before it, it claims to hold more"),
        ("/buffers/0/uri", json!("beside.bin"), "/buffers/0/uri: "),
        ("/buffers/0/uri", json!("data:x;base64,%%%"), "/buffers/0/uri: "),
        (
            "/animations/0/samplers/0/output",
            json!(2),
            "/animations/0/samplers/0/output: its accessor holds SCALAR, and translation is VEC3",
        ),
        ("/animations/0/channels/0/sampler", json!(4), "/animations/0/channels/0/sampler: it is not below 1"),
        ("/skins/0/joints", json!([]), "/skins/0/joints: a skin has 1 joint or more"),
        (
            "/skins/0/inverseBindMatrices",
            json!(0),
            "/skins/0/inverseBindMatrices: its accessor does not hold 1 matrices",
        ),
    ];
    let mut unlike = BTreeMap::new();
    for (place, value, words) in cases {
        let mut broken = File { json: file.json.clone(), binary: file.binary.clone() };
        let (above, name) = place.rsplit_once('/').expect("a way");
        let into = broken.json.pointer_mut(above).expect("it is there");
        match name.parse::<usize>() {
            Ok(at) if into.is_array() => into[at] = value,
            _ => into[name] = value,
        }
        let length = broken.binary.len();
        let mut json = broken.json.clone();
        json["buffers"][0]["byteLength"] = json!(length);
        let text = serde_json::to_vec(&json).expect("it is JSON");
        let bytes = kiln::gltf::container(text, broken.binary).expect("it is small");
        for profile in [Profile::Core, Profile::Web] {
            match made(&bytes, &Options { profile, ..Options::default() }) {
                Ok(_) => drop(unlike.insert(place, "nothing is said".to_owned())),
                Err(fault) if fault.contains(words) => {}
                Err(fault) => drop(unlike.insert(place, fault)),
            }
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
    let mut broken = File { json: file.json.clone(), binary: file.binary.clone() };
    broken.binary[16..20].copy_from_slice(&f32::NAN.to_le_bytes());
    let fault = made(&broken.bytes(), &Options::default()).expect_err("a number is none");
    assert!(fault.contains("/accessors/0: a number of its element 1 is not finite"), "{fault}");
}

#[test]
fn draco_is_refused_by_name_unless_there_is_another_form() {
    let mut file = File::new();
    let positions = file.floats(&sheet(2, 0.0), 3);
    let packed =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    file.shown("s", json!([{ "attributes": { "POSITION": positions }, "extensions": packed }]));
    file.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    let read = file.made(Profile::Web);
    assert!(!read.shipped.to_string().contains("draco"), "what is read is the other form");
    assert!(read.report.notes.is_empty());
    let refused = |file: &File| {
        let fault = made(&file.bytes(), &Options::default()).expect_err("it is not read");
        assert!(
            fault.starts_with("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression: "),
            "{fault}"
        );
    };
    let mut required = File { json: file.json.clone(), binary: file.binary.clone() };
    required.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    refused(&required);
    file.json["accessors"][0].as_object_mut().expect("an object").remove("bufferView");
    refused(&file);
}

#[test]
fn files_that_are_cut_off_or_changed_are_files_or_faults() {
    let mut file = File::new();
    let positions = file.floats(&sheet(5, 0.0), 3);
    file.shown("s", json!([{ "attributes": { "POSITION": positions } }]));
    let options = Options { profile: Profile::Web, ..Options::default() };
    let whole = made(&file.bytes(), &options).expect("the file is right").bytes;
    for at in 0..whole.len() {
        assert!(made(&whole[..at], &options).is_err(), "cut off at {at}");
        let mut changed = whole.clone();
        changed[at] ^= 1 << (at % 8);
        if let Ok(again) = made(&changed, &options) {
            // What comes out is a file that is read again.
            assert!(made(&again.bytes, &options).is_ok(), "changed at {at}");
        }
    }
    crate::counts::tried("damaged-optimized-files", 2 * whole.len());
}

/// A triangle is shorter as it is than with words about whole numbers and compressed views; a sheet is not.
#[test]
fn files_of_a_few_triangles_do_not_grow() {
    for (side, plain) in [(1, true), (60, false)] {
        let mut file = File::new();
        let positions = file.floats(&sheet(side, 0.0), 3);
        file.shown("a", json!([{ "attributes": { "POSITION": positions } }]));
        let bytes = file.bytes();
        let options = Options { profile: Profile::Web, shortest: true, ..Options::default() };
        let read = Read::of(&made(&bytes, &options).expect("the file is right"));
        assert_eq!(read.shipped.get("extensionsRequired").is_none(), plain, "{side}");
        assert_eq!(read.report.notes.len(), usize::from(plain), "{:?}", read.report.notes);
        let longer = made(&bytes, &Options { shortest: false, ..options }).expect("the file is right");
        assert!(read.report.bytes.after <= longer.bytes.len() as u64);
    }
}

/// Colors, normals and numbers, each in its own way; what no reader here knows, and what is small enough, stays.
#[test]
fn pictures_are_made_smaller_where_that_is_asked_for() {
    use kiln::import::image::{Pixels, pixels, png};
    let checks = |size: u32| {
        let rgba = (0..size * size)
            .map(|k| if (k % size + k / size).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] });
        png(&Pixels { width: size, height: size, rgba: rgba.collect() }, false)
    };
    let mut file = File::new();
    let positions = file.floats(&sheet(4, 0.0), 3);
    file.shown("a", json!([{ "attributes": { "POSITION": positions }, "material": 0 }]));
    let data = |bytes: &[u8]| {
        let mut text = "data:image/png;base64,".to_owned();
        text.push_str(&base64(bytes));
        json!({ "uri": text })
    };
    file.json["images"] =
        json!([data(&checks(64)), data(&checks(64)), data(&checks(8)), data(b"\xabKTX 20\xbb rest")]);
    file.json["textures"] = json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }, { "source": 3 }]);
    file.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "occlusionTexture": { "index": 2 },
        "emissiveTexture": { "index": 3 },
    }]);
    let options = Options { texture_size: Some(16), compress_textures: true, ..Options::default() };
    let read = Read::of(&made(&file.bytes(), &options).expect("the file is right"));
    let images = read.json["images"].as_array().expect("pictures");
    let picture = |image: usize| {
        let view = images[image]["bufferView"].as_u64().and_then(|view| usize::try_from(view).ok());
        pixels(read.view(view.expect("a view")), 1 << 20)
    };
    let (color, numbers, small) = (picture(0), picture(1), picture(2));
    let (color, numbers) = (color.expect("a picture"), numbers.expect("a picture"));
    assert_eq!(([color.width, color.height], [numbers.width, numbers.height]), ([16, 16], [16, 16]));
    assert_eq!(color.rgba[35], [188, 188, 188, 255], "as light");
    assert!(numbers.rgba[35][0].abs_diff(128) <= 1, "as numbers");
    assert_eq!(small.expect("a picture").width, 8);
    assert_eq!(images[3]["mimeType"], "image/ktx2");
    // What is broken is told.
    file.json["images"][0] = data(&checks(64)[..100]);
    let told = made(&file.bytes(), &options).expect_err("cut off");
    assert!(told.contains("/images/0"), "{told}");
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0_usize, |word, byte| word << 8 | usize::from(*byte))
            << (8 * (3 - three.len()));
        for place in 0..4 {
            let letter = LETTERS[word >> (18 - 6 * place) & 63];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Places of a mesh that a node shows many times, by a reader that knows the extension: each vertex at each copy.
fn copied(json: &Value, numbers: &dyn Fn(&Value) -> Vec<Vec<f64>>) -> Vec<glam::DVec3> {
    let node = json["nodes"].as_array().expect("nodes").iter().find(|node| node["name"] == "forest");
    let node = node.expect("it keeps its name");
    let own = &node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    let (moves, turns, sizes) =
        (numbers(&own["TRANSLATION"]), numbers(&own["ROTATION"]), numbers(&own["SCALE"]));
    let mesh = &json["meshes"][count(&node["mesh"])]["primitives"][0]["attributes"]["POSITION"];
    let points = numbers(mesh);
    let mut all = Vec::new();
    for ((size, turn), from) in sizes.iter().zip(&turns).zip(&moves) {
        let turn = glam::DQuat::from_slice(turn).normalize();
        let map = glam::DAffine3::from_scale_rotation_translation(
            glam::DVec3::from_slice(size),
            turn,
            glam::DVec3::from_slice(from),
        );
        all.extend(points.iter().map(|point| map.transform_point3(glam::DVec3::from_slice(point))));
    }
    all
}

/// Copies stand where they stood, one of them many times as large as the rest; their numbers may be whole ones.
#[test]
fn what_is_shown_many_times_at_once_stays_where_it_is() {
    let mut file = File::new();
    let position = file.floats(&sheet(6, 0.37), 3);
    let primitives = json!([{ "attributes": { "POSITION": position } }]);
    let (_, node) = file.shown("forest", primitives);
    let moves = file.floats(&[1.0, 2.0, 3.0, -40.0, 0.5, 7.0, 0.0, 0.0, 90.0], 3);
    let turns: Vec<u8> = [[0_i16, 0, 0, 32767], [0, 23170, 0, 23170], [18918, 0, 0, 26754]]
        .into_iter()
        .flatten()
        .flat_map(i16::to_le_bytes)
        .collect();
    let turns = file.accessor(&turns, (5122, "VEC4", 3));
    file.json["accessors"][turns]["normalized"] = json!(true);
    let sizes = file.floats(&[1.0, 1.0, 1.0, 0.5, 2.0, 0.5, 30.0, 30.0, 30.0], 3);
    let shade = file.floats(&[0.1, 0.2, 0.3], 1);
    let own = json!({ "TRANSLATION": moves, "ROTATION": turns, "SCALE": sizes, "_SHADE": shade });
    file.json["nodes"][node]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": own } });
    file.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let numbers = |read: &Read, index: &Value| -> Vec<Vec<f64>> {
        let kind = read.json["accessors"][count(index)]["componentType"].as_u64();
        let one = |bytes: &[u8]| match kind {
            Some(5122) => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])) / 32767.0,
            Some(5123) => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            _ => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        };
        let size = if matches!(kind, Some(5122 | 5123)) { 2 } else { 4 };
        read.elements(index).iter().map(|row| row.chunks(size).map(one).collect()).collect()
    };
    let plain = file.made(Profile::Core);
    let before = copied(&plain.json, &|index| numbers(&plain, index));
    assert_eq!((before.len(), plain.report.errors.positions), (3 * 7 * 7, 0.0));
    for profile in [Profile::Quantized, Profile::Web] {
        let made = file.made(profile);
        let after = copied(&made.json, &|index| numbers(&made, index));
        let attributes = &made.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
        let mesh = &made.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
        assert_eq!(made.json["accessors"][count(mesh)]["componentType"], 5123, "the mesh is on a grid");
        let error = made.report.errors.positions;
        assert!(error > 0.0 && error < 0.02, "{error}");
        // The order of vertices may be another one.
        let near =
            |from: &glam::DVec3| after.iter().map(|to| from.distance(*to)).fold(f64::INFINITY, f64::min);
        let off = before.iter().map(near).fold(0.0, f64::max);
        assert!(off <= error * 1.001 + 1e-5, "{off} and {error}");
        let shades: Vec<f64> = numbers(&made, &attributes["_SHADE"]).concat();
        assert!(shades.iter().zip([0.1, 0.2, 0.3]).all(|(found, wanted)| (found - wanted).abs() < 1e-7));
    }
}

/// Places that do not belong together are told with where they stand.
#[test]
fn places_of_unequal_numbers_are_told() {
    let mut file = File::new();
    let position = file.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 3);
    let (_, node) = file.shown("forest", json!([{ "attributes": { "POSITION": position } }]));
    let moves = file.floats(&[0.0; 6], 3);
    let sizes = file.floats(&[1.0; 3], 3);
    let own = json!({ "SCALE": sizes, "TRANSLATION": moves });
    file.json["nodes"][node]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": own } });
    let found = made(&file.bytes(), &Options::default()).expect_err("it is refused");
    assert!(found.contains("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION"), "{found}");
    file.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = json!(77);
    let found = made(&file.bytes(), &Options::default()).expect_err("it is refused");
    assert!(found.contains("77 is no accessor"), "{found}");
}

//! Nodes that show a shape several times: nodes below them, or places of one node.

use glam::{DAffine3, DMat4, DQuat, DVec3, EulerRot};
use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::language::Document;
use kiln::packing::unpacked;
use serde_json::Value;

use super::glb::Glb;
use super::inputs;

const RING: &str = "tolerance = 0.004
[shape.post]
material = \"wood\"
[shape.post.revolve]
profile = { bezier = { points = [[0, 0], [0.3, 0.1], [0.05, 0.4], [0, 0.8]] } }
[shape.ball.sphere]
radius = 0.25
[material.wood]
color = \"#806040\"
[node.ring]
shape = \"post\"
at = [1, 0, 0]
rotate = [0, 30, 0]
copies = { count = 12, each = { at = [\"= 3 * i\", 0, \"= i * i / 4\"], rotate = [0, \"= 30 * i\", 10], scale = [\"= 1 + i / 20\", 1, 1] } }
[node.ball]
shape = \"ball\"
parent = \"ring\"
";
const INSTANCES: &str = "EXT_mesh_gpu_instancing";
const DRAWING: [Profile; 5] =
    [Profile::Web, Profile::Unity, Profile::Three, Profile::Babylon, Profile::Blender];
const SHOWING: [Profile; 6] =
    [Profile::Core, Profile::Quantized, Profile::Verify, Profile::Bevy, Profile::Godot, Profile::Unreal];

fn baked(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = inputs().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().expect("an index")).expect("it fits")
}

fn vector<const N: usize>(value: Option<&Value>, rest: [f64; N]) -> [f64; N] {
    let Some(all) = value.and_then(Value::as_array) else { return rest };
    core::array::from_fn(|place| all[place].as_f64().expect("a number"))
}

fn local(node: &Value) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        vector(node.get("scale"), [1.0; 3]).into(),
        DQuat::from_array(vector(node.get("rotation"), [0.0, 0.0, 0.0, 1.0])),
        vector(node.get("translation"), [0.0; 3]).into(),
    )
}

/// The corners of the box that an accessor says its positions have.
fn corners(accessor: &Value) -> Vec<DVec3> {
    let [low, high] = ["min", "max"].map(|bound| vector::<3>(accessor.get(bound), [0.0; 3]));
    let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    (0..8).map(|corner| DVec3::from_array([0, 1, 2].map(|axis| pick(corner, axis)))).collect()
}

/// The boxes, in the scene, of the corners of a mesh's box, at all places where a mesh of the name is shown, by a reader that knows the extension.
fn boxes(glb: &Glb, name: &str) -> Vec<[DVec3; 2]> {
    let scene = &glb.list("scenes")[0]["nodes"];
    let mut open: Vec<(usize, DAffine3)> =
        scene.as_array().expect("nodes").iter().rev().map(|node| (index(node), DAffine3::IDENTITY)).collect();
    let mut found = Vec::new();
    while let Some((at, above)) = open.pop() {
        let node = &glb.list("nodes")[at];
        let world = above * local(node);
        let below = node["children"].as_array().into_iter().flatten().rev();
        open.extend(below.map(|child| (index(child), world)));
        let Some(mesh) = node.get("mesh").map(index) else { continue };
        if glb.list("meshes")[mesh]["name"] != name {
            continue;
        }
        let attributes = node["extensions"].get(INSTANCES).map(|own| &own["attributes"]);
        let places = attributes.map_or_else(
            || vec![DAffine3::IDENTITY],
            |attributes| {
                let column = |name: &str| attributes.get(name).map(|own| glb.accessor(index(own)));
                let (moves, turns, sizes) = (column("TRANSLATION"), column("ROTATION"), column("SCALE"));
                let moves = moves.expect("every place has one");
                let place = |row: usize| {
                    let size = sizes.as_ref().map_or(DVec3::ONE, |all| DVec3::from_slice(&all[row]));
                    let turn = turns.as_ref().map_or(DQuat::IDENTITY, |all| DQuat::from_slice(&all[row]));
                    DAffine3::from_scale_rotation_translation(size, turn, DVec3::from_slice(&moves[row]))
                };
                (0..moves.len()).map(place).collect()
            },
        );
        let positions = &glb.list("meshes")[mesh]["primitives"][0]["attributes"]["POSITION"];
        let points = corners(&glb.list("accessors")[index(positions)]);
        for place in places {
            let all = points.iter().map(|point| (world * place).transform_point3(*point));
            let low = all.clone().fold(DVec3::INFINITY, DVec3::min);
            found.push([low, all.fold(DVec3::NEG_INFINITY, DVec3::max)]);
        }
    }
    found
}

/// Where the document says that the places are, with the box of the shape there.
fn wanted(points: &[DVec3]) -> Vec<[DVec3; 2]> {
    let turn = |degrees: [f64; 3]| {
        let [x, y, z] = degrees.map(f64::to_radians);
        DMat4::from_euler(EulerRot::ZYX, z, y, x)
    };
    let above = DMat4::from_translation(DVec3::X) * turn([0.0, 30.0, 0.0]);
    let place = |i: i32| {
        let i = f64::from(i);
        let at = DMat4::from_translation(DVec3::new(3.0 * i, 0.0, i * i / 4.0));
        let map = above
            * at
            * turn([0.0, 30.0 * i, 10.0])
            * DMat4::from_scale(DVec3::new(1.0 + i / 20.0, 1.0, 1.0));
        let all = points.iter().map(|point| map.transform_point3(*point));
        [all.clone().fold(DVec3::INFINITY, DVec3::min), all.fold(DVec3::NEG_INFINITY, DVec3::max)]
    };
    (0..12).map(place).collect()
}

#[test]
fn copies_stand_where_the_document_says_in_every_profile() {
    let all = [SHOWING.as_slice(), &DRAWING].concat();
    let files = baked(RING, &all);
    let core = Glb::new(&files[0].bytes);
    let post = core.list("meshes").iter().find(|mesh| mesh["name"] == "post").expect("it is shown");
    let post = index(&post["primitives"][0]["attributes"]["POSITION"]);
    let points = corners(&core.list("accessors")[post]);
    let wanted = wanted(&points);
    for file in &files {
        let plain = unpacked(&file.bytes).expect("it was written so");
        let glb = Glb::new(&plain);
        let found = boxes(&glb, "post");
        assert_eq!(found.len(), 12, "{:?}", file.profile);
        for (found, wanted) in found.iter().zip(&wanted) {
            let off = (found[0] - wanted[0]).abs().max((found[1] - wanted[1]).abs()).max_element();
            // Twice what surfaces may be off by, and the greatest factor of size.
            assert!(off < 2.0 * 0.004 * 1.6, "{off} in {:?}", file.profile);
        }
        let drawn = file.profile.draws_instances();
        for list in ["extensionsUsed", "extensionsRequired"] {
            let told = glb.json[list].as_array().into_iter().flatten().any(|one| one == INSTANCES);
            assert_eq!(told, drawn, "{:?}", file.profile);
        }
        let named = |name: &str| glb.list("nodes").iter().any(|node| node["name"] == name);
        assert_eq!(named("ring.11"), !drawn);
        assert!(named("ring") && named("ball"));
    }
}

/// Whether copies are nodes or places, the report tells the same of them.
#[test]
fn the_report_does_not_depend_on_how_copies_are_drawn() {
    let files = baked(RING, &[Profile::Core, Profile::Blender]);
    let [one, other] = [0, 1].map(|file: usize| files[file].report.as_ref().expect("a report"));
    assert_eq!(one.totals.nodes, 14);
    assert_eq!(one.totals.nodes, other.totals.nodes);
    assert_eq!(one.totals.drawn_triangles, other.totals.drawn_triangles);
    for axis in 0..3 {
        assert!((one.totals.bounds.min[axis] - other.totals.bounds.min[axis]).abs() < 1e-5);
        assert!((one.totals.bounds.max[axis] - other.totals.bounds.max[axis]).abs() < 1e-5);
    }
    for node in &one.nodes {
        let same =
            other.nodes.iter().find(|same| same.name == node.name).unwrap_or_else(|| panic!("{}", node.name));
        assert_eq!((&same.parent, &same.mesh), (&node.parent, &node.mesh), "{}", node.name);
        let off = node.matrix.iter().zip(same.matrix).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5, "{off} at {}", node.name);
    }
    // Twelve nodes of JSON are gone.
    assert!(other.file.bytes < one.file.bytes);
}

/// Drawing at once would lose something of these.
#[test]
fn what_cannot_be_drawn_at_once_stays_nodes() {
    let mirrored = RING.replace("scale = [\"= 1 + i / 20\", 1, 1]", "scale = [-1, 1, 1]");
    let body = format!("{RING}[collider.c]\nshape = \"post\"\n");
    let levels = format!("{RING}[lod]\nlevels = 3\n");
    let states = format!(
        "[parameters]\nh = 0.8\n{}[morph.post.high]\nwith = {{ h = 1.4 }}\n",
        RING.replace("[0, 0.8]", "[0, \"= h\"]")
    );
    let lines = RING
        .replace("[shape.post.revolve]\nprofile = {", "[shape.post.wire]\ncurves = [{")
        .replace("[0, 0.8]] } }\n", "[0, 0.8]] } }]\n");
    let single = RING.replace("count = 12", "count = 1");
    for text in [mirrored, body, levels, states, lines, single] {
        let text = text.replace("tolerance = 0.004\n[parameters]", "[parameters]");
        for file in baked(&text, &[Profile::Three, Profile::Babylon]) {
            assert!(!Glb::new(&file.bytes).json.to_string().contains(INSTANCES), "{text}");
        }
    }
}

/// What a clip moves moves its copies, whose joints keep their numbers.
#[test]
fn copies_go_where_their_node_goes() {
    let text = format!(
        "{RING}[skeleton.s.joint.low]\nhead = [0, 0, 0]\ntail = [0, 0.2, 0]\n[skin.k]\nshape = \"ball\"\nskeleton = \"s\"\nweights = \"rigid\"\n\
         [[clip.c.track]]\nnode = \"ring\"\npath = \"translation\"\nkeys = [{{ at = 0, value = [1, 0, 0] }}, {{ at = 1, value = [5, 0, 0] }}]\n\
         [[clip.c.track]]\njoint = \"low\"\npath = \"rotation\"\nkeys = [{{ at = 0, value = [0, 0, 0] }}, {{ at = 1, value = [0, 0, 40] }}]\n"
    )
    .replace("shape = \"ball\"\nparent = \"ring\"", "shape = \"ball\"");
    for file in baked(&text, &[Profile::Core, Profile::Three]) {
        let glb = Glb::new(&file.bytes);
        let name = |node: &Value| glb.list("nodes")[index(node)]["name"].as_str().expect("a name").to_owned();
        let channels = glb.list("animations")[0]["channels"].as_array().expect("channels");
        let mut moved: Vec<String> =
            channels.iter().map(|channel| name(&channel["target"]["node"])).collect();
        moved.sort();
        assert_eq!(moved, ["low", "ring"], "{:?}", file.profile);
        assert_eq!(name(&glb.list("skins")[0]["joints"][0]), "low");
        assert_eq!(glb.json.to_string().contains(INSTANCES), file.profile == Profile::Three);
    }
}

//! Parts of one material: one primitive, or one for each.

use kiln::Profile;
use kiln::compile::Compiled;
use serde_json::Value;

use super::glb::Glb;
use super::lods::files;

/// A cart of parts of two materials; a wheel four times, and a body that is a solid of two.
const CART: &str = "tolerance = 0.004
[shape.cart.group]
of = [\"bed\", \"wheels\", \"lamp\"]
[shape.bed]
material = \"wood\"
[shape.bed.union]
of = [\"floor\", \"back\"]
[shape.floor.box]
size = [2, 0.1, 1]
[shape.back]
at = [-0.9, 0.3, 0]
[shape.back.box]
size = [0.1, 0.8, 0.9]
[shape.wheels.array]
of = \"wheel\"
count = [2, 1, 2]
offset = [1.4, 0, 1.2]
[shape.wheel]
material = \"wood\"
at = [-0.7, -0.3, -0.6]
[shape.wheel.torus]
radius = 0.25
tube-radius = 0.05
[shape.lamp]
material = \"brass\"
at = [1.2, 0.3, 0]
[shape.lamp.sphere]
radius = 0.1
[material.wood]
color = \"#806040\"
[material.brass]
metallic = 1
[node.cart]
shape = \"cart\"
";

fn baked(more: &str, profiles: &[Profile]) -> Vec<Compiled> {
    files(&format!("{CART}{more}"), profiles)
}

fn primitives(glb: &Glb, mesh: usize) -> &[Value] {
    glb.list("meshes")[mesh]["primitives"].as_array().expect("primitives")
}

/// The part, material and count of indices of each primitive of a mesh.
fn parts(glb: &Glb, mesh: usize) -> Vec<(String, u64, u64)> {
    let of = |primitive: &Value| {
        let index = primitive["indices"].as_u64().and_then(|index| usize::try_from(index).ok());
        let accessor = &glb.list("accessors")[index.expect("indices")];
        (
            primitive["extras"]["part"].as_str().unwrap_or("").to_owned(),
            primitive["material"].as_u64().expect("a material"),
            accessor["count"].as_u64().expect("a count"),
        )
    };
    primitives(glb, mesh).iter().map(of).collect()
}

#[test]
fn parts_are_merged_by_material_or_kept_with_their_names() {
    let merged = baked("", &[Profile::Core]).remove(0);
    let (whole, report) = (Glb::new(&merged.bytes), merged.report.as_ref().expect("a report"));
    let one = parts(&whole, 0);
    assert_eq!(one.iter().map(|part| (part.0.as_str(), part.1)).collect::<Vec<_>>(), [("", 0), ("", 1)]);
    let kept = baked("[output]\nmerge = false\n", &[Profile::Core, Profile::Quantized, Profile::Web]);
    for file in &kept {
        let glb = Glb::new(&file.bytes);
        let own = parts(&glb, 0);
        let names: Vec<&str> = own.iter().map(|part| part.0.as_str()).collect();
        assert_eq!(
            names,
            ["floor", "back", "wheel", "wheel", "wheel", "wheel", "lamp"],
            "{:?}",
            file.profile
        );
        assert!(own.iter().all(|part| part.1 == u64::from(part.0 == "lamp")));
        let own_report = file.report.as_ref().expect("a report");
        assert_eq!(own_report.shapes["cart"].facts.closed, report.shapes["cart"].facts.closed);
        if file.profile == Profile::Core {
            let sum =
                |wanted: u64| own.iter().filter(|part| part.1 == wanted).map(|part| part.2).sum::<u64>();
            assert_eq!([sum(0), sum(1)], [one[0].2, one[1].2]);
            // Each wheel is the same wheel.
            assert!(own[2..6].iter().all(|part| part.2 == own[2].2));
        }
    }
}

/// A part stands in its own place: the box of its triangles is the part's.
#[test]
fn each_part_has_its_own_triangles() {
    let file = baked("[output]\nmerge = false\n", &[Profile::Core]).remove(0);
    let glb = Glb::new(&file.bytes);
    let mesh = glb.mesh(0);
    let mut start = 0;
    let mut boxes = Vec::new();
    for (name, _, count) in parts(&glb, 0) {
        let end = start + usize::try_from(count / 3).expect("it fits");
        let places = mesh.triangles[start..end].iter().flatten().map(|corner| mesh.positions[*corner]);
        let least =
            places.clone().fold([f64::MAX; 3], |a, b| [0, 1, 2].map(|axis| f64::min(a[axis], b[axis])));
        let most = places.fold([f64::MIN; 3], |a, b| [0, 1, 2].map(|axis| f64::max(a[axis], b[axis])));
        boxes.push((name, [0, 1, 2].map(|axis| least[axis].midpoint(most[axis])), most[0] - least[0]));
        start = end;
    }
    let wheels: Vec<_> = boxes.iter().filter(|one| one.0 == "wheel").collect();
    for (wheel, place) in wheels.iter().zip([[-0.7, -0.6], [0.7, -0.6], [-0.7, 0.6], [0.7, 0.6]]) {
        let off = (wheel.1[0] - place[0]).abs() + (wheel.1[1] + 0.3).abs() + (wheel.1[2] - place[1]).abs();
        assert!(off < 0.01 && (wheel.2 - 0.6).abs() < 0.01, "{wheel:?}");
    }
    let lamp = boxes.last().expect("there are parts");
    assert!((lamp.1[0] - 1.2).abs() < 1e-3 && (lamp.2 - 0.2).abs() < 0.01, "{lamp:?}");
}

#[test]
fn levels_have_the_parts_of_the_finest() {
    let file = baked("[output]\nmerge = false\n[lod]\nlevels = 3\n", &[Profile::Core]).remove(0);
    let report = file.report.as_ref().expect("a report");
    assert_eq!(report.lods["cart"].len(), 3);
    let glb = Glb::new(&file.bytes);
    let names = |mesh: usize| parts(&glb, mesh).into_iter().map(|part| part.0).collect::<Vec<_>>();
    for mesh in 1..3 {
        assert_eq!(names(mesh), names(0));
    }
}

#[test]
fn a_shape_shown_with_several_materials_is_a_mesh_for_each_measured_once() {
    let balls = "[shape.ball.sphere]
radius = 1
[material.gold]
metallic = 1
[material.red]
color = \"#ff0000\"
[node.plain]
shape = \"ball\"
[node.gold]
shape = \"ball\"
material = \"gold\"
at = [3, 0, 0]
[node.red]
shape = \"ball\"
material = \"red\"
at = [6, 0, 0]
[node.red-too]
shape = \"ball\"
material = \"red\"
at = [9, 0, 0]
[lod]
levels = 2
";
    let [made] = &files(balls, &[Profile::Core])[..] else { panic!("one file") };
    let glb = Glb::new(&made.bytes);
    let names: Vec<_> = glb.list("meshes").iter().map(|mesh| mesh["name"].clone()).collect();
    assert_eq!(names, ["ball", "ball.gold", "ball.red", "ball_LOD1", "ball.gold_LOD1", "ball.red_LOD1"]);
    let report = made.report.as_ref().expect("a report");
    let facts = |name: &str| &report.shapes[name];
    assert_eq!(facts("ball").meshes, ["ball", "ball.gold", "ball.red"]);
    assert_eq!(facts("ball_LOD1").meshes, ["ball_LOD1", "ball.gold_LOD1", "ball.red_LOD1"]);
    let totals = &report.totals;
    let each = |count: fn(&kiln::report::ShapeFacts) -> u64| {
        report.shapes.values().map(|own| 3 * count(own)).sum::<u64>()
    };
    assert_eq!(totals.triangles, each(|own| own.facts.triangles));
    assert_eq!(totals.vertices, each(|own| own.facts.vertices));
    assert_eq!((totals.meshes, totals.primitives), (6, 6));
}

//! Surfaces through curves: closed forms that they reach, references of other programs, and how patches join.

use core::f64::consts::PI;

use kiln::compile::Options;
use kiln::geometry::surface::{AnySurface, PatchContinuity, Surface, joints, measure};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;
use kiln::model::Recipe;
use serde_json::Value;

use super::{assert_near, bake};

/// A bilinear patch over four lines is the hyperbolic paraboloid z = x y on the unit square, whose area is the integral
/// of sqrt(1 + x^2 + y^2).
const SADDLE: &str = "[shape.a.coons]
sides = [
  { line = { from = [0, 0, 0], to = [1, 0, 0] } },
  { line = { from = [1, 0, 0], to = [1, 1, 1] } },
  { line = { from = [1, 1, 1], to = [0, 1, 0] } },
  { line = { from = [0, 1, 0], to = [0, 0, 0] } },
]";

/// One closed curve, cut into quarters: a flat disk.
const DISK: &str = "[shape.a.coons]\nsides = [{ circle = { radius = 2 } }]";

/// Three arcs of one circle: a flat disk again, with a pole at its corner.
const THREE: &str = "[shape.a.coons]
sides = [
  { arc = { radius = 1, from = 0, to = 120 } },
  { arc = { radius = 1, from = 120, to = 240 } },
  { arc = { radius = 1, from = 240, to = 360 } },
]";

/// Two half circles.
const TWO: &str = "[shape.a.coons]
sides = [{ arc = { radius = 1, from = 0, to = 180 } }, { arc = { radius = 1, from = 180, to = 360 } }]";

/// A barrel: closed rings as one family, straight staves as the other.
const BARREL: &str = "[shape.a.gordon]
u = [
  { transform = { of = { circle = { radius = 1 } }, rotate = [-90, 0, 0] } },
  { transform = { of = { transform = { of = { circle = { radius = 1 } }, rotate = [-90, 0, 0] } }, at = [0, 2, 0] } },
]
v = [
  { line = { from = [1, 0, 0], to = [1, 2, 0] } },
  { line = { from = [0, 0, -1], to = [0, 2, -1] } },
  { line = { from = [-1, 0, 0], to = [-1, 2, 0] } },
  { line = { from = [0, 0, 1], to = [0, 2, 1] } },
]";

fn surfaces(text: &str) -> Vec<AnySurface> {
    let files = MemoryFiles::new().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let model = kiln::compile::model(&document, &files, &Options::default());
    let model = model.unwrap_or_else(|found| panic!("{found}"));
    let patches = model.shapes.iter().filter_map(|shape| match &shape.recipe {
        Recipe::Patches { patches, .. } => Some(patches.surfaces.clone()),
        _ => None,
    });
    patches.flatten().collect()
}

fn saddle_area() -> f64 {
    let steps = 1000;
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
    let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (at(i), at(j))));
    all.map(|(x, y)| (1.0 + x * x + y * y).sqrt()).sum::<f64>() / f64::from(steps * steps)
}

#[test]
fn flat_and_ruled_patches_have_the_areas_of_school() {
    for (text, area) in [(SADDLE, saddle_area()), (DISK, 4.0 * PI), (THREE, PI), (TWO, PI)] {
        // The integral of the exact surface: midpoints of a thousand steps leave 1e-7.
        assert_near(measure(&surfaces(text)[0]).area, area, 1e-6);
        let baked = bake(&format!("tolerance = 1e-4\n{text}"));
        let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
        assert_near(facts.area, area, 2e-4);
        assert_eq!((facts.components, facts.boundary_loops), (1, 1), "{text}");
        assert_eq!(facts.degenerate_triangles, 0, "{text}");
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{text}: {deviation:?}");
        assert!(deviation.bound <= 1e-4, "{text}: {deviation:?}");
    }
}

#[test]
fn networks_around_closed_curves_have_no_seam() {
    let baked = bake(&format!("tolerance = 1e-3\n{BARREL}"));
    let facts = &baked.only().facts;
    assert_eq!((facts.components, facts.boundary_loops), (1, 2), "{facts:?}");
    assert!(facts.area > 2.0 * PI * 2.0 * 0.9, "{facts:?}");
}

/// Bilinear patches of the reference file: points, derivatives, normals and area.
#[test]
#[expect(clippy::print_stdout, reason = "a test that does not run must say so")]
fn bilinear_patches_agree_with_other_programs() {
    let Some(folder) = std::env::var_os("KILN_CASES") else {
        println!("KILN_CASES is not set: 2 Coons patches not tried");
        return;
    };
    let path = std::path::Path::new(&folder).join("surfaces/surfaces.json.gz");
    let bytes = std::fs::read(path).expect("the cases are there");
    let cases: Value = serde_json::from_reader(flate2::read::GzDecoder::new(bytes.as_slice())).expect("JSON");
    let mut tried = 0;
    for case in
        cases["cases"].as_array().expect("a list").iter().filter(|case| case["kind"] == "coons_bilinear")
    {
        let curve = |name: &str| {
            let points = case[name].as_array().unwrap_or_else(|| panic!("{name} of {case}"));
            format!("{{ bezier = {{ degree = {}, points = {} }} }}", points.len() - 1, case[name])
        };
        // Around: along u at v = 0, along v at u = 1, along u at v = 1, along v at u = 0.
        let sides = ["c_v0", "d_u1", "c_v1", "d_u0"].map(curve).join(", ");
        let surface = &surfaces(&format!("[shape.a.coons]\nsides = [{sides}]"))[0];
        for sample in case["samples"].as_array().expect("samples") {
            let number = |key: &str| sample[key].as_f64().expect("a number");
            let vector = |key: &str| {
                let part = |k: usize| sample[key][k].as_f64().expect("a number");
                glam::DVec3::new(part(0), part(1), part(2))
            };
            let jet = surface.evaluate(number("u"), number("v"));
            for (found, key) in [(jet.point, "p"), (jet.du, "du"), (jet.dv, "dv")] {
                let expected = vector(key);
                let near = found.distance(expected) <= 1e-9 * expected.length().max(1.0);
                assert!(near, "{key} of {sample}: {found}");
            }
            tried += 1;
        }
        if let Some(area) = case["area"].as_f64() {
            assert_near(measure(surface).area, area, 1e-7);
        }
    }
    assert!(tried >= 40, "{tried}");
}

/// Sides of equal curves are one line, whichever way they run: two patches of one skin, tested through the joints.
#[test]
fn derivatives_across_a_common_side_make_it_smooth() {
    let side = |cross: &str| {
        format!("{{ curve = {{ line = {{ from = [0, 0, 0], to = [0, 0, 1] }} }}, cross = {cross} }}")
    };
    let curve = |x: f64, z: f64| {
        format!(
            "{{ bezier = {{ points = [[0, 0, {z}], [{}, 0, {z}], [{}, 1, {z}], [{x}, 1, {z}]] }} }}",
            x / 3.0,
            x / 1.5
        )
    };
    let end = |x: f64| format!("{{ line = {{ from = [{x}, 1, 0], to = [{x}, 1, 1] }} }}");
    let patch = |name: &str, x: f64| {
        let lines = [side(&format!("[{x}, 0, 0]")), curve(x, 1.0), end(x), curve(x, 0.0)].join(", ");
        format!("[shape.{name}.coons]\nblend = 'bicubic'\nsides = [{lines}]\n")
    };
    let both = surfaces(&format!("{}{}", patch("a", 1.0), patch("b", -1.0)));
    let found = joints(&both);
    let [joint] = found.joints.as_slice() else { panic!("{found:?}") };
    assert!(joint.smoothness.holds(PatchContinuity::G1, 1e-6), "{joint:?}");
    assert!(joint.smoothness.holds(PatchContinuity::C1, 1e-6), "{joint:?}");
    assert_eq!((found.open.len(), found.collapsed.len()), (6, 0));
}

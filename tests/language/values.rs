//! What a document means: the typed values that the next stage gets.

use glam::DVec3;
use kiln::language::source::MemoryFiles;
use kiln::language::spec::{
    Arc, Curve, CurveReference, Demand, Expected, Frame, Parameters, Shape, Smoothing, Unit, Up, Uv,
};
use kiln::language::{Document, Spec};

fn spec_of(text: &str, variant: Option<&str>, overrides: &[(&str, &str)]) -> Spec {
    let files = MemoryFiles::new().with("models/main.toml", text);
    let overrides: Vec<_> = overrides.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
    let document = Document::load("models/main.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    document.spec(variant, &overrides).unwrap_or_else(|found| panic!("{found}")).0
}

fn spec(text: &str) -> Spec {
    spec_of(text, None, &[])
}

fn radius(spec: &Spec) -> f64 {
    match &spec.shapes["a"].value.kind {
        Shape::Sphere(sphere) => sphere.radius.value,
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_not_written_has_its_default() {
    let spec = spec("[shape.a.revolve]\nprofile = { circle = { radius = 1, center = [2, 0] } }");
    assert_eq!((spec.unit, spec.up), (Unit::Metre, Up::Y));
    assert!(spec.tolerance.is_none() && spec.asserts.is_empty() && spec.nodes.is_empty());
    assert_eq!((spec.limits.triangles, spec.limits.memory, spec.limits.recursion), (50_000_000, 8 << 30, 64));
    let shape = &spec.shapes["a"].value;
    let options = &shape.options;
    assert_eq!((options.smoothing.value, options.uv.value), (Smoothing::Auto, Uv::Auto));
    assert_eq!(
        (options.crease_angle.value, options.scale.value.0, options.at.value),
        (30.0, DVec3::ONE, DVec3::ZERO)
    );
    assert!(options.crease_angle.span.is_none());
    let Shape::Revolve(revolve) = &shape.kind else { panic!("{shape:?}") };
    assert_eq!((revolve.angle.value, revolve.start.value, revolve.caps.value), (360.0, 0.0, true));
    assert!(matches!(&revolve.profile, CurveReference::Inline(_)));
    let Some(Curve::Circle(circle)) = spec.curve(&revolve.profile) else { panic!("{revolve:?}") };
    assert_eq!((circle.radius.value, circle.center.position.x), (1.0, 2.0));
}

#[test]
fn what_is_written_is_read() {
    let spec = spec(
        include_str!("cases/whole.case")
            .split("=== ")
            .nth(2)
            .and_then(|case| case.split_once('\n'))
            .unwrap()
            .1,
    );
    assert_eq!((spec.unit.metres(), spec.up), (0.01, Up::Z));
    assert_eq!(spec.curves.keys().take(3).collect::<Vec<_>>(), ["a", "b", "c"], "the order of the text");
    let Curve::Arc(Arc::Center(arc)) = &spec.curves["e"].value else { panic!("an arc") };
    assert_eq!((arc.from.value, arc.to.value), (0.0, -90.0));
    let Curve::NaturalSpline(spline) = &spec.curves["g2"].value else { panic!("a spline") };
    assert_eq!((&spline.parameters.value, spline.closed.value), (&Parameters::Centripetal, true));
    let Shape::Sweep(sweep) = &spec.shapes["sweep"].value.kind else { panic!("a sweep") };
    assert_eq!((sweep.frame.value, sweep.twist.value), (Frame::RotationMinimizing, 90.0));
    let Shape::Import(import) = &spec.shapes["import"].value.kind else { panic!("an import") };
    assert_eq!(
        (import.file.resolved.as_str(), import.file.extension().as_str()),
        ("models/models/cage.obj", "obj")
    );
    assert_eq!(import.materials["Wood.001"].0, "clay");
    let clay = &spec.materials["clay"].value;
    assert_eq!(clay.color.linear, [1.0, 0.5, 0.25, 0.5]);
    assert_eq!(clay.emissive.unwrap().linear, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!((spec.limits.memory, spec.limits.steps), (512 << 20, 100_000));
    let paths: Vec<_> = spec.asserts.iter().map(|one| one.path.as_str()).collect();
    assert_eq!(paths, ["triangles", "shapes.box.closed", "shapes.box.area", "volume", "name"]);
    assert_eq!(spec.asserts[1].demand, Demand::Equals(Expected::Boolean(true)));
    let equals = Demand::Bounds { at_most: None, at_least: None, equals: Some(1.0), tolerance: 0.1 };
    assert_eq!(spec.asserts[3].demand, equals);
    assert_eq!(spec.nodes["leaf"].value.parent.as_ref().unwrap().0, "root");
}

#[test]
fn colors_on_screen_become_linear() {
    let spec = spec("[material.a]\ncolor = \"#ff8000\"\n[material.b]\ncolor = \"#0A0a0a80\"");
    let a = spec.materials["a"].value.color.linear;
    // IEC 61966-2-1: 128/255 is 0.21586 of the light of white.
    assert!(
        (a[0] - 1.0).abs() < 1e-15 && (a[1] - 0.215_860_500).abs() < 1e-9 && a[2] == 0.0 && a[3] == 1.0,
        "{a:?}"
    );
    let b = spec.materials["b"].value.color.linear;
    assert!((b[0] - 10.0 / 255.0 / 12.92).abs() < 1e-15 && (b[3] - 128.0 / 255.0).abs() < 1e-15, "{b:?}");
}

#[test]
fn roots_are_the_shapes_that_nothing_uses() {
    let text = "[shape.a.sphere]\nradius = 1\n[shape.b.copy]\nof = \"a\"\n[shape.c.group]\nof = [{ copy = { of = \"d\" } }]\n\
                [shape.d.sphere]\nradius = 1\n[shape.e.sphere]\nradius = 1";
    assert_eq!(spec(text).roots, ["b", "c", "e"]);
}

#[test]
fn overrides_win_over_variants_and_variants_over_the_base() {
    let text = "[parameters]\nr = 1\ns = \"= r * 10\"\n[shape.a.sphere]\nradius = \"= s\"\n[variant.v.parameters]\nr = 2";
    assert_eq!(radius(&spec_of(text, None, &[])), 10.0);
    assert_eq!(radius(&spec_of(text, Some("v"), &[])), 20.0);
    assert_eq!(radius(&spec_of(text, Some("v"), &[("r", "3")])), 30.0);
    assert_eq!(radius(&spec_of(text, Some("v"), &[("r", "= 1 + 3")])), 40.0);
    assert_eq!(radius(&spec_of(text, Some("v"), &[("s", "1e-3")])), 0.001);
    let words = "[parameters]\nname = \"x\"\n[asset]\nname = \"= name + '!'\"";
    let named = spec_of(words, None, &[("name", "1 = one")]);
    assert_eq!(named.asset.name.unwrap().value, "1 = one!");
}

#[test]
fn expressions_have_the_values_of_school() {
    for (expression, value) in [
        ("1 + 2 * 3 - 4 / 8", 6.5),
        ("2 ^ 3 ^ 2", 512.0),
        ("(2 ^ 3) ^ 2", 64.0),
        ("10 - 3 - 2", 5.0),
        ("100 / 5 / 2", 10.0),
        ("9 - -2 ^ 2", 13.0),
        ("-7 % 3", 2.0),
        ("7 % -3 + 9", 7.0),
        ("1_000 + 1.5e2", 1150.0),
        ("sin(30) * 2 + cos(180) + 1", 1.0),
        ("atan2(1, 1) + acos(0.5)", 105.0),
        ("if(1 < 2 and not (2 == 3) or false, 4, 5)", 4.0),
        ("if('a' + 'b' == 'ab', 1, 2)", 1.0),
        ("if([1, 2] == [1, 2], 1, 2)", 1.0),
        ("mix(2, 4, 0.25)", 2.5),
        ("clamp(7, 1, 3) + clamp(-7, 1, 3)", 4.0),
        ("smoothstep(0, 2, 1) + smoothstep(0, 1, 9)", 1.5),
        ("length([3, 4]) + length([1, 2, 2])", 8.0),
        ("(p + [1, 1, 1] * 2).y", 4.0),
        ("mix(p, [3, 4, 5], 0.5).z", 4.0),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("floor(-1.5) + ceil(-1.5) + round(2.5) + 4", 4.0),
        ("abs(-3) + sign(-3) + sign(0)", 2.0),
        ("exp(ln(5))", 5.0),
    ] {
        let text =
            format!("[parameters]\np = [1, 2, 3]\n[shape.a.sphere]\nradius = \"= {expression} + 0 * p.x\"");
        let found = radius(&spec(&text));
        assert!((found - value).abs() <= 1e-14 * value, "{expression} is {found}");
    }
}

#[test]
fn generators_count_from_zero() {
    let spec = spec("[curve.a.polyline]\npoints = { count = 5, each = \"= [i, i * i]\" }");
    let Curve::Polyline(line) = &spec.curves["a"].value else { panic!("a polyline") };
    let points: Vec<_> = line.points.iter().map(|point| point.xy().to_array()).collect();
    assert_eq!(points, [[0.0, 0.0], [1.0, 1.0], [2.0, 4.0], [3.0, 9.0], [4.0, 16.0]]);
}

#[test]
fn places_of_values_lead_to_their_text() {
    let text = "[shape.a.sphere]\nradius = \"= 1 + 1\"\n";
    let files = MemoryFiles::new().with("main.toml", text);
    let document = Document::load("main.toml", &files).unwrap();
    let (spec, _) = document.spec(None, &[]).unwrap();
    let Shape::Sphere(sphere) = &spec.shapes["a"].value.kind else { panic!("a sphere") };
    assert_eq!(document.sources().snippet(sphere.radius.span), "\"= 1 + 1\"");
    assert_eq!(document.sources().snippet(spec.shapes["a"].name.span), "a");
}

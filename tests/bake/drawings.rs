//! SVG paths and curves of several parts, as solids and lines.

use core::f64::consts::PI;

use super::{assert_near, bake};

/// Two rings, a block in a hole of the other: areas by hand.
const RINGS: &str = "M0 0H10V10H0Z M2 2V8H8V2Z M4 4H6V6H4Z M20 0H30V10H20Z M22 2H28V8H22Z";

fn sheet(d: &str, fill: &str) -> super::Baked {
    bake(&format!("[shape.a.sheet]\nfill = \"{fill}\"\nprofile = {{ svg = {{ d = \"{d}\" }} }}"))
}

#[test]
fn fill_rules_fill_what_browsers_fill() {
    let even_odd = sheet(RINGS, "even-odd");
    assert_near(even_odd.only().facts.area, 64.0 + 4.0 + 64.0, 1e-6);
    assert_eq!((even_odd.only().facts.components, even_odd.only().facts.boundary_loops), (3, 5));
    // The second ring's inner outline turns like the outer one: no hole there.
    let nonzero = sheet(RINGS, "nonzero");
    assert_near(nonzero.only().facts.area, 64.0 + 4.0 + 100.0, 1e-6);
}

#[test]
fn solids_of_parts_are_closed_each() {
    let baked = bake(&format!(
        "tolerance = 0.001\n[shape.a.extrude]\nheight = 0.5\nprofile = {{ svg = {{ d = \"{RINGS}\" }} }}\n\
         holes = [{{ circle = {{ radius = 0.5, center = [5, -5] }} }}, {{ circle = {{ radius = 0.5, center = [1, -1] }} }}]"
    ));
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold);
    assert_eq!(facts.components, 3);
    let area = 132.0 - PI / 2.0;
    assert!((facts.volume.expect("closed") - area / 2.0).abs() <= 2.0 * PI * 0.001);
    // y points down in a drawing.
    let bounds = facts.bounds.expect("there are points");
    assert_eq!((bounds.min, bounds.max), ([0.0, -10.0, 0.0], [30.0, 0.0, 0.5]));
}

#[test]
fn arcs_follow_the_implementation_notes() {
    // A disk of two half circles; radii too small for their ends are stretched; signs of radii do not count.
    for arc in ["3 3 0 1 0", "3 3 0 0 0", "1 1 30 0 0", "-3 3 45 0 0"] {
        let d = format!("M0 0A{arc} 6 0A{arc} 0 0Z");
        let facts = &sheet(&d, "nonzero").only().facts.clone();
        assert!((facts.area - 9.0 * PI).abs() < 0.2, "{arc}: {}", facts.area);
        let bounds = facts.bounds.expect("there are points");
        assert!(
            (bounds.max[1] - 3.0).abs() < 0.01 && (bounds.min[1] + 3.0).abs() < 0.01,
            "{arc}: {bounds:?}"
        );
    }
    // Two thirds and a third of a circle of radius 2 over a chord of 2 sqrt 3, above and below.
    let chord = 2.0 * 3.0_f64.sqrt();
    let segment = 4.0 * PI / 3.0 - 3.0_f64.sqrt();
    for (flags, area, above) in [
        ("1 1", 4.0 * PI - segment, true),
        ("1 0", 4.0 * PI - segment, false),
        ("0 1", segment, true),
        ("0 0", segment, false),
    ] {
        let d = format!("M0 0A2 2 0 {flags} {chord} 0Z");
        let baked =
            bake(&format!("tolerance = 0.0001\n[shape.a.sheet]\nprofile = {{ svg = {{ d = \"{d}\" }} }}"));
        let facts = &baked.only().facts;
        assert!((facts.area - area).abs() < 4.0 * PI * 1e-4, "{flags}: {} instead of {area}", facts.area);
        let bounds = facts.bounds.expect("there are points");
        assert_eq!(bounds.max[1] > 0.9, above, "{flags}: {bounds:?}");
    }
}

#[test]
fn scale_origin_and_y_up_place_a_drawing() {
    let baked = bake(
        "[shape.a.sheet]\nprofile = { svg = { d = \"M10 10h4v2h-4z\", scale = 0.5, origin = [10, 10], y-up = true } }",
    );
    let bounds = baked.only().facts.bounds.expect("there are points");
    assert_eq!((bounds.min, bounds.max), ([0.0, 0.0, 0.0], [2.0, 1.0, 0.0]));
}

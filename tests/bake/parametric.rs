//! Surfaces by formulas: closed forms of area and volume, how they close, poles and kinks, and how few triangles they need.

use core::f64::consts::PI;

use kiln::compile::Options;
use kiln::geometry::number::{cos, sin};
use kiln::report::facts::MeshFacts;

use super::accuracy::exponent;
use super::{assert_near, bake, compile};

const SPHERE: &str = "[shape.a.parametric]\nx = '= sin(v) * sin(u)'\ny = '= cos(v)'\nz = '= sin(v) * cos(u)'\n\
    u = [0, 360]\nv = [0, 180]\nclosed = ['u']";
const ELLIPSOID: &str = "[shape.a.parametric]\nx = '= 2 * cos(v) * sin(u)'\ny = '= sin(v)'\nz = '= 1.5 * cos(v) * cos(u)'\n\
    u = [0, 360]\nv = [-90, 90]\nclosed = ['u']";
const TORUS: &str = "[shape.a.parametric]\nx = '= (1 + 0.3 * cos(v)) * sin(u)'\ny = '= 0.3 * sin(v)'\nz = '= (1 + 0.3 * cos(v)) * cos(u)'\n\
    u = [0, 360]\nv = [0, 360]\nclosed = ['u', 'v']";
const MOEBIUS: &str = "[shape.a.parametric]\nx = '= (2 + v * cos(u / 2)) * cos(u)'\ny = '= v * sin(u / 2)'\nz = '= (2 + v * cos(u / 2)) * sin(u)'\n\
    u = [0, 360]\nv = [-0.5, 0.5]\nclosed = ['u']";
/// The Klein bottle in the form of an eight that is turned by half a turn on its way around.
const KLEIN: &str = "[shape.a.parametric]\n\
    x = '= (3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * cos(u)'\n\
    y = '= sin(u / 2) * sin(v) + cos(u / 2) * sin(2 * v)'\n\
    z = '= (3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * sin(u)'\n\
    u = [0, 360]\nv = [-180, 180]\nclosed = ['u', 'v']";

fn facts(text: &str) -> MeshFacts {
    let compiled = compile(text, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    compiled.report.expect("a report was asked for").shapes[0].facts.clone()
}

#[test]
fn area_and_volume_converge_with_the_tolerance() {
    let torus = (4.0 * PI * PI * 0.3, 2.0 * PI * PI * 0.09);
    for (text, area, volume) in [
        (SPHERE, Some(4.0 * PI), 4.0 * PI / 3.0),
        (ELLIPSOID, None, 4.0 * PI),
        (TORUS, Some(torus.0), torus.1),
    ] {
        let (mut areas, mut volumes) = (Vec::new(), Vec::new());
        for k in 0..=5 {
            // Down to a thousandth.
            let tolerance = if k == 5 { 1e-4 } else { 1e-1 / f64::from(1 << (2 * k)) };
            let facts = facts(&format!("tolerance = {tolerance}\n{text}"));
            assert!(facts.manifold && facts.closed, "{text}");
            areas.extend(area.map(|area| (tolerance, (facts.area - area).abs())));
            volumes.push((tolerance, (facts.volume.expect("closed") - volume).abs()));
        }
        assert!(areas.is_empty() || exponent(&areas) >= 0.9, "{text}: area {}: {areas:?}", exponent(&areas));
        assert!(exponent(&volumes) >= 0.9, "{text}: volume {}: {volumes:?}", exponent(&volumes));
    }
}

/// The optimum: the integral of sqrt |K| over the surface, by twice the tolerance.
#[test]
fn doubly_curved_surfaces_need_few_triangles() {
    let steps = 2000;
    let angle = |k: u32, span: f64| span * (f64::from(k) + 0.5) / f64::from(steps);
    let torus: f64 = (0..steps)
        .map(|k| {
            let cosine = cos(angle(k, 2.0 * PI));
            (cosine.abs() * 0.3 * (1.0 + 0.3 * cosine)).sqrt() * 2.0 * PI / f64::from(steps)
        })
        .sum::<f64>()
        * 2.0
        * PI;
    // On an ellipsoid with half axes a, b, c: K = 1 / (a b c)^2 / (x^2 / a^4 + y^2 / b^4 + z^2 / c^4)^2, and dA is a b c times
    // the root of that sum times dA of the unit sphere. So sqrt K dA is that of the sphere by the root of the sum.
    let ellipsoid: f64 = (0..steps)
        .map(|i| {
            let v = angle(i, PI);
            let ring: f64 = (0..steps)
                .map(|j| {
                    let u = angle(j, 2.0 * PI);
                    let (x, y, z) = (sin(v) * sin(u) / 2.0, cos(v), sin(v) * cos(u) / 1.5);
                    1.0 / (x * x + y * y + z * z).sqrt()
                })
                .sum();
            ring * sin(v) * 2.0 * PI * PI / f64::from(steps) / f64::from(steps)
        })
        .sum();
    for (text, integral) in [(SPHERE, 4.0 * PI), (TORUS, torus), (ELLIPSOID, ellipsoid)] {
        for tolerance in [2e-3, 5e-4] {
            let optimum = integral / (2.0 * tolerance);
            let ratio = facts(&format!("tolerance = {tolerance}\n{text}")).triangles as f64 / optimum;
            assert!(ratio <= 1.5, "{text} at {tolerance}: {ratio:.3} of the optimum");
            assert!(ratio >= 0.8, "{text} at {tolerance}: fewer than can be, {ratio:.3}");
        }
    }
}

#[test]
fn bounds_hold_and_simple_ones_are_proved() {
    for text in [SPHERE, ELLIPSOID, TORUS, MOEBIUS, KLEIN] {
        let baked = bake(&format!("tolerance = 0.01\n{text}"));
        let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{text}: {deviation:?}");
        assert!(deviation.bound <= 0.01, "{text}: {deviation:?}");
        assert_eq!(facts.degenerate_triangles, 0, "{text}");
    }
    // Where second derivatives are constant intervals tell all of them.
    let bowl = "tolerance = 1e-3\n[shape.a.parametric]\nx = '= u'\ny = '= 0.3 * (u ^ 2 + v ^ 2)'\nz = '= v'\nu = [-1, 1]\nv = [-1, 1]";
    let said = serde_json::to_value(bake(bowl).only().deviation).expect("plain data");
    assert_eq!(said["kind"], "proved", "{said}");
}

/// Both poles are one point each, and their normals are the axis.
#[test]
fn poles_have_the_normals_of_the_limit() {
    let baked = bake(&format!("tolerance = 0.01\n{SPHERE}"));
    let facts = &baked.only().facts;
    assert_eq!((facts.euler, facts.genus, facts.boundary_edges), (2, Some(0), 0));
    let mesh = baked.glb.named("a");
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let along: f64 = (0..3).map(|k| position[k] * normal[k]).sum();
        assert!((along - 1.0).abs() < 1e-5, "{position:?} {normal:?}");
    }
}

#[test]
fn twisted_surfaces_close_and_have_one_side() {
    let band = bake(&format!("tolerance = 0.01\n{MOEBIUS}"));
    let facts = &band.only().facts;
    // One rim, and along the seam triangles turn against each other: no way of turning them helps.
    assert_eq!((facts.boundary_loops, facts.euler, facts.components), (1, 0, 1), "{facts:?}");
    assert!(facts.misoriented_edges > 0 && !facts.manifold && !facts.closed, "{facts:?}");
    let bottle = bake(&format!("tolerance = 0.02\n{KLEIN}"));
    let facts = &bottle.only().facts;
    assert_eq!((facts.boundary_edges, facts.components), (0, 1), "{facts:?}");
    assert!(facts.misoriented_edges > 0 && facts.crowded_edges == 0, "{facts:?}");
}

/// The skin of a Moebius band is a ring: inside of it a solid of its area times its thickness (a theorem of tubes: what
/// bending adds on one side it takes on the other, but for the third power of the thickness).
#[test]
fn a_thick_moebius_band_is_a_closed_ring() {
    let sheet = facts(&format!("tolerance = 1e-4\n{MOEBIUS}"));
    let baked = bake(&format!("tolerance = 1e-3\n{MOEBIUS}\nthickness = 0.1"));
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(facts.closed && facts.manifold, "{facts:?}");
    assert_eq!((facts.genus, facts.components, facts.degenerate_triangles), (Some(1), 1, 0));
    assert_near(facts.volume.expect("closed"), sheet.area * 0.1, 3e-3);
    assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
    // Its one rim is left of the edges that are sharp: vertices are doubled there and nowhere else.
    assert!(facts.vertices > facts.points && facts.vertices < facts.points * 3 / 2, "{facts:?}");
}

#[test]
fn a_thick_sphere_is_two_spheres_and_a_thick_sheet_has_four_walls() {
    let facts = facts(&format!("tolerance = 1e-3\n{SPHERE}\nthickness = 0.2"));
    assert_eq!((facts.components, facts.boundary_edges, facts.manifold), (2, 0, true), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 4.0 * PI / 3.0 * (1.331 - 0.729), 5e-3);
    let flat = "[shape.a.parametric]\nx = '= u'\ny = 0\nz = '= v'\nu = [0, 2]\nv = [0, 3]\nthickness = 0.5";
    let baked = bake(flat);
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold, "{facts:?}");
    assert_eq!((facts.triangles, facts.points), (12, 8));
    assert_near(facts.volume.expect("closed"), 3.0, 1e-6);
}

/// Lines where a formula of one variable turns are edges of the mesh, at their exact places.
#[test]
fn kinks_become_edges() {
    let roof =
        "[shape.a.parametric]\nx = '= u'\ny = '= 1 - abs(v - 1 / 3)'\nz = '= v'\nu = [0, 3]\nv = [-1, 1]";
    let baked = bake(roof);
    let facts = &baked.only().facts;
    assert_eq!((facts.triangles, facts.points), (4, 6), "{facts:?}");
    assert_near(facts.area, 3.0 * 2.0 * 2.0_f64.sqrt(), 1e-6);
    // A ridge is sharp: its points have a normal for each side.
    assert_eq!(facts.vertices, 8);
    // Gutters of `%` and steps of `clamp`, which are kinks at places that no lattice meets.
    let zigzag = "[shape.a.parametric]\nx = '= u'\ny = '= abs(u % 0.7 - 0.35) + clamp(v, 0.1, 0.35)'\nz = '= v'\nu = [0, 2.1]\nv = [0, 1]";
    let facts = bake(zigzag).only().facts.clone();
    assert_eq!((facts.triangles, facts.points), (2 * 6 * 3, 7 * 4), "{facts:?}");
}

/// A kink that runs askew is no line of the parameters: triangles close in on it until it is within the tolerance.
#[test]
fn kinks_askew_are_within_the_tolerance() {
    let text = "tolerance = 0.005\n[shape.a.parametric]\nx = '= u'\ny = '= 0.4 * abs(u - 0.6 * v)'\nz = '= v'\nu = [-1, 1]\nv = [-1, 1]";
    let baked = bake(text);
    let deviation = baked.only().deviation;
    assert!(deviation.measured.expect("asked for") <= 0.005, "{deviation:?}");
    assert!(deviation.bound <= 0.005, "{deviation:?}");
}

/// Roots are upright where they begin: a half sphere over its square root, and a cone by a bare length.
#[test]
fn infinite_slopes_at_the_rim_are_kept_within_the_tolerance() {
    let dome = "tolerance = 0.004\n[shape.a.parametric]\nx = '= v * cos(u)'\ny = '= sqrt(1 - v ^ 2)'\nz = '= -v * sin(u)'\nu = [0, 360]\nv = [0, 1]\nclosed = ['u']";
    let baked = bake(dome);
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(deviation.measured.expect("asked for") <= 0.004, "{deviation:?}");
    assert_near(facts.area, 2.0 * PI, 0.02);
    assert_eq!((facts.boundary_loops, facts.degenerate_triangles), (1, 0), "{facts:?}");
}

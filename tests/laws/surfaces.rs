//! Laws of surfaces.

use glam::DVec3;
use kiln::geometry::curve::{AnyCurve, Domain};
use kiln::geometry::surface::{Carry, ExtrudedSurface, FrameRule, RevolvedSurface, Surface, SweptWall};
use kiln::geometry::tessellate::Sweep;
use std::sync::Arc;

use super::{Dice, curves};

fn curve(name: &str) -> AnyCurve {
    curves()
        .into_iter()
        .find(|(known, _)| known == name)
        .map(|(_, curve)| curve)
        .expect("a curve of the list")
}

fn swept(profile: AnyCurve, path: AnyCurve, carry: &Carry) -> SweptWall {
    let surface = Arc::new(Sweep::plain(profile, path, *carry).surface());
    SweptWall { surface, outline: 0 }
}

/// How exactly the tangents of a kind of surface are known.
struct Subject {
    name: String,
    surface: Box<dyn Surface>,
    /// Share of a tangent's length.
    exactness: f64,
}

fn surfaces() -> Vec<Subject> {
    let mut all = Vec::new();
    for profile in ["circle", "arc", "smooth", "rounded", "line"] {
        let flat = |name: &str| match curve(name) {
            // Profiles lie in the plane.
            AnyCurve::Polyline(_) => curve("clockwise"),
            other => other,
        };
        // A profile that crosses the axis turns no surface.
        let turned = if profile == "arc" { &[][..] } else { &[(0.0, 360.0), (-30.0, 75.0)] };
        for &(start, angle) in turned {
            let surface = RevolvedSurface { profile: flat(profile), start, angle };
            let name = format!("{profile} turned by {angle}");
            all.push(Subject { name, surface: Box::new(surface), exactness: 1e-6 });
        }
        let surface = ExtrudedSurface { profile: flat(profile), bottom: -0.5, height: 2.5 };
        all.push(Subject { name: format!("{profile} pushed"), surface: Box::new(surface), exactness: 1e-6 });
    }
    // The section is thinner than every bend is wide, so the surface does not fold.
    for path in ["line", "helix", "cone", "chordal", "ring", "high", "ellipse", "polyline", "mixed"] {
        for twist in [0.0, 200.0] {
            let up = DVec3::new(0.1, 0.2, 1.0);
            for (rule_name, rule) in [
                ("", FrameRule::RotationMinimizing),
                (" by Frenet", FrameRule::Frenet),
                (" upright", FrameRule::Up(up)),
            ] {
                let surface = swept(curve("wire"), curve(path), &Carry { rule, twist });
                let name = format!("an arc along {path}{rule_name}, twisted by {twist}");
                // Frames are those of the exact field to about 1e-9 at each end of a step.
                all.push(Subject { name, surface: Box::new(surface), exactness: 1e-5 });
            }
        }
    }
    all
}

fn inside(domain: Domain, dice: &mut Dice) -> (f64, f64) {
    (domain.at(dice.between(0.01, 0.99)), 1e-5 * domain.span())
}

#[test]
fn tangents_are_the_limits_of_differences() {
    let mut dice = Dice::new(11);
    for Subject { name, surface, exactness } in surfaces() {
        let mut tried = 0;
        for _ in 0..80 {
            let ((u, du), (v, dv)) =
                (inside(surface.domain_u(), &mut dice), inside(surface.domain_v(), &mut dice));
            let at = |u: f64, v: f64| surface.evaluate(u, v);
            let here = at(u, v);
            let differences = (
                (at(u + du, v).point - at(u - du, v).point) / (2.0 * du),
                (at(u, v + dv).point - at(u, v - dv).point) / (2.0 * dv),
            );
            // Across a joint of a profile or path a difference means nothing.
            let jumps = at(u + du, v).du.distance(at(u - du, v).du) > 1e-2 * here.du.length()
                || at(u, v + dv).dv.distance(at(u, v - dv).dv) > 1e-2 * here.dv.length();
            if jumps {
                continue;
            }
            tried += 1;
            let (u_scale, v_scale) = (here.du.length() + 1e-6, here.dv.length() + 1e-6);
            assert!(differences.0.distance(here.du) <= 1e-6 * u_scale, "{name} by u at {u} {v}");
            assert!(
                differences.1.distance(here.dv) <= exactness * v_scale,
                "{name} by v at {u} {v}: {} for {}",
                here.dv,
                differences.1
            );
        }
        assert!(tried >= 70, "{name}: only {tried} places are smooth");
    }
}

#[test]
fn normals_are_unit_perpendicular_and_to_the_right_hand() {
    let mut dice = Dice::new(12);
    for Subject { name, surface, .. } in surfaces() {
        for _ in 0..80 {
            let ((u, _), (v, _)) =
                (inside(surface.domain_u(), &mut dice), inside(surface.domain_v(), &mut dice));
            let jet = surface.evaluate(u, v);
            assert!((jet.normal.length() - 1.0).abs() < 1e-12, "{name} at {u} {v}");
            for tangent in [jet.du, jet.dv] {
                assert!(jet.normal.dot(tangent).abs() <= 1e-9 * tangent.length(), "{name} at {u} {v}");
            }
            let cross = jet.du.cross(jet.dv);
            assert!(jet.normal.dot(cross) >= 0.999 * cross.length(), "{name} at {u} {v}");
        }
    }
}

#[test]
fn closed_surfaces_have_no_seam() {
    let mut dice = Dice::new(13);
    for Subject { name, surface, .. } in surfaces() {
        let turned = name.contains("turned by 360");
        let around = name.contains("along ring") || name.contains("along ellipse");
        for _ in 0..20 {
            let (u, v) = (surface.domain_u(), surface.domain_v());
            let (one, other) = if turned {
                let v = v.at(dice.between(0.0, 1.0));
                (surface.evaluate(u.start, v), surface.evaluate(u.end, v))
            } else if around && name.ends_with("by 0") {
                let u = u.at(dice.between(0.0, 1.0));
                (surface.evaluate(u, v.start), surface.evaluate(u, v.end))
            } else {
                break;
            };
            assert!(one.point.distance(other.point) < 1e-9, "{name}");
            // Frenet frames turn with the torsion, which jumps where the third derivative does.
            assert!(name.contains("Frenet") || one.normal.distance(other.normal) < 1e-6, "{name}");
        }
    }
}

#[test]
fn parameters_outside_the_domain_are_its_ends() {
    for Subject { name, surface, .. } in surfaces() {
        let (u, v) = (surface.domain_u(), surface.domain_v());
        for (outside, inside) in [
            ((u.start - 1.0, v.at(0.4)), (u.start, v.at(0.4))),
            ((u.end + 1.0, v.at(0.4)), (u.end, v.at(0.4))),
            ((u.at(0.4), v.start - 1.0), (u.at(0.4), v.start)),
            ((u.at(0.4), v.end + 1.0), (u.at(0.4), v.end)),
        ] {
            let (one, other) = (surface.evaluate(outside.0, outside.1), surface.evaluate(inside.0, inside.1));
            assert!(one.point.distance(other.point) < 1e-12, "{name} at {outside:?}");
            assert!(one.normal.distance(other.normal) < 1e-9, "{name} at {outside:?}");
        }
    }
}

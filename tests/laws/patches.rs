//! Laws of the surfaces that are cut into triangles by bounds on their second derivatives.

use glam::DVec3;
use kiln::compile::{self, Options};
use kiln::geometry::curve::Side;
use kiln::geometry::surface::{AnySurface, Surface as _};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;
use kiln::model::Recipe;

use super::Dice;

const SURFACES: &str = r#"
[curve]
wave.bezier = { points = [[0, 0, 0], [1, 2, 0], [2, -2, 0], [3, 0, 0]] }
bow.bezier = { degree = 2, points = [[0, 0, 0], [0, 0.3, 1], [0.5, 1, 2]] }
ring.circle = { radius = 1 }
oval.ellipse = { radii = [0.5, 0.8] }
blob.natural-spline = { points = [[1, 0], [0.2, 1.2], [-0.8, 0.4], [-0.3, -0.9]], closed = true }
square.polyline = { points = [[1, -1], [1, 1], [-1, 1], [-1, -1]], closed = true }
star.polyline = { points = [[2, 0], [0.5, 0.5], [0, 2], [-0.5, 0.5], [-2, 0], [0, -2]], closed = true }
[shape.saddle.ruled]
from = { line = { from = [0, 0, 0], to = [1, 0, 1] } }
to = { line = { from = [0, 1, 1], to = [1, 1, 0] } }
[shape.waving.ruled]
from = "wave"
to = { transform = { of = "bow", at = [0, 0, 3] } }
[shape.moved.translational]
profile = "wave"
path = "bow"
[shape.linear.loft]
across = "linear"
profiles = ["ring", { curve = "oval", at = [0, 0, 1] }, { curve = "square", at = [0.2, 0, 2] }]
[shape.natural.loft]
profiles = ["ring", { curve = "blob", at = [0, 0, 1] }, { curve = "star", at = [0.2, 0, 2] }, { curve = "oval", rotate = [20, 0, 0], at = [0, 0, 3.5] }]
[shape.parabolic.loft]
start = "not-a-knot"
end = "not-a-knot"
matching = "parameter"
profiles = ["ring", { curve = "oval", at = [0, 0, 1] }, { curve = "oval", scale = 2, at = [0, 0.4, 2] }, { curve = "ring", at = [0, 0, 3] }]
[shape.egg.loft]
start = "round"
end = "round"
profiles = [[0, 0, -1], { curve = "blob", scale = 1.3 }, [0, 0.1, 1.6]]
[shape.led.loft]
start = { first = [0.5, 0, 1] }
end = "straight"
profiles = ["ring", { curve = "oval", at = [0, 0, 1] }, { curve = "ring", scale = 0.5, rotate = [0, 30, 0], at = [0.5, 0, 3] }]
[shape.two.loft]
start = "straight"
profiles = ["wave", { curve = "bow", at = [0, 0, 3] }]
[shape.around.loft]
closed = true
profiles = [{ curve = "oval", at = [3, 0, 0] }, { curve = "ring", rotate = [0, -90, 0], at = [0, 0, 3] }, { curve = "oval", rotate = [0, 180, 0], at = [-3, 0, 0] }, { curve = "blob", rotate = [0, 90, 0], at = [0, 0, -3] }]
[shape.polygonal.loft]
closed = true
across = "linear"
profiles = [{ curve = "oval", at = [3, 0, 0] }, { curve = "ring", rotate = [0, -90, 0], at = [0, 0, 3] }, { curve = "oval", rotate = [0, 180, 0], at = [-3, 0, 0] }]
"#;

fn surfaces() -> Vec<(String, AnySurface)> {
    let files = MemoryFiles::new().with("laws.toml", SURFACES.as_bytes());
    let document = Document::load("laws.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let model =
        compile::model(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let surface = |shape: &kiln::model::Shape| match &shape.recipe {
        Recipe::Patches { patches, .. } => (shape.name.clone(), patches.surfaces[0].clone()),
        other => panic!("{other:?}"),
    };
    model.shapes.iter().map(surface).collect()
}

/// The stretches between joints.
fn pieces(start: f64, joints: Vec<f64>, end: f64) -> Vec<(f64, f64)> {
    let mut stops = vec![start];
    stops.extend(joints);
    stops.push(end);
    assert!(stops.windows(2).all(|pair| pair[0] < pair[1]), "joints do not increase: {stops:?}");
    stops.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// A rectangle inside one piece, of a size from a thousandth of it to half of it.
fn rectangle(surface: &AnySurface, dice: &mut Dice) -> ((f64, f64), (f64, f64)) {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let mut part = |pieces: Vec<(f64, f64)>| {
        let (start, end) = pieces[dice.roll(pieces.len())];
        let size = (end - start) * 0.5 * dice.between(0.1, 1.0) * dice.between(0.02, 1.0);
        let low = dice.between(start, end - size);
        (low, low + size)
    };
    (part(pieces(u.start, surface.joints_u(), u.end)), part(pieces(v.start, surface.joints_v(), v.end)))
}

const AFTER: Side = Side::After;

/// Where second derivatives jump (the weights of a spline, the knots of profiles) a difference means nothing.
#[test]
fn derivatives_are_the_limits_of_differences() {
    let mut dice = Dice::new(21);
    for (name, surface) in surfaces() {
        let mut tried = 0;
        for _ in 0..60 {
            let (u, v) = rectangle(&surface, &mut dice);
            let (u, v) = ((u.0 + u.1) / 2.0, (v.0 + v.1) / 2.0);
            let at = |u: f64, v: f64| surface.sided((u, AFTER), (v, AFTER));
            let bend = |u: f64, v: f64| surface.second((u, AFTER), (v, AFTER));
            let h = 1e-5;
            let (left, right, below, above) = (at(u - h, v), at(u + h, v), at(u, v - h), at(u, v + h));
            let (here, second) = (at(u, v), bend(u, v));
            let size = second.uu.length() + second.uv.length() + second.vv.length();
            let scale = here.du.length() + here.dv.length() + size;
            let jumps = bend(u - h, v).uu.distance(bend(u + h, v).uu) > 1e-2 * scale
                || bend(u, v - h).vv.distance(bend(u, v + h).vv) > 1e-2 * scale;
            if jumps {
                continue;
            }
            tried += 1;
            let rate = |a: DVec3, b: DVec3| (b - a) / (2.0 * h);
            for (what, found, expected, share) in [
                ("du", here.du, rate(left.point, right.point), 1e-7),
                ("dv", here.dv, rate(below.point, above.point), 1e-7),
                ("duu", second.uu, rate(left.du, right.du), 1e-2),
                ("duv", second.uv, rate(below.du, above.du), 1e-2),
                ("dvu", second.uv, rate(left.dv, right.dv), 1e-2),
                ("dvv", second.vv, rate(below.dv, above.dv), 1e-2),
            ] {
                let away = found.distance(expected);
                assert!(away <= share * scale, "{what} of {name} at {u} {v}: {found} {expected}");
            }
        }
        assert!(tried >= 50, "{name}: {tried}");
    }
}

#[test]
fn second_derivatives_lie_in_their_ranges_and_the_ranges_close_in() {
    let mut dice = Dice::new(22);
    for (name, surface) in surfaces() {
        for _ in 0..60 {
            let (u, v) = rectangle(&surface, &mut dice);
            let range = surface.second_range(u, v).expect("all of these know theirs");
            let mut size = 0.0_f64;
            for _ in 0..40 {
                let place = (dice.between(u.0, u.1), dice.between(v.0, v.1));
                let second = surface.second((place.0, AFTER), (place.1, AFTER));
                let jet = surface.sided((place.0, AFTER), (place.1, AFTER));
                size = size.max(jet.du.length() + jet.dv.length());
                for (found, range) in
                    [second.uu, second.uv, second.vv].into_iter().zip([range.uu, range.uv, range.vv])
                {
                    let rounding = 1e-9 * (found.length() + size + 1.0);
                    let inside =
                        found.cmpge(range.min - rounding).all() && found.cmple(range.max + rounding).all();
                    assert!(inside, "{name} at {place:?}: {found} outside {range:?}");
                    size = size.max(found.length());
                }
            }
            // Bounds that do not close in would be proofs of nothing.
            let less = |(low, high): (f64, f64)| (low, low + (high - low) / 16.0);
            let closer = surface.second_range(less(u), less(v)).expect("all of these know theirs");
            for range in [closer.uu, closer.uv, closer.vv] {
                let step = ((u.1 - u.0).max(v.1 - v.0)) / 16.0;
                let wide = (range.max - range.min).length();
                assert!(wide <= 100.0 * step * size + 1e-9, "{name} {u:?} {v:?}: {range:?} for {size}");
            }
        }
    }
}

/// At its knots a loft is its profiles, at the parameters that it gives them.
/// What is asked for together is what is asked for one by one.
#[test]
fn lattices_are_their_places() {
    let mut dice = Dice::new(23);
    for (name, surface) in surfaces() {
        let cells: Vec<_> = (0..5).map(|_| rectangle(&surface, &mut dice)).collect();
        let (u, v): (Vec<_>, Vec<_>) = cells.into_iter().unzip();
        let low = |intervals: &[(f64, f64)]| -> Vec<(f64, Side)> {
            intervals.iter().map(|(low, _)| (*low, AFTER)).collect()
        };
        let jets = surface.lattice(&low(&u), &low(&v));
        let ranges = surface.second_ranges(&u, &v).unwrap();
        assert_eq!((jets.len(), ranges.len()), (25, 25), "{name}");
        for (row, v) in v.iter().enumerate() {
            for (column, u) in u.iter().enumerate() {
                let number = 5 * row + column;
                assert_eq!(jets[number], surface.sided((u.0, AFTER), (v.0, AFTER)), "{name}");
                assert_eq!(Some(ranges[number]), surface.second_range(*u, *v), "{name}");
            }
        }
    }
}

#[test]
fn lofts_go_through_their_profiles() {
    use kiln::geometry::curve::Curve as _;
    let mut tried = 0;
    for (name, surface) in surfaces() {
        let AnySurface::Lofted(loft) = &surface else { continue };
        for curve in loft.curves() {
            let at = |u: f64, v: f64| surface.evaluate(u, v).point;
            // The knot is where one point of it is met, and then all are.
            let target = curve.point(0.317);
            let steps: u32 = 4000;
            let mut best = (f64::INFINITY, 0.0);
            for k in 0..=steps {
                let v = f64::from(k) / f64::from(steps);
                let away = at(0.317, v).distance(target);
                if away < best.0 {
                    best = (away, v);
                }
            }
            let (mut low, mut high) = (best.1 - 1.0 / f64::from(steps), best.1 + 1.0 / f64::from(steps));
            for _ in 0..100 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if at(0.317, a).distance(target) < at(0.317, b).distance(target) {
                    high = b;
                } else {
                    low = a;
                }
            }
            for u in [0.0, 0.1, 0.25, 0.5, 0.77, 1.0] {
                let away = at(u, (low + high) / 2.0).distance(curve.point(u));
                assert!(away < 1e-6, "{name} at {u}: {away}");
            }
            tried += 1;
        }
    }
    assert!(tried > 25, "{tried}");
}

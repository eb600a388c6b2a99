//! Laws that hold for every curve and every surface, whatever its kind: reusable, seeded, stated once.

mod curves;
mod deformations;
mod equations;
mod patches;
mod surfaces;

use kiln::compile::{self, Options};
use kiln::geometry::curve::AnyCurve;
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

/// Numbers that are the same in every run (xorshift, G. Marsaglia, 2003).
#[derive(Clone, Copy)]
pub(crate) struct Dice(u64);

impl Dice {
    /// Numbers that depend on `seed` alone.
    pub(crate) fn new(seed: u64) -> Self {
        let mut dice = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..8 {
            dice.bits();
        }
        dice
    }

    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number from `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// A whole number below `sides`.
    pub(crate) fn roll(&mut self, sides: usize) -> usize {
        usize::try_from(self.bits() % sides as u64).unwrap_or(0)
    }
}

/// One of each kind of curve, plane and in space, open and closed, with and without corners, nested too.
const CURVES: &str = r#"
line.line = { from = [1, 2, 3], to = [-4, 0.5, 1] }
polyline.polyline = { points = [[0, 0], [2, 0.5], [3, 3], [1, 1, 2]] }
polygon.polyline = { points = [[0, 0], [2, 0.5], [3, 3], [1, 2]], closed = true }
straight.polyline = { points = [[0, 0], [1, 0], [2, 0], [2, 1]] }
circle.circle = { radius = 1.5, center = [3, -1] }
ellipse.ellipse = { radii = [3, 0.4], center = [0.5, 2] }
arc.arc = { center = [1, 1], radius = 2, from = 30, to = 250 }
clockwise.arc = { center = [1, 1], radius = 0.01, from = 10, to = -100 }
wire.arc = { center = [0.02, 0.01], radius = 0.04, from = 10, to = -100 }
three.arc = { points = [[0, 0, 0], [1, 2, 1], [3, 0, -1]] }
helix.helix = { radius = 1, pitch = 0.3, turns = 2.3 }
cone.helix = { radius = 1, end-radius = 0.2, pitch = -0.7, turns = 1.7 }
uniform.natural-spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2], [-4, -3]], parameters = "uniform" }
chordal.natural-spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2], [-4, -3]] }
given.natural-spline = { points = [[0, 0], [3, 4, 1], [-1, 4]], parameters = [-1, 0.25, 7] }
ring.natural-spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2]], closed = true, parameters = "centripetal" }
two.natural-spline = { points = [[0, 0], [3, 4, 1]] }
cubic.bezier = { points = [[0, 0], [1, 2, 1], [3, -1, 0], [4, 1, 1], [5, 3, 1], [5, 4], [6, 2]] }
smooth.bezier = { degree = 2, points = [[0, 0], [1, 1], [2, 0], [3, -1], [4, 0]] }
high.bezier = { degree = 9, points = [[0, 0], [1, 3], [2, -3], [3, 4], [4, -1], [5, 0], [6, 1], [7, 1], [8, 0], [9, 2, 1]] }
stopped.bezier = { points = [[0, 0], [0, 0], [3, 1], [4, 4]] }
quartic.b-spline = { degree = 4, points = [[5, 10], [15, 25], [30, 30], [45, 5], [55, 5], [70, 40], [60, 60, 5], [35, 60], [20, 40]] }
loose.b-spline = { points = [[0, 0], [1, 2], [3, 1, 1], [4, 0], [5, 2]], knots = "uniform" }
uneven.b-spline = { points = [[0, 0], [1, 2], [3, 1, 1], [4, 0], [5, 2], [6, 0], [7, 1]], degree = 2, knots = [-1, -1, 0, 0.5, 2, 2, 3, 7, 7, 9] }
tripled.b-spline = { points = [[0, 0], [1, 2], [3, 1], [3, 1], [3, 1], [5, 2], [6, 0]] }
bloop.b-spline = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5], [0.7, 2.2], [-0.6, 1.4]], closed = true }
bring.b-spline = { points = [[0, 0], [2, -0.5], [3, 1, 1]], closed = true, degree = 4, knots = [0, 0.5, 0.75, 3] }
cusp.bezier = { points = [[0, 0], [1, 1], [0, 1], [1, 0]] }
turning.bezier = { points = [[0, 0], [2, 4], [1, 2]], degree = 2 }
four.nurbs = { points = [[1, 0], [0, 1], [-1, 0], [0, -1]], weights = [1, 0, 1, 0], degree = 2, closed = true, knots = [0, 1, 1, 2, 2] }
nine.nurbs = { points = [[0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1], [1, 0], [1, -1], [0, -1]], degree = 2, knots = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1], weights = [1, 0.707, 1, 0.707, 1, 0.707, 1, 0.707, 1] }
heavy.nurbs = { points = [[0, 0], [1, 2], [3, 1, 1], [4, 0], [5, 2], [6, 1], [7, 3]], weights = [1, 10, 0.1, 3, 0, 2, 1] }
conic.bezier = { points = [[1, 0], [1, 1, 0.5], [0, 1]], degree = 2, weights = [1, 0.3, 2] }
rcusp.bezier = { points = [[0, 0], [1, 1], [0, 1], [1, 0]], weights = [1, 1, 1, 1] }
nielsen.spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2], [-4, -3]], parameters = "nielsen", ends = "not-a-knot" }
clamped.spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2], [-4, -3]], start = { first = [0, 1, 2] }, end = { second = [0.5, 0.1, 0] } }
resting.spline = { points = [[0, 0], [3, 4, 1], [-1, 4]], ends = "clamped" }
nring.spline = { points = [[0, 0], [3, 4, 1], [-1, 4], [-4, 0, 2]], closed = true, parameters = "nielsen" }
table.function-spline = { points = [[0, 1], [0.5, 2], [2, 0.5], [2.5, 0.25]], start = { first = -1 }, end = "not-a-knot" }
period.function-spline = { points = [[0, 1], [0.5, 2], [2, 0.5], [2.5, 1]], periodic = true }
ferguson.hermite = { points = [[0, 0], [1, 2], [3, 1, 1]], tangents = [[2, 0], [1, 1, 1], [0, -2, 1]] }
fring.hermite = { points = [[0, 0], [1, 2], [3, 1, 1]], tangents = [[2, 0], [1, 1, 1], [0, -2, 1]], closed = true, parameters = "chordal" }
rhermite.hermite = { points = [[0, 0], [1, 2], [3, 1, 1]], tangents = [[2, 0], [1, 1, 1], [0, -2, 1]], weights = [1, 3, 0.5], weight-rates = [2, -3, 0.5] }
catmull.catmull-rom = { points = [[5, 10], [15, 25], [30, 30], [45, 5, 3], [55, 5], [70, 40]] }
chordalrom.catmull-rom = { points = [[5, 10], [15, 25], [30, 30], [45, 5, 3], [55, 5], [70, 40]], alpha = "chordal", ends = "guides" }
romring.catmull-rom = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5], [0.7, 2.2], [-0.6, 1.4]], alpha = 0.3, closed = true }
quad.catmull-rom = { points = [[0, 0], [2, -0.5], [3, 1]], alpha = "uniform", ends = "quadratic" }
tight.cardinal = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], tension = 0.5, ends = "reflect" }
straightened.cardinal = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], tension = 1 }
loosering.cardinal = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], scale = 0.7, closed = true }
kochanek.kochanek-bartels = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], tension = [0, 0.5, -0.5, 0], continuity = [0, 0, -0.7, 0], bias = 0.3, ends = "duplicate" }
kring.kochanek-bartels = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], continuity = 0.5, parameters = "centripetal", closed = true }
beta.beta-spline = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], bias = 2, tension = 5 }
betaring.beta-spline = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], bias = 0.5, tension = 1, closed = true }
powers.cubic = { coefficients = [[[0, 0], [1, 0], [0, 0], [0, 1]], [[1, 1], [1, 3], [0, 0], [0, 0.5, 1]]] }
window.cubic = { basis = [[-0.5, 1.5, -1.5, 0.5], [1, -2.5, 2, -0.5], [-0.5, 0, 0.5, 0], [0, 1, 0, 0]], points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5], [0.7, 2.2]], closed = true }
pairs.cubic = { basis = "hermite", points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5], [2, -0.5], [4, 4], [1, -3], [1, 1]] }
corners.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "chaikin" }
chaikin.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5]], scheme = "chaikin", closed = true }
cutter.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "chaikin", ends = "cut", levels = 2 }
three-p.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "three-point" }
three-r.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "three-point", closed = true }
fourpoint.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "four-point" }
fourpoint-r.subdivision = { points = [[0, 0], [2, -0.5], [3, 1], [2.2, 2.5, 1]], scheme = "four-point", tension = 0.05, closed = true }
mixed.path = { start = [0, 0], segments = [
  { line = [[1, 0], [2, 1], [2, 2]] }, { arc = { through = [1.5, 3], to = [1, 2.5] } },
  { natural-spline = [[0, 2], [-1, 1], [-1, 0.5]] }, { quadratic = [[-1, 0], [-0.5, 0]] },
  { bezier = [[0, -1], [1, -1], [1, 0], [2, 2], [3, 1], [3, -1]] }, { arc = { center = [3, -2], angle = -77 } } ] }
drawn.path = { start = [0, 0], segments = [
  { catmull-rom = [[1, 0], [2, 1], [2, 2]] }, { b-spline = [[2, 3], [1, 3], [0, 2], [0, 4]] }, { b-spline = [[1, 5], [2, 5]] },
  { b-spline = [[3, 5]] } ] }
rounded.path = { start = [1, 0], closed = true, segments = [
  { line = [[3, 0]] }, { arc = { center = [3, 1], angle = 90 } }, { line = [[4, 2]] },
  { arc = { center = [3, 2], angle = 90 } }, { line = [[2.3, 3], [1.7, 3], [1, 3]] } ] }
back.reverse = { of = "mixed" }
again.reverse = { of = { reverse = { of = "mixed" } } }
moved.transform = { of = "mixed", scale = 0.37, rotate = [10, 20, 70], at = [5, 5, 5] }
squeezed.transform = { of = "back", scale = [3, 0.2, 1], rotate = [0, 0, 33] }
"#;

/// The curves of the list, each with its name.
pub(crate) fn curves() -> Vec<(String, AnyCurve)> {
    let text = format!("[shape.a.sphere]\nradius = 1\n[curve]\n{CURVES}{}", equations::CURVES);
    let text = joined(&text);
    let files = MemoryFiles::new().with("laws.toml", text.as_bytes());
    let document = Document::load("laws.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let (spec, _) = document.spec(None, &[]).unwrap_or_else(|found| panic!("{found}"));
    let curve = |name: &String| {
        let curve = compile::curve(&document, &files, &Options::default(), name);
        let curve = curve.unwrap_or_else(|found| panic!("{found}")).expect("it is defined");
        (name.clone(), curve)
    };
    spec.curves.keys().map(curve).collect()
}

/// TOML 1.0 keeps an inline table on one line; the list above does not.
fn joined(text: &str) -> String {
    let mut joined = String::new();
    for line in text.lines() {
        if !line.starts_with("  ") {
            joined.push('\n');
        }
        joined.push_str(line);
    }
    joined
}

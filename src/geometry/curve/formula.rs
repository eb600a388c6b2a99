//! Curves given by formulas.
//!
//! The bound on a chord is proved by interval arithmetic on the derivatives of the formula (R. Moore,
//! R. Kearfott, M. Cloud, Introduction to Interval Analysis, 2009, ch. 6): what lies across the chord vanishes
//! at both ends, so it is at most h^2 / 8 times its second derivative, and h / 4 times the width of its first.

use glam::DVec3;

use super::chord::{Chord, joined};
use super::study::{Break, breaks, derivatives, point};
use super::{Curve, Domain, FormulaFault, Jet, Side};
use crate::geometry::formula::{Algebra, Binary, Formula, Interval, Jet as Slopes};
use crate::geometry::number::Bounds;

/// The points (x(t), y(t), z(t)) of a formula of one variable.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaCurve {
    formula: Formula,
    domain: Domain,
    breaks: Vec<Break>,
    joints: Vec<f64>,
    closed: bool,
}

impl FormulaCurve {
    /// The curve of a formula with one variable and three results, for t from `from` to `to`, which is greater.
    /// Studies the formula first, see [`FormulaFault`].
    ///
    /// # Errors
    /// When the formula has no value, jumps, stands still or changes too often.
    pub fn new(formula: Formula, from: f64, to: f64) -> Result<Self, FormulaFault> {
        let breaks = breaks(&formula, from, to)?;
        let domain = Domain { start: from, end: to };
        let mut curve = Self { formula, domain, breaks, joints: Vec::new(), closed: false };
        let points: Vec<DVec3> =
            (0..=64).map(|k| point(&curve.formula, domain.at(f64::from(k) / 64.0))).collect();
        let size = points.iter().map(|place| place.distance(points[0])).fold(0.0, f64::max);
        if size == 0.0 {
            return Err(FormulaFault::Still { from, to });
        }
        // Formulas that return do so but for rounding.
        curve.closed = points[0].distance(points[64]) <= 1e-12 * size;
        let inner = curve.breaks.iter().map(|one| one.t).filter(|t| *t > from && *t < to);
        curve.joints = inner.filter(|t| curve.turns(*t)).collect();
        Ok(curve)
    }

    /// Whether the direction jumps.
    fn turns(&self, t: f64) -> bool {
        // What is found of a direction beside a kink differs by less than this where there is none.
        const SAME_DIRECTION: f64 = 1e-6;
        let (before, after) = (self.direction(t, Side::Before), self.direction(t, Side::After));
        before.cross(after).length() > SAME_DIRECTION || before.dot(after) < 0.0
    }

    /// The break at a parameter, or the one so near that the formula is not known to be smooth there.
    fn near(&self, t: f64) -> Option<&Break> {
        let index = self.breaks.partition_point(|one| one.after <= t && one.t < t);
        self.breaks.get(index).filter(|one| one.t == t || (one.before < t && t < one.after))
    }

    /// Where derivatives are taken for a parameter: beside a break, on the named side of it.
    fn beside(&self, t: f64, side: Side) -> f64 {
        match self.near(t) {
            Some(one) if !one.still || one.t == t => {
                let before = if one.t == t { side == Side::Before } else { t < one.t };
                let there = if before { one.before } else { one.after };
                // At the ends of the domain there is only one side.
                if there <= self.domain.start {
                    one.after
                } else if there >= self.domain.end {
                    one.before
                } else {
                    there
                }
            }
            _ => t,
        }
    }

    /// Ends of the parts between two parameters over each of which the formula is smooth, or which are too
    /// short to be known.
    fn stops(&self, from: f64, to: f64) -> Vec<(f64, bool)> {
        let mut stops = vec![(from, true)];
        for one in self.breaks.iter().filter(|one| !one.still && one.after > from && one.before < to) {
            let (start, end) = (one.before.max(from), one.after.min(to));
            if start > stops[stops.len() - 1].0 {
                stops.push((start, true));
            }
            if end > start {
                stops.push((end, false));
            }
        }
        if to > stops[stops.len() - 1].0 {
            stops.push((to, true));
        }
        stops
    }

    fn place(&self, t: f64) -> DVec3 {
        let t = if self.closed && t == self.domain.end { self.domain.start } else { t };
        point(&self.formula, t)
    }

    /// A box that holds a derivative between two parameters, where it is finite.
    fn range(&self, from: f64, to: f64, order: fn(&Slopes<Interval, 1>) -> Interval) -> Option<Bounds> {
        let (from, to) = (self.beside(from, Side::After), self.beside(to, Side::Before));
        let jets: [Slopes<Interval, 1>; 3] =
            self.formula.jets_over([Interval::new(from.min(to), from.max(to))]);
        let sides = jets.map(|jet| order(&jet));
        let end = |part: fn(&Interval) -> f64| DVec3::from_array(sides.map(|side| part(&side)));
        let finite = sides.iter().all(Interval::is_finite);
        finite.then(|| Bounds { min: end(|side| side.low), max: end(|side| side.high) })
    }

    /// Bound for a part over which the formula is smooth.
    fn smooth_deviation(&self, from: f64, to: f64) -> f64 {
        let chord = Chord::new(self.place(from), self.place(to));
        let sampled = (1..8)
            .map(|k| chord.distance(point(&self.formula, from + (to - from) * f64::from(k) / 8.0)))
            .fold(0.0, f64::max);
        let mut bound = f64::INFINITY;
        // Bounds over shorter parts are tighter; where that gains little it is not worth the time.
        for parts in [1, 4, 16] {
            bound = bound.min(self.bound(&chord, (from, to), parts));
            if bound <= 1.1 * sampled {
                break;
            }
        }
        bound
    }

    fn bound(&self, chord: &Chord, (from, to): (f64, f64), parts: u32) -> f64 {
        let span = to - from;
        let at = |k: u32| if k == parts { to } else { from + span * f64::from(k) / f64::from(parts) };
        let mut all = Spread::default();
        for k in 0..parts {
            let jets: [Slopes<Interval, 1>; 3] = self.formula.jets_over([Interval::new(at(k), at(k + 1))]);
            all.add(chord, &jets);
        }
        all.deviation(span)
    }
}

/// What the derivatives of a curve can be, along and across a chord.
#[derive(Default)]
struct Spread {
    /// Position, first and second derivative, along the normals of the chord.
    across: Option<[[Interval; 2]; 3]>,
    /// The same along all axes.
    full: Option<[[Interval; 3]; 3]>,
    /// The first derivative along the chord.
    along: Option<Interval>,
}

impl Spread {
    fn add(&mut self, chord: &Chord, jets: &[Slopes<Interval, 1>; 3]) {
        let start = chord.start.to_array();
        let moved = core::array::from_fn(|axis| {
            Interval::binary(Binary::Subtract, jets[axis].value, Interval::constant(start[axis]))
        });
        let full = [moved, jets.map(|jet| jet.first[0]), jets.map(|jet| jet.second[0][0])];
        let along = dot(full[1], chord.direction);
        // By the axes of the chord: taking the share along it off again would count every coordinate twice.
        let across = full.map(|vector| chord.normals.map(|normal| dot(vector, normal)));
        self.full = Some(widened(self.full, full));
        self.across = Some(widened(self.across, across));
        self.along = Some(self.along.map_or(along, |known| known.hull(along)));
    }

    /// The least of the bounds by position, first and second derivative over a parameter span.
    fn deviation(&self, span: f64) -> f64 {
        let (Some(across), Some(full), Some(along)) = (self.across, self.full, self.along) else {
            return 0.0;
        };
        // A curve that never turns back along its chord covers it with the feet of its points. What it may turn
        // back by rounding alone is added.
        let turned = -along.low.min(0.0);
        let onward = along.size() > 0.0 && turned <= 1e-9 * along.size();
        let second = if onward { size(across[2]) } else { size(full[2]) };
        let width = if onward { width(across[1]) } else { width(full[1]) };
        // In full the box of the part holds the chord too; its diagonal is no less than any distance in it.
        let place = if onward {
            size(across[0])
        } else {
            self::width(full[0].map(|side| side.hull(Interval::constant(0.0))))
        };
        let back = if onward { turned * span } else { 0.0 };
        let bounds = [second * span * span / 8.0, width * span / 4.0, place];
        bounds.into_iter().filter(|bound| !bound.is_nan()).fold(f64::INFINITY, f64::min) + back
    }
}

fn widened<const M: usize>(
    known: Option<[[Interval; M]; 3]>,
    more: [[Interval; M]; 3],
) -> [[Interval; M]; 3] {
    let Some(known) = known else { return more };
    core::array::from_fn(|order| core::array::from_fn(|axis| known[order][axis].hull(more[order][axis])))
}

fn dot(vector: [Interval; 3], direction: DVec3) -> Interval {
    let direction = direction.to_array();
    let product =
        |axis: usize| Interval::binary(Binary::Multiply, vector[axis], Interval::constant(direction[axis]));
    let sum = Interval::binary(Binary::Add, product(0), product(1));
    Interval::binary(Binary::Add, sum, product(2))
}

/// The greatest length of the vectors in a box.
fn size<const M: usize>(vector: [Interval; M]) -> f64 {
    vector.iter().map(|side| side.size() * side.size()).sum::<f64>().sqrt()
}

/// The diagonal of a box.
fn width<const M: usize>(vector: [Interval; M]) -> f64 {
    vector.iter().map(|side| side.width() * side.width()).sum::<f64>().sqrt()
}

impl Curve for FormulaCurve {
    fn domain(&self) -> Domain {
        self.domain
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let t = t.clamp(self.domain.start, self.domain.end);
        let [place, first, second] = derivatives(&self.formula, self.beside(t, side));
        let inner = self.beside(t, side);
        let place = if inner == t && !(self.closed && t == self.domain.end) { place } else { self.place(t) };
        // A second derivative that is infinite in one point is taken a little further inside.
        let second = if second.is_finite() {
            second
        } else {
            let step = 1e-7 * self.domain.span();
            let inward = if t + step > self.domain.end { -step } else { step };
            let near = derivatives(&self.formula, inner + inward)[2];
            if near.is_finite() { near } else { DVec3::ZERO }
        };
        Jet { point: place, first, second }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.clone()
    }

    fn breaks(&self) -> Vec<f64> {
        let Domain { start, end } = self.domain;
        self.breaks.iter().map(|one| one.t).filter(|t| *t > start && *t < end).collect()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let (from, to) = (from.max(self.domain.start), to.min(self.domain.end));
        let stops = self.stops(from, to);
        let chord = Chord::new(self.place(from), self.place(to));
        let parts = stops.windows(2).map(|pair| {
            let ((start, _), (end, smooth)) = (pair[0], pair[1]);
            let own = if smooth {
                self.smooth_deviation(start, end)
            } else {
                self.bound(&Chord::new(self.place(start), self.place(end)), (start, end), 1)
            };
            (self.place(end), own)
        });
        joined(&chord, parts)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        self.range(from, to, |jet| jet.second[0][0])
    }

    fn first_range(&self, from: f64, to: f64) -> Option<Bounds> {
        self.range(from, to, |jet| jet.first[0])
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let t = t.clamp(self.domain.start, self.domain.end);
        if let Some(one) = self.near(t).filter(|one| one.still && one.t == t) {
            // The speed is lost in rounding here; the way to where it is known shows the direction.
            let (start, end) = match side {
                Side::Before if one.before > self.domain.start || one.t > one.before => (one.before, one.t),
                _ => (one.t, one.after),
            };
            return (self.place(end) - self.place(start)).normalize_or(DVec3::X);
        }
        let jet = self.evaluate(t, side);
        if jet.first.length() > 0.0 {
            return jet.first.normalize();
        }
        let step = 1e-6 * self.domain.span();
        let (start, end) = match side {
            Side::Before => (t - step, t),
            Side::After => (t, t + step),
        };
        let clamp = |t: f64| t.clamp(self.domain.start, self.domain.end);
        (self.place(clamp(end)) - self.place(clamp(start))).normalize_or(DVec3::X)
    }
}

#[cfg(test)]
mod tests {
    use super::FormulaCurve;
    use crate::geometry::curve::{Curve, FormulaFault, Side, length};
    use crate::geometry::formula::{Binary, Builder, Formula, Operation, Slot, Unary};

    /// (t, f(t), 0).
    fn graph(function: impl Fn(&mut Builder, Slot) -> Slot) -> Formula {
        let mut builder = Builder::new();
        let t = builder.push(Operation::Variable(0));
        let y = function(&mut builder, t);
        let z = builder.constant(0.0);
        builder.finish(1, vec![t, y, z])
    }

    #[test]
    fn kinks_become_joints_at_their_places() {
        let formula = graph(|builder, t| {
            let third = builder.constant(1.0 / 3.0);
            let moved = builder.binary(Binary::Subtract, t, third);
            builder.unary(Unary::Abs, moved)
        });
        let curve = FormulaCurve::new(formula, -1.0, 1.0).unwrap();
        assert_eq!(curve.joints().len(), 1);
        let joint = curve.joints()[0];
        assert!((joint - 1.0 / 3.0).abs() < 1e-12);
        assert!(
            curve.evaluate(joint, Side::Before).first.y == -1.0
                && curve.evaluate(joint, Side::After).first.y == 1.0
        );
        assert!(curve.chord_deviation(joint, 1.0) < 1e-9 && curve.chord_deviation(-1.0, joint) < 1e-9);
        // At a place that halving meets exactly.
        let formula = graph(|builder, t| builder.unary(Unary::Abs, t));
        assert_eq!(FormulaCurve::new(formula, -1.0, 1.0).unwrap().joints(), [0.0]);
        // The root of a square is as sharp, though nothing in it changes its way.
        let formula = graph(|builder, t| {
            let square = builder.push(Operation::Power(t, 2.0));
            builder.unary(Unary::Sqrt, square)
        });
        let joints = FormulaCurve::new(formula, -1.0, 2.0).unwrap().joints();
        assert!(joints.len() == 1 && joints[0].abs() < 1e-11, "{joints:?}");
    }

    #[test]
    fn cusps_of_a_cycloid_are_joints_and_its_length_is_eight_radii() {
        let mut builder = Builder::new();
        let t = builder.push(Operation::Variable(0));
        let radian = builder.constant(core::f64::consts::PI / 180.0);
        let way = builder.binary(Binary::Multiply, t, radian);
        let (sin, cos) = (builder.unary(Unary::Sin, t), builder.unary(Unary::Cos, t));
        let one = builder.constant(1.0);
        let x = builder.binary(Binary::Subtract, way, sin);
        let y = builder.binary(Binary::Subtract, one, cos);
        let z = builder.constant(0.0);
        let formula = builder.finish(1, vec![x, y, z]);
        let curve = FormulaCurve::new(formula, 0.0, 720.0).unwrap();
        assert_eq!(curve.joints().len(), 1);
        assert!((curve.joints()[0] - 360.0).abs() < 1e-5, "{:?}", curve.joints());
        assert!((length(&curve) - 16.0).abs() < 1e-8, "{}", length(&curve));
        let (before, after) = (
            curve.direction(curve.joints()[0], Side::Before),
            curve.direction(curve.joints()[0], Side::After),
        );
        assert!(before.y < -0.999_999 && after.y > 0.999_999);
    }

    #[test]
    fn a_root_starts_upright_and_is_bounded() {
        let curve = FormulaCurve::new(graph(|builder, t| builder.unary(Unary::Sqrt, t)), 0.0, 4.0).unwrap();
        assert!(curve.joints().is_empty());
        assert_eq!(curve.point(0.0), glam::DVec3::ZERO);
        assert!(curve.direction(0.0, Side::After).y > 0.999);
        assert!(curve.evaluate(0.0, Side::After).first.is_finite());
        // The parabola x = y^2 between y = 0 and y = h is at most h^2 / 4 from its chord, measured along x.
        for y in [0.1, 0.01, 1e-3] {
            let bound = curve.chord_deviation(0.0, y * y);
            assert!(bound >= y * y / 4.0 / 1.1 && bound < 4.0 * y * y, "{y}: {bound}");
        }
    }

    #[test]
    fn what_gives_no_curve_is_told() {
        let pole = graph(|builder, t| builder.push(Operation::Power(t, -1.0)));
        assert!(matches!(
            FormulaCurve::new(pole.clone(), -1.0, 1.0),
            Err(FormulaFault::NoValue { t: 0.0, .. })
        ));
        let Err(FormulaFault::Unbounded { t }) = FormulaCurve::new(pole, -1.0, 2.0) else { panic!() };
        assert!(t.abs() < 1e-11);
        let jump = graph(|builder, t| builder.unary(Unary::Floor, t));
        let Err(FormulaFault::Jump { t, before, after }) = FormulaCurve::new(jump, 0.5, 1.7) else {
            panic!()
        };
        assert!((t - 1.0).abs() < 1e-11 && before.y == 0.0 && after.y == 1.0);
        let wild = graph(|builder, t| {
            let fast = builder.constant(1e12);
            let angle = builder.binary(Binary::Multiply, t, fast);
            builder.unary(Unary::Sin, angle)
        });
        assert!(FormulaCurve::new(wild, 0.0, 1.0).is_ok(), "a graph moves on however much it swings");
        let still = Builder::new();
        let mut still = still;
        let t = still.push(Operation::Variable(0));
        let zero = still.constant(0.0);
        let stopped = still.binary(Binary::Maximum, t, zero);
        let still = still.finish(1, vec![stopped, stopped, zero]);
        assert!(matches!(FormulaCurve::new(still, -1.0, 1.0), Err(FormulaFault::Still { .. })));
    }
}

//! Laws of formulas, held against thousands of random ones.

use super::{Algebra, Binary, Builder, Formula, Interval, Jet, Operation, Quality, Slot, Unary};

/// Numbers that are the same in every run (xorshift, G. Marsaglia, 2003).
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        let index = usize::try_from(self.bits() >> 33).unwrap_or(0) % all.len();
        all[index]
    }
}

const UNARY: [Unary; 19] = [
    Unary::Negate,
    Unary::Sin,
    Unary::Cos,
    Unary::Tan,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Sinh,
    Unary::Cosh,
    Unary::Tanh,
    Unary::Sqrt,
    Unary::Exp,
    Unary::Ln,
    Unary::Abs,
    Unary::Sign,
    Unary::Floor,
    Unary::Round,
    Unary::Smoothstep,
    Unary::Not,
];

const BINARY: [Binary; 11] = [
    Binary::Add,
    Binary::Subtract,
    Binary::Multiply,
    Binary::Divide,
    Binary::Power,
    Binary::Atan2,
    Binary::Minimum,
    Binary::Maximum,
    Binary::Less,
    Binary::LessOrEqual,
    Binary::Equal,
];

/// A random formula of two variables, of this many steps.
fn random(dice: &mut Dice, steps: usize) -> Formula {
    let mut builder = Builder::new();
    let mut all: Vec<Slot> = (0..2).map(|index| builder.push(Operation::Variable(index))).collect();
    all.push(builder.constant(dice.between(-2.0, 2.0)));
    for _ in 0..steps {
        let (a, b, c) = (dice.of(&all), dice.of(&all), dice.of(&all));
        let operation = match dice.bits() % 10 {
            0..4 => Operation::Unary(dice.of(&UNARY), a),
            4..7 => Operation::Binary(dice.of(&BINARY), a, b),
            7 => Operation::Power(a, dice.of(&[-2.0, -1.0, 0.5, 1.5, 2.0, 3.0, 4.0, 5.0])),
            8 => {
                let condition = builder.binary(Binary::Less, a, b);
                Operation::Select(condition, b, c)
            }
            _ => Operation::Noise(7.0, a, b),
        };
        all.push(builder.push(operation));
    }
    let last = all[all.len() - 1];
    builder.finish(2, vec![last])
}

fn inside(bound: Interval, value: f64) -> bool {
    // Bounds enclose what exact numbers give; plain numbers round, here by a few steps of 1e-16 each.
    let slack = 1e-9 * (1.0 + value.abs());
    bound.low - slack <= value && value <= bound.high + slack
}

#[test]
fn bounds_over_a_box_hold_at_its_points() {
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    let (mut checked, mut tight, mut smooth) = (0, 0, 0);
    for round in 0..4000 {
        let formula = random(&mut dice, 1 + round % 9);
        let width = dice.of(&[1e-6, 0.01, 0.3, 3.0]);
        let corner = [dice.between(-3.0, 3.0), dice.between(-3.0, 3.0)];
        let sides = corner.map(|low| Interval::new(low, low + width));
        let [bounds]: [Jet<Interval, 2>; 1] = formula.jets_over(sides);
        let quality = bounds.value.quality;
        for _ in 0..12 {
            let place = corner.map(|low| dice.between(low, low + width));
            let [jet]: [Jet<f64, 2>; 1] = formula.jets(place);
            if quality > Quality::Unknown {
                assert!(!jet.value.is_nan(), "{formula:?} has no value at {place:?}");
            }
            if !jet.value.is_finite() {
                continue;
            }
            assert!(inside(bounds.value, jet.value), "{formula:?} at {place:?}: {jet:?} in {bounds:?}");
            if quality == Quality::Smooth {
                smooth += 1;
                for i in 0..2 {
                    let (bound, slope) = (bounds.first[i], jet.first[i]);
                    assert!(
                        !slope.is_finite() || inside(bound, slope),
                        "{formula:?} at {place:?}: {i} {slope} in {bound:?}"
                    );
                    for j in 0..2 {
                        let (bound, bend) = (bounds.second[i][j], jet.second[i][j]);
                        let fits =
                            !bend.is_finite() || inside(bound, bend) || slope.abs() > 1e9 || bend.abs() > 1e9;
                        assert!(fits, "{formula:?} at {place:?}: {i}{j} {bend} in {bound:?}");
                    }
                }
            }
            checked += 1;
            tight += usize::from(
                bounds.value.width() <= 1e3 * width * (1.0 + jet.first[0].abs() + jet.first[1].abs()),
            );
        }
    }
    assert!(checked > 20_000 && smooth > 15_000, "{checked} places, {smooth} smooth");
    assert!(tight * 10 > checked * 8, "only {tight} of {checked} bounds are tight");
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let mut dice = Dice(0x0123_4567_89ab_cdef);
    let mut checked = 0;
    for round in 0..4000 {
        let formula = random(&mut dice, 1 + round % 6);
        let place = [dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)];
        let h = 1e-5;
        let around = place.map(|x| Interval::new(x - 2.0 * h, x + 2.0 * h));
        let [bounds]: [Jet<Interval, 2>; 1] = formula.jets_over(around);
        // Differences mean something where the formula is smooth and bends little over the step.
        let calm = bounds.second.iter().flatten().all(|bend| bend.width() < 1e-2 * (1.0 + bend.size()));
        if bounds.value.quality < Quality::Smooth || !calm {
            continue;
        }
        let jet = |place: [f64; 2]| -> Jet<f64, 2> { formula.jets::<2, 1>(place)[0] };
        let here = jet(place);
        for i in 0..2 {
            let moved = |step: f64| jet(core::array::from_fn(|k| place[k] + if k == i { step } else { 0.0 }));
            let (before, after) = (moved(-h), moved(h));
            let first = (after.value - before.value) / (2.0 * h);
            let size = 1.0 + here.value.abs() / h * 1e-6 + here.first[i].abs() + here.second[i][i].abs();
            assert!(
                (first - here.first[i]).abs() <= 1e-4 * size,
                "{formula:?} at {place:?}: {first} {here:?}"
            );
            for j in 0..2 {
                let second = (after.first[j] - before.first[j]) / (2.0 * h);
                let size = 1.0 + here.first[j].abs() / h * 1e-7 + here.second[i][j].abs();
                assert!(
                    (second - here.second[i][j]).abs() <= 2e-2 * size,
                    "{formula:?} at {place:?}: {second} {here:?}"
                );
            }
        }
        checked += 1;
    }
    assert!(checked > 1500, "{checked}");
}

#[test]
fn equal_steps_are_made_once_and_constants_are_folded() {
    let mut builder = Builder::new();
    let x = builder.push(Operation::Variable(0));
    let one = builder.unary(Unary::Sin, x);
    let two = builder.unary(Unary::Sin, x);
    assert_eq!(one, two);
    let (a, b) = (builder.constant(2.0), builder.constant(3.0));
    let sum = builder.binary(Binary::Multiply, a, b);
    assert_eq!(builder.known(sum), Some(6.0));
    let nothing = builder.constant(0.0);
    let pole = builder.binary(Binary::Divide, a, nothing);
    assert_eq!(builder.known(pole), None);
    let chosen = builder.push(Operation::Select(nothing, pole, one));
    assert_eq!(chosen, one);
}

#[test]
fn long_formulas_use_few_registers_and_wide_ones_many() {
    // x + 1 + 2 + ... needs one register for the sum and one for the next number.
    let mut builder = Builder::new();
    let mut sum = builder.push(Operation::Variable(0));
    for k in 1..=200 {
        let next = builder.constant(f64::from(k));
        sum = builder.binary(Binary::Add, sum, next);
    }
    let formula = builder.finish(1, vec![sum]);
    assert_eq!(formula.evaluate::<f64, 1>(&[0.5]), [20100.5]);
    assert!(formula.registers() <= 3, "{}", formula.registers());
    // All sines are made before any is used.
    let mut builder = Builder::new();
    let x = builder.push(Operation::Variable(0));
    let sines: Vec<Slot> = (1..=40)
        .map(|k| {
            let factor = builder.constant(f64::from(k));
            let angle = builder.binary(Binary::Multiply, x, factor);
            builder.unary(Unary::Sin, angle)
        })
        .collect();
    let sum = sines.into_iter().reduce(|sum, sine| builder.binary(Binary::Add, sum, sine)).unwrap();
    let formula = builder.finish(1, vec![sum]);
    assert!(formula.registers() > 39);
    let expected: f64 = (1..=40).map(|k| crate::geometry::number::sin_degrees(f64::from(k) * 7.0)).sum();
    assert!((formula.evaluate::<f64, 1>(&[7.0])[0] - expected).abs() < 1e-13);
}

#[test]
fn intervals_know_peaks_poles_and_kinks() {
    let over = |operation: Unary, low: f64, high: f64| Interval::unary(operation, Interval::new(low, high));
    assert_eq!(over(Unary::Sin, 30.0, 400.0).high, 1.0);
    let rise = over(Unary::Sin, 0.0, 90.0);
    assert!(rise.low <= 0.0 && rise.low > -1e-300 && rise.high == 1.0);
    assert!(over(Unary::Cos, 100.0, 170.0).high < -0.17 && over(Unary::Cos, 170.0, 190.0).low == -1.0);
    assert_eq!(over(Unary::Tan, 80.0, 100.0).quality, Quality::Unknown);
    assert_eq!(over(Unary::Tan, -80.0, 80.0).quality, Quality::Smooth);
    assert_eq!(over(Unary::Sqrt, -1.0, 4.0).quality, Quality::Unknown);
    assert_eq!(over(Unary::Sqrt, 0.0, 4.0).quality, Quality::Smooth);
    assert_eq!(
        over(Unary::Abs, -1.0, 2.0),
        Interval { quality: Quality::Continuous, ..Interval::new(0.0, 2.0) }
    );
    assert_eq!(over(Unary::Floor, 1.5, 2.5).quality, Quality::Defined);
    assert_eq!(over(Unary::Floor, 1.5, 1.9).quality, Quality::Smooth);
    let pole = Interval::binary(Binary::Divide, Interval::constant(1.0), Interval::new(-1.0, 1.0));
    assert_eq!(pole.quality, Quality::Unknown);
    // What may have no value is not hidden by a comparison.
    let root = over(Unary::Sqrt, -2.0, -1.0);
    let most = Interval::binary(Binary::Maximum, root, Interval::constant(10.0));
    assert_eq!(most.quality, Quality::Unknown);
}

#[test]
fn the_step_that_loses_the_value_is_named() {
    let mut builder = Builder::new();
    let x = builder.push(Operation::Variable(0));
    let root = builder.unary(Unary::Sqrt, x);
    let nothing = builder.constant(0.0);
    let positive = builder.binary(Binary::LessOrEqual, nothing, x);
    let guarded = builder.push(Operation::Select(positive, root, nothing));
    let log = builder.unary(Unary::Ln, x);
    let safe = builder.push(Operation::Select(positive, root, nothing));
    let sum = builder.binary(Binary::Add, guarded, log);
    let formula = builder.finish(1, vec![safe, sum]);
    let culprit = formula.culprit(&[-4.0]).unwrap();
    assert_eq!((culprit.slot, culprit.operands), (log, vec![-4.0]));
    assert_eq!(formula.culprit(&[4.0]), None);
}

/// The excess of a bound is at most the sum of the sizes of the second derivatives over half the box, squared: the mean value
/// with bounds on slopes that differ by that much.
#[test]
fn bounds_on_noise_close_in_with_the_square_of_the_box() {
    let mut dice = Dice(0x51_7cc1_b727_220a);
    let mut loosest: f64 = 0.0;
    for _ in 0..2000 {
        let width = dice.of(&[0.2, 0.02, 0.002]);
        let corner = [dice.between(-5.0, 5.0), dice.between(-5.0, 5.0)];
        let sides = corner.map(|low| Interval::new(low, low + width));
        let bound = Interval::noise(7.0, sides[0], sides[1]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for step in 0..81 {
            let [x, y] = [step % 9, step / 9].map(|step| f64::from(step) / 8.0 * width);
            let value = f64::noise(7.0, corner[0] + x, corner[1] + y);
            assert!(bound.low <= value && value <= bound.high, "{value} in {bound:?}");
            (low, high) = (low.min(value), high.max(value));
        }
        let excess = (bound.high - bound.low) - (high - low);
        loosest = loosest.max((excess - 1e-10) / (width * width));
    }
    assert!(loosest < 4.0 * 38.74, "{loosest} of the square of a box");
}

//! Laws of curves.

use glam::{DAffine3, DMat3, DVec3};
use kiln::geometry::curve::{
    AnyCurve, Curve, Jet, Restarted, Retimed, Reversed, Side, Transformed, length, lengths_at,
};
use kiln::geometry::number::atan2;

use super::{Dice, curves};

/// A curve, its name, the pieces between its joints, and its size.
struct Subject {
    name: String,
    curve: AnyCurve,
    pieces: Vec<(f64, f64)>,
    size: f64,
}

impl Subject {
    fn new(name: String, curve: AnyCurve) -> Self {
        let domain = curve.domain();
        let mut stops = vec![domain.start];
        stops.extend(curve.joints());
        stops.push(domain.end);
        assert!(stops.windows(2).all(|pair| pair[0] < pair[1]), "{name}: joints do not increase: {stops:?}");
        let pieces = stops.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let points: Vec<DVec3> = (0..=64).map(|k| curve.point(domain.at(f64::from(k) / 64.0))).collect();
        let size = points.iter().map(|point| point.distance(points[0])).fold(0.0, f64::max);
        Self { name, curve, pieces, size }
    }

    /// Every curve of the list, and each of them backwards, under a map that stretches and shears, at an even speed, and
    /// begun elsewhere if it is closed.
    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for (name, curve) in curves() {
            let map = skew();
            all.push(Self::new(
                format!("{name} backwards"),
                AnyCurve::Reversed(Reversed::new(curve.clone())),
            ));
            let mapped = Transformed::new(curve.clone(), map);
            all.push(Self::new(format!("{name} mapped"), AnyCurve::Transformed(mapped)));
            let domain = curve.domain();
            let ends = [(-1.0, domain.start), (2.0, domain.end)];
            let even = Retimed::by_length(curve.clone(), &ends).expect("the ends are those of the domain");
            all.push(Self::new(format!("{name} at an even speed"), AnyCurve::Retimed(even)));
            if let Some(other) = Restarted::new(curve.clone(), domain.at(0.37)) {
                all.push(Self::new(format!("{name} begun elsewhere"), AnyCurve::Restarted(other)));
            }
            all.push(Self::new(name, curve));
        }
        assert!(all.len() > 60, "{}", all.len());
        all
    }

    /// A parameter inside a piece, with its piece.
    fn place(&self, dice: &mut Dice) -> (f64, (f64, f64)) {
        let (start, end) = self.pieces[dice.roll(self.pieces.len())];
        let margin = 1e-3 * (end - start);
        (dice.between(start + margin, end - margin), (start, end))
    }
}

fn skew() -> DAffine3 {
    let matrix =
        DMat3::from_cols(DVec3::new(1.0, 0.2, 0.0), DVec3::new(-0.7, 0.5, 0.1), DVec3::new(0.3, 0.0, 2.0));
    DAffine3 { matrix3: matrix, translation: DVec3::new(1.0, -2.0, 0.5) }
}

fn segment_distance(point: DVec3, (start, end): (DVec3, DVec3)) -> f64 {
    let along = end - start;
    let square = along.length_squared();
    let place = if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(start + along * place)
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    atan2(a.cross(b).length(), a.dot(b))
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let mut dice = Dice::new(1);
    for Subject { name, curve, pieces, size } in Subject::all() {
        let subject = Subject { name, curve, pieces, size };
        let mut tried = 0;
        for _ in 0..60 {
            let (t, (start, end)) = subject.place(&mut dice);
            if !subject.curve.has_curvature() {
                // Its kernel's own tests hold the derivative against its modulus of continuity.
                tried += 1;
                continue;
            }
            let h = 1e-4 * (end - start);
            let jet = |t: f64| subject.curve.evaluate(t, Side::After);
            let (before, here, after) = (jet(t - h), jet(t), jet(t + h));
            // A joint of equal directions may still change its speed; a difference across it means nothing.
            let bend = here.second.length().max(before.second.length());
            if before.second.distance(after.second) > 0.05 * bend + 1e-9 * here.first.length() / h {
                continue;
            }
            tried += 1;
            let first = (after.point - before.point) / (2.0 * h);
            let second = (after.first - before.first) / (2.0 * h);
            let scale = here.first.length().max(bend * (end - start));
            assert!(
                first.distance(here.first) <= 1e-6 * scale,
                "{} at {t}: {first} {}",
                subject.name,
                here.first
            );
            let scale = bend.max(scale / (end - start));
            assert!(
                second.distance(here.second) <= 5e-2 * scale,
                "{} at {t}: {second} {}",
                subject.name,
                here.second
            );
        }
        assert!(tried >= 50, "{}: only {tried} places are smooth", subject.name);
    }
}

/// Where a curve is one polynomial or one arc, the second derivative is met far more exactly.
#[test]
fn second_derivatives_inside_one_piece_are_exact() {
    let mut dice = Dice::new(2);
    let whole = [
        "circle",
        "ellipse",
        "arc",
        "clockwise",
        "three",
        "helix",
        "cone",
        "high",
        "two",
        "elliptic",
        "parabola",
        "falling",
        "hyperbola",
        "leaning",
        "slice",
        "branch",
        "dish",
    ];
    for (name, curve) in curves().into_iter().filter(|(name, _)| whole.contains(&name.as_str())) {
        let domain = curve.domain();
        for _ in 0..50 {
            let t = domain.at(dice.between(0.01, 0.99));
            let h = 1e-4 * domain.span();
            let jet = |t: f64| curve.evaluate(t, Side::After);
            let second = (jet(t + h).first - jet(t - h).first) / (2.0 * h);
            let scale = jet(t).second.length() + jet(t).first.length() / domain.span();
            assert!(second.distance(jet(t).second) <= 2e-5 * scale, "{name} at {t}");
        }
    }
}

#[test]
fn chord_bounds_hold_in_both_directions() {
    let mut dice = Dice::new(3);
    for subject in Subject::all() {
        for round in 0..24 {
            let (one, piece) = subject.place(&mut dice);
            let other = dice.between(piece.0, piece.1);
            let (from, to) = if round == 0 { piece } else { (one.min(other), one.max(other)) };
            let bound = subject.curve.chord_deviation(from, to);
            let point =
                |t: f64| subject.curve.evaluate(t, if t == to { Side::Before } else { Side::After }).point;
            let chord = (point(from), point(to));
            let samples: Vec<DVec3> =
                (0..=400).map(|k| point(from + (to - from) * f64::from(k) / 400.0)).collect();
            let worst = samples.iter().map(|p| segment_distance(*p, chord)).fold(0.0, f64::max);
            let rounding = 1e-13 * (subject.size + chord.0.length());
            assert!(
                worst <= bound * (1.0 + 1e-9) + rounding,
                "{} {from} {to}: {worst} > {bound}",
                subject.name
            );
            for k in 0..=20 {
                let on_chord = chord.0.lerp(chord.1, f64::from(k) / 20.0);
                let nearest = samples.windows(2).map(|p| segment_distance(on_chord, (p[0], p[1])));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                // The samples are themselves chords, 400 times shorter.
                let slack = bound * 1e-3 + rounding;
                assert!(nearest <= bound + slack, "{} {from} {to}: {nearest} > {bound}", subject.name);
            }
        }
    }
}

#[test]
fn chord_bounds_tend_to_zero_with_the_square_of_the_length() {
    let mut dice = Dice::new(4);
    for subject in Subject::all() {
        let mut uneven = 0;
        for _ in 0..12 {
            let (t, (start, end)) = subject.place(&mut dice);
            let step = (end - t).min(1e-2 * (end - start));
            let bound = |part: f64| subject.curve.chord_deviation(t, t + step * part);
            let (coarse, fine) = (bound(1.0), bound(1.0 / 64.0));
            let rounding = 1e-14 * subject.size;
            // Where the bend jumps inside the coarse chord, the fine one may lie on the side that bends more.
            uneven += usize::from(fine > coarse / 4096.0 * 1.5 + rounding);
            assert!(fine <= coarse / 128.0 + rounding, "{} at {t}: {coarse} became {fine}", subject.name);
        }
        // Without a second derivative the square comes with a logarithm.
        assert!(
            uneven <= if subject.curve.has_curvature() { 2 } else { 12 },
            "{}: {uneven} of 12 do not fall with the square",
            subject.name
        );
    }
}

#[test]
fn a_curve_that_is_reversed_twice_is_itself() {
    let mut dice = Dice::new(5);
    for subject in Subject::all() {
        let once = Reversed::new(subject.curve.clone());
        let twice = Reversed::new(AnyCurve::Reversed(once.clone()));
        let domain = subject.curve.domain();
        assert_eq!((once.domain(), twice.domain()), (domain, domain));
        assert_eq!(twice.joints().len(), subject.curve.joints().len());
        let close = |a: Jet, b: Jet| {
            let speed = a.first.length() + b.first.length() + subject.size;
            a.point.distance(b.point) <= 1e-12 * subject.size.max(1.0)
                && a.first.distance(b.first) <= 1e-11 * speed.max(1.0)
        };
        for _ in 0..30 {
            let (t, _) = subject.place(&mut dice);
            let back = once.evaluate(domain.start + (domain.end - t), Side::Before);
            let back = Jet { first: -back.first, ..back };
            assert!(close(back, subject.curve.evaluate(t, Side::After)), "{} at {t}", subject.name);
            let again = twice.evaluate(t, Side::After);
            assert!(close(again, subject.curve.evaluate(t, Side::After)), "{} at {t}", subject.name);
        }
        for (own, again) in subject.curve.joints().into_iter().zip(twice.joints()) {
            for side in [Side::Before, Side::After] {
                let directions = (subject.curve.direction(own, side), twice.direction(again, side));
                assert!(angle(directions.0, directions.1) < 1e-9, "{} at {own} {side:?}", subject.name);
            }
        }
    }
}

#[test]
fn maps_commute_with_evaluation() {
    let mut dice = Dice::new(6);
    let map = skew();
    for (name, curve) in curves() {
        let mapped = Transformed::new(curve.clone(), map);
        assert_eq!((mapped.domain(), mapped.joints()), (curve.domain(), curve.joints()));
        assert_eq!(mapped.is_closed(), curve.is_closed());
        for _ in 0..20 {
            let t = curve.domain().at(dice.between(0.0, 1.0));
            let (image, own) = (mapped.evaluate(t, Side::After), curve.evaluate(t, Side::After));
            assert!(image.point.distance(map.transform_point3(own.point)) < 1e-12, "{name}");
            assert!(
                image.first.distance(map.transform_vector3(own.first)) <= 1e-12 * own.first.length(),
                "{name}"
            );
            assert!(
                image.second.distance(map.transform_vector3(own.second)) <= 1e-12 * own.second.length(),
                "{name}"
            );
        }
    }
}

#[test]
fn the_ends_of_closed_curves_meet_and_those_of_open_ones_do_not() {
    let mut closed = 0;
    for Subject { name, curve, size, .. } in Subject::all() {
        let domain = curve.domain();
        let gap = curve.point(domain.start).distance(curve.evaluate(domain.end, Side::Before).point);
        assert_eq!(curve.is_closed(), gap <= 1e-12 * size, "{name}: {gap}");
        closed += usize::from(curve.is_closed());
    }
    let named = "polygon, circle, ellipse, ring, rounded, leaning, bloop, bring, four, nine, ten more";
    assert!(closed >= 3 * 20, "{named}: {closed}");
}

#[test]
fn directions_jump_at_joints_and_nowhere_else() {
    let straight_joint = |name: &str| name.starts_with("straight") || name.starts_with("rounded");
    for subject in Subject::all() {
        for joint in subject.curve.joints() {
            let (before, after) =
                (subject.curve.evaluate(joint, Side::Before), subject.curve.evaluate(joint, Side::After));
            assert!(
                before.point.distance(after.point) <= 1e-12 * subject.size,
                "{} at {joint}",
                subject.name
            );
            let turn = angle(
                subject.curve.direction(joint, Side::Before),
                subject.curve.direction(joint, Side::After),
            );
            assert!(
                turn > 1e-9 || straight_joint(&subject.name),
                "{} does not turn at {joint}",
                subject.name
            );
        }
        for (start, end) in &subject.pieces {
            assert_smooth(&subject, *start, *end);
        }
    }
}

/// No jump between: where two neighboring samples turn by much, ever nearer ones turn by little.
fn assert_smooth(subject: &Subject, start: f64, end: f64) {
    let at = |k: u32| start + (end - start) * f64::from(k) / 800.0;
    let turn = |from: f64, to: f64| {
        angle(subject.curve.direction(from, Side::After), subject.curve.direction(to, Side::Before))
    };
    for k in 0..800 {
        let (mut from, mut to) = (at(k), if k == 799 { end } else { at(k + 1) });
        for _ in 0..34 {
            if turn(from, to) < 1e-3 {
                break;
            }
            let middle = from + (to - from) / 2.0;
            if turn(from, middle) > turn(middle, to) { to = middle } else { from = middle }
        }
        assert!(turn(from, to) < 1e-3, "{}: a jump of {} near {from}", subject.name, turn(from, to));
    }
}

#[test]
fn many_at_once_are_the_same_as_one_by_one() {
    let mut dice = Dice::new(31);
    for subject in Subject::all() {
        let domain = subject.curve.domain();
        let mut places: Vec<f64> = (0..40).map(|_| dice.between(domain.start, domain.end)).collect();
        places.extend(subject.curve.breaks());
        places.extend([domain.start, domain.end, domain.start - 1.0, domain.end + 1.0]);
        for side in [Side::Before, Side::After] {
            let mut found = vec![(DVec3::ZERO, DVec3::ZERO); places.len()];
            subject.curve.tangents(&places, side, &mut found);
            for (t, found) in places.iter().zip(found) {
                let jet = subject.curve.evaluate(*t, side);
                assert_eq!(found, (jet.point, jet.first), "{} at {t} {side:?}", subject.name);
            }
        }
    }
}

#[test]
fn parameters_outside_the_domain_are_its_ends() {
    for Subject { name, curve, .. } in Subject::all() {
        let domain = curve.domain();
        for beyond in [1e-9, 0.5, 1e9, f64::INFINITY] {
            for side in [Side::Before, Side::After] {
                let (low, high) =
                    (curve.evaluate(domain.start - beyond, side), curve.evaluate(domain.end + beyond, side));
                assert_eq!(low.point, curve.evaluate(domain.start, side).point, "{name} - {beyond}");
                assert_eq!(high.point, curve.evaluate(domain.end, side).point, "{name} + {beyond}");
                assert!(low.first.is_finite() && high.first.is_finite(), "{name}");
            }
        }
    }
}

#[test]
fn arc_lengths_add_up_and_are_those_of_fine_polygons() {
    for Subject { name, curve, size, .. } in Subject::all() {
        let domain = curve.domain();
        let places: Vec<f64> = (0..=16).map(|k| domain.at(f64::from(k) / 16.0)).collect();
        let lengths = lengths_at(&curve, &places);
        let whole = length(&curve);
        assert!(lengths.windows(2).all(|pair| pair[0] <= pair[1]), "{name}: {lengths:?}");
        assert!((lengths[16] - whole).abs() <= 1e-8 * whole, "{name}: {} {whole}", lengths[16]);
        let fine = 20_000;
        let points: Vec<DVec3> =
            (0..=fine).map(|k| curve.point(domain.at(f64::from(k) / f64::from(fine)))).collect();
        let polygon: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        // Corners that fall between two samples are cut by a part of a step each.
        let cut = 2.0 * curve.joints().len() as f64 * size / f64::from(fine);
        assert!(
            polygon <= whole * (1.0 + 1e-9) && polygon >= whole * (1.0 - 1e-6) - cut * 4.0,
            "{name}: {polygon} {whole}"
        );
    }
}

/// Between breaks both derivatives are continuous; at breaks that are no joints the direction is.
#[test]
fn derivatives_jump_at_breaks_and_nowhere_else() {
    for Subject { name, curve, .. } in Subject::all() {
        let domain = curve.domain();
        let breaks = curve.breaks();
        assert!(breaks.windows(2).all(|pair| pair[0] < pair[1]), "{name}: {breaks:?}");
        assert!(breaks.iter().all(|t| *t > domain.start && *t < domain.end), "{name}: {breaks:?}");
        let joints = curve.joints();
        assert!(joints.iter().all(|joint| breaks.contains(joint)), "{name}: {joints:?} {breaks:?}");
        for t in breaks.iter().filter(|t| !joints.contains(t)) {
            let turn = angle(curve.direction(*t, Side::Before), curve.direction(*t, Side::After));
            assert!(turn < 1e-8, "{name} turns by {turn} at {t}");
        }
        if !curve.has_curvature() {
            continue;
        }
        let stops: Vec<f64> = [vec![domain.start], breaks, vec![domain.end]].concat();
        for pair in stops.windows(2) {
            let step = (pair[1] - pair[0]) / 4096.0;
            let jets: Vec<Jet> =
                (1..4096).map(|k| curve.evaluate(pair[0] + step * f64::from(k), Side::After)).collect();
            let greatest = jets.iter().map(|jet| jet.second.length()).fold(0.0, f64::max);
            let speed = jets.iter().map(|jet| jet.first.length()).fold(0.0, f64::max);
            // A jump stays as it is between ever nearer samples; what is continuous falls with their distance.
            let jump =
                jets.windows(2).map(|pair| pair[0].second.distance(pair[1].second)).fold(0.0, f64::max);
            assert!(
                jump <= 0.05 * greatest + 1e-9 * speed / (pair[1] - pair[0]),
                "{name} in {pair:?}: {jump} of {greatest}"
            );
        }
    }
}

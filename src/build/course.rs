//! The law of a track: keys, formulas, curves, ways along curves.

use glam::{DQuat, DVec3, DVec4};

use super::Builder;
use super::formula::Compiler;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Transformed, length};
use crate::geometry::number::single;
use crate::geometry::surface::{Carry, FrameRule};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{
    AngleOrder, ClipTrack, CurveReference, Formulas, KeyBetween, MotionKey, MotionPath, RotationWay, Sp,
};
use crate::motion::{Course, EulerOrder, Interpolation, Keys, Law, LawFault, Speed};

/// A law and how many numbers it gives, with the place that says so.
pub(super) type Counted = (Law, usize, Span);

/// What a track is of.
pub(super) struct Moved {
    /// Whether it is a joint; else it is a node.
    pub(super) joint: bool,
    /// The place along a chain, 0 to 1.
    pub(super) share: f64,
    /// Seconds of the clip.
    pub(super) duration: f64,
    /// Whether the clip is a loop.
    pub(super) looped: bool,
    /// Whether values are colors.
    pub(super) color: bool,
}

impl Builder<'_> {
    /// The courses of a track: one, and for a node that turns along a curve its rotation too.
    pub(super) fn courses(&mut self, track: &Sp<ClipTrack>, moved: &Moved) -> Option<Vec<Course>> {
        if let Some(along) = &track.along {
            return self.along_courses(track, along, moved);
        }
        if track.morph.is_some() {
            let (law, count, span) = self.law_of(track, moved)?;
            if count == 1 {
                return Some(vec![Course::Weight(law)]);
            }
            let message = format!("a weight is one number, found {count}");
            self.report(Diagnostic::error(Code::KeyValue, message).at(span, format!("{count} numbers")));
            return None;
        }
        let path = track.path.as_ref()?.value;
        let (law, count, span) = self.law_of(track, moved)?;
        let axis = track.axis.as_ref().map(|axis| axis.value.0);
        let course = match (path, count, axis) {
            (MotionPath::Translation, 3, None) => Course::Offset(law),
            (MotionPath::Translation, 1, Some(axis)) => Course::Slide { axis, law },
            (MotionPath::Scale, 3, None) => Course::Size(law),
            (MotionPath::Scale, 1, None) => Course::Growth(law),
            (MotionPath::Rotation, 1, Some(axis)) => turn(track, axis, law, moved.looped),
            (MotionPath::Rotation, 3, None) => angles(track, law, moved),
            (MotionPath::Rotation, 4, None) => self.quaternions(track, law, moved)?,
            _ => {
                self.report(wrong_count(track, (path, count, axis.is_some()), span));
                return None;
            }
        };
        Some(vec![course])
    }

    fn quaternions(&mut self, track: &ClipTrack, law: Law, moved: &Moved) -> Option<Course> {
        let Law::Keys(keys) = law else { return None };
        let mut rotations = Vec::new();
        for (value, key) in keys.values.iter().zip(&track.keys) {
            let length = value.length();
            if !(0.99..=1.01).contains(&length) {
                let message = format!("a quaternion has length 1, but this one has {}", show(length));
                let report = Diagnostic::error(Code::KeyValue, message)
                    .at(key.value.span, "no rotation")
                    .help("write angles in degrees with `axis`, or three angles");
                self.report(report);
                return None;
            }
            rotations.push(DQuat::from_vec4(*value / length));
        }
        Some(Course::rotations(keys.times, &rotations, keys.interpolation, moved.looped))
    }

    /// The law that a track writes.
    pub(super) fn law_of(&mut self, track: &Sp<ClipTrack>, moved: &Moved) -> Option<Counted> {
        if let Some(formula) = &track.formula {
            let law = self.formula_law(formula, moved)?;
            return Some((law, formula.0.len(), formula.span()));
        }
        if let Some(curve) = &track.curve {
            return self.graph_law(curve).map(|law| (law, 1, curve.span()));
        }
        let (keys, count) = self.keys(&track.keys, track.between.value, moved)?;
        Some((Law::Keys(keys), count, track.keys[0].value.span))
    }

    fn formula_law(&mut self, written: &Formulas, moved: &Moved) -> Option<Law> {
        /// Places at which a value must be finite.
        const SAMPLES: u32 = 1024;
        let mut formulas = Vec::new();
        for formula in &written.0 {
            let mut compiler = Compiler::new(&["t", "u"]);
            match compiler.add(&formula.value) {
                Ok(slot) => formulas.push((compiler.finish(vec![slot]).formula, formula.span)),
                Err(diagnostic) => self.report(*diagnostic),
            }
        }
        if formulas.len() < written.0.len() {
            return None;
        }
        for (formula, span) in &formulas {
            let time = |k: u32| moved.duration * f64::from(k) / f64::from(SAMPLES);
            let value = |time: f64| formula.evaluate::<f64, 1>(&[time, moved.share])[0];
            let lost = (0..=SAMPLES)
                .map(time)
                .find(|time| value(*time).abs().partial_cmp(&1e15).is_none_or(std::cmp::Ordering::is_gt));
            if let Some(time) = lost {
                let message = format!("the formula has no finite value at t = {}", show(time));
                let report = Diagnostic::error(Code::FormulaValue, message).at(*span, "no value");
                self.report(report.help("say with `if` what holds there"));
                return None;
            }
        }
        let formulas = formulas.into_iter().map(|(formula, _)| formula).collect();
        Some(Law::Formula { formulas, share: moved.share })
    }

    fn graph_law(&mut self, reference: &CurveReference) -> Option<Law> {
        let curve = self.curve_of(reference)?;
        match Law::graph(curve) {
            Ok(law) => Some(law),
            Err(LawFault::TurnsBack(time)) => {
                let message =
                    format!("this curve turns back or stands still in x, the time, at {} s", show(time));
                let report = Diagnostic::error(Code::KeyOrder, message)
                    .at(reference.span(), "x is the time, y the value")
                    .help("let x increase all the way; for a jump write `keys` with `between = \"step\"`");
                self.report(report);
                None
            }
        }
    }

    fn keys(&mut self, written: &[MotionKey], between: KeyBetween, moved: &Moved) -> Option<(Keys, usize)> {
        let count = written.first()?.value.count;
        let mut good = self.check_times(written, moved.duration);
        for key in written {
            let other = [Some(&key.value), key.slope.as_ref()].into_iter().flatten();
            if let Some(value) = other.into_iter().find(|value| value.count != count) {
                let message = format!(
                    "keys of a track have as many numbers, but here are {} after {count}",
                    value.count
                );
                let report = Diagnostic::error(Code::KeyValue, message)
                    .at(value.span, "not as many")
                    .also(written[0].value.span, "the first key");
                self.report(report);
                good = false;
                break;
            }
        }
        let colored = written.iter().find(|key| key.value.is_color && !moved.color);
        if let Some(key) = colored {
            let message = "a color stands only for a color, and this track moves something else";
            self.report(Diagnostic::error(Code::KeyValue, message).at(key.value.span, "no color is wanted"));
            return None;
        }
        if !good {
            return None;
        }
        let interpolation = match between {
            KeyBetween::Step => Interpolation::Step,
            KeyBetween::Linear => Interpolation::Linear,
            KeyBetween::Cubic => Interpolation::Cubic,
        };
        let slopes: Vec<Option<DVec4>> =
            written.iter().map(|key| key.slope.as_ref().map(|slope| slope.numbers)).collect();
        let values = written.iter().map(|key| key.value.numbers).collect();
        Some((Keys::new((times(written), values), &slopes, interpolation, moved.looped), count))
    }

    /// Times must increase, by more than single precision loses, and lie within the clip.
    fn check_times(&mut self, keys: &[MotionKey], duration: f64) -> bool {
        for pair in keys.windows(2) {
            let (before, after) = (pair[0].at.value, pair[1].at.value);
            if after - before > 1e-4 {
                continue;
            }
            let (message, label) = if after < before {
                (format!("a key at {} s comes after one at {} s", show(after), show(before)), "too early")
            } else {
                (format!("two keys are at {} s", show(after)), "not later by 0.1 ms")
            };
            let report = Diagnostic::error(Code::KeyOrder, message)
                .at(pair[1].at.span, label)
                .also(pair[0].at.span, "the key before")
                .help("write keys in the order of their times; for a jump write `between = \"step\"`");
            self.report(report);
            return false;
        }
        let late = keys.iter().find(|key| key.at.value > duration * (1.0 + 1e-9));
        if let Some(key) = late {
            let message = format!(
                "a key at {} s lies beyond the end of the clip at {} s",
                show(key.at.value),
                show(duration)
            );
            self.report(Diagnostic::error(Code::KeyOrder, message).at(key.at.span, "never reached"));
        }
        late.is_none()
    }

    fn along_courses(
        &mut self,
        track: &Sp<ClipTrack>,
        along: &CurveReference,
        moved: &Moved,
    ) -> Option<Vec<Course>> {
        if moved.joint {
            let report = Diagnostic::error(Code::BadTrack, "a joint is not moved along a curve")
                .at(along.span(), "only nodes are")
                .help("let a node carry the skeleton, with `parent`, and move that node");
            self.report(report);
            return None;
        }
        let written = self.curve_of(along)?;
        let whole = length(&written);
        let law = self.progress(track, (&written, along, whole), moved)?;
        let unit = self.model.frame.map();
        let path = if unit == glam::DAffine3::IDENTITY {
            written
        } else {
            AnyCurve::Transformed(Transformed::new(written, unit))
        };
        let mut courses = vec![Course::Along { path: path.clone(), law: law.clone() }];
        if track.orient.value {
            let up = track.up.as_ref().map(|up| unit.transform_vector3(up.value));
            let rule = up.map_or(FrameRule::RotationMinimizing, FrameRule::Up);
            courses.push(Course::Facing { path, carry: Carry { rule, twist: 0.0 }, law });
        }
        Some(courses)
    }

    /// A color that goes along a curve of colors.
    pub(super) fn color_along(
        &mut self,
        track: &Sp<ClipTrack>,
        along: &CurveReference,
        moved: &Moved,
    ) -> Option<Course> {
        let path = self.curve_of(along)?;
        let whole = length(&path);
        let law = self.progress(track, (&path, along, whole), &Moved { color: false, ..*moved })?;
        Some(Course::Along { path, law })
    }

    /// The share of the length that is gone at each time.
    fn progress(
        &mut self,
        track: &Sp<ClipTrack>,
        (path, along, whole): (&AnyCurve, &CurveReference, f64),
        moved: &Moved,
    ) -> Option<Law> {
        if !track.speed.is_empty() {
            let good = self.check_times(&track.speed, moved.duration);
            let speeds: Vec<f64> = track.speed.iter().map(|key| key.value.numbers.x).collect();
            if let Some(key) = track.speed.iter().find(|key| key.value.count != 1) {
                let report = Diagnostic::error(Code::KeyValue, "a speed is one number");
                self.report(report.at(key.value.span, "not one number"));
                return None;
            }
            let speed = Speed { times: times(&track.speed), speeds };
            let gone = speed.gone(moved.duration);
            if good && !path.is_closed() && (gone > whole * (1.0 + 1e-6) || gone < -1e-6 * whole) {
                self.report(past(along, track.speed[0].value.span, gone, whole));
                return None;
            }
            return good.then_some(Law::Speed { speed, length: whole });
        }
        if track.keys.is_empty() && track.formula.is_none() && track.curve.is_none() {
            let values = vec![DVec4::ZERO, DVec4::X];
            let keys = Keys::new((vec![0.0, moved.duration], values), &[], Interpolation::Linear, false);
            return Some(Law::Keys(keys));
        }
        let (law, count, span) = self.law_of(track, moved)?;
        if count != 1 {
            let message = "the share of a curve's length is one number from 0 to 1";
            self.report(Diagnostic::error(Code::KeyValue, message).at(span, "not one number"));
            return None;
        }
        Some(law)
    }
}

/// Times of keys, as they are written.
fn times(keys: &[MotionKey]) -> Vec<f64> {
    keys.iter().map(|key| f64::from(single(key.at.value))).collect()
}

fn past(along: &CurveReference, span: Span, gone: f64, whole: f64) -> Diagnostic {
    let message = format!(
        "at these speeds {} units are gone by the end of the clip, and the curve is {} long",
        show(gone),
        show(whole)
    );
    Diagnostic::error(Code::PastTheEnd, message)
        .at(span, "beyond its end")
        .also(along.span(), "the curve")
        .help("go slower, make the clip shorter, or close the curve to go round")
}

fn wrong_count(track: &ClipTrack, (path, count, axis): (MotionPath, usize, bool), span: Span) -> Diagnostic {
    let demand = match path {
        MotionPath::Translation => "three numbers, or one with `axis`",
        MotionPath::Rotation => "one number with `axis`, three angles, or four numbers of a quaternion",
        MotionPath::Scale => "one number or three, without `axis`",
        _ => "one number",
    };
    let numbers = if count == 1 { "1 number".to_owned() } else { format!("{count} numbers") };
    let with = if axis { " with `axis`" } else { "" };
    let message = format!("a {} has {demand}, found {numbers}{with}", path.text());
    let report = Diagnostic::error(Code::KeyValue, message).at(span, numbers);
    match &track.axis {
        Some(axis) => report.also(axis.span, "the axis"),
        None if count == 1 => report.help("write `axis = \"x\"`, \"y\", \"z\" or a direction beside it"),
        None => report,
    }
}

fn euler(order: AngleOrder) -> EulerOrder {
    match order {
        AngleOrder::Xyz => EulerOrder::Xyz,
        AngleOrder::Xzy => EulerOrder::Xzy,
        AngleOrder::Yxz => EulerOrder::Yxz,
        AngleOrder::Yzx => EulerOrder::Yzx,
        AngleOrder::Zxy => EulerOrder::Zxy,
        AngleOrder::Zyx => EulerOrder::Zyx,
    }
}

fn turn(track: &ClipTrack, axis: DVec3, law: Law, looped: bool) -> Course {
    match (&law, track.way.value) {
        (Law::Keys(keys), RotationWay::Shortest) => {
            let turned: Vec<DQuat> =
                keys.values.iter().map(|value| crate::motion::about(axis, value.x)).collect();
            Course::rotations(keys.times.clone(), &turned, keys.interpolation, looped)
        }
        _ => Course::Turn { axis, law },
    }
}

fn angles(track: &ClipTrack, law: Law, moved: &Moved) -> Course {
    let order = track.order.as_ref().map(|order| order.value);
    let order = order.unwrap_or(if moved.joint { AngleOrder::Yzx } else { AngleOrder::Xyz });
    let order = euler(order);
    match (&law, track.way.value) {
        (Law::Keys(keys), RotationWay::Shortest) => {
            let turned: Vec<DQuat> =
                keys.values.iter().map(|value| order.rotation(value.truncate())).collect();
            Course::rotations(keys.times.clone(), &turned, keys.interpolation, moved.looped)
        }
        _ => Course::Euler { order, law },
    }
}

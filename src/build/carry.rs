//! How sections are carried along paths.

use glam::DVec3;

use super::Builder;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::{acos, cos_degrees};
use crate::geometry::surface::{Carry, FrameRule};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{CurveReference, Frame, Sp, Up};

/// A path that comes nearer than this many degrees to `up` is taken to run along it: the section would spin.
const NEAREST: f64 = 1.0;

impl Builder<'_> {
    /// The rule of frames, and the direction of `up`, which the path must suit.
    pub(super) fn carry(
        &mut self,
        (frame, up): (&Sp<Frame>, Option<&Sp<DVec3>>),
        (path, place): (&AnyCurve, &CurveReference),
        twist: f64,
    ) -> Option<Carry> {
        let rule = match frame.value {
            Frame::RotationMinimizing => FrameRule::RotationMinimizing,
            Frame::Frenet => FrameRule::Frenet,
            Frame::Up => {
                let own = if self.spec.up == Up::Z { DVec3::Z } else { DVec3::Y };
                let (up, span) = up.map_or((own, frame.span), |up| (up.value, up.span));
                self.check_up(up.normalize(), span, (path, place.span()))?;
                FrameRule::Up(up)
            }
        };
        Some(Carry { rule, twist })
    }

    fn check_up(&mut self, up: DVec3, span: Span, (path, place): (&AnyCurve, Span)) -> Option<()> {
        let Some((t, degrees)) = steepest(path, up) else { return Some(()) };
        let message = format!(
            "the path runs along `up` at parameter {}: there up is no guide (the angle between them is {} degrees)",
            show(t),
            show(degrees)
        );
        let report = Diagnostic::error(Code::AlongUp, message)
            .at(place, "runs along `up`")
            .also(span, "the direction that is to be up")
            .help("give `up` a direction that the path never takes, or leave out `frame`: rotation-minimizing frames suit every path");
        self.report(report);
        None
    }
}

/// Where the path comes nearest to the direction or its opposite, if that is too near, and the angle in degrees.
fn steepest(path: &AnyCurve, up: DVec3) -> Option<(f64, f64)> {
    const SAMPLES: u32 = 64;
    let domain = path.domain();
    let mut stops = vec![domain.start];
    stops.extend(path.joints());
    stops.push(domain.end);
    let lean = |t: f64, side: Side| path.direction(t, side).dot(up).abs();
    let mut steepest = (0.0, domain.start);
    for pair in stops.windows(2) {
        let step = (pair[1] - pair[0]) / f64::from(SAMPLES);
        for k in 0..=SAMPLES {
            let t = if k == SAMPLES { pair[1] } else { pair[0] + step * f64::from(k) };
            let here = lean(t, if k == SAMPLES { Side::Before } else { Side::After });
            if here > steepest.0 {
                steepest = (here, t);
            }
        }
        steepest = polished(&lean, steepest, (pair[0], pair[1]), step);
    }
    let (cosine, t) = steepest;
    (cosine > cos_degrees(NEAREST)).then(|| (t, acos(cosine.min(1.0)).to_degrees()))
}

/// The greatest value around a sample inside a piece, by golden sections.
fn polished(
    lean: &impl Fn(f64, Side) -> f64,
    best: (f64, f64),
    (start, end): (f64, f64),
    step: f64,
) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if best.1 < start || best.1 > end {
        return best;
    }
    let (mut low, mut high) = ((best.1 - step).max(start), (best.1 + step).min(end));
    for _ in 0..40 {
        let (left, right) = (high - (high - low) * GOLDEN, low + (high - low) * GOLDEN);
        if lean(left, Side::After) > lean(right, Side::After) {
            high = right;
        } else {
            low = left;
        }
    }
    let t = (low + high) / 2.0;
    let found = (lean(t, Side::After), t);
    if found.0 > best.0 { found } else { best }
}

//! Frames of every rule: the transported ones, turned about the path.

use glam::DVec3;

use super::frenet::Angles;
use super::transport::Transport;
use super::turns::Turns;
use super::{Carry, Frame, FrameRule, wrapped};
use crate::geometry::curve::{AnyCurve, Curve, Side};

/// Radians below which two frames that should agree do: what transport leaves open.
const AGREED: f64 = 1e-8;

/// Frames along a path.
#[derive(Clone, Debug)]
pub struct FrameField {
    path: AnyCurve,
    transport: Transport,
    rule: Rule,
    turns: Turns,
}

/// The rule with what it needs to know of the path.
#[derive(Clone, Debug)]
enum Rule {
    RotationMinimizing,
    Frenet(Vec<Angles>),
    Up(DVec3),
}

impl FrameField {
    /// Frames along `path` for a section that reaches up to `reach` metres from it: so far beyond a corner nothing is
    /// turned.
    ///
    /// Without another rule, up is at the start as near to +y as can be; where the path itself runs along y there,
    /// side is +x. Cost: one walk along the path, some hundred evaluations for each smooth piece that bends.
    #[must_use]
    pub fn new(path: &AnyCurve, carry: &Carry, reach: f64) -> Self {
        let transport = Transport::new(path);
        let rule = match carry.rule {
            FrameRule::RotationMinimizing => Rule::RotationMinimizing,
            FrameRule::Frenet => {
                Rule::Frenet(transport.pieces().map(|stops| Angles::new(path, &transport, stops)).collect())
            }
            FrameRule::Up(up) => Rule::Up(up.normalize_or(DVec3::Y)),
        };
        let mut field = Self { path: path.clone(), transport, rule, turns: Turns::default() };
        let angles = field.angles(carry.twist.to_radians());
        field.turns = Turns::new(path, &field.transport, &angles, reach);
        field
    }

    /// Length of the path, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.transport.length()
    }

    /// What brings the frames before and after each corner and seam together, and the twist: the angles at the ends
    /// of each piece, radians.
    fn angles(&self, twist: f64) -> Vec<(f64, f64)> {
        let spans: Vec<(f64, f64)> =
            (self.transport.pieces()).map(|stops| (stops[0].walked, stops[stops.len() - 1].walked)).collect();
        let gaps = self.gaps(spans.len());
        let (length, count) = (self.length(), spans.len());
        if let Rule::RotationMinimizing = self.rule {
            // Transported frames agree at corners; what is left at the seam is spread over all.
            let turn = gaps[count - 1] + twist;
            let at = |walked: f64| turn * (walked / length);
            return spans.into_iter().map(|(from, to)| (at(from), at(to))).collect();
        }
        let at = |walked: f64| twist * (walked / length);
        let mut start = 0.0;
        let mut angles = Vec::with_capacity(count);
        for (index, (from, to)) in spans.into_iter().enumerate() {
            let end = if index + 1 < count { gaps[index] * self.share_before(index) } else { gaps[index] };
            angles.push((start + at(from), end + at(to)));
            start = end - gaps[index];
        }
        angles
    }

    /// For each piece the angle about the path from its last frame to the first one of the next; for the last piece
    /// of a closed path, to the first of all.
    fn gaps(&self, count: usize) -> Vec<f64> {
        let domain = self.path.domain();
        let joints = self.path.joints();
        let gap = |index: usize| {
            let found = if index + 1 < count {
                self.roll(joints[index], Side::After) - self.roll(joints[index], Side::Before)
            } else if self.path.is_closed() {
                let seam = self.transport.returned().angle_to(self.transport.first().side);
                seam + self.roll(domain.start, Side::After) - self.roll(domain.end, Side::Before)
            } else {
                0.0
            };
            let found = wrapped(found);
            let rounding = if let Rule::RotationMinimizing = self.rule { 1e-12 } else { AGREED };
            if found.abs() < rounding { 0.0 } else { found }
        };
        (0..count).map(gap).collect()
    }

    /// How much of the gap at a corner the piece before it takes; the one after takes the rest. A straight piece has
    /// no Frenet frame of its own and takes all.
    fn share_before(&self, index: usize) -> f64 {
        let Rule::Frenet(angles) = &self.rule else { return 0.5 };
        match (angles[index].bends, angles[index + 1].bends) {
            (false, true) => 1.0,
            (true, false) => 0.0,
            _ => 0.5,
        }
    }

    /// Angle about the path from the transported frame to that of the rule, radians.
    fn roll(&self, t: f64, side: Side) -> f64 {
        match &self.rule {
            Rule::RotationMinimizing => 0.0,
            Rule::Frenet(angles) => {
                angles[self.transport.piece(t, side)].at(&self.path, &self.transport, (t, side))
            }
            Rule::Up(up) => {
                let frame = self.transport.frame(&self.path, t, side);
                frame.angle_to(upright(*up, frame).side)
            }
        }
    }

    fn clamped(&self, t: f64) -> f64 {
        let domain = self.path.domain();
        t.clamp(domain.start, domain.end)
    }

    /// The frame at `t`, at a corner of the side before or after.
    #[must_use]
    pub fn at(&self, t: f64, side: Side) -> Frame {
        let t = self.clamped(t);
        let transported = self.transport.frame(&self.path, t, side);
        let frame = match &self.rule {
            Rule::RotationMinimizing => transported,
            Rule::Frenet(_) => transported.turned(self.roll(t, side)),
            Rule::Up(up) => upright(*up, transported),
        };
        let piece = self.transport.piece(t, side);
        frame.turned(self.turns.angle(piece, t, || self.transport.walked(&self.path, t)))
    }

    /// Turn about the path for each metre of it, radians, against a frame that does not turn; exactly zero where
    /// at this rate the whole path would turn by less than a billionth.
    #[must_use]
    pub fn turn_rate(&self, t: f64, side: Side) -> f64 {
        let t = self.clamped(t);
        let piece = self.transport.piece(t, side);
        let spread = self.turns.rate(piece, t, side);
        let own = match &self.rule {
            Rule::RotationMinimizing => 0.0,
            Rule::Frenet(angles) => angles[piece].rate(&self.path, &self.transport, (t, side)),
            Rule::Up(up) => {
                let jet = self.path.evaluate(t, side);
                let frame = upright(*up, self.transport.frame(&self.path, t, side));
                let bend = jet.second / jet.first.length_squared();
                up.cross(bend).dot(frame.up) / up.cross(frame.along).length()
            }
        };
        let rate = spread + own;
        if rate.is_finite() && rate.abs() * self.length() >= 1e-9 { rate } else { 0.0 }
    }

    /// Whether the frames nowhere turn about the path.
    #[must_use]
    pub fn steady(&self) -> bool {
        matches!(self.rule, Rule::RotationMinimizing) && self.turns.is_empty()
    }

    /// Turn about the path between two parameters of a smooth piece, radians.
    #[must_use]
    pub fn turn_between(&self, from: f64, to: f64) -> f64 {
        const STEPS: u32 = 4;
        let rolled = match &self.rule {
            Rule::RotationMinimizing => 0.0,
            _ => {
                let at = |k: u32| {
                    let side = if k == STEPS { Side::Before } else { Side::After };
                    self.roll(from + (to - from) * (f64::from(k) / f64::from(STEPS)), side)
                };
                (0..STEPS).map(|k| wrapped(at(k + 1) - at(k))).sum()
            }
        };
        let piece = self.transport.piece(from, Side::After);
        let turned = |t: f64| self.turns.angle(piece, t, || self.transport.walked(&self.path, t));
        rolled + (turned(to) - turned(from))
    }

    /// Parameters inside smooth pieces where the rate of turning jumps.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        self.turns.joints(&self.transport).collect()
    }

    /// The greatest turn for each metre found along the path, radians.
    #[must_use]
    pub fn greatest_turn_rate(&self) -> f64 {
        if self.steady() {
            return 0.0;
        }
        let stops = self.transport.pieces().flat_map(|stops| {
            let last = stops.len() - 1;
            let step = (stops.len() / 64).max(1);
            (0..stops.len())
                .filter(move |index| index % step == 0 || *index == last)
                .map(move |index| (stops[index].t, if index == last { Side::Before } else { Side::After }))
        });
        let joints = self.joints();
        let joints = joints.iter().flat_map(|t| [(*t, Side::Before), (*t, Side::After)]);
        stops.chain(joints).map(|(t, side)| self.turn_rate(t, side).abs()).fold(0.0, f64::max)
    }

    /// The share of the path's length up to a parameter, 0 to 1; exactly 0 and 1 at the ends.
    #[must_use]
    pub fn share(&self, t: f64) -> f64 {
        self.transport.walked(&self.path, self.clamped(t)) / self.length()
    }

    /// The parameter at a share of the path's length; exactly the ends at 0 and 1.
    #[must_use]
    pub fn parameter(&self, share: f64) -> f64 {
        let domain = self.path.domain();
        if share <= 0.0 {
            domain.start
        } else if share >= 1.0 {
            domain.end
        } else {
            self.transport.parameter(&self.path, share * self.length())
        }
    }
}

/// The frame with the same direction whose up is nearest to `up`; the frame itself where that runs along it.
fn upright(up: DVec3, frame: Frame) -> Frame {
    let side = up.cross(frame.along);
    if side.length() > 1e-9 { Frame::new(side, frame.along) } else { frame }
}

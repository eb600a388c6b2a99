//! One outline of a section: a curve, or several that it changes into along the path.

use glam::{DVec2, DVec3};

use super::change::Mix;
use super::matched::{Matched, Spot};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Jet, Side};

/// One closed or open line of a section, for each profile of a [`Change`](super::Change) a curve.
#[derive(Clone, Debug)]
pub struct Outline {
    curves: Vec<Matched>,
    closed: bool,
}

/// A point of a section at one place of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPoint {
    /// Position in the section's plane.
    pub place: DVec2,
    /// Direction along the section, of any length but zero.
    pub across: DVec2,
    /// Derivative of the position by the share of the path.
    pub rate: DVec2,
}

impl Outline {
    /// The same curve everywhere, under its own parameter.
    #[must_use]
    pub fn single(curve: AnyCurve) -> Self {
        let closed = curve.is_closed();
        Self { curves: vec![Matched::alone(curve)], closed }
    }

    /// At least one curve, all closed or all open; more than one share a parameter from 0 to 1.
    #[must_use]
    pub fn of(mut curves: Vec<AnyCurve>) -> Self {
        if curves.len() == 1 {
            return Self::single(curves.remove(0));
        }
        let closed = curves[0].is_closed();
        Self { curves: Matched::all(curves), closed }
    }

    /// Interval of its parameter.
    #[must_use]
    pub fn domain(&self) -> Domain {
        match self.curves.as_slice() {
            [only] => only.curve().domain(),
            _ => Domain { start: 0.0, end: 1.0 },
        }
    }

    /// Whether its end meets its start.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Place and derivatives of its first curve, for judging how it runs.
    #[must_use]
    pub fn first_jet(&self, u: f64, side: Side) -> Jet {
        if let [only] = self.curves.as_slice() {
            return only.curve().evaluate(u, side);
        }
        let spot = self.curves[0].spot(u, side);
        let flat = |vector: DVec2| DVec3::new(vector.x, vector.y, 0.0);
        Jet { point: flat(spot.point), first: flat(spot.across), second: DVec3::ZERO }
    }

    /// Number of curves.
    #[must_use]
    pub fn profiles(&self) -> usize {
        self.curves.len()
    }

    /// Where each curve stands at a parameter, at a joint from the named side.
    pub fn spots(&self, u: f64, side: Side) -> impl Iterator<Item = Spot> + '_ {
        self.curves.iter().map(move |curve| curve.spot(u, side))
    }

    /// The point at a parameter and a place of the path.
    #[must_use]
    pub fn at(&self, u: f64, side: Side, mix: &Mix) -> SectionPoint {
        let part = &self.curves[mix.first..mix.first + mix.count];
        SectionPoint::new(part.iter().map(|curve| curve.spot(u, side)), mix)
    }

    /// How far it reaches from the path's place, before factors, metres; of samples and joints.
    #[must_use]
    pub fn reach(&self) -> f64 {
        const SAMPLES: u32 = 64;
        let domain = self.domain();
        let samples = (0..=SAMPLES).map(|k| domain.at(f64::from(k) / f64::from(SAMPLES)));
        let places = samples.chain(self.joints()).flat_map(|u| self.spots(u, Side::Before));
        places.map(|spot| spot.point.length()).fold(0.0, f64::max)
    }

    /// Parameters strictly inside where the direction of any of its curves jumps.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        if let [only] = self.curves.as_slice() {
            return only.joints();
        }
        let mut all: Vec<f64> = self.curves.iter().flat_map(Matched::joints).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|next, last| *next - *last <= 1e-9);
        all
    }

    /// A bound on how far each of its curves leaves a chord; see [`Matched::chord_deviation`].
    #[must_use]
    pub fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curves.iter().map(|curve| curve.chord_deviation(from, to)).fold(0.0, f64::max)
    }

    /// The outline at one place of the path, as a curve.
    #[must_use]
    pub fn under<'a>(&'a self, mix: &'a Mix) -> Section<'a> {
        Section { outline: self, mix }
    }
}

impl SectionPoint {
    /// The mix of the spots that have a part in it.
    pub fn new(spots: impl Iterator<Item = Spot>, mix: &Mix) -> Self {
        let (mut point, mut across, mut rate) = (DVec2::ZERO, DVec2::ZERO, DVec2::ZERO);
        for ((spot, weight), change) in spots.zip(mix.weights).zip(mix.rates) {
            if weight == 1.0 && mix.count == 1 {
                (point, across) = (spot.point, spot.across);
                break;
            }
            point += spot.point * weight;
            across += spot.across * weight;
            rate += spot.point * change;
        }
        Self {
            place: point * mix.scale,
            across: scaled(across, mix),
            rate: point * mix.scale_rate + rate * mix.scale,
        }
    }
}

/// A direction under the factors. Where they are zero it is the direction that it comes from.
fn scaled(across: DVec2, mix: &Mix) -> DVec2 {
    let under = across * mix.scale;
    if under.length_squared() > 1e-24 * across.length_squared() {
        return under;
    }
    let vanishing = across * mix.scale_rate.abs();
    if mix.scale == DVec2::ZERO && vanishing != DVec2::ZERO { vanishing } else { across }
}

/// An outline at one place of the path.
#[derive(Clone, Copy, Debug)]
pub struct Section<'a> {
    outline: &'a Outline,
    mix: &'a Mix,
}

impl Curve for Section<'_> {
    fn domain(&self) -> Domain {
        self.outline.domain()
    }

    fn is_closed(&self) -> bool {
        self.outline.closed
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let flat = |vector: DVec2| DVec3::new(vector.x, vector.y, 0.0);
        let scale = flat(self.mix.scale);
        if let [only] = self.outline.curves.as_slice() {
            let jet = only.curve().evaluate(t, side);
            return Jet { point: jet.point * scale, first: jet.first * scale, second: jet.second * scale };
        }
        let at = |t: f64| self.outline.at(t, side, self.mix);
        let (here, step) = (at(t), 1e-5);
        let bend = (at(t + step).across - at(t - step).across) / (2.0 * step);
        Jet { point: flat(here.place), first: flat(here.across), second: flat(bend) }
    }

    fn point(&self, t: f64) -> DVec3 {
        let part = &self.outline.curves[self.mix.first..self.mix.first + self.mix.count];
        let place = match part {
            [only] => only.point(t),
            _ => part.iter().zip(self.mix.weights).map(|(curve, weight)| curve.point(t) * weight).sum(),
        };
        (place * self.mix.scale).extend(0.0)
    }

    fn joints(&self) -> Vec<f64> {
        self.outline.joints()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let weight: f64 = self.mix.weights.iter().map(|weight| weight.abs()).sum();
        self.outline.chord_deviation(from, to) * weight * self.mix.scale.max_element()
    }
}

//! Extrusions that turn and narrow, and revolutions that rise: sections that move.

use glam::{DVec2, DVec3};

use super::Builder;
use super::profile::{Profile, show};
use crate::geometry::curve::{AnyCurve, Curve as _, Polyline, Reversed};
use crate::geometry::planar::first_contact;
use crate::geometry::surface::{Carry, Change, FrameRule, Law, Screw, Stations};
use crate::geometry::tessellate::{Route, Station, Sweep};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{self, Factor};
use crate::model::Recipe;

/// An extrusion whose section turns or changes its size on the way up; none if it does neither.
pub(super) fn moving_extrusion(
    extrude: &spec::Extrude,
    (outlines, islands): (&[AnyCurve], &[usize]),
) -> Option<Sweep> {
    let taper = extrude.taper.as_ref().map_or(DVec2::ONE, |taper| {
        let Factor(factor) = taper.value;
        factor
    });
    let twist = extrude.twist.value;
    if taper == DVec2::ONE && twist == 0.0 {
        return None;
    }
    let height = extrude.height.value;
    let bottom = if extrude.centered.value { -height / 2.0 } else { 0.0 };
    let ends = vec![DVec3::Z * bottom, DVec3::Z * (bottom + height)];
    let path = AnyCurve::Polyline(Polyline::new(ends, false)?);
    let scale = if taper == DVec2::ONE {
        Law::One
    } else {
        Law::Stations(Stations::linear(&[(0.0, DVec2::ONE), (1.0, taper)]))
    };
    Some(Sweep {
        outlines: outlines.iter().map(|outline| vec![outline.clone()]).collect(),
        islands: islands.to_vec(),
        change: Change::of_scale(scale),
        route: Route::Path { path, carry: Carry { rule: FrameRule::Up(DVec3::Y), twist } },
        caps: extrude.caps.value,
    })
}

impl Builder<'_> {
    /// A profile that rises while it turns from an angle on.
    pub(super) fn screw(
        &mut self,
        revolve: &spec::Revolve,
        (profile, start): (Profile, f64),
    ) -> Option<Recipe> {
        self.check_off_axis(&profile)?;
        self.check_turns(revolve, &profile);
        let curve = if profile.curve.is_closed() || faces_outward(&profile) {
            profile.curve
        } else {
            AnyCurve::Reversed(Reversed::new(profile.curve))
        };
        let screw = Screw { start, angle: revolve.angle.value, rise: revolve.rise.value };
        Some(Recipe::Sweep(Sweep {
            outlines: vec![vec![curve]],
            islands: vec![1],
            change: Change::constant(),
            route: Route::Screw(screw),
            caps: revolve.caps.value,
        }))
    }

    /// What runs along the axis would glide along itself and sweep no surface.
    fn check_off_axis(&mut self, profile: &Profile) -> Option<()> {
        let near = 1e-9 * profile.size;
        let on_axis = |pair: &[Station]| pair[0].point.x <= near && pair[1].point.x <= near;
        let Some(index) = profile.stations.windows(2).position(on_axis) else { return Some(()) };
        let (from, to) = (profile.stations[index].point, profile.stations[index + 1].point);
        let message = format!(
            "a profile that rises must not run along the axis, but this one does from y = {} to y = {}",
            show(from.y),
            show(to.y)
        );
        let report = Diagnostic::error(Code::AlongAxis, message)
            .at(profile.span, "runs along the axis")
            .help("end an open profile where it meets the axis, or keep a closed one at x > 0");
        self.report(report);
        None
    }

    /// Warns where one turn reaches into the next.
    fn check_turns(&mut self, revolve: &spec::Revolve, profile: &Profile) {
        // Turns that only touch do not cut each other.
        const APART: f64 = 1.0 + 1e-6;
        if revolve.angle.value < 360.0 || !profile.curve.is_closed() {
            return;
        }
        let rise = revolve.rise.value * 360.0 / revolve.angle.value;
        let here = profile.places();
        let there: Vec<DVec2> = here.iter().map(|place| *place + DVec2::Y * (rise * APART)).collect();
        if first_contact(&[here, there]).is_none() {
            return;
        }
        let ys = || profile.stations.iter().map(|station| station.point.y);
        let height = ys().fold(f64::NEG_INFINITY, f64::max) - ys().fold(f64::INFINITY, f64::min);
        let message = format!(
            "each turn reaches into the next: one turn rises by {}, and the profile is {} high",
            show(rise.abs()),
            show(height)
        );
        let report = Diagnostic::warning(Code::TurnsMeet, message)
            .at(revolve.rise.span, "too little for this profile")
            .also(profile.span, "the profile")
            .help("raise `rise`, lower `angle`, or make the profile lower");
        self.report(report);
    }
}

/// Whether the right of an open profile looks away from the axis: by the area between it and the axis.
fn faces_outward(profile: &Profile) -> bool {
    let twice_area: f64 = (profile.stations.windows(2))
        .map(|pair| (pair[0].point.x + pair[1].point.x) * (pair[1].point.y - pair[0].point.y))
        .sum();
    twice_area >= 0.0
}

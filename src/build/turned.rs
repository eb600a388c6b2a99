//! Profiles turned about a line of their plane.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::Builder;
use super::profile::{Profile, show};
use crate::geometry::curve::{AnyCurve, Transformed};
use crate::geometry::tessellate::Revolution;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Axis};
use crate::model::Recipe;

/// A profile brought to the right of the y axis.
struct Turned {
    profile: Profile,
    /// First angle.
    start: f64,
    /// The map that brings what is made back to the written axis.
    back: DAffine3,
}

impl Builder<'_> {
    /// A turned profile about the y axis, and the map that brings it to its own.
    pub(super) fn revolution(&mut self, revolve: &spec::Revolve) -> Option<(Recipe, DAffine3)> {
        let turned = match &revolve.axis {
            Some(axis) => self.about(revolve, axis)?,
            None => Turned {
                profile: self.axial_profile(&revolve.profile)?,
                start: revolve.start.value,
                back: DAffine3::IDENTITY,
            },
        };
        let recipe = if revolve.rise.value == 0.0 {
            Recipe::Revolution(Revolution {
                profile: turned.profile.curve,
                start: turned.start,
                angle: revolve.angle.value,
                caps: revolve.caps.value,
            })
        } else {
            self.screw(revolve, (turned.profile, turned.start))?
        };
        Some((recipe, turned.back))
    }

    /// A profile beside any axis, brought to the y axis. One that lies to the left turns about the opposite direction,
    /// backwards: from the end of its turn to the start.
    fn about(&mut self, revolve: &spec::Revolve, axis: &Axis) -> Option<Turned> {
        let (curve, span) = (self.curve_of(&revolve.profile)?, revolve.profile.span());
        let written = self.profile_of(curve, "profile", span)?;
        let direction = axis.direction.normalize();
        let left = self.lies_left(&written, &Axis { direction, ..*axis }, span)?;
        let up = if left { -direction } else { direction };
        let matrix = DMat3::from_cols(DVec3::new(up.y, up.x, 0.0), DVec3::new(-up.x, up.y, 0.0), DVec3::Z);
        let there = DAffine3 { matrix3: matrix, translation: -(matrix * axis.point.extend(0.0)) };
        let moved = AnyCurve::Transformed(Transformed::new(written.curve, there));
        let profile = self.profile_of(moved, "profile", span)?;
        let back = there.inverse();
        let (start, angle) = (revolve.start.value, revolve.angle.value);
        Some(if left {
            let back = back * DAffine3::from_translation(DVec3::NEG_Y * revolve.rise.value);
            Turned { profile, start: -(start + angle), back }
        } else {
            Turned { profile, start, back }
        })
    }

    /// Whether a profile lies to the left of its axis; it must lie on one side, and not on the axis itself.
    fn lies_left(&mut self, profile: &Profile, axis: &Axis, span: Span) -> Option<bool> {
        let right = DVec2::new(axis.direction.y, -axis.direction.x);
        let away = profile.stations.iter().map(|station| (station.point.truncate() - axis.point).dot(right));
        let (low, high) = away.fold((0.0_f64, 0.0_f64), |(low, high), away| (low.min(away), high.max(away)));
        let near = 1e-9 * profile.size;
        if low < -near && high > near {
            let message = format!(
                "the profile crosses the axis: it reaches {} to the right of it and {} to the left",
                show(high),
                show(-low)
            );
            let report = Diagnostic::error(Code::AcrossAxis, message)
                .at(span, "must lie on one side of the axis")
                .help("move the profile or the axis; a profile may end on the axis");
            self.report(report);
            return None;
        }
        if low >= -near && high <= near {
            return self.refuse(Code::NoArea, "the profile lies on the axis", span, "sweeps no surface");
        }
        Some(low < -near)
    }
}

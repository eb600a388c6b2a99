//! What profiles must satisfy before they are turned, pushed or carried.

use glam::DVec2;

use super::Builder;
use crate::geometry::curve::{AnyCurve, Curve as _};
use crate::geometry::number::Bounds;
use crate::geometry::planar::{Contact, Crossing, encloses, first_contact, first_crossing};
use crate::geometry::tessellate::{Density, Station, discretize};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::CurveReference;

/// A profile and points along it, close enough to judge it by.
pub(super) struct Profile {
    pub(super) curve: AnyCurve,
    pub(super) stations: Vec<Station>,
    pub(super) size: f64,
    pub(super) span: Span,
    /// As messages name it.
    pub(super) name: String,
}

/// Most chords with which a profile is judged.
const CHORDS: u64 = 1 << 20;

impl Builder<'_> {
    /// A flat profile that does not cross itself.
    pub(super) fn profile(&mut self, reference: &CurveReference, what: &str) -> Option<Profile> {
        let curve = self.curve_of(reference)?;
        self.profile_of(curve, what, reference.span())
    }

    /// A curve as a flat profile that does not cross itself.
    pub(super) fn profile_of(&mut self, curve: AnyCurve, what: &str, span: Span) -> Option<Profile> {
        let rough: Vec<_> = discretize(&curve, Density::Count(64), CHORDS).ok()?;
        let bounds = Bounds::of_points(rough.iter().map(|station| station.point));
        let size = bounds.diagonal();
        let Ok(stations) = discretize(&curve, Density::Tolerance(size / 4000.0), CHORDS) else {
            return self.refuse(
                Code::LimitPassed,
                &format!("the {what} is too intricate"),
                span,
                "too many bends",
            );
        };
        if let Some(station) = stations.iter().find(|station| station.point.z.abs() > 1e-9 * size) {
            let message = format!("the {what} is not flat: it reaches z = {}", show(station.point.z));
            return self.refuse(Code::NotFlat, &message, span, "must lie in the x, y plane");
        }
        let profile = Profile { curve, stations, size, span, name: what.to_owned() };
        match profile.crossing() {
            Some(crossing) => self.crossed(&profile, what, &crossing),
            None => Some(profile),
        }
    }

    /// A profile that is closed.
    pub(super) fn closed_profile(&mut self, reference: &CurveReference, what: &str) -> Option<Profile> {
        let profile = self.profile(reference, what)?;
        if profile.curve.is_closed() { Some(profile) } else { self.open_profile(&profile, what) }
    }

    /// A curve as a profile that is closed.
    pub(super) fn closed_profile_of(&mut self, curve: AnyCurve, what: &str, span: Span) -> Option<Profile> {
        let profile = self.profile_of(curve, what, span)?;
        if profile.curve.is_closed() { Some(profile) } else { self.open_profile(&profile, what) }
    }

    /// Refuses a profile because it is open.
    pub(super) fn open_profile<T>(&mut self, profile: &Profile, what: &str) -> Option<T> {
        let (start, end) = (profile.stations[0].point, profile.stations[profile.stations.len() - 1].point);
        let message = format!("the {what} must be closed; its ends are {} apart", show(start.distance(end)));
        let report = Diagnostic::error(Code::OpenProfile, message)
            .at(profile.span, format!("from {} to {}", place(start.truncate()), place(end.truncate())))
            .help("write `closed = true`, end an SVG subpath with Z, or end the curve where it starts");
        self.report(report);
        None
    }

    /// A profile on one side of the y axis.
    pub(super) fn axial_profile(&mut self, reference: &CurveReference) -> Option<Profile> {
        let profile = self.profile(reference, "profile")?;
        let least = profile.stations.iter().min_by(|a, b| a.point.x.total_cmp(&b.point.x))?;
        if least.point.x < -1e-9 * profile.size {
            let message = format!(
                "the profile crosses the axis: x is {} at y = {}",
                show(least.point.x),
                show(least.point.y)
            );
            let report = Diagnostic::error(Code::AcrossAxis, message)
                .at(profile.span, "x is the radius and must not be negative")
                .help("move the points to x >= 0; a profile that ends on the axis ends at x = 0");
            self.report(report);
            return None;
        }
        if profile.stations.iter().all(|station| station.point.x <= 1e-9 * profile.size) {
            return self.refuse(
                Code::NoArea,
                "the profile lies on the axis",
                profile.span,
                "sweeps no surface",
            );
        }
        Some(profile)
    }

    /// Holes must lie inside their outline and apart from each other.
    pub(super) fn check_holes(&mut self, outline: &Profile, holes: &[&Profile]) -> Option<()> {
        let outlines: Vec<&Profile> = std::iter::once(outline).chain(holes.iter().copied()).collect();
        let places: Vec<Vec<DVec2>> = outlines.iter().map(|profile| profile.places()).collect();
        let name = |index: usize| &outlines[index].name;
        let help = "holes lie inside the outline and apart from each other";
        if let Some(Contact { first, second, point }) = meeting(&outlines, &places) {
            let message = format!("{} meets {} near {}", name(second), name(first), place(point));
            let report = Diagnostic::error(Code::BadHole, message)
                .at(outlines[second].span, "this hole")
                .also(outlines[first].span, if first == 0 { "the outline" } else { "the other hole" })
                .help(help);
            self.report(report);
            return None;
        }
        for index in 1..outlines.len() {
            let start = places[index][0];
            let around = (1..index).find(|other| encloses(&places[*other], start));
            let inside = (1..index).find(|other| encloses(&places[index], places[*other][0]));
            let swallowed = encloses(&places[index], places[0][0]);
            let message = match (encloses(&places[0], start), around, inside) {
                (false, ..) if swallowed => format!("{} lies around the outline", name(index)),
                (false, ..) => format!("{} lies outside of the outline", name(index)),
                (_, Some(other), _) => format!("{} lies inside {}", name(index), name(other)),
                (_, _, Some(other)) => format!("{} lies around {}", name(index), name(other)),
                _ => continue,
            };
            let report = Diagnostic::error(Code::BadHole, message).at(outlines[index].span, "this hole");
            self.report(report.also(outline.span, "the outline").help(help));
            return None;
        }
        Some(())
    }

    fn crossed(&mut self, profile: &Profile, what: &str, crossing: &Crossing) -> Option<Profile> {
        let t = |segment: usize| profile.stations[segment].t;
        let message = format!("the {what} crosses itself near {}", place(crossing.point));
        let report = Diagnostic::error(Code::SelfCrossing, message)
            .at(profile.span, "crosses itself")
            .note(format!("at parameters {} and {}", show(t(crossing.first)), show(t(crossing.second))));
        self.report(report);
        None
    }

    pub(super) fn refuse<T>(&mut self, code: Code, message: &str, span: Span, label: &str) -> Option<T> {
        self.report(Diagnostic::error(code, message).at(span, label));
        None
    }
}

impl Profile {
    fn crossing(&self) -> Option<Crossing> {
        first_crossing(&self.places(), self.curve.is_closed())
    }

    /// Points along it, the end of a closed one left out.
    pub(super) fn places(&self) -> Vec<DVec2> {
        flat(&self.stations, self.curve.is_closed())
    }
}

fn flat(stations: &[Station], closed: bool) -> Vec<DVec2> {
    let used = stations.len() - usize::from(closed);
    stations[..used].iter().map(|station| station.point.truncate()).collect()
}

/// Two outlines that cross or touch; `places` are points along them.
pub(super) fn meeting(outlines: &[&Profile], places: &[Vec<DVec2>]) -> Option<Contact> {
    first_contact(places).and_then(|contact| confirmed(outlines, &contact))
}

/// A contact that is still there when both outlines are cut a thousand times finer: chords may meet where the
/// curves come close.
fn confirmed(outlines: &[&Profile], contact: &Contact) -> Option<Contact> {
    let finer = |index: usize| {
        let profile = outlines[index];
        let stations = discretize(&profile.curve, Density::Tolerance(profile.size / 4e6), CHORDS).ok()?;
        Some(flat(&stations, true))
    };
    let pair = [finer(contact.first)?, finer(contact.second)?];
    first_contact(&pair).map(|found| Contact { point: found.point, ..*contact })
}

/// A number for a message, to six digits.
pub(super) fn show(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    rounded.to_string()
}

pub(super) fn place(point: DVec2) -> String {
    format!("[{}, {}]", show(point.x), show(point.y))
}

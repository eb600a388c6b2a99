//! Sweeps into recipes, and what their paths and profiles must satisfy.

use glam::DVec2;

use super::Builder;
use super::profile::{Profile, show};
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::{atan2, sin_cos_degrees};
use crate::geometry::surface::{Carry, Change};
use crate::geometry::tessellate::{Route, Sweep};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Blend, CurveReference};
use crate::model::Recipe;

/// Profiles with where they stand.
struct Profiles {
    stations: Vec<f64>,
    profiles: Vec<Profile>,
}

/// Degrees by which corners may turn.
const STEEPEST: f64 = 170.0;

impl Builder<'_> {
    pub(super) fn sweep(&mut self, sweep: &spec::Sweep) -> Option<Recipe> {
        let profiles = self.profiles(sweep);
        let holes: Vec<_> = (sweep.holes.iter().enumerate())
            .map(|(index, hole)| {
                let profile = self.closed_profile(hole, "hole")?;
                Some(Profile { name: format!("`holes[{index}]`"), ..profile })
            })
            .collect();
        let holes: Option<Vec<Profile>> = holes.into_iter().collect();
        let path = self.curve_of(&sweep.path);
        let scale = self.law(sweep.scale.as_ref(), sweep.blend.value);
        let (mut profiles, holes, path, scale) = (profiles?, holes?, path?, scale?);
        let outline = &mut profiles.profiles[0];
        "the outline".clone_into(&mut outline.name);
        if !holes.is_empty() {
            if !outline.curve.is_closed() {
                return self.open_profile(outline, "outline");
            }
            self.check_holes(outline, &holes.iter().collect::<Vec<_>>())?;
        }
        self.check_path(&path, sweep.path.span())?;
        let carry = self.carry((&sweep.frame, sweep.up.as_ref()), (&path, &sweep.path), sweep.twist.value)?;
        let smooth = sweep.blend.value == Blend::Smooth;
        let change = Change::new(profiles.stations.clone(), smooth, scale);
        self.check_seam(sweep, (&profiles, &holes), (&path, &carry), &change)?;
        let mut outlines = vec![profiles.profiles.into_iter().map(|profile| profile.curve).collect()];
        outlines.extend(holes.into_iter().map(|hole| vec![hole.curve]));
        let islands = vec![outlines.len()];
        let shape =
            Sweep { outlines, islands, change, route: Route::Path { path, carry }, caps: sweep.caps.value };
        self.check_overlap(&shape, sweep.path.span());
        Some(Recipe::Sweep(shape))
    }

    fn profiles(&mut self, sweep: &spec::Sweep) -> Option<Profiles> {
        let Some(stations) = &sweep.profiles else {
            let profile = self.profile(sweep.profile.as_ref()?, "profile")?;
            return Some(Profiles { stations: vec![0.0], profiles: vec![profile] });
        };
        let curves: Vec<&CurveReference> = stations.iter().map(|station| &station.curve).collect();
        let built: Vec<_> = curves.iter().map(|curve| self.profile(curve, "profile")).collect();
        let built: Vec<Profile> = built.into_iter().collect::<Option<_>>()?;
        let closed = |profile: &Profile| profile.curve.is_closed();
        if let Some(odd) = built.iter().find(|profile| closed(profile) != closed(&built[0])) {
            let word = |profile: &Profile| if closed(profile) { "closed" } else { "open" };
            let message = format!(
                "the profiles of a sweep must be all closed or all open, but this one is {} and the first is {}",
                word(odd),
                word(&built[0])
            );
            let report = Diagnostic::error(Code::MixedProfiles, message)
                .at(odd.span, word(odd))
                .also(built[0].span, word(&built[0]))
                .help("a section cannot open on its way: close the open profile, or open the closed ones at one point");
            self.report(report);
            return None;
        }
        let last = (built.len() - 1).max(1) as f64;
        let place = |(index, station): (usize, &spec::ProfileStation)| {
            station.at.map_or(index as f64 / last, |at| at.value)
        };
        Some(Profiles { stations: stations.iter().enumerate().map(place).collect(), profiles: built })
    }

    /// A path must not turn back: there the section would have no plane to stand in.
    fn check_path(&mut self, path: &AnyCurve, span: Span) -> Option<()> {
        let Some((turn, place)) = reversal(path) else { return Some(()) };
        let message = format!("the path turns back by {turn:.1} degrees at parameter {}", show(place));
        let report = Diagnostic::error(Code::Reversal, message)
            .at(span, format!("corners may turn by up to {STEEPEST} degrees"))
            .help("round the corner with an arc or a spline");
        self.report(report);
        None
    }

    /// On a closed path the last section must lie on the first.
    fn check_seam(
        &mut self,
        sweep: &spec::Sweep,
        (profiles, holes): (&Profiles, &[Profile]),
        (path, carry): (&AnyCurve, &Carry),
        change: &Change,
    ) -> Option<()> {
        if !path.is_closed() {
            return Some(());
        }
        let (first, last) = (change.mix(0.0, Side::After), change.mix(1.0, Side::Before));
        let help = "where a closed path ends, the section must be what it was at the start";
        if (first.scale - last.scale).abs().max_element() > 1e-9 {
            let message = format!(
                "the section begins with the factor {} and comes back with {}",
                factor(first.scale),
                factor(last.scale)
            );
            let span = sweep.scale.as_ref().map_or(sweep.path.span(), |scale| scale.span);
            self.report(
                Diagnostic::error(Code::UnmetSeam, message).at(span, "does not come back").help(help),
            );
            return None;
        }
        let (one, other) = (&profiles.profiles[first.first], &profiles.profiles[last.first + last.count - 1]);
        if one.curve != other.curve {
            let report = Diagnostic::error(Code::UnmetSeam, "the section comes back as another profile");
            self.report(report.at(other.span, "the last profile").also(one.span, "the first").help(help));
            return None;
        }
        let turn = carry.twist % 360.0;
        let odd = std::iter::once(one).chain(holes).find(|profile| !comes_back(profile, turn, first.scale));
        let Some(odd) = odd else { return Some(()) };
        let message = format!(
            "after a twist of {} degrees the profile does not come back to itself where the closed path ends",
            show(carry.twist)
        );
        let report = Diagnostic::error(Code::UnmetSeam, message)
            .at(sweep.twist.span, "does not come back")
            .also(odd.span, "this profile")
            .help(
                "write whole turns, a multiple of 360; a square fits after 90 degrees too, a strip after 180",
            );
        self.report(report);
        None
    }
}

fn factor(factor: DVec2) -> String {
    if factor.x == factor.y { show(factor.x) } else { format!("[{}, {}]", show(factor.x), show(factor.y)) }
}

/// Whether a profile under factors lies on itself after a turn about the origin, by degrees. Its points are close
/// enough together for chords between them.
fn comes_back(profile: &Profile, degrees: f64, scale: DVec2) -> bool {
    if degrees == 0.0 {
        return true;
    }
    let (sin, cos) = sin_cos_degrees(degrees);
    let places: Vec<DVec2> =
        profile.stations.iter().map(|station| station.point.truncate() * scale).collect();
    let turned = |place: DVec2| DVec2::new(place.x * cos - place.y * sin, place.x * sin + place.y * cos);
    // Points stand on the profile within size / 4000.
    let near = profile.size / 1000.0;
    let distance = |place: DVec2| {
        places.windows(2).map(|pair| to_segment(place, (pair[0], pair[1]))).fold(f64::INFINITY, f64::min)
    };
    let step = places.len().div_ceil(512);
    places.iter().step_by(step).all(|place| distance(turned(*place)) <= near)
}

fn to_segment(place: DVec2, (start, end): (DVec2, DVec2)) -> f64 {
    let along = end - start;
    let part = (place - start).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    place.distance(start + along * part.clamp(0.0, 1.0))
}

/// The degrees and the parameter of the first place at which a path turns back: a corner, or where it slows down to
/// nothing and goes on the other way.
fn reversal(path: &AnyCurve) -> Option<(f64, f64)> {
    /// Places of a piece that are looked at; between two of them it may turn by half a circle without being missed.
    const PLACES: usize = 8;
    /// The share of the domain in which a turn counts as a corner.
    const CORNER: f64 = 1e-6;
    let turn = |from: (f64, Side), to: (f64, Side)| {
        let (before, after) = (path.direction(from.0, from.1), path.direction(to.0, to.1));
        atan2(before.cross(after).length(), before.dot(after)).to_degrees()
    };
    let corner = |(end, start): (f64, f64)| {
        let turn = turn((end, Side::Before), (start, Side::After));
        (turn > STEEPEST).then_some((turn, start))
    };
    let domain = path.domain();
    let mut ends = vec![domain.start];
    ends.extend(path.breaks());
    ends.push(domain.end);
    let within = |from: f64, to: f64| {
        let (mut from, mut to) = (from, to);
        while turn((from, Side::After), (to, Side::Before)) > 90.0 {
            let middle = f64::midpoint(from, to);
            if to - from <= CORNER * domain.span() || middle <= from || middle >= to {
                return corner((from, to));
            }
            if let Some(found) = corner((middle, middle)) {
                return Some(found);
            }
            let first = turn((from, Side::After), (middle, Side::Before));
            let second = turn((middle, Side::After), (to, Side::Before));
            (from, to) = if first >= second { (from, middle) } else { (middle, to) };
        }
        None
    };
    let seam = path.is_closed().then(|| corner((domain.end, domain.start))).flatten();
    let mut parts = ends.windows(2).flat_map(|pair| {
        let place = move |k: usize| pair[0] + (pair[1] - pair[0]) * k as f64 / PLACES as f64;
        (0..PLACES).map(move |k| (place(k), if k + 1 == PLACES { pair[1] } else { place(k + 1) }))
    });
    let found = parts.find_map(|(from, to)| {
        let at = if from > domain.start { corner((from, from)) } else { None };
        at.or_else(|| within(from, to))
    });
    found.or(seam)
}

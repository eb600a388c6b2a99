//! Sweeps: profiles along curves.

use glam::DVec3;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::scaling::{Blend, Scaling, increasing};
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// A profile drawn along a curve: x of the profile runs to the side, y up.
    "sweep" pub Sweep {
        /// The profile: the name of a curve, or a curve in place.
        profile: Option<CurveReference>;
        /// Instead of one profile several, all closed or all open: `[{ at = 0, curve = "a" }, { at = 1, curve = "b" }]`, or
        /// a list of curves that stand at even distances. Between them the section changes from one to the next:
        /// corner to corner where all have equally many, else by length.
        profiles: Option<Sp<Vec<ProfileStation>>> => Check::items(1);
        /// Closed curves inside a closed profile that are left open: a tube is a circle with a hole.
        holes: Vec<CurveReference> = Vec::new();
        /// The curve that it is drawn along.
        path: CurveReference;
        /// How the profile is carried along the path.
        frame: Sp<Frame> = Frame::RotationMinimizing;
        /// With `frame = "up"`, the direction; the document's own up when it is not written. The path must not run along
        /// it.
        up: Option<Sp<DVec3>>;
        /// How far the profile turns about the path from start to end, in degrees. On a closed path it must come back to
        /// itself.
        twist: Sp<f64> = 0.0 => Check::within(-1e6, 1e6);
        /// How large the profile is along the path: `0.5` shrinks evenly to a half at the end, `[1, 2, 0]` has factors at
        /// even distances, `[{ at = 0.2, factor = [1, 0.5] }, ...]` at given shares of the length, and a curve has the
        /// share as x, from 0 to 1, and the factor as y. At 0 the section is a point.
        scale: Option<Sp<Scaling>>;
        /// How `scale` and `profiles` go from one station to the next.
        blend: Sp<Blend> = Blend::Linear;
        /// Whether both ends are closed with flat caps, so that the result is a solid.
        caps: Sp<bool> = true;
    }
    checked check
}

choices! {
    /// How a profile is carried along a path.
    Frame {
        /// It turns about the path no more than the path itself makes it.
        RotationMinimizing = "rotation-minimizing";
        /// Its x looks to the center of the bend. After an inflection it looks from the center, so that nothing jumps;
        /// straight parts turn evenly from the bend before to the one after.
        Frenet = "frenet";
        /// Its y is as near to the direction of `up` as can be: for handrails, roads, mouldings.
        Up = "up";
    }
}

/// One of several profiles.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileStation {
    /// Where it stands, where that is written.
    pub at: Option<Sp<f64>>,
    /// The profile.
    pub curve: CurveReference,
}

table! {
    /// A profile at one place of the path.
    "profile station" pub(crate) StationFields {
        /// Where it stands: 0 at the start of the path, 1 at the end, by length.
        at: Sp<f64> => Check::within(0.0, 1.0);
        /// The profile: the name of a curve, or a curve in place.
        curve: CurveReference;
    }
}

impl Read for ProfileStation {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::Table(table) if table.get("curve").is_some() || table.get("at").is_some() => {
                let fields = StationFields::read(value, reader)?;
                Some(Self { at: Some(fields.at), curve: fields.curve })
            }
            _ => Some(Self { at: None, curve: CurveReference::read(value, reader)? }),
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![StationFields::schema(schemas), CurveReference::schema(schemas)])
    }
}

/// `up` goes with frames that look up, and is a direction.
pub(super) fn check_up(frame: &Sp<Frame>, up: Option<&Sp<DVec3>>, reader: &mut Reader<'_>) -> bool {
    let Some(up) = up else { return true };
    if frame.value != Frame::Up {
        let message = format!("`up` has no meaning with `frame = \"{}\"`", frame.text());
        let report = Diagnostic::error(Code::Conflict, message)
            .at(up.span, "only for frame = \"up\"")
            .help("write `frame = \"up\"`, or leave `up` out");
        reader.report(report);
        return false;
    }
    if up.value == DVec3::ZERO {
        let report = Diagnostic::error(Code::OutOfRange, "`up` must not be [0, 0, 0]");
        reader.report(report.at(up.span, "no direction"));
        return false;
    }
    true
}

impl Sweep {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let up = check_up(&self.frame, self.up.as_ref(), reader);
        let profiles = self.check_profiles(span, reader);
        up && profiles
    }

    fn check_profiles(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let profiles = match (&self.profile, &self.profiles) {
            (Some(_), None) => return true,
            (None, Some(profiles)) => profiles,
            (None, None) => {
                let report = Diagnostic::error(Code::MissingField, "missing field `profile` of sweep");
                reader.report(report.at(span, "needs `profile`"));
                return false;
            }
            (Some(profile), Some(profiles)) => {
                let message = "a sweep has either `profile` or `profiles`";
                let report = Diagnostic::error(Code::Conflict, message)
                    .at(profiles.span, "several profiles")
                    .also(profile.span(), "one profile");
                reader.report(report);
                return false;
            }
        };
        if !self.holes.is_empty() {
            let report =
                Diagnostic::error(Code::Conflict, "`holes` go with one `profile`, not with `profiles`");
            reader.report(report.at(self.holes[0].span(), "a hole").also(profiles.span, "several profiles"));
            return false;
        }
        let placed = profiles.iter().filter(|station| station.at.is_some()).count();
        if placed != 0 && placed != profiles.len() {
            let message = "either every profile says `at`, or none does";
            let bare = profiles.iter().find(|station| station.at.is_none());
            let span = bare.map_or(profiles.span, |station| station.curve.span());
            reader.report(Diagnostic::error(Code::MissingField, message).at(span, "without `at`"));
            return false;
        }
        increasing(profiles.iter().filter_map(|station| station.at), reader)
    }
}

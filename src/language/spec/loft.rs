//! Surfaces through a row of profiles.

use glam::DVec3;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::point::{Point, Scale};
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// A surface through a row of profiles: hulls, bottles, handles, horns.
    "loft" pub Loft {
        /// The profiles in their order: for each the name of a curve, a curve in place, a curve with a placement
        /// (`{ curve = "rib", at = [0, 0, 1] }`), or at either end a point `[x, y, z]` for a tip. All are open or all are
        /// closed; they may be of different kinds and have different numbers of points.
        profiles: Vec<Sp<Profile>> => Check::items(2);
        /// How the surface goes from profile to profile.
        across: Sp<Across> = Across::Smooth;
        /// How a smooth surface begins at the first profile: `"natural"` (without bend: the second derivative is 0),
        /// `"not-a-knot"` (the first two pieces are one cubic), `"straight"` (at right angles to the profile, which must be
        /// flat), `"round"` (from a tip in all directions, so that it is smooth like the end of an egg), or
        /// `{ first = [x, y, z] }`: the direction in which it leaves; its length is 1 for the even speed, and the longer it is,
        /// the longer the surface keeps to it.
        start: Sp<LoftEnd> = LoftEnd::Natural;
        /// How it ends at the last profile, in the same words; the direction of `first` is that in which it arrives.
        end: Sp<LoftEnd> = LoftEnd::Natural;
        /// Whether it goes on from the last profile back to the first.
        closed: Sp<bool> = false;
        /// Which points of the profiles belong together.
        matching: Sp<Matching> = Matching::Auto;
        /// Whether each profile is begun, and turned around, so that it lies as close as can be to the one before. Otherwise
        /// the profiles' own starts are joined.
        align: Sp<bool> = true;
        /// Whether the first and the last profile are closed with flat faces where the profiles are closed, so that the
        /// result is a solid. They must be flat for that.
        caps: Sp<bool> = true;
    }
    checked check
}

choices! {
    /// How a surface goes from profile to profile.
    Across {
        /// In one smooth sweep: a cubic spline through all.
        Smooth = "smooth";
        /// Straight from each to the next, with an edge along each.
        Linear = "linear";
    }
}

choices! {
    /// Which points of profiles belong together.
    Matching {
        /// Corner to corner where all profiles have as many, else by their lengths.
        Auto = "auto";
        /// Corner to corner, and between two corners by their lengths.
        Corners = "corners";
        /// Points at the same share of the length.
        Length = "length";
        /// Points at the same share of the parameters: of two polylines of as many points, point to point.
        Parameter = "parameter";
    }
}

table! {
    /// A profile at its place: the curve, scaled, then rotated, then moved.
    "profile" pub PlacedProfile {
        /// The curve: its name, or a curve in place.
        curve: CurveReference;
        /// Factor of size: a number, or one for each axis.
        scale: Sp<Scale> = Scale(DVec3::ONE) => Check::nonzero();
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
    }
}

/// How a smooth loft begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoftEnd {
    /// The second derivative is zero.
    Natural,
    /// The two pieces next to the end are one cubic.
    NotAKnot,
    /// At right angles to the profile.
    Straight,
    /// From a tip in all directions.
    Round,
    /// The derivative by the average way.
    First(Sp<DVec3>),
}

const ENDS: [&str; 4] = ["natural", "not-a-knot", "straight", "round"];

impl Read for LoftEnd {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if !matches!(value.data, Data::Table(_)) {
            return Some(match choice(value, &ENDS, reader)? {
                "not-a-knot" => Self::NotAKnot,
                "straight" => Self::Straight,
                "round" => Self::Round,
                _ => Self::Natural,
            });
        }
        let mut fields = Fields::open(value, "loft end", reader)?;
        let first = fields.take::<Sp<DVec3>>("first", None, Check::ANY, reader);
        if !fields.close(reader) {
            return None;
        }
        let first = first?;
        if first.value != DVec3::ZERO {
            return Some(Self::First(first));
        }
        let message = "the direction in which a surface leaves a profile must not be zero";
        reader.report(Diagnostic::error(Code::Degenerate, message).at(first.span, "no direction"));
        None
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&ENDS);
        let doc = "How a loft leaves or reaches a profile: its first derivative.";
        alternatives.push(schemas.object("loft end", doc, |object, schemas| {
            object.field::<Sp<DVec3>>("first", "The direction.", None, Check::ANY, schemas);
        }));
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        matches!(self, Self::Natural).then(|| Json::from(ENDS[0]))
    }
}

impl Loft {
    /// Ends are shaped only where there are ends that are shaped.
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (name, end) in [("start", self.start), ("end", self.end)] {
            let plain = if self.closed.value {
                Some(("a closed loft has no ends", self.closed.span))
            } else if self.across.value == Across::Linear {
                Some(("a loft goes straight from profile to profile", self.across.span))
            } else {
                None
            };
            let Some((reason, span)) = plain.filter(|_| end.value != LoftEnd::Natural) else { continue };
            let message = format!("{reason}, so `{name}` has nothing to shape");
            let report = Diagnostic::error(Code::Conflict, message).at(end.span, "without effect");
            reader.report(report.also(span, "because of this").help(format!("leave out `{name}`")));
            good = false;
        }
        good
    }
}

/// One profile of a loft.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A curve where it is written.
    Curve(CurveReference),
    /// A curve that is placed.
    Placed(Box<PlacedProfile>),
    /// A tip.
    Point(Point),
}

impl Read for Profile {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::Array(_) => Point::read(value, reader).map(Self::Point),
            Data::Table(table) if table.get("curve").is_some() => {
                PlacedProfile::read(value, reader).map(|placed| Self::Placed(Box::new(placed)))
            }
            Data::String(_) | Data::Table(_) => CurveReference::read(value, reader).map(Self::Curve),
            _ => {
                let expected = "the name of a curve, a curve in place, { curve = ..., at = ... }, or a point";
                reader.mismatch(value, expected);
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![CurveReference::schema(schemas), PlacedProfile::schema(schemas), Point::schema(schemas)])
    }
}

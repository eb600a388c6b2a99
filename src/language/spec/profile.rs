//! Shapes made from profiles: revolve, extrude.

use glam::DVec2;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::scaling::{Factor, keeps_width};
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

table! {
    /// A profile turned about the y axis, or another line of its plane: x of the profile is the radius, y goes along the
    /// axis.
    "revolve" pub Revolve {
        /// The profile: the name of a curve, or a curve in place. It lies on one side of the axis: about the y axis its x
        /// must not be negative.
        profile: CurveReference;
        /// The axis, where it is not the y axis: `"x"`, `"y"`, or a line in the plane of the profile,
        /// `{ point = [0.1, 0], direction = [0, 1] }`. The profile may lie to either side, and turns as a right-handed
        /// screw does that moves in the direction of the axis.
        axis: Option<Axis>;
        /// How far it is turned, in degrees; more than 360 needs a `rise`.
        angle: Sp<f64> = 360.0 => Check::above(0.0).up_to(360_000.0);
        /// Where the turn starts, in degrees from +x.
        start: Sp<f64> = 0.0 => Check::within(-360.0, 360.0);
        /// Whether a part turn gets flat faces at its two ends. They need a profile that encloses an area: one that is
        /// closed, or runs from the axis to the axis.
        caps: Sp<bool> = true;
        /// How far it climbs along the axis over the whole turn, in the document's unit: `angle = 1800, rise = 0.01` is a
        /// thread of five turns. With a rise only closed profiles get flat ends, and none may run along the axis.
        rise: Sp<f64> = 0.0;
    }
    checked check
}

/// A line in the plane of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// A point on it.
    pub point: DVec2,
    /// Its direction; not zero, of any length.
    pub direction: DVec2,
}

table! {
    /// An axis in the plane of a profile.
    "axis" pub(crate) AxisFields {
        /// Where it goes; any length but 0.
        direction: Sp<DVec2>;
        /// A point on it.
        point: Sp<DVec2> = DVec2::ZERO;
    }
    checked check
}

impl AxisFields {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.direction.value != DVec2::ZERO {
            return true;
        }
        let report = Diagnostic::error(Code::OutOfRange, "`direction` must not be [0, 0]");
        reader.report(report.at(self.direction.span, "no direction"));
        false
    }
}

impl Read for Axis {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Table(_)) {
            let fields = AxisFields::read(value, reader)?;
            return Some(Self { point: fields.point.value, direction: fields.direction.value });
        }
        let direction = if choice(value, &["x", "y"], reader)? == "x" { DVec2::X } else { DVec2::Y };
        Some(Self { point: DVec2::ZERO, direction })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&["x", "y"]);
        alternatives.push(AxisFields::schema(schemas));
        any_of(alternatives)
    }
}

impl Revolve {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.angle.value <= 360.0 || self.rise.value != 0.0 {
            return true;
        }
        let message = format!(
            "`angle` must be greater than 0 and at most 360, found {}",
            show_number(self.angle.value)
        );
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(self.angle.span, "more than a full turn")
            .help("with a `rise`, as of a screw, it may turn further");
        reader.report(report);
        false
    }
}

table! {
    /// A flat, closed profile drawn out along the z axis.
    "extrude" pub Extrude {
        /// The outline in the x, y plane: the name of a closed curve, or a curve in place. A curve of several parts
        /// gives several solids side by side: outlines, with the parts inside them as holes.
        profile: CurveReference;
        /// Which parts of a profile of several are holes in others.
        fill: Sp<Fill> = Fill::EvenOdd;
        /// Closed curves inside the outline that are cut out.
        holes: Vec<CurveReference> = Vec::new();
        /// How far it is drawn out along +z, in the document's unit.
        height: Sp<f64> => Check::above(0.0);
        /// Whether both ends are closed, so that the result is a solid.
        caps: Sp<bool> = true;
        /// Whether it reaches from -height / 2 to height / 2, instead of from 0 to height.
        centered: Sp<bool> = false;
        /// How far the upper end is turned against the lower one about the z axis, in degrees, counter-clockwise as seen
        /// from above.
        twist: Sp<f64> = 0.0 => Check::within(-1e6, 1e6);
        /// How large the upper end is, about the z axis: `0.5` is half as large as the lower end, `[1, 0.5]` is narrower
        /// along y alone, 0 is a tip.
        taper: Option<Sp<Factor>> => Check::at_least(0.0);
        /// What is cut off the edges of both ends: `0.002` is a straight cut so far inward and along z, a table says more.
        /// The outline keeps its size between the ends; corners of the cut are as sharp as those of the outline, and run
        /// round where the outline turns inward.
        bevel: Option<Bevel>;
        /// How much the walls lean inward on the way up, in degrees, as molds need it.
        draft: Sp<f64> = 0.0 => Check::within(0.0, 89.0);
    }
    checked check
}

/// What is cut off the edges of an extrusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bevel {
    /// How far the ends stand inside the outline.
    pub size: Sp<f64>,
    /// How far the cut reaches along the walls.
    pub height: Sp<f64>,
    /// Its form.
    pub form: BevelForm,
    /// Where it is made.
    pub ends: BevelEnds,
}

table! {
    /// What is cut off the edges of an extrusion.
    "bevel" pub(crate) BevelFields {
        /// How far the flat ends stand inside the outline, in the document's unit.
        size: Sp<f64> => Check::above(0.0);
        /// How far the cut reaches along z; as far as `size` when it is not written.
        height: Option<Sp<f64>> => Check::above(0.0);
        /// Its form.
        form: Sp<BevelForm> = BevelForm::Straight;
        /// Which ends have it.
        ends: Sp<BevelEnds> = BevelEnds::Both;
    }
}

choices! {
    /// The form of a bevel.
    BevelForm {
        /// A flat cut.
        Straight = "straight";
        /// A quarter of a circle, or of an ellipse, that bulges.
        Round = "round";
        /// A quarter that is hollow.
        Cove = "cove";
    }
}

choices! {
    /// The ends of an extrusion that have a bevel.
    BevelEnds {
        /// Both ends.
        Both = "both";
        /// The upper end.
        Top = "top";
        /// The lower end.
        Bottom = "bottom";
    }
}

impl Read for Bevel {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Table(_)) {
            let fields = BevelFields::read(value, reader)?;
            let (form, ends) = (fields.form.value, fields.ends.value);
            let height = fields.height.unwrap_or(fields.size);
            return Some(Self { size: fields.size, height, form, ends });
        }
        let size = Sp::<f64>::read(value, reader)?;
        Check::above(0.0).apply(value, reader).then_some(Self {
            size,
            height: size,
            form: BevelForm::Straight,
            ends: BevelEnds::Both,
        })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![Sp::<f64>::schema(schemas), BevelFields::schema(schemas)])
    }
}

choices! {
    /// What outlines that lie inside each other enclose.
    Fill {
        /// An outline inside another is a hole, one inside a hole an island, however they turn.
        EvenOdd = "even-odd";
        /// An outline inside another is a hole only if it turns the other way: what a browser does unless told.
        NonZero = "nonzero";
    }
}

impl Extrude {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let width = self.taper.as_ref().is_none_or(|taper| keeps_width(taper, reader));
        width && self.check_leaning(reader) && self.check_heights(reader)
    }

    /// Walls lean inward, or the section turns and narrows, but not both.
    fn check_leaning(&self, reader: &mut Reader<'_>) -> bool {
        let leaning = match &self.bevel {
            Some(bevel) => Some(("bevel", bevel.size.span)),
            None => (self.draft.value != 0.0).then_some(("draft", self.draft.span)),
        };
        let moving = match &self.taper {
            Some(taper) => Some(("taper", taper.span)),
            None => (self.twist.value != 0.0).then_some(("twist", self.twist.span)),
        };
        let (Some((one, here)), Some((other, there))) = (leaning, moving) else { return true };
        let message = format!("`{one}` goes with straight extrusions, not with `{other}`");
        let report = Diagnostic::error(Code::Conflict, message)
            .at(here, "this needs a section that stays as it is")
            .also(there, "this changes it")
            .help(format!("leave `{other}` out here and write `[shape.NAME.{other}]` with `of` this shape"));
        reader.report(report);
        false
    }

    /// Bevels of both ends find room on the walls.
    fn check_heights(&self, reader: &mut Reader<'_>) -> bool {
        let Some(bevel) = &self.bevel else { return true };
        let count = if bevel.ends == BevelEnds::Both { 2.0 } else { 1.0 };
        if count * bevel.height.value <= self.height.value {
            return true;
        }
        let most = self.height.value / count;
        let message = format!(
            "a bevel may be at most {} high here, found {}",
            show_number(most),
            show_number(bevel.height.value)
        );
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(bevel.height.span, "too high")
            .also(self.height.span, "the extrusion's height");
        reader.report(report);
        false
    }
}

//! Circular arcs: by center and angles, or through three points.

use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Value, show_number};

/// A part of a circle.
#[derive(Clone, Debug, PartialEq)]
pub enum Arc {
    /// By its center, in the x, y plane.
    Center(CenterArc),
    /// From the first point through the second to the third; the points are different and not on one line.
    Through([Sp<Point>; 3]),
}

/// An arc by center, radius and angles.
#[derive(Clone, Debug, PartialEq)]
pub struct CenterArc {
    /// The center.
    pub center: Sp<Point>,
    /// Radius, in the document's unit.
    pub radius: Sp<f64>,
    /// Angle of the start in degrees, counterclockwise from +x.
    pub from: Sp<f64>,
    /// Angle of the end in degrees; less than `from` turns clockwise. At most 360 away from it.
    pub to: Sp<f64>,
}

/// The greatest angle of an arc's end, by size, in degrees.
const ANGLE: f64 = 3600.0;

table! {
    /// A part of a circle: either `center`, `radius`, `from` and `to`, or `points`.
    "arc" pub(crate) ArcFields {
        /// The center; `[0, 0]` when it is not written.
        center: Option<Sp<Point>>;
        /// Radius, in the document's unit.
        radius: Option<Sp<f64>> => Check::above(0.0);
        /// Angle of the start in degrees, counterclockwise from +x.
        from: Option<Sp<f64>> => Check::within(-ANGLE, ANGLE);
        /// Angle of the end in degrees; less than `from` turns clockwise.
        to: Option<Sp<f64>> => Check::within(-ANGLE, ANGLE);
        /// Three points: start, one between, end.
        points: Option<Sp<Vec<Sp<Point>>>>;
    }
}

impl Read for Arc {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let fields = ArcFields::read(value, reader)?;
        match &fields.points {
            Some(points) => fields.through(points, reader),
            None => fields.around(value.span, reader),
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        ArcFields::schema(schemas)
    }
}

impl ArcFields {
    fn through(&self, points: &Sp<Vec<Sp<Point>>>, reader: &mut Reader<'_>) -> Option<Arc> {
        let center = self.center.as_ref().map(|center| ("center", center.span));
        let others = [("radius", &self.radius), ("from", &self.from), ("to", &self.to)];
        let others =
            others.iter().filter_map(|(name, field)| field.as_ref().map(|field| (*name, field.span)));
        if let Some((name, span)) = center.into_iter().chain(others).next() {
            let message = format!("an arc through points has no `{name}`");
            let report = Diagnostic::error(Code::Conflict, message)
                .at(span, "cannot stand beside `points`")
                .also(points.span, "the points determine the arc");
            reader.report(report);
            return None;
        }
        let Ok(three) = <[Sp<Point>; 3]>::try_from(points.value.clone()) else {
            let message = format!("an arc goes through 3 points, found {}", points.len());
            let report = Diagnostic::error(Code::WrongLength, message)
                .at(points.span, "expected [start, through, end]");
            reader.report(report);
            return None;
        };
        check_three(&three, points.span, reader).then_some(Arc::Through(three))
    }

    fn around(self, table: Span, reader: &mut Reader<'_>) -> Option<Arc> {
        let fields = [("radius", &self.radius), ("from", &self.from), ("to", &self.to)];
        let missing: Vec<_> =
            fields.iter().filter(|(_, field)| field.is_none()).map(|(name, _)| format!("`{name}`")).collect();
        if !missing.is_empty() {
            let message = format!("missing {} {} of arc", field_word(missing.len()), missing.join(", "));
            let report = Diagnostic::error(Code::MissingField, message)
                .at(table, format!("needs {}", missing.join(", ")))
                .help("write `radius`, `from` and `to`, or `points = [start, through, end]`");
            reader.report(report);
            return None;
        }
        let center = self.center.unwrap_or_else(|| Point::ORIGIN.into());
        let arc = CenterArc { center, radius: self.radius?, from: self.from?, to: self.to? };
        let sweep = arc.to.value - arc.from.value;
        if sweep != 0.0 && sweep.abs() <= 360.0 {
            return Some(Arc::Center(arc));
        }
        let turned = show_number(sweep);
        let message = format!("an arc turns by more than 0 and at most 360 degrees, found {turned}");
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(arc.to.span, format!("{turned} degrees from the start"))
            .also(arc.from.span, "the start");
        reader.report(report);
        None
    }
}

fn field_word(count: usize) -> &'static str {
    if count == 1 { "field" } else { "fields" }
}

/// Whether three points determine a circle; reports it where they do not.
///
/// They do when the triangle's height is not lost in rounding: its doubled area is above 1e-12 of the
/// product of the sides.
pub(crate) fn check_three(points: &[Sp<Point>; 3], span: Span, reader: &mut Reader<'_>) -> bool {
    const LOST: f64 = 1e-12;
    let [start, through, end] = [0, 1, 2].map(|index| points[index].position);
    let (one, two) = (through - start, end - start);
    let area = one.cross(two).length();
    if area > LOST * one.length() * two.length() && through != end {
        return true;
    }
    let equal = start == through || through == end || start == end;
    let why = if equal { "two of them are equal" } else { "they lie on one line" };
    let message = format!("three points determine no arc: {why}");
    let mut report = Diagnostic::error(Code::Degenerate, message).at(span, why);
    if start == end && start != through {
        report = report.help("write a full circle as `circle`");
    }
    reader.report(report);
    false
}

//! Cameras, lights, and what nodes look at.

use glam::DVec3;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::material::Color;
use crate::language::spec::point::read_numbers;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::Family;
use crate::language::spec::schema::{Schemas, any_of, numbers};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

/// Degrees that a camera sees upright where nothing is written.
const UPRIGHT: f64 = 45.0;
/// Degrees from the middle of a spot to its rim where nothing is written.
const RIM: f64 = 45.0;

table! {
    /// A camera, as `[node.NAME.camera]`. It looks along the node's -z, with y up; where z points up in the document, along the
    /// node's y, with z up.
    "camera" pub Camera {
        /// Degrees that it sees upright: 45 when neither this nor `height` is written.
        field_of_view: Option<Sp<f64>> => Check::within(0.001, 179.0);
        /// What it sees upright in the document's unit at any distance: a camera without perspective.
        height: Option<Sp<f64>> => Check::above(0.0);
        /// Width of its picture over the height.
        aspect: Sp<f64> = 1.777_777_777_777_777_7 => Check::within(0.01, 100.0);
        /// It sees nothing nearer, in the document's unit.
        near: Sp<f64> = 0.1 => Check::above(0.0);
        /// It sees nothing further, in the document's unit: without end when it is not written, or with `height` 1000 times
        /// `near`.
        far: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

table! {
    /// A light, as `[node.NAME.light]`. Spots and suns shine the way in which a camera there would look.
    "light" pub Light {
        /// Where it shines.
        kind: Sp<LightKind> = LightKind::Point;
        /// Its color.
        color: Sp<Color> = Color::WHITE;
        /// Candela; of a sun lux.
        intensity: Sp<f64> = 1.0 => Check::at_least(0.0).up_to(1e12);
        /// It shines no further, in the document's unit: without end when it is not written.
        range: Option<Sp<f64>> => Check::above(0.0);
        /// Degrees from the middle of a spot to where it begins to fade: 0 when it is not written.
        inner: Option<Sp<f64>> => Check::within(0.0, 90.0);
        /// Degrees from the middle of a spot to where it ends: 45 when it is not written.
        outer: Option<Sp<f64>> => Check::within(0.001, 90.0);
    }
    checked check
}

choices! {
    /// Where a light shines.
    LightKind {
        /// All around.
        Point = "point";
        /// In a cone.
        Spot = "spot";
        /// The same way everywhere.
        Sun = "sun";
    }
}

/// What a node looks at.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// A point of the model.
    Point(DVec3),
    /// A node of the document.
    Node(String),
}

impl Read for Aim {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::String(name) = &value.data {
            // To look at a node is not to be carried by it: two may look at each other.
            reader.uses_alone(Family::Node, name, value.span);
            return Some(Self::Node(name.clone()));
        }
        let read = read_numbers(value, 3, 3, "the name of a node or a point [x, y, z]", reader)?;
        Some(Self::Point(DVec3::new(read[0], read[1], read[2])))
    }

    fn schema(_: &mut Schemas) -> Json {
        any_of(vec![serde_json::json!({ "type": "string" }), numbers(3, 3)])
    }
}

impl Camera {
    /// Degrees that it sees upright, where it has perspective.
    #[must_use]
    pub fn upright(&self) -> f64 {
        self.field_of_view.as_ref().map_or(UPRIGHT, |degrees| degrees.value)
    }

    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if let (Some(view), Some(height)) = (&self.field_of_view, &self.height) {
            let message = "a camera has a `field-of-view`, or without perspective a `height`";
            let report = Diagnostic::error(Code::Conflict, message)
                .at(height.span, "cannot stand beside `field-of-view`")
                .also(view.span, "the field of view");
            reader.report(report);
            return false;
        }
        let Some(far) = self.far.as_ref().filter(|far| far.value <= self.near.value) else { return true };
        let message = format!(
            "a camera sees from `near` to `far`, but {} is not more than {}",
            show_number(far.value),
            show_number(self.near.value)
        );
        let report = Diagnostic::error(Code::OutOfRange, message).at(far.span, "sees nothing");
        let report =
            if self.near.span.is_none() { report } else { report.also(self.near.span, "`near` is here") };
        reader.report(report.help("write a `far` above `near`, or a smaller `near`"));
        false
    }
}

impl Light {
    /// Degrees from the middle of a spot to where it begins to fade and where it ends.
    #[must_use]
    pub fn cone(&self) -> (f64, f64) {
        let degrees = |written: &Option<Sp<f64>>, plain| written.as_ref().map_or(plain, |angle| angle.value);
        (degrees(&self.inner, 0.0), degrees(&self.outer, RIM))
    }

    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let cone = [("inner", &self.inner), ("outer", &self.outer)];
        let stray = cone.into_iter().find_map(|(field, angle)| Some((field, angle.as_ref()?.span)));
        if let (Some((field, span)), true) = (stray, self.kind.value != LightKind::Spot) {
            let message = format!("only a spot has an `{field}` angle");
            let report = Diagnostic::error(Code::Conflict, message)
                .at(span, "no cone")
                .help("write `kind = \"spot\"`, or leave it out");
            reader.report(report);
            return false;
        }
        if let (LightKind::Sun, Some(range)) = (self.kind.value, &self.range) {
            let report = Diagnostic::error(Code::Conflict, "a sun shines without end and has no `range`")
                .at(range.span, "cannot stand beside `kind = \"sun\"`");
            reader.report(report.help("leave `range` out, or write `kind = \"spot\"`"));
            return false;
        }
        let (inner, outer) = self.cone();
        if inner < outer {
            return true;
        }
        let place = self.inner.as_ref().or(self.outer.as_ref()).map_or(Span::NONE, |angle| angle.span);
        let message = format!(
            "a spot fades from `inner` to `outer`, but {} is not less than {}",
            show_number(inner),
            show_number(outer)
        );
        reader.report(
            Diagnostic::error(Code::OutOfRange, message)
                .at(place, "no room to fade")
                .help("write an `inner` below `outer`"),
        );
        false
    }
}

//! Shapes made from curves: revolve, extrude, sweep.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::CurveReference;
use crate::language::spec::spanned::Sp;

table! {
    /// A profile turned about the y axis: x of the profile is the radius, y goes along the axis.
    "revolve" pub Revolve {
        /// The profile: the name of a curve, or a curve in place. Its x must not be negative.
        profile: CurveReference;
        /// How far it is turned, in degrees.
        angle: Sp<f64> = 360.0 => Check::above(0.0).up_to(360.0);
        /// Where the turn starts, in degrees from +x.
        start: Sp<f64> = 0.0 => Check::within(-360.0, 360.0);
        /// Whether a part turn gets flat faces at its two ends. They need a profile that encloses an area: one that is
        /// closed, or runs from the axis to the axis.
        caps: Sp<bool> = true;
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
    }
}

table! {
    /// A profile drawn along a curve: x of the profile runs to the side, y up.
    "sweep" pub Sweep {
        /// The profile: the name of a curve, or a curve in place.
        profile: CurveReference;
        /// The curve that it is drawn along.
        path: CurveReference;
        /// How the profile is carried along the path.
        frame: Sp<Frame> = Frame::RotationMinimizing;
        /// With `frame = "up"`, the direction; the document's own up when it is not written. The path must not run along
        /// it.
        up: Option<Sp<DVec3>>;
        /// How far the profile turns about the path from start to end, in degrees.
        twist: Sp<f64> = 0.0 => Check::within(-1e6, 1e6);
        /// Whether both ends are closed with flat caps, so that the result is a solid.
        caps: Sp<bool> = true;
    }
    checked check
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

impl Sweep {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let Some(up) = self.up else { return true };
        if self.frame.value != Frame::Up {
            let message = format!("`up` has no meaning with `frame = \"{}\"`", self.frame.text());
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
}

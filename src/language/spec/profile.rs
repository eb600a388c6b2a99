//! Shapes made from curves: revolve, extrude, sweep.

use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
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
        /// The outline in the x, y plane: the name of a closed curve, or a curve in place.
        profile: CurveReference;
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
        /// How far the profile turns about the path from start to end, in degrees.
        twist: Sp<f64> = 0.0 => Check::within(-1e6, 1e6);
        /// Whether both ends are closed with flat caps, so that the result is a solid.
        caps: Sp<bool> = true;
    }
}

choices! {
    /// How a profile is carried along a path.
    Frame {
        /// It turns about the path no more than the path itself makes it.
        RotationMinimizing = "rotation-minimizing";
    }
}

//! Shapes made from another by bending space: taper, twist, bend, along a curve.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{CurveReference, ShapeReference};
use crate::language::spec::spanned::Sp;
use crate::language::spec::sweep::{Frame, check_up};

table! {
    /// Another shape, made thinner or thicker along an axis.
    "taper" pub Taper {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// Factor of size across the axis at the end of the shape.
        factor: Sp<f64> => Check::above(0.0);
        /// Factor of size at its start.
        start: Sp<f64> = 1.0 => Check::above(0.0);
        /// The axis.
        axis: Sp<CoordinateAxis> = CoordinateAxis::Y;
        /// A point that the axis goes through.
        around: Sp<DVec3> = DVec3::ZERO;
        /// Where the change begins, as a coordinate along the axis: at the start of the shape when it is not written.
        from: Option<Sp<f64>>;
        /// Where it ends: at the end of the shape when it is not written.
        to: Option<Sp<f64>>;
    }
    checked check
}

table! {
    /// Another shape, turned about an axis more and more.
    "twist" pub Twist {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// How far the end is turned against the start, in degrees; counterclockwise for who looks against the axis.
        angle: Sp<f64> => Check::within(-1e6, 1e6);
        /// The axis.
        axis: Sp<CoordinateAxis> = CoordinateAxis::Y;
        /// A point that the axis goes through.
        around: Sp<DVec3> = DVec3::ZERO;
        /// Where the turn begins, as a coordinate along the axis: at the start of the shape when it is not written.
        from: Option<Sp<f64>>;
        /// Where it ends: at the end of the shape when it is not written.
        to: Option<Sp<f64>>;
    }
    checked check
}

table! {
    /// Another shape, its axis bent into an arc. The axis keeps its length.
    "bend" pub Bend {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// How far the direction turns from start to end, in degrees.
        angle: Sp<f64> => Check::within(-36_000.0, 36_000.0);
        /// The axis that is bent.
        axis: Sp<CoordinateAxis> = CoordinateAxis::Y;
        /// The axis toward which it bends; another than `axis`. Toward the other side with a negative `angle`.
        toward: Sp<CoordinateAxis> = CoordinateAxis::X;
        /// A point that the axis goes through.
        around: Sp<DVec3> = DVec3::ZERO;
        /// Where the bend begins, as a coordinate along the axis: at the start of the shape when it is not written.
        from: Option<Sp<f64>>;
        /// Where it ends: at the end of the shape when it is not written.
        to: Option<Sp<f64>>;
    }
    checked check
}

table! {
    /// Another shape, laid along a curve: its axis follows the curve, by length, and what is beside the axis goes along.
    "along" pub Along {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The curve, without corners.
        path: CurveReference;
        /// The axis of the shape that is laid on the curve. What is up of the shape, its y, stays up; of a shape that is
        /// laid down along its y, the front, its z, comes up.
        axis: Sp<CoordinateAxis> = CoordinateAxis::Z;
        /// A point that the axis goes through.
        around: Sp<DVec3> = DVec3::ZERO;
        /// Which coordinate along the axis comes to the start of the curve: the start of the shape when it is not written.
        from: Option<Sp<f64>>;
        /// How the shape is carried along the curve, as in a sweep.
        frame: Sp<Frame> = Frame::RotationMinimizing;
        /// With `frame = "up"`, the direction; the document's own up when it is not written. The curve must not run along
        /// it.
        up: Option<Sp<DVec3>>;
        /// Whether the shape is stretched, or squeezed, along its axis, until it is as long as the curve. Otherwise it keeps its
        /// length, and must not be longer than an open curve; around a closed one it may go again.
        stretch: Sp<bool> = false;
    }
    checked check
}

choices! {
    /// An axis.
    CoordinateAxis {
        /// To the right.
        X = "x";
        /// Up, unless the document says otherwise.
        Y = "y";
        /// Toward who looks at it.
        Z = "z";
    }
}

impl CoordinateAxis {
    /// Its unit direction.
    #[must_use]
    pub fn direction(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

    /// What comes to the side of a curve when this axis is laid on it: y comes up, or z where this is y.
    #[must_use]
    pub fn sideways(self) -> DVec3 {
        match self {
            Self::X => DVec3::NEG_Z,
            Self::Y => DVec3::NEG_X,
            Self::Z => DVec3::X,
        }
    }
}

/// Where a change begins lies before where it ends.
fn in_order(from: Option<&Sp<f64>>, to: Option<&Sp<f64>>, reader: &mut Reader<'_>) -> bool {
    let (Some(from), Some(to)) = (from, to) else { return true };
    if from.value < to.value {
        return true;
    }
    let message = format!("`to` must be greater than `from`, found {} and {}", to.value, from.value);
    let report = Diagnostic::error(Code::NoLength, message)
        .at(to.span, "not after `from`")
        .also(from.span, "where the change begins");
    reader.report(report);
    false
}

impl Taper {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        in_order(self.from.as_ref(), self.to.as_ref(), reader)
    }
}

impl Twist {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        in_order(self.from.as_ref(), self.to.as_ref(), reader)
    }
}

impl Along {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let up = check_up(&self.frame, self.up.as_ref(), reader);
        let (Some(from), true) = (&self.from, self.stretch.value) else { return up };
        let message = "`from` says nothing when the shape is stretched to the whole curve";
        let report = Diagnostic::error(Code::Conflict, message)
            .at(from.span, "does not go with `stretch`")
            .help("leave out `from`, or `stretch`");
        reader.report(report);
        false
    }
}

impl Bend {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let ordered = in_order(self.from.as_ref(), self.to.as_ref(), reader);
        if self.axis.value != self.toward.value {
            return ordered;
        }
        let message = format!("an axis cannot bend toward itself: both are \"{}\"", self.axis.value.text());
        let mut report = Diagnostic::error(Code::NoLength, message).at(self.toward.span, "the axis itself");
        if self.toward.span != self.axis.span {
            report = report.also(self.axis.span, "the axis");
        }
        let other = if self.axis.value == CoordinateAxis::X { "y" } else { "x" };
        reader.report(report.help(format!("write `toward = \"{other}\"`")));
        false
    }
}

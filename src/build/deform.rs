//! Deformations of shapes.

use glam::DVec3;

use super::Builder;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::atan2;
use crate::geometry::surface::AxialKind;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Along, Bend, CoordinateAxis, ShapeReference, Sp, Taper, Twist};
use crate::model::{AxialBending, Bending, PathBending, Recipe};

/// What all maps along a straight axis have.
struct Straight<'a> {
    of: &'a ShapeReference,
    axis: CoordinateAxis,
    side: CoordinateAxis,
    around: DVec3,
    from: Option<Sp<f64>>,
    to: Option<Sp<f64>>,
}

/// The axis after another: x, y, z and again x.
fn next(axis: CoordinateAxis) -> CoordinateAxis {
    match axis {
        CoordinateAxis::X => CoordinateAxis::Y,
        CoordinateAxis::Y => CoordinateAxis::Z,
        CoordinateAxis::Z => CoordinateAxis::X,
    }
}

impl Builder<'_> {
    pub(super) fn taper(&mut self, name: &str, taper: &Taper) -> Option<Recipe> {
        let straight = Straight {
            of: &taper.of,
            axis: taper.axis.value,
            side: next(taper.axis.value),
            around: taper.around.value,
            from: taper.from,
            to: taper.to,
        };
        let kind = AxialKind::Taper { start: taper.start.value, end: taper.factor.value };
        self.straight(name, &straight, kind)
    }

    pub(super) fn twist(&mut self, name: &str, twist: &Twist) -> Option<Recipe> {
        let straight = Straight {
            of: &twist.of,
            axis: twist.axis.value,
            side: next(twist.axis.value),
            around: twist.around.value,
            from: twist.from,
            to: twist.to,
        };
        self.straight(name, &straight, AxialKind::Twist(twist.angle.value.to_radians()))
    }

    pub(super) fn bend(&mut self, name: &str, bend: &Bend) -> Option<Recipe> {
        let straight = Straight {
            of: &bend.of,
            axis: bend.axis.value,
            side: bend.toward.value,
            around: bend.around.value,
            from: bend.from,
            to: bend.to,
        };
        self.straight(name, &straight, AxialKind::Bend(bend.angle.value.to_radians()))
    }

    fn straight(&mut self, name: &str, map: &Straight<'_>, kind: AxialKind) -> Option<Recipe> {
        let of = self.shape_of(name, 0, map.of)?;
        let by = Bending::Axial(AxialBending {
            around: map.around,
            axis: map.axis.direction(),
            side: map.side.direction(),
            from: map.from.map(|from| from.value),
            to: map.to.map(|to| to.value),
            kind,
        });
        Some(Recipe::Deformed { of, by })
    }

    pub(super) fn along(&mut self, name: &str, along: &Along) -> Option<Recipe> {
        let of = self.shape_of(name, 0, &along.of);
        let path = self.curve_of(&along.path)?;
        self.check_smooth(&path, along.path.span())?;
        let carry = self.carry((&along.frame, along.up.as_ref()), (&path, &along.path), 0.0)?;
        let axis = along.axis.value;
        let by = Bending::Along(PathBending {
            path,
            around: along.around.value,
            axis: axis.direction(),
            side: axis.sideways(),
            carry,
            from: along.from.map(|from| from.value),
            stretch: along.stretch.value,
        });
        Some(Recipe::Deformed { of: of?, by })
    }

    /// A path with a corner would tear what is laid along it.
    fn check_smooth(&mut self, path: &AnyCurve, span: Span) -> Option<()> {
        /// Degrees that smooth constructions stay below.
        const CORNER: f64 = 1e-3;
        let domain = path.domain();
        let mut joints: Vec<(f64, f64)> = path.joints().into_iter().map(|t| (t, t)).collect();
        if path.is_closed() {
            joints.push((domain.end, domain.start));
        }
        for (end, start) in joints {
            let (before, after) = (path.direction(end, Side::Before), path.direction(start, Side::After));
            let turn = atan2(before.cross(after).length(), before.dot(after)).to_degrees();
            if turn > CORNER {
                let message = format!("the path has a corner of {turn:.1} degrees at parameter {start}");
                let report = Diagnostic::error(Code::CorneredPath, message)
                    .at(span, "a shape laid along it would tear")
                    .help("round the corner with an arc or a spline");
                self.report(report);
                return None;
            }
        }
        Some(())
    }
}

//! Shapes made from closed shapes: set operations, cuts, hulls, rounding, hollowing.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::combine::Plane;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::ShapeReference;
use crate::language::spec::solid_expression::SolidExpression;
use crate::language::spec::spanned::Sp;

table! {
    /// Closed shapes put together as solids: no walls are left inside, faces that lie on one another are exact, and each
    /// triangle keeps the material, the texture coordinates and the smoothing of its shape. New edges are sharp. Groups
    /// and arrays count as the union of their parts.
    "solid set" pub SolidSet {
        /// The shapes: their names, or shapes in place. Of a difference, the first is what the others are taken from.
        of: Vec<ShapeReference> => Check::items(2);
    }
}

table! {
    /// Closed shapes put together by an expression.
    "solid" pub SolidFormula {
        /// Names of shapes with `+` (union), `-` (difference), `&` (intersection) and parentheses between them:
        /// `"body + handle - inside"`. `&` binds tighter than `+` and `-`, which go from left to right. Names may have
        /// hyphens in them, so a minus sign stands between spaces.
        of: Sp<SolidExpression>;
    }
}

table! {
    /// A shape cut by a plane.
    "cut" pub Cut {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The plane: `"x"` is the plane x = 0, and so on; or `{ normal = [x, y, z], point = [x, y, z] }`.
        plane: Sp<Plane>;
        /// What stays: the side that the plane's normal points to, the other side, or both.
        keep: Sp<Keep> = Keep::Below;
        /// Whether the cut is closed by a flat face. That needs a closed shape; without it any shape can be cut.
        cap: Sp<bool> = true;
        /// With `keep = "both"`: how far the two sides are moved apart.
        gap: Sp<f64> = 0.0 => Check::at_least(0.0);
    }
    checked check
}

choices! {
    /// What stays of a shape that is cut.
    Keep {
        /// The side that the normal of the plane points to.
        Above = "above";
        /// The side that it points away from.
        Below = "below";
        /// Both sides, as bodies of their own.
        Both = "both";
    }
}

table! {
    /// The smallest convex body around shapes and points, as a skin stretched over them.
    "hull" pub Hull {
        /// The shapes: their names, or shapes in place; closed or not, wires too.
        of: Vec<ShapeReference> = Vec::new();
        /// Points beside them, in the document's unit.
        points: Vec<Sp<DVec3>> = Vec::new();
    }
    checked check
}

table! {
    /// A closed shape grown by a ball, which rounds its outer edges; or shrunk by one, which rounds its inner edges. Flat
    /// faces move by the radius. Once grown and once shrunk by the same radius, notches are filled with roundings; once
    /// shrunk and once grown, outer edges are rounded and the rest stays where it was.
    "minkowski-round" pub MinkowskiRound {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The radius of the ball, in the document's unit; more than 0 grows, less than 0 shrinks. It is met from inside: no
        /// point of the result stands off by more than the radius, or by less than the radius without the tolerance.
        radius: Sp<f64> => Check::nonzero();
    }
}

table! {
    /// A closed shape hollowed out: its surface is kept, and a wall of even thickness behind it.
    "shell" pub Shell {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The thickness of the wall, in the document's unit.
        thickness: Sp<f64> => Check::above(0.0);
        /// On which side of the surface the wall is.
        side: Sp<WallSide> = WallSide::Inside;
        /// Planes whose flat faces are left open: each `"x"`, `"y"`, `"z"`, or `{ normal = [x, y, z], point = [x, y, z] }`;
        /// the normal looks out of the shape. The hollow goes straight through such a face.
        open: Vec<Sp<Plane>> = Vec::new();
    }
    checked check
}

choices! {
    /// On which side of a surface a wall is.
    WallSide {
        /// Behind the surface, which stays as it is.
        Inside = "inside";
        /// In front of the surface, which becomes the inside of the hollow.
        Outside = "outside";
    }
}

impl Cut {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.gap.value == 0.0 || self.keep.value == Keep::Both {
            return true;
        }
        let report =
            Diagnostic::error(Code::Conflict, "`gap` says nothing when one side of the cut is left out")
                .at(self.gap.span, "between what?")
                .also(self.keep.span, "one side alone")
                .help("write `keep = \"both\"`, or leave out `gap`");
        reader.report(report);
        false
    }
}

impl Hull {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        if !self.of.is_empty() || self.points.len() >= 4 {
            return true;
        }
        let report = match self.points.len() {
            0 => Diagnostic::error(Code::MissingField, "missing `of` or `points` of hull")
                .at(table, "around what?"),
            count => {
                let message = format!("a body needs at least 4 points, found {count}");
                Diagnostic::error(Code::WrongLength, message).at(self.points[0].span, "too few")
            }
        };
        reader.report(report.help("write `of = [\"name\"]`, or `points` with at least 4 points"));
        false
    }
}

impl Shell {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (Some(open), WallSide::Outside) = (self.open.first(), self.side.value) else { return true };
        let message = "faces are left open where the wall is inside; outside, the wall goes around them";
        let report = Diagnostic::error(Code::Conflict, message)
            .at(open.span, "does not go with `side = \"outside\"`")
            .also(self.side.span, "the wall is outside")
            .help("cut the result with `cut`, or write `side = \"inside\"`");
        reader.report(report);
        false
    }
}

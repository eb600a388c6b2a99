//! Shapes moved along their normals.

use glam::DVec2;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::point::Segments;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{MapReference, ShapeReference};
use crate::language::spec::spanned::Sp;

table! {
    /// Another shape, each of its points moved along its normal by a height: that of a map, or of a formula. It is cut
    /// finely enough that the moved surface is followed within the tolerance. What was closed stays closed: where the shape
    /// is smooth points go along the one normal there, and at sharp edges and corners along the miter, on which every face
    /// moves by its height, so a box moved evenly is a larger box. What would run through itself is an error.
    "displace" pub Displace {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The heights: the name of a map, or a map in place.
        map: Option<MapReference>;
        /// The heights by a formula of x, y and z, the place in the document's unit. Angles are in degrees.
        formula: Option<Sp<Formula>>;
        /// The heights of the values 0 and 1 of the map or the formula, in the document's unit.
        range: Sp<DVec2> = DVec2::new(0.0, 1.0);
        /// How the map lies on the shape.
        projection: Sp<DisplaceProjection> = DisplaceProjection::Texture;
        /// Draws the normals of the heights at full resolution into a normal map of the shape's material: its width and height
        /// in pixels, or one number for both. Few triangles then look like many: write a coarser `tolerance` with it. Its
        /// texture coordinates must lie between 0 and 1 and cover no place twice.
        bake_normal_map: Option<Sp<Segments>> => Check::within(1.0, 16384.0);
    }
    checked check
}

choices! {
    /// How a map lies on a shape that it moves.
    DisplaceProjection {
        /// By its texture coordinates: columns with u, rows with v, again and again beyond 0 and 1. Where the texture has a
        /// seam, heights on both sides of it must agree.
        Texture = "texture";
        /// Straight along the x axis, over the box around the shape: columns go to -z, rows down.
        X = "x";
        /// Straight along the y axis, over the box around the shape: columns go to +x, rows to +z.
        Y = "y";
        /// Straight along the z axis, over the box around the shape: columns go to +x, rows down.
        Z = "z";
        /// By angle and latitude about the middle of the box around the shape; the first column looks to -z. The map closes,
        /// and its first and last row are each one point.
        Spherical = "spherical";
        /// By the angle about the upright axis through the middle of the box around the shape, and the height. The map
        /// closes.
        Cylindrical = "cylindrical";
    }
}

impl Displace {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.map, &self.formula) {
            (None, None) => {
                Diagnostic::error(Code::MissingField, "missing field `map` or `formula` of displace")
                    .at(span, "by what heights?")
                    .help("write `map = { noise = {} }`, or `formula = \"= 0.1 * sin(x * 360)\"`")
            }
            (Some(_), Some(formula)) => {
                Diagnostic::error(Code::Conflict, "a shape is moved by a `map` or by a `formula`, not both")
                    .at(formula.span, "the second")
                    .help("move it twice: displace the displaced shape")
            }
            (None, Some(_)) if !self.projection.span.is_none() => {
                Diagnostic::error(Code::Conflict, "`projection` says how a map lies on the shape")
                    .at(self.projection.span, "no effect with `formula`")
            }
            _ => return true,
        };
        reader.report(report);
        false
    }
}

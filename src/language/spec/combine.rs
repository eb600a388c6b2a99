//! Shapes made from other shapes: copies, mirror images, arrays, groups.

use glam::DVec3;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::kind::choice;
use crate::language::spec::point::Count;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::ShapeReference;
use crate::language::spec::schema::{Schemas, any_of, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// Another shape again, to be placed or given a material of its own.
    "copy" pub Copy {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
    }
}

table! {
    /// Another shape and its mirror image.
    "mirror" pub Mirror {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// The mirror: `"x"` is the plane x = 0, and so on; or `{ normal = [x, y, z], point = [x, y, z] }`.
        plane: Sp<Plane>;
        /// Whether the shape itself stays beside its image.
        keep: Sp<bool> = true;
    }
}

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its normal; not zero, of any length.
    pub normal: DVec3,
    /// A point on it.
    pub point: DVec3,
}

table! {
    /// A plane by its normal and a point.
    "plane" pub(crate) PlaneFields {
        /// The direction in which the plane looks; any length but 0.
        normal: Sp<DVec3>;
        /// A point on it.
        point: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// Another shape many times: in a row, in a block, or around.
    "array" pub Array {
        /// The shape: its name, or a shape in place.
        of: ShapeReference;
        /// How many: `n` in a row, or `[nx, ny, nz]` in a block.
        count: Sp<Count> => Check::at_least(1.0);
        /// From one to the next, in the document's unit; in a block, the spacing along each axis.
        offset: Sp<DVec3> = DVec3::ZERO;
        /// Degrees from one to the next, about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// The point that `rotate` turns about.
        around: Sp<DVec3> = DVec3::ZERO;
    }
    checked check
}

table! {
    /// Several shapes as one mesh; each keeps its material.
    "group" pub Group {
        /// The shapes: their names, or shapes in place.
        of: Vec<ShapeReference> => Check::items(1);
    }
}

impl PlaneFields {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.normal.value != DVec3::ZERO {
            return true;
        }
        let report = Diagnostic::error(Code::OutOfRange, "`normal` must not be [0, 0, 0]");
        reader.report(report.at(self.normal.span, "no direction"));
        false
    }
}

impl Array {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let Count::Row(count) = self.count.value else { return self.check_block(reader) };
        if count == 1 || self.offset.value != DVec3::ZERO || self.rotate.value != DVec3::ZERO {
            return true;
        }
        let message = format!("all {count} copies of this array stand in the same place");
        let report = Diagnostic::error(Code::Degenerate, message)
            .at(self.count.span, "more than one")
            .help("write `offset = [x, y, z]` or `rotate = [x, y, z]`");
        reader.report(report);
        false
    }

    fn check_block(&self, reader: &mut Reader<'_>) -> bool {
        let Count::Block(counts) = self.count.value else { return true };
        let offset = self.offset.value.to_array();
        let Some(axis) = (0..3).find(|axis| counts[*axis] > 1 && offset[*axis] == 0.0) else { return true };
        let name = ["x", "y", "z"][axis];
        let message = format!("{} copies along {name} stand in the same place", counts[axis]);
        let report = Diagnostic::error(Code::Degenerate, message)
            .at(self.count.span, "more than one")
            .help(format!("give `offset` a spacing along {name}"));
        reader.report(report);
        false
    }
}

impl Read for Plane {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Table(_)) {
            let fields = PlaneFields::read(value, reader)?;
            return Some(Self { normal: fields.normal.value, point: fields.point.value });
        }
        let normal = match choice(value, &["x", "y", "z"], reader)? {
            "x" => DVec3::X,
            "y" => DVec3::Y,
            _ => DVec3::Z,
        };
        Some(Self { normal, point: DVec3::ZERO })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&["x", "y", "z"]);
        alternatives.push(PlaneFields::schema(schemas));
        any_of(alternatives)
    }
}

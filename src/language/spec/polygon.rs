//! Flat faces: polygons written out, and what curves enclose.

use glam::DVec2;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::profile::Fill;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::schema::{Schemas, any_of, array};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// Flat polygons in the x, y plane that look to +z, without thickness, written out as loops of corners. Loops that
    /// turn counterclockwise are outlines; those that turn clockwise are holes in the outline around them.
    "polygon" pub Polygon {
        /// For each loop its corners, `[x, y]`, in the document's unit. The last is joined to the first.
        loops: Vec<Sp<Vec<DVec2>>> => Check::items(1);
    }
    checked check
}

table! {
    /// The flat face that a closed curve encloses, in the x, y plane. It looks to +z and has no thickness.
    "sheet" pub Sheet {
        /// The outline: the name of a closed curve, or a curve in place. A curve of several parts gives several faces
        /// side by side: outlines, with the parts inside them as holes.
        profile: CurveReference;
        /// Which parts of a profile of several are holes in others.
        fill: Sp<Fill> = Fill::EvenOdd;
        /// Closed curves inside the outline that are cut out.
        holes: Vec<CurveReference> = Vec::new();
    }
}

/// A face of a mesh: the corners of its outline, then those of each of its holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// The loops; at least the outline.
    pub loops: Vec<Vec<u32>>,
}

impl Face {
    /// Corners of all loops.
    pub fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.loops.iter().flatten().copied()
    }
}

impl Read for Face {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let nested = matches!(&value.data, Data::Array(items) if items.iter().any(|item| matches!(item.data, Data::Array(_))));
        let loops = if nested { Vec::read(value, reader)? } else { vec![Vec::read(value, reader)?] };
        Some(Self { loops })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let corners = Vec::<u32>::schema(schemas);
        any_of(vec![corners.clone(), array(corners)])
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self.loops))
    }
}

impl Polygon {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (index, corners) in self.loops.iter().enumerate().filter(|(_, corners)| corners.len() < 3) {
            let message = format!("`loops[{index}]` needs at least 3 corners, found {}", corners.len());
            reader.report(Diagnostic::error(Code::FaceCorners, message).at(corners.span, "too few"));
            good = false;
        }
        good
    }
}

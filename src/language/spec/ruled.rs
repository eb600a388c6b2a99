//! Surfaces between and along curves: ruled, translational.

use serde_json::Value as Json;

use crate::language::spec::construct::table;
use crate::language::spec::point::Point;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// Straight lines between two curves in space, or between a curve and a point: cones, tents, wings, funnels
    /// from one outline to another. Points at the same share of both curves' parameters are joined.
    "ruled" pub Ruled {
        /// Where the lines start: the name of a curve, or a curve in place.
        from: CurveReference;
        /// Where they end: a curve as well, or a point `[x, y, z]` for the tip of a cone.
        to: End;
        /// Whether both ends are closed with flat faces where the curves are closed, so that the result is a solid. Closed
        /// curves must be flat for that.
        caps: Sp<bool> = true;
    }
}

table! {
    /// A curve moved along another without turning: each of its points runs along a copy of the path.
    "translational" pub Translational {
        /// The curve that is moved: the name of a curve, or a curve in place.
        profile: CurveReference;
        /// The curve that it is moved along; it starts where the profile is written, wherever the path itself lies.
        path: CurveReference;
        /// Whether both ends of an open path are closed with flat faces, where the profile is closed, so that the result is
        /// a solid. The profile must be flat for that.
        caps: Sp<bool> = true;
    }
}

/// Where the lines of a ruled surface end.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// On a curve.
    Curve(CurveReference),
    /// All in one point.
    Point(Sp<Point>),
}

impl Read for End {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::Array(_) => Sp::<Point>::read(value, reader).map(Self::Point),
            Data::String(_) | Data::Table(_) => CurveReference::read(value, reader).map(Self::Curve),
            _ => {
                reader.mismatch(value, "the name of a curve, a curve in place, or a point [x, y, z]");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![CurveReference::schema(schemas), Point::schema(schemas)])
    }
}

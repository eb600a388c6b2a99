//! Surfaces through curves: Coons patches and networks.

use glam::DVec3;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::schema::{Schemas, any_of, numbers, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

table! {
    /// A smooth patch over its sides: four curves, three, two, or one closed one, each meeting the next. u runs along the
    /// first side, v from there to the opposite one. The front shows the sides counterclockwise.
    "coons" pub Coons {
        /// The sides around the patch, in order: names of curves, curves in place, or
        /// `{ curve = "...", cross = "..." }` where the direction across a side is given. A curve may run either way.
        /// One closed curve is cut at its corners where it has two to four of them, else into quarters.
        sides: Vec<CoonsSide> = Vec::new();
        /// How the inside follows from the sides.
        blend: Sp<CoonsBlend> = CoonsBlend::Bilinear;
        /// How a bicubic patch twists at its corners: a rule, or four vectors, the mixed derivatives by u and v where the
        /// first side starts, where it ends, and on around. Where `cross` is given it determines the twist.
        twist: Option<Sp<CoonsTwist>>;
        /// Two sides that stay apart: straight or, with `cross`, curved lines lead from each place of the first side to
        /// the same share of the second.
        apart: Sp<bool> = false;
        /// A patch without sides: it goes out from this point by the four vectors of `twist` and comes back, like a drop.
        point: Option<Sp<DVec3>>;
    }
    checked check
}

choices! {
    /// How the inside of a patch follows from its sides.
    CoonsBlend {
        /// The sides alone matter; patches that share a side may make an edge there.
        Bilinear = "bilinear";
        /// The directions across the sides matter too: patches that share a side and its `cross` join smoothly.
        Bicubic = "bicubic";
    }
}

/// How a bicubic patch twists at its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoonsTwist {
    /// Not at all.
    Zero,
    /// As the bilinear surface through the corners.
    Bilinear,
    /// As the bilinear Coons patch through the sides.
    Adini,
    /// As given.
    Given([DVec3; 4]),
}

/// A side of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct CoonsSide {
    /// The side.
    pub curve: CurveReference,
    /// The derivative across it.
    pub cross: Option<Sp<Cross>>,
}

table! {
    /// A side of a patch, and how the patch leaves it.
    "coons side" pub CoonsSideFields {
        /// The side.
        curve: CurveReference;
        /// How the patch leaves the side: the derivative into the patch, one vector `[x, y, z]` for the whole side, or a
        /// curve whose points are the vectors, run through like the side. At the corners it is the tangent of the
        /// side beside it.
        cross: Option<Sp<Cross>>;
    }
}

/// The derivative across a side.
#[derive(Clone, Debug, PartialEq)]
pub enum Cross {
    /// The same everywhere.
    Constant(DVec3),
    /// The points of a curve are the derivatives.
    Curve(CurveReference),
}

table! {
    /// A surface through a network of curves: each curve along u meets each along v. Both families are given in order;
    /// what sticks out beyond the first and the last curve of the other family is left out. One family may be of closed
    /// curves, which the other, at least three curves, goes along.
    "gordon" pub Gordon {
        /// The curves along u, in the order of v: names of curves, or curves in place. They may run either way.
        u: Vec<CurveReference> => Check::items(2);
        /// The curves along v, in the order of u.
        v: Vec<CurveReference> => Check::items(2);
        /// How the surface goes on from curve to curve.
        blend: Sp<GordonBlend> = GordonBlend::Spline;
    }
}

choices! {
    /// How a surface goes on from curve to curve of a network.
    GordonBlend {
        /// Smooth across the curves, as a natural spline.
        Spline = "spline";
        /// Straight, with an edge at each curve.
        Linear = "linear";
    }
}

impl Coons {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let whole = self.check_count(span, reader);
        whole && self.check_blend(reader)
    }

    fn check_count(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let count = self.sides.len();
        let report = match (self.point, self.apart.value) {
            (Some(point), _) if count > 0 => {
                Diagnostic::error(Code::Conflict, "a patch has `sides` or a `point`, not both")
                    .at(point.span, "beside `sides`")
            }
            (Some(point), _) if !matches!(self.twist, Some(Sp { value: CoonsTwist::Given(_), .. })) => {
                Diagnostic::error(
                    Code::Conflict,
                    "a patch from a `point` goes where four vectors of `twist` lead, and there are none",
                )
                .at(point.span, "needs `twist`")
                .help("write `twist = [[1, 0, 2], [0, -1, -2], [-1, 0, 2], [0, 1, -2]]`")
            }
            (Some(_), _) => return true,
            (None, _) if count == 0 => Diagnostic::error(Code::WrongCount, "a patch needs sides, found none")
                .at(span, "no side")
                .help("write `sides = [...]` with one to four curves, or a `point` with `twist`"),
            (None, true) if count != 2 => {
                Diagnostic::error(Code::WrongCount, format!("only two sides can stay apart, found {count}"))
                    .at(self.apart.span, "for two sides")
            }
            (None, _) if count > 4 => {
                Diagnostic::error(Code::WrongCount, format!("a patch has at most 4 sides, found {count}"))
                    .at(self.sides[4].curve.span(), "one too many")
                    .help("join curves into one side with a path, or build the surface from several patches")
            }
            _ => return true,
        };
        reader.report(report);
        false
    }

    /// What matters to a bicubic patch alone has no effect on a bilinear one.
    fn check_blend(&self, reader: &mut Reader<'_>) -> bool {
        if self.blend.value == CoonsBlend::Bicubic || self.point.is_some() {
            return true;
        }
        let cross = self.sides.iter().find_map(|side| side.cross.as_ref()).map(|cross| ("cross", cross.span));
        let twist = self.twist.as_ref().map(|twist| ("twist", twist.span));
        let Some((name, span)) = cross.or(twist) else { return true };
        let report = Diagnostic::error(Code::Conflict, format!("`{name}` has no effect on a bilinear patch"))
            .at(span, "no effect")
            .help("write `blend = \"bicubic\"`");
        reader.report(report);
        false
    }
}

impl Read for CoonsTwist {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Array(_)) {
            let vectors = Vec::<DVec3>::read(value, reader)?;
            let count = vectors.len();
            let Ok(vectors) = <[DVec3; 4]>::try_from(vectors) else {
                let message =
                    format!("{} must be four vectors, one for each corner, found {count}", reader.place());
                reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "not four"));
                return None;
            };
            return Some(Self::Given(vectors));
        }
        match choice(value, &["zero", "bilinear", "adini"], reader)? {
            "zero" => Some(Self::Zero),
            "bilinear" => Some(Self::Bilinear),
            _ => Some(Self::Adini),
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut alternatives = one_of_words(&["zero", "bilinear", "adini"]);
        alternatives.push(json!({ "type": "array", "minItems": 4, "maxItems": 4, "items": numbers(3, 3) }));
        any_of(alternatives)
    }
}

impl Read for CoonsSide {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let fields =
            value.table().is_some_and(|table| table.get("curve").is_some() || table.get("cross").is_some());
        if fields {
            let CoonsSideFields { curve, cross } = CoonsSideFields::read(value, reader)?;
            return Some(Self { curve, cross });
        }
        CurveReference::read(value, reader).map(|curve| Self { curve, cross: None })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![CurveReference::schema(schemas), CoonsSideFields::schema(schemas)])
    }
}

impl Read for Cross {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if matches!(value.data, Data::Array(_)) {
            return DVec3::read(value, reader).map(Self::Constant);
        }
        CurveReference::read(value, reader).map(Self::Curve)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![CurveReference::schema(schemas), numbers(3, 3)])
    }
}

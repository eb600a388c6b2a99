//! Morphs: states of a shape that weights bring its vertices to.

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::expression::Computed;
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::name::check_name;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::reference::{ShapeName, SkeletonName};
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

/// The states of a shape, `[morph.SHAPE.TARGET]`, by their names.
pub type Morphs = IndexMap<String, Sp<Morph>>;

table! {
    /// A state of a shape: where its vertices are at weight 1. In between they move along straight lines; several states add
    /// up. A state has the same triangles as its shape, which are fine enough for both.
    "morph" pub Morph {
        /// The same shape with other values of these parameters of the document.
        with: IndexMap<String, Sp<ParameterValue>> = IndexMap::new();
        /// Another shape of the same topology, in place of `with`: polygons with as many points and faces, as of another
        /// frame of a file, or a surface of the same kind and parts.
        shape: Option<Sp<ShapeName>>;
        /// The weight that is shown where no clip moves it.
        weight: Sp<f64> = 0.0 => Check::within(-10.0, 10.0);
        /// The joint whose angle gives the weight in every clip that turns it, as a muscle swells with its joint.
        driver: Option<Sp<MorphDriver>>;
    }
    checked check
}

table! {
    /// A joint whose angle gives the weight of a state: 0 up to `from`, 1 from `to` on, evenly between. Its rotation is taken
    /// apart as for its limits: a swing about x, then one about z, then a twist about y, the bone. At rest all three are 0, and
    /// the weight is 0 too.
    "morph driver" pub MorphDriver {
        /// The joint.
        joint: Sp<String>;
        /// Its skeleton; not needed where the document has one.
        skeleton: Option<Sp<SkeletonName>>;
        /// Which angle.
        axis: Sp<DriverAxis>;
        /// Degrees at which it begins.
        from: Sp<f64> = 0.0 => Check::within(-360.0, 360.0);
        /// Degrees at which it is whole; less than `from` where the joint turns backward.
        to: Sp<f64> => Check::within(-360.0, 360.0);
    }
    checked check
}

choices! {
    /// An angle of a joint.
    DriverAxis {
        /// The swing about x.
        X = "x";
        /// The twist about y, the bone.
        Y = "y";
        /// The swing about z.
        Z = "z";
    }
}

impl MorphDriver {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (from, to) = (self.from.value, self.to.value);
        let place = if self.from.span.is_none() { self.to.span } else { self.from.span };
        let report = if from == to {
            Diagnostic::error(
                Code::OutOfRange,
                format!("a weight goes from `from` to `to`, but both are {}", show_number(to)),
            )
            .at(self.to.span, "no way between")
            .help("write another `to`")
        } else if (to > from && from < 0.0) || (to < from && from > 0.0) {
            let message = format!(
                "at rest the angle is 0, where this state is shown already: it begins at {}",
                show_number(from)
            );
            Diagnostic::error(Code::OutOfRange, message)
                .at(place, "before rest")
                .help("let it begin at 0, or further on")
        } else {
            return true;
        };
        reader.report(report);
        false
    }
}

/// A value of a parameter: a number, true or false, a string, or a list of such.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue(pub Computed);

/// The name of a state: `"SHAPE.TARGET"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MorphName {
    /// The shape.
    pub shape: String,
    /// The state.
    pub target: String,
}

impl Morph {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        if let Some(driver) = self.driver.as_ref().filter(|_| !self.weight.span.is_none()) {
            let report =
                Diagnostic::error(Code::Conflict, "`weight` and `driver` both say the weight at rest")
                    .at(self.weight.span, "said here")
                    .also(driver.span, "0 at rest")
                    .help("leave `weight` out");
            reader.report(report);
            return false;
        }
        let report = match (self.with.values().next(), &self.shape) {
            (Some(_), None) | (None, Some(_)) => return true,
            (None, None) => Diagnostic::error(Code::MissingField, "missing field `with` of morph")
                .at(table, "no state")
                .help("write `with = { PARAMETER = ... }`, or `shape` with the name of another shape"),
            (Some(value), Some(shape)) => {
                Diagnostic::error(Code::Conflict, "`with` and `shape` both say the state")
                    .at(shape.span, "said again")
                    .also(value.span, "said here")
            }
        };
        reader.report(report);
        false
    }
}

/// Reports names of states that are not in kebab-case.
pub(crate) fn check_names(morphs: &Morphs, reader: &mut Reader<'_>) {
    for (name, morph) in morphs {
        reader.diagnostics.extend(check_name("morph", name, morph.span));
    }
}

impl Read for ParameterValue {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let computed = match &value.data {
            Data::Integer(_) | Data::Float(_) => Computed::Number(finite(value, reader)?),
            Data::Boolean(truth) => Computed::Boolean(*truth),
            Data::String(text) => Computed::Text(text.clone()),
            Data::Array(items) => {
                let read = items.iter().map(|item| Self::read(item, reader).map(|item| item.0));
                Computed::List(read.collect::<Option<Vec<_>>>()?)
            }
            _ => {
                reader.mismatch(value, "a number, true or false, a point or a string");
                return None;
            }
        };
        Some(Self(computed))
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": ["number", "boolean", "array", "string"] })
    }
}

impl Read for MorphName {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(text) = &value.data else {
            reader.mismatch(value, "the name of a morph");
            return None;
        };
        if let Some((shape, target)) = text.split_once('.').filter(|(_, target)| !target.contains('.')) {
            return Some(Self { shape: shape.to_owned(), target: target.to_owned() });
        }
        let message = format!("{} names no morph: {}", reader.place(), backtick(text));
        let report = Diagnostic::error(Code::UnknownName, message)
            .at(value.span, "not \"SHAPE.TARGET\"")
            .help("write the name of the shape, a dot and the name of the state, as in [morph.SHAPE.TARGET]");
        reader.report(report);
        None
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }
}

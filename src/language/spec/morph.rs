//! Morphs: states of a shape that weights bring its vertices to.

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::expression::Computed;
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::name::check_name;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::reference::ShapeName;
use crate::language::spec::scalar::finite;
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

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
    }
    checked check
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

//! Attributes of vertices that games read themselves: formulas under names such as `_WIND`.

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The longest name of an attribute.
const LONGEST: usize = 64;

/// The most attributes of a shape: what graphics interfaces promise is sixteen, and half of them are taken.
const MOST: usize = 8;

choices! {
    /// How the numbers of an attribute are written.
    AttributeForm {
        /// In single precision; compressed files keep 16 bits of the greatest.
        Float = "float";
        /// In a byte each, for numbers from 0 to 1 in steps of 1/255. What is beyond is held back. A file always has four; those
        /// without a formula are 0.
        Byte = "byte";
    }
}

/// One formula, or up to four.
#[derive(Clone, Debug, PartialEq)]
pub struct Components(pub Vec<Sp<Formula>>);

table! {
    /// An attribute of vertices that games read themselves.
    "attribute" pub Attribute {
        /// A formula, or a list of up to four, of the place x, y, z before `scale`, `rotate` and `at`, in the document's unit, of
        /// the normal nx, ny, nz there, of the texture coordinates u, v, and with `joint` of its `weight`. When it is not
        /// written, the `weight`.
        formula: Option<Sp<Components>>;
        /// The name of a joint of the shape's skin: `weight` is how much of a vertex it carries, from 0 to 1.
        joint: Option<Sp<String>>;
        /// How its numbers are written.
        form: Sp<AttributeForm> = AttributeForm::Float;
    }
    checked check
}

/// The attributes of a shape, by their names in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes(pub IndexMap<String, Sp<Attribute>>);

impl Attribute {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        if self.formula.is_some() || self.joint.is_some() {
            return true;
        }
        let report = Diagnostic::error(Code::MissingField, "missing `formula` or `joint` of an attribute")
            .at(span, "of what?")
            .help("write `_WIND = \"= y\"`, or `_WIND = { joint = \"branch\" }` for the weight of a joint");
        reader.report(report);
        false
    }
}

impl Read for Components {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Array(items) = &value.data else {
            return Sp::<Formula>::read(value, reader).map(|one| Self(vec![one]));
        };
        if !(1..=4).contains(&items.len()) {
            let message = format!("{} has one to four formulas, found {}", reader.place(), items.len());
            let label = if items.is_empty() { "too few" } else { "too many" };
            reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, label));
            return None;
        }
        let mut read = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            read.extend(reader.within_index(index, |reader| Sp::<Formula>::read(item, reader)));
        }
        (read.len() == items.len()).then_some(Self(read))
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let one = Formula::schema(schemas);
        any_of(vec![one.clone(), json!({ "type": "array", "items": one, "minItems": 1, "maxItems": 4 })])
    }
}

impl Read for Attributes {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Table(table) = &value.data else {
            reader.mismatch(value, "a table");
            return None;
        };
        let mut read = IndexMap::with_capacity(table.entries.len());
        for (name, entry) in &table.entries {
            let named = check_name(name, entry.key, reader);
            let own = reader.within_key(name, |reader| attribute(&entry.value, reader));
            read.extend(own.filter(|_| named).map(|own| (name.clone(), own)));
        }
        if table.entries.len() > MOST {
            let message =
                format!("a shape has at most {MOST} attributes of its own, found {}", table.entries.len());
            reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "too many"));
            return None;
        }
        (read.len() == table.entries.len()).then_some(Self(read))
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let own = any_of(vec![Components::schema(schemas), Attribute::schema(schemas)]);
        json!({ "type": "object", "additionalProperties": own, "propertyNames": { "pattern": "^_[A-Z0-9_]+$" } })
    }
}

/// An attribute as a table, or its formulas alone.
fn attribute(value: &Value, reader: &mut Reader<'_>) -> Option<Sp<Attribute>> {
    if let Data::Table(_) = value.data {
        return Sp::<Attribute>::read(value, reader);
    }
    let formula = Sp::<Components>::read(value, reader)?;
    Some(Sp::new(
        Attribute { formula: Some(formula), joint: None, form: AttributeForm::Float.into() },
        value.span,
    ))
}

/// Reports a name that is none of an attribute of its own; whether it is one.
fn check_name(name: &str, span: Span, reader: &mut Reader<'_>) -> bool {
    let upper = |letter: u8| letter.is_ascii_uppercase() || letter.is_ascii_digit() || letter == b'_';
    let rest = name.strip_prefix('_').unwrap_or("");
    if rest.bytes().any(|letter| letter != b'_') && name.bytes().all(upper) && name.len() <= LONGEST {
        return true;
    }
    let good: String = name.to_ascii_uppercase().replace(|letter: char| !letter.is_ascii_alphanumeric(), "_");
    let good = format!("_{}", good.trim_matches('_'));
    let message = format!("an attribute cannot be called {}", backtick(name));
    let report = Diagnostic::error(Code::AttributeName, message)
        .at(span, "not the name of an attribute")
        .note("an underscore, then capital letters, digits and underscores, 64 of them at most: the format keeps other names for itself");
    let usable = good.len() > 1 && good.len() <= LONGEST;
    reader.report(if usable {
        report.suggest(span, good.clone(), format!("write `{good}`"))
    } else {
        report
    });
    false
}

//! Reading what tables are made of: numbers, words, lists.

use indexmap::IndexMap;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, array, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The greatest number of a document, by size. Its fifth power, which moments of inertia need, is still finite.
pub(crate) const GREATEST: f64 = 1e15;

/// A finite number of the value; reports everything else.
pub(crate) fn finite(value: &Value, reader: &mut Reader<'_>) -> Option<f64> {
    let Some(number) = value.number() else {
        reader.mismatch(value, "a number");
        return None;
    };
    if number.abs() <= GREATEST {
        return Some(number);
    }
    let message = format!("{} must be a finite number, found {}", reader.place(), value.describe());
    let report = Diagnostic::error(Code::NotFinite, message);
    reader.report(if number.is_finite() {
        report.at(value.span, "too large").note(format!("numbers go up to {GREATEST:e}"))
    } else {
        report.at(value.span, "not finite")
    });
    None
}

/// A whole number in a range; reports everything else.
pub(crate) fn whole(value: &Value, least: u64, most: u64, reader: &mut Reader<'_>) -> Option<u64> {
    let Some(number) = value.number().filter(|number| number.is_finite() && number.fract() == 0.0) else {
        reader.mismatch(value, "a whole number");
        return None;
    };
    let whole = match value.data {
        Data::Integer(whole) => u64::try_from(whole).ok(),
        // Exact: a whole number at most 2^53 has an exact u64.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked by the range")]
        _ if (0.0..=9_007_199_254_740_992.0).contains(&number) => Some(number as u64),
        _ => None,
    };
    if let Some(whole) = whole.filter(|whole| (least..=most).contains(whole)) {
        return Some(whole);
    }
    let demand = if most >= u64::from(u32::MAX) && number < 1.0 {
        format!("at least {least}")
    } else {
        format!("from {least} to {most}")
    };
    let message = format!("{} must be {demand}, found {}", reader.place(), value.describe());
    reader.report(Diagnostic::error(Code::OutOfRange, message).at(value.span, format!("not {demand}")));
    None
}

impl Read for f64 {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        finite(value, reader)
    }

    fn schema(_: &mut Schemas) -> Json {
        or_expression("number")
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self))
    }
}

impl Read for u32 {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        whole(value, 0, u64::from(Self::MAX), reader).and_then(|whole| Self::try_from(whole).ok())
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut schema = or_expression("integer");
        schema["minimum"] = json!(0);
        schema
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self))
    }
}

impl Read for u64 {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        whole(value, 0, Self::MAX, reader)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        u32::schema(schemas)
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self))
    }
}

impl Read for bool {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::Boolean(truth) = value.data {
            return Some(truth);
        }
        reader.mismatch(value, "true or false");
        None
    }

    fn schema(_: &mut Schemas) -> Json {
        or_expression("boolean")
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self))
    }
}

impl Read for String {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::String(text) = &value.data {
            return Some(text.clone());
        }
        reader.mismatch(value, "a string");
        None
    }

    fn schema(_: &mut Schemas) -> Json {
        json!({ "type": "string" })
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self))
    }
}

impl<T: Read> Read for Sp<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        T::read(value, reader).map(|read| Self::new(read, value.span))
    }

    fn absent() -> Option<Self> {
        T::absent().map(Self::from)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        T::schema(schemas)
    }

    fn written(&self) -> Option<Json> {
        self.value.written()
    }
}

impl<T: Read> Read for Option<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        T::read(value, reader).map(Some)
    }

    fn absent() -> Option<Self> {
        Some(None)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        T::schema(schemas)
    }

    fn written(&self) -> Option<Json> {
        self.as_ref().and_then(T::written)
    }
}

impl<T: Read> Read for Box<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        T::read(value, reader).map(Self::new)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        T::schema(schemas)
    }
}

impl<T: Read> Read for Vec<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Array(items) = &value.data else {
            reader.mismatch(value, "an array");
            return None;
        };
        let mut read = Self::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            // All items are read, so that every error among them is seen.
            read.extend(reader.within_index(index, |reader| T::read(item, reader)));
        }
        (read.len() == items.len()).then_some(read)
    }

    fn schema(schemas: &mut Schemas) -> Json {
        array(T::schema(schemas))
    }

    fn written(&self) -> Option<Json> {
        self.iter().map(T::written).collect()
    }
}

impl<T: Read> Read for IndexMap<String, T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Table(table) = &value.data else {
            reader.mismatch(value, "a table");
            return None;
        };
        let mut read = Self::with_capacity(table.entries.len());
        for (name, entry) in &table.entries {
            let item = reader.within(name, |reader| T::read(&entry.value, reader));
            read.extend(item.map(|item| (name.clone(), item)));
        }
        (read.len() == table.entries.len()).then_some(read)
    }

    fn absent() -> Option<Self> {
        Some(Self::new())
    }

    fn schema(schemas: &mut Schemas) -> Json {
        json!({ "type": "object", "additionalProperties": T::schema(schemas) })
    }
}

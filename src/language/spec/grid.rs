//! What surfaces over two parameters are given in: grids, pairs of degrees, directions.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::kind::choice;
use crate::language::spec::point::read_numbers;
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::whole;
use crate::language::spec::schema::{Schemas, words};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// Rows of equal length, at least one item in each.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows<T> {
    rows: Vec<Sp<Vec<Sp<T>>>>,
}

impl<T> Rows<T> {
    /// Items in a row: those that u runs along.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.rows.first().map_or(0, |row| row.len())
    }

    /// Rows: those that v runs along.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// All items, row by row.
    pub fn items(&self) -> impl Iterator<Item = &Sp<T>> {
        self.rows.iter().flat_map(|row| row.iter())
    }

    /// One row.
    #[must_use]
    pub fn row(&self, index: usize) -> &Sp<Vec<Sp<T>>> {
        &self.rows[index]
    }
}

impl<T: Read> Read for Rows<T> {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let rows = Vec::<Sp<Vec<Sp<T>>>>::read(value, reader)?;
        let place = reader.place();
        let Some(first) = rows.first() else {
            let message = format!("{place} needs at least 1 row, found none");
            reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, "no rows"));
            return None;
        };
        let mut good = true;
        for (index, row) in rows.iter().enumerate() {
            if row.is_empty() {
                let message = format!("row {index} of {place} is empty");
                reader.report(Diagnostic::error(Code::WrongLength, message).at(row.span, "no items"));
                good = false;
            } else if row.len() != first.len() && !first.is_empty() {
                reader.report(uneven(&place, index, row, first));
                good = false;
            }
        }
        good.then_some(Self { rows })
    }

    fn schema(schemas: &mut Schemas) -> Json {
        Vec::<Vec<T>>::schema(schemas)
    }
}

fn uneven<T>(place: &str, index: usize, row: &Sp<Vec<T>>, first: &Sp<Vec<T>>) -> Diagnostic {
    let message = format!("row {index} of {place} has {} items, row 0 has {}", row.len(), first.len());
    Diagnostic::error(Code::UnevenRows, message)
        .at(row.span, format!("expected {}", first.len()))
        .also(first.span, "the first row")
        .help("every row of a grid has equally many items")
}

/// Degrees of a surface: one number for both directions, or `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Degrees {
    /// Along u.
    pub u: u32,
    /// Along v.
    pub v: u32,
}

/// The highest degree.
const MOST: u64 = 25;

impl Read for Degrees {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let degree = |value: &Value, reader: &mut Reader<'_>| {
            whole(value, 1, MOST, reader).and_then(|whole| u32::try_from(whole).ok())
        };
        if value.number().is_some() {
            return degree(value, reader).map(|both| Self { u: both, v: both });
        }
        read_numbers(value, 2, 2, "a whole number or two [u, v]", reader)?;
        let Data::Array(items) = &value.data else { return None };
        let mut item = |index: usize| reader.within_index(index, |reader| degree(&items[index], reader));
        let (u, v) = (item(0), item(1));
        Some(Self { u: u?, v: v? })
    }

    fn schema(_: &mut Schemas) -> Json {
        let number = json!({ "type": ["integer", "string"], "minimum": 1, "maximum": MOST });
        json!({
            "type": ["integer", "array", "string"],
            "minimum": 1,
            "maximum": MOST,
            "items": number,
            "minItems": 2,
            "maxItems": 2,
        })
    }

    fn written(&self) -> Option<Json> {
        Some(if self.u == self.v { json!(self.u) } else { json!([self.u, self.v]) })
    }
}

/// Directions of a surface: `["u"]`, `["v"]`, both or none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// Whether u is among them.
    pub u: bool,
    /// Whether v is.
    pub v: bool,
}

impl Read for Directions {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Array(items) = &value.data else {
            reader.mismatch(value, "a list of \"u\" and \"v\"");
            return None;
        };
        let mut read = Self::default();
        for (index, item) in items.iter().enumerate() {
            let word = reader.within_index(index, |reader| choice(item, &["u", "v"], reader))?;
            let slot = if word == "u" { &mut read.u } else { &mut read.v };
            if std::mem::replace(slot, true) {
                let message = format!("{} names {word} twice", reader.place());
                reader.report(Diagnostic::error(Code::Conflict, message).at(item.span, "again"));
                return None;
            }
        }
        Some(read)
    }

    fn schema(_: &mut Schemas) -> Json {
        let word = words(&[("u", "Along the rows."), ("v", "From row to row.")]);
        json!({ "type": "array", "items": word, "uniqueItems": true })
    }

    fn written(&self) -> Option<Json> {
        let named = [("u", self.u), ("v", self.v)];
        Some(named.iter().filter(|(_, is)| *is).map(|(name, _)| json!(name)).collect())
    }
}

/// A direction, with the place where it is asked for.
pub(crate) fn direction(directions: &Sp<Directions>, of: impl Fn(&Directions) -> bool) -> Sp<bool> {
    Sp::new(of(directions), directions.span)
}

/// Rows that must fit others: reports those that do not.
pub(crate) fn same_size<T, U>(
    (name, rows): (&str, &Sp<Rows<T>>),
    (other_name, others): (&str, &Sp<Rows<U>>),
    reader: &mut Reader<'_>,
) -> bool {
    if (rows.rows(), rows.columns()) == (others.rows(), others.columns()) {
        return true;
    }
    let size = |rows: usize, columns: usize| format!("{rows} rows of {columns}");
    let message = format!(
        "`{name}` has {}, `{other_name}` has {}",
        size(rows.rows(), rows.columns()),
        size(others.rows(), others.columns())
    );
    let report = Diagnostic::error(Code::WrongCount, message)
        .at(rows.span, "not of the same size")
        .also(others.span, "one for each of these");
    reader.report(report);
    false
}

//! Points, vectors and what is written as one number or several.

use glam::{DVec2, DVec3};
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::scalar::{finite, whole};
use crate::language::spec::schema::{Schemas, numbers};
use crate::language::value::{Data, Value};

/// A point of a curve: `[x, y]` in the curve's plane, or `[x, y, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is, in the document's unit; z is 0 where two numbers are written.
    pub position: DVec3,
    /// Whether it is written with two numbers.
    pub planar: bool,
}

impl Point {
    /// `[0, 0]`.
    pub const ORIGIN: Self = Self::planar(0.0, 0.0);

    /// `[x, y]`.
    #[must_use]
    pub const fn planar(x: f64, y: f64) -> Self {
        Self { position: DVec3::new(x, y, 0.0), planar: true }
    }

    /// The coordinates in the plane.
    #[must_use]
    pub fn xy(&self) -> DVec2 {
        self.position.truncate()
    }
}

impl Read for Point {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match read_numbers(value, 2, 3, "a point [x, y] or [x, y, z]", reader)?.as_slice() {
            [x, y] => Some(Self::planar(*x, *y)),
            [x, y, z] => Some(Self { position: DVec3::new(*x, *y, *z), planar: false }),
            _ => None,
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        numbers(2, 3)
    }

    fn written(&self) -> Option<Json> {
        let DVec3 { x, y, z } = self.position;
        Some(if self.planar { json!([x, y]) } else { json!([x, y, z]) })
    }
}

impl Read for DVec2 {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let read = read_numbers(value, 2, 2, "two numbers [x, y]", reader)?;
        Some(Self::new(read[0], read[1]))
    }

    fn schema(_: &mut Schemas) -> Json {
        numbers(2, 2)
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self.to_array()))
    }
}

impl Read for DVec3 {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let read = read_numbers(value, 3, 3, "three numbers [x, y, z]", reader)?;
        Some(Self::new(read[0], read[1], read[2]))
    }

    fn schema(_: &mut Schemas) -> Json {
        numbers(3, 3)
    }

    fn written(&self) -> Option<Json> {
        Some(json!(self.to_array()))
    }
}

/// Reads from `least` to `most` numbers; reports surplus and missing ones.
pub(crate) fn read_numbers(
    value: &Value,
    least: usize,
    most: usize,
    expected: &str,
    reader: &mut Reader<'_>,
) -> Option<Vec<f64>> {
    let Data::Array(items) = &value.data else {
        reader.mismatch(value, expected);
        return None;
    };
    if items.len() < least || items.len() > most {
        let count = if items.len() == 1 { "1 number".to_owned() } else { format!("{} numbers", items.len()) };
        let message = format!("{} must be {expected}, found {count}", reader.place());
        let label = if items.len() < least { "too few" } else { "too many" };
        reader.report(Diagnostic::error(Code::WrongLength, message).at(value.span, label));
        return None;
    }
    let mut read = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        read.extend(reader.within_index(index, |reader| finite(item, reader)));
    }
    (read.len() == items.len()).then_some(read)
}

/// A factor for all directions or one for each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(pub DVec3);

impl From<DVec3> for Scale {
    fn from(factors: DVec3) -> Self {
        Self(factors)
    }
}

impl Read for Scale {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if value.number().is_some() {
            return finite(value, reader).map(|factor| Self(DVec3::splat(factor)));
        }
        let factors = read_numbers(value, 3, 3, "a number or three numbers [x, y, z]", reader)?;
        Some(Self(DVec3::new(factors[0], factors[1], factors[2])))
    }

    fn schema(_: &mut Schemas) -> Json {
        one_or_many("number", 3)
    }

    fn written(&self) -> Option<Json> {
        let DVec3 { x, y, z } = self.0;
        Some(if x == y && y == z { json!(x) } else { json!([x, y, z]) })
    }
}

/// How many pieces a fixed grid has: `n` for both directions, or `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segments {
    /// Along the first parameter: around a revolve, along a sweep's profile.
    pub u: u32,
    /// Along the second parameter; the same as `u` where one number is written.
    pub v: u32,
}

/// The most pieces of a fixed grid in one direction.
const MOST_SEGMENTS: u64 = 1_000_000;

impl Read for Segments {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let counts = read_counts(value, 2, "a whole number or two [u, v]", reader)?;
        Some(Self { u: *counts.first()?, v: *counts.last()? })
    }

    fn schema(_: &mut Schemas) -> Json {
        one_or_many("integer", 2)
    }
}

/// How many copies an array makes: `n` in a row, or `[nx, ny, nz]` in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// In a row; each step applies offset and rotation once more.
    Row(u32),
    /// In a block; the offset gives the spacing along each axis.
    Block([u32; 3]),
}

impl Read for Count {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match read_counts(value, 3, "a whole number or three [x, y, z]", reader)?.as_slice() {
            [count] => Some(Self::Row(*count)),
            [x, y, z] => Some(Self::Block([*x, *y, *z])),
            _ => None,
        }
    }

    fn schema(_: &mut Schemas) -> Json {
        one_or_many("integer", 3)
    }
}

fn read_counts(value: &Value, many: usize, expected: &str, reader: &mut Reader<'_>) -> Option<Vec<u32>> {
    let count = |value: &Value, reader: &mut Reader<'_>| {
        whole(value, 1, MOST_SEGMENTS, reader).and_then(|whole| u32::try_from(whole).ok())
    };
    if value.number().is_some() {
        return count(value, reader).map(|whole| vec![whole]);
    }
    read_numbers(value, many, many, expected, reader)?;
    let Data::Array(items) = &value.data else { return None };
    let mut read = Vec::with_capacity(many);
    for (index, item) in items.iter().enumerate() {
        read.extend(reader.within_index(index, |reader| count(item, reader)));
    }
    (read.len() == many).then_some(read)
}

fn one_or_many(kind: &str, many: usize) -> Json {
    let mut schema = numbers(many, many);
    schema["type"] = json!([kind, "array", "object", "string"]);
    schema["items"]["type"] = json!([kind, "string"]);
    schema
}

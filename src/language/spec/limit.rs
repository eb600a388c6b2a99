//! Limits: how much a document may ask for.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::construct::table;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::scalar::whole;
use crate::language::spec::schema::{Schemas, or_expression};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// How much a document may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Triangles of one asset.
    pub triangles: u64,
    /// Vertices of one asset.
    pub vertices: u64,
    /// Bytes of memory.
    pub memory: u64,
    /// Pixels of one image.
    pub image_pixels: u64,
    /// How deep definitions, expressions and tables may be nested.
    pub recursion: u32,
    /// Steps of work.
    pub steps: u64,
}

/// Bytes of a pixel while a picture is read and written: as it is unpacked, and packed again.
const BYTES_OF_PIXEL: u64 = 8;
/// Bytes of a sample of a map of heights, with the ranges over parts of the map: what the peak of a process grows by.
const BYTES_OF_SAMPLE: u64 = 13;

impl Limits {
    /// Most pixels of one image, for the memory too.
    #[must_use]
    pub const fn pixels(&self) -> u64 {
        least(self.image_pixels, self.memory / BYTES_OF_PIXEL)
    }

    /// Most samples of one map of heights: as many as pixels of an image, for the memory too.
    #[must_use]
    pub const fn samples(&self) -> u64 {
        least(self.image_pixels, self.memory / BYTES_OF_SAMPLE)
    }
}

const fn least(one: u64, other: u64) -> u64 {
    if one < other { one } else { other }
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            triangles: 50_000_000,
            vertices: 50_000_000,
            memory: 8 << 30,
            image_pixels: 268_435_456,
            recursion: 64,
            steps: 10_000_000_000,
        }
    }
}

table! {
    /// How much this document may ask for. A document can only lower the limits.
    "limits" pub(crate) LimitFields {
        /// Most triangles of one asset; 50 million when it is not written.
        triangles: Option<Sp<u64>>;
        /// Most vertices of one asset; 50 million when it is not written.
        vertices: Option<Sp<u64>>;
        /// Most memory, in bytes or as in `"512 MiB"`; 8 GiB when it is not written.
        memory: Option<Sp<Bytes>>;
        /// Most pixels of one image; 268435456 when it is not written.
        image_pixels: Option<Sp<u64>>;
        /// How deep definitions and expressions may be nested; 64 when it is not written.
        recursion: Option<Sp<u32>>;
        /// Most steps of work; 10^10 when it is not written.
        steps: Option<Sp<u64>>;
    }
}

/// A size of memory in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bytes(pub(crate) u64);

/// Units of memory, with the letters that name them.
const UNITS: [(&str, u64); 8] = [
    ("KiB", 1 << 10),
    ("MiB", 1 << 20),
    ("GiB", 1 << 30),
    ("TiB", 1 << 40),
    ("kB", 1_000),
    ("MB", 1_000_000),
    ("GB", 1_000_000_000),
    ("B", 1),
];

impl Read for Bytes {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::String(text) = &value.data else {
            return whole(value, 0, u64::MAX, reader).map(Self);
        };
        let read = parse_bytes(text);
        if read.is_none() {
            let message = format!("{} is no size of memory: {}", reader.place(), backtick(text));
            let report = Diagnostic::error(Code::Malformed, message)
                .at(value.span, "expected a number and a unit, as in \"512 MiB\"")
                .note("units: B, kB, MB, GB, KiB, MiB, GiB, TiB");
            reader.report(report);
        }
        read.map(Self)
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut schema = or_expression("integer");
        schema["pattern"] = json!("^(= |[0-9]+ ?([KMGT]iB|[kMG]?B)$)");
        schema["minimum"] = json!(0);
        schema
    }
}

/// The number of bytes that a text such as `500 MB` or `2 GiB` says.
pub(crate) fn parse_bytes(text: &str) -> Option<u64> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    let (number, unit) = text.split_at(digits);
    let unit = unit.strip_prefix(' ').unwrap_or(unit);
    let (_, factor) = UNITS.iter().find(|(name, _)| *name == unit)?;
    number.parse::<u64>().ok()?.checked_mul(*factor)
}

impl LimitFields {
    /// The limits that hold when a document with these fields is built under `outer` ones. A field that
    /// would raise a limit is an error.
    pub(crate) fn under(&self, outer: Limits, reader: &mut Reader<'_>) -> Limits {
        let memory = self.memory.map(|bytes| Sp::new(bytes.value.0, bytes.span));
        let recursion = self.recursion.map(|depth| Sp::new(u64::from(depth.value), depth.span));
        let recursion = lower("recursion", recursion, u64::from(outer.recursion), reader);
        Limits {
            triangles: lower("triangles", self.triangles, outer.triangles, reader),
            vertices: lower("vertices", self.vertices, outer.vertices, reader),
            memory: lower("memory", memory, outer.memory, reader),
            image_pixels: lower("image-pixels", self.image_pixels, outer.image_pixels, reader),
            recursion: u32::try_from(recursion).unwrap_or(outer.recursion),
            steps: lower("steps", self.steps, outer.steps, reader),
        }
    }
}

fn lower(name: &str, field: Option<Sp<u64>>, outer: u64, reader: &mut Reader<'_>) -> u64 {
    let Some(field) = field else { return outer };
    if field.value <= outer {
        return field.value;
    }
    let message = format!("a document can only lower `{name}`: {} is above {outer}", field.value);
    let report = Diagnostic::error(Code::LimitRaised, message)
        .at(field.span, format!("at most {outer}"))
        .help("leave it out, or write less");
    reader.report(report);
    outer
}

//! What the targets share: documents made of bytes, and what must hold of every bake.
//!
//! A target turns any bytes into a document, so that what the engine changes is numbers and choices, not syntax. The
//! document is baked under small limits. It must not panic or hang; what it refuses it must refuse with a message and a
//! place; what it writes must be a file whose numbers are all finite and whose indices all exist.

use std::fmt::Write as _;

use kiln::compile::{Compiled, Options};
use kiln::language::Document;
use kiln::language::diagnostic::{Code, Diagnostics, Severity};
use kiln::language::source::MemoryFiles;
use libfuzzer_sys::arbitrary::Unstructured;
use serde_json::Value;

/// Limits under which everything ends soon.
pub const LIMITS: &str = "[limits]\ntriangles = 20000\nvertices = 20000\nmemory = \"256 MiB\"\nimage-pixels = 65536\nsteps = 3000000\n";

/// Numbers at which arithmetic goes wrong.
const EXTREMES: [f64; 12] = [0.0, 1e-300, 1e-12, 1e-9, 1e-4, 1.0, 90.0, 360.0, 1e4, 1e9, 1e15, 1e300];

/// Choices and numbers out of bytes; zeros when they are used up.
pub struct Words<'a> {
    bytes: Unstructured<'a>,
    last: f64,
}

impl<'a> Words<'a> {
    /// Begins with the first byte.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: Unstructured::new(bytes), last: 0.0 }
    }

    /// A number below another.
    pub fn below(&mut self, count: usize) -> usize {
        self.bytes.int_in_range(0..=count.max(1) - 1).unwrap_or(0)
    }

    /// A number from one to another, both included.
    pub fn from_to(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    /// True once in so many times.
    pub fn once_in(&mut self, count: usize) -> bool {
        self.below(count) + 1 == count
    }

    /// One of several words.
    pub fn pick<'w>(&mut self, words: &[&'w str]) -> &'w str {
        words[self.below(words.len())]
    }

    /// A coordinate: mostly of common size and on a grid where things coincide, sometimes extreme, sometimes the last
    /// one again.
    pub fn number(&mut self) -> f64 {
        let kind: u8 = self.bytes.arbitrary().unwrap_or(0);
        let sign = if kind & 128 == 0 { 1.0 } else { -1.0 };
        let number = match kind % 128 {
            0..=63 => f64::from(self.bytes.arbitrary::<u8>().unwrap_or(0)) / 16.0,
            64..=99 => f64::from(self.bytes.arbitrary::<u16>().unwrap_or(0)) / 4096.0,
            100..=107 => self.last.abs(),
            108..=111 => self.last.abs() * (1.0 + 1e-14),
            112..=119 => EXTREMES[self.below(EXTREMES.len())],
            _ => {
                let bits: u64 = self.bytes.arbitrary().unwrap_or(0);
                let number = f64::from_bits(bits).abs();
                if number.is_finite() { number } else { 0.5 }
            }
        };
        self.last = sign * number;
        self.last
    }

    /// A number that mostly is a size: positive and not far from 1.
    pub fn size(&mut self) -> f64 {
        if self.once_in(16) { self.number() } else { 0.0625 * self.from_to(1, 64) as f64 }
    }

    /// `[1.0, 2.0]`.
    pub fn numbers(&mut self, count: usize) -> String {
        let all: Vec<String> = (0..count).map(|_| format!("{:?}", self.number())).collect();
        format!("[{}]", all.join(", "))
    }

    /// Numbers that do not decrease, or nearly so.
    pub fn knots(&mut self, count: usize) -> String {
        let mut knot = 0.0;
        let mut all = Vec::new();
        for _ in 0..count {
            if !self.once_in(3) {
                knot += if self.once_in(8) { self.number() } else { 0.25 * self.below(9) as f64 };
            }
            all.push(format!("{knot:?}"));
        }
        format!("[{}]", all.join(", "))
    }

    /// `[[1.0, 2.0], [3.0, 4.0]]`.
    pub fn points(&mut self, count: usize, width: usize) -> String {
        let all: Vec<String> = (0..count).map(|_| self.numbers(width)).collect();
        format!("[{}]", all.join(", "))
    }

    /// Rows of points.
    pub fn grid(&mut self, rows: usize, columns: usize, width: usize) -> String {
        let all: Vec<String> = (0..rows).map(|_| self.points(columns, width)).collect();
        format!("[{}]", all.join(", "))
    }

    /// Adds `key = value` for a value that is written once in so many times.
    pub fn perhaps(
        &mut self,
        text: &mut String,
        count: usize,
        key: &str,
        value: impl Fn(&mut Self) -> String,
    ) {
        if self.once_in(count) {
            let value = value(self);
            let _ = writeln!(text, "{key} = {value}");
        }
    }
}

/// Bakes a document that a target made and that is sound but for its numbers: what says otherwise is a fault of the target.
pub fn bake_made(text: &str) {
    if let Some(refused) = baked(text, &[]) {
        let unsound = [
            Code::UnknownField,
            Code::MissingField,
            Code::NoKind,
            Code::ManyKinds,
            Code::UnknownChoice,
            Code::Syntax,
        ];
        let fault = refused.iter().find(|one| unsound.contains(&one.code));
        assert!(
            fault.is_none(),
            "the target makes no sound document: {}\n{text}",
            fault.map_or("", |one| &one.message)
        );
    }
}

/// Bakes a document with the files that it names, and checks what comes out.
pub fn bake(text: &str, files: &[(&str, &[u8])]) {
    baked(text, files);
}

fn baked(text: &str, files: &[(&str, &[u8])]) -> Option<Diagnostics> {
    if std::env::var_os("KILN_FUZZ_SHOW").is_some() {
        eprintln!("{text}");
    }
    let mut all = MemoryFiles::new().with("spec.toml", text);
    for (path, bytes) in files {
        all = all.with(*path, bytes.to_vec());
    }
    let outcome = Document::load("spec.toml", &all).and_then(|document| {
        kiln::compile(&document, &all, &Options { name: "x".to_owned(), ..Options::default() })
    });
    match outcome {
        Ok(compiled) => {
            check(&compiled);
            None
        }
        Err(diagnostics) => {
            check_refusal(&diagnostics);
            Some(diagnostics)
        }
    }
}

fn check_refusal(diagnostics: &Diagnostics) {
    let errors = diagnostics.iter().filter(|one| one.severity == Severity::Error);
    assert!(errors.count() > 0, "refused without an error");
    assert!(diagnostics.iter().all(|one| !one.message.is_empty()), "an empty message");
    let inside = diagnostics.iter().find(|one| one.message.contains("failed inside"));
    assert!(inside.is_none(), "{}", inside.map_or("", |one| one.message.as_str()));
}

fn number(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
}

/// Every number of a file is finite and every index exists, read with nothing of what wrote it.
fn check(compiled: &Compiled) {
    let bytes = &compiled.bytes;
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!(number(bytes, 8), bytes.len());
    let json: Value = serde_json::from_slice(&bytes[20..20 + number(bytes, 12)]).expect("JSON");
    let empty = Vec::new();
    let list = |name: &str| json[name].as_array().unwrap_or(&empty);
    let binary = 28 + number(bytes, 12);
    let place = |value: &Value| value.as_u64().map_or(0, |number| usize::try_from(number).expect("it fits"));
    for accessor in list("accessors") {
        if accessor["componentType"] != 5126 || accessor.get("bufferView").is_none() {
            continue;
        }
        let view = &list("bufferViews")[place(&accessor["bufferView"])];
        let width = match accessor["type"].as_str() {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            _ => 16,
        };
        let stride = match place(&view["byteStride"]) {
            0 => 4 * width,
            stride => stride,
        };
        let start = binary + place(&view["byteOffset"]) + place(&accessor["byteOffset"]);
        for element in 0..place(&accessor["count"]) {
            for part in 0..width {
                let at = start + element * stride + 4 * part;
                let value = f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
                assert!(value.is_finite(), "a number that is not finite");
            }
        }
    }
    for mesh in list("meshes") {
        for primitive in mesh["primitives"].as_array().unwrap_or(&empty) {
            let count = place(&list("accessors")[place(&primitive["attributes"]["POSITION"])]["count"]);
            let Some(indices) = primitive.get("indices") else { continue };
            let accessor = &list("accessors")[place(indices)];
            let view = &list("bufferViews")[place(&accessor["bufferView"])];
            let start = binary + place(&view["byteOffset"]) + place(&accessor["byteOffset"]);
            let wide = accessor["componentType"] == 5125;
            for k in 0..place(&accessor["count"]) {
                let index = if wide {
                    number(bytes, start + 4 * k)
                } else {
                    usize::from(u16::from_le_bytes([bytes[start + 2 * k], bytes[start + 2 * k + 1]]))
                };
                assert!(index < count, "an index without a vertex");
            }
        }
    }
}

//! The binary chunk in the making: views of equal kind are one, what is equal is there once.
//!
//! Promise: numbers of accessors and views are final when they are given out; those that an unknown extension may know keep
//! theirs. Compressed views are as long as the elements say; a view that compression does not make shorter stays plain.

use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hasher as _};
use std::ops::Range;

use rayon::prelude::{IntoParallelRefMutIterator as _, ParallelIterator as _};
use serde_json::{Value, json};

use super::document::{Object, list};
use super::pin::Pins;
use crate::packing::{Codec, encode_attributes, encode_sequence, encode_triangles};

/// What stands in a view, and so how it is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Content {
    /// Anything, as it is.
    Plain,
    /// Elements of equal length.
    Rows,
    /// Unit vectors on the octahedron.
    Directions,
    /// Floats with their exponents.
    Exponents,
    /// Quaternions as three of their parts.
    Quaternions,
    /// Indices of triangles.
    Triangles,
    /// Indices of other things.
    Indices,
}

impl Content {
    /// The filter that its bytes are read through.
    const fn filter(self) -> Option<&'static str> {
        match self {
            Self::Directions => Some("OCTAHEDRAL"),
            Self::Exponents => Some("EXPONENTIAL"),
            Self::Quaternions => Some("QUATERNION"),
            _ => None,
        }
    }
}

/// Attributes of vertices, in the words of the specification.
pub(super) const VERTICES: u16 = 34962;

/// Indices.
pub(super) const INDICES: u16 = 34963;

/// What the bytes of a view are.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Kind {
    /// What they say, so that like stands beside like.
    pub(super) name: String,
    pub(super) content: Content,
    /// Bytes of an element.
    pub(super) stride: usize,
    pub(super) target: Option<u16>,
}

struct Stream {
    kind: Kind,
    bytes: Vec<u8>,
    /// Bytes for accessors to find again: their length and hash, and where they stand.
    known: HashMap<(usize, u64), usize>,
    /// What is written of the view beside where it stands.
    told: Object,
    /// The least number of vertices that its indices name.
    vertices: usize,
    view: usize,
}

/// Numbers that are given out, but for some that are taken.
struct Numbers {
    next: usize,
    taken: BTreeSet<usize>,
}

impl Numbers {
    fn give(&mut self) -> usize {
        while self.taken.contains(&self.next) {
            self.next += 1;
        }
        self.next += 1;
        self.next - 1
    }
}

/// Views and accessors.
pub(super) struct Output {
    streams: Vec<Stream>,
    /// Streams by what they are; only looked up.
    kinds: HashMap<Kind, usize>,
    /// For each view of the source that is copied its stream; only looked up.
    copies: HashMap<usize, usize>,
    accessors: Vec<(usize, Value)>,
    /// Accessors by what they say; only looked up.
    told: HashMap<String, usize>,
    view_numbers: Numbers,
    accessor_numbers: Numbers,
    codec: Option<Codec>,
}

/// A place in a view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    stream: usize,
    pub(super) start: usize,
}

/// The buffers, views and accessors of a file.
pub(super) struct Finished {
    pub(super) binary: Vec<u8>,
    pub(super) buffers: Vec<Value>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
    /// Whether a view is compressed.
    pub(super) compressed: bool,
}

impl Output {
    /// Nothing yet; views are compressed by a codec where there is one.
    pub(super) fn new(pins: &Pins, codec: Option<Codec>) -> Self {
        let numbers = |taken: &BTreeSet<usize>| Numbers { next: 0, taken: taken.clone() };
        Self {
            streams: Vec::new(),
            kinds: HashMap::new(),
            copies: HashMap::new(),
            accessors: Vec::new(),
            told: HashMap::new(),
            view_numbers: numbers(&pins.views),
            accessor_numbers: numbers(&pins.accessors),
            codec,
        }
    }

    /// Whether no view is compressed.
    pub(super) fn is_plain(&self) -> bool {
        self.codec.is_none()
    }

    /// Takes bytes into the view of their kind.
    pub(super) fn put(&mut self, kind: &Kind, bytes: Vec<u8>) -> Span {
        let stream = match self.kinds.get(kind) {
            Some(stream) => *stream,
            None => {
                let view = self.view_numbers.give();
                let made = self.stream(kind.clone(), Vec::new(), Object::new(), view);
                self.kinds.insert(kind.clone(), made);
                made
            }
        };
        let own = &mut self.streams[stream];
        let mut hasher = DefaultHasher::new();
        hasher.write(&bytes);
        let key = (bytes.len(), hasher.finish());
        if let Some(start) = own.known.get(&key)
            && own.bytes[*start..*start + bytes.len()] == bytes
        {
            return Span { stream, start: *start };
        }
        let start = own.bytes.len();
        own.known.insert(key, start);
        if start == 0 {
            own.bytes = bytes;
        } else {
            own.bytes.extend_from_slice(&bytes);
        }
        Span { stream, start }
    }

    /// Says that indices of a view name vertices below a number.
    pub(super) fn name_vertices(&mut self, span: Span, vertices: usize) {
        let own = &mut self.streams[span.stream];
        own.vertices = own.vertices.max(vertices);
    }

    /// A view of its own, of bytes that stay as they are.
    pub(super) fn plain(&mut self, bytes: Vec<u8>, told: Object) -> usize {
        let view = self.view_numbers.give();
        let kind = Kind { name: String::new(), content: Content::Plain, stride: 1, target: None };
        self.stream(kind, bytes, told, view);
        view
    }

    /// A view of the source as it is, at its place where it is `kept`.
    pub(super) fn copied(&mut self, (index, bytes): (usize, &[u8]), view: &Value, kept: bool) -> usize {
        if let Some(stream) = self.copies.get(&index) {
            return self.streams[*stream].view;
        }
        let mut told = view.as_object().cloned().unwrap_or_default();
        for name in ["buffer", "byteOffset", "byteLength"] {
            told.remove(name);
        }
        if let Some(own) = told.get_mut("extensions").and_then(Value::as_object_mut) {
            crate::packing::EXTENSIONS.into_iter().for_each(|name| drop(own.remove(name)));
            if own.is_empty() {
                told.remove("extensions");
            }
        }
        let number = if kept { index } else { self.view_numbers.give() };
        let kind = Kind { name: String::new(), content: Content::Plain, stride: 1, target: None };
        let stream = self.stream(kind, bytes.to_vec(), told, number);
        self.copies.insert(index, stream);
        number
    }

    fn stream(&mut self, kind: Kind, bytes: Vec<u8>, told: Object, view: usize) -> usize {
        let known = HashMap::new();
        self.streams.push(Stream { kind, bytes, known, told, vertices: 0, view });
        self.streams.len() - 1
    }

    /// An accessor at a place in a view; one that says the same stands for it.
    pub(super) fn accessor(&mut self, span: Span, mut told: Object) -> usize {
        let own = &mut self.streams[span.stream];
        told.insert("bufferView".to_owned(), json!(own.view));
        if span.start > 0 {
            told.insert("byteOffset".to_owned(), json!(span.start));
        }
        self.push(told)
    }

    /// An accessor that names its views itself.
    pub(super) fn push(&mut self, told: Object) -> usize {
        let told = Value::Object(told);
        let text = told.to_string();
        if let Some(known) = self.told.get(&text) {
            return *known;
        }
        let number = self.accessor_numbers.give();
        self.told.insert(text, number);
        self.accessors.push((number, told));
        number
    }

    /// An accessor at its own place.
    pub(super) fn keep(&mut self, number: usize, told: Value) {
        self.accessors.push((number, told));
    }

    /// Writes everything. Linear in the bytes, views beside each other.
    pub(super) fn finish(mut self, root: &Object) -> Finished {
        let codec = self.codec;
        let packed: Vec<Option<Vec<u8>>> =
            self.streams.par_iter_mut().map(|stream| codec.and_then(|codec| packed(stream, codec))).collect();
        let stored = |(stream, packed): (&Stream, &Option<Vec<u8>>)| {
            packed.as_ref().map_or(stream.bytes.len(), Vec::len).next_multiple_of(4)
        };
        let length = self.streams.iter().zip(&packed).map(stored).sum::<usize>();
        // The JSON is put before: room for most, so that the bytes are not copied for it.
        let mut binary: Vec<u8> = Vec::with_capacity(length + length / 64 + 65536);
        let mut plain = 0;
        let mut views = Vec::with_capacity(self.streams.len());
        for (stream, packed) in self.streams.iter_mut().zip(packed) {
            let start = binary.len();
            let length = stream.bytes.len();
            let mut told = std::mem::take(&mut stream.told);
            told.insert("byteLength".to_owned(), json!(length));
            if let Some(target) = stream.kind.target {
                told.insert("target".to_owned(), json!(target));
            }
            if stream.kind.target == Some(VERTICES) && stream.kind.content != Content::Plain {
                told.insert("byteStride".to_owned(), json!(stream.kind.stride));
            }
            let (buffer, offset) = match (&packed, codec) {
                (Some(packed), Some(codec)) => {
                    binary.extend_from_slice(packed);
                    let own = extension(stream, start..binary.len());
                    told.insert("extensions".to_owned(), json!({ codec.extension(): own }));
                    let offset = plain;
                    plain += length.next_multiple_of(4);
                    (1, offset)
                }
                _ => {
                    binary.extend_from_slice(&stream.bytes);
                    (0, start)
                }
            };
            stream.bytes = Vec::new();
            told.insert("buffer".to_owned(), json!(buffer));
            if offset > 0 {
                told.insert("byteOffset".to_owned(), json!(offset));
            }
            binary.resize(binary.len().next_multiple_of(4), 0);
            views.push((stream.view, Value::Object(told)));
        }
        let mut first = list(root, "buffers").first().and_then(Value::as_object).cloned().unwrap_or_default();
        for name in ["uri", "extensions"] {
            first.remove(name);
        }
        first.insert("byteLength".to_owned(), json!(binary.len()));
        let mut buffers = if binary.is_empty() { Vec::new() } else { vec![Value::Object(first)] };
        let compressed = plain > 0;
        if let Some(codec) = codec.filter(|_| compressed) {
            let fallback = json!({ codec.extension(): { "fallback": true } });
            buffers.push(json!({ "byteLength": plain, "extensions": fallback }));
        }
        Finished { binary, buffers, views: in_order(views), accessors: in_order(self.accessors), compressed }
    }
}

/// Members at their places; where nothing stands, a copy of a neighbor keeps the others there.
fn in_order(mut all: Vec<(usize, Value)>) -> Vec<Value> {
    all.sort_by_key(|(number, _)| *number);
    let mut made: Vec<Value> = Vec::with_capacity(all.len());
    for (number, value) in all {
        made.resize(number, value.clone());
        made.push(value);
    }
    made
}

/// What the JSON of a compressed view costs beyond that of a plain one.
const OVERHEAD: usize = 120;

/// The compressed bytes of a view; none where it stays plain.
fn packed(stream: &Stream, codec: Codec) -> Option<Vec<u8>> {
    let Kind { content, stride, .. } = stream.kind;
    let indices = || -> Vec<u32> {
        let word = |element: &[u8]| {
            let mut word = [0; 4];
            word[..stride].copy_from_slice(element);
            u32::from_le_bytes(word)
        };
        stream.bytes.chunks_exact(stride).map(word).collect()
    };
    let made = match content {
        Content::Plain => None,
        Content::Triangles => encode_triangles(&indices(), stream.vertices),
        Content::Indices => encode_sequence(&indices(), stream.vertices),
        _ => encode_attributes(&stream.bytes, stride, codec),
    }?;
    let shorter = made.len() + OVERHEAD < stream.bytes.len();
    (shorter || content.filter().is_some()).then_some(made)
}

fn extension(stream: &Stream, stored: Range<usize>) -> Value {
    let Kind { content, stride, .. } = stream.kind;
    let mut told = Object::new();
    told.insert("buffer".to_owned(), json!(0));
    if stored.start > 0 {
        told.insert("byteOffset".to_owned(), json!(stored.start));
    }
    told.insert("byteLength".to_owned(), json!(stored.len()));
    told.insert("byteStride".to_owned(), json!(stride));
    told.insert("count".to_owned(), json!(stream.bytes.len() / stride));
    let mode = match content {
        Content::Triangles => "TRIANGLES",
        Content::Indices => "INDICES",
        _ => "ATTRIBUTES",
    };
    told.insert("mode".to_owned(), json!(mode));
    if let Some(filter) = content.filter() {
        told.insert("filter".to_owned(), json!(filter));
    }
    Value::Object(told)
}

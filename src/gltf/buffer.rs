//! The binary chunk and the views and accessors into it.

use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Buffer, Stride, Target, View};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{Accessor, Index, Root, Value, extensions};
use serde_json::{Map, json};

use super::duplicate::{Views, share};
use crate::geometry::mesh;
use crate::packing::{Codec, EXTENSION, encode_attributes, encode_sequence, encode_triangles};

/// The binary chunk in the making.
pub(super) struct Binary {
    pub(super) bytes: Vec<u8>,
    /// Where views are compressed, the bytes that they stand for so far.
    plain: Option<usize>,
    views: Views,
}

/// Elements of an accessor.
pub(super) struct Elements {
    pub(super) component: ComponentType,
    pub(super) shape: Type,
    pub(super) count: usize,
}

/// What stands in a view, and so how it is compressed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    /// Pictures, which are compressed already.
    Picture,
    /// Elements of so many bytes.
    Attributes { stride: usize },
    /// Unit vectors on the octahedron where views are compressed, and as they are where not.
    Directions,
    /// Floats with one exponent, of so many bytes an element.
    Exponential { stride: usize },
    /// Indices of triangles of so many bytes, among so many vertices.
    Triangles { width: usize, vertices: usize },
    /// Indices of lines.
    Lines { width: usize, vertices: usize },
}

impl Binary {
    pub(super) fn new(capacity: usize, compressed: bool) -> Self {
        Self { bytes: Vec::with_capacity(capacity), plain: compressed.then_some(0), views: Views::default() }
    }

    /// Whether views are compressed.
    pub(super) fn is_compressed(&self) -> bool {
        self.plain.is_some()
    }

    /// Starts a view on a multiple of four.
    pub(super) fn start(&mut self) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.bytes.len()
    }

    /// Ends the view begun at `start`; one like it that was written before stands for it.
    pub(super) fn view(
        &mut self,
        root: &mut Root,
        start: usize,
        target: Option<Target>,
        content: Content,
    ) -> Index<View> {
        let length = self.bytes.len() - start;
        let packing = self.plain.and_then(|_| packed(&self.bytes[start..], content));
        // A view that compression makes longer stays as it is, unless a filter has been applied to it.
        let filtered = matches!(content, Content::Directions | Content::Exponential { .. });
        let packing = packing.filter(|(packed, _)| packed.len() < length || filtered);
        if let Some((packed, _)) = &packing {
            self.bytes.truncate(start);
            self.bytes.extend_from_slice(packed);
        }
        let stored = (target, packing.is_some());
        if let Some(known) = self.views.find((&self.bytes, start), content, stored) {
            self.bytes.truncate(start);
            share(&mut root.buffer_views[known.value()], content);
            return known;
        }
        let mut view = View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: (start > 0).then(|| USize64::from(start)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        };
        if let Some((packed, rest)) = packing {
            let before = self.plain.unwrap_or(0);
            let mut own = Map::new();
            own.insert("buffer".to_owned(), json!(0));
            own.insert("byteOffset".to_owned(), json!(start));
            own.insert("byteLength".to_owned(), json!(packed.len()));
            own.extend(rest);
            view.buffer = Index::new(1);
            view.byte_offset = (before > 0).then(|| USize64::from(before));
            let others = Map::from_iter([(EXTENSION.to_owned(), Value::Object(own))]);
            view.extensions = Some(extensions::buffer::View { others });
            self.plain = Some((before + length).next_multiple_of(4));
        }
        let made = root.push(view);
        self.views.add(start..self.bytes.len(), content, stored, made);
        made
    }

    /// A view of vertex attributes written by `fill`, and its accessor; `stride` bytes from one to the next.
    pub(super) fn attribute(
        &mut self,
        root: &mut Root,
        elements: Elements,
        content: Content,
        fill: impl FnOnce(&mut Vec<u8>),
    ) -> Index<Accessor> {
        let start = self.start();
        fill(&mut self.bytes);
        let view = self.view(root, start, Some(Target::ArrayBuffer), content);
        let stride = match content {
            Content::Attributes { stride } | Content::Exponential { stride } => stride,
            _ => 4,
        };
        if stride != elements.component.size() * elements.shape.multiplicity() {
            root.buffer_views[view.value()].byte_stride = Some(Stride(stride));
        }
        root.push(accessor(view, 0, elements, None))
    }

    /// The buffers of the file: this one, and the one that nothing needs to hold.
    pub(super) fn buffers(&self, root: &mut Root) {
        let buffer = |length: usize| Buffer {
            byte_length: USize64::from(length),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        };
        root.buffers.push(buffer(self.bytes.len()));
        if let Some(plain) = self.plain.filter(|plain| *plain > 0) {
            let mut fallback = buffer(plain);
            let others = Map::from_iter([(EXTENSION.to_owned(), json!({ "fallback": true }))]);
            fallback.extensions = Some(extensions::buffer::Buffer { others });
            root.buffers.push(fallback);
            root.extensions_used.push(EXTENSION.to_owned());
            root.extensions_required.push(EXTENSION.to_owned());
        }
    }
}

/// The compressed bytes of a view, and what its extension says of them; `None` where it stays as it is.
fn packed(bytes: &[u8], content: Content) -> Option<(Vec<u8>, Map<String, Value>)> {
    let indices = |width: usize| -> Vec<u32> {
        let word = |element: &[u8]| {
            let mut word = [0; 4];
            word[..width].copy_from_slice(element);
            u32::from_le_bytes(word)
        };
        bytes.chunks_exact(width).map(word).collect()
    };
    let (made, stride, mode, filter) = match content {
        Content::Picture => return None,
        Content::Attributes { stride } => {
            (encode_attributes(bytes, stride, Codec::Zero)?, stride, "ATTRIBUTES", None)
        }
        Content::Directions => {
            (encode_attributes(bytes, 4, Codec::Zero)?, 4, "ATTRIBUTES", Some("OCTAHEDRAL"))
        }
        Content::Exponential { stride } => {
            (encode_attributes(bytes, stride, Codec::Zero)?, stride, "ATTRIBUTES", Some("EXPONENTIAL"))
        }
        Content::Triangles { width, vertices } => {
            (encode_triangles(&indices(width), vertices)?, width, "TRIANGLES", None)
        }
        Content::Lines { width, vertices } => {
            (encode_sequence(&indices(width), vertices)?, width, "INDICES", None)
        }
    };
    let mut rest = Map::new();
    rest.insert("byteStride".to_owned(), json!(stride));
    rest.insert("count".to_owned(), json!(bytes.len() / stride));
    rest.insert("mode".to_owned(), json!(mode));
    if let Some(filter) = filter {
        rest.insert("filter".to_owned(), json!(filter));
    }
    Some((made, rest))
}

/// An accessor at an offset into a view, with the least and greatest of each component where demanded.
pub(super) fn accessor(
    view: Index<View>,
    offset: usize,
    elements: Elements,
    bounds: Option<(Value, Value)>,
) -> Accessor {
    let (min, max) = bounds.unzip();
    Accessor {
        buffer_view: Some(view),
        byte_offset: (offset > 0).then(|| USize64::from(offset)),
        count: USize64::from(elements.count),
        component_type: Checked::Valid(GenericComponentType(elements.component)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(elements.shape),
        min,
        max,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// Writes indices, which name `vertices`, and for each of the counts an accessor to the next of them.
pub(super) fn index_accessors(
    root: &mut Root,
    binary: &mut Binary,
    indices: impl Iterator<Item = u32>,
    (vertices, lines): (usize, bool),
    counts: impl Iterator<Item = usize>,
) -> Vec<Index<Accessor>> {
    let width = index_width(vertices);
    let start = binary.start();
    if width == 2 {
        // The two low bytes are all: the greatest vertex is below 0xFFFF.
        indices.for_each(|index| {
            let [low, high, ..] = index.to_le_bytes();
            binary.bytes.extend_from_slice(&[low, high]);
        });
    } else {
        indices.for_each(|index| binary.bytes.extend_from_slice(&index.to_le_bytes()));
    }
    let content =
        if lines { Content::Lines { width, vertices } } else { Content::Triangles { width, vertices } };
    let view = binary.view(root, start, Some(Target::ElementArrayBuffer), content);
    let component = if width == 2 { ComponentType::U16 } else { ComponentType::U32 };
    let mut first = 0;
    counts
        .map(|count| {
            let elements = Elements { component, shape: Type::Scalar, count };
            let made = root.push(accessor(view, first * width, elements, None));
            first += count;
            made
        })
        .collect()
}

/// Bytes of an index: 0xFFFF restarts primitives and is no vertex.
pub(super) fn index_width(vertices: usize) -> usize {
    if vertices <= 0xFFFF { 2 } else { 4 }
}

/// A subscript of the document.
pub(super) fn at<T>(subscript: usize) -> Index<T> {
    Index::new(mesh::index(subscript))
}

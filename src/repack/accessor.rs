//! Elements of accessors, scattered, sparse and quantized ones too.

use std::borrow::Cow;

use gltf::json::accessor::ComponentType;
use serde_json::Value;

use super::document::{Fault, Object, list, whole};
use crate::import::gltf::{little, number, size};

/// A document and the bytes of its views.
pub(super) struct Source<'a> {
    pub(super) root: &'a Object,
    pub(super) views: &'a [Cow<'a, [u8]>],
}

/// Elements of an accessor that has no bytes of its own, at most.
const MOST: usize = 1 << 26;

/// Numbers of an element of a type.
pub(super) fn width(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

/// Elements as they stand in the file.
pub(super) struct Elements<'a> {
    bytes: Cow<'a, [u8]>,
    start: usize,
    stride: usize,
    /// Bytes of an element.
    pub(super) size: usize,
    pub(super) count: usize,
    /// Numbers of an element.
    pub(super) width: usize,
    pub(super) component: ComponentType,
    pub(super) normalized: bool,
}

impl Elements<'_> {
    /// The bytes of an element.
    pub(super) fn at(&self, place: usize) -> &[u8] {
        &self.bytes[self.start + place * self.stride..][..self.size]
    }

    /// The first numbers of an element: whole ones of normalized accessors as shares of their most.
    pub(super) fn numbers<const N: usize>(&self, place: usize) -> [f64; N] {
        let bytes = self.at(place);
        if self.component == ComponentType::F32 {
            let (words, _) = bytes.as_chunks::<4>();
            return std::array::from_fn(|k| {
                words.get(k).map_or(0.0, |word| f32::from_le_bytes(*word).into())
            });
        }
        let one = size(self.component);
        std::array::from_fn(|k| {
            let part = bytes.get(k * one..(k + 1) * one);
            part.map_or(0.0, |part| number(self.component, self.normalized, part).into())
        })
    }

    /// The first number of every element, as whole ones.
    pub(super) fn wholes(&self) -> Vec<u32> {
        let dense = &self.bytes[self.start..][..self.count * self.size];
        match (self.component, self.stride) {
            (ComponentType::U32, 4) => {
                dense.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
            }
            (ComponentType::U16, 2) => {
                dense.as_chunks().0.iter().map(|word| u16::from_le_bytes(*word).into()).collect()
            }
            _ => (0..self.count).map(|place| little(&self.at(place)[..size(self.component)])).collect(),
        }
    }

    /// Whether the numbers are floats.
    pub(super) fn is_float(&self) -> bool {
        self.component == ComponentType::F32
    }
}

/// The type of components of a number of the specification.
fn component(of: &Value) -> ComponentType {
    match whole(of, "componentType") {
        Some(5120) => ComponentType::I8,
        Some(5121) => ComponentType::U8,
        Some(5122) => ComponentType::I16,
        Some(5123) => ComponentType::U16,
        Some(5125) => ComponentType::U32,
        _ => ComponentType::F32,
    }
}

/// Bytes of an element: columns of matrices of small numbers begin on multiples of four.
fn element(kind: &str, component: ComponentType) -> usize {
    let one = size(component);
    match (kind, one) {
        ("MAT2", 1) => 8,
        ("MAT3", 1) => 12,
        ("MAT3", 2) => 24,
        _ => width(kind).unwrap_or(1) * one,
    }
}

impl Source<'_> {
    /// The elements of an accessor.
    pub(super) fn elements(&self, index: usize) -> Result<Elements<'_>, Fault> {
        let wrong = |message: String| Fault::new(format!("/accessors/{index}"), message);
        let own = &list(self.root, "accessors")[index];
        let kind = own["type"].as_str().unwrap_or_default();
        let component = component(own);
        let size = element(kind, component);
        let count = whole(own, "count").unwrap_or(0);
        let (bytes, start, stride) = match whole(own, "bufferView") {
            Some(view) => {
                let told = whole(&list(self.root, "bufferViews")[view], "byteStride");
                let stride = told.unwrap_or(size);
                let start = self.reach(view, whole(own, "byteOffset").unwrap_or(0), (count, size, stride));
                let start =
                    start.ok_or_else(|| wrong(format!("it reaches past the end of buffer view {view}")))?;
                (Cow::Borrowed(&*self.views[view]), start, stride)
            }
            None if count <= MOST => (Cow::Owned(vec![0; count * size]), 0, size),
            None => return Err(wrong(format!("it has {count} elements without bytes, more than {MOST}"))),
        };
        let normalized = own.get("normalized").and_then(Value::as_bool).unwrap_or(false);
        let width = width(kind).unwrap_or(1);
        let plain = Elements { bytes, start, stride, size, count, width, component, normalized };
        match own.get("sparse") {
            None => Ok(plain),
            Some(sparse) => self.changed(plain, sparse).map_err(wrong),
        }
    }

    /// As [`Source::elements`], of finite numbers alone.
    pub(super) fn sound(&self, index: usize) -> Result<Elements<'_>, Fault> {
        let elements = self.elements(index)?;
        if elements.is_float() {
            let finite = |word: &[u8; 4]| f32::from_le_bytes(*word).is_finite();
            let broken = |place: &usize| !elements.at(*place).as_chunks::<4>().0.iter().all(finite);
            if let Some(place) = (0..elements.count).find(broken) {
                let message = format!("a number of its element {place} is not finite");
                return Err(Fault::new(format!("/accessors/{index}"), message));
            }
        }
        Ok(elements)
    }

    /// Where elements begin, if all of them lie in a view.
    fn reach(
        &self,
        view: usize,
        start: usize,
        (count, size, stride): (usize, usize, usize),
    ) -> Option<usize> {
        let last = count.saturating_sub(1).checked_mul(stride)?;
        let end = start.checked_add(last)?.checked_add(size)?;
        (stride >= size && end <= self.views[view].len()).then_some(start)
    }

    /// Elements of which some stand elsewhere.
    fn changed<'a>(&self, plain: Elements<'a>, sparse: &Value) -> Result<Elements<'a>, String> {
        let changed = whole(sparse, "count").unwrap_or(0);
        let part = |part: &str, size: usize| {
            let own = &sparse[part];
            let view = whole(own, "bufferView").unwrap_or(0);
            let start = self.reach(view, whole(own, "byteOffset").unwrap_or(0), (changed, size, size));
            let outside = || format!("its sparse {part} reach past the end of buffer view {view}");
            start.map(|start| &self.views[view][start..]).ok_or_else(outside)
        };
        let short = size(component(&sparse["indices"]));
        let size = plain.size;
        let mut bytes = Vec::with_capacity(plain.count * size);
        (0..plain.count).for_each(|place| bytes.extend_from_slice(plain.at(place)));
        if changed > 0 {
            let (places, values) = (part("indices", short)?, part("values", size)?);
            for (place, value) in places.chunks_exact(short).zip(values.chunks_exact(size)).take(changed) {
                let place = little(place) as usize;
                let to = bytes.get_mut(place * size..(place + 1) * size);
                to.ok_or_else(|| format!("its sparse index {place} is not below {}", plain.count))?
                    .copy_from_slice(value);
            }
        }
        Ok(Elements { bytes: Cow::Owned(bytes), start: 0, stride: size, ..plain })
    }
}

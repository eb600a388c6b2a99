//! Numbers of accessors: every kind of component, scattered and sparse ones too.

use gltf::accessor::{DataType, sparse::IndexType};

use super::GltfFault;

/// A document and the bytes of its buffers.
pub(crate) struct Data<'a> {
    pub(crate) document: &'a gltf::Document,
    pub(crate) buffers: Vec<&'a [u8]>,
}

/// Bytes with the width of their elements and the way from one to the next.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    width: usize,
}

impl<'a> Elements<'a> {
    fn at(&self, place: usize) -> &'a [u8] {
        &self.bytes[place * self.stride..][..self.width]
    }
}

impl<'a> Data<'a> {
    /// The bytes of a part of a buffer.
    pub(crate) fn view(&self, view: &gltf::buffer::View<'_>) -> Result<&'a [u8], GltfFault> {
        let buffer = self.buffers.get(view.buffer().index()).copied().unwrap_or_default();
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end)).ok_or(GltfFault::View(view.index()))
    }

    fn elements(
        &self,
        view: &gltf::buffer::View<'_>,
        offset: usize,
        (count, width, stride): (usize, usize, Option<usize>),
    ) -> Result<Elements<'a>, GltfFault> {
        let outside = GltfFault::View(view.index());
        let bytes = self.view(view)?.get(offset..).ok_or(outside.clone())?;
        let stride = stride.unwrap_or(width);
        let reach = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride).and_then(|start| start.checked_add(width)));
        if stride < width || reach.is_none_or(|reach| reach > bytes.len()) {
            return Err(outside);
        }
        Ok(Elements { bytes, stride, width })
    }

    /// The elements of an accessor, each of `N` numbers: whole ones of normalized accessors as shares of their most.
    pub(crate) fn numbers<const N: usize>(
        &self,
        accessor: &gltf::Accessor<'_>,
    ) -> Result<Vec<[f32; N]>, GltfFault> {
        let (kind, normalized) = (accessor.data_type(), accessor.normalized());
        let read = |bytes: &[u8]| {
            let width = size(kind);
            std::array::from_fn(|k| {
                bytes.get(k * width..(k + 1) * width).map_or(0.0, |bytes| number(kind, normalized, bytes))
            })
        };
        self.read(accessor, N, [0.0; N], read)
    }

    /// The elements of an accessor of whole numbers, each of `N`.
    pub(crate) fn whole<const N: usize>(
        &self,
        accessor: &gltf::Accessor<'_>,
    ) -> Result<Vec<[u32; N]>, GltfFault> {
        let kind = accessor.data_type();
        let read = |bytes: &[u8]| {
            let width = size(kind);
            std::array::from_fn(|k| bytes.get(k * width..(k + 1) * width).map_or(0, little))
        };
        self.read(accessor, N, [0; N], read)
    }

    fn read<T: Clone>(
        &self,
        accessor: &gltf::Accessor<'_>,
        numbers: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, GltfFault> {
        let (count, own) = (accessor.count(), accessor.dimensions().multiplicity());
        // Colors of three numbers are read as four; nothing else may differ.
        if own != numbers && !(own == 3 && numbers == 4) {
            return Err(GltfFault::Accessor(accessor.index()));
        }
        let width = size(accessor.data_type()) * own;
        let mut all = match accessor.view() {
            Some(view) => {
                let elements = self.elements(&view, accessor.offset(), (count, width, view.stride()))?;
                (0..count).map(|place| read(elements.at(place))).collect()
            }
            None if accessor.sparse().is_some() && count <= MOST => vec![zero; count],
            None => return Err(GltfFault::Accessor(accessor.index())),
        };
        if let Some(sparse) = accessor.sparse() {
            let (places, values) = (sparse.indices(), sparse.values());
            let short = match places.index_type() {
                IndexType::U8 => 1,
                IndexType::U16 => 2,
                IndexType::U32 => 4,
            };
            let changed = sparse.count();
            let at = self.elements(&places.view(), places.offset(), (changed, short, None))?;
            let new = self.elements(&values.view(), values.offset(), (changed, width, None))?;
            for k in 0..changed {
                let place = little(at.at(k)) as usize;
                *all.get_mut(place).ok_or(GltfFault::Accessor(accessor.index()))? = read(new.at(k));
            }
        }
        Ok(all)
    }
}

/// Elements of an accessor that has no bytes of its own.
const MOST: usize = 1 << 26;

/// Bytes of a component.
pub(crate) fn size(kind: DataType) -> usize {
    match kind {
        DataType::I8 | DataType::U8 => 1,
        DataType::I16 | DataType::U16 => 2,
        DataType::U32 | DataType::F32 => 4,
    }
}

pub(crate) fn little(bytes: &[u8]) -> u32 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    u32::from_le_bytes(word)
}

/// A component as a number (glTF 2.0 Specification, 2021, section 3.11: how normalized ones are read).
pub(crate) fn number(kind: DataType, normalized: bool, bytes: &[u8]) -> f32 {
    let whole = little(bytes);
    let (value, most) = match kind {
        DataType::F32 => return f32::from_bits(whole),
        DataType::U32 => return whole as f32,
        DataType::I8 => (f32::from(whole.to_le_bytes()[0].cast_signed()), 127.0),
        DataType::U8 => (whole as f32, 255.0),
        DataType::I16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]]).cast_signed()), 32767.0),
        DataType::U16 => (whole as f32, 65535.0),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

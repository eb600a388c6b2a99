//! Bytes of vertices and indices, shorter and back: the formats of `EXT_meshopt_compression` and of its successor.
//!
//! Source: Khronos Group, glTF extension `EXT_meshopt_compression`, 2021, appendix A (bitstreams, version 0);
//! `KHR_meshopt_compression`, release candidate of 2025 (version 1 of vertices; indices are the same).

use super::whole_triangles;

/// A row of bytes, one vertex.
#[derive(Clone, Copy)]
#[repr(transparent)]
struct Row<const N: usize>([u8; N]);

impl<const N: usize> Default for Row<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

/// Calls a function of the stride, which the library takes as a type; `None` for a stride that the format has not.
macro_rules! by_stride {
    ($stride:expr, $call:ident $arguments:tt; $($n:literal)+) => {
        match $stride {
            $($n => $call::<$n>$arguments,)+
            _ => None,
        }
    };
    ($stride:expr, $call:ident $arguments:tt) => {
        by_stride!($stride, $call $arguments;
            4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64 68 72 76 80 84 88 92 96 100 104 108 112 116 120 124 128
            132 136 140 144 148 152 156 160 164 168 172 176 180 184 188 192 196 200 204 208 212 216 220 224 228 232
            236 240 244 248 252 256)
    };
}

/// How bytes of vertices are written, and so which extension reads them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Codec {
    /// Version 0, of `EXT_meshopt_compression`.
    #[default]
    Zero,
    /// Version 1, of `KHR_meshopt_compression`: shorter.
    One,
}

impl Codec {
    /// The extension that reads it.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Zero => "EXT_meshopt_compression",
            Self::One => "KHR_meshopt_compression",
        }
    }
}

/// Attributes of `stride` bytes a vertex; `None` where the stride is no multiple of 4 up to 256, or the bytes are not
/// whole vertices. Linear.
#[must_use]
pub fn encode_attributes(bytes: &[u8], stride: usize, codec: Codec) -> Option<Vec<u8>> {
    fn encode<const N: usize>(bytes: &[u8], version: i32) -> Option<Vec<u8>> {
        let (rows, rest) = bytes.as_chunks::<N>();
        // The level counts in version 1 alone.
        let made = rest.is_empty().then(|| meshopt::encode_vertex_buffer_level(rows, 2, Some(version)));
        made?.ok().filter(|made| !made.is_empty())
    }
    let version = match codec {
        Codec::Zero => 0,
        Codec::One => 1,
    };
    by_stride!(stride, encode(bytes, version))
}

/// The bytes that [`encode_attributes`] was given; `None` where they are broken.
#[must_use]
pub fn decode_attributes(encoded: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    fn decode<const N: usize>(encoded: &[u8], count: usize) -> Option<Vec<u8>> {
        let rows = meshopt::decode_vertex_buffer::<Row<N>>(encoded, count).ok()?;
        Some(rows.iter().flat_map(|row| row.0).collect())
    }
    if !plausible(encoded, count.checked_mul(stride)?) {
        return None;
    }
    by_stride!(stride, decode(encoded, count))
}

/// Triangles. Each keeps its place, its corners may begin with another. `None` where they are not whole, or use a
/// vertex beyond `vertices`. Linear.
#[must_use]
pub fn encode_triangles(indices: &[u32], vertices: usize) -> Option<Vec<u8>> {
    whole_triangles(indices, vertices).then(|| meshopt::encode_index_buffer(indices, vertices).ok()).flatten()
}

/// Indices that [`encode_triangles`] was given; `None` where the bytes are broken. They may name any vertex.
#[must_use]
pub fn decode_triangles(encoded: &[u8], count: usize) -> Option<Vec<u32>> {
    let whole = count.is_multiple_of(3) && plausible(encoded, count.checked_mul(4)?);
    whole.then(|| meshopt::decode_index_buffer(encoded, count).ok()).flatten()
}

/// Indices of any kind. `None` where one is not below `vertices`. Linear.
#[must_use]
pub fn encode_sequence(indices: &[u32], vertices: usize) -> Option<Vec<u8>> {
    let within = indices.iter().all(|index| (*index as usize) < vertices);
    within.then(|| meshopt::encode_index_sequence(indices, vertices).ok()).flatten()
}

/// Indices that [`encode_sequence`] was given; `None` where the bytes are broken. They may name any vertex.
#[must_use]
pub fn decode_sequence(encoded: &[u8], count: usize) -> Option<Vec<u32>> {
    plausible(encoded, count.checked_mul(4)?)
        .then(|| meshopt::decode_index_sequence(encoded, count).ok())
        .flatten()
}

/// Whether so few bytes can stand for so many: the formats keep at least two bits for sixteen bytes of vertices, and a
/// byte for each triangle. What claims more is refused before memory is taken for it.
fn plausible(encoded: &[u8], decoded: usize) -> bool {
    decoded / 128 <= encoded.len()
}

#[cfg(test)]
mod tests {
    use super::{
        Codec, decode_attributes, decode_sequence, decode_triangles, encode_attributes, encode_sequence,
        encode_triangles,
    };

    /// Bytes that repeat and drift, as those of neighboring vertices do.
    fn bytes(count: usize) -> Vec<u8> {
        (0..count).map(|at| ((at * at / 7 + at % 13) % 256).to_le_bytes()[0]).collect()
    }

    #[test]
    fn every_stride_comes_back() {
        for stride in (4..=256).step_by(4) {
            for count in [1, 15, 16, 17, 255, 256, 257, 1000] {
                let given = bytes(count * stride);
                for (codec, first) in [(Codec::Zero, 0xA0), (Codec::One, 0xA1)] {
                    let encoded =
                        encode_attributes(&given, stride, codec).expect("the stride is one of the format");
                    assert_eq!(encoded[0], first, "the version");
                    let back = decode_attributes(&encoded, count, stride);
                    assert_eq!(back.as_ref(), Some(&given), "{count} of {stride}");
                }
            }
        }
        for stride in [0, 2, 3, 6, 260] {
            assert_eq!(encode_attributes(&bytes(stride * 4), stride, Codec::Zero), None);
        }
        assert_eq!(encode_attributes(&bytes(7), 4, Codec::Zero), None, "half a vertex");
    }

    #[test]
    fn triangles_and_sequences_come_back() {
        let indices: Vec<u32> = (0..300).flat_map(|at| [at, at + 1, (at * 31) % 300]).collect();
        let encoded = encode_triangles(&indices, 301).expect("indices are in range");
        let back = decode_triangles(&encoded, indices.len()).expect("it is what was encoded");
        for (given, found) in indices.as_chunks::<3>().0.iter().zip(back.as_chunks::<3>().0) {
            let turns = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|turn| turn.map(|corner| given[corner]));
            assert!(turns.contains(found), "{given:?} became {found:?}");
        }
        let encoded = encode_sequence(&indices, 301).expect("indices are in range");
        assert_eq!(decode_sequence(&encoded, indices.len()), Some(indices.clone()));
        assert_eq!(encode_triangles(&indices, 300), None, "an index beyond the vertices");
        assert_eq!(encode_triangles(&indices[1..], 301), None, "no whole triangles");
        assert_eq!(encode_sequence(&indices, 300), None);
    }

    #[test]
    fn broken_bytes_are_refused_or_read_as_others_and_never_crash() {
        let given = bytes(300 * 8);
        let encoded = encode_attributes(&given, 8, Codec::Zero).expect("the stride is one of the format");
        for cut in 0..encoded.len() {
            assert_eq!(decode_attributes(&encoded[..cut], 300, 8), None, "cut off at {cut}");
        }
        for at in 0..encoded.len() {
            let mut broken = encoded.clone();
            broken[at] ^= 0x55;
            // What comes out is garbage of the right length, or nothing.
            assert!(decode_attributes(&broken, 300, 8).is_none_or(|found| found.len() == given.len()));
        }
        assert_eq!(decode_attributes(&encoded, usize::MAX / 8, 8), None, "more than the bytes can hold");
        assert_eq!(decode_triangles(&[], 0), None);
        assert_eq!(decode_triangles(&[0xE1, 0, 0], 3_000_000_000), None);
    }
}

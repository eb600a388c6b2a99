//! The one adapter to `meshopt`, whose functions trust their input, and that to `uvunwrap`.
//!
//! Promise: every index, count and stride is checked before it is handed over, so that no input of these functions can
//! read or write beyond its arrays; a result depends on the input alone. Where bytes of a file depend on it, only what
//! computes in integers, or adds and compares floats, is taken: what a processor contracts into one operation differs
//! between them. Tangents and simplified meshes are the exception. Not promised: that indices are those of a sensible mesh.
//!
//! Source: A. Kapoulkine, meshoptimizer 1.3, 2026.

mod codec;
mod filter;
mod order;
mod pointer;
mod simplify;
mod tangent;
mod unpack;
mod unwrap;

pub use codec::{
    Codec, decode_attributes, decode_sequence, decode_triangles, encode_attributes, encode_sequence,
    encode_triangles,
};
pub use filter::{
    Filter, exponential, exponential_step, octahedral, power_of_two, quaternion, share_byte, signed_byte,
};
pub use order::{order_for_cache, order_for_strips};
pub use pointer::{POINTER, PointerChannel, without_pointers};
pub use simplify::{Attributes, simplified};
pub use tangent::corner_tangents;
pub use unpack::{EXTENSION, EXTENSIONS, MOST_RATIO, UnpackError, decoded, stored_lengths, unpacked};
pub use unwrap::{Unwrapped, unwrapped};

/// Whether all indices are below a count, and make whole triangles.
fn whole_triangles(indices: &[u32], vertices: usize) -> bool {
    indices.len().is_multiple_of(3) && indices.iter().max().is_none_or(|most| (*most as usize) < vertices)
}

//! Checked scenes into glTF bytes, and bytes back for measuring.
//!
//! Promise: the bytes depend on the scene alone; positions shared in the scene are equal bits in the file;
//! all primitives of a mesh share their vertex accessors and all its indices lie in one buffer view. The
//! `core` profile requires no extension. Source: Khronos Group, glTF 2.0 Specification, 2021; `KHR_mesh_quantization`,
//! 2020; `EXT_meshopt_compression`, 2021.

mod attribute;
mod buffer;
mod carrier;
mod collider;
mod color;
mod duplicate;
mod instance;
mod lines;
mod manifold;
mod material;
mod morph;
mod motion;
mod optics;
mod pointer;
mod position;
mod profile;
mod read;
mod read_morph;
mod read_motion;
mod read_second;
mod vector;
mod view;
mod write;

pub use attribute::ReadRange;
pub use carrier::ReadLevels;
pub use color::ReadColors;
pub use profile::Profile;
pub use read::{Geometry, Indices, Lines, Part, PositionBytes, Read, ReadError, read};
pub use read_morph::ReadTarget;
pub use read_motion::{ReadAnimation, ReadChannel, ReadInfluences, ReadProperty, ReadSkin};
pub use write::{
    Form, WriteError, Written, WrittenAnimation, WrittenGeometry, WrittenLevel, WrittenTarget, container,
    write,
};

//! Quake II models (MD2): triangles with texture coordinates, and frames of points.
//!
//! A frame has a byte for each coordinate, a scale and an offset; frames of a sequence have its name and a number. Corners
//! run clockwise seen from outside, x looks forward, y to the left and z up. Lists of commands for drawing, and normals,
//! which are only rounded to 162 directions, are not read.
//!
//! Promise: every count and offset is held against the length of the file before anything is read, so that no more memory
//! is taken than a few times that length. Source: id Software, Quake II source code, 2001, `qfiles.h`.

use glam::{DVec2, DVec3};
use thiserror::Error;

use super::MaterialLook;
use super::keyframes::{Frame, Keyframes, text};
use crate::geometry::mesh::PolygonMesh;

/// Why a file is no model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Md2Fault {
    /// No room for the header.
    #[error("the file has {length} bytes, and its header alone has {HEADER}")]
    TooShort {
        /// Its length.
        length: usize,
    },
    /// Another file.
    #[error("the file does not begin with `IDP2`, as Quake II models do")]
    NotMd2,
    /// Another version of the format.
    #[error("this is version {version} of the format, and version 8 is read")]
    Version {
        /// The version.
        version: i32,
    },
    /// A count or a size that makes no sense.
    #[error("the header counts {count} {what}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many.
        count: i32,
    },
    /// A section that the file has no room for.
    #[error("{what} should stand at bytes {start} to {end}, and the file has {length}")]
    Beyond {
        /// What stands there.
        what: &'static str,
        /// First byte.
        start: i64,
        /// One past the last.
        end: i64,
        /// Length of the file.
        length: usize,
    },
    /// Frames with room for another number of points.
    #[error("each frame has {size} bytes, and {points} points need {needed}")]
    FrameSize {
        /// As the header says.
        size: i32,
        /// How many points there are.
        points: i32,
        /// Bytes that these need.
        needed: i64,
    },
    /// A corner that there is not.
    #[error("triangle {triangle} has {what} {index}, and the file has {count}")]
    Index {
        /// The triangle, from 1.
        triangle: usize,
        /// What is named.
        what: &'static str,
        /// Its number.
        index: u16,
        /// How many there are.
        count: usize,
    },
    /// A scale or an offset that is no number.
    #[error("frame {frame} is scaled or moved by {value}, which is no finite number")]
    NotFinite {
        /// The frame, from 1.
        frame: usize,
        /// The value.
        value: f32,
    },
}

/// Name of the material of a file that names skins.
const SKIN: &str = "skin";
/// Bytes of the header: 17 numbers.
const HEADER: usize = 68;
/// Bytes of a frame before its points: scale, offset and name.
const FRAME_HEAD: i64 = 40;

/// Reads a file. O(its length).
///
/// # Errors
/// See [`Md2Fault`].
pub fn read(bytes: &[u8]) -> Result<Keyframes, Md2Fault> {
    if !bytes.starts_with(b"IDP2") {
        let short = bytes.len() < HEADER && b"IDP2".starts_with(&bytes[..bytes.len().min(4)]);
        return Err(if short { Md2Fault::TooShort { length: bytes.len() } } else { Md2Fault::NotMd2 });
    }
    let Some(header) = bytes.first_chunk::<HEADER>() else {
        return Err(Md2Fault::TooShort { length: bytes.len() });
    };
    let header = Header::read(header);
    header.check(bytes.len())?;
    let frames = header.frames(bytes)?;
    let mut mesh = header.mesh(bytes, &frames[0].points)?;
    let names = header.rows(bytes, header.skin_offset, header.skins, 64);
    let pictures: Vec<String> = names.map(text).collect();
    let mut materials = Vec::new();
    if let Some(first) = pictures.first().filter(|first| !first.is_empty()) {
        // Games give a model the first of its skins.
        materials.push(MaterialLook::pictured(SKIN, first));
        mesh.materials.push(SKIN.to_owned());
        mesh.faces.iter_mut().for_each(|face| face.material = Some(0));
    }
    Ok(Keyframes { mesh, frames, pictures, materials, ..Keyframes::default() })
}

/// What the header says.
struct Header {
    version: i32,
    picture: [i32; 2],
    frame_size: i32,
    skins: i32,
    points: i32,
    places: i32,
    triangles: i32,
    frames: i32,
    skin_offset: i32,
    place_offset: i32,
    triangle_offset: i32,
    frame_offset: i32,
}

impl Header {
    fn read(bytes: &[u8; HEADER]) -> Self {
        let (words, _) = bytes.as_chunks::<4>();
        let word = |at: usize| i32::from_le_bytes(words[at]);
        Self {
            version: word(1),
            picture: [word(2), word(3)],
            frame_size: word(4),
            skins: word(5),
            points: word(6),
            places: word(7),
            triangles: word(8),
            frames: word(10),
            skin_offset: word(11),
            place_offset: word(12),
            triangle_offset: word(13),
            frame_offset: word(14),
        }
    }

    fn check(&self, length: usize) -> Result<(), Md2Fault> {
        if self.version != 8 {
            return Err(Md2Fault::Version { version: self.version });
        }
        for (what, count, least) in [
            ("points", self.points, 1),
            ("texture coordinates", self.places, 0),
            ("triangles", self.triangles, 1),
            ("frames", self.frames, 1),
            ("skins", self.skins, 0),
        ] {
            if count < least {
                return Err(Md2Fault::Count { what, count });
            }
        }
        let needed = FRAME_HEAD + 4 * i64::from(self.points);
        if i64::from(self.frame_size) < needed {
            return Err(Md2Fault::FrameSize { size: self.frame_size, points: self.points, needed });
        }
        for (what, start, count, size) in [
            ("the names of skins", self.skin_offset, self.skins, 64),
            ("texture coordinates", self.place_offset, self.places, 4),
            ("triangles", self.triangle_offset, self.triangles, 12),
            ("frames", self.frame_offset, self.frames, self.frame_size),
        ] {
            let start = i64::from(start);
            let end = start + i64::from(count) * i64::from(size);
            if count > 0 && (start < 0 || usize::try_from(end).is_ok_and(|end| end > length)) {
                return Err(Md2Fault::Beyond { what, start, end, length });
            }
        }
        Ok(())
    }

    /// Rows of a section that [`check`](Self::check) has found to be there.
    fn rows<'b>(
        &self,
        bytes: &'b [u8],
        start: i32,
        count: i32,
        size: i32,
    ) -> impl Iterator<Item = &'b [u8]> + use<'b> {
        let [start, count, size] = [start, count, size].map(|number| usize::try_from(number).unwrap_or(0));
        let section = bytes.get(start..start + count * size).unwrap_or_default();
        section.chunks_exact(size.max(1))
    }

    fn frames(&self, bytes: &[u8]) -> Result<Vec<Frame>, Md2Fault> {
        let points = usize::try_from(self.points).unwrap_or(0);
        let rows = self.rows(bytes, self.frame_offset, self.frames, self.frame_size);
        let frame = |(number, row): (usize, &[u8])| {
            let (words, _) = row.as_chunks::<4>();
            let float = |at: usize| f32::from_le_bytes(words[at]);
            if let Some(value) = (0..6).map(float).find(|value| !value.is_finite()) {
                return Err(Md2Fault::NotFinite { frame: number, value });
            }
            let vector = |at: usize| DVec3::from_array([at, at + 1, at + 2].map(|at| f64::from(float(at))));
            let (scale, offset) = (vector(0), vector(3));
            let place =
                |[x, y, z, _]: &[u8; 4]| scale * DVec3::from_array([*x, *y, *z].map(f64::from)) + offset;
            let points = words[10..10 + points].iter().map(place).collect();
            Ok(Frame { name: text(&row[24..40]), points, normals: Vec::new() })
        };
        (1..).zip(rows).map(frame).collect()
    }

    fn mesh(&self, bytes: &[u8], points: &[DVec3]) -> Result<PolygonMesh, Md2Fault> {
        let mut found =
            PolygonMesh { points: points.to_vec(), has_smoothing: true, ..PolygonMesh::default() };
        let size = self.picture.map(f64::from);
        // Without a size of the picture places on it mean nothing.
        let placed = self.places > 0 && self.picture.iter().all(|side| *side > 0);
        if placed {
            let place = |row: &[u8]| {
                let (parts, _) = row.as_chunks::<2>();
                let part = |at: usize| f64::from(i16::from_le_bytes(parts[at])) / size[at];
                DVec2::new(part(0), part(1))
            };
            found.uvs = self.rows(bytes, self.place_offset, self.places, 4).map(place).collect();
        }
        for (number, row) in (1..).zip(self.rows(bytes, self.triangle_offset, self.triangles, 12)) {
            let (parts, _) = row.as_chunks::<2>();
            let named = |at: usize, what: &'static str, count: usize| {
                let index = u16::from_le_bytes(parts[at]);
                if usize::from(index) < count {
                    return Ok(u32::from(index));
                }
                Err(Md2Fault::Index { triangle: number, what, index, count })
            };
            // Clockwise becomes counter-clockwise.
            let mut corners = [0; 3];
            for (corner, at) in corners.iter_mut().zip([0, 2, 1]) {
                *corner = named(at, "point", found.points.len())?;
            }
            found.push_face(&[&corners], None, 1);
            if placed {
                for at in [3, 5, 4] {
                    let place = named(at, "texture coordinates", found.uvs.len())?;
                    found.corner_uvs.push(place);
                }
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests;

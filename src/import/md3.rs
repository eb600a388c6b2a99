//! Quake III models (MD3): surfaces of triangles with texture coordinates, frames of points with normals, and tags.
//!
//! A surface has its own points, in steps of 1/64, and each names the picture that it shows. Points of a surface that
//! are in one place in every frame, as they are along seams of a picture, are made one. Normals are two angles of a byte
//! each. Corners run clockwise seen from outside, x looks forward, y to the left and z up. A tag is a place with axes.
//!
//! Promise: every count and offset is held against the length of the file before anything is read, and surfaces lie one
//! after the other, so that no more memory is taken than a few times that length. Source: id Software, Quake III Arena
//! source code, 2005, `qfiles.h` and `tr_surface.c`.

use glam::{DAffine3, DMat3, DVec2, DVec3};
use thiserror::Error;

use super::bytes::{f32_at, i16_at, i32_at};
use super::keyframes::{Frame, Keyframes, Tag, text};
use super::{ImportError, MaterialLook};
use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::number::sin_cos_degrees;

/// Why a file is no model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Md3Fault {
    /// No room for a header.
    #[error("{what} should stand at byte {start}, and the file has {length}")]
    TooShort {
        /// What stands there.
        what: &'static str,
        /// First byte.
        start: i64,
        /// Length of the file.
        length: usize,
    },
    /// Another file.
    #[error("the file does not begin with `IDP3`, as Quake III models do")]
    NotMd3,
    /// A surface that is none.
    #[error("surface {number} at byte {start} does not begin with `IDP3`, as surfaces do")]
    NotSurface {
        /// Which, from 1.
        number: i32,
        /// Its first byte.
        start: i64,
    },
    /// Another version of the format.
    #[error("this is version {version} of the format, and version 15 is read")]
    Version {
        /// The version.
        version: i32,
    },
    /// A count that makes no sense.
    #[error("{place} counts {count} {what}")]
    Count {
        /// The header or a surface.
        place: String,
        /// What is counted.
        what: &'static str,
        /// How many.
        count: i32,
    },
    /// A surface with another number of frames than the file.
    #[error("surface `{surface}` has {found} frames, and the file has {frames}")]
    Frames {
        /// Its name.
        surface: String,
        /// How many it has.
        found: i32,
        /// How many the file has.
        frames: i32,
    },
    /// A section that the file or the surface has no room for.
    #[error(
        "{what} of {place} should stand at bytes {start} to {end}, and there is room from {first} to {last}"
    )]
    Beyond {
        /// The file or a surface.
        place: String,
        /// What stands there.
        what: &'static str,
        /// First byte.
        start: i64,
        /// One past the last.
        end: i64,
        /// First byte there is room for.
        first: i64,
        /// One past the last.
        last: i64,
    },
    /// A corner that there is not.
    #[error("triangle {triangle} of surface `{surface}` has point {point}, and the surface has {count}")]
    Index {
        /// Its name.
        surface: String,
        /// The triangle, from 1.
        triangle: usize,
        /// The point that is named.
        point: i32,
        /// How many there are.
        count: i32,
    },
    /// A number that is none.
    #[error("{what} has {value}, which is no finite number")]
    NotFinite {
        /// Where.
        what: String,
        /// The value.
        value: f32,
    },
    /// Axes of a tag that are no rotation.
    #[error("the axes of tag `{tag}` in frame {frame} are not of unit length and square to each other")]
    Axes {
        /// Its name.
        tag: String,
        /// The frame, from 1.
        frame: usize,
    },
}

/// Bytes of the headers and rows.
const HEADER: i64 = 108;
const SURFACE: i64 = 108;
const FRAME: i64 = 56;
const TAG: i64 = 112;
const SHADER: i64 = 68;
const TRIANGLE: i64 = 12;
const PLACE: i64 = 8;
const POINT: i64 = 8;

/// What a file holds in one step of a coordinate.
const STEP: f64 = 1.0 / 64.0;

/// Axes of a tag may be so far from square and from unit length: they are written in single precision, often to six
/// digits of a text before.
const SQUARE: f64 = 1e-2;

/// Reads a file: all of its surfaces, or the one of a name. O(n log n) in its length.
///
/// # Errors
/// See [`Md3Fault`]; a name that no surface has.
pub fn read(bytes: &[u8], group: Option<&str>) -> Result<Keyframes, ImportError> {
    let file = File::new(bytes)?;
    let mut found = Keyframes {
        frames: file.frames()?,
        tags: file.tags()?,
        mesh: PolygonMesh { has_smoothing: true, ..PolygonMesh::default() },
        ..Keyframes::default()
    };
    let mut start = i64::from(file.word(100));
    for number in 1..=file.surfaces {
        let surface = Surface::new(&file, start, number)?;
        start += i64::from(surface.length);
        if !found.groups.contains(&surface.name) {
            found.groups.push(surface.name.clone());
        }
        if group.is_none_or(|group| group == surface.name) {
            surface.add(&mut found)?;
        }
    }
    if let Some(group) = group.filter(|group| !found.groups.iter().any(|name| name == group)) {
        return Err(ImportError::UnknownGroup { group: group.to_owned(), known: found.groups });
    }
    if found.mesh.faces.is_empty() {
        return Err(match group {
            Some(group) => ImportError::EmptyGroup { group: group.to_owned() },
            None => ImportError::NoFaces { vertices: index(found.mesh.points.len()) },
        });
    }
    found.mesh.points.clone_from(&found.frames[0].points);
    found.mesh.normals.clone_from(&found.frames[0].normals);
    Ok(found)
}

/// The whole file, its header checked.
struct File<'b> {
    bytes: &'b [u8],
    count: i32,
    tags: i32,
    surfaces: i32,
}

impl<'b> File<'b> {
    fn new(bytes: &'b [u8]) -> Result<Self, Md3Fault> {
        let length = bytes.len();
        if !bytes.starts_with(b"IDP3") {
            let short = b"IDP3".starts_with(bytes);
            return Err(if short {
                Md3Fault::TooShort { what: "the header", start: 0, length }
            } else {
                Md3Fault::NotMd3
            });
        }
        let mut file = Self { bytes, count: 0, tags: 0, surfaces: 0 };
        if length < usize_of(HEADER) {
            return Err(Md3Fault::TooShort { what: "what the header announces", start: HEADER, length });
        }
        let version = file.word(4);
        if version != 15 {
            return Err(Md3Fault::Version { version });
        }
        (file.count, file.tags, file.surfaces) = (file.word(76), file.word(80), file.word(84));
        let counts = [("frames", file.count, 1), ("tags", file.tags, 0), ("surfaces", file.surfaces, 0)];
        for (what, count, least) in counts {
            if count < least {
                return Err(Md3Fault::Count { place: "the header".to_owned(), what, count });
            }
        }
        let tags = i64::from(file.tags) * i64::from(file.count);
        let room = (0, file.length());
        beyond("the file", ("frames", file.word(92), i64::from(file.count), FRAME), room)?;
        beyond("the file", ("tags", file.word(96), tags, TAG), room)?;
        beyond("the file", ("surfaces", file.word(100), i64::from(file.surfaces), SURFACE), room)?;
        Ok(file)
    }

    fn length(&self) -> i64 {
        i64::try_from(self.bytes.len()).unwrap_or(i64::MAX)
    }

    /// A number of the header, which is there.
    fn word(&self, at: usize) -> i32 {
        i32_at(self.bytes, at).unwrap_or(0)
    }

    fn float(&self, at: i64, what: &dyn Fn() -> String) -> Result<f64, Md3Fault> {
        let value = f32_at(self.bytes, usize_of(at)).unwrap_or(f32::NAN);
        if value.is_finite() {
            Ok(f64::from(value))
        } else {
            Err(Md3Fault::NotFinite { what: what(), value })
        }
    }

    fn vector(&self, at: i64, what: &dyn Fn() -> String) -> Result<DVec3, Md3Fault> {
        let part = |k: i64| self.float(at + 4 * k, what);
        Ok(DVec3::new(part(0)?, part(1)?, part(2)?))
    }

    fn text(&self, at: i64, size: i64) -> String {
        self.bytes.get(usize_of(at)..usize_of(at + size)).map(text).unwrap_or_default()
    }

    fn frames(&self) -> Result<Vec<Frame>, Md3Fault> {
        let start = i64::from(self.word(92));
        let name = |k: i64| self.text(start + k * FRAME + 40, 16);
        Ok((0..i64::from(self.count)).map(|k| Frame { name: name(k), ..Frame::default() }).collect())
    }

    fn tags(&self) -> Result<Vec<Tag>, Md3Fault> {
        let start = i64::from(self.word(96));
        let tag = |number: i64| {
            let row = |frame: i64| start + (frame * i64::from(self.tags) + number) * TAG;
            let name = self.text(row(0), 64);
            let place = |frame: i64| {
                let what = || format!("tag `{name}` in frame {}", frame + 1);
                let vector = |k: i64| self.vector(row(frame) + 64 + 12 * k, &what);
                let axes = DMat3::from_cols(vector(1)?, vector(2)?, vector(3)?);
                let square = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
                if square.iter().any(|part| part.abs() > SQUARE) || axes.determinant() < 0.0 {
                    return Err(Md3Fault::Axes { tag: name.clone(), frame: usize_of(frame) + 1 });
                }
                Ok(DAffine3 { matrix3: axes, translation: vector(0)? })
            };
            let places = (0..i64::from(self.count)).map(place).collect::<Result<_, _>>()?;
            Ok(Tag { name: name.clone(), places })
        };
        (0..i64::from(self.tags)).map(tag).collect()
    }
}

/// A surface, its header checked.
struct Surface<'b> {
    file: &'b File<'b>,
    start: i64,
    name: String,
    length: i32,
    shaders: i32,
    points: i32,
    triangles: i32,
    offsets: [i32; 4],
}

impl<'b> Surface<'b> {
    fn new(file: &'b File<'b>, start: i64, number: i32) -> Result<Self, Md3Fault> {
        if start + SURFACE > file.length() {
            return Err(Md3Fault::TooShort {
                what: "the header of a surface",
                start,
                length: file.bytes.len(),
            });
        }
        let word = |at: i64| file.word(usize_of(start + at));
        let name = file.text(start + 4, 64);
        let name = if name.is_empty() { format!("surface-{number}") } else { name };
        let place = || format!("surface `{name}`");
        if !file.bytes[usize_of(start)..].starts_with(b"IDP3") {
            return Err(Md3Fault::NotSurface { number, start });
        }
        if word(72) != file.count {
            return Err(Md3Fault::Frames { surface: name, found: word(72), frames: file.count });
        }
        let [shaders, points, triangles] = [76, 80, 84].map(word);
        let length = word(104);
        for (what, count) in
            [("shaders", shaders), ("points", points), ("triangles", triangles), ("bytes", length)]
        {
            if count < 0 {
                return Err(Md3Fault::Count { place: place(), what, count });
            }
        }
        let offsets = [88, 92, 96, 100].map(word);
        let all = i64::from(points) * i64::from(file.count);
        let room = (SURFACE, i64::from(length).min(file.length() - start));
        for section in [
            ("triangles", offsets[0], i64::from(triangles), TRIANGLE),
            ("shaders", offsets[1], i64::from(shaders), SHADER),
            ("texture coordinates", offsets[2], i64::from(points), PLACE),
            ("points", offsets[3], all, POINT),
        ] {
            beyond(&place(), section, room)?;
        }
        // The next one begins behind it.
        beyond(&place(), ("the header", 0, 1, SURFACE), (0, room.1))?;
        Ok(Self { file, start, name, length, shaders, points, triangles, offsets })
    }

    /// Where a row of a section begins.
    fn row(&self, section: usize, row: i64, size: i64) -> i64 {
        self.start + i64::from(self.offsets[section]) + row * size
    }

    fn add(&self, found: &mut Keyframes) -> Result<(), Md3Fault> {
        let mesh = &mut found.mesh;
        let first_place = index(mesh.uvs.len());
        for number in 0..i64::from(self.points) {
            let what = || format!("point {number} of surface `{}`", self.name);
            let at = self.row(2, number, PLACE);
            mesh.uvs.push(DVec2::new(self.file.float(at, &what)?, self.file.float(at + 4, &what)?));
        }
        let own = self.merged();
        let first_point = index(found.frames[0].points.len());
        let count = own.iter().max().map_or(0, |last| last + 1);
        for (number, frame) in (0..).zip(&mut found.frames) {
            let row = number * i64::from(self.points);
            let mut points = vec![DVec3::ZERO; usize_of(i64::from(count))];
            for (vertex, point) in (0..).zip(&own) {
                let at = self.row(3, row + vertex, POINT);
                let part = |k: i64| f64::from(i16_at(self.file.bytes, usize_of(at + 2 * k)).unwrap_or(0));
                points[*point as usize] = DVec3::new(part(0), part(1), part(2)) * STEP;
                frame.normals.push(normal(self.file.bytes.get(usize_of(at + 6)..).unwrap_or_default()));
            }
            frame.points.extend(points);
        }
        let material = self.material(found);
        for number in 0..i64::from(self.triangles) {
            let mut corners = [0_u32; 3];
            // Clockwise becomes counter-clockwise.
            for (corner, k) in corners.iter_mut().zip([0, 2, 1]) {
                let point = i32_at(self.file.bytes, usize_of(self.row(0, number, TRIANGLE) + 4 * k));
                let point = point.unwrap_or(-1);
                if !(0..self.points).contains(&point) {
                    let triangle = usize_of(number) + 1;
                    let (surface, count) = (self.name.clone(), self.points);
                    return Err(Md3Fault::Index { surface, triangle, point, count });
                }
                *corner = point.unsigned_abs();
            }
            let places = corners.map(|corner| first_place + corner);
            let points = corners.map(|corner| first_point + own[corner as usize]);
            found.mesh.push_face(&[&points], Some(material), 1);
            found.mesh.corner_uvs.extend(places);
            found.mesh.corner_normals.extend(places);
        }
        Ok(())
    }

    /// The number of the surface's material, which has its name and shows the picture of its first shader.
    fn material(&self, found: &mut Keyframes) -> u32 {
        let names = &mut found.mesh.materials;
        if let Some(known) = names.iter().position(|name| *name == self.name) {
            return index(known);
        }
        names.push(self.name.clone());
        let shader = self.file.text(self.row(1, 0, SHADER), 64);
        let shader = if self.shaders > 0 { shader.as_str() } else { "" };
        found.materials.push(MaterialLook::pictured(&self.name, shader));
        index(names.len() - 1)
    }

    /// For each vertex its point: vertices that are in one place in every frame have one.
    fn merged(&self) -> Vec<u32> {
        let frames = i64::from(self.file.count);
        let places = |vertex: u32| {
            (0..frames).map(move |frame| {
                let at = usize_of(self.row(3, frame * i64::from(self.points) + i64::from(vertex), POINT));
                &self.file.bytes[at..at + 6]
            })
        };
        let count = self.points.unsigned_abs();
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by(|a, b| places(*a).cmp(places(*b)).then(a.cmp(b)));
        let mut first: Vec<u32> = (0..count).collect();
        for equal in order.chunk_by(|a, b| places(*a).eq(places(*b))) {
            equal.iter().for_each(|vertex| first[*vertex as usize] = equal[0]);
        }
        let mut points = vec![0; first.len()];
        let mut next = 0;
        for (vertex, own) in (0..count).zip(&first) {
            points[vertex as usize] = if *own == vertex {
                next += 1;
                next - 1
            } else {
                points[*own as usize]
            };
        }
        points
    }
}

/// The direction of two angles in 256ths of a turn: from z, and about z from x.
fn normal(bytes: &[u8]) -> DVec3 {
    let [from_z, about_z] = bytes.first_chunk::<2>().copied().unwrap_or_default();
    let angle = |byte: u8| sin_cos_degrees(f64::from(byte) * 360.0 / 256.0);
    let ((sin, cos), (side, ahead)) = (angle(from_z), angle(about_z));
    DVec3::new(ahead * sin, side * sin, cos)
}

/// Holds a section of so many rows against the room that there is.
fn beyond(
    place: &str,
    (what, start, count, size): (&'static str, i32, i64, i64),
    (first, last): (i64, i64),
) -> Result<(), Md3Fault> {
    let start = i64::from(start);
    let end = start.saturating_add(count.saturating_mul(size));
    if count > 0 && (start < first || end > last) {
        return Err(Md3Fault::Beyond { place: place.to_owned(), what, start, end, first, last });
    }
    Ok(())
}

/// An offset that is not below 0.
fn usize_of(offset: i64) -> usize {
    usize::try_from(offset).unwrap_or(0)
}

#[cfg(test)]
mod tests;

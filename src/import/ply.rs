//! PLY (Stanford polygons), text and binary of either byte order: points, normals, texture coordinates, colors, polygons, strips.
//!
//! The header says what stands in the file, element by element and property by property; what is not known is passed
//! over. Texture coordinates are those of points or of the corners of faces, colors those of points or of faces. Colors are
//! taken as on screen (sRGB), which is how programs write them: whole numbers up to the greatest of their kind, or numbers
//! up to 1; opacity is as it stands.
//!
//! Promise: counts are held against the bytes that they need at least before anything is read. Source: G. Turk, The PLY
//! polygon file format, Stanford University, 1994.

mod body;
mod header;

use glam::{DVec2, DVec3};
use thiserror::Error;

use self::body::Body;
use self::header::{Element, Kind};
use super::error::quoted;
use super::{ImportError, ImportOptions, Imported, MaterialLook, Note};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::{Color, PolygonMesh, index};
use crate::geometry::number::{count_of, floor_count, srgb_to_linear};

/// Why a file is no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlyFault {
    /// The header is not one.
    #[error("line {line} of the header: expected {expected}, found `{found}`")]
    Header {
        /// Line of the file, from 1.
        line: u32,
        /// What must stand there.
        expected: &'static str,
        /// What does.
        found: String,
    },
    /// Points without places.
    #[error("element `vertex` has no properties `x`, `y` and `z`, it has {found}")]
    Places {
        /// What it has.
        found: String,
    },
    /// More than the file has room for.
    #[error(
        "the header announces {count} of element `{element}`, which need at least {needed} bytes, and {left} are left"
    )]
    Truncated {
        /// The element.
        element: String,
        /// How many.
        count: u64,
        /// Bytes that they need at least.
        needed: u64,
        /// Bytes that are left.
        left: usize,
    },
    /// The file ends in the middle.
    #[error("the file ends inside `{element}` {row}")]
    Ends {
        /// The element.
        element: String,
        /// Which of it, from 1.
        row: u64,
    },
    /// What is no number, or not finite.
    #[error("`{property}` of `{element}` {row} is `{found}`, which is no finite number")]
    Number {
        /// The element.
        element: String,
        /// Which of it, from 1.
        row: u64,
        /// The property.
        property: String,
        /// What stands there.
        found: String,
    },
    /// A corner that there is not.
    #[error("`{element}` {row} has the point {index}, and the file has {count}, counted from 0")]
    Index {
        /// The element.
        element: String,
        /// Which of it, from 1.
        row: u64,
        /// Its number.
        index: f64,
        /// How many points there are.
        count: usize,
    },
}

/// What is read of points.
const POINT: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [&["nx"], &["ny"], &["nz"]];
const PLACE: [&[&str]; 2] = [&["u", "s", "texture_u", "texture_s"], &["v", "t", "texture_v", "texture_t"]];
const COLOR: [&[&str]; 4] = [
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "a"],
];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a file. Linear in its length.
///
/// # Errors
/// The first fault in it.
pub fn read(bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let (header, start) = header::read(bytes)?;
    if let Some(group) = &options.group {
        return Err(ImportError::UnknownGroup { group: group.clone(), known: Vec::new() });
    }
    let mut body = Body::new(&bytes[start..], header.format);
    let mut found = Found { pictures: header.pictures.clone(), ..Found::default() };
    for element in &header.elements {
        body.check(element)?;
        match element.name.as_str() {
            "vertex" => found.points(element, &mut body)?,
            "face" => found.faces(element, &mut body)?,
            "tristrips" => found.strips(element, &mut body)?,
            _ => (0..element.count).try_for_each(|row| body.row(element, row, |_, _| Ok(())))?,
        }
    }
    found.finish(options)
}

/// Where the colors of an element stand.
struct Shade {
    /// For red, green, blue and alpha the column and the greatest number.
    columns: [Option<(usize, f64)>; 4],
}

impl Shade {
    fn of(element: &Element) -> Option<Self> {
        let columns = COLOR.map(|names| {
            let column = element.find(names)?;
            let property = &element.properties[column];
            let most = match property.kind {
                Kind::I8 => f64::from(i8::MAX),
                Kind::U8 => f64::from(u8::MAX),
                Kind::I16 => f64::from(i16::MAX),
                Kind::U16 => f64::from(u16::MAX),
                Kind::I32 => f64::from(i32::MAX),
                Kind::U32 => f64::from(u32::MAX),
                Kind::F32 | Kind::F64 => 1.0,
            };
            property.count.is_none().then_some((column, most))
        });
        columns[..3].iter().all(Option::is_some).then_some(Self { columns })
    }

    fn color(&self, numbers: &[f64], beyond: &mut u64) -> Color {
        let parts = self.columns.map(|column| column.map_or(1.0, |(column, most)| numbers[column] / most));
        *beyond += u64::from(parts.iter().any(|part| !(0.0..=1.0).contains(part)));
        let [red, green, blue, alpha] = parts;
        let [red, green, blue] = [red, green, blue].map(|part| srgb_to_linear(part.clamp(0.0, 1.0)));
        Color::held([red, green, blue, alpha])
    }
}

#[derive(Default)]
struct Found {
    mesh: PolygonMesh,
    normals: Vec<DVec3>,
    places: Vec<DVec2>,
    /// Colors of points.
    colors: Vec<Color>,
    /// Colors of faces, each at the corners of its face.
    face_colors: Vec<Color>,
    corner_colors: Vec<u32>,
    /// Colors that reach beyond their range.
    beyond: u64,
    /// Faces that have fewer than three corners.
    small: u64,
    /// Pictures, by which faces have their numbers.
    pictures: Vec<String>,
}

impl Found {
    fn points(&mut self, element: &Element, body: &mut Body<'_>) -> Result<(), PlyFault> {
        let columns = |names: &[&[&str]]| -> Option<Vec<usize>> {
            names.iter().map(|names| element.find(names)).collect()
        };
        let (point, normal, place) = (columns(&POINT), columns(&NORMAL), columns(&PLACE));
        if point.is_none() && element.count > 0 {
            let names: Vec<String> =
                element.properties.iter().map(|own| format!("`{}`", quoted(own.name.as_bytes()))).collect();
            let found = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(PlyFault::Places { found });
        }
        let shade = Shade::of(element);
        for row in 0..element.count {
            let mut numbers = vec![0.0; element.properties.len()];
            body.row(element, row, |column, values| {
                if let [value] = values {
                    numbers[column] = *value;
                }
                Ok(())
            })?;
            let vector = |columns: &Option<Vec<usize>>| {
                columns.as_ref().map(|at| DVec3::new(numbers[at[0]], numbers[at[1]], numbers[at[2]]))
            };
            self.mesh.points.push(vector(&point).unwrap_or_default());
            self.normals.extend(vector(&normal));
            if let Some(shade) = &shade {
                let color = shade.color(&numbers, &mut self.beyond);
                self.colors.push(color);
            }
            // Pictures have their first row on top, and v counts from below.
            self.places.extend(place.as_ref().map(|at| DVec2::new(numbers[at[0]], 1.0 - numbers[at[1]])));
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element, body: &mut Body<'_>) -> Result<(), PlyFault> {
        let (corners, places) = (element.find(&CORNERS), element.find(&["texcoord"]));
        let shade = Shade::of(element);
        let texture = element.find(&["texnumber"]);
        let mut numbers = vec![0.0; element.properties.len()];
        for row in 0..element.count {
            let (mut own, mut own_places) = (Vec::new(), Vec::new());
            body.row(element, row, |column, values| {
                if Some(column) == corners {
                    own = values.to_vec();
                } else if Some(column) == places {
                    own_places = values.to_vec();
                } else if let [value] = values {
                    numbers[column] = *value;
                }
                Ok(())
            })?;
            let own =
                own.iter().map(|index| self.corner(element, row, *index)).collect::<Result<Vec<u32>, _>>()?;
            if own.len() < 3 {
                self.small += 1;
                continue;
            }
            let number = texture.map_or(0.0, |column| numbers[column]);
            self.face(&own, number);
            if let Some(shade) = &shade {
                let color = shade.color(&numbers, &mut self.beyond);
                self.corner_colors.extend(own.iter().map(|_| index(self.face_colors.len())));
                self.face_colors.push(color);
            }
            if own_places.len() == 2 * own.len() {
                let before = self.mesh.corners.len() - own.len();
                self.mesh.corner_uvs.resize(before, NONE);
                for place in own_places.chunks_exact(2) {
                    self.mesh.corner_uvs.push(index(self.mesh.uvs.len()));
                    self.mesh.uvs.push(DVec2::new(place[0], 1.0 - place[1]));
                }
            }
        }
        Ok(())
    }

    /// Strips of triangles, one after the other in a list, with -1 between.
    fn strips(&mut self, element: &Element, body: &mut Body<'_>) -> Result<(), PlyFault> {
        let corners = element.find(&CORNERS);
        for row in 0..element.count {
            let mut own = Vec::new();
            body.row(element, row, |column, values| {
                if Some(column) == corners {
                    own = values.to_vec();
                }
                Ok(())
            })?;
            for strip in own.split(|index| *index == -1.0) {
                let strip = strip.iter().map(|index| self.corner(element, row, *index));
                let strip = strip.collect::<Result<Vec<u32>, _>>()?;
                for (at, triangle) in strip.windows(3).enumerate() {
                    let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                    // Corners that repeat only lead on to the next strip.
                    if a != b && b != c && c != a {
                        self.face(&if at % 2 == 0 { [a, b, c] } else { [b, a, c] }, 0.0);
                    }
                }
            }
        }
        Ok(())
    }

    fn corner(&self, element: &Element, row: u64, index: f64) -> Result<u32, PlyFault> {
        let count = self.mesh.points.len();
        if index >= 0.0 && index < count as f64 && index.fract() == 0.0 {
            return Ok(floor_count(index));
        }
        Err(PlyFault::Index { element: element.name.clone(), row: row + 1, index, count })
    }

    /// A face that shows the picture of a number, where there is one.
    fn face(&mut self, corners: &[u32], picture: f64) {
        let known = picture >= 0.0 && picture < self.pictures.len() as f64;
        self.mesh.push_face(&[corners], known.then(|| floor_count(picture)), 0);
    }

    fn finish(mut self, options: &ImportOptions) -> Result<Imported, ImportError> {
        let points = self.mesh.points.len();
        if self.mesh.faces.is_empty() {
            return Err(ImportError::NoFaces { vertices: count_of(points) });
        }
        let corners = || self.mesh.corners.iter().map(|point| point.0).collect::<Vec<_>>();
        let mut notes = Vec::new();
        let mut tell = |message: String| notes.push(Note { line: None, message });
        if self.normals.iter().all(|normal| *normal != DVec3::ZERO) && !self.normals.is_empty() {
            self.mesh.corner_normals = corners();
            self.mesh.normals = self.normals;
        } else if !self.normals.is_empty() {
            tell("some normals have no length; normals are found from the faces".to_owned());
        }
        if self.mesh.uvs.is_empty() && !self.places.is_empty() {
            self.mesh.corner_uvs = corners();
            self.mesh.uvs = self.places;
        } else if !self.mesh.uvs.is_empty() {
            self.mesh.corner_uvs.resize(self.mesh.corners.len(), NONE);
        }
        if self.small > 0 {
            tell(format!("{} faces have fewer than three corners and are left out", self.small));
        }
        if !self.colors.is_empty() {
            self.mesh.corner_colors = corners();
            self.mesh.colors = self.colors;
            if !self.face_colors.is_empty() {
                tell("its points have colors, so those of its faces are left out".to_owned());
            }
        } else if self.corner_colors.len() == self.mesh.corners.len() {
            self.mesh.corner_colors = self.corner_colors;
            self.mesh.colors = self.face_colors;
        } else if !self.face_colors.is_empty() {
            tell("some of its faces have no colors, so those of the others are left out".to_owned());
        }
        if self.beyond > 0 {
            tell(format!("{} colors have parts beyond their range, which are held back", self.beyond));
        }
        if let Some(weld) = options.weld {
            self.mesh.weld(weld);
        }
        let name = |number: usize| format!("texture-{}", number + 1);
        let look = |(number, path): (usize, &String)| MaterialLook::pictured(&name(number), path);
        let materials: Vec<MaterialLook> = self.pictures.iter().enumerate().map(look).collect();
        self.mesh.materials = materials.iter().map(|look| look.name.clone()).collect();
        Ok(Imported { mesh: self.mesh, materials, groups: Vec::new(), notes })
    }
}

#[cfg(test)]
mod tests;

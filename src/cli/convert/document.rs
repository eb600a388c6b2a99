//! The text of a converted mesh.
//!
//! Promise: the text is a document as `kiln fmt` leaves it, whose shape has the points, polygons with holes, texture
//! coordinates, smoothing and materials of the file; numbers that are exactly those of single precision are written as
//! short as these need, so they differ from the file's by less than single precision tells apart.
//! What a document cannot say is told in a note.

use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

use super::smoothing::{Smoothing, smoothing};
use crate::geometry::mesh::polygon::NONE;
use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::number::srgb_to_linear;
use crate::import::look::PictureSource;
use crate::import::{Imported, MaterialLook};
use crate::language::format;
use crate::language::spec::{SubdivisionScheme, Unit, Up, kebab};

/// Columns of a line of an array.
const COLUMNS: usize = 100;

/// What is written beside the mesh.
pub(super) struct Written<'w> {
    /// The name of the shape.
    pub(super) name: &'w str,
    /// The file it comes from.
    pub(super) source: &'w Path,
    /// The folder of the document.
    pub(super) folder: &'w Path,
    pub(super) unit: Unit,
    pub(super) up: Up,
    pub(super) subdivide: Option<SubdivisionScheme>,
}

/// A document and what it does not say.
pub(super) struct Converted {
    pub(super) text: String,
    pub(super) notes: Vec<String>,
}

impl Written<'_> {
    pub(super) fn document(&self, imported: &Imported) -> Converted {
        let mesh = &imported.mesh;
        let mut notes = Vec::new();
        let source = self.source.file_name().unwrap_or_default().to_string_lossy();
        let (points, faces) = (mesh.points.len(), mesh.faces.len());
        let mut text = format!(
            "# {} from {}: {points} points, {faces} faces\n",
            self.name,
            source.escape_debug().to_string().replace('#', "")
        );
        let _ = writeln!(text, "unit = \"{}\"", self.unit.text());
        if self.up != Up::Y {
            let _ = writeln!(text, "up = \"{}\"", self.up.text());
        }
        let materials = self.materials(imported, &mut text, &mut notes);
        let one = (!materials.is_empty()
            && mesh.faces.iter().all(|face| face.material == mesh.faces[0].material))
        .then(|| name_of(&materials, mesh.faces[0].material));
        let cage = if self.subdivide.is_some() { self.cage_name() } else { self.name.to_owned() };
        let _ = writeln!(text, "\n[shape.{cage}]");
        if let Some(name) = &one {
            let _ = writeln!(text, "material = \"{name}\"");
        }
        let smooth = if mesh.has_smoothing { None } else { smoothing(mesh) };
        match &smooth {
            Some(Smoothing::Smooth) => text.push_str("smoothing = \"smooth\"\n"),
            Some(Smoothing::Flat) => text.push_str("smoothing = \"flat\"\n"),
            _ => {}
        }
        let _ = writeln!(text, "\n[shape.{cage}.mesh]");
        self.mesh(mesh, &materials, one.is_none(), smooth.as_ref(), &mut text, &mut notes);
        if let Some(scheme) = self.subdivide {
            let _ = writeln!(text, "\n[shape.{}]", self.name);
            if let Some(name) = &one {
                let _ = writeln!(text, "material = \"{name}\"");
            }
            let _ = writeln!(text, "\n[shape.{}.subdivide]\ncage = \"{cage}\"", self.name);
            let _ = writeln!(text, "scheme = \"{}\"", scheme.text());
            let creased = matches!(scheme, SubdivisionScheme::CatmullClark | SubdivisionScheme::Loop);
            if creased {
                creases(mesh, &mut text);
            } else if !mesh.creases.is_empty() || !mesh.sharp_points.is_empty() {
                notes.push(format!(
                    "the scheme \"{}\" has no creases; those of the file are left out",
                    scheme.text()
                ));
            }
            let triangles = matches!(
                scheme,
                SubdivisionScheme::Loop | SubdivisionScheme::Root3 | SubdivisionScheme::Butterfly
            );
            if triangles && (0..faces).any(|face| mesh.corners_of(face).len() > 3) {
                text.push_str("triangulate = true\n");
            }
        }
        Converted { text: format(&text), notes }
    }

    /// A name for the cage that is not that of the shape, and no longer than names are.
    fn cage_name(&self) -> String {
        kebab(&format!("{}-cage", self.name)).unwrap_or_else(|| "cage".to_owned())
    }

    /// Writes the materials that faces have, and gives for each of the file its name; last one for faces that have none
    /// where others do.
    fn materials(&self, imported: &Imported, text: &mut String, notes: &mut Vec<String>) -> Vec<String> {
        let mesh = &imported.mesh;
        let mut names: Vec<String> = Vec::new();
        for (number, written) in mesh.materials.iter().enumerate() {
            let wished = kebab(written).unwrap_or_else(|| format!("material-{}", number + 1));
            let name = unlike(&names, &wished);
            let used = mesh.faces.iter().any(|face| face.material == Some(index(number)));
            if used {
                let from = if name == *written {
                    String::new()
                } else {
                    format!("  # `{}` of the file", written.escape_debug().to_string().replace('`', ""))
                };
                let _ = writeln!(text, "\n[material.{name}]{from}");
                if let Some(look) = imported.materials.get(number) {
                    self.look(look, text, notes);
                }
            }
            names.push(name);
        }
        if mesh.faces.iter().any(|face| face.material.is_none()) && !names.is_empty() {
            let name = unlike(&names, "plain");
            let _ = writeln!(text, "\n[material.{name}]");
            names.push(name);
        }
        names
    }

    fn look(&self, look: &MaterialLook, text: &mut String, notes: &mut Vec<String>) {
        let opacity = look.opacity.unwrap_or(1.0);
        if look.color.is_some() || opacity < 1.0 {
            let [red, green, blue] = look.color.unwrap_or([1.0; 3]);
            let _ = writeln!(text, "color = {}", color([red, green, blue, opacity]));
        }
        if let Some(cutoff) = look.cutoff {
            let _ = writeln!(text, "alpha = \"mask\"\nalpha-cutoff = {}", rounded(cutoff));
        } else if look.blends {
            text.push_str("alpha = \"blend\"\n");
        }
        for (key, value) in [("metallic", look.metallic), ("roughness", look.roughness)] {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {}", rounded(value));
            }
        }
        if let Some([red, green, blue]) = look.emissive.filter(|light| *light != [0.0; 3]) {
            let _ = writeln!(text, "emissive = {}", color([red, green, blue, 1.0]));
        }
        if look.double_sided {
            text.push_str("double-sided = true\n");
        }
        for (field, picture) in look.pictures.all() {
            let path = match &picture.source {
                PictureSource::File(path) => path,
                PictureSource::Inside { number, .. } => {
                    notes.push(format!("picture {number} stands inside the file and was left out"));
                    continue;
                }
            };
            match self.path_to(path) {
                Some(path) => {
                    let _ = writeln!(text, "{field} = {}", toml::Value::from(path));
                }
                None => notes.push(format!("the picture {path} is not beside the file and was left out")),
            }
        }
    }

    /// The path of a picture from the folder of the document, where the picture is there.
    fn path_to(&self, picture: &str) -> Option<String> {
        let picture = picture.replace('\\', "/");
        let folder = |path: &Path| {
            let folder = if path.as_os_str().is_empty() { Path::new(".") } else { path };
            std::fs::canonicalize(folder).ok()
        };
        let file = std::fs::canonicalize(folder(self.source.parent()?)?.join(picture)).ok()?;
        let from = folder(self.folder)?;
        let mut shared = from.components().zip(file.components()).take_while(|(a, b)| a == b).count();
        if !matches!(from.components().next(), Some(Component::RootDir)) && shared == 0 {
            return None;
        }
        shared = shared.min(file.components().count() - 1);
        let mut path = PathBuf::new();
        path.extend(from.components().skip(shared).map(|_| ".."));
        path.extend(file.components().skip(shared));
        Some(path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/"))
    }

    fn mesh(
        &self,
        mesh: &PolygonMesh,
        materials: &[String],
        several: bool,
        smooth: Option<&Smoothing>,
        text: &mut String,
        notes: &mut Vec<String>,
    ) {
        array(text, "points", mesh.points.iter().map(|point| numbers(&point.to_array())));
        array(text, "faces", (0..mesh.faces.len()).map(|face| loops(mesh, face, |k| mesh.corners[k].0)));
        self.uvs(mesh, text, notes);
        self.colors(mesh, text, notes);
        let groups: Option<Vec<u32>> = match smooth {
            Some(Smoothing::Groups(groups, lost)) => {
                if *lost > 0 {
                    notes.push(format!("{lost} sharp edges end within a smooth part; they became smooth"));
                }
                Some(groups.clone())
            }
            _ if mesh.has_smoothing => Some(self.groups(mesh, notes)),
            _ => None,
        };
        if let Some(groups) = groups {
            array(text, "smoothing-groups", groups.iter().map(ToString::to_string));
        }
        if several && !materials.is_empty() {
            let names = mesh.faces.iter().map(|face| format!("\"{}\"", name_of(materials, face.material)));
            array(text, "face-materials", names);
        }
    }

    /// One group for each face: where a face is in several, the lowest.
    fn groups(&self, mesh: &PolygonMesh, notes: &mut Vec<String>) -> Vec<u32> {
        if !mesh.smoothing_masks {
            return mesh.faces.iter().map(|face| face.smoothing).collect();
        }
        let several = mesh.faces.iter().filter(|face| face.smoothing.count_ones() > 1).count();
        if several > 0 {
            notes.push(format!(
                "{several} faces are in several smoothing groups; the lowest of each was kept"
            ));
        }
        let lowest = |mask: u32| if mask == 0 { 0 } else { mask.trailing_zeros() + 1 };
        mesh.faces.iter().map(|face| lowest(face.smoothing)).collect()
    }

    fn uvs(&self, mesh: &PolygonMesh, text: &mut String, notes: &mut Vec<String>) {
        if mesh.corner_uvs.iter().all(|&uv| uv == NONE) {
            return;
        }
        let missing = mesh.corner_uvs.iter().filter(|&&uv| uv == NONE).count();
        if missing > 0 {
            notes.push(format!("{missing} corners have no texture coordinates; they are [0, 0]"));
        }
        let extra = (missing > 0).then(|| "[0, 0]".to_owned());
        array(text, "uvs", mesh.uvs.iter().map(|uv| numbers(&uv.to_array())).chain(extra));
        let of = |corner: usize| match mesh.corner_uvs[corner] {
            NONE => index(mesh.uvs.len()),
            uv => uv,
        };
        if (0..mesh.corners.len()).any(|corner| of(corner) != mesh.corners[corner].0)
            || mesh.uvs.len() != mesh.points.len()
        {
            array(text, "face-uvs", (0..mesh.faces.len()).map(|face| loops(mesh, face, of)));
        }
    }

    fn colors(&self, mesh: &PolygonMesh, text: &mut String, notes: &mut Vec<String>) {
        if mesh.corner_colors.is_empty() {
            return;
        }
        let mut of_points: Vec<Option<u32>> = vec![None; mesh.points.len()];
        let mut lost = 0_usize;
        for (corner, &color) in mesh.corners.iter().zip(&mesh.corner_colors) {
            let known = of_points[corner.subscript()].get_or_insert(color);
            lost += usize::from(mesh.colors[*known as usize] != mesh.colors[color as usize]);
        }
        if lost > 0 {
            notes.push(format!("{lost} corners have another color than their point; the point's was kept"));
        }
        let color = |color: &Option<u32>| {
            let parts = color.map_or([1.0; 4], |color| mesh.colors[color as usize].0).map(f64::from);
            numbers(&parts[..if parts[3] < 1.0 { 4 } else { 3 }])
        };
        array(text, "colors", of_points.iter().map(color));
    }
}

/// Longest sharpness; from it on edges are sharp for ever.
const FOREVER: f64 = 10.0;

/// Creases and sharp vertices, those of one sharpness together.
fn creases(mesh: &PolygonMesh, text: &mut String) {
    let sharpness = |value: f64| if value >= FOREVER { "\"sharp\"".to_owned() } else { number(value) };
    let mut groups: Vec<(f64, Vec<String>)> = Vec::new();
    for ([a, b], sharp) in mesh.creases.iter().filter(|(_, sharp)| *sharp > 0.0) {
        let pair = format!("[{}, {}]", a.0, b.0);
        match groups.iter_mut().find(|(known, _)| known == sharp) {
            Some((_, pairs)) => pairs.push(pair),
            None => groups.push((*sharp, vec![pair])),
        }
    }
    if !groups.is_empty() {
        let groups = groups.iter().map(|(sharp, pairs)| {
            format!("{{ edges = [{}], sharpness = {} }}", pairs.join(", "), sharpness(*sharp))
        });
        array(text, "creases", groups);
    }
    let sharp = mesh.sharp_points.iter().filter(|(_, sharp)| *sharp > 0.0);
    let corners: Vec<String> = sharp
        .map(|(point, sharp)| format!("{{ vertex = {}, sharpness = {} }}", point.0, sharpness(*sharp)))
        .collect();
    if !corners.is_empty() {
        array(text, "corners", corners.into_iter());
    }
}

/// The name, or with a number after it that no other has.
fn unlike(names: &[String], wished: &str) -> String {
    let free = |name: &String| !names.contains(name);
    // Names of a document have at most 64 letters.
    let short = wished.get(..56).unwrap_or(wished).trim_end_matches('-');
    let numbered = (2..).map(|number| format!("{short}-{number}"));
    std::iter::once(wished.to_owned()).chain(numbered).find(free).unwrap_or_default()
}

/// The name of a face's material; the last is that of faces without one.
fn name_of(materials: &[String], material: Option<u32>) -> String {
    let number = material.map_or(materials.len() - 1, |material| material as usize);
    materials[number].clone()
}

/// The corners of a face: a list, or a list of loops where it has holes.
fn loops(mesh: &PolygonMesh, face: usize, of: impl Fn(usize) -> u32) -> String {
    let list = |ring: usize| {
        let items: Vec<String> = mesh.corners_of_loop(ring).map(|corner| of(corner).to_string()).collect();
        format!("[{}]", items.join(", "))
    };
    let mut lists: Vec<String> = mesh.loops_of(face).map(list).collect();
    if lists.len() == 1 { lists.remove(0) } else { format!("[{}]", lists.join(", ")) }
}

fn numbers(values: &[f64]) -> String {
    let items: Vec<String> = values.iter().map(|&value| number(value)).collect();
    format!("[{}]", items.join(", "))
}

/// A number as short as it may be.
#[expect(clippy::cast_possible_truncation, reason = "what is lost is looked at")]
fn number(value: f64) -> String {
    let short = value as f32;
    // Adding zero makes of -0 a 0.
    let text = if f64::from(short) == value { (short + 0.0).to_string() } else { (value + 0.0).to_string() };
    if text.len() <= 24 { text } else { format!("{:e}", value + 0.0) }
}

/// A linear color: as on screen where it is exactly one of these, else by its parts.
fn color(linear: [f64; 4]) -> String {
    let parts = if linear[3] < 1.0 { 4 } else { 3 };
    let byte = |(place, &part): (usize, &f64)| {
        let shown = |byte: u8| f64::from(byte) / 255.0;
        let is = |byte: u8| if place < 3 { srgb_to_linear(shown(byte)) } else { shown(byte) };
        (0..=255).find(|&byte| (is(byte) - part).abs() < 1e-7)
    };
    let bytes: Option<Vec<u8>> = linear[..parts].iter().enumerate().map(byte).collect();
    if let Some(bytes) = bytes {
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        return format!("\"#{digits}\"");
    }
    let items: Vec<String> = linear[..parts].iter().map(|&part| rounded(part)).collect();
    format!("[{}]", items.join(", "))
}

/// A number from 0 to 1 to six digits, more than a look needs.
fn rounded(value: f64) -> String {
    number((value * 1e6).round() / 1e6)
}

/// Writes an array over lines of about [`COLUMNS`].
fn array(text: &mut String, key: &str, items: impl Iterator<Item = String>) {
    let _ = writeln!(text, "{key} = [");
    let mut line = String::new();
    for item in items {
        if !line.is_empty() && line.len() + item.len() + 4 > COLUMNS {
            let _ = writeln!(text, "  {line}");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(&item);
        line.push(',');
    }
    let _ = writeln!(text, "  {line}\n]");
}

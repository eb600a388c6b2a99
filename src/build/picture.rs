//! Pictures that files name for their materials, found beside them.

use super::Builder;
use super::import::beside;
use crate::geometry::mesh;
use crate::import::image::{self, Edge, ImageError};
use crate::import::look::{Picture, PictureSource, Pictures};
use crate::import::{MaterialLook, Note};
use crate::language::spec::FilePath;
use crate::model::{
    AlphaMode, Filter, Image, ImageHandle, ImageKind, Material, MaterialHandle, Optics, Texture, Wrap,
};

/// Endings of pictures that glTF holds.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

impl Builder<'_> {
    /// A material as a file describes it; `None` where it says nothing of its look. What of it cannot be shown is noted.
    pub(super) fn look(
        &mut self,
        file: &FilePath,
        look: &MaterialLook,
        notes: &mut Vec<Note>,
    ) -> Option<MaterialHandle> {
        let Pictures { color, metallic_roughness, normal, occlusion, emissive } = &look.pictures;
        let mut show = |picture: Option<&Picture>| self.shown(file, &look.name, picture?, notes);
        let color_texture = show(color.as_ref());
        let metallic_roughness_texture = show(metallic_roughness.as_ref());
        let strong = |of: &Option<(Picture, f64)>, texture: Option<Texture>| {
            texture.zip(of.as_ref().map(|(_, strength)| *strength))
        };
        let normal_texture = strong(normal, show(normal.as_ref().map(|(picture, _)| picture)));
        let occlusion_texture = strong(occlusion, show(occlusion.as_ref().map(|(picture, _)| picture)));
        let emissive_texture = show(emissive.as_ref());
        let [red, green, blue] = look.color.or(color_texture.map(|_| [1.0; 3]))?;
        let opacity = look.opacity.unwrap_or(1.0);
        self.model.materials.push(Material {
            name: look.name.clone(),
            color: [red, green, blue, opacity],
            metallic: look.metallic.unwrap_or(0.0),
            roughness: look.roughness.unwrap_or(1.0),
            color_texture,
            metallic_roughness_texture,
            normal_texture,
            occlusion_texture,
            emissive: look.emissive.unwrap_or(if emissive_texture.is_some() { [1.0; 3] } else { [0.0; 3] }),
            emissive_texture,
            alpha: match look.cutoff {
                Some(cutoff) => AlphaMode::Mask { cutoff },
                None if look.blends => AlphaMode::Blend,
                None => AlphaMode::Opaque,
            },
            double_sided: look.double_sided,
            optics: Optics {
                unlit: look.unlit,
                emissive_strength: look.emissive_strength,
                ..Optics::default()
            },
        });
        Some(MaterialHandle(mesh::index(self.model.materials.len()) - 1))
    }

    /// A picture of a material of a file.
    fn shown(
        &mut self,
        file: &FilePath,
        material: &str,
        picture: &Picture,
        notes: &mut Vec<Note>,
    ) -> Option<Texture> {
        let image = match &picture.source {
            PictureSource::File(path) => self.picture_beside(file, path),
            PictureSource::Inside { number, name, bytes } => {
                let key = format!("{}#{number}", file.resolved);
                let name =
                    if name.is_empty() { format!("{}-{number}", stem(&file.resolved)) } else { name.clone() };
                self.checked(key, name, bytes)
                    .map_err(|error| format!("picture {number} cannot be used: {error}"))
            }
        };
        let image = image.map_err(|reason| {
            let note = Note { line: None, message: format!("material `{material}`: {reason}") };
            if !notes.contains(&note) {
                notes.push(note);
            }
        });
        let wrap = match picture.edge {
            Edge::Repeat => Wrap::Repeat,
            Edge::Clamp => Wrap::Clamp,
            Edge::Mirror => Wrap::Mirror,
        };
        let filter = if picture.nearest { Filter::Nearest } else { Filter::Linear };
        Some(Texture { image: image.ok()?, wrap, filter })
    }

    /// The picture that a file names, in whatever letters' case and with whatever of the endings that glTF knows.
    fn picture_beside(&mut self, file: &FilePath, path: &str) -> Result<ImageHandle, String> {
        let written = plain(path);
        let places = places(&written);
        let mut open = beside(self.files, file);
        for place in &places {
            if let Some(bytes) = open(place) {
                let shown = format!("{place} cannot be used");
                return self
                    .checked(format!("{}/{place}", folder(&file.resolved)), stem(place), &bytes.into())
                    .map_err(|error| format!("{shown}: {error}"));
            }
        }
        // One that is there, but is no such picture.
        if open(&written).is_some() {
            let png = format!("{}.png", without_ending(&written));
            return Err(format!("{written} is neither PNG nor JPEG; convert it to {png} beside it"));
        }
        let mut looked: Vec<&str> = places.iter().map(|place| without_ending(place)).collect();
        looked.retain(|place| place.eq_ignore_ascii_case(without_ending(&written)) || !place.contains('/'));
        looked.dedup_by(|a, b| a.eq_ignore_ascii_case(b));
        let looked: Vec<String> = looked.iter().map(|place| format!("{place}.png")).collect();
        Err(format!(
            "its picture `{path}` is missing: {} was looked for from the folder of the file, .jpg and .jpeg too, in small and large letters",
            looked.join(" or ")
        ))
    }

    /// A picture of the model, once for each key.
    fn checked(
        &mut self,
        key: String,
        name: String,
        bytes: &std::sync::Arc<[u8]>,
    ) -> Result<ImageHandle, ImageError> {
        if let Some(known) = self.images.get(&key).copied().flatten() {
            return Ok(known);
        }
        let facts = image::read(bytes, self.spec.limits.pixels())?;
        let kind = match facts.kind {
            image::Kind::Png => ImageKind::Png,
            image::Kind::Jpeg => ImageKind::Jpeg,
        };
        self.model.images.push(Image { name, kind, bytes: bytes.clone() });
        let handle = ImageHandle(mesh::index(self.model.images.len()) - 1);
        self.images.insert(key, Some(handle));
        Ok(handle)
    }
}

fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

fn stem(path: &str) -> String {
    let name = path.rsplit('/').next().unwrap_or(path);
    without_ending(name).to_owned()
}

fn without_ending(path: &str) -> &str {
    match path.rsplit_once('.') {
        Some((start, ending)) if !start.is_empty() && !ending.contains('/') => start,
        _ => path,
    }
}

/// A path with forward strokes that leads down from the folder of its file; of others the name.
fn plain(path: &str) -> String {
    let path = path.replace('\\', "/");
    let parts: Vec<&str> = path.split('/').filter(|part| !matches!(*part, "" | ".")).collect();
    let leads_away = path.starts_with('/') || parts.iter().any(|part| *part == ".." || part.contains(':'));
    let from = if leads_away { parts.len().saturating_sub(1) } else { 0 };
    parts[from..].join("/")
}

/// Where a picture may stand: at its path or beside the file, with its own ending or another, in the letters that are
/// written, in small and in large ones.
fn places(written: &str) -> Vec<String> {
    let name = written.rsplit('/').next().unwrap_or(written);
    let mut all: Vec<String> = Vec::new();
    for path in [written, name] {
        let (start, own) =
            (without_ending(path), path.strip_prefix(without_ending(path)).unwrap_or_default());
        let own = own.trim_start_matches('.');
        let is_picture = ENDINGS.iter().any(|ending| ending.eq_ignore_ascii_case(own));
        let (before, last) = start
            .rsplit_once('/')
            .map_or((String::new(), start), |(before, last)| (format!("{before}/"), last));
        let mut first = last.to_lowercase();
        if let Some(letter) = first.get_mut(..1) {
            letter.make_ascii_uppercase();
        }
        let stems = [
            format!("{before}{last}"),
            format!("{before}{}", last.to_lowercase()),
            format!("{before}{first}"),
            format!("{before}{}", last.to_uppercase()),
            start.to_lowercase(),
        ];
        let endings = is_picture.then_some(own).into_iter().chain(ENDINGS);
        for ending in
            endings.flat_map(|ending| [ending.to_owned(), ending.to_lowercase(), ending.to_uppercase()])
        {
            all.extend(stems.iter().map(|stem| format!("{stem}.{ending}")));
        }
    }
    let mut seen = std::collections::BTreeSet::new();
    all.retain(|place| seen.insert(place.clone()));
    all
}

#[cfg(test)]
mod tests {
    use super::{places, plain};

    #[test]
    fn paths_of_other_systems_lead_to_names() {
        for (path, name) in [
            ("C:\\maps\\Skin.TGA", "Skin.TGA"),
            ("/home/a/skin.png", "skin.png"),
            ("../skin.png", "skin.png"),
            ("models\\players/a.tga", "models/players/a.tga"),
            ("./a.png", "a.png"),
        ] {
            assert_eq!(plain(path), name, "{path}");
        }
    }

    #[test]
    fn a_picture_is_looked_for_by_its_own_name_first() {
        let all = places("maps/Skin.tga");
        assert_eq!(all[0], "maps/Skin.png");
        for place in ["maps/skin.png", "maps/SKIN.PNG", "Skin.jpg", "skin.jpeg", "SKIN.JPG", "maps/Skin.JPEG"]
        {
            assert!(all.iter().any(|known| known == place), "{place}");
        }
        assert_eq!(places("a.JPG")[0], "a.JPG");
        // A name without an ending, and one whose letters are not those of ASCII.
        assert_eq!(places("maps/stone")[0], "maps/stone.png");
        assert!(places("\u{e4}.png").iter().any(|place| place == "\u{c4}.PNG"));
    }
}

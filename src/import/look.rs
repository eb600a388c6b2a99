//! What files say of how their materials look.

use std::sync::Arc;

use super::image::Edge;

/// What a file or a material library says of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialLook {
    /// Its name.
    pub name: String,
    /// Diffuse color, linear, 0 to 1.
    pub color: Option<[f64; 3]>,
    /// 1 is opaque.
    pub opacity: Option<f64>,
    /// Whether what is not opaque blends with what lies behind it.
    pub blends: bool,
    /// What is more transparent than this is left out, and the rest is opaque.
    pub cutoff: Option<f64>,
    /// How metallic it is, 0 to 1.
    pub metallic: Option<f64>,
    /// How rough it is, 0 to 1.
    pub roughness: Option<f64>,
    /// Linear light that it sends out.
    pub emissive: Option<[f64; 3]>,
    /// What the light that it sends out is multiplied by.
    pub emissive_strength: Option<f64>,
    /// Whether its back is seen.
    pub double_sided: bool,
    /// Whether it shows its color whatever light falls on it.
    pub unlit: bool,
    /// Its pictures.
    pub pictures: Pictures,
}

/// Pictures of a material, as glTF has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// Multiplies the color.
    pub color: Option<Picture>,
    /// Green multiplies the roughness, blue the metal.
    pub metallic_roughness: Option<Picture>,
    /// Normals, and their strength.
    pub normal: Option<(Picture, f64)>,
    /// Red darkens, and how much of it.
    pub occlusion: Option<(Picture, f64)>,
    /// Multiplies the light that is sent out.
    pub emissive: Option<Picture>,
}

/// A picture on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Where it comes from.
    pub source: PictureSource,
    /// What lies beyond its borders.
    pub edge: Edge,
    /// Whether it is in squares when enlarged.
    pub nearest: bool,
}

/// Where a picture comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureSource {
    /// A file, by its path as written, from the folder of the file that names it.
    File(String),
    /// Bytes inside the file.
    Inside {
        /// Its number among the pictures of the file.
        number: usize,
        /// Its name, may be empty.
        name: String,
        /// An encoded picture.
        bytes: Arc<[u8]>,
    },
}

impl Picture {
    /// A picture in a file, which is repeated.
    #[must_use]
    pub fn file(path: impl Into<String>) -> Self {
        Self { source: PictureSource::File(path.into()), edge: Edge::Repeat, nearest: false }
    }
}

impl MaterialLook {
    /// A material of a name that shows a picture of a file; none where the path is empty.
    #[must_use]
    pub fn pictured(name: &str, path: &str) -> Self {
        let color = Some(path).filter(|path| !path.is_empty()).map(Picture::file);
        Self { name: name.to_owned(), pictures: Pictures { color, ..Pictures::default() }, ..Self::default() }
    }
}

impl Pictures {
    /// All of them, each with the field of a document that names it.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &Picture)> {
        let all = [
            ("color-texture", self.color.as_ref()),
            ("metallic-roughness-texture", self.metallic_roughness.as_ref()),
            ("normal-texture", self.normal.as_ref().map(|(picture, _)| picture)),
            ("occlusion-texture", self.occlusion.as_ref().map(|(picture, _)| picture)),
            ("emissive-texture", self.emissive.as_ref()),
        ];
        all.into_iter().filter_map(|(field, picture)| Some((field, picture?)))
    }
}

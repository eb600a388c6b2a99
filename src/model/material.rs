//! Materials and the images they show.

use std::sync::Arc;

use super::optics::Optics;

/// Index of a material in its model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialHandle(pub u32);

/// Index of an image in its model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImageHandle(pub u32);

/// A metallic-roughness material; colors are linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Red, green, blue, alpha, each 0 to 1.
    pub color: [f64; 4],
    /// 0 to 1.
    pub metallic: f64,
    /// 0 to 1.
    pub roughness: f64,
    /// Multiplies the color.
    pub color_texture: Option<Texture>,
    /// Green multiplies roughness, blue metallic.
    pub metallic_roughness_texture: Option<Texture>,
    /// Normals in tangent space, and their strength.
    pub normal_texture: Option<(Texture, f64)>,
    /// Occlusion in red, and its strength 0 to 1.
    pub occlusion_texture: Option<(Texture, f64)>,
    /// Red, green, blue of the light given off.
    pub emissive: [f64; 3],
    /// Multiplies the light given off.
    pub emissive_texture: Option<Texture>,
    /// What alpha does.
    pub alpha: AlphaMode,
    /// Whether the back is seen.
    pub double_sided: bool,
    /// What light does there beyond that.
    pub optics: Optics,
}

/// What alpha does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Parts below the cutoff are left out.
    Mask {
        /// Between 0 and 1.
        cutoff: f64,
    },
    /// It blends with what lies behind.
    Blend,
}

/// An image and how it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// The image.
    pub image: ImageHandle,
    /// Beyond the borders.
    pub wrap: Wrap,
    /// Between the pixels.
    pub filter: Filter,
}

/// What the numbers of a texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureUse {
    /// A color, as screens show it.
    Color,
    /// Normals.
    Normal,
    /// Numbers of other kinds.
    Data,
}

/// What lies beyond the borders of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// Its border.
    Clamp,
    /// The image mirrored.
    Mirror,
}

/// How an image looks when enlarged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Smooth.
    Linear,
    /// In squares.
    Nearest,
}

/// An encoded image.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Its name: the file's, without its ending.
    pub name: String,
    /// How it is encoded.
    pub kind: ImageKind,
    /// The file's bytes.
    pub bytes: Arc<[u8]>,
}

/// How an image is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageKind {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
}

/// A normal map of a shape's heights. Its image is empty until it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    /// The shape.
    pub shape: super::ShapeHandle,
    /// The material that shows it: the shape's own, with the map.
    pub material: MaterialHandle,
    /// Name of the image.
    pub name: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

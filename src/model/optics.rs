//! What light does at a surface beyond color, metal and roughness; each part is an extension of glTF.

use glam::DVec4;

use super::material::{AlphaMode, Material, Texture, TextureUse};
use crate::motion::Property;

/// What a material has of it. Lengths are metres; colors are linear red, green and blue, each 0 to 1; shares are 0 to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Optics {
    /// Whether it shows its color whatever light falls on it.
    pub unlit: bool,
    /// What the light that it gives off is multiplied by.
    pub emissive_strength: Option<f64>,
    /// Index of refraction, from 1.
    pub ior: Option<f64>,
    /// 20 over the Abbe number.
    pub dispersion: Option<f64>,
    /// A coat over it.
    pub clearcoat: Option<Clearcoat>,
    /// Light that goes through it.
    pub transmission: Option<Transmission>,
    /// The body below it.
    pub volume: Option<Volume>,
    /// What it reflects where it is no metal.
    pub specular: Option<Specular>,
    /// Fibers on it.
    pub sheen: Option<Sheen>,
    /// A film on it.
    pub iridescence: Option<Iridescence>,
    /// Shine along a direction.
    pub anisotropy: Option<Anisotropy>,
}

/// A coat over a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// The share of the surface that it covers.
    pub factor: f64,
    /// Red multiplies the factor.
    pub texture: Option<Texture>,
    /// 0 to 1.
    pub roughness: f64,
    /// Green multiplies the roughness.
    pub roughness_texture: Option<Texture>,
    /// Normals in tangent space, and their strength.
    pub normal_texture: Option<(Texture, f64)>,
}

/// Light that goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// The share of what is not reflected.
    pub factor: f64,
    /// Red multiplies the factor.
    pub texture: Option<Texture>,
}

/// The body below a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// How thick it is.
    pub thickness: f64,
    /// Green multiplies the thickness.
    pub thickness_texture: Option<Texture>,
    /// The way after which white light has the color; `None` without end.
    pub attenuation_distance: Option<f64>,
    /// That color.
    pub attenuation_color: [f64; 3],
}

/// What is reflected by no metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Its share.
    pub factor: f64,
    /// Alpha multiplies the factor.
    pub texture: Option<Texture>,
    /// Its color where light falls straight onto the surface.
    pub color: [f64; 3],
    /// Multiplies the color.
    pub color_texture: Option<Texture>,
}

/// Fibers on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Their color.
    pub color: [f64; 3],
    /// Multiplies the color.
    pub color_texture: Option<Texture>,
    /// 0 to 1.
    pub roughness: f64,
    /// Alpha multiplies the roughness.
    pub roughness_texture: Option<Texture>,
}

/// A film on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Its share.
    pub factor: f64,
    /// Red multiplies the factor.
    pub texture: Option<Texture>,
    /// Its index of refraction.
    pub ior: f64,
    /// How thick it is at most, nanometres; everywhere, without a texture.
    pub thickness: f64,
    /// Green leads from the least thickness to the greatest, with the least in nanometres.
    pub thickness_texture: Option<(Texture, f64)>,
}

/// Shine along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// 0 to 1.
    pub strength: f64,
    /// Degrees from the tangent, against the clock.
    pub rotation: f64,
    /// Red and green turn the direction, blue multiplies the strength.
    pub texture: Option<Texture>,
}

/// All textures of a material with what they mean, borrowed by `as_ref` or `as_mut`; of the unlit too.
macro_rules! textures {
    ($own:expr, $borrow:ident) => {{
        use TextureUse::{Color, Data, Normal};
        let own = $own;
        let mut all = vec![
            (own.color_texture.$borrow(), Color),
            (own.metallic_roughness_texture.$borrow(), Data),
            (own.emissive_texture.$borrow(), Color),
            (own.normal_texture.$borrow().map(|(texture, _)| texture), Normal),
            (own.occlusion_texture.$borrow().map(|(texture, _)| texture), Data),
        ];
        if let Some(coat) = own.optics.clearcoat.$borrow() {
            all.push((coat.texture.$borrow(), Data));
            all.push((coat.roughness_texture.$borrow(), Data));
            all.push((coat.normal_texture.$borrow().map(|(texture, _)| texture), Normal));
        }
        if let Some(transmission) = own.optics.transmission.$borrow() {
            all.push((transmission.texture.$borrow(), Data));
        }
        if let Some(volume) = own.optics.volume.$borrow() {
            all.push((volume.thickness_texture.$borrow(), Data));
        }
        if let Some(specular) = own.optics.specular.$borrow() {
            all.push((specular.texture.$borrow(), Data));
            all.push((specular.color_texture.$borrow(), Color));
        }
        if let Some(sheen) = own.optics.sheen.$borrow() {
            all.push((sheen.color_texture.$borrow(), Color));
            all.push((sheen.roughness_texture.$borrow(), Data));
        }
        if let Some(film) = own.optics.iridescence.$borrow() {
            all.push((film.texture.$borrow(), Data));
            all.push((film.thickness_texture.$borrow().map(|(texture, _)| texture), Data));
        }
        if let Some(anisotropy) = own.optics.anisotropy.$borrow() {
            all.push((anisotropy.texture.$borrow(), Data));
        }
        all.into_iter().filter_map(|(texture, meaning)| Some((texture?, meaning)))
    }};
}

impl Material {
    /// Its textures, each with what it means.
    pub fn textures(&self) -> impl Iterator<Item = (&Texture, TextureUse)> {
        textures!(self, as_ref)
    }

    /// Its textures, to be changed.
    pub fn textures_mut(&mut self) -> impl Iterator<Item = (&mut Texture, TextureUse)> {
        textures!(self, as_mut)
    }

    /// Whether it is drawn by texture coordinates: with a picture, or with shine along one of their directions.
    #[must_use]
    pub fn needs_uv(&self) -> bool {
        self.optics.anisotropy.is_some() || self.textures().next().is_some()
    }

    /// Whether it is drawn in a frame of tangents.
    #[must_use]
    pub fn needs_tangents(&self) -> bool {
        self.optics.anisotropy.is_some() || self.textures().any(|(_, meaning)| meaning == TextureUse::Normal)
    }

    /// The numbers of a property that it has: colors as red, green, blue and alpha.
    #[must_use]
    pub fn value(&self, property: Property) -> Option<DVec4> {
        let rgb = |[red, green, blue]: [f64; 3]| Some(DVec4::new(red, green, blue, 0.0));
        let optics = &self.optics;
        let number = match property {
            Property::Color => return Some(DVec4::from_array(self.color)),
            Property::Emissive => return rgb(self.emissive),
            Property::AttenuationColor => return rgb(optics.volume?.attenuation_color),
            Property::SpecularColor => return rgb(optics.specular?.color),
            Property::SheenColor => return rgb(optics.sheen?.color),
            Property::Metallic => self.metallic,
            Property::Roughness => self.roughness,
            Property::NormalScale => self.normal_texture?.1,
            Property::OcclusionStrength => self.occlusion_texture?.1,
            Property::AlphaCutoff => match self.alpha {
                AlphaMode::Mask { cutoff } => cutoff,
                _ => return None,
            },
            Property::EmissiveStrength => optics.emissive_strength?,
            Property::Ior => optics.ior?,
            Property::Dispersion => optics.dispersion?,
            Property::Clearcoat => optics.clearcoat?.factor,
            Property::ClearcoatRoughness => optics.clearcoat?.roughness,
            Property::ClearcoatNormalScale => optics.clearcoat?.normal_texture?.1,
            Property::Transmission => optics.transmission?.factor,
            Property::Thickness => optics.volume?.thickness,
            Property::AttenuationDistance => optics.volume?.attenuation_distance?,
            Property::Specular => optics.specular?.factor,
            Property::SheenRoughness => optics.sheen?.roughness,
            Property::Iridescence => optics.iridescence?.factor,
            Property::IridescenceIor => optics.iridescence?.ior,
            Property::IridescenceThickness => optics.iridescence?.thickness,
            Property::Anisotropy => optics.anisotropy?.strength,
            Property::AnisotropyRotation => optics.anisotropy?.rotation,
            Property::LightColor
            | Property::Intensity
            | Property::Range
            | Property::FieldOfView
            | Property::Height => return None,
        };
        Some(DVec4::X * number)
    }
}

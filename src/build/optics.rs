//! What light does at surfaces beyond color, metal and roughness.

use super::Builder;
use crate::language::spec::{self, Color};
use crate::model::{Anisotropy, Clearcoat, Iridescence, Optics, Sheen, Specular, Transmission, Volume};

impl Builder<'_> {
    /// The optics of a material; lengths become metres. None where a picture of theirs cannot be used.
    pub(super) fn optics(&mut self, written: &spec::Material) -> Option<Optics> {
        let unit = self.model.frame.unit;
        // All pictures are looked at before the first fault ends it.
        let clearcoat = written.clearcoat.as_ref().map(|own| self.clearcoat(&own.value));
        let transmission = written.transmission.as_ref().map(|own| {
            let texture = self.texture(own.value.texture.as_ref())?;
            Some(Transmission { factor: own.value.factor.value, texture })
        });
        let volume = written.volume.as_ref().map(|own| {
            Some(Volume {
                thickness: own.value.thickness.value * unit,
                thickness_texture: self.texture(own.value.thickness_texture.as_ref())?,
                attenuation_distance: own.value.attenuation_distance.as_ref().map(|way| way.value * unit),
                attenuation_color: rgb(&own.value.attenuation_color.value),
            })
        });
        let specular = written.specular.as_ref().map(|own| self.specular(&own.value));
        let sheen = written.sheen.as_ref().map(|own| self.sheen(&own.value));
        let iridescence = written.iridescence.as_ref().map(|own| self.iridescence(&own.value));
        let anisotropy = written.anisotropy.as_ref().map(|own| {
            let texture = self.texture(own.value.texture.as_ref())?;
            let (strength, rotation) = (own.value.strength.value, own.value.rotation.value);
            Some(Anisotropy { strength, rotation, texture })
        });
        Some(Optics {
            unlit: written.unlit.value,
            emissive_strength: written.emissive_strength.as_ref().map(|own| own.value),
            ior: written.ior.as_ref().map(|own| own.value),
            dispersion: written.dispersion.as_ref().map(|own| own.value),
            clearcoat: sound(clearcoat)?,
            transmission: sound(transmission)?,
            volume: sound(volume)?,
            specular: sound(specular)?,
            sheen: sound(sheen)?,
            iridescence: sound(iridescence)?,
            anisotropy: sound(anisotropy)?,
        })
    }

    fn clearcoat(&mut self, written: &spec::Clearcoat) -> Option<Clearcoat> {
        let texture = self.texture(written.texture.as_ref());
        let roughness_texture = self.texture(written.roughness_texture.as_ref());
        let normal = self.texture(written.normal_texture.as_ref())?;
        Some(Clearcoat {
            factor: written.factor.value,
            texture: texture?,
            roughness: written.roughness.value,
            roughness_texture: roughness_texture?,
            normal_texture: normal.map(|texture| (texture, written.normal_scale.value)),
        })
    }

    fn specular(&mut self, written: &spec::Specular) -> Option<Specular> {
        let texture = self.texture(written.texture.as_ref());
        let color_texture = self.texture(written.color_texture.as_ref())?;
        let (factor, color) = (written.factor.value, rgb(&written.color.value));
        Some(Specular { factor, texture: texture?, color, color_texture })
    }

    fn sheen(&mut self, written: &spec::Sheen) -> Option<Sheen> {
        let color_texture = self.texture(written.color_texture.as_ref());
        let roughness_texture = self.texture(written.roughness_texture.as_ref())?;
        let (color, roughness) = (rgb(&written.color.value), written.roughness.value);
        Some(Sheen { color, color_texture: color_texture?, roughness, roughness_texture })
    }

    fn iridescence(&mut self, written: &spec::Iridescence) -> Option<Iridescence> {
        let texture = self.texture(written.texture.as_ref());
        let thickness_texture = self.texture(written.thickness_texture.as_ref())?;
        Some(Iridescence {
            factor: written.factor.value,
            texture: texture?,
            ior: written.ior.value,
            thickness: written.thickness.value,
            thickness_texture: thickness_texture.map(|texture| (texture, written.least())),
        })
    }
}

/// A part that is not written, or one that was built; the outer `None` says that it failed.
#[expect(clippy::option_option, reason = "absent and failed are different answers")]
fn sound<T>(built: Option<Option<T>>) -> Option<Option<T>> {
    match built {
        None => Some(None),
        Some(built) => built.map(Some),
    }
}

fn rgb(color: &Color) -> [f64; 3] {
    let [red, green, blue, _] = color.linear;
    [red, green, blue]
}

//! What light does at a surface beyond color, metal and roughness: coats, glass, cloth, thin films, brushed metal.
//!
//! Each table is one extension of the format, which files use and never require: an engine that does not know it draws the
//! material without it. Numbers have the ranges of the extensions; lengths are in the document's unit, angles in degrees, the
//! thickness of thin films in nanometres.
//!
//! Sources: Khronos Group, `KHR_materials_anisotropy`, `_clearcoat`, `_dispersion`, `_emissive_strength`, `_ior`,
//! `_iridescence`, `_sheen`, `_specular`, `_transmission`, `_unlit`, `_volume`, 2020 to 2024.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::material::{Color, Material, Texture};
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

/// Indices of refraction.
pub(super) const IOR: Check = Check::within(1.0, 100.0);
const SHARE: Check = Check::within(0.0, 1.0);

table! {
    /// A clear coat over the material, as of lacquer: `KHR_materials_clearcoat`.
    "clearcoat" pub Clearcoat {
        /// How much of the surface it covers.
        factor: Sp<f64> = 1.0 => SHARE;
        /// An image whose red multiplies `factor`.
        texture: Option<Sp<Texture>>;
        /// 0 is a mirror, 1 a chalk.
        roughness: Sp<f64> = 0.0 => SHARE;
        /// An image whose green multiplies `roughness`.
        roughness_texture: Option<Sp<Texture>>;
        /// An image of small bumps of the coat, as normals in tangent space.
        normal_texture: Option<Sp<Texture>>;
        /// Strength of the normal texture.
        normal_scale: Sp<f64> = 1.0;
    }
}

table! {
    /// Light goes through the surface, as through glass: `KHR_materials_transmission`. What it goes through is thin; a body has a
    /// `volume` too.
    "transmission" pub Transmission {
        /// The part of the light that is not reflected and goes through.
        factor: Sp<f64> = 1.0 => SHARE;
        /// An image whose red multiplies `factor`.
        texture: Option<Sp<Texture>>;
    }
}

table! {
    /// The body below a surface that light goes through, which bends it and takes some: `KHR_materials_volume`. The shape is
    /// closed, and `transmission` stands beside it.
    "volume" pub Volume {
        /// How thick the body is below the surface, in the document's unit, for engines that follow no rays.
        thickness: Sp<f64> => Check::above(0.0);
        /// An image whose green multiplies `thickness`.
        thickness_texture: Option<Sp<Texture>>;
        /// After this way in the body, in the document's unit, white light has the `attenuation-color`; no light is taken when
        /// it is not written.
        attenuation_distance: Option<Sp<f64>> => Check::above(0.0);
        /// The color of white light after that way.
        attenuation_color: Sp<Color> = Color::WHITE;
    }
    checked check
}

table! {
    /// What a surface that is no metal reflects: `KHR_materials_specular`.
    "specular" pub Specular {
        /// How much of it.
        factor: Sp<f64> = 1.0 => SHARE;
        /// An image whose alpha multiplies `factor`.
        texture: Option<Sp<Texture>>;
        /// Its color where light falls straight onto the surface.
        color: Sp<Color> = Color::WHITE;
        /// An image that multiplies `color`.
        color_texture: Option<Sp<Texture>>;
    }
}

table! {
    /// Fibers that stand up from the surface and shine at its rim, as of velvet: `KHR_materials_sheen`.
    "sheen" pub Sheen {
        /// Their color.
        color: Sp<Color> = Color::WHITE;
        /// An image that multiplies `color`.
        color_texture: Option<Sp<Texture>>;
        /// 0 is a thin rim, 1 a shine all over.
        roughness: Sp<f64> = 0.5 => SHARE;
        /// An image whose alpha multiplies `roughness`.
        roughness_texture: Option<Sp<Texture>>;
    }
}

table! {
    /// A thin film whose color changes with the angle, as of soap: `KHR_materials_iridescence`.
    "iridescence" pub Iridescence {
        /// How much of it.
        factor: Sp<f64> = 1.0 => SHARE;
        /// An image whose red multiplies `factor`.
        texture: Option<Sp<Texture>>;
        /// The film's index of refraction.
        ior: Sp<f64> = 1.3 => IOR;
        /// How thick the film is in nanometres; with `thickness-texture` where that is white.
        thickness: Sp<f64> = 400.0 => Check::within(0.0, 1e6);
        /// An image whose green leads from `least-thickness` to `thickness`.
        thickness_texture: Option<Sp<Texture>>;
        /// How thick the film is in nanometres where `thickness-texture` is black: 100 when it is not written.
        least_thickness: Option<Sp<f64>> => Check::within(0.0, 1e6);
    }
    checked check
}

table! {
    /// A surface whose shine is drawn out along one direction, as of brushed metal: `KHR_materials_anisotropy`. The direction is
    /// one of texture coordinates, which the shape then has.
    "anisotropy" pub Anisotropy {
        /// How much it is drawn out.
        strength: Sp<f64> = 1.0 => SHARE;
        /// Degrees from the direction in which u grows, against the clock: the shine is drawn out along it.
        rotation: Sp<f64> = 0.0 => Check::within(-1e6, 1e6);
        /// An image whose red and green turn that direction and whose blue multiplies `strength`.
        texture: Option<Sp<Texture>>;
    }
}

impl Volume {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.attenuation_distance.is_some() || self.attenuation_color.span.is_none() {
            return true;
        }
        let report = Diagnostic::error(Code::Conflict, "`attenuation-color` needs `attenuation-distance`")
            .at(self.attenuation_color.span, "has no effect")
            .help("write the way after which white light has this color");
        reader.report(report);
        false
    }
}

impl Iridescence {
    /// How thick the film is at least, nanometres.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.least_thickness.as_ref().map_or(100.0, |least| least.value)
    }

    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.least_thickness, &self.thickness_texture) {
            (Some(least), None) => {
                Diagnostic::error(Code::Conflict, "`least-thickness` needs `thickness-texture`")
                    .at(least.span, "has no effect")
                    .help("write the thickness of the film as `thickness`")
            }
            (_, Some(texture)) if self.least() == self.thickness.value => {
                let both = show_number(self.thickness.value);
                let message = format!("`thickness-texture` leads from {both} to {both} nanometres");
                Diagnostic::error(Code::Conflict, message)
                    .at(texture.span, "has no effect")
                    .help("write another `thickness` or `least-thickness`")
            }
            _ => return true,
        };
        reader.report(report);
        false
    }
}

impl Material {
    /// What of it is an extension of the format: the key, the extension and where it is written.
    #[must_use]
    pub fn extensions(&self) -> Vec<(&'static str, &'static str, Span)> {
        let span = |written: &Option<Sp<f64>>| written.as_ref().map(|own| own.span);
        let unlit = self.unlit.value.then_some(self.unlit.span);
        let all = [
            ("anisotropy", "KHR_materials_anisotropy", self.anisotropy.as_ref().map(|own| own.span)),
            ("clearcoat", "KHR_materials_clearcoat", self.clearcoat.as_ref().map(|own| own.span)),
            ("dispersion", "KHR_materials_dispersion", span(&self.dispersion)),
            ("emissive-strength", "KHR_materials_emissive_strength", span(&self.emissive_strength)),
            ("ior", "KHR_materials_ior", span(&self.ior)),
            ("iridescence", "KHR_materials_iridescence", self.iridescence.as_ref().map(|own| own.span)),
            ("sheen", "KHR_materials_sheen", self.sheen.as_ref().map(|own| own.span)),
            ("specular", "KHR_materials_specular", self.specular.as_ref().map(|own| own.span)),
            ("transmission", "KHR_materials_transmission", self.transmission.as_ref().map(|own| own.span)),
            ("unlit", "KHR_materials_unlit", unlit),
            ("volume", "KHR_materials_volume", self.volume.as_ref().map(|own| own.span)),
        ];
        all.into_iter().filter_map(|(key, extension, span)| Some((key, extension, span?))).collect()
    }

    /// What needs something that is not written, or cannot stand beside something that is.
    pub(super) fn check_optics(&self, reader: &mut Reader<'_>) -> bool {
        let lit = self.extensions().into_iter().find(|(key, ..)| *key != "unlit");
        let glows = self.emissive.is_some() || self.emissive_texture.is_some();
        let report = match (lit, &self.volume, &self.dispersion, &self.emissive_strength) {
            (Some((key, _, span)), ..) if self.unlit.value => {
                let message = format!("an unlit surface shows its color alone, without `{key}`");
                Diagnostic::error(Code::Conflict, message)
                    .at(span, "cannot stand here")
                    .also(self.unlit.span, "no light falls on it")
            }
            (_, Some(volume), ..) if self.transmission.is_none() => Diagnostic::error(
                Code::Conflict,
                "`volume` needs `transmission`: no light comes into the body",
            )
            .at(volume.span, "has no effect")
            .help("write `transmission = {}` beside it"),
            (_, Some(volume), ..) if self.double_sided.value => {
                Diagnostic::error(Code::Conflict, "a body has one outer side, and no `double-sided` surface")
                    .at(self.double_sided.span, "cannot stand beside `volume`")
                    .also(volume.span, "the body")
                    .help("leave `volume` out for something thin, or `double-sided` for a body")
            }
            (_, None, Some(dispersion), _) => {
                Diagnostic::error(Code::Conflict, "`dispersion` needs `volume`: only a body spreads colors")
                    .at(dispersion.span, "has no effect")
                    .help("write `volume` with a `thickness` beside it")
            }
            (.., Some(strength)) if !glows => Diagnostic::error(
                Code::Conflict,
                "`emissive-strength` needs `emissive` or `emissive-texture`",
            )
            .at(strength.span, "has no effect")
            .help("write `emissive = \"#ffffff\"` beside it"),
            _ => return true,
        };
        reader.report(report);
        false
    }
}

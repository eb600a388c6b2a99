//! Materials: metallic-roughness, as glTF has it.

use serde_json::{Value as Json, json};

use crate::geometry::number::srgb_to_linear;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::import::FilePath;
use crate::language::spec::optics::{
    Anisotropy, Clearcoat, IOR, Iridescence, Sheen, Specular, Transmission, Volume,
};
use crate::language::spec::point::read_numbers;
use crate::language::spec::reader::{Read, Reader, backtick};
use crate::language::spec::schema::{Schemas, any_of, numbers};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value, show_number};

table! {
    /// How a surface looks.
    "material" pub Material {
        /// Its color: `"#rrggbb"` or `"#rrggbbaa"` as on screen (sRGB), or linear `[r, g, b]` or `[r, g, b, a]`.
        color: Sp<Color> = Color::WHITE;
        /// 0 is a plastic, a stone, a wood; 1 a metal.
        metallic: Sp<f64> = 0.0 => Check::within(0.0, 1.0);
        /// 0 is a mirror, 1 a chalk.
        roughness: Sp<f64> = 1.0 => Check::within(0.0, 1.0);
        /// An image that multiplies the color.
        color_texture: Option<Sp<Texture>>;
        /// An image whose green multiplies roughness and whose blue multiplies metallic.
        metallic_roughness_texture: Option<Sp<Texture>>;
        /// An image whose red multiplies roughness. It is packed into one picture with `metallic-texture` and
        /// `occlusion-texture`, as the format has it; in place of `metallic-roughness-texture`.
        roughness_texture: Option<Sp<Texture>>;
        /// An image whose red multiplies metallic, packed likewise.
        metallic_texture: Option<Sp<Texture>>;
        /// An image of small bumps, as normals in tangent space.
        normal_texture: Option<Sp<Texture>>;
        /// Strength of the normal texture.
        normal_scale: Sp<f64> = 1.0;
        /// An image whose red darkens what light hardly reaches.
        occlusion_texture: Option<Sp<Texture>>;
        /// Strength of the occlusion texture.
        occlusion_strength: Sp<f64> = 1.0 => Check::within(0.0, 1.0);
        /// Light that the surface gives off, as a color.
        emissive: Option<Sp<Color>>;
        /// An image that multiplies `emissive`.
        emissive_texture: Option<Sp<Texture>>;
        /// How many times as bright as its colors the light is that the surface gives off.
        emissive_strength: Option<Sp<f64>> => Check::at_least(0.0).up_to(1e6);
        /// What the color's fourth number does.
        alpha: Sp<Alpha> = Alpha::Opaque;
        /// With `alpha = "mask"`: what is more transparent than this is left out.
        alpha_cutoff: Option<Sp<f64>> => Check::within(0.0, 1.0);
        /// Whether the back of the surface is seen too.
        double_sided: Sp<bool> = false;
        /// Whether it shows its color as it is, whatever light falls on it.
        unlit: Sp<bool> = false;
        /// Index of refraction, of which follows how much it reflects: 1.33 is water, 2.42 diamond; 1.5 when it is not written.
        ior: Option<Sp<f64>> => IOR;
        /// How much more its `volume` bends blue than red: 20 over the Abbe number, so 0.31 is crown glass, 0.36 diamond.
        dispersion: Option<Sp<f64>> => Check::within(0.0, 1000.0);
        /// A clear coat over it.
        clearcoat: Option<Sp<Clearcoat>>;
        /// Light goes through it.
        transmission: Option<Sp<Transmission>>;
        /// The body below it.
        volume: Option<Sp<Volume>>;
        /// What it reflects where it is no metal.
        specular: Option<Sp<Specular>>;
        /// Fibers that stand up from it.
        sheen: Option<Sp<Sheen>>;
        /// A thin film on it.
        iridescence: Option<Sp<Iridescence>>;
        /// Shine that is drawn out along one direction.
        anisotropy: Option<Sp<Anisotropy>>;
    }
    checked check
}

choices! {
    /// What the alpha of a color does.
    Alpha {
        /// Nothing.
        Opaque = "opaque";
        /// It decides between all and nothing at `alpha-cutoff`.
        Mask = "mask";
        /// It blends with what lies behind.
        Blend = "blend";
    }
}

/// An image on a surface: a path, or a table with `file` in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image, PNG or JPEG.
    pub file: Sp<FilePath>,
    /// What lies beyond its borders.
    pub wrap: Sp<Wrap>,
    /// How it looks when enlarged.
    pub filter: Sp<Filter>,
}

table! {
    /// An image on a surface.
    "texture" pub(crate) TextureFields {
        /// The image, PNG or JPEG; the path is relative to this document.
        file: Sp<FilePath>;
        /// What lies beyond its borders.
        wrap: Sp<Wrap> = Wrap::Repeat;
        /// How it looks when enlarged.
        filter: Sp<Filter> = Filter::Linear;
    }
}

choices! {
    /// What lies beyond the borders of an image.
    Wrap {
        /// The image again.
        Repeat = "repeat";
        /// Its border, drawn out.
        Clamp = "clamp";
        /// The image, mirrored.
        Mirror = "mirror";
    }
}

choices! {
    /// How an image looks when enlarged.
    Filter {
        /// Smooth.
        Linear = "linear";
        /// In squares.
        Nearest = "nearest";
    }
}

/// A color: linear red, green, blue and alpha, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    /// Red, green, blue, alpha.
    pub linear: [f64; 4],
}

impl Color {
    /// White, opaque.
    pub const WHITE: Self = Self { linear: [1.0; 4] };
}

impl Material {
    fn check(&self, span: crate::language::source::Span, reader: &mut Reader<'_>) -> bool {
        self.check_alpha(span, reader) && self.check_packed(reader) && self.check_optics(reader)
    }

    /// Pictures that are packed into one, which may stand apart.
    #[must_use]
    pub fn packed(&self) -> [Option<&Sp<Texture>>; 2] {
        [self.roughness_texture.as_ref(), self.metallic_texture.as_ref()]
    }

    fn check_packed(&self, reader: &mut Reader<'_>) -> bool {
        let apart: Vec<&Sp<Texture>> = self.packed().into_iter().flatten().collect();
        let report = match (apart.as_slice(), &self.metallic_roughness_texture) {
            ([one, ..], Some(both)) => Diagnostic::error(
                Code::Conflict,
                "roughness and metallic stand in one picture, or in one each, not both",
            )
            .at(one.span, "cannot stand beside `metallic-roughness-texture`")
            .also(both.span, "one picture of both"),
            ([one, other], None)
                if (one.value.wrap, one.value.filter) != (other.value.wrap, other.value.filter) =>
            {
                Diagnostic::error(Code::Conflict, "pictures that are packed into one are read in one way")
                    .at(other.span, "other `wrap` or `filter`")
                    .also(one.span, "than here")
            }
            _ => return true,
        };
        reader.report(report);
        false
    }

    fn check_alpha(&self, _: crate::language::source::Span, reader: &mut Reader<'_>) -> bool {
        let Some(cutoff) = self.alpha_cutoff.filter(|_| self.alpha.value != Alpha::Mask) else { return true };
        let report = Diagnostic::error(Code::Conflict, "`alpha-cutoff` needs `alpha = \"mask\"`")
            .at(cutoff.span, format!("has no effect with \"{}\"", self.alpha.text()))
            .also(self.alpha.span, "the alpha mode");
        reader.report(report);
        false
    }
}

impl Read for Texture {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(_) => {
                let file = Sp::<FilePath>::read(value, reader)?;
                Some(Self { file, wrap: Wrap::Repeat.into(), filter: Filter::Linear.into() })
            }
            Data::Table(_) => {
                let TextureFields { file, wrap, filter } = TextureFields::read(value, reader)?;
                Some(Self { file, wrap, filter })
            }
            _ => {
                reader.mismatch(value, "the path of an image, or a table with `file`");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        any_of(vec![json!({ "type": "string" }), TextureFields::schema(schemas)])
    }
}

impl Read for Color {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        if let Data::String(text) = &value.data {
            let read = parse_hex(text);
            if read.is_none() {
                let message = format!("{} is no color: {}", reader.place(), backtick(text));
                let report = Diagnostic::error(Code::Malformed, message)
                    .at(value.span, "expected \"#rrggbb\" or \"#rrggbbaa\"");
                reader.report(hint_hex(report, text, value.span));
            }
            return read;
        }
        let expected = "a color \"#rrggbb\", [r, g, b] or [r, g, b, a]";
        let parts = read_numbers(value, 3, 4, expected, reader)?;
        if let Some(index) = parts.iter().position(|part| !(0.0..=1.0).contains(part)) {
            let found = show_number(parts[index]);
            let message = format!("{} has parts from 0 to 1, found {found}", reader.place());
            reader
                .report(Diagnostic::error(Code::OutOfRange, message).at(value.span, "linear, not 0 to 255"));
            return None;
        }
        Some(Self { linear: [parts[0], parts[1], parts[2], *parts.get(3).unwrap_or(&1.0)] })
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut schema = numbers(3, 4);
        schema["pattern"] = json!("^(#([0-9a-fA-F]{6}|[0-9a-fA-F]{8})$|= )");
        schema
    }

    fn written(&self) -> Option<Json> {
        (*self == Self::WHITE).then(|| json!("#ffffff"))
    }
}

fn parse_hex(text: &str) -> Option<Color> {
    let digits = text.strip_prefix('#')?;
    if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let part = |index: usize| digits.get(2 * index..2 * index + 2).map(|pair| u8::from_str_radix(pair, 16));
    let byte = |index| part(index).and_then(Result::ok).map(|byte| f64::from(byte) / 255.0);
    let alpha = byte(3).unwrap_or(1.0);
    Some(Color {
        linear: [srgb_to_linear(byte(0)?), srgb_to_linear(byte(1)?), srgb_to_linear(byte(2)?), alpha],
    })
}

fn hint_hex(report: Diagnostic, text: &str, span: crate::language::source::Span) -> Diagnostic {
    let digits = text.strip_prefix('#').unwrap_or(text);
    if !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return report;
    }
    let full = match digits.len() {
        3 => digits.chars().flat_map(|digit| [digit, digit]).collect(),
        6 | 8 => digits.to_owned(),
        _ => return report,
    };
    report.suggest(span, format!("\"#{full}\""), format!("write \"#{full}\""))
}

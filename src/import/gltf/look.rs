//! How the materials of a file look, and where on their pictures vertices lie.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021, sections 3.8 and 3.9; `KHR_texture_transform`.

use glam::DVec2;
use gltf::image::Source;
use gltf::material::AlphaMode;
use gltf::texture::{MagFilter, WrappingMode};
use serde_json::Value;

use super::{Data, base64, unescaped};
use crate::geometry::number::sin_cos;
use crate::import::image::Edge;
use crate::import::look::{MaterialLook, Picture, PictureSource, Pictures};

/// Extensions of materials that are read.
const KNOWN: [&str; 2] = ["KHR_materials_unlit", "KHR_materials_emissive_strength"];

/// Which texture coordinates the pictures of a material are laid by, and how these are changed before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mapping {
    /// Which coordinates.
    pub(super) set: usize,
    offset: DVec2,
    /// Radians, against the clock.
    rotation: f64,
    scale: DVec2,
}

impl Mapping {
    const PLAIN: Self = Self { set: 0, offset: DVec2::ZERO, rotation: 0.0, scale: DVec2::ONE };

    fn new(set: u32, transform: Option<&Value>) -> Self {
        let Some(own) = transform else { return Self { set: set as usize, ..Self::PLAIN } };
        let pair = |key: &str, none: DVec2| {
            let own = own.get(key).and_then(Value::as_array);
            let part = |k: usize| own.and_then(|own| own.get(k)?.as_f64());
            part(0).zip(part(1)).map_or(none, |(x, y)| DVec2::new(x, y))
        };
        let set = own.get("texCoord").and_then(Value::as_u64).unwrap_or(set.into());
        Self {
            set: usize::try_from(set).unwrap_or(usize::MAX),
            offset: pair("offset", DVec2::ZERO),
            rotation: own.get("rotation").and_then(Value::as_f64).unwrap_or(0.0),
            scale: pair("scale", DVec2::ONE),
        }
    }

    /// Whether a mesh has the coordinates: two sets are read.
    fn is_read(&self) -> bool {
        self.set < 2
    }

    /// Where texture coordinates lie on the picture.
    pub(super) fn at(&self, place: DVec2) -> DVec2 {
        if self.rotation == 0.0 {
            return self.offset + self.scale * place;
        }
        let (sin, cos) = sin_cos(self.rotation);
        let DVec2 { x, y } = self.scale * place;
        self.offset + DVec2::new(cos * x + sin * y, cos * y - sin * x)
    }
}

/// For each material how it looks, and how its pictures are laid.
pub(super) fn read(data: &Data<'_>, notes: &mut Vec<String>) -> (Vec<MaterialLook>, Vec<Mapping>) {
    data.document.materials().map(|own| look(data, &own, notes)).unzip()
}

/// The name of a material, or its number.
pub(super) fn name_of(own: &gltf::Material<'_>) -> String {
    match own.name().filter(|name| !name.is_empty()) {
        Some(name) => name.to_owned(),
        None => format!("material-{}", own.index().map_or(0, |index| index + 1)),
    }
}

fn look(data: &Data<'_>, own: &gltf::Material<'_>, notes: &mut Vec<String>) -> (MaterialLook, Mapping) {
    let metal = own.pbr_metallic_roughness();
    let share = |value: f32| f64::from(value).clamp(0.0, 1.0);
    let [red, green, blue, opacity] = metal.base_color_factor().map(share);
    let (pictures, mapping) = pictures(data, own, notes);
    let name = name_of(own);
    for unknown in own.extensions().into_iter().flat_map(|own| own.keys()) {
        if unknown.starts_with("KHR_materials_") && !KNOWN.contains(&unknown.as_str()) {
            notes.push(format!("material `{name}` has {unknown}, which is left out"));
        }
    }
    let strength = own.extension_value("KHR_materials_emissive_strength");
    let look = MaterialLook {
        name,
        color: Some([red, green, blue]),
        opacity: Some(if own.alpha_mode() == AlphaMode::Opaque { 1.0 } else { opacity }),
        blends: own.alpha_mode() == AlphaMode::Blend,
        cutoff: (own.alpha_mode() == AlphaMode::Mask).then(|| own.alpha_cutoff().map_or(0.5, share)),
        metallic: Some(share(metal.metallic_factor())),
        roughness: Some(share(metal.roughness_factor())),
        emissive: Some(own.emissive_factor().map(share)),
        emissive_strength: strength.and_then(|own| own.get("emissiveStrength")?.as_f64()),
        double_sided: own.double_sided(),
        unlit: own.extension_value("KHR_materials_unlit").is_some(),
        pictures,
    };
    (look, mapping)
}

/// The pictures of a material that are laid as its first one is; the others are left out with a note.
fn pictures(data: &Data<'_>, own: &gltf::Material<'_>, notes: &mut Vec<String>) -> (Pictures, Mapping) {
    const TRANSFORM: &str = "KHR_texture_transform";
    let metal = own.pbr_metallic_roughness();
    let plain = |field: &'static str, info: Option<gltf::texture::Info<'_>>| {
        let info = info?;
        let mapping = Mapping::new(info.tex_coord(), info.extension_value(TRANSFORM));
        Some((field, mapping, picture(data, &info.texture())))
    };
    let normal = own.normal_texture();
    let occlusion = own.occlusion_texture();
    let strengths =
        (normal.as_ref().map(|own| own.scale().into()), occlusion.as_ref().map(|own| own.strength().into()));
    let normal = normal.map(|info| {
        let mapping = Mapping::new(info.tex_coord(), info.extension_value(TRANSFORM));
        ("normal", mapping, picture(data, &info.texture()))
    });
    let occlusion = occlusion.map(|info| {
        let mapping = Mapping::new(info.tex_coord(), info.extension_value(TRANSFORM));
        ("occlusion", mapping, picture(data, &info.texture()))
    });
    let all = [
        plain("color", metal.base_color_texture()),
        plain("metallic-roughness", metal.metallic_roughness_texture()),
        normal,
        occlusion,
        plain("emissive", own.emissive_texture()),
    ];
    let first = all.iter().flatten().map(|(_, mapping, _)| *mapping).find(Mapping::is_read);
    let mapping = first.unwrap_or(Mapping::PLAIN);
    let mut keep = |slot: Option<(&'static str, Mapping, Result<Picture, String>)>| {
        let (field, own_mapping, picture) = slot?;
        let mut left_out = |reason: &str| {
            notes.push(format!("the {field} picture of material `{}` is left out: {reason}", name_of(own)));
            None
        };
        if !own_mapping.is_read() {
            return left_out("it is laid by texture coordinates beyond the first two");
        }
        if own_mapping != mapping {
            return left_out("it is laid in another way than the first one");
        }
        match picture {
            Ok(picture) => Some(picture),
            Err(reason) => left_out(&reason),
        }
    };
    let [color, metallic_roughness, normal, occlusion, emissive] = all.map(&mut keep);
    let pictures = Pictures {
        color,
        metallic_roughness,
        normal: normal.zip(strengths.0),
        occlusion: occlusion.zip(strengths.1),
        emissive,
    };
    (pictures, mapping)
}

/// A picture, or why it is not read.
fn picture(data: &Data<'_>, own: &gltf::Texture<'_>) -> Result<Picture, String> {
    let image = own.source();
    let inside = |bytes: Vec<u8>| PictureSource::Inside {
        number: image.index(),
        name: image.name().unwrap_or_default().to_owned(),
        bytes: bytes.into(),
    };
    let source = match image.source() {
        Source::View { view, .. } => inside(data.view(&view).map_err(|fault| fault.to_string())?.to_vec()),
        Source::Uri { uri, .. } => match uri.strip_prefix("data:") {
            Some(rest) => {
                let text = rest.split_once(";base64,").map(|(_, text)| text);
                let bytes = text.and_then(|text| base64(text.as_bytes()));
                inside(bytes.ok_or("it is not written in base64")?)
            }
            None => PictureSource::File(unescaped(uri)),
        },
    };
    let sampler = own.sampler();
    if sampler.wrap_s() != sampler.wrap_t() {
        return Err("it goes on in another way beside its borders than above and below them".to_owned());
    }
    let edge = match sampler.wrap_s() {
        WrappingMode::Repeat => Edge::Repeat,
        WrappingMode::ClampToEdge => Edge::Clamp,
        WrappingMode::MirroredRepeat => Edge::Mirror,
    };
    Ok(Picture { source, edge, nearest: sampler.mag_filter() == Some(MagFilter::Nearest) })
}

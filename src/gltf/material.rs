//! Materials, textures, samplers and images.

use std::fmt::Write as _;

use gltf::json::image::{Image, MimeType};
use gltf::json::material::{
    AlphaCutoff, AlphaMode as JsonAlphaMode, EmissiveFactor, Material as JsonMaterial, NormalTexture,
    OcclusionTexture, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor,
};
use gltf::json::texture::{Info, MagFilter, MinFilter, Sampler, Texture as JsonTexture, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

use super::buffer::{Binary, Content};
use super::optics;
use crate::geometry::mesh;
use crate::geometry::number::single;
use crate::scene::{AlphaMode, Filter, ImageHandle, ImageKind, Material, Scene, Texture, Wrap};

/// The beginning of the names of files of pictures, and those files.
pub(super) type Beside<'a> = (&'a str, &'a mut Vec<(String, Vec<u8>)>);

/// Writes the images, equal ones once, into the file or beside it; for each of the scene its index in the file.
pub(super) fn images(
    root: &mut Root,
    binary: &mut Binary,
    scene: &Scene,
    mut beside: Option<Beside<'_>>,
) -> Vec<u32> {
    let mut places: Vec<u32> = Vec::with_capacity(scene.images.len());
    for (number, image) in scene.images.iter().enumerate() {
        let before = &scene.images[..number];
        if let Some(known) = before.iter().position(|one| one.kind == image.kind && one.bytes == image.bytes)
        {
            places.push(places[known]);
            continue;
        }
        places.push(mesh::index(root.images.len()));
        let (mime, end) = match image.kind {
            ImageKind::Png => ("image/png", "png"),
            ImageKind::Jpeg => ("image/jpeg", "jpg"),
        };
        let (view, uri) = match &mut beside {
            Some((stem, files)) => {
                let name = file_name((stem, &image.name, end), files);
                let uri = address(&name);
                files.push((name, image.bytes.to_vec()));
                (None, Some(uri))
            }
            None => {
                let start = binary.start();
                binary.bytes.extend_from_slice(&image.bytes);
                (Some(binary.view(root, start, None, Content::Picture)), None)
            }
        };
        root.push(Image {
            buffer_view: view,
            mime_type: Some(MimeType(mime.to_owned())),
            name: Some(image.name.clone()),
            uri,
            extensions: None,
            extras: None,
        });
    }
    places
}

/// A name that no picture before has, as file systems tell names that leave case alone.
fn file_name((stem, image, end): (&str, &str, &str), before: &[(String, Vec<u8>)]) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '-' || letter == '_';
    let image: String = image.chars().map(|letter| if plain(letter) { letter } else { '-' }).collect();
    let free = |name: &String| before.iter().all(|(other, _)| !other.eq_ignore_ascii_case(name));
    let numbered = (2_u64..).map(|number| format!("{stem}.{image}-{number}.{end}"));
    let names = std::iter::once(format!("{stem}.{image}.{end}")).chain(numbered);
    names.into_iter().find(free).expect("there are more numbers than pictures")
}

/// A name of a file as a relative reference (RFC 3986, section 2.3).
fn address(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            text.push(byte.into());
        } else {
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}

/// Writes the materials; index k of the scene is index k of the file.
pub(super) fn materials(root: &mut Root, scene: &Scene, images: &[u32]) {
    let mut textures = Textures { images, seen: Vec::new(), samplers: Vec::new() };
    for (index, material) in scene.materials.iter().enumerate() {
        let written = textures.material(root, material);
        let extensions = optics::extensions(&mut textures, root, (scene, index));
        root.push(JsonMaterial { extensions, ..written });
    }
    optics::name_used(root);
}

/// Textures and samplers written so far: equal ones are written once.
pub(super) struct Textures<'a> {
    /// For each image of the scene that of the file.
    images: &'a [u32],
    seen: Vec<Texture>,
    samplers: Vec<(Wrap, Filter)>,
}

impl Textures<'_> {
    fn material(&mut self, root: &mut Root, material: &Material) -> JsonMaterial {
        let strength = |value: f64| StrengthFactor(single(value));
        JsonMaterial {
            alpha_cutoff: match material.alpha {
                AlphaMode::Mask { cutoff } => Some(AlphaCutoff(single(cutoff))),
                _ => None,
            },
            alpha_mode: Checked::Valid(match material.alpha {
                AlphaMode::Opaque => JsonAlphaMode::Opaque,
                AlphaMode::Mask { .. } => JsonAlphaMode::Mask,
                AlphaMode::Blend => JsonAlphaMode::Blend,
            }),
            double_sided: material.double_sided,
            name: Some(material.name.clone()),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor(material.color.map(single)),
                base_color_texture: self.info(root, material.color_texture),
                metallic_factor: strength(material.metallic),
                roughness_factor: strength(material.roughness),
                metallic_roughness_texture: self.info(root, material.metallic_roughness_texture),
                extensions: None,
                extras: None,
            },
            normal_texture: material.normal_texture.map(|(texture, scale)| NormalTexture {
                index: self.texture(root, texture),
                scale: single(scale),
                tex_coord: 0,
                extensions: None,
                extras: None,
            }),
            occlusion_texture: material.occlusion_texture.map(|(texture, value)| OcclusionTexture {
                index: self.texture(root, texture),
                strength: strength(value),
                tex_coord: 0,
                extensions: None,
                extras: None,
            }),
            emissive_texture: self.info(root, material.emissive_texture),
            emissive_factor: EmissiveFactor(material.emissive.map(single)),
            extensions: None,
            extras: None,
        }
    }

    fn info(&mut self, root: &mut Root, texture: Option<Texture>) -> Option<Info> {
        texture.map(|texture| Info {
            index: self.texture(root, texture),
            tex_coord: 0,
            extensions: None,
            extras: None,
        })
    }

    pub(super) fn texture(&mut self, root: &mut Root, texture: Texture) -> Index<JsonTexture> {
        let texture = Texture { image: ImageHandle(self.images[texture.image.0 as usize]), ..texture };
        if let Some(known) = self.seen.iter().position(|seen| *seen == texture) {
            return Index::new(mesh::index(known));
        }
        let sampler = self.sampler(root, texture.wrap, texture.filter);
        self.seen.push(texture);
        root.push(JsonTexture {
            name: None,
            sampler: Some(sampler),
            source: Index::new(texture.image.0),
            extensions: None,
            extras: None,
        })
    }

    fn sampler(&mut self, root: &mut Root, wrap: Wrap, filter: Filter) -> Index<Sampler> {
        if let Some(known) = self.samplers.iter().position(|seen| *seen == (wrap, filter)) {
            return Index::new(mesh::index(known));
        }
        self.samplers.push((wrap, filter));
        let mode = Checked::Valid(match wrap {
            Wrap::Repeat => WrappingMode::Repeat,
            Wrap::Clamp => WrappingMode::ClampToEdge,
            Wrap::Mirror => WrappingMode::MirroredRepeat,
        });
        let (mag, min) = match filter {
            Filter::Linear => (MagFilter::Linear, MinFilter::LinearMipmapLinear),
            Filter::Nearest => (MagFilter::Nearest, MinFilter::NearestMipmapLinear),
        };
        root.push(Sampler {
            mag_filter: Some(Checked::Valid(mag)),
            min_filter: Some(Checked::Valid(min)),
            name: None,
            wrap_s: mode,
            wrap_t: mode,
            extensions: None,
            extras: None,
        })
    }
}

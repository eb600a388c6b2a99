//! Materials and the images they show.

use super::Builder;
use crate::geometry::mesh;
use crate::import::image::{self, Pixels};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{self, Alpha, Sp};
use crate::model::{
    AlphaMode, Filter, Image, ImageHandle, ImageKind, Material, MaterialHandle, Texture, Wrap,
};

impl Builder<'_> {
    /// The material of a name, built at its first use.
    pub(super) fn material(&mut self, name: &str) -> Option<MaterialHandle> {
        if let Some(known) = self.materials.get(name) {
            return *known;
        }
        let spec = self.spec;
        let definition = spec.materials.get(name)?;
        let built = self.build_material(name, &definition.value);
        let handle = built.map(|material| {
            self.model.materials.push(material);
            MaterialHandle(mesh::index(self.model.materials.len()) - 1)
        });
        self.materials.insert(name.to_owned(), handle);
        handle
    }

    fn build_material(&mut self, name: &str, written: &spec::Material) -> Option<Material> {
        // All textures are looked at before the first fault ends it.
        let color = self.texture(written.color_texture.as_ref());
        let packed = self.packed_texture(name, written);
        let metallic_roughness = match packed {
            Some(None) => self.texture(written.metallic_roughness_texture.as_ref()),
            packed => packed,
        };
        let normal = self.texture(written.normal_texture.as_ref());
        let occlusion = match (packed, &written.occlusion_texture) {
            (Some(Some(packed)), Some(own)) if texture_way(&own.value) == (packed.wrap, packed.filter) => {
                Some(Some(packed))
            }
            _ => self.texture(written.occlusion_texture.as_ref()),
        };
        let emissive = self.texture(written.emissive_texture.as_ref());
        let optics = self.optics(written);
        let emitted = written.emissive.map(|color| color.value.linear);
        let without = if written.emissive_texture.is_some() { [1.0; 4] } else { [0.0; 4] };
        let [red, green, blue, _] = emitted.unwrap_or(without);
        Some(Material {
            name: name.to_owned(),
            color: written.color.value.linear,
            metallic: written.metallic.value,
            roughness: written.roughness.value,
            color_texture: color?,
            metallic_roughness_texture: metallic_roughness?,
            normal_texture: normal?.map(|texture| (texture, written.normal_scale.value)),
            occlusion_texture: occlusion?.map(|texture| (texture, written.occlusion_strength.value)),
            emissive: [red, green, blue],
            emissive_texture: emissive?,
            alpha: match written.alpha.value {
                Alpha::Opaque => AlphaMode::Opaque,
                Alpha::Mask => {
                    AlphaMode::Mask { cutoff: written.alpha_cutoff.map_or(0.5, |cutoff| cutoff.value) }
                }
                Alpha::Blend => AlphaMode::Blend,
            },
            double_sided: written.double_sided.value,
            optics: optics?,
        })
    }

    /// A texture where one is written; the outer `None` says that it failed.
    #[expect(clippy::option_option, reason = "absent and failed are different answers")]
    pub(super) fn texture(&mut self, written: Option<&Sp<spec::Texture>>) -> Option<Option<Texture>> {
        let Some(written) = written else { return Some(None) };
        let image = self.image(&written.value)?;
        let (wrap, filter) = texture_way(&written.value);
        Some(Some(Texture { image, wrap, filter }))
    }

    fn image(&mut self, texture: &spec::Texture) -> Option<ImageHandle> {
        let path = texture.file.value.resolved.clone();
        if let Some(known) = self.images.get(&path) {
            return *known;
        }
        let image = self.load_image(texture);
        let handle = image.map(|image| {
            self.model.images.push(image);
            ImageHandle(mesh::index(self.model.images.len()) - 1)
        });
        self.images.insert(path, handle);
        handle
    }

    fn load_image(&mut self, texture: &spec::Texture) -> Option<Image> {
        let file = &texture.file;
        let bytes = match self.files.read(&file.value.resolved) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.file_fault(&error, file);
                return None;
            }
        };
        let facts = match image::read(&bytes, self.spec.limits.pixels()) {
            Ok(facts) => facts,
            Err(error) => {
                let message = format!("{} cannot be used as a texture: {error}", file.value.written);
                let report = Diagnostic::error(Code::BadImage, message).at(file.span, "this image");
                self.report(match error.hint() {
                    Some(hint) => report.help(hint),
                    None => report,
                });
                return None;
            }
        };
        let stem = std::path::Path::new(&file.value.resolved).file_stem();
        Some(Image {
            name: stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            kind: match facts.kind {
                image::Kind::Png => ImageKind::Png,
                image::Kind::Jpeg => ImageKind::Jpeg,
            },
            bytes,
        })
    }

    /// Occlusion, roughness and metallic, each the red of a picture, as red, green and blue of one; the inner `None` where a
    /// material has them not apart.
    #[expect(clippy::option_option, reason = "absent and failed are different answers")]
    fn packed_texture(&mut self, name: &str, written: &spec::Material) -> Option<Option<Texture>> {
        let [roughness, metallic] = written.packed();
        let Some(first) = roughness.or(metallic) else { return Some(None) };
        let (wrap, filter) = texture_way(&first.value);
        let occlusion =
            written.occlusion_texture.as_ref().filter(|own| texture_way(&own.value) == (wrap, filter));
        let mut channels: [Option<Pixels>; 3] = [None, None, None];
        for (channel, own) in channels.iter_mut().zip([occlusion, roughness, metallic]) {
            let Some(own) = own else { continue };
            let loaded = self.load_image(&own.value)?;
            match image::pixels(&loaded.bytes, self.spec.limits.pixels()) {
                Ok(pixels) => *channel = Some(pixels),
                Err(error) => {
                    let message = format!("{} cannot be packed: {error}", own.value.file.value.written);
                    self.report(Diagnostic::error(Code::BadImage, message).at(own.span, "this image"));
                    return None;
                }
            }
        }
        let edge = match wrap {
            Wrap::Repeat => image::Edge::Repeat,
            Wrap::Clamp => image::Edge::Clamp,
            Wrap::Mirror => image::Edge::Mirror,
        };
        let bytes = image::png(&image::packed(channels, [edge; 2]), false).into();
        let image = Image { name: format!("{name}-orm"), kind: ImageKind::Png, bytes };
        self.model.images.push(image);
        let image = ImageHandle(mesh::index(self.model.images.len()) - 1);
        Some(Some(Texture { image, wrap, filter }))
    }
}

/// How a texture is read.
fn texture_way(written: &spec::Texture) -> (Wrap, Filter) {
    let wrap = match written.wrap.value {
        spec::Wrap::Repeat => Wrap::Repeat,
        spec::Wrap::Clamp => Wrap::Clamp,
        spec::Wrap::Mirror => Wrap::Mirror,
    };
    let filter = match written.filter.value {
        spec::Filter::Linear => Filter::Linear,
        spec::Filter::Nearest => Filter::Nearest,
    };
    (wrap, filter)
}

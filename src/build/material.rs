//! Materials and the images they show.

use super::Builder;
use crate::geometry::mesh;
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
        let metallic_roughness = self.texture(written.metallic_roughness_texture.as_ref());
        let normal = self.texture(written.normal_texture.as_ref());
        let occlusion = self.texture(written.occlusion_texture.as_ref());
        let emissive = self.texture(written.emissive_texture.as_ref());
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
        })
    }

    /// A texture where one is written; the outer `None` says that it failed.
    #[expect(clippy::option_option, reason = "absent and failed are different answers")]
    fn texture(&mut self, written: Option<&Sp<spec::Texture>>) -> Option<Option<Texture>> {
        let Some(written) = written else { return Some(None) };
        let image = self.image(&written.value)?;
        let wrap = match written.wrap.value {
            spec::Wrap::Repeat => Wrap::Repeat,
            spec::Wrap::Clamp => Wrap::Clamp,
            spec::Wrap::Mirror => Wrap::Mirror,
        };
        let filter = match written.filter.value {
            spec::Filter::Linear => Filter::Linear,
            spec::Filter::Nearest => Filter::Nearest,
        };
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
        let facts = match crate::import::image::read(&bytes, self.spec.limits.image_pixels) {
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
                crate::import::image::Kind::Png => ImageKind::Png,
                crate::import::image::Kind::Jpeg => ImageKind::Jpeg,
            },
            bytes,
        })
    }
}

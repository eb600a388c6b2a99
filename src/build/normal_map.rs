//! Normal maps that are drawn from the heights of shapes.

use std::sync::Arc;

use glam::DVec2;

use super::Builder;
use crate::geometry::mesh;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{Shape as Kind, ShapeDefinition};
use crate::model::{
    AlphaMode, Filter, Image, ImageHandle, ImageKind, Material, MaterialHandle, NormalMap, Optics,
    ShapeHandle, ShapeOptions, Texture, UvMapping, UvMode, Wrap,
};

impl Builder<'_> {
    /// Notes the normal map that a shape asks for, with a material and an empty image for it; none when it cannot be.
    pub(super) fn normal_map(
        &mut self,
        name: &str,
        shape: ShapeHandle,
        definition: &ShapeDefinition,
        options: &ShapeOptions,
    ) -> Option<()> {
        let size = match &definition.kind {
            Kind::HeightMap(map) => map.bake_normal_map,
            Kind::Displace(displace) => displace.bake_normal_map,
            _ => None,
        };
        let Some(size) = size else { return Some(()) };
        let mut refuse = |message: &str, help: &str| {
            self.reports
                .push(Diagnostic::error(Code::Conflict, message).at(size.span, "no place for it").help(help));
        };
        if options.uv == UvMode::None {
            refuse("a normal map needs texture coordinates, and `uv` is \"none\"", "leave `uv` out");
            return None;
        }
        if options.uv_scale != DVec2::ONE {
            refuse(
                "a normal map covers the shape once, and `uv-scale` repeats textures",
                "leave `uv-scale` out",
            );
            return None;
        }
        if options.uv_mapping != UvMapping::Surface {
            refuse(
                "a normal map lies along the surface, and `uv-mapping` lays textures another way",
                "leave `uv-mapping` out",
            );
            return None;
        }
        let own = options.material.map(|handle| self.model.material(handle).clone());
        if own.as_ref().is_some_and(|own| own.normal_texture.is_some()) {
            refuse(
                "the material of this shape has a normal texture already",
                "give the shape a material of its own, or leave `bake-normal-map` out",
            );
            return None;
        }
        let pixels = u64::from(size.u) * u64::from(size.v);
        if pixels > self.spec.limits.pixels() {
            let message = format!(
                "this normal map has {} x {} pixels, and the limit is {}",
                size.u,
                size.v,
                self.spec.limits.pixels()
            );
            self.reports.push(Diagnostic::error(Code::LimitPassed, message).at(size.span, "too large"));
            return None;
        }
        let picture = format!("{name}-normal");
        let image = ImageHandle(mesh::index(self.model.images.len()));
        self.model.images.push(Image { name: picture.clone(), kind: ImageKind::Png, bytes: Arc::from([]) });
        let texture = Texture { image, wrap: Wrap::Repeat, filter: Filter::Linear };
        let plain = Material {
            name: name.to_owned(),
            color: [1.0; 4],
            metallic: 0.0,
            roughness: 1.0,
            color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            emissive: [0.0; 3],
            emissive_texture: None,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            optics: Optics::default(),
        };
        let mut material = own.unwrap_or(plain);
        material.name = format!("{}-{name}", material.name);
        material.normal_texture = Some((texture, 1.0));
        self.model.materials.push(material);
        let material = MaterialHandle(mesh::index(self.model.materials.len()) - 1);
        self.model.normal_maps.push(NormalMap { shape, material, name: picture, size: [size.u, size.v] });
        Some(())
    }
}

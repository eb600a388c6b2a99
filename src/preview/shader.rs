//! What color a face has at a place of the picture.

use glam::{DMat3, DVec2, DVec3, Vec3, Vec4};

use super::asset::{Asset, Cutoff, Map, Material};
use super::camera::Camera;
use super::color;
use super::exact::Exact;
use super::light::{Light, Surface, lights};
use super::shadow::Shadow;
use super::stage::{Stage, Vertex};
use super::{Look, Shading};
use crate::geometry::number::{count_of, ln, single};

/// Colors of the faces of one picture; names past those of the triangles are lines.
pub(super) struct Shader<'a> {
    asset: &'a Asset,
    stage: &'a Stage,
    exact: &'a Exact<'a>,
    camera: &'a Camera,
    shading: Shading,
    lights: [Light; 3],
    shadow: Option<Shadow>,
    /// For each triangle its material.
    materials: Vec<u32>,
    /// Light reflected at each vertex, for Gouraud's way.
    vertices: Vec<Vec3>,
    /// Whether any material lets anything through.
    opaque: bool,
}

/// Color of lines, linear.
const LINE: Vec3 = Vec3::new(0.02, 0.02, 0.025);

/// Color of triangles on which nothing could be measured, linear.
const UNMEASURED: Vec3 = Vec3::splat(0.4);

/// What the back of a surface that has none is multiplied with: it is not drawn in engines, and here it is red.
const BACK: Vec3 = Vec3::new(0.75, 0.12, 0.10);

/// A surface at a place of the picture.
struct Hit {
    /// The triangle, or that nearest to it.
    name: u32,
    corners: [Vertex; 3],
    /// How much each corner counts.
    shares: [f64; 3],
    point: DVec3,
    /// Across the triangle or the surface, on its front; of length 1.
    across: DVec3,
    /// The normal that light sees, on its front; of length 1.
    smooth: DVec3,
    front: bool,
    /// How far from it the triangles are that cast shadows.
    lift: f64,
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        (asset, stage): (&'a Asset, &'a Stage),
        exact: &'a Exact<'a>,
        camera: &'a Camera,
        look: &Look,
    ) -> Self {
        let mut materials = Vec::with_capacity(stage.triangles.len());
        for piece in &stage.pieces {
            materials.resize(piece.end, count_of(piece.material));
        }
        let lights = lights(&camera.axes());
        let opaque = stage.materials.iter().all(|material| material.cutoff == Cutoff::Opaque);
        let mut shader = Self {
            asset,
            stage,
            exact,
            camera,
            shading: look.shading,
            lights,
            shadow: None,
            materials,
            vertices: Vec::new(),
            opaque,
        };
        if look.shadows && look.shading != Shading::Normals && stage.heat.is_none() {
            shader.shadow =
                Some(Shadow::new(stage, lights[0].towards, &|name, shares| shader.let_through(name, shares)));
        }
        if look.shading == Shading::Gouraud {
            shader.vertices = shader.lit_vertices();
        }
        shader
    }

    /// The name of the first surface that stands in place of triangles.
    pub(super) fn first_exact(&self) -> u32 {
        count_of(self.stage.triangles.len() + self.stage.lines.len())
    }

    fn material(&self, triangle: u32) -> &Material {
        &self.stage.materials[self.materials[triangle as usize] as usize]
    }

    fn corners(&self, triangle: u32) -> [Vertex; 3] {
        self.stage.triangles[triangle as usize].map(|corner| self.stage.vertices[corner as usize])
    }

    /// Opacity of a face in the middle of a pixel.
    pub(super) fn opacity(&self, name: u32, place: DVec2) -> f32 {
        if self.opaque || self.stage.heat.is_some() || name as usize >= self.stage.triangles.len() {
            return 1.0;
        }
        if self.material(name).cutoff == Cutoff::Opaque {
            return 1.0;
        }
        let hit = self.hit(name, place);
        self.let_through(name, hit.shares)
    }

    fn let_through(&self, name: u32, shares: [f64; 3]) -> f32 {
        let material = self.material(name);
        if material.cutoff == Cutoff::Opaque {
            return 1.0;
        }
        let alpha = self.base(material, &self.corners(name), shares, 0.0).w;
        match material.cutoff {
            Cutoff::Opaque => 1.0,
            Cutoff::Mask(least) => {
                if alpha < least {
                    0.0
                } else {
                    1.0
                }
            }
            Cutoff::Blend => alpha.clamp(0.0, 1.0),
        }
    }

    fn hit(&self, name: u32, place: DVec2) -> Hit {
        let corners = self.corners(name);
        let [a, b, c] = corners.map(|corner| corner.point);
        let (start, along) = self.camera.sight(place);
        let normal = (b - a).cross(c - a);
        let slope = normal.dot(along);
        let twice = normal.length_squared();
        let mut shares = [1.0 / 3.0; 3];
        if slope * slope > 1e-18 * twice {
            // The middle of what is covered may lie outside.
            shares = shares_of([a, b, c], start + along * (normal.dot(a - start) / slope));
        }
        let point = a * shares[0] + b * shares[1] + c * shares[2];
        let across = normal.normalize_or_zero();
        let smooth = mixed(&corners, shares, |vertex| vertex.normal).normalize_or(across);
        Hit { name, corners, shares, point, across, smooth, front: slope <= 0.0, lift: 0.0 }
    }

    /// The same of a surface that stands in place of triangles, about so deep in the picture.
    fn exact_hit(&self, number: u32, place: DVec2, depth: f64) -> Hit {
        let met = self.exact.met(number, self.camera, place, depth);
        let corners = self.corners(met.triangle);
        let shares = shares_of(corners.map(|corner| corner.point), met.point);
        Hit {
            name: met.triangle,
            corners,
            shares,
            point: met.point,
            across: met.normal,
            smooth: met.normal,
            front: met.front,
            lift: met.lift,
        }
    }

    /// The color of a face at a place, about so deep in the picture, for a screen: linear, 0 to 1.
    pub(super) fn color(&self, name: u32, place: DVec2, depth: f64) -> Vec3 {
        let first = self.first_exact();
        let hit = if name >= first {
            self.exact_hit(name - first, place, depth)
        } else if name as usize >= self.stage.triangles.len() {
            return LINE;
        } else {
            self.hit(name, place)
        };
        let name = hit.name;
        if let Some(heat) = &self.stage.heat {
            // So little shade that colors are still those of the legend.
            let facing = hit.across.dot(self.camera.towards(hit.point)).abs();
            return heat.color(name, hit.shares).unwrap_or(UNMEASURED) * single(0.8 + 0.2 * facing);
        }
        let material = self.material(name);
        let side = if hit.front { 1.0 } else { -1.0 };
        let mut normal = if self.shading == Shading::Flat { hit.across } else { hit.smooth } * side;
        if self.shading == Shading::Normals {
            return (normal.as_vec3() * 0.5 + 0.5).clamp(Vec3::ZERO, Vec3::ONE);
        }
        let level = self.level(&hit, material);
        let base = self.base(material, &hit.corners, hit.shares, level).truncate();
        let own = if hit.front || material.double_sided { base } else { base * BACK };
        if self.shading == Shading::Gouraud {
            let corners = self.stage.triangles[name as usize];
            let light: Vec3 =
                (0..3).map(|k| self.vertices[corners[k] as usize] * single(hit.shares[k])).sum();
            let light = if hit.front { light } else { Vec3::splat(0.3) };
            return color::toned(own * light);
        }
        if material.unlit {
            return own;
        }
        if let Some((map, scale)) = material.normal_map.filter(|_| self.shading != Shading::Flat) {
            normal = self.bent(&hit, (map, scale), normal, level);
        }
        let surface = self.surface(material, &hit, (own, normal, level));
        let shadow = self.shadow.as_ref().map_or(1.0, |shadow| {
            let across = hit.across * side;
            shadow.at(hit.point + across * hit.lift, across)
        });
        let light = match self.shading {
            Shading::Phong | Shading::Flat => surface.phong(&self.lights, shadow),
            _ => surface.reflected(&self.lights, shadow) + self.emitted(material, &hit, level),
        };
        color::toned(light)
    }

    fn surface(&self, material: &Material, hit: &Hit, (color, normal, level): (Vec3, DVec3, f64)) -> Surface {
        let maps = self.mapped(material.metallic_roughness_map, hit, level);
        let open = material
            .occlusion_map
            .map_or(1.0, |(map, strength)| 1.0 + strength * (self.mapped(Some(map), hit, level).x - 1.0));
        let eye = self.camera.towards(hit.point);
        Surface {
            color,
            metallic: material.metallic * maps.z,
            roughness: (material.roughness * maps.y).clamp(0.0, 1.0),
            open,
            // Normals between those of corners may look away where the surface itself does not.
            normal: (normal + eye * (0.02 - normal.dot(eye)).max(0.0)).normalize_or(eye),
            eye,
        }
    }

    fn emitted(&self, material: &Material, hit: &Hit, level: f64) -> Vec3 {
        Vec3::from_array(material.emissive) * self.mapped(material.emissive_map, hit, level).truncate()
    }

    /// A picture's value; white where there is none.
    fn mapped(&self, map: Option<Map>, hit: &Hit, level: f64) -> Vec4 {
        map.map_or(Vec4::ONE, |map| self.asset.textures[map.texture].at(coordinates(&map, hit), level))
    }

    /// A normal bent by a picture, in the frame of the tangents; those that a file leaves out are taken from the texture
    /// coordinates of the triangle.
    fn bent(&self, hit: &Hit, (map, scale): (Map, f32), normal: DVec3, level: f64) -> DVec3 {
        let value = self.mapped(Some(map), hit, level) * 2.0 - 1.0;
        let own = mixed(&hit.corners, hit.shares, |vertex| {
            DVec3::new(vertex.tangent[0].into(), vertex.tangent[1].into(), vertex.tangent[2].into())
        });
        let (tangent, hand) = if own == DVec3::ZERO {
            let [a, b, c] = hit.corners.map(|corner| corner.point);
            let [p, q, r] = hit.corners.map(|corner| uv(&corner, map.set));
            let (one, other) = (q - p, r - p);
            let turned = one.perp_dot(other);
            ((b - a) * other.y - (c - a) * one.y, if turned < 0.0 { 1.0 } else { -1.0 })
        } else {
            (own, f64::from(hit.corners[0].tangent[3]))
        };
        let Some(tangent) = tangent.reject_from_normalized(normal).try_normalize() else { return normal };
        let other = normal.cross(tangent) * hand;
        let bent = DVec3::new((value.x * scale).into(), (value.y * scale).into(), value.z.into());
        (DMat3::from_cols(tangent, other, normal) * bent).normalize_or(normal)
    }

    /// The linear color of a material with its picture and the colors of the vertices, and its opacity.
    fn base(&self, material: &Material, corners: &[Vertex; 3], shares: [f64; 3], level: f64) -> Vec4 {
        let colors: Vec4 = (0..3).map(|k| Vec4::from_array(corners[k].color) * single(shares[k])).sum();
        let map = material.color_map.map_or(Vec4::ONE, |map| {
            let place: DVec2 = (0..3).map(|k| uv(&corners[k], map.set) * shares[k]).sum();
            self.asset.textures[map.texture].at(map.place.transform_point2(place).to_array(), level)
        });
        Vec4::from_array(material.color) * colors * map
    }

    /// Which copy of the pictures has about one texel a pixel on a triangle.
    fn level(&self, hit: &Hit, material: &Material) -> f64 {
        let Some(map) = material.color_map.or(material.normal_map.map(|(map, _)| map)) else { return 0.0 };
        let [a, b, c] =
            hit.corners.map(|corner| self.camera.project(corner.point).unwrap_or_default().truncate());
        let [p, q, r] = hit.corners.map(|corner| map.place.transform_point2(uv(&corner, map.set)));
        let (width, height) = self.asset.textures[map.texture].size();
        let texels = (q - p).perp_dot(r - p).abs() * width * height;
        let pixels = (b - a).perp_dot(c - a).abs();
        if texels > pixels && pixels > 0.0 {
            ln(texels / pixels) / (2.0 * std::f64::consts::LN_2)
        } else {
            0.0
        }
    }

    /// Light of a white surface at each vertex (H. Gouraud, 1971); with no normals, none.
    fn lit_vertices(&self) -> Vec<Vec3> {
        let light = |vertex: &Vertex| {
            let eye = self.camera.towards(vertex.point);
            let normal = if vertex.normal == DVec3::ZERO { eye } else { vertex.normal };
            let open = Surface { color: Vec3::ONE, metallic: 0.0, roughness: 1.0, open: 1.0, normal, eye };
            let shadow = self.shadow.as_ref().map_or(1.0, |shadow| shadow.at(vertex.point, normal));
            open.phong(&self.lights, shadow)
        };
        self.stage.vertices.iter().map(light).collect()
    }
}

fn uv(vertex: &Vertex, set: usize) -> DVec2 {
    let [u, v] = vertex.uvs[set];
    DVec2::new(u.into(), v.into())
}

fn coordinates(map: &Map, hit: &Hit) -> [f64; 2] {
    let place: DVec2 = (0..3).map(|k| uv(&hit.corners[k], map.set) * hit.shares[k]).sum();
    map.place.transform_point2(place).to_array()
}

fn mixed(corners: &[Vertex; 3], shares: [f64; 3], of: impl Fn(&Vertex) -> DVec3) -> DVec3 {
    (0..3).map(|k| of(&corners[k]) * shares[k]).sum()
}

/// How much each corner of a triangle counts at a point over it; beside it, at a point of it.
fn shares_of([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let twice = normal.length_squared();
    let part = |one: DVec3, other: DVec3| (one - point).cross(other - point).dot(normal) / twice;
    let own = [part(b, c), part(c, a), part(a, b)].map(|share| share.clamp(0.0, 1.0));
    let sum: f64 = own.iter().sum();
    if sum > 0.0 { own.map(|share| share / sum) } else { [1.0 / 3.0; 3] }
}

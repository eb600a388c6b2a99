//! Shapes of a document into recipes.

use glam::{DAffine3, DMat3, DVec3};

use super::primitive::primitive;
use super::solid::SetOf;
use super::{Builder, placement};
use crate::geometry::mesh;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Count, Shape as Kind, ShapeDefinition, ShapeReference};
use crate::model::{
    Density, LightmapOptions, Occlusion, Recipe, Shape, ShapeHandle, ShapeOptions, Smoothing, UvMapping,
    UvMode, VertexColor,
};

impl Builder<'_> {
    /// The shape of a name, built at its first use.
    pub(super) fn named_shape(&mut self, name: &str) -> Option<ShapeHandle> {
        if let Some(known) = self.shapes.get(name) {
            return *known;
        }
        let definition = self.spec.shapes.get(name)?;
        let outside = self.within.replace((name.to_owned(), true));
        let handle = self.shape(name, &definition.value, definition.span);
        self.within = outside;
        self.shapes.insert(name.to_owned(), handle);
        handle
    }

    /// The shape that a field asks for.
    pub(super) fn shape_of(
        &mut self,
        user: &str,
        index: usize,
        reference: &ShapeReference,
    ) -> Option<ShapeHandle> {
        match reference {
            ShapeReference::Named(name) => self.named_shape(&name.value),
            ShapeReference::Inline(shape) => {
                self.refuse_attributes(&shape.value.options);
                self.shape(&format!("{user}-{}", index + 1), &shape.value, shape.span)
            }
        }
    }

    fn shape(&mut self, name: &str, definition: &ShapeDefinition, span: Span) -> Option<ShapeHandle> {
        let options = self.options(&definition.options);
        let (recipe, place) = self.recipe(name, definition, span)?;
        let faces = std::mem::take(&mut self.face_places);
        let mut options = options?;
        options.placement *= place;
        if let Some(color) = &mut options.vertex_color {
            color.space = place;
        }
        let handle = ShapeHandle(mesh::index(self.model.shapes.len()));
        self.normal_map(name, handle, definition, &options)?;
        self.model.shapes.push(Shape { name: name.to_owned(), recipe, options });
        self.places.push(span);
        self.faces.push(faces);
        Some(handle)
    }

    pub(super) fn options(&mut self, written: &spec::ShapeOptions) -> Option<ShapeOptions> {
        let material = match &written.material {
            Some(name) => Some(self.material(&name.value.0)?),
            None => None,
        };
        let vertex_color = match &written.vertex_color {
            Some(color) => {
                Some(VertexColor { law: self.color_law(&color.value)?, space: DAffine3::IDENTITY })
            }
            None => None,
        };
        if let (Some(map), spec::Uv::None) = (&written.lightmap, written.uv.value) {
            let message = "`lightmap` and `uv = \"none\"` exclude each other: second texture coordinates need first ones";
            self.report(
                Diagnostic::error(Code::Conflict, message)
                    .at(map.span, "second texture coordinates")
                    .also(written.uv.span, "no first ones")
                    .help("leave one of them out"),
            );
            return None;
        }
        Some(ShapeOptions {
            lightmap: written
                .lightmap
                .as_ref()
                .map(|map| LightmapOptions { size: map.value.size.value, padding: map.value.padding.value }),
            occlusion: written.occlusion.as_ref().map(|asked| Occlusion {
                samples: asked.value.samples.value,
                distance: asked.value.distance.as_ref().map(|distance| distance.value),
                strength: asked.value.strength.value,
                seed: asked.value.seed.value,
            }),
            vertex_color,
            tolerance: written.tolerance.map(|tolerance| tolerance.value),
            density: written.segments.map(|grid| Density { u: grid.u, v: grid.v }),
            smoothing: match written.smoothing.value {
                spec::Smoothing::Auto => Smoothing::Auto,
                spec::Smoothing::Flat => Smoothing::Flat,
                spec::Smoothing::Smooth => Smoothing::Smooth,
            },
            crease_angle: written.crease_angle.value,
            uv: match written.uv.value {
                spec::Uv::Auto => UvMode::Auto,
                spec::Uv::Always => UvMode::Always,
                spec::Uv::None => UvMode::None,
            },
            uv_mapping: match written.uv_mapping.value {
                spec::UvMapping::Surface => UvMapping::Surface,
                spec::UvMapping::Box => UvMapping::Box,
                spec::UvMapping::Cylinder => UvMapping::Cylinder,
                spec::UvMapping::Sphere => UvMapping::Sphere,
            },
            uv_scale: written.uv_scale.value,
            material,
            placement: placement(written.scale.0, written.rotate.value, written.at.value),
        })
    }

    /// The recipe of a kind and where it is put.
    fn recipe(&mut self, name: &str, definition: &ShapeDefinition, span: Span) -> Option<(Recipe, DAffine3)> {
        let here = |recipe: Recipe| (recipe, DAffine3::IDENTITY);
        let kind = &definition.kind;
        match kind {
            Kind::Box(_)
            | Kind::Sphere(_)
            | Kind::Cylinder(_)
            | Kind::Cone(_)
            | Kind::Capsule(_)
            | Kind::Torus(_)
            | Kind::Tube(_)
            | Kind::Disk(_)
            | Kind::Plane(_)
            | Kind::Polyhedron(_)
            | Kind::Geodesic(_) => {
                primitive(kind).map(|(recipe, center)| (recipe, DAffine3::from_translation(center)))
            }
            Kind::Revolve(revolve) => self.revolution(revolve),
            Kind::Extrude(extrude) => self.extrusion(extrude).map(here),
            Kind::Sweep(sweep) => self.sweep(sweep).map(here),
            Kind::Ruled(ruled) => self.ruled(ruled).map(here),
            Kind::Loft(loft) => self.loft(loft, span).map(here),
            Kind::Translational(moved) => self.translational(moved).map(here),
            Kind::Sheet(sheet) => self.sheet(sheet).map(here),
            Kind::Polygon(polygon) => self.polygon(polygon, span).map(here),
            Kind::Wire(wire) => {
                let curves: Vec<_> = wire.curves.iter().map(|curve| self.parts_of(curve)).collect();
                let curves: Option<Vec<_>> = curves.into_iter().collect();
                curves.map(|curves| here(Recipe::Wire(curves.concat())))
            }
            Kind::Patches(patches) => self.patches(patches, span).map(here),
            Kind::BezierTriangles(triangles) => self.bezier_triangles(triangles).map(here),
            Kind::Hermite(surface) => self.hermite_surface(surface, span).map(here),
            Kind::BSpline(surface) => self.b_spline_surface(surface, span).map(here),
            Kind::Nurbs(surface) => self.nurbs_surface(surface, span).map(here),
            Kind::Coons(patch) => self.coons(patch).map(here),
            Kind::Trimmed(part) => self.trimmed(name, part, span),
            Kind::Joined(joined) => self.joined_surfaces(name, joined),
            Kind::Quadric(quadric) => self.quadric(quadric, span).map(here),
            Kind::Gordon(network) => self.gordon(network, span).map(here),
            Kind::HeightMap(map) => self.height_map(name, map, &definition.options).map(here),
            Kind::Split(split) => self.split(name, split, &definition.options, span),
            Kind::Parametric(surface) => {
                let both = self.shows_both_sides(&definition.options);
                self.parametric(surface, span, both).map(here)
            }
            Kind::Perturbed(patches) => self.perturbed_patches(patches, span).map(here),
            Kind::Implicit(surface) => self.implicit_shape(surface, span).map(here),
            Kind::Mesh(mesh) => self.mesh(mesh, span).map(here),
            Kind::Import(import) => {
                self.import(import, definition.options.material.is_some(), span).map(here)
            }
            Kind::Taper(taper) => self.taper(name, taper).map(here),
            Kind::Twist(twist) => self.twist(name, twist).map(here),
            Kind::Bend(bend) => self.bend(name, bend).map(here),
            Kind::Along(along) => self.along(name, along).map(here),
            Kind::Displace(displace) => self.displace(name, displace).map(here),
            Kind::Copy(copy) => {
                let of = self.shape_of(name, 0, &copy.of)?;
                Some(here(Recipe::Assembly(vec![(of, DAffine3::IDENTITY)])))
            }
            Kind::Mirror(mirror) => {
                let of = self.shape_of(name, 0, &mirror.of)?;
                let image = (of, reflection(mirror.plane.normal, mirror.plane.point));
                let parts =
                    if mirror.keep.value { vec![(of, DAffine3::IDENTITY), image] } else { vec![image] };
                Some(here(Recipe::Assembly(parts)))
            }
            Kind::Array(array) => {
                let of = self.shape_of(name, 0, &array.of);
                self.check_count(array)?;
                let of = of?;
                Some(here(Recipe::Assembly(copies(array).into_iter().map(|map| (of, map)).collect())))
            }
            Kind::Union(set) => self.solid_set(name, set, SetOf::Union, span).map(here),
            Kind::Difference(set) => self.solid_set(name, set, SetOf::Difference, span).map(here),
            Kind::Intersection(set) => self.solid_set(name, set, SetOf::Intersection, span).map(here),
            Kind::Solid(solid) => self.solid_formula(solid, span).map(here),
            Kind::Cut(cut) => self.cut(name, cut, span).map(here),
            Kind::Hull(hull) => self.hull(name, hull, span).map(here),
            Kind::MinkowskiRound(round) => self.minkowski_round(name, round, span).map(here),
            Kind::Shell(shell) => self.shell(name, shell, span).map(here),
            Kind::Subdivide(written) => self.subdivide(name, written).map(here),
            Kind::Group(group) => {
                let parts: Vec<_> = (group.of.iter().enumerate())
                    .map(|(index, part)| self.shape_of(name, index, part))
                    .collect();
                let parts: Option<Vec<_>> = parts.into_iter().collect();
                let parts = parts?.into_iter().map(|part| (part, DAffine3::IDENTITY)).collect();
                Some(here(Recipe::Assembly(parts)))
            }
        }
    }

    /// A block of copies is refused before it is laid out.
    fn check_count(&mut self, array: &spec::Array) -> Option<()> {
        const MOST: u64 = 1_000_000;
        // A copy is a part with its place, once more in each stage.
        const BYTES_OF_COPY: u64 = 320;
        let most = MOST.min(self.spec.limits.memory / BYTES_OF_COPY);
        let Count::Block(counts) = array.count.value else { return Some(()) };
        let copies = counts.iter().fold(1, |product: u64, count| product.saturating_mul(u64::from(*count)));
        if copies <= most {
            return Some(());
        }
        let message = format!("this array makes {copies} copies, and the limit is {most}");
        self.report(Diagnostic::error(Code::LimitPassed, message).at(array.count.span, "too many"));
        None
    }
}

/// The mirror image in a plane.
fn reflection(normal: DVec3, point: DVec3) -> DAffine3 {
    let normal = normal.normalize();
    let matrix = DMat3::IDENTITY
        - DMat3::from_cols(normal * (2.0 * normal.x), normal * (2.0 * normal.y), normal * (2.0 * normal.z));
    DAffine3 { matrix3: matrix, translation: normal * (2.0 * normal.dot(point)) }
}

/// Where the copies of an array stand.
fn copies(array: &spec::Array) -> Vec<DAffine3> {
    let offset = array.offset.value;
    match array.count.value {
        Count::Row(count) => {
            let center = array.around.value;
            let step = |k: u32| {
                let turn = placement(DVec3::ONE, array.rotate.value * f64::from(k), DVec3::ZERO);
                DAffine3::from_translation(offset * f64::from(k) + center)
                    * turn
                    * DAffine3::from_translation(-center)
            };
            (0..count).map(step).collect()
        }
        Count::Block([nx, ny, nz]) => {
            let mut all = Vec::new();
            for z in 0..nz {
                for y in 0..ny {
                    for x in 0..nx {
                        let place = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * offset;
                        all.push(DAffine3::from_translation(place));
                    }
                }
            }
            all
        }
    }
}

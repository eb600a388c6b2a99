//! Fields of a document into fields of the kernel, and shapes of their surfaces.

use glam::{DAffine3, DVec3};

use super::formula::Compiler;
use super::{Builder, placement};
use crate::geometry::curve::AnyCurve;
use crate::geometry::field::{
    AnyField, Blend, Bump, Element, Form, Join, Joined, Line, Perturbed, Placed, Potential, Primitive,
    Quadric, Skeleton, Sum,
};
use crate::geometry::mesh;
use crate::geometry::mesh::triangulate::triangulate_in_space;
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::FieldSurface;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{
    FallOff, Field as Kind, FieldDefinition, FieldJoin, FieldReference, FieldSum, ImplicitShape, JoinMethod,
    PerturbedField, SkeletonElement, SkeletonField, Sp, Spec,
};
use crate::model::{MaterialHandle, Recipe, ShapeHandle};

impl Builder<'_> {
    /// The surface of a field.
    pub(super) fn implicit_shape(&mut self, written: &ImplicitShape, span: Span) -> Option<Recipe> {
        let field = self.field_of(&written.field)?;
        let materials = self.body_materials(&written.field)?;
        let colors = self.element_colors(&written.field);
        let level = written.level.value;
        let field = if level == 0.0 {
            field
        } else {
            AnyField::Sum(Sum { of: vec![(1.0, field)], constant: -level })
        };
        let mut shapes = Vec::new();
        let mut place = |number: usize| {
            let known = shapes.iter().position(|shape| *shape == number);
            AnyField::Shape(known.unwrap_or_else(|| {
                shapes.push(number);
                shapes.len() - 1
            }))
        };
        let field = field.with_shapes(&mut place);
        let shapes: Vec<ShapeHandle> =
            shapes.into_iter().map(|number| ShapeHandle(mesh::index(number))).collect();
        let known = if level == 0.0 { box_of(&field) } else { None };
        let within =
            written.within.as_ref().map(|within| Bounds { min: within.min.value, max: within.max.value });
        let Some(within) = within.or(known) else {
            let report = Diagnostic::error(Code::NeedsBox, "no box is known that holds the surface of this field")
                .at(span, "needs `within`")
                .help("write `within = { min = [-1, -1, -1], max = [1, 1, 1] }`: where the surface lies, with a little room");
            self.report(report);
            return None;
        };
        let size = (within.max - within.min).to_array();
        let later = !shapes.is_empty() && written.within.is_none();
        if !later && (within.is_empty() || size.iter().any(|side| *side <= 0.0)) {
            self.report(
                Diagnostic::error(
                    Code::NoFieldSurface,
                    "this field has no inside: its parts do not reach each other or the level",
                )
                .at(span, "no surface"),
            );
            return None;
        }
        let surface = FieldSurface { field, within, least: written.search.map(|size| size.value) };
        Some(Recipe::Implicit { surface: Box::new(surface), shapes, materials, colors })
    }

    /// The field that a reference names or writes.
    pub(super) fn field_of(&mut self, reference: &FieldReference) -> Option<AnyField> {
        match reference {
            FieldReference::Named(name) => self.named_field(&name.value),
            FieldReference::Inline(field) => self.field(&field.value),
        }
    }

    /// The field of a name, built at its first use.
    pub(super) fn named_field(&mut self, name: &str) -> Option<AnyField> {
        if let Some(known) = self.fields.get(name) {
            return known.clone();
        }
        let definition = self.spec.fields.get(name)?;
        let outside = self.within.replace((name.to_owned(), true));
        let field = self.field(&definition.value);
        self.within = outside;
        self.fields.insert(name.to_owned(), field.clone());
        field
    }

    /// The materials of the bodies that a field is made of, as [`AnyField::owners`] counts them; none where none has one.
    fn body_materials(&mut self, reference: &FieldReference) -> Option<Vec<Option<MaterialHandle>>> {
        let mut all = Vec::new();
        self.add_materials(reference, None, &mut all)?;
        Some(if all.iter().all(Option::is_none) { Vec::new() } else { all })
    }

    fn add_materials(
        &mut self,
        reference: &FieldReference,
        outer: Option<MaterialHandle>,
        all: &mut Vec<Option<MaterialHandle>>,
    ) -> Option<()> {
        let spec = self.spec;
        let Some(definition) = written(spec, reference) else { return Some(()) };
        let own = match &definition.options.material {
            Some(name) => Some(self.material(&name.value.0)?),
            None => outer,
        };
        let inner = match &definition.kind {
            Kind::Skeleton(skeleton) => {
                for element in &skeleton.elements {
                    all.push(match &element.value.material {
                        Some(name) => Some(self.material(&name.value.0)?),
                        None => own,
                    });
                }
                return Some(());
            }
            Kind::Union(join) | Kind::Intersection(join) | Kind::Difference(join) => &join.of[..],
            Kind::Sum(sum) => &sum.of[..1],
            Kind::Perturbed(perturbed) => std::slice::from_ref(&perturbed.base),
            _ => {
                all.push(own);
                return Some(());
            }
        };
        inner.iter().try_for_each(|part| self.add_materials(part, own, all))
    }

    /// The colors of the elements of a skeleton; none of other fields.
    fn element_colors(&self, reference: &FieldReference) -> Vec<[f64; 4]> {
        let colors =
            written_elements(self.spec, reference).iter().map(|element| element.value.color.as_ref());
        if colors.clone().all(|color| color.is_none()) {
            return Vec::new();
        }
        colors.map(|color| color.map_or([1.0; 4], |color| color.value.linear)).collect()
    }

    fn field(&mut self, definition: &FieldDefinition) -> Option<AnyField> {
        let kind = self.field_kind(&definition.kind)?;
        let options = &definition.options;
        let thick = match options.thickness {
            Some(thickness) => AnyField::Skin { of: Box::new(kind), half: thickness.value / 2.0 },
            None => kind,
        };
        let grown = if options.grow.value == 0.0 {
            thick
        } else {
            AnyField::Grown { of: Box::new(thick), by: options.grow.value }
        };
        let map = placement(DVec3::splat(options.scale.value), options.rotate.value, options.at.value);
        Some(if map == DAffine3::IDENTITY { grown } else { AnyField::Placed(Placed::new(grown, &map)) })
    }

    fn field_kind(&mut self, kind: &Kind) -> Option<AnyField> {
        let body = |body: Primitive, center: DVec3| {
            let body = AnyField::Primitive(body);
            let map = DAffine3::from_translation(center);
            if center == DVec3::ZERO { body } else { AnyField::Placed(Placed::new(body, &map)) }
        };
        Some(match kind {
            Kind::Skeleton(skeleton) => self.skeleton(skeleton)?,
            Kind::Formula(written) => {
                let mut compiler = Compiler::new(&["x", "y", "z"]);
                let output = match compiler.add(&written.f.value) {
                    Ok(slot) => slot,
                    Err(diagnostic) => {
                        self.report(*diagnostic);
                        return None;
                    }
                };
                AnyField::Formula(Box::new(compiler.finish(vec![output]).formula))
            }
            Kind::Quadric(q) => AnyField::Quadric(Box::new(Quadric::new(
                DVec3::new(q.xx.value, q.yy.value, q.zz.value),
                DVec3::new(q.xy.value, q.yz.value, q.zx.value),
                DVec3::new(q.x.value, q.y.value, q.z.value),
                q.constant.value,
            ))),
            Kind::Sphere(ball) => body(Primitive::Sphere { radius: ball.radius.value }, ball.center.value),
            Kind::Box(cuboid) => {
                let half = cuboid.size.value / 2.0;
                body(Primitive::Box { half, radius: cuboid.radius.value }, cuboid.center.value)
            }
            Kind::Cylinder(tube) => {
                let (radius, half) = (tube.radius.value, tube.height.value / 2.0);
                body(Primitive::Cylinder { radius, half }, tube.center.value)
            }
            Kind::Capsule(tube) => {
                let (radius, half) = (tube.radius.value, tube.height.value / 2.0 - tube.radius.value);
                body(Primitive::Capsule { radius, half: half.max(0.0) }, tube.center.value)
            }
            Kind::Torus(ring) => {
                let (major, minor) = (ring.radius.value, ring.tube_radius.value);
                body(Primitive::Torus { major, minor }, ring.center.value)
            }
            Kind::Cone(cone) => {
                let (bottom, top) = (cone.radius.value, cone.top_radius.value);
                body(Primitive::Cone { bottom, top, half: cone.height.value / 2.0 }, cone.center.value)
            }
            Kind::Shape(shape) => {
                let user = self.within.as_ref().map_or("field", |(name, _)| name).to_owned();
                AnyField::Shape(self.shape_of(&user, 0, &shape.of)?.0 as usize)
            }
            Kind::HalfSpace(half) => {
                let normal = half.normal.value.normalize();
                AnyField::Primitive(Primitive::Plane { normal, offset: normal.dot(half.point.value) })
            }
            Kind::Union(join) => self.joined_fields(join, Join::Union)?,
            Kind::Intersection(join) => self.joined_fields(join, Join::Intersection)?,
            Kind::Difference(join) => self.joined_fields(join, Join::Difference)?,
            Kind::Sum(sum) => self.field_sum(sum)?,
            Kind::Perturbed(perturbed) => self.perturbed(perturbed)?,
        })
    }

    fn joined_fields(&mut self, written: &FieldJoin, join: fn(Blend) -> Join) -> Option<AnyField> {
        let of = self.fields_of(written.of.iter());
        let blend = match (written.blend.value, written.method.value) {
            (size, _) if size > 0.0 => Blend::Smooth(size),
            (_, JoinMethod::MinMax) => Blend::Sharp,
            (_, JoinMethod::RFunction) => Blend::Rvachev,
        };
        Some(AnyField::Joined(Joined { join: join(blend), of: of? }))
    }

    fn field_sum(&mut self, written: &FieldSum) -> Option<AnyField> {
        let of = self.fields_of(written.of.iter());
        let weight = |k: usize| written.weights.as_ref().map_or(1.0, |weights| weights.value[k]);
        let of = of?.into_iter().enumerate().map(|(k, field)| (weight(k), field)).collect();
        Some(AnyField::Sum(Sum { of, constant: written.constant.value }))
    }

    fn perturbed(&mut self, written: &PerturbedField) -> Option<AnyField> {
        let parts = core::iter::once(&written.base).chain(written.bumps.iter().map(|bump| &bump.value.field));
        let mut parts = self.fields_of(parts)?.into_iter();
        let base = Box::new(parts.next()?);
        let bumps = parts.zip(&written.bumps);
        let bumps = bumps.map(|(field, bump)| Bump { field, factor: bump.value.factor.value }).collect();
        Some(AnyField::Perturbed(Perturbed { base, bumps }))
    }

    /// Several fields. What names the same fields again and again could grow without bound: parts are counted before more
    /// are copied.
    fn fields_of<'a>(&mut self, written: impl Iterator<Item = &'a FieldReference>) -> Option<Vec<AnyField>> {
        const MOST: u64 = 1 << 16;
        let mut all = Some(Vec::new());
        let mut parts: u64 = 0;
        for reference in written {
            let Some(field) = self.field_of(reference) else {
                all = None;
                continue;
            };
            parts += field.weight();
            if parts > MOST {
                let message = format!(
                    "this field is made of more than {MOST} parts, those of fields that it names included"
                );
                let report = Diagnostic::error(Code::LimitPassed, message)
                    .at(reference.span(), "too many with this one");
                self.report(report.help("name fewer fields, or the same fields less often"));
                return None;
            }
            if let Some(all) = &mut all {
                all.push(field);
            }
        }
        all
    }

    fn skeleton(&mut self, written: &SkeletonField) -> Option<AnyField> {
        let elements: Vec<_> = written.elements.iter().map(|element| self.elements(element)).collect();
        let elements: Option<Vec<_>> = elements.into_iter().collect();
        let elements = elements?.concat();
        Some(AnyField::Skeleton(Box::new(Skeleton::new(elements, written.level.value))))
    }

    /// The element; of a curve of several parts one for each part would count double where they meet, so they are one.
    fn elements(&mut self, written: &Sp<SkeletonElement>) -> Option<Vec<Element>> {
        let radius = written.radius.value;
        let potential = match written.potential.value {
            FallOff::Wyvill => Potential::Wyvill { radius },
            FallOff::Gaussian => Potential::Gaussian { sharpness: 1.0 / (radius * radius) },
            FallOff::Power1 => Potential::Power { radius, exponent: 1 },
            FallOff::Power2 => Potential::Power { radius, exponent: 2 },
            FallOff::Power3 => Potential::Power { radius, exponent: 3 },
        };
        let form = if let Some(point) = &written.point {
            Form::Point(point.value)
        } else if let Some(ends) = &written.segment {
            Form::Segment(ends[0].value, ends[1].value)
        } else if let Some(corners) = &written.polygon {
            self.polygon_form(corners)?
        } else {
            let parts: Vec<AnyCurve> = self.parts_of(written.curve.as_ref()?)?;
            Form::Curves(parts.iter().map(Line::new).collect())
        };
        Some(vec![Element { form, potential, strength: written.strength.value }])
    }

    fn polygon_form(&mut self, corners: &Sp<Vec<Sp<DVec3>>>) -> Option<Form> {
        let places: Vec<DVec3> = corners.iter().map(|corner| corner.value).collect();
        match triangulate_in_space(&[&places]) {
            Ok((triangles, _)) if !triangles.is_empty() => Some(Form::Triangles(
                triangles.iter().map(|t| t.map(|corner| places[corner as usize])).collect(),
            )),
            _ => {
                let report = Diagnostic::error(Code::NoElement, "this polygon encloses no area");
                self.report(
                    report
                        .at(corners.span, "flat, or crossing itself")
                        .help("a line is a `segment` or a `curve`"),
                );
                None
            }
        }
    }
}

/// A box around the surface of a field; an empty one where it is that of shapes that are not made yet.
fn box_of(field: &AnyField) -> Option<Bounds> {
    if field.shapes().is_empty() {
        return field.bounds();
    }
    let stand_in = || AnyField::Primitive(Primitive::Sphere { radius: 1.0 });
    field.with_shapes(&mut |_| stand_in()).bounds().map(|_| Bounds::EMPTY)
}

/// The definition that a reference names or writes.
fn written<'s>(spec: &'s Spec, reference: &'s FieldReference) -> Option<&'s FieldDefinition> {
    match reference {
        FieldReference::Named(name) => spec.fields.get(&name.value).map(|field| &field.value),
        FieldReference::Inline(field) => Some(&field.value),
    }
}

/// The elements of a skeleton as they are written; none of other fields.
fn written_elements<'s>(spec: &'s Spec, reference: &'s FieldReference) -> &'s [Sp<SkeletonElement>] {
    match written(spec, reference).map(|definition| &definition.kind) {
        Some(Kind::Skeleton(skeleton)) => &skeleton.elements,
        _ => &[],
    }
}

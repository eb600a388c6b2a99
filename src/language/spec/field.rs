//! Fields: a number at every point of space, and shapes of the surfaces where it is zero.

use glam::DVec3;
use serde_json::Value as Json;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, kinds, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::kind::{Kinds, take_kind};
use crate::language::spec::material::Color;
use crate::language::spec::primitive::{BoxShape, Capsule, Cone, Cylinder, Sphere, Torus};
use crate::language::spec::quadric::Within;
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::reference::{CurveReference, FieldReference, MaterialName, ShapeReference};
use crate::language::spec::schema::Schemas;
use crate::language::spec::spanned::Sp;
use crate::language::value::Value;

/// A field: its kind and the fields that all kinds have.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldDefinition {
    /// What is common to all kinds.
    pub options: FieldOptions,
    /// What it is.
    pub kind: Field,
}

table! {
    /// Fields of every field, beside the table of its kind.
    "field" pub FieldOptions {
        /// The skin of the body, half of this thickness to each side of its surface, in place of the body.
        thickness: Option<Sp<f64>> => Check::above(0.0);
        /// How far the surface moves outward; of a negative number inward. Exact where values are distances, as those of
        /// simple bodies are.
        grow: Sp<f64> = 0.0;
        /// The material of the surface where it is this field's: where of fields that are joined this one is the nearest, and
        /// on what a difference cuts with it. Elements of skeletons may have others; a field that is a part of this one too.
        material: Option<Sp<MaterialName>>;
        /// Factor of size, applied before `rotate` and `at`. Values grow with it.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
    }
}

kinds! {
    /// A field of one kind.
    "field" Field {
        /// Potentials around points, segments, polygons and curves.
        Skeleton(SkeletonField) = "skeleton";
        /// A formula of x, y and z.
        Formula(FieldFormula) = "formula";
        /// A polynomial of the second degree.
        Quadric(FieldQuadric) = "quadric";
        /// Distance to a ball.
        Sphere(Sphere) = "sphere";
        /// Distance to a box.
        Box(BoxShape) = "box";
        /// Distance to a cylinder.
        Cylinder(Cylinder) = "cylinder";
        /// Distance to a capsule.
        Capsule(Capsule) = "capsule";
        /// Distance to a ring.
        Torus(Torus) = "torus";
        /// Distance to a cone.
        Cone(Cone) = "cone";
        /// Distance to a closed shape.
        Shape(ShapeField) = "shape";
        /// Distance to a plane.
        HalfSpace(HalfSpaceField) = "half-space";
        /// All points of any.
        Union(FieldJoin) = "union";
        /// The points of all.
        Intersection(FieldJoin) = "intersection";
        /// The points of the first that belong to no other.
        Difference(FieldJoin) = "difference";
        /// Fields added up.
        Sum(FieldSum) = "sum";
        /// A field with bumps on it.
        Perturbed(PerturbedField) = "perturbed";
    }
}

table! {
    /// Potentials around elements, added up; the surface lies where the sum reaches `level`, inside it is greater. Elements
    /// near each other flow together. The value of the field is `level` minus the sum.
    "skeleton field" pub SkeletonField {
        /// The elements.
        elements: Vec<Sp<SkeletonElement>> => Check::items(1);
        /// The sum at which the surface lies.
        level: Sp<f64> = 0.5 => Check::above(0.0);
    }
}

table! {
    /// An element of a skeleton: one of `point`, `segment`, `polygon` and `curve`, and the potential around it.
    "element" pub SkeletonElement {
        /// A point.
        point: Option<Sp<DVec3>>;
        /// Two points.
        segment: Option<Sp<Vec<Sp<DVec3>>>>;
        /// The corners of a flat polygon, in order.
        polygon: Option<Sp<Vec<Sp<DVec3>>>> => Check::items(3);
        /// A curve.
        curve: Option<CurveReference>;
        /// The distance at which the potential ends; a Gaussian has fallen to 1 / e there.
        radius: Sp<f64> => Check::above(0.0);
        /// Factor of the potential; negative takes away.
        strength: Sp<f64> = 1.0 => Check::nonzero();
        /// How the potential falls off.
        potential: Sp<FallOff> = FallOff::Wyvill;
        /// The material of the surface where this element is the strongest.
        material: Option<Sp<MaterialName>>;
        /// The color of the surface near this element, which multiplies that of the material: colors of elements blend by their
        /// shares of the sum, and elements without one are white.
        color: Option<Sp<Color>>;
    }
    checked check
}

choices! {
    /// How a potential falls off with the distance d.
    FallOff {
        /// 1 - 4/9 d⁶/R⁶ + 17/9 d⁴/R⁴ - 22/9 d²/R²: 1/2 at half of the radius.
        Wyvill = "wyvill";
        /// e^(-d²/R²); it never ends, so every element reaches everywhere.
        Gaussian = "gaussian";
        /// 1 - d²/R². Its slope does not end softly: where the reach of an element ends on the surface of others there is a
        /// faint edge.
        Power1 = "power-1";
        /// (1 - d²/R²)².
        Power2 = "power-2";
        /// (1 - d²/R²)³.
        Power3 = "power-3";
    }
}

table! {
    /// A formula of x, y and z; inside is where it is negative. Angles are in degrees.
    "field formula" pub FieldFormula {
        /// The formula: `"= x^2 + y^2 + z^2 - 1"` is a ball.
        f: Sp<Formula>;
    }
}

table! {
    /// The polynomial xx x² + yy y² + zz z² + xy x y + yz y z + zx z x + x x + y y + z z + constant.
    "field quadric" pub FieldQuadric {
        /// Factor of x².
        xx: Sp<f64> = 0.0;
        /// Factor of y².
        yy: Sp<f64> = 0.0;
        /// Factor of z².
        zz: Sp<f64> = 0.0;
        /// Factor of x y.
        xy: Sp<f64> = 0.0;
        /// Factor of y z.
        yz: Sp<f64> = 0.0;
        /// Factor of z x.
        zx: Sp<f64> = 0.0;
        /// Factor of x.
        x: Sp<f64> = 0.0;
        /// Factor of y.
        y: Sp<f64> = 0.0;
        /// Factor of z.
        z: Sp<f64> = 0.0;
        /// What is added.
        constant: Sp<f64> = 0.0;
    }
}

table! {
    /// The distance to a closed shape of any kind: a mesh, an imported file, a solid, a revolution. What is round is cut into
    /// triangles first, within an eighth of the tolerance of the surface that is asked for, or within its own `tolerance`, and
    /// where it looks smooth the surface does. Edges stay sharp where the field is 0; moved outward they become
    /// round, as by a ball, and moved inward they stay. The shape itself is not shown, and its materials do not count.
    "shape field" pub ShapeField {
        /// The shape, by name or in place. Its faces look outward, enclose it and do not cross each other.
        of: ShapeReference;
    }
}

table! {
    /// All points on one side of a plane.
    "half space" pub HalfSpaceField {
        /// The direction that points out of it.
        normal: Sp<DVec3> = DVec3::Y;
        /// A point of the plane.
        point: Sp<DVec3> = DVec3::ZERO;
    }
}

table! {
    /// Fields joined.
    "field join" pub FieldJoin {
        /// The fields, by name or in place.
        of: Vec<FieldReference> => Check::items(1);
        /// Size of the fillet where surfaces meet: they flow together where their distances differ by less. 0 keeps sharp
        /// edges.
        blend: Sp<f64> = 0.0 => Check::at_least(0.0);
        /// How sharp edges are made.
        method: Sp<JoinMethod> = JoinMethod::MinMax;
    }
}

choices! {
    /// How fields are joined without a fillet.
    JoinMethod {
        /// By the lesser or the greater value: edges everywhere where both are equal.
        MinMax = "min-max";
        /// By R-functions, a + b ± √(a² + b²): edges on the surface alone, which blends well with further fields.
        RFunction = "r-function";
    }
}

table! {
    /// Fields added up.
    "field sum" pub FieldSum {
        /// The fields, by name or in place.
        of: Vec<FieldReference> => Check::items(1);
        /// A factor for each; 1 when they are not written.
        weights: Option<Sp<Vec<f64>>>;
        /// What is added.
        constant: Sp<f64> = 0.0;
    }
    checked check
}

table! {
    /// A field perturbed by others: where the field of a bump is negative, its square times `factor` is taken away from the
    /// base, which grows there; at its rim a bump ends smoothly. A bump may be a perturbed field itself.
    "perturbed field" pub PerturbedField {
        /// What is perturbed, by name or in place: mostly a half space, a ball or a quadric.
        base: FieldReference;
        /// The bumps.
        bumps: Vec<Sp<BumpField>> => Check::items(1);
    }
}

table! {
    /// A perturbation.
    "bump" pub BumpField {
        /// Its field, by name or in place: mostly a quadric.
        field: FieldReference;
        /// Factor of its square; negative makes a hollow.
        factor: Sp<f64> = 1.0 => Check::nonzero();
    }
}

table! {
    /// The surface on which a field is 0, closed and without edges but those of the field itself. Where bounds on the field
    /// show how it runs no part of it is missed; where they do not (at sharp edges, of formulas that vary wildly) parts
    /// smaller than `search` may be. A surface that reaches the sides of `within` is an error: an intersection with a body
    /// cuts off what has no end.
    "implicit shape" pub ImplicitShape {
        /// The field, by name or in place.
        field: FieldReference;
        /// The value of the field on the surface; inside it is less.
        level: Sp<f64> = 0.0;
        /// Where the surface is searched, `{ min = [x, y, z], max = [x, y, z] }`. Of bodies and skeletons a box is known;
        /// formulas, sums and half spaces need one.
        within: Option<Within>;
        /// The smallest part that must be found where nothing can be proved; 1/128 of the box when it is not written.
        search: Option<Sp<f64>> => Check::above(0.0);
    }
}

impl SkeletonElement {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let forms = [
            self.point.as_ref().map(|point| point.span),
            self.segment.as_ref().map(|ends| ends.span),
            self.polygon.as_ref().map(|corners| corners.span),
            self.curve.as_ref().map(CurveReference::span),
        ];
        let found: Vec<Span> = forms.into_iter().flatten().collect();
        match found.as_slice() {
            [_] => {}
            [] => {
                let report = Diagnostic::error(Code::NoElement, "this element says no form")
                    .at(span, "nothing to reach from");
                reader.report(report.help("write one of `point`, `segment`, `polygon` and `curve`"));
                return false;
            }
            [first, second, ..] => {
                let report = Diagnostic::error(Code::NoElement, "an element has one form, found two");
                reader.report(report.at(*second, "the second form").also(*first, "the first form"));
                return false;
            }
        }
        let Some(ends) = self.segment.as_ref().filter(|ends| ends.len() != 2) else { return true };
        let message = format!("a segment has 2 points, found {}", ends.len());
        let report = Diagnostic::error(Code::WrongLength, message).at(ends.span, "not two");
        reader.report(report.help("a `curve = { polyline = { points = [...] } }` may have more"));
        false
    }
}

impl FieldSum {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let Some(weights) = self.weights.as_ref().filter(|weights| weights.len() != self.of.len()) else {
            return true;
        };
        let message = format!("`weights` has {} numbers for {} fields", weights.len(), self.of.len());
        reader.report(Diagnostic::error(Code::WrongCount, message).at(weights.span, "one for each field"));
        false
    }
}

impl Read for FieldDefinition {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, "field", reader)?;
        let options = FieldOptions::take(&mut fields, reader);
        let kind = take_kind::<Field>(&mut fields, reader);
        let closed = fields.close(reader);
        match (options, kind, closed) {
            (Some(options), Some(kind), true) => Some(Self { options, kind }),
            _ => None,
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        let doc = "A field: one kind, and beside it the fields that every field has.";
        schemas.object("field", doc, |object, schemas| {
            FieldOptions::describe(object, schemas);
            Field::describe_kinds(object, schemas);
        })
    }
}

//! Names of other definitions, or the definition itself where a name is asked for.

use serde_json::{Value as Json, json};

use crate::language::source::Span;
use crate::language::spec::curve::Curve;
use crate::language::spec::field::FieldDefinition;
use crate::language::spec::kind::take_kind;
use crate::language::spec::map::MapDefinition;
use crate::language::spec::reader::{Fields, Read, Reader};
use crate::language::spec::schema::{Schemas, any_of};
use crate::language::spec::shape::ShapeDefinition;
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Value};

/// The namespaces of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// `[curve.NAME.KIND]`.
    Curve,
    /// `[map.NAME.KIND]`.
    Map,
    /// `[field.NAME.KIND]`.
    Field,
    /// `[shape.NAME.KIND]`.
    Shape,
    /// `[material.NAME]`.
    Material,
    /// `[node.NAME]`.
    Node,
    /// `[skeleton.NAME]`.
    Skeleton,
    /// `[skin.NAME]`.
    Skin,
    /// `[morph.SHAPE]`.
    Morph,
    /// `[clip.NAME]`.
    Clip,
    /// `[collider.NAME]`.
    Collider,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 11] = [
        Self::Curve,
        Self::Map,
        Self::Field,
        Self::Shape,
        Self::Material,
        Self::Node,
        Self::Skeleton,
        Self::Skin,
        Self::Morph,
        Self::Clip,
        Self::Collider,
    ];

    /// The word of headers and messages.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Curve => "curve",
            Self::Map => "map",
            Self::Field => "field",
            Self::Shape => "shape",
            Self::Material => "material",
            Self::Node => "node",
            Self::Skeleton => "skeleton",
            Self::Skin => "skin",
            Self::Morph => "morph",
            Self::Clip => "clip",
            Self::Collider => "collider",
        }
    }
}

/// One definition that uses another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Link {
    /// The definition that uses the other: its family and name.
    pub user: (Family, String),
    /// The definition that is used.
    pub used: (Family, String),
}

/// A name where one definition uses another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Use {
    /// The family in which the name is looked up.
    pub(crate) family: Family,
    /// The name.
    pub(crate) name: String,
    /// Where it is written.
    pub(crate) span: Span,
    /// The definition that uses it.
    pub(crate) user: Option<(Family, String)>,
    /// Whether the span holds a whole text with its quotes, and not a name inside one.
    pub(crate) quoted: bool,
}

/// The curve that a field asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveReference {
    /// By name; the name is defined.
    Named(Sp<String>),
    /// Written in place: `{ circle = { radius = 0.005 } }`.
    Inline(Sp<Box<Curve>>),
}

/// The map that a field asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum MapReference {
    /// By name; the name is defined.
    Named(Sp<String>),
    /// Written in place: `{ noise = { hills = [3, 3] } }`, common fields beside the kind.
    Inline(Sp<Box<MapDefinition>>),
}

/// The field that a field asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldReference {
    /// By name; the name is defined.
    Named(Sp<String>),
    /// Written in place: `{ sphere = { radius = 1 } }`, common fields beside the kind.
    Inline(Sp<Box<FieldDefinition>>),
}

/// The shape that a field asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeReference {
    /// By name; the name is defined.
    Named(Sp<String>),
    /// Written in place: `{ box = { size = [1, 1, 1] } }`, common fields beside the kind.
    Inline(Sp<Box<ShapeDefinition>>),
}

impl CurveReference {
    /// Where it is written.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Named(name) => name.span,
            Self::Inline(curve) => curve.span,
        }
    }
}

impl MapReference {
    /// Where it is written.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Named(name) => name.span,
            Self::Inline(map) => map.span,
        }
    }
}

impl FieldReference {
    /// Where it is written.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Named(name) => name.span,
            Self::Inline(field) => field.span,
        }
    }
}

impl ShapeReference {
    /// Where it is written.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Named(name) => name.span,
            Self::Inline(shape) => shape.span,
        }
    }
}

impl Read for CurveReference {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(name) => Some(Self::Named(named(Family::Curve, name, value.span, reader))),
            Data::Table(_) => {
                let curve = Box::<Curve>::read(value, reader)?;
                Some(Self::Inline(Sp::new(curve, value.span)))
            }
            _ => {
                reader.mismatch(value, "the name of a curve, or a curve in place");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        named_or_inline(Curve::schema(schemas))
    }
}

impl Read for MapReference {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(name) => Some(Self::Named(named(Family::Map, name, value.span, reader))),
            Data::Table(_) => {
                let map = Box::<MapDefinition>::read(value, reader)?;
                Some(Self::Inline(Sp::new(map, value.span)))
            }
            _ => {
                reader.mismatch(value, "the name of a map, or a map in place");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        named_or_inline(MapDefinition::schema(schemas))
    }
}

impl Read for FieldReference {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(name) => Some(Self::Named(named(Family::Field, name, value.span, reader))),
            Data::Table(_) => {
                let field = Box::<FieldDefinition>::read(value, reader)?;
                Some(Self::Inline(Sp::new(field, value.span)))
            }
            _ => {
                reader.mismatch(value, "the name of a field, or a field in place");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        named_or_inline(FieldDefinition::schema(schemas))
    }
}

impl Read for ShapeReference {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        match &value.data {
            Data::String(name) => Some(Self::Named(named(Family::Shape, name, value.span, reader))),
            Data::Table(_) => {
                let shape = Box::<ShapeDefinition>::read(value, reader)?;
                Some(Self::Inline(Sp::new(shape, value.span)))
            }
            _ => {
                reader.mismatch(value, "the name of a shape, or a shape in place");
                None
            }
        }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        named_or_inline(ShapeDefinition::schema(schemas))
    }
}

impl Read for Curve {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let mut fields = Fields::open(value, "curve", reader)?;
        let kind = take_kind::<Self>(&mut fields, reader);
        if fields.close(reader) { kind } else { None }
    }

    fn schema(schemas: &mut Schemas) -> Json {
        schemas.object(
            "curve",
            "A curve of one kind.",
            <Self as crate::language::spec::kind::Kinds>::describe_kinds,
        )
    }
}

/// The name of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialName(pub String);

/// The name of a shape, where a shape in place makes no sense.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeName(pub String);

/// The name of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeName(pub String);

/// The name of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct SkeletonName(pub String);

macro_rules! read_name {
    ($($name:ident: $family:ident = $expected:literal;)+) => {$(
        impl Read for $name {
            fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
                let Data::String(name) = &value.data else {
                    reader.mismatch(value, $expected);
                    return None;
                };
                Some(Self(named(Family::$family, name, value.span, reader).value))
            }

            fn schema(_: &mut Schemas) -> Json {
                json!({ "type": "string" })
            }
        }

        impl std::ops::Deref for $name {
            type Target = str;

            fn deref(&self) -> &str {
                &self.0
            }
        }
    )+};
}

read_name! {
    MaterialName: Material = "the name of a material";
    ShapeName: Shape = "the name of a shape";
    NodeName: Node = "the name of a node";
    SkeletonName: Skeleton = "the name of a skeleton";
}

fn named(family: Family, name: &str, span: Span, reader: &mut Reader<'_>) -> Sp<String> {
    reader.uses(family, name, span);
    Sp::new(name.to_owned(), span)
}

fn named_or_inline(table: Json) -> Json {
    any_of(vec![json!({ "type": "string" }), table])
}

//! The whole of a document, typed.

use indexmap::IndexMap;

use crate::language::source::Span;
use crate::language::spec::assertion::Assertion;
use crate::language::spec::clip::Clip;
use crate::language::spec::collider::Collider;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::curve::Curve;
use crate::language::spec::field::FieldDefinition;
use crate::language::spec::import::Up;
use crate::language::spec::limit::Limits;
use crate::language::spec::lod::Lod;
use crate::language::spec::map::MapDefinition;
use crate::language::spec::material::Material;
use crate::language::spec::morph::Morphs;
use crate::language::spec::node::Node;
use crate::language::spec::output::Output;
use crate::language::spec::reference::{CurveReference, Family, Link, MapReference, ShapeReference};
use crate::language::spec::shape::ShapeDefinition;
use crate::language::spec::skeleton::Skeleton;
use crate::language::spec::skin::Skin;
use crate::language::spec::spanned::Sp;

/// A document with all parameters put in: typed, checked, every name defined, free of cycles.
///
/// Lengths are as written, in the document's unit.
#[derive(Clone, Debug)]
pub struct Spec {
    /// What one unit of length is.
    pub unit: Unit,
    /// The axis that points up in what is written.
    pub up: Up,
    /// How far meshes may lie from true surfaces, in the document's unit.
    pub tolerance: Option<Sp<f64>>,
    /// How far vertices may be from exact motions, in the document's unit.
    pub motion_tolerance: Option<Sp<f64>>,
    /// Facts about the asset, for its metadata.
    pub asset: Asset,
    /// `[output]`.
    pub output: Output,
    /// `[lod]`.
    pub lod: Option<Sp<Lod>>,
    /// `[curve.NAME]`, in the order of the text.
    pub curves: IndexMap<String, Definition<Curve>>,
    /// `[map.NAME]`, in the order of the text.
    pub maps: IndexMap<String, Definition<MapDefinition>>,
    /// `[field.NAME]`, in the order of the text.
    pub fields: IndexMap<String, Definition<FieldDefinition>>,
    /// `[shape.NAME]`, in the order of the text.
    pub shapes: IndexMap<String, Definition<ShapeDefinition>>,
    /// `[material.NAME]`, in the order of the text.
    pub materials: IndexMap<String, Definition<Material>>,
    /// `[node.NAME]`, in the order of the text.
    pub nodes: IndexMap<String, Definition<Node>>,
    /// `[skeleton.NAME]`, in the order of the text.
    pub skeletons: IndexMap<String, Definition<Skeleton>>,
    /// `[skin.NAME]`, in the order of the text.
    pub skins: IndexMap<String, Definition<Skin>>,
    /// `[morph.SHAPE]`, in the order of the text.
    pub morphs: IndexMap<String, Definition<Morphs>>,
    /// `[clip.NAME]`, in the order of the text.
    pub clips: IndexMap<String, Definition<Clip>>,
    /// `[collider.NAME]`, in the order of the text.
    pub colliders: IndexMap<String, Definition<Collider>>,
    /// The shapes that a document without nodes shows: those that no other definition uses.
    pub roots: Vec<String>,
    /// Which definition uses which, each once, sorted.
    pub links: Vec<Link>,
    /// `[assert]`.
    pub asserts: Vec<Assertion>,
    /// `[limits]`, laid under the defaults.
    pub limits: Limits,
}

/// A definition, its name and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition<T> {
    /// The name, where it is first written.
    pub name: Sp<String>,
    /// The header.
    pub span: Span,
    /// What it says.
    pub value: T,
}

choices! {
    /// The unit of every length of a document.
    Unit {
        /// Metres.
        Metre = "m";
        /// Centimetres.
        Centimetre = "cm";
        /// Millimetres.
        Millimetre = "mm";
        /// Inches of 25.4 mm.
        Inch = "in";
        /// Feet of 304.8 mm.
        Foot = "ft";
    }
}

table! {
    /// Facts about the asset, written into it.
    "asset" pub Asset {
        /// Its name; the name of the file when it is not written.
        name: Option<Sp<String>>;
        /// What it is.
        description: Option<Sp<String>>;
    }
}

impl Unit {
    /// The unit in metres.
    #[must_use]
    pub const fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }
}

impl Spec {
    /// All definitions: family, name, and where the name is first written; by families, and in the order of the text.
    pub fn definitions(&self) -> impl Iterator<Item = (Family, &String, Span)> {
        fn of<T>(
            family: Family,
            all: &IndexMap<String, Definition<T>>,
        ) -> impl Iterator<Item = (Family, &String, Span)> {
            all.iter().map(move |(name, definition)| (family, name, definition.name.span))
        }
        let parts = of(Family::Curve, &self.curves)
            .chain(of(Family::Map, &self.maps))
            .chain(of(Family::Field, &self.fields))
            .chain(of(Family::Shape, &self.shapes))
            .chain(of(Family::Material, &self.materials));
        parts
            .chain(of(Family::Node, &self.nodes))
            .chain(of(Family::Skeleton, &self.skeletons))
            .chain(of(Family::Skin, &self.skins))
            .chain(of(Family::Morph, &self.morphs))
            .chain(of(Family::Clip, &self.clips))
            .chain(of(Family::Collider, &self.colliders))
    }

    /// The curve that a reference names or writes; `None` only for a reference of another document.
    #[must_use]
    pub fn curve<'s>(&'s self, reference: &'s CurveReference) -> Option<&'s Curve> {
        match reference {
            CurveReference::Named(name) => self.curves.get(&name.value).map(|definition| &definition.value),
            CurveReference::Inline(curve) => Some(&curve.value),
        }
    }

    /// The map that a reference names or writes; `None` only for a reference of another document.
    #[must_use]
    pub fn map<'s>(&'s self, reference: &'s MapReference) -> Option<&'s MapDefinition> {
        match reference {
            MapReference::Named(name) => self.maps.get(&name.value).map(|definition| &definition.value),
            MapReference::Inline(map) => Some(&map.value),
        }
    }

    /// The shape that a reference names or writes; `None` only for a reference of another document.
    #[must_use]
    pub fn shape<'s>(&'s self, reference: &'s ShapeReference) -> Option<&'s ShapeDefinition> {
        match reference {
            ShapeReference::Named(name) => self.shapes.get(&name.value).map(|definition| &definition.value),
            ShapeReference::Inline(shape) => Some(&shape.value),
        }
    }
}

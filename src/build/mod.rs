//! From what a document says to the exact model.
//!
//! Promise: every definition that the asset needs is built once, however often it is used; all faults are
//! found in one run, each with its place; what is built satisfies the preconditions of the geometry kernels
//! (profiles flat, closed where they must be, on their side of the axis, free of crossings).

mod attribute;
mod bevel;
mod bezier_triangle;
mod bspline;
mod carry;
mod clip;
mod collider;
mod conic;
mod coons;
mod course;
mod curve;
mod deform;
mod displace;
mod dxf;
mod extrude;
mod field;
mod file_state;
mod formula;
mod formula_curve;
mod frames;
mod gltf;
mod height;
mod height_base;
mod implicit;
mod import;
mod joined;
mod loft;
mod map;
mod material;
mod md5;
mod morph;
mod motion_file;
mod moving;
mod node;
mod normal_map;
mod operation;
mod optics;
mod overlap;
mod parametric;
mod part;
mod patch;
mod path;
mod perturbed;
mod picture;
mod polygon;
mod primitive;
mod profile;
mod property;
mod quadric;
mod reach;
mod ruled;
mod scaling;
mod scene;
mod shape;
mod skeleton;
mod skin;
mod solid;
mod spline;
mod split;
mod stage;
mod subdivide;
mod svg;
mod sweep;
mod trimmed;
mod turned;
mod vertex_color;
mod view;

use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use indexmap::IndexMap;

use crate::geometry::curve::AnyCurve;
use crate::geometry::field::AnyField;
use crate::geometry::map::GridField;
use crate::language::diagnostic::{Diagnostic, Severity};
use crate::language::source::{Files, Span};
use crate::language::spec::{ParameterValue, Sp, Spec, Up};
use crate::model::{Frame, ImageHandle, Limits, MaterialHandle, Model, ShapeHandle};

/// A model, and where its parts are written.
#[derive(Clone, Debug)]
pub struct Built {
    /// The model.
    pub model: Model,
    /// Where each shape is defined, by handle.
    pub places: Vec<Span>,
    /// Where the faces of each shape are written, by handle; none for shapes whose faces are not.
    pub faces: Vec<Vec<Span>>,
    /// Where each skin is defined, by its index.
    pub skin_places: Vec<Span>,
    /// Where each clip is defined, by its index.
    pub clip_places: Vec<Span>,
    /// Where each state of a shape is defined, by its index.
    pub morph_places: Vec<Span>,
    /// The shapes by their names in the document.
    pub shapes: IndexMap<String, ShapeHandle>,
    /// Where each collider is defined, by its index.
    pub collider_places: Vec<Span>,
    /// What a person should know though nothing is wrong.
    pub warnings: Vec<Diagnostic>,
}

/// What a document makes with other values of some parameters.
#[derive(Clone, Debug)]
pub struct StateModel {
    /// The values.
    pub with: IndexMap<String, Sp<ParameterValue>>,
    /// What they make.
    pub built: Built,
}

/// Builds the model of a document; `name` is the asset's unless the document states one. `states` are those that its
/// morphs ask for.
///
/// # Errors
/// All faults of the document's geometry and of the files it names.
pub fn model(
    spec: &Spec,
    name: &str,
    files: &dyn Files,
    states: Vec<StateModel>,
) -> Result<Built, Vec<Diagnostic>> {
    let mut builder = Builder::new(spec, name, files);
    builder.build_shapes();
    builder.build_motion(&states);
    builder.model.states = states.into_iter().map(|state| state.built.model).collect();
    builder.finish()
}

/// Builds what a document makes as a state: its shapes, without what shows and moves them.
///
/// # Errors
/// As those of [`model`].
pub fn state(spec: &Spec, name: &str, files: &dyn Files) -> Result<Built, Vec<Diagnostic>> {
    let mut builder = Builder::new(spec, name, files);
    builder.build_shapes();
    builder.finish()
}

/// Builds one curve of a document, with all its parts; none when there is no such curve.
///
/// # Errors
/// All faults of that curve and of those it is made from.
pub fn curve(spec: &Spec, name: &str, files: &dyn Files) -> Result<Option<Vec<AnyCurve>>, Vec<Diagnostic>> {
    let mut builder = Builder::new(spec, name, files);
    let curve = builder.named_parts(name);
    if builder.reports.is_empty() { Ok(curve) } else { Err(builder.reports) }
}

/// The model in the making. A definition that failed is `None` in its map and is not tried again.
struct Builder<'a> {
    spec: &'a Spec,
    files: &'a dyn Files,
    model: Model,
    places: Vec<Span>,
    faces: Vec<Vec<Span>>,
    /// Where the faces of the shape that is being built are written.
    face_places: Vec<Span>,
    /// Where each skin is defined.
    skin_places: Vec<Span>,
    /// Where each clip is defined.
    clip_places: Vec<Span>,
    /// Where each state of a shape is defined.
    morph_places: Vec<Span>,
    /// Where each collider is defined.
    collider_places: Vec<Span>,
    /// Nodes that look at something, those that carry others first.
    aims: Vec<view::Aimed>,
    reports: Vec<Diagnostic>,
    shapes: IndexMap<String, Option<ShapeHandle>>,
    materials: IndexMap<String, Option<MaterialHandle>>,
    images: IndexMap<String, Option<ImageHandle>>,
    from_files: file_state::FromFiles,
    curves: IndexMap<String, Option<Vec<AnyCurve>>>,
    maps: IndexMap<String, Option<Arc<GridField>>>,
    fields: IndexMap<String, Option<AnyField>>,
    /// The definition that is being built, and whether what is built now only stands inside it.
    within: Option<(String, bool)>,
}

impl<'a> Builder<'a> {
    fn new(spec: &'a Spec, name: &str, files: &'a dyn Files) -> Self {
        let name = spec.asset.name.as_ref().map_or_else(|| name.to_owned(), |name| name.value.clone());
        let model = Model {
            name,
            frame: Frame { unit: spec.unit.metres(), z_up: spec.up == Up::Z },
            tolerance: spec.tolerance.map(|tolerance| tolerance.value),
            shapes: Vec::new(),
            materials: Vec::new(),
            normal_maps: Vec::new(),
            images: Vec::new(),
            nodes: Vec::new(),
            skeletons: Vec::new(),
            skins: Vec::new(),
            clips: Vec::new(),
            morphs: Vec::new(),
            states: Vec::new(),
            colliders: Vec::new(),
            attributes: Vec::new(),
            motion_tolerance: spec.motion_tolerance.map(|tolerance| tolerance.value * spec.unit.metres()),
            paths: Vec::new(),
            limits: Limits {
                triangles: spec.limits.triangles,
                vertices: spec.limits.vertices,
                memory: spec.limits.memory,
            },
        };
        Self {
            spec,
            files,
            model,
            places: Vec::new(),
            faces: Vec::new(),
            face_places: Vec::new(),
            skin_places: Vec::new(),
            clip_places: Vec::new(),
            morph_places: Vec::new(),
            collider_places: Vec::new(),
            aims: Vec::new(),
            reports: Vec::new(),
            shapes: IndexMap::new(),
            materials: IndexMap::new(),
            images: IndexMap::new(),
            from_files: file_state::FromFiles::default(),
            curves: IndexMap::new(),
            maps: IndexMap::new(),
            fields: IndexMap::new(),
            within: None,
        }
    }

    fn build_shapes(&mut self) {
        let spec = self.spec;
        // Every definition is built, used or not, so that no fault hides.
        for name in spec.materials.keys() {
            self.material(name);
        }
        for name in spec.curves.keys() {
            self.named_parts(name);
        }
        for name in spec.maps.keys() {
            self.named_map(name);
        }
        for name in spec.fields.keys() {
            self.named_field(name);
        }
        for name in spec.shapes.keys() {
            self.named_shape(name);
        }
    }

    fn build_motion(&mut self, states: &[StateModel]) {
        self.skeletons();
        self.nodes();
        self.scenes();
        self.check_shown_nodes();
        let played = self.frames();
        self.attach_nodes();
        self.aim_nodes();
        self.skins();
        self.attributes();
        self.morphs(states);
        self.clips();
        self.sequence_clips(played);
        self.colliders();
    }

    fn finish(self) -> Result<Built, Vec<Diagnostic>> {
        let Self { model, places, faces, skin_places, clip_places, .. } = self;
        let Self { morph_places, collider_places, reports, shapes, .. } = self;
        if reports.iter().any(|report| report.severity == Severity::Error) {
            return Err(reports);
        }
        let shapes = shapes.into_iter().filter_map(|(name, handle)| Some((name, handle?))).collect();
        let warnings = reports;
        Ok(Built {
            model,
            places,
            faces,
            skin_places,
            clip_places,
            morph_places,
            collider_places,
            shapes,
            warnings,
        })
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.reports.push(diagnostic);
    }
}

/// The map that scales, then turns about x, y and z, then moves.
fn placement(scale: DVec3, rotate: DVec3, at: DVec3) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_quat(rotation(rotate)) * DMat3::from_diagonal(scale), translation: at }
}

/// The rotation by degrees about x, then y, then z (fixed axes).
fn rotation(degrees: DVec3) -> DQuat {
    if degrees == DVec3::ZERO {
        return DQuat::IDENTITY;
    }
    let about = |axis: DVec3, angle: f64| {
        let (sin, cos) = crate::geometry::number::sin_cos_degrees(angle / 2.0);
        DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
    };
    about(DVec3::Z, degrees.z) * about(DVec3::Y, degrees.y) * about(DVec3::X, degrees.x)
}

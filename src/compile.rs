//! The pipeline, one line a stage.

mod assertion;
mod baked;
mod beyond;
mod collider;
mod engine;
mod exact;
mod file;
mod joint;
mod kept;
mod lod;
mod motion;
mod notice;
mod origin;
mod placement;
mod planned;
mod profile;
mod solid;
mod state;
mod subdivide;
mod texture;

use beyond::{beyond_bound, beyond_tolerance};
pub use exact::Source;
use file::{file_name, same_file};
pub use joint::LimitedJoint;
use notice::{noticed, too_coarse};
pub use origin::Origins;
pub use planned::{estimated_memory, outputs};
pub(crate) use profile::profile_of;
use profile::profiles;

use std::sync::Arc;

use crate::build::{self, Built};
use crate::geometry::curve::AnyCurve;
use crate::geometry::tessellate::{DeformError, TessellateError};
use crate::gltf::Profile;
use crate::language::Document;
use crate::language::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::language::source::{Files, Span};
use crate::language::spec::{Assertion, Spec};
use crate::model::{Model, ShapeHandle};
use crate::optimize::{Order, Rounding};
use crate::realize::{self, Keep, Memo, RealizeError, Realized, WorkLog};
use crate::report::{About, Report};
use crate::scene::SceneError;
use crate::{gltf, optimize, report, scene};

/// What to compile of a document, and how.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The variant; none is the document itself.
    pub variant: Option<String>,
    /// Parameters and what they shall be.
    pub overrides: Vec<(String, String)>,
    /// Name of the asset where the document states none; the output is this name and `.glb`.
    pub name: String,
    /// The document's path from the project root, for the report.
    pub path: String,
    /// Leave the report out. Assertions then cannot be checked, and are not.
    pub no_report: bool,
    /// Measure the deviation by dense sampling.
    pub measure: bool,
    /// Keep where the triangles of the file are defined.
    pub origins: bool,
    /// Keep how far each triangle is from the exact surface.
    pub deviations: bool,
    /// For a picture of the surfaces themselves: what is shown is cut to within so many metres, whatever the document says,
    /// where it is not drawn as a field.
    pub exact: Option<f64>,
    /// Be quick and coarse: tolerances are [`DRAFT`] times as wide, there are no levels of detail, lightmaps and occlusion, and
    /// assertions are not checked.
    pub draft: bool,
    /// Where realized shapes are kept from one bake to the next.
    pub keep: Option<Arc<dyn Keep>>,
    /// Where it is noted what each shape took.
    pub log: Option<Arc<WorkLog>>,
    /// Let pictures stand in files of their own where the document says so. Who looks at one file alone leaves them in it.
    pub beside: bool,
    /// For whom files are; where empty, for whom the document says, and without that, for all.
    pub profiles: Vec<Profile>,
}

/// How much wider the tolerances of a draft are.
pub const DRAFT: f64 = 8.0;

/// One asset.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The `.glb` file.
    pub bytes: Vec<u8>,
    /// Name of the file.
    pub file: String,
    /// Names and bytes of the pictures that stand beside it.
    pub pictures: Vec<(String, Vec<u8>)>,
    /// For whom it is.
    pub profile: Profile,
    /// The level of detail that it shows, 0 for the finest.
    pub level: usize,
    /// What is known of it.
    pub report: Option<Report>,
    /// Where its triangles are defined, when that was asked for.
    pub origins: Option<Origins>,
    /// When that was asked for: for each mesh of the file how far its triangles are from the exact surface, metres, at the
    /// places of [`FAN`](crate::geometry::number::FAN); none for a mesh of surfaces that have no form of their own.
    pub deviations: Vec<Option<Vec<[f32; 13]>>>,
    /// Its joints that do not turn freely.
    pub joints: Vec<LimitedJoint>,
    /// When the surfaces themselves were asked for: how that of each mesh of the file is known.
    pub sources: Vec<Source>,
    /// What a person should know though nothing is wrong.
    pub warnings: Diagnostics,
}

impl Compiled {
    /// The name and the text of its report, where there is one.
    ///
    /// # Errors
    /// None that is known: a report is plain data.
    pub fn report_file(&self) -> serde_json::Result<Option<(String, Vec<u8>)>> {
        let Some(report) = &self.report else { return Ok(None) };
        let mut text = serde_json::to_vec_pretty(report)?;
        text.push(b'\n');
        Ok(Some((format!("{}.report.json", self.file.trim_end_matches(".glb")), text)))
    }
}

/// Compiles one asset of a document, for the first of its profiles.
///
/// # Errors
/// Everything that is wrong with the document, or the assertions that do not hold.
pub fn compile(document: &Document, files: &dyn Files, options: &Options) -> Result<Compiled, Diagnostics> {
    let compiled = compile_profiles(document, files, options)?;
    let first = compiled.into_iter().next();
    Ok(first.expect("a document has at least one profile"))
}

/// Compiles one asset of a document for each of its profiles, and for each level of detail where these stand in files of their
/// own; at least one. Warnings stand with the first file that they are true of. Surfaces are cut into triangles once.
///
/// # Errors
/// Everything that is wrong with the document, or the assertions that do not hold.
pub fn compile_profiles(
    document: &Document,
    files: &dyn Files,
    options: &Options,
) -> Result<Vec<Compiled>, Diagnostics> {
    let fail = |list: Vec<Diagnostic>| document.diagnostics(list);
    let (spec, mut warnings) = document.spec(options.variant.as_deref(), &options.overrides)?;
    let mut built = state::model(document, &spec, files, options)?;
    if let Some(tolerance) = options.exact {
        exact::refine(&mut built, tolerance);
    }
    warnings.extend(built.warnings.iter().cloned());
    let profiles = profiles(&spec, options);
    if let Some(same) = same_file(document, &spec, &profiles) {
        return Err(fail(vec![same]));
    }
    let memo = Memo::new(&built.model, options.keep.as_deref(), options.log.as_deref());
    let made = Made { document, spec: &spec, built: &built, options, memo: memo.as_ref() };
    // One scene for floats, and one for whole numbers.
    let mut scenes: [Option<Surfaces>; 2] = [None, None];
    let mut said: Vec<Diagnostic> = Vec::new();
    let mut all = Vec::with_capacity(profiles.len());
    for (place, profile) in profiles.iter().enumerate() {
        let kept = &mut scenes[usize::from(profile.is_quantized())];
        let surfaces = match kept.take() {
            Some(surfaces) => surfaces,
            None => {
                let (surfaces, found) = made.surfaces(*profile).map_err(fail)?;
                // What is true of floats is said once, though whole numbers have it too.
                warnings.extend(found.iter().filter(|new| !said.contains(new)).cloned());
                said.extend(found);
                surfaces
            }
        };
        if profiles[place + 1..].iter().any(|other| other.is_quantized() == profile.is_quantized()) {
            *kept = Some(surfaces.clone());
        }
        all.extend(made.files(surfaces, *profile, std::mem::take(&mut warnings)).map_err(fail)?);
    }
    Ok(all)
}

/// What all files of an asset are made of.
struct Made<'a> {
    document: &'a Document,
    spec: &'a Spec,
    built: &'a Built,
    options: &'a Options,
    memo: Option<&'a Memo<'a>>,
}

/// Surfaces as triangles, and the part of the tolerance that is left for rounding.
#[derive(Clone)]
struct Surfaces {
    realized: Realized,
    share: f64,
}

impl Made<'_> {
    /// Whether parts of one material stay apart.
    fn apart(&self) -> bool {
        !self.spec.output.merge.value
    }

    /// The surfaces for a profile, with what there is to say of them. Where rounding takes a part of the tolerance, they are
    /// kept within the rest of it: an eighth goes to rounding, and more where the grid is coarser.
    fn surfaces(&self, profile: Profile) -> Result<(Surfaces, Vec<Diagnostic>), Vec<Diagnostic>> {
        let (mut surfaces, mut found) = self.finest(profile)?;
        if self.options.exact.is_none() && !self.options.draft {
            found.extend(lod::add(self, &mut surfaces)?);
        }
        if !self.options.draft {
            baked::bake(self, &mut surfaces)?;
        }
        Ok((surfaces, found))
    }

    fn finest(&self, profile: Profile) -> Result<(Surfaces, Vec<Diagnostic>), Vec<Diagnostic>> {
        if !profile.is_quantized() {
            return self.surfaces_within(0.0);
        }
        let made = self.surfaces_within(optimize::GRID_SHARE)?;
        // A little more, for other triangles end elsewhere.
        let needed = optimize::grid_share(&made.0.realized.scene) * 1.001;
        if needed > optimize::GRID_SHARE && needed <= optimize::MOST_GRID_SHARE {
            return self.surfaces_within(needed);
        }
        Ok(made)
    }

    fn surfaces_within(&self, share: f64) -> Result<(Surfaces, Vec<Diagnostic>), Vec<Diagnostic>> {
        let built = self.built;
        let coarser = 1.0 - share;
        let made = |coarser: f64| {
            let options = realize::Options {
                coarser,
                memo: self.memo,
                apart: self.apart(),
                ..realize::Options::default()
            };
            realize::scene(&built.model, &options)
        };
        // What cannot be so coarse as a draft may still be as it is written.
        let realized = match self.options.draft.then(|| made(DRAFT * coarser)) {
            Some(Ok(realized)) => Ok(realized),
            _ => made(coarser),
        };
        let mut realized = realized.map_err(|errors| refusals(built, errors))?;
        for geometry in &mut realized.scene.geometries {
            geometry.tolerance = geometry.tolerance.map(|tolerance| tolerance / coarser);
            for target in &mut geometry.targets {
                target.tolerance = target.tolerance.map(|tolerance| tolerance / coarser);
            }
        }
        let Realized { scene, shapes, loose, unseen, notes, .. } = &realized;
        let mut found: Vec<Diagnostic> =
            notes.iter().filter_map(|(shape, note)| noticed(built, *shape, note)).collect();
        found.extend(loose.iter().map(|one| motion::loose(built, one)));
        found.extend(unseen.iter().map(|(clip, material)| motion::unseen(built, *clip, material)));
        found.extend(beyond_tolerance(scene, shapes, built));
        found.extend(state::beyond_tolerance(scene, shapes, built));
        Ok((Surfaces { realized, share }, found))
    }

    /// The files of a profile, the first with these warnings and what there is to say of all.
    fn files(
        &self,
        surfaces: Surfaces,
        profile: Profile,
        mut warnings: Vec<Diagnostic>,
    ) -> Result<Vec<Compiled>, Vec<Diagnostic>> {
        let Self { built, spec, .. } = *self;
        let Surfaces { realized: Realized { mut scene, mut shapes, notes, .. }, share } = surfaces;
        let (rounding, order) = match profile {
            profile if profile.is_compressed() => (Rounding::Coarse(share), Order::Packing),
            profile if profile.is_quantized() => (Rounding::Fine(share), Order::Drawing),
            _ => (Rounding::Single, Order::Drawing),
        };
        if let Err(coarse) = optimize::run(&mut scene, rounding, order) {
            warnings.push(too_coarse(profile, &coarse, spec));
        }
        realize::normal_maps(&built.model, &mut scene, &shapes).map_err(|errors| refusals(built, errors))?;
        texture::fit(&mut scene, spec, profile)?;
        lod::settle(&mut scene, &mut shapes);
        realize::attributes(&built.model, &mut scene, &shapes).map_err(|errors| refusals(built, errors))?;
        // What encloses a shape encloses its written places.
        let coarser =
            realize::Options { coarser: 1.0 - share, memo: self.memo, ..realize::Options::default() };
        let colliders = realize::colliders(&built.model, &coarser, &shapes, &scene);
        scene.colliders = colliders.map_err(|errors| refusals(built, errors))?;
        collider::hold(&mut scene, engine::collider_form(profile, spec));
        warnings.extend(collider::rough(built, &scene));
        warnings.extend(engine::unread(profile, spec));
        let placement = placement::placement(&scene, &built.model.frame, spec, profile);
        let mut scenes = lod::files(scene, engine::level_form(profile, spec));
        if let Some(placement) = placement {
            scenes.iter_mut().for_each(|scene| placement.place(scene));
        }
        if profile.draws_instances() {
            scenes.iter_mut().for_each(optimize::fold_copies);
        }
        let file = |(level, scene)| {
            self.file(scene, (&shapes, &notes), (profile, level), std::mem::take(&mut warnings))
        };
        scenes.into_iter().enumerate().map(file).collect()
    }

    /// One file, with these warnings and what there is to say of it alone.
    fn file(
        &self,
        scene: scene::Scene,
        (shapes, notes): (&[ShapeHandle], &[(ShapeHandle, realize::Note)]),
        (profile, level): (Profile, usize),
        mut warnings: Vec<Diagnostic>,
    ) -> Result<Compiled, Vec<Diagnostic>> {
        let Self { built, options, .. } = *self;
        let checked = scene::check::check(&scene).map_err(|error| vec![unwritable(&error, built)])?;
        let file = file_name(options, profile, level);
        let form = gltf::Form {
            profile,
            anchors: options.measure || options.origins || options.deviations,
            beside: (options.beside && texture::beside(self.spec, profile))
                .then(|| file.trim_end_matches(".glb").to_owned()),
        };
        let written = gltf::write(checked, &form);
        let sources =
            if options.exact.is_some() { exact::sources(built, &scene, shapes) } else { Vec::new() };
        let joints = joint::limited(&built.model, &scene);
        let meshes: Vec<usize> = scene.meshes.iter().map(|mesh| mesh.geometry).collect();
        // From here on the bytes speak for themselves; the scene's memory is needed no more.
        drop(scene);
        let written = written.map_err(|error| {
            vec![Diagnostic::error(Code::LimitPassed, error.to_string()).at(Span::NONE, "")]
        })?;
        let report = if options.no_report {
            None
        } else {
            let about = About {
                spec: &options.path,
                variant: options.variant.as_deref(),
                profile,
                file: &file,
                measure: options.measure,
                notes,
            };
            // A document speaks of the finest level.
            let speaks = level == 0 && !options.draft;
            let asserts = if speaks { self.spec.asserts.as_slice() } else { &[] };
            let report = measured(&written, &built.model, shapes, &about, asserts)?;
            warnings.extend(beyond_bound(&report, shapes, built));
            Some(report)
        };
        let deviations = if options.deviations {
            let maps = report::deviation_maps(&written, &built.model, shapes).map_err(unmeasured)?;
            meshes.iter().map(|geometry| maps[*geometry].clone()).collect()
        } else {
            Vec::new()
        };
        let origins = options.origins.then(|| Origins::new((built, shapes), meshes, &written));
        let warnings = self.document.diagnostics(warnings);
        let (bytes, pictures) = (written.bytes, written.pictures);
        Ok(Compiled {
            bytes,
            file,
            pictures,
            profile,
            level,
            report,
            origins,
            deviations,
            joints,
            sources,
            warnings,
        })
    }
}

/// Builds the exact model of a document, for `sample`.
///
/// # Errors
/// Everything that is wrong with the document.
pub fn model(document: &Document, files: &dyn Files, options: &Options) -> Result<Model, Diagnostics> {
    let (spec, _) = document.spec(options.variant.as_deref(), &options.overrides)?;
    state::model(document, &spec, files, options).map(|built| built.model)
}

/// The curve of a name with all its parts, for `sample`; none when there is no such curve.
///
/// # Errors
/// Everything that is wrong with the document.
pub fn curve_parts(
    document: &Document,
    files: &dyn Files,
    options: &Options,
    name: &str,
) -> Result<Option<Vec<AnyCurve>>, Diagnostics> {
    let (spec, _) = document.spec(options.variant.as_deref(), &options.overrides)?;
    build::curve(&spec, name, files).map_err(|list| document.diagnostics(list))
}

/// The curve of a name; of one that has several parts the first.
///
/// # Errors
/// Everything that is wrong with the document.
pub fn curve(
    document: &Document,
    files: &dyn Files,
    options: &Options,
    name: &str,
) -> Result<Option<AnyCurve>, Diagnostics> {
    let parts = curve_parts(document, files, options, name)?;
    Ok(parts.and_then(|parts| parts.into_iter().next()))
}

fn place(built: &Built, shape: ShapeHandle) -> Span {
    built.places.get(shape.0 as usize).copied().unwrap_or(Span::NONE)
}

fn refusals(built: &Built, errors: Vec<(ShapeHandle, RealizeError)>) -> Vec<Diagnostic> {
    errors.into_iter().map(|(shape, error)| refusal(built, shape, &error)).collect()
}

fn refusal(built: &Built, shape: ShapeHandle, error: &RealizeError) -> Diagnostic {
    if let RealizeError::Solid { shape, part, fault } = error {
        return solid::refused(built, *shape, *part, fault);
    }
    if let RealizeError::Subdivide { shape, cage, fault } = error {
        return subdivide::refused(built, *shape, *cage, fault);
    }
    let known = || motion::refused(built, shape, error).or_else(|| state::refused(built, shape, error));
    if let Some(report) = collider::refused(built, error).or_else(known) {
        return report;
    }
    let name = &built.model.shape(shape).name;
    let (code, help) = match error {
        RealizeError::Limit { .. }
        | RealizeError::Together { .. }
        | RealizeError::Tessellate(TessellateError::TooMany { .. }) => (
            Code::LimitPassed,
            "write a coarser `tolerance`, fewer `segments`, or fewer copies; `[limits]` can only be lowered here",
        ),
        RealizeError::Tessellate(TessellateError::Cap { .. }) => (
            Code::BadHole,
            "holes must lie inside the outline and apart from each other; a finer `tolerance` keeps them apart",
        ),
        RealizeError::Tessellate(TessellateError::Tangled) => (
            Code::TangledLines,
            "cut it off where the lines that bound it lie further apart, or write a finer `tolerance`",
        ),
        RealizeError::Tessellate(TessellateError::TooNarrow { .. }) => {
            (Code::TooNarrow, "write a smaller `bevel` or `draft`")
        }
        RealizeError::Tessellate(TessellateError::NoArea) => {
            (Code::NoArea, "a finer `tolerance` or more `segments` keep the outline open")
        }
        RealizeError::Tessellate(TessellateError::NoSurface) => {
            (Code::NoFieldSurface, "move `within` to where the surface lies, or change the level")
        }
        RealizeError::Tessellate(TessellateError::NoValue { .. }) => {
            (Code::FormulaValue, "let `within` leave that place out, or say with `if` what holds there")
        }
        RealizeError::Tessellate(TessellateError::LeavesBox { .. }) => (
            Code::LeavesBox,
            "make `within` larger, or cut the field off by an `intersection` with a body inside of it",
        ),
        RealizeError::Tessellate(TessellateError::Unsound { .. }) => (
            Code::UnsoundSurface,
            "let its parts overlap or lie apart, join them with a `blend`, or make each a shape of its own and join those as solids",
        ),
        RealizeError::Tessellate(TessellateError::TooMuchWork) => (
            Code::TooMuchWork,
            "write a coarser `tolerance` or `search`, a smaller `within`, or a field of fewer parts",
        ),
        RealizeError::Tessellate(TessellateError::BelowBase { .. }) => {
            (Code::BelowBase, "write a lower `base`, or raise the heights with `range`")
        }
        RealizeError::Tessellate(TessellateError::BelowLevel { .. }) => {
            (Code::BelowBase, "write a lower `base`, or raise the heights with `range`")
        }
        RealizeError::Tessellate(TessellateError::TornSeam { .. }) => (
            Code::TornHeights,
            "write another `projection`, a map whose borders agree where the texture has a seam, or a `formula` without jumps",
        ),
        RealizeError::NoColor { .. }
        | RealizeError::NoAttribute { .. }
        | RealizeError::Tessellate(TessellateError::NoHeight { .. }) => {
            (Code::FormulaValue, "say with `if` what holds there")
        }
        RealizeError::Tessellate(TessellateError::CrossesItself { .. }) => (
            Code::DeepHeights,
            "lower the heights with `range`: inward they must stay above the centers of curvature, and what lies opposite must not be reached",
        ),
        RealizeError::Tessellate(TessellateError::NothingKept) => {
            (Code::NothingKept, "write other thresholds: all masks must hold at once, over some area")
        }
        RealizeError::Deform(DeformError::Folds { .. }) => (
            Code::FoldsOver,
            "bend less, or over a greater length, or a thinner shape; `around` moves the axis",
        ),
        RealizeError::Deform(DeformError::TooLong { .. }) => {
            (Code::LongerThanPath, "write `stretch = true`, another `from`, or a longer path")
        }
        RealizeError::Deform(_) => {
            (Code::NoLength, "write another `axis`, or `from` and `to` inside the shape")
        }
        RealizeError::FlatCollider { .. } => (Code::FlatCollider, "see its collider"),
        RealizeError::ColliderParts { .. } => (Code::NoParts, "see its collider"),
        RealizeError::Unweighted { .. } | RealizeError::SkinnedWire { .. } => {
            (Code::Unweighted, "see its skin")
        }
        RealizeError::Unseen { .. } => (Code::UnseenBones, "see its skin"),
        RealizeError::MorphedWire | RealizeError::Topology { .. } | RealizeError::State { .. } => {
            (Code::BadMorph, "see its states")
        }
        RealizeError::Solid { .. } => (Code::NoSolid, "see the parts of it"),
        RealizeError::Subdivide { .. } => (Code::BadCage, "see its cage"),
        RealizeError::NormalMapUnused => (
            Code::NormalMap,
            "let a node show the shape by itself, with its own material, or leave `bake-normal-map` out",
        ),
        RealizeError::NormalMapPlace { .. } => (
            Code::NormalMap,
            "displace a shape whose texture coordinates cover the picture once, as those of `sphere`, `revolve`, `plane` and surfaces do",
        ),
        RealizeError::Polygons(_) => (Code::BadMesh, "check the indices of the faces"),
    };
    Diagnostic::error(code, format!("shape `{name}` cannot be made: {error}"))
        .at(place(built, shape), "this shape")
        .help(help)
}

fn unwritable(error: &SceneError, built: &Built) -> Diagnostic {
    let named = |name: &String| built.model.shapes.iter().position(|shape| shape.name == *name);
    let (code, shape) = match error {
        SceneError::NoTriangle(name) => (Code::NothingToShow, named(name)),
        SceneError::TooLarge(name) => (Code::LimitPassed, named(name)),
        SceneError::NoArea(name) | SceneError::NoLength(name) => (Code::NoArea, named(name)),
        SceneError::TexturedWire(name, _) => (Code::TexturedWire, named(name)),
        SceneError::NoUv(name, _) => (Code::Conflict, named(name)),
        SceneError::Animation(..) | SceneError::Skin(..) | SceneError::Collider(..) => {
            (Code::NotFinite, None)
        }
        SceneError::Lightmap(name) => (Code::NoLightmap, named(name)),
        SceneError::Morph(name, ..) => (Code::NotFinite, named(name)),
        SceneError::NotFinite(name) | SceneError::NotUnit(name, _) => (Code::NotFinite, named(name)),
        _ => (Code::NothingToShow, None),
    };
    let span = shape.and_then(|index| built.places.get(index).copied()).unwrap_or(Span::NONE);
    let report = Diagnostic::error(code, error.to_string()).at(span, "this shape");
    if let SceneError::NoUv(..) = error {
        report.help("leave `uv = \"none\"` out, or give it a material without textures")
    } else if let SceneError::TexturedWire(..) = error {
        report.help(
            "give it a material with a plain color, or draw a thin profile along its curves with `sweep`",
        )
    } else {
        report
    }
}

fn unmeasured(error: report::ReportError) -> Vec<Diagnostic> {
    let message = format!("the written file cannot be read back: {error}");
    let report = Diagnostic::error(Code::NothingToShow, message).at(Span::NONE, "");
    vec![report.help("this is a bug of Kiln; please report it with the document")]
}

fn measured(
    written: &gltf::Written,
    model: &Model,
    shapes: &[ShapeHandle],
    about: &About<'_>,
    asserts: &[Assertion],
) -> Result<Report, Vec<Diagnostic>> {
    let mut report = report::measure(written, model, shapes, about).map_err(unmeasured)?;
    let mut held = Vec::new();
    let mut failed = Vec::new();
    for assertion in asserts {
        match assertion::assert(&report, assertion) {
            Ok(check) => held.push(check),
            Err(diagnostic) => failed.push(*diagnostic),
        }
    }
    report.assertions = held;
    if failed.is_empty() { Ok(report) } else { Err(failed) }
}

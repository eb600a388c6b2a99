//! What engines read of a file: the forms that a profile takes where the document does not say, and what is told where an
//! engine cannot take what the document asks for.
//!
//! Sources: Godot Engine documentation, Node type customization using name suffixes, 4.5; Unity glTFast documentation,
//! Features; Unreal Engine API, `GLTFCore`; the loaders' own sources, 2026.

use crate::gltf::Profile;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Clip, ColliderForm, Definition, LodForm, MotionPath, ShapeDefinition, Spec};

/// How levels of detail stand in the files of a profile: as the document says, else by the extension where that is read or the
/// file is for everyone, and in files of their own for engines that take one level a file.
pub(super) fn level_form(profile: Profile, spec: &Spec) -> LodForm {
    let Some(lod) = &spec.lod else { return LodForm::MsftLod };
    let own = match profile.engine() {
        None => LodForm::MsftLod,
        Some(_) if reads_levels(profile, LodForm::MsftLod) => LodForm::MsftLod,
        Some(_) => LodForm::Files,
    };
    lod.value.form.as_ref().map_or(own, |form| form.value)
}

/// How colliders stand in the files of a profile: as the document says, else as the engine reads them.
pub(super) fn collider_form(profile: Profile, spec: &Spec) -> ColliderForm {
    let own = match profile {
        Profile::Godot => ColliderForm::Godot,
        Profile::Unreal => ColliderForm::Unreal,
        _ => ColliderForm::Extras,
    };
    spec.output.colliders.as_ref().map_or(own, |form| form.value)
}

/// Whether an engine shows one level at a time of those in such a form. `three.js` does so with a plugin.
fn reads_levels(profile: Profile, form: LodForm) -> bool {
    match form {
        LodForm::Files => true,
        LodForm::MsftLod => {
            profile.engine().is_none() || matches!(profile, Profile::Three | Profile::Babylon)
        }
        LodForm::Nodes => profile.engine().is_none(),
    }
}

fn reads_colliders(profile: Profile, form: ColliderForm) -> bool {
    match form {
        ColliderForm::Extras => !matches!(profile, Profile::Godot | Profile::Unreal),
        ColliderForm::Omi => profile.engine().is_none() || profile == Profile::Godot,
        ColliderForm::Godot => profile.engine().is_none() || profile == Profile::Godot,
        ColliderForm::Unreal => profile.engine().is_none() || profile == Profile::Unreal,
    }
}

/// What the engine of a profile will not take as the document means it.
pub(super) fn unread(profile: Profile, spec: &Spec) -> Vec<Diagnostic> {
    let Some(engine) = profile.engine() else { return Vec::new() };
    let mut found = Vec::new();
    if let Some(form) = spec.lod.as_ref().and_then(|lod| lod.value.form.as_ref())
        && !reads_levels(profile, form.value)
    {
        let shown = match form.value {
            LodForm::Nodes => "shows all of them at once",
            _ => "shows the finest alone",
        };
        let message =
            format!("{engine} reads no levels of detail of the form \"{}\": it {shown}", form.text());
        found.push(
            Diagnostic::warning(Code::EngineLevels, message)
                .at(form.span, "this form")
                .help("leave `form` out: each profile then has the form that its engine takes"),
        );
    }
    if let Some(form) = &spec.output.colliders
        && !spec.colliders.is_empty()
        && !reads_colliders(profile, form.value)
    {
        let message = format!("{engine} makes no bodies of colliders of the form \"{}\"", form.text());
        found.push(
            Diagnostic::warning(Code::EngineColliders, message)
                .at(form.span, "this form")
                .help("leave `colliders` out: each profile then has the form that its engine takes"),
        );
    }
    found.extend(unread_properties(profile, engine, spec));
    found.extend(unread_attributes((profile, engine), spec));
    found.extend(unread_materials((profile, engine), spec));
    if profile == Profile::Godot {
        found.extend(changed_by_godot(spec));
    }
    found
}

/// Tracks of properties that an engine's loader does not play, the first of each clip.
fn unread_properties(profile: Profile, engine: &str, spec: &Spec) -> Vec<Diagnostic> {
    match profile {
        Profile::Babylon => return spec.clips.values().filter_map(mistaken_by_babylon).collect(),
        Profile::Blender | Profile::Godot => return Vec::new(),
        _ => {}
    }
    let how =
        if profile.reads_properties() { "plays none" } else { "refuses files with some; they are left out" };
    let of_clip = |clip: &Definition<Clip>| {
        let mut paths = clip.value.track.iter().filter_map(|track| track.path.as_ref());
        let path = paths.find(|path| path.value.is_property())?;
        let message =
            format!("{engine} {how}: changes of materials, lights and cameras (`KHR_animation_pointer`)");
        let report = Diagnostic::warning(Code::EngineProperties, message).at(path.span, "this change");
        Some(
            report.help("change it in the game, or let nodes, joints or weights of morphs move in its place"),
        )
    };
    spec.clips.values().filter_map(of_clip).collect()
}

/// The first track of a clip that Babylon.js plays as something else: its loader knows metal twice, of which the second is
/// meant to be roughness (`KHR_animation_pointer.data.ts` of 9.28).
fn mistaken_by_babylon(clip: &Definition<Clip>) -> Option<Diagnostic> {
    let mut paths = clip.value.track.iter().filter_map(|track| track.path.as_ref());
    let path = paths.find(|path| matches!(path.value, MotionPath::Metallic | MotionPath::Roughness))?;
    let how = match path.value {
        MotionPath::Roughness => "plays no changes of `roughness`",
        _ => "plays changes of `metallic` as changes of roughness",
    };
    let report = Diagnostic::warning(Code::EngineProperties, format!("Babylon.js {how}"));
    Some(
        report.at(path.span, "this change").help(
            "change it in the game, or change `color`, `emissive` or a property of clearcoat in its place",
        ),
    )
}

/// Attributes of names of their own that an engine leaves out, or mixes up.
fn unread_attributes((profile, engine): (Profile, &str), spec: &Spec) -> Option<Diagnostic> {
    let several = usize::from(profile == Profile::Blender);
    let own = |shape: &Definition<ShapeDefinition>| {
        let (name, attribute) = shape.value.options.attributes.0.get_index(several)?;
        Some((name.clone(), attribute.span))
    };
    let (name, span) = spec.shapes.values().find_map(own)?;
    let (message, help) = match profile {
        Profile::Godot | Profile::Unreal | Profile::Unity | Profile::Babylon => (
            format!("{engine} leaves out attributes of names of their own, such as `{name}`"),
            "write what it says into `vertex-color`, which every engine reads",
        ),
        Profile::Blender => (
            format!(
                "{engine} 4.5 fails on several attributes of names of their own, or mixes them up: `{name}`"
            ),
            "write one attribute of up to four formulas",
        ),
        _ => return None,
    };
    Some(Diagnostic::warning(Code::EngineAttributes, message).at(span, "this attribute").help(help))
}

/// Extensions of materials, each with the engines whose loaders do not read it. Unity's reads a transmission as a thin one.
const UNREAD_MATERIALS: [(&str, &[Profile]); 10] = [
    ("KHR_materials_anisotropy", &[Profile::Godot, Profile::Unity]),
    ("KHR_materials_clearcoat", &[Profile::Godot]),
    (
        "KHR_materials_dispersion",
        &[Profile::Bevy, Profile::Godot, Profile::Unreal, Profile::Unity, Profile::Blender],
    ),
    ("KHR_materials_emissive_strength", &[Profile::Unity]),
    ("KHR_materials_ior", &[Profile::Godot, Profile::Unity]),
    ("KHR_materials_iridescence", &[Profile::Bevy, Profile::Godot, Profile::Unity, Profile::Blender]),
    ("KHR_materials_sheen", &[Profile::Bevy, Profile::Godot, Profile::Unity]),
    ("KHR_materials_specular", &[Profile::Godot, Profile::Unity]),
    ("KHR_materials_transmission", &[Profile::Godot]),
    ("KHR_materials_volume", &[Profile::Godot, Profile::Unreal, Profile::Unity]),
];

/// What of materials an engine does not draw, the first material of each extension.
fn unread_materials((profile, engine): (Profile, &str), spec: &Spec) -> Option<Diagnostic> {
    let used: Vec<_> = spec.materials.values().flat_map(|own| own.value.extensions()).collect();
    let unread = UNREAD_MATERIALS.iter().filter(|(_, by)| by.contains(&profile));
    let found: Vec<_> =
        unread.filter_map(|(extension, _)| used.iter().find(|(_, own, _)| own == extension)).collect();
    let (_, _, first) = found.first()?;
    let keys: Vec<String> = found.iter().map(|(key, ..)| format!("`{key}`")).collect();
    let message = format!("{engine} reads of these materials no {}", keys.join(", "));
    let report = Diagnostic::warning(Code::EngineMaterials, message).at(*first, "left out there");
    let report = found[1..].iter().fold(report, |report, (_, _, span)| report.also(*span, "and this"));
    Some(report.help("it draws the rest of each material, which should look well alone"))
}

/// Ends of names by which Godot makes something else of a node.
const OF_NODES: [&str; 11] = [
    "noimp",
    "col",
    "convcol",
    "colonly",
    "convcolonly",
    "navmesh",
    "vehicle",
    "wheel",
    "rigid",
    "occ",
    "occonly",
];

/// Ends of names by which Godot changes a material.
const OF_MATERIALS: [&str; 2] = ["vcol", "alpha"];

/// First and last words of names of motions that Godot repeats.
const OF_CLIPS: [&str; 2] = ["loop", "cycle"];

/// The end of a name that Godot acts upon; digits after it do not count.
fn suffix(name: &str, of: &'static [&'static str]) -> Option<&'static str> {
    let (_, last) = name
        .trim_end_matches(|letter: char| letter.is_ascii_digit())
        .trim_end_matches('-')
        .rsplit_once('-')?;
    of.iter().copied().find(|suffix| *suffix == last)
}

/// Names by which Godot does something to what they name.
fn changed_by_godot(spec: &Spec) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut tell = |kind: &str, name: &str, span: Span, what: String| {
        let message = format!("Godot {what} {kind} `{name}` for the end of its name");
        found.push(
            Diagnostic::warning(Code::EngineName, message)
                .at(span, "this name")
                .help("give it another name, or import the file without name suffixes"),
        );
    };
    let done = |suffix: &str| match suffix {
        "noimp" => "leaves out".to_owned(),
        other => format!("makes something else (\"-{other}\") of"),
    };
    let shown = spec.roots.iter().filter_map(|name| spec.shapes.get_key_value(name.as_str()));
    for (name, span) in spec
        .nodes
        .iter()
        .map(|(name, node)| (name, node.name.span))
        .chain(shown.filter(|_| spec.nodes.is_empty()).map(|(name, shape)| (name, shape.name.span)))
    {
        if let Some(suffix) = suffix(name, &OF_NODES) {
            tell("node", name, span, done(suffix));
        }
    }
    for (name, material) in &spec.materials {
        if let Some(suffix) = suffix(name, &OF_MATERIALS) {
            tell("material", name, material.name.span, done(suffix));
        }
    }
    for (name, clip) in &spec.clips {
        let words: Vec<&str> = name.split('-').collect();
        let named = OF_CLIPS.iter().any(|word| words.first() == Some(word) || words.last() == Some(word));
        if named && !clip.value.r#loop.value {
            tell("clip", name, clip.name.span, "repeats".to_owned());
        }
    }
    found
}

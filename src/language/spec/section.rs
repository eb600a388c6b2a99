//! The sections of a document: from the evaluated value tree to the typed whole.

use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic, Severity};
use crate::language::source::{SourceMap, Span};
use crate::language::spec::assertion::read_assertions;
use crate::language::spec::check::Check;
use crate::language::spec::curve::Curve;
use crate::language::spec::document::{Asset, Definition, Spec, Unit};
use crate::language::spec::field::Field;
use crate::language::spec::import::Up;
use crate::language::spec::kind::Kinds;
use crate::language::spec::limit::{LimitFields, Limits};
use crate::language::spec::lod::Lod;
use crate::language::spec::map::Map;
use crate::language::spec::morph::{self, Morphs};
use crate::language::spec::name::check_name;
use crate::language::spec::output::Output;
use crate::language::spec::reader::{Read, Reader, backtick, unknown_field};
use crate::language::spec::reference::Family;
use crate::language::spec::resolve::{Names, resolve};
use crate::language::spec::schema::{Object, Schemas};
use crate::language::spec::shape::{Shape, ShapeOptions};
use crate::language::spec::spanned::Sp;
use crate::language::value::{Data, Entry, Table};

/// Everything that may stand at the top of a document, with what it means.
pub(crate) const SECTIONS: [(&str, &str); 23] = [
    ("unit", "The unit of every length; metres when it is not written."),
    ("up", "The axis that points up; y when it is not written."),
    ("tolerance", "How far meshes may lie from the true surfaces, in the document's unit."),
    ("motion-tolerance", "How far vertices may be from the exact motion of clips, in the document's unit."),
    ("include", "Documents whose definitions belong to this one; paths are relative to this file."),
    ("asset", "Facts about the asset."),
    ("output", "What is written, and for whom."),
    ("lod", "Levels of detail of all shapes."),
    ("parameters", "Named values for expressions: numbers, booleans, points, strings."),
    ("curve", "Curves, as `[curve.NAME.KIND]`."),
    ("map", "Maps of heights and masks, as `[map.NAME]` and `[map.NAME.KIND]`."),
    ("field", "Fields whose zeros are surfaces, as `[field.NAME]` and `[field.NAME.KIND]`."),
    ("shape", "Shapes, as `[shape.NAME]` and `[shape.NAME.KIND]`."),
    ("material", "Materials, as `[material.NAME]`."),
    ("node", "Nodes, as `[node.NAME]`. Without any, each shape that no other definition uses is shown."),
    ("skeleton", "Skeletons, as `[skeleton.NAME.joint.JOINT]`."),
    ("skin", "Shapes that joints carry, as `[skin.NAME]`."),
    ("morph", "States of shapes, as `[morph.SHAPE.TARGET]`."),
    ("clip", "Motions, as `[clip.NAME]` and `[[clip.NAME.track]]`."),
    ("collider", "Bodies that physics engines take for shapes, as `[collider.NAME]`."),
    (
        "variant",
        "Partial documents, as `[variant.NAME]`: each is laid over this one and bakes one more asset.",
    ),
    ("assert", "What must hold of the result."),
    ("limits", "How much this document may ask for."),
];

/// The default of a word at the top of a document.
pub(crate) fn default_text(section: &str) -> &'static str {
    match section {
        "unit" => Unit::Metre.text(),
        "up" => Up::Y.text(),
        _ => "",
    }
}

/// Reads an evaluated document; everything that is wrong with it, and the whole where nothing is.
///
/// `outer` are the limits that it can only lower.
pub(crate) fn read_spec(
    table: &Table,
    sources: &SourceMap,
    outer: Limits,
) -> (Option<Spec>, Vec<Diagnostic>) {
    let mut reader = Reader::new(sources);
    unknown_sections(table, &mut reader);
    let unit = word(table, "unit", Unit::Metre, &mut reader);
    let up = word(table, "up", Up::Y, &mut reader);
    let motion_tolerance = tolerance(table, "motion-tolerance", &mut reader);
    let tolerance = tolerance(table, "tolerance", &mut reader);
    let asset = table.get("asset").map(|value| reader.within("asset", |reader| Asset::read(value, reader)));
    let output =
        table.get("output").map(|value| reader.within("output", |reader| Output::read(value, reader)));
    let lod = table.get("lod").map(|value| reader.within("lod", |reader| Sp::<Lod>::read(value, reader)));
    let limits =
        table.get("limits").map(|value| reader.within("limits", |reader| LimitFields::read(value, reader)));
    let limits = limits.flatten().map_or(outer, |fields| fields.under(outer, &mut reader));
    let curves = family(Family::Curve, Curve::NAMES, table, &mut reader);
    let maps = family(Family::Map, Map::NAMES, table, &mut reader);
    let fields = family(Family::Field, Field::NAMES, table, &mut reader);
    let shapes = family(Family::Shape, Shape::NAMES, table, &mut reader);
    let materials = family(Family::Material, &[], table, &mut reader);
    let nodes = family(Family::Node, &[], table, &mut reader);
    let skeletons = family(Family::Skeleton, &[], table, &mut reader);
    let skins = family(Family::Skin, &[], table, &mut reader);
    let morphs = morphs(table, &mut reader);
    let clips = family(Family::Clip, &[], table, &mut reader);
    let colliders = family(Family::Collider, &[], table, &mut reader);
    let asserts = table.get("assert").map(|value| read_assertions(value, &mut reader)).unwrap_or_default();
    let (roots, links) = resolve(&Names::of(table), limits.recursion, &mut reader);
    let asset = asset.flatten().unwrap_or(Asset { name: None, description: None });
    let output = output.flatten().unwrap_or(Output::NONE);
    let spec = Spec {
        unit,
        up,
        tolerance,
        motion_tolerance,
        asset,
        output,
        lod: lod.flatten(),
        curves,
        maps,
        fields,
        shapes,
        materials,
        nodes,
        skeletons,
        skins,
        morphs,
        clips,
        colliders,
        roots,
        links,
        asserts,
        limits,
    };
    let found = reader.diagnostics;
    let failed = found.iter().any(|one| one.severity == Severity::Error);
    ((!failed).then_some(spec), found)
}

/// The states of shapes; each of their names is that of a shape, which is shown all the same.
fn morphs(table: &Table, reader: &mut Reader<'_>) -> IndexMap<String, Definition<Morphs>> {
    let morphs: IndexMap<String, Definition<Morphs>> = family(Family::Morph, &[], table, reader);
    for (name, definition) in &morphs {
        reader.user = Some((Family::Morph, name.clone()));
        reader.uses_inside(Family::Shape, name, definition.name.span, true);
        reader.user = None;
        morph::check_names(&definition.value, reader);
    }
    morphs
}

fn word<T: Read>(table: &Table, name: &str, default: T, reader: &mut Reader<'_>) -> T {
    let read = table.get(name).map(|value| reader.within(name, |reader| T::read(value, reader)));
    read.flatten().unwrap_or(default)
}

fn tolerance(table: &Table, name: &str, reader: &mut Reader<'_>) -> Option<Sp<f64>> {
    let value = table.get(name)?;
    reader.within(name, |reader| {
        let read = Sp::<f64>::read(value, reader);
        read.filter(|_| Check::above(0.0).apply(value, reader))
    })
}

fn unknown_sections(table: &Table, reader: &mut Reader<'_>) {
    for (name, entry) in &table.entries {
        if SECTIONS.iter().any(|(known, _)| known == name) {
            continue;
        }
        let known: Vec<String> = SECTIONS.iter().map(|(known, _)| (*known).to_owned()).collect();
        let report = unknown_field(name, entry.key, &known, "a document");
        let shape_field = is_shape_field(name);
        reader.report(match (shape_field, &entry.value.data) {
            (true, _) => report.help(format!("`{name}` is a field of [shape.NAME]")),
            (_, Data::Table(_)) if Shape::NAMES.contains(&name.as_str()) => {
                report.help(format!("a shape is written as [shape.NAME.{name}]"))
            }
            (_, Data::Table(_)) if Curve::NAMES.contains(&name.as_str()) => {
                report.help(format!("a curve is written as [curve.NAME.{name}]"))
            }
            (_, Data::Table(_)) if Field::NAMES.contains(&name.as_str()) => {
                report.help(format!("a field is written as [field.NAME.{name}]"))
            }
            (_, Data::Table(_)) if Map::NAMES.contains(&name.as_str()) => {
                report.help(format!("a map is written as [map.NAME.{name}]"))
            }
            _ => report,
        });
    }
}

fn is_shape_field(name: &str) -> bool {
    let mut fields = Object::default();
    ShapeOptions::describe(&mut fields, &mut Schemas::default());
    fields.has(name)
}

fn family<T: Read>(
    family: Family,
    kinds: &[&str],
    table: &Table,
    reader: &mut Reader<'_>,
) -> IndexMap<String, Definition<T>> {
    let mut definitions = IndexMap::new();
    let Some(value) = table.get(family.text()) else { return definitions };
    let Data::Table(entries) = &value.data else {
        reader.within(family.text(), |reader| reader.mismatch(value, "a table of definitions"));
        return definitions;
    };
    for (name, entry) in &entries.entries {
        if let Some(read) = definition(family, kinds, name, entry, reader) {
            let (span, name_span) = (entry.value.span, Sp::new(name.clone(), entry.key));
            definitions.insert(name.clone(), Definition { name: name_span, span, value: read });
        }
    }
    definitions
}

fn definition<T: Read>(
    family: Family,
    kinds: &[&str],
    name: &str,
    entry: &Entry,
    reader: &mut Reader<'_>,
) -> Option<T> {
    if let Some(report) = nameless(family, kinds, name, entry) {
        reader.report(report);
        return None;
    }
    reader.diagnostics.extend(check_name(family.text(), name, entry.key));
    reader.user = Some((family, name.to_owned()));
    let read = reader.within(name, |reader| T::read(&entry.value, reader));
    reader.user = None;
    read
}

/// The error on `[curve.circle]`, where the name is left out and the kind stands in its place.
fn nameless(family: Family, kinds: &[&str], name: &str, entry: &Entry) -> Option<Diagnostic> {
    let table = entry.value.table()?;
    let has_kind = table.entries.keys().any(|key| kinds.contains(&key.as_str()));
    if !kinds.contains(&name) || has_kind || table.entries.is_empty() {
        return None;
    }
    let family = family.text();
    let report = Diagnostic::error(Code::NoKind, format!("this {family} has a kind, `{name}`, but no name"));
    Some(report.at(entry.key, "expected a name").help(format!("write [{family}.NAME.{name}]")))
}

/// The place of a definition: its header, else its name.
pub(crate) fn place_of(entry: &Entry) -> Span {
    if entry.key.is_none() { entry.value.span } else { entry.key }
}

/// How a name of a family is shown: `` curve `outline` ``.
pub(crate) fn titled(family: Family, name: &str) -> String {
    format!("{} {}", family.text(), backtick(name))
}

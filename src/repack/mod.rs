//! A glTF file of whatever maker, made small and quick to draw for a profile.
//!
//! Promise: the JSON is kept as it is but for what is rewritten here: names, `extras`, nodes and their places, cameras, lights,
//! materials, and extensions that are not known live on, and what such an extension may refer to stays true. What is drawn and
//! how it moves is the same within what the report says, which is measured on what a reader finds. Positions of a mesh are rounded
//! together, so nothing opens. Anything broken is a [`Fault`] with its place in the JSON, and nothing is taken on faith: counts
//! are held against the bytes before memory is taken. The bytes depend on the input alone. Not promised: names and extras of
//! buffers and buffer views, which are made anew; that a file that the validator refuses is mended.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021; A. Kapoulkine, gltfpack, 2026, whose defaults of precision are these.

mod accessor;
mod animation;
mod check;
mod column;
mod copies;
mod document;
mod duplicate;
mod grid;
mod node;
mod picture;
mod pin;
mod report;
mod set;
mod stream;
mod texture;
mod thickness;

use gltf::json::accessor::ComponentType;
use serde_json::{Value, json};

use accessor::Source;
use column::Column;
pub use document::Fault;
use document::{Object, as_index, list, list_mut, whole};
use pin::Pins;
pub use report::{Change, Errors, Report};
use set::{Set, Slot};
use stream::{Content, INDICES, Kind, Output, VERTICES};

use crate::geometry::number::single;
use crate::gltf::{Profile, container};
pub use crate::packing::Codec;
use crate::packing::EXTENSIONS;

/// What is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// For whom the file is.
    pub profile: Profile,
    /// How far a point may move, in units of the scene; by default a 16384th of its extent, halved.
    pub tolerance: Option<f64>,
    /// How views are compressed, where the profile has them compressed.
    pub codec: Codec,
    /// Whether a file that the profile would make longer than it was is written plainer: what is said of whole numbers and of
    /// compressed views costs more than they save in a file of a few triangles. Whoever reads the profile reads that too.
    pub shortest: bool,
    /// Pixels of the longer side of a PNG or JPEG picture, at most.
    pub texture_size: Option<u32>,
    /// Whether PNG pictures are written anew in the shortest of many ways.
    pub compress_textures: bool,
}

/// A file and what came of it.
#[derive(Clone, Debug)]
pub struct Repacked {
    /// The `.glb` file.
    pub bytes: Vec<u8>,
    /// What came of it.
    pub report: Report,
}

const QUANTIZATION: &str = "KHR_mesh_quantization";
const DRACO: &str = "KHR_draco_mesh_compression";

/// Makes a `.glb` or `.gltf` file small; `open` reads others by their paths from it.
///
/// Cost: linear, some 300 ns a triangle; memory about three times the bytes of the plain file.
///
/// # Errors
/// The first fault in it.
pub fn repacked(
    bytes: &[u8],
    options: &Options,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Repacked, Fault> {
    let mut best = passed(bytes, options, open)?;
    for profile in [Profile::Quantized, Profile::Core] {
        let plainer = (options.profile.is_compressed() && profile == Profile::Quantized)
            || (options.profile.is_quantized() && profile == Profile::Core);
        if !options.shortest || !plainer || best.report.bytes.after <= best.report.bytes.before {
            continue;
        }
        let made = passed(bytes, &Options { profile, ..*options }, open)?;
        if made.bytes.len() < best.bytes.len() {
            best = made;
            let note =
                format!("written as for profile `{}`, which is shorter for so small a file", profile.name());
            best.report.notes.push(note);
        }
    }
    Ok(best)
}

/// All passes, one after the other.
fn passed(
    bytes: &[u8],
    options: &Options,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Repacked, Fault> {
    let mut read = bytes.len() as u64;
    let (Value::Object(mut root), binary) = document::parse(bytes)? else {
        return Err(Fault::new("", "its JSON is no object"));
    };
    check::check(&root)?;
    undraco(&mut root)?;
    let mut counting = |path: &str| {
        let found = open(path)?;
        read += found.len() as u64;
        Some(found)
    };
    let buffers = document::buffers(&root, binary, &mut counting)?;
    let mut notes = Vec::new();
    if !options.profile.reads_properties() {
        animation::without_properties(&mut root, &mut notes);
    }
    let pictures = picture::read(&root, open, &mut notes)?;
    let views = document::views(&root, &buffers)?;
    let source = Source { root: &root, views: &views };
    let pins = pin::pins(&root);
    tell_pins(&pins, &mut notes);
    node::check_joints(&source)?;
    let places = grid::places(&source, &pins, options, &mut notes)?;
    let mut sets = set::sets(&root, &pins, &places);
    set::pack(&mut sets, &source, options)?;

    let codec = options.profile.is_compressed().then_some(options.codec);
    let mut output = Output::new(&pins, codec);
    let mut made = root.clone();
    let mut errors = Errors::default();
    keep(&source, &pins, &mut output)?;
    let mut quantized = !pins.meshes.is_empty() && uses(&root, QUANTIZATION);
    let tallies: Vec<_> = sets.iter().map(|set| set.tally).collect();
    for set in sets {
        for (slot, column) in &set.columns {
            quantized |= needs_quantization(slot, column);
            errors.column(column);
        }
        write_set(&mut made, &source, set, &mut output);
    }
    drop_merged(&mut made);
    animation::animations(&mut made, &source, (&mut output, codec.is_some()), &mut errors)?;
    node::skins(&mut made, &source, &places, &mut output)?;
    copies::write(&mut made, &source, &places, &mut output)?;
    node::carriers(&mut made, &places);
    thickness::scale(&mut made, &places);
    let picture_bytes = pictures.read;
    picture::write(&mut made, (&source, &pins), (pictures, options), &mut output)?;
    duplicate::merge(&mut made, &pins);
    let finished = output.finish(&root);
    for (name, all) in
        [("buffers", finished.buffers), ("bufferViews", finished.views), ("accessors", finished.accessors)]
    {
        if all.is_empty() {
            made.remove(name);
        } else {
            made.insert(name.to_owned(), Value::Array(all));
        }
    }
    let compression = codec.filter(|_| finished.compressed).map(Codec::extension);
    let needed = [quantized.then_some(QUANTIZATION), compression];
    name_extensions(&mut made, &needed.into_iter().flatten().collect::<Vec<_>>());
    if let Some(asset) = made.get_mut("asset") {
        asset["generator"] = json!(concat!("Kiln ", env!("CARGO_PKG_VERSION")));
    }
    let text = serde_json::to_vec(&made).map_err(|error| Fault::new("", error.to_string()))?;
    let bytes = container(text, finished.binary).map_err(|error| Fault::new("", error.to_string()))?;
    let report = Report {
        bytes: Change { before: read + picture_bytes, after: bytes.len() as u64 },
        triangles: report::total(&tallies, |tally| tally.triangles),
        vertices: report::total(&tallies, |tally| tally.vertices),
        acmr: report::acmr(&tallies),
        errors,
        notes,
    };
    Ok(Repacked { bytes, report })
}

/// Takes away Draco's form of primitives that have another, too.
fn undraco(root: &mut Object) -> Result<(), Fault> {
    let bare = |own: &Value| own.get("bufferView").is_none() && own.get("sparse").is_none();
    let bare: Vec<bool> = list(root, "accessors").iter().map(bare).collect();
    let required = root.get("extensionsRequired").and_then(Value::as_array).cloned().unwrap_or_default();
    let required = required.iter().any(|name| name == DRACO);
    for (mesh, own) in list_mut(root, "meshes").iter_mut().enumerate() {
        let all = own.get_mut("primitives").and_then(Value::as_array_mut);
        for (place, primitive) in all.into_iter().flatten().enumerate() {
            let accessors = accessors_of(primitive);
            let Some(own) = primitive.get_mut("extensions").and_then(Value::as_object_mut) else { continue };
            if own.remove(DRACO).is_none() {
                continue;
            }
            if own.is_empty() {
                primitive.as_object_mut().map(|primitive| primitive.remove("extensions"));
            }
            if required || accessors.iter().any(|accessor| bare[*accessor]) {
                let path = format!("/meshes/{mesh}/primitives/{place}/extensions/{DRACO}");
                return Err(Fault::new(path, "it is compressed by Draco, which is not read here"));
            }
        }
    }
    Ok(())
}

fn tell_pins(pins: &Pins, notes: &mut Vec<String>) {
    if !pins.unknown.is_empty() {
        let names: Vec<&str> = pins.unknown.iter().map(String::as_str).collect();
        let and = if pins.meshes.is_empty() {
            String::new()
        } else {
            let meshes: Vec<String> = pins.meshes.iter().map(usize::to_string).collect();
            format!(" (meshes {})", meshes.join(", "))
        };
        notes.push(format!("what {} may refer to stays as it is{and}", names.join(", ")));
    }
}

/// The primitives of a mesh.
fn primitives(mesh: &Value) -> impl Iterator<Item = &Value> {
    mesh.get("primitives").and_then(Value::as_array).into_iter().flatten()
}

/// All accessors that a primitive names.
fn accessors_of(primitive: &Value) -> Vec<usize> {
    let targets = primitive.get("targets").and_then(Value::as_array).into_iter().flatten();
    let maps = primitive.get("attributes").into_iter().chain(targets).filter_map(Value::as_object);
    let named = maps.flat_map(|map| map.values().filter_map(as_index));
    named.chain(whole(primitive, "indices")).collect()
}

/// So many numbers of an object.
fn number_list<const N: usize>(of: &Value, name: &str) -> Option<[f64; N]> {
    let all: Vec<f64> = of.get(name)?.as_array()?.iter().filter_map(Value::as_f64).collect();
    all.try_into().ok()
}

/// A number that single precision holds, in its shortest form.
fn number_of(number: f64) -> Value {
    let narrow = single(number) + 0.0;
    let short: f64 = narrow.to_string().parse().unwrap_or(0.0);
    if short.fract() == 0.0 && short.abs() < 1e15 {
        #[expect(clippy::cast_possible_truncation, reason = "a whole number within the range of the type")]
        return json!(short as i64);
    }
    json!(short)
}

/// Name and extras of an accessor.
fn described(root: &Object, accessor: usize) -> Object {
    let own = list(root, "accessors")[accessor].as_object().into_iter().flatten();
    let kept = own.filter(|(name, _)| ["name", "extras"].contains(&name.as_str()));
    kept.map(|(name, value)| (name.clone(), value.clone())).collect()
}

fn uses(root: &Object, extension: &str) -> bool {
    root.get("extensionsUsed")
        .and_then(Value::as_array)
        .is_some_and(|all| all.iter().any(|name| name == extension))
}

/// Copies what is pinned.
fn keep(source: &Source<'_>, pins: &Pins, output: &mut Output) -> Result<(), Fault> {
    let views = list(source.root, "bufferViews");
    let copy = |output: &mut Output, view: usize| {
        output.copied((view, &source.views[view]), &views[view], pins.views.contains(&view))
    };
    for view in &pins.views {
        copy(output, *view);
    }
    for accessor in &pins.accessors {
        source.elements(*accessor)?;
        let mut told = list(source.root, "accessors")[*accessor].clone();
        if let Some(view) = whole(&told, "bufferView") {
            told["bufferView"] = json!(copy(output, view));
        }
        for part in ["indices", "values"] {
            if let Some(view) = told.get("sparse").and_then(|sparse| whole(&sparse[part], "bufferView")) {
                told["sparse"][part]["bufferView"] = json!(copy(output, view));
            }
        }
        output.keep(*accessor, told);
    }
    Ok(())
}

/// Whether the specification itself has no such attribute.
fn needs_quantization((target, name): &Slot, column: &Column) -> bool {
    let float = column.component == ComponentType::F32;
    let unsigned = matches!(column.component, ComponentType::U8 | ComponentType::U16);
    match name.split_once('_').map_or(name.as_str(), |(own, _)| own) {
        "POSITION" | "NORMAL" | "TANGENT" => !float,
        "TEXCOORD" => !(float || column.normalized && unsigned && *target == 0),
        _ => false,
    }
}

/// Writes the vertices and indices of a set, and says in its primitives where they are.
fn write_set(made: &mut Object, source: &Source<'_>, set: Set, output: &mut Output) {
    let Set { members, columns, count, .. } = set;
    let mut numbers: Vec<(Slot, usize)> = Vec::with_capacity(columns.len());
    for (slot, column) in columns {
        let accessor = members.iter().find_map(|member| member.accessor(&slot));
        let told = accessor.map(|accessor| described(source.root, accessor)).unwrap_or_default();
        numbers.push((slot.clone(), write_column(&slot, column, (count, told), output)));
    }
    for member in members {
        let Some(primitive) = list_mut(made, "meshes")[member.mesh]["primitives"].get_mut(member.parts[0])
        else {
            continue;
        };
        for (slot, accessor) in numbers.iter().filter(|(slot, _)| member.accessor(slot).is_some()) {
            let (target, name) = slot;
            let map = match target.checked_sub(1) {
                None => &mut primitive["attributes"],
                Some(target) => &mut primitive["targets"][target],
            };
            map[name] = json!(accessor);
        }
        let told = whole(primitive, "indices").map(|accessor| described(source.root, accessor));
        if let Some(own) = primitive.as_object_mut() {
            own.remove("indices");
            if member.mode == 4 {
                own.remove("mode");
            }
        }
        if let Some(indices) = member.indices {
            let number = write_indices(&indices, (count, member.mode), told.unwrap_or_default(), output);
            primitive["indices"] = json!(number);
        }
        for part in &member.parts[1..] {
            list_mut(made, "meshes")[member.mesh]["primitives"][*part] = Value::Null;
        }
    }
}

/// Takes out the primitives that became part of others.
fn drop_merged(made: &mut Object) {
    for mesh in list_mut(made, "meshes") {
        if let Some(primitives) = mesh.get_mut("primitives").and_then(Value::as_array_mut) {
            primitives.retain(|primitive| !primitive.is_null());
        }
    }
}

fn write_indices(
    indices: &[u32],
    (vertices, mode): (usize, usize),
    mut told: Object,
    output: &mut Output,
) -> usize {
    // 0xFFFF restarts primitives and is no vertex.
    let short = vertices <= 0xFFFF;
    let bytes: Vec<u8> = if short {
        indices
            .iter()
            .flat_map(|index| {
                let [a, b, ..] = index.to_le_bytes();
                [a, b]
            })
            .collect()
    } else {
        indices.iter().flat_map(|index| index.to_le_bytes()).collect()
    };
    let content = if mode == 4 { Content::Triangles } else { Content::Indices };
    let stride = if short { 2 } else { 4 };
    let kind = Kind { name: String::new(), content, stride, target: Some(INDICES) };
    let span = output.put(&kind, bytes);
    output.name_vertices(span, vertices);
    told.insert("componentType".to_owned(), json!(if short { 5123 } else { 5125 }));
    told.insert("count".to_owned(), json!(indices.len()));
    told.insert("type".to_owned(), json!("SCALAR"));
    output.accessor(span, told)
}

fn write_column(
    (_, name): &Slot,
    column: Column,
    (count, mut told): (usize, Object),
    output: &mut Output,
) -> usize {
    told.insert("componentType".to_owned(), json!(column.component.as_gl_enum()));
    told.insert("count".to_owned(), json!(count));
    told.insert("type".to_owned(), json!(column.kind));
    if column.normalized {
        told.insert("normalized".to_owned(), json!(true));
    }
    if column.bounded {
        let (min, max) = bounds(&column);
        told.insert("min".to_owned(), min);
        told.insert("max".to_owned(), max);
    }
    if column.differs
        && output.is_plain()
        && let Some(number) = write_sparse(&column, count, &told, output)
    {
        return number;
    }
    let kind =
        Kind { name: name.clone(), content: column.content, stride: column.stride, target: Some(VERTICES) };
    let span = output.put(&kind, column.rows);
    output.accessor(span, told)
}

/// What a sparse accessor costs in JSON and views beyond its elements.
const SPARSE_OVERHEAD: usize = 400;

/// Writes differences of few vertices; none where all of them are shorter.
fn write_sparse(column: &Column, count: usize, told: &Object, output: &mut Output) -> Option<usize> {
    let row = |at: usize| &column.rows[at * column.stride..(at + 1) * column.stride];
    let mut moved: Vec<usize> = (0..count).filter(|at| row(*at).iter().any(|byte| *byte != 0)).collect();
    let size = crate::import::gltf::size(column.component) * 3;
    let short = count <= 0xFFFF;
    let width = if short { 2 } else { 4 };
    if column.kind != "VEC3" || moved.len() * (size + width) + SPARSE_OVERHEAD >= column.rows.len() {
        return None;
    }
    if moved.is_empty() {
        // Not every reader knows accessors without any data.
        moved.push(0);
    }
    let places =
        moved.iter().flat_map(|at| crate::geometry::mesh::index(*at).to_le_bytes()[..width].to_vec());
    let places = output.plain(places.collect(), Object::new());
    let values = moved.iter().flat_map(|at| row(*at)[..size].to_vec()).collect();
    let values = output.plain(values, Object::new());
    let mut told = told.clone();
    let indices = json!({ "bufferView": places, "componentType": if short { 5123 } else { 5125 } });
    let sparse = json!({ "count": moved.len(), "indices": indices, "values": { "bufferView": values } });
    told.insert("sparse".to_owned(), sparse);
    Some(output.push(told))
}

/// The least and the greatest of each number of a column, as they stand in the file.
fn bounds(column: &Column) -> (Value, Value) {
    let size = crate::import::gltf::size(column.component);
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut take = |numbers: [f64; 3]| {
        for axis in 0..3 {
            min[axis] = min[axis].min(numbers[axis]);
            max[axis] = max[axis].max(numbers[axis]);
        }
    };
    for row in column.rows.chunks_exact(column.stride) {
        take(match column.component {
            ComponentType::U16 => {
                let words = row.as_chunks::<2>().0;
                [words[0], words[1], words[2]].map(|word| u16::from_le_bytes(word).into())
            }
            _ => [0, 1, 2].map(|axis| {
                let bytes = &row[axis * size..(axis + 1) * size];
                crate::import::gltf::number(column.component, false, bytes).into()
            }),
        });
    }
    let told = |bound: [f64; 3]| Value::Array(bound.map(number_of).to_vec());
    (told(min), told(max))
}

/// Says which extensions are used and required now.
fn name_extensions(made: &mut Object, needed: &[&str]) {
    let gone = |name: &Value| {
        let known = EXTENSIONS.iter().chain(&[QUANTIZATION, DRACO]);
        known.into_iter().any(|own| name == own)
    };
    for list in ["extensionsUsed", "extensionsRequired"] {
        let mut names = made.remove(list).and_then(|own| own.as_array().cloned()).unwrap_or_default();
        names.retain(|name| !gone(name));
        names.extend(needed.iter().map(|name| json!(name)));
        if !names.is_empty() {
            made.insert(list.to_owned(), Value::Array(names));
        }
    }
}

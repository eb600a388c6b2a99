//! Keys of animations: what stays still has two, and compressed ones are rounded as finely as a report says.
//!
//! Promise: times stay as they are, and no key moves in time. A sampler whose keys are all equal keeps the first and the last,
//! so that the animation lasts as long. Splines keep their bits.

use glam::DVec4;
use gltf::json::accessor::ComponentType;
use serde_json::{Value, json};

use super::accessor::{Elements, Source};
use super::column::kind;
use super::document::{Fault, Object, list, list_mut, whole};
use super::report::Errors;
use super::stream::{Content, Kind, Output};
use super::{described, number_of};
use crate::packing::{Filter, POINTER, exponential_step, power_of_two, quaternion};

/// Bits of each part of a quaternion.
const TURN_BITS: u8 = 16;

/// Steps that the range of moves, scales and weights is divided into, at least.
const STEPS: f64 = 65535.0;

/// Writes all animations. Linear in their keys.
pub(super) fn animations(
    made: &mut Object,
    source: &Source<'_>,
    (output, folded): (&mut Output, bool),
    errors: &mut Errors,
) -> Result<(), Fault> {
    for (index, animation) in list_mut(made, "animations").iter_mut().enumerate() {
        let paths = paths(animation);
        let samplers = animation.get_mut("samplers").and_then(Value::as_array_mut);
        for (place, sampler) in samplers.into_iter().flatten().enumerate() {
            let path = format!("/animations/{index}/samplers/{place}");
            let own = paths.get(place).map_or("", String::as_str);
            write(sampler, (source, own, &path), (output, folded), errors)?;
        }
    }
    Ok(())
}

/// Takes out what changes without a node, which some loaders refuse to parse.
pub(super) fn without_properties(root: &mut Object, notes: &mut Vec<String>) {
    let mut dropped = 0;
    let mut kept = Vec::new();
    for mut animation in list(root, "animations").to_vec() {
        let all = animation["channels"].as_array().map_or(0, Vec::len);
        let channels = animation.get_mut("channels").and_then(Value::as_array_mut);
        let Some(channels) = channels else { continue };
        channels.retain(|channel| channel["target"].get("node").is_some());
        dropped += all - channels.len();
        // Samplers of theirs go with them.
        let mut used: Vec<usize> = channels.iter().filter_map(|channel| whole(channel, "sampler")).collect();
        used.sort_unstable();
        used.dedup();
        for channel in channels.iter_mut() {
            let place = whole(channel, "sampler").and_then(|old| used.binary_search(&old).ok());
            channel["sampler"] = json!(place.unwrap_or(0));
        }
        let empty = channels.is_empty();
        let samplers = used.iter().map(|old| animation["samplers"][*old].clone()).collect();
        animation["samplers"] = Value::Array(samplers);
        if !empty {
            kept.push(animation);
        }
    }
    if dropped == 0 {
        return;
    }
    notes.push(format!(
        "{dropped} changes of materials, lights or cameras are left out: Bevy refuses files with some"
    ));
    if kept.is_empty() {
        root.remove("animations");
    } else {
        root.insert("animations".to_owned(), Value::Array(kept));
    }
    for name in ["extensionsUsed", "extensionsRequired"] {
        let Some(all) = root.get_mut(name).and_then(Value::as_array_mut) else { continue };
        all.retain(|extension| extension != POINTER);
        if all.is_empty() {
            root.remove(name);
        }
    }
}

/// For each sampler what it moves; nothing where that is more than one thing.
fn paths(animation: &Value) -> Vec<String> {
    let count = animation["samplers"].as_array().map_or(0, Vec::len);
    let mut paths: Vec<Option<String>> = vec![None; count];
    for channel in animation["channels"].as_array().into_iter().flatten() {
        let path = channel["target"]["path"].as_str().unwrap_or_default();
        if let Some(own) = whole(channel, "sampler").and_then(|sampler| paths.get_mut(sampler)) {
            let known = own.get_or_insert_with(|| path.to_owned());
            if known != path {
                known.clear();
            }
        }
    }
    paths.into_iter().map(Option::unwrap_or_default).collect()
}

fn write(
    sampler: &mut Value,
    (source, path, at): (&Source<'_>, &str, &str),
    (output, folded): (&mut Output, bool),
    errors: &mut Errors,
) -> Result<(), Fault> {
    let (input, values) = (whole(sampler, "input").unwrap_or(0), whole(sampler, "output").unwrap_or(0));
    let (times, keys) = (source.sound(input)?, source.sound(values)?);
    let wanted = match path {
        "rotation" => 4,
        "translation" | "scale" => 3,
        "weights" => 1,
        _ => keys.width,
    };
    if keys.width != wanted {
        let message = format!("its accessor holds {}, and {path} is {}", kind(keys.width), kind(wanted));
        return Err(Fault::new(format!("{at}/output"), message));
    }
    let splines = sampler["interpolation"] == "CUBICSPLINE";
    let each = if splines { 3 * times.count } else { times.count };
    let fits = if matches!(path, "weights" | "pointer") {
        keys.count.is_multiple_of(each)
    } else {
        keys.count == each
    };
    if !fits {
        let message = format!("its accessor has {} elements for {} times", keys.count, times.count);
        return Err(Fault::new(format!("{at}/output"), message));
    }
    // Elements of a key: one, or one for each target.
    let width = keys.count / times.count;
    let same = |key: usize| (0..width).all(|part| keys.at(key * width + part) == keys.at(part));
    let still = !splines && times.count > 2 && (1..times.count).all(same);
    let kept: Vec<usize> = if still { vec![0, times.count - 1] } else { (0..times.count).collect() };
    let seconds: Vec<f64> = kept.iter().map(|key| times.numbers::<1>(*key)[0]).collect();
    let bytes = seconds.iter().flat_map(|time| (crate::geometry::number::single(*time) + 0.0).to_le_bytes());
    let span = output.put(&row_kind("time", Content::Rows, 4), bytes.collect());
    let mut told = described(source.root, input);
    told.insert("componentType".to_owned(), json!(5126));
    told.insert("count".to_owned(), json!(kept.len()));
    told.insert("type".to_owned(), json!("SCALAR"));
    let bound = |time: Option<f64>| json!([number_of(time.unwrap_or(0.0))]);
    told.insert("min".to_owned(), bound(seconds.iter().copied().reduce(f64::min)));
    told.insert("max".to_owned(), bound(seconds.iter().copied().reduce(f64::max)));
    sampler["input"] = json!(output.accessor(span, told));
    let places: Vec<usize> = kept.iter().flat_map(|key| (key * width)..(key * width + width)).collect();
    let written = match path {
        "rotation" if folded && !splines && keys.width == 4 => turns(&keys, &places, errors),
        "translation" | "scale" | "weights" if folded && !splines && keys.is_float() => {
            powers(&keys, &places, (path, errors))
        }
        _ => plain(&keys, &places),
    };
    let span = output.put(&row_kind(path, written.content, written.stride), written.rows);
    let mut told = described(source.root, values);
    told.insert("componentType".to_owned(), json!(written.component.as_gl_enum()));
    told.insert("count".to_owned(), json!(places.len()));
    told.insert("type".to_owned(), json!(kind(keys.width)));
    if written.normalized {
        told.insert("normalized".to_owned(), json!(true));
    }
    sampler["output"] = json!(output.accessor(span, told));
    Ok(())
}

fn row_kind(name: &str, content: Content, stride: usize) -> Kind {
    Kind { name: name.to_owned(), content, stride, target: None }
}

/// Values as they are written.
struct Written {
    rows: Vec<u8>,
    content: Content,
    stride: usize,
    component: ComponentType,
    normalized: bool,
}

/// The same bits. Rows that are no whole words are not compressed.
fn plain(keys: &Elements<'_>, places: &[usize]) -> Written {
    let stride = keys.size;
    Written {
        rows: places.iter().flat_map(|place| keys.at(*place)).copied().collect(),
        content: if stride.is_multiple_of(4) { Content::Rows } else { Content::Plain },
        stride,
        component: keys.component,
        normalized: keys.normalized,
    }
}

fn turns(keys: &Elements<'_>, places: &[usize], errors: &mut Errors) -> Written {
    let given: Vec<[f64; 4]> = places.iter().map(|place| keys.numbers::<4>(*place)).collect();
    // A key that is no turn is somebody's mistake, and stays as it is.
    if given.iter().any(|turn| (DVec4::from_array(*turn).length() - 1.0).abs() > 1e-3) {
        return plain(keys, places);
    }
    let words = given.iter().map(|turn| quaternion(*turn, TURN_BITS).map(i16::to_le_bytes));
    let rows: Vec<u8> = words.flat_map(|row| row.as_flattened().to_vec()).collect();
    let mut read = rows.clone();
    // Rows of eight bytes are the filter's own.
    let _ = Filter::Quaternion.undo(&mut read, 8);
    for (row, turn) in read.as_chunks::<8>().0.iter().zip(&given) {
        let words = row.as_chunks::<2>().0;
        let part = |at: usize| f64::from(i16::from_le_bytes(words[at])) / 32767.0;
        let (found, given) = (DVec4::new(part(0), part(1), part(2), part(3)), DVec4::from_array(*turn));
        let (found, given) = (found.normalize_or_zero(), given.normalize_or_zero());
        errors.turn(found.distance(given).min(found.distance(-given)));
    }
    Written {
        rows,
        content: Content::Quaternions,
        stride: 8,
        component: ComponentType::I16,
        normalized: true,
    }
}

/// Floats as multiples of a power of two.
fn powers(keys: &Elements<'_>, places: &[usize], (path, errors): (&str, &mut Errors)) -> Written {
    let width = keys.width.min(3);
    let (mut range, mut most) = (0.0_f64, 0.0_f64);
    for part in 0..width {
        let values = || places.iter().map(|place| keys.numbers::<3>(*place)[part]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        (range, most) = (range.max(high - low), most.max(high.abs()).max(low.abs()));
    }
    let range = if range > 0.0 { range } else { most };
    let mut exponent: i8 = 60;
    while exponent > -80 && power_of_two(exponent) > range / STEPS {
        exponent -= 1;
    }
    while exponent < 100 && power_of_two(exponent) * 8_388_607.0 < most {
        exponent += 1;
    }
    let step = power_of_two(exponent);
    let mut rows = Vec::with_capacity(places.len() * width * 4);
    for place in places {
        for number in keys.numbers::<3>(*place).into_iter().take(width) {
            errors.key(path, ((number / step).round() * step - number).abs());
            rows.extend_from_slice(&exponential_step(number, exponent).to_le_bytes());
        }
    }
    Written {
        rows,
        content: Content::Exponents,
        stride: 4 * width,
        component: ComponentType::F32,
        normalized: false,
    }
}

//! One attribute of vertices in the numbers of a profile, and by how much it is off.
//!
//! Promise: what a profile has no smaller form for is copied bit by bit; a reader is off by no more than the column says,
//! which is measured on what it reads. Kinds of attributes that the specification does not name are copied.
//!
//! Source: Khronos Group, `KHR_mesh_quantization`, 2020; `EXT_meshopt_compression`, 2021.

use glam::DVec3;
use gltf::json::accessor::ComponentType;
use rayon::prelude::{IndexedParallelIterator as _, ParallelIterator as _, ParallelSliceMut as _};

use super::accessor::Elements;
use super::grid::{Grid, MeshPlace};
use super::stream::Content;
use crate::gltf::Profile;
use crate::packing::{Filter, exponential_step, octahedral, power_of_two, signed_byte};

/// What a column's error is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    /// Units of the scene.
    Positions,
    /// Chords of the unit sphere.
    Normals,
    /// The same.
    Tangents,
    /// Units of textures.
    Uvs,
    /// Shares of 1.
    Colors,
    /// Shares of 1.
    Weights,
    /// Nothing is off.
    Nothing,
}

/// An attribute of all vertices.
pub(super) struct Column {
    /// A row for each vertex.
    pub(super) rows: Vec<u8>,
    /// Bytes of a row, whole words.
    pub(super) stride: usize,
    pub(super) component: ComponentType,
    /// Numbers of an element.
    pub(super) kind: &'static str,
    pub(super) normalized: bool,
    pub(super) content: Content,
    pub(super) measure: Measure,
    /// The greatest that a reader is off.
    pub(super) error: f64,
    /// Whether the least and greatest numbers are told.
    pub(super) bounded: bool,
    /// Whether it says by how much something differs, mostly by nothing.
    pub(super) differs: bool,
}

/// Rows that are written together by one thread.
const PIECE: usize = 4096;

/// Rows, written side by side; and the greatest of what `write` gives, which is how far it is off.
fn rows(count: usize, stride: usize, write: impl Fn(usize, &mut [u8]) -> f64 + Sync) -> (Vec<u8>, f64) {
    let mut rows = vec![0; count * stride];
    let piece = |(piece, rows): (usize, &mut [u8])| {
        let rows = rows.chunks_exact_mut(stride).enumerate();
        rows.map(|(at, row)| write(piece * PIECE + at, row)).fold(0.0, f64::max)
    };
    let error = if count > 4 * PIECE {
        rows.par_chunks_mut(stride * PIECE).enumerate().map(piece).reduce(|| 0.0, f64::max)
    } else {
        rows.chunks_mut(stride * PIECE).enumerate().map(piece).fold(0.0, f64::max)
    };
    (rows, error)
}

/// An attribute of a base shape.
pub(super) fn base(name: &str, own: &Elements<'_>, profile: Profile, place: &MeshPlace) -> Column {
    let small = profile.is_quantized();
    let folded = profile.is_compressed();
    let is = |kind: ComponentType| own.component == kind;
    match name.split_once('_').map_or(name, |(own, _)| own) {
        "POSITION" => match place.grid {
            Some(grid) => on_grid(own, grid, place.scale),
            None if own.is_float() || !small => floats(own, true),
            None => Column { bounded: true, ..copied(own) },
        },
        "NORMAL" | "TANGENT" if !small => floats(own, false),
        "NORMAL" | "TANGENT" if folded => on_octahedron(own),
        "NORMAL" | "TANGENT" if own.is_float() => in_bytes(own),
        "TEXCOORD" if own.is_float() && folded => in_powers(own),
        "TEXCOORD" if own.is_float() && small && in_unit(own) => in_shares(own, Measure::Uvs),
        "TEXCOORD"
            if !own.is_float()
                && !small
                && !(own.normalized && (is(ComponentType::U8) || is(ComponentType::U16))) =>
        {
            floats(own, false)
        }
        "COLOR" if small && !is(ComponentType::U8) && in_unit(own) => in_shares(own, Measure::Colors),
        "WEIGHTS" if small && name == "WEIGHTS_0" && own.is_float() => weights(own),
        "JOINTS" => joints(own),
        _ => copied(own),
    }
}

/// Numbers of an element, in the words of the specification.
pub(super) fn kind(width: usize) -> &'static str {
    match width {
        2 => "VEC2",
        3 => "VEC3",
        4 => "VEC4",
        9 => "MAT3",
        16 => "MAT4",
        _ => "SCALAR",
    }
}

/// The same bits.
pub(super) fn copied(own: &Elements<'_>) -> Column {
    let stride = own.size.next_multiple_of(4);
    let zeros = own.is_float();
    let (rows, _) = rows(own.count, stride, |at, row| {
        row[..own.size].copy_from_slice(own.at(at));
        if zeros {
            // Zero has one form, so that equal numbers are equal bytes.
            for word in row.as_chunks_mut::<4>().0.iter_mut().filter(|word| **word == [0, 0, 0, 0x80]) {
                *word = [0; 4];
            }
        }
        0.0
    });
    Column {
        rows,
        stride,
        component: own.component,
        kind: kind(own.width),
        normalized: own.normalized,
        content: Content::Rows,
        measure: Measure::Nothing,
        error: 0.0,
        bounded: false,
        differs: false,
    }
}

fn floats(own: &Elements<'_>, bounded: bool) -> Column {
    if own.is_float() {
        return Column { bounded, ..copied(own) };
    }
    let stride = own.width * 4;
    let (rows, _) = rows(own.count, stride, |at, row| {
        let numbers = own.numbers::<4>(at);
        for (word, number) in row.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
            *word = narrow(number).to_le_bytes();
        }
        0.0
    });
    Column { rows, stride, component: ComponentType::F32, normalized: false, bounded, ..empty(own) }
}

/// A number that came from single precision, back.
fn narrow(number: f64) -> f32 {
    crate::geometry::number::single(number) + 0.0
}

fn empty(own: &Elements<'_>) -> Column {
    Column {
        rows: Vec::new(),
        stride: 4,
        component: ComponentType::I8,
        kind: kind(own.width),
        normalized: true,
        content: Content::Rows,
        measure: Measure::Nothing,
        error: 0.0,
        bounded: false,
        differs: false,
    }
}

/// A whole number of 16 bits, of one that lies in their range.
fn short(number: f64) -> [u8; 2] {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the range of the type"
    )]
    let word = number.clamp(0.0, 65535.0) as u16;
    word.to_le_bytes()
}

fn on_grid(own: &Elements<'_>, grid: Grid, scale: f64) -> Column {
    let (rows, error) = rows(own.count, 8, |at, row| {
        let position = own.numbers::<3>(at);
        let place = grid.place(position);
        row[..6].copy_from_slice(place.map(short).as_flattened());
        DVec3::from_array(grid.position(place)).distance_squared(DVec3::from_array(position))
    });
    Column {
        rows,
        stride: 8,
        component: ComponentType::U16,
        normalized: false,
        measure: Measure::Positions,
        error: error.sqrt() * scale,
        bounded: true,
        ..empty(own)
    }
}

fn measure_of(own: &Elements<'_>) -> Measure {
    if own.width == 4 { Measure::Tangents } else { Measure::Normals }
}

/// How far apart two directions are, as the square of a chord; directions of no length are anywhere.
fn chord(a: DVec3, b: DVec3) -> f64 {
    match (a.try_normalize(), b.try_normalize()) {
        (Some(a), Some(b)) => a.distance_squared(b),
        _ => 0.0,
    }
}

fn read_bytes(row: &[u8]) -> DVec3 {
    let part = |at: usize| f64::from(row[at].cast_signed()) / 127.0;
    DVec3::new(part(0), part(1), part(2))
}

fn on_octahedron(own: &Elements<'_>) -> Column {
    let signed = own.width == 4;
    let (rows, _) = rows(own.count, 4, |at, row| {
        let [x, y, z, w] = own.numbers::<4>(at);
        let sign = if signed { w } else { 0.0 };
        row.copy_from_slice(&octahedral([x, y, z], sign).map(i8::cast_unsigned));
        0.0
    });
    let mut read = rows.clone();
    // Rows of four bytes are the filter's own.
    let _ = Filter::Octahedral.undo(&mut read, 4);
    let apart = |(at, row): (usize, &[u8])| chord(read_bytes(row), DVec3::from_array(own.numbers::<3>(at)));
    let error = read.chunks_exact(4).enumerate().map(apart).fold(0.0, f64::max);
    Column { rows, content: Content::Directions, measure: measure_of(own), error: error.sqrt(), ..empty(own) }
}

fn in_bytes(own: &Elements<'_>) -> Column {
    let (rows, error) = rows(own.count, 4, |at, row| {
        let numbers = own.numbers::<4>(at);
        let signs = if own.width == 4 { numbers[3] } else { 0.0 };
        let bytes = [numbers[0], numbers[1], numbers[2], signs].map(signed_byte);
        row.copy_from_slice(&bytes.map(i8::cast_unsigned));
        chord(read_bytes(row), DVec3::new(numbers[0], numbers[1], numbers[2]))
    });
    Column { rows, measure: measure_of(own), error: error.sqrt(), ..empty(own) }
}

fn in_unit(own: &Elements<'_>) -> bool {
    (0..own.count)
        .all(|at| own.numbers::<4>(at)[..own.width.min(4)].iter().all(|part| (0.0..=1.0).contains(part)))
}

/// Numbers from 0 to 1 in 16 bits, colors in 8.
fn in_shares(own: &Elements<'_>, measure: Measure) -> Column {
    let colors = measure == Measure::Colors;
    let (most, component) = if colors { (255.0, ComponentType::U8) } else { (65535.0, ComponentType::U16) };
    let (rows, error) = rows(own.count, 4, |at, row| {
        let mut off: f64 = 0.0;
        for (part, number) in own.numbers::<4>(at).into_iter().take(own.width).enumerate() {
            let steps = (number * most).round();
            off = off.max((steps / most - number).abs());
            let [low, high] = short(steps);
            if colors {
                row[part] = low;
            } else {
                row[2 * part..2 * part + 2].copy_from_slice(&[low, high]);
            }
        }
        off
    });
    Column { rows, component, measure, error, ..empty(own) }
}

/// Floats as multiples of a power of two, of which the range of the column has 4095 or more.
fn in_powers(own: &Elements<'_>) -> Column {
    let (mut low, mut high, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], 0.0_f64);
    for at in 0..own.count {
        for (axis, number) in own.numbers::<2>(at).into_iter().enumerate() {
            (low[axis], high[axis]) = (low[axis].min(number), high[axis].max(number));
            most = most.max(number.abs());
        }
    }
    let range = f64::max(high[0] - low[0], high[1] - low[1]);
    let range = if range > 0.0 { range } else { most };
    let mut exponent: i8 = 60;
    while exponent > -60 && power_of_two(exponent) > range / 4095.0 {
        exponent -= 1;
    }
    // No more steps from 0 than the mantissa has.
    while exponent < 100 && power_of_two(exponent) * 8_388_607.0 < most {
        exponent += 1;
    }
    let (rows, error) = rows(own.count, 8, |at, row| {
        let mut off: f64 = 0.0;
        for (word, number) in row.as_chunks_mut::<4>().0.iter_mut().zip(own.numbers::<2>(at)) {
            let step = power_of_two(exponent);
            off = off.max(((number / step).round() * step - number).abs());
            *word = exponential_step(number, exponent).to_le_bytes();
        }
        off
    });
    Column {
        rows,
        stride: 8,
        component: ComponentType::F32,
        normalized: false,
        content: Content::Exponents,
        measure: Measure::Uvs,
        error,
        ..empty(own)
    }
}

/// Shares in bytes whose sum is exactly 1, if they are such.
fn weights(own: &Elements<'_>) -> Column {
    let sum = |at: usize| own.numbers::<4>(at).iter().sum::<f64>();
    let even =
        |at: usize| own.numbers::<4>(at).iter().all(|share| *share >= 0.0) && (sum(at) - 1.0).abs() < 0.01;
    if !(0..own.count).all(even) {
        return copied(own);
    }
    let (rows, error) = rows(own.count, 4, |at, row| {
        let shares = own.numbers::<4>(at);
        let total = sum(at);
        let mut bytes = shares.map(|share| (share / total * 255.0).floor());
        // What is left goes to those that lost the most.
        let mut left = 255.0 - bytes.iter().sum::<f64>();
        let mut order = [0, 1, 2, 3];
        let lost = |part: &usize| shares[*part] / total * 255.0 - bytes[*part];
        order.sort_by(|a, b| lost(b).total_cmp(&lost(a)));
        for part in order {
            if left > 0.5 {
                (bytes[part], left) = (bytes[part] + 1.0, left - 1.0);
            }
        }
        let mut off: f64 = 0.0;
        for ((byte, to), share) in bytes.into_iter().zip(row).zip(shares) {
            off = off.max((byte / 255.0 - share).abs());
            [*to, _] = short(byte);
        }
        off
    });
    Column { rows, component: ComponentType::U8, measure: Measure::Weights, error, ..empty(own) }
}

/// Joints in bytes, if there are no others.
fn joints(own: &Elements<'_>) -> Column {
    let few = (0..own.count).all(|at| own.numbers::<4>(at).iter().all(|joint| *joint < 256.0));
    if !few || own.component == ComponentType::U8 || own.is_float() {
        return copied(own);
    }
    let (rows, _) = rows(own.count, 4, |at, row| {
        for (to, joint) in row.iter_mut().zip(own.numbers::<4>(at)) {
            [*to, _] = short(joint);
        }
        0.0
    });
    Column { rows, component: ComponentType::U8, normalized: false, ..empty(own) }
}

/// What a morph target changes of an attribute whose base is `from`, and stands in the file as `written`.
pub(super) fn target(
    name: &str,
    own: &Elements<'_>,
    (from, written): (Option<&Elements<'_>>, Option<&Column>),
    (profile, place): (Profile, &MeshPlace),
) -> Column {
    let small = profile.is_quantized();
    let made = match (name, from, written) {
        ("POSITION", Some(from), _) if place.grid.is_some() => steps(own, from, place),
        ("POSITION", _, _) if own.is_float() || !small => floats(own, true),
        ("POSITION", _, _) => Column { bounded: true, ..copied(own) },
        ("NORMAL" | "TANGENT", _, _) if !small => floats(own, false),
        ("NORMAL" | "TANGENT", Some(from), Some(written)) if own.is_float() => turned(own, from, written),
        _ => copied(own),
    };
    Column { differs: true, ..made }
}

/// Differences of places on the grid.
fn steps(own: &Elements<'_>, from: &Elements<'_>, place: &MeshPlace) -> Column {
    let Some(grid) = place.grid else { return copied(own) };
    let step = f64::from(grid.step);
    let moved = |at: usize| {
        let (base, by) = (from.numbers::<3>(at), own.numbers::<3>(at));
        let foot = grid.place(base);
        let to: [f64; 3] = std::array::from_fn(|axis| base[axis] + by[axis]);
        // A state may lie outside of the grid of its base.
        let steps: [f64; 3] = std::array::from_fn(|axis| {
            if by[axis] == 0.0 {
                0.0
            } else {
                ((to[axis] - f64::from(grid.offset[axis])) / step).round() - foot[axis]
            }
        });
        let found = grid.position(std::array::from_fn(|axis| foot[axis] + steps[axis]));
        (steps, DVec3::from_array(found).distance_squared(DVec3::from_array(to)))
    };
    let few = (0..own.count).all(|at| moved(at).0.iter().all(|steps| steps.abs() <= 32767.0));
    let stride = if few { 8 } else { 12 };
    let (rows, error) = rows(own.count, stride, |at, row| {
        let (steps, off) = moved(at);
        if few {
            #[expect(clippy::cast_possible_truncation, reason = "all are within the range of the type")]
            row[..6].copy_from_slice(steps.map(|part| (part as i16).to_le_bytes()).as_flattened());
        } else {
            row.copy_from_slice(steps.map(|part| narrow(part).to_le_bytes()).as_flattened());
        }
        off
    });
    Column {
        rows,
        stride,
        component: if few { ComponentType::I16 } else { ComponentType::F32 },
        normalized: false,
        measure: Measure::Positions,
        error: error.sqrt() * place.scale,
        bounded: true,
        ..empty(own)
    }
}

/// Differences from what is read of the base, in bytes where none is greater than 1.
fn turned(own: &Elements<'_>, from: &Elements<'_>, written: &Column) -> Column {
    let mut read = written.rows.clone();
    if written.content == Content::Directions {
        let _ = Filter::Octahedral.undo(&mut read, 4);
    }
    let way = |at: usize| {
        let by = DVec3::from_array(own.numbers::<3>(at));
        let to = DVec3::from_array(from.numbers::<3>(at)) + by;
        let foot = read_bytes(&read[at * 4..at * 4 + 4]);
        (if by == DVec3::ZERO { by } else { to - foot }, foot, to)
    };
    let few = (0..own.count).all(|at| way(at).0.abs().max_element() <= 1.0);
    let stride = if few { 4 } else { 12 };
    let (rows, error) = rows(own.count, stride, |at, row| {
        let (way, foot, to) = way(at);
        if few {
            row[..3].copy_from_slice(&way.to_array().map(|part| signed_byte(part).cast_unsigned()));
            chord(foot + read_bytes(row), to)
        } else {
            row.copy_from_slice(way.to_array().map(|part| narrow(part).to_le_bytes()).as_flattened());
            0.0
        }
    });
    Column {
        rows,
        stride,
        component: if few { ComponentType::I8 } else { ComponentType::F32 },
        normalized: few,
        measure: measure_of(from),
        error: error.sqrt(),
        ..empty(own)
    }
}

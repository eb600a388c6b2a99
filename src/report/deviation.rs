//! The deviation of written triangles, measured by dense sampling.

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::ReportError;
use crate::geometry::mesh::Anchor;
use crate::geometry::number::{FAN, single};
use crate::gltf::{Geometry, Written, WrittenGeometry, read};
use crate::model::{Model, ShapeHandle};
use crate::packing::unpacked;
use crate::realize::{Sources, Window, sources};

/// The greatest distance from samples of the written triangles to the exact surface, metres. Each sample looks
/// for its nearest point near the parameters of its triangle's corners, so the result is local:
/// a sheet that lies near by does not hide a gap. None where a surface has no form of its own to be far from.
#[must_use]
pub fn measure_deviation(
    geometry: &Geometry<'_>,
    known: &WrittenGeometry,
    model: &Model,
    handle: ShapeHandle,
) -> Option<f64> {
    let sources = sources(model, handle);
    if !sources.known() {
        return None;
    }
    let lines = of_lines(geometry, known, &sources);
    if !sources.curved() || known.anchors.len() != geometry.positions.len() {
        return Some(lines);
    }
    // The greatest of a set is the same in any order, so threads do not matter.
    let greatest = (0..geometry.indices.len() / 3)
        .into_par_iter()
        .with_min_len(256)
        .map(|triangle| {
            of_triangle(triangle, geometry, &known.anchors, &sources).into_iter().fold(0.0, f64::max)
        })
        .reduce(|| lines, f64::max);
    Some(greatest)
}

/// Distances from the exact surfaces, for each geometry of a file and each of its triangles at the places of [`FAN`], metres:
/// of the greatest of them and those of lines [`measure_deviation`] tells. None where a surface has no form of its own.
///
/// # Errors
/// When the bytes cannot be read back, which is a bug of the writer.
pub fn deviation_maps(
    written: &Written,
    model: &Model,
    shapes: &[ShapeHandle],
) -> Result<Vec<Option<Vec<[f32; 13]>>>, ReportError> {
    let plain = unpacked(&written.bytes)?;
    let file = read(&plain)?;
    let map = |(known, handle): (&WrittenGeometry, &ShapeHandle)| {
        let geometry = &file.geometries[known.mesh()];
        let sources = sources(model, *handle);
        let count = geometry.indices.len() / 3;
        if !sources.known() || known.anchors.len() != geometry.positions.len() {
            return None;
        }
        if !sources.curved() {
            return Some(vec![[0.0; 13]; count]);
        }
        let of = |triangle| of_triangle(triangle, geometry, &known.anchors, &sources).map(single);
        Some((0..count).into_par_iter().with_min_len(256).map(of).collect())
    };
    Ok(written.geometries.iter().zip(shapes).map(map).collect())
}

/// The greatest distance from samples of written lines to their curves.
fn of_lines(geometry: &Geometry<'_>, known: &WrittenGeometry, sources: &Sources) -> f64 {
    let lines = &geometry.lines;
    if known.line_anchors.len() != lines.positions.len() {
        return 0.0;
    }
    let of_segment = |ends: &[u32; 2]| {
        let [a, b] = ends.map(|end| known.line_anchors[end as usize]);
        let [from, to] = ends.map(|end| DVec3::from_array(lines.positions[end as usize].map(f64::from)));
        let Some(source) = sources.get(a.source) else { return 0.0 };
        let window = Window { u: [a.u, b.u, b.u], v: [0.0; 3] };
        (0..=8_u8).map(|k| source.distance(from.lerp(to, f64::from(k) / 8.0), &window)).fold(0.0, f64::max)
    };
    lines.segments.iter().map(of_segment).fold(0.0, f64::max)
}

fn of_triangle(triangle: usize, geometry: &Geometry<'_>, anchors: &[Anchor], sources: &Sources) -> [f64; 13] {
    let vertices = [0, 1, 2].map(|corner| geometry.indices.at(3 * triangle + corner) as usize);
    let corners = vertices.map(|vertex| anchors[vertex]);
    let places = vertices.map(|vertex| DVec3::from_array(geometry.position(vertex).map(f64::from)));
    let at = |weights: &[f64; 3]| places[0] * weights[0] + places[1] * weights[1] + places[2] * weights[2];
    let around = sources.around(&corners, &places);
    if around.is_empty() {
        return [0.0; 13];
    }
    let nearest = |point: DVec3| {
        around.iter().map(|(source, window)| source.distance(point, window)).fold(f64::INFINITY, f64::min)
    };
    FAN.each_ref().map(|weights| nearest(at(weights)))
}

//! How long a kernel takes for a point of a curve or a surface: `kiln sample --time`.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use serde_json::{Value, json};

use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::surface::{AnySurface, Surface, SurfaceJet};

/// Passes over all points; the fastest counts, since whatever else the machine does only adds.
const PASSES: usize = 7;

/// Evaluates even steps over the domain, points and first derivatives into memory as a caller would have them, and
/// tells how many nanoseconds a point takes.
pub(crate) fn of_curve(name: &str, curve: &AnyCurve, steps: u32) -> Value {
    let domain = curve.domain();
    let places: Vec<f64> = (0..=steps).map(|k| domain.at(f64::from(k) / f64::from(steps))).collect();
    let mut found = vec![(DVec3::ZERO, DVec3::ZERO); places.len()];
    let pass = |found: &mut Vec<(DVec3, DVec3)>| {
        let started = Instant::now();
        curve.tangents(black_box(&places), Side::After, found);
        black_box(found);
        started.elapsed().as_secs_f64()
    };
    let fastest = fastest(|| pass(&mut found));
    json!({ "curve": name, "points": places.len(), "nanoseconds": fastest * 1e9 / places.len() as f64 })
}

/// The same of a surface over a grid of steps: points, both tangents and normals.
pub(crate) fn of_surface(name: &str, surface: &AnySurface, steps: u32) -> Value {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let part = |k: u32| f64::from(k) / f64::from(steps);
    let rows = (0..=steps).flat_map(|row| (0..=steps).map(move |column| (column, row)));
    let places: Vec<(f64, f64)> = rows.map(|(column, row)| (u.at(part(column)), v.at(part(row)))).collect();
    let mut found = vec![surface.evaluate(u.start, v.start); places.len()];
    let pass = |found: &mut Vec<SurfaceJet>| {
        let started = Instant::now();
        for ((u, v), slot) in black_box(&places).iter().zip(found.iter_mut()) {
            *slot = surface.evaluate(*u, *v);
        }
        black_box(found);
        started.elapsed().as_secs_f64()
    };
    let fastest = fastest(|| pass(&mut found));
    json!({ "shape": name, "points": places.len(), "nanoseconds": fastest * 1e9 / places.len() as f64 })
}

fn fastest(pass: impl FnMut() -> f64) -> f64 {
    std::iter::repeat_with(pass).take(PASSES).fold(f64::INFINITY, f64::min)
}

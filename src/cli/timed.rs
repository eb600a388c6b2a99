//! How long a curve's kernel takes for a point: `kiln sample --time`.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use serde_json::{Value, json};

use crate::geometry::curve::{AnyCurve, Curve, Side};

/// Passes over all points; the fastest counts, since whatever else the machine does only adds.
const PASSES: u32 = 7;

/// Evaluates even steps over the domain, points and first derivatives into memory as a caller would have them, and
/// tells how many nanoseconds a point takes.
pub(crate) fn of_curve(name: &str, curve: &AnyCurve, steps: u32) -> Value {
    let domain = curve.domain();
    let places: Vec<f64> = (0..=steps).map(|k| domain.at(f64::from(k) / f64::from(steps))).collect();
    let mut found = vec![(DVec3::ZERO, DVec3::ZERO); places.len()];
    let pass = |found: &mut Vec<(DVec3, DVec3)>| {
        let started = Instant::now();
        for (t, slot) in black_box(&places).iter().zip(found.iter_mut()) {
            let jet = curve.evaluate(*t, Side::After);
            *slot = (jet.point, jet.first);
        }
        black_box(found);
        started.elapsed().as_secs_f64()
    };
    let fastest = (0..PASSES).map(|_| pass(&mut found)).fold(f64::INFINITY, f64::min);
    json!({ "curve": name, "points": places.len(), "nanoseconds": fastest * 1e9 / places.len() as f64 })
}

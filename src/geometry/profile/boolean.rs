//! Union, difference, intersection and symmetric difference of what closed curves enclose.

use glam::DVec2;

use super::chords::{Loop, reach};
use super::trace::Tracer;
use super::{ProfileError, ROUGH};
use crate::geometry::curve::{AnyCurve, Curve as _};
use crate::geometry::number::Bounds;
use crate::geometry::planar::{SetOperation, Winding, overlay};

/// What an operation makes of regions, each bounded by closed curves (inside is where an odd number of them goes around):
/// the first united, cut, or crossed with all others. Parts that touch along a line are joined there. The curves that
/// bound the result are parts of those given.
///
/// # Errors
/// Where nothing is left, where curves touch without crossing, or where they are too intricate.
pub fn combine(regions: &[Vec<AnyCurve>], operation: SetOperation) -> Result<Vec<AnyCurve>, ProfileError> {
    let accuracy = ROUGH * extent(regions.iter().flatten());
    let mut loops = Vec::new();
    let mut polygons: Vec<Vec<Vec<DVec2>>> = Vec::new();
    for region in regions {
        let first = loops.len();
        for curve in region {
            loops.push(Loop::new(curve.clone(), accuracy)?);
        }
        let places: Vec<_> = loops[first..].iter().map(Loop::places).collect();
        polygons.push(overlay(&places, &[], SetOperation::Union, Winding::Odd));
    }
    let mut polygons = polygons.into_iter();
    let first = polygons.next().unwrap_or_default();
    let made = polygons.fold(first, |made, next| overlay(&made, &next, operation, Winding::Odd));
    let size = reach(&loops);
    Tracer { loops: &loops, size, thin: thinnest(&loops, size) }.trace(&made)
}

/// Twice what chords leave out, or rounding.
pub(super) fn thinnest(loops: &[Loop], size: f64) -> f64 {
    let chords = loops.iter().flat_map(|one| &one.stations).map(|station| station.deviation);
    2.0 * chords.fold(1e-9 * size, f64::max)
}

/// A rough extent of curves.
pub(super) fn extent<'a>(curves: impl Iterator<Item = &'a AnyCurve>) -> f64 {
    const SAMPLES: u32 = 64;
    let samples = curves.flat_map(|curve| {
        let domain = curve.domain();
        (0..=SAMPLES).map(move |k| curve.point(domain.at(f64::from(k) / f64::from(SAMPLES))))
    });
    Bounds::of_points(samples).diagonal()
}

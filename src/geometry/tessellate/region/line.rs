//! Lines on surfaces, cut into chords.

use glam::DVec3;

use crate::geometry::number::floor_index;
use crate::geometry::tessellate::TessellateError;

/// A smooth line in space between two of its points, known by going to it from near by.
pub(in crate::geometry::tessellate) trait Line {
    /// The point of the line furthest from the chord between two of its points, or near that, and a bound on how far
    /// the chord leaves the line.
    fn bulge(&self, from: DVec3, to: DVec3) -> (DVec3, f64);

    /// The point of the line near a point.
    fn settled(&self, point: DVec3) -> DVec3;
}

/// How finely a line is cut.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry::tessellate) enum Cut {
    /// Chords within this many metres.
    Within(f64),
    /// So many chords.
    Into(u32),
}

/// Halvings of a line before it counts as too intricate.
const DEEPEST: u32 = 24;

/// Points along a line that goes through `stops`, the first and the last included: all chords leave out alike, and each
/// part between two stops is less than half of the whole for a closed one.
///
/// # Errors
/// More chords than `limit`.
pub(in crate::geometry::tessellate) fn stations(
    line: &dyn Line,
    stops: &[DVec3],
    cut: Cut,
    limit: u64,
) -> Result<Vec<DVec3>, TessellateError> {
    let fine = fine(line, stops, cut, limit)?;
    let weights: Vec<f64> = fine.windows(2).map(|pair| line.bulge(pair[0], pair[1]).1.sqrt()).collect();
    let total: f64 = weights.iter().sum();
    let least = match cut {
        // The sum of the roots of what chords leave out is the number of chords, at a tolerance of 1.
        Cut::Within(tolerance) => total / tolerance.sqrt(),
        Cut::Into(count) => f64::from(count),
    };
    let mut count = floor_index((least - 1e-6).ceil()).max(1);
    loop {
        let chords = even(line, &fine, &weights, count);
        let good = match cut {
            Cut::Within(tolerance) => {
                chords.windows(2).all(|pair| line.bulge(pair[0], pair[1]).1 <= tolerance)
            }
            Cut::Into(_) => true,
        };
        if good || count >= fine.len() - 1 {
            return Ok(if good { chords } else { fine });
        }
        count += 1 + count / 16;
    }
}

/// Points so close that chords between them leave out little more than nothing.
fn fine(line: &dyn Line, stops: &[DVec3], cut: Cut, limit: u64) -> Result<Vec<DVec3>, TessellateError> {
    /// Chords four times as fine as those that are wanted.
    const FINER: f64 = 16.0;
    let mut points = vec![stops[0]];
    for pair in stops.windows(2) {
        let enough = match cut {
            Cut::Within(tolerance) => tolerance / FINER,
            Cut::Into(count) => {
                let count = f64::from(count);
                line.bulge(pair[0], pair[1]).1 / (FINER * count * count)
            }
        };
        halve(line, (pair[0], pair[1]), enough, DEEPEST, &mut points);
        let needed = points.len() as u64 / 4;
        if needed > limit {
            return Err(TessellateError::TooMany { needed, limit });
        }
    }
    Ok(points)
}

fn halve(line: &dyn Line, (from, to): (DVec3, DVec3), enough: f64, depth: u32, points: &mut Vec<DVec3>) {
    let (middle, out) = line.bulge(from, to);
    if out > enough && depth > 0 && middle != from && middle != to {
        halve(line, (from, middle), enough, depth - 1, points);
        halve(line, (middle, to), enough, depth - 1, points);
    } else {
        points.push(to);
    }
}

/// `count` chords with equal sums of the weights.
fn even(line: &dyn Line, fine: &[DVec3], weights: &[f64], count: usize) -> Vec<DVec3> {
    let total: f64 = weights.iter().sum();
    let mut chords = vec![fine[0]];
    let (mut index, mut before) = (0, 0.0);
    for k in 1..count {
        let wanted = total * k as f64 / count as f64;
        while index + 1 < weights.len() && before + weights[index] < wanted {
            before += weights[index];
            index += 1;
        }
        let part = if weights[index] > 0.0 {
            ((wanted - before) / weights[index]).clamp(0.0, 1.0)
        } else {
            // A straight line: shares of its length.
            k as f64 / count as f64
        };
        let ends = if total > 0.0 { (fine[index], fine[index + 1]) } else { (fine[0], fine[fine.len() - 1]) };
        chords.push(line.settled(ends.0.lerp(ends.1, part)));
    }
    chords.push(fine[fine.len() - 1]);
    chords
}

//! What a smooth piece of a curve is: straight, an arc of a circle, or free.

use glam::DVec2;

use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::atan2;

/// A smooth piece as far as operations tell it from others.
pub(super) enum Span {
    /// A straight line.
    Line,
    /// An arc of a circle.
    Arc {
        center: DVec2,
        /// Degrees from its start to its end, positive counter-clockwise.
        sweep: f64,
    },
    /// Anything else.
    Free,
}

/// Where a piece is looked at; uneven, so that nothing periodic looks even.
const PLACES: [f64; 9] = [0.0, 0.137, 0.241, 0.389, 0.502, 0.613, 0.748, 0.871, 1.0];

/// Tells what a piece is. It is an arc where its center of curvature stands still to within 1e-11 of its radius.
pub(super) fn span(piece: &AnyCurve) -> Span {
    let domain = piece.domain();
    if piece.chord_deviation(domain.start, domain.end) == 0.0 {
        return Span::Line;
    }
    match arc(piece) {
        Some((center, sweep)) => Span::Arc { center, sweep },
        None => Span::Free,
    }
}

fn arc(piece: &AnyCurve) -> Option<(DVec2, f64)> {
    let domain = piece.domain();
    let mut centers = Vec::new();
    let mut spokes: Vec<DVec2> = Vec::new();
    for place in PLACES {
        let side = if place == 1.0 { Side::Before } else { Side::After };
        let jet = piece.evaluate(domain.at(place), side);
        let (point, first, second) = (jet.point.truncate(), jet.first.truncate(), jet.second.truncate());
        let bend = first.perp_dot(second);
        if bend == 0.0 {
            return None;
        }
        let center = point + first.perp() * (first.length_squared() / bend);
        centers.push(center);
        spokes.push(point - centers[0]);
    }
    let radius = spokes[0].length();
    let still = centers.iter().all(|center| center.distance(centers[0]) <= 1e-11 * radius);
    let round = spokes.iter().all(|spoke| (spoke.length() - radius).abs() <= 1e-11 * radius);
    let turn = |pair: &[DVec2]| atan2(pair[0].perp_dot(pair[1]), pair[0].dot(pair[1])).to_degrees();
    (still && round).then(|| (centers[0], spokes.windows(2).map(turn).sum()))
}

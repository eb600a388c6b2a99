//! Edges that cross by a little, led over the corners that are in their way.
//!
//! Of two edges that cross, one passes close to an end of the other; it is bent to run over that end. So the edges
//! become chains between places and cross no more, if crossings are shallow. It is a greedy form of snap rounding: J.
//! Hobby, Practical segment intersection with finite precision output, Computational Geometry 13 (1999).

use glam::DVec2;

use super::Polygon;
use crate::geometry::number::floor_index;
use crate::geometry::planar::{crossing_segments, distance_to_segment};

/// Edges are bent by no more than this part of the polygon.
const DEEPEST: f64 = 0.01;

/// How much work may be spent: corners times crossings.
const WORK: f64 = 4e6;

/// For each edge of the polygon the places that it runs over, its end last; `None` where edges cross deeply, too
/// often, or run over one stretch the same way.
pub(super) fn ways(polygon: &Polygon, of: &[u32], points: &[DVec2]) -> Option<Vec<Vec<u32>>> {
    let mut ways: Vec<Vec<u32>> = polygon.edges().map(|[_, to]| vec![of[to as usize]]).collect();
    let starts: Vec<u32> = polygon.edges().map(|[from, _]| of[from as usize]).collect();
    let reach = size(points);
    #[expect(clippy::cast_precision_loss, reason = "a limit need not be exact")]
    let rounds = floor_index(WORK / points.len() as f64).clamp(16, 4096);
    for _ in 0..rounds {
        // Each piece as its edge, its place on the way, and its ends.
        let mut pieces: Vec<(usize, usize, [u32; 2])> = Vec::with_capacity(points.len());
        for (edge, way) in ways.iter().enumerate() {
            let mut here = starts[edge];
            for (k, &next) in way.iter().enumerate() {
                if here != next {
                    pieces.push((edge, k, [here, next]));
                }
                here = next;
            }
        }
        let place = |ends: [u32; 2]| ends.map(|place| points[place as usize]);
        let segments: Vec<[DVec2; 2]> = pieces.iter().map(|piece| place(piece.2)).collect();
        let Some([one, other]) = crossing_segments(&segments) else { return Some(ways) };
        let ends = [(one, other), (other, one)].into_iter().flat_map(|(bent, kept)| {
            let far = segments[bent];
            pieces[kept].2.map(|end| (distance_to_segment(points[end as usize], far), bent, end))
        });
        let (distance, bent, end) = ends
            .filter(|(_, bent, end)| !pieces[*bent].2.contains(end))
            .min_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))))?;
        if distance > DEEPEST * reach {
            return None;
        }
        let (edge, k, _) = pieces[bent];
        ways[edge].insert(k, end);
    }
    None
}

fn size(points: &[DVec2]) -> f64 {
    let low = points.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = points.iter().copied().reduce(DVec2::max).unwrap_or_default();
    (high - low).length()
}

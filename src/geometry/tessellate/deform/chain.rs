//! Lines under maps that bend.

use glam::DVec3;

use super::DeformError;
use super::images::{FlatChart, image_of};
use super::split::anchor_between;
use crate::geometry::mesh::{Wire, WirePoint};
use crate::geometry::surface::Deformation;
use crate::geometry::tessellate::patch::judge::judge_chord;
use crate::geometry::tessellate::{Deviation, Evidence, TessellateError};

/// Times that a segment is halved.
const HALVINGS: u32 = 24;

/// Halves the segments of a wire until their images follow the bent ones within the tolerance, and moves it.
pub(super) fn deform(
    wire: &Wire,
    map: &Deformation,
    periods: &[(f64, f64)],
    tolerance: f64,
    limit: u64,
) -> Result<(Wire, Deviation), DeformError> {
    let kinks = map.kinks(&wire.bounds());
    let mut chain = Chain { map, periods, tolerance, limit, points: Vec::new(), deviation: Deviation::NONE };
    let mut made = Wire::default();
    for (strand, range) in wire.ranges() {
        let points = &wire.points[range.start as usize..range.end as usize];
        let Some(first) = points.first() else { continue };
        let mut last = *first;
        let back = strand.closed.then_some(first);
        for next in points[1..].iter().chain(back) {
            for part in crossings(&kinks, last.position, next.position) {
                let middle = chain.between(&last, next, part);
                chain.segment(&last, &middle, HALVINGS)?;
                last = middle;
            }
            chain.segment(&last, next, HALVINGS)?;
            last = *next;
        }
        if !strand.closed {
            let position = image_of(map, last.position)?.point;
            chain.points.push(WirePoint { position, ..last });
        }
        made.push(std::mem::take(&mut chain.points), strand.closed, strand.origin);
        let needed = made.points.len() as u64;
        if needed > limit {
            return Err(TessellateError::TooMany { needed, limit }.into());
        }
    }
    Ok((made, chain.deviation))
}

/// Parts of the way from a place to another at which it crosses planes, in order; counted anew from each on.
fn crossings(planes: &[(DVec3, f64)], from: DVec3, to: DVec3) -> Vec<f64> {
    /// Nearer to an end than this is at the end.
    const END: f64 = 1e-9;
    let cross = |(normal, offset): &(DVec3, f64)| {
        let (start, end) = (from.dot(*normal) - offset, to.dot(*normal) - offset);
        let part = start / (start - end);
        (start * end < 0.0 && part > END && part < 1.0 - END).then_some(part)
    };
    let mut parts: Vec<f64> = planes.iter().filter_map(cross).collect();
    parts.sort_by(f64::total_cmp);
    parts.dedup_by(|next, last| *next - *last <= END);
    let mut passed = 0.0;
    for part in &mut parts {
        let whole = *part;
        *part = (whole - passed) / (1.0 - passed);
        passed = whole;
    }
    parts
}

struct Chain<'a> {
    map: &'a Deformation,
    periods: &'a [(f64, f64)],
    tolerance: f64,
    limit: u64,
    /// Images of the strand so far.
    points: Vec<WirePoint>,
    deviation: Deviation,
}

impl Chain<'_> {
    fn between(&self, a: &WirePoint, b: &WirePoint, part: f64) -> WirePoint {
        WirePoint {
            position: a.position.lerp(b.position, part),
            color: a.color.lerp(b.color, part),
            anchor: anchor_between((a.anchor, b.anchor), part, self.periods),
        }
    }

    /// Adds the image of a segment without its last point.
    fn segment(&mut self, a: &WirePoint, b: &WirePoint, halvings: u32) -> Result<(), DeformError> {
        let needed = self.points.len() as u64;
        if needed > self.limit {
            return Err(TessellateError::TooMany { needed, limit: self.limit }.into());
        }
        let images = [image_of(self.map, a.position)?.point, image_of(self.map, b.position)?.point];
        let middle = a.position.midpoint(b.position);
        let chart = FlatChart::new(self.map, [a.position, b.position, middle]);
        let corners = [chart.corner(a.position), chart.corner(b.position)];
        let (bound, evidence) = judge_chord(&chart, (&corners[0], &corners[1]), images, self.tolerance);
        if bound > self.tolerance && halvings > 0 {
            let middle = self.between(a, b, 0.5);
            self.segment(a, &middle, halvings - 1)?;
            return self.segment(&middle, b, halvings - 1);
        }
        let evidence = if bound == 0.0 { Evidence::Exact } else { evidence };
        self.deviation = self.deviation.union(Deviation { bound, evidence });
        self.points.push(WirePoint { position: images[0], ..*a });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::crossings;

    #[test]
    fn crossings_count_from_the_last_one_on() {
        let planes = [(DVec3::X, 3.0), (DVec3::X, 1.0), (DVec3::X, 9.0), (DVec3::Y, 0.0)];
        let parts = crossings(&planes, DVec3::ZERO, DVec3::X * 4.0);
        assert_eq!(parts, [0.25, (0.75 - 0.25) / 0.75]);
    }
}

//! What the triangles between rows leave out.

use glam::{DVec2, DVec3};

use super::super::{Deviation, Evidence};
use super::Plan;
use super::rows::{GUARD, MARGIN};
use crate::geometry::curve::Side;
use crate::geometry::surface::{Outline, SectionPoint, Stand};

/// What is added to the margin for each radian that a row twists: distances are taken across the tangent plane of
/// one place, from which a twisted surface departs. Dense samples of ellipses, rectangles and lines on straight
/// and bent paths, at 50 to 5000 degrees, exceed what is measured so by up to half of each radian.
const TWIST_MARGIN: f64 = 0.7;

impl Plan<'_> {
    /// e1 of the section's chords plus e2 along the way.
    pub(super) fn measure(&self) -> Deviation {
        let change = &self.surface.change;
        let greatest = change.greatest_weight() * change.scale.greatest().max_element();
        let e1 = greatest * self.columns.iter().map(|columns| columns.deviation).fold(0.0, f64::max);
        let e1 = e1 * self.lean_factor();
        let reach = self.surface.reach();
        let mut e2 = 0.0_f64;
        for row in 0..self.rows.len() - 1 {
            let (from, to) = (self.rows[row].v, self.rows[row + 1].v);
            if self.surface.is_straight(from, to) && !self.comes_back_shifted(row + 1) {
                continue;
            }
            let sampled = self.row_deviation(row);
            // A chord over whole turns looks short to samples: then the way's own bound speaks.
            let bend = self.surface.carrier.bend(from, to, reach);
            e2 = e2.max(if bend > 2.0 * GUARD * sampled { bend } else { sampled });
        }
        let evidence = match (e1, e2) {
            (0.0, 0.0) => Evidence::Exact,
            (_, 0.0) if change.profiles() == 1 => Evidence::Proved,
            _ => Evidence::Sampled,
        };
        Deviation { bound: e1 + e2 * MARGIN, evidence }
    }

    /// What leans toward a mitre leaves out more than its section: of a chord's distance in the section the part
    /// `lean` goes along the way, and a surface that narrows sees its slope of that.
    fn lean_factor(&self) -> f64 {
        let surface = self.surface;
        let reach = surface.outlines.iter().map(Outline::reach).fold(0.0, f64::max);
        let length = surface.carrier.length(reach);
        let of = |stand: &Stand| {
            let (lean, mix) = (stand.plane.slope.map_or(0.0, |slope| slope.lean.length()), &stand.mix);
            let mixing: f64 = mix.rates.iter().map(|rate| rate.abs()).sum();
            let rate = mix.scale_rate.abs().max_element() + mixing * mix.scale.max_element();
            lean * rate * reach / length
        };
        self.rows
            .iter()
            .flat_map(|row| [of(&row.before), of(&row.after)])
            .fold(1.0, |most, of| most.max(1.0 + of))
    }

    /// Greatest distance to the surface from the cells between a row and the next.
    fn row_deviation(&self, row: usize) -> f64 {
        let (from, to) = (self.rows[row].v, self.rows[row + 1].v);
        let middle = self.between(row, 0.5);
        if self.surface.change.is_constant() && !middle.plane.leans && !self.comes_back_shifted(row + 1) {
            return self.plain_cell_deviation(row, &middle);
        }
        // Twisted cells are saddles: their triangles may be furthest away before and behind the middle.
        let lean = 1.0 + TWIST_MARGIN * self.surface.carrier.turn_between(from, to).abs();
        let parts = [0.25, 0.5, 0.75].map(|part| self.cell_deviation(row, &self.between(row, part), part));
        parts.into_iter().fold(0.0, f64::max) * lean
    }

    /// The stand at a part of the way from a row to the next: where the plane holds the point of the chord.
    fn between(&self, row: usize, part: f64) -> Stand {
        let (from, to) = (self.rows[row].v, self.rows[row + 1].v);
        let v = from + (to - from) * part;
        let stand = self.surface.stand(v, Side::After);
        let chord = (self.rows[row].after.plane.origin, self.rows[row + 1].before.plane.origin);
        let along = stand.plane.frame.along;
        let speed = stand.plane.velocity.dot(along);
        let step = (chord.0.lerp(chord.1, part) - stand.plane.origin).dot(along) / speed;
        let margin = 0.05 * (to - from);
        if !step.is_finite() || step.abs() < 1e-3 * margin {
            return stand;
        }
        self.surface.stand((v + step).clamp(from + margin, to - margin), Side::After)
    }

    /// Greatest distance to the surface from chords and diagonals between two rows, at `part` of their length
    /// where `middle` stands.
    fn cell_deviation(&self, row: usize, middle: &Stand, part: f64) -> f64 {
        let mut deviation = 0.0_f64;
        for (outline, columns) in self.columns.iter().enumerate() {
            let mut last: Option<(DVec3, SectionPoint)> = None;
            for column in 0..columns.len() {
                let here = columns.at(column, Some(Side::After), &middle.mix);
                let near = self.stand_point(outline, row, column, Side::After);
                let far = self.stand_point(outline, row + 1, column, Side::Before);
                let away = near.lerp(far, part) - middle.point(&here);
                deviation = deviation.max(if columns.is_edge(column) {
                    // At a corner of the section there is no one normal, and at its end the surface ends: all that is
                    // not along the way counts.
                    let along = middle.onward(&here).normalize_or_zero();
                    (away - along * away.dot(along)).length()
                } else {
                    away.dot(middle.normal(&here)).abs()
                });
                if let Some((near, before)) = last {
                    let place = chord_point(&before, &here, part);
                    let away = near.lerp(far, part) - middle.point(&place);
                    deviation = deviation.max(away.dot(middle.normal(&place)).abs());
                }
                last = Some((near, here));
            }
        }
        deviation
    }

    /// A point of a row before corners are mitred, in the last row of a closed way where the first row has it.
    fn stand_point(&self, outline: usize, row: usize, column: usize, side: Side) -> DVec3 {
        let columns = &self.columns[outline];
        if self.comes_back_shifted(row) {
            let stand = &self.rows[0].after;
            let column = self.seam[outline].column(column, columns.len());
            return stand.point(&columns.at(column, Some(Side::After), &stand.mix));
        }
        let stand = if side == Side::Before { &self.rows[row].before } else { &self.rows[row].after };
        stand.point(&columns.at(column, Some(Side::After), &stand.mix))
    }

    /// Whether the columns of a row are those of the first row, shifted.
    fn comes_back_shifted(&self, row: usize) -> bool {
        row + 1 == self.rows.len() && self.shifted
    }

    /// The same as [`Plan::cell_deviation`] in the middle, without twist and change: the normals of the surface lie
    /// in the plane of the middle section, where all is measured in its own two coordinates.
    fn plain_cell_deviation(&self, row: usize, middle: &Stand) -> f64 {
        let (start, end) = (&self.rows[row].after.plane, &self.rows[row + 1].before.plane);
        let plane = &middle.plane;
        let flat = |point: DVec3| {
            let away = point - plane.origin;
            DVec2::new(away.dot(plane.frame.side), away.dot(plane.frame.up))
        };
        let mut deviation = 0.0_f64;
        for columns in &self.columns {
            let mut before: Option<(DVec2, DVec2)> = None;
            for column in columns.plain() {
                let here = column.place();
                let (near, far) = (flat(start.point(here.x, here.y)), flat(end.point(here.x, here.y)));
                let away = (near + far) / 2.0 - here;
                let across = column.normal(Some(Side::After)).dot(away).abs();
                deviation = deviation.max(if column.edge { away.length() } else { across });
                if let Some((last, last_near)) = before {
                    let away = (last_near + far) / 2.0 - (last + here) / 2.0;
                    deviation = deviation.max(column.chord.dot(away).abs());
                }
                before = Some((here, near));
            }
        }
        deviation
    }
}

/// A point on the chord between two points of a section.
fn chord_point(one: &SectionPoint, other: &SectionPoint, part: f64) -> SectionPoint {
    let across = other.place - one.place;
    SectionPoint {
        place: one.place.lerp(other.place, part),
        across: if across == DVec2::ZERO { other.across } else { across },
        rate: one.rate.lerp(other.rate, part),
    }
}

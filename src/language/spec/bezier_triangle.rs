//! Bezier triangles by control points.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::patch::SpokenContinuity;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;

table! {
    /// Curved triangles by control points, alone or joined to one skin: where sides agree they are shared, so that the skin
    /// has no cracks. The points of a triangle stand in rows of 1, 2, 3 and so on: the first is a corner, the last row the
    /// side across from it. A triangle of 3 points is flat, one of 6 is quadratic, of 10 cubic, of 15 quartic.
    "bezier triangles" pub BezierTriangles {
        /// Control points `[x, y, z]`: of one triangle, row by row, or those that `triangles` choose from.
        points: Sp<Vec<Sp<DVec3>>> => Check::items(3);
        /// For each triangle the numbers of its control points in `points`, row by row. Without it all points are one
        /// triangle.
        triangles: Option<Sp<Vec<Sp<Vec<Sp<u32>>>>>> => Check::items(1);
        /// The number of the first point: 0, or 1 as in printed tables.
        first: Sp<u32> = 0 => Check::within(0.0, 1.0);
        /// For each of `points` how strongly it attracts. An eighth of a ball needs them; without them, all are equal.
        weights: Option<Sp<Vec<Sp<f64>>>> => Check::above(0.0);
        /// How smoothly all triangles must join; an error names the sides that do not. C1 and C2 hold where triangles are
        /// pieces of one smooth map over some flat triangles, whatever the shapes of these.
        continuity: Option<Sp<SpokenContinuity>>;
        /// How many degrees tangent planes may differ under `continuity`, and derivatives by the same share.
        continuity_angle: Sp<f64> = 0.01 => Check::within(0.0, 90.0);
    }
    checked check
}

/// The highest degree of a triangle.
const MOST_DEGREE: usize = 25;

impl BezierTriangles {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let weighed = self.check_weights(reader);
        let Some(triangles) = &self.triangles else {
            let fits = check_count("`points`", self.points.len(), self.points.span, reader);
            return weighed && fits && self.check_first(reader);
        };
        let mut good = weighed;
        for (index, triangle) in triangles.iter().enumerate() {
            let name = format!("`triangles[{index}]`");
            good &= check_count(&name, triangle.len(), triangle.span, reader);
            for number in triangle.iter() {
                good &= self.check_number(&name, *number, reader);
            }
        }
        good
    }

    fn check_weights(&self, reader: &mut Reader<'_>) -> bool {
        let Some(weights) = self.weights.as_ref().filter(|weights| weights.len() != self.points.len()) else {
            return true;
        };
        let message = format!("{} points have {} weights", self.points.len(), weights.len());
        let report = Diagnostic::error(Code::PatchPoints, message)
            .at(weights.span, format!("expected {}", self.points.len()))
            .also(self.points.span, "one for each of these");
        reader.report(report);
        false
    }

    fn check_first(&self, reader: &mut Reader<'_>) -> bool {
        if self.first.span.is_none() {
            return true;
        }
        let report =
            Diagnostic::error(Code::Conflict, "`first` says how `triangles` count, which is not written")
                .at(self.first.span, "has no effect");
        reader.report(report);
        false
    }

    fn check_number(&self, name: &str, number: Sp<u32>, reader: &mut Reader<'_>) -> bool {
        let first = self.first.value;
        let last = u64::from(first) + self.points.len() as u64;
        if number.value >= first && u64::from(number.value) < last {
            return true;
        }
        let message = format!("{name} names the point {}, which does not exist", number.value);
        let report = Diagnostic::error(Code::PatchIndex, message);
        let report = report.at(number.span, format!("points go from {first} to {}", last - 1));
        let counts_from_one = first == 0 && u64::from(number.value) == last;
        reader.report(if counts_from_one {
            report.help("where a table counts from 1, write `first = 1`")
        } else {
            report
        });
        false
    }
}

/// Whether so many points fill a triangle.
fn check_count(name: &str, points: usize, span: Span, reader: &mut Reader<'_>) -> bool {
    let full = |degree: usize| (degree + 1) * (degree + 2) / 2;
    if (1..=MOST_DEGREE).any(|degree| full(degree) == points) {
        return true;
    }
    let message = format!("{name} has {points} points, which do not fill a triangle");
    let most = full(MOST_DEGREE);
    let above = (1..=MOST_DEGREE).find(|degree| full(*degree) > points);
    let expected = match above {
        None => format!("at most {most}, which is degree {MOST_DEGREE}"),
        Some(1) => "expected 3".to_owned(),
        Some(degree) => format!("expected {} or {}", full(degree - 1), full(degree)),
    };
    let report = Diagnostic::error(Code::PatchPoints, message)
        .at(span, expected)
        .note("rows of 1, 2, 3, ... points: 3 of degree 1, 6 of degree 2, 10 of degree 3, 15 of degree 4");
    reader.report(report);
    false
}

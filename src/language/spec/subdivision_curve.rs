//! Subdivision curves.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::cubic::{Border, closed_without_ends};
use crate::language::spec::point::Point;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::{check_closed, report_repeated};
use crate::language::value::show_number;

table! {
    /// A polygon whose corners are rounded again and again: to the smooth limit, or a few times when `levels` is
    /// written.
    "subdivision" pub SubdivisionCurve {
        /// The corners of the polygon, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// How it is refined.
        scheme: Sp<CurveScheme>;
        /// Of the four-point scheme: how far new points leave the edges. 1/16 = 0.0625 gives the smoothest curves; a limit
        /// with a direction everywhere is proved between 0 and 1/8. 0.0625 when it is not written.
        tension: Option<Sp<f64>> => Check::within(-0.249, 0.249);
        /// How often it is refined; the result is then a polyline. The limit when it is not written.
        levels: Option<Sp<u32>> => Check::within(0.0, 16.0);
        /// Whether the polygon is closed.
        closed: Sp<bool> = false;
        /// What happens where an open polygon ends.
        ends: Sp<Border> = Border::Reflect;
    }
    checked check
}

choices! {
    /// How a polygon is refined.
    CurveScheme {
        /// Corners are cut at the quarters of the edges; the limit is the quadratic B-spline.
        Chaikin = "chaikin";
        /// Goes through all points; new ones lie off the middles of the edges.
        FourPoint = "four-point";
        /// Middles of edges, and corners moved inward; the limit is the cubic B-spline.
        ThreePoint = "three-point";
    }
}

/// The most points that a refined polygon has.
const MOST_POINTS: usize = 1 << 20;

/// Refinements that stand for a limit that is not proved.
pub(crate) const UNPROVED_LEVELS: u32 = 8;

impl SubdivisionCurve {
    /// The tension of the four-point scheme.
    #[must_use]
    pub fn tension(&self) -> f64 {
        self.tension.map_or(0.0625, |tension| tension.value)
    }

    /// How often to refine; `None` is the limit. Where no limit is proved the polygon is refined eight times.
    #[must_use]
    pub fn refinements(&self) -> Option<u32> {
        let levels = self.levels.map(|levels| levels.value);
        levels
            .or((self.scheme.value == CurveScheme::FourPoint && !self.has_limit()).then_some(UNPROVED_LEVELS))
    }

    fn has_limit(&self) -> bool {
        self.tension() > 0.0 && self.tension() < 0.125
    }

    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.closed.value && !self.ends.span.is_none() {
            reader.report(closed_without_ends("subdivision curve", self.ends.span, self.closed.span));
            return false;
        }
        check_closed("subdivision curve", self.points.len(), self.closed, reader)
            && self.check_count(reader)
            && report_repeated(&self.points, self.closed.value, "points", reader)
            && self.check_size(reader)
            && self.check_tension(reader)
    }

    fn check_count(&self, reader: &mut Reader<'_>) -> bool {
        let least = match (self.ends.value, self.scheme.value) {
            (Border::Cut, CurveScheme::Chaikin) => 3,
            (Border::Cut, CurveScheme::ThreePoint) => 4,
            (Border::Cut, CurveScheme::FourPoint) => 6,
            (Border::Reflect, _) => 2,
        };
        let count = self.points.len();
        if self.closed.value || count >= least {
            return true;
        }
        let message = format!(
            "the {} scheme with cut ends needs at least {least} points, found {count}",
            self.scheme.value.text()
        );
        let report = Diagnostic::error(Code::FewPoints, message)
            .at(self.ends.span, "nothing would be left")
            .help("leave `ends` out: the curve then runs from the first to the last point");
        reader.report(report);
        false
    }

    fn check_size(&self, reader: &mut Reader<'_>) -> bool {
        let Some(levels) = &self.levels else { return true };
        let points = self.points.len() << levels.value;
        if points <= MOST_POINTS {
            return true;
        }
        let message = format!(
            "{} levels make {points} points of {}, more than {MOST_POINTS}",
            levels.value,
            self.points.len()
        );
        let report = Diagnostic::error(Code::OutOfRange, message)
            .at(levels.span, "too many levels")
            .help("leave `levels` out for the limit");
        reader.report(report);
        false
    }

    fn check_tension(&self, reader: &mut Reader<'_>) -> bool {
        let Some(tension) = &self.tension else { return true };
        if self.scheme.value != CurveScheme::FourPoint {
            let message = format!("the {} scheme has no tension", self.scheme.value.text());
            let report = Diagnostic::error(Code::Conflict, message)
                .at(tension.span, "belongs to \"four-point\"")
                .also(self.scheme.span, "the scheme");
            reader.report(report);
            return false;
        }
        if !self.has_limit() {
            let shown = show_number(tension.value);
            let message = format!("no smooth limit is proved for a tension of {shown}");
            let report = Diagnostic::warning(Code::TensionRange, message)
                .at(tension.span, "not between 0 and 0.125")
                .help("0.0625 gives the smoothest curves");
            reader.report(if self.levels.is_none() {
                report.note(format!("the polygon is refined {UNPROVED_LEVELS} times instead"))
            } else {
                report
            });
        }
        true
    }
}

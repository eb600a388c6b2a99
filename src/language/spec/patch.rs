//! Patches by control points: Bezier and other bicubic ones, alone or as networks, and Hermite surfaces.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::cubic::{Basis, Border};
use crate::language::spec::grid::{Degrees, Directions, Rows, same_size};
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;

table! {
    /// Curved patches by control points, joined to one skin: Bezier patches as of the Utah teapot, or bicubic ones in
    /// another basis. Patches whose sides agree share them, so that the skin has no cracks. Either `control` is
    /// written, a grid for all of them, or `points` and `patches`.
    "patches" pub Patches {
        /// Control points in a grid: rows of points `[x, y, z]`. u runs along a row, v from row to row. Bezier patches
        /// share the points between them: a row of bicubic ones has 4, 7, 10, ... points.
        control: Option<Sp<Rows<DVec3>>>;
        /// Control points that patches choose from, in place of `control`.
        points: Option<Sp<Vec<Sp<DVec3>>>> => Check::items(1);
        /// For each patch the numbers of its control points in `points`, row by row: 16 of a bicubic one.
        patches: Option<Sp<Vec<Sp<Vec<Sp<u32>>>>>>;
        /// The number of the first point: 0, or 1 as in printed tables.
        first: Sp<u32> = 0 => Check::within(0.0, 1.0);
        /// Degree of Bezier patches, one for both directions or `[u, v]`: 3 is bicubic.
        degree: Sp<Degrees> = Degrees { u: 3, v: 3 };
        /// How control points make a patch: `"bezier"`; `"b-spline"` (very smooth, near its points); `"catmull-rom"`
        /// (smooth, through its points); `"hermite"` (in both directions start, end, and the derivatives there: 16 vectors);
        /// or four rows of four numbers, the first row for the third power.
        basis: Sp<Basis> = Basis::Bezier;
        /// Of a grid in a basis given as a matrix: how many points further on the next patch begins.
        step: Option<Sp<u32>> => Check::within(1.0, 4.0);
        /// Directions in which the grid runs back to its start: `["u"]`, `["v"]` or both. Points are not repeated.
        closed: Sp<Directions> = Directions::default();
        /// How an open grid of B-spline or Catmull-Rom patches ends.
        ends: Sp<Border> = Border::Reflect;
        /// How smoothly all patches must join; an error names the sides that do not.
        continuity: Option<Sp<SpokenContinuity>>;
        /// How many degrees tangent planes may differ under `continuity`, and derivatives by the same share.
        continuity_angle: Sp<f64> = 0.01 => Check::within(0.0, 90.0);
    }
    checked check
}

table! {
    /// A surface through a grid of points with given tangents (Ferguson patches): bicubic between every four points.
    "hermite surface" pub HermiteSurface {
        /// The points that it goes through: rows of `[x, y, z]`. u runs along a row and goes 1 further from point to
        /// point, v from row to row.
        points: Sp<Rows<DVec3>>;
        /// For each point the derivative by u: direction along the row, and how far it leads.
        along_u: Sp<Rows<DVec3>>;
        /// For each point the derivative by v.
        along_v: Sp<Rows<DVec3>>;
        /// For each point the twist, the derivative by u and v. Without it, zero: flat spots at the points.
        twists: Option<Sp<Rows<DVec3>>>;
    }
    checked check
}

choices! {
    /// How smoothly patches join.
    SpokenContinuity {
        /// They have a common line.
        G0 = "G0";
        /// They have a common line, with equal parameters.
        C0 = "C0";
        /// Their tangent planes agree.
        G1 = "G1";
        /// Their first derivatives agree.
        C1 = "C1";
        /// Their first and second derivatives agree.
        C2 = "C2";
    }
}

impl Patches {
    /// Control points of one patch.
    #[must_use]
    pub fn points_of_patch(&self) -> usize {
        (self.degree.u as usize + 1) * (self.degree.v as usize + 1)
    }

    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let degree = self.check_degree(reader);
        let given = match (&self.control, &self.points, &self.patches) {
            (Some(_), None, None) => self.check_step(reader) && self.check_ends(reader),
            (None, Some(points), Some(patches)) => {
                self.check_lists(points, patches, reader) && self.check_no_grid(patches.span, reader)
            }
            (Some(control), Some(other), _) => both(control.span, "points", other.span, reader),
            (Some(control), _, Some(other)) => both(control.span, "patches", other.span, reader),
            (None, points, patches) => {
                let missing = match (points, patches) {
                    (None, None) => "`control`, or `points` and `patches`",
                    (None, _) => "`points`, which `patches` chooses from",
                    _ => "`patches`, which says how points make patches",
                };
                let report = Diagnostic::error(Code::MissingField, format!("patches need {missing}"));
                reader.report(report.at(span, "no control points"));
                false
            }
        };
        degree && given
    }

    fn check_degree(&self, reader: &mut Reader<'_>) -> bool {
        let cubic = self.degree.value == Degrees { u: 3, v: 3 };
        if cubic || self.basis.value == Basis::Bezier {
            return true;
        }
        let report = Diagnostic::error(Code::Conflict, "only Bezier patches have degrees other than 3")
            .at(self.degree.span, "not of this basis")
            .also(self.basis.span, "bicubic")
            .help("B-splines of any degree are written `[shape.NAME.b-spline]`");
        reader.report(report);
        false
    }

    fn check_step(&self, reader: &mut Reader<'_>) -> bool {
        let Some(step) = &self.step else { return true };
        if matches!(self.basis.value, Basis::Matrix(_)) {
            return true;
        }
        let report = Diagnostic::error(Code::Conflict, "the basis says how patches follow each other")
            .at(step.span, "has no effect")
            .help("leave `step` out: it is for a basis that is given as a matrix");
        reader.report(report);
        false
    }

    fn check_ends(&self, reader: &mut Reader<'_>) -> bool {
        if self.ends.span.is_none() || matches!(self.basis.value, Basis::BSpline | Basis::CatmullRom) {
            return true;
        }
        let message = "patches of this basis have no choice of ends";
        let report = Diagnostic::error(Code::Conflict, message)
            .at(self.ends.span, "has no effect")
            .help("leave `ends` out: it is for \"b-spline\" and \"catmull-rom\"");
        reader.report(report);
        false
    }

    /// What says how a grid runs means nothing for patches that are listed.
    fn check_no_grid(&self, patches: Span, reader: &mut Reader<'_>) -> bool {
        let written = [
            ("step", self.step.map_or(Span::NONE, |step| step.span)),
            ("closed", self.closed.span),
            ("ends", self.ends.span),
        ];
        let mut good = true;
        for (name, span) in written.into_iter().filter(|(_, span)| !span.is_none()) {
            let report =
                Diagnostic::error(Code::Conflict, format!("`{name}` is for a grid of `control` points"))
                    .at(span, "has no effect")
                    .also(patches, "each patch names its points");
            reader.report(report);
            good = false;
        }
        good
    }

    fn check_lists(
        &self,
        points: &Sp<Vec<Sp<DVec3>>>,
        patches: &Sp<Vec<Sp<Vec<Sp<u32>>>>>,
        reader: &mut Reader<'_>,
    ) -> bool {
        let expected = self.points_of_patch();
        if patches.is_empty() {
            let report = Diagnostic::error(Code::WrongLength, "`patches` needs at least 1 item, found none");
            reader.report(report.at(patches.span, "no patches"));
            return false;
        }
        let mut good = true;
        for (index, patch) in patches.iter().enumerate() {
            if patch.len() != expected {
                reader.report(self.wrong_count(index, patch, expected));
                good = false;
            }
            for number in patch.iter() {
                good &= self.check_number(index, *number, points.len(), reader);
            }
        }
        good
    }

    fn wrong_count(&self, index: usize, patch: &Sp<Vec<Sp<u32>>>, expected: usize) -> Diagnostic {
        let Degrees { u, v } = self.degree.value;
        let message =
            format!("`patches[{index}]` has {} points, of degree {u} by {v} it has {expected}", patch.len());
        Diagnostic::error(Code::PatchPoints, message)
            .at(patch.span, format!("expected {expected}"))
            .note(format!("{} rows of {} points, u runs along a row", v + 1, u + 1))
    }

    fn check_number(&self, index: usize, number: Sp<u32>, points: usize, reader: &mut Reader<'_>) -> bool {
        let first = self.first.value;
        let last = u64::from(first) + points as u64;
        if number.value >= first && u64::from(number.value) < last {
            return true;
        }
        let message = format!("`patches[{index}]` names the point {}, which does not exist", number.value);
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

fn both(control: Span, name: &str, other: Span, reader: &mut Reader<'_>) -> bool {
    let report = Diagnostic::error(Code::Conflict, format!("`control` and `{name}` exclude each other"))
        .at(other, "a list of patches")
        .also(control, "a grid");
    reader.report(report);
    false
}

impl HermiteSurface {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let points = ("points", &self.points);
        let mut good = same_size(("along-u", &self.along_u), points, reader);
        good &= same_size(("along-v", &self.along_v), points, reader);
        if let Some(twists) = &self.twists {
            good &= same_size(("twists", twists), points, reader);
        }
        let (rows, columns) = (self.points.rows(), self.points.columns());
        if rows < 2 || columns < 2 {
            let message =
                format!("a Hermite surface needs at least 2 rows of 2 points, found {rows} of {columns}");
            reader.report(Diagnostic::error(Code::FewPoints, message).at(self.points.span, "too few"));
            good = false;
        }
        good
    }
}

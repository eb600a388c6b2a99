//! Cubic pieces by a basis: beta-splines, any 4x4 matrix, and power coefficients.

use glam::DVec3;
use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::kind::choice;
use crate::language::spec::point::{Point, read_numbers};
use crate::language::spec::reader::{Read, Reader};
use crate::language::spec::schema::{Schemas, any_of, array, numbers, one_of_words};
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::{check_closed, report_repeated};
use crate::language::value::{Data, Value, show_number};

table! {
    /// A beta-spline: a curve drawn towards its control points, with one direction and one curvature at each joint (G2),
    /// which bias and tension shape.
    "beta-spline" pub BetaSpline {
        /// The control points, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// The speed after each joint over that before it; 1 favors neither side.
        bias: Sp<f64> = 1.0 => Check::above(0.0).up_to(1000.0);
        /// Draws the curve to its control points; 0 with a bias of 1 is the cubic B-spline.
        tension: Sp<f64> = 0.0 => Check::within(0.0, 1e6);
        /// Whether it runs back to its start.
        closed: Sp<bool> = false;
        /// How an open curve ends.
        ends: Sp<Border> = Border::Reflect;
    }
    checked check
}

choices! {
    /// What happens where a polygon of control points ends.
    Border {
        /// The polygon is continued by its mirror image, so that the curve runs from the first to the last point.
        Reflect = "reflect";
        /// Only what the points determine: the curve ends before they do.
        Cut = "cut";
    }
}

table! {
    /// Cubic pieces end to end, either by power coefficients, or by a 4x4 basis matrix: the point at t from 0 to 1 is
    /// (t^3, t^2, t, 1) times the matrix times four points.
    "cubic" pub Cubic {
        /// For each piece four vectors: the coefficients of 1, t, t^2 and t^3. Each piece begins where the one before
        /// ends.
        coefficients: Option<Sp<Vec<Sp<Vec<Sp<Point>>>>>>;
        /// Four rows of four numbers, the first row for t^3; or `"bezier"`, `"b-spline"`, `"catmull-rom"`, `"hermite"`
        /// (start, end, derivative at the start, derivative at the end).
        basis: Option<Sp<Basis>>;
        /// The points that the basis weighs, four for each piece.
        points: Option<Sp<Vec<Sp<Point>>>>;
        /// How many points further each piece takes its four: 1 for splines, 3 for Bezier curves, 4 for pieces that share
        /// none. When it is not written: 3 with `"bezier"`, 4 with `"hermite"`, else 1.
        step: Option<Sp<u32>> => Check::within(1.0, 4.0);
        /// Whether the last pieces take the first points again; with `basis` and steps of 1.
        closed: Sp<bool> = false;
    }
    checked check
}

/// What weighs four points to a cubic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Basis {
    /// Bernstein polynomials.
    Bezier,
    /// The uniform cubic B-spline.
    BSpline,
    /// The uniform Catmull-Rom spline.
    CatmullRom,
    /// Start, end, derivative at the start, derivative at the end.
    Hermite,
    /// Four rows, the first for t^3.
    Matrix([[f64; 4]; 4]),
}

const WORDS: [&str; 4] = ["bezier", "b-spline", "catmull-rom", "hermite"];

impl Read for Basis {
    fn read(value: &Value, reader: &mut Reader<'_>) -> Option<Self> {
        let Data::Array(rows) = &value.data else {
            return Some(match choice(value, &WORDS, reader)? {
                "bezier" => Self::Bezier,
                "b-spline" => Self::BSpline,
                "catmull-rom" => Self::CatmullRom,
                _ => Self::Hermite,
            });
        };
        if rows.len() != 4 {
            let message = format!("a basis matrix has 4 rows, found {}", rows.len());
            reader
                .report(Diagnostic::error(Code::WrongLength, message).at(value.span, "expected 4 rows of 4"));
            return None;
        }
        let read_row = |(index, row): (usize, &Value), reader: &mut Reader<'_>| {
            reader.within_index(index, |reader| read_numbers(row, 4, 4, "four numbers", reader))
        };
        let read: Vec<_> = rows.iter().enumerate().map(|row| read_row(row, reader)).collect();
        let mut matrix = [[0.0; 4]; 4];
        for (row, numbers) in matrix.iter_mut().zip(read) {
            row.copy_from_slice(&numbers?);
        }
        Some(Self::Matrix(matrix))
    }

    fn schema(_: &mut Schemas) -> Json {
        let mut rows = array(numbers(4, 4));
        rows["minItems"] = json!(4);
        rows["maxItems"] = json!(4);
        let mut alternatives = one_of_words(&WORDS);
        alternatives.push(rows);
        any_of(alternatives)
    }

    fn written(&self) -> Option<Json> {
        match self {
            Self::Bezier => Some(json!(WORDS[0])),
            Self::BSpline => Some(json!(WORDS[1])),
            Self::CatmullRom => Some(json!(WORDS[2])),
            Self::Hermite => Some(json!(WORDS[3])),
            Self::Matrix(_) => None,
        }
    }
}

impl BetaSpline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let count = self.points.len();
        if self.closed.value && !self.ends.span.is_none() {
            reader.report(closed_without_ends("beta-spline", self.ends.span, self.closed.span));
            return false;
        }
        if !self.closed.value && self.ends.value == Border::Cut && count < 4 {
            let message = format!("a beta-spline with cut ends needs at least 4 points, found {count}");
            let report = Diagnostic::error(Code::FewPoints, message)
                .at(self.ends.span, "nothing would be left")
                .help("leave `ends` out: the curve then runs from the first to the last point");
            reader.report(report);
            return false;
        }
        check_closed("beta-spline", count, self.closed, reader)
            && report_repeated(&self.points, self.closed.value, "points", reader)
    }
}

pub(crate) fn closed_without_ends(what: &str, ends: Span, closed: Span) -> Diagnostic {
    Diagnostic::error(Code::Conflict, format!("a closed {what} has no `ends`"))
        .at(ends, "cannot stand beside `closed`")
        .also(closed, "closed")
}

impl Cubic {
    /// How many points further each piece takes its four.
    #[must_use]
    pub fn stride(&self) -> usize {
        match (&self.step, self.basis.as_ref().map(|basis| basis.value)) {
            (Some(step), _) => step.value as usize,
            (None, Some(Basis::Bezier)) => 3,
            (None, Some(Basis::Hermite)) => 4,
            (None, _) => 1,
        }
    }

    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        match (&self.coefficients, &self.basis, &self.points) {
            (Some(coefficients), None, None) => self.check_coefficients(coefficients, reader),
            (None, Some(_), Some(points)) => self.check_windows(points, reader),
            (Some(coefficients), _, _) => {
                let other = self.basis.as_ref().map(|basis| ("basis", basis.span));
                let (name, span) = other
                    .or(self.points.as_ref().map(|points| ("points", points.span)))
                    .unwrap_or(("basis", table));
                let report =
                    Diagnostic::error(Code::Conflict, format!("a cubic by coefficients has no `{name}`"))
                        .at(span, "cannot stand beside `coefficients`")
                        .also(coefficients.span, "the coefficients");
                reader.report(report);
                false
            }
            _ => {
                let report = Diagnostic::error(
                    Code::MissingField,
                    "a cubic has either `coefficients`, or `basis` and `points`",
                )
                .at(table, "neither form");
                reader.report(report);
                false
            }
        }
    }

    fn check_coefficients(&self, pieces: &Sp<Vec<Sp<Vec<Sp<Point>>>>>, reader: &mut Reader<'_>) -> bool {
        let stray = self.step.map(|step| ("step", step.span));
        let stray = stray.or((!self.closed.span.is_none()).then_some(("closed", self.closed.span)));
        if let Some((name, span)) = stray {
            let report =
                Diagnostic::error(Code::Conflict, format!("a cubic by coefficients has no `{name}`"))
                    .at(span, "cannot stand beside `coefficients`")
                    .also(pieces.span, "the coefficients");
            reader.report(report);
            return false;
        }
        if pieces.is_empty() {
            reader.report(
                Diagnostic::error(Code::WrongLength, "a cubic needs at least one piece")
                    .at(pieces.span, "none"),
            );
            return false;
        }
        for piece in pieces.iter() {
            if piece.len() != 4 {
                let message =
                    format!("a piece has 4 coefficients, of 1, t, t^2 and t^3, found {}", piece.len());
                reader.report(Diagnostic::error(Code::WrongCount, message).at(piece.span, "expected 4"));
                return false;
            }
        }
        let ends = |piece: &Sp<Vec<Sp<Point>>>| {
            (piece[0].position, piece.iter().map(|power| power.position).sum::<DVec3>(), piece.span)
        };
        check_meeting(&pieces.iter().map(ends).collect::<Vec<_>>(), reader)
    }

    fn check_windows(&self, points: &Sp<Vec<Sp<Point>>>, reader: &mut Reader<'_>) -> bool {
        let (count, step) = (points.len(), self.stride());
        if self.closed.value && step != 1 {
            let report =
                Diagnostic::error(Code::Conflict, format!("a closed cubic has steps of 1, found {step}"))
                    .at(self.closed.span, "closed");
            reader.report(report);
            return false;
        }
        let fits =
            if self.closed.value { count >= 3 } else { count >= 4 && (count - 4).is_multiple_of(step) };
        if !fits {
            let message = if self.closed.value {
                format!("a closed cubic needs at least 3 points, found {count}")
            } else {
                format!("{count} points do not make windows of 4 in steps of {step}")
            };
            let below = 4 + count.saturating_sub(4) / step * step;
            let label = if self.closed.value {
                "too few".to_owned()
            } else {
                format!("expected {below} or {}", below + step)
            };
            reader.report(Diagnostic::error(Code::WrongCount, message).at(points.span, label));
            return false;
        }
        let Some(basis) = self.basis.as_ref().map(|basis| basis.value) else { return true };
        let last = if self.closed.value { count } else { count - 3 };
        let weigh = |start: usize, weights: [f64; 4]| {
            (0..4).map(|k| points[(start + k) % count].position * weights[k]).sum::<DVec3>()
        };
        let (first, last_weights) = basis.ends();
        let ends = |start: usize| (weigh(start, first), weigh(start, last_weights), points[start].span);
        let mut pieces: Vec<_> = (0..last).step_by(step).map(ends).collect();
        pieces.extend(self.closed.value.then(|| pieces[0]));
        check_meeting(&pieces, reader)
    }
}

impl Basis {
    /// What the four points weigh at the start and at the end of a piece.
    fn ends(self) -> ([f64; 4], [f64; 4]) {
        match self {
            Self::Bezier => ([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]),
            Self::Hermite => ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]),
            Self::CatmullRom => ([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]),
            Self::BSpline => ([1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0], [0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]),
            Self::Matrix(rows) => {
                (rows[3], [0, 1, 2, 3].map(|column| rows.iter().map(|row| row[column]).sum::<f64>()))
            }
        }
    }
}

/// Each piece begins where the one before ends, up to rounding.
fn check_meeting(pieces: &[(DVec3, DVec3, Span)], reader: &mut Reader<'_>) -> bool {
    const ROUNDING: f64 = 1e-9;
    let size =
        pieces.iter().map(|(start, end, _)| start.abs().max(end.abs()).max_element()).fold(0.0, f64::max);
    let apart = |pair: &[(DVec3, DVec3, Span)]| pair[0].1.distance(pair[1].0) > ROUNDING * size;
    let Some(index) = pieces.windows(2).position(apart) else { return true };
    let (end, start) = (pieces[index].1, pieces[index + 1].0);
    let message = format!(
        "piece {} of this cubic begins {} away from where piece {index} ends",
        index + 1,
        show_number(end.distance(start))
    );
    let shown = |point: DVec3| format!("[{:.6}, {:.6}, {:.6}]", point.x, point.y, point.z);
    let report = Diagnostic::error(Code::PiecesApart, message)
        .at(pieces[index + 1].2, format!("begins at {}", shown(start)))
        .also(pieces[index].2, format!("ends at {}", shown(end)));
    reader.report(report);
    false
}

//! Parabolas, hyperbolas, and conics by conjugate vectors.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::point::Point;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// A part of the parabola y = x^2 / (4 focus), moved so that its vertex stands at `vertex`: a mirror of this
    /// shape gathers light in a point `focus` above the vertex.
    "parabola" pub Parabola {
        /// Distance from the vertex to the focus, in the document's unit; a negative one opens downward.
        focus: Sp<f64> => Check::nonzero();
        /// The lowest point, or the highest where `focus` is negative.
        vertex: Sp<Point> = Point::ORIGIN;
        /// Where it starts: x, counted from the vertex.
        from: Sp<f64>;
        /// Where it ends: x, counted from the vertex; less than `from` runs to the left.
        to: Sp<f64>;
    }
    checked check
}

table! {
    /// A part of the right branch of the hyperbola x^2 / a^2 - y^2 / b^2 = 1, moved to `center`.
    "hyperbola" pub Hyperbola {
        /// The half axes `[a, b]`: the branch begins to open at x = a, and its asymptotes rise by b over a.
        radii: Sp<glam::DVec2> => Check::above(0.0);
        /// Where the asymptotes cross.
        center: Sp<Point> = Point::ORIGIN;
        /// Where it starts: y, counted from the center.
        from: Sp<f64>;
        /// Where it ends: y, counted from the center; less than `from` runs downward.
        to: Sp<f64>;
    }
    checked check
}

table! {
    /// A part of a conic in space, by two vectors that need be neither perpendicular nor equally long (conjugate
    /// half diameters): center + first cos t + second sin t, center + first cosh t + second sinh t, or
    /// center + first t + second t^2.
    "conic" pub Conic {
        /// Which of the three.
        form: Sp<ConicForm>;
        /// The center; of a parabola the point at t = 0.
        center: Sp<Point> = Point::ORIGIN;
        /// The vector that goes with cos t, with cosh t, or with t.
        first: Sp<Point>;
        /// The vector that goes with sin t, with sinh t, or with t^2.
        second: Sp<Point>;
        /// The parameter t where it starts: degrees for an ellipse, where 0 is the default, and a plain number else.
        from: Option<Sp<f64>>;
        /// The parameter t where it ends; an ellipse ends at 360 degrees when it is not written.
        to: Option<Sp<f64>>;
    }
    checked check
}

choices! {
    /// The three conics.
    ConicForm {
        /// An ellipse, or an arc of one.
        Ellipse = "ellipse";
        /// A branch of a hyperbola.
        Hyperbola = "hyperbola";
        /// A parabola.
        Parabola = "parabola";
    }
}

impl Parabola {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_range(self.from, self.to, reader)
    }
}

impl Hyperbola {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_range(self.from, self.to, reader)
    }
}

impl Conic {
    /// The parameters of start and end, where the default stands for what is not written.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        let or = |written: Option<Sp<f64>>, default: f64| match (written, self.form.value) {
            (Some(written), _) => Some(written.value),
            (None, ConicForm::Ellipse) => Some(default),
            (None, _) => None,
        };
        Some((or(self.from, 0.0)?, or(self.to, 360.0)?))
    }

    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let Some((from, to)) = self.range() else {
            let form = self.form.text();
            let message = format!("a {form} goes on without end: it needs `from` and `to`");
            let report = Diagnostic::error(Code::MissingField, message)
                .at(table, "no end")
                .help(format!("write the parameters where the part of the {form} starts and ends"));
            reader.report(report);
            return false;
        };
        let vectors = self.check_vectors(reader);
        let last = self.to.or(self.from).unwrap_or_else(|| to.into());
        let ranged = if self.form.value == ConicForm::Ellipse {
            check_turn(from, to, last.span, reader)
        } else {
            check_range(from.into(), Sp::new(to, last.span), reader)
        };
        vectors && ranged
    }

    fn check_vectors(&self, reader: &mut Reader<'_>) -> bool {
        /// As for three points of a circle: what is thinner is lost in rounding.
        const LOST: f64 = 1e-12;
        let (first, second) = (self.first.position, self.second.position);
        if first.cross(second).length() > LOST * first.length() * second.length() {
            return true;
        }
        let message = "`first` and `second` lie on one line: the conic would be a line";
        let report = Diagnostic::error(Code::Degenerate, message)
            .at(self.second.span, "no other direction than `first`")
            .also(self.first.span, "the first vector")
            .help("the two vectors span the plane of the conic; give them different directions");
        reader.report(report);
        false
    }
}

/// Whether the ends of a range differ; reports it where they do not.
fn check_range(from: Sp<f64>, to: Sp<f64>, reader: &mut Reader<'_>) -> bool {
    if from.value != to.value {
        return true;
    }
    let message = format!("`from` and `to` must differ, found {} twice", show_number(to.value));
    reader.report(Diagnostic::error(Code::OutOfRange, message).at(to.span, "no curve between them"));
    false
}

/// Whether a turn is more than nothing and at most a full one; reports it where it is not.
pub(crate) fn check_turn(from: f64, to: f64, span: Span, reader: &mut Reader<'_>) -> bool {
    let turn = to - from;
    if turn != 0.0 && turn.abs() <= 360.0 {
        return true;
    }
    let turned = show_number(turn);
    let message = format!("an arc turns by more than 0 and at most 360 degrees, found {turned}");
    let report =
        Diagnostic::error(Code::OutOfRange, message).at(span, format!("{turned} degrees from the start"));
    reader.report(report);
    false
}

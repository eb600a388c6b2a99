//! Conics of a document into curves of the kernel.

use glam::{DVec2, DVec3};

use super::Builder;
use crate::geometry::curve::{AnyCurve, BezierSpline, Curve as _, EllipseArc, HyperbolaArc, Side};
use crate::geometry::number::asinh;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Conic, ConicForm, Ellipse, Hyperbola, Parabola};

/// The greatest coordinate that a curve may reach, as for the numbers of a document.
pub(super) const GREATEST: f64 = 1e15;

pub(super) fn ellipse(ellipse: &Ellipse) -> AnyCurve {
    let DVec2 { x, y } = ellipse.radii.value;
    AnyCurve::Ellipse(EllipseArc {
        center: ellipse.center.position,
        x: DVec3::X * x,
        y: DVec3::Y * y,
        from: ellipse.from.value,
        to: ellipse.to.value,
    })
}

impl Builder<'_> {
    pub(super) fn parabola(&mut self, parabola: &Parabola, span: Span) -> Option<AnyCurve> {
        let second = DVec3::Y / (4.0 * parabola.focus.value);
        let range = (parabola.from.value, parabola.to.value);
        self.quadratic((parabola.vertex.position, DVec3::X, second), range, span)
    }

    pub(super) fn hyperbola(&mut self, hyperbola: &Hyperbola, span: Span) -> Option<AnyCurve> {
        let DVec2 { x, y } = hyperbola.radii.value;
        let arc = HyperbolaArc {
            center: hyperbola.center.position,
            x: DVec3::X * x,
            y: DVec3::Y * y,
            from: asinh(hyperbola.from.value / y),
            to: asinh(hyperbola.to.value / y),
        };
        self.within_reach(AnyCurve::Hyperbola(arc), span)
    }

    pub(super) fn conic(&mut self, conic: &Conic, span: Span) -> Option<AnyCurve> {
        let (from, to) = conic.range()?;
        let (center, x, y) = (conic.center.position, conic.first.position, conic.second.position);
        match conic.form.value {
            ConicForm::Ellipse => Some(AnyCurve::Ellipse(EllipseArc { center, x, y, from, to })),
            ConicForm::Hyperbola => {
                self.within_reach(AnyCurve::Hyperbola(HyperbolaArc { center, x, y, from, to }), span)
            }
            ConicForm::Parabola => self.quadratic((center, x, y), (from, to), span),
        }
    }

    /// center + first t + second t^2 for t from `from` to `to`, over 0 to 1.
    fn quadratic(
        &mut self,
        (center, first, second): (DVec3, DVec3, DVec3),
        (from, to): (f64, f64),
        span: Span,
    ) -> Option<AnyCurve> {
        // The control point between the ends stands where the tangents meet; in polar form at (from, to).
        let polar = |s: f64, t: f64| center + first * ((s + t) / 2.0) + second * (s * t);
        let points = vec![polar(from, from), polar(from, to), polar(to, to)];
        let curve = BezierSpline::new(2, points).ok().map(AnyCurve::Bezier)?;
        self.within_reach(curve, span)
    }

    /// The curve, unless it goes further than can be computed with.
    fn within_reach(&mut self, curve: AnyCurve, span: Span) -> Option<AnyCurve> {
        let domain = curve.domain();
        for (t, side) in [(domain.start, Side::After), (domain.end, Side::Before)] {
            let jet = curve.evaluate(t, side);
            let greatest = [jet.point, jet.first, jet.second].map(|vector| vector.abs().max_element());
            if !greatest.iter().all(|size| *size <= GREATEST) {
                let message = format!("this curve reaches further than {GREATEST:e}");
                let report = Diagnostic::error(Code::NotFinite, message)
                    .at(span, "too far")
                    .help("bring `from` and `to` nearer to each other");
                self.report(report);
                return None;
            }
        }
        Some(curve)
    }
}

//! Curves of a document on which a formula is zero.

use glam::DVec2;

use super::Builder;
use super::formula::Compiler;
use super::profile::place;
use crate::geometry::curve::{AnyCurve, ImplicitFault, implicit};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::Implicit;

impl Builder<'_> {
    /// All parts of the curve.
    pub(super) fn implicit(&mut self, written: &Implicit, span: Span) -> Option<Vec<AnyCurve>> {
        let mut compiler = Compiler::new(&["x", "y"]);
        let output = match compiler.add(&written.f.value) {
            Ok(slot) => slot,
            Err(diagnostic) => {
                self.report(*diagnostic);
                return None;
            }
        };
        let compiled = compiler.finish(vec![output]);
        let (min, max) = (written.min.value, written.max.value);
        match implicit(&compiled.formula, min, max) {
            Ok(parts) => Some(parts.into_iter().map(AnyCurve::Bezier).collect()),
            Err(fault) => {
                self.report(refusal(&fault, written.f.span, (span, max - min)));
                None
            }
        }
    }
}

fn refusal(fault: &ImplicitFault, formula: Span, (table, size): (Span, DVec2)) -> Diagnostic {
    match fault {
        ImplicitFault::Nowhere => Diagnostic::error(Code::NoZero, "this formula is nowhere 0 in its box")
            .at(formula, "no zero between `min` and `max`")
            .help("make the box larger, or subtract the value that the curve shall have: \"= ... - 1\""),
        ImplicitFault::Singular(places) => {
            // A coordinate that is 0 but for rounding is told as 0.
            let clean = |number: f64, size: f64| if number.abs() < 1e-9 * size { 0.0 } else { number };
            let named = places.iter().map(|at| place(DVec2::new(clean(at.x, size.x), clean(at.y, size.y))));
            let named: Vec<String> = named.collect();
            let message = format!("the zeros of this formula are no smooth curve near {}", named.join(", "));
            Diagnostic::error(Code::SingularCurve, message)
                .at(formula, "a crossing, a cusp, a kink, a lone point, or contact with the border of the box")
                .help("let the box leave such places out; `min` and `max` a little further out end a contact with the border")
        }
        ImplicitFault::Intricate => Diagnostic::error(
            Code::LimitPassed,
            "the zeros of this formula are too long or lie too close to be told apart",
        )
        .at(table, "too intricate")
        .help("make the box smaller"),
    }
}

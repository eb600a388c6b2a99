//! Formula curves of a document into curves of the kernel.

use super::Builder;
use super::formula::{Compiled, Compiler};
use super::profile::show;
use crate::geometry::curve::{AnyCurve, FormulaCurve as Curve, FormulaFault};
use crate::geometry::formula::{Binary, Operation, Unary};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Formula as Written, FormulaCurve, FormulaForm, Sp};

impl Builder<'_> {
    pub(super) fn formula_curve(&mut self, written: &FormulaCurve, span: Span) -> Option<AnyCurve> {
        let form = written.form()?;
        let variables = [form.variable()];
        let mut compiler = Compiler::new(&variables);
        let mut outputs = Vec::new();
        for coordinate in coordinates(written, form) {
            match coordinate {
                None => outputs.push(compiler.constant(0.0)),
                Some(Coordinate::Variable) => outputs.push(compiler.variable(0)),
                Some(Coordinate::Written(formula)) => match compiler.add(&formula.value) {
                    Ok(slot) => outputs.push(slot),
                    Err(diagnostic) => self.report(*diagnostic),
                },
                Some(Coordinate::Around(formula, direction)) => match compiler.add(&formula.value) {
                    Ok(radius) => {
                        let angle = compiler.variable(0);
                        let share = compiler.push(Operation::Unary(direction, angle));
                        outputs.push(compiler.push(Operation::Binary(Binary::Multiply, radius, share)));
                    }
                    // The radius is told once.
                    Err(diagnostic) if direction == Unary::Cos => self.report(*diagnostic),
                    Err(_) => {}
                },
            }
        }
        if outputs.len() < 3 {
            return None;
        }
        let compiled = compiler.finish(outputs);
        let (from, to) = (written.from.value, written.to.value);
        match Curve::new(compiled.formula.clone(), from, to) {
            Ok(curve) => Some(AnyCurve::Formula(Box::new(curve))),
            Err(fault) => {
                self.report(refusal(&compiled, &fault, written, span));
                None
            }
        }
    }
}

enum Coordinate<'a> {
    Variable,
    Written(&'a Sp<Written>),
    /// A radius times the sine or cosine of the variable.
    Around(&'a Sp<Written>, Unary),
}

/// What gives x, y and z; nothing stands for 0.
fn coordinates(written: &FormulaCurve, form: FormulaForm) -> [Option<Coordinate<'_>>; 3] {
    fn own(formula: &Option<Sp<Written>>) -> Option<Coordinate<'_>> {
        formula.as_ref().map(Coordinate::Written)
    }
    let around = |direction: Unary| written.r.as_ref().map(|r| Coordinate::Around(r, direction));
    let (x, y) = match form {
        FormulaForm::Graph => (Some(Coordinate::Variable), own(&written.y)),
        FormulaForm::SideGraph => (own(&written.x), Some(Coordinate::Variable)),
        FormulaForm::Parametric => (own(&written.x), own(&written.y)),
        FormulaForm::Polar => (around(Unary::Cos), around(Unary::Sin)),
    };
    [x, y, own(&written.z)]
}

fn refusal(compiled: &Compiled, fault: &FormulaFault, written: &FormulaCurve, table: Span) -> Diagnostic {
    let variable = written.form().map_or("t", FormulaForm::variable);
    let span = written.to.value - written.from.value;
    // A place that is 0 but for rounding is told as 0.
    let round = |t: f64| if t.abs() < 1e-9 * span { 0.0 } else { t };
    let at = |t: f64| format!("{variable} = {}", show(round(t)));
    match fault {
        FormulaFault::NoValue { t, culprit } => compiled
            .lost(culprit, &at(*t), table)
            .help("let `from` and `to` leave such places out, or say with `if` what holds there"),
        FormulaFault::Unbounded { t } => {
            let message = format!("the formula has no finite value near {}", at(*t));
            Diagnostic::error(Code::FormulaValue, message)
                .at(table, "it grows without end, or cannot be shown not to")
                .help("let `from` and `to` leave that place out, or say with `if` what holds there")
        }
        FormulaFault::Jump { t, before, after } => {
            let place = |point: &glam::DVec3| {
                let size = before.distance(*after);
                let [x, y, z] =
                    point.to_array().map(|part| show(if part.abs() < 1e-9 * size { 0.0 } else { part }));
                if point.z == 0.0 { format!("[{x}, {y}]") } else { format!("[{x}, {y}, {z}]") }
            };
            let message =
                format!("the formula jumps at {} from {} to {}", at(*t), place(before), place(after));
            Diagnostic::error(Code::FormulaJump, message)
                .at(table, "torn there")
                .help("a curve is one piece: end it there, or join both sides with `smoothstep` or `mix`")
        }
        FormulaFault::Wild { t } => {
            let message = format!("the formula changes too often to be followed, beyond {}", at(*t));
            Diagnostic::error(Code::FormulaWild, message)
                .at(table, "too wild")
                .help("make the range shorter or the waves longer")
        }
        FormulaFault::Still { from, to } => {
            let message = format!("the formula stands still from {} to {}", at(*from), show(round(*to)));
            Diagnostic::error(Code::Degenerate, message)
                .at(table, "one point, no direction")
                .help("let the range leave that part out")
        }
    }
}

//! Formulas of a document into formulas of the kernel.

use std::ops::Range;

use super::profile::show;
use crate::geometry::formula::{Binary as Op, Builder as Program, Culprit, Formula, Operation, Slot, Unary};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::expression::{self, Binary, Call, Expression, Fault, Node};
use crate::language::source::Span;
use crate::language::spec::Formula as Written;

/// A formula and where each of its steps is written.
pub(super) struct Compiled {
    pub(super) formula: Formula,
    /// For each step the written formula and the part of it; none for what no one wrote.
    origins: Vec<Option<(expression::Formula, Range<usize>)>>,
}

/// Puts written formulas of the same variables together.
pub(super) struct Compiler<'a> {
    program: Program,
    variables: &'a [&'static str],
    origins: Vec<Option<(expression::Formula, Range<usize>)>>,
}

/// A value in the making.
#[derive(Clone)]
enum Term {
    Number(Slot),
    Truth(Slot),
    Text,
    List(Vec<Self>),
}

type Result<T> = std::result::Result<T, Fault>;

impl<'a> Compiler<'a> {
    pub(super) fn new(variables: &'a [&'static str]) -> Self {
        let mut compiler = Self { program: Program::new(), variables, origins: Vec::new() };
        for index in 0..variables.len() {
            compiler.program.push(Operation::Variable(u32::try_from(index).unwrap_or(u32::MAX)));
        }
        compiler.settle(None);
        compiler
    }

    /// The step of a variable.
    pub(super) fn variable(&mut self, index: u32) -> Slot {
        self.program.push(Operation::Variable(index))
    }

    pub(super) fn constant(&mut self, value: f64) -> Slot {
        let slot = self.program.constant(value);
        self.settle(None);
        slot
    }

    pub(super) fn push(&mut self, operation: Operation) -> Slot {
        let slot = self.program.push(operation);
        self.settle(None);
        slot
    }

    /// The step that gives a written formula, or what is wrong with it.
    pub(super) fn add(&mut self, written: &Written) -> std::result::Result<Slot, Box<Diagnostic>> {
        match written {
            Written::Number(value) => Ok(self.constant(*value)),
            Written::Varying(formula) => self
                .number(formula, formula.tree())
                .map_err(|fault| Box::new(fault.diagnostic(|range| formula.place(&range)))),
        }
    }

    pub(super) fn finish(self, outputs: Vec<Slot>) -> Compiled {
        Compiled { formula: self.program.finish(self.variables.len(), outputs), origins: self.origins }
    }

    /// Notes where the steps come from that were added since.
    fn settle(&mut self, origin: Option<(&expression::Formula, &Range<usize>)>) {
        let origin = origin.map(|(formula, range)| (formula.clone(), range.clone()));
        self.origins.resize(self.program.len(), origin);
    }

    fn number(&mut self, formula: &expression::Formula, tree: &Expression) -> Result<Slot> {
        match self.term(formula, tree)? {
            Term::Number(slot) => Ok(slot),
            other => Err(mismatch("a number", &other, tree)),
        }
    }

    fn truth(&mut self, formula: &expression::Formula, tree: &Expression) -> Result<Slot> {
        match self.term(formula, tree)? {
            Term::Truth(slot) => Ok(slot),
            other => Err(mismatch("true or false", &other, tree)),
        }
    }

    fn term(&mut self, formula: &expression::Formula, tree: &Expression) -> Result<Term> {
        let term = match &tree.node {
            Node::Number(value) => Term::Number(self.program.constant(*value)),
            Node::Boolean(truth) => Term::Truth(self.program.constant(f64::from(u8::from(*truth)))),
            Node::Text(_) => Term::Text,
            Node::Name(name) => self.name(name, tree)?,
            Node::List(items) => {
                let items: Result<Vec<_>> = items.iter().map(|item| self.term(formula, item)).collect();
                Term::List(items?)
            }
            Node::Negate(inner) => {
                let term = self.term(formula, inner)?;
                self.each(&term, |program, slot| program.unary(Unary::Negate, slot))
                    .ok_or_else(|| mismatch("a number or a point", &term, inner))?
            }
            Node::Not(inner) => {
                let truth = self.truth(formula, inner)?;
                Term::Truth(self.program.unary(Unary::Not, truth))
            }
            Node::Part(whole, index) => self.part(formula, whole, *index, tree)?,
            Node::Binary(operator, sides) => self.binary(formula, *operator, sides, tree)?,
            Node::Call(function, arguments) => self.call(formula, function.call, arguments, tree)?,
        };
        self.settle(Some((formula, &tree.range)));
        Ok(term)
    }

    fn name(&mut self, name: &str, tree: &Expression) -> Result<Term> {
        if let Some(index) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Term::Number(self.variable(u32::try_from(index).unwrap_or(u32::MAX))));
        }
        let known = self.variables.join("` and `");
        let message = format!("`{name}` is no variable here: this is a formula of `{known}`");
        Err(Fault::new(Code::UnknownVariable, tree.range.clone(), message).label("not known here"))
    }

    /// An operation on a number, or on all numbers of a point.
    fn each(&mut self, term: &Term, apply: impl Fn(&mut Program, Slot) -> Slot) -> Option<Term> {
        match term {
            Term::Number(slot) => Some(Term::Number(apply(&mut self.program, *slot))),
            Term::List(items) => {
                let items: Option<Vec<_>> = items
                    .iter()
                    .map(|item| match item {
                        Term::Number(slot) => Some(Term::Number(apply(&mut self.program, *slot))),
                        _ => None,
                    })
                    .collect();
                items.map(Term::List)
            }
            Term::Truth(_) | Term::Text => None,
        }
    }

    fn part(
        &mut self,
        formula: &expression::Formula,
        whole: &Expression,
        index: usize,
        tree: &Expression,
    ) -> Result<Term> {
        let term = self.term(formula, whole)?;
        let Term::List(items) = &term else { return Err(mismatch("a point", &term, whole)) };
        items.get(index).cloned().ok_or_else(|| {
            let axis = ["x", "y", "z"][index];
            let message = format!("a list of {} has no `.{axis}`", items.len());
            Fault::new(Code::ExpressionType, tree.range.clone(), message)
        })
    }

    fn binary(
        &mut self,
        formula: &expression::Formula,
        operator: Binary,
        [left, right]: &[Expression; 2],
        tree: &Expression,
    ) -> Result<Term> {
        let compared = match operator {
            Binary::And | Binary::Or => {
                let (left, right) = (self.truth(formula, left)?, self.truth(formula, right)?);
                let operation = if operator == Binary::And { Op::And } else { Op::Or };
                return Ok(Term::Truth(self.program.binary(operation, left, right)));
            }
            Binary::Equal | Binary::NotEqual => return self.equality(formula, operator, left, right),
            Binary::Less => Some((Op::Less, false)),
            Binary::Greater => Some((Op::Less, true)),
            Binary::LessOrEqual => Some((Op::LessOrEqual, false)),
            Binary::GreaterOrEqual => Some((Op::LessOrEqual, true)),
            _ => None,
        };
        if let Some((operation, swapped)) = compared {
            let (left, right) = (self.number(formula, left)?, self.number(formula, right)?);
            let (left, right) = if swapped { (right, left) } else { (left, right) };
            return Ok(Term::Truth(self.program.binary(operation, left, right)));
        }
        let terms = (self.term(formula, left)?, self.term(formula, right)?);
        self.arithmetic(operator, &terms).ok_or_else(|| no_operation(operator, &terms, tree))
    }

    fn equality(
        &mut self,
        formula: &expression::Formula,
        operator: Binary,
        left: &Expression,
        right: &Expression,
    ) -> Result<Term> {
        let terms = (self.term(formula, left)?, self.term(formula, right)?);
        let slots = match &terms {
            (Term::Number(left), Term::Number(right)) | (Term::Truth(left), Term::Truth(right)) => {
                (*left, *right)
            }
            (one, other) => {
                let message = format!("{} and {} are not compared in a formula", kind(one), kind(other));
                let range = left.range.start..right.range.end;
                return Err(Fault::new(Code::ExpressionType, range, message));
            }
        };
        let equal = self.program.binary(Op::Equal, slots.0, slots.1);
        let negated = operator == Binary::NotEqual;
        Ok(Term::Truth(if negated { self.program.unary(Unary::Not, equal) } else { equal }))
    }

    fn arithmetic(&mut self, operator: Binary, terms: &(Term, Term)) -> Option<Term> {
        match (operator, terms) {
            (_, (Term::Number(left), Term::Number(right))) => {
                Some(Term::Number(self.numbers(operator, *left, *right)))
            }
            (Binary::Add | Binary::Subtract, (Term::List(left), Term::List(right)))
                if left.len() == right.len() =>
            {
                let pairs = left.iter().zip(right).map(|pair| match pair {
                    (Term::Number(left), Term::Number(right)) => {
                        Some(Term::Number(self.numbers(operator, *left, *right)))
                    }
                    _ => None,
                });
                pairs.collect::<Option<Vec<_>>>().map(Term::List)
            }
            (Binary::Multiply, (point @ Term::List(_), Term::Number(factor)))
            | (Binary::Multiply, (Term::Number(factor), point @ Term::List(_))) => {
                self.each(point, |program, slot| program.binary(Op::Multiply, slot, *factor))
            }
            (Binary::Divide, (point @ Term::List(_), Term::Number(factor))) => {
                self.each(point, |program, slot| program.binary(Op::Divide, slot, *factor))
            }
            _ => None,
        }
    }

    fn numbers(&mut self, operator: Binary, left: Slot, right: Slot) -> Slot {
        let operation = match operator {
            Binary::Add => Op::Add,
            Binary::Subtract => Op::Subtract,
            Binary::Multiply => Op::Multiply,
            Binary::Divide => Op::Divide,
            Binary::Modulo => {
                let quotient = self.program.binary(Op::Divide, left, right);
                let whole = self.program.unary(Unary::Floor, quotient);
                let below = self.program.binary(Op::Multiply, right, whole);
                return self.program.binary(Op::Subtract, left, below);
            }
            // `arithmetic` is asked for these six alone.
            _ => Op::Power,
        };
        self.program.binary(operation, left, right)
    }

    fn call(
        &mut self,
        formula: &expression::Formula,
        call: Call,
        arguments: &[Expression],
        tree: &Expression,
    ) -> Result<Term> {
        match call {
            Call::If => {
                let condition = self.truth(formula, &arguments[0])?;
                let ways = (self.term(formula, &arguments[1])?, self.term(formula, &arguments[2])?);
                self.chosen(condition, &ways).ok_or_else(|| {
                    let message = format!(
                        "both ways of `if` need the same type in a formula, found {} and {}",
                        kind(&ways.0),
                        kind(&ways.1)
                    );
                    Fault::new(Code::ExpressionType, tree.range.clone(), message)
                })
            }
            Call::Mix => {
                let ends = (self.term(formula, &arguments[0])?, self.term(formula, &arguments[1])?);
                let t = self.number(formula, &arguments[2])?;
                self.mixed(&ends, t).ok_or_else(|| {
                    let message = format!(
                        "`mix` needs two numbers or two points of one length, found {} and {}",
                        kind(&ends.0),
                        kind(&ends.1)
                    );
                    Fault::new(Code::ExpressionType, tree.range.clone(), message)
                })
            }
            Call::Length => {
                let point = self.term(formula, &arguments[0])?;
                let squares = match &point {
                    Term::List(_) => {
                        self.each(&point, |program, slot| program.push(Operation::Power(slot, 2.0)))
                    }
                    _ => None,
                };
                let Some(Term::List(squares)) = squares else {
                    return Err(mismatch("a point", &point, &arguments[0]));
                };
                let zero = self.program.constant(0.0);
                let sum = squares.iter().fold(zero, |sum, square| match square {
                    Term::Number(slot) => self.program.binary(Op::Add, sum, *slot),
                    _ => sum,
                });
                Ok(Term::Number(self.program.unary(Unary::Sqrt, sum)))
            }
            _ => {
                let slots: Result<Vec<_>> =
                    arguments.iter().map(|argument| self.number(formula, argument)).collect();
                self.numeric(call, &slots?, tree).map(Term::Number)
            }
        }
    }

    fn chosen(&mut self, condition: Slot, ways: &(Term, Term)) -> Option<Term> {
        let select = |yes: Slot, no: Slot| Operation::Select(condition, yes, no);
        match ways {
            (Term::Number(yes), Term::Number(no)) => Some(Term::Number(self.program.push(select(*yes, *no)))),
            (Term::Truth(yes), Term::Truth(no)) => Some(Term::Truth(self.program.push(select(*yes, *no)))),
            (Term::List(yes), Term::List(no)) if yes.len() == no.len() => {
                let pairs =
                    yes.iter().zip(no).map(|(yes, no)| self.chosen(condition, &(yes.clone(), no.clone())));
                pairs.collect::<Option<Vec<_>>>().map(Term::List)
            }
            _ => None,
        }
    }

    fn mixed(&mut self, ends: &(Term, Term), t: Slot) -> Option<Term> {
        let one = self.program.constant(1.0);
        let rest = self.program.binary(Op::Subtract, one, t);
        let parts = (
            self.arithmetic(Binary::Multiply, &(ends.0.clone(), Term::Number(rest)))?,
            self.arithmetic(Binary::Multiply, &(ends.1.clone(), Term::Number(t)))?,
        );
        self.arithmetic(Binary::Add, &parts)
    }

    fn numeric(&mut self, call: Call, slots: &[Slot], tree: &Expression) -> Result<Slot> {
        let x = slots[0];
        let program = &mut self.program;
        let unary = match call {
            Call::Sin => Unary::Sin,
            Call::Cos => Unary::Cos,
            Call::Tan => Unary::Tan,
            Call::Asin => Unary::Asin,
            Call::Acos => Unary::Acos,
            Call::Atan => Unary::Atan,
            Call::Sinh => Unary::Sinh,
            Call::Cosh => Unary::Cosh,
            Call::Tanh => Unary::Tanh,
            Call::Sqrt => Unary::Sqrt,
            Call::Abs => Unary::Abs,
            Call::Sign => Unary::Sign,
            Call::Floor => Unary::Floor,
            Call::Round => Unary::Round,
            Call::Exp => Unary::Exp,
            Call::Ln => Unary::Ln,
            Call::Ceil => {
                let down = program.unary(Unary::Negate, x);
                let floor = program.unary(Unary::Floor, down);
                return Ok(program.unary(Unary::Negate, floor));
            }
            Call::Min => {
                return Ok(slots
                    .iter()
                    .skip(1)
                    .fold(x, |least, slot| program.binary(Op::Minimum, least, *slot)));
            }
            Call::Max => {
                return Ok(slots
                    .iter()
                    .skip(1)
                    .fold(x, |most, slot| program.binary(Op::Maximum, most, *slot)));
            }
            Call::Clamp => {
                let above = program.binary(Op::Maximum, x, slots[1]);
                return Ok(program.binary(Op::Minimum, above, slots[2]));
            }
            Call::Atan2 => return Ok(program.binary(Op::Atan2, x, slots[1])),
            Call::Smoothstep => {
                let way = program.binary(Op::Subtract, slots[2], x);
                let whole = program.binary(Op::Subtract, slots[1], x);
                let part = program.binary(Op::Divide, way, whole);
                return Ok(program.unary(Unary::Smoothstep, part));
            }
            Call::Noise => {
                let Some(seed) = program.known(x) else {
                    let message = "the seed of `noise` must not vary in a formula";
                    return Err(Fault::new(Code::ExpressionType, tree.range.clone(), message));
                };
                return Ok(program.push(Operation::Noise(seed, slots[1], slots[2])));
            }
            // Taken care of where these are called.
            Call::If | Call::Mix | Call::Length => Unary::Abs,
        };
        Ok(program.unary(unary, x))
    }
}

fn kind(term: &Term) -> String {
    match term {
        Term::Number(_) => "a number".to_owned(),
        Term::Truth(_) => "true or false".to_owned(),
        Term::Text => "a string".to_owned(),
        Term::List(items) => format!("a list of {}", items.len()),
    }
}

fn mismatch(expected: &str, found: &Term, place: &Expression) -> Fault {
    let message = format!("expected {expected}, found {}", kind(found));
    Fault::new(Code::ExpressionType, place.range.clone(), message).label(format!("this is {}", kind(found)))
}

fn no_operation(operator: Binary, terms: &(Term, Term), tree: &Expression) -> Fault {
    let message = format!("`{}` does not work on {} and {}", operator.text(), kind(&terms.0), kind(&terms.1));
    Fault::new(Code::ExpressionType, tree.range.clone(), message)
}

impl Compiled {
    /// Where a step is written, and as what.
    pub(super) fn origin(&self, slot: Slot) -> Option<(Span, &str)> {
        let (formula, range) = self.origins.get(slot.index())?.as_ref()?;
        Some((formula.place(range).0, formula.part(range)))
    }

    /// What to say of a step that has no value at a place, which is told in words (`x = 0.5`).
    pub(super) fn lost(&self, culprit: &Culprit, place: &str, table: Span) -> Diagnostic {
        let operands = culprit.operands.iter().map(|value| show(*value)).collect::<Vec<_>>().join(" and ");
        match self.origin(culprit.slot) {
            Some((span, text)) => {
                let message = format!("`{text}` has no finite value at {place}");
                let label =
                    if operands.is_empty() { "no value".to_owned() } else { format!("here of {operands}") };
                Diagnostic::error(Code::FormulaValue, message).at(span, label)
            }
            None => {
                Diagnostic::error(Code::FormulaValue, format!("the formula has no finite value at {place}"))
                    .at(table, "no value")
            }
        }
    }
}

//! From the tree of an expression to its value.

use std::ops::Range;

use crate::geometry::number;
use crate::language::diagnostic::Code;
use crate::language::expression::Computed;
use crate::language::expression::fault::Fault;
use crate::language::expression::function::{Call, Function};
use crate::language::expression::parse::{Binary, Expression, Node};
use crate::language::value::show_number;

/// A value, or what is wrong with the expression.
pub(crate) type Result<T> = std::result::Result<T, Fault>;

/// Where names get their values.
pub trait Scope {
    /// The value of a name; the error says why it has none.
    ///
    /// # Errors
    /// When the name is unknown, or is computed from itself, or its own expression fails.
    fn look_up(&mut self, name: &str, range: Range<usize>) -> Result<Computed>;

    /// Counts one step of work.
    ///
    /// # Errors
    /// When too many were taken.
    fn step(&mut self, range: &Range<usize>) -> Result<()>;
}

/// Evaluates expressions with the names of a scope.
#[derive(Debug)]
pub struct Evaluator<'s, S> {
    scope: &'s mut S,
}

impl<'s, S: Scope> Evaluator<'s, S> {
    /// An evaluator of a scope.
    pub fn new(scope: &'s mut S) -> Self {
        Self { scope }
    }

    /// The value of an expression.
    ///
    /// # Errors
    /// The first part that has no value, with its place.
    pub fn value(&mut self, expression: &Expression) -> Result<Computed> {
        self.scope.step(&expression.range)?;
        match &expression.node {
            Node::Number(number) => Ok(Computed::Number(*number)),
            Node::Boolean(truth) => Ok(Computed::Boolean(*truth)),
            Node::Text(text) => Ok(Computed::Text(text.clone())),
            Node::Name(name) => self.scope.look_up(name, expression.range.clone()),
            Node::List(items) => {
                let items: Result<Vec<_>> = items.iter().map(|item| self.value(item)).collect();
                items.map(Computed::List)
            }
            Node::Negate(inner) => self.negate(inner),
            Node::Not(inner) => Ok(Computed::Boolean(!self.truth(inner)?)),
            Node::Binary(operator, sides) => self.binary(*operator, sides, &expression.range),
            Node::Part(whole, index) => self.part(whole, *index, &expression.range),
            Node::Call(function, arguments) => self.call(function, arguments, &expression.range),
        }
    }

    fn number(&mut self, expression: &Expression) -> Result<f64> {
        match self.value(expression)? {
            Computed::Number(number) => Ok(number),
            other => Err(mismatch("a number", &other, expression)),
        }
    }

    fn truth(&mut self, expression: &Expression) -> Result<bool> {
        match self.value(expression)? {
            Computed::Boolean(truth) => Ok(truth),
            other => Err(mismatch("true or false", &other, expression)),
        }
    }

    fn negate(&mut self, inner: &Expression) -> Result<Computed> {
        match self.value(inner)? {
            Computed::Number(number) => Ok(Computed::Number(-number)),
            list @ Computed::List(_) => {
                let negative: Option<Vec<_>> =
                    coordinates(&list).map(|all| all.into_iter().map(|one| Computed::Number(-one)).collect());
                negative.map(Computed::List).ok_or_else(|| mismatch("a number or a point", &list, inner))
            }
            other => Err(mismatch("a number or a point", &other, inner)),
        }
    }

    fn part(&mut self, whole: &Expression, index: usize, range: &Range<usize>) -> Result<Computed> {
        let value = self.value(whole)?;
        let Computed::List(items) = &value else { return Err(mismatch("a point", &value, whole)) };
        let axis = ["x", "y", "z"][index];
        items.get(index).cloned().ok_or_else(|| {
            let message = format!("a list of {} has no `.{axis}`", items.len());
            Fault::new(Code::ExpressionType, range.clone(), message)
        })
    }

    fn binary(
        &mut self,
        operator: Binary,
        sides: &[Expression; 2],
        range: &Range<usize>,
    ) -> Result<Computed> {
        let [left, right] = sides;
        match operator {
            // The right side is not computed where the left one decides.
            Binary::And => Ok(Computed::Boolean(self.truth(left)? && self.truth(right)?)),
            Binary::Or => Ok(Computed::Boolean(self.truth(left)? || self.truth(right)?)),
            Binary::Equal | Binary::NotEqual => {
                let equal = self.equal(left, right)?;
                Ok(Computed::Boolean(equal == (operator == Binary::Equal)))
            }
            Binary::Less | Binary::LessOrEqual | Binary::Greater | Binary::GreaterOrEqual => {
                let (left, right) = (self.number(left)?, self.number(right)?);
                Ok(Computed::Boolean(compare(operator, left, right)))
            }
            _ => {
                let values = [self.value(left)?, self.value(right)?];
                arithmetic(operator, values, sides, range)
            }
        }
    }

    fn equal(&mut self, left: &Expression, right: &Expression) -> Result<bool> {
        let (one, other) = (self.value(left)?, self.value(right)?);
        if one.kind() == other.kind() {
            return Ok(one == other);
        }
        let message = format!("{} never equals {}", one.kind(), other.kind());
        Err(Fault::new(Code::ExpressionType, left.range.start..right.range.end, message))
    }

    fn call(
        &mut self,
        function: &Function,
        arguments: &[Expression],
        range: &Range<usize>,
    ) -> Result<Computed> {
        match function.call {
            Call::If => {
                let chosen = if self.truth(&arguments[0])? { 1 } else { 2 };
                self.value(&arguments[chosen])
            }
            Call::Mix => {
                let ends = [self.value(&arguments[0])?, self.value(&arguments[1])?];
                let t = self.number(&arguments[2])?;
                mix(&ends, t, arguments, range)
            }
            Call::Length => {
                let point = self.value(&arguments[0])?;
                let all = coordinates(&point).ok_or_else(|| mismatch("a point", &point, &arguments[0]))?;
                finite(all.into_iter().fold(0.0, number::hypot), range)
            }
            _ => {
                let numbers: Result<Vec<f64>> =
                    arguments.iter().map(|argument| self.number(argument)).collect();
                numeric(function.call, &numbers?, range)
            }
        }
    }
}

fn compare(operator: Binary, left: f64, right: f64) -> bool {
    match operator {
        Binary::Less => left < right,
        Binary::LessOrEqual => left <= right,
        Binary::Greater => left > right,
        _ => left >= right,
    }
}

fn arithmetic(
    operator: Binary,
    values: [Computed; 2],
    sides: &[Expression; 2],
    range: &Range<usize>,
) -> Result<Computed> {
    match (operator, &values[0], &values[1]) {
        (_, Computed::Number(left), Computed::Number(right)) => numbers(operator, *left, *right, range),
        (Binary::Add, Computed::Text(left), Computed::Text(right)) => joined(left, right, range),
        (Binary::Add | Binary::Subtract, Computed::List(left), Computed::List(right))
            if left.len() == right.len() =>
        {
            let pairs = left.iter().zip(right).map(|pair| match pair {
                (Computed::Number(left), Computed::Number(right)) => numbers(operator, *left, *right, range),
                _ => Err(no_operation(operator, &values, range)),
            });
            pairs.collect::<Result<Vec<_>>>().map(Computed::List)
        }
        (Binary::Multiply | Binary::Divide, Computed::List(_), Computed::Number(factor)) => {
            scaled(operator, &values[0], *factor, &sides[0], range)
        }
        (Binary::Multiply, Computed::Number(factor), Computed::List(_)) => {
            scaled(operator, &values[1], *factor, &sides[1], range)
        }
        _ => Err(no_operation(operator, &values, range)),
    }
}

fn joined(left: &str, right: &str, range: &Range<usize>) -> Result<Computed> {
    const LONGEST: usize = 10_000;
    if left.len() + right.len() > LONGEST {
        let message = format!("this string would have more than {LONGEST} bytes");
        return Err(Fault::new(Code::ExpressionLimit, range.clone(), message));
    }
    Ok(Computed::Text(format!("{left}{right}")))
}

fn scaled(
    operator: Binary,
    point: &Computed,
    factor: f64,
    place: &Expression,
    range: &Range<usize>,
) -> Result<Computed> {
    let all = coordinates(point).ok_or_else(|| mismatch("a point", point, place))?;
    let products = all.into_iter().map(|one| numbers(operator, one, factor, range));
    products.collect::<Result<Vec<_>>>().map(Computed::List)
}

fn numbers(operator: Binary, left: f64, right: f64, range: &Range<usize>) -> Result<Computed> {
    if right == 0.0 && matches!(operator, Binary::Divide | Binary::Modulo) {
        let message = format!("{} {} 0 has no value", show_number(left), operator.text());
        return Err(Fault::new(Code::ExpressionValue, range.clone(), message).label("division by zero"));
    }
    let value = match operator {
        Binary::Add => left + right,
        Binary::Subtract => left - right,
        Binary::Multiply => left * right,
        Binary::Divide => left / right,
        Binary::Modulo => left - right * (left / right).floor(),
        _ => number::pow(left, right),
    };
    if value.is_finite() {
        return Ok(Computed::Number(value));
    }
    let base = if left < 0.0 { format!("({})", show_number(left)) } else { show_number(left) };
    let message = format!("{base} {} {} has no finite value", operator.text(), show_number(right));
    Err(Fault::new(Code::ExpressionValue, range.clone(), message))
}

fn mix(ends: &[Computed; 2], t: f64, arguments: &[Expression], range: &Range<usize>) -> Result<Computed> {
    let between = |a: f64, b: f64| finite(a * (1.0 - t) + b * t, range);
    match ends {
        [Computed::Number(a), Computed::Number(b)] => between(*a, *b),
        [Computed::List(one), Computed::List(other)] if one.len() == other.len() => {
            let wrong = |index: usize| mismatch("a number or a point", &ends[index], &arguments[index]);
            let a = coordinates(&ends[0]).ok_or_else(|| wrong(0))?;
            let b = coordinates(&ends[1]).ok_or_else(|| wrong(1))?;
            let mixed = a.into_iter().zip(b).map(|(a, b)| between(a, b));
            mixed.collect::<Result<Vec<_>>>().map(Computed::List)
        }
        _ => {
            let message = format!(
                "`mix` needs two numbers or two points of one length, found {} and {}",
                sized(&ends[0]),
                sized(&ends[1])
            );
            Err(Fault::new(Code::ExpressionType, range.clone(), message))
        }
    }
}

fn numeric(call: Call, all: &[f64], range: &Range<usize>) -> Result<Computed> {
    let x = all[0];
    let value = match call {
        Call::Sin => number::sin_degrees(x),
        Call::Cos => number::cos_degrees(x),
        Call::Tan => number::tan_degrees(x),
        Call::Asin => number::asin(x).to_degrees(),
        Call::Acos => number::acos(x).to_degrees(),
        Call::Atan => number::atan(x).to_degrees(),
        // Zero has one sign, or the angle behind the origin would have two.
        Call::Atan2 => number::atan2(x + 0.0, all[1]).to_degrees(),
        Call::Sqrt => x.sqrt(),
        Call::Abs => x.abs(),
        Call::Sign => {
            if x == 0.0 {
                0.0
            } else {
                x.signum()
            }
        }
        Call::Min => all.iter().copied().fold(x, f64::min),
        Call::Max => all.iter().copied().fold(x, f64::max),
        Call::Floor => x.floor(),
        Call::Ceil => x.ceil(),
        Call::Round => x.round(),
        Call::Sinh => number::sinh(x),
        Call::Cosh => number::cosh(x),
        Call::Tanh => number::tanh(x),
        Call::Exp => number::exp(x),
        Call::Ln => number::ln(x),
        Call::Noise => number::noise(x, all[1], all[2]),
        Call::Smoothstep => return smoothstep(all, range),
        Call::Clamp => return clamp(all, range),
        Call::If | Call::Mix | Call::Length => f64::NAN,
    };
    finite(value, range).map_err(|fault| fault.label(format!("at {}", show_number(x))))
}

fn clamp(all: &[f64], range: &Range<usize>) -> Result<Computed> {
    let (x, least, most) = (all[0], all[1], all[2]);
    if least <= most {
        return Ok(Computed::Number(x.max(least).min(most)));
    }
    let message =
        format!("`clamp` needs its least {} below its most {}", show_number(least), show_number(most));
    Err(Fault::new(Code::ExpressionValue, range.clone(), message))
}

fn smoothstep(all: &[f64], range: &Range<usize>) -> Result<Computed> {
    let (from, to, x) = (all[0], all[1], all[2]);
    if from == to {
        let message = format!("`smoothstep` needs two different ends, found {} twice", show_number(from));
        return Err(Fault::new(Code::ExpressionValue, range.clone(), message));
    }
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    finite(t * t * (3.0 - 2.0 * t), range)
}

fn finite(value: f64, range: &Range<usize>) -> Result<Computed> {
    if value.is_finite() {
        return Ok(Computed::Number(value));
    }
    Err(Fault::new(Code::ExpressionValue, range.clone(), "this has no finite value"))
}

/// The numbers of a list of numbers.
fn coordinates(value: &Computed) -> Option<Vec<f64>> {
    let Computed::List(items) = value else { return None };
    let numbers = items.iter().map(|item| match item {
        Computed::Number(number) => Some(*number),
        _ => None,
    });
    numbers.collect()
}

fn sized(value: &Computed) -> String {
    match value {
        Computed::List(items) => format!("a list of {}", items.len()),
        other => other.kind().to_owned(),
    }
}

fn mismatch(expected: &str, found: &Computed, place: &Expression) -> Fault {
    let message = format!("expected {expected}, found {}", sized(found));
    Fault::new(Code::ExpressionType, place.range.clone(), message).label(format!("this is {}", sized(found)))
}

fn no_operation(operator: Binary, values: &[Computed; 2], range: &Range<usize>) -> Fault {
    let message =
        format!("`{}` does not work on {} and {}", operator.text(), sized(&values[0]), sized(&values[1]));
    Fault::new(Code::ExpressionType, range.clone(), message)
}

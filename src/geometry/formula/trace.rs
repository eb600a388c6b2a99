//! What happens inside of a formula at one place: which ways it takes, and where it loses its value.

use super::algebra::{Algebra, Binary, Unary};
use super::program::{Formula, Operation, Slot};

/// A step that has no value though its operands have.
#[derive(Clone, Debug, PartialEq)]
pub struct Culprit {
    /// The step.
    pub slot: Slot,
    /// The values of its operands.
    pub operands: Vec<f64>,
}

impl Formula {
    /// The values of all steps at a place, or over a box.
    #[must_use]
    pub fn trace<S: Algebra>(&self, place: &[S]) -> Vec<S> {
        let mut values: Vec<S> = Vec::with_capacity(self.operations().len());
        for operation in self.operations() {
            let value = operation.apply(place, |slot| values[slot.index()]);
            values.push(value);
        }
        values
    }

    /// The variables of which each step is a function, as bits: bit 0 for the first.
    #[must_use]
    pub fn dependence(&self) -> Vec<u32> {
        let mut masks: Vec<u32> = Vec::with_capacity(self.operations().len());
        for operation in self.operations() {
            let own = if let Operation::Variable(index) = operation { 1 << index } else { 0 };
            let mask = operation.operands().fold(own, |mask, slot| mask | masks[slot.index()]);
            masks.push(mask);
        }
        masks
    }

    /// The first step, in the order of evaluation, because of which a result has no finite value at a place;
    /// none when all results have one. Ways not taken do not count.
    #[must_use]
    pub fn culprit(&self, place: &[f64]) -> Option<Culprit> {
        let values = self.trace(place);
        let lost = |slot: Slot| !values[slot.index()].is_finite();
        let mut slot = *self.outputs().iter().find(|slot| lost(**slot))?;
        loop {
            let operation = &self.operations()[slot.index()];
            let used: Vec<Slot> = match operation {
                Operation::Select(condition, yes, no) if !lost(*condition) => {
                    vec![if values[condition.index()] == 0.0 { *no } else { *yes }]
                }
                _ => operation.operands().collect(),
            };
            match used.iter().find(|operand| lost(**operand)) {
                Some(operand) => slot = *operand,
                None => {
                    let operands = used.iter().map(|operand| values[operand.index()]).collect();
                    return Some(Culprit { slot, operands });
                }
            }
        }
    }

    /// Which way each step goes that has several: the sign of an absolute value, the lesser of two, the whole
    /// part. Between two places with equal ways a formula has no kink and no jump, unless it comes back.
    #[must_use]
    pub fn ways(&self, place: &[f64]) -> Vec<f64> {
        self.ways_of(place, |_| true)
    }

    /// The ways of those steps alone whose index is wanted.
    #[must_use]
    pub fn ways_of(&self, place: &[f64], wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let values = self.trace(place);
        let steps = (0..values.len()).filter(|index| wanted(*index));
        let ways = steps.filter_map(|index| way(&self.operations()[index], index, &values));
        // Ways without a value are equal to each other.
        ways.map(|way| if way.is_nan() { f64::INFINITY } else { way }).collect()
    }
}

/// Which way a step goes, if it has several.
fn way(operation: &Operation, index: usize, values: &[f64]) -> Option<f64> {
    let value = |slot: &Slot| values[slot.index()];
    match operation {
        Operation::Unary(Unary::Abs, x) => Some(f64::binary(Binary::Less, value(x), 0.0)),
        Operation::Unary(Unary::Sign | Unary::Floor | Unary::Round, _) => Some(values[index]),
        Operation::Unary(Unary::Smoothstep, x) => {
            Some(f64::binary(Binary::Less, 0.0, value(x)) + f64::binary(Binary::Less, 1.0, value(x)))
        }
        Operation::Binary(Binary::Minimum | Binary::Maximum, x, y) => {
            Some(f64::binary(Binary::Less, value(x), value(y)))
        }
        Operation::Binary(Binary::Less | Binary::LessOrEqual | Binary::Equal, ..) => Some(values[index]),
        // The angle jumps by a full turn behind the origin.
        Operation::Binary(Binary::Atan2, y, x) => {
            Some(if value(x) < 0.0 { f64::binary(Binary::Less, value(y), 0.0) } else { 2.0 })
        }
        _ => None,
    }
}

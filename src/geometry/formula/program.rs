//! Formulas as straight-line programs.

use std::collections::HashMap;

use super::algebra::{Algebra, Binary, Unary};
use super::interval::Interval;
use super::jet::Jet;

/// Index of an operation of a formula: the value that it gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Slot(u32);

impl Slot {
    /// Its place in [`Formula::operations`].
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One step of a formula; operands are steps before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// A number.
    Constant(f64),
    /// The variable of an index.
    Variable(u32),
    /// Of one operand.
    Unary(Unary, Slot),
    /// Of two operands.
    Binary(Binary, Slot, Slot),
    /// To a power that does not vary.
    Power(Slot, f64),
    /// The second where the first is true, the third where it is not.
    Select(Slot, Slot, Slot),
    /// Gradient noise of a seed.
    Noise(f64, Slot, Slot),
}

impl Operation {
    /// The steps that it needs.
    pub fn operands(&self) -> impl Iterator<Item = Slot> {
        let all = match *self {
            Self::Constant(_) | Self::Variable(_) => [None; 3],
            Self::Unary(_, x) | Self::Power(x, _) => [Some(x), None, None],
            Self::Binary(_, x, y) | Self::Noise(_, x, y) => [Some(x), Some(y), None],
            Self::Select(x, y, z) => [Some(x), Some(y), Some(z)],
        };
        all.into_iter().flatten()
    }

    /// Two equal operations have equal keys: numbers by their bits.
    fn key(&self) -> (u8, u64, [u32; 3]) {
        match *self {
            Self::Constant(value) => (0, value.to_bits(), [0; 3]),
            Self::Variable(index) => (1, 0, [index, 0, 0]),
            Self::Unary(unary, x) => (2, unary as u64, [x.0, 0, 0]),
            Self::Binary(binary, x, y) => (3, binary as u64, [x.0, y.0, 0]),
            Self::Power(x, exponent) => (4, exponent.to_bits(), [x.0, 0, 0]),
            Self::Select(x, y, z) => (5, 0, [x.0, y.0, z.0]),
            Self::Noise(seed, x, y) => (6, seed.to_bits(), [x.0, y.0, 0]),
        }
    }

    /// Its value, where `operand` gives those of its operands.
    pub(super) fn apply<S: Algebra>(&self, variables: &[S], operand: impl Fn(Slot) -> S) -> S {
        match *self {
            Self::Constant(value) => S::constant(value),
            Self::Variable(index) => variables[index as usize],
            Self::Unary(unary, x) => S::unary(unary, operand(x)),
            Self::Binary(binary, x, y) => S::binary(binary, operand(x), operand(y)),
            Self::Power(x, exponent) => S::power(operand(x), exponent),
            Self::Select(condition, yes, no) => S::select(operand(condition), operand(yes), operand(no)),
            Self::Noise(seed, x, y) => S::noise(seed, operand(x), operand(y)),
        }
    }
}

/// Puts a formula together. Equal steps are made once, and what does not vary is computed at once.
#[derive(Debug, Default)]
pub struct Builder {
    operations: Vec<Operation>,
    known: HashMap<(u8, u64, [u32; 3]), Slot>,
}

impl Builder {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a step, or finds the one that was added before.
    pub fn push(&mut self, operation: Operation) -> Slot {
        let operation = self.folded(operation);
        let next = Slot(u32::try_from(self.operations.len()).unwrap_or(u32::MAX));
        *self.known.entry(operation.key()).or_insert_with(|| {
            self.operations.push(operation);
            next
        })
    }

    /// Adds a number.
    pub fn constant(&mut self, value: f64) -> Slot {
        self.push(Operation::Constant(value))
    }

    /// Adds an operation on one operand.
    pub fn unary(&mut self, operation: Unary, x: Slot) -> Slot {
        self.push(Operation::Unary(operation, x))
    }

    /// Adds an operation on two operands.
    pub fn binary(&mut self, operation: Binary, x: Slot, y: Slot) -> Slot {
        self.push(Operation::Binary(operation, x, y))
    }

    /// The number that a step gives, if it does not vary.
    #[must_use]
    pub fn known(&self, slot: Slot) -> Option<f64> {
        match self.operations.get(slot.index()) {
            Some(Operation::Constant(value)) => Some(*value),
            _ => None,
        }
    }

    /// How many steps there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// Whether there is no step.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.operations.is_empty()
    }

    fn folded(&self, operation: Operation) -> Operation {
        if let Operation::Select(condition, yes, no) = operation
            && let Some(truth) = self.known(condition)
        {
            return self.operations[if truth == 0.0 { no } else { yes }.index()];
        }
        if let Operation::Binary(Binary::Power, x, y) = operation
            && let Some(exponent) = self.known(y)
        {
            return self.folded(Operation::Power(x, exponent));
        }
        let varies = operation.operands().any(|slot| self.known(slot).is_none());
        if varies || matches!(operation, Operation::Variable(_) | Operation::Constant(_)) {
            return operation;
        }
        let value = operation.apply(&[], |slot| self.known(slot).unwrap_or(f64::NAN));
        // What has no value stays as it is written, so that it can be named.
        if value.is_finite() { Operation::Constant(value) } else { operation }
    }

    /// The formula of these outputs, of so many variables.
    #[must_use]
    pub fn finish(self, variables: usize, outputs: Vec<Slot>) -> Formula {
        let registers = allocate(&self.operations, &outputs);
        let count = registers.iter().max().map_or(0, |most| *most as usize + 1);
        Formula { variables, operations: self.operations, registers, count, outputs }
    }
}

/// A register for each step, used again when no later step needs its value.
fn allocate(operations: &[Operation], outputs: &[Slot]) -> Vec<u16> {
    let mut last: Vec<usize> = (0..operations.len()).collect();
    for (index, operation) in operations.iter().enumerate() {
        for operand in operation.operands() {
            last[operand.index()] = index;
        }
    }
    for output in outputs {
        last[output.index()] = operations.len();
    }
    let mut ending: Vec<Vec<usize>> = vec![Vec::new(); operations.len()];
    for (index, last) in last.iter().enumerate().filter(|(_, last)| **last < operations.len()) {
        ending[*last].push(index);
    }
    let mut free: Vec<u16> = Vec::new();
    let mut next = 0;
    let mut registers = vec![0; operations.len()];
    for (index, ends) in ending.iter().enumerate() {
        // Operands are read before the result is written, so that it may take the place of one.
        free.extend(ends.iter().filter(|end| **end != index).map(|end| registers[*end]));
        registers[index] = free.pop().unwrap_or_else(|| {
            next += 1;
            next - 1
        });
        if ends.contains(&index) {
            free.push(registers[index]);
        }
    }
    registers
}

/// A formula of several variables with one or more results. Evaluation costs one operation a step and, where
/// at most sixteen intermediate values are alive at once, no memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    variables: usize,
    operations: Vec<Operation>,
    registers: Vec<u16>,
    count: usize,
    outputs: Vec<Slot>,
}

/// Registers that cost no memory.
const INLINE: usize = 16;

impl Formula {
    /// How many operations one evaluation takes.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.operations.len() as u64
    }

    /// How many variables it has.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Its steps, in order.
    #[must_use]
    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    /// The steps that give its results.
    #[must_use]
    pub fn outputs(&self) -> &[Slot] {
        &self.outputs
    }

    /// How many intermediate values are alive at once.
    #[must_use]
    pub fn registers(&self) -> usize {
        self.count
    }

    /// The results for these variables. `M` is the number of results.
    #[must_use]
    pub fn evaluate<S: Algebra, const M: usize>(&self, variables: &[S]) -> [S; M] {
        debug_assert_eq!((variables.len(), M), (self.variables, self.outputs.len()));
        if self.count <= INLINE {
            return self.run(variables, &mut [S::constant(0.0); INLINE]);
        }
        self.run(variables, &mut vec![S::constant(0.0); self.count])
    }

    fn run<S: Algebra, const M: usize>(&self, variables: &[S], values: &mut [S]) -> [S; M] {
        let register = |slot: Slot| usize::from(self.registers[slot.index()]);
        for (operation, target) in self.operations.iter().zip(&self.registers) {
            let value = operation.apply(variables, |slot| values[register(slot)]);
            values[usize::from(*target)] = value;
        }
        core::array::from_fn(|index| values[register(self.outputs[index])])
    }

    /// The results with their derivatives by all variables.
    #[must_use]
    pub fn jets<const N: usize, const M: usize>(&self, place: [f64; N]) -> [Jet<f64, N>; M] {
        self.evaluate(&core::array::from_fn::<_, N, _>(|index| Jet::variable(place[index], index)))
    }

    /// Bounds on the results and their derivatives over a box.
    #[must_use]
    pub fn jets_over<const N: usize, const M: usize>(&self, sides: [Interval; N]) -> [Jet<Interval, N>; M] {
        self.evaluate(&core::array::from_fn::<_, N, _>(|index| Jet::variable(sides[index], index)))
    }
}

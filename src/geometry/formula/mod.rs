//! Formulas: compiled expressions of several variables, with exact derivatives and bounds over boxes.
//!
//! Promise: one straight-line program serves four kinds of numbers. Plain numbers give values; [`Jet`]s of
//! numbers give exact first and second derivatives by all variables (forward automatic differentiation, no
//! differences); [`Interval`]s give bounds that hold for every point of a box, rounding included; jets of
//! intervals bound the derivatives too. An interval also says whether the formula is smooth over the box,
//! has a kink, may jump, or may have no value ([`Quality`]). Angles are in degrees. Bits are equal on every
//! machine. Not promised: that bounds are tight over wide boxes; where a variable occurs twice they widen, in
//! proportion to the box.
//!
//! Sources: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed. 2008, ch. 2, 3, 13; R. Moore, R. Kearfott,
//! M. Cloud, Introduction to Interval Analysis, 2009; decorations after IEEE 1788-2015.

mod algebra;
mod interval;
mod jet;
mod noise;
mod program;
#[cfg(test)]
mod tests;
mod trace;

pub use algebra::{Algebra, Binary, Unary, minus, plus, times};
pub use interval::{Interval, Quality};
pub use jet::{Decide, Jet};
pub use noise::Cells;
pub use program::{Builder, Formula, Operation, Slot};
pub use trace::Culprit;

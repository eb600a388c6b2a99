//! What a formula of two variables does over a rectangle: where it bends sharply, and whether it has a finite
//! value everywhere.
//!
//! First the steps that depend on one variable alone are followed along it by interval arithmetic: their kinks and
//! infinite slopes are lines across the rectangle, found to the last digits. Then the rectangle between those lines is
//! cut until each part is shown to have bounded values without jumps, or is so small that samples decide.
//! Sources: as for [`formula`](crate::geometry::formula).

use glam::DVec3;

use crate::geometry::curve::Domain;
use crate::geometry::formula::{Binary, Culprit, Decide, Formula, Interval, Operation, Quality, Slot, Unary};

/// Why a formula gives no surface over a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceFault {
    /// It has no finite value.
    NoValue {
        /// Where.
        place: [f64; 2],
        /// Because of which step.
        culprit: Culprit,
    },
    /// It goes to infinity.
    Unbounded {
        /// Near which place.
        place: [f64; 2],
    },
    /// It jumps.
    Jump {
        /// Where.
        place: [f64; 2],
        /// The point on the one side.
        before: DVec3,
        /// The point on the other.
        after: DVec3,
    },
    /// It changes more often than can be followed.
    Wild {
        /// How far it was followed.
        place: [f64; 2],
    },
}

/// A line of one constant parameter along which a formula is not smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Break {
    /// Where.
    pub(super) t: f64,
    /// Up to here it is smooth.
    pub(super) before: f64,
    /// From here on it is smooth.
    pub(super) after: f64,
    /// Whether second derivatives grow without end toward it.
    pub(super) steep: bool,
}

/// No coordinate may be greater than this by size, as in a document.
const GREATEST: f64 = 1e15;

/// Parts of a variable's range this short are not cut further: rounding moves kinks by about as much.
const SHORTEST: f64 = 1.0 / (1u64 << 42) as f64;

/// Most looks at parts of one variable's range, and of the rectangle.
const MOST: usize = 60_000;

/// Halvings after which a part of the rectangle whose values are bounded is left to samples.
const HALVINGS: u32 = 18;

/// Halvings after which a part whose values are not shown to be bounded is taken to have a pole.
const MORE_HALVINGS: u32 = 52;

/// Of the size of the surface: roots, which are steep without end, rise by 1e-8 over the last digit.
const GAP: f64 = 1e-7;

/// The lines across the rectangle along which a formula is not smooth, for u and for v; ends of a range are among
/// them where the formula is not smooth there.
///
/// # Errors
/// When the formula gives no surface.
pub(super) fn study(formula: &Formula, domains: [Domain; 2]) -> Result<[Vec<Break>; 2], SurfaceFault> {
    let study = Study { formula, domains, masks: formula.dependence(), size: size(formula, domains)? };
    let breaks = [study.lines(0)?, study.lines(1)?];
    study.values(&breaks)?;
    Ok(breaks)
}

/// The places of breaks strictly inside of a range.
pub(super) fn inside(breaks: &[Break], domain: Domain) -> Vec<f64> {
    breaks.iter().map(|one| one.t).filter(|t| *t > domain.start && *t < domain.end).collect()
}

struct Study<'a> {
    formula: &'a Formula,
    domains: [Domain; 2],
    /// Variables of each step.
    masks: Vec<u32>,
    size: f64,
}

/// How a step is over a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Unrest {
    Calm,
    /// It may have a kink, or a slope without end.
    Kink,
    Jump,
}

/// The greatest extent of points of a lattice.
fn size(formula: &Formula, domains: [Domain; 2]) -> Result<f64, SurfaceFault> {
    let share = |k: u32| f64::from(k) / 16.0;
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (i, j) in (0..=16).flat_map(|i| (0..=16).map(move |j| (i, j))) {
        let found = value(formula, [domains[0].at(share(i)), domains[1].at(share(j))])?;
        (min, max) = (min.min(found), max.max(found));
    }
    Ok(max.distance(min))
}

fn point(formula: &Formula, place: [f64; 2]) -> DVec3 {
    DVec3::from_array(formula.evaluate::<f64, 3>(&place))
}

/// The point at a place, finite and within reason.
fn value(formula: &Formula, place: [f64; 2]) -> Result<DVec3, SurfaceFault> {
    let found = point(formula, place);
    if let Some(culprit) = (!found.is_finite()).then(|| formula.culprit(&place)).flatten() {
        return Err(SurfaceFault::NoValue { place, culprit });
    }
    if found.abs().max_element() > GREATEST {
        return Err(SurfaceFault::Unbounded { place });
    }
    Ok(found)
}

/// How a step of known operands is.
fn unrest(operation: &Operation, index: usize, values: &[Interval]) -> Unrest {
    let of = |slot: &Slot| values[slot.index()];
    let own = values[index];
    let around = |x: Interval, t: f64| x.low < t && t < x.high;
    let when = |holds: bool, unrest: Unrest| if holds { unrest } else { Unrest::Calm };
    match operation {
        Operation::Unary(Unary::Abs, x) => when(around(of(x), 0.0), Unrest::Kink),
        Operation::Unary(Unary::Sqrt, x) => when(of(x).low <= 0.0, Unrest::Kink),
        Operation::Unary(Unary::Asin | Unary::Acos, x) => when(of(x).size() >= 1.0, Unrest::Kink),
        Operation::Unary(Unary::Smoothstep, x) => {
            when(around(of(x), 0.0) || around(of(x), 1.0), Unrest::Kink)
        }
        Operation::Power(x, exponent) => {
            when(exponent.fract() != 0.0 && *exponent < 2.0 && of(x).low <= 0.0, Unrest::Kink)
        }
        Operation::Binary(Binary::Minimum | Binary::Maximum, x, y) => {
            when(Decide::less(of(x), of(y)).is_none(), Unrest::Kink)
        }
        Operation::Unary(Unary::Sign | Unary::Floor | Unary::Round | Unary::Not, _)
        | Operation::Binary(
            Binary::Less | Binary::LessOrEqual | Binary::Equal | Binary::And | Binary::Or,
            ..,
        ) => when(own.low != own.high, Unrest::Jump),
        Operation::Binary(Binary::Atan2, y, x) => {
            when(of(x).low < 0.0 && of(y).low < 0.0 && of(y).high >= 0.0, Unrest::Jump)
        }
        _ => Unrest::Calm,
    }
}

impl Study<'_> {
    /// Lines of constant u (axis 0) or v (axis 1) where steps of this variable alone are not smooth.
    fn lines(&self, axis: usize) -> Result<Vec<Break>, SurfaceFault> {
        let own = |index: usize| self.masks[index] == 1 << axis;
        let domain = self.domains[axis];
        let mut parts: Vec<(f64, f64, Unrest)> = Vec::new();
        let mut waiting = vec![(domain.start, domain.end)];
        let mut left = MOST;
        while let Some((low, high)) = waiting.pop() {
            if left == 0 {
                return Err(SurfaceFault::Wild { place: self.across(axis, low, 0.5) });
            }
            left -= 1;
            let found = self.unrest_of(axis, (low, high));
            let middle = low + (high - low) / 2.0;
            let short = high - low <= SHORTEST * domain.span() || middle <= low || middle >= high;
            if found == Unrest::Calm || short {
                parts.push((low, high, found));
            } else {
                waiting.push((middle, high));
                waiting.push((low, middle));
            }
        }
        let ways = |t: f64| self.formula.ways_of(&self.across(axis, t, 0.5), own);
        let mut breaks: Vec<Break> = Vec::new();
        let mut from = 0;
        while from < parts.len() {
            let run = parts[from..].iter().take_while(|part| part.2 != Unrest::Calm).count();
            if run > 0 {
                let (low, high) = (parts[from].0, parts[from + run - 1].1);
                let most = parts[from..from + run].iter().map(|part| part.2).max();
                if most == Some(Unrest::Jump) {
                    self.check_jump(axis, (low, high), &ways)?;
                }
                let t = if low == domain.start {
                    low
                } else if high == domain.end {
                    high
                } else {
                    turning(low, high, &ways)
                };
                breaks.push(Break { t, before: low, after: high, steep: false });
            } else if from > 0 && parts[from - 1].2 == Unrest::Calm {
                // Two calm parts that touch in the very number where the formula turns.
                let middle = |part: &(f64, f64, Unrest)| part.0 + (part.1 - part.0) / 2.0;
                let (before, after) = (middle(&parts[from - 1]), middle(&parts[from]));
                if ways(before) != ways(after) {
                    let (t, step) = (parts[from].0, SHORTEST * domain.span());
                    self.check_jump(axis, (t - step, t + step), &ways)?;
                    let (before, after) = ((t - step).max(before), (t + step).min(after));
                    breaks.push(Break { t, before, after, steep: false });
                }
            }
            from += run.max(1);
        }
        Ok(breaks)
    }

    /// A place by one parameter and a share of the other's range.
    fn across(&self, axis: usize, t: f64, share: f64) -> [f64; 2] {
        let other = self.domains[1 - axis].at(share);
        if axis == 0 { [t, other] } else { [other, t] }
    }

    /// The worst of the steps of one variable alone over a part of its range.
    fn unrest_of(&self, axis: usize, (low, high): (f64, f64)) -> Unrest {
        let own = Interval::new(low, high);
        let other = Interval::new(self.domains[1 - axis].start, self.domains[1 - axis].end);
        let values = self.formula.trace(&if axis == 0 { [own, other] } else { [other, own] });
        let steps = self.formula.operations().iter().enumerate();
        let own = steps.filter(|(index, _)| self.masks[*index] == 1 << axis);
        own.map(|(index, operation)| unrest(operation, index, &values)).max().unwrap_or(Unrest::Calm)
    }

    /// A formula that may jump in a short part does so between two neighboring numbers, where it changes its ways.
    fn check_jump(
        &self,
        axis: usize,
        (from, to): (f64, f64),
        ways: &impl Fn(f64) -> Vec<f64>,
    ) -> Result<(), SurfaceFault> {
        let domain = self.domains[axis];
        let (from, to) = (from.max(domain.start), to.min(domain.end));
        let Some((low, high)) = change(from, to, ways) else { return Ok(()) };
        for share in [0.0, 0.137, 0.291, 0.382, 0.5, 0.618, 0.743, 0.863, 1.0] {
            let place = self.across(axis, high, share);
            let (before, after) =
                (value(self.formula, self.across(axis, low, share))?, value(self.formula, place)?);
            if before.distance(after) > GAP * self.size {
                return Err(SurfaceFault::Jump { place, before, after });
            }
        }
        Ok(())
    }

    /// Shows that values are bounded and do not jump.
    fn values(&self, breaks: &[Vec<Break>; 2]) -> Result<(), SurfaceFault> {
        let spans = |axis: usize| -> Vec<(f64, f64)> {
            let domain = self.domains[axis];
            let mut spans = Vec::new();
            let mut start = domain.start;
            for one in &breaks[axis] {
                if one.before > start {
                    spans.push((start, one.before));
                }
                start = one.after;
            }
            if domain.end > start {
                spans.push((start, domain.end));
            }
            spans
        };
        let (u, v) = (spans(0), spans(1));
        let cell = |u: &(f64, f64), v: &(f64, f64)| Cell { sides: [*u, *v], halvings: 0 };
        let mut waiting: Vec<Cell> = v.iter().flat_map(|v| u.iter().map(|u| cell(u, v))).collect();
        let mut left = MOST + waiting.len();
        while let Some(cell) = waiting.pop() {
            let middle = cell.middle();
            value(self.formula, middle)?;
            if left == 0 {
                return Err(SurfaceFault::Wild { place: middle });
            }
            left -= 1;
            let sides = cell.sides.map(|(low, high)| Interval::new(low, high));
            let found: [Interval; 3] = self.formula.evaluate(&sides);
            let bounded = found.iter().all(|side| side.size() <= GREATEST);
            let quality = found.iter().map(|side| side.quality).min();
            if bounded && quality >= Some(Quality::Continuous) {
                continue;
            }
            if cell.halvings < if bounded { HALVINGS } else { MORE_HALVINGS } {
                waiting.extend(cell.halves(self.domains));
            } else if bounded {
                self.look_at(&cell)?;
            } else {
                return Err(SurfaceFault::Unbounded { place: middle });
            }
        }
        Ok(())
    }

    /// Samples of a small part.
    fn look_at(&self, cell: &Cell) -> Result<(), SurfaceFault> {
        let places = |k: u32, axis: usize| {
            let (low, high) = cell.sides[axis];
            low + (high - low) * f64::from(k) / 4.0
        };
        for (i, j) in (0..=4).flat_map(|i| (0..=4).map(move |j| (i, j))) {
            value(self.formula, [places(i, 0), places(j, 1)])?;
        }
        for axis in [0, 1] {
            for share in [0, 2, 4] {
                let other = places(share, 1 - axis);
                let at = |t: f64| if axis == 0 { [t, other] } else { [other, t] };
                let (low, high) = cell.sides[axis];
                let Some((low, high)) = change(low, high, &|t| self.formula.ways(&at(t))) else { continue };
                let (before, after) = (value(self.formula, at(low))?, value(self.formula, at(high))?);
                if before.distance(after) > GAP * self.size {
                    return Err(SurfaceFault::Jump { place: at(high), before, after });
                }
            }
        }
        Ok(())
    }
}

/// A part of the rectangle.
struct Cell {
    sides: [(f64, f64); 2],
    halvings: u32,
}

impl Cell {
    fn middle(&self) -> [f64; 2] {
        self.sides.map(|(low, high)| low + (high - low) / 2.0)
    }

    /// Two halves across the side that is longer as a share of its range.
    fn halves(&self, domains: [Domain; 2]) -> [Self; 2] {
        let share = |axis: usize| (self.sides[axis].1 - self.sides[axis].0) / domains[axis].span();
        let axis = usize::from(share(1) > share(0));
        let middle = self.middle()[axis];
        let (mut low, mut high) = (self.sides, self.sides);
        low[axis].1 = middle;
        high[axis].0 = middle;
        [low, high].map(|sides| Self { sides, halvings: self.halvings + 1 })
    }
}

/// The last number that goes the ways of the start and the first that goes those of the end, where they differ.
fn change(from: f64, to: f64, ways: &impl Fn(f64) -> Vec<f64>) -> Option<(f64, f64)> {
    let (first, last) = (ways(from), ways(to));
    if first == last {
        return None;
    }
    // In one number between it may go a third way, as the sign of 0 does.
    let low = bisect(from, to, |t| ways(t) != first).0;
    Some((low, bisect(low, to, |t| ways(t) == last).1))
}

/// Where the ways of a formula change in a short part; else its middle.
fn turning(from: f64, to: f64, ways: &impl Fn(f64) -> Vec<f64>) -> f64 {
    change(from, to, ways).map_or(from + (to - from) / 2.0, |(_, high)| high)
}

/// Two neighboring numbers of which `reached` holds for the second alone, as for the end and not for the start.
fn bisect(from: f64, to: f64, reached: impl Fn(f64) -> bool) -> (f64, f64) {
    let (mut low, mut high) = (from, to);
    for _ in 0..80 {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            break;
        }
        if reached(middle) { high = middle } else { low = middle }
    }
    (low, high)
}

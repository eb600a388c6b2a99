//! What a formula of one variable does over a range: where it breaks, and whether a curve can follow it.
//!
//! The range is cut until bounds by interval arithmetic show each part to be smooth and moving, or it is as
//! short as rounding allows; what then remains are the places where the formula has a kink, stands still,
//! or ceases. Cost: a few hundred evaluations for a calm formula, at most [`MOST`].

use glam::DVec3;

use crate::geometry::formula::{Culprit, Formula, Interval, Jet, Quality};

/// Why a formula gives no curve over a range.
#[derive(Clone, Debug, PartialEq)]
pub enum FormulaFault {
    /// It has no finite value.
    NoValue {
        /// Where.
        t: f64,
        /// Because of which step.
        culprit: Culprit,
    },
    /// It goes to infinity.
    Unbounded {
        /// Where.
        t: f64,
    },
    /// It jumps.
    Jump {
        /// Where.
        t: f64,
        /// The point before.
        before: DVec3,
        /// The point after.
        after: DVec3,
    },
    /// It changes more often than can be followed.
    Wild {
        /// How far it was followed.
        t: f64,
    },
    /// It does not move.
    Still {
        /// From where.
        from: f64,
        /// To where.
        to: f64,
    },
}

/// A place where a formula is not smooth, or stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Break {
    /// Where.
    pub(super) t: f64,
    /// Up to here it is smooth.
    pub(super) before: f64,
    /// From here on it is smooth.
    pub(super) after: f64,
    /// Whether it is smooth here too and only stands still.
    pub(super) still: bool,
}

/// Most evaluations of a study.
const MOST: usize = 200_000;

/// No coordinate may be greater than this by size, as in a document.
const GREATEST: f64 = 1e15;

/// Parts this short, as a share of the range, are not cut further: rounding moves kinks by about as much.
const SHORTEST: f64 = 1.0 / (1u64 << 42) as f64;

/// Parts this short that are smooth, but may stand still, are not cut further: speeds such as 1 - cos t lose
/// half their digits where they vanish.
const SHORT: f64 = 1.0 / (1u64 << 23) as f64;

/// The three coordinates of a formula of one variable.
pub(super) fn point(formula: &Formula, t: f64) -> DVec3 {
    DVec3::from_array(formula.evaluate::<f64, 3>(&[t]))
}

/// Point, first and second derivative.
pub(super) fn derivatives(formula: &Formula, t: f64) -> [DVec3; 3] {
    let jets: [Jet<f64, 1>; 3] = formula.jets([t]);
    [
        DVec3::from_array(jets.map(|jet| jet.value)),
        DVec3::from_array(jets.map(|jet| jet.first[0])),
        DVec3::from_array(jets.map(|jet| jet.second[0][0])),
    ]
}

/// How a part of the range was found to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Nature {
    Smooth,
    /// Smooth, and somewhere in it the formula may stand still.
    Slow,
    /// It certainly stands still.
    Still,
    /// Too short to be known better.
    Unclear(Quality),
}

struct Part {
    from: f64,
    to: f64,
    nature: Nature,
}

/// The breaks of a formula between two parameters, in order; ends of the range are among them where the
/// formula is not smooth there.
///
/// # Errors
/// When the formula gives no curve there.
pub(super) fn breaks(formula: &Formula, from: f64, to: f64) -> Result<Vec<Break>, FormulaFault> {
    let parts = parts(formula, from, to)?;
    let start = point(formula, from);
    let size = parts.iter().map(|part| point(formula, part.to).distance(start)).fold(0.0, f64::max);
    let mut found = Vec::new();
    let mut run: Option<(usize, usize)> = None;
    for (index, part) in parts.iter().enumerate() {
        if part.nature != Nature::Smooth {
            run = Some((run.map_or(index, |(first, _)| first), index));
            continue;
        }
        match run.take() {
            Some(run) => found.extend(broken(formula, &parts, run, size)?),
            None if index > 0 => found.extend(touching(formula, &parts[index - 1], part, to - from)),
            None => {}
        }
    }
    if let Some(run) = run {
        found.extend(broken(formula, &parts, run, size)?);
    }
    Ok(found)
}

fn parts(formula: &Formula, from: f64, to: f64) -> Result<Vec<Part>, FormulaFault> {
    let span = to - from;
    let mut parts = Vec::new();
    let mut waiting = vec![(from, to)];
    let mut left = MOST;
    for end in [from, to] {
        check_value(formula, end)?;
    }
    while let Some((low, high)) = waiting.pop() {
        if left == 0 {
            return Err(FormulaFault::Wild { t: low });
        }
        left -= 1;
        let middle = low + (high - low) / 2.0;
        check_value(formula, middle)?;
        let nature = nature(formula, low, high);
        if nature == Nature::Still {
            return Err(FormulaFault::Still { from: low, to: high });
        }
        let enough = match nature {
            Nature::Smooth | Nature::Still => true,
            Nature::Slow => high - low <= SHORT * span,
            Nature::Unclear(_) => high - low <= SHORTEST * span,
        };
        if enough || middle <= low || middle >= high {
            parts.push(Part { from: low, to: high, nature });
        } else {
            waiting.push((middle, high));
            waiting.push((low, middle));
        }
    }
    Ok(parts)
}

fn check_value(formula: &Formula, t: f64) -> Result<(), FormulaFault> {
    if let Some(culprit) = formula.culprit(&[t]) {
        return Err(FormulaFault::NoValue { t, culprit });
    }
    if point(formula, t).abs().max_element() > GREATEST {
        return Err(FormulaFault::Unbounded { t });
    }
    Ok(())
}

fn nature(formula: &Formula, from: f64, to: f64) -> Nature {
    let jets: [Jet<Interval, 1>; 3] = formula.jets_over([Interval::new(from, to)]);
    let quality = jets.iter().map(|jet| jet.value.quality).min().unwrap_or(Quality::Unknown);
    let bounded = jets.iter().all(|jet| jet.value.size() <= GREATEST);
    if quality < Quality::Smooth || !bounded {
        return Nature::Unclear(if bounded { quality } else { Quality::Unknown });
    }
    if !jets.iter().all(|jet| jet.first[0].is_finite()) {
        return Nature::Unclear(Quality::Continuous);
    }
    if jets.iter().any(|jet| !jet.first[0].contains(0.0)) {
        Nature::Smooth
    } else if jets.iter().all(|jet| jet.first[0].size() == 0.0) {
        Nature::Still
    } else {
        Nature::Slow
    }
}

/// The break between two smooth parts, when the formula goes other ways in them.
fn touching(formula: &Formula, left: &Part, right: &Part, span: f64) -> Option<Break> {
    let middle = |part: &Part| part.from + (part.to - part.from) / 2.0;
    let changed = formula.ways(&[middle(left)]) != formula.ways(&[middle(right)]);
    // In the point itself the formula goes one way; derivatives of both are found beside it.
    let step = SHORTEST * span;
    let (before, after) = ((left.to - step).max(middle(left)), (right.from + step).min(middle(right)));
    changed.then_some(Break { t: left.to, before, after, still: false })
}

/// The break in a run of parts that are not smooth.
fn broken(
    formula: &Formula,
    parts: &[Part],
    (first, last): (usize, usize),
    size: f64,
) -> Result<Option<Break>, FormulaFault> {
    let run = &parts[first..=last];
    let (from, to) = (run[0].from, run[run.len() - 1].to);
    if run.iter().all(|part| part.nature == Nature::Slow) {
        return Ok(Some(Break { t: slowest(formula, from, to), before: from, after: to, still: true }));
    }
    let at_start = first == 0;
    let at_end = last + 1 == parts.len();
    let t = match (at_start, at_end) {
        (true, _) => from,
        (_, true) => to,
        _ => turning(formula, from, to),
    };
    for part in run.iter().filter(|part| part.nature == Nature::Unclear(Quality::Unknown)) {
        let values: [Interval; 3] = formula.evaluate(&[Interval::new(part.from, part.to)]);
        if !values.iter().all(|value| value.size() <= GREATEST) {
            return Err(FormulaFault::Unbounded { t });
        }
    }
    let quality =
        |part: &Part| if let Nature::Unclear(quality) = part.nature { quality } else { Quality::Smooth };
    if run.iter().any(|part| quality(part) < Quality::Continuous) {
        check_jump(formula, (from, to), size)?;
    }
    Ok(Some(Break { t, before: from, after: to, still: false }))
}

/// A formula that may jump somewhere in a short run does so between two neighboring numbers, where it changes
/// its ways.
fn check_jump(formula: &Formula, (from, to): (f64, f64), size: f64) -> Result<(), FormulaFault> {
    /// Of the size of the curve: roots, which are steep without end, rise by 1e-8 over the last digit.
    const GAP: f64 = 1e-7;
    let (first, last) = (formula.ways(&[from]), formula.ways(&[to]));
    if first == last {
        return Ok(());
    }
    // In one number between it may go a third way, as the sign of 0 does.
    let low = bisect(from, to, |t| formula.ways(&[t]) != first).0;
    let high = bisect(low, to, |t| formula.ways(&[t]) == last).1;
    let (before, after) = (point(formula, low), point(formula, high));
    if before.distance(after) > GAP * size {
        return Err(FormulaFault::Jump { t: high, before, after });
    }
    Ok(())
}

/// Where a formula that is smooth moves most slowly.
fn slowest(formula: &Formula, from: f64, to: f64) -> f64 {
    let mut t = from + (to - from) / 2.0;
    for _ in 0..24 {
        let [_, first, second] = derivatives(formula, t);
        let bend = second.length_squared();
        let next = (t - first.dot(second) / bend).clamp(from, to);
        if bend == 0.0 || !next.is_finite() || next == t {
            break;
        }
        t = next;
    }
    t
}

/// Where the ways of a formula change in a short run; else where it turns back; else the middle.
fn turning(formula: &Formula, from: f64, to: f64) -> f64 {
    let last = formula.ways(&[to]);
    if formula.ways(&[from]) != last {
        return bisect(from, to, |t| formula.ways(&[t]) == last).1;
    }
    let [_, onward, _] = derivatives(formula, to);
    let [_, before, _] = derivatives(formula, from);
    if before.dot(onward) < 0.0 {
        return bisect(from, to, |t| derivatives(formula, t)[1].dot(onward) > 0.0).1;
    }
    from + (to - from) / 2.0
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

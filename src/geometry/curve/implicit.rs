//! Plane curves on which a formula of x and y is zero.
//!
//! The box is quartered until on each cell the formula either has no zero, or its gradient turns by less than a right
//! angle; interval arithmetic proves both. Then signs at the corners of equal cells tell how the curve runs: S. Plantinga,
//! G. Vegter, Isotopic approximation of implicit curves and surfaces, SGP 2004. On the border of the box the formula is
//! monotone along each cell side that the curve may meet, so that no part that only peeps in is lost. Places where no
//! quartering helps are told: crossings, cusps, lone points, doubled curves, contact with the border.
//!
//! Between places on the curve, found to rounding, run cubic pieces with the curve's own directions, halved until they
//! follow it.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use super::BezierSpline;
use crate::geometry::formula::{Formula, Interval, Quality};

/// Why no curve is found.
#[derive(Clone, Debug, PartialEq)]
pub enum ImplicitFault {
    /// The formula is zero nowhere in the box.
    Nowhere,
    /// Near these places the zeros are no smooth curve, or cannot be shown to be one.
    Singular(Vec<DVec2>),
    /// The curve is too long or too fine for the cells that are allowed.
    Intricate,
}

/// Deepest quartering where something cannot be decided.
const DEEPEST: u32 = 14;

/// Least quartering: cells are small beside the box.
const SHALLOWEST: u32 = 5;

/// Most cells that are looked at.
const CELLS: usize = 1 << 17;

/// By this part of a cell its surroundings are looked at too.
const MARGIN: f64 = 1.0 / 64.0;

/// Places on the curve that lie closer than this part of a cell are one: a direction between them means nothing.
const CLOSE: f64 = 1e-3;

/// Cubic pieces are halved until they follow the curve to this part of the box.
const FOLLOWED: f64 = 1e-9;

/// The parts of the curve f(x, y) = 0 in a box, open ones with their ends on its border; each has the side where f is
/// negative to its left, so that an outline around negative values turns counter-clockwise. The formula has two
/// variables and one result.
///
/// Deterministic. Cost: one interval evaluation a cell; cells grow with the length of the curve over the smallest
/// feature that has to be told apart.
///
/// # Errors
/// See [`ImplicitFault`].
pub fn implicit(formula: &Formula, low: DVec2, high: DVec2) -> Result<Vec<BezierSpline>, ImplicitFault> {
    let field = Field { formula, low, size: high - low };
    let level = field.level()?;
    let cells = field.cells(level)?;
    let chains = field.chains(level, &cells);
    if chains.is_empty() {
        return Err(ImplicitFault::Nowhere);
    }
    Ok(chains.iter().filter_map(|chain| field.curve(chain)).collect())
}

struct Field<'a> {
    formula: &'a Formula,
    low: DVec2,
    size: DVec2,
}

/// A cell of a level: column and row.
type Cell = (u32, u32);

/// A side of a cell, by its lower or left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Edge {
    /// To the right of the corner.
    Across(Cell),
    /// Upward from the corner.
    Up(Cell),
}

/// What intervals say of a cell.
#[derive(PartialEq)]
enum Verdict {
    /// No zero.
    Empty,
    /// At most one simple branch.
    Simple,
    Undecided,
}

impl Field<'_> {
    fn corner(&self, level: u32, (x, y): Cell) -> DVec2 {
        let step = 1.0 / f64::from(1_u32 << level);
        self.low + self.size * DVec2::new(f64::from(x) * step, f64::from(y) * step)
    }

    fn value(&self, place: DVec2) -> f64 {
        let [value] = self.formula.evaluate::<f64, 1>(&place.to_array());
        value
    }

    fn gradient(&self, place: DVec2) -> (f64, DVec2) {
        let [jet] = self.formula.jets::<2, 1>(place.to_array());
        (jet.value, DVec2::from(jet.first))
    }

    fn verdict(&self, level: u32, cell: Cell) -> Verdict {
        // A little more than the cell, so that a kink or a jump along its side is seen.
        let margin = self.size * (MARGIN / f64::from(1_u32 << level));
        let a = (self.corner(level, cell) - margin).max(self.low);
        let b = (self.corner(level, (cell.0 + 1, cell.1 + 1)) + margin).min(self.low + self.size);
        let sides = [Interval::new(a.x, b.x), Interval::new(a.y, b.y)];
        let [jet] = self.formula.jets_over::<2, 1>(sides);
        if jet.value.quality > Quality::Unknown && !jet.value.contains(0.0) {
            return Verdict::Empty;
        }
        let smooth =
            [jet.value, jet.first[0], jet.first[1]].iter().all(|part| part.quality == Quality::Smooth);
        let turns = least_product(jet.first[0]) + least_product(jet.first[1]);
        if smooth && turns > 0.0 && self.border_is_simple(level, cell) {
            return Verdict::Simple;
        }
        Verdict::Undecided
    }

    /// Along sides on the border of the box the formula has no zero or grows one way.
    fn border_is_simple(&self, level: u32, (x, y): Cell) -> bool {
        let last = 1_u32 << level;
        let (a, b) = (self.corner(level, (x, y)), self.corner(level, (x + 1, y + 1)));
        let simple = |sides: [Interval; 2], along: usize| {
            let [jet] = self.formula.jets_over::<2, 1>(sides);
            !jet.value.contains(0.0) || !jet.first[along].contains(0.0)
        };
        let (wide, tall) = (Interval::new(a.x, b.x), Interval::new(a.y, b.y));
        let at = |number: f64| Interval::new(number, number);
        (x > 0 || simple([at(a.x), tall], 1))
            && (x + 1 < last || simple([at(b.x), tall], 1))
            && (y > 0 || simple([wide, at(a.y)], 0))
            && (y + 1 < last || simple([wide, at(b.y)], 0))
    }

    /// The level at which every cell is decided.
    fn level(&self) -> Result<u32, ImplicitFault> {
        let mut open: Vec<Cell> = vec![(0, 0)];
        let mut looked = 0;
        for level in 0..=DEEPEST {
            open.retain(|cell| level < SHALLOWEST || self.verdict(level, *cell) == Verdict::Undecided);
            looked += open.len();
            if open.is_empty() {
                return Ok(level);
            }
            if level == DEEPEST {
                break;
            }
            if looked > CELLS {
                return Err(self.unclear(level, &open));
            }
            open = open.into_iter().flat_map(quarters).collect();
        }
        Err(self.unclear(DEEPEST, &open))
    }

    /// The places of cells that stay undecided, neighbors as one.
    fn unclear(&self, level: u32, open: &[Cell]) -> ImplicitFault {
        const MOST: usize = 8;
        let mut left: BTreeSet<Cell> = open.iter().copied().collect();
        let mut places = Vec::new();
        while let Some(first) = left.pop_first() {
            let (mut group, mut waiting) = (Vec::new(), vec![first]);
            while let Some(cell) = waiting.pop() {
                group.push(cell);
                for x in cell.0.saturating_sub(1)..=cell.0 + 1 {
                    for y in cell.1.saturating_sub(1)..=cell.1 + 1 {
                        if left.remove(&(x, y)) {
                            waiting.push((x, y));
                        }
                    }
                }
            }
            let sum: DVec2 = group
                .iter()
                .map(|cell| self.corner(level, *cell) + self.corner(level, (cell.0 + 1, cell.1 + 1)))
                .sum();
            places.push(sum / (2.0 * group.len() as f64));
        }
        places.truncate(MOST);
        ImplicitFault::Singular(places)
    }

    /// The cells of a level that may hold a zero.
    fn cells(&self, level: u32) -> Result<Vec<Cell>, ImplicitFault> {
        let mut open: Vec<Cell> = vec![(0, 0)];
        for depth in 0..=level {
            if depth > 0 {
                open = open.into_iter().flat_map(quarters).collect();
            }
            open.retain(|cell| self.verdict(depth, *cell) != Verdict::Empty);
            if open.len() > CELLS {
                return Err(ImplicitFault::Intricate);
            }
        }
        Ok(open)
    }

    /// Chains of places on the curve, by the sides of the cells that it passes. Closed ones end where they start.
    fn chains(&self, level: u32, cells: &[Cell]) -> Vec<Vec<DVec2>> {
        let mut next: BTreeMap<Edge, Edge> = BTreeMap::new();
        let positive = |cell: Cell| self.value(self.corner(level, cell)) >= 0.0;
        for &(x, y) in cells {
            // Counter-clockwise around the cell; the curve enters where values rise to the next corner.
            let ring = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let edges =
                [Edge::Across((x, y)), Edge::Up((x + 1, y)), Edge::Across((x, y + 1)), Edge::Up((x, y))];
            let signs = ring.map(positive);
            let step = |k: usize| (signs[k], signs[(k + 1) % 4]);
            let rising = (0..4).find(|k| step(*k) == (false, true));
            let falling = (0..4).find(|k| step(*k) == (true, false));
            if let (Some(rising), Some(falling)) = (rising, falling) {
                next.insert(edges[rising], edges[falling]);
            }
        }
        let entered: BTreeSet<Edge> = next.values().copied().collect();
        let begins: Vec<Edge> = next.keys().copied().filter(|edge| !entered.contains(edge)).collect();
        let mut chains = Vec::new();
        for first in begins {
            chains.push(self.chain(level, first, &mut next));
        }
        while let Some((&first, _)) = next.first_key_value() {
            chains.push(self.chain(level, first, &mut next));
        }
        chains.retain(|chain| chain.len() > 1);
        chains
    }

    fn chain(&self, level: u32, first: Edge, next: &mut BTreeMap<Edge, Edge>) -> Vec<DVec2> {
        let mut places = vec![self.crossing(level, first)];
        let close = CLOSE * self.size.max_element() / f64::from(1_u32 << level);
        let mut edge = first;
        while let Some(following) = next.remove(&edge) {
            let place = self.crossing(level, following);
            // A curve through a corner of the grid meets two sides there.
            if places.last().is_none_or(|last| last.distance(place) > close) {
                places.push(place);
            }
            edge = following;
        }
        // The end is where it is, though a place just before it may have stood for it.
        if places.len() > 1
            && let Some(last) = places.last_mut()
        {
            *last = self.crossing(level, edge);
        }
        places
    }

    /// The zero on a side, to rounding: halving keeps a change of sign.
    fn crossing(&self, level: u32, edge: Edge) -> DVec2 {
        let (from, to) = match edge {
            Edge::Across((x, y)) => ((x, y), (x + 1, y)),
            Edge::Up((x, y)) => ((x, y), (x, y + 1)),
        };
        let (mut from, mut to) = (self.corner(level, from), self.corner(level, to));
        let start = self.value(from) >= 0.0;
        for _ in 0..64 {
            let middle = (from + to) / 2.0;
            if (self.value(middle) >= 0.0) == start { from = middle } else { to = middle }
        }
        (from + to) / 2.0
    }

    /// Cubic pieces through a chain.
    fn curve(&self, chain: &[DVec2]) -> Option<BezierSpline> {
        let mut points = vec![chain[0].extend(0.0)];
        let mut knots = vec![0.0];
        let mut reached = 0.0;
        for pair in chain.windows(2) {
            for control in self.pieces([pair[0], pair[1]]) {
                reached += control[0].distance(control[3]);
                knots.push(reached);
                points.extend(control[1..].iter().map(|point| point.extend(0.0)));
            }
        }
        let first: DVec3 = points[0];
        if chain[0] == chain[chain.len() - 1]
            && let Some(last) = points.last_mut()
        {
            *last = first;
        }
        BezierSpline::with_knots(3, points, knots).ok()
    }

    fn pieces(&self, ends: [DVec2; 2]) -> Vec<[DVec2; 4]> {
        const HALVINGS: u32 = 12;
        let mut done = Vec::new();
        let mut waiting = vec![(ends, HALVINGS)];
        while let Some(([from, to], halvings)) = waiting.pop() {
            let control = self.cubic(from, to);
            let middle = self.onto(cubic_point(&control, 0.5));
            let follows = [0.25, 0.5, 0.75].into_iter().all(|share| {
                let place = cubic_point(&control, share);
                self.onto(place).distance(place) <= FOLLOWED * self.size.max_element()
            });
            let apart = middle != from && middle != to;
            if follows || halvings == 0 || !apart {
                done.push(control);
            } else {
                waiting.push(([middle, to], halvings - 1));
                waiting.push(([from, middle], halvings - 1));
            }
        }
        done
    }

    fn cubic(&self, from: DVec2, to: DVec2) -> [DVec2; 4] {
        let chord = to - from;
        let along = |place: DVec2| {
            let tangent = self.gradient(place).1.perp().normalize_or(chord.normalize_or_zero());
            if tangent.dot(chord) < 0.0 { -tangent } else { tangent }
        };
        let third = chord.length() / 3.0;
        [from, from + along(from) * third, to - along(to) * third, to]
    }

    /// The place on the curve near another: Newton's method along the gradient.
    fn onto(&self, place: DVec2) -> DVec2 {
        let mut place = place;
        for _ in 0..8 {
            let (value, gradient) = self.gradient(place);
            let square = gradient.length_squared();
            if square == 0.0 || value == 0.0 {
                break;
            }
            place -= gradient * (value / square);
        }
        place
    }
}

/// The least product of two numbers of an interval.
fn least_product(part: Interval) -> f64 {
    let least = part.low.abs().min(part.high.abs());
    if part.contains(0.0) { part.low * part.high } else { least * least }
}

fn quarters((x, y): Cell) -> [Cell; 4] {
    [(2 * x, 2 * y), (2 * x + 1, 2 * y), (2 * x, 2 * y + 1), (2 * x + 1, 2 * y + 1)]
}

fn cubic_point(control: &[DVec2; 4], share: f64) -> DVec2 {
    let rest = 1.0 - share;
    control[0] * (rest * rest * rest)
        + control[1] * (3.0 * rest * rest * share)
        + control[2] * (3.0 * rest * share * share)
        + control[3] * (share * share * share)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{ImplicitFault, implicit};
    use crate::geometry::curve::{BezierSpline, Curve as _, length};
    use crate::geometry::formula::{Binary, Builder, Formula, Operation, Slot, Unary};

    /// A formula of x and y by what `make` adds to the program.
    fn formula(make: impl Fn(&mut Builder, Slot, Slot) -> Slot) -> Formula {
        let mut program = Builder::new();
        let (x, y) = (program.push(Operation::Variable(0)), program.push(Operation::Variable(1)));
        let output = make(&mut program, x, y);
        program.finish(2, vec![output])
    }

    fn square(program: &mut Builder, x: Slot) -> Slot {
        program.push(Operation::Power(x, 2.0))
    }

    /// x^2 + y^2 - radius^2
    fn disk(program: &mut Builder, x: Slot, y: Slot, radius: f64) -> Slot {
        let (a, b) = (square(program, x), square(program, y));
        let sum = program.binary(Binary::Add, a, b);
        let constant = program.constant(radius * radius);
        program.binary(Binary::Subtract, sum, constant)
    }

    fn traced(formula: &Formula, reach: f64) -> Result<Vec<BezierSpline>, ImplicitFault> {
        implicit(formula, DVec2::splat(-reach), DVec2::splat(reach))
    }

    #[test]
    fn circles_are_found_whole_and_turn_counter_clockwise() {
        let circle = formula(|program, x, y| disk(program, x, y, 1.0));
        let found = traced(&circle, 1.5).unwrap();
        assert_eq!(found.len(), 1);
        assert!(found[0].is_closed() && found[0].joints().is_empty());
        assert!((length(&found[0]) - 2.0 * core::f64::consts::PI).abs() < 1e-7);
        let domain = found[0].domain();
        for k in 0..1000 {
            let jet = found[0].evaluate(domain.at(f64::from(k) / 1000.0), super::super::Side::After);
            assert!((jet.point.length() - 1.0).abs() < 1e-8);
            assert!(jet.point.truncate().perp_dot(jet.first.truncate()) > 0.0);
        }
    }

    #[test]
    fn rings_that_lie_close_stay_apart() {
        let rings = formula(|program, x, y| {
            let (one, other) = (disk(program, x, y, 1.0), disk(program, x, y, 1.01));
            program.binary(Binary::Multiply, one, other)
        });
        let mut lengths: Vec<f64> = traced(&rings, 1.2).unwrap().iter().map(length).collect();
        lengths.sort_by(f64::total_cmp);
        assert_eq!(lengths.len(), 2);
        for (found, radius) in lengths.iter().zip([1.0, 1.01]) {
            assert!((found - 2.0 * core::f64::consts::PI * radius).abs() < 1e-6, "{found}");
        }
    }

    #[test]
    fn parts_end_on_the_border() {
        let circle = formula(|program, x, y| disk(program, x, y, 1.0));
        let found = implicit(&circle, DVec2::new(-0.5, -2.0), DVec2::new(0.5, 2.0)).unwrap();
        assert_eq!(found.len(), 2);
        for part in found {
            let domain = part.domain();
            for end in [domain.start, domain.end] {
                assert!((part.point(end).x.abs() - 0.5).abs() < 1e-12);
            }
            assert!((length(&part) - core::f64::consts::FRAC_PI_3).abs() < 1e-7);
        }
    }

    #[test]
    fn what_is_no_smooth_curve_is_named() {
        let cross = formula(|program, x, y| program.binary(Binary::Multiply, x, y));
        let Err(ImplicitFault::Singular(places)) = traced(&cross, 1.0) else { panic!() };
        assert!(places.len() == 1 && places[0].length() < 1e-3, "{places:?}");
        // x^3 - y^2 has a cusp; |x| + |y| - 1/2 has corners, which lie on the sides of cells.
        let cusp = formula(|program, x, y| {
            let (a, b) = (program.push(Operation::Power(x, 3.0)), square(program, y));
            program.binary(Binary::Subtract, a, b)
        });
        let Err(ImplicitFault::Singular(places)) = traced(&cusp, 2.0) else { panic!() };
        assert!(places.len() == 1 && places[0].length() < 0.01, "{places:?}");
        let diamond = formula(|program, x, y| {
            let (a, b) = (program.unary(Unary::Abs, x), program.unary(Unary::Abs, y));
            let (sum, half) = (program.binary(Binary::Add, a, b), program.constant(0.5));
            program.binary(Binary::Subtract, sum, half)
        });
        let Err(ImplicitFault::Singular(places)) = traced(&diamond, 1.0) else { panic!() };
        assert_eq!(places.len(), 4, "{places:?}");
        let point = formula(|program, x, y| disk(program, x, y, 0.0));
        assert!(matches!(traced(&point, 1.0), Err(ImplicitFault::Singular(places)) if places.len() == 1));
        let doubled = formula(|program, x, y| {
            let disk = disk(program, x, y, 0.7);
            square(program, disk)
        });
        assert!(matches!(traced(&doubled, 1.0), Err(ImplicitFault::Singular(_))));
        // Touches the border from inside.
        let touching = formula(|program, x, y| disk(program, x, y, 1.0));
        assert!(matches!(traced(&touching, 1.0), Err(ImplicitFault::Singular(places)) if places.len() == 4));
        assert_eq!(
            traced(&formula(|program, x, y| disk(program, x, y, 9.0)), 1.0),
            Err(ImplicitFault::Nowhere)
        );
    }
}

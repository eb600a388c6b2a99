//! How finely a block needs to be cut, from its second fundamental form at samples.
//!
//! A block is cut into rows, and each row into steps of its own. With L, M, N the second fundamental form of the
//! place, steps h along the row and rows k high leave out |L h^2| / 8 and |N k^2| / 8 along their sides and
//! |L h^2 ± 2 M h k + N k^2| / 8 along their diagonals, which is all where triangles have a right or an obtuse
//! angle (E. F. D'Azevedo, R. B. Simpson, On optimal interpolation triangle incidences, SIAM J. Sci. Stat.
//! Comput. 10, 1989). The rows are made as high, and run in the direction, that gives the fewest triangles.

use glam::DVec3;

use super::density::Density;
use super::layout::{Block, Rim};
use crate::geometry::number::{cbrt, ln};

/// What is known of a block at a lattice of places; derivatives by fractions of the block.
struct Samples {
    /// Places along a row (x), and rows (y); one less is the number of pieces.
    across: usize,
    up: usize,
    places: Vec<Sample>,
}

#[derive(Clone, Copy)]
struct Sample {
    /// Second fundamental form.
    l: f64,
    m: f64,
    n: f64,
    /// Lengths of the tangents.
    x: f64,
    y: f64,
    /// Greatest of the second derivatives across the tangents: what chords of the lines themselves leave out.
    bend_x: f64,
    bend_y: f64,
}

/// The demand of one block.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Whether rows run along u.
    pub(super) along_u: bool,
    /// Rows, from the bottom to the top.
    pub(super) rows: Density,
    /// Steps along the row at even places from the bottom to the top.
    pub(super) steps: Vec<Density>,
    /// Chords that the four rims need as lines of their own, in the order of [`Rim::ALL`].
    pub(super) chords: [Density; 4],
    /// Whether every other row is shifted by half a step: where the surface bends to one side, triangles that are nearly
    /// equilateral in the sense of the error leave out less than right ones.
    pub(super) shifted: bool,
    /// Fewer rows than these would pass the tolerance however many steps they have.
    least: f64,
    /// Triangles, about.
    pub(super) triangles: f64,
}

/// Normals turn by no more than about this many radians over one step, however coarse the tolerance: a circle
/// does not become a line.
const GREATEST_TURN: f64 = 1.4;

/// With fewer rows than these the halves of steps at the ends of shifted rows cost what the shift saves.
const FEWEST_SHIFTED: f64 = 6.0;

/// Lines that are looked at to see how fine the lattice has to be.
const PROBES: [f64; 3] = [0.13, 0.5, 0.87];

/// Pieces of the lattice, from coarse to fine: as many as show all of the bends.
const LATTICES: [usize; 4] = [8, 16, 32, 64];

impl Plan {
    /// Rows of the block for a tolerance in metres.
    pub(super) fn new(block: &Block<'_>, tolerance: f64, poles: [bool; 4]) -> Self {
        let samples = Samples::new(block);
        let turned = samples.transposed();
        let chords = chords(&samples, &turned, tolerance);
        let [bottom, right, top, left] = poles;
        let rows_along = |along_u: bool| {
            let samples = if along_u { &samples } else { &turned };
            let beside = if along_u { [&chords[3], &chords[1]] } else { [&chords[0], &chords[2]] };
            Self { along_u, chords: chords.clone(), ..cheapest(samples, tolerance, beside) }
        };
        // Rows end in a pole as in a single point; across one they would crowd into it.
        if bottom || top {
            return rows_along(true);
        }
        if left || right {
            return rows_along(false);
        }
        let (one, other) = (rows_along(true), rows_along(false));
        let mut best = if other.triangles < 0.98 * one.triangles { other } else { one };
        best.shifted = best.rows.total() >= FEWEST_SHIFTED && samples.bend_to_one_side();
        best.pair_rows();
        best
    }

    /// Makes the rows an even number, so that shifted ones lie between two that are not.
    fn pair_rows(&mut self) {
        let total = self.rows.total();
        let pairs = (total * 0.995 / 2.0).ceil();
        if self.shifted && total > 0.0 {
            self.rows = self.rows.scaled(2.0 * pairs / total);
        }
    }

    /// The rows of a fixed grid.
    pub(super) fn grid(u: u32, v: u32) -> Self {
        let (u, v) = (Density::even(f64::from(u)), Density::even(f64::from(v)));
        let chords = [u.clone(), v.clone(), u.clone(), v.clone()];
        let triangles = 2.0 * u.total() * v.total();
        let least = v.total();
        Self { along_u: true, shifted: false, least, rows: v, steps: vec![u.clone(), u], chords, triangles }
    }

    /// What the surface itself needs along a rim.
    pub(super) fn along(&self, rim: Rim) -> Density {
        if rim.along_u() != self.along_u {
            return self.rows.clone();
        }
        match rim {
            Rim::Bottom | Rim::Left => self.steps[0].clone(),
            Rim::Top | Rim::Right => self.steps[self.steps.len() - 1].clone(),
        }
    }

    /// Makes rows and steps finer, or coarser, by a factor. Few rows are a whole number first: those become more
    /// only where they would no longer be low enough.
    pub(super) fn scale(&mut self, factor: f64) {
        self.least *= factor;
        if self.rows.total() >= 6.0 || self.least > self.rows.total() {
            self.rows = self.rows.scaled(factor);
            self.pair_rows();
        }
        for steps in &mut self.steps {
            *steps = steps.scaled(factor);
        }
        self.triangles *= factor * factor;
    }
}

impl Samples {
    fn new(block: &Block<'_>) -> Self {
        let (across, up) = (fineness(block, true), fineness(block, false));
        let mut places = Vec::with_capacity((across + 1) * (up + 1));
        for row in 0..=up {
            for column in 0..=across {
                let part = (column as f64 / across as f64, row as f64 / up as f64);
                places.push(Sample::new(block, part));
            }
        }
        Self { across: across + 1, up: up + 1, places }
    }

    fn get(&self, column: usize, row: usize) -> &Sample {
        &self.places[row * self.across + column]
    }

    fn row(&self, row: usize) -> &[Sample] {
        &self.places[row * self.across..(row + 1) * self.across]
    }

    /// Whether it is curved like an egg at most places. Where it is a saddle a shift saves nothing, and costs nothing.
    fn bend_to_one_side(&self) -> bool {
        let round = |sample: &&Sample| sample.l * sample.n > sample.m * sample.m;
        2 * self.places.iter().filter(round).count() >= self.places.len()
    }

    fn transposed(&self) -> Self {
        let turn = |sample: &Sample| Sample {
            l: sample.n,
            m: sample.m,
            n: sample.l,
            x: sample.y,
            y: sample.x,
            bend_x: sample.bend_y,
            bend_y: sample.bend_x,
        };
        let columns = (0..self.across).flat_map(|column| (0..self.up).map(move |row| (column, row)));
        let places = columns.map(|(column, row)| turn(self.get(column, row))).collect();
        Self { across: self.up, up: self.across, places }
    }
}

impl Sample {
    fn new(block: &Block<'_>, part: (f64, f64)) -> Self {
        let (u, v) = block.at(part);
        let (across, up) = block.spans();
        let (jet, second) = (block.jet(u, v), block.second(u, v));
        let (du, dv) = (jet.du * across, jet.dv * up);
        let (uu, uv, vv) = (second.uu * (across * across), second.uv * (across * up), second.vv * (up * up));
        let beside = |bend: DVec3, tangent: DVec3| {
            let direction = tangent.normalize_or_zero();
            (bend - direction * bend.dot(direction)).length()
        };
        Self {
            l: uu.dot(jet.normal),
            m: uv.dot(jet.normal),
            n: vv.dot(jet.normal),
            x: du.length(),
            y: dv.length(),
            bend_x: beside(uu, du),
            bend_y: beside(vv, dv),
        }
    }

    /// Steps that keep lines and normal from turning too far, along the row and across.
    fn turns(&self) -> (f64, f64) {
        let rate = |bend: f64, length: f64| if length > 0.0 { bend.abs() / length } else { 0.0 };
        let x = rate(self.bend_x, self.x).max(rate(self.m, self.y));
        let y = rate(self.bend_y, self.y).max(rate(self.m, self.x.max(0.01 * self.y)));
        (x / GREATEST_TURN, y / GREATEST_TURN)
    }

    /// Steps along a row of this height whose chords keep away from the neighbouring rows: a row that bends in the
    /// surface must not cut off the corners of the next.
    fn apart(&self, height: f64) -> f64 {
        /// Share of the height that chords may take.
        const ROOM: f64 = 0.15;
        let aside = (self.bend_x * self.bend_x - self.l * self.l).max(0.0).sqrt();
        let room = ROOM * self.y * height;
        if aside > 0.0 && room > 0.0 { (aside / (8.0 * room)).sqrt() } else { 0.0 }
    }
}

/// Pieces of a lattice that are fine enough to see the bends of the lines along one parameter.
fn fineness(block: &Block<'_>, along_u: bool) -> usize {
    let bends = |pieces: usize| {
        let sum = |fixed: f64| {
            (0..pieces)
                .map(|k| {
                    let part = (k as f64 + 0.5) / pieces as f64;
                    let sample = Sample::new(block, if along_u { (part, fixed) } else { (fixed, part) });
                    if along_u { sample.bend_x.sqrt() } else { sample.bend_y.sqrt() }
                })
                .sum::<f64>()
                / pieces as f64
        };
        PROBES.map(sum)
    };
    let mut coarse = bends(LATTICES[0]);
    for pair in LATTICES.windows(2) {
        let fine = bends(pair[1]);
        let same = coarse.iter().zip(fine).all(|(a, b)| (a - b).abs() <= 0.04 * b);
        if same {
            return pair[0];
        }
        coarse = fine;
    }
    LATTICES[LATTICES.len() - 1]
}

/// Chords that the rims need as lines.
fn chords(samples: &Samples, turned: &Samples, tolerance: f64) -> [Density; 4] {
    let line = |samples: &Samples, row: usize| {
        let steps = |sample: &Sample| {
            let turn = if sample.x > 0.0 { sample.bend_x / sample.x / GREATEST_TURN } else { 0.0 };
            (sample.bend_x / (8.0 * tolerance)).sqrt().max(turn)
        };
        Density(samples.row(row).iter().map(steps).collect())
    };
    [line(samples, 0), line(turned, turned.up - 1), line(samples, samples.up - 1), line(turned, 0)]
}

/// Factors by which the heights of rows are tried.
const TRIALS: [f64; 9] = [0.35, 0.5, 0.71, 0.84, 1.0, 1.19, 1.41, 2.0, 2.8];

/// Rows and steps with the fewest triangles among a few heights of rows.
fn cheapest(samples: &Samples, tolerance: f64, beside: [&Density; 2]) -> Plan {
    let mut rows: Vec<RowNeeds> =
        (0..samples.up).map(|row| RowNeeds::new(samples.row(row), tolerance)).collect();
    for column in 0..samples.across {
        let bends = (0..samples.up).map(|row| samples.get(column, row).n);
        for (row, change) in rows.iter_mut().zip(changes(bends)) {
            row.least = row.least.max(cbrt(ODD * change / tolerance));
        }
    }
    let balanced = Density(rows.iter().map(|row| row.balanced).collect());
    let least = Density(rows.iter().map(|row| row.least).collect());
    let mut tried: Vec<f64> =
        TRIALS.iter().map(|factor| (balanced.total() * factor).ceil().max(1.0)).collect();
    tried.extend([1.0, 2.0, 3.0]);
    tried.sort_by(f64::total_cmp);
    tried.dedup();
    let mut trials: Vec<Density> =
        tried.into_iter().filter_map(|count| heights(&balanced, &least, count)).collect();
    if trials.is_empty() {
        trials.push(balanced.max(&least));
    }
    let trial = |rows: Density| {
        let steps: Vec<Density> =
            (0..samples.up).map(|row| steps(samples.row(row), rows.0[row], tolerance)).collect();
        let triangles = total(&rows, &steps, beside);
        let cost = triangles * (1.0 + SLENDER * slenderness(samples, &rows, &steps));
        let chords = [0; 4].map(|_| Density::even(0.0));
        let least = least.total();
        (cost, Plan { along_u: true, shifted: false, least, rows, steps, chords, triangles })
    };
    let mut best: Option<(f64, Plan)> = None;
    for (cost, plan) in trials.into_iter().map(trial) {
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, plan));
        }
    }
    best.expect("there is at least one trial").1
}

/// What a halving of the width of triangles at the same height must save to be worth it: slender triangles shade
/// badly and are harder to prove.
const SLENDER: f64 = 0.03;

/// How often the longer side of the steps in the middle must be halved to be as long as the shorter one, on the average.
fn slenderness(samples: &Samples, heights: &Density, steps: &[Density]) -> f64 {
    let row = samples.up / 2;
    let halvings = |(sample, steps): (&Sample, &f64)| {
        let (along, up) = (sample.x / steps.max(1.0), sample.y / heights.0[row].max(1.0));
        if along > 0.0 && up > 0.0 { (ln(along / up) / core::f64::consts::LN_2).abs().min(20.0) } else { 0.0 }
    };
    let all = samples.row(row).iter().zip(&steps[row].0);
    all.map(halvings).sum::<f64>() / samples.across as f64
}

/// What the places of one row ask of the heights of rows.
struct RowNeeds {
    /// Rows that give about square triangles in the sense of the error.
    balanced: f64,
    /// Fewer rows would alone pass the tolerance.
    least: f64,
}

impl RowNeeds {
    fn new(row: &[Sample], tolerance: f64) -> Self {
        /// Slants of steps against rows beyond this have more to do with a pole near by than with a shape.
        const STEEPEST: f64 = 1e3;
        let mut needs = Self { balanced: 0.0, least: 0.0 };
        for sample in row {
            let slant = if sample.x > 0.0 { (sample.y / sample.x).min(STEEPEST) } else { 0.0 };
            let both = sample.n.abs() + 2.0 * sample.m.abs() * slant;
            let turn = sample.turns().1;
            // Rows that leave something for the steps.
            let alone = (sample.n.abs() / (7.6 * tolerance)).sqrt().max(turn);
            needs.balanced = needs.balanced.max((2.0 * both / (8.0 * tolerance)).sqrt()).max(turn);
            needs.least = needs.least.max(alone);
        }
        needs
    }
}

/// `count` rows in the proportions of the balance, nowhere fewer than the least; `None` where that needs more.
fn heights(balanced: &Density, least: &Density, count: f64) -> Option<Density> {
    let whole = balanced.total();
    let even = if whole > 0.0 { balanced.scaled(count / whole) } else { Density::even(count) };
    let raised = even.max(least);
    let total = raised.total();
    if total > 1.3 * count {
        return None;
    }
    Some(raised.scaled(total.ceil().max(count) / total))
}

/// Steps along a row of which `rows` would fill the block.
fn steps(row: &[Sample], rows: f64, tolerance: f64) -> Density {
    let height = 1.0 / rows;
    let limit = 8.0 * tolerance;
    let needed = |sample: &Sample| {
        let rise = sample.n * height * height;
        // Bends to one side add up along the diagonal, bends to opposite sides do not.
        let left = if sample.l * sample.n > 0.0 { (limit - rise.abs()).max(0.05 * limit) } else { limit };
        let bend = (sample.l.abs() / left).sqrt();
        let twist = 2.0 * sample.m.abs() * height / limit;
        bend.max(twist).max(sample.turns().0).max(sample.apart(height))
    };
    let changes = changes(row.iter().map(|sample| sample.l));
    let change = changes.map(|change| cbrt(ODD * change / tolerance));
    Density(row.iter().zip(change).map(|(sample, change)| needed(sample).max(change)).collect())
}

/// What a third derivative d leaves out over a unit step: the most of d t (1 - t) (1 - 2t) / 12.
const ODD: f64 = 0.00802;

/// How fast values at even places from 0 to 1 change: they say nothing of a step over a place where they vanish.
fn changes(values: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    let values: Vec<f64> = values.collect();
    let last = values.len() - 1;
    (0..=last).map(move |k| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (values[after] - values[before]).abs() * last as f64 / (after - before) as f64
    })
}

/// Triangles of so many rows with so many steps. Rims that need more chords than there are rows get strips of
/// triangles that are good for nothing else.
fn total(rows: &Density, steps: &[Density], beside: [&Density; 2]) -> f64 {
    const STRIP: f64 = 1.5;
    let more = beside.map(|chords| STRIP * (chords.total() - rows.total()).max(0.0));
    let counts = steps.iter().map(|steps| (steps.total() + 0.3).max(1.0));
    let row = Density(counts.zip(&rows.0).map(|(count, rows)| 2.0 * count * rows).collect());
    row.total() + more[0] + more[1]
}

//! Iso-lines of bicubic splines: cells are bisected until what they hold is proved.
//!
//! A cell of one sign in its Bezier net holds no line. A cell holds at most one arc, without turns, if the net of a
//! derivative has one sign and the net of no side changes its sign twice (the variation-diminishing property; G. Farin,
//! "Curves and Surfaces for CAGD", 2002, section 5.3). Then the arc is a graph y(x) with
//! `y'' = -(f_xx + 2 f_xy y' + f_yy y'^2) / f_y`, which the nets bound, and so its distance from chords. What is still
//! not decided in cells smaller than the tolerance is settled by the signs of their corners.
//!
//! Where a side is crossed is found by halving it down to one fixed depth, by values of the field alone: cells of any
//! depth on both sides find the same place.

use super::{Pieces, Side, Step, Trace};
use crate::geometry::map::GridField;

type Net = [[f64; 4]; 4];

/// A part of a cell of the field.
#[derive(Clone, Copy)]
struct Leaf {
    net: Net,
    origin: Step,
    size: f64,
    depth: u32,
}

struct Tracer<'f> {
    field: &'f GridField,
    how: &'f Trace,
    /// With a little room below, so that plateaus at the threshold are above it to the last cell.
    threshold: f64,
    /// How far values are off by rounding.
    noise: f64,
    deepest: u32,
    pieces: Pieces,
    points: u64,
}

/// Side length to which crossings are found, as a power of a half.
const FINEST: f64 = 1.0 / (1 << 30) as f64;

pub(super) fn trace(field: &GridField, how: &Trace) -> Result<Pieces, u64> {
    let scale = field.samples().iter().fold(how.threshold.abs(), |most, value| most.max(value.abs()));
    let longest = how.step.max_element() * core::f64::consts::SQRT_2;
    let mut deepest = 1;
    while longest / f64::from(1_u32 << deepest) > how.tolerance / 2.0 && deepest < 24 {
        deepest += 1;
    }
    let threshold = how.threshold - 256.0 * f64::EPSILON * scale;
    let noise = 16.0 * f64::EPSILON * scale;
    let mut tracer = Tracer { field, how, threshold, noise, deepest, pieces: Pieces::default(), points: 0 };
    for j in 0..field.rows() - 1 {
        for i in 0..field.columns() - 1 {
            let Some(net) = field.net(i, j) else { continue };
            let net = net.map(|row| row.map(|value| value - threshold));
            tracer.cell(Leaf { net, origin: [i as f64, j as f64], size: 1.0, depth: 0 })?;
        }
    }
    Ok(tracer.pieces)
}

/// What a leaf holds.
enum Holds {
    Nothing,
    /// One arc, as a graph over this axis, in so many straight pieces.
    Arc {
        over: usize,
        pieces: u32,
    },
    Unknown,
}

impl Tracer<'_> {
    fn cell(&mut self, whole: Leaf) -> Result<(), u64> {
        let mut open = vec![whole];
        while let Some(leaf) = open.pop() {
            self.points += u64::from(leaf.depth > 0);
            if self.points > self.how.limit {
                return Err(self.points);
            }
            match self.holds(&leaf) {
                Holds::Unknown if leaf.depth < self.deepest => open.extend(quarters(&leaf)),
                Holds::Nothing => self.border(&leaf, leaf.net[0][0] > 0.0),
                Holds::Unknown => self.settle(&leaf, None),
                Holds::Arc { over, pieces } => self.settle(&leaf, Some((over, pieces))),
            }
        }
        Ok(())
    }

    fn holds(&self, leaf: &Leaf) -> Holds {
        /// Most straight pieces before a leaf is bisected instead.
        const MOST: f64 = 16.0;
        let net = &leaf.net;
        if self.has_one_sign(net.iter().flatten().copied()) {
            return Holds::Nothing;
        }
        let sides = [net[0], net[3], net.map(|row| row[0]), net.map(|row| row[3])];
        if !sides.iter().all(|side| self.changes_once(side)) {
            return Holds::Unknown;
        }
        let bends = Bends::of(leaf);
        let count = |over: usize| {
            let steepest = bends.least[1 - over];
            if steepest <= 0.0 {
                return f64::INFINITY;
            }
            let slope = bends.most[over] / steepest;
            let second =
                bends.second[over] + 2.0 * bends.mixed * slope + bends.second[1 - over] * slope * slope;
            let away = leaf.size * leaf.size / 8.0 * second / steepest * self.how.step[1 - over];
            (2.0 * away / self.how.tolerance).sqrt().ceil().max(1.0)
        };
        let (over_x, over_y) = (count(0), count(1));
        let (over, pieces) = if over_x <= over_y { (0, over_x) } else { (1, over_y) };
        if pieces > MOST {
            return Holds::Unknown;
        }
        Holds::Arc { over, pieces: crate::geometry::number::floor_count(pieces) }
    }

    /// Whether numbers have one sign, all beyond rounding.
    fn has_one_sign(&self, mut numbers: impl Iterator<Item = f64> + Clone) -> bool {
        numbers.clone().all(|number| number > self.noise) || numbers.all(|number| number < -self.noise)
    }

    fn changes_once(&self, side: &[f64; 4]) -> bool {
        let certain = side.iter().all(|number| number.abs() > self.noise);
        certain && side.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count() <= 1
    }

    fn is_above(&self, place: Step) -> bool {
        self.field.value(place[0], place[1]) >= self.threshold
    }

    /// Sides of a leaf on the border, where all of it is above or below.
    fn border(&mut self, leaf: &Leaf, above: bool) {
        for (side, along) in self.sides_on_border(leaf) {
            if above {
                self.pieces.above(side, leaf.origin[along], leaf.origin[along] + leaf.size);
            }
        }
    }

    fn sides_on_border(&self, leaf: &Leaf) -> impl Iterator<Item = (Side, usize)> + use<> {
        let [right, bottom] = self.field.extent();
        let [x, y] = leaf.origin;
        let on = [y == 0.0, y + leaf.size == bottom, x == 0.0, x + leaf.size == right];
        Side::ALL.into_iter().zip([0, 0, 1, 1]).zip(on).filter(|(_, on)| *on).map(|(side, _)| side)
    }

    /// The arcs of a leaf by the signs of its corners.
    fn settle(&mut self, leaf: &Leaf, graph: Option<(usize, u32)>) {
        let [x, y] = leaf.origin;
        let h = leaf.size;
        let corners = [[x, y], [x + h, y], [x + h, y + h], [x, y + h]];
        let above = corners.map(|corner| self.is_above(corner));
        let crossings: [Option<Step>; 4] = core::array::from_fn(|k| {
            (above[k] != above[(k + 1) % 4]).then(|| self.crossing(corners[k], corners[(k + 1) % 4]))
        });
        let joined = || self.is_above([x + h / 2.0, y + h / 2.0]);
        let entry = |at: &usize| !above[*at % 4] && above[(*at + 1) % 4];
        let mut found = Vec::new();
        for k in 0..4 {
            if !above[k] || above[(k + 1) % 4] {
                continue;
            }
            let to = if joined() { (k + 1..k + 4).find(entry) } else { (k + 1..k + 4).rev().find(entry) };
            if let (Some(from), Some(to)) = (crossings[k], to.and_then(|to| crossings[to % 4])) {
                found.push([from, to]);
            }
        }
        for ends in found {
            let arc = self.arc(leaf, ends, graph);
            self.points += arc.len() as u64;
            self.pieces.arcs.push(arc);
        }
        for (side, along) in self.sides_on_border(leaf) {
            let [from, to] = match side {
                Side::Top => [0, 1],
                Side::Bottom => [3, 2],
                Side::Left => [0, 3],
                Side::Right => [1, 2],
            };
            let cut = match side {
                Side::Top => crossings[0],
                Side::Right => crossings[1],
                Side::Bottom => crossings[2],
                Side::Left => crossings[3],
            };
            let (start, end) = (leaf.origin[along], leaf.origin[along] + h);
            match (above[from], above[to], cut) {
                (true, true, _) => self.pieces.above(side, start, end),
                (true, false, Some(cut)) => self.pieces.above(side, start, cut[along]),
                (false, true, Some(cut)) => self.pieces.above(side, cut[along], end),
                _ => {}
            }
        }
    }

    /// Where the side between two corners on different sides of the line is crossed.
    fn crossing(&self, one: Step, other: Step) -> Step {
        let axis = usize::from(one[0] == other[0]);
        let (mut low, mut high) = if one[axis] < other[axis] { (one, other) } else { (other, one) };
        let low_is_above = self.is_above(low);
        while high[axis] - low[axis] > FINEST {
            let mut middle = low;
            middle[axis] = f64::midpoint(low[axis], high[axis]);
            if self.is_above(middle) == low_is_above {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mut place = low;
        place[axis] = f64::midpoint(low[axis], high[axis]);
        place
    }

    fn arc(&self, leaf: &Leaf, [from, to]: [Step; 2], graph: Option<(usize, u32)>) -> Vec<Step> {
        let mut arc = vec![from];
        if let Some((over, pieces)) = graph {
            let across = 1 - over;
            for k in 1..pieces {
                let part = f64::from(k) / f64::from(pieces);
                let along = from[over] * (1.0 - part) + to[over] * part;
                arc.push(self.on_graph(leaf, over, along, across));
            }
        }
        arc.push(to);
        arc
    }

    /// The place of an arc at a coordinate of the axis over which it is a graph.
    fn on_graph(&self, leaf: &Leaf, over: usize, along: f64, across: usize) -> Step {
        let at = |height: f64| {
            let mut place = [0.0; 2];
            place[over] = along;
            place[across] = height;
            place
        };
        let (mut low, mut high) = (leaf.origin[across], leaf.origin[across] + leaf.size);
        let low_is_above = self.is_above(at(low));
        while high - low > FINEST {
            let middle = f64::midpoint(low, high);
            if self.is_above(at(middle)) == low_is_above {
                low = middle;
            } else {
                high = middle;
            }
        }
        at(f64::midpoint(low, high))
    }
}

/// Bounds on derivatives of a leaf, for each step.
struct Bends {
    /// Least size of the first derivatives by x and y; 0 where the net of one changes its sign.
    least: [f64; 2],
    /// Greatest size of the first derivatives.
    most: [f64; 2],
    second: [f64; 2],
    mixed: f64,
}

impl Bends {
    fn of(leaf: &Leaf) -> Self {
        let by_x = leaf.net;
        let by_y: Net = core::array::from_fn(|i| core::array::from_fn(|j| leaf.net[j][i]));
        let first = |net: &Net| -> Vec<f64> {
            net.iter()
                .flat_map(|row| row.windows(2).map(|pair| 3.0 * (pair[1] - pair[0]) / leaf.size))
                .collect()
        };
        let least = |numbers: &[f64]| {
            let one_sign =
                numbers.iter().all(|number| *number > 0.0) || numbers.iter().all(|number| *number < 0.0);
            if one_sign {
                numbers.iter().fold(f64::INFINITY, |least, number| least.min(number.abs()))
            } else {
                0.0
            }
        };
        let most = |numbers: &[f64]| numbers.iter().fold(0.0_f64, |most, number| most.max(number.abs()));
        let second = |net: &Net| {
            let all = net.iter().flat_map(|row| row.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()));
            6.0 * all.fold(0.0, f64::max) / (leaf.size * leaf.size)
        };
        let mixed = by_x.windows(2).flat_map(|rows| {
            let (one, other) = (rows[0], rows[1]);
            (0..3).map(move |k| (one[k] - one[k + 1] - other[k] + other[k + 1]).abs())
        });
        let (x, y) = (first(&by_x), first(&by_y));
        Self {
            least: [least(&x), least(&y)],
            most: [most(&x), most(&y)],
            second: [second(&by_x), second(&by_y)],
            mixed: 9.0 * mixed.fold(0.0, f64::max) / (leaf.size * leaf.size),
        }
    }
}

/// A leaf cut in half along both axes.
fn quarters(leaf: &Leaf) -> [Leaf; 4] {
    let halves = |net: &Net| {
        let cut = net.map(|row| halved(&row));
        [cut.map(|(near, _)| near), cut.map(|(_, far)| far)]
    };
    let turned = |net: &Net| -> Net { core::array::from_fn(|i| core::array::from_fn(|j| net[j][i])) };
    let [top, bottom] = halves(&turned(&leaf.net)).map(|net| turned(&net));
    let size = leaf.size / 2.0;
    let [x, y] = leaf.origin;
    let quarter = |net: Net, origin: Step| Leaf { net, origin, size, depth: leaf.depth + 1 };
    let ([a, b], [c, d]) = (halves(&top), halves(&bottom));
    [
        quarter(a, [x, y]),
        quarter(b, [x + size, y]),
        quarter(c, [x, y + size]),
        quarter(d, [x + size, y + size]),
    ]
}

/// Both halves of a cubic (P. de Casteljau).
fn halved([a, b, c, d]: &[f64; 4]) -> ([f64; 4], [f64; 4]) {
    let (ab, bc, cd) = (f64::midpoint(*a, *b), f64::midpoint(*b, *c), f64::midpoint(*c, *d));
    let (abc, bcd) = (f64::midpoint(ab, bc), f64::midpoint(bc, cd));
    let middle = f64::midpoint(abc, bcd);
    ([*a, ab, abc, middle], [middle, bcd, cd, *d])
}

//! How far a triangle is from the function that is bilinear between the nodes of a lattice.
//!
//! Inside a cell the difference of that function and a plane is a saddle, so over the part of a triangle in a cell it is
//! greatest on that part's boundary: at a node, or on an edge of the triangle, along which it is a parabola in each cell.
//! So the nodes inside and the exact greatest along three edges prove the greatest everywhere.

use super::delaunay::{Place, turn};
use super::ground::{Ground, Value};
use super::lattice::Lattice;

/// The greatest distance found and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub(super) error: f64,
    pub(super) place: [f64; 2],
}

impl Worst {
    pub(super) const NONE: Self = Self { error: 0.0, place: [0.0; 2] };
}

/// A corner of a triangle and what stands there.
pub(super) type Corner<V = f64> = (Place, V);

/// The greatest error at the nodes in a triangle, those of the lattice's border left out. The place is in units.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "counts of nodes fit 29 bits"
)]
pub(super) fn nodes<G: Ground>(lattice: &Lattice<'_, G>, corners: [Corner<G::Value>; 3]) -> Worst {
    let units = i64::from(lattice.units);
    let plane = Plane::of(corners, units as f64);
    let mut sorted = corners.map(|(place, _)| place.map(i64::from));
    sorted.sort_by_key(|place| place[1]);
    let [low, middle, high] = sorted;
    // A counter-clockwise triangle has its middle corner to the right of the long edge when that turns left.
    let left_is_long = turn(sorted_place(low), sorted_place(high), sorted_place(middle)) < 0;
    let first = up(low[1], units).max(1);
    let last = high[1].div_euclid(units).min(lattice.rows as i64 - 2);
    let mut worst = (0.0, 0, 0);
    for row in first..=last {
        let y = row * units;
        let short = if y < middle[1] || high[1] == middle[1] { (low, middle) } else { (middle, high) };
        let (left, right) = if left_is_long { ((low, high), short) } else { (short, (low, high)) };
        let from = crossing_up(left, y, units).max(1);
        let to = crossing_down(right, y, units).min(lattice.columns as i64 - 2);
        if from > to {
            continue;
        }
        let start = row as usize * lattice.columns;
        let values = &lattice.values[start + from as usize..=start + to as usize];
        let base = plane.at(from as f64, row as f64);
        let most = G::Value::greatest(values, base, plane.across);
        if most > worst.0 {
            let at = position(values, base, plane.across, most);
            worst = (most, from + at as i64, row);
        }
    }
    Worst { error: worst.0, place: [(worst.1 * units) as f64, (worst.2 * units) as f64] }
}

#[expect(clippy::cast_possible_truncation, reason = "places are 32-bit; they were only widened")]
fn sorted_place(place: [i64; 2]) -> Place {
    place.map(|part| part as i32)
}

/// The plane of a triangle over nodes.
struct Plane<V> {
    origin: [f64; 2],
    height: V,
    across: V,
    along: V,
}

impl<V: Value> Plane<V> {
    fn of(corners: [Corner<V>; 3], units: f64) -> Self {
        let [a, b, c] = corners.map(|(place, _)| place.map(|part| f64::from(part) / units));
        let [za, zb, zc] = corners.map(|(_, height)| height);
        let (ab, ac) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let twice = ab[0] * ac[1] - ab[1] * ac[0];
        Self {
            origin: a,
            height: za,
            across: ((zb - za) * ac[1] - (zc - za) * ab[1]) / twice,
            along: ((zc - za) * ab[0] - (zb - za) * ac[0]) / twice,
        }
    }

    fn at(&self, x: f64, y: f64) -> V {
        self.height + self.across * (x - self.origin[0]) + self.along * (y - self.origin[1])
    }
}

fn up(coordinate: i64, units: i64) -> i64 {
    -(-coordinate).div_euclid(units)
}

/// The first node at or after a line between two places at height y. Dividing once is enough: floor of a quotient of
/// quotients is the floor of the whole.
fn crossing_up((from, to): ([i64; 2], [i64; 2]), y: i64, units: i64) -> i64 {
    -(-numerator(from, to, y)).div_euclid(denominator(from, to) * units)
}

fn crossing_down((from, to): ([i64; 2], [i64; 2]), y: i64, units: i64) -> i64 {
    numerator(from, to, y).div_euclid(denominator(from, to) * units)
}

fn denominator(from: [i64; 2], to: [i64; 2]) -> i64 {
    (to[1] - from[1]).max(1)
}

fn numerator(from: [i64; 2], to: [i64; 2], y: i64) -> i64 {
    from[0] * denominator(from, to) + (to[0] - from[0]) * (y - from[1])
}

/// Where [`Value::greatest`] found its value.
fn position<V: Value>(values: &[V], base: V, slope: V, most: f64) -> usize {
    let reached = most * (1.0 - V::LOSS);
    values
        .iter()
        .enumerate()
        .position(|(k, value)| (*value - (base + slope * k as f64)).size() >= reached)
        .unwrap_or(0)
}

/// The greatest error along an edge, as exact as [`Value::crest`]. The place is in units.
pub(super) fn edge<G: Ground>(
    lattice: &Lattice<'_, G>,
    (from, start): Corner<G::Value>,
    (to, end): Corner<G::Value>,
) -> Worst {
    let units = f64::from(lattice.units);
    let a = from.map(|part| f64::from(part) / units);
    let b = to.map(|part| f64::from(part) / units);
    let way = [b[0] - a[0], b[1] - a[1]];
    let mut stops = [Stops::new(a[0], b[0]), Stops::new(a[1], b[1])];
    let mut worst = (0.0, 0.0);
    let mut note = |error: f64, part: f64| {
        if error > worst.0 {
            worst = (error, part);
        }
    };
    let line = |part: f64| start + (end - start) * part;
    let mut before = 0.0;
    while before < 1.0 {
        let after = stops[0].part.min(stops[1].part).min(1.0);
        stops.iter_mut().for_each(|stop| stop.pass(after));
        if after <= before {
            continue;
        }
        let at = |part: f64| [a[0] + way[0] * part, a[1] + way[1] * part];
        let middle = at(f64::midpoint(before, after));
        let cell = Cell::of(lattice, middle);
        let gap = |part: f64| cell.value(at(part)) - line(part);
        let (near, far) = (gap(before), gap(after));
        note(near.size(), before);
        note(far.size(), after);
        let length = after - before;
        let bend = cell.twist * way[0] * way[1] * length * length;
        if let Some((most, t)) = G::Value::crest(near, far, bend) {
            note(most, before + length * t);
        }
        before = after;
    }
    Worst { error: worst.0, place: [0, 1].map(|k| units * (a[k] + way[k] * worst.1)) }
}

/// Where an edge crosses the lines of the lattice along one axis, as parts of the edge.
struct Stops {
    from: f64,
    way: f64,
    line: f64,
    step: f64,
    part: f64,
}

impl Stops {
    fn new(from: f64, to: f64) -> Self {
        let way = to - from;
        let step = if way > 0.0 { 1.0 } else { -1.0 };
        let line = if way > 0.0 { from.floor() + 1.0 } else { from.ceil() - 1.0 };
        let part = if way == 0.0 { f64::INFINITY } else { (line - from) / way };
        Self { from, way, line, step, part }
    }

    fn pass(&mut self, part: f64) {
        if self.part <= part {
            self.line += self.step;
            self.part = (self.line - self.from) / self.way;
        }
    }
}

/// A cell of the lattice.
struct Cell<V> {
    origin: [f64; 2],
    values: [V; 4],
    twist: V,
}

impl<V: Value> Cell<V> {
    fn of<G: Ground<Value = V>>(lattice: &Lattice<'_, G>, place: [f64; 2]) -> Self {
        let index = |part: f64, count: usize| crate::geometry::number::floor_index(part).min(count - 2);
        let (i, j) = (index(place[0], lattice.columns), index(place[1], lattice.rows));
        let at = j * lattice.columns + i;
        let values =
            [at, at + 1, at + lattice.columns, at + lattice.columns + 1].map(|at| lattice.values[at]);
        let twist = values[0] - values[1] - values[2] + values[3];
        Self { origin: [i as f64, j as f64], values, twist }
    }

    fn value(&self, place: [f64; 2]) -> V {
        let (s, t) = (place[0] - self.origin[0], place[1] - self.origin[1]);
        let [a, b, c, d] = self.values;
        (a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t
    }
}

//! Gradient noise with derivatives, and bounds on it over boxes.
//!
//! Inside one cell of the lattice noise is a polynomial, so that derivatives and bounds of one cell follow
//! from its formula. Over a few cells the bounds of each are put together; over many the greatest that noise
//! can do is taken.

use super::algebra::{Algebra, minus, plus, times};
use super::interval::Interval;
use crate::geometry::number::{floor_index, noise_gradient};

/// Bounds on noise everywhere: on its size, on its first derivatives and on its second derivatives.
///
/// With unit gradients and the quintic fade (slope at most 1.875, bend at most 5.7736) the noise without its
/// factor root 2 is a mix of four numbers of size root 2 at most, so that its slope is at most
/// 1 + 2 root 2 1.875 and its bends are at most 4 1.875 + 2 root 2 5.7736 and 4 1.875 + 4 root 2 1.875^2.
const GREATEST: [f64; 3] = [1.0, 8.92, 38.74];

/// Cells in each direction over which bounds are put together one by one.
const FEW: usize = 4;

/// One cell of the lattice seen from a place in it.
struct Cell<T> {
    /// Place in the cell, 0 to 1.
    place: [T; 2],
    /// Gradients at (0, 0), (1, 0), (0, 1), (1, 1).
    gradients: [(f64, f64); 4],
}

/// Value and derivatives of a cell: by x, y, xx, xy, yy.
struct Bumps<T> {
    value: T,
    slopes: [T; 5],
}

fn scaled<T: Algebra>(factor: f64, x: T) -> T {
    times(T::constant(factor), x)
}

/// The quintic fade 6 t^5 - 15 t^4 + 10 t^3 with its two derivatives.
fn fade<T: Algebra>(t: T) -> [T; 3] {
    let rest = minus(T::constant(1.0), t);
    let inner = plus(times(t, minus(scaled(6.0, t), T::constant(15.0))), T::constant(10.0));
    let both = T::power(times(t, rest), 2.0);
    let bend = scaled(60.0, times(times(t, rest), minus(T::constant(1.0), scaled(2.0, t))));
    [times(T::power(t, 3.0), inner), scaled(30.0, both), bend]
}

impl<T: Cells> Cell<T> {
    fn new(seed: f64, corner: [f64; 2], place: [T; 2]) -> Self {
        let at = |dx: f64, dy: f64| noise_gradient(seed, corner[0] + dx, corner[1] + dy);
        Self { place, gradients: [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)] }
    }

    /// Noise is a + (b - a) s + (c - a) t + (a - b - c + d) s t with the ramps a to d of the four gradients and
    /// the fades s and t of the two coordinates.
    fn bumps(&self) -> Bumps<T> {
        let [u, v] = self.place;
        let ramp = |index: usize, du: f64, dv: f64| {
            let (gx, gy) = self.gradients[index];
            plus(scaled(gx, minus(u, T::constant(du))), scaled(gy, minus(v, T::constant(dv))))
        };
        let ramps = [ramp(0, 0.0, 0.0), ramp(1, 1.0, 0.0), ramp(2, 0.0, 1.0), ramp(3, 1.0, 1.0)];
        let by = |part: fn((f64, f64)) -> f64| self.gradients.map(|gradient| T::constant(part(gradient)));
        let (by_x, by_y) = (by(|gradient| gradient.0), by(|gradient| gradient.1));
        let (s, t) = (T::fades(u), T::fades(v));
        let corner = |ramps: &[T; 4]| {
            let across = minus(ramps[1], ramps[0]);
            let along = minus(ramps[2], ramps[0]);
            [ramps[0], across, along, minus(minus(ramps[3], ramps[2]), across)]
        };
        let mixed = |parts: &[T; 4]| {
            plus(
                plus(parts[0], times(parts[1], s[0])),
                plus(times(parts[2], t[0]), times(parts[3], times(s[0], t[0]))),
            )
        };
        let (own, dx, dy) = (corner(&ramps), corner(&by_x), corner(&by_y));
        // What the fade of x does to a set of ramps, and what the fade of y does.
        let by_s = |parts: &[T; 4]| plus(parts[1], times(parts[3], t[0]));
        let by_t = |parts: &[T; 4]| plus(parts[2], times(parts[3], s[0]));
        let root = T::rounded(core::f64::consts::SQRT_2);
        let double = T::constant(2.0);
        let slopes = [
            plus(mixed(&dx), times(s[1], by_s(&own))),
            plus(mixed(&dy), times(t[1], by_t(&own))),
            plus(times(double, times(s[1], by_s(&dx))), times(s[2], by_s(&own))),
            plus(plus(times(t[1], by_t(&dx)), times(s[1], by_s(&dy))), times(times(s[1], t[1]), own[3])),
            plus(times(double, times(t[1], by_t(&dy))), times(t[2], by_t(&own))),
        ];
        Bumps { value: times(root, mixed(&own)), slopes: slopes.map(|slope| times(root, slope)) }
    }
}

/// Numbers that know the cells they lie in.
pub trait Cells: Algebra {
    /// The first derivatives of noise by x and y, then the second ones: xx, xy, yy.
    fn slopes(seed: f64, x: Self, y: Self) -> [Self; 5];

    /// The quintic fade of a place in a cell, 0 to 1, with its two derivatives.
    fn fades(t: Self) -> [Self; 3] {
        fade(t)
    }
}

impl Cells for f64 {
    fn slopes(seed: f64, x: Self, y: Self) -> [Self; 5] {
        let corner = [x.floor(), y.floor()];
        Cell::new(seed, corner, [x - corner[0], y - corner[1]]).bumps().slopes
    }
}

impl Cells for Interval {
    fn slopes(seed: f64, x: Self, y: Self) -> [Self; 5] {
        let [_, slope, bend] = GREATEST;
        let quality = x.quality.min(y.quality);
        let greatest = [slope, slope, bend, bend, bend];
        let bounds = over_cells(seed, x, y, |cell| {
            let (bumps, middle) = (cell.bumps(), cell.middle().bumps());
            let [by_x, by_y, xx, xy, yy] = bumps.slopes;
            let near = |own: Self, middle: f64, steepness: [Self; 2]| cell.near(own, middle, steepness);
            [near(by_x, middle.slopes[0], [xx, xy]), near(by_y, middle.slopes[1], [xy, yy]), xx, xy, yy]
        });
        bounds
            .unwrap_or_else(|| greatest.map(|size| Self::new(-size, size)))
            .map(|bound| bound.at_best(quality))
    }

    /// The fade grows, its slope rises to the middle and falls behind it, and its bend has its greatest sizes at
    /// (3 +- root 3) / 6: so each is bounded by its values at the ends and there.
    fn fades(t: Self) -> [Self; 3] {
        const TURNS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];
        let over = |index: usize, turns: &[f64]| {
            let ends = [t.low, t.high].into_iter();
            let all = ends.chain(turns.iter().copied().filter(|turn| t.contains(*turn)));
            let values = all.map(|place| fade(place)[index]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            Self::new(low - ROUNDING, high + ROUNDING).at_best(t.quality)
        };
        [over(0, &[]), over(1, &[0.5]), over(2, &TURNS)]
    }
}

/// More than rounding does to a fade, to its derivatives, or to the value and the slope of noise at one place.
const ROUNDING: f64 = 1e-13;

impl Cell<Interval> {
    /// The same cell seen from the middle of the box.
    fn middle(&self) -> Cell<f64> {
        Cell { place: self.place.map(|side| f64::midpoint(side.low, side.high)), gradients: self.gradients }
    }

    /// A bound on a number by its value in the middle and its derivatives, where that is better than its own: it closes in
    /// with the square of the size of the box.
    fn near(&self, own: Interval, middle: f64, steepness: [Interval; 2]) -> Interval {
        let half = self.place.map(|side| {
            let half = (side.high - side.low) / 2.0 + ROUNDING;
            Interval::new(-half, half)
        });
        let around = Interval::new(middle - ROUNDING, middle + ROUNDING);
        let mean = plus(around, plus(times(steepness[0], half[0]), times(steepness[1], half[1])));
        Interval::new(own.low.max(mean.low), own.high.min(mean.high))
    }
}

/// Bounds on noise over a box.
pub(super) fn noise_over(seed: f64, x: Interval, y: Interval) -> Interval {
    let quality = x.quality.min(y.quality);
    let bounds = over_cells(seed, x, y, |cell| {
        let bumps = cell.bumps();
        [cell.near(bumps.value, cell.middle().bumps().value, [bumps.slopes[0], bumps.slopes[1]])]
    });
    let [bound] = bounds.unwrap_or([Interval::new(-GREATEST[0], GREATEST[0])]);
    bound.at_best(quality)
}

/// Bounds put together from each cell that a box meets, where these are few.
fn over_cells<const M: usize>(
    seed: f64,
    x: Interval,
    y: Interval,
    bounds: impl Fn(&Cell<Interval>) -> [Interval; M],
) -> Option<[Interval; M]> {
    let cells = |side: Interval| {
        let (first, last) = (side.low.floor(), side.high.floor());
        let count = last - first + 1.0;
        (count <= FEW as f64).then(|| (first, floor_index(count)))
    };
    let ((left, columns), (bottom, rows)) = (cells(x)?, cells(y)?);
    let part = |side: Interval, cell: f64| {
        let (low, high) = ((side.low - cell).max(0.0), (side.high - cell).min(1.0));
        Interval::new(low.next_down().max(0.0), high.next_up().min(1.0))
    };
    let mut all: Option<[Interval; M]> = None;
    for column in 0..columns {
        for row in 0..rows {
            let corner = [left + column as f64, bottom + row as f64];
            let cell = Cell::new(seed, corner, [part(x, corner[0]), part(y, corner[1])]);
            let found = bounds(&cell);
            all = Some(match all {
                None => found,
                Some(before) => core::array::from_fn(|index| before[index].hull(found[index])),
            });
        }
    }
    all
}

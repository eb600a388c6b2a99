//! Area, volume and their first and second moments, summed over triangles.
//!
//! Source: the closed integrals of polynomials over a tetrahedron with one corner at the origin and over a triangle,
//! for example B. Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties", 1996. With s = a + b + c:
//! over the tetrahedron 0abc of six-fold volume d the integrals of 1, x and x x^T are d / 6, d s / 24 and
//! d (aa^T + bb^T + cc^T + ss^T) / 120; over the triangle of area A they are A, A s / 3 and A (...) / 12.

use glam::{DVec2, DVec3};
use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::ParallelSlice;

use super::{Box3, Corner, Mass, ONE_THREAD, Position};

/// Triangles summed one after another; blocks are added pairwise.
const BLOCK: usize = 1024;

/// Integrals of 1, x, y, z, and the second moments xx, yy, zz, yz, zx, xy.
type Integrals = [f64; 10];

/// Integrals about the center of the box.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    center: DVec3,
    /// Over the inside, times 6, 24 and 120.
    solid: Integrals,
    /// Over the surface, times 2, 6 and 24; only the first until [`add_surface`](Self::add_surface).
    surface: Integrals,
    /// Triangles of no area.
    pub(super) degenerate: u64,
}

/// What a block of triangles adds up to.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    integrals: Integrals,
    double_area: f64,
    degenerate: u64,
}

impl Block {
    fn plus(mut self, other: Self) -> Self {
        self.integrals.iter_mut().zip(other.integrals).for_each(|(sum, value)| *sum += value);
        self.double_area += other.double_area;
        self.degenerate += other.degenerate;
        self
    }
}

/// One coordinate in each of two blocks: processors do arithmetic on two doubles at the price of one. Sums of a
/// block do not depend on the block beside it.
type Pair = DVec2;

/// A vector in each of two blocks.
type Vectors = [Pair; 3];

/// The triangles to sum over, about a center.
struct Triangles<'a, P, I> {
    positions: &'a [P],
    indices: &'a [I],
    center: DVec3,
    mass: Mass,
}

impl<P: Position, I: Corner> Triangles<'_, P, I> {
    /// Blocks added pairwise: the result does not depend on the number of threads.
    fn sum(&self) -> Block {
        let mut blocks: Vec<Block> = if self.indices.len() < 3 * ONE_THREAD {
            self.indices.chunks(6 * BLOCK).flat_map(|both| self.two_blocks(both)).collect()
        } else {
            let pairs = self.indices.par_chunks(6 * BLOCK).with_min_len(8);
            pairs.flat_map_iter(|both| self.two_blocks(both)).collect()
        };
        while blocks.len() > 1 {
            let add = |pair: &[Block]| pair.iter().copied().reduce(Block::plus).unwrap_or_default();
            blocks = blocks.chunks(2).map(add).collect();
        }
        blocks.pop().unwrap_or_default()
    }

    /// Two blocks, or at the end what is left of them.
    fn two_blocks(&self, both: &[I]) -> impl Iterator<Item = Block> + use<P, I> {
        let (first, second) = both.split_at(both.len().min(3 * BLOCK));
        let (first, second) = if first.len() == second.len() {
            let [first, second] = self.blocks(first, second);
            (first, Some(second))
        } else {
            let alone = |block: &[I]| self.blocks(block, block)[0];
            (alone(first), (!second.is_empty()).then(|| alone(second)))
        };
        std::iter::once(first).chain(second)
    }

    /// Two blocks of the same length.
    fn blocks(&self, first: &[I], second: &[I]) -> [Block; 2] {
        let mut sums = [Pair::ZERO; 10];
        let mut double_areas = Pair::ZERO;
        let mut degenerate = [0_u64; 2];
        for (one, other) in first.as_chunks::<3>().0.iter().zip(second.as_chunks::<3>().0) {
            let (a, b, c) =
                (self.arms(one[0], other[0]), self.arms(one[1], other[1]), self.arms(one[2], other[2]));
            let normal = cross(minus(b, a), minus(c, a));
            let square = dot(normal, normal);
            let length = Pair::new(square.x.sqrt(), square.y.sqrt());
            double_areas += length;
            degenerate[0] += u64::from(normal[0].x == 0.0 && normal[1].x == 0.0 && normal[2].x == 0.0);
            degenerate[1] += u64::from(normal[0].y == 0.0 && normal[1].y == 0.0 && normal[2].y == 0.0);
            let factor = match self.mass {
                Mass::Solid => dot(a, normal),
                Mass::Surface => length,
            };
            add_scaled(&mut sums, factor, [a, b, c]);
        }
        [0, 1].map(|lane| Block {
            integrals: sums.map(|sum| sum[lane]),
            double_area: double_areas[lane],
            degenerate: degenerate[lane],
        })
    }

    /// From the center to a corner in each block.
    #[inline]
    fn arms(&self, one: I, other: I) -> Vectors {
        let one = self.positions[one.vertex() as usize].coordinates();
        let other = self.positions[other.vertex() as usize].coordinates();
        let pair = |axis: usize| Pair::new(one[axis].into(), other[axis].into());
        [pair(0) - self.center.x, pair(1) - self.center.y, pair(2) - self.center.z]
    }
}

/// Adds the integrals of 1 and the first and second moments over a triangle, times a factor.
#[inline]
fn add_scaled(sums: &mut [Pair; 10], factor: Pair, [a, b, c]: [Vectors; 3]) {
    let s = plus(plus(a, b), c);
    let squares = plus(plus(plus(times(a, a), times(b, b)), times(c, c)), times(s, s));
    let mixed = plus(plus(plus(turned(a), turned(b)), turned(c)), turned(s));
    sums[0] += factor;
    for axis in 0..3 {
        sums[1 + axis] += factor * s[axis];
        sums[4 + axis] += factor * squares[axis];
        sums[7 + axis] += factor * mixed[axis];
    }
}

#[inline]
fn plus(a: Vectors, b: Vectors) -> Vectors {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
fn minus(a: Vectors, b: Vectors) -> Vectors {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn times(a: Vectors, b: Vectors) -> Vectors {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline]
fn dot(a: Vectors, b: Vectors) -> Pair {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn cross(a: Vectors, b: Vectors) -> Vectors {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

/// The products yz, zx, xy.
#[inline]
fn turned(v: Vectors) -> Vectors {
    [v[1] * v[2], v[2] * v[0], v[0] * v[1]]
}

impl Moments {
    /// Sums over all triangles; indices must be in range.
    pub(super) fn of<P: Position, I: Corner>(positions: &[P], indices: &[I], bounds: Option<&Box3>) -> Self {
        let Some(bounds) = bounds else { return Self::default() };
        let vector = |position: [f32; 3]| DVec3::from_array(position.map(f64::from));
        let center = (vector(bounds.min) + vector(bounds.max)) * 0.5;
        let block = Triangles { positions, indices, center, mass: Mass::Solid }.sum();
        let mut surface = Integrals::default();
        surface[0] = block.double_area;
        Self { center, solid: block.integrals, surface, degenerate: block.degenerate }
    }

    /// Sums the moments of the surface, which only meshes without an inside need.
    pub(super) fn add_surface<P: Position, I: Corner>(&mut self, positions: &[P], indices: &[I]) {
        let center = self.center;
        self.surface = Triangles { positions, indices, center, mass: Mass::Surface }.sum().integrals;
    }

    /// Cubic metres inside.
    pub(super) fn volume(&self) -> f64 {
        self.solid[0] / 6.0
    }

    /// Square metres.
    pub(super) fn area(&self) -> f64 {
        self.surface[0] / 2.0
    }

    /// The integrals of 1, the position about the center, and the two halves of the second moments.
    fn integrals(&self, mass: Mass) -> (f64, DVec3, DVec3, DVec3) {
        let (sums, [zeroth, first, second]) = match mass {
            Mass::Solid => (&self.solid, [6.0, 24.0, 120.0]),
            Mass::Surface => (&self.surface, [2.0, 6.0, 24.0]),
        };
        let at = |place: usize| DVec3::new(sums[place], sums[place + 1], sums[place + 2]);
        (sums[0] / zeroth, at(1) / first, at(4) / second, at(7) / second)
    }

    /// Center of mass.
    pub(super) fn centroid(&self, mass: Mass) -> Option<[f64; 3]> {
        let (total, first, ..) = self.integrals(mass);
        (total != 0.0).then(|| (self.center + first / total).to_array())
    }

    /// Inertia tensor about the center of mass, density 1.
    pub(super) fn inertia(&self, mass: Mass) -> Option<[[f64; 3]; 3]> {
        let (total, first, squares, mixed) = self.integrals(mass);
        if total == 0.0 {
            return None;
        }
        let arm = first / total;
        let squares = squares - first * arm;
        let mixed = mixed - DVec3::new(first.y * arm.z, first.z * arm.x, first.x * arm.y);
        let (x, y, z) = (squares.x, squares.y, squares.z);
        Some([[y + z, -mixed.z, -mixed.y], [-mixed.z, z + x, -mixed.x], [-mixed.y, -mixed.x, x + y]])
    }
}

//! Area, volume and their first and second moments, summed over triangles.
//!
//! Source: the closed integrals of polynomials over a tetrahedron with one corner at the origin and over a triangle,
//! for example B. Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties", 1996. With s = a + b + c:
//! over the tetrahedron 0abc of six-fold volume d the integrals of 1, x and x x^T are d / 6, d s / 24 and
//! d (aa^T + bb^T + cc^T + ss^T) / 120; over the triangle of area A they are A, A s / 3 and A (...) / 12.

use glam::DVec3;
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
    /// Over the surface, times 2, 6 and 24; only the first unless [`add_surface`](Self::add_surface) is called.
    surface: Integrals,
    /// Triangles of no area.
    pub(super) degenerate: u64,
}

/// Sums that blocks add up to.
trait Sum: Copy + Default + Send {
    fn add(&mut self, corners: [DVec3; 3]);
    fn plus(self, other: Self) -> Self;
}

/// What every mesh needs.
#[derive(Clone, Copy, Default)]
struct Inside {
    integrals: Integrals,
    double_area: f64,
    degenerate: u64,
}

impl Sum for Inside {
    #[inline]
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        let normal = (b - a).cross(c - a);
        self.double_area += normal.length();
        self.degenerate += u64::from(normal == DVec3::ZERO);
        add_scaled(&mut self.integrals, a.dot(normal), [a, b, c]);
    }

    fn plus(self, other: Self) -> Self {
        Self {
            integrals: sum(self.integrals, other.integrals),
            double_area: self.double_area + other.double_area,
            degenerate: self.degenerate + other.degenerate,
        }
    }
}

/// What meshes without an inside need.
#[derive(Clone, Copy, Default)]
struct Surface(Integrals);

impl Sum for Surface {
    #[inline]
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        add_scaled(&mut self.0, (b - a).cross(c - a).length(), [a, b, c]);
    }

    fn plus(self, other: Self) -> Self {
        Self(sum(self.0, other.0))
    }
}

#[inline]
fn add_scaled(integrals: &mut Integrals, factor: f64, [a, b, c]: [DVec3; 3]) {
    let s = a + b + c;
    let squares = a * a + b * b + c * c + s * s;
    let mixed = turned(a) + turned(b) + turned(c) + turned(s);
    let shape = [1.0, s.x, s.y, s.z, squares.x, squares.y, squares.z, mixed.x, mixed.y, mixed.z];
    for (integral, value) in integrals.iter_mut().zip(shape) {
        *integral += factor * value;
    }
}

fn sum(mut one: Integrals, other: Integrals) -> Integrals {
    one.iter_mut().zip(other).for_each(|(one, other)| *one += other);
    one
}

/// Sums over all triangles, block by block; indices must be in range.
fn summed<S: Sum, P: Position, I: Corner>(positions: &[P], indices: &[I], center: DVec3) -> S {
    let arm = |corner: &I| {
        let position = positions[corner.vertex() as usize].coordinates();
        DVec3::from_array(position.map(f64::from)) - center
    };
    let block = |block: &[I]| {
        let mut sum = S::default();
        for [a, b, c] in block.as_chunks().0 {
            sum.add([arm(a), arm(b), arm(c)]);
        }
        sum
    };
    let mut blocks: Vec<S> = if indices.len() < 3 * ONE_THREAD {
        indices.chunks(3 * BLOCK).map(block).collect()
    } else {
        indices.par_chunks(3 * BLOCK).with_min_len(8).map(block).collect()
    };
    while blocks.len() > 1 {
        blocks =
            blocks.chunks(2).map(|pair| pair.iter().copied().reduce(S::plus).unwrap_or_default()).collect();
    }
    blocks.pop().unwrap_or_default()
}

impl Moments {
    /// Sums over all triangles; indices must be in range.
    pub(super) fn of<P: Position, I: Corner>(positions: &[P], indices: &[I], bounds: Option<&Box3>) -> Self {
        let Some(bounds) = bounds else { return Self::default() };
        let vector = |position: [f32; 3]| DVec3::from_array(position.map(f64::from));
        let center = (vector(bounds.min) + vector(bounds.max)) * 0.5;
        let Inside { integrals, double_area, degenerate } = summed(positions, indices, center);
        let mut surface = Integrals::default();
        surface[0] = double_area;
        Self { center, solid: integrals, surface, degenerate }
    }

    /// Sums the moments of the surface too.
    pub(super) fn add_surface<P: Position, I: Corner>(&mut self, positions: &[P], indices: &[I]) {
        let Surface(integrals) = summed(positions, indices, self.center);
        self.surface = integrals;
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

/// The products yz, zx, xy.
fn turned(v: DVec3) -> DVec3 {
    DVec3::new(v.y * v.z, v.z * v.x, v.x * v.y)
}

//! Area, volume and their first and second moments, summed over triangles.
//!
//! Source: the closed integrals of polynomials over a tetrahedron with one corner at the origin and over a triangle,
//! for example B. Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties", 1996. With s = a + b + c:
//! over the tetrahedron 0abc of six-fold volume d the integrals of 1, x and x x^T are d / 6, d s / 24 and
//! d (aa^T + bb^T + cc^T + ss^T) / 120; over the triangle of area A they are A, A s / 3 and A (...) / 12.

use glam::DVec3;
use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::ParallelSlice;

use super::{Box3, Mass};

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
    /// Over the surface, times 2, 6 and 24.
    surface: Integrals,
    /// Triangles of no area.
    pub(super) degenerate: u64,
}

impl Moments {
    /// Sums over all triangles; indices must be in range.
    pub(super) fn of(positions: &[[f32; 3]], indices: &[u32], bounds: Option<&Box3>) -> Self {
        let Some(bounds) = bounds else { return Self::default() };
        let vector = |position: [f32; 3]| DVec3::from_array(position.map(f64::from));
        let center = (vector(bounds.min) + vector(bounds.max)) * 0.5;
        let block = |block: &[u32]| {
            let mut sum = Self::default();
            for corners in block.chunks_exact(3) {
                let arm = |corner: usize| vector(positions[corners[corner] as usize]) - center;
                sum.add_triangle(arm(0), arm(1), arm(2));
            }
            sum
        };
        let mut blocks: Vec<Self> = indices.par_chunks(3 * BLOCK).with_min_len(8).map(block).collect();
        while blocks.len() > 1 {
            blocks = blocks
                .chunks(2)
                .map(|pair| pair.iter().copied().reduce(Self::plus).unwrap_or_default())
                .collect();
        }
        Self { center, ..blocks.pop().unwrap_or_default() }
    }

    fn add_triangle(&mut self, a: DVec3, b: DVec3, c: DVec3) {
        let normal = (b - a).cross(c - a);
        let double_area = normal.length();
        let determinant = a.dot(normal);
        self.degenerate += u64::from(normal == DVec3::ZERO);
        let s = a + b + c;
        let squares = a * a + b * b + c * c + s * s;
        let mixed = turned(a) + turned(b) + turned(c) + turned(s);
        let shape = [1.0, s.x, s.y, s.z, squares.x, squares.y, squares.z, mixed.x, mixed.y, mixed.z];
        for (place, value) in shape.into_iter().enumerate() {
            self.solid[place] += determinant * value;
            self.surface[place] += double_area * value;
        }
    }

    fn plus(mut self, other: Self) -> Self {
        for place in 0..self.solid.len() {
            self.solid[place] += other.solid[place];
            self.surface[place] += other.surface[place];
        }
        self.degenerate += other.degenerate;
        self
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

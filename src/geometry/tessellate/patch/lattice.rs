//! A block as a lattice: a given grid whose rims are cut where its own lines end.
//!
//! What a surface costs along its lines is paid once for each line, not once for each place; and the proof takes the
//! cells, not their triangles, one by one.

use glam::DVec3;

use super::judge::{bound, widened};
use super::layout::{Block, Rim};
use super::plan::Plan;
use super::rows::{Corner, Cut, Free, Piece};
use crate::geometry::mesh::index;
use crate::geometry::number::Bounds;
use crate::geometry::surface::{SecondRange, Surface as _, SurfaceJet};
use crate::geometry::tessellate::{Deviation, Evidence};

/// The lines of a block.
pub(super) struct Lattice {
    u: Vec<f64>,
    v: Vec<f64>,
    /// Jets in the middles of the cells, row by row.
    middles: Vec<SurfaceJet>,
}

/// Fractions that differ by no more than this are the same: those of an edge that runs backward are differences from 1.
const SAME: f64 = 1e-12;

/// A diagonal must be nearer to the surface than the other by this share of their lengths to be taken instead.
const BETTER: f64 = 1e-9;

/// Rows of cells whose ranges are asked for at once.
const ROWS: usize = 16;

impl Lattice {
    /// The lattice of a block with the plan of a grid; none where a rim is a pole, or is cut otherwise.
    pub(super) fn new(block: &Block<'_>, plan: &Plan, rims: &[Cut; 4]) -> Option<Self> {
        let across = plan.along(Rim::Bottom).stations(1);
        let up = plan.along(Rim::Left).stations(1);
        let fits = |(rim, cut): (&Rim, &Cut)| {
            let lines = if rim.along_u() { &across } else { &up };
            cut.points.len() == lines.len()
                && cut.fractions.iter().zip(lines).all(|(a, b)| (a - b).abs() <= SAME)
        };
        if !Rim::ALL.iter().zip(rims).all(fits) {
            return None;
        }
        let u: Vec<f64> = across.iter().map(|part| block.at((*part, 0.0)).0).collect();
        let v: Vec<f64> = up.iter().map(|part| block.at((0.0, *part)).1).collect();
        let halves = |lines: &[f64]| -> Vec<f64> {
            lines.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
        };
        let middles = block.lattice(&halves(&u), &halves(&v));
        Some(Self { u, v, middles })
    }

    /// Number of the corner where two lines cross.
    fn corner(&self, column: usize, row: usize) -> u32 {
        index(row * self.u.len() + column)
    }

    /// Chords along a rim as pairs of corners.
    pub(super) fn along(&self, rim: Rim) -> Vec<(u32, u32)> {
        let (right, top) = (self.u.len() - 1, self.v.len() - 1);
        let count = if rim.along_u() { right } else { top };
        let at = |k: usize| match rim {
            Rim::Bottom => self.corner(k, 0),
            Rim::Top => self.corner(k, top),
            Rim::Left => self.corner(0, k),
            Rim::Right => self.corner(right, k),
        };
        (0..count).map(|k| (at(k), at(k + 1))).collect()
    }

    /// Corners and triangles, two for each cell. Points that are not on the rims are new.
    pub(super) fn piece(&self, block: &Block<'_>, rims: &[Cut; 4], points: &mut Vec<DVec3>) -> Piece {
        let jets = block.lattice(&self.u, &self.v);
        let mut piece = Piece { normals: jets.iter().map(|jet| jet.normal).collect(), ..Piece::default() };
        points.reserve(jets.len());
        piece.corners.reserve(jets.len());
        let mut jet = jets.iter();
        let [bottom, right, top, left] = rims;
        for (row, v) in self.v.iter().enumerate() {
            for (column, (u, jet)) in self.u.iter().zip(&mut jet).enumerate() {
                let point = if row == 0 {
                    bottom.points[column]
                } else if row + 1 == self.v.len() {
                    top.points[column]
                } else if column == 0 {
                    left.points[row]
                } else if column + 1 == self.u.len() {
                    right.points[row]
                } else {
                    points.push(jet.point);
                    index(points.len() - 1)
                };
                piece.corners.push(Corner { u: *u, v: *v, point, free: Free::Neither });
            }
        }
        piece.triangles.reserve(2 * self.middles.len());
        let mut middle = self.middles.iter();
        for row in 0..self.v.len() - 1 {
            for (column, middle) in (0..self.u.len() - 1).zip(&mut middle) {
                let quad = self.quad(column, row);
                let place = quad.map(|corner| points[piece.corners[corner as usize].point as usize]);
                let [a, b, c, d] = quad;
                if rises(place, middle) {
                    piece.triangles.extend([[a, b, c], [a, c, d]]);
                } else {
                    piece.triangles.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
        piece
    }

    /// Corners of a cell, counter-clockwise from the lower left.
    fn quad(&self, column: usize, row: usize) -> [u32; 4] {
        let corner = |right: usize, up: usize| self.corner(column + right, row + up);
        [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]
    }

    /// A proved bound of all triangles, which are those of [`Lattice::piece`] still; none where there is no proof.
    pub(super) fn deviation(&self, block: &Block<'_>, piece: &Piece, points: &[DVec3]) -> Option<Deviation> {
        let wide = |lines: &[f64], within: (f64, f64)| -> Vec<(f64, f64)> {
            lines.windows(2).map(|pair| widened((pair[0], pair[1]), within)).collect()
        };
        let (columns, rows) = (wide(&self.u, block.u), wide(&self.v, block.v));
        let cells = columns.len();
        let mut most = 0.0_f64;
        for (group, rows) in rows.chunks(ROWS).enumerate() {
            let ranges = block.surface.second_ranges(&columns, rows)?;
            for (k, range) in ranges.iter().enumerate() {
                let cell = group * ROWS * cells + k;
                let (column, row) = (cell % cells, cell / cells);
                let size = (self.u[column + 1] - self.u[column], self.v[row + 1] - self.v[row]);
                if most_of_a_cell(range, size) <= most {
                    continue;
                }
                for triangle in &piece.triangles[2 * cell..2 * cell + 2] {
                    let corners = triangle.map(|corner| piece.corners[corner as usize]);
                    let [a, b, c] = corners.map(|corner| points[corner.point as usize]);
                    let normal = (b - a).cross(c - a).normalize_or_zero();
                    let steps = super::judge::steps(&corners);
                    most = most.max(bound(range, || self.middles[cell], (normal, steps), size, most));
                }
            }
        }
        most.is_finite().then(|| Deviation::new(most, Evidence::Proved))
    }
}

/// No triangle of a cell that is h wide and k high is further away than this (D. Filip, R. Magedson, R. Markot, 1986).
fn most_of_a_cell(range: &SecondRange, (h, k): (f64, f64)) -> f64 {
    let size = |range: &Bounds| range.min.abs().max(range.max.abs()).length();
    (size(&range.uu) * h * h + 2.0 * size(&range.uv) * h * k + size(&range.vv) * k * k) / 8.0
}

/// Whether the diagonal from the lower left to the upper right leaves out less of the surface than the other.
fn rises([a, b, c, d]: [DVec3; 4], middle: &SurfaceJet) -> bool {
    let away = |one: DVec3, other: DVec3| ((one + other) / 2.0 - middle.point).dot(middle.normal).abs();
    let (up, down) = (away(a, c), away(b, d));
    up + BETTER * (c - a).length().max((d - b).length()) < down
}

//! Bicubic surfaces by a basis matrix: Bezier, B-spline, Catmull-Rom, Hermite, or any other.
//!
//! Each piece is (u^3, u^2, u, 1) M G M^T (v^3, v^2, v, 1)^T with 4 x 4 geometry G. Matrices as in J. Foley, A. van
//! Dam, S. Feiner, J. Hughes, Computer Graphics, 2nd ed. 1990, 11.3.

use glam::DVec3;
use thiserror::Error;

use super::patches::{Patches, PatchesError};
use super::{Grid, PolynomialSurface};
use crate::geometry::curve::control::BasisMatrix;
use crate::geometry::number::Bounds;

/// Why geometry does not make a bicubic surface.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BicubicError {
    /// The grid does not hold whole pieces.
    #[error(transparent)]
    Patches(#[from] PatchesError),
    /// Pieces that follow each other do not meet: the basis does not join at this step.
    #[error("pieces {before:?} and {after:?} are {gap} apart where they should meet")]
    Gap {
        /// Column and row of the one.
        before: (usize, usize),
        /// Column and row of the other.
        after: (usize, usize),
        /// The greatest distance between control points of the two sides.
        gap: f64,
    },
}

/// Control points of two sides nearer than this share of the size of all are one line.
const MEETS: f64 = 1e-9;

/// Pieces whose geometry is every 4 x 4 part of the grid, `step` points from one to the next: 1 for B-splines and
/// Catmull-Rom, 3 for Bezier. Each covers 1 of u and of v.
///
/// # Errors
/// When the grid does not hold whole pieces, or these do not meet.
pub fn bicubic(
    control: &Grid<DVec3>,
    basis: &BasisMatrix,
    step: usize,
) -> Result<PolynomialSurface, BicubicError> {
    let count = |direction: char, points: usize| {
        let fits = step > 0 && points >= 4 && (points - 4).is_multiple_of(step);
        let pieces = if fits { Some((points - 4) / step + 1) } else { None };
        pieces.ok_or(PatchesError::Count { direction, points, degree: 3 })
    };
    let count = (count('u', control.columns())?, count('v', control.rows())?);
    pieces(count, |column, row| {
        let geometry = |j: usize, i: usize| control.get(column * step + i, row * step + j);
        bezier(basis, geometry)
    })
}

/// What a Hermite surface is given at each point of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct HermiteGrid {
    /// Corners of the pieces.
    pub points: Grid<DVec3>,
    /// Derivatives by u there.
    pub along_u: Grid<DVec3>,
    /// Derivatives by v.
    pub along_v: Grid<DVec3>,
    /// Derivatives by u and v; zero where not given, as J. Ferguson had them.
    pub twists: Option<Grid<DVec3>>,
}

/// Hermite pieces (bicubic Coons patches): from every four neighbors of the grid, their tangents and twists.
///
/// Sources: J. Ferguson, Multivariable curve interpolation, J. ACM 11 (1964); S. Coons, Surfaces for
/// computer-aided design of space forms, 1967.
///
/// # Errors
/// When the grids differ in size or hold fewer than 2 x 2 points.
pub fn hermite(grid: &HermiteGrid) -> Result<PolynomialSurface, BicubicError> {
    let (columns, rows) = (grid.points.columns(), grid.points.rows());
    let others = [Some(&grid.along_u), Some(&grid.along_v), grid.twists.as_ref()];
    for (direction, of) in [('u', Grid::columns as fn(&Grid<DVec3>) -> usize), ('v', Grid::rows)] {
        let expected = of(&grid.points);
        let wrong = others.iter().flatten().map(|other| of(other)).find(|found| *found != expected);
        if let Some(points) = wrong.or(Some(expected).filter(|count| *count < 2)) {
            return Err(PatchesError::Count { direction, points, degree: 3 }.into());
        }
    }
    pieces((columns - 1, rows - 1), |column, row| {
        let geometry = |j: usize, i: usize| {
            let (x, y) = (column + i % 2, row + j % 2);
            match (i < 2, j < 2) {
                (true, true) => grid.points.get(x, y),
                (false, true) => grid.along_u.get(x, y),
                (true, false) => grid.along_v.get(x, y),
                (false, false) => grid.twists.as_ref().map_or(DVec3::ZERO, |twists| twists.get(x, y)),
            }
        };
        bezier(&BasisMatrix::HERMITE, geometry)
    })
}

/// Bezier points, row by row, of the piece with geometry (row, column).
fn bezier(basis: &BasisMatrix, geometry: impl Fn(usize, usize) -> DVec3) -> [DVec3; 16] {
    let rows = [0, 1, 2, 3].map(|j| basis.to_bezier(&[0, 1, 2, 3].map(|i| geometry(j, i))));
    let columns = [0, 1, 2, 3].map(|i| basis.to_bezier(&[0, 1, 2, 3].map(|j| rows[j][i])));
    let mut points = [DVec3::ZERO; 16];
    for (k, point) in points.iter_mut().enumerate() {
        *point = columns[k % 4][k / 4];
    }
    points
}

fn pieces(
    count: (usize, usize),
    piece: impl Fn(usize, usize) -> [DVec3; 16],
) -> Result<PolynomialSurface, BicubicError> {
    let (columns, rows) = count;
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let all: Vec<[DVec3; 16]> = places.map(|(column, row)| piece(column, row)).collect();
    check_meeting(&all, columns)?;
    let breaks = |count: usize| (0..=count).map(|k| k as f64).collect();
    let control = all.into_iter().flatten().collect();
    let patches = Patches::of_pieces((3, 3), control, count, (breaks(columns), breaks(rows)))?;
    Ok(PolynomialSurface::of_patches(patches))
}

fn check_meeting(all: &[[DVec3; 16]], columns: usize) -> Result<(), BicubicError> {
    let size = Bounds::of_points(all.iter().flatten().copied()).diagonal();
    let place = |index: usize| (index % columns, index / columns);
    for index in 0..all.len() {
        let right =
            (index + 1 < all.len() && place(index).0 + 1 < columns).then(|| (index + 1, [3, 7, 11, 15], 3));
        let above = (index + columns < all.len()).then(|| (index + columns, [12, 13, 14, 15], 12));
        for (next, side, back) in right.into_iter().chain(above) {
            let apart = |k: usize| all[index][k].distance(all[next][k - back]);
            let gap = side.into_iter().map(apart).fold(0.0, f64::max);
            if gap > MEETS * size {
                return Err(BicubicError::Gap { before: place(index), after: place(next), gap });
            }
        }
    }
    Ok(())
}

/// The grid with its first `u` columns and `v` rows repeated at the end: closed that way.
#[must_use]
pub fn wrapped<P: Copy>(control: &Grid<P>, u: usize, v: usize) -> Grid<P> {
    let (columns, rows) = (control.columns(), control.rows());
    let place = |i: usize, j: usize| control.get(i % columns, j % rows);
    Grid::from_fn(columns + u, rows + v, place).expect("a grid with more points is a grid")
}

/// The grid with one more row or column at each end, by reflecting the neighbor of the end in it: pieces that run
/// between the inner points of four then reach the border.
#[must_use]
pub fn reflected(control: &Grid<DVec3>, u: bool, v: bool) -> Grid<DVec3> {
    let along = |grid: &Grid<DVec3>| {
        let rows = (0..grid.rows()).map(|row| {
            let row = grid.row(row);
            let (last, inner) = (row[row.len() - 1], row[row.len().saturating_sub(2)]);
            let first = row[0] * 2.0 - row[1.min(row.len() - 1)];
            [&[first], row, &[last * 2.0 - inner]].concat()
        });
        Grid::of_rows(rows.collect()).expect("every row got two points more")
    };
    let mut grid = control.clone();
    if u {
        grid = along(&grid);
    }
    if v {
        grid = along(&grid.transposed()).transposed();
    }
    grid
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{BicubicError, HermiteGrid, bicubic, hermite, reflected, wrapped};
    use crate::geometry::curve::Side;
    use crate::geometry::curve::control::{BasisMatrix, Knots};
    use crate::geometry::surface::Surface;
    use crate::geometry::surface::tensor::{Grid, PolynomialSurface, TensorSpline};

    fn wavy(columns: usize, rows: usize) -> Grid<DVec3> {
        let height = |i: usize, j: usize| ((i * i * 7 + j * 5 + i * j) % 11) as f64 * 0.2 - 1.0;
        Grid::from_fn(columns, rows, |i, j| DVec3::new(i as f64, height(i, j), -(j as f64))).unwrap()
    }

    #[test]
    fn the_uniform_b_spline_is_that_of_even_knots() {
        let control = wavy(7, 5);
        let one = bicubic(&control, &BasisMatrix::B_SPLINE, 1).unwrap();
        let (u, v) = (Knots::uniform(3, 7).unwrap(), Knots::uniform(3, 5).unwrap());
        let other = PolynomialSurface::spline(&TensorSpline::new(u, v, control).unwrap()).unwrap();
        for (u, v) in (0..=96).map(|k| (f64::from(k) / 24.0, f64::from((k * 5) % 97) / 48.0)) {
            let (a, b) = (one.evaluate(u, v), other.evaluate(u + 3.0, v + 3.0));
            assert!(a.point.distance(b.point) < 1e-13 && a.du.distance(b.du) < 1e-12);
        }
        assert!(one.joints_u().is_empty() && one.joints_v().is_empty());
    }

    #[test]
    fn catmull_rom_goes_through_its_points() {
        let control = wavy(6, 5);
        let surface = bicubic(&reflected(&control, true, true), &BasisMatrix::CATMULL_ROM, 1).unwrap();
        for (i, j) in (0..6).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let point = surface.evaluate(i as f64, j as f64).point;
            assert!(point.distance(control.get(i, j)) < 1e-14 * 8.0);
        }
    }

    #[test]
    fn closed_grids_come_back() {
        let control = wavy(6, 5);
        for basis in [BasisMatrix::B_SPLINE, BasisMatrix::CATMULL_ROM, BasisMatrix::beta(2.0, 1.0)] {
            let surface = bicubic(&wrapped(&control, 3, 0), &basis, 1).unwrap();
            let (start, end) =
                (surface.evaluate(0.0, 1.3), surface.sided((6.0, Side::Before), (1.3, Side::After)));
            assert!(start.point.distance(end.point) < 1e-14 * 8.0);
        }
    }

    #[test]
    fn a_hermite_surface_has_what_it_is_given() {
        let at = |seed: usize| wavy(3, 4).map(|p| DVec3::new(p.y + seed as f64, p.z, p.x * 0.5));
        let grid = HermiteGrid { points: wavy(3, 4), along_u: at(1), along_v: at(2), twists: Some(at(3)) };
        let surface = hermite(&grid).unwrap();
        for (i, j) in (0..3).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let place = ((i as f64, Side::After), (j as f64, Side::After));
            let (jet, second) = (surface.sided(place.0, place.1), surface.second(place.0, place.1));
            assert!(jet.point.distance(grid.points.get(i, j)) < 1e-13);
            assert!(jet.du.distance(grid.along_u.get(i, j)) < 1e-12);
            assert!(jet.dv.distance(grid.along_v.get(i, j)) < 1e-12);
            assert!(second.uv.distance(at(3).get(i, j)) < 1e-11);
        }
        let flat = hermite(&HermiteGrid { twists: None, ..grid }).unwrap();
        let zero = flat.second((1.0, Side::After), (1.0, Side::After));
        assert!(zero.uv.length() < 1e-12);
    }

    #[test]
    fn pieces_that_do_not_meet_are_refused() {
        let refused = bicubic(&wavy(5, 4), &BasisMatrix::BEZIER, 1);
        assert!(
            matches!(refused, Err(BicubicError::Gap { before: (0, 0), after: (1, 0), gap }) if gap > 0.5)
        );
        assert!(matches!(bicubic(&wavy(6, 4), &BasisMatrix::BEZIER, 3), Err(BicubicError::Patches(_))));
        let (two, three) = (wavy(2, 2), wavy(3, 2));
        let uneven = HermiteGrid { points: two.clone(), along_u: three, along_v: two, twists: None };
        assert!(hermite(&uneven).is_err());
    }
}

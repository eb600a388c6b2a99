//! Bezier pieces over a grid of parameters.

use thiserror::Error;

use super::bernstein::{self, MOST_DEGREE};
use super::grid::Grid;
use super::net::Net;
use crate::geometry::curve::control::Control;
use crate::geometry::curve::pieces::Pieces;
use crate::geometry::curve::{Domain, Side};

/// Why control points do not make pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum PatchesError {
    /// A degree is zero or above [`MOST_DEGREE`].
    #[error("degrees go from 1 to {MOST_DEGREE}, not {degree}")]
    Degree {
        /// The degree.
        degree: usize,
    },
    /// The points do not make up whole pieces.
    #[error("{points} points along {direction} do not make whole pieces of degree {degree}")]
    Count {
        /// `u` or `v`.
        direction: char,
        /// Points in that direction.
        points: usize,
        /// Degree in that direction.
        degree: usize,
    },
    /// The parameters do not increase, or are not one more than there are pieces.
    #[error("the parameters along {direction} must increase, one more than there are pieces")]
    Breaks {
        /// `u` or `v`.
        direction: char,
    },
}

/// Pieces of one pair of degrees, each with its own control points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patches<P> {
    degree: (usize, usize),
    u: Pieces,
    v: Pieces,
    /// Piece after piece along u, then along v; in each, row by row.
    control: Vec<P>,
}

/// A part of one piece, in its local parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) piece: (usize, usize),
    pub(super) u: (f64, f64),
    pub(super) v: (f64, f64),
}

impl<P: Control> Patches<P> {
    /// Pieces from one grid in which neighbors share their points.
    pub(super) fn new(
        degree: (usize, usize),
        grid: &Grid<P>,
        breaks_u: Vec<f64>,
        breaks_v: Vec<f64>,
    ) -> Result<Self, PatchesError> {
        let count = |direction: char, points: usize, degree: usize| {
            if degree == 0 || degree > MOST_DEGREE {
                return Err(PatchesError::Degree { degree });
            }
            if points < degree + 1 || !(points - 1).is_multiple_of(degree) {
                return Err(PatchesError::Count { direction, points, degree });
            }
            Ok((points - 1) / degree)
        };
        let columns = count('u', grid.columns(), degree.0)?;
        let rows = count('v', grid.rows(), degree.1)?;
        let mut control = Vec::with_capacity(columns * rows * (degree.0 + 1) * (degree.1 + 1));
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            for j in 0..=degree.1 {
                let start = column * degree.0;
                control.extend_from_slice(&grid.row(row * degree.1 + j)[start..=start + degree.0]);
            }
        }
        Self::of_pieces(degree, control, (columns, rows), (breaks_u, breaks_v))
    }

    /// `count.0` times `count.1` pieces, each with all its points.
    pub(super) fn of_pieces(
        degree: (usize, usize),
        control: Vec<P>,
        count: (usize, usize),
        breaks: (Vec<f64>, Vec<f64>),
    ) -> Result<Self, PatchesError> {
        let pieces = |direction: char, breaks: Vec<f64>, count: usize| {
            Pieces::new(breaks)
                .filter(|pieces| pieces.count() == count)
                .ok_or(PatchesError::Breaks { direction })
        };
        let (u, v) = (pieces('u', breaks.0, count.0)?, pieces('v', breaks.1, count.1)?);
        Ok(Self { degree, u, v, control })
    }

    pub(super) fn degree(&self) -> (usize, usize) {
        self.degree
    }

    /// Pieces along u and along v.
    pub(super) fn count(&self) -> (usize, usize) {
        (self.u.count(), self.v.count())
    }

    pub(super) fn domain_u(&self) -> Domain {
        self.u.domain()
    }

    pub(super) fn domain_v(&self) -> Domain {
        self.v.domain()
    }

    pub(super) fn breaks(&self) -> (&[f64], &[f64]) {
        (self.u.breaks(), self.v.breaks())
    }

    pub(super) fn inner_breaks(&self) -> (&[f64], &[f64]) {
        (self.u.inner(), self.v.inner())
    }

    pub(super) fn control(&self) -> &[P] {
        &self.control
    }

    /// Control points of one piece, row by row.
    #[inline]
    pub(super) fn piece(&self, piece: (usize, usize)) -> &[P] {
        let size = (self.degree.0 + 1) * (self.degree.1 + 1);
        let start = self.number(piece) * size;
        &self.control[start..start + size]
    }

    /// The number of a piece, row by row.
    #[inline]
    pub(super) fn number(&self, (column, row): (usize, usize)) -> usize {
        row * self.u.count() + column
    }

    /// The piece of a place, and the place in it from 0 to 1.
    #[inline]
    pub(super) fn locate(&self, u: (f64, Side), v: (f64, Side)) -> ((usize, usize), (f64, f64)) {
        let piece = (self.u.locate(u.0, u.1), self.v.locate(v.0, v.1));
        (piece, (self.u.local(piece.0, u.0), self.v.local(piece.1, v.0)))
    }

    /// Lengths of a piece in u and v.
    #[inline]
    pub(super) fn spans(&self, (column, row): (usize, usize)) -> (f64, f64) {
        (self.u.span(column), self.v.span(row))
    }

    /// Value and derivatives by the local parameters.
    #[inline]
    pub(super) fn jet(&self, piece: (usize, usize), local: (f64, f64)) -> [P; 3] {
        bernstein::jet(self.piece(piece), self.degree, local.0, local.1)
    }

    /// Second derivatives by the local parameters.
    pub(super) fn second(&self, piece: (usize, usize), local: (f64, f64)) -> [P; 3] {
        bernstein::second(self.piece(piece), self.degree, local.0, local.1)
    }

    pub(super) fn net(&self, piece: (usize, usize)) -> Net<P> {
        Net::new(self.piece(piece), self.degree.0 + 1)
    }

    /// The parts of pieces that make up a rectangle of parameters.
    pub(super) fn parts(&self, u: (f64, f64), v: (f64, f64)) -> impl Iterator<Item = Part> {
        let first = (self.u.locate(u.0, Side::After), self.v.locate(v.0, Side::After));
        let last = (self.u.locate(u.1, Side::Before), self.v.locate(v.1, Side::Before));
        let rows = first.1..=last.1.max(first.1);
        rows.flat_map(move |row| (first.0..=last.0.max(first.0)).map(move |column| (column, row))).map(
            move |piece| Part {
                piece,
                u: (self.u.local(piece.0, u.0), self.u.local(piece.0, u.1)),
                v: (self.v.local(piece.1, v.0), self.v.local(piece.1, v.1)),
            },
        )
    }

    /// Control points of both sides of the line between two columns of pieces, in rows that run across it: for
    /// each piece along v the last column of points before and the first after, `depth` columns deep, ordered
    /// from the line inward.
    pub(super) fn beside_u(&self, column: usize, row: usize, depth: usize) -> (Vec<Vec<P>>, Vec<Vec<P>>) {
        let width = self.degree.0 + 1;
        let take = |piece: &[P], place: usize| -> Vec<P> {
            piece.chunks_exact(width).map(|line| line[place]).collect()
        };
        let (before, after) = (self.piece((column - 1, row)), self.piece((column, row)));
        (
            (0..depth).map(|k| take(before, self.degree.0 - k)).collect(),
            (0..depth).map(|k| take(after, k)).collect(),
        )
    }

    /// The same pieces with u and v exchanged.
    pub(super) fn transposed(&self) -> Self {
        let (columns, rows) = self.count();
        let (p, q) = self.degree;
        let places = (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row)));
        let turned = |place: (usize, usize)| {
            let piece = self.piece(place);
            (0..=p).flat_map(move |i| (0..=q).map(move |j| piece[j * (p + 1) + i]))
        };
        let control = places.flat_map(turned).collect();
        Self { degree: (q, p), u: self.v.clone(), v: self.u.clone(), control }
    }
}

//! B-spline surfaces in the form of their control points and knots, and what changes the form alone.

use super::Grid;
use crate::geometry::curve::control::{BSpline, Control, KnotError, Knots};

/// A tensor-product B-spline of any degrees, rational when its points are homogeneous.
///
/// Every operation works line by line, so its cost is that of the curve's times the number of lines.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorSpline<P> {
    u: Knots,
    v: Knots,
    control: Grid<P>,
}

impl<P: Control> TensorSpline<P> {
    /// A spline with one control point for each pair of basis functions; `None` when the counts differ.
    #[must_use]
    pub fn new(u: Knots, v: Knots, control: Grid<P>) -> Option<Self> {
        let fits = u.points() == control.columns() && v.points() == control.rows();
        fits.then_some(Self { u, v, control })
    }

    /// Knots along u.
    #[must_use]
    pub fn u(&self) -> &Knots {
        &self.u
    }

    /// Knots along v.
    #[must_use]
    pub fn v(&self) -> &Knots {
        &self.v
    }

    /// The control points.
    #[must_use]
    pub fn control(&self) -> &Grid<P> {
        &self.control
    }

    /// The same surface with u and v exchanged; the normal turns to the other side.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { u: self.v.clone(), v: self.u.clone(), control: self.control.transposed() }
    }

    /// The point at (u, v) by de Boor's scheme: row by row, then across. O(p^2 q + q^2).
    #[must_use]
    pub fn de_boor(&self, u: f64, v: f64) -> P {
        let rows: Vec<P> = self.lines().map(|line| line.de_boor(u)).collect();
        self.across(rows).de_boor(v)
    }

    /// The same surface with one knot more along u.
    ///
    /// # Errors
    /// When the knot would stand more often than the degree allows.
    pub fn insert_u(&self, t: f64) -> Result<Self, KnotError> {
        let lines = self.lines().map(|line| line.insert(t)).collect::<Result<Vec<_>, _>>()?;
        Ok(self.with_lines(&lines))
    }

    /// The same surface with one knot more along v.
    ///
    /// # Errors
    /// When the knot would stand more often than the degree allows.
    pub fn insert_v(&self, t: f64) -> Result<Self, KnotError> {
        Ok(self.transposed().insert_u(t)?.transposed())
    }

    /// The same surface with a knot in the middle of every step of both directions: four pieces for each.
    ///
    /// # Errors
    /// When knots stand so close that there is no number between them.
    pub fn refined(&self) -> Result<Self, KnotError> {
        let middles = |knots: &Knots| {
            let middle = |span: usize| f64::midpoint(knots.values()[span], knots.values()[span + 1]);
            knots.spans().into_iter().map(middle).collect::<Vec<_>>()
        };
        let mut finer = self.clone();
        for t in middles(&self.u) {
            finer = finer.insert_u(t)?;
        }
        for t in middles(&self.v) {
            finer = finer.insert_v(t)?;
        }
        Ok(finer)
    }

    /// The same surface one degree higher along u.
    #[must_use]
    pub fn elevated_u(&self) -> Self {
        let lines: Vec<BSpline<P>> = self.lines().map(|line| line.elevated()).collect();
        self.with_lines(&lines)
    }

    /// The same surface one degree higher along v.
    #[must_use]
    pub fn elevated_v(&self) -> Self {
        self.transposed().elevated_u().transposed()
    }

    /// The same surface with u run backwards; the normal turns to the other side.
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let lines: Vec<BSpline<P>> = self.lines().map(|line| line.reversed()).collect();
        self.with_lines(&lines)
    }

    /// Bezier points of all pieces, shared ones once, and the parameters at which pieces begin and end.
    #[must_use]
    pub fn to_bezier(&self) -> (Grid<P>, Vec<f64>, Vec<f64>) {
        let (along, breaks_u) = bezier_rows(&self.u, &self.control);
        let (across, breaks_v) = bezier_rows(&self.v, &along.transposed());
        (across.transposed(), breaks_u, breaks_v)
    }

    fn lines(&self) -> impl Iterator<Item = BSpline<P>> {
        (0..self.control.rows()).map(|row| line(&self.u, self.control.row(row).to_vec()))
    }

    fn across(&self, points: Vec<P>) -> BSpline<P> {
        line(&self.v, points)
    }

    /// The surface whose rows have become these, all over the same knots.
    fn with_lines(&self, lines: &[BSpline<P>]) -> Self {
        let points = lines.iter().flat_map(|line| line.points().iter().copied()).collect();
        let control = Grid::new(lines[0].points().len(), points);
        Self {
            u: lines[0].knots().clone(),
            v: self.v.clone(),
            control: control.expect("the same change gives every row the same number of points"),
        }
    }
}

fn line<P: Control>(knots: &Knots, points: Vec<P>) -> BSpline<P> {
    BSpline::new(knots.clone(), points).expect("a row has one point for each basis function")
}

fn bezier_rows<P: Control>(knots: &Knots, control: &Grid<P>) -> (Grid<P>, Vec<f64>) {
    let rows: Vec<(Vec<P>, Vec<f64>)> =
        (0..control.rows()).map(|row| line(knots, control.row(row).to_vec()).to_bezier()).collect();
    let breaks = rows[0].1.clone();
    let points = rows.into_iter().map(|(points, _)| points).collect();
    (Grid::of_rows(points).expect("equal knots give equally many points"), breaks)
}

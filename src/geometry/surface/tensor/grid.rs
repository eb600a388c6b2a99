//! Control points in rows and columns.

/// Control points in rows: u runs along a row, v from row to row.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<P> {
    columns: usize,
    points: Vec<P>,
}

impl<P: Copy> Grid<P> {
    /// Rows of `columns` points each; `None` when the points do not fill them, or there is none.
    #[must_use]
    pub fn new(columns: usize, points: Vec<P>) -> Option<Self> {
        let fits = columns > 0 && !points.is_empty() && points.len().is_multiple_of(columns);
        fits.then_some(Self { columns, points })
    }

    /// One row for each item; `None` when they differ in length or there is none.
    #[must_use]
    pub fn of_rows(rows: Vec<Vec<P>>) -> Option<Self> {
        let columns = rows.first()?.len();
        let same = rows.iter().all(|row| row.len() == columns);
        if same { Self::new(columns, rows.into_iter().flatten().collect()) } else { None }
    }

    /// A point for each place.
    pub fn from_fn(columns: usize, rows: usize, point: impl Fn(usize, usize) -> P) -> Option<Self> {
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self::new(columns, places.map(|(column, row)| point(column, row)).collect())
    }

    /// Points in a row: those that u runs along.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows: those that v runs along.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.points.len() / self.columns
    }

    /// All points, row by row.
    #[must_use]
    pub fn points(&self) -> &[P] {
        &self.points
    }

    /// The point of a place.
    #[must_use]
    pub fn get(&self, column: usize, row: usize) -> P {
        self.points[row * self.columns + column]
    }

    /// One row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[P] {
        &self.points[row * self.columns..(row + 1) * self.columns]
    }

    /// Rows as columns: u and v change places.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let columns = (0..self.columns).flat_map(|column| (0..self.rows()).map(move |row| (column, row)));
        let points = columns.map(|(column, row)| self.get(column, row)).collect();
        Self { columns: self.rows(), points }
    }

    /// The same places with other points.
    #[must_use]
    pub fn map<Q: Copy>(&self, change: impl Fn(P) -> Q) -> Grid<Q> {
        Grid { columns: self.columns, points: self.points.iter().map(|point| change(*point)).collect() }
    }
}

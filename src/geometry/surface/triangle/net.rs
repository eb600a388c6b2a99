//! Triangular nets of control points.

use crate::geometry::curve::control::Control;
use crate::geometry::surface::tensor::Grid;

/// The control points of one Bezier triangle. Row m holds m + 1 points, from the first row, which is corner 0, to the last,
/// which runs from corner 1 to corner 2: point k of row m stands at ((n - m) / n, (m - k) / n, k / n) in barycentric
/// coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleNet<P> {
    degree: usize,
    points: Vec<P>,
}

/// Where point k of row m is stored.
fn place(row: usize, k: usize) -> usize {
    row * (row + 1) / 2 + k
}

impl<P: Control> TriangleNet<P> {
    /// A net from its points, row by row; `None` when they fill no triangle of degree 1 or more.
    #[must_use]
    pub fn new(points: Vec<P>) -> Option<Self> {
        let degree = Self::degree_of(points.len())?;
        Some(Self { degree, points })
    }

    /// The degree of a net with so many points: 1 for 3, 2 for 6, 3 for 10, 4 for 15.
    #[must_use]
    pub fn degree_of(points: usize) -> Option<usize> {
        (1..points)
            .take_while(|degree| place(*degree, 0) < points)
            .find(|degree| place(degree + 1, 0) == points)
    }

    /// A net of one degree, its points by row and place in the row.
    fn from_fn(degree: usize, point: impl Fn(usize, usize) -> P) -> Self {
        let places = (0..=degree).flat_map(|row| (0..=row).map(move |k| (row, k)));
        Self { degree, points: places.map(|(row, k)| point(row, k)).collect() }
    }

    /// Its degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All points, row by row.
    #[must_use]
    pub fn points(&self) -> &[P] {
        &self.points
    }

    /// Point k of a row.
    #[must_use]
    pub fn get(&self, row: usize, k: usize) -> P {
        self.points[place(row, k)]
    }

    /// One step of de Casteljau's construction: each small triangle that stands like the whole becomes its point of the
    /// coordinates. With coordinates that add to 0 times the degree, the derivative in their direction.
    #[must_use]
    pub fn step(&self, b: [f64; 3]) -> Self {
        Self::from_fn(self.degree - 1, |row, k| {
            self.get(row, k) * b[0] + self.get(row + 1, k) * b[1] + self.get(row + 1, k + 1) * b[2]
        })
    }

    /// The point at barycentric coordinates that add to 1, inside where none is negative. O(degree^3).
    #[must_use]
    pub fn evaluate(&self, b: [f64; 3]) -> P {
        let mut net = self.clone();
        while net.degree > 0 {
            net = net.step(b);
        }
        net.points[0]
    }

    /// The derivative in a direction, whose coordinates add to 0; `None` of degree 1, where it is constant.
    #[must_use]
    pub fn derived(&self, direction: [f64; 3]) -> Option<Self> {
        let scale = self.degree as f64;
        (self.degree > 1).then(|| self.step(direction.map(|part| part * scale)))
    }

    /// The same surface one degree higher.
    #[must_use]
    pub fn elevated(&self) -> Self {
        let degree = self.degree + 1;
        Self::from_fn(degree, |row, k| {
            let (i, j) = (degree - row, row - k);
            let mut point = P::default();
            if i > 0 {
                point = point + self.get(row, k) * (i as f64 / degree as f64);
            }
            if j > 0 {
                point = point + self.get(row - 1, k) * (j as f64 / degree as f64);
            }
            if k > 0 {
                point = point + self.get(row - 1, k - 1) * (k as f64 / degree as f64);
            }
            point
        })
    }

    /// The surface cut at a point into three triangles: the first has it as corner 0, the second as corner 1, the third as
    /// corner 2, the other corners stay.
    #[must_use]
    pub fn divided(&self, b: [f64; 3]) -> [Self; 3] {
        let mut levels = vec![self.clone()];
        for level in 0..self.degree {
            levels.push(levels[level].step(b));
        }
        let n = self.degree;
        [
            // Points without a share in the corner that is replaced, at as many steps as the new corner has.
            Self::from_fn(n, |row, k| levels[n - row].get(row, k)),
            Self::from_fn(n, |row, k| levels[row - k].get(k, k)),
            Self::from_fn(n, |row, k| levels[k].get(row - k, 0)),
        ]
    }

    /// The same surface with its corners named anew: corner c is what was `from[c]`.
    #[must_use]
    pub fn renamed(&self, from: [usize; 3]) -> Self {
        let n = self.degree;
        Self::from_fn(n, |row, k| {
            let mut index = [0; 3];
            for (corner, count) in from.into_iter().zip([n - row, row - k, k]) {
                index[corner] = count;
            }
            self.get(n - index[0], index[2])
        })
    }

    /// Its last row: the Bezier points of the side from corner 1 to corner 2.
    #[must_use]
    pub fn last_row(&self) -> &[P] {
        &self.points[place(self.degree, 0)..]
    }

    /// The same surface as a Bezier patch over two parameters: barycentric coordinates (1 - v, v (1 - u), v u). v = 0 is
    /// corner 0, v = 1 the side from corner 1 to 2, u = 0 the side from 0 to 1 and u = 1 that from 0 to 2.
    ///
    /// Row m of the net is a Bezier curve of degree m in u, raised to the full degree; over v the rows are the control
    /// points as they stand.
    ///
    /// Source: B. Brueckner, Construction of Bezier points of quadrilaterals from those of triangles, CAD 12 (1980).
    ///
    /// # Panics
    /// Never: every row has as many points as the degree asks for.
    #[must_use]
    pub fn grid(&self) -> Grid<P> {
        let rows = (0..=self.degree).map(|row| {
            let mut points = self.points[place(row, 0)..place(row + 1, 0)].to_vec();
            while points.len() <= self.degree {
                points = raised(&points);
            }
            points
        });
        Grid::of_rows(rows.collect()).expect("all rows were raised to the same degree")
    }
}

/// The Bezier points of a curve one degree higher. Equal points stay what they are.
fn raised<P: Control>(points: &[P]) -> Vec<P> {
    let count = points.len();
    let inner = (1..count).map(|k| {
        let (before, here) = (points[k - 1], points[k]);
        here + (before - here) * (k as f64 / count as f64)
    });
    std::iter::once(points[0]).chain(inner).chain(std::iter::once(points[count - 1])).collect()
}

//! Fields from scattered points.
//!
//! Sources: R. Sibson, "A brief description of natural neighbour interpolation", in "Interpreting Multivariate Data",
//! 1981; D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM National Conference
//! 1968 (inverse squares of distances). Triangulation and Sibson's weights are spade's.

use glam::{DVec2, DVec3};
use spade::{DelaunayTriangulation, FloatTriangulation as _, HasPosition, Point2, Triangulation as _};
use thiserror::Error;

/// How values go on between points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Flat triangles of the Delaunay triangulation.
    Linear,
    /// Sibson's natural neighbors: smooth but at the points.
    NaturalNeighbor,
    /// Means weighted by inverse squares of distances.
    Shepard,
}

/// Why points make no field.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ScatterError {
    /// Two values at one place.
    #[error("points {first} and {second} lie at one place")]
    Repeated {
        /// The earlier one, from 0.
        first: usize,
        /// The later one.
        second: usize,
    },
    /// All points on one line.
    #[error("all points lie on one line")]
    OnLine,
}

struct Sample {
    place: Point2<f64>,
    value: f64,
}

impl HasPosition for Sample {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// Points with values, ready to be asked between them.
pub struct Scattered {
    method: Method,
    points: Vec<DVec3>,
    mesh: DelaunayTriangulation<Sample>,
    hull: Vec<[usize; 2]>,
}

impl Scattered {
    /// Points (x, y) with their values as z; all finite.
    ///
    /// # Errors
    /// When two points lie at one place or all on one line.
    pub fn new(points: Vec<DVec3>, method: Method) -> Result<Self, ScatterError> {
        let mut order: Vec<usize> = (0..points.len()).collect();
        let key = |index: &usize| points[*index].truncate();
        order
            .sort_by(|a, b| key(a).x.total_cmp(&key(b).x).then(key(a).y.total_cmp(&key(b).y)).then(a.cmp(b)));
        if let Some(pair) = order.windows(2).find(|pair| key(&pair[0]) == key(&pair[1])) {
            return Err(ScatterError::Repeated { first: pair[0], second: pair[1] });
        }
        // Spade takes no coordinates that are almost 0.
        let clean = |number: f64| if number.abs() < 1e-40 { 0.0 } else { number };
        let mut mesh = DelaunayTriangulation::new();
        for point in &points {
            let sample = Sample { place: Point2::new(clean(point.x), clean(point.y)), value: point.z };
            mesh.insert(sample).map_err(|_| ScatterError::OnLine)?;
        }
        if mesh.num_inner_faces() == 0 {
            return Err(ScatterError::OnLine);
        }
        let hull = mesh.convex_hull().map(|edge| [edge.from().index(), edge.to().index()]).collect();
        Ok(Self { method, points, mesh, hull })
    }

    /// The value at a place. Outside the hull of the points the value at the nearest place of the hull holds, but for
    /// Shepard's means, which go on.
    #[must_use]
    pub fn value(&self, x: f64, y: f64) -> f64 {
        if self.method == Method::Shepard {
            return self.mean(DVec2::new(x, y));
        }
        let place = Point2::new(x, y);
        let found = match self.method {
            Method::Linear => self.mesh.barycentric().interpolate(|vertex| vertex.data().value, place),
            _ => self.mesh.natural_neighbor().interpolate(|vertex| vertex.data().value, place),
        };
        match found {
            Some(value) if value.is_finite() => value,
            _ => self.on_hull(DVec2::new(x, y)),
        }
    }

    fn mean(&self, place: DVec2) -> f64 {
        let mut sums = (0.0, 0.0);
        for point in &self.points {
            let away = point.truncate().distance_squared(place);
            if away == 0.0 {
                return point.z;
            }
            sums = (sums.0 + point.z / away, sums.1 + 1.0 / away);
        }
        sums.0 / sums.1
    }

    fn on_hull(&self, place: DVec2) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for [from, to] in &self.hull {
            let (a, b) = (self.points[*from], self.points[*to]);
            let along = (b - a).truncate();
            let part = ((place - a.truncate()).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let away = (a.truncate() + along * part).distance_squared(place);
            if away < best.0 {
                best = (away, a.z + (b.z - a.z) * part);
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Method, ScatterError, Scattered};

    fn plane() -> Vec<DVec3> {
        let places = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (1.0, 1.0), (2.5, 1.7), (3.1, 0.4)];
        places.iter().map(|(x, y)| DVec3::new(*x, *y, 2.0 + 0.5 * x - 0.25 * y)).collect()
    }

    #[test]
    fn linear_and_natural_neighbors_reproduce_planes() {
        for method in [Method::Linear, Method::NaturalNeighbor] {
            let field = Scattered::new(plane(), method).unwrap();
            for k in 0..100 {
                let (x, y) = (f64::from(k % 10) * 0.43 + 0.03, f64::from(k / 10) * 0.32 + 0.01);
                assert!((field.value(x, y) - (2.0 + 0.5 * x - 0.25 * y)).abs() < 1e-12, "{method:?} {x} {y}");
            }
            // Beyond the hull the nearest value of its border.
            assert!((field.value(9.0, 1.0) - 3.75).abs() < 1e-12);
        }
    }

    #[test]
    fn every_method_passes_through_its_points() {
        for method in [Method::Linear, Method::NaturalNeighbor, Method::Shepard] {
            let field = Scattered::new(plane(), method).unwrap();
            for point in plane() {
                assert!((field.value(point.x, point.y) - point.z).abs() < 1e-12, "{method:?} {point}");
            }
        }
    }

    #[test]
    fn what_has_no_triangles_is_refused() {
        let line = (0..5).map(|k| DVec3::new(f64::from(k), 2.0 * f64::from(k), 1.0)).collect();
        assert!(matches!(Scattered::new(line, Method::Linear), Err(ScatterError::OnLine)));
        let twice = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Z];
        let repeated = Err(ScatterError::Repeated { first: 1, second: 3 });
        assert_eq!(Scattered::new(twice, Method::Shepard).map(|_| ()), repeated);
    }
}

//! Tensor-product surfaces of polynomial pieces.

use glam::DVec3;

use super::net::Net;
use super::patches::{Part, Patches, PatchesError};
use super::{Grid, TensorSpline, normal};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{SecondJet, SecondRange, Surface, SurfaceJet};

/// Bezier patches over a grid of parameters, joined at least without a gap; B-spline, Hermite and Catmull-Rom
/// surfaces in that form too. The normal is du x dv, at collapsed sides its limit.
///
/// Cost: point and tangents in O(degree^2) after finding the piece in O(log pieces); bounds in O(degree^3) for
/// each piece that the rectangle touches.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialSurface {
    patches: Patches<DVec3>,
    /// Size of the control net, which rounding is measured against.
    size: f64,
    joints: (Vec<f64>, Vec<f64>),
    bends: Bends,
}

/// Derivatives on both sides of a line that differ by less than this share of their size come from a smooth
/// construction: rounding alone leaves about 1e-14, an edge that a person means starts far above.
pub(super) const SAME: f64 = 1e-9;

impl PolynomialSurface {
    /// Bezier pieces of `degree` in u and v from one grid, in which neighbors share their points; the pieces meet
    /// at `breaks_u` and `breaks_v`, first and last included.
    ///
    /// # Errors
    /// When counts, degrees or parameters do not fit each other.
    pub fn bezier(
        degree: (usize, usize),
        control: &Grid<DVec3>,
        breaks_u: Vec<f64>,
        breaks_v: Vec<f64>,
    ) -> Result<Self, PatchesError> {
        Ok(Self::of_patches(Patches::new(degree, control, breaks_u, breaks_v)?))
    }

    /// A B-spline surface.
    ///
    /// # Errors
    /// When a degree is above [`MOST_DEGREE`](super::MOST_DEGREE).
    pub fn spline(spline: &TensorSpline<DVec3>) -> Result<Self, PatchesError> {
        let (grid, breaks_u, breaks_v) = spline.to_bezier();
        Self::bezier((spline.u().degree(), spline.v().degree()), &grid, breaks_u, breaks_v)
    }

    pub(super) fn of_patches(patches: Patches<DVec3>) -> Self {
        let size = Bounds::of_points(patches.control().iter().copied()).diagonal();
        let joints = (joints(&patches), joints(&patches.transposed()));
        let bends = Bends::new(&patches);
        Self { patches, size, joints, bends }
    }

    /// Degrees in u and v.
    #[must_use]
    pub fn degree(&self) -> (usize, usize) {
        self.patches.degree()
    }

    /// Parameters at which pieces begin and end, along u and along v.
    #[must_use]
    pub fn breaks(&self) -> (&[f64], &[f64]) {
        self.patches.breaks()
    }

    /// The Bezier points of the piece in a column and a row, row by row.
    #[must_use]
    pub fn piece(&self, column: usize, row: usize) -> &[DVec3] {
        self.patches.piece((column, row))
    }

    /// A box that holds the surface.
    #[must_use]
    pub fn hull(&self) -> Bounds {
        Bounds::of_points(self.patches.control().iter().copied())
    }

    fn limit(&self, u: (f64, Side), v: (f64, Side), [_, du, dv]: [DVec3; 3]) -> DVec3 {
        let (piece, local) = self.patches.locate(u, v);
        let [uu, uv, vv] = self.patches.second(piece, local);
        let inside = |x: f64, y: f64| {
            let [_, du, dv] = self.patches.jet(piece, (x, y));
            (du, dv)
        };
        normal::at_limit((du, dv), &SecondJet { uu, uv, vv }, (u.1, v.1), local, self.size, inside)
    }

    fn part_range(&self, part: &Part) -> SecondRange {
        let (across, up) = self.patches.spans(part.piece);
        let hull = |order: usize, scale: f64| {
            let (points, columns) = self.bends.piece(self.patches.number(part.piece), order);
            let net = Net::new(points, columns).restricted(part.u, part.v);
            let Bounds { min, max } = Bounds::of_points(net.points().iter().copied());
            Bounds { min: min / scale, max: max / scale }
        };
        SecondRange { uu: hull(0, across * across), uv: hull(1, across * up), vv: hull(2, up * up) }
    }
}

/// Control points of the second derivatives of all pieces by their local parameters: twice by u, by u and v, and twice
/// by v.
#[derive(Clone, Debug, PartialEq)]
struct Bends {
    /// Points, and how many stand in a row; as many for every piece.
    orders: [(Vec<DVec3>, usize); 3],
    pieces: usize,
}

impl Bends {
    fn new(patches: &Patches<DVec3>) -> Self {
        let (columns, rows) = patches.count();
        let pieces = || (0..rows).flat_map(|row| (0..columns).map(move |column| patches.net((column, row))));
        let all = |derived: fn(Net<DVec3>) -> Net<DVec3>| {
            let nets: Vec<Net<DVec3>> = pieces().map(derived).collect();
            let points = nets.iter().flat_map(|net| net.points().iter().copied()).collect();
            (points, nets[0].columns())
        };
        let orders = [
            all(|net| net.derived_u().derived_u()),
            all(|net| net.derived_u().derived_v()),
            all(|net| net.derived_v().derived_v()),
        ];
        Self { orders, pieces: columns * rows }
    }

    fn piece(&self, number: usize, order: usize) -> (&[DVec3], usize) {
        let (points, columns) = &self.orders[order];
        let size = points.len() / self.pieces;
        (&points[number * size..(number + 1) * size], *columns)
    }
}

/// Parameters of u, strictly inside, across which the first derivative jumps.
fn joints(patches: &Patches<DVec3>) -> Vec<f64> {
    let (columns, rows) = patches.count();
    let degree = patches.degree().0 as f64;
    let jumps = |column: usize| {
        let (span_before, span_after) = (patches.spans((column - 1, 0)).0, patches.spans((column, 0)).0);
        let (mut jump, mut size) = (0.0_f64, 0.0_f64);
        for row in 0..rows {
            let (before, after) = patches.beside_u(column, row, 2);
            for k in 0..before[0].len() {
                let one = (before[0][k] - before[1][k]) * (degree / span_before);
                let other = (after[1][k] - after[0][k]) * (degree / span_after);
                jump = jump.max(one.distance(other));
                size = size.max(one.length()).max(other.length());
            }
        }
        jump > SAME * size
    };
    (1..columns).filter(|column| jumps(*column)).map(|column| patches.breaks().0[column]).collect()
}

impl Surface for PolynomialSurface {
    fn domain_u(&self) -> Domain {
        self.patches.domain_u()
    }

    fn domain_v(&self) -> Domain {
        self.patches.domain_v()
    }

    #[inline]
    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let (piece, local) = self.patches.locate(u, v);
        let (across, up) = self.patches.spans(piece);
        let jet = self.patches.jet(piece, local);
        let [point, du, dv] = jet;
        let normal = normal::regular(du, dv, self.size).unwrap_or_else(|| self.limit(u, v, jet));
        SurfaceJet { point, du: du * (1.0 / across), dv: dv * (1.0 / up), normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let (piece, local) = self.patches.locate(u, v);
        let (across, up) = self.patches.spans(piece);
        let [uu, uv, vv] = self.patches.second(piece, local);
        SecondJet { uu: uu / (across * across), uv: uv / (across * up), vv: vv / (up * up) }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let ranges = self.patches.parts(u, v).map(|part| self.part_range(&part));
        ranges.reduce(|one, other| SecondRange {
            uu: one.uu.union(other.uu),
            uv: one.uv.union(other.uv),
            vv: one.vv.union(other.vv),
        })
    }

    fn joints_u(&self) -> Vec<f64> {
        self.joints.0.clone()
    }

    fn joints_v(&self) -> Vec<f64> {
        self.joints.1.clone()
    }

    fn breaks_u(&self) -> Vec<f64> {
        self.patches.inner_breaks().0.to_vec()
    }

    fn breaks_v(&self) -> Vec<f64> {
        self.patches.inner_breaks().1.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::PolynomialSurface;
    use crate::geometry::curve::Side;
    use crate::geometry::curve::control::Knots;
    use crate::geometry::surface::tensor::{Grid, TensorSpline};
    use crate::geometry::surface::{SecondRange, Surface};

    fn wavy(columns: usize, rows: usize) -> Grid<DVec3> {
        let height = |i: usize, j: usize| ((i * i * 7 + j * 5 + i * j) % 11) as f64 * 0.2 - 1.0;
        Grid::from_fn(columns, rows, |i, j| DVec3::new(i as f64, height(i, j), -(j as f64))).unwrap()
    }

    fn spline() -> TensorSpline<DVec3> {
        let u = Knots::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.5, 2.5, 2.5, 4.0, 4.0, 4.0, 4.0]).unwrap();
        let v = Knots::clamped(2, 6).unwrap();
        TensorSpline::new(u, v, wavy(8, 6)).unwrap()
    }

    #[test]
    fn a_spline_is_the_sum_of_its_basis() {
        let spline = spline();
        let surface = PolynomialSurface::spline(&spline).unwrap();
        for step in 0..=200 {
            let u = 4.0 * f64::from(step % 21) / 20.0;
            let v = 4.0 * f64::from(step % 17) / 16.0;
            let (first_u, basis_u) = spline.u().basis(u);
            let (first_v, basis_v) = spline.v().basis(v);
            let mut expected = [DVec3::ZERO; 5];
            for (j, row) in basis_v.iter().enumerate() {
                for (i, column) in basis_u.iter().enumerate() {
                    let point = spline.control().get(first_u + i, first_v + j);
                    let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1)];
                    for (sum, (a, b)) in expected.iter_mut().zip(orders) {
                        *sum += point * (column[a] * row[b]);
                    }
                }
            }
            let (jet, second) = (surface.evaluate(u, v), surface.second((u, Side::After), (v, Side::After)));
            assert!(jet.point.distance(expected[0]) < 1e-13);
            assert!(spline.de_boor(u, v).distance(expected[0]) < 1e-13);
            assert!(jet.du.distance(expected[1]) < 1e-12 && jet.dv.distance(expected[2]) < 1e-12);
            if u < 4.0 && v < 4.0 {
                assert!(second.uu.distance(expected[3]) < 1e-11 && second.uv.distance(expected[4]) < 1e-11);
            }
        }
    }

    #[test]
    fn joints_are_where_knots_leave_no_derivative() {
        let surface = PolynomialSurface::spline(&spline()).unwrap();
        assert_eq!((surface.joints_u(), surface.joints_v()), (vec![2.5], vec![]));
    }

    #[test]
    fn changes_of_form_are_the_same_surface() {
        let spline = spline();
        let changed = [
            spline.insert_u(0.3).unwrap().insert_v(3.9).unwrap(),
            spline.refined().unwrap(),
            spline.elevated_u(),
            spline.elevated_v().elevated_v(),
            spline.reversed_u().reversed_u(),
            spline.transposed().transposed(),
        ];
        for other in changed {
            for (u, v) in (0..=48).map(|k| (f64::from(k) / 12.0, f64::from((k * 7) % 49) / 12.0)) {
                assert!(spline.de_boor(u, v).distance(other.de_boor(u, v)) < 1e-12);
            }
        }
    }

    /// The box of every second derivative found by dense sampling lies in the bound, which closes in on it.
    #[test]
    fn second_derivatives_lie_in_their_bounds() {
        let surface = PolynomialSurface::spline(&spline()).unwrap();
        let parts = [((0.0, 2.5), (0.0, 4.0)), ((0.3, 0.4), (1.9, 2.1)), ((2.5, 4.0), (3.0, 3.01))];
        for (u, v) in parts {
            let SecondRange { uu, uv, vv } = surface.second_range(u, v).unwrap();
            for step in 0..400 {
                let part = |k: i32, n: i32| (f64::from(k % n) + 0.5) / f64::from(n);
                let place = (u.0 + (u.1 - u.0) * part(step, 20), v.0 + (v.1 - v.0) * part(step / 20, 20));
                let second = surface.second((place.0, Side::After), (place.1, Side::After));
                for (found, bound) in [(second.uu, uu), (second.uv, uv), (second.vv, vv)] {
                    let grown = DVec3::splat(1e-11);
                    assert!(found.cmpge(bound.min - grown).all() && found.cmple(bound.max + grown).all());
                }
            }
        }
        let fine = surface.second_range((0.3, 0.3001), (1.7, 1.7001)).unwrap();
        let here = surface.second((0.3, Side::After), (1.7, Side::After));
        assert!((fine.uu.center() - here.uu).length() < 1e-2 && fine.uu.diagonal() < 1e-2);
    }

    #[test]
    fn normals_at_collapsed_sides_are_limits() {
        // One side drawn together once and twice: a cone's tip and a paraboloid's.
        for depth in [1, 2] {
            let point = |i: usize, j: usize| {
                let radius = j.saturating_sub(depth - 1) as f64;
                let across = i as f64 - 1.5;
                DVec3::new(radius * across, -radius * radius, radius * 2.0 + 0.1 * radius * across * across)
            };
            let grid = Grid::from_fn(4, 4, point).unwrap();
            let surface = PolynomialSurface::bezier((3, 3), &grid, vec![0.0, 1.0], vec![0.0, 1.0]).unwrap();
            for step in 0..=10 {
                let u = f64::from(step) / 10.0;
                let near = surface.evaluate(u, 1e-5);
                let here = surface.evaluate(u, 0.0);
                assert!(here.normal.is_normalized());
                assert!(here.normal.distance(near.normal) < 2e-4, "{depth} {u}");
            }
        }
    }
}

//! Tensor-product surfaces of rational pieces: NURBS.

use glam::{DVec3, DVec4};
use thiserror::Error;

use super::patches::{Patches, PatchesError};
use super::polynomial::SAME;
use super::range::{self, projected};
use super::{Grid, TensorSpline, normal};
use crate::geometry::curve::control::product;
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{SecondJet, SecondRange, Surface, SurfaceJet};

/// Why homogeneous control points do not make a surface.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RationalError {
    /// Counts, degrees or parameters do not fit.
    #[error(transparent)]
    Patches(#[from] PatchesError),
    /// The sum of weights is not seen to be positive: the surface goes through infinity there, or near it.
    #[error("the weights are not positive for u from {} to {}, v from {} to {}", u.0, u.1, v.0, v.1)]
    Weights {
        /// The parameters of the piece along u.
        u: (f64, f64),
        /// The parameters of the piece along v.
        v: (f64, f64),
    },
}

/// Rational Bezier patches over a grid of parameters, joined at least without a gap. A control point is stored as
/// (w x, w y, w z, w); with w = 0 it is the direction (x, y, z), a point at infinity.
///
/// Cost: as [`PolynomialSurface`](super::PolynomialSurface), and a division for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct RationalSurface {
    patches: Patches<DVec4>,
    size: f64,
    joints: (Vec<f64>, Vec<f64>),
}

impl RationalSurface {
    /// A NURBS surface from its homogeneous control points.
    ///
    /// Single weights may be zero or less, but not what they add up to anywhere: this is proved, by hulls of the
    /// weights over ever smaller parts.
    ///
    /// # Errors
    /// When a degree is above [`MOST_DEGREE`](super::MOST_DEGREE), or the weights add up to zero or less somewhere.
    pub fn spline(spline: &TensorSpline<DVec4>) -> Result<Self, RationalError> {
        let (grid, breaks_u, breaks_v) = spline.to_bezier();
        Self::bezier((spline.u().degree(), spline.v().degree()), &grid, breaks_u, breaks_v)
    }

    /// Rational Bezier pieces from one grid, in which neighbors share their points.
    ///
    /// # Errors
    /// As [`RationalError`] says.
    pub fn bezier(
        degree: (usize, usize),
        control: &Grid<DVec4>,
        breaks_u: Vec<f64>,
        breaks_v: Vec<f64>,
    ) -> Result<Self, RationalError> {
        let patches = Patches::new(degree, control, breaks_u, breaks_v)?;
        check_weights(&patches)?;
        let joints = (joints(&patches), joints(&patches.transposed()));
        let mut surface = Self { patches, size: 0.0, joints };
        surface.size = surface.corners().diagonal();
        Ok(surface)
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

    /// The homogeneous Bezier points of the piece in a column and a row, row by row.
    #[must_use]
    pub fn piece(&self, column: usize, row: usize) -> &[DVec4] {
        self.patches.piece((column, row))
    }

    /// The box of the corners and middles of all pieces.
    fn corners(&self) -> Bounds {
        let (columns, rows) = self.patches.count();
        let pieces = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let places = pieces.flat_map(|piece| {
            let nine = (0..9).map(|k| (f64::from(k % 3) / 2.0, f64::from(k / 3) / 2.0));
            nine.map(move |local| (piece, local))
        });
        Bounds::of_points(places.map(|(piece, local)| self.local(piece, local)[0]))
    }

    #[inline]
    fn local(&self, piece: (usize, usize), local: (f64, f64)) -> [DVec3; 3] {
        projected(self.patches.jet(piece, local))
    }

    /// Second derivatives by local parameters.
    fn local_second(&self, piece: (usize, usize), local: (f64, f64)) -> SecondJet {
        let [a, a_u, a_v] = self.patches.jet(piece, local);
        let [point, du, dv] = projected([a, a_u, a_v]);
        let [a_uu, a_uv, a_vv] = self.patches.second(piece, local);
        let rest = |by: DVec4| by.truncate() - point * by.w;
        SecondJet {
            uu: (rest(a_uu) - du * (2.0 * a_u.w)) / a.w,
            uv: (rest(a_uv) - dv * a_u.w - du * a_v.w) / a.w,
            vv: (rest(a_vv) - dv * (2.0 * a_v.w)) / a.w,
        }
    }

    fn limit(&self, u: (f64, Side), v: (f64, Side), [_, du, dv]: [DVec3; 3]) -> DVec3 {
        let (piece, local) = self.patches.locate(u, v);
        let inside = |x: f64, y: f64| {
            let [_, du, dv] = self.local(piece, (x, y));
            (du, dv)
        };
        let second = self.local_second(piece, local);
        normal::at_limit((du, dv), &second, (u.1, v.1), local, self.size, inside)
    }
}

fn check_weights(patches: &Patches<DVec4>) -> Result<(), RationalError> {
    let (columns, rows) = patches.count();
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        let weights: Vec<f64> = patches.piece((column, row)).iter().map(|point| point.w).collect();
        if !range::positive(&weights, patches.degree().0 + 1) {
            let (u, v) = patches.breaks();
            return Err(RationalError::Weights { u: (u[column], u[column + 1]), v: (v[row], v[row + 1]) });
        }
    }
    Ok(())
}

/// Parameters of u, strictly inside, across which the first derivative jumps.
///
/// On the line between two columns A and w are the same from both sides, so the jump of `(A_u w - A w_u) / w^2` is
/// that of its numerator, a polynomial in v: it is looked at in Bernstein form.
fn joints(patches: &Patches<DVec4>) -> Vec<f64> {
    let (columns, rows) = patches.count();
    let degree = patches.degree().0 as f64;
    let jumps = |column: usize| {
        let (span_before, span_after) = (patches.spans((column - 1, 0)).0, patches.spans((column, 0)).0);
        let (mut jump, mut size) = (0.0_f64, 0.0_f64);
        for row in 0..rows {
            let (before, after) = patches.beside_u(column, row, 2);
            let slope = |one: &[DVec4], other: &[DVec4], scale: f64| -> Vec<DVec4> {
                one.iter().zip(other).map(|(one, other)| (*other - *one) * scale).collect()
            };
            let one = numerator(&after[0], &slope(&before[1], &before[0], degree / span_before));
            let other = numerator(&after[0], &slope(&after[0], &after[1], degree / span_after));
            for (one, other) in one.iter().zip(&other) {
                jump = jump.max(one.distance(*other));
                size = size.max(one.length()).max(other.length());
            }
        }
        jump > SAME * size
    };
    (1..columns).filter(|column| jumps(*column)).map(|column| patches.breaks().0[column]).collect()
}

/// A' w - A w' in Bernstein form.
fn numerator(line: &[DVec4], slope: &[DVec4]) -> Vec<DVec3> {
    let vectors = |points: &[DVec4]| points.iter().map(|point| point.truncate()).collect::<Vec<_>>();
    let weights = |points: &[DVec4]| points.iter().map(|point| point.w).collect::<Vec<_>>();
    let one = product(&vectors(slope), &weights(line));
    let other = product(&vectors(line), &weights(slope));
    one.iter().zip(&other).map(|(one, other)| *one - *other).collect()
}

impl Surface for RationalSurface {
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
        let jet = self.local(piece, local);
        let [point, du, dv] = jet;
        let normal = normal::regular(du, dv, self.size).unwrap_or_else(|| self.limit(u, v, jet));
        SurfaceJet { point, du: du * (1.0 / across), dv: dv * (1.0 / up), normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let (piece, local) = self.patches.locate(u, v);
        let (across, up) = self.patches.spans(piece);
        let SecondJet { uu, uv, vv } = self.local_second(piece, local);
        SecondJet { uu: uu / (across * across), uv: uv / (across * up), vv: vv / (up * up) }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let mut all: Option<SecondRange> = None;
        for part in self.patches.parts(u, v) {
            let range = range::second_range(&self.patches, &part)?;
            let range = range::scaled(&range, self.patches.spans(part.piece));
            all = Some(all.map_or(range, |all| range::union(&all, &range)));
        }
        all
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
    use glam::{DVec3, DVec4};

    use super::{RationalError, RationalSurface};
    use crate::geometry::curve::Side;
    use crate::geometry::curve::control::{BSpline, Knots};
    use crate::geometry::surface::tensor::{Grid, PolynomialSurface, TensorSpline, revolved};
    use crate::geometry::surface::{SecondRange, Surface};

    /// A control net that no symmetry hides behind, weights among them above and below 1.
    fn net() -> TensorSpline<DVec4> {
        let u = Knots::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.5, 1.5, 1.5, 3.0, 3.0, 3.0, 3.0]).unwrap();
        let v = Knots::clamped(2, 5).unwrap();
        let point = |i: usize, j: usize| {
            let weight = [1.0, 0.4, 2.5, 0.8][(i + 2 * j) % 4];
            let height = ((i * i * 7 + j * 5 + i * j) % 11) as f64 * 0.2;
            DVec3::new(i as f64, height, -(j as f64)).extend(1.0) * weight
        };
        TensorSpline::new(u, v, Grid::from_fn(8, 5, point).unwrap()).unwrap()
    }

    fn places() -> impl Iterator<Item = (f64, f64)> {
        (0..300).map(|k| (3.0 * (f64::from(k % 20) + 0.5) / 20.0, 3.0 * (f64::from(k / 20) + 0.5) / 15.0))
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let surface = RationalSurface::spline(&net()).unwrap();
        let step = 1e-5;
        for (u, v) in places().filter(|(u, _)| (u - 1.5).abs() > 1e-3) {
            let at = |u: f64, v: f64| surface.evaluate(u, v);
            let jet = at(u, v);
            let second = surface.second((u, Side::After), (v, Side::After));
            let by_u = (at(u + step, v).point - at(u - step, v).point) / (2.0 * step);
            let by_v = (at(u, v + step).point - at(u, v - step).point) / (2.0 * step);
            assert!(by_u.distance(jet.du) < 1e-7 * (1.0 + jet.du.length()));
            assert!(by_v.distance(jet.dv) < 1e-7 * (1.0 + jet.dv.length()));
            let twice_u = (at(u + step, v).du - at(u - step, v).du) / (2.0 * step);
            let mixed = (at(u, v + step).du - at(u, v - step).du) / (2.0 * step);
            let twice_v = (at(u, v + step).dv - at(u, v - step).dv) / (2.0 * step);
            for (found, expected) in [(twice_u, second.uu), (mixed, second.uv), (twice_v, second.vv)] {
                assert!(found.distance(expected) < 1e-5 * (10.0 + expected.length()), "{u} {v}");
            }
        }
    }

    #[test]
    fn second_derivatives_lie_in_their_bounds() {
        let surface = RationalSurface::spline(&net()).unwrap();
        for (u, v) in [((0.0, 1.5), (0.0, 3.0)), ((0.1, 0.2), (1.9, 2.1)), ((1.5, 3.0), (2.0, 2.5))] {
            let SecondRange { uu, uv, vv } = surface.second_range(u, v).unwrap();
            for (x, y) in places().map(|(x, y)| (x / 3.0, y / 3.0)) {
                let place = (u.0 + (u.1 - u.0) * x, v.0 + (v.1 - v.0) * y);
                let second = surface.second((place.0, Side::After), (place.1, Side::After));
                for (found, bound) in [(second.uu, uu), (second.uv, uv), (second.vv, vv)] {
                    let grown = DVec3::splat(1e-10);
                    assert!(found.cmpge(bound.min - grown).all() && found.cmple(bound.max + grown).all());
                }
            }
        }
    }

    /// On a small part the bound is little more than what is there.
    #[test]
    fn bounds_close_in() {
        let surface = RationalSurface::spline(&net()).unwrap();
        let here = surface.second((0.7, Side::After), (1.2, Side::After));
        let mut last = f64::INFINITY;
        for step in [0.1, 0.01, 0.001] {
            let range = surface.second_range((0.7, 0.7 + step), (1.2, 1.2 + step)).unwrap();
            let loose = range.uu.diagonal() + range.uv.diagonal() + range.vv.diagonal();
            assert!(loose < 0.15 * last, "{loose} after {last}");
            last = loose;
        }
        assert!(last < 0.05 * (here.uu.length() + here.uv.length() + here.vv.length()));
    }

    #[test]
    fn equal_weights_are_the_polynomial_surface() {
        let (u, v) = (net().u().clone(), net().v().clone());
        let plain = net().control().map(|point| point.truncate() / point.w);
        let heavy = TensorSpline::new(u.clone(), v.clone(), plain.map(|p| (p * 3.0).extend(3.0))).unwrap();
        let rational = RationalSurface::spline(&heavy).unwrap();
        let polynomial = PolynomialSurface::spline(&TensorSpline::new(u, v, plain).unwrap()).unwrap();
        for (u, v) in places() {
            let (one, other) = (rational.evaluate(u, v), polynomial.evaluate(u, v));
            assert!(one.point.distance(other.point) < 1e-13);
            assert!(one.du.distance(other.du) < 1e-12 && one.dv.distance(other.dv) < 1e-12);
        }
        assert_eq!(rational.joints_u(), polynomial.joints_u());
    }

    /// The parameters of a rational surface may run unevenly while its shape is smooth: where weights differ
    /// across a double knot the speed jumps in homogeneous coordinates alone.
    #[test]
    fn a_circle_of_four_arcs_has_no_joint() {
        let meridian = BSpline::new(
            Knots::clamped(1, 2).unwrap(),
            vec![DVec4::new(2.0, 0.0, 0.0, 1.0), DVec4::new(2.0, 1.0, 0.0, 1.0)],
        );
        let spline = revolved(&meridian.unwrap(), 0.0, 360.0);
        let surface = RationalSurface::spline(&spline).unwrap();
        assert!(surface.joints_u().is_empty() && surface.joints_v().is_empty());
    }

    /// A full circle from control points two of which are at infinity.
    #[test]
    fn points_at_infinity_make_exact_circles() {
        let circle = [(1.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 1.0)];
        let row = |z: f64| circle.map(|(x, y, w)| DVec4::new(x, y, z * w, w)).to_vec();
        let knots = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
        let grid = Grid::of_rows(vec![row(0.0), row(2.0)]).unwrap();
        let spline = TensorSpline::new(knots, Knots::clamped(1, 2).unwrap(), grid).unwrap();
        let surface = RationalSurface::spline(&spline).unwrap();
        for k in 0..=64 {
            let point = surface.evaluate(f64::from(k) / 32.0, 0.7).point;
            assert!(
                (point.truncate().length() - 1.0).abs() < 1e-15 * 4.0 && (point.z - 1.4).abs() < 1e-15 * 4.0
            );
        }
        assert!(surface.second_range((0.0, 1.0), (0.0, 1.0)).is_some());
    }

    #[test]
    fn surfaces_through_infinity_are_refused() {
        let weights = [[1.0, 1.0], [-1.0, 1.0]];
        let grid =
            Grid::from_fn(2, 2, |i, j| DVec3::new(i as f64, j as f64, 0.0).extend(1.0) * weights[j][i]);
        let line = Knots::clamped(1, 2).unwrap();
        let spline = TensorSpline::new(line.clone(), line, grid.unwrap()).unwrap();
        let refused = RationalSurface::spline(&spline);
        assert_eq!(refused, Err(RationalError::Weights { u: (0.0, 1.0), v: (0.0, 1.0) }));
    }
}

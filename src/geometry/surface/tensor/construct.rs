//! NURBS surfaces from NURBS curves, exact: moved, turned, swept, ruled.
//!
//! Curves and surfaces are in homogeneous coordinates (w x, w y, w z, w). A motion whose matrices are a B-spline
//! moves a curve through a tensor product: M(v) P(u) has the control points `M[j] P[i]`. Moving along a curve and
//! turning about an axis are such motions.
//!
//! Sources: L. Piegl, W. Tiller, The NURBS Book, 2nd ed. 1997, 8.3 to 8.5 and 10.4; B. Juettler, M. Wagner,
//! Computer-aided design with spatial rational B-spline motions, J. Mech. Design 118 (1996).

use glam::{DMat4, DVec3, DVec4};
use thiserror::Error;

use super::{Grid, TensorSpline};
use crate::geometry::curve::control::{BSpline, KnotError, Knots, elevate, split};
use crate::geometry::number::{floor_count, sin_cos_degrees};

/// Why a motion cannot be made of maps.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ConstructError {
    /// There is not one map for each basis function.
    #[error("{maps} maps do not fit knots for {expected}")]
    Count {
        /// Maps given.
        maps: usize,
        /// Maps that the knots ask for.
        expected: usize,
    },
    /// Two curves cannot be brought to the same knots.
    #[error(transparent)]
    Knots(#[from] KnotError),
}

/// A motion by maps of homogeneous coordinates that are a B-spline of v.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    knots: Knots,
    maps: Vec<DMat4>,
}

impl Motion {
    /// One map for each basis function.
    ///
    /// # Errors
    /// When the counts differ.
    pub fn new(knots: Knots, maps: Vec<DMat4>) -> Result<Self, ConstructError> {
        if maps.len() != knots.points() {
            return Err(ConstructError::Count { maps: maps.len(), expected: knots.points() });
        }
        Ok(Self { knots, maps })
    }

    /// Without turning, as a point moves along a curve; things start where they are.
    #[must_use]
    pub fn along(path: &BSpline<DVec4>) -> Self {
        let start = path.de_boor(path.knots().domain().0);
        let start = start.truncate() / start.w;
        let map = |point: &DVec4| {
            let offset = point.truncate() - start * point.w;
            let mut map = DMat4::from_diagonal(DVec4::splat(point.w));
            map.w_axis = offset.extend(point.w);
            map
        };
        Self { knots: path.knots().clone(), maps: path.points().iter().map(map).collect() }
    }

    /// About the y axis, from `start` by `angle` degrees (at most a full turn), +x going toward -z: arcs of at most
    /// 90 degrees, between whose ends the speed is not quite even. The parameter is the angle at the ends of arcs.
    #[must_use]
    pub fn about_y(start: f64, angle: f64) -> Self {
        let arcs = floor_count((angle.abs() / 90.0 - 1e-9).ceil().clamp(1.0, 4.0));
        let step = angle / f64::from(arcs);
        let at =
            |half: u32| if half == 2 * arcs { start + angle } else { start + step * f64::from(half) / 2.0 };
        let (_, cos_half) = sin_cos_degrees(step / 2.0);
        let map = |half: u32| {
            let (sin, cos) = sin_cos_degrees(at(half));
            // Between two ends stands the corner of their tangents, with the cosine of half the step for weight.
            let weight = if half.is_multiple_of(2) { 1.0 } else { cos_half };
            DMat4::from_cols(
                DVec4::new(cos, 0.0, -sin, 0.0),
                DVec4::new(0.0, weight, 0.0, 0.0),
                DVec4::new(sin, 0.0, cos, 0.0),
                DVec4::new(0.0, 0.0, 0.0, weight),
            )
        };
        let breaks: Vec<f64> = (0..=arcs).map(|arc| at(2 * arc)).collect();
        let (breaks, maps) = if step < 0.0 {
            (breaks.iter().map(|angle| -angle).collect(), (0..=2 * arcs).map(map).collect())
        } else {
            (breaks, (0..=2 * arcs).map(map).collect())
        };
        Self { knots: piecewise(2, &breaks), maps }
    }

    /// Knots of the motion.
    #[must_use]
    pub fn knots(&self) -> &Knots {
        &self.knots
    }
}

/// Knots of Bezier pieces: full multiplicity everywhere.
fn piecewise(degree: usize, breaks: &[f64]) -> Knots {
    let last = breaks.len() - 1;
    let times = |k: usize| degree + usize::from(k == 0 || k == last);
    let values = breaks.iter().enumerate().flat_map(|(k, knot)| std::iter::repeat_n(*knot, times(k)));
    Knots::new(degree, values.collect()).expect("increasing breaks at full multiplicity are knots")
}

/// The surface that a motion sweeps with a curve: u runs along the motion, v along the curve.
#[must_use]
pub fn swept(profile: &BSpline<DVec4>, motion: &Motion) -> TensorSpline<DVec4> {
    let (columns, rows) = (motion.maps.len(), profile.points().len());
    let grid = Grid::from_fn(columns, rows, |i, j| motion.maps[i] * profile.points()[j]);
    let grid = grid.expect("curves and motions have control points");
    TensorSpline::new(motion.knots.clone(), profile.knots().clone(), grid)
        .expect("a control point for each pair of basis functions")
}

/// P(v) + Q(u) - Q(0): `profile` moved along `path`. u runs along the path, v along the profile.
#[must_use]
pub fn translational(profile: &BSpline<DVec4>, path: &BSpline<DVec4>) -> TensorSpline<DVec4> {
    swept(profile, &Motion::along(path))
}

/// A curve turned about the y axis from `start` by `angle` degrees; u runs around, v along the curve.
#[must_use]
pub fn revolved(profile: &BSpline<DVec4>, start: f64, angle: f64) -> TensorSpline<DVec4> {
    swept(profile, &Motion::about_y(start, angle))
}

/// Straight lines between points of equal parameter share: u runs along the curves, v from the first (0) to the
/// second (1). Where the weights of the two differ the lines are the same, but are run through unevenly.
///
/// # Errors
/// When knots of the two curves fall so close together that they cannot be told apart.
pub fn ruled(from: &BSpline<DVec4>, to: &BSpline<DVec4>) -> Result<TensorSpline<DVec4>, ConstructError> {
    let (from, to) = compatible(from, to)?;
    let rows = vec![from.points().to_vec(), to.points().to_vec()];
    let grid = Grid::of_rows(rows).expect("equal knots have equally many points");
    let across = Knots::clamped(1, 2).expect("two points make a line");
    Ok(TensorSpline::new(from.knots().clone(), across, grid).expect("counts were made equal"))
}

/// Two curves in one form: the degree of the higher, the domain of the first, the knots of both.
fn compatible(
    one: &BSpline<DVec4>,
    other: &BSpline<DVec4>,
) -> Result<(BSpline<DVec4>, BSpline<DVec4>), KnotError> {
    if one.knots() == other.knots() {
        return Ok((one.clone(), other.clone()));
    }
    let (mut one, mut other) = (Pieced::new(one), Pieced::new(other));
    let (start, end) = (one.breaks[0], one.breaks[one.breaks.len() - 1]);
    other.spread(start, end);
    let degree = one.degree().max(other.degree());
    one.raise(degree);
    other.raise(degree);
    for t in other.breaks.clone() {
        one.cut(t);
    }
    for t in one.breaks.clone() {
        other.cut(t);
    }
    // What differs by rounding alone is one break.
    other.breaks.clone_from(&one.breaks);
    Ok((one.joined()?, other.joined()?))
}

/// A curve as its Bezier pieces.
struct Pieced {
    pieces: Vec<Vec<DVec4>>,
    breaks: Vec<f64>,
}

/// Breaks nearer to each other than this share of the domain are one.
const SAME_BREAK: f64 = 1e-9;

impl Pieced {
    fn new(curve: &BSpline<DVec4>) -> Self {
        let (points, breaks) = curve.to_bezier();
        let degree = curve.knots().degree();
        let pieces = (0..breaks.len() - 1).map(|k| points[k * degree..=(k + 1) * degree].to_vec()).collect();
        Self { pieces, breaks }
    }

    fn degree(&self) -> usize {
        self.pieces[0].len() - 1
    }

    /// Maps the domain.
    fn spread(&mut self, start: f64, end: f64) {
        let (first, last) = (self.breaks[0], self.breaks[self.breaks.len() - 1]);
        for t in &mut self.breaks {
            let share = (*t - first) / (last - first);
            *t = start * (1.0 - share) + end * share;
        }
    }

    fn raise(&mut self, degree: usize) {
        for piece in &mut self.pieces {
            while piece.len() <= degree {
                *piece = elevate(piece);
            }
        }
    }

    /// Begins a piece at `t`, unless one does nearly there.
    fn cut(&mut self, t: f64) {
        let near = SAME_BREAK * (self.breaks[self.breaks.len() - 1] - self.breaks[0]);
        if self.breaks.iter().any(|known| (known - t).abs() <= near) {
            return;
        }
        let index = self.breaks.partition_point(|known| *known < t) - 1;
        let (start, end) = (self.breaks[index], self.breaks[index + 1]);
        let (before, after) = split(&self.pieces[index], (t - start) / (end - start));
        self.pieces.splice(index..=index, [before, after]);
        self.breaks.insert(index + 1, t);
    }

    fn joined(&self) -> Result<BSpline<DVec4>, KnotError> {
        let mut points = vec![self.pieces[0][0]];
        points.extend(self.pieces.iter().flat_map(|piece| piece[1..].iter().copied()));
        BSpline::from_bezier(self.degree(), points, &self.breaks)
    }
}

/// A point of weight 1.
#[must_use]
pub fn plain(point: DVec3) -> DVec4 {
    point.extend(1.0)
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3, DVec4};

    use super::{Motion, plain, revolved, ruled, swept, translational};
    use crate::geometry::curve::control::{BSpline, Knots};
    use crate::geometry::number::sin_cos_degrees;
    use crate::geometry::surface::tensor::TensorSpline;

    fn curve(degree: usize, weights: &[f64]) -> BSpline<DVec4> {
        let point = |k: usize| {
            let height = ((k * k * 5 + k * 3 + 2) % 7) as f64 * 0.4;
            plain(DVec3::new(1.0 + 0.3 * k as f64, height, 0.2 * height)) * weights[k]
        };
        let knots = Knots::clamped(degree, weights.len()).unwrap();
        BSpline::new(knots, (0..weights.len()).map(point).collect()).unwrap()
    }

    fn at(curve: &BSpline<DVec4>, share: f64) -> DVec3 {
        let (start, end) = curve.knots().domain();
        let point = curve.de_boor(start + (end - start) * share);
        point.truncate() / point.w
    }

    fn on(surface: &TensorSpline<DVec4>, x: f64, y: f64) -> DVec3 {
        let ((u0, u1), (v0, v1)) = (surface.u().domain(), surface.v().domain());
        let point = surface.de_boor(u0 + (u1 - u0) * x, v0 + (v1 - v0) * y);
        point.truncate() / point.w
    }

    fn shares() -> impl Iterator<Item = (f64, f64)> {
        (0..=99).map(|k| (f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0))
    }

    #[test]
    fn moved_curves_are_sums() {
        let (profile, path) = (curve(3, &[1.0, 0.5, 2.0, 1.5, 1.0]), curve(2, &[1.0, 3.0, 0.4, 1.0]));
        let surface = translational(&profile, &path);
        for (x, y) in shares() {
            let expected = at(&profile, y) + at(&path, x) - at(&path, 0.0);
            assert!(on(&surface, x, y).distance(expected) < 1e-13);
        }
    }

    #[test]
    fn turned_curves_keep_height_and_radius() {
        let profile = curve(2, &[1.0, 0.5, 2.0, 1.0]);
        for (start, angle) in [(0.0, 360.0), (30.0, 45.0), (-20.0, 200.0), (0.0, -270.0)] {
            let surface = revolved(&profile, start, angle);
            for (x, y) in shares() {
                let (point, still) = (on(&surface, x, y), at(&profile, y));
                assert!((point.y - still.y).abs() < 1e-14);
                let radius = |p: DVec3| DVec3::new(p.x, 0.0, p.z).length();
                assert!((radius(point) - radius(still)).abs() < 1e-14 * 4.0);
            }
            for (x, turn) in [(0.0, start), (1.0, start + angle), (0.5, start + angle / 2.0)] {
                let (sin, cos) = sin_cos_degrees(turn);
                let p = at(&profile, 0.3);
                let expected = DVec3::new(p.x * cos + p.z * sin, p.y, p.z * cos - p.x * sin);
                assert!(on(&surface, x, 0.3).distance(expected) < 1e-13, "{start} {angle} {x}");
            }
        }
    }

    #[test]
    fn a_full_turn_closes_to_the_bit() {
        let surface = revolved(&curve(2, &[1.0, 0.5, 2.0, 1.0]), 0.0, 360.0);
        for row in 0..surface.control().rows() {
            let points = surface.control().row(row);
            assert_eq!(points[0], points[points.len() - 1]);
        }
    }

    #[test]
    fn rulings_are_straight_and_join_equal_shares() {
        let pairs = [
            (curve(3, &[1.0, 0.5, 2.0, 1.5, 1.0]), curve(1, &[1.0, 2.0, 1.0])),
            (curve(2, &[1.0, 1.0, 1.0, 1.0, 1.0]), curve(2, &[1.0, 4.0, 1.0])),
        ];
        for (from, to) in pairs {
            // Away from each other, so that every line has a length.
            let moved = to.points().iter().map(|point| *point + DVec4::Z * (3.0 * point.w)).collect();
            let to = BSpline::new(to.knots().clone(), moved).unwrap();
            let surface = ruled(&from, &to).unwrap();
            for (x, y) in shares() {
                let (a, b) = (at(&from, x), at(&to, x));
                assert!(on(&surface, x, 0.0).distance(a) < 1e-13 && on(&surface, x, 1.0).distance(b) < 1e-13);
                let (point, along) = (on(&surface, x, y), (b - a).normalize());
                assert!((point - a).cross(along).length() < 1e-13);
            }
        }
    }

    /// A motion that grows while it moves: an exact sweep with a changing profile.
    #[test]
    fn any_spline_of_maps_sweeps() {
        let profile = curve(2, &[1.0, 0.5, 2.0, 1.0]);
        let maps = [1.0, 1.5, 0.5]
            .map(|size| DMat4::from_translation(DVec3::Z * size) * DMat4::from_scale(DVec3::splat(size)));
        let motion = Motion::new(Knots::clamped(2, 3).unwrap(), maps.to_vec()).unwrap();
        let surface = swept(&profile, &motion);
        for (x, y) in shares() {
            let size = (1.0 - x) * (1.0 - x) + 3.0 * x * (1.0 - x) + 0.5 * x * x;
            let expected = at(&profile, y) * size + DVec3::Z * size;
            assert!(on(&surface, x, y).distance(expected) < 1e-13);
        }
        assert!(Motion::new(Knots::clamped(2, 4).unwrap(), maps.to_vec()).is_err());
    }
}

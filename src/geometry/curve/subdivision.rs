//! Subdivision curves: polygons that are refined again and again.
//!
//! Sources: G. Chaikin, An algorithm for high-speed curve generation, 1974; R. Riesenfeld, On Chaikin's algorithm,
//! 1975 (its limit is the uniform quadratic B-spline); J. Lane, R. Riesenfeld, A theoretical development for the
//! computer generation and display of piecewise polynomial surfaces, IEEE PAMI 2 (1980) (the three-point scheme,
//! whose limit is the uniform cubic B-spline); N. Dyn, D. Levin, J. Gregory, A 4-point interpolatory subdivision
//! scheme for curve design, CAGD 4 (1987).

use glam::DVec3;

use super::control::{BSpline, KnotError, Knots};
use super::{BezierError, BezierSpline};

/// How a polygon is refined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// Corners are cut at the quarters of the edges.
    Chaikin,
    /// Points stay; a new one between each two lies off the middle of its edge by the tension times what its
    /// neighbours bend.
    FourPoint {
        /// 1/16 reproduces cubics; 0 is the polygon.
        tension: f64,
    },
    /// Middles of edges, and points moved to 1/8, 6/8, 1/8 of themselves and their neighbours.
    ThreePoint,
}

/// What happens where a polygon ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// There is no end.
    Closed,
    /// The polygon is continued by reflection in its end, `p[-1] = 2 p[0] - p[1]`; the curve runs from the first
    /// point to the last.
    Reflect,
    /// Only what the given points determine is kept, so that the curve ends before they do.
    Cut,
}

/// The fewest points that a scheme can refine.
#[must_use]
pub fn fewest(scheme: Scheme, border: Border) -> usize {
    match (border, scheme) {
        (Border::Closed, _) => 3,
        (Border::Reflect, _) => 2,
        (Border::Cut, Scheme::Chaikin) => 3,
        (Border::Cut, Scheme::ThreePoint) => 4,
        (Border::Cut, Scheme::FourPoint { .. }) => 6,
    }
}

/// The points after `levels` refinements; at least [`fewest`] are needed. Cost: the number of points that result,
/// about 2^levels times those given.
#[must_use]
pub fn refine(points: &[DVec3], scheme: Scheme, border: Border, levels: u32) -> Vec<DVec3> {
    let mut polygon = points.to_vec();
    if levels == 0 || points.len() < fewest(scheme, border) {
        return polygon;
    }
    let count = polygon.len();
    let ends = (polygon[0], polygon[count - 1]);
    let reflected = border == Border::Reflect;
    if scheme == Scheme::Chaikin && reflected {
        // The continued polygon; what lies beyond the ends is its own reflection at every level.
        polygon.insert(0, ends.0 * 2.0 - polygon[1]);
        polygon.push(ends.1 * 2.0 - polygon[count - 1]);
    }
    for level in 0..levels {
        polygon = match scheme {
            Scheme::Chaikin => {
                let cut = chaikin(&polygon, border == Border::Closed);
                if reflected && level == 0 { cut[1..cut.len() - 1].to_vec() } else { cut }
            }
            Scheme::ThreePoint => three_point(&polygon, border),
            Scheme::FourPoint { tension } => four_point(&polygon, tension, border),
        };
    }
    if scheme == Scheme::Chaikin && reflected {
        let last = polygon.len() - 1;
        (polygon[0], polygon[last]) = ends;
    }
    polygon
}

fn chaikin(p: &[DVec3], closed: bool) -> Vec<DVec3> {
    let count = p.len();
    let edges = if closed { count } else { count - 1 };
    let cut = |k: usize| {
        let (a, b) = (p[k], p[(k + 1) % count]);
        [a * 0.75 + b * 0.25, a * 0.25 + b * 0.75]
    };
    (0..edges).flat_map(cut).collect()
}

fn three_point(p: &[DVec3], border: Border) -> Vec<DVec3> {
    let count = p.len();
    let middle = |k: usize| (p[k] + p[(k + 1) % count]) * 0.5;
    let moved = |k: usize| match (border, k) {
        // The neighbours of an end are each other's reflection.
        (Border::Reflect, _) if k == 0 || k == count - 1 => p[k],
        _ => (p[(k + count - 1) % count] + p[(k + 1) % count]) * 0.125 + p[k] * 0.75,
    };
    match border {
        Border::Closed => (0..count).flat_map(|k| [moved(k), middle(k)]).collect(),
        Border::Reflect => {
            let inner = (0..count - 1).flat_map(|k| [moved(k), middle(k)]);
            inner.chain(std::iter::once(p[count - 1])).collect()
        }
        Border::Cut => {
            let inner = (1..count - 1).flat_map(|k| [moved(k), middle(k)]);
            std::iter::once(middle(0)).chain(inner).collect()
        }
    }
}

fn four_point(p: &[DVec3], tension: f64, border: Border) -> Vec<DVec3> {
    let at = |k: isize| continued(p, k, border);
    let between = |k: isize| (at(k) + at(k + 1)) * (0.5 + tension) - (at(k - 1) + at(k + 2)) * tension;
    let count = p.len().cast_signed();
    match border {
        Border::Closed => (0..count).flat_map(|k| [at(k), between(k)]).collect(),
        Border::Reflect => {
            let inner = (0..count - 1).flat_map(|k| [at(k), between(k)]);
            inner.chain(std::iter::once(at(count - 1))).collect()
        }
        Border::Cut => {
            let inner = (1..count - 2).flat_map(|k| [at(k), between(k)]);
            inner.chain(std::iter::once(at(count - 2))).collect()
        }
    }
}

/// The point of a number, beyond the ends too: around a closed polygon, reflected at the ends of an open one.
pub(super) fn continued(p: &[DVec3], k: isize, border: Border) -> DVec3 {
    let last = p.len().cast_signed() - 1;
    if border == Border::Closed {
        return p[k.rem_euclid(last + 1).cast_unsigned()];
    }
    if k < 0 {
        return p[0] * 2.0 - continued(p, -k, border);
    }
    if k > last {
        return p[p.len() - 1] * 2.0 - continued(p, 2 * last - k, border);
    }
    p[k.cast_unsigned()]
}

/// The limit of Chaikin's scheme: quadratic pieces, C1. Parameter k + 1/2 of an open reflected curve stands in the
/// middle between points k and k + 1, and the domain runs from 0 to the number of edges; of the others parameter k
/// does, counted from the first edge.
///
/// # Errors
/// When there are fewer than [`fewest`] points.
pub fn chaikin_limit(points: &[DVec3], border: Border) -> Result<BezierSpline, BezierError> {
    let count = points.len();
    if count < fewest(Scheme::Chaikin, border) {
        return Err(BezierError::Count { points: count, degree: 2 });
    }
    if border != Border::Reflect {
        return uniform_limit(2, points, border);
    }
    let middle = |k: usize| (points[k] + points[k + 1]) * 0.5;
    // The curve begins straight: its first two edges are one line.
    let mut control = vec![points[0], (points[0] + middle(0)) * 0.5, middle(0)];
    let mut knots = vec![0.0, 0.5];
    for (k, corner) in points.iter().enumerate().take(count - 1).skip(1) {
        control.extend([*corner, middle(k)]);
        knots.push(k as f64 + 0.5);
    }
    control.extend([(middle(count - 2) + points[count - 1]) * 0.5, points[count - 1]]);
    knots.push((count - 1) as f64);
    BezierSpline::with_knots(2, control, knots)
}

/// The limit of the three-point scheme: cubic pieces, C2. Parameter k stands near point k; of a cut curve, near
/// point k + 1.
///
/// # Errors
/// When there are fewer than [`fewest`] points.
pub fn three_point_limit(points: &[DVec3], border: Border) -> Result<BezierSpline, BezierError> {
    let count = points.len();
    if count < fewest(Scheme::ThreePoint, border) {
        return Err(BezierError::Count { points: count, degree: 3 });
    }
    if border != Border::Reflect {
        let mut turned = points.to_vec();
        turned.rotate_right(usize::from(border == Border::Closed));
        return uniform_limit(3, &turned, border);
    }
    let continued = (-1..=count.cast_signed()).map(|k| continued(points, k, border)).collect::<Vec<_>>();
    let spline = uniform_limit(3, &continued, Border::Cut)?;
    let (mut control, knots) = (spline.control_points().to_vec(), spline.knots().to_vec());
    let end = control.len() - 1;
    (control[0], control[end]) = (points[0], points[count - 1]);
    BezierSpline::with_knots(3, control, knots)
}

/// The uniform B-spline of control points over 0, 1, 2, ...
fn uniform_limit(degree: usize, points: &[DVec3], border: Border) -> Result<BezierSpline, BezierError> {
    let count = points.len();
    let even = |from: isize, to: usize| (from..=to.cast_signed()).map(|k| k as f64).collect::<Vec<_>>();
    let misfit = |_: KnotError| BezierError::Count { points: count, degree };
    let spline = if border == Border::Closed {
        BSpline::closed(degree, points, &even(0, count)).map_err(misfit)?
    } else {
        let knots = Knots::new(degree, even(-degree.cast_signed(), count)).map_err(misfit)?;
        BSpline::new(knots, points.to_vec()).ok_or(BezierError::Count { points: count, degree })?
    };
    let (control, knots) = spline.to_bezier();
    BezierSpline::with_knots(degree, control, knots)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Border, Scheme, chaikin_limit, fewest, refine, three_point_limit};
    use crate::geometry::curve::{Curve, Side, nearest_within};

    fn points() -> Vec<DVec3> {
        [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (2.2, 2.5), (0.7, 2.2), (-0.6, 1.4)]
            .map(|(x, y)| DVec3::new(x, y, 0.3 * x))
            .to_vec()
    }

    const BORDERS: [Border; 3] = [Border::Closed, Border::Reflect, Border::Cut];

    /// Control points come to the curve with a quarter of the distance at each level.
    #[test]
    fn refined_polygons_tend_to_the_limits() {
        for border in BORDERS {
            for scheme in [Scheme::Chaikin, Scheme::ThreePoint] {
                let limit = match scheme {
                    Scheme::Chaikin => chaikin_limit(&points(), border).unwrap(),
                    _ => three_point_limit(&points(), border).unwrap(),
                };
                let distance = |levels: u32| {
                    let fine = refine(&points(), scheme, border, levels);
                    let domain = limit.domain();
                    let of = |point: &DVec3| {
                        let pieces = (0..24).map(|k| {
                            let (from, to) =
                                (domain.at(f64::from(k) / 24.0), domain.at(f64::from(k + 1) / 24.0));
                            nearest_within(&limit, *point, from, to).0
                        });
                        pieces.fold(f64::INFINITY, f64::min)
                    };
                    // The ends of a cut polygon lie beyond the curve, by half an edge.
                    let beyond = usize::from(border == Border::Cut);
                    fine[beyond..fine.len() - beyond].iter().map(of).fold(0.0, f64::max)
                };
                let (coarse, fine) = (distance(2), distance(5));
                assert!(fine < coarse / 50.0, "{scheme:?} {border:?}: {coarse} {fine}");
                assert!(limit.joints().is_empty());
            }
        }
    }

    #[test]
    fn reflected_curves_keep_their_ends_and_cut_ones_lose_them() {
        let p = points();
        for scheme in [Scheme::Chaikin, Scheme::ThreePoint, Scheme::FourPoint { tension: 0.07 }] {
            for levels in 1..5 {
                let fine = refine(&p, scheme, Border::Reflect, levels);
                assert_eq!((fine[0], fine[fine.len() - 1]), (p[0], p[5]), "{scheme:?}");
                // Reflection repeats at each level: the polygon continues through the end.
                let more = refine(&p, scheme, Border::Cut, levels);
                assert!(more[0].distance(p[0]) > 0.1 && more[more.len() - 1].distance(p[5]) > 0.1);
            }
        }
        for (curve, ends) in [chaikin_limit, three_point_limit]
            .map(|of| of(&p, Border::Reflect).unwrap())
            .iter()
            .zip([5.0, 5.0])
        {
            assert_eq!(curve.domain().end, ends);
            assert_eq!((curve.point(0.0), curve.evaluate(ends, Side::Before).point), (p[0], p[5]));
            assert!(curve.evaluate(0.0, Side::After).second.length() < 1e-14);
        }
    }

    #[test]
    fn four_points_reproduce_cubics() {
        let cubic = |t: f64| DVec3::new(t, t * t - 2.0 * t, t * t * t);
        let p: Vec<DVec3> = (0..8).map(|k| cubic(f64::from(k))).collect();
        let fine = refine(&p, Scheme::FourPoint { tension: 1.0 / 16.0 }, Border::Cut, 3);
        assert_eq!(fine.len(), 8 * (8 - 5) + 5);
        for point in fine {
            assert!(point.distance(cubic(point.x)) < 1e-12);
        }
    }

    #[test]
    fn too_few_points_are_refused() {
        for border in BORDERS {
            let least = fewest(Scheme::Chaikin, border);
            assert!(chaikin_limit(&points()[..least - 1], border).is_err());
            assert!(chaikin_limit(&points()[..least], border).is_ok());
            let least = fewest(Scheme::ThreePoint, border);
            assert!(three_point_limit(&points()[..least - 1], border).is_err());
            assert!(three_point_limit(&points()[..least], border).is_ok());
        }
    }
}

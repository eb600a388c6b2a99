//! Curves into lines.

use super::discretize::{Density, discretize};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError};
use crate::geometry::curve::{AnyCurve, Curve as _};
use crate::geometry::mesh::{Anchor, Color, Wire, WirePoint, index};

/// Cuts curves into chains of segments, one strand of origin 0 for each; those that are closed return to their start.
/// The points of polylines are kept as they are. Anchor source k is curve k. The bound is proved.
///
/// # Errors
/// When there would be more segments than triangles are allowed.
pub fn wire(curves: &[AnyCurve], detail: &Detail) -> Result<(Wire, Deviation), TessellateError> {
    let mut made = Wire::default();
    let mut bound = 0.0_f64;
    for (source, curve) in (0..).zip(curves) {
        let density = match detail.density {
            SurfaceDensity::Tolerance(tolerance) => Density::Tolerance(tolerance),
            SurfaceDensity::Grid { u, .. } => Density::Count(u.max(if curve.is_closed() { 3 } else { 1 })),
        };
        let left = detail.triangle_limit.saturating_sub(u64::from(index(made.points.len())));
        let stations = discretize(curve, density, left)?;
        bound = stations.iter().map(|station| station.deviation).fold(bound, f64::max);
        let used = stations.len() - usize::from(curve.is_closed());
        let points = stations[..used].iter().map(|station| WirePoint {
            position: station.point,
            color: Color::WHITE,
            anchor: Anchor { source, u: station.t, v: 0.0 },
        });
        made.push(points, curve.is_closed(), 0);
    }
    let evidence = if bound == 0.0 { Evidence::Exact } else { Evidence::Proved };
    Ok((made, Deviation { bound, evidence }))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::wire;
    use crate::geometry::curve::{AnyCurve, EllipseArc, Polyline};
    use crate::geometry::tessellate::{Detail, Evidence, SurfaceDensity, TessellateError};

    fn detail(tolerance: f64, triangle_limit: u64) -> Detail {
        Detail {
            density: SurfaceDensity::Tolerance(tolerance),
            crease_angle: 30.0,
            uv: false,
            triangle_limit,
        }
    }

    #[test]
    fn polylines_are_exact_and_circles_close() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::ONE].to_vec();
        let line = AnyCurve::Polyline(Polyline::new(corners.clone(), false).unwrap());
        let circle = AnyCurve::Ellipse(EllipseArc::full(DVec3::ZERO, 1.0, 1.0));
        let (made, deviation) = wire(&[line.clone(), circle], &detail(1e-3, 1000)).unwrap();
        let positions: Vec<DVec3> = made.points[..4].iter().map(|point| point.position).collect();
        assert_eq!(positions, corners);
        assert!(!made.strands[0].closed && made.strands[1].closed);
        assert!(deviation.bound <= 1e-3 && deviation.evidence == Evidence::Proved);
        // As many segments as points on the circle, one less on the line.
        assert_eq!(made.segments(0).count(), made.points.len() - 1);
        assert_eq!(wire(&[line], &detail(1e-3, 10)).unwrap().1.evidence, Evidence::Exact);
    }

    #[test]
    fn limits_count_all_curves() {
        let circle = AnyCurve::Ellipse(EllipseArc::full(DVec3::ZERO, 1.0, 1.0));
        let curves = vec![circle; 4];
        let needed = wire(&curves, &detail(1e-4, 1 << 20)).unwrap().0.points.len() as u64;
        assert!(matches!(wire(&curves, &detail(1e-4, needed - 1)), Err(TessellateError::TooMany { .. })));
    }
}

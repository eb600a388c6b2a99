//! Factors of size along a way.

use glam::DVec2;

use super::Builder;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::surface::{Law, Stations};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Blend, Scaling, Sp};

/// How far the ends of a curve of factors may miss the ends of the way.
const MISSED: f64 = 1e-9;

impl Builder<'_> {
    /// The law of written factors; without any, none.
    pub(super) fn law(&mut self, scaling: Option<&Sp<Scaling>>, blend: Blend) -> Option<Law> {
        let Some(scaling) = scaling else { return Some(Law::One) };
        let stations: Vec<(f64, DVec2)> = match &scaling.value {
            Scaling::End(factor) => vec![(0.0, DVec2::ONE), (1.0, DVec2::splat(*factor))],
            Scaling::Stations(stations) => {
                stations.iter().map(|station| (station.at.value, station.factor.value.0)).collect()
            }
            Scaling::Curve(reference) => {
                let curve = self.curve_of(reference)?;
                self.check_law(&curve, reference.span())?;
                return Some(Law::Curve(curve));
            }
        };
        if stations.iter().all(|(_, factor)| factor.x == 0.0 || factor.y == 0.0) {
            let report = Diagnostic::error(Code::NoArea, "at these factors the section never has a size");
            self.report(report.at(scaling.span, "all 0"));
            return None;
        }
        if stations.iter().all(|(_, factor)| *factor == DVec2::ONE) {
            return Some(Law::One);
        }
        Some(Law::Stations(match blend {
            Blend::Linear => Stations::linear(&stations),
            Blend::Smooth => Stations::smooth(&stations),
        }))
    }

    /// A curve of factors runs from x = 0 to x = 1, always onward, and never below y = 0.
    fn check_law(&mut self, curve: &AnyCurve, span: Span) -> Option<()> {
        const SAMPLES: u32 = 1024;
        let domain = curve.domain();
        let (start, end) = (curve.point(domain.start), curve.evaluate(domain.end, Side::Before).point);
        let fault = if start.x.abs() > MISSED || (end.x - 1.0).abs() > MISSED {
            Some(format!("this curve of factors runs from x = {} to {}", show(start.x), show(end.x)))
        } else {
            let mut places: Vec<f64> =
                (0..=SAMPLES).map(|k| domain.at(f64::from(k) / f64::from(SAMPLES))).collect();
            places.extend(curve.breaks());
            places.sort_by(f64::total_cmp);
            let points: Vec<_> = places.iter().map(|t| curve.evaluate(*t, Side::Before).point).collect();
            let back = points.windows(2).find(|pair| pair[1].x < pair[0].x - 1e-12);
            let lowest = points.iter().min_by(|a, b| a.y.total_cmp(&b.y));
            let below = lowest.filter(|point| point.y < 0.0);
            match (back, below) {
                (Some(pair), _) => {
                    Some(format!("this curve of factors turns back at x = {}", show(pair[0].x)))
                }
                (None, Some(point)) => {
                    Some(format!("this curve of factors falls to {} at x = {}", show(point.y), show(point.x)))
                }
                _ => None,
            }
        };
        let Some(message) = fault else { return Some(()) };
        let report = Diagnostic::error(Code::BadFactors, message)
            .at(span, "x is the share of the length, y the factor")
            .help("let x increase from 0 to 1, and keep y at 0 or above");
        self.report(report);
        None
    }
}

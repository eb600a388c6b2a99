//! Lofts into patches.

use glam::{DAffine3, DMat3, DVec3};

use super::ruled::places;
use super::{Builder, patch, placement};
use crate::geometry::curve::{AnyCurve, Curve as _, Side, Transformed};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{
    Across, AnySurface, CrossEnd, LoftedSurface, MatchError, Matching, gathered, matched,
};
use crate::geometry::tessellate::Rim;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Loft, LoftEnd, Profile, Sp};
use crate::model::Recipe;

/// Curves that leave a plane by less than this share of their size lie in it.
const FLAT: f64 = 1e-9;

/// The curves of a loft, and the points at its ends.
struct Row {
    curves: Vec<(AnyCurve, Span)>,
    first: Option<(DVec3, Span)>,
    last: Option<(DVec3, Span)>,
}

impl Builder<'_> {
    /// The surface through a row of profiles.
    pub(super) fn loft(&mut self, loft: &Loft, span: Span) -> Option<Recipe> {
        let row = self.row(loft, span)?;
        let listed: Vec<(&AnyCurve, Span)> = row.curves.iter().map(|(curve, span)| (curve, *span)).collect();
        self.check_both(&listed)?;
        let matching = match loft.matching.value {
            spec::Matching::Auto => Matching::Auto,
            spec::Matching::Corners => Matching::Corners,
            spec::Matching::Length => Matching::Length,
            spec::Matching::Parameter => Matching::Parameter,
        };
        let curves = row.curves.iter().map(|(curve, _)| curve.clone()).collect();
        let curves = match matched(curves, matching, loft.align.value) {
            Ok(curves) => curves,
            Err(error) => return self.unmatched(&error, &row, loft),
        };
        self.check_neighbors(&curves, &row, loft)?;
        let caps = self.loft_caps(loft, &row)?;
        let mut all = Vec::with_capacity(curves.len() + 2);
        all.extend(row.first.map(|(point, _)| gathered(&curves[0], point)));
        all.extend(curves.iter().cloned());
        all.extend(row.last.map(|(point, _)| gathered(&curves[curves.len() - 1], point)));
        let (knots, whole) = knots(&all, loft.closed.value);
        let across = match (loft.across.value, loft.closed.value) {
            (spec::Across::Linear, false) => Across::Linear,
            (spec::Across::Linear, true) => Across::LinearRing,
            (spec::Across::Smooth, true) => Across::SmoothRing,
            (spec::Across::Smooth, false) => {
                let start = self.cross_end(loft.start, (&all[0], &all[1]), row.first, whole);
                let ends = (&all[all.len() - 1], &all[all.len() - 2]);
                let end = self.cross_end(loft.end, ends, row.last, -whole);
                Across::Smooth(start?, end?)
            }
        };
        match LoftedSurface::new(all, &knots, across) {
            Ok(surface) => {
                let surfaces = vec![AnySurface::Lofted(Box::new(surface))];
                Some(patch::capped(surfaces, caps))
            }
            Err(error) => {
                let message = format!("there is no surface through these profiles: {error}");
                self.report(Diagnostic::error(Code::Degenerate, message).at(span, "this loft"));
                None
            }
        }
    }

    /// Curves and tips in their places.
    fn row(&mut self, loft: &Loft, span: Span) -> Option<Row> {
        let mut row = Row { curves: Vec::new(), first: None, last: None };
        let last = loft.profiles.len() - 1;
        let mut good = true;
        for (index, profile) in loft.profiles.iter().enumerate() {
            let curve = match &profile.value {
                Profile::Point(point) => {
                    good &= self.tip(&mut row, (index, last), (point.position, profile.span), loft);
                    continue;
                }
                Profile::Curve(curve) => self.curve_of(curve),
                Profile::Placed(placed) => self.curve_of(&placed.curve).map(|curve| {
                    let map = placement(placed.scale.0, placed.rotate.value, placed.at.value);
                    AnyCurve::Transformed(Transformed::new(curve, map))
                }),
            };
            match curve {
                Some(curve) => row.curves.push((curve, profile.span)),
                None => good = false,
            }
        }
        if good && row.curves.is_empty() {
            let message = "a loft needs at least one curve between its tips";
            self.report(Diagnostic::error(Code::Degenerate, message).at(span, "only points"));
            return None;
        }
        let fewest = 3;
        if good && loft.closed.value && row.curves.len() < fewest {
            let message =
                format!("a closed loft needs at least {fewest} profiles, found {}", row.curves.len());
            self.report(
                Diagnostic::error(Code::WrongLength, message).at(loft.closed.span, "nothing to go around"),
            );
            return None;
        }
        good.then_some(row)
    }

    fn tip(&mut self, row: &mut Row, (index, last): (usize, usize), tip: (DVec3, Span), loft: &Loft) -> bool {
        let refused = if loft.closed.value {
            Some("a closed loft has no tips")
        } else if index != 0 && index != last {
            Some("a tip stands at one end of a loft, not between its profiles")
        } else {
            None
        };
        if let Some(message) = refused {
            self.report(Diagnostic::error(Code::Degenerate, message).at(tip.1, "a point"));
            return false;
        }
        if index == 0 {
            row.first = Some(tip);
        } else {
            row.last = Some(tip);
        }
        true
    }

    fn unmatched<T>(&mut self, error: &MatchError, row: &Row, loft: &Loft) -> Option<T> {
        let MatchError::Corners { curve, corners, first } = error;
        let message = format!("this profile has {corners} corners, and the first has {first}");
        let report = Diagnostic::error(Code::WrongCount, message)
            .at(row.curves[*curve].1, format!("{corners} corners"))
            .also(row.curves[0].1, format!("{first} corners"))
            .also(loft.matching.span, "corners are to be matched")
            .help("write `matching = \"length\"`");
        self.report(report);
        None
    }

    /// Neighbors must not be one and the same line, nor a tip lie where all of its neighbor does.
    fn check_neighbors(&mut self, curves: &[AnyCurve], row: &Row, loft: &Loft) -> Option<()> {
        let listed: Vec<(&AnyCurve, Span)> =
            curves.iter().zip(&row.curves).map(|(curve, (_, span))| (curve, *span)).collect();
        for pair in listed.windows(2) {
            self.check_apart(pair[0], pair[1])?;
        }
        if loft.closed.value {
            self.check_apart(listed[listed.len() - 1], listed[0])?;
        }
        if let Some((tip, span)) = row.first {
            self.check_tip(listed[0].0, listed[0].1, tip, span)?;
        }
        if let Some((tip, span)) = row.last {
            let (curve, at) = listed[listed.len() - 1];
            self.check_tip(curve, at, tip, span)?;
        }
        Some(())
    }

    /// What holds at an end: `at` is the curve there and `next` its neighbor, `speed` the even speed away from it, less than
    /// 0 where it is the last.
    fn cross_end(
        &mut self,
        end: Sp<LoftEnd>,
        (at, next): (&AnyCurve, &AnyCurve),
        tip: Option<(DVec3, Span)>,
        speed: f64,
    ) -> Option<CrossEnd> {
        let derivative = match end.value {
            LoftEnd::Natural => return Some(CrossEnd::Natural),
            LoftEnd::NotAKnot => return Some(CrossEnd::NotAKnot),
            LoftEnd::First(first) => gathered(at, first.value * speed.abs()),
            LoftEnd::Straight if tip.is_some() => {
                let message = "a loft cannot leave a tip at right angles: a point has no plane";
                let report = Diagnostic::error(Code::Degenerate, message).at(end.span, "of a tip");
                self.report(report.help("write \"round\", or the direction: `{ first = [x, y, z] }`"));
                return None;
            }
            LoftEnd::Straight => {
                let normal = self.plane_of(at, end.span)?;
                // To the side on which its neighbor lies.
                let onward: f64 = places().map(|u| (next.point(u) - at.point(u)).dot(normal)).sum();
                gathered(at, normal * onward.signum() * speed)
            }
            LoftEnd::Round => {
                let Some((tip, _)) = tip else {
                    let message = "only a tip can be round, and this end of the loft has a curve";
                    let report = Diagnostic::error(Code::Degenerate, message).at(end.span, "no tip");
                    self.report(report.help("let the profiles begin or end with a point `[x, y, z]`"));
                    return None;
                };
                let normal = self.plane_of(next, end.span)?;
                let flat = |vector: DVec3| vector - normal * vector.dot(normal);
                let reach: f64 = places().map(|u| flat(next.point(u) - tip).length()).sum();
                let factor = speed * places().count() as f64 / reach;
                // To the shadow of the neighbor, seen from the tip.
                let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|unit| flat(unit) * factor);
                let matrix3 = DMat3::from_cols(columns[0], columns[1], columns[2]);
                let map = DAffine3 { matrix3, translation: -(matrix3 * tip) };
                AnyCurve::Transformed(Transformed::new(next.clone(), map))
            }
        };
        Some(CrossEnd::Derivative(Box::new(derivative)))
    }

    /// The normal of the plane in which a curve lies.
    fn plane_of(&mut self, curve: &AnyCurve, span: Span) -> Option<DVec3> {
        let points: Vec<DVec3> = places().map(|u| curve.point(u)).collect();
        let size = Bounds::of_points(points.iter().copied()).diagonal();
        let origin = points[0];
        // The point that is furthest away, and the one that is furthest from the line there: a net area may be zero.
        let furthest = |measure: &dyn Fn(DVec3) -> DVec3| {
            let all = points.iter().map(|point| measure(*point - origin));
            all.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::ZERO)
        };
        let far = furthest(&|away| away);
        let area = furthest(&|away| far.cross(away));
        let normal = area.normalize_or_zero();
        let away = points.iter().map(|point| (*point - origin).dot(normal).abs()).fold(0.0, f64::max);
        if area.length() > FLAT * size * size && away <= FLAT * size {
            return Some(normal);
        }
        let message = "the profile next to this end does not lie in one plane";
        let report = Diagnostic::error(Code::NoPlane, message).at(span, "in which plane?");
        self.report(report.help("write the direction: `{ first = [x, y, z] }`"));
        None
    }

    fn loft_caps(&mut self, loft: &Loft, row: &Row) -> Option<Vec<Vec<(u32, Rim)>>> {
        let (first, last) = (&row.curves[0], &row.curves[row.curves.len() - 1]);
        let mut caps = Vec::new();
        if !loft.caps.value || loft.closed.value || !first.0.is_closed() {
            return Some(caps);
        }
        for (end, tip, rim) in [(first, row.first, Rim::Bottom), (last, row.last, Rim::Top)] {
            if tip.is_none() {
                self.check_flat_end(&end.0, end.1)?;
                caps.push(vec![(0, rim)]);
            }
        }
        Some(caps)
    }
}

/// Knots from 0 to 1, as far apart as the profiles are on the average, and the whole way.
fn knots(curves: &[AnyCurve], closed: bool) -> (Vec<f64>, f64) {
    let mut reached = vec![0.0];
    let next = curves.iter().skip(1).chain(curves.first().filter(|_| closed));
    for (one, other) in curves.iter().zip(next) {
        let apart: f64 = places()
            .map(|u| one.evaluate(u, Side::After).point.distance(other.evaluate(u, Side::After).point))
            .sum();
        reached.push(reached[reached.len() - 1] + apart);
    }
    let whole = reached[reached.len() - 1];
    let count = reached.len() - 1;
    let last = |k: usize| k == count;
    let knots = (0..=count).map(|k| if last(k) { 1.0 } else { reached[k] / whole }).collect();
    (knots, whole / places().count() as f64)
}

//! Ruled and translational surfaces into patches.

use glam::DVec3;

use super::profile::show;
use super::{Builder, patch};
use crate::geometry::curve::{AnyCurve, Curve as _, Retimed, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{AnySurface, RuledSurface, TranslationalSurface};
use crate::geometry::tessellate::{Density, Rim, discretize};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{End, Ruled, Translational};
use crate::model::Recipe;

/// Lengths below this share of the size are rounding.
const NOTHING: f64 = 1e-9;

impl Builder<'_> {
    /// The surface of straight lines between two curves.
    pub(super) fn ruled(&mut self, ruled: &Ruled) -> Option<Recipe> {
        let from = self.curve_of(&ruled.from);
        let (to, to_span) = match &ruled.to {
            End::Curve(curve) => (Some(self.curve_of(curve)), curve.span()),
            End::Point(point) => (None, point.span),
        };
        let from = from?;
        let from_span = ruled.from.span();
        let surface = match (to, &ruled.to) {
            (Some(to), _) => {
                let to = to?;
                self.check_both(&[(&from, from_span), (&to, to_span)])?;
                self.check_apart((&from, from_span), (&to, to_span))?;
                RuledSurface::new(from.clone(), to)
            }
            (None, End::Point(point)) => {
                self.check_tip(&from, from_span, point.position, point.span)?;
                RuledSurface::to_point(from.clone(), point.position)
            }
            (None, End::Curve(_)) => return None,
        };
        let mut caps = Vec::new();
        if ruled.caps.value && from.is_closed() {
            self.check_flat_end(&from, from_span)?;
            caps.push(vec![(0, Rim::Bottom)]);
            if let End::Curve(curve) = &ruled.to {
                self.check_flat_end(surface.to(), curve.span())?;
                caps.push(vec![(0, Rim::Top)]);
            }
        }
        Some(patch::capped(vec![AnySurface::Ruled(Box::new(surface))], caps))
    }

    /// The surface of a curve moved along another.
    pub(super) fn translational(&mut self, moved: &Translational) -> Option<Recipe> {
        let profile = self.curve_of(&moved.profile);
        let path = self.curve_of(&moved.path);
        let (profile, path) = (profile?, path?);
        self.check_across(&profile, &path, moved.path.span())?;
        let mut caps = Vec::new();
        if moved.caps.value && profile.is_closed() && !path.is_closed() {
            self.check_flat_end(&profile, moved.profile.span())?;
            caps = vec![vec![(0, Rim::Bottom)], vec![(0, Rim::Top)]];
        }
        let surface = AnySurface::Translational(Box::new(TranslationalSurface::new(profile, path)));
        Some(patch::capped(vec![surface], caps))
    }

    /// All curves are open, or all are closed.
    pub(super) fn check_both(&mut self, curves: &[(&AnyCurve, Span)]) -> Option<()> {
        let find = |closed: bool| curves.iter().find(|(curve, _)| curve.is_closed() == closed);
        let (Some(closed), Some((open, span))) = (find(true), find(false)) else { return Some(()) };
        let domain = open.domain();
        let gap = open.point(domain.start).distance(open.evaluate(domain.end, Side::Before).point);
        let message =
            format!("this curve is open, its ends are {} apart, and the other is closed", show(gap));
        let report = Diagnostic::error(Code::OpenAndClosed, message)
            .at(*span, "open")
            .also(closed.1, "closed")
            .help("close it with `closed = true`, or open the other: an arc from 0 to 359.9 degrees instead of a circle");
        self.report(report);
        None
    }

    /// Curves that are joined point to point must not be one and the same.
    pub(super) fn check_apart(&mut self, from: (&AnyCurve, Span), to: (&AnyCurve, Span)) -> Option<()> {
        let (a, b) = (Retimed::unit(from.0.clone()), Retimed::unit(to.0.clone()));
        let pairs: Vec<(DVec3, DVec3)> = places().map(|t| (a.point(t), b.point(t))).collect();
        let size = Bounds::of_points(pairs.iter().flat_map(|(a, b)| [*a, *b])).diagonal();
        if pairs.iter().any(|(a, b)| a.distance(*b) > NOTHING * size) {
            return Some(());
        }
        let report = Diagnostic::error(Code::Coincident, "the two curves are the same line in space")
            .at(to.1, "no distance from the first")
            .also(from.1, "the first")
            .help("move one of them: `{ transform = { of = \"name\", at = [0, 0, 1] } }`");
        self.report(report);
        None
    }

    /// A tip must not lie on the line that its curve follows.
    pub(super) fn check_tip(&mut self, from: &AnyCurve, span: Span, tip: DVec3, at: Span) -> Option<()> {
        let curve = Retimed::unit(from.clone());
        let jets: Vec<_> = places().map(|t| curve.evaluate(t, Side::After)).collect();
        let size = Bounds::of_points(jets.iter().map(|jet| jet.point).chain([tip])).diagonal();
        if jets.iter().any(|jet| {
            jet.first.cross(tip - jet.point).length()
                > NOTHING * size * jet.first.length().max(NOTHING * size)
        }) {
            return Some(());
        }
        let report = Diagnostic::error(Code::Coincident, "the point lies on the line that the curve follows")
            .at(at, "no surface from there")
            .also(span, "the curve");
        self.report(report);
        None
    }

    /// A path that follows the profile itself sweeps no area.
    fn check_across(&mut self, profile: &AnyCurve, path: &AnyCurve, span: Span) -> Option<()> {
        let (a, b) = (Retimed::unit(profile.clone()), Retimed::unit(path.clone()));
        let along: Vec<DVec3> = places().map(|t| a.direction(t, Side::After)).collect();
        let crosses = |direction: DVec3| along.iter().any(|own| own.cross(direction).length() > 1e-9);
        if places().any(|t| crosses(b.direction(t, Side::After))) {
            return Some(());
        }
        let message = "the path runs along the profile itself: moving it there sweeps no area";
        self.report(Diagnostic::error(Code::NoArea, message).at(span, "same direction as the profile"));
        None
    }

    /// The end of a solid that a closed curve bounds must be flat.
    pub(super) fn check_flat_end(&mut self, curve: &AnyCurve, span: Span) -> Option<()> {
        const CHORDS: u32 = 256;
        let stations = discretize(curve, Density::Count(CHORDS), u64::MAX).ok()?;
        let points: Vec<DVec3> = stations.iter().map(|station| station.point).collect();
        let size = Bounds::of_points(points.iter().copied()).diagonal();
        let origin = points[0];
        let area: DVec3 = points.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum();
        let normal = area.normalize_or_zero();
        let away = points.iter().map(|point| (*point - origin).dot(normal).abs()).fold(0.0, f64::max);
        if area.length() <= NOTHING * size * size {
            let message = "this closed curve encloses no area, so no flat face can close the end";
            let report = Diagnostic::error(Code::NoFlatEnd, message).at(span, "encloses nothing");
            self.report(report.help("write `caps = false`"));
            return None;
        }
        if away > NOTHING * size {
            let message =
                format!("this curve is not flat, by {}, so no flat face can close the end", show(away));
            let report = Diagnostic::error(Code::NoFlatEnd, message).at(span, "leaves its plane");
            self.report(report.help("write `caps = false` and close the end with a shape of its own"));
            return None;
        }
        Some(())
    }
}

/// Places along curves over 0 to 1 where they are compared; a prime, so that equal bends are not met at equal places.
pub(super) fn places() -> impl Iterator<Item = f64> {
    const COUNT: u32 = 97;
    (0..COUNT).map(|k| (f64::from(k) + 0.5) / f64::from(COUNT))
}

//! Bevels and drafts of extrusions.

use glam::DVec3;

use super::Builder;
use super::profile::{place, show};
use crate::geometry::curve::{AnyCurve, Curve as _, EllipseArc, Path, Polyline};
use crate::geometry::number::{Bounds, tan_degrees};
use crate::geometry::tessellate::{Density, EdgeProfile, discretize};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{Bevel, BevelEnds, BevelForm, Extrude};

/// How the walls of an extrusion lean; none where they are straight.
pub(super) fn edge_profile(extrude: &Extrude, bottom: f64) -> Option<EdgeProfile> {
    let draft = extrude.draft.value;
    if extrude.bevel.is_none() && draft == 0.0 {
        return None;
    }
    let has = |end: BevelEnds| {
        extrude.bevel.as_ref().filter(|bevel| bevel.ends == BevelEnds::Both || bevel.ends == end)
    };
    let (below, above) = (has(BevelEnds::Bottom), has(BevelEnds::Top));
    let height = |bevel: Option<&Bevel>| bevel.map_or(0.0, |bevel| bevel.height.value);
    let whole = bottom + height(below);
    let top = bottom + extrude.height.value;
    let shoulder = if above.is_some() { top - height(above) } else { top };
    let leaned = tan_degrees(draft) * (shoulder - whole).max(0.0);
    let at = |inset: f64, z: f64| DVec3::new(inset, z, 0.0);
    let wall = (shoulder > whole).then(|| line(at(0.0, whole), at(leaned, shoulder))).flatten();
    let end = above.and_then(|bevel| cut(bevel, at(leaned, shoulder), 1.0));
    let upper = Path::new(wall.into_iter().chain(end).collect())?;
    Some(EdgeProfile {
        lower: below.and_then(|bevel| cut(bevel, at(0.0, whole), -1.0)),
        upper: AnyCurve::Path(upper),
    })
}

/// The profile of a bevel from the wall inward, up or down.
fn cut(bevel: &Bevel, from: DVec3, up: f64) -> Option<AnyCurve> {
    let (inward, onward) = (DVec3::X * bevel.size.value, DVec3::Y * (up * bevel.height.value));
    let quarter = |center: DVec3, x: DVec3, y: DVec3| {
        Some(AnyCurve::Ellipse(EllipseArc { center, x, y, from: 0.0, to: 90.0 }))
    };
    match bevel.form {
        BevelForm::Straight => line(from, from + inward + onward),
        BevelForm::Round => quarter(from + inward, -inward, onward),
        BevelForm::Cove => quarter(from + onward, -onward, inward),
    }
}

fn line(from: DVec3, to: DVec3) -> Option<AnyCurve> {
    Polyline::new(vec![from, to], false).map(AnyCurve::Polyline)
}

impl Builder<'_> {
    /// The outline must be wide enough for walls that lean in.
    pub(super) fn check_width(
        &mut self,
        extrude: &Extrude,
        edge: &EdgeProfile,
        (outlines, islands): (&[AnyCurve], &[usize]),
    ) -> Option<()> {
        let size = extent(outlines);
        let tolerance = size / 4000.0;
        // What the tessellator refuses it refuses with its own words.
        let Ok(Some((collision, most))) = edge.fits(outlines, islands, tolerance) else { return Some(()) };
        let span = match &extrude.bevel {
            Some(bevel) => bevel.size.span,
            None => extrude.draft.span,
        };
        // Told no more finely than it is known.
        let grain = power_of_ten(tolerance);
        let message = format!(
            "the walls reach {} inside the outline, which is too narrow for that near {}",
            show(edge.deepest()),
            place((collision.place / grain).round() * grain + 0.0)
        );
        let report = Diagnostic::error(Code::TooNarrow, message)
            .at(span, "too much for this outline")
            .also(extrude.profile.span(), "this outline");
        self.report(if most > 1e-3 * size {
            report.help(format!("they may reach {} inside; what `draft` takes counts too", show(most)))
        } else {
            report.help("write a smaller `bevel` or `draft`")
        });
        None
    }
}

/// The greatest power of ten that is no more than a number.
fn power_of_ten(number: f64) -> f64 {
    let mut power = 1.0;
    while power > number {
        power /= 10.0;
    }
    while power * 10.0 <= number {
        power *= 10.0;
    }
    power
}

fn extent(outlines: &[AnyCurve]) -> f64 {
    let of = |curve: &AnyCurve| {
        let stations = discretize(curve, Density::Count(64), u64::MAX).unwrap_or_default();
        let start = curve.point(curve.domain().start);
        Bounds::of_points(stations.iter().map(|station| station.point).chain([start]))
    };
    outlines.iter().map(of).fold(Bounds::EMPTY, Bounds::union).diagonal()
}

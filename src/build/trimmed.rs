//! Surfaces cut off along lines of their parameters into recipes.

use glam::{DAffine3, DVec2, DVec3};

use super::Builder;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Domain, Polyline};
use crate::geometry::number::{Bounds, floor_count};
use crate::geometry::planar::{encloses, first_contact};
use crate::geometry::surface::{AnySurface, Surface as _, closed_directions};
use crate::geometry::tessellate::TrimmedSurface;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::model::Recipe;

impl Builder<'_> {
    /// The recipe and where the surface stands.
    pub(super) fn trimmed(
        &mut self,
        name: &str,
        written: &spec::Trimmed,
        span: Span,
    ) -> Option<(Recipe, DAffine3)> {
        let place = written.of.span();
        let handle = self.shape_of(name, 0, &written.of)?;
        let shape = self.model.shape(handle);
        let (recipe, placement) = (shape.recipe.clone(), shape.options.placement);
        let surface = self.surface_to_trim(&recipe, place)?;
        let profile = written.profile.as_ref().map_or(span, spec::CurveReference::span);
        let outlines = match &written.profile {
            Some(profile) => self.closed_parts(profile, "outline", "outline's part"),
            None => self.closed_profile_of(around(&surface), "outline", span).map(|whole| vec![whole]),
        };
        let (mut outlines, _) = self.cut_out(outlines, written.fill.value, &written.holes, profile)?;
        let drawn = usize::from(written.profile.is_none());
        self.check_outlines(&surface, &outlines[drawn..], profile)?;
        if written.profile.is_none() {
            outlines[0] = whole(&surface, DVec2::ZERO);
        }
        Some((Recipe::Trimmed(TrimmedSurface::new(surface, outlines)), placement))
    }

    /// Outlines lie on the surface; around a closed one each lies within a turn, and they lie apart when it comes round.
    fn check_outlines(&mut self, surface: &AnySurface, outlines: &[AnyCurve], span: Span) -> Option<()> {
        let drawn: Vec<Vec<DVec2>> = outlines.iter().map(|outline| places(outline).collect()).collect();
        let domains = [surface.domain_u(), surface.domain_v()];
        let closed = closed_directions(surface);
        let report = drawn
            .iter()
            .find_map(|outline| not_on(surface, (domains, closed), outline, span))
            .or_else(|| {
                let turns = [0, 1].map(|axis| if closed[axis] { domains[axis].span() } else { 0.0 });
                round_again(&drawn, DVec2::from_array(turns)).map(|at| {
                    let message = format!(
                        "outlines meet near u = {}, v = {}, where the surface comes round",
                        show(at.x),
                        show(at.y)
                    );
                    Diagnostic::error(Code::BadHole, message)
                        .at(span, "one turn on, an outline lies on another")
                        .help("draw each part once: what lies before the seam is also what lies one turn on")
                })
            });
        report.map_or(Some(()), |report| {
            self.report(report);
            None
        })
    }

    /// The one surface of a recipe.
    fn surface_to_trim(&mut self, recipe: &Recipe, place: Span) -> Option<AnySurface> {
        let report = match recipe {
            Recipe::Patches { patches, .. } => match patches.surfaces.as_slice() {
                [surface] if patches.caps.is_empty() => return Some(surface.clone()),
                [_] => Diagnostic::error(Code::TrimSurface, "this surface has flat ends, which have no parameters")
                    .at(place, "closed by caps")
                    .help("leave the caps out, and close the trimmed surface by shapes of its own"),
                all => {
                    let message = format!("this shape is made of {} surfaces, each with its own parameters", all.len());
                    Diagnostic::error(Code::TrimSurface, message)
                        .at(place, "needs one surface")
                        .help("write the patch that is to be cut as a shape of its own")
                }
            },
            _ => Diagnostic::error(Code::TrimSurface, "this shape is no surface over parameters u and v")
                .at(place, "cannot be trimmed")
                .help("surfaces are `nurbs`, `b-spline`, `patches`, `bezier-triangles`, `hermite`, `coons`, `gordon`, `ruled`, `loft` and `translational`"),
        };
        self.report(report);
        None
    }
}

/// What is wrong with an outline that leaves the surface, or goes around it more than once.
fn not_on(
    surface: &AnySurface,
    (domains, closed): ([Domain; 2], [bool; 2]),
    outline: &[DVec2],
    span: Span,
) -> Option<Diagnostic> {
    (0..2).find_map(|axis| {
        let domain = domains[axis];
        let rounding = 1e-9 * domain.span();
        if !closed[axis] {
            let beyond = |at: &&DVec2| (domain.start - at[axis]).max(at[axis] - domain.end) > rounding;
            return outline.iter().find(beyond).map(|place| left(surface, *place, span));
        }
        let ends = outline.iter().map(|at| at[axis]);
        let (low, high) =
            ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        (high - low > domain.span() + rounding).then(|| {
            let message = format!(
                "this outline goes from {} = {} to {}, and the surface comes round after {}",
                ["u", "v"][axis],
                show(low),
                show(high),
                show(domain.span())
            );
            Diagnostic::error(Code::TrimOutside, message)
                .at(span, "more than one turn")
                .help("draw each outline within one turn of the closed surface; it may start anywhere")
        })
    })
}

/// A place where an outline meets, or lies in, another that is moved by turns; none of `turns` where a direction is open.
fn round_again(outlines: &[Vec<DVec2>], turns: DVec2) -> Option<DVec2> {
    let boxes: Vec<Bounds> =
        outlines.iter().map(|all| Bounds::of_points(all.iter().map(|at| at.extend(0.0)))).collect();
    // Turns by which the other must move to meet the one, along one direction.
    let steps = |turn: f64, one: (f64, f64), other: (f64, f64)| {
        let (low, high) = if turn > 0.0 {
            (((one.0 - other.1) / turn).ceil(), ((one.1 - other.0) / turn).floor())
        } else {
            (0.0, 0.0)
        };
        let count = if high >= low { floor_count(high - low) + 1 } else { 0 };
        (0..count).map(move |k| (low + f64::from(k)) * turn)
    };
    for (i, one) in outlines.iter().enumerate() {
        for (j, other) in outlines.iter().enumerate().filter(|(j, _)| *j != i) {
            let range = |axis: usize| {
                let of = |bounds: &Bounds| (bounds.min[axis], bounds.max[axis]);
                steps(turns[axis], of(&boxes[i]), of(&boxes[j]))
            };
            for (x, y) in range(0).flat_map(|x| range(1).map(move |y| (x, y))) {
                if x == 0.0 && y == 0.0 {
                    continue;
                }
                let moved: Vec<DVec2> = other.iter().map(|at| *at + DVec2::new(x, y)).collect();
                if encloses(one, moved[0]) {
                    return Some(moved[0]);
                }
                if let Some(contact) = first_contact(&[one.clone(), moved]) {
                    return Some(contact.point);
                }
            }
        }
    }
    None
}

/// The border of all parameters, moved outward.
fn whole(surface: &AnySurface, by: DVec2) -> AnyCurve {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let (low, high) = (DVec2::new(u.start, v.start) - by, DVec2::new(u.end, v.end) + by);
    let corners = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
    let points = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    AnyCurve::Polyline(Polyline::new(points, true).expect("four corners"))
}

/// What holes must lie inside of where nothing else is drawn: all parameters, around closed directions many turns to both
/// sides, since holes may lie over the seam, or be drawn on any turn.
fn around(surface: &AnySurface) -> AnyCurve {
    const TURNS: f64 = 16.0;
    let spans = [surface.domain_u().span(), surface.domain_v().span()];
    let closed = closed_directions(surface);
    let by = |axis: usize| if closed[axis] { TURNS * spans[axis] } else { 0.0 };
    whole(surface, DVec2::new(by(0), by(1)))
}

/// Places of a curve; what lies further out between two of them is a thousandth of the piece.
fn places(curve: &AnyCurve) -> impl Iterator<Item = DVec2> + '_ {
    const PLACES: u32 = 64;
    let domain = curve.domain();
    let mut stops = vec![domain.start];
    stops.extend(curve.joints());
    stops.push(domain.end);
    let pieces: Vec<(f64, f64)> = stops.windows(2).map(|pair| (pair[0], pair[1])).collect();
    pieces.into_iter().flat_map(move |(from, to)| {
        let along = (0..=PLACES).map(move |k| from + (to - from) * f64::from(k) / f64::from(PLACES));
        along.map(|t| curve.point(t).truncate())
    })
}

fn left(surface: &AnySurface, place: DVec2, span: Span) -> Diagnostic {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let message =
        format!("this outline leaves the surface: it reaches u = {}, v = {}", show(place.x), show(place.y));
    Diagnostic::error(Code::TrimOutside, message).at(span, "not on the surface everywhere").note(format!(
        "u goes from {} to {}, v from {} to {}",
        show(u.start),
        show(u.end),
        show(v.start),
        show(v.end)
    ))
}

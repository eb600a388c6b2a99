//! Surfaces cut off along lines of their parameters into recipes.

use glam::{DAffine3, DVec2, DVec3};

use super::Builder;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Domain, Polyline};
use crate::geometry::surface::{AnySurface, Surface as _};
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
        let parts = match &written.profile {
            Some(profile) => self.closed_parts(profile, "outline", "outline's part"),
            None => self.closed_profile_of(whole(&surface), "outline", span).map(|whole| vec![whole]),
        };
        let profile = written.profile.as_ref().map_or(span, spec::CurveReference::span);
        let (outlines, _) = self.cut_out(parts, written.fill.value, &written.holes, profile)?;
        for outline in &outlines {
            if let Some(place) = outside(&surface, outline) {
                self.report(left(&surface, place, profile));
                return None;
            }
        }
        Some((Recipe::Trimmed(TrimmedSurface { surface, outlines }), placement))
    }

    /// The one smooth surface of a recipe.
    fn surface_to_trim(&mut self, recipe: &Recipe, place: Span) -> Option<AnySurface> {
        let report = match recipe {
            Recipe::Patches { patches, .. } => match patches.surfaces.as_slice() {
                [surface] if patches.caps.is_empty() => match TrimmedSurface::first_edge(surface) {
                    None => return Some(surface.clone()),
                    Some(edge) => edged(edge, place),
                },
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

fn edged((along_u, t): (bool, f64), place: Span) -> Diagnostic {
    let name = if along_u { "u" } else { "v" };
    let message =
        format!("this surface has an edge at {name} = {}: only smooth ones can be trimmed", show(t));
    Diagnostic::error(Code::TrimSurface, message)
        .at(place, "has an edge inside")
        .help("write the parts on both sides of the edge as surfaces of their own, and trim each")
}

/// The border of all parameters.
fn whole(surface: &AnySurface) -> AnyCurve {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let corners = [(u.start, v.start), (u.end, v.start), (u.end, v.end), (u.start, v.end)];
    let points = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    AnyCurve::Polyline(Polyline::new(points, true).expect("four corners"))
}

/// A place of a curve outside of the parameters of a surface.
fn outside(surface: &AnySurface, curve: &AnyCurve) -> Option<DVec2> {
    /// Places along each piece; what lies further out between two of them is a thousandth of the piece.
    const PLACES: u32 = 64;
    let beyond = |x: f64, domain: Domain| (domain.start - x).max(x - domain.end) > 1e-9 * domain.span();
    let domain = curve.domain();
    let mut stops = vec![domain.start];
    stops.extend(curve.joints());
    stops.push(domain.end);
    let places = stops.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (0..=PLACES).map(move |k| from + (to - from) * f64::from(k) / f64::from(PLACES))
    });
    let mut places = places.map(|t| curve.point(t).truncate());
    places.find(|at| beyond(at.x, surface.domain_u()) || beyond(at.y, surface.domain_v()))
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

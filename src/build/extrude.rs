//! Outlines and holes of a document, sorted into what is filled.

use glam::DVec2;

use super::Builder;
use super::bevel::edge_profile;
use super::moving::moving_extrusion;
use super::profile::{Profile, meeting, place};
use crate::geometry::curve::AnyCurve;
use crate::geometry::planar::{Contact, encloses, twice_area};
use crate::geometry::tessellate::{Extrusion, Sheet};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{CurveReference, Extrude, Fill, Sheet as SheetFields};
use crate::model::Recipe;

/// An outline, and indices of the parts that are holes in it.
struct Island {
    outline: usize,
    holes: Vec<usize>,
}

impl Builder<'_> {
    /// Flat regions, drawn out.
    pub(super) fn extrusion(&mut self, extrude: &Extrude) -> Option<Recipe> {
        let (outlines, islands) = self.islands(&extrude.profile, extrude.fill.value, &extrude.holes)?;
        if let Some(moving) = moving_extrusion(extrude, (&outlines, &islands)) {
            return Some(Recipe::Sweep(moving));
        }
        let height = extrude.height.value;
        let bottom = if extrude.centered.value { -height / 2.0 } else { 0.0 };
        let edge = edge_profile(extrude, bottom);
        if let Some(edge) = &edge {
            self.check_width(extrude, edge, (&outlines, &islands))?;
        }
        Some(Recipe::Extrusion(Extrusion {
            outlines,
            islands,
            bottom,
            height,
            caps: extrude.caps.value,
            edge,
        }))
    }

    /// Flat regions as they are.
    pub(super) fn sheet(&mut self, sheet: &SheetFields) -> Option<Recipe> {
        let (outlines, islands) = self.islands(&sheet.profile, sheet.fill.value, &sheet.holes)?;
        Some(Recipe::Sheet(Sheet { outlines, islands }))
    }

    /// What a profile and its holes enclose: for each island its outline and its holes, and how many these are.
    fn islands(
        &mut self,
        profile: &CurveReference,
        fill: Fill,
        holes: &[CurveReference],
    ) -> Option<(Vec<AnyCurve>, Vec<usize>)> {
        let parts = self.closed_parts(profile, "outline", "outline's part");
        self.cut_out(parts, fill, holes, profile.span())
    }

    /// The same of parts of an outline that are known.
    pub(super) fn cut_out(
        &mut self,
        parts: Option<Vec<Profile>>,
        fill: Fill,
        holes: &[CurveReference],
        span: Span,
    ) -> Option<(Vec<AnyCurve>, Vec<usize>)> {
        let named = holes.iter().enumerate();
        let holes: Vec<_> = named
            .map(|(index, hole)| {
                let mut parts = self.closed_parts(hole, "hole", "hole's part")?;
                let field = format!("`holes[{index}]`");
                parts.iter_mut().for_each(|part| part.name = part.name.replacen("hole", &field, 1));
                Some(parts)
            })
            .collect();
        let holes: Option<Vec<_>> = holes.into_iter().collect();
        let (mut parts, holes) = (parts?, holes?.into_iter().flatten().collect::<Vec<_>>());
        parts.iter_mut().for_each(|part| part.name.insert_str(0, "the "));
        let islands = if parts.len() == 1 {
            vec![Island { outline: 0, holes: Vec::new() }]
        } else {
            self.sort(&parts, fill, span)?
        };
        let mut outlines = Vec::new();
        let mut counts = Vec::new();
        for (island, cut) in islands.iter().zip(self.holes_of(&islands, &parts, &holes)?) {
            let own = island.holes.iter().map(|index| &parts[*index]);
            let all: Vec<&Profile> = own.chain(cut).collect();
            self.check_holes(&parts[island.outline], &all)?;
            counts.push(1 + all.len());
            outlines.push(parts[island.outline].curve.clone());
            outlines.extend(all.into_iter().map(|hole| hole.curve.clone()));
        }
        Some((outlines, counts))
    }

    /// All parts of a curve, each as a closed profile: named `one` where there is one, else `many` and a number.
    pub(super) fn closed_parts(
        &mut self,
        reference: &CurveReference,
        one: &str,
        many: &str,
    ) -> Option<Vec<Profile>> {
        let parts = self.parts_of(reference)?;
        let count = parts.len();
        let profiles: Vec<_> = (parts.into_iter().enumerate())
            .map(|(index, part)| {
                let name = if count == 1 { one.to_owned() } else { format!("{many} {index}") };
                self.closed_profile_of(part, &name, reference.span())
            })
            .collect();
        profiles.into_iter().collect()
    }

    /// Parts that lie apart or inside each other, sorted by what they enclose.
    fn sort(&mut self, parts: &[Profile], fill: Fill, span: Span) -> Option<Vec<Island>> {
        self.apart(parts, span)?;
        let places: Vec<Vec<DVec2>> = parts.iter().map(Profile::places).collect();
        Some(islands(&places, fill))
    }

    /// Parts must not meet.
    pub(super) fn apart(&mut self, parts: &[Profile], span: Span) -> Option<()> {
        let all: Vec<&Profile> = parts.iter().collect();
        let places: Vec<Vec<DVec2>> = parts.iter().map(Profile::places).collect();
        let Some(Contact { first, second, point }) = meeting(&all, &places) else { return Some(()) };
        let message = format!("parts {first} and {second} of the outline meet near {}", place(point));
        let report = Diagnostic::error(Code::PartsMeet, message)
            .at(span, "parts lie apart or inside each other")
            .help("join them first: `{ union = { of = [...] } }`");
        self.report(report);
        None
    }

    /// The written holes of each island.
    fn holes_of<'p>(
        &mut self,
        islands: &[Island],
        parts: &[Profile],
        holes: &'p [Profile],
    ) -> Option<Vec<Vec<&'p Profile>>> {
        let mut found: Vec<Vec<&Profile>> = vec![Vec::new(); islands.len()];
        for hole in holes {
            let start = hole.places()[0];
            let inside = |island: &Island| {
                let within = |index: usize| encloses(&parts[index].places(), start);
                within(island.outline) && !island.holes.iter().any(|index| within(*index))
            };
            match islands.iter().position(inside) {
                Some(index) => found[index].push(hole),
                // One outline tells more closely how the hole lies.
                None if islands.len() == 1 => found[0].push(hole),
                None => {
                    let message = format!("{} lies inside no part of the outline", hole.name);
                    let report = Diagnostic::error(Code::BadHole, message)
                        .at(hole.span, "this hole")
                        .help("holes lie inside the outline and apart from each other");
                    self.report(report);
                    return None;
                }
            }
        }
        Some(found)
    }
}

/// Sorts outlines that do not meet. An outline bounds what is filled when the fill rule holds on one side of it
/// alone; what lies in an outline and bounds its inside is a hole of the smallest one around it.
fn islands(places: &[Vec<DVec2>], fill: Fill) -> Vec<Island> {
    let turns: Vec<i32> = places.iter().map(|place| if twice_area(place) < 0.0 { -1 } else { 1 }).collect();
    let around: Vec<Vec<usize>> = (0..places.len())
        .map(|k| (0..places.len()).filter(|j| *j != k && encloses(&places[*j], places[k][0])).collect())
        .collect();
    let filled = |winding: i32| match fill {
        Fill::NonZero => winding != 0,
        Fill::EvenOdd => winding % 2 != 0,
    };
    let sides = |k: usize| {
        let outside: i32 = around[k].iter().map(|j| turns[*j]).sum();
        (filled(outside + turns[k]), filled(outside))
    };
    let mut islands: Vec<Island> = (0..places.len())
        .filter(|k| sides(*k) == (true, false))
        .map(|outline| Island { outline, holes: Vec::new() })
        .collect();
    for hole in (0..places.len()).filter(|k| sides(*k) == (false, true)) {
        // The more outlines lie around an outline, the nearer it is.
        let nearest = islands
            .iter_mut()
            .filter(|island| around[hole].contains(&island.outline))
            .max_by_key(|island| around[island.outline].len());
        if let Some(island) = nearest {
            island.holes.push(hole);
        }
    }
    islands
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{Fill, islands};

    /// A square about the origin; a negative size turns clockwise.
    fn square(size: f64) -> Vec<DVec2> {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let points = corners.map(|(x, y)| DVec2::new(x * size.abs(), y * size.abs()));
        if size < 0.0 { points.into_iter().rev().collect() } else { points.to_vec() }
    }

    fn sorted(sizes: &[f64], fill: Fill) -> Vec<(usize, Vec<usize>)> {
        let places: Vec<_> = sizes.iter().map(|size| square(*size)).collect();
        islands(&places, fill).into_iter().map(|island| (island.outline, island.holes)).collect()
    }

    #[test]
    fn rings_in_rings_are_islands_in_holes() {
        let nested = [(0, vec![1]), (2, vec![3])];
        assert_eq!(sorted(&[4.0, 3.0, 2.0, 1.0], Fill::EvenOdd), nested);
        assert_eq!(sorted(&[4.0, -3.0, 2.0, -1.0], Fill::NonZero), nested);
        assert_eq!(sorted(&[-4.0, 3.0, -2.0, 1.0], Fill::NonZero), nested);
        // The order in which they are written does not matter.
        assert_eq!(sorted(&[1.0, 3.0, 2.0, 4.0], Fill::EvenOdd), [(2, vec![0]), (3, vec![1])]);
    }

    #[test]
    fn outlines_that_change_nothing_bound_nothing() {
        assert_eq!(sorted(&[4.0, 3.0, 2.0], Fill::NonZero), [(0, vec![])]);
        // Twice around, once back: still inside.
        assert_eq!(sorted(&[4.0, 3.0, -2.0], Fill::NonZero), [(0, vec![])]);
        assert_eq!(sorted(&[4.0, 3.0, -2.0, -1.0], Fill::NonZero), [(0, vec![3])]);
    }
}

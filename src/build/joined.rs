//! Surfaces of several shapes as one skin into a recipe.

use glam::{DAffine3, DVec3};

use super::Builder;
use super::patch::{MOST_REPORTS, broken_between, continuity};
use super::profile::show;
use crate::geometry::mesh;
use crate::geometry::surface::{
    AnySurface, PatchContinuity, PlacedSurface, Rim, Surface as _, SurfaceJoint, SurfaceJoints, SurfaceLine,
    joints,
};
use crate::geometry::tessellate::Patchwork;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::model::{MaterialHandle, Recipe};

/// A shape whose surfaces are joined to others.
struct Part {
    name: String,
    span: Span,
    placement: DAffine3,
    material: Option<MaterialHandle>,
    shape: Patchwork,
}

impl Builder<'_> {
    /// The recipe and where all parts stand.
    pub(super) fn joined_surfaces(
        &mut self,
        name: &str,
        written: &spec::Joined,
    ) -> Option<(Recipe, DAffine3)> {
        let parts: Vec<Option<Part>> =
            written.of.iter().enumerate().map(|(index, of)| self.part_to_join(name, index, of)).collect();
        let parts: Vec<Part> = parts.into_iter().collect::<Option<_>>()?;
        // What stands at one place is joined there; else each surface goes to its own before.
        let common = parts[0].placement;
        let together = parts.iter().all(|part| part.placement == common);
        let placement = if together { common } else { DAffine3::IDENTITY };
        let mut whole = Patchwork { surfaces: Vec::new(), caps: Vec::new() };
        let mut owners = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            let first = mesh::index(whole.surfaces.len());
            let moved =
                |rims: &Vec<(u32, Rim)>| rims.iter().map(|(surface, rim)| (first + surface, *rim)).collect();
            whole.caps.extend(part.shape.caps.iter().map(moved));
            let surfaces = part.shape.surfaces.iter().cloned();
            whole.surfaces.extend(surfaces.map(|surface| match together {
                true => surface,
                false => AnySurface::Placed(Box::new(PlacedSurface::new(surface, part.placement))),
            }));
            owners.resize(whole.surfaces.len(), index);
        }
        let found = joints(&whole.surfaces);
        let good = self.check_common_sides(&parts, &owners, (&whole.surfaces, &found));
        let smooth = self.check_joined(written, (&parts, &owners), &found);
        let mut materials: Vec<_> = owners.iter().map(|part| parts[*part].material).collect();
        if materials.iter().all(Option::is_none) {
            materials.clear();
        }
        (good && smooth).then_some((Recipe::Patches { patches: whole, materials }, placement))
    }

    fn part_to_join(&mut self, name: &str, index: usize, of: &spec::ShapeReference) -> Option<Part> {
        let handle = self.shape_of(name, index, of)?;
        let shape = self.model.shape(handle);
        let placement = shape.options.placement;
        if let Recipe::Patches { patches, .. } = &shape.recipe {
            let name = format!("`{}`", shape.name);
            let material = shape.options.material;
            return Some(Part { name, span: of.span(), placement, material, shape: patches.clone() });
        }
        let report = Diagnostic::error(Code::NoSurface, "this shape is no surface over parameters u and v")
            .at(of.span(), "cannot be joined by its sides")
            .help("shapes of any kind stand together in a `group`, which does not share their points");
        self.report(report);
        None
    }

    /// Whether each part shares a side with another one, and runs along it as the other does.
    fn check_common_sides(
        &mut self,
        parts: &[Part],
        owners: &[usize],
        (surfaces, found): (&[AnySurface], &SurfaceJoints),
    ) -> bool {
        let mut good = true;
        for joint in found.joints.iter().filter(|joint| !joint.smoothness.same_parameters) {
            let [(one, _), (other, _)] = joint.lines;
            let (one, other) = (&parts[owners[one]], &parts[owners[other]]);
            let message = format!(
                "{} and {} have a line in common, but their parameters run along it in different ways",
                one.name, other.name
            );
            let report = Diagnostic::error(Code::ApartSurfaces, message)
                .at(other.span, "cannot be cut at the same points")
                .also(one.span, "the other")
                .help("make both sides from one curve");
            self.report(report);
            good = false;
        }
        for (index, part) in parts.iter().enumerate() {
            let touches = |joint: &SurfaceJoint| {
                let [one, other] = joint.lines.map(|(surface, _)| owners[surface]);
                one != other && (one == index || other == index)
            };
            if found.joints.iter().any(touches) {
                continue;
            }
            let (message, place) = match parts {
                [one, other] => (format!("{} and {} share no side", one.name, other.name), other.span),
                _ => (format!("{} shares no side with the other surfaces", part.name), part.span),
            };
            let mut report = Diagnostic::error(Code::ApartSurfaces, message).at(place, "joined to nothing");
            if let Some(gap) = nearest_side(surfaces, owners, index) {
                report = report.note(format!("the nearest two sides are {} apart", show(gap)));
            }
            self.report(report.help("sides are shared where they are one line from end to end"));
            good = false;
            // Of two surfaces the other one would say the same.
            if parts.len() == 2 {
                break;
            }
        }
        good
    }

    /// Whether all joints between parts are as smooth as declared.
    fn check_joined(
        &mut self,
        written: &spec::Joined,
        (parts, owners): (&[Part], &[usize]),
        found: &SurfaceJoints,
    ) -> bool {
        let Some(declared) = written.continuity else { return true };
        let wanted: PatchContinuity = continuity(declared.value);
        let within = written.continuity_angle.value;
        let between =
            |joint: &&SurfaceJoint| joint.lines.iter().all(|(_, line)| matches!(line, SurfaceLine::Rim(_)));
        let broken: Vec<&SurfaceJoint> = (found.joints.iter().filter(between))
            .filter(|joint| !joint.smoothness.holds(wanted, within))
            .collect();
        for joint in broken.iter().take(MOST_REPORTS) {
            let [one, other] = joint.lines.map(|(surface, _)| &parts[owners[surface]]);
            let lines = format!("{} and {}", one.name, other.name);
            let report = Diagnostic::error(Code::BrokenSeam, broken_between(&lines, joint, wanted))
                .at(declared.span, format!("{wanted} does not hold"))
                .also(one.span, "one side")
                .also(other.span, "the other");
            self.report(report);
        }
        broken.is_empty()
    }
}

/// How far the nearest side of one part lies from a side of another: at their ends and middles, the worst of the three.
fn nearest_side(surfaces: &[AnySurface], owners: &[usize], part: usize) -> Option<f64> {
    let places = |surface: &AnySurface, rim: Rim| {
        [0.0, 0.5, 1.0].map(|share| -> DVec3 {
            let (x, y) = rim.place(share);
            surface.evaluate(surface.domain_u().at(x), surface.domain_v().at(y)).point
        })
    };
    let mut least = None;
    for (one, own) in surfaces.iter().zip(owners).filter(|(_, owner)| **owner == part) {
        for (other, _) in surfaces.iter().zip(owners).filter(|(_, owner)| *owner != own) {
            for (a, b) in Rim::ALL.into_iter().flat_map(|a| Rim::ALL.map(|b| (a, b))) {
                let (a, b) = (places(one, a), places(other, b));
                let away = |order: [usize; 3]| {
                    order.iter().zip(&a).map(|(k, place)| place.distance(b[*k])).fold(0.0, f64::max)
                };
                let gap = away([0, 1, 2]).min(away([2, 1, 0]));
                least = Some(least.map_or(gap, |least: f64| least.min(gap)));
            }
        }
    }
    least
}

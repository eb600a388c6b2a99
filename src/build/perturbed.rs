//! Perturbed patches into recipes.

use glam::DVec3;

use super::Builder;
use super::profile::show;
use crate::geometry::field::{AnyField, Relief, ReliefBump};
use crate::geometry::tessellate::{NetBase, NetBump, NoSolid, PerturbedNet, PerturbedSkin, SkinFault};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{PatchBump, PerturbedPatches};
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn perturbed_patches(&mut self, written: &PerturbedPatches, span: Span) -> Option<Recipe> {
        let bumps: Vec<_> = written.bumps.iter().map(|bump| self.patch_bump(&bump.value)).collect();
        let bumps: Option<Vec<_>> = bumps.into_iter().collect();
        let base = match (&written.center, written.spherical.value) {
            (Some(center), true) => NetBase::Ball(center.value),
            (Some(center), false) => NetBase::FlatAround(center.value),
            (None, _) => NetBase::Flat,
        };
        let net = PerturbedNet {
            points: written.points.iter().map(|point| point.value).collect(),
            faces: written.faces.iter().map(|face| face.value.clone()).collect(),
            base,
            bumps: bumps?,
            reach: written.reach.map(|reach| reach.value),
            depth: written.depth.map(|depth| depth.value),
        };
        match PerturbedSkin::new(&net) {
            Ok(skin) => Some(Recipe::Perturbed(Box::new(skin))),
            Err(fault) => {
                self.report(refusal(&fault, written, span));
                None
            }
        }
    }

    fn patch_bump(&mut self, written: &PatchBump) -> Option<NetBump> {
        let field = self.field_of(&written.field)?;
        let Some(relief) = Relief::of(&field) else {
            let message = format!(
                "the Q of a bump is a quadric, or a quadric perturbed by such; this is {}",
                what(&field)
            );
            let report =
                Diagnostic::error(Code::PatchBump, message).at(written.field.span(), "not a quadric");
            let help = "a ball of radius 1/5 is `{ quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [x, y, z] }`";
            self.report(report.help(help));
            return None;
        };
        let mut faces = written.faces.as_ref().map(|faces| faces.value.clone());
        if let Some(faces) = &mut faces {
            faces.sort_unstable();
            faces.dedup();
        }
        Some(NetBump { bump: ReliefBump::new(relief, written.factor.value), faces })
    }
}

/// A field that is no relief, in words.
fn what(field: &AnyField) -> &'static str {
    match field {
        AnyField::Primitive(_) => "the distance to a body",
        AnyField::Shape(_) | AnyField::Distance(_) => "the distance to a shape",
        AnyField::Skeleton(_) => "a skeleton",
        AnyField::Formula(_) => "a formula",
        AnyField::Joined(_) => "several fields joined",
        AnyField::Skin { .. } => "the skin of a field",
        AnyField::Placed(placed) => what(&placed.of),
        AnyField::Grown { of, .. } => what(of),
        AnyField::Sum(_) | AnyField::Perturbed(_) | AnyField::Quadric(_) => "made of other fields",
    }
}

fn refusal(fault: &SkinFault, written: &PerturbedPatches, span: Span) -> Diagnostic {
    let face = |face: &u32| written.faces[*face as usize].span;
    let point = |point: &u32| written.points[*point as usize].span;
    let error = |code: Code| Diagnostic::error(code, fault.to_string());
    match fault {
        SkinFault::ZeroCorner { face: at, point: corner } => error(Code::BadPatch)
            .at(face(at), "no area")
            .also(point(corner), "this corner")
            .help("corners are apart, and no side runs back along the one before it"),
        SkinFault::Crossing { face: at } => error(Code::BadPatch)
            .at(face(at), "crosses itself")
            .help("write the corners in their order around the face"),
        SkinFault::NotFlat { face: at, point: corner, off } => {
            let message = format!("face {at} is not flat: point {corner} lies {} from its plane", show(*off));
            Diagnostic::error(Code::BadPatch, message)
                .at(face(at), "not flat")
                .also(point(corner), "off the plane of all corners")
                .help("move the point, or cut the face into triangles")
        }
        SkinFault::Antipodal { face: at, ends } => error(Code::BadPatch)
            .at(face(at), "no shortest side")
            .also(point(&ends[0]), "one end")
            .also(point(&ends[1]), "the other end")
            .help("put a point between them, and cut the face there"),
        SkinFault::TooWide { face: at } => error(Code::PatchSight)
            .at(face(at), "too wide")
            .help("cut it into smaller faces; the center lies well behind each of them"),
        SkinFault::OffBall { point: corner, found, radius } => {
            let message = format!(
                "point {corner} lies {} from the center, the first corner {}: not on one ball",
                show(*found),
                show(*radius)
            );
            let help = "move it, or leave `spherical` out: flat faces may have any points";
            Diagnostic::error(Code::PatchSight, message).at(point(corner), "off the ball").help(help)
        }
        SkinFault::LooksInward { face: at } => error(Code::PatchSight)
            .at(face(at), "does not look away from the center")
            .help("corners run counterclockwise seen from outside, and the center lies behind the face"),
        SkinFault::SharedSide { .. } => error(Code::PatchSide)
            .at(span, "not the skin of a body")
            .help("at each side one face, or two that run along it in opposite directions"),
        SkinFault::Parted { bump, faces, place } => {
            let place = near(*place);
            let report = Diagnostic::error(Code::PatchesPart, format!("{fault}, near {place}"));
            report
                .at(written.bumps[*bump].span, "reaches over their side")
                .also(face(&faces[0]), "one face")
                .also(face(&faces[1]), "the other face")
                .help(parted_help(written, *bump))
        }
        SkinFault::Lost { face: at, place, inward } => {
            let report = Diagnostic::error(Code::PatchReach, format!("{fault}, near {}", near(*place)));
            let report = report.at(face(at), "its surface");
            report.help(match (inward, &written.center) {
                (true, Some(_)) => "a hollow that reaches the center leaves nothing; write a smaller `factor`, or a larger `reach`",
                _ => "write a larger `reach`, or bumps that end, as those of ellipsoids do",
            })
        }
        SkinFault::Overhang { face: at, place, why } => {
            let report = Diagnostic::error(Code::PatchOverhang, format!("{fault}, near {}", near(*place)));
            let report = report.at(face(at), "overhangs here").note(reason(*why));
            report.help("write a smaller `factor` or a wider bump; or build the body as a field")
        }
    }
}

fn parted_help(written: &PerturbedPatches, bump: usize) -> &'static str {
    match (&written.center, &written.bumps[bump].value.faces) {
        (_, Some(_)) => "leave `faces` out, or keep the bump inside of them",
        (None, None) => "faces that look apart grow apart: keep the bump inside of one, or write a `center`",
        (Some(_), None) => "keep the bump away from the side",
    }
}

fn reason(why: NoSolid) -> &'static str {
    match why {
        NoSolid::Open => "a solid is made of one face alone, or of a closed skin",
        NoSolid::NoCenter => "a closed skin is made a solid about its `center`",
        NoSolid::OwnBumps => "a closed skin is made a solid where its bumps are for all faces",
        NoSolid::NotConvex => "a solid is made of convex faces",
    }
}

/// A place for a person.
fn near(DVec3 { x, y, z }: DVec3) -> String {
    let number = |x: f64| {
        let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
        (rounded + 0.0).to_string()
    };
    format!("[{}, {}, {}]", number(x), number(y), number(z))
}

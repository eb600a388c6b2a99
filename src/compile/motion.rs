//! What is said of skins and clips that cannot be made as they are asked for.

use super::place;
use crate::build::Built;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::model::{ShapeHandle, WeightRule};
use crate::realize::{Loose, RealizeError};

/// The diagnostic for a skin that has no weights; none for other errors.
pub(super) fn refused(built: &Built, shape: ShapeHandle, error: &RealizeError) -> Option<Diagnostic> {
    let name = &built.model.shape(shape).name;
    let (skin, message) = match error {
        RealizeError::SkinnedWire { skin } => (
            *skin,
            format!("shape `{name}` cannot be skinned: it has lines, and joints carry triangles alone"),
        ),
        RealizeError::Unweighted { skin, count, of, place, distance } => {
            let [x, y, z] = place.to_array().map(short);
            let distance = short(*distance);
            (
                *skin,
                format!(
                    "{count} of the {of} points of shape `{name}` are carried by no joint, one of them at [{x}, {y}, {z}], {distance} from the nearest bone"
                ),
            )
        }
        RealizeError::Unseen { skin, parts, count, of, place, nearest } => {
            let [x, y, z] = place.to_array().map(short);
            let bones = &built.model.skeletons[built.model.skins[*skin].skeleton].skeleton.joints;
            let (which, nearest) = (
                if *parts == 1 { "a part".to_owned() } else { format!("{parts} parts") },
                &bones[*nearest].bone.name,
            );
            let message = format!(
                "{which} of shape `{name}`, with {count} of its {of} points, cannot be heated: at [{x}, {y}, {z}] the nearest bone, of joint `{nearest}`, lies behind the surface, and so everywhere on it"
            );
            (*skin, message)
        }
        _ => return None,
    };
    let span = built.skin_places.get(skin).copied().unwrap_or(Span::NONE);
    let unseen = matches!(error, RealizeError::Unseen { .. });
    let report = Diagnostic::error(if unseen { Code::UnseenBones } else { Code::Unweighted }, message)
        .at(span, "this skin")
        .also(place(built, shape), "this shape");
    Some(match (&built.model.skins[skin].rule, error) {
        (_, RealizeError::SkinnedWire { .. }) => {
            report.help("draw a thin profile along its curves with `sweep`")
        }
        (_, RealizeError::Unseen { .. }) => report.help(
            "let a bone of its own run through it, join it to the rest with `union`, or write `weights = \"rigid\"`",
        ),
        (WeightRule::Given(_), _) => report.help("the points of the shape are not those of its file"),
        (WeightRule::Perturbation(_), _) => {
            report.help("let a wider bump of some joint reach them: a quadric is negative inside")
        }
        (WeightRule::Explicit(_), _) => report.help("write formulas that are greater than 0 there"),
        _ => report
            .help("write a greater `radius` or `falloff` for the joints near it, or `weights = \"rigid\"`"),
    })
}

/// The warning for a motion that is not within its tolerance.
pub(super) fn loose(built: &Built, one: &Loose) -> Diagnostic {
    let clip = &built.model.clips[one.clip];
    let span = built.clip_places.get(one.clip).copied().unwrap_or(Span::NONE);
    let (unit, what) = if one.property.is_some() { ("", "changes") } else { (" m", "motion") };
    let message = format!(
        "clip `{}` is written up to {:.3e}{unit} from its exact {what}, more than its tolerance of {:.3e}{unit}",
        clip.name, one.bound, one.tolerance
    );
    Diagnostic::warning(Code::LooseMotion, message)
        .at(span, "this clip")
        .note("where a motion jumps or changes faster than it is sampled, more keys do not come nearer")
        .help("write a higher `rate`, a coarser `tolerance`, or jumps as keys with `between = \"step\"`")
}

/// The warning for a clip that changes a material that nothing shows.
pub(super) fn unseen(built: &Built, clip: usize, material: &str) -> Diagnostic {
    let span = built.clip_places.get(clip).copied().unwrap_or(Span::NONE);
    let name = &built.model.clips[clip].name;
    let message = format!("clip `{name}` changes material `{material}`, which nothing shows");
    Diagnostic::warning(Code::UnseenChange, message)
        .at(span, "this clip")
        .help("give the material to a shape or node that is shown, or leave the track out")
}

/// A number with few digits.
fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.4e}").parse().unwrap_or(number);
    rounded.to_string()
}

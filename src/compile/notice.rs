//! What is said of the faces of a shape that is made, though not as it was perhaps meant.

use super::place;
use crate::build::Built;
use crate::gltf::Profile;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::Spec;
use crate::model::ShapeHandle;
use crate::optimize;
use crate::realize::{Faces, Note};

/// How a note reads.
struct Words {
    code: Code,
    /// After `face 3`.
    one: &'static str,
    /// After `7 faces`.
    many: &'static str,
    help: Option<&'static str>,
}

/// The warning for a note of faces: at the face, where the document writes faces, or else at the shape.
pub(super) fn noticed(built: &Built, shape: ShapeHandle, note: &Note) -> Option<Diagnostic> {
    let name = &built.model.shape(shape).name;
    let written = written_faces(built, shape);
    let (faces, words) = words(note, !written.is_empty())?;
    let message = match faces.count {
        1 => format!("shape `{name}`: face {} {}", faces.first, words.one),
        count => format!("shape `{name}`: {count} faces {}, the first is face {}", words.many, faces.first),
    };
    let report = Diagnostic::warning(words.code, message);
    let report = match written.get(faces.first as usize) {
        Some(face) => report.at(*face, "this face"),
        None => report.at(place(built, shape), "this shape"),
    };
    Some(words.help.into_iter().fold(report, Diagnostic::help))
}

fn written_faces(built: &Built, shape: ShapeHandle) -> &[Span] {
    built.faces.get(shape.0 as usize).map_or(&[], Vec::as_slice)
}

fn words(note: &Note, written: bool) -> Option<(&Faces, Words)> {
    Some(match note {
        Note::Dropped(faces) if written => (faces, DROPPED),
        Note::Dropped(faces) => (faces, Words { code: Code::ImportNote, ..DROPPED }),
        Note::Flat(faces) => (faces, FLAT),
        Note::Crossing(faces) => (faces, CROSSING),
        Note::Triangulated(faces) => (faces, TRIANGULATED),
        Note::Classes(_) => return None,
    })
}

const TRIANGULATED: Words = Words {
    code: Code::NeedsTriangles,
    one: "of the cage is cut into triangles first, as the scheme is one of triangles",
    many: "of the cage are cut into triangles first, as the scheme is one of triangles",
    help: None,
};

const DROPPED: Words = Words {
    code: Code::FlatFace,
    one: "has corners at one place and is left out",
    many: "have corners at one place and are left out",
    help: None,
};

const FLAT: Words = Words {
    code: Code::FlatFace,
    one: "has no area: its corners lie on one line, or its outline runs back the way it came",
    many: "have no area: their corners lie on one line, or their outlines run back the way they came",
    help: None,
};

const CROSSING: Words = Words {
    code: Code::FoldedFace,
    one: "crosses itself: its triangles fold over each other",
    many: "cross themselves: their triangles fold over each other",
    help: Some(
        "name the corners in the order in which they follow each other around the face; holes lie inside of their outline",
    ),
};

/// What is said where whole numbers would move positions too far.
pub(super) fn too_coarse(profile: Profile, coarse: &optimize::TooCoarse, spec: &Spec) -> Diagnostic {
    let message = format!(
        "profile `{}` keeps its positions in single precision: on a grid of 16 bits over the whole model they would move by up to {:.3e} m, and half of the tolerance, {:.3e} m, is what rounding may take",
        profile.name(),
        coarse.moved,
        coarse.allowed
    );
    let place = spec.tolerance.as_ref().map_or(Span::NONE, |tolerance| tolerance.span);
    Diagnostic::warning(Code::CoarseGrid, message)
        .at(place, "")
        .help("write a coarser `tolerance`, or split the model into documents of their own")
}

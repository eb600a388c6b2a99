//! Solids that cannot be made, in words.

use super::place;
use crate::build::Built;
use crate::geometry::solid::SolidFault;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::model::{Recipe, ShapeHandle, SolidOperation};

/// A solid that was refused, and the part of it that is to blame.
pub(super) fn refused(
    built: &Built,
    shape: ShapeHandle,
    part: Option<ShapeHandle>,
    fault: &SolidFault,
) -> Diagnostic {
    let name = &built.model.shape(shape).name;
    let what = match part {
        Some(part) => format!("its part `{}` {fault}", built.model.shape(part).name),
        None => fault.to_string(),
    };
    let (code, help) = advice(built, shape, fault);
    let report = Diagnostic::error(code, format!("shape `{name}` cannot be made: {what}"))
        .at(place(built, shape), "this shape")
        .help(help);
    match part.filter(|part| place(built, *part) != place(built, shape)) {
        Some(part) => report.also(place(built, part), "the part"),
        None => report,
    }
}

fn advice(built: &Built, shape: ShapeHandle, fault: &SolidFault) -> (Code, &'static str) {
    match fault {
        SolidFault::NoFaces { .. } | SolidFault::Lines { .. } => {
            (Code::NotClosed, "use shapes that enclose something; a thin sweep along a curve does")
        }
        SolidFault::Open { .. } => (
            Code::NotClosed,
            "close it with caps or `thickness`; an imported file may need `weld`, and a mesh more faces",
        ),
        SolidFault::Misoriented { .. } => {
            (Code::NotClosed, "list the corners of all faces counter-clockwise, seen from outside")
        }
        SolidFault::NoVolume { .. } => (Code::InsideOut, "give it some thickness"),
        SolidFault::InsideOut { .. } => {
            (Code::InsideOut, "turn its faces round: list their corners counter-clockwise, seen from outside")
        }
        SolidFault::Crossing { .. } => {
            (Code::CrossesItself, "put it together from parts that do not cross themselves, as a `union`")
        }
        SolidFault::Nothing => (Code::NoSolid, nothing(built, shape)),
        SolidFault::Flat => (Code::NoSolid, "add a point or a shape outside of that plane"),
        SolidFault::NoFace { .. } => {
            (Code::NoFaceThere, "name the plane of a flat face of the shape, its normal looking out")
        }
        SolidFault::TooMuch { .. } => {
            (Code::LimitPassed, "write a coarser `tolerance`, or round a simpler shape")
        }
        SolidFault::Scattered { .. } => (Code::LimitPassed, "name a shape of fewer bodies"),
        SolidFault::Missing => (Code::MissingFeature, "build Kiln with `features = [\"csg\"]`"),
        SolidFault::Engine(_) => (Code::NoSolid, "this is a bug of Kiln; please report it with the document"),
    }
}

/// What to do where nothing is left.
fn nothing(built: &Built, shape: ShapeHandle) -> &'static str {
    let Recipe::Solid(solid) = &built.model.shape(shape).recipe else { return "see its parts" };
    match &solid.operation {
        SolidOperation::Combine(_) => {
            "what is taken away covers everything, or the shapes have nothing but faces in common"
        }
        SolidOperation::Cut(_) => {
            "the plane leaves the shape on the side that is taken away; write another `keep`"
        }
        SolidOperation::Shell(_) => "the wall fills the shape; write a smaller `thickness`",
        SolidOperation::Round(_) => {
            "the shape is thinner than the ball that shrinks it; write a smaller `radius`"
        }
        SolidOperation::Hull(_) => "see its parts",
    }
}

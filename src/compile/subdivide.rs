//! Cages that cannot be refined, in words.

use super::place;
use crate::build::Built;
use crate::geometry::subdivide::SubdivideFault;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::model::ShapeHandle;

/// A subdivision that was refused, and its cage.
pub(super) fn refused(
    built: &Built,
    shape: ShapeHandle,
    cage: ShapeHandle,
    fault: &SubdivideFault,
) -> Diagnostic {
    let name = &built.model.shape(shape).name;
    let (code, help) = advice(fault);
    let report = Diagnostic::error(code, format!("shape `{name}` cannot be made: {fault}"))
        .at(place(built, shape), "this shape")
        .help(help);
    if place(built, cage) == place(built, shape) {
        report
    } else {
        report.also(place(built, cage), "the cage")
    }
}

fn advice(fault: &SubdivideFault) -> (Code, &'static str) {
    match fault {
        SubdivideFault::NoEdge { .. } => {
            (Code::NoCageEdge, "name two neighbors along a side of a face; vertices count from 0")
        }
        SubdivideFault::NoCreases => (
            Code::NoCageEdge,
            "write `edges` or `crease-angle`; OBJ files say it by lines such as `t crease 2/1/0 0 1 2.5`",
        ),
        SubdivideFault::NoVertex { .. } => (Code::NoCageEdge, "vertices count from 0"),
        SubdivideFault::NotTriangles { .. } => (
            Code::NeedsTriangles,
            "write `triangulate = true`, or a scheme of polygons such as \"catmull-clark\"",
        ),
        SubdivideFault::OddLevels { .. } => {
            (Code::OddLevels, "write an even number of `levels`, or close the cage")
        }
        SubdivideFault::Opposed { .. } => {
            (Code::BadCage, "list the corners of all faces counter-clockwise, seen from outside")
        }
        SubdivideFault::Pinched { .. } => (Code::BadCage, "give each part a vertex of its own there"),
        SubdivideFault::Isolated { .. } => (Code::BadCage, "leave the vertex out"),
        SubdivideFault::ManyFaces { .. } => (Code::BadCage, "at most two faces may share an edge"),
        SubdivideFault::Holes { .. } => (Code::BadCage, "cut the face into faces without holes"),
        _ => (Code::BadCage, "check the faces of the cage"),
    }
}

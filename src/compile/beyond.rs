//! Shapes that are further from their true surface than they should be: warnings.

use super::place;
use crate::build::Built;
use crate::geometry::number::{Bounds, single_rounding};
use crate::geometry::tessellate::Evidence;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::model::ShapeHandle;
use crate::report::{self, Report};
use crate::scene;

/// Shapes whose bound could not be brought under their tolerance.
pub(super) fn beyond_tolerance(
    scene: &scene::Scene,
    shapes: &[ShapeHandle],
    built: &Built,
) -> Vec<Diagnostic> {
    let beyond = |(geometry, shape): (&scene::Geometry, &ShapeHandle)| {
        let tolerance = geometry.tolerance?;
        let bound = geometry.deviation.bound;
        let bounds = Bounds::of_points(geometry.mesh.points.iter().copied()).union(geometry.wire.bounds());
        let rounding = single_rounding(bounds.reach());
        if bound <= tolerance && bound + rounding > tolerance {
            return Some(
                imprecise(&geometry.name, (bound, rounding, tolerance))
                    .at(place(built, *shape), "this shape"),
            );
        }
        (bound > tolerance * (1.0 + 1e-9)).then(|| {
            let sampled = if geometry.deviation.evidence == Evidence::Sampled { " (sampled)" } else { "" };
            let message = format!(
                "shape `{}` lies up to {bound:.3e} m from the true surface{sampled}, more than its tolerance of {tolerance:.3e} m",
                geometry.name
            );
            Diagnostic::warning(Code::TightBend, message)
                .at(place(built, *shape), "this shape")
                .note("where a surface folds, ends in a cusp, or turns sharply beside a corner, more triangles do not come nearer")
                .help("round or move that place, or write the `tolerance` that is enough for it")
        })
    };
    scene.geometries.iter().zip(shapes).filter_map(beyond).collect()
}

fn imprecise(name: &str, (bound, rounding, tolerance): (f64, f64, f64)) -> Diagnostic {
    let message = format!(
        "shape `{name}` lies up to {:.3e} m from the true surface, {rounding:.3e} m of that by rounding to single precision, more than its tolerance of {tolerance:.3e} m",
        bound + rounding
    );
    Diagnostic::warning(Code::BeyondPrecision, message)
        .help("model it near the origin and let a node carry it to its place, or write a coarser `tolerance`")
}

/// Shapes where dense sampling finds more than the bound.
pub(super) fn beyond_bound(report: &Report, shapes: &[ShapeHandle], built: &Built) -> Vec<Diagnostic> {
    let beyond = |((name, facts), shape): ((&String, &report::ShapeFacts), &ShapeHandle)| {
        let (found, bound) = (facts.deviation.measured?, facts.deviation.bound);
        (found > bound * (1.0 + 1e-9)).then(|| {
            let message = format!(
                "shape `{name}`: dense sampling finds {found:.3e} m from the true surface, more than the bound of {bound:.3e} m"
            );
            Diagnostic::warning(Code::TightBend, message)
                .at(place(built, *shape), "this shape")
                .help("where a section reaches beyond the center of a bend, or a path crosses itself, the surface folds over itself and distances to it mean little")
        })
    };
    report.shapes.iter().zip(shapes).filter_map(beyond).collect()
}

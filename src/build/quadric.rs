//! Quadrics into recipes.

use glam::DVec3;

use super::Builder;
use super::profile::show;
use crate::geometry::field::Quadric;
use crate::geometry::field::quadric::{QuadricForm, QuadricKind};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::{
    self, Ball, Clip, ClippedQuadric, Detail, SurfaceDensity, TessellateError,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn quadric(&mut self, written: &spec::Quadric, span: Span) -> Option<Recipe> {
        let quadric = Quadric::new(
            DVec3::new(written.xx.value, written.yy.value, written.zz.value),
            DVec3::new(written.xy.value, written.yz.value, written.zx.value),
            DVec3::new(written.x.value, written.y.value, written.z.value),
            written.constant.value,
        );
        let within = written.within.as_ref();
        let clip = within.map(|within| within.clip());
        let clip = clip.map(|clip| match clip {
            spec::QuadricClip::Box { min, max } => Clip::Box(Bounds { min: min.value, max: max.value }),
            spec::QuadricClip::Ball { center, radius } => {
                Clip::Ball(Ball { center: center.value, radius: radius.value })
            }
        });
        let shape = ClippedQuadric { quadric, within: clip, closed: written.caps.value };
        let place = within.map_or(span, spec::QuadricWithin::span);
        match fault(&shape, span, place) {
            None => Some(Recipe::Quadric(shape)),
            Some(report) => {
                self.report(report);
                None
            }
        }
    }
}

fn fault(shape: &ClippedQuadric, span: Span, place: Span) -> Option<Diagnostic> {
    let form = shape.form();
    let error = |message: String| Diagnostic::error(Code::NoQuadric, message);
    match form.kind {
        QuadricKind::Empty | QuadricKind::Everything => {
            let message = "no point satisfies this equation: the sum never becomes 0".to_owned();
            return Some(error(message).at(span, "no surface").help("look at the sign of `constant`"));
        }
        QuadricKind::Point | QuadricKind::Line => {
            let message =
                format!("this equation holds on a {} alone, {}", form.kind.text(), where_it_is(&form));
            return Some(
                error(message).at(span, "no surface").help("a smaller `constant` gives it a surface"),
            );
        }
        kind if kind != QuadricKind::Ellipsoid && shape.within.is_none() => {
            let kind = kind.text();
            let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
            let message = format!("this quadric is {article} {kind}, which goes on without end");
            let help =
                "write `within = { min = [-1, -1, -1], max = [1, 1, 1] }`, or `within = { radius = 1 }`";
            return Some(
                Diagnostic::error(Code::EndlessQuadric, message).at(span, "needs `within`").help(help),
            );
        }
        _ => {}
    }
    // Few triangles tell whether there is anything.
    let detail = Detail {
        density: SurfaceDensity::Tolerance(shape.bounds().diagonal() / 50.0),
        crease_angle: 0.0,
        uv: false,
        triangle_limit: 1 << 20,
    };
    match tessellate::quadric(shape, &detail) {
        Err(TessellateError::NoArea) => {
            let message = format!("this {} does not reach into `within`", form.kind.text());
            Some(error(message).at(place, "nothing of it is inside").note(where_it_is(&form)))
        }
        Err(TessellateError::Tangled) if matches!(shape.within, Some(Clip::Ball(_))) => {
            let message = format!("the ball touches this {} where it cuts it", form.kind.text());
            let report = error(message).at(place, "touches");
            Some(report.note(where_it_is(&form)).help("a little larger or smaller `radius` cuts it cleanly"))
        }
        _ => None,
    }
}

fn where_it_is(form: &QuadricForm) -> String {
    format!("at {}", vector(form.origin))
}

fn vector(DVec3 { x, y, z }: DVec3) -> String {
    format!("[{}, {}, {}]", show(x + 0.0), show(y + 0.0), show(z + 0.0))
}

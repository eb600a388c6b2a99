//! Formula surfaces of a document into patches.

use glam::{DVec2, DVec3};

use super::formula::{Compiled, Compiler};
use super::profile::show;
use super::{Builder, patch};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::surface::{AnySurface, Closing, FormulaSurface, Surface as _, SurfaceFault, thickened};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Formula as Written, Parametric, ShapeOptions, Sp};
use crate::model::Recipe;

impl Builder<'_> {
    /// Whether the material that a shape has itself is seen from both sides.
    pub(super) fn shows_both_sides(&mut self, options: &ShapeOptions) -> bool {
        let material = options.material.as_ref().and_then(|name| self.material(&name.value.0));
        material.is_some_and(|material| self.model.material(material).double_sided)
    }

    pub(super) fn parametric(&mut self, written: &Parametric, span: Span, two_sided: bool) -> Option<Recipe> {
        let mut compiler = Compiler::new(&["u", "v"]);
        let mut outputs = Vec::new();
        for formula in [&written.x, &written.y, &written.z] {
            let formula: &Sp<Written> = formula;
            match compiler.add(&formula.value) {
                Ok(slot) => outputs.push(slot),
                Err(diagnostic) => self.report(*diagnostic),
            }
        }
        if outputs.len() < 3 {
            return None;
        }
        let compiled = compiler.finish(outputs);
        let domain = |range: DVec2| Domain { start: range.x, end: range.y };
        let (u, v) = (domain(written.u.value), domain(written.v.value));
        let surface = match FormulaSurface::new(compiled.formula.clone(), u, v) {
            Ok(surface) => surface,
            Err(fault) => {
                self.report(refusal(&compiled, &fault, [u, v], span));
                return None;
            }
        };
        let closings = [surface.closing(true), surface.closing(false)];
        let asked = [("u", written.closed.value.u), ("v", written.closed.value.v)];
        let mut open = false;
        for (axis, (name, asked)) in asked.into_iter().enumerate() {
            if asked && !surface.is_closed(&closings[axis]) {
                self.report(gap(name, &closings[axis], written.closed.span));
                open = true;
            }
        }
        if open {
            return None;
        }
        let surfaces = match &written.thickness {
            Some(thickness) => {
                if let Some(report) = too_thick(&surface, thickness) {
                    self.report(report);
                    return None;
                }
                let sides = thickened(surface, thickness.value);
                sides.into_iter().map(|side| AnySurface::Thick(Box::new(side))).collect()
            }
            None => {
                if surface.is_one_sided() && !two_sided {
                    self.report(one_sided(span));
                }
                vec![AnySurface::Formula(Box::new(surface))]
            }
        };
        Some(patch::recipe(surfaces))
    }
}

/// What to say of a skin that would fold over itself.
fn too_thick(surface: &FormulaSurface, thickness: &Sp<f64>) -> Option<Diagnostic> {
    let (radius, (u, v)) = tightest(surface)?;
    let half = thickness.value / 2.0;
    if radius > half {
        return None;
    }
    let message = format!(
        "the surface bends with a radius of {} near u = {}, v = {}, and half of its thickness is {}",
        show(radius),
        show(u),
        show(v),
        show(half)
    );
    let report = Diagnostic::error(Code::TooThick, message)
        .at(thickness.span, "thicker than the bend has room for")
        .help("make it thinner or the bend wider, or leave the sharpest part out of the ranges");
    Some(report)
}

/// The least radius of curvature on a lattice, and where it is.
fn tightest(surface: &FormulaSurface) -> Option<(f64, (f64, f64))> {
    const STEPS: u32 = 40;
    let (domain_u, domain_v) = (surface.domain_u(), surface.domain_v());
    // Inside of the rims: at a pole derivatives say nothing.
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let places = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (share(i), share(j))));
    let radius = |(x, y): (f64, f64)| {
        let (u, v) = (domain_u.at(x), domain_v.at(y));
        let (at_u, at_v) = ((u, Side::After), (v, Side::After));
        let (jet, second) = (surface.sided(at_u, at_v), surface.second(at_u, at_v));
        let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let [l, m, n] = [second.uu, second.uv, second.vv].map(|bend: DVec3| bend.dot(jet.normal));
        let determinant = e * g - f * f;
        let mean = (e * n - 2.0 * f * m + g * l) / (2.0 * determinant);
        let product = (l * n - m * m) / determinant;
        let most = mean.abs() + (mean * mean - product).max(0.0).sqrt();
        (1.0 / most, (u, v))
    };
    places.map(radius).filter(|(radius, _)| radius.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn one_sided(table: Span) -> Diagnostic {
    Diagnostic::warning(Code::OneSided, "this surface closes with a twist: it has one side, and no front")
        .at(table, "seen from half of the places")
        .help("write a `thickness`, or give it a material with `double-sided = true`")
}

fn gap(name: &str, closing: &Closing, span: Span) -> Diagnostic {
    let other = if name == "u" { "v" } else { "u" };
    let message = format!(
        "the surface does not close along {name}: at {other} = {} its ends are {} apart",
        show(round(closing.at, 1.0)),
        show(closing.gap)
    );
    Diagnostic::error(Code::FormulaGap, message)
        .at(span, format!("open along {name}"))
        .help(format!(
            "let `{name}` run over whole turns of all that depends on it (360 for `sin({name})`, 720 for `sin({name} / 2)`)"
        ))
}

/// A place that is 0 but for rounding is told as 0.
fn round(t: f64, span: f64) -> f64 {
    if t.abs() < 1e-9 * span { 0.0 } else { t }
}

fn refusal(compiled: &Compiled, fault: &SurfaceFault, domains: [Domain; 2], table: Span) -> Diagnostic {
    let at = |place: &[f64; 2]| {
        let [u, v] = [0, 1].map(|axis: usize| show(round(place[axis], domains[axis].span())));
        format!("u = {u}, v = {v}")
    };
    match fault {
        SurfaceFault::NoValue { place, culprit } => compiled
            .lost(culprit, &at(place), table)
            .help("let the ranges of `u` and `v` leave such places out, or say with `if` what holds there"),
        SurfaceFault::Unbounded { place } => {
            let message = format!("the formulas have no finite value near {}", at(place));
            Diagnostic::error(Code::FormulaValue, message)
                .at(table, "they grow without end, or cannot be shown not to")
                .help("let the ranges of `u` and `v` leave that place out, or say with `if` what holds there")
        }
        SurfaceFault::Jump { place, before, after } => {
            let size = before.distance(*after);
            let point = |point: &DVec3| {
                let [x, y, z] = point.to_array().map(|part| show(round(part, size)));
                format!("[{x}, {y}, {z}]")
            };
            let message =
                format!("the surface jumps at {} from {} to {}", at(place), point(before), point(after));
            Diagnostic::error(Code::FormulaJump, message)
                .at(table, "torn there")
                .help("a surface is one piece: end it there, or join both sides with `smoothstep` or `mix`")
        }
        SurfaceFault::Wild { place } => {
            let message = format!("the formulas change too often to be followed, near {}", at(place));
            Diagnostic::error(Code::FormulaWild, message)
                .at(table, "too wild")
                .help("make the ranges shorter or the waves longer")
        }
    }
}

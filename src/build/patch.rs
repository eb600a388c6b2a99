//! Patches, Hermite, B-spline and NURBS surfaces of a document into surfaces of the kernel.

use glam::{DVec3, DVec4};

use super::Builder;
use super::bspline::knots;
use crate::geometry::curve::RationalSpline;
use crate::geometry::curve::control::{BasisMatrix, Control};
use crate::geometry::surface::tensor::{
    BicubicError, Grid, HermiteGrid, PatchesError, PolynomialSurface, RationalError, RationalSurface,
    TensorSpline, bicubic, hermite, reflected, wrapped,
};
use crate::geometry::surface::{AnySurface, PatchContinuity, Rim, SurfaceJoint, SurfaceLine, joints};
use crate::geometry::tessellate::Patchwork;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Basis, Border, Degrees, Directions, KnotRule, Rows, Sp, SpokenContinuity};
use crate::model::Recipe;

/// Diagnostics of one shape's joints; what is wrong with one is often wrong with all.
pub(super) const MOST_REPORTS: usize = 8;

fn grid<T: Copy>(rows: &Rows<T>) -> Grid<T> {
    let items = rows.items().map(|item| item.value).collect();
    Grid::new(rows.columns(), items).expect("rows that were read are equally long and not empty")
}

pub(super) fn recipe(surfaces: Vec<AnySurface>) -> Recipe {
    capped(surfaces, Vec::new())
}

/// Surfaces with flat ends, each of which is some sides one after the other.
pub(super) fn capped(surfaces: Vec<AnySurface>, caps: Vec<Vec<(u32, Rim)>>) -> Recipe {
    Recipe::Patches { patches: Patchwork { surfaces, caps }, materials: Vec::new() }
}

fn polynomial(surface: PolynomialSurface) -> AnySurface {
    AnySurface::Polynomial(Box::new(surface))
}

impl Builder<'_> {
    /// Whether control points span a surface: reports those that are one point or stand on one line.
    pub(super) fn spans(&mut self, points: &[DVec3], place: Span) -> bool {
        let Some(why) = flat(points) else { return true };
        let report =
            Diagnostic::error(Code::Degenerate, format!("the control points {why}: there is no surface"));
        self.report(report.at(place, "no area"));
        false
    }

    pub(super) fn patches(&mut self, patches: &spec::Patches, span: Span) -> Option<Recipe> {
        let surfaces = match (&patches.control, &patches.points, &patches.patches) {
            (Some(control), ..) => vec![polynomial(self.patch_grid(patches, control)?)],
            (None, Some(points), Some(lists)) => {
                let given: Vec<DVec3> = points.iter().map(|point| point.value).collect();
                if !self.spans(&given, points.span) {
                    return None;
                }
                let single = |list: &Sp<Vec<Sp<u32>>>| single_patch(patches, points, list);
                let made: Result<Vec<_>, _> = lists.iter().map(single).collect();
                match made {
                    Ok(surfaces) => surfaces.into_iter().map(polynomial).collect(),
                    Err(error) => return self.bad_patches(&error, patches, span),
                }
            }
            _ => return None,
        };
        self.check_continuity(patches, &surfaces, span).then(|| recipe(surfaces))
    }

    fn patch_grid(
        &mut self,
        patches: &spec::Patches,
        control: &Sp<Rows<DVec3>>,
    ) -> Option<PolynomialSurface> {
        let (basis, steps) = basis(patches);
        let closed = patches.closed.value;
        let mut points = grid(control);
        if !self.spans(points.points(), control.span) {
            return None;
        }
        let inner = matches!(patches.basis.value, Basis::BSpline | Basis::CatmullRom);
        if inner && patches.ends.value == Border::Reflect {
            points = reflected(&points, !closed.u, !closed.v);
        }
        let size = |degree: u32, step: usize| {
            if patches.basis.value == Basis::Bezier {
                (degree as usize + 1, degree as usize)
            } else {
                (4, step)
            }
        };
        let (along, across) = (size(patches.degree.u, steps), size(patches.degree.v, steps));
        let fits_u = self.check_patch_count('u', points.columns(), along, closed.u, control.span);
        let fits_v = self.check_patch_count('v', points.rows(), across, closed.v, control.span);
        if !(fits_u && fits_v) {
            return None;
        }
        let more = |closed: bool, (count, step): (usize, usize)| if closed { count - step } else { 0 };
        let points = wrapped(&points, more(closed.u, along), more(closed.v, across));
        let made = match basis {
            None => bezier(patches.degree.value, &points),
            Some(basis) => bicubic(&points, &basis, steps),
        };
        match made {
            Ok(surface) => Some(surface),
            Err(error) => self.bad_patches(&error, patches, control.span),
        }
    }

    /// Whether points in one direction make whole patches of `count` points, each `step` after the one before.
    fn check_patch_count(
        &mut self,
        direction: char,
        points: usize,
        (count, step): (usize, usize),
        closed: bool,
        span: Span,
    ) -> bool {
        let fits = if closed {
            points.is_multiple_of(step) && points >= 3
        } else {
            points >= count && (points - count).is_multiple_of(step)
        };
        if fits {
            return true;
        }
        let (least, kind) =
            if closed { (step.max(3).next_multiple_of(step), "closed ") } else { (count, "") };
        let below = points.saturating_sub(least) / step * step + least;
        let expected =
            if points < least { least.to_string() } else { format!("{below} or {}", below + step) };
        let message = format!("{points} points along {direction} do not make whole {kind}patches");
        let report = Diagnostic::error(Code::PatchGrid, message)
            .at(span, format!("along {direction} expected {expected}"))
            .note(format!("a patch has {count} points along {direction}, the next begins {step} further on"));
        self.report(report);
        false
    }

    fn bad_patches<T>(&mut self, error: &BicubicError, patches: &spec::Patches, span: Span) -> Option<T> {
        let report = match error {
            BicubicError::Gap { before, after, gap } => {
                let message = format!(
                    "the patches in column {}, row {} and column {}, row {} are {gap:.3e} apart where they should meet",
                    before.0, before.1, after.0, after.1
                );
                Diagnostic::error(Code::PatchGap, message)
                    .at(if patches.basis.span.is_none() { span } else { patches.basis.span }, "does not join")
                    .note("a basis joins when its patch ends, whatever the points, where the next begins")
                    .help("choose another `step`, or write patches that do not join as shapes of their own")
            }
            BicubicError::Patches(error) => {
                Diagnostic::error(Code::PatchGrid, error.to_string()).at(span, "")
            }
        };
        self.report(report);
        None
    }

    /// Whether all joints are as smooth as declared.
    fn check_continuity(&mut self, patches: &spec::Patches, surfaces: &[AnySurface], span: Span) -> bool {
        let Some(declared) = patches.continuity else { return true };
        let wanted = continuity(declared.value);
        let within = patches.continuity_angle.value;
        let found = joints(surfaces);
        let broken: Vec<&SurfaceJoint> =
            found.joints.iter().filter(|joint| !joint.smoothness.holds(wanted, within)).collect();
        for joint in broken.iter().take(MOST_REPORTS) {
            let mut report = Diagnostic::error(Code::BrokenSeam, broken_seam(joint, wanted))
                .at(declared.span, format!("{wanted} does not hold"));
            let place = |index: usize| patches.patches.as_ref().map_or(span, |lists| lists[index].span);
            let [(one, _), (other, _)] = joint.lines;
            if patches.patches.is_some() {
                report = report.also(place(one), "one side");
                if one != other {
                    report = report.also(place(other), "the other");
                }
            }
            if broken.len() > MOST_REPORTS {
                report = report.note(format!("{} of {} joints are so", broken.len(), found.joints.len()));
            }
            self.report(report);
        }
        broken.is_empty()
    }

    pub(super) fn hermite_surface(&mut self, hermites: &spec::HermiteSurface, span: Span) -> Option<Recipe> {
        let given = HermiteGrid {
            points: grid(&hermites.points),
            along_u: grid(&hermites.along_u),
            along_v: grid(&hermites.along_v),
            twists: hermites.twists.as_ref().map(|twists| grid(twists)),
        };
        match hermite(&given) {
            Ok(surface) => Some(recipe(vec![polynomial(surface)])),
            Err(error) => {
                self.report(Diagnostic::error(Code::PatchGrid, error.to_string()).at(span, ""));
                None
            }
        }
    }

    pub(super) fn b_spline_surface(&mut self, surface: &spec::BSplineSurface, span: Span) -> Option<Recipe> {
        let knots = (surface.knots_u.as_ref(), surface.knots_v.as_ref());
        let control = grid(&surface.control);
        if !self.spans(control.points(), surface.control.span) {
            return None;
        }
        let spline = self.tensor(&control, surface.degree.value, surface.closed.value, knots, span)?;
        match PolynomialSurface::spline(&spline) {
            Ok(made) => Some(recipe(vec![polynomial(made)])),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    pub(super) fn nurbs_surface(&mut self, surface: &spec::NurbsSurface, span: Span) -> Option<Recipe> {
        let knots = (surface.knots_u.as_ref(), surface.knots_v.as_ref());
        let (points, weights) = (grid(&surface.control), grid(&surface.weights));
        let (degree, closed) = (surface.degree.value, surface.closed.value);
        let finite = weights.points().iter().all(|weight| *weight > 0.0);
        if finite && !self.spans(points.points(), surface.control.span) {
            return None;
        }
        let first = weights.get(0, 0);
        if weights.points().iter().all(|weight| *weight == first) {
            // Equal weights say nothing: the surface is the polynomial one.
            let spline = self.tensor(&points, degree, closed, knots, span)?;
            let made = PolynomialSurface::spline(&spline);
            return made.map_or_else(
                |error| self.degenerate(&error.to_string(), span),
                |made| Some(recipe(vec![polynomial(made)])),
            );
        }
        let place = |column: usize, row: usize| {
            RationalSpline::homogeneous(points.get(column, row), weights.get(column, row))
        };
        let control: Grid<DVec4> = Grid::from_fn(points.columns(), points.rows(), place)
            .expect("a point for each weight, and there is one");
        let spline = self.tensor(&control, degree, closed, knots, span)?;
        match RationalSurface::spline(&spline) {
            Ok(made) => Some(recipe(vec![AnySurface::Rational(Box::new(made))])),
            Err(error) => self.bad_weights(&error, surface.weights.span, span),
        }
    }

    fn bad_weights<T>(&mut self, error: &RationalError, weights: Span, span: Span) -> Option<T> {
        let RationalError::Weights { u, v } = error else {
            return self.degenerate(&error.to_string(), span);
        };
        let message = format!(
            "no finite points hold the surface somewhere between u = {} and {}, v = {} and {}: it runs to infinity",
            u.0, u.1, v.0, v.1
        );
        let report = Diagnostic::error(Code::BadWeight, message)
            .at(weights, "too few weights are greater than 0")
            .help("at every pair of knots one of the points that act there needs a weight greater than 0");
        self.report(report);
        None
    }

    fn tensor<P: Control>(
        &mut self,
        control: &Grid<P>,
        degree: Degrees,
        closed: Directions,
        rules: (Option<&Sp<KnotRule>>, Option<&Sp<KnotRule>>),
        span: Span,
    ) -> Option<TensorSpline<P>> {
        let u = knots(degree.u as usize, control.columns(), closed.u, rules.0);
        let v = knots(degree.v as usize, control.rows(), closed.v, rules.1);
        let (u, v) = match (u, v) {
            (Ok(u), Ok(v)) => (u, v),
            (Err(error), _) | (_, Err(error)) => return self.degenerate(&error.to_string(), span),
        };
        let more = |knots: usize, points: usize| knots.saturating_sub(points);
        let control = wrapped(control, more(u.points(), control.columns()), more(v.points(), control.rows()));
        TensorSpline::new(u, v, control)
    }
}

/// What is wrong with points that span no plane, up to rounding.
fn flat(points: &[DVec3]) -> Option<String> {
    const ROUNDING: f64 = 1e-12;
    let first = points[0];
    let far = points
        .iter()
        .copied()
        .max_by(|a, b| a.distance_squared(first).total_cmp(&b.distance_squared(first)))?;
    let line = far - first;
    let least = ROUNDING * points.iter().map(|point| point.length()).fold(0.0, f64::max);
    if line.length() <= least {
        return Some(format!("are all one point, [{}, {}, {}]", first.x, first.y, first.z));
    }
    let beside = points.iter().map(|point| (*point - first).cross(line).length() / line.length());
    (beside.fold(0.0, f64::max) <= least).then(|| "all stand on one line".to_owned())
}

fn single_patch(
    patches: &spec::Patches,
    points: &[Sp<DVec3>],
    list: &[Sp<u32>],
) -> Result<PolynomialSurface, BicubicError> {
    let point = |number: &Sp<u32>| points[(number.value - patches.first.value) as usize].value;
    let columns = patches.degree.u as usize + 1;
    let control = Grid::new(columns, list.iter().map(point).collect());
    let control = control.expect("a patch has as many points as its degrees ask for");
    match basis(patches).0 {
        None => bezier(patches.degree.value, &control),
        Some(basis) => bicubic(&control, &basis, 1),
    }
}

/// Bezier patches over whole numbers.
fn bezier(degree: Degrees, control: &Grid<DVec3>) -> Result<PolynomialSurface, BicubicError> {
    let degree = (degree.u as usize, degree.v as usize);
    let breaks = |points: usize, degree: usize| (0..=(points - 1) / degree).map(|k| k as f64).collect();
    let (u, v) = (breaks(control.columns(), degree.0), breaks(control.rows(), degree.1));
    PolynomialSurface::bezier(degree, control, u, v).map_err(|error: PatchesError| error.into())
}

/// The matrix of a basis, but for Bezier, and the step from patch to patch in a grid.
fn basis(patches: &spec::Patches) -> (Option<BasisMatrix>, usize) {
    match patches.basis.value {
        Basis::Bezier => (None, 3),
        Basis::BSpline => (Some(BasisMatrix::B_SPLINE), 1),
        Basis::CatmullRom => (Some(BasisMatrix::CATMULL_ROM), 1),
        Basis::Hermite => (Some(BasisMatrix::HERMITE), 4),
        Basis::Matrix(rows) => (Some(BasisMatrix(rows)), patches.step.map_or(1, |step| step.value as usize)),
    }
}

pub(super) fn continuity(spoken: SpokenContinuity) -> PatchContinuity {
    match spoken {
        SpokenContinuity::G0 => PatchContinuity::G0,
        SpokenContinuity::C0 => PatchContinuity::C0,
        SpokenContinuity::G1 => PatchContinuity::G1,
        SpokenContinuity::C1 => PatchContinuity::C1,
        SpokenContinuity::C2 => PatchContinuity::C2,
    }
}

/// A line of a surface in words.
fn line(surface: usize, line: SurfaceLine) -> String {
    match line {
        SurfaceLine::Rim(Rim::Bottom) => format!("the first row of patch {surface}"),
        SurfaceLine::Rim(Rim::Top) => format!("the last row of patch {surface}"),
        SurfaceLine::Rim(Rim::Left) => format!("the first column of patch {surface}"),
        SurfaceLine::Rim(Rim::Right) => format!("the last column of patch {surface}"),
        SurfaceLine::U(u) => format!("u = {u}"),
        SurfaceLine::V(v) => format!("v = {v}"),
    }
}

fn broken_seam(joint: &SurfaceJoint, wanted: PatchContinuity) -> String {
    let [(one, first), (other, second)] = joint.lines;
    let lines = match first {
        SurfaceLine::Rim(_) => format!("{} and {}", line(one, first), line(other, second)),
        _ => format!("patches along {}", line(one, first)),
    };
    broken_between(&lines, joint, wanted)
}

/// The same of lines that are named in words.
pub(super) fn broken_between(lines: &str, joint: &SurfaceJoint, wanted: PatchContinuity) -> String {
    let found = &joint.smoothness;
    let place = format!("[{:.4}, {:.4}, {:.4}]", found.place.x, found.place.y, found.place.z);
    let why = if !found.holds(PatchContinuity::G1, 0.0) && wanted >= PatchContinuity::G1 {
        format!("their planes differ by {:.4} degrees at {place}", found.angle)
    } else if !found.same_parameters {
        "their parameters run along it in different ways".to_owned()
    } else if found.slope > 1e-7 {
        format!("their derivatives across it differ by {:.4} percent", 100.0 * found.slope)
    } else {
        format!("their second derivatives across it differ by {:.4} percent", 100.0 * found.bend)
    };
    format!("{lines} join {} only: {why}", found.continuity)
}

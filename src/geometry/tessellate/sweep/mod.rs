//! Sections carried along paths, screwed about an axis, changed on the way.
//!
//! The section is cut into chords (deviation e1 in its plane), and rows are set along the way. The lines that the
//! section's points trace have no closed form, so what their chords and the diagonals of the cells leave out
//! (e2) is measured inside each cell, with a margin; e1 + e2 is `Sampled`, except where the section goes straight
//! on and flat parts stay flat: there e2 is zero and the bound is that of the section alone. At corners of a path
//! the section stands in the bisecting plane (a mitre).

mod build;
mod columns;
mod measure;
mod rows;
mod seam;

use crate::geometry::curve::AnyCurve;
use crate::geometry::number::{ln, pow};
use crate::geometry::surface::{Carrier, Carry, Change, Outline, Screw, SweptSurface};
use build::Builder;
use columns::Columns;
use rows::Row;
use seam::Seam;

use super::{Detail, Deviation, SurfaceDensity, TessellateError, Tessellation};

/// Outlines carried along.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The outlines, in the plane that moves: x along its side, y along its up. Each has a curve for every profile of
    /// the change. Of each island the first is the outer one, if it is closed; the others are closed and lie inside it.
    pub outlines: Vec<Vec<AnyCurve>>,
    /// How many outlines each island has.
    pub islands: Vec<usize>,
    /// How they change.
    pub change: Change,
    /// How their plane moves.
    pub route: Route,
    /// Whether open ends are closed by flat faces, where the section is closed.
    pub caps: bool,
}

/// What moves the plane of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Route {
    /// It stands across a path.
    Path {
        /// The path.
        path: AnyCurve,
        /// How it is carried.
        carry: Carry,
    },
    /// It turns about the y axis and rises.
    Screw(Screw),
}

impl Sweep {
    /// One outline that does not change, along a path.
    #[must_use]
    pub fn plain(profile: AnyCurve, path: AnyCurve, carry: Carry) -> Self {
        Self {
            outlines: vec![vec![profile]],
            islands: vec![1],
            change: Change::constant(),
            route: Route::Path { path, carry },
            caps: true,
        }
    }

    /// The surface that it sweeps.
    #[must_use]
    pub fn surface(&self) -> SweptSurface {
        let outlines: Vec<Outline> = self.outlines.iter().cloned().map(Outline::of).collect();
        let reach = outlines.iter().map(Outline::reach).fold(0.0, f64::max);
        let reach = reach * self.change.greatest_weight() * self.change.scale.greatest().max_element();
        let carrier = match &self.route {
            Route::Path { path, carry } => Carrier::along(path.clone(), carry, reach),
            Route::Screw(screw) => Carrier::Screw(*screw),
        };
        SweptSurface::new(outlines, self.change.clone(), carrier)
    }
}

/// Carries a section into triangles. Anchor sources: the wall of outline k is k, then come the first end and the
/// last end.
///
/// # Errors
/// When the limit would be passed, an outline encloses no area, or an end cannot be triangulated.
pub fn sweep(shape: &Sweep, detail: &Detail) -> Result<Tessellation, TessellateError> {
    if let SurfaceDensity::Grid { u, v } = detail.density {
        detail.allow(2 * u64::from(u) * u64::from(v) * shape.outlines.len() as u64)?;
    }
    let surface = shape.surface();
    let SurfaceDensity::Tolerance(tolerance) = detail.density else {
        let plan = Plan::new(&surface, &shape.islands, detail, 0.0)?;
        return Builder::new(&plan, detail).build(shape.caps);
    };
    // What a row leaves out falls with the square of its length, or where a flat side twists with the length
    // itself: the exponent is taken from the last two trials.
    let mut aim = tolerance / 2.0;
    let mut exponent = 1.0;
    let mut plan = Plan::new(&surface, &shape.islands, detail, aim)?;
    for _ in 0..10 {
        let bound = plan.deviation.bound;
        if bound <= tolerance {
            break;
        }
        let next = aim * pow(0.97 * tolerance / bound, 1.0 / exponent);
        let finer = Plan::new(&surface, &shape.islands, detail, next)?;
        // Where a mitre leaves no room for rows, more rows elsewhere do not help.
        if finer.deviation.bound > 0.98 * bound {
            if finer.rows.len() > 4 * plan.rows.len() {
                break;
            }
            aim = next * 0.5;
            continue;
        }
        exponent = (ln(finer.deviation.bound / bound) / ln(next / aim)).clamp(0.25, 1.0);
        (plan, aim) = (finer, next);
    }
    Builder::new(&plan, detail).build(shape.caps)
}

/// Outlines and way, cut, before any vertex is made.
struct Plan<'a> {
    surface: &'a SweptSurface,
    /// How many outlines each island has.
    islands: &'a [usize],
    columns: Vec<Columns>,
    rows: Vec<Row>,
    /// Whether the last row stands where the first does.
    closed: bool,
    /// For each outline, how it does.
    seam: Vec<Seam>,
    /// Whether the columns of the last row are not simply those of the first.
    shifted: bool,
    deviation: Deviation,
}

impl<'a> Plan<'a> {
    fn new(
        surface: &'a SweptSurface,
        islands: &'a [usize],
        detail: &Detail,
        aim: f64,
    ) -> Result<Self, TessellateError> {
        let columns = columns::cut(surface, islands, detail, aim)?;
        let rows = rows::cut(surface, &columns, detail, aim)?;
        let cells: u64 = columns.iter().map(|columns| columns.len() as u64 - 1).sum();
        detail.allow(2 * cells * (rows.len() as u64 - 1))?;
        let closed = surface.carrier.is_closed();
        let mut plan = Self {
            surface,
            islands,
            columns,
            rows,
            closed,
            seam: Vec::new(),
            shifted: false,
            deviation: Deviation::NONE,
        };
        plan.find_seam();
        plan.deviation = plan.measure();
        Ok(plan)
    }

    /// Finds how the last row of a closed way lies on the first; where column lies on column, what comes before the
    /// seam is known on both sides of it.
    fn find_seam(&mut self) {
        let last = self.rows.len() - 1;
        if !self.closed {
            self.seam = vec![Seam::Same; self.columns.len()];
            return;
        }
        let of = |columns: &Columns| seam::find(columns, &self.rows[0], &self.rows[last]);
        let found: Vec<_> = self.columns.iter().map(of).collect();
        self.shifted = found.iter().any(|(_, same)| !same);
        self.seam = found.into_iter().map(|(seam, _)| seam).collect();
        if !self.shifted {
            (self.rows[0].before, self.rows[last].after) = (self.rows[last].before, self.rows[0].after);
            for row in [0, last] {
                let joint = self.rows[row].before != self.rows[row].after;
                self.rows[row].joint = joint;
                self.rows[row].plain &= !joint;
            }
        }
    }
}

//! Quadrics cut off by a box or a ball, alone or as closed bodies.
//!
//! Promise: every vertex lies on the quadric to rounding, every line on the plane that cuts it; the bound is proved by
//! the equation itself. What the cut only touches counts as inside: walls are moved outward by a billionth of their size.
//! The apex of a cone is a vertex of both of its halves; each triangle has a normal of its own there.

mod ball;
mod convex;
mod flat;
mod judge;
mod shell;
mod skeleton;
#[cfg(test)]
mod tests;
mod walled;

use glam::DVec3;

use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::field::quadric::{HalfSpace, QuadricForm, QuadricKind};
use crate::geometry::field::{Field, Quadric};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::region::Cut;
pub use ball::Ball;
pub(super) use judge::greatest;
use shell::Shell;
use walled::{TRIES, Walled};

/// A quadric and where it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippedQuadric {
    /// The quadric; its inside is where it is negative.
    pub quadric: Quadric,
    /// What it ends at; without it only an ellipsoid ends.
    pub within: Option<Clip>,
    /// Whether it is the closed surface of all points inside of both.
    pub closed: bool,
}

/// What a quadric ends at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clip {
    /// The sides of a box.
    Box(Bounds),
    /// The surface of a ball.
    Ball(Ball),
}

impl Clip {
    /// A box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Box(bounds) => *bounds,
            Self::Ball(Ball { center, radius }) => {
                Bounds { min: *center - DVec3::splat(*radius), max: *center + DVec3::splat(*radius) }
            }
        }
    }

    /// A point in the middle, and how far it reaches from there.
    fn place(&self) -> (DVec3, f64) {
        match self {
            Self::Box(bounds) => (bounds.center(), bounds.diagonal() / 2.0),
            Self::Ball(ball) => (ball.center, ball.radius),
        }
    }
}

impl ClippedQuadric {
    /// How many sources anchors may name: sheets, then faces of the cut.
    pub const SOURCES: u32 = SHEETS + 6;

    /// The polynomial that is zero on the surface of an anchor's source; none for flat faces.
    #[must_use]
    pub fn surface(&self, source: u32) -> Option<Quadric> {
        match self.within {
            Some(Clip::Ball(ball)) if source >= SHEETS => Some(ball.quadric()),
            _ => (source < SHEETS && !self.form().kind.is_flat()).then_some(self.quadric),
        }
    }

    /// Whether an anchor's source is the quadric itself and not a face of the cut.
    #[must_use]
    pub fn is_sheet(&self, source: u32) -> bool {
        source < SHEETS
    }

    /// What surface the quadric is, there where it is cut off.
    #[must_use]
    pub fn form(&self) -> QuadricForm {
        self.within.map_or_else(
            || QuadricForm::anywhere(&self.quadric),
            |clip| {
                let (middle, reach) = clip.place();
                QuadricForm::new(&self.quadric, middle, reach)
            },
        )
    }

    /// A box that holds the shape.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let everything = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        let clip = self.within.map_or(everything, |clip| clip.bounds());
        let form = self.form();
        if form.kind != QuadricKind::Ellipsoid {
            return clip;
        }
        let own = form.box_around();
        Bounds { min: clip.min.max(own.min), max: clip.max.min(own.max) }
    }
}

/// Sheets that a quadric has at most.
const SHEETS: u32 = 4;

/// What the parts of the work have in common.
#[derive(Clone, Copy)]
struct Job {
    /// How lines are cut.
    cut: Cut,
    /// How far triangles may lie from the surface.
    tolerance: f64,
    /// Points of a fixed grid.
    lattice: Option<[u32; 2]>,
    limit: u64,
    uv: bool,
    closed: bool,
}

impl Job {
    /// The same with lines cut finer, where chords of two lines crossed.
    fn finer(self) -> Self {
        let cut = match self.cut {
            Cut::Within(tolerance) => Cut::Within(tolerance / 4.0),
            Cut::Into(count) => Cut::Into(count.saturating_mul(2)),
        };
        Self { cut, ..self }
    }
}

/// The share of the tolerance that lines may use: faces beside them need some for themselves.
const LINES: f64 = 0.9;

/// Walls are moved outward by this share of the size of the box, each by its own multiple of it.
const OUTWARD: f64 = 1e-9;

/// Cuts a quadric into triangles. Anchor sources: sheets from 0, faces of the cut from 4 (x least, x greatest, y ...).
/// A fixed grid gives each edge `u` chords and each sheet a lattice of `u` by `v` points of its plane coordinates.
///
/// # Errors
/// When the limit is passed or nothing of the quadric lies inside.
pub fn quadric(shape: &ClippedQuadric, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let (cut, tolerance, lattice) = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => (Cut::Within(LINES * tolerance), tolerance, None),
        // Triangles of which nothing is known are split even so.
        SurfaceDensity::Grid { u, v } => (Cut::Into(u.max(4)), f64::MAX, Some([u, v])),
    };
    let job =
        Job { cut, tolerance, lattice, limit: detail.triangle_limit, uv: detail.uv, closed: shape.closed };
    let mut job = job;
    for _ in 0..TRIES {
        let made = dressed(shape, &job)?;
        // Faces beside a chord cannot be nearer to the surface than it: where its share was too great it is cut finer.
        if made.deviation.bound > tolerance {
            job = job.finer();
            continue;
        }
        let mesh = made.shell.finish(detail.uv);
        if mesh.triangles.is_empty() {
            return Err(TessellateError::NoArea);
        }
        return Ok(Tessellation { mesh, deviation: made.deviation });
    }
    Err(TessellateError::Tangled)
}

fn dressed(shape: &ClippedQuadric, job: &Job) -> Result<Made, TessellateError> {
    let form = shape.form();
    let negative = |point: DVec3| shape.quadric.value(point) < 0.0;
    let walled = |walls: &[HalfSpace], place: (DVec3, f64)| {
        let walled =
            Walled { quadric: &shape.quadric, form: &form, walls, first_sheet: 0, first_wall: SHEETS };
        walled::in_walls(&walled, place, job)
    };
    match shape.within {
        Some(Clip::Box(bounds)) if form.kind.is_flat() => Ok(flat::in_walls(&form, &bounds, &negative, job)),
        Some(Clip::Ball(ball)) if form.kind.is_flat() => ball::flat_in_ball(&form, &ball, &negative, job),
        Some(Clip::Ball(ball)) => ball::in_ball(&shape.quadric, &form, &ball, job),
        Some(clip @ Clip::Box(bounds)) => walled(&walls(&bounds), clip.place()),
        None => walled(&[], (form.origin, form.half.length())),
    }
}

/// A shell and how far it is from its source.
struct Made {
    shell: Shell,
    deviation: Deviation,
}

/// The sides of a box, moved outward.
fn walls(bounds: &Bounds) -> Vec<HalfSpace> {
    let size = bounds.diagonal();
    let mut walls = Vec::with_capacity(6);
    for (axis, normal) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
        let (min, max) = (bounds.min.to_array()[axis], bounds.max.to_array()[axis]);
        let out = |k: usize| size * OUTWARD * (1.0 + 0.137 * k as f64);
        walls.push(HalfSpace { normal, offset: min - out(2 * axis) });
        walls.push(HalfSpace { normal: -normal, offset: -(max + out(2 * axis + 1)) });
    }
    walls
}

fn proved(bound: f64) -> Deviation {
    Deviation { bound, evidence: Evidence::Proved }
}

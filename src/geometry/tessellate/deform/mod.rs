//! Meshes and wires under maps that bend: cut until their flat triangles follow, then moved.
//!
//! Every map has an axis, and takes planes across it to planes. So sides that run along the axis are first cut by
//! common planes, as densely as the map bends there: faces become ladders whose rungs stay straight. A map takes
//! a flat triangle to a curved one; its second derivatives say how far that lies from the triangle of
//! the images of the corners, by the same proof as for surfaces ([`super::patch`]): the triangle is a surface whose
//! parameters are places in its plane. What is not good enough then is split on. Sides are split, not triangles, so
//! neighbors agree and nothing cracks; sides at hard edges and borders must keep the tolerance as lines.
//!
//! What the mesh leaves out of the shape before the map is multiplied by at most the map's stretch.
//!
//! Cost: linear in the triangles that come out.

mod chain;
mod images;
mod levels;
mod lines;
mod slice;
mod split;

use std::collections::HashMap;

use glam::DVec3;
use thiserror::Error;

use super::{Deviation, TessellateError};
use crate::geometry::mesh::{Mesh, Wire};
use crate::geometry::surface::Deformation;
use images::{Images, Judged};
use levels::Levels;
pub(super) use split::{Part, Splitter, key};

/// Why a mesh was not deformed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DeformError {
    /// More triangles than allowed.
    #[error(transparent)]
    Tessellate(#[from] TessellateError),
    /// There is nothing along the axis for the map to act on.
    #[error("it has no length along the axis where the map acts")]
    NoLength,
    /// The shape reaches beyond an end of the path it is laid along.
    #[error(
        "along the path it reaches from {} to {}, and the path is {} long",
        show(*from), show(*to), show(*length)
    )]
    TooLong {
        /// Place of the start of the shape, by length from the start of the path.
        from: f64,
        /// Place of its end.
        to: f64,
        /// Length of the path.
        length: f64,
    },
    /// The map folds space over inside the shape.
    #[error("it would fold over itself at [{}, {}, {}]{}", show(at.x), show(at.y), show(at.z), how(*bend))]
    Folds {
        /// A place of the shape before the map.
        at: DVec3,
        /// Radius of the bend there, and how far the place reaches toward its center.
        bend: Option<(f64, f64)>,
    },
}

/// A length with as many digits as a reader needs; none is -0.
fn show(length: f64) -> f64 {
    (length * 1e6).round() / 1e6 + 0.0
}

/// What a fold has to do with the radius of its bend.
fn how(bend: Option<(f64, f64)>) -> String {
    let told = |(radius, reach): (f64, f64)| {
        let (radius, reach) = (show(radius), show(reach));
        format!(", which reaches {reach} toward the center of a bend of radius {radius}")
    };
    bend.map(told).unwrap_or_default()
}

/// A mesh and lines that are deformed together.
#[derive(Clone, Debug)]
pub struct Deformed {
    /// The mesh.
    pub mesh: Mesh,
    /// The lines.
    pub wire: Wire,
}

/// Rounds in which sides are halved; what is then still too far away is as rough as samples show.
const ROUNDS: usize = 24;

/// Times that slices are made finer.
const ATTEMPTS: usize = 4;

/// The share of the tolerance that slices are made for: what samples add takes the rest.
const SHARE: f64 = 0.9;

/// Slices are made finer when more than this share of the triangles ask for it; fewer are split one by one.
const MANY: f64 = 0.1;

/// Cuts a mesh until its triangles lie within `tolerance` of their images under the map, and moves it there; lines too.
/// Gives how far they do; what the mesh left out before is not in it. `periods` says for each source of the anchors
/// after which parameters u and v come round again.
///
/// # Errors
/// When the limit would be passed, or the map folds over.
pub fn deform(
    subject: Deformed,
    map: &Deformation,
    periods: &[(f64, f64)],
    tolerance: f64,
    triangle_limit: u64,
) -> Result<(Deformed, Deviation), DeformError> {
    let Deformed { mesh, wire } = subject;
    let (wire, of_wire) = chain::deform(&wire, map, periods, tolerance, triangle_limit)?;
    let (mesh, of_mesh) = surface(&mesh, map, periods, tolerance, triangle_limit)?;
    Ok((Deformed { mesh, wire }, of_wire.union(of_mesh)))
}

fn surface(
    mesh: &Mesh,
    map: &Deformation,
    periods: &[(f64, f64)],
    tolerance: f64,
    triangle_limit: u64,
) -> Result<(Mesh, Deviation), DeformError> {
    let mut fine = 1.0;
    let mut attempt = 1;
    loop {
        let levels = Levels::new(map, &mesh.points, SHARE * tolerance / fine, triangle_limit)?;
        let mut work = Work::new(slice::slice(mesh, &levels, periods, triangle_limit)?, map)?;
        let finer = work.begin(&levels, tolerance);
        if attempt < ATTEMPTS
            && let Some(finer) = finer
        {
            fine *= finer;
            attempt += 1;
            continue;
        }
        return work.finish(tolerance, triangle_limit);
    }
}

/// A mesh that is being split.
struct Work<'a> {
    splitter: Splitter<'a>,
    images: Images<'a>,
    /// The verdict on each triangle.
    judged: Vec<Judged>,
}

impl<'a> Work<'a> {
    fn new(splitter: Splitter<'a>, map: &'a Deformation) -> Result<Self, DeformError> {
        let mut images = Images { map, points: Vec::new() };
        images.follow(&splitter.mesh)?;
        Ok(Self { splitter, images, judged: Vec::new() })
    }

    /// Judges all triangles; when many want finer slices, says how much finer.
    fn begin(&mut self, levels: &Levels, tolerance: f64) -> Option<f64> {
        let mesh = &self.splitter.mesh;
        let judge = |triangle| self.images.judge(&self.splitter, triangle, tolerance);
        self.judged = mesh.triangles.iter().map(judge).collect();
        let coarse = |judged: &&Judged| {
            judged.deviation.bound > tolerance && levels.is_rung(mesh, &judged.ends, &judged.sides)
        };
        let mut asked: Vec<f64> =
            self.judged.iter().filter(coarse).map(|judged| judged.deviation.bound / tolerance).collect();
        if asked.len() as f64 <= MANY * self.judged.len() as f64 {
            return None;
        }
        asked.sort_by(f64::total_cmp);
        Some(asked[asked.len() * 3 / 4].clamp(1.05, 4.0))
    }

    /// Splits what is not good enough, and moves all.
    fn finish(mut self, tolerance: f64, triangle_limit: u64) -> Result<(Mesh, Deviation), DeformError> {
        for _ in 0..ROUNDS {
            let mut marks: HashMap<(u32, u32), f64> = HashMap::new();
            for judged in self.judged.iter().filter(|judged| judged.deviation.bound > tolerance) {
                judged.mark(&mut marks);
            }
            if marks.is_empty() {
                break;
            }
            let parts = self.splitter.split(&marks);
            let needed = self.splitter.mesh.triangles.len() as u64;
            if needed > triangle_limit {
                return Err(TessellateError::TooMany { needed, limit: triangle_limit }.into());
            }
            self.images.follow(&self.splitter.mesh)?;
            let fresh = |triangle, part: &Part| match part.whole {
                true => self.judged[part.of as usize],
                false => self.images.judge(&self.splitter, triangle, tolerance),
            };
            let triangles = self.splitter.mesh.triangles.iter();
            self.judged = triangles.zip(&parts).map(|(triangle, part)| fresh(triangle, part)).collect();
        }
        let all = self.judged.iter().map(|judged| judged.deviation);
        let deviation = all.fold(Deviation::NONE, Deviation::union);
        Ok((self.images.moved(self.splitter.mesh), deviation))
    }
}

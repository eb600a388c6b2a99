//! Curved quadrics inside walls.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::judge::{FlatChart, SheetChart};
use super::shell::{Face, Shell};
use super::skeleton::{Body, Edge, Skeleton};
use super::{Job, Made, proved};
use crate::geometry::field::quadric::{HalfSpace, QuadricForm, QuadricKind, Sheet};
use crate::geometry::field::{Field, Quadric};
use crate::geometry::mesh;
use crate::geometry::tessellate::TessellateError;
use crate::geometry::tessellate::region::{Chart, Fault, NO_LINE, Outline, Place, Wanted, fill};

/// Times that lines are cut finer where their chords cross.
pub(super) const TRIES: usize = 8;

/// A quadric that is not flat and the walls around it.
pub(super) struct Walled<'a> {
    pub(super) quadric: &'a Quadric,
    pub(super) form: &'a QuadricForm,
    pub(super) walls: &'a [HalfSpace],
    /// Sources of anchors of the first sheet and of the first wall.
    pub(super) first_sheet: u32,
    pub(super) first_wall: u32,
}

/// The body of a quadric inside walls, as it looks around a point within a distance.
pub(super) fn in_walls(
    walled: &Walled<'_>,
    (around, size): (DVec3, f64),
    job: &Job,
) -> Result<Made, TessellateError> {
    let Walled { quadric, form, walls, .. } = *walled;
    let (walls, touching) = apart_from_apex(form, walls, size);
    let mut touching = touching;
    let sheets = Sheet::all(form, &walls);
    let mut cuts: Vec<HalfSpace> = Vec::new();
    for limit in sheets.iter().flat_map(Sheet::limits) {
        if !cuts.iter().any(|cut| cut.normal.cross(limit.normal).length() < 1e-9) {
            touching.push(limit.touches_apex(form));
            cuts.push(limit);
        }
    }
    let apex = sheets.first().and_then(Sheet::apex);
    let body = Body { quadric, walls: &walls, touching: &touching, cuts: &cuts, apex, around, size };
    let mut job = *job;
    for _ in 0..TRIES {
        let skeleton = body.skeleton(job.closed, &job)?;
        match dress(walled, &body, &sheets, &skeleton, &job)? {
            Ok(made) => return Ok(made),
            Err(Fault::Crossing) => job = job.finer(),
        }
    }
    Err(TessellateError::Tangled)
}

/// Walls that pass the apex of a cone nearly go through it exactly; those that only touch it there are marked.
fn apart_from_apex(form: &QuadricForm, walls: &[HalfSpace], size: f64) -> (Vec<HalfSpace>, Vec<bool>) {
    /// Distance from the apex as a share of the size: a circle that small would be dust.
    const NEAR: f64 = 1e-6;
    let mut snapped = walls.to_vec();
    let mut touching = vec![false; walls.len()];
    if form.kind != QuadricKind::Cone {
        return (snapped, touching);
    }
    for (wall, touches) in snapped.iter_mut().zip(&mut touching) {
        if wall.depth(form.origin).abs() > NEAR * size {
            continue;
        }
        wall.offset = wall.normal.dot(form.origin);
        // Directions of the cone are (a cos, b sin, +-c); the wall meets them between these two numbers.
        let local = form.axes.transpose() * wall.normal * form.half;
        let around = local.truncate().length();
        *touches = local.z.abs() >= around * (1.0 - NEAR);
    }
    (snapped, touching)
}

/// The faces of a body on its skeleton.
fn dress(
    walled: &Walled<'_>,
    body: &Body<'_>,
    sheets: &[Sheet],
    skeleton: &Skeleton,
    job: &Job,
) -> Result<Result<Made, Fault>, TessellateError> {
    let mut shell = Shell::on(skeleton.points.clone());
    let sheets =
        Sheets { quadric: body.quadric, all: sheets, first: walled.first_sheet, on: &|edge| edge.on_quadric };
    let found = match add_sheets(&sheets, skeleton, body.size, &mut shell, job)? {
        Ok(found) => found,
        Err(fault) => return Ok(Err(fault)),
    };
    if job.closed {
        for (wall, source) in body.walls.iter().zip(walled.first_wall..) {
            let places = skeleton.on_wall((source - walled.first_wall) as usize, wall);
            let filled = match fill_face(&FlatChart, &places, &mut shell, job)? {
                Ok(filled) => filled,
                Err(fault) => return Ok(Err(fault)),
            };
            let Some((triangles, _)) = filled else { continue };
            add_wall(&mut shell, wall, &triangles, source);
        }
    }
    Ok(Ok(Made { shell, deviation: proved(found.max(skeleton.out)) }))
}

/// The sheets of a quadric that are to become faces.
pub(super) struct Sheets<'a> {
    pub(super) quadric: &'a Quadric,
    pub(super) all: &'a [Sheet],
    /// Source of anchors of the first.
    pub(super) first: u32,
    /// Which edges lie on the quadric.
    pub(super) on: &'a dyn Fn(&Edge) -> bool,
}

/// Adds the sheets of a quadric; the greatest bound of their triangles.
pub(super) fn add_sheets(
    sheets: &Sheets<'_>,
    skeleton: &Skeleton,
    size: f64,
    shell: &mut Shell,
    job: &Job,
) -> Result<Result<f64, Fault>, TessellateError> {
    let mut bound: f64 = 0.0;
    for (sheet, source) in sheets.all.iter().zip(sheets.first..) {
        let places = skeleton.on_sheet(sheet, size, sheets.on);
        let chart = SheetChart { quadric: sheets.quadric, sheet };
        let filled = match fill_face(&chart, &places, shell, job)? {
            Ok(filled) => filled,
            Err(fault) => return Ok(Err(fault)),
        };
        let Some((triangles, found)) = filled else { continue };
        bound = bound.max(found);
        shell.add(&Face {
            triangles: &triangles,
            outward: &|point| sheets.quadric.gradient(point),
            place: &|_, point| sheet.drop(point),
            source,
            shared: !job.uv,
        });
    }
    Ok(Ok(bound))
}

/// Adds a flat face.
pub(super) fn add_wall(shell: &mut Shell, wall: &HalfSpace, triangles: &[[u32; 3]], source: u32) {
    shell.add(&Face {
        triangles,
        outward: &|_| -wall.normal,
        place: &|_, point| flat_place(wall, point),
        source,
        shared: false,
    });
}

/// Coordinates in the plane of a wall.
pub(super) fn flat_place(wall: &HalfSpace, point: DVec3) -> DVec2 {
    let x = wall.normal.any_orthonormal_vector();
    DVec2::new(point.dot(x), point.dot(wall.normal.cross(x)))
}

/// Triangles of a face and the greatest bound of them.
type Filled = Option<(Vec<[u32; 3]>, f64)>;

/// Fills a face; `None` where no edge bounds one.
pub(super) fn fill_face(
    chart: &dyn Chart,
    outline: &Outline,
    shell: &mut Shell,
    job: &Job,
) -> Result<Result<Filled, Fault>, TessellateError> {
    if outline.edges.is_empty() {
        return Ok(Ok(None));
    }
    let wanted = Wanted { tolerance: job.tolerance, limit: job.limit, lattice: job.lattice };
    let filled = fill(chart, outline, &mut shell.points, wanted)?;
    Ok(filled.map(|filled| Some((filled.triangles, filled.bound))))
}

/// Outlines under construction: the place of each point.
#[derive(Default)]
struct Places {
    outline: Outline,
    known: BTreeMap<u32, usize>,
}

impl Places {
    /// The place of a point of a line.
    fn add(&mut self, point: u32, at: DVec2, line: u32) -> usize {
        let places = &mut self.outline.places;
        let index = *self.known.entry(point).or_insert_with(|| {
            places.push(Place { at, point, lines: [NO_LINE; 2] });
            places.len() - 1
        });
        let lines = &mut places[index].lines;
        if !lines.contains(&line) {
            lines[usize::from(lines[0] != NO_LINE)] = line;
        }
        index
    }

    fn add_edge(&mut self, edge: &Edge, line: u32, at: impl Fn(u32) -> DVec2) {
        for pair in edge.points.windows(2) {
            let ends = [pair[0], pair[1]].map(|point| self.add(point, at(point), line));
            self.outline.edges.push(ends);
        }
    }
}

impl Skeleton {
    /// The outline of a sheet.
    pub(super) fn on_sheet(&self, sheet: &Sheet, size: f64, on: impl Fn(&Edge) -> bool) -> Outline {
        let limits = sheet.limits();
        let inside =
            |edge: &&Edge| on(edge) && limits.iter().all(|limit| limit.depth(edge.middle) >= -1e-9 * size);
        let edges = self.edges.iter().filter(inside).enumerate();
        let edges: Vec<(u32, &Edge)> = edges.map(|(line, edge)| (mesh::index(line), edge)).collect();
        let mut places = Places::default();
        let drop = |point: u32| sheet.drop(self.points[point as usize]);
        let at_apex = |edge: &Edge| edge.points.iter().any(|point| Some(*point) == self.apex);
        let (rays, lines): (Vec<_>, Vec<_>) = edges.into_iter().partition(|(_, edge)| at_apex(edge));
        for (line, edge) in lines {
            places.add_edge(edge, line, drop);
        }
        if let Some(apex) = self.apex.filter(|_| !rays.is_empty()) {
            self.add_rays(apex, &rays, drop, &mut places);
        }
        places.outline
    }

    /// Lines from an apex: in the plane they end at places of their own on one level, which join in pairs.
    fn add_rays(&self, apex: u32, rays: &[(u32, &Edge)], drop: impl Fn(u32) -> DVec2, places: &mut Places) {
        let far =
            |edge: &Edge| edge.points.iter().copied().filter(|point| *point != apex).collect::<Vec<_>>();
        let others = rays.iter().flat_map(|(_, edge)| far(edge)).map(|point| drop(point).y);
        let low =
            places.outline.places.iter().map(|place| place.at.y).chain(others).fold(f64::INFINITY, f64::min);
        let mut ends: Vec<(f64, usize)> = Vec::new();
        for (line, edge) in rays {
            let angle = far(edge).first().map_or(0.0, |point| drop(*point).x);
            let at = DVec2::new(angle, low - 1e-3);
            places.outline.places.push(Place { at, point: apex, lines: [*line, NO_LINE] });
            let end = places.outline.places.len() - 1;
            ends.push((angle, end));
            for pair in edge.points.windows(2) {
                let ends = [pair[0], pair[1]]
                    .map(|point| if point == apex { end } else { places.add(point, drop(point), *line) });
                places.outline.edges.push(ends);
            }
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in ends.chunks_exact(2) {
            places.outline.edges.push([pair[0].1, pair[1].1]);
        }
    }

    /// The outline of what lies on a wall.
    pub(super) fn on_wall(&self, index: usize, wall: &HalfSpace) -> Outline {
        let mut places = Places::default();
        for edge in self.edges.iter().filter(|edge| edge.lies_on(index)) {
            places.add_edge(edge, NO_LINE, |point| flat_place(wall, self.points[point as usize]));
        }
        places.outline
    }
}

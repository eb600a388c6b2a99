//! Sections carried along paths.
//!
//! The section is cut into chords (deviation e1 in its plane, proved), and stations are set along the path.
//! The lines that the section's points trace have no closed form, so what their chords and the diagonals of
//! the cells leave out (e2) is measured at the middle of each, the place of the greatest deviation of a
//! smooth curve, with a margin; e1 + e2 is `Sampled`, except on straight paths without twist, where e2 is
//! zero and the bound is proved. At corners of the path the section stands in the bisecting plane (a mitre).

use glam::{DVec2, DVec3};

use super::cap::{CapLoop, Facing, add_cap, twice_area};
use super::discretize::{Density, Station, arc_lengths, discretize};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::{ln, pow};
use crate::geometry::surface::{Carry, Section, SweptSurface};

/// A section carried along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The section, x along the frame's side, y along its up.
    pub profile: AnyCurve,
    /// The path.
    pub path: AnyCurve,
    /// How the section is carried.
    pub carry: Carry,
    /// Whether the ends of an open path are closed by flat faces, where the section is closed.
    pub caps: bool,
}

/// Measured deviations are raised by this share: between the samples a smooth curve can exceed them by a
/// term of the next order.
const MARGIN: f64 = 1.05;

/// What is added to the margin for each radian that a row twists: distances are taken across the tangent plane of
/// one place, from which a twisted surface departs. Dense samples of ellipses, rectangles and lines on straight
/// and bent paths, at 50 to 5000 degrees, exceed what is measured so by up to half of each radian.
const TWIST_MARGIN: f64 = 0.7;

/// The share of the path's own bound that a chord must keep whatever the samples say. The bound holds for long
/// chords too, and is up to six times what a curve does.
const GUARD: f64 = 8.0;

/// Radians by which the section may turn over one chord.
const GREATEST_TWIST: f64 = 0.5;

/// Carries a section into triangles. Anchor sources: the wall is 0, the first end 1, the last end 2.
///
/// # Errors
/// When the limit would be passed, the section encloses no area, or an end cannot be triangulated.
pub fn sweep(shape: &Sweep, detail: &Detail) -> Result<Tessellation, TessellateError> {
    if let SurfaceDensity::Grid { u, v } = detail.density {
        detail.allow(2 * u64::from(u) * u64::from(v))?;
    }
    let surface = SweptSurface::new(shape.profile.clone(), shape.path.clone(), &shape.carry);
    let SurfaceDensity::Tolerance(tolerance) = detail.density else {
        return Plan::new(shape, &surface, detail, 0.0)?.build(shape, detail);
    };
    // What a row leaves out falls with the square of its length, or where a flat side twists with the length
    // itself: the exponent is taken from the last two trials.
    let mut aim = tolerance / 2.0;
    let mut exponent = 1.0;
    let mut plan = Plan::new(shape, &surface, detail, aim)?;
    for _ in 0..10 {
        let bound = plan.deviation.bound;
        if bound <= tolerance {
            break;
        }
        let next = aim * pow(0.97 * tolerance / bound, 1.0 / exponent);
        let finer = Plan::new(shape, &surface, detail, next)?;
        // Where a mitre leaves no room for rows, more rows elsewhere do not help.
        if finer.deviation.bound > 0.98 * bound {
            if finer.path.len() > 4 * plan.path.len() {
                break;
            }
            aim = next * 0.5;
            continue;
        }
        exponent = (ln(finer.deviation.bound / bound) / ln(next / aim)).clamp(0.25, 1.0);
        (plan, aim) = (finer, next);
    }
    plan.build(shape, detail)
}

/// The path as the lines traced by the section see it: chords are judged by all of them.
struct Traced<'a> {
    surface: &'a SweptSurface,
    offsets: Vec<DVec2>,
}

impl Curve for Traced<'_> {
    fn domain(&self) -> Domain {
        self.surface.path.domain()
    }

    fn is_closed(&self) -> bool {
        self.surface.path.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        self.surface.path.evaluate(t, side)
    }

    fn joints(&self) -> Vec<f64> {
        let mut joints = self.surface.path.joints();
        joints.extend(self.surface.frames.joints());
        joints.sort_by(f64::total_cmp);
        joints
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let path = &self.surface.path;
        if straight(self.surface, from, to) {
            return 0.0;
        }
        let (start, end) = (self.surface.section(from, Side::After), self.surface.section(to, Side::Before));
        // Samples of a chord over whole turns see nothing: such a chord is judged by the path's own bound, and
        // by how far the section turns on it.
        let mut deviation = path.chord_deviation(from, to) / GUARD;
        if self.surface.frames.turn_between(from, to).abs() > GREATEST_TWIST {
            let reach = self.offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
            deviation = deviation.max(reach);
        }
        for part in [0.25, 0.5, 0.75] {
            let middle = self.surface.section(from + (to - from) * part, Side::After);
            for offset in &self.offsets {
                let chord = (start.point(offset.x, offset.y), end.point(offset.x, offset.y));
                deviation = deviation.max(across(middle.point(offset.x, offset.y), chord));
            }
        }
        deviation * MARGIN
    }
}

/// The section as a twist sees it. Its straight sides become saddles, and a cell of width a and length h with
/// rate w of twist leaves out w a h / 4 at its diagonal, whatever its proportions: sides are cut so that
/// cells come out about square. Long thin cells would be as near to the surface, but tilt against it by an
/// angle that no tolerance lessens.
struct Twisted<'a> {
    profile: &'a AnyCurve,
    rate: f64,
}

impl Curve for Twisted<'_> {
    fn domain(&self) -> Domain {
        self.profile.domain()
    }

    fn is_closed(&self) -> bool {
        self.profile.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        self.profile.evaluate(t, side)
    }

    fn joints(&self) -> Vec<f64> {
        self.profile.joints()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let width = self.profile.point(from).distance(self.profile.point(to));
        self.profile.chord_deviation(from, to).max(self.rate * width * width / 4.0)
    }
}

/// The section cut into chords; their deviations are those of the section alone.
fn section_stations(
    shape: &Sweep,
    surface: &SweptSurface,
    density: Density,
    limit: u64,
) -> Result<Vec<Station>, TessellateError> {
    let rate = surface.frames.greatest_turn_rate();
    if rate == 0.0 {
        return discretize(&shape.profile, density, limit);
    }
    let mut stations = discretize(&Twisted { profile: &shape.profile, rate }, density, limit)?;
    for index in 1..stations.len() {
        let (from, to) = (stations[index - 1].t, stations[index].t);
        stations[index - 1].deviation = shape.profile.chord_deviation(from, to);
    }
    Ok(stations)
}

/// Whether the section goes straight on between two parameters, without a turn.
fn straight(surface: &SweptSurface, from: f64, to: f64) -> bool {
    surface.path.chord_deviation(from, to) == 0.0
        && (surface.frames.steady() || surface.frames.turn_between(from, to).abs() < 1e-9)
}

/// Distance of a point from the line of a chord.
fn across(point: DVec3, (start, end): (DVec3, DVec3)) -> f64 {
    let direction = (end - start).normalize_or_zero();
    let away = point - start;
    (away - direction * away.dot(direction)).length()
}

/// Section and path, cut, before any vertex is made.
struct Plan {
    profile: Vec<Station>,
    profile_along: Vec<f64>,
    profile_closed: bool,
    path: Vec<Station>,
    path_along: Vec<f64>,
    path_closed: bool,
    /// Sections before and after each station of the path; equal but at corners.
    sections: Vec<(Section, Section)>,
    deviation: Deviation,
}

impl Plan {
    fn new(
        shape: &Sweep,
        surface: &SweptSurface,
        detail: &Detail,
        aim: f64,
    ) -> Result<Self, TessellateError> {
        let (across, along) = match detail.density {
            SurfaceDensity::Tolerance(_) => (Density::Tolerance(aim), Density::Tolerance(aim)),
            SurfaceDensity::Grid { u, v } => (Density::Count(u), Density::Count(v)),
        };
        let limit = detail.triangle_limit;
        let mut profile = section_stations(shape, surface, across, limit)?;
        let profile_closed = shape.profile.is_closed();
        if profile_closed && (profile.len() < 4 || twice_area(&places(&profile)) == 0.0) {
            return Err(TessellateError::NoArea);
        }
        let lengths = |curve: &AnyCurve, stations: &[Station]| {
            if !detail.uv {
                return vec![0.0; stations.len()];
            }
            let lengths = arc_lengths(curve, stations);
            let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
            lengths.iter().map(|length| length / whole).collect()
        };
        let mut profile_along = lengths(&shape.profile, &profile);
        if profile_closed && twice_area(&places(&profile)) < 0.0 {
            super::extrude::reverse(&mut profile);
            profile_along = profile_along.iter().rev().map(|part| 1.0 - part).collect();
        }
        let path = match along {
            Density::Count(_) => discretize(&shape.path, along, limit)?,
            Density::Tolerance(_) => {
                let traced = Traced { surface, offsets: spread(&profile) };
                discretize(&traced, along, limit / (2 * (profile.len() as u64 - 1)) + 1)?
            }
        };
        let path = clear_of_corners(surface, path, &profile);
        let needed = 2 * (profile.len() as u64 - 1) * (path.len() as u64 - 1);
        if needed > limit {
            return Err(TessellateError::TooMany { needed, limit });
        }
        let mut plan = Self {
            profile_along,
            profile_closed,
            path_along: lengths(&shape.path, &path),
            path_closed: shape.path.is_closed(),
            sections: sections(surface, &path),
            profile,
            path,
            deviation: Deviation::NONE,
        };
        plan.deviation = plan.measure(surface);
        Ok(plan)
    }

    /// e1 of the section's chords plus e2 along the path.
    fn measure(&self, surface: &SweptSurface) -> Deviation {
        let e1 = self.profile.iter().map(|station| station.deviation).fold(0.0, f64::max);
        let mut e2 = 0.0_f64;
        for row in 0..self.path.len() - 1 {
            let (from, to) = (self.path[row].t, self.path[row + 1].t);
            if straight(surface, from, to) {
                continue;
            }
            let middle = surface.section((from + to) / 2.0, Side::After);
            let sampled = self.row_deviation(surface, row, &middle);
            // A chord over whole turns looks short to samples: then the path's own bound speaks.
            let bend = surface.path.chord_deviation(from, to);
            e2 = e2.max(if bend > 2.0 * GUARD * sampled { bend } else { sampled });
        }
        let evidence = match (e1, e2) {
            (0.0, 0.0) => Evidence::Exact,
            (_, 0.0) => Evidence::Proved,
            _ => Evidence::Sampled,
        };
        Deviation { bound: e1 + e2 * MARGIN, evidence }
    }

    /// Greatest distance to the surface from the cells between a row and the next.
    fn row_deviation(&self, surface: &SweptSurface, row: usize, middle: &Section) -> f64 {
        if middle.twist == 0.0 {
            return self.plain_cell_deviation(row, middle);
        }
        // Twisted cells are saddles: their triangles may be furthest away before and behind the middle.
        let (from, to) = (self.path[row].t, self.path[row + 1].t);
        let lean = 1.0 + TWIST_MARGIN * surface.frames.turn_between(from, to).abs();
        let section = |part: f64| surface.section(from + (to - from) * part, Side::After);
        let deviations = [0.25, 0.5, 0.75].map(|part| self.cell_deviation(row, &section(part), part));
        deviations.into_iter().fold(0.0, f64::max) * lean
    }

    /// Greatest distance to the surface from chords and diagonals between two rows, at `part` of their length
    /// where `section` stands.
    fn cell_deviation(&self, row: usize, section: &Section, part: f64) -> f64 {
        let (start, end) = (&self.sections[row].1, &self.sections[row + 1].0);
        let mut deviation = 0.0_f64;
        let place = |column: usize| self.profile[column].point;
        let mut before = place(0);
        for column in 0..self.profile.len() {
            let here = place(column);
            let chord = (start.point(here.x, here.y), end.point(here.x, here.y));
            let between = chord.0.lerp(chord.1, part);
            deviation = deviation.max(self.normal_distance(between, section, (here, here), (column, part)));
            if column > 0 {
                let diagonal = start.point(before.x, before.y).lerp(chord.1, part);
                deviation =
                    deviation.max(self.normal_distance(diagonal, section, (before, here), (column, part)));
            }
            before = here;
        }
        deviation
    }

    /// The same in the middle, without twist: the normals of the surface lie in the plane of the middle section,
    /// where all is measured in its own two coordinates.
    fn plain_cell_deviation(&self, row: usize, middle: &Section) -> f64 {
        let (start, end) = (&self.sections[row].1, &self.sections[row + 1].0);
        let flat = |point: DVec3| {
            let away = point - middle.origin;
            DVec2::new(away.dot(middle.frame.side), away.dot(middle.frame.up))
        };
        let mut deviation = 0.0_f64;
        let mut before: Option<(DVec2, DVec2)> = None;
        for station in &self.profile {
            let here = station.point.truncate();
            let (near, far) = (flat(start.point(here.x, here.y)), flat(end.point(here.x, here.y)));
            let away = (near + far) / 2.0 - here;
            // At a corner of the section there is no one normal: all of the distance counts.
            let corner = station.before != station.after;
            let across = station.after.truncate().perp_dot(away).abs();
            deviation = deviation.max(if corner { away.length() } else { across });
            if let Some((last, last_near)) = before {
                let away = (last_near + far) / 2.0 - (last + here) / 2.0;
                deviation = deviation.max((here - last).normalize_or_zero().perp_dot(away).abs());
            }
            before = Some((here, near));
        }
        deviation
    }

    /// Distance across the surface of `point` from the place at `part` between two points of a section.
    fn normal_distance(
        &self,
        point: DVec3,
        section: &Section,
        (first, second): (DVec3, DVec3),
        (column, part): (usize, f64),
    ) -> f64 {
        let place = first.lerp(second, part);
        let direction = if first == second { self.profile[column].after } else { second - first };
        let normal = section.normal((place.x, place.y), (direction.x, direction.y));
        let away = point - section.point(place.x, place.y);
        if first == second && self.profile[column].before != self.profile[column].after {
            // At a corner of the section there is no one normal: all that is not along the path counts.
            return (away - section.frame.along * away.dot(section.frame.along)).length();
        }
        away.dot(normal).abs()
    }

    fn build(self, shape: &Sweep, detail: &Detail) -> Result<Tessellation, TessellateError> {
        let mut mesh = Mesh::default();
        let (columns, rows) = (self.point_columns(), self.point_rows());
        mesh.points.reserve_exact(rows * columns);
        for row in 0..rows {
            mesh.points.extend((0..columns).map(|column| self.position(row, column)));
        }
        for (first, last) in hard_runs(&self.path, detail) {
            for (left, right) in hard_runs(&self.profile, detail) {
                self.patch(&mut mesh, (first, last), (left, right), detail);
            }
        }
        if shape.caps && self.profile_closed && !self.path_closed {
            self.cap(&mut mesh, 0, detail)?;
            self.cap(&mut mesh, rows - 1, detail)?;
        }
        mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
        Ok(Tessellation { mesh, deviation: self.deviation })
    }

    fn point_columns(&self) -> usize {
        self.profile.len() - usize::from(self.profile_closed)
    }

    fn point_rows(&self) -> usize {
        self.path.len() - usize::from(self.path_closed)
    }

    fn point_index(&self, row: usize, column: usize) -> PointIndex {
        let (columns, rows) = (self.point_columns(), self.point_rows());
        PointIndex(mesh::index(row % rows * columns + column % columns))
    }

    /// A point of the section at a row, at corners in the bisecting plane.
    fn position(&self, row: usize, column: usize) -> DVec3 {
        let (before, after) = &self.sections[row];
        let place = self.profile[column].point;
        let plain = after.point(place.x, place.y);
        if before.frame.along == after.frame.along {
            return plain;
        }
        let bisector = before.frame.along + after.frame.along;
        let lean = after.frame.along.dot(bisector);
        plain - after.frame.along * ((plain - after.origin).dot(bisector) / lean)
    }

    /// Vertices and triangles between two hard rows and two hard columns.
    fn patch(
        &self,
        mesh: &mut Mesh,
        (first, last): (usize, usize),
        (left, right): (usize, usize),
        detail: &Detail,
    ) {
        let whole =
            |from: usize, to: usize, count: usize, closed: bool| closed && from == 0 && to == count - 1;
        let share = |round: bool| round && !detail.uv;
        let round_path = share(whole(first, last, self.path.len(), self.path_closed))
            && self.path[0].turn() <= detail.crease_angle;
        let round_profile = share(whole(left, right, self.profile.len(), self.profile_closed))
            && self.profile[0].turn() <= detail.crease_angle;
        let rows = last - first + usize::from(!round_path);
        let columns = right - left + usize::from(!round_profile);
        let base = mesh::index(mesh.vertices.len());
        mesh.vertices.reserve(rows * columns);
        mesh.triangles.reserve(2 * (last - first) * (right - left));
        let directions: Vec<DVec3> = (left..left + columns)
            .map(|column| self.direction(column, (column == left, column == right), detail))
            .collect();
        for row in first..first + rows {
            let hard_row = self.path[row].turn() > detail.crease_angle;
            let side = match (hard_row, row == first, row == last) {
                (true, true, _) => Some(Side::After),
                (true, _, true) => Some(Side::Before),
                _ => None,
            };
            for (column, direction) in (left..).zip(&directions) {
                mesh.vertices.push(self.vertex((row, side), (column, *direction), detail));
            }
        }
        let at = |row: usize, column: usize| {
            VertexIndex(base + mesh::index(row % rows * columns + column % columns))
        };
        for row in 0..last - first {
            for column in 0..right - left {
                let corners =
                    [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
                mesh.triangles.push([corners[0], corners[1], corners[2]]);
                mesh.triangles.push([corners[0], corners[2], corners[3]]);
            }
        }
    }

    /// Direction of the section at a column; at a hard joint of the side that the patch lies on.
    fn direction(&self, column: usize, (left, right): (bool, bool), detail: &Detail) -> DVec3 {
        let station = &self.profile[column];
        match (station.turn() > detail.crease_angle, left, right) {
            (true, true, _) => station.after,
            (true, _, true) => station.before,
            _ if station.before == station.after => station.after,
            _ => (station.before + station.after).normalize_or(station.after),
        }
    }

    fn vertex(
        &self,
        (row, side): (usize, Option<Side>),
        (column, direction): (usize, DVec3),
        detail: &Detail,
    ) -> Vertex {
        let station = &self.profile[column];
        let (before, after) = &self.sections[row];
        let place = (station.point.x, station.point.y);
        let direction = (direction.x, direction.y);
        let normal = match side {
            Some(Side::After) => after.normal(place, direction),
            Some(Side::Before) => before.normal(place, direction),
            None if before.frame.along == after.frame.along => after.normal(place, direction),
            None => (before.normal(place, direction) + after.normal(place, direction)).normalize_or(DVec3::Y),
        };
        let uv = DVec2::new(self.profile_along[column], 1.0 - self.path_along[row]);
        Vertex {
            point: self.point_index(row, column),
            normal,
            uv: if detail.uv { uv } else { DVec2::ZERO },
            anchor: Anchor { source: 0, u: station.t, v: self.path[row].t },
        }
    }

    fn cap(&self, mesh: &mut Mesh, row: usize, detail: &Detail) -> Result<(), TessellateError> {
        let end = row > 0;
        let columns = self.point_columns();
        let outline = CapLoop {
            place: places(&self.profile),
            points: (0..columns).map(|column| self.point_index(row, column)).collect(),
        };
        let along = self.sections[row].0.frame.along;
        let facing = Facing { normal: if end { along } else { -along }, mirrored: !end };
        add_cap(mesh, &[outline], facing, 1 + u32::from(end), detail.uv)
    }
}

/// Places of a closed outline, its end left out.
fn places(stations: &[Station]) -> Vec<DVec2> {
    stations[..stations.len() - 1].iter().map(|station| station.point.truncate()).collect()
}

/// At most sixteen points of the section that stand for all.
fn spread(profile: &[Station]) -> Vec<DVec2> {
    let step = profile.len().div_ceil(16);
    profile.iter().step_by(step).map(|station| station.point.truncate()).collect()
}

fn sections(surface: &SweptSurface, path: &[Station]) -> Vec<(Section, Section)> {
    let last = path.len() - 1;
    let closed = surface.path.is_closed();
    let mut all: Vec<(Section, Section)> = path
        .iter()
        .enumerate()
        .map(|(row, station)| {
            let smooth = station.before == station.after;
            let after = surface.section(station.t, if row == last { Side::Before } else { Side::After });
            let before = if smooth || row == 0 { after } else { surface.section(station.t, Side::Before) };
            (before, after)
        })
        .collect();
    if closed {
        all[0].0 = all[last].0;
        all[last].1 = all[0].1;
    }
    all
}

/// Leaves out stations whose section would reach across the bisecting plane of a corner: there the mitre
/// already stands, and rows behind it would fold the surface.
fn clear_of_corners(surface: &SweptSurface, path: Vec<Station>, profile: &[Station]) -> Vec<Station> {
    let corner = |station: &Station| station.before.dot(station.after) < 1.0 - 1e-12;
    let closed = surface.path.is_closed();
    let ends = path.len() - 1;
    let corners: Vec<(usize, DVec3, DVec3)> = (0..path.len())
        .filter(|row| corner(&path[*row]) && (closed || (*row > 0 && *row < ends)))
        .map(|row| (row, path[row].point, (path[row].before + path[row].after).normalize_or_zero()))
        .collect();
    if corners.is_empty() {
        return path;
    }
    let clear = |row: usize, station: &Station| {
        let near = |place: usize| corners.get(place).into_iter();
        let next = corners.partition_point(|(corner, ..)| *corner <= row);
        let section = surface.section(station.t, Side::After);
        let reaches = |(_, origin, normal): &(usize, DVec3, DVec3), sign: f64| {
            let across = |point: &Station| {
                (section.point(point.point.x, point.point.y) - *origin).dot(*normal) * sign <= 0.0
            };
            profile.iter().any(across)
        };
        let before = near(next.wrapping_sub(1)).any(|corner| reaches(corner, 1.0));
        !before && !near(next).any(|corner| reaches(corner, -1.0))
    };
    let keep: Vec<bool> = (0..path.len())
        .map(|row| row == 0 || row == ends || corner(&path[row]) || clear(row, &path[row]))
        .collect();
    path.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(station, _)| station).collect()
}

/// Runs of stations between hard joints.
fn hard_runs(stations: &[Station], detail: &Detail) -> Vec<(usize, usize)> {
    let last = stations.len() - 1;
    let hard = |station: &Station| station.turn() > detail.crease_angle;
    let mut stops = vec![0];
    stops.extend((1..last).filter(|index| hard(&stations[*index])));
    stops.push(last);
    stops.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

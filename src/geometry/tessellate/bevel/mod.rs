//! Solids between two flat ends whose walls lean inward: beveled and drafted extrusions.
//!
//! The wall is given by an edge profile, how far it stands inside the outline at each height. Outlines become polygons
//! within a part of the tolerance, [`Front`] moves these inward, and what their edges run over between two heights
//! becomes triangles.
//!
//! Promise: the surface is the set of points as far inside the outline as the profile says for their height, and the
//! bound is proved: distances from two outlines differ by no more than the outlines do, so the chords of the
//! outline, the fans at its inner corners and the chords of the profile add up. Nothing cracks, and faces that vanish
//! on the way up leave no triangle without area. Not promised: profiles that reach further in than the outline is
//! wide; [`EdgeProfile::fits`] tells them.
//!
//! Cost: O(n m log n) for n chords of the outlines and m rows.

mod front;

pub use front::Collision;

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::cap::{CapLoop, Facing, add_cap};
use super::discretize::{Density, Station, arc_lengths, discretize};
use super::extrude::{Extrusion, Outline, cut, firsts};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::mesh;
use crate::geometry::mesh::triangulate::triangulate;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::cos_degrees;
use crate::geometry::planar::turn;
use front::{Corner, Face, Front, Passed, Stretch, whole, widest};

/// How far the wall of an extrusion stands inside its outline: curves whose x is that distance and whose y is the
/// height, metres. x nowhere decreases along them.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeProfile {
    /// From where the outline is whole down to the lower end; none where it is whole at the lower end.
    pub lower: Option<AnyCurve>,
    /// From the same height up to the upper end.
    pub upper: AnyCurve,
}

impl EdgeProfile {
    /// How far in the wall reaches at most, metres.
    #[must_use]
    pub fn deepest(&self) -> f64 {
        self.curves()
            .map(|curve| curve.evaluate(curve.domain().end, Side::Before).point.x)
            .fold(0.0, f64::max)
    }

    /// Distance of a place, inside distance and height, from the profile.
    #[must_use]
    pub fn distance(&self, place: DVec2) -> f64 {
        let point = place.extend(0.0);
        let of = |curve: &AnyCurve| {
            let domain = curve.domain();
            let mut stops = vec![domain.start];
            stops.extend(curve.breaks());
            stops.push(domain.end);
            let within =
                |pair: &[f64]| crate::geometry::curve::distance_within(curve, point, pair[0], pair[1]);
            stops.windows(2).map(within).fold(f64::INFINITY, f64::min)
        };
        self.curves().map(of).fold(f64::INFINITY, f64::min)
    }

    fn curves(&self) -> impl Iterator<Item = &AnyCurve> {
        self.lower.iter().chain([&self.upper])
    }

    /// Whether closed outlines are wide enough for it; else where they are not, and how far in a wall may reach, to a
    /// thousandth. The first outline of each island is its rim, the others are holes.
    ///
    /// # Errors
    /// As in [`discretize`]; too narrow outlines are no error.
    pub fn fits(
        &self,
        outlines: &[AnyCurve],
        islands: &[usize],
        tolerance: f64,
    ) -> Result<Option<(Collision, f64)>, TessellateError> {
        const CHORDS: u64 = 1 << 18;
        let detail = Detail {
            density: SurfaceDensity::Tolerance(tolerance),
            crease_angle: 0.0,
            uv: false,
            triangle_limit: CHORDS,
        };
        let begins = firsts(islands);
        let mut corners = Vec::new();
        for (index, curve) in outlines.iter().enumerate() {
            corners.push(polygon(&cut(curve, !begins.contains(&index), &detail)?, 0.0));
        }
        let (deepest, round) = (self.deepest(), Some(tolerance));
        Ok(match whole(&corners, deepest, round) {
            Ok(()) => None,
            Err(collision) => Some((collision, widest(&corners, deepest, round))),
        })
    }
}

/// One height of the wall.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Distance inside the outline.
    inset: f64,
    /// Height.
    z: f64,
    /// Normals of the wall, outward and up, of what comes before in the profile and after.
    tilt: [DVec2; 2],
    /// Share of the profile's length.
    along: f64,
}

/// Makes a beveled extrusion. Anchor sources as of [`super::extrude()`].
///
/// # Errors
/// As of [`super::extrude()`], and where the outline is too narrow for the profile.
pub(super) fn bevel(
    shape: &Extrusion,
    profile: &EdgeProfile,
    detail: &Detail,
) -> Result<Tessellation, TessellateError> {
    let shares = Shares::of(profile, detail);
    let begins = firsts(&shape.islands);
    let mut outlines = Vec::new();
    for (index, curve) in shape.outlines.iter().enumerate() {
        outlines.push(cut(curve, !begins.contains(&index), &shares.outline)?);
    }
    let rows = Rows::of(profile, &shares, detail)?;
    let chords: usize = outlines.iter().map(|outline| outline.stations.len() - 1).sum();
    detail.allow(2 * chords as u64 * (rows.lower.len() + rows.upper.len()) as u64)?;
    let corners: Vec<Vec<Corner>> =
        outlines.iter().map(|outline| polygon(outline, detail.crease_angle)).collect();
    let mut maker = Maker { mesh: Mesh::default(), known: HashMap::new(), detail, merged: 0.0 };
    let upper = maker.side(&corners, &rows.upper, &shares, None)?;
    let lower = if rows.lower.len() > 1 {
        maker.side(&corners, &rows.lower, &shares, Some(chords))?
    } else {
        maker.bottom(&corners)
    };
    if shape.caps {
        let source = mesh::index(outlines.len());
        let ends = [
            (lower, Facing { normal: DVec3::NEG_Z, mirrored: true }, source),
            (upper, Facing { normal: DVec3::Z, mirrored: false }, source + 1),
        ];
        for (loops, facing, source) in &ends {
            for (first, count) in begins.iter().zip(&shape.islands) {
                add_cap(&mut maker.mesh, &loops[*first..first + count], *facing, *source, detail.uv)?;
            }
        }
    }
    let (mut mesh, merged) = (maker.mesh, maker.merged);
    mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
    let stations = outlines.iter().flat_map(|outline| &outline.stations);
    let chords = stations.map(|station| station.deviation).fold(0.0, f64::max);
    let fans =
        if corners.iter().any(|corners| turns_out(corners)) { shares.fan(profile.deepest()) } else { 0.0 };
    let bound = chords + fans + rows.deviation + merged;
    Ok(Tessellation { mesh, deviation: Deviation::new(bound, Evidence::Proved) })
}

/// Parts of the tolerance.
struct Shares {
    outline: Detail,
    profile: Density,
    round: Option<f64>,
}

impl Shares {
    /// Half for the outline where the profile is curved, else nearly all of it.
    fn of(profile: &EdgeProfile, detail: &Detail) -> Self {
        let SurfaceDensity::Tolerance(tolerance) = detail.density else {
            let SurfaceDensity::Grid { v, .. } = detail.density else { unreachable!("two kinds of density") };
            return Self { outline: *detail, profile: Density::Count(v.max(1)), round: None };
        };
        let straight = profile.curves().all(|curve| {
            let mut stops = vec![curve.domain().start];
            stops.extend(curve.breaks());
            stops.push(curve.domain().end);
            stops.windows(2).all(|pair| curve.chord_deviation(pair[0], pair[1]) == 0.0)
        });
        let (outline, rows) = if straight { (0.9, 0.0) } else { (0.5, 0.4) };
        let density = SurfaceDensity::Tolerance(tolerance * outline);
        Self {
            outline: Detail { density, ..*detail },
            // Straight profiles have no chords that deviate; any tolerance will do.
            profile: Density::Tolerance(tolerance * if rows == 0.0 { 1.0 } else { rows }),
            round: Some(tolerance * 0.1),
        }
    }

    /// How far fans lie outside of their arcs.
    fn fan(&self, deepest: f64) -> f64 {
        self.round.unwrap_or_else(|| deepest * (1.0 / cos_degrees(7.5) - 1.0))
    }
}

/// Rows of both sides, from where the outline is whole.
struct Rows {
    lower: Vec<Row>,
    upper: Vec<Row>,
    deviation: f64,
}

impl Rows {
    fn of(profile: &EdgeProfile, shares: &Shares, detail: &Detail) -> Result<Self, TessellateError> {
        let (mut upper, over) = rows(&profile.upper, shares.profile, detail)?;
        let (mut lower, under) = match &profile.lower {
            Some(curve) => rows(curve, shares.profile, detail)?,
            None => (Vec::new(), (0.0, 0.0)),
        };
        let whole = over.0 + under.0;
        upper.iter_mut().for_each(|row| row.along = (under.0 + row.along) / whole);
        lower.iter_mut().for_each(|row| row.along = (under.0 - row.along) / whole);
        if let Some(below) = lower.first_mut() {
            // Where the two sides meet they look at each other's normals.
            let met = met([below.tilt[1], upper[0].tilt[1]], detail.crease_angle);
            below.tilt = [met[0]; 2];
            upper[0].tilt = [met[1]; 2];
        }
        Ok(Self { lower, upper, deviation: over.1.max(under.1) })
    }
}

/// Rows along a profile with lengths from its start; its length and how far its chords deviate.
fn rows(
    curve: &AnyCurve,
    density: Density,
    detail: &Detail,
) -> Result<(Vec<Row>, (f64, f64)), TessellateError> {
    let stations = discretize(curve, density, detail.triangle_limit)?;
    let lengths = arc_lengths(curve, &stations);
    let deviation = stations.iter().map(|station| station.deviation).fold(0.0, f64::max);
    let row = |(station, along): (&Station, &f64)| Row {
        inset: station.point.x.max(0.0),
        z: station.point.y,
        tilt: met([tilt(station.before), tilt(station.after)], detail.crease_angle),
        along: *along,
    };
    let rows = stations.iter().zip(&lengths).map(row).collect();
    Ok((rows, (lengths[lengths.len() - 1], deviation)))
}

/// The normal of a wall, outward and up, whose profile goes in a direction.
fn tilt(direction: DVec3) -> DVec2 {
    DVec2::new(direction.y.abs(), direction.x * direction.y.signum())
}

/// Two normals, or twice their mean where they differ by no more than an angle in degrees.
fn met([one, other]: [DVec2; 2], crease_angle: f64) -> [DVec2; 2] {
    if one == other || one.dot(other) >= cos_degrees(crease_angle) {
        [(one + other).normalize_or(one); 2]
    } else {
        [one, other]
    }
}

/// A cut outline as corners that will move.
fn polygon(outline: &Outline, crease_angle: f64) -> Vec<Corner> {
    let outward = |direction: DVec3| DVec2::new(direction.y, -direction.x).normalize_or(DVec2::X);
    let corner = |k: usize| {
        let (station, next) = (&outline.stations[k], &outline.stations[k + 1]);
        Corner {
            place: station.point.truncate(),
            outward: [outward(station.before), outward(station.after)],
            smooth: station.turn() <= crease_angle,
            t: [station.t, next.t],
            along: [outline.along[k], outline.along[k + 1]],
        }
    };
    (0..outline.stations.len() - 1).map(corner).collect()
}

/// Whether a polygon has a corner around which the inside takes the larger part.
fn turns_out(corners: &[Corner]) -> bool {
    let count = corners.len();
    (0..count).any(|k| {
        let [a, b, c] = [k, (k + 1) % count, (k + 2) % count].map(|k| corners[k].place);
        (b - a).perp_dot(c - b) < 0.0
    })
}

/// What makes two corners of faces one vertex: their point and, bit for bit, normal and texture coordinates.
type Key = (u32, [u64; 5]);

struct Maker<'a> {
    mesh: Mesh,
    known: HashMap<Key, VertexIndex>,
    detail: &'a Detail,
    /// The greatest length that was left out.
    merged: f64,
}

impl Maker<'_> {
    /// One side of the wall; its loops at the far end. Points of the whole outline are made by the first side;
    /// the second finds as many as it is told.
    fn side(
        &mut self,
        corners: &[Vec<Corner>],
        rows: &[Row],
        shares: &Shares,
        made: Option<usize>,
    ) -> Result<Vec<CapLoop>, TessellateError> {
        let deepest = rows[rows.len() - 1].inset;
        let crease = cos_degrees(self.detail.crease_angle);
        let mut front = Front::new(corners, deepest, shares.round, crease);
        let up = made.is_none();
        let mut points: Vec<PointIndex> = match made {
            None => Vec::new(),
            Some(count) => (0..mesh::index(count)).map(PointIndex).collect(),
        };
        for pair in rows.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let faces = if from.inset == to.inset { Ok(front.rise()) } else { front.advance(to.inset) };
            let narrow =
                |collision: Collision| TessellateError::TooNarrow { inset: deepest, place: collision.place };
            let faces = faces.map_err(narrow)?;
            let level = Level { from, to, up };
            for (place, share) in front.points.iter().skip(points.len()) {
                points.push(PointIndex(mesh::index(self.mesh.points.len())));
                self.mesh.points.push(place.extend(mix([from.z, to.z], *share)));
            }
            for mut face in faces {
                for passed in face.left.iter_mut().chain(&mut face.right) {
                    passed.point = front.stand_in(passed.point);
                }
                self.face(&front.stretches[face.edge], &face, &level, &points)?;
            }
        }
        if front.merged {
            self.merged = self.merged.max(front.nothing);
        }
        let polygons = front.polygons().into_iter();
        Ok(polygons
            .map(|polygon| CapLoop {
                place: polygon.iter().map(|(_, place)| *place).collect(),
                points: polygon.iter().map(|(point, _)| points[*point as usize]).collect(),
            })
            .collect())
    }

    /// The loops of the whole outline, whose points come first.
    fn bottom(&self, corners: &[Vec<Corner>]) -> Vec<CapLoop> {
        let mut next = 0;
        let outline = |corners: &Vec<Corner>| {
            let first = next;
            next += mesh::index(corners.len());
            CapLoop {
                place: corners.iter().map(|corner| corner.place).collect(),
                points: (first..next).map(PointIndex).collect(),
            }
        };
        corners.iter().map(outline).collect()
    }

    /// Triangles of what an edge ran over.
    fn face(
        &mut self,
        stretch: &Stretch,
        face: &Face,
        level: &Level,
        points: &[PointIndex],
    ) -> Result<(), TessellateError> {
        let chain = |passed: &[Passed]| {
            let mut chain = passed.to_vec();
            chain.dedup_by_key(|passed| passed.point);
            chain
        };
        let (left, right) = (chain(&face.left), chain(&face.right));
        // The ring goes up on the right and down on the left; places are those in the plane of the face.
        let around: Vec<Passed> = right.iter().chain(left.iter().rev()).copied().collect();
        let place = |passed: &Passed| {
            DVec2::new((passed.place - stretch.ends[0]).dot(stretch.direction), passed.share * level.height())
        };
        let places: Vec<DVec2> = around.iter().map(place).collect();
        let points_of: Vec<u32> = around.iter().map(|passed| passed.point).collect();
        let triangles = between(&places, &points_of, right.len())?;
        let vertices: Vec<VertexIndex> =
            around.iter().map(|passed| self.vertex(stretch, passed, level, points)).collect();
        for triangle in triangles {
            let [a, b, c] = triangle.map(|corner| vertices[corner as usize]);
            self.mesh.triangles.push(if level.up { [a, b, c] } else { [a, c, b] });
        }
        Ok(())
    }

    fn vertex(
        &mut self,
        stretch: &Stretch,
        passed: &Passed,
        level: &Level,
        points: &[PointIndex],
    ) -> VertexIndex {
        let share = passed.share;
        let tilt = level.from.tilt[1].lerp(level.to.tilt[0], share).normalize_or(level.from.tilt[1]);
        let normal = (passed.outward * tilt.x).extend(tilt.y).normalize_or(DVec3::Z);
        let length = stretch.ends[0].distance(stretch.ends[1]);
        let part = (passed.place - stretch.ends[0]).dot(stretch.direction) / length.max(f64::MIN_POSITIVE);
        let part = part.clamp(0.0, 1.0);
        let along = mix([level.from.along, level.to.along], share);
        let uv = if self.detail.uv { DVec2::new(mix(stretch.along, part), 1.0 - along) } else { DVec2::ZERO };
        let point = points[passed.point as usize];
        let anchor = Anchor { source: mesh::index(stretch.outline), u: mix(stretch.t, part), v: along };
        let bits = [normal.x, normal.y, normal.z, uv.x, uv.y].map(f64::to_bits);
        let next = VertexIndex(mesh::index(self.mesh.vertices.len()));
        *self.known.entry((point.0, bits)).or_insert_with(|| {
            self.mesh.vertices.push(Vertex { point, normal, uv, color: Color::WHITE, anchor });
            next
        })
    }
}

/// What lies between two rows.
struct Level {
    from: Row,
    to: Row,
    up: bool,
}

impl Level {
    /// Length of the wall between them, metres.
    fn height(&self) -> f64 {
        DVec2::new(self.from.inset, self.from.z).distance(DVec2::new(self.to.inset, self.to.z))
    }
}

/// Between two numbers, at the ends exactly these.
fn mix(ends: [f64; 2], share: f64) -> f64 {
    if share == 1.0 { ends[1] } else { ends[0] + (ends[1] - ends[0]) * share }
}

/// Triangles between two chains of places that go up, the first `rising` of them to the right, the others back down to
/// the left. Neighbors may be one point where the chains meet.
fn between(places: &[DVec2], points: &[u32], rising: usize) -> Result<Vec<[u32; 3]>, TessellateError> {
    let last = places.len() - 1;
    let (mut left, mut right) = (last, 0);
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    while left > rising || right + 1 < rising {
        let onward = right + 1 < rising && (left == rising || places[right + 1].y <= places[left - 1].y);
        let next = if onward { right + 1 } else { left - 1 };
        let corners = [left, right, next];
        if onward {
            right = next;
        } else {
            left = next;
        }
        let [a, b, c] = corners.map(|corner| points[corner]);
        if a == b || b == c || c == a {
            continue;
        }
        let [a, b, c] = corners.map(|corner| places[corner]);
        if turn(a, b, c) <= 0.0 {
            return bent(places, points);
        }
        triangles.push(corners.map(mesh::index));
    }
    Ok(triangles)
}

/// The same where a chain bulges to the other's side.
fn bent(places: &[DVec2], points: &[u32]) -> Result<Vec<[u32; 3]>, TessellateError> {
    let count = points.len();
    let kept: Vec<usize> = (0..count).filter(|k| points[*k] != points[(k + 1) % count]).collect();
    let ring: Vec<DVec2> = kept.iter().map(|k| places[*k]).collect();
    let triangles =
        triangulate(&[&ring]).map_err(|error| TessellateError::Cap { reason: error.to_string() })?;
    Ok(triangles.into_iter().map(|triangle| triangle.map(|k| mesh::index(kept[k as usize]))).collect())
}

//! The way cut into rows.

use glam::{DVec2, DVec3};

use super::super::discretize::{Density, Station, arc_lengths, discretize};
use super::super::{Detail, SurfaceDensity, TessellateError};
use super::columns::{Columns, Plain};
use crate::geometry::curve::{Curve, Domain, Jet, Side};
use crate::geometry::surface::{Plane, Stand, SweptSurface};

/// A section of the mesh.
pub(super) struct Row {
    /// Parameter.
    pub(super) v: f64,
    /// What comes before and after; equal but at corners and where the change has a joint.
    pub(super) before: Stand,
    pub(super) after: Stand,
    /// Whether they differ.
    pub(super) joint: bool,
    /// Whether nothing but its plane tells the section from that of any other place.
    pub(super) plain: bool,
    /// Sum of the directions before and after, at a corner of the way.
    pub(super) bisector: Option<DVec3>,
    /// Share of the way's length.
    pub(super) along: f64,
}

impl Row {
    /// Where a point of the section stands, seen from before or after; at corners in the bisecting plane.
    pub(super) fn point(&self, stand: &Stand, place: DVec2) -> DVec3 {
        let plane = &stand.plane;
        let plain = plane.point(place.x, place.y);
        let along = plane.frame.along;
        match self.bisector {
            None => plain,
            Some(bisector) => plain - along * ((plain - plane.origin).dot(bisector) / along.dot(bisector)),
        }
    }

    /// Whether all points of the section are one.
    pub(super) fn is_pole(&self) -> bool {
        self.after.mix.scale == DVec2::ZERO
    }
}

/// Measured deviations are raised by this share: between the samples a smooth curve can exceed them by a
/// term of the next order.
pub(super) const MARGIN: f64 = 1.05;

/// The share of the way's own bound that a chord must keep whatever the samples say. The bound holds for long
/// chords too, and is up to six times what a curve does.
pub(super) const GUARD: f64 = 8.0;

/// Radians by which the section may turn over one chord.
const GREATEST_TWIST: f64 = 0.5;

/// Cuts the way for sections that are cut into these columns.
pub(super) fn cut(
    surface: &SweptSurface,
    columns: &[Columns],
    detail: &Detail,
    aim: f64,
) -> Result<Vec<Row>, TessellateError> {
    let judged = matches!(detail.density, SurfaceDensity::Tolerance(_));
    let samples = samples(columns);
    let plain = samples.iter().filter_map(|(outline, column)| columns[*outline].plain().get(*column));
    let places = plain.map(Plain::place).collect();
    let traced = Traced { surface, samples, places, columns, reach: surface.reach(), judged };
    let limit = detail.triangle_limit;
    let stations = match detail.density {
        SurfaceDensity::Grid { v, .. } => discretize(&traced, Density::Count(v), limit)?,
        SurfaceDensity::Tolerance(_) => {
            let cells: u64 = columns.iter().map(|columns| columns.len() as u64 - 1).sum();
            // Each station is a row of two triangles a cell.
            let in_triangles = |error| match error {
                TessellateError::TooMany { needed, .. } => {
                    TessellateError::TooMany { needed: needed.saturating_mul(2 * cells), limit }
                }
                error => error,
            };
            discretize(&traced, Density::Tolerance(aim), limit / (2 * cells) + 1).map_err(in_triangles)?
        }
    };
    let stations = clear_of_corners(surface, stations, columns);
    let along = if detail.uv { arc_lengths(&traced, &stations) } else { vec![0.0; stations.len()] };
    Ok(rows(surface, &stations, &along))
}

/// At most sixteen points of the section that stand for all: index of the outline and column.
fn samples(columns: &[Columns]) -> Vec<(usize, usize)> {
    let each = 16_usize.div_ceil(columns.len());
    let of = |(outline, columns): (usize, &Columns)| {
        let step = columns.len().div_ceil(each);
        (0..columns.len()).step_by(step).map(move |column| (outline, column)).collect::<Vec<_>>()
    };
    columns.iter().enumerate().flat_map(of).collect()
}

/// The way as the lines traced by the section see it: chords are judged by all of them.
struct Traced<'a> {
    surface: &'a SweptSurface,
    columns: &'a [Columns],
    samples: Vec<(usize, usize)>,
    /// Where the samples are in a section that does not change.
    places: Vec<DVec2>,
    reach: f64,
    /// Whether chords are to be judged at all.
    judged: bool,
}

impl Traced<'_> {
    fn point(&self, stand: &Stand, (outline, column): (usize, usize)) -> DVec3 {
        stand.point(&self.columns[outline].at(column, Some(Side::After), &stand.mix))
    }

    /// How far the lines of the samples leave their chords; `point` tells where a sample stands in a section.
    fn bend<P>(&self, (from, to): (&P, &P), middles: &[P], point: impl Fn(&P, usize) -> DVec3) -> f64 {
        let away = |sample: usize| {
            let (start, end) = (point(from, sample), point(to, sample));
            let direction = (end - start).normalize_or_zero();
            let across = |middle: &P| {
                let away = point(middle, sample) - start;
                (away - direction * away.dot(direction)).length_squared()
            };
            middles.iter().map(across).fold(0.0, f64::max)
        };
        (0..self.samples.len()).map(away).fold(0.0, f64::max).sqrt()
    }

    /// The same for a section that does not change: only its plane moves.
    fn plain_bend(&self, from: f64, to: f64) -> f64 {
        let carrier = &self.surface.carrier;
        let (start, end) = (carrier.plane(from, Side::After), carrier.plane(to, Side::Before));
        let middle = |part: f64| carrier.plane(from + (to - from) * part, Side::After);
        let point = |plane: &Plane, sample: usize| plane.point(self.places[sample].x, self.places[sample].y);
        self.bend((&start, &end), &[0.25, 0.5, 0.75].map(middle), point)
    }

    /// What the diagonals of cells leave out because the section changes its form between two places.
    fn warp(&self, from: &Stand, to: &Stand) -> f64 {
        let of = |(outline, column): &(usize, usize)| {
            let columns = &self.columns[*outline];
            let next = (column + 1).min(columns.len() - 1);
            let chord = |stand: &Stand| {
                let at = |column: usize| stand.point(&columns.at(column, Some(Side::After), &stand.mix));
                (at(*column), at(next))
            };
            let (one, other) = (chord(from), chord(to));
            let (here, there) = (one.1 - one.0, other.1 - other.0);
            let normal = (here + there).cross(other.0 + other.1 - one.0 - one.1).normalize_or_zero();
            normal.dot(there - here).abs() / 4.0
        };
        self.samples.iter().map(of).fold(0.0, f64::max)
    }
}

impl Curve for Traced<'_> {
    fn domain(&self) -> Domain {
        self.surface.carrier.domain()
    }

    fn is_closed(&self) -> bool {
        self.surface.carrier.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        self.surface.carrier.jet(t, side, self.reach)
    }

    fn joints(&self) -> Vec<f64> {
        self.surface.joints()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let (surface, carrier) = (self.surface, &self.surface.carrier);
        if !self.judged || surface.is_straight(from, to) {
            return 0.0;
        }
        // Samples of a chord over whole turns see nothing: such a chord is judged by the way's own bound, and by
        // how far the section turns on it.
        let mut deviation = carrier.bend(from, to, self.reach) / GUARD;
        if carrier.turn_between(from, to).abs() > GREATEST_TWIST {
            deviation = deviation.max(self.reach);
        }
        if surface.change.is_constant() {
            return deviation.max(self.plain_bend(from, to)) * MARGIN;
        }
        let (start, end) = (surface.stand(from, Side::After), surface.stand(to, Side::Before));
        let bend = surface.change.scale.bend(surface.share(from), surface.share(to));
        deviation = deviation.max(bend * self.reach / GUARD).max(self.warp(&start, &end));
        let middle = |part: f64| surface.stand(from + (to - from) * part, Side::After);
        let point = |stand: &Stand, sample: usize| self.point(stand, self.samples[sample]);
        deviation = deviation.max(self.bend((&start, &end), &[0.25, 0.5, 0.75].map(middle), point));
        deviation * MARGIN
    }
}

/// Directions that differ by more are a corner.
fn is_corner(before: DVec3, after: DVec3) -> bool {
    before.dot(after) < 1.0 - 1e-12
}

fn rows(surface: &SweptSurface, stations: &[Station], along: &[f64]) -> Vec<Row> {
    let last = stations.len() - 1;
    let whole = along[last].max(f64::MIN_POSITIVE);
    let joints = surface.joints();
    let row = |index: usize| {
        let v = stations[index].t;
        let after = surface.stand(v, if index == last { Side::Before } else { Side::After });
        let joint = index > 0 && index < last && joints.binary_search_by(|joint| joint.total_cmp(&v)).is_ok();
        let before = if joint { surface.stand(v, Side::Before) } else { after };
        let (one, other) = (before.plane.frame.along, after.plane.frame.along);
        let bisector = (one != other).then(|| one + other);
        let joint = joint && before != after;
        let plain = !joint && bisector.is_none() && !after.plane.leans && surface.change.is_constant();
        Row { v, before, after, joint, plain, bisector, along: along[index] / whole }
    };
    let mut rows: Vec<Row> = (0..=last).map(row).collect();
    if surface.carrier.is_closed() {
        let (first, end) = (rows[0].after.plane.frame.along, rows[last].after.plane.frame.along);
        let bisector = is_corner(first, end).then(|| first + end);
        for row in [0, last] {
            rows[row].bisector = bisector;
            rows[row].plain &= bisector.is_none();
        }
    }
    rows
}

/// Leaves out stations whose section would reach across the bisecting plane of a corner: there the mitre
/// already stands, and rows behind it would fold the surface.
fn clear_of_corners(surface: &SweptSurface, path: Vec<Station>, columns: &[Columns]) -> Vec<Station> {
    let closed = surface.carrier.is_closed();
    let ends = path.len() - 1;
    let corners: Vec<(usize, DVec3, DVec3)> = (0..path.len())
        .filter(|row| is_corner(path[*row].before, path[*row].after) && (closed || (*row > 0 && *row < ends)))
        .map(|row| (row, path[row].point, (path[row].before + path[row].after).normalize_or_zero()))
        .collect();
    if corners.is_empty() {
        return path;
    }
    let knots = surface.joints();
    let clear = |row: usize, station: &Station| {
        let near = |place: usize| corners.get(place).into_iter();
        let next = corners.partition_point(|(corner, ..)| *corner <= row);
        let stand = surface.stand(station.t, Side::After);
        if stand.plane.slope.is_some() {
            return true;
        }
        let places: Vec<DVec2> = columns.iter().flat_map(|columns| columns.places(&stand.mix)).collect();
        let reaches = |(_, origin, normal): &(usize, DVec3, DVec3), sign: f64| {
            let across =
                |place: &DVec2| (stand.plane.point(place.x, place.y) - *origin).dot(*normal) * sign <= 0.0;
            places.iter().any(across)
        };
        let before = near(next.wrapping_sub(1)).any(|corner| reaches(corner, 1.0));
        !before && !near(next).any(|corner| reaches(corner, -1.0))
    };
    let is_knot = |t: f64| knots.binary_search_by(|knot| knot.total_cmp(&t)).is_ok();
    let keep: Vec<bool> = (0..path.len())
        .map(|row| {
            let station = &path[row];
            row == 0
                || row == ends
                || is_corner(station.before, station.after)
                || is_knot(station.t)
                || clear(row, station)
        })
        .collect();
    path.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(station, _)| station).collect()
}

//! Outlines cut into columns.

use glam::DVec2;

use super::super::cap::twice_area;
use super::super::discretize::{Density, Station, arc_lengths, discretize};
use super::super::{Detail, SurfaceDensity, TessellateError};
use crate::geometry::curve::{Curve, Domain, Jet, Side};
use crate::geometry::surface::{Change, Mix, Outline, SectionPoint, Spot, SweptSurface};

/// One outline, cut: counter-clockwise where it is the outer one, clockwise where it is a hole.
pub(super) struct Columns {
    /// Parameters, increasing or decreasing.
    pub(super) u: Vec<f64>,
    /// For each column and profile, what it is before and after.
    spots: Vec<(Spot, Spot)>,
    profiles: usize,
    /// What stays the same along the way in a section that does not change.
    plain: Vec<Plain>,
    /// Share of the outline's length at each column.
    pub(super) along: Vec<f64>,
    pub(super) closed: bool,
    /// Bound on what the chords leave out of every profile, metres, before factors.
    pub(super) deviation: f64,
}

/// A column of a section that does not change.
pub(super) struct Plain {
    /// The point seen from before, from after, and across the mean of both directions.
    points: [SectionPoint; 3],
    /// Unit normals of these in the section's plane, to the right.
    normals: [DVec2; 3],
    /// Unit normal of the chord from the column before.
    pub(super) chord: DVec2,
    /// As [`Columns::is_edge`] tells.
    pub(super) edge: bool,
}

impl Plain {
    /// Where it is in the section's plane.
    pub(super) fn place(&self) -> DVec2 {
        self.points[1].place
    }

    /// The unit normal in the section's plane, from one side of a joint or between both.
    pub(super) fn normal(&self, side: Option<Side>) -> DVec2 {
        self.normals[seen(side)]
    }
}

fn seen(side: Option<Side>) -> usize {
    match side {
        Some(Side::Before) => 0,
        Some(Side::After) => 1,
        None => 2,
    }
}

impl Columns {
    pub(super) fn len(&self) -> usize {
        self.u.len()
    }

    /// The point of a column, seen from one side of its joint; without a side across the mean of both directions.
    pub(super) fn at(&self, column: usize, side: Option<Side>, mix: &Mix) -> SectionPoint {
        if let Some(plain) = self.plain.get(column) {
            return plain.points[seen(side)];
        }
        self.mixed(column, side, mix)
    }

    /// Keeps the points of a section that does not change.
    fn settle(&mut self, change: &Change) {
        if change.is_constant() {
            let mix = change.mix(0.0, Side::After);
            let sides = [Some(Side::Before), Some(Side::After), None];
            let right = |direction: DVec2| DVec2::new(direction.y, -direction.x).normalize_or_zero();
            let place = |column: usize| self.mixed(column, Some(Side::After), &mix).place;
            let of = |column: usize| {
                let points = sides.map(|side| self.mixed(column, side, &mix));
                Plain {
                    points,
                    normals: points.map(|point| right(point.across)),
                    chord: right(place(column) - place(column.saturating_sub(1))),
                    edge: self.is_edge(column),
                }
            };
            self.plain = (0..self.len()).map(of).collect();
        }
    }

    /// The columns of a section that does not change; of another one none.
    pub(super) fn plain(&self) -> &[Plain] {
        &self.plain
    }

    fn mixed(&self, column: usize, side: Option<Side>, mix: &Mix) -> SectionPoint {
        let first = column * self.profiles + mix.first;
        let spots = self.spots[first..first + mix.count].iter();
        match side {
            Some(Side::Before) => SectionPoint::new(spots.map(|(before, _)| *before), mix),
            Some(Side::After) => SectionPoint::new(spots.map(|(_, after)| *after), mix),
            None => SectionPoint::new(spots.map(|(before, after)| mean(before, after)), mix),
        }
    }

    /// Whether a direction jumps at a column, in any profile.
    pub(super) fn is_joint(&self, column: usize) -> bool {
        let spots = &self.spots[column * self.profiles..(column + 1) * self.profiles];
        spots.iter().any(|(before, after)| before.across != after.across)
    }

    /// Whether a column is a joint or an end of the outline.
    pub(super) fn is_edge(&self, column: usize) -> bool {
        self.is_joint(column) || (!self.closed && (column == 0 || column + 1 == self.len()))
    }

    /// Places in the section's plane under a mix; of a closed outline the end is left out.
    pub(super) fn places(&self, mix: &Mix) -> Vec<DVec2> {
        let used = self.len() - usize::from(self.closed);
        (0..used).map(|column| self.at(column, Some(Side::After), mix).place).collect()
    }

    fn of_profile(&self, profile: usize) -> Vec<DVec2> {
        let used = self.len() - usize::from(self.closed);
        (0..used).map(|column| self.spots[column * self.profiles + profile].1.point).collect()
    }

    fn reverse(&mut self) {
        self.u.reverse();
        self.along = self.along.iter().rev().map(|part| 1.0 - part).collect();
        let back = |spot: &Spot| Spot { across: -spot.across, ..*spot };
        let columns = self.spots.chunks(self.profiles).rev();
        self.spots = columns.flatten().map(|(before, after)| (back(after), back(before))).collect();
    }
}

fn mean(before: &Spot, after: &Spot) -> Spot {
    if before.across == after.across {
        return *after;
    }
    let across = before.across.normalize_or_zero() + after.across.normalize_or_zero();
    let across = if across.length_squared() > 1e-20 { across * after.across.length() } else { after.across };
    Spot { across, ..*after }
}

/// Cuts all outlines of a surface.
pub(super) fn cut(
    surface: &SweptSurface,
    islands: &[usize],
    detail: &Detail,
    aim: f64,
) -> Result<Vec<Columns>, TessellateError> {
    let view = View {
        turn: surface.carrier.greatest_turn_rate(),
        size: surface.change.greatest_weight() * surface.change.scale.greatest().max_element(),
        gap: shortest_gap(surface),
    };
    let mut all = Vec::new();
    let mut needed = 0;
    let holes = islands.iter().flat_map(|count| (0..*count).map(|index| index > 0));
    for (outline, hole) in surface.outlines.iter().zip(holes) {
        let mut columns = cut_one(outline, hole, &view, (detail, aim))?;
        columns.settle(&surface.change);
        needed += 2 * (columns.len() as u64 - 1);
        detail.allow(needed)?;
        all.push(columns);
    }
    Ok(all)
}

/// The shortest way from one profile to the next, metres.
fn shortest_gap(surface: &SweptSurface) -> f64 {
    let length = surface.carrier.length(surface.reach());
    let gaps = surface.change.stations().windows(2).map(|pair| (pair[1] - pair[0]) * length);
    gaps.fold(f64::INFINITY, f64::min)
}

/// What the cutting of a section must know of its way.
struct View {
    /// Greatest turn for each metre, radians.
    turn: f64,
    /// Greatest factor of size.
    size: f64,
    /// Shortest way between two profiles, metres.
    gap: f64,
}

fn cut_one(
    outline: &Outline,
    hole: bool,
    view: &View,
    (detail, aim): (&Detail, f64),
) -> Result<Columns, TessellateError> {
    let density = match detail.density {
        SurfaceDensity::Tolerance(_) => Density::Tolerance(aim),
        SurfaceDensity::Grid { u, .. } => Density::Count(u),
    };
    let seen = Seen { outline, view };
    let stations = discretize(&seen, density, detail.triangle_limit)?;
    let along = if detail.uv { shares(&arc_lengths(&seen, &stations)) } else { vec![0.0; stations.len()] };
    let mut columns = gather(outline, &stations, along);
    if columns.closed {
        if stations.len() < 4 {
            return Err(TessellateError::NoArea);
        }
        let areas: Vec<f64> = (0..columns.profiles).map(|k| twice_area(&columns.of_profile(k))).collect();
        if areas.contains(&0.0) {
            return Err(TessellateError::NoArea);
        }
        if (areas[0] < 0.0) != hole {
            columns.reverse();
        }
    }
    Ok(columns)
}

fn shares(lengths: &[f64]) -> Vec<f64> {
    let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
    lengths.iter().map(|length| length / whole).collect()
}

fn gather(outline: &Outline, stations: &[Station], along: Vec<f64>) -> Columns {
    let last = stations.len() - 1;
    let closed = outline.is_closed();
    let mut spots = Vec::with_capacity(stations.len() * outline.profiles());
    for (index, station) in stations.iter().enumerate() {
        let smooth = station.before == station.after && outline.profiles() == 1;
        let t = |end: usize| stations[end].t;
        let (before, after) = match (index, closed) {
            (0, true) => (t(last), t(0)),
            (k, true) if k == last => (t(last), t(0)),
            _ => (station.t, station.t),
        };
        let seen_before = if index == 0 && !closed { Side::After } else { Side::Before };
        let seen_after = if index == last && !closed { Side::Before } else { Side::After };
        let pairs = outline.spots(before, seen_before).zip(outline.spots(after, seen_after));
        spots.extend(pairs.map(|(before, after)| {
            // The seam of a closed curve is one point; smooth joints have one direction.
            let before = Spot { point: after.point, ..before };
            (if smooth { after } else { settled(before, after) }, after)
        }));
    }
    let deviation =
        stations.windows(2).map(|pair| outline.chord_deviation(pair[0].t, pair[1].t)).fold(0.0, f64::max);
    let u = stations.iter().map(|station| station.t).collect();
    Columns { u, spots, profiles: outline.profiles(), plain: Vec::new(), along, closed, deviation }
}

/// Directions that agree but for rounding and length are one.
fn settled(before: Spot, after: Spot) -> Spot {
    let (one, other) = (before.across.normalize_or_zero(), after.across.normalize_or_zero());
    if one.distance(other) < 1e-9 { after } else { before }
}

/// An outline as the tolerance sees it.
///
/// Where the section turns or changes its form, straight sides of it become saddles: a cell of width a and
/// length h at rate w leaves out w a h / 4 at its diagonal, whatever its proportions. Sides are cut so that
/// cells come out about square. Long thin cells would be as near to the surface, but tilt against it by an angle
/// that no tolerance lessens.
struct Seen<'a> {
    outline: &'a Outline,
    view: &'a View,
}

impl Seen<'_> {
    /// How fast the chord between two parameters leaves its direction, for each metre of the way.
    fn warp(&self, from: f64, to: f64, width: f64) -> f64 {
        let mut warp = self.view.turn * width;
        if self.outline.profiles() > 1 {
            let chord = |(one, other): (Spot, Spot)| other.point - one.point;
            let spots = self.outline.spots(from, Side::After).zip(self.outline.spots(to, Side::Before));
            let chords: Vec<DVec2> = spots.map(chord).collect();
            for pair in chords.windows(2) {
                let direction = (pair[0] + pair[1]).normalize_or_zero();
                warp = warp.max(direction.perp_dot(pair[1] - pair[0]).abs() / self.view.gap);
            }
        }
        warp
    }

    /// Whether any profile turns by more than a right angle between two parameters.
    fn turns_back(&self, from: f64, to: f64) -> bool {
        let spots = self.outline.spots(from, Side::After).zip(self.outline.spots(to, Side::Before));
        spots.skip(1).any(|(one, other)| one.across.dot(other.across) < -1e-12 * one.across.length_squared())
    }
}

impl Curve for Seen<'_> {
    fn domain(&self) -> Domain {
        self.outline.domain()
    }

    fn is_closed(&self) -> bool {
        self.outline.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        self.outline.first_jet(t, side)
    }

    fn joints(&self) -> Vec<f64> {
        self.outline.joints()
    }

    fn breaks(&self) -> Vec<f64> {
        self.outline.joints()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        if self.outline.profiles() > 1 && self.turns_back(from, to) {
            return f64::INFINITY;
        }
        let bend = self.outline.chord_deviation(from, to) * self.view.size;
        if self.view.turn == 0.0 && self.outline.profiles() == 1 {
            return bend;
        }
        let ends = (self.evaluate(from, Side::After).point, self.evaluate(to, Side::Before).point);
        let width = ends.0.distance(ends.1) * self.view.size;
        bend.max(self.warp(from, to, width) * width / 4.0)
    }
}

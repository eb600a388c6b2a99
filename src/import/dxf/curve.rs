//! Lines, arcs and splines of drawings, and how they join.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec2, DVec3};

use super::entity::Kind;
use super::{Drawing, Note};
use crate::geometry::number::{atan, cos_degrees, sin_degrees};

/// A curve of pieces end to end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// The pieces, each with whether it is run through backwards; at least one.
    pub pieces: Vec<(Piece, bool)>,
    /// Whether its end is its start.
    pub closed: bool,
}

/// A piece of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// A straight line.
    Line(DVec3, DVec3),
    /// `center + x cos t + y sin t` between two angles in degrees.
    Arc {
        /// Its center.
        center: DVec3,
        /// Half diameter at 0 degrees.
        x: DVec3,
        /// Half diameter at 90 degrees.
        y: DVec3,
        /// First and last angle, degrees, not equal; arcs of 360 degrees are whole.
        angles: DVec2,
    },
    /// A B-spline; weights of control points are 1 where there are none.
    Spline {
        /// Its degree, 1 to 25.
        degree: usize,
        /// Its knots, which never fall: as many as points, and one more than the degree.
        knots: Vec<f64>,
        /// Control points.
        points: Vec<DVec3>,
        /// Weights, above 0.
        weights: Vec<f64>,
    },
    /// A smooth curve through points, at least two.
    Through(Vec<DVec3>),
}

impl Piece {
    /// Where it begins and ends, as far as that is known without its spline: those begin at their first point only where
    /// knots are repeated there.
    fn ends(&self) -> [DVec3; 2] {
        match self {
            Self::Line(from, to) => [*from, *to],
            Self::Arc { center, x, y, angles } => {
                let place = |angle: f64| *center + *x * cos_degrees(angle) + *y * sin_degrees(angle);
                [place(angles.x), place(angles.y)]
            }
            Self::Spline { points, .. } | Self::Through(points) => [points[0], points[points.len() - 1]],
        }
    }

    /// Whether it is closed by itself.
    fn is_whole(&self) -> bool {
        let [from, to] = self.ends();
        match self {
            Self::Arc { angles, .. } => (angles.y - angles.x).abs() >= 360.0,
            _ => from == to,
        }
    }

    /// The same under a map.
    pub(super) fn mapped(&self, map: &DAffine3) -> Self {
        let point = |point: &DVec3| map.transform_point3(*point);
        let all = |points: &[DVec3]| points.iter().map(point).collect();
        match self {
            Self::Line(from, to) => Self::Line(point(from), point(to)),
            Self::Arc { center, x, y, angles } => Self::Arc {
                center: point(center),
                x: map.transform_vector3(*x),
                y: map.transform_vector3(*y),
                angles: *angles,
            },
            Self::Spline { degree, knots, points, weights } => Self::Spline {
                degree: *degree,
                knots: knots.clone(),
                points: all(points),
                weights: weights.clone(),
            },
            Self::Through(points) => Self::Through(all(points)),
        }
    }

    /// How many points it has.
    pub(super) fn size(&self) -> u64 {
        match self {
            Self::Line(..) | Self::Arc { .. } => 2,
            Self::Spline { points, .. } | Self::Through(points) => points.len() as u64,
        }
    }
}

/// Lines and arcs between places of a plane, each with the tangent of a quarter of its arc's angle.
pub(super) fn bulged(places: &[(DVec2, f64)], closed: bool) -> Vec<Piece> {
    let count = if closed { places.len() } else { places.len().saturating_sub(1) };
    let piece = |k: usize| {
        let ((from, bulge), (to, _)) = (places[k], places[(k + 1) % places.len()]);
        if from == to {
            return None;
        }
        if bulge == 0.0 {
            return Some(Piece::Line(from.extend(0.0), to.extend(0.0)));
        }
        let chord = to - from;
        let center = (from + to) / 2.0 + chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
        let x = from - center;
        let angles = DVec2::new(0.0, 4.0 * atan(bulge).to_degrees());
        let (center, x, y) = (center.extend(0.0), x.extend(0.0), x.perp().extend(0.0));
        Some(Piece::Arc { center, x, y, angles })
    };
    (0..count).filter_map(piece).collect()
}

impl Drawing {
    /// The curves of the drawing, or of one of its layers, and what is left out. Where `join` is above 0, curves whose
    /// ends are within it of each other are joined; where more than two meet, in the order of the file. O(n log n).
    #[must_use]
    pub fn curves(&self, layer: Option<&str>, join: f64) -> (Vec<Drawn>, Vec<Note>) {
        let (mut curves, mut faces) = (Vec::new(), 0);
        for item in self.items.iter().filter(|item| layer.is_none_or(|layer| item.layer == layer)) {
            match &item.kind {
                Kind::Curve { pieces, closed } => {
                    let pieces = pieces.iter().cloned().map(|piece| (piece, false)).collect();
                    curves.push(Drawn { pieces, closed: *closed });
                }
                Kind::Faces { .. } => faces += 1,
            }
        }
        let mut notes = Vec::new();
        let mut tell = |message: String| notes.push(Note { line: None, message });
        if faces > 0 {
            tell(format!("{faces} faces and meshes are left out; `[shape.NAME.import]` reads them"));
        }
        for (name, count) in &self.others {
            tell(format!("{count} entities {name} are left out"));
        }
        (if join > 0.0 { joined(curves, join) } else { curves }, notes)
    }
}

impl Drawn {
    fn ends(&self) -> [DVec3; 2] {
        let end = |(piece, back): &(Piece, bool), at: usize| piece.ends()[at ^ usize::from(*back)];
        [end(&self.pieces[0], 0), end(&self.pieces[self.pieces.len() - 1], 1)]
    }

    fn is_closed(&self) -> bool {
        self.closed || (self.pieces.len() == 1 && self.pieces[0].0.is_whole())
    }

    fn reversed(self) -> Self {
        let pieces = self.pieces.into_iter().rev().map(|(piece, back)| (piece, !back)).collect();
        Self { pieces, closed: self.closed }
    }
}

/// Curves joined where their ends meet.
fn joined(curves: Vec<Drawn>, join: f64) -> Vec<Drawn> {
    let ends: Vec<[DVec3; 2]> = curves.iter().map(Drawn::ends).collect();
    let cell = |place: DVec3| (place / join).to_array().map(floor_cell);
    // In each cell the ends in it, the first of the file last.
    let mut cells: BTreeMap<[i64; 3], Vec<(usize, usize)>> = BTreeMap::new();
    for at in (0..curves.len()).rev().filter(|at| !curves[*at].is_closed()) {
        for end in [1, 0] {
            cells.entry(cell(ends[at][end])).or_default().push((at, end));
        }
    }
    let mut left: Vec<Option<Drawn>> = curves.into_iter().map(Some).collect();
    // The first curve of the file that has an end at a place.
    let mut meets = |place: DVec3, left: &[Option<Drawn>]| {
        let [x, y, z] = cell(place);
        let around = |middle: i64| middle.saturating_sub(1)..=middle.saturating_add(1);
        let near = around(x).flat_map(|x| around(y).flat_map(move |y| around(z).map(move |z| [x, y, z])));
        let mut found: Option<(usize, usize)> = None;
        for key in near {
            let Some(own) = cells.get_mut(&key) else { continue };
            while own.last().is_some_and(|(at, _)| left[*at].is_none()) {
                own.pop();
            }
            let good =
                |(at, end): &&(usize, usize)| left[*at].is_some() && ends[*at][*end].distance(place) <= join;
            let first = own.iter().rev().find(good).copied();
            found = found.into_iter().chain(first).min();
        }
        found
    };
    let mut made = Vec::new();
    for start in 0..left.len() {
        let Some(mut whole) = left[start].take() else { continue };
        // Onward from its end, then onward from its start.
        for _ in 0..2 {
            while !whole.is_closed() {
                let [from, to] = whole.ends();
                if whole.pieces.len() > 1 && from.distance(to) <= join {
                    whole.closed = true;
                    break;
                }
                let Some((at, end)) = meets(to, &left) else { break };
                let Some(next) = left[at].take() else { break };
                whole.pieces.extend(if end == 0 { next } else { next.reversed() }.pieces);
            }
            whole = if whole.is_closed() { whole } else { whole.reversed() };
        }
        made.push(whole);
    }
    made
}

/// The whole number below a coordinate in cells, as far as there are so many.
#[expect(clippy::cast_possible_truncation, reason = "saturates: such cells are all one")]
fn floor_cell(coordinate: f64) -> i64 {
    coordinate.floor() as i64
}

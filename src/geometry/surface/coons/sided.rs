//! Coons patches with four sides, three, two, one or none.
//!
//! A patch is the unit square of u and v: the bottom (v = 0) and the top (v = 1) run with u, the left (u = 0) and
//! the right (u = 1) with v. A side that is missing is a point. Sources: S. A. Coons, Surfaces for computer-aided
//! design of space forms, 1967; J. Ferguson, Multivariable curve interpolation, J. ACM 11 (1964); A. Adini's twist as
//! in R. Barnhill, J. Brown, I. Klucewicz, A new twist in computer aided geometric design, CGIP 8 (1978); G. Farin,
//! Curves and Surfaces for CAGD, 5th ed. 2002, ch. 22.

use glam::{DAffine3, DMat3, DVec3};
use thiserror::Error;

use super::blends::Blends;
use super::rail::Rail;
use super::ring::{Gap, cut, reversed, ring};
use super::three::ThreeSidedSurface;
use super::transfinite::TransfiniteSurface;
use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::surface::AnySurface;

/// A side of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct CoonsSide {
    /// The side; it may run either way.
    pub curve: AnyCurve,
    /// For each place of the curve (the same share of its own domain) the derivative into the patch.
    pub cross: Option<AnyCurve>,
}

/// How the inside follows from the sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoonsBlend {
    /// Linear blending functions: the sides alone matter.
    Bilinear,
    /// Cubic ones: derivatives across the sides and twists at the corners matter too.
    Bicubic,
}

/// Mixed derivatives at the corners, where no derivatives across the sides determine them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Twist {
    /// None: flat at the corners.
    Zero,
    /// Of the bilinear surface through the corners.
    Bilinear,
    /// Of the bilinear Coons patch through the sides.
    Adini,
    /// Given, in the order of the corners: where the first side starts, where it ends, and on around.
    Given([DVec3; 4]),
}

/// What a patch is made from.
#[derive(Clone, Debug, PartialEq)]
pub enum CoonsSides {
    /// One to four sides around the patch, in order, each meeting the next; one alone is a closed curve.
    Around(Vec<CoonsSide>),
    /// Two sides that stay apart: lines lead from each place of the first to that of the second.
    Apart(Box<[CoonsSide; 2]>),
    /// No side at all: a point from which the surface goes out and comes back, by the twists.
    Point(DVec3),
}

/// Why sides make no patch.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CoonsError {
    /// Sides do not meet.
    #[error(transparent)]
    Gap(#[from] Gap),
    /// One side alone is open.
    #[error("one side alone must be a closed curve; its ends are {0} apart")]
    Open(f64),
    /// The derivative across a side is not the tangent of the side beside it.
    #[error(
        "at its {end} the derivative across side {side} is {found}, but the side that leaves there has the tangent {expected}"
    )]
    Cross {
        /// Index of the side.
        side: usize,
        /// `start` or `end` of the side as it is written.
        end: &'static str,
        /// The derivative.
        found: DVec3,
        /// The tangent.
        expected: DVec3,
    },
    /// A given twist is not the one of a derivative across a side.
    #[error(
        "the twist at corner {corner} is given as {given}, but the derivative across a side makes it {found}"
    )]
    Twist {
        /// Index of the corner.
        corner: usize,
        /// As given.
        given: DVec3,
        /// As the derivative has it.
        found: DVec3,
    },
}

/// Derivatives nearer to each other than this share of their size are the same: they are given to six or more digits.
const SAME_DERIVATIVE: f64 = 1e-6;

/// The patch of its sides.
///
/// # Errors
/// Where sides do not meet, and where derivatives contradict each other.
pub fn coons(sides: CoonsSides, blend: CoonsBlend, twist: Twist) -> Result<AnySurface, CoonsError> {
    let sides = match sides {
        CoonsSides::Point(point) => return Ok(transfinite(bubble(point, twist))),
        CoonsSides::Apart(sides) => return Ok(transfinite(strip(&sides, blend))),
        CoonsSides::Around(sides) => sides,
    };
    if let [side] = sides.as_slice() {
        let pieces = single(&side.curve)?;
        return patch(pieces.into_iter().map(|rail| (rail, None)).collect(), blend, twist);
    }
    let curves: Vec<AnyCurve> = sides.iter().map(|side| side.curve.clone()).collect();
    let rails = ring(curves)?.into_iter().zip(&sides).map(|(curve, side)| {
        let turned = curve != side.curve;
        let cross = side.cross.clone().map(|cross| if turned { reversed(cross) } else { cross });
        (Rail::new(curve), cross.map(Rail::new))
    });
    patch(rails.collect(), blend, twist)
}

fn transfinite(surface: TransfiniteSurface) -> AnySurface {
    AnySurface::Transfinite(Box::new(surface))
}

fn single(curve: &AnyCurve) -> Result<Vec<Rail>, CoonsError> {
    if curve.is_closed() {
        return Ok(cut(curve));
    }
    let domain = curve.domain();
    let gap = curve.point(domain.start).distance(curve.evaluate(domain.end, Side::Before).point);
    Err(CoonsError::Open(gap))
}

/// A patch of sides that run head to tail, each with the derivative into the patch.
fn patch(
    sides: Vec<(Rail, Option<Rail>)>,
    blend: CoonsBlend,
    twist: Twist,
) -> Result<AnySurface, CoonsError> {
    if let ([(a, _), (b, _), (c, _)], CoonsBlend::Bilinear) = (sides.as_slice(), blend) {
        // A corner inside a side would become a crease along no parameter line; the other construction keeps it.
        let sides = [a, b, c];
        if sides.iter().all(|side| side.joints().is_empty()) {
            return Ok(AnySurface::ThreeSided(Box::new(ThreeSidedSurface::new(sides.map(Rail::clone)))));
        }
    }
    let square = Square::new(sides);
    Ok(transfinite(match blend {
        CoonsBlend::Bilinear => square.bilinear(),
        CoonsBlend::Bicubic => square.bicubic(twist)?,
    }))
}

/// A side of the unit square, run with u or v; a point where there is no curve.
#[derive(Clone, Debug)]
struct Edge {
    rail: Option<Rail>,
    /// Derivative by v of the bottom and the top, by u of the left and the right.
    cross: Option<Rail>,
    ends: [DVec3; 2],
    /// Index among the sides as they are written, and whether it runs against that.
    written: (usize, bool),
}

/// Four sides: bottom, right, top, left.
struct Square([Edge; 4]);

const BOTTOM: usize = 0;
const RIGHT: usize = 1;
const TOP: usize = 2;
const LEFT: usize = 3;

impl Edge {
    fn point(point: DVec3) -> Self {
        Self { rail: None, cross: None, ends: [point; 2], written: (0, false) }
    }

    /// A side of the ring; the top and the left run against it, and at the right and the top the derivative by
    /// the parameter goes out of the patch.
    fn new((rail, cross): (Rail, Option<Rail>), index: usize, place: usize) -> Self {
        let (backward, outward) = (place >= TOP, place == RIGHT || place == TOP);
        let rail = if backward { rail.backward() } else { rail };
        let cross = cross.map(|cross| if backward { cross.backward() } else { cross });
        let cross = cross.map(|cross| if outward { cross.mapped(&negative()) } else { cross });
        let ends = [rail.point(0.0), rail.point(1.0)];
        Self { rail: Some(rail), cross, ends, written: (index, backward) }
    }

    /// Derivative along the side at its start (0) or end (1).
    fn tangent(&self, end: usize) -> DVec3 {
        self.rail.as_ref().map_or(DVec3::ZERO, |rail| at_end(rail, end).first)
    }
}

fn at_end(rail: &Rail, end: usize) -> crate::geometry::curve::Jet {
    if end == 0 { rail.evaluate(0.0, Side::After) } else { rail.evaluate(1.0, Side::Before) }
}

fn negative() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_diagonal(DVec3::NEG_ONE))
}

impl Square {
    fn new(sides: Vec<(Rail, Option<Rail>)>) -> Self {
        // Where two sides make a patch they are its bottom and its top.
        let places: &[usize] = if sides.len() == 2 { &[BOTTOM, TOP] } else { &[BOTTOM, RIGHT, TOP, LEFT] };
        let skipped = (sides.len() == 3).then_some(TOP);
        let places = places.iter().copied().filter(|place| Some(*place) != skipped);
        let mut edges: [Option<Edge>; 4] = [None, None, None, None];
        for ((index, side), place) in sides.into_iter().enumerate().zip(places) {
            edges[place] = Some(Edge::new(side, index, place));
        }
        // A missing top is the end of the right side, missing left and right sides are ends of the bottom.
        let end = |edge: &Option<Edge>, end: usize| edge.as_ref().map_or(DVec3::ZERO, |edge| edge.ends[end]);
        let missing = [DVec3::ZERO, end(&edges[BOTTOM], 1), end(&edges[RIGHT], 1), end(&edges[BOTTOM], 0)];
        let mut place = 0;
        Self(edges.map(|edge| {
            let edge = edge.unwrap_or_else(|| Edge::point(missing[place]));
            place += 1;
            edge
        }))
    }

    /// A corner by its u and v.
    fn corner(&self, u: usize, v: usize) -> DVec3 {
        let edge = if v == 0 { &self.0[BOTTOM] } else { &self.0[TOP] };
        edge.ends[u]
    }

    fn rails(&self) -> [Vec<Option<Rail>>; 2] {
        let rail = |place: usize| self.0[place].rail.clone();
        [vec![rail(BOTTOM), rail(TOP)], vec![rail(LEFT), rail(RIGHT)]]
    }

    fn bilinear(&self) -> TransfiniteSurface {
        let net = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(u, v)| self.corner(u, v)).to_vec();
        let [along_u, along_v] = self.rails();
        TransfiniteSurface::new((Blends::linear(), Blends::linear()), net, along_u, along_v)
    }

    /// Derivative by u of the bottom or top at u = 0 or 1.
    fn du(&self, u: usize, v: usize) -> DVec3 {
        self.0[if v == 0 { BOTTOM } else { TOP }].tangent(u)
    }

    /// Derivative by v of the left or right side at v = 0 or 1.
    fn dv(&self, u: usize, v: usize) -> DVec3 {
        self.0[if u == 0 { LEFT } else { RIGHT }].tangent(v)
    }

    /// The twist at a corner where no derivative across a side makes it.
    fn free_twist(&self, (u, v): (usize, usize), rule: Twist) -> DVec3 {
        let corners = self.corner(0, 0) - self.corner(1, 0) - self.corner(0, 1) + self.corner(1, 1);
        match rule {
            Twist::Zero => DVec3::ZERO,
            Twist::Bilinear => corners,
            Twist::Adini => (self.du(u, 1) - self.du(u, 0)) + (self.dv(1, v) - self.dv(0, v)) - corners,
            Twist::Given(twists) => twists[around(u, v)],
        }
    }

    /// The mean twist at a corner, and half the difference of the two that derivatives across sides make.
    fn twist(&self, (u, v): (usize, usize), rule: Twist) -> Result<(DVec3, DVec3), CoonsError> {
        let of =
            |place: usize, end: usize| self.0[place].cross.as_ref().map(|cross| at_end(cross, end).first);
        let by_u = of(if v == 0 { BOTTOM } else { TOP }, u);
        let by_v = of(if u == 0 { LEFT } else { RIGHT }, v);
        if let Twist::Given(given) = rule {
            let given = given[around(u, v)];
            let other = [by_u, by_v].into_iter().flatten().find(|found| !same(given, *found));
            if let Some(found) = other {
                return Err(CoonsError::Twist { corner: around(u, v), given, found });
            }
        }
        Ok(match (by_u, by_v) {
            (Some(a), Some(b)) => ((a + b) / 2.0, (b - a) / 2.0),
            (Some(twist), None) | (None, Some(twist)) => (twist, DVec3::ZERO),
            (None, None) => (self.free_twist((u, v), rule), DVec3::ZERO),
        })
    }

    fn bicubic(&self, rule: Twist) -> Result<TransfiniteSurface, CoonsError> {
        self.check_cross()?;
        let mut net = vec![DVec3::ZERO; 16];
        let mut disagreements = [DVec3::ZERO; 4];
        for (u, v) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (twist, half) = self.twist((u, v), rule)?;
            net[4 * u + v] = self.corner(u, v);
            net[4 * (2 + u) + v] = self.du(u, v);
            net[4 * u + 2 + v] = self.dv(u, v);
            net[4 * (2 + u) + 2 + v] = twist;
            disagreements[u + 2 * v] = half;
        }
        let [mut along_u, mut along_v] = self.rails();
        let cross = |place: usize| self.0[place].cross.clone();
        along_u.extend([cross(BOTTOM), cross(TOP)]);
        along_v.extend([cross(LEFT), cross(RIGHT)]);
        let surface = TransfiniteSurface::new((Blends::hermite(), Blends::hermite()), net, along_u, along_v);
        Ok(surface.with_disagreements(disagreements))
    }

    /// Where a derivative across a side begins and ends it is the tangent of the side there.
    fn check_cross(&self) -> Result<(), CoonsError> {
        for (place, edge) in self.0.iter().enumerate() {
            let Some(cross) = &edge.cross else { continue };
            for end in [0, 1] {
                let found = at_end(cross, end).point;
                let expected = match place {
                    BOTTOM => self.dv(end, 0),
                    TOP => self.dv(end, 1),
                    LEFT => self.du(0, end),
                    _ => self.du(1, end),
                };
                if !same(found, expected) {
                    let (side, backward) = edge.written;
                    let inward = if place == RIGHT || place == TOP { -1.0 } else { 1.0 };
                    let end = if (end == 0) == backward { "end" } else { "start" };
                    let (found, expected) = (found * inward, expected * inward);
                    return Err(CoonsError::Cross { side, end, found, expected });
                }
            }
        }
        Ok(())
    }
}

/// The index of a corner in the order around the patch.
fn around(u: usize, v: usize) -> usize {
    match (u, v) {
        (0, 0) => 0,
        (1, 0) => 1,
        (1, 1) => 2,
        _ => 3,
    }
}

fn same(a: DVec3, b: DVec3) -> bool {
    a.distance(b) <= SAME_DERIVATIVE * a.length().max(b.length()).max(f64::MIN_POSITIVE)
}

/// A transition between two curves: straight or cubic lines from each place of one to that of the other.
fn strip(sides: &[CoonsSide; 2], blend: CoonsBlend) -> TransfiniteSurface {
    let rails = [0, 1].map(|k| Rail::new(sides[k].curve.clone()));
    let corner = |u: usize, v: usize| rails[v].point(u as f64);
    let none = vec![None; 2];
    if blend == CoonsBlend::Bilinear {
        let net = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(u, v)| corner(u, v)).to_vec();
        let blends = (Blends::linear(), Blends::linear());
        return TransfiniteSurface::new(blends, net, rails.map(Some).to_vec(), none);
    }
    let cross = [0, 1].map(|k| {
        let inward = sides[k].cross.clone().map(Rail::new);
        inward.map(|cross| if k == 1 { cross.mapped(&negative()) } else { cross })
    });
    let mut net = vec![DVec3::ZERO; 16];
    for (u, v) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let across = cross[v].as_ref().map(|cross| at_end(cross, u));
        let straight = [corner(u, 1) - corner(u, 0), at_end(&rails[1], u).first - at_end(&rails[0], u).first];
        net[4 * u + v] = corner(u, v);
        net[4 * (2 + u) + v] = at_end(&rails[v], u).first;
        net[4 * u + 2 + v] = across.map_or(straight[0], |jet| jet.point);
        net[4 * (2 + u) + 2 + v] = across.map_or(straight[1], |jet| jet.first);
    }
    let along_u = rails.into_iter().map(Some).chain(cross).collect();
    let blends = (Blends::hermite(), Blends::hermite());
    TransfiniteSurface::new(blends, net, along_u, vec![None; 4])
}

/// A patch whose four sides are one point: out by the twists and back.
fn bubble(point: DVec3, twist: Twist) -> TransfiniteSurface {
    let mut net = vec![DVec3::ZERO; 16];
    for (u, v) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        net[4 * u + v] = point;
        net[4 * (2 + u) + 2 + v] = match twist {
            Twist::Given(twists) => twists[around(u, v)],
            _ => DVec3::ZERO,
        };
    }
    TransfiniteSurface::new((Blends::hermite(), Blends::hermite()), net, vec![None; 4], vec![None; 4])
}

//! Perturbed patches: polygons, flat or on a ball, with bumps, joined along their sides into a skin.
//!
//! Promise: every vertex lies on the surface F' = 0 of its face to rounding; sides that two faces share are cut once, so a
//! closed net gives a closed skin; the bound is proved. A skin is made of one point for each ray (along the normal of a
//! face, or from a center): that there is just one is proved by intervals before anything is cut ([`unique`]). Where there
//! are more, the body of all points below is made by its field ([`solid`]), where one is known. Not promised: that skins of
//! separate faces keep clear of each other.
//!
//! About a center all faces have one F on the walls between them, so bumps may lie over several. Faces that look along
//! their own normals have that only where they lie in one plane: other sides must stay free of bumps.
//!
//! Source: S. Vyatkin, Complex surface modeling using perturbation functions, Optoelectronics, Instrumentation and Data
//! Processing 43 (2007): patches of planes and quadrics, cut off by planes, with perturbations.

mod judge;
mod mesh;
mod net;
mod rays;
mod rims;
mod solid;
#[cfg(test)]
mod tests;
mod thin;
mod unique;

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use super::field::{FieldSurface, field_surface};
use super::region::{Cut, Fault, Line as _, NO_LINE, Outline, Place, Wanted, fill, stations as chords};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::field::{Relief, ReliefBump};
use crate::geometry::mesh::index;
use crate::geometry::number::Bounds;
use crate::geometry::planar::{distance_to_segment, encloses};
use judge::{FaceChart, Rim};
pub use net::{NoSolid, SkinFault};
use rays::Rays;

/// What is written of a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct PerturbedNet {
    /// Corners of faces.
    pub points: Vec<DVec3>,
    /// For each face its corners, counterclockwise seen from outside.
    pub faces: Vec<Vec<u32>>,
    /// What the faces are without bumps.
    pub base: NetBase,
    /// The bumps.
    pub bumps: Vec<NetBump>,
    /// How far the surface may go from the faces, to both sides; none: as far as bumps that end go, and half of the size of
    /// the net where one does not end.
    pub reach: Option<f64>,
    /// How far a solid goes below a single face, where one is needed; none: further than the surface may go.
    pub depth: Option<f64>,
}

/// What faces are without bumps, and where their rays go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NetBase {
    /// Flat, rays along the normals.
    Flat,
    /// Flat, rays from a center.
    FlatAround(DVec3),
    /// Parts of a ball with this center.
    Ball(DVec3),
}

/// A bump and the faces that it is for: all, where none are named.
#[derive(Clone, Debug, PartialEq)]
pub struct NetBump {
    /// The bump.
    pub bump: ReliefBump,
    /// Indices of faces, increasing.
    pub faces: Option<Vec<u32>>,
}

/// A skin that is known to be sound.
#[derive(Clone, Debug, PartialEq)]
pub struct PerturbedSkin {
    points: Vec<DVec3>,
    faces: Vec<PerturbedFace>,
    /// Sides by their points, the lesser first: the faces at them.
    sides: BTreeMap<[u32; 2], Vec<u32>>,
    /// The body of its field where a ray meets it more than once.
    solid: Option<Box<FieldSurface>>,
}

/// A face with its rays and its equation.
#[derive(Clone, Debug, PartialEq)]
struct PerturbedFace {
    corners: Vec<u32>,
    /// The corners in coordinates of the rays.
    outline: Vec<DVec2>,
    rays: Rays,
    relief: Relief,
    /// Which bumps of the net it has.
    bumps: Vec<usize>,
    /// Numbers of rays between which the surface lies.
    reach: (f64, f64),
    /// The ball that it is a part of: how long rays are there.
    radius: Option<f64>,
}

/// The share of the tolerance that sides may use: triangles beside them need some for themselves.
const SIDES: f64 = 0.9;
/// Times that sides are cut finer, where triangles beside them were not near enough.
const TRIES: u32 = 7;

impl PerturbedFace {
    /// Where a ray meets the face without bumps.
    fn rest(&self, at: DVec2) -> f64 {
        match self.radius {
            Some(radius) => radius / self.rays.direction(at).length(),
            None if self.rays.is_central() => 1.0,
            None => 0.0,
        }
    }

    /// The point of the surface on a ray, to rounding; `None` where F' does not change its sign.
    fn root(&self, at: DVec2) -> Option<DVec3> {
        let direction = self.rays.direction(at);
        let (mut low, mut high) = self.reach;
        let value = |number: f64| {
            let (value, gradient) = self.relief.value_gradient(self.rays.point(at, number));
            (value, gradient.dot(direction))
        };
        if value(low).0 >= 0.0 || value(high).0 <= 0.0 {
            return None;
        }
        let enough = 1e-16 * (high - low);
        let mut number = self.rest(at).clamp(low, high);
        // Newton's steps as long as they stay between the ends, halving otherwise: each of these takes at least one bit.
        for _ in 0..200 {
            let (found, slope) = value(number);
            if found == 0.0 {
                break;
            }
            *(if found < 0.0 { &mut low } else { &mut high }) = number;
            let step = number - found / slope;
            let next = if step > low && step < high { step } else { f64::midpoint(low, high) };
            let near = (next - number).abs() <= enough || next == low || next == high;
            number = next;
            if near {
                break;
            }
        }
        Some(self.rays.point(at, number))
    }

    /// The rectangle of its coordinates.
    fn rectangle(&self) -> (DVec2, DVec2) {
        let spread = |(low, high): (DVec2, DVec2), at: &DVec2| (low.min(*at), high.max(*at));
        self.outline.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), spread)
    }

    fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let next = self.outline.iter().cycle().skip(1);
        self.outline.iter().zip(next).map(|(from, to)| [*from, *to])
    }

    /// Whether a point lies over the face, or beside it by less than a share of its size.
    fn is_over(&self, point: DVec3, slack: f64) -> bool {
        let (at, number) = self.rays.drop(point);
        if self.rays.is_central() && number <= 0.0 {
            return false;
        }
        let (low, high) = self.rectangle();
        let near = slack * (high - low).length();
        encloses(&self.outline, at) || self.sides().any(|side| distance_to_segment(at, side) <= near)
    }

    /// How far a place near the surface is from it, by steps along the gradient.
    fn distance(&self, place: DVec3) -> f64 {
        let mut at = place;
        for _ in 0..24 {
            let (value, gradient) = self.relief.value_gradient(at);
            let square = gradient.length_squared();
            if square == 0.0 {
                return f64::INFINITY;
            }
            let next = at - gradient * (value / square);
            if next == at || next.distance(at) <= 1e-15 * at.abs().max_element() {
                return next.distance(place);
            }
            at = next;
        }
        at.distance(place)
    }

    /// Points of the surface, to find the box around it.
    fn lattice(&self) -> impl Iterator<Item = DVec3> {
        const STEPS: u32 = 24;
        let (low, high) = self.rectangle();
        let at = move |x: u32, y: u32| {
            low + (high - low) * DVec2::new(f64::from(x), f64::from(y)) / f64::from(STEPS)
        };
        let places = (0..=STEPS).flat_map(move |x| (0..=STEPS).map(move |y| at(x, y)));
        let inner = places.filter(|place| encloses(&self.outline, *place));
        let along =
            |[from, to]: [DVec2; 2]| (0..STEPS).map(move |k| from.lerp(to, f64::from(k) / f64::from(STEPS)));
        inner.chain(self.sides().flat_map(along)).filter_map(|place| self.root(place))
    }
}

impl PerturbedSkin {
    /// Whether it is a body of a field, because a ray meets the surface more than once.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.solid.is_some()
    }

    /// Whether another skin has the same faces with the same rays, and each ray meets both once.
    #[must_use]
    pub fn has_faces_of(&self, other: &Self) -> bool {
        let alike = |(one, other): (&PerturbedFace, &PerturbedFace)| {
            one.corners == other.corners && one.rays == other.rays && one.radius == other.radius
        };
        self.solid.is_none()
            && other.solid.is_none()
            && self.points == other.points
            && self.faces.len() == other.faces.len()
            && self.faces.iter().zip(&other.faces).all(alike)
    }

    /// The point of another skin of the same faces on the ray of a point of this one, and the derivatives of their equations
    /// at both; none where no face has that ray.
    #[must_use]
    pub fn carried(&self, other: &Self, point: DVec3) -> Option<(DVec3, [DVec3; 2])> {
        // A point on a side lies beside its faces by rounding.
        const BESIDE: f64 = 1e-9;
        let (own, there) =
            self.faces.iter().zip(&other.faces).find(|(face, _)| face.is_over(point, BESIDE))?;
        let place = there.root(own.rays.drop(point).0)?;
        let slope = |face: &PerturbedFace, at: DVec3| face.relief.value_gradient(at).1;
        Some((place, [slope(own, point), slope(there, place)]))
    }

    /// How many faces it has.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Whether every side belongs to two faces.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.sides.values().all(|faces| faces.len() == 2)
    }

    /// Points all over it; of a solid the corners of a box that holds it.
    #[must_use]
    pub fn samples(&self) -> Vec<DVec3> {
        match &self.solid {
            Some(solid) => {
                let (low, high) = (solid.within.min, solid.within.max);
                let pick = |mask: u32, bit: u32, axis: usize| {
                    if mask & bit == 0 { low.to_array()[axis] } else { high.to_array()[axis] }
                };
                (0..8).map(|k| DVec3::new(pick(k, 1, 0), pick(k, 2, 1), pick(k, 4, 2))).collect()
            }
            None => self.faces.iter().flat_map(PerturbedFace::lattice).collect(),
        }
    }

    /// A box around it, by points of the surface.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.samples())
    }

    /// How far a place near the surface is from it.
    #[must_use]
    pub fn distance(&self, place: DVec3) -> f64 {
        if let Some(solid) = &self.solid {
            return solid.distance(place);
        }
        // Chords over a side leave the faces by little.
        const BESIDE: f64 = 1e-3;
        let over = self.faces.iter().filter(|face| face.is_over(place, BESIDE));
        let nearest = over.map(|face| face.distance(place)).fold(f64::INFINITY, f64::min);
        if nearest.is_finite() {
            return nearest;
        }
        self.faces.iter().map(|face| face.distance(place)).fold(f64::INFINITY, f64::min)
    }
}

/// Cuts a skin into triangles. Anchors have source 0. A fixed grid gives each side `u` chords and each face a lattice of
/// `u` by `v` points.
///
/// # Errors
/// When the limit is passed; of bodies, what [`field_surface`] refuses.
pub fn perturbed(skin: &PerturbedSkin, detail: &Detail) -> Result<Tessellation, TessellateError> {
    if let Some(solid) = &skin.solid {
        return field_surface(solid, detail);
    }
    let (mut cut, tolerance, lattice) = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => (Cut::Within(SIDES * tolerance), tolerance, None),
        // Triangles of which nothing is known are split even so.
        SurfaceDensity::Grid { u, v } => (Cut::Into(u), f64::MAX, Some([u, v])),
    };
    let wanted = Wanted { tolerance, limit: detail.triangle_limit, lattice };
    for halvings in 0..TRIES {
        if let Some((mut cloth, mut bound)) = filled(skin, (cut, halvings), wanted)?
            && bound <= tolerance
        {
            if lattice.is_none() {
                bound = cloth.thin(skin, tolerance);
            }
            return Ok(Tessellation {
                mesh: cloth.mesh(skin, detail),
                deviation: Deviation::new(bound, Evidence::Proved),
            });
        }
        cut = match cut {
            Cut::Within(tolerance) => Cut::Within(tolerance / 4.0),
            Cut::Into(count) => Cut::Into(count.saturating_mul(2)),
        };
    }
    Err(TessellateError::Tangled)
}

/// The triangles of a face, and the coordinates of their points.
type FilledFace = (Vec<[u32; 3]>, BTreeMap<u32, DVec2>);

/// The triangles of all faces, on common points.
struct Cloth {
    points: Vec<DVec3>,
    /// How many of them, from the first on, lie on sides.
    sides: u32,
    /// How far sides lie from their chords.
    out: f64,
    /// For each face its triangles, and the coordinates of their points.
    faces: Vec<FilledFace>,
}

impl Cloth {
    /// Takes points away that no triangle needs. The greatest bound of triangles and sides.
    fn thin(&mut self, skin: &PerturbedSkin, tolerance: f64) -> f64 {
        let (points, sides) = (&self.points, self.sides);
        let bounds = self.faces.par_iter_mut().zip(&skin.faces).map(|((triangles, places), face)| {
            let on_border = |point: &&u32| **point < sides;
            let border: BTreeSet<u32> = places.keys().filter(on_border).copied().collect();
            thin::thin(FaceChart { face }, (triangles, places), points, &border, tolerance)
        });
        bounds.reduce(|| 0.0, f64::max).max(self.out)
    }
}

/// Fills all faces; `None` where chords cross.
///
/// Sides are halved so often before they are cut: a straight one is not cut for its own sake, but bounds over triangles on it
/// may say nothing while it is long.
fn filled(
    skin: &PerturbedSkin,
    (cut, halvings): (Cut, u32),
    wanted: Wanted,
) -> Result<Option<(Cloth, f64)>, TessellateError> {
    let mut points = skin.corners()?;
    let mut chains: BTreeMap<[u32; 2], (u32, Vec<u32>)> = BTreeMap::new();
    let mut bound: f64 = 0.0;
    for (line, (side, faces)) in skin.sides.iter().enumerate() {
        let face = &skin.faces[faces[0] as usize];
        let at = side.map(|point| face.place_of(point));
        let rim = Rim { face, from: at[0], to: at[1] };
        let [start, end] = side.map(|point| points[point as usize]);
        let pieces = 1_u32 << halvings;
        let inner = (1..pieces).map(|k| rim.settled(start.lerp(end, f64::from(k) / f64::from(pieces))));
        let stops: Vec<DVec3> = core::iter::once(start).chain(inner).chain([end]).collect();
        let mut stations = vec![start];
        for piece in stops.windows(2) {
            stations.extend(chords(&rim, piece, cut, wanted.limit)?.into_iter().skip(1));
        }
        let out = stations.windows(2).map(|pair| rim.bulge(pair[0], pair[1]).1);
        bound = out.fold(bound, f64::max);
        let inner = stations.len().saturating_sub(2);
        let mut chain = vec![side[0]];
        chain.extend((0..inner).map(|k| index(points.len() + k)));
        chain.push(side[1]);
        points.extend_from_slice(&stations[1..=inner]);
        chains.insert(*side, (index(line), chain));
    }
    let (sides, out) = (index(points.len()), bound);
    let mut faces = Vec::with_capacity(skin.faces.len());
    let mut count = 0;
    for face in &skin.faces {
        let outline = face.bordered(&chains, &points);
        let limit = wanted.limit.saturating_sub(count).max(1);
        match fill(&FaceChart { face }, &outline, &mut points, Wanted { limit, ..wanted })? {
            Ok(found) => {
                bound = bound.max(found.bound);
                count += found.triangles.len() as u64;
                faces.push((found.triangles, found.places.into_iter().collect()));
            }
            Err(Fault::Crossing) => return Ok(None),
        }
    }
    Ok(Some((Cloth { points, sides, out, faces }, bound)))
}

impl PerturbedFace {
    /// The coordinates of a corner.
    fn place_of(&self, point: u32) -> DVec2 {
        let corner = self.corners.iter().position(|corner| *corner == point);
        self.outline[corner.expect("a side's points are corners of its faces")]
    }

    /// The border as it is cut.
    fn bordered(&self, chains: &BTreeMap<[u32; 2], (u32, Vec<u32>)>, points: &[DVec3]) -> Outline {
        let mut outline = Outline::default();
        let count = self.corners.len();
        let side = |k: usize| [self.corners[k % count], self.corners[(k + 1) % count]];
        let key = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        for k in 0..count {
            let ends = side(k);
            let (line, chain) = &chains[&key(ends)];
            let (before, _) = &chains[&key(side(k + count - 1))];
            outline.places.push(Place { at: self.outline[k], point: ends[0], lines: [*line, *before] });
            let inner = &chain[1..chain.len() - 1];
            let mut inner: Vec<u32> = inner.to_vec();
            if chain[0] != ends[0] {
                inner.reverse();
            }
            for point in inner {
                let (at, _) = self.rays.drop(points[point as usize]);
                outline.places.push(Place { at, point, lines: [*line, NO_LINE] });
            }
        }
        let places = outline.places.len();
        outline.edges = (0..places).map(|k| [k, (k + 1) % places]).collect();
        outline
    }
}

impl PerturbedSkin {
    /// Where the surface stands on the corners; points that no face has stay where they are.
    fn corners(&self) -> Result<Vec<DVec3>, TessellateError> {
        let mut points = self.points.clone();
        for face in &self.faces {
            for (corner, at) in face.corners.iter().zip(&face.outline) {
                points[*corner as usize] = face.root(*at).ok_or(TessellateError::NoSurface)?;
            }
        }
        Ok(points)
    }
}

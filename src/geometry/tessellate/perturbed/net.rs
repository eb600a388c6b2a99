//! Skins from what is written: faces, rays and equations, and what is wrong with them.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use thiserror::Error;

use super::rays::Rays;
use super::unique::{Count, count};
use super::{NetBase, PerturbedFace, PerturbedNet, PerturbedSkin, rims, solid};
use crate::geometry::field::{Quadric, Relief};
use crate::geometry::mesh::index;
use crate::geometry::number::Bounds;
use crate::geometry::planar::{crossing, turn, twice_area};

/// What is wrong with a net. Faces and points count from 0.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SkinFault {
    /// A corner without area: two corners in one place, or a side that runs back along the one before it.
    #[error("face {face} has no area at its corner {point}")]
    ZeroCorner {
        /// The face.
        face: u32,
        /// The point.
        point: u32,
    },
    /// Sides that cross or touch.
    #[error("sides of face {face} cross each other")]
    Crossing {
        /// The face.
        face: u32,
    },
    /// A flat face that is not.
    #[error("face {face} is not flat: point {point} lies {off} from the plane of its corners")]
    NotFlat {
        /// The face.
        face: u32,
        /// The point.
        point: u32,
        /// How far it is off.
        off: f64,
    },
    /// A side of a part of a ball whose ends look away from each other: no great circle is the shortest.
    #[error("points {} and {} are antipodal: no shortest side of face {face} leads from one to the other", ends[0], ends[1])]
    Antipodal {
        /// The face.
        face: u32,
        /// The ends of the side.
        ends: [u32; 2],
    },
    /// A face that spans more of the directions from the center than rays can be counted on.
    #[error("seen from the center face {face} is wider than a half of all directions")]
    TooWide {
        /// The face.
        face: u32,
    },
    /// Points of a ball with several radii.
    #[error("point {point} lies {found} from the center, the first one {radius}")]
    OffBall {
        /// The point.
        point: u32,
        /// Its distance.
        found: f64,
        /// That of the first point of the first face.
        radius: f64,
    },
    /// A face that does not look away from the center.
    #[error("face {face} looks towards the center, or past it")]
    LooksInward {
        /// The face.
        face: u32,
    },
    /// A side with more than two faces, or with two on one hand.
    #[error("the side from point {} to point {} {}", ends[0], ends[1], if *faces > 2 { "has more than two faces" } else { "has both of its faces on one hand" })]
    SharedSide {
        /// The ends of the side.
        ends: [u32; 2],
        /// How many faces it has.
        faces: usize,
    },
    /// Bumps that part neighbors.
    #[error("bump {bump} parts faces {} and {} along their side", faces[0], faces[1])]
    Parted {
        /// The bump.
        bump: usize,
        /// The faces.
        faces: [u32; 2],
        /// Where.
        place: DVec3,
    },
    /// A surface that goes further from a face than it is looked for, or reaches the center.
    #[error("the surface of face {face} {}", if *inward { "goes too far in" } else { "goes too far out" })]
    Lost {
        /// The face.
        face: u32,
        /// Near where.
        place: DVec3,
        /// Whether on the inner side.
        inward: bool,
    },
    /// A surface that a ray meets more than once, where no solid is known.
    #[error("a ray through face {face} meets the surface more than once")]
    Overhang {
        /// The face.
        face: u32,
        /// Near where.
        place: DVec3,
        /// Why its solid is not known.
        why: NoSolid,
    },
}

/// Why the body of a skin has no field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSolid {
    /// Several faces that leave the skin open.
    Open,
    /// A closed skin whose faces have no center.
    NoCenter,
    /// A closed skin whose bumps belong to some of its faces.
    OwnBumps,
    /// A face, or the body of all, that is not convex.
    NotConvex,
}

/// Points that are off a plane or a ball by more than this share of the size are a mistake.
const OFF: f64 = 1e-6;
/// The least cosine between the axis of a face and its corners, seen from a center.
const WIDEST: f64 = 0.05;
/// Rays from a center are searched from this share of their length on.
pub(super) const NEAR_CENTER: f64 = 0.02;

impl PerturbedSkin {
    /// A skin that is known to be sound.
    ///
    /// # Errors
    /// What is wrong with the net.
    pub fn new(net: &PerturbedNet) -> Result<Self, SkinFault> {
        let size = Bounds::of_points(net.points.iter().copied()).diagonal();
        let radius = radius(net)?;
        let mut faces = Vec::with_capacity(net.faces.len());
        for (number, corners) in net.faces.iter().enumerate() {
            faces.push(face(net, index(number), corners, radius)?);
        }
        let scale = faces.iter().map(|(_, distance)| distance).sum::<f64>() / faces.len() as f64;
        let mut skin =
            Self { points: net.points.clone(), faces: Vec::new(), sides: sides(net)?, solid: None };
        for (mut face, distance) in faces {
            let number = index(skin.faces.len());
            if matches!(net.base, NetBase::FlatAround(_)) {
                // One value on the walls between faces: 0 on the face, and proportional to the way from the center.
                face.relief.base = zero().plus(&face.relief.base, scale / distance);
            }
            take_bumps(&mut face, net, number, size);
            skin.faces.push(face);
        }
        for number in 0..skin.faces.len() {
            let place = match count(&skin.faces[number]) {
                Count::One => continue,
                Count::Lost { place, inward } => {
                    return Err(SkinFault::Lost { face: index(number), place, inward });
                }
                Count::Several { place } => place,
            };
            let fault = |why| SkinFault::Overhang { face: index(number), place, why };
            skin.solid = Some(Box::new(solid::body(net, &skin, radius).map_err(fault)?));
            return Ok(skin);
        }
        rims::check(net, &skin, size)?;
        Ok(skin)
    }
}

fn zero() -> Quadric {
    Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0)
}

/// The polynomial n . (p - a).
fn plane(normal: DVec3, point: DVec3) -> Quadric {
    Quadric::new(DVec3::ZERO, DVec3::ZERO, normal, -normal.dot(point))
}

/// The polynomial that is 0 on a ball, with slopes of 1 there.
pub(super) fn ball(center: DVec3, radius: f64) -> Quadric {
    let half = 0.5 / radius;
    let constant = (center.length_squared() - radius * radius) * half;
    Quadric::new(DVec3::splat(half), DVec3::ZERO, -center / radius, constant)
}

/// The radius of a ball's points.
fn radius(net: &PerturbedNet) -> Result<Option<f64>, SkinFault> {
    let NetBase::Ball(center) = net.base else { return Ok(None) };
    let mut all =
        net.faces.iter().flatten().map(|point| (*point, net.points[*point as usize].distance(center)));
    let Some((_, radius)) = all.next() else { return Ok(None) };
    match all.find(|(_, found)| (found - radius).abs() > OFF * radius) {
        Some((point, found)) => Err(SkinFault::OffBall { point, found, radius }),
        None => Ok(Some(radius)),
    }
}

/// A face without bumps, and how far its plane is from the center.
fn face(
    net: &PerturbedNet,
    number: u32,
    corners: &[u32],
    radius: Option<f64>,
) -> Result<(PerturbedFace, f64), SkinFault> {
    let places: Vec<DVec3> = corners.iter().map(|corner| net.points[*corner as usize]).collect();
    let size = Bounds::of_points(places.iter().copied()).diagonal();
    for (k, place) in places.iter().enumerate() {
        if place.distance(places[(k + 1) % places.len()]) <= 1e-9 * size {
            return Err(SkinFault::ZeroCorner { face: number, point: corners[k] });
        }
    }
    let (rays, base, distance) = match net.base {
        NetBase::Ball(center) => on_ball(number, corners, &places, (center, radius.unwrap_or(1.0)))?,
        NetBase::Flat | NetBase::FlatAround(_) => on_plane(net.base, number, corners, &places, size)?,
    };
    let outline: Vec<DVec2> = places.iter().map(|place| rays.drop(*place).0).collect();
    check_outline(number, corners, &outline)?;
    let made = PerturbedFace {
        corners: corners.to_vec(),
        outline,
        rays,
        relief: Relief::smooth(base),
        bumps: Vec::new(),
        reach: (0.0, 1.0),
        radius,
    };
    Ok((made, distance))
}

fn on_ball(
    number: u32,
    corners: &[u32],
    places: &[DVec3],
    (center, radius): (DVec3, f64),
) -> Result<(Rays, Quadric, f64), SkinFault> {
    let directions: Vec<DVec3> = places.iter().map(|place| (*place - center).normalize_or_zero()).collect();
    let count = corners.len();
    for k in 0..count {
        let next = (k + 1) % count;
        if directions[k].dot(directions[next]) < -1.0 + 1e-9 {
            return Err(SkinFault::Antipodal { face: number, ends: [corners[k], corners[next]] });
        }
    }
    let area: DVec3 = (0..count).map(|k| directions[k].cross(directions[(k + 1) % count])).sum();
    let axis = area.normalize_or_zero();
    let least = directions.iter().map(|direction| direction.dot(axis)).fold(f64::INFINITY, f64::min);
    if least < WIDEST {
        let inward = directions.iter().map(|direction| direction.dot(axis)).sum::<f64>() < 0.0;
        return Err(if inward {
            SkinFault::LooksInward { face: number }
        } else {
            SkinFault::TooWide { face: number }
        });
    }
    Ok((Rays::central(center, axis * radius), ball(center, radius), radius))
}

fn on_plane(
    base: NetBase,
    number: u32,
    corners: &[u32],
    places: &[DVec3],
    size: f64,
) -> Result<(Rays, Quadric, f64), SkinFault> {
    let middle = places.iter().sum::<DVec3>() / places.len() as f64;
    let count = places.len();
    let area: DVec3 =
        (0..count).map(|k| (places[k] - middle).cross(places[(k + 1) % count] - middle)).sum::<DVec3>() / 2.0;
    if area.length() <= 1e-9 * size * size {
        // A figure of eight may have as much area on one hand as on the other.
        let wide = |k: usize| (places[k] - middle).cross(places[(k + 1) % count] - middle).length();
        let crosses = (0..count).any(|k| wide(k) > 1e-6 * size * size);
        return Err(if crosses {
            SkinFault::Crossing { face: number }
        } else {
            SkinFault::ZeroCorner { face: number, point: corners[0] }
        });
    }
    let normal = area.normalize();
    for (corner, place) in corners.iter().zip(places) {
        let off = normal.dot(*place - middle);
        if off.abs() > OFF * size {
            return Err(SkinFault::NotFlat { face: number, point: *corner, off: off.abs() });
        }
    }
    let NetBase::FlatAround(center) = base else {
        return Ok((Rays::parallel(middle, normal), plane(normal, middle), 1.0));
    };
    let distance = normal.dot(middle - center);
    let widest = places.iter().map(|place| (*place - center).length()).fold(0.0, f64::max);
    if distance < WIDEST * widest {
        let inward = distance < 0.0;
        return Err(if inward {
            SkinFault::LooksInward { face: number }
        } else {
            SkinFault::TooWide { face: number }
        });
    }
    Ok((Rays::central(center, normal * distance), plane(normal, middle), distance))
}

/// Corners without area, and sides that cross.
fn check_outline(number: u32, corners: &[u32], outline: &[DVec2]) -> Result<(), SkinFault> {
    let count = outline.len();
    for k in 0..count {
        let (before, here, next) = (outline[(k + count - 1) % count], outline[k], outline[(k + 1) % count]);
        let (from, to) = (here - before, next - here);
        if turn(before, here, next).abs() <= 1e-9 * from.length() * to.length() && from.dot(to) < 0.0 {
            return Err(SkinFault::ZeroCorner { face: number, point: corners[k] });
        }
    }
    if crossing(&[outline]).is_some() {
        return Err(SkinFault::Crossing { face: number });
    }
    // Seen along the rays a face that does not cross itself turns once around, to the left where it looks outward.
    if twice_area(outline) <= 0.0 {
        return Err(SkinFault::LooksInward { face: number });
    }
    Ok(())
}

/// The faces at each side.
fn sides(net: &PerturbedNet) -> Result<BTreeMap<[u32; 2], Vec<u32>>, SkinFault> {
    let mut sides: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    let mut ways: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (face, corners) in net.faces.iter().enumerate() {
        for (k, from) in corners.iter().enumerate() {
            let to = corners[(k + 1) % corners.len()];
            let faces = sides.entry([*from.min(&to), *from.max(&to)]).or_default();
            faces.push(index(face));
            let way = ways.entry([*from, to]).or_default();
            *way += 1;
            if faces.len() > 2 || *way > 1 {
                return Err(SkinFault::SharedSide { ends: [*from, to], faces: faces.len() });
            }
        }
    }
    Ok(sides)
}

/// The bumps that reach a face, and how far along its rays the surface may be.
fn take_bumps(face: &mut PerturbedFace, net: &PerturbedNet, number: u32, size: f64) {
    let stretch = face.rays.stretch();
    let rests = face.outline.iter().map(|at| face.rest(*at)).chain(face.radius.is_some().then_some(1.0));
    let (mut low, mut high) =
        rests.fold((f64::INFINITY, 0.0_f64), |(low, high), at| (low.min(at), high.max(at)));
    let rest = (low, high);
    let convex = face.is_convex();
    for (k, written) in net.bumps.iter().enumerate() {
        if written.faces.as_ref().is_some_and(|faces| !faces.contains(&number)) {
            continue;
        }
        let span = match written.bump.bounds() {
            Some(bounds) if bounds.is_empty() || (convex && face.misses(bounds)) => continue,
            Some(bounds) => {
                let numbers = corners_of(bounds).map(|corner| face.rays.drop(corner).1);
                numbers
                    .into_iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
            }
            None => (rest.0 - size / 2.0 / stretch, rest.1 + size / 2.0 / stretch),
        };
        (low, high) = (low.min(span.0), high.max(span.1));
        face.relief.bumps.push(written.bump.clone());
        face.bumps.push(k);
    }
    let pad = 1e-3 * size / stretch;
    if let Some(reach) = net.reach {
        (low, high) = (low.max(rest.0 - reach / stretch), high.min(rest.1 + reach / stretch));
    }
    (low, high) = (low - pad, high + pad);
    if face.rays.is_central() {
        low = low.max(NEAR_CENTER);
    }
    face.reach = (low, high);
}

fn corners_of(bounds: &Bounds) -> [DVec3; 8] {
    let pick = |k: usize, bit: usize, axis: usize| {
        if k & bit == 0 { bounds.min.to_array()[axis] } else { bounds.max.to_array()[axis] }
    };
    std::array::from_fn(|k| DVec3::new(pick(k, 1, 0), pick(k, 2, 1), pick(k, 4, 2)))
}

impl PerturbedFace {
    /// Whether its outline never turns right.
    pub(super) fn is_convex(&self) -> bool {
        let count = self.outline.len();
        let at = |k: usize| self.outline[k % count];
        (0..count).all(|k| turn(at(k), at(k + 1), at(k + 2)) >= 0.0)
    }

    /// Whether a box surely lies beside the rays of a convex face.
    fn misses(&self, bounds: &Bounds) -> bool {
        let corners = corners_of(bounds);
        let behind = self.rays.is_central() && corners.iter().all(|corner| self.rays.drop(*corner).1 < 0.0);
        let beside = |[from, to]: [DVec2; 2]| {
            let (wall, foot) = (self.rays.wall(from, to), self.rays.foot(from));
            corners.iter().all(|corner| wall.dot(*corner - foot) > 0.0)
        };
        behind || self.sides().any(beside)
    }
}

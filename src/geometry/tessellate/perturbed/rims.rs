//! Whether neighbors have one line along their common side.

use std::collections::BTreeSet;

use glam::DVec3;

use super::judge::{Rim, chord};
use super::{NetBase, PerturbedNet, PerturbedSkin, SkinFault};
use crate::geometry::field::{ReliefBump, Zone};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::region::Line as _;

/// Normals that differ by less look one way.
const ALIKE: f64 = 1e-9;
/// A bump less high than this share of the size does not part faces.
const LOW: f64 = 1e-9;
/// Halvings of a side.
const DEEPEST: u32 = 12;

/// Checks all sides with two faces, and the corners where faces look along normals of their own.
pub(super) fn check(net: &PerturbedNet, skin: &PerturbedSkin, size: f64) -> Result<(), SkinFault> {
    for (side, faces) in &skin.sides {
        let [one, other] = faces.as_slice() else { continue };
        let [a, b] = [one, other].map(|face| &skin.faces[*face as usize]);
        let turned = net.base == NetBase::Flat
            && a.rays.direction(a.outline[0]).distance(b.rays.direction(b.outline[0])) > ALIKE;
        let of = |bumps: &[usize]| bumps.iter().copied().collect::<BTreeSet<usize>>();
        let (first, second) = (of(&a.bumps), of(&b.bumps));
        // Bumps of both part faces too that do not grow the same way.
        let parting: Vec<usize> = if turned {
            first.union(&second).copied().collect()
        } else {
            first.symmetric_difference(&second).copied().collect()
        };
        let rim = Rim { face: a, from: a.place_of(side[0]), to: a.place_of(side[1]) };
        for bump in parting {
            let written = &net.bumps[bump];
            let common = |face: u32| written.faces.as_ref().is_none_or(|faces| faces.contains(&face));
            // A bump that both may have was left out where its box misses a face, and with it the side.
            if !turned && common(*one) && common(*other) {
                continue;
            }
            let ends =
                [rim.settled(skin.points[side[0] as usize]), rim.settled(skin.points[side[1] as usize])];
            if let Some(place) = met(&rim, ends, &written.bump, LOW * size, DEEPEST) {
                return Err(SkinFault::Parted { bump, faces: [*one, *other], place });
            }
        }
    }
    check_corners(skin, size)
}

/// Faces that meet in a corner alone must have one point there.
fn check_corners(skin: &PerturbedSkin, size: f64) -> Result<(), SkinFault> {
    let mut found: Vec<Option<(u32, DVec3)>> = vec![None; skin.points.len()];
    for (number, face) in skin.faces.iter().enumerate() {
        let number = crate::geometry::mesh::index(number);
        for (corner, at) in face.corners.iter().zip(&face.outline) {
            let Some(place) = face.root(*at) else { continue };
            match found[*corner as usize] {
                None => found[*corner as usize] = Some((number, place)),
                Some((other, known)) if known.distance(place) > 1e-8 * size => {
                    let bump = face.bumps.first().or(skin.faces[other as usize].bumps.first());
                    return Err(SkinFault::Parted {
                        bump: bump.copied().unwrap_or(0),
                        faces: [other, number],
                        place,
                    });
                }
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// A place of the line between two of its points where a bump is.
fn met(rim: &Rim<'_>, [from, to]: [DVec3; 2], bump: &ReliefBump, low: f64, depth: u32) -> Option<DVec3> {
    let out = chord(&rim.face.relief, from, to, None).min(from.distance(to));
    let bounds = Bounds::of_points([from, to]);
    let depths = bump.depth(Zone::Box(&Bounds { min: bounds.min - out, max: bounds.max + out }))?;
    if bump.factor.abs() * depths.low * depths.low <= low {
        return None;
    }
    let middle = rim.settled((from + to) / 2.0);
    let value = bump.field.value(middle).min(0.0);
    if bump.factor.abs() * value * value > low {
        return Some(middle);
    }
    if depth == 0 {
        return None;
    }
    met(rim, [from, middle], bump, low, depth - 1).or_else(|| met(rim, [middle, to], bump, low, depth - 1))
}

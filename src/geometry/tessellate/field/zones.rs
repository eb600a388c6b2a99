//! Places where first triangles are kept as they are, in small cells.
//!
//! First triangles lie each in its own tetrahedron, so that none cross whatever the surface does there: at the ends of
//! its edges, where edges meet in ways that have no name, where sheets nearly touch. There few good triangles cannot
//! always be made of many, and what is split and turned gets worse. So what did not come right is made again, with a
//! ball around it in which cells are small and triangles stay.

use glam::DVec3;

use crate::geometry::number::Bounds;

/// A ball in which first triangles are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Zone {
    center: DVec3,
    radius: f64,
    /// How large its cells may be.
    cell: f64,
}

/// A triangle that crosses another, or is too far off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrong {
    /// Its middle.
    pub(super) place: DVec3,
    /// Whether it was kept as it was, and is too large.
    pub(super) coarse: bool,
}

/// The balls of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Zones(Vec<Zone>);

/// Radius of a new zone in tolerances.
const REACH: f64 = 3.0;
/// Most zones of a surface.
const MOST: usize = 1 << 8;

impl Zones {
    /// How large cells in a box may be.
    pub(super) fn cell(&self, within: &Bounds) -> Option<f64> {
        let touches = |zone: &&Zone| {
            let nearest = zone.center.clamp(within.min, within.max);
            zone.center.distance_squared(nearest) <= zone.radius * zone.radius
        };
        self.0.iter().filter(touches).map(|zone| zone.cell).min_by(f64::total_cmp)
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The same with cells half as large.
    pub(super) fn halved(&self) -> Self {
        Self(self.0.iter().map(|zone| Zone { cell: zone.cell / 2.0, ..*zone }).collect())
    }

    /// All of them as too coarse.
    pub(super) fn coarse(&self) -> Vec<Wrong> {
        self.0.iter().map(|zone| Wrong { place: zone.center, coarse: true }).collect()
    }

    /// The middle of those that overlap the one that grew most.
    pub(super) fn middle(&self) -> DVec3 {
        let Some(largest) = self.0.iter().max_by(|one, other| one.radius.total_cmp(&other.radius)) else {
            return DVec3::ZERO;
        };
        let (mut members, mut next) = (vec![*largest], 0);
        while let Some(member) = members.get(next).copied() {
            let joined = |zone: &&Zone| zone.center.distance(member.center) <= zone.radius + member.radius;
            let new: Vec<Zone> =
                self.0.iter().filter(joined).filter(|zone| !members.contains(zone)).copied().collect();
            members.extend(new);
            next += 1;
        }
        members.iter().map(|zone| zone.center).sum::<DVec3>() / members.len() as f64
    }

    /// Whether a place is in a zone.
    pub(super) fn hold(&self, place: DVec3) -> bool {
        self.0.iter().any(|zone| zone.center.distance_squared(place) <= zone.radius * zone.radius)
    }

    /// Grows zones at which something is still wrong, and adds those of other places; whether that is worth another try.
    /// Where triangles that were kept are too far off, cells become smaller.
    pub(super) fn grow(&mut self, wrong: &[Wrong], tolerance: f64) -> bool {
        let old = self.0.len();
        let mut failed = vec![(false, false); old];
        for Wrong { place, coarse } in wrong {
            // What is wrong at the rim of a zone grows it.
            let near = |zone: &Zone| zone.center.distance(*place) <= zone.radius + tolerance;
            match self.0.iter().position(near) {
                Some(found) if found < old => {
                    failed[found] = (failed[found].0 | !coarse, failed[found].1 | coarse)
                }
                Some(_) => {}
                None => self.0.push(Zone { center: *place, radius: REACH * tolerance, cell: tolerance }),
            }
            if self.0.len() > MOST {
                return false;
            }
        }
        for (zone, (beside, within)) in self.0.iter_mut().zip(failed) {
            if beside {
                zone.radius *= 1.7;
            }
            if within {
                zone.cell /= 2.0;
            }
        }
        !wrong.is_empty()
    }
}

//! Weights: which joints carry a point, and by how much.
//!
//! At most four joints carry a point. Weights are written as bytes whose sum is exactly 255: shares are
//! rounded down and what is missing goes to the greatest remainders (Hamilton's method), so no weight is
//! further than 1/255 from its share.

use glam::DVec3;

use super::skeleton::Joint;
use crate::geometry::mesh::Mesh;

/// A joint's part in a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Influence {
    /// Index among the joints of the skin.
    pub joint: u8,
    /// Weight in 255ths; 0 for a place that is not used, whose joint is 0.
    pub weight: u8,
}

/// The joints of a point, the greatest weight first.
pub type Influences = [Influence; 4];

/// For each point the weight of each joint of the skin: `joints` numbers a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    joints: usize,
    values: Vec<f64>,
}

/// How far around its bone a joint carries: wholly to `radius`, less and less to `radius + falloff`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// Metres.
    pub radius: f64,
    /// Metres, greater than 0.
    pub falloff: f64,
}

impl Envelope {
    /// The weight at a distance: 1 inside, (1 - s^2)^2 over the falloff, 0 beyond; smooth all the way.
    #[must_use]
    pub fn weight(&self, distance: f64) -> f64 {
        let share = ((distance - self.radius) / self.falloff).clamp(0.0, 1.0);
        let rest = 1.0 - share * share;
        rest * rest
    }
}

/// Each point wholly with the nearest bone; of two at one distance with the first.
#[must_use]
pub fn rigid_weights(points: &[DVec3], joints: &[&Joint]) -> Weights {
    weights_of(points, joints.len(), |point, weights| {
        let distance = |joint: &usize| joints[*joint].distance(point);
        let nearest = (0..joints.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(nearest) = nearest {
            weights[nearest] = 1.0;
        }
    })
}

/// Each point with the bones in whose envelopes it lies.
#[must_use]
pub fn envelope_weights(points: &[DVec3], joints: &[(&Joint, Envelope)]) -> Weights {
    weights_of(points, joints.len(), |point, weights| {
        for (weight, (joint, envelope)) in weights.iter_mut().zip(joints) {
            *weight = envelope.weight(joint.distance(point));
        }
    })
}

/// Weights that a function writes for each point.
pub fn weights_of(points: &[DVec3], joints: usize, mut write: impl FnMut(DVec3, &mut [f64])) -> Weights {
    let mut values = vec![0.0; points.len() * joints];
    if joints > 0 {
        points.iter().zip(values.chunks_mut(joints)).for_each(|(point, weights)| write(*point, weights));
    }
    Weights { joints, values }
}

impl Weights {
    /// The weights of a point.
    #[must_use]
    pub fn of(&self, point: usize) -> &[f64] {
        &self.values[point * self.joints..(point + 1) * self.joints]
    }

    /// How many points there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len().checked_div(self.joints).unwrap_or(0)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The points that no joint carries, and how many there are.
    #[must_use]
    pub fn without(&self) -> (Option<usize>, usize) {
        let bare = |point: &usize| self.of(*point).iter().all(|weight| *weight <= 0.0);
        let mut bare = (0..self.len()).filter(bare);
        let first = bare.next();
        (first, bare.count() + usize::from(first.is_some()))
    }

    /// Brings each point's weights nearer to the mean of its neighbours along edges, by half, `rounds` times. Sums stay 1.
    /// O(rounds * (edges + points * joints)).
    pub fn smooth(&mut self, mesh: &Mesh, rounds: u32) {
        self.normalize();
        let neighbors = neighbors(mesh);
        for _ in 0..rounds {
            let before = self.values.clone();
            for (point, around) in neighbors.iter().enumerate() {
                if around.is_empty() {
                    continue;
                }
                let share = 0.5 / around.len() as f64;
                for joint in 0..self.joints {
                    let at = |point: usize| before[point * self.joints + joint];
                    let sum: f64 = around.iter().map(|other| at(*other as usize)).sum();
                    self.values[point * self.joints + joint] = 0.5 * at(point) + share * sum;
                }
            }
        }
    }

    fn normalize(&mut self) {
        if self.joints == 0 {
            return;
        }
        for weights in self.values.chunks_mut(self.joints) {
            let sum: f64 = weights.iter().sum();
            if sum > 0.0 {
                weights.iter_mut().for_each(|weight| *weight /= sum);
            }
        }
    }

    /// The four greatest weights of each point, as bytes.
    #[must_use]
    pub fn written(&self) -> Vec<Influences> {
        (0..self.len()).map(|point| written(self.of(point))).collect()
    }
}

/// For each point of a mesh the points it shares an edge with, increasing, each once.
fn neighbors(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut neighbors = vec![Vec::new(); mesh.points.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.vertices[vertex.subscript()].point);
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
            if a != b {
                neighbors[a.subscript()].push(b.0);
                neighbors[b.subscript()].push(a.0);
            }
        }
    }
    for around in &mut neighbors {
        around.sort_unstable();
        around.dedup();
    }
    neighbors
}

fn written(weights: &[f64]) -> Influences {
    let mut order: Vec<usize> = (0..weights.len()).filter(|joint| weights[*joint] > 0.0).collect();
    order.sort_by(|a, b| weights[*b].total_cmp(&weights[*a]).then(a.cmp(b)));
    order.truncate(4);
    let sum: f64 = order.iter().map(|joint| weights[*joint]).sum();
    let exact: Vec<f64> = order.iter().map(|joint| weights[*joint] / sum * 255.0).collect();
    let mut bytes: Vec<u8> = exact.iter().map(|share| byte(*share)).collect();
    let given: u32 = bytes.iter().map(|byte| u32::from(*byte)).sum();
    let missing = 255_u32.saturating_sub(given) as usize;
    let mut by_remainder: Vec<usize> = (0..bytes.len()).collect();
    let remainder = |place: usize| exact[place] - exact[place].floor();
    by_remainder.sort_by(|a, b| remainder(*b).total_cmp(&remainder(*a)).then(a.cmp(b)));
    by_remainder.iter().take(missing).for_each(|place| bytes[*place] += 1);
    let mut all = [Influence::default(); 4];
    let used = order.iter().zip(bytes).filter(|(_, weight)| *weight > 0);
    for (slot, (joint, weight)) in all.iter_mut().zip(used) {
        *slot = Influence { joint: u8::try_from(*joint).unwrap_or(u8::MAX), weight };
    }
    all
}

/// The whole part of a share of 255.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
fn byte(share: f64) -> u8 {
    share.clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Envelope, Influence, weights_of, written};

    #[test]
    fn bytes_always_sum_to_255_and_stay_near() {
        let mut seed = 7_u64;
        for _ in 0..5000 {
            let mut roll = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 40) as f64 / f64::from(1 << 24)
            };
            let weights: Vec<f64> =
                (0..7).map(|_| if roll() < 0.3 { 0.0 } else { roll() * roll() }).collect();
            if weights.iter().all(|weight| *weight == 0.0) {
                continue;
            }
            let found = written(&weights);
            let sum: u32 = found.iter().map(|one| u32::from(one.weight)).sum();
            assert_eq!(sum, 255, "{weights:?}");
            let mut sorted = weights.clone();
            sorted.sort_by(|a, b| b.total_cmp(a));
            let kept: f64 = sorted.iter().take(4).sum();
            for one in found.iter().filter(|one| one.weight > 0) {
                let share = weights[usize::from(one.joint)] / kept * 255.0;
                assert!((f64::from(one.weight) - share).abs() < 1.0, "{weights:?} {found:?}");
            }
            assert!(found.iter().filter(|one| one.weight == 0).all(|one| *one == Influence::default()));
        }
    }

    #[test]
    fn envelopes_fall_off_smoothly() {
        let envelope = Envelope { radius: 1.0, falloff: 2.0 };
        assert_eq!((envelope.weight(0.5), envelope.weight(3.0), envelope.weight(9.0)), (1.0, 0.0, 0.0));
        assert_eq!(envelope.weight(2.0), 0.5625);
    }

    #[test]
    fn bare_points_are_counted() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let weights = weights_of(&points, 2, |point, weights| weights[1] = point.x);
        assert_eq!(weights.without(), (Some(0), 2));
    }
}

//! Masks: a new value as a sum of old ones, and the one loop that applies them.

use super::level::{Born, Channel, Level};
use super::sharpness::Around;
use super::split::{Dual, Root3};
use super::topology::Ring;
use super::{Scheme, butterfly, corner_cut, primal, root3};
use crate::geometry::mesh::index;

/// Weights of old vertices; a vertex may stand in it several times.
#[derive(Clone, Debug, Default)]
pub(super) struct Mask(pub(super) Vec<(u32, f64)>);

impl Mask {
    pub(super) fn add(&mut self, vertex: u32, weight: f64) {
        self.0.push((vertex, weight));
    }

    /// Adds the mean of a face, weighted.
    pub(super) fn add_face(&mut self, level: &Level, face: u32, weight: f64) {
        let corners = level.topology.face(face as usize);
        let share = weight / f64::from(index(corners.len()));
        self.0.extend(corners.iter().map(|vertex| (*vertex, share)));
    }
}

/// Buffers that are filled anew for each vertex.
#[derive(Default)]
pub(super) struct Scratch {
    pub(super) ring: Ring,
    pub(super) other: Ring,
    pub(super) around: Around,
}

/// One step of a scheme over all channels. O(new vertices).
pub(super) fn refine(old: &Level, scheme: Scheme) -> Level {
    let (mut made, born) = old.split(scheme);
    let count = made.topology.vertices();
    made.channels = (old.channels.iter())
        .map(|channel| Channel { width: channel.width, values: Vec::with_capacity(count * channel.width) })
        .collect();
    let (mut mask, mut scratch) = (Mask::default(), Scratch::default());
    for vertex in 0..index(count) {
        mask.0.clear();
        born_mask(old, scheme, &born, vertex, &mut scratch, &mut mask);
        apply(&mask, &old.channels, &mut made.channels);
    }
    made
}

/// Appends the value of a mask to each channel.
pub(super) fn apply(mask: &Mask, old: &[Channel], new: &mut [Channel]) {
    for (from, to) in old.iter().zip(new) {
        for part in 0..from.width {
            let sum = (mask.0.iter()).fold(0.0, |sum, (vertex, weight)| {
                sum + weight * from.values[*vertex as usize * from.width + part]
            });
            to.values.push(sum);
        }
    }
}

fn born_mask(old: &Level, scheme: Scheme, born: &Born, vertex: u32, scratch: &mut Scratch, mask: &mut Mask) {
    let (vertices, edges) = (index(old.topology.vertices()), index(old.topology.edges()));
    match born {
        Born::Primal { faces } => {
            if vertex < vertices {
                match scheme {
                    Scheme::Butterfly => mask.add(vertex, 1.0),
                    _ => primal::vertex(old, scheme, vertex, scratch, mask),
                }
            } else if vertex < vertices + edges {
                match scheme {
                    Scheme::Butterfly => butterfly::edge(old, vertex - vertices, scratch, mask),
                    _ => primal::edge(old, scheme, vertex - vertices, mask),
                }
            } else {
                debug_assert!(*faces, "only quads have a vertex in each face");
                mask.add_face(old, vertex - vertices - edges, 1.0);
            }
        }
        Born::Root3(new) => match vertex.checked_sub(vertices).map(|place| new[place as usize]) {
            None => root3::vertex(old, vertex, scratch, mask),
            Some(Root3::Middle(face)) => mask.add_face(old, face, 1.0),
            Some(Root3::Third(corner)) => root3::third(old, corner, false, scratch, mask),
            Some(Root3::TwoThirds(corner)) => root3::third(old, corner, true, scratch, mask),
        },
        Born::Dual(new) => match new[vertex as usize] {
            Dual::Corner(corner) => corner_cut::corner(old, scheme, corner, mask),
            Dual::Near(corner) => corner_cut::border(old, corner, false, mask),
            Dual::Far(corner) => corner_cut::border(old, corner, true, mask),
        },
    }
}

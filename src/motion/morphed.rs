//! Boxes of points that morph.

use crate::geometry::number::Bounds;

/// A box of points that morph.
#[derive(Clone, Debug)]
pub struct MorphedBox {
    /// The node in whose space they are.
    pub node: usize,
    /// The node whose weights move them.
    pub weights: usize,
    /// The box where all weights are 0.
    pub base: Bounds,
    /// For each morph target what it does to the points.
    pub states: Vec<MorphedState>,
}

/// What a morph target does to the points of a box at weight 1.
#[derive(Clone, Copy, Debug)]
pub struct MorphedState {
    /// The box of the points.
    pub bounds: Bounds,
    /// The box of the ways that they go.
    pub ways: Bounds,
    /// The longest of the ways, metres.
    pub furthest: f64,
}

impl MorphedBox {
    /// A box of the points at some weights: what the sum of the scaled boxes of all states, and that of the box at rest
    /// and the scaled boxes of all ways, have in common. The first is tight where states take turns, the second where
    /// each moves something else.
    #[must_use]
    pub fn at(&self, weights: &[f64]) -> Bounds {
        let sum: f64 = weights.iter().sum();
        let states = || self.states.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let taking_turns = states().fold(scaled(&self.base, 1.0 - sum), |all, (state, weight)| {
            plus(all, scaled(&state.bounds, *weight))
        });
        let together =
            states().fold(self.base, |all, (state, weight)| plus(all, scaled(&state.ways, *weight)));
        Bounds { min: taking_turns.min.max(together.min), max: taking_turns.max.min(together.max) }
    }
}

fn scaled(bounds: &Bounds, factor: f64) -> Bounds {
    let (a, b) = (bounds.min * factor, bounds.max * factor);
    Bounds { min: a.min(b), max: a.max(b) }
}

fn plus(one: Bounds, other: Bounds) -> Bounds {
    Bounds { min: one.min + other.min, max: one.max + other.max }
}

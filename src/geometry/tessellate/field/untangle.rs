//! What puts triangles in order that are too short, too narrow or cross each other.
//!
//! Promise: the surface stays closed and without branches; what is drawn together is shorter than can be seen, or belongs
//! to edges of the surface for which first triangles had too little room.

use super::refine::Refiner;
use super::skin::{Kind, NONE, before, next};
use crate::geometry::mesh;

/// Corners that are nearer than this share of the size are one.
const ONE_PLACE: f64 = 1e-6;

impl Refiner<'_> {
    /// Draws edges together that are shorter than anything that can be seen; triangles beside them have no shape to lose.
    pub(super) fn draw_short(&mut self) {
        let short = (0.02 * self.tolerance).max(2e-6 * self.probe.size).min(1e-4 * self.probe.size);
        let edges: Vec<u32> = self.skin.edges().collect();
        for half in edges {
            if !self.skin.is_alive(half / 3) {
                continue;
            }
            let (a, b) = (self.skin.from(half), self.skin.to(half));
            if self.skin.point(a).distance(self.skin.point(b)) < short {
                let _ = self.draw_either(half);
            }
        }
    }

    /// Puts edges of the surface in order where first triangles had too little room for them: what runs back the way it
    /// came is drawn together, spurs are drawn in, and what is left without an edge is smooth. What is longer than `most`
    /// is left as it is.
    pub(super) fn unfold(&mut self, most: f64) {
        for _ in 0..6 {
            let mut any = false;
            for point in 0..mesh::index(self.skin.points.len()) {
                if self.skin.starts[point as usize] != NONE
                    && matches!(self.skin.kind(point), Kind::Edge | Kind::Corner)
                {
                    any |= self.unfold_at(point, most);
                }
            }
            if !any {
                return;
            }
        }
    }

    fn unfold_at(&mut self, point: u32, most: f64) -> bool {
        let sharp: Vec<u32> = self.skin.around(point).filter(|half| self.skin.is_sharp(*half)).collect();
        let way = |half: u32| self.skin.point(self.skin.to(half)) - self.skin.point(point);
        if let &[] = sharp.as_slice() {
            let Some((place, normal)) = self.probe.settle(self.skin.point(point), 0.01 * self.probe.size)
            else {
                return false;
            };
            self.skin.kinds[point as usize] = Kind::Smooth;
            (self.skin.points[point as usize], self.skin.normals[point as usize]) = (place, normal);
            self.touch(point);
            return true;
        }
        if let &[only] = sharp.as_slice() {
            // An edge may end where its sides come to lie in one plane; what runs out of it is none.
            return !self.probe.is_edge(&self.skin, only) && self.draw_within(only, most);
        }
        // Two edges that leave in nearly one direction are one; of two that pass through a point none turns back.
        let narrow = if sharp.len() == 2 { 0.3 } else { 0.9 };
        for (k, one) in sharp.iter().enumerate() {
            for other in &sharp[k + 1..] {
                let (a, b) = (way(*one), way(*other));
                if a.dot(b) > narrow * a.length() * b.length() {
                    let near = if a.length() <= b.length() { *one } else { *other };
                    // The nearer neighbor goes, unless this point is only on the way.
                    return if sharp.len() == 2 {
                        self.draw_within(near, most)
                    } else {
                        self.draw_within(self.skin.twin(near), most)
                    };
                }
            }
        }
        if sharp.len() == 2 && self.skin.kind(point) == Kind::Corner {
            self.skin.kinds[point as usize] = Kind::Edge;
            return true;
        }
        false
    }

    fn draw_within(&mut self, half: u32, most: f64) -> bool {
        let (from, to) = (self.skin.point(self.skin.from(half)), self.skin.point(self.skin.to(half)));
        from.distance(to) <= most && self.draw_anyway(half)
    }

    fn draw_anyway(&mut self, half: u32) -> bool {
        if self.skin.kind(self.skin.from(half)) == Kind::Held || !self.skin.can_collapse(half) {
            return false;
        }
        let left = self.skin.to(half);
        self.skin.collapse(half);
        self.touch(left);
        true
    }

    /// Draws the ends of a very short edge together.
    fn draw_either(&mut self, half: u32) -> bool {
        let ends = [self.skin.from(half), self.skin.to(half)];
        // Two corners in one place are one, in which more than three edges of the surface meet.
        let twins = ends.iter().all(|end| self.skin.kind(*end) == Kind::Corner)
            && self.skin.point(ends[0]).distance(self.skin.point(ends[1])) < ONE_PLACE * self.probe.size;
        self.draw(half) || self.draw(self.skin.twin(half)) || (twins && self.draw_anyway(half))
    }

    /// Draws the start of a half-edge into its end, where the surface's edges allow it; whether it was done.
    fn draw(&mut self, half: u32) -> bool {
        let skin = &self.skin;
        let free = match skin.kind(skin.from(half)) {
            Kind::Corner | Kind::Held => false,
            Kind::Edge => skin.is_sharp(half),
            Kind::Smooth => true,
        };
        let merged = [(next(half), before(half)), (before(skin.twin(half)), next(skin.twin(half)))];
        let kept = !merged.iter().any(|(one, other)| skin.is_sharp(*one) && skin.is_sharp(*other));
        if !(free && kept && skin.can_collapse(half)) {
            return false;
        }
        let left = skin.to(half);
        self.skin.collapse(half);
        self.touch(left);
        true
    }

    /// Makes triangles that cross others sounder: the shortest side of each is drawn together; large ones are split.
    pub(super) fn untangle(&mut self, crossed: &[u32], round: u32) {
        if crossed.is_empty() {
            return;
        }
        self.unfold(4.0 * self.tolerance);
        for triangle in crossed {
            if !self.skin.is_alive(*triangle) {
                continue;
            }
            let length = |k: u32| {
                let half = 3 * triangle + k;
                self.skin.point(self.skin.from(half)).distance(self.skin.point(self.skin.to(half)))
            };
            let shortest =
                [1, 2].into_iter().fold(0, |best, k| if length(k) < length(best) { k } else { best });
            let short = 3 * triangle + shortest;
            let small = length(shortest) < 2.0 * self.tolerance.max(1e-5 * self.probe.size);
            let mut ring = Vec::new();
            let twin = self.skin.twin(short);
            let gentle = [short, twin]
                .into_iter()
                .find(|half| self.cost_of_collapse(*half, &mut ring) <= self.tolerance);
            if let Some(half) = gentle
                && self.draw(half)
            {
                continue;
            }
            if small && round < 5 && self.draw_either(short) {
                continue;
            }
            if let Some(point) = self.split_any(*triangle) {
                self.touch(point);
            }
        }
        self.turn();
    }
}

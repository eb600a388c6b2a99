//! The nearest of many triangles.

use glam::DVec3;

use crate::geometry::number::Bounds;

/// Triangles in a tree of boxes.
#[derive(Clone, Debug)]
pub(super) struct Facets {
    triangles: Vec<[DVec3; 3]>,
    /// Nodes in the order in which they are met; the first is the root.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    /// Triangles of a leaf; of others the second child, after the first, which comes next.
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Leaf { from: usize, to: usize },
    Inner { second: usize },
}

/// Triangles of a leaf.
const FEW: usize = 4;

impl Facets {
    /// Cost: O(n log n).
    pub(super) fn new(mut triangles: Vec<[DVec3; 3]>) -> Self {
        let mut nodes = Vec::new();
        let count = triangles.len();
        build(&mut triangles, (0, count), &mut nodes);
        Self { triangles, nodes }
    }

    /// Distance to the nearest triangle.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let mut best = f64::INFINITY;
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let Some(node) = self.nodes.get(number) else { continue };
            if away(&node.bounds, point) >= best {
                continue;
            }
            match node.content {
                Content::Leaf { from, to } => {
                    for triangle in &self.triangles[from..to] {
                        best = best.min(to_triangle(point, triangle));
                    }
                }
                Content::Inner { second } => {
                    let first = number + 1;
                    let near =
                        away(&self.nodes[first].bounds, point) <= away(&self.nodes[second].bounds, point);
                    open.extend(if near { [second, first] } else { [first, second] });
                }
            }
        }
        best
    }
}

fn build(triangles: &mut [[DVec3; 3]], (from, to): (usize, usize), nodes: &mut Vec<Node>) {
    let part = &mut triangles[from..to];
    let bounds = Bounds::of_points(part.iter().flatten().copied());
    let number = nodes.len();
    nodes.push(Node { bounds, content: Content::Leaf { from, to } });
    if part.len() <= FEW {
        return;
    }
    let size = bounds.max - bounds.min;
    let axis = if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = part.len() / 2;
    let place = |triangle: &[DVec3; 3]| triangle.iter().map(|corner| corner[axis]).sum::<f64>();
    part.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
    build(triangles, (from, from + middle), nodes);
    nodes[number].content = Content::Inner { second: nodes.len() };
    build(triangles, (from + middle, to), nodes);
}

fn away(bounds: &Bounds, point: DVec3) -> f64 {
    point.distance(point.clamp(bounds.min, bounds.max))
}

/// Source: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
fn to_triangle(point: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let square = normal.length_squared();
    let inside = |start: &DVec3, end: &DVec3| (end - start).cross(point - start).dot(normal) >= 0.0;
    if square > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        return ((point - a).dot(normal) / square.sqrt()).abs();
    }
    let to_side = |start: &DVec3, end: &DVec3| {
        let along = end - start;
        let square = along.length_squared();
        let part = if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        point.distance(start + along * part)
    };
    to_side(a, b).min(to_side(b, c)).min(to_side(c, a))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Facets, to_triangle};

    #[test]
    fn the_tree_finds_what_looking_at_all_finds() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 40).expect("24 bits")) / 16_777_216.0
        };
        let mut point = || DVec3::new(random(), random(), random());
        let triangles: Vec<[DVec3; 3]> = (0..300)
            .map(|_| {
                let at = point();
                [at, at + point() * 0.1, at + point() * 0.1]
            })
            .collect();
        let facets = Facets::new(triangles.clone());
        for _ in 0..200 {
            let place = point() * 1.4 - 0.2;
            let expected =
                triangles.iter().map(|triangle| to_triangle(place, triangle)).fold(f64::INFINITY, f64::min);
            assert!((facets.distance(place) - expected).abs() < 1e-15);
        }
        assert_eq!(Facets::new(Vec::new()).distance(DVec3::ZERO), f64::INFINITY);
    }
}

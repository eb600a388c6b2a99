//! A tree of boxes over triangles, for questions about what is near.

use glam::DVec3;

use super::index;
use crate::geometry::number::Bounds;

/// A tree of boxes over triangles in the order of their middles.
pub(crate) struct Tree {
    /// Boxes, level by level from the root: node k has children 2 k + 1 and 2 k + 2.
    nodes: Vec<Bounds>,
    boxes: Vec<Bounds>,
    order: Vec<u32>,
    leaves: usize,
}

/// Triangles in a leaf.
const LEAF: usize = 4;

impl Tree {
    pub(crate) fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let boxes: Vec<Bounds> = triangles
            .iter()
            .map(|triangle| Bounds::of_points(triangle.map(|corner| points[corner as usize])))
            .collect();
        let mut order: Vec<u32> = (0..index(triangles.len())).collect();
        let leaves = triangles.len().div_ceil(LEAF).next_power_of_two().max(1);
        let mut nodes = vec![Bounds::EMPTY; 2 * leaves - 1];
        sort(&mut order, &boxes, leaves);
        let mut tree = Self { nodes: Vec::new(), boxes, order, leaves };
        for leaf in 0..leaves {
            let members = tree.members(leaf).iter().map(|triangle| tree.boxes[*triangle as usize]);
            nodes[leaves - 1 + leaf] = members.fold(Bounds::EMPTY, Bounds::union);
        }
        for node in (0..leaves - 1).rev() {
            nodes[node] = nodes[2 * node + 1].union(nodes[2 * node + 2]);
        }
        tree.nodes = nodes;
        tree
    }

    /// The box around all triangles.
    pub(crate) fn bounds(&self) -> Bounds {
        self.nodes[0]
    }

    fn members(&self, leaf: usize) -> &[u32] {
        let count = self.order.len();
        let bound = |leaf: usize| leaf * count / self.leaves;
        &self.order[bound(leaf)..bound(leaf + 1)]
    }

    /// All triangles of greater index whose boxes meet that of a triangle, until `with` says that it is enough.
    pub(crate) fn visit(&self, triangle: u32, mut with: impl FnMut(u32) -> bool) {
        let own = &self.boxes[triangle as usize];
        self.visit_where(|bounds| meet(own, bounds), |other| other <= triangle || with(other));
    }

    /// All triangles whose boxes a straight line meets, until `with` says that it is enough.
    pub(super) fn visit_along(&self, from: DVec3, to: DVec3, with: impl FnMut(u32) -> bool) {
        let way = to - from;
        // As far as the line lies within all three slabs of a box at once; a little more for rounding.
        let meets = |bounds: &Bounds| {
            let (mut enter, mut leave) = (-1e-9_f64, 1.0_f64 + 1e-9);
            for axis in 0..3 {
                let (low, high) = (bounds.min[axis] - from[axis], bounds.max[axis] - from[axis]);
                if way[axis] == 0.0 {
                    if low > 0.0 || high < 0.0 {
                        return false;
                    }
                    continue;
                }
                let (a, b) = (low / way[axis], high / way[axis]);
                enter = enter.max(a.min(b) - 1e-9);
                leave = leave.min(a.max(b) + 1e-9);
            }
            enter <= leave
        };
        self.visit_where(meets, with);
    }

    /// All triangles whose boxes are no further from a point than `reach`, until `with` says that it is enough.
    pub(crate) fn visit_near(&self, point: DVec3, reach: f64, with: impl FnMut(u32) -> bool) {
        self.visit_where(|bounds| gap(bounds, point) <= reach, with);
    }

    /// All triangles whose boxes are as asked for, until `with` says that it is enough.
    fn visit_where(&self, meets: impl Fn(&Bounds) -> bool, mut with: impl FnMut(u32) -> bool) {
        let mut stack = [0_usize; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let node = stack[depth];
            if !meets(&self.nodes[node]) {
                continue;
            }
            if node + 1 < self.leaves {
                stack[depth] = 2 * node + 1;
                stack[depth + 1] = 2 * node + 2;
                depth += 2;
                continue;
            }
            for other in self.members(node + 1 - self.leaves) {
                if meets(&self.boxes[*other as usize]) && !with(*other) {
                    return;
                }
            }
        }
    }

    /// The triangle with the least of some distance, which is never less than that to its box; the first of several.
    pub(crate) fn least(&self, point: DVec3, distance: impl Fn(u32) -> f64) -> Option<(u32, f64)> {
        let mut best: Option<(u32, f64)> = None;
        let mut stack = [(0_usize, 0.0_f64); 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (node, away) = stack[depth];
            if best.is_some_and(|(_, least)| away > least) {
                continue;
            }
            if node + 1 < self.leaves {
                let mut below =
                    [2 * node + 2, 2 * node + 1].map(|node| (node, gap(&self.nodes[node], point)));
                // The nearer one is looked at first.
                below.sort_by(|a, b| b.1.total_cmp(&a.1));
                stack[depth..depth + 2].copy_from_slice(&below);
                depth += 2;
                continue;
            }
            for triangle in self.members(node + 1 - self.leaves) {
                let own = distance(*triangle);
                let nearer = |(known, least): (u32, f64)| own < least || (own == least && *triangle < known);
                if best.is_none_or(nearer) {
                    best = Some((*triangle, own));
                }
            }
        }
        best
    }
}

/// The distance from a point to a box; 0 inside, infinite to an empty one.
fn gap(bounds: &Bounds, point: DVec3) -> f64 {
    if bounds.is_empty() {
        return f64::INFINITY;
    }
    (bounds.min - point).max(point - bounds.max).max(DVec3::ZERO).length()
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

/// Halves the triangles by the middles of their boxes along the longest side, again and again.
fn sort(order: &mut [u32], boxes: &[Bounds], leaves: usize) {
    if leaves <= 1 || order.len() <= 1 {
        return;
    }
    let center = |triangle: &u32| boxes[*triangle as usize].center();
    let all = Bounds::of_points(order.iter().map(center));
    let size = (all.max - all.min).to_array();
    let axis = (1..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    let middle = (leaves / 2) * order.len() / leaves;
    let key = |triangle: &u32| center(triangle).to_array()[axis];
    if middle < order.len() {
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    }
    let (low, high) = order.split_at_mut(middle);
    sort(low, boxes, leaves / 2);
    sort(high, boxes, leaves / 2);
}

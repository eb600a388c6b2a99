//! Where an outline crosses or touches itself.
//!
//! Exact: the test uses the robust orientation predicate of J. Shewchuk, Adaptive precision floating-point
//! arithmetic and fast robust geometric predicates, 1997. Cost: O(n log n) and the pairs whose boxes overlap.

use glam::DVec2;
use robust::{Coord, orient2d};

/// Two segments that meet where they should not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Index of the first segment (from point k to k + 1).
    pub first: usize,
    /// Index of the second segment, greater.
    pub second: usize,
    /// About where they meet.
    pub point: DVec2,
}

/// The first pair of segments, by index, that cross, touch or overlap though they are not neighbours;
/// neighbours count when they fold back onto each other. `closed` adds the segment from the last point to
/// the first.
#[must_use]
pub fn first_crossing(points: &[DVec2], closed: bool) -> Option<Crossing> {
    let count = if closed { points.len() } else { points.len().saturating_sub(1) };
    let segment = |k: usize| (points[k], points[(k + 1) % points.len()]);
    let mut order: Vec<usize> = (0..count).collect();
    let left = |k: usize| segment(k).0.x.min(segment(k).1.x);
    order.sort_by(|a, b| left(*a).total_cmp(&left(*b)));
    let mut found: Option<Crossing> = None;
    let mut active: Vec<usize> = Vec::new();
    for k in order {
        let (a, b) = segment(k);
        active.retain(|other| segment(*other).0.x.max(segment(*other).1.x) >= a.x.min(b.x));
        for &other in &active {
            let (first, second) = (k.min(other), k.max(other));
            let neighbors = second - first == 1 || (closed && first == 0 && second == count - 1);
            if let Some(point) = meeting(segment(first), segment(second), neighbors) {
                let crossing = Crossing { first, second, point };
                if found.is_none_or(|best| (first, second) < (best.first, best.second)) {
                    found = Some(crossing);
                }
            }
        }
        active.push(k);
    }
    found
}

/// Two closed outlines that meet where they should not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the first outline.
    pub first: usize,
    /// Index of the second outline, greater.
    pub second: usize,
    /// About where they meet.
    pub point: DVec2,
}

/// The first pair of closed outlines, by index, that cross or touch. Cost as that of [`first_crossing`].
#[must_use]
pub fn first_contact(outlines: &[Vec<DVec2>]) -> Option<Contact> {
    let mut segments: Vec<(usize, (DVec2, DVec2))> = Vec::new();
    for (owner, points) in outlines.iter().enumerate() {
        let next = points.iter().cycle().skip(1);
        segments.extend(points.iter().zip(next).map(|(a, b)| (owner, (*a, *b))));
    }
    let left = |(_, (a, b)): &(usize, (DVec2, DVec2))| a.x.min(b.x);
    segments.sort_by(|a, b| left(a).total_cmp(&left(b)));
    let mut found: Option<Contact> = None;
    let mut active: Vec<(usize, (DVec2, DVec2))> = Vec::new();
    for segment in segments {
        active.retain(|(_, (a, b))| a.x.max(b.x) >= left(&segment));
        for other in active.iter().filter(|other| other.0 != segment.0) {
            let (one, two) = if other.0 < segment.0 { (*other, segment) } else { (segment, *other) };
            let nearer = found.is_none_or(|best| (one.0, two.0) < (best.first, best.second));
            if let Some(point) = meeting(one.1, two.1, false).filter(|_| nearer) {
                found = Some(Contact { first: one.0, second: two.0, point });
            }
        }
        active.push(segment);
    }
    found
}

/// Whether a closed outline goes around a point; exact unless the point lies on it. O(points).
#[must_use]
pub fn encloses(outline: &[DVec2], point: DVec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    let crosses = |(a, b): (&DVec2, &DVec2)| {
        let upward = a.y <= point.y && b.y > point.y;
        let downward = b.y <= point.y && a.y > point.y;
        (upward && side(*a, *b, point) > 0.0) || (downward && side(*a, *b, point) < 0.0)
    };
    outline.iter().zip(next).filter(|edge| crosses(*edge)).count() % 2 == 1
}

fn side(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

fn within(point: DVec2, (a, b): (DVec2, DVec2)) -> bool {
    point.cmpge(a.min(b)).all() && point.cmple(a.max(b)).all()
}

fn meeting(p: (DVec2, DVec2), q: (DVec2, DVec2), neighbors: bool) -> Option<DVec2> {
    if p.0.max(p.1).cmplt(q.0.min(q.1)).any() || q.0.max(q.1).cmplt(p.0.min(p.1)).any() {
        return None;
    }
    if neighbors {
        return fold(p, q);
    }
    let (a, b) = (side(p.0, p.1, q.0), side(p.0, p.1, q.1));
    let (c, d) = (side(q.0, q.1, p.0), side(q.0, q.1, p.1));
    for (zero, point, segment) in [(a, q.0, p), (b, q.1, p), (c, p.0, q), (d, p.1, q)] {
        if zero == 0.0 && within(point, segment) {
            return Some(point);
        }
    }
    let apart = |x: f64, y: f64| (x > 0.0) == (y > 0.0) || x == 0.0 || y == 0.0;
    if apart(a, b) || apart(c, d) {
        return None;
    }
    Some(q.0 + (q.1 - q.0) * (a / (a - b)))
}

/// Neighbours share one end; they meet elsewhere only when they lie on one line and turn back.
fn fold(p: (DVec2, DVec2), q: (DVec2, DVec2)) -> Option<DVec2> {
    let (shared, back, onward) = if p.1 == q.0 { (p.1, p.0, q.1) } else { (p.0, p.1, q.0) };
    let folded = side(back, shared, onward) == 0.0 && (back - shared).dot(onward - shared) > 0.0;
    folded.then_some(shared)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{encloses, first_contact, first_crossing};

    #[test]
    fn outlines_that_meet_are_told_from_those_inside_and_outside() {
        let square = |x: f64, y: f64, size: f64| {
            outline(&[(x, y), (x + size, y), (x + size, y + size), (x, y + size)])
        };
        let apart = [square(0.0, 0.0, 4.0), square(1.0, 1.0, 1.0), square(2.5, 2.5, 1.0)];
        assert_eq!(first_contact(&apart), None);
        assert!(encloses(&apart[0], apart[1][0]) && !encloses(&apart[1], apart[2][0]));
        assert!(!encloses(&apart[1], apart[0][0]) && !encloses(&apart[1], DVec2::new(0.5, 1.5)));
        let crossing =
            [square(0.0, 0.0, 4.0), square(1.0, 1.0, 1.0), square(1.5, 1.5, 1.0), square(3.5, 3.5, 1.0)];
        let contact = first_contact(&crossing).unwrap();
        assert_eq!((contact.first, contact.second), (0, 3));
        assert_eq!(first_contact(&crossing[1..3]).map(|found| (found.first, found.second)), Some((0, 1)));
        let touching = [square(0.0, 0.0, 1.0), square(1.0, 0.25, 0.5)];
        assert!(
            first_contact(&touching).is_some()
                && first_contact(&[touching[0].clone(), touching[0].clone()]).is_some()
        );
    }

    fn outline(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect()
    }

    #[test]
    fn simple_outlines_do_not_cross() {
        assert_eq!(first_crossing(&outline(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]), true), None);
        assert_eq!(first_crossing(&outline(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0)]), true), None);
    }

    #[test]
    fn bow_tie_touch_and_fold_are_found() {
        let tie = first_crossing(&outline(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]), true).unwrap();
        assert_eq!((tie.first, tie.second, tie.point), (0, 2, DVec2::new(0.5, 0.5)));
        let touch = outline(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        assert!(first_crossing(&touch, true).is_some());
        let fold = outline(&[(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        assert_eq!(first_crossing(&fold, false).map(|found| (found.first, found.second)), Some((0, 1)));
        let open = outline(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, -1.0)]);
        assert_eq!(first_crossing(&open, false).map(|found| (found.first, found.second)), Some((0, 3)));
    }
}

//! Where outlines cross or touch, themselves or each other.

use glam::DVec2;

use super::sweep::sweep;
use super::turn;
use crate::geometry::number::count_of;

/// Two segments of an outline that meet where they should not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Index of the first segment (from point k to k + 1).
    pub first: usize,
    /// Index of the second segment, greater.
    pub second: usize,
    /// About where they meet.
    pub point: DVec2,
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

/// Two segments of an outline that cross, touch or overlap though they are not neighbours; neighbours count when
/// they fold back onto each other. `closed` adds the segment from the last point to the first. Where there are
/// several such pairs, one that is far to the left. O(n log n).
#[must_use]
pub fn first_crossing(points: &[DVec2], closed: bool) -> Option<Crossing> {
    let count = if closed { points.len() } else { points.len().saturating_sub(1) };
    let segments: Vec<[DVec2; 2]> = (0..count).map(|k| [points[k], points[(k + 1) % points.len()]]).collect();
    let neighbors =
        |first: usize, second: usize| second - first == 1 || (closed && first == 0 && second == count - 1);
    let meet = |first: usize, second: usize| {
        let [p, q] = [segments[first], segments[second]];
        let point = if neighbors(first, second) { fold(p, q) } else { meeting(p, q) };
        point.map(|point| Crossing { first, second, point })
    };
    repeated(&segments, |first, second| !neighbors(first, second))
        .map(|(first, second)| Crossing { first, second, point: segments[second][0] })
        .or_else(|| sweep(&segments, meet))
}

/// Two closed outlines that cross or touch. Where there are several, one that is far to the left. O(n log n).
#[must_use]
pub fn first_contact(outlines: &[Vec<DVec2>]) -> Option<Contact> {
    let mut segments: Vec<[DVec2; 2]> = Vec::new();
    let mut owners: Vec<usize> = Vec::new();
    for (owner, points) in outlines.iter().enumerate() {
        let next = points.iter().cycle().skip(1);
        segments.extend(points.iter().zip(next).map(|(a, b)| [*a, *b]));
        owners.resize(segments.len(), owner);
    }
    let contact = |first: usize, second: usize, point: DVec2| {
        let (first, second) = (owners[first].min(owners[second]), owners[first].max(owners[second]));
        Contact { first, second, point }
    };
    let meet = |first: usize, second: usize| {
        let point = meeting(segments[first], segments[second]).filter(|_| owners[first] != owners[second])?;
        Some(contact(first, second, point))
    };
    repeated(&segments, |first, second| owners[first] != owners[second])
        .map(|(first, second)| contact(first, second, segments[second][0]))
        .or_else(|| sweep(&segments, meet))
}

/// Two edges of closed rings that cross, or overlap and run the same way, as the corners (counted through all rings)
/// at which they begin; `None` when all rings are simple and apart.
///
/// Touching at a corner is allowed, as is a corner that lies on another edge without crossing it; edges that run
/// back along each other (the cut of a keyhole polygon) are not crossings. O(n log n).
#[must_use]
pub fn crossing(rings: &[&[DVec2]]) -> Option<[u32; 2]> {
    let mut segments: Vec<[DVec2; 2]> = Vec::new();
    for ring in rings {
        let next = ring.iter().cycle().skip(1);
        segments.extend(ring.iter().zip(next).map(|(a, b)| [*a, *b]));
    }
    crossing_segments(&segments).map(|pair| pair.map(count_of))
}

/// Two segments, by their numbers, that cross, or overlap and run the same way. O(n log n).
#[must_use]
pub fn crossing_segments(segments: &[[DVec2; 2]]) -> Option<[usize; 2]> {
    sweep(segments, |first, second| cross(segments[first], segments[second]).then_some([first, second]))
}

/// Two segments, told of by `counts`, that begin at one place, lesser first.
fn repeated(segments: &[[DVec2; 2]], counts: impl Fn(usize, usize) -> bool) -> Option<(usize, usize)> {
    let mut order: Vec<usize> = (0..segments.len()).collect();
    // Adding zero turns -0 into 0, which the order would put apart.
    let start = |k: usize| segments[k][0] + DVec2::ZERO;
    let by_place = |a: &usize, b: &usize| {
        start(*a).x.total_cmp(&start(*b).x).then(start(*a).y.total_cmp(&start(*b).y)).then(a.cmp(b))
    };
    order.sort_unstable_by(by_place);
    for same in order.chunk_by(|a, b| start(*a) == start(*b)) {
        for (k, &first) in same.iter().enumerate() {
            // Neighbours are few: the second look at most finds one that counts.
            if let Some(&second) = same[k + 1..].iter().find(|&&second| counts(first, second)) {
                return Some((first, second));
            }
        }
    }
    None
}

fn within(point: DVec2, [a, b]: [DVec2; 2]) -> bool {
    point.cmpge(a.min(b)).all() && point.cmple(a.max(b)).all()
}

/// Where two segments have a point in common, one of their ends where there is a choice.
fn meeting(p: [DVec2; 2], q: [DVec2; 2]) -> Option<DVec2> {
    if p[0].max(p[1]).cmplt(q[0].min(q[1])).any() || q[0].max(q[1]).cmplt(p[0].min(p[1])).any() {
        return None;
    }
    let (a, b) = (turn(p[0], p[1], q[0]), turn(p[0], p[1], q[1]));
    let (c, d) = (turn(q[0], q[1], p[0]), turn(q[0], q[1], p[1]));
    for (zero, point, segment) in [(a, q[0], p), (b, q[1], p), (c, p[0], q), (d, p[1], q)] {
        if zero == 0.0 && within(point, segment) {
            return Some(point);
        }
    }
    (opposite(a, b) && opposite(c, d)).then(|| q[0] + (q[1] - q[0]) * (a / (a - b)))
}

fn opposite(x: f64, y: f64) -> bool {
    (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0)
}

/// Neighbours share one end; they meet elsewhere only when they lie on one line and turn back.
fn fold(p: [DVec2; 2], q: [DVec2; 2]) -> Option<DVec2> {
    let (shared, back, onward) = if p[1] == q[0] { (p[1], p[0], q[1]) } else { (p[0], p[1], q[0]) };
    let folded = turn(back, shared, onward) == 0.0 && (back - shared).dot(onward - shared) > 0.0;
    folded.then_some(shared)
}

/// Whether two segments meet in a point that is inside both, or run the same way over a common stretch.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let sides = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
    if opposite(sides[0], sides[1]) && opposite(sides[2], sides[3]) {
        return true;
    }
    sides == [0.0; 4] && a != b && c != d && (b - a).dot(d - c) > 0.0 && overlap([a, b], [c, d])
}

/// Whether two segments on one line share more than a point.
fn overlap([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let wide = (b - a).abs();
    let along = |point: DVec2| if wide.x >= wide.y { point.x } else { point.y };
    let (low, high) = (along(a).min(along(b)), along(a).max(along(b)));
    let (other_low, other_high) = (along(c).min(along(d)), along(c).max(along(d)));
    low.max(other_low) < high.min(other_high)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{cross, crossing, first_contact, first_crossing, meeting};
    use crate::geometry::planar::encloses;

    fn outline(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect()
    }

    fn square(x: f64, y: f64, size: f64) -> Vec<DVec2> {
        outline(&[(x, y), (x + size, y), (x + size, y + size), (x, y + size)])
    }

    #[test]
    fn outlines_that_meet_are_told_from_those_inside_and_outside() {
        let apart = [square(0.0, 0.0, 4.0), square(1.0, 1.0, 1.0), square(2.5, 2.5, 1.0)];
        assert_eq!(first_contact(&apart), None);
        assert!(encloses(&apart[0], apart[1][0]) && !encloses(&apart[1], apart[2][0]));
        assert!(!encloses(&apart[1], apart[0][0]) && !encloses(&apart[1], DVec2::new(0.5, 1.5)));
        let crossing =
            [square(0.0, 0.0, 4.0), square(1.0, 1.0, 1.0), square(1.5, 1.5, 1.0), square(3.5, 3.5, 1.0)];
        assert!(first_contact(&crossing).is_some());
        assert_eq!(first_contact(&crossing[1..3]).map(|found| (found.first, found.second)), Some((0, 1)));
        // An edge on an edge, a corner on an edge, a corner on a corner, the same twice.
        for other in
            [square(1.0, 0.25, 0.5), square(1.0, 0.0, 1.0), square(1.0, 1.0, 1.0), square(0.0, 0.0, 1.0)]
        {
            let pair = [square(0.0, 0.0, 1.0), other];
            assert!(first_contact(&pair).is_some(), "{pair:?}");
            assert!(first_contact(&[pair[1].clone(), pair[0].clone()]).is_some(), "{pair:?}");
        }
    }

    #[test]
    fn simple_outlines_do_not_cross() {
        assert_eq!(first_crossing(&square(0.0, 0.0, 1.0), true), None);
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
        let eight = outline(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 2.0), (1.0, 1.0), (0.0, 2.0)]);
        assert!(first_crossing(&eight, true).is_some(), "it comes to one place twice");
    }

    /// Numbers below `most`, the same in every run.
    fn random(state: &mut u64, most: u32) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(*state >> 33).expect("31 bits") % most)
    }

    /// On small whole coordinates, where touching and collinear segments abound, the sweep finds a pair exactly when
    /// a look at all pairs finds one.
    #[test]
    fn the_sweep_agrees_with_a_look_at_all_pairs() {
        let mut state = 11;
        let (mut crossed, mut apart) = (0, 0);
        for round in 0..20_000u32 {
            let corners = 3 + round % 6;
            let most = 3 + round % 5;
            let rings: Vec<Vec<DVec2>> = (0..1 + round % 2)
                .map(|_| {
                    (0..corners)
                        .map(|_| DVec2::new(random(&mut state, most), random(&mut state, most)))
                        .collect()
                })
                .collect();
            let slices: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
            let segments: Vec<[DVec2; 2]> = rings
                .iter()
                .flat_map(|ring| (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]]))
                .collect();
            let pairs = || (0..segments.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
            let expected = pairs().any(|(a, b)| cross(segments[a], segments[b]));
            let found = crossing(&slices);
            assert_eq!(found.is_some(), expected, "{rings:?}");
            if let Some([a, b]) = found {
                assert!(cross(segments[a as usize], segments[b as usize]));
            }
            if rings.len() == 2 && rings.iter().all(|ring| first_crossing(ring, true).is_none()) {
                let half = rings[0].len();
                let touch = pairs()
                    .filter(|(a, b)| *a < half && *b >= half)
                    .any(|(a, b)| meeting(segments[a], segments[b]).is_some());
                assert_eq!(first_contact(&rings).is_some(), touch, "{rings:?}");
            }
            if expected { crossed += 1 } else { apart += 1 }
        }
        assert!(crossed > 1000 && apart > 1000, "{crossed} {apart}");
    }

    #[test]
    fn a_hundred_thousand_long_segments_are_quick() {
        // A comb whose teeth all lie side by side: every tooth is active at once.
        let mut comb = vec![DVec2::new(-1.0, -1.0)];
        for tooth in 0..100_000u32 {
            let y = f64::from(tooth);
            comb.extend([DVec2::new(1e6, y), DVec2::new(0.0, y + 0.5)]);
        }
        comb.push(DVec2::new(-1.0, 1e6));
        assert_eq!(crossing(&[&comb]), None);
        assert_eq!(first_crossing(&comb, true), None);
    }
}

//! Triangles of a plane that lie on each other.
//!
//! Promise: a pair counts when no line parts the two by all but the depth that is allowed; triangles that touch, or share sides
//! or corners, do not lie on each other. Those without area lie on nothing. Cost: a grid of about as many cells as triangles.
//!
//! Source: two convex polygons are apart when a side of one of them parts them; S. Gottschalk, Separating axis theorem, 1996.

use glam::DVec2;

use crate::geometry::number::{count_of, floor_index};

/// How many pairs of triangles lie on each other more deeply than so much.
#[must_use]
pub fn overlaps(places: &[DVec2], triangles: &[[u32; 3]], depth: f64) -> usize {
    let all: Vec<[DVec2; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|corner| places[corner as usize]))
        .filter_map(|[a, b, c]| match (b - a).perp_dot(c - a) {
            area if area > 0.0 => Some([a, b, c]),
            area if area < 0.0 => Some([a, c, b]),
            _ => None,
        })
        .collect();
    let Some(first) = all.first() else { return 0 };
    let low = all.iter().flatten().fold(first[0], |low, place| low.min(*place));
    let high = all.iter().flatten().fold(first[0], |high, place| high.max(*place));
    let side = floor_index(f64::from(count_of(all.len())).sqrt()).clamp(1, 2048);
    let step = ((high - low).max_element() / f64::from(count_of(side))).max(f64::MIN_POSITIVE);
    let cell = |place: DVec2| {
        let [x, y] = ((place - low) / step).to_array().map(|part| floor_index(part.max(0.0)).min(side - 1));
        (x, y)
    };
    let mut cells: Vec<Vec<usize>> = vec![Vec::new(); side * side];
    let mut count = 0;
    for (number, own) in all.iter().enumerate() {
        let (from, to) = (own[0].min(own[1]).min(own[2]), own[0].max(own[1]).max(own[2]));
        let ((x0, y0), (x1, y1)) = (cell(from), cell(to));
        for y in y0..=y1 {
            for x in x0..=x1 {
                for other in &cells[y * side + x] {
                    let other = &all[*other];
                    let both = from.max(other[0].min(other[1]).min(other[2]));
                    // Of the cells that hold both, in that of the corner of what their boxes share.
                    count += usize::from(
                        cell(both) == (x, y) && !apart(own, other, depth) && !apart(other, own, depth),
                    );
                }
                cells[y * side + x].push(number);
            }
        }
    }
    count
}

/// Whether a side of a triangle has the other one outside of it, but for a depth.
fn apart(one: &[DVec2; 3], other: &[DVec2; 3], depth: f64) -> bool {
    (0..3).any(|k| {
        let (from, to) = (one[k], one[(k + 1) % 3]);
        let along = to - from;
        let most = other.iter().map(|place| along.perp_dot(*place - from)).fold(f64::NEG_INFINITY, f64::max);
        most <= depth * along.length()
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::overlaps;

    fn sheet(side: u32) -> (Vec<DVec2>, Vec<[u32; 3]>) {
        let places = (0..=side)
            .flat_map(|y| (0..=side).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
            .collect();
        let corner = |x: u32, y: u32| y * (side + 1) + x;
        let square = |x: u32, y: u32| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b, c], [a, d, c]]
        };
        (places, (0..side).flat_map(|y| (0..side).flat_map(move |x| square(x, y))).collect())
    }

    #[test]
    fn neighbors_touch_and_what_is_laid_twice_overlaps() {
        let (places, triangles) = sheet(9);
        // Triangles of either turn.
        assert_eq!(overlaps(&places, &triangles, 0.0), 0);
        let twice = [triangles.as_slice(), &triangles].concat();
        assert_eq!(overlaps(&places, &twice, 0.0), triangles.len());
        // A large triangle over all of it, and a line over it.
        let mut more = places.clone();
        more.extend([[-20.0, -20.0], [40.0, -20.0], [4.0, 60.0]].map(DVec2::from_array));
        let over = [triangles.as_slice(), &[[100, 101, 102], [0, 99, 0]]].concat();
        assert_eq!(overlaps(&more, &over, 0.0), triangles.len());
    }

    #[test]
    fn depth_is_how_far_one_would_have_to_move() {
        let pair = |by: f64| {
            let places =
                [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0 - by, 0.0], [2.0 - by, 0.0], [2.0 - by, 1.0]];
            let places: Vec<DVec2> = places.map(DVec2::from_array).to_vec();
            move |depth: f64| overlaps(&places, &[[0, 1, 2], [3, 5, 4]], depth)
        };
        let deep = pair(0.01);
        assert_eq!((deep(0.0), deep(0.005), deep(0.011)), (1, 1, 0));
        assert_eq!(pair(-0.01)(0.0), 0);
    }
}

//! How far surfaces are from each other.
//!
//! Promise: the greatest distance of a surface from another lies between the two numbers that are told; they are as close
//! together as was asked, unless the work passes its limit.
//! No promise: surfaces are sheets without sides; what lies on both by different triangles has the distance 0.
//!
//! Source: M. Tang, M. Lee, Y. Kim, Interactive Hausdorff Distance Computation for General Polygonal Models, 2009 (branch
//! and bound over triangles); distances change by no more than one moves, which bounds them between samples.
//!
//! Cost: a tree of boxes, O(n log n); then a search for each point, and more in triangles that may be the farthest.

use std::collections::BTreeSet;

use glam::DVec3;
use rayon::prelude::{
    IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator,
};

use super::nearest::nearest_of_triangle;
use super::tree::Tree;

/// Most searches for one triangle: what is left of it then counts as far away as it may be.
const MOST: usize = 1 << 14;

/// Triangles of points, and where to find them.
pub struct Sheet {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tree: Tree,
}

/// The greatest distance of one surface from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Farthest {
    /// It is no less.
    pub at_least: f64,
    /// It is no more.
    pub at_most: f64,
    /// Where it is at least that.
    pub place: DVec3,
}

impl Sheet {
    /// A surface; every corner is the index of a point. None without triangles.
    #[must_use]
    pub fn new(points: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Option<Self> {
        let tree = Tree::new(&points, &triangles);
        (!triangles.is_empty()).then_some(Self { points, triangles, tree })
    }

    /// The triangles' corners.
    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|corner| self.points[corner as usize])
    }

    /// How far a point is from the nearest place.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(point).0
    }

    /// How far a point is from the nearest place, and in which triangle that lies.
    fn nearest(&self, point: DVec3) -> (f64, u32) {
        let found = self.tree.least(point, |triangle| self.square(point, triangle).sqrt());
        let (triangle, distance) = found.expect("a sheet has triangles");
        (distance, triangle)
    }

    /// The square of a point's distance from a triangle.
    fn square(&self, point: DVec3, triangle: u32) -> f64 {
        let corners = self.corners(self.triangles[triangle as usize]);
        nearest_of_triangle(corners, point).distance_squared(point)
    }

    /// Whether a point lies inside of this surface, which is to be closed: a ray from it leaves more often than it enters.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        /// Directions of no symmetry; the next is tried where a ray meets an edge.
        const RAYS: [[f64; 3]; 4] =
            [[0.36, 0.48, 0.81], [-0.71, 0.23, 0.67], [0.19, -0.88, 0.43], [0.53, 0.61, -0.59]];
        let bounds = self.tree.bounds();
        let reach = 2.0 * (bounds.diagonal() + point.distance(bounds.center()));
        let crossings = |ray: DVec3| {
            let (mut count, mut clear) = (0_u32, true);
            self.tree.visit_along(point, point + ray, |triangle| {
                if let Some(inside) = met(self.corners(self.triangles[triangle as usize]), point, ray) {
                    (count, clear) = (count + 1, inside);
                }
                clear
            });
            clear.then_some(count)
        };
        RAYS.iter()
            .find_map(|ray| crossings(DVec3::from_array(*ray) * reach))
            .is_some_and(|count| count % 2 == 1)
    }

    /// The greatest distance of this surface from another, within `accuracy`.
    #[must_use]
    pub fn farthest_from(&self, other: &Self, accuracy: f64) -> Farthest {
        self.farthest(other, accuracy, |_| true)
    }

    /// The greatest distance of this surface from a closed one where it lies outside of that, within `accuracy`.
    #[must_use]
    pub fn farthest_outside(&self, body: &Self, accuracy: f64) -> Farthest {
        self.farthest(body, accuracy, |place| !body.contains(place))
    }

    fn farthest(&self, other: &Self, accuracy: f64, counts: impl Fn(DVec3) -> bool + Sync) -> Farthest {
        let common: BTreeSet<[[u64; 3]; 3]> =
            other.triangles.iter().map(|triangle| name(other.corners(*triangle))).collect();
        let own: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .copied()
            .filter(|triangle| !common.contains(&name(self.corners(*triangle))))
            .collect();
        let none =
            Farthest { at_least: 0.0, at_most: 0.0, place: self.points[self.triangles[0][0] as usize] };
        let mut used: Vec<u32> = own.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let known: Vec<(f64, u32)> =
            used.par_iter().map(|corner| other.nearest(self.points[*corner as usize])).collect();
        // What all triangles begin with is the same for any number of threads.
        let start = used.iter().zip(&known).fold(none, |best, (corner, (distance, _))| {
            let place = self.points[*corner as usize];
            if *distance > best.at_least && counts(place) { best.or(*distance, place) } else { best }
        });
        let nearest = |corner: u32| used.binary_search(&corner).map_or(0, |place| known[place].1);
        let found = own.into_par_iter().with_min_len(16).map(|triangle| {
            let corners = self.corners(triangle);
            let bounds = triangle.map(|corner| other.farthest_corner(corners, nearest(corner)));
            let most = bounds.into_iter().fold(f64::INFINITY, f64::min);
            if most <= start.at_least + accuracy {
                return Farthest { at_most: most, ..start };
            }
            within(corners, other, (start, accuracy), &counts)
        });
        let found = found.reduce(|| start, Farthest::with);
        Farthest { at_most: found.at_most.max(found.at_least), ..found }
    }

    /// The distance of a triangle's farthest corner from one of this surface's triangles. No place of it is further from the
    /// surface: the distance from one triangle is a convex function, which is greatest at a corner.
    fn farthest_corner(&self, corners: [DVec3; 3], triangle: u32) -> f64 {
        corners.iter().map(|corner| self.square(*corner, triangle)).fold(0.0, f64::max).sqrt()
    }
}

/// A triangle by its corners, wherever it begins.
fn name(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    let mut all = corners.map(|corner| (corner + 0.0).to_array().map(f64::to_bits));
    all.sort_unstable();
    all
}

impl Farthest {
    fn or(self, distance: f64, place: DVec3) -> Self {
        if distance > self.at_least { Self { at_least: distance, place, ..self } } else { self }
    }

    /// The farther of both; of two that are alike the one whose place comes first.
    fn with(self, other: Self) -> Self {
        let order = self.at_least.total_cmp(&other.at_least).then_with(|| {
            let places = other.place.to_array().into_iter().zip(self.place.to_array());
            places
                .map(|(a, b)| a.total_cmp(&b))
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let farther = if order.is_ge() { self } else { other };
        Self { at_most: self.at_most.max(other.at_most), ..farther }
    }
}

/// Where a ray meets a triangle: whether inside of it, away from its edges; none where it passes by.
///
/// Source: T. Möller, B. Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
fn met([a, b, c]: [DVec3; 3], start: DVec3, ray: DVec3) -> Option<bool> {
    /// Shares of sides that may be rounding.
    const EDGE: f64 = 1e-9;
    let (ab, ac) = (b - a, c - a);
    let across = ray.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from = start - a;
    let over = from.cross(ab);
    let (u, v) = (from.dot(across) / determinant, ray.dot(over) / determinant);
    let least = u.min(v).min(1.0 - u - v);
    (ac.dot(over) / determinant > 0.0 && least >= -EDGE).then_some(least > EDGE)
}

/// The farthest place of a triangle that counts, if it is farther than what is known by more than the accuracy. Places that do
/// not count lie on the other side of the surface from those that do.
fn within(
    corners: [DVec3; 3],
    other: &Sheet,
    (start, accuracy): (Farthest, f64),
    counts: &impl Fn(DVec3) -> bool,
) -> Farthest {
    let mut best = start;
    let mut left = vec![corners];
    let mut searches = 0;
    while let Some([a, b, c]) = left.pop() {
        let middle = (a + b + c) / 3.0;
        let reach = [a, b, c].iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let (distance, nearest) = other.nearest(middle);
        searches += 1;
        let mut most = (distance + reach).min(other.farthest_corner([a, b, c], nearest));
        if counts(middle) {
            best = best.or(distance, middle);
        } else {
            // The way from here to a place that counts leads through the surface.
            most = most.min(reach - distance);
        }
        if most <= best.at_least + accuracy || searches >= MOST {
            best.at_most = best.at_most.max(most);
            continue;
        }
        let [ab, bc, ca] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
        left.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    best
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Sheet;

    fn square(height: f64, side: f64) -> Sheet {
        let points =
            [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, z]| DVec3::new(x, height, z));
        Sheet::new(points.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    /// Numbers that repeat from run to run.
    fn numbers() -> impl FnMut() -> f64 {
        let mut seed = 7_u64;
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    #[test]
    fn closed_forms_lie_between_the_two_numbers() {
        let accuracy = 1e-3;
        let cases = [
            (square(0.0, 1.0), square(0.25, 1.0), 0.25),
            // The far corner of the larger square.
            (square(0.0, 2.0), square(0.0, 1.0), 2.0_f64.sqrt()),
            (square(0.0, 1.0), square(0.0, 2.0), 0.0),
            (square(0.0, 1.0), square(0.0, 1.0), 0.0),
        ];
        for (one, other, exact) in cases {
            let found = one.farthest_from(&other, accuracy);
            assert!(found.at_least <= exact + 1e-12 && exact <= found.at_most + 1e-12, "{found:?} {exact}");
            assert!(found.at_most - found.at_least <= accuracy, "{found:?}");
            assert!((other.distance(found.place) - found.at_least).abs() < 1e-12);
        }
    }

    /// A cube of side 2 about the origin, outward.
    fn cube(middle: DVec3) -> Sheet {
        let side = |bit: u32, k: u32| if k & bit == 0 { -1.0 } else { 1.0 };
        let points = (0..8).map(|k| middle + DVec3::new(side(1, k), side(2, k), side(4, k))).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        Sheet::new(points, faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
            .unwrap()
    }

    #[test]
    fn only_what_lies_outside_counts() {
        let cube_here = cube(DVec3::ZERO);
        let mut next = numbers();
        for _ in 0..500 {
            let point = DVec3::new(next(), next(), next()) * 4.0 - 2.0;
            assert_eq!(cube_here.contains(point), point.abs().max_element() < 1.0, "{point}");
        }
        // Rays through edges and corners too.
        assert!(cube_here.contains(DVec3::ZERO) && !cube_here.contains(DVec3::new(0.0, -3.0, 0.0)));
        // Half of the moved cube is inside, its far side half a side out.
        let found = cube(DVec3::new(0.5, 0.0, 0.0)).farthest_outside(&cube_here, 1e-3);
        assert!(found.at_least <= 0.5 + 1e-12 && found.at_most >= 0.5 && found.at_most < 0.502, "{found:?}");
        let small = cube(DVec3::ZERO);
        let shrunk =
            Sheet::new(small.points.iter().map(|point| *point * 0.5).collect(), small.triangles).unwrap();
        assert_eq!(shrunk.farthest_outside(&cube_here, 1e-3).at_most, 0.0);
        assert!(shrunk.farthest_from(&cube_here, 1e-3).at_least >= 0.5);
    }

    /// The farthest place of a roof lies inside its triangles, where no corner is.
    #[test]
    fn a_place_inside_a_triangle_is_found() {
        let points =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 1.0], [0.5, -0.3, 0.33]].map(DVec3::from_array);
        let flat = Sheet::new(points.to_vec(), vec![[0, 1, 2]]).unwrap();
        let bent = Sheet::new(points.to_vec(), vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
        let found = flat.farthest_from(&bent, 1e-4);
        let mut next = numbers();
        let mut sampled = 0.0_f64;
        for _ in 0..20_000 {
            let (mut a, mut b) = (next(), next());
            if a + b > 1.0 {
                (a, b) = (1.0 - a, 1.0 - b);
            }
            sampled = sampled.max(bent.distance(points[0] * (1.0 - a - b) + points[1] * a + points[2] * b));
        }
        assert!(
            sampled > 0.1 && sampled <= found.at_most && found.at_least > sampled - 1e-3,
            "{found:?} {sampled}"
        );
    }

    /// The tree finds what trying all triangles finds.
    #[test]
    fn the_nearest_is_the_nearest_of_all() {
        let mut next = numbers();
        let points: Vec<DVec3> = (0..300).map(|_| DVec3::new(next(), next(), next())).collect();
        let triangles: Vec<[u32; 3]> = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let all = Sheet::new(points.clone(), triangles.clone()).unwrap();
        let alone: Vec<Sheet> =
            triangles.iter().map(|triangle| Sheet::new(points.clone(), vec![*triangle]).unwrap()).collect();
        for _ in 0..200 {
            let point = DVec3::new(next(), next(), next()) * 3.0 - 1.0;
            let least = alone.iter().map(|one| one.distance(point)).fold(f64::INFINITY, f64::min);
            assert!((all.distance(point) - least).abs() < 1e-12);
        }
    }
}

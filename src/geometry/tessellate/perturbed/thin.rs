//! Fewer triangles of a filled face.
//!
//! Triangles that are Delaunay in the plane of the rays are long and thin on steep parts of the surface, and points that
//! were added where nothing was known yet stay. Here points inside of a face are drawn into neighbors, and edges turned,
//! as long as every new triangle keeps the tolerance and its sense in the plane: so the face stays one sheet over its
//! polygon. Work is done in rounds of changes that do not touch each other, so that its result is the same for any number
//! of threads.
//!
//! Source: H. Hoppe and others, Mesh optimization, SIGGRAPH 1993 (edge collapse and
//! swap); here accepted by a proved bound in place of an energy.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::judge::FaceChart;
use crate::geometry::mesh::index;
use crate::geometry::planar::turn;
use crate::geometry::tessellate::region::Chart as _;

/// Rounds of each kind.
const ROUNDS: u32 = 48;
/// The share of the tolerance that changes may use in the first rounds: what is least needed goes first.
const FIRST: f64 = 0.125;

/// A face while points are taken from it.
struct Thinning<'a> {
    chart: FaceChart<'a>,
    /// Of each local point its place, its point in space, and whether it stays.
    places: Vec<DVec2>,
    points: Vec<DVec3>,
    border: Vec<bool>,
    /// Corners as local points; `NONE` where a triangle is gone.
    triangles: Vec<[u32; 3]>,
    bounds: Vec<f64>,
    /// Whether a triangle has changed since its edges were last looked at.
    fresh: Vec<bool>,
}

const NONE: u32 = u32::MAX;

/// A point and the neighbor that it is drawn into, with the greatest bound of the triangles that this makes.
#[derive(Clone, Copy, Debug)]
struct Draw {
    bound: f64,
    point: u32,
    into: u32,
}

/// An edge that is turned: the triangles at it, what they become, and how much better the worse of them gets.
struct Turn {
    share: f64,
    pair: [u32; 2],
    new: [[u32; 3]; 2],
    bounds: [f64; 2],
}

/// Takes points from the triangles of a face. What lies on the border, by the names of points, stays. The greatest bound of
/// the triangles that are left.
pub(super) fn thin(
    chart: FaceChart<'_>,
    (triangles, places): (&mut Vec<[u32; 3]>, &BTreeMap<u32, DVec2>),
    points: &[DVec3],
    border: &BTreeSet<u32>,
    tolerance: f64,
) -> f64 {
    let names: Vec<u32> = places.keys().copied().collect();
    let local: BTreeMap<u32, u32> = names.iter().enumerate().map(|(k, name)| (*name, index(k))).collect();
    let mut thinning = Thinning {
        chart,
        places: places.values().copied().collect(),
        points: names.iter().map(|name| points[*name as usize]).collect(),
        border: names.iter().map(|name| border.contains(name)).collect(),
        triangles: triangles.iter().map(|corners| corners.map(|corner| local[&corner])).collect(),
        bounds: Vec::new(),
        fresh: vec![true; triangles.len()],
    };
    thinning.bounds = thinning.triangles.par_iter().map(|corners| thinning.bound(*corners)).collect();
    thinning.run(tolerance);
    let alive = thinning.triangles.iter().filter(|corners| corners[0] != NONE);
    *triangles = alive.map(|corners| corners.map(|corner| names[corner as usize])).collect();
    let alive = thinning.triangles.iter().zip(&thinning.bounds).filter(|(corners, _)| corners[0] != NONE);
    alive.map(|(_, bound)| *bound).fold(0.0, f64::max)
}

impl Thinning<'_> {
    fn run(&mut self, tolerance: f64) {
        let mut known: Vec<Option<Draw>> = vec![None; self.places.len()];
        let mut changed: Vec<u32> = (0..index(self.places.len())).collect();
        let mut share = FIRST;
        for _ in 0..ROUNDS {
            let stars = self.stars();
            let found: Vec<(u32, Option<Draw>)> =
                changed.par_iter().map(|point| (*point, self.best_draw(*point, &stars, tolerance))).collect();
            for (point, draw) in found {
                known[point as usize] = draw;
            }
            let drawn = self.draw(&mut known, &stars, share * tolerance);
            let turned = self.turn_edges(tolerance);
            if drawn.is_empty() && turned.is_empty() && share >= 1.0 {
                break;
            }
            share = (share * 1.5).min(1.0);
            changed = drawn.into_iter().chain(turned).collect::<BTreeSet<u32>>().into_iter().collect();
        }
    }

    /// A bound on a triangle; infinite where it has no area in the plane or turns over.
    fn bound(&self, corners: [u32; 3]) -> f64 {
        const THIN: f64 = 1e-6;
        let places = corners.map(|corner| self.places[corner as usize]);
        let [a, b, c] = places;
        let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
        if turn(a, b, c) <= THIN * longest {
            return f64::INFINITY;
        }
        self.chart.judge(places, corners.map(|corner| self.points[corner as usize])).bound
    }

    /// The triangles around each point.
    fn stars(&self) -> Vec<Vec<u32>> {
        let mut stars = vec![Vec::new(); self.places.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for corner in corners.iter().filter(|corner| **corner != NONE) {
                stars[*corner as usize].push(index(triangle));
            }
        }
        stars
    }

    fn best_draw(&self, point: u32, stars: &[Vec<u32>], tolerance: f64) -> Option<Draw> {
        let star = &stars[point as usize];
        if self.border[point as usize] || star.is_empty() {
            return None;
        }
        let place = self.points[point as usize];
        let mut ring = self.ring(point, star);
        // The nearest first: that mostly is the best.
        let far = |other: &u32| self.points[*other as usize].distance_squared(place);
        ring.sort_by(|a, b| far(a).total_cmp(&far(b)).then(a.cmp(b)));
        let mut best: Option<Draw> = None;
        for into in ring {
            let limit = best.map_or(tolerance, |draw| draw.bound);
            let mut bound: f64 = 0.0;
            for corners in self.drawn(point, into, star) {
                bound = bound.max(self.bound(corners));
                if bound > limit {
                    break;
                }
            }
            if bound <= limit && best.is_none_or(|draw| bound < draw.bound) {
                best = Some(Draw { bound, point, into });
            }
        }
        best
    }

    /// Points around a point.
    fn ring(&self, point: u32, star: &[u32]) -> Vec<u32> {
        let corners = star.iter().flat_map(|triangle| self.triangles[*triangle as usize]);
        let ring: BTreeSet<u32> = corners.filter(|corner| *corner != point).collect();
        ring.into_iter().collect()
    }

    /// Triangles that drawing a point into another leaves around it.
    fn drawn<'b>(&'b self, point: u32, into: u32, star: &'b [u32]) -> impl Iterator<Item = [u32; 3]> + 'b {
        let kept = star.iter().map(|triangle| self.triangles[*triangle as usize]);
        let kept = kept.filter(move |corners| !corners.contains(&into));
        kept.map(move |corners| corners.map(|corner| if corner == point { into } else { corner }))
    }

    /// Draws points into others, the least needed first, as long as changes do not touch. The points around them.
    fn draw(&mut self, known: &mut [Option<Draw>], stars: &[Vec<u32>], tolerance: f64) -> BTreeSet<u32> {
        let mut all: Vec<Draw> =
            known.iter().flatten().copied().filter(|draw| draw.bound <= tolerance).collect();
        all.sort_by(|a, b| a.bound.total_cmp(&b.bound).then(a.point.cmp(&b.point)));
        let mut touched = vec![false; self.places.len()];
        let mut around = BTreeSet::new();
        for draw in all {
            let star = &stars[draw.point as usize];
            let ring = self.ring(draw.point, star);
            if touched[draw.point as usize] || ring.iter().any(|other| touched[*other as usize]) {
                continue;
            }
            for triangle in star {
                let slot = *triangle as usize;
                let corners = self.triangles[slot];
                if corners.contains(&draw.into) {
                    self.triangles[slot] = [NONE; 3];
                    continue;
                }
                self.triangles[slot] =
                    corners.map(|corner| if corner == draw.point { draw.into } else { corner });
                self.bounds[slot] = self.bound(self.triangles[slot]);
                self.fresh[slot] = true;
            }
            touched[draw.point as usize] = true;
            known[draw.point as usize] = None;
            for other in ring {
                touched[other as usize] = true;
                around.insert(other);
            }
        }
        around
    }

    /// Turns edges between two triangles where that makes the worse of them better. The points around them.
    fn turn_edges(&mut self, tolerance: f64) -> BTreeSet<u32> {
        let alive = self.triangles.iter().enumerate().filter(|(_, corners)| corners[0] != NONE);
        let edges = alive.flat_map(|(triangle, corners)| {
            let [a, b, c] = *corners;
            [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], index(triangle)))
        });
        let mut edges: Vec<([u32; 2], u32)> = edges.collect();
        edges.sort_unstable();
        // Only where a triangle is near the tolerance something is gained, and only where one is new something is found.
        let worth = |triangle: u32| self.bounds[triangle as usize] > 0.4 * tolerance;
        let fresh = |triangle: u32| self.fresh[triangle as usize];
        let either = |[a, b]: [u32; 2]| (worth(a) || worth(b)) && (fresh(a) || fresh(b));
        let inner: Vec<([u32; 2], [u32; 2])> = edges
            .windows(2)
            .filter(|pair| pair[0].0 == pair[1].0 && either([pair[0].1, pair[1].1]))
            .map(|pair| (pair[0].0, [pair[0].1, pair[1].1]))
            .collect();
        let judged: Vec<Turn> = inner
            .par_iter()
            .filter_map(|(edge, pair)| {
                let old = pair.map(|triangle| self.bounds[triangle as usize]);
                let worse = old[0].max(old[1]);
                let new = self.turned(*edge, *pair)?;
                let first = self.bound(new[0]);
                if first >= 0.9 * worse {
                    return None;
                }
                let second = self.bound(new[1]);
                let bounds = [first, second];
                (second < 0.9 * worse).then(|| Turn {
                    share: first.max(second) / worse,
                    pair: *pair,
                    new,
                    bounds,
                })
            })
            .collect();
        self.fresh.fill(false);
        let mut order: Vec<usize> = (0..judged.len()).collect();
        order.sort_by(|a, b| judged[*a].share.total_cmp(&judged[*b].share).then(a.cmp(b)));
        let mut touched = BTreeSet::new();
        let mut around = BTreeSet::new();
        for at in order {
            let Turn { pair, new, bounds, .. } = judged[at];
            if pair.iter().any(|triangle| touched.contains(triangle)) {
                continue;
            }
            for k in 0..2 {
                self.triangles[pair[k] as usize] = new[k];
                self.bounds[pair[k] as usize] = bounds[k];
                self.fresh[pair[k] as usize] = true;
                touched.insert(pair[k]);
                around.extend(new[k]);
            }
        }
        around
    }

    /// The two triangles on the other diagonal of a quadrilateral.
    fn turned(&self, edge: [u32; 2], pair: [u32; 2]) -> Option<[[u32; 3]; 2]> {
        let [one, other] = pair.map(|triangle| self.triangles[triangle as usize]);
        let from = (0..3).find(|k| edge.contains(&one[*k]) && edge.contains(&one[(*k + 1) % 3]))?;
        let (a, b, c) = (one[from], one[(from + 1) % 3], one[(from + 2) % 3]);
        let d = other.into_iter().find(|corner| !edge.contains(corner))?;
        Some([[a, d, c], [d, b, c]])
    }
}

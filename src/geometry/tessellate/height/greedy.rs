//! Triangles that follow a field within a tolerance: the place of the greatest error becomes a corner, again and again.
//!
//! Source: M. Garland and P. Heckbert, "Fast polygonal approximation of terrains and height fields", Carnegie Mellon
//! University CMU-CS-95-181, 1995. Theirs looks at the samples; with `everywhere` the edges are looked at too, which
//! proves the bound between the samples (see [`scan`](super::scan)), and corners may stand between samples.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::{
    IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator,
};

use super::chain::{Chain, Side};
use super::delaunay::{BORDER, Delaunay, Place, next};
use super::drawn::Tangled;
use super::ground::{Ground, Value};
use super::lattice::Lattice;
use super::region::{Keep, Region, rim_edges};
use super::round::{Round, draw_fixed};
use super::scan::{Corner, Worst, edge, nodes};

/// What is asked of the triangles.
pub(super) struct Goal<'r> {
    /// Greatest error, the lattice's slack already taken off.
    pub(super) tolerance: f64,
    /// Whether it holds between the nodes too.
    pub(super) everywhere: bool,
    /// Most triangles.
    pub(super) limit: u64,
    /// What is kept; everything without it.
    pub(super) region: Option<(&'r Region, Keep)>,
    /// How the map closes in itself.
    pub(super) round: Round,
    /// A base, how far below it heights are raised to it, and how near to it corners on lines are set on it.
    pub(super) floor: Option<Floor>,
}

/// A base on which a region may end.
#[derive(Clone, Copy)]
pub(super) struct Floor {
    pub(super) base: f64,
    pub(super) below: f64,
    pub(super) near: f64,
}

/// Why there are no triangles.
pub(super) enum RefineError {
    /// So many are too many.
    TooMany(u64),
    /// Lines of the region could not be drawn.
    Tangled,
    /// Nothing is kept.
    Empty,
}

impl Floor {
    pub(super) fn raised(floor: Option<Self>, height: f64) -> f64 {
        match floor {
            Some(floor) if height < floor.base && height >= floor.base - floor.below => floor.base,
            _ => height,
        }
    }

    pub(super) fn on_line(floor: Option<Self>, height: f64) -> f64 {
        match floor {
            Some(floor) if (height - floor.base).abs() <= floor.near => floor.base,
            _ => Self::raised(floor, height),
        }
    }
}

/// Triangles over a field.
pub(super) struct Triangles<V = f64> {
    pub(super) mesh: Delaunay,
    pub(super) heights: Vec<V>,
    /// How far they are from the lattice's function, its borders left out; at the nodes alone, unless everywhere.
    pub(super) error: f64,
}

/// A triangle in need of a corner.
struct Need {
    error: f64,
    triangle: u32,
    version: u32,
    place: [f64; 2],
}

impl PartialEq for Need {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Need {}

impl PartialOrd for Need {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Need {
    fn cmp(&self, other: &Self) -> Ordering {
        let later = other.triangle.cmp(&self.triangle).then(other.version.cmp(&self.version));
        self.error.total_cmp(&other.error).then(later)
    }
}

struct Greedy<'l, G: Ground> {
    lattice: &'l Lattice<'l, G>,
    goal: &'l Goal<'l>,
    made: Triangles<G::Value>,
    versions: Vec<u32>,
    errors: Vec<f64>,
    needs: BinaryHeap<Need>,
}

/// Refines until the goal is met.
pub(super) fn refine<G: Ground>(
    lattice: &Lattice<'_, G>,
    chains: &[Chain; 4],
    goal: &Goal<'_>,
) -> Result<Triangles<G::Value>, RefineError> {
    let mut greedy = Greedy {
        lattice,
        goal,
        made: begun(lattice, chains, goal)?,
        versions: Vec::new(),
        errors: Vec::new(),
        needs: BinaryHeap::new(),
    };
    let all: Vec<u32> = (0..greedy.made.mesh.triangles()).collect();
    let found: Vec<Worst> = all.par_iter().with_min_len(16).map(|triangle| greedy.judge(*triangle)).collect();
    greedy.versions.resize(all.len(), 0);
    greedy.errors.resize(all.len(), 0.0);
    for (triangle, worst) in all.into_iter().zip(found) {
        greedy.note(triangle, worst);
    }
    greedy.run().map_err(RefineError::TooMany)?;
    let mut made = greedy.made;
    made.error = greedy.errors.into_iter().fold(0.0, f64::max);
    Ok(made)
}

/// Triangles between the borders and lines alone.
pub(super) fn begun<G: Ground>(
    lattice: &Lattice<'_, G>,
    chains: &[Chain; 4],
    goal: &Goal<'_>,
) -> Result<Triangles<G::Value>, RefineError> {
    let mut mesh = Delaunay::new(lattice.far());
    draw_borders(&mut mesh, lattice, chains);
    draw_fixed(&mut mesh, &goal.round.lines).map_err(|Tangled| RefineError::Tangled)?;
    let mut on_line = vec![false; mesh.places.len()];
    if let Some((region, keep)) = goal.region {
        let any = region.draw(&mut mesh, lattice, keep).map_err(|_| RefineError::Tangled)?;
        if !any {
            return Err(RefineError::Empty);
        }
        goal.round.share(&mut mesh);
        on_line.resize(mesh.places.len(), false);
        rim_edges(&mesh).flatten().for_each(|corner| on_line[corner as usize] = true);
    }
    let height = |(place, on_line): (&Place, &bool)| lattice.standing(*place, goal.floor, *on_line);
    let heights = mesh.places.iter().zip(&on_line).map(height).collect();
    Ok(Triangles { mesh, heights, error: 0.0 })
}

fn draw_borders<G: Ground>(mesh: &mut Delaunay, lattice: &Lattice<'_, G>, chains: &[Chain; 4]) {
    let scale = f64::from(lattice.units) * f64::from(lattice.refine);
    for (side, chain) in Side::ALL.into_iter().zip(chains) {
        let mut near = 0;
        for along in &chain.steps {
            let place = side.at(lattice.ground.grid(), *along).map(|step| whole(step * scale));
            if mesh.insert(place, near).is_some() {
                near = mesh.changed[0];
            }
        }
    }
}

impl<G: Ground> Greedy<'_, G> {
    fn run(&mut self) -> Result<(), u64> {
        while let Some(need) = self.needs.pop() {
            let at = need.triangle as usize;
            if self.versions[at] != need.version {
                continue;
            }
            if !self.insert(&need) {
                // No place is left near by: what remains is told, and the caller tries a finer lattice.
                self.errors[at] = need.error;
                continue;
            }
            let count = self.made.mesh.triangles();
            if u64::from(count) > self.goal.limit {
                return Err(u64::from(count));
            }
            self.versions.resize(count as usize, 0);
            self.errors.resize(count as usize, 0.0);
            for k in 0..self.made.mesh.changed.len() {
                let triangle = self.made.mesh.changed[k];
                let worst = self.judge(triangle);
                self.versions[triangle as usize] += 1;
                self.note(triangle, worst);
            }
            if self.versions[at] == need.version {
                // The new corner stands beside it and has changed others: the next try finds another place.
                self.needs.push(need);
            }
        }
        Ok(())
    }

    /// Sets a corner at or near the place that needs one.
    fn insert(&mut self, need: &Need) -> bool {
        let far = self.lattice.far();
        // The border has its own corners already, and so have rings around poles.
        let [first, last] = self.goal.round.rows(far);
        if far[0] < 2 || last < first {
            return false;
        }
        let inside = |place: Place| [place[0].clamp(1, far[0] - 1), place[1].clamp(first, last)];
        let middle = need.place.map(whole);
        let around = [(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        let near = around.map(|(dx, dy)| inside([middle[0] + dx, middle[1] + dy]));
        let center = inside(self.center(need.triangle).map(whole));
        for place in near.into_iter().chain([center]) {
            if self.made.mesh.insert(place, need.triangle).is_some() {
                self.made.heights.push(self.lattice.standing(place, self.goal.floor, false));
                return true;
            }
        }
        false
    }

    /// The center of the circle through the corners of a triangle: inside of it stands no corner.
    fn center(&self, triangle: u32) -> [f64; 2] {
        let [a, b, c] = self.corners(triangle).map(|(place, _)| place.map(f64::from));
        let (b, c) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let twice = 2.0 * (b[0] * c[1] - b[1] * c[0]);
        let (bb, cc) = (b[0] * b[0] + b[1] * b[1], c[0] * c[0] + c[1] * c[1]);
        [a[0] + (c[1] * bb - b[1] * cc) / twice, a[1] + (b[0] * cc - c[0] * bb) / twice]
    }

    fn note(&mut self, triangle: u32, worst: Worst) {
        if worst.error > self.goal.tolerance {
            let version = self.versions[triangle as usize];
            self.needs.push(Need { error: worst.error, triangle, version, place: worst.place });
            self.errors[triangle as usize] = 0.0;
        } else {
            self.errors[triangle as usize] = worst.error;
        }
    }

    fn corners(&self, triangle: u32) -> [Corner<G::Value>; 3] {
        self.made.corners(triangle)
    }

    /// The greatest error of a triangle: at the nodes first, since a node is the better corner.
    fn judge(&self, triangle: u32) -> Worst {
        if !self.made.mesh.keeps(triangle) || self.goal.round.at_pole(&self.made.mesh, triangle) {
            return Worst::NONE;
        }
        let worst = nodes(self.lattice, self.corners(triangle));
        if !self.goal.everywhere || worst.error > self.goal.tolerance {
            return worst;
        }
        let along = self.made.along_edges(self.lattice, triangle);
        if along.error > worst.error { along } else { worst }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "saturates; places are clamped into the lattice")]
pub(super) fn whole(number: f64) -> i32 {
    number.round() as i32
}

impl<V: Value> Triangles<V> {
    /// Makes every node of the lattice a corner that lies in what is kept: coarse ones first, so that no triangle is
    /// walked through often.
    pub(super) fn insert_nodes<G: Ground<Value = V>>(&mut self, lattice: &Lattice<'_, G>, goal: &Goal<'_>) {
        let (columns, rows) = (lattice.columns, lattice.rows);
        let mut step = columns.max(rows).next_power_of_two();
        let mut near = 0;
        while step > 0 {
            for j in (0..rows).step_by(step) {
                for i in (0..columns).step_by(step) {
                    if i % (2 * step) == 0 && j % (2 * step) == 0 && step < columns.max(rows) {
                        continue;
                    }
                    let place = [i, j].map(|node| whole(node as f64).saturating_mul(lattice.units));
                    if self.mesh.insert(place, near).is_some() {
                        self.heights.push(lattice.standing(place, goal.floor, false));
                        near = self.mesh.changed[0];
                    }
                }
            }
            step /= 2;
        }
    }

    pub(super) fn corners(&self, triangle: u32) -> [Corner<V>; 3] {
        self.mesh.corners_of(triangle).map(|corner| {
            let at = corner as usize;
            (self.mesh.places[at], self.heights[at])
        })
    }

    /// The greatest error along the edges of a triangle that have a triangle beyond and bound nothing.
    fn along_edges<G: Ground<Value = V>>(&self, lattice: &Lattice<'_, G>, triangle: u32) -> Worst {
        let mut worst = Worst::NONE;
        for side in 3 * triangle..3 * triangle + 3 {
            if self.mesh.beyond(side) == BORDER || self.mesh.line(side) != 0 {
                continue;
            }
            let [from, to] = [side, next(side)].map(|side| {
                let corner = self.mesh.corners[side as usize] as usize;
                (self.mesh.places[corner], self.heights[corner])
            });
            let found = edge(lattice, from, to);
            if found.error > worst.error {
                worst = found;
            }
        }
        worst
    }

    /// The greatest error along the edges that bound what is kept.
    pub(super) fn along_rims<G: Ground<Value = V>>(&self, lattice: &Lattice<'_, G>) -> f64 {
        let corner = |corner: u32| (self.mesh.places[corner as usize], self.heights[corner as usize]);
        let errors = rim_edges(&self.mesh).map(|[from, to]| edge(lattice, corner(from), corner(to)).error);
        errors.fold(0.0, f64::max)
    }

    /// The greatest error everywhere but at the border, measured anew.
    pub(super) fn measure<G: Ground<Value = V>>(&self, lattice: &Lattice<'_, G>) -> f64 {
        let of = |triangle: u32| {
            if !self.mesh.keeps(triangle) {
                return 0.0;
            }
            let inside = nodes(lattice, self.corners(triangle)).error;
            inside.max(self.along_edges(lattice, triangle).error)
        };
        (0..self.mesh.triangles()).into_par_iter().with_min_len(256).map(of).reduce(|| 0.0, f64::max)
    }
}

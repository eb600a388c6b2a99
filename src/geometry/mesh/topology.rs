//! Topology of an index buffer: closed, manifold, components, Euler number, genus, boundary.
//!
//! Exact: no coordinate is read. Callers merge equal positions first; vertices that stand on one position are one
//! *point* here. Most meshes are oriented surfaces, and a quick proof of that (`surface`) comes first; the general
//! way follows where it fails. A *corner* is a place in the index buffer, and names the edge that leaves it: corner
//! `3t` of triangle (a, b, c) is the edge a-b. Edges of one pair of points are paired by bucketing all corners under
//! the lower of their two points and sorting each bucket by the higher, so nothing is hashed.

mod surface;

use serde::Serialize;

use crate::geometry::mesh::index;

/// A corner without a partner.
const NONE: u32 = u32::MAX;
/// Marks in a key that the edge runs from its higher to its lower point.
const BACKWARD: u64 = 1 << 31;

/// What [`measure`] finds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Topology {
    /// Points that a triangle uses.
    pub points: u64,
    /// Different pairs of points that an edge joins.
    pub edges: u64,
    /// Triangles.
    pub triangles: u64,
    /// Each edge is used equally often in both directions.
    pub closed: bool,
    /// Each edge is used exactly once in each direction, and the triangles around each point form one fan.
    pub manifold: bool,
    /// Sets of triangles joined through shared edges.
    pub components: u64,
    /// Points - edges + triangles.
    pub euler: i64,
    /// Handles, summed over all components; only for manifold meshes.
    pub genus: Option<u64>,
    /// Edges that exactly one triangle uses.
    pub boundary_edges: u64,
    /// Closed chains of boundary edges.
    pub boundary_loops: u64,
    /// Edges that more than two triangles use.
    pub crowded_edges: u64,
    /// Edges that two triangles use in the same direction: neighbours of opposite orientation.
    pub misoriented_edges: u64,
    /// Fans of triangles beyond one at each point: where parts touch at a point only.
    pub extra_fans: u64,
}

/// More corners or points than the keys can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{triangles} triangles are more than topology can be measured for ({})", i32::MAX / 3)]
pub struct TooLarge {
    /// How many triangles there are.
    pub triangles: usize,
}

/// Measures the triangles whose `3 * triangles` corners stand on `point_of(corner)`, each below `points`.
///
/// Edges that join a point to itself are left out. Linear in time (sorting the edges of one point adds a logarithm
/// of their number); at its peak about 43 bytes for each triangle.
///
/// # Errors
/// [`TooLarge`] from 2^31 / 3 triangles on.
pub fn measure(
    triangles: usize,
    points: usize,
    point_of: impl Fn(usize) -> u32,
) -> Result<Topology, TooLarge> {
    if triangles > i32::MAX as usize / 3 {
        return Err(TooLarge { triangles });
    }
    let mut topology = match surface::of_surface(triangles, points, &point_of) {
        Some(topology) => topology,
        None => of_any(triangles, points, &point_of),
    };
    topology.euler = signed(topology.points) - signed(topology.edges) + signed(topology.triangles);
    topology.genus = if topology.manifold {
        u64::try_from(signed(topology.components) - topology.euler / 2).ok()
    } else {
        None
    };
    Ok(topology)
}

/// Measures any triangles, but for the Euler number and the genus.
fn of_any(triangles: usize, points: usize, point_of: &impl Fn(usize) -> u32) -> Topology {
    let mut topology = Topology { triangles: triangles as u64, ..Topology::default() };
    let mut joined = Joined::new(triangles);
    let pairing = pair(&mut topology, &mut joined, points, (triangles, point_of));
    topology.components = joined.sets();
    drop(joined);
    count_fans(&mut topology, &pairing);
    count_boundary_loops(&mut topology, &pairing);
    let paired = topology.boundary_edges + topology.crowded_edges + topology.misoriented_edges == 0;
    topology.manifold = topology.closed && paired && pairing.self_edges == 0 && topology.extra_fans == 0;
    topology
}

/// Measures an index buffer.
///
/// # Errors
/// [`TooLarge`]; see [`measure`].
pub fn of_triangles(triangles: &[[u32; 3]], points: usize) -> Result<Topology, TooLarge> {
    measure(triangles.len(), points, |corner| triangles[corner / 3][corner % 3])
}

fn signed(count: u64) -> i64 {
    i64::try_from(count).expect("counts are below 2^33")
}

/// The corner after a corner in its triangle.
fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// The corner before a corner in its triangle.
fn before(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

/// Which edges run back along which.
struct Pairing {
    /// For each corner the corner of the one edge that runs back along its edge, else [`NONE`].
    twins: Vec<u32>,
    /// Corners whose edges no other triangle uses.
    boundary: Vec<u32>,
    /// Edges that join a point to itself.
    self_edges: u64,
}

/// All edges by their lower point: `keys[starts[p]..starts[p + 1]]` holds (higher point, direction, corner).
struct Buckets {
    starts: Vec<u32>,
    keys: Vec<u64>,
    self_edges: u64,
    points: u64,
}

impl Buckets {
    fn new(points: usize, triangles: usize, point_of: &impl Fn(usize) -> u32) -> Self {
        let mut starts = vec![0_u32; points + 1];
        let mut used = vec![false; points];
        let mut self_edges = 0;
        for triangle in 0..triangles {
            for [a, b] in edges_of(triangle, point_of) {
                used[a as usize] = true;
                if a == b {
                    self_edges += 1;
                } else {
                    starts[a.min(b) as usize] += 1;
                }
            }
        }
        let mut total = 0;
        for start in &mut starts {
            // Each entry ends as the end of its bucket; filling backwards turns it into the start.
            total += *start;
            *start = total;
        }
        let mut keys = vec![0_u64; total as usize];
        let mut corner = 0_u64;
        for triangle in 0..triangles {
            for [a, b] in edges_of(triangle, point_of) {
                if a != b {
                    let place = &mut starts[a.min(b) as usize];
                    *place -= 1;
                    let direction = if a > b { BACKWARD } else { 0 };
                    keys[*place as usize] = u64::from(a.max(b)) << 32 | direction | corner;
                }
                corner += 1;
            }
        }
        let points = used.into_iter().filter(|&used| used).count() as u64;
        Self { starts, keys, self_edges, points }
    }
}

/// The edges of a triangle in the order of their corners.
#[inline]
fn edges_of(triangle: usize, point_of: &impl Fn(usize) -> u32) -> [[u32; 2]; 3] {
    let [a, b, c] = [0, 1, 2].map(|step| point_of(3 * triangle + step));
    [[a, b], [b, c], [c, a]]
}

fn pair(
    topology: &mut Topology,
    joined: &mut Joined,
    points: usize,
    (triangles, point_of): (usize, &impl Fn(usize) -> u32),
) -> Pairing {
    let mut buckets = Buckets::new(points, triangles, point_of);
    topology.points = buckets.points;
    let mut pairing =
        Pairing { twins: vec![NONE; 3 * triangles], boundary: Vec::new(), self_edges: buckets.self_edges };
    topology.closed = true;
    for point in 0..points {
        let bucket = &mut buckets.keys[buckets.starts[point] as usize..buckets.starts[point + 1] as usize];
        sort_short(bucket);
        for uses in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            pairing.add_edge(topology, joined, uses);
        }
    }
    pairing
}

/// Sorts keys; buckets mostly hold a handful.
fn sort_short(keys: &mut [u64]) {
    if keys.len() > 20 {
        keys.sort_unstable();
        return;
    }
    for end in 1..keys.len() {
        let key = keys[end];
        let mut place = end;
        while place > 0 && keys[place - 1] > key {
            keys[place] = keys[place - 1];
            place -= 1;
        }
        keys[place] = key;
    }
}

/// The corner in a key.
fn corner_in(key: u64) -> u32 {
    (key & (BACKWARD - 1)) as u32
}

impl Pairing {
    /// Takes in all uses of one edge, forward ones first.
    fn add_edge(&mut self, topology: &mut Topology, joined: &mut Joined, uses: &[u64]) {
        topology.edges += 1;
        match *uses {
            [only] => {
                topology.boundary_edges += 1;
                topology.closed = false;
                self.boundary.push(corner_in(only));
            }
            [first, second] => {
                let (first_corner, second_corner) = (corner_in(first), corner_in(second));
                joined.join(first_corner / 3, second_corner / 3);
                if (first ^ second) & BACKWARD == 0 {
                    topology.misoriented_edges += 1;
                    topology.closed = false;
                } else {
                    self.twins[first_corner as usize] = second_corner;
                    self.twins[second_corner as usize] = first_corner;
                }
            }
            _ => {
                topology.crowded_edges += 1;
                let backward = uses.iter().filter(|&&key| key & BACKWARD != 0).count();
                topology.closed &= 2 * backward == uses.len();
                for pair in uses.windows(2) {
                    joined.join(corner_in(pair[0]) / 3, corner_in(pair[1]) / 3);
                }
            }
        }
    }
}

/// Sets, by union-find.
struct Joined(Vec<u32>);

impl Joined {
    /// This many sets of one each.
    fn new(count: usize) -> Self {
        Self((0..index(count)).collect())
    }

    /// Adds a set of one.
    fn add(&mut self) -> u32 {
        let one = index(self.0.len());
        self.0.push(one);
        one
    }

    fn find(&mut self, mut one: u32) -> u32 {
        loop {
            let above = self.0[one as usize];
            if above == one {
                return one;
            }
            let top = self.0[above as usize];
            self.0[one as usize] = top;
            one = top;
        }
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.0[a.max(b) as usize] = a.min(b);
        }
    }

    fn sets(&self) -> u64 {
        self.0.iter().zip(0..).filter(|&(&above, one)| above == one).count() as u64
    }
}

/// A set of corners.
struct Marks(Vec<u64>);

impl Marks {
    fn new(count: usize) -> Self {
        Self(vec![0; count / 64 + 1])
    }

    /// Marks a corner; whether it was not marked before.
    fn mark(&mut self, corner: u32) -> bool {
        let word = &mut self.0[corner as usize / 64];
        let bit = 1 << (corner % 64);
        let fresh = *word & bit == 0;
        *word |= bit;
        fresh
    }
}

/// Counts fans. The corner after `c` counter-clockwise around its point is the twin of the edge before `c`; an open
/// fan begins at a corner whose own edge has no twin, the other fans are cycles.
fn count_fans(topology: &mut Topology, pairing: &Pairing) {
    let twins = &pairing.twins;
    let mut seen = Marks::new(twins.len());
    let mut fans = 0_u64;
    let mut walk = |start: u32| {
        let mut corner = start;
        while corner != NONE && seen.mark(corner) {
            corner = twins[before(corner) as usize];
        }
    };
    for (corner, &twin) in (0..).zip(twins) {
        if twin == NONE {
            fans += 1;
            walk(corner);
        }
    }
    for corner in 0..index(twins.len()) {
        if seen.0[corner as usize / 64] & (1 << (corner % 64)) == 0 {
            fans += 1;
            let mut at = corner;
            while seen.mark(at) {
                at = twins[before(at) as usize];
            }
        }
    }
    topology.extra_fans = fans - topology.points.min(fans);
}

/// Counts the loops of edges without twins that hold a boundary edge. After an edge comes the first edge without a
/// twin met when turning around its end through its own triangles: fans that touch at a point are taken apart.
fn count_boundary_loops(topology: &mut Topology, pairing: &Pairing) {
    if pairing.boundary.is_empty() {
        return;
    }
    let mut seen = Marks::new(pairing.twins.len());
    for &start in &pairing.boundary {
        let mut corner = start;
        let mut fresh = false;
        while seen.mark(corner) {
            fresh = true;
            corner = next(corner);
            while pairing.twins[corner as usize] != NONE {
                corner = next(pairing.twins[corner as usize]);
            }
        }
        topology.boundary_loops += u64::from(fresh);
    }
}

#[cfg(test)]
mod tests;

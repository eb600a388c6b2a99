//! The order of triangles and vertices.
//!
//! Promise: for drawing, the triangles of each run come in an order in which vertices are seldom transformed twice, and those
//! that look outward before those that look inward, so that what is hidden is drawn late; for packing, in strips. Vertices stand in the order of
//! their first use. Each triangle keeps its corners, its turn and its run; the result does not depend on the number of
//! threads. Source: P. Sander, D. Nehab, J. Barczak, Fast triangle reordering for vertex locality and reduced
//! overdraw, 2007; boundaries between clusters as meshoptimizer draws them.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::{ParallelIterator, ParallelSliceMut};

use super::band::bands;
use crate::geometry::mesh;
use crate::geometry::mesh::cache::{FIFO_SIZE, FifoCache};
use crate::geometry::mesh::{Mesh, VertexIndex};
use crate::packing::{order_for_cache, order_for_strips};
use crate::scene::Geometry;

/// Overdraw may cost this part of the misses of the cache.
const THRESHOLD: f64 = 1.05;

/// Triangles that are ordered together: few enough for a processor's cache, and many for the other's.
const PIECE: usize = 1 << 14;

/// As [`PIECE`], for strips: what follows a border between pieces is told anew, which makes bytes longer.
const STRIP_PIECE: usize = 1 << 19;

/// Triangles below which one thread orders everything: to wake another takes longer.
const ONE_THREAD: usize = 100_000;

/// Misses for each triangle that are good enough not to look for a better order: 0.5 is the least of a large mesh.
const GOOD: f64 = 0.7;

/// Misses for each triangle above which the pieces of a run are ordered together.
const FAIR: f64 = 0.9;

/// As [`FAIR`], for strips, which use the cache less.
const FAIR_STRIPS: f64 = 1.3;

/// What the order of triangles is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// For drawing: few vertices are transformed twice, what is hidden is drawn late.
    Drawing,
    /// For the shortest bytes: each triangle goes on from the one before.
    Packing,
}

/// Orders triangles and vertices. O(triangles + vertices), 20 to 60 ns a triangle; 8 bytes a vertex on top.
pub(super) fn order(geometry: &mut Geometry, order: Order) {
    let mesh = &mut geometry.mesh;
    if mesh.triangles.is_empty() {
        return;
    }
    let parallel = mesh.triangles.len() > ONE_THREAD;
    let place = |vertex: VertexIndex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()];
    let mut rest = mesh.triangles.as_mut_slice();
    let mut start = 0;
    for run in &mesh.runs {
        let (own, after) = rest.split_at_mut((run.end - start) as usize);
        order_run(own, &place, (order, parallel));
        (rest, start) = (after, run.end);
    }
    order_vertices(geometry);
}

/// Orders triangles whose vertices stand where `place` says. O(triangles), 20 to 60 ns each; memory for vertices is that of
/// the greatest index.
pub fn order_triangles(triangles: &mut [[VertexIndex; 3]], place: Place<'_>, order: Order) {
    if !triangles.is_empty() {
        let parallel = triangles.len() > ONE_THREAD;
        order_run(triangles, place, (order, parallel));
    }
}

fn order_run(run: &mut [[VertexIndex; 3]], place: Place<'_>, (order, parallel): (Order, bool)) {
    let count = run.len();
    let length = match order {
        Order::Drawing => PIECE,
        Order::Packing => STRIP_PIECE,
    };
    let of = |piece: &mut [[VertexIndex; 3]]| match order {
        Order::Drawing => order_piece(piece, place),
        Order::Packing => strip_piece(piece),
    };
    let misses: u32 = if parallel {
        run.par_chunks_mut(length).map(of).sum()
    } else {
        run.chunks_mut(length).map(of).sum()
    };
    let fair = match order {
        Order::Drawing => FAIR,
        Order::Packing => FAIR_STRIPS,
    };
    // Where neighbors do not come together, most are in another piece.
    if count > length && f64::from(misses) > fair * count as f64 {
        of(run);
    }
}

/// Puts triangles into strips and tells how many vertices are transformed for them.
fn strip_piece(piece: &mut [[VertexIndex; 3]]) -> u32 {
    let local = Local::of(piece);
    let mut indices: Vec<u32> = piece.iter().flatten().map(|vertex| local.name(*vertex)).collect();
    order_for_strips(&mut indices, local.len());
    let mut cache = FifoCache::new(local.len());
    let mut misses = 0;
    for (to, from) in piece.iter_mut().zip(indices.as_chunks::<3>().0) {
        misses += cache.misses_of(*from);
        *to = from.map(|name| local.vertex(name));
    }
    misses
}

/// Where a vertex stands.
pub type Place<'a> = &'a (dyn Fn(VertexIndex) -> DVec3 + Sync);

/// Orders triangles and tells how many vertices are transformed for them.
fn order_piece(piece: &mut [[VertexIndex; 3]], place: Place<'_>) -> u32 {
    let local = Local::of(piece);
    let mut cache = FifoCache::new(local.len());
    let bands = bands(piece);
    let mut misses: u32 =
        bands.triangles.iter().map(|at| cache.misses_of(at.map(|vertex| local.name(vertex)))).sum();
    let (ordered, clusters) = if f64::from(misses) <= GOOD * piece.len() as f64 {
        (bands.triangles, bands.clusters)
    } else {
        let mut indices: Vec<u32> = piece.iter().flatten().map(|vertex| local.name(*vertex)).collect();
        order_for_cache(&mut indices, local.len(), FIFO_SIZE);
        let triangles = indices.as_chunks::<3>().0;
        let clusters;
        (clusters, misses) = self::clusters(triangles, local.len());
        (triangles.iter().map(|triangle| triangle.map(|name| local.vertex(name))).collect(), clusters)
    };
    let mut to = 0;
    for cluster in outward_first(&ordered, clusters, place) {
        piece[to..to + cluster.len()].copy_from_slice(&ordered[cluster.clone()]);
        to += cluster.len();
    }
    misses
}

/// Short names for the vertices of a piece, so that tables of them are small.
enum Local {
    /// They lie close together: counted from the first.
    Near { first: u32, len: usize },
    /// They are scattered: their places among those that are used.
    Far(Vec<u32>),
}

impl Local {
    fn of(piece: &[[VertexIndex; 3]]) -> Self {
        let all = || piece.iter().flatten().map(|vertex| vertex.0);
        let (first, last) = (all().min().unwrap_or(0), all().max().unwrap_or(0));
        let len = (last - first) as usize + 1;
        if len <= 4 * piece.len().max(PIECE) {
            return Self::Near { first, len };
        }
        let mut used: Vec<u32> = all().collect();
        used.sort_unstable();
        used.dedup();
        Self::Far(used)
    }

    fn len(&self) -> usize {
        match self {
            Self::Near { len, .. } => *len,
            Self::Far(used) => used.len(),
        }
    }

    fn name(&self, vertex: VertexIndex) -> u32 {
        match self {
            Self::Near { first, .. } => vertex.0 - first,
            Self::Far(used) => mesh::index(used.partition_point(|other| *other < vertex.0)),
        }
    }

    fn vertex(&self, name: u32) -> VertexIndex {
        VertexIndex(match self {
            Self::Near { first, .. } => first + name,
            Self::Far(used) => used[name as usize],
        })
    }
}

/// Triangles of a cluster that are asked where they look.
const SAMPLES: usize = 16;

/// The most outward cluster first.
fn outward_first(
    triangles: &[[VertexIndex; 3]],
    clusters: Vec<Range<usize>>,
    place: Place<'_>,
) -> impl Iterator<Item = Range<usize>> {
    let (mut middle, mut weight) = (DVec3::ZERO, 0.0);
    let sums: Vec<(DVec3, DVec3, f64)> = clusters
        .iter()
        .map(|cluster| {
            let (mut centroid, mut normal, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            let some = cluster.len().div_ceil(SAMPLES);
            for triangle in triangles[cluster.clone()].iter().step_by(some) {
                let [a, b, c] = triangle.map(place);
                let cross = (b - a).cross(c - a);
                let size = cross.length();
                centroid += (a + b + c) * (size / 3.0);
                normal += cross;
                area += size;
            }
            middle += centroid;
            weight += area;
            (centroid, normal, area)
        })
        .collect();
    middle /= f64::max(weight, f64::MIN_POSITIVE);
    let mut keyed: Vec<(f64, Range<usize>)> = sums
        .into_iter()
        .zip(clusters)
        .map(|((centroid, normal, area), cluster)| {
            let outward =
                (centroid / f64::max(area, f64::MIN_POSITIVE) - middle).dot(normal.normalize_or_zero());
            (outward, cluster)
        })
        .collect();
    keyed.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    keyed.into_iter().map(|(_, cluster)| cluster)
}

/// Neighboring triangles that are drawn one after the other. A cluster begins where the cache holds no corner of a triangle, and wherever so far it missed no more than a
/// little above the average, so that a break costs little.
fn clusters(triangles: &[[u32; 3]], vertices: usize) -> (Vec<Range<usize>>, u32) {
    let mut cache = FifoCache::new(vertices);
    let misses: Vec<u32> = triangles.iter().map(|triangle| cache.misses_of(*triangle)).collect();
    let all_missed = |(at, misses): (usize, &u32)| (at == 0 || *misses == 3).then_some(at);
    let hard: Vec<usize> = misses.iter().enumerate().filter_map(all_missed).collect();
    let mut starts = Vec::with_capacity(hard.len());
    for (place, &start) in hard.iter().enumerate() {
        let end = hard.get(place + 1).copied().unwrap_or(triangles.len());
        let total: u32 = misses[start..end].iter().sum();
        let allowed = THRESHOLD * f64::from(total) / (end - start) as f64;
        let before = starts.len();
        starts.push(start);
        cache.forget();
        let (mut missed, mut faces) = (0, 0);
        for (at, triangle) in triangles[start..end].iter().enumerate() {
            missed += cache.misses_of(*triangle);
            faces += 1;
            if f64::from(missed) <= allowed * f64::from(faces) {
                starts.push(start + at + 1);
                cache.forget();
                (missed, faces) = (0, 0);
            }
        }
        // The last cluster is what was left over: it stays with the one before it.
        if starts.len() > before + 1 {
            starts.pop();
        }
    }
    let ends = starts.iter().copied().skip(1).chain([triangles.len()]);
    let clusters = starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect();
    (clusters, misses.iter().sum())
}

/// Vertices in the order of their first use.
fn order_vertices(geometry: &mut Geometry) {
    let mesh: &mut Mesh = &mut geometry.mesh;
    const UNSEEN: u32 = u32::MAX;
    let mut places = vec![UNSEEN; mesh.vertices.len()];
    let mut order = Vec::with_capacity(mesh.vertices.len());
    for vertex in mesh.triangles.iter_mut().flatten() {
        let place = &mut places[vertex.subscript()];
        if *place == UNSEEN {
            *place = mesh::index(order.len());
            order.push(vertex.0);
        }
        *vertex = VertexIndex(*place);
    }
    if let Some(tangents) = &mut geometry.tangents {
        *tangents = order.iter().map(|vertex| tangents[*vertex as usize]).collect();
    }
    if let Some(lightmap) = &mut geometry.lightmap {
        rearrange(&mut lightmap.places, order.clone());
    }
    for target in &mut geometry.targets {
        if let Some(tangents) = &mut target.tangents {
            *tangents = order.iter().map(|vertex| tangents[*vertex as usize]).collect();
        }
        rearrange(&mut target.normals, order.clone());
    }
    rearrange(&mut mesh.vertices, order);
}

/// Puts at each place what `order` says, in place: vertices are large, and memory must be cleared before it is used.
fn rearrange<T: Copy>(all: &mut Vec<T>, mut order: Vec<u32>) {
    let kept = order.len();
    const DONE: u32 = u32::MAX;
    for start in 0..kept {
        let mut to = start;
        let held = all[start];
        while order[to] != DONE {
            let from = order[to] as usize;
            order[to] = DONE;
            all[to] = if from == start { held } else { all[from] };
            to = from;
        }
    }
    all.truncate(kept);
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{Order, PIECE, order};
    use crate::geometry::mesh;
    use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
    use crate::geometry::tessellate::{Deviation, Evidence};
    use crate::report::facts::vertex_cache;
    use crate::scene::Geometry;

    /// A sheet of quadrilaterals, row by row, with the second half of its rows in a run of its own.
    fn sheet(across: u32, rows: u32) -> Geometry {
        let mut mesh = Mesh::default();
        for row in 0..=rows {
            for column in 0..=across {
                let point = PointIndex(mesh::index(mesh.points.len()));
                mesh.points.push(DVec3::new(f64::from(column), 0.0, f64::from(row)));
                mesh.vertices.push(Vertex {
                    point,
                    normal: DVec3::Y,
                    uv: DVec2::new(f64::from(column), f64::from(row)),
                    color: Color::WHITE,
                    anchor: Anchor { source: 0, u: f64::from(column), v: f64::from(row) },
                });
            }
        }
        for row in 0..rows {
            for column in 0..across {
                let at = row * (across + 1) + column;
                let [a, b, c, d] = [at, at + 1, at + across + 2, at + across + 1].map(VertexIndex);
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let half = across * (rows / 2) * 2;
        mesh.runs = vec![Run { origin: 0, end: half }, Run { origin: 1, end: across * rows * 2 }];
        geometry(mesh)
    }

    fn geometry(mesh: Mesh) -> Geometry {
        let tangents = mesh.vertices.iter().map(|vertex| [vertex.point.0 as f32, 0.0, 0.0, 1.0]).collect();
        Geometry {
            name: "sheet".to_owned(),
            mesh,
            wire: mesh::Wire::default(),
            uv: true,
            colored: false,
            tangents: Some(tangents),
            parts: Vec::new(),
            lightmap: None,
            attributes: Vec::new(),
            influences: None,
            targets: Vec::new(),
            deviation: Deviation { bound: 0.0, evidence: Evidence::Exact },
            tolerance: None,
        }
    }

    /// For each run its triangles as what stands at their corners, sorted.
    fn corners(geometry: &Geometry) -> Vec<Vec<[(u32, u32); 3]>> {
        let mesh = &geometry.mesh;
        let tangents = geometry.tangents.as_ref().expect("the sheet has tangents");
        let mut start = 0;
        mesh.runs
            .iter()
            .map(|run| {
                let of = |vertex: &VertexIndex| {
                    let known = mesh.vertices[vertex.subscript()];
                    assert_eq!(mesh.points[known.point.subscript()].x, known.anchor.u);
                    (known.point.0, tangents[vertex.subscript()][0].to_bits())
                };
                let turned = |triangle: &[VertexIndex; 3]| {
                    let all = [0, 1, 2].map(|corner| of(&triangle[corner]));
                    let least = (0..3).min_by_key(|corner| all[*corner]).unwrap_or(0);
                    [0, 1, 2].map(|step| all[(least + step) % 3])
                };
                let mut all: Vec<_> = mesh.triangles[start..run.end as usize].iter().map(turned).collect();
                start = run.end as usize;
                all.sort_unstable();
                all
            })
            .collect()
    }

    fn misses(geometry: &Geometry) -> f64 {
        let indices: Vec<[u8; 4]> =
            geometry.mesh.triangles.iter().flatten().map(|vertex| vertex.0.to_le_bytes()).collect();
        vertex_cache(&indices, geometry.mesh.vertices.len()).acmr
    }

    #[test]
    fn every_run_keeps_its_triangles_and_vertices_stand_as_they_are_first_used() {
        for (across, rows) in [(1, 1), (1, 2), (40, 30), (200, 3), (3, 300), (150, 150)] {
            let mut made = sheet(across, rows);
            if rows == 1 {
                made.mesh.runs.remove(0);
            }
            let before = corners(&made);
            for way in [Order::Drawing, Order::Packing] {
                order(&mut made, way);
                assert_eq!(corners(&made), before, "{across} x {rows}");
                let mut next = 0;
                for vertex in made.mesh.triangles.iter().flatten() {
                    assert!(vertex.0 <= next, "a vertex stands before its first use");
                    next = next.max(vertex.0 + 1);
                }
            }
        }
    }

    #[test]
    fn few_vertices_are_transformed_twice_in_whatever_order_triangles_come() {
        let mut rows = sheet(300, 100);
        let (before, triangles) = (misses(&rows), rows.mesh.triangles.len());
        assert!(triangles > 3 * PIECE && before > 1.0, "{before}");
        order(&mut rows, Order::Drawing);
        assert!(misses(&rows) < 0.7, "{}", misses(&rows));
        // A linear congruence puts every triangle, and every vertex, far from its neighbors.
        let mut mixed = sheet(300, 100);
        mixed.mesh.runs.remove(0);
        mixed.mesh.triangles = (0..triangles).map(|at| mixed.mesh.triangles[at * 7919 % triangles]).collect();
        assert!(misses(&mixed) > 2.5);
        order(&mut mixed, Order::Drawing);
        assert!(misses(&mixed) < 0.75, "{}", misses(&mixed));
    }
}

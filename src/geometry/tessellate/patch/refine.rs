//! Splits the triangles that are not yet within the tolerance, without cracks.
//!
//! Sides are marked, not triangles: every triangle with a marked side is split there, whoever marked it, so
//! neighbours always agree. A triangle with one marked side becomes two, with two three, with three four.

use std::collections::HashMap;

use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::judge::halfway;
use super::net::{Judged, Net};
use super::rows::{Corner, Free};
use crate::geometry::mesh::index;
use crate::geometry::tessellate::{Detail, Deviation, TessellateError};

/// Rounds after which a surface is as rough as its samples: each round halves sides.
const ROUNDS: usize = 24;

/// Times the triangles of the plan, and triangles on top of them, after which refining has no end: a surface that folds
/// in its own plane has a line along which no triangle is good. The bound then says what is left.
const MOST: (u64, u64) = (64, 50_000);

/// Triangles that are judged before their verdicts are put together.
const AT_ONCE: usize = 1 << 14;

/// Triangles that one thread judges before it looks for others.
const APIECE: usize = 32;

/// Sides that bend by this share of the worst are split with it.
const LIKE_THE_WORST: f64 = 0.55;

/// Refines until every triangle is within the tolerance, or has no end; gives the bound of all.
pub(super) fn refine(
    net: &mut Net<'_>,
    tolerance: f64,
    detail: &Detail,
) -> Result<Deviation, TessellateError> {
    let mut deviation = Deviation::NONE;
    let most = net.triangles().saturating_mul(MOST.0).saturating_add(MOST.1);
    // Triangles that have not been judged, by block.
    let mut fresh: Vec<Vec<u32>> =
        net.pieces.iter().map(|piece| (0..index(piece.triangles.len())).collect()).collect();
    for round in 0..=ROUNDS {
        let mut marks: HashMap<(u32, u32), u32> = HashMap::new();
        let mut good = Deviation::NONE;
        let mut failed = Deviation::NONE;
        let mut kept: Vec<(usize, u32, Deviation)> = Vec::new();
        for (block, list) in fresh.iter().enumerate() {
            let triangles = &net.pieces[block].triangles;
            for part in list.chunks(AT_ONCE) {
                let verdict = |number: &u32| net.judge(block, &triangles[*number as usize], tolerance);
                let judged: Vec<Judged> = part.par_iter().with_min_len(APIECE).map(verdict).collect();
                for (number, judged) in part.iter().zip(judged) {
                    if judged.bound <= tolerance {
                        kept.push((block, *number, judged.deviation()));
                    } else {
                        failed = failed.union(judged.deviation());
                        mark(net, block, &triangles[*number as usize], judged.sides, &mut marks);
                    }
                }
            }
        }
        let done = marks.is_empty() || round == ROUNDS || net.triangles() > most;
        // A triangle that is good may still be split by its neighbours; its parts are judged again.
        for (block, number, own) in kept {
            let split = !done && sides(net, block, number).iter().any(|side| marks.contains_key(side));
            if !split {
                good = good.union(own);
            }
        }
        deviation = deviation.union(good);
        if done {
            return Ok(deviation.union(failed));
        }
        fresh = split(net, &mut marks);
        detail.allow(net.triangles())?;
    }
    Ok(deviation)
}

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// The sides of a triangle as pairs of points; side k lies opposite of corner k.
fn sides(net: &Net<'_>, block: usize, number: u32) -> [(u32, u32); 3] {
    let piece = &net.pieces[block];
    let points = piece.triangles[number as usize].map(|corner| piece.corners[corner as usize].point);
    [key(points[1], points[2]), key(points[2], points[0]), key(points[0], points[1])]
}

fn mark(
    net: &Net<'_>,
    block: usize,
    triangle: &[u32; 3],
    bends: [f64; 3],
    marks: &mut HashMap<(u32, u32), u32>,
) {
    let points = triangle.map(|corner| net.pieces[block].corners[corner as usize].point);
    let ends = |side: usize| (points[(side + 1) % 3], points[(side + 2) % 3]);
    let worst = bends.into_iter().fold(0.0, f64::max);
    let length = |side: usize| {
        let (a, b) = ends(side);
        net.points[a as usize].distance(net.points[b as usize])
    };
    let longest = (0..3).map(length).fold(0.0, f64::max);
    for (side, bend) in bends.into_iter().enumerate() {
        let chosen = if worst > 0.0 { bend >= LIKE_THE_WORST * worst } else { length(side) == longest };
        if chosen {
            let (a, b) = ends(side);
            marks.insert(key(a, b), u32::MAX);
        }
    }
}

/// Splits every triangle at its marked sides; gives the triangles that are new, by block.
fn split(net: &mut Net<'_>, marks: &mut HashMap<(u32, u32), u32>) -> Vec<Vec<u32>> {
    let mut fresh = Vec::with_capacity(net.pieces.len());
    for block in 0..net.pieces.len() {
        let mut new = Vec::new();
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        for number in 0..net.pieces[block].triangles.len() {
            let triangle = net.pieces[block].triangles[number];
            let middle = [0, 1, 2].map(|side| halve(net, block, (&triangle, side), marks, &mut middles));
            let parts = parts(net, block, triangle, middle);
            if parts.len() == 1 {
                continue;
            }
            let list = &mut net.pieces[block].triangles;
            list[number] = parts[0];
            new.push(index(number));
            for part in &parts[1..] {
                new.push(index(list.len()));
                list.push(*part);
            }
        }
        fresh.push(new);
    }
    fresh
}

/// The corner in the middle of a side, made at its first use; none where the side is not marked.
fn halve(
    net: &mut Net<'_>,
    block: usize,
    (triangle, side): (&[u32; 3], usize),
    marks: &mut HashMap<(u32, u32), u32>,
    middles: &mut HashMap<(u32, u32), u32>,
) -> Option<u32> {
    let (a, b) = (triangle[(side + 1) % 3], triangle[(side + 2) % 3]);
    let corners = [a, b].map(|corner| net.pieces[block].corners[corner as usize]);
    let point = marks.get_mut(&key(corners[0].point, corners[1].point))?;
    if let Some(known) = middles.get(&key(a, b)) {
        return Some(*known);
    }
    let (u, v) = halfway(&corners[0], &corners[1]);
    let jet = net.layout.blocks[block].jet(u, v);
    if *point == u32::MAX {
        *point = index(net.points.len());
        net.points.push(jet.point);
    }
    net.pieces[block].normals.push(jet.normal);
    let made = index(net.pieces[block].corners.len());
    net.pieces[block].corners.push(Corner { u, v, point: *point, free: Free::Neither });
    middles.insert(key(a, b), made);
    Some(made)
}

/// A triangle cut at the middles of its sides.
fn parts(net: &Net<'_>, block: usize, [a, b, c]: [u32; 3], middle: [Option<u32>; 3]) -> Vec<[u32; 3]> {
    match middle {
        [None, None, None] => vec![[a, b, c]],
        [Some(m), None, None] => vec![[a, b, m], [a, m, c]],
        [None, Some(m), None] => vec![[b, c, m], [b, m, a]],
        [None, None, Some(m)] => vec![[c, a, m], [c, m, b]],
        [None, Some(q), Some(r)] => fork(net, block, [a, b, c], (r, q)),
        [Some(p), None, Some(r)] => fork(net, block, [b, c, a], (p, r)),
        [Some(p), Some(q), None] => fork(net, block, [c, a, b], (q, p)),
        [Some(p), Some(q), Some(r)] => vec![[a, r, q], [r, b, p], [q, p, c], [p, q, r]],
    }
}

/// A triangle (a, b, c) with marks on the sides from a: at `r` toward b and `q` toward c. The quadrilateral that
/// is left is cut so that the worse of its halves is as good as can be.
fn fork(net: &Net<'_>, block: usize, [a, b, c]: [u32; 3], (r, q): (u32, u32)) -> Vec<[u32; 3]> {
    let piece = &net.pieces[block];
    let place = |corner: u32| net.points[piece.corners[corner as usize].point as usize];
    let quality = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(place);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
    };
    let (one, other) = ([[r, b, q], [b, c, q]], [[r, b, c], [r, c, q]]);
    let worse = |pair: &[[u32; 3]; 2]| quality(pair[0]).min(quality(pair[1]));
    let [first, second] = if worse(&one) >= worse(&other) { one } else { other };
    vec![[a, r, q], first, second]
}

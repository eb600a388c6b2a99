//! Convex parts that are joined where one does as well as two.

use std::collections::BTreeMap;

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::{Decomposing, Hull, Part, ball, concavity};
use crate::geometry::mesh::index;
use crate::geometry::solid::SolidFault;

/// Two parts by their numbers, and what they would be together.
type Pair = ((usize, usize), Together);

#[derive(Clone)]
struct Together {
    hull: Hull,
    /// What the volume that the hull adds counts.
    ball: f64,
    /// How far from convex they are, once that is known.
    concavity: Option<f64>,
}

/// No more parts than are allowed, and none that another could take in.
pub(super) fn joined(parts: Vec<Part>, how: &Decomposing) -> Result<Vec<Part>, SolidFault> {
    let mut parts: BTreeMap<usize, Part> = parts.into_iter().enumerate().collect();
    let all: Vec<usize> = parts.keys().copied().collect();
    let mut pairs = BTreeMap::new();
    pairs.extend(together(
        &parts,
        all.iter().flat_map(|a| all.iter().map(|b| (*a, *b))).filter(|(a, b)| a < b).collect(),
    )?);
    let mut next = parts.len();
    while let Some(pair) = choose(&parts, &mut pairs, how) {
        let found = pairs.get(&pair).cloned();
        let (Some(one), Some(other), Some(found)) = (parts.remove(&pair.0), parts.remove(&pair.1), found)
        else {
            break;
        };
        pairs.retain(|(a, b), _| ![pair.0, pair.1].iter().any(|gone| gone == a || gone == b));
        let mut made = side_by_side(&one, &other, found.hull);
        made.concavity = found.concavity.unwrap_or_else(|| made.measured(how));
        parts.insert(next, made);
        pairs.extend(together(&parts, parts.keys().filter(|a| **a != next).map(|a| (*a, next)).collect())?);
        next += 1;
    }
    Ok(parts.into_values().collect())
}

/// The pair that is to be joined next.
fn choose(
    parts: &BTreeMap<usize, Part>,
    pairs: &mut BTreeMap<(usize, usize), Together>,
    how: &Decomposing,
) -> Option<(usize, usize)> {
    let mut order: Vec<(f64, (usize, usize))> =
        pairs.iter().map(|(pair, found)| (found.ball, *pair)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    if parts.len() > how.most {
        return order.first().map(|(_, pair)| *pair);
    }
    order.into_iter().take_while(|(ball, _)| *ball <= how.concavity).map(|(_, pair)| pair).find(|pair| {
        let Some(found) = pairs.get_mut(pair) else { return false };
        let measured = *found.concavity.get_or_insert_with(|| {
            side_by_side(&parts[&pair.0], &parts[&pair.1], found.hull.clone()).measured(how)
        });
        measured <= how.concavity
    })
}

/// What parts would be together.
fn together(parts: &BTreeMap<usize, Part>, of: Vec<(usize, usize)>) -> Result<Vec<Pair>, SolidFault> {
    let make = |(a, b): &(usize, usize)| {
        let (one, other) = (&parts[a], &parts[b]);
        let points = [one.hull.points.as_slice(), other.hull.points.as_slice()].concat();
        let hull = Hull::around(&points)?.ok_or(SolidFault::Flat)?;
        let ball = ball(hull.volume - one.volume - other.volume);
        Ok(((*a, *b), Together { hull, ball, concavity: None }))
    };
    of.par_iter().map(make).collect()
}

fn side_by_side(one: &Part, other: &Part, hull: Hull) -> Part {
    let first = index(one.points.len());
    let moved = other.triangles.iter().map(|triangle| triangle.map(|corner| corner + first));
    Part {
        body: None,
        points: [one.points.as_slice(), other.points.as_slice()].concat(),
        triangles: one.triangles.iter().copied().chain(moved).collect(),
        volume: one.volume + other.volume,
        hull,
        concavity: 0.0,
        last: true,
    }
}

impl Part {
    fn measured(&self, how: &Decomposing) -> f64 {
        concavity((&self.points, &self.triangles), self.volume, &self.hull, how.concavity / 8.0)
    }
}

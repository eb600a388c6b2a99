//! Pieces that follow each other, as one line each.

use std::collections::BTreeMap;

use glam::DVec3;

use super::feature::Kind;
use super::hidden::Piece;

/// A line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// What it is.
    pub kind: Kind,
    /// How many triangles hide it; 0 is seen.
    pub hidden: u32,
    /// Places along it: pixels from the upper left corner, and how far away ([`Camera::depth`]).
    ///
    /// [`Camera::depth`]: crate::preview::Camera::depth
    pub places: Vec<DVec3>,
    /// Whether it ends where it begins.
    pub closed: bool,
}

/// Chains pieces of one kind that are hidden alike wherever just two of them meet.
pub(super) fn traces(pieces: &[Piece]) -> Vec<Trace> {
    let class = |piece: &Piece| (piece.kind, piece.hidden);
    let mut meet: BTreeMap<((Kind, u32), u32), Vec<usize>> = BTreeMap::new();
    for (number, piece) in pieces.iter().enumerate() {
        for point in piece.points.iter().flatten() {
            meet.entry((class(piece), *point)).or_default().push(number);
        }
    }
    let mut used = vec![false; pieces.len()];
    let next = |number: usize, point: Option<u32>, used: &[bool]| -> Option<(usize, usize)> {
        let others = meet.get(&(class(&pieces[number]), point?))?;
        let [one, other] = others.as_slice() else { return None };
        let follower = if *one == number { *other } else { *one };
        if used[follower] || follower == number {
            return None;
        }
        let end = usize::from(pieces[follower].points[0] != point);
        Some((follower, end))
    };
    let mut traces = Vec::new();
    for start in 0..pieces.len() {
        if std::mem::replace(&mut used[start], true) {
            continue;
        }
        let first = &pieces[start];
        let mut places = vec![first.ends[0], first.ends[1]];
        let (mut at, mut end) = (start, 1);
        let mut points = first.points;
        let mut walk = |at: &mut usize, end: &mut usize, places: &mut Vec<DVec3>| {
            while let Some((follower, entered)) = next(*at, pieces[*at].points[*end], &used) {
                used[follower] = true;
                (*at, *end) = (follower, 1 - entered);
                places.push(pieces[follower].ends[*end]);
            }
            pieces[*at].points[*end]
        };
        points[1] = walk(&mut at, &mut end, &mut places);
        let closed = points[0].is_some() && points[0] == points[1] && places.len() > 3;
        if !closed {
            places.reverse();
            (at, end) = (start, 0);
            walk(&mut at, &mut end, &mut places);
        }
        if closed {
            places.pop();
        }
        traces.push(Trace { kind: first.kind, hidden: first.hidden, places, closed });
    }
    // What is hidden most is drawn first.
    traces.sort_by(|a, b| b.hidden.cmp(&a.hidden).then(b.kind.cmp(&a.kind)));
    traces
}

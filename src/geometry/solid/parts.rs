//! Parts into pieces that the library takes: closed, outward, and apart from each other.
//!
//! A part may be a group or an array: several closed skins that overlap as they like. Each outward skin with the
//! hollows inside it is a solid; solids whose boxes are apart make one piece, the others are united.

use glam::DVec3;

use super::check::{Check, components, moments};
use super::{Combination, Making, SolidFault, Stock};
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{Mesh, Run, VertexIndex, index};
use crate::geometry::number::Bounds;

/// Part of the diagonal below which the mean thickness of a component is none: an eighth of what single precision
/// tells apart at that size.
pub(super) const THIN: f64 = 1e-9;

/// The pieces of each part; none of parts that are not used.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids {
    pub(super) parts: Vec<Vec<Piece>>,
}

/// Closed skins that are apart from each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Piece {
    pub(super) points: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each triangle its number in the stock.
    pub(super) of: Vec<u32>,
    pub(super) check: Check,
}

/// Looks at every part that a combination uses.
///
/// # Errors
/// The first part that is no solid.
pub(super) fn solids(stock: &Stock, how: &Combination, making: &Making<'_>) -> Result<Solids, SolidFault> {
    let mut used = vec![false; stock.parts.len()];
    mark(how, &mut used);
    let mut solids = Solids::default();
    for (part, used) in used.into_iter().enumerate() {
        let check = making.check.get(part).copied().unwrap_or_default();
        solids.parts.push(if used { pieces(stock, part, check)? } else { Vec::new() });
    }
    Ok(solids)
}

fn mark(how: &Combination, used: &mut [bool]) {
    match how {
        Combination::Part(part) => used[*part] = true,
        Combination::Union(all) | Combination::Intersection(all) => {
            all.iter().for_each(|one| mark(one, used));
        }
        Combination::Difference(first, rest) => {
            mark(first, used);
            rest.iter().for_each(|one| mark(one, used));
        }
    }
}

/// The pieces of one part.
pub(super) fn pieces(stock: &Stock, part: usize, check: Check) -> Result<Vec<Piece>, SolidFault> {
    let mut whole = whole(stock, part);
    whole.check = check;
    if whole.triangles.is_empty() {
        return Err(SolidFault::NoFaces { part });
    }
    let count = match components(part, &whole.points, &whole.triangles) {
        Ok(count) => count,
        Err(_) => {
            // Points that stand on one place without being the same may be all that is open.
            whole = welded(whole);
            components(part, &whole.points, &whole.triangles)?
        }
    };
    if count == 1 {
        let (volume, area) = moments(&whole.points, whole.triangles.iter().copied());
        let size = Bounds::of_points(whole.points.iter().copied()).diagonal();
        return match volume / 6.0 {
            volume if volume.abs() <= THIN * size * area => Err(SolidFault::NoVolume { part }),
            volume if volume < 0.0 => Err(SolidFault::InsideOut { part, volume }),
            _ => Ok(vec![whole]),
        };
    }
    apart(part, whole)
}

/// The triangles of a part over points of their own.
fn whole(stock: &Stock, part: usize) -> Piece {
    let range = stock.parts[part].clone();
    let mesh = &stock.mesh;
    let triangles = &mesh.triangles[range.clone()];
    let corners =
        |triangle: &[VertexIndex; 3]| triangle.map(|vertex| mesh.vertices[vertex.subscript()].point.0);
    let (low, high) = (triangles.iter().flat_map(corners))
        .fold((u32::MAX, 0), |(low, high), point| (low.min(point), high.max(point)));
    if triangles.is_empty() {
        return Piece::default();
    }
    let mut piece = Piece {
        points: mesh.points[low as usize..=high as usize].to_vec(),
        triangles: Vec::with_capacity(triangles.len()),
        of: Vec::with_capacity(triangles.len()),
        check: Check::Trusted,
    };
    for (number, triangle) in range.zip(triangles) {
        push(&mut piece, corners(triangle).map(|point| point - low), index(number));
    }
    piece
}

/// Adds a triangle, unless it uses a point twice.
fn push(piece: &mut Piece, [a, b, c]: [u32; 3], number: u32) {
    if a != b && b != c && c != a {
        piece.triangles.push([a, b, c]);
        piece.of.push(number);
    }
}

fn welded(piece: Piece) -> Piece {
    let welded = weld_equal(&piece.points);
    let mut made = Piece { points: welded.points, check: piece.check, ..Piece::default() };
    for (triangle, of) in piece.triangles.iter().zip(&piece.of) {
        push(&mut made, triangle.map(|point| welded.map[point as usize]), *of);
    }
    made
}

/// A skin without boundary.
struct Skin {
    triangles: Vec<u32>,
    bounds: Bounds,
    volume: f64,
}

/// Skins into solids, and solids into pieces.
fn apart(part: usize, whole: Piece) -> Result<Vec<Piece>, SolidFault> {
    let labels = labels(whole.points.len(), &whole.triangles);
    let mut skins: Vec<Skin> = Vec::new();
    for (number, [a, _, _]) in whole.triangles.iter().enumerate() {
        let label = labels[*a as usize] as usize;
        if label >= skins.len() {
            skins.resize_with(label + 1, || Skin {
                triangles: Vec::new(),
                bounds: Bounds::EMPTY,
                volume: 0.0,
            });
        }
        skins[label].triangles.push(index(number));
    }
    for skin in &mut skins {
        let corners = || skin.triangles.iter().map(|number| whole.triangles[*number as usize]);
        let bounds = Bounds::of_points(corners().flatten().map(|point| whole.points[point as usize]));
        let (volume, area) = moments(&whole.points, corners());
        let thin = volume.abs() / 6.0 <= THIN * bounds.diagonal() * area;
        (skin.bounds, skin.volume) = (bounds, if thin { 0.0 } else { volume / 6.0 });
    }
    let mut solids = outward(part, &skins)?;
    if solids.is_empty() {
        return Err(SolidFault::NoVolume { part });
    }
    solids.sort_by(|a, b| a[0].cmp(&b[0]));
    let boxes: Vec<Bounds> = solids.iter().map(|solid| skins[solid[0]].bounds).collect();
    let mut pieces: Vec<Piece> = Vec::new();
    for (solid, class) in solids.iter().zip(classes(&boxes)) {
        if class >= pieces.len() {
            pieces.resize_with(class + 1, || Piece { check: whole.check, ..Piece::default() });
        }
        for skin in solid {
            for number in &skins[*skin].triangles {
                pieces[class].triangles.push(whole.triangles[*number as usize]);
                pieces[class].of.push(whole.of[*number as usize]);
            }
        }
    }
    Ok(pieces.into_iter().map(|piece| compact(piece, &whole.points)).collect())
}

/// Each outward skin with the hollows in it: its own number first.
fn outward(part: usize, skins: &[Skin]) -> Result<Vec<Vec<usize>>, SolidFault> {
    let mut solids: Vec<Vec<usize>> =
        (0..skins.len()).filter(|skin| skins[*skin].volume > 0.0).map(|skin| vec![skin]).collect();
    let holds =
        |outer: &Bounds, inner: &Bounds| outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all();
    for (number, hollow) in skins.iter().enumerate().filter(|(_, skin)| skin.volume < 0.0) {
        let around = solids.iter_mut().filter(|solid| holds(&skins[solid[0]].bounds, &hollow.bounds));
        let nearest = around.min_by(|a, b| skins[a[0]].volume.total_cmp(&skins[b[0]].volume));
        let fault = SolidFault::InsideOut { part, volume: hollow.volume };
        nearest.ok_or(fault)?.push(number);
    }
    Ok(solids)
}

/// For boxes numbers of classes, such that no two of one class meet.
pub(super) fn classes(boxes: &[Bounds]) -> Vec<usize> {
    let all = boxes.iter().fold(Bounds::EMPTY, |all, one| all.union(*one));
    let size = all.max - all.min;
    let axis = if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|a, b| boxes[*a].min[axis].total_cmp(&boxes[*b].min[axis]).then(a.cmp(b)));
    let mut classes = vec![0; boxes.len()];
    let mut open: Vec<usize> = Vec::new();
    for number in order {
        let own = &boxes[number];
        open.retain(|other| boxes[*other].max[axis] >= own.min[axis]);
        let meets = |other: &&usize| {
            let other = &boxes[**other];
            own.min.cmple(other.max).all() && other.min.cmple(own.max).all()
        };
        let taken: Vec<usize> = open.iter().filter(meets).map(|other| classes[*other]).collect();
        classes[number] = (0..).find(|class| !taken.contains(class)).unwrap_or(0);
        open.push(number);
    }
    classes
}

/// For each point the number of its component, in the order of the first triangles; points without one get any.
fn labels(points: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..index(points)).collect();
    for [a, b, c] in triangles {
        let (a, b, c) = (find(&mut parent, *a), find(&mut parent, *b), find(&mut parent, *c));
        let least = a.min(b).min(c);
        for root in [a, b, c] {
            parent[root as usize] = least;
        }
    }
    let mut label = vec![u32::MAX; points];
    let mut next = 0;
    for [a, _, _] in triangles {
        let root = find(&mut parent, *a) as usize;
        if label[root] == u32::MAX {
            label[root] = next;
            next += 1;
        }
    }
    (0..index(points)).map(|point| label[find(&mut parent, point) as usize]).collect()
}

/// The first of a set, with the way there made shorter.
pub(super) fn find(parent: &mut [u32], mut of: u32) -> u32 {
    while parent[of as usize] != of {
        let next = parent[of as usize];
        parent[of as usize] = parent[next as usize];
        of = next;
    }
    of
}

fn compact(mut piece: Piece, points: &[DVec3]) -> Piece {
    let mut place = vec![u32::MAX; points.len()];
    for corner in piece.triangles.as_flattened_mut() {
        let slot = &mut place[*corner as usize];
        if *slot == u32::MAX {
            *slot = index(piece.points.len());
            piece.points.push(points[*corner as usize]);
        }
        *corner = *slot;
    }
    piece
}

/// Leaves out components that enclose nothing: where faces touch, an intersection may leave two of them on one another.
pub(super) fn without_slivers(mut mesh: Mesh) -> Mesh {
    let corners: Vec<[u32; 3]> = (mesh.triangles.iter())
        .map(|triangle| triangle.map(|vertex| mesh.vertices[vertex.subscript()].point.0))
        .collect();
    let labels = labels(mesh.points.len(), &corners);
    let of = |[a, _, _]: &[u32; 3]| labels[*a as usize] as usize;
    let count = corners.iter().map(of).max().map_or(0, |most| most + 1);
    let mut sums = vec![(0.0, 0.0, None); count];
    for triangle in &corners {
        let [a, b, c] = triangle.map(|point| mesh.points[point as usize]);
        let (volume, area, origin) = &mut sums[of(triangle)];
        let origin = *origin.get_or_insert(a);
        let across = (b - a).cross(c - a);
        *volume += across.dot(a - origin) / 6.0;
        *area += across.length();
    }
    let size = mesh.bounds().diagonal();
    let kept: Vec<bool> = sums.iter().map(|(volume, area, _)| volume.abs() > THIN * size * area).collect();
    if kept.iter().all(|kept| *kept) {
        return mesh;
    }
    let mut triangles = Vec::with_capacity(corners.len());
    let mut runs = Vec::new();
    let mut start = 0;
    for run in &mesh.runs {
        let before = triangles.len();
        for number in start..run.end as usize {
            if kept[of(&corners[number])] {
                triangles.push(mesh.triangles[number]);
            }
        }
        start = run.end as usize;
        if triangles.len() > before {
            runs.push(Run { origin: run.origin, end: index(triangles.len()) });
        }
    }
    (mesh.triangles, mesh.runs) = (triangles, runs);
    mesh
}

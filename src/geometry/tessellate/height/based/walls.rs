//! Skins put together: seams closed, poles gathered, walls along rims, flat ends.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::super::delaunay::Place;
use super::sheet::Sheet;
use super::{BasedMap, Layer};
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Vertex, VertexIndex, index};
use crate::geometry::number::cos_degrees;
use crate::geometry::tessellate::cap::{CapLoop, Facing, add_cap, twice_area};
use crate::geometry::tessellate::height::Closing;
use crate::geometry::tessellate::{Detail, TessellateError};

/// Walls and ends.
const WALL: u32 = 1;
/// The lower skin.
const UNDER: u32 = 2;

/// A skin in the mesh.
struct Placed {
    /// Points of corners on sides and rims, by their places.
    shared: BTreeMap<Place, PointIndex>,
    /// Directed sides of triangles with nothing beyond, as the mesh shows them: places and points of both ends.
    rim: Vec<[(Place, PointIndex); 2]>,
}

/// One mesh of the skins of a map, the upper one first.
pub(super) fn joined(
    map: &BasedMap,
    layers: &[Layer],
    sheets: &[Sheet],
    detail: &Detail,
) -> Result<Mesh, TessellateError> {
    let mut mesh = Mesh::default();
    if let Closing::Base(level) = map.heights.close {
        check_level(map, layers[0], &sheets[0], level)?;
    }
    let top = add_skin(map, layers[0], &sheets[0], &mut mesh, (0, None), detail);
    if let (Some(layer), Some(sheet)) = (layers.get(1), sheets.get(1)) {
        let under = add_skin(map, *layer, sheet, &mut mesh, (UNDER, Some(&top)), detail);
        add_walls(&top, &under, &mut mesh, detail)?;
    }
    if map.heights.close == Closing::Ends {
        add_ends(&top, &mut mesh, detail)?;
    }
    Ok(mesh)
}

/// Refuses heights below the level that closes them; those of corners are set on it where they are near.
fn check_level(map: &BasedMap, layer: Layer, sheet: &Sheet, level: f64) -> Result<(), TessellateError> {
    for (steps, point) in sheet.steps.iter().zip(&sheet.points) {
        let [s, t] = map.parts(*steps);
        let (foot, normal) = map.base.stand(s, t);
        let height = (*point - foot).dot(normal);
        let slack = 1e-12 * point.length();
        if height < level - slack {
            let [x, y] = *steps;
            // As the field has it, without the rounding of the point.
            let height = map.height(layer, *steps);
            return Err(TessellateError::BelowLevel { height, base: level, place: DVec2::new(x, y) });
        }
    }
    Ok(())
}

fn add_skin(
    map: &BasedMap,
    layer: Layer,
    sheet: &Sheet,
    mesh: &mut Mesh,
    (source, over): (u32, Option<&Placed>),
    detail: &Detail,
) -> Placed {
    let on_border = |place: Place| (0..2).any(|k| place[k] == 0 || place[k] == sheet.far[k]);
    let mut on_rim = vec![false; sheet.points.len()];
    sheet.rim.iter().flatten().for_each(|corner| on_rim[*corner as usize] = true);
    let mut shared = BTreeMap::new();
    let mut points = Vec::with_capacity(sheet.points.len());
    for (corner, point) in (0..).zip(&sheet.points) {
        let mut add = || {
            mesh.points.push(*point);
            PointIndex(index(mesh.points.len()) - 1)
        };
        if !on_rim[corner as usize] && !on_border(sheet.places[corner as usize]) {
            points.push(add());
            continue;
        }
        let place = sheet.place(corner);
        let own = *shared.entry(place).or_insert_with(|| {
            // Where both skins meet, they share their points.
            let meeting = over.and_then(|over| over.shared.get(&place).copied());
            meeting.filter(|other| mesh.points[other.subscript()] == *point).unwrap_or_else(|| {
                mesh.points.push(*point);
                PointIndex(index(mesh.points.len()) - 1)
            })
        });
        points.push(own);
    }
    let pole = |corner: u32| {
        let row = sheet.places[corner as usize][1];
        (sheet.round.poles[0] && row == 0) || (sheet.round.poles[1] && row == sheet.far[1])
    };
    let looks_up = (source == 0) != map.base.is_turned();
    let side = if source == 0 { 1.0 } else { -1.0 };
    let first = index(mesh.vertices.len());
    let of = |corner: usize| {
        let steps = sheet.steps[corner];
        let normal = map.jet(layer, steps).normal * side;
        vertex(map, points[corner], steps, normal, source, detail.uv)
    };
    let vertices: Vec<Vertex> = (0..sheet.points.len()).into_par_iter().with_min_len(1024).map(of).collect();
    mesh.vertices.extend(vertices);
    let mut at_poles: Vec<(u32, usize)> = Vec::new();
    for corners in &sheet.triangles {
        let own = corners.map(|corner| points[corner as usize]);
        if own[0] == own[1] || own[1] == own[2] || own[2] == own[0] {
            continue;
        }
        let [mut a, mut b, mut c] = corners.map(|corner| VertexIndex(first + corner));
        if let Some(k) = (0..3).find(|k| pole(corners[*k])) {
            // A vertex for each triangle of the fan, its texture in the middle of the others.
            let [p, q] = [1, 2].map(|step| sheet.steps[corners[(k + step) % 3] as usize][0]);
            let steps = [f64::midpoint(p, q), sheet.steps[corners[k] as usize][1]];
            let own = VertexIndex(index(mesh.vertices.len()));
            at_poles.push((u32::from(steps[1] > 0.0), own.subscript()));
            mesh.vertices.push(vertex(map, points[corners[k] as usize], steps, DVec3::Y, source, detail.uv));
            *[&mut a, &mut b, &mut c][k] = own;
        }
        mesh.triangles.push(if looks_up { [a, c, b] } else { [a, b, c] });
    }
    smooth_poles(mesh, &at_poles, first);
    let turned = |ends: &[u32; 2]| if looks_up { [ends[1], ends[0]] } else { *ends };
    let rim = sheet
        .open_sides()
        .into_iter()
        .map(|ends| turned(&ends).map(|corner| (sheet.place(corner), points[corner as usize])));
    Placed { rim: rim.collect(), shared }
}

fn vertex(
    map: &BasedMap,
    point: PointIndex,
    steps: [f64; 2],
    normal: DVec3,
    source: u32,
    uv: bool,
) -> Vertex {
    let [s, t] = map.parts(steps);
    let uv = if uv { DVec2::new(s, t) } else { DVec2::ZERO };
    Vertex { point, normal, uv, color: Color::WHITE, anchor: Anchor { source, u: steps[0], v: steps[1] } }
}

/// Gives the vertices at each pole the mean normal of the triangles around it, by their angles there.
fn smooth_poles(mesh: &mut Mesh, at_poles: &[(u32, usize)], first: u32) {
    for end in 0..2 {
        let own: BTreeSet<usize> =
            at_poles.iter().filter(|(pole, _)| *pole == end).map(|(_, vertex)| *vertex).collect();
        let mut sum = DVec3::ZERO;
        let corner = |at: VertexIndex| mesh.points[mesh.vertices[at.subscript()].point.subscript()];
        for triangle in &mesh.triangles {
            if triangle[0].0 < first && triangle[1].0 < first && triangle[2].0 < first {
                continue;
            }
            let Some(k) = (0..3).find(|k| own.contains(&triangle[*k].subscript())) else { continue };
            let [a, b, c] = [0, 1, 2].map(|step| corner(triangle[(k + step) % 3]));
            let (ab, ac) = (b - a, c - a);
            let normal = ab.cross(ac).normalize_or_zero();
            sum += normal * ab.angle_between(ac);
        }
        let normal = sum.normalize_or(DVec3::Y);
        for vertex in own {
            mesh.vertices[vertex].normal = normal;
        }
    }
}

/// Loops of rim sides, one after the other by their points. None where rims touch in a point: walls there would share an
/// edge.
fn loops(rim: &[[(Place, PointIndex); 2]]) -> Result<Vec<Vec<usize>>, TessellateError> {
    let mut leaving: BTreeMap<u32, usize> = BTreeMap::new();
    for (at, [(_, from), _]) in rim.iter().enumerate() {
        if leaving.insert(from.0, at).is_some() {
            return Err(TessellateError::Tangled);
        }
    }
    let mut used = vec![false; rim.len()];
    let mut all = Vec::new();
    for first in 0..rim.len() {
        let mut ring = Vec::new();
        let mut at = first;
        while !used[at] {
            used[at] = true;
            ring.push(at);
            let Some(next) = leaving.get(&rim[at][1].1.0) else { break };
            at = *next;
        }
        if !ring.is_empty() {
            all.push(ring);
        }
    }
    Ok(all)
}

/// Walls between the rims of two skins; smooth where they turn by less than the crease angle.
fn add_walls(top: &Placed, under: &Placed, mesh: &mut Mesh, detail: &Detail) -> Result<(), TessellateError> {
    let least = cos_degrees(detail.crease_angle);
    for ring in loops(&top.rim)? {
        let sides: Vec<[(Place, PointIndex); 2]> = ring.iter().map(|at| top.rim[*at]).collect();
        let feet: Vec<[PointIndex; 2]> = sides
            .iter()
            .map(|ends| ends.map(|(place, own)| under.shared.get(&place).copied().unwrap_or(own)))
            .collect();
        let at = |point: PointIndex, mesh: &Mesh| mesh.points[point.subscript()];
        let normals: Vec<DVec3> = sides
            .iter()
            .zip(&feet)
            .map(|([(_, from), (_, to)], feet)| {
                let (a, b) = (at(*from, mesh), at(*to, mesh));
                let (c, d) = (at(feet[0], mesh), at(feet[1], mesh));
                // The quadrilateral a, c, d, b by its diagonals.
                (d - a).cross(b - c).normalize_or((b - a).any_orthonormal_vector())
            })
            .collect();
        let count = sides.len();
        let closed = sides[count - 1][1].1 == sides[0][0].1;
        let lengths: Vec<f64> =
            sides.iter().map(|[(_, a), (_, b)]| at(*a, mesh).distance(at(*b, mesh))).collect();
        let around: f64 = lengths.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let mut run = 0.0;
        for k in 0..count {
            let own = normals[k];
            let shared = |other: Option<usize>| match other {
                Some(other) if normals[other].dot(own) >= least => (normals[other] + own).normalize_or(own),
                _ => own,
            };
            let before = if k > 0 { Some(k - 1) } else { closed.then_some(count - 1) };
            let after = if k + 1 < count { Some(k + 1) } else { closed.then_some(0) };
            let ends = [shared(before), shared(after)];
            let across = [run / around, (run + lengths[k]) / around];
            run += lengths[k];
            let [(_, p), (_, q)] = sides[k];
            let corners = [(p, 0, 0.0), (q, 1, 0.0), (feet[k][1], 1, 1.0), (feet[k][0], 0, 1.0)];
            let base = index(mesh.vertices.len());
            mesh.vertices.extend(corners.map(|(point, end, down)| Vertex {
                point,
                normal: ends[end],
                uv: if detail.uv { DVec2::new(across[end], down) } else { DVec2::ZERO },
                color: Color::WHITE,
                anchor: Anchor { source: WALL, u: across[end], v: down },
            }));
            let [p, q, q_under, p_under] = [0, 1, 2, 3].map(|corner| VertexIndex(base + corner));
            if corners[1].0 != corners[2].0 {
                mesh.triangles.push([q, p, q_under]);
            }
            if corners[0].0 != corners[3].0 {
                mesh.triangles.push([p, p_under, q_under]);
            }
        }
    }
    Ok(())
}

/// Flat ends of a skin all around a cylinder: its rims lie in planes across the axis.
fn add_ends(top: &Placed, mesh: &mut Mesh, detail: &Detail) -> Result<(), TessellateError> {
    for ring in loops(&top.rim)? {
        let points: Vec<PointIndex> = ring.iter().map(|at| top.rim[*at][0].1).collect();
        let places: Vec<DVec2> = points
            .iter()
            .map(|point| mesh.points[point.subscript()])
            .map(|point| DVec2::new(point.x, point.z))
            .collect();
        // Over x and z a rim that has the skin to its left runs around the lower end by the other way than the upper.
        let up = twice_area(&places) > 0.0;
        let normal = if up { DVec3::Y } else { DVec3::NEG_Y };
        let facing = Facing { normal, mirrored: up };
        add_cap(mesh, &[CapLoop { place: places, points }], facing, WALL, detail.uv)?;
    }
    Ok(())
}

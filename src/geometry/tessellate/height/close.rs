//! Walls along the rim of a height map, and what closes it below.

use glam::{DVec2, DVec3};

use super::{Closing, HeightMap};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Vertex, VertexIndex};
use crate::geometry::number::cos_degrees;
use crate::geometry::tessellate::cap::{CapLoop, Facing, add_cap};
use crate::geometry::tessellate::{Detail, TessellateError};

/// Walls and the base.
const WALL: u32 = 1;
/// The lower sheet.
const UNDER: u32 = 2;

/// Closes a sheet along the rims of its connected parts, loops of its vertices (which are its points too) with the sheet
/// to their left over columns and rows, the outer one of each part first. Where the sheet lies on its base, it shares the
/// points of the base.
pub(super) fn close(
    shape: &HeightMap,
    mut sheet: Mesh,
    parts: &[Vec<Vec<u32>>],
    detail: &Detail,
) -> Result<Mesh, TessellateError> {
    match shape.close {
        Closing::None | Closing::Ends => {}
        Closing::Thickness(thickness) => {
            detail.allow(2 * sheet.triangles.len() as u64)?;
            let below = add_under(&mut sheet, thickness);
            for rim in parts.iter().flatten() {
                let under: Vec<PointIndex> = rim.iter().map(|at| PointIndex(below + at)).collect();
                add_walls(&mut sheet, rim, &under, detail);
            }
        }
        Closing::Base(base) => {
            if let Some(low) = sheet.points.iter().find(|point| point.y < base) {
                return Err(TessellateError::BelowBase {
                    height: low.y,
                    base,
                    place: DVec2::new(low.x, low.z),
                });
            }
            let facing = Facing { normal: DVec3::NEG_Y, mirrored: false };
            for rims in parts {
                let mut loops = Vec::new();
                for rim in rims {
                    let under = add_feet(&mut sheet, rim, base);
                    add_walls(&mut sheet, rim, &under, detail);
                    let place = rim.iter().map(|at| flat(sheet.points[*at as usize])).collect();
                    loops.push(CapLoop { place, points: under });
                }
                add_cap(&mut sheet, &loops, facing, WALL, detail.uv)?;
            }
        }
    }
    Ok(sheet)
}

fn flat(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}

/// A copy of the sheet that looks down; the first of its points.
fn add_under(sheet: &mut Mesh, thickness: f64) -> u32 {
    let below = mesh::index(sheet.points.len());
    let points: Vec<DVec3> = sheet.points.iter().map(|point| *point - DVec3::Y * thickness).collect();
    let vertices: Vec<Vertex> = sheet
        .vertices
        .iter()
        .map(|vertex| Vertex {
            point: PointIndex(below + vertex.point.0),
            normal: -vertex.normal,
            anchor: Anchor { source: UNDER, ..vertex.anchor },
            ..*vertex
        })
        .collect();
    let turned: Vec<[VertexIndex; 3]> = sheet
        .triangles
        .iter()
        .map(|[a, b, c]| [a, c, b].map(|corner| VertexIndex(below + corner.0)))
        .collect();
    sheet.points.extend(points);
    sheet.vertices.extend(vertices);
    sheet.triangles.extend(turned);
    below
}

/// Points under a rim on the base; where the rim lies on it, its own.
fn add_feet(sheet: &mut Mesh, rim: &[u32], base: f64) -> Vec<PointIndex> {
    let foot = |at: &u32| {
        let point = sheet.points[*at as usize];
        if point.y == base {
            return PointIndex(*at);
        }
        sheet.points.push(point.with_y(base));
        PointIndex(mesh::index(sheet.points.len()) - 1)
    };
    rim.iter().map(foot).collect()
}

fn add_walls(sheet: &mut Mesh, rim: &[u32], under: &[PointIndex], detail: &Detail) {
    let top: Vec<PointIndex> = rim.iter().map(|at| PointIndex(*at)).collect();
    add_strip(sheet, &top, under, detail);
}

/// A wall from a closed line of points down to those under it, with the inside to its left over columns and rows; smooth
/// where its sides turn by less than the crease angle.
pub(super) fn add_strip(sheet: &mut Mesh, rim: &[PointIndex], under: &[PointIndex], detail: &Detail) {
    let count = rim.len();
    let place = |k: usize| flat(sheet.points[rim[k % count].subscript()]);
    // With the sheet to the left over columns and rows, outside is to the right.
    let normals: Vec<DVec3> = (0..count)
        .map(|k| {
            let way = place(k + 1) - place(k);
            DVec3::new(way.y, 0.0, -way.x).normalize_or(DVec3::X)
        })
        .collect();
    let lengths: Vec<f64> = (0..count).map(|k| place(k).distance(place(k + 1))).collect();
    let around: f64 = lengths.iter().sum();
    let least = cos_degrees(detail.crease_angle);
    let shared = |before: DVec3, after: DVec3, own: DVec3| {
        if before.dot(after) >= least { (before + after).normalize_or(own) } else { own }
    };
    let mut run = 0.0;
    for k in 0..count {
        let (before, own, after) = (normals[(k + count - 1) % count], normals[k], normals[(k + 1) % count]);
        let ends = [shared(before, own, own), shared(own, after, own)];
        let across = [run / around, (run + lengths[k]) / around];
        run += lengths[k];
        let base = mesh::index(sheet.vertices.len());
        let after = (k + 1) % count;
        let corners = [(rim[k], 0, 0.0), (rim[after], 1, 0.0), (under[after], 1, 1.0), (under[k], 0, 1.0)];
        let vertices = corners.map(|(point, end, down)| Vertex {
            point,
            normal: ends[end],
            uv: if detail.uv { DVec2::new(across[end], down) } else { DVec2::ZERO },
            color: Color::WHITE,
            anchor: Anchor { source: WALL, u: across[end], v: down },
        });
        sheet.vertices.extend(vertices);
        let [p, q, q_under, p_under] = [0, 1, 2, 3].map(|corner| VertexIndex(base + corner));
        if corners[1].0 != corners[2].0 {
            sheet.triangles.push([p, q, q_under]);
        }
        if corners[0].0 != corners[3].0 {
            sheet.triangles.push([p, q_under, p_under]);
        }
    }
}

//! Vertices, normals, texture coordinates and flat ends: from a net to a mesh.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::Patchwork;
use super::layout::{Block, Rim};
use super::net::{Net, on_rim};
use super::rows::{Corner, Free};
use crate::geometry::mesh::polygon::newell;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex, index};
use crate::geometry::surface::Surface;
use crate::geometry::tessellate::cap::{CapLoop, Facing, add_cap};
use crate::geometry::tessellate::{Detail, TessellateError};

/// Makes the mesh of a net.
pub(super) fn assemble(net: &Net<'_>, shape: &Patchwork, detail: &Detail) -> Result<Mesh, TessellateError> {
    let mut assembly = Assembly::new(net, detail);
    assembly.join_smooth_edges();
    assembly.triangles();
    let mut mesh = assembly.mesh;
    for (number, rims) in shape.caps.iter().enumerate() {
        let source = index(shape.surfaces.len() + number);
        if let Some((outline, facing)) = cap(net, rims) {
            add_cap(&mut mesh, &[outline], facing, source, detail.uv)?;
        }
    }
    keep_used_points(&mut mesh);
    if looks_inward(&mesh) {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh.vertices.iter_mut().for_each(|vertex| vertex.normal = -vertex.normal);
    }
    mesh.runs = vec![Run { origin: 0, end: index(mesh.triangles.len()) }];
    Ok(mesh)
}

/// Sums of unit normals shorter than this have no direction.
const OPPOSITE: f64 = 1e-6;

struct Assembly<'a, 'b> {
    net: &'a Net<'b>,
    detail: &'a Detail,
    mesh: Mesh,
    /// First corner of each block in the counts below.
    first: Vec<u32>,
    /// Corners that share one normal, as a forest.
    parent: Vec<u32>,
    normals: Vec<DVec3>,
}

impl<'a, 'b> Assembly<'a, 'b> {
    fn new(net: &'a Net<'b>, detail: &'a Detail) -> Self {
        let mesh = Mesh { points: net.points.clone(), ..Mesh::default() };
        let mut first = Vec::with_capacity(net.pieces.len());
        let mut count = 0;
        let mut normals = Vec::new();
        for (block, piece) in net.layout.blocks.iter().zip(&net.pieces) {
            first.push(count);
            count += index(piece.corners.len());
            normals.extend(piece.normals.iter().map(|normal| if block.flipped { -*normal } else { *normal }));
        }
        Self { net, detail, mesh, first, parent: (0..count).collect(), normals }
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parent[corner as usize] != corner {
            let above = self.parent[self.parent[corner as usize] as usize];
            self.parent[corner as usize] = above;
            corner = above;
        }
        corner
    }

    /// Corners on the two sides of a smooth edge get one normal.
    fn join_smooth_edges(&mut self) {
        let mut joined = Vec::new();
        for (number, edge) in self.net.layout.edges.iter().enumerate() {
            let [one, other] = edge.uses.as_slice() else { continue };
            if edge.pole || self.net.turns[number] > self.detail.crease_angle {
                continue;
            }
            let (one, other) = (self.chain(*one), self.chain(*other));
            for ((a, point), (b, same)) in one.into_iter().zip(other) {
                if point == same {
                    joined.extend([a, b]);
                    let (a, b) = (self.root(a), self.root(b));
                    self.parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
        // Few corners stand on edges; the rest keep what they have.
        joined.sort_unstable();
        joined.dedup();
        let mut sums: BTreeMap<u32, DVec3> = BTreeMap::new();
        for corner in &joined {
            *sums.entry(self.root(*corner)).or_default() += self.normals[*corner as usize];
        }
        for corner in joined {
            let (sum, own) = (sums[&self.root(corner)], &mut self.normals[corner as usize]);
            // Along a seam with a twist normals are opposite, and their sum is rounding.
            if sum != *own && sum.length() >= OPPOSITE {
                *own = sum.normalize();
            }
        }
    }

    /// Corners of one side with their points, in the way of the edge.
    fn chain(&self, (block, rim): (usize, Rim)) -> Vec<(u32, u32)> {
        let mut chain = rim_corners(self.net, block, rim);
        if self.net.layout.blocks[block].edge(rim).backward {
            chain.reverse();
        }
        let piece = &self.net.pieces[block];
        chain
            .into_iter()
            .map(|corner| (self.first[block] + corner, piece.corners[corner as usize].point))
            .collect()
    }

    fn triangles(&mut self) {
        let corners = self.net.pieces.iter().map(|piece| piece.corners.len()).sum();
        self.mesh.vertices.reserve(corners);
        let newest = vec![NONE; self.net.points.len()];
        let mut made = Made { newest, older: Vec::with_capacity(corners) };
        for (number, (block, piece)) in self.net.layout.blocks.iter().zip(&self.net.pieces).enumerate() {
            let mut vertices = vec![NONE; piece.corners.len()];
            self.mesh.triangles.reserve(piece.triangles.len());
            for triangle in &piece.triangles {
                let corners = triangle.map(|corner| {
                    let slot = vertices[corner as usize];
                    if slot != NONE {
                        return VertexIndex(slot);
                    }
                    let normal = self.normals[(self.first[number] + corner) as usize];
                    let vertex = vertex(block, &piece.corners[corner as usize], normal, self.detail.uv);
                    let found = made.find_or_push(&mut self.mesh.vertices, vertex);
                    vertices[corner as usize] = found;
                    VertexIndex(found)
                });
                let [a, b, c] = corners;
                self.mesh.triangles.push(if block.flipped { [a, c, b] } else { [a, b, c] });
            }
        }
    }
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// The vertices on each point, from the newest to the oldest.
struct Made {
    /// For each point.
    newest: Vec<u32>,
    /// For each vertex the one before it on the same point.
    older: Vec<u32>,
}

impl Made {
    /// The vertex on the same point that looks the same, or a new one. A point of a pole may have very many: there only
    /// the newest are looked at.
    fn find_or_push(&mut self, vertices: &mut Vec<Vertex>, vertex: Vertex) -> u32 {
        const ALIKE: f64 = 1e-9;
        const LOOKED_AT: usize = 9;
        let newest = &mut self.newest[vertex.point.subscript()];
        let mut known = *newest;
        for _ in 0..LOOKED_AT {
            let Some(other) = vertices.get(known as usize) else { break };
            if other.uv == vertex.uv && other.normal.distance(vertex.normal) <= ALIKE {
                return known;
            }
            known = self.older[known as usize];
        }
        let new = index(vertices.len());
        vertices.push(vertex);
        self.older.push(*newest);
        *newest = new;
        new
    }
}

/// Corners on a rim, by the rim's own parameter; none on poles.
fn rim_corners(net: &Net<'_>, block: usize, rim: Rim) -> Vec<u32> {
    let (place, piece) = (&net.layout.blocks[block], &net.pieces[block]);
    let stands = |corner: &Corner| corner.free == Free::Neither && on_rim(place, corner, rim);
    let mut chain: Vec<u32> =
        (0..index(piece.corners.len())).filter(|corner| stands(&piece.corners[*corner as usize])).collect();
    let along = |corner: u32| {
        let corner = &piece.corners[corner as usize];
        if rim.along_u() { corner.u } else { corner.v }
    };
    chain.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
    chain
}

fn vertex(block: &Block<'_>, corner: &Corner, normal: DVec3, uv: bool) -> Vertex {
    let (u, v) = (block.surface.domain_u(), block.surface.domain_v());
    let place = DVec2::new((corner.u - u.start) / u.span(), 1.0 - (corner.v - v.start) / v.span());
    Vertex {
        point: PointIndex(corner.point),
        normal,
        uv: if uv { place } else { DVec2::ZERO },
        color: Color::WHITE,
        anchor: Anchor { source: block.source, u: corner.u, v: corner.v },
    }
}

/// The outline of a flat end, against the way in which the blocks run along it.
fn cap(net: &Net<'_>, rims: &[(u32, Rim)]) -> Option<(CapLoop, Facing)> {
    let mut points: Vec<u32> = Vec::new();
    for (source, rim) in rims {
        let mut chains: Vec<Vec<u32>> = Vec::new();
        for (number, block) in net.layout.blocks.iter().enumerate() {
            if block.source == *source && block.outer[*rim as usize] {
                let piece = &net.pieces[number];
                let mut chain: Vec<u32> = rim_corners(net, number, *rim)
                    .into_iter()
                    .map(|corner| piece.corners[corner as usize].point)
                    .collect();
                // The block lies to the left of the way along its bottom and right rims.
                let with_block = matches!(rim, Rim::Bottom | Rim::Right) != block.flipped;
                if with_block {
                    chain.reverse();
                }
                chains.push(chain);
            }
        }
        link(&mut points, chains);
    }
    let closed = points.len() > 3 && points.first() == points.last();
    if closed {
        points.pop();
    }
    if points.len() < 3 {
        return None;
    }
    let place = |point: &u32| net.points[*point as usize];
    let normal = newell(points.iter().map(place)).try_normalize()?;
    let right = if normal.y.abs() < 0.9 { DVec3::Y.cross(normal) } else { DVec3::X };
    let right = (right - normal * right.dot(normal)).normalize();
    let up = normal.cross(right);
    let origin = place(&points[0]);
    let flat = |point: &u32| {
        let away = place(point) - origin;
        DVec2::new(away.dot(right), away.dot(up))
    };
    let outline = CapLoop {
        place: points.iter().map(flat).collect(),
        points: points.iter().copied().map(PointIndex).collect(),
    };
    Some((outline, Facing { normal, mirrored: false }))
}

/// Appends chains that follow each other, in whichever order they are given.
fn link(points: &mut Vec<u32>, mut chains: Vec<Vec<u32>>) {
    while !chains.is_empty() {
        let next = match points.last() {
            Some(last) => chains.iter().position(|chain| chain.first() == Some(last)).unwrap_or(0),
            // The first is the one that no other leads to, if there is such a one.
            None => {
                let led = |chain: &Vec<u32>| chains.iter().any(|other| other.last() == chain.first());
                chains.iter().position(|chain| !led(chain)).unwrap_or(0)
            }
        };
        let chain = chains.remove(next);
        let skip = usize::from(points.last().is_some() && points.last() == chain.first());
        points.extend(&chain[skip..]);
    }
}

/// Leaves out points that no triangle uses.
fn keep_used_points(mesh: &mut Mesh) {
    let mut new = vec![u32::MAX; mesh.points.len()];
    for vertex in &mesh.vertices {
        new[vertex.point.subscript()] = 0;
    }
    if new.iter().all(|slot| *slot == 0) {
        return;
    }
    let mut kept = Vec::with_capacity(mesh.points.len());
    for (slot, point) in new.iter_mut().zip(&mesh.points) {
        if *slot == 0 {
            *slot = index(kept.len());
            kept.push(*point);
        }
    }
    mesh.points = kept;
    for vertex in &mut mesh.vertices {
        vertex.point = PointIndex(new[vertex.point.subscript()]);
    }
}

/// Whether a closed mesh shows its inside.
fn looks_inward(mesh: &Mesh) -> bool {
    let origin = mesh.points.first().copied().unwrap_or(DVec3::ZERO);
    let place =
        |vertex: &VertexIndex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()] - origin;
    let six: f64 = mesh.triangles.iter().map(|[a, b, c]| place(a).dot(place(b).cross(place(c)))).sum();
    let corner = |corner: usize| mesh.vertices[mesh.triangles[corner / 3][corner % 3].subscript()].point.0;
    let closed = || crate::geometry::mesh::topology::measure(mesh.triangles.len(), mesh.points.len(), corner);
    // What is cheap is asked first.
    six < 0.0 && closed().is_ok_and(|topology| topology.closed)
}

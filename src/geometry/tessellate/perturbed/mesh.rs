//! Vertices and triangles of a filled skin.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::{Cloth, PerturbedSkin};
use crate::geometry::mesh::{self, Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::cos_degrees;
use crate::geometry::tessellate::Detail;

/// Faces around a point that share a normal there.
struct Sector {
    faces: Vec<u32>,
    first: DVec3,
    sum: DVec3,
}

impl Cloth {
    /// The mesh, without points that no triangle has. Where faces turn by no more than the crease angle they share a
    /// normal, and without texture coordinates a vertex.
    pub(super) fn mesh(&self, skin: &PerturbedSkin, detail: &Detail) -> Mesh {
        let sectors = self.sectors(skin, detail.crease_angle);
        let mut made = Mesh::default();
        let mut points = vec![None; self.points.len()];
        // By point, face, and whether the face stands for all of its sector.
        let mut known: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (number, (triangles, places)) in self.faces.iter().enumerate() {
            let face = mesh::index(number);
            let (low, high) = skin.faces[number].rectangle();
            for corners in triangles {
                let vertices = corners.map(|corner| {
                    let place = self.points[corner as usize];
                    let around = &sectors[corner as usize];
                    let own = around.iter().find(|sector| sector.faces.contains(&face));
                    let stand_in = own.map_or(face, |sector| sector.faces[0]);
                    let key = (corner, if detail.uv { face } else { stand_in });
                    let vertex = *known.entry(key).or_insert_with(|| {
                        let point = *points[corner as usize].get_or_insert_with(|| {
                            made.points.push(place);
                            mesh::index(made.points.len() - 1)
                        });
                        let at = places[&corner];
                        let part = (at - low) / (high - low);
                        let gradient = || skin.faces[number].relief.value_gradient(place).1;
                        made.vertices.push(Vertex {
                            point: PointIndex(point),
                            normal: own.map_or_else(gradient, |sector| sector.sum).normalize_or(DVec3::Y),
                            uv: if detail.uv { DVec2::new(part.x, 1.0 - part.y) } else { DVec2::ZERO },
                            color: Color::WHITE,
                            anchor: Anchor { source: 0, u: at.x, v: at.y },
                        });
                        mesh::index(made.vertices.len() - 1)
                    });
                    VertexIndex(vertex)
                });
                made.triangles.push(vertices);
            }
        }
        made.runs.push(Run { origin: 0, end: mesh::index(made.triangles.len()) });
        made
    }

    /// For each point of several faces those that look alike.
    fn sectors(&self, skin: &PerturbedSkin, crease_angle: f64) -> Vec<Vec<Sector>> {
        let alike = cos_degrees(crease_angle).min(1.0 - 1e-12);
        let mut faces_of: Vec<Vec<u32>> = vec![Vec::new(); self.points.len()];
        for (face, (triangles, _)) in self.faces.iter().enumerate() {
            for corner in triangles.iter().flatten() {
                let known = &mut faces_of[*corner as usize];
                if known.last() != Some(&mesh::index(face)) {
                    known.push(mesh::index(face));
                }
            }
        }
        let sector = |(point, faces): (&DVec3, Vec<u32>)| {
            let mut all: Vec<Sector> = Vec::new();
            if faces.len() < 2 {
                return all;
            }
            for face in faces {
                let gradient = skin.faces[face as usize].relief.value_gradient(*point).1;
                let normal = gradient.normalize_or(DVec3::Y);
                match all.iter_mut().find(|sector| sector.first.dot(normal) >= alike) {
                    Some(sector) => {
                        sector.faces.push(face);
                        sector.sum += normal;
                    }
                    None => all.push(Sector { faces: vec![face], first: normal, sum: normal }),
                }
            }
            all
        };
        self.points.iter().zip(faces_of).map(sector).collect()
    }
}

//! MikkTSpace tangents, where and only where a material is drawn in their frame: by a normal texture, or shine along a direction.
//!
//! Vertices whose corners have different tangents are split.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::mesh;
use crate::geometry::mesh::{Mesh, Vertex, VertexIndex};
use crate::packing;
use crate::scene::{Geometry, MorphTarget, Scene};

/// Gives tangents to every geometry that is shown with a material that needs them.
pub(super) fn tangents(scene: &mut Scene) {
    for index in 0..scene.geometries.len() {
        let shown = scene.meshes.iter().filter(|mesh| mesh.geometry == index);
        let materials = shown.flat_map(|mesh| mesh.materials.iter().flatten());
        let needed = materials.into_iter().any(|material| scene.materials[*material].needs_tangents());
        let geometry = &mut scene.geometries[index];
        if needed && geometry.uv && !geometry.mesh.triangles.is_empty() {
            add_tangents(geometry);
        }
    }
}

fn add_tangents(geometry: &mut Geometry) {
    let corners = corner_tangents(&geometry.mesh, None);
    let states: Vec<Vec<[f32; 4]>> =
        geometry.targets.iter().map(|target| corner_tangents(&geometry.mesh, Some(target))).collect();
    let mesh = &mut geometry.mesh;
    let mut tangents: Vec<Option<[f32; 4]>> = vec![None; mesh.vertices.len()];
    // For each vertex the corner that its tangent is of, and the vertex that it was split from.
    let mut first: Vec<(usize, u32)> = (0..mesh::index(mesh.vertices.len())).map(|own| (0, own)).collect();
    // Further vertices of one that is split, found by their tangent's bits; only looked up, never walked.
    let mut split: HashMap<(u32, [u32; 4]), VertexIndex> = HashMap::new();
    for (corner, tangent) in corners.into_iter().enumerate() {
        let vertex = mesh.triangles[corner / 3][corner % 3];
        let slot = &mut tangents[vertex.0 as usize];
        match slot {
            None => {
                *slot = Some(tangent);
                first[vertex.0 as usize].0 = corner;
            }
            Some(known) if *known == tangent => {}
            Some(_) => {
                let key = (vertex.0, tangent.map(f32::to_bits));
                let twin = *split.entry(key).or_insert_with(|| {
                    mesh.vertices.push(mesh.vertices[vertex.0 as usize]);
                    tangents.push(Some(tangent));
                    first.push((corner, vertex.0));
                    VertexIndex(mesh::index(mesh.vertices.len()) - 1)
                });
                mesh.triangles[corner / 3][corner % 3] = twin;
            }
        }
    }
    for (target, corners) in geometry.targets.iter_mut().zip(states) {
        let normals: Vec<DVec3> = first.iter().map(|(_, from)| target.normals[*from as usize]).collect();
        target.normals = normals;
        let along = |(corner, _): &(usize, u32)| {
            let [x, y, z, _] = corners[*corner];
            [x, y, z]
        };
        target.tangents = Some(first.iter().map(along).collect());
    }
    if let Some(lightmap) = &mut geometry.lightmap {
        lightmap.places = first.iter().map(|(_, from)| lightmap.places[*from as usize]).collect();
    }
    geometry.tangents =
        Some(tangents.into_iter().map(|tangent| tangent.unwrap_or([1.0, 0.0, 0.0, 1.0])).collect());
}

/// A tangent for each corner, of a mesh or a state of it, of unit length and perpendicular to nothing in particular, as
/// MikkTSpace has it.
fn corner_tangents(mesh: &Mesh, state: Option<&MorphTarget>) -> Vec<[f32; 4]> {
    let points = state.map_or(&mesh.points, |state| &state.points);
    let normal =
        |(index, vertex): (usize, &Vertex)| state.map_or(vertex.normal, |state| state.normals[index]);
    let single = |vector: DVec3| vector.as_vec3().to_array();
    let positions: Vec<[f32; 3]> =
        mesh.vertices.iter().map(|vertex| single(points[vertex.point.0 as usize])).collect();
    let normals: Vec<[f32; 3]> = mesh.vertices.iter().enumerate().map(normal).map(single).collect();
    let uvs: Vec<[f32; 2]> = mesh.vertices.iter().map(|vertex| vertex.uv.as_vec2().to_array()).collect();
    let indices: Vec<u32> = mesh.triangles.iter().flatten().map(|vertex| vertex.0).collect();
    let made = packing::corner_tangents(&indices, &positions, &normals, &uvs);
    made.into_iter().zip(&indices).map(|(tangent, index)| unit(tangent, normals[*index as usize])).collect()
}

/// Where texture coordinates have no direction MikkTSpace gives any vector, zero too: any unit tangent serves.
fn unit([x, y, z, w]: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let tangent = glam::Vec3::new(x, y, z);
    let tangent = tangent.try_normalize().unwrap_or_else(|| {
        glam::Vec3::from_array(normal).normalize_or(glam::Vec3::Y).any_orthonormal_vector()
    });
    // MikkTSpace takes v as growing up the picture, glTF down: the bitangent points up either way.
    [tangent.x, tangent.y, tangent.z, if w < 0.0 { 1.0 } else { -1.0 }]
}

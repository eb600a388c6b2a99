//! Wavefront OBJ: polygons with UVs, normals, smoothing groups, materials, and the creases that tags of subdivision say.
//!
//! The text passes through `lines` first, which checks every line, keeps what the parser drops (smoothing groups,
//! group names, which corners have attributes) and hands on a clean text of vertices and faces in one object; `tobj`
//! parses that. Faces stay polygons: their triangulation is `geometry::mesh`'s.

mod lines;
mod mtl;
mod tags;

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::{ImportError, ImportOptions, Imported, MaterialLook, Note};
use crate::geometry::mesh::polygon::{Face, NONE};
use crate::geometry::mesh::{PointIndex, PolygonMesh};
use lines::{FaceRecord, Scan};

/// Reads an OBJ file. `open` gives the bytes of another file by the path written in the file, relative to it;
/// paths that are absolute or lead upwards are never asked for.
///
/// Points that no face uses are left out. Texture coordinates are turned to grow downwards. Time and memory are
/// linear in the length of the file.
///
/// # Errors
/// The first fault in the file, with its line.
pub fn read(
    bytes: &[u8],
    options: &ImportOptions,
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Imported, ImportError> {
    if let Some(foreign) = super::recognize(bytes) {
        return Err(ImportError::Foreign(foreign));
    }
    let scan = Scan::of(bytes, options.group.as_deref())?;
    let parsed = parse(&scan)?;
    let mut mesh = mesh_of(&parsed, &scan);
    if let Some(tolerance) = options.weld {
        mesh.weld(tolerance);
    }
    let mut notes = scan.notes;
    let materials = looks_of(&scan.libraries, &mesh.materials, open, &mut notes);
    notes.sort_by_key(|note| note.line);
    Ok(Imported { mesh, materials, groups: scan.groups, notes })
}

/// The clean text through `tobj`: one object, polygons kept.
fn parse(scan: &Scan) -> Result<tobj::Mesh, ImportError> {
    let options = tobj::LoadOptions::default();
    let no_library = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut scan.clean.as_slice(), &options, no_library)
        .map_err(|error| ImportError::Refused { reason: error.to_string() })?;
    let corners: usize = scan.faces.iter().map(|face| face.corners as usize).sum();
    let mesh = models.into_iter().map(|model| model.mesh).find(|mesh| !mesh.indices.is_empty());
    let mesh = mesh.filter(|mesh| mesh.indices.len() == corners);
    mesh.ok_or_else(|| ImportError::Refused { reason: "faces are missing".to_owned() }).and_then(|mesh| {
        let spoiled = mesh.positions.chunks_exact(3).find(|position| !position[0].is_finite());
        spoiled.map_or(Ok(()), |position| Err(scan.fault(position[1])))?;
        Ok(mesh)
    })
}

fn mesh_of(parsed: &tobj::Mesh, scan: &Scan) -> PolygonMesh {
    let triples = |flat: &[f64]| flat.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>();
    let keep = |indices: &[u32], has: &[bool]| {
        if has.iter().any(|&has| has) && indices.len() == has.len() {
            indices.iter().zip(has).map(|(&index, &has)| if has { index } else { NONE }).collect()
        } else {
            Vec::new()
        }
    };
    let mut mesh = PolygonMesh {
        points: triples(&parsed.positions),
        corners: parsed.indices.iter().copied().map(PointIndex).collect(),
        uvs: parsed.texcoords.chunks_exact(2).map(|uv| DVec2::new(uv[0], 1.0 - uv[1])).collect(),
        corner_uvs: keep(&parsed.texcoord_indices, &scan.has_uv),
        normals: triples(&parsed.normals),
        corner_normals: keep(&parsed.normal_indices, &scan.has_normal),
        materials: scan.materials.clone(),
        has_smoothing: scan.has_smoothing,
        ..PolygonMesh::default()
    };
    take_creases(&mut mesh, scan);
    let mut end = 0;
    for (loops_end, &FaceRecord { corners, material, smoothing }) in (1..).zip(&scan.faces) {
        end += corners;
        mesh.loop_ends.push(end);
        mesh.faces.push(Face { loops_end, material, smoothing });
    }
    mesh
}

/// Creases between points that faces use; the parser numbers these anew.
fn take_creases(mesh: &mut PolygonMesh, scan: &Scan) {
    if scan.creases.is_empty() && scan.sharp_points.is_empty() {
        return;
    }
    let mut points: HashMap<u32, PointIndex> = HashMap::new();
    for (vertex, &point) in scan.vertices.iter().zip(&mesh.corners) {
        points.insert(vertex - 1, point);
    }
    let of = |vertex: &u32| points.get(vertex).copied();
    let edges = scan.creases.iter();
    mesh.creases = edges.filter_map(|([a, b], sharpness)| Some(([of(a)?, of(b)?], *sharpness))).collect();
    let sharp = scan.sharp_points.iter();
    mesh.sharp_points = sharp.filter_map(|(vertex, sharpness)| Some((of(vertex)?, *sharpness))).collect();
}

/// What the libraries say of the materials that faces use.
fn looks_of(
    libraries: &[(u32, String)],
    used: &[String],
    open: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
    notes: &mut Vec<Note>,
) -> Vec<MaterialLook> {
    let mut known = Vec::new();
    for (line, path) in libraries {
        let Some(inside) = inside_folder(path) else {
            let message =
                format!("material library `{path}` lies outside the folder of the file; not opened");
            notes.push(Note { line: Some(*line), message });
            continue;
        };
        match open(&inside) {
            Some(bytes) => {
                let folder = inside.rfind('/').map_or("", |end| &inside[..=end]);
                known.extend(mtl::read(&bytes, folder));
            }
            None => {
                let message = format!("material library `{path}` not found");
                notes.push(Note { line: Some(*line), message });
            }
        }
    }
    let look = |name: &String| {
        let found = known.iter().find(|look: &&MaterialLook| look.name == *name).cloned();
        found.unwrap_or_else(|| MaterialLook { name: name.clone(), ..MaterialLook::default() })
    };
    used.iter().map(look).collect()
}

/// A relative path with forward slashes that never leads upwards, or `None`.
fn inside_folder(path: &str) -> Option<String> {
    let path = path.replace('\\', "/");
    let fits = |part: &str| !part.is_empty() && part != ".." && !part.contains([':', '\0']);
    let inside = !path.starts_with('/') && path.split('/').all(fits);
    let parts: Vec<&str> = path.split('/').filter(|&part| part != ".").collect();
    (inside && !parts.is_empty()).then(|| parts.join("/"))
}

#[cfg(test)]
mod tests;

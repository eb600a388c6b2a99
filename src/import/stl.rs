//! STL, binary and text: facets, welded into a connected mesh.
//!
//! STL repeats every point in every facet; points that are equal but for rounding are joined. It also stores a normal for each facet, which
//! says nothing that the order of the corners does not: where they disagree the order wins, and a note tells how
//! often.

mod text;

use glam::DVec3;

use super::{ImportError, ImportOptions, Imported, Note};
use crate::geometry::mesh::weld::{Welded, weld_near};
use crate::geometry::mesh::{PolygonMesh, polygon};
use crate::geometry::number::{Bounds, single_rounding};

/// Bytes before the facets of a binary file: a free header and the count.
const HEADER: usize = 84;
/// Bytes of a facet: normal, three corners, an attribute that is not read.
const FACET: usize = 50;

/// A facet as stored.
#[derive(Clone, Copy, Debug)]
struct Facet {
    normal: DVec3,
    corners: [DVec3; 3],
}

/// Reads an STL file. Points within [`ImportOptions::weld`] of each other are joined, by default within the rounding of
/// single precision at the size of the model. Linear in the length of the file, in time and memory.
///
/// A file is binary when its length fits the count in its header, whatever the header says, and text when it begins
/// with `solid` and goes on as text.
///
/// # Errors
/// The first fault in the file.
pub fn read(bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    if is_text(bytes) {
        let read = text::read(bytes, options.group.as_deref())?;
        return Ok(imported(&read.facets, read.solids, options, Vec::new()));
    }
    if let Some(foreign) = super::recognize(bytes).filter(|_| claimed_length(bytes) != Some(bytes.len())) {
        return Err(ImportError::Foreign(foreign));
    }
    if let Some(group) = &options.group {
        return Err(ImportError::UnknownGroup { group: group.clone(), known: Vec::new() });
    }
    let (facets, notes) = read_binary(bytes)?;
    Ok(imported(&facets, Vec::new(), options, notes))
}

/// Length of a binary file by the count in its header.
fn claimed_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    Some(HEADER + FACET * count)
}

/// Begins with `solid`, is not a binary file of just the right length, and looks like text at its beginning.
fn is_text(bytes: &[u8]) -> bool {
    let bare = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let named = bare.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let start = &bytes[..bytes.len().min(4096)];
    let plain = start.iter().all(|&byte| byte >= b' ' || byte.is_ascii_whitespace());
    named && plain && claimed_length(bytes) != Some(bytes.len())
}

fn read_binary(bytes: &[u8]) -> Result<(Vec<Facet>, Vec<Note>), ImportError> {
    let Some(claimed_length) = claimed_length(bytes) else {
        return Err(ImportError::TooShort { length: bytes.len() });
    };
    let body = &bytes[HEADER..];
    if claimed_length > bytes.len() {
        let claimed = u32::try_from((claimed_length - HEADER) / FACET).unwrap_or(u32::MAX);
        let held = u32::try_from(body.len() / FACET).unwrap_or(u32::MAX);
        return Err(ImportError::Truncated { claimed, held });
    }
    let mut notes = Vec::new();
    let spare = bytes.len() - claimed_length;
    if spare > 0 {
        let message = format!("{spare} bytes after the last facet are not read");
        notes.push(Note { line: None, message });
    }
    let mut facets = Vec::with_capacity(body.len() / FACET);
    for (number, bytes) in (1..).zip(body[..claimed_length - HEADER].chunks_exact(FACET)) {
        let read = facet(bytes).map_err(|value| ImportError::FacetNotFinite { facet: number, value })?;
        facets.push(read);
    }
    if facets.is_empty() {
        return Err(ImportError::NoFaces { vertices: 0 });
    }
    Ok((facets, notes))
}

/// One facet of a binary file, or a coordinate of it that is not finite.
fn facet(bytes: &[u8]) -> Result<Facet, f64> {
    let vector = |at: usize| {
        DVec3::from_array([0, 4, 8].map(|step| {
            let b = &bytes[at + step..at + step + 4];
            f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        }))
    };
    let corners = [vector(12), vector(24), vector(36)];
    match corners.iter().flat_map(|corner| corner.to_array()).find(|value| !value.is_finite()) {
        Some(value) => Err(value),
        None => Ok(Facet { normal: vector(0), corners }),
    }
}

fn imported(
    facets: &[Facet],
    solids: Vec<String>,
    options: &ImportOptions,
    mut notes: Vec<Note>,
) -> Imported {
    let points: Vec<DVec3> = facets.iter().flat_map(|facet| facet.corners).collect();
    let welded = weld(&points, options.weld);
    let mut mesh = PolygonMesh { points: welded.points, ..PolygonMesh::default() };
    for corners in welded.map.chunks_exact(3) {
        mesh.push_face(&[corners], None, 0);
    }
    notes.extend(disagreement(facets));
    Imported { mesh, materials: Vec::new(), groups: solids, notes }
}

/// Joins points. Without a wish, those that single precision at the size of the model cannot tell apart: programs
/// write 0 in one facet and 1e-17 in the next.
fn weld(points: &[DVec3], tolerance: Option<f64>) -> Welded {
    let reach = Bounds::of_points(points.iter().copied()).reach();
    weld_near(points, tolerance.unwrap_or_else(|| single_rounding(reach)))
}

/// A note when stored normals point against the order of the corners.
fn disagreement(facets: &[Facet]) -> Option<Note> {
    let against = |facet: &&Facet| polygon::newell(facet.corners).dot(facet.normal) < 0.0;
    let count = facets.iter().filter(against).count();
    (count > 0).then(|| {
        let total = facets.len();
        let message = format!(
            "{count} of {total} facet normals point against the order of the corners; the order of the corners is used"
        );
        Note { line: None, message }
    })
}

#[cfg(test)]
mod tests;

//! Flat faces that close a shape, on points that its walls already use.

use glam::{DVec2, DVec3};

use super::TessellateError;
use crate::geometry::mesh;
use crate::geometry::mesh::triangulate::triangulate;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Vertex, VertexIndex};

/// A closed outline of a flat face: places in its plane and the points of the mesh that stand there.
pub(super) struct CapLoop {
    /// Places, the last joined to the first.
    pub(super) place: Vec<DVec2>,
    /// Points of the mesh.
    pub(super) points: Vec<PointIndex>,
}

/// Where a flat face looks.
#[derive(Clone, Copy)]
pub(super) struct Facing {
    /// Outward normal.
    pub(super) normal: DVec3,
    /// Whether the plane's x runs to the left for who looks at the face.
    pub(super) mirrored: bool,
}

/// Adds the face bounded by the first loop, without the others. Its texture covers the box of the outline.
pub(super) fn add_cap(
    mesh: &mut Mesh,
    loops: &[CapLoop],
    facing: Facing,
    source: u32,
    uv: bool,
) -> Result<(), TessellateError> {
    let rings: Vec<&[DVec2]> = loops.iter().map(|ring| ring.place.as_slice()).collect();
    let triangles =
        triangulate(&rings).map_err(|error| TessellateError::Cap { reason: error.to_string() })?;
    let base = mesh::index(mesh.vertices.len());
    let (low, size) = extent(&loops[0].place);
    for (place, point) in loops.iter().flat_map(|ring| ring.place.iter().zip(&ring.points)) {
        let part = (*place - low) / size;
        let across = if facing.mirrored { 1.0 - part.x } else { part.x };
        mesh.vertices.push(Vertex {
            point: *point,
            normal: facing.normal,
            uv: if uv { DVec2::new(across, 1.0 - part.y) } else { DVec2::ZERO },
            color: Color::WHITE,
            anchor: Anchor { source, u: place.x, v: place.y },
        });
    }
    let turn = (twice_area(&loops[0].place) < 0.0) != facing.mirrored;
    mesh.triangles.extend(triangles.into_iter().map(|[a, b, c]| {
        let corners = if turn { [a, c, b] } else { [a, b, c] };
        corners.map(|corner| VertexIndex(base + corner))
    }));
    Ok(())
}

fn extent(places: &[DVec2]) -> (DVec2, DVec2) {
    let low = places.iter().fold(DVec2::INFINITY, |low, place| low.min(*place));
    let high = places.iter().fold(DVec2::NEG_INFINITY, |high, place| high.max(*place));
    (low, (high - low).max(DVec2::splat(f64::MIN_POSITIVE)))
}

/// Twice the signed area of a closed outline; positive when it turns counter-clockwise.
pub(super) fn twice_area(places: &[DVec2]) -> f64 {
    let next = places.iter().cycle().skip(1);
    let origin = places.first().copied().unwrap_or(DVec2::ZERO);
    places.iter().zip(next).map(|(a, b)| (*a - origin).perp_dot(*b - origin)).sum()
}

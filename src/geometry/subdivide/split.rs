//! How faces are split: the topology of the next level, without positions.
//!
//! The numbers of new things follow from the old ones alone, so meshes with the same faces but other vertices, such as
//! texture charts, are split into the same corners. Vertices of the old level keep their numbers where they live on.

use super::topology::{NONE, Topology};
use crate::geometry::mesh::index;

/// Each face of n corners into n quads: vertices, then one for each edge, then one for each face.
///
/// Corner `h` of the old level becomes face `h`, from the vertex along its edge, over the middle of the face.
pub(super) fn quads(old: &Topology) -> Topology {
    let (vertices, edges, corners) = (index(old.vertices()), index(old.edges()), old.corners());
    let mut made = Topology {
        face_start: (0..=index(corners)).map(|face| 4 * face).collect(),
        corner_face: (0..4 * index(corners)).map(|corner| corner / 4).collect(),
        corner_vertex: Vec::with_capacity(4 * corners),
        corner_edge: Vec::with_capacity(4 * corners),
        twin: Vec::with_capacity(4 * corners),
        edge_corner: Vec::with_capacity(2 * old.edges() + corners),
        vertex_corner: Vec::with_capacity(old.vertices() + old.edges() + old.faces()),
    };
    for corner in 0..index(corners) {
        let here = corner as usize;
        let before = old.before(corner);
        let (edge, edge_before) = (old.corner_edge[here], old.corner_edge[before as usize]);
        let center = vertices + edges + old.corner_face[here];
        made.corner_vertex.extend([old.corner_vertex[here], vertices + edge, center, vertices + edge_before]);
        made.corner_edge.extend([
            half(old, corner, edge),
            2 * edges + corner,
            2 * edges + before,
            other_half(old, before, edge_before),
        ]);
        let (twin, twin_before) = (old.twin[here], old.twin[before as usize]);
        made.twin.extend([
            if twin == NONE { NONE } else { 4 * old.next(twin) + 3 },
            4 * old.next(corner) + 2,
            4 * before + 1,
            if twin_before == NONE { NONE } else { 4 * twin_before },
        ]);
    }
    made.edge_corner
        .extend(old.edge_corner.iter().flat_map(|corner| [4 * corner, 4 * old.next(*corner) + 3]));
    made.edge_corner.extend((0..index(corners)).map(|corner| 4 * corner + 1));
    made.vertex_corner.extend(old.vertex_corner.iter().map(|corner| 4 * corner));
    made.vertex_corner.extend(old.edge_corner.iter().map(|corner| 4 * old.next(*corner) + 3));
    made.vertex_corner.extend(old.face_start[..old.faces()].iter().map(|corner| 4 * corner + 2));
    made
}

/// Each triangle into four: vertices, then one for each edge. Of face `f`, the first three new faces stand in its corners
/// and the last in its middle.
pub(super) fn triangles(old: &Topology) -> Topology {
    let (vertices, edges, faces) = (index(old.vertices()), index(old.edges()), index(old.faces()));
    let base = |corner: u32| 12 * (corner / 3) + 3 * (corner % 3);
    let mut made = Topology {
        face_start: (0..=4 * faces).map(|face| 3 * face).collect(),
        corner_face: (0..12 * faces).map(|corner| corner / 3).collect(),
        corner_vertex: Vec::with_capacity(12 * faces as usize),
        corner_edge: Vec::with_capacity(12 * faces as usize),
        twin: Vec::with_capacity(12 * faces as usize),
        edge_corner: Vec::with_capacity(2 * old.edges() + old.corners()),
        vertex_corner: Vec::with_capacity(old.vertices() + old.edges()),
    };
    for face in 0..faces {
        for corner in 3 * face..3 * face + 3 {
            let here = corner as usize;
            let before = old.before(corner);
            let (edge, edge_before) = (old.corner_edge[here], old.corner_edge[before as usize]);
            made.corner_vertex.extend([old.corner_vertex[here], vertices + edge, vertices + edge_before]);
            made.corner_edge.extend([
                half(old, corner, edge),
                2 * edges + corner,
                other_half(old, before, edge_before),
            ]);
            let (twin, twin_before) = (old.twin[here], old.twin[before as usize]);
            made.twin.extend([
                if twin == NONE { NONE } else { base(old.next(twin)) + 2 },
                12 * face + 9 + before % 3,
                if twin_before == NONE { NONE } else { base(twin_before) },
            ]);
        }
        for corner in 3 * face..3 * face + 3 {
            let next = old.next(corner);
            made.corner_vertex.push(vertices + old.corner_edge[corner as usize]);
            made.corner_edge.push(2 * edges + next);
            made.twin.push(base(next) + 1);
        }
    }
    made.edge_corner
        .extend(old.edge_corner.iter().flat_map(|corner| [base(*corner), base(old.next(*corner)) + 2]));
    made.edge_corner.extend((0..3 * faces).map(|corner| base(corner) + 1));
    made.vertex_corner.extend(old.vertex_corner.iter().map(|corner| base(*corner)));
    made.vertex_corner.extend(old.edge_corner.iter().map(|corner| base(old.next(*corner)) + 2));
    made
}

/// The half of an edge at the vertex of a corner that runs along it.
fn half(old: &Topology, corner: u32, edge: u32) -> u32 {
    2 * edge + u32::from(old.edge_corner[edge as usize] != corner)
}

/// The half of an edge at the far end of a corner that runs along it.
fn other_half(old: &Topology, corner: u32, edge: u32) -> u32 {
    2 * edge + u32::from(old.edge_corner[edge as usize] == corner)
}

/// What a new vertex of the sqrt(3) scheme stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Root3 {
    /// The middle of a face.
    Middle(u32),
    /// A third of a border edge from the vertex of its corner.
    Third(u32),
    /// Two thirds of it.
    TwoThirds(u32),
}

/// The triangles of the sqrt(3) scheme: each gets a vertex in its middle and old edges are turned over. In every second
/// step (`thirds`) a triangle with one border edge gets two vertices on that edge instead.
pub(super) fn root3(old: &Topology, thirds: bool) -> (Topology, Vec<Root3>) {
    let vertices = index(old.vertices());
    let mut new = Vec::with_capacity(old.faces());
    // For each face, its new vertex, or that at its first third; and the corner of the border edge that is cut.
    let mut first = Vec::with_capacity(old.faces());
    for face in 0..old.faces() {
        first.push(vertices + index(new.len()));
        let border = old.face_range(face).find(|corner| old.twin[*corner] == NONE);
        match border.filter(|_| thirds) {
            Some(corner) => new.extend([Root3::Third(index(corner)), Root3::TwoThirds(index(corner))]),
            None => new.push(Root3::Middle(index(face))),
        }
    }
    let cut_corner = |face: u32| match new[(first[face as usize] - vertices) as usize] {
        Root3::Third(corner) => Some(corner),
        _ => None,
    };
    // The new vertex of a face that an edge sees.
    let seen = |corner: u32| {
        let face = old.corner_face[corner as usize];
        match cut_corner(face) {
            Some(cut) if corner == old.next(cut) => first[face as usize] + 1,
            _ => first[face as usize],
        }
    };
    let mut faces = Vec::with_capacity(9 * old.faces());
    for corner in 0..index(old.corners()) {
        let (from, to) = (old.corner_vertex[corner as usize], old.corner_vertex[old.next(corner) as usize]);
        let twin = old.twin[corner as usize];
        if twin != NONE {
            // Each half-edge gives the triangle at its beginning.
            faces.extend([from, seen(twin), seen(corner)]);
        } else if cut_corner(old.corner_face[corner as usize]) == Some(corner) {
            let top = old.corner_vertex[old.before(corner) as usize];
            faces.extend([seen(corner), seen(corner) + 1, top]);
        } else {
            faces.extend([from, to, seen(corner)]);
        }
    }
    let start = (0..=index(faces.len() / 3)).map(|face| 3 * face).collect();
    let made = Topology::of_faces(start, faces, vertices + index(new.len()))
        .expect("triangles of a manifold turned over are a manifold");
    (made, new)
}

/// What a new vertex of a dual scheme stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dual {
    /// A corner of a face.
    Corner(u32),
    /// A place on the border edge of a corner, near the vertex of the corner.
    Near(u32),
    /// A place on it near its other end.
    Far(u32),
}

/// The faces of a dual scheme: one for each face, then each edge, then each vertex; a vertex for each corner, and two for
/// each border edge.
pub(super) fn dual(old: &Topology) -> (Topology, Vec<Dual>) {
    let mut new: Vec<Dual> = (0..index(old.corners())).map(Dual::Corner).collect();
    let mut near = vec![NONE; old.corners()];
    for corner in (0..index(old.corners())).filter(|corner| old.twin[*corner as usize] == NONE) {
        near[corner as usize] = index(new.len());
        new.extend([Dual::Near(corner), Dual::Far(corner)]);
    }
    let mut start = old.face_start.clone();
    let mut corners: Vec<u32> = (0..index(old.corners())).collect();
    for corner in &old.edge_corner {
        let (next, twin) = (old.next(*corner), old.twin[*corner as usize]);
        if twin == NONE {
            let place = near[*corner as usize];
            corners.extend([next, *corner, place, place + 1]);
        } else {
            corners.extend([next, *corner, old.next(twin), twin]);
        }
        start.push(index(corners.len()));
    }
    let mut ring = super::topology::Ring::default();
    for vertex in 0..index(old.vertices()) {
        old.ring(vertex, &mut ring);
        corners.extend(&ring.corners);
        if !ring.is_closed() {
            let last = old.before(*ring.corners.last().expect("a vertex has a face"));
            corners.extend([near[last as usize] + 1, near[ring.corners[0] as usize]]);
        }
        start.push(index(corners.len()));
    }
    let made =
        Topology::of_faces(start, corners, index(new.len())).expect("the dual of a manifold is a manifold");
    (made, new)
}

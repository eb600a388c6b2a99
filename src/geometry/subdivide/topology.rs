//! Who touches whom in a mesh of polygons: flat arrays of half-edges, no positions.
//!
//! A *corner* is a place in a face and stands for the half-edge from its vertex to that of the next corner. Corners of one
//! face follow each other. Edges and vertices know one of their corners; that of a vertex on a border is the first of
//! its fan, so that a walk counterclockwise sees all of it.

use super::SubdivideFault;
use crate::geometry::mesh::index;

/// No corner: the other side of a border.
pub(super) const NONE: u32 = u32::MAX;

/// The topology of one level.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    pub(super) face_start: Vec<u32>,
    pub(super) corner_vertex: Vec<u32>,
    pub(super) corner_face: Vec<u32>,
    pub(super) corner_edge: Vec<u32>,
    pub(super) twin: Vec<u32>,
    pub(super) edge_corner: Vec<u32>,
    pub(super) vertex_corner: Vec<u32>,
}

/// The faces and edges around a vertex, counterclockwise. Face `i` lies between edges `i` and `i + 1`; around an inner
/// vertex the first edge follows the last, on a border there is one edge more than faces.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    pub(super) vertex: u32,
    pub(super) corners: Vec<u32>,
    pub(super) edges: Vec<u32>,
    pub(super) far: Vec<u32>,
}

impl Ring {
    pub(super) fn is_closed(&self) -> bool {
        self.edges.len() == self.corners.len()
    }

    pub(super) fn valence(&self) -> usize {
        self.edges.len()
    }
}

impl Topology {
    /// The topology of faces over `vertices` vertices. O(n), but for O(k log k) at a vertex of k edges.
    ///
    /// # Errors
    /// The first fault that keeps the faces from being a manifold.
    pub fn of_faces(
        face_start: Vec<u32>,
        corner_vertex: Vec<u32>,
        vertices: u32,
    ) -> Result<Self, SubdivideFault> {
        let mut made = Self { face_start, corner_vertex, ..Self::default() };
        if made.faces() == 0 {
            return Err(SubdivideFault::Empty);
        }
        made.corner_face = vec![0; made.corners()];
        for face in 0..made.faces() {
            made.check_face(face)?;
            let range = made.face_range(face);
            made.corner_face[range].fill(index(face));
        }
        made.pair(vertices)?;
        made.find_fans(vertices)?;
        Ok(made)
    }

    fn check_face(&self, face: usize) -> Result<(), SubdivideFault> {
        let corners = &self.corner_vertex[self.face_range(face)];
        if corners.len() < 3 {
            return Err(SubdivideFault::FewCorners { face: index(face) });
        }
        let mut sorted = corners.to_vec();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(SubdivideFault::RepeatedVertex { face: index(face), vertex: pair[0] }),
            None => Ok(()),
        }
    }

    /// Finds the other side of each half-edge and numbers the edges by their first corner.
    fn pair(&mut self, vertices: u32) -> Result<(), SubdivideFault> {
        let corners = self.corners();
        let ends = |corner: usize| {
            let (from, to) =
                (self.corner_vertex[corner], self.corner_vertex[self.next(index(corner)) as usize]);
            (from.min(to), from.max(to))
        };
        // Corners by the lesser end of their edge.
        let mut start = vec![0_u32; vertices as usize + 1];
        (0..corners).for_each(|corner| start[ends(corner).0 as usize + 1] += 1);
        (0..vertices as usize).for_each(|vertex| start[vertex + 1] += start[vertex]);
        let mut place = start.clone();
        let mut sorted = vec![(0_u32, 0_u32); corners];
        for corner in 0..corners {
            let (low, high) = ends(corner);
            sorted[place[low as usize] as usize] = (high, index(corner));
            place[low as usize] += 1;
        }
        let mut twin = vec![NONE; corners];
        for vertex in 0..vertices {
            let bucket = &mut sorted[start[vertex as usize] as usize..start[vertex as usize + 1] as usize];
            bucket.sort_unstable();
            for group in bucket.chunk_by(|one, other| one.0 == other.0) {
                match group {
                    [_] => {}
                    [(_, one), (_, other)] => {
                        if self.corner_vertex[*one as usize] == self.corner_vertex[*other as usize] {
                            return Err(SubdivideFault::Opposed { a: vertex, b: group[0].0 });
                        }
                        (twin[*one as usize], twin[*other as usize]) = (*other, *one);
                    }
                    many => {
                        let faces = index(many.len());
                        return Err(SubdivideFault::ManyFaces { a: vertex, b: many[0].0, faces });
                    }
                }
            }
        }
        self.corner_edge = vec![NONE; corners];
        for (corner, &other) in twin.iter().enumerate() {
            if other == NONE || other as usize > corner {
                self.corner_edge[corner] = index(self.edge_corner.len());
                self.edge_corner.push(index(corner));
            } else {
                self.corner_edge[corner] = self.corner_edge[other as usize];
            }
        }
        self.twin = twin;
        Ok(())
    }

    /// Finds the first corner of each vertex's fan.
    fn find_fans(&mut self, vertices: u32) -> Result<(), SubdivideFault> {
        let mut count = vec![0_u32; vertices as usize];
        self.vertex_corner = vec![NONE; vertices as usize];
        for corner in 0..self.corners() {
            let vertex = self.corner_vertex[corner] as usize;
            count[vertex] += 1;
            if self.vertex_corner[vertex] == NONE || self.twin[corner] == NONE {
                self.vertex_corner[vertex] = index(corner);
            }
        }
        let mut ring = Ring::default();
        for vertex in 0..vertices {
            if count[vertex as usize] == 0 {
                return Err(SubdivideFault::Isolated { vertex });
            }
            self.ring(vertex, &mut ring);
            if ring.corners.len() != count[vertex as usize] as usize {
                return Err(SubdivideFault::Pinched { vertex });
            }
        }
        Ok(())
    }

    /// How many faces there are.
    #[must_use]
    pub fn faces(&self) -> usize {
        self.face_start.len().saturating_sub(1)
    }

    /// How many vertices there are.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.vertex_corner.len()
    }

    /// How many edges there are.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edge_corner.len()
    }

    /// How many corners the faces have together.
    #[must_use]
    pub fn corners(&self) -> usize {
        self.corner_vertex.len()
    }

    /// The vertices of a face.
    #[must_use]
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corner_vertex[self.face_range(face)]
    }

    /// The ends of an edge.
    #[must_use]
    pub fn ends(&self, edge: u32) -> [u32; 2] {
        let corner = self.edge_corner[edge as usize];
        [self.corner_vertex[corner as usize], self.corner_vertex[self.next(corner) as usize]]
    }

    /// Whether an edge has a face on one side alone.
    #[must_use]
    pub fn is_border(&self, edge: u32) -> bool {
        self.twin[self.edge_corner[edge as usize] as usize] == NONE
    }

    /// The edge between two vertices.
    #[must_use]
    pub fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        let mut ring = Ring::default();
        self.ring(a, &mut ring);
        ring.far.iter().position(|far| *far == b).map(|found| ring.edges[found])
    }

    pub(super) fn face_range(&self, face: usize) -> std::ops::Range<usize> {
        self.face_start[face] as usize..self.face_start[face + 1] as usize
    }

    pub(super) fn next(&self, corner: u32) -> u32 {
        let face = self.corner_face[corner as usize] as usize;
        if corner + 1 == self.face_start[face + 1] { self.face_start[face] } else { corner + 1 }
    }

    pub(super) fn before(&self, corner: u32) -> u32 {
        let face = self.corner_face[corner as usize] as usize;
        if corner == self.face_start[face] { self.face_start[face + 1] - 1 } else { corner - 1 }
    }

    /// Collects what lies around a vertex.
    pub(super) fn ring(&self, vertex: u32, ring: &mut Ring) {
        ring.vertex = vertex;
        ring.corners.clear();
        ring.edges.clear();
        ring.far.clear();
        let first = self.vertex_corner[vertex as usize];
        let mut corner = first;
        loop {
            ring.corners.push(corner);
            ring.edges.push(self.corner_edge[corner as usize]);
            ring.far.push(self.corner_vertex[self.next(corner) as usize]);
            let before = self.before(corner);
            corner = self.twin[before as usize];
            if corner == NONE {
                ring.edges.push(self.corner_edge[before as usize]);
                ring.far.push(self.corner_vertex[before as usize]);
                return;
            }
            if corner == first {
                return;
            }
        }
    }
}

//! Facts about the lines of a written mesh.

use serde::Serialize;

use super::Box3;

/// What [`measure_lines`] finds. Lines hang together where they share a vertex of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LineFacts {
    /// Sets of segments that hang together.
    pub curves: u64,
    /// Those of them whose every vertex joins two segments.
    pub closed_curves: u64,
    /// Segments.
    pub segments: u64,
    /// Vertices in the file.
    pub vertices: u64,
    /// Length of all segments, metres.
    pub length: f64,
    /// The box of all vertices.
    pub bounds: Option<Box3>,
}

/// Measures pairs of vertices. Linear.
#[must_use]
pub fn measure_lines(positions: &[[f32; 3]], segments: &[[u32; 2]]) -> LineFacts {
    let mut joined: Vec<u32> = (0..).take(positions.len()).collect();
    let mut uses = vec![0_u32; positions.len()];
    let mut length = 0.0;
    for [from, to] in segments {
        let [a, b] = [from, to].map(|vertex| positions[*vertex as usize].map(f64::from));
        length += glam::DVec3::from_array(a).distance(glam::DVec3::from_array(b));
        for vertex in [from, to] {
            uses[*vertex as usize] += 1;
        }
        let (a, b) = (find(&mut joined, *from), find(&mut joined, *to));
        joined[a.max(b) as usize] = a.min(b);
    }
    let mut closed = vec![true; positions.len()];
    let mut roots = vec![false; positions.len()];
    for (vertex, uses) in (0..).zip(&uses) {
        if *uses > 0 {
            let root = find(&mut joined, vertex) as usize;
            roots[root] = true;
            closed[root] &= *uses == 2;
        }
    }
    let count = |flags: &mut dyn Iterator<Item = bool>| flags.filter(|flag| *flag).count() as u64;
    LineFacts {
        curves: count(&mut roots.iter().copied()),
        closed_curves: count(&mut roots.iter().zip(&closed).map(|(root, closed)| *root && *closed)),
        segments: segments.len() as u64,
        vertices: positions.len() as u64,
        length,
        bounds: super::bounds_of(positions),
    }
}

fn find(joined: &mut [u32], mut vertex: u32) -> u32 {
    while joined[vertex as usize] != vertex {
        joined[vertex as usize] = joined[joined[vertex as usize] as usize];
        vertex = joined[vertex as usize];
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::measure_lines;

    #[test]
    fn curves_are_told_apart_by_their_vertices() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mut positions = square.to_vec();
        positions.extend(square);
        let segments = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7]];
        let facts = measure_lines(&positions, &segments);
        assert_eq!((facts.curves, facts.closed_curves, facts.segments), (2, 1, 7));
        assert_eq!((facts.vertices, facts.length), (8, 7.0));
        assert_eq!(facts.bounds.map(|bounds| bounds.max), Some([1.0, 1.0, 0.0]));
    }
}

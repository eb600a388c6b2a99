//! Holds a triangulation against its polygon: mends what ear cutting leaves out, and refuses what is wrong.
//!
//! Ear cutting drops corners that lie on a line between their neighbours, and takes one of several corners that
//! stand on one place. Both leave edges that do not meet:
//!
//! ```text
//!   u-----------w      the edge u-w has no partner: v was dropped
//!    \         /
//!     \       /        every place on the edge splits its triangle:
//!   u--v--w  c         (u, w, c) becomes (u, v, c), (v, w, c)
//! ```
//!
//! A *place* is a position; corners that touch share one.

use std::collections::HashMap;

use glam::DVec2;

use super::Polygon;

/// Rounding in the area of one triangle, relative to the square of the polygon's extent.
const AREA_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Whether several corners stand on one place.
pub(super) fn has_touching_corners(polygon: &Polygon) -> bool {
    let places = Places::new(&polygon.corners);
    places.count < polygon.corners.len()
}

/// The triangulation with every boundary edge used exactly once by its own corners; `None` where it is wrong.
pub(super) fn conform(polygon: &Polygon, triangles: Vec<[u32; 3]>) -> Option<Vec<[u32; 3]>> {
    let places = Places::new(&polygon.corners);
    let boundary = Boundary::new(polygon, &places)?;
    let mut mesh = Edges::new(&places, triangles)?;
    let corner_limit = 4 * polygon.corners.len();
    loop {
        let loose = mesh.loose(&boundary);
        if loose.is_empty() {
            break;
        }
        if !mesh.split_all(polygon, &loose) || mesh.triangles.len() > corner_limit {
            return None;
        }
        mesh = Edges::new(&places, mesh.triangles)?;
    }
    let whole = boundary.0.keys().all(|edge| mesh.owner.contains_key(edge));
    if !whole || !areas_agree(polygon, &mesh.triangles) {
        return None;
    }
    if places.count < polygon.corners.len() { mesh.with_own_corners(&boundary) } else { Some(mesh.triangles) }
}

/// Which place each corner stands on, named by its first corner.
struct Places {
    of: Vec<u32>,
    count: usize,
}

impl Places {
    fn new(corners: &[DVec2]) -> Self {
        let mut first: HashMap<[u64; 2], u32> = HashMap::with_capacity(corners.len());
        let mut of = Vec::with_capacity(corners.len());
        for (corner, point) in (0..).zip(corners) {
            // Adding zero turns -0 into 0.
            let bits = [(point.x + 0.0).to_bits(), (point.y + 0.0).to_bits()];
            of.push(*first.entry(bits).or_insert(corner));
        }
        Self { of, count: first.len() }
    }

    fn edge(&self, [a, b]: [u32; 2]) -> [u32; 2] {
        [self.of[a as usize], self.of[b as usize]]
    }
}

/// The polygon's edges by place, with the corners that own them.
struct Boundary(HashMap<[u32; 2], [u32; 2]>);

impl Boundary {
    /// `None` when an edge occurs twice in one direction.
    fn new(polygon: &Polygon, places: &Places) -> Option<Self> {
        let mut owners = HashMap::with_capacity(polygon.corners.len());
        for edge in polygon.edges() {
            if owners.insert(places.edge(edge), edge).is_some() {
                return None;
            }
        }
        Some(Self(owners))
    }
}

/// Triangles with the directed edges they own, by place.
struct Edges<'a> {
    places: &'a Places,
    triangles: Vec<[u32; 3]>,
    owner: HashMap<[u32; 2], u32>,
}

impl<'a> Edges<'a> {
    /// `None` when two triangles own one directed edge, or a triangle has two corners on one place.
    fn new(places: &'a Places, triangles: Vec<[u32; 3]>) -> Option<Self> {
        let mut owner = HashMap::with_capacity(3 * triangles.len());
        for (number, &[a, b, c]) in (0..).zip(&triangles) {
            for edge in [[a, b], [b, c], [c, a]] {
                let edge = places.edge(edge);
                if edge[0] == edge[1] || owner.insert(edge, number).is_some() {
                    return None;
                }
            }
        }
        Some(Self { places, triangles, owner })
    }

    /// Edges of triangles that have no partner and are not on the boundary, in the order of the triangles.
    fn loose(&self, boundary: &Boundary) -> Vec<(u32, usize)> {
        let mut loose = Vec::new();
        for (number, &triangle) in (0..).zip(&self.triangles) {
            for side in 0..3 {
                let [from, to] = self.places.edge([triangle[side], triangle[(side + 1) % 3]]);
                if !boundary.0.contains_key(&[from, to]) && !self.owner.contains_key(&[to, from]) {
                    loose.push((number, side));
                }
            }
        }
        loose
    }

    /// Splits triangles at the places on their loose edges (one edge of a triangle at a time); whether any was.
    fn split_all(&mut self, polygon: &Polygon, loose: &[(u32, usize)]) -> bool {
        let before = self.triangles.len();
        let mut last = u32::MAX;
        for &(number, side) in loose {
            if number != last && self.split(polygon, number as usize, side) {
                last = number;
            }
        }
        self.triangles.len() > before
    }

    fn split(&mut self, polygon: &Polygon, number: usize, side: usize) -> bool {
        let triangle = self.triangles[number];
        let [from, to, apex] = [0, 1, 2].map(|step| triangle[(side + step) % 3]);
        let mut between = places_between(polygon, self.places, [from, to]);
        if between.is_empty() {
            return false;
        }
        between.push(to);
        self.triangles[number] = [from, between[0], apex];
        self.triangles.extend(between.windows(2).map(|pair| [pair[0], pair[1], apex]));
        true
    }

    /// Triangles that name, of the corners on one place, the one whose sector of the polygon they lie in.
    fn with_own_corners(&self, boundary: &Boundary) -> Option<Vec<[u32; 3]>> {
        let mut named = self.triangles.clone();
        for (number, triangle) in named.iter_mut().enumerate() {
            for (side, corner) in triangle.iter_mut().enumerate() {
                *corner = self.own_corner(boundary, number, side)?;
            }
        }
        Some(named)
    }

    /// Turns clockwise around the place until the boundary; the edge found there begins at the corner wanted.
    fn own_corner(&self, boundary: &Boundary, number: usize, side: usize) -> Option<u32> {
        let triangle = self.triangles[number];
        let place = self.places.of[triangle[side] as usize];
        let mut edge = self.places.edge([triangle[side], triangle[(side + 1) % 3]]);
        for _ in 0..=self.triangles.len() {
            if let Some(owner) = boundary.0.get(&edge) {
                return Some(owner[0]);
            }
            let across = self.triangles[*self.owner.get(&[edge[1], edge[0]])? as usize];
            let at = across.iter().position(|&corner| self.places.of[corner as usize] == place)?;
            edge = self.places.edge([across[at], across[(at + 1) % 3]]);
        }
        None
    }
}

/// Corners (one for each place) strictly between the ends of an edge and within rounding of it, in its direction.
fn places_between(polygon: &Polygon, places: &Places, [from, to]: [u32; 2]) -> Vec<u32> {
    let (start, end) = (polygon.corners[from as usize], polygon.corners[to as usize]);
    let along = end - start;
    let length_squared = along.length_squared();
    let slack = AREA_ROUNDING * (extent_squared(polygon) * length_squared).sqrt();
    let mut found: Vec<(f64, u32)> = Vec::new();
    for (corner, (&point, &place)) in (0..).zip(polygon.corners.iter().zip(&places.of)) {
        let part = (point - start).dot(along);
        let inside = part > 0.0 && part < length_squared && place == corner;
        if inside && point != end && point != start && super::turn(start, end, point).abs() <= slack {
            found.push((part, corner));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found.into_iter().map(|(_, corner)| corner).collect()
}

fn extent_squared(polygon: &Polygon) -> f64 {
    let low = polygon.corners.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = polygon.corners.iter().copied().reduce(DVec2::max).unwrap_or_default();
    (high - low).length_squared()
}

/// No triangle is turned over and the areas add up, both within rounding.
fn areas_agree(polygon: &Polygon, triangles: &[[u32; 3]]) -> bool {
    let slack = AREA_ROUNDING * extent_squared(polygon);
    let mut total = 0.0;
    for &triangle in triangles {
        let area = polygon.turn(triangle);
        if area < -slack {
            return false;
        }
        total += area;
    }
    #[expect(clippy::cast_precision_loss, reason = "an error bound need not be exact")]
    let corners = polygon.corners.len() as f64;
    (total - polygon.area).abs() <= slack * corners
}

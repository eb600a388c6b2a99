//! A Delaunay triangulation of whole-numbered places that grows point by point.
//!
//! Promise: every decision is exact, so the triangulation is Delaunay after each insertion and depends on nothing but the
//! order of the points. Coordinates are below 2^29 in size: products of two differences fit 64 bits, of four 128.
//!
//! Notation: half-edge e belongs to triangle e / 3 and runs from corner `corners[e]` to the next corner of its triangle;
//! `opposite[e]` is the same edge in the triangle beyond, or [`BORDER`]. Triangles turn counter-clockwise when x points
//! right and y up.
//!
//! Sources: C. Lawson, "Software for C1 surface interpolation", 1977 (insertion and flips); the arrays of half-edges are
//! those of V. Agafonkin's "delatin" and "delaunator".

/// No triangle beyond.
pub(super) const BORDER: u32 = u32::MAX;

/// The bit of lines that stay edges and bound nothing.
pub(super) const FIXED: u32 = 1 << 31;

/// A place in units of the finest grid.
pub(super) type Place = [i32; 2];

/// A triangulation of a rectangle.
pub(super) struct Delaunay {
    pub(super) places: Vec<Place>,
    pub(super) corners: Vec<u32>,
    pub(super) opposite: Vec<u32>,
    /// Half-edges that may be wrong.
    suspects: Vec<u32>,
    /// For each half-edge the lines that run along it, one bit each; where there are any it is never turned. Empty
    /// until lines are drawn.
    pub(super) lines: Vec<u32>,
    /// For each corner a half-edge that begins there; empty until lines are drawn.
    pub(super) out_of: Vec<u32>,
    /// For each triangle whether corners may be set in it; empty where they may in all.
    pub(super) kept: Vec<bool>,
    /// Triangles that the last insertion made or changed, each once.
    pub(super) changed: Vec<u32>,
}

/// Where a place lies.
enum Found {
    Inside(u32),
    On(u32),
    /// On the corner at which this half-edge begins.
    Corner(u32),
    Outside,
}

/// Twice the area of a triangle, positive when it turns counter-clockwise.
pub(super) fn turn(a: Place, b: Place, c: Place) -> i64 {
    let difference = |from: Place, to: Place| [0, 1].map(|k| i64::from(to[k]) - i64::from(from[k]));
    let (ab, ac) = (difference(a, b), difference(a, c));
    ab[0] * ac[1] - ab[1] * ac[0]
}

/// Whether d lies inside the circle through the corners of a counter-clockwise triangle.
#[expect(clippy::cast_precision_loss, reason = "the rounded result is used where it is beyond doubt")]
pub(super) fn in_circle(a: Place, b: Place, c: Place, d: Place) -> bool {
    let from = |p: Place| [0, 1].map(|k| i64::from(p[k]) - i64::from(d[k]));
    let [a, b, c] = [from(a), from(b), from(c)];
    let cross = |p: [i64; 2], q: [i64; 2]| p[0] * q[1] - p[1] * q[0];
    let square = |p: [i64; 2]| p[0] * p[0] + p[1] * p[1];
    let parts = [(square(a), cross(b, c)), (square(b), cross(c, a)), (square(c), cross(a, b))];
    // Each factor is exact; three roundings of products and two of sums are below 4 units of the sum of their sizes.
    let products = parts.map(|(square, cross)| square as f64 * cross as f64);
    let sum = products[0] + products[1] + products[2];
    let size = products[0].abs() + products[1].abs() + products[2].abs();
    if sum.abs() > 8.0 * f64::EPSILON * size {
        return sum > 0.0;
    }
    parts.iter().map(|(square, cross)| i128::from(*square) * i128::from(*cross)).sum::<i128>() > 0
}

pub(super) fn next(edge: u32) -> u32 {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

pub(super) fn previous(edge: u32) -> u32 {
    if edge.is_multiple_of(3) { edge + 2 } else { edge - 1 }
}

impl Delaunay {
    /// Two triangles over the rectangle from 0 to `far`. Its corners are places 0 to 3, counter-clockwise from 0.
    pub(super) fn new(far: Place) -> Self {
        let places = vec![[0, 0], [far[0], 0], far, [0, far[1]]];
        Self {
            places,
            corners: vec![0, 1, 2, 0, 2, 3],
            opposite: vec![BORDER, BORDER, 3, 2, BORDER, BORDER],
            suspects: Vec::new(),
            lines: Vec::new(),
            out_of: Vec::new(),
            kept: Vec::new(),
            changed: Vec::new(),
        }
    }

    pub(super) fn triangles(&self) -> u32 {
        crate::geometry::mesh::index(self.corners.len() / 3)
    }

    pub(super) fn corners_of(&self, triangle: u32) -> [u32; 3] {
        let at = 3 * triangle as usize;
        [self.corners[at], self.corners[at + 1], self.corners[at + 2]]
    }

    pub(super) fn beyond(&self, edge: u32) -> u32 {
        self.opposite[edge as usize]
    }

    pub(super) fn place(&self, edge: u32) -> Place {
        self.places[self.corners[edge as usize] as usize]
    }

    /// The lines along a half-edge.
    pub(super) fn line(&self, edge: u32) -> u32 {
        self.lines.get(edge as usize).copied().unwrap_or(0)
    }

    /// Whether corners may be set in a triangle.
    pub(super) fn keeps(&self, triangle: u32) -> bool {
        self.kept.get(triangle as usize).copied().unwrap_or(true)
    }

    /// Adds a place inside the rectangle or on its border, looked for from a triangle near by. None when a corner
    /// stands there already, or where none may stand: on a line, or in a triangle that is not kept. Else its number, and
    /// [`Self::changed`] lists the triangles around it.
    pub(super) fn insert(&mut self, place: Place, near: u32) -> Option<u32> {
        match self.locate(place, near) {
            Found::Inside(triangle) if self.keeps(triangle) => {
                Some(self.split(place, |mesh, corner| mesh.split_triangle(triangle, corner)))
            }
            Found::On(edge) if self.keeps(edge / 3) && self.line(edge) == 0 => {
                Some(self.split(place, |mesh, corner| mesh.split_edge(edge, corner)))
            }
            _ => None,
        }
    }

    /// The corner at a place, added where there is none yet, on lines too. None outside of the rectangle.
    pub(super) fn corner_at(&mut self, place: Place, near: u32) -> Option<u32> {
        match self.locate(place, near) {
            Found::Inside(triangle) => {
                Some(self.split(place, |mesh, corner| mesh.split_triangle(triangle, corner)))
            }
            Found::On(edge) => Some(self.split(place, |mesh, corner| mesh.split_edge(edge, corner))),
            Found::Corner(edge) => Some(self.corners[edge as usize]),
            Found::Outside => None,
        }
    }

    fn split(&mut self, place: Place, at: impl FnOnce(&mut Self, u32)) -> u32 {
        let corner = crate::geometry::mesh::index(self.places.len());
        self.places.push(place);
        if !self.out_of.is_empty() {
            self.out_of.push(BORDER);
        }
        self.changed.clear();
        at(self, corner);
        self.settle();
        corner
    }

    /// A walk straight towards the place; ends since the triangulation is Delaunay (L. Guibas and J. Stolfi, 1985). Lines
    /// may lead it in circles: then all triangles are looked at.
    fn locate(&self, place: Place, near: u32) -> Found {
        let mut edge = 3 * near;
        let mut came_from = BORDER;
        let mut steps = self.triangles();
        loop {
            if steps == 0 {
                return self.search(place);
            }
            steps -= 1;
            let mut on = BORDER;
            let mut out = BORDER;
            let mut corners = 0;
            for side in [edge, next(edge), previous(edge)] {
                if side == came_from {
                    continue;
                }
                match turn(self.place(side), self.place(next(side)), place) {
                    turn if turn < 0 => out = side,
                    0 => {
                        on = side;
                        corners += 1;
                    }
                    _ => {}
                }
                if out != BORDER {
                    break;
                }
            }
            if out == BORDER {
                return self.found(edge / 3, if corners == 0 { BORDER } else { on }, place);
            }
            came_from = self.opposite[out as usize];
            if came_from == BORDER {
                return Found::Outside;
            }
            edge = came_from;
        }
    }

    /// Looks at every triangle.
    fn search(&self, place: Place) -> Found {
        for triangle in 0..self.triangles() {
            let sides = 3 * triangle..3 * triangle + 3;
            let turns = sides.clone().map(|side| turn(self.place(side), self.place(next(side)), place));
            if turns.clone().all(|turn| turn >= 0) {
                let on = sides.zip(turns).find(|(_, turn)| *turn == 0).map_or(BORDER, |(side, _)| side);
                return self.found(triangle, on, place);
            }
        }
        Found::Outside
    }

    /// A place in a triangle, or on a side of it.
    fn found(&self, triangle: u32, on: u32, place: Place) -> Found {
        let corner = (3 * triangle..3 * triangle + 3).find(|side| self.place(*side) == place);
        match (corner, on) {
            (_, BORDER) => Found::Inside(triangle),
            (Some(corner), _) => Found::Corner(corner),
            (None, on) => Found::On(on),
        }
    }

    /// One triangle into three.
    ///
    /// ```text
    ///         c
    ///       / | \
    ///      /  p  \        abc -> abp, bcp, cap
    ///     / /   \ \
    ///    a ------- b
    /// ```
    fn split_triangle(&mut self, triangle: u32, p: u32) {
        let [a, b, c] = self.corners_of(triangle);
        let first = 3 * triangle;
        let [ab, bc, ca] = [0, 1, 2].map(|k| self.opposite[(first + k) as usize]);
        let [line_ab, line_bc, line_ca] = [0, 1, 2].map(|k| self.line(first + k));
        let second = self.add([b, c, p], triangle);
        let third = self.add([c, a, p], triangle);
        self.set(first, [a, b, p]);
        self.draw_along(first, [line_ab, 0, 0]);
        self.draw_along(second, [line_bc, 0, 0]);
        self.draw_along(third, [line_ca, 0, 0]);
        self.join(first, ab);
        self.join(first + 1, second + 2);
        self.join(first + 2, third + 1);
        self.join(second, bc);
        self.join(second + 1, third + 2);
        self.join(third, ca);
        self.suspects.extend([first, second, third]);
        self.changed.extend([first / 3, second / 3, third / 3]);
    }

    /// The one or two triangles at an edge into two or four.
    ///
    /// ```text
    ///         c                    c
    ///       /   \                / | \
    ///      a --- b     ->       a- p -b       abc -> apc, pbc
    ///       \   /                \ | /        bad -> bpd, pad
    ///         d                    d
    /// ```
    fn split_edge(&mut self, edge: u32, p: u32) {
        let (e, f, g) = (edge, next(edge), previous(edge));
        let [a, b, c] = [e, f, g].map(|edge| self.corners[edge as usize]);
        let beyond = self.opposite[e as usize];
        let bc = self.opposite[f as usize];
        let ca = self.opposite[g as usize];
        let [line, line_bc, line_ca] = [e, f, g].map(|edge| self.line(edge));
        let triangle = 3 * (edge / 3);
        self.set(triangle, [a, p, c]);
        self.join(triangle + 2, ca);
        let other = self.add([p, b, c], edge / 3);
        self.draw_along(triangle, [line, 0, line_ca]);
        self.draw_along(other, [line, line_bc, 0]);
        self.join(other + 1, bc);
        self.join(triangle + 1, other + 2);
        self.suspects.extend([triangle + 2, other + 1]);
        self.changed.extend([triangle / 3, other / 3]);
        if beyond == BORDER {
            self.join(triangle, BORDER);
            self.join(other, BORDER);
            return;
        }
        let [ad, db] = [next(beyond), previous(beyond)].map(|edge| self.opposite[edge as usize]);
        let [line_ad, line_db] = [next(beyond), previous(beyond)].map(|edge| self.line(edge));
        let d = self.corners[previous(beyond) as usize];
        let below = 3 * (beyond / 3);
        self.set(below, [b, p, d]);
        self.join(below + 2, db);
        let left = self.add([p, a, d], beyond / 3);
        self.draw_along(below, [line, 0, line_db]);
        self.draw_along(left, [line, line_ad, 0]);
        self.join(left + 1, ad);
        self.join(below + 1, left + 2);
        self.join(below, other);
        self.join(left, triangle);
        self.suspects.extend([below + 2, left + 1]);
        self.changed.extend([below / 3, left / 3]);
    }

    /// A triangle more, kept if another is.
    fn add(&mut self, corners: [u32; 3], like: u32) -> u32 {
        let edge = crate::geometry::mesh::index(self.corners.len());
        self.corners.extend(corners);
        self.opposite.extend([BORDER; 3]);
        if !self.lines.is_empty() {
            self.lines.extend([0; 3]);
        }
        if !self.kept.is_empty() {
            self.kept.push(self.kept[like as usize]);
        }
        self.note_corners(edge);
        edge
    }

    fn set(&mut self, edge: u32, corners: [u32; 3]) {
        self.corners[edge as usize..edge as usize + 3].copy_from_slice(&corners);
        self.note_corners(edge);
    }

    fn note_corners(&mut self, edge: u32) {
        if !self.out_of.is_empty() {
            for side in edge..edge + 3 {
                self.out_of[self.corners[side as usize] as usize] = side;
            }
        }
    }

    /// The lines along the sides of a triangle.
    fn draw_along(&mut self, edge: u32, lines: [u32; 3]) {
        if !self.lines.is_empty() {
            self.lines[edge as usize..edge as usize + 3].copy_from_slice(&lines);
        }
    }

    pub(super) fn join(&mut self, edge: u32, other: u32) {
        self.opposite[edge as usize] = other;
        if other != BORDER {
            self.opposite[other as usize] = edge;
        }
    }

    /// Turns suspect edges until all are right. Each suspect is opposite to the new corner in its triangle.
    ///
    /// ```text
    ///        p                p
    ///      /   \            / | \
    ///     a --- b    ->    a  |  b       pab, qba -> pqb, qpa
    ///      \   /            \ | /
    ///        q                q
    /// ```
    fn settle(&mut self) {
        while let Some(ab) = self.suspects.pop() {
            let ba = self.opposite[ab as usize];
            if ba == BORDER || self.line(ab) != 0 {
                continue;
            }
            let (bp, pa) = (next(ab), previous(ab));
            let (aq, qb) = (next(ba), previous(ba));
            let [a, b, p, q] = [ab, bp, pa, qb].map(|edge| self.place(edge));
            if !in_circle(a, b, p, q) {
                continue;
            }
            self.flip(ab);
            self.suspects.extend([ab, aq]);
            let changed = ba / 3;
            if !self.changed.contains(&changed) {
                self.changed.push(changed);
            }
        }
    }

    /// Turns an edge ab without lines that has a triangle on both sides: its half-edge is q to b afterwards.
    pub(super) fn flip(&mut self, ab: u32) {
        let ba = self.opposite[ab as usize];
        let (pa, qb) = (previous(ab), previous(ba));
        let (p, q) = (self.corners[pa as usize], self.corners[qb as usize]);
        let (outer_pa, outer_qb) = (self.opposite[pa as usize], self.opposite[qb as usize]);
        // ab starts at q now: q, b, p; ba starts at p: p, a, q.
        self.corners[ab as usize] = q;
        self.corners[ba as usize] = p;
        self.join(ab, outer_qb);
        self.join(ba, outer_pa);
        self.join(pa, qb);
        if !self.lines.is_empty() {
            self.lines[ab as usize] = self.lines[qb as usize];
            self.lines[ba as usize] = self.lines[pa as usize];
            self.lines[pa as usize] = 0;
            self.lines[qb as usize] = 0;
        }
        self.note_corners(3 * (ab / 3));
        self.note_corners(3 * (ba / 3));
    }
}

#[cfg(test)]
mod tests {
    use super::{BORDER, Delaunay, in_circle, turn};

    fn check(mesh: &Delaunay, twice_area: i64) {
        let mut sum = 0;
        for triangle in 0..mesh.triangles() {
            let [a, b, c] = mesh.corners_of(triangle).map(|corner| mesh.places[corner as usize]);
            let area = turn(a, b, c);
            assert!(area > 0);
            sum += area;
            for edge in 3 * triangle..3 * triangle + 3 {
                let other = mesh.beyond(edge);
                if other == BORDER {
                    continue;
                }
                assert_eq!(mesh.beyond(other), edge);
                assert_eq!(mesh.place(edge), mesh.place(super::next(other)));
                let apex = mesh.place(super::previous(other));
                assert!(!in_circle(a, b, c, apex));
            }
        }
        assert_eq!(sum, twice_area);
    }

    #[test]
    fn it_stays_delaunay_whatever_comes() {
        let mut state = 7_u64;
        let mut random = |below: i32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            i32::try_from((state >> 33) % u64::from(below.unsigned_abs())).unwrap()
        };
        for (far, count) in [([20, 20], 300), ([1 << 28, 1 << 28], 400), ([3, 500], 600)] {
            let mut mesh = Delaunay::new(far);
            let mut known = mesh.places.clone();
            for _ in 0..count {
                let place = [random(far[0] + 1), random(far[1] + 1)];
                let near = u32::try_from(random(i32::try_from(mesh.triangles()).unwrap())).unwrap();
                let inserted = mesh.insert(place, near);
                assert_eq!(inserted.is_some(), !known.contains(&place));
                known.push(place);
            }
            check(&mesh, 2 * i64::from(far[0]) * i64::from(far[1]));
        }
    }

    #[test]
    fn a_whole_grid_closes() {
        let mut mesh = Delaunay::new([12, 9]);
        for y in 0..=9 {
            for x in 0..=12 {
                mesh.insert([x, y], 0);
            }
        }
        check(&mesh, 2 * 12 * 9);
        assert_eq!(mesh.triangles(), 2 * 12 * 9);
    }
}

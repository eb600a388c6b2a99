//! Boxes with rounded edges and corners.
//!
//! Each side is a grid: a flat middle, and around it half of each rounding. A place of the grid has on each axis a
//! number from -1 to 1, the tangent of an angle in steps of 45 degrees / m; 1 and -1 stand on the border between two
//! sides, 0 where the rounding ends. Its direction (x, y, z), with one of the three +-1, is that of the surface's
//! normal, so the grids of the six sides agree on their borders, and the point is that of the core (the box without
//! its rounding) plus the radius along the direction.
//!
//! The bound is proved: points of an edge lie on a cylinder, those of a corner on a ball, and rays from its axis or
//! middle pair them with the surface.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::round::{fewest_pieces, sagitta};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::{cos_degrees, tan_degrees};

/// A box about the origin whose edges and corners are rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedBox {
    /// Lengths of its sides, metres.
    pub size: DVec3,
    /// Radius of the rounding, more than 0 and at most half the least side.
    pub radius: f64,
}

/// Flat parts narrower than this part of the box are none.
const FLAT: f64 = 1e-12;

/// The most steps in half of a quarter turn that are tried.
const MOST: u32 = 20_000;

impl RoundedBox {
    /// Half the lengths of the box without its rounding: where the middles of its balls lie.
    #[must_use]
    pub fn core(&self) -> DVec3 {
        let core = self.size / 2.0 - self.radius;
        core.map(|half| if half > FLAT * self.size.max_element() { half } else { 0.0 })
    }

    /// Distance of a point from the surface. Exact.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        let away = point.abs() - self.core();
        let outside = away.max(DVec3::ZERO).length();
        (outside + away.max_element().min(0.0) - self.radius).abs()
    }
}

/// Makes a rounded box. Each side shows the whole texture, to the middle of its roundings. Anchor source 0.
///
/// # Errors
/// When the limit would be passed.
pub fn rounded_box(shape: &RoundedBox, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let steps = match detail.density {
        SurfaceDensity::Grid { u, .. } => u.max(1),
        SurfaceDensity::Tolerance(tolerance) => {
            let affordable = (detail.triangle_limit / 48).isqrt();
            let most = u32::try_from(affordable).unwrap_or(MOST).clamp(1, MOST) + 1;
            fewest_pieces(tolerance / shape.radius, most, deviation)
        }
    };
    let grid = Grid::new(shape, steps);
    detail.allow(grid.triangles())?;
    let mesh = grid.mesh(detail.uv);
    let bound = deviation(steps) * shape.radius;
    Ok(Tessellation { mesh, deviation: Deviation { bound, evidence: Evidence::Proved } })
}

/// Distance of a rounding of radius 1 from its triangles: that of a third of a corner, or of an edge.
fn deviation(steps: u32) -> f64 {
    let step = 45.0 / f64::from(steps);
    let at = |i: u32, j: u32| {
        DVec3::new(tan_degrees(step * f64::from(i)), tan_degrees(step * f64::from(j)), 1.0).normalize()
    };
    let mut worst = 1.0 - cos_degrees(step / 2.0);
    for i in 0..steps {
        for j in i..steps {
            // As the grid cuts its cells: across the way to the corner.
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            worst = worst.max(sagitta([a, b, d], 1.0)).max(sagitta([b, c, d], 1.0));
        }
    }
    worst
}

/// Places along one axis, from the lower border to the upper.
struct Axis {
    /// Tangents of the angle to the side's normal.
    lean: Vec<f64>,
    /// Coordinate of the core.
    core: Vec<f64>,
    /// Part of the unrolled side.
    part: Vec<f64>,
}

impl Axis {
    fn new(core: f64, radius: f64, steps: u32) -> Self {
        let mut axis = Self { lean: Vec::new(), core: Vec::new(), part: Vec::new() };
        let arc = radius * core::f64::consts::FRAC_PI_4;
        let half = core + arc;
        for side in [-1.0, 1.0] {
            for k in 0..=steps {
                let out = if side < 0.0 { steps - k } else { k };
                if side > 0.0 && k == 0 && core == 0.0 {
                    // Without a flat part both roundings share their end.
                    continue;
                }
                let turn = f64::from(out) / f64::from(steps);
                let lean = if out == steps { 1.0 } else { tan_degrees(45.0 * turn) };
                axis.lean.push(side * lean);
                axis.core.push(side * core);
                axis.part.push(0.5 + side * (core + arc * turn) / half / 2.0);
            }
        }
        axis
    }

    fn cells(&self) -> u32 {
        mesh::index(self.lean.len()) - 1
    }
}

struct Grid {
    axes: [Axis; 3],
    radius: f64,
}

/// Outward normal of each side as axis and sense, and the direction to the right for who looks at it.
const SIDES: [((usize, bool), (usize, bool)); 6] = [
    ((0, true), (2, false)),
    ((0, false), (2, true)),
    ((1, true), (0, true)),
    ((1, false), (0, true)),
    ((2, true), (0, true)),
    ((2, false), (0, false)),
];

impl Grid {
    fn new(shape: &RoundedBox, steps: u32) -> Self {
        let core = shape.core().to_array();
        Self { axes: core.map(|core| Axis::new(core, shape.radius, steps)), radius: shape.radius }
    }

    fn triangles(&self) -> u64 {
        let [x, y, z] = [0, 1, 2].map(|axis| u64::from(self.axes[axis].cells()));
        4 * (x * y + y * z + z * x)
    }

    fn direction(&self, place: [u32; 3]) -> DVec3 {
        let lean = |axis: usize| self.axes[axis].lean[place[axis] as usize];
        DVec3::new(lean(0), lean(1), lean(2)).normalize()
    }

    fn position(&self, place: [u32; 3]) -> DVec3 {
        let core = |axis: usize| self.axes[axis].core[place[axis] as usize];
        DVec3::new(core(0), core(1), core(2)) + self.direction(place) * self.radius
    }

    fn mesh(&self, uv: bool) -> Mesh {
        let mut made = Made { grid: self, uv, mesh: Mesh::default(), points: HashMap::new() };
        for ((normal, positive), right) in SIDES {
            made.side(normal, positive, right);
        }
        let mut mesh = made.mesh;
        mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
        mesh
    }
}

struct Made<'a> {
    grid: &'a Grid,
    uv: bool,
    mesh: Mesh,
    /// Points by their place, for the borders that sides share.
    points: HashMap<[u32; 3], u32>,
}

impl Made<'_> {
    /// One side: rows from bottom to top, columns from left to right, for who looks at it.
    fn side(&mut self, normal: usize, positive: bool, (right, rightward): (usize, bool)) {
        let up = 3 - normal - right;
        // Up is normal x right: +1 for even permutations of the axes.
        let even = (normal + 1) % 3 == right;
        let upward = even == (positive == rightward);
        let axis = |axis: usize| &self.grid.axes[axis];
        let (columns, rows) = (axis(right).cells(), axis(up).cells());
        let toward = |cells: u32, k: u32, onward: bool| if onward { k } else { cells - k };
        let mut vertices = Vec::with_capacity(((columns + 1) * (rows + 1)) as usize);
        for row in 0..=rows {
            for column in 0..=columns {
                let mut place = [0; 3];
                place[normal] = if positive { self.grid.axes[normal].cells() } else { 0 };
                place[right] = toward(columns, column, rightward);
                place[up] = toward(rows, row, upward);
                let uv = DVec2::new(
                    self.grid.axes[right].part[column as usize],
                    1.0 - self.grid.axes[up].part[row as usize],
                );
                vertices.push(self.vertex(place, uv));
            }
        }
        let at = |row: u32, column: u32| vertices[(row * (columns + 1) + column) as usize];
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
                // Towards a corner cells are narrow across: they are cut there.
                if (2 * row < rows) == (2 * column < columns) {
                    self.mesh.triangles.extend([[a, b, d], [b, c, d]]);
                } else {
                    self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }

    fn vertex(&mut self, place: [u32; 3], uv: DVec2) -> VertexIndex {
        let next = mesh::index(self.mesh.points.len());
        let point = *self.points.entry(place).or_insert(next);
        if point == next {
            self.mesh.points.push(self.grid.position(place));
        } else if !self.uv {
            // Without texture coordinates each point has one vertex, of its own number.
            return VertexIndex(point);
        }
        let normal = self.grid.direction(place);
        let uv = if self.uv { uv } else { DVec2::ZERO };
        self.mesh.vertices.push(Vertex {
            point: PointIndex(point),
            normal,
            uv,
            color: Color::WHITE,
            anchor: Anchor::default(),
        });
        VertexIndex(mesh::index(self.mesh.vertices.len()) - 1)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use glam::DVec3;

    use super::{RoundedBox, rounded_box};
    use crate::geometry::mesh::{Mesh, topology};
    use crate::geometry::tessellate::{Detail, SurfaceDensity, Tessellation};

    fn made(size: [f64; 3], radius: f64, density: SurfaceDensity, uv: bool) -> Tessellation {
        let shape = RoundedBox { size: DVec3::from_array(size), radius };
        let detail = Detail { density, crease_angle: 30.0, uv, triangle_limit: 1 << 24 };
        rounded_box(&shape, &detail).expect("within the limit")
    }

    fn area_and_volume(mesh: &Mesh) -> (f64, f64) {
        mesh.triangles.iter().fold((0.0, 0.0), |(area, volume), triangle| {
            let [a, b, c] = triangle.map(|v| mesh.points[mesh.vertices[v.0 as usize].point.0 as usize]);
            let cross = (b - a).cross(c - a);
            assert!(cross.length() > 0.0, "no triangle is without area");
            (area + cross.length() / 2.0, volume + a.dot(cross) / 6.0)
        })
    }

    /// Every way in which flat sides vanish, down to the ball.
    const BOXES: [([f64; 3], f64); 6] = [
        ([3.0, 2.0, 1.0], 0.25),
        ([3.0, 2.0, 1.0], 0.5),
        ([1.0, 3.0, 1.0], 0.5),
        ([1.0, 1.0, 1.0], 0.5),
        ([0.3, 0.3, 0.3], 0.15),
        ([2.0, 1.0, 2.0], 0.5),
    ];

    #[test]
    fn all_limits_are_closed_balls_without_empty_triangles() {
        for (size, radius) in BOXES {
            for steps in [1, 2, 3, 7] {
                for uv in [false, true] {
                    let mesh = made(size, radius, SurfaceDensity::Grid { u: steps, v: 1 }, uv).mesh;
                    let corner = |k: usize| mesh.vertices[mesh.triangles[k / 3][k % 3].0 as usize].point.0;
                    let found =
                        topology::measure(mesh.triangles.len(), mesh.points.len(), corner).expect("small");
                    assert!(found.manifold && found.genus == Some(0), "{size:?} {radius} {steps}");
                    assert!(area_and_volume(&mesh).1 > 0.0);
                }
            }
        }
    }

    #[test]
    fn area_and_volume_come_near_those_of_steiner() {
        for (size, radius) in BOXES {
            let [x, y, z] = size.map(|side| side - 2.0 * radius);
            // J. Steiner: the body at a distance r around a box.
            let volume = x * y * z
                + 2.0 * radius * (x * y + y * z + z * x)
                + PI * radius * radius * (x + y + z)
                + 4.0 / 3.0 * PI * radius * radius * radius;
            let area =
                2.0 * (x * y + y * z + z * x) + 2.0 * PI * radius * (x + y + z) + 4.0 * PI * radius * radius;
            let mut last = f64::INFINITY;
            for tolerance in [1e-2, 1e-3, 1e-4] {
                let made = made(size, radius, SurfaceDensity::Tolerance(tolerance * radius), false);
                assert!(made.deviation.bound <= tolerance * radius * (1.0 + 1e-9));
                let (found_area, found_volume) = area_and_volume(&made.mesh);
                assert!(found_volume < volume && found_volume > volume - area * tolerance * radius);
                assert!(found_area < area && area - found_area < last / 5.0, "{size:?} {tolerance}");
                last = area - found_area;
            }
        }
    }

    #[test]
    fn every_sample_of_the_triangles_is_within_the_bound() {
        for (size, radius) in BOXES {
            let shape = RoundedBox { size: DVec3::from_array(size), radius };
            for steps in [1, 2, 5] {
                let made = made(size, radius, SurfaceDensity::Grid { u: steps, v: 1 }, false);
                let mesh = &made.mesh;
                let mut worst = 0.0_f64;
                for triangle in &mesh.triangles {
                    let [a, b, c] = triangle.map(|v| mesh.points[v.0 as usize]);
                    for (s, t) in [(0.5, 0.5), (0.5, 0.0), (0.0, 0.5), (1.0 / 3.0, 1.0 / 3.0), (0.0, 0.0)] {
                        worst = worst.max(shape.distance(a * (1.0 - s - t) + b * s + c * t));
                    }
                }
                assert!(worst <= made.deviation.bound * (1.0 + 1e-9) + 1e-15, "{worst}");
                assert!(worst >= made.deviation.bound * 0.9, "the bound is met: {worst}");
            }
        }
    }
}

//! The edges of a quadric that half spaces cut: vertices, lines between them, and which faces each line bounds.
//!
//! Walls are given in general position (no line of two walls touches the quadric, no wall does); what would touch is
//! separated before, by moving walls outward by less than can be seen.

use glam::DVec3;

use super::Job;
use crate::geometry::field::quadric::HalfSpace;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::mesh;
use crate::geometry::tessellate::TessellateError;
use crate::geometry::tessellate::region::{Arc, Line, PlaneSection, stations};

/// A quadric and the walls that hold it.
pub(super) struct Body<'a> {
    pub(super) quadric: &'a Quadric,
    /// What bounds the body.
    pub(super) walls: &'a [HalfSpace],
    /// For each plane, walls first, whether it only touches the apex.
    pub(super) touching: &'a [bool],
    /// Planes that part its sheets.
    pub(super) cuts: &'a [HalfSpace],
    /// The apex of a cone.
    pub(super) apex: Option<DVec3>,
    /// A point in the middle, and about how far the body reaches.
    pub(super) around: DVec3,
    pub(super) size: f64,
}

/// An edge: points along it.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    /// Indices of points, the ends included; a closed one ends where it starts.
    pub(super) points: Vec<u32>,
    /// A point of the true line, away from its ends.
    pub(super) middle: DVec3,
    /// Whether it lies on the quadric.
    pub(super) on_quadric: bool,
    /// The planes that it lies on: walls, then cuts.
    pub(super) planes: [Option<usize>; 2],
}

impl Edge {
    pub(super) fn lies_on(&self, plane: usize) -> bool {
        self.planes.contains(&Some(plane))
    }
}

/// All edges, cut into chords.
#[derive(Clone, Debug, Default)]
pub(super) struct Skeleton {
    pub(super) points: Vec<DVec3>,
    pub(super) edges: Vec<Edge>,
    /// Index of the apex.
    pub(super) apex: Option<u32>,
    /// The most that a chord leaves out.
    pub(super) out: f64,
}

/// A vertex on two planes.
struct Vertex {
    index: usize,
    point: DVec3,
    planes: [usize; 2],
}

impl Body<'_> {
    fn plane(&self, index: usize) -> &HalfSpace {
        let walls = self.walls.len();
        if index < walls { &self.walls[index] } else { &self.cuts[index - walls] }
    }

    fn planes(&self) -> usize {
        self.walls.len() + self.cuts.len()
    }

    /// Whether a point lies inside all walls but those it stands on.
    fn holds(&self, point: DVec3, but: [usize; 2]) -> bool {
        self.walls.iter().enumerate().all(|(k, wall)| but.contains(&k) || wall.depth(point) >= 0.0)
    }

    /// Whether a plane goes through the apex of a cone but for rounding.
    fn passes_apex(&self, plane: usize) -> bool {
        self.apex.is_some_and(|apex| self.plane(plane).depth(apex).abs() <= 1e-12 * self.size)
    }

    /// The line of two planes: a point near the middle and a unit direction.
    fn line_of(&self, k: usize, l: usize) -> Option<(DVec3, DVec3)> {
        let (one, other) = (self.plane(k), self.plane(l));
        let direction = one.normal.cross(other.normal);
        let square = direction.length_squared();
        if square < 1e-18 {
            return None;
        }
        let (a, b) = (-one.depth(self.around), -other.depth(self.around));
        let step = (other.normal.cross(direction) * a + direction.cross(one.normal) * b) / square;
        Some((self.around + step, direction / square.sqrt()))
    }

    /// All edges; those of the walls among themselves, where the quadric is negative, only when `closed`.
    pub(super) fn skeleton(&self, closed: bool, job: &Job) -> Result<Skeleton, TessellateError> {
        let mut skeleton = Skeleton::default();
        let vertices = self.vertices(&mut skeleton.points);
        // Walls that nearly pass the apex go through it exactly, but for rounding.
        let near = |apex: &DVec3| self.walls.iter().all(|wall| wall.depth(*apex) >= -1e-12 * self.size);
        if let Some(apex) = self.apex.filter(near) {
            skeleton.apex = Some(mesh::index(skeleton.points.len()));
            skeleton.points.push(apex);
        }
        for plane in 0..self.planes() {
            if self.touching.get(plane) != Some(&true) {
                self.add_section(plane, &vertices, &mut skeleton, job)?;
            }
        }
        if closed {
            self.add_wall_edges(&vertices, &mut skeleton);
        }
        Ok(skeleton)
    }

    /// Where the lines of two planes meet the quadric.
    fn vertices(&self, points: &mut Vec<DVec3>) -> Vec<Vertex> {
        let mut vertices = Vec::new();
        for k in 0..self.planes() {
            for l in k + 1..self.planes() {
                // Two cuts meet on an axis of the quadric; the only such line that meets it does so at an apex.
                // A line through the apex meets the cone there alone, and rounding must not make it two points.
                if k >= self.walls.len() || (self.passes_apex(k) && self.passes_apex(l)) {
                    continue;
                }
                let Some((origin, direction)) = self.line_of(k, l) else { continue };
                for t in self.quadric.on_line(origin, direction) {
                    let point = origin + direction * t;
                    if self.holds(point, [k, l]) {
                        vertices.push(Vertex { index: points.len(), point, planes: [k, l] });
                        points.push(point);
                    }
                }
            }
        }
        vertices
    }

    fn add_section(
        &self,
        plane: usize,
        vertices: &[Vertex],
        skeleton: &mut Skeleton,
        job: &Job,
    ) -> Result<(), TessellateError> {
        let HalfSpace { normal, offset } = *self.plane(plane);
        let section = PlaneSection { quadric: *self.quadric, normal, offset };
        let on_it = vertices.iter().filter(|vertex| vertex.planes.contains(&plane));
        let mut points: Vec<(usize, DVec3)> = on_it.map(|vertex| (vertex.index, vertex.point)).collect();
        if let Some(apex) = skeleton.apex {
            let at = skeleton.points[apex as usize];
            if self.passes_apex(plane) {
                points.push((apex as usize, at));
            }
        }
        let inside = |point: DVec3| self.holds(point, [plane; 2]);
        let first = skeleton.edges.len();
        skeleton.add_arcs(&section, &points, (self.around, self.size), &inside, job)?;
        for edge in &mut skeleton.edges[first..] {
            edge.planes[0] = Some(plane);
        }
        Ok(())
    }

    /// Edges of the walls among themselves, as far as they run inside.
    fn add_wall_edges(&self, vertices: &[Vertex], skeleton: &mut Skeleton) {
        let walls = self.walls.len();
        let mut corners: Vec<([usize; 3], u32)> = Vec::new();
        for k in 0..walls {
            for l in k + 1..walls {
                let Some((origin, direction)) = self.line_of(k, l) else { continue };
                let through = self.passes_apex(k) && self.passes_apex(l);
                let mut stops: Vec<(f64, u32)> = vertices
                    .iter()
                    .filter(|vertex| vertex.planes == [k, l])
                    .map(|vertex| ((vertex.point - origin).dot(direction), mesh::index(vertex.index)))
                    .collect();
                if let Some(apex) = skeleton.apex {
                    let at = skeleton.points[apex as usize];
                    if through {
                        stops.push(((at - origin).dot(direction), apex));
                    }
                }
                for third in (0..walls).filter(|third| *third != k && *third != l) {
                    let wall = &self.walls[third];
                    let slope = wall.normal.dot(direction);
                    if slope.abs() < 1e-12 || (through && self.passes_apex(third)) {
                        continue;
                    }
                    let t = -wall.depth(origin) / slope;
                    let point = origin + direction * t;
                    let mut others = (0..walls).filter(|m| ![k, l, third].contains(m));
                    let inside = others.all(|m| self.walls[m].depth(point) >= 0.0);
                    if inside && self.quadric.value(point) < 0.0 {
                        let mut key = [k, l, third];
                        key.sort_unstable();
                        let known = corners.iter().find(|(known, _)| *known == key).map(|(_, index)| *index);
                        let index = known.unwrap_or_else(|| {
                            skeleton.points.push(point);
                            let index = mesh::index(skeleton.points.len() - 1);
                            corners.push((key, index));
                            index
                        });
                        stops.push((t, index));
                    }
                }
                stops.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                for pair in stops.windows(2) {
                    let middle = origin + direction * f64::midpoint(pair[0].0, pair[1].0);
                    if self.quadric.value(middle) < 0.0 && self.holds(middle, [k, l]) {
                        let points = vec![pair[0].1, pair[1].1];
                        skeleton.edges.push(Edge {
                            points,
                            middle,
                            on_quadric: false,
                            planes: [Some(k), Some(l)],
                        });
                    }
                }
            }
        }
    }
}

impl Skeleton {
    /// Adds the arcs of a section between points, as far as their middles lie inside.
    pub(super) fn add_arcs(
        &mut self,
        section: &PlaneSection,
        points: &[(usize, DVec3)],
        (around, size): (DVec3, f64),
        inside: &dyn Fn(DVec3) -> bool,
        job: &Job,
    ) -> Result<(), TessellateError> {
        for arc in section.arcs(points, around, size) {
            let middle = section.bulge(arc.stops[0], arc.stops[1]).0;
            if inside(middle) && is_on(&section.quadric, middle, size) {
                let edge = Edge { points: Vec::new(), middle, on_quadric: true, planes: [None; 2] };
                self.add_line(section, &arc, job, edge)?;
            }
        }
        Ok(())
    }

    /// Cuts a line into chords and adds it as an edge.
    pub(super) fn add_line(
        &mut self,
        line: &dyn Line,
        arc: &Arc,
        job: &Job,
        edge: Edge,
    ) -> Result<(), TessellateError> {
        let places = stations(line, &arc.stops, job.cut, job.limit)?;
        let chords = places.windows(2).map(|pair| line.bulge(pair[0], pair[1]).1);
        self.out = self.out.max(chords.fold(0.0, f64::max));
        let points = self.add(arc, &places);
        self.edges.push(Edge { points, ..edge });
        Ok(())
    }

    /// Adds the points of an arc; its ends are known.
    fn add(&mut self, arc: &Arc, places: &[DVec3]) -> Vec<u32> {
        let first = mesh::index(self.points.len());
        let last = places.len() - 1;
        match arc.ends {
            Some([from, to]) => {
                self.points.extend_from_slice(&places[1..last]);
                let inner = (0..mesh::index(last - 1)).map(|k| first + k);
                let from = std::iter::once(mesh::index(from));
                from.chain(inner).chain(std::iter::once(mesh::index(to))).collect()
            }
            None => {
                self.points.extend_from_slice(&places[..last]);
                let around = (0..mesh::index(last)).map(|k| first + k);
                around.chain(std::iter::once(first)).collect()
            }
        }
    }
}

/// Whether the middle of an arc lies on the quadric: the one between two points that no branch joins need not.
fn is_on(quadric: &Quadric, point: DVec3, size: f64) -> bool {
    let scale = quadric.gradient(point).length() * size + quadric.stretch() * size * size * 1e-3;
    quadric.value(point).abs() <= 1e-6 * scale
}

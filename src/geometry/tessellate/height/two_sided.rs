//! Bodies between two height maps on opposite sides of one plane.
//!
//! Promise: where both sides are, nothing stands between them; where one of them ends, the plane closes the other. Both
//! sides are cut by the lines of both, which are traced once, so all edges between them are shared; they are joined by
//! their places, in time linear but for a look-up, never by nearness. Bounds are those of the two height maps. Not
//! promised: a manifold where the sides touch along a line on the plane alone.
//!
//! Source of the idea: parts of an object on split planes, each a base with a perturbation (S. Vyatkin and B. Dolgovesov,
//! "Modeling and rendering of freeforms by scalar perturbation functions").

use std::collections::BTreeMap;

use glam::DVec3;

use super::chain::{Chain, Side};
use super::close::add_strip;
use super::delaunay::{BORDER, Delaunay, Place};
use super::greedy::{Floor, Goal, Triangles, begun, refine};
use super::lattice::Lattice;
use super::region::{Keep, Region, grain, rims};
use super::round::Round;
use super::{HeightMap, border_tolerance, of_refining, of_region, push, tessellation, up};
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Vertex, index};
use crate::geometry::tessellate::{Detail, SurfaceDensity, TessellateError, Tessellation};

/// Two height maps over one rectangle of the x, z plane: the front rises along y, the back falls below it. Both have
/// equally many samples; what closes them is the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoSided {
    /// Heights above the plane.
    pub front: HeightMap,
    /// Depths below it, over the same places.
    pub back: HeightMap,
}

/// Makes the body. Anchor sources: 0 the front, 1 walls and the plane, 2 the back.
///
/// # Errors
/// When a limit would be passed, a side reaches through the plane, or nothing of it is kept.
///
/// # Panics
/// When the sides have different sizes or numbers of samples.
pub fn two_sided(shape: &TwoSided, detail: &Detail, tolerance: f64) -> Result<Tessellation, TessellateError> {
    let (front, back) = (&shape.front, &shape.back);
    assert_eq!(front.size, back.size, "one rectangle");
    assert_eq!(front.field.extent(), back.field.extent(), "one grid");
    let aim = match detail.density {
        SurfaceDensity::Tolerance(aim) => aim,
        SurfaceDensity::Grid { .. } => tolerance,
    };
    let limit = detail.triangle_limit;
    let too_many = |needed| TessellateError::TooMany { needed, limit };
    let sides = [front, back];
    let border = sides.map(|side| border_tolerance(&side.field, aim, tolerance));
    let border = border[0].min(border[1]);
    // Borders are cut about as finely as the lattices, which are allowed first.
    let most = limit.saturating_mul(8);
    let fine = [
        Lattice::fine(&*front.field, aim, 1, most).map_err(too_many)?,
        Lattice::fine(&*back.field, aim, 1, most).map_err(too_many)?,
    ];
    let chains = merged(&sides, border);
    let grain = grain(front, tolerance);
    let mut lattices = Vec::new();
    for lattice in fine {
        lattices.push(lattice.holding(&chains, grain).map_err(too_many)?);
    }
    let finest = lattices.iter().map(Lattice::parts).fold(grain, u64::max);
    for lattice in &mut lattices {
        lattice.set_parts(finest).map_err(too_many)?;
    }
    let traced = Region::trace(&sides, &lattices, (tolerance, border), limit);
    let region = traced.map_err(|error| of_region(error, limit))?;
    let along = chains.iter().map(|chain| chain.bound).fold(0.0, f64::max);
    let floor = Some(Floor { base: 0.0, below: tolerance / 2.0, near: tolerance / 16.0 });
    let mut bound = region.error.max(2.0 * along);
    let mut made = Vec::new();
    for (number, lattice) in lattices.iter().enumerate() {
        let keep = Keep { of: number, without: None };
        let goal = Goal {
            tolerance: aim - lattice.slack,
            everywhere: true,
            limit,
            region: Some((&region, keep)),
            round: Round::OPEN,
            floor,
        };
        let side = refine(lattice, &chains, &goal).map_err(|error| of_refining(error, limit))?;
        bound = bound.max(side.error.max(side.along_rims(lattice)) + lattice.slack);
        made.push(side);
    }
    let mut body = Body::new(shape, detail, &lattices[0]);
    body.add_side(&made[0], 0)?;
    body.add_side(&made[1], 1)?;
    for (of, without) in [(0, 1), (1, 0)] {
        let keep = Keep { of, without: Some(without) };
        let goal = Goal {
            tolerance: aim,
            everywhere: false,
            limit,
            region: Some((&region, keep)),
            round: Round::OPEN,
            floor,
        };
        match begun(&lattices[0], &chains, &goal) {
            Ok(flat) => body.add_flat(&flat.mesh, of),
            Err(super::greedy::RefineError::Empty) => {}
            Err(error) => return Err(of_refining(error, limit)),
        }
    }
    Ok(tessellation(body.mesh, bound))
}

/// Places on the border of both fields.
fn merged(sides: &[&HeightMap; 2], tolerance: f64) -> [Chain; 4] {
    Side::ALL.map(|side| {
        let [one, other] = sides.map(|map| side.chain(&map.field, tolerance));
        let mut steps = [one.steps, other.steps].concat();
        steps.sort_by(f64::total_cmp);
        steps.dedup();
        Chain { steps, bound: one.bound.max(other.bound), refine: one.refine.max(other.refine) }
    })
}

/// The mesh as it grows.
struct Body<'s> {
    shape: &'s TwoSided,
    detail: &'s Detail,
    lattice: &'s Lattice<'s>,
    mesh: Mesh,
    /// Points of the rims of both sides, by their places.
    rims: [BTreeMap<Place, PointIndex>; 2],
    /// Points on the plane.
    ground: BTreeMap<Place, PointIndex>,
}

impl<'s> Body<'s> {
    fn new(shape: &'s TwoSided, detail: &'s Detail, lattice: &'s Lattice<'s>) -> Self {
        let (rims, ground) = Default::default();
        Self { shape, detail, lattice, mesh: Mesh::default(), rims, ground }
    }

    fn add_side(&mut self, made: &Triangles, number: usize) -> Result<(), TessellateError> {
        let map = if number == 0 { &self.shape.front } else { &self.shape.back };
        let mesh = &made.mesh;
        let parts = rims(mesh);
        let mut on_rim = vec![false; mesh.places.len()];
        parts.iter().flatten().flatten().for_each(|corner| on_rim[*corner as usize] = true);
        let kept: Vec<u32> = (0..mesh.triangles()).filter(|triangle| mesh.keeps(*triangle)).collect();
        let mut numbers = vec![BORDER; mesh.places.len()];
        for corner in kept.iter().flat_map(|triangle| mesh.corners_of(*triangle)) {
            let at = corner as usize;
            if numbers[at] != BORDER {
                continue;
            }
            let (place, height) = (mesh.places[at], made.heights[at]);
            if height < 0.0 {
                let steps = self.lattice.steps(place);
                let point = map.point(steps, height);
                let place = glam::DVec2::new(point.x, point.z);
                return Err(TessellateError::BelowBase { height, base: 0.0, place });
            }
            numbers[at] = index(self.mesh.vertices.len());
            push(map, &mut self.mesh, self.lattice.steps(place), height, self.detail.uv);
            let vertex = self.mesh.vertices.len() - 1;
            if number == 1 {
                self.turn_down(vertex);
            }
            if on_rim[at] {
                self.share(vertex, place, height, number);
            }
        }
        let number_of = |corner: u32| numbers[corner as usize];
        for triangle in kept {
            let [a, b, c] = up(mesh.corners_of(triangle).map(number_of));
            self.mesh.triangles.push(if number == 0 { [a, b, c] } else { [a, c, b] });
        }
        for ring in parts.iter().flatten() {
            let places: Vec<Place> = ring.iter().map(|corner| mesh.places[*corner as usize]).collect();
            let own: Vec<PointIndex> = places.iter().map(|place| self.rims[number][place]).collect();
            let ground: Vec<PointIndex> = places.iter().map(|place| self.on_ground(*place)).collect();
            let (top, under) = if number == 0 { (own, ground) } else { (ground, own) };
            add_strip(&mut self.mesh, &top, &under, self.detail);
        }
        Ok(())
    }

    /// The last vertex of a side, below the plane.
    fn turn_down(&mut self, vertex: usize) {
        let vertex = &mut self.mesh.vertices[vertex];
        let point = &mut self.mesh.points[vertex.point.subscript()];
        point.y = 0.0 - point.y;
        vertex.normal.y = -vertex.normal.y;
        vertex.anchor.source = 2;
    }

    /// Notes the last point as one of a rim; on the plane it is the one that stands there.
    fn share(&mut self, vertex: usize, place: Place, height: f64, number: usize) {
        let own = self.mesh.vertices[vertex].point;
        let mut point = own;
        if height == 0.0 {
            point = *self.ground.entry(place).or_insert(own);
            if point != own {
                self.mesh.points.pop();
                self.mesh.vertices[vertex].point = point;
            }
        }
        self.rims[number].insert(place, point);
    }

    fn on_ground(&mut self, place: Place) -> PointIndex {
        let steps = self.lattice.steps(place);
        let mesh = &mut self.mesh;
        *self.ground.entry(place).or_insert_with(|| {
            mesh.points.push(self.shape.front.point(steps, 0.0));
            PointIndex(index(mesh.points.len()) - 1)
        })
    }

    /// The plane where only one side is.
    fn add_flat(&mut self, flat: &Delaunay, of: usize) {
        let normal = if of == 0 { DVec3::NEG_Y } else { DVec3::Y };
        let mut numbers = vec![BORDER; flat.places.len()];
        let [right, bottom] = self.shape.front.field.extent();
        for triangle in (0..flat.triangles()).filter(|triangle| flat.keeps(*triangle)) {
            let corners = flat.corners_of(triangle).map(|corner| {
                let number = &mut numbers[corner as usize];
                if *number == BORDER {
                    let place = flat.places[corner as usize];
                    let point = self.on_ground(place);
                    let steps = self.lattice.steps(place);
                    let part = glam::DVec2::new(steps[0] / right, steps[1] / bottom);
                    let uv = if self.detail.uv { part } else { glam::DVec2::ZERO };
                    *number = index(self.mesh.vertices.len());
                    let anchor = Anchor { source: 1, u: part.x, v: part.y };
                    self.mesh.vertices.push(Vertex { point, normal, uv, color: Color::WHITE, anchor });
                }
                *number
            });
            let [a, b, c] = up(corners);
            self.mesh.triangles.push(if of == 0 { [a, c, b] } else { [a, b, c] });
        }
    }
}

//! Surfaces drawn as they are, without triangles: the ground truth that meshes are compared with.
//!
//! Promise: what is seen of a surface of a field is decided for each sample of the picture, by bounds wherever they prove it
//! ([`Exact::unproved`] says for how many lines of sight they did not); its place on the line is right to the last digits, its
//! normal is the slope of the field. Camera, lights, samples and what stands beside it are those of any other picture.
//! What is painted on it (materials, texture coordinates, colors of vertices) is that of the nearest place of the mesh
//! beside it, and so are shadows. Not promised: that light passes through what has opacity; such parts are drawn by their
//! mesh.
//!
//! Cost: for each surface a few hundred values of its field for each pixel that it covers, and more along its outline.

mod rays;
mod tile;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DAffine3, DVec2, DVec3};

use super::asset::Cutoff;
use super::camera::{Camera, Projection};
use super::raster::{Pattern, Tile};
use super::stage::{Piece, Stage};
use crate::geometry::field::Sheet;
use crate::geometry::mesh::nearest::nearest_of_triangle;
use crate::geometry::mesh::tree::Tree;
use crate::geometry::number::{Bounds, count_of, floor_index};
use rays::Rays;
use tile::{Area, Painter};

/// The surfaces of a mesh of a file.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// Each with the map from its own space to that of the mesh.
    pub sheets: Vec<(Sheet, DAffine3)>,
    /// How far the mesh is from them, in its own space, metres.
    pub deviation: f64,
}

/// What stands in place of triangles on a stage.
pub struct Exact<'a> {
    sheets: Vec<Standing<'a>>,
    carriers: Vec<Carrier>,
    /// Lines of sight without a proof.
    unproved: AtomicU64,
}

/// A surface where it stands.
struct Standing<'a> {
    sheet: &'a Sheet,
    /// From space to the space of the field.
    back: DAffine3,
    /// A box around it, in space.
    bounds: Bounds,
    carrier: usize,
}

/// The mesh that a surface takes what is painted on it from.
struct Carrier {
    /// Its number.
    mesh: usize,
    triangles: Range<usize>,
    points: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
    tree: Tree,
    /// Whether all of it looks the same.
    plain: bool,
    /// How far it may be from the surface, metres.
    lift: f64,
}

/// What a line of sight meets.
pub(super) struct Met {
    pub(super) point: DVec3,
    /// Outward, of length 1.
    pub(super) normal: DVec3,
    /// Whether it is seen from outside.
    pub(super) front: bool,
    /// The triangle of the stage that is nearest.
    pub(super) triangle: u32,
    /// How far from the surface shadows may be thrown from.
    pub(super) lift: f64,
}

impl<'a> Exact<'a> {
    /// Surfaces on a stage, by the numbers of its meshes. What joints, morph targets or a map without inverse move keeps its
    /// triangles, and so does what lets light through.
    #[must_use]
    pub fn new(stage: &Stage, surfaces: &'a [Option<Surfaces>]) -> Self {
        let mut exact = Self { sheets: Vec::new(), carriers: Vec::new(), unproved: AtomicU64::new(0) };
        let mut start = 0;
        for pieces in stage.pieces.chunk_by(|one, next| one.node == next.node) {
            let end = pieces.last().map_or(start, |piece| piece.end);
            exact.add(stage, pieces, start..end, surfaces);
            start = end;
        }
        exact
    }

    fn add(
        &mut self,
        stage: &Stage,
        pieces: &[Piece],
        triangles: Range<usize>,
        surfaces: &'a [Option<Surfaces>],
    ) {
        let Some(Some(own)) = surfaces.get(pieces[0].mesh) else { return };
        let opaque = |piece: &Piece| stage.materials[piece.material].cutoff == Cutoff::Opaque;
        let Some(world) = pieces[0].world.filter(|_| pieces.iter().all(opaque)) else { return };
        let world = DAffine3::from_mat4(world);
        let sound = |map: &DAffine3| map.is_finite() && map.inverse().is_finite();
        if triangles.is_empty() || !own.sheets.iter().all(|(_, map)| sound(&(world * *map))) {
            return;
        }
        let carrier = self.carriers.len();
        let stretch = stretch_of(&world);
        self.carriers.push(Carrier::new(stage, pieces, triangles, stretch * own.deviation));
        for (sheet, map) in &own.sheets {
            let map = world * *map;
            let bounds = Bounds::of_points(sheet.bounds.corners().map(|corner| map.transform_point3(corner)));
            self.sheets.push(Standing { sheet, back: map.inverse(), bounds, carrier });
        }
    }

    /// Whether surfaces stand in place of a mesh.
    #[must_use]
    pub fn draws(&self, mesh: usize) -> bool {
        self.carriers.iter().any(|carrier| carrier.mesh == mesh)
    }

    /// Whether a surface stands in place of a triangle.
    pub(super) fn replaces(&self, triangle: usize) -> bool {
        // They stand in the order of their triangles.
        let next = self.carriers.partition_point(|carrier| carrier.triangles.start <= triangle);
        next > 0 && triangle < self.carriers[next - 1].triangles.end
    }

    /// How many lines of sight met or missed a surface without a proof, in all pictures so far.
    #[must_use]
    pub fn unproved(&self) -> u64 {
        self.unproved.load(Ordering::Relaxed)
    }

    /// Draws into a tile what is nearer than what is seen there; surfaces have names from `first` on.
    pub(super) fn paint(&self, tile: &mut Tile, (camera, pattern, first): (&Camera, Pattern, u32)) {
        for (number, standing) in self.sheets.iter().enumerate() {
            let Some((area, near, far)) = standing.place(camera, tile) else { continue };
            let name = first + 2 * count_of(number);
            let rays = Rays::new(camera, &standing.back);
            let mut painter = Painter { sheet: standing.sheet, rays, pattern, name, tile, unproved: 0 };
            painter.paint(area, near, far);
            let unproved = painter.unproved;
            self.unproved.fetch_add(unproved, Ordering::Relaxed);
        }
    }

    /// What a line of sight meets of a surface, about so deep in the picture; the number counts both sides of surfaces.
    pub(super) fn met(&self, number: u32, camera: &Camera, place: DVec2, depth: f64) -> Met {
        /// Steps; the place is nearly known.
        const STEPS: u32 = 4;
        let standing = &self.sheets[number as usize / 2];
        let (_, along) = camera.sight(place);
        let start = camera.point(place.extend(depth));
        let reach = 0.01 * standing.bounds.diagonal();
        let at = |moved: f64| {
            let own = standing.back.transform_point3(start + along * moved);
            let (value, slope) = standing.sheet.field.value_gradient(own);
            (value, standing.back.matrix3.transpose() * slope)
        };
        let mut moved = 0.0;
        for _ in 0..STEPS {
            let (value, slope) = at(moved);
            let next = moved - value / slope.dot(along);
            if !next.is_finite() || next.abs() > reach {
                // The line misses it, or nearly: what is seen beside it stays.
                moved = 0.0;
                break;
            }
            let near = (next - moved).abs() <= 1e-9 * reach;
            moved = next;
            if near {
                break;
            }
        }
        let normal = at(moved).1.normalize_or(-along);
        let point = start + along * moved;
        let carrier = &self.carriers[standing.carrier];
        let (triangle, lift) = (carrier.nearest(point), carrier.lift);
        Met { point, normal, front: number.is_multiple_of(2), triangle, lift }
    }
}

impl Standing<'_> {
    /// The part of a tile that it may cover, and the distances between which it lies.
    fn place(&self, camera: &Camera, tile: &Tile) -> Option<(Area, f64, f64)> {
        let corners = self.bounds.corners();
        let away = corners.map(|corner| camera.away(corner));
        let (least, most) = camera.seen_range();
        let near = away.into_iter().fold(f64::INFINITY, f64::min).max(least);
        let far = away.into_iter().fold(f64::NEG_INFINITY, f64::max).min(most);
        // Before the eye by a share of its size.
        let near = match camera.projection() {
            Projection::Perspective => near.max(1e-6 * self.bounds.diagonal()),
            Projection::Orthographic => near,
        };
        if near >= far {
            return None;
        }
        let mut area =
            Area { low: [tile.left, tile.top], high: [tile.left + tile.width, tile.top + tile.height] };
        let places: Option<Vec<DVec3>> = corners.into_iter().map(|corner| camera.project(corner)).collect();
        for axis in 0..2 {
            let Some(places) = &places else { continue };
            let along = places.iter().map(|place| place.to_array()[axis]);
            let low = along.clone().fold(f64::INFINITY, f64::min);
            let high = along.fold(f64::NEG_INFINITY, f64::max);
            area.low[axis] = area.low[axis].max(floor_index(low.max(0.0)));
            area.high[axis] = area.high[axis].min(floor_index(high.max(0.0)) + 1);
            if area.low[axis] >= area.high[axis] {
                return None;
            }
        }
        Some((area, near, far))
    }
}

impl Carrier {
    fn new(stage: &Stage, pieces: &[Piece], triangles: Range<usize>, lift: f64) -> Self {
        let own = &stage.triangles[triangles.clone()];
        let first = own.iter().flatten().copied().min().unwrap_or(0);
        let end = own.iter().flatten().copied().max().map_or(first, |last| last + 1);
        let vertices = &stage.vertices[first as usize..end as usize];
        let points: Vec<DVec3> = vertices.iter().map(|vertex| vertex.point).collect();
        let corners: Vec<[u32; 3]> = own.iter().map(|corners| corners.map(|corner| corner - first)).collect();
        let material = &stage.materials[pieces[0].material];
        let maps = material.color_map.is_some()
            || material.metallic_roughness_map.is_some()
            || material.normal_map.is_some()
            || material.occlusion_map.is_some()
            || material.emissive_map.is_some();
        let plain = pieces.iter().all(|piece| piece.material == pieces[0].material)
            && !maps
            && vertices.iter().all(|vertex| vertex.color == vertices[0].color);
        let tree = Tree::new(&points, &corners);
        Self { mesh: pieces[0].mesh, triangles, points, corners, tree, plain, lift }
    }

    /// The nearest triangle of the stage.
    fn nearest(&self, point: DVec3) -> u32 {
        let corners =
            |triangle: u32| self.corners[triangle as usize].map(|corner| self.points[corner as usize]);
        let distance = |triangle: u32| nearest_of_triangle(corners(triangle), point).distance(point);
        let own = if self.plain { Some(0) } else { self.tree.least(point, distance).map(|(own, _)| own) };
        count_of(self.triangles.start) + own.unwrap_or(0)
    }
}

/// At least as much as a map stretches lengths.
fn stretch_of(map: &DAffine3) -> f64 {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
}

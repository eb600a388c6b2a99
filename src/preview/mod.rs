//! Pictures of baked files, without a graphics card.
//!
//! Promise: what is drawn are the written bytes, at any moment of their clips; the same bytes and the same [`Look`] give
//! the same picture on every machine and for any number of threads; everything is in the picture. Vertices, triangles
//! and lines are drawn with their materials, pictures, vertex colors, skins and morph targets. Backs of surfaces that
//! have none are red: engines leave them out.
//! No promise: light is that of a simple studio (three lights, one shadow, a sky), not of a scene; glass and other
//! special materials look like their base.
//!
//! Cost: linear in vertices, in pixels, and in the pixels that triangles cover. Memory: the vertices, and while a
//! picture is drawn about 220 bytes a triangle and 8 a pixel.

pub mod asset;
mod camera;
mod color;
pub mod exact;
mod gif;
pub mod heat;
mod legend;
mod light;
pub mod lines;
mod picture;
mod raster;
mod shader;
mod shadow;
mod stage;

use glam::{DVec2, DVec3, Vec3, Vec4};

use asset::Asset;
pub use camera::{Camera, Projection, View};
use exact::Exact;
pub use picture::{Picture, PictureError};
use raster::{Face, MIDDLE, SIXTEEN, Seen, Tile, Veil, draw};
use shader::Shader;
pub use stage::{Eye, Moment, Piece, Stage, StageError, Vertex, turns};

use crate::geometry::number::count_of;

/// How a picture is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// How light is reflected.
    pub shading: Shading,
    /// How space becomes a plane.
    pub projection: Projection,
    /// Whether the first light casts shadows.
    pub shadows: bool,
    /// What is behind everything: sRGB and opacity.
    pub background: [u8; 4],
}

impl Default for Look {
    fn default() -> Self {
        Self {
            size: (1024, 1024),
            shading: Shading::Standard,
            projection: Projection::Perspective,
            shadows: true,
            background: [0xe6, 0xe8, 0xec, 0xff],
        }
    }
}

/// How light is reflected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shading {
    /// As glTF says: metal and roughness.
    Standard,
    /// Phong's rule with normals between those of the corners.
    Phong,
    /// Phong's rule at the corners, and light between them.
    Gouraud,
    /// Phong's rule with one normal a triangle.
    Flat,
    /// Normals as colors, no light.
    Normals,
}

/// Half the width of lines, in pixels.
const HALF_LINE: f64 = 0.75;

/// Draws a stage as it is seen by a camera that was made for the same size of picture.
#[must_use]
pub fn draw_picture(asset: &Asset, stage: &Stage, camera: &Camera, look: &Look) -> Picture {
    draw_exact((asset, stage), &Exact::new(stage, &[]), camera, look)
}

/// The same with surfaces that stand in place of triangles.
#[must_use]
pub fn draw_exact(
    (asset, stage): (&Asset, &Stage),
    exact: &Exact<'_>,
    camera: &Camera,
    look: &Look,
) -> Picture {
    let (width, height) = (look.size.0 as usize, look.size.1 as usize);
    let faces = faces(stage, exact, camera);
    let shader = Shader::new((asset, stage), exact, camera, look);
    let first = shader.first_exact();
    let behind = look.background;
    let opacity = |name: u32, place: DVec2| shader.opacity(name, place);
    let tiles = draw(&faces, (width, height), SIXTEEN, &opacity, |tile| {
        exact.paint(tile, (camera, SIXTEEN, first));
        let mut veils = tile.veils.as_slice();
        let mut pixels = Vec::with_capacity(tile.width * tile.height);
        for number in 0..tile.width * tile.height {
            let own = &tile.seen[number * SIXTEEN.len()..(number + 1) * SIXTEEN.len()];
            let count = veils.iter().take_while(|veil| veil.pixel as usize == number).count();
            let (before, rest) = veils.split_at(count);
            veils = rest;
            pixels.push(resolve((own, before), corner(tile, number), &shader, behind));
        }
        (tile.left, tile.top, tile.width, pixels)
    });
    Picture { width, height, pixels: gathered(tiles, (width, height), behind) }
}

/// Tiles (left, top, width and what they hold, row by row) put together.
fn gathered<T: Copy>(
    tiles: Vec<(usize, usize, usize, Vec<T>)>,
    (width, height): (usize, usize),
    empty: T,
) -> Vec<T> {
    let mut all = vec![empty; width * height];
    for (left, top, across, own) in tiles {
        for (row, line) in own.chunks(across).enumerate() {
            let start = (top + row) * width + left;
            all[start..start + across].copy_from_slice(line);
        }
    }
    all
}

fn corner(tile: &Tile, number: usize) -> DVec2 {
    DVec2::new((tile.left + number % tile.width) as f64, (tile.top + number / tile.width) as f64)
}

/// Triangles and lines in the picture; lines have the names after those of the triangles.
fn faces(stage: &Stage, exact: &Exact<'_>, camera: &Camera) -> Vec<Face> {
    let point = |vertex: u32| stage.vertices[vertex as usize].point;
    let mut faces = Vec::with_capacity(stage.triangles.len() + 2 * stage.lines.len());
    for (name, corners) in stage.triangles.iter().enumerate().filter(|(name, _)| !exact.replaces(*name)) {
        let seen = camera.seen(&corners.map(point));
        let places: Vec<_> = seen.into_iter().filter_map(|point| camera.project(point)).collect();
        for k in 1..places.len().saturating_sub(1) {
            faces.push(Face { corners: [places[0], places[k], places[k + 1]], name: count_of(name) });
        }
    }
    for (number, ends) in stage.lines.iter().enumerate() {
        let seen = camera.seen(&ends.map(point));
        if let [Some(a), Some(b)] = [0, 1].map(|k| camera.project(*seen.get(k)?)) {
            let along = (b - a).truncate().normalize_or(DVec2::X);
            let (side, along) = (along.perp().extend(0.0) * HALF_LINE, along.extend(0.0) * (HALF_LINE / 2.0));
            let [p, q, r, s] = [a - along + side, a - along - side, b + along - side, b + along + side];
            let name = count_of(stage.triangles.len() + number);
            faces.extend([Face { corners: [p, q, r], name }, Face { corners: [p, r, s], name }]);
        }
    }
    faces
}

/// Faces of a pixel that get a color of their own; where there are more, the smallest have that of the greatest.
const MOST: usize = 6;

/// The color of a pixel: each face has one color where it covers samples, in their middle, and what lets light through
/// lies over what is behind it.
fn resolve(
    (seen, veils): (&[Seen], &[Veil]),
    corner: DVec2,
    shader: &Shader<'_>,
    behind: [u8; 4],
) -> [u8; 4] {
    let groups = groups(seen);
    if groups.is_empty() && veils.is_empty() {
        return behind;
    }
    // Colors times opacity, and opacity.
    let back_opacity = f32::from(behind[3]) / 255.0;
    let back = Vec3::from_array([0, 1, 2].map(|k| color::linear(behind[k]))) * back_opacity;
    let mut samples = [back.extend(back_opacity); 16];
    let mut first = Vec4::ZERO;
    for (number, group) in groups.iter().enumerate() {
        if number < MOST {
            let place = corner + group.places / f64::from(group.covered.count_ones());
            let depth = group.depths / f64::from(group.covered.count_ones());
            let color = shader.color(group.name, place, depth).clamp(Vec3::ZERO, Vec3::ONE).extend(1.0);
            group.cover(&mut samples, color);
            first = if number == 0 { color } else { first };
        } else {
            group.cover(&mut samples, first);
        }
    }
    for veil in veils {
        let middle = corner + DVec2::splat(0.5);
        let color = shader.color(veil.name, middle, veil.depth.into()).clamp(Vec3::ZERO, Vec3::ONE);
        let over = (color * veil.opacity).extend(veil.opacity);
        for (k, (sample, seen)) in samples.iter_mut().zip(seen).enumerate() {
            if veil.covered >> k & 1 == 1 && veil.depth < seen.depth {
                *sample = over + *sample * (1.0 - veil.opacity);
            }
        }
    }
    let mean = samples.iter().sum::<Vec4>() / 16.0;
    if mean.w <= 0.0 {
        return [0; 4];
    }
    let [r, g, b] = (mean.truncate() / mean.w).to_array().map(color::srgb);
    [r, g, b, color::byte(mean.w)]
}

/// The samples of a pixel where one face is seen.
struct Group {
    name: u32,
    /// As bits.
    covered: u32,
    /// The sum of their places in the pixel.
    places: DVec2,
    /// The sum of how far away they are.
    depths: f64,
}

impl Group {
    fn cover(&self, samples: &mut [Vec4; 16], color: Vec4) {
        for (k, sample) in samples.iter_mut().enumerate() {
            if self.covered >> k & 1 == 1 {
                *sample = color;
            }
        }
    }
}

/// The faces of a pixel, that with the most samples first.
fn groups(seen: &[Seen]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (k, (seen, [x, y])) in seen.iter().zip(SIXTEEN).enumerate() {
        if seen.name == u32::MAX {
            continue;
        }
        let place = DVec2::new(*x as f64, *y as f64) / 256.0;
        match groups.iter_mut().find(|group| group.name == seen.name) {
            Some(group) => {
                group.covered |= 1 << k;
                group.places += place;
                group.depths += f64::from(seen.depth);
            }
            None => {
                let depths = seen.depth.into();
                groups.push(Group { name: seen.name, covered: 1 << k, places: place, depths });
            }
        }
    }
    groups.sort_by_key(|group| (std::cmp::Reverse(group.covered.count_ones()), group.name));
    groups
}

impl Camera {
    /// A camera that sees all that is drawn of some stages, as large as it fits.
    #[must_use]
    pub fn on(stages: &[&Stage], view: View, look: &Look) -> Self {
        Self::around(view, look.projection, stages.iter().flat_map(|stage| used_points(stage)), look.size)
    }
}

/// Points that are drawn.
fn used_points(stage: &Stage) -> impl Iterator<Item = DVec3> + Clone + '_ {
    let used = stage.triangles.iter().flatten().chain(stage.lines.iter().flatten());
    used.map(|vertex| stage.vertices[*vertex as usize].point)
}

/// How far away what is seen in the middle of each pixel is, as [`Camera::depth`] says; infinite where nothing is. Row by
/// row from the top.
#[must_use]
pub fn depths(stage: &Stage, camera: &Camera, size: (u32, u32)) -> Vec<f32> {
    exact_depths(stage, &Exact::new(stage, &[]), camera, size)
}

/// The same with surfaces that stand in place of triangles.
#[must_use]
pub fn exact_depths(
    stage: &Stage,
    exact: &Exact<'_>,
    camera: &Camera,
    (width, height): (u32, u32),
) -> Vec<f32> {
    let (width, height) = (width as usize, height as usize);
    let tiles = draw(&faces(stage, exact, camera), (width, height), MIDDLE, &|_, _| 1.0, |tile| {
        exact.paint(tile, (camera, MIDDLE, 0));
        (tile.left, tile.top, tile.width, tile.seen.iter().map(|seen| seen.depth).collect())
    });
    gathered(tiles, (width, height), f32::INFINITY)
}

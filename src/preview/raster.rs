//! A z-buffer: which face is seen at each sample of a picture.
//!
//! Promise: faces that share an edge leave no gap and never both cover a sample (places are rounded to 1/256 of a
//! pixel, and from there on edges are exact); of faces at the same depth the first is seen; the result does not depend
//! on the number of threads. Faces that reach behind the eye, or more than 2^22 pixels away, are left out.
//!
//! Source: E. Catmull, A Subdivision Algorithm for Computer Display of Curved Surfaces, 1974 (the z-buffer); J. Pineda, A
//! Parallel Algorithm for Polygon Rasterization, SIGGRAPH 1988 (edge functions); L. Carpenter, The A-buffer, SIGGRAPH
//! 1984 (what lets light through is kept in a list, and sorted by depth).
//!
//! Cost: linear in faces, and in the samples that they cover; memory for the faces and for one tile a thread.

use glam::DVec2;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use super::camera::Projected;
use crate::geometry::number::{count_of, floor_index, single};

/// A triangle in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Its corners, either way round.
    pub(super) corners: [Projected; 3],
    /// What it belongs to.
    pub(super) name: u32,
}

/// What is seen at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// How far away; infinite where nothing is.
    pub(super) depth: f32,
    /// The name of the face.
    pub(super) name: u32,
}

/// Where samples lie in a pixel, in 1/256 of it.
pub(super) type Pattern = &'static [[i64; 2]];

/// One sample in the middle.
pub(super) const MIDDLE: Pattern = &[[128, 128]];

/// Sixteen samples, one in each sixteenth of a pixel's width and of its height.
pub(super) const SIXTEEN: Pattern = &[
    [8, 8],
    [24, 136],
    [40, 72],
    [56, 200],
    [72, 40],
    [88, 168],
    [104, 104],
    [120, 232],
    [136, 24],
    [152, 152],
    [168, 88],
    [184, 216],
    [200, 56],
    [216, 184],
    [232, 120],
    [248, 248],
];

/// Parts of a pixel.
const PARTS: f64 = 256.0;

/// Pixels along the side of a tile.
const SIDE: usize = 32;

/// Pixels from the origin beyond which no place is drawn.
const FARTHEST: f64 = 4_194_304.0;

/// A part of the picture, drawn.
pub(super) struct Tile {
    /// Its first pixel.
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    /// The samples of each pixel, row by row.
    pub(super) seen: Vec<Seen>,
    /// What lets light through, by pixels, of each the farthest first.
    pub(super) veils: Vec<Veil>,
}

/// A face over a pixel that lets light through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Veil {
    /// Number of the pixel in its tile.
    pub(super) pixel: u32,
    /// How far away, in the middle of the pixel.
    pub(super) depth: f32,
    pub(super) name: u32,
    /// The samples that it covers, as bits.
    pub(super) covered: u32,
    /// How much it hides, less than 1.
    pub(super) opacity: f32,
}

/// A face, ready for its samples.
struct Ready {
    /// Edge functions as (per column, per row, at the origin): at least 0 inside.
    edges: [[i64; 3]; 3],
    /// Depth likewise.
    depth: [f64; 3],
    /// First and last pixels.
    low: [usize; 2],
    high: [usize; 2],
    name: u32,
}

/// Draws faces into tiles, and what `finish` makes of each tile. `opacity` of a face at a place is 1 where it hides all
/// that is behind it.
pub(super) fn draw<T: Send>(
    faces: &[Face],
    (width, height): (usize, usize),
    pattern: Pattern,
    opacity: &(impl Fn(u32, DVec2) -> f32 + Sync),
    finish: impl Fn(&mut Tile) -> T + Sync,
) -> Vec<T> {
    let ready: Vec<Ready> = faces.iter().filter_map(|face| Ready::new(face, (width, height))).collect();
    let (across, down) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
    let mut bins: Vec<Vec<u32>> = vec![Vec::new(); across * down];
    for (number, face) in ready.iter().enumerate() {
        for row in face.low[1] / SIDE..=face.high[1] / SIDE {
            for column in face.low[0] / SIDE..=face.high[0] / SIDE {
                bins[row * across + column].push(count_of(number));
            }
        }
    }
    let empty = || Tile { left: 0, top: 0, width: 0, height: 0, seen: Vec::new(), veils: Vec::new() };
    let made = |tile: &mut Tile, number: usize| {
        (tile.left, tile.top) = (number % across * SIDE, number / across * SIDE);
        (tile.width, tile.height) = (SIDE.min(width - tile.left), SIDE.min(height - tile.top));
        tile.seen.clear();
        let nothing = Seen { depth: f32::INFINITY, name: u32::MAX };
        tile.seen.resize(tile.width * tile.height * pattern.len(), nothing);
        tile.veils.clear();
        for face in &bins[number] {
            ready[*face as usize].cover(tile, pattern, opacity);
        }
        let order = |a: &Veil, b: &Veil| b.depth.total_cmp(&a.depth).then(a.name.cmp(&b.name));
        tile.veils.sort_by(|a, b| a.pixel.cmp(&b.pixel).then_with(|| order(a, b)));
        finish(tile)
    };
    // A thread takes one tile's memory for all of its tiles.
    (0..bins.len()).into_par_iter().map_init(empty, made).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "places are at most 2^30 parts of pixels")]
fn parts(place: f64) -> i64 {
    (place * PARTS).round() as i64
}

fn pixels(parts: i64) -> f64 {
    parts as f64 / PARTS
}

impl Ready {
    fn new(face: &Face, (width, height): (usize, usize)) -> Option<Self> {
        if face
            .corners
            .iter()
            .any(|corner| !corner.is_finite() || corner.truncate().abs().max_element() > FARTHEST)
        {
            return None;
        }
        let mut corners = face.corners;
        let mut at = corners.map(|corner| [parts(corner.x), parts(corner.y)]);
        let area = |[a, b, c]: [[i64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let twice = area(at);
        if twice == 0 {
            return None;
        }
        if twice < 0 {
            at.swap(1, 2);
            corners.swap(1, 2);
        }
        let edges = [0, 1, 2].map(|k| {
            let ([ax, ay], [bx, by]) = (at[(k + 1) % 3], at[(k + 2) % 3]);
            let (dx, dy) = (bx - ax, by - ay);
            // A sample on an edge belongs to the face on one side of it.
            let own = dy < 0 || dy == 0 && dx > 0;
            [-dy, dx, dy * ax - dx * ay - i64::from(!own)]
        });
        // Depth is linear in the picture. The places that are drawn are the rounded ones.
        let [a, b, c] = at.map(|[x, y]| DVec2::new(pixels(x), pixels(y)));
        let (u, v) = (b - a, c - a);
        let (du, dv) = (corners[1].z - corners[0].z, corners[2].z - corners[0].z);
        let determinant = u.perp_dot(v);
        let slope = DVec2::new(du * v.y - dv * u.y, dv * u.x - du * v.x) / determinant;
        let depth = [slope.x, slope.y, corners[0].z - slope.dot(a)];
        let bound = |k: usize, most: usize| {
            let values = at.map(|place| pixels(place[k]));
            let (low, high) = (
                values.iter().copied().fold(f64::INFINITY, f64::min),
                values.into_iter().fold(f64::NEG_INFINITY, f64::max),
            );
            (high >= 0.0 && low < most as f64).then(|| (floor_index(low), floor_index(high).min(most - 1)))
        };
        let ((left, right), (top, bottom)) = (bound(0, width)?, bound(1, height)?);
        Some(Self { edges, depth, low: [left, top], high: [right, bottom], name: face.name })
    }

    fn cover(&self, tile: &mut Tile, pattern: Pattern, opacity: &(impl Fn(u32, DVec2) -> f32 + Sync)) {
        let (left, right) = (self.low[0].max(tile.left), self.high[0].min(tile.left + tile.width - 1));
        let (top, bottom) = (self.low[1].max(tile.top), self.high[1].min(tile.top + tile.height - 1));
        let mut steps = [[0_i64; 3]; 16];
        let (mut least, mut most) = ([i64::MAX; 3], [i64::MIN; 3]);
        for (steps, [x, y]) in steps.iter_mut().zip(pattern) {
            for k in 0..3 {
                steps[k] = self.edges[k][0] * x + self.edges[k][1] * y;
                (least[k], most[k]) = (least[k].min(steps[k]), most[k].max(steps[k]));
            }
        }
        for row in top..=bottom {
            for column in left..=right {
                let (x, y) = ((column << 8).cast_signed() as i64, (row << 8).cast_signed() as i64);
                let at = self.edges.map(|[a, b, c]| a * x + b * y + c);
                if (0..3).any(|k| at[k] + most[k] < 0) {
                    continue;
                }
                let all = (0..3).all(|k| at[k] + least[k] >= 0);
                let mut covered = 0_u32;
                for (sample, steps) in steps.iter().enumerate().take(pattern.len()) {
                    if all || (0..3).all(|k| at[k] + steps[k] >= 0) {
                        covered |= 1 << sample;
                    }
                }
                if covered == 0 {
                    continue;
                }
                let place = DVec2::new(column as f64, row as f64);
                let pixel = (row - tile.top) * tile.width + column - tile.left;
                let middle = place + DVec2::splat(0.5);
                let opacity = opacity(self.name, middle);
                if opacity < 1.0 {
                    if opacity > 0.0 {
                        let depth =
                            single(self.depth[0] * middle.x + self.depth[1] * middle.y + self.depth[2]);
                        let name = self.name;
                        tile.veils.push(Veil { pixel: count_of(pixel), depth, name, covered, opacity });
                    }
                    continue;
                }
                let first = pixel * pattern.len();
                for (sample, [dx, dy]) in pattern.iter().enumerate() {
                    if covered >> sample & 1 == 0 {
                        continue;
                    }
                    let (x, y) = (place.x + pixels(*dx), place.y + pixels(*dy));
                    let depth = single(self.depth[0] * x + self.depth[1] * y + self.depth[2]);
                    let seen = &mut tile.seen[first + sample];
                    if depth < seen.depth {
                        *seen = Seen { depth, name: self.name };
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{Face, MIDDLE, SIXTEEN, Seen, draw};
    use crate::geometry::number::floor_index;

    fn seen(faces: &[Face], size: (usize, usize), pattern: super::Pattern) -> Vec<Seen> {
        let mut all = vec![Seen { depth: f32::INFINITY, name: u32::MAX }; size.0 * size.1 * pattern.len()];
        let tiles = draw(faces, size, pattern, &|_, _| 1.0, |tile| {
            (tile.left, tile.top, tile.width, tile.height, tile.seen.clone())
        });
        for (left, top, width, height, own) in tiles {
            for row in 0..height {
                let count = width * pattern.len();
                let at = ((top + row) * size.0 + left) * pattern.len();
                all[at..at + count].copy_from_slice(&own[row * count..(row + 1) * count]);
            }
        }
        all
    }

    /// A fan of slivers around a point that lies on no grid.
    fn fan(count: u32) -> Vec<Face> {
        let center = DVec3::new(31.77, 33.21, 1.0);
        let at = |k: u32| {
            let turn = f64::from(k % count) / f64::from(count);
            // Around a square: exact for any count, without angles.
            let side = turn * 4.0;
            let along = side.fract() * 60.0 + 2.0;
            match floor_index(side) {
                0 => DVec3::new(along, 2.0, 1.0),
                1 => DVec3::new(62.0, along, 1.0),
                2 => DVec3::new(64.0 - along, 62.0, 1.0),
                _ => DVec3::new(2.0, 64.0 - along, 1.0),
            }
        };
        (0..count).map(|k| Face { corners: [center, at(k), at(k + 1)], name: k }).collect()
    }

    #[test]
    fn faces_that_share_edges_cover_every_sample_once() {
        let faces = fan(1000);
        let mut counts = vec![0; 64 * 64 * SIXTEEN.len()];
        for face in &faces {
            for (count, seen) in counts.iter_mut().zip(seen(&[*face], (64, 64), SIXTEEN)) {
                *count += usize::from(seen.name != u32::MAX);
            }
        }
        let inside = |pixel: usize| (2..62).contains(&(pixel % 64)) && (2..62).contains(&(pixel / 64));
        for (sample, count) in counts.into_iter().enumerate() {
            let expected = usize::from(inside(sample / SIXTEEN.len()));
            assert_eq!(count, expected, "sample {sample}");
        }
    }

    #[test]
    fn the_nearer_face_is_seen_and_of_equals_the_first() {
        let square = |depth: f64, name: u32| {
            let at = |x: f64, y: f64| DVec3::new(x, y, depth);
            [
                Face { corners: [at(0.0, 0.0), at(8.0, 0.0), at(8.0, 8.0)], name },
                Face { corners: [at(0.0, 0.0), at(8.0, 8.0), at(0.0, 8.0)], name },
            ]
        };
        let faces: Vec<Face> =
            [square(2.0, 0), square(1.0, 1), square(1.0, 2)].into_iter().flatten().collect();
        assert!(seen(&faces, (8, 8), MIDDLE).iter().all(|seen| seen.name == 1 && seen.depth == 1.0));
    }

    #[test]
    fn depth_is_that_of_the_plane() {
        let plane = |x: f64, y: f64| DVec3::new(x, y, 3.0 + 0.25 * x - 0.125 * y);
        let face = Face { corners: [plane(0.0, 0.0), plane(64.0, 0.0), plane(0.0, 64.0)], name: 0 };
        let all = seen(&[face], (64, 64), MIDDLE);
        for (pixel, seen) in all.iter().enumerate().filter(|(_, seen)| seen.name == 0) {
            let middle = DVec2::new((pixel % 64) as f64 + 0.5, (pixel / 64) as f64 + 0.5);
            assert!((f64::from(seen.depth) - plane(middle.x, middle.y).z).abs() < 1e-5);
        }
    }

    #[test]
    fn what_lets_light_through_is_listed_from_far_to_near() {
        let square = |depth: f64, name: u32| {
            let at = |x: f64, y: f64| DVec3::new(x, y, depth);
            Face { corners: [at(-9.0, -9.0), at(29.0, -9.0), at(-9.0, 29.0)], name }
        };
        let faces = [square(1.0, 0), square(3.0, 1), square(2.0, 2), square(4.0, 3)];
        let opacity = |name: u32, _: DVec2| [0.25, 0.5, 0.75, 1.0][name as usize];
        let tiles = draw(&faces, (4, 4), SIXTEEN, &opacity, |tile| tile.veils.clone());
        assert_eq!(tiles[0].len(), 3 * 16);
        for (pixel, own) in (0..).zip(tiles[0].chunks(3)) {
            assert!(own.iter().all(|veil| veil.pixel == pixel && veil.covered == 0xffff));
            assert_eq!([own[0].name, own[1].name, own[2].name], [1, 2, 0]);
            assert_eq!(own[1].opacity, 0.75);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let far = DVec3::new(1e12, 0.0, 1.0);
        let nan = DVec3::new(f64::NAN, 0.0, 1.0);
        for corners in [[far, DVec3::X, DVec3::Y], [nan, DVec3::X, DVec3::Y], [DVec3::X; 3]] {
            assert!(
                seen(&[Face { corners, name: 0 }], (8, 8), MIDDLE).iter().all(|seen| seen.name == u32::MAX)
            );
        }
    }
}

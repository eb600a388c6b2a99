//! Pictures in another size.
//!
//! Each pixel is the mean of those that it stands for, weighted by a filter that neither blurs much nor rings: colors as
//! light, not as the screen's numbers, and weighted by their opacity; normals made unit again; all else as it is. Beyond the
//! borders the picture goes on as its texture does, so that what repeats without a seam does so still. Sums run in one order
//! in doubles: the bytes are the same on every machine.
//!
//! Source: D. Mitchell, A. Netravali, "Reconstruction filters in computer graphics", SIGGRAPH 1988, with B = C = 1/3.

use super::Pixels;
use crate::geometry::number::{floor_count, srgb_to_linear};

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Colors as a screen shows them (sRGB), and opacity.
    Color,
    /// Directions in red, green and blue.
    Normal,
    /// Numbers.
    Data,
}

/// What lies beyond a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The picture again.
    Repeat,
    /// Its border.
    Clamp,
    /// The picture mirrored.
    Mirror,
}

/// The size of a picture whose longer side is at most so long, its sides in proportion; `None` where it is no longer.
#[must_use]
pub fn within([width, height]: [u32; 2], most: u32) -> Option<[u32; 2]> {
    let longer = width.max(height);
    let side = |side: u32| {
        let scaled = f64::from(side) * f64::from(most) / f64::from(longer);
        floor_count(scaled + 0.5).clamp(1, most)
    };
    (longer > most && most > 0).then(|| [side(width), side(height)])
}

/// A picture in another size. Linear in the pixels of both.
#[must_use]
pub fn resized(picture: &Pixels, size: [u32; 2], meaning: Meaning, edges: [Edge; 2]) -> Pixels {
    let (before, [width, height]) = ([picture.width, picture.height], size);
    let decode = Decode::new(meaning);
    let across = taps(before[0], width, edges[0]);
    let down = taps(before[1], height, edges[1]);
    let rows = picture.rgba.chunks_exact(before[0] as usize);
    let narrow: Vec<Vec<[f32; 4]>> = rows
        .map(|row| {
            let row: Vec<[f64; 4]> = row.iter().map(|pixel| decode.pixel(*pixel)).collect();
            across.iter().map(|taps| sum(taps, |at| row[at]).map(crate::geometry::number::single)).collect()
        })
        .collect();
    let mut rgba = Vec::with_capacity(width as usize * height as usize);
    for taps in &down {
        let pixel = |column: usize| decode.bytes(sum(taps, |at| narrow[at][column].map(f64::from)));
        rgba.extend((0..width as usize).map(pixel));
    }
    Pixels { width, height, rgba }
}

/// The pixels that a new one is made of, and their weights, which sum to one.
type Taps = Vec<(usize, f64)>;

fn sum(taps: &Taps, at: impl Fn(usize) -> [f64; 4]) -> [f64; 4] {
    let mut total = [0.0; 4];
    for (place, weight) in taps {
        let pixel = at(*place);
        (0..4).for_each(|part| total[part] += pixel[part] * weight);
    }
    total
}

fn taps(before: u32, after: u32, edge: Edge) -> Vec<Taps> {
    let ratio = f64::from(before) / f64::from(after);
    // Where it grows, the filter spans pixels of the old picture; where it shrinks, of the new one.
    let stretch = ratio.max(1.0);
    let count = i64::from(before);
    let place = |index: i64| {
        let within = match edge {
            Edge::Clamp => index.clamp(0, count - 1),
            Edge::Repeat => index.rem_euclid(count),
            Edge::Mirror => {
                let along = index.rem_euclid(2 * count);
                along.min(2 * count - 1 - along)
            }
        };
        usize::try_from(within).unwrap_or(0)
    };
    let one = |pixel: u32| {
        let middle = (f64::from(pixel) + 0.5) * ratio - 0.5;
        let reach = 2.0 * stretch;
        let (low, high) = (whole((middle - reach).ceil()), whole((middle + reach).floor()));
        let mut taps: Taps = Vec::new();
        for index in low..=high {
            #[expect(clippy::cast_precision_loss, reason = "pixels are fewer than 2^32")]
            let weight = mitchell((index as f64 - middle) / stretch);
            if weight != 0.0 {
                taps.push((place(index), weight));
            }
        }
        let total: f64 = taps.iter().map(|(_, weight)| weight).sum();
        taps.iter_mut().for_each(|(_, weight)| *weight /= total);
        taps
    };
    (0..after).map(one).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "a place in a picture, a few pixels beyond at most")]
fn whole(place: f64) -> i64 {
    place as i64
}

/// The filter, whose integral is one.
fn mitchell(x: f64) -> f64 {
    let x = x.abs();
    let (square, cube) = (x * x, x * x * x);
    if x < 1.0 {
        (7.0 * cube - 12.0 * square + 16.0 / 3.0) / 6.0
    } else if x < 2.0 {
        (-7.0 / 3.0 * cube + 12.0 * square - 20.0 * x + 32.0 / 3.0) / 6.0
    } else {
        0.0
    }
}

/// From bytes to what is added up, and back.
struct Decode {
    meaning: Meaning,
    /// The light of each byte.
    light: Vec<f64>,
}

impl Decode {
    fn new(meaning: Meaning) -> Self {
        let light = (0..=255_u8).map(|byte| srgb_to_linear(f64::from(byte) / 255.0)).collect();
        Self { meaning, light }
    }

    fn pixel(&self, pixel: [u8; 4]) -> [f64; 4] {
        let plain = pixel.map(|byte| f64::from(byte) / 255.0);
        match self.meaning {
            Meaning::Data => plain,
            Meaning::Normal => {
                let [x, y, z, alpha] = plain;
                [2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0, alpha]
            }
            Meaning::Color => {
                let alpha = plain[3];
                let part = |part: usize| self.light[usize::from(pixel[part])] * alpha;
                [part(0), part(1), part(2), alpha]
            }
        }
    }

    fn bytes(&self, sums: [f64; 4]) -> [u8; 4] {
        let [x, y, z, alpha] = sums;
        match self.meaning {
            Meaning::Data => sums.map(byte),
            Meaning::Normal => {
                let normal = glam::DVec3::new(x, y, z).normalize_or(glam::DVec3::Z);
                let [x, y, z] = normal.to_array().map(|part| byte(part / 2.0 + 0.5));
                [x, y, z, byte(alpha)]
            }
            Meaning::Color => {
                let opacity = alpha.clamp(0.0, 1.0);
                let part = |light: f64| if opacity > 0.0 { self.screen(light / opacity) } else { 0 };
                [part(x), part(y), part(z), byte(opacity)]
            }
        }
    }

    /// The byte whose light is nearest.
    fn screen(&self, light: f64) -> u8 {
        let above = self.light.partition_point(|own| *own < light).min(255);
        let nearest = if above > 0 && light - self.light[above - 1] <= self.light[above] - light {
            above - 1
        } else {
            above
        };
        u8::try_from(nearest).unwrap_or(u8::MAX)
    }
}

fn byte(part: f64) -> u8 {
    u8::try_from(floor_count(part.clamp(0.0, 1.0) * 255.0 + 0.5)).unwrap_or(u8::MAX)
}

#[cfg(test)]
mod tests {
    use super::{Edge, Meaning, resized, within};
    use crate::import::image::Pixels;

    const ALL: [Edge; 3] = [Edge::Repeat, Edge::Clamp, Edge::Mirror];

    fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Pixels {
        let rgba =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Pixels { width, height, rgba }
    }

    #[test]
    fn one_color_stays_itself() {
        for meaning in [Meaning::Color, Meaning::Data] {
            for byte in [0, 1, 77, 128, 254, 255] {
                let even = picture(37, 23, |_, _| [byte, 255 - byte, 3, 255]);
                for edge in ALL {
                    let made = resized(&even, [9, 31], meaning, [edge; 2]);
                    assert!(
                        made.rgba.iter().all(|pixel| *pixel == [byte, 255 - byte, 3, 255]),
                        "{meaning:?} {byte}"
                    );
                }
            }
        }
    }

    /// Half of the light of black and white is 188 on a screen (IEC 61966-2-1), and half of the numbers 128.
    #[test]
    fn colors_are_mixed_as_light_and_numbers_as_they_are() {
        let checks = picture(64, 64, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
        let middle = |meaning| resized(&checks, [8, 8], meaning, [Edge::Repeat; 2]).rgba[27];
        assert_eq!(middle(Meaning::Color), [188, 188, 188, 255]);
        assert!(middle(Meaning::Data)[0].abs_diff(128) <= 1);
    }

    #[test]
    fn what_cannot_be_seen_has_no_color() {
        let holes = picture(64, 64, |x, _| if x % 2 == 0 { [255, 0, 0, 255] } else { [0, 255, 0, 0] });
        let made = resized(&holes, [8, 8], Meaning::Color, [Edge::Repeat; 2]);
        assert!(made.rgba.iter().all(|pixel| pixel[..3] == [255, 0, 0] && pixel[3].abs_diff(128) <= 1));
    }

    #[test]
    fn normals_stay_unit() {
        let bumps =
            picture(64, 64, |x, _| if x % 4 < 2 { [218, 128, 218, 255] } else { [37, 128, 218, 255] });
        for pixel in resized(&bumps, [24, 24], Meaning::Normal, [Edge::Repeat; 2]).rgba {
            let [x, y, z, _] = pixel.map(|part| f64::from(part) / 127.5 - 1.0);
            assert!((glam::DVec3::new(x, y, z).length() - 1.0).abs() < 0.02, "{pixel:?}");
        }
    }

    /// A wave that repeats is the same wave, however the picture is shifted before.
    #[test]
    fn what_repeats_without_a_seam_does_so_still() {
        let wave = |shift: u32| {
            picture(60, 4, move |x, _| [if (x + shift) % 60 < 30 { 40 } else { 200 }, 0, 0, 255])
        };
        let small = |shift: u32| resized(&wave(shift), [20, 4], Meaning::Data, [Edge::Repeat, Edge::Clamp]);
        let (one, other) = (small(0), small(15));
        for x in 0..20 {
            assert_eq!(one.rgba[(x + 5) % 20], other.rgba[x]);
        }
    }

    #[test]
    fn sizes_keep_their_proportion() {
        assert_eq!(within([2048, 1024], 512), Some([512, 256]));
        assert_eq!(within([3, 4000], 100), Some([1, 100]));
        assert_eq!(within([512, 300], 512), None);
    }
}

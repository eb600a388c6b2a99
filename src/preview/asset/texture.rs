//! Pictures of materials.

use glam::Vec4;

use crate::geometry::number::{floor_index, single};
use crate::import::gltf::Data;
use crate::import::image;
use crate::preview::color;

/// A picture with smaller copies of itself, and the way it goes on beyond its rims.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The picture, then copies of half the size each; none when it could not be read: then it is white.
    levels: Vec<Level>,
    wrap: [Wrap; 2],
    /// Whether bytes are sRGB colors rather than linear numbers.
    colors: bool,
}

#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<[u8; 4]>,
}

/// What lies beyond the rim of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// It again.
    Repeat,
    /// It again, mirrored.
    Mirror,
    /// Its rim.
    Clamp,
}

/// Most pixels of a picture.
const MOST: u64 = 1 << 26;

pub(super) fn read(data: &Data<'_>, notes: &mut Vec<String>) -> Vec<Texture> {
    let colored = colored(data.document);
    let read = |texture: gltf::Texture<'_>| {
        let source = texture.source();
        let levels = match source.source() {
            gltf::image::Source::View { view, .. } => data
                .view(&view)
                .map_err(|error| error.to_string())
                .and_then(|bytes| image::pixels(bytes, MOST).map_err(|error| error.to_string())),
            gltf::image::Source::Uri { .. } => Err("it stands outside the file".to_owned()),
        };
        let colors = colored.contains(&texture.index());
        let levels = match levels {
            Ok(pixels) => halved(
                Level { width: pixels.width as usize, height: pixels.height as usize, texels: pixels.rgba },
                colors,
            ),
            Err(reason) => {
                notes.push(format!("image {} is left white: {reason}", source.index()));
                Vec::new()
            }
        };
        let wrap = |mode| match mode {
            gltf::texture::WrappingMode::Repeat => Wrap::Repeat,
            gltf::texture::WrappingMode::MirroredRepeat => Wrap::Mirror,
            gltf::texture::WrappingMode::ClampToEdge => Wrap::Clamp,
        };
        let sampler = texture.sampler();
        Texture { levels, wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())], colors }
    };
    data.document.textures().map(read).collect()
}

/// Textures that are colors, not numbers.
fn colored(document: &gltf::Document) -> Vec<usize> {
    let of = |material: gltf::Material<'_>| {
        let base = material.pbr_metallic_roughness().base_color_texture();
        [base, material.emissive_texture()].map(|info| info.map(|info| info.texture().index()))
    };
    document.materials().flat_map(of).flatten().collect()
}

/// A picture with its copies down to one texel; means are taken of linear values.
fn halved(picture: Level, colors: bool) -> Vec<Level> {
    let mut levels = vec![picture];
    while let Some(last) = levels.last().filter(|last| last.width > 1 || last.height > 1) {
        let (width, height) = ((last.width / 2).max(1), (last.height / 2).max(1));
        let mut texels = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let at = |k: usize| {
                    let x = (2 * column + k % 2).min(last.width - 1);
                    let y = (2 * row + k / 2).min(last.height - 1);
                    linear(last.texels[y * last.width + x], colors)
                };
                let mean = (at(0) + at(1) + at(2) + at(3)) / 4.0;
                texels.push(bytes(mean, colors));
            }
        }
        levels.push(Level { width, height, texels });
    }
    levels
}

fn linear(texel: [u8; 4], colors: bool) -> Vec4 {
    let share = |k: usize| f32::from(texel[k]) / 255.0;
    if colors {
        let [r, g, b] = [0, 1, 2].map(|k| color::linear(texel[k]));
        Vec4::new(r, g, b, share(3))
    } else {
        Vec4::new(share(0), share(1), share(2), share(3))
    }
}

fn bytes(value: Vec4, colors: bool) -> [u8; 4] {
    let share = |part: f32| color::byte(part);
    if colors {
        [color::srgb(value.x), color::srgb(value.y), color::srgb(value.z), share(value.w)]
    } else {
        [share(value.x), share(value.y), share(value.z), share(value.w)]
    }
}

impl Texture {
    /// Texels across and down; 1 and 1 where the picture could not be read.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        let size = |level: &Level| (level.width as f64, level.height as f64);
        self.levels.first().map_or((1.0, 1.0), size)
    }

    /// The value at texture coordinates, linear, between the texels of the level nearest to `level` (0 is the whole
    /// picture, each further one half of it).
    #[must_use]
    pub fn at(&self, [u, v]: [f64; 2], level: f64) -> Vec4 {
        let Some(last) = self.levels.len().checked_sub(1) else { return Vec4::ONE };
        let level = &self.levels[floor_index(level + 0.5).min(last)];
        let spread = |t: f64, count: usize| {
            let place = t * count as f64 - 0.5;
            let floor = place.floor();
            (floor, single(place - floor))
        };
        let ((x, right), (y, down)) = (spread(u, level.width), spread(v, level.height));
        let texel = |dx: f64, dy: f64| {
            let (x, y) = (self.wrap[0].at(x + dx, level.width), self.wrap[1].at(y + dy, level.height));
            linear(level.texels[y * level.width + x], self.colors)
        };
        let upper = texel(0.0, 0.0).lerp(texel(1.0, 0.0), right);
        let lower = texel(0.0, 1.0).lerp(texel(1.0, 1.0), right);
        upper.lerp(lower, down)
    }
}

impl Wrap {
    /// The texel that is shown at a whole place.
    fn at(self, place: f64, count: usize) -> usize {
        let most = count as f64;
        let within = match self {
            Self::Repeat => place.rem_euclid(most),
            Self::Mirror => {
                let place = place.rem_euclid(2.0 * most);
                if place < most { place } else { 2.0 * most - 1.0 - place }
            }
            Self::Clamp => place,
        };
        floor_index(within.max(0.0)).min(count - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::{Level, Texture, Wrap, halved};

    fn checks(wrap: Wrap) -> Texture {
        let texels = vec![[0, 0, 0, 255], [255, 255, 255, 255], [255, 255, 255, 255], [0, 0, 0, 255]];
        Texture {
            levels: halved(Level { width: 2, height: 2, texels }, false),
            wrap: [wrap, wrap],
            colors: false,
        }
    }

    #[test]
    fn texels_stand_in_the_middle_of_their_squares() {
        let texture = checks(Wrap::Repeat);
        assert_eq!(texture.at([0.25, 0.25], 0.0).x, 0.0);
        assert_eq!(texture.at([0.75, 0.25], 0.0).x, 1.0);
        assert_eq!(texture.at([0.5, 0.25], 0.0).x, 0.5);
        assert!((texture.at([0.1, 0.9], 1.0).x - 0.5).abs() < 0.01, "the smallest copy is the mean");
    }

    #[test]
    fn rims_go_on_as_they_shall() {
        assert_eq!(checks(Wrap::Repeat).at([1.25, 0.25], 0.0).x, 0.0);
        assert_eq!(checks(Wrap::Mirror).at([1.25, 0.25], 0.0).x, 1.0);
        assert_eq!(checks(Wrap::Clamp).at([7.0, 0.25], 0.0).x, 1.0);
        assert_eq!(checks(Wrap::Clamp).at([-7.0, 0.25], 0.0).x, 0.0);
        assert_eq!(checks(Wrap::Mirror).at([-0.25, 0.25], 0.0).x, 0.0);
    }
}

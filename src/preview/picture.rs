//! Pictures as pixels and as files.
//!
//! Source: W3C, Portable Network Graphics, 3rd ed. 2025 (with animations).

use thiserror::Error;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Red, green, blue (sRGB) and opacity, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
}

/// Why a picture cannot be written.
#[derive(Debug, Error)]
pub enum PictureError {
    /// As a PNG file.
    #[error("the picture cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// As a GIF file.
    #[error("the picture cannot be encoded: {0}")]
    Gif(#[from] gif::EncodingError),
}

/// Pixels between the pictures of a sheet.
const GAP: usize = 8;

impl Picture {
    /// Pictures side by side, in rows that make the sheet about square; between them and where none is left, `color`.
    #[must_use]
    pub fn sheet(pictures: &[Self], color: [u8; 4]) -> Self {
        let width = pictures.iter().map(|picture| picture.width).max().unwrap_or(1);
        let height = pictures.iter().map(|picture| picture.height).max().unwrap_or(1);
        let across = (1..=pictures.len()).find(|across| across * across >= pictures.len()).unwrap_or(1);
        let down = pictures.len().div_ceil(across).max(1);
        let (all_across, all_down) = (across * width + (across - 1) * GAP, down * height + (down - 1) * GAP);
        let mut pixels = vec![color; all_across * all_down];
        for (number, picture) in pictures.iter().enumerate() {
            let (left, top) = (number % across * (width + GAP), number / across * (height + GAP));
            for (row, line) in picture.pixels.chunks(picture.width).enumerate() {
                let start = (top + row) * all_across + left;
                pixels[start..start + picture.width].copy_from_slice(line);
            }
        }
        Self { width: all_across, height: all_down, pixels }
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// When it has no pixels, or more than a file can hold.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let encoder = encoder(&mut bytes, self);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(bytes)
    }

    /// Pictures of one size as an animated PNG file that goes round for ever; each is shown for `milliseconds`.
    ///
    /// # Errors
    /// As for [`png`](Self::png), and when there are no pictures or their sizes differ.
    pub fn animation(pictures: &[Self], milliseconds: u16) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let empty = Self { width: 0, height: 0, pixels: Vec::new() };
        let first = pictures.first().unwrap_or(&empty);
        let mut encoder = encoder(&mut bytes, first);
        encoder.set_animated(u32::try_from(pictures.len()).unwrap_or(u32::MAX), 0)?;
        encoder.set_frame_delay(milliseconds, 1000)?;
        let mut writer = encoder.write_header()?;
        for picture in pictures {
            writer.write_image_data(picture.pixels.as_flattened())?;
        }
        writer.finish()?;
        Ok(bytes)
    }

    /// The same as GIF: of 255 colors, for places that show no better.
    ///
    /// # Errors
    /// When the sides of a picture are no whole numbers of 16 bits.
    pub fn gif(pictures: &[Self], milliseconds: u16) -> Result<Vec<u8>, PictureError> {
        Ok(super::gif::gif(pictures, milliseconds)?)
    }
}

fn encoder<'a>(bytes: &'a mut Vec<u8>, picture: &Picture) -> png::Encoder<'static, &'a mut Vec<u8>> {
    let size = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let mut encoder = png::Encoder::new(bytes, size(picture.width), size(picture.height));
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    encoder
}

#[cfg(test)]
mod tests {
    use super::Picture;
    use crate::import::image;

    fn plain(width: usize, height: usize, color: [u8; 4]) -> Picture {
        Picture { width, height, pixels: vec![color; width * height] }
    }

    #[test]
    fn a_file_holds_the_pixels() {
        let mut picture = plain(5, 3, [1, 2, 3, 255]);
        picture.pixels[7] = [200, 100, 50, 0];
        let read = image::pixels(&picture.png().unwrap(), 1000).unwrap();
        assert_eq!((read.width, read.height, read.rgba), (5, 3, picture.pixels));
    }

    #[test]
    fn an_animation_holds_its_pictures_in_order() {
        let all: Vec<Picture> = (0..3).map(|k| plain(4, 2, [k, 0, 0, 255])).collect();
        let bytes = Picture::animation(&all, 40).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
        for picture in all {
            let mut pixels = vec![0; 4 * 8];
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(pixels, picture.pixels.as_flattened());
        }
        assert!(Picture::animation(&[], 40).is_err());
    }

    #[test]
    fn a_sheet_is_about_square() {
        let five: Vec<Picture> = (0..5).map(|k| plain(10, 10, [k, 0, 0, 255])).collect();
        let sheet = Picture::sheet(&five, [9, 9, 9, 9]);
        assert_eq!((sheet.width, sheet.height), (46, 28));
        assert_eq!(sheet.pixels[0], [0, 0, 0, 255]);
        assert_eq!(sheet.pixels[12], [9, 9, 9, 9], "a gap");
        assert_eq!(sheet.pixels[46 * 18 + 18], [4, 0, 0, 255], "the fifth");
    }
}

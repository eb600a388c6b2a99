//! Pictures into short PNG files: nothing of what is seen is lost.
//!
//! Opacity that is full everywhere, colors that are all grey, and colors that are so few that a palette holds them are
//! written so; all filters of the format are tried, and the shortest is kept. The bytes depend on the pixels alone. Not
//! promised: what a program that searches for minutes finds.
//!
//! Source: W3C, Portable Network Graphics (PNG) Specification, third edition, 2025, sections 6 and 9.

use std::collections::HashMap;

use png::{BitDepth, ColorType, Compression, Filter};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::{ImageError, Kind, Pixels, pixels};

/// The filters of the format, and the choice among them row by row.
const FILTERS: [Filter; 6] =
    [Filter::Adaptive, Filter::NoFilter, Filter::Sub, Filter::Up, Filter::Avg, Filter::Paeth];

/// How pixels are laid down.
struct Form {
    color: ColorType,
    data: Vec<u8>,
    /// Red, green and blue of each entry, and its opacity.
    palette: Option<(Vec<u8>, Vec<u8>)>,
}

/// The bytes of a PNG file; with `search` the shortest of many ways to write it, which takes some fifty times as long.
#[must_use]
pub fn png(picture: &Pixels, search: bool) -> Vec<u8> {
    let size = [picture.width, picture.height];
    let direct = direct(picture);
    if !search {
        return written(size, &direct, Filter::Adaptive, Compression::Balanced);
    }
    let mut ways: Vec<(&Form, Filter)> = FILTERS.iter().map(|filter| (&direct, *filter)).collect();
    let indexed = indexed(picture);
    ways.extend(indexed.iter().map(|form| (form, Filter::NoFilter)));
    let all: Vec<Vec<u8>> =
        ways.par_iter().map(|(form, filter)| written(size, form, *filter, Compression::High)).collect();
    // The first of those that are equally short.
    all.into_iter().min_by_key(Vec::len).unwrap_or_default()
}

/// A shorter PNG file of the same picture; `None` where there is none, or it is no PNG of 8 bits a part or fewer.
///
/// # Errors
/// See [`ImageError`].
pub fn shorter(bytes: &[u8], pixel_limit: u64) -> Result<Option<Vec<u8>>, ImageError> {
    if super::read(bytes, pixel_limit)?.kind != Kind::Png || is_deep(bytes) {
        return Ok(None);
    }
    let made = png(&pixels(bytes, pixel_limit)?, true);
    Ok((made.len() < bytes.len()).then_some(made))
}

/// Whether a PNG file has 16 bits a part: a byte of its first chunk, which is checked by then.
fn is_deep(bytes: &[u8]) -> bool {
    bytes.get(24) == Some(&16)
}

fn written([width, height]: [u32; 2], form: &Form, filter: Filter, compression: Compression) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(form.color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.set_filter(filter);
    if let Some((colors, opacity)) = &form.palette {
        encoder.set_palette(colors.as_slice());
        if opacity.iter().any(|alpha| *alpha != 255) {
            encoder.set_trns(opacity.as_slice());
        }
    }
    let done = encoder.write_header().and_then(|mut writer| writer.write_image_data(&form.data));
    done.expect("a picture of this size into memory cannot fail");
    bytes
}

/// Parts one by one, as few as the picture needs.
fn direct(picture: &Pixels) -> Form {
    let all = &picture.rgba;
    let grey = all.iter().all(|[red, green, blue, _]| red == green && green == blue);
    let opaque = all.iter().all(|pixel| pixel[3] == 255);
    let (color, parts): (ColorType, &[usize]) = match (grey, opaque) {
        (true, true) => (ColorType::Grayscale, &[0]),
        (true, false) => (ColorType::GrayscaleAlpha, &[0, 3]),
        (false, true) => (ColorType::Rgb, &[0, 1, 2]),
        (false, false) => (ColorType::Rgba, &[0, 1, 2, 3]),
    };
    let data = all.iter().flat_map(|pixel| parts.iter().map(|part| pixel[*part])).collect();
    Form { color, data, palette: None }
}

/// Entries of a palette, in the order of their first use; `None` where there are more than it holds.
fn indexed(picture: &Pixels) -> Option<Form> {
    // Only looked up, never walked.
    let mut known: HashMap<[u8; 4], u8> = HashMap::new();
    let mut entries: Vec<[u8; 4]> = Vec::new();
    let mut data = Vec::with_capacity(picture.rgba.len());
    for pixel in &picture.rgba {
        let index = match known.get(pixel) {
            Some(index) => *index,
            None => {
                let index = u8::try_from(entries.len()).ok()?;
                entries.push(*pixel);
                known.insert(*pixel, index);
                index
            }
        };
        data.push(index);
    }
    let colors = entries.iter().flat_map(|[red, green, blue, _]| [*red, *green, *blue]).collect();
    let opacity = entries.iter().map(|entry| entry[3]).collect();
    Some(Form { color: ColorType::Indexed, data, palette: Some((colors, opacity)) })
}

#[cfg(test)]
mod tests {
    use super::{png, shorter};
    use crate::import::image::{Pixels, pixels};

    fn picture(pixel: impl Fn(u32, u32) -> [u8; 4]) -> Pixels {
        let rgba = (0..40).flat_map(|y| (0..50).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Pixels { width: 50, height: 40, rgba }
    }

    fn pictures() -> Vec<Pixels> {
        let byte = |value: u32| u8::try_from(value % 256).expect("a byte");
        vec![
            picture(|_, _| [9, 9, 9, 255]),
            picture(move |x, y| [byte(x * y), byte(x * y), byte(x * y), 255]),
            picture(move |x, y| [byte(x), byte(x), byte(x), byte(y)]),
            picture(move |x, y| [byte(x * 5), byte(y * 6), byte(x * y * 7), 255]),
            picture(move |x, y| [byte(x * 5), byte(y * 6), byte(x * y * 7), byte(x + y)]),
            picture(move |x, y| [byte(x / 10 * 60), 0, byte(y / 20 * 9), if x < 5 { 0 } else { 255 }]),
        ]
    }

    #[test]
    fn files_hold_the_picture_and_search_never_makes_them_longer() {
        for one in pictures() {
            let (quick, short) = (png(&one, false), png(&one, true));
            for bytes in [&quick, &short] {
                assert_eq!(pixels(bytes, 10_000).expect("a picture"), one);
            }
            assert!(short.len() <= quick.len());
            assert_eq!(shorter(&short, 10_000), Ok(None), "what is shortest is left alone");
            let again = shorter(&quick, 10_000).expect("a picture");
            assert_eq!(again.unwrap_or(quick).len(), short.len());
        }
    }
}

//! Grids of numbers from files: grey pictures, ESRI ASCII grids, bare numbers.
//!
//! What a file claims to hold is held against the limit before anything is decoded or memory is taken.

use std::io::Cursor;

use thiserror::Error;

/// A grid of numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Numbers in a row; at least 1.
    pub columns: usize,
    /// The numbers; whole rows.
    pub values: Vec<f64>,
    /// The number that stands for no value.
    pub no_data: Option<f64>,
}

/// Numbers of a raw file, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RawNumber {
    /// Unsigned, one byte.
    U8,
    /// Unsigned, two bytes.
    U16,
    /// Signed, two bytes.
    I16,
    /// Floating point, four bytes.
    F32,
    /// Floating point, eight bytes.
    F64,
}

impl RawNumber {
    /// Bytes of one.
    #[must_use]
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// Why a file gives no heights. `Display` is a message for a diagnostic.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HeightsError {
    /// More numbers than allowed; nothing was decoded.
    #[error("it has {columns} x {rows} samples, more than the limit of {limit}")]
    TooLarge {
        /// Numbers in a row.
        columns: u64,
        /// Rows.
        rows: u64,
        /// Most samples.
        limit: u64,
    },
    /// A picture with colors, a palette, transparency or few grays.
    #[error("it is {found}; heights are read from grey pictures of 8 or 16 bits")]
    Look {
        /// What it is, with its article.
        found: String,
    },
    /// Not a picture in PNG.
    #[error("it is no PNG picture")]
    NotPng,
    /// A damaged picture.
    #[error("the PNG file is damaged: {0}")]
    Damaged(String),
    /// The text of an ASCII grid is wrong.
    #[error("line {line}: {reason}")]
    Text {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A raw file of the wrong length.
    #[error("it has {found} bytes; {columns} x {rows} numbers of {each} bytes{} are {needed}", if *skip == 0 { String::new() } else { format!(" after {skip}") })]
    Length {
        /// Bytes of the file.
        found: u64,
        /// Bytes that are needed.
        needed: u64,
        /// Numbers in a row.
        columns: u64,
        /// Rows.
        rows: u64,
        /// Bytes of a number.
        each: u64,
        /// Bytes before the first.
        skip: u64,
    },
}

fn allow(columns: u64, rows: u64, limit: u64) -> Result<(), HeightsError> {
    if columns.saturating_mul(rows) > limit {
        return Err(HeightsError::TooLarge { columns, rows, limit });
    }
    Ok(())
}

/// A grey PNG of 8 or 16 bits: black is 0, white is 1. Time and memory are linear in its pixels.
///
/// # Errors
/// See [`HeightsError`].
pub fn png(bytes: &[u8], limit: u64) -> Result<Heights, HeightsError> {
    if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(HeightsError::NotPng);
    }
    let damaged = |error: png::DecodingError| {
        let whole = error.to_string();
        let reason = whole.split(" while decoding").next().unwrap_or(&whole);
        HeightsError::Damaged(reason.trim_end_matches('.').to_owned())
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (u64::from(header.width), u64::from(header.height));
    let wide = match (header.color_type, header.bit_depth) {
        (png::ColorType::Grayscale, png::BitDepth::Eight) => false,
        (png::ColorType::Grayscale, png::BitDepth::Sixteen) => true,
        (color, depth) => return Err(HeightsError::Look { found: look(color, depth) }),
    };
    allow(width, height, limit)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    if reader.info().trns.is_some() {
        return Err(HeightsError::Look { found: "a grey picture with a transparent color".to_owned() });
    }
    let size =
        reader.output_buffer_size().ok_or(HeightsError::TooLarge { columns: width, rows: height, limit })?;
    let mut pixels = vec![0; size];
    reader.next_frame(&mut pixels).map_err(damaged)?;
    reader.finish().map_err(damaged)?;
    let values = if wide {
        pixels
            .chunks_exact(2)
            .map(|pair| f64::from(u16::from_be_bytes([pair[0], pair[1]])) / 65_535.0)
            .collect()
    } else {
        pixels.iter().map(|pixel| f64::from(*pixel) / 255.0).collect()
    };
    Ok(Heights { columns: crate::geometry::number::size(width), values, no_data: None })
}

fn look(color: png::ColorType, depth: png::BitDepth) -> String {
    let name = match color {
        png::ColorType::Grayscale => "a grey picture",
        png::ColorType::Rgb => "an RGB picture",
        png::ColorType::Indexed => "a picture with a palette",
        png::ColorType::GrayscaleAlpha => "a grey picture with transparency",
        png::ColorType::Rgba => "an RGB picture with transparency",
    };
    let bits = match depth {
        png::BitDepth::One => 1,
        png::BitDepth::Two => 2,
        png::BitDepth::Four => 4,
        png::BitDepth::Eight => 8,
        png::BitDepth::Sixteen => 16,
    };
    format!("{name} of {bits} {}", if bits == 1 { "bit" } else { "bits" })
}

/// Bare numbers, little-endian, after `skip` bytes; nothing may follow them.
///
/// # Errors
/// See [`HeightsError`].
pub fn raw(
    bytes: &[u8],
    [columns, rows]: [u32; 2],
    (number, skip): (RawNumber, u64),
    limit: u64,
) -> Result<Heights, HeightsError> {
    let (columns, rows) = (u64::from(columns), u64::from(rows));
    allow(columns, rows, limit)?;
    let each = number.bytes() as u64;
    let needed = (columns * rows).saturating_mul(each).saturating_add(skip);
    let found = bytes.len() as u64;
    if needed != found {
        return Err(HeightsError::Length { found, needed, columns, rows, each, skip });
    }
    let numbers = bytes[crate::geometry::number::size(skip)..].chunks_exact(number.bytes());
    let read = |bytes: &[u8]| match *bytes {
        [a] => f64::from(a),
        [a, b] if number == RawNumber::I16 => f64::from(i16::from_le_bytes([a, b])),
        [a, b] => f64::from(u16::from_le_bytes([a, b])),
        [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    };
    let columns = crate::geometry::number::size(columns);
    Ok(Heights { columns, values: numbers.map(read).collect(), no_data: None })
}

/// Keys of an ASCII grid that say where it lies, which is nothing to a map.
const PLACES: [&str; 7] = ["xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy"];

/// An ESRI ASCII grid. Numbers may be broken into lines anywhere.
///
/// # Errors
/// See [`HeightsError`].
pub fn ascii_grid(bytes: &[u8], limit: u64) -> Result<Heights, HeightsError> {
    let fault = |line: usize, reason: String| HeightsError::Text { line, reason };
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count() + 1;
        fault(line, "it is not text".to_owned())
    })?;
    let words = text
        .lines()
        .enumerate()
        .flat_map(|(at, line)| line.split_ascii_whitespace().map(move |word| (at + 1, word)));
    let mut words = words.peekable();
    let (mut columns, mut rows, mut no_data) = (None, None, None);
    while let Some((line, word)) =
        words.next_if(|(_, word)| word.starts_with(|c: char| c.is_ascii_alphabetic()))
    {
        let key = word.to_ascii_lowercase();
        let Some((_, value)) = words.next() else {
            return Err(fault(line, format!("`{}` has no value", shown(word))));
        };
        match key.as_str() {
            "ncols" => columns = Some(count(line, &key, value)?),
            "nrows" => rows = Some(count(line, &key, value)?),
            "nodata_value" => no_data = Some(number(line, value)?),
            key if PLACES.contains(&key) => {
                number(line, value)?;
            }
            _ => return Err(fault(line, format!("`{}` is no key of an ASCII grid", shown(word)))),
        }
    }
    let (Some(columns), Some(rows)) = (columns, rows) else {
        let line = words.peek().map_or(1, |(line, _)| *line);
        return Err(fault(line, "the header does not say `ncols` and `nrows`".to_owned()));
    };
    allow(columns, rows, limit)?;
    let all = columns * rows;
    // A number takes two bytes of text at least: more are not there to be read.
    let mut values = Vec::with_capacity(crate::geometry::number::size(all).min(bytes.len()));
    let mut last = 1;
    for (line, word) in words {
        last = line;
        if values.len() as u64 == all {
            return Err(fault(line, format!("more than {columns} x {rows} numbers")));
        }
        values.push(number(line, word)?);
    }
    if (values.len() as u64) < all {
        return Err(fault(
            last,
            format!("the file ends after {} of {columns} x {rows} numbers", values.len()),
        ));
    }
    Ok(Heights { columns: crate::geometry::number::size(columns), values, no_data })
}

fn number(line: usize, word: &str) -> Result<f64, HeightsError> {
    let read = word.parse::<f64>().ok().filter(|number| number.is_finite());
    read.ok_or_else(|| HeightsError::Text {
        line,
        reason: format!("`{}` is not a finite number", shown(word)),
    })
}

fn count(line: usize, key: &str, word: &str) -> Result<u64, HeightsError> {
    let read = word.parse::<u64>().ok().filter(|count| *count > 0);
    let reason = format!("`{key}` is `{}`, not a number of samples", shown(word));
    read.ok_or(HeightsError::Text { line, reason })
}

/// A word of a file as a message shows it.
fn shown(word: &str) -> String {
    word.chars().take(24).map(|c| if c.is_control() { '?' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::{HeightsError, RawNumber, ascii_grid, png, raw};

    fn picture(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn grey_pictures_are_read_to_the_last_bit() {
        let words = [0_u16, 1, 65_535, 32_768, 256, 255];
        let data: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
        let read = png(&picture(png::ColorType::Grayscale, png::BitDepth::Sixteen, &data), 6).unwrap();
        assert_eq!((read.columns, read.values.len()), (3, 6));
        for (word, value) in words.iter().zip(&read.values) {
            assert_eq!(value * 65_535.0, f64::from(*word));
        }
        let bytes = [0, 51, 255, 7, 8, 9];
        let read = png(&picture(png::ColorType::Grayscale, png::BitDepth::Eight, &bytes), 6).unwrap();
        assert_eq!(read.values[..3], [0.0, 0.2, 1.0]);
    }

    #[test]
    fn other_pictures_are_refused_before_they_are_decoded() {
        let grey = picture(png::ColorType::Grayscale, png::BitDepth::Eight, &[0; 6]);
        assert_eq!(png(&grey, 5), Err(HeightsError::TooLarge { columns: 3, rows: 2, limit: 5 }));
        let color = png(&picture(png::ColorType::Rgb, png::BitDepth::Eight, &[0; 18]), 100);
        assert!(matches!(color, Err(HeightsError::Look { found }) if found == "an RGB picture of 8 bits"));
        let few = png(&picture(png::ColorType::Grayscale, png::BitDepth::One, &[0; 2]), 100);
        assert!(matches!(few, Err(HeightsError::Look { found }) if found == "a grey picture of 1 bit"));
        for length in 8..grey.len() - 1 {
            assert!(matches!(png(&grey[..length], 100), Err(HeightsError::Damaged(_))), "{length}");
        }
        assert_eq!(png(b"GIF89a", 100), Err(HeightsError::NotPng));
    }

    #[test]
    fn raw_numbers_fill_their_file() {
        let bytes: Vec<u8> = [-2_i16, 300, 0, 7].iter().flat_map(|number| number.to_le_bytes()).collect();
        assert_eq!(raw(&bytes, [2, 2], (RawNumber::I16, 0), 4).unwrap().values, [-2.0, 300.0, 0.0, 7.0]);
        assert_eq!(raw(&bytes, [1, 3], (RawNumber::U16, 2), 4).unwrap().values, [300.0, 0.0, 7.0]);
        let long = raw(&bytes, [2, 2], (RawNumber::F32, 0), 4);
        assert!(matches!(long, Err(HeightsError::Length { found: 8, needed: 16, .. })));
        assert!(matches!(
            raw(&bytes, [u32::MAX, u32::MAX], (RawNumber::U8, 0), 9),
            Err(HeightsError::TooLarge { .. })
        ));
    }

    #[test]
    fn ascii_grids_say_what_is_wrong() {
        let good = "NCOLS 3\nnrows 2\nxllcorner 1.5\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n1 2 3\n4 5\n-9999\n";
        let read = ascii_grid(good.as_bytes(), 6).unwrap();
        assert_eq!((read.columns, read.no_data), (3, Some(-9999.0)));
        assert_eq!(read.values, [1.0, 2.0, 3.0, 4.0, 5.0, -9999.0]);
        let wrong = [
            ("ncols 2\nnrows 2\n1 2 3", "line 3: the file ends after 3 of 2 x 2 numbers"),
            ("ncols 2\nnrows 1\n1 2\n3", "line 4: more than 2 x 1 numbers"),
            ("ncols 2\nnrows 1\n1 nan", "line 3: `nan` is not a finite number"),
            ("ncols -2\nnrows 1\n1 2", "line 1: `ncols` is `-2`, not a number of samples"),
            ("ncols 2\n1 2", "line 2: the header does not say `ncols` and `nrows`"),
            ("ncols 2\nheight 3\n1 2", "line 2: `height` is no key of an ASCII grid"),
            ("ncols", "line 1: `ncols` has no value"),
            (
                "ncols 99999999999\nnrows 99999999999\n1",
                "it has 99999999999 x 99999999999 samples, more than the limit of 6",
            ),
        ];
        for (text, message) in wrong {
            assert_eq!(ascii_grid(text.as_bytes(), 6).unwrap_err().to_string(), message);
        }
        assert!(ascii_grid(b"ncols 1\n\xff", 6).unwrap_err().to_string().starts_with("line 2"));
    }
}

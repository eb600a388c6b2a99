//! Pictures for textures: PNG and JPEG, checked before they are embedded.
//!
//! A picture is checked row by row, so that even the largest takes little memory, and its size is held against the
//! limit before anything is decoded.

mod encode;
mod fit;
mod resize;

pub use encode::{png, shorter};
pub use fit::{Wish, fitted, packed};
pub use resize::{Edge, Meaning, resized, within};

use std::io::Cursor;

use serde::Serialize;
use thiserror::Error;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Format of a picture that glTF can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
}

impl Kind {
    /// The MIME type as glTF writes it.
    #[must_use]
    pub fn mime_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
        }
    }
}

/// What a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageFacts {
    /// Its format.
    pub kind: Kind,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// Whether it can be transparent: an alpha channel or a transparent color.
    pub alpha: bool,
}

/// Why a picture cannot be used. `Display` is a message for a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImageError {
    /// Neither PNG nor JPEG.
    #[error("this is {found}; textures are PNG or JPEG")]
    Format {
        /// What it is, with its article.
        found: &'static str,
    },
    /// More pixels than allowed; nothing was decoded.
    #[error("the picture is {width} x {height} pixels, more than the limit of {limit}")]
    TooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Most pixels allowed.
        limit: u64,
    },
    /// Damaged.
    #[error("the {} file is damaged: {reason}", match kind { Kind::Png => "PNG", Kind::Jpeg => "JPEG" })]
    Damaged {
        /// Its format.
        kind: Kind,
        /// What the decoder says.
        reason: String,
    },
    /// A JPEG in the colors of print.
    #[error("the JPEG file has {components} color components; engines show only grey (1) and RGB (3)")]
    Components {
        /// Components.
        components: u8,
    },
}

impl ImageError {
    /// What to do about it.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Self::Format { .. } => "convert it to PNG",
            Self::TooLarge { .. } => {
                "scale it down; where [limits] lowers `image-pixels` or `memory`, write more there"
            }
            Self::Damaged { .. } => "save it again from the program that made it",
            Self::Components { .. } => "convert it from CMYK to RGB",
        };
        Some(hint.to_owned())
    }
}

/// Other formats, by their first bytes.
const OTHERS: [(&[u8], &str); 9] = [
    (b"GIF8", "a GIF picture"),
    (b"BM", "a BMP picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"RIFF", "a WebP picture (or another RIFF file)"),
    (b"DDS ", "a DDS texture"),
    (b"\xabKTX", "a KTX texture"),
    (b"8BPS", "a Photoshop document"),
    (b"<svg", "an SVG drawing"),
];

/// Checks a picture of at most `pixel_limit` pixels.
///
/// PNG: all rows are decoded and every checksum is checked. JPEG: the headers, and that the file has its end. Time is
/// linear in pixels, memory in the file and one row.
///
/// # Errors
/// See [`ImageError`].
pub fn read(bytes: &[u8], pixel_limit: u64) -> Result<ImageFacts, ImageError> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return read_png(bytes, pixel_limit);
    }
    if bytes.starts_with(b"\xff\xd8\xff") {
        return read_jpeg(bytes, pixel_limit);
    }
    let known = OTHERS.iter().find(|(magic, _)| bytes.starts_with(magic));
    Err(ImageError::Format {
        found: known
            .map_or(if bytes.is_empty() { "an empty file" } else { "not a picture" }, |&(_, name)| name),
    })
}

/// A picture, decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// Red, green, blue and opacity of each pixel, row by row from the top.
    pub rgba: Vec<[u8; 4]>,
}

/// Decodes a picture of at most `pixel_limit` pixels; numbers of 16 bits keep their upper 8.
///
/// # Errors
/// See [`ImageError`].
pub fn pixels(bytes: &[u8], pixel_limit: u64) -> Result<Pixels, ImageError> {
    let facts = read(bytes, pixel_limit)?;
    let rgba = match facts.kind {
        Kind::Png => png_pixels(bytes)?,
        Kind::Jpeg => {
            let most = usize::from(u16::MAX);
            let options = DecoderOptions::default()
                .set_max_width(most)
                .set_max_height(most)
                .jpeg_set_out_colorspace(ColorSpace::RGBA);
            let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
            let decoded = decoder
                .decode()
                .map_err(|error| ImageError::Damaged { kind: Kind::Jpeg, reason: error.to_string() })?;
            decoded.as_chunks().0.to_vec()
        }
    };
    let count = u64::from(facts.width) * u64::from(facts.height);
    if rgba.len() as u64 != count {
        let reason = "it holds another number of pixels than it says".to_owned();
        return Err(ImageError::Damaged { kind: facts.kind, reason });
    }
    Ok(Pixels { width: facts.width, height: facts.height, rgba })
}

fn png_pixels(bytes: &[u8]) -> Result<Vec<[u8; 4]>, ImageError> {
    let damaged = |reason: String| ImageError::Damaged { kind: Kind::Png, reason };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(|error| damaged(error.to_string()))?;
    let size = reader.output_buffer_size().ok_or_else(|| damaged("it is too large".to_owned()))?;
    let mut decoded = vec![0; size];
    let info = reader.next_frame(&mut decoded).map_err(|error| damaged(error.to_string()))?;
    decoded.truncate(info.buffer_size());
    Ok(match info.color_type.samples() {
        2 => decoded.as_chunks().0.iter().map(|[grey, alpha]| [*grey, *grey, *grey, *alpha]).collect(),
        _ => decoded.as_chunks().0.to_vec(),
    })
}

fn check_size(width: u32, height: u32, limit: u64) -> Result<(), ImageError> {
    if u64::from(width) * u64::from(height) > limit {
        return Err(ImageError::TooLarge { width, height, limit });
    }
    Ok(())
}

fn read_png(bytes: &[u8], pixel_limit: u64) -> Result<ImageFacts, ImageError> {
    let damaged = |error: png::DecodingError| {
        let whole = error.to_string();
        // What follows names the chunk in the words of the decoder's own types.
        let reason = whole.split(" while decoding").next().unwrap_or(&whole).trim_end_matches('.').to_owned();
        ImageError::Damaged { kind: Kind::Png, reason }
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (header.width, header.height);
    check_size(width, height, pixel_limit)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let color = reader.info().color_type;
    let alpha = matches!(color, png::ColorType::Rgba | png::ColorType::GrayscaleAlpha)
        || reader.info().trns.is_some();
    if color == png::ColorType::Indexed && reader.info().palette.is_none() {
        let reason = "it has indexed colors but no palette".to_owned();
        return Err(ImageError::Damaged { kind: Kind::Png, reason });
    }
    while reader.next_interlaced_row().map_err(damaged)?.is_some() {}
    reader.finish().map_err(damaged)?;
    Ok(ImageFacts { kind: Kind::Png, width, height, alpha })
}

fn read_jpeg(bytes: &[u8], pixel_limit: u64) -> Result<ImageFacts, ImageError> {
    let damaged = |reason: String| ImageError::Damaged { kind: Kind::Jpeg, reason };
    let most = usize::from(u16::MAX);
    let options = DecoderOptions::default().set_max_width(most).set_max_height(most);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| damaged(error.to_string()))?;
    let info = decoder.info().ok_or_else(|| damaged("it has no header".to_owned()))?;
    let (width, height) = (u32::from(info.width), u32::from(info.height));
    check_size(width, height, pixel_limit)?;
    if width == 0 || height == 0 {
        return Err(damaged(format!("it is {width} x {height} pixels")));
    }
    if !matches!(info.components, 1 | 3) {
        return Err(ImageError::Components { components: info.components });
    }
    // Only after the last scan begins: a thumbnail in the metadata has an end marker of its own.
    let scan = bytes.windows(2).rposition(|pair| pair == b"\xff\xda").unwrap_or(0);
    if !bytes[scan..].windows(2).any(|pair| pair == b"\xff\xd9") {
        return Err(damaged("it is cut off: its end marker is missing".to_owned()));
    }
    Ok(ImageFacts { kind: Kind::Jpeg, width, height, alpha: false })
}

#[cfg(test)]
mod tests;

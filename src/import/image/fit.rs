//! Pictures made as small as is asked for.

use super::encode::{png, shorter};
use super::resize::{Edge, Meaning, resized, within};
use super::{ImageError, Pixels, pixels, read};

/// What is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wish {
    /// Pixels of the longer side, at most.
    pub most: Option<u32>,
    /// Whether the shortest of many PNG files is looked for.
    pub compress: bool,
}

/// Up to three pictures, the red of each as red, green and blue of one that is as wide and as high as any of them; full where
/// there is none.
#[must_use]
pub fn packed(channels: [Option<Pixels>; 3], edges: [Edge; 2]) -> Pixels {
    let side = |of: fn(&Pixels) -> u32| channels.iter().flatten().map(of).max().unwrap_or(1);
    let size @ [width, height] = [side(|own| own.width), side(|own| own.height)];
    let mut rgba = vec![[255; 4]; width as usize * height as usize];
    for (part, own) in channels.into_iter().enumerate() {
        let Some(own) = own else { continue };
        let alike = [own.width, own.height] == size;
        let own = if alike { own } else { resized(&own, size, Meaning::Data, edges) };
        rgba.iter_mut().zip(own.rgba).for_each(|(pixel, [red, ..])| pixel[part] = red);
    }
    Pixels { width, height, rgba }
}

/// A PNG file of a picture that is as small as is asked for; `None` where it is so already. What is made smaller is written
/// with 8 bits a part, also of a JPEG.
///
/// # Errors
/// See [`ImageError`].
pub fn fitted(
    bytes: &[u8],
    (meaning, edges): (Meaning, [Edge; 2]),
    wish: Wish,
    pixel_limit: u64,
) -> Result<Option<Vec<u8>>, ImageError> {
    let facts = read(bytes, pixel_limit)?;
    let smaller = wish.most.and_then(|most| within([facts.width, facts.height], most));
    match smaller {
        Some(size) => {
            let made = resized(&pixels(bytes, pixel_limit)?, size, meaning, edges);
            Ok(Some(png(&made, wish.compress)))
        }
        None if wish.compress => shorter(bytes, pixel_limit),
        None => Ok(None),
    }
}

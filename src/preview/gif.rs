//! Moving pictures as GIF, for places that show no better.
//!
//! Promise: one palette of up to 255 colors for all pictures, so that nothing flickers; what is less than half opaque is not
//! drawn. No promise: smooth shades; APNG keeps all colors.
//!
//! Source: P. Heckbert, Color Image Quantization for Frame Buffer Display, 1982, section 4.2 (median cut).
//!
//! Cost: linear in pixels, and a table of 32768 colors.

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::Picture;

/// Bits of each part of a color that are told apart, and how many colors that makes.
const BITS: u32 = 5;
const COLORS: usize = 1 << (3 * BITS);

/// Colors of the palette; the last of 256 is nothing.
const PALETTE: usize = 255;
const NOTHING: u8 = 255;

/// The file of pictures of one size, each shown so long, forever.
pub(super) fn gif(pictures: &[Picture], milliseconds: u16) -> Result<Vec<u8>, EncodingError> {
    let (width, height) = pictures.first().map_or((0, 0), |picture| (picture.width, picture.height));
    let short = |number: usize| u16::try_from(number).unwrap_or(u16::MAX);
    let (palette, nearest) = palette(pictures);
    let frame = |picture: &Picture| {
        let color = |pixel: &[u8; 4]| told(*pixel).map_or(NOTHING, |color| nearest[color]);
        let mut frame = Frame {
            delay: milliseconds / 10,
            // The picture goes before the next comes, for that may show less.
            dispose: DisposalMethod::Background,
            transparent: Some(NOTHING),
            width: short(picture.width),
            height: short(picture.height),
            buffer: picture.pixels.iter().map(color).collect(),
            ..Frame::default()
        };
        frame.make_lzw_pre_encoded();
        frame
    };
    let frames: Vec<Frame<'_>> = pictures.par_iter().map(frame).collect();
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, short(width), short(height), palette.as_flattened())?;
    encoder.set_repeat(Repeat::Infinite)?;
    for frame in &frames {
        encoder.write_lzw_pre_encoded_frame(frame)?;
    }
    drop(encoder);
    Ok(file)
}

/// Which of the told colors a pixel has; none where it is nothing.
fn told([r, g, b, opacity]: [u8; 4]) -> Option<usize> {
    let part = |part: u8| usize::from(part >> (8 - BITS));
    (opacity >= 128).then(|| part(r) << (2 * BITS) | part(g) << BITS | part(b))
}

/// Colors that pictures have, and how often.
#[derive(Clone, Copy, Default)]
struct Seen {
    count: u64,
    sum: [u64; 3],
}

/// Up to 255 colors, and for each of the told ones which of them stands for it.
fn palette(pictures: &[Picture]) -> ([[u8; 3]; 256], Vec<u8>) {
    let mut seen = vec![Seen::default(); COLORS];
    for pixel in pictures.iter().flat_map(|picture| &picture.pixels) {
        if let Some(color) = told(*pixel) {
            seen[color].count += 1;
            for (sum, part) in seen[color].sum.iter_mut().zip(pixel) {
                *sum += u64::from(*part);
            }
        }
    }
    let there: Vec<usize> = (0..COLORS).filter(|color| seen[*color].count > 0).collect();
    let mut boxes = if there.is_empty() { Vec::new() } else { vec![there] };
    while boxes.len() < PALETTE {
        // The one that spoils most: colors far apart, of many pixels.
        let cost = |own: &Vec<usize>| {
            let count: u64 = own.iter().map(|color| seen[*color].count).sum();
            let (_, span) = widest(own);
            count * (span * span) as u64
        };
        let Some(worst) = (0..boxes.len()).max_by_key(|number| (cost(&boxes[*number]), usize::MAX - number))
        else {
            break;
        };
        if cost(&boxes[worst]) == 0 {
            break;
        }
        let upper = halved(&mut boxes[worst], &seen);
        boxes.push(upper);
    }
    let mut palette = [[0; 3]; 256];
    let mut nearest = vec![0; COLORS];
    for (number, own) in boxes.iter().enumerate() {
        let count: u64 = own.iter().map(|color| seen[*color].count).sum();
        let sum = |k: usize| own.iter().map(|color| seen[*color].sum[k]).sum::<u64>();
        palette[number] = [0, 1, 2].map(|k| u8::try_from((sum(k) + count / 2) / count).unwrap_or(u8::MAX));
        for color in own {
            nearest[*color] = u8::try_from(number).unwrap_or(NOTHING);
        }
    }
    (palette, nearest)
}

/// A part of a told color: 0 is red.
fn part(color: usize, axis: u32) -> usize {
    color >> ((2 - axis) * BITS) & ((1 << BITS) - 1)
}

/// The part in which colors differ most, and by how much.
fn widest(colors: &[usize]) -> (u32, usize) {
    let span = |axis: u32| {
        let parts = || colors.iter().map(|color| part(*color, axis));
        parts().max().unwrap_or(0) - parts().min().unwrap_or(0)
    };
    // Green counts before red before blue, as eyes see.
    [1, 0, 2]
        .map(|axis| (axis, span(axis)))
        .into_iter()
        .fold((1, 0), |best, own| if own.1 > best.1 { own } else { best })
}

/// Leaves the lower half, by pixels, of colors sorted along the part in which they differ most; gives the upper.
fn halved(colors: &mut Vec<usize>, seen: &[Seen]) -> Vec<usize> {
    let (axis, _) = widest(colors);
    colors.sort_by_key(|color| (part(*color, axis), *color));
    let all: u64 = colors.iter().map(|color| seen[*color].count).sum();
    let mut below = 0;
    let mut cut = 0;
    while 2 * below < all {
        below += seen[colors[cut]].count;
        cut += 1;
    }
    // Colors that are equal in this part stay together, and no half is empty.
    let value = part(colors[cut - 1], axis);
    let (lowest, highest) = (part(colors[0], axis), part(colors[colors.len() - 1], axis));
    let border = if value == highest { value - 1 } else { value }.max(lowest);
    let cut = colors.partition_point(|color| part(*color, axis) <= border);
    colors.split_off(cut)
}

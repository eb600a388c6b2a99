//! The scale of a heat map, drawn beside the picture: a bar of its colors, with numbers, and what they mean.

use super::color;
use super::heat::ramp;
use super::picture::Picture;

/// Columns of the bar, in pixels where letters have scale 1.
const BAR: usize = 10;

/// Numbers beside the bar.
const TICKS: usize = 5;

/// Columns and rows of a letter, with the gap to the next.
const LETTER: (usize, usize) = (6, 8);

/// Ink: a dark gray that is read on light and on transparent ground.
const INK: [u8; 4] = [0x30, 0x34, 0x38, 0xff];

impl Picture {
    /// The picture with a scale to its right, on `ground`: from `low` to `high`, under a title. Where a number passes the
    /// scale, `greatest` says how far.
    #[must_use]
    pub fn with_legend(&self, title: &str, (low, high, greatest): (f64, f64, f64), ground: [u8; 4]) -> Self {
        let scale = (self.height / 256).clamp(1, 4);
        let mut names: Vec<String> =
            (0..TICKS).map(|k| number(low + (high - low) * k as f64 / (TICKS - 1) as f64)).collect();
        if greatest > high {
            names.push(format!("up to {}", number(greatest)));
        }
        let widest = names.iter().map(|name| name.len() + 2).max().unwrap_or(0).max(title.len());
        let width = scale * (2 * BAR + LETTER.0 * widest);
        let mut whole = Self {
            width: self.width + width,
            height: self.height,
            pixels: vec![ground; (self.width + width) * self.height],
        };
        for (row, line) in self.pixels.chunks(self.width).enumerate() {
            let start = row * whole.width;
            whole.pixels[start..start + self.width].copy_from_slice(line);
        }
        let left = self.width + scale * BAR / 2;
        let (top, bottom) = (3 * scale * LETTER.1, self.height.saturating_sub(3 * scale * LETTER.1));
        whole.text(title, (left, scale * LETTER.1), scale);
        if bottom <= top {
            return whole;
        }
        for row in top..bottom {
            let share = 1.0 - (row - top) as f64 / (bottom - top - 1).max(1) as f64;
            let [r, g, b] = ramp(share).to_array().map(color::srgb);
            for column in left..left + scale * BAR {
                whole.put((column, row), [r, g, b, 0xff]);
            }
        }
        for (k, name) in names.iter().enumerate() {
            let row = match k {
                TICKS => bottom + scale * LETTER.1,
                _ => bottom - k * (bottom - top) / (TICKS - 1),
            };
            let up = if k == TICKS { 0 } else { scale * LETTER.1 / 2 };
            whole.text(name, (left + scale * (BAR + 4), row.saturating_sub(up)), scale);
        }
        whole
    }

    fn put(&mut self, (column, row): (usize, usize), color: [u8; 4]) {
        if column < self.width && row < self.height {
            self.pixels[row * self.width + column] = color;
        }
    }

    /// Writes a text from its upper left corner.
    fn text(&mut self, text: &str, (left, top): (usize, usize), scale: usize) {
        for (place, sign) in text.chars().enumerate() {
            let rows = glyph(sign);
            for (row, bits) in rows.iter().enumerate() {
                for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                    for (x, y) in (0..scale * scale).map(|k| (k % scale, k / scale)) {
                        let across = left + scale * (place * LETTER.0 + column) + x;
                        self.put((across, top + scale * row + y), INK);
                    }
                }
            }
        }
    }
}

/// A number with three digits that count.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    // Zeros before the first digit that counts do not count.
    let decimals = [100.0, 10.0, 1.0, 0.1, 0.01].iter().filter(|least| size < **least).count();
    format!("{value:.decimals$}")
}

/// Rows of a letter from the top, five bits each; those that have no form are blank.
fn glyph(sign: char) -> [u8; 7] {
    match sign {
        '0' => [0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e],
        '1' => [0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e],
        '2' => [0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f],
        '3' => [0x0e, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0e],
        '4' => [0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02],
        '5' => [0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e],
        '6' => [0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e],
        '7' => [0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08],
        '8' => [0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e],
        '9' => [0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c],
        'a' => [0x00, 0x00, 0x0e, 0x01, 0x0f, 0x11, 0x0f],
        'b' => [0x10, 0x10, 0x1e, 0x11, 0x11, 0x11, 0x1e],
        'c' => [0x00, 0x00, 0x0e, 0x10, 0x10, 0x11, 0x0e],
        'd' => [0x01, 0x01, 0x0f, 0x11, 0x11, 0x11, 0x0f],
        'e' => [0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e],
        'f' => [0x06, 0x09, 0x08, 0x1c, 0x08, 0x08, 0x08],
        'g' => [0x00, 0x0f, 0x11, 0x11, 0x0f, 0x01, 0x0e],
        'h' => [0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x11],
        'i' => [0x04, 0x00, 0x0c, 0x04, 0x04, 0x04, 0x0e],
        'j' => [0x02, 0x00, 0x06, 0x02, 0x02, 0x12, 0x0c],
        'k' => [0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12],
        'l' => [0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e],
        'm' => [0x00, 0x00, 0x1a, 0x15, 0x15, 0x15, 0x15],
        'n' => [0x00, 0x00, 0x16, 0x19, 0x11, 0x11, 0x11],
        'o' => [0x00, 0x00, 0x0e, 0x11, 0x11, 0x11, 0x0e],
        'p' => [0x00, 0x00, 0x1e, 0x11, 0x1e, 0x10, 0x10],
        'q' => [0x00, 0x00, 0x0f, 0x11, 0x0f, 0x01, 0x01],
        'r' => [0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10],
        's' => [0x00, 0x00, 0x0e, 0x10, 0x0e, 0x01, 0x1e],
        't' => [0x08, 0x08, 0x1c, 0x08, 0x08, 0x09, 0x06],
        'u' => [0x00, 0x00, 0x11, 0x11, 0x11, 0x13, 0x0d],
        'v' => [0x00, 0x00, 0x11, 0x11, 0x11, 0x0a, 0x04],
        'w' => [0x00, 0x00, 0x11, 0x11, 0x15, 0x15, 0x0a],
        'x' => [0x00, 0x00, 0x11, 0x0a, 0x04, 0x0a, 0x11],
        'y' => [0x00, 0x00, 0x11, 0x11, 0x0f, 0x01, 0x0e],
        'z' => [0x00, 0x00, 0x1f, 0x02, 0x04, 0x08, 0x1f],
        '.' => [0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c],
        ',' => [0x00, 0x00, 0x00, 0x00, 0x0c, 0x04, 0x08],
        '-' => [0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00],
        '/' => [0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10],
        _ => [0; 7],
    }
}

//! Bytes to text.

use std::ops::Range;

/// Why bytes are not a text that can be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// The bytes begin as UTF-16 or UTF-32 does.
    #[error("this is {0} text; save it as UTF-8")]
    Encoding(&'static str),
    /// A byte that UTF-8 does not have here.
    #[error("byte {at} (0x{byte:02x}) is not UTF-8 text")]
    Invalid {
        /// Where it stands, from 0.
        at: usize,
        /// The byte.
        byte: u8,
    },
}

/// Marks of byte order: an encoding and how its text begins. The longer ones come first.
const MARKS: [(&[u8], &str); 4] = [
    (&[0xff, 0xfe, 0, 0], "UTF-32"),
    (&[0, 0, 0xfe, 0xff], "UTF-32"),
    (&[0xff, 0xfe], "UTF-16"),
    (&[0xfe, 0xff], "UTF-16"),
];

/// The text of a file: UTF-8, without the byte order mark that may stand before it.
///
/// # Errors
/// When the bytes are not UTF-8; says which encoding they look like.
pub fn decode(bytes: &[u8]) -> Result<&str, TextError> {
    if let Some((_, encoding)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        return Err(TextError::Encoding(encoding));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        if alternates_with_zero(bytes) {
            return TextError::Encoding("UTF-16");
        }
        let at = error.valid_up_to();
        TextError::Invalid { at, byte: bytes.get(at).copied().unwrap_or(0) }
    })
}

/// The readable text before the first byte that is not UTF-8, and the range of what cannot be read, for a
/// diagnostic that shows its line.
#[must_use]
pub fn readable(bytes: &[u8]) -> (String, Range<usize>) {
    let good = bytes.utf8_chunks().next().map_or("", |chunk| chunk.valid());
    (format!("{good}\u{fffd}"), good.len()..good.len() + '\u{fffd}'.len_utf8())
}

/// Whether half of the first bytes are zero, as they are in UTF-16 text of Latin letters.
fn alternates_with_zero(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(64)];
    let zeros = |first: usize| head.iter().skip(first).step_by(2).all(|byte| *byte == 0);
    head.len() >= 4 && (zeros(0) || zeros(1))
}

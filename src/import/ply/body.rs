//! The numbers of a PLY file.

use super::super::error::quoted;
use super::PlyFault;
use super::header::{Element, Format, Kind};

/// What is left of a file to read.
pub(super) struct Body<'b> {
    bytes: &'b [u8],
    format: Format,
    /// Numbers of the property in hand.
    values: Vec<f64>,
}

/// The greatest number by size, as in documents.
const GREATEST: f64 = 1e15;

impl<'b> Body<'b> {
    pub(super) fn new(bytes: &'b [u8], format: Format) -> Self {
        Self { bytes, format, values: Vec::new() }
    }

    /// That there is room for as many of an element as the header announces.
    pub(super) fn check(&self, element: &Element) -> Result<(), PlyFault> {
        let (count, left) = (element.count, self.bytes.len());
        let text = self.format == Format::Text;
        let needed = count.saturating_mul(element.least(self.format)).saturating_sub(u64::from(text));
        // Of what has no properties there is nothing to read, but it would be counted through.
        let many = element.properties.is_empty() && count > left as u64;
        if needed > left as u64 || many {
            return Err(PlyFault::Truncated { element: element.name.clone(), count, needed, left });
        }
        Ok(())
    }

    /// Reads one of an element; `take` is given the column of each property and its numbers.
    pub(super) fn row(
        &mut self,
        element: &Element,
        row: u64,
        mut take: impl FnMut(usize, &[f64]) -> Result<(), PlyFault>,
    ) -> Result<(), PlyFault> {
        for (column, property) in element.properties.iter().enumerate() {
            let mut values = std::mem::take(&mut self.values);
            values.clear();
            let at = (element, row, column);
            let items = match property.count {
                Some(kind) => self.number(kind, at)?,
                None => 1.0,
            };
            let items = if items >= 0.0 { crate::geometry::number::floor_large(items) } else { 0 };
            for _ in 0..items {
                values.push(self.number(property.kind, at)?);
            }
            take(column, &values)?;
            self.values = values;
        }
        Ok(())
    }

    fn number(&mut self, kind: Kind, at: (&Element, u64, usize)) -> Result<f64, PlyFault> {
        let (element, row, column) = at;
        let fault = |found: String| PlyFault::Number {
            element: element.name.clone(),
            row: row + 1,
            property: element.properties[column].name.clone(),
            found,
        };
        let number = if self.format == Format::Text {
            let word = self.word().ok_or_else(|| ends(element, row))?;
            let text = std::str::from_utf8(word).unwrap_or_default();
            text.parse().map_err(|_| fault(quoted(word)))?
        } else {
            let bytes = self.bytes.get(..kind.size()).ok_or_else(|| ends(element, row))?;
            self.bytes = &self.bytes[kind.size()..];
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            if self.format == Format::BigEndian {
                word[..bytes.len()].reverse();
            }
            number(kind, word)
        };
        // NaN compares with nothing.
        if number.abs() <= GREATEST { Ok(number) } else { Err(fault(number.to_string())) }
    }

    fn word(&mut self) -> Option<&'b [u8]> {
        let start = self.bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.bytes[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.bytes = &rest[end..];
        Some(&rest[..end])
    }
}

fn ends(element: &Element, row: u64) -> PlyFault {
    PlyFault::Ends { element: element.name.clone(), row: row + 1 }
}

/// A number of its first bytes, the lowest first.
fn number(kind: Kind, word: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = word;
    match kind {
        Kind::I8 => f64::from(a.cast_signed()),
        Kind::U8 => f64::from(a),
        Kind::I16 => f64::from(i16::from_le_bytes([a, b])),
        Kind::U16 => f64::from(u16::from_le_bytes([a, b])),
        Kind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Kind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Kind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Kind::F64 => f64::from_le_bytes(word),
    }
}

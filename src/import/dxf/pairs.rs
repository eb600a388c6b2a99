//! Pairs of codes and values, from texts and from binary files.

use super::{DxfFault, Place};
use crate::import::bytes::{f64_at, i16_at, i32_at};
use crate::import::error::quoted;

/// What a binary file begins with.
const SENTINEL: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// A code with its value.
#[derive(Clone, Debug)]
pub(super) struct Pair<'b> {
    pub(super) code: i32,
    value: Value<'b>,
    pub(super) place: Place,
}

#[derive(Clone, Debug)]
enum Value<'b> {
    Text(&'b [u8]),
    Number(f64),
}

impl Pair<'_> {
    /// The value as a text; numbers of binary files are none.
    pub(super) fn text(&self) -> String {
        match self.value {
            Value::Text(text) => quoted(text.trim_ascii()),
            Value::Number(number) => number.to_string(),
        }
    }

    pub(super) fn is(&self, code: i32, text: &str) -> bool {
        self.code == code && matches!(self.value, Value::Text(own) if own.trim_ascii() == text.as_bytes())
    }

    /// The value as a finite number.
    pub(super) fn number(&self) -> Result<f64, DxfFault> {
        let number = match self.value {
            Value::Number(number) => Some(number),
            Value::Text(text) => std::str::from_utf8(text).ok().and_then(|text| text.trim().parse().ok()),
        };
        number
            .filter(|number: &f64| number.is_finite() && number.abs() < 1e100)
            .ok_or_else(|| DxfFault::Number { place: self.place, code: self.code, found: self.text() })
    }

    /// The value as a whole number.
    pub(super) fn whole(&self) -> Result<i64, DxfFault> {
        let number = self.number()?;
        if number.fract() == 0.0 && number.abs() < 1e15 {
            let size = i64::try_from(crate::geometry::number::floor_large(number.abs())).unwrap_or(0);
            return Ok(if number < 0.0 { -size } else { size });
        }
        Err(DxfFault::Number { place: self.place, code: self.code, found: self.text() })
    }
}

/// The pairs of a file in their order.
pub(super) struct Pairs<'b> {
    bytes: &'b [u8],
    at: usize,
    line: u32,
    form: Form,
}

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    /// Codes of one byte, or of three where the first is 255.
    Short,
    /// Codes of two bytes.
    Long,
}

impl<'b> Pairs<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Result<Self, DxfFault> {
        if let Some(body) = bytes.strip_prefix(SENTINEL) {
            let form = match body {
                // The first code is 0, or that of a comment.
                [0, 0, ..] | [0xe7, 3, ..] => Form::Long,
                [0 | 255, ..] => Form::Short,
                _ => return Err(DxfFault::NotDxf),
            };
            return Ok(Self { bytes, at: SENTINEL.len(), line: 0, form });
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut pairs = Self { bytes, at: 0, line: 1, form: Form::Text };
        let first = pairs.next().map_err(|_| DxfFault::NotDxf)?.ok_or(DxfFault::NotDxf)?;
        if !first.is(0, "SECTION") && first.code != 999 {
            return Err(DxfFault::NotDxf);
        }
        Ok(Self { bytes, at: 0, line: 1, form: Form::Text })
    }

    /// Where the next pair begins.
    pub(super) fn place(&self) -> Place {
        if self.form == Form::Text { Place::Line(self.line) } else { Place::Byte(self.at) }
    }

    fn ends<T>(&self) -> Result<T, DxfFault> {
        Err(DxfFault::Ends { place: self.place(), what: "a pair" })
    }

    /// The next pair; none at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Pair<'b>>, DxfFault> {
        if self.form == Form::Text { self.next_text() } else { self.next_binary() }
    }

    fn text_line(&mut self) -> Option<&'b [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.at += end + 1;
        self.line = self.line.saturating_add(1);
        Some(rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]))
    }

    fn next_text(&mut self) -> Result<Option<Pair<'b>>, DxfFault> {
        let place = self.place();
        let Some(line) = self.text_line() else { return Ok(None) };
        if line.trim_ascii().is_empty() && self.at >= self.bytes.len() {
            return Ok(None);
        }
        let code = std::str::from_utf8(line).ok().and_then(|text| text.trim().parse().ok());
        let Some(code) = code else { return Err(DxfFault::Code { place, found: quoted(line) }) };
        let place = self.place();
        let Some(value) = self.text_line() else { return self.ends() };
        Ok(Some(Pair { code, value: Value::Text(value), place }))
    }

    fn next_binary(&mut self) -> Result<Option<Pair<'b>>, DxfFault> {
        if self.at >= self.bytes.len() {
            return Ok(None);
        }
        let place = self.place();
        let long = self.form == Form::Long || self.bytes[self.at] == 255;
        self.at += usize::from(long && self.form == Form::Short);
        let code = if long {
            i16_at(self.bytes, self.at).map(i32::from)
        } else {
            self.bytes.get(self.at).map(|byte| i32::from(*byte))
        };
        let Some(code) = code else { return self.ends() };
        self.at += if long { 2 } else { 1 };
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let number = |number: Option<f64>, size: usize| number.map(|number| (Value::Number(number), size));
        let found = match code {
            10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => number(f64_at(rest, 0), 8),
            60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => {
                number(i16_at(rest, 0).map(f64::from), 2)
            }
            90..=99 | 420..=429 | 440..=459 | 1071 => number(i32_at(rest, 0).map(f64::from), 4),
            160..=169 => (rest.len() >= 8).then_some((Value::Number(0.0), 8)),
            290..=299 => number(rest.first().map(|byte| f64::from(*byte)), 1),
            310..=319 | 1004 => {
                let size = rest.first().map(|size| usize::from(*size) + 1);
                size.filter(|size| *size <= rest.len()).map(|size| (Value::Text(b""), size))
            }
            _ => {
                let end = rest.iter().position(|byte| *byte == 0);
                end.map(|end| (Value::Text(&rest[..end]), end + 1))
            }
        };
        let Some((value, size)) = found else { return self.ends() };
        self.at += size;
        Ok(Some(Pair { code, value, place }))
    }
}

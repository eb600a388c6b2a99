//! The header of a PLY file.

use super::super::error::quoted;
use super::PlyFault;

/// How the numbers stand after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Text,
    LittleEndian,
    BigEndian,
}

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The kind of the number of items, where it is a list.
    pub(super) count: Option<Kind>,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// Paths of pictures (`comment TextureFile`, as MeshLab writes it).
    pub(super) pictures: Vec<String>,
}

/// The most properties of all elements together.
const MOST_PROPERTIES: usize = 4096;

impl Kind {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a number.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Element {
    /// The column of the first property that has one of some names.
    pub(super) fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }

    /// Bytes that one of it needs at least.
    pub(super) fn least(&self, format: Format) -> u64 {
        let of = |property: &Property| match format {
            // A digit and what parts it from the next.
            Format::Text => 2,
            _ => property.count.unwrap_or(property.kind).size() as u64,
        };
        self.properties.iter().map(of).sum()
    }
}

/// Reads the header; tells where it ends.
pub(super) fn read(bytes: &[u8]) -> Result<(Header, usize), PlyFault> {
    let mut lines = Lines { bytes, at: 0, line: 0 };
    let first = lines.next();
    if first != Some(&b"ply"[..]) {
        return Err(lines.fault("`ply`", first));
    }
    let (mut format, mut elements) = (None, Vec::<Element>::new());
    let (mut properties, mut pictures) = (0, Vec::new());
    loop {
        let line = lines.next();
        let text = line.and_then(|line| std::str::from_utf8(line).ok());
        let words: Vec<&str> = text.unwrap_or_default().split_ascii_whitespace().collect();
        match words.as_slice() {
            ["format", name, _] if format.is_none() => {
                format = match *name {
                    "ascii" => Some(Format::Text),
                    "binary_little_endian" => Some(Format::LittleEndian),
                    "binary_big_endian" => Some(Format::BigEndian),
                    _ => {
                        return Err(
                            lines.fault("`ascii`, `binary_little_endian` or `binary_big_endian`", line)
                        );
                    }
                };
            }
            ["comment", "TextureFile", ..] if pictures.len() < MOST_PROPERTIES => {
                let path = text.and_then(|text| text.split_once("TextureFile"));
                pictures.extend(path.map(|(_, path)| path.trim().to_owned()).filter(|path| !path.is_empty()));
            }
            ["comment" | "obj_info", ..] => {}
            [] if line.is_some() => {}
            ["element", name, count] => {
                let count = count.parse().map_err(|_| lines.fault("a number of elements", line))?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] if !elements.is_empty() && properties < MOST_PROPERTIES => {
                let property = property(rest)
                    .ok_or_else(|| lines.fault("a property with a known kind of number", line))?;
                properties += 1;
                if let Some(element) = elements.last_mut() {
                    element.properties.push(property);
                }
            }
            ["end_header"] => {
                let format = format.ok_or_else(|| lines.fault("a line that begins with `format`", line))?;
                return Ok((Header { format, elements, pictures }, lines.at));
            }
            _ => return Err(lines.fault("`format`, `comment`, `element`, `property` or `end_header`", line)),
        }
    }
}

fn property(words: &[&str]) -> Option<Property> {
    match words {
        ["list", count, kind, name] => {
            let count = Kind::named(count).filter(|kind| !matches!(kind, Kind::F32 | Kind::F64))?;
            Some(Property { name: (*name).to_owned(), count: Some(count), kind: Kind::named(kind)? })
        }
        [kind, name] => Some(Property { name: (*name).to_owned(), count: None, kind: Kind::named(kind)? }),
        _ => None,
    }
}

struct Lines<'b> {
    bytes: &'b [u8],
    at: usize,
    line: u32,
}

impl<'b> Lines<'b> {
    /// The next line without its end: a line feed, a carriage return, or both.
    fn next(&mut self) -> Option<&'b [u8]> {
        self.line += 1;
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
        let both = rest[end] == b'\r' && rest.get(end + 1) == Some(&b'\n');
        self.at += end + 1 + usize::from(both);
        Some(&rest[..end])
    }

    fn fault(&self, expected: &'static str, found: Option<&[u8]>) -> PlyFault {
        let found = found.map_or_else(|| "the end of the file".to_owned(), quoted);
        PlyFault::Header { line: self.line, expected, found }
    }
}

//! The text form of STL.

use glam::DVec3;

use super::Facet;
use crate::import::ImportError;
use crate::import::error::quoted;

/// What a text file holds.
#[derive(Debug, Default)]
pub(super) struct TextFile {
    pub(super) facets: Vec<Facet>,
    /// Names of all its solids, without repetition.
    pub(super) solids: Vec<String>,
}

/// Words with the lines they stand on.
struct Words<'a> {
    rest: &'a [u8],
    line: u32,
}

impl<'a> Words<'a> {
    /// The next word; empty at the end.
    fn next(&mut self) -> &'a [u8] {
        while let Some((&byte, rest)) = self.rest.split_first()
            && byte.is_ascii_whitespace()
        {
            self.line += u32::from(byte == b'\n');
            self.rest = rest;
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    /// What is left of the line.
    fn rest_of_line(&mut self) -> &'a [u8] {
        let end = self.rest.iter().position(|&byte| byte == b'\n').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest;
        line.trim_ascii()
    }

    /// The next words must be these, in any case.
    fn expect(&mut self, expected: &'static str) -> Result<(), ImportError> {
        for wanted in expected.split(' ') {
            let word = self.next();
            if !word.eq_ignore_ascii_case(wanted.as_bytes()) {
                return Err(self.unexpected(expected, word));
            }
        }
        Ok(())
    }

    fn unexpected(&self, expected: &'static str, found: &[u8]) -> ImportError {
        ImportError::Unexpected { line: self.line, expected, found: quoted(found) }
    }

    fn number(&mut self, what: &'static str) -> Result<f64, ImportError> {
        let word = self.next();
        if word.is_empty() {
            return Err(self.unexpected(what, word));
        }
        let parsed = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        parsed.ok_or_else(|| ImportError::BadNumber { line: self.line, what, text: quoted(word) })
    }

    fn corner(&mut self) -> Result<DVec3, ImportError> {
        let mut corner = DVec3::ZERO;
        for axis in 0..3 {
            let value = self.number("a coordinate of a vertex")?;
            if !value.is_finite() {
                return Err(ImportError::NotFinite { line: self.line, text: value.to_string() });
            }
            corner[axis] = value;
        }
        Ok(corner)
    }

    /// The rest of a facet, after `facet`. A normal may be anything that parses: it is only compared.
    fn facet(&mut self) -> Result<Facet, ImportError> {
        self.expect("normal")?;
        let mut normal = DVec3::ZERO;
        for axis in 0..3 {
            normal[axis] = self.number("a normal")?;
        }
        self.expect("outer loop")?;
        let mut corners = [DVec3::ZERO; 3];
        for corner in &mut corners {
            self.expect("vertex")?;
            *corner = self.corner()?;
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        Ok(Facet { normal, corners })
    }
}

/// Reads a text file, only solid `wanted` if that is given.
pub(super) fn read(bytes: &[u8], wanted: Option<&str>) -> Result<TextFile, ImportError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut words = Words { rest: bytes, line: 1 };
    let mut file = TextFile::default();
    let mut seen = std::collections::HashSet::new();
    loop {
        let word = words.next();
        if word.is_empty() {
            break;
        }
        if !word.eq_ignore_ascii_case(b"solid") {
            return Err(words.unexpected("solid", word));
        }
        let name = String::from_utf8_lossy(words.rest_of_line()).into_owned();
        read_solid(&mut words, &mut file, wanted.is_none_or(|wanted| wanted == name))?;
        if seen.insert(name.clone()) {
            file.solids.push(name);
        }
    }
    check_group(&file, wanted)?;
    Ok(file)
}

fn read_solid(words: &mut Words<'_>, file: &mut TextFile, keep: bool) -> Result<(), ImportError> {
    loop {
        let word = words.next();
        if word.eq_ignore_ascii_case(b"endsolid") {
            words.rest_of_line();
            return Ok(());
        }
        if !word.eq_ignore_ascii_case(b"facet") {
            return Err(words.unexpected("facet or endsolid", word));
        }
        let facet = words.facet()?;
        if keep {
            file.facets.push(facet);
        }
    }
}

fn check_group(file: &TextFile, wanted: Option<&str>) -> Result<(), ImportError> {
    if !file.facets.is_empty() {
        return Ok(());
    }
    match wanted {
        None => Err(ImportError::NoFaces { vertices: 0 }),
        Some(group) if file.solids.iter().any(|solid| solid == group) => {
            Err(ImportError::EmptyGroup { group: group.to_owned() })
        }
        Some(group) => Err(ImportError::UnknownGroup { group: group.to_owned(), known: file.solids.clone() }),
    }
}

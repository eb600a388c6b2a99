//! Spans and the files that they point into.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// A range of bytes in the text of one loaded file.
///
/// The numbers are global: every file of a [`SourceMap`] has a base offset of its own, so a span alone finds
/// its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// Points at nothing: a value that no text wrote, such as a default.
    pub const NONE: Self = Self { start: u32::MAX, end: u32::MAX };

    /// The bytes from `start` up to `end`.
    #[must_use]
    pub const fn new(start: u32, end: u32) -> Self {
        Self { start, end }
    }

    /// Whether it points at nothing.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The smallest span that holds both; the other one when one is [`Span::NONE`].
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        match (self.is_none(), other.is_none()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self { start: self.start.min(other.start), end: self.end.max(other.end) },
        }
    }
}

/// Names a file of a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(u32);

/// A place as people read it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location<'a> {
    /// Path as it was asked for, with `/` between its parts.
    pub file: &'a str,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// The texts of all files that a document is made of.
#[derive(Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

#[derive(Debug)]
struct SourceFile {
    path: String,
    text: String,
    base: u32,
    lines: Vec<u32>,
}

impl SourceMap {
    /// A map of no file.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a text under its path. `None` when all texts together would pass 4 GiB.
    ///
    /// Cost: one pass over the text.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<String>) -> Option<FileId> {
        let text = text.into();
        let base = self.files.last().map_or(0, |last| last.end() + 1);
        let length = u32::try_from(text.len()).ok()?;
        // One byte is left between files, so that the end of one is not the start of the next.
        base.checked_add(length)?.checked_add(2)?;
        let id = FileId(u32::try_from(self.files.len()).ok()?);
        let lines = line_starts(&text);
        self.files.push(SourceFile { path: path.into(), text, base, lines });
        Some(id)
    }

    /// The file that a span lies in; `None` for [`Span::NONE`] and spans of other maps.
    #[must_use]
    pub fn file_of(&self, span: Span) -> Option<FileId> {
        let after = self.files.partition_point(|file| file.base <= span.start);
        let file = self.files.get(after.checked_sub(1)?)?;
        let id = FileId(u32::try_from(after - 1).ok()?);
        (span.start <= file.end()).then_some(id)
    }

    /// The path that a file was added under.
    #[must_use]
    pub fn path(&self, id: FileId) -> &str {
        &self.files[id.0 as usize].path
    }

    /// The text of a file.
    #[must_use]
    pub fn text(&self, id: FileId) -> &str {
        &self.files[id.0 as usize].text
    }

    /// The global span of a range of bytes within a file, clamped to its text.
    #[must_use]
    pub fn span(&self, id: FileId, range: Range<usize>) -> Span {
        let file = &self.files[id.0 as usize];
        let clamp = |at: usize| u32::try_from(at).unwrap_or(u32::MAX).min(file.length());
        let start = clamp(range.start);
        Span { start: file.base + start, end: file.base + clamp(range.end).max(start) }
    }

    /// The bytes of a span within its file, clamped to whole characters; `None` when it points at nothing.
    #[must_use]
    pub fn range(&self, span: Span) -> Option<(FileId, Range<usize>)> {
        let id = self.file_of(span)?;
        let file = &self.files[id.0 as usize];
        let start = floor_character(&file.text, (span.start - file.base) as usize);
        let end = span.end.saturating_sub(file.base).min(file.length()) as usize;
        Some((id, start..ceil_character(&file.text, end.max(start))))
    }

    /// The text under a span; empty when it points at nothing.
    #[must_use]
    pub fn snippet(&self, span: Span) -> &str {
        self.range(span).map_or("", |(id, range)| &self.text(id)[range])
    }

    /// Line and column of the first byte of a span.
    #[must_use]
    pub fn locate(&self, span: Span) -> Option<Location<'_>> {
        let (id, range) = self.range(span)?;
        let file = &self.files[id.0 as usize];
        let line = file.lines.partition_point(|start| *start as usize <= range.start);
        let line_start = file.lines[line - 1] as usize;
        let column = file.text[line_start..range.start].chars().count() + 1;
        Some(Location { file: &file.path, line, column })
    }

    /// All files, in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = FileId> + '_ {
        (0u32..).zip(&self.files).map(|(index, _)| FileId(index))
    }
}

impl SourceFile {
    fn length(&self) -> u32 {
        u32::try_from(self.text.len()).unwrap_or(u32::MAX)
    }

    fn end(&self) -> u32 {
        self.base + self.length()
    }
}

fn line_starts(text: &str) -> Vec<u32> {
    let newlines = text.bytes().zip(1u32..).filter(|(byte, _)| *byte == b'\n');
    std::iter::once(0).chain(newlines.map(|(_, after)| after)).collect()
}

fn floor_character(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn ceil_character(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::{SourceMap, Span};

    #[test]
    fn a_span_alone_finds_file_line_and_column() {
        let mut map = SourceMap::new();
        let first = map.add("a.toml", "one\ntwö = 1\n").unwrap();
        let second = map.add("b.toml", "three").unwrap();
        let span = map.span(first, 9..10);
        let place = map.locate(span).unwrap();
        assert_eq!((place.file, place.line, place.column), ("a.toml", 2, 5));
        assert_eq!(map.snippet(span), "=");
        let end = map.span(first, 13..99);
        assert_eq!(map.file_of(end), Some(first));
        assert_eq!(map.locate(end).unwrap().line, 3);
        assert_eq!(map.file_of(map.span(second, 0..1)), Some(second));
    }

    #[test]
    fn spans_out_of_bounds_are_clamped() {
        let mut map = SourceMap::new();
        let id = map.add("a", "ä").unwrap();
        assert_eq!(map.range(Span::new(1, 900)), Some((id, 0..2)));
        assert_eq!(map.locate(Span::NONE), None);
        assert_eq!(map.snippet(Span::NONE), "");
        assert_eq!(map.file_of(Span::new(3, 4)), None);
    }
}

//! What stands where in a document that is being written: names of tables, keys and values, each with the tables around it.
//!
//! Tokens alone are looked at, so that a document is understood while a line of it is still wrong: what was not closed ends
//! at the next header.

use std::ops::Range;
use std::rc::Rc;

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// A step from a table to what is in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Key(String),
    /// An item of an array.
    Item,
}

/// Steps from the document down.
pub(super) type Path = Rc<[Step]>;

/// What may stand at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name in a header.
    Header,
    /// A key.
    Key,
    /// A value.
    Value,
}

/// A name, key, or value that is a word.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) kind: Kind,
    /// Of a header or key: the tables that it stands in. Of a value: its own path.
    pub(super) path: Path,
    /// Without quotation marks.
    pub(super) text: String,
    /// Bytes of the document, quotation marks included.
    pub(super) range: Range<usize>,
    pub(super) quoted: bool,
}

impl Part {
    /// The path of a header's table or of a key's value.
    pub(super) fn own_path(&self) -> Path {
        match self.kind {
            Kind::Value => Rc::clone(&self.path),
            Kind::Header | Kind::Key => joined(&self.path, Step::Key(self.text.clone())),
        }
    }

    /// The bytes between the quotation marks.
    pub(super) fn inner(&self) -> Range<usize> {
        let mark = usize::from(self.quoted);
        self.range.start + mark..(self.range.end - mark).max(self.range.start + mark)
    }
}

/// All parts of a document.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// In the order of the text.
    pub(super) parts: Vec<Part>,
    /// From which byte on what may stand, and in which tables.
    gaps: Vec<(usize, Kind, Path)>,
}

impl Scan {
    /// The part that a place touches.
    pub(super) fn part(&self, offset: usize) -> Option<&Part> {
        let after = self.parts.partition_point(|part| part.range.start <= offset);
        self.parts[..after].last().filter(|part| offset <= part.range.end)
    }

    /// What may be written at a place, and the tables around it; of a value its own path.
    pub(super) fn around(&self, offset: usize) -> (Kind, Path) {
        if let Some(part) = self.part(offset) {
            return (part.kind, Rc::clone(&part.path));
        }
        let after = self.gaps.partition_point(|(from, ..)| *from <= offset);
        let gap = after.checked_sub(1).and_then(|last| self.gaps.get(last));
        gap.map_or((Kind::Key, Rc::from([])), |(_, kind, path)| (*kind, Rc::clone(path)))
    }
}

fn joined(path: &[Step], step: Step) -> Path {
    path.iter().cloned().chain(std::iter::once(step)).collect()
}

/// Looks at a document.
pub(super) fn scan(text: &str) -> Scan {
    let mut scanner = Scanner {
        text,
        scan: Scan::default(),
        header: Rc::from([]),
        open: Vec::new(),
        key: Vec::new(),
        mode: Mode::Key,
    };
    for token in Source::new(text).lex() {
        let span = token.span();
        scanner.token(token.kind(), span.start()..span.end());
    }
    scanner.scan
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Inside the brackets of a header.
    Header,
    Key,
    Value,
    /// After a value.
    After,
}

struct Scanner<'t> {
    text: &'t str,
    scan: Scan,
    /// The table of the last header.
    header: Path,
    /// Open inline tables (true) and arrays, each with its path.
    open: Vec<(bool, Path)>,
    /// The dotted key before `=`.
    key: Vec<String>,
    mode: Mode,
}

impl Scanner<'_> {
    /// The table that keys belong to.
    fn table(&self) -> Path {
        self.open.last().map_or_else(|| Rc::clone(&self.header), |(_, path)| Rc::clone(path))
    }

    /// The path of what the dotted key names so far.
    fn keyed(&self) -> Path {
        let keys = self.key.iter().cloned().map(Step::Key);
        self.table().iter().cloned().chain(keys).collect()
    }

    fn value(&self) -> Path {
        match self.open.last() {
            Some((false, path)) => joined(path, Step::Item),
            _ => self.keyed(),
        }
    }

    /// What may stand here, and in which tables.
    fn here(&self) -> (Kind, Path) {
        match self.mode {
            Mode::Header => (Kind::Header, Rc::clone(&self.header)),
            Mode::Key => (Kind::Key, self.keyed()),
            Mode::Value | Mode::After => (Kind::Value, self.value()),
        }
    }

    fn gap(&mut self, at: usize) {
        let (kind, path) = self.here();
        if self.scan.gaps.last().is_none_or(|(_, known, same)| *known != kind || **same != *path) {
            self.scan.gaps.push((at, kind, path));
        }
    }

    fn token(&mut self, kind: TokenKind, range: Range<usize>) {
        match kind {
            TokenKind::Whitespace | TokenKind::Comment | TokenKind::Eof => return,
            TokenKind::Newline => self.line_end(range.end),
            TokenKind::LeftSquareBracket if self.mode == Mode::Header => {}
            TokenKind::LeftSquareBracket
                if self.mode == Mode::Key && self.open.is_empty() && self.key.is_empty() =>
            {
                self.mode = Mode::Header;
                self.header = Rc::from([]);
            }
            TokenKind::RightSquareBracket if self.mode == Mode::Header => {
                if self.text[range.end..].starts_with(']') {
                    self.header = joined(&self.header, Step::Item);
                }
                self.mode = Mode::After;
            }
            TokenKind::Dot => {}
            TokenKind::Equals => self.mode = Mode::Value,
            TokenKind::LeftCurlyBracket => {
                self.open.push((true, self.value()));
                (self.mode, self.key) = (Mode::Key, Vec::new());
            }
            TokenKind::LeftSquareBracket => {
                self.open.push((false, self.value()));
                self.mode = Mode::Value;
            }
            TokenKind::RightCurlyBracket | TokenKind::RightSquareBracket => {
                self.open.pop();
                (self.mode, self.key) = (Mode::After, Vec::new());
            }
            TokenKind::Comma => {
                self.key.clear();
                self.mode = if matches!(self.open.last(), Some((true, _))) { Mode::Key } else { Mode::Value };
            }
            TokenKind::Atom
            | TokenKind::BasicString
            | TokenKind::LiteralString
            | TokenKind::MlBasicString
            | TokenKind::MlLiteralString => self.word(kind, range.clone()),
        }
        self.gap(range.end);
    }

    fn line_end(&mut self, at: usize) {
        // A header ends whatever was left open before it.
        let rest = self.text[at..].trim_start_matches('[');
        let starts = rest.len() < self.text.len() - at && rest.starts_with(|c: char| c.is_ascii_lowercase());
        if starts
            && rest.lines().next().is_some_and(|line| line.contains(']') && !line.contains(['=', '"', ',']))
        {
            self.open.clear();
        }
        if self.open.is_empty() {
            (self.mode, self.key) = (Mode::Key, Vec::new());
        }
    }

    fn word(&mut self, kind: TokenKind, range: Range<usize>) {
        let quoted = matches!(kind, TokenKind::BasicString | TokenKind::LiteralString);
        let written = &self.text[range.clone()];
        let text = if quoted { written.trim_matches(['"', '\'']) } else { written };
        let (kind, path) = self.here();
        match self.mode {
            Mode::Header => self.header = joined(&self.header, Step::Key(text.to_owned())),
            Mode::Key => self.key.push(text.to_owned()),
            Mode::Value | Mode::After => self.mode = Mode::After,
        }
        // Numbers are many, and nothing is said of them.
        if kind != Kind::Value || quoted || text.starts_with(|c: char| c.is_ascii_alphabetic()) {
            self.scan.parts.push(Part { kind, path, text: text.to_owned(), range, quoted });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Kind, Step, scan};

    fn path(text: &str, mark: &str) -> (Kind, String) {
        let at = text.find(mark).expect("the mark");
        let (kind, path) = scan(&text.replace(mark, "")).around(at);
        let steps = path.iter().map(|step| match step {
            Step::Key(key) => key.as_str(),
            Step::Item => "*",
        });
        (kind, steps.collect::<Vec<_>>().join("."))
    }

    #[test]
    fn places_know_their_tables() {
        let cases = [
            ("[shape.|", Kind::Header, "shape"),
            ("[|", Kind::Header, ""),
            ("[[shape.a.split.|part]]", Kind::Header, "shape.a.split"),
            ("[shape.a.box]\n|\n[shape.b.sphere]\nradius = 1", Kind::Key, "shape.a.box"),
            ("[shape.a.box]\nsi|ze = 2", Kind::Key, "shape.a.box"),
            ("[shape.a.box]\nsize = |", Kind::Value, "shape.a.box.size"),
            ("[[shape.a.split.part]]\n|", Kind::Key, "shape.a.split.part.*"),
            ("[shape.a.sweep]\nprofile = { | }", Kind::Key, "shape.a.sweep.profile"),
            (
                "[shape.a.sweep]\nprofile = { circle = { radius = 1, | } }",
                Kind::Key,
                "shape.a.sweep.profile.circle",
            ),
            ("[shape.a.sweep]\nprofile = { circle = { radius = 1 }, | }", Kind::Key, "shape.a.sweep.profile"),
            ("holes = [\n  { | }\n]", Kind::Key, "holes.*"),
            ("holes = [\"a\", \"|\"]", Kind::Value, "holes.*"),
            ("points = [[1, 2], [3, |4]]\n", Kind::Value, "points.*.*"),
            // What was left open ends at the next header.
            ("[shape.a.sweep]\nprofile = { circle = {\n[shape.b]\n|", Kind::Key, "shape.b"),
            ("points = [[1, 2],\n[shape.b]\nmaterial = \"|\"", Kind::Value, "shape.b.material"),
        ];
        for (text, kind, expected) in cases {
            assert_eq!(path(text, "|"), (kind, expected.to_owned()), "{text}");
        }
    }

    #[test]
    fn parts_are_words_with_ranges() {
        let text = "[curve.rim.circle]\nradius = 2 # r\n[shape.a]\nmaterial = \"gold\"";
        let scan = scan(text);
        let found: Vec<(&str, &str)> =
            scan.parts.iter().map(|part| (part.text.as_str(), &text[part.range.clone()])).collect();
        let expected = [
            ("curve", "curve"),
            ("rim", "rim"),
            ("circle", "circle"),
            ("radius", "radius"),
            ("shape", "shape"),
            ("a", "a"),
            ("material", "material"),
            ("gold", "\"gold\""),
        ];
        assert_eq!(found, expected);
        assert_eq!(&text[scan.parts[7].inner()], "gold");
    }
}

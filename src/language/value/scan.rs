//! What is checked on the raw text before it is parsed: nesting, and TOML 1.1 forms that 1.0 does not have.
//!
//! The parser recurses and reads TOML 1.1. This scanner does neither: one pass, a stack of brackets.

use std::ops::Range;

/// How deep arrays and inline tables may be nested. Below the parser's own limit of 80.
pub(crate) const DEEPEST: usize = 64;

/// Something in the raw text that is refused.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Finding {
    /// Brackets are nested deeper than [`DEEPEST`]; the text is not to be parsed.
    TooDeep(usize),
    /// Something that only later versions of TOML allow.
    Newer(Range<usize>, &'static str),
    /// A bracket that is never closed: what the parser says of the text after it is guesswork.
    Unclosed(usize),
}

/// Looks through a text. At most one [`Finding::TooDeep`], which ends the search.
pub(crate) fn scan(text: &str) -> Vec<Finding> {
    let mut scanner =
        Scanner { bytes: text.as_bytes(), at: 0, open: Vec::new(), comma: None, found: Vec::new() };
    while scanner.at < scanner.bytes.len() {
        if !scanner.step() {
            return scanner.found;
        }
    }
    if let Some((_, at)) = scanner.open.first() {
        scanner.found.push(Finding::Unclosed(*at));
    }
    scanner.found
}

struct Scanner<'t> {
    bytes: &'t [u8],
    at: usize,
    /// The open brackets and their places.
    open: Vec<(u8, usize)>,
    comma: Option<usize>,
    found: Vec<Finding>,
}

impl Scanner<'_> {
    /// Takes one token; `false` ends the search.
    fn step(&mut self) -> bool {
        let byte = self.bytes[self.at];
        let significant = !matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'#' | b'}');
        if significant {
            self.comma = None;
        }
        match byte {
            b'"' | b'\'' => self.string(byte),
            b'#' => self.comment(),
            b'[' | b'{' => return self.enter(byte),
            b']' | b'}' => self.leave(byte),
            b',' => self.take_comma(),
            b'\n' => self.newline(),
            _ => self.at += 1,
        }
        true
    }

    fn enter(&mut self, bracket: u8) -> bool {
        self.open.push((bracket, self.at));
        if self.open.len() > DEEPEST {
            self.found.push(Finding::TooDeep(self.at));
            return false;
        }
        self.at += 1;
        true
    }

    fn leave(&mut self, bracket: u8) {
        if let (b'}', Some(comma)) = (bracket, self.comma) {
            self.newer(comma..comma + 1, "an inline table has no comma after its last entry");
        }
        self.comma = None;
        self.open.pop();
        self.at += 1;
    }

    fn take_comma(&mut self) {
        if self.inline_table() {
            self.comma = Some(self.at);
        }
        self.at += 1;
    }

    fn newline(&mut self) {
        if self.inline_table() {
            self.newer(self.at..self.at + 1, "an inline table stands on one line");
            // One report for each table is enough.
            if let Some((bracket, _)) = self.open.last_mut() {
                *bracket = b'[';
            }
        }
        self.at += 1;
    }

    fn comment(&mut self) {
        while self.at < self.bytes.len() && self.bytes[self.at] != b'\n' {
            self.at += 1;
        }
    }

    fn inline_table(&self) -> bool {
        self.open.last().is_some_and(|(bracket, _)| *bracket == b'{')
    }

    fn string(&mut self, quote: u8) {
        let start = self.at;
        let long = self.bytes[start..].starts_with(&[quote; 3]);
        self.at += if long { 3 } else { 1 };
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'\\' && quote == b'"' {
                self.escape();
            } else if byte == b'\n' && !long {
                return;
            } else if byte == quote && (!long || self.bytes[self.at..].starts_with(&[quote; 3])) {
                return self.end_string(quote, long);
            } else {
                self.at += 1;
            }
        }
    }

    /// Steps over the closing quotes; a long string may end with up to two more of its own.
    fn end_string(&mut self, quote: u8, long: bool) {
        self.at += if long { 3 } else { 1 };
        let more = self.bytes[self.at..].iter().take(2).take_while(|byte| **byte == quote).count();
        if long {
            self.at += more;
        }
    }

    fn escape(&mut self) {
        if let Some(b'e' | b'x') = self.bytes.get(self.at + 1) {
            self.newer(self.at..self.at + 2, "TOML 1.0 has no such escape; write \\u and four digits");
        }
        // A line end after a backslash is left to the loop, which knows whether the string goes on.
        self.at += if self.bytes.get(self.at + 1) == Some(&b'\n') { 1 } else { 2 };
    }

    fn newer(&mut self, range: Range<usize>, message: &'static str) {
        self.found.push(Finding::Newer(range, message));
    }
}

#[cfg(test)]
mod tests {
    use super::{DEEPEST, Finding, scan};

    #[test]
    fn depth_is_counted_outside_of_strings_and_comments() {
        assert_eq!(scan("a = [1, [2]\n[b]\nc = 3"), [Finding::Unclosed(4)]);
        let deep = format!("a = {}", "[".repeat(100_000));
        assert_eq!(scan(&deep), [Finding::TooDeep(4 + DEEPEST)]);
        let quoted = format!("a = '{0}' # {0}\nb = \"\\\"{0}\"\nc = '''{0}\n{0}'''", "[{".repeat(99));
        assert_eq!(scan(&quoted), []);
    }

    #[test]
    fn forms_of_later_versions_are_found() {
        let newer = |text: &str| match scan(text).as_slice() {
            [Finding::Newer(range, _)] => Some(range.clone()),
            _ => None,
        };
        assert_eq!(newer("a = { b = 1, }"), Some(11..12));
        assert_eq!(newer("a = { b = 1,\n c = 2 }"), Some(12..13));
        assert_eq!(newer("a = \"\\x41\""), Some(5..7));
        assert_eq!(newer("a = [1, 2,\n]\nb = { c = [\n1\n] }"), None);
        assert_eq!(newer("a = '\\x41'"), None);
    }
}

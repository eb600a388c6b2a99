//! Words of a text, one after the other, with their lines.

use super::Md5Fault;
use crate::import::error::quoted;

pub(super) struct Tokens<'t> {
    text: &'t str,
    at: usize,
    /// The line that is read.
    here: u32,
    /// The line of the last word.
    line: u32,
}

impl<'t> Tokens<'t> {
    pub(super) fn new(bytes: &'t [u8]) -> Result<Self, Md5Fault> {
        let text = std::str::from_utf8(bytes).map_err(|_| Md5Fault::NotText)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.contains('\0') {
            return Err(Md5Fault::NotText);
        }
        Ok(Self { text, at: 0, here: 1, line: 1 })
    }

    /// The line of the last word.
    pub(super) fn line(&self) -> u32 {
        self.line
    }

    /// Where the next word begins; the end of the text where there is none.
    fn skip(&mut self) {
        let bytes = self.text.as_bytes();
        while let Some(&byte) = bytes.get(self.at) {
            if bytes[self.at..].starts_with(b"//") {
                self.at += bytes[self.at..].iter().take_while(|byte| **byte != b'\n').count();
            } else if byte.is_ascii_whitespace() {
                self.here = self.here.saturating_add(u32::from(byte == b'\n'));
                self.at += 1;
            } else {
                break;
            }
        }
    }

    fn next(&mut self, expected: &'static str) -> Result<&'t str, Md5Fault> {
        self.skip();
        self.line = self.here;
        let rest = &self.text[self.at..];
        let length = match rest.bytes().next() {
            None => return Err(Md5Fault::Ends { line: self.here, expected }),
            Some(b'"') => match rest[1..].find(['"', '\n']).filter(|end| rest.as_bytes()[end + 1] == b'"') {
                Some(end) => end + 2,
                None => {
                    return Err(Md5Fault::Expected { line: self.here, expected, found: "\"".to_owned() });
                }
            },
            Some(b'(' | b')' | b'{' | b'}') => 1,
            Some(_) => {
                let ends = |c: char| c.is_ascii_whitespace() || matches!(c, '"' | '(' | ')' | '{' | '}');
                let end = rest.find(ends).unwrap_or(rest.len());
                rest[..end].find("//").unwrap_or(end)
            }
        };
        self.at += length;
        Ok(&rest[..length])
    }

    fn expected<T>(&self, expected: &'static str, found: &str) -> Result<T, Md5Fault> {
        Err(Md5Fault::Expected { line: self.line, expected, found: quoted(found.as_bytes()) })
    }

    /// Whether a word is next.
    pub(super) fn is_next(&mut self, word: &str) -> bool {
        let (at, here, line) = (self.at, self.here, self.line);
        let found = self.next("").is_ok_and(|next| next == word);
        (self.at, self.here, self.line) = (at, here, line);
        found
    }

    /// Whether nothing is left.
    pub(super) fn is_done(&mut self) -> bool {
        self.skip();
        self.at == self.text.len()
    }

    /// A word that must stand there.
    pub(super) fn word(&mut self, word: &str, expected: &'static str) -> Result<(), Md5Fault> {
        let found = self.next(expected)?;
        if found == word { Ok(()) } else { self.expected(expected, found) }
    }

    /// A quoted name, without its quotes.
    pub(super) fn name(&mut self, expected: &'static str) -> Result<String, Md5Fault> {
        let found = self.next(expected)?;
        let name = found.strip_prefix('"').and_then(|found| found.strip_suffix('"'));
        name.map_or_else(|| self.expected(expected, found), |name| Ok(name.to_owned()))
    }

    fn parsed<T: std::str::FromStr>(
        &mut self,
        what: &'static str,
        good: impl Fn(&T) -> bool,
    ) -> Result<T, Md5Fault> {
        let found = self.next(what)?;
        let number = found.parse().ok().filter(good);
        number.ok_or_else(|| Md5Fault::Number { line: self.line, what, found: quoted(found.as_bytes()) })
    }

    /// A whole number that is not negative.
    pub(super) fn count(&mut self, what: &'static str) -> Result<u32, Md5Fault> {
        self.parsed(what, |_| true)
    }

    /// A whole number.
    pub(super) fn whole(&mut self, what: &'static str) -> Result<i64, Md5Fault> {
        self.parsed(what, |_| true)
    }

    /// A finite number.
    pub(super) fn number(&mut self, what: &'static str) -> Result<f64, Md5Fault> {
        self.parsed(what, |number: &f64| number.is_finite() && number.abs() < 1e30)
    }

    /// Numbers in parentheses.
    pub(super) fn numbers<const N: usize>(&mut self, what: &'static str) -> Result<[f64; N], Md5Fault> {
        self.word("(", "`(`")?;
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number(what)?;
        }
        self.word(")", "`)`")?;
        Ok(numbers)
    }

    /// The number of a row, which must be the next.
    pub(super) fn ordered(&mut self, what: &'static str, expected: usize) -> Result<(), Md5Fault> {
        let found = self.count(what)?;
        if found as usize == expected {
            return Ok(());
        }
        Err(Md5Fault::Order { line: self.line, what, found, expected })
    }

    /// Holds how many there are against how many were announced.
    pub(super) fn counted(&self, what: &'static str, announced: u32, found: usize) -> Result<(), Md5Fault> {
        if announced as usize == found {
            return Ok(());
        }
        Err(Md5Fault::Count { line: self.line, what, announced, found })
    }

    /// A number of something.
    pub(super) fn index(&mut self, what: &'static str, count: usize) -> Result<usize, Md5Fault> {
        let index = self.count(what)?;
        if (index as usize) < count {
            return Ok(index as usize);
        }
        Err(Md5Fault::Index { line: self.line, what, index, count })
    }
}

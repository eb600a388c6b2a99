//! Documents as they are written by hand at their best: one way to set spaces, indents and commas.
//!
//! Promise: only spaces, line ends and commas after the last item of an array change, so the text means what it meant and
//! keeps its comments, its order, and the way numbers and strings are written; formatting twice is formatting once.
//! One space stands around `=` and after a comma; what stands inside brackets on lines of its own is indented by two from
//! the line that opens them, and the line that closes them is not; arrays over several lines end in a comma, others in
//! none; a comment after code stays in its column where there is room; of several empty lines one is left.
//! No promise: lines are neither broken nor joined. Text that is not TOML comes back as some other text that is not.
//!
//! Cost: linear in the text.

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// What a line inside brackets is indented by, from the line that opens them.
const INDENT: usize = 2;

/// Formats a document.
#[must_use]
pub fn format(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(text);
    let mut lines = vec![Vec::new()];
    // The column of the next token, in characters.
    let mut column = 0;
    for token in source.lex() {
        let span = token.span();
        let written = &text[span.start()..span.end()];
        match token.kind() {
            TokenKind::Newline => {
                lines.push(Vec::new());
                column = 0;
                continue;
            }
            TokenKind::Whitespace | TokenKind::Eof => {}
            kind => lines.last_mut().expect("there is one").push(Word { kind, text: written, column }),
        }
        column = match written.rsplit_once('\n') {
            Some((_, last)) => last.chars().count(),
            None => column + written.chars().count(),
        };
    }
    set_commas(&mut lines);
    write(&lines)
}

/// A token that is kept.
#[derive(Clone, Copy)]
struct Word<'t> {
    kind: TokenKind,
    text: &'t str,
    column: usize,
}

/// Puts a comma after the last item of an array where a line ends there, and takes it away elsewhere.
fn set_commas(lines: &mut [Vec<Word<'_>>]) {
    // The word before that is no comment: its line and place.
    let mut before: Option<(usize, usize)> = None;
    let mut open = Vec::new();
    for line in 0..lines.len() {
        let mut place = 0;
        while place < lines[line].len() {
            let word = lines[line][place];
            let last = before.map(|(line, place)| lines[line][place].kind);
            match word.kind {
                TokenKind::Comment => {
                    place += 1;
                    continue;
                }
                TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => open.push(word.kind),
                TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                    let array = open.pop() == Some(TokenKind::LeftSquareBracket);
                    let (at, after) = before.unwrap_or((line, 0));
                    match last {
                        Some(TokenKind::Comma) if at == line => {
                            lines[line].remove(after);
                            place -= 1;
                        }
                        Some(TokenKind::Comma | TokenKind::LeftSquareBracket) | None => {}
                        Some(_) if at < line && array => {
                            let column = lines[at][after].column;
                            let comma = Word { kind: TokenKind::Comma, text: ",", column };
                            lines[at].insert(after + 1, comma);
                        }
                        Some(_) => {}
                    }
                }
                _ => {}
            }
            before = Some((line, place));
            place += 1;
        }
    }
}

fn write(lines: &[Vec<Word<'_>>]) -> String {
    let mut text = String::new();
    // For each open bracket the indent of its line.
    let mut open: Vec<usize> = Vec::new();
    let mut empty = 0;
    for line in lines {
        if line.is_empty() {
            empty += 1;
            continue;
        }
        if empty > 0 && !text.is_empty() {
            text.push('\n');
        }
        empty = 0;
        let header = open.is_empty() && line[0].kind == TokenKind::LeftSquareBracket;
        let closing = line.iter().take_while(|word| closes(word.kind)).count();
        let indent = match closing {
            0 => open.last().map_or(0, |outer| outer + INDENT),
            // Where the line of the bracket begins that the last of them closes.
            _ => open.get(open.len().saturating_sub(closing)).copied().unwrap_or(0),
        };
        let start = text.len();
        text.extend(std::iter::repeat_n(' ', indent));
        for (place, word) in line.iter().enumerate() {
            if place > 0 {
                let gap = gap(&line[place - 1], word, header);
                let own = text[start..].rsplit('\n').next().unwrap_or_default().chars().count();
                let gap = if word.kind == TokenKind::Comment {
                    word.column.saturating_sub(own).max(1)
                } else {
                    gap
                };
                text.extend(std::iter::repeat_n(' ', gap));
            }
            let content = if word.kind == TokenKind::Comment { word.text.trim_end() } else { word.text };
            text.push_str(content);
            if opens(word.kind) {
                open.push(indent);
            } else if closes(word.kind) {
                open.pop();
            }
        }
        text.push('\n');
    }
    text
}

fn opens(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket)
}

fn closes(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket)
}

/// Spaces between two words of a line.
fn gap(before: &Word<'_>, word: &Word<'_>, header: bool) -> usize {
    use TokenKind::{Atom, Comma, Dot, Equals, LeftCurlyBracket, LeftSquareBracket, RightCurlyBracket};
    let apart = match (before.kind, word.kind) {
        _ if header => false,
        (LeftCurlyBracket, RightCurlyBracket) | (Dot, _) | (_, Dot | Comma) => false,
        (LeftCurlyBracket, _) | (_, RightCurlyBracket) | (Equals, _) | (_, Equals) | (Comma, _) => true,
        (LeftSquareBracket, _) => false,
        // A date and a time.
        (Atom, Atom) => before.column + before.text.chars().count() < word.column,
        _ => false,
    };
    usize::from(apart)
}

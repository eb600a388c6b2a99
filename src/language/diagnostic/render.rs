//! Diagnostics for people, in the look of rustc.

use std::borrow::Cow;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Patch, Renderer, Snippet};

use crate::language::diagnostic::{Diagnostic, Label, Severity, Suggestion};
use crate::language::source::{FileId, SourceMap, Span};

/// The most diagnostics that are shown.
const MOST: usize = 100;

/// Lines longer than this are cut around the place, in bytes.
const WIDEST: usize = 2000;

/// How much of a cut line is shown before the place and, twice as much, after it, in bytes.
const MARGIN: usize = 60;

/// All diagnostics, one after the other.
pub(crate) fn all(list: &[Diagnostic], sources: &SourceMap, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let mut text = String::new();
    for diagnostic in list.iter().take(MOST) {
        text.push_str(&one(diagnostic, sources, &renderer));
        text.push_str("\n\n");
    }
    if list.len() > MOST {
        text.push_str(&format!("and {} more\n", list.len() - MOST));
    }
    text.truncate(text.trim_end().len());
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

fn one(diagnostic: &Diagnostic, sources: &SourceMap, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(neutral(&diagnostic.message)).id(diagnostic.code.text());
    let mut main = Group::with_title(title);
    for (file, labels) in by_file(diagnostic, sources) {
        main = snippet(main, file, &labels, sources);
    }
    for note in &diagnostic.notes {
        main = main.element(Level::NOTE.message(neutral(note)));
    }
    for help in &diagnostic.help {
        main = main.element(Level::HELP.message(neutral(help)));
    }
    let patch = diagnostic.suggestion.as_ref().and_then(|suggestion| patch(suggestion, sources));
    let groups: Vec<Group<'_>> = std::iter::once(main).chain(patch).collect();
    renderer.render(&groups)
}

/// The labels of each file, the file of the primary label first.
fn by_file<'d>(diagnostic: &'d Diagnostic, sources: &SourceMap) -> Vec<(FileId, Vec<&'d Label>)> {
    let mut files: Vec<(FileId, Vec<&Label>)> = Vec::new();
    let (primary, others): (Vec<_>, Vec<_>) = diagnostic.labels.iter().partition(|label| label.primary);
    for label in primary.into_iter().chain(others) {
        let Some(file) = sources.file_of(label.span) else { continue };
        match files.iter_mut().find(|(known, _)| *known == file) {
            Some((_, labels)) => labels.push(label),
            None => files.push((file, vec![label])),
        }
    }
    files
}

/// The labels of one file under their lines.
fn snippet<'s>(mut main: Group<'s>, file: FileId, labels: &[&Label], sources: &'s SourceMap) -> Group<'s> {
    let mut window = Window::around(file, labels.iter().map(|label| label.span), sources);
    let mut shown = labels;
    if window.is_wide() {
        // The first label is the most important one.
        shown = &labels[..1];
        window = Window::narrow(file, labels[0].span, sources);
    }
    let annotations = shown.iter().map(|label| {
        let kind = if label.primary { AnnotationKind::Primary } else { AnnotationKind::Context };
        kind.span(window.range(label.span, sources)).label(neutral(&label.text).into_owned())
    });
    let annotations: Vec<_> = annotations.collect();
    let path = neutral(sources.path(file)).into_owned();
    let mut snippet = Snippet::source(window.text).line_start(window.line).annotations(annotations);
    match sources.locate(labels[0].span).filter(|_| window.cut) {
        // The renderer would count the column from the cut.
        Some(place) => main = main.element(Origin::path(path).line(place.line).char_column(place.column)),
        None => snippet = snippet.path(path),
    }
    main.element(snippet)
}

fn patch<'s>(suggestion: &'s Suggestion, sources: &'s SourceMap) -> Option<Group<'s>> {
    let title = Level::HELP.secondary_title(neutral(&suggestion.text));
    let file = sources.file_of(suggestion.span)?;
    let window = Window::around(file, std::iter::once(suggestion.span), sources);
    if window.is_wide() {
        return Some(Group::with_title(title));
    }
    let range = window.range(suggestion.span, sources);
    let patch = Patch::new(range, neutral(&suggestion.replacement));
    let snippet = Snippet::source(window.text).line_start(window.line).patch(patch);
    Some(Group::with_title(title).element(snippet))
}

/// The lines around some spans: only these are given to the renderer, whose cost grows with the text.
struct Window {
    text: String,
    start: usize,
    line: usize,
    cut: bool,
}

impl Window {
    fn around(file: FileId, spans: impl Iterator<Item = Span>, sources: &SourceMap) -> Self {
        let whole = sources.text(file);
        let ranges: Vec<Range<usize>> =
            spans.filter_map(|span| sources.range(span)).map(|(_, range)| range).collect();
        let first = ranges.iter().map(|range| range.start).min().unwrap_or(0);
        let last = ranges.iter().map(|range| range.end).max().unwrap_or(0);
        let start = whole[..first].rfind('\n').map_or(0, |at| at + 1);
        let end = whole[last..].find('\n').map_or(whole.len(), |at| last + at);
        Self::new(whole, start..end, false)
    }

    fn new(whole: &str, range: Range<usize>, cut: bool) -> Self {
        let (start, line) =
            (range.start, whole[..range.start].bytes().filter(|byte| *byte == b'\n').count() + 1);
        Self { text: same_length(&whole[range]), start, line, cut }
    }

    /// Whether a line is too long to be shown: one line may be the whole of a large file.
    fn is_wide(&self) -> bool {
        self.text.len() > WIDEST && self.text.lines().any(|line| line.len() > WIDEST)
    }

    /// The part of a line around the start of a span.
    fn narrow(file: FileId, span: Span, sources: &SourceMap) -> Self {
        let whole = sources.text(file);
        let (line, place) = (Self::around(file, std::iter::once(span), sources), sources.range(span));
        let place = place.map_or(0, |(_, range)| range.start);
        let mut start = line.start.max(place.saturating_sub(MARGIN));
        let line_end = whole[place..].find('\n').map_or(whole.len(), |at| place + at);
        let mut end = line_end.min(place + 2 * MARGIN);
        while !whole.is_char_boundary(start) {
            start += 1;
        }
        while !whole.is_char_boundary(end) {
            end -= 1;
        }
        Self::new(whole, start..end, true)
    }

    /// A span within the window, never beyond its end: the renderer panics on such.
    fn range(&self, span: Span, sources: &SourceMap) -> Range<usize> {
        let range = sources.range(span).map_or(0..0, |(_, range)| range);
        let clamp = |at: usize| at.saturating_sub(self.start).min(self.text.len());
        clamp(range.start)..clamp(range.end)
    }
}

/// The text with control characters replaced by others of the same length, so that places stay.
fn same_length(text: &str) -> String {
    text.chars().map(|character| harmless(character, character.len_utf8())).collect()
}

fn harmless(character: char, length: usize) -> char {
    match (character, length) {
        ('\n' | '\t' | '\r', _) => character,
        (control, 1) if control.is_control() => '?',
        (control, 2) if control.is_control() => '\u{b7}',
        (hidden, 2) if reorders(hidden) => '\u{b7}',
        (hidden, 3) if reorders(hidden) => '\u{fffd}',
        _ => character,
    }
}

/// Whether a character changes the order in which others are shown, or shows nothing.
fn reorders(character: char) -> bool {
    matches!(character, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// A message with its control characters escaped: a document must not talk to the terminal.
fn neutral(text: &str) -> Cow<'_, str> {
    let bad = |character: char| character.is_control() && character != '\n' || reorders(character);
    if !text.chars().any(bad) {
        return Cow::Borrowed(text);
    }
    let escape = |character: char| {
        if bad(character) { character.escape_default().to_string() } else { character.to_string() }
    };
    Cow::Owned(text.chars().map(escape).collect())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::language::diagnostic::{Code, Diagnostic, Diagnostics};
    use crate::language::source::{SourceMap, Span};

    fn rendered(text: &str, from: usize, to: usize) -> String {
        let mut sources = SourceMap::new();
        let file = sources.add("case.toml", text).unwrap();
        let span = sources.span(file, from..to);
        let one = Diagnostic::error(Code::UnknownField, "unknown field").at(span, "here");
        Diagnostics::new(vec![one.suggest(span, "segments", "did you mean `segments`?")], Arc::new(sources))
            .render(false)
    }

    #[test]
    fn the_line_the_caret_and_the_change_are_shown() {
        let expected = "\
error[K0101]: unknown field
 --> case.toml:2:1
  |
2 | segmnts = 3
  | ^^^^^^^ here
  |
help: did you mean `segments`?
  |
2 | segments = 3
  |     +
";
        assert_eq!(rendered("a = 1\nsegmnts = 3\n", 6, 13), expected);
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        let text = rendered("a = \"\u{1b}[2J\u{9b}\u{202e}\"\n", 0, 20);
        assert!(!text.chars().any(|c| c != '\n' && (c.is_control() || c == '\u{202e}')), "{text:?}");
    }

    #[test]
    fn places_beyond_the_end_and_in_very_long_lines_are_shown() {
        assert!(rendered("ab", 1, 90).contains("case.toml:1:2"));
        assert!(rendered("", 0, 0).contains("case.toml:1:1"));
        let long = rendered(&"x = 1, ".repeat(200_000), 700_001, 700_002);
        assert!(long.len() < 4000, "{}", long.len());
        assert!(long.contains("case.toml:1:700002"), "{long}");
        let mut sources = SourceMap::new();
        sources.add("a", "text").unwrap();
        let one = Diagnostic::error(Code::Syntax, "nowhere").at(Span::new(900, 901), "label");
        assert_eq!(Diagnostics::new(vec![one], Arc::new(sources)).render(false), "error[K0005]: nowhere\n");
    }
}

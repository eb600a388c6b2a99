//! Where things are named in a document, and where their names are used.

use std::ops::Range;

use super::guide::Guide;
use super::scan::{Kind, Part, Scan, Step};

/// A name in a document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    /// `shape`, `curve`, `parameters`, ...
    pub(super) section: String,
    pub(super) text: String,
    /// Bytes of the name alone.
    pub(super) range: Range<usize>,
    /// Whether it is given here, and not used.
    pub(super) given: bool,
}

/// The section of parameters, whose names stand in expressions.
const PARAMETERS: &str = "parameters";

/// All names of a document in the order of the text.
pub(super) fn names(text: &str, scan: &Scan, guide: &Guide) -> Vec<Name> {
    let mut names = Vec::new();
    for part in &scan.parts {
        match (part.kind, &*part.path) {
            (Kind::Header | Kind::Key, [Step::Key(section)]) if guide.is_family(section) => {
                names.push(Name {
                    section: section.clone(),
                    text: part.text.clone(),
                    range: part.inner(),
                    given: true,
                });
            }
            (Kind::Value, _) if part.quoted && part.text.starts_with('=') => {
                names.extend(identifiers(text, part));
            }
            (Kind::Value, path) if part.quoted => {
                if let Some(section) = guide.section(path) {
                    names.push(Name {
                        section: section.to_owned(),
                        text: part.text.clone(),
                        range: part.inner(),
                        given: false,
                    });
                }
            }
            _ => {}
        }
    }
    names
}

/// Words of an expression; of them those that name parameters are looked up by their text.
fn identifiers<'a>(text: &'a str, part: &'a Part) -> impl Iterator<Item = Name> + 'a {
    let inner = part.inner();
    let written = &text[inner.clone()];
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at + written[at..].find(|c: char| c.is_ascii_alphabetic())?;
        let end = written[start..].find(|c| !is_word(c)).map_or(written.len(), |length| start + length);
        at = end;
        Some(Name {
            section: PARAMETERS.to_owned(),
            text: written[start..end].to_owned(),
            range: inner.start + start..inner.start + end,
            given: false,
        })
    })
}

/// The name at a place.
pub(super) fn at(names: &[Name], offset: usize) -> Option<&Name> {
    names.iter().find(|name| name.range.start <= offset && offset <= name.range.end)
}

/// Whether two names are of one thing.
pub(super) fn same(one: &Name, other: &Name) -> bool {
    one.section == other.section && one.text == other.text
}

#[cfg(test)]
mod tests {
    use super::{at, names, same};
    use crate::cli::lsp::guide::Guide;
    use crate::cli::lsp::scan::scan;

    #[test]
    fn names_lead_to_what_they_name() {
        let text = "[parameters]\nheight = 2\n[curve.rim.circle]\nradius = \"= height / 2\"\n[shape.rim]\nmaterial = \"gold\"\n\
                    [shape.rim.extrude]\nprofile = \"rim\"\nheight = 1\n[material.gold]\ncolor = \"#ffcc00\"\n";
        let all = names(text, &scan(text), &Guide::of_documents());
        let uses = |mark: &str| {
            let place = at(&all, text.find(mark).expect("the mark") + 1).expect("a name");
            let all = all.iter().filter(|name| same(name, place));
            all.map(|name| (name.range.start, name.given)).collect::<Vec<_>>()
        };
        let of = |words: &str, from: usize| text[from..].find(words).expect("the words") + from;
        // The curve `rim` and the shape `rim` are two.
        assert_eq!(uses("rim.circle"), [(of("rim", 0), true), (of("rim\"", 0), false)]);
        assert_eq!(uses("gold\""), [(of("gold", 0), false), (of("gold]", 0), true)]);
        assert_eq!(uses("height = 2"), [(of("height", 0), true), (of("height / 2", 0), false)]);
    }
}

//! Places in texts as editors count them: lines, and on them units of UTF-16 or bytes, both from 0.

use std::ops::Range;

use serde_json::{Value as Json, json};

/// How an editor counts the places of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    Utf16,
}

/// The byte of a place; beyond the end of a line, its end.
pub(super) fn offset(text: &str, position: &Json, encoding: Encoding) -> usize {
    let number =
        |key: &str| position[key].as_u64().and_then(|number| usize::try_from(number).ok()).unwrap_or(0);
    let start = match number("line") {
        0 => 0,
        line => text.match_indices('\n').nth(line - 1).map_or(text.len(), |(at, _)| at + 1),
    };
    let line = text[start..].split('\n').next().unwrap_or_default();
    let wanted = number("character");
    let mut counted = 0;
    for (at, character) in line.char_indices() {
        if counted >= wanted {
            return start + at;
        }
        counted += width(character, encoding);
    }
    start + line.trim_end_matches('\r').len()
}

/// The place of a byte.
pub(super) fn position(text: &str, offset: usize, encoding: Encoding) -> Json {
    let before = &text[..offset.min(text.len())];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.matches('\n').count();
    let character: usize = before[start..].chars().map(|character| width(character, encoding)).sum();
    json!({ "line": line, "character": character })
}

/// A range of bytes as an editor counts it.
pub(super) fn range(text: &str, range: &Range<usize>, encoding: Encoding) -> Json {
    json!({ "start": position(text, range.start, encoding), "end": position(text, range.end, encoding) })
}

fn width(character: char, encoding: Encoding) -> usize {
    match encoding {
        Encoding::Utf8 => character.len_utf8(),
        Encoding::Utf16 => character.len_utf16(),
    }
}

/// The file that a URI names; `None` where it is no file.
pub(super) fn file_of(uri: &str) -> Option<std::path::PathBuf> {
    let path = uri.strip_prefix("file://")?;
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let [first, tail @ ..] = rest {
        rest = tail;
        if let (b'%', [high, low, after @ ..]) = (first, tail) {
            let digits = std::str::from_utf8(&[*high, *low]).ok().map(str::to_owned)?;
            bytes.push(u8::from_str_radix(&digits, 16).ok()?);
            rest = after;
        } else {
            bytes.push(*first);
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // A drive of Windows stands behind a slash.
    let drive = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Some(drive.map_or_else(|| path.clone().into(), Into::into))
}

/// The URI of a file.
pub(super) fn uri_of(path: &std::path::Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let mut uri = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~:".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{Encoding, file_of, offset, position, uri_of};

    #[test]
    fn places_count_what_the_editor_counts() {
        let text = "a = 1\nb = \"\u{e9}\u{1f600}x\"\r\nc";
        for (place, at16, at8) in
            [(0, [0, 0], [0, 0]), (11, [1, 5], [1, 5]), (13, [1, 6], [1, 7]), (17, [1, 8], [1, 11])]
        {
            for (encoding, [line, character]) in [(Encoding::Utf16, at16), (Encoding::Utf8, at8)] {
                let expected = json!({ "line": line, "character": character });
                assert_eq!(position(text, place, encoding), expected);
                assert_eq!(offset(text, &expected, encoding), place);
            }
        }
        let beyond = json!({ "line": 1, "character": 99 });
        assert_eq!(offset(text, &beyond, Encoding::Utf16), text.find('\r').expect("an end"));
        assert_eq!(offset(text, &json!({ "line": 99, "character": 0 }), Encoding::Utf16), text.len());
    }

    #[test]
    fn files_and_uris_are_each_other() {
        let path = std::path::Path::new("/a b/\u{fc}/x%.toml");
        assert_eq!(uri_of(path), "file:///a%20b/%C3%BC/x%25.toml");
        assert_eq!(file_of(&uri_of(path)).as_deref(), Some(path));
        assert_eq!(file_of("file:///c:/x.toml").as_deref(), Some(std::path::Path::new("c:/x.toml")));
        assert_eq!(file_of("untitled:1"), None);
        assert_eq!(file_of("file:///%zz"), None);
    }
}

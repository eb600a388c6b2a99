//! What changed, as a page that needs no other file: for reviews.

use std::fmt::Write as _;

use super::Compared;
use super::facts::shown;
use crate::cli::html::escaped;

/// The page's look.
const STYLE: &str = "body { font: 14px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem } \
    h1 { font-size: 1.3rem } img { max-width: 100% } table { border-collapse: collapse } \
    th, td { text-align: left; padding: .2rem 1rem .2rem 0; border-bottom: 1px solid #d8dce0; vertical-align: top } \
    td { font: 12px/1.5 ui-monospace, monospace; overflow-wrap: anywhere }";

/// The page, with a picture (PNG) of both models.
pub(super) fn page(compared: &Compared<'_>, picture: &[u8]) -> String {
    let (one, other) = (escaped(&compared.one.name), escaped(&compared.other.name));
    let mut rows = String::new();
    for change in &compared.changes {
        let cells = [change.path.clone(), shown(change.before.as_ref()), shown(change.after.as_ref())];
        let [path, before, after] = cells.map(|cell| escaped(&cell));
        let _ = writeln!(rows, "<tr><td>{path}<td>{before}<td>{after}");
    }
    let distance = compared.hausdorff().map_or_else(String::new, |(least, most)| {
        format!("<p>The greatest distance between the surfaces is {least:.6} to {most:.6} m.\n")
    });
    let verdict = if compared.same { "<p>Both are the same bytes.\n" } else { "" };
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{one} and {other}</title>\n<style>{STYLE}</style>\n\
         <h1>{one} &rarr; {other}</h1>\n{verdict}{distance}\
         <p><img alt=\"both models; what differs is colored\" src=\"data:image/png;base64,{}\">\n\
         <table><tr><th>fact<th>before<th>after\n{rows}</table>\n</html>\n",
        base64(picture)
    )
}

/// S. Josefsson, RFC 4648, The Base16, Base32, and Base64 Data Encodings, 2006, section 4.
fn base64(bytes: &[u8]) -> String {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let number = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let sign = SIGNS[(number >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= group.len() { char::from(sign) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        let all = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (text, expected) in all {
            assert_eq!(base64(text.as_bytes()), expected);
        }
    }
}

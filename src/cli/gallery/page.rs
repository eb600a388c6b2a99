//! The page of a gallery.

use std::fmt::Write as _;

use crate::cli::html::escaped;

/// What the page says of a model.
pub(super) struct Entry {
    /// Its place below the folder of models, without ending.
    pub(super) name: String,
    /// Its document.
    pub(super) path: String,
    /// The document's text.
    pub(super) text: String,
    /// Its facts, in a line.
    pub(super) line: String,
}

/// The page.
pub(super) fn page(entries: &[Entry], viewer: bool) -> String {
    let mut cards = String::new();
    for entry in entries {
        let [name, path, text, line] =
            [&entry.name, &entry.path, &entry.text, &entry.line].map(|text| escaped(text));
        // The first line of a document says what it shows.
        let first = entry.text.lines().find(|line| line.starts_with("# ")).map_or("", |line| &line[2..]);
        let address = address(&entry.name);
        let _ = write!(
            cards,
            "<article id=\"{name}\" data-model=\"models/{address}.glb\">\n<h2>{name}</h2>\n<p>{}</p>\n\
             <div class=\"view\"><img loading=\"lazy\" width=\"480\" height=\"360\" alt=\"{name}\" src=\"models/{address}.png\"></div>\n\
             <p class=\"facts\">{line} <a href=\"models/{address}.glb\">download</a></p>\n\
             <details><summary>{path}</summary><pre>{text}</pre></details>\n</article>\n",
            escaped(first)
        );
    }
    let script = if viewer {
        "<script type=\"importmap\">{ \"imports\": { \"three\": \"./three/build/three.module.js\", \
         \"three/addons/\": \"./three/examples/jsm/\" } }</script>\n<script type=\"module\" src=\"gallery.js\"></script>\n"
    } else {
        ""
    };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n\
         <title>Gallery</title>\n<link rel=\"stylesheet\" href=\"gallery.css\">\n{script}</head>\n<body>\n<h1>Gallery</h1>\n\
         <main>\n{cards}</main>\n</body>\n</html>\n"
    )
}

/// A path as it is written in an address.
fn address(path: &str) -> String {
    let mut text = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_./".contains(&byte) {
            text.push(char::from(byte));
        } else {
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}

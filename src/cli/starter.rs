//! `kiln new`: a commented document to start from.

use std::io::Write as _;

use serde_json::json;

use super::Outcome;
use super::arguments::New;
use super::output::Printer;
use crate::project::reason;

/// The document, with the name of its shape left open.
const STARTER: &str = include_str!("starter.toml");

pub(crate) fn run(new: &New, printer: &Printer) -> Outcome {
    let name = new.name.trim_end_matches(".toml");
    let kebab = name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '-')
        && !name.ends_with('-');
    if !kebab {
        let message = format!("`{name}` is not a name in kebab-case");
        printer.failure(&message, Some("lower-case letters, digits and hyphens, as in `garden-gnome`"));
        return Outcome::Usage;
    }
    let file = format!("{name}.toml");
    let written = std::fs::OpenOptions::new().write(true).create_new(true).open(&file);
    match written.and_then(|mut out| out.write_all(STARTER.replace("NAME", name).as_bytes())) {
        Ok(()) => {
            let text = format!("wrote {file}; now: kiln bake {file}");
            printer.result(&text, &json!({ "document": file }));
            Outcome::Good
        }
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
            printer.failure(
                &format!("{file} is there already"),
                Some("choose another name; nothing was changed"),
            );
            Outcome::Files
        }
        Err(error) => {
            printer.failure(&format!("{file}: {}", reason(&error)), None);
            Outcome::Files
        }
    }
}

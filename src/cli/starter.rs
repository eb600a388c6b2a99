//! `kiln new`: commented documents to start from, and materials to include.

use std::io::Write as _;

use serde_json::json;

use super::Outcome;
use super::arguments::New;
use super::output::Printer;
use crate::project::reason;

/// Documents with the name of their shape left open: what they are called, and what they show.
const STARTERS: [(&str, &str, &str); 5] = [
    ("vase", "a curve turned about an axis, with a variant", include_str!("starters/vase.toml")),
    ("mug", "bodies joined and cut: a hollow one with a handle", include_str!("starters/mug.toml")),
    (
        "landscape",
        "land of noise with water, in four levels of detail",
        include_str!("starters/landscape.toml"),
    ),
    ("creature", "a skeleton, a skin and a clip that plays", include_str!("starters/creature.toml")),
    ("materials", "metals, wood, stone, cloth and more to include", include_str!("starters/materials.toml")),
];

pub(crate) fn run(new: &New, printer: &Printer) -> Outcome {
    let Some(name) = new.name.as_deref().filter(|_| !new.list) else {
        for (name, about, _) in STARTERS {
            printer.result(&format!("{name:<10} {about}"), &json!({ "starter": name, "about": about }));
        }
        return Outcome::Good;
    };
    let Some((.., text)) = STARTERS.iter().find(|(starter, ..)| *starter == new.from) else {
        let known: Vec<&str> = STARTERS.iter().map(|(starter, ..)| *starter).collect();
        let help = format!("there are {}", known.join(", "));
        printer.failure(&format!("there is no document `{}` to start from", new.from), Some(&help));
        return Outcome::Usage;
    };
    write(name.trim_end_matches(".toml"), text, printer)
}

fn write(name: &str, starter: &str, printer: &Printer) -> Outcome {
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
    match written.and_then(|mut out| out.write_all(starter.replace("NAME", name).as_bytes())) {
        Ok(()) => {
            // What has no shape is there for others to include.
            let next = if starter.contains("\n[shape.") {
                format!("kiln bake {file}")
            } else {
                format!("include = [\"{file}\"]")
            };
            printer.result(&format!("wrote {file}; now: {next}"), &json!({ "document": file }));
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

//! What the program says of itself: schema, reference, codes, completions.

use clap::CommandFactory as _;
use serde_json::json;

use super::Outcome;
use super::arguments::{Arguments, Completions, Explain, Format, Man};
use super::output::Printer;
use crate::language::diagnostic::Code;
use crate::project::reason;

pub(crate) fn schema(printer: &Printer) -> Outcome {
    let schema = crate::language::schema();
    match serde_json::to_string_pretty(&schema) {
        Ok(text) => printer.raw(&format!("{text}\n")),
        Err(error) => printer.failure(&error.to_string(), None),
    }
    Outcome::Good
}

pub(crate) fn reference(printer: &Printer) -> Outcome {
    printer.raw(&crate::language::reference());
    Outcome::Good
}

pub(crate) fn explain(explain: &Explain, printer: &Printer) -> Outcome {
    let Some(text) = &explain.code else {
        for code in Code::ALL {
            printer.result(
                &format!("{code}  {}", code.title()),
                &json!({ "code": code.text(), "title": code.title() }),
            );
        }
        return Outcome::Good;
    };
    let Some(code) = Code::parse(text) else {
        printer.failure(&format!("there is no code `{text}`"), Some("`kiln explain` lists all codes"));
        return Outcome::Usage;
    };
    let explanation = crate::language::explain(code);
    match printer.format {
        Format::Text | Format::Github => printer.raw(&format!("{}\n", explanation.trim_end())),
        Format::Json => {
            let object = json!({ "code": code.text(), "title": code.title(), "explanation": explanation });
            printer.raw(&format!("{object}\n"));
        }
    }
    Outcome::Good
}

pub(crate) fn completions(completions: &Completions) -> Outcome {
    let mut command = Arguments::command();
    clap_complete::generate(completions.shell, &mut command, "kiln", &mut std::io::stdout());
    Outcome::Good
}

/// Writes a manual page for each command.
pub(crate) fn manual(man: &Man, printer: &Printer) -> Outcome {
    let written = std::fs::create_dir_all(&man.folder)
        .and_then(|()| clap_mangen::generate_to(Arguments::command().max_term_width(0), &man.folder));
    match written {
        Ok(()) => Outcome::Good,
        Err(error) => {
            let message =
                format!("cannot write manual pages to {}: {}", man.folder.display(), reason(&error));
            printer.failure(&message, None);
            Outcome::Files
        }
    }
}

//! Printing, for people and for programs.

use std::io::{IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};

use super::arguments::{Color, Common, Format};
use super::records::annotation;
use crate::language::diagnostic::Diagnostics;

/// Whether something that was to be printed is lost.
static LOST: AtomicBool = AtomicBool::new(false);

/// Whether all that was to be printed came through, or its reader went away.
pub(crate) fn all_printed() -> bool {
    !LOST.load(Ordering::Relaxed)
}

/// Prints as the common arguments ask.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Printer {
    pub(crate) format: Format,
    pub(crate) quiet: bool,
    pub(crate) verbose: bool,
    color: bool,
}

impl Printer {
    pub(crate) fn new(common: &Common) -> Self {
        let color = match common.color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => {
                std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
                    && std::io::stderr().is_terminal()
            }
        };
        Self { format: common.format, quiet: common.quiet, verbose: common.verbose, color }
    }

    /// A result: text for people, or one JSON object.
    pub(crate) fn result(&self, text: &str, object: &Value) {
        match self.format {
            _ if self.quiet => {}
            Format::Text | Format::Github => self.raw(&format!("{text}\n")),
            Format::Json => self.raw(&format!("{object}\n")),
        }
    }

    /// What a command is asked to print, as it is.
    pub(crate) fn raw(&self, text: &str) {
        let mut out = std::io::stdout().lock();
        if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            // A closed pipe (`kiln schema | head`) is no reason to fail; a full disk is.
            if error.kind() != std::io::ErrorKind::BrokenPipe && !LOST.swap(true, Ordering::Relaxed) {
                self.complain(&format!("error: cannot print: {error}\n"));
            }
        }
    }

    /// Errors and warnings of a document.
    pub(crate) fn diagnostics(&self, list: &Diagnostics) {
        if list.is_empty() || (self.quiet && !list.has_errors()) {
            return;
        }
        match self.format {
            Format::Text => self.complain(&list.render(self.color)),
            Format::Github => {
                self.complain(&list.render(self.color));
                let items = list.to_json();
                for item in items.as_array().into_iter().flatten() {
                    self.raw(&format!("{}\n", annotation(item)));
                }
            }
            Format::Json => {
                let items = list.to_json();
                for item in items.as_array().into_iter().flatten() {
                    self.raw(&format!("{}\n", json!({ "diagnostic": item })));
                }
            }
        }
    }

    /// Something wrong that has no place in a document.
    pub(crate) fn failure(&self, message: &str, help: Option<&str>) {
        let message = printable(message);
        let object = json!({ "severity": "error", "message": message, "help": help });
        match self.format {
            Format::Text | Format::Github => {
                if self.format == Format::Github {
                    self.raw(&format!("{}\n", annotation(&object)));
                }
                let help = help.map_or_else(String::new, |help| format!("\nhelp: {help}"));
                self.complain(&format!("error: {message}{help}\n"));
            }
            Format::Json => {
                self.raw(&format!("{}\n", json!({ "diagnostic": object })));
            }
        }
    }

    /// Something that a person should know, though all goes on.
    pub(crate) fn warning(&self, message: &str) {
        let message = printable(message);
        let object = json!({ "severity": "warning", "message": message });
        match self.format {
            _ if self.quiet => {}
            Format::Text => self.complain(&format!("warning: {message}\n")),
            Format::Github => self.raw(&format!("{}\n", annotation(&object))),
            Format::Json => self.raw(&format!("{}\n", json!({ "diagnostic": object }))),
        }
    }

    fn complain(&self, text: &str) {
        let text = if text.ends_with('\n') { text.to_owned() } else { format!("{text}\n") };
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }

    /// Whether progress may be drawn: a person watches and wants it.
    pub(crate) fn draws_progress(&self) -> bool {
        self.format != Format::Json && !self.quiet && std::io::stderr().is_terminal()
    }
}

/// Text without signs that a terminal would obey.
fn printable(text: &str) -> String {
    text.chars().map(|sign| if sign.is_control() && sign != '\n' { '\u{fffd}' } else { sign }).collect()
}

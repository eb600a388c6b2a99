//! `kiln verify`: hands baked files to the program `kiln-verify`, which holds their reports against tools that share no code
//! with this one.

use std::process::Command;

use super::Outcome;
use super::arguments::Verify;
use super::output::Printer;
use crate::project::reason;

/// The program.
const PROGRAM: &str = "kiln-verify";

pub(crate) fn run(verify: &Verify, printer: &Printer) -> Outcome {
    match Command::new(PROGRAM).args(&verify.words).status() {
        Ok(status) => match status.code() {
            Some(0) => Outcome::Good,
            Some(1) => Outcome::Errors,
            Some(2) => Outcome::Usage,
            _ => Outcome::Files,
        },
        Err(error) => {
            let message = format!("cannot run {PROGRAM}: {}", reason(&error));
            let help =
                "install it with `pip install kiln-verify` (Python 3.11), then `kiln-verify --install`";
            printer.failure(&message, Some(help));
            Outcome::Files
        }
    }
}

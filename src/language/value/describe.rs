//! Values in the words of messages.

use crate::language::value::{Data, Value};

/// Longest piece of a string that a message quotes, in characters.
const QUOTED: usize = 40;

impl Value {
    /// The value as a message names it: `3.5`, `the string "abc"`, `an array of 4`, `a table`.
    #[must_use]
    pub fn describe(&self) -> String {
        match &self.data {
            Data::Integer(number) => number.to_string(),
            Data::Float(number) => show_number(*number),
            Data::Boolean(value) => value.to_string(),
            Data::String(text) => format!("the string {}", quote(text)),
            Data::Datetime(text) => format!("the date {text}"),
            Data::Array(items) if items.is_empty() => "an empty array".to_owned(),
            Data::Array(items) if items.len() == 1 => "an array of 1 item".to_owned(),
            Data::Array(items) => format!("an array of {} items", items.len()),
            Data::Formula(formula) => format!("a formula of {}", formula.variables().join(", ")),
            Data::Table(_) => "a table".to_owned(),
            Data::Broken => "a value with errors".to_owned(),
        }
    }
}

/// A number as TOML writes it, `2` rather than `2.0`.
#[must_use]
pub fn show_number(number: f64) -> String {
    if number.is_nan() {
        "nan".to_owned()
    } else if number.is_finite() && number != 0.0 && !(1e-5..1e16).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// Text in quotes, cut when it is long, with line ends and the like escaped.
#[must_use]
pub fn quote(text: &str) -> String {
    let cut = text.char_indices().nth(QUOTED).map_or(text.len(), |(at, _)| at);
    let mut quoted = String::from("\"");
    for character in text[..cut].chars() {
        if character == '"' || character.is_control() {
            quoted.extend(character.escape_default());
        } else {
            quoted.push(character);
        }
    }
    quoted.push_str(if cut < text.len() { "...\"" } else { "\"" });
    quoted
}

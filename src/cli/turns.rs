//! What is told of documents that are worked on at once, in their order.

use std::collections::BTreeMap;
use std::sync::Mutex;

use indicatif::ProgressBar;
use serde_json::Value;

use super::output::Printer;
use crate::language::diagnostic::Diagnostics;

/// What a document's work has to say, and to whom.
pub(crate) enum Message {
    Result(String, Value),
    Diagnostics(Diagnostics),
    Failure(String),
}

/// Messages wait for their turn, so that they are printed in the order of the documents.
pub(crate) struct Turns<'a> {
    printer: &'a Printer,
    progress: &'a ProgressBar,
    waiting: Mutex<Waiting>,
}

#[derive(Default)]
struct Waiting {
    next: usize,
    messages: BTreeMap<usize, Vec<Message>>,
}

impl<'a> Turns<'a> {
    pub(crate) fn new(printer: &'a Printer, progress: &'a ProgressBar) -> Self {
        Self { printer, progress, waiting: Mutex::default() }
    }

    /// Takes what a document has to say, and prints all that is at its turn.
    pub(crate) fn speak(&self, index: usize, messages: Vec<Message>) {
        let Ok(mut waiting) = self.waiting.lock() else { return };
        waiting.messages.insert(index, messages);
        loop {
            let next = waiting.next;
            let Some(messages) = waiting.messages.remove(&next) else { return };
            waiting.next += 1;
            self.progress.suspend(|| messages.iter().for_each(|message| self.print(message)));
        }
    }

    fn print(&self, message: &Message) {
        match message {
            Message::Result(text, object) => self.printer.result(text, object),
            Message::Diagnostics(list) => self.printer.diagnostics(list),
            Message::Failure(text) => self.printer.failure(text, None),
        }
    }
}

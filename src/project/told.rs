//! What was told already: a document and its variants share most of their errors.

use crate::language::Document;
use crate::language::diagnostic::{Diagnostic, Diagnostics};

/// Diagnostics of a document that were told.
#[derive(Default)]
pub(crate) struct Told(Vec<Diagnostic>);

impl Told {
    /// Those of a list that are new; of a variant they say so.
    pub(crate) fn only_new(
        &mut self,
        document: &Document,
        list: Diagnostics,
        variant: Option<&str>,
    ) -> Diagnostics {
        let mut fresh = Vec::new();
        for one in list.into_vec() {
            if self.0.contains(&one) {
                continue;
            }
            self.0.push(one.clone());
            fresh.push(match variant {
                Some(variant) => one.note(format!("in variant `{variant}`")),
                None => one,
            });
        }
        document.diagnostics(fresh)
    }
}

//! Documents: files put together, variants laid over, parameters put in.

mod evaluate;
mod load;
mod overlay;
mod parameters;

pub(crate) use load::single;

use std::sync::Arc;

use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::language::document::evaluate::{Given, evaluate};
use crate::language::document::overlay::overlay;
use crate::language::source::Span;
use crate::language::source::{Files, SourceMap};
use crate::language::spec::{Limits, ParameterValue, Sp, Spec, read_spec};
use crate::language::suggest::closest;
use crate::language::value::{Table, quote};

/// A document and all that it includes, parsed but not evaluated.
#[derive(Clone, Debug)]
pub struct Document {
    sources: Arc<SourceMap>,
    /// The definitions of all files; what only the main file may say stands here too.
    base: Table,
    /// What stands under `[variant]`.
    variants: Table,
    /// How much it may ask for at most.
    limits: Limits,
}

impl Document {
    /// Reads a document and the documents that it includes. `main` is its path from the root of `files`.
    ///
    /// # Errors
    /// Every file that cannot be read and every syntax error; beside them those errors of the rest that
    /// cannot follow from the first.
    pub fn load(main: &str, files: &dyn Files) -> Result<Self, Diagnostics> {
        Self::load_within(main, files, Limits::default())
    }

    /// The same, where other limits than the usual ones hold.
    ///
    /// # Errors
    /// As [`Document::load`].
    pub fn load_within(main: &str, files: &dyn Files, limits: Limits) -> Result<Self, Diagnostics> {
        let (mut document, mut found) = load::load(main, files);
        document.limits = limits;
        if found.is_empty() {
            return Ok(document);
        }
        let rest = document.read(None, &[]).1;
        let rest: Vec<_> = rest.into_iter().filter(|one| document.independent(one, &found)).collect();
        found.extend(rest);
        Err(document.diagnostics(found))
    }

    /// Whether it is made for others to include: it defines curves or materials and nothing that could be shown.
    /// A document with a word that is not known is none; it is to be told.
    #[must_use]
    pub fn is_library(&self) -> bool {
        const OF_LIBRARIES: [&str; 5] = ["unit", "up", "include", "parameters", "curve"];
        let known = |key: &String| OF_LIBRARIES.contains(&key.as_str()) || key == "material";
        let defines = ["curve", "material"].iter().any(|family| self.base.entries.contains_key(*family));
        defines && self.base.entries.keys().all(known)
    }

    /// The names of the variants, in the order of the text.
    #[must_use]
    pub fn variants(&self) -> Vec<String> {
        self.variants.entries.keys().cloned().collect()
    }

    /// The names of its parameters, those of its variants too.
    #[must_use]
    pub fn parameters(&self) -> Vec<String> {
        let of_variants = self.variants.entries.values().filter_map(|entry| entry.value.table());
        let tables = std::iter::once(&self.base).chain(of_variants);
        let mut names: Vec<String> = tables
            .filter_map(|table| table.get("parameters")?.table())
            .flat_map(|parameters| parameters.entries.keys().cloned())
            .collect();
        names.sort();
        names.dedup();
        names
    }

    /// The texts of the document, for rendering what is said about them.
    #[must_use]
    pub fn sources(&self) -> &Arc<SourceMap> {
        &self.sources
    }

    /// Diagnostics on this document, sorted.
    #[must_use]
    pub fn diagnostics(&self, mut list: Vec<Diagnostic>) -> Diagnostics {
        // What has no place of its own concerns the document as a whole, and names it by its first line.
        let start = self.sources.files().next().map_or(Span::NONE, |main| self.sources.span(main, 0..0));
        for one in &mut list {
            if one.place().is_none_or(Span::is_none) {
                one.labels.clear();
                *one = one.clone().at(start, "");
            }
        }
        Diagnostics::new(list, Arc::clone(&self.sources))
    }

    /// The document with a variant laid over it and its parameters put in, and warnings. Overrides are
    /// names of parameters and what they shall be, as the command line writes them.
    ///
    /// # Errors
    /// Everything that is wrong, warnings included.
    pub fn spec(
        &self,
        variant: Option<&str>,
        overrides: &[(String, String)],
    ) -> Result<(Spec, Vec<Diagnostic>), Diagnostics> {
        let (spec, found) = self.read(variant, overrides);
        let failed = found.iter().any(|one| one.severity == Severity::Error);
        match spec {
            Some(spec) if !failed => Ok((spec, self.diagnostics(found).into_vec())),
            _ => Err(self.diagnostics(found)),
        }
    }

    /// The document as [`Document::spec`] reads it with other values of some parameters: a state of it.
    ///
    /// # Errors
    /// Everything that is wrong with these values, or with the document that they make.
    pub fn state(
        &self,
        variant: Option<&str>,
        overrides: &[(String, String)],
        with: &IndexMap<String, Sp<ParameterValue>>,
    ) -> Result<Spec, Diagnostics> {
        let (spec, found) = self.read_with(variant, &Given { overrides, with });
        let failed = found.iter().any(|one| one.severity == Severity::Error);
        spec.filter(|_| !failed).ok_or_else(|| self.diagnostics(found))
    }

    fn read(&self, variant: Option<&str>, overrides: &[(String, String)]) -> (Option<Spec>, Vec<Diagnostic>) {
        self.read_with(variant, &Given { overrides, with: &IndexMap::new() })
    }

    fn read_with(&self, variant: Option<&str>, given: &Given<'_>) -> (Option<Spec>, Vec<Diagnostic>) {
        let mut table = self.base.clone();
        if let Some(name) = variant {
            match self.variants.get(name) {
                Some(partial) => overlay(&mut table, partial),
                None => return (None, vec![self.unknown_variant(name)]),
            }
        }
        let mut found = evaluate(&mut table, &self.variants, given, &self.sources);
        let (spec, more) = read_spec(&table, &self.sources, self.limits);
        found.extend(more);
        (spec, found)
    }

    fn unknown_variant(&self, name: &str) -> Diagnostic {
        let report = Diagnostic::error(Code::UnknownVariant, format!("there is no variant {}", quote(name)));
        let names = self.variants();
        match closest(name, names.iter().map(String::as_str)) {
            Some(near) => report.help(format!("did you mean \"{near}\"?")),
            None if names.is_empty() => report.note("this document has no variants"),
            None => report.note(format!("variants: {}", names.join(", "))),
        }
    }

    /// Whether a diagnostic holds even where others left a part of the document unread.
    fn independent(&self, one: &Diagnostic, causes: &[Diagnostic]) -> bool {
        let line = |diagnostic: &Diagnostic| {
            let place = self.sources.locate(diagnostic.place()?)?;
            Some((place.file.to_owned(), place.line))
        };
        let follows = matches!(
            one.code,
            Code::MissingField
                | Code::NoKind
                | Code::UnknownName
                | Code::WrongFamily
                | Code::UnknownVariable
                | Code::UnusedParameter
                | Code::WrongCount
                | Code::NothingToBake
        );
        let here = line(one);
        let lost = |cause: &Diagnostic| {
            let place = cause.place().zip(one.place());
            let file = |span| self.sources.file_of(span);
            // What follows an open bracket was read as something else.
            cause.code == Code::Unclosed
                && place.is_some_and(|(open, at)| file(open) == file(at) && open < at)
        };
        !follows && !causes.iter().any(|cause| line(cause) == here || lost(cause))
    }
}

//! Reading a document and what it includes.

use std::sync::Arc;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::document::Document;
use crate::language::source::{FileError, FileId, Files, SourceMap, Span, decode, join, readable};
use crate::language::spec::{Limits, backtick, check_name, default_text};
use crate::language::value::{Data, Entry, Table, Value, parse, quote};

/// How deep includes may be nested.
const DEEPEST: usize = 32;

/// What several files may define together: in each family a name once.
const SHARED: [&str; 8] = ["curve", "map", "shape", "material", "node", "parameters", "variant", "assert"];

/// What must be the same in every file of a document.
const EQUAL: [&str; 2] = ["unit", "up"];

/// Reads a document with all its files; what could be read, and what was wrong.
pub(crate) fn load(main: &str, files: &dyn Files) -> (Document, Vec<Diagnostic>) {
    let mut loader =
        Loader { files, sources: SourceMap::new(), found: Vec::new(), seen: Vec::new(), open: Vec::new() };
    let mut base = match join("", main) {
        Ok(path) => loader.file(&path, main, Span::NONE),
        Err(error) => {
            loader.unreadable(&error, main, Span::NONE);
            None
        }
    }
    .unwrap_or_default();
    let variants = base.entries.shift_remove("variant").map(|entry| loader.variants(entry.value));
    let sources = Arc::new(loader.sources);
    let limits = Limits::default();
    (Document { sources, base, variants: variants.unwrap_or_default(), limits }, loader.found)
}

/// Reads one file that includes no other: the texts, what stands in it where it can be read, and what was wrong.
pub(crate) fn single(path: &str, files: &dyn Files) -> (SourceMap, Option<Table>, Vec<Diagnostic>) {
    let mut loader =
        Loader { files, sources: SourceMap::new(), found: Vec::new(), seen: Vec::new(), open: Vec::new() };
    let table = loader.table(path, path, Span::NONE);
    (loader.sources, table, loader.found)
}

struct Loader<'f> {
    files: &'f dyn Files,
    sources: SourceMap,
    found: Vec<Diagnostic>,
    /// The files that were read, so that each is read once.
    seen: Vec<String>,
    /// The files whose includes are being read, and where each was asked for.
    open: Vec<(String, Span)>,
}

impl Loader<'_> {
    /// Reads one file and what it includes, into one table; `None` when it cannot be read.
    fn file(&mut self, path: &str, written: &str, asked: Span) -> Option<Table> {
        self.seen.push(path.to_owned());
        let mut table = self.table(path, written, asked)?;
        let include = table.entries.shift_remove("include");
        self.open.push((path.to_owned(), asked));
        for (path, written, span) in include.map(|entry| self.paths(path, &entry.value)).unwrap_or_default() {
            if self.enter(&path, span)
                && let Some(included) = self.file(&path, &written, span)
            {
                self.merge(&mut table, included);
            }
        }
        self.open.pop();
        Some(table)
    }

    /// What stands in a file.
    fn table(&mut self, path: &str, written: &str, asked: Span) -> Option<Table> {
        let bytes = match self.files.read(path) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.unreadable(&error, written, asked);
                return None;
            }
        };
        let id = self.add(path, &bytes)?;
        let (table, found) = parse(&self.sources, id);
        self.found.extend(found);
        Some(table)
    }

    fn add(&mut self, path: &str, bytes: &[u8]) -> Option<FileId> {
        let fault = match decode(bytes) {
            Ok(text) => {
                let id = self.sources.add(path, text);
                if id.is_none() {
                    let message = format!("{} makes the document larger than 4 GiB", quote(path));
                    self.found.push(Diagnostic::error(Code::TooLarge, message));
                }
                return id;
            }
            Err(fault) => fault,
        };
        let (text, range) = readable(bytes);
        let id = self.sources.add(path, text)?;
        let report = Diagnostic::error(Code::NotText, fault.to_string());
        self.found
            .push(report.at(self.sources.span(id, range), "not text").help("save the document as UTF-8"));
        None
    }

    fn unreadable(&mut self, error: &FileError, written: &str, asked: Span) {
        let code = match error {
            FileError::Missing => Code::FileMissing,
            FileError::Absolute | FileError::Outside | FileError::NotPortable => Code::OutsideRoot,
            FileError::TooLarge(_) => Code::TooLarge,
            FileError::Folder | FileError::Unreadable(_) => Code::FileUnreadable,
        };
        self.found.push(Diagnostic::error(code, error.message(written)).at(asked, error.label()));
    }

    /// The paths of an include list: from the root, as written, and where.
    fn paths(&mut self, from: &str, list: &Value) -> Vec<(String, String, Span)> {
        let Data::Array(items) = &list.data else {
            self.mismatch("`include` must be an array of paths", list);
            return Vec::new();
        };
        let mut paths = Vec::new();
        for item in items {
            let Data::String(written) = &item.data else {
                self.mismatch("`include` must be an array of paths", item);
                continue;
            };
            match join(from, written) {
                Ok(path) => paths.push((path, written.clone(), item.span)),
                Err(error) => self.unreadable(&error, written, item.span),
            }
        }
        paths
    }

    fn mismatch(&mut self, message: &str, value: &Value) {
        if !matches!(value.data, Data::Broken) {
            let message = format!("{message}, found {}", value.describe());
            self.found.push(Diagnostic::error(Code::WrongType, message).at(value.span, ""));
        }
    }

    /// Whether a file is to be read: not when it was, and not when it includes itself.
    fn enter(&mut self, path: &str, span: Span) -> bool {
        if let Some(start) = self.open.iter().position(|(open, _)| open == path) {
            let circle: Vec<&str> = self.open[start..].iter().map(|(open, _)| open.as_str()).collect();
            let message = format!("documents include each other: {} -> {path}", circle.join(" -> "));
            let mut report = Diagnostic::error(Code::IncludeCycle, message).at(span, "closes the circle");
            for (open, asked) in &self.open[start + 1..] {
                report = report.also(*asked, format!("includes {open}"));
            }
            self.found.push(report);
            return false;
        }
        if self.open.len() > DEEPEST {
            let message = format!("includes are nested more than {DEEPEST} deep");
            self.found.push(Diagnostic::error(Code::TooDeep, message).at(span, "too deep"));
            return false;
        }
        !self.seen.iter().any(|seen| seen == path)
    }

    /// Adds the definitions of an included document.
    fn merge(&mut self, base: &mut Table, included: Table) {
        for (name, entry) in included.entries {
            match name.as_str() {
                name if SHARED.contains(&name) => self.merge_family(name, base, entry),
                name if EQUAL.contains(&name) => self.compare(name, base, &entry),
                name => {
                    let message = format!("{} stands in an included document", backtick(name));
                    let report = Diagnostic::error(Code::IncludeConflict, message)
                        .at(entry.key, "only the main document says this")
                        .note("an included document holds definitions, parameters, variants and assertions");
                    self.found.push(report);
                }
            }
        }
    }

    fn merge_family(&mut self, family: &str, base: &mut Table, entry: Entry) {
        let Some(under) = base.entries.get_mut(family) else {
            base.entries.insert(family.to_owned(), entry);
            return;
        };
        // What is no table is reported where families are read; the one of the main document wins.
        if let (Data::Table(under), Data::Table(added)) = (&mut under.value.data, entry.value.data) {
            self.merge_names(family, under, added);
        }
    }

    fn merge_names(&mut self, family: &str, base: &mut Table, added: Table) {
        for (name, entry) in added.entries {
            let Some(under) = base.entries.get_mut(&name) else {
                base.entries.insert(name, entry);
                continue;
            };
            // Paths of assertions are tables in tables: only their ends are names.
            if family == "assert"
                && let (Data::Table(under), Data::Table(added)) =
                    (&mut under.value.data, entry.value.data.clone())
            {
                self.merge_names(family, under, added);
                continue;
            }
            let what = match family {
                "parameters" => "parameter",
                "assert" => "assertion",
                family => family,
            };
            let report = Diagnostic::error(
                Code::DuplicateName,
                format!("{what} {} is defined twice", backtick(&name)),
            )
            .at(under.key, "here")
            .also(entry.key, "and in an included document")
            .help("give one of them another name, or leave it out");
            self.found.push(report);
        }
    }

    fn compare(&mut self, name: &str, base: &Table, entry: &Entry) {
        let default = default_text(name);
        let text = |value: &Value| match &value.data {
            Data::String(text) => text.clone(),
            other => format!("{other:?}"),
        };
        let main = base.entries.get(name);
        let (mine, theirs) = (main.map_or(default.to_owned(), |main| text(&main.value)), text(&entry.value));
        if mine == theirs {
            return;
        }
        let report =
            Diagnostic::error(Code::IncludeConflict, format!("an included document has another `{name}`"))
                .at(entry.value.span, format!("the including document has \"{mine}\""))
                .also(main.map_or(Span::NONE, |main| main.value.span), "here")
                .help("write both documents in the same unit and axis");
        self.found.push(report);
    }

    fn variants(&mut self, value: Value) -> Table {
        let Data::Table(mut table) = value.data else {
            self.mismatch("`variant` must be a table", &value);
            return Table::default();
        };
        table.entries.retain(|name, entry| {
            self.found.extend(check_name("variant", name, entry.key));
            let partial = matches!(entry.value.data, Data::Table(_));
            if !partial {
                self.mismatch("a variant must be a table", &entry.value);
            }
            self.check_partial(name, &entry.value);
            partial
        });
        table
    }

    /// A variant changes what a document says, not which files it has.
    fn check_partial(&mut self, variant: &str, value: &Value) {
        let Some(table) = value.table() else { return };
        for name in ["include", "variant"] {
            if let Some(entry) = table.entries.get(name) {
                let message = format!("variant {} holds `{name}`", backtick(variant));
                let report = Diagnostic::error(Code::UnknownField, message);
                self.found.push(report.at(entry.key, "stands at the top of a document only"));
            }
        }
    }
}

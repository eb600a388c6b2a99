//! The documents that are open in an editor, and what is known of them.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value as Json, json};

use super::guide::Guide;
use super::names::{Name, names};
use super::scan::{Kind, Part, Scan, scan};
use super::text::{Encoding, file_of, uri_of};
use crate::build;
use crate::compile::{Compiled, Options, compile, outputs};
use crate::geometry::curve::length;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::{DiskFiles, FileError, FileRecord, Files, join};
use crate::language::spec::Limits;
use crate::language::{Document, PROJECT_FILE, ProjectFile};
use crate::project::{Task, Told};

/// An open document.
pub(super) struct Sheet {
    pub(super) text: String,
    pub(super) scan: Scan,
    pub(super) names: Vec<Name>,
    /// What was wrong with it when it was last looked at.
    pub(super) found: Option<Diagnostics>,
    /// What was made of this text, when that was asked for.
    made: Option<Option<Box<Compiled>>>,
}

/// All open documents by their URIs.
pub(super) struct Desk {
    documents: Guide,
    projects: Guide,
    pub(super) encoding: Encoding,
    /// The folder that the editor has open.
    root: Option<PathBuf>,
    pub(super) sheets: BTreeMap<String, Sheet>,
}

/// Files as the editor shows them, where they are open, and as they are on disk elsewhere.
struct Shown<'a> {
    disk: DiskFiles,
    open: BTreeMap<String, &'a str>,
}

impl Files for Shown<'_> {
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let open = join("", path).ok().and_then(|path| self.open.get(&path));
        open.map_or_else(|| self.disk.read(path), |text| Ok(Arc::from(text.as_bytes())))
    }

    fn record(&self) -> Vec<FileRecord> {
        self.disk.record()
    }
}

impl Desk {
    pub(super) fn new(root: Option<PathBuf>, encoding: Encoding) -> Self {
        let root = root.and_then(|root| root.canonicalize().ok());
        let (documents, projects) = (Guide::of_documents(), Guide::of_projects());
        Self { documents, projects, encoding, root, sheets: BTreeMap::new() }
    }

    /// What may stand in a text.
    pub(super) fn guide(&self, uri: &str) -> &Guide {
        if is_project(uri) { &self.projects } else { &self.documents }
    }

    pub(super) fn put(&mut self, uri: &str, text: String) {
        let scan = scan(&text);
        let names = names(&text, &scan, self.guide(uri));
        let found = self.sheets.remove(uri).and_then(|before| before.found);
        self.sheets.insert(uri.to_owned(), Sheet { text, scan, names, found, made: None });
    }

    /// Where a document lies: its root and its path from there.
    fn task(&self, uri: &str) -> Option<Task> {
        let file = file_of(uri)?;
        // A document that was never saved has a folder all the same.
        let folder = file.parent()?.canonicalize().ok()?;
        let real = folder.join(file.file_name()?);
        let root = self.root.clone().filter(|root| real.starts_with(root)).unwrap_or(folder);
        let below = real.strip_prefix(&root).ok()?;
        let slashes = |path: &std::path::Path| path.to_string_lossy().replace('\\', "/");
        Some(Task {
            path: slashes(below),
            output: slashes(&below.with_extension("")),
            root,
            found: false,
            linked: false,
            limits: Limits::default(),
        })
    }

    fn files(&self, task: &Task) -> Option<Shown<'_>> {
        let disk = DiskFiles::new(&task.root).ok()?;
        let path = |uri: &String| {
            let own = self.task(uri)?;
            let full = own.root.join(&own.path);
            Some(full.strip_prefix(&task.root).ok()?.to_string_lossy().replace('\\', "/"))
        };
        let open =
            self.sheets.iter().filter_map(|(uri, sheet)| Some((path(uri)?, sheet.text.as_str()))).collect();
        Some(Shown { disk, open })
    }

    /// Whether a text has a section of our language: editors show the server all TOML, of other programs too.
    fn is_ours(&self, uri: &str, sheet: &Sheet) -> bool {
        if is_project(uri) {
            return true;
        }
        let first = |part: &Part| part.kind != Kind::Value && part.path.is_empty();
        let mut words = sheet.scan.parts.iter().filter(|part| first(part));
        words.any(|part| self.documents.sections().any(|section| section == part.text))
    }

    /// Looks for what is wrong with a document: all of it where `whole`, else what shows before surfaces are cut.
    pub(super) fn look(&mut self, uri: &str, whole: bool) {
        let task =
            self.task(uri).filter(|_| self.sheets.get(uri).is_some_and(|sheet| self.is_ours(uri, sheet)));
        let found = task.and_then(|task| {
            let files = self.files(&task)?;
            // A fault of ours must not take the editor's server with it.
            catch_unwind(AssertUnwindSafe(|| diagnostics(&task, &files, whole))).ok().flatten()
        });
        if let Some(sheet) = self.sheets.get_mut(uri) {
            sheet.found = found;
        }
    }

    /// The document and those that it includes, each by its URI, with names.
    pub(super) fn family(&self, uri: &str) -> Vec<(String, String, Vec<Name>)> {
        let Some(sheet) = self.sheets.get(uri) else { return Vec::new() };
        let mut all = vec![(uri.to_owned(), sheet.text.clone(), sheet.names.clone())];
        let Some(task) = self.task(uri) else { return all };
        let Some(files) = self.files(&task) else { return all };
        let sources = match Document::load(&task.path, &files) {
            Ok(document) => Arc::clone(document.sources()),
            Err(list) => Arc::clone(list.sources()),
        };
        for id in sources.files().filter(|id| sources.path(*id) != task.path) {
            let text = sources.text(id).to_owned();
            let names = names(&text, &scan(&text), &self.documents);
            all.push((uri_of(&task.root.join(sources.path(id))), text, names));
        }
        all
    }

    /// The URI of a file that a diagnostic names.
    pub(super) fn uri_beside(&self, uri: &str, path: &str) -> Option<String> {
        let task = self.task(uri)?;
        if path == task.path { Some(uri.to_owned()) } else { Some(uri_of(&task.root.join(path))) }
    }

    /// What was measured of a named thing, for people.
    pub(super) fn facts(&mut self, uri: &str, section: &str, name: &str) -> Option<String> {
        let task = self.task(uri)?;
        match section {
            "curve" => {
                let files = self.files(&task)?;
                let document = Document::load(&task.path, &files).ok()?;
                let (spec, _) = document.spec(None, &[]).ok()?;
                let curves = build::curve(&spec, name, &files).ok()??;
                let total: f64 = curves.iter().map(length).sum();
                Some(format!("length {}", short(total)))
            }
            "shape" => {
                if self.sheets.get(uri)?.made.is_none() {
                    let files = self.files(&task)?;
                    let made = Document::load(&task.path, &files).ok().and_then(|document| {
                        let work = || compile(&document, &files, &options(&task, None)).ok();
                        catch_unwind(AssertUnwindSafe(work)).ok().flatten()
                    });
                    self.sheets.get_mut(uri)?.made = Some(made.map(Box::new));
                }
                let report = self.sheets.get(uri)?.made.as_ref()?.as_ref()?.report.as_ref()?;
                let facts = &report.shapes.get(name)?.facts;
                let facts = serde_json::to_value(facts).ok()?;
                let number = |key: &str| facts[key].as_f64();
                let mut said = vec![format!("{} triangles", facts["triangles"])];
                said.extend(number("area").map(|area| format!("area {}", short(area))));
                if facts["closed"] == true {
                    said.extend(number("volume").map(|volume| format!("volume {}", short(volume))));
                }
                Some(said.join(", "))
            }
            _ => None,
        }
    }
}

/// Whether a path is that of a project file.
fn is_project(path: &str) -> bool {
    path.rsplit('/').next() == Some(PROJECT_FILE)
}

/// A number for a person.
fn short(number: f64) -> String {
    let text = format!("{number:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn options(task: &Task, variant: Option<String>) -> Options {
    Options { variant, name: task.name().to_owned(), path: task.path.clone(), ..Options::default() }
}

fn diagnostics(task: &Task, files: &Shown<'_>, whole: bool) -> Option<Diagnostics> {
    if is_project(&task.path) {
        return ProjectFile::load(&task.path, files).err();
    }
    let document = match Document::load(&task.path, files) {
        Ok(document) => document,
        Err(list) => return Some(list),
    };
    if document.is_library() {
        return None;
    }
    let mut told = Told::default();
    let mut all = Vec::new();
    for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
        let options = options(task, variant);
        let list = if whole {
            compile(&document, files, &options).map(|compiled| compiled.warnings)
        } else {
            outputs(&document, files, &options).map(|_| document.diagnostics(Vec::new()))
        };
        let list = list.unwrap_or_else(|list| list);
        all.extend(told.only_new(&document, list, options.variant.as_deref()).into_vec());
    }
    Some(document.diagnostics(all))
}

/// A diagnostic as an editor takes it, with the path of its file; `None` where it has no place.
pub(super) fn shown(
    one: &crate::language::diagnostic::Diagnostic,
    list: &Diagnostics,
    (uri, desk): (&str, &Desk),
) -> Option<(String, Json)> {
    let sources = list.sources();
    let place = |span| {
        let (id, range) = sources.range(span)?;
        let file = desk.uri_beside(uri, sources.path(id))?;
        Some((file, super::text::range(sources.text(id), &range, desk.encoding)))
    };
    let (file, range) = one.place().and_then(place)?;
    let mut message = one.message.clone();
    for (word, lines) in [("note", &one.notes), ("help", &one.help)] {
        lines.iter().for_each(|line| message.push_str(&format!("\n{word}: {line}")));
    }
    let related: Vec<Json> = one
        .labels
        .iter()
        .filter(|label| !label.primary)
        .filter_map(|label| {
            let (uri, range) = place(label.span)?;
            Some(json!({ "location": { "uri": uri, "range": range }, "message": label.text }))
        })
        .collect();
    let severity = match one.severity {
        crate::language::diagnostic::Severity::Error => 1,
        crate::language::diagnostic::Severity::Warning => 2,
    };
    let mut shown = json!({
        "range": range, "severity": severity, "code": one.code.text(), "source": "kiln", "message": message,
        "relatedInformation": related,
    });
    if let Some(suggestion) = &one.suggestion
        && let Some((file, range)) = place(suggestion.span)
    {
        shown["data"] = json!({
            "uri": file, "title": suggestion.text, "edit": { "range": range, "newText": suggestion.replacement },
        });
    }
    Some((file, shown))
}

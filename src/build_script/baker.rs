//! One document for a build script: baked, or taken from the cache.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Build;
use crate::cache::{Baked, Cache, Hit, Key, OutputFile, Record};
use crate::compile::{Compiled, Options, compile_profiles};
use crate::gltf::Profile;
use crate::language;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::{FileRecord, Files as _};
use crate::project::{Task, Told, reason};
use crate::realize::Keep;

/// Bakes documents as a build asks for.
pub(super) struct Baker<'a> {
    pub(super) build: &'a Build,
    pub(super) profiles: Vec<Profile>,
    /// Parameters that the project gives to those documents that have them.
    pub(super) given: Vec<(String, String)>,
    pub(super) cache: Option<&'a Arc<Cache>>,
}

/// What came of one document.
#[derive(Default)]
pub(super) struct Document {
    pub(super) outputs: Vec<Output>,
    pub(super) errors: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) inputs: Vec<PathBuf>,
}

/// An asset that is to be written.
pub(super) struct Output {
    /// The folder below the output folder; empty for that itself.
    pub(super) folder: String,
    /// The name of its first file.
    pub(super) file: String,
    /// Names and bytes: the model and its report.
    pub(super) files: Vec<(String, Vec<u8>)>,
    pub(super) facts: Facts,
}

/// What the build script says of an asset beside its bytes.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Facts {
    /// The box of all nodes, where there is a report.
    pub(super) bounds: Option<[[f64; 3]; 2]>,
    pub(super) triangles: u64,
}

impl Baker<'_> {
    pub(super) fn document(&self, task: &Task) -> Document {
        let cached = self.cache.map(|cache| (cache.as_ref(), self.key(cache, task)));
        let known = cached.as_ref().and_then(|(cache, key)| self.known(task, (cache, key)));
        known.unwrap_or_else(|| self.baked(task, cached))
    }

    fn baked(&self, task: &Task, cached: Option<(&Cache, Key)>) -> Document {
        let mut done = Document::default();
        let (files, document) = match task.load() {
            Ok(loaded) => loaded,
            Err(error) => {
                done.errors.push(format!("{}: {}", task.path, reason(&error)));
                return done;
            }
        };
        let mut record = Record::default();
        match document {
            Ok(document) if task.found && document.is_library() => {}
            Ok(document) => self.assets(task, (&document, &files), (&mut record, &mut done)),
            Err(list) => done.fail(&list),
        }
        let read = files.record();
        let path = |record: &FileRecord| record.found.then(|| self.build.shown(task, &record.path));
        done.inputs = read.iter().filter_map(path).collect();
        if let (Some((cache, key)), true) = (cached, done.errors.is_empty() && !record.assets.is_empty()) {
            let bytes: Vec<&[u8]> = done.outputs.iter().flat_map(Output::bytes).collect();
            cache.keep(&key, &read, &record, &bytes);
        }
        done
    }

    /// Bakes all variants.
    fn assets(
        &self,
        task: &Task,
        (document, files): (&language::Document, &dyn language::source::Files),
        (record, done): (&mut Record, &mut Document),
    ) {
        let build = self.build;
        let known = document.parameters();
        let given = self.given.iter().filter(|(name, _)| known.contains(name));
        let overrides: Vec<(String, String)> = given.chain(&build.parameters).cloned().collect();
        let mut told = Told::default();
        for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
            let options = Options {
                variant,
                overrides: overrides.clone(),
                name: task.name().to_owned(),
                path: task.path.clone(),
                no_report: !build.report,
                beside: true,
                profiles: self.profiles.clone(),
                keep: self.cache.map(|cache| Arc::clone(cache) as Arc<dyn Keep>),
                ..Options::default()
            };
            let variant = options.variant.as_deref();
            let all = match compile_profiles(document, files, &options) {
                Ok(all) => all,
                Err(list) => {
                    done.fail(&told.only_new(document, list, variant));
                    continue;
                }
            };
            for mut compiled in all {
                let none = document.diagnostics(Vec::new());
                let warnings = std::mem::replace(&mut compiled.warnings, none);
                let warnings = told.only_new(document, warnings, variant);
                done.warn(&warnings);
                match Output::new(task, compiled) {
                    Ok(output) => {
                        record.assets.push(output.recorded(warnings));
                        done.outputs.push(output);
                    }
                    Err(error) => done.errors.push(format!("{}: {error}", task.path)),
                }
            }
        }
    }

    /// Everything but files that outputs depend on.
    fn key(&self, cache: &Cache, task: &Task) -> Key {
        let report = if self.build.report { "report" } else { "no report" };
        let profiles = self.profiles.iter().map(|profile| profile.name());
        let texts = |list: &'_ [(String, String)]| {
            list.iter().flat_map(|(name, value)| [name.clone(), value.clone()]).collect::<Vec<_>>()
        };
        let (given, set) = (texts(&self.given), texts(&self.build.parameters));
        let limits = format!("{:?}", task.limits);
        let parts =
            ["build script", task.path.as_str(), task.name(), report, &limits].into_iter().chain(profiles);
        let given = given.iter().map(String::as_str);
        let set = set.iter().map(String::as_str);
        cache.key(parts.chain(["--"]).chain(given).chain(["--"]).chain(set))
    }

    /// What was baked of a document before; none when it is not known, or not whole.
    fn known(&self, task: &Task, (cache, key): (&Cache, &Key)) -> Option<Document> {
        let Hit { record, inputs } = cache.find(key, &task.root)?;
        let warned = record.assets.iter().any(|asset| !asset.warnings.is_empty());
        // Warnings show lines of the texts.
        let document = if warned { Some(task.load().ok()?.1.ok()?) } else { None };
        let mut done = Document::default();
        for asset in record.assets {
            let files = asset.files.iter().map(|file| Some((file.name.clone(), cache.bytes(file)?)));
            done.outputs.push(Output {
                folder: folder(task),
                file: asset.file,
                files: files.collect::<Option<_>>()?,
                facts: serde_json::from_value(asset.facts).ok()?,
            });
            if let Some(document) = &document {
                done.warn(&document.diagnostics(asset.warnings));
            }
        }
        done.inputs = inputs.iter().map(|path| self.build.shown(task, path)).collect();
        Some(done)
    }
}

fn folder(task: &Task) -> String {
    task.output.rsplit_once('/').map_or_else(String::new, |(folder, _)| folder.to_owned())
}

impl Output {
    fn new(task: &Task, compiled: Compiled) -> serde_json::Result<Self> {
        let mut facts = Facts::default();
        let report_file = compiled.report_file()?;
        if let Some(report) = &compiled.report {
            let bounds = &report.totals.bounds;
            facts = Facts { bounds: Some([bounds.min, bounds.max]), triangles: report.totals.triangles };
        }
        let written = std::iter::once((compiled.file.clone(), compiled.bytes)).chain(report_file);
        let files = written.chain(compiled.pictures).collect();
        Ok(Self { folder: folder(task), file: compiled.file, files, facts })
    }

    fn bytes(&self) -> impl Iterator<Item = &[u8]> {
        self.files.iter().map(|(_, bytes)| bytes.as_slice())
    }

    /// What the cache keeps of it.
    fn recorded(&self, warnings: Diagnostics) -> Baked {
        Baked {
            file: self.file.clone(),
            line: String::new(),
            facts: json!(self.facts),
            files: self.files.iter().map(|(name, bytes)| OutputFile::of(name, bytes)).collect(),
            warnings: warnings.into_vec(),
        }
    }
}

impl Document {
    fn warn(&mut self, list: &Diagnostics) {
        if !list.is_empty() {
            self.warnings.push(list.render(false));
        }
    }

    fn fail(&mut self, list: &Diagnostics) {
        if !list.is_empty() {
            self.errors.push(list.render(false));
        }
    }
}

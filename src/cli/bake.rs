//! `kiln bake`: documents into files.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::json;

use super::Outcome;
use super::arguments::Bake;
use super::baked::baked;
use super::cache;
use super::dependencies::Dependencies;
use super::output::Printer;
use super::project::{Budget, Work, each, from_here, loaded, named, out, profiles};
use super::records::write;
use super::turns::Message;
use crate::cache::{Baked, Cache, Hit, Key, Record};
use crate::compile::{Options, compile_profiles, estimated_memory};
use crate::language::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::language::source::Files as _;
use crate::language::spec::{backtick, closest};
use crate::language::{Document, PROJECT_FILE};
use crate::project::{Project, Task, Told, reason, save};
use crate::realize::Keep;

/// Bakes all documents; one that fails does not stop the others.
pub(crate) fn run(bake: &mut Bake, printer: &Printer) -> Outcome {
    let (project, tasks) = match named(&mut bake.documents, bake.out.as_ref(), printer) {
        Ok(named) => named,
        Err(outcome) => return outcome,
    };
    let project = project.as_ref();
    bake.profile = profiles(&bake.profile, project);
    let out = out(bake.out.as_ref(), project);
    if let Some(message) = same_name(&tasks) {
        printer.failure(&message, Some("bake them in separate runs with different --out folders"));
        return Outcome::Usage;
    }
    if bake.check {
        // Nothing is written, the folder neither.
    } else if let Err(error) = std::fs::create_dir_all(&out) {
        let message = format!("cannot make the output folder {}: {}", out.display(), reason(&error));
        printer.failure(&message, None);
        return Outcome::Files;
    }
    let worker = Worker {
        bake,
        project,
        out,
        names: tasks.iter().map(|task| task.output.to_lowercase()).collect(),
        printer,
        dependencies: Dependencies::default(),
        cache: if bake.documents.hermetic {
            None
        } else {
            cache::opened(&bake.cache, project, printer).map(Arc::new)
        },
        hits: AtomicUsize::new(0),
        parameters: Mutex::default(),
    };
    let cost = |task: &Task| worker.cost(task);
    let budget: Option<Budget<'_>> = bake.memory.map(|bytes| (bytes, &cost as _));
    let work = Work { documents: &bake.documents, records: &bake.records, printer, budget };
    let outcome = each(&work, &tasks, &|turn, task, messages| worker.document((turn, task), messages));
    worker.end_cache(tasks.len());
    if outcome == Outcome::Good && bake.documents.paths.is_empty() && bake.documents.shard.is_none() {
        worker.tell_unused();
    }
    let written = bake.depfile.as_ref().map(|file| write(file, &worker.dependencies.text(), printer));
    outcome.max(written.unwrap_or(Outcome::Good))
}

/// Two documents whose outputs would be one file.
fn same_name(tasks: &[Task]) -> Option<String> {
    let mut seen: BTreeMap<String, &Task> = BTreeMap::new();
    for task in tasks {
        // Some file systems do not tell upper case from lower.
        if let Some(other) = seen.insert(task.output.to_lowercase(), task) {
            return Some(format!(
                "{} and {} would both be written to {}.glb",
                other.path, task.path, task.output
            ));
        }
    }
    None
}

struct Worker<'a> {
    bake: &'a Bake,
    project: Option<&'a Project>,
    /// Where outputs go.
    out: PathBuf,
    /// The names of the outputs of all documents, in lower case.
    names: BTreeSet<String>,
    printer: &'a Printer,
    dependencies: Dependencies,
    cache: Option<Arc<Cache>>,
    /// Documents that were found in the cache.
    hits: AtomicUsize,
    /// The names of the parameters of all documents.
    parameters: Mutex<BTreeSet<String>>,
}

impl Worker<'_> {
    /// Bakes a document and its variants, or takes what was baked before.
    fn document(&self, (index, task): (usize, &Task), messages: &mut Vec<Message>) -> Outcome {
        let cached = self.cache.as_deref().map(|cache| (cache, self.key(cache, task)));
        if let Some((cache, key)) = &cached
            && let Some(outcome) = self.known((index, task), (cache, key), messages)
        {
            return outcome;
        }
        let (files, document) = match loaded(task, messages) {
            Ok(loaded) => loaded,
            Err(outcome) => return outcome,
        };
        if task.found && document.is_library() {
            if self.printer.verbose {
                let text = format!("passed over {}: it defines nothing to show", task.path);
                messages.push(Message::Result(text, json!({ "skipped": task.path })));
            }
            return Outcome::Good;
        }
        let mut outcome = Outcome::Good;
        let mut told = Told::default();
        let mut made = Made::default();
        made.record.parameters = document.parameters();
        self.note_parameters(&made.record);
        let variants = std::iter::once(None).chain(document.variants().into_iter().map(Some));
        for variant in variants {
            let options = self.options(task, &document, variant);
            match compile_profiles(&document, &files, &options) {
                Ok(all) => {
                    for mut compiled in all {
                        compiled.warnings =
                            told.only_new(&document, compiled.warnings, options.variant.as_deref());
                        let target = self.target(task, &compiled.file);
                        if let Some(message) = self.taken(task, &compiled.file) {
                            messages.push(message);
                            outcome = outcome.max(Outcome::Errors);
                            continue;
                        }
                        let asset = baked(&task.path, compiled).map_err(|error| {
                            Message::Failure(format!("cannot write {}: {}", target.display(), reason(&error)))
                        });
                        match asset {
                            Ok((asset, bytes)) => {
                                let put = self.put(task, &asset, &bytes, messages);
                                outcome = outcome.max(put);
                                self.tell((task, Some(&document)), &asset, put, messages);
                                made.record.assets.push(asset);
                                made.bytes.extend(bytes);
                            }
                            Err(message) => {
                                messages.push(message);
                                outcome = outcome.max(Outcome::Files);
                            }
                        }
                    }
                }
                Err(list) => {
                    let list = told.only_new(&document, list, options.variant.as_deref());
                    let list = self.with_project(&document, list);
                    messages.push(Message::Diagnostics(list));
                    outcome = outcome.max(Outcome::Errors);
                }
            }
        }
        let read = files.record();
        if self.bake.depfile.is_some() {
            let inputs = read.iter().filter(|record| record.found).map(|record| record.path.as_str());
            self.depend((index, task), &made.record, inputs);
        }
        if let (Some((cache, key)), Outcome::Good) = (cached, outcome) {
            let bytes: Vec<&[u8]> = made.bytes.iter().map(Vec::as_slice).collect();
            cache.keep(&key, &read, &made.record, &bytes);
        }
        outcome
    }

    fn options(&self, task: &Task, document: &Document, variant: Option<String>) -> Options {
        Options {
            variant,
            overrides: self.bake.documents.overrides(document),
            name: task.name().to_owned(),
            path: task.path.clone(),
            no_report: self.bake.no_report,
            beside: true,
            measure: self.bake.measure,
            draft: self.bake.draft,
            keep: self.cache.clone().map(|cache| cache as Arc<dyn Keep>),
            profiles: self.bake.profile.clone(),
            ..Options::default()
        }
    }

    /// Bytes of memory that a document takes, by estimate: of its variants, which are made one after the other, the most. One that
    /// is wrong, or was baked before, takes nothing to speak of.
    fn cost(&self, task: &Task) -> u64 {
        let cached = self.cache.as_deref().map(|cache| (cache, self.key(cache, task)));
        if cached.is_some_and(|(cache, key)| cache.find(&key, &task.root).is_some()) {
            return 0;
        }
        let Ok((files, Ok(document))) = task.load() else { return 0 };
        let variants = std::iter::once(None).chain(document.variants().into_iter().map(Some));
        let costs = variants.map(|variant| {
            let options = self.options(task, &document, variant);
            let found = AssertUnwindSafe(|| estimated_memory(&document, &files, &options).unwrap_or(0));
            catch_unwind(found).unwrap_or(0)
        });
        costs.max().unwrap_or(0)
    }

    /// Everything but files that outputs depend on.
    fn key<'a>(&'a self, cache: &Cache, task: &'a Task) -> Key {
        let bake = self.bake;
        let flags = [bake.no_report, bake.measure, bake.draft].map(|flag| if flag { "yes" } else { "no" });
        let profiles = bake.profile.iter().map(|profile| profile.name());
        let texts = |list: &'a [(String, String)]| {
            list.iter().flat_map(|(name, value)| [name.as_str(), value.as_str()])
        };
        let limits = format!("{:?}", task.limits);
        let sets = texts(&bake.documents.given).chain(["--"]).chain(texts(&bake.documents.set));
        cache.key(
            [task.path.as_str(), task.name(), limits.as_str()]
                .into_iter()
                .chain(flags)
                .chain(profiles)
                .chain(["--"])
                .chain(sets),
        )
    }

    /// What was baked of a document before, put where it belongs; none when it is not known, or not whole.
    fn known(
        &self,
        (index, task): (usize, &Task),
        (cache, key): (&Cache, &Key),
        messages: &mut Vec<Message>,
    ) -> Option<Outcome> {
        let Hit { record, inputs } = cache.find(key, &task.root)?;
        if record.assets.iter().any(|asset| self.taken(task, &asset.file).is_some()) {
            return None;
        }
        self.note_parameters(&record);
        let mut missing = Vec::new();
        for asset in &record.assets {
            let folder = self.folder(task);
            let absent = asset.files.iter().filter(|file| !cache.is_there(&folder.join(&file.name), file));
            if self.bake.check {
                let names: Vec<&str> = absent.map(|file| file.name.as_str()).collect();
                missing.push((names, Vec::new()));
            } else {
                let found: Option<Vec<(&str, Vec<u8>)>> =
                    absent.map(|file| Some((file.name.as_str(), cache.bytes(file)?))).collect();
                missing.push((Vec::new(), found?));
            }
        }
        let document = if record.assets.iter().all(|asset| asset.warnings.is_empty()) {
            None
        } else {
            // Warnings show lines of the texts.
            Some(task.load().ok()?.1.ok()?)
        };
        let mut outcome = Outcome::Good;
        for (asset, (differing, absent)) in record.assets.iter().zip(&missing) {
            let list: Vec<(&str, &[u8])> =
                absent.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
            let put = if differing.is_empty() {
                self.save(task, &asset.file, &list, messages)
            } else {
                self.complain_of(task, differing, messages)
            };
            outcome = outcome.max(put);
            self.tell((task, document.as_ref()), asset, put, messages);
        }
        self.hits.fetch_add(1, Ordering::Relaxed);
        if self.bake.depfile.is_some() {
            self.depend((index, task), &record, inputs.iter().map(String::as_str));
        }
        Some(outcome)
    }

    /// What is said of a file that another document is written to: `a.tall.toml` becomes what a variant `tall` of `a.toml` does.
    fn taken(&self, task: &Task, file: &str) -> Option<Message> {
        let folder = task.output.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let stem = format!("{folder}{}", file.trim_end_matches(".glb")).to_lowercase();
        // A longer name than its own: `a` may be written to `a.tall.glb`, unless that is `a.tall`'s.
        let own = task.output.len();
        let mut ends = stem.match_indices('.').map(|(at, _)| at).chain([stem.len()]).filter(|end| *end > own);
        let other = ends.find_map(|end| self.names.get(&stem[..end]))?;
        let target = self.target(task, file);
        Some(Message::Failure(format!(
            "{} would be written to {}, which belongs to {other}.toml: rename the document, the variant or that document",
            task.path,
            target.display()
        )))
    }

    fn note_parameters(&self, record: &Record) {
        if !self.bake.documents.given.is_empty() {
            let mut all = self.parameters.lock().unwrap_or_else(PoisonError::into_inner);
            all.extend(record.parameters.iter().cloned());
        }
    }

    /// Errors on parameters with the place in the project file that sets them.
    fn with_project(&self, document: &Document, list: Diagnostics) -> Diagnostics {
        let Some(file) = self.project.map(|project| &project.file) else { return list };
        let set = |one: &Diagnostic| {
            let texts = || one.notes.iter().chain([&one.message]);
            let named = |name: &&String| texts().any(|text| text.contains(&format!("--set {name}=")));
            let name =
                (one.code == Code::BadOverride).then(|| file.project.parameters.keys().find(named))??;
            Some(format!("{PROJECT_FILE}:{} sets `{name}`", file.line(file.project.parameters[name].span)))
        };
        let noted = list.into_vec().into_iter().map(|one| match set(&one) {
            Some(note) => one.note(note),
            None => one,
        });
        document.diagnostics(noted.collect())
    }

    /// Tells parameters of the project that no document has.
    fn tell_unused(&self) {
        let Some(file) = self.project.map(|project| &project.file) else { return };
        let known = self.parameters.lock().unwrap_or_else(PoisonError::into_inner);
        let unused = file.project.parameters.iter().filter(|(name, _)| !known.contains(*name));
        let list = unused.map(|(name, value)| {
            let message = format!("no document has the parameter {}", backtick(name));
            let report = Diagnostic::warning(Code::ProjectParameter, message).at(value.span, "sets nothing");
            match closest(name, known.iter().map(String::as_str)) {
                Some(near) => report.help(format!("did you mean `{near}`?")),
                None => report,
            }
        });
        self.printer.diagnostics(&file.diagnostics(list.collect()));
    }

    fn folder(&self, task: &Task) -> PathBuf {
        match task.output.rsplit_once('/') {
            Some((folder, _)) => self.out.join(folder),
            None => self.out.clone(),
        }
    }

    fn target(&self, task: &Task, file: &str) -> PathBuf {
        self.folder(task).join(file)
    }

    /// Writes an asset, or holds it against the files that there are.
    fn put(&self, task: &Task, asset: &Baked, bytes: &[Vec<u8>], messages: &mut Vec<Message>) -> Outcome {
        let names = asset.files.iter().map(|file| file.name.as_str());
        let list: Vec<(&str, &[u8])> = names.zip(bytes.iter().map(Vec::as_slice)).collect();
        if !self.bake.check {
            return self.save(task, &asset.file, &list, messages);
        }
        let folder = self.folder(task);
        let other =
            |(name, bytes): &&(&str, &[u8])| std::fs::read(folder.join(name)).ok().as_deref() != Some(*bytes);
        let differing: Vec<&str> = list.iter().filter(other).map(|(name, _)| *name).collect();
        self.complain_of(task, &differing, messages)
    }

    fn save(&self, task: &Task, file: &str, list: &[(&str, &[u8])], messages: &mut Vec<Message>) -> Outcome {
        if list.is_empty() {
            return Outcome::Good;
        }
        match save(&self.folder(task), list) {
            Ok(()) => Outcome::Good,
            Err(error) => {
                let target = self.target(task, file);
                messages.push(Message::Failure(format!(
                    "cannot write {}: {}",
                    target.display(),
                    reason(&error)
                )));
                Outcome::Files
            }
        }
    }

    /// Names files that are not what they should be.
    fn complain_of(&self, task: &Task, differing: &[&str], messages: &mut Vec<Message>) -> Outcome {
        let message = |name: &&str| {
            Message::Failure(format!("{} is not what is baked", self.target(task, name).display()))
        };
        messages.extend(differing.iter().map(message));
        if differing.is_empty() { Outcome::Good } else { Outcome::Errors }
    }

    /// Notes what a document was made into, for Make and Ninja.
    fn depend<'a>(
        &self,
        (index, task): (usize, &Task),
        record: &Record,
        inputs: impl Iterator<Item = &'a str>,
    ) {
        let files = record.assets.iter().flat_map(|asset| &asset.files);
        let outputs = files.map(|file| self.target(task, &file.name).display().to_string()).collect();
        let project = self.project.map(|project| from_here(project.place()).display().to_string());
        let inputs = inputs.map(|path| shown(task, path)).chain(project).collect();
        self.dependencies.add(index, outputs, inputs);
    }

    /// Tells what was baked, where that went well.
    fn tell(
        &self,
        (task, document): (&Task, Option<&Document>),
        asset: &Baked,
        put: Outcome,
        messages: &mut Vec<Message>,
    ) {
        if put != Outcome::Good {
            return;
        }
        let target = self.target(task, &asset.file).display().to_string();
        let mut facts = asset.facts.clone();
        facts["asset"] = json!(target);
        messages.push(Message::Result(format!("{target}  {}", asset.line), facts));
        if let (Some(document), false) = (document, asset.warnings.is_empty()) {
            messages.push(Message::Diagnostics(document.diagnostics(asset.warnings.clone())));
        }
    }

    /// Notes what is to be kept of the cache, and tells how much of it was used.
    fn end_cache(&self, documents: usize) {
        let Some(cache) = &self.cache else { return };
        if let Some(trouble) = cache.finish() {
            let message = format!("the cache cannot be written: {trouble}");
            self.printer.warning(&message);
        }
        cache.remote_troubles().iter().for_each(|trouble| self.printer.warning(trouble));
        if self.printer.verbose {
            let hits = self.hits.load(Ordering::Relaxed);
            let [found, kept] = cache.shape_counts();
            let text = format!(
                "cache: {hits} of {documents} documents were baked before; of the rest {found} shapes, {kept} more are kept now"
            );
            let shapes = json!({ "found": found, "kept": kept });
            self.printer.result(
                &text,
                &json!({ "cache": { "hits": hits, "documents": documents, "shapes": shapes } }),
            );
        }
    }
}

/// What came of a document, and the bytes of all its files.
#[derive(Default)]
struct Made {
    record: Record,
    bytes: Vec<Vec<u8>>,
}

/// The path of an input from the working directory, where it lies in that.
pub(crate) fn shown(task: &Task, path: &str) -> String {
    let whole = task.root.join(path);
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| whole.strip_prefix(here).ok().map(Path::to_path_buf));
    below.unwrap_or(whole).display().to_string()
}

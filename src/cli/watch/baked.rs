//! One bake of the watched document: all of its variants, for each of its profiles.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::seen::Seen;
use crate::cache::Memory;
use crate::cli::arguments::{Documents, Watch};
use crate::cli::baked::line;
use crate::compile::{Compiled, Options, compile_profiles};
use crate::geometry::number::Bounds;
use crate::language::Document;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::SourceMap;
use crate::preview::heat::Measured;
use crate::preview::{self, Moment, Stage};
use crate::project::{Task, Told, reason};
use crate::realize::Keep;

/// What came of a bake.
pub(super) struct Bake<'a> {
    task: &'a Task,
    /// What was read; none where the project's folder cannot be reached.
    seen: Option<Arc<Seen>>,
    /// What is baked; nothing where any part of it failed.
    pub(super) assets: Vec<Arc<Asset>>,
    /// Errors and warnings of the document.
    pub(super) diagnostics: Option<Diagnostics>,
    /// What is wrong and has no place in a document.
    pub(super) failure: Option<String>,
    /// The texts of the document.
    pub(super) sources: Option<Arc<SourceMap>>,
}

impl<'a> Bake<'a> {
    /// Bakes a document.
    pub(super) fn of(task: &'a Task, asked: (&Watch, &Documents), memory: &Arc<Memory>) -> Self {
        let mut bake =
            Self { task, seen: None, assets: Vec::new(), diagnostics: None, failure: None, sources: None };
        let seen = match Seen::new(&task.root) {
            Ok(seen) => Arc::new(seen),
            Err(error) => {
                bake.failure = Some(format!("{}: {}", task.root.display(), reason(&error)));
                return bake;
            }
        };
        if catch_unwind(AssertUnwindSafe(|| bake.document(asked, memory, &seen))).is_err() {
            let message = format!("{}: Kiln failed inside; please report this document as a bug", task.path);
            bake = Self { failure: Some(message), assets: Vec::new(), ..bake };
        }
        bake.seen = Some(seen);
        bake
    }

    fn document(&mut self, (watch, documents): (&Watch, &Documents), memory: &Arc<Memory>, seen: &Arc<Seen>) {
        let task = self.task;
        let document = match Document::load_within(&task.path, seen.as_ref(), task.limits) {
            Ok(document) => Arc::new(document),
            Err(list) => {
                self.sources = Some(Arc::clone(list.sources()));
                self.diagnostics = Some(list);
                return;
            }
        };
        self.sources = Some(Arc::clone(document.sources()));
        let variants: Vec<Option<String>> =
            std::iter::once(None).chain(document.variants().into_iter().map(Some)).collect();
        let options = |variant: &Option<String>| Options {
            variant: variant.clone(),
            overrides: documents.overrides(&document),
            name: task.name().to_owned(),
            path: task.path.clone(),
            profiles: watch.profile.clone(),
            origins: true,
            draft: watch.draft,
            keep: Some(Arc::clone(memory) as Arc<dyn Keep>),
            ..Options::default()
        };
        let compile =
            |variant: &Option<String>| compile_profiles(&document, seen.as_ref(), &options(variant));
        // Waking a second thread costs more than a small document takes.
        let results: Vec<_> = if let [one] = variants.as_slice() {
            vec![compile(one)]
        } else {
            variants.par_iter().map(compile).collect()
        };
        let good = results.iter().all(Result::is_ok);
        let mut told = Told::default();
        let mut found = Vec::new();
        let mut baked = Vec::new();
        for (variant, result) in variants.iter().zip(results) {
            let mut tell = |list| found.extend(told.only_new(&document, list, variant.as_deref()).into_vec());
            match result {
                Ok(all) => {
                    for mut compiled in all {
                        let none = document.diagnostics(Vec::new());
                        tell(std::mem::replace(&mut compiled.warnings, none));
                        let source = Source {
                            document: Arc::clone(&document),
                            seen: Arc::clone(seen),
                            options: options(variant),
                        };
                        baked.push(Arc::new(Asset::new(compiled, source)));
                    }
                }
                Err(list) => tell(list),
            }
        }
        self.diagnostics = Some(document.diagnostics(found));
        if good {
            self.assets = baked;
        }
    }

    /// Whether there is something to show.
    pub(super) fn is_good(&self) -> bool {
        !self.assets.is_empty()
    }

    /// Whether a file that was read holds something else by now, or can be read at all.
    pub(super) fn has_changed(&self) -> bool {
        self.seen.as_ref().map_or_else(|| Seen::new(&self.task.root).is_ok(), |seen| seen.has_changed())
    }

    /// Where the files stand that the bake depends on.
    pub(super) fn paths(&self) -> BTreeSet<PathBuf> {
        let own = self.task.root.join(&self.task.path);
        self.seen.iter().flat_map(|seen| seen.paths()).chain([own]).collect()
    }
}

/// A baked file that is shown.
pub(super) struct Asset {
    /// Names its bytes: a part of their hash.
    pub(super) key: String,
    pub(super) compiled: Compiled,
    /// What it was made from.
    source: Source,
    drawn: [OnceLock<Result<Drawn, String>>; LEVELS],
    deviations: OnceLock<Vec<Option<Measured>>>,
}

/// Levels of detail that are shown at most: as many as a document may ask for.
const LEVELS: usize = 8;

/// What makes an asset.
struct Source {
    document: Arc<Document>,
    seen: Arc<Seen>,
    options: Options,
}

/// A file that is read for drawing, and the box around it at rest.
pub(super) type Drawn = (preview::asset::Asset, Bounds);

impl Asset {
    fn new(compiled: Compiled, source: Source) -> Self {
        let key = blake3::hash(&compiled.bytes).to_hex()[..32].to_owned();
        Self { key, compiled, source, drawn: Default::default(), deviations: OnceLock::new() }
    }

    /// What there is to say of it, in a line.
    pub(super) fn line(&self) -> String {
        format!("{}  {}", self.compiled.file, line(&self.compiled))
    }

    /// Its clips, with their seconds.
    pub(super) fn clips(&self) -> impl Iterator<Item = (&str, f64)> {
        let clips = self.compiled.report.iter().flat_map(|report| &report.clips);
        clips.map(|(name, facts)| (name.as_str(), facts.duration))
    }

    /// For drawing at a level of detail; read when it is first asked for.
    pub(super) fn drawn(&self, level: usize) -> Result<&Drawn, &str> {
        let level = level.min(LEVELS - 1);
        let read = || {
            let mut asset = preview::asset::read(&self.compiled.bytes).map_err(|error| error.to_string())?;
            asset.show_level(level);
            let rest = Stage::new(&asset, &Moment::default()).map_err(|error| error.to_string())?;
            Ok((asset, rest.bounds))
        };
        self.drawn[level].get_or_init(read).as_ref().map_err(String::as_str)
    }

    /// How many levels of detail its file holds.
    pub(super) fn levels(&self) -> usize {
        let lods = self.compiled.report.iter().flat_map(|report| report.lods.values());
        lods.map(Vec::len).max().unwrap_or(1)
    }

    /// For each mesh how far its triangles lie from the true surface; none of any where its files hold something else by
    /// now. Baked once more for that, when it is first asked for.
    pub(super) fn deviations(&self) -> &[Option<Measured>] {
        self.deviations.get_or_init(|| {
            let Source { document, seen, options } = &self.source;
            let options = Options { deviations: true, origins: false, keep: None, ..options.clone() };
            let baked = compile_profiles(document, seen.as_ref(), &options).unwrap_or_default();
            let same = |one: &Compiled| one.file == self.compiled.file && one.bytes == self.compiled.bytes;
            baked.into_iter().find(same).map(|one| one.deviations).unwrap_or_default()
        })
    }

    /// File and line of the definition that a triangle comes from.
    pub(super) fn place(&self, mesh: usize, corners: [usize; 3]) -> Option<(&str, usize)> {
        let span = self.compiled.origins.as_ref()?.place(mesh, corners)?;
        self.source.document.sources().locate(span).map(|place| (place.file, place.line))
    }
}

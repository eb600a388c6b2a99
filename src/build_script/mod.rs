//! Baking from a game's `build.rs`.
//!
//! Promise: every document of a folder is baked into `OUT_DIR`; Cargo is told each file that was read, and the folder for new
//! ones; diagnostics become Cargo's errors and warnings; a Rust module names every asset, node, mesh, material, clip,
//! joint, socket and morph target, so that a name that is gone does not compile. Files whose bytes stay the same are not
//! touched. The module's text depends on the assets and on nothing else, but for the folder of outputs.
//! A `kiln.toml` in the root says what is not said here; where a cache is named, what was baked before is taken from it.
//!
//! Cost: that of the documents, in parallel; with a cache, of those that changed.

mod baker;
mod module;
mod names;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use crate::cache::Cache;
use crate::compile::profile_of;
use crate::gltf::Profile;
use crate::language::PROJECT_FILE;
use crate::project::{Project, ProjectFault, Task, collect, reason, save};
use baker::{Baker, Document, Output};
use module::Asset;

/// The bake of a folder, from a build script.
///
/// ```no_run
/// kiln::Build::new("assets").run();
/// ```
///
/// The game then includes the module that was written:
///
/// ```ignore
/// mod assets {
///     include!(concat!(env!("OUT_DIR"), "/assets.rs"));
/// }
/// let bytes: &[u8] = assets::vase::BYTES;      // of assets/vase.toml
/// let lid: &str = assets::vase::nodes::LID;    // a name that is gone does not compile
/// ```
#[derive(Clone, Debug)]
pub struct Build {
    folder: PathBuf,
    root: Option<PathBuf>,
    out: Option<PathBuf>,
    parameters: Vec<(String, String)>,
    profiles: Vec<Profile>,
    report: bool,
    cache: Option<(PathBuf, u64)>,
}

/// What was baked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuiltAssets {
    /// The `.glb` files, in the order of their documents.
    pub files: Vec<PathBuf>,
    /// The Rust module.
    pub module: PathBuf,
    /// What a person should know though nothing is wrong, rendered.
    pub warnings: Vec<String>,
    /// What the bake depends on: every file that was read, and the folder.
    pub inputs: Vec<PathBuf>,
}

/// Why nothing, or not all, was baked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", errors.join("\n"))]
pub struct BuildFailure {
    /// Each rendered with its place, as the command line does.
    pub errors: Vec<String>,
    /// What the bake depends on, as far as it came.
    pub inputs: Vec<PathBuf>,
}

/// Triangles from which on a bake without optimization is worth a hint.
const MANY: u64 = 100_000;

impl Build {
    /// A bake of all documents in a folder and in its folders, or of one document.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
            root: None,
            out: None,
            parameters: Vec::new(),
            profiles: Vec::new(),
            report: true,
            cache: None,
        }
    }

    /// The folder that no document may read outside of; without it, the folder of the documents.
    #[must_use]
    pub fn root(mut self, root: impl Into<PathBuf>) -> Self {
        self.root = Some(root.into());
        self
    }

    /// Where outputs go; without it, `OUT_DIR`.
    #[must_use]
    pub fn out_dir(mut self, out: impl Into<PathBuf>) -> Self {
        self.out = Some(out.into());
        self
    }

    /// Sets a parameter of all documents, as `--set` does.
    #[must_use]
    pub fn set(mut self, name: impl Into<String>, value: impl std::fmt::Display) -> Self {
        self.parameters.push((name.into(), value.to_string()));
        self
    }

    /// For whom files are, whatever documents say: `core`, which every engine opens, when nothing is named anywhere. Of
    /// several profiles each file is an asset of its own in the module.
    #[must_use]
    pub fn profile(mut self, profile: Profile) -> Self {
        self.profiles.push(profile);
        self
    }

    /// Takes what was baked before from a folder, and keeps there what is baked now, up to a number of bytes. A folder
    /// that cannot be used costs a warning. Without it nothing is kept, whatever `kiln.toml` says.
    #[must_use]
    pub fn cache(mut self, folder: impl Into<PathBuf>, limit: u64) -> Self {
        self.cache = Some((folder.into(), limit));
        self
    }

    /// Measures nothing and checks no assertions: the fastest bake, without promises.
    #[must_use]
    pub fn without_report(mut self) -> Self {
        self.report = false;
        self
    }

    /// Bakes, and talks to Cargo on standard output. Ends the process with code 1 when there are errors, after all of
    /// them are told.
    pub fn run(self) {
        let (lines, good) = match self.bake() {
            Ok(done) => (told(&done.inputs, "warning", &done.warnings), true),
            Err(failure) => (told(&failure.inputs, "error", &failure.errors), false),
        };
        say(&lines);
        if !good {
            std::process::exit(1);
        }
    }

    /// Bakes, and says nothing.
    ///
    /// # Errors
    /// All errors of all documents; files that cannot be read or written. What could be baked is written all the same,
    /// but the module stays as it was.
    pub fn bake(&self) -> Result<BuiltAssets, BuildFailure> {
        let fail = |error: String| BuildFailure { errors: vec![error], inputs: vec![self.folder.clone()] };
        let out = self.out.clone().or_else(|| std::env::var_os("OUT_DIR").map(PathBuf::from));
        let out = out.ok_or_else(|| {
            fail(
                "OUT_DIR is not set: call this from a build script, or name a folder with `out_dir`"
                    .to_owned(),
            )
        })?;
        let (project, tasks) = self.tasks().map_err(|error| BuildFailure {
            errors: vec![error],
            inputs: vec![self.folder.clone(), self.root_folder().join(PROJECT_FILE)],
        })?;
        if tasks.is_empty() {
            return Err(fail(format!("no document (.toml) in {}", self.folder.display())));
        }
        let mut done = BuiltAssets { module: out.join(self.module_name()), ..BuiltAssets::default() };
        let cache = self.opened(&mut done.warnings).map(Arc::new);
        let baker = self.baker(project.as_ref(), cache.as_ref());
        let baked: Vec<Document> = tasks.par_iter().map(|task| baker.document(task)).collect();
        done.warnings.extend(cache.and_then(|cache| cache.finish()).map(|trouble| unusable(&trouble)));
        let mut inputs = BTreeSet::from([self.folder.clone()]);
        inputs.extend(project.map(|_| self.root_folder().join(PROJECT_FILE)));
        let mut errors = Vec::new();
        let mut assets = Vec::new();
        let mut triangles = 0;
        for document in baked {
            inputs.extend(document.inputs);
            errors.extend(document.errors);
            done.warnings.extend(document.warnings);
            for Output { folder, file, files, facts } in document.outputs {
                let place = if folder.is_empty() { out.clone() } else { out.join(&folder) };
                triangles += facts.triangles;
                let written =
                    files.iter().try_for_each(|(name, bytes)| unless_same(&place.join(name), bytes));
                match written {
                    Ok(()) => done.files.push(place.join(&file)),
                    Err(error) => errors.push(error),
                }
                let bytes = files.first().map(|(_, bytes)| bytes.as_slice()).unwrap_or_default();
                assets.push(Asset::new(&folder, &file, bytes, facts.bounds));
            }
        }
        done.inputs = inputs.into_iter().collect();
        let relative = std::env::var_os("OUT_DIR").is_some_and(|own| Path::new(&own) == out);
        let text = module::text(&assets, (!relative).then_some(out.as_path()));
        match text {
            Ok(text) if errors.is_empty() => {
                if let Err(error) = unless_same(&done.module, text.as_bytes()) {
                    errors.push(error);
                }
            }
            Ok(_) => {}
            Err(error) => errors.push(error),
        }
        if !errors.is_empty() {
            return Err(BuildFailure { errors, inputs: done.inputs });
        }
        if cfg!(debug_assertions) && triangles >= MANY {
            done.warnings.push(SLOW.to_owned());
        }
        Ok(done)
    }

    /// `assets.rs` for the folder `assets`.
    fn module_name(&self) -> String {
        let stem = self.folder.file_stem().map_or_else(|| "assets".into(), |stem| stem.to_string_lossy());
        format!("{}.rs", names::module(&stem))
    }

    /// The folder that no document may read outside of.
    fn root_folder(&self) -> &Path {
        self.root.as_deref().unwrap_or(&self.folder)
    }

    /// The documents, and the project whose file lies in the root; all of the project's where the folder is its own.
    fn tasks(&self) -> Result<(Option<Project>, Vec<Task>), String> {
        let root = self.root_folder();
        let file = root.join(PROJECT_FILE);
        let project =
            file.is_file().then(|| Project::load(&file)).transpose().map_err(|fault| match fault {
                ProjectFault::Wrong(list) => list.render(false),
                ProjectFault::Unreachable(message) => message,
            })?;
        let tasks = match &project {
            Some(project) if self.folder.canonicalize().is_ok_and(|folder| folder == project.root) => {
                project.tasks().map_err(|list| list.render(false))?
            }
            _ => collect(&self.folder, root.is_dir().then_some(root))?,
        };
        Ok((project, tasks))
    }

    fn opened(&self, warnings: &mut Vec<String>) -> Option<Cache> {
        let (folder, limit) = self.cache.as_ref()?;
        Cache::open(folder, *limit)
            .map_err(|error| warnings.push(format!("no cache in {}: {}", folder.display(), reason(&error))))
            .ok()
    }

    fn baker<'a>(&'a self, project: Option<&Project>, cache: Option<&'a Arc<Cache>>) -> Baker<'a> {
        let file = project.map(|project| &project.file.project);
        let of_project = file.and_then(|file| file.profiles.as_ref());
        let profiles = match of_project {
            Some(list) if self.profiles.is_empty() => {
                list.value.iter().map(|name| profile_of(name.value)).collect()
            }
            _ => self.profiles.clone(),
        };
        let given = file.into_iter().flat_map(|file| &file.parameters);
        let given = given.map(|(name, text)| (name.clone(), text.value.0.clone())).collect();
        Baker { build: self, profiles, given, cache }
    }

    /// The path of an input as the build script would write it: below the folder where that is the root.
    fn shown(&self, task: &Task, path: &str) -> PathBuf {
        match (&self.root, self.folder.is_dir()) {
            (Some(root), _) => root.join(path),
            (None, true) => self.folder.join(path),
            (None, false) => task.root.join(path),
        }
    }
}

/// A hint for bakes that take several times longer than they need.
const SLOW: &str = "this bake would be five to seven times faster with optimized build scripts; write in Cargo.toml:\n\
                    [profile.dev.build-override]\nopt-level = 3";

fn unusable(trouble: &str) -> String {
    format!("the cache cannot be written: {trouble}")
}

/// Writes a file whose bytes are others than these; Cargo goes by the time of a file.
fn unless_same(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if std::fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    save(folder, &[(&name, bytes)])
        .map_err(|error| format!("cannot write {}: {}", path.display(), reason(&error)))
}

/// Lines for Cargo: what to watch, and what to tell.
fn told(inputs: &[PathBuf], kind: &str, messages: &[String]) -> String {
    let mut text = String::new();
    for input in inputs {
        let _ = writeln!(text, "cargo::rerun-if-changed={}", input.display());
    }
    // Cargo takes a message line by line.
    for line in messages.iter().flat_map(|message| message.lines()) {
        let _ = writeln!(text, "cargo::{kind}={line}");
    }
    text
}

#[expect(clippy::print_stdout, reason = "a build script talks to Cargo on standard output")]
fn say(text: &str) {
    print!("{text}");
}

#[cfg(test)]
mod tests {
    use super::told;

    #[test]
    fn cargo_takes_messages_line_by_line() {
        let lines = told(
            &["assets".into(), "assets/a.toml".into()],
            "error",
            &["error: no\n --> a.toml:1".to_owned()],
        );
        assert_eq!(
            lines,
            "cargo::rerun-if-changed=assets\ncargo::rerun-if-changed=assets/a.toml\n\
             cargo::error=error: no\ncargo::error= --> a.toml:1\n"
        );
    }
}

//! `kiln cache`, and which cache a command uses.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::json;

use super::Outcome;
use super::arguments::{CacheAction, CacheCommand, CacheOptions};
use super::baked::size;
use super::output::Printer;
use super::project::{from_here, loaded_project, project_here};
use crate::cache::{Cache, RemoteOptions, Stats, clear, stats, verify};
use crate::project::{Project, reason};

/// The most that a cache's folder takes where nothing is said.
const LIMIT: u64 = 1_000_000_000;

/// The folder that an argument or the environment names, else the project.
fn folder(written: Option<&PathBuf>, project: Option<&Project>) -> Option<PathBuf> {
    let named = || std::env::var_os("KILN_CACHE").filter(|value| !value.is_empty()).map(PathBuf::from);
    let of_project = || {
        let project = project?;
        let folder = project.file.project.cache.as_ref()?.value.folder.as_ref()?;
        Some(from_here(project.path(&folder.value)))
    };
    written.cloned().or_else(named).or_else(of_project)
}

/// The cache that a command uses, if any. One that cannot be used costs a warning and nothing else.
pub(crate) fn opened(options: &CacheOptions, project: Option<&Project>, printer: &Printer) -> Option<Cache> {
    if options.no_cache {
        return None;
    }
    let remote = remote(options, project);
    let Some(folder) = folder(options.cache.as_ref(), project) else {
        if remote.is_some() {
            printer
                .warning("a shared cache needs a folder of this machine's own: name one with `--cache DIR`");
        }
        return None;
    };
    let of_project = project.and_then(|project| project.file.project.cache.as_ref()?.value.limit);
    let limit = options.cache_limit.or(of_project.map(|limit| limit.value.0)).unwrap_or(LIMIT);
    let opened = Cache::open(&folder, limit)
        .map_err(|error| format!("no cache in {}: {}", folder.display(), reason(&error)));
    let cache = opened.map_err(|message| printer.warning(&message)).ok()?;
    let Some(remote) = remote else { return Some(cache) };
    match cache.with_remote(&remote) {
        Ok(cache) => Some(cache),
        Err(message) => {
            printer.warning(&format!("no shared cache: {message}"));
            Cache::open(&folder, limit).ok()
        }
    }
}

/// The shared cache that arguments or the environment name, else the project.
fn remote(options: &CacheOptions, project: Option<&Project>) -> Option<RemoteOptions> {
    let of_project = project.and_then(|project| project.file.project.cache.as_ref()?.value.remote.as_ref());
    let of_project = of_project.map(|remote| &remote.value);
    let named = || std::env::var("KILN_REMOTE_CACHE").ok().filter(|value| !value.is_empty());
    let said = options.remote_cache.clone().or_else(named);
    let trusted = said.is_some();
    let url = said.or_else(|| of_project.map(|remote| remote.url.value.clone()))?;
    let seconds = options.remote_cache_timeout.or(of_project.map(|remote| remote.timeout)).unwrap_or(10.0);
    Some(RemoteOptions {
        url,
        writes: options.remote_cache_write || of_project.is_some_and(|remote| remote.write),
        trusted,
        timeout: Duration::from_secs_f64(seconds),
    })
}

/// Looks after a cache.
pub(crate) fn run(command: &CacheCommand, printer: &Printer) -> Outcome {
    let project = match project_here().map(|file| loaded_project(&file, printer)).transpose() {
        Ok(project) => project,
        Err(outcome) => return outcome,
    };
    let Some(folder) = folder(command.cache.as_ref(), project.as_ref()) else {
        let help = "write `--cache DIR`, set KILN_CACHE, or give the project a `[cache]` with a `folder`";
        printer.failure("no cache is named", Some(help));
        return Outcome::Usage;
    };
    let done = match command.action {
        CacheAction::Stats => stats(&folder).map(|found| tell(&folder, "holds", &found, printer)),
        CacheAction::Clear => clear(&folder).map(|found| tell(&folder, "held", &found, printer)),
        CacheAction::Verify => verify(&folder).map(|found| {
            let outcome = tell(&folder, "holds", &found.whole, printer);
            if found.broken == 0 {
                return outcome;
            }
            let files = if found.broken == 1 { "file is" } else { "files are" };
            printer.failure(&format!("{} broken {files} taken out", found.broken), None);
            Outcome::Errors
        }),
    };
    done.unwrap_or_else(|error| {
        printer.failure(&format!("{}: {}", folder.display(), reason(&error)), None);
        Outcome::Files
    })
}

fn tell(
    folder: &Path,
    verb: &str,
    Stats { documents, objects, shapes, bytes }: &Stats,
    printer: &Printer,
) -> Outcome {
    let whole = usize::try_from(*bytes).unwrap_or(usize::MAX);
    let text = format!(
        "{} {verb} {documents} documents, {objects} objects, {shapes} shapes, {}",
        folder.display(),
        size(whole)
    );
    let object = json!({ "cache": folder.display().to_string(), "documents": documents, "objects": objects, "shapes": shapes, "bytes": bytes });
    printer.result(&text, &object);
    Outcome::Good
}

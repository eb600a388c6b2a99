//! Waits for changes in the folders of files.
//!
//! Folders are watched, not files: editors that save by rename leave a watch on a file with nothing. Of a file that is
//! not there the nearest folder above it is watched. A folder that is itself moved or removed is watched anew.
//!
//! Where the system gives no more watches, the wait ends every [`POLL`].

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher as _};

/// How often files are looked at where the system does not tell of changes.
const POLL: Duration = Duration::from_millis(500);

/// The folders of some files.
pub(super) struct Folders {
    sender: Sender<notify::Result<Event>>,
    events: Receiver<notify::Result<Event>>,
    /// None where the system does not tell of all changes.
    watcher: Option<RecommendedWatcher>,
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
    /// Whether a folder that is watched may be another one by now.
    moved: bool,
    complained: bool,
}

impl Folders {
    pub(super) fn new() -> Self {
        let (sender, events) = channel();
        Self {
            sender,
            events,
            watcher: None,
            files: BTreeSet::new(),
            folders: BTreeSet::new(),
            moved: true,
            complained: false,
        }
    }

    /// Watches the folders of these files from now on; says, once, if changes are found late.
    pub(super) fn follow(&mut self, files: BTreeSet<PathBuf>) -> Option<String> {
        let folders: BTreeSet<PathBuf> = files.iter().filter_map(|file| folder_of(file)).collect();
        self.files = files;
        if folders == self.folders && !self.moved {
            return None;
        }
        self.moved = false;
        let made = watcher(&self.sender, &folders);
        self.folders = folders;
        let complaint = made
            .as_ref()
            .err()
            .map(|error| format!("changes are found by looking every {} ms, for {error}", POLL.as_millis()));
        self.watcher = made.ok();
        complaint.filter(|_| !std::mem::replace(&mut self.complained, true))
    }

    /// Waits until one of the files may have changed.
    pub(super) fn wait(&mut self) {
        loop {
            let event = if self.watcher.is_some() {
                self.events.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                self.events.recv_timeout(POLL)
            };
            match event {
                Ok(event) if self.concerns(&event) => return,
                Ok(_) => {}
                Err(RecvTimeoutError::Timeout) => return,
                // It holds a sender of its own, so this cannot be; a pause makes it harmless.
                Err(RecvTimeoutError::Disconnected) => return thread::sleep(POLL),
            }
        }
    }

    /// Takes all that happens until a moment, and what happened before.
    pub(super) fn gather(&mut self, until: Instant) {
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.events.recv_timeout(left) {
                Ok(event) => {
                    self.concerns(&event);
                }
                Err(_) => return,
            }
        }
    }

    /// Whether an event tells of one of the files, or of a folder on its way.
    fn concerns(&mut self, event: &notify::Result<Event>) -> bool {
        let Ok(event) = event else { return true };
        if matches!(event.kind, EventKind::Access(_)) {
            return false;
        }
        let above = |paths: &BTreeSet<PathBuf>| {
            event.paths.iter().any(|path| paths.iter().any(|other| other.starts_with(path)))
        };
        self.moved |= above(&self.folders);
        event.need_rescan() || event.paths.is_empty() || above(&self.files)
    }
}

/// The nearest folder above a file that there is.
fn folder_of(file: &Path) -> Option<PathBuf> {
    file.ancestors().skip(1).find(|folder| folder.is_dir()).map(Path::to_path_buf)
}

fn watcher(
    sender: &Sender<notify::Result<Event>>,
    folders: &BTreeSet<PathBuf>,
) -> notify::Result<RecommendedWatcher> {
    let mut watcher = notify::recommended_watcher(sender.clone())?;
    for folder in folders {
        match watcher.watch(folder, RecursiveMode::NonRecursive) {
            Ok(()) => {}
            // It went away a moment ago; then its files have changed.
            Err(error) if matches!(error.kind, notify::ErrorKind::PathNotFound) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(watcher)
}

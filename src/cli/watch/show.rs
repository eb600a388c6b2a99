//! What the page shows: the last good files, and what came of the last bake.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};

use super::baked::{Asset, Bake};
use super::joints;

/// What is shown at a time.
pub(super) struct Show {
    /// Counts the bakes.
    pub(super) revision: u64,
    /// What the page is told, as JSON on one line.
    pub(super) text: String,
    /// The texts of the document, as JSON.
    pub(super) sources: String,
    /// The files of the last bake that went well.
    pub(super) assets: Vec<Arc<Asset>>,
    /// Whether that was the last one.
    pub(super) good: bool,
}

/// Where a show is put up, and where others wait for the next one.
pub(super) struct Stand {
    show: Mutex<Arc<Show>>,
    changed: Condvar,
}

impl Stand {
    pub(super) fn new() -> Self {
        let text = json!({ "revision": 0, "good": true, "assets": [], "diagnostics": [] }).to_string();
        let empty = Show { revision: 0, text, sources: "[]".to_owned(), assets: Vec::new(), good: true };
        Self { show: Mutex::new(Arc::new(empty)), changed: Condvar::new() }
    }

    /// What is shown now.
    pub(super) fn now(&self) -> Arc<Show> {
        Arc::clone(&self.lock())
    }

    /// What is shown once that is later than a revision; none when patience ends before.
    pub(super) fn after(&self, revision: u64, patience: Duration) -> Option<Arc<Show>> {
        let waits = |show: &mut Arc<Show>| show.revision <= revision;
        let waited = self.changed.wait_timeout_while(self.lock(), patience, waits);
        let (show, _) = waited.unwrap_or_else(PoisonError::into_inner);
        (show.revision > revision).then(|| Arc::clone(&show))
    }

    /// Shows what came of a bake. Where nothing good did, the last good files stay.
    pub(super) fn put(&self, bake: &Bake<'_>, took: Duration, document: &str) {
        let mut show = self.lock();
        let revision = show.revision + 1;
        let good = bake.is_good();
        let assets = if good { bake.assets.clone() } else { show.assets.clone() };
        let diagnostics = bake.diagnostics.as_ref();
        let text = json!({
            "revision": revision,
            "document": document,
            "good": good,
            "milliseconds": took.as_secs_f64() * 1e3,
            "failure": bake.failure,
            "diagnostics": diagnostics.map_or_else(|| json!([]), |list| list.to_json()),
            "rendered": diagnostics.map_or_else(String::new, |list| list.render(false)),
            "assets": assets.iter().map(|asset| described(asset)).collect::<Vec<_>>(),
        });
        let sources = bake.sources.iter().flat_map(|sources| {
            sources.files().map(|id| json!({ "file": sources.path(id), "text": sources.text(id) }))
        });
        let sources = Value::Array(sources.collect()).to_string();
        *show = Arc::new(Show { revision, text: text.to_string(), sources, assets, good });
        drop(show);
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Arc<Show>> {
        self.show.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn described(asset: &Asset) -> Value {
    let clips = asset.clips().map(|(name, duration)| json!({ "name": name, "duration": duration }));
    json!({
        "key": asset.key,
        "file": asset.compiled.file,
        "line": asset.line(),
        "clips": clips.collect::<Vec<_>>(),
        "levels": asset.levels(),
        "joints": joints::limits(&asset.compiled.joints),
    })
}

//! `kiln watch`: bakes a document whenever it, or a file that it reads, is saved, and shows what was baked in a page.
//!
//! Promise: the page shows the bytes that `bake` would write; the first change is acted on at once, those that follow
//! within [`MERGE`] are one; what is wrong is told on the terminal and in the page, where the last good model stays; no
//! state of the files ends the watch, and what is mended is seen. Nothing is done while nothing changes. The page is
//! served on loopback alone.
//! No promise: a bake that runs is finished before the next begins; the document itself is baked whole; the project file is read
//! once, at the start.

mod answer;
mod baked;
mod folders;
mod heat;
mod joints;
mod request;
mod seen;
mod server;
mod show;

use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::json;

use super::Outcome;
use super::arguments::{Documents, Watch};
use super::baked::line;
use super::output::Printer;
use super::project::{profiles, single};
use super::three::Three;
use crate::cache::Memory;
use crate::compile::Compiled;
use crate::project::{Task, reason, save};
use answer::Site;
use baked::Bake;
use folders::Folders;
use show::Stand;

/// Changes within this time of the first are one.
const MERGE: Duration = Duration::from_millis(30);

/// Errors of files that are still being written are held back for no longer than this.
const PATIENCE: Duration = Duration::from_millis(300);

/// Bytes of realized shapes that are remembered from bake to bake.
const REMEMBERED: usize = 256 << 20;

pub(crate) fn run(watch: &mut Watch, printer: &Printer) -> Outcome {
    let given = (watch.root.as_deref(), watch.set.as_slice());
    let (project, task, documents) = match single(&watch.file, given, printer) {
        Ok(single) => single,
        Err(outcome) => return outcome,
    };
    watch.profile = profiles(&watch.profile, project.as_ref());
    let three = match Three::find(watch.three.as_deref(), &task.root) {
        Ok(three) => three,
        Err(message) => {
            printer.failure(&message, None);
            return Outcome::Usage;
        }
    };
    let (listener, port) = match listen(watch.port, printer) {
        Ok(found) => found,
        Err(error) => {
            printer.failure(&format!("cannot serve the page: {}", reason(&error)), None);
            return Outcome::Files;
        }
    };
    let address = format!("http://127.0.0.1:{port}/");
    printer.result(
        &format!("watching {}, shown at {address}", task.path),
        &json!({ "watching": task.path, "address": address, "three": three.is_some() }),
    );
    if three.is_none() && !printer.quiet {
        let note = "three.js was not found: the page shows pictures that are drawn here; install it with \
                    `npm install three`, or name its folder with --three";
        printer.result(&format!("note: {note}"), &json!({ "note": note }));
    }
    let site = Arc::new(Site::new(port, three));
    let shown = Arc::clone(&site);
    let served =
        thread::Builder::new().name("page".to_owned()).spawn(move || server::serve(&listener, &shown));
    if let Err(error) = served {
        printer.failure(&format!("cannot serve the page: {}", reason(&error)), None);
        return Outcome::Files;
    }
    Watcher { watch, documents: &documents, task: &task, printer, stand: &site.stand }.follow()
}

/// Listens on loopback: at a port, or at any where that is taken.
fn listen(port: u16, printer: &Printer) -> std::io::Result<(TcpListener, u16)> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).or_else(|error| {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let why = if error.kind() == std::io::ErrorKind::AddrInUse {
            "is in use".to_owned()
        } else {
            format!("cannot be had: {}", reason(&error))
        };
        let note = format!("port {port} {why}; another one is taken");
        printer.result(&format!("note: {note}"), &json!({ "note": note }));
        Ok::<_, std::io::Error>(listener)
    })?;
    let port = listener.local_addr()?.port();
    Ok((listener, port))
}

struct Watcher<'a> {
    watch: &'a Watch,
    /// With the parameters of the document.
    documents: &'a Documents,
    task: &'a Task,
    printer: &'a Printer,
    stand: &'a Stand,
}

impl Watcher<'_> {
    /// Bakes, shows, waits for a change, and so on.
    fn follow(&self) -> ! {
        let mut folders = Folders::new();
        let memory = Arc::new(Memory::new(REMEMBERED));
        // Since when nothing was told because files were still being written.
        let mut silent: Option<Instant> = None;
        loop {
            let started = Instant::now();
            let bake = Bake::of(self.task, (self.watch, self.documents), &memory);
            let took = started.elapsed();
            if let Some(message) = folders.follow(bake.paths()) {
                self.printer.result(&format!("note: {message}"), &json!({ "note": message }));
            }
            if !bake.is_good() && silent.get_or_insert(started).elapsed() < PATIENCE {
                // A save in two steps must not show an error between them.
                folders.gather(Instant::now() + MERGE);
                if bake.has_changed() {
                    continue;
                }
            }
            silent = None;
            self.tell(&bake, took);
            self.stand.put(&bake, took, &self.task.path);
            // A change between the bake and this moment brought no event, or one that came too early.
            folders.gather(started + MERGE);
            while !bake.has_changed() {
                folders.wait();
            }
        }
    }

    /// Prints what `bake` would print, and writes what it would write where that is asked for.
    fn tell(&self, bake: &Bake<'_>, took: Duration) {
        if let Some(message) = &bake.failure {
            self.printer.failure(message, None);
        }
        if let Some(list) = &bake.diagnostics {
            self.printer.diagnostics(list);
        }
        for asset in &bake.assets {
            let compiled = &asset.compiled;
            let milliseconds = took.as_secs_f64() * 1e3;
            let folder = self.watch.out.as_deref();
            let target = folder.unwrap_or(Path::new("")).join(&compiled.file);
            if let Some(folder) = folder
                && let Err(error) = write(folder, compiled)
            {
                let message = format!("cannot write {}: {}", target.display(), reason(&error));
                self.printer.failure(&message, None);
                continue;
            }
            let object = json!({
                "asset": target.display().to_string(),
                "key": asset.key,
                "bytes": compiled.bytes.len(),
                "milliseconds": milliseconds,
            });
            let text = format!("{}  {}  in {milliseconds:.1} ms", target.display(), line(compiled));
            self.printer.result(&text, &object);
        }
    }
}

fn write(folder: &Path, compiled: &Compiled) -> std::io::Result<()> {
    let report = compiled.report_file()?;
    let asset = (compiled.file.as_str(), compiled.bytes.as_slice());
    let report = report.as_ref().map(|(name, text)| (name.as_str(), text.as_slice()));
    let list: Vec<(&str, &[u8])> = std::iter::once(asset).chain(report).collect();
    save(folder, &list)
}

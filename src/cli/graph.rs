//! `kiln graph`: which definitions of a document use which, and what the shapes take.
//!
//! Promise: every definition stands there with its place and all that it uses; the document is baked for it, so that times, bytes and
//! what is kept are those of this run, with the cache that `bake` would use. A time holds what a shape is made from too. Not
//! promised: times of definitions that are no shapes; they are parts of recipes, and cost nothing by themselves.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use serde_json::{Value, json};

use super::Outcome;
use super::arguments::{Graph, GraphFormat};
use super::baked::size;
use super::cache::opened;
use super::output::Printer;
use super::project::{profiles, single};
use crate::compile::{Compiled, Options, compile_profiles};
use crate::language::Document;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::Span;
use crate::language::spec::{Family, Spec};
use crate::project::reason;
use crate::realize::{Keep, Origin, ShapeWork, WorkLog};

pub(crate) fn run(graph: &Graph, printer: &Printer) -> Outcome {
    let (project, task, documents) =
        match single(&graph.file, (graph.root.as_deref(), graph.set.as_slice()), printer) {
            Ok(single) => single,
            Err(outcome) => return outcome,
        };
    let (files, document) = match task.load() {
        Ok(loaded) => loaded,
        Err(error) => {
            printer.failure(&format!("{}: {}", task.path, reason(&error)), None);
            return Outcome::Files;
        }
    };
    let cache = opened(&graph.cache, project.as_ref(), printer).map(Arc::new);
    let log = Arc::new(WorkLog::default());
    let bake = |document: Document| {
        let options = Options {
            variant: graph.variant.clone(),
            overrides: documents.overrides(&document),
            name: task.name().to_owned(),
            path: task.path.clone(),
            keep: cache.clone().map(|cache| cache as Arc<dyn Keep>),
            log: Some(Arc::clone(&log)),
            profiles: profiles(&graph.profile, project.as_ref()),
            ..Options::default()
        };
        let (spec, _) = document.spec(options.variant.as_deref(), &options.overrides)?;
        let assets = compile_profiles(&document, &files, &options)?;
        Ok::<_, Diagnostics>((document, spec, assets))
    };
    let (document, spec, assets) = match document.and_then(bake) {
        Ok(baked) => baked,
        Err(list) => {
            printer.diagnostics(&list);
            return Outcome::Errors;
        }
    };
    if let Some(trouble) = cache.as_deref().and_then(crate::cache::Cache::finish) {
        printer.warning(&format!("the cache cannot be written: {trouble}"));
    }
    let drawn = Drawn { path: &task.path, definitions: definitions(&document, &spec, &log), assets: &assets };
    printer.raw(&match graph.form {
        GraphFormat::Dot => drawn.as_dot(),
        GraphFormat::Json => drawn.as_json(),
    });
    Outcome::Good
}

/// A definition, and what is known of it.
struct Definition {
    family: Family,
    name: String,
    /// File and line.
    place: Option<(String, usize)>,
    uses: Vec<String>,
    /// Whether the document shows it, without a node for it.
    is_root: bool,
    work: Option<ShapeWork>,
}

impl Definition {
    /// `shape.vase`.
    fn key(&self) -> String {
        key(self.family, &self.name)
    }
}

fn key(family: Family, name: &str) -> String {
    format!("{}.{name}", family.text())
}

/// All definitions of a document, by their families and in the order of the text.
fn definitions(document: &Document, spec: &Spec, log: &WorkLog) -> Vec<Definition> {
    let mut uses: BTreeMap<&(Family, String), Vec<String>> = BTreeMap::new();
    for link in &spec.links {
        uses.entry(&link.user).or_default().push(key(link.used.0, &link.used.1));
    }
    let of = |(family, name, span): (Family, &String, Span)| {
        let place = document.sources().locate(span);
        Definition {
            family,
            name: name.clone(),
            place: place.map(|place| (place.file.to_owned(), place.line)),
            uses: uses.get(&(family, name.clone())).cloned().unwrap_or_default(),
            is_root: family == Family::Shape && spec.nodes.is_empty() && spec.roots.contains(name),
            work: if family == Family::Shape { log.of(name) } else { None },
        }
    };
    spec.definitions().map(of).collect()
}

/// What is printed.
struct Drawn<'a> {
    path: &'a str,
    definitions: Vec<Definition>,
    assets: &'a [Compiled],
}

const fn text(origin: Origin) -> &'static str {
    match origin {
        Origin::Found => "found",
        Origin::Kept => "kept",
        Origin::Made => "made",
    }
}

impl Drawn<'_> {
    fn as_json(&self) -> String {
        let definition = |one: &Definition| {
            json!({
                "definition": one.key(),
                "file": one.place.as_ref().map(|(file, _)| file),
                "line": one.place.as_ref().map(|(_, line)| line),
                "uses": one.uses,
                "shown": one.is_root,
                "milliseconds": one.work.map(|work| work.time.as_secs_f64() * 1e3),
                "bytes": one.work.map(|work| work.bytes),
                "triangles": one.work.map(|work| work.triangles),
                "cache": one.work.map(|work| text(work.origin)),
            })
        };
        let asset = |one: &Compiled| json!({ "file": one.file, "profile": one.profile.name(), "bytes": one.bytes.len() });
        let graph = json!({
            "document": self.path,
            "definitions": self.definitions.iter().map(definition).collect::<Vec<Value>>(),
            "assets": self.assets.iter().map(asset).collect::<Vec<Value>>(),
        });
        format!("{graph:#}\n")
    }

    /// Source: the DOT language, Graphviz documentation, 2024. An arrow leads from what is used to its user, as the data does.
    fn as_dot(&self) -> String {
        let mut out = format!(
            "digraph {} {{\n  rankdir = LR\n  node [shape = box, style = filled, fillcolor = white]\n",
            quoted(self.path)
        );
        for one in &self.definitions {
            let mut label = format!("{} {}", one.family.text(), one.name);
            if let Some(work) = one.work {
                let milliseconds = work.time.as_secs_f64() * 1e3;
                let (bytes, origin) = (size(work.bytes), text(work.origin));
                let _ = write!(label, "\n{milliseconds:.1} ms, {bytes}, {origin}");
            }
            let color = match one.work.map(|work| work.origin) {
                Some(Origin::Found) => ", fillcolor = palegreen",
                Some(Origin::Kept) => ", fillcolor = khaki",
                Some(Origin::Made) | None => "",
            };
            let _ = writeln!(out, "  {} [label = {}{color}]", quoted(&one.key()), quoted(&label));
        }
        for one in &self.definitions {
            for used in &one.uses {
                let _ = writeln!(out, "  {} -> {}", quoted(used), quoted(&one.key()));
            }
        }
        for asset in self.assets {
            let label = format!("{}\n{}", asset.file, size(asset.bytes.len()));
            let file = quoted(&asset.file);
            let _ = writeln!(out, "  {file} [label = {}, shape = note]", quoted(&label));
            let shown = self.definitions.iter().filter(|one| one.is_root || one.family == Family::Node);
            for one in shown {
                let _ = writeln!(out, "  {} -> {file}", quoted(&one.key()));
            }
        }
        out.push_str("}\n");
        out
    }
}

/// A quoted identifier of DOT.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

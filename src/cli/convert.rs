//! `kiln convert`: the mesh of another program's file as a document.

mod document;
mod simple;
mod smoothing;

use std::path::Path;

use serde_json::json;

use super::Outcome;
use super::arguments::Convert;
use super::input::{beside, read};
use super::output::Printer;
use crate::import::{self, ImportOptions, Imported, Note};
use crate::language::spec::{Up, kebab};
use crate::project::{reason, save};
use document::Written;
use simple::simple;

/// Faces beyond which nobody reads the text.
const READABLE: usize = 5000;
/// Items that an array of a document has at most.
const MOST: usize = 1_000_000;

pub(crate) fn run(convert: &Convert, printer: &Printer) -> Outcome {
    if convert.out.extension().and_then(|ending| ending.to_str()) != Some("toml") {
        let message = format!("write a document that ends in .toml, not {}", convert.out.display());
        printer.failure(&message, None);
        return Outcome::Usage;
    }
    let stem = convert.out.file_stem().unwrap_or_default().to_string_lossy();
    let asked = convert.name.as_deref().unwrap_or(&stem);
    let Some(name) = kebab(asked).filter(|name| convert.name.is_none() || name == asked) else {
        let help = "lower-case letters, digits and hyphens, as in `--name garden-gnome`";
        printer.failure(&format!("`{asked}` is not a name in kebab-case"), Some(help));
        return Outcome::Usage;
    };
    if !convert.force && convert.out.exists() {
        let message = format!("{} is there already", convert.out.display());
        printer.failure(&message, Some("choose another name, or add --force; nothing was changed"));
        return Outcome::Files;
    }
    let (imported, ending) = match imported(convert) {
        Ok(imported) => imported,
        Err(refusal) => {
            let message = format!("{}: {}", convert.file.display(), refusal.message);
            printer.failure(&message, refusal.help.as_deref());
            return refusal.outcome;
        }
    };
    let usual = if import::z_is_up(&ending) { Up::Z } else { Up::Y };
    let written = Written {
        name: &name,
        source: &convert.file,
        folder: convert.out.parent().unwrap_or(Path::new("")),
        unit: convert.unit,
        up: convert.up.unwrap_or(usual),
        subdivide: convert.subdivide,
    };
    let document = written.document(&imported);
    let file = convert.out.file_name().unwrap_or_default().to_string_lossy();
    let folder =
        convert.out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if let Err(error) = save(folder, &[(&file, document.text.as_bytes())]) {
        printer.failure(&format!("{}: {}", convert.out.display(), reason(&error)), None);
        return Outcome::Files;
    }
    let told = imported.notes.iter().map(|note| match note.line {
        Some(line) => format!("{}:{line}: {}", convert.file.display(), note.message),
        None => format!("{}: {}", convert.file.display(), note.message),
    });
    let faces = imported.mesh.faces.len();
    let long = (faces > READABLE)
        .then(|| format!("{faces} faces are more than people read; `import` takes the file as it is"));
    for note in told.chain(document.notes).chain(long) {
        printer.warning(&note);
    }
    let out = convert.out.display();
    let points = imported.mesh.points.len();
    let object = json!({
        "document": out.to_string(), "shape": name, "points": points, "faces": faces,
        "materials": imported.mesh.materials, "groups": imported.groups,
    });
    let text = format!("wrote {out}: {points} points, {faces} faces; now: kiln bake {out}");
    printer.result(&text, &object);
    Outcome::Good
}

/// Why there is no mesh, and what to do.
struct Refusal {
    message: String,
    help: Option<String>,
    outcome: Outcome,
}

impl Refusal {
    fn new(message: impl Into<String>, help: Option<&str>) -> Self {
        Self { message: message.into(), help: help.map(str::to_owned), outcome: Outcome::Errors }
    }
}

/// The mesh of the file, and the ending of its name.
fn imported(convert: &Convert) -> Result<(Imported, String), Refusal> {
    let file = &convert.file;
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let unread = |message| Refusal { message, help: None, outcome: Outcome::Files };
    let bytes = read(file).map_err(unread)?;
    let options = ImportOptions { group: convert.group.clone(), weld: convert.weld, most: MOST as u64 };
    let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
    let foreign = import::recognize(&bytes);
    let Some(read) = import::read(&ending, &bytes, &options, &mut |path| beside(&folder, path)) else {
        return Err(match foreign {
            Some(foreign) => Refusal::new(format!("this is {}", foreign.name), Some(foreign.hint)),
            None => Refusal::new(format!("meshes of .{ending} files are not read"), None),
        });
    };
    let mut imported = read.map_err(|error| match foreign.filter(|_| error.is_foreign()) {
        Some(foreign) => Refusal::new(format!("this is {}", foreign.name), Some(foreign.hint)),
        None => {
            let line = error.line().map_or_else(String::new, |line| format!("line {line}: "));
            Refusal::new(format!("{line}{error}"), error.hint().as_deref())
        }
    })?;
    imported.mesh.validate().map_err(|error| Refusal::new(error.to_string(), None))?;
    let (mesh, parted) = simple(imported.mesh);
    imported.mesh = mesh;
    if parted > 0 {
        let message =
            format!("{parted} faces come back to one of their points; they are written as triangles");
        imported.notes.push(Note { line: None, message });
    }
    let mesh = &imported.mesh;
    if mesh.faces.is_empty() {
        return Err(Refusal::new("it has no faces", None));
    }
    let most = mesh.points.len().max(mesh.faces.len()).max(mesh.uvs.len());
    if most > MOST {
        let message = format!("{most} items are more than the {MOST} that an array of a document has");
        return Err(Refusal::new(message, Some("`import` takes the file as it is")));
    }
    Ok((imported, ending))
}

//! `kiln diff`: what changed between two models.
//!
//! Promise: both are compared as they are written: facts measured on the bytes, the greatest distance between the surfaces
//! with its accuracy, and pictures from one camera in which what is further away than that accuracy is colored by how far.
//! Files with the same bytes are the same; all others differ. Models of a git revision are read as they stood in it, with
//! all that they include.
//! No promise: clips are compared by their facts alone.

mod facts;
mod page;
mod side;

use std::path::Path;

use serde_json::{Value, json};

use super::Outcome;
use super::arguments::Diff;
use super::output::Printer;
use crate::geometry::mesh::distance::{Farthest, Sheet};
use crate::geometry::number::{FAN, single};
use crate::preview::heat::{Heat, HeatMap, Measured};
use crate::preview::{Camera, Look, Picture, Stage, draw_picture};
use crate::project::{reason, save};
use facts::{Change, changes};
use side::{Side, Trouble};

/// Accuracy of the distance, as a share of the diagonal of both models.
const ACCURACY: f64 = 1e-3;

pub(crate) fn run(diff: &Diff, printer: &Printer) -> Outcome {
    let read = |named: &str, other: &str| {
        Side::read(named, diff).map_err(|trouble| {
            match trouble {
                Trouble::Document(list) => printer.diagnostics(&list),
                Trouble::Other(message) => printer.failure(&message, None),
            }
            printer.failure(&format!("{named} cannot be compared with {other}"), None);
        })
    };
    let (Ok(one), Ok(other)) = (read(&diff.one, &diff.other), read(&diff.other, &diff.one)) else {
        return Outcome::Files;
    };
    let compared = Compared::new(&one, &other);
    printer.result(&compared.text(), &compared.json());
    if let Some(out) = &diff.out
        && let Err((message, outcome)) = write(out, diff, &compared)
    {
        printer.failure(&message, None);
        return outcome;
    }
    if compared.same { Outcome::Good } else { Outcome::Errors }
}

/// Two models and what differs.
struct Compared<'a> {
    one: &'a Side,
    other: &'a Side,
    same: bool,
    changes: Vec<Change>,
    /// The distances of the first from the second and back; none where one has no triangles.
    distances: Option<[Farthest; 2]>,
    accuracy: f64,
    sheets: [Option<Sheet>; 2],
}

impl<'a> Compared<'a> {
    fn new(one: &'a Side, other: &'a Side) -> Self {
        let same = one.bytes == other.bytes;
        let bounds = one.stage.bounds.union(other.stage.bounds);
        let accuracy = bounds.diagonal() * ACCURACY;
        let sheets = [sheet(&one.stage), sheet(&other.stage)];
        let distances = match &sheets {
            [Some(a), Some(b)] => Some([a.farthest_from(b, accuracy), b.farthest_from(a, accuracy)]),
            _ => None,
        };
        Self { one, other, same, changes: changes(&one.facts, &other.facts), distances, accuracy, sheets }
    }

    /// Between which numbers the Hausdorff distance lies, metres.
    fn hausdorff(&self) -> Option<(f64, f64)> {
        let [there, back] = self.distances?;
        Some((there.at_least.max(back.at_least), there.at_most.max(back.at_most)))
    }

    fn text(&self) -> String {
        if self.same {
            return format!("{} and {} are the same bytes", self.one.name, self.other.name);
        }
        let mut lines = vec![format!("{} -> {}", self.one.name, self.other.name)];
        if let Some((least, most)) = self.hausdorff() {
            lines.push(format!("greatest distance between the surfaces: {least:.6} to {most:.6} m"));
        }
        lines.extend(self.changes.iter().map(Change::text));
        lines.join("\n")
    }

    fn json(&self) -> Value {
        let distance = |found: Farthest| json!({ "at-least": found.at_least, "at-most": found.at_most, "place": found.place.to_array() });
        json!({
            "one": self.one.name,
            "other": self.other.name,
            "same": self.same,
            "distance": self.hausdorff().map(|(least, most)| json!({ "at-least": least, "at-most": most })),
            "from-one-to-other": self.distances.map(|[there, _]| distance(there)),
            "from-other-to-one": self.distances.map(|[_, back]| distance(back)),
            "changes": self.changes.iter().map(Change::json).collect::<Vec<_>>(),
        })
    }

    /// Both from one camera, side by side; what is further from the other than the accuracy is colored.
    fn picture(&self, diff: &Diff) -> Picture {
        let look = Look { size: diff.size, ..Look::default() };
        let camera = Camera::on(&[&self.one.stage, &self.other.stage], diff.view, &look);
        let high = self.hausdorff().map_or(0.0, |(least, _)| least);
        let draw = |side: &Side, own: &Option<Sheet>, other: &Option<Sheet>| {
            let mut stage = side.stage.clone();
            if own.is_some() && high > self.accuracy {
                let values = stage.triangles.iter().map(|triangle| match other {
                    Some(other) => self.marked(&stage, *triangle, other),
                    None => [single(high); 13],
                });
                let values: Measured = values.collect();
                stage.heat = Some(HeatMap::of(values, (0.0, high)));
            }
            draw_picture(&side.asset, &stage, &camera, &look)
        };
        let [a, b] = &self.sheets;
        let pictures = [draw(self.one, a, b), draw(self.other, b, a)];
        let sheet = Picture::sheet(&pictures, look.background);
        if high > self.accuracy {
            return sheet.with_legend(&Heat::Distance.title(), (0.0, high, high), look.background);
        }
        sheet
    }

    /// Distances of a triangle from the other surface; not a number where all of it is as near as the accuracy.
    fn marked(&self, stage: &Stage, triangle: [u32; 3], other: &Sheet) -> [f32; 13] {
        let [a, b, c] = triangle.map(|corner| stage.vertices[corner as usize].point);
        let distances = FAN.map(|[x, y, z]| other.distance(a * x + b * y + c * z));
        let far = distances.iter().any(|distance| *distance > self.accuracy);
        if far { distances.map(single) } else { [f32::NAN; 13] }
    }
}

fn sheet(stage: &Stage) -> Option<Sheet> {
    Sheet::new(stage.vertices.iter().map(|vertex| vertex.point).collect(), stage.triangles.clone())
}

/// Writes the pictures, or a page with them and all that is known.
fn write(out: &Path, diff: &Diff, compared: &Compared<'_>) -> Result<(), (String, Outcome)> {
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    if !matches!(ending.as_str(), "png" | "html") {
        let message = format!("write a picture (.png) or a page (.html), not {}", out.display());
        return Err((message, Outcome::Usage));
    }
    let picture = compared.picture(diff).png().map_err(|error| (error.to_string(), Outcome::Usage))?;
    let file = if ending == "png" { picture } else { page::page(compared, &picture).into_bytes() };
    let folder = out.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    save(folder, &[(&name, &file)])
        .map_err(|error| (format!("cannot write {}: {}", out.display(), reason(&error)), Outcome::Files))
}

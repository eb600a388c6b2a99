//! From the text of a document to the bytes of its file and what the report says of them.
//!
//! Every file baked here is read by [`glb`], which shares nothing with Kiln's own reader, and held against the report.

mod accuracy;
mod attributes;
mod baked;
mod bevels;
mod colliders;
mod colors;
mod coons;
mod copies;
mod deformations;
mod determinism;
mod document;
mod drawings;
mod duplicates;
mod engines;
mod fields;
mod glb;
mod heights;
mod hostile;
mod joined;
mod lods;
mod lofts;
mod mapping;
mod morphs;
mod motion;
mod mutation;
mod nets;
mod operations;
mod optics;
mod parametric;
mod parts;
mod patches;
mod paths;
mod perturbed;
mod polygons;
mod primitives;
mod profiles;
mod quadrics;
mod refusals;
mod shading;
mod shapes;
mod solids;
mod subdivisions;
mod sweeps;
mod textures;
mod triangles;
mod trimmed;
mod wires;

use kiln::compile::{Compiled, Options};
use kiln::language::Document;
use kiln::language::diagnostic::Diagnostics;
use kiln::language::source::MemoryFiles;
use kiln::report::{Report, ShapeFacts};

use glb::Glb;

/// A baked document: the file, read by the tests' own reader, and the report.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) compiled: Compiled,
    pub(crate) glb: Glb,
}

impl Baked {
    pub(crate) fn report(&self) -> &Report {
        self.compiled.report.as_ref().expect("a report was asked for")
    }

    /// The one shape of a document.
    pub(crate) fn only(&self) -> &ShapeFacts {
        assert_eq!(self.report().shapes.len(), 1);
        &self.report().shapes[0]
    }
}

/// Files that stand beside the documents of these tests.
pub(crate) fn inputs() -> MemoryFiles {
    MemoryFiles::new()
        .with("label.png", include_bytes!("../specs/inputs/label.png").as_slice())
        .with("bumps.png", include_bytes!("../specs/inputs/crate-normal.png").as_slice())
        .with("bird.obj", include_str!("../specs/inputs/bird.obj"))
}

pub(crate) fn compile(text: &str, options: &Options) -> Result<Compiled, Diagnostics> {
    let files = inputs().with("spec.toml", text);
    let document = Document::load("spec.toml", &files)?;
    kiln::compile(&document, &files, options)
}

/// Bakes and checks: the file by the reader of the tests, the report against what that reader finds.
pub(crate) fn bake_with(text: &str, options: &Options) -> Baked {
    let compiled = compile(text, options).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let baked = Baked { glb: Glb::new(&compiled.bytes), compiled };
    baked.glb.check();
    for (name, facts) in &baked.report().shapes {
        hold_against(&baked.glb, name, facts);
    }
    baked
}

pub(crate) fn bake(text: &str) -> Baked {
    bake_with(text, &Options { name: "asset".to_owned(), measure: true, ..Options::default() })
}

fn hold_against(glb: &Glb, name: &str, reported: &ShapeFacts) {
    let shows = |mesh: &&serde_json::Value| {
        mesh["name"] == *name
            || mesh["name"].as_str().is_some_and(|full| full.starts_with(&format!("{name}.")))
    };
    let mesh = glb.list("meshes").iter().find(shows).unwrap_or_else(|| panic!("no mesh shows {name}"));
    let mesh = glb.named(mesh["name"].as_str().expect("meshes have names"));
    let (found, facts) = (mesh.facts(), &reported.facts);
    assert_eq!(facts.triangles, mesh.triangles.len() as u64, "{name}");
    assert_eq!(facts.vertices, mesh.positions.len() as u64, "{name}");
    assert_eq!((facts.points, facts.euler), (found.points as u64, found.euler), "{name}");
    assert_eq!((facts.closed, facts.boundary_edges), (found.closed, found.boundary as u64), "{name}");
    assert!(
        (facts.area - found.area).abs() <= 1e-12 * found.area,
        "{name}: area {}, {}",
        facts.area,
        found.area
    );
    assert_eq!(facts.volume.is_some(), found.closed, "{name}");
    if let Some(volume) = facts.volume {
        let size = found.area * found.area.sqrt();
        assert!((volume - found.volume).abs() <= 1e-12 * size, "{name}: volume {volume}, {}", found.volume);
    }
}

/// Ten thousandths of an expected number, for what is made of flat faces and only rounded.
#[track_caller]
pub(crate) fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} instead of {expected}");
}

//! `kiln render --exact`: the surfaces of a document themselves.
//!
//! Each shape is drawn by what is known best of it: the surface of a field line of sight by line of sight, proved by bounds;
//! any other surface cut until its pieces lie within a small part of a pixel of it; triangles that are the shape as they are.
//! Cameras are those of the ordinary picture, so that both can be laid over each other.

use serde_json::json;

use super::{Fault, document, read, stage};
use crate::cli::Outcome;
use crate::cli::arguments::Render;
use crate::cli::output::Printer;
use crate::compile::{Options, Source, compile_profiles};
use crate::geometry::tessellate::Evidence;
use crate::preview::asset::Asset;
use crate::preview::exact::{Exact, Surfaces};
use crate::preview::{Camera, Look, Picture, Stage, draw_exact};

/// The part of a pixel that pieces of surfaces may lie beside them.
const PART: f64 = 1.0 / 16.0;

/// How much coarser pieces become where they cannot be so fine, and how often.
const COARSER: f64 = 4.0;
const TRIES: u32 = 4;

/// What is drawn in place of the baked file.
pub(super) struct Surface {
    asset: Asset,
    sources: Vec<Source>,
    surfaces: Vec<Option<Surfaces>>,
    /// Pixels for a meter, at most.
    pixels: f64,
}

/// Says what cannot be drawn so.
pub(super) fn allowed(render: &Render, drawn: bool) -> Result<(), Fault> {
    let refused = |message: &str| Err((Some(message.to_owned()), Outcome::Usage));
    if render.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb")) {
        return refused(
            "a .glb file holds triangles, not the surfaces that they stand for: give --exact the document that it was baked from",
        );
    }
    if drawn {
        return refused(
            "--exact makes pictures of pixels, for lines are edges of triangles: write a .png or an .apng",
        );
    }
    if render.heat.is_some() {
        return refused(
            "--exact draws the surface, and --heat shows numbers of its triangles: write one of them; --heat deviation tells how far both are apart",
        );
    }
    if render.lod > 0 {
        return refused("--exact draws the surface itself, which has no levels of detail: leave --lod out");
    }
    Ok(())
}

impl Surface {
    /// Cuts the surfaces of the document as finely as these cameras see them on these stages of the baked file.
    pub(super) fn new(
        render: &Render,
        printer: &Printer,
        cameras: &[Camera],
        stages: &[&Stage],
    ) -> Result<Self, Fault> {
        let pixel = cameras
            .iter()
            .flat_map(|camera| stages.iter().map(|stage| camera.pixel(&stage.bounds)))
            .fold(f64::INFINITY, f64::min);
        let stretch = stages.iter().flat_map(|stage| stage.pieces.iter()).filter_map(|piece| piece.world);
        let stretch = stretch.map(|world| crate::realize::stretch(&glam::DMat3::from_mat4(world)));
        let stretch = stretch.fold(f64::MIN_POSITIVE, f64::max);
        let stretch = if stretch > f64::MIN_POSITIVE { stretch } else { 1.0 };
        let (files, document, options) = document(render, printer)?;
        let mut tolerance = PART * pixel / stretch;
        let mut tries = 0;
        let mut compiled = loop {
            let options = Options { exact: Some(tolerance), ..options.clone() };
            match compile_profiles(&document, &files, &options) {
                Ok(compiled) => break compiled,
                // There may be too many pieces, or none so small that a surface is sound; it was at its own tolerance.
                Err(_) if tries < TRIES => {
                    tries += 1;
                    tolerance *= COARSER;
                }
                Err(list) => {
                    printer.diagnostics(&list);
                    return Err((None, Outcome::Errors));
                }
            }
        };
        let compiled = compiled.swap_remove(0);
        let asset = read(render, &compiled.bytes)?;
        let surfaces = |source: &Source| {
            let sheets = source.sheets.clone()?;
            Some(Surfaces { sheets, deviation: source.deviation.bound })
        };
        let surfaces = compiled.sources.iter().map(surfaces).collect();
        Ok(Self { asset, sources: compiled.sources, surfaces, pixels: stretch / pixel })
    }

    /// The picture at a time of the clip.
    pub(super) fn draw(
        &self,
        render: &Render,
        time: f64,
        camera: &Camera,
        look: &Look,
    ) -> Result<Picture, Fault> {
        let stage = stage(&self.asset, render, time)?;
        let exact = Exact::new(&stage, &self.surfaces);
        Ok(draw_exact((&self.asset, &stage), &exact, camera, look))
    }

    /// Says how each shape is drawn.
    pub(super) fn tell(&self, render: &Render, printer: &Printer) -> Result<(), Fault> {
        let stage = stage(&self.asset, render, render.time.unwrap_or(0.0))?;
        let exact = Exact::new(&stage, &self.surfaces);
        let mut told: Vec<&str> = Vec::new();
        for (mesh, source) in self.sources.iter().enumerate() {
            if told.contains(&source.shape.as_str()) {
                continue;
            }
            told.push(&source.shape);
            let shape = &source.shape;
            let pixels = source.deviation.bound * self.pixels;
            let (drawn, text) = if exact.draws(mesh) {
                ("field", format!("{shape}: proved, by bounds of its field"))
            } else {
                match source.deviation.evidence {
                    Evidence::Exact => ("mesh", format!("{shape}: its mesh, which is the shape")),
                    Evidence::Proved => ("proved", format!("{shape}: proved, to {pixels:.3} pixels")),
                    Evidence::Sampled => ("sampled", format!("{shape}: sampled, to {pixels:.3} pixels")),
                }
            };
            printer.result(&text, &json!({ "shape": shape, "drawn": drawn, "pixels": pixels }));
        }
        Ok(())
    }
}

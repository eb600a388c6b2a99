//! `kiln render`: pictures of documents and of `.glb` files.

mod exact;

use std::path::{Path, PathBuf};

use serde_json::json;

use super::Outcome;
use super::arguments::{Hidden, Render, ShadingName};
use super::output::Printer;
use super::project::single;
use crate::compile::{Options, compile_profiles};
use crate::gltf::Profile;
use crate::language::Document;
use crate::language::source::DiskFiles;
use crate::preview::asset::{self, Asset};
use crate::preview::heat::{Heat, HeatMap, Measured};
use crate::preview::lines::{Ink, draw_lines, postscript, svg};
use crate::preview::{Camera, Look, Moment, Picture, Projection, Shading, Stage, View, draw_picture};
use crate::project::{reason, save};

/// Pictures a second of a clip that plays.
const RATE: f64 = 24.0;

/// Most pictures of an animation.
const MOST: usize = 2000;

pub(crate) fn run(render: &Render, printer: &Printer) -> Outcome {
    match picture(render, printer) {
        Ok(()) => Outcome::Good,
        Err((message, outcome)) => {
            if let Some(message) = message {
                printer.failure(&message, None);
            }
            outcome
        }
    }
}

/// A message that is still to be printed, and how the command ends.
type Fault = (Option<String>, Outcome);

fn picture(render: &Render, printer: &Printer) -> Result<(), Fault> {
    let usage = |message: &str| (Some(message.to_owned()), Outcome::Usage);
    let out = render.out.clone().unwrap_or_else(|| PathBuf::from(named(&render.file)).with_extension("png"));
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    let animated = matches!(ending.as_str(), "apng" | "gif");
    let plays = render.clip.is_some() && render.time.is_none() && animated;
    let moves = plays || render.turntable.is_some();
    match ending.as_str() {
        "png" | "apng" | "gif" | "svg" | "eps" => {}
        _ => {
            let message = format!(
                "write a picture that ends in .png, .apng, .gif, .svg or .eps, not {}",
                out.display()
            );
            return Err(usage(&message));
        }
    }
    let drawn = matches!(ending.as_str(), "svg" | "eps");
    if drawn && (render.turntable.is_some() || render.view.len() > 1) {
        return Err(usage("a line drawing has one view; write several drawings, or a .png"));
    }
    if drawn && render.camera.is_some() {
        return Err(usage(
            "--camera makes pictures of pixels: write a .png or an .apng, or a drawing with --view",
        ));
    }
    if animated && !moves {
        return Err(usage(&format!(
            "an .{ending} moves: write --turntable N, or --clip NAME without --time"
        )));
    }
    if render.heat.is_some() && (drawn || plays) {
        return Err(usage(
            "--heat makes pictures of one moment: write a .png, or an .apng or .gif with --turntable",
        ));
    }
    if render.exact {
        exact::allowed(render, drawn)?;
    }
    let (bytes, deviations) = bytes(render, printer)?;
    let mut asset = read(render, &bytes)?;
    asset.show_level(render.lod.into());
    for note in &asset.notes {
        printer.result(&format!("note: {note}"), &json!({ "note": note }));
    }
    let file = if plays {
        clip(render, printer, &asset, &ending)?
    } else {
        let mut stage = stage(&asset, render, render.time.unwrap_or(0.0))?;
        if let Some(heat) = &render.heat {
            let map = HeatMap::new(heat, (&asset, &stage), &deviations);
            let map = map.map_err(|error| (Some(error.to_string()), Outcome::Errors))?;
            let (title, high) = (heat.title(), map.high);
            printer.result(
                &format!("{title}: {} to {high:.6}, at most {:.6}", map.low, map.greatest),
                &json!({ "heat": title, "low": map.low, "high": high, "greatest": map.greatest }),
            );
            stage.heat = Some(map);
        }
        match render.turntable {
            Some(count) => turntable(render, printer, (&asset, &stage), (count, &ending))?,
            None if drawn => lines(render, &stage, &ending).into_bytes(),
            None => {
                let picture = still(render, printer, &asset, &stage)?;
                legended(render, &stage, picture).png().map_err(unwritten)?
            }
        }
    };
    let folder = out.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let name =
        out.file_name().and_then(|name| name.to_str()).ok_or_else(|| usage("write the name of a file"))?;
    save(folder, &[(name, &file)]).map_err(|error| {
        (Some(format!("cannot write {}: {}", out.display(), reason(&error))), Outcome::Files)
    })?;
    printer.result(
        &out.display().to_string(),
        &json!({ "picture": out.display().to_string(), "bytes": file.len() }),
    );
    Ok(())
}

fn unwritten(error: crate::preview::PictureError) -> Fault {
    (Some(error.to_string()), Outcome::Errors)
}

fn named(file: &Path) -> &std::ffi::OsStr {
    file.file_name().unwrap_or(file.as_os_str())
}

/// A picture with the scale of its colors, where numbers are shown.
fn legended(render: &Render, stage: &Stage, picture: Picture) -> Picture {
    match (&stage.heat, &render.heat) {
        (Some(map), Some(heat)) => {
            picture.with_legend(&heat.title(), (map.low, map.high, map.greatest), render.background)
        }
        _ => picture,
    }
}

/// The bytes to draw: of a `.glb` file as they are, of a document as it is baked, with the distances of its triangles from
/// the true surface where those are shown.
fn bytes(render: &Render, printer: &Printer) -> Result<(Vec<u8>, Vec<Option<Measured>>), Fault> {
    if render.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb")) {
        if render.variant.is_some() || !render.set.is_empty() {
            let message = "--variant and --set are for documents; a .glb file is drawn as it is";
            return Err((Some(message.to_owned()), Outcome::Usage));
        }
        return Ok((std::fs::read(&render.file).map_err(|error| unread(render, &error))?, Vec::new()));
    }
    let (files, document, options) = document(render, printer)?;
    let mut compiled = compile_profiles(&document, &files, &options).map_err(|list| {
        printer.diagnostics(&list);
        (None, Outcome::Errors)
    })?;
    // Levels of detail stand in one file or in several; warnings stand with the first.
    for one in compiled.iter().filter(|one| !one.warnings.is_empty()) {
        printer.diagnostics(&one.warnings);
    }
    let shown = usize::from(render.lod).min(compiled.len() - 1);
    let shown = compiled.swap_remove(shown);
    Ok((shown.bytes, shown.deviations))
}

/// The document to draw, the files that it is read from, and how it is baked.
fn document(render: &Render, printer: &Printer) -> Result<(DiskFiles, Document, Options), Fault> {
    let given = (render.root.as_deref(), render.set.as_slice());
    let (_, task, documents) = single(&render.file, given, printer).map_err(|outcome| (None, outcome))?;
    let (files, document) = task.load().map_err(|error| unread(render, &error))?;
    let document = document.map_err(|list| {
        printer.diagnostics(&list);
        (None, Outcome::Errors)
    })?;
    let options = Options {
        variant: render.variant.clone(),
        overrides: documents.overrides(&document),
        name: task.name().to_owned(),
        path: task.path.clone(),
        no_report: true,
        deviations: render.heat == Some(Heat::Deviation),
        draft: render.draft,
        profiles: vec![Profile::Core],
        ..Options::default()
    };
    Ok((files, document, options))
}

fn unread(render: &Render, error: &std::io::Error) -> Fault {
    (Some(format!("{}: {}", render.file.display(), reason(error))), Outcome::Files)
}

fn read(render: &Render, bytes: &[u8]) -> Result<Asset, Fault> {
    asset::read(bytes).map_err(|error| (Some(format!("{}: {error}", render.file.display())), Outcome::Errors))
}

fn stage(asset: &Asset, render: &Render, time: f64) -> Result<Stage, Fault> {
    let moment = Moment { clip: render.clip.clone(), time };
    Stage::new(asset, &moment).map_err(|error| (Some(error.to_string()), Outcome::Usage))
}

fn look(render: &Render) -> Look {
    Look {
        size: render.size,
        shading: match render.shading {
            ShadingName::Standard => Shading::Standard,
            ShadingName::Phong => Shading::Phong,
            ShadingName::Gouraud => Shading::Gouraud,
            ShadingName::Flat => Shading::Flat,
            ShadingName::Normals => Shading::Normals,
        },
        projection: if render.orthographic { Projection::Orthographic } else { Projection::Perspective },
        shadows: !render.no_shadows,
        background: render.background,
    }
}

/// The camera of the file that the picture is seen through, if one was asked for.
fn through(render: &Render, stage: &Stage, look: &Look) -> Result<Option<Camera>, Fault> {
    let Some(asked) = &render.camera else { return Ok(None) };
    let Some(eye) = stage.eyes.iter().find(|eye| eye.name == *asked) else {
        let known: Vec<&str> = stage.eyes.iter().map(|eye| eye.name.as_str()).collect();
        let known = if known.is_empty() {
            "the model has none".to_owned()
        } else {
            format!("it has {}", known.join(", "))
        };
        return Err((Some(format!("there is no camera at a node `{asked}`: {known}")), Outcome::Usage));
    };
    let camera = Camera::through(eye, look.size);
    camera.map(Some).ok_or_else(|| {
        (Some(format!("the camera `{asked}` sees nothing: its node has no size")), Outcome::Errors)
    })
}

/// Pictures of one moment each, by cameras: of the file, or where that is asked for of the surfaces behind it.
fn pictures(
    render: &Render,
    printer: &Printer,
    asset: &Asset,
    shots: &[(&Stage, f64, Camera)],
) -> Result<Vec<Picture>, Fault> {
    let look = look(render);
    if !render.exact {
        let draw = |(stage, _, camera): &(&Stage, f64, Camera)| draw_picture(asset, stage, camera, &look);
        return Ok(shots.iter().map(draw).collect());
    }
    let (stages, cameras): (Vec<&Stage>, Vec<Camera>) =
        shots.iter().map(|(stage, _, camera)| (*stage, *camera)).unzip();
    let surface = exact::Surface::new(render, printer, &cameras, &stages)?;
    surface.tell(render, printer)?;
    shots.iter().map(|(_, time, camera)| surface.draw(render, *time, camera, &look)).collect()
}

/// All views on one sheet.
fn still(render: &Render, printer: &Printer, asset: &Asset, stage: &Stage) -> Result<Picture, Fault> {
    let look = look(render);
    let time = render.time.unwrap_or(0.0);
    let cameras = match through(render, stage, &look)? {
        Some(camera) => vec![camera],
        None => render.view.iter().map(|view| Camera::on(&[stage], *view, &look)).collect(),
    };
    let shots: Vec<(&Stage, f64, Camera)> = cameras.into_iter().map(|camera| (stage, time, camera)).collect();
    let mut pictures = pictures(render, printer, asset, &shots)?;
    Ok(match pictures.len() {
        1 => pictures.remove(0),
        _ => Picture::sheet(&pictures, look.background),
    })
}

/// The lines of the first view.
fn lines(render: &Render, stage: &Stage, ending: &str) -> String {
    let look = look(render);
    let drawing = draw_lines(stage, &Camera::on(&[stage], first_view(render), &look));
    let [r, g, b, opacity] = look.background;
    let paper = (opacity > 0).then_some([r, g, b]);
    let ink = Ink { size: look.size, hidden: render.hidden == Hidden::Dashed, paper };
    if ending == "svg" { svg(&drawing, &ink) } else { postscript(&drawing, &ink) }
}

/// Once around, from the first view; the distance stays.
fn turntable(
    render: &Render,
    printer: &Printer,
    (asset, stage): (&Asset, &Stage),
    (count, ending): (u16, &str),
) -> Result<Vec<u8>, Fault> {
    let look = look(render);
    let start = first_view(render);
    let view = |k: u16| View { azimuth: start.azimuth + 360.0 * f64::from(k) / f64::from(count), ..start };
    let time = render.time.unwrap_or(0.0);
    let camera = |k: u16| Camera::turning(&stage.bounds, view(k), look.projection, look.size);
    let shots: Vec<(&Stage, f64, Camera)> = (0..count).map(|k| (stage, time, camera(k))).collect();
    let pictures = pictures(render, printer, asset, &shots)?.into_iter();
    let pictures: Vec<Picture> = pictures.map(|picture| legended(render, stage, picture)).collect();
    // Once around takes four seconds, however many pictures there are.
    let milliseconds = (4000 / count).max(10);
    moving(&pictures, milliseconds, ending)
}

/// Pictures one after the other, as the ending of the file says: a .png shows them too, where it is read as an .apng.
fn moving(pictures: &[Picture], milliseconds: u16, ending: &str) -> Result<Vec<u8>, Fault> {
    if ending == "gif" {
        return Picture::gif(pictures, milliseconds).map_err(unwritten);
    }
    Picture::animation(pictures, milliseconds).map_err(unwritten)
}

/// The whole clip; the camera stands where it sees all of it.
fn clip(render: &Render, printer: &Printer, asset: &Asset, ending: &str) -> Result<Vec<u8>, Fault> {
    let look = look(render);
    let name = render.clip.as_deref().unwrap_or_default();
    let found = asset.clips.iter().find(|clip| clip.name == name);
    let duration = found.map_or(0.0, asset::Clip::duration);
    let count = crate::geometry::number::floor_index(duration * RATE).max(1);
    if count > MOST {
        let message = format!(
            "the clip `{name}` of {duration} s would be {count} pictures, more than {MOST}; write --time"
        );
        return Err((Some(message), Outcome::Usage));
    }
    let time = |k: usize| k as f64 / RATE;
    let stages: Result<Vec<Stage>, Fault> = (0..count).map(|k| stage(asset, render, time(k))).collect();
    let stages = stages?;
    let all: Vec<&Stage> = stages.iter().collect();
    let outside = Camera::on(&all, first_view(render), &look);
    let shot = |(k, stage): (usize, &'_ Stage)| Ok((k, through(render, stage, &look)?.unwrap_or(outside)));
    let cameras: Vec<(usize, Camera)> = stages.iter().enumerate().map(shot).collect::<Result<_, Fault>>()?;
    let shots: Vec<(&Stage, f64, Camera)> =
        cameras.into_iter().map(|(k, camera)| (&stages[k], time(k), camera)).collect();
    let pictures = pictures(render, printer, asset, &shots)?;
    moving(&pictures, 42, ending)
}

fn first_view(render: &Render) -> View {
    render.view.first().copied().unwrap_or(View::NAMED[0].1)
}

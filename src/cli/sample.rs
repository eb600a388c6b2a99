//! `kiln sample`: points and derivatives as JSON, so that anyone can check the mathematics from outside.

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};

use super::Outcome;
use super::arguments::Sample;
use super::output::Printer;
use super::project::single;
use super::sample_curve::describe;
use super::sample_surface::describe as describe_surfaces;
use super::timed;
use crate::compile::{self, Options};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Side};
use crate::geometry::surface::{ExtrudedSurface, RevolvedSurface, Surface, SweptSurface, SweptWall};
use crate::model::{Model, Recipe};
use crate::project::reason;

pub(crate) fn run(sample: &Sample, printer: &Printer) -> Outcome {
    let (_, task, documents) = match single(&sample.file, (None, &sample.set), printer) {
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
    let found = document.and_then(|document| {
        let overrides = documents.overrides(&document);
        let options = Options { overrides, name: task.name().to_owned(), ..Options::default() };
        match (&sample.curve, &sample.shape) {
            (Some(name), _) => compile::curve_parts(&document, &files, &options, name)
                .map(|parts| of_parts(name, parts.as_deref(), sample)),
            (None, Some(name)) => {
                compile::model(&document, &files, &options).map(|model| of_shape(name, &model, sample))
            }
            (None, None) => Ok(Err("name a curve or a shape".to_owned())),
        }
    });
    match found {
        Ok(Ok(object)) => {
            printer.raw(&format!("{object}\n"));
            Outcome::Good
        }
        Ok(Err(message)) => {
            printer.failure(&message, None);
            Outcome::Usage
        }
        Err(list) => {
            printer.diagnostics(&list);
            Outcome::Errors
        }
    }
}

fn numbers(vector: DVec3) -> Value {
    json!(vector.to_array())
}

/// One curve as it is; several parts as a list of curves.
fn of_parts(name: &str, parts: Option<&[AnyCurve]>, sample: &Sample) -> Result<Value, String> {
    match parts {
        None | Some([]) => Err(format!("there is no curve `{name}`")),
        Some([curve]) => of_curve(name, curve, sample),
        Some(parts) => {
            let parts: Result<Vec<_>, _> = parts.iter().map(|part| of_curve(name, part, sample)).collect();
            Ok(json!({ "curve": name, "parts": parts? }))
        }
    }
}

fn of_curve(name: &str, curve: &AnyCurve, sample: &Sample) -> Result<Value, String> {
    if sample.time {
        return Ok(timed::of_curve(name, curve, sample.count));
    }
    let domain = curve.domain();
    let places = if sample.at.is_empty() {
        (0..=sample.count).map(|k| domain.at(f64::from(k) / f64::from(sample.count))).collect()
    } else {
        sample.at.iter().map(|text| parameter(text, domain)).collect::<Result<Vec<_>, _>>()?
    };
    Ok(describe(name, curve, &places))
}

fn parameter(text: &str, domain: Domain) -> Result<f64, String> {
    let t: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if t >= domain.start && t <= domain.end {
        Ok(t)
    } else {
        Err(format!("{t} lies outside the domain, {} to {}", domain.start, domain.end))
    }
}

fn of_shape(name: &str, model: &Model, sample: &Sample) -> Result<Value, String> {
    let shape = model.shapes.iter().find(|shape| shape.name == name);
    let shape = shape.ok_or_else(|| {
        let known: Vec<&str> = model.shapes.iter().map(|shape| shape.name.as_str()).collect();
        format!("there is no shape `{name}`; there is: {}", known.join(", "))
    })?;
    if let Recipe::Patches { patches, .. } = &shape.recipe {
        if let (true, [surface]) = (sample.time, patches.surfaces.as_slice()) {
            return Ok(timed::of_surface(name, surface, sample.count));
        }
        return describe_surfaces(name, &patches.surfaces, &|u, v| surface_places(sample, u, v));
    }
    if let Recipe::Trimmed(shape) = &shape.recipe {
        let whole = core::slice::from_ref(shape.surface());
        return describe_surfaces(name, whole, &|u, v| surface_places(sample, u, v));
    }
    let (surface, swept) = surface(&shape.recipe)
        .ok_or_else(|| format!("shape `{name}` has no surface with parameters u and v"))?;
    let (domain_u, domain_v) = (surface.domain_u(), surface.domain_v());
    let places = surface_places(sample, domain_u, domain_v)?;
    let points: Vec<Value> = places
        .iter()
        .map(|(u, v)| {
            let jet = surface.evaluate(*u, *v);
            let mut place = json!({
                "u": u, "v": v,
                "point": numbers(jet.point), "du": numbers(jet.du), "dv": numbers(jet.dv),
                "normal": numbers(jet.normal),
            });
            if let Some(swept) = &swept {
                place["frame"] = frame(swept, *v, domain_v);
            }
            place
        })
        .collect();
    Ok(json!({
        "shape": name,
        "domain-u": [domain_u.start, domain_u.end],
        "domain-v": [domain_v.start, domain_v.end],
        "samples": points,
    }))
}

/// A surface, and the whole that it belongs to where sections are carried.
type Sampled = (Box<dyn Surface>, Option<Arc<SweptSurface>>);

/// The first surface of a recipe.
fn surface(recipe: &Recipe) -> Option<Sampled> {
    match recipe {
        Recipe::Revolution(revolution) => {
            let surface = RevolvedSurface {
                profile: revolution.profile.clone(),
                start: revolution.start,
                angle: revolution.angle,
            };
            Some((Box::new(surface), None))
        }
        Recipe::Extrusion(extrusion) => {
            let surface = ExtrudedSurface {
                profile: extrusion.outlines[0].clone(),
                bottom: extrusion.bottom,
                height: extrusion.height,
            };
            Some((Box::new(surface), None))
        }
        Recipe::Sweep(sweep) => {
            let surface = Arc::new(sweep.surface());
            Some((Box::new(SweptWall { surface: surface.clone(), outline: 0 }), Some(surface)))
        }
        _ => None,
    }
}

fn frame(surface: &SweptSurface, v: f64, domain: Domain) -> Value {
    let frame = surface.carrier.plane(v, if v >= domain.end { Side::Before } else { Side::After }).frame;
    json!({ "side": numbers(frame.side), "up": numbers(frame.up), "along": numbers(frame.along) })
}

fn surface_places(sample: &Sample, u: Domain, v: Domain) -> Result<Vec<(f64, f64)>, String> {
    if sample.at.is_empty() {
        let count = sample.count.min(4096);
        let part = |k: u32| f64::from(k) / f64::from(count);
        return Ok((0..=count)
            .flat_map(|i| (0..=count).map(move |j| (u.at(part(i)), v.at(part(j)))))
            .collect());
    }
    let pair = |text: &String| {
        let (first, second) = text.split_once(',').ok_or_else(|| format!("`{text}` is not U,V"))?;
        Ok((parameter(first, u)?, parameter(second, v)?))
    };
    sample.at.iter().map(pair).collect()
}

//! Maps of a document into fields.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Builder;
use super::formula::Compiler;
use super::profile::show;
use crate::geometry::map::{GridError, GridField, Interpolation, Method, ScatterError, Scattered};
use crate::geometry::number::noise;
use crate::import::heights::{self, Heights, HeightsError};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{
    Between, FilePath, Map, MapCombine, MapDefinition, MapFormula, MapGrid, MapNoise, MapOperation,
    MapPoints, MapRaw, MapReference, NoData, RawNumber, Scatter, Sp,
};

/// Numbers row by row, and how many stand in a row.
type Grid = (usize, Vec<f64>);

impl Builder<'_> {
    /// The field that a reference names or writes.
    pub(super) fn map_of(&mut self, reference: &MapReference) -> Option<Arc<GridField>> {
        match reference {
            MapReference::Named(name) => self.named_map(&name.value),
            MapReference::Inline(map) => self.map(&map.value, map.span),
        }
    }

    /// The field of a name, built at its first use.
    pub(super) fn named_map(&mut self, name: &str) -> Option<Arc<GridField>> {
        if let Some(known) = self.maps.get(name) {
            return known.clone();
        }
        let definition = self.spec.maps.get(name)?;
        let field = self.map(&definition.value, definition.span);
        self.maps.insert(name.to_owned(), field.clone());
        field
    }

    fn map(&mut self, map: &MapDefinition, span: Span) -> Option<Arc<GridField>> {
        let gaps = map.options.no_data.as_ref().map(|no_data| no_data.value);
        let (columns, mut values) = match &map.kind {
            Map::Image(image) => {
                let limit = self.spec.limits.samples();
                self.file_heights(&image.file, gaps, Code::MapImage, |bytes| heights::png(bytes, limit))?
            }
            Map::Raw(raw) => self.raw_heights(raw, gaps)?,
            Map::Grid(grid) => self.grid_heights(grid, gaps)?,
            Map::Points(points) => self.scattered(points)?,
            Map::Formula(formula) => self.formula_heights(formula, gaps)?,
            Map::Noise(noise) => self.noise_heights(noise, span)?,
            Map::Combine(combine) => self.combined(combine)?,
        };
        if let Some(NoData::Number(number)) = gaps {
            values.iter_mut().filter(|value| **value == number).for_each(|value| *value = f64::NAN);
        }
        // What has no value by now was allowed to have none.
        let unknown: Vec<bool> = values.iter().map(|value| !value.is_finite()).collect();
        if !unknown.is_empty() && !unknown.contains(&false) {
            let report = Diagnostic::error(Code::NoValue, "no sample of this map has a value")
                .at(span, "nothing but holes")
                .help("check `no-data`");
            self.report(report);
            return None;
        }
        let interpolation = match map.options.interpolation.value {
            Between::Bilinear => Interpolation::Bilinear,
            Between::Bicubic => Interpolation::Bicubic,
        };
        match GridField::with_gaps(columns, values, unknown, interpolation) {
            Ok(field) => Some(Arc::new(field)),
            Err(error) => {
                self.report(match error {
                    GridError::TooSmall { .. } => {
                        Diagnostic::error(Code::MapSize, error.to_string()).at(span, "spans no area")
                    }
                    GridError::NotFinite { .. } => {
                        Diagnostic::error(Code::NoValue, error.to_string()).at(span, "this map")
                    }
                });
                None
            }
        }
    }

    /// Refuses more samples than the pixels of an image may be.
    fn allow_samples(&mut self, columns: u32, rows: u32, span: Span) -> Option<()> {
        let limit = self.spec.limits.samples();
        if u64::from(columns) * u64::from(rows) <= limit {
            return Some(());
        }
        let message = format!("this map has {columns} x {rows} samples, more than the limit of {limit}");
        self.report(
            Diagnostic::error(Code::LimitPassed, message)
                .at(span, "too many")
                .help("write fewer columns and rows; where [limits] lowers `image-pixels` or `memory`, write more there"),
        );
        None
    }

    /// Refuses more steps for all samples than a document may take.
    fn allow_steps(&mut self, [columns, rows]: [u32; 2], each: u64, span: Span) -> Option<()> {
        let limit = self.spec.limits.steps;
        let steps = (u64::from(columns) * u64::from(rows)).saturating_mul(each);
        if steps <= limit {
            return Some(());
        }
        let message = format!("the samples of this map take {steps} steps, more than the limit of {limit}");
        self.report(
            Diagnostic::error(Code::LimitPassed, message)
                .at(span, "too many")
                .help("write fewer columns and rows; `interpolation = \"bicubic\"` is smooth between them"),
        );
        None
    }

    fn file_heights(
        &mut self,
        file: &Sp<FilePath>,
        gaps: Option<NoData>,
        code: Code,
        read: impl FnOnce(&[u8]) -> Result<Heights, HeightsError>,
    ) -> Option<Grid> {
        let bytes = match self.files.read(&file.value.resolved) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.file_fault(&error, file);
                return None;
            }
        };
        match read(&bytes) {
            Ok(heights) => self.with_values(heights, gaps, file),
            Err(error) => {
                let message = format!("{} cannot be a map: {error}", file.value.written);
                let code =
                    if matches!(error, HeightsError::TooLarge { .. }) { Code::LimitPassed } else { code };
                let report = Diagnostic::error(code, message).at(file.span, "this file");
                self.report(match hint(&error) {
                    Some(hint) => report.help(hint),
                    None => report,
                });
                None
            }
        }
    }

    /// The numbers of a file. Those without a value are errors, or NaN where there may be gaps.
    fn with_values(&mut self, heights: Heights, gaps: Option<NoData>, file: &Sp<FilePath>) -> Option<Grid> {
        let Heights { columns, mut values, no_data } = heights;
        if gaps.is_some() {
            values.iter_mut().filter(|value| Some(**value) == no_data).for_each(|value| *value = f64::NAN);
            return Some((columns, values));
        }
        let lost = values.iter().position(|value| !value.is_finite() || Some(*value) == no_data);
        let Some(at) = lost else { return Some((columns, values)) };
        let (row, column) = (at / columns, at % columns);
        let why = if Some(values[at]) == no_data {
            "is marked as having no value"
        } else {
            "is not a finite number"
        };
        let message =
            format!("row {row}, column {column} of {} {why} ({})", file.value.written, show(values[at]));
        let report = Diagnostic::error(Code::NoValue, message)
            .at(file.span, "this file")
            .help("write `no-data = \"marked\"` beside the kind of the map to leave holes there, or fill them in the program that made it");
        self.report(report);
        None
    }

    fn raw_heights(&mut self, raw: &MapRaw, gaps: Option<NoData>) -> Option<Grid> {
        let number = match raw.number.value {
            RawNumber::U8 => heights::RawNumber::U8,
            RawNumber::U16 => heights::RawNumber::U16,
            RawNumber::I16 => heights::RawNumber::I16,
            RawNumber::F32 => heights::RawNumber::F32,
            RawNumber::F64 => heights::RawNumber::F64,
        };
        let (size, skip) = ([raw.columns.value, raw.rows.value], raw.skip.value);
        let limit = self.spec.limits.samples();
        self.file_heights(&raw.file, gaps, Code::MapFile, |bytes| {
            heights::raw(bytes, size, (number, skip), limit)
        })
    }

    fn grid_heights(&mut self, grid: &MapGrid, gaps: Option<NoData>) -> Option<Grid> {
        if let Some(file) = &grid.file {
            let limit = self.spec.limits.samples();
            return self.file_heights(file, gaps, Code::MapFile, |bytes| heights::ascii_grid(bytes, limit));
        }
        let rows = grid.rows.as_ref()?;
        Some((rows.columns(), rows.items().map(|number| number.value).collect()))
    }

    fn scattered(&mut self, written: &MapPoints) -> Option<Grid> {
        self.allow_samples(written.columns.value, written.rows.value, written.columns.span)?;
        let points: Vec<DVec3> = written.points.iter().map(|point| point.value).collect();
        let flat = || points.iter().map(|point| point.truncate());
        let from = written.from.map_or_else(|| flat().fold(DVec2::INFINITY, DVec2::min), |from| from.value);
        let to = written.to.map_or_else(|| flat().fold(DVec2::NEG_INFINITY, DVec2::max), |to| to.value);
        let method = match written.method.value {
            Scatter::Linear => Method::Linear,
            Scatter::NaturalNeighbor => Method::NaturalNeighbor,
            Scatter::Shepard => Method::Shepard,
        };
        let field = match Scattered::new(points, method) {
            Ok(field) => field,
            Err(error) => {
                let report = Diagnostic::error(Code::MapPoints, error.to_string());
                self.report(match error {
                    ScatterError::Repeated { first, second } => report
                        .at(written.points[second].span, "this point")
                        .also(written.points[first].span, "the same place"),
                    ScatterError::OnLine => report.at(written.points[0].span, "this and all others"),
                });
                return None;
            }
        };
        Some(sampled([written.columns.value, written.rows.value], from, to, |x, y| field.value(x, y)))
    }

    fn formula_heights(&mut self, written: &MapFormula, gaps: Option<NoData>) -> Option<Grid> {
        self.allow_samples(written.columns.value, written.rows.value, written.columns.span)?;
        let mut compiler = Compiler::new(&["x", "y"]);
        let output = match compiler.add(&written.f.value) {
            Ok(slot) => slot,
            Err(diagnostic) => {
                self.report(*diagnostic);
                return None;
            }
        };
        let formula = compiler.finish(vec![output]).formula;
        let size = [written.columns.value, written.rows.value];
        self.allow_steps(size, formula.steps(), written.columns.span)?;
        let (from, to) = (written.from.value, written.to.value);
        let grid = sampled(size, from, to, |x, y| {
            let [value] = formula.evaluate::<f64, 1>(&[x, y]);
            value
        });
        let lost = grid.1.iter().position(|value| !value.is_finite()).filter(|_| gaps.is_none());
        let Some(at) = lost else { return Some(grid) };
        let place = |k: usize, count: u32, from: f64, to: f64| {
            show(from + (to - from) * (k as f64 / f64::from(count - 1)))
        };
        let x = place(at % grid.0, size[0], from.x, to.x);
        let y = place(at / grid.0, size[1], from.y, to.y);
        let message = format!("the formula has no finite value at x = {x}, y = {y}");
        let report = Diagnostic::error(Code::NoValue, message)
            .at(written.f.span, "this formula")
            .help("let `from` and `to` leave such places out, or say with `if` what holds there");
        self.report(report);
        None
    }

    fn noise_heights(&mut self, written: &MapNoise, span: Span) -> Option<Grid> {
        let size = [written.columns.value, written.rows.value];
        let place = if written.columns.span.is_none() { span } else { written.columns.span };
        self.allow_samples(size[0], size[1], place)?;
        self.allow_steps(size, NOISE_STEPS * u64::from(written.octaves.value), place)?;
        let (gain, seed) = (written.gain.value, written.seed.value);
        let layers: Vec<(f64, f64)> = (0..written.octaves.value)
            .scan((1.0, 1.0), |(scale, height), _| {
                let layer = (*scale, *height);
                (*scale, *height) = (*scale * 2.0, *height * gain);
                Some(layer)
            })
            .collect();
        let most: f64 = layers.iter().map(|(_, height)| height).sum();
        // Half of a hill and half of a hollow lie in each cell of the noise; its lattice, where all layers are 0, is
        // kept off the borders.
        let offset = DVec2::new(0.37, 0.71);
        Some(sampled(size, offset, offset + written.hills.value, |x, y| {
            let sum = layers.iter().zip(0_u32..).map(|((scale, height), layer)| {
                height * noise(seed + 1013.0 * f64::from(layer), x * scale, y * scale)
            });
            sum.sum::<f64>() / most
        }))
    }

    fn combined(&mut self, written: &MapCombine) -> Option<Grid> {
        let fields: Vec<_> = written.of.iter().map(|map| self.map_of(map)).collect();
        let fields: Vec<Arc<GridField>> = fields.into_iter().collect::<Option<_>>()?;
        let (columns, rows) = (fields[0].columns(), fields[0].rows());
        let weight = |k: usize| written.weights.as_ref().map_or(1.0, |weights| weights.value[k]);
        let value = |k: usize, i: usize, j: usize| {
            let [right, bottom] = fields[k].extent();
            let x = right * (i as f64 / (columns - 1) as f64);
            let y = bottom * (j as f64 / (rows - 1) as f64);
            if fields[k].knows_at(x, y) { weight(k) * fields[k].value(x, y) } else { f64::NAN }
        };
        let operation = written.operation.value;
        let join = |one: f64, other: f64| match operation {
            MapOperation::Add => one + other,
            MapOperation::Subtract => one - other,
            MapOperation::Multiply => one * other,
            // The functions of the standard library would take a number instead of no value.
            MapOperation::Min if one < other || one.is_nan() => one,
            MapOperation::Max if one > other || one.is_nan() => one,
            MapOperation::Min | MapOperation::Max => other,
        };
        let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let values =
            places.map(|(i, j)| (1..fields.len()).fold(value(0, i, j), |all, k| join(all, value(k, i, j))));
        Some((columns, values.collect()))
    }
}

/// Steps of one octave of noise at one place.
const NOISE_STEPS: u64 = 8;

/// What to do about a file that is no map.
fn hint(error: &HeightsError) -> Option<&'static str> {
    match error {
        HeightsError::TooLarge { .. } => {
            Some("scale it down; where [limits] lowers `image-pixels` or `memory`, write more there")
        }
        HeightsError::Look { .. } | HeightsError::NotPng => {
            Some("save it as a grey PNG, for heights with 16 bits")
        }
        HeightsError::Damaged(_) => Some("save it again from the program that made it"),
        HeightsError::Length { .. } => Some("check `columns`, `rows`, `number` and `skip`"),
        HeightsError::Text { .. } => None,
    }
}

/// A function on a grid; the last sample stands at `to` to the last bit.
fn sampled(size: [u32; 2], from: DVec2, to: DVec2, f: impl Fn(f64, f64) -> f64) -> Grid {
    let [columns, rows] = size.map(|count| count as usize);
    let place = |k: usize, count: usize, from: f64, to: f64| {
        let part = k as f64 / (count - 1) as f64;
        from * (1.0 - part) + to * part
    };
    let y = |j: usize| place(j, rows, from.y, to.y);
    let x = |i: usize| place(i, columns, from.x, to.x);
    (columns, (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| f(x(i), y(j))).collect())
}

//! What is told of an asset, and the files that it is written to.

use serde_json::json;

use crate::cache::{Baked, OutputFile};
use crate::compile::Compiled;
use crate::report::{DeviationFacts, Kind, Report, ShapeFacts};

/// An asset with the bytes of its files. Its line is what follows its path.
pub(crate) fn baked(spec: &str, compiled: Compiled) -> std::io::Result<(Baked, Vec<Vec<u8>>)> {
    let line = line(&compiled);
    let report_file = compiled.report_file()?;
    let Compiled { bytes, file, pictures, profile, report, warnings, .. } = compiled;
    let facts = json!({
        "asset": null,
        "spec": spec,
        "variant": report.as_ref().and_then(|report| report.variant.clone()),
        "profile": profile.name(),
        "bytes": bytes.len(),
        "triangles": report.as_ref().map(|report| report.totals.triangles),
        "deviation": report.as_ref().and_then(worst),
    });
    let written = std::iter::once((file.clone(), bytes)).chain(report_file).chain(pictures);
    let (names, all): (Vec<String>, Vec<Vec<u8>>) = written.unzip();
    let files = names.iter().zip(&all).map(|(name, bytes)| OutputFile::of(name, bytes)).collect();
    Ok((Baked { file, line, facts, files, warnings: warnings.into_vec() }, all))
}

/// The greatest deviation of all shapes, coarser levels of detail left out.
fn worst(report: &Report) -> Option<DeviationFacts> {
    let coarser = report.lods.values().flat_map(|levels| levels.iter().skip(1));
    let finest = |(name, _): &(&String, &ShapeFacts)| !coarser.clone().any(|level| level.mesh == **name);
    let deviations = report.shapes.iter().filter(finest).map(|(_, shape)| shape.deviation);
    deviations.max_by(|a, b| a.bound.total_cmp(&b.bound))
}

/// What is told of an asset behind its name.
pub(super) fn line(compiled: &Compiled) -> String {
    let bytes = size(compiled.bytes.len());
    let Some(report) = &compiled.report else { return bytes };
    let accuracy = worst(report).map_or_else(String::new, |deviation| {
        let how = match deviation.kind {
            Kind::Exact => "exact".to_owned(),
            Kind::Proved => format!("within {} (proved)", metres(deviation.bound)),
            Kind::Sampled => format!("within {} (sampled)", metres(deviation.bound)),
        };
        let measured =
            deviation.measured.map_or_else(String::new, |found| format!(", measured {}", metres(found)));
        format!("  {how}{measured}")
    });
    let drawn = match (report.totals.triangles, report.totals.segments) {
        (triangles, 0) => format!("{triangles} triangles"),
        (0, segments) => format!("{segments} line segments"),
        (triangles, segments) => format!("{triangles} triangles  {segments} line segments"),
    };
    let levels = match report.lods.values().map(Vec::len).max() {
        Some(count) if count > 1 => format!("  {count} levels"),
        _ => String::new(),
    };
    format!("{drawn}{levels}  {bytes}{accuracy}")
}

/// A length for people.
fn metres(length: f64) -> String {
    match length {
        _ if length >= 1.0 => format!("{length:.3} m"),
        _ if length >= 1e-3 => format!("{:.3} mm", length * 1e3),
        _ => format!("{:.3} um", length * 1e6),
    }
}

/// A number of bytes for people.
pub(crate) fn size(bytes: usize) -> String {
    match bytes as f64 {
        bytes if bytes >= 1e9 => format!("{:.1} GB", bytes / 1e9),
        bytes if bytes >= 1e6 => format!("{:.1} MB", bytes / 1e6),
        bytes if bytes >= 1e3 => format!("{:.1} kB", bytes / 1e3),
        bytes => format!("{bytes} B"),
    }
}

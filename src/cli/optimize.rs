//! `kiln optimize`: a glTF file of whatever maker, small and quick to draw.

use std::path::Path;

use serde_json::json;

use super::Outcome;
use super::arguments::Optimize;
use super::input::{beside, read};
use super::output::Printer;
use crate::project::{reason, save};
use crate::repack::{Change, Codec, Options, Report, repacked};

pub(crate) fn run(optimize: &Optimize, printer: &Printer) -> Outcome {
    if optimize.out.extension().and_then(|ending| ending.to_str()) != Some("glb") {
        let message = format!("write a file that ends in .glb, not {}", optimize.out.display());
        printer.failure(&message, None);
        return Outcome::Usage;
    }
    let failed = |path: &Path, message: &str, outcome: Outcome| {
        printer.failure(&format!("{}: {message}", path.display()), None);
        outcome
    };
    let bytes = match read(&optimize.file) {
        Ok(bytes) => bytes,
        Err(message) => return failed(&optimize.file, &message, Outcome::Files),
    };
    let options = Options {
        profile: optimize.profile,
        tolerance: optimize.tolerance,
        codec: if optimize.codec == 1 { Codec::One } else { Codec::Zero },
        shortest: true,
        texture_size: optimize.texture_size,
        compress_textures: optimize.compress_textures,
    };
    let folder = optimize.file.parent().unwrap_or(Path::new("")).to_path_buf();
    let made = match repacked(&bytes, &options, &mut |path| beside(&folder, path)) {
        Ok(made) => made,
        Err(fault) => return failed(&optimize.file, &fault.to_string(), Outcome::Errors),
    };
    drop(bytes);
    let object = serde_json::to_value(&made.report).unwrap_or_default();
    let text = serde_json::to_string_pretty(&object).unwrap_or_default();
    let report = optimize.report.as_deref().map(|path| (path, text.as_bytes()));
    for (path, bytes) in [(optimize.out.as_path(), made.bytes.as_slice())].into_iter().chain(report) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if let Err(error) = save(folder, &[(&name, bytes)]) {
            return failed(path, &reason(&error), Outcome::Files);
        }
    }
    for note in &made.report.notes {
        printer.warning(note);
    }
    let told = json!({ "file": optimize.out.display().to_string(), "optimized": object });
    printer.result(&described(optimize, &made.report), &told);
    Outcome::Good
}

fn described(optimize: &Optimize, report: &Report) -> String {
    let Report { bytes, triangles, vertices, acmr, errors, .. } = report;
    let whole = |change: &Change<u64>| format!("{} -> {}", change.before, change.after);
    let mut lines = vec![
        format!("{} ({})", optimize.out.display(), optimize.profile.name()),
        format!("  bytes      {}", whole(bytes)),
        format!("  triangles  {}", whole(triangles)),
        format!("  vertices   {}", whole(vertices)),
        format!("  ACMR       {:.3} -> {:.3}", acmr.before, acmr.after),
    ];
    let off = [
        ("positions", errors.positions, ""),
        ("normals", errors.normals, " degrees"),
        ("tangents", errors.tangents, " degrees"),
        ("UVs", errors.uvs, ""),
        ("colors", errors.colors, ""),
        ("weights", errors.weights, ""),
        ("rotations", errors.rotations, " degrees"),
        ("moves", errors.translations, ""),
        ("scales", errors.scales, ""),
        ("morphs", errors.morphs, ""),
    ];
    for (name, error, unit) in off.into_iter().filter(|(_, error, _)| *error > 0.0) {
        lines.push(format!("  {name:<9}  within {error:.2e}{unit}"));
    }
    lines.join("\n")
}

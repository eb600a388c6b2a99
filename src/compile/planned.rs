//! What is known of an asset before its surfaces are cut: the names of its files, and what making them will take.

use super::file::{file_name, same_file};
use super::profile::profiles;
use super::{Options, state};
use crate::language::Document;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::Files;
use crate::realize;

/// The names of the files that a document certainly becomes, without making them; levels of detail in files of their own are
/// not among them, for some may turn out to be none, nor pictures beside files. All files that a bake would read are read.
///
/// # Errors
/// Everything that is wrong with the document before its surfaces are cut.
pub fn outputs(
    document: &Document,
    files: &dyn Files,
    options: &Options,
) -> Result<Vec<String>, Diagnostics> {
    let (spec, _) = document.spec(options.variant.as_deref(), &options.overrides)?;
    state::model(document, &spec, files, options)?;
    let profiles = profiles(&spec, options);
    if let Some(same) = same_file(document, &spec, &profiles) {
        return Err(document.diagnostics(vec![same]));
    }
    Ok(profiles.into_iter().map(|profile| file_name(options, profile, 0)).collect())
}

/// Bytes of memory that compiling one asset of a document takes at its most, estimated from the exact model; nothing is cut
/// into triangles. See [`realize::memory`].
///
/// # Errors
/// Everything that is wrong with the document before its surfaces are cut.
pub fn estimated_memory(
    document: &Document,
    files: &dyn Files,
    options: &Options,
) -> Result<u64, Diagnostics> {
    let (spec, _) = document.spec(options.variant.as_deref(), &options.overrides)?;
    let built = state::model(document, &spec, files, options)?;
    let profiles = profiles(&spec, options);
    let both = profiles.iter().any(|profile| profile.is_quantized())
        && profiles.iter().any(|profile| !profile.is_quantized());
    let once = realize::memory(&built.model);
    // A scene of floats stays while one of whole numbers is made, and a level has at most half of the triangles of the one before.
    let parts = 1 + u64::from(both) + u64::from(spec.lod.is_some());
    Ok(once.saturating_mul(parts))
}

//! Names of the files of an asset.

use super::Options;
use super::engine::level_form;
use crate::gltf::Profile;
use crate::language::Document;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{LodForm, Spec};

/// The file of an asset: `NAME.glb`, with the variant, the level of detail and every profile but `core` before the end.
pub(super) fn file_name(options: &Options, profile: Profile, level: usize) -> String {
    let variant = options.variant.as_deref().map_or_else(String::new, |variant| format!(".{variant}"));
    let level = if level == 0 { String::new() } else { format!(".{}", level_name(level)) };
    let profile = if profile == Profile::Core { String::new() } else { format!(".{}", profile.name()) };
    format!("{}{variant}{level}{profile}.glb", options.name)
}

/// A level as the name of its file says it.
fn level_name(level: usize) -> String {
    format!("lod{level}")
}

/// A variant whose file would have the name of that of a profile or a level.
pub(super) fn same_file(document: &Document, spec: &Spec, profiles: &[Profile]) -> Option<Diagnostic> {
    let variants = document.variants();
    let among = |name: &str| variants.iter().any(|variant| variant == name);
    let named = profiles.iter().filter(|profile| **profile != Profile::Core).map(|profile| profile.name());
    let same = named.map(|name| ("profile", name.to_owned())).find(|(_, name)| among(name));
    let in_files =
        spec.lod.is_some() && profiles.iter().any(|profile| level_form(*profile, spec) == LodForm::Files);
    let levels = (1..=8).map(level_name).filter(|_| in_files);
    let (kind, same) = same.or_else(|| levels.map(|name| ("level", name)).find(|(_, name)| among(name)))?;
    let message = format!("the variant `{same}` and the {kind} `{same}` would be written to one file");
    Some(Diagnostic::error(Code::SameFile, message).at(Span::NONE, "").help("give the variant another name"))
}

//! For whom the files of an asset are.

use super::Options;
use crate::gltf::Profile;
use crate::language::spec::{OutputProfile, Spec};

/// For whom an asset is, each once.
pub(super) fn profiles(spec: &Spec, options: &Options) -> Vec<Profile> {
    let mut all = options.profiles.clone();
    if all.is_empty() {
        let named = spec.output.profiles.iter().flat_map(|list| &list.value);
        all = named.map(|profile| profile_of(profile.value)).collect();
    }
    let mut seen = Vec::new();
    all.retain(|profile| {
        !seen.contains(profile) && {
            seen.push(*profile);
            true
        }
    });
    if all.is_empty() { vec![Profile::default()] } else { all }
}

/// The profile that a document or a project names.
pub(crate) fn profile_of(name: OutputProfile) -> Profile {
    match name {
        OutputProfile::Core => Profile::Core,
        OutputProfile::Quantized => Profile::Quantized,
        OutputProfile::Web => Profile::Web,
        OutputProfile::Verify => Profile::Verify,
        OutputProfile::Bevy => Profile::Bevy,
        OutputProfile::Godot => Profile::Godot,
        OutputProfile::Unreal => Profile::Unreal,
        OutputProfile::Unity => Profile::Unity,
        OutputProfile::Three => Profile::Three,
        OutputProfile::Babylon => Profile::Babylon,
        OutputProfile::Blender => Profile::Blender,
    }
}

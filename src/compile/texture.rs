//! Pictures as small as `[output.textures]` asks for.

use rayon::prelude::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use super::profile_of;
use crate::gltf::Profile;
use crate::import::image::{Edge, ImageError, Meaning, Wish, fitted};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::Spec;
use crate::scene::{ImageKind, Scene, Texture, TextureUse, Wrap};

/// Makes the pictures of a scene as small as a document asks for in the files of a profile.
///
/// # Errors
/// A picture that cannot be decoded; its header was checked before.
pub(super) fn fit(scene: &mut Scene, spec: &Spec, profile: Profile) -> Result<(), Vec<Diagnostic>> {
    let Some(asked) = &spec.output.textures else { return Ok(()) };
    let most = asked.value.max_size.as_ref().and_then(|most| most.of(|name| profile_of(name) == profile));
    let wish = Wish { most: most.map(|most| most.value.0), compress: asked.value.compress.value };
    let uses = uses(scene);
    let fit = |(image, own): (&mut crate::scene::Image, &(Meaning, [Edge; 2]))| -> Result<(), ImageError> {
        if let Some(made) = fitted(&image.bytes, *own, wish, spec.limits.pixels())? {
            (image.bytes, image.kind) = (made.into(), ImageKind::Png);
        }
        Ok(())
    };
    let done: Vec<Result<(), ImageError>> = scene.images.par_iter_mut().zip(&uses).map(fit).collect();
    let broken = |(number, result): (usize, Result<(), ImageError>)| {
        let error = result.err()?;
        let message = format!("picture `{}` cannot be made smaller: {error}", scene.images[number].name);
        Some(Diagnostic::error(Code::BadImage, message).at(asked.span, "asked for here"))
    };
    let broken: Vec<Diagnostic> = done.into_iter().enumerate().filter_map(broken).collect();
    if broken.is_empty() { Ok(()) } else { Err(broken) }
}

/// Whether the pictures of a profile's files stand beside them.
pub(super) fn beside(spec: &Spec, profile: Profile) -> bool {
    let own = spec.output.textures.as_ref().and_then(|asked| asked.value.beside.as_ref());
    own.and_then(|beside| beside.of(|name| profile_of(name) == profile)).is_some_and(|beside| beside.value)
}

/// What each picture is for: a color where any material shows it as one.
fn uses(scene: &Scene) -> Vec<(Meaning, [Edge; 2])> {
    let mut uses = vec![(Meaning::Data, [Edge::Repeat; 2]); scene.images.len()];
    let mut note = |texture: &Texture, meaning: Meaning| {
        let edge = match texture.wrap {
            Wrap::Repeat => Edge::Repeat,
            Wrap::Clamp => Edge::Clamp,
            Wrap::Mirror => Edge::Mirror,
        };
        let known = &mut uses[texture.image.0 as usize];
        let stays = known.0 == Meaning::Color || meaning == Meaning::Data;
        *known = (if stays { known.0 } else { meaning }, [edge; 2]);
    };
    for material in &scene.materials {
        for (texture, own) in material.textures() {
            note(
                texture,
                match own {
                    TextureUse::Color => Meaning::Color,
                    TextureUse::Normal => Meaning::Normal,
                    TextureUse::Data => Meaning::Data,
                },
            );
        }
    }
    uses
}

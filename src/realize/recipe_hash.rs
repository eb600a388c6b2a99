//! What a realized shape depends on, as a hash.
//!
//! Promise: two shapes with one hash are made into the same mesh. It holds the recipe of the shape and of all that it is made
//! of, with every number of theirs, and no name, no place in a text, no material: which slots wear the same one matters, what it
//! looks like does not. Handles count in the order in which they are met, so that a definition that is added elsewhere changes
//! nothing. Numbers are hashed as they print, which tells all of them apart, but for long lists, which are hashed as bytes.

use std::fmt::{Debug, Write};
use std::sync::OnceLock;

use blake3::{Hash, Hasher};

use crate::geometry::mesh::PolygonMesh;
use crate::model::{
    Displacement, MaterialHandle, Model, Recipe, ShapeHandle, ShapeOptions, SolidRecipe, SubdivisionRecipe,
};

/// The hashes of a model's shapes, each made when it is first asked for.
#[derive(Debug)]
pub(super) struct RecipeHashes<'a> {
    pub(super) model: &'a Model,
    own: Vec<OnceLock<Hash>>,
}

/// Shapes and materials in the order in which a shape comes to them.
#[derive(Debug, Default)]
pub(super) struct Met {
    pub(super) shapes: Vec<ShapeHandle>,
    pub(super) materials: Vec<MaterialHandle>,
}

/// Text on its way into a hash.
struct Feed {
    hasher: Hasher,
    text: String,
}

/// How much text is gathered before it is hashed.
const GATHERED: usize = 1 << 14;

impl Write for Feed {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.text.push_str(text);
        if self.text.len() >= GATHERED {
            self.flush();
        }
        Ok(())
    }
}

impl Feed {
    fn new() -> Self {
        Self { hasher: Hasher::new(), text: String::new() }
    }

    fn flush(&mut self) {
        self.hasher.update(self.text.as_bytes());
        self.text.clear();
    }

    fn add(&mut self, value: &dyn Debug) -> &mut Self {
        // A string takes all that is written to it.
        let _ = write!(self, "{value:?};");
        self
    }

    fn numbers(&mut self, count: usize, numbers: impl Iterator<Item = f64>) {
        let _ = write!(self, "{count};");
        self.flush();
        for number in numbers {
            self.hasher.update(&number.to_bits().to_le_bytes());
        }
    }

    fn finish(mut self) -> Hash {
        self.flush();
        self.hasher.finalize()
    }
}

impl<'a> RecipeHashes<'a> {
    pub(super) fn new(model: &'a Model) -> Self {
        Self { model, own: model.shapes.iter().map(|_| OnceLock::new()).collect() }
    }

    /// Adds a shape with all that it is made of to a hash, and tells what was met.
    pub(super) fn feed(&self, shape: ShapeHandle, hasher: &mut Hasher) -> Met {
        let mut met = Met::default();
        self.visit(shape, hasher, &mut met);
        met
    }

    fn visit(&self, handle: ShapeHandle, hasher: &mut Hasher, met: &mut Met) {
        if let Some(known) = met.shapes.iter().position(|known| *known == handle) {
            hasher.update(b"again").update(&(known as u64).to_le_bytes());
            return;
        }
        met.shapes.push(handle);
        let shape = self.model.shape(handle);
        hasher.update(
            self.own[handle.0 as usize].get_or_init(|| own(&shape.recipe, &shape.options)).as_bytes(),
        );
        let drawn = self.model.normal_maps.iter().find(|map| map.shape == handle).map(|map| map.material);
        let slots = materials(&shape.recipe).iter().chain([&shape.options.material, &drawn]);
        for slot in slots {
            let place = slot.map_or(u64::MAX, |material| met.material(material));
            hasher.update(&place.to_le_bytes());
        }
        for part in parts(&shape.recipe) {
            self.visit(part, hasher, met);
        }
    }
}

impl Met {
    /// The place of a material among those that were met.
    fn material(&mut self, material: MaterialHandle) -> u64 {
        let known = self.materials.iter().position(|known| *known == material);
        known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        }) as u64
    }
}

/// The shapes that a shape is made of, in their order.
fn parts(recipe: &Recipe) -> Vec<ShapeHandle> {
    match recipe {
        Recipe::Assembly(parts) => parts.iter().map(|(part, _)| *part).collect(),
        Recipe::Deformed { of, .. } | Recipe::Displaced(Displacement { of, .. }) => vec![*of],
        Recipe::Solid(solid) => solid.parts.clone(),
        Recipe::Subdivided(refined) => vec![refined.cage],
        Recipe::Implicit { shapes, .. } => shapes.clone(),
        _ => Vec::new(),
    }
}

/// The materials that a recipe itself names.
fn materials(recipe: &Recipe) -> &[Option<MaterialHandle>] {
    match recipe {
        Recipe::Patches { materials, .. }
        | Recipe::Implicit { materials, .. }
        | Recipe::Polygons { materials, .. } => materials,
        _ => &[],
    }
}

/// A recipe without the shapes that it is made of and without materials, and what holds for its result.
fn own(recipe: &Recipe, options: &ShapeOptions) -> Hash {
    let ShapeOptions {
        tolerance,
        density,
        smoothing,
        crease_angle,
        uv,
        uv_mapping,
        uv_scale,
        vertex_color,
        material: _,
        placement,
        // Both are baked into what has been made.
        lightmap: _,
        occlusion: _,
    } = options;
    let mut feed = Feed::new();
    feed.add(&(tolerance, density, smoothing, crease_angle, uv, uv_mapping, uv_scale));
    feed.add(&(vertex_color, placement));
    match recipe {
        Recipe::Assembly(parts) => {
            feed.add(&"assembly");
            parts.iter().for_each(|(_, map)| _ = feed.add(map));
        }
        Recipe::Deformed { of: _, by } => _ = feed.add(&"deformed").add(by),
        Recipe::Displaced(Displacement { of: _, heights }) => _ = feed.add(&"displaced").add(heights),
        Recipe::Solid(SolidRecipe { parts: _, operation }) => _ = feed.add(&"solid").add(operation),
        Recipe::Subdivided(refined) => {
            let SubdivisionRecipe {
                cage: _,
                scheme,
                levels,
                limit,
                border_corners,
                creases,
                corners,
                triangulate,
            } = refined;
            feed.add(&(scheme, levels, limit, border_corners, triangulate)).add(&(creases, corners));
        }
        Recipe::Patches { patches, materials } => _ = feed.add(patches).add(&materials.len()),
        Recipe::Implicit { surface, shapes: _, materials, colors } => {
            feed.add(surface).add(&materials.len()).add(colors);
        }
        Recipe::Polygons { mesh, materials } => {
            feed.add(&materials.len());
            polygons(&mut feed, mesh);
        }
        whole => _ = feed.add(whole),
    }
    feed.finish()
}

fn polygons(feed: &mut Feed, mesh: &PolygonMesh) {
    let PolygonMesh {
        points,
        corners,
        loop_ends,
        faces,
        uvs,
        corner_uvs,
        normals,
        corner_normals,
        colors,
        corner_colors,
        creases,
        sharp_points,
        materials,
        has_smoothing,
        smoothing_masks,
    } = mesh;
    for list in [points, normals] {
        feed.numbers(list.len(), list.iter().flat_map(|place| place.to_array()));
    }
    feed.numbers(uvs.len(), uvs.iter().flat_map(|place| place.to_array()));
    feed.numbers(corners.len(), corners.iter().map(|corner| f64::from(corner.0)));
    for list in [loop_ends, corner_uvs, corner_normals, corner_colors] {
        feed.numbers(list.len(), list.iter().map(|index| f64::from(*index)));
    }
    feed.add(faces).add(colors).add(&(creases, sharp_points)).add(&(
        materials,
        has_smoothing,
        smoothing_masks,
    ));
}

#[cfg(test)]
mod tests {
    use blake3::{Hash, Hasher};

    use super::RecipeHashes;
    use crate::compile::{Options, model};
    use crate::language::Document;
    use crate::language::source::MemoryFiles;
    use crate::model::ShapeHandle;

    /// The hash of the shape `s` of a document.
    fn of(text: &str) -> Hash {
        let files = MemoryFiles::new().with("a.toml", text);
        let document = Document::load("a.toml", &files).unwrap();
        let model = model(&document, &files, &Options::default()).unwrap();
        let place = model.shapes.iter().position(|shape| shape.name == "s").unwrap();
        let mut hasher = Hasher::new();
        RecipeHashes::new(&model).feed(ShapeHandle(u32::try_from(place).unwrap()), &mut hasher);
        hasher.finalize()
    }

    #[test]
    fn a_field_depends_on_the_shapes_in_it_and_on_no_others() {
        let text = |before: &str, size: f64| {
            format!(
                "{before}[shape.b.box]\nsize = [{size}, 1, 1]\n[field.f.shape]\nof = \"b\"\n\
                 [shape.s.implicit]\nfield = {{ union = {{ of = [\"f\", {{ sphere = {{ radius = 1 }} }}] }} }}\n"
            )
        };
        let other = "[shape.a.sphere]\nradius = 2\n";
        assert_eq!(of(&text("", 1.0)), of(&text(other, 1.0)));
        assert_ne!(of(&text("", 1.0)), of(&text("", 1.5)));
    }
}

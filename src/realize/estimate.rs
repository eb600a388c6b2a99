//! How much memory a model will take, guessed before any of it is made.
//!
//! Promise: quick, by the recipes alone; larger for a finer tolerance, a denser grid and more copies. It is meant for telling
//! heavy assets from light ones, so that not too many heavy ones are made at one time. Not promised: that it is right. A smooth
//! surface counts as if it were round wherever it is, so that what is flat is guessed too heavy, and what is wrinkled far below
//! its size too light.

use super::extents::{Extents, extents};
use crate::geometry::mesh;
use crate::geometry::number::floor_index;
use crate::model::{Density, Model, Recipe, Shape, ShapeHandle};

/// Bytes that a triangle of the scene takes at the most crowded moment, its file and its measuring included. Measured on spheres
/// of 0.3 to 1.3 million triangles: 110 to 170.
const OF_SCENE: u64 = 150;

/// Bytes that a triangle takes while solids are joined. Measured on a union of two spheres: 740.
const OF_SOLID: u64 = 800;

/// Triangles of a smooth surface for each tolerance that its box is long. A sphere of radius r with chords of height t has about
/// 6.4 r / t triangles in rows, and the diagonal of its box is 3.46 r.
const ROUND: f64 = 1.86;

/// What the program takes for a document of which nothing is known.
const LEAST: u64 = 1 << 20;

/// Bytes of memory that making an asset takes at its most, its states, images and file included; an estimate.
#[must_use]
pub fn memory(model: &Model) -> u64 {
    let all = extents(model);
    let mut triangles: Vec<u64> = Vec::with_capacity(model.shapes.len());
    let mut bytes = LEAST;
    for (index, shape) in model.shapes.iter().enumerate() {
        // A recipe refers only to shapes before it.
        let count = triangles_of(model, shape, (&all, index), &triangles);
        let parts = match &shape.recipe {
            Recipe::Solid(solid) => solid.parts.iter().map(|part| triangles[part.0 as usize]).sum(),
            _ => 0,
        };
        let own = count.saturating_mul(OF_SCENE).max(u64::saturating_mul(parts, OF_SOLID));
        bytes = bytes.saturating_add(own);
        triangles.push(count);
    }
    let images: u64 = model.images.iter().map(|image| image.bytes.len() as u64).sum();
    let states = model.states.iter().map(memory);
    // The bytes of an image stand in the model and in the file.
    states.fold(bytes.saturating_add(images.saturating_mul(2)), u64::saturating_add)
}

fn triangles_of(model: &Model, shape: &Shape, (all, index): (&Extents, usize), before: &[u64]) -> u64 {
    let of = |handle: &ShapeHandle| before[handle.0 as usize];
    let grid = |columns: usize, rows: usize| 2 * (columns as u64).saturating_mul(rows as u64);
    let round = || {
        if let Some(Density { u, v }) = shape.options.density {
            return 2 * u64::from(u) * u64::from(v);
        }
        let diagonal = all.bounds(ShapeHandle(mesh::index(index))).diagonal();
        let written = shape.options.tolerance.or(model.tolerance);
        let tolerance = written.map_or(diagonal / 2000.0, |tolerance| tolerance.max(f64::MIN_POSITIVE));
        let count = ROUND * diagonal / tolerance;
        floor_index(count) as u64
    };
    let refined = |count: u64, levels: u32| count.saturating_mul(4_u64.saturating_pow(levels));
    let count = match &shape.recipe {
        Recipe::Cuboid { .. } => 12,
        Recipe::Plane(_) | Recipe::Sheet(_) | Recipe::Wire(_) => 64,
        Recipe::Height(map) => grid(map.field.columns(), map.field.rows()),
        Recipe::TwoSided(body) => 2 * grid(body.front.field.columns(), body.front.field.rows()),
        Recipe::Polygons { mesh, .. } => mesh.corners.len() as u64,
        Recipe::Assembly(parts) => parts.iter().map(|(part, _)| of(part)).fold(0, u64::saturating_add),
        Recipe::Deformed { of: base, .. } => of(base).max(round()),
        Recipe::Displaced(recipe) => of(&recipe.of).max(round().saturating_mul(4)),
        Recipe::Solid(solid) => solid.parts.iter().map(of).fold(0, u64::saturating_add),
        Recipe::Subdivided(refinement) => {
            refinement.levels.map_or_else(round, |levels| refined(of(&refinement.cage), levels))
        }
        _ => round(),
    };
    // More is refused.
    count.min(model.limits.triangles)
}

#[cfg(test)]
mod tests {
    use super::memory;
    use crate::compile::{Options, model};
    use crate::language::Document;
    use crate::language::source::MemoryFiles;

    fn of(text: &str) -> u64 {
        let files = MemoryFiles::new().with("a.toml", text);
        let document = Document::load("a.toml", &files).unwrap();
        memory(&model(&document, &files, &Options::default()).unwrap())
    }

    #[test]
    fn finer_and_more_is_heavier() {
        let sphere = |tolerance: &str| {
            of(&format!("[shape.s]\ntolerance = {tolerance}\n[shape.s.sphere]\nradius = 1\n"))
        };
        let (coarse, fine) = (sphere("1e-4"), sphere("1e-6"));
        assert!(fine > 50 * coarse, "{coarse} {fine}");
        let copies = of("[shape.s]\ntolerance = 1e-4\n[shape.s.sphere]\nradius = 1\n\
                         [shape.c.array]\nof = \"s\"\ncount = 10\noffset = [3, 0, 0]\n");
        assert!(copies > 5 * coarse, "{coarse} {copies}");
        let grid = of("[shape.s]\nsegments = [1000, 1000]\n[shape.s.sphere]\nradius = 1\n");
        assert!((250_000_000..400_000_000).contains(&grid), "{grid}");
        assert!(of("[shape.s.box]\nsize = [1, 1, 1]\n") < 2_000_000);
    }

    #[test]
    fn what_has_no_end_is_no_more_than_the_limit() {
        let text = "[shape.s]\ntolerance = 1e-300\n[shape.s.sphere]\nradius = 1e6\n";
        assert!(of(text) <= 50_000_000 * 150 + 2_000_000);
    }
}

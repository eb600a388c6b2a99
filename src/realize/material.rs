//! Which triangles have which material.

use glam::DVec3;

use super::shape::Made;
use super::source::{Source, sources};
use crate::geometry::mesh;
use crate::geometry::mesh::{Mesh, Run, Vertex, VertexIndex};
use crate::model::{MaterialHandle, Model, Recipe, ShapeHandle};

/// Materials of elements; those that have none of their own get the whole shape's.
pub(super) fn own_or(
    materials: &[Option<MaterialHandle>],
    whole: Option<MaterialHandle>,
) -> Vec<Option<MaterialHandle>> {
    materials.iter().map(|own| own.or(whole)).collect()
}

pub(super) fn middle(mesh: &Mesh, corners: &[VertexIndex; 3]) -> DVec3 {
    let places = corners.map(|corner| mesh.points[mesh.vertices[corner.subscript()].point.subscript()]);
    (places[0] + places[1] + places[2]) / 3.0
}

/// The source that a triangle lies on.
pub(super) fn source_of(mesh: &Mesh, corners: &[VertexIndex; 3]) -> u32 {
    mesh.vertices[corners[0].subscript()].anchor.source
}

/// Gives each triangle the material of the element that it belongs to. Each material has vertices of its own: no two
/// primitives of a file share one.
pub(super) fn split_by_element(
    made: &mut Made,
    element: impl Fn(&Mesh, &[VertexIndex; 3]) -> usize,
    materials: &[Option<MaterialHandle>],
) {
    let mesh = &mut made.mesh;
    // Elements of one material are one origin, named by the first of them.
    let first = |element: usize| materials.iter().position(|other| *other == materials[element]).unwrap_or(0);
    let of = |corners: &[VertexIndex; 3]| first(element(mesh, corners));
    let mut all: Vec<(usize, [VertexIndex; 3])> =
        mesh.triangles.iter().map(|corners| (of(corners), *corners)).collect();
    all.sort_by_key(|(element, _)| *element);
    let mut vertices: Vec<Vertex> = Vec::with_capacity(mesh.vertices.len());
    let mut names = vec![u32::MAX; mesh.vertices.len()];
    mesh.runs.clear();
    let mut start = 0;
    for (place, (element, _)) in all.iter().enumerate() {
        if all.get(place + 1).is_some_and(|(next, _)| next == element) {
            continue;
        }
        // What was named for another material is named anew.
        let own = mesh::index(vertices.len());
        for (at, (_, corners)) in all.iter().enumerate().take(place + 1).skip(start) {
            mesh.triangles[at] = corners.map(|corner| {
                let name = &mut names[corner.subscript()];
                if *name == u32::MAX || *name < own {
                    *name = mesh::index(vertices.len());
                    vertices.push(mesh.vertices[corner.subscript()]);
                }
                VertexIndex(*name)
            });
        }
        mesh.runs.push(Run { origin: mesh::index(*element), end: mesh::index(place + 1) });
        start = place + 1;
    }
    mesh.vertices = vertices;
    made.materials = materials.to_vec();
}

/// Gives what shows a normal map its material: all that has none, or of a height map the upper side.
pub(super) fn show_normals(made: &mut Made, material: MaterialHandle, recipe: &Recipe) {
    if matches!(recipe, Recipe::Displaced(_)) {
        made.materials.iter_mut().for_each(|slot| *slot = slot.or(Some(material)));
        return;
    }
    let mesh = &mut made.mesh;
    let is_top = |corners: &[VertexIndex; 3]| {
        corners.iter().all(|corner| mesh.vertices[corner.subscript()].anchor.source == 0)
    };
    let (top, rest): (Vec<_>, Vec<_>) = mesh.triangles.iter().copied().partition(is_top);
    let end = mesh::index(top.len());
    mesh.triangles = [top, rest].concat();
    let all = mesh::index(mesh.triangles.len());
    mesh.runs = vec![Run { origin: 0, end }];
    if all > end {
        mesh.runs.push(Run { origin: 1, end: all });
    }
    made.materials = vec![Some(material), None];
}

/// One run and one origin of strands for each material, or for each part.
pub(super) fn grouped(made: Made, apart: bool) -> Made {
    if apart { by_part(made) } else { by_material(made) }
}

/// One run for each origin, in their order.
fn by_part(made: Made) -> Made {
    let sorted = made.mesh.runs.windows(2).all(|pair| pair[0].origin < pair[1].origin);
    if sorted {
        return made;
    }
    let mut parts: Vec<(u32, std::ops::Range<usize>)> = Vec::with_capacity(made.mesh.runs.len());
    let mut start = 0;
    for run in &made.mesh.runs {
        parts.push((run.origin, start..run.end as usize));
        start = run.end as usize;
    }
    parts.sort_by_key(|(origin, _)| *origin);
    let mut triangles = Vec::with_capacity(made.mesh.triangles.len());
    let mut runs: Vec<Run> = Vec::new();
    for part in parts.chunk_by(|one, other| one.0 == other.0) {
        part.iter().for_each(|(_, range)| triangles.extend_from_slice(&made.mesh.triangles[range.clone()]));
        runs.push(Run { origin: part[0].0, end: mesh::index(triangles.len()) });
    }
    Made { mesh: Mesh { triangles, runs, ..made.mesh }, ..made }
}

/// The names of the shapes that the parts of a mesh are, by their origins; of parts that have no triangles none.
pub(super) fn part_names(model: &Model, shape: ShapeHandle, made: &Made) -> Vec<String> {
    let sources = sources(model, shape);
    let mut names = vec![String::new(); made.materials.len()];
    let mut start = 0;
    for run in &made.mesh.runs {
        let first = made.mesh.triangles[start][0];
        let source = sources.get(made.mesh.vertices[first.subscript()].anchor.source);
        let part = source.map_or(shape, Source::shape);
        names[run.origin as usize].clone_from(&model.shape(part).name);
        start = run.end as usize;
    }
    names
}

/// One run and one origin of strands for each material, in the order of their first use.
fn by_material(made: Made) -> Made {
    let origins = made.mesh.runs.iter().map(|run| run.origin);
    let origins = origins.chain(made.wire.strands.iter().map(|strand| strand.origin));
    let mut order: Vec<Option<MaterialHandle>> = Vec::new();
    for material in origins.map(|origin| made.materials[origin as usize]) {
        if !order.contains(&material) {
            order.push(material);
        }
    }
    let grouped = made.mesh.runs.iter().zip(0..).all(|(run, k)| run.origin == k)
        && order.len() == made.mesh.runs.len()
        && made.wire.is_empty();
    if grouped {
        return made;
    }
    let mut triangles = Vec::with_capacity(made.mesh.triangles.len());
    let mut runs: Vec<Run> = Vec::new();
    for (origin, material) in order.iter().enumerate() {
        let before = triangles.len();
        let mut start = 0;
        for run in &made.mesh.runs {
            if made.materials[run.origin as usize] == *material {
                triangles.extend_from_slice(&made.mesh.triangles[start as usize..run.end as usize]);
            }
            start = run.end;
        }
        if triangles.len() > before {
            runs.push(Run { origin: mesh::index(origin), end: mesh::index(triangles.len()) });
        }
    }
    let name = |material| mesh::index(order.iter().position(|known| known == material).unwrap_or(0));
    let names: Vec<u32> = made.materials.iter().map(name).collect();
    let wire = made.wire.regrouped(&names);
    Made { mesh: Mesh { triangles, runs, ..made.mesh }, wire, materials: order, ..made }
}

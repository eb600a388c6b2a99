//! Faces that are written out.

use glam::{DVec2, DVec3};
use indexmap::IndexSet;

use super::Builder;
use crate::geometry::mesh;
use crate::geometry::mesh::{Color, PolygonMesh};
use crate::geometry::planar::{Regions, regions};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::model::{MaterialHandle, Recipe};

impl Builder<'_> {
    /// A mesh of points and faces.
    pub(super) fn mesh(&mut self, mesh: &spec::Mesh, span: Span) -> Option<Recipe> {
        let mut polygons = PolygonMesh {
            points: mesh.points.iter().map(|point| point.value).collect(),
            has_smoothing: mesh.smoothing_groups.is_some(),
            ..PolygonMesh::default()
        };
        let mut names: IndexSet<&str> = IndexSet::new();
        for (index, face) in mesh.faces.iter().enumerate() {
            let material = mesh
                .face_materials
                .as_ref()
                .map(|materials| mesh::index(names.insert_full(&materials[index]).0));
            let smoothing = mesh.smoothing_groups.as_ref().map_or(0, |groups| groups[index]);
            let loops: Vec<&[u32]> = face.loops.iter().map(Vec::as_slice).collect();
            polygons.push_face(&loops, material, smoothing);
        }
        polygons.materials = names.iter().map(|&name| name.to_owned()).collect();
        let materials = names.iter().map(|name| self.material(name)).collect();
        if let Some(uvs) = &mesh.uvs {
            polygons.uvs = uvs.value.iter().map(|uv| DVec2::new(uv.x, uv.y)).collect();
            let faces = mesh.face_uvs.as_ref().map_or(&mesh.faces, |faces| &faces.value);
            polygons.corner_uvs = faces.iter().flat_map(|face| face.corners()).collect();
        }
        if let Some(colors) = &mesh.colors {
            polygons.colors = colors.value.iter().map(|color| Color::held(color.linear)).collect();
            polygons.corner_colors = polygons.corners.iter().map(|point| point.0).collect();
        }
        self.face_places = mesh.faces.iter().map(|face| face.span).collect();
        self.polygons(polygons, materials, span)
    }

    /// Flat polygons of loops that are sorted by the way they turn.
    pub(super) fn polygon(&mut self, polygon: &spec::Polygon, span: Span) -> Option<Recipe> {
        let loops: Vec<&[DVec2]> = polygon.loops.iter().map(|corners| corners.value.as_slice()).collect();
        let Regions { faces, stray } = regions(&loops);
        for &hole in &stray {
            let message = format!("`loops[{hole}]` turns clockwise, but lies in no other loop");
            let report = Diagnostic::error(Code::StrayHole, message)
                .at(polygon.loops[hole].span, "a hole in nothing")
                .help("outlines turn counterclockwise: write its corners the other way around");
            self.report(report);
        }
        if !stray.is_empty() {
            return None;
        }
        let mut polygons = PolygonMesh::default();
        let starts: Vec<u32> = loops
            .iter()
            .map(|corners| {
                let start = mesh::index(polygons.points.len());
                polygons.points.extend(corners.iter().map(|corner| corner.extend(0.0)));
                start
            })
            .collect();
        for face in &faces {
            let corners = |ring: &usize| {
                let start = starts[*ring];
                (start..start + mesh::index(loops[*ring].len())).collect()
            };
            let rings: Vec<Vec<u32>> = face.iter().map(corners).collect();
            polygons.push_face(&rings.iter().map(Vec::as_slice).collect::<Vec<_>>(), None, 0);
        }
        polygons.uvs = across_the_box(&polygons.points);
        polygons.corner_uvs = polygons.corners.iter().map(|corner| corner.0).collect();
        self.face_places = faces.iter().map(|face| polygon.loops[face[0]].span).collect();
        self.polygons(polygons, Vec::new(), span)
    }

    fn polygons(
        &mut self,
        mesh: PolygonMesh,
        materials: Vec<Option<MaterialHandle>>,
        span: Span,
    ) -> Option<Recipe> {
        if let Err(error) = mesh.validate() {
            self.report(Diagnostic::error(Code::BadMesh, error.to_string()).at(span, "this mesh"));
            return None;
        }
        Some(Recipe::Polygons { mesh, materials })
    }
}

/// Texture coordinates that put the texture on the box of flat points.
fn across_the_box(points: &[DVec3]) -> Vec<DVec2> {
    let flat = || points.iter().map(|point| point.truncate());
    let low = flat().reduce(DVec2::min).unwrap_or_default();
    let size = flat().reduce(DVec2::max).unwrap_or_default() - low;
    let size = size.max(DVec2::splat(f64::MIN_POSITIVE));
    flat().map(|place| ((place - low) / size) * DVec2::new(1.0, -1.0) + DVec2::Y).collect()
}

//! Subdivision surfaces: the polygons of a cage, refined.

use glam::{DAffine3, DVec3};

use super::inherited::Inherited;
use super::limit::Working;
use super::shape::{Made, Maker, cost, flatten};
use super::vertex_color::color_polygons;
use super::{Faces, Level, Note, RealizeError};
use crate::geometry::mesh::convert::{ConvertOptions, Shading, convert};
use crate::geometry::mesh::polygon::Face;
use crate::geometry::mesh::{self, Color, PointIndex, PolygonMesh, Wire};
use crate::geometry::subdivide::{Aim, Options, Scheme, SubdivideFault, subdivide};
use crate::geometry::tessellate::{Deviation, Evidence};
use crate::model::{MaterialHandle, Recipe, ShapeHandle, Smoothing, SubdivisionRecipe};

/// Polygons, and the material of each entry of their table.
type Cage = (PolygonMesh, Vec<Option<MaterialHandle>>);

impl Maker<'_> {
    /// A subdivision surface in its own space.
    pub(super) fn subdivided(
        &self,
        handle: ShapeHandle,
        recipe: &SubdivisionRecipe,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        // The surface is that of the cage: a coarser one would be another surface.
        let finest = Inherited { level: Level::FINEST, ..inherited };
        let (cage, materials) = self.cage(recipe.cage, finest)?;
        let tolerance = inherited.tolerance.unwrap_or_else(|| cage.bounds().diagonal() / 2000.0);
        let tolerance = self.coarsened(tolerance, inherited.level);
        let aim = (tolerance - inherited.rounding).max(tolerance / 2.0);
        let mut options = Options {
            scheme: recipe.scheme,
            aim: recipe.levels.map_or(Aim::Tolerance(aim), |levels| {
                Aim::Levels(levels.saturating_sub(inherited.level.number))
            }),
            limit: recipe.limit,
            border_corners: recipe.border_corners,
            creases: recipe.creases.clone(),
            corners: recipe.corners.clone(),
            triangulate: recipe.triangulate,
        };
        let refuse = |fault| match fault {
            SubdivideFault::TooMany { needed, .. } => Working::Subdivided.refusal(needed, &self.model.limits),
            fault => RealizeError::Subdivide { shape: handle, cage: recipe.cage, fault },
        };
        let most = Working::Subdivided.most(&self.model.limits);
        let mut refined = subdivide(&cage, &options, most).map_err(refuse)?;
        if recipe.levels.is_none() && refined.levels < self.levels {
            options.aim = Aim::Levels(self.levels);
            refined = subdivide(&cage, &options, most).map_err(refuse)?;
        }
        let (shading, crease_angle) = match shape.options.smoothing {
            Smoothing::Auto => (Shading::Auto, shape.options.crease_angle),
            Smoothing::Flat => (Shading::Flat, 0.0),
            Smoothing::Smooth => (Shading::Smooth, 180.0),
        };
        let converted = convert(&refined.mesh, &ConvertOptions { shading, crease_angle })?;
        let of =
            |index: &Option<u32>| index.and_then(|index| materials.get(index as usize).copied().flatten());
        let note = |count: u32| Note::Triangulated(Faces { first: 0, count: count as usize });
        let mut made = Made {
            materials: converted.materials.iter().map(of).collect(),
            mesh: converted.mesh,
            wire: Wire::default(),
            deviation: match recipe.scheme {
                Scheme::Bilinear => Deviation::NONE,
                _ => Deviation::new(refined.distance, Evidence::Sampled),
            },
            tolerance: recipe.levels.is_none().then_some(tolerance),
            notes: (refined.triangulated > 0)
                .then(|| (handle, note(refined.triangulated)))
                .into_iter()
                .chain([(handle, Note::Classes(refined.classes))])
                .collect(),
            levels: if recipe.levels.is_none() { refined.levels } else { 0 },
        };
        made.mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source = *next_source);
        *next_source += 1;
        let made = if shape.options.smoothing == Smoothing::Flat { flatten(made) } else { made };
        cost(&made).check(&self.model.limits)?;
        Ok(made)
    }

    /// The polygons of a shape where it has such, or else its triangles.
    fn cage(&self, handle: ShapeHandle, inherited: Inherited) -> Result<Cage, RealizeError> {
        if let Some((mut mesh, mut materials)) = self.polygons_of(handle)? {
            let own = self.model.shape(handle).options.material;
            mesh.transform(&self.model.shape(handle).options.placement);
            if own.is_some() {
                materials.iter_mut().for_each(|slot| *slot = slot.or(own));
                name_material(&mut mesh, &mut materials, own);
            }
            mesh.normals.clear();
            mesh.corner_normals.clear();
            return Ok((mesh, materials));
        }
        let made = self.part(handle, inherited, &mut 0)?;
        Ok(of_triangles(&made))
    }

    /// The polygons of a recipe before its placement.
    fn polygons_of(&self, handle: ShapeHandle) -> Result<Option<Cage>, RealizeError> {
        let shape = self.model.shape(handle);
        let cage = match &shape.recipe {
            Recipe::Polygons { mesh, materials } => Some((mesh.clone(), materials.clone())),
            Recipe::Cuboid { size, center } => Some((cuboid(*size, *center), Vec::new())),
            Recipe::Assembly(parts) => match parts[..] {
                [(part, map)] => {
                    let cage = self.cage_of_part(part, &map)?;
                    cage.map(|(mut mesh, materials)| {
                        mesh.normals.clear();
                        (mesh, materials)
                    })
                }
                _ => None,
            },
            _ => None,
        };
        let Some((mut mesh, materials)) = cage else { return Ok(None) };
        if let Some(law) = &shape.options.vertex_color {
            color_polygons(&mut mesh, law)?;
        }
        Ok(Some((mesh, materials)))
    }

    fn cage_of_part(&self, part: ShapeHandle, map: &DAffine3) -> Result<Option<Cage>, RealizeError> {
        let Some((mut mesh, mut materials)) = self.polygons_of(part)? else { return Ok(None) };
        let options = &self.model.shape(part).options;
        mesh.transform(&(*map * options.placement));
        name_material(&mut mesh, &mut materials, options.material);
        Ok(Some((mesh, materials)))
    }
}

/// Gives faces without a material one.
fn name_material(
    mesh: &mut PolygonMesh,
    materials: &mut Vec<Option<MaterialHandle>>,
    own: Option<MaterialHandle>,
) {
    let bare = mesh.faces.iter().any(|face| face.material.is_none());
    if own.is_none() || !bare {
        return;
    }
    materials.resize(mesh.materials.len(), None);
    let number = mesh::index(materials.len());
    materials.push(own);
    mesh.materials.push(String::new());
    mesh.faces.iter_mut().for_each(|face| face.material = face.material.or(Some(number)));
}

/// A box of six faces.
fn cuboid(size: DVec3, center: DVec3) -> PolygonMesh {
    let side = |bit: u32, k: u32| if k & bit == 0 { -0.5 } else { 0.5 };
    let points = (0..8).map(|k| center + size * DVec3::new(side(1, k), side(2, k), side(4, k))).collect();
    let faces: [&[u32]; 6] =
        [&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];
    PolygonMesh::from_faces(points, &faces)
}

/// For each corner its color, which is that of its vertex; none where all are white.
fn corner_colors(mesh: &mesh::Mesh) -> Vec<u32> {
    let colored = mesh.vertices.iter().any(|vertex| vertex.color != Color::WHITE);
    if colored { mesh.triangles.iter().flatten().map(|vertex| vertex.0).collect() } else { Vec::new() }
}

fn of_triangles(made: &Made) -> Cage {
    let mesh = &made.mesh;
    let corner = |vertex: mesh::VertexIndex| mesh.vertices[vertex.subscript()].point;
    let mut polygons = PolygonMesh {
        points: mesh.points.clone(),
        corners: mesh.triangles.iter().flatten().map(|vertex| corner(*vertex)).collect::<Vec<PointIndex>>(),
        loop_ends: (1..=mesh::index(mesh.triangles.len())).map(|face| 3 * face).collect(),
        uvs: mesh.vertices.iter().map(|vertex| vertex.uv).collect(),
        corner_uvs: mesh.triangles.iter().flatten().map(|vertex| vertex.0).collect(),
        colors: mesh.vertices.iter().map(|vertex| vertex.color).collect(),
        corner_colors: corner_colors(mesh),
        materials: vec![String::new(); made.materials.len()],
        ..PolygonMesh::default()
    };
    let mut face = 0;
    for run in &mesh.runs {
        while face < run.end {
            face += 1;
            polygons.faces.push(Face { loops_end: face, material: Some(run.origin), smoothing: 0 });
        }
    }
    (polygons, made.materials.clone())
}

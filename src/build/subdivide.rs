//! Subdivision surfaces of a document into recipes.

use super::Builder;
use crate::geometry::subdivide::{Crease, CreaseEdges, Scheme};
use crate::language::spec::{CageBorder, Subdivide, SubdivideCrease, SubdivisionScheme};
use crate::model::{Recipe, SubdivisionRecipe};

impl Builder<'_> {
    pub(super) fn subdivide(&mut self, name: &str, written: &Subdivide) -> Option<Recipe> {
        let cage = self.shape_of(name, 0, &written.cage)?;
        Some(Recipe::Subdivided(SubdivisionRecipe {
            cage,
            scheme: scheme(written.scheme.value),
            levels: written.levels.map(|levels| levels.value),
            limit: written.limit.value,
            border_corners: written.border.value == CageBorder::Corners,
            creases: written.creases.iter().map(crease).collect(),
            corners: (written.corners.iter())
                .map(|corner| (corner.vertex.value, corner.sharpness.value.0))
                .collect(),
            triangulate: written.triangulate.value,
        }))
    }
}

fn scheme(written: SubdivisionScheme) -> Scheme {
    match written {
        SubdivisionScheme::CatmullClark => Scheme::CatmullClark,
        SubdivisionScheme::Loop => Scheme::Loop,
        SubdivisionScheme::Root3 => Scheme::Root3,
        SubdivisionScheme::DooSabin => Scheme::DooSabin,
        SubdivisionScheme::MidEdge => Scheme::MidEdge,
        SubdivisionScheme::Butterfly => Scheme::Butterfly,
        SubdivisionScheme::Bilinear => Scheme::Bilinear,
    }
}

fn crease(written: &SubdivideCrease) -> Crease {
    let edges = match &written.crease_angle {
        _ if written.imported.value => CreaseEdges::Own,
        Some(angle) => CreaseEdges::Angle(angle.value),
        None => CreaseEdges::Pairs(written.edges.iter().map(|pair| [pair.value[0], pair.value[1]]).collect()),
    };
    Crease { edges, sharpness: written.sharpness.value.0 }
}

//! Flat faces inside closed curves.

use glam::{DVec2, DVec3};

use super::cap::{CapLoop, Facing, add_cap};
use super::extrude::{Outline, cut, flat};
use super::{Detail, Deviation, Evidence, TessellateError, Tessellation};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh;
use crate::geometry::mesh::{Mesh, PointIndex, Run};

/// Closed outlines in the xy plane with holes; the faces between them look to +z.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// For each island its outline, then its holes; any sense of turning.
    pub outlines: Vec<AnyCurve>,
    /// How many of the outlines belong to each island, in order.
    pub islands: Vec<usize>,
}

/// Makes the faces. The texture covers the box of each outline. The bound is that of the outlines' chords, and proved.
/// Anchor source 0.
///
/// # Errors
/// When the limit would be passed, an outline encloses no area, or a face cannot be triangulated.
pub fn sheet(shape: &Sheet, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let mut made = Mesh::default();
    let mut bound = 0.0_f64;
    let mut outlines = shape.outlines.iter();
    for count in &shape.islands {
        let mut loops = Vec::new();
        for (number, curve) in outlines.by_ref().take(*count).enumerate() {
            let Outline { stations, .. } = cut(curve, number > 0, detail)?;
            detail.allow((made.points.len() + stations.len()) as u64)?;
            bound = stations.iter().map(|station| station.deviation).fold(bound, f64::max);
            let place: Vec<DVec2> = flat(&stations);
            let first = mesh::index(made.points.len());
            made.points.extend(place.iter().map(|place| place.extend(0.0)));
            let points = (first..mesh::index(made.points.len())).map(PointIndex).collect();
            loops.push(CapLoop { place, points });
        }
        let facing = Facing { normal: DVec3::Z, mirrored: false };
        add_cap(&mut made, &loops, facing, 0, detail.uv)?;
    }
    made.runs = vec![Run { origin: 0, end: mesh::index(made.triangles.len()) }];
    let evidence = if bound == 0.0 { Evidence::Exact } else { Evidence::Proved };
    Ok(Tessellation { mesh: made, deviation: Deviation { bound, evidence } })
}

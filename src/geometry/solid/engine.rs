//! The solid library behind one door: checked meshes in, bare triangles with their origins out.
//!
//! Nothing else calls it. What has to be known of it: its errors are a status that an empty mesh carries, so every
//! step is asked for it; ids of meshes are given here, since its own come from a counter of the whole process; and
//! points that stand on one place after an operation are not to be joined, or edges where solids touch would have
//! four faces.

use glam::DVec3;
use manifold_rust::linalg::Vec3;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error, MeshGLP, OpType};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::check::{Check, moments};
use super::half::{HalfSpace, half_space};
use super::parts::{Piece, Solids, THIN, classes};
use super::{Combination, Lying, Raw, SolidFault, Stock};
use crate::geometry::mesh::{VertexIndex, index};
use crate::geometry::number::Bounds;

/// Pieces that one part may have, as ids tell them apart.
const PIECES: u32 = 1 << 12;

/// Evaluates a combination.
pub(super) fn combine(
    stock: &Stock,
    solids: &Solids,
    faces: &[u32],
    how: &Combination,
    resolution: f64,
) -> Result<Raw, SolidFault> {
    let make = |(part, pieces): &(usize, &Vec<Piece>)| imported(*part, pieces, Some(faces), resolution);
    let numbered: Vec<(usize, &Vec<Piece>)> = solids.parts.iter().enumerate().collect();
    // Waking other threads costs more than small parts take.
    let made: Result<Vec<Manifold>, SolidFault> = if stock.mesh.triangles.len() < 20_000 {
        numbered.iter().map(make).collect()
    } else {
        numbered.par_iter().map(make).collect()
    };
    let result = evaluate(how, &made?)?;
    Ok(exported(&result))
}

/// A part: its pieces, united.
fn imported(
    part: usize,
    pieces: &[Piece],
    faces: Option<&[u32]>,
    resolution: f64,
) -> Result<Manifold, SolidFault> {
    let mut made = Vec::with_capacity(pieces.len());
    for (number, piece) in (0..).zip(pieces) {
        let id = 1 + index(part) * PIECES + number % PIECES;
        let one = taken(Manifold::from_mesh_glp(&exchange(piece, id, faces, resolution)))?;
        if piece.check == Check::Crossings && one.has_self_intersections() {
            return Err(SolidFault::Crossing { part, place: None });
        }
        made.push(one);
    }
    union(made)
}

fn exchange(piece: &Piece, id: u32, faces: Option<&[u32]>, resolution: f64) -> MeshGLP<f64, u32> {
    MeshGLP {
        num_prop: 3,
        vert_properties: piece.points.iter().flat_map(|point| point.to_array()).collect(),
        tri_verts: piece.triangles.as_flattened().to_vec(),
        run_original_id: vec![id],
        face_id: faces
            .map_or_else(Vec::new, |faces| piece.of.iter().map(|number| faces[*number as usize]).collect()),
        tolerance: resolution,
        ..MeshGLP::default()
    }
}

/// A result of the library, or what it says against it.
fn taken(made: Manifold) -> Result<Manifold, SolidFault> {
    match made.status() {
        Error::NoError => Ok(made),
        other => Err(SolidFault::Engine(format!("{other:?}"))),
    }
}

fn applied(one: &Manifold, other: &Manifold, operation: OpType) -> Result<Manifold, SolidFault> {
    taken(one.boolean_with_engine(other, operation, BooleanEngine::Exact))
}

fn evaluate(how: &Combination, parts: &[Manifold]) -> Result<Manifold, SolidFault> {
    let all =
        |list: &[Combination]| list.iter().map(|one| evaluate(one, parts)).collect::<Result<Vec<_>, _>>();
    match how {
        Combination::Part(part) => Ok(parts[*part].clone()),
        Combination::Union(list) => union(all(list)?),
        Combination::Intersection(list) => {
            let mut rest = all(list)?.into_iter();
            let first = rest.next().unwrap_or_default();
            rest.try_fold(first, |one, other| applied(&one, &other, OpType::Intersect))
        }
        Combination::Difference(first, rest) => {
            let first = evaluate(first, parts)?;
            applied(&first, &union(all(rest)?)?, OpType::Subtract)
        }
    }
}

/// What is in any of them: those that are apart side by side, then pair by pair.
fn union(list: Vec<Manifold>) -> Result<Manifold, SolidFault> {
    let mut list: Vec<Manifold> = list.into_iter().filter(|one| !one.is_empty()).collect();
    if list.len() > 2 {
        let classes = classes(&list.iter().map(bounds).collect::<Vec<_>>());
        let count = classes.iter().max().map_or(0, |most| most + 1);
        let mut sets: Vec<Vec<Manifold>> = vec![Vec::new(); count];
        for (one, class) in list.into_iter().zip(classes) {
            sets[class].push(one);
        }
        list = sets.into_iter().map(|set| taken(Manifold::compose(&set))).collect::<Result<_, _>>()?;
    }
    while list.len() > 1 {
        let pair = |pair: &[Manifold]| match pair {
            [one, other] => applied(one, other, OpType::Add),
            one => Ok(one[0].clone()),
        };
        list = list.chunks(2).map(pair).collect::<Result<_, _>>()?;
    }
    Ok(list.pop().unwrap_or_default())
}

fn bounds(of: &Manifold) -> Bounds {
    let found = of.bounding_box();
    Bounds { min: from(&found.min), max: from(&found.max) }
}

fn from(place: &Vec3) -> DVec3 {
    DVec3::new(place.x, place.y, place.z)
}

fn to(place: DVec3) -> Vec3 {
    Vec3::new(place.x, place.y, place.z)
}

fn exported(result: &Manifold) -> Raw {
    let mesh: MeshGLP<f64, u32> = result.get_mesh_glp(-1);
    let (points, triangles) = split(&mesh);
    let mut origins = Vec::with_capacity(triangles.len());
    for (run, ends) in mesh.run_index.windows(2).enumerate() {
        let flipped = mesh.run_flags.get(run).is_some_and(|flags| flags & 1 == 1);
        let triangles = ends[0] as usize / 3..ends[1] as usize / 3;
        origins.extend(mesh.face_id[triangles].iter().map(|on| Lying { on: *on, flipped }));
    }
    Raw { points, triangles, origins }
}

fn split(mesh: &MeshGLP<f64, u32>) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let width = mesh.num_prop as usize;
    let points = mesh.vert_properties.chunks_exact(width).map(DVec3::from_slice).collect();
    let triangles =
        mesh.tri_verts.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect();
    (points, triangles)
}

/// The triangles of the smallest convex body around some points; none where they lie on one plane.
pub(super) fn hull(points: &[DVec3]) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), SolidFault> {
    let places: Vec<Vec3> = points.iter().copied().map(to).collect();
    let body = Body(taken(Manifold::hull(&places))?);
    let (points, triangles) = body.triangles();
    let (volume, area) = moments(&points, triangles.iter().copied());
    let size = Bounds::of_points(points.iter().copied()).diagonal();
    if volume <= THIN * size * area { Err(SolidFault::Flat) } else { Ok((points, triangles)) }
}

/// Triangles that enclose something.
#[derive(Clone)]
pub(super) struct Body(Manifold);

/// The only part of a stock.
pub(super) fn body(solids: &Solids, resolution: f64) -> Result<Body, SolidFault> {
    let pieces = solids.parts.first().map_or(&[] as &[Piece], Vec::as_slice);
    imported(0, pieces, None, resolution).map(Body)
}

impl Body {
    pub(super) fn is_convex(&self) -> bool {
        self.0.as_impl().is_convex()
    }

    /// Everything that a convex body about the origin covers when its middle is in this.
    pub(super) fn dilated(&self, ball: &[DVec3]) -> Result<Self, SolidFault> {
        let ball = tool(ball)?;
        if self.is_convex() {
            return taken(self.0.minkowski_sum(&ball)).map(Self);
        }
        let quick = self.0.try_dilate_by_convex(&ball, None, None);
        taken(quick.unwrap_or_else(|| self.0.minkowski_sum(&ball))).map(Self)
    }

    /// All places where a convex body about the origin lies inside.
    pub(super) fn eroded(&self, ball: &[DVec3]) -> Result<Self, SolidFault> {
        let ball = tool(ball)?;
        let quick = self.0.try_convex_erosion(&ball, None, None);
        let quick = quick.or_else(|| self.0.try_erode_by_convex(&ball, None, None));
        taken(quick.unwrap_or_else(|| self.0.minkowski_difference(&ball))).map(Self)
    }

    /// What lies on the side that the normal of a plane points to, and on the other.
    pub(super) fn halves(&self, plane: &HalfSpace) -> Result<[Self; 2], SolidFault> {
        let mesh = half_space(plane, &bounds(&self.0), 0);
        let corners = |of: &[VertexIndex; 3]| of.map(|corner| mesh.vertices[corner.subscript()].point.0);
        let triangles = mesh.triangles.iter().map(corners).collect();
        let piece = Piece { points: mesh.points.clone(), triangles, ..Piece::default() };
        let half = taken(Manifold::from_mesh_glp(&exchange(&piece, 2, None, 0.0)))?;
        let side = |operation: OpType| applied(&self.0, &half, operation).map(Self);
        Ok([side(OpType::Intersect)?, side(OpType::Subtract)?])
    }

    /// The skins that are apart from each other, hollows too.
    pub(super) fn components(&self) -> Vec<Self> {
        self.0.decompose().into_iter().map(Self).collect()
    }

    pub(super) fn triangles(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        split(&self.0.get_mesh_glp(-1))
    }
}

fn tool(ball: &[DVec3]) -> Result<Manifold, SolidFault> {
    let places: Vec<Vec3> = ball.iter().copied().map(to).collect();
    taken(Manifold::hull(&places))
}

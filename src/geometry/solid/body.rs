//! One solid as it is: checked, without walls inside of it.

use glam::DVec3;

use super::check::Check;
use super::parts::{Piece, pieces};
use super::{Combination, Making, SolidFault, Stock, combine};
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{Mesh, VertexIndex};

/// The triangles of a solid over points that they share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Its points.
    pub points: Vec<DVec3>,
    /// Its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the normals that its corners were given.
    pub normals: Vec<[DVec3; 3]>,
}

/// A mesh as a solid: closed, looking outward, not crossing itself. Where it is several solids, what lies inside another goes.
///
/// Cost: linear, but for looking for crossings and for several solids, which are O(n log n).
///
/// # Errors
/// A mesh that is no solid; its part is 0.
pub fn body(mesh: &Mesh, check: Check) -> Result<Body, SolidFault> {
    let mut stock = Stock::default();
    stock.add(mesh, 0);
    let mut found = pieces(&stock, 0, check)?;
    if let (1, Some(one)) = (found.len(), found.pop()) {
        return whole(mesh, one);
    }
    let checks = [check];
    let making = Making { resolution: 0.0, periods: &[], check: &checks };
    let made = combine(&stock, &Combination::Part(0), &making)?.mesh;
    let corners = |triangle: &[VertexIndex; 3]| triangle.map(|vertex| made.vertices[vertex.subscript()]);
    let welded = weld_equal(&made.points);
    let mut all = Body { points: welded.points, ..Body::default() };
    for triangle in &made.triangles {
        let corners = corners(triangle);
        let [a, b, c] = corners.map(|vertex| welded.map[vertex.point.subscript()]);
        if a != b && b != c && c != a {
            all.triangles.push([a, b, c]);
            all.normals.push(corners.map(|vertex| vertex.normal));
        }
    }
    Ok(all)
}

/// A piece with the normals of its triangles.
fn whole(mesh: &Mesh, piece: Piece) -> Result<Body, SolidFault> {
    let crossed = match piece.check {
        Check::Crossings => crossings(&piece.points, &piece.triangles).first().copied(),
        Check::Trusted => None,
    };
    if let Some([one, _]) = crossed {
        let [a, b, c] = piece.triangles[one as usize].map(|corner| piece.points[corner as usize]);
        return Err(SolidFault::Crossing { part: 0, place: Some((a + b + c) / 3.0) });
    }
    let normals = |triangle: &u32| {
        mesh.triangles[*triangle as usize].map(|vertex| mesh.vertices[vertex.subscript()].normal)
    };
    Ok(Body {
        normals: piece.of.iter().map(normals).collect(),
        points: piece.points,
        triangles: piece.triangles,
    })
}

#[cfg(test)]
mod tests {
    use super::{Check, body};
    use crate::geometry::mesh::Mesh;
    use crate::geometry::mesh::convert::{ConvertOptions, convert};
    use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};
    use crate::geometry::solid::SolidFault;

    fn ball() -> Mesh {
        let solid = platonic(Platonic::Icosahedron, PlatonicSize::Circumradius(1.0), Pose::Axes);
        convert(&solid, &ConvertOptions::default()).expect("a solid").mesh
    }

    #[test]
    fn a_closed_mesh_is_a_body_and_an_open_one_is_none() {
        let ball = ball();
        let found = body(&ball, Check::Crossings).expect("closed");
        assert_eq!((found.points.len(), found.triangles.len(), found.normals.len()), (12, 20, 20));
        let mut open = ball.clone();
        open.triangles.pop();
        open.runs[0].end -= 1;
        assert!(matches!(body(&open, Check::Trusted), Err(SolidFault::Open { part: 0, edges: 3, .. })));
        let mut inward = ball;
        inward.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        assert!(matches!(body(&inward, Check::Trusted), Err(SolidFault::InsideOut { part: 0, .. })));
    }
}

//! Shapes of elementary geometry into recipes, about the origin, and where their middle stands.

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, EllipseArc, Path, Polyline};
use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};
use crate::geometry::tessellate::{FlatPlane, Geodesic, Revolution, RoundedBox};
use crate::language::spec;
use crate::language::spec::{Base, GeodesicClass, Shape as Kind, Solid};
use crate::model::Recipe;

/// The recipe of an elementary shape; `None` for other kinds.
pub(super) fn primitive(kind: &Kind) -> Option<(Recipe, DVec3)> {
    Some(match kind {
        Kind::Box(cuboid) => {
            let (size, radius) = (cuboid.size.value, cuboid.radius.value);
            if radius > 0.0 {
                (Recipe::RoundedBox(RoundedBox { size, radius }), cuboid.center.value)
            } else {
                (Recipe::Cuboid { size, center: cuboid.center.value }, DVec3::ZERO)
            }
        }
        Kind::Sphere(sphere) => {
            let arc = EllipseArc::circle(DVec3::ZERO, sphere.radius.value, -90.0, 90.0);
            (turned(AnyCurve::Ellipse(arc)), sphere.center.value)
        }
        Kind::Cylinder(cylinder) => {
            let (radius, half) = (cylinder.radius.value, cylinder.height.value / 2.0);
            let corners = [(0.0, -half), (radius, -half), (radius, half), (0.0, half)];
            (turned(polyline(&corners, false)?), cylinder.center.value)
        }
        Kind::Cone(cone) => (turned(cone_profile(cone)?), cone.center.value),
        Kind::Capsule(capsule) => (turned(capsule_profile(capsule)?), capsule.center.value),
        Kind::Torus(torus) => {
            let (middle, radius) = (DVec3::X * torus.radius.value, torus.tube_radius.value);
            (turned(AnyCurve::Ellipse(EllipseArc::full(middle, radius, radius))), torus.center.value)
        }
        Kind::Tube(tube) => {
            let (outer, inner, half) = (tube.radius.value, tube.inner_radius.value, tube.height.value / 2.0);
            let corners = [(inner, -half), (outer, -half), (outer, half), (inner, half)];
            (turned(polyline(&corners, true)?), tube.center.value)
        }
        Kind::Disk(disk) => {
            let profile = polyline(&[(disk.inner_radius.value, 0.0), (disk.radius.value, 0.0)], false)?;
            let recipe = Recipe::Revolution(Revolution {
                profile,
                start: disk.start.value,
                angle: disk.angle.value,
                caps: false,
            });
            (recipe, disk.center.value)
        }
        Kind::Plane(plane) => (Recipe::Plane(FlatPlane { size: plane.size.value }), plane.center.value),
        Kind::Polyhedron(polyhedron) => (faces(polyhedron)?, polyhedron.center.value),
        Kind::Geodesic(ball) => (geodesic(ball), ball.center.value),
        _ => return None,
    })
}

fn turned(profile: AnyCurve) -> Recipe {
    Recipe::Revolution(Revolution { profile, start: 0.0, angle: 360.0, caps: true })
}

fn polyline(corners: &[(f64, f64)], closed: bool) -> Option<AnyCurve> {
    let corners = corners.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect();
    Polyline::new(corners, closed).map(AnyCurve::Polyline)
}

/// From the middle of the lower end over both rims to the middle of the upper end; an end without radius is a tip.
fn cone_profile(cone: &spec::Cone) -> Option<AnyCurve> {
    let half = cone.height.value / 2.0;
    let (low, high) = (cone.radius.value, cone.top_radius.value);
    let mut corners = vec![(0.0, -half), (low, -half), (high, half), (0.0, half)];
    // A point that is written twice is a corner without direction.
    corners.dedup();
    polyline(&corners, false)
}

fn capsule_profile(capsule: &spec::Capsule) -> Option<AnyCurve> {
    /// A straight part shorter than this part of the radius is none.
    const NONE: f64 = 1e-12;
    let radius = capsule.radius.value;
    let half = capsule.height.value / 2.0 - radius;
    if half <= NONE * radius {
        return Some(AnyCurve::Ellipse(EllipseArc::circle(DVec3::ZERO, radius, -90.0, 90.0)));
    }
    let end =
        |y: f64, from: f64| AnyCurve::Ellipse(EllipseArc::circle(DVec3::Y * y, radius, from, from + 90.0));
    let side = polyline(&[(radius, -half), (radius, half)], false)?;
    Path::new(vec![end(-half, -90.0), side, end(half, 0.0)]).map(AnyCurve::Path)
}

fn faces(polyhedron: &spec::Polyhedron) -> Option<Recipe> {
    let solid = match polyhedron.solid.value {
        Solid::Tetrahedron => Platonic::Tetrahedron,
        Solid::Cube => Platonic::Cube,
        Solid::Octahedron => Platonic::Octahedron,
        Solid::Dodecahedron => Platonic::Dodecahedron,
        Solid::Icosahedron => Platonic::Icosahedron,
    };
    let size = match (polyhedron.radius, polyhedron.edge, polyhedron.inradius) {
        (Some(radius), ..) => PlatonicSize::Circumradius(radius.value),
        (_, Some(edge), _) => PlatonicSize::Edge(edge.value),
        (_, _, inradius) => PlatonicSize::Inradius(inradius?.value),
    };
    let pose = match polyhedron.pose.value {
        spec::Pose::Axes => Pose::Axes,
        spec::Pose::Face => Pose::Face,
        spec::Pose::Edge => Pose::Edge,
        spec::Pose::Vertex => Pose::Vertex,
    };
    Some(Recipe::Polygons { mesh: platonic(solid, size, pose), materials: Vec::new() })
}

fn geodesic(ball: &spec::Geodesic) -> Recipe {
    Recipe::Geodesic(Geodesic {
        radius: ball.radius.value,
        base: match ball.base.value {
            Base::Tetrahedron => Platonic::Tetrahedron,
            Base::Octahedron => Platonic::Octahedron,
            Base::Icosahedron => Platonic::Icosahedron,
        },
        frequency: ball.frequency.map(|frequency| frequency.value),
        across: ball.class.value == GeodesicClass::Triacon,
    })
}

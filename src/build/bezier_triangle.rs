//! Bezier triangles of a document into surfaces of the kernel.

use glam::{DVec3, DVec4};

use super::Builder;
use super::patch::{MOST_REPORTS, broken_between, continuity, recipe};
use crate::geometry::curve::RationalSpline;
use crate::geometry::curve::control::Control;
use crate::geometry::surface::tensor::{PolynomialSurface, RationalSurface};
use crate::geometry::surface::triangle::{Coordinates, TriangleNet, side_of, triangle_joints};
use crate::geometry::surface::{AnySurface, SurfaceJoint, SurfaceJoints, SurfaceLine};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::model::Recipe;

impl Builder<'_> {
    pub(super) fn bezier_triangles(&mut self, triangles: &spec::BezierTriangles) -> Option<Recipe> {
        let points: Vec<DVec3> = triangles.points.iter().map(|point| point.value).collect();
        if !self.spans(&points, triangles.points.span) {
            return None;
        }
        let weights: Option<Vec<f64>> =
            triangles.weights.as_ref().map(|weights| weights.iter().map(|weight| weight.value).collect());
        // Equal weights say nothing: the triangles are polynomial.
        let rational = weights.filter(|weights| weights.iter().any(|weight| *weight != weights[0]));
        let (surfaces, found) = match rational {
            None => joined(&nets(triangles, &points), &polynomial),
            Some(mut weights) => {
                let most = weights.iter().copied().fold(0.0, f64::max);
                weights.iter_mut().for_each(|weight| *weight /= most);
                if weights.iter().any(|weight| *weight < LEAST_WEIGHT) {
                    self.report(unequal(triangles));
                    return None;
                }
                let homogeneous =
                    |(point, weight): (&DVec3, &f64)| RationalSpline::homogeneous(*point, *weight);
                let points: Vec<DVec4> = points.iter().zip(&weights).map(homogeneous).collect();
                joined(&nets(triangles, &points), &of_weights)
            }
        };
        self.check_triangle_joints(triangles, &found).then(|| recipe(surfaces))
    }

    /// Whether all joints are as smooth as declared.
    fn check_triangle_joints(&mut self, triangles: &spec::BezierTriangles, found: &SurfaceJoints) -> bool {
        let Some(declared) = triangles.continuity else { return true };
        let wanted = continuity(declared.value);
        let within = triangles.continuity_angle.value;
        let broken: Vec<&SurfaceJoint> =
            found.joints.iter().filter(|joint| !joint.smoothness.holds(wanted, within)).collect();
        for joint in broken.iter().take(MOST_REPORTS) {
            let [one, other] = joint.lines;
            let lines = format!("{} and {}", side(one), side(other));
            let mut report = Diagnostic::error(Code::BrokenSeam, broken_between(&lines, joint, wanted))
                .at(declared.span, format!("{wanted} does not hold"));
            let place =
                |index: usize| triangles.triangles.as_ref().map_or(Span::NONE, |lists| lists[index].span);
            if triangles.triangles.is_some() {
                report = report.also(place(one.0), "one side");
                if one.0 != other.0 {
                    report = report.also(place(other.0), "the other");
                }
            }
            if broken.len() > MOST_REPORTS {
                report = report.note(format!("{} of {} joints are so", broken.len(), found.joints.len()));
            }
            self.report(report);
        }
        broken.is_empty()
    }
}

/// The least weight as a share of the greatest: what is weaker does nothing that double precision could show.
const LEAST_WEIGHT: f64 = 1e-12;

fn unequal(triangles: &spec::BezierTriangles) -> Diagnostic {
    let place = triangles.weights.as_ref().map_or(Span::NONE, |weights| weights.span);
    Diagnostic::error(Code::BadWeight, "the weights differ by more than a factor of 1e12")
        .at(place, "too different")
        .help("a point without pull needs no weight near 0: leave it out of the triangle, or move it to its neighbor")
}

/// A side of a triangle in words.
fn side((triangle, line): (usize, SurfaceLine)) -> String {
    let corners = match line {
        SurfaceLine::Rim(rim) => side_of(rim),
        _ => None,
    };
    match corners {
        Some([from, to]) => format!("the side from corner {from} to {to} of triangle {triangle}"),
        None => format!("triangle {triangle}"),
    }
}

fn nets<P: Control>(triangles: &spec::BezierTriangles, points: &[P]) -> Vec<TriangleNet<P>> {
    let net = |points: Vec<P>| TriangleNet::new(points).expect("lists of points that fill triangles");
    match &triangles.triangles {
        None => vec![net(points.to_vec())],
        Some(lists) => {
            let first = triangles.first.value;
            let chosen = |list: &spec::Sp<Vec<spec::Sp<u32>>>| {
                net(list.iter().map(|number| points[(number.value - first) as usize]).collect())
            };
            lists.iter().map(chosen).collect()
        }
    }
}

fn joined<P: Coordinates>(
    nets: &[TriangleNet<P>],
    made: &dyn Fn(&TriangleNet<P>) -> AnySurface,
) -> (Vec<AnySurface>, SurfaceJoints) {
    let surfaces: Vec<AnySurface> = nets.iter().map(made).collect();
    let found = triangle_joints(nets, &surfaces);
    (surfaces, found)
}

fn polynomial(net: &TriangleNet<DVec3>) -> AnySurface {
    let n = net.degree();
    let made = PolynomialSurface::bezier((n, n), &net.grid(), vec![0.0, 1.0], vec![0.0, 1.0]);
    AnySurface::Polynomial(Box::new(made.expect("one patch of a degree that was checked")))
}

fn of_weights(net: &TriangleNet<DVec4>) -> AnySurface {
    let n = net.degree();
    let made = RationalSurface::bezier((n, n), &net.grid(), vec![0.0, 1.0], vec![0.0, 1.0]);
    AnySurface::Rational(Box::new(made.expect("all weights are clearly positive, and so are their means")))
}

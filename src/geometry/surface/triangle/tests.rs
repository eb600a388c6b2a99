//! Laws of triangular nets.

use glam::{DVec3, DVec4};

use super::{TriangleNet, triangle_joints};
use crate::geometry::surface::tensor::{PolynomialSurface, RationalSurface};
use crate::geometry::surface::{AnySurface, PatchContinuity, Surface};

fn net(degree: usize, seed: usize) -> TriangleNet<DVec3> {
    let number = |k: usize| ((seed * 7919 + k * 104_729) % 2003) as f64 / 1001.0 - 1.0;
    let count = (degree + 1) * (degree + 2) / 2;
    let points = (0..count).map(|k| DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2)));
    TriangleNet::new(points.collect()).expect("a full net")
}

fn places() -> impl Iterator<Item = [f64; 3]> {
    (0..=6).flat_map(|a| {
        (0..=6 - a).map(move |b| [f64::from(a), f64::from(b), f64::from(6 - a - b)].map(|x| x / 6.0))
    })
}

fn power(x: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |product, _| product * x)
}

/// The sum of control points times Bernstein polynomials, n! / (i! j! k!) x^i y^j z^k.
fn sum(net: &TriangleNet<DVec3>, [x, y, z]: [f64; 3]) -> DVec3 {
    let factorial = |n: usize| (1..=n).fold(1.0, |product, k| product * k as f64);
    let n = net.degree();
    let mut sum = DVec3::ZERO;
    for row in 0..=n {
        for k in 0..=row {
            let (i, j) = (n - row, row - k);
            let count = factorial(n) / (factorial(i) * factorial(j) * factorial(k));
            sum += net.get(row, k) * (count * power(x, i) * power(y, j) * power(z, k));
        }
    }
    sum
}

fn surface(net: &TriangleNet<DVec3>) -> AnySurface {
    let n = net.degree();
    let made = PolynomialSurface::bezier((n, n), &net.grid(), vec![0.0, 1.0], vec![0.0, 1.0]);
    AnySurface::Polynomial(Box::new(made.expect("a full grid")))
}

#[test]
fn counts_of_points_are_triangular() {
    let degrees: Vec<_> = (0..22).map(TriangleNet::<f64>::degree_of).collect();
    let known = [(3, 1), (6, 2), (10, 3), (15, 4), (21, 5)];
    for (count, degree) in degrees.iter().enumerate() {
        let expected = known.iter().find(|(points, _)| *points == count).map(|(_, degree)| *degree);
        assert_eq!(*degree, expected, "{count}");
    }
}

#[test]
fn de_casteljau_is_the_sum_of_bernstein() {
    for degree in 1..=9 {
        let net = net(degree, degree);
        for b in places() {
            assert!(net.evaluate(b).distance(sum(&net, b)) < 1e-13, "{degree} {b:?}");
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    for degree in 2..=6 {
        let net = net(degree, 3);
        let direction = [0.3, -0.8, 0.5];
        let derived = net.derived(direction).expect("not linear");
        for b in places() {
            let at = |h: f64| net.evaluate([0, 1, 2].map(|k| b[k] + h * direction[k]));
            let found = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!(derived.evaluate(b).distance(found) < 1e-7, "{degree} {b:?}");
        }
    }
    assert!(net(1, 1).derived([1.0, -1.0, 0.0]).is_none());
}

#[test]
fn a_higher_degree_is_the_same_surface() {
    for degree in 1..=6 {
        let net = net(degree, 5);
        let raised = net.elevated().elevated();
        assert_eq!(raised.degree(), degree + 2);
        for b in places() {
            assert!(net.evaluate(b).distance(raised.evaluate(b)) < 1e-13);
        }
    }
}

#[test]
fn parts_are_parts_of_the_whole() {
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for degree in 1..=5 {
        let net = net(degree, 7);
        let at = [0.2, 0.5, 0.3];
        for (replaced, part) in net.divided(at).iter().enumerate() {
            let mut own = corners;
            own[replaced] = at;
            for b in places() {
                let whole = [0, 1, 2].map(|k| b[0] * own[0][k] + b[1] * own[1][k] + b[2] * own[2][k]);
                assert!(part.evaluate(b).distance(net.evaluate(whole)) < 1e-13, "{degree} {replaced} {b:?}");
            }
        }
    }
}

#[test]
fn names_of_corners_do_not_matter() {
    let net = net(4, 2);
    for from in [[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 2, 1]] {
        let renamed = net.renamed(from);
        for b in places() {
            let mut old = [0.0; 3];
            (0..3).for_each(|corner| old[from[corner]] = b[corner]);
            assert!(renamed.evaluate(b).distance(net.evaluate(old)) < 1e-14);
        }
    }
}

#[test]
fn as_a_patch_it_is_the_same_surface() {
    for degree in 1..=7 {
        let net = net(degree, 11);
        let surface = surface(&net);
        for (u, v) in (0..=5).flat_map(|a| (0..=5).map(move |b| (f64::from(a) / 5.0, f64::from(b) / 5.0))) {
            let expected = net.evaluate([1.0 - v, v * (1.0 - u), v * u]);
            assert!(surface.evaluate(u, v).point.distance(expected) < 1e-13, "{degree} {u} {v}");
        }
        // The pole is one point but for rounding.
        let pole = |u: f64| surface.evaluate(u, 0.0).point;
        assert!((0..=8).all(|k| pole(f64::from(k) / 8.0).distance(net.get(0, 0)) < 1e-15));
    }
}

/// A net over a triangle of the plane, with heights from a polynomial, has the polynomial as its surface: raised from its
/// own degree. Neighbours of one polynomial are C2, and of one polynomial on one side only C1 or less.
#[test]
fn joints_have_the_class_of_what_they_are_pieces_of() {
    // Heights of quadratic polynomials by their polar form f(p, q).
    let blossom = |c: f64, p: DVec3, q: DVec3| {
        p.x * q.x - 0.5 * (p.x * q.y + p.y * q.x) + c * p.y * q.y + 0.3 * (p.y + q.y) / 2.0
    };
    let triangle = |corners: [[f64; 2]; 3], c: f64| {
        let corner = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
        let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let points = pairs.map(|(i, j)| {
            let middle = (corner[i] + corner[j]) / 2.0;
            middle.with_z(blossom(c, corner[i], corner[j]))
        });
        TriangleNet::new(points.to_vec()).expect("six points")
    };
    // The common side lies on y = 0, where y^2 and its slope vanish.
    let upper = [[0.2, 1.0], [0.0, 0.0], [1.0, 0.0]];
    let lower = [[1.0, 0.0], [0.7, -1.5], [0.0, 0.0]];
    let class = |nets: [TriangleNet<DVec3>; 2]| {
        let surfaces: Vec<AnySurface> = nets.iter().map(surface).collect();
        let found = triangle_joints(&nets, &surfaces);
        assert_eq!((found.joints.len(), found.open.len(), found.collapsed.len()), (1, 4, 2));
        found.joints[0].smoothness.continuity
    };
    let above = triangle(upper, 0.4);
    assert_eq!(class([above.clone(), triangle(lower, 0.4)]), PatchContinuity::C2);
    assert_eq!(class([above.clone(), triangle(lower, 0.4).elevated()]), PatchContinuity::C2);
    assert_eq!(class([above.clone(), triangle(lower, 0.9)]), PatchContinuity::C1);
    // Folded back over the other one: the planes agree, the surface turns around.
    let folded = triangle([[1.0, 0.0], [0.7, 1.5], [0.0, 0.0]], 0.4);
    assert!(class([above, folded]) < PatchContinuity::C1);
}

/// An eighth of a sphere as a rational triangle of degree 4. Source: G. Farin, B. Piper, A. Worsey, The octant of a sphere
/// as a non-degenerate triangular Bezier patch, CAGD 4 (1987).
pub(crate) fn octant() -> TriangleNet<DVec4> {
    let (two, three) = (2.0_f64.sqrt(), 3.0_f64.sqrt());
    let (a, b) = ((three - 1.0) / three, (three + 1.0) / (2.0 * three));
    let c = 1.0 - (5.0 - two) * (7.0 - three) / 46.0;
    let weights =
        [4.0 * three * (three - 1.0), 3.0 * two, 4.0, (2.0_f64 / 3.0).sqrt() * (3.0 + 2.0 * two - three)];
    let [corner, beside, middle, inner] = weights;
    let points = [
        ([0.0, 0.0, 1.0], corner),
        ([a, 0.0, 1.0], beside),
        ([0.0, a, 1.0], beside),
        ([b, 0.0, b], middle),
        ([c, c, 1.0], inner),
        ([0.0, b, b], middle),
        ([1.0, 0.0, a], beside),
        ([1.0, c, c], inner),
        ([c, 1.0, c], inner),
        ([0.0, 1.0, a], beside),
        ([1.0, 0.0, 0.0], corner),
        ([1.0, a, 0.0], beside),
        ([b, b, 0.0], middle),
        ([a, 1.0, 0.0], beside),
        ([0.0, 1.0, 0.0], corner),
    ];
    let homogeneous = points.map(|(at, w)| (DVec3::from_array(at) * w).extend(w));
    TriangleNet::new(homogeneous.to_vec()).expect("fifteen points")
}

#[test]
fn an_eighth_of_a_sphere_is_one() {
    let made = RationalSurface::bezier((4, 4), &octant().grid(), vec![0.0, 1.0], vec![0.0, 1.0]);
    let surface = made.expect("positive weights");
    for (u, v) in (0..=8).flat_map(|a| (0..=8).map(move |b| (f64::from(a) / 8.0, f64::from(b) / 8.0))) {
        let jet = surface.evaluate(u, v);
        assert!((jet.point.length() - 1.0).abs() < 4e-16 * 4.0, "{u} {v}");
        assert!(jet.normal.dot(jet.point).abs() > 1.0 - 1e-12, "{u} {v}: {}", jet.normal);
    }
}

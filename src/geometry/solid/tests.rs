//! Laws of sets, on random pairs and on contacts that are anything but random.
#![cfg(feature = "csg")]

use glam::{DAffine3, DQuat, DVec2, DVec3};

use super::check::moments;
use super::{Check, Combination, Combined, Making, SolidFault, Stock, combine};
use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex, index, topology};

/// Numbers that look random: Knuth's MMIX generator.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(self.0 >> 40).expect("24 bits")) / 16_777_216.0
    }

    fn pick(&mut self, count: u32) -> u32 {
        (0..count).find(|k| self.roll() * f64::from(count - k) < 1.0).unwrap_or(0)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.roll(), self.roll(), self.roll()) * 2.0 - 1.0
    }
}

/// A mesh of bare triangles, every corner with the normal of its triangle, its place as UV and parameters.
fn mesh(points: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh { points: points.to_vec(), ..Mesh::default() };
    for corners in triangles {
        let [a, b, c] = corners.map(|point| points[point as usize]);
        let normal = (b - a).cross(c - a).normalize();
        let first = index(mesh.vertices.len());
        mesh.vertices.extend(corners.map(|point| {
            let place = points[point as usize];
            let anchor = Anchor { source: 0, u: place.x + place.z, v: place.y };
            Vertex {
                point: PointIndex(point),
                normal,
                uv: DVec2::new(place.x - place.z, place.y),
                color: Color::WHITE,
                anchor,
            }
        }));
        mesh.triangles.push([first, first + 1, first + 2].map(VertexIndex));
    }
    mesh.runs = vec![Run { origin: 0, end: index(mesh.triangles.len()) }];
    mesh
}

fn solid(of: Platonic) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let made = platonic(of, PlatonicSize::Edge(1.0), Pose::Vertex);
    let mut triangles = Vec::new();
    for face in 0..made.faces.len() {
        let corners: Vec<u32> = made.corners[made.corners_of(face)].iter().map(|corner| corner.0).collect();
        triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
    }
    (made.points, triangles)
}

fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let bit = |k: u32, axis: u32| f64::from(k >> axis & 1);
    let points = (0..8).map(|k| DVec3::new(bit(k, 0), bit(k, 1), bit(k, 2))).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (points, faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
}

/// A ring of square section.
fn ring(around: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corners = [(0.5, -0.2), (1.0, -0.2), (1.0, 0.2), (0.5, 0.2)];
    let mut points = Vec::new();
    for k in 0..around {
        let turn = DQuat::from_rotation_y(-core::f64::consts::TAU * f64::from(k) / f64::from(around));
        points.extend(corners.map(|(radius, height)| turn * DVec3::new(radius, height, 0.0)));
    }
    let at = |k: u32, corner: u32| 4 * (k % around) + corner % 4;
    let sides = (0..around).flat_map(|k| (0..4).map(move |corner| (k, corner)));
    let triangles = sides.flat_map(|(k, c)| {
        let [a, b, d, e] = [at(k, c), at(k, c + 1), at(k + 1, c + 1), at(k + 1, c)];
        [[a, b, d], [a, d, e]]
    });
    (points, triangles.collect())
}

fn subject(dice: &mut Dice, number: u32) -> Mesh {
    let (points, triangles) = match dice.pick(4) {
        0 => cube(),
        1 => solid(Platonic::Icosahedron),
        2 => solid(Platonic::Dodecahedron),
        _ => ring(5 + dice.pick(6)),
    };
    // A third stands on a coarse lattice, so that faces meet; of those a half is off it by almost nothing.
    let map = match number % 3 {
        0 => {
            let step = |value: f64| (value * 2.0).round() / 2.0;
            let jitter = if dice.pick(2) == 0 { 1e-13 } else { 0.0 };
            let place = dice.vector();
            let place = DVec3::new(step(place.x), step(place.y), step(place.z)) + dice.vector() * jitter;
            DAffine3::from_translation(place)
        }
        _ => {
            let turn = DQuat::from_scaled_axis(dice.vector() * 3.0);
            DAffine3::from_scale_rotation_translation(
                DVec3::ONE * (0.4 + dice.roll()),
                turn,
                dice.vector() * 0.6,
            )
        }
    };
    let points: Vec<DVec3> = points.iter().map(|point| map.transform_point3(*point)).collect();
    mesh(&points, &triangles)
}

fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    let of = |triangle: &[VertexIndex; 3]| triangle.map(|vertex| mesh.vertices[vertex.subscript()].point.0);
    mesh.triangles.iter().map(of).collect()
}

fn volume(mesh: &Mesh) -> f64 {
    moments(&mesh.points, corners(mesh).into_iter()).0 / 6.0
}

/// Volume of a result that must be closed; 0 of one that is empty.
fn closed(result: Result<Combined, SolidFault>, what: &str) -> f64 {
    match result {
        Err(SolidFault::Nothing) => 0.0,
        Err(fault) => panic!("{what}: {fault}"),
        Ok(Combined { mesh, .. }) => {
            let found = topology::of_triangles(&corners(&mesh), mesh.points.len()).expect("few");
            assert!(found.closed && found.crowded_edges == 0, "{what}: {found:?}");
            carries(&mesh, what);
            volume(&mesh)
        }
    }
}

/// Every corner has the UV and the parameters of its place, and a normal across its triangle or its mirror image.
fn carries(mesh: &Mesh, what: &str) {
    for triangle in &mesh.triangles {
        let vertices = triangle.map(|vertex| &mesh.vertices[vertex.subscript()]);
        let [a, b, c] = vertices.map(|vertex| mesh.points[vertex.point.subscript()]);
        for vertex in vertices {
            let place = mesh.points[vertex.point.subscript()];
            let uv = DVec2::new(place.x - place.z, place.y);
            assert!(vertex.uv.distance(uv) < 1e-9, "{what}: {place} {}", vertex.uv);
            let off = (vertex.anchor.u - place.x - place.z).abs() + (vertex.anchor.v - place.y).abs();
            assert!(off < 1e-9, "{what}: {place} {:?}", vertex.anchor);
            let across = (b - a).cross(c - a);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            // Of a sliver the direction is rounding.
            if across.length() > 1e-9 * longest * longest {
                assert!(
                    across.normalize().dot(vertex.normal) > 1.0 - 1e-6,
                    "{what}: {across} {}",
                    vertex.normal
                );
            }
        }
    }
}

fn all_three(a: &Mesh, b: &Mesh, resolution: f64) -> [Result<Combined, SolidFault>; 3] {
    let mut stock = Stock::default();
    let [one, other] = [a, b].map(|part| Combination::Part(stock.add(part, 0)));
    let making = Making { resolution, ..Making::default() };
    [
        combine(&stock, &Combination::Union(vec![one.clone(), other.clone()]), &making),
        combine(&stock, &Combination::Intersection(vec![one.clone(), other.clone()]), &making),
        combine(&stock, &Combination::Difference(Box::new(one), vec![other]), &making),
    ]
}

#[test]
fn volumes_of_random_pairs_obey_inclusion_and_exclusion() {
    let mut dice = Dice(5);
    let mut met = 0;
    for number in 0..1000 {
        let (a, b) = (subject(&mut dice, number), subject(&mut dice, number));
        let what = format!("pair {number}");
        let [union, common, rest] = all_three(&a, &b, 0.0).map(|result| closed(result, &what));
        let (one, other) = (volume(&a), volume(&b));
        let scale = one + other;
        assert!(
            (union + common - one - other).abs() <= 1e-12 * scale,
            "{what}: {union} {common} {one} {other}"
        );
        assert!((rest + common - one).abs() <= 1e-12 * scale, "{what}: {rest} {common} {one}");
        met += u32::from(common > 0.0);
    }
    assert!(met > 600, "only {met} pairs have anything in common");
}

/// What is written has single precision: nothing may tear or fold there.
#[test]
fn rounded_results_of_random_pairs_are_closed() {
    let mut dice = Dice(17);
    for number in 0..300 {
        let (a, b) = (subject(&mut dice, number), subject(&mut dice, number));
        let resolution = 2.0 * crate::geometry::number::single_rounding(a.bounds().union(b.bounds()).reach());
        for (which, result) in all_three(&a, &b, resolution).into_iter().enumerate() {
            let Ok(Combined { mesh, moved }) = result else { continue };
            assert!(moved <= 8.0 * resolution, "pair {number}: {moved} of {resolution}");
            let single: Vec<DVec3> = mesh.points.iter().map(|point| point.as_vec3().as_dvec3()).collect();
            let welded = weld_equal(&single);
            let joined = |triangle: &[u32; 3]| triangle.map(|point| welded.map[point as usize]);
            let triangles: Vec<[u32; 3]> = corners(&mesh).iter().map(joined).collect();
            let found = topology::of_triangles(&triangles, welded.points.len()).expect("few");
            assert!(found.closed, "pair {number}, operation {which}: {found:?}");
        }
    }
}

#[test]
fn touching_faces_leave_no_wall_and_nothing_in_common() {
    let (points, triangles) = cube();
    let moved = |by: DVec3| mesh(&points.iter().map(|point| *point + by).collect::<Vec<_>>(), &triangles);
    let one = moved(DVec3::ZERO);
    for (by, components, area) in [
        (DVec3::X, 1, 10.0),
        (DVec3::new(1.0, 0.5, 0.0), 1, 11.0),
        (DVec3::new(1.0, 0.25, 0.5), 1, 12.0 - 2.0 * 0.75 * 0.5),
        (DVec3::new(1.0, 1.0, 0.0), 2, 12.0),
        (DVec3::ONE, 2, 12.0),
    ] {
        let [union, common, rest] = all_three(&one, &moved(by), 0.0);
        let union = union.expect("two cubes").mesh;
        let found = topology::of_triangles(&corners(&union), union.points.len()).expect("few");
        assert_eq!((found.closed, found.manifold, found.components), (true, true, components), "{by}");
        assert!((moments(&union.points, corners(&union).into_iter()).1 / 2.0 - area).abs() < 1e-12, "{by}");
        assert_eq!(common.map(|made| made.mesh.triangles.len()), Err(SolidFault::Nothing), "{by}");
        assert!((volume(&rest.expect("the first").mesh) - 1.0).abs() < 1e-15, "{by}");
    }
    let [same, common, rest] = all_three(&one, &one, 0.0);
    for made in [same, common] {
        let made = made.expect("the cube again").mesh;
        assert_eq!((made.triangles.len(), made.points.len()), (12, 8));
    }
    assert_eq!(rest.map(|_| ()), Err(SolidFault::Nothing));
}

#[test]
fn results_do_not_depend_on_threads_or_on_what_was_made_before() {
    let make = |seed: u64| {
        let mut dice = Dice(seed);
        let (a, b) = (subject(&mut dice, 1), subject(&mut dice, 2));
        all_three(&a, &b, 0.0).map(|made| made.map(|made| made.mesh))
    };
    let alone: Vec<_> = (0..40).map(make).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().expect("four threads");
    let together: Vec<_> = pool.install(|| {
        use rayon::prelude::{IntoParallelIterator, ParallelIterator};
        (0..40_u64).into_par_iter().map(make).collect()
    });
    assert_eq!(alone, together);
}

#[test]
fn parts_that_are_no_solids_are_told_apart() {
    let (points, triangles) = cube();
    let good = mesh(&points, &triangles);
    let with = |triangles: &[[u32; 3]], check: Check| {
        let mut stock = Stock::default();
        let all = [&good, &mesh(&points, triangles)].map(|part| Combination::Part(stock.add(part, 0)));
        let making = Making { check: &[Check::Trusted, check], ..Making::default() };
        combine(&stock, &Combination::Union(all.to_vec()), &making).map(|_| ())
    };
    assert_eq!(with(&triangles, Check::Crossings), Ok(()));
    let open = with(&triangles[1..], Check::Trusted);
    assert!(matches!(open, Err(SolidFault::Open { part: 1, edges: 3, .. })), "{open:?}");
    let mut turned = triangles.clone();
    turned[0].swap(1, 2);
    let found = with(&turned, Check::Trusted);
    assert!(matches!(found, Err(SolidFault::Misoriented { part: 1, edges: 3, .. })), "{found:?}");
    let inward: Vec<[u32; 3]> = triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    assert_eq!(with(&inward, Check::Trusted), Err(SolidFault::InsideOut { part: 1, volume: -1.0 }));
    let sheet = [[0, 1, 3], [0, 3, 1]];
    assert_eq!(with(&sheet, Check::Trusted), Err(SolidFault::NoVolume { part: 1 }));
    // Two corners changed places: closed and outward, but it crosses itself.
    let crossed: Vec<[u32; 3]> = (triangles.iter())
        .map(|corners| corners.map(|point| if point < 2 { 1 - point } else { point }))
        .collect();
    let found = with(&crossed, Check::Crossings);
    assert!(
        matches!(
            found,
            Err(SolidFault::Crossing { part: 1, .. }
                | SolidFault::InsideOut { .. }
                | SolidFault::NoVolume { .. })
        ),
        "{found:?}"
    );
}

#[test]
fn groups_that_overlap_and_hollows_are_understood() {
    let (points, triangles) = cube();
    let placed = |size: f64, by: f64, inward: bool| {
        let points: Vec<DVec3> = points.iter().map(|point| (*point - 0.5) * size + DVec3::X * by).collect();
        let turned: Vec<[u32; 3]> =
            triangles.iter().map(|[a, b, c]| if inward { [*a, *c, *b] } else { [*a, *b, *c] }).collect();
        mesh(&points, &turned)
    };
    let volume_of = |parts: &[Mesh]| {
        let mut group = Mesh::default();
        parts.iter().for_each(|part| group.append(part, 0));
        let mut stock = Stock::default();
        let whole = Combination::Part(stock.add(&group, 0));
        let far = Combination::Part(stock.add(&placed(1.0, 100.0, false), 0));
        closed(
            combine(&stock, &Combination::Difference(Box::new(whole), vec![far]), &Making::default()),
            "group",
        )
    };
    assert!((volume_of(&[placed(1.0, 0.0, false), placed(1.0, 0.5, false)]) - 1.5).abs() < 1e-12);
    assert!((volume_of(&[placed(1.0, 0.0, false), placed(1.0, 1.0, false)]) - 2.0).abs() < 1e-12);
    let hollow = [placed(3.0, 0.0, false), placed(2.0, 0.0, true)];
    assert!((volume_of(&hollow) - 19.0).abs() < 1e-12);
    let [outer, inner] = hollow;
    assert!((volume_of(&[outer.clone(), inner.clone(), placed(1.0, 0.0, false)]) - 20.0).abs() < 1e-12);
    assert!((volume_of(&[inner, placed(1.0, 8.0, false), outer]) - 20.0).abs() < 1e-12);
}

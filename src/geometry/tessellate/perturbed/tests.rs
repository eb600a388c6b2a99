//! Laws of perturbed patches.

use glam::{DVec2, DVec3};

use super::judge::FaceChart;
use super::{NetBase, NetBump, PerturbedNet, PerturbedSkin, SkinFault, perturbed};
use crate::geometry::field::{Field, Quadric, Relief, ReliefBump};
use crate::geometry::number::sin;
use crate::geometry::planar::encloses;
use crate::geometry::tessellate::region::Chart as _;
use crate::geometry::tessellate::{Detail, Evidence, SurfaceDensity};

fn ball(center: DVec3, radius: f64) -> Relief {
    let square = 1.0 / (radius * radius);
    let constant = center.length_squared() * square - 1.0;
    Relief::smooth(Quadric::new(DVec3::splat(square), DVec3::ZERO, center * (-2.0 * square), constant))
}

fn bump(center: DVec3, radius: f64, factor: f64) -> NetBump {
    NetBump { bump: ReliefBump::new(ball(center, radius), factor), faces: None }
}

/// A hill with a dent in it, and a bump on the dent's rim.
fn nested(center: DVec3, factor: f64) -> NetBump {
    let mut hill = ball(center, 0.5);
    hill.bumps.push(ReliefBump::new(ball(center + DVec3::new(0.1, 0.1, 0.1), 0.3), -0.6));
    NetBump { bump: ReliefBump::new(hill, factor), faces: None }
}

fn octahedron(base: NetBase, bumps: Vec<NetBump>) -> PerturbedNet {
    let axes = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    PerturbedNet {
        points: axes.to_vec(),
        faces: faces.map(|face| face.to_vec()).to_vec(),
        base,
        bumps,
        reach: None,
        depth: None,
    }
}

fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: false,
        triangle_limit: 1 << 20,
    }
}

fn head() -> Vec<NetBump> {
    vec![
        bump(DVec3::new(0.9, 0.1, 0.2), 0.5, 0.4),
        nested(DVec3::new(0.0, 0.6, 0.7), 0.3),
        bump(DVec3::new(-0.6, -0.6, 0.4), 0.4, -0.2),
    ]
}

#[test]
fn roots_are_zeros_and_rays_meet_no_other() {
    for base in [NetBase::Ball(DVec3::ZERO), NetBase::FlatAround(DVec3::ZERO)] {
        let skin = PerturbedSkin::new(&octahedron(base, head())).expect("sound");
        assert!(skin.is_closed() && !skin.is_solid());
        for face in &skin.faces {
            let (low, high) = face.rectangle();
            for k in 0..400 {
                let part = DVec2::new(f64::from(k % 20), f64::from(k / 20)) / 19.0;
                let at = low + (high - low) * part;
                if !encloses(&face.outline, at) {
                    continue;
                }
                let root = face.root(at).expect("proved");
                assert!(face.relief.value(root).abs() < 1e-13, "{root}");
                let signs = (0..=200).map(|k| {
                    let (from, to) = face.reach;
                    face.relief.value(face.rays.point(at, from + (to - from) * f64::from(k) / 200.0)) < 0.0
                });
                let signs: Vec<bool> = signs.collect();
                assert_eq!(signs.windows(2).filter(|pair| pair[0] != pair[1]).count(), 1, "{at}");
            }
        }
    }
}

/// The bound of a triangle holds at all its places, and is no more than a few times what is found.
#[test]
fn no_place_of_a_triangle_is_further_away_than_its_bound() {
    let skin = PerturbedSkin::new(&octahedron(NetBase::Ball(DVec3::ZERO), head())).expect("sound");
    let face = &skin.faces[0];
    let chart = FaceChart { face };
    let middle = face.outline.iter().sum::<DVec2>() / 3.0;
    let (mut judged, mut loosest): (u32, f64) = (0, 0.0);
    for k in 0..300 {
        let t = f64::from(k);
        let size = 0.3 / (1.0 + f64::from(k % 9));
        let at = middle + DVec2::new(sin(1.3 * t), sin(2.1 * t + 1.0)) * 0.35;
        let places = [
            at,
            at + DVec2::new(size, 0.3 * size * sin(t)),
            at + DVec2::new(0.4 * size * sin(3.0 * t), size),
        ];
        if places.iter().any(|place| !encloses(&face.outline, *place)) {
            continue;
        }
        let corners = places.map(|place| face.root(place).expect("proved"));
        let judgment = chart.judge(places, corners);
        if judgment.bound.is_infinite() {
            assert!(size > 0.034, "small triangles have bounds");
            continue;
        }
        let mut found: f64 = 0.0;
        for i in 0..=16 {
            for j in 0..=16 - i {
                let (s, t) = (f64::from(i) / 16.0, f64::from(j) / 16.0);
                let place = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
                found = found.max(face.distance(place));
            }
        }
        assert!(found <= judgment.bound * (1.0 + 1e-9) + 1e-15, "{found} {}", judgment.bound);
        loosest = loosest.max(judgment.bound / found);
        judged += 1;
    }
    assert!(judged > 80, "{judged}");
    assert!(loosest < 60.0, "{loosest}");
}

#[test]
fn flat_faces_without_bumps_are_triangles() {
    let skin = PerturbedSkin::new(&octahedron(NetBase::Flat, Vec::new())).expect("sound");
    let made = perturbed(&skin, &detail(1e-3)).expect("made");
    assert_eq!((made.mesh.points.len(), made.mesh.triangles.len(), made.mesh.vertices.len()), (6, 8, 24));
    assert_eq!((made.deviation.bound, made.deviation.evidence), (0.0, Evidence::Exact));
}

/// Against the integral of the root of the curvature over twice the tolerance.
#[test]
fn a_ball_takes_few_triangles() {
    let skin = PerturbedSkin::new(&octahedron(NetBase::Ball(DVec3::ZERO), Vec::new())).expect("sound");
    let made = perturbed(&skin, &detail(1e-3)).expect("made");
    let least = 4.0 * core::f64::consts::PI / 1e-3 / 2.0;
    let count = made.mesh.triangles.len() as f64;
    assert!(made.deviation.evidence == Evidence::Proved && count < 1.5 * least, "{count} {least}");
    for vertex in &made.mesh.vertices {
        let point = made.mesh.points[vertex.point.subscript()];
        assert!((point.length() - 1.0).abs() < 1e-14 && vertex.normal.distance(point) < 1e-13);
    }
}

/// A bump high enough to overhang makes a solid; just below that the rays are proved to meet it once.
#[test]
fn overhangs_are_found_where_they_begin() {
    let square = |factor: f64| PerturbedNet {
        points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
        faces: vec![vec![0, 1, 2, 3]],
        base: NetBase::Flat,
        bumps: vec![bump(DVec3::new(0.5, 0.5, 0.1), 0.3, factor)],
        reach: None,
        depth: None,
    };
    // By trial on many rays: the slope of z - f Q² along z is 1 - 2 f Q Q_z.
    let slope = |factor: f64, at: f64, z: f64| {
        let field = ball(DVec3::new(0.5, 0.5, 0.1), 0.3);
        let place = DVec3::new(at, 0.5, z);
        let depth = field.value(place).min(0.0);
        1.0 - 2.0 * factor * depth * field.base.gradient(place).z
    };
    let root = |factor: f64, at: f64| {
        let field = ball(DVec3::new(0.5, 0.5, 0.1), 0.3);
        let value = |z: f64| {
            let depth = field.value(DVec3::new(at, 0.5, z)).min(0.0);
            z - factor * depth * depth
        };
        let (mut low, mut high) = (-0.5, 1.0);
        for _ in 0..80 {
            let z = 0.5 * (low + high);
            *(if value(z) < 0.0 { &mut low } else { &mut high }) = z;
        }
        low
    };
    for factor in [0.05, 0.1, 0.2, 0.4, 0.8, 1.6] {
        let least = (0..=600)
            .map(|k| {
                let at = 0.2 + 0.6 * f64::from(k) / 600.0;
                slope(factor, at, root(factor, at))
            })
            .fold(f64::INFINITY, f64::min);
        let skin = PerturbedSkin::new(&square(factor)).expect("one face has a solid");
        if least < -1e-2 {
            assert!(skin.is_solid(), "{factor} {least}");
        }
        if least > 0.05 {
            assert!(!skin.is_solid(), "{factor} {least}");
        }
    }
}

#[test]
fn bumps_for_one_face_part_neighbors() {
    let mut bumps = head();
    bumps[0].faces = Some(vec![0]);
    let fault = PerturbedSkin::new(&octahedron(NetBase::Ball(DVec3::ZERO), bumps)).expect_err("parted");
    let SkinFault::Parted { bump: 0, faces, place } = fault else { panic!("{fault:?}") };
    assert!(faces.contains(&0) && place.distance(DVec3::new(0.9, 0.1, 0.2)) < 0.6, "{faces:?} {place}");
    // Inside of a face it does not.
    let center = DVec3::ONE.normalize();
    let bumps = vec![NetBump { faces: Some(vec![0]), ..bump(center, 0.3, 0.1) }];
    assert!(PerturbedSkin::new(&octahedron(NetBase::Ball(DVec3::ZERO), bumps)).is_ok());
}

#[test]
fn a_closed_skin_of_flat_faces_has_bumps_inside_of_one() {
    let quadric = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::ZERO, -1.0);
    let net = PerturbedNet {
        points: vec![
            DVec3::new(-2.0, -2.0, 0.0),
            DVec3::new(2.0, -2.0, 0.0),
            DVec3::new(2.0, 2.0, 0.0),
            DVec3::new(-2.0, 2.0, 0.0),
            DVec3::NEG_Z,
        ],
        faces: vec![vec![0, 1, 2, 3], vec![1, 0, 4], vec![2, 1, 4], vec![3, 2, 4], vec![0, 3, 4]],
        base: NetBase::Flat,
        bumps: vec![NetBump { bump: ReliefBump::new(Relief::smooth(quadric), 0.25), faces: Some(vec![0]) }],
        reach: Some(1.0),
        depth: None,
    };
    let skin = PerturbedSkin::new(&net).expect("sound");
    let made = perturbed(&skin, &detail(1e-2)).expect("straight sides beside a bump");
    assert!(made.deviation.bound <= 1e-2 && made.mesh.triangles.len() < 500, "{}", made.mesh.triangles.len());
}

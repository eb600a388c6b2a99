//! Laws of quadrics inside balls.

use glam::{DQuat, DVec3};

use super::super::tests::{PI, area, axes, check, detail, every_kind, made, open_edges, turned, volume};
use super::super::{Clip, ClippedQuadric, quadric};
use super::Ball;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::tessellate::TessellateError;

fn ball(center: [f64; 3], radius: f64) -> Option<Clip> {
    Some(Clip::Ball(Ball { center: DVec3::from_array(center), radius }))
}

fn unit() -> Option<Clip> {
    ball([0.0; 3], 1.0)
}

#[test]
fn bodies_have_the_volumes_of_their_closed_forms() {
    let bowl = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), 0.0);
    let aside = Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::new(-2.0, 0.0, 0.0), 0.0);
    let plane = |offset: f64| Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::Z, offset);
    // Of a unit ball: what a cylinder of radius 1/2 takes and leaves, half, a cap of height 0.4, a slab, two cones of 45
    // degrees, a paraboloid to the height where x^2 + y^2 = z meets the ball, the lens of two balls, wedges, all of it.
    let left = 0.75 * 0.75_f64.sqrt();
    let level = (5.0_f64.sqrt() - 1.0) / 2.0;
    let dome = |from: f64| PI * (2.0 / 3.0 - from + from * from * from / 3.0);
    for (name, shape, expected) in [
        ("rod", axes([1.0, 1.0, 0.0], -0.25), 4.0 * PI / 3.0 * (1.0 - left)),
        ("ring", axes([-1.0, -1.0, 0.0], 0.25), 4.0 * PI / 3.0 * left),
        ("half", plane(0.0), 2.0 * PI / 3.0),
        ("cap", plane(0.6), PI * 0.16 * 2.6 / 3.0),
        ("slab", axes([0.0, 0.0, 1.0], -0.25), PI * (1.0 - 0.25 / 3.0)),
        ("lids", axes([0.0, 0.0, -1.0], 0.25), 2.0 * dome(0.5)),
        ("wedges", axes([1.0, -1.0, 0.0], 0.0), 2.0 * PI / 3.0),
        ("cones", axes([1.0, 1.0, -1.0], 0.0), 4.0 * PI / 3.0 * (1.0 - 0.5_f64.sqrt())),
        ("bowl", bowl, PI * level * level / 2.0 + dome(level)),
        ("lens", aside, 5.0 * PI / 12.0),
        ("all of it", axes([1.0; 3], -4.0), 4.0 * PI / 3.0),
        ("a ball inside", axes([1.0; 3], -0.25), PI / 6.0),
        ("a shell", axes([-1.0; 3], 0.25), 4.0 * PI / 3.0 * 0.875),
        ("the same ball", axes([1.0; 3], -1.0), 4.0 * PI / 3.0),
    ] {
        let whole = ClippedQuadric { quadric: shape, within: unit(), closed: true };
        for tolerance in [1e-2, 1e-3, 3e-4] {
            let made = made(shape, unit(), true, tolerance);
            check(&whole, &made);
            assert_eq!(open_edges(&made.mesh), 0, "{name} at {tolerance}");
            assert!(made.deviation.bound <= tolerance, "{name}: {}", made.deviation.bound);
            let off = (volume(&made.mesh) - expected).abs();
            let most = 1.01 * area(&made.mesh) * made.deviation.bound + 1e-7;
            assert!(off <= most, "{name} at {tolerance}: {} for {expected}", volume(&made.mesh));
        }
    }
}

/// Points of the cut lie on the ball, and those of both surfaces on both.
#[test]
fn every_kind_is_cut_by_balls_in_every_position() {
    let turns = [
        DQuat::IDENTITY,
        DQuat::from_xyzw(0.18, -0.36, 0.54, 0.738_918_1).normalize(),
        DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
    ];
    let balls = [
        ball([0.0; 3], 1.0),
        ball([0.3, -0.2, 0.4], 0.6),
        ball([0.5, 0.05, 0.0], 0.5),
        ball([-2.0, 1.0, 0.5], 2.4),
    ];
    let mut cut = 0;
    for (kind, plain) in every_kind() {
        for turn in turns {
            for origin in [DVec3::ZERO, DVec3::new(0.1, 0.2, -0.15)] {
                let placed = turned(&plain, turn, origin);
                for within in balls {
                    let mut sum = 0.0;
                    let Some(Clip::Ball(ball)) = within else { panic!("a ball") };
                    for sign in [1.0, -1.0] {
                        let quadric = Quadric { a: placed.a * sign, b: placed.b * sign, c: placed.c * sign };
                        let shape = ClippedQuadric { quadric, within, closed: true };
                        let made = match super::super::quadric(&shape, &detail(3e-3 * ball.radius)) {
                            Ok(made) => made,
                            Err(TessellateError::NoArea) => continue,
                            Err(error) => panic!("{kind:?} {turn} {origin} {within:?} {sign}: {error}"),
                        };
                        check(&shape, &made);
                        assert_eq!(open_edges(&made.mesh), 0, "{kind:?} {turn} {origin} {within:?} {sign}");
                        for point in &made.mesh.points {
                            assert!(ball.quadric().value(*point) <= 1e-8 * ball.radius);
                        }
                        sum += volume(&made.mesh);
                        cut += 1;
                    }
                    let all = 4.0 * PI / 3.0 * ball.radius * ball.radius * ball.radius;
                    assert!(
                        (sum / all - 1.0).abs() < 1e-2,
                        "{kind:?} {turn} {origin} {within:?}: {sum} of {all}"
                    );
                }
            }
        }
    }
    assert!(cut > 300, "{cut}");
}

#[test]
fn skins_end_at_the_ball_and_leave_its_surface_out() {
    // A cylinder of radius 1/2: 2 pi r times its length between the points where it leaves the ball.
    let made_skin = made(axes([1.0, 1.0, 0.0], -0.25), unit(), false, 1e-4);
    let expected = PI * 2.0 * 0.75_f64.sqrt();
    assert!((area(&made_skin.mesh) / expected - 1.0).abs() < 1e-3, "{}", area(&made_skin.mesh));
    let sheets = made_skin.mesh.vertices.iter().all(|vertex| vertex.anchor.source < super::SHEETS);
    assert!(sheets);
    // Two disks that cross.
    let disks = made(axes([1.0, -1.0, 0.0], 0.0), unit(), false, 1e-4);
    assert!((area(&disks.mesh) / (2.0 * PI) - 1.0).abs() < 1e-3, "{}", area(&disks.mesh));
}

#[test]
fn what_touches_is_made_or_refused() {
    // V. Viviani's cylinder: it touches the ball from inside, and its curve crosses itself there.
    let viviani = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.0), 0.0);
    let shape = ClippedQuadric { quadric: viviani, within: unit(), closed: true };
    let made_body = quadric(&shape, &detail(1e-3)).expect("the ball is a billionth larger");
    check(&shape, &made_body);
    assert_eq!(open_edges(&made_body.mesh), 0);
    assert!((volume(&made_body.mesh) - (2.0 * PI / 3.0 - 8.0 / 9.0)).abs() < 1e-2);
    // A plane that touches the ball cuts nothing off; a ball that touches it from inside is whole.
    let plane = Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::Z, 1.0);
    let beside = ClippedQuadric { quadric: plane, within: unit(), closed: true };
    assert_eq!(quadric(&beside, &detail(1e-3)), Err(TessellateError::NoArea));
    let inner = Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.0), 0.0);
    let made_inner = made(inner, unit(), true, 1e-3);
    assert!((volume(&made_inner.mesh) - PI / 6.0).abs() < 1e-2);
    // An apex on the ball would leave dust.
    let cone = axes([1.0, 1.0, -1.0], 0.0);
    let shape = ClippedQuadric { quadric: cone, within: ball([0.0, 0.0, 1.0], 1.0), closed: true };
    assert_eq!(quadric(&shape, &detail(1e-3)), Err(TessellateError::Tangled));
}

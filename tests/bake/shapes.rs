//! Every kind of shape: closed, of the right genus, and of the area and volume of school.

use core::f64::consts::PI;

use super::{assert_near, bake};

/// A shape whose area and volume are known.
struct Known {
    text: &'static str,
    area: f64,
    volume: f64,
    genus: u64,
    components: u64,
    /// The least radius at which it bends, for how much of its area chords may lose; 0 where all is flat.
    bend: f64,
}

const FLAT: f64 = 0.0;

fn known() -> Vec<Known> {
    let torus = (4.0 * PI * PI * 0.3, 2.0 * PI * PI * 0.09);
    let coil = 3.0 * (4.0 * PI * PI + 0.25_f64).sqrt();
    let shape = |text, area, volume, genus, bend| Known { text, area, volume, genus, components: 1, bend };
    vec![
        shape("[shape.a.box]\nsize = [1, 2, 3]\ncenter = [5, 0, 0]", 22.0, 6.0, 0, FLAT),
        shape("[shape.a.sphere]\nradius = 1\ncenter = [0, 1, 2]", 4.0 * PI, 4.0 * PI / 3.0, 0, 1.0),
        shape("[shape.a.cylinder]\nradius = 0.5\nheight = 2", 2.5 * PI, PI / 2.0, 0, 0.5),
        shape(
            "[shape.a.revolve]\nprofile = { polyline = { points = [[0, 0], [1, 0], [0, 2]] } }",
            PI * (1.0 + 5.0_f64.sqrt()),
            2.0 * PI / 3.0,
            0,
            1.0,
        ),
        shape(
            "[shape.a.revolve]\nprofile = { circle = { radius = 0.3, center = [1, 0] } }",
            torus.0,
            torus.1,
            1,
            0.3,
        ),
        shape(
            "[shape.a.revolve]\nprofile = { circle = { radius = 0.3, center = [1, 0] } }\nangle = 90\nstart = 30",
            torus.0 / 4.0 + 2.0 * PI * 0.09,
            torus.1 / 4.0,
            0,
            0.3,
        ),
        shape(
            "[shape.a.revolve]\nprofile = { arc = { center = [0, 0], radius = 1, from = -90, to = 90 } }\nangle = 120",
            4.0 * PI / 3.0 + PI,
            4.0 * PI / 9.0,
            0,
            1.0,
        ),
        shape(
            "[shape.a.revolve]\nprofile = { polyline = { points = [[1, 0], [2, 0], [2, 1], [1, 1]], closed = true } }",
            2.0 * PI * 3.0 + 2.0 * PI * 3.0,
            3.0 * PI,
            1,
            1.0,
        ),
        shape(
            "[shape.a.extrude]\nheight = 1\nprofile = { polyline = { points = [[-1, -1], [1, -1], [1, 1], [-1, 1]], closed = true } }\n\
             holes = [{ circle = { radius = 0.5 } }]",
            2.0 * (4.0 - PI / 4.0) + 8.0 + PI,
            4.0 - PI / 4.0,
            1,
            0.5,
        ),
        shape(
            "[shape.a.extrude]\nheight = 0.25\ncentered = true\nprofile = { ellipse = { radii = [3, 2] } }\n\
             holes = [{ circle = { radius = 0.5, center = [1, 0] } }, { circle = { radius = 0.5, center = [-1, 0] } }]",
            2.0 * (6.0 * PI - PI / 2.0) + 0.25 * (15.865_439_589_290_59 + 2.0 * PI),
            (6.0 * PI - PI / 2.0) * 0.25,
            2,
            0.5,
        ),
        shape(
            "[shape.a.sweep]\nprofile = { circle = { radius = 0.2 } }\npath = { line = { from = [0, 0, 0], to = [1, 2, 2] } }",
            2.0 * PI * 0.2 * 3.0 + 2.0 * PI * 0.04,
            PI * 0.04 * 3.0,
            0,
            0.2,
        ),
        // Pappus: the section stands across its path everywhere, and its middle lies on the path.
        shape(
            "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { helix = { radius = 1, pitch = 0.5, turns = 3 } }",
            2.0 * PI * 0.1 * coil + 2.0 * PI * 0.01,
            PI * 0.01 * coil,
            0,
            0.1,
        ),
        shape(
            "[shape.a.sweep]\nprofile = { circle = { radius = 0.3 } }\npath = { circle = { radius = 1 } }",
            torus.0,
            torus.1,
            1,
            0.3,
        ),
        // Mitred: the lengths of the four sides, each measured along its middle.
        shape(
            "[shape.a.sweep]\nprofile = { polyline = { points = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], closed = true } }\n\
             path = { polyline = { points = [[-1, -1], [1, -1], [1, 1], [-1, 1]], closed = true } }",
            8.0 * 0.8,
            8.0 * 0.04,
            1,
            FLAT,
        ),
        shape(
            "[shape.a.sweep]\nprofile = { polyline = { points = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], closed = true } }\n\
             path = { polyline = { points = [[0, 0], [1, 0], [1, 1]] } }",
            2.0 * 0.8 + 2.0 * 0.04,
            2.0 * 0.04,
            0,
            FLAT,
        ),
        shape(
            "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\n\
             faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]",
            1.5 + 3.0_f64.sqrt() / 2.0,
            1.0 / 6.0,
            0,
            FLAT,
        ),
        Known {
            text: "[shape.a.array]\nof = { box = { size = [1, 1, 1] } }\ncount = [2, 3, 4]\noffset = [2, 2, 2]",
            area: 24.0 * 6.0,
            volume: 24.0,
            genus: 0,
            components: 24,
            bend: FLAT,
        },
        Known {
            text: "[shape.a.mirror]\nof = { sphere = { radius = 0.5, center = [1, 2, 3] } }\nplane = { normal = [1, 1, 0], point = [-1, 0, 0] }",
            area: 2.0 * PI,
            volume: PI / 3.0,
            genus: 0,
            components: 2,
            bend: 0.5,
        },
        Known {
            text: "[shape.a.mirror]\nof = { sphere = { radius = 0.5, center = [1, 2, 3] } }\nplane = \"x\"\nkeep = false",
            area: PI,
            volume: PI / 6.0,
            genus: 0,
            components: 1,
            bend: 0.5,
        },
        Known {
            text: "[shape.a.group]\nof = [{ box = { size = [1, 1, 1] } }, { cylinder = { radius = 0.5, height = 2, center = [4, 0, 0] } }]",
            area: 6.0 + 2.5 * PI,
            volume: 1.0 + PI / 2.0,
            genus: 0,
            components: 2,
            bend: 0.5,
        },
        Known {
            text: "[shape.a.copy]\nof = { cylinder = { radius = 0.5, height = 2 } }",
            area: 2.5 * PI,
            volume: PI / 2.0,
            genus: 0,
            components: 1,
            bend: 0.5,
        },
    ]
}

#[test]
fn solids_are_closed_and_have_the_area_and_volume_of_school() {
    for known in known() {
        for tolerance in [1e-2, 1e-3] {
            let text = format!("tolerance = {tolerance}\n{}", known.text);
            let baked = bake(&text);
            let shape = baked.only();
            let facts = &shape.facts;
            assert!(facts.closed && facts.manifold, "{text}: {facts:?}");
            assert_eq!((facts.genus, facts.components), (Some(known.genus), known.components), "{text}");
            assert_eq!(
                facts.euler,
                2 * known.components.cast_signed() - 2 * known.genus.cast_signed(),
                "{text}"
            );
            assert_eq!((facts.degenerate_triangles, facts.boundary_edges), (0, 0), "{text}");
            // Two surfaces that are nowhere further apart than the bound enclose volumes that differ by at most
            // a layer of that thickness.
            let rounding = 1e-6;
            let volume = facts.volume.expect("it is closed");
            let layer = known.area * shape.deviation.bound * 1.1;
            assert!((volume - known.volume).abs() <= layer + rounding * known.volume, "{text}: {volume}");
            // A chord of sagitta d on a circle of radius r is shorter than its arc by about the share 2 d / 3 r in
            // each of two directions, and diagonals lean.
            let share = if known.bend > 0.0 { 4.0 * shape.deviation.bound / known.bend } else { 0.0 };
            assert_near(facts.area, known.area, share + rounding);
        }
    }
}

#[test]
fn bounds_hold_what_is_measured_and_keep_the_tolerance() {
    for known in known() {
        for tolerance in [3e-2, 1e-3] {
            let text = format!("tolerance = {tolerance}\n{}", known.text);
            let baked = bake(&text);
            let deviation = baked.only().deviation;
            let measured = deviation.measured.expect("it was asked for");
            assert!(deviation.bound <= tolerance, "{text}: {deviation:?}");
            assert!(measured <= deviation.bound, "{text}: {deviation:?}");
            if known.bend == FLAT {
                assert!(deviation.bound < 1e-6, "{text}: {deviation:?}");
            } else {
                assert!(
                    deviation.bound >= 0.25 * tolerance,
                    "{text} is finer than it was asked for: {deviation:?}"
                );
                assert!(measured >= 0.2 * deviation.bound, "{text}: the bound is loose: {deviation:?}");
            }
            assert!(baked.compiled.warnings.is_empty(), "{text}: {}", baked.compiled.warnings);
        }
    }
}

/// Shapes that are placed keep their tolerance in the document's unit after scaling, and stand where they are put.
#[test]
fn placement_scales_turns_and_moves_in_that_order() {
    let text = "tolerance = 0.001\n[shape.a]\nscale = [2, 1, 1]\nrotate = [0, 0, 90]\nat = [10, 0, 0]\n\
                [shape.a.sphere]\nradius = 1\ncenter = [3, 0, 0]";
    let baked = bake(text);
    let shape = baked.only();
    assert!(shape.deviation.bound <= 0.001 && shape.deviation.bound > 0.0003, "{:?}", shape.deviation);
    let bounds = shape.facts.bounds.expect("it has points");
    for (axis, (low, high)) in [(9.0, 11.0), (4.0, 8.0), (-1.0, 1.0)].into_iter().enumerate() {
        assert!((f64::from(bounds.min[axis]) - low).abs() < 0.001, "{bounds:?}");
        assert!((f64::from(bounds.max[axis]) - high).abs() < 0.001, "{bounds:?}");
    }
    assert_near(shape.facts.volume.expect("it is closed"), 8.0 * PI / 3.0, 0.005);
}

#[test]
fn caps_close_and_their_absence_opens() {
    let profile = "profile = { circle = { radius = 0.3, center = [1, 0] } }\nangle = 90";
    for (text, loops) in [
        (format!("[shape.a.revolve]\n{profile}\ncaps = false"), 2),
        (format!("[shape.a.revolve]\n{profile}"), 0),
        (
            "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { helix = { radius = 1, pitch = 1, turns = 1 } }\ncaps = false"
                .to_owned(),
            2,
        ),
        (
            "[shape.a.extrude]\nheight = 1\ncaps = false\nprofile = { circle = { radius = 1 } }\nholes = [{ circle = { radius = 0.5 } }]"
                .to_owned(),
            4,
        ),
        // An open profile has no inside: its ends stay open.
        (
            "[shape.a.revolve]\nprofile = { line = { from = [1, 0], to = [1, 1] } }\nangle = 90".to_owned(),
            1,
        ),
        ("[shape.a.revolve]\nprofile = { line = { from = [1, 0], to = [1, 1] } }".to_owned(), 2),
        (
            "[shape.a.sweep]\nprofile = { line = { from = [-1, 0], to = [1, 0] } }\npath = { line = { from = [0, 0, 0], to = [0, 0, 5] } }"
                .to_owned(),
            1,
        ),
    ] {
        let facts = &bake(&text).only().facts.clone();
        assert_eq!((facts.boundary_loops, facts.closed), (loops, loops == 0), "{text}");
        assert!(facts.degenerate_triangles == 0 && facts.misoriented_edges == 0 && facts.crowded_edges == 0, "{text}");
    }
}

/// The way a profile runs does not turn a solid inside out.
#[test]
fn solids_look_outward_whichever_way_their_curves_run() {
    for text in [
        "[shape.a.revolve]\nprofile = { reverse = { of = { polyline = { points = [[0, 0], [1, 0], [0, 2]] } } } }",
        "[shape.a.revolve]\nprofile = { reverse = { of = { circle = { radius = 0.3, center = [1, 0] } } } }",
        "[shape.a.extrude]\nheight = 1\nprofile = { reverse = { of = { circle = { radius = 1 } } } }\nholes = [{ circle = { radius = 0.5 } }]",
        "[shape.a.sweep]\nprofile = { reverse = { of = { circle = { radius = 0.1 } } } }\npath = { helix = { radius = 1, pitch = 1, turns = 1 } }",
        "[shape.a]\nscale = [-1, 1, 1]\n[shape.a.sphere]\nradius = 1",
        "[shape.a]\nscale = -2\n[shape.a.extrude]\nheight = 1\nprofile = { circle = { radius = 1 } }",
    ] {
        let baked = bake(text);
        assert!(baked.only().facts.volume.is_some_and(|volume| volume > 0.0), "{text}");
        assert!(baked.glb.mesh(0).greatest_lean() < 45.0, "{text}: normals look inward");
    }
}

#[test]
fn an_imported_cage_is_what_its_file_says() {
    let baked = bake("[shape.bird]\nat = [0, 1, 0]\n[shape.bird.import]\nfile = \"bird.obj\"\nscale = 2");
    let plain = bake("[shape.bird.import]\nfile = \"bird.obj\"");
    let (shape, plain) = (baked.only(), plain.only());
    assert!(shape.facts.closed);
    assert_eq!(shape.facts.triangles, plain.facts.triangles);
    assert_near(shape.facts.area, 4.0 * plain.facts.area, 1e-6);
    assert_near(shape.facts.volume.expect("closed"), 8.0 * plain.facts.volume.expect("closed"), 1e-6);
    assert!(shape.polygons.is_some() && shape.deviation.bound < 1e-6);
}

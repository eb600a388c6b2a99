//! Pictures: what is seen of baked files, by closed forms, by brute force and by the z-buffer.

mod drawing;
mod exact;
mod files;

use glam::DVec3;
use kiln::geometry::number::floor_index;
use kiln::preview::asset;
use kiln::preview::{Camera, Look, Moment, Picture, Projection, Shading, Stage, View, draw_picture};

use crate::bake::bake;

/// The stage of a document.
fn stage(text: &str) -> (asset::Asset, Stage) {
    let baked = bake(text);
    let asset = asset::read(&baked.compiled.bytes).expect("what is baked can be drawn");
    let stage = Stage::new(&asset, &Moment::default()).expect("no clip was asked for");
    (asset, stage)
}

fn view(name: &str) -> View {
    View::NAMED.iter().find(|(known, _)| *known == name).expect("a known view").1
}

fn picture(text: &str, from: &str, look: &Look) -> Picture {
    let (asset, stage) = stage(text);
    draw_picture(&asset, &stage, &Camera::on(&[&stage], view(from), look), look)
}

const CLEAR: [u8; 4] = [0; 4];

fn parallel(size: u32) -> Look {
    Look { size: (size, size), projection: Projection::Orthographic, background: CLEAR, ..Look::default() }
}

/// Share of the picture that is covered.
fn coverage(picture: &Picture) -> f64 {
    let sum: f64 = picture.pixels.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum();
    sum / picture.pixels.len() as f64
}

/// What a picture shows of a body is as large as its shadow in parallel light: a disk of the ball, a square of the box.
#[test]
fn silhouettes_have_the_areas_of_closed_forms() {
    // The camera leaves 6 % free on each side.
    let free = 0.88_f64 * 0.88;
    let ball = coverage(&picture("tolerance = 1e-4\n[shape.a.sphere]\nradius = 1", "corner", &parallel(400)));
    assert!((ball - free * std::f64::consts::PI / 4.0).abs() < 4e-4, "{ball}");
    let cube = coverage(&picture("[shape.a.box]\nsize = [2, 2, 2]", "front", &parallel(400)));
    assert!((cube - free).abs() < 4e-4, "{cube}");
    let slab = coverage(&picture("[shape.a.box]\nsize = [2, 1, 2]", "right", &parallel(400)));
    assert!((slab - free / 2.0).abs() < 4e-4, "{slab}");
}

/// Normals as colors: towards the eye, to the right and up.
#[test]
fn normals_are_those_of_a_ball() {
    let look = Look { shading: Shading::Normals, ..parallel(201) };
    let ball = picture("tolerance = 1e-4\n[shape.a.sphere]\nradius = 1", "front", &look);
    let at = |x: usize, y: usize| {
        // Back from sRGB: the preview writes linear parts of the normal as colors of a screen.
        let part = |byte: u8| {
            let value = f64::from(byte) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                kiln::geometry::number::pow((value + 0.055) / 1.055, 2.4)
            }
        };
        let [r, g, b, _] = ball.pixels[y * 201 + x];
        DVec3::new(part(r), part(g), part(b)) * 2.0 - DVec3::ONE
    };
    let radius = 0.88 * 100.5;
    for (x, y) in [(100, 100), (130, 100), (100, 60), (60, 130), (140, 140)] {
        let (across, up) = ((x as f64 + 0.5 - 100.5) / radius, (100.5 - y as f64 - 0.5) / radius);
        let expected = DVec3::new(across, up, (1.0 - across * across - up * up).sqrt());
        let off = (at(x, y) - expected).length();
        assert!(off < 0.02, "at {x}, {y}: {} instead of {expected}", at(x, y));
    }
}

/// The side that a light falls on is brighter, whatever the shading; a shadow falls on what lies behind.
#[test]
fn light_comes_from_the_upper_left_and_casts_shadows() {
    let grey = |pixel: [u8; 4]| u32::from(pixel[0]) + u32::from(pixel[1]) + u32::from(pixel[2]);
    for shading in [Shading::Standard, Shading::Phong, Shading::Gouraud, Shading::Flat] {
        let look = Look { shading, ..parallel(200) };
        let ball = picture("[shape.a.sphere]\nradius = 1", "front", &look);
        let (bright, dark) = (ball.pixels[60 * 200 + 70], ball.pixels[150 * 200 + 135]);
        assert!(grey(bright) > grey(dark) + 60, "{shading:?}: {bright:?} and {dark:?}");
    }
    // A small plate in front of a wall: beside it, away from the light, the wall is dark.
    let text = "[shape.wall.box]\nsize = [4, 4, 0.1]\n[shape.plate.box]\nsize = [1, 1, 0.1]\n\
                [node.wall]\nshape = \"wall\"\n[node.plate]\nshape = \"plate\"\nat = [0, 0, 1]";
    let lit = picture(text, "front", &parallel(200));
    let unlit = picture(text, "front", &Look { shadows: false, ..parallel(200) });
    // The light comes from (-0.55, 0.8, 0.75): a meter behind, the shadow lies 0.73 m to the right and 1.07 m down.
    let scale = 0.88 * 200.0 / 4.0;
    let at = |x: f64, y: f64| floor_index(100.0 - y * scale) * 200 + floor_index(100.0 + x * scale);
    let (shaded, open) = (at(0.73, -1.2), at(-1.2, 1.2));
    assert!(
        grey(lit.pixels[shaded]) + 60 < grey(unlit.pixels[shaded]),
        "{:?} and {:?}",
        lit.pixels[shaded],
        unlit.pixels[shaded]
    );
    assert_eq!(lit.pixels[open], unlit.pixels[open]);
}

/// The same picture for any number of threads.
#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let text = "[shape.a.torus]\nradius = 1\ntube-radius = 0.4";
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| picture(text, "corner", &Look { size: (300, 200), ..Look::default() }))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(5));
}

/// Half of what lies behind glass shines through.
#[test]
fn glass_lets_through_what_its_opacity_says() {
    let text = "[shape.a]\nmaterial = \"glass\"\n[shape.a.box]\nsize = [2, 2, 2]\n\
                [material.glass]\ncolor = [1, 1, 1, 0.5]\nalpha = \"blend\"";
    let covered = coverage(&picture(text, "front", &parallel(200)));
    // Two walls of a half: three quarters of the light are held back.
    assert!((covered / (0.88 * 0.88) - 0.75).abs() < 0.01, "{covered}");
}

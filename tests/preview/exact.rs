//! Surfaces drawn as they are, by closed forms.

use glam::DVec3;
use kiln::compile::Options;
use kiln::preview::asset;
use kiln::preview::exact::{Exact, Surfaces};
use kiln::preview::{Camera, Look, Moment, Projection, Stage, View, exact_depths};

use super::parallel;
use crate::bake::compile;

/// How far away the surfaces of a document are in each pixel, with the camera, and whether all of it was proved.
fn depths(text: &str, view: View, look: &Look) -> (Vec<f32>, Camera, bool) {
    let options = Options { name: "asset".to_owned(), exact: Some(0.01), ..Options::default() };
    let compiled = compile(text, &options).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let asset = asset::read(&compiled.bytes).expect("what is baked can be drawn");
    let stage = Stage::new(&asset, &Moment::default()).expect("no clip was asked for");
    let surfaces: Vec<Option<Surfaces>> = compiled
        .sources
        .iter()
        .map(|source| {
            let sheets = source.sheets.clone()?;
            Some(Surfaces { sheets, deviation: source.deviation.bound })
        })
        .collect();
    let camera = Camera::on(&[&stage], view, look);
    let exact = Exact::new(&stage, &surfaces);
    assert!(exact.draws(0), "it is drawn as a field");
    let depths = exact_depths(&stage, &exact, &camera, look.size);
    (depths, camera, exact.unproved() == 0)
}

/// What an ellipsoid's nearest point on each line of sight is, in closed form, pixel by pixel.
#[test]
fn depths_are_those_of_an_ellipsoid() {
    let half = DVec3::new(1.5, 0.6, 1.0);
    let text = "[shape.a.quadric]\nxx = \"= 1 / 2.25\"\nyy = \"= 1 / 0.36\"\nzz = 1\nconstant = -1";
    for projection in [Projection::Orthographic, Projection::Perspective] {
        let look = Look { projection, ..parallel(64) };
        let (found, camera, proved) = depths(text, View { azimuth: 33.0, elevation: 21.0 }, &look);
        assert!(proved);
        let mut seen = 0;
        for (number, found) in found.iter().enumerate() {
            let place = glam::DVec2::new((number % 64) as f64 + 0.5, (number / 64) as f64 + 0.5);
            let (start, along) = camera.sight(place);
            let (p, d) = (start / half, along / half);
            let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - 1.0);
            let discriminant = b * b - a * c;
            if discriminant.abs() < 1e-9 {
                continue;
            }
            if discriminant < 0.0 {
                assert!(found.is_infinite(), "a line of sight misses it at {place}, and sees {found}");
                continue;
            }
            seen += 1;
            let expected = camera.depth(start + along * ((-b - discriminant.sqrt()) / a));
            // Depths are kept in single precision.
            let off = (f64::from(*found) - expected).abs();
            assert!(off <= 1e-6 * expected.abs().max(1.0), "{found} instead of {expected} at {place}");
        }
        assert!(seen > 800, "{seen}");
    }
}

/// Solids are seen as deep as their bodies say: a plate with a round hole.
#[test]
fn depths_of_solids_are_those_of_their_bodies() {
    let text = "[shape.plate.box]\nsize = [2, 2, 0.5]\n[shape.bore]\nrotate = [90, 0, 0]\n\
                [shape.bore.cylinder]\nradius = 0.6\nheight = 3\n\
                [shape.a.difference]\nof = [\"plate\", \"bore\"]";
    let (found, camera, _) = depths(text, View::NAMED[0].1, &parallel(80));
    for (number, found) in found.iter().enumerate() {
        let place = glam::DVec2::new((number % 80) as f64 + 0.5, (number / 80) as f64 + 0.5);
        let (start, _) = camera.sight(place);
        let (side, hole) = (start.x.abs().max(start.y.abs()), start.truncate().length());
        if (side - 1.0).abs() < 1e-6 || (hole - 0.6).abs() < 1e-6 {
            continue;
        }
        if side > 1.0 || hole < 0.6 {
            assert!(found.is_infinite(), "{found} at {start}");
        } else {
            let expected = camera.depth(start.with_z(0.25));
            assert!((f64::from(*found) - expected).abs() < 1e-6, "{found} instead of {expected} at {start}");
        }
    }
}

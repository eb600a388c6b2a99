//! Textures laid from where a surface is: held against the maps of the six sides, of the cylinder and of the globe.

use kiln::geometry::number::{cos_degrees, sin_degrees};

use super::{Baked, bake};

/// The three corners of each triangle: place, normal, texture coordinates.
type Corner = ([f64; 3], [f64; 3], [f64; 2]);

fn triangles(baked: &Baked) -> Vec<[Corner; 3]> {
    let mesh = baked.glb.mesh(0);
    let uvs = mesh.uvs.as_ref().expect("they are asked for");
    let corner = |index: usize| (mesh.positions[index], mesh.normals[index], uvs[index]);
    mesh.triangles.iter().map(|corners| corners.map(corner)).collect()
}

fn cross([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 3] {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

fn across(triangle: &[Corner; 3]) -> [f64; 3] {
    let side = |to: usize| [0, 1, 2].map(|axis| triangle[to].0[axis] - triangle[0].0[axis]);
    cross(side(1), side(2))
}

fn length(of: [f64; 3]) -> f64 {
    of.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Twice the area that a triangle has of a picture whose up is v falling; more than 0 where it is not mirrored.
fn of_picture(triangle: &[Corner; 3]) -> f64 {
    let side = |to: usize| [0, 1].map(|axis| triangle[to].2[axis] - triangle[0].2[axis]);
    let ([a, b], [c, d]) = (side(1), side(2));
    -(a * d - b * c)
}

fn mapped(shape: &str, mapping: &str) -> Baked {
    bake(&format!("tolerance = 0.001\n[shape.s]\nuv = \"always\"\nuv-mapping = \"{mapping}\"\n{shape}"))
}

/// Every side of a box shows a picture in its true size, upright and not mirrored.
#[test]
fn six_sides_show_pictures_in_their_true_size() {
    let baked = mapped("[shape.s.box]\nsize = [2, 1, 3]\n", "box");
    let all = triangles(&baked);
    assert_eq!(all.len(), 12);
    for triangle in &all {
        let area = length(across(triangle));
        assert!((of_picture(triangle) - area).abs() < 1e-6, "{triangle:?}");
        for (place, normal, uv) in triangle {
            if normal[1].abs() < 0.5 {
                assert!((uv[1] + place[1]).abs() < 1e-6, "upright: {place:?} at {uv:?}");
            } else {
                assert!((uv[0] - place[0]).abs() < 1e-6 && (uv[1] - normal[1] * place[2]).abs() < 1e-6);
            }
        }
    }
    let twice = mapped("uv-scale = [2, 3]\n[shape.s.box]\nsize = [2, 1, 3]\n", "box");
    for (one, other) in all.iter().zip(triangles(&twice)) {
        for (one, other) in one.iter().zip(other) {
            assert!((2.0 * one.2[0] - other.2[0]).abs() < 1e-6 && (3.0 * one.2[1] - other.2[1]).abs() < 1e-6);
        }
    }
}

/// Whichever side a triangle of a round body is laid from, the picture lies on it as seen from there.
#[test]
fn round_bodies_are_laid_from_the_side_that_they_face() {
    let baked = mapped("[shape.s.implicit]\nfield = \"f\"\n[field.f.sphere]\nradius = 0.5\n", "box");
    for triangle in triangles(&baked) {
        let facing = across(&triangle);
        let most = facing.iter().map(|part| part.abs()).fold(0.0, f64::max);
        // Seen from that side a triangle is as large as its share along the axis.
        assert!((of_picture(&triangle) - most).abs() < 1e-7 + 1e-4 * most, "{triangle:?}");
    }
}

/// A ball wears a map of the world once, and each vertex stands where its coordinates say.
#[test]
fn a_globe_is_covered_once() {
    let baked = mapped("[shape.s.sphere]\nradius = 0.5\n", "sphere");
    let mut covered = 0.0;
    for triangle in triangles(&baked) {
        let picture = of_picture(&triangle);
        assert!(picture > -1e-9, "{triangle:?}");
        covered += picture / 2.0;
        for (place, _, [u, v]) in triangle {
            let (east, north) = (360.0 * (u - 0.5), 180.0 * (0.5 - v));
            let round = cos_degrees(north);
            let wanted = [round * sin_degrees(east), sin_degrees(north), round * cos_degrees(east)];
            let off = [0, 1, 2].map(|axis| 0.5 * wanted[axis] - place[axis]);
            assert!(length(off) < 1e-5, "{place:?} at {u}, {v}");
        }
        let us = triangle.map(|corner| corner.2[0]);
        let span = us.iter().fold(0.0_f64, |span, u| span.max((u - us[0]).abs()));
        assert!(span < 0.5, "no triangle goes around the world: {us:?}");
    }
    // Half of the picture's first and last rows is lost at the poles.
    assert!(covered > 0.9 && covered < 1.0 + 1e-6, "{covered}");
}

/// A label goes once around a can, and its ends are laid from above and below.
#[test]
fn a_label_goes_once_around() {
    let baked = mapped("[shape.s.cylinder]\nradius = 0.5\nheight = 2\n", "cylinder");
    let (mut around, mut ends) = (0.0, 0.0);
    for triangle in triangles(&baked) {
        let picture = of_picture(&triangle);
        assert!(picture > 0.0, "{triangle:?}");
        if across(&triangle)[1].abs() > 0.9 * length(across(&triangle)) {
            ends += picture / 2.0;
            assert!((picture - length(across(&triangle))).abs() < 1e-6);
        } else {
            around += picture / 2.0;
            assert!(triangle.iter().all(|(place, _, uv)| (uv[1] + place[1]).abs() < 1e-6));
        }
    }
    assert!((around - 2.0).abs() < 1e-6, "one turn, two units high: {around}");
    assert!((ends - 2.0 * 0.25 * std::f64::consts::PI).abs() < 0.01, "{ends}");
}

/// Only vertices become more: points and triangles stay, in solids and on coarser levels.
#[test]
fn the_surface_stays_what_it_is() {
    let solid = "[shape.s.difference]\nof = [\"block\", \"hole\"]\n[shape.block.box]\nsize = [1, 1, 1]\n[shape.hole.sphere]\nradius = 0.6\n";
    let [plain, laid] =
        ["surface", "box"].map(|mapping| mapped(&format!("{solid}[lod]\nlevels = 3\n"), mapping));
    for (name, shape) in &plain.report().shapes {
        let other = &laid.report().shapes[name];
        assert_eq!(
            (shape.facts.triangles, shape.facts.closed),
            (other.facts.triangles, other.facts.closed),
            "{name}"
        );
        assert_eq!((shape.facts.euler, shape.facts.components), (other.facts.euler, other.facts.components));
    }
    assert_eq!(laid.report().lods[0].len(), 3);
}

//! Vertices, normals and texture coordinates.

use kiln::compile::Options;

use super::{bake, bake_with};

#[test]
fn flat_smooth_and_automatic_shading() {
    let cylinder = |options: &str| {
        format!("[shape.a]\nsegments = [16, 3]\n{options}\n[shape.a.cylinder]\nradius = 1\nheight = 2")
    };
    let auto = bake(&cylinder(""));
    let flat = bake(&cylinder("smoothing = \"flat\""));
    let smooth = bake(&cylinder("smoothing = \"smooth\""));
    // Two ends with a middle each, and the wall apart from both.
    assert_eq!(auto.only().facts.vertices, 2 * (16 + 1) + 2 * 16);
    assert_eq!(flat.only().facts.vertices, 3 * flat.only().facts.triangles);
    assert_eq!(smooth.only().facts.vertices, smooth.only().facts.points);
    assert!(flat.glb.mesh(0).greatest_lean() < 0.1);
    let lean = auto.glb.mesh(0).greatest_lean();
    assert!((lean - 180.0 / 16.0).abs() < 0.1, "half a step: {lean}");
    assert!(smooth.glb.mesh(0).greatest_lean() > 30.0);
    for baked in [&auto, &flat, &smooth] {
        assert!(baked.only().facts.closed && baked.only().facts.points == 34);
    }
}

#[test]
fn edges_are_hard_beyond_the_crease_angle() {
    // A roof of two faces that meet at 40 degrees.
    let roof = |options: &str| {
        format!(
            "[shape.a]\n{options}\n[shape.a.mesh]\npoints = [[-1, 0, 0], [-1, 0, 1], [0, 0.36397, 0], [0, 0.36397, 1], [1, 0, 0], [1, 0, 1]]\n\
             faces = [[0, 1, 3, 2], [2, 3, 5, 4]]"
        )
    };
    for (options, vertices) in [
        ("", 8),
        ("crease-angle = 39", 8),
        ("crease-angle = 41", 6),
        ("crease-angle = 41\nsmoothing = \"flat\"", 8),
        ("smoothing = \"smooth\"", 6),
    ] {
        let facts = &bake(&roof(options)).only().facts.clone();
        assert!(facts.vertices == vertices || options.contains("flat"), "{options}: {}", facts.vertices);
        assert!(!options.contains("flat") || facts.vertices >= vertices, "{options}: {}", facts.vertices);
    }
    // The same on a profile: its corner turns by 40 degrees.
    let cone = |angle: u32| {
        format!(
            "[shape.a]\nsegments = [8, 2]\ncrease-angle = {angle}\n[shape.a.revolve]\nprofile = {{ polyline = {{ points = [[1, 0], [1, 1], [0.35721, 1.76604]] }} }}"
        )
    };
    assert_eq!(bake(&cone(39)).only().facts.vertices, 4 * 8);
    assert_eq!(bake(&cone(41)).only().facts.vertices, 3 * 8);
}

#[test]
fn smoothing_groups_decide_where_they_are_written() {
    let strip = |groups: &str| {
        format!(
            "[shape.a.mesh]\npoints = [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1], [2, 1, 0], [2, 1, 1]]\n\
             faces = [[0, 1, 3, 2], [2, 3, 5, 4], [4, 5, 7, 6]]\nsmoothing-groups = {groups}"
        )
    };
    for (groups, vertices) in
        [("[1, 1, 1]", 8), ("[1, 1, 2]", 10), ("[1, 2, 3]", 12), ("[0, 0, 0]", 12), ("[3, 3, 0]", 10)]
    {
        assert_eq!(bake(&strip(groups)).only().facts.vertices, vertices, "{groups}");
    }
}

#[test]
fn texture_coordinates_are_written_when_asked_for() {
    for (options, textured, written) in [
        ("", false, false),
        ("uv = \"auto\"", true, true),
        ("uv = \"always\"", false, true),
        ("uv = \"none\"", false, false),
    ] {
        let material = if textured { "color-texture = \"label.png\"" } else { "" };
        let text = format!(
            "[material.x]\n{material}\n[shape.a]\nmaterial = \"x\"\n{options}\n[shape.a.sphere]\nradius = 1"
        );
        let baked = bake(&text);
        assert_eq!(baked.glb.mesh(0).uvs.is_some(), written, "{text}");
        // Without texture coordinates nothing is split: a sphere is smooth everywhere.
        assert_eq!(baked.only().facts.vertices == baked.only().facts.points, !written, "{text}");
    }
}

#[test]
fn texture_coordinates_cover_the_square_in_proportion_to_length() {
    let text = |scale: &str| {
        format!(
            "[shape.a]\nuv = \"always\"\nsegments = [8, 6]\n{scale}\n[shape.a.revolve]\nprofile = {{ polyline = {{ points = [[1, 0], [1, 1], [1, 4]] }} }}"
        )
    };
    let baked = bake(&text(""));
    let mesh = baked.glb.mesh(0);
    let uvs = mesh.uvs.as_ref().expect("they were asked for");
    for (position, [u, v]) in mesh.positions.iter().zip(uvs) {
        // v falls from the top, as images do; the wall is four metres high.
        assert!((v - (1.0 - position[1] / 4.0)).abs() < 1e-6, "{position:?} {v}");
        let angle = kiln::geometry::number::atan2(-position[2], position[0]).to_degrees().rem_euclid(360.0);
        let turned = (u * 360.0 - angle).abs();
        assert!(turned < 1e-3 || (turned - 360.0).abs() < 1e-3, "{position:?} {u}");
    }
    let scaled = bake(&text("uv-scale = [4, 2]")).glb.mesh(0).uvs.expect("they were asked for");
    for (plain, scaled) in uvs.iter().zip(&scaled) {
        assert!((scaled[0] - 4.0 * plain[0]).abs() < 1e-6 && (scaled[1] - 2.0 * plain[1]).abs() < 1e-6);
    }
}

/// 65535 restarts a primitive in 16 bits, so 65535 vertices are the most that they can count.
#[test]
fn indices_take_two_bytes_up_to_65535_vertices() {
    // A strip of n + 1 by 2 points.
    let strip = |vertices: u32| {
        format!(
            "[shape.a]\nsegments = [1, {}]\n[shape.a.sweep]\nprofile = {{ line = {{ from = [0, 0], to = [1, 0] }} }}\n\
             path = {{ line = {{ from = [0, 0, 0], to = [0, 0, 9] }} }}",
            vertices / 2 - 1
        )
    };
    let grid = |count: &str| {
        format!(
            "[shape.a]\nsegments = {count}\n[shape.a.sweep]\nprofile = {{ line = {{ from = [0, 0], to = [1, 0] }} }}\n\
                 path = {{ line = {{ from = [0, 0, 0], to = [0, 0, 9] }} }}"
        )
    };
    for (text, vertices, component) in [
        (strip(65_534), 65_534, 5123),
        // 65535 = 257 * 255
        (grid("[256, 254]"), 65_535, 5123),
        (strip(65_536), 65_536, 5125),
    ] {
        let baked = bake_with(&text, &Options::default());
        assert_eq!(baked.only().facts.vertices, vertices);
        let accessor = baked.glb.list("meshes")[0]["primitives"][0]["indices"].as_u64().expect("indices");
        let accessor = &baked.glb.list("accessors")[usize::try_from(accessor).expect("small")];
        assert_eq!(accessor["componentType"], component);
    }
}

/// Normals of smooth surfaces are those of the surface, not of the triangles.
#[test]
fn normals_are_analytic() {
    let baked = bake("tolerance = 0.01\n[shape.a.sphere]\nradius = 2");
    let mesh = baked.glb.mesh(0);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        for axis in 0..3 {
            assert!((normal[axis] - position[axis] / 2.0).abs() < 1e-6, "{position:?} {normal:?}");
        }
    }
    // A path that turns by a third of its segment's parameters: hard edges stand where they are written.
    let text = "[shape.a]\nsegments = [4, 3]\n[shape.a.revolve]\n\
                profile = { path = { start = [1, 0], segments = [{ arc = { center = [2, 0], angle = 90 } }, { line = [[3, -1], [3, 1], [2, 1]] }] } }";
    assert!(bake(text).glb.mesh(0).greatest_lean() < 60.0, "a normal of the wrong side stands at a corner");
}

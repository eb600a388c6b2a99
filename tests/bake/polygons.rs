//! Flat faces with holes: written out as faces, as loops, or inside curves.

use core::f64::consts::PI;

use glam::DVec2;

use super::{assert_near, bake};

#[test]
fn a_face_with_a_hole_through_a_block_closes_it() {
    let block = "[shape.a.mesh]
points = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [0, 0, 2], [4, 0, 2], [4, 4, 2], [0, 4, 2],
          [1, 1, 0], [3, 1, 0], [3, 3, 0], [1, 3, 0], [1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
faces = [[[3, 2, 1, 0], [8, 9, 10, 11]], [[4, 5, 6, 7], [15, 14, 13, 12]],
         [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7],
         [12, 13, 9, 8], [13, 14, 10, 9], [14, 15, 11, 10], [15, 12, 8, 11]]";
    let baked = bake(block);
    let shape = baked.only();
    assert!(shape.facts.closed && shape.facts.manifold);
    assert_eq!((shape.facts.genus, shape.facts.triangles), (Some(1), 2 * 8 + 8 * 2));
    assert_near(shape.facts.volume.expect("closed"), 24.0, 1e-6);
    let polygons = shape.polygons.expect("it is made of polygons");
    assert_eq!((polygons.vertices, polygons.edges, polygons.faces, polygons.holes), (16, 24, 10, 2));
    assert!(polygons.simple && !polygons.convex_faces);
    assert!(baked.compiled.warnings.is_empty(), "{}", baked.compiled.warnings);
}

#[test]
fn loops_are_sorted_by_the_way_they_turn() {
    // An island in a lake on an island, and another island.
    let baked = bake(
        "[shape.a]\nuv = \"always\"\n[shape.a.polygon]\nloops = [
  [[0, 0], [8, 0], [8, 8], [0, 8]],
  [[1, 1], [1, 7], [7, 7], [7, 1]],
  [[2, 2], [6, 2], [6, 6], [2, 6]],
  [[9, 0], [10, 0], [10, 1], [9, 1]],
]",
    );
    let shape = baked.only();
    assert_near(shape.facts.area, 64.0 - 36.0 + 16.0 + 1.0, 1e-6);
    assert_eq!(
        (shape.facts.components, shape.facts.triangles, shape.facts.boundary_loops),
        (3, 8 + 2 + 2, 4)
    );
    let polygons = shape.polygons.expect("it is made of polygons");
    assert_eq!((polygons.faces, polygons.holes), (3, 1));
    let mesh = baked.glb.mesh(0);
    for (position, uv) in mesh.positions.iter().zip(mesh.uvs.as_ref().expect("asked for")) {
        assert!((uv[0] - position[0] / 10.0).abs() < 1e-6 && (uv[1] - 1.0 + position[1] / 8.0).abs() < 1e-6);
    }
    assert!(mesh.triangles.iter().all(|triangle| mesh.across(*triangle)[2] > 0.0), "all look to +z");
}

#[test]
fn sheets_have_the_area_of_their_curves() {
    for tolerance in [1e-2, 1e-4] {
        let baked = bake(&format!(
            "tolerance = {tolerance}\n[shape.a.sheet]\nprofile = {{ ellipse = {{ radii = [3, 2] }} }}\n\
             holes = [{{ circle = {{ radius = 0.5, center = [1, 0] }} }}, {{ circle = {{ radius = 0.5, center = [-1, 0] }} }}]"
        ));
        let shape = baked.only();
        let area = 6.0 * PI - PI / 2.0;
        // Each chord takes off at most its length times the bound, of the outline and the holes.
        assert!((shape.facts.area - area).abs() <= 23.0 * shape.deviation.bound, "{}", shape.facts.area);
        assert!(shape.deviation.bound <= tolerance);
        assert_eq!((shape.facts.boundary_loops, shape.facts.euler), (3, -1));
    }
}

/// The polygon sets of the publisher through documents. Two corners that are one place in single precision take the
/// triangles between them away; where there are none the count is the publisher's, and the area is his but where the
/// document is told that its outline folds.
#[test]
fn polygon_sets_bake_with_their_counts_and_areas() {
    let Some(folder) = crate::import::cases(50, "polygon sets") else { return };
    let corpus = crate::import::json_of(&folder.join("csg/polygon_corpus.json.gz"));
    let (mut refused, mut silent, mut counted) = (Vec::new(), 0, 0);
    for entry in corpus["entries"].as_array().expect("a list") {
        let name = entry["name"].as_str().expect("a name");
        let loops = crate::import::loops_of(entry);
        let options = kiln::compile::Options { name: "asset".to_owned(), ..Default::default() };
        let text = format!("[shape.a.polygon]\nloops = {}", entry["polygons"]);
        let compiled = match super::compile(&text, &options) {
            Ok(compiled) => compiled,
            Err(found) => {
                refused.push((name.to_owned(), found.iter().map(|one| one.code.text()).collect::<Vec<_>>()));
                continue;
            }
        };
        let facts = &compiled.report.expect("a report was asked for").shapes[0].facts;
        let expected = entry["triangles"].as_u64().expect("a number");
        let distinct = all_distinct(&loops);
        assert!(facts.triangles <= expected, "{name}: {} of {expected}", facts.triangles);
        assert!(!distinct || facts.triangles == expected, "{name}: {} of {expected}", facts.triangles);
        counted += usize::from(distinct);
        let area = entry["signed_area"].as_f64().expect("a number");
        let slack = rounded_area(&loops);
        assert!(facts.area >= area - slack, "{name}: {} of {area}", facts.area);
        let told = compiled.warnings.iter().any(|one| ["K0831", "K0832"].contains(&one.code.text()));
        assert!(told || facts.area <= area + slack, "{name}: {} of {area}", facts.area);
        silent += usize::from(!told);
    }
    // One reaches beyond single precision; of the other nothing is left there.
    let known = [("Looping1".to_owned(), vec!["K0204", "K0204"]), ("Degenerate3".to_owned(), vec!["K0804"])];
    assert_eq!(refused, known);
    assert!(silent >= 30 && counted >= 20, "{silent} without a word, {counted} of distinct corners");
}

/// Whether no two corners are one place in single precision.
fn all_distinct(loops: &[Vec<DVec2>]) -> bool {
    let mut places: Vec<[u32; 2]> =
        loops.concat().iter().map(|corner| (corner.as_vec2() + 0.0).to_array().map(f32::to_bits)).collect();
    places.sort_unstable();
    places.windows(2).all(|pair| pair[0] != pair[1])
}

/// What an area can change by where every corner moves by half a unit in the last place of single precision.
fn rounded_area(loops: &[Vec<DVec2>]) -> f64 {
    let reach = loops.concat().iter().fold(0.0, |reach, corner| f64::max(reach, corner.abs().max_element()));
    let around = |corners: &Vec<DVec2>| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a.distance(*b)).sum::<f64>()
    };
    reach * f64::from(f32::EPSILON) * loops.iter().map(around).sum::<f64>()
}

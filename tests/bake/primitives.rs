//! Shapes of elementary geometry: counts, areas, volumes and angles of closed forms, at every limit of their measures.

use core::f64::consts::PI;

use glam::DVec3;

use super::{Baked, assert_near, bake};

/// Bakes one shape within a tolerance, closed and of one piece; its area and volume lie within what the tolerance
/// allows of those expected. `bend` is the least radius at which it bends; 0 where it is flat.
#[track_caller]
fn check(kind: &str, (area, volume): (f64, f64), genus: u64, bend: f64) -> Baked {
    let text = format!("tolerance = 0.001\n[shape.a.{kind}");
    let baked = bake(&text);
    let shape = baked.only();
    let facts = &shape.facts;
    assert!(facts.closed && facts.manifold && facts.components == 1, "{text}: {facts:?}");
    assert_eq!((facts.genus, facts.degenerate_triangles), (Some(genus), 0), "{text}");
    assert!(shape.deviation.bound <= 0.001, "{text}: {:?}", shape.deviation);
    assert!(shape.deviation.measured.is_some_and(|measured| measured <= shape.deviation.bound), "{text}");
    let layer = area * shape.deviation.bound * 1.1;
    let found = facts.volume.expect("it is closed");
    assert!((found - volume).abs() <= layer + 1e-6 * volume, "{text}: {found} instead of {volume}");
    let share = if bend > 0.0 { 4.0 * shape.deviation.bound / bend } else { 0.0 };
    assert_near(facts.area, area, share + 1e-6);
    assert!(baked.compiled.warnings.is_empty(), "{text}: {}", baked.compiled.warnings);
    baked
}

#[test]
fn cones_end_in_tips_of_many_normals() {
    let baked = check(
        "cone]\nradius = 1\nheight = 2\ncenter = [0, 5, 0]",
        (PI * (1.0 + 5.0_f64.sqrt()), 2.0 * PI / 3.0),
        0,
        1.0,
    );
    // Each triangle at the tip has a normal along its own middle: none is off by more than half a step.
    assert!(baked.glb.mesh(0).greatest_lean() < 5.0, "{}", baked.glb.mesh(0).greatest_lean());
    let bounds = baked.only().facts.bounds.expect("it has points");
    assert_eq!((bounds.min[1], bounds.max[1]), (4.0, 6.0));
    check(
        "cone]\nradius = 0\ntop-radius = 1\nheight = 2",
        (PI * (1.0 + 5.0_f64.sqrt()), 2.0 * PI / 3.0),
        0,
        1.0,
    );
    let slant = (0.25 + 4.0_f64).sqrt();
    check(
        "cone]\nradius = 1\ntop-radius = 0.5\nheight = 2",
        (PI * (1.5 * slant + 1.25), PI * 2.0 / 3.0 * 1.75),
        0,
        0.5,
    );
    check("cone]\nradius = 1\ntop-radius = 1\nheight = 2", (6.0 * PI, 2.0 * PI), 0, 1.0);
}

#[test]
fn capsules_are_smooth_and_end_in_the_ball() {
    let baked = check("capsule]\nradius = 1\nheight = 4", (8.0 * PI, 10.0 * PI / 3.0), 0, 1.0);
    // Smooth all over: a vertex for each point.
    assert_eq!(baked.only().facts.vertices, baked.only().facts.points);
    check("capsule]\nradius = 1\nheight = 2", (4.0 * PI, 4.0 * PI / 3.0), 0, 1.0);
    check("capsule]\nradius = 0.1\nheight = \"= 0.1 + 0.1\"", (0.04 * PI, 0.004 * PI / 3.0), 0, 0.1);
}

#[test]
fn rings_and_pipes_have_a_hole() {
    check("torus]\nradius = 3\ntube-radius = 1", (12.0 * PI * PI, 6.0 * PI * PI), 1, 1.0);
    check(
        "torus]\nradius = 1\ntube-radius = 0.999",
        (4.0 * PI * PI * 0.999, 2.0 * PI * PI * 0.998_001),
        1,
        0.9,
    );
    check(
        "tube]\nradius = 1\ninner-radius = 0.75\nheight = 2",
        (2.0 * PI * 1.75 * 2.0 + 2.0 * PI * 0.4375, PI * 0.4375 * 2.0),
        1,
        0.75,
    );
}

/// J. Steiner's formula for the body at a distance around a box, down to the limits where its sides vanish.
#[test]
fn rounded_boxes_are_the_bodies_of_steiner() {
    for (size, radius) in [
        ([3.0, 2.0, 1.0], 0.25),
        ([3.0, 2.0, 1.0], 0.5),
        ([1.0, 3.0, 1.0], 0.5),
        ([1.0, 1.0, 1.0], 0.5),
        ([0.3, 0.3, 0.7], 0.15),
    ] {
        let [x, y, z] = size.map(|side: f64| side - 2.0 * radius);
        let (faces, edges) = (x * y + y * z + z * x, x + y + z);
        let area = 2.0 * faces + 2.0 * PI * radius * edges + 4.0 * PI * radius * radius;
        let volume = x * y * z
            + 2.0 * radius * faces
            + PI * radius * radius * edges
            + 4.0 / 3.0 * PI * radius * radius * radius;
        let baked = check(
            &format!("box]\nsize = {size:?}\nradius = {radius}\ncenter = [1, 2, 3]"),
            (area, volume),
            0,
            radius,
        );
        assert_eq!(baked.only().facts.vertices, baked.only().facts.points, "smooth all over");
        let bounds = baked.only().facts.bounds.expect("it has points");
        for (axis, side) in size.into_iter().enumerate() {
            assert!((f64::from(bounds.max[axis] - bounds.min[axis]) - side).abs() < 1e-6, "{bounds:?}");
        }
    }
    // Radius 0 is the plain box.
    let plain = bake("[shape.a.box]\nsize = [1, 2, 3]\nradius = 0");
    assert_eq!((plain.only().facts.triangles, plain.only().facts.vertices), (12, 24));
}

#[test]
fn textures_of_rounded_boxes_cover_each_side() {
    let baked = bake("[shape.a]\nuv = \"always\"\n[shape.a.box]\nsize = [3, 2, 1]\nradius = 0.2");
    let mesh = baked.glb.mesh(0);
    let uvs = mesh.uvs.as_ref().expect("asked for");
    for axis in 0..2 {
        let all = || uvs.iter().map(|uv| uv[axis]);
        assert_eq!((all().fold(1.0, f64::min), all().fold(0.0, f64::max)), (0.0, 1.0));
    }
    // On the flat middle of the front, a texel is as wide as it is high within the ratio of the unrolled sides.
    let arc = 0.2 * PI / 4.0;
    for (position, uv) in mesh.positions.iter().zip(uvs) {
        let flat = position[2] > 0.499_999 && position[0].abs() < 1.299 && position[1].abs() < 0.799;
        let [u, v] = [0, 1].map(|axis| position[axis] / (2.0 * ([1.3, 0.8][axis] + arc)));
        assert!(
            !flat || ((uv[0] - 0.5 - u).abs() < 1e-6 && (0.5 - uv[1] - v).abs() < 1e-6),
            "{position:?} {uv:?}"
        );
    }
}

#[test]
fn sheets_are_open_and_exact() {
    let plane = bake("[shape.a]\nsegments = [4, 3]\n[shape.a.plane]\nsize = [2, 3]\ncenter = [0, 1, 0]");
    let facts = &plane.only().facts;
    assert_eq!((facts.triangles, facts.points, facts.boundary_loops), (24, 20, 1));
    assert_near(facts.area, 6.0, 1e-7);
    assert_eq!(plane.glb.mesh(0).across(plane.glb.mesh(0).triangles[0])[1].signum(), 1.0, "it looks up");
    assert_eq!(bake("[shape.a.plane]\nsize = [2, 3]").only().facts.triangles, 2);

    let ring = bake("tolerance = 1e-4\n[shape.a.disk]\nradius = 2\ninner-radius = 1\nangle = 90\nstart = 45");
    assert_near(ring.only().facts.area, 0.75 * PI, 1e-3);
    assert_eq!((ring.only().facts.boundary_loops, ring.only().facts.euler), (1, 1));
    let disk = bake("tolerance = 1e-4\n[shape.a.disk]\nradius = 2");
    assert_near(disk.only().facts.area, 4.0 * PI, 1e-3);
    assert!(disk.glb.mesh(0).across(disk.glb.mesh(0).triangles[0])[1] > 0.0, "it looks up");
}

/// Corners, edges, faces, corners of a face; area and volume for edge 1; angle between neighbouring faces. Source:
/// H. S. M. Coxeter, Regular Polytopes, 3rd edition, 1973, table I.
#[test]
fn platonic_solids_are_those_of_the_table() {
    let five = 5.0_f64.sqrt();
    for (solid, counts, area, volume, dihedral) in [
        ("tetrahedron", [4, 6, 4, 3], 3.0_f64.sqrt(), 2.0_f64.sqrt() / 12.0, 70.528_779_365_509_31),
        ("cube", [8, 12, 6, 4], 6.0, 1.0, 90.0),
        ("octahedron", [6, 12, 8, 3], 2.0 * 3.0_f64.sqrt(), 2.0_f64.sqrt() / 3.0, 109.471_220_634_490_69),
        (
            "dodecahedron",
            [20, 30, 12, 5],
            3.0 * (25.0 + 10.0 * five).sqrt(),
            (15.0 + 7.0 * five) / 4.0,
            116.565_051_177_077_99,
        ),
        (
            "icosahedron",
            [12, 30, 20, 3],
            5.0 * 3.0_f64.sqrt(),
            5.0 * (3.0 + five) / 12.0,
            138.189_685_104_221_4,
        ),
    ] {
        let kind = format!("polyhedron]\nsolid = \"{solid}\"\nedge = 1\ncenter = [0.5, 0, 0]");
        let baked = check(&kind, (area, volume), 0, 0.0);
        let polygons = baked.only().polygons.expect("it is made of polygons");
        let found = [polygons.vertices, polygons.edges, polygons.faces, polygons.most_corners];
        assert_eq!(found, counts, "{solid}");
        assert!(polygons.planar && polygons.convex_faces && polygons.simple);
        for angle in dihedral_angles(&baked) {
            assert!((angle - dihedral).abs() < 1e-4, "{solid}: {angle} instead of {dihedral}");
        }
    }
}

/// Angles inside the solid between triangles of different faces that share an edge, in degrees.
fn dihedral_angles(baked: &Baked) -> Vec<f64> {
    let mesh = baked.glb.mesh(0);
    let place = |corner: usize| DVec3::from_array(mesh.positions[corner]);
    let normal = |t: &[usize; 3]| DVec3::from_array(mesh.across(*t)).normalize();
    let edges = |t: &[usize; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|edge| edge.map(place));
    let mut angles = Vec::new();
    for one in &mesh.triangles {
        for other in &mesh.triangles {
            let shared = edges(one).iter().any(|[a, b]| edges(other).contains(&[*b, *a]));
            let cos = normal(one).dot(normal(other));
            if shared && cos < 0.999 {
                angles.push(180.0 - kiln::geometry::number::acos(cos.clamp(-1.0, 1.0)).to_degrees());
            }
        }
    }
    assert!(angles.len() >= 12);
    angles
}

#[test]
fn polyhedra_stand_on_what_they_are_told_to() {
    for (pose, lowest) in
        [("face", -0.5), ("vertex", -(0.75_f64.sqrt())), ("edge", -(0.5_f64.sqrt())), ("axes", -0.5)]
    {
        let baked =
            bake(&format!("[shape.a.polyhedron]\nsolid = \"cube\"\ninradius = 0.5\npose = \"{pose}\""));
        let bounds = baked.only().facts.bounds.expect("it has points");
        assert!((f64::from(bounds.min[1]) - lowest).abs() < 1e-6, "{pose}: {bounds:?}");
    }
}

#[test]
fn geodesic_balls_keep_the_tolerance_with_fewer_triangles_than_turned_ones() {
    for tolerance in [3e-3, 3e-4] {
        let triangles = |kind: &str| {
            let baked = bake(&format!("tolerance = {tolerance}\n[shape.a.{kind}]\nradius = 1"));
            let shape = baked.only();
            assert!(shape.facts.closed && shape.deviation.bound <= tolerance, "{kind} {tolerance}");
            assert!(shape.deviation.measured.is_some_and(|found| found > 0.5 * shape.deviation.bound));
            assert_near(shape.facts.volume.expect("closed"), 4.0 * PI / 3.0, 4.0 * tolerance);
            shape.facts.triangles
        };
        assert!(triangles("geodesic") < triangles("sphere"), "{tolerance}");
    }
    for (base, class, expected) in [
        ("icosahedron", "alternate", 20 * 16),
        ("octahedron", "alternate", 8 * 16),
        ("tetrahedron", "alternate", 4 * 16),
        ("icosahedron", "triacon", 20 * 48),
        ("octahedron", "triacon", 8 * 48),
    ] {
        let baked = bake(&format!(
            "[shape.a]\nsmoothing = \"flat\"\nuv = \"always\"\n[shape.a.geodesic]\nradius = 2\nbase = \"{base}\"\nclass = \"{class}\"\nfrequency = 4"
        ));
        let facts = &baked.only().facts;
        assert_eq!(
            (facts.triangles, facts.vertices, facts.euler),
            (expected, 3 * expected, 2),
            "{base} {class}"
        );
        assert_eq!(baked.only().deviation.tolerance, None);
    }
}

#[test]
fn a_grid_of_segments_replaces_the_tolerance() {
    for (kind, triangles) in [
        // Two rows of each rounding and a flat one: six sides of 5 x 5 cells.
        ("box]\nsize = [1, 1, 1]\nradius = 0.25", 6 * 25 * 2),
        ("geodesic]\nradius = 1", 20 * 4),
    ] {
        let baked = bake(&format!("[shape.a]\nsegments = [2, 2]\n[shape.a.{kind}"));
        assert_eq!(baked.only().facts.triangles, triangles, "{kind}");
        assert_eq!(baked.only().deviation.tolerance, None);
    }
}

/// Areas, volumes, counts and angles that other programs computed, where the folder of cases is there.
#[test]
fn measures_of_the_cases_are_met() {
    let Some(folder) = crate::import::cases(9, "solids") else { return };
    let cases = crate::import::json_of(&folder.join("surfaces/surfaces.json.gz"));
    let mut met = 0;
    for case in cases["cases"].as_array().expect("a list") {
        let name = case["name"].as_str().unwrap_or_default();
        let solid = format!("polyhedron]\nsolid = \"{name}\"\nedge = 1");
        let (kind, bend, genus) = match (case["kind"].as_str().unwrap_or_default(), name) {
            ("platonic_solid", _) => (solid.as_str(), 0.0, 0),
            (_, "sphere_r2") => ("geodesic]\nradius = 2", 2.0, 0),
            (_, "cone_r1_h2") => ("cone]\nradius = 1\nheight = 2", 1.0, 0),
            (_, "capsule_r1_l2") => ("capsule]\nradius = 1\nheight = 4", 1.0, 0),
            (_, "torus_3_1") => ("torus]\nradius = 3\ntube-radius = 1", 1.0, 1),
            _ => continue,
        };
        let number = |keys: [&str; 2]| keys.iter().find_map(|key| case[key].as_f64()).expect("a number");
        let (area, volume) = (number(["area", "lateral_area"]), number(["volume", "volume_swept_to_axis"]));
        let baked = check(kind, (area, volume), genus, bend);
        if case["kind"] == "platonic_solid" {
            let polygons = baked.only().polygons.expect("it is made of polygons");
            for (key, found) in [("v", polygons.vertices), ("e", polygons.edges), ("f", polygons.faces)] {
                assert_eq!(case[key].as_u64(), Some(found), "{name}: {key}");
            }
            let dihedral = case["dihedral_deg"].as_f64().expect("a number");
            assert!(dihedral_angles(&baked).iter().all(|angle| (angle - dihedral).abs() < 1e-4), "{name}");
        }
        met += 1;
    }
    assert_eq!(met, 7);
    let ellipsoid = bake("tolerance = 1e-4\n[shape.a]\nscale = [3, 2, 1]\n[shape.a.sphere]\nradius = 1");
    let case =
        cases["cases"].as_array().and_then(|all| all.iter().find(|case| case["name"] == "ellipsoid_3_2_1"));
    let case = case.expect("it is there");
    assert_near(ellipsoid.only().facts.area, case["area"].as_f64().expect("a number"), 1e-3);
    assert_near(
        ellipsoid.only().facts.volume.expect("closed"),
        case["volume"].as_f64().expect("a number"),
        1e-3,
    );
}

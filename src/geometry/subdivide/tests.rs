//! Laws, closed forms and tables of other programs.
//!
//! The tables of `OpenSubdiv` lie outside the repository, in the folder that the variable `KILN_CASES` names; without it
//! these tests say that they were not run. Those of CGAL are in `tests/data/subdivide`.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::Value;

use super::level::{Channel, Level};
use super::limit::position;
use super::sharpness::{ENDLESS, VertexClass};
use super::topology::Topology;
use super::{Aim, Crease, CreaseEdges, Options, Scheme, SubdivideFault, limit, refine, subdivide};
use crate::geometry::mesh::{PolygonMesh, index};

const ALL: [Scheme; 7] = [
    Scheme::CatmullClark,
    Scheme::Loop,
    Scheme::Root3,
    Scheme::DooSabin,
    Scheme::MidEdge,
    Scheme::Butterfly,
    Scheme::Bilinear,
];

fn level(points: &[DVec3], faces: &[Vec<u32>]) -> Level {
    try_level(points, faces).expect("a manifold")
}

fn try_level(points: &[DVec3], faces: &[Vec<u32>]) -> Result<Level, SubdivideFault> {
    let mut start = vec![0];
    let mut corners = Vec::new();
    for face in faces {
        corners.extend(face);
        start.push(index(corners.len()));
    }
    let topology = Topology::of_faces(start, corners, index(points.len()))?;
    let values = points.iter().flat_map(|point| point.to_array()).collect();
    Ok(Level { topology, channels: vec![Channel { width: 3, values }], ..Level::default() })
}

fn points(level: &Level) -> Vec<DVec3> {
    (0..index(level.topology.vertices())).map(|vertex| position(&level.channels[0], vertex)).collect()
}

/// A sharpness as the program keeps it.
#[expect(clippy::cast_possible_truncation, reason = "single precision is what the tables were computed with")]
fn single(sharpness: f64) -> f64 {
    f64::from(sharpness as f32)
}

/// A cage of the folder, as its tags say: creases, corners, borders.
struct Case {
    points: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    creases: Vec<([u32; 2], f64)>,
    corners: Vec<(u32, f64)>,
    border_corners: bool,
}

fn case(text: &str) -> Case {
    let mut made =
        Case { points: vec![], faces: vec![], creases: vec![], corners: vec![], border_corners: false };
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |k: usize| words[k].parse::<f64>().expect("a number");
        let whole = |k: usize| words[k].parse::<u32>().expect("a number");
        match words.first().copied() {
            Some("v") => made.points.push(DVec3::new(number(1), number(2), number(3))),
            Some("f") => made.faces.push(
                words[1..]
                    .iter()
                    .map(|word| word.split('/').next().expect("one").parse::<u32>().expect("a number") - 1)
                    .collect(),
            ),
            Some("t") => match words[1] {
                "crease" => made.creases.push(([whole(3), whole(4)], single(number(5)))),
                "corner" => made.corners.push((whole(3), single(number(4)))),
                "interpolateboundary" => made.border_corners = whole(3) == 1,
                _ => {}
            },
            _ => {}
        }
    }
    made
}

impl Case {
    fn level(&self) -> Level {
        let mut made = level(&self.points, &self.faces);
        let mut edges = vec![0.0; made.topology.edges()];
        for ([a, b], sharpness) in &self.creases {
            // Tags that name no edge are ignored by the program that wrote the tables.
            if let Some(edge) = made.topology.edge_between(*a, *b) {
                edges[edge as usize] = *sharpness;
            }
        }
        let mut vertices = vec![0.0; made.topology.vertices()];
        let mut ring = super::topology::Ring::default();
        for vertex in 0..index(made.topology.vertices()) {
            made.topology.ring(vertex, &mut ring);
            if self.border_corners && ring.corners.len() == 1 {
                vertices[vertex as usize] = ENDLESS;
            }
        }
        for (vertex, sharpness) in &self.corners {
            vertices[*vertex as usize] = f64::max(vertices[*vertex as usize], *sharpness);
        }
        (made.edge_sharpness, made.vertex_sharpness) = (edges, vertices);
        made
    }
}

fn scheme(name: &str) -> Scheme {
    match name {
        "catmark" => Scheme::CatmullClark,
        "loop" => Scheme::Loop,
        "bilinear" => Scheme::Bilinear,
        other => panic!("no scheme {other}"),
    }
}

#[expect(clippy::print_stdout, reason = "a test that is left out says so")]
fn folder() -> Option<PathBuf> {
    let found = std::env::var_os("KILN_CASES").map(|folder| PathBuf::from(folder).join("subdiv"));
    if found.is_none() {
        println!("KILN_CASES is not set: tables of OpenSubdiv not tried");
    }
    found
}

fn text(path: &Path) -> String {
    let bytes = std::fs::read(path).expect("it can be read");
    let mut text = String::new();
    if path.extension().is_some_and(|end| end == "gz") {
        flate2::read::GzDecoder::new(bytes.as_slice()).read_to_string(&mut text).expect("it unpacks");
    } else {
        text = String::from_utf8(bytes).expect("it is text");
    }
    text
}

fn files(folder: &Path) -> Vec<(String, PathBuf)> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut found: Vec<(String, PathBuf)> = entries
        .map(|entry| entry.expect("an entry").path())
        .map(|path| (path.file_name().expect("a name").to_string_lossy().into_owned(), path))
        .collect();
    found.sort();
    found
}

/// The farthest that a point of one list is from the nearest of the other, both ways.
fn apart(one: &[DVec3], other: &[DVec3]) -> f64 {
    let way = |from: &[DVec3], to: &[DVec3]| {
        let mut cells: BTreeMap<[i64; 3], Vec<DVec3>> = BTreeMap::new();
        #[expect(clippy::cast_possible_truncation, reason = "coordinates of cages are small")]
        let cell = |point: DVec3| (point * 100.0).floor().to_array().map(|part| part as i64);
        to.iter().for_each(|point| cells.entry(cell(*point)).or_default().push(*point));
        let nearest = |point: &DVec3| {
            let [x, y, z] = cell(*point);
            let around = (x - 1..=x + 1)
                .flat_map(|x| (y - 1..=y + 1).flat_map(move |y| (z - 1..=z + 1).map(move |z| [x, y, z])));
            let near = around.filter_map(|key| cells.get(&key)).flatten();
            near.map(|other| other.distance(*point)).fold(f64::INFINITY, f64::min)
        };
        from.iter().map(nearest).fold(0.0, f64::max)
    };
    way(one, other).max(way(other, one))
}

fn whole(value: &Value) -> u32 {
    value.as_u64().and_then(|number| u32::try_from(number).ok()).expect("a whole number")
}

fn numbers(list: &Value) -> DVec3 {
    let part = |k: usize| list[k].as_f64().expect("a number");
    DVec3::new(part(0), part(1), part(2))
}

/// The published results of `OpenSubdiv`'s regression, in single precision.
#[test]
fn published_levels_are_met() {
    let Some(folder) = folder() else { return };
    let mut tried = 0;
    for (name, path) in files(&folder.join("baseline")) {
        // Refined with Chaikin's rule for sharpness, which is not ours.
        if name.starts_with("loop_chaikin1") && !name.contains("step1") {
            continue;
        }
        let (stem, step) = name.trim_end_matches(".obj.gz").split_once("_step").expect("a step");
        let steps: u32 = step.parse().expect("a number");
        let case = case(&text(&folder.join(format!("cages/{stem}.obj"))));
        let mut level = case.level();
        let scheme = scheme(stem.split('_').next().expect("a scheme"));
        (0..steps).for_each(|_| level = refine(&level, scheme));
        let expected = self::case(&text(&path));
        assert_eq!(level.topology.vertices(), expected.points.len(), "{name}");
        assert_eq!(level.topology.faces(), expected.faces.len(), "{name}");
        let size = expected.points.iter().map(|point| point.length()).fold(0.0, f64::max);
        let apart = apart(&points(&level), &expected.points);
        assert!(apart <= 1e-6 * size.max(1.0), "{name}: {apart:e}");
        // The same faces, each by the middle of its corners.
        let middle = |points: &[DVec3], face: &[u32]| {
            face.iter().map(|vertex| points[*vertex as usize]).sum::<DVec3>() / f64::from(index(face.len()))
        };
        let own = points(&level);
        let ours: Vec<DVec3> =
            (0..level.topology.faces()).map(|face| middle(&own, level.topology.face(face))).collect();
        let theirs: Vec<DVec3> = expected.faces.iter().map(|face| middle(&expected.points, face)).collect();
        assert!(self::apart(&ours, &theirs) <= 1e-6 * size.max(1.0), "{name}: faces");
        tried += 1;
    }
    assert!(tried >= 54, "only {tried}");
}

/// Limits that `OpenSubdiv` computed in double precision.
#[test]
fn limits_are_met() {
    let Some(folder) = folder() else { return };
    let (mut tried, mut faults, mut refused) = (0, Vec::new(), Vec::new());
    for (name, path) in files(&folder.join("ref")) {
        let Some(stem) = name.split_once(".limit.json").map(|(stem, _)| stem) else { continue };
        // Holes have no place in this language.
        if stem.starts_with("catmark_hole") {
            continue;
        }
        let table: Value = serde_json::from_str(&text(&path)).expect("it is JSON");
        let case = case(&text(&folder.join(format!("cages/{stem}.obj"))));
        if let Err(fault) = try_level(&case.points, &case.faces) {
            refused.push(format!("{stem}: {fault}"));
            continue;
        }
        let cage = case.level();
        let scheme = scheme(table["scheme"].as_str().expect("a scheme"));
        let counts = table["levels"].as_array().expect("levels");
        let mut level = cage.clone();
        for (step, count) in counts.iter().enumerate() {
            let found = (level.topology.vertices(), level.topology.edges(), level.topology.faces());
            let expected = ["v", "e", "f"].map(|key| whole(&count[key]) as usize);
            assert_eq!(found, (expected[0], expected[1], expected[2]), "{stem}");
            if step == 1 {
                let list = table["step1_vertices"].as_array().expect("points");
                let list: Vec<DVec3> = list.iter().map(numbers).collect();
                let apart = apart(&points(&level), &list);
                // The table of the pawn leaves these out.
                if apart > 1e-9 && stem != "catmark_pawn" {
                    faults.push(format!("{stem}: step 1 apart {apart:e}"));
                }
                // Chaikin's rule for sharpness is not ours.
                let uniform = table["crease_method"] == "uniform" || scheme != Scheme::Loop;
                let whole = table["boundary"] != 0 || cage_closed(&cage);
                if uniform && whole && table["limit_exact"] == true {
                    compare(stem, &cage, &level, scheme, &table, &mut faults);
                }
            }
            level = refine(&level, scheme);
        }
        tried += 1;
    }
    assert_eq!(refused.len(), 4, "{refused:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(tried >= 37, "only {tried}");
}

fn around(level: &Level, vertex: u32) -> super::sharpness::Around {
    let mut ring = super::topology::Ring::default();
    let mut around = super::sharpness::Around::default();
    level.topology.ring(vertex, &mut ring);
    around.read(level, &ring);
    around
}

fn class_of(level: &Level, vertex: u32) -> VertexClass {
    around(level, vertex).class()
}

fn cage_closed(level: &Level) -> bool {
    (0..index(level.topology.edges())).all(|edge| !level.topology.is_border(edge))
}

fn compare(stem: &str, cage: &Level, level: &Level, scheme: Scheme, table: &Value, faults: &mut Vec<String>) {
    let made = limit(level, scheme);
    let (vertices, edges) = (cage.topology.vertices(), cage.topology.edges());
    let order = table["edges"].as_array().expect("edges");
    let edge = |k: usize| {
        let end = |side: usize| whole(&order[k][side]);
        index(vertices) + cage.topology.edge_between(end(0), end(1)).expect("an edge")
    };
    let (mut away, mut turned, mut normals) = (0.0_f64, 0.0_f64, 0);
    let mut hold = |vertex: u32, entry: &Value| {
        if entry.is_null() || entry["p"].is_null() {
            return;
        }
        let class = class_of(level, vertex);
        // The program has the mask of smooth vertices where a crease ends that never fades; ours is the limit itself.
        if class == VertexClass::Dart && around(level, vertex).edges.iter().any(|edge| *edge >= ENDLESS) {
            return;
        }
        // Nor has it masks for two edges, or exact ones across creases that are not regular.
        let own = around(level, vertex);
        let regular = if scheme == Scheme::Loop { 4 } else { 3 };
        if own.edges.len() == 2 && own.edges.iter().all(|edge| *edge < ENDLESS) {
            return;
        }
        let irregular = class == VertexClass::Crease && own.edges.len() != regular && own.edges.len() > 2;
        away = away.max(position(&made.channels[0], vertex).distance(numbers(&entry["p"])));
        if entry["n"].is_null() || scheme == Scheme::Bilinear {
            return;
        }
        let mut ring = super::topology::Ring::default();
        level.topology.ring(vertex, &mut ring);
        let own: Vec<DVec3> = (ring.corners.iter())
            .map(|corner| made.normals[made.corner_normals[*corner as usize] as usize])
            .collect();
        if own.windows(2).all(|pair| pair[0] == pair[1]) && class != VertexClass::Corner && !irregular {
            normals += 1;
            turned = turned.max(own[0].distance(numbers(&entry["n"])));
        }
    };
    for (key, place) in
        [("limit_of_control_vertex", 0), ("limit_of_edge_vertex", 1), ("limit_of_face_vertex", 2)]
    {
        for (k, entry) in table[key].as_array().expect("limits").iter().enumerate() {
            let vertex = match place {
                0 => index(k),
                1 => edge(k),
                _ => index(vertices + edges + k),
            };
            hold(vertex, entry);
        }
    }
    if away > 1e-9 || turned > 1e-6 {
        faults.push(format!("{stem}: limits {away:e} apart, {normals} normals {turned:e}"));
    }
}

/// What CGAL computed: Doo-Sabin, sqrt(3) and Butterfly.
#[test]
fn levels_of_cgal_are_met() {
    let packed = include_bytes!("../../../tests/data/subdivide/cgal.json.gz");
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed.as_slice()).read_to_string(&mut text).expect("it unpacks");
    let mut tables: Vec<Value> = vec![serde_json::from_str(&text).expect("it is JSON")];
    if let Some(folder) = folder() {
        let more = self::text(&folder.join("ref/doosabin_sqrt3_butterfly.json"));
        tables.push(serde_json::from_str(&more).expect("it is JSON"));
    }
    let mut tried = 0;
    for (name, model) in tables.iter().flat_map(|table| table["models"].as_object().expect("models")) {
        let list =
            |of: &Value| of["vertices"].as_array().expect("points").iter().map(numbers).collect::<Vec<_>>();
        let face = |face: &Value| -> Vec<u32> {
            let corners = face.as_array().expect("a face").iter();
            corners.map(whole).collect()
        };
        let faces: Vec<Vec<u32>> = model["faces"].as_array().expect("faces").iter().map(face).collect();
        let cage = level(&list(model), &faces);
        for (key, scheme) in
            [("doosabin", Scheme::DooSabin), ("sqrt3", Scheme::Root3), ("butterfly", Scheme::Butterfly)]
        {
            let mut level = cage.clone();
            for step in 1..=2 {
                let Some(table) = model.get(format!("{key}_step{step}")) else { continue };
                level = refine(&level, scheme);
                assert_eq!(
                    level.topology.faces() as u64,
                    table["f"].as_u64().expect("a count"),
                    "{name} {key}"
                );
                assert_eq!(
                    level.topology.vertices() as u64,
                    table["v"].as_u64().expect("a count"),
                    "{name} {key}"
                );
                let Some(list) = table["points"].as_array() else { continue };
                let expected: Vec<DVec3> = list.iter().map(numbers).collect();
                let apart = apart(&points(&level), &expected);
                assert!(
                    apart <= if key == "butterfly" { 1e-6 } else { 1e-9 },
                    "{name} {key} {step}: {apart:e}"
                );
                tried += 1;
            }
        }
    }
    assert!(tried >= 12, "only {tried}");
}

fn octahedron() -> Level {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    level(&axes, &faces.map(|face| face.to_vec()))
}

/// A grid of squares over the plane, or of two triangles each, at height `height`.
fn grid(size: u32, triangles: bool, height: impl Fn(f64, f64) -> f64) -> Level {
    let place = |k: u32| (f64::from(k % (size + 1)), f64::from(k / (size + 1)));
    let all: Vec<DVec3> =
        (0..(size + 1) * (size + 1)).map(place).map(|(x, y)| DVec3::new(x, y, height(x, y))).collect();
    let mut faces = Vec::new();
    for y in 0..size {
        for x in 0..size {
            let at = |x: u32, y: u32| y * (size + 1) + x;
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            if triangles {
                faces.extend([vec![a, b, c], vec![a, c, d]]);
            } else {
                faces.push(vec![a, b, c, d]);
            }
        }
    }
    level(&all, &faces)
}

fn wants_triangles(scheme: Scheme) -> bool {
    scheme.wants_triangles()
}

/// The numbers of a split are those of a topology that is found anew from its faces.
#[test]
fn splits_are_manifolds() {
    for scheme in ALL {
        for cage in [octahedron(), grid(3, wants_triangles(scheme), |x, y| x * y)] {
            let mut level = cage;
            for _ in 0..3 {
                let euler = |level: &Level| {
                    let [v, e, f] =
                        [level.topology.vertices(), level.topology.edges(), level.topology.faces()]
                            .map(|count| i64::from(index(count)));
                    v - e + f
                };
                let before = (euler(&level), cage_closed(&level));
                level = refine(&level, scheme);
                assert_eq!(before, (euler(&level), cage_closed(&level)), "{scheme:?}");
                let found = &level.topology;
                let again = Topology::of_faces(
                    found.face_start.clone(),
                    found.corner_vertex.clone(),
                    index(found.vertices()),
                );
                let again = again.expect("a manifold");
                assert_eq!(again.twin, found.twin, "{scheme:?}");
                assert_eq!(again.edges(), found.edges(), "{scheme:?}");
                for edge in 0..index(found.edges()) {
                    let corner = found.edge_corner[edge as usize];
                    assert_eq!(found.corner_edge[corner as usize], edge, "{scheme:?}");
                    let twin = found.twin[corner as usize];
                    assert!(twin == u32::MAX || found.corner_edge[twin as usize] == edge, "{scheme:?}");
                }
                for vertex in 0..index(found.vertices()) {
                    let corner = found.vertex_corner[vertex as usize] as usize;
                    assert_eq!(found.corner_vertex[corner], vertex, "{scheme:?}");
                    let open = found.twin[again.vertex_corner[vertex as usize] as usize] == u32::MAX;
                    assert_eq!(found.twin[corner] == u32::MAX, open, "{scheme:?}");
                }
            }
        }
    }
}

#[test]
fn affine_maps_go_through() {
    let map = |point: DVec3| {
        DVec3::new(2.0 * point.x - point.y + 5.0, point.z + 0.5 * point.x - 1.0, 3.0 * point.y + point.z)
    };
    for scheme in ALL {
        let cage = grid(3, wants_triangles(scheme), |x, y| x * x - 0.3 * x * y);
        let mut moved = level(&points(&cage).into_iter().map(map).collect::<Vec<_>>(), &faces_of(&cage));
        let mut plain = cage;
        for _ in 0..2 {
            (plain, moved) = (refine(&plain, scheme), refine(&moved, scheme));
        }
        for (one, other) in points(&plain).into_iter().zip(points(&moved)) {
            assert!(map(one).distance(other) < 1e-12, "{scheme:?}");
        }
    }
}

fn faces_of(level: &Level) -> Vec<Vec<u32>> {
    (0..level.topology.faces()).map(|face| level.topology.face(face).to_vec()).collect()
}

/// Inside a regular grid, control points on a paraboloid give a paraboloid of the same second derivatives, and the
/// interpolating scheme the same one.
#[test]
fn quadratics_are_reproduced() {
    for scheme in
        ALL.into_iter().filter(|scheme| !matches!(scheme, Scheme::Bilinear | Scheme::MidEdge | Scheme::Root3))
    {
        let height = |x: f64, y: f64| 0.7 * x * x - 0.4 * x * y + 0.2 * y * y + x - 2.0;
        let mut level = grid(12, wants_triangles(scheme), height);
        (0..2).for_each(|_| level = refine(&level, scheme));
        let inside: Vec<DVec3> = points(&level)
            .into_iter()
            .filter(|point| (point.truncate() - 6.0).abs().max_element() < 1.5)
            .collect();
        assert!(inside.len() > 20);
        let off = inside[0].z - height(inside[0].x, inside[0].y);
        for point in &inside {
            let here = point.z - height(point.x, point.y);
            assert!((here - off).abs() < 1e-11, "{scheme:?}: {here} {off}");
        }
        assert!(scheme != Scheme::Butterfly || off.abs() < 1e-11);
    }
}

/// A vertex has the same limit before and after a step.
#[test]
fn limits_stay() {
    for scheme in [Scheme::CatmullClark, Scheme::Loop, Scheme::Root3, Scheme::Butterfly] {
        for creased in [false, true] {
            let mut cage = grid(4, wants_triangles(scheme), |x, y| (x - 2.0) * (x - 2.0) - 0.3 * x * y * y);
            if creased {
                if !scheme.creases() {
                    continue;
                }
                // A fading crease, a dart that does not fade, and a sharp vertex.
                let sharp = [([6, 7], 2.3), ([7, 8], 1.6), ([12, 17], ENDLESS), ([16, 17], 0.4)];
                cage.edge_sharpness = vec![0.0; cage.topology.edges()];
                for ([a, b], sharpness) in sharp {
                    let edge = cage.topology.edge_between(a, b).expect("an edge");
                    cage.edge_sharpness[edge as usize] = sharpness;
                }
                cage.vertex_sharpness = vec![0.0; cage.topology.vertices()];
                cage.vertex_sharpness[18] = 1.7;
            }
            // Borders of sqrt(3) are refined in every second step.
            let twice = |level: &Level| {
                let next = refine(level, scheme);
                if scheme == Scheme::Root3 { refine(&next, scheme) } else { next }
            };
            let one = twice(&cage);
            let next = twice(&one);
            let (before, after) = (limit(&one, scheme), limit(&next, scheme));
            for vertex in 0..index(one.topology.vertices()) {
                let [a, b] = [&before, &after].map(|limit| position(&limit.channels[0], vertex));
                assert!(a.distance(b) < 1e-9, "{scheme:?} {vertex}: {a} {b}");
            }
        }
    }
}

/// Normals are those of the deeply refined surface.
#[test]
fn normals_are_those_of_the_limit() {
    for scheme in [Scheme::CatmullClark, Scheme::Loop, Scheme::Root3, Scheme::Butterfly] {
        let bumpy = |level: &Level| {
            let moved = points(level).into_iter().enumerate();
            let wave = |k: usize, share: f64| 1.0 + share * f64::from(index(k) % 5) / 5.0;
            let all: Vec<DVec3> = moved
                .map(|(k, point)| point * DVec3::new(wave(k, 0.3), wave(k + 2, 0.2), wave(k + 1, 0.4)))
                .collect();
            self::level(&all, &faces_of(level))
        };
        let cage = bumpy(&octahedron());
        let level = refine(&refine(&cage, scheme), scheme);
        let made = limit(&level, scheme);
        let deep = (0..if scheme == Scheme::Root3 { 8 } else { 5 })
            .fold(level.clone(), |level, _| refine(&level, scheme));
        let fine = limit(&deep, scheme);
        let exact = |vertex: u32| scheme != Scheme::Butterfly || vertex < 6;
        for vertex in (0..index(level.topology.vertices())).filter(|vertex| exact(*vertex)) {
            let normal = made.normals
                [made.corner_normals[level.topology.vertex_corner[vertex as usize] as usize] as usize];
            let mut ring = super::topology::Ring::default();
            deep.topology.ring(vertex, &mut ring);
            let at = |vertex: u32| position(&fine.channels[0], vertex);
            let arm = |k: usize| at(ring.far[k % ring.far.len()]) - at(vertex);
            let sum: DVec3 = (0..ring.far.len()).map(|k| arm(k).cross(arm(k + 1))).sum();
            assert!(
                sum.normalize().distance(normal) < 0.02,
                "{scheme:?} {vertex}: {} {normal}",
                sum.normalize()
            );
        }
    }
}

/// So are those along borders, of two, three and more faces around a vertex.
#[test]
fn normals_hold_along_borders() {
    for scheme in [Scheme::CatmullClark, Scheme::Loop] {
        for count in 2..=6_u32 {
            // A fan of triangles around a vertex of the border; quads after a step.
            let turn = std::f64::consts::PI / f64::from(count);
            let rim = |k: u32| {
                let (sine, cosine) = crate::geometry::number::sin_cos(turn * f64::from(k));
                DVec3::new(cosine, sine, 0.4 * cosine * cosine - 0.3 * sine + 0.2 * sine * cosine)
            };
            let all: Vec<DVec3> = std::iter::once(DVec3::ZERO).chain((0..=count).map(rim)).collect();
            let faces: Vec<Vec<u32>> = (0..count).map(|k| vec![0, k + 1, k + 2]).collect();
            let level = refine(&level(&all, &faces), scheme);
            let made = limit(&level, scheme);
            let normal = made.normals[made.corner_normals[level.topology.vertex_corner[0] as usize] as usize];
            let deep = (0..7).fold(level, |level, _| refine(&level, scheme));
            let fine = limit(&deep, scheme);
            let mut ring = super::topology::Ring::default();
            deep.topology.ring(0, &mut ring);
            let at = |vertex: u32| position(&fine.channels[0], vertex);
            let arm = |k: usize| at(ring.far[k]) - at(0);
            let last = ring.far.len() - 1;
            let across = (1..last).map(arm).sum::<DVec3>();
            let found = (arm(0) - arm(last)).cross(across).normalize();
            assert!(found.distance(normal) < 0.02, "{scheme:?} {count}: {found} {normal}");
        }
    }
}

/// The eigenvalues that the papers give: of Catmull-Clark and Loop by traces of the local step, of the others by their
/// first waves.
#[test]
fn eigenvalues_are_the_published_ones() {
    use std::f64::consts::TAU;
    for valence in 3..=9_usize {
        let n = f64::from(index(valence));
        let c = (TAU / n).cos_();
        let around = super::sharpness::Around { vertex: 0.0, edges: vec![0.0; valence] };
        // Catmull-Clark: (c + 5 + sqrt((c + 9)(c + 1))) / 16.
        let quads = super::local::Local { quads: true, edges: valence, faces: valence };
        let expected = (c + 5.0 + ((c + 9.0) * (c + 1.0)).sqrt()) / 16.0;
        assert!((second(&quads.step(&around)) - expected).abs() < 1e-9, "Catmull-Clark {valence}");
        // Loop: 3/8 + cos(2 pi / n) / 4.
        let triangles = super::local::Local { quads: false, edges: valence, faces: valence };
        let expected = if valence == 3 { 0.25 } else { 0.375 + 0.25 * c };
        assert!((second(&triangles.step(&around)) - expected).abs() < 1e-9, "Loop {valence}");
        // Doo-Sabin: 1/2 for every face. Modified Butterfly: 1/2 for every valence but 3.
        let wave = |weight: &dyn Fn(usize) -> f64| -> f64 {
            (0..valence).map(|k| weight(k) * (TAU * f64::from(index(k)) / n).cos_()).sum()
        };
        assert!((wave(&|k| super::corner_cut::doo_sabin_weight(valence, k)) - 0.5).abs() < 1e-12);
        if valence != 6 {
            assert!(
                (wave(&|k| super::butterfly::ring_weight(valence, k)) - 0.5).abs() < 1e-12,
                "Butterfly {valence}"
            );
        }
        // Two steps of sqrt(3): the first eigenvalue of the center row is (2 - 2 cos) / 9 of the mean left.
        let relaxation = super::root3::relaxation(valence);
        assert!((relaxation - (4.0 - 2.0 * c) / 9.0).abs() < 1e-15);
    }
}

trait Cosine {
    fn cos_(self) -> f64;
}

impl Cosine for f64 {
    fn cos_(self) -> f64 {
        crate::geometry::number::cos(self)
    }
}

/// The second eigenvalue of a step whose first is 1, by powers on differences from the limit, started with a wave.
fn second(step: &[Vec<f64>]) -> f64 {
    let apply = |vector: &[f64]| -> Vec<f64> {
        step.iter().map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
    };
    // A vector that has no part of the eigenvalue 1 in it: what a step changes.
    let size = step.len();
    let start: Vec<f64> = (0..size).map(|k| f64::from(index((k * 7 + 3) % 11)) / 11.0).collect();
    let mut vector: Vec<f64> = apply(&start).iter().zip(&start).map(|(a, b)| a - b).collect();
    let mut value = 0.0;
    // Rows of a high power are the limit, of which nothing may come back by rounding.
    let limit = (0..400).fold(vec![1.0 / f64::from(index(size)); size], |row: Vec<f64>, _| {
        let sums = (0..size).map(|column| row.iter().zip(step).map(|(part, line)| part * line[column]).sum());
        sums.collect()
    });
    for _ in 0..400 {
        let mut next = apply(&vector);
        let part: f64 = limit.iter().zip(&next).map(|(a, b)| a * b).sum();
        next.iter_mut().for_each(|value| *value -= part);
        let norm = |vector: &[f64]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        value = norm(&next) / norm(&vector);
        let size = norm(&next);
        vector = next.into_iter().map(|part| part / size).collect();
    }
    value
}

fn polygons(level: &Level) -> PolygonMesh {
    let faces = faces_of(level);
    let slices: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    PolygonMesh::from_faces(points(level), &slices)
}

fn asked(scheme: Scheme, aim: Aim) -> Options {
    Options {
        scheme,
        aim,
        limit: true,
        border_corners: false,
        creases: vec![],
        corners: vec![],
        triangulate: false,
    }
}

/// What is told of the distance holds against a mesh four levels finer.
#[test]
fn distances_hold() {
    for scheme in ALL.into_iter().filter(|scheme| *scheme != Scheme::Bilinear) {
        for cage in [octahedron(), grid(3, wants_triangles(scheme), |x, y| x * x - x * y)] {
            let cage = polygons(&cage);
            let mut last = f64::INFINITY;
            for levels in if scheme == Scheme::Root3 { [2, 4] } else { [2, 3] } {
                let made =
                    subdivide(&cage, &asked(scheme, Aim::Levels(levels)), 1 << 22).expect("it is made");
                let fine =
                    subdivide(&cage, &asked(scheme, Aim::Levels(levels + 2)), 1 << 22).expect("it is made");
                let away = fine
                    .mesh
                    .points
                    .iter()
                    .step_by(41)
                    .map(|point| far_from(&made.mesh, *point))
                    .fold(0.0, f64::max);
                assert!(away <= made.distance, "{scheme:?} {levels}: {away} {}", made.distance);
                assert!(made.distance < last, "{scheme:?}");
                last = made.distance;
            }
        }
    }
}

/// Distance of a point from the triangles of a mesh.
fn far_from(mesh: &PolygonMesh, point: DVec3) -> f64 {
    let mut best = f64::INFINITY;
    for face in 0..mesh.faces.len() {
        let corners: Vec<DVec3> = mesh.corners_of(face).map(|corner| mesh.position(corner)).collect();
        for k in 1..corners.len() - 1 {
            best = best.min(triangle_distance([corners[0], corners[k], corners[k + 1]], point));
        }
    }
    best
}

fn triangle_distance([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(from, to)| (*to - *from).cross(point - *from).dot(normal) >= 0.0);
    if inside && normal != DVec3::ZERO {
        return (point - a).dot(normal.normalize()).abs();
    }
    let side = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let part = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + along * part)
    };
    [(a, b), (b, c), (c, a)].into_iter().map(side).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_tolerance_is_kept() {
    for scheme in ALL {
        let cage = polygons(&octahedron());
        let made = subdivide(&cage, &asked(scheme, Aim::Tolerance(0.01)), 1 << 22).expect("it is made");
        assert!(made.distance <= 0.01, "{scheme:?}");
        assert!(made.levels <= 6, "{scheme:?} {}", made.levels);
    }
}

#[test]
fn faults_are_told() {
    let cage = polygons(&octahedron());
    let plain = asked(Scheme::CatmullClark, Aim::Levels(2));
    let crease = |a: u32, b: u32| Options {
        creases: vec![Crease { edges: CreaseEdges::Pairs(vec![[a, b]]), sharpness: 2.0 }],
        ..plain.clone()
    };
    let fault = |mesh: &PolygonMesh, options: &Options| subdivide(mesh, options, 1000).err();
    assert_eq!(fault(&cage, &crease(0, 1)), Some(SubdivideFault::NoEdge { a: 0, b: 1 }));
    assert_eq!(fault(&cage, &crease(0, 9)), Some(SubdivideFault::NoVertex { vertex: 9, count: 6 }));
    let deep = Options { aim: Aim::Levels(9), ..plain.clone() };
    assert!(matches!(fault(&cage, &deep), Some(SubdivideFault::TooMany { levels: 9, .. })));
    let fine = Options { aim: Aim::Tolerance(1e-9), ..plain.clone() };
    assert!(matches!(fault(&cage, &fine), Some(SubdivideFault::TooMany { .. })));
    let quads = polygons(&grid(2, false, |_, _| 0.0));
    let of_triangles = asked(Scheme::Loop, Aim::Levels(1));
    assert_eq!(fault(&quads, &of_triangles), Some(SubdivideFault::NotTriangles { face: 0, corners: 4 }));
    let cut = Options { triangulate: true, ..of_triangles };
    assert_eq!(subdivide(&quads, &cut, 1000).map(|made| made.triangulated), Ok(4));
    let mut alone = cage.clone();
    alone.points.push(DVec3::ONE);
    assert_eq!(fault(&alone, &plain), Some(SubdivideFault::Isolated { vertex: 6 }));
    let mut thrice = cage.clone();
    thrice.points.push(DVec3::ONE);
    thrice.push_face(&[&[0, 2, 6]], None, 0);
    assert_eq!(fault(&thrice, &plain), Some(SubdivideFault::ManyFaces { a: 0, b: 2, faces: 3 }));
    let turned = PolygonMesh::from_faces(cage.points[..4].to_vec(), &[&[0, 1, 2], &[0, 1, 3]]);
    assert_eq!(fault(&turned, &plain), Some(SubdivideFault::Opposed { a: 0, b: 1 }));
    let touching = PolygonMesh::from_faces(cage.points[..5].to_vec(), &[&[0, 1, 2], &[0, 3, 4]]);
    assert_eq!(fault(&touching, &plain), Some(SubdivideFault::Pinched { vertex: 0 }));
    let twice = PolygonMesh::from_faces(cage.points[..4].to_vec(), &[&[0, 1, 2, 1]]);
    assert_eq!(fault(&twice, &plain), Some(SubdivideFault::RepeatedVertex { face: 0, vertex: 1 }));
}

/// Texture coordinates follow their faces, and seams stay where they are.
#[test]
fn charts_are_carried() {
    for scheme in [Scheme::CatmullClark, Scheme::Loop] {
        let level = grid(2, wants_triangles(scheme), |x, y| x * y * 0.2);
        let mut mesh = polygons(&level);
        mesh.uvs = mesh
            .corners
            .iter()
            .enumerate()
            .map(|(corner, point)| {
                let place = mesh.points[point.subscript()].truncate();
                // The right half is a chart of its own.
                let right = (0..mesh.faces.len())
                    .find(|face| mesh.corners_of(*face).contains(&corner))
                    .is_some_and(|face| {
                        mesh.corners_of(face).map(|corner| mesh.position(corner).x).fold(0.0, f64::max) > 1.5
                    });
                if right { place + 10.0 } else { place }
            })
            .collect();
        let mut all: Vec<glam::DVec2> = Vec::new();
        mesh.corner_uvs = mesh
            .uvs
            .iter()
            .map(|uv| {
                index(all.iter().position(|known| known == uv).unwrap_or_else(|| {
                    all.push(*uv);
                    all.len() - 1
                }))
            })
            .collect();
        mesh.uvs = all;
        let options = Options { border_corners: true, ..asked(scheme, Aim::Levels(3)) };
        let made = subdivide(&mesh, &options, 1 << 20).expect("it is made").mesh;
        made.validate().expect("it is a mesh");
        for (corner, uv) in made.corner_uvs.iter().enumerate() {
            let (uv, place) = (made.uvs[*uv as usize], made.position(corner).truncate());
            let near = if uv.x > 9.0 { uv - 10.0 } else { uv };
            assert!((near - 1.0).abs().max_element() <= 1.0 + 1e-12, "{uv}");
            if near.x == 1.0 {
                assert!((place.x - 1.0).abs() < 0.2, "{place} {uv}");
            }
        }
    }
}

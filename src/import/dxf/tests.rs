use glam::{DVec2, DVec3};

use super::super::{ImportError, ImportOptions};
use super::{Drawn, DxfFault, Piece, drawing, read};

/// Pairs as text: codes and values by turns.
fn text(pairs: &[(i32, &str)]) -> String {
    pairs.iter().map(|(code, value)| format!("{code:3}\n{value}\n")).collect()
}

/// The same pairs in binary, with codes of two bytes or of one.
fn binary(pairs: &[(i32, &str)], long: bool) -> Vec<u8> {
    let mut bytes = b"AutoCAD Binary DXF\r\n\x1a\0".to_vec();
    for (code, value) in pairs {
        match (long, u8::try_from(*code)) {
            (false, Ok(code)) if code < 255 => bytes.push(code),
            (true, _) => bytes.extend(i16::try_from(*code).expect("small").to_le_bytes()),
            (false, _) => {
                bytes.push(255);
                bytes.extend(i16::try_from(*code).expect("small").to_le_bytes());
            }
        }
        match code {
            10..=59 | 210..=239 => bytes.extend(value.parse::<f64>().expect("a number").to_le_bytes()),
            60..=79 => bytes.extend(value.parse::<i16>().expect("a number").to_le_bytes()),
            90..=99 => bytes.extend(value.parse::<i32>().expect("a number").to_le_bytes()),
            _ => {
                bytes.extend(value.as_bytes());
                bytes.push(0);
            }
        }
    }
    bytes
}

type Pairs<'t> = Vec<(i32, &'t str)>;

/// A block with a face, in a row of two, turned by a quarter and twice as large; a polyface mesh; a mesh.
fn faces() -> Pairs<'static> {
    let mut all: Pairs<'_> = vec![(0, "SECTION"), (2, "BLOCKS"), (0, "BLOCK"), (2, "tile")];
    all.extend([(10, "1"), (20, "0"), (30, "0"), (0, "3DFACE"), (8, "0")]);
    all.extend([(10, "1"), (20, "0"), (30, "0"), (11, "2"), (21, "0"), (31, "0")]);
    all.extend([(12, "2"), (22, "1"), (32, "0"), (13, "1"), (23, "1"), (33, "0")]);
    all.extend([(0, "ENDBLK"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]);
    all.extend([(0, "INSERT"), (8, "floor"), (2, "TILE"), (10, "5"), (20, "0"), (30, "1")]);
    all.extend([(41, "2"), (42, "2"), (50, "90"), (70, "2"), (71, "1"), (44, "3")]);
    all.extend([(0, "POLYLINE"), (8, "walls"), (66, "1"), (70, "64")]);
    for [x, y, z] in [["0", "0", "0"], ["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]] {
        all.extend([(0, "VERTEX"), (8, "walls"), (10, x), (20, y), (30, z), (70, "192")]);
    }
    for [a, b, c] in [["1", "3", "2"], ["1", "2", "-4"], ["2", "3", "4"], ["3", "1", "4"]] {
        all.extend([(0, "VERTEX"), (8, "walls"), (70, "128"), (71, a), (72, b), (73, c)]);
    }
    all.extend([(0, "SEQEND"), (0, "TEXT"), (8, "0"), (1, "hello"), (0, "MESH"), (8, "roof"), (92, "4")]);
    for [x, y] in [["0", "0"], ["2", "0"], ["2", "1"], ["0", "1"]] {
        all.extend([(10, x), (20, y), (30, "3")]);
    }
    all.extend([(93, "5"), (90, "4"), (90, "0"), (90, "1"), (90, "2"), (90, "3"), (94, "0"), (95, "0")]);
    all.extend([(0, "ENDSEC"), (0, "EOF")]);
    all
}

/// A plate of two lines and two arcs, a circle in a plane that looks along x, a slot with bulges, and splines.
fn curves() -> Pairs<'static> {
    let mut all: Pairs<'_> = vec![(999, "a plate"), (0, "SECTION"), (2, "ENTITIES")];
    let line = |all: &mut Pairs<'static>, [a, b, c, d]: [&'static str; 4]| {
        all.extend([(0, "LINE"), (8, "plate"), (10, a), (20, b), (11, c), (21, d)]);
    };
    line(&mut all, ["0", "0", "4", "0"]);
    line(&mut all, ["0", "2", "4", "2"]);
    all.extend([(0, "ARC"), (8, "plate"), (10, "4"), (20, "1"), (40, "1"), (50, "270"), (51, "90")]);
    all.extend([(0, "ARC"), (8, "plate"), (10, "0"), (20, "1"), (40, "1"), (50, "90"), (51, "270")]);
    all.extend([(0, "CIRCLE"), (8, "hole"), (10, "2"), (20, "3"), (30, "5"), (40, "0.5")]);
    all.extend([(210, "1"), (220, "0"), (230, "0")]);
    all.extend([(0, "LWPOLYLINE"), (8, "slot"), (90, "2"), (70, "1"), (38, "7")]);
    all.extend([(10, "0"), (20, "0"), (42, "1"), (10, "0"), (20, "2"), (42, "0")]);
    all.extend([(0, "ELLIPSE"), (8, "hole"), (10, "1"), (20, "1"), (11, "0"), (21, "2"), (40, "0.5")]);
    all.extend([(41, "0"), (42, "1.5707963267948966")]);
    all.extend([(0, "SPLINE"), (8, "wave"), (70, "8"), (71, "2"), (72, "6"), (73, "3"), (74, "0")]);
    ["0", "0", "0", "1", "1", "1"].iter().for_each(|knot| all.push((40, knot)));
    for [x, y] in [["0", "0"], ["1", "2"], ["2", "0"]] {
        all.extend([(10, x), (20, y), (30, "0")]);
    }
    all.extend([(0, "SPLINE"), (8, "wave"), (70, "8"), (71, "3"), (74, "3")]);
    for [x, y] in [["2", "0"], ["3", "1"], ["4", "0"]] {
        all.extend([(11, x), (21, y), (31, "0")]);
    }
    all.extend([(0, "ENDSEC"), (0, "EOF")]);
    all
}

#[test]
fn faces_are_read_from_text_and_both_binary_forms() {
    let found = read(text(&faces()).as_bytes(), &ImportOptions::default()).expect("a mesh");
    found.mesh.validate().expect("valid");
    assert_eq!(found.groups, ["floor", "walls", "roof"]);
    assert_eq!(found.mesh.materials, found.groups);
    assert_eq!(found.mesh.faces.len(), 2 + 4 + 1);
    // The block's corner [2, 0], from its base [1, 0] on, turned to y and doubled; then a step of 3 along y.
    let corner = |at: usize| found.mesh.points[found.mesh.corners[at].subscript()];
    assert!(corner(1).distance(DVec3::new(5.0, 2.0, 1.0)) < 1e-12, "{}", corner(1));
    assert!(corner(5).distance(DVec3::new(5.0, 5.0, 1.0)) < 1e-12, "{}", corner(5));
    let told: Vec<&str> = found.notes.iter().map(|note| note.message.as_str()).collect();
    assert_eq!(told, ["1 entities TEXT are left out"]);
    for long in [false, true] {
        assert_eq!(read(&binary(&faces(), long), &ImportOptions::default()).expect("a mesh"), found);
    }
    let returns = text(&faces()).replace('\n', "\r\n");
    assert_eq!(read(returns.as_bytes(), &ImportOptions::default()).expect("a mesh"), found);
    let walls = ImportOptions { group: Some("walls".to_owned()), ..ImportOptions::default() };
    let walls = read(text(&faces()).as_bytes(), &walls).expect("a mesh").mesh;
    let volume: f64 = (0..4)
        .map(|face| {
            let [a, b, c] = [0, 1, 2].map(|k| walls.points[walls.corners[3 * face + k].subscript()]);
            a.cross(b).dot(c) / 6.0
        })
        .sum();
    assert!((volume - 1.0 / 6.0).abs() < 1e-12, "{volume}");
}

#[test]
fn a_grid_is_closed_where_it_says_so() {
    let mut all: Pairs<'_> = vec![(0, "SECTION"), (2, "ENTITIES"), (0, "POLYLINE"), (8, "0"), (66, "1")];
    all.extend([(70, "48"), (71, "2"), (72, "3")]);
    for [x, y, z] in
        [["0", "0", "0"], ["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"], ["1", "0", "1"], ["0", "1", "1"]]
    {
        all.extend([(0, "VERTEX"), (10, x), (20, y), (30, z), (70, "64")]);
    }
    all.extend([(0, "SEQEND"), (0, "ENDSEC"), (0, "EOF")]);
    let mesh = read(text(&all).as_bytes(), &ImportOptions::default()).expect("a mesh").mesh;
    assert_eq!((mesh.faces.len(), mesh.points.len()), (3, 6));
    let ring: Vec<u32> = mesh.corners[8..].iter().map(|corner| corner.0).collect();
    assert_eq!(ring, [2, 0, 3, 5]);
}

#[test]
fn curves_are_joined_where_they_meet() {
    let found = drawing(text(&curves()).as_bytes()).expect("a drawing");
    assert_eq!(found.layers, ["plate", "hole", "slot", "wave"]);
    let (all, notes) = found.curves(None, 1e-6);
    assert!(notes.is_empty(), "{notes:?}");
    let shapes: Vec<(usize, bool)> = all.iter().map(|one| (one.pieces.len(), one.closed)).collect();
    assert_eq!(shapes, [(4, true), (1, true), (2, true), (1, false), (2, false)]);
    let backwards: Vec<bool> = all[0].pieces.iter().map(|(_, back)| *back).collect();
    assert_eq!(backwards, [false, false, true, false], "the line above runs on to the right");
    // The plane that looks along x has y as its x and z as its y.
    let Piece::Arc { center, x, y, angles } = &all[1].pieces[0].0 else { panic!("an arc") };
    assert!(center.distance(DVec3::new(5.0, 2.0, 3.0)) < 1e-12, "{center}");
    assert!(x.distance(DVec3::Y * 0.5) < 1e-12 && y.distance(DVec3::Z * 0.5) < 1e-12, "{x} {y}");
    assert_eq!(*angles, DVec2::new(0.0, 360.0));
    // A bulge of 1 is half a circle, counter-clockwise: up along y it swings out to the right.
    let Piece::Arc { center, x, angles, .. } = &all[2].pieces[0].0 else { panic!("an arc") };
    assert!(center.distance(DVec3::new(0.0, 1.0, 7.0)) < 1e-12 && x.distance(-DVec3::Y) < 1e-12);
    assert!((angles.y - 180.0).abs() < 1e-12);
    let Piece::Arc { x, y, angles, .. } = &all[3].pieces[0].0 else { panic!("an arc") };
    assert!(x.distance(DVec3::Y * 2.0) < 1e-12 && y.distance(-DVec3::X) < 1e-12, "{x} {y}");
    assert!((angles.y - 90.0).abs() < 1e-9);
    assert!(matches!(all[4].pieces[1].0, Piece::Through(ref points) if points.len() == 3));
    let (apart, _) = found.curves(Some("plate"), 0.0);
    assert_eq!(apart.iter().map(|one: &Drawn| one.pieces.len()).collect::<Vec<_>>(), [1; 4]);
    for long in [false, true] {
        assert_eq!(drawing(&binary(&curves(), long)).expect("a drawing"), found);
    }
}

/// Whatever a file is cut off to, or whichever bit of it is wrong: it is read or refused.
#[test]
fn cut_off_and_flipped_files_are_read_or_refused() {
    let files = [
        text(&faces()).into_bytes(),
        binary(&faces(), true),
        text(&curves()).into_bytes(),
        binary(&curves(), false),
    ];
    let try_all = |bytes: &[u8]| {
        let mesh = read(bytes, &ImportOptions::default());
        if let Ok(found) = &mesh {
            found.mesh.validate().expect("valid");
        }
        let drawn = drawing(bytes).map(|drawing| drawing.curves(None, 1e-6).0.len());
        let errors = [mesh.err().map(|error| error.to_string()), drawn.err().map(|error| error.to_string())];
        errors.into_iter().flatten().all(|message| !message.is_empty())
    };
    for whole in files {
        for length in 0..whole.len() {
            assert!(try_all(&whole[..length]), "{length} bytes");
            // But for the end of the last line.
            assert!(length + 1 == whole.len() || drawing(&whole[..length]).is_err(), "{length} bytes");
        }
        let mut refused = 0;
        for at in 0..whole.len() {
            for bit in [0, 2, 4, 6, 7] {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                assert!(try_all(&bytes));
                refused += usize::from(drawing(&bytes).is_err());
            }
        }
        assert!(refused > 50, "{refused}");
    }
}

#[test]
fn faults_name_what_they_found() {
    let told = |pairs: &Pairs<'_>, from: (i32, &str), to: &str| {
        let mut pairs = pairs.clone();
        let place = pairs.iter().position(|pair| *pair == from).expect("there");
        pairs[place].1 = to;
        let error = ImportError::from(drawing(text(&pairs).as_bytes()).expect_err("refused"));
        format!("{}: {error}", error.line().unwrap_or(0))
    };
    let (solid, flat) = (faces(), curves());
    let messages = [
        told(&solid, (73, "-4"), "-5"),
        told(&solid, (12, "2"), "two"),
        told(&solid, (93, "5"), "9"),
        told(&solid, (90, "3"), "4"),
        told(&solid, (90, "4"), "7"),
        told(&flat, (40, "1"), "0"),
        told(&flat, (71, "2"), "4"),
        told(&flat, (11, "0"), "zero"),
    ];
    let wanted = [
        "144: a polyface mesh has a face with vertex 4, and it has 4",
        "32: expected a number for code 12, found `two`",
        "188: a MESH has fewer corners than it announces",
        "188: a MESH has a face with vertex 4, and it has 4",
        "188: a MESH has a face of more corners than are left",
        "32: an arc or circle has no radius above 0",
        "118: a spline has a degree that is not from 1 to 25, or too few points for it",
        "108: expected a number for code 11, found `zero`",
    ];
    assert_eq!(messages, wanted);
}

#[test]
fn blocks_that_hold_themselves_or_grow_without_end_are_refused() {
    let nested = |depth: usize, columns: &str, last: &str| {
        let mut lines = String::from("0\nSECTION\n2\nBLOCKS\n");
        for level in 0..depth {
            let inside = if level + 1 < depth { format!("b{}", level + 1) } else { last.to_owned() };
            lines += &format!(
                "0\nBLOCK\n2\nB{level}\n0\nINSERT\n2\n{inside}\n70\n{columns}\n0\nLINE\n11\n1\n0\nENDBLK\n"
            );
        }
        lines + "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb0\n0\nENDSEC\n0\nEOF\n"
    };
    assert_eq!(drawing(nested(3, "1", "b1").as_bytes()), Err(DxfFault::Circle { block: "B1".to_owned() }));
    assert_eq!(drawing(nested(40, "1", "none").as_bytes()), Err(DxfFault::Deep));
    assert!(matches!(drawing(nested(20, "30", "none").as_bytes()), Err(DxfFault::TooMany { .. })));
    assert!(drawing(nested(20, "1", "none").as_bytes()).is_ok());
    let empty = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nA\n70\n32000\n71\n32000\n0\nENDSEC\n0\nEOF\n";
    assert!(matches!(drawing(empty.as_bytes()), Err(DxfFault::TooMany { .. })));
    assert_eq!(drawing(b"solid x"), Err(DxfFault::NotDxf));
    assert_eq!(drawing(b""), Err(DxfFault::NotDxf));
}

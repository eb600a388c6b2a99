//! Both forms of STL, and files that pass for the other.

use glam::DVec3;

use super::read;
use crate::import::{ImportError, ImportOptions, Imported};

fn plain(bytes: &[u8]) -> Result<Imported, ImportError> {
    read(bytes, &ImportOptions::default())
}

/// The message with its place, as a diagnostic shows it.
fn told(error: &ImportError) -> String {
    error.line().map_or_else(|| error.to_string(), |line| format!("line {line}: {error}"))
}

/// A binary file of these facets: normal and corners.
fn binary(header: &[u8], facets: &[[[f32; 3]; 4]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(u32::try_from(facets.len()).expect("small").to_le_bytes());
    for facet in facets {
        bytes.extend(facet.iter().flatten().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Two triangles of a square in the plane z = 0.
const SQUARE: [[[f32; 3]; 4]; 2] = [
    [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
    [[0.0, 0.0, 1.0], [0.0, 0.0, -0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
];

const TEXT: &str = "solid left\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid left\nSOLID right arm\nFACET NORMAL 0 0 -1 OUTER LOOP VERTEX 0 0 0 VERTEX 1E0 0 0 VERTEX 0 1 0 ENDLOOP ENDFACET\nENDSOLID\n";

#[test]
fn facets_are_joined_at_equal_points() {
    let read = plain(&binary(b"made by hand", &SQUARE)).expect("good");
    assert_eq!((read.mesh.points.len(), read.mesh.faces.len()), (4, 2));
    assert_eq!(read.mesh.validate(), Ok(()));
    assert!(read.notes.is_empty());
}

#[test]
fn a_binary_file_may_call_itself_solid() {
    assert_eq!(plain(&binary(b"solid pretender", &SQUARE)).expect("good").mesh.faces.len(), 2);
}

#[test]
fn text_of_several_solids() {
    let read = plain(TEXT.as_bytes()).expect("good");
    assert_eq!((read.mesh.faces.len(), read.mesh.points.len()), (2, 3));
    assert_eq!(read.groups, ["left", "right arm"]);
    assert_eq!(
        read.notes[0].message,
        "1 of 2 facet normals point against the order of the corners; the order of the corners is used"
    );
    assert_eq!(read.mesh.newell(1), DVec3::Z);
    let only = |group: &str| {
        super::read(
            TEXT.as_bytes(),
            &ImportOptions { group: Some(group.to_owned()), ..ImportOptions::default() },
        )
    };
    assert_eq!(only("left").expect("good").mesh.faces.len(), 1);
    assert_eq!(
        only("up").expect_err("no such solid").hint().as_deref(),
        Some("its groups are: `left`, `right arm`")
    );
    let crlf = TEXT.replace('\n', "\r\n");
    assert_eq!(plain(crlf.as_bytes()).expect("good").mesh.faces.len(), 2);
    assert_eq!(plain(format!("\u{feff}{TEXT}").as_bytes()).expect("good").mesh.faces.len(), 2);
}

#[test]
fn near_points_are_joined_on_request() {
    let mut gap = SQUARE;
    gap[1][2][0] = 1.001;
    let options = ImportOptions { weld: Some(0.01), ..ImportOptions::default() };
    assert_eq!(plain(&binary(b"", &gap)).expect("good").mesh.points.len(), 5);
    assert_eq!(read(&binary(b"", &gap), &options).expect("good").mesh.points.len(), 4);
}

#[test]
fn counts_that_lie() {
    let good = binary(b"", &SQUARE);
    let mut more = good.clone();
    more[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = plain(&more).expect_err("too few");
    assert_eq!(error, ImportError::Truncated { claimed: u32::MAX, held: 2 });
    assert_eq!(
        error.to_string(),
        "the file says it holds 4294967295 triangles, but there is room for only 2"
    );
    assert_eq!(plain(&good[..good.len() - 1]), Err(ImportError::Truncated { claimed: 2, held: 1 }));
    assert_eq!(plain(&good[..83]), Err(ImportError::TooShort { length: 83 }));
    let mut less = good.clone();
    less[80] = 1;
    let read = plain(&less).expect("one facet");
    assert_eq!(
        (read.mesh.faces.len(), read.notes[0].message.as_str()),
        (1, "50 bytes after the last facet are not read")
    );
    less[80] = 0;
    assert_eq!(plain(&less), Err(ImportError::NoFaces { vertices: 0 }));
}

#[test]
fn numbers_that_are_not_finite() {
    let mut spoiled = SQUARE;
    spoiled[1][3][2] = f32::NAN;
    let error = plain(&binary(b"", &spoiled)).expect_err("NaN");
    assert_eq!(error.to_string(), "facet 2 has a coordinate that is not a finite number: NaN");
    // A stored normal may be anything.
    let mut strange = SQUARE;
    strange[0][0] = [f32::NAN, 0.0, f32::INFINITY];
    assert!(plain(&binary(b"", &strange)).expect("good").notes.is_empty());
    let text = TEXT.replace("1E0", "1e999");
    assert_eq!(told(&plain(text.as_bytes()).expect_err("infinite")), "line 11: `inf` is not a finite number");
}

#[test]
fn text_that_breaks_off() {
    let message = |text: &str| told(&plain(text.as_bytes()).expect_err("broken"));
    let facet = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    assert_eq!(message(&format!("{facet}endloop\nendfacet")), "line 6: expected vertex, found `endloop`");
    assert_eq!(message(facet), "line 6: expected vertex, found the end of the file");
    assert_eq!(
        message(&format!("{facet}vertex 0 1")),
        "line 6: expected a coordinate of a vertex, found the end of the file"
    );
    assert_eq!(
        message(&format!("{facet}vertex 0 1 q\n")),
        "line 6: expected a number for a coordinate of a vertex, found `q`"
    );
    assert_eq!(
        message(&format!("{facet}vertex 0 1 0\nvertex 1 1 0")),
        "line 7: expected endloop, found `vertex`"
    );
    assert_eq!(message("solid x\nendsolid x\n"), "the file holds no faces");
}

#[test]
fn other_formats_are_named() {
    let mut blend = b"BLENDER-v405".to_vec();
    blend.resize(200, 7);
    assert_eq!(
        plain(&blend).expect_err("not STL").to_string(),
        "this is a Blender file, which Kiln does not read"
    );
    // A proper STL file may begin with anything.
    assert!(plain(&binary(b"BLENDER", &SQUARE)).is_ok());
}

#[test]
fn no_damage_breaks_the_reader() {
    for source in [TEXT.as_bytes().to_vec(), binary(b"solid", &SQUARE)] {
        let (mut good, mut bad) = (0, 0);
        for at in 0..source.len() {
            let mut spoiled = source.clone();
            for value in [0, b' ', b'9', b'-', 0xff] {
                spoiled[at] = value;
                match plain(&spoiled) {
                    Ok(read) => {
                        assert_eq!(read.mesh.validate(), Ok(()));
                        good += 1;
                    }
                    Err(_) => bad += 1,
                }
            }
            bad += usize::from(plain(&source[..at]).is_err());
        }
        assert!(good > 10 && bad > 10, "{good} good, {bad} bad");
    }
}

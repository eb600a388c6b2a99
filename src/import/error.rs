//! Why a file could not be imported.

use thiserror::Error;

use super::Foreign;
use super::dxf::DxfFault;
use super::gltf::GltfFault;
use super::md2::Md2Fault;
use super::md3::Md3Fault;
use super::md5::Md5Fault;
use super::ply::PlyFault;
use super::studio::StudioFault;

/// Why a file could not be imported. `Display` is a message for a diagnostic, [`ImportError::line`] its place,
/// [`ImportError::hint`] what to do.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ImportError {
    /// A file of another format.
    #[error("this is {}, which Kiln does not read", .0.name)]
    Foreign(Foreign),
    /// Bytes where text is needed.
    #[error("this is not text: it holds byte 0x{byte:02x}")]
    Binary {
        /// Line of the first such byte.
        line: u32,
        /// The byte.
        byte: u8,
    },
    /// Text in UTF-16.
    #[error("the text is encoded as UTF-16")]
    Utf16,
    /// Something that should be a number is not.
    #[error("expected a number for {what}, found `{text}`")]
    BadNumber {
        /// Where.
        line: u32,
        /// For example `the x coordinate of a vertex`.
        what: &'static str,
        /// What stands there.
        text: String,
    },
    /// A number is NaN, infinite, or too large for a double.
    #[error("`{text}` is not a finite number")]
    NotFinite {
        /// Where.
        line: u32,
        /// What stands there.
        text: String,
    },
    /// A coordinate of a facet in a binary file is NaN or infinite.
    #[error("facet {facet} has a coordinate that is not a finite number: {value}")]
    FacetNotFinite {
        /// Which facet, counted from 1.
        facet: u32,
        /// The value.
        value: f64,
    },
    /// Too few numbers.
    #[error("{what} needs {expected} numbers, found {found}")]
    TooFewNumbers {
        /// Where.
        line: u32,
        /// For example `a vertex`.
        what: &'static str,
        /// How many are needed.
        expected: u32,
        /// How many there are.
        found: u32,
    },
    /// The corner of a face is not of the form `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[error("`{text}` is not the corner of a face")]
    BadCorner {
        /// Where.
        line: u32,
        /// What stands there.
        text: String,
    },
    /// Index 0.
    #[error("index 0 in `{text}`; indices count from 1")]
    IndexZero {
        /// Where.
        line: u32,
        /// The corner.
        text: String,
    },
    /// An index beyond the end, or a relative one before the beginning.
    #[error("{what} {index} does not exist; {}", if *index < 0 {
        format!("only {count} come before it")
    } else {
        format!("the file has {count}")
    })]
    IndexOutOfRange {
        /// Where.
        line: u32,
        /// `vertex`, `texture coordinate` or `normal`.
        what: &'static str,
        /// The index as written.
        index: i128,
        /// How many there are.
        count: u32,
    },
    /// No face at all.
    #[error("the file holds no faces{}", if *vertices > 0 { format!(", only {vertices} vertices") } else { String::new() })]
    NoFaces {
        /// How many vertices it holds.
        vertices: u32,
    },
    /// The group asked for is not there.
    #[error("the file has no group `{group}`")]
    UnknownGroup {
        /// The name asked for.
        group: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// The group asked for is there but empty.
    #[error("group `{group}` holds no faces")]
    EmptyGroup {
        /// The name asked for.
        group: String,
    },
    /// A binary STL file that holds fewer triangles than it says.
    #[error("the file says it holds {claimed} triangles, but there is room for only {held}")]
    Truncated {
        /// What its header says.
        claimed: u32,
        /// Whole triangles in it.
        held: u32,
    },
    /// Too short to be a file of its kind.
    #[error("the file has {length} bytes; a binary STL file has at least 84")]
    TooShort {
        /// Its length.
        length: usize,
    },
    /// A text STL file breaks its grammar.
    #[error("expected {expected}, found {}", if found.is_empty() { "the end of the file".to_owned() } else { format!("`{found}`") })]
    Unexpected {
        /// Where.
        line: u32,
        /// What the grammar asks for.
        expected: &'static str,
        /// What stands there, empty at the end of the file.
        found: String,
    },
    /// More of something than 32-bit indices can count.
    #[error("the file holds more than {limit} {what}")]
    TooMany {
        /// For example `faces`.
        what: &'static str,
        /// The limit.
        limit: u32,
    },
    /// A Quake II model that is none.
    #[error(transparent)]
    Md2(#[from] Md2Fault),
    /// A Quake III model that is none.
    #[error(transparent)]
    Md3(#[from] Md3Fault),
    /// A Doom 3 model that is none.
    #[error(transparent)]
    Md5(#[from] Md5Fault),
    /// A drawing that is none.
    #[error(transparent)]
    Dxf(#[from] DxfFault),
    /// A 3D Studio scene that is none.
    #[error(transparent)]
    Studio(#[from] StudioFault),
    /// A glTF file that is none.
    #[error(transparent)]
    Gltf(#[from] GltfFault),
    /// A PLY file that is none.
    #[error(transparent)]
    Ply(#[from] PlyFault),
    /// The OBJ parser refused a text that passed every check of ours.
    #[error("the OBJ parser refused the file: {reason}")]
    Refused {
        /// Its reason.
        reason: String,
    },
}

impl ImportError {
    /// What to do about it.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Self::Foreign(foreign) => foreign.hint.to_owned(),
            Self::Binary { .. } => {
                "OBJ files are text; Wavefront's binary form (`.mod`) must be exported again as text OBJ"
                    .to_owned()
            }
            Self::Utf16 => "save the file as UTF-8".to_owned(),
            Self::BadNumber { text, .. } if text.contains(',') => {
                "write decimals with a point, not a comma".to_owned()
            }
            Self::BadNumber { .. }
            | Self::TooFewNumbers { .. }
            | Self::BadCorner { .. }
            | Self::Md5(_)
            | Self::Dxf(_) => "the file is damaged here; export it again".to_owned(),
            Self::NotFinite { .. } | Self::FacetNotFinite { .. } => {
                "the program that wrote the file divided by zero; repair the vertex there".to_owned()
            }
            Self::IndexZero { .. } => "the first vertex has index 1, the last one -1".to_owned(),
            Self::IndexOutOfRange { .. } => "the file is cut off or damaged; export it again".to_owned(),
            Self::NoFaces { .. } => "export the mesh with its faces, not only points or curves".to_owned(),
            Self::UnknownGroup { known, .. } if known.is_empty() => {
                "the file names no groups; leave `group` out".to_owned()
            }
            Self::UnknownGroup { known, .. } => format!("its groups are: {}", list_names(known)),
            Self::EmptyGroup { .. } => "leave `group` out, or name a group with faces".to_owned(),
            _ if self.is_foreign() => "let its name end as those of its format do".to_owned(),
            Self::Gltf(GltfFault::Extension(_)) => {
                "export it again without compression, or unpack it: `gltf-transform copy` writes plain files"
                    .to_owned()
            }
            Self::Gltf(GltfFault::File(..)) => {
                "files that it names stand beside it, inside the project".to_owned()
            }
            Self::Gltf(_) => "the file is damaged; the Khronos glTF validator tells more of it".to_owned(),
            Self::Ply(PlyFault::Places { .. }) => {
                "export the mesh again: its points need three coordinates".to_owned()
            }
            Self::Truncated { .. }
            | Self::TooShort { .. }
            | Self::Md2(_)
            | Self::Md3(_)
            | Self::Ply(_)
            | Self::Studio(_) => "the file is cut off; export it again".to_owned(),
            Self::Unexpected { .. } => {
                "the file is damaged here; export it again, as binary STL if you can".to_owned()
            }
            Self::TooMany { .. } => "split the file into parts".to_owned(),
            Self::Refused { .. } => "please report this file as a bug of Kiln".to_owned(),
        };
        Some(hint)
    }

    /// Whether the file does not begin as those of its format do.
    #[must_use]
    pub fn is_foreign(&self) -> bool {
        matches!(
            self,
            Self::Md2(Md2Fault::NotMd2)
                | Self::Md3(Md3Fault::NotMd3)
                | Self::Dxf(DxfFault::NotDxf)
                | Self::Studio(StudioFault::NotStudio)
        )
    }

    /// The line it stands on, where there is one.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        match *self {
            Self::Binary { line, .. }
            | Self::BadNumber { line, .. }
            | Self::NotFinite { line, .. }
            | Self::TooFewNumbers { line, .. }
            | Self::BadCorner { line, .. }
            | Self::IndexZero { line, .. }
            | Self::IndexOutOfRange { line, .. }
            | Self::Unexpected { line, .. } => Some(line),
            Self::Md5(ref fault) => fault.line(),
            Self::Dxf(ref fault) => fault.line(),
            _ => None,
        }
    }
}

/// The first names, so that a message stays readable.
fn list_names(names: &[String]) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
    let more = names.len().saturating_sub(SHOWN);
    if more > 0 { format!("{} and {more} more", shown.join(", ")) } else { shown.join(", ") }
}

/// At most this much of a strange token is quoted.
const QUOTED: usize = 40;

/// A token as it may stand in a message: short, without control characters.
pub(super) fn quoted(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(token);
    let mut short: String =
        text.chars().take(QUOTED).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(QUOTED).is_some() {
        short.push('…');
    }
    short
}

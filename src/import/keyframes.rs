//! Models of frames: one mesh with the places of its points in each, as Quake's formats hold them.
//!
//! Frames that follow each other and have one name but for a number are a sequence. Tags are places with axes, one for
//! each frame, where other models are held.

use glam::{DAffine3, DVec3};

use super::{Imported, MaterialLook};
use crate::geometry::mesh::PolygonMesh;

/// A file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keyframes {
    /// Faces over the points of the first frame.
    pub mesh: PolygonMesh,
    /// The frames, at least one, each with as many points and normals.
    pub frames: Vec<Frame>,
    /// Places that move with the frames.
    pub tags: Vec<Tag>,
    /// Names of its parts, also of those that were not read.
    pub groups: Vec<String>,
    /// What the materials of the mesh look like, as far as the file says; in the order of its names.
    pub materials: Vec<MaterialLook>,
    /// Paths of pictures that the file names for the whole.
    pub pictures: Vec<String>,
}

/// A frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Its name in the file.
    pub name: String,
    /// Its points, in the file's unit and axes.
    pub points: Vec<DVec3>,
    /// Its normals, in the order of those of the mesh; none where the file has none.
    pub normals: Vec<DVec3>,
}

/// A place that moves with the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Tag {
    /// Its name in the file.
    pub name: String,
    /// For each frame the map from its axes to the model's: a rotation, then a translation.
    pub places: Vec<DAffine3>,
}

/// The names and lengths of the sequences of a player in Quake II, in their order.
///
/// Source: id Software, Quake II source code, 2001, `m_player.h`.
pub const STANDARD: [(&str, usize); 21] = [
    ("stand", 40),
    ("run", 6),
    ("attack", 8),
    ("pain-a", 4),
    ("pain-b", 4),
    ("pain-c", 4),
    ("jump", 6),
    ("flip", 12),
    ("salute", 11),
    ("taunt", 17),
    ("wave", 11),
    ("point", 12),
    ("crouch-stand", 19),
    ("crouch-walk", 6),
    ("crouch-attack", 9),
    ("crouch-pain", 4),
    ("crouch-death", 5),
    ("death-fall-back", 6),
    ("death-fall-forward", 6),
    ("death-fall-back-slow", 8),
    ("boom", 1),
];

/// Frames of a player but for the last sequence, which few models have.
pub const STANDARD_FRAMES: usize = 198;

/// Frames of one sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    /// Its name.
    pub name: String,
    /// Numbers of its frames, from 0.
    pub frames: std::ops::Range<usize>,
}

impl Keyframes {
    /// The mesh in the state of a frame.
    #[must_use]
    pub fn at(&self, frame: usize) -> PolygonMesh {
        let Frame { points, normals, .. } = &self.frames[frame];
        PolygonMesh { points: points.clone(), normals: normals.clone(), ..self.mesh.clone() }
    }

    /// The model in the state of a frame.
    #[must_use]
    pub fn frame(self, frame: usize) -> Imported {
        let mesh = self.at(frame);
        Imported { mesh, materials: self.materials, groups: self.groups, notes: Vec::new() }
    }

    /// Frames that follow each other and have one name but for a number at its end. Of numbers of three digits the first
    /// belongs to the name: `death213` is the thirteenth frame of `death2`.
    #[must_use]
    pub fn sequences(&self) -> Vec<Sequence> {
        let mut all: Vec<Sequence> = Vec::new();
        for (number, frame) in self.frames.iter().enumerate() {
            let name = sequence_name(&frame.name);
            match all.last_mut().filter(|last| last.name == name) {
                Some(last) => last.frames.end = number + 1,
                None => all.push(Sequence { name, frames: number..number + 1 }),
            }
        }
        all
    }

    /// The sequences of a player in Quake II, by their places; none where there are other numbers of frames.
    #[must_use]
    pub fn standard_sequences(&self) -> Option<Vec<Sequence>> {
        let count = match self.frames.len() {
            STANDARD_FRAMES => STANDARD.len() - 1,
            length if length == STANDARD_FRAMES + 1 => STANDARD.len(),
            _ => return None,
        };
        let mut start = 0;
        let sequence = |(name, frames): &(&str, usize)| {
            let own = start..start + frames;
            start = own.end;
            Sequence { name: (*name).to_owned(), frames: own }
        };
        Some(STANDARD[..count].iter().map(sequence).collect())
    }
}

fn sequence_name(frame: &str) -> String {
    let name = frame.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &frame[name.len()..];
    match digits.parse::<u32>() {
        Ok(number) if digits.len() >= 3 && number >= 100 => format!("{name}{}", number / 100),
        _ => name.to_owned(),
    }
}

/// Text up to its first zero; what is no ASCII letter, digit or sign is a question mark.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    bytes[..end].iter().map(|byte| if byte.is_ascii_graphic() { char::from(*byte) } else { '?' }).collect()
}

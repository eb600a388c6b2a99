//! Doom 3 models (MD5): meshes with joints and weights (`.md5mesh`), and motions of such joints (`.md5anim`).
//!
//! Both are text of words, numbers, quoted names, braces and parentheses; two slashes begin a comment. A rotation is three
//! parts of a unit quaternion whose fourth is not positive. Joints of a mesh stand in the model's space, those of a
//! motion in their parents'. x looks forward, y to the left and z up.
//!
//! Promise: memory is taken for what stands in the text, not for what it announces; what is refused is refused with its
//! line. Source: id Software, Doom 3 source code, 2011, `Model_md5.cpp` and `Anim.cpp`.

pub mod animation;
pub mod mesh;
mod tokens;

use glam::{DQuat, DVec3};
use thiserror::Error;

use tokens::Tokens;

/// Why a file is no mesh or motion.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Md5Fault {
    /// Not text.
    #[error("this is not text")]
    NotText,
    /// Another word than what must stand there.
    #[error("expected {expected}, found `{found}`")]
    Expected {
        /// Line of the file, from 1.
        line: u32,
        /// What must stand there.
        expected: &'static str,
        /// What does.
        found: String,
    },
    /// The file ends too early.
    #[error("the file ends where {expected} must stand")]
    Ends {
        /// The last line.
        line: u32,
        /// What must stand there.
        expected: &'static str,
    },
    /// Another version of the format.
    #[error("this is version {version} of the format, and version 10 is read")]
    Version {
        /// Line of the file.
        line: u32,
        /// The version.
        version: u32,
    },
    /// What is no number.
    #[error("expected {what}, found `{found}`")]
    Number {
        /// Line of the file.
        line: u32,
        /// What it is for.
        what: &'static str,
        /// What stands there.
        found: String,
    },
    /// More or fewer than announced.
    #[error("the file announces {announced} {what} and has {found}")]
    Count {
        /// Line of the first that is too many, or of the end.
        line: u32,
        /// What is counted.
        what: &'static str,
        /// How many it says.
        announced: u32,
        /// How many there are.
        found: usize,
    },
    /// Rows that do not stand in their order.
    #[error("{what} {found} stands where {expected} must")]
    Order {
        /// Line of the file.
        line: u32,
        /// What is numbered.
        what: &'static str,
        /// Its number.
        found: u32,
        /// The number that is next.
        expected: usize,
    },
    /// A number of something that there is not.
    #[error("{what} {index} does not exist: there are {count}, counted from 0")]
    Index {
        /// Line of the file.
        line: u32,
        /// What is named.
        what: &'static str,
        /// Its number.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A joint before the one that carries it.
    #[error("joint `{joint}` is carried by joint {parent}, which does not stand before it")]
    Parent {
        /// Line of the file.
        line: u32,
        /// The joint.
        joint: String,
        /// Number of what should carry it.
        parent: i64,
    },
    /// A quaternion that is none.
    #[error("a rotation has parts from -1 to 1 whose squares add up to at most 1")]
    Rotation {
        /// Line of the file.
        line: u32,
    },
    /// A point that nothing carries.
    #[error("vertex {vertex} has no weight")]
    Bare {
        /// Line of the file.
        line: u32,
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A point that too much carries.
    #[error("vertex {vertex} has {count} weights, and at most {} are read", mesh::MOST_WEIGHTS)]
    Crowded {
        /// Line of the file.
        line: u32,
        /// The vertex, from 0.
        vertex: usize,
        /// How many it has.
        count: u32,
    },
    /// A motion that is too long.
    #[error("the motion has more than {} places of joints", animation::MOST_PLACES)]
    Long {
        /// Line of the frame that is too many.
        line: u32,
    },
}

impl Md5Fault {
    /// The line it stands on, where there is one.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        match *self {
            Self::NotText => None,
            Self::Expected { line, .. }
            | Self::Ends { line, .. }
            | Self::Version { line, .. }
            | Self::Number { line, .. }
            | Self::Count { line, .. }
            | Self::Order { line, .. }
            | Self::Index { line, .. }
            | Self::Parent { line, .. }
            | Self::Rotation { line }
            | Self::Long { line }
            | Self::Bare { line, .. }
            | Self::Crowded { line, .. } => Some(line),
        }
    }
}

/// A joint of a mesh or a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Md5Joint {
    /// Its name.
    pub name: String,
    /// Index of its parent, which stands before it.
    pub parent: Option<usize>,
}

/// Where a joint is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its place, in the file's unit.
    pub translation: DVec3,
    /// Its axes.
    pub rotation: DQuat,
}

/// The lines that both kinds of files begin with.
fn version(tokens: &mut Tokens<'_>) -> Result<(), Md5Fault> {
    tokens.word("MD5Version", "`MD5Version`")?;
    let version = tokens.count("the version")?;
    if version != 10 {
        return Err(Md5Fault::Version { line: tokens.line(), version });
    }
    if tokens.is_next("commandline") {
        tokens.word("commandline", "`commandline`")?;
        tokens.name("the command line")?;
    }
    Ok(())
}

/// A name with the number of what carries it, -1 for nothing.
fn joint(tokens: &mut Tokens<'_>, before: usize) -> Result<Md5Joint, Md5Fault> {
    let name = tokens.name("the name of a joint")?;
    let parent = tokens.whole("the number of a parent")?;
    let found = usize::try_from(parent).ok().filter(|parent| *parent < before);
    if found.is_none() && parent != -1 {
        return Err(Md5Fault::Parent { line: tokens.line(), joint: name, parent });
    }
    Ok(Md5Joint { name, parent: found })
}

/// A place and a rotation, each in parentheses.
fn place(tokens: &mut Tokens<'_>) -> Result<Place, Md5Fault> {
    let translation = DVec3::from_array(tokens.numbers("a coordinate")?);
    let rotation = rotation(tokens.numbers("a part of a rotation")?, tokens.line())?;
    Ok(Place { translation, rotation })
}

/// The unit quaternion of its first three parts.
fn rotation([x, y, z]: [f64; 3], line: u32) -> Result<DQuat, Md5Fault> {
    let rest = 1.0 - (x * x + y * y + z * z);
    // Parts are written with few digits.
    if rest.is_nan() || rest < -1e-3 {
        return Err(Md5Fault::Rotation { line });
    }
    Ok(DQuat::from_xyzw(x, y, z, -rest.max(0.0).sqrt()).normalize())
}

#[cfg(test)]
mod tests;

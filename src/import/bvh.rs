//! Skeletons and motions of BVH files (Biovision hierarchy).
//!
//! A joint has an offset from its parent, in axes that are those of the file at rest, and channels; a frame has one
//! number for each channel. A joint's own rotation is the product of its rotation channels in their order, its place the
//! offset and its position channels added. End sites are tails of bones.
//!
//! Promise: no more memory is taken than the text is long; every frame has as many numbers as there are channels; what
//! is refused is refused with its line. Source: M. Meredith, S. Maddock, Motion capture file formats explained,
//! University of Sheffield, 2001.

use thiserror::Error;

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Joints, parents first.
    pub joints: Vec<BvhJoint>,
    /// Seconds from frame to frame, greater than 0.
    pub frame_time: f64,
    /// The frames, each with a number for every channel.
    pub frames: Vec<Vec<f64>>,
}

/// A joint of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct BvhJoint {
    /// Its name.
    pub name: String,
    /// Index of its parent.
    pub parent: Option<usize>,
    /// From its parent, in the file's unit.
    pub offset: [f64; 3],
    /// The end of its bone, from its own place, where an end site says so.
    pub end: Option<[f64; 3]>,
    /// Its channels in their order.
    pub channels: Vec<Channel>,
    /// Where its numbers begin in a frame.
    pub first: usize,
}

/// What a number of a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// A place along x, y or z (0, 1, 2).
    Position(usize),
    /// Degrees about x, y or z (0, 1, 2).
    Rotation(usize),
}

/// Why a file is no motion.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BvhFault {
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
    /// Not a finite number.
    #[error("expected a number for {what}, found `{found}`")]
    Number {
        /// Line of the file.
        line: u32,
        /// What it is for.
        what: &'static str,
        /// What stands there.
        found: String,
    },
    /// A channel twice in one joint.
    #[error("joint `{joint}` has the channel {channel} twice")]
    Twice {
        /// Line of the file.
        line: u32,
        /// The joint.
        joint: String,
        /// The channel.
        channel: String,
    },
    /// More or fewer frames than announced.
    #[error("the file announces {announced} frames and has {found}")]
    Frames {
        /// Line of the announcement.
        line: u32,
        /// How many it says.
        announced: u64,
        /// How many there are.
        found: u64,
    },
    /// A frame with another number of numbers than there are channels.
    #[error("frame {frame} has {found} numbers, and the joints have {channels} channels")]
    Width {
        /// Line of the frame.
        line: u32,
        /// Which frame, from 1.
        frame: u64,
        /// How many numbers it has.
        found: usize,
        /// How many it needs.
        channels: usize,
    },
    /// Braces within braces without end.
    #[error("joints are nested more than {0} deep")]
    Deep(usize),
}

/// The deepest nesting.
const DEEPEST: usize = 256;
/// The greatest number by size, as in documents.
const GREATEST: f64 = 1e15;

impl BvhFault {
    /// The line, where there is one.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        match self {
            Self::NotText | Self::Deep(_) => None,
            Self::Expected { line, .. }
            | Self::Ends { line, .. }
            | Self::Number { line, .. }
            | Self::Twice { line, .. }
            | Self::Frames { line, .. }
            | Self::Width { line, .. } => Some(*line),
        }
    }
}

/// Reads a file. O(length of the text).
///
/// # Errors
/// See [`BvhFault`].
pub fn read(bytes: &[u8]) -> Result<Bvh, BvhFault> {
    let text = std::str::from_utf8(bytes).map_err(|_| BvhFault::NotText)?;
    let mut words = Words::new(text.strip_prefix('\u{feff}').unwrap_or(text));
    words.word("HIERARCHY", "`HIERARCHY`")?;
    words.word("ROOT", "`ROOT`")?;
    let mut joints = Vec::new();
    hierarchy(&mut words, &mut joints)?;
    words.word("MOTION", "`MOTION`")?;
    words.word("Frames:", "`Frames:`")?;
    let line = words.line;
    let announced = words.number("the number of frames")?;
    words.word("Frame", "`Frame Time:`")?;
    words.word("Time:", "`Frame Time:`")?;
    let frame_time = words.number("the time of a frame")?;
    if frame_time <= 0.0 {
        let found = frame_time.to_string();
        return Err(BvhFault::Number { line: words.line, what: "the time of a frame, above 0", found });
    }
    let channels = joints.iter().map(|joint: &BvhJoint| joint.channels.len()).sum();
    let frames = frames(&words, channels)?;
    let whole = crate::geometry::number::floor_large(announced);
    if whole != frames.len() as u64 || frames.is_empty() {
        return Err(BvhFault::Frames { line, announced: whole, found: frames.len() as u64 });
    }
    Ok(Bvh { joints, frame_time, frames })
}

/// The joints of the tree whose root's name comes next.
fn hierarchy(words: &mut Words<'_>, joints: &mut Vec<BvhJoint>) -> Result<(), BvhFault> {
    let mut open = vec![joint(words, joints, None)?];
    while let Some(parent) = open.last().copied() {
        match words.next("`JOINT`, `End Site` or `}`")? {
            "}" => {
                open.pop();
            }
            "JOINT" => {
                if open.len() >= DEEPEST {
                    return Err(BvhFault::Deep(DEEPEST));
                }
                open.push(joint(words, joints, Some(parent))?);
            }
            "End" => {
                words.word("Site", "`End Site`")?;
                words.word("{", "`{`")?;
                words.word("OFFSET", "`OFFSET`")?;
                joints[parent].end = Some(words.point()?);
                words.word("}", "`}`")?;
            }
            other => return Err(words.unexpected("`JOINT`, `End Site` or `}`", other)),
        }
    }
    Ok(())
}

/// A joint up to its children; its index.
fn joint(
    words: &mut Words<'_>,
    joints: &mut Vec<BvhJoint>,
    parent: Option<usize>,
) -> Result<usize, BvhFault> {
    let name = words.next("the name of a joint")?.to_owned();
    words.word("{", "`{`")?;
    words.word("OFFSET", "`OFFSET`")?;
    let offset = words.point()?;
    words.word("CHANNELS", "`CHANNELS`")?;
    let count = words.number("the number of channels")?;
    if !(0.0..=6.0).contains(&count) || count.fract() != 0.0 {
        let found = count.to_string();
        return Err(BvhFault::Number {
            line: words.line,
            what: "the number of channels, from 0 to 6",
            found,
        });
    }
    let mut channels = Vec::new();
    for _ in 0..crate::geometry::number::floor_count(count) {
        let word = words.next("a channel such as `Zrotation`")?;
        let axis = match word.as_bytes().first() {
            Some(b'X') => 0,
            Some(b'Y') => 1,
            Some(b'Z') => 2,
            _ => return Err(words.unexpected("a channel such as `Zrotation`", word)),
        };
        let channel = match &word[1..] {
            "position" => Channel::Position(axis),
            "rotation" => Channel::Rotation(axis),
            _ => return Err(words.unexpected("a channel such as `Zrotation`", word)),
        };
        if channels.contains(&channel) {
            return Err(BvhFault::Twice { line: words.line, joint: name, channel: word.to_owned() });
        }
        channels.push(channel);
    }
    let first = joints.last().map_or(0, |last| last.first + last.channels.len());
    joints.push(BvhJoint { name, parent, offset, end: None, channels, first });
    Ok(joints.len() - 1)
}

/// The lines that follow, a frame each.
fn frames(words: &Words<'_>, channels: usize) -> Result<Vec<Vec<f64>>, BvhFault> {
    let mut frames: Vec<Vec<f64>> = Vec::new();
    let lines = words.rest.lines().zip(words.line..);
    for (text, line) in lines.filter(|(text, _)| !text.trim().is_empty()) {
        let number = |word: &str| number(word, line, "a channel");
        let frame: Result<Vec<f64>, BvhFault> = text.split_whitespace().map(number).collect();
        let frame = frame?;
        if frame.len() != channels {
            let count = frames.len() as u64 + 1;
            return Err(BvhFault::Width { line, frame: count, found: frame.len(), channels });
        }
        frames.push(frame);
    }
    Ok(frames)
}

fn number(word: &str, line: u32, what: &'static str) -> Result<f64, BvhFault> {
    let found = word.parse::<f64>().ok().filter(|number| number.abs() <= GREATEST);
    found.ok_or_else(|| BvhFault::Number { line, what, found: short(word) })
}

/// A word for a message, cut when it is long.
fn short(word: &str) -> String {
    word.chars().take(40).flat_map(char::escape_default).collect()
}

/// The words of a text, one after the other.
struct Words<'t> {
    rest: &'t str,
    /// The line of the word that was read last.
    line: u32,
}

impl<'t> Words<'t> {
    fn new(text: &'t str) -> Self {
        Self { rest: text, line: 1 }
    }

    fn next(&mut self, expected: &'static str) -> Result<&'t str, BvhFault> {
        let start = self.rest.find(|letter: char| !letter.is_whitespace());
        let Some(start) = start else { return Err(BvhFault::Ends { line: self.line, expected }) };
        let lines = self.rest[..start].matches('\n').count();
        self.line = self.line.saturating_add(u32::try_from(lines).unwrap_or(u32::MAX));
        let text = &self.rest[start..];
        let end = text.find(char::is_whitespace).unwrap_or(text.len());
        self.rest = &text[end..];
        Ok(&text[..end])
    }

    fn word(&mut self, word: &str, expected: &'static str) -> Result<(), BvhFault> {
        let found = self.next(expected)?;
        if found == word { Ok(()) } else { Err(self.unexpected(expected, found)) }
    }

    fn number(&mut self, what: &'static str) -> Result<f64, BvhFault> {
        let word = self.next(what)?;
        number(word, self.line, what)
    }

    fn point(&mut self) -> Result<[f64; 3], BvhFault> {
        Ok([self.number("an offset")?, self.number("an offset")?, self.number("an offset")?])
    }

    fn unexpected(&self, expected: &'static str, found: &str) -> BvhFault {
        BvhFault::Expected { line: self.line, expected, found: short(found) }
    }
}

#[cfg(test)]
mod tests;

//! Motions of joints (`.md5anim`).
//!
//! Each joint has a place in its parent's space in the base frame; a frame gives anew those of its six numbers that the
//! joint's flags name.

use super::tokens::Tokens;
use super::{Md5Fault, Md5Joint, Place, joint, place, rotation, version};

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Md5Animation {
    /// The joints, parents first.
    pub joints: Vec<Md5Joint>,
    /// Frames a second, greater than 0.
    pub frame_rate: f64,
    /// For each frame the place of each joint in its parent's space.
    pub frames: Vec<Vec<Place>>,
}

/// Which numbers of a joint move, and where they begin in a frame.
struct Moved {
    flags: u32,
    first: usize,
}

/// The most places of joints in all frames: a frame that moves nothing has one of each joint all the same.
pub const MOST_PLACES: usize = 4_000_000;

/// Reads a file. Linear in its length, times the joints for frames that move few of them.
///
/// # Errors
/// See [`Md5Fault`].
pub fn read(bytes: &[u8]) -> Result<Md5Animation, Md5Fault> {
    let mut tokens = Tokens::new(bytes)?;
    version(&mut tokens)?;
    let mut header = |word: &str, expected: &'static str| {
        tokens.word(word, expected)?;
        tokens.count("a whole number")
    };
    let frames = header("numFrames", "`numFrames`")?;
    let announced = header("numJoints", "`numJoints`")?;
    let frame_rate = f64::from(header("frameRate", "`frameRate`")?);
    let numbers = header("numAnimatedComponents", "`numAnimatedComponents`")?;
    if frame_rate <= 0.0 {
        let found = "0".to_owned();
        return Err(Md5Fault::Number { line: tokens.line(), what: "a frame rate above 0", found });
    }
    let (joints, moved) = hierarchy(&mut tokens, announced, numbers as usize)?;
    skip_bounds(&mut tokens)?;
    let base = base(&mut tokens, announced)?;
    let mut found = Vec::new();
    while !tokens.is_done() {
        if (found.len() + 1) * joints.len() > MOST_PLACES {
            return Err(Md5Fault::Long { line: tokens.line() });
        }
        found.push(frame(&mut tokens, (&base, &moved), (found.len(), numbers))?);
    }
    tokens.counted("frames", frames, found.len())?;
    if found.is_empty() {
        return Err(Md5Fault::Ends { line: tokens.line(), expected: "a frame" });
    }
    Ok(Md5Animation { joints, frame_rate, frames: found })
}

fn hierarchy(
    tokens: &mut Tokens<'_>,
    announced: u32,
    numbers: usize,
) -> Result<(Vec<Md5Joint>, Vec<Moved>), Md5Fault> {
    tokens.word("hierarchy", "`hierarchy`")?;
    tokens.word("{", "`{`")?;
    let (mut joints, mut moved) = (Vec::new(), Vec::new());
    while !tokens.is_next("}") {
        joints.push(joint(tokens, joints.len())?);
        let flags = tokens.index("flags", 64)?;
        let first = tokens.count("the first number of a joint")?;
        let own = Moved { flags: u32::try_from(flags).unwrap_or(0), first: first as usize };
        let end = own.first.saturating_add(own.flags.count_ones() as usize);
        if own.flags != 0 && end > numbers {
            let index = u32::try_from(end - 1).unwrap_or(u32::MAX);
            return Err(Md5Fault::Index {
                line: tokens.line(),
                what: "animated component",
                index,
                count: numbers,
            });
        }
        moved.push(own);
    }
    tokens.word("}", "`}`")?;
    tokens.counted("joints", announced, joints.len())?;
    Ok((joints, moved))
}

fn skip_bounds(tokens: &mut Tokens<'_>) -> Result<(), Md5Fault> {
    if !tokens.is_next("bounds") {
        return Ok(());
    }
    tokens.word("bounds", "`bounds`")?;
    tokens.word("{", "`{`")?;
    while !tokens.is_next("}") {
        tokens.numbers::<3>("a coordinate")?;
    }
    tokens.word("}", "`}`")
}

fn base(tokens: &mut Tokens<'_>, announced: u32) -> Result<Vec<Place>, Md5Fault> {
    tokens.word("baseframe", "`baseframe`")?;
    tokens.word("{", "`{`")?;
    let mut base = Vec::new();
    while !tokens.is_next("}") {
        base.push(place(tokens)?);
    }
    tokens.word("}", "`}`")?;
    tokens.counted("places of the base frame", announced, base.len())?;
    Ok(base)
}

fn frame(
    tokens: &mut Tokens<'_>,
    (base, moved): (&[Place], &[Moved]),
    (number, count): (usize, u32),
) -> Result<Vec<Place>, Md5Fault> {
    tokens.word("frame", "`frame`")?;
    tokens.ordered("frame", number)?;
    tokens.word("{", "`{`")?;
    let mut numbers = Vec::new();
    while !tokens.is_next("}") {
        numbers.push(tokens.number("a number of the frame")?);
    }
    tokens.word("}", "`}`")?;
    tokens.counted("numbers of a frame", count, numbers.len())?;
    let own = |(base, moved): (&Place, &Moved)| {
        let mut next = moved.first;
        let mut parts = [base.translation.x, base.translation.y, base.translation.z, 0.0, 0.0, 0.0];
        let turned = if base.rotation.w > 0.0 { -base.rotation } else { base.rotation };
        parts[3..].copy_from_slice(&[turned.x, turned.y, turned.z]);
        for (bit, part) in parts.iter_mut().enumerate() {
            if moved.flags & (1 << bit) != 0 {
                *part = numbers[next];
                next += 1;
            }
        }
        let [x, y, z, a, b, c] = parts;
        let rotation =
            if moved.flags >> 3 == 0 { base.rotation } else { rotation([a, b, c], tokens.line())? };
        Ok(Place { translation: glam::DVec3::new(x, y, z), rotation })
    };
    base.iter().zip(moved).map(own).collect()
}

//! Values of arguments, from how they are written to what they mean.

use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::arguments::Shard;
use crate::gltf::Profile;
use crate::language::spec::parse_bytes;
use crate::preview::View;
use crate::preview::heat::Heat;

pub(super) fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE, as in `height=0.3`".to_owned()),
    }
}

pub(super) fn shard(text: &str) -> Result<Shard, String> {
    let shard = text.split_once('/').and_then(|(number, of)| {
        Some(Shard { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? })
    });
    let whole = |shard: &Shard| (1..=shard.of).contains(&shard.number);
    shard.filter(whole).ok_or_else(|| "a part is written as `1/4`, from 1/4 to 4/4".to_owned())
}

pub(super) fn bytes(text: &str) -> Result<u64, String> {
    parse_bytes(text).ok_or_else(|| "a size is written as `500 MB` or `2 GB`".to_owned())
}

pub(super) fn profile(text: &str) -> Result<Profile, String> {
    let names: Vec<&str> = Profile::NAMED.iter().map(|(name, _)| *name).collect();
    Profile::named(text).ok_or_else(|| format!("write one of {}", names.join(", ")))
}

pub(super) fn heat(text: &str) -> Result<Heat, String> {
    let wrong = || "write deviation, curvature, uv-stretch, texel-density, or weights:JOINT".to_owned();
    Heat::named(text).ok_or_else(wrong)
}

pub(super) fn view(text: &str) -> Result<View, String> {
    if let Some((_, view)) = View::NAMED.iter().find(|(name, _)| *name == text) {
        return Ok(*view);
    }
    let wrong = || {
        let names: Vec<&str> = View::NAMED.iter().map(|(name, _)| *name).collect();
        format!("write {}, or AZIMUTH,ELEVATION in degrees, as in `30,20`", names.join(", "))
    };
    let (azimuth, elevation) = text.split_once(',').ok_or_else(wrong)?;
    let number =
        |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(wrong);
    let (azimuth, elevation) = (number(azimuth)?, number(elevation)?);
    if !(-90.0..=90.0).contains(&elevation) {
        return Err(format!("the elevation {elevation} lies outside -90 to 90 degrees"));
    }
    Ok(View { azimuth, elevation })
}

pub(super) fn pixels(text: &str) -> Result<(u32, u32), String> {
    const MOST: u32 = 8192;
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    let number = |text: &str| {
        let number: u32 = text.trim().parse().map_err(|_| format!("`{text}` is not a number of pixels"))?;
        if (1..=MOST).contains(&number) {
            Ok(number)
        } else {
            Err(format!("write 1 to {MOST} pixels, not {number}"))
        }
    };
    Ok((number(width)?, number(height)?))
}

/// A choice of the language by its word.
pub(super) fn words<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    text: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let known = PossibleValuesParser::new(all.iter().map(|&choice| text(choice)));
    known.try_map(move |word| all.iter().copied().find(|&choice| text(choice) == word).ok_or("unknown word"))
}

pub(super) fn distance(text: &str) -> Result<f64, String> {
    let distance: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a distance"))?;
    if distance.is_finite() && distance >= 0.0 {
        Ok(distance)
    } else {
        Err("write a distance of 0 or more".to_owned())
    }
}

pub(super) fn length(text: &str) -> Result<f64, String> {
    let length: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a length"))?;
    if length.is_finite() && length > 0.0 { Ok(length) } else { Err("write a length above 0".to_owned()) }
}

pub(super) fn background(text: &str) -> Result<[u8; 4], String> {
    if text == "transparent" {
        return Ok([0; 4]);
    }
    let wrong = || format!("write a color like #e6e8ec, or `transparent`, not `{text}`");
    let digits =
        text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii()).ok_or_else(wrong)?;
    let number = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
    let [_, r, g, b] = number.to_be_bytes();
    Ok([r, g, b, 255])
}

pub(super) fn timeout(text: &str) -> Result<f64, String> {
    let time = seconds(text)?;
    if (0.1..=600.0).contains(&time) { Ok(time) } else { Err("write 0.1 to 600 seconds".to_owned()) }
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let time: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number of seconds"))?;
    if time.is_finite() && time >= 0.0 { Ok(time) } else { Err("write 0 or more seconds".to_owned()) }
}

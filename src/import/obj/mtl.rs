//! Material libraries: the little of them that says how a material looks.

use crate::import::image::Edge;
use crate::import::look::{MaterialLook, Picture};

/// Materials of a library that stands in a folder, empty or ending with `/`. Anything that is not understood is passed over: a library never spoils its mesh.
pub(super) fn read(bytes: &[u8], folder: &str) -> Vec<MaterialLook> {
    let mut looks: Vec<MaterialLook> = Vec::new();
    let text = String::from_utf8_lossy(bytes);
    for line in text.trim_start_matches('\u{feff}').lines() {
        let (keyword, rest) = line.trim().split_once(char::is_whitespace).unwrap_or_default();
        let rest = rest.trim();
        if keyword == "newmtl" {
            looks.push(MaterialLook { name: rest.to_owned(), ..MaterialLook::default() });
            continue;
        }
        let Some(look) = looks.last_mut() else { continue };
        match keyword {
            "Kd" => look.color = color(rest),
            "d" => look.opacity = part(rest.trim_start_matches("-halo")),
            "Tr" => look.opacity = part(rest).map(|transparency| 1.0 - transparency),
            "Ke" => look.emissive = color(rest),
            "Pm" => look.metallic = part(rest),
            "Pr" => look.roughness = part(rest),
            "map_Kd" => look.pictures.color = picture(folder, rest),
            "map_Ke" => look.pictures.emissive = picture(folder, rest),
            "norm" => look.pictures.normal = picture(folder, rest).map(|picture| (picture, 1.0)),
            _ => {}
        }
    }
    for look in &mut looks {
        look.blends = look.opacity.is_some_and(|opacity| opacity < 1.0);
        // A picture whose color is not written shows as it is.
        if look.pictures.color.is_some() {
            look.color = look.color.or(Some([1.0; 3]));
        }
    }
    looks
}

/// A picture with the options before its path. One that is moved or scaled is left out: textures lie as they are.
fn picture(folder: &str, line: &str) -> Option<Picture> {
    let mut edge = Edge::Repeat;
    let mut rest = line;
    while let Some(option) = rest.strip_prefix('-') {
        let (name, after) = option.split_once(char::is_whitespace)?;
        let mut after = after.trim_start();
        let mut word = || {
            let (word, next) = after.split_once(char::is_whitespace)?;
            after = next.trim_start();
            Some(word)
        };
        match name {
            "clamp" => edge = if word()? == "on" { Edge::Clamp } else { Edge::Repeat },
            "blendu" | "blendv" | "cc" | "bm" | "boost" | "texres" | "imfchan" | "type" => {
                word()?;
            }
            "mm" => {
                word()?;
                word()?;
            }
            "o" | "s" | "t" => {
                let still = if name == "s" { 1.0 } else { 0.0 };
                loop {
                    let next = after.split_once(char::is_whitespace);
                    let Some((Ok(value), next)) = next.map(|(word, next)| (word.parse::<f64>(), next)) else {
                        break;
                    };
                    if value != still {
                        return None;
                    }
                    after = next.trim_start();
                }
            }
            _ => return None,
        }
        rest = after;
    }
    let inside = !rest.starts_with(['/', '\\']) && !rest.contains(':');
    let path = if inside { format!("{folder}{rest}") } else { rest.to_owned() };
    (!rest.is_empty()).then(|| Picture { edge, ..Picture::file(path) })
}

/// A number from 0 to 1.
fn part(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|part: &f64| part.is_finite()).map(|part| part.clamp(0.0, 1.0))
}

fn color(text: &str) -> Option<[f64; 3]> {
    let mut parts = text.split_whitespace().map(part);
    let red = parts.next()??;
    // One number alone is a grey.
    match (parts.next(), parts.next()) {
        (Some(green), Some(blue)) => Some([red, green?, blue?]),
        _ => Some([red; 3]),
    }
}

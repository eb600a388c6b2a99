//! Material libraries: the little of them that says how a material looks.

use crate::import::MaterialLook;

/// Materials of a library. Anything that is not understood is passed over: a library never spoils its mesh.
pub(super) fn read(bytes: &[u8]) -> Vec<MaterialLook> {
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
            // Options such as `-s 1 1 1` stand before the path.
            "map_Kd" if !rest.starts_with('-') && !rest.is_empty() => look.texture = Some(rest.to_owned()),
            _ => {}
        }
    }
    looks
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

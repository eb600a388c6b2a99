//! "Did you mean": the nearest of the names that would be right.

use strsim::damerau_levenshtein;

/// Names longer than this are not compared: the cost grows with the product of the lengths.
const LONGEST: usize = 64;

/// The name nearest to `wrong`, where it is near: at most a third of its letters differ, or it is the same
/// but for case, `_` and `-`. The first of equals.
#[must_use]
pub fn closest<'n>(wrong: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let letters = wrong.chars().count();
    if letters > LONGEST {
        return None;
    }
    let plain = normal(wrong);
    // Of one or two letters nothing is left to recognize when one is wrong.
    let allowed = if letters < 3 { 0 } else { letters / 3 };
    let distance = |name: &str| {
        if normal(name) == plain { 0 } else { damerau_levenshtein(wrong, name) }
    };
    names
        .filter(|name| name.len() <= LONGEST * 4)
        .map(|name| (distance(name), name))
        .filter(|(distance, name)| *distance <= allowed && *distance < name.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

fn normal(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::closest;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let names = ["segments", "smoothing", "radius"];
        assert_eq!(closest("segmnts", names.into_iter()), Some("segments"));
        assert_eq!(closest("Radius", names.into_iter()), Some("radius"));
        assert_eq!(closest("height", names.into_iter()), None);
        assert_eq!(closest("y", ["x"].into_iter()), None);
        assert_eq!(closest("crease_angle", ["crease-angle"].into_iter()), Some("crease-angle"));
    }
}

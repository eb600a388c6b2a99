//! Tags of subdivision: `t crease 2/1/0 A B SHARPNESS`, `t corner 1/1/0 A SHARPNESS`. After the name stand the numbers of
//! whole numbers, of real numbers and of words that follow. Vertices count from 0.
//!
//! Source: Pixar, `OpenSubdiv`, 2013, `regression/common/shape_utils.cpp`, whose tags are those of the `RenderMan` Interface
//! Specification, version 3.2, 2005 (`SubdivisionMesh`).

/// What a tag says.
#[derive(Debug, PartialEq)]
pub(super) enum Tag {
    /// Edges from vertex to vertex, each with its sharpness.
    Crease(Vec<([u32; 2], f64)>),
    /// Vertices, each with its sharpness.
    Corner(Vec<(u32, f64)>),
    /// Something else.
    Other,
}

/// Reads what stands after `t`; none where it is broken.
pub(super) fn tag<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<Tag> {
    let mut text = || words.next().and_then(|word| std::str::from_utf8(word).ok());
    let name = text()?;
    if !matches!(name, "crease" | "corner") {
        return Some(Tag::Other);
    }
    let mut counts = text()?.split('/').map(|count| count.parse::<usize>().ok());
    let (vertices, numbers) = (counts.next()??, counts.next()??);
    let vertices: Vec<u32> =
        (0..vertices).map_while(|_| Some(text()?.parse())).collect::<Result<_, _>>().ok()?;
    let numbers: Vec<f64> =
        (0..numbers).map_while(|_| Some(text()?.parse())).collect::<Result<_, _>>().ok()?;
    let sharp = numbers.iter().all(|sharpness| sharpness.is_finite() && *sharpness >= 0.0);
    let items = if name == "crease" { vertices.len().checked_sub(1)? } else { vertices.len() };
    if !sharp || items == 0 || !(numbers.len() == 1 || numbers.len() == items) {
        return None;
    }
    let sharpness = |item: usize| numbers[item.min(numbers.len() - 1)];
    Some(if name == "crease" {
        let edges = vertices.windows(2).enumerate();
        Tag::Crease(edges.map(|(item, ends)| ([ends[0], ends[1]], sharpness(item))).collect())
    } else {
        Tag::Corner(vertices.iter().enumerate().map(|(item, vertex)| (*vertex, sharpness(item))).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::{Tag, tag};

    fn read(text: &str) -> Option<Tag> {
        tag(text.split_whitespace().map(str::as_bytes))
    }

    #[test]
    fn creases_and_corners_are_read() {
        assert_eq!(read("crease 2/1/0 3 4 2.5"), Some(Tag::Crease(vec![([3, 4], 2.5)])));
        assert_eq!(read("crease 3/2/0 0 1 2 1 10"), Some(Tag::Crease(vec![([0, 1], 1.0), ([1, 2], 10.0)])));
        assert_eq!(read("crease 3/1/0 0 1 2 4"), Some(Tag::Crease(vec![([0, 1], 4.0), ([1, 2], 4.0)])));
        assert_eq!(read("corner 2/1/0 7 9 10"), Some(Tag::Corner(vec![(7, 10.0), (9, 10.0)])));
        assert_eq!(read("interpolateboundary 1/0/0 2"), Some(Tag::Other));
    }

    #[test]
    fn broken_tags_are_none() {
        for text in [
            "",
            "crease",
            "crease 2",
            "crease 2/1/0",
            "crease 2/1/0 3 4",
            "crease 2/1/0 3 4 x",
            "crease 2/1/0 -3 4 1",
            "crease 1/1/0 3 1",
            "crease 0/1/0 1",
            "corner 1/1/0 3 nan",
            "corner 1/1/0 3 -1",
            "corner 0/1/0 1",
            "crease 4/2/0 0 1 2 3 1 1",
            "crease 99999999999/1/0 1 2 3",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}

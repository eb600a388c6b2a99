//! Which loops are outlines, and which holes lie in them.

use glam::DVec2;

use super::{distance_to_segment, encloses, twice_area};

/// Loops sorted into outlines with their holes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Regions {
    /// For each outline, in order: its loop, then the loops of its holes.
    pub faces: Vec<Vec<usize>>,
    /// Loops that run like holes but lie in no outline.
    pub stray: Vec<usize>,
}

/// How far a hole may stand away from its outline, as a part of the hole's size: what rounded coordinates do.
const NEAR: f64 = 0.01;

/// Loops thinner than this part of the greatest coordinate have no area.
const ROUNDING: f64 = 1e-12;

/// Sorts loops by the way they turn: counter-clockwise ones are outlines, clockwise ones holes. A hole belongs to the
/// smallest outline that most of its corners lie in; where they all lie on one or just beyond it, to the nearest.
/// A loop without area, as far as rounded coordinates can tell, is an outline.
///
/// O(corners of outlines * corners of holes).
#[must_use]
pub fn regions(loops: &[&[DVec2]]) -> Regions {
    let reach = loops.concat().iter().fold(0.0, |reach, point| f64::max(reach, point.abs().max_element()));
    let area = |outline: &&[DVec2]| {
        let area = twice_area(outline);
        if area.abs() > ROUNDING * reach * size(outline) { area } else { 0.0 }
    };
    let areas: Vec<f64> = loops.iter().map(area).collect();
    let mut found = Regions::default();
    found.faces.extend((0..loops.len()).filter(|k| areas[*k] >= 0.0).map(|outline| vec![outline]));
    for hole in (0..loops.len()).filter(|k| areas[*k] < 0.0) {
        let around = |face: &Vec<usize>| {
            let outline = loops[face[0]];
            loops[hole].iter().filter(|corner| encloses(outline, **corner)).count()
        };
        let inside = |&k: &usize| 2 * around(&found.faces[k]) > loops[hole].len();
        let faces = 0..found.faces.len();
        let smallest = faces
            .clone()
            .filter(inside)
            .min_by(|a, b| areas[found.faces[*a][0]].total_cmp(&areas[found.faces[*b][0]]));
        let face = smallest.or_else(|| {
            let gap = |k: usize| gap(loops[hole], loops[found.faces[k][0]]);
            let nearest = faces.map(|k| (gap(k), k)).min_by(|a, b| a.0.total_cmp(&b.0))?;
            (nearest.0 <= NEAR * size(loops[hole])).then_some(nearest.1)
        });
        match face {
            Some(face) => found.faces[face].push(hole),
            None => found.stray.push(hole),
        }
    }
    found
}

/// How far the middle corner of a hole, by distance, stands from an outline; less than none when it is inside.
fn gap(hole: &[DVec2], outline: &[DVec2]) -> f64 {
    let mut gaps: Vec<f64> = hole
        .iter()
        .map(|corner| {
            let next = outline.iter().cycle().skip(1);
            let sides = outline.iter().zip(next).map(|(a, b)| distance_to_segment(*corner, [*a, *b]));
            let away = sides.fold(f64::INFINITY, f64::min);
            if encloses(outline, *corner) { -away } else { away }
        })
        .collect();
    gaps.sort_by(f64::total_cmp);
    gaps.get(hole.len() / 2).copied().unwrap_or(f64::INFINITY)
}

fn size(outline: &[DVec2]) -> f64 {
    let low = outline.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = outline.iter().copied().reduce(DVec2::max).unwrap_or_default();
    (high - low).length()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::regions;

    fn square(x: f64, y: f64, size: f64, hole: bool) -> Vec<DVec2> {
        let mut corners: Vec<DVec2> = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)]
            .map(|(a, b)| DVec2::new(x + a, y + b))
            .to_vec();
        if hole {
            corners.reverse();
        }
        corners
    }

    #[test]
    fn holes_belong_to_the_smallest_outline_around_them() {
        // An island in a lake: outline, hole, outline in the hole, hole in that.
        let loops = [
            square(0.0, 0.0, 10.0, false),
            square(1.0, 1.0, 8.0, true),
            square(2.0, 2.0, 6.0, false),
            square(3.0, 3.0, 1.0, true),
            square(20.0, 0.0, 1.0, false),
            square(-5.0, 0.0, 1.0, true),
        ];
        let slices: Vec<&[DVec2]> = loops.iter().map(Vec::as_slice).collect();
        let found = regions(&slices);
        assert_eq!(found.faces, [vec![0, 1], vec![2, 3], vec![4]]);
        assert_eq!(found.stray, [5]);
    }

    #[test]
    fn holes_on_their_outline_belong_to_it() {
        for shift in [0.0, 1e-9, -1e-9] {
            let loops = [square(0.0, 0.0, 1.0, false), square(shift, shift, 1.0, true)];
            let slices: Vec<&[DVec2]> = loops.iter().map(Vec::as_slice).collect();
            assert_eq!(regions(&slices).faces, [vec![0, 1]], "{shift}");
        }
    }
}

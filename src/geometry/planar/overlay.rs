//! Set operations on regions of the plane that polygons bound.
//!
//! The only module that calls the library that does them. Its engine of 64-bit integers lays coordinates on a grid of
//! about 2^-60 of their reach, so that positions keep the accuracy of a double.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::Solver;
use i_overlay::float::overlay::{FloatOverlay, OverlayOptions};

/// What is made of two regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetOperation {
    /// What lies in any of them.
    Union,
    /// What lies in the first and not in the second.
    Difference,
    /// What lies in both.
    Intersection,
    /// What lies in one alone.
    Xor,
}

/// What loops enclose, by how often they go around a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// An odd number of times.
    Odd,
    /// More often counter-clockwise than clockwise.
    Positive,
}

/// The boundary of what two sets of loops make: outlines counter-clockwise, holes clockwise, corners on straight lines
/// kept. Loops may cross themselves and each other.
///
/// Deterministic. O((n + k) log n) for n corners and k crossings.
#[must_use]
pub fn overlay(
    first: &[Vec<DVec2>],
    second: &[Vec<DVec2>],
    operation: SetOperation,
    winding: Winding,
) -> Vec<Vec<DVec2>> {
    let plain = |loops: &[Vec<DVec2>]| -> Vec<Vec<[f64; 2]>> {
        loops.iter().map(|corners| corners.iter().map(DVec2::to_array).collect()).collect()
    };
    let (first, second) = (plain(first), plain(second));
    let mut options = OverlayOptions::<f64, i64>::default();
    options.preserve_input_collinear = true;
    options.preserve_output_collinear = true;
    options.clean_result = false;
    let solver = Solver::default();
    let mut overlay =
        FloatOverlay::<[f64; 2], i64>::from_subj_and_clip_custom(&first, &second, options, solver);
    let rule = match operation {
        SetOperation::Union => OverlayRule::Union,
        SetOperation::Difference => OverlayRule::Difference,
        SetOperation::Intersection => OverlayRule::Intersect,
        SetOperation::Xor => OverlayRule::Xor,
    };
    let fill = match winding {
        Winding::Odd => FillRule::EvenOdd,
        Winding::Positive => FillRule::Positive,
    };
    let shapes = overlay.overlay(rule, fill);
    shapes.into_iter().flatten().map(|corners| corners.into_iter().map(DVec2::from).collect()).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{SetOperation, Winding, overlay};
    use crate::geometry::planar::twice_area;

    fn square(x: f64, y: f64, size: f64) -> Vec<DVec2> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(a, b)| DVec2::new(x + size * a, y + size * b))
            .to_vec()
    }

    fn area(loops: &[Vec<DVec2>]) -> f64 {
        loops.iter().map(|corners| twice_area(corners) / 2.0).sum()
    }

    #[test]
    fn areas_add_up() {
        let (one, other) = (vec![square(0.0, 0.0, 1.0)], vec![square(0.3, 0.6, 1.0)]);
        let of = |operation| area(&overlay(&one, &other, operation, Winding::Odd));
        let common = 0.7 * 0.4;
        assert!((of(SetOperation::Intersection) - common).abs() < 1e-15);
        assert!((of(SetOperation::Union) - (2.0 - common)).abs() < 1e-15);
        assert!((of(SetOperation::Difference) - (1.0 - common)).abs() < 1e-15);
        assert!((of(SetOperation::Xor) - (2.0 - 2.0 * common)).abs() < 1e-15);
    }

    #[test]
    fn fine_coordinates_are_kept() {
        let place = 0.123_456_789_012_3;
        let far = vec![square(0.0, 0.0, 1000.0)];
        let found = overlay(&far, &[square(place, place, 1.0)], SetOperation::Difference, Winding::Odd);
        let hole = found.iter().find(|corners| twice_area(corners) < 0.0).unwrap();
        assert!(hole.iter().any(|corner| (*corner - DVec2::splat(place)).length() < 1e-12));
    }

    #[test]
    fn loops_that_turn_back_enclose_nothing_positive() {
        let mut back = square(2.0, 0.0, 1.0);
        back.reverse();
        let found = overlay(&[square(0.0, 0.0, 1.0), back], &[], SetOperation::Union, Winding::Positive);
        assert_eq!(found.len(), 1);
        assert!((area(&found) - 1.0).abs() < 1e-15);
    }
}

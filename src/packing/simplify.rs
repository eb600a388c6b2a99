//! Fewer triangles for a surface that is known by its triangles alone.

use meshopt::{SimplifyOptions, SimplifyVertex, simplify_with_attributes_and_locks_decoder};

use super::whole_triangles;

/// What a surface shows at its vertices, and how much of it.
#[derive(Clone, Copy, Debug)]
pub struct Attributes<'a> {
    /// Numbers of the first vertex, then of the next; `weights.len()` for each.
    pub values: &'a [f32],
    /// By how much a difference of 1 in each number counts as distance, in sizes of the mesh. At most 32.
    pub weights: &'a [f32],
}

/// Triangles over the same vertices, fewer of them, each within `error` of what was there in meshoptimizer's measure, which
/// is no bound. Vertices on the border stay where they are, and keep their edges. Seams, where vertices at one place differ, stay
/// closed; those of `kept` vertices stay where they are too. Corners of a triangle keep their turn. O(n log n), some 500 ns a triangle.
///
/// Source: M. Garland, P. Heckbert, Simplifying surfaces with color and texture using quadric error metrics, 1998;
/// H. Hoppe, New quadric metric for simplifying meshes with appearance attributes, 1999.
///
/// # Panics
/// When an index is not below the number of vertices, attributes are not one for each vertex, or a number is not finite.
#[must_use]
pub fn simplified(
    indices: &[u32],
    positions: &[[f32; 3]],
    attributes: Attributes<'_>,
    kept: &[bool],
    error: f32,
) -> Vec<u32> {
    assert!(whole_triangles(indices, positions.len()), "a mesh's indices are in range");
    let width = attributes.weights.len();
    assert!(
        width <= 32 && attributes.values.len() == positions.len() * width,
        "each vertex has its attributes"
    );
    let numbers = positions.as_flattened().iter().chain(attributes.values).chain(attributes.weights);
    assert!(error >= 0.0 && numbers.into_iter().all(|number| number.is_finite()), "numbers are finite");
    if indices.is_empty() {
        return Vec::new();
    }
    let lock = |kept: &bool| if *kept { SimplifyVertex::Protect } else { SimplifyVertex::None };
    let locks: Vec<SimplifyVertex> = kept.iter().map(lock).collect();
    let options = SimplifyOptions::LockBorder | SimplifyOptions::ErrorAbsolute | SimplifyOptions::Permissive;
    let (values, weights) = (attributes.values, attributes.weights);
    simplify_with_attributes_and_locks_decoder(
        indices,
        positions,
        values,
        weights,
        4 * width,
        &locks,
        0,
        error,
        options,
        None,
    )
}

#[cfg(test)]
mod tests {
    use super::{Attributes, simplified};

    /// A flat square of `n` by `n` cells whose middle is raised.
    fn tent(n: u32, height: f32) -> (Vec<u32>, Vec<[f32; 3]>) {
        let at = |k: u32| f32::from(u16::try_from(k).expect("small"));
        let middle = |k: u32| (at(k) - at(n) / 2.0).abs() * 2.0 / at(n);
        let place = |i: u32, j: u32| [at(i), height * (1.0 - middle(i).max(middle(j))), at(j)];
        let points = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j))).collect();
        let corner = |i: u32, j: u32| j * (n + 1) + i;
        let cell = |i: u32, j: u32| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [a, c, b, a, d, c]
        };
        ((0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect(), points)
    }

    const BARE: Attributes<'_> = Attributes { values: &[], weights: &[] };

    #[test]
    fn what_is_flat_goes_and_the_border_stays() {
        let (indices, points) = tent(16, 4.0);
        let few = simplified(&indices, &points, BARE, &[false; 289], 1e-3);
        // Of the cells that a ridge crosses, and of those at the border, triangles are left.
        assert!(few.len() < indices.len() / 2, "{} of {}", few.len(), indices.len());
        let border: Vec<u32> =
            (0..17 * 17).filter(|k| k % 17 == 0 || k % 17 == 16 || k / 17 == 0 || k / 17 == 16).collect();
        assert!(
            border.iter().all(|vertex| few.contains(vertex)),
            "every vertex of the border is still there"
        );
        assert!(few.contains(&(8 * 17 + 8)), "so is the tip");
        assert_eq!(simplified(&[], &points, BARE, &[false; 289], 1.0), Vec::<u32>::new());
    }

    #[test]
    fn attributes_hold_what_flatness_would_give_up() {
        let (indices, points) = tent(16, 0.0);
        let values: Vec<f32> = points.iter().map(|[x, ..]| if *x < 8.0 { 0.0 } else { 1.0 }).collect();
        let few = simplified(
            &indices,
            &points,
            Attributes { values: &values, weights: &[1.0] },
            &[false; 289],
            1e-3,
        );
        assert!(few.len() > simplified(&indices, &points, BARE, &[false; 289], 1e-3).len());
    }

    #[test]
    #[should_panic(expected = "in range")]
    fn an_index_beyond_the_vertices_never_reaches_the_library() {
        let _ = simplified(&[0, 1, 3], &[[0.0; 3]; 3], BARE, &[false; 3], 0.1);
    }

    #[test]
    #[should_panic(expected = "finite")]
    fn a_number_that_is_none_never_reaches_the_library() {
        let _ = simplified(&[0, 1, 2], &[[0.0; 3], [f32::NAN; 3], [1.0; 3]], BARE, &[false; 3], 0.1);
    }
}

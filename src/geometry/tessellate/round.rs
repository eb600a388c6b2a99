//! Distance of triangles from the ball that their corners lie on, and the coarsest division that keeps a tolerance.

use glam::DVec3;

use crate::geometry::number::{floor_count, floor_large};

/// How far the points of a triangle, whose corners lie on the ball of `radius` about the origin, stay inside of it
/// at most. Along the rays from the middle this is the distance of the ball from the triangle too.
///
/// The point of the triangle nearest to the middle is the foot of its plane, or where that lies outside of it, the
/// nearest point of an edge.
pub(super) fn sagitta([a, b, c]: [DVec3; 3], radius: f64) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = [[a, b], [b, c], [c, a]].into_iter().all(|[p, q]| p.cross(q).dot(normal) >= 0.0);
    let nearest = if inside && normal != DVec3::ZERO {
        a.dot(normal).abs() / normal.length()
    } else {
        [[a, b], [b, c], [c, a]].into_iter().map(nearest_of_edge).fold(f64::INFINITY, f64::min)
    };
    (radius - nearest).max(0.0)
}

fn nearest_of_edge([a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let length = along.length_squared();
    let part = if length > 0.0 { (-a.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * part).length()
}

/// The least number of pieces for which `deviation` is at most `tolerance`, given that it falls about with the
/// square of the number; `most` when even that many are not enough. Evaluates `deviation` a handful of times.
pub(super) fn fewest_pieces(tolerance: f64, most: u32, deviation: impl Fn(u32) -> f64) -> u32 {
    let mut pieces = 1;
    loop {
        let found = deviation(pieces);
        if found <= tolerance || pieces >= most {
            return pieces;
        }
        // The guess falls short rather than overshoots, for the fewest are wanted.
        let guess = 0.95 * f64::from(pieces) * (found / tolerance).sqrt();
        pieces =
            if floor_large(guess) >= u64::from(most) { most } else { floor_count(guess).max(pieces + 1) };
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{fewest_pieces, sagitta};

    #[test]
    fn sagitta_is_that_of_the_nearest_point() {
        // The octant's triangle is nearest in its middle, at 1 / sqrt 3.
        let octant = [DVec3::X, DVec3::Y, DVec3::Z];
        assert!((sagitta(octant, 1.0) - (1.0 - 1.0 / 3.0_f64.sqrt())).abs() < 1e-15);
        // An obtuse one in the middle of its longest side.
        let flat = [DVec3::X, DVec3::Y, DVec3::new(0.7, 0.7, 0.1).normalize()];
        assert!((sagitta(flat, 1.0) - (1.0 - 0.5_f64.sqrt())).abs() < 1e-15);
    }

    #[test]
    fn fewest_pieces_are_fewest() {
        let deviation = |pieces: u32| 1.0 / (f64::from(pieces) + 0.3) / f64::from(pieces);
        for tolerance in [2.0, 0.5, 0.1, 1e-3, 1e-6] {
            let pieces = fewest_pieces(tolerance, 5000, deviation);
            assert!(deviation(pieces) <= tolerance && (pieces == 1 || deviation(pieces - 1) > tolerance));
        }
        assert_eq!(fewest_pieces(1e-12, 50, deviation), 50);
    }
}

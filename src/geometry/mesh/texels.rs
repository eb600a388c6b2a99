//! The texels of a picture that a triangle covers in texture space.
//!
//! Texel (i, j) of a picture of w by h has its center at u = (i + 1/2) / w, v = (j + 1/2) / h, v running down as glTF has
//! it. Promise: a center inside of a triangle or on its border is visited, and those up to a texel outside of it, which
//! filters read, marked as such.

use glam::DVec2;

use super::super::number::floor_index;

/// A texel that a triangle covers.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Its number, row by row.
    pub at: usize,
    /// Weights of the corners at its center, within the triangle: of one outside, those of a place near by.
    pub weights: [f64; 3],
    /// Whether its center lies in the triangle, and how deep: the least weight.
    pub inside: f64,
}

/// Visits the texels of a triangle. Triangles without area in texture space have none.
pub fn texels([a, b, c]: [DVec2; 3], [width, height]: [u32; 2], mut visit: impl FnMut(Texel)) {
    let size = DVec2::new(f64::from(width), f64::from(height));
    let [a, b, c] = [a, b, c].map(|uv| uv * size);
    let (ab, ac) = (b - a, c - a);
    let twice = ab.perp_dot(ac);
    if twice == 0.0 || !twice.is_finite() {
        return;
    }
    let low = (a.min(b).min(c) - 1.5).max(DVec2::ZERO);
    let high = (a.max(b).max(c) + 1.5).min(size);
    let columns = floor_index(low.x)..floor_index(high.x.max(0.0)).min(width as usize);
    let rows = floor_index(low.y)..floor_index(high.y.max(0.0)).min(height as usize);
    let longest = ab.length().max(ac.length()).max((c - b).length());
    // The weight that falls by this much a texel away from the longest side's height.
    let margin = longest / twice.abs();
    for j in rows {
        for i in columns.clone() {
            let place = DVec2::new(i as f64 + 0.5, j as f64 + 0.5) - a;
            let (v, w) = (place.perp_dot(ac) / twice, ab.perp_dot(place) / twice);
            let weights = [1.0 - v - w, v, w];
            let inside = weights.into_iter().fold(f64::INFINITY, f64::min);
            if inside < -margin {
                continue;
            }
            let held = weights.map(|weight| weight.max(0.0));
            let sum: f64 = held.iter().sum();
            visit(Texel { at: j * width as usize + i, weights: held.map(|weight| weight / sum), inside });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::texels;
    use glam::DVec2;

    #[test]
    fn two_triangles_cover_a_square_once() {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let mut seen = [0; 7 * 5];
        for triangle in [[0, 1, 2], [0, 2, 3]] {
            texels(triangle.map(|k| corners[k]), [7, 5], |texel| {
                assert!((texel.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                if texel.inside > 0.0 {
                    seen[texel.at] += 1;
                    let at: DVec2 = (0..3).map(|k| corners[triangle[k]] * texel.weights[k]).sum();
                    let center = DVec2::new((texel.at % 7) as f64 + 0.5, (texel.at / 7) as f64 + 0.5);
                    assert!((at * DVec2::new(7.0, 5.0) - center).length() < 1e-9);
                }
            });
        }
        // Those on the diagonal are on the border of both.
        assert!(seen.iter().all(|count| *count <= 1));
        assert!(seen.iter().filter(|count| **count == 1).count() >= 34);
    }
}

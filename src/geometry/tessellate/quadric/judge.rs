//! How far a triangle lies from a quadric.

use glam::{DVec2, DVec3};

use crate::geometry::field::quadric::Sheet;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::tessellate::region::{Chart, Judgment};

/// A sheet of a quadric as a chart.
pub(super) struct SheetChart<'a> {
    pub(super) quadric: &'a Quadric,
    pub(super) sheet: &'a Sheet,
}

/// A flat face: nothing needs to be added.
pub(super) struct FlatChart;

/// A triangle whose corners look apart by more than this (as a cosine) says little about the surface between.
const WIDEST: f64 = 0.25;

impl Chart for SheetChart<'_> {
    fn lift(&self, place: DVec2) -> Option<DVec3> {
        self.quadric.settled(self.sheet.lift(place))
    }

    fn judge(&self, _: [DVec2; 3], corners: [DVec3; 3]) -> Judgment {
        judge(self.quadric, corners)
    }

    fn judge_edge(&self, _: [DVec2; 2], [from, to]: [DVec3; 2]) -> f64 {
        judge(self.quadric, [from, to, (from + to) / 2.0]).bound
    }
}

impl Chart for FlatChart {
    fn lift(&self, _: DVec2) -> Option<DVec3> {
        None
    }

    fn judge(&self, _: [DVec2; 3], _: [DVec3; 3]) -> Judgment {
        Judgment { bound: 0.0, worst: DVec3::splat(1.0 / 3.0) }
    }

    fn judge_edge(&self, _: [DVec2; 2], _: [DVec3; 2]) -> f64 {
        0.0
    }
}

/// A proved bound, up to rounding, for corners on the surface.
///
/// On the triangle the polynomial is `-(st q_ab + tr q_bc + rs q_ca)` for the shares r, s, t of its corners, where q is
/// what the squares make of a side: its greatest size is found exactly. From a place where the polynomial is f and its
/// gradient at least g long, the surface is met along the gradient after 2 f / (g + sqrt(g^2 - 4 f b)) or before, where b
/// bounds the bend.
pub(super) fn judge(quadric: &Quadric, corners: [DVec3; 3]) -> Judgment {
    let gradients = corners.map(|corner| quadric.gradient(corner));
    let lengths = gradients.map(DVec3::length);
    let longest = lengths.into_iter().fold(0.0, f64::max);
    // At the apex of a cone the gradient vanishes; distances from a cone are proportional to those from its apex, so
    // that the far side tells.
    if let Some(apex) = (0..3).find(|k| lengths[*k] <= 1e-7 * longest) {
        let (from, to) = ((apex + 1) % 3, (apex + 2) % 3);
        let mut worst = [0.0; 3];
        (worst[from], worst[to]) = (0.5, 0.5);
        let value = quadric.bent(corners[to] - corners[from]).abs() / 4.0;
        let bound = reach(quadric, value, &[gradients[from], gradients[to]]);
        return Judgment { bound, worst: DVec3::from_array(worst) };
    }
    let [a, b, c] = corners;
    let (value, worst) = greatest([c - b, a - c, b - a].map(|side| quadric.bent(side)));
    Judgment { bound: reach(quadric, value, &gradients), worst }
}

/// How far the surface can be from a place where the polynomial has at most a size, among places whose gradients are
/// means of the given ones.
fn reach(quadric: &Quadric, value: f64, gradients: &[DVec3]) -> f64 {
    let sum: DVec3 = gradients.iter().copied().sum();
    let direction = sum.normalize_or_zero();
    let least = gradients.iter().map(|gradient| gradient.dot(direction)).fold(f64::INFINITY, f64::min);
    let apart = gradients.iter().any(|gradient| gradient.dot(direction) < WIDEST * gradient.length());
    let room = least * least - 4.0 * value * quadric.stretch();
    if apart || least <= 0.0 || room < 0.0 {
        return f64::INFINITY;
    }
    2.0 * value / (least + room.sqrt())
}

/// The greatest size of `b c p + c a q + a b r` on a triangle, for the shares a, b, c of its corners and numbers p, q, r of
/// the sides across from them; and the shares where that is.
pub(in crate::geometry::tessellate) fn greatest([p, q, r]: [f64; 3]) -> (f64, DVec3) {
    let middles = [
        (p.abs() / 4.0, DVec3::new(0.0, 0.5, 0.5)),
        (q.abs() / 4.0, DVec3::new(0.5, 0.0, 0.5)),
        (r.abs() / 4.0, DVec3::new(0.5, 0.5, 0.0)),
    ];
    let sides =
        middles.into_iter().fold((-1.0, DVec3::ZERO), |best, next| if next.0 > best.0 { next } else { best });
    // Inside, where the sum of products does not change to first order.
    let shares = DVec3::new(p * (q + r - p), q * (r + p - q), r * (p + q - r));
    let sum = shares.element_sum();
    let shares = shares / sum;
    if sum == 0.0 || !shares.is_finite() || shares.min_element() <= 0.0 {
        return sides;
    }
    let inside = (shares.y * shares.z * p + shares.z * shares.x * q + shares.x * shares.y * r).abs();
    if inside > sides.0 { (inside, shares) } else { sides }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::judge;
    use crate::geometry::field::{Field, Quadric};

    #[test]
    fn no_place_of_a_triangle_is_further_away_than_its_bound() {
        let quadric = Quadric::new(DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.2, 0.1, -0.3), DVec3::ZERO, -1.0);
        let on = |x: f64, y: f64| {
            let settled = quadric.settled(DVec3::new(1.0 + x, 0.3 * y, y)).unwrap();
            assert!(quadric.value(settled).abs() < 1e-14);
            settled
        };
        for k in 0..40 {
            let size = 0.4 / (1.0 + f64::from(k % 7));
            let at = f64::from(k) / 40.0;
            let corners = [on(at, 0.3), on(at + size, 0.3 - size), on(at - 0.2 * size, 0.3 + size)];
            let judged = judge(&quadric, corners);
            let mut found: f64 = 0.0;
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (s, t) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let place = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
                    found = found.max(quadric.settled(place).unwrap().distance(place));
                }
            }
            assert!(found <= judged.bound, "{found} {}", judged.bound);
            assert!(judged.bound < 2.0 * found, "{found} {}", judged.bound);
        }
    }
}

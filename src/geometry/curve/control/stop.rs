//! Where a moving point stands still for an instant: the cusps of a curve.

use glam::DVec3;

use super::bernstein::{de_casteljau, hodograph, split};

/// How often an interval is halved before a root is polished: 2^-40 of it is left.
const HALVINGS: u32 = 40;

/// No more parts than this are looked at: what is tangled beyond it is rounding, not geometry.
const PARTS: usize = 4096;

/// The parameters strictly between 0 and 1 where the vector in Bernstein form vanishes, increasing.
///
/// A part whose control vectors all lie in one open half space has no zero (the hull property); others are
/// halved. What is left is polished by Newton's method and kept where the vector is zero up to rounding. Zeros
/// within 1e-9 of an end belong to the end and are left out, and of a vector that is zero throughout there are
/// none. Cost: O(degree) where the control vectors lie in a half space, which is nearly always.
#[must_use]
pub fn stops(vector: &[DVec3]) -> Vec<f64> {
    const END: f64 = 1e-9;
    let size = vector.iter().map(|v| v.length()).fold(0.0, f64::max);
    let rounding = 1e-14 * size;
    if size == 0.0 || in_half_space(vector, rounding) {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut parts = vec![(vector.to_vec(), 0.0, 1.0, 0)];
    for _ in 0..PARTS {
        let Some((control, start, end, depth)) = parts.pop() else { break };
        if in_half_space(&control, rounding) {
            continue;
        }
        let middle = (start + end) / 2.0;
        if depth == HALVINGS {
            found.push(middle);
            continue;
        }
        let (left, right) = split(&control, 0.5);
        parts.push((right, middle, end, depth + 1));
        parts.push((left, start, middle, depth + 1));
    }
    let rate = hodograph(vector);
    let mut roots: Vec<f64> = found.into_iter().map(|t| polish(vector, &rate, t)).collect();
    roots.retain(|t| *t > END && *t < 1.0 - END && de_casteljau(vector, *t).length() <= 1e-12 * size);
    roots.dedup_by(|later, earlier| *later - *earlier <= END);
    roots
}

/// Whether a direction shows that no combination of the vectors is zero, up to `rounding` in each: a zero at
/// the place of a cut must not slip between the two parts.
fn in_half_space(control: &[DVec3], rounding: f64) -> bool {
    let direction = control.iter().copied().sum::<DVec3>().normalize_or_zero();
    control.iter().all(|vector| vector.dot(direction) > rounding)
}

/// Newton's method for the least length.
fn polish(vector: &[DVec3], rate: &[DVec3], mut t: f64) -> f64 {
    for _ in 0..3 {
        let (value, slope) = (de_casteljau(vector, t), de_casteljau(rate, t));
        let bend = slope.length_squared();
        let next = t - value.dot(slope) / bend;
        let better =
            bend > 0.0 && (next - t).abs() < 1e-9 && de_casteljau(vector, next).length() < value.length();
        if !better {
            break;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::bernstein::{hodograph, product};
    use super::stops;

    fn flat(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect()
    }

    #[test]
    fn the_cusp_of_a_cubic_is_found() {
        let cusp = flat(&[(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]);
        assert_eq!(stops(&hodograph(&cusp)), [0.5]);
        for near in [1e-3, -1e-3, 1e-6] {
            let loose = flat(&[(0.0, 0.0), (1.0 + near, 1.0), (0.0, 1.0), (1.0, 0.0)]);
            assert_eq!(stops(&hodograph(&loose)), [] as [f64; 0], "{near}");
        }
    }

    #[test]
    fn a_point_that_turns_back_on_a_line_stops() {
        let back = flat(&[(0.0, 0.0), (2.0, 0.0), (0.0, 0.0)]);
        assert_eq!(stops(&hodograph(&back)), [0.5]);
        let twice = flat(&[(0.0, 0.0), (3.0, 3.0), (-2.0, -2.0), (1.0, 1.0)]);
        let found = stops(&hodograph(&twice));
        assert_eq!(found.len(), 2);
        assert!((found[0] + found[1] - 1.0).abs() < 1e-14);
    }

    #[test]
    fn planted_zeros_are_found_and_ends_are_not() {
        for root in [0.1, 0.3337, 0.75, 0.9] {
            let line = [-root, 1.0 - root];
            let vector = product(&flat(&[(1.0, 0.2), (0.3, 1.0), (-0.5, 0.4)]), &line);
            let found = stops(&vector);
            assert_eq!(found.len(), 1, "{root}: {found:?}");
            assert!((found[0] - root).abs() < 1e-14, "{found:?} is not {root}");
        }
        let from_rest = flat(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        assert_eq!(stops(&from_rest), [] as [f64; 0]);
        assert_eq!(stops(&[DVec3::ZERO; 4]), [] as [f64; 0]);
    }
}

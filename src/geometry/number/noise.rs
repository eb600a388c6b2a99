//! Gradient noise: the same hills on every machine.
//!
//! Source: K. Perlin, "Improving Noise", SIGGRAPH 2002 (quintic fade), with eight unit gradients that are
//! chosen by hashing the lattice point (`SplitMix64`, G. Steele, D. Lea, C. Flood, OOPSLA 2014).

/// Smooth noise: 0 where both coordinates are whole, twice differentiable, within -1 to 1.
///
/// Coordinates beyond 2^52 have no fraction and give 0. Cost: four hashes.
#[must_use]
pub fn noise(seed: f64, x: f64, y: f64) -> f64 {
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (x - column, y - row);
    let corner = |dx: f64, dy: f64| {
        let (gx, gy) = noise_gradient(seed, column + dx, row + dy);
        gx * (u - dx) + gy * (v - dy)
    };
    let (s, t) = (fade(u), fade(v));
    let near = mix(corner(0.0, 0.0), corner(1.0, 0.0), s);
    let far = mix(corner(0.0, 1.0), corner(1.0, 1.0), s);
    // Unit gradients reach 1/√2 in the middle of a cell.
    mix(near, far, t) * std::f64::consts::SQRT_2
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The unit gradient of the lattice point (x, y).
#[must_use]
pub fn noise_gradient(seed: f64, x: f64, y: f64) -> (f64, f64) {
    const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
    // Adding zero makes -0 and 0 one lattice point.
    let bits = [seed, x, y].iter().fold(0, |hash, number| scramble(hash ^ (number + 0.0).to_bits()));
    match bits >> 61 {
        0 => (1.0, 0.0),
        1 => (DIAGONAL, DIAGONAL),
        2 => (0.0, 1.0),
        3 => (-DIAGONAL, DIAGONAL),
        4 => (-1.0, 0.0),
        5 => (-DIAGONAL, -DIAGONAL),
        6 => (0.0, -1.0),
        _ => (DIAGONAL, -DIAGONAL),
    }
}

fn scramble(state: u64) -> u64 {
    let mut bits = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::noise;

    #[test]
    fn noise_is_bounded_continuous_and_zero_on_the_lattice() {
        let mut greatest: f64 = 0.0;
        for step in 0..40_000 {
            let (x, y) = (f64::from(step % 200) * 0.137 - 9.0, f64::from(step / 200) * 0.091 - 7.0);
            let here = noise(3.0, x, y);
            greatest = greatest.max(here.abs());
            assert!((noise(3.0, x + 1e-9, y) - here).abs() < 1e-7);
        }
        assert!(greatest > 0.5 && greatest <= 1.0, "{greatest}");
        assert_eq!(noise(1.0, -0.0, 0.0), noise(1.0, 0.0, 0.0));
        assert_eq!(noise(5.0, 12.0, -7.0), 0.0);
        assert!(noise(1.0, 0.5, 0.5) != noise(2.0, 0.5, 0.5) || noise(1.0, 1.5, 0.5) != noise(2.0, 1.5, 0.5));
    }
}

//! Numbers at some places of a triangle, and between them.

use super::floor_index;

/// Places in a triangle, as weights of its corners: around the rim in quarters of its sides, from the first corner to the
/// second and on, then the middle.
pub const FAN: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.75, 0.25, 0.0],
    [0.5, 0.5, 0.0],
    [0.25, 0.75, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.75, 0.25],
    [0.0, 0.5, 0.5],
    [0.0, 0.25, 0.75],
    [0.0, 0.0, 1.0],
    [0.25, 0.0, 0.75],
    [0.5, 0.0, 0.5],
    [0.75, 0.0, 0.25],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];

/// The number at a place of a triangle, straight between those at [`FAN`]: linear in each of the twelve triangles around
/// the middle. `shares` are the weights of the corners, at least 0 and with the sum 1.
#[must_use]
pub fn in_fan(values: &[f64; 13], shares: [f64; 3]) -> f64 {
    let middle = values[12];
    // The corner that counts least stands across the side that is nearest; three times its weight counts for the middle.
    let far = (0..3).min_by(|a, b| shares[*a].total_cmp(&shares[*b])).unwrap_or(0);
    let inner = 3.0 * shares[far];
    let outer = 1.0 - inner;
    if outer <= 0.0 {
        return middle;
    }
    let (from, to) = ((far + 1) % 3, (far + 2) % 3);
    // How far along that side, in quarters.
    let along = 4.0 * ((shares[to] - shares[far]) / outer).clamp(0.0, 1.0);
    let step = floor_index(along).min(3);
    let value = |step: usize| values[(4 * from + step) % 12];
    let rim = value(step) + (value(step + 1) - value(step)) * (along - step as f64);
    rim * outer + middle * inner
}

#[cfg(test)]
mod tests {
    use super::{FAN, in_fan};

    #[test]
    fn the_numbers_are_met_at_their_places() {
        let values = std::array::from_fn(|k| (k * k) as f64 - 7.0);
        for (place, value) in FAN.iter().zip(values) {
            assert!((in_fan(&values, *place) - value).abs() < 1e-12, "{place:?}");
        }
    }

    #[test]
    fn what_is_linear_stays_linear_and_nothing_passes_the_greatest() {
        let linear = |[a, b, c]: [f64; 3]| 3.0 * a - 2.0 * b + 5.0 * c;
        let flat = FAN.map(linear);
        let mut peak = [0.0; 13];
        peak[6] = 1.0;
        for i in 0..=20_u8 {
            for j in 0..=20 - i {
                let (a, b) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let place = [a, b, 1.0 - a - b];
                assert!((in_fan(&flat, place) - linear(place)).abs() < 1e-12, "{place:?}");
                assert!((0.0..=1.0).contains(&in_fan(&peak, place)));
            }
        }
    }
}

//! Unit vectors in few bytes, and the filters of `EXT_meshopt_compression` backwards.
//!
//! Source: Khronos Group, glTF extension `EXT_meshopt_compression`, 2021, appendix B (filters); Q. Meyer and others, On
//! floating-point normal vectors, 2010 (the octahedron).

/// A vector of unit length and a sign on the octahedron: what the filter OCTAHEDRAL reads back as four bytes.
///
/// Of the four ways to round, the one whose direction lies nearest: what is read back, in bytes again, is within 0.9
/// degrees.
#[must_use]
pub fn octahedral([x, y, z]: [f64; 3], sign: f64) -> [i8; 4] {
    let sum = x.abs() + y.abs() + z.abs();
    let [x, y, z] = if sum > 0.0 { [x, y, z].map(|part| part / sum) } else { [0.0, 0.0, 1.0] };
    // The lower half is folded over the upper one.
    let fold = |a: f64, b: f64| if a >= 0.0 { 1.0 - b.abs() } else { b.abs() - 1.0 };
    let (u, v) = if z >= 0.0 { (x, y) } else { (fold(x, y), fold(y, x)) };
    let ways = |number: f64| [number.floor(), number.ceil()];
    let mut best = (f64::NEG_INFINITY, [0.0, 0.0]);
    for way in ways(u * 127.0).into_iter().flat_map(|u| ways(v * 127.0).map(|v| [u / 127.0, v / 127.0])) {
        let found = unfolded(way);
        let near = (found[0] * x + found[1] * y + found[2] * z)
            / (found[0] * found[0] + found[1] * found[1] + found[2] * found[2]).sqrt();
        if near > best.0 {
            best = (near, way);
        }
    }
    let [u, v] = best.1;
    [signed_byte(u), signed_byte(v), 127, signed_byte(sign)]
}

/// A direction of the place on the octahedron.
fn unfolded([u, v]: [f64; 2]) -> [f64; 3] {
    let z = 1.0 - u.abs() - v.abs();
    let below = z.min(0.0);
    let back = |part: f64| if part >= 0.0 { part + below } else { part - below };
    [back(u), back(v), z]
}

/// A number from -1 to 1 as a normalized byte with a sign.
#[must_use]
pub fn signed_byte(number: f64) -> i8 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the range of the type")]
    let byte = (number.clamp(-1.0, 1.0) * 127.0).round() as i8;
    byte
}

/// A share of 1 as a normalized byte: the nearest.
#[must_use]
pub fn share_byte(share: f32) -> u8 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the range of the type"
    )]
    let byte = (share.clamp(0.0, 1.0) * 255.0).round() as u8;
    byte
}

/// Numbers with one exponent for all of them: what the filter EXPONENTIAL reads back as floats. Each is rounded to a
/// multiple of 2^-16 of the power of two above the greatest; numbers that are not finite count as 0.
#[must_use]
pub fn exponential(numbers: &[f64]) -> Vec<u32> {
    let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
    let most = numbers.iter().fold(0.0, |most: f64, number| most.max(finite(*number).abs()));
    let (mut power, mut exponent) = (1.0, 0_i8);
    while power < most && exponent < 120 {
        (power, exponent) = (power * 2.0, exponent + 1);
    }
    while power / 2.0 >= most && exponent > -80 {
        (power, exponent) = (power / 2.0, exponent - 1);
    }
    let step = power / 65536.0;
    let high = (exponent - 16).cast_unsigned();
    let word = |number: &f64| {
        // A mantissa of 24 bits with its sign, of which 17 are used.
        #[expect(clippy::cast_possible_truncation, reason = "at most 65536 steps from 0")]
        let [low, middle, third, _] = ((finite(*number) / step).round() as i32).to_le_bytes();
        u32::from_le_bytes([low, middle, third, high])
    };
    numbers.iter().map(word).collect()
}

/// A number as a multiple of a power of two, `2^exponent`: what the filter EXPONENTIAL reads back as a float. The nearest of the
/// multiples below 2^23.
#[must_use]
pub fn exponential_step(number: f64, exponent: i8) -> u32 {
    let most = f64::from((1 << 23) - 1);
    #[expect(clippy::cast_possible_truncation, reason = "clamped to 24 bits")]
    let steps = (number / power_of_two(exponent)).round().clamp(-most, most) as i32;
    let [low, middle, third, _] = steps.to_le_bytes();
    u32::from_le_bytes([low, middle, third, exponent.cast_unsigned()])
}

/// `2^exponent`, exactly.
#[must_use]
pub fn power_of_two(exponent: i8) -> f64 {
    // The bits of a float hold its exponent, counted from 1023, above 52 others.
    let counted = u64::from((i16::from(exponent) + 1023).cast_unsigned());
    f64::from_bits(counted << 52)
}

/// A unit quaternion as its three smallest components in `bits` bits each, at least 4 and at most 16, and which is the
/// greatest: what the filter QUATERNION reads back as four normalized words.
#[must_use]
pub fn quaternion(parts: [f64; 4], bits: u8) -> [i16; 4] {
    let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let unit = if length > 0.0 { parts.map(|part| part / length) } else { [0.0, 0.0, 0.0, 1.0] };
    let greatest = (0..4).fold(0, |most, at| if unit[at].abs() > unit[most].abs() { at } else { most });
    // Of the two quaternions of a turn, the one whose greatest component is not negative.
    let sign = if unit[greatest] < 0.0 { -1.0 } else { 1.0 };
    let most = (1_i16 << (bits - 1)).wrapping_sub(1);
    let part = |step: usize| {
        let scaled = unit[(greatest + step) % 4] * sign * std::f64::consts::SQRT_2 * f64::from(most);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "no part but the greatest is above the root of 1/2"
        )]
        let word = scaled.round().clamp(-f64::from(most), f64::from(most)) as i16;
        word
    };
    let which = i16::try_from(greatest).unwrap_or_default();
    [part(1), part(2), part(3), (most & !3) | which]
}

/// What a filter makes of decoded bytes, in place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Unit vectors of 4 or 8 bytes.
    Octahedral,
    /// Quaternions of 8 bytes.
    Quaternion,
    /// Floats, any number of them.
    Exponential,
    /// Colors of 4 or 8 bytes, as lightness and two differences; of `KHR_meshopt_compression` alone.
    Color,
}

impl Filter {
    /// The filter of a name of the extension.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "OCTAHEDRAL" => Some(Self::Octahedral),
            "QUATERNION" => Some(Self::Quaternion),
            "EXPONENTIAL" => Some(Self::Exponential),
            "COLOR" => Some(Self::Color),
            _ => None,
        }
    }

    /// Turns decoded rows into what they stand for; false where rows of this length are not the filter's.
    #[must_use]
    pub fn undo(self, bytes: &mut [u8], stride: usize) -> bool {
        match (self, stride) {
            (Self::Octahedral, 4) => in_rows::<4, [i8; 4]>(
                bytes,
                |row| row.map(u8::cast_signed),
                meshopt::decode_filter_oct,
                |row| row.map(i8::cast_unsigned),
            ),
            (Self::Octahedral, 8) => in_rows(bytes, shorts, meshopt::decode_filter_oct, bytes_of),
            (Self::Quaternion, 8) => in_rows(bytes, shorts, meshopt::decode_filter_quat, bytes_of),
            (Self::Color, 4) => {
                in_rows::<4, [u8; 4]>(bytes, |row| row, meshopt::decode_filter_color, |row| row)
            }
            (Self::Color, 8) => in_rows::<8, [u16; 4]>(
                bytes,
                |row| shorts(row).map(i16::cast_unsigned),
                meshopt::decode_filter_color,
                |row| bytes_of(row.map(u16::cast_signed)),
            ),
            (Self::Exponential, stride) if stride % 4 == 0 => in_rows::<4, [u32; 1]>(
                bytes,
                |row| [u32::from_le_bytes(row)],
                meshopt::decode_filter_exp,
                |[word]| word.to_le_bytes(),
            ),
            _ => return false,
        }
        true
    }
}

fn shorts(row: [u8; 8]) -> [i16; 4] {
    let (pairs, _) = row.as_chunks::<2>();
    std::array::from_fn(|at| i16::from_le_bytes(pairs[at]))
}

fn bytes_of(row: [i16; 4]) -> [u8; 8] {
    let [[a, b], [c, d], [e, f], [g, h]] = row.map(i16::to_le_bytes);
    [a, b, c, d, e, f, g, h]
}

fn in_rows<const N: usize, T>(
    bytes: &mut [u8],
    from: impl Fn([u8; N]) -> T,
    undo: impl Fn(&mut [T]),
    to: impl Fn(T) -> [u8; N],
) {
    let (rows, _) = bytes.as_chunks_mut::<N>();
    let mut words: Vec<T> = rows.iter().map(|row| from(*row)).collect();
    undo(&mut words);
    rows.iter_mut().zip(words).for_each(|(row, word)| *row = to(word));
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Filter, exponential, exponential_step, octahedral, power_of_two, quaternion, shorts};

    #[test]
    fn quaternions_come_back_as_the_same_turn() {
        for bits in [12_u8, 16] {
            let step = power_of_two(1 - bits.cast_signed());
            for at in 0..2000_i32 {
                let part = |k: i32| f64::from((at * 7919 + k * 104_729) % 2003 - 1001);
                let given = glam::DVec4::new(part(1), part(2), part(3), part(4)).normalize();
                let words = quaternion(given.to_array(), bits);
                let mut bytes = super::bytes_of(words);
                assert!(Filter::Quaternion.undo(&mut bytes, 8));
                let found = glam::DVec4::from_array(shorts(bytes).map(|word| f64::from(word) / 32767.0));
                let apart = (found - given).length().min((found + given).length());
                // Half a step of each of three parts, what the greatest makes good of it, and the words' own rounding.
                assert!(apart < 2.0 * step + 1e-4, "{given} became {found}, {apart} away in {bits} bits");
            }
        }
        assert_eq!(
            quaternion([0.0; 4], 16),
            quaternion([0.0, 0.0, 0.0, 1.0], 16),
            "no turn is the turn of nothing"
        );
    }

    #[test]
    fn multiples_of_a_power_of_two_come_back_within_half_of_it() {
        for exponent in [-20_i8, -12, 0, 3] {
            for at in -50..=50 {
                let given = f64::from(at) * 0.37;
                let mut bytes = exponential_step(given, exponent).to_le_bytes();
                assert!(Filter::Exponential.undo(&mut bytes, 4));
                let found = f64::from(f32::from_le_bytes(bytes));
                let step = power_of_two(exponent);
                // The mantissa has 23 bits beside its sign.
                let bound = (step / 2.0).max(given.abs() - step * 8_388_607.0);
                assert!((given - found).abs() <= bound, "{given} became {found} of {step}");
            }
        }
    }

    #[test]
    fn unit_vectors_come_back_within_a_degree() {
        let mut worst: f64 = 1.0;
        for i in -20..=20 {
            for j in -20..=20 {
                for k in -20..=20 {
                    let Some(given) = DVec3::new(i.into(), j.into(), k.into()).try_normalize() else {
                        continue;
                    };
                    let sign = if i < 0 { -1.0 } else { 1.0 };
                    let mut bytes = octahedral(given.to_array(), sign).map(i8::cast_unsigned);
                    assert!(Filter::Octahedral.undo(&mut bytes, 4));
                    let [x, y, z, w] = bytes.map(|byte| f64::from(byte.cast_signed()) / 127.0);
                    let found = DVec3::new(x, y, z);
                    assert!((found.length() - 1.0).abs() < 0.012, "{found} is not of unit length");
                    assert_eq!(w, sign);
                    worst = worst.min(found.normalize().dot(given));
                }
            }
        }
        // The cosine of 0.9 degrees.
        assert!(worst > 0.999_876, "{worst}");
        assert_eq!(octahedral([0.0; 3], 0.0), [0, 0, 127, 0], "no direction is some direction");
    }

    #[test]
    fn numbers_of_one_exponent_come_back_within_half_a_step() {
        for size in [0.0, 1e-6, 0.3, 1.0, 7.9, 8.0, 1234.5] {
            let given: Vec<f64> = (0..=50).map(|at| size * (f64::from(at) / 25.0 - 1.0)).collect();
            let mut bytes: Vec<u8> = exponential(&given).into_iter().flat_map(u32::to_le_bytes).collect();
            assert!(Filter::Exponential.undo(&mut bytes, 8), "rows of two");
            let found = bytes.as_chunks::<4>().0.iter().map(|word| f64::from(f32::from_le_bytes(*word)));
            for (given, found) in given.iter().zip(found) {
                // The power of two above the greatest is less than twice as large.
                assert!((given - found).abs() <= size * 2.0 / 65536.0 / 2.0, "{given} became {found}");
            }
        }
        assert_eq!(exponential(&[f64::NAN, f64::INFINITY]).len(), 2);
    }

    #[test]
    fn rows_of_the_wrong_length_are_refused() {
        let refused = |filter: Filter, stride: usize| !filter.undo(&mut vec![0; stride], stride);
        assert!(
            refused(Filter::Octahedral, 12)
                && refused(Filter::Quaternion, 4)
                && refused(Filter::Exponential, 6)
        );
        let mut bytes = [3, 0, 0, 2].to_vec();
        assert!(Filter::Exponential.undo(&mut bytes, 4));
        assert_eq!(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]), 12.0, "3 times 2^2");
    }
}

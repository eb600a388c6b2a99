//! From real numbers to whole ones and to single precision: the places where digits are dropped on purpose.

/// The whole part of a number as an index; negative and NaN give 0, what is too great the greatest index.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, as stated")]
pub fn floor_index(number: f64) -> usize {
    number as usize
}

/// The whole part of a number as a count; negative and NaN give 0, what is too great the greatest count.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, as stated")]
pub fn floor_count(number: f64) -> u32 {
    number as u32
}

/// The whole part of a number as a large count; negative and NaN give 0, what is too great the greatest.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, as stated")]
pub fn floor_large(number: f64) -> u64 {
    number as u64
}

/// The nearest whole number, halves away from zero; NaN gives 0, what is too great the greatest.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "saturates, as stated")]
pub(super) fn nearest(number: f64) -> i64 {
    (number + 0.5_f64.copysign(number)) as i64
}

/// The nearest number of single precision.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "rounds, as stated")]
pub fn single(number: f64) -> f32 {
    number as f32
}

/// A count as a size in memory; on a machine of 32 bits what does not fit gives the greatest.
#[must_use]
pub fn size(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

/// A subscript as a 32-bit index.
///
/// # Panics
/// When there are 2^32 things or more; limits refuse so many long before they exist.
#[must_use]
pub fn count_of(subscript: usize) -> u32 {
    u32::try_from(subscript).expect("limits keep every count below 2^32")
}

#[cfg(test)]
mod tests {
    use super::{floor_count, floor_index, nearest, single};

    #[test]
    fn what_does_not_fit_saturates() {
        assert_eq!((floor_index(2.9), floor_index(-1.0), floor_index(f64::NAN)), (2, 0, 0));
        assert_eq!((floor_count(1e300), floor_count(3.0)), (u32::MAX, 3));
        assert_eq!((nearest(2.5), nearest(-2.5), nearest(-0.4), nearest(f64::NAN)), (3, -3, 0, 0));
        assert_eq!(single(0.1), 0.1_f32);
    }
}

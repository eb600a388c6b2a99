//! Colors as numbers and as bytes.
//!
//! Source: IEC 61966-2-1, sRGB, 1999; Khronos Group, PBR Neutral Tone Mapper, 2024.

use glam::Vec3;

use crate::geometry::number::{floor_count, single, srgb_to_linear};

/// The linear value of an sRGB byte.
#[must_use]
pub(super) fn linear(byte: u8) -> f32 {
    TABLE.with(|table| table[usize::from(byte)])
}

thread_local! {
    static TABLE: [f32; 256] = std::array::from_fn(|byte| single(srgb_to_linear(byte as f64 / 255.0)));
    /// Linear values halfway between those of a byte and the next.
    static HALVES: [f32; 255] = std::array::from_fn(|byte| single(srgb_to_linear((byte as f64 + 0.5) / 255.0)));
}

/// The sRGB byte nearest to a linear value; what lies outside 0 to 1 is cut off.
#[must_use]
pub(super) fn srgb(value: f32) -> u8 {
    let below = HALVES.with(|halves| halves.partition_point(|half| *half < value));
    u8::try_from(below).unwrap_or(u8::MAX)
}

/// The byte nearest to a share of 1; what lies outside 0 to 1 is cut off.
#[must_use]
pub(super) fn byte(share: f32) -> u8 {
    u8::try_from(floor_count(f64::from(share.clamp(0.0, 1.0)) * 255.0 + 0.5)).unwrap_or(u8::MAX)
}

/// Light brought into the range of a screen: colors stay as they are below 0.76, and highlights lose their color only
/// where they must.
#[must_use]
pub(super) fn toned(light: Vec3) -> Vec3 {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = light.min_element();
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = light - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let new = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new) + 1.0);
    (color * (new / peak)).lerp(Vec3::splat(new), white)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::{linear, srgb, toned};

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255 {
            assert_eq!(srgb(linear(byte)), byte);
        }
        assert_eq!((srgb(-1.0), srgb(7.0), srgb(f32::NAN)), (0, 255, 0));
    }

    #[test]
    fn a_middle_grey_is_the_one_of_the_standard() {
        // IEC 61966-2-1: 18 % light is byte 118.
        assert_eq!(srgb(0.18), 118);
    }

    #[test]
    fn the_tone_mapper_grows_and_stays_below_white() {
        let mut last = 0.0;
        for k in 1_u8..100 {
            let value = toned(Vec3::splat(f32::from(k) * 0.1)).x;
            assert!(value > last && value < 1.0, "{k}: {value} after {last}");
            last = value;
        }
    }
}

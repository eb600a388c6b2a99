//! Properties of materials, lights and cameras that change over time, with few keys.
//!
//! Promise: keys run straight from one to the next, or step, and no value is further from the exact one than the property's
//! tolerance, at dense sample times and halfway between them: colors by half a step of 8 bits on a screen (sRGB), opacity and
//! shares by 1/510, angles by a hundredth of a degree, lights and lengths by a thousandth of their greatest. Not promised: the
//! least number of keys there is; a bound between the samples.

use glam::DVec4;

use super::reduce::{Wanted, furthest, rounded, sampled, stepped};
use crate::geometry::number::linear_to_srgb;

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Property {
    /// Color and opacity of a material: linear red, green, blue and alpha.
    Color,
    /// Light that a material gives off: linear red, green, blue.
    Emissive,
    /// How metallic a material is.
    Metallic,
    /// How rough a material is.
    Roughness,
    /// Strength of a normal texture.
    NormalScale,
    /// Strength of an occlusion texture.
    OcclusionStrength,
    /// Opacity below which nothing is there.
    AlphaCutoff,
    /// What the light that a material gives off is multiplied by.
    EmissiveStrength,
    /// Index of refraction.
    Ior,
    /// How much more a body bends blue than red.
    Dispersion,
    /// Share of a coat.
    Clearcoat,
    /// How rough a coat is.
    ClearcoatRoughness,
    /// Strength of a coat's normal texture.
    ClearcoatNormalScale,
    /// Share of light that goes through.
    Transmission,
    /// How thick a body is, metres.
    Thickness,
    /// After how long a way light has the color of a body, metres.
    AttenuationDistance,
    /// That color: linear red, green, blue.
    AttenuationColor,
    /// How much is reflected by no metal.
    Specular,
    /// Its color: linear red, green, blue.
    SpecularColor,
    /// Color of fibers: linear red, green, blue.
    SheenColor,
    /// How rough fibers are.
    SheenRoughness,
    /// Share of a film.
    Iridescence,
    /// Index of refraction of a film.
    IridescenceIor,
    /// How thick a film is, nanometres.
    IridescenceThickness,
    /// How much shine is drawn out.
    Anisotropy,
    /// Along which direction, degrees.
    AnisotropyRotation,
    /// Color of a light: linear red, green, blue.
    LightColor,
    /// Strength of a light, candela or lux.
    Intensity,
    /// How far a light shines, metres.
    Range,
    /// What a camera sees upright, degrees.
    FieldOfView,
    /// What a camera without perspective sees upright, metres.
    Height,
}

/// Keys of a property.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyKeys {
    /// Seconds, increasing, exact in single precision.
    pub times: Vec<f64>,
    /// Values in single precision.
    pub values: Vec<DVec4>,
    /// The greatest distance from the exact value, at the samples and halfway between them, in the unit of the tolerance.
    pub bound: f64,
    /// What was asked for.
    pub tolerance: f64,
}

impl Property {
    /// How many numbers a value has in a file.
    #[must_use]
    pub const fn width(self) -> usize {
        match self {
            Self::Color => 4,
            color if color.is_color() => 3,
            _ => 1,
        }
    }

    /// Whether it is a color.
    #[must_use]
    pub const fn is_color(self) -> bool {
        matches!(
            self,
            Self::Color
                | Self::Emissive
                | Self::AttenuationColor
                | Self::SpecularColor
                | Self::SheenColor
                | Self::LightColor
        )
    }

    /// Whether it is a length, metres.
    #[must_use]
    pub const fn is_length(self) -> bool {
        matches!(self, Self::Thickness | Self::AttenuationDistance | Self::Range | Self::Height)
    }

    /// The least and the greatest number that it may have.
    #[must_use]
    pub const fn range(self) -> (f64, f64) {
        match self {
            Self::NormalScale | Self::ClearcoatNormalScale | Self::AnisotropyRotation => (-1e6, 1e6),
            Self::Intensity | Self::Thickness => (0.0, 1e12),
            Self::EmissiveStrength | Self::IridescenceThickness => (0.0, 1e6),
            Self::Ior | Self::IridescenceIor => (1.0, 100.0),
            Self::Dispersion => (0.0, 1000.0),
            Self::FieldOfView => (0.001, 179.0),
            // Nothing is seen by what has no height.
            Self::AttenuationDistance | Self::Range | Self::Height => (1e-6, 1e12),
            _ => (0.0, 1.0),
        }
    }

    /// How far a value may be from the exact one, where the greatest of all is known.
    fn tolerance(self, greatest: f64) -> f64 {
        match self {
            Self::FieldOfView | Self::AnisotropyRotation => 0.01,
            _ if self.range() == (0.0, 1.0) => 0.5 / 255.0,
            _ => greatest / 1000.0,
        }
    }

    /// The greatest of its numbers.
    fn greatest(self, value: &DVec4) -> f64 {
        value.to_array().into_iter().take(self.width()).map(f64::abs).fold(0.0, f64::max)
    }

    /// How far two values are apart: colors as screens show them.
    #[must_use]
    pub fn gap(self, a: DVec4, b: DVec4) -> f64 {
        let shown = |number: f64| linear_to_srgb(number.clamp(0.0, 1.0));
        let mut gap = 0.0_f64;
        for part in 0..self.width() {
            let (a, b) = (a[part], b[part]);
            let screen = self.is_color() && part < 3;
            gap = gap.max(if screen { (shown(a) - shown(b)).abs() } else { (a - b).abs() });
        }
        gap
    }

    /// The fewest keys found for a course; with the times of its `steps` where it jumps from key to key. The tolerance of
    /// `wanted` is not asked.
    #[must_use]
    pub fn reduced(
        self,
        exact: &dyn Fn(f64) -> DVec4,
        steps: Option<&[f64]>,
        wanted: &Wanted,
    ) -> PropertyKeys {
        if let Some(steps) = steps {
            let (times, values) = stepped(exact, steps);
            let values: Vec<DVec4> = values.into_iter().map(rounded).collect();
            let greatest = values.iter().map(|value| self.greatest(value)).fold(0.0, f64::max);
            return PropertyKeys { times, values, bound: 0.0, tolerance: self.tolerance(greatest) };
        }
        let mut rate = wanted.rate;
        loop {
            let times = sampled(wanted, rate);
            let exact: Vec<DVec4> = times.iter().map(|time| exact(*time)).collect();
            let keys = self.within(&times, &exact);
            if keys.bound <= keys.tolerance || rate >= 15.0 * wanted.rate || times.len() > wanted.most {
                return keys;
            }
            rate *= 2.0;
        }
    }

    /// The fewest keys found for some samples, of which those at even places may be keys.
    fn within(self, times: &[f64], exact: &[DVec4]) -> PropertyKeys {
        let tolerance = self.tolerance(exact.iter().map(|value| self.greatest(value)).fold(0.0, f64::max));
        if exact.iter().all(|value| self.gap(*value, exact[0]) <= tolerance) {
            let bound = exact.iter().map(|value| self.gap(*value, exact[0])).fold(0.0, f64::max);
            return PropertyKeys { times: vec![times[0]], values: vec![rounded(exact[0])], bound, tolerance };
        }
        // The greatest gap between two samples that are keys.
        let off = |from: usize, to: usize| {
            let (start, span) = (times[from], times[to] - times[from]);
            let (low, high) = (rounded(exact[from]), rounded(exact[to]));
            let gap =
                |inner: usize| self.gap(low + (high - low) * ((times[inner] - start) / span), exact[inner]);
            (from + 1..to).map(gap).fold(0.0, f64::max)
        };
        let (mut kept, mut values, mut bound) = (vec![times[0]], vec![rounded(exact[0])], 0.0_f64);
        let (mut from, last) = (0, times.len() - 1);
        while from < last {
            let to = furthest(from, last, |to| off(from, to) <= tolerance);
            bound = bound.max(off(from, to));
            kept.push(times[to]);
            values.push(rounded(exact[to]));
            from = to;
        }
        PropertyKeys { times: kept, values, bound, tolerance }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{Property, Wanted};

    fn wanted(stops: &[f64]) -> Wanted {
        Wanted { duration: 2.0, tolerance: 0.0, rate: 60.0, stops: stops.to_vec(), most: 100_000 }
    }

    /// The value of keys at a time, as a player has it.
    fn played(keys: &super::PropertyKeys, time: f64) -> DVec4 {
        let next = keys.times.partition_point(|key| *key <= time);
        if next == 0 || next == keys.times.len() {
            return keys.values[next.saturating_sub(1)];
        }
        let share = (time - keys.times[next - 1]) / (keys.times[next] - keys.times[next - 1]);
        keys.values[next - 1].lerp(keys.values[next], share)
    }

    #[test]
    fn a_straight_way_has_its_ends() {
        let fading = |time: f64| DVec4::new(1.0 - time / 2.0, time / 2.0, 0.25, 1.0);
        let keys = Property::Color.reduced(&fading, None, &wanted(&[]));
        assert_eq!(keys.times, [0.0, 2.0]);
        assert!(keys.bound <= 1e-6, "{}", keys.bound);
    }

    #[test]
    fn every_moment_is_within_the_tolerance() {
        let glowing = |time: f64| {
            let shine = 0.5 - 0.5 * crate::geometry::number::sin_cos_degrees(time * 360.0).1;
            DVec4::new(shine, shine * shine, 0.0, 0.0)
        };
        let keys = Property::Emissive.reduced(&glowing, None, &wanted(&[]));
        assert!(keys.bound <= keys.tolerance && keys.times.len() < 121, "{} keys", keys.times.len());
        for step in 0..=4000 {
            let time = f64::from(step) / 2000.0;
            let gap = Property::Emissive.gap(played(&keys, time), glowing(time));
            // Between the samples a little more: near black the screen's numbers grow thirteen times as fast as light.
            assert!(gap <= 1.2 * keys.tolerance, "{gap} at {time}");
        }
    }

    #[test]
    fn steps_stay_steps_and_what_rests_has_one_key() {
        let blinking = |time: f64| DVec4::X * if time < 0.5 { 0.0 } else { 9.0 };
        let keys = Property::Intensity.reduced(&blinking, Some(&[0.0, 0.5, 1.0]), &wanted(&[]));
        assert_eq!((keys.times, keys.bound), (vec![0.0, 0.5], 0.0));
        let keys = Property::Intensity.reduced(&|_| DVec4::X * 4.0, None, &wanted(&[]));
        assert_eq!((keys.times, keys.values), (vec![0.0], vec![DVec4::X * 4.0]));
    }
}

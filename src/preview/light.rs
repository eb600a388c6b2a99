//! How surfaces reflect light, and the lights of the preview.
//!
//! Source: B. T. Phong, Illumination for Computer Generated Pictures, CACM 18, 1975; H. Gouraud, Continuous Shading of Curved
//! Surfaces, 1971; Khronos Group, glTF 2.0 Specification, 2021, appendix B (metal and roughness: B. Walter and others,
//! 2007, and C. Schlick, 1994); B. Karis, Physically Based Shading on Mobile, 2014 (light from all around).

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::number::{exp, pow, single};

/// A light from one side, far away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Towards it, of length 1.
    pub(super) towards: DVec3,
    pub(super) strength: f32,
}

/// The lights of a picture; the first casts shadows.
pub(super) fn lights(axes: &DMat3) -> [Light; 3] {
    let at = |x: f64, y: f64, z: f64, strength: f32| Light {
        towards: (*axes * DVec3::new(x, y, z)).normalize(),
        strength,
    };
    [at(-0.55, 0.8, 0.75, 2.3), at(0.9, 0.15, 0.55, 0.55), at(0.35, 0.6, -0.9, 0.9)]
}

/// Light that arrives from all around, from below and from above.
const GROUND: Vec3 = Vec3::new(0.33, 0.31, 0.29);
const SKY: Vec3 = Vec3::new(0.72, 0.77, 0.84);

/// Light from around that arrives from a direction, seen by a surface of some roughness.
fn around(direction: DVec3, roughness: f32) -> Vec3 {
    let width = 0.15 + 0.85 * roughness;
    let part = (single(direction.y) / width * 0.5 + 0.5).clamp(0.0, 1.0);
    GROUND.lerp(SKY, part * part * (3.0 - 2.0 * part))
}

/// A surface at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) color: Vec3,
    pub(super) metallic: f32,
    pub(super) roughness: f32,
    /// Share of the light from around that arrives.
    pub(super) open: f32,
    pub(super) normal: DVec3,
    /// Towards the eye.
    pub(super) eye: DVec3,
}

impl Surface {
    /// The light that it reflects; `shadow` is the share of the first light that arrives.
    pub(super) fn reflected(&self, lights: &[Light], shadow: f32) -> Vec3 {
        let straight = Vec3::splat(0.04).lerp(self.color, self.metallic);
        let diffuse = self.color * (1.0 - self.metallic);
        let square = (self.roughness * self.roughness).max(0.002);
        let facing = single(self.normal.dot(self.eye)).max(1e-3);
        let mut sum = Vec3::ZERO;
        for (number, light) in lights.iter().enumerate() {
            let falls = single(self.normal.dot(light.towards));
            if falls <= 0.0 {
                continue;
            }
            let half = (light.towards + self.eye).normalize_or(self.normal);
            let (across, along) =
                (single(self.normal.dot(half)).max(0.0), single(self.eye.dot(half)).max(0.0));
            let fresnel = straight + (Vec3::ONE - straight) * fifth(1.0 - along);
            let arrives = if number == 0 { shadow } else { 1.0 } * light.strength * falls;
            let shine = distribution(across, square) * visibility(falls, facing, square);
            sum += (diffuse * (Vec3::ONE - fresnel) / std::f32::consts::PI + fresnel * shine) * arrives;
        }
        let mirrored = self.normal * (2.0 * self.normal.dot(self.eye)) - self.eye;
        sum + (diffuse * around(self.normal, 1.0)
            + around(mirrored, self.roughness) * mirror(straight, self.roughness, facing))
            * self.open
    }

    /// The light that it reflects by Phong's rule: a part from everywhere, a part from where a light falls, and a
    /// highlight around where it is mirrored.
    pub(super) fn phong(&self, lights: &[Light], shadow: f32) -> Vec3 {
        let shine = exp(f64::from(1.0 - self.roughness) * 5.0);
        let highlight = 0.5 * (1.0 - self.roughness);
        let mut sum = self.color * 0.25;
        for (number, light) in lights.iter().enumerate() {
            let falls = self.normal.dot(light.towards);
            if falls <= 0.0 {
                continue;
            }
            let arrives = if number == 0 { shadow } else { 1.0 } * light.strength * 0.35;
            let mirrored = self.normal * (2.0 * falls) - light.towards;
            let seen = single(pow(mirrored.dot(self.eye).max(0.0), shine));
            sum += (self.color * single(falls) + Vec3::splat(highlight * seen)) * arrives;
        }
        sum
    }
}

fn fifth(x: f32) -> f32 {
    let square = x * x;
    square * square * x
}

/// The share of facets that mirror (GGX).
fn distribution(across: f32, alpha: f32) -> f32 {
    let square = alpha * alpha;
    let bottom = across * across * (square - 1.0) + 1.0;
    square / (std::f32::consts::PI * bottom * bottom)
}

/// How much of them is neither hidden nor in shadow (Smith), over four times both cosines.
fn visibility(falls: f32, facing: f32, alpha: f32) -> f32 {
    let square = alpha * alpha;
    let one = falls * (facing * facing * (1.0 - square) + square).sqrt();
    let other = facing * (falls * falls * (1.0 - square) + square).sqrt();
    0.5 / (one + other).max(1e-6)
}

/// The share of the light from around that is mirrored (Karis' fit).
fn mirror(straight: Vec3, roughness: f32, facing: f32) -> Vec3 {
    let (x, y) = (1.0 - roughness, 0.0425 - 0.0275 * roughness);
    let power = single(exp(-9.28 * f64::from(facing) * std::f64::consts::LN_2));
    let a = (x * x).min(power) * x + y;
    let scale = -1.04 * a + 1.04 - 0.572 * roughness;
    let bias = 1.04 * a - 0.04 + 0.022 * roughness;
    straight * scale.max(0.0) + Vec3::splat(bias.max(0.0))
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3, Vec3};

    use super::{Light, Surface, lights};

    fn white(normal: DVec3) -> Surface {
        Surface { color: Vec3::ONE, metallic: 0.0, roughness: 1.0, open: 0.0, normal, eye: DVec3::Z }
    }

    #[test]
    fn light_falls_by_the_cosine() {
        let light = [Light { towards: DVec3::Z, strength: 1.0 }];
        let straight = white(DVec3::Z).reflected(&light, 1.0).x;
        let normal = DVec3::new(0.75_f64.sqrt(), 0.0, 0.5);
        let slanted = white(normal).reflected(&light, 1.0).x;
        // The diffuse part halves at 60 degrees; the highlight of a rough surface is small.
        assert!((slanted / straight - 0.5).abs() < 0.06, "{slanted} of {straight}");
        assert_eq!(white(-DVec3::Z).reflected(&light, 1.0), Vec3::ZERO, "the other side is dark");
        assert_eq!(white(DVec3::Z).reflected(&light, 0.0), Vec3::ZERO, "so is what stands in shadow");
    }

    #[test]
    fn no_more_light_comes_back_than_arrives() {
        // The sum over the half sphere of light from everywhere, by many directions of the eye (reciprocity).
        for roughness in [0.2, 0.5, 1.0] {
            for metallic in [0.0, 1.0] {
                let mut sum = 0.0;
                let count = 64;
                for row in 0..count {
                    for column in 0..2 * count {
                        let height = (f64::from(row) + 0.5) / f64::from(count);
                        let turn = f64::from(column) * std::f64::consts::PI / f64::from(count);
                        let radius = (1.0 - height * height).sqrt();
                        let (sine, cosine) = crate::geometry::number::sin_cos(turn);
                        let towards = DVec3::new(radius * cosine, radius * sine, height);
                        let surface = Surface { metallic, roughness, ..white(DVec3::Z) };
                        let light = Light { towards, strength: 1.0 };
                        sum += surface.reflected(&[light], 1.0).x * std::f32::consts::PI
                            / (count * count) as f32;
                    }
                }
                assert!(sum > 0.3 && sum < 1.02, "roughness {roughness}, metallic {metallic}: {sum}");
                if roughness == 1.0 && metallic == 1.0 {
                    // With one facet as likely as another the sum is the integral of x / (1 + x) from 0 to 1.
                    assert!((sum - (1.0 - std::f32::consts::LN_2)).abs() < 1e-3, "{sum}");
                }
            }
        }
    }

    #[test]
    fn the_lights_move_with_the_camera() {
        let [key, ..] = lights(&DMat3::IDENTITY);
        let turned = DMat3::from_cols(DVec3::Z, DVec3::Y, -DVec3::X);
        assert!((turned * key.towards - lights(&turned)[0].towards).length() < 1e-12);
    }
}

//! Tracks of properties: what changes of materials, and of the lights and cameras of nodes.

use glam::DVec4;

use super::Builder;
use super::clip::{seam_gap, times};
use super::course::Moved;
use super::profile::show;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, LimitRule, MotionPath, Sp};
use crate::model::{Lens, MaterialHandle, Owner, PropertyTrack};
use crate::motion::{Course, Path, Property, Track};

/// A number that leaves its range by rounding alone is in it.
const ROUNDING: f64 = 1e-9;

impl Builder<'_> {
    /// The tracks of a clip's properties, after those of a file; none where one of them is wrong.
    pub(super) fn properties(
        &mut self,
        clip: &spec::Clip,
        imported: Vec<(PropertyTrack, Span)>,
        duration: f64,
    ) -> Option<Vec<PropertyTrack>> {
        let mut made = imported;
        let mut good = true;
        for track in clip.track.iter().filter(|track| is_property(track)) {
            let Some(one) = self.property(clip, track, duration) else {
                good = false;
                continue;
            };
            let same = |other: &&(PropertyTrack, Span)| {
                other.0.owner == one.owner && other.0.property == one.property
            };
            if let Some((_, first)) = made.iter().find(same) {
                let (what, of) = (self.path_of(track), self.owner_of(track));
                let report =
                    Diagnostic::error(Code::BadTrack, format!("the {what} of `{of}` has two tracks"))
                        .at(track.span, "changed once more")
                        .also(*first, "changed here")
                        .help(
                            "write one track; the color and opacity of a material are one, of four numbers",
                        );
                self.report(report);
                good = false;
            }
            made.push((one, track.span));
        }
        good.then(|| made.into_iter().map(|(track, _)| track).collect())
    }

    fn path_of(&self, track: &spec::ClipTrack) -> &'static str {
        track.path.as_ref().map_or("property", |path| path.value.text())
    }

    fn owner_of<'t>(&self, track: &'t spec::ClipTrack) -> &'t str {
        let node = track.node.as_ref().map(|node| node.value.0.as_str());
        track.material.as_ref().map(|material| material.value.0.as_str()).or(node).unwrap_or_default()
    }

    fn property(
        &mut self,
        clip: &spec::Clip,
        track: &Sp<spec::ClipTrack>,
        duration: f64,
    ) -> Option<PropertyTrack> {
        let path = track.path.as_ref()?;
        let (owner, property) = match &track.material {
            Some(material) => {
                let handle = self.material(&material.value)?;
                (self.wearing(handle), self.of_material(handle, path)?)
            }
            None => {
                let index = self.spec.nodes.get_index_of(&track.node.as_ref()?.value.0)?;
                (Owner::Node(index), self.of_node(index, path)?)
            }
        };
        let moved = Moved {
            joint: false,
            share: 0.0,
            duration,
            looped: clip.r#loop.value,
            color: property.is_color(),
        };
        let (course, count, span) = match &track.along {
            Some(along) => (self.color_along(track, along, &moved)?, 3, along.span()),
            None => {
                let (law, count, span) = self.law_of(track, &moved)?;
                (Course::Offset(law), count, span)
            }
        };
        let is_alpha = path.value == MotionPath::Alpha;
        let wanted: &[usize] = match property {
            _ if is_alpha => &[1],
            Property::Color => &[3, 4],
            property if property.is_color() => &[3],
            _ => &[1],
        };
        if !wanted.contains(&count) {
            let demand = if property.is_color() && !is_alpha { "red, green and blue" } else { "one number" };
            let numbers = if count == 1 { "1 number".to_owned() } else { format!("{count} numbers") };
            let message = format!("{} is {demand}, found {numbers}", path.value.text());
            self.report(Diagnostic::error(Code::KeyValue, message).at(span, numbers));
            return None;
        }
        let clamp = clip.limits.value == LimitRule::Clamp;
        let made =
            PropertyTrack { owner, property, first: if is_alpha { 3 } else { 0 }, count, course, clamp };
        self.check_range(&made, (track, path.value), duration)?;
        self.check_property_seam(&made, track, (clip, duration))?;
        Some(made)
    }

    /// A material, and those that shapes with normal maps have in its place.
    fn wearing(&self, handle: MaterialHandle) -> Owner {
        let drawn = self.model.normal_maps.iter();
        let made = drawn.filter(|map| self.model.shape(map.shape).options.material == Some(handle));
        Owner::Material(std::iter::once(handle).chain(made.map(|map| map.material)).collect())
    }

    /// As `wearing`, of several materials.
    pub(super) fn wearing_all(&self, handles: &[MaterialHandle]) -> Owner {
        let all = handles.iter().flat_map(|handle| match self.wearing(*handle) {
            Owner::Material(all) => all,
            Owner::Node(_) => Vec::new(),
        });
        Owner::Material(all.collect())
    }

    fn of_material(&mut self, handle: MaterialHandle, path: &Sp<MotionPath>) -> Option<Property> {
        let material = self.model.material(handle);
        let property = property_of(path.value);
        if property.is_some_and(|property| material.value(property).is_some()) {
            return property;
        }
        let missing = match path.value {
            MotionPath::NormalScale => "no `normal-texture`",
            MotionPath::OcclusionStrength => "no `occlusion-texture`",
            MotionPath::AlphaCutoff => "no `alpha = \"mask\"`",
            MotionPath::EmissiveStrength | MotionPath::Ior | MotionPath::Dispersion => "none at rest",
            MotionPath::ClearcoatNormalScale if material.optics.clearcoat.is_some() => {
                "no `normal-texture` of its `clearcoat`"
            }
            MotionPath::Clearcoat | MotionPath::ClearcoatRoughness | MotionPath::ClearcoatNormalScale => {
                "no `clearcoat`"
            }
            MotionPath::Transmission => "no `transmission`",
            MotionPath::AttenuationDistance if material.optics.volume.is_some() => {
                "no `attenuation-distance` at rest"
            }
            MotionPath::Thickness | MotionPath::AttenuationDistance | MotionPath::AttenuationColor => {
                "no `volume`"
            }
            MotionPath::Specular | MotionPath::SpecularColor => "no `specular`",
            MotionPath::SheenColor | MotionPath::SheenRoughness => "no `sheen`",
            MotionPath::Iridescence | MotionPath::IridescenceIor | MotionPath::IridescenceThickness => {
                "no `iridescence`"
            }
            MotionPath::Anisotropy | MotionPath::AnisotropyRotation => "no `anisotropy`",
            _ => "no light and no camera",
        };
        let message = format!("material `{}` has no `{}`", material.name, path.value.text());
        let report = Diagnostic::error(Code::NoProperty, message).at(path.span, format!("it has {missing}"));
        self.report(report);
        None
    }

    fn of_node(&mut self, node: usize, path: &Sp<MotionPath>) -> Option<Property> {
        let own = &self.model.nodes[node];
        let lens = own.camera.map(|camera| camera.lens);
        let (table, missing) = match (path.value, &own.light, lens) {
            (MotionPath::Color, Some(_), _) => return Some(Property::LightColor),
            (MotionPath::Intensity, Some(_), _) => return Some(Property::Intensity),
            (MotionPath::Range, Some(light), _) if light.range.is_some() => return Some(Property::Range),
            (MotionPath::FieldOfView, _, Some(Lens::Perspective { .. })) => {
                return Some(Property::FieldOfView);
            }
            (MotionPath::Height, _, Some(Lens::Parallel { .. })) => return Some(Property::Height),
            (MotionPath::Range, Some(_), _) => ("light", "a light that shines without end"),
            (MotionPath::FieldOfView, _, Some(_)) => ("camera", "a camera without perspective"),
            (MotionPath::Height, _, Some(_)) => ("camera", "a camera with perspective"),
            (MotionPath::FieldOfView | MotionPath::Height, ..) => ("camera", "no camera"),
            (MotionPath::Color | MotionPath::Intensity | MotionPath::Range, ..) => ("light", "no light"),
            _ => ("", "properties of lights and cameras; name its material with `material`"),
        };
        let message = format!("node `{}` has no `{}`", own.name, path.value.text());
        let report = Diagnostic::error(Code::NoProperty, message).at(path.span, format!("it has {missing}"));
        let help = format!("write `[node.{}.{table}]` with `{}`", own.name, path.value.text());
        self.report(if table.is_empty() { report } else { report.help(help) });
        None
    }

    /// No number leaves what its property may be; the worst moment is told.
    fn check_range(
        &mut self,
        made: &PropertyTrack,
        (track, path): (&Sp<spec::ClipTrack>, MotionPath),
        duration: f64,
    ) -> Option<()> {
        if made.clamp {
            return Some(());
        }
        let (least, most) = made.property.range();
        let playing = Track::new(&made.course);
        let excess = |time: f64| {
            let numbers = playing.at(time).to_array().into_iter().take(made.count);
            let beyond = |number: f64| (f64::max(least - number, number - most), number);
            numbers
                .map(beyond)
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(excess, number)| (excess, number, time))
        };
        let all = times(&made.course, duration).into_iter().filter_map(excess);
        let worst = all.max_by(|a, b| a.0.total_cmp(&b.0).then(b.2.total_cmp(&a.2)));
        let Some((_, number, time)) = worst.filter(|(excess, ..)| *excess > ROUNDING) else {
            return Some(());
        };
        let message = format!(
            "{} of `{}` is {} at {} s, and must be from {} to {}",
            path.text(),
            self.owner_of(track),
            show(number),
            show(time),
            show(least),
            show(most)
        );
        let report = Diagnostic::error(Code::PropertyRange, message)
            .at(track.span, "this track")
            .help("keep it within the range, or write `limits = \"clamp\"` for the clip");
        self.report(report);
        None
    }

    /// A loop ends as it begins.
    fn check_property_seam(
        &mut self,
        made: &PropertyTrack,
        track: &Sp<spec::ClipTrack>,
        (clip, duration): (&spec::Clip, f64),
    ) -> Option<()> {
        if !clip.r#loop.value {
            return Some(());
        }
        let playing = Track::new(&made.course);
        let value = |time: f64| made.composed(DVec4::ZERO, playing.at(time));
        let Some(gap) = seam_gap(Path::Scale, value(0.0), value(duration)) else { return Some(()) };
        let (what, of) = (self.path_of(track), self.owner_of(track));
        let message =
            format!("this clip is a loop, but the {what} of `{of}` ends {gap} from where it begins");
        let report = Diagnostic::error(Code::LoopSeam, message)
            .at(track.span, "this track")
            .also(clip.r#loop.span, "played again and again")
            .help("end with the value of the start, or leave `loop` out");
        self.report(report);
        None
    }
}

/// The property of materials that a path names.
const fn property_of(path: MotionPath) -> Option<Property> {
    Some(match path {
        MotionPath::Color | MotionPath::Alpha => Property::Color,
        MotionPath::Emissive => Property::Emissive,
        MotionPath::Metallic => Property::Metallic,
        MotionPath::Roughness => Property::Roughness,
        MotionPath::NormalScale => Property::NormalScale,
        MotionPath::OcclusionStrength => Property::OcclusionStrength,
        MotionPath::AlphaCutoff => Property::AlphaCutoff,
        MotionPath::EmissiveStrength => Property::EmissiveStrength,
        MotionPath::Ior => Property::Ior,
        MotionPath::Dispersion => Property::Dispersion,
        MotionPath::Clearcoat => Property::Clearcoat,
        MotionPath::ClearcoatRoughness => Property::ClearcoatRoughness,
        MotionPath::ClearcoatNormalScale => Property::ClearcoatNormalScale,
        MotionPath::Transmission => Property::Transmission,
        MotionPath::Thickness => Property::Thickness,
        MotionPath::AttenuationDistance => Property::AttenuationDistance,
        MotionPath::AttenuationColor => Property::AttenuationColor,
        MotionPath::Specular => Property::Specular,
        MotionPath::SpecularColor => Property::SpecularColor,
        MotionPath::SheenColor => Property::SheenColor,
        MotionPath::SheenRoughness => Property::SheenRoughness,
        MotionPath::Iridescence => Property::Iridescence,
        MotionPath::IridescenceIor => Property::IridescenceIor,
        MotionPath::IridescenceThickness => Property::IridescenceThickness,
        MotionPath::Anisotropy => Property::Anisotropy,
        MotionPath::AnisotropyRotation => Property::AnisotropyRotation,
        MotionPath::Translation
        | MotionPath::Rotation
        | MotionPath::Scale
        | MotionPath::Intensity
        | MotionPath::Range
        | MotionPath::FieldOfView
        | MotionPath::Height => return None,
    })
}

/// Whether a track is one of a property.
pub(super) fn is_property(track: &spec::ClipTrack) -> bool {
    track.path.as_ref().is_some_and(|path| path.value.is_property())
}

//! Properties that clips change, into keys.

use glam::DVec4;

use crate::model::{self, Lens, MaterialHandle, Model, PropertyTrack};
use crate::motion::{Property, Track, Wanted};
use crate::scene::{Owner, PropertyChannel, Scene};

/// The channels of a property, one for each thing in the scene that has it; none where nothing there does.
pub(super) fn channels(
    (model, used): (&Model, &[MaterialHandle]),
    scene: &Scene,
    track: &PropertyTrack,
    wanted: &Wanted,
) -> Vec<PropertyChannel> {
    let place = |handle: &MaterialHandle| used.iter().position(|known| known == handle);
    let owners: Vec<Owner> = match &track.owner {
        model::Owner::Material(handles) => handles.iter().filter_map(place).map(Owner::Material).collect(),
        model::Owner::Node(node) => vec![Owner::Node(*node)],
    };
    let playing = Track::new(&track.course);
    let unit = if track.property.is_length() { model.frame.unit } else { 1.0 };
    let channel = |owner: Owner| {
        let rest = at_rest(scene, owner, track.property);
        let exact = |time: f64| track.composed(rest, playing.at(time)) * unit;
        let stops = track.course.stops();
        let steps = track.course.stepped().then_some(stops.as_slice());
        let keys = track.property.reduced(&exact, steps, wanted);
        let width = track.property.width();
        PropertyChannel {
            owner,
            property: track.property,
            stepped: steps.is_some() && keys.times.len() > 1,
            values: keys.values.iter().flat_map(|value| value.to_array().into_iter().take(width)).collect(),
            times: keys.times,
            bound: keys.bound,
            tolerance: keys.tolerance,
        }
    };
    owners.into_iter().map(channel).collect()
}

/// Something lasts until the end, so that a player gives the clip its duration.
pub(super) fn last_to_the_end(channels: &mut [PropertyChannel], end: f64) {
    let end = f64::from(crate::geometry::number::single(end));
    if channels.iter().any(|channel| channel.times.last() == Some(&end)) {
        return;
    }
    if let Some(channel) = channels.first_mut() {
        let width = channel.property.width();
        if channel.times[0] > 0.0 {
            let first = channel.values[..width].to_vec();
            channel.times.insert(0, 0.0);
            channel.values.splice(0..0, first);
        }
        let last = channel.values[channel.values.len() - width..].to_vec();
        channel.times.push(end);
        channel.values.extend(last);
    }
}

/// The value of a property where no clip changes it.
fn at_rest(scene: &Scene, owner: Owner, property: Property) -> DVec4 {
    let rgb = |[red, green, blue]: [f64; 3]| DVec4::new(red, green, blue, 0.0);
    match owner {
        Owner::Material(material) => scene.materials[material].value(property).unwrap_or_default(),
        Owner::Node(node) => {
            let node = &scene.nodes[node];
            match (property, &node.light, node.camera.map(|camera| camera.lens)) {
                (Property::LightColor, Some(light), _) => rgb(light.color),
                (Property::Intensity, Some(light), _) => DVec4::X * light.intensity,
                (Property::FieldOfView, _, Some(Lens::Perspective { upright })) => DVec4::X * upright,
                (Property::Height, _, Some(Lens::Parallel { height })) => DVec4::X * height,
                _ => DVec4::ZERO,
            }
        }
    }
}

//! Skeletons into nodes, skins into weights, clips into keys.

use glam::{DAffine3, DVec3, DVec4};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::{Loose, RealizeError};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::Bounds;
use crate::model::{Clip, ClipTrack, Model, NamedSkeleton, ShapeHandle, Target, WeightRule};
use crate::motion::{
    Influences, Joint, Moving, Path, Rig, Track, Transform, Wanted, Weights, envelope_weights, reduce,
    rigid_weights, weights_of,
};
use crate::scene::{Animation, Channel, Node, Scene, Skin};

/// The most samples of a motion, times what is watched.
const MOST_SAMPLES: usize = 8_000_000;

/// A default tolerance is the diagonal of the bounding box over this.
const FINE: f64 = 1e4;

/// Where the nodes of skeletons stand among the nodes of the scene.
struct Places {
    /// For each skeleton its first joint.
    joints: Vec<usize>,
    /// For each skeleton its first socket.
    sockets: Vec<usize>,
}

/// Adds to a scene what moves it. `shapes` are those of its geometries.
pub(super) fn add(
    model: &Model,
    shapes: &[ShapeHandle],
    scene: &mut Scene,
) -> Result<Vec<Loose>, Vec<(ShapeHandle, RealizeError)>> {
    let places = skeleton_nodes(model, scene);
    for (index, node) in model.nodes.iter().enumerate() {
        if let Some(socket) = node.socket {
            scene.nodes[index].parent = Some(places.sockets[socket.skeleton] + socket.socket);
        }
    }
    skins(model, shapes, &places, scene)?;
    let rig = rig(model, &places, scene);
    let baked: Vec<(Animation, Option<Loose>)> = model
        .clips
        .par_iter()
        .enumerate()
        .map(|(index, clip)| bake(model, &places, &rig, (index, clip)))
        .collect();
    let (animations, loose): (Vec<_>, Vec<_>) = baked.into_iter().unzip();
    scene.animations = animations;
    Ok(loose.into_iter().flatten().collect())
}

fn skeleton_nodes(model: &Model, scene: &mut Scene) -> Places {
    let mut places = Places { joints: Vec::new(), sockets: Vec::new() };
    for named in &model.skeletons {
        let first = scene.nodes.len();
        for joint in &named.skeleton.joints {
            let parent = joint.bone.parent.map(|parent| first + parent).or(named.parent);
            let name = free_name(scene, named, &joint.bone.name);
            scene.nodes.push(node(name, parent, &joint.rest));
        }
        places.joints.push(first);
        places.sockets.push(scene.nodes.len());
        for socket in &named.sockets {
            let name = free_name(scene, named, &socket.name);
            let node = node(name, Some(first + socket.joint), &socket.place);
            scene.nodes.push(Node { socket: true, ..node });
        }
    }
    places
}

/// A name for a joint: its own, or with the skeleton's before it where another node has it.
fn free_name(scene: &Scene, skeleton: &NamedSkeleton, name: &str) -> String {
    let taken = scene.nodes.iter().any(|node| node.name == name);
    if taken { format!("{}.{name}", skeleton.name) } else { name.to_owned() }
}

fn node(name: String, parent: Option<usize>, place: &Transform) -> Node {
    Node {
        name,
        mesh: None,
        skin: None,
        socket: false,
        parent,
        translation: place.translation,
        rotation: place.rotation,
        scale: place.scale,
    }
}

fn skins(
    model: &Model,
    shapes: &[ShapeHandle],
    places: &Places,
    scene: &mut Scene,
) -> Result<(), Vec<(ShapeHandle, RealizeError)>> {
    let mut errors = Vec::new();
    for (index, skin) in model.skins.iter().enumerate() {
        let Some(geometry) = shapes.iter().position(|shape| *shape == skin.shape) else { continue };
        if !scene.geometries[geometry].wire.is_empty() {
            errors.push((skin.shape, RealizeError::SkinnedWire { skin: index }));
            continue;
        }
        match influences(model, index, &scene.geometries[geometry].mesh) {
            Ok(influences) => scene.geometries[geometry].influences = Some(influences),
            Err(error) => {
                errors.push((skin.shape, error));
                continue;
            }
        }
        let joints = &model.skeletons[skin.skeleton].skeleton.joints;
        let first = places.joints[skin.skeleton];
        let shown = scene
            .nodes
            .iter_mut()
            .filter(|node| node.mesh.is_some_and(|mesh| scene.meshes[mesh].geometry == geometry));
        shown.for_each(|node| node.skin = Some(scene.skins.len()));
        scene.skins.push(Skin {
            name: skin.name.clone(),
            joints: (first..first + joints.len()).collect(),
            inverse_bind: joints.iter().map(|joint| joint.bind().inverse()).collect(),
            root: first,
        });
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}

/// The joints that carry each point of a mesh, as indices in the skeleton.
fn influences(model: &Model, index: usize, mesh: &Mesh) -> Result<Vec<Influences>, RealizeError> {
    let skin = &model.skins[index];
    let named = &model.skeletons[skin.skeleton];
    let joints: Vec<&Joint> = skin.joints.iter().map(|joint| &named.skeleton.joints[*joint]).collect();
    let mut weights = match &skin.rule {
        WeightRule::Rigid => rigid_weights(&mesh.points, &joints),
        WeightRule::Envelope => {
            let envelopes = skin.joints.iter().map(|joint| named.envelopes[*joint]);
            let joints: Vec<_> = joints.iter().copied().zip(envelopes).collect();
            envelope_weights(&mesh.points, &joints)
        }
        WeightRule::Explicit(formulas) => {
            let back = model.frame.map().inverse();
            weights_of(&mesh.points, formulas.len(), |point, weights| {
                let place = back.transform_point3(point).to_array();
                for (weight, formula) in weights.iter_mut().zip(formulas) {
                    let [value] = formula.evaluate::<f64, 1>(&place);
                    // What has no value carries nothing.
                    *weight = if value.is_finite() { value.max(0.0) } else { 0.0 };
                }
            })
        }
    };
    if let (Some(first), count) = weights.without() {
        let place = model.frame.map().inverse().transform_point3(mesh.points[first]);
        let distance =
            joints.iter().map(|joint| joint.distance(mesh.points[first])).fold(f64::INFINITY, f64::min);
        return Err(RealizeError::Unweighted {
            skin: index,
            count,
            of: mesh.points.len(),
            place,
            distance: distance / model.frame.unit,
        });
    }
    if skin.smoothing > 0 {
        weights.smooth(mesh, skin.smoothing);
    }
    Ok(in_skeleton(&weights, &skin.joints))
}

/// Weights with the joints' indices in the skeleton, not in the skin.
fn in_skeleton(weights: &Weights, joints: &[usize]) -> Vec<Influences> {
    let mut all = weights.written();
    for influence in all.iter_mut().flatten().filter(|influence| influence.weight > 0) {
        let joint = joints[usize::from(influence.joint)];
        influence.joint = u8::try_from(joint).unwrap_or(u8::MAX);
    }
    all
}

/// What a motion is judged by: boxes of what nodes and joints carry.
fn rig(model: &Model, places: &Places, scene: &Scene) -> Rig {
    let place =
        |node: &Node| Transform { translation: node.translation, rotation: node.rotation, scale: node.scale };
    let mut points: Vec<Vec<DVec3>> = scene.nodes.iter().map(|node| shown_box(scene, node)).collect();
    for (named, first) in model.skeletons.iter().zip(&places.joints) {
        for (index, joint) in named.skeleton.joints.iter().enumerate() {
            points[first + index].extend([DVec3::ZERO, DVec3::Y * joint.length()]);
        }
    }
    for (skin, scene_skin) in model.skins.iter().zip(&scene.skins) {
        let shown = scene
            .nodes
            .iter()
            .find(|node| node.skin.is_some_and(|index| scene.skins[index].name == scene_skin.name));
        let mesh = shown.and_then(|node| node.mesh).map(|mesh| scene.meshes[mesh].geometry);
        let Some(geometry) = mesh else { continue };
        for (joint, corners) in carried_boxes(model, skin.skeleton, &scene.geometries[geometry]) {
            points[places.joints[skin.skeleton] + joint].extend(corners);
        }
    }
    let parents: Vec<Option<usize>> = scene.nodes.iter().map(|node| node.parent).collect();
    let rest: Vec<Transform> = scene.nodes.iter().map(place).collect();
    Rig { parents, rest, points }
}

/// The corners of the box of what a node shows; none where that is skinned.
fn shown_box(scene: &Scene, node: &Node) -> Vec<DVec3> {
    let Some(mesh) = node.mesh.filter(|_| node.skin.is_none()) else { return Vec::new() };
    let geometry = &scene.geometries[scene.meshes[mesh].geometry];
    let bounds = Bounds::of_points(geometry.mesh.points.iter().copied()).union(geometry.wire.bounds());
    corners(&bounds)
}

fn corners(bounds: &Bounds) -> Vec<DVec3> {
    let pick = |corner: u32, axis: usize| {
        if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] }
    };
    (0..8).map(|corner| DVec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2))).collect()
}

/// For each joint that carries points the box of these in its rest frame.
fn carried_boxes(
    model: &Model,
    skeleton: usize,
    geometry: &crate::scene::Geometry,
) -> Vec<(usize, Vec<DVec3>)> {
    let joints = &model.skeletons[skeleton].skeleton.joints;
    let into: Vec<DAffine3> = joints.iter().map(|joint| joint.bind().inverse()).collect();
    let mut boxes = vec![Bounds::EMPTY; joints.len()];
    for (point, influences) in geometry.mesh.points.iter().zip(geometry.influences.iter().flatten()) {
        for influence in influences.iter().filter(|influence| influence.weight > 0) {
            let joint = usize::from(influence.joint);
            boxes[joint] = boxes[joint].with_point(into[joint].transform_point3(*point));
        }
    }
    let carrying = boxes.iter().enumerate().filter(|(_, bounds)| bounds.min.x <= bounds.max.x);
    carrying.map(|(joint, bounds)| (joint, corners(bounds))).collect()
}

fn bake(
    model: &Model,
    places: &Places,
    rig: &Rig,
    (index, clip): (usize, &Clip),
) -> (Animation, Option<Loose>) {
    let node = |track: &ClipTrack| match track.target {
        Target::Node(node) => node,
        Target::Joint { skeleton, joint } => places.joints[skeleton] + joint,
    };
    let rig = watched(rig, clip.tracks.iter().map(node));
    let tolerance = clip.tolerance.or(model.motion_tolerance).unwrap_or_else(|| size(&rig) / FINE);
    let moving: Vec<Moving<'_>> =
        clip.tracks.iter().map(|track| moving(model, &rig, track, node(track))).collect();
    let watched: usize = rig.points.iter().map(Vec::len).sum();
    let wanted = Wanted {
        duration: clip.duration,
        tolerance,
        rate: clip.rate,
        stops: clip.tracks.iter().flat_map(|track| track.course.stops()).collect(),
        most: MOST_SAMPLES / (watched + 4 * moving.len() + 1),
    };
    let reduced = reduce(&rig, &moving, &wanted);
    let channel = |track: crate::motion::ReducedTrack| Channel {
        node: moving[track.track].node,
        path: moving[track.track].path,
        stepped: track.stepped,
        times: track.times,
        values: track.values,
    };
    let loose = (reduced.bound > tolerance).then_some(Loose { clip: index, bound: reduced.bound, tolerance });
    let animation = Animation {
        name: clip.name.clone(),
        channels: reduced.tracks.into_iter().map(channel).collect(),
        looped: clip.looped,
        events: clip.events.clone(),
        reach: reduced.reach,
        bound: reduced.bound,
        tolerance,
        samples: reduced.samples,
    };
    (animation, loose)
}

/// The rig with points where something moves that carries none: a tenth of the model's size from it.
fn watched(rig: &Rig, moved: impl Iterator<Item = usize>) -> Rig {
    let mut rig = rig.clone();
    let mut carries: Vec<bool> = rig.points.iter().map(|points| !points.is_empty()).collect();
    for node in 0..carries.len() {
        let mut above = if carries[node] { rig.parents[node] } else { None };
        for _ in 0..rig.parents.len() {
            let Some(parent) = above else { break };
            carries[parent] = true;
            above = rig.parents[parent];
        }
    }
    let reach = size(&rig) / 10.0;
    for node in moved {
        if !carries[node] {
            rig.points[node] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * reach).to_vec();
        }
    }
    rig
}

/// The diagonal of the box of all points at rest; 1 where there is none.
fn size(rig: &Rig) -> f64 {
    let world = |node: usize| {
        let mut map = rig.rest[node].map();
        let mut above = rig.parents[node];
        for _ in 0..rig.parents.len() {
            let Some(parent) = above else { break };
            map = rig.rest[parent].map() * map;
            above = rig.parents[parent];
        }
        map
    };
    let of = |node: usize| {
        let map = world(node);
        rig.points[node].iter().map(move |point| map.transform_point3(*point)).collect::<Vec<_>>()
    };
    let bounds = Bounds::of_points((0..rig.points.len()).flat_map(of));
    let diagonal = (bounds.max - bounds.min).length();
    if diagonal.is_finite() && diagonal > 0.0 { diagonal } else { 1.0 }
}

/// A track with its rest put in.
fn moving<'a>(model: &'a Model, rig: &Rig, track: &'a ClipTrack, node: usize) -> Moving<'a> {
    let playing = Track::new(&track.course);
    let (path, rest) = (track.course.path(), rig.rest[node]);
    let exact = move |time: f64| {
        let value = track.composed(&rest, playing.at(time), &model.frame);
        if value.is_finite() { value } else { at_rest(&rest, path) }
    };
    let steps = track.course.stepped().then(|| track.course.stops());
    Moving { node, path, exact: Box::new(exact), steps }
}

fn at_rest(rest: &Transform, path: Path) -> DVec4 {
    match path {
        Path::Translation => rest.translation.extend(0.0),
        Path::Rotation => DVec4::from(rest.rotation),
        Path::Scale => rest.scale.extend(0.0),
    }
}

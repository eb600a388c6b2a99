//! Skeletons into nodes, skins into weights, clips into keys.

use glam::{DAffine3, DVec3, DVec4};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::{Loose, RealizeError, property};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::Bounds;
use crate::model::{
    Clip, ClipTrack, MaterialHandle, Model, NamedSkeleton, Owner, ShapeHandle, Target, WeightRule,
};
use crate::motion::{
    HeatFault, Influences, Joint, MorphedBox, MorphedState, Moving, Path, ReducedTrack, Rig, Track,
    Transform, Wanted, Weights, envelope_weights, heat_weights, reduce, rigid_weights, weights_of,
};
use crate::scene::{Animation, Channel, Geometry, MorphTarget, Node, PropertyChannel, Scene, Skin};

/// The most samples of a motion, times what is watched.
const MOST_SAMPLES: usize = 8_000_000;

/// A default tolerance is the diagonal of the bounding box over this.
const FINE: f64 = 1e4;

/// Shapes that cannot be carried, with the reasons.
type Refused = Vec<(ShapeHandle, RealizeError)>;

/// For each change of a material that is on nothing shown its clip and the name of the material.
type Unseen = Vec<(usize, String)>;

/// Where the nodes of skeletons stand among the nodes of the scene.
struct Places {
    /// For each skeleton its first joint.
    joints: Vec<usize>,
    /// For each skeleton its first socket.
    sockets: Vec<usize>,
}

/// Adds to a scene what moves it. `shapes` are those of its geometries.
pub(super) fn add(
    (model, used): (&Model, &[MaterialHandle]),
    shapes: &[ShapeHandle],
    scene: &mut Scene,
) -> Result<(Vec<Loose>, Unseen), Refused> {
    let places = skeleton_nodes(model, scene);
    for (index, node) in model.nodes.iter().enumerate() {
        if let Some(socket) = node.socket {
            scene.nodes[index].parent = Some(places.sockets[socket.skeleton] + socket.socket);
        }
    }
    skins(model, shapes, &places, scene)?;
    let rig = rig(model, &places, scene);
    let own = &*scene;
    let bake = |(index, clip): (usize, &Clip)| {
        let (mut animation, loose) = bake(model, &places, &rig, (index, clip));
        let (changes, unseen) = changes((model, used), own, clip);
        let loose_changes = changes.iter().filter(|channel| channel.bound > channel.tolerance);
        let told = |channel: &PropertyChannel| Loose {
            clip: index,
            property: Some(channel.property),
            bound: channel.bound,
            tolerance: channel.tolerance,
        };
        let loose: Vec<Loose> = loose.into_iter().chain(loose_changes.map(told)).collect();
        animation.properties = changes;
        let unseen: Unseen = unseen.into_iter().map(|name| (index, name)).collect();
        (animation, loose, unseen)
    };
    let baked: Vec<(Animation, Vec<Loose>, Unseen)> = model.clips.par_iter().enumerate().map(bake).collect();
    let (mut all_loose, mut all_unseen) = (Vec::new(), Vec::new());
    for (animation, loose, unseen) in baked {
        all_loose.extend(loose);
        all_unseen.extend(unseen);
        // What changes only what is not shown is no animation.
        if !(animation.channels.is_empty() && animation.properties.is_empty()) {
            scene.animations.push(animation);
        }
    }
    Ok((all_loose, all_unseen))
}

/// What a clip changes of materials, lights and cameras, and the materials among them that nothing shows.
fn changes(
    (model, used): (&Model, &[MaterialHandle]),
    scene: &Scene,
    clip: &Clip,
) -> (Vec<PropertyChannel>, Vec<String>) {
    let (mut changes, mut unseen) = (Vec::new(), Vec::new());
    for track in &clip.properties {
        let wanted = Wanted {
            duration: clip.duration,
            tolerance: 0.0,
            rate: clip.rate,
            stops: track.course.stops(),
            most: MOST_SAMPLES / 16,
        };
        let own = property::channels((model, used), scene, track, &wanted);
        if let (true, Owner::Material(handles)) = (own.is_empty(), &track.owner) {
            unseen.extend(handles.first().map(|handle| model.material(*handle).name.clone()));
        }
        changes.extend(own);
    }
    if clip.tracks.is_empty() {
        property::last_to_the_end(&mut changes, clip.duration);
    }
    (changes, unseen)
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
        copy: false,
        instances: Vec::new(),
        camera: None,
        light: None,
        parent,
        translation: place.translation,
        rotation: place.rotation,
        scale: place.scale,
    }
}

fn skins(model: &Model, shapes: &[ShapeHandle], places: &Places, scene: &mut Scene) -> Result<(), Refused> {
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
        WeightRule::Heat => heat(model, (index, &skin.joints), mesh, &joints)?,
        WeightRule::Given(given) => {
            let mut own = given.iter();
            weights_of(&mesh.points, joints.len(), |_, weights| {
                own.next().into_iter().flatten().for_each(|(joint, share)| weights[*joint] = *share);
            })
        }
        WeightRule::Perturbation(bumps) => {
            let back = model.frame.map().inverse();
            weights_of(&mesh.points, joints.len(), |point, weights| {
                for (joint, bump) in bumps {
                    weights[*joint] += bump.perturbation(back.transform_point3(point)).abs();
                }
            })
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

fn heat(
    model: &Model,
    (skin, joints): (usize, &[usize]),
    mesh: &Mesh,
    bones: &[&Joint],
) -> Result<Weights, RealizeError> {
    let limit = model.limits.memory;
    heat_weights(mesh, bones, limit).map_err(|fault| match fault {
        HeatFault::Unseen { parts, count, first } => {
            let point = mesh.points[first];
            let nearest = (0..bones.len())
                .min_by(|a, b| bones[*a].distance(point).total_cmp(&bones[*b].distance(point)))
                .map_or(0, |bone| joints[bone]);
            let place = model.frame.map().inverse().transform_point3(point);
            RealizeError::Unseen { skin, parts, count, of: mesh.points.len(), place, nearest }
        }
        HeatFault::Limit { needed } => RealizeError::Limit { what: "bytes of memory", needed, limit },
    })
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
    let weights = scene.nodes.iter().map(|node| rest_weights(scene, node)).collect();
    let mut morphed = Vec::new();
    for (index, node) in scene.nodes.iter().enumerate() {
        let Some(geometry) = shown(scene, node).filter(|own| node.skin.is_none() && !own.targets.is_empty())
        else {
            continue;
        };
        let all: Vec<usize> = (0..geometry.mesh.points.len()).collect();
        morphed.push(morphed_box(geometry, (index, index), &all, &DAffine3::IDENTITY));
    }
    for (named, first) in model.skeletons.iter().zip(&places.joints) {
        for (index, joint) in named.skeleton.joints.iter().enumerate() {
            points[first + index].extend([DVec3::ZERO, DVec3::Y * joint.length()]);
        }
    }
    for (skin, scene_skin) in model.skins.iter().zip(&scene.skins) {
        let carries = |node: &Node| node.skin.is_some_and(|index| scene.skins[index].name == scene_skin.name);
        let Some(index) = scene.nodes.iter().position(carries) else { continue };
        let Some(geometry) = shown(scene, &scene.nodes[index]) else { continue };
        let joints = &model.skeletons[skin.skeleton].skeleton.joints;
        for (joint, carried) in carried_points(joints.len(), geometry).iter().enumerate() {
            if carried.is_empty() {
                continue;
            }
            let (node, into) = (places.joints[skin.skeleton] + joint, joints[joint].bind().inverse());
            if geometry.targets.is_empty() {
                let own = carried.iter().map(|point| into.transform_point3(geometry.mesh.points[*point]));
                points[node].extend(Bounds::of_points(own).corners());
            } else {
                morphed.push(morphed_box(geometry, (node, index), carried, &into));
            }
        }
    }
    let parents: Vec<Option<usize>> = scene.nodes.iter().map(|node| node.parent).collect();
    let rest: Vec<Transform> = scene.nodes.iter().map(place).collect();
    Rig { parents, rest, points, weights, morphed }
}

/// What a node shows.
fn shown<'s>(scene: &'s Scene, node: &Node) -> Option<&'s Geometry> {
    node.mesh.map(|mesh| &scene.geometries[scene.meshes[mesh].geometry])
}

/// The corners of the box of what a node shows; none where that is skinned or morphs.
fn shown_box(scene: &Scene, node: &Node) -> Vec<DVec3> {
    let still = |own: &&Geometry| node.skin.is_none() && own.targets.is_empty();
    shown(scene, node).filter(still).map_or_else(Vec::new, |own| own.bounds().corners().to_vec())
}

/// The weights of what a node shows.
fn rest_weights(scene: &Scene, node: &Node) -> Vec<f64> {
    let targets = shown(scene, node).map_or(&[][..], |geometry| &geometry.targets);
    targets.iter().map(|target| target.weight).collect()
}

/// The box of some points that morph, in a node's space.
fn morphed_box(
    geometry: &Geometry,
    (node, weights): (usize, usize),
    some: &[usize],
    into: &DAffine3,
) -> MorphedBox {
    let bounds =
        |points: &[DVec3]| Bounds::of_points(some.iter().map(|point| into.transform_point3(points[*point])));
    let base = &geometry.mesh.points;
    let state = |target: &MorphTarget| {
        let ways = some.iter().map(|at| into.transform_vector3(target.points[*at] - base[*at]));
        MorphedState {
            bounds: bounds(&target.points),
            ways: Bounds::of_points(ways.clone()),
            furthest: ways.map(DVec3::length).fold(0.0, f64::max),
        }
    };
    let states = geometry.targets.iter().map(state).collect();
    MorphedBox { node, weights, base: bounds(base), states }
}

/// For each joint the points that it carries.
fn carried_points(joints: usize, geometry: &Geometry) -> Vec<Vec<usize>> {
    let mut carried = vec![Vec::new(); joints];
    for (point, influences) in geometry.influences.iter().flatten().enumerate() {
        for influence in influences.iter().filter(|influence| influence.weight > 0) {
            carried[usize::from(influence.joint)].push(point);
        }
    }
    carried
}

fn bake(
    model: &Model,
    places: &Places,
    rig: &Rig,
    (index, clip): (usize, &Clip),
) -> (Animation, Option<Loose>) {
    let node = |track: &ClipTrack| match track.target {
        Target::Node(node) | Target::Weight { node, .. } => node,
        Target::Joint { skeleton, joint } => places.joints[skeleton] + joint,
    };
    let rig = watched(rig, clip.tracks.iter().map(node));
    let tolerance = clip.tolerance.or(model.motion_tolerance).unwrap_or_else(|| size(&rig) / FINE);
    let moving: Vec<Moving<'_>> =
        clip.tracks.iter().map(|track| moving(model, &rig, track, node(track))).collect();
    let watched = rig.points.iter().map(Vec::len).sum::<usize>() + 8 * rig.morphed.len();
    let wanted = Wanted {
        duration: clip.duration,
        tolerance,
        rate: clip.rate,
        stops: clip.tracks.iter().flat_map(|track| track.course.stops()).collect(),
        most: MOST_SAMPLES / (watched + 4 * moving.len() + 1),
    };
    let reduced = reduce(&rig, &moving, &wanted);
    let channels = channels(&rig, &moving, reduced.tracks);
    let loose = (reduced.bound > tolerance).then_some(Loose {
        clip: index,
        property: None,
        bound: reduced.bound,
        tolerance,
    });
    let animation = Animation {
        name: clip.name.clone(),
        channels,
        properties: Vec::new(),
        looped: clip.looped,
        events: clip.events.clone(),
        reach: reduced.reach,
        bound: reduced.bound,
        tolerance,
        samples: reduced.samples,
    };
    (animation, loose)
}

/// Reduced tracks as a file has them: the weights of a node are one channel, at the times of all of their keys.
fn channels(rig: &Rig, moving: &[Moving<'_>], tracks: Vec<ReducedTrack>) -> Vec<Channel> {
    let mut channels: Vec<Channel> = Vec::new();
    let (weights, places): (Vec<_>, Vec<_>) =
        tracks.into_iter().partition(|track| moving[track.track].path == Path::Weight);
    for track in places {
        let Moving { node, path, .. } = moving[track.track];
        let width = if path == Path::Rotation { 4 } else { 3 };
        let values = track.values.iter().flat_map(|value| value.to_array().into_iter().take(width)).collect();
        channels.push(Channel { node, path, stepped: track.stepped, times: track.times, values });
    }
    let node = |track: &ReducedTrack| moving[track.track].node;
    let mut nodes: Vec<usize> = weights.iter().map(node).collect();
    nodes.dedup();
    nodes.sort_unstable();
    nodes.dedup();
    for node in nodes {
        let own: Vec<&ReducedTrack> =
            weights.iter().filter(|track| moving[track.track].node == node).collect();
        let mut times: Vec<f64> = own.iter().flat_map(|track| track.times.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut values = rig.weights[node].repeat(times.len());
        let count = rig.weights[node].len();
        for track in &own {
            for (time, row) in times.iter().zip(values.chunks_mut(count)) {
                row[moving[track.track].target] = track.at(Path::Weight, *time).x;
            }
        }
        let stepped = own.iter().any(|track| track.stepped && track.times.len() > 1);
        channels.push(Channel { node, path: Path::Weight, stepped, times, values });
    }
    channels
}

/// The rig with points where something moves that carries none: a tenth of the model's size from it.
fn watched(rig: &Rig, moved: impl Iterator<Item = usize>) -> Rig {
    let mut rig = rig.clone();
    let mut carries: Vec<bool> = rig.points.iter().map(|points| !points.is_empty()).collect();
    rig.morphed.iter().for_each(|morphed| carries[morphed.node] = true);
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
    let of_morphed = |morphed: &MorphedBox| {
        let map = world(morphed.node);
        morphed.at(&rig.weights[morphed.weights]).corners().map(|corner| map.transform_point3(corner))
    };
    let morphed = rig.morphed.iter().flat_map(of_morphed);
    let bounds = Bounds::of_points((0..rig.points.len()).flat_map(of).chain(morphed));
    let diagonal = (bounds.max - bounds.min).length();
    if diagonal.is_finite() && diagonal > 0.0 { diagonal } else { 1.0 }
}

/// A track with its rest put in.
fn moving<'a>(model: &'a Model, rig: &Rig, track: &'a ClipTrack, node: usize) -> Moving<'a> {
    let playing = Track::new(&track.course);
    let (path, rest) = (track.course.path(), rig.rest[node]);
    let target = if let Target::Weight { target, .. } = track.target { target } else { 0 };
    let at_rest_weight = rig.weights[node].get(target).copied().unwrap_or(0.0);
    let exact = move |time: f64| {
        let value = track.composed(&rest, playing.at(time), &model.frame);
        match path {
            _ if value.is_finite() => value,
            Path::Weight => DVec4::X * at_rest_weight,
            _ => at_rest(&rest, path),
        }
    };
    let steps = track.course.stepped().then(|| track.course.stops());
    let corners = track.course.corners();
    Moving { node, path, target, exact: Box::new(exact), steps, corners }
}

fn at_rest(rest: &Transform, path: Path) -> DVec4 {
    match path {
        Path::Translation => rest.translation.extend(0.0),
        Path::Rotation => DVec4::from(rest.rotation),
        Path::Scale => rest.scale.extend(0.0),
        Path::Weight => DVec4::ZERO,
    }
}

//! Whole scenes of files: objects, cameras and lights as nodes, and their motion as a clip.
//!
//! A node of the document carries everything. Motions are sampled at the frames of the file, which is where the program
//! that made it shows them.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use super::Builder;
use super::import::{axes_between, default_up};
use crate::geometry::mesh::{self, PolygonMesh};
use crate::geometry::number::{atan, sin_cos_degrees, single, tan_degrees};
use crate::import::studio::keyframe::{Node as Moved, NodeKind};
use crate::import::studio::scene::{Camera, Light, Object, Scene};
use crate::import::{self, ImportError, Imported, Note, studio};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Sp, kebab};
use crate::model::{
    self, Clip, ClipTrack, Lens, LightKind, Node, Recipe, Shape, ShapeHandle, ShapeOptions, Space, Target,
};
use crate::motion::{Course, Interpolation, Keys, Law};

/// The most frames of a scene, times what moves.
const MOST_PLACES: usize = 1_000_000;
/// Width of a picture over its height.
const ASPECT: f64 = 4.0 / 3.0;
/// Where cameras see nothing yet, where the file does not say, as a share of the distance to what they look at.
const NEAR: f64 = 0.01;

/// What a scene is turned and scaled by, and where it comes from.
struct Place<'a> {
    import: &'a spec::SceneImport,
    axes: DMat3,
    scale: f64,
    name: &'a str,
    span: Span,
}

/// Where something is at a frame, in the document's unit and axes.
#[derive(Clone, Copy, PartialEq)]
struct Pose {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

/// A node that may move, with its poses at all frames.
struct Playing {
    node: usize,
    poses: Vec<Pose>,
}

impl Place<'_> {
    fn point(&self, point: DVec3) -> DVec3 {
        self.axes * point * self.scale
    }

    fn turned(&self, rotation: DQuat) -> DQuat {
        let turn = DQuat::from_mat3(&self.axes);
        (turn * rotation * turn.conjugate()).normalize()
    }

    /// Factors along the axes of the file, along those of the document.
    fn factors(&self, scale: DVec3) -> DVec3 {
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis].map(DVec3::abs);
        DMat3::from_cols(x, y, z) * scale
    }
}

impl Builder<'_> {
    /// Reads the scenes that nodes import.
    pub(super) fn scenes(&mut self) {
        let spec = self.spec;
        for (index, (name, definition)) in spec.nodes.iter().enumerate() {
            if let Some(import) = &definition.value.import {
                self.scene(index, name, import);
            }
        }
    }

    fn scene(&mut self, carrier: usize, name: &str, import: &Sp<spec::SceneImport>) -> Option<()> {
        let file = &import.file;
        let bytes = self.bytes_of(file)?;
        if file.value.extension() != "3ds" {
            let message = format!("{} is no 3D Studio scene (.3ds)", file.value.written);
            let report = Diagnostic::error(Code::UnsupportedFormat, message).at(file.span, "not a scene");
            self.report(report.help("import the mesh of a file with `[shape.NAME.import]`"));
            return None;
        }
        let read = studio::read_scene(&bytes).map_err(|error| match import::recognize(&bytes) {
            Some(foreign) if error.is_foreign() => ImportError::Foreign(foreign),
            _ => error,
        });
        let scene = read.map_err(|error| self.refused(file, &error)).ok()?;
        let up = import.up.map_or_else(|| default_up(file), |up| up.value);
        let axes = axes_between(up, self.spec.up);
        let place = Place { import, axes, scale: import.scale.value, name, span: import.span };
        let frames = frames(&scene);
        let all = frames.len().saturating_mul(scene.nodes.len() + scene.cameras.len() + scene.lights.len());
        if all > MOST_PLACES {
            let message = format!(
                "the motion of this scene has {all} places of {} frames, and the limit is {MOST_PLACES}",
                frames.len()
            );
            self.report(Diagnostic::error(Code::LimitPassed, message).at(file.span, "too long"));
            return None;
        }
        let mut notes = Vec::new();
        let shapes = self.scene_shapes(&scene, &place, &mut notes);
        let mut playing = self.scene_nodes(&scene, &shapes, (carrier, &place), &frames);
        self.scene_views(&scene, (carrier, &place), &frames, &mut playing);
        self.tell_notes(file, &notes);
        self.scene_clip(&scene, &place, &frames, playing);
        Some(())
    }

    /// A shape of each object with faces, in its own axes where a node moves it, else where it stands.
    fn scene_shapes(
        &mut self,
        scene: &Scene,
        place: &Place<'_>,
        notes: &mut Vec<Note>,
    ) -> Vec<Option<ShapeHandle>> {
        let mut shapes = Vec::new();
        for object in &scene.objects {
            let mut mesh = PolygonMesh::default();
            studio::append(&mut mesh, object);
            if mesh.faces.is_empty() {
                shapes.push(None);
                continue;
            }
            let moved =
                scene.nodes.iter().find(|node| node.kind == NodeKind::Object && node.name == object.name);
            if let Some(node) = moved {
                mesh.transform(&local(object, node));
            }
            let map = DAffine3::from_mat3(place.axes * place.scale);
            mesh.transform(&map);
            if let Err(error) = mesh.validate() {
                let message = format!("object `{}`: {error}", object.name);
                self.report(Diagnostic::error(Code::BadMesh, message).at(place.span, "this scene"));
                shapes.push(None);
                continue;
            }
            let looks = scene.looks(&mesh.materials);
            let imported = Imported { mesh, materials: looks, ..Imported::default() };
            let materials =
                self.looks_of((&place.import.file.value, &place.import.materials), &imported, notes);
            let recipe = Recipe::Polygons { mesh: imported.mesh, materials };
            let handle = ShapeHandle(mesh::index(self.model.shapes.len()));
            let own = kebab(&object.name).unwrap_or_else(|| format!("object-{}", shapes.len() + 1));
            let name = format!("{}.{own}", place.name);
            self.model.shapes.push(Shape { name, recipe, options: ShapeOptions::PLAIN });
            self.places.push(place.span);
            self.faces.push(Vec::new());
            shapes.push(Some(handle));
        }
        let used = |name: &String| {
            scene
                .objects
                .iter()
                .any(|object| object.faces.iter().any(|face| face.material.as_ref() == Some(name)))
        };
        if let Some((name, target)) = place.import.materials.iter().find(|(name, _)| !used(name)) {
            let message = format!("{} has no material `{name}`", place.import.file.value.written);
            self.report(Diagnostic::error(Code::UnknownPart, message).at(target.span, "never used"));
        }
        shapes
    }

    /// The nodes of objects: those that the file moves, and those that only stand there.
    fn scene_nodes(
        &mut self,
        scene: &Scene,
        shapes: &[Option<ShapeHandle>],
        (carrier, place): (usize, &Place<'_>),
        frames: &[f64],
    ) -> Vec<Playing> {
        let mut playing = Vec::new();
        let mut of: Vec<Option<usize>> = Vec::with_capacity(scene.nodes.len());
        for node in &scene.nodes {
            if node.kind != NodeKind::Object {
                of.push(None);
                continue;
            }
            let object = scene.objects.iter().position(|object| object.name == node.name);
            let shape = object.and_then(|object| shapes[object]);
            let name = if node.instance.is_empty() { &node.name } else { &node.instance };
            let parent = node.parent.and_then(|parent| of[parent]).unwrap_or(carrier);
            let poses: Vec<Pose> = frames.iter().map(|frame| pose(node, *frame, place)).collect();
            // What is hidden carries others all the same: only what it shows is made nothing of.
            let hides = !node.hidden.is_empty() && shape.is_some();
            let made = self.scene_node(name, parent, shape.filter(|_| !hides), &poses[0]);
            of.push(Some(made));
            playing.push(Playing { node: made, poses });
            if hides {
                let seen = |frame: &f64| {
                    let turns = node.hidden.iter().filter(|hidden| f64::from(**hidden) <= *frame).count();
                    let scale = if turns % 2 == 0 { DVec3::ONE } else { DVec3::ZERO };
                    Pose { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale }
                };
                let poses = frames.iter().map(seen).collect();
                let rest = Pose { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
                let shown = self.scene_node(&format!("{name} shown"), made, shape, &rest);
                playing.push(Playing { node: shown, poses });
            }
        }
        for (object, shape) in scene.objects.iter().zip(shapes) {
            let moved =
                scene.nodes.iter().any(|node| node.kind == NodeKind::Object && node.name == object.name);
            if !moved && shape.is_some() {
                let still = Pose { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
                self.scene_node(&object.name, carrier, *shape, &still);
            }
        }
        playing
    }

    fn scene_node(&mut self, name: &str, parent: usize, shape: Option<ShapeHandle>, pose: &Pose) -> usize {
        let name = kebab(name).unwrap_or_else(|| format!("node-{}", self.model.nodes.len() + 1));
        let taken = |name: &String| self.model.nodes.iter().any(|node| node.name == *name);
        let numbered = |k: usize| if k == 1 { name.clone() } else { format!("{name}-{k}") };
        let name = (1..).map(numbered).find(|name| !taken(name)).unwrap_or_default();
        let Pose { translation, rotation, scale } = *pose;
        // Factors of motion are multiplied with those at rest.
        let scale = DVec3::select(scale.cmpeq(DVec3::ZERO), DVec3::ONE, scale);
        let (material, socket, is_socket, camera, light) = (None, None, false, None, None);
        let parent = Some(parent);
        self.model.nodes.push(Node {
            name,
            shape,
            material,
            parent,
            socket,
            is_socket,
            is_copy: false,
            camera,
            light,
            translation,
            rotation,
            scale,
        });
        self.model.nodes.len() - 1
    }

    /// The nodes of cameras and lights. They look at what may move by itself, so that they are carried by the whole scene.
    fn scene_views(
        &mut self,
        scene: &Scene,
        (carrier, place): (usize, &Place<'_>),
        frames: &[f64],
        playing: &mut Vec<Playing>,
    ) {
        let worlds = worlds(scene, frames);
        let track = |kind: NodeKind, name: &str| {
            scene.nodes.iter().position(|node| node.kind == kind && node.name == name)
        };
        let at = |node: Option<usize>, frame: usize, still: DVec3| {
            node.map_or(still, |node| worlds[node][frame].translation)
        };
        for camera in &scene.cameras {
            let (own, aim) =
                (track(NodeKind::Camera, &camera.name), track(NodeKind::CameraTarget, &camera.name));
            let view = |frame: usize| {
                let (from, to) = (at(own, frame, camera.place), at(aim, frame, camera.target));
                let roll = own.and_then(|own| scene.nodes[own].roll.numbers(frames[frame]));
                looking(place, from, to, roll.map_or(camera.roll, |roll| roll.x))
            };
            let poses: Vec<Pose> = (0..frames.len()).map(view).collect();
            let node = self.scene_node(&camera.name, carrier, None, &poses[0]);
            let seen = own.and_then(|own| scene.nodes[own].view.numbers(frames[0]));
            self.model.nodes[node].camera = Some(self.camera(camera, seen.map(|seen| seen.x), place.scale));
            playing.push(Playing { node, poses });
        }
        for light in scene.lights.iter().filter(|light| light.on) {
            let (own, aim) = (track(NodeKind::Light, &light.name), track(NodeKind::LightTarget, &light.name));
            let view = |frame: usize| {
                let from = at(own, frame, light.place);
                match light.spot {
                    Some((target, ..)) => looking(place, from, at(aim, frame, target), 0.0),
                    None => {
                        Pose { translation: place.point(from), rotation: DQuat::IDENTITY, scale: DVec3::ONE }
                    }
                }
            };
            let poses: Vec<Pose> = (0..frames.len()).map(view).collect();
            let node = self.scene_node(&light.name, carrier, None, &poses[0]);
            self.model.nodes[node].light = Some(self.light(light, place.scale));
            playing.push(Playing { node, poses });
        }
    }

    /// A camera; lengths become metres.
    fn camera(&self, camera: &Camera, seen: Option<f64>, scale: f64) -> model::Camera {
        let unit = scale * self.model.frame.unit;
        // A picture of 36 mm: the angle across, and from it the one upright.
        let across = seen
            .filter(|seen| (1.0..=170.0).contains(seen))
            .unwrap_or_else(|| 2.0 * atan(18.0 / camera.lens.max(1.0)).to_degrees());
        let upright = 2.0 * atan(tan_degrees(across / 2.0) / ASPECT).to_degrees();
        let away = camera.place.distance(camera.target).max(1e-6);
        let near = camera.range.map_or(away * NEAR, |(near, _)| near);
        let far = camera.range.map(|(_, far)| far * unit);
        model::Camera { lens: Lens::Perspective { upright }, aspect: ASPECT, near: near * unit, far }
    }

    /// A light; lengths become metres. What 3D Studio shows at full strength is 100 candela here, at any distance.
    fn light(&self, light: &Light, scale: f64) -> model::Light {
        const CANDELA: f64 = 100.0;
        let unit = scale * self.model.frame.unit;
        let kind = match light.spot {
            Some((_, bright, whole)) => {
                let outer = (whole / 2.0).clamp(0.5, 89.0);
                LightKind::Spot { inner: (bright / 2.0).clamp(0.0, outer - 0.1), outer }
            }
            None => LightKind::Point,
        };
        model::Light {
            kind,
            color: light.color,
            intensity: light.strength.max(0.0) * CANDELA,
            range: light.range.map(|range| range * unit),
        }
    }

    /// One clip of all that moves.
    fn scene_clip(&mut self, scene: &Scene, place: &Place<'_>, frames: &[f64], playing: Vec<Playing>) {
        if !scene.nodes.iter().any(Moved::moves) || frames.len() < 2 {
            return;
        }
        let rate = place.import.frame_rate.value;
        let time = |frame: &f64| f64::from(single((frame - frames[0]) / rate));
        let times: Vec<f64> = frames.iter().map(time).collect();
        let looped = place.import.r#loop.value;
        let mut tracks = Vec::new();
        for Playing { node, poses } in playing {
            let rest = self.model.nodes[node].clone();
            let courses = courses(&rest, &poses, &times);
            let (target, space, clamp) = (Target::Node(node), Space::Document, None);
            tracks.extend(courses.into_iter().map(|course| ClipTrack { target, course, space, clamp }));
        }
        let name =
            place.import.clip.as_ref().map_or_else(|| place.name.to_owned(), |clip| clip.value.clone());
        if tracks.is_empty() {
            return;
        }
        if self.spec.clips.contains_key(&name) || self.model.clips.iter().any(|clip| clip.name == name) {
            let report = Diagnostic::error(Code::DuplicateName, format!("clip `{name}` is defined twice"))
                .at(place.import.file.span, "the motion of this scene")
                .help("write `clip = \"NAME\"` beside `file`");
            self.report(report);
            return;
        }
        self.model.clips.push(Clip::of_file(name, times[times.len() - 1], looped, tracks));
        self.clip_places.push(place.span);
    }
}

/// The frames of a scene; one where nothing moves.
fn frames(scene: &Scene) -> Vec<f64> {
    let (first, last) = scene.frames.unwrap_or((0, 0));
    // A count that is too great is told as what it is at least.
    let last = last.min(first.saturating_add(1_000_000));
    if scene.nodes.iter().any(Moved::moves) {
        (first..=last).map(f64::from).collect()
    } else {
        vec![f64::from(first)]
    }
}

/// From the scene to an object's own axes, about its pivot.
fn local(object: &Object, node: &Moved) -> DAffine3 {
    let flat = object.axes.matrix3.determinant().abs() < 1e-12;
    let axes = if flat { DAffine3::from_translation(object.axes.translation) } else { object.axes };
    DAffine3::from_translation(-node.pivot) * axes.inverse()
}

/// Where a node is in its parent, in the file's unit and axes.
fn placed(node: &Moved, frame: f64) -> Pose {
    let numbers = |track: &studio::keyframe::Track, still: DVec3| {
        track.numbers(frame).map_or(still, |numbers| numbers.truncate())
    };
    Pose {
        translation: numbers(&node.position, DVec3::ZERO),
        rotation: node.rotation.rotation(frame).unwrap_or(DQuat::IDENTITY),
        scale: numbers(&node.scale, DVec3::ONE),
    }
}

/// The same in the document's.
fn pose(node: &Moved, frame: f64, place: &Place<'_>) -> Pose {
    let Pose { translation, rotation, scale } = placed(node, frame);
    Pose {
        translation: place.point(translation),
        rotation: place.turned(rotation),
        scale: place.factors(scale),
    }
}

/// For each node and frame its map to the scene, in the file's unit and axes.
fn worlds(scene: &Scene, frames: &[f64]) -> Vec<Vec<DAffine3>> {
    let mut worlds: Vec<Vec<DAffine3>> = Vec::with_capacity(scene.nodes.len());
    for node in &scene.nodes {
        let own = |(k, frame): (usize, &f64)| {
            let Pose { translation, rotation, scale } = placed(node, *frame);
            let own = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            node.parent.map_or(own, |parent| worlds[parent][k] * own)
        };
        let all = frames.iter().enumerate().map(own).collect();
        worlds.push(all);
    }
    worlds
}

/// Looks along -z from one point to another, z of the file up, then turned about that line counter-clockwise.
fn looking(place: &Place<'_>, from: DVec3, to: DVec3, roll: f64) -> Pose {
    let along = (to - from).normalize_or(DVec3::Y);
    // Straight up or down the top of the picture looks along y.
    let side = along.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
    let axes = DMat3::from_cols(side, side.cross(along), -along);
    let (sin, cos) = sin_cos_degrees(roll / 2.0);
    let turn = DQuat::from_xyzw(0.0, 0.0, sin, cos);
    let rotation = DQuat::from_mat3(&axes).normalize() * turn;
    let turned = DQuat::from_mat3(&place.axes) * rotation;
    Pose { translation: place.point(from), rotation: turned.normalize(), scale: DVec3::ONE }
}

/// How poses differ from the first.
fn courses(rest: &Node, poses: &[Pose], times: &[f64]) -> Vec<Course> {
    let keys = |values: Vec<DVec4>, interpolation: Interpolation| {
        Keys::new((times.to_vec(), values), &[], interpolation, false)
    };
    let mut courses = Vec::new();
    if poses.iter().any(|pose| pose.translation != rest.translation) {
        let values = poses.iter().map(|pose| (pose.translation - rest.translation).extend(0.0)).collect();
        courses.push(Course::Offset(Law::Keys(keys(values, Interpolation::Linear))));
    }
    if poses.iter().any(|pose| pose.rotation != rest.rotation) {
        let turned = |pose: &Pose| (rest.rotation.conjugate() * pose.rotation).normalize();
        let rotations: Vec<DQuat> = poses.iter().map(turned).collect();
        courses.push(Course::rotations(times.to_vec(), &rotations, Interpolation::Linear, false));
    }
    if poses.iter().any(|pose| pose.scale != rest.scale) {
        // What is hidden is gone at once.
        let gone = poses.iter().any(|pose| pose.scale == DVec3::ZERO);
        let way = if gone { Interpolation::Step } else { Interpolation::Linear };
        let values = poses.iter().map(|pose| (pose.scale / rest.scale).extend(0.0)).collect();
        courses.push(Course::Size(Law::Keys(keys(values, way))));
    }
    courses
}

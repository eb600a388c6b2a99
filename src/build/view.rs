//! Cameras and lights of nodes, and nodes that look at something, at rest and in clips.
//!
//! What a node looks at is found in the axes of what carries it, so it is looked at exactly however that is turned,
//! scaled or sheared.

use glam::{DMat3, DQuat, DVec3};

use super::Builder;
use super::profile::show;
use super::reach::Frames;
use super::stage::Stage;
use crate::geometry::number::{floor_count, single};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Aim};
use crate::model::{Camera, ClipTrack, Lens, Light, LightKind, Space, Target};
use crate::motion::{Course, Interpolation, Path};

/// What a camera without perspective and `far` sees, as a multiple of `near`.
const FAR: f64 = 1000.0;
/// Shares of the size of places below which two are one.
const SAME: f64 = 1e-9;
/// Sines of angles to the upward axis below which a node looks straight up or down.
const UPRIGHT: f64 = 1e-9;
/// Quaternions that differ by no more than this are one.
const STILL: f64 = 1e-12;

/// A node that looks at something.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aimed {
    node: usize,
    goal: Goal,
    span: Span,
}

#[derive(Clone, Copy, Debug)]
enum Goal {
    /// A place, metres, y up.
    Place(DVec3),
    /// A node.
    Node(usize),
}

impl Builder<'_> {
    /// The camera of a node; lengths become metres.
    pub(super) fn camera_of(&self, written: &spec::Camera) -> Camera {
        let unit = self.model.frame.unit;
        let near = written.near.value * unit;
        let far = written.far.as_ref().map(|far| far.value * unit);
        let (lens, far) = match &written.height {
            Some(height) => (Lens::Parallel { height: height.value * unit }, far.or(Some(near * FAR))),
            None => (Lens::Perspective { upright: written.upright() }, far),
        };
        Camera { lens, aspect: written.aspect.value, near, far }
    }

    /// The light of a node; lengths become metres.
    pub(super) fn light_of(&self, written: &spec::Light) -> Light {
        let kind = match written.kind.value {
            spec::LightKind::Point => LightKind::Point,
            spec::LightKind::Sun => LightKind::Sun,
            spec::LightKind::Spot => {
                let (inner, outer) = written.cone();
                LightKind::Spot { inner, outer }
            }
        };
        let [red, green, blue, _] = written.color.value.linear;
        Light {
            kind,
            color: [red, green, blue],
            intensity: written.intensity.value,
            range: written.range.as_ref().map(|range| range.value * self.model.frame.unit),
        }
    }

    /// Turns nodes to what they look at, once everything stands in its place.
    pub(super) fn aim_nodes(&mut self) {
        let spec = self.spec;
        let mut aims = Vec::new();
        for (node, definition) in spec.nodes.values().enumerate() {
            let Some(aim) = &definition.value.aim else { continue };
            let goal = match &aim.value {
                Aim::Point(point) => Goal::Place(self.model.frame.map().transform_point3(*point)),
                Aim::Node(name) => match spec.nodes.get_index_of(name) {
                    Some(other) => Goal::Node(other),
                    None => continue,
                },
            };
            aims.push(Aimed { node, goal, span: aim.span });
        }
        let Some(order) = self.aim_order(&aims) else { return };
        for index in order {
            let aimed = aims[index];
            match self.looking(&Stage::new(self, &[]), &aimed, 0.0) {
                Some(rotation) => {
                    let turn = self.model.frame.turn();
                    let own = (turn.conjugate() * rotation * turn).normalize();
                    self.model.nodes[aimed.node].rotation = own;
                    self.aims.push(aimed);
                }
                None => self.report(nothing_to_see(&self.model.nodes[aimed.node].name, aimed.span, None)),
            }
        }
    }

    /// An order in which each node is turned after all that it, or what it looks at, is carried by; none where there is
    /// no such order.
    fn aim_order(&mut self, aims: &[Aimed]) -> Option<Vec<usize>> {
        let needs: Vec<Vec<usize>> = aims
            .iter()
            .map(|aimed| {
                let mut carriers = self.carriers(aimed.node);
                if let Goal::Node(goal) = aimed.goal {
                    carriers.extend(self.carriers(goal));
                    // What looks at itself looks nowhere.
                    carriers.extend((goal == aimed.node).then_some(goal));
                }
                (0..aims.len()).filter(|other| carriers.contains(&aims[*other].node)).collect()
            })
            .collect();
        let mut order = Vec::new();
        while order.len() < aims.len() {
            let ready = |index: &usize| {
                !order.contains(index) && needs[*index].iter().all(|other| order.contains(other))
            };
            let Some(next) = (0..aims.len()).find(ready) else {
                let stuck = (0..aims.len()).find(|index| !order.contains(index))?;
                let name = &self.model.nodes[aims[stuck].node].name;
                let message = format!("where `{name}` looks depends on where it looks");
                let report = Diagnostic::error(Code::AimCircle, message)
                    .at(aims[stuck].span, "moves with the node that looks at it")
                    .help("look at a node that this one does not carry");
                self.report(report);
                return None;
            };
            order.push(next);
        }
        Some(order)
    }

    /// The nodes that carry a node.
    fn carriers(&self, node: usize) -> Vec<usize> {
        let model = &self.model;
        let above = |node: usize| {
            let node = &model.nodes[node];
            node.parent.or_else(|| model.skeletons[node.socket?.skeleton].parent)
        };
        let chain = std::iter::successors(above(node), |node| above(*node));
        // Nodes that carry each other in a circle are told of elsewhere.
        chain.take(model.nodes.len()).collect()
    }

    /// The rotation of a node among those that one carrier carries, y up; none where there is nothing to look at.
    fn looking(&self, stage: &Stage<'_>, aimed: &Aimed, time: f64) -> Option<DQuat> {
        let eye = stage.place(aimed.node, time).translation;
        let goal = match aimed.goal {
            Goal::Place(place) => place,
            Goal::Node(node) => stage.place(node, time).translation,
        };
        if eye.distance(goal) <= SAME * (eye.length() + goal.length()) {
            return None;
        }
        let inside = stage.outside(aimed.node, time).inverse();
        let along = inside.transform_vector3(goal - eye).try_normalize()?;
        let own = &self.model.nodes[aimed.node];
        let z = if own.camera.is_some() || own.light.is_some() { -along } else { along };
        // Straight up or down the top of the picture is to the north, away from the front of a model.
        let tops = [DVec3::Y, DVec3::NEG_Z].map(|top| inside.transform_vector3(top).normalize_or_zero());
        let x = tops.into_iter().map(|top| top.cross(z)).find(|side| side.length() > UPRIGHT)?.normalize();
        Some(DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize())
    }

    /// Tracks of a clip that keep nodes looking; those that need not turn have none.
    pub(super) fn aim_tracks(&mut self, frames: &Frames<'_>, span: Span) -> Option<Vec<ClipTrack>> {
        let count = floor_count((frames.duration * frames.rate).ceil()).clamp(8, 1 << 20);
        let time = |k: u32| f64::from(single(frames.duration * f64::from(k) / f64::from(count)));
        let times: Vec<f64> = (0..=count).map(time).collect();
        let mut playing = frames.tracks.to_vec();
        for aimed in self.aims.clone() {
            let target = Target::Node(aimed.node);
            let turned = |track: &ClipTrack| track.target == target && track.course.path() == Path::Rotation;
            let name = &self.model.nodes[aimed.node].name;
            if playing.iter().any(turned) {
                let message = format!("a track turns `{name}`, which looks at something");
                let report = Diagnostic::error(Code::BadTrack, message)
                    .at(span, "turned in this clip")
                    .also(aimed.span, "it looks there")
                    .help("leave the track out (along a curve: write `orient = false`), or leave out `aim`");
                self.report(report);
                return None;
            }
            let own = self.model.nodes[aimed.node].rotation;
            let turn = self.model.frame.turn();
            let back = (turn * own * turn.conjugate()).normalize().conjugate();
            let stage = Stage::new(self, &playing);
            let found = |time: &f64| {
                self.looking(&stage, &aimed, *time).map(|turned| (back * turned).normalize()).ok_or(*time)
            };
            let rotations: Result<Vec<DQuat>, f64> = times.iter().map(found).collect();
            let rotations = match rotations {
                Ok(rotations) => rotations,
                Err(time) => {
                    let report = nothing_to_see(name, aimed.span, Some(time));
                    self.report(report.also(span, "in this clip"));
                    return None;
                }
            };
            if rotations.iter().all(|turned| 1.0 - turned.w.abs() <= STILL) {
                continue;
            }
            let course = Course::rotations(times.clone(), &rotations, Interpolation::Linear, frames.looped);
            playing.push(ClipTrack { target, course, space: Space::Rest, clamp: None });
        }
        Some(playing.split_off(frames.tracks.len()))
    }
}

fn nothing_to_see(name: &str, span: Span, time: Option<f64>) -> Diagnostic {
    let when = time.map_or(String::new(), |time| format!(" at {} s", show(time)));
    Diagnostic::error(Code::AimAtItself, format!("`{name}` is where it looks{when}"))
        .at(span, "no way to look")
        .help("look at another place, or put the node elsewhere")
}

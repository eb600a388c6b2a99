//! Nodes and joints as the tracks of a clip move them.

use glam::DAffine3;

use super::Builder;
use crate::model::{ClipTrack, Target};
use crate::motion::{Stand, Track, Transform};

/// Where everything is while tracks play. Cost of an answer: the nodes and joints up to the root, times the tracks.
pub(super) struct Stage<'b> {
    builder: &'b Builder<'b>,
    tracks: Vec<(&'b ClipTrack, Track<'b>)>,
}

impl<'b> Stage<'b> {
    pub(super) fn new(builder: &'b Builder<'_>, tracks: &'b [ClipTrack]) -> Self {
        let tracks = tracks.iter().map(|track| (track, Track::new(&track.course))).collect();
        Self { builder, tracks }
    }

    /// Where a skeleton stands at a time, metres, y up.
    pub(super) fn stand(&self, skeleton: usize, time: f64) -> Stand {
        let named = &self.builder.model.skeletons[skeleton];
        let local = |joint: usize| {
            self.moved(Target::Joint { skeleton, joint }, named.skeleton.joints[joint].rest, time)
        };
        Stand {
            base: named.parent.map_or(DAffine3::IDENTITY, |node| self.node(node, time, 0)),
            local: (0..named.skeleton.joints.len()).map(local).collect(),
        }
    }

    /// Where a node stands at a time, metres, y up.
    pub(super) fn place(&self, node: usize, time: f64) -> DAffine3 {
        self.node(node, time, 0)
    }

    /// Where what carries a node stands at a time, metres, y up.
    pub(super) fn outside(&self, node: usize, time: f64) -> DAffine3 {
        self.carrier(node, time, 0)
    }

    fn node(&self, index: usize, time: f64, depth: usize) -> DAffine3 {
        let model = &self.builder.model;
        let node = &model.nodes[index];
        let frame = &model.frame;
        let turn = frame.turn();
        let rest = Transform {
            translation: frame.map().transform_point3(node.translation),
            rotation: (turn * node.rotation * turn.conjugate()).normalize(),
            scale: frame.scale(node.scale),
        };
        let own = self.moved(Target::Node(index), rest, time).map();
        // Nodes that carry each other in a circle are told of elsewhere.
        if depth > model.nodes.len() + model.skeletons.len() {
            return own;
        }
        self.carrier(index, time, depth) * own
    }

    fn carrier(&self, index: usize, time: f64, depth: usize) -> DAffine3 {
        let model = &self.builder.model;
        let node = &model.nodes[index];
        match (node.parent, node.socket) {
            (Some(parent), _) => self.node(parent, time, depth + 1),
            (None, Some(socket)) => {
                let named = &model.skeletons[socket.skeleton];
                let place = &named.sockets[socket.socket];
                self.joint(socket.skeleton, place.joint, time, depth + 1) * place.place.map()
            }
            (None, None) => DAffine3::IDENTITY,
        }
    }

    fn joint(&self, skeleton: usize, joint: usize, time: f64, depth: usize) -> DAffine3 {
        let named = &self.builder.model.skeletons[skeleton];
        let mut map = DAffine3::IDENTITY;
        let mut next = Some(joint);
        while let Some(one) = next {
            let rest = named.skeleton.joints[one].rest;
            map = self.moved(Target::Joint { skeleton, joint: one }, rest, time).map() * map;
            next = named.skeleton.joints[one].bone.parent;
        }
        named.parent.map_or(DAffine3::IDENTITY, |node| self.node(node, time, depth + 1)) * map
    }

    fn moved(&self, target: Target, rest: Transform, time: f64) -> Transform {
        let mut place = rest;
        for (track, playing) in self.tracks.iter().filter(|(track, _)| track.target == target) {
            track.put(&mut place, &rest, playing.at(time), &self.builder.model.frame);
        }
        place
    }
}

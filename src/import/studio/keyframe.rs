//! Places that move: tracks of keys by frames, with tension, continuity and bias, eased in and out.
//!
//! A node carries what it names and other nodes. The rotation of a key is a turn on top of the one of the key before it, so
//! that more than half a turn goes the long way. Values between keys are those of 3D Studio's splines; of a track that is
//! repeated they go on from the last key to the first.
//!
//! Sources: D. Kochanek, R. Bartels, Interpolating splines with local tension, continuity, and bias control, SIGGRAPH
//! 1984; K. Shoemake, Quaternion calculus and fast animation, SIGGRAPH course notes, 1987 (squad).

use std::collections::BTreeMap;

use glam::{DQuat, DVec3, DVec4};

use super::StudioFault;
use super::chunk::Chunk;
use crate::geometry::number::{acos, sin, sin_cos_degrees};

/// The first and the last frame of a motion.
pub type Frames = (i32, i32);

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// An object, or a place that only carries others.
    Object,
    /// A camera.
    Camera,
    /// What a camera looks at.
    CameraTarget,
    /// A light.
    Light,
    /// What a spot shines at.
    LightTarget,
}

/// A place that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Name of the object, camera or light; `$$$DUMMY` of none.
    pub name: String,
    /// Its own name, where several show one object or none is there.
    pub instance: String,
    /// Index of the node that carries it.
    pub parent: Option<usize>,
    /// The point of the object's axes about which it turns.
    pub pivot: DVec3,
    /// Its place in its parent.
    pub position: Track,
    /// Its rotation in its parent, as quaternions.
    pub rotation: Track,
    /// Its factors of size.
    pub scale: Track,
    /// Degrees about the line of sight of a camera or spot.
    pub roll: Track,
    /// Degrees that a camera sees across.
    pub view: Track,
    /// Frames at which it is hidden, and shown again, by turns.
    pub hidden: Vec<i32>,
}

/// Keys of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// The keys, in the order of their frames.
    pub keys: Vec<Key>,
    /// Whether it goes on from the last key to the first.
    pub repeated: bool,
}

/// A key.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Key {
    /// Its frame.
    pub frame: i32,
    tension: f64,
    continuity: f64,
    bias: f64,
    ease_to: f64,
    ease_from: f64,
    /// Three numbers or one; or a quaternion.
    pub value: DVec4,
    /// Of a rotation the turn since the key before: axis and radians.
    turn: DVec4,
}

impl Node {
    /// Whether anything of it changes.
    #[must_use]
    pub fn moves(&self) -> bool {
        let tracks = [&self.position, &self.rotation, &self.scale, &self.roll];
        tracks.iter().any(|track| track.keys.len() > 1) || !self.hidden.is_empty()
    }
}

/// Reads the nodes, parents first, and the first and last frame.
pub(super) fn read(chunk: Chunk<'_>) -> Result<(Vec<Node>, Option<Frames>), StudioFault> {
    let mut nodes: Vec<(u16, u16, Node)> = Vec::new();
    let mut frames = None;
    chunk.inside(|mut chunk| {
        let kind = match chunk.id {
            0xb002 => NodeKind::Object,
            0xb003 => NodeKind::Camera,
            0xb004 => NodeKind::CameraTarget,
            0xb005 | 0xb007 => NodeKind::Light,
            0xb006 => NodeKind::LightTarget,
            0xb008 => {
                let mut frame = || chunk.word("a frame").map(u32::cast_signed);
                let (first, last) = (frame()?, frame()?);
                frames = (last > first).then_some((first, last));
                return Ok(());
            }
            _ => return Ok(()),
        };
        let number = u16::try_from(nodes.len()).unwrap_or(u16::MAX);
        nodes.push(node(kind, number, chunk)?);
        Ok(())
    })?;
    Ok((ordered(nodes)?, frames))
}

/// A node with its number and the one of its parent.
fn node(kind: NodeKind, number: u16, chunk: Chunk<'_>) -> Result<(u16, u16, Node), StudioFault> {
    let empty = Track::default;
    let mut made = Node {
        kind,
        name: String::new(),
        instance: String::new(),
        parent: None,
        pivot: DVec3::ZERO,
        position: empty(),
        rotation: empty(),
        scale: empty(),
        roll: empty(),
        view: empty(),
        hidden: Vec::new(),
    };
    let (mut own, mut parent) = (number, u16::MAX);
    chunk.inside(|mut chunk| {
        let vector = |chunk: &mut Chunk<'_>| Ok(chunk.vector("a key")?.extend(0.0));
        let number = |chunk: &mut Chunk<'_>| Ok(DVec4::X * chunk.float("a key")?);
        match chunk.id {
            0xb010 => {
                made.name = chunk.text("the name of a node")?;
                chunk.word("the flags of a node")?;
                parent = chunk.short("the parent of a node")?;
            }
            0xb011 => made.instance = chunk.text("the name of a node")?,
            0xb013 => made.pivot = chunk.vector("a pivot")?,
            0xb020 => made.position = track(chunk, 12, vector)?,
            0xb021 => {
                // Radians and an axis.
                let turn = |chunk: &mut Chunk<'_>| {
                    let radians = chunk.float("a key")?;
                    Ok(chunk.vector("a key")?.extend(radians))
                };
                made.rotation = absolute(track(chunk, 16, turn)?);
            }
            0xb022 => made.scale = track(chunk, 12, vector)?,
            0xb023 => made.view = track(chunk, 4, number)?,
            0xb024 => made.roll = track(chunk, 4, number)?,
            0xb029 => {
                let keys = track(chunk, 0, |_| Ok(DVec4::ZERO))?.keys;
                made.hidden = keys.iter().map(|key| key.frame).collect();
            }
            0xb030 => own = chunk.short("the number of a node")?,
            _ => {}
        }
        Ok(())
    })?;
    let tracks = [&made.position, &made.rotation, &made.scale, &made.roll, &made.view];
    let pairs =
        tracks.iter().flat_map(|track| track.keys.windows(2)).map(|pair| (pair[0].frame, pair[1].frame));
    let pairs = pairs.chain(made.hidden.windows(2).map(|pair| (pair[0], pair[1])));
    if let Some((before, next)) = pairs.into_iter().find(|(before, next)| next <= before) {
        return Err(StudioFault::Order { node: made.name, before, next });
    }
    Ok((own, parent, made))
}

/// Nodes with their parents before them.
fn ordered(nodes: Vec<(u16, u16, Node)>) -> Result<Vec<Node>, StudioFault> {
    let numbers: BTreeMap<u16, usize> =
        nodes.iter().enumerate().rev().map(|(at, (number, ..))| (*number, at)).collect();
    let parent = |at: usize| {
        let (_, parent, _) = nodes[at];
        // Nothing is carried by what is not there.
        numbers.get(&parent).copied().filter(|_| parent != u16::MAX)
    };
    let mut places: Vec<Option<usize>> = vec![None; nodes.len()];
    let mut order = Vec::with_capacity(nodes.len());
    for start in 0..nodes.len() {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(at) = next.filter(|at| places[*at].is_none()) {
            if chain.len() > nodes.len() {
                let (_, parent, node) = &nodes[start];
                let why = "carries it in a circle";
                return Err(StudioFault::Parent { node: node.name.clone(), parent: *parent, why });
            }
            chain.push(at);
            next = parent(at);
        }
        for at in chain.into_iter().rev() {
            places[at] = Some(order.len());
            order.push(at);
        }
    }
    let parents: Vec<Option<usize>> =
        order.iter().map(|at| parent(*at).and_then(|parent| places[parent])).collect();
    let mut nodes: Vec<Option<Node>> = nodes.into_iter().map(|(.., node)| Some(node)).collect();
    let with = |(at, parent): (usize, Option<usize>)| nodes[at].take().map(|node| Node { parent, ..node });
    Ok(order.into_iter().zip(parents).filter_map(with).collect())
}

fn track<'b>(
    mut chunk: Chunk<'b>,
    size: usize,
    value: impl Fn(&mut Chunk<'b>) -> Result<DVec4, StudioFault>,
) -> Result<Track, StudioFault> {
    let flags = chunk.short("the flags of a track")?;
    chunk.word("a track")?;
    chunk.word("a track")?;
    let count = usize::try_from(chunk.word("the number of keys")?).unwrap_or(usize::MAX);
    chunk.rows(count, 6 + size, "keys")?;
    let mut key = || {
        let mut made = Key { frame: chunk.word("a frame")?.cast_signed(), ..Key::default() };
        let given = chunk.short("the flags of a key")?;
        let Key { tension, continuity, bias, ease_to, ease_from, .. } = &mut made;
        for (bit, part) in [tension, continuity, bias, ease_to, ease_from].into_iter().enumerate() {
            if given & (1 << bit) != 0 {
                *part = chunk.float("a part of a key")?.clamp(-1.0, 1.0);
            }
        }
        made.value = value(&mut chunk)?;
        Ok(made)
    };
    let keys = (0..count).map(|_| key()).collect::<Result<_, StudioFault>>()?;
    Ok(Track { keys, repeated: flags & 3 != 0 })
}

/// Turns since the key before, as quaternions from the beginning.
fn absolute(mut track: Track) -> Track {
    let mut before = DQuat::IDENTITY;
    for key in &mut track.keys {
        key.turn = key.value;
        before = (about(key.turn, 1.0) * before).normalize();
        key.value = DVec4::from(before);
    }
    track
}

/// A share of a turn about an axis: clockwise, seen along it from its end.
fn about(turn: DVec4, share: f64) -> DQuat {
    let Some(axis) = turn.truncate().try_normalize() else { return DQuat::IDENTITY };
    let (sin, cos) = sin_cos_degrees(-0.5 * (turn.w * share).to_degrees());
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos).normalize()
}

impl Track {
    /// The key before a frame and the eased share of the way to the next; the nearest key where there is no other.
    fn locate(&self, frame: f64) -> Option<(usize, f64)> {
        let (first, last) = (f64::from(self.keys.first()?.frame), f64::from(self.keys.last()?.frame));
        let mut frame = frame;
        if self.repeated && last > first {
            frame = first + (frame - first).rem_euclid(last - first);
        }
        let next = self.keys.partition_point(|key| f64::from(key.frame) <= frame);
        let Some(key) = next.checked_sub(1) else { return Some((0, 0.0)) };
        let Some(after) = self.keys.get(next) else { return Some((key, 0.0)) };
        let own = self.keys[key];
        let share = (frame - f64::from(own.frame)) / (f64::from(after.frame) - f64::from(own.frame));
        Some((key, eased(share, own.ease_from.max(0.0), after.ease_to.max(0.0))))
    }

    /// The numbers at a frame; none where there are no keys.
    #[must_use]
    pub fn numbers(&self, frame: f64) -> Option<DVec4> {
        let (key, s) = self.locate(frame)?;
        if s <= 0.0 {
            return Some(self.keys[key].value);
        }
        let t = 1.0 - s;
        let (from, to) = (self.keys[key].value, self.keys[key + 1].value);
        let (leaving, coming) = (self.leaving(key), self.coming(key + 1));
        Some(
            from * (t * t * (1.0 + 2.0 * s)) + to * (s * s * (1.0 + 2.0 * t)) + leaving * (t * t * s)
                - coming * (s * s * t),
        )
    }

    /// The rotation at a frame; none where there are no keys.
    #[must_use]
    pub fn rotation(&self, frame: f64) -> Option<DQuat> {
        let (key, share) = self.locate(frame)?;
        let from = DQuat::from_vec4(self.keys[key].value);
        if share <= 0.0 {
            return Some(from);
        }
        let next = self.keys[key + 1];
        // Beyond half a turn quaternions would go the shorter way.
        if next.turn.w.abs() >= 3.1 {
            return Some((about(next.turn, share) * from).normalize());
        }
        let to = nearer(DQuat::from_vec4(next.value), from);
        let (leaving, coming) = (self.around(key).1, nearer(self.around(key + 1).0, from));
        let leaving = nearer(leaving, from);
        Some(straight(
            straight(from, to, share),
            straight(leaving, coming, share),
            2.0 * share * (1.0 - share),
        ))
    }

    /// Weights of the ways from the key before and to the next: for the slope that comes to a key, and that which leaves.
    fn weights(&self, key: usize) -> Option<[f64; 4]> {
        let own = self.keys[key];
        let (before, next) = (self.keys.get(key.checked_sub(1)?)?, self.keys.get(key + 1)?);
        let [before, here, next] = [before, &own, next].map(|key| f64::from(key.frame));
        let half = (next - before) / 2.0;
        let uneven = |step: f64| step + own.continuity.abs() * (1.0 - step);
        let (first, second) = (uneven((here - before) / half), uneven((next - here) / half));
        let tense = (1.0 - own.tension) / 2.0;
        let (low, high) = (tense * (1.0 - own.continuity), tense * (1.0 + own.continuity));
        let (less, more) = (1.0 - own.bias, 1.0 + own.bias);
        Some([low * more * first, high * less * first, high * more * second, low * less * second])
    }

    fn way(&self, from: usize, to: usize) -> DVec4 {
        self.keys[to].value - self.keys[from].value
    }

    /// The slope with which numbers come to a key, by the share of the way from the one before.
    fn coming(&self, key: usize) -> DVec4 {
        match self.weights(key) {
            Some([a, b, ..]) => self.way(key - 1, key) * a + self.way(key, key + 1) * b,
            None if self.keys.len() < 3 => self.way(key - 1, key) * (1.0 - self.keys[key].tension),
            None => {
                let way = self.way(key - 1, key) * 1.5 - self.leaving(key - 1) * 0.5;
                way * (1.0 - self.keys[key].tension)
            }
        }
    }

    /// The slope with which numbers leave a key, by the share of the way to the next.
    fn leaving(&self, key: usize) -> DVec4 {
        match self.weights(key) {
            Some([.., c, d]) => self.way(key - 1, key) * c + self.way(key, key + 1) * d,
            None if self.keys.len() < 3 => self.way(key, key + 1) * (1.0 - self.keys[key].tension),
            None => {
                let way = self.way(key, key + 1) * 1.5 - self.coming(key + 1) * 0.5;
                way * (1.0 - self.keys[key].tension)
            }
        }
    }

    /// The rotations between which a spline comes to a key and leaves it.
    fn around(&self, key: usize) -> (DQuat, DQuat) {
        let own = DQuat::from_vec4(self.keys[key].value);
        let Some([a, b, c, d]) = self.weights(key) else { return (own, own) };
        let value = |at: usize| nearer(DQuat::from_vec4(self.keys[at].value), own);
        let before = logarithm(value(key - 1).conjugate() * own);
        let after = logarithm(own.conjugate() * value(key + 1));
        let mixed = |before_share: f64, after_share: f64| {
            (own * exponential((before * before_share + after * after_share) * 0.5)).normalize()
        };
        (mixed(1.0 - a, -b), mixed(c, d - 1.0))
    }
}

/// A share of the way, slow where it leaves and comes.
fn eased(share: f64, from: f64, to: f64) -> f64 {
    let sum = from + to;
    if sum <= 0.0 {
        return share;
    }
    let (from, to) = if sum > 1.0 { (from / sum, to / sum) } else { (from, to) };
    let speed = 1.0 / (2.0 - from - to);
    if share < from {
        speed / from * share * share
    } else if share <= 1.0 - to {
        speed * (2.0 * share - from)
    } else {
        1.0 - speed / to * (1.0 - share) * (1.0 - share)
    }
}

fn nearer(to: DQuat, from: DQuat) -> DQuat {
    if to.dot(from) < 0.0 { -to } else { to }
}

/// Between two rotations at constant speed, along the way that the quaternions go.
fn straight(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let cos = from.dot(to).clamp(-1.0, 1.0);
    if cos > 1.0 - 1e-9 {
        return (from * (1.0 - share) + to * share).normalize();
    }
    let angle = acos(cos);
    let whole = sin(angle);
    // Opposite ones leave the way open.
    if whole < 1e-9 {
        return from;
    }
    (from * (sin((1.0 - share) * angle) / whole) + to * (sin(share * angle) / whole)).normalize()
}

/// Half the angle of a rotation along its axis.
fn logarithm(rotation: DQuat) -> DVec3 {
    let rotation = nearer(rotation, DQuat::IDENTITY);
    let vector = DVec3::new(rotation.x, rotation.y, rotation.z);
    vector.normalize_or_zero() * acos(rotation.w.clamp(-1.0, 1.0))
}

/// The rotation of half an angle along its axis.
fn exponential(half: DVec3) -> DQuat {
    let (sin, cos) = sin_cos_degrees(half.length().to_degrees());
    let axis = half.normalize_or_zero();
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

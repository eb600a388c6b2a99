//! Baked motion with few keys.
//!
//! The exact motion is sampled; for each track keys are kept greedily, each as far on as the way between
//! them stays within the track's share of the tolerance; then all points are played at the samples and
//! halfway between, and the shares are made as large as the tolerance allows. A rotation's share is its
//! tolerance over the greatest distance of a point that it carries.
//!
//! Players differ: some interpolate rotations on the sphere (glTF demands it), others by normalized straight
//! lines (Blender, many engines). The bound holds for both. Points are corners of boxes; a weighted mean of
//! affine maps moves no point of a box further than the worst corner, so a box stands for all it holds. Points that morph
//! are p + sum w (q - p) = (1 - sum w) p + sum w q: they lie in the sums of the scaled boxes of all p and q, and of all p
//! and q - p, and a weight that is wrong by e moves none further than e times the greatest |q - p|.
//!
//! Cost: O(samples * (nodes + tracks) * rounds), with at most some 20 rounds.

use std::borrow::Cow;

use glam::{DAffine3, DQuat, DVec3, DVec4};

use super::rig::{Rig, least_factor, order, places, reaches, rest_value, stretch};
use super::rotation::{nearer, normalized_lerp, slerp};
use super::track::Path;

/// A part of a node that changes.
pub struct Moving<'a> {
    /// The node.
    pub node: usize,
    /// Which part of it.
    pub path: Path,
    /// Which morph target a weight is of; 0 for other paths.
    pub target: usize,
    /// Its value at a time: translation or scale (x, y, z), rotation (x, y, z, w), weight (x); not relative to rest.
    pub exact: Box<dyn Fn(f64) -> DVec4 + Sync + 'a>,
    /// The times of its keys where it jumps from key to key, and is written so.
    pub steps: Option<Vec<f64>>,
    /// The times of its keys where it runs straight from key to key, and is written so.
    pub corners: Option<Vec<f64>>,
}

/// How the motion is sampled and how exactly it is kept.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Seconds from 0.
    pub duration: f64,
    /// No point moves further, metres.
    pub tolerance: f64,
    /// Samples a second to begin with.
    pub rate: f64,
    /// Times that must be samples.
    pub stops: Vec<f64>,
    /// The most samples.
    pub most: usize,
}

/// How a player goes between two keys of a rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Player {
    /// On the sphere.
    Sphere,
    /// Along a straight line, brought back to unit length.
    Line,
}

/// Keys of one track.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedTrack {
    /// Which of the given tracks.
    pub track: usize,
    /// Whether values stay until the next key.
    pub stepped: bool,
    /// Seconds, increasing, exact in single precision.
    pub times: Vec<f64>,
    /// Values in single precision.
    pub values: Vec<DVec4>,
}

/// A motion with few keys.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The tracks that remain; those that keep their node at rest are left out.
    pub tracks: Vec<ReducedTrack>,
    /// The greatest distance of a point from its exact place, at the samples and halfway between them, metres.
    pub bound: f64,
    /// Samples of the exact motion.
    pub samples: usize,
    /// The box of all points at all samples, in space.
    pub reach: Option<(DVec3, DVec3)>,
}

/// Reduces a motion.
#[must_use]
pub fn reduce(rig: &Rig, moving: &[Moving<'_>], wanted: &Wanted) -> Reduced {
    let order = order(rig);
    let mut rate = wanted.rate;
    loop {
        let study = Study::new(rig, moving, wanted, (rate, &order));
        let reduced = study.best(wanted.tolerance);
        let enough = reduced.bound <= wanted.tolerance || rate >= 15.0 * wanted.rate;
        if enough || study.times.len() > wanted.most {
            return reduced;
        }
        rate *= 2.0;
    }
}

/// A time in the precision in which it is written.
pub(super) fn single(time: f64) -> f64 {
    f64::from(crate::geometry::number::single(time))
}

/// A value in the precision in which it is written; rotations keep unit length as far as that allows.
pub(super) fn rounded(value: DVec4) -> DVec4 {
    value.as_vec4().as_dvec4()
}

/// The exact motion, sampled.
struct Study<'a> {
    rig: &'a Rig,
    moving: &'a [Moving<'a>],
    order: &'a [usize],
    /// Samples at even places may be keys; those at odd places, halfway between, only judge.
    times: Vec<f64>,
    /// For each track its values at the times.
    values: Vec<Vec<DVec4>>,
    /// For each time the places of all points.
    places: Vec<Vec<DVec3>>,
    /// For each track the error of its value that moves a point by one metre.
    levers: Vec<f64>,
}

impl<'a> Study<'a> {
    fn new(
        rig: &'a Rig,
        moving: &'a [Moving<'a>],
        wanted: &Wanted,
        (rate, order): (f64, &'a [usize]),
    ) -> Self {
        let times = sampled(wanted, rate);
        let values: Vec<Vec<DVec4>> = moving
            .iter()
            .map(|one| {
                let mut before = DVec4::ZERO;
                let value = |time: &f64| {
                    let mut value = (one.exact)(*time);
                    if one.path == Path::Rotation && value.dot(before) < 0.0 {
                        value = -value;
                    }
                    before = value;
                    value
                };
                times.iter().map(value).collect()
            })
            .collect();
        let mut study = Self { rig, moving, order, times, values, places: Vec::new(), levers: Vec::new() };
        study.play_exactly();
        study
    }

    fn play_exactly(&mut self) {
        let mut levers = vec![0.0_f64; self.moving.len()];
        let parents = self.rig.parents.clone();
        for sample in 0..self.times.len() {
            let value = |track: usize| self.values[track][sample];
            let worlds = worlds(self.rig, self.order, self.moving, value);
            let points = self.points(sample);
            let reach = reaches(self.rig, &points, self.order, &worlds);
            for (lever, one) in levers.iter_mut().zip(self.moving) {
                let outside = parents[one.node].map_or(DAffine3::IDENTITY, |parent| worlds[parent]);
                let stretch = stretch(&outside);
                *lever = lever.max(match one.path {
                    Path::Translation => stretch,
                    Path::Rotation => reach[one.node],
                    // The points a scale moves lie within the reach over the least of its factors.
                    Path::Scale => reach[one.node] / least_factor(&worlds[one.node]) * stretch,
                    Path::Weight => {
                        let own = self.rig.morphed.iter().filter(|morphed| morphed.weights == one.node);
                        own.map(|own| own.states[one.target].furthest * self::stretch(&worlds[own.node]))
                            .fold(0.0, f64::max)
                    }
                });
            }
            self.places.push(places(&points, &worlds));
        }
        self.levers = levers;
    }

    /// The weights of a node's morph targets, where the values of tracks are given.
    fn weights(&self, node: usize, value: impl Fn(usize) -> DVec4) -> Vec<f64> {
        let mut weights = self.rig.weights[node].clone();
        for (track, one) in self.moving.iter().enumerate() {
            if one.node == node && one.path == Path::Weight {
                weights[one.target] = value(track).x;
            }
        }
        weights
    }

    /// For each node its points at a sample: those that do not morph, and the corners of the boxes of those that do.
    fn points(&self, sample: usize) -> Cow<'a, [Vec<DVec3>]> {
        if self.rig.morphed.is_empty() {
            return Cow::Borrowed(&self.rig.points);
        }
        let mut points = self.rig.points.clone();
        for morphed in &self.rig.morphed {
            let weights = self.weights(morphed.weights, |track| self.values[track][sample]);
            points[morphed.node].extend(morphed.at(&weights).corners());
        }
        Cow::Owned(points)
    }

    /// For each node how far its points are off by wrong weights alone.
    fn slack(&self, sample: usize, played: &[DVec4], worlds: &[DAffine3]) -> Vec<f64> {
        let mut slack = vec![0.0; worlds.len()];
        for morphed in &self.rig.morphed {
            let exact = self.weights(morphed.weights, |track| self.values[track][sample]);
            let found = self.weights(morphed.weights, |track| played[track]);
            let off = exact.iter().zip(found).zip(&morphed.states);
            let off: f64 = off.map(|((exact, found), state)| (found - exact).abs() * state.furthest).sum();
            slack[morphed.node] = f64::max(slack[morphed.node], off * stretch(&worlds[morphed.node]));
        }
        slack
    }

    /// The value of a track at rest.
    fn at_rest(&self, one: &Moving<'_>) -> DVec4 {
        match one.path {
            Path::Weight => DVec4::X * self.rig.weights[one.node][one.target],
            path => rest_value(&self.rig.rest[one.node], path),
        }
    }

    /// The fewest keys found within a tolerance.
    fn best(&self, tolerance: f64) -> Reduced {
        let shares = self.shares();
        let attempt = |factor: f64| {
            let limit = |track: usize| tolerance * factor / (shares[track] * self.levers[track].max(1e-12));
            let tracks: Vec<ReducedTrack> =
                (0..self.moving.len()).map(|track| self.kept(track, limit(track))).collect();
            let bound = self.error(&tracks, tolerance);
            (tracks, bound)
        };
        let mut good = None;
        let (mut low, mut high) = (0.0, 64.0);
        let mut factor = 64.0;
        // From generous shares down by halves to the first that holds.
        while factor > 1e-3 {
            let found = attempt(factor);
            if found.1 <= tolerance {
                (good, low) = (Some(found), factor);
                break;
            }
            (high, factor) = (factor, factor / 2.0);
        }
        for _ in 0..if good.is_some() && low < high { 3 } else { 0 } {
            let middle = (low + high) / 2.0;
            let found = attempt(middle);
            if found.1 <= tolerance { (good, low) = (Some(found), middle) } else { high = middle }
        }
        let (tracks, bound) = good.unwrap_or_else(|| {
            let all: Vec<_> = (0..self.moving.len()).map(|track| self.kept(track, 0.0)).collect();
            let bound = self.error(&all, f64::INFINITY);
            (all, bound)
        });
        self.finish(tracks, bound)
    }

    fn finish(&self, mut tracks: Vec<ReducedTrack>, bound: f64) -> Reduced {
        let resting = |track: &ReducedTrack| {
            let one = &self.moving[track.track];
            track.times.len() == 1 && track.values[0] == rounded(self.at_rest(one))
        };
        let moved: Vec<ReducedTrack> = tracks.iter().filter(|track| !resting(track)).cloned().collect();
        if moved.is_empty() {
            tracks.truncate(1);
        } else {
            tracks = moved;
        }
        self.last_to_the_end(&mut tracks);
        let mut places = self.places.iter().flatten();
        let reach = places.next().map(|first| {
            places.fold((*first, *first), |(min, max), place| (min.min(*place), max.max(*place)))
        });
        Reduced { tracks, bound, samples: self.times.len().div_ceil(2), reach }
    }

    /// Some track has a key at the end, so that a player gives the clip its duration.
    fn last_to_the_end(&self, tracks: &mut [ReducedTrack]) {
        let end = self.times[self.times.len() - 1];
        if tracks.iter().any(|track| track.times.last() == Some(&end)) {
            return;
        }
        if let Some(track) = tracks.first_mut() {
            if track.times[0] > 0.0 {
                track.times.insert(0, 0.0);
                track.values.insert(0, track.values[0]);
            }
            track.times.push(end);
            track.values.push(track.values[track.values.len() - 1]);
        }
    }

    /// Into how many parts the tolerance is cut for a track: the most tracks on a way from a root through its node.
    fn shares(&self) -> Vec<f64> {
        let mut own = vec![0.0_f64; self.rig.parents.len()];
        for one in self.moving.iter().filter(|one| one.steps.is_none()) {
            own[one.node] += 1.0;
        }
        let mut above = own.clone();
        for node in self.order {
            above[*node] += self.rig.parents[*node].map_or(0.0, |parent| above[parent]);
        }
        let mut through = above.clone();
        for node in self.order.iter().rev() {
            if let Some(parent) = self.rig.parents[*node] {
                through[parent] = through[parent].max(through[*node]);
            }
        }
        self.moving.iter().map(|one| through[one.node].max(1.0)).collect()
    }

    /// The keys of a track whose value may be wrong by `limit`.
    fn kept(&self, track: usize, limit: f64) -> ReducedTrack {
        let one = &self.moving[track];
        let written = |times: Vec<f64>, values: Vec<DVec4>| ReducedTrack {
            track,
            stepped: one.steps.is_some(),
            times,
            values: values.into_iter().map(rounded).collect(),
        };
        if let Some(steps) = &one.steps {
            return self.stepped(one, steps, written);
        }
        let values = &self.values[track];
        let rest = self.at_rest(one);
        let constant = |value: DVec4| values.iter().all(|other| gap(one.path, value, *other) <= limit);
        if constant(rest) {
            return written(vec![0.0], vec![rest]);
        }
        if constant(values[0]) {
            return written(vec![0.0], vec![values[0]]);
        }
        if let Some(corners) = &one.corners {
            return self.cornered(one, corners, written);
        }
        let last = values.len() - 1;
        let (mut times, mut kept) = (vec![self.times[0]], vec![values[0]]);
        let mut from = 0;
        while from < last {
            from = self.furthest(one.path, values, from, limit);
            times.push(self.times[from]);
            kept.push(values[from]);
        }
        written(times, kept)
    }

    fn stepped(
        &self,
        one: &Moving<'_>,
        steps: &[f64],
        written: impl Fn(Vec<f64>, Vec<DVec4>) -> ReducedTrack,
    ) -> ReducedTrack {
        let (times, values) = stepped(&*one.exact, steps);
        debug_assert!(!times.is_empty() && self.times.len() > 1);
        written(times, values)
    }

    /// The keys of what runs straight between them, without those that lie on the way of their neighbours.
    fn cornered(
        &self,
        one: &Moving<'_>,
        corners: &[f64],
        written: impl Fn(Vec<f64>, Vec<DVec4>) -> ReducedTrack,
    ) -> ReducedTrack {
        let (mut times, mut values): (Vec<f64>, Vec<DVec4>) = (Vec::new(), Vec::new());
        for time in corners.iter().map(|time| single(*time)) {
            let value = (one.exact)(time);
            if let ([.., a, b], [.., from, over]) = (times.as_slice(), values.as_slice()) {
                let way = *from + (value - *from) * ((b - a) / (time - a));
                if way.distance(*over) <= 1e-9 {
                    times.pop();
                    values.pop();
                }
            }
            if times.last().is_none_or(|last| *last < time) {
                times.push(time);
                values.push(value);
            }
        }
        debug_assert!(!times.is_empty() && self.times.len() > 1);
        written(times, values)
    }

    /// The furthest sample to which the way from another runs within a limit.
    fn furthest(&self, path: Path, values: &[DVec4], from: usize, limit: f64) -> usize {
        let last = values.len() - 1;
        let reaches = |to: usize| {
            let (start, span) = (self.times[from], self.times[to] - self.times[from]);
            (from + 1..to).all(|inner| {
                let share = (self.times[inner] - start) / span;
                [Player::Sphere, Player::Line].iter().all(|player| {
                    let way = between(path, *player, (rounded(values[from]), rounded(values[to])), share);
                    gap(path, way, values[inner]) <= limit
                })
            })
        };
        furthest(from, last, reaches)
    }

    /// The greatest distance of a point from its place, with either player; at least `enough` as soon as that is passed.
    fn error(&self, tracks: &[ReducedTrack], enough: f64) -> f64 {
        let mut worst = 0.0_f64;
        for player in [Player::Sphere, Player::Line] {
            let mut cursors = vec![0; tracks.len()];
            for (sample, time) in self.times.iter().enumerate() {
                let played: Vec<DVec4> = tracks
                    .iter()
                    .zip(&mut cursors)
                    .map(|(track, cursor)| {
                        let path = self.moving[track.track].path;
                        track.play(path, player, *time, cursor)
                    })
                    .collect();
                let worlds = worlds(self.rig, self.order, self.moving, |track| played[track]);
                let points = self.points(sample);
                let slack = self.slack(sample, &played, &worlds);
                let found = places(&points, &worlds);
                let slack = points.iter().zip(slack).flat_map(|(own, slack)| own.iter().map(move |_| slack));
                let off = found.iter().zip(&self.places[sample]).zip(slack);
                let off = off.map(|((found, exact), slack)| found.distance(*exact) + slack);
                worst = off.fold(worst, f64::max);
                if worst > enough {
                    return worst;
                }
            }
        }
        worst
    }
}

impl ReducedTrack {
    /// The value at a time, rotations on the sphere.
    #[must_use]
    pub fn at(&self, path: Path, time: f64) -> DVec4 {
        self.play(path, Player::Sphere, time, &mut 0)
    }

    /// The value at a time; `cursor` is the key that was used last, and times come in order.
    fn play(&self, path: Path, player: Player, time: f64, cursor: &mut usize) -> DVec4 {
        while *cursor + 1 < self.times.len() && self.times[*cursor + 1] <= time {
            *cursor += 1;
        }
        let key = *cursor;
        if self.stepped || key + 1 == self.times.len() || time <= self.times[key] {
            return self.values[key];
        }
        let share = (time - self.times[key]) / (self.times[key + 1] - self.times[key]);
        between(path, player, (self.values[key], self.values[key + 1]), share)
    }
}

/// The furthest sample that a key at `from` reaches, at an even place: found by doubling the step, then halving. The next one
/// is always reached.
pub(super) fn furthest(from: usize, last: usize, reaches: impl Fn(usize) -> bool) -> usize {
    let (mut good, mut step) = (from + 2, 2);
    let mut bad = loop {
        let next = good + 2 * step;
        if next > last {
            break last + 2;
        }
        if !reaches(next) {
            break next;
        }
        (good, step) = (next, 2 * step);
    };
    while bad - good > 2 {
        let middle = good + (bad - good) / 4 * 2;
        let middle = if middle == good { good + 2 } else { middle };
        if reaches(middle) { good = middle } else { bad = middle }
    }
    good
}

/// The keys of what jumps from key to key, without those that change nothing.
pub(super) fn stepped(exact: &dyn Fn(f64) -> DVec4, steps: &[f64]) -> (Vec<f64>, Vec<DVec4>) {
    let (mut times, mut values): (Vec<f64>, Vec<DVec4>) = (Vec::new(), Vec::new());
    for time in steps {
        let value = exact(*time);
        if values.last() != Some(&value) {
            times.push(single(*time));
            values.push(value);
        }
    }
    (times, values)
}

/// Even samples, the stops, and halfway between any two.
pub(super) fn sampled(wanted: &Wanted, rate: f64) -> Vec<f64> {
    let count = crate::geometry::number::floor_count((wanted.duration * rate).ceil()).clamp(8, 1 << 24);
    let even = (0..=count).map(|k| wanted.duration * f64::from(k) / f64::from(count));
    let stops = wanted.stops.iter().copied().filter(|time| (0.0..=wanted.duration).contains(time));
    let mut all: Vec<f64> = even.chain(stops).map(single).collect();
    all.sort_by(f64::total_cmp);
    // Neighbours that are the same but for rounding would make a key that no one sees.
    all.dedup_by(|later, before| *later - *before < 1e-5);
    let end = single(wanted.duration);
    if let Some(last) = all.last_mut() {
        *last = end;
    }
    let mut times = Vec::with_capacity(2 * all.len());
    for pair in all.windows(2) {
        times.extend([pair[0], f64::midpoint(pair[0], pair[1])]);
    }
    times.extend(all.last());
    times
}

fn between(path: Path, player: Player, (from, to): (DVec4, DVec4), share: f64) -> DVec4 {
    if path != Path::Rotation {
        return from + (to - from) * share;
    }
    let (from, to) = (DQuat::from_vec4(from).normalize(), DQuat::from_vec4(to).normalize());
    DVec4::from(match player {
        Player::Sphere => slerp(from, to, share),
        Player::Line => normalized_lerp(from, to, share),
    })
}

/// How far apart two values are: metres, factors, or radians (by the chord, which is shorter by at most a ninth up to a
/// right angle).
fn gap(path: Path, a: DVec4, b: DVec4) -> f64 {
    if path != Path::Rotation {
        return (a - b).length();
    }
    2.0 * DVec4::from(nearer(DQuat::from_vec4(a), DQuat::from_vec4(b))).distance(b)
}

/// The maps from the nodes to space, with the tracks' values in place of what they move.
fn worlds(
    rig: &Rig,
    order: &[usize],
    moving: &[Moving<'_>],
    value: impl Fn(usize) -> DVec4,
) -> Vec<DAffine3> {
    let mut local = rig.rest.clone();
    for (track, one) in moving.iter().enumerate() {
        let value = value(track);
        let place = &mut local[one.node];
        match one.path {
            Path::Translation => place.translation = value.truncate(),
            Path::Rotation => place.rotation = DQuat::from_vec4(value).normalize(),
            Path::Scale => place.scale = value.truncate(),
            Path::Weight => {}
        }
    }
    let mut worlds = vec![DAffine3::IDENTITY; local.len()];
    for node in order {
        let outside = rig.parents[*node].map_or(DAffine3::IDENTITY, |parent| worlds[parent]);
        worlds[*node] = outside * local[*node].map();
    }
    worlds
}

#[cfg(test)]
mod tests;

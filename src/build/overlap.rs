//! Sweeps that fold over themselves in a bend, or run into another part of themselves.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::Builder;
use super::profile::show;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::{Bounds, floor_count};
use crate::geometry::planar::encloses;
use crate::geometry::surface::{Stand, SweptSurface};
use crate::geometry::tessellate::{Route, Sweep};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;

/// Samples of a section that stand for all of it.
const AROUND: u32 = 48;

/// The share of a section, about its middle, that must lie outside of other parts: parts that touch do not cut each other, and a section is known by
/// samples.
const INSIDE: f64 = 0.97;

impl Builder<'_> {
    /// Warns where a section reaches beyond the center of a bend, or into a distant part of its own way.
    pub(super) fn check_overlap(&mut self, shape: &Sweep, span: Span) {
        let Route::Path { path, .. } = &shape.route else { return };
        let (reach, width) = extent(shape);
        let fold = if least_radius(path) < reach { fold(&shape.surface()) } else { None };
        if let Some(fold) = fold {
            self.report_fold(&fold, span);
            return;
        }
        if !shape.outlines[0][0].is_closed() {
            return;
        }
        let walk = Walk::new(path, reach, width);
        let pairs = walk.near_pairs(reach);
        if pairs.is_empty() {
            return;
        }
        if let Some((one, other)) = meeting(&shape.surface(), &walk, &pairs) {
            self.report_meeting((&walk, one, other), span);
        }
    }

    fn report_fold(&mut self, fold: &Fold, span: Span) {
        let message = format!(
            "the section is too wide for its path: it reaches {} toward the center of a bend of radius {}, near {} at parameter {}",
            show(fold.reach),
            show(fold.radius),
            place(fold.at),
            show(fold.v)
        );
        let report = Diagnostic::warning(Code::TightBend, message)
            .at(span, "bends more tightly than the section is wide")
            .help("make the section smaller or the bend wider: beyond the center of the bend the surface folds over itself");
        self.report(report);
    }

    fn report_meeting(&mut self, (walk, one, other): (&Walk, usize, usize), span: Span) {
        let (here, there) = (&walk.stops[one], &walk.stops[other]);
        let message = format!(
            "the sweep runs into itself near {}: there parameter {} of the path meets parameter {}",
            place((here.point + there.point) / 2.0),
            show(here.v),
            show(there.v)
        );
        let report = Diagnostic::warning(Code::SelfOverlap, message)
            .at(span, format!("{} from itself", show(here.point.distance(there.point))))
            .help("lead the path further past itself there, or make the section smaller: where two parts overlap, the volume counts twice");
        self.report(report);
    }
}

/// How far the section reaches from its path and half of its own width, at its greatest factors; of samples.
fn extent(shape: &Sweep) -> (f64, f64) {
    let of = |curve: &AnyCurve| {
        let domain = curve.domain();
        let samples = (0..=64).map(|k| domain.at(f64::from(k) / 64.0));
        let places: Vec<DVec3> = samples.chain(curve.joints()).map(|t| curve.point(t)).collect();
        let width = Bounds::of_points(places.iter().copied()).diagonal() / 2.0;
        (places.iter().map(|place| place.length()).fold(0.0, f64::max), width)
    };
    let both = shape.outlines[0]
        .iter()
        .map(of)
        .fold((0.0_f64, 0.0_f64), |most, one| (most.0.max(one.0), most.1.max(one.1)));
    let factor = shape.change.greatest_weight() * shape.change.scale.greatest().max_element();
    (both.0 * factor, both.1 * factor)
}

/// A prime, so that a path of many equal bends is not met at equal places.
const SAMPLES: u32 = 1021;

fn samples(path: &AnyCurve) -> impl Iterator<Item = f64> {
    let domain = path.domain();
    (0..SAMPLES).map(move |k| domain.at((f64::from(k) + 0.5) / f64::from(SAMPLES)))
}

/// The radius of the tightest bend.
fn least_radius(path: &AnyCurve) -> f64 {
    let radius = |t: f64| {
        let jet = path.evaluate(t, Side::After);
        let speed = jet.first.length();
        speed * speed * speed / jet.first.cross(jet.second).length()
    };
    samples(path).map(radius).fold(f64::INFINITY, f64::min)
}

/// Where a section reaches furthest beyond the center of a bend.
struct Fold {
    v: f64,
    at: DVec3,
    reach: f64,
    radius: f64,
}

/// The worst fold: a point `p` of the section stands still where `p . curvature` is 1, and moves back beyond.
fn fold(surface: &SweptSurface) -> Option<Fold> {
    let path = surface.carrier.path()?;
    let mut worst: Option<(f64, Fold)> = None;
    let reach = surface.reach();
    for v in samples(path) {
        let jet = path.evaluate(v, Side::After);
        let bend = jet.second / jet.first.length_squared();
        if bend.length() * reach <= 1.0 {
            continue;
        }
        let stand = surface.stand(v, Side::After);
        let frame = &stand.plane.frame;
        let curvature = DVec2::new(bend.dot(frame.side), bend.dot(frame.up));
        let toward = |place: DVec2| place.dot(curvature);
        let most = section(surface, &stand).into_iter().map(toward).fold(0.0, f64::max);
        if most > 1.0 && worst.as_ref().is_none_or(|(found, _)| most > *found) {
            let radius = 1.0 / curvature.length();
            worst = Some((most, Fold { v, at: jet.point, reach: most * radius, radius }));
        }
    }
    worst.map(|(_, fold)| fold)
}

/// The outer outline at one place of the way.
fn section(surface: &SweptSurface, stand: &Stand) -> Vec<DVec2> {
    let outline = &surface.outlines[0];
    let domain = outline.domain();
    let even = (0..AROUND).map(|k| domain.at(f64::from(k) / f64::from(AROUND)));
    let mut all: Vec<f64> = even.chain(outline.joints()).collect();
    all.sort_by(f64::total_cmp);
    all.into_iter().map(|u| outline.at(u, Side::After, &stand.mix).place).collect()
}

/// A path in steps that are short beside the section's width.
struct Walk {
    stops: Vec<Stop>,
    length: f64,
    closed: bool,
}

struct Stop {
    v: f64,
    point: DVec3,
    walked: f64,
    /// Whether a mitre cuts the section here.
    mitred: bool,
}

impl Walk {
    fn new(path: &AnyCurve, reach: f64, width: f64) -> Self {
        const FEWEST: u32 = 64;
        const MOST: u32 = 2048;
        let domain = path.domain();
        let rough = |count: u32| -> f64 {
            let at = |k: u32| path.point(domain.at(f64::from(k) / f64::from(count)));
            (0..count).map(|k| at(k).distance(at(k + 1))).sum()
        };
        let count = floor_count(4.0 * rough(FEWEST) / width).clamp(FEWEST, MOST);
        let mut cuts: Vec<f64> = (0..=count).map(|k| domain.at(f64::from(k) / f64::from(count))).collect();
        cuts.extend(path.joints());
        cuts.sort_by(f64::total_cmp);
        let mut stops: Vec<Stop> = Vec::with_capacity(cuts.len());
        for v in cuts {
            let point = path.point(v);
            let walked = stops.last().map_or(0.0, |last| last.walked + last.point.distance(point));
            stops.push(Stop { v, point, walked, mitred: false });
        }
        let length = stops[stops.len() - 1].walked;
        let mut walk = Self { stops, length, closed: path.is_closed() };
        walk.mark_mitres(path, reach);
        walk
    }

    /// At a corner both sides of the section reach past the plane between them, where the mitre cuts them.
    fn mark_mitres(&mut self, path: &AnyCurve, reach: f64) {
        let domain = path.domain();
        let mut corners: Vec<(f64, f64)> = path.joints().into_iter().map(|t| (t, t)).collect();
        if self.closed {
            corners.push((domain.end, domain.start));
        }
        for (end, start) in corners {
            let cosine = path.direction(end, Side::Before).dot(path.direction(start, Side::After));
            let cut = reach * ((1.0 - cosine).max(0.0) / (1.0 + cosine).max(1e-9)).sqrt();
            let near = self.stops.partition_point(|stop| stop.v < start).min(self.stops.len() - 1);
            let corner = self.stops[near].walked;
            for index in 0..self.stops.len() {
                let away = self.apart(self.stops[index].walked, corner);
                self.stops[index].mitred |= cut > 0.0 && away <= 1.01 * cut;
            }
        }
    }

    /// Length of the way between two places, the shorter way around.
    fn apart(&self, one: f64, other: f64) -> f64 {
        let between = (one - other).abs();
        if self.closed { between.min(self.length - between) } else { between }
    }

    /// Stops whose sections may touch though they are not neighbors on the way. Compared are those that lie near each
    /// other along the longest side of the path's box.
    fn near_pairs(&self, reach: f64) -> Vec<(usize, usize)> {
        let size = 2.0 * reach;
        let bounds = Bounds::of_points(self.stops.iter().map(|stop| stop.point));
        let extent = (bounds.max - bounds.min).to_array();
        let axis = (0..3).max_by(|a: &usize, b: &usize| extent[*a].total_cmp(&extent[*b])).unwrap_or(0);
        let free = self.stops.iter().enumerate().filter(|(_, stop)| !stop.mitred);
        let mut order: Vec<(f64, usize)> = free.map(|(index, stop)| (stop.point[axis], index)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut pairs = Vec::new();
        for (rank, (place, index)) in order.iter().enumerate() {
            let stop = &self.stops[*index];
            let beside = order[rank + 1..].iter().take_while(|(other, _)| other - place < size);
            // On a bend that does not fold, sections nearer than half a turn do not reach each other.
            let far = beside.map(|(_, other)| *other).filter(|other| {
                let other = &self.stops[*other];
                self.apart(stop.walked, other.walked) > std::f64::consts::PI * reach
                    && stop.point.distance_squared(other.point) < size * size
            });
            pairs.extend(far.map(|other| (other.min(*index), other.max(*index))));
        }
        pairs.sort_unstable();
        pairs
    }
}

/// The first pair of stops of which one has a point of its section inside the other.
fn meeting(surface: &SweptSurface, walk: &Walk, pairs: &[(usize, usize)]) -> Option<(usize, usize)> {
    let mut sections: BTreeMap<usize, (Stand, Vec<DVec2>)> = BTreeMap::new();
    for index in pairs.iter().flat_map(|(one, other)| [*one, *other]) {
        sections.entry(index).or_insert_with(|| {
            let stand = surface.stand(walk.stops[index].v, Side::After);
            let places = section(surface, &stand);
            (stand, places)
        });
    }
    let reaches = |from: usize, into: usize| {
        let ((one, places), (other, outline)) = (&sections[&from], &sections[&into]);
        let before = walk.stops[into].walked - walk.stops[into.saturating_sub(1)].walked;
        let after = walk.stops[(into + 1).min(walk.stops.len() - 1)].walked - walk.stops[into].walked;
        let frame = &other.plane.frame;
        let (center, there) = (middle(places), middle(outline));
        places.iter().any(|place| {
            let shrunk = center + (*place - center) * INSIDE;
            let away = one.plane.point(shrunk.x, shrunk.y) - other.plane.origin;
            let along = away.dot(frame.along);
            along > -before / 2.0
                && along < after / 2.0
                && encloses(
                    outline,
                    there + (DVec2::new(away.dot(frame.side), away.dot(frame.up)) - there) / INSIDE,
                )
        })
    };
    pairs.iter().copied().find(|(one, other)| reaches(*one, *other) || reaches(*other, *one))
}

fn middle(places: &[DVec2]) -> DVec2 {
    places.iter().sum::<DVec2>() / places.len() as f64
}

fn place(point: DVec3) -> String {
    format!("[{}, {}, {}]", show(point.x), show(point.y), show(point.z))
}

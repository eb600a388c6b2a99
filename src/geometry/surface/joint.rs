//! How smoothly surfaces continue across their common lines.

use std::fmt;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelExtend, ParallelIterator};

use super::Surface;
use super::rim::{Line, Rim};
use crate::geometry::curve::Side;
use crate::geometry::number::{Bounds, atan2};

/// How well two surfaces join along a line, from the least to the most.
///
/// Source: G. Farin, Curves and Surfaces for CAGD, 5th ed. 2002, chapters 15 and 20.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PatchContinuity {
    /// They have one line in common, which their parameters run along in different ways.
    G0,
    /// They have one line in common, with equal parameters.
    C0,
    /// Their tangent planes agree all along it.
    G1,
    /// Their first derivatives agree.
    C1,
    /// Their first and second derivatives agree.
    C2,
}

impl PatchContinuity {
    /// All, from the least to the most.
    pub const ALL: [Self; 5] = [Self::G0, Self::C0, Self::G1, Self::C1, Self::C2];
}

impl fmt::Display for PatchContinuity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, formatter)
    }
}

/// What was found along a whole common line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothness {
    /// The class, up to rounding.
    pub continuity: PatchContinuity,
    /// The greatest angle between the tangent planes, degrees: 0 where they agree, 180 where the surface turns back
    /// on itself.
    pub angle: f64,
    /// Where that is.
    pub place: DVec3,
    /// The greatest difference of the derivatives across the line, as a share of the greater.
    pub slope: f64,
    /// The same of the second derivatives.
    pub bend: f64,
    /// Whether equal shares of the line are equal points.
    pub same_parameters: bool,
}

/// What differs by less than this is equal but for rounding: radians for planes, shares for derivatives.
const ROUNDING: f64 = 1e-7;

impl Smoothness {
    /// Whether the joint is at least as good as declared when planes may differ by an angle in degrees, and
    /// derivatives by the same share (a hundredth of it for a degree is 0.000175).
    #[must_use]
    pub fn holds(&self, declared: PatchContinuity, within: f64) -> bool {
        let share = within.to_radians().max(ROUNDING);
        let (planes, slopes) = (self.angle.to_radians() <= share, self.slope <= share);
        match declared {
            PatchContinuity::G0 => true,
            PatchContinuity::C0 => self.same_parameters,
            PatchContinuity::G1 => planes,
            PatchContinuity::C1 => self.same_parameters && planes && slopes,
            PatchContinuity::C2 => self.same_parameters && planes && slopes && self.bend <= share,
        }
    }
}

/// A line of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceLine {
    /// One of its sides.
    Rim(Rim),
    /// The line where u has a value inside the domain.
    U(f64),
    /// The line where v has a value inside the domain.
    V(f64),
}

/// A line along which two surfaces, or two parts of one, meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJoint {
    /// Index of the surface and line on it, on both sides.
    pub lines: [(usize, SurfaceLine); 2],
    /// How they meet.
    pub smoothness: Smoothness,
}

/// How surfaces hang together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceJoints {
    /// Common lines: inside surfaces where pieces meet, then between sides.
    pub joints: Vec<SurfaceJoint>,
    /// Sides that meet no other: index of the surface and side.
    pub open: Vec<(usize, Rim)>,
    /// Sides that are one point.
    pub collapsed: Vec<(usize, Rim)>,
}

/// Points nearer to each other than this share of the size of all are one.
const SAME: f64 = 1e-9;

/// Finds and classifies all common lines of surfaces. A side that runs along only a part of another is taken for open.
///
/// Each line is looked at in at least 16 places a piece: polynomials that vanish there vanish everywhere, up to
/// degree 15, which is more than the tangent planes of two patches of degree 5 have between them.
///
/// Cost: sorting the sides, and about 32 evaluations for each piece of each joint.
#[must_use]
pub fn joints<S: Surface + Sync>(surfaces: &[S]) -> SurfaceJoints {
    let mut found = SurfaceJoints::default();
    let inner = |(index, surface)| inner_joints(index, surface);
    found.joints = surfaces.par_iter().enumerate().flat_map_iter(inner).collect();
    let sides = sides(surfaces);
    let ends = sides.iter().flat_map(|side| side.probes);
    let near = SAME * Bounds::of_points(ends).diagonal();
    let mut met = vec![false; sides.len()];
    let mut meetings = Vec::new();
    for (one, side) in sides.iter().enumerate() {
        if side.is_point(near) {
            found.collapsed.push((side.surface, side.rim));
            met[one] = true;
            continue;
        }
        // Sides are sorted by the first of their ends, so partners stand near by.
        let reach = sides[one + 1..].iter().take_while(|other| other.key.x <= side.key.x + near);
        for (offset, other) in reach.enumerate() {
            let Some(meeting) = side.meets(surfaces, other, near) else { continue };
            meetings.push((side, other, meeting));
            met[one] = true;
            met[one + 1 + offset] = true;
        }
    }
    let joint = |(side, other, meeting): &(&SideOf, &SideOf, Meeting)| {
        let lines =
            [(side.surface, SurfaceLine::Rim(side.rim)), (other.surface, SurfaceLine::Rim(other.rim))];
        let smoothness = classify(&side.line(surfaces), &other.line(surfaces), meeting);
        SurfaceJoint { lines, smoothness }
    };
    found.joints.par_extend(meetings.par_iter().map(joint));
    found
        .open
        .extend(sides.iter().zip(&met).filter(|(_, met)| !**met).map(|(side, _)| (side.surface, side.rim)));
    let order = |(surface, rim): &(usize, Rim)| (*surface, *rim as usize);
    found.open.sort_by_key(order);
    found.collapsed.sort_by_key(order);
    found
}

fn inner_joints<S: Surface>(index: usize, surface: &S) -> Vec<SurfaceJoint> {
    let mut found = Vec::new();
    for (along_u, breaks) in [(false, surface.breaks_u()), (true, surface.breaks_v())] {
        for t in breaks {
            let line = |side: Side| Line::inner(surface, along_u, t, side);
            let meeting = Meeting { backward: false, same_parameters: true };
            let smoothness = classify(&line(Side::Before), &line(Side::After), &meeting);
            let line = if along_u { SurfaceLine::V(t) } else { SurfaceLine::U(t) };
            found.push(SurfaceJoint { lines: [(index, line); 2], smoothness });
        }
    }
    found
}

/// How two sides run along each other.
struct Meeting {
    backward: bool,
    same_parameters: bool,
}

/// Places along a side that are compared.
const PROBES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// One side of one surface.
struct SideOf {
    surface: usize,
    rim: Rim,
    probes: [DVec3; 5],
    /// The first of its ends in order of x.
    key: DVec3,
}

fn sides<S: Surface>(surfaces: &[S]) -> Vec<SideOf> {
    let side = |surface: usize, rim: Rim| {
        let line = Line::rim(&surfaces[surface], rim);
        let probes = PROBES.map(|share| line.point(share));
        let key = if probes[0].x <= probes[4].x { probes[0] } else { probes[4] };
        SideOf { surface, rim, probes, key }
    };
    let mut sides: Vec<SideOf> =
        (0..surfaces.len()).flat_map(|surface| Rim::ALL.map(|rim| side(surface, rim))).collect();
    sides.sort_by(|a, b| a.key.x.total_cmp(&b.key.x));
    sides
}

impl SideOf {
    fn is_point(&self, near: f64) -> bool {
        self.probes.iter().all(|probe| probe.distance(self.probes[0]) <= near)
    }

    fn line<'a, S: Surface>(&self, surfaces: &'a [S]) -> Line<'a, S> {
        Line::rim(&surfaces[self.surface], self.rim)
    }

    /// Whether another side is the same line, and how it runs.
    fn meets<S: Surface>(&self, surfaces: &[S], other: &Self, near: f64) -> Option<Meeting> {
        let close = |a: DVec3, b: DVec3| a.distance(b) <= near;
        for backward in [false, true] {
            let probe = |k: usize| other.probes[if backward { 4 - k } else { k }];
            if !(close(self.probes[0], probe(0)) && close(self.probes[4], probe(4))) {
                continue;
            }
            if (1..4).all(|k| close(self.probes[k], probe(k))) {
                return Some(Meeting { backward, same_parameters: true });
            }
            let line = other.line(surfaces);
            if self.probes[1..4].iter().all(|probe| distance(&line, *probe) <= near) {
                return Some(Meeting { backward, same_parameters: false });
            }
        }
        None
    }
}

/// Distance of a point from a line: from the nearest of samples by golden sections.
fn distance<S: Surface>(line: &Line<'_, S>, point: DVec3) -> f64 {
    nearest(line, point).1
}

/// The share of the nearest point, and its distance.
fn nearest<S: Surface>(line: &Line<'_, S>, point: DVec3) -> (f64, f64) {
    const SAMPLES: u32 = 64;
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let square = |share: f64| line.point(share).distance_squared(point);
    let at = |k: u32| f64::from(k) / f64::from(SAMPLES);
    let best = (0..=SAMPLES).min_by(|a, b| square(at(*a)).total_cmp(&square(at(*b)))).unwrap_or(0);
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(SAMPLES)));
    for _ in 0..60 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if square(a) <= square(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let share = f64::midpoint(low, high);
    (share, square(share).sqrt())
}

/// Compares two lines that are one, from one end to the other.
fn classify<S: Surface>(one: &Line<'_, S>, other: &Line<'_, S>, meeting: &Meeting) -> Smoothness {
    let flipped = |share: f64| if meeting.backward { 1.0 - share } else { share };
    let mut stops = vec![0.0, 1.0];
    stops.extend(one.breaks());
    stops.extend(other.breaks().into_iter().map(flipped));
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|a, b| *a - *b <= SAME);
    let count = (96 / (stops.len() - 1)).max(16);
    let mut worst = Smoothness {
        continuity: PatchContinuity::G0,
        angle: 0.0,
        place: one.point(0.5),
        slope: 0.0,
        bend: 0.0,
        same_parameters: meeting.same_parameters,
    };
    let mut size = Sizes::default();
    for pair in stops.windows(2) {
        for k in 0..=count {
            let share = pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64;
            let there =
                if meeting.same_parameters { flipped(share) } else { nearest(other, one.point(share)).0 };
            compare(&one.jet(share), &other.jet(there), &mut worst, &mut size);
        }
    }
    worst.slope /= size.slope.max(f64::MIN_POSITIVE);
    // A surface that is straight across the line bends by rounding alone.
    worst.bend /= size.bend.max(size.slope).max(f64::MIN_POSITIVE);
    let order = [PatchContinuity::C2, PatchContinuity::C1, PatchContinuity::G1, PatchContinuity::C0];
    let class = order.into_iter().find(|class| worst.holds(*class, 0.0));
    Smoothness { continuity: class.unwrap_or(PatchContinuity::G0), ..worst }
}

/// What differences are measured against.
#[derive(Default)]
struct Sizes {
    slope: f64,
    bend: f64,
}

fn compare(one: &super::rim::LineJet, other: &super::rim::LineJet, worst: &mut Smoothness, size: &mut Sizes) {
    // Onward out of the one is onward into the other.
    let (out, into) = (one.onward, -other.onward);
    worst.slope = worst.slope.max(out.distance(into));
    worst.bend = worst.bend.max(one.second.distance(other.second));
    size.slope = size.slope.max(out.length()).max(into.length());
    size.bend = size.bend.max(one.second.length()).max(other.second.length());
    let Some(along) = one.along.try_normalize() else { return };
    let across = |vector: DVec3| vector - along * vector.dot(along);
    let (flat_out, flat_into) = (across(out), across(into));
    // Where a side has no width there is no plane to compare.
    let least = ROUNDING * size.slope;
    if flat_out.length() <= least || flat_into.length() <= least {
        return;
    }
    let angle = atan2(flat_out.cross(flat_into).length(), flat_out.dot(flat_into)).to_degrees();
    if angle > worst.angle {
        (worst.angle, worst.place) = (angle, one.point);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{PatchContinuity, SurfaceLine, joints};
    use crate::geometry::curve::control::{BasisMatrix, Knots};
    use crate::geometry::surface::Rim;
    use crate::geometry::surface::tensor::{
        Grid, PolynomialSurface, TensorSpline, bicubic, reflected, wrapped,
    };

    fn wavy(columns: usize, rows: usize) -> Grid<DVec3> {
        let height = |i: usize, j: usize| ((i * i * 7 + j * 5 + i * j) % 11) as f64 * 0.2 - 1.0;
        Grid::from_fn(columns, rows, |i, j| DVec3::new(i as f64, height(i, j), -(j as f64))).unwrap()
    }

    fn patch(point: impl Fn(f64, f64) -> DVec3) -> PolynomialSurface {
        let grid = Grid::from_fn(4, 4, |i, j| point(i as f64 / 3.0, j as f64 / 3.0)).unwrap();
        PolynomialSurface::bezier((3, 3), &grid, vec![0.0, 1.0], vec![0.0, 1.0]).unwrap()
    }

    fn only(surfaces: &[PolynomialSurface]) -> super::Smoothness {
        let found = joints(surfaces);
        assert_eq!(found.joints.len(), 1, "{found:?}");
        found.joints[0].smoothness
    }

    #[test]
    fn lines_inside_are_classified_by_their_basis() {
        let smooth = bicubic(&wavy(6, 5), &BasisMatrix::B_SPLINE, 1).unwrap();
        let through = bicubic(&reflected(&wavy(6, 5), true, true), &BasisMatrix::CATMULL_ROM, 1).unwrap();
        let found = joints(&[smooth, through]);
        let class = |surface: usize| {
            let own = found.joints.iter().filter(move |joint| joint.lines[0].0 == surface);
            own.map(|joint| joint.smoothness.continuity).collect::<Vec<_>>()
        };
        assert_eq!(class(0), vec![PatchContinuity::C2; 3]);
        assert_eq!(class(1), vec![PatchContinuity::C1; 7]);
        assert_eq!((found.open.len(), found.collapsed.len()), (8, 0));
    }

    #[test]
    fn multiple_knots_take_continuity_away() {
        let u = Knots::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 5.0, 5.0, 5.0, 5.0])
            .unwrap();
        let spline = TensorSpline::new(u, Knots::clamped(3, 4).unwrap(), wavy(10, 4)).unwrap();
        let found = joints(&[PolynomialSurface::spline(&spline).unwrap()]);
        let classes: Vec<_> = found.joints.iter().map(|joint| joint.smoothness.continuity).collect();
        assert_eq!(classes, [PatchContinuity::C2, PatchContinuity::C1, PatchContinuity::C0]);
        assert_eq!(found.joints[2].lines, [(0, SurfaceLine::U(3.0)); 2]);
    }

    #[test]
    fn patches_meet_whichever_way_they_run() {
        let ground = |x: f64, y: f64| DVec3::new(x, y, 0.1 * x * x + 0.2 * y * y * y);
        let left = patch(ground);
        // Every position of the right neighbor: turned and mirrored.
        for turned in 0..4 {
            let turn = |s: f64, t: f64| match turned {
                0 => (1.0 + s, t),
                1 => (2.0 - s, t),
                2 => (1.0 + t, s),
                _ => (1.0 + t, 1.0 - s),
            };
            let other = patch(|s, t| {
                let (x, y) = turn(s, t);
                // Control points of x^2 past 1 as those of the same parabola: slope 2 a at the joint.
                DVec3::new(x, y, 0.1 * (2.0 * x - 1.0) + 0.2 * y * y * y)
            });
            let found = only(&[left.clone(), other]);
            // Left, the control points at 2/3 and 1 rise by 0.1 * 5 / 9; right by 0.2 / 3: planes differ a little.
            assert_eq!(found.continuity, PatchContinuity::C0);
            let slope = |rise: f64| crate::geometry::number::atan(rise * 3.0).to_degrees();
            assert!((found.angle - (slope(0.2 / 3.0) - slope(0.1 * 5.0 / 9.0))).abs() < 1.0);
        }
    }

    /// A plane beside a plane: with equal speed C2, with another speed across G1, with other parameters along G0.
    #[test]
    fn parameters_tell_geometric_from_parametric() {
        let flat = patch(|x, y| DVec3::new(x, y, 0.0));
        let even = patch(|x, y| DVec3::new(1.0 + x, y, 0.0));
        let fast = patch(|x, y| DVec3::new(1.0 + 2.0 * x, y, 0.0));
        let uneven = patch(|x, y| DVec3::new(1.0 + x, y * y, 0.0));
        let bent = patch(|x, y| DVec3::new(1.0, y, x));
        let class = |other: &PolynomialSurface| only(&[flat.clone(), other.clone()]);
        assert_eq!(class(&even).continuity, PatchContinuity::C2);
        assert_eq!(class(&fast).continuity, PatchContinuity::G1);
        let found = class(&uneven);
        assert_eq!((found.continuity, found.same_parameters), (PatchContinuity::G1, false));
        assert!(!found.holds(PatchContinuity::C0, 1.0));
        let found = class(&bent);
        assert_eq!(found.continuity, PatchContinuity::C0);
        assert!((found.angle - 90.0).abs() < 1e-9 && !found.holds(PatchContinuity::G1, 89.0));
        assert!(found.holds(PatchContinuity::G1, 91.0));
    }

    /// Two patches on top of each other share a line, but the surface turns back there.
    #[test]
    fn a_fold_is_not_smooth() {
        let sheet = patch(|x, y| DVec3::new(x, y, 0.0));
        let back = patch(|x, y| DVec3::new(1.0 - 2.0 * x, y, 0.0));
        let found = only(&[sheet, back]);
        assert_eq!((found.continuity, found.angle), (PatchContinuity::C0, 180.0));
    }

    #[test]
    fn seams_and_poles_are_found() {
        let around = bicubic(&wrapped(&wavy(6, 5), 3, 0), &BasisMatrix::B_SPLINE, 1).unwrap();
        let found = joints(&[around]);
        let seam = found.joints.last().unwrap();
        assert_eq!(seam.smoothness.continuity, PatchContinuity::C2);
        assert!(seam.lines.iter().all(|(_, line)| matches!(line, SurfaceLine::Rim(Rim::Left | Rim::Right))));
        let cone = patch(|x, y| DVec3::new(x * y, y, 0.0));
        assert_eq!(joints(&[cone]).collapsed, [(0, Rim::Bottom)]);
    }
}

//! The surface of a field in a tile of a picture: blocks of space are split until the surface in them is known.
//!
//! Promise: a block (a part of the tile over an interval of distances) is left out only where bounds on the field show that
//! it holds none of the surface, or where all of its samples see something nearer. Where bounds show that the field grows
//! or falls along all lines of sight of a block, each line meets the surface in it at most once, and two values tell
//! whether it does. A pixel where neither can be shown for all of its lines is searched line by line, by bounds along the
//! line; how many lines end without a proof is counted.
//!
//! Source: S. Vyatkin, B. Dolgovesov, Synthesis of virtual environment with object-space recursive subdivision, Graphicon
//! 1998; along a line: E. Hansen, Global Optimization using Interval Analysis, 1992 (the mean value form).

use glam::{DVec2, DVec3};

use super::rays::{Block, Rays};
use crate::geometry::field::{Field, Sheet};
use crate::geometry::formula::Quality;
use crate::geometry::number::{Bounds, single};
use crate::preview::raster::{Pattern, Seen, Tile};

/// Blocks of so many pixels across are drawn when their lines are known to meet the surface once at most; larger ones hold
/// many lines that miss it.
const FEW: usize = 8;

/// A block of one pixel is split along its lines while it is so many times longer than wide.
const LONG: f64 = 32.0;

/// Halvings of a line without a proof, after which two values decide.
const HALVINGS: u32 = 36;

/// Steps to a place on a line, and how often one of them halves, since others may creep.
const STEPS: u32 = 200;
const CREEPING: u32 = 8;

/// A part of the picture in whole pixels: from, and up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) low: [usize; 2],
    pub(super) high: [usize; 2],
}

/// What draws one surface into a tile.
pub(super) struct Painter<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) rays: Rays,
    pub(super) pattern: Pattern,
    /// The name of its front; that of its back is the next.
    pub(super) name: u32,
    pub(super) tile: &'a mut Tile,
    /// Lines that ended without a proof.
    pub(super) unproved: u64,
}

/// What bounds show of the field on lines through a box.
struct Known {
    /// Whether no line meets the surface.
    empty: bool,
    /// Whether the field only grows, or only falls, along each line.
    steady: bool,
    /// Bounds on the size of its slope along lines, for a distance of 1.
    slope: f64,
    /// Whether all points belong to the surface where the field is zero.
    inside: bool,
    /// Bounds on how much values at one distance differ from that on the middle line of a pixel.
    varies: f64,
}

impl Painter<'_> {
    /// Draws what is seen in a part of the tile between two distances.
    pub(super) fn paint(&mut self, area: Area, near: f64, far: f64) {
        let corner = |place: [usize; 2]| DVec2::new(place[0] as f64, place[1] as f64);
        let block = Block { low: corner(area.low), high: corner(area.high), near, far };
        if self.hidden(&area, near) {
            return;
        }
        let (points, ways) = self.rays.around(&block);
        let [wide, high] = [0, 1].map(|axis| area.high[axis] - area.low[axis]);
        let known = self.known(&points, &ways, (far, wide.max(high) > FEW));
        if known.empty {
            return;
        }
        let (across, along) = self.rays.size(&block);
        let one = wide == 1 && high == 1;
        if known.steady {
            self.steady(&area, &block, &known);
        } else if along > if one { LONG * across } else { across } {
            let middle = f64::midpoint(near, far);
            if middle <= near || middle >= far {
                return;
            }
            self.paint(area, near, middle);
            self.paint(area, middle, far);
        } else if one {
            self.lines(area.low, (near, far));
        } else {
            let split = |axis: usize| (area.low[axis] + area.high[axis]).div_ceil(2);
            let (x, y) = (split(0), split(1));
            for (left, right) in [(area.low[0], x), (x, area.high[0])] {
                for (top, bottom) in [(area.low[1], y), (y, area.high[1])] {
                    if left < right && top < bottom {
                        self.paint(Area { low: [left, top], high: [right, bottom] }, near, far);
                    }
                }
            }
        }
    }

    fn pixel(&self, [column, row]: [usize; 2]) -> usize {
        ((row - self.tile.top) * self.tile.width + column - self.tile.left) * self.pattern.len()
    }

    /// Whether everything in an area is hidden by what is nearer.
    fn hidden(&self, area: &Area, near: f64) -> bool {
        let near = single(self.rays.depth(near));
        (area.low[1]..area.high[1]).all(|row| {
            let (from, to) = (self.pixel([area.low[0], row]), self.pixel([area.high[0], row]));
            self.tile.seen[from..to].iter().all(|seen| seen.depth < near)
        })
    }

    /// What is known of a box of points, and of the ways of lines through it; of a large one only whether it is empty.
    fn known(&self, points: &Bounds, ways: &Bounds, (far, large): (f64, bool)) -> Known {
        let empty_box =
            Known { empty: true, steady: false, slope: f64::INFINITY, inside: false, varies: f64::INFINITY };
        let own = &self.sheet.bounds;
        let within = Bounds { min: points.min.max(own.min), max: points.max.min(own.max) };
        if within.is_empty() {
            return empty_box;
        }
        let mut inside = true;
        for other in &self.sheet.inside {
            let values = other.values(&within);
            if values.low > 0.0 {
                return empty_box;
            }
            inside &= values.high <= 0.0;
        }
        // Values alone cost less, and large boxes are seldom steady.
        if large {
            let values = self.sheet.field.values(&within);
            let empty = values.low > 0.0 || values.high < 0.0;
            return Known { empty, inside, ..empty_box };
        }
        let study = self.sheet.field.study(&within);
        if study.value.low > 0.0 || study.value.high < 0.0 {
            return empty_box;
        }
        let (mut low, mut high) = (0.0, 0.0);
        let mut sizes = [0.0; 3];
        for (axis, slope) in study.gradient.iter().enumerate() {
            sizes[axis] = slope.size();
            let (least, most) = (ways.min.to_array()[axis], ways.max.to_array()[axis]);
            let products = [slope.low * least, slope.low * most, slope.high * least, slope.high * most];
            low += products.iter().copied().fold(f64::INFINITY, f64::min);
            high += products.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        }
        let continuous = self.sheet.field.is_continuous() || study.value.quality >= Quality::Continuous;
        let finite = continuous && f64::is_finite(low) && f64::is_finite(high);
        // A little for rounding of the products.
        let room = 1e-12 * (low.abs() + high.abs());
        Known {
            empty: false,
            steady: finite && (low > room || high < -room),
            slope: if finite { low.abs().max(high.abs()) + room } else { f64::INFINITY },
            inside,
            // Beside the box nothing is known.
            varies: if finite && within == *points {
                self.rays.beside(DVec3::from_array(sizes), far)
            } else {
                f64::INFINITY
            },
        }
    }

    /// Draws an area whose lines meet the surface at most once in its block.
    fn steady(&mut self, area: &Area, block: &Block, known: &Known) {
        // Where the last line met it: the next one is near.
        let mut last = f64::midpoint(block.near, block.far);
        for row in area.low[1]..area.high[1] {
            for column in area.low[0]..area.high[0] {
                match self.ends([column, row], block, known) {
                    Some((one, other)) if !differ((one, other)) => {}
                    Some((one, _)) if known.inside => {
                        let (start, way) = self.rays.line(place([column, row], [128, 128]));
                        last = self.place((start, way), (block.near, block.far), (one, last));
                        self.whole([column, row], start + way * last, (block, one <= 0.0));
                    }
                    _ => self.apart([column, row], (block.near, block.far), known.inside),
                }
            }
        }
    }

    /// Values on the middle line of a pixel at both ends of a block; none where those on other lines of the pixel may have other
    /// signs.
    fn ends(&self, pixel: [usize; 2], block: &Block, known: &Known) -> Option<(f64, f64)> {
        let (start, way) = self.rays.line(place(pixel, [128, 128]));
        let value = |away: f64| {
            let value = self.sheet.field.value(start + way * away);
            (value.abs() > known.varies).then_some(value)
        };
        Some((value(block.near)?, value(block.far)?))
    }

    /// Shows all samples of a pixel on the plane that the surface has at a point.
    fn whole(&mut self, pixel: [usize; 2], point: DVec3, (block, back): (&Block, bool)) {
        let first = self.pixel(pixel);
        let slope = self.sheet.field.value_gradient(point).1;
        for (sample, parts) in self.pattern.iter().enumerate() {
            let (start, way) = self.rays.line(place(pixel, *parts));
            let away = slope.dot(point - start) / slope.dot(way);
            let away = if away.is_finite() { away.clamp(block.near, block.far) } else { block.near };
            self.show(first + sample, away, back);
        }
    }

    /// Looks at each line of a pixel by itself, where it meets the surface at most once between two distances.
    fn apart(&mut self, pixel: [usize; 2], (near, far): (f64, f64), inside: bool) {
        let first = self.pixel(pixel);
        for (sample, parts) in self.pattern.iter().enumerate() {
            let (start, way) = self.rays.line(place(pixel, *parts));
            let Some((from, to)) = self.clipped((start, way), (near, far)) else { continue };
            let value = |away: f64| self.sheet.field.value(start + way * away);
            let ends = (value(from), value(to));
            if differ(ends) {
                let away = self.place((start, way), (from, to), (ends.0, f64::midpoint(from, to)));
                if inside || self.belongs(start + way * away) {
                    self.show(first + sample, away, ends.0 <= 0.0);
                }
            }
        }
    }

    /// Shows the surface at a sample, from its back where that is seen.
    fn show(&mut self, sample: usize, away: f64, back: bool) {
        let depth = single(self.rays.depth(away));
        let seen = &mut self.tile.seen[sample];
        if depth < seen.depth {
            *seen = Seen { depth, name: self.name + u32::from(back) };
        }
    }

    /// Looks along each line of a pixel by itself.
    fn lines(&mut self, pixel: [usize; 2], (near, far): (f64, f64)) {
        let first = self.pixel(pixel);
        for (sample, parts) in self.pattern.iter().enumerate() {
            let line = self.rays.line(place(pixel, *parts));
            if let Some((from, to)) = self.clipped(line, (near, far))
                && let Some((away, back)) = self.first(line, (from, to), 0)
            {
                self.show(first + sample, away, back);
            }
        }
    }

    /// How far away a line first meets the surface, and whether from its back.
    fn first(&mut self, line: (DVec3, DVec3), (from, to): (f64, f64), halved: u32) -> Option<(f64, bool)> {
        let (start, way) = line;
        let (one, other) = (start + way * from, start + way * to);
        let known = self.known(&Bounds::of_points([one, other]), &Bounds::of_points([way]), (to, false));
        if known.empty {
            return None;
        }
        let middle = f64::midpoint(from, to);
        let value = self.sheet.field.value(start + way * middle);
        if value.abs() > known.slope * (to - from) * 0.5 * (1.0 + 1e-12) {
            return None;
        }
        if known.steady || halved >= HALVINGS || middle <= from || middle >= to {
            self.unproved += u64::from(!known.steady);
            let value = |away: f64| self.sheet.field.value(start + way * away);
            let ends = (value(from), value(to));
            if !differ(ends) {
                return None;
            }
            let away = self.place(line, (from, to), (ends.0, middle));
            return (known.inside || self.belongs(start + way * away)).then_some((away, ends.0 <= 0.0));
        }
        self.first(line, (from, middle), halved + 1).or_else(|| self.first(line, (middle, to), halved + 1))
    }

    /// The part of a line between two distances that lies in the box of the surface.
    fn clipped(&self, (start, way): (DVec3, DVec3), (near, far): (f64, f64)) -> Option<(f64, f64)> {
        let (start, way) = (start.to_array(), way.to_array());
        let (min, max) = (self.sheet.bounds.min.to_array(), self.sheet.bounds.max.to_array());
        let (mut from, mut to) = (near, far);
        for axis in 0..3 {
            let (low, high) = (min[axis] - start[axis], max[axis] - start[axis]);
            if way[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / way[axis], high / way[axis]);
            (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        }
        (from < to).then_some((from, to))
    }

    /// Where a line meets the surface between two distances, by the value at the first and a guess: Newton's steps as long as
    /// they stay between the ends, halving otherwise.
    fn place(
        &self,
        (start, way): (DVec3, DVec3),
        (mut from, mut to): (f64, f64),
        (value, guess): (f64, f64),
    ) -> f64 {
        let below = value <= 0.0;
        let enough = 1e-11 * from.abs().max(to.abs()).max(to - from);
        let mut away = if guess > from && guess < to { guess } else { f64::midpoint(from, to) };
        for step in 0..STEPS {
            let (value, gradient) = self.sheet.field.value_gradient(start + way * away);
            if value == 0.0 {
                break;
            }
            *(if (value <= 0.0) == below { &mut from } else { &mut to }) = away;
            let next = away - value / gradient.dot(way);
            let next = if next > from && next < to && step % CREEPING != CREEPING - 1 {
                next
            } else {
                f64::midpoint(from, to)
            };
            let near = (next - away).abs() <= enough;
            away = next;
            if near || to - from <= enough {
                break;
            }
        }
        away
    }

    fn belongs(&self, point: DVec3) -> bool {
        self.sheet.inside.iter().all(|other| other.value(point) <= 0.0)
    }
}

/// Whether values are numbers of both signs.
fn differ((one, other): (f64, f64)) -> bool {
    (one <= 0.0) != (other <= 0.0) && one.is_finite() && other.is_finite()
}

fn place([column, row]: [usize; 2], [x, y]: [i64; 2]) -> DVec2 {
    DVec2::new(column as f64 + x as f64 / 256.0, row as f64 + y as f64 / 256.0)
}

//! What curves made of pieces share: finding a piece, and bounds over several of them.

use glam::DVec3;

use super::{Domain, Jet, Side};

/// The parameters at which pieces begin and end, increasing; piece k covers those from k to k + 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pieces {
    breaks: Vec<f64>,
    /// Pieces for each unit of the parameter, on average.
    rate: f64,
}

impl Pieces {
    /// At least one piece; `None` when the parameters do not increase.
    pub(crate) fn new(breaks: Vec<f64>) -> Option<Self> {
        let increasing = breaks.windows(2).all(|pair| pair[0] < pair[1]);
        let last = breaks.len().checked_sub(2)? + 1;
        let rate = last as f64 / (breaks[last] - breaks[0]);
        increasing.then_some(Self { breaks, rate })
    }

    pub(crate) fn count(&self) -> usize {
        self.breaks.len() - 1
    }

    pub(crate) fn domain(&self) -> Domain {
        Domain { start: self.breaks[0], end: self.breaks[self.breaks.len() - 1] }
    }

    /// All parameters at which pieces begin and end.
    pub(crate) fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Those where one piece follows another.
    pub(crate) fn inner(&self) -> &[f64] {
        &self.breaks[1..self.breaks.len() - 1]
    }

    /// The piece that holds `t`: O(1) where pieces are about equally long, else O(log pieces).
    #[inline]
    pub(crate) fn locate(&self, t: f64, side: Side) -> usize {
        match side {
            Side::After => self.count_where(t, |knot| knot <= t),
            Side::Before => self.count_where(t, |knot| knot < t),
        }
    }

    /// Whether a piece is the one that [`Pieces::locate`] finds for an inner parameter.
    #[inline]
    pub(crate) fn holds(&self, index: usize, t: f64, side: Side) -> bool {
        let (start, end) = (self.breaks[index], self.breaks[index + 1]);
        match side {
            Side::After => start <= t && t < end,
            Side::Before => start < t && t <= end,
        }
    }

    /// How many of the inner breaks, from the first on, stand `before` a parameter: a few steps from the place where
    /// it would be among equal pieces, then by halving.
    #[inline]
    fn count_where(&self, t: f64, before: impl Fn(f64) -> bool) -> usize {
        const STEPS: usize = 6;
        let inner = self.inner();
        let mut at = whole((t - self.breaks[0]) * self.rate).min(inner.len());
        for _ in 0..STEPS {
            if at < inner.len() && before(inner[at]) {
                at += 1;
            } else if at > 0 && !before(inner[at - 1]) {
                at -= 1;
            } else {
                return at;
            }
        }
        inner.partition_point(|knot| before(*knot))
    }

    /// Length of a piece in the parameter.
    #[inline]
    pub(crate) fn span(&self, index: usize) -> f64 {
        self.breaks[index + 1] - self.breaks[index]
    }

    /// Local parameter of `t` in piece `index`, 0 to 1.
    #[inline]
    pub(crate) fn local(&self, index: usize, t: f64) -> f64 {
        ((t - self.breaks[index]) / self.span(index)).clamp(0.0, 1.0)
    }

    /// The parameter at a local one of piece `index`.
    pub(crate) fn parameter(&self, index: usize, local: f64) -> f64 {
        self.breaks[index] * (1.0 - local) + self.breaks[index + 1] * local
    }

    /// Derivatives by the local parameter of a piece into those by the parameter.
    #[inline]
    pub(crate) fn scaled(&self, index: usize, jet: &Jet) -> Jet {
        let rate = 1.0 / self.span(index);
        Jet { point: jet.point, first: jet.first * rate, second: jet.second * (rate * rate) }
    }

    /// Bound on the distance of the curve from the chord between two parameters, from such bounds within single
    /// pieces (`within`, between local parameters) and the ends of the pieces.
    ///
    /// A part lies within its own bound of its own chord, and that chord no further from the whole one than its
    /// ends. By continuity the curve passes every place along the chord, so the bound holds both ways.
    pub(crate) fn chord_deviation(
        &self,
        (from, to): (f64, f64),
        point: impl Fn(usize, f64) -> DVec3,
        within: impl Fn(usize, f64, f64) -> f64,
    ) -> f64 {
        let (first, last) = (self.locate(from, Side::After), self.locate(to, Side::Before));
        if first >= last {
            return within(first, self.local(first, from), self.local(first, to));
        }
        let chord = (point(first, self.local(first, from)), point(last, self.local(last, to)));
        let mut deviation = 0.0_f64;
        let mut previous = 0.0;
        for index in first..=last {
            let (start, end) = (self.local(index, from), self.local(index, to));
            let distance = if index == last { 0.0 } else { distance_to_segment(point(index, 1.0), chord) };
            deviation = deviation.max(distance.max(previous) + within(index, start, end));
            previous = distance;
        }
        deviation
    }
}

/// The whole part of a number; 0 for a negative one and for none.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
fn whole(number: f64) -> usize {
    number as usize
}

/// Distance from a point to a segment.
pub(crate) fn distance_to_segment(point: DVec3, (start, end): (DVec3, DVec3)) -> f64 {
    let along = end - start;
    let square = along.length_squared();
    let place = if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(start + along * place)
}

/// Unit direction within one piece at a local parameter, from the jet there and the leading terms: the ways
/// from the point at the nearer end, ordered from that end, each with what it weighs.
///
/// Where the first derivative vanishes, the direction is that of the first leading term that does not, at an
/// end, and that of the second derivative elsewhere.
pub(crate) fn direction_within(
    jet: &Jet,
    local: f64,
    side: Side,
    leading: impl Fn(bool) -> Vec<DVec3>,
) -> Option<DVec3> {
    const STOPPED: f64 = 1e-9;
    if jet.first.length() > STOPPED * jet.second.length() && jet.first.length() > 0.0 {
        return Some(jet.first.normalize());
    }
    let onward = if side == Side::After { 1.0 } else { -1.0 };
    if (local <= 0.0 && side == Side::After) || (local >= 1.0 && side == Side::Before) {
        let ways = leading(local >= 1.0);
        let size = ways.iter().map(|way| way.length()).fold(0.0, f64::max);
        let way = ways.into_iter().find(|way| way.length() > 1e-12 * size)?;
        return Some(way.normalize() * onward);
    }
    jet.second.try_normalize().map(|second| second * onward)
}

/// Whether two unit directions differ by more than rounding.
pub(crate) fn turns(before: DVec3, after: DVec3) -> bool {
    // Directions that agree to this sine come from a smooth construction: rounding alone leaves about
    // 1e-14, a corner a person means starts far above.
    const SAME_DIRECTION: f64 = 1e-9;
    before.cross(after).length() > SAME_DIRECTION || before.dot(after) < 0.0
}

#[cfg(test)]
mod tests {
    use super::Pieces;
    use crate::geometry::curve::Side;

    #[test]
    fn a_piece_is_found_as_by_counting() {
        let equal: Vec<f64> = (0..50).map(f64::from).collect();
        let growing: Vec<f64> = (0..50).map(|k| f64::from(k * k) - 7.0).collect();
        let crowded: Vec<f64> = (0..50).map(|k| if k < 49 { 1e-9 * f64::from(k) } else { 1.0 }).collect();
        for breaks in [equal, growing, crowded, vec![0.0, 1.0], vec![-1.0, 0.0, 1e300]] {
            let pieces = Pieces::new(breaks.clone()).unwrap();
            let between = breaks.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
            let beyond = [breaks[0] - 1.0, breaks[breaks.len() - 1] + 1.0, f64::NEG_INFINITY, f64::INFINITY];
            for t in breaks.iter().copied().chain(between).chain(beyond) {
                let counted = |before: &dyn Fn(f64) -> bool| {
                    breaks[1..breaks.len() - 1].iter().filter(|knot| before(**knot)).count()
                };
                assert_eq!(pieces.locate(t, Side::After), counted(&|knot| knot <= t), "{t} of {breaks:?}");
                assert_eq!(pieces.locate(t, Side::Before), counted(&|knot| knot < t), "{t} of {breaks:?}");
            }
        }
    }

    #[test]
    fn breaks_that_do_not_increase_make_no_pieces() {
        for breaks in [vec![], vec![1.0], vec![0.0, 0.0], vec![0.0, 2.0, 1.0]] {
            assert_eq!(Pieces::new(breaks), None);
        }
    }
}

//! Whether a formula comes back to where it started.

use super::FormulaSurface;
use crate::geometry::surface::Rim;

/// How opposite rims of a surface meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// The greatest distance of points that should be one, metres.
    pub gap: f64,
    /// The parameter along the rims at which it is found, at the first of them.
    pub at: f64,
    /// Whether one rim runs against the other: as in a Moebius band.
    pub twisted: bool,
}

/// Rims that are nearer than this share of the size are one line: formulas that return do so but for rounding.
const SAME: f64 = 1e-9;

/// Places along the rims that are compared; a prime, so that waves of a formula do not hide between them.
const PLACES: u32 = 1009;

impl FormulaSurface {
    /// How the rims at both ends of u (or of v) meet, the better of straight and twisted. Cost: 2018 evaluations.
    #[must_use]
    pub fn closing(&self, along_u: bool) -> Closing {
        let rims = if along_u { [Rim::Left, Rim::Right] } else { [Rim::Bottom, Rim::Top] };
        let [first, last] = rims.map(|rim| {
            let point = |k: u32| self.rim_point(rim, f64::from(k) / f64::from(PLACES - 1));
            (0..PLACES).map(point).collect::<Vec<_>>()
        });
        let along = self.domains[usize::from(along_u)];
        let worst = |twisted: bool| {
            let mut closing = Closing { gap: 0.0, at: along.start, twisted };
            for (k, point) in (0..PLACES).zip(&first) {
                let partner = if twisted { PLACES - 1 - k } else { k };
                let gap = point.distance(last[partner as usize]);
                if gap > closing.gap {
                    closing.gap = gap;
                    closing.at = along.at(f64::from(k) / f64::from(PLACES - 1));
                }
            }
            closing
        };
        let (straight, twisted) = (worst(false), worst(true));
        if straight.gap <= twisted.gap || self.is_closed(&straight) { straight } else { twisted }
    }

    /// Whether rims that meet so are one line.
    #[must_use]
    pub fn is_closed(&self, closing: &Closing) -> bool {
        closing.gap <= SAME * self.size
    }

    /// Whether all of a rim is one point.
    #[must_use]
    pub fn is_pole(&self, rim: Rim) -> bool {
        let start = self.rim_point(rim, 0.0);
        let away = |k: u32| self.rim_point(rim, f64::from(k) / f64::from(PLACES - 1)).distance(start);
        (1..PLACES).all(|k| away(k) <= SAME * self.size)
    }

    /// Whether it has only one side: somewhere it closes with a twist.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        [true, false].into_iter().any(|along_u| {
            let closing = self.closing(along_u);
            let end = if along_u { Rim::Left } else { Rim::Bottom };
            closing.twisted && self.is_closed(&closing) && !self.is_pole(end)
        })
    }

    fn rim_point(&self, rim: Rim, share: f64) -> glam::DVec3 {
        let (x, y) = rim.place(share);
        self.place(self.domains[0].at(x), self.domains[1].at(y))
    }
}

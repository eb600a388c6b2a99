//! Formula surfaces with a thickness: both sides, and walls along open rims.

use std::sync::Arc;

use glam::DVec3;

use super::{FormulaSurface, Rim, SecondJet, Surface, SurfaceJet};
use crate::geometry::curve::{Domain, Side};

/// One side of a surface with a thickness: its points moved along the normals, or the wall that a rim leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct ThickSide {
    base: Arc<FormulaSurface>,
    part: Part,
    /// Half of the thickness, metres.
    half: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// Moved along the normals.
    Front,
    /// Moved against them.
    Back,
    /// u runs along the rim, v through the thickness.
    Wall(Rim),
}

/// Sides that lie nearer to each other than this share of the size are one line.
const SAME: f64 = 1e-9;

/// Share of a domain over which the normal is followed where it has no derivative of its own.
const STEP: f64 = 1e-5;

/// The skin of a surface of some thickness, in metres: half of it lies on each side. Where it closes, with a twist
/// too, the sides go on into each other; along open rims there are walls.
///
/// Source: I. D. Faux, M. J. Pratt, Computational Geometry for Design and Manufacture, 1979, ch. 4.7 (offsets).
#[must_use]
pub fn thickened(base: FormulaSurface, thickness: f64) -> Vec<ThickSide> {
    let base = Arc::new(base);
    let side = |part: Part| ThickSide { base: base.clone(), part, half: thickness / 2.0 };
    let front = side(Part::Front);
    let near = SAME * base.size();
    let one_line = |a: &dyn Fn(f64) -> DVec3, b: &dyn Fn(f64) -> DVec3| {
        [0.0, 0.137, 0.382, 0.5, 0.743, 1.0].into_iter().all(|share| a(share).distance(b(share)) <= near)
    };
    let goes_on = |rim: Rim, opposite: Rim| {
        let own = |share: f64| front.rim(rim, share);
        one_line(&own, &|share| front.rim(opposite, share))
            || one_line(&own, &|share| front.other_rim(opposite, 1.0 - share))
    };
    let mut sides = vec![front.clone(), side(Part::Back)];
    for rim in Rim::ALL {
        let opposite = match rim {
            Rim::Bottom => Rim::Top,
            Rim::Top => Rim::Bottom,
            Rim::Left => Rim::Right,
            Rim::Right => Rim::Left,
        };
        let pole = one_line(&|share| front.rim(rim, share), &|_| front.rim(rim, 0.0));
        if !pole && !goes_on(rim, opposite) {
            sides.push(side(Part::Wall(rim)));
        }
    }
    sides
}

/// Normal of the base and its derivatives.
struct Turn {
    jet: SurfaceJet,
    du: DVec3,
    dv: DVec3,
}

impl ThickSide {
    fn rim(&self, rim: Rim, share: f64) -> DVec3 {
        let jet = self.base_at(rim, share);
        jet.point + jet.normal * self.half
    }

    fn other_rim(&self, rim: Rim, share: f64) -> DVec3 {
        let jet = self.base_at(rim, share);
        jet.point - jet.normal * self.half
    }

    fn base_at(&self, rim: Rim, share: f64) -> SurfaceJet {
        let (x, y) = rim.place(share);
        self.base.evaluate(self.base.domain_u().at(x), self.base.domain_v().at(y))
    }

    /// The back runs along u against the front, so that both look away from each other.
    fn against(&self, (u, side): (f64, Side)) -> (f64, Side) {
        let domain = self.base.domain_u();
        let turned = if side == Side::Before { Side::After } else { Side::Before };
        // The ends go over into each other exactly.
        let u = if u <= domain.start {
            domain.end
        } else if u >= domain.end {
            domain.start
        } else {
            domain.start + (domain.end - u)
        };
        (u, turned)
    }

    /// How the normal of the base changes: by the derivatives of du x dv, or where that vanishes by differences.
    fn turn(&self, u: (f64, Side), v: (f64, Side)) -> Turn {
        let (jet, second) = (self.base.sided(u, v), self.base.second(u, v));
        let across = jet.du.cross(jet.dv);
        let length = across.dot(jet.normal);
        if length > 1e-6 * jet.du.length() * jet.dv.length() {
            let by = |change: DVec3| (change - jet.normal * change.dot(jet.normal)) / length;
            let du = by(second.uu.cross(jet.dv) + jet.du.cross(second.uv));
            let dv = by(second.uv.cross(jet.dv) + jet.du.cross(second.vv));
            return Turn { jet, du, dv };
        }
        let step = |domain: Domain, (t, side): (f64, Side)| {
            let step = domain.span() * STEP;
            let backward = (side == Side::Before && t - step >= domain.start) || t + step > domain.end;
            if backward { -step } else { step }
        };
        let (h, k) = (step(self.base.domain_u(), u), step(self.base.domain_v(), v));
        let du = (self.base.sided((u.0 + h, u.1), v).normal - jet.normal) / h;
        let dv = (self.base.sided(u, (v.0 + k, v.1)).normal - jet.normal) / k;
        Turn { jet, du, dv }
    }

    /// Where on the base a place of a wall stands.
    fn on_rim(&self, rim: Rim, along: (f64, Side)) -> ((f64, Side), (f64, Side)) {
        let (u, v) = (self.base.domain_u(), self.base.domain_v());
        match rim {
            Rim::Bottom => (along, (v.start, Side::After)),
            Rim::Top => (along, (v.end, Side::Before)),
            Rim::Left => ((u.start, Side::After), along),
            Rim::Right => ((u.end, Side::Before), along),
        }
    }
}

impl Surface for ThickSide {
    fn domain_u(&self) -> Domain {
        match self.part {
            Part::Wall(rim) if !rim.along_u() => self.base.domain_v(),
            _ => self.base.domain_u(),
        }
    }

    fn domain_v(&self) -> Domain {
        match self.part {
            Part::Wall(_) => Domain { start: -self.half, end: self.half },
            Part::Front | Part::Back => self.base.domain_v(),
        }
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        match self.part {
            Part::Front => {
                let Turn { jet, du, dv } = self.turn(u, v);
                SurfaceJet {
                    point: jet.point + jet.normal * self.half,
                    du: jet.du + du * self.half,
                    dv: jet.dv + dv * self.half,
                    normal: jet.normal,
                }
            }
            Part::Back => {
                let Turn { jet, du, dv } = self.turn(self.against(u), v);
                SurfaceJet {
                    point: jet.point - jet.normal * self.half,
                    du: du * self.half - jet.du,
                    dv: jet.dv - dv * self.half,
                    normal: -jet.normal,
                }
            }
            Part::Wall(rim) => {
                let (x, y) = self.on_rim(rim, u);
                let Turn { jet, du, dv } = self.turn(x, y);
                let way = v.0.clamp(-self.half, self.half);
                let along = if rim.along_u() { jet.du + du * way } else { jet.dv + dv * way };
                // Where the rim stands still the wall still goes where the rim's direction is known: across.
                let across = if rim.along_u() { jet.dv } else { jet.du };
                let normal =
                    along.cross(jet.normal).try_normalize().unwrap_or_else(|| across.normalize_or(DVec3::X));
                SurfaceJet { point: jet.point + jet.normal * way, du: along, dv: jet.normal, normal }
            }
        }
    }

    fn joints_u(&self) -> Vec<f64> {
        match self.part {
            Part::Wall(rim) if !rim.along_u() => self.base.joints_v(),
            Part::Back => {
                let joints = self.base.joints_u();
                joints.into_iter().rev().map(|joint| self.against((joint, Side::After)).0).collect()
            }
            _ => self.base.joints_u(),
        }
    }

    fn joints_v(&self) -> Vec<f64> {
        match self.part {
            Part::Wall(_) => Vec::new(),
            Part::Front | Part::Back => self.base.joints_v(),
        }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        super::second::by_differences(self, u, v)
    }
}

//! Area of surfaces, and the volume between them and the origin.

use super::Surface;

/// Integrals over a whole surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceMeasures {
    /// Area.
    pub area: f64,
    /// A third of the integral of P . (du x dv): for surfaces that close and have their normals outward, what they
    /// enclose together.
    pub volume: f64,
}

/// Nodes and weights of Gauss and Legendre's rule of ten points on 0 to 1 (one half of them).
const NODES: [(f64, f64); 5] = [
    (0.425_562_830_509_184_4, 0.147_762_112_357_376_4),
    (0.283_302_302_935_376_4, 0.134_633_359_654_998_1),
    (0.160_295_215_850_487_8, 0.109_543_181_257_991),
    (0.067_468_316_655_507_74, 0.074_725_674_575_290_3),
    (0.013_046_735_741_414_14, 0.033_335_672_154_344_07),
];

/// Area and volume by Gauss's rule of ten points on each piece, quartered where that does not agree with its four
/// parts to 1e-11 of the whole: next to poles and cusps.
///
/// Cost: 500 evaluations for each smooth piece, up to some thousand at poles.
#[must_use]
pub fn measure<S: Surface>(surface: &S) -> SurfaceMeasures {
    const EXACT: f64 = 1e-11;
    const DEEPEST: u32 = 24;
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let (u, v) = (stops(u.start, surface.breaks_u(), u.end), stops(v.start, surface.breaks_v(), v.end));
    let mut cells: Vec<Cell> = Vec::new();
    for across in u.windows(2) {
        for up in v.windows(2) {
            cells.push(Cell::new(surface, (across[0], across[1]), (up[0], up[1]), DEEPEST));
        }
    }
    let whole: f64 = cells.iter().map(|cell| cell.found.area).sum();
    let mut sum = SurfaceMeasures::default();
    while let Some(cell) = cells.pop() {
        let parts = cell.quarters(surface);
        let add = |total: SurfaceMeasures, part: &Cell| SurfaceMeasures {
            area: total.area + part.found.area,
            volume: total.volume + part.found.volume,
        };
        let finer = parts.iter().fold(SurfaceMeasures::default(), add);
        let agree = (finer.area - cell.found.area).abs() <= EXACT * whole;
        if agree || cell.left == 0 {
            sum.area += finer.area;
            sum.volume += finer.volume;
        } else {
            cells.extend(parts);
        }
    }
    sum
}

fn stops(start: f64, breaks: Vec<f64>, end: f64) -> Vec<f64> {
    let mut stops = vec![start];
    stops.extend(breaks);
    stops.push(end);
    stops
}

/// A rectangle of parameters and what the rule finds there.
#[derive(Clone, Copy)]
struct Cell {
    u: (f64, f64),
    v: (f64, f64),
    found: SurfaceMeasures,
    /// How often it may be quartered yet.
    left: u32,
}

impl Cell {
    fn new<S: Surface>(surface: &S, u: (f64, f64), v: (f64, f64), left: u32) -> Self {
        let (across, up) = (u.1 - u.0, v.1 - v.0);
        let mut found = SurfaceMeasures::default();
        for (x, weight_x) in both_halves() {
            for (y, weight_y) in both_halves() {
                let jet = surface.evaluate(u.0 + across * x, v.0 + up * y);
                let normal = jet.du.cross(jet.dv) * (weight_x * weight_y * across * up);
                found.area += normal.length();
                found.volume += jet.point.dot(normal) / 3.0;
            }
        }
        Self { u, v, found, left }
    }

    fn quarters<S: Surface>(&self, surface: &S) -> [Self; 4] {
        let (x, y) = (f64::midpoint(self.u.0, self.u.1), f64::midpoint(self.v.0, self.v.1));
        let part = |u, v| Self::new(surface, u, v, self.left.saturating_sub(1));
        [
            part((self.u.0, x), (self.v.0, y)),
            part((x, self.u.1), (self.v.0, y)),
            part((self.u.0, x), (y, self.v.1)),
            part((x, self.u.1), (y, self.v.1)),
        ]
    }
}

fn both_halves() -> impl Iterator<Item = (f64, f64)> {
    NODES.iter().flat_map(|(node, weight)| [(*node, *weight), (1.0 - node, *weight)])
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{NODES, measure};
    use crate::geometry::curve::control::{BSpline, Knots};
    use crate::geometry::surface::tensor::{RationalSurface, revolved};

    #[test]
    fn the_rule_is_exact_up_to_degree_nineteen() {
        for degree in 0..20 {
            let power = |x: f64| (0..degree).fold(1.0, |product, _| product * x);
            let sum: f64 = NODES.iter().map(|(x, w)| w * (power(*x) + power(1.0 - x))).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15, "{degree}: {sum}");
        }
    }

    /// A sphere from a half circle of two quarter arcs, turned: collapsed at both poles.
    #[test]
    fn a_ball_has_the_area_and_volume_of_one() {
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let arc = [(0.0, -1.0, 1.0), (1.0, -1.0, half), (1.0, 0.0, 1.0), (1.0, 1.0, half), (0.0, 1.0, 1.0)];
        let points = arc.map(|(x, y, w)| DVec4::new(2.0 * x * w, 2.0 * y * w, 0.0, w));
        let knots = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
        let profile = BSpline::new(knots, points.to_vec()).unwrap();
        let ball = RationalSurface::spline(&revolved(&profile, 0.0, 360.0)).unwrap();
        let found = measure(&ball);
        let pi = core::f64::consts::PI;
        assert!((found.area - 16.0 * pi).abs() < 1e-9, "{}", found.area);
        assert!((found.volume - 32.0 / 3.0 * pi).abs() < 1e-9, "{}", found.volume);
    }
}
